"""The autopilot of a simulated drone: arming, take-off, landing, hover, and a dead man's switch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from wigwag.errors import InputError
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.vehicles.protocol import Capabilities, FlightMode


class Airframe(Protocol):
    """What flies: a velocity loop over a body, for example ``wigwag.sim.quadrotor.Quadrotor``."""

    @property
    def measured(self) -> VehicleState:
        """What the drone believes of itself."""
        ...

    @property
    def on_ground(self) -> bool:
        """Whether a skid touches the ground."""
        ...

    def step(self, setpoint: Setpoint, dt_s: float) -> None:
        """Fly on for ``dt_s`` seconds."""
        ...

    def set_motors(self, on: bool) -> None:
        """Start or stop the motors."""
        ...


@dataclass(frozen=True, slots=True)
class AutopilotConfig:
    """How the simulated autopilot behaves."""

    dead_man_s: float = 0.5
    """A set-point older than this is not flown: the vehicle stops and hovers."""
    climb_m_s: float = 0.7
    descend_m_s: float = 0.5
    touch_down_m_s: float = 0.25
    """Rate of descent below ``flare_m``."""
    flare_m: float = 0.5


_STILL = Setpoint()
_TAKES_SETPOINTS = (FlightMode.HOLDING, FlightMode.STEERED)
_ON_GROUND = (FlightMode.DISARMED, FlightMode.READY)


class SimulatedVehicle:
    """A ``Vehicle`` over a simulated airframe. Time comes from the airframe's own stamps.

    Args:
        airframe: What flies.
        config: How the autopilot behaves.
        airborne: Whether it hovers already.
    """

    def __init__(
        self, airframe: Airframe, config: AutopilotConfig | None = None, airborne: bool = False
    ) -> None:
        self.config = config or AutopilotConfig()
        self._airframe = airframe
        self._mode = FlightMode.HOLDING if airborne else FlightMode.DISARMED
        self._setpoint, self._sent_ns = _STILL, -1
        self._height_m = 0.0

    @property
    def mode(self) -> FlightMode:
        """What it is doing."""
        return self._mode

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""
        dead_man_s = self.config.dead_man_s
        return Capabilities("simulated quadrotor", dead_man_s, own_timeout_s=dead_man_s)

    @property
    def warnings(self) -> tuple[str, ...]:
        """None."""
        return ()

    def connect(self) -> None:
        """Nothing to reach: it lives in this process."""

    def close(self) -> None:
        """Hold, if it is steered."""
        if self._mode is FlightMode.STEERED:
            self.hold()

    def beat(self, now_ns: int) -> None:
        """Nothing to keep alive: the set-points' own age is watched."""

    @property
    def state(self) -> VehicleState:
        """What the drone believes of itself."""
        return self._airframe.measured

    def arm(self) -> bool:
        """Start the motors; refused in the air."""
        if self._mode not in _ON_GROUND:
            return False
        self._airframe.set_motors(True)
        self._mode = FlightMode.READY
        return True

    def take_off(self, height_m: float = 1.5) -> bool:
        """Climb to ``height_m`` above the ground; refused unless armed and on the ground.

        Raises:
            InputError: If the height is not positive.
        """
        if not height_m > 0:
            raise InputError(f"take_off needs a height above 0 m, but got {height_m}.")
        if self._mode is not FlightMode.READY:
            return False
        self._height_m = height_m
        self._mode = FlightMode.TAKING_OFF
        return True

    def land(self) -> bool:
        """Come down on the spot and stop the motors; refused on the ground."""
        if self._mode in _ON_GROUND:
            return False
        self._mode = FlightMode.LANDING
        return True

    def hold(self) -> bool:
        """Stop and hover, also out of a take-off or a landing; refused on the ground."""
        if self._mode in _ON_GROUND:
            return False
        self._mode = FlightMode.HOLDING
        return True

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        """Take a set-point; it is flown from now until it is ``dead_man_s`` old."""
        if self._mode not in _TAKES_SETPOINTS or not self._fresh(stamp_ns):
            return False
        self._setpoint, self._sent_ns = setpoint, stamp_ns
        self._mode = FlightMode.STEERED
        return True

    def step(self, dt_s: float) -> None:
        """Let the autopilot fly on for ``dt_s`` seconds. The world calls this, the pilot does not."""
        if self._mode is FlightMode.STEERED and not self._fresh(self._sent_ns):
            self._mode = FlightMode.HOLDING
        self._airframe.step(self._wanted(), dt_s)
        height = float(self.state.position_m[2])
        if self._mode is FlightMode.TAKING_OFF and height > self._height_m - 0.05:
            self._mode = FlightMode.HOLDING
        elif self._mode is FlightMode.LANDING and self._airframe.on_ground:
            self._airframe.set_motors(False)
            self._mode = FlightMode.DISARMED

    def _fresh(self, stamp_ns: int) -> bool:
        return self.state.stamp_ns - stamp_ns <= self.config.dead_man_s * 1e9

    def _wanted(self) -> Setpoint:
        """Set-point of the moment."""
        c, height = self.config, float(self.state.position_m[2])
        if self._mode is FlightMode.STEERED:
            return self._setpoint
        if self._mode is FlightMode.TAKING_OFF:
            return Setpoint((0.0, 0.0, min(c.climb_m_s, 0.15 + 1.5 * max(0.0, self._height_m - height))))
        if self._mode is FlightMode.LANDING:
            return Setpoint((0.0, 0.0, -(c.descend_m_s if height > c.flare_m else c.touch_down_m_s)))
        if self._mode is FlightMode.READY:
            return Setpoint((0.0, 0.0, -1.0))  # keeps it pressed to the ground
        return _STILL
