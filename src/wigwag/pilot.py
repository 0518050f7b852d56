"""The one loop in which everything meets: frame, pose, gesture, command, set-point."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from wigwag.camera import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.fly.follow import FollowConfig, Goal, wrap
from wigwag.fly.helm import Helm
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.movements import MovementConfig
from wigwag.fly.operator import Mount, OperatorTrack, TrackConfig, rotation
from wigwag.fly.situation import Action, Craft, Mode, Permit, Situation, Verdict
from wigwag.fly.supervisor import Supervisor
from wigwag.fly.values import Command, Setpoint, VehicleState
from wigwag.fly.view import View
from wigwag.gesture import Gesture
from wigwag.skeleton import Pose
from wigwag.stream.listener import Listener, listening
from wigwag.stream.segment import arms_down
from wigwag.stream.spot import Recogniser, SpotConfig
from wigwag.vehicles.protocol import AIRBORNE, FlightMode, Vehicle

if TYPE_CHECKING:
    from wigwag.stream.gesture_stream import StreamModel
    from wigwag.stream.moments import MomentModel


class PoseSource(Protocol):
    """Anything that finds the operator in a frame."""

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the operator's 3-D pose, or ``None`` when nobody is found."""
        ...


class Somebody(Protocol):
    """Whoever commands, as a pose source knows them."""

    @property
    def number(self) -> int:
        """Who; never given twice."""
        ...


@runtime_checkable
class Engaging(Protocol):
    """A pose source that knows who commands, also while they are not seen."""

    @property
    def operator(self) -> Somebody | None:
        """Who commands; ``None``: nobody."""
        ...


@dataclass(frozen=True, slots=True)
class PilotConfig:
    """Everything about flying that can be set."""

    goal: Goal = field(default_factory=Goal)
    mount: Mount = field(default_factory=Mount)
    track: TrackConfig = field(default_factory=TrackConfig)
    follow: FollowConfig = field(default_factory=FollowConfig)
    movement: MovementConfig = field(default_factory=MovementConfig)
    supervisor: SupervisorConfig = field(default_factory=SupervisorConfig)
    spot: SpotConfig = field(default_factory=SpotConfig)

    def __post_init__(self) -> None:
        """Check that no movement leads where the supervisor stops it.

        Raises:
            InputError: If the movements' bounds, or the goal, lie outside the supervisor's limits.
        """
        goal, bounds, limits = self.goal, self.movement, self.supervisor
        for what, value, least, most in (
            ("distance_m", goal.distance_m, bounds.min_distance_m, bounds.max_distance_m),
            ("altitude_m", goal.altitude_m, bounds.min_altitude_m, bounds.max_altitude_m),
            ("min_distance_m", bounds.min_distance_m, limits.min_distance_m, bounds.max_distance_m),
            ("max_distance_m", bounds.max_distance_m, bounds.min_distance_m, limits.max_distance_m),
            ("min_altitude_m", bounds.min_altitude_m, limits.floor_m, bounds.max_altitude_m),
            ("max_altitude_m", bounds.max_altitude_m, bounds.min_altitude_m, limits.ceiling_m),
        ):
            if not least <= value <= most:
                raise InputError(
                    f"PilotConfig: {what} is {value}, but has to be from {least} to {most}. The goal lies "
                    "within the movements' bounds, and those within the supervisor's limits; change either."
                )


@dataclass(frozen=True, slots=True)
class Step:
    """What one turn of the loop saw, decided and sent."""

    pose: Pose | None
    """As measured, camera optical frame."""
    movement: Pose | None
    """The same without the drone's tilt, turn and climb: what the spotter saw."""
    gesture: Gesture | None
    command: Command | None
    """What the gesture asks for; whether it was obeyed is in ``verdict``."""
    situation: Situation
    """What the supervisor was told."""
    verdict: Verdict
    """What it decided."""
    wish: Setpoint
    """What the follow law would have liked to send."""
    permit: Permit
    """What was sent."""
    goal: Goal
    state: VehicleState
    pose_s: float
    """Processor seconds for finding the pose."""
    rest_s: float
    """Processor seconds for everything after it."""


class Pilot:
    """Turns frames into set-points, and gestures into commands on the way.

    Args:
        pose: Finds the operator in a frame.
        recogniser: A model of streams, or what names whole clips.
        vehicle: What is flown. One that hovers already is taken over as it is.
        commands: Which command each gesture label stands for; labels not listed command nothing.
        config: Everything that can be set.
        clock: Processor time for the timings; never used for decisions.
        time_ns: The clock of the stamps, where it goes on while the pose is looked for; what is decided
            afterwards is decided at its time. By default at the time that ``step`` is given.
        in_the_air: What a vehicle that hovers already is taken over with: followed at once, or held until
            the first command.
    """

    def __init__(
        self,
        pose: PoseSource,
        recogniser: StreamModel | MomentModel | Recogniser,
        vehicle: Vehicle,
        *,
        commands: Mapping[str, Command] | None = None,
        config: PilotConfig | None = None,
        clock: Callable[[], float] = time.thread_time,
        time_ns: Callable[[], int] | None = None,
        in_the_air: Mode = Mode.FOLLOWING,
    ) -> None:
        self.config = config or PilotConfig()
        self.pose, self.vehicle, self.clock, self.time_ns = pose, vehicle, clock, time_ns
        self.commands = commands if commands is not None else {c.value: c for c in Command}
        self.spotter: Listener = listening(recogniser, self.config.spot)
        self.track = OperatorTrack(self.config.track, self.config.mount)
        self.helm = Helm(self.config.goal, self.config.follow, self.config.movement)
        mode = in_the_air if vehicle.mode in AIRBORNE else Mode.DISARMED
        self.supervisor = Supervisor(self.config.supervisor, mode)
        self.trouble = ""
        """The last complaint about a frame or a recogniser, for people to read."""
        self.withheld = False
        """Whether somebody at the console keeps the drone where it is: gestures but for stop and land are
        refused."""
        self.calls = 0
        """How often somebody at the console has called for an operator."""
        self._lens: Intrinsics | None = None
        self._camera_ns: int | None = None
        self._rested_ns: int | None = None
        self._deaf_ns: int | None = None
        self._number: int | None = None
        """Who commanded last, as the pose source counts."""
        self._engaged_ns: int | None = None
        self._swapped = 0
        """How often somebody else took command."""

    def step(self, frame: Frame | None, now_ns: int, asked: Command | None = None) -> Step:
        """Run the loop once.

        Args:
            frame: The newest frame, or ``None`` if the camera has none: the clock goes on, and an
                operator not seen for too long is lost.
            now_ns: Monotonic nanoseconds, the clock of the frame's and the vehicle's stamps.
            asked: What somebody at the console asks for; it comes before what a gesture asks for, and
                counts as confirmed.
        """
        began = self.clock()
        self.vehicle.beat(now_ns)
        pose = None if frame is None else self._find(frame, now_ns)
        seen = self.clock()
        if self.time_ns is not None:
            now_ns = self.time_ns()
        state = self.vehicle.state
        self.track.observe_vehicle(state)
        own = pose is not None and self.track.observe(pose)
        movement = self._level(pose) if pose is not None and own else None
        gesture = self._hear(movement, now_ns)
        command = None if gesture is None or gesture.label is None else self.commands.get(gesture.label)
        held_s = np.inf if asked is not None else 0.0 if gesture is None else _held_s(gesture)
        self._note_operator(now_ns)
        situation, verdict, wish, sent = self._fly(asked or command, held_s, state, now_ns)
        done = self.clock()
        return Step(
            pose, movement, gesture, command, situation, verdict, wish, sent, self.helm.movement.goal, state,
            seen - began, done - seen,
        )  # fmt: skip

    def tighten(self, situation: Situation, name: str, value: float) -> str:
        """Set one of the supervisor's limits anew, and keep goal and movements within; return why not.

        Args:
            situation: The newest step's.
            name: One of ``wigwag.fly.tighten.DIALS``.
            value: In its unit.
        """
        why = self.supervisor.tighten(situation, name, value)
        self.helm.keep_within(self.supervisor.config)
        return why

    def _find(self, frame: Frame, now_ns: int) -> Pose | None:
        """Find the operator; a frame that cannot be used (no depth, out of order) is one without a pose."""
        try:
            pose = self.pose(frame)
        except Exception as error:  # whatever it is: a network that fails must not end the loop that flies
            self.trouble = str(error)
            return None
        self._camera_ns = now_ns
        if frame.intrinsics != self._lens:
            self._lens, bounds = frame.intrinsics, self.config.movement
            self.helm.look(
                View.through(
                    frame.intrinsics, self.config.mount, bounds.above_hips_m, bounds.below_hips_m,
                    bounds.view_margin_rad,
                )
            )  # fmt: skip
        return pose

    def _hear(self, movement: Pose | None, now_ns: int) -> Gesture | None:
        """Listen; a recogniser that fails has heard nothing, and the supervisor is told."""
        if movement is not None and arms_down(movement):
            self._rested_ns = now_ns
        try:
            gesture = self.spotter.update(movement)
        except Exception as error:  # as above
            self.trouble = f"the recogniser failed: {error}"
            self._deaf_ns = self._deaf_ns or now_ns
            return None
        if gesture is not None:
            self._deaf_ns = None
        return gesture

    def _note_operator(self, now_ns: int) -> None:
        """Note since when somebody has been the operator, and whether it is somebody else."""
        if not isinstance(self.pose, Engaging):
            self._engaged_ns = self.track.since_ns
            return
        operator = self.pose.operator
        if operator is None:
            self._engaged_ns = None
        elif self._engaged_ns is None or operator.number != self._number:
            self._engaged_ns = now_ns
            self._swapped += self._number is not None and operator.number != self._number
            self._number = operator.number

    def _level(self, pose: Pose) -> Pose:
        """Take the drone's tilt, turn and climb out of a pose: what is left is the operator's own movement.

        The result stays in an optical frame (y down, from the height at which the vehicle started), level,
        looking along the line of sight to the track. How far the operator is ahead and aside stays as the
        drone saw it: recognisers for drones take the hips' path out of that, but not out of the height, by
        which a squat is known.
        """
        state = self.track.state_at(pose.stamp_ns)
        body = np.stack([self.config.mount.to_body(joint) for joint in pose.joints])
        world = body @ rotation(state).T
        world[:, 2] += state.position_m[2]
        sight = self.track.position_m(pose.stamp_ns) - state.position_m
        angle = float(np.arctan2(sight[1], sight[0]))
        cos, sin = np.cos(angle), np.sin(angle)
        ahead = cos * world[:, 0] + sin * world[:, 1]
        left = -sin * world[:, 0] + cos * world[:, 1]
        return replace(pose, joints=np.stack([-left, -world[:, 2], ahead], axis=1))

    def _fly(
        self, command: Command | None, held_s: float, state: VehicleState, now_ns: int
    ) -> tuple[Situation, Verdict, Setpoint, Permit]:
        """Decide, and let the vehicle know in the same turn: first the set-point, then what is asked."""
        before, track = self.supervisor.mode, self.track
        situation = self._situation(command, held_s, state, now_ns)
        verdict = self.supervisor.step(situation)
        if told := self.helm.enter(before, verdict, track, state):
            verdict = replace(verdict, reason=told)
        wish = self.helm.wish(verdict.mode, track, state, now_ns)
        sent = self.supervisor.permit(situation, wish)
        if sent.setpoint is not None:
            self.vehicle.send(sent.setpoint, now_ns)
        match verdict.action:
            case Action.ARM:
                self.vehicle.arm()
            case Action.TAKE_OFF:
                self.vehicle.take_off(self.config.goal.altitude_m)
            case Action.LAND:
                self.vehicle.land()
            case Action.HOLD:
                self.vehicle.hold()
            case Action.NONE:
                pass
        return situation, verdict, wish, sent

    def _situation(
        self, command: Command | None, held_s: float, state: VehicleState, now_ns: int
    ) -> Situation:
        """Say all that is known as plain values."""
        track = self.track
        sight = (track.position_m(now_ns) - state.position_m)[:2]
        known = track.seen_ns is not None
        east, north, up = (float(v) for v in state.position_m)
        return Situation(
            now_ns,
            CRAFT[self.vehicle.mode],
            state.stamp_ns,
            state.stamp_ns if state.link_ns is None else state.link_ns,
            (east, north, up),
            state.heading_rad,
            state.battery,
            state.healthy,
            self._camera_ns,
            track.seen_ns,
            float(np.hypot(sight[0], sight[1])) if known else None,
            wrap(float(np.arctan2(sight[1], sight[0])) - state.heading_rad),
            track.person + self._swapped,
            self._engaged_ns,
            self._rested_ns,
            self._deaf_ns,
            self.helm.moving,
            command,
            held_s,
            self.withheld,
        )


CRAFT: dict[FlightMode, Craft] = {
    FlightMode.DISARMED: Craft.DOWN,
    FlightMode.READY: Craft.ARMED,
    FlightMode.TAKING_OFF: Craft.CLIMBING,
    FlightMode.HOLDING: Craft.AIRBORNE,
    FlightMode.STEERED: Craft.AIRBORNE,
    FlightMode.LANDING: Craft.SINKING,
    FlightMode.MANUAL: Craft.PILOTED,
    FlightMode.FAILSAFE: Craft.OWN,
}
"""What a vehicle's mode means to the supervisor."""


def _held_s(gesture: Gesture) -> float:
    """Return how long the movement was that was judged, seconds."""
    until_ns = min(gesture.end_ns or gesture.decided_ns, gesture.decided_ns)
    return max(0.0, (until_ns - gesture.onset_ns) * 1e-9)


__all__ = ["CRAFT", "Pilot", "PilotConfig", "PoseSource", "Step"]
