"""The one loop in which everything meets: frame, pose, gesture, command, set-point."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from wigwag.camera import Frame
from wigwag.errors import InputError
from wigwag.fly.follow import FollowConfig, FollowLaw, Goal, wrap
from wigwag.fly.movements import Movement, MovementConfig
from wigwag.fly.operator import Mount, OperatorTrack, TrackConfig, rotation
from wigwag.fly.supervisor import Action, Mode, Situation, Supervisor, SupervisorConfig, Verdict
from wigwag.fly.values import HOVER, Command, Setpoint, VehicleState
from wigwag.gesture import Gesture
from wigwag.skeleton import Pose
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.listener import Listener, listening
from wigwag.stream.spot import Recogniser, SpotConfig
from wigwag.vehicles.protocol import FlightMode, Vehicle


class PoseSource(Protocol):
    """Anything that finds the operator in a frame."""

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the operator's 3-D pose, or ``None`` when nobody is found."""
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
    rest_between_s: float = 1.0
    """Commands are taken at most this often; stop and land always."""


@dataclass(frozen=True, slots=True)
class Step:
    """What one turn of the loop saw, decided and sent."""

    pose: Pose | None
    """As measured, camera optical frame."""
    movement: Pose | None
    """The same without the drone's tilt and turn: what the spotter saw."""
    gesture: Gesture | None
    command: Command | None
    verdict: Verdict
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
    """

    def __init__(
        self,
        pose: PoseSource,
        recogniser: StreamModel | Recogniser,
        vehicle: Vehicle,
        *,
        commands: Mapping[str, Command] | None = None,
        config: PilotConfig | None = None,
        clock: Callable[[], float] = time.thread_time,
    ) -> None:
        self.config = config or PilotConfig()
        self.pose, self.vehicle, self.clock = pose, vehicle, clock
        self.commands = commands if commands is not None else {c.value: c for c in Command}
        self.spotter: Listener = listening(recogniser, self.config.spot)
        self.track = OperatorTrack(self.config.track, self.config.mount)
        self.follow = FollowLaw(self.config.follow)
        self.movement = Movement(self.config.movement, self.config.goal)
        airborne = vehicle.mode in (FlightMode.HOLDING, FlightMode.STEERED)
        mode = Mode.FOLLOWING if airborne else Mode.GROUNDED
        self.supervisor = Supervisor(self.config.supervisor, mode)
        self.trouble = ""
        """The last complaint about a frame, for people to read."""
        self._last_ns: int | None = None
        self._commanded_ns: int | None = None

    def step(self, frame: Frame | None, now_ns: int) -> Step:
        """Run the loop once.

        Args:
            frame: The newest frame, or ``None`` if the camera has none: the clock goes on, and an
                operator not seen for too long is lost.
            now_ns: Monotonic nanoseconds, the clock of the frame's and the vehicle's stamps.
        """
        began = self.clock()
        pose = None if frame is None else self._find(frame)
        seen = self.clock()
        state = self.vehicle.state
        self.track.observe_vehicle(state)
        if pose is not None:
            self.track.observe(pose)
        movement = None if pose is None else self._level(pose)
        gesture = self.spotter.update(movement)
        command = self._command(gesture, now_ns)
        verdict = self._fly(command, state, now_ns)
        self._last_ns = now_ns
        done = self.clock()
        return Step(
            pose, movement, gesture, command, verdict, self.movement.goal, state, seen - began, done - seen
        )

    def _find(self, frame: Frame) -> Pose | None:
        """Find the operator; a frame that cannot be used (no depth, out of order) is one without a pose."""
        try:
            return self.pose(frame)
        except InputError as error:
            self.trouble = str(error)
            return None

    def _level(self, pose: Pose) -> Pose:
        """Take the drone's tilt and turn out of a pose: what is left is the operator's own movement.

        The result stays in an optical frame (y down), level, looking along the line of sight to the track.
        """
        state = self.track.state_at(pose.stamp_ns)
        body = np.stack([self.config.mount.to_body(joint) for joint in pose.joints])
        world = body @ rotation(state).T
        sight = self.track.position_m(pose.stamp_ns) - state.position_m
        angle = float(np.arctan2(sight[1], sight[0]))
        cos, sin = np.cos(angle), np.sin(angle)
        ahead = cos * world[:, 0] + sin * world[:, 1]
        left = -sin * world[:, 0] + cos * world[:, 1]
        return replace(pose, joints=np.stack([-left, -world[:, 2], ahead], axis=1))

    def _command(self, gesture: Gesture | None, now_ns: int) -> Command | None:
        if gesture is None or gesture.label is None:
            return None
        command = self.commands.get(gesture.label)
        if command is None:
            return None
        urgent = command in (Command.STOP, Command.LAND)
        if (
            not urgent
            and self._commanded_ns is not None
            and (now_ns - self._commanded_ns) * 1e-9 < self.config.rest_between_s
        ):
            return None
        self._commanded_ns = now_ns
        return command

    def _fly(self, command: Command | None, state: VehicleState, now_ns: int) -> Verdict:
        known = self.track.seen_ns is not None
        operator = self.track.position_m(now_ns)
        sight = (operator - state.position_m)[:2]
        distance = float(np.linalg.norm(sight))
        mode = self.vehicle.mode
        wanted = HOVER
        before = self.supervisor.mode
        if known and before in (Mode.FOLLOWING, Mode.HOLDING):
            dt_s = 0.0 if self._last_ns is None else (now_ns - self._last_ns) * 1e-9
            if before is Mode.FOLLOWING:
                self.movement.update(dt_s, state.position_m, operator)
            wanted = self.follow.setpoint(self.track, state, self.movement.goal, now_ns)
        else:
            self.follow.reset()
        verdict = self.supervisor.step(
            Situation(
                now_ns,
                self.track.seen_ns,
                state.stamp_ns,
                distance if known else None,
                wrap(float(np.arctan2(sight[1], sight[0])) - state.heading_rad),
                mode in (FlightMode.HOLDING, FlightMode.STEERED),
                mode in (FlightMode.DISARMED, FlightMode.READY),
                command,
                wanted,
            )
        )
        self._apply(verdict, before, distance, float(state.position_m[2]), now_ns)
        return verdict

    def _apply(
        self, verdict: Verdict, before: Mode, distance_m: float, altitude_m: float, now_ns: int
    ) -> None:
        if verdict.mode is not Mode.FOLLOWING and before is Mode.FOLLOWING:
            self.movement.cancel(distance_m, altitude_m)
        if verdict.mode is Mode.FOLLOWING and before is Mode.TAKING_OFF:
            self.movement.approach(distance_m, self.config.goal)
        elif verdict.mode is Mode.FOLLOWING and before is not Mode.FOLLOWING:
            self.movement.cancel(distance_m, altitude_m)
        if verdict.accepted is not None:
            self.movement.start(verdict.accepted)
        match verdict.action:
            case Action.TAKE_OFF:
                self.vehicle.arm()
                self.vehicle.take_off(self.config.goal.altitude_m)
            case Action.LAND:
                self.vehicle.land()
            case Action.HOLD:
                self.vehicle.hold()
            case Action.NONE:
                pass
        if verdict.mode in (Mode.FOLLOWING, Mode.HOLDING, Mode.LOST_PERSON) and verdict.action is Action.NONE:
            self.vehicle.send(verdict.setpoint, now_ns)


__all__ = ["Pilot", "PilotConfig", "PoseSource", "Setpoint", "Step"]
