"""The follow law against a first-order vehicle and a walking operator."""

import numpy as np
import pytest

from wigwag.fly.follow import FollowLaw, Goal, wrap
from wigwag.fly.movements import Movement, MovementConfig
from wigwag.fly.operator import Mount, OperatorTrack, rotation
from wigwag.fly.values import Command, Setpoint, VehicleState
from wigwag.skeleton import Pose

DT = 1 / 30
GOAL, CONFIG = Goal(), MovementConfig()
STAND = np.array([GOAL.distance_m, 0.0, 0.95])
"""An operator whom the drone, at the origin, already sees from the goal's distance."""


def pose_seen(operator: np.ndarray, state: VehicleState, mount: Mount) -> Pose:
    """What an exact camera on the drone would measure of a point-like operator."""
    body = rotation(state).T @ (operator - state.position_m) - np.array(mount.offset_m)
    cos, sin = np.cos(mount.pitch_down_rad), np.sin(mount.pitch_down_rad)
    forward, down = cos * body[0] - sin * body[2], -sin * body[0] - cos * body[2]
    return Pose(np.tile([-body[1], down, forward], (13, 1)), np.ones(13), state.stamp_ns)


def test_a_drone_that_is_held_up_is_waited_for_and_the_movement_gives_up() -> None:
    for command in (Command.FARTHER, Command.UP, Command.LEFT, Command.RIGHT, Command.ORBIT):
        movement = Movement(MovementConfig(distance_step_m=1.0, altitude_step_m=0.8, sideways_m=2.0))
        here = STAND - [GOAL.distance_m, 0.0, STAND[2] - GOAL.altitude_m]
        start = movement.update(DT, here, STAND)
        movement.start(command)
        turns = 0
        while (goal := movement.update(DT, here, STAND)) and movement.command is not None:
            around = wrap(goal.angle_rad - start.angle_rad) * GOAL.distance_m
            assert abs(goal.distance_m - start.distance_m) < 0.55
            assert abs(goal.altitude_m - start.altitude_m) < 0.55
            assert abs(around) < 0.55
            turns += 1
            assert turns * DT < 80
        assert (goal.tangential_m_s, goal.receding_m_s, goal.climbing_m_s) == (0.0, 0.0, 0.0)
        assert goal.distance_m == pytest.approx(GOAL.distance_m), "what it has there becomes the goal"


class Drone:
    """A first-order vehicle: it reaches a commanded velocity with a lag of 0.25 s."""

    def __init__(self) -> None:
        self.position, self.velocity, self.heading, self.yaw_rate = (
            np.array([0, 0, GOAL.altitude_m]),
            np.zeros(3),
            0.0,
            0.0,
        )

    def state(self, now_ns: int) -> VehicleState:
        return VehicleState(self.position.copy(), self.velocity.copy(), self.heading, now_ns)

    def fly(self, setpoint: Setpoint) -> None:
        forward, left, up = setpoint.velocity_m_s
        cos, sin = np.cos(self.heading), np.sin(self.heading)
        wanted = np.array([cos * forward - sin * left, sin * forward + cos * left, up])
        self.velocity += (wanted - self.velocity) * DT / 0.25
        self.yaw_rate += (setpoint.yaw_rate_rad_s - self.yaw_rate) * DT / 0.15
        self.position = self.position + self.velocity * DT
        self.heading = wrap(self.heading + self.yaw_rate * DT)


def fly(seconds: float, operator_at, movement: Movement | None = None):  # type: ignore[no-untyped-def]
    drone, track, law, mount = Drone(), OperatorTrack(), FollowLaw(), Mount()
    errors = []
    for step in range(int(seconds / DT)):
        now = int(step * DT * 1e9)
        operator = operator_at(step * DT)
        state = drone.state(now)
        track.observe_vehicle(state)
        track.observe(pose_seen(operator, state, mount))
        goal = Goal() if movement is None else movement.update(DT, state.position_m, track.position_m(now))
        sight = (operator - drone.position)[:2]
        bearing = wrap(float(np.arctan2(sight[1], sight[0])) - drone.heading)
        errors.append((abs(np.degrees(bearing)), abs(np.linalg.norm(sight) - goal.distance_m)))
        drone.fly(law.setpoint(track, state, goal, now))
    return drone, np.array(errors)


def test_keeps_a_walking_operator_centred_and_at_distance() -> None:
    def walk(t: float) -> np.ndarray:
        return STAND + np.array([1.5 * np.sin(0.5 * t), 1.5 * (1 - np.cos(0.5 * t)), 0.0])  # 0.75 m/s

    _, errors = fly(30, walk)
    assert errors[60:, 0].mean() < 1.0
    assert errors[60:, 0].max() < 4.0
    assert errors[60:, 1].mean() < 0.15


@pytest.mark.parametrize(("command", "side"), [(Command.LEFT, -1), (Command.RIGHT, 1)])
def test_sideways_is_the_operators_own_side_and_ends(command: Command, side: int) -> None:
    movement = Movement()
    movement.start(command)
    drone, errors = fly(8, lambda t: STAND, movement)
    angle = np.arctan2(drone.position[1], STAND[0] - drone.position[0])
    # The operator looks along -x; their left is -y, which is where the drone goes on LEFT.
    assert side * angle * GOAL.distance_m == pytest.approx(CONFIG.sideways_m, abs=0.15)
    assert movement.command is None
    assert errors[-1, 1] < 0.1


@pytest.mark.parametrize(
    ("command", "farther_m", "higher_m"),
    [
        (Command.UP, 0.0, 0.4), (Command.DOWN, 0.0, -0.4),
        (Command.CLOSER, -0.6, 0.0), (Command.FARTHER, 0.6, 0.0),
    ],
)  # fmt: skip
def test_movements_end_where_they_should(command: Command, farther_m: float, higher_m: float) -> None:
    movement = Movement()
    movement.start(command)
    drone, _ = fly(8, lambda t: STAND, movement)
    distance = np.linalg.norm((drone.position - STAND)[:2])
    assert distance == pytest.approx(GOAL.distance_m + farther_m, abs=0.05)
    assert drone.position[2] == pytest.approx(GOAL.altitude_m + higher_m, abs=0.03)
    assert movement.command is None


def test_orbit_goes_all_the_way_round() -> None:
    movement = Movement()
    movement.start(Command.ORBIT)
    seconds = CONFIG.orbit_rad * GOAL.distance_m / CONFIG.orbit_m_s
    drone, errors = fly(seconds + 4.0, lambda t: STAND, movement)
    assert movement.command is None
    assert np.linalg.norm(drone.position[:2]) < 0.8
    assert errors[60:, 0].max() < 5
    assert errors[60:, 1].max() < 0.4


def test_goals_stay_within_bounds_however_often_asked() -> None:
    movement = Movement()
    bounds = {
        Command.CLOSER: CONFIG.min_distance_m, Command.DOWN: CONFIG.min_altitude_m,
        Command.FARTHER: CONFIG.max_distance_m, Command.UP: CONFIG.max_altitude_m,
    }  # fmt: skip
    for command, bound in bounds.items():
        for _ in range(9):
            movement.start(command)
            for _ in range(200):
                at = STAND - [movement.goal.distance_m, 0.0, STAND[2] - movement.goal.altitude_m]
                goal = movement.update(DT, at, STAND)
        reached = goal.altitude_m if command in (Command.UP, Command.DOWN) else goal.distance_m
        assert reached == pytest.approx(bound)


def test_a_late_frame_meets_the_state_of_its_time() -> None:
    track, mount = OperatorTrack(), Mount(pitch_down_rad=0.2)
    operator = np.array([4.0, 1.0, 1.0])
    states = [
        VehicleState(np.array([0.1 * i, 0, 1.4]), np.zeros(3), 0.1 * i, i * 33_000_000, 0.05 * i, -0.04 * i)
        for i in range(4)
    ]
    for state in states:
        track.observe_vehicle(state)
    track.observe(pose_seen(operator, states[2], mount))
    exact = OperatorTrack(mount=mount)
    for state in states:
        exact.observe_vehicle(state)
    exact.observe(pose_seen(operator, states[2], mount))
    assert exact.position_m(states[2].stamp_ns) == pytest.approx(operator)


def test_poses_out_of_order_are_ignored() -> None:
    track, mount = OperatorTrack(), Mount()
    state = VehicleState(np.zeros(3), np.zeros(3), 0.0, 10**9)
    track.observe_vehicle(state)
    track.observe(pose_seen(np.array([4.0, 0, 0]), state, mount))
    before = track.position_m(10**9)
    old = Pose(np.full((13, 3), 9.0), np.ones(13), 5 * 10**8)
    track.observe(old)
    assert track.position_m(10**9) == pytest.approx(before)
