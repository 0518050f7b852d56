"""A flight in the simulated world, with a pose source that knows the truth: the log says what was so."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from tests.sim.people import standing
from wigwag.camera import Frame, Intrinsics
from wigwag.evaluate.session import Session
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot
from wigwag.sim.scene import SceneConfig
from wigwag.sim.script import Script, Shown
from wigwag.sim.world import World, WorldConfig
from wigwag.skeleton import Clip, Pose

SMALL = Intrinsics(fx=75.0, fy=75.0, cx=40.0, cy=30.0, width=80, height=60)


class Statue:
    def step(self, t_s: float, dt_s: float, drone_position_m: np.ndarray) -> np.ndarray:
        return standing("down", at=(4.6, 0.0))


class Oracle:
    """Sees the hips where they truly were, or ``off_m`` beside them, or nobody at all."""

    def __init__(self) -> None:
        self.world: World | None = None
        self.off_m: float | None = 0.0

    def __call__(self, frame: Frame) -> Pose | None:
        assert self.world is not None
        if self.off_m is None:
            return None
        joints = np.tile(self.world.truth.hip_center_camera_m + np.array([self.off_m, 0, 0]), (13, 1))
        return Pose(joints, np.ones(13), frame.stamp_ns)


class Nobody:
    def recognise(self, clip: Clip) -> Gesture:
        raise AssertionError("nothing moved")


class Prompter:
    """Says each label at its turn of the loop."""

    def __init__(self, lines: dict[int, str | None]) -> None:
        self.lines, self.turn = lines, 0

    def update(self, pose: Pose | None) -> Gesture | None:
        self.turn += 1
        return Gesture(self.lines[self.turn], 0.8) if self.turn in self.lines else None


@pytest.fixture
def flight() -> tuple[Session, Oracle]:
    oracle = Oracle()
    world = World(WorldConfig(intrinsics=SMALL, scene=SceneConfig(clutter=0), noise=None), 1, Statue())
    oracle.world = world
    script = Script((), (), (Shown("left", 0.1, 0.4, True),), 1.0)
    return Session(world, Pilot(oracle, Nobody(), world.vehicle), script), oracle


def test_one_row_a_frame_to_the_end_of_the_script(flight: tuple[Session, Oracle]) -> None:
    session, _ = flight
    turns = list(session.fly())
    assert len(turns) == len(session.log.rows) == len(session.movements) == 30
    rows = session.log.rows
    assert [row.time_s for row in rows] == pytest.approx([k / 30 for k in range(1, 31)])
    assert all(row.found and row.flying and row.mode == "following" for row in rows)
    assert max(abs(row.bearing_deg) for row in rows) < 2
    truth = session.world.truth_now
    goal = session.pilot.config.goal.distance_m
    assert rows[-1].distance_error_m == pytest.approx(truth.distance_m - goal)
    assert rows[-1].drone_m == pytest.approx(tuple(truth.drone.position_m))
    assert session.log.shown == list(session.script.shown)
    assert turns[-1].frame.stamp_ns < session.world.now_ns, "the camera is late"


def test_found_is_judged_by_the_truth_and_not_by_what_the_chain_believes(
    flight: tuple[Session, Oracle],
) -> None:
    session, oracle = flight
    found = []
    for k, turn in enumerate(session.fly()):
        found.append(turn.row.found)
        oracle.off_m = {5: 0.25, 10: 0.35, 15: None}.get(k, oracle.off_m)
    assert found == [True] * 11 + [False] * 19
    assert len(session.movements) == 16, "frames without a pose bring no movement"


def test_only_gestures_that_command_something_are_events(flight: tuple[Session, Oracle]) -> None:
    session, _ = flight
    session.pilot.spotter = Prompter({3: "left", 6: None, 9: "clap"})  # type: ignore[assignment]
    gestures = [turn.step.gesture for turn in session.fly() if turn.step.gesture is not None]
    assert [gesture.label for gesture in gestures] == ["left", None, "clap"]
    assert [gesture.label for gesture in session.log.events] == ["left"]


def test_the_worlds_time_counts_into_the_loops(flight: tuple[Session, Oracle]) -> None:
    session, _ = flight
    ticks = itertools.count()
    session.world._clock = lambda: next(ticks) * 1e-3  # looked at three times a step, and twice a picture
    session.clock = session.pilot.clock = session.world._clock
    list(session.fly())
    row = session.log.rows[-1]
    assert row.pose_ms == pytest.approx(1.0)
    assert row.loop_ms > session.world.spent.render_ms + session.world.spent.noise_ms + row.pose_ms


def test_the_world_is_the_same_whoever_looks(flight: tuple[Session, Oracle]) -> None:
    """The log changes nothing: two flights of one seed are one flight."""
    session, _ = flight
    rows = [dataclasses.replace(turn.row, pose_ms=0.0, loop_ms=0.0) for turn in session.fly()]
    oracle = Oracle()
    world = World(session.world.config, 1, Statue())
    oracle.world = world
    again = Session(world, Pilot(oracle, Nobody(), world.vehicle), session.script)
    assert [dataclasses.replace(turn.row, pose_ms=0.0, loop_ms=0.0) for turn in again.fly()] == rows
