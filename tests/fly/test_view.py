"""Wherever commands lead, a level camera sees the operator from there: hands to knees."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from wigwag.camera.frame import Intrinsics
from wigwag.fly.follow import Goal
from wigwag.fly.helm import Helm
from wigwag.fly.movements import Movement, MovementConfig
from wigwag.fly.operator import Mount, OperatorTrack
from wigwag.fly.situation import Mode, Verdict
from wigwag.fly.values import Command, VehicleState
from wigwag.fly.view import View
from wigwag.skeleton import Pose

BOUNDS = MovementConfig()
HIPS_M = 0.95
DT = 1 / 30
STEPS = (Command.UP, Command.DOWN, Command.CLOSER, Command.FARTHER)


def through(lens: Intrinsics, mount: Mount, bounds: MovementConfig = BOUNDS) -> View:
    return View.through(lens, mount, bounds.above_hips_m, bounds.below_hips_m, bounds.view_margin_rad)


def row(lens: Intrinsics, mount: Mount, distance_m: float, up_m: float) -> float:
    """In which row of the picture a level drone sees what is so far ahead of it and above it."""
    axes = np.stack([mount.to_body(axis) - mount.to_body(np.zeros(3)) for axis in np.eye(3)])
    ahead = np.array([distance_m, 0.0, up_m]) - mount.to_body(np.zeros(3))
    return float(lens.project(axes @ ahead)[1])


lenses = st.builds(
    lambda height, focal, middle: Intrinsics(fy=focal * height, cy=middle * height, height=height),
    st.sampled_from([240, 480, 720]), st.floats(0.6, 1.6), st.floats(0.4, 0.6),
)  # fmt: skip
mounts = st.builds(
    lambda pitch, ahead, up: Mount(pitch, (ahead, 0.0, up)),
    st.floats(-0.1, 0.4), st.floats(-0.1, 0.2), st.floats(-0.1, 0.1),
)  # fmt: skip


@given(lenses, mounts, st.floats(1.5, 8.0))
def test_between_lowest_and_highest_all_is_in_the_picture_and_beyond_it_is_not(
    lens: Intrinsics, mount: Mount, distance_m: float
) -> None:
    view = through(lens, mount)
    lowest, highest = view.heights_m(distance_m)
    assume(distance_m > view.nearest_m)
    top_row, bottom_row = (
        lens.fy * math.tan(sign * (math.atan(edge / lens.fy) - BOUNDS.view_margin_rad)) + lens.cy
        for sign, edge in ((-1, lens.cy), (1, lens.height - lens.cy))
    )

    def seen(height_m: float) -> tuple[bool, bool]:
        hands = row(lens, mount, distance_m, BOUNDS.above_hips_m - height_m)
        knees = row(lens, mount, distance_m, -BOUNDS.below_hips_m - height_m)
        return hands >= top_row, knees <= bottom_row

    assert 0 < top_row < bottom_row < lens.height
    assert seen(lowest + 1e-6) == seen(highest - 1e-6) == (True, True)
    assert seen(lowest - 1e-3)[0] is False and seen(highest + 1e-3)[1] is False


@given(lenses, mounts)
def test_nearer_than_the_nearest_it_does_not_fit_and_hands_and_knees_are_cut_alike(
    lens: Intrinsics, mount: Mount
) -> None:
    view = through(lens, mount)
    assume(view.nearest_m > mount.offset_m[0] + 0.5)
    low, high = view.heights_m(view.nearest_m - 0.3)
    assert low == high
    away = view.nearest_m - 0.3 - mount.offset_m[0]
    over = BOUNDS.above_hips_m - low - mount.offset_m[2] - away * math.tan(view.upper_rad)
    under = BOUNDS.below_hips_m + low + mount.offset_m[2] + away * math.tan(view.lower_rad)
    assert over == pytest.approx(under) and over > 0


def test_a_lens_that_sees_less_than_the_margin_sees_nobody() -> None:
    assert through(Intrinsics(fy=1e5), Mount()).nearest_m == math.inf


def fly(movement: Movement, command: Command) -> list[Goal]:
    """Let a drone that goes where its goal is fly a command to its end."""
    movement.start(command)
    goals = []
    for _ in range(3000):
        goal = movement.goal
        here = np.array([-goal.distance_m, 0.0, goal.altitude_m])
        goals.append(movement.update(DT, here, np.zeros(3)))
        if movement.command is None:
            return goals
    raise AssertionError(f"{command} does not end")


def in_view(view: View, goal: Goal, hips_m: float = HIPS_M, slack_m: float = 0.0) -> bool:
    low, high = view.heights_m(goal.distance_m)
    return low - slack_m - 1e-9 <= goal.altitude_m - hips_m <= high + slack_m + 1e-9


@given(
    st.builds(through, lenses, mounts), st.floats(0.6, 1.3), st.floats(2.8, 5.5), st.floats(0.3, 2.5),
    st.lists(st.sampled_from(STEPS), min_size=1, max_size=6),
)  # fmt: skip
def test_no_steady_goal_is_out_of_view(
    view: View, hips_m: float, distance_m: float, altitude_m: float, commands: list[Command]
) -> None:
    movement = Movement()
    movement.look(view, hips_m)
    movement.cancel(distance_m, altitude_m)
    for command in commands:
        before = movement.goal
        goal = fly(movement, command)[-1]
        low, high = view.heights_m(goal.distance_m)
        if BOUNDS.min_altitude_m <= high + hips_m and low + hips_m <= BOUNDS.max_altitude_m:
            assert in_view(view, goal, hips_m)
        else:
            assert goal.altitude_m in (BOUNDS.min_altitude_m, BOUNDS.max_altitude_m), "the bounds win"
        assert BOUNDS.min_altitude_m <= goal.altitude_m <= BOUNDS.max_altitude_m
        assert BOUNDS.min_distance_m <= goal.distance_m <= BOUNDS.max_distance_m
        way = {
            Command.UP: goal.altitude_m - before.altitude_m,
            Command.DOWN: before.altitude_m - goal.altitude_m,
            Command.CLOSER: before.distance_m - goal.distance_m,
            Command.FARTHER: goal.distance_m - before.distance_m,
        }[command]
        step = BOUNDS.altitude_step_m if command in (Command.UP, Command.DOWN) else BOUNDS.distance_step_m
        assert -1e-9 <= way <= step + 1e-9, "never the other way, never farther than asked"
        if command in (Command.UP, Command.DOWN):
            assert goal.distance_m == before.distance_m, "only closer and farther change both"
        if way < step - 0.06:
            assert movement.told.startswith(command), "what is cut is told"
        if goal.distance_m < view.nearest_m - 1e-9:
            assert command is not Command.CLOSER or way < 1e-9, "closer does not lead nearer than it fits"


@given(st.lists(st.sampled_from(STEPS), min_size=1, max_size=6))
def test_on_the_way_too_a_level_camera_sees_all(commands: list[Command]) -> None:
    view, movement = through(Intrinsics(), Mount()), Movement()
    movement.look(view, HIPS_M)
    movement.cancel(4.5, 1.2)
    slack_m = 2 * BOUNDS.near_m  # so near its end the height stays, until the distance is there too
    for command in commands:
        assert all(in_view(view, goal, slack_m=slack_m) for goal in fly(movement, command))


@pytest.mark.parametrize(
    "commands", [(Command.UP, Command.CLOSER), (Command.CLOSER, Command.UP), (Command.DOWN, Command.CLOSER),
                 (Command.CLOSER, Command.DOWN)], ids=str,
)  # fmt: skip
def test_without_a_view_two_commands_lead_out_of_the_picture_and_with_it_they_do_not(
    commands: tuple[Command, ...],
) -> None:
    view, seeing, blind = through(Intrinsics(), Mount()), Movement(), Movement()
    seeing.look(view, HIPS_M)
    told = []
    for command in (commands[0], *commands, commands[1]):
        fly(seeing, command), fly(blind, command)
        told.append(seeing.told)
    assert in_view(view, seeing.goal) and not in_view(view, blind.goal)
    assert any("see" in said or "picture" in said for said in told)


def test_closer_brings_the_height_along_and_up_is_cut() -> None:
    movement = Movement()
    movement.look(through(Intrinsics(), Mount()), HIPS_M)
    fly(movement, Command.UP)
    assert movement.goal.altitude_m == pytest.approx(1.6) and movement.told == ""
    fly(movement, Command.UP)
    assert movement.told == "up: 0.3 m instead of 0.4 m; the camera would not see your legs; farther first"
    high_m = movement.goal.altitude_m
    fly(movement, Command.CLOSER)
    assert movement.goal.distance_m == pytest.approx(3.9), "closer is flown in full"
    assert movement.goal.altitude_m < high_m - 0.15
    assert movement.told == "closer: the height changes by -0.2 m on the way, to keep you in the picture"
    fly(movement, Command.UP)
    assert movement.told == "up: stays where it is; the camera would not see your legs; farther first"
    fly(movement, Command.FARTHER)
    assert movement.told == "", "there is room again, and it is not climbed into unasked"


def test_the_picture_is_too_narrow_to_come_near() -> None:
    movement = Movement()
    view = through(Intrinsics(fy=850.0), Mount())
    movement.look(view, HIPS_M)
    movement.cancel(4.5, 1.2)
    fly(movement, Command.CLOSER)
    assert movement.goal.distance_m == pytest.approx(view.nearest_m) and 3.9 < view.nearest_m < 4.4
    assert "hands and knees do not fit into the picture" in movement.told
    fly(movement, Command.CLOSER)
    assert movement.told.startswith("closer: stays where it is; nearer, hands and knees do not fit")


def test_what_is_not_known_bounds_nothing() -> None:
    helm, view = Helm(), through(Intrinsics(), Mount())
    helm.look(view)
    assert helm.movement.heights_m(3.0) == (BOUNDS.min_altitude_m, BOUNDS.max_altitude_m), "whose hips?"
    helm.movement.look(None, HIPS_M)
    assert helm.movement.heights_m(3.0) == (BOUNDS.min_altitude_m, BOUNDS.max_altitude_m)


def test_limits_tightened_in_flight_keep_the_view() -> None:
    movement = Movement()
    movement.look(through(Intrinsics(), Mount()), HIPS_M)
    fly(movement, Command.UP)
    movement.bound(replace(BOUNDS, max_distance_m=3.0))
    assert movement.goal.distance_m == 3.0 and movement.goal.altitude_m < 1.45


@given(lenses, mounts, st.floats(2.8, 5.5), st.floats(-0.5, 2.5))
def test_a_place_that_was_set_is_allowed_or_the_camera_is_not_believed(
    lens: Intrinsics, mount: Mount, distance_m: float, height_m: float
) -> None:
    view = through(lens, mount)
    allowing = view.allowing(distance_m, height_m)
    if allowing is None:
        low, high = View.through(lens, mount, 0.0, 0.0, BOUNDS.view_margin_rad).heights_m(distance_m)
        assert not low <= height_m <= high, "not even the hips are seen"
        return
    low, high = allowing.heights_m(distance_m)
    assert low - 1e-9 <= height_m <= high + 1e-9
    assert allowing.above_hips_m <= view.above_hips_m and allowing.below_hips_m <= view.below_hips_m
    if view.heights_m(distance_m)[0] < height_m < view.heights_m(distance_m)[1]:
        assert allowing == view, "nothing is given up without need"


@pytest.mark.parametrize(
    ("altitude_m", "pitch_rad", "told", "up_m"),
    [
        (1.2, 0.0, "", 0.4),
        (2.2, 0.0, "the camera does not see all of you from 2.2 m: tilt it, or fly otherwise", 0.0),
        (3.0, 0.0, "the camera does not see you from 3 m: tilt it, or fly otherwise", 0.4),
        (3.0, 0.4, "", 0.4),
    ],
)
def test_the_height_that_was_set_is_flown_and_what_is_not_seen_from_it_is_told(
    altitude_m: float, pitch_rad: float, told: str, up_m: float
) -> None:
    helm, track = Helm(Goal(4.5, altitude_m), movement=replace(BOUNDS, max_altitude_m=4.0)), OperatorTrack()
    state = VehicleState(np.array([0.0, 0.0, altitude_m]), np.zeros(3), 0.0, 10**9)
    helm.look(through(Intrinsics(), Mount(pitch_rad)))
    track.observe_vehicle(state)
    track.observe(Pose(np.tile([0.0, altitude_m - HIPS_M, 4.4], (13, 1)), np.ones(13), 10**9))
    assert helm.enter(Mode.TAKING_OFF, Verdict(Mode.FOLLOWING), track, state) == told
    helm.movement.cancel(4.5, altitude_m)
    assert helm.movement.goal.altitude_m == pytest.approx(altitude_m)
    assert fly(helm.movement, Command.UP)[-1].altitude_m == pytest.approx(altitude_m + up_m)
