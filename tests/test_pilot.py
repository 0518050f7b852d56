"""The loop, with stand-ins for camera, network, recogniser and drone: what is commanded, and what never."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from wigwag.camera import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.fly.follow import Goal
from wigwag.fly.movements import MovementConfig
from wigwag.fly.operator import Mount
from wigwag.fly.situation import Craft, Mode
from wigwag.fly.values import HOVER, Command, Setpoint, VehicleState
from wigwag.gesture import Gesture
from wigwag.pilot import CRAFT, Pilot, PilotConfig, Step
from wigwag.skeleton import Clip, Landmark, Pose
from wigwag.vehicles import FlightMode

S = 10**9
PERIOD_NS = S // 30
PICTURE = np.zeros((4, 4, 3), np.uint8)
DEPTH = np.full((4, 4), 4000, np.uint16)


class Drone:
    """Does at once what it is asked, and notes it. Its clock is turned by hand."""

    def __init__(self, mode: FlightMode = FlightMode.HOLDING) -> None:
        self.mode = mode
        self.state = VehicleState(np.array([0.0, 0.0, 1.2]), np.zeros(3), 0.0, 0)
        self.asked: list[str] = []
        self.sent: list[Setpoint] = []

    def beat(self, now_ns: int) -> None:
        self.beats_ns = now_ns

    def arm(self) -> bool:
        self.asked.append("arm")
        self.mode = FlightMode.READY
        return True

    def take_off(self, height_m: float = 1.5) -> bool:
        self.asked.append(f"take off to {height_m} m")
        self.mode = FlightMode.TAKING_OFF
        return True

    def land(self) -> bool:
        self.asked.append("land")
        self.mode = FlightMode.LANDING
        return True

    def hold(self) -> bool:
        self.asked.append("hold")
        self.mode = FlightMode.HOLDING
        return True

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        self.sent.append(setpoint)
        self.asked_at_send = list(self.asked)
        self.mode = FlightMode.STEERED
        return True


class Sight:
    """Sees the operator where they are put, and complains of frames as the pose estimator does."""

    def __init__(self) -> None:
        self.at_m: tuple[float, float, float] | None = (0.0, 0.2, 4.5)
        self.last_ns = -1
        self.arms_up = False

    def __call__(self, frame: Frame) -> Pose | None:
        if frame.depth_mm is None:
            raise InputError("Frame.depth_mm is None")
        if frame.stamp_ns <= self.last_ns:
            raise InputError("Frame.stamp_ns must grow")
        self.last_ns = frame.stamp_ns
        if self.at_m is None:
            return None
        joints = np.tile(self.at_m, (13, 1))
        joints[[Landmark.LEFT_WRIST, Landmark.RIGHT_WRIST], 1] += -0.5 if self.arms_up else 0.2
        joints[[Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER], 1] -= 0.5
        return Pose(joints, np.ones(13), frame.stamp_ns)


class Silent:
    """Is never asked: gestures come from ``Prompter``."""

    def recognise(self, clip: Clip) -> Gesture:
        raise AssertionError("nothing moved")


class Prompter:
    """Stands where the spotter goes and says what it is told, whatever it sees."""

    def __init__(self) -> None:
        self.label: str | None = None
        self.shown_s = 2.0

    def update(self, pose: Pose | None) -> Gesture | None:
        label, self.label = self.label, None
        shown_ns = int(self.shown_s * S)
        return None if label is None else Gesture(label, 0.9, 0, shown_ns, shown_ns)


class Flight:
    """A pilot with all its stand-ins, and a clock."""

    def __init__(self, mode: FlightMode = FlightMode.HOLDING) -> None:
        self.drone, self.sight, self.prompter = Drone(mode), Sight(), Prompter()
        self.pilot = Pilot(self.sight, Silent(), self.drone, clock=lambda: 0.0)  # type: ignore[arg-type]
        self.pilot.spotter = self.prompter  # type: ignore[assignment]
        self.now_ns = 0

    def turn(self, label: str | None = None, frame: Callable[[int], Frame | None] | None = None) -> Step:
        self.now_ns += PERIOD_NS
        state = self.drone.state
        self.drone.state = VehicleState(state.position_m, state.velocity_m_s, state.heading_rad, self.now_ns)
        self.prompter.label = label
        return self.pilot.step((frame or good)(self.now_ns), self.now_ns)

    def turns(self, seconds: float, frame: Callable[[int], Frame | None] | None = None) -> list[Step]:
        return [self.turn(frame=frame) for _ in range(round(seconds * 30))]


def good(now_ns: int) -> Frame:
    return Frame(PICTURE, DEPTH, Intrinsics(), now_ns)


def flat(now_ns: int) -> Frame:
    return Frame(PICTURE, None, Intrinsics(), now_ns)


def old(now_ns: int) -> Frame:
    return Frame(PICTURE, DEPTH, Intrinsics(), 1)


def none(now_ns: int) -> None:
    return None


def test_an_operator_at_the_goal_is_followed_with_hardly_any_movement() -> None:
    flight = Flight()
    flight.sight.at_m = (0.0, 0.2, 4.4)  # 0.1 m behind the camera's place on the drone
    steps = flight.turns(1.0)
    assert steps[-1].verdict.mode is Mode.FOLLOWING
    assert np.abs(flight.drone.sent[-1].velocity_m_s).max() < 1e-6
    flight.sight.at_m = (-0.4, 0.2, 5.0)
    flight.turns(0.5)
    forward = flight.drone.sent[-1].velocity_m_s[0]
    assert forward > 0.3 and flight.drone.sent[-1].yaw_rate_rad_s > 0.05, (
        "farther and to the left: after them"
    )


@pytest.mark.parametrize(("frame", "says"), [(flat, "depth_mm is None"), (old, "stamp_ns must grow")])
def test_frames_that_cannot_be_used_neither_raise_nor_command(
    frame: Callable[[int], Frame], says: str
) -> None:
    flight = Flight()
    flight.turns(0.5)
    for step in flight.turns(0.4, frame):
        assert (step.pose, step.movement, step.command) == (None, None, None)
        assert step.verdict.mode is Mode.FOLLOWING
    assert says in flight.pilot.trouble
    assert flight.turns(0.3)[-1].pose is not None, "the next good frame is taken"
    assert flight.drone.asked == []


@pytest.mark.parametrize("frame", [none, flat, old])
def test_without_frames_the_operator_is_lost_and_the_drone_stands(
    frame: Callable[[int], Frame | None],
) -> None:
    flight = Flight()
    flight.sight.at_m = (0.0, 0.2, 5.5)
    flight.turns(0.5)
    assert flight.drone.sent[-1].velocity_m_s[0] > 0.3
    steps = flight.turns(1.0, frame)
    lost = [k for k, step in enumerate(steps) if step.verdict.mode is Mode.LOST_PERSON]
    assert lost == list(range(lost[0], len(steps))), "once lost it stays lost without frames"
    assert (lost[0] + 1) / 30 == pytest.approx(flight.pilot.config.supervisor.max_pose_age_s, abs=2 / 30)
    assert steps[-1].permit.setpoint == HOVER
    assert set(flight.drone.sent[-10:]) == {HOVER}
    assert flight.turns(0.2)[-1].verdict.mode is Mode.FOLLOWING, "seen again: followed again"


def test_a_movement_does_not_go_on_after_the_operator_was_lost() -> None:
    flight = Flight()
    flight.turns(1.2)
    flight.turn("orbit")
    flight.turns(0.5)
    assert flight.pilot.helm.movement.command is Command.ORBIT
    flight.turns(1.0, none)
    assert flight.pilot.helm.movement.command is None
    assert flight.turns(0.5)[-1].goal.tangential_m_s == 0.0


def test_stop_in_flight_holds_until_the_next_command() -> None:
    flight = Flight()
    flight.turns(1.2)
    flight.turn("left")
    flight.turns(0.5)
    assert flight.drone.sent[-1].velocity_m_s[1] < -0.1
    step = flight.turn("stop")
    assert step.verdict.mode is Mode.HOLDING
    assert flight.drone.sent[-1] == HOVER, "in the turn of the decision"
    assert flight.drone.asked == ["hold"] and flight.drone.asked_at_send == [], "the set-point goes first"
    flight.sight.at_m = (0.3, 0.2, 5.5)
    before = len(flight.drone.sent)
    flight.turns(1.9)
    assert len(flight.drone.sent) == before, "nothing is sent for two seconds"
    flight.turns(2.0)
    assert all(s.velocity_m_s == (0.0, 0.0, 0.0) for s in flight.drone.sent[before:])
    assert flight.drone.sent[-1].yaw_rate_rad_s < -0.05, "it turns to the operator"
    assert flight.turn("closer").verdict.mode is Mode.EXECUTING


def test_a_command_changes_the_setpoint_in_the_turn_in_which_it_is_decided() -> None:
    flight = Flight()
    flight.sight.at_m = (0.0, 0.2, 4.4)
    flight.turns(2.0)
    assert flight.drone.sent[-1].velocity_m_s[1] == pytest.approx(0.0, abs=1e-6)
    step = flight.turn("left")
    assert step.verdict.accepted is Command.LEFT
    assert flight.drone.sent[-1].velocity_m_s[1] < -0.005


def test_commands_come_once_a_second_at_most_but_stop_and_land_always() -> None:
    flight = Flight()
    flight.turns(1.2)
    assert flight.turn("left").verdict.accepted is Command.LEFT
    said = [flight.turn("up").verdict.accepted for _ in range(29)]
    assert said == [None] * 29
    assert [flight.turn("up").verdict.accepted for _ in range(2)].count(Command.UP) == 1
    assert flight.turn("stop").verdict.accepted is Command.STOP
    assert flight.turn("land").verdict.accepted is Command.LAND
    assert flight.drone.asked == ["hold", "land"]


def test_the_arms_come_down_between_two_commands() -> None:
    flight = Flight()
    flight.turns(1.2)
    flight.sight.arms_up = True
    assert flight.turn("left").verdict.accepted is Command.LEFT
    flight.turns(3.0)
    step = flight.turn("up")
    assert (step.command, step.verdict.accepted) == (Command.UP, None)
    assert "lower your arms" in step.verdict.reason
    assert flight.turn("stop").verdict.accepted is Command.STOP
    flight.sight.arms_up = False
    flight.turns(1.0)
    flight.sight.arms_up = True
    assert flight.turn("up").verdict.accepted is Command.UP


def test_labels_that_command_nothing_command_nothing() -> None:
    flight = Flight()
    flight.turns(0.5)
    for label in ("clap", "a1", ""):
        step = flight.turn(label)
        assert step.gesture is not None and step.command is None
    flight.turns(1.0)
    assert flight.turn("clap").command is None
    assert flight.turn("left").verdict.accepted is Command.LEFT, "and do not use up the second either"


def test_taking_off_needs_the_ground_and_an_operator_in_view() -> None:
    flight = Flight(FlightMode.DISARMED)
    assert flight.turn("take_off", none).verdict.mode is Mode.DISARMED, "nobody has been seen"
    flight.turns(2.0)
    flight.turns(1.0, none)
    assert flight.turn("take_off", none).verdict.mode is Mode.DISARMED, "nobody is in view any more"
    assert flight.drone.asked == [] and flight.drone.sent == []
    flight.turns(0.9)
    assert flight.turn("take_off").verdict.mode is Mode.DISARMED, "seen for less than a second"
    flight.turns(0.2)
    flight.prompter.shown_s = 0.5
    step = flight.turn("take_off")
    assert step.verdict.mode is Mode.DISARMED and "again to confirm" in step.verdict.reason
    flight.turns(1.2)
    assert flight.turn("take_off").verdict.mode is Mode.ARMING
    assert flight.turn().verdict.mode is Mode.TAKING_OFF
    assert flight.drone.asked == ["arm", "take off to 1.2 m"]
    assert flight.turns(0.5)[-1].verdict.mode is Mode.TAKING_OFF
    assert flight.drone.sent == [], "a drone that takes off is not steered"
    flight.drone.mode = FlightMode.HOLDING
    assert flight.turns(0.1)[-1].verdict.mode is Mode.FOLLOWING


def test_taking_off_in_the_air_and_other_commands_on_the_ground_do_nothing() -> None:
    flying = Flight()
    flying.turns(1.2)
    step = flying.turn("take_off")
    assert step.verdict.mode is Mode.FOLLOWING and step.verdict.reason == "take_off: not while following"
    assert flying.drone.asked == []
    grounded = Flight(FlightMode.DISARMED)
    for label in ("left", "up", "orbit", "stop", "land"):
        grounded.turns(1.1)
        assert grounded.turn(label).verdict.mode is Mode.DISARMED
    assert grounded.drone.asked == [] and grounded.drone.sent == []


def test_after_taking_off_the_drone_goes_to_its_goal_smoothly() -> None:
    flight = Flight(FlightMode.DISARMED)
    flight.sight.at_m = (0.0, 0.2, 5.9)
    flight.turns(1.2)
    flight.turn("take_off")
    flight.turn()
    flight.drone.mode = FlightMode.HOLDING
    flight.turn()
    goals = []
    for _ in range(180):
        goals.append(flight.turn().goal.distance_m)
        flight.sight.at_m = (0.0, 0.2, goals[-1] - 0.1)  # the drone does as it is told
    assert goals[0] == pytest.approx(6.0, abs=0.1)
    assert max(np.abs(np.diff(goals))) < 0.02
    assert goals[-1] == pytest.approx(4.5)


def test_the_drones_state_at_the_frames_stamp_places_the_operator() -> None:
    """The drone turns at 1 rad/s; frames are three turns late. The operator stands still in the world."""
    flight = Flight()
    operator = np.array([4.5, 0.5, 1.0])
    headings: dict[int, float] = {}
    for k in range(1, 31):
        now_ns, heading = k * PERIOD_NS, k / 30
        headings[now_ns] = heading
        flight.drone.state = VehicleState(np.array([0, 0, 1.2]), np.zeros(3), heading, now_ns)
        stamp_ns = max(k - 3, 1) * PERIOD_NS
        cos, sin = np.cos(headings[stamp_ns]), np.sin(headings[stamp_ns])
        forward, left = cos * operator[0] + sin * operator[1], -sin * operator[0] + cos * operator[1]
        flight.sight.at_m = (-left, 0.2, forward - 0.1)
        movement = flight.pilot.step(good(stamp_ns), now_ns).movement
        if movement is not None:
            assert movement.joints[0, 0] == pytest.approx(0.0, abs=0.01), "the spotter sees no turn"
    track = flight.pilot.track
    assert track.position_m(now_ns)[:2] == pytest.approx(operator[:2], abs=0.01)
    assert np.linalg.norm(track.velocity_m_s) < 0.05


def test_the_spotter_sees_the_operator_level_however_the_drone_is_tilted() -> None:
    still, tilted = Flight(), Flight()
    joints = np.random.default_rng(0).normal(0, 0.4, (13, 3)) + np.array([0.0, 0.2, 4.5])
    pitch = 0.3
    cos, sin = np.cos(pitch), np.sin(pitch)
    # A nose that is down sees what is ahead higher up: the same joints, in a camera that turned with it.
    ahead = joints[:, 2] + 0.1
    seen = np.stack(
        [joints[:, 0], cos * joints[:, 1] - sin * ahead, sin * joints[:, 1] + cos * ahead - 0.1], 1
    )
    shown = []
    for flight, points, angle in ((still, joints, 0.0), (tilted, seen, pitch)):
        flight.drone.state = VehicleState(np.array([0, 0, 1.2]), np.zeros(3), 0.0, S, 0.0, angle)
        flight.pilot.pose = lambda frame, points=points: Pose(points, np.ones(13), frame.stamp_ns)
        shown.append(flight.pilot.step(good(S), S).movement)
    assert shown[0] is not None and shown[1] is not None
    np.testing.assert_allclose(shown[1].joints, shown[0].joints, atol=1e-9)


def test_the_spotter_sees_no_climb_of_the_drone_but_that_of_the_operator() -> None:
    """The drone climbs at 0.5 m/s, and its frames are three turns late; then the operator squats by 0.3 m."""
    flight, heights = Flight(), []
    for k in range(1, 61):
        now_ns, stamp_ns = k * PERIOD_NS, max(k - 3, 1) * PERIOD_NS
        flight.drone.state = VehicleState(np.array([0, 0, 1.2 + k / 60]), np.zeros(3), 0.0, now_ns)
        hips_m = 1.0 if k <= 30 else 0.7
        flight.sight.at_m = (0.0, 1.2 + stamp_ns / PERIOD_NS / 60 - hips_m, 4.5)
        movement = flight.pilot.step(good(stamp_ns), now_ns).movement
        if movement is not None:
            heights.append(-float(movement.hip_center[1]))
    np.testing.assert_allclose(heights[:27], 1.0, atol=1e-6)
    np.testing.assert_allclose(heights[-25:], 0.7, atol=1e-6)


def test_a_vehicle_whose_state_is_stale_is_held() -> None:
    flight = Flight()
    flight.turns(0.5)
    stale = flight.drone.state
    for _ in range(20):
        flight.now_ns += PERIOD_NS
        flight.drone.state = stale
        step = flight.pilot.step(good(flight.now_ns), flight.now_ns)
    assert step.verdict.mode is Mode.HOLDING
    assert flight.drone.sent[-1] == HOVER
    assert flight.drone.asked == ["hold"]


def test_a_recogniser_that_raises_is_told_to_the_supervisor_and_ends_nothing() -> None:
    flight = Flight()
    flight.turns(1.2)

    def fail(pose: Pose | None) -> Gesture | None:
        raise RuntimeError("no such class")

    heard, flight.prompter.update = flight.prompter.update, fail  # type: ignore[method-assign]
    assert flight.turn().verdict.mode is Mode.HOLDING
    assert "no such class" in flight.pilot.trouble
    flight.prompter.update = heard  # type: ignore[method-assign]
    flight.turns(1.0)
    assert flight.turn("left").verdict.mode is Mode.EXECUTING, "it decides again"
    assert flight.turn().situation.deaf_ns is None


def test_a_pose_network_that_raises_is_a_frame_without_a_pose() -> None:
    flight = Flight()
    flight.turns(1.0)

    def fail(frame: Frame) -> Pose | None:
        raise MemoryError("network")

    flight.pilot.pose = fail
    steps = flight.turns(1.0)
    assert steps[-1].verdict.mode is Mode.LOST_PERSON
    assert "network" in flight.pilot.trouble


def test_somebody_elsewhere_is_not_the_operator_and_is_not_listened_to() -> None:
    flight = Flight()
    flight.turns(2.0)
    flight.sight.at_m = (1.9, 0.2, 4.5)
    steps = flight.turns(0.9)
    assert all(step.pose is not None and step.movement is None for step in steps)
    assert steps[-1].verdict.mode is Mode.LOST_PERSON
    last = flight.turns(1.0)[-1]
    assert last.verdict.mode is Mode.HOLDING and last.situation.person == 1
    assert flight.drone.asked == ["hold"]


def test_what_is_decided_after_a_slow_pose_is_decided_at_its_time() -> None:
    flight = Flight()
    flight.pilot.time_ns = lambda: flight.now_ns + 40_000_000
    step = flight.turns(0.2)[-1]
    assert step.situation.now_ns == flight.now_ns + 40_000_000


def test_every_mode_of_a_vehicle_means_something() -> None:
    assert set(CRAFT) == set(FlightMode)
    assert set(CRAFT.values()) == set(Craft)


def test_a_goal_outside_the_bounds_is_an_error() -> None:
    with pytest.raises(InputError, match=r"altitude_m is 9\.0, but has to be from 0\.8 to 2\.0"):
        PilotConfig(goal=Goal(altitude_m=9.0))
    with pytest.raises(InputError, match="max_altitude_m is 5"):
        PilotConfig(movement=MovementConfig(max_altitude_m=5.0))


def test_processor_time_is_measured_with_the_clock_given_and_decides_nothing() -> None:
    ticks = iter(range(1000))
    flight = Flight()
    flight.pilot.clock = lambda: next(ticks) * 0.5
    step = flight.turn()
    assert (step.pose_s, step.rest_s) == (0.5, 0.5)


class Engager(Sight):
    """A pose source that knows who commands."""

    class Somebody:
        def __init__(self, number: int) -> None:
            self.number = number

    def __init__(self) -> None:
        super().__init__()
        self.operator: Engager.Somebody | None = None


def engaging() -> tuple[Flight, Engager]:
    flight, sight = Flight(), Engager()
    flight.sight = flight.pilot.pose = sight
    return flight, sight


def test_commands_count_a_second_after_somebody_engaged_and_stop_at_once() -> None:
    flight, sight = engaging()
    flight.turns(3.0)
    assert "nobody has been the operator" in flight.turn("left").verdict.reason
    assert flight.turn("stop").verdict.accepted is Command.STOP
    sight.operator = Engager.Somebody(4)
    flight.turns(0.8)
    assert flight.turn("left").verdict.accepted is None
    flight.turns(0.5)
    assert flight.turn("left").verdict.accepted is Command.LEFT


def test_somebody_else_who_engages_is_another_person_and_one_who_lets_go_is_not() -> None:
    flight, sight = engaging()
    sight.operator = Engager.Somebody(4)
    flight.turns(2.0)
    sight.operator = None
    assert flight.turns(0.5)[-1].verdict.mode is Mode.FOLLOWING
    sight.operator = Engager.Somebody(4)
    assert flight.turns(0.5)[-1].situation.person == 0
    sight.operator = Engager.Somebody(9)
    step = flight.turn()
    assert (step.verdict.mode, step.situation.person) == (Mode.HOLDING, 1)
    flight.turns(1.2)
    assert flight.turn("left").verdict.mode is Mode.EXECUTING


def test_what_the_console_asks_for_comes_first_and_is_confirmed() -> None:
    flight = Flight()
    flight.turns(1.2)
    flight.prompter.label = "left"
    flight.now_ns += PERIOD_NS
    step = flight.pilot.step(good(flight.now_ns), flight.now_ns, Command.LAND)
    assert step.verdict.accepted is Command.LAND and flight.drone.asked == ["land"]


def test_a_vehicle_found_in_the_air_may_be_held_until_the_first_command() -> None:
    flight = Flight()
    drone = Drone(FlightMode.HOLDING)
    pilot = Pilot(flight.sight, Silent(), drone, clock=lambda: 0.0, in_the_air=Mode.HOLDING)  # type: ignore[arg-type]
    drone.state = VehicleState(np.array([0.0, 0.0, 1.2]), np.zeros(3), 0.0, S)
    assert pilot.step(good(S), S).verdict.mode is Mode.HOLDING


def seeing(config: PilotConfig) -> Flight:
    flight = Flight()
    flight.pilot = Pilot(flight.sight, Silent(), flight.drone, clock=lambda: 0.0, config=config)  # type: ignore[arg-type]
    flight.pilot.spotter = flight.prompter  # type: ignore[assignment]
    return flight


def test_what_the_camera_would_not_see_is_not_flown_and_that_is_told() -> None:
    def wide(now_ns: int) -> Frame:
        return Frame(PICTURE, DEPTH, Intrinsics(fy=300.0), now_ns)

    for frame, says in ((good, "up: 0.2 m instead of 0.4 m; the camera would not see your legs"), (wide, "")):
        flight = seeing(PilotConfig(goal=Goal(3.0, 1.2)))
        flight.sight.at_m = (0.0, 0.2, 2.9)
        flight.turns(1.5, frame)
        step = flight.turn("up", frame)
        assert step.verdict.accepted is Command.UP and step.verdict.mode is Mode.EXECUTING
        assert step.verdict.reason.startswith(says) and bool(step.verdict.reason) == bool(says)


def test_a_camera_that_looks_down_sees_the_operator_from_higher() -> None:
    def over_hips_m(pitch_rad: float) -> float:
        bounds = MovementConfig(min_altitude_m=0.6, max_altitude_m=4.0)
        flight = seeing(PilotConfig(mount=Mount(pitch_down_rad=pitch_rad), movement=bounds))
        flight.turns(1.5)
        helm = flight.pilot.helm
        assert helm.law.level_m is not None
        return helm.movement.heights_m(4.5)[1] - helm.law.level_m

    assert over_hips_m(0.0) == pytest.approx(0.92, abs=0.01)
    assert over_hips_m(0.25) == pytest.approx(2.27, abs=0.01)
