"""How an autopilot is talked to."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from wigwag.errors import InputError
from wigwag.vehicles.mavlink.setup import Origin


@dataclass(frozen=True, slots=True)
class MavlinkConfig:
    """How an autopilot is talked to.

    Raises:
        InputError: If a number is out of its range.
    """

    system: int | None = None
    """System id of the vehicle; ``None`` takes the first one heard."""
    rate_hz: float = 30.0
    """How often set-points are sent, evenly, whatever the loop's own rate; 8 to 100."""
    stream_hz: float = 30.0
    """How often position and attitude are asked for; less for slow radios."""
    fresh_s: float = 0.22
    """Nothing older is sent as it is: with the wait for the next even moment, 250 ms end to end."""
    still_s: float = 0.5
    """How long standing still is sent after that, before the vehicle is told to hold."""
    beat_s: float = 1.0
    """Heartbeats stop when the loop has not said for so long that it is alive."""
    ack_s: float = 0.5
    """How long an acknowledgement is waited for before a command is sent again."""
    tries: int = 4
    heartbeat: Literal["auto", "onboard", "gcs"] = "auto"
    """What wigwag says it is: a companion computer; a ground station; or a companion computer, unless PX4
    is set not to fly without a ground station (NAV_DLL_ACT)."""
    origin: Origin | None = None
    """Where the estimator's origin is put if it has none."""
    key: Path | None = None
    """File with the MAVLink 2 signing key."""

    def __post_init__(self) -> None:
        """Check what would otherwise be found out in the air."""
        if not 8 <= self.rate_hz <= 100:
            raise InputError(f"MavlinkConfig.rate_hz must be 8 to 100, but got {self.rate_hz}.")
        if not 4 <= self.stream_hz <= 200:
            raise InputError(f"MavlinkConfig.stream_hz must be 4 to 200, but got {self.stream_hz}.")
        if not 0 < self.fresh_s <= 0.5 or not 0 <= self.still_s <= 2.0:
            raise InputError("MavlinkConfig: fresh_s must be at most 0.5, still_s at most 2 seconds.")
