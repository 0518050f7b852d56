"""The operator lives: stands, breathes, steps, walks, faces the drone, and shows what the script says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.sim.feet import Feet
from wigwag.sim.gestures import Performance
from wigwag.sim.kinematics import CHANNEL, CHANNELS, blend, pose_body, rest
from wigwag.sim.person import JOINT, Person
from wigwag.sim.recorded import Replay
from wigwag.sim.script import Act, Script

FACING_RATE_S = 3.0
"""How quickly the operator turns to face the drone: the critically damped loop's 1/s."""
_TURN_RATE_MAX_RAD_S = 2.0


@dataclass(frozen=True, slots=True)
class BodyState:
    """All that a body's pose follows from, at one moment."""

    channels: Float[np.ndarray, " channels"]
    root_xy: Float[np.ndarray, 2]
    heading_rad: float
    feet: Float[np.ndarray, "2 4"]


class Operator:
    """A simulated person who plays a script in front of a drone.

    The script decides what is shown and where the person walks; only the direction in which the person
    faces follows the drone. Call ``step`` with time running forward.

    Args:
        person: Whose body and habits.
        script: What to do; times are seconds since the session began.
        position_m: Where the operator stands at first, x and y, world ENU.
        heading_rad: Where the operator faces at first, anticlockwise from east.
        seed: Chooses sway, trembling and the like.
        turned_rad: How far past the drone the operator faces, positive to the operator's left.
        turns_s: When the operator turns so far; before, they face the drone. 0: they stand so from the first.

    Example:
        >>> from wigwag.sim.script import plan_session
        >>> person = Person.random(5)
        >>> operator = Operator(person, plan_session(person, seed=1), position_m=(4.0, 0.0))
        >>> operator.step(0.0, 1 / 30, np.array([0.0, 0.0, 1.5])).shape
        (20, 3)
    """

    def __init__(
        self,
        person: Person,
        script: Script,
        position_m: tuple[float, float] = (4.0, 0.0),
        heading_rad: float = np.pi,
        seed: int = 0,
        *,
        turned_rad: float = 0.0,
        turns_s: float = 0.0,
    ) -> None:
        self.person = person
        self.script = script
        self.root_xy = np.array(position_m, dtype=np.float64)
        self.velocity_m_s = np.zeros(2)
        self.heading_rad = float(heading_rad) + (turned_rad if turns_s <= 0 else 0.0)
        self._turned_rad, self._turns_s = turned_rad, turns_s
        self._turn_rate = 0.0
        self._rest = rest(person)
        self._idle = _Idle(person, np.random.default_rng([0x1D1E, person.seed, seed]))
        self._feet = Feet(person, self.root_xy, self.heading_rad)
        self._drop = np.array([0.0, 0.0])  # pelvis lowered for the reach of the legs, and its rate
        self._act = 0
        self._walk = 0
        self._anchor: tuple[np.ndarray, float] | None = None  # where and how a recording is placed
        self._last_s: float | None = None

    def step(
        self, t_s: float, dt_s: float, drone_position_m: Float[np.ndarray, 3]
    ) -> Float[np.ndarray, "20 3"]:
        """Go on to time ``t_s`` and return the body.

        Args:
            t_s: Seconds since the session began.
            dt_s: Seconds since the step before.
            drone_position_m: World ENU; the operator turns to face it.

        Returns:
            Kinect-20 joints, metres, world ENU, the ground at z = 0.

        Raises:
            InputError: If time does not run forward.
        """
        state = self.advance(t_s, dt_s, drone_position_m)
        joints = np.asarray(pose_states(self.person, [state])[0])
        act = self._acting(t_s)
        if act is None or not isinstance(act.motion, Replay):
            self._anchor = None
            return joints
        return self._replayed(act.motion, t_s - act.start_s, joints)

    def advance(self, t_s: float, dt_s: float, drone_position_m: Float[np.ndarray, 3]) -> BodyState:
        """Go on to time ``t_s`` without posing the body; ``pose_states`` poses many at once.

        Recordings are not in the state; use ``step`` for scripts that hold any.
        """
        if dt_s <= 0 or (self._last_s is not None and t_s <= self._last_s):
            raise InputError(
                f"Operator.step needs time to run forward, but got t_s={t_s} with dt_s={dt_s} after "
                f"t_s={self._last_s}. Make a new Operator to start again."
            )
        self._last_s = t_s
        turn = self._move(t_s, dt_s, np.asarray(drone_position_m, dtype=np.float64)[:2])
        self._face(dt_s, np.asarray(drone_position_m, dtype=np.float64)[:2], turn)
        feet = self._feet.step(dt_s, self.root_xy, self.velocity_m_s, self.heading_rad, self._turn_rate)
        channels = self._rest + self._idle.at(t_s)
        act = self._acting(t_s)
        if act is not None and isinstance(act.motion, Performance):
            channels = channels + act.motion.at(t_s - act.start_s)
        ahead = self._feet.stride(self.heading_rad)  # left ahead of right, metres
        channels[CHANNEL["left_swing"]] -= 0.55 * ahead
        channels[CHANNEL["right_swing"]] += 0.55 * ahead
        channels[CHANNEL["pelvis_yaw"]] -= 0.22 * ahead
        channels[CHANNEL["twist"]] += 0.40 * ahead
        channels[CHANNEL["lean_forward"]] += 0.05 * float(
            self.velocity_m_s @ [np.cos(self.heading_rad), np.sin(self.heading_rad)]
        )
        channels[CHANNEL["pelvis_down"]] += self._lower(dt_s, feet)
        return BodyState(channels, self.root_xy.copy(), self.heading_rad, feet)

    def _acting(self, t_s: float) -> Act | None:
        """Return the act of this moment."""
        acts = self.script.acts
        while self._act < len(acts) and acts[self._act].end_s <= t_s:
            self._act += 1
        if self._act < len(acts) and acts[self._act].start_s <= t_s:
            return acts[self._act]
        return None

    def _move(self, t_s: float, dt_s: float, drone_xy: Float[np.ndarray, 2]) -> float:
        """Walk on; return how far the body wants to turn away from the drone, radians."""
        walks = self.script.walks
        while self._walk < len(walks) and walks[self._walk].start_s + walks[self._walk].duration_s <= t_s:
            self._walk += 1
        if self._walk == len(walks):
            self.velocity_m_s = np.zeros(2)
            return 0.0
        walk = walks[self._walk]
        # The midpoint rule keeps the path the same whatever the step.
        self.velocity_m_s = walk.velocity(t_s - dt_s / 2)
        if walk.from_drone:
            span = self.root_xy - drone_xy
            c, s = span / max(float(np.hypot(*span)), 1e-6)
            self.velocity_m_s = np.array([[c, -s], [s, c]]) @ self.velocity_m_s
        self.root_xy = self.root_xy + self.velocity_m_s * dt_s
        left_s = walk.start_s + walk.duration_s - t_s
        if walk.turn == 0 or t_s < walk.start_s or left_s < 0.45:
            return 0.0
        away = wrap(walk.direction_rad - self.heading_rad)
        return max(-1.0, min(1.0, walk.turn * away))

    def _face(self, dt_s: float, drone_xy: Float[np.ndarray, 2], turn: float) -> None:
        """Turn to the drone: second order and critically damped, so that the heading has no corners."""
        span = drone_xy - self.root_xy
        if np.hypot(*span) < 0.3:  # overhead: there is no direction to face
            error = 0.0
        else:
            past = turn + (self._turned_rad if (self._last_s or 0.0) >= self._turns_s else 0.0)
            error = wrap(float(np.arctan2(span[1], span[0])) + past - self.heading_rad)
        self._turn(error, dt_s)

    def _turn(self, error: float, dt_s: float) -> None:
        """Turn by ``error`` radians, as far as that goes in ``dt_s``."""
        acceleration = FACING_RATE_S**2 * error - 2 * FACING_RATE_S * self._turn_rate
        rate = self._turn_rate + dt_s * max(-8.0, min(8.0, acceleration))
        self._turn_rate = max(-_TURN_RATE_MAX_RAD_S, min(_TURN_RATE_MAX_RAD_S, rate))
        self.heading_rad += self._turn_rate * dt_s

    def _lower(self, dt_s: float, feet: Float[np.ndarray, "2 4"]) -> float:
        """Lower the pelvis so that the legs reach the feet, smoothly."""
        person = self.person
        need = 0.0
        for foot in feet:
            away = float(np.hypot(*(foot[:2] - self.root_xy))) - person.hip_half_m
            reach = 0.992 * person.leg_m
            height = np.sqrt(max(reach**2 - max(away, 0.0) ** 2, 0.0)) + foot[2]
            need = max(need, 0.988 * person.leg_m - height)
        rate_s = 14.0
        acceleration = rate_s**2 * (need - self._drop[0]) - 2 * rate_s * self._drop[1]
        self._drop[1] += acceleration * min(dt_s, 0.05)
        self._drop[0] += self._drop[1] * min(dt_s, 0.05)
        return float(self._drop[0])

    def _replayed(self, motion: Replay, since_s: float, standing: np.ndarray) -> Float[np.ndarray, "20 3"]:
        """Put the recording where the operator stands, facing as the operator faces when it begins."""
        if self._anchor is None:
            self._anchor = (self.root_xy.copy(), self.heading_rad)
        origin, heading = self._anchor
        c, s = np.cos(heading), np.sin(heading)
        turned = motion.at(since_s) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        placed = turned + np.array([origin[0], origin[1], 0.0])
        weight = motion.weight(since_s)
        if weight >= 1.0:
            # Whatever the recording does with the feet, standing goes on from where it leaves them.
            hips = (placed[JOINT["left_hip"]] + placed[JOINT["right_hip"]]) / 2
            self.root_xy = hips[:2].copy()
            self._feet.place(placed[[JOINT["left_ankle"], JOINT["right_ankle"]], :2])
            return np.asarray(placed)
        return blend(standing, placed, weight)


class _Idle:
    """What a body does when it does nothing: breath, shift of weight, small wandering, trembling."""

    _WAVES = (
        # channel, amplitude (rad or m; sway_m and tremor_rad scale theirs), lowest and highest Hz
        ("lean_forward", 0.006, 0.20, 0.32),  # breath
        ("left_shrug", 0.008, 0.20, 0.32),
        ("right_shrug", 0.008, 0.20, 0.32),
        ("lean_left", 0.012, 0.05, 0.30),
        ("twist", 0.020, 0.05, 0.25),
        ("nod", 0.030, 0.05, 0.40),
        ("tilt", 0.025, 0.05, 0.40),
        ("left_raise", 0.020, 0.05, 0.40),
        ("right_raise", 0.020, 0.05, 0.40),
        ("left_bend", 0.035, 0.05, 0.40),
        ("right_bend", 0.035, 0.05, 0.40),
        ("left_swing", 0.020, 0.05, 0.40),
        ("right_swing", 0.020, 0.05, 0.40),
    )

    def __init__(self, person: Person, rng: np.random.Generator) -> None:
        waves = [
            *self._WAVES,
            ("pelvis_left", person.sway_m, 0.08, 0.30),
            ("pelvis_forward", 0.5 * person.sway_m, 0.08, 0.40),
            *((f"{side}_{name}", person.tremor_rad, 4.0, 7.0) for side in ("left", "right")
              for name in ("raise", "swing", "bend")),
        ]  # fmt: skip
        n_each = 3  # sinusoids a channel
        self._gain = np.zeros((len(CHANNELS), len(waves) * n_each))
        rates = []
        for i, (channel, amplitude, low, high) in enumerate(waves):
            for j in range(n_each):
                self._gain[CHANNEL[channel], i * n_each + j] = (
                    amplitude * rng.uniform(0.4, 1.0) / np.sqrt(n_each)
                )
                rates.append(rng.uniform(low, high))
        self._omega = 2 * np.pi * np.array(rates)
        self._phase = rng.uniform(0, 2 * np.pi, len(rates))

    def at(self, t_s: float) -> Float[np.ndarray, " channels"]:
        return np.asarray(self._gain @ np.sin(self._omega * t_s + self._phase))


def pose_states(person: Person, states: list[BodyState]) -> Float[np.ndarray, "n 20 3"]:
    """Pose many moments of one person's body at once."""
    return pose_body(
        person,
        np.stack([state.channels for state in states]),
        np.stack([state.root_xy for state in states]),
        np.array([state.heading_rad for state in states]),
        np.stack([state.feet for state in states]),
    )


def play(
    operator: Operator,
    rate_hz: float = 30.0,
    drone: Callable[[float], Float[np.ndarray, 3]] = lambda t_s: np.array([0.0, 0.0, 1.5]),
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, "n 20 3"]]:
    """Play a whole script of procedural gestures without a renderer.

    Args:
        operator: A new operator.
        rate_hz: Moments a second.
        drone: Where the drone is at a time.

    Returns:
        Times in seconds and the joints (metres, world ENU).
    """
    times = np.arange(1, int(operator.script.duration_s * rate_hz) + 1) / rate_hz
    if any(isinstance(act.motion, Replay) for act in operator.script.acts):
        return times, np.stack([operator.step(float(t), 1 / rate_hz, drone(float(t))) for t in times])
    states = [operator.advance(float(t), 1 / rate_hz, drone(float(t))) for t in times]
    return times, pose_states(operator.person, states)


def wrap(angle: float) -> float:
    """Bring an angle into -pi to pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
