"""PX4 and ArduPilot Copter: the same requests, in each one's own words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from wigwag.errors import VehicleError
from wigwag.fly.values import Setpoint
from wigwag.vehicles.mavlink.dialect import TAKES_VELOCITY
from wigwag.vehicles.mavlink.frames import body_to_ned, flip
from wigwag.vehicles.mavlink.telemetry import Telemetry

ARDUPILOT, PX4 = 3, 12
"""MAV_AUTOPILOT."""
_LOCAL_NED, _BODY_OFFSET_NED = 1, 9
"""MAV_FRAME."""


class Doing(Enum):
    """What an autopilot's own flight mode means here."""

    STEER = "steer"
    """Follows set-points of a companion computer."""
    HOLD = "hold"
    TAKE_OFF = "take off"
    LAND = "land"
    OTHER = "other"
    """Flown by sticks, a mission, on the way home: nothing that is asked for here."""


@dataclass(frozen=True, slots=True)
class CommandRequest:
    """A MAV_CMD with its seven parameters."""

    command: int
    what: str
    """For people to read."""
    params: tuple[float, ...]


class Autopilot(Protocol):
    """How one kind of autopilot wants to be talked to."""

    name: str
    steer_mode: int
    hold_mode: int
    land_mode: int
    arm_mode: int
    """Mode in which it can be armed and then told to take off."""
    stream_first_s: float
    """How long set-points must flow before it follows them."""
    prearm_present: bool
    """See ``Telemetry``."""

    def doing(self, custom_mode: int) -> Doing:
        """Say what a mode means."""
        ...

    def by_sticks(self, custom_mode: int) -> bool:
        """Say whether a pilot's sticks fly it in a mode."""
        ...

    def mode_name(self, custom_mode: int) -> str:
        """Return its own name of a mode."""
        ...

    def mode_params(self, custom_mode: int) -> tuple[float, ...]:
        """Return the parameters of DO_SET_MODE."""
        ...

    def take_off_params(self, height_m: float, telemetry: Telemetry) -> tuple[float, ...]:
        """Return the parameters of NAV_TAKEOFF for a height above where it stands.

        Raises:
            VehicleError: If it does not know where it stands.
        """
        ...

    def setpoint(self, mav: Any, target: tuple[int, int], setpoint: Setpoint, heading_rad: float) -> Any:
        """Return the message of a set-point; the sender's time stays 0, as no autopilot reads it."""
        ...


def _set_mode(main: float, sub: float = 0.0) -> tuple[float, ...]:
    return (1.0, main, sub, 0.0, 0.0, 0.0, 0.0)  # 1: MAV_MODE_FLAG_CUSTOM_MODE_ENABLED


class Px4:
    """PX4, 1.13 and later."""

    name = "PX4"
    steer_mode = 6 << 16
    hold_mode = 4 << 16 | 3 << 24
    take_off_mode = 4 << 16 | 2 << 24
    land_mode = 4 << 16 | 6 << 24
    arm_mode = hold_mode
    stream_first_s = 1.1
    """It wants set-points for more than a second, at 2 Hz at least (docs.px4.io, Offboard Mode)."""
    prearm_present = False

    _DOING = {  # noqa: RUF012  a table, never changed
        steer_mode: Doing.STEER, hold_mode: Doing.HOLD, take_off_mode: Doing.TAKE_OFF, land_mode: Doing.LAND,
        4 << 16 | 9 << 24: Doing.LAND,
    }  # fmt: skip
    _NAMES = {  # noqa: RUF012
        1: "Manual", 2: "Altitude", 3: "Position", 5: "Acro", 6: "Offboard", 7: "Stabilized",
    }  # fmt: skip
    _AUTO = {  # noqa: RUF012
        2: "Takeoff", 3: "Hold", 4: "Mission", 5: "Return", 6: "Land", 8: "Follow", 9: "Precision land",
    }  # fmt: skip

    def doing(self, custom_mode: int) -> Doing:
        """Say what a mode means."""
        return self._DOING.get(custom_mode & 0xFFFF0000, Doing.OTHER)

    def by_sticks(self, custom_mode: int) -> bool:
        """Say whether a pilot's sticks fly it in a mode: in all but Auto and Offboard."""
        return custom_mode >> 16 & 255 not in (4, 6)

    def mode_name(self, custom_mode: int) -> str:
        """Return its own name of a mode."""
        main, sub = custom_mode >> 16 & 255, custom_mode >> 24 & 255
        return self._AUTO.get(sub, f"Auto {sub}") if main == 4 else self._NAMES.get(main, f"mode {main}")

    def mode_params(self, custom_mode: int) -> tuple[float, ...]:
        """Return the parameters of DO_SET_MODE."""
        return _set_mode(custom_mode >> 16 & 255, custom_mode >> 24 & 255)

    def take_off_params(self, height_m: float, telemetry: Telemetry) -> tuple[float, ...]:
        """Return the parameters of NAV_TAKEOFF: its altitude counts from the sea; the rest is 'as it is'."""
        if not math.isfinite(telemetry.amsl_m):
            raise VehicleError(
                "PX4 takes off to an altitude above the sea and has not said at which it stands "
                "(GLOBAL_POSITION_INT): wait for its position, or give it an origin."
            )
        nan = math.nan
        return (nan, 0.0, 0.0, nan, nan, nan, telemetry.amsl_m + height_m)

    def setpoint(self, mav: Any, target: tuple[int, int], setpoint: Setpoint, heading_rad: float) -> Any:
        """Return the set-point in LOCAL_NED: BODY_NED was turned by the whole tilt up to PX4 1.13."""
        velocity = body_to_ned(setpoint.velocity_m_s, heading_rad)
        return _velocity(mav, target, _LOCAL_NED, velocity, -setpoint.yaw_rate_rad_s)


class ArduCopter:
    """ArduPilot Copter, 4.0 and later."""

    name = "ArduPilot"
    steer_mode = 4
    hold_mode = 17
    """BRAKE: LOITER would listen to a throttle stick that may not be there, and sink."""
    land_mode = 9
    arm_mode = steer_mode
    stream_first_s = 0.0
    prearm_present = True

    _DOING = {  # noqa: RUF012
        steer_mode: Doing.STEER, hold_mode: Doing.HOLD, land_mode: Doing.LAND,
    }  # fmt: skip
    _NAMES = {  # noqa: RUF012
        0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 5: "LOITER", 6: "RTL",
        7: "CIRCLE", 9: "LAND", 11: "DRIFT", 13: "SPORT", 15: "AUTOTUNE", 16: "POSHOLD", 17: "BRAKE",
        18: "THROW", 20: "GUIDED_NOGPS", 21: "SMART_RTL", 27: "AUTO_RTL",
    }  # fmt: skip

    _STICKS = frozenset({0, 1, 2, 5, 11, 13, 14, 15, 16, 22, 24, 26, 28})
    """STABILIZE, ACRO, ALT_HOLD, LOITER, DRIFT, SPORT, FLIP, AUTOTUNE, POSHOLD, FLOWHOLD, ZIGZAG, AUTOROTATE,
    TURTLE."""

    def doing(self, custom_mode: int) -> Doing:
        """Say what a mode means."""
        return self._DOING.get(custom_mode, Doing.OTHER)

    def by_sticks(self, custom_mode: int) -> bool:
        """Say whether a pilot's sticks fly it in a mode."""
        return custom_mode in self._STICKS

    def mode_name(self, custom_mode: int) -> str:
        """Return its own name of a mode."""
        return self._NAMES.get(custom_mode, f"mode {custom_mode}")

    def mode_params(self, custom_mode: int) -> tuple[float, ...]:
        """Return the parameters of DO_SET_MODE."""
        return _set_mode(custom_mode)

    def take_off_params(self, height_m: float, telemetry: Telemetry) -> tuple[float, ...]:
        """Return the parameters of NAV_TAKEOFF: its altitude counts from home, which may lie elsewhere."""
        above_home = telemetry.relative_m if math.isfinite(telemetry.relative_m) else 0.0
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height_m + above_home)

    def setpoint(self, mav: Any, target: tuple[int, int], setpoint: Setpoint, heading_rad: float) -> Any:
        """Return the set-point in BODY_OFFSET_NED: the autopilot turns it by the heading of the moment."""
        velocity = flip(*setpoint.velocity_m_s)
        return _velocity(mav, target, _BODY_OFFSET_NED, velocity, -setpoint.yaw_rate_rad_s)


def _velocity(
    mav: Any, target: tuple[int, int], frame: int, velocity: tuple[float, float, float], yaw_rate: float
) -> Any:
    return mav.set_position_target_local_ned_encode(
        0, *target, frame, TAKES_VELOCITY, 0, 0, 0, *velocity, 0, 0, 0, 0, yaw_rate
    )


def autopilot_of(kind: int) -> Autopilot | None:
    """Return how to talk to an autopilot, by the ``autopilot`` field of its heartbeat; None if unknown."""
    if kind == PX4:
        return Px4()
    if kind == ARDUPILOT:
        return ArduCopter()
    return None


VEHICLES = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
"""MAV_TYPE of what hovers: quadrotor, coaxial, helicopter, hexa-, octo-, tri-, dodeca-, decarotor."""
