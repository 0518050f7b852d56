"""A device's clock, read on the host's."""

from __future__ import annotations

_LEAK = 100e-6
"""No two quartz clocks drift apart faster; the estimate may rise by so much."""
_JUMP_NS = 1_000_000_000
"""An offset that changes by more says that the device's clock was set anew."""

_PLAUSIBLE_NS = 200_000_000
"""An answer cannot lie before the newest stamp's own offset by more than clocks part between the two."""


class DeviceClock:
    """Tells when a picture was taken, on the host's monotonic clock, from the device's own stamp.

    A device stamps evenly, but its clock is another one. Pictures arrive late, by more or less: the least
    difference between arrival and stamp is the offset of the clocks and the shortest way of a picture.
    The estimate follows it downwards at once, and upwards no faster than clocks drift. What is left is
    the shortest way itself, a few milliseconds over USB, by which all stamps are late.

    Example:
        >>> clock = DeviceClock()
        >>> [clock.to_host(stamp, arrival) for stamp, arrival in ((0, 500), (10, 590), (20, 520))]
        [500, 510, 520]
    """

    def __init__(self) -> None:
        self._offset_ns: int | None = None
        self._newest_ns = 0
        """The offset that the newest stamp alone would give."""
        self._seen_ns = 0

    def to_host(self, device_ns: int, arrival_ns: int) -> int:
        """Return the time of a stamp on the host's clock; never later than the arrival.

        Args:
            device_ns: The picture's stamp on the device's clock.
            arrival_ns: When it came, on the host's monotonic clock.
        """
        self._newest_ns = offset = arrival_ns - device_ns
        if self._offset_ns is None or abs(offset - self._offset_ns) > _JUMP_NS:
            self._offset_ns = offset
        else:
            drifted = self._offset_ns + int(_LEAK * max(0, arrival_ns - self._seen_ns))
            self._offset_ns = min(offset, drifted)
        self._seen_ns = arrival_ns
        return device_ns + self._offset_ns

    def answered(self, asked_ns: int, device_ns: int) -> None:
        """Take in that the device read its clock when it was asked to: not before it was asked.

        So the estimate follows a clock that runs far too slow, as a simulator's does on a computer that does
        not keep up, and still calls no stamp younger than it is. An answer by another clock than the stamps'
        is told by its size, and left alone.

        Args:
            asked_ns: When it was asked, on the host's clock.
            device_ns: What its clock said.
        """
        least = asked_ns - device_ns
        if self._offset_ns is not None and self._offset_ns < least < self._newest_ns + _PLAUSIBLE_NS:
            self._offset_ns = least
