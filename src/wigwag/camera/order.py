"""Stamps that rise strictly, whatever the source's clock does."""

from __future__ import annotations

_RESTART_NS = 1_000_000_000
"""A frame this much older than the newest is not merely late: its clock was set anew."""
_RESTART_FRAMES = 3
"""As many such frames, one after the other, make it certain."""


class Order:
    """Lets frames pass in order of time.

    A frame that is not newer than the last one is dropped. If the source's clock was set back (a device
    that was reset counts from zero), its frames are taken for what they are after three of them, and their
    stamps go on where the old ones ended.

    Example:
        >>> order = Order()
        >>> [order.admit(stamp) for stamp in (10, 20, 15, 20, 30)]
        [10, 20, None, None, 30]
    """

    def __init__(self) -> None:
        self._last: int | None = None
        self._step = 1
        self._offset = 0
        self._behind: list[int] = []
        self._begin = True

    def restart(self) -> None:
        """Expect a new clock with the next frame: the source was opened anew."""
        self._begin = True

    def admit(self, stamp_ns: int) -> int | None:
        """Return the frame's stamp in the order of all frames so far, or ``None`` to drop it.

        Args:
            stamp_ns: The source's own stamp.
        """
        begin, self._begin = self._begin, False
        if self._last is None:
            return self._pass(stamp_ns)
        stamp = stamp_ns + self._offset
        if stamp > self._last:
            return self._pass(stamp)
        if begin or self._set_back(stamp):
            self._offset = self._last + self._step - stamp_ns
            return self._pass(self._last + self._step)
        return None

    def _pass(self, stamp: int) -> int:
        if self._last is not None:
            self._step = min(max(1, stamp - self._last), _RESTART_NS)
        self._last = stamp
        self._behind.clear()
        return stamp

    def _set_back(self, stamp: int) -> bool:
        """Tell a clock that was set back from frames that are merely late."""
        assert self._last is not None
        if self._last - stamp < _RESTART_NS or (self._behind and stamp <= self._behind[-1]):
            self._behind.clear()
            return False
        self._behind.append(stamp)
        return len(self._behind) >= _RESTART_FRAMES
