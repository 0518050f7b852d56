"""Fly the whole chain in the simulated world, and judge it by what only the world knows."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from wigwag.camera import Frame
from wigwag.evaluate.flight import FlightLog, Row
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.pilot import Pilot, Step
from wigwag.sim.script import Script
from wigwag.sim.world import World
from wigwag.skeleton import Pose


@dataclass(frozen=True, slots=True)
class Turn:
    """One turn of the loop, for whoever watches."""

    frame: Frame
    step: Step
    row: Row


class Session:
    """A flight of one script: the world turns, the chain sees frames, the log keeps what is true.

    Args:
        world: Operator, drone and camera.
        pilot: The chain; it is given frames and the drone's own state, nothing else.
        script: What the operator will do; read only to judge.
        clock: Processor seconds of this thread, for the timings.
    """

    def __init__(
        self,
        world: World,
        pilot: Pilot,
        script: Script,
        clock: Callable[[], float] = time.thread_time,
    ) -> None:
        self.world, self.pilot, self.script, self.clock = world, pilot, script, clock
        self.asked: Callable[[], Command | None] = lambda: None
        """Says what somebody at a console asks for, once a turn."""
        self.log = FlightLog(shown=list(script.shown))
        self.movements: list[Pose] = []
        """Every pose as the spotter saw it."""

    def fly(self) -> Iterator[Turn]:
        """Fly to the end of the script, a turn of the loop at a time."""
        frames = int(self.script.duration_s * self.world.config.rate_hz)
        for _ in range(frames):
            began = self.clock()
            frame = self.world.step()
            step = self.pilot.step(frame, self.world.now_ns, self.asked())
            spent_ms = 1e3 * (self.clock() - began)
            yield Turn(frame, step, self._note(step, spent_ms))

    def _note(self, step: Step, spent_ms: float) -> Row:
        now, seen = self.world.truth_now, self.world.truth
        found = step.pose is not None and bool(
            np.linalg.norm(step.pose.hip_center - seen.hip_center_camera_m) < 0.3
        )
        drone, operator = now.drone.position_m, now.hip_center_m
        row = Row(
            time_s=now.stamp_ns * 1e-9,
            found=found,
            flying=step.verdict.mode in (Mode.FOLLOWING, Mode.EXECUTING),
            bearing_deg=float(np.degrees(now.bearing_rad)),
            distance_error_m=now.distance_m - step.goal.distance_m,
            drone_m=(float(drone[0]), float(drone[1]), float(drone[2])),
            operator_m=(float(operator[0]), float(operator[1]), float(operator[2])),
            pose_ms=1e3 * step.pose_s,
            loop_ms=spent_ms,
            mode=step.verdict.mode.value,
            sought=seen.stamp_ns * 1e-9 >= (self.script.engaged_s or 0.0),
        )
        self.log.rows.append(row)
        if step.movement is not None:
            self.movements.append(step.movement)
        if step.gesture is not None and step.gesture.label in self.pilot.commands:
            self.log.events.append(step.gesture)
        return row
