"""Ten thousand turns of whatever may happen, over and over: what never comes out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.fly.scene import S, Scene, flying
from wigwag.fly.fence import Cylinder, Fence, Polygon
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Mode
from wigwag.fly.supervisor import FLYING, STEERED
from wigwag.fly.transitions import TABLE
from wigwag.fly.values import Command, Setpoint
from wigwag.sim.response import Response, ResponseConfig, ardupilot_like, px4_like

TURNS = 10_000
FENCES: tuple[Fence, ...] = (
    Cylinder(12.0), Polygon(((-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (0.0, 3.0), (-9.0, 9.0)))
)  # fmt: skip
seeds = st.integers(0, 2**32 - 1)
SETTINGS = settings(max_examples=4, deadline=None)


STUCK = {"pose_ns": 60, "state_ns": 100, "link_ns": 200, "camera_ns": 200, "rested_ns": 60}
"""For how many turns a stamp stays where it is, about."""
CHANGES: tuple[tuple[str, int, tuple[object, ...]], ...] = (
    ("battery", 600, (0.2, 0.05, None)), ("battery", 100, (0.8,)), ("healthy", 600, (False,)),
    ("healthy", 100, (True,)), ("person", 700, tuple(range(9))), ("moving", 90, (False,)),
)  # fmt: skip
"""What is told otherwise, how often, and how."""


class Weather:
    """Turns everything that may go wrong on and off, at random."""

    def __init__(self, seed: int) -> None:
        self.rng, self.nonsense = np.random.default_rng(seed), np.random.default_rng([seed, 1])
        self.scene = Scene(config=SupervisorConfig(fence=FENCES[seed % 2]))
        self.at = np.array([0.0, 0.0, 1.5])

    def happens(self, once_in: float) -> bool:
        return bool(self.rng.random() < 1.0 / once_in)

    def turn(self) -> tuple[Command | None, float]:
        """Let one turn pass; return the command that was given and how long it was shown."""
        self.change()
        self.move()
        scene, rng = self.scene, self.rng
        scene.wish = self.wish()
        command = list(Command)[int(rng.integers(len(Command)))] if self.happens(40) else None
        if scene.mode in (Mode.DISARMED, Mode.READY) and self.happens(40):
            command = Command.TAKE_OFF
        held_s = float(rng.uniform(0.0, 2.5))
        passed_s = 1 / 30 if not self.happens(2000) else float(rng.choice([-40.0, -0.5, 0.0, 3.0, 90.0]))
        scene.turn(command, held_s, passed_s)
        return command, held_s

    def change(self) -> None:
        """Turn things on and off."""
        scene, rng = self.scene, self.rng
        for name in ("pose_ns", "state_ns", "link_ns", "camera_ns", "rested_ns"):
            if name in scene.stuck and self.happens(STUCK[name]):
                scene.free(name)
            elif name not in scene.stuck and self.happens(1500):
                scene.stick(name)
        for name, once_in, values in CHANGES:
            if self.happens(once_in):
                scene.known[name] = values[int(rng.integers(len(values)))]
        if self.happens(900):
            scene.ages["deaf_ns"] = None if scene.ages["deaf_ns"] is not None else 0.0
        if self.happens(600):
            scene.ages["engaged_ns"] = [None, 0.2, 60.0, 60.0][int(rng.integers(4))]
        if self.happens(1200):
            scene.craft = list(Craft)[int(rng.integers(len(Craft)))]
        elif scene.craft in (Craft.OWN, Craft.PILOTED) and self.happens(60):
            scene.craft = Craft.AIRBORNE

    def move(self) -> None:
        """Let vehicle and person be somewhere else."""
        scene, rng = self.scene, self.rng
        self.at += rng.normal(0.0, [0.1, 0.1, 0.03])
        self.at[2] = abs(self.at[2])
        if self.happens(900):
            self.at = np.array([0.0, 0.0, 1.5])
        distance = scene.known["distance_m"]
        distance = (
            4.0 if distance is None or not math.isfinite(distance) else abs(distance + rng.normal(0.0, 0.1))
        )
        scene.known.update(
            position_m=(float(self.at[0]), float(self.at[1]), float(self.at[2])),
            heading_rad=float(rng.uniform(-math.pi, math.pi)),
            bearing_rad=float(rng.normal(0.0, 0.3)),
            distance_m=None if self.happens(300) else min(distance, 12.0),
        )
        if self.nonsense.random() < 1 / 2000:
            name = str(self.nonsense.choice(["heading_rad", "bearing_rad", "distance_m", "position_m"]))
            value = float(self.nonsense.choice([math.nan, math.inf]))
            scene.known[name] = (0.0, value, 1.0) if name == "position_m" else value

    def wish(self) -> Setpoint:
        values = self.rng.normal(0.0, 2.0, 4)
        if self.happens(50):
            values[int(self.rng.integers(4))] = self.rng.choice([math.nan, math.inf, -math.inf, 1e308])
        return Setpoint((float(values[0]), float(values[1]), float(values[2])), float(values[3]))


@SETTINGS
@given(seeds)
@example(0)
@example(1)
def test_whatever_happens(seed: int) -> None:
    weather = Weather(seed)
    scene, limits = weather.scene, weather.scene.supervisor.config
    confirmed_ns = shown_ns = stopped_ns = -(10**12)
    now_ns = 0  # a clock of our own, which nobody sets back
    for _ in range(TURNS):
        before, told_ns = scene.mode, scene.now_ns
        command, held_s = weather.turn()
        now_ns += max(0, scene.now_ns - told_ns)
        verdict, setpoint = scene.verdict, scene.sent[-1]
        if command is Command.TAKE_OFF:
            again = 0 <= now_ns - shown_ns <= limits.confirm_within_s * S
            if held_s >= limits.take_off_held_s or again:
                confirmed_ns = now_ns
            shown_ns = now_ns
        if verdict.action is Action.ARM:
            assert confirmed_ns == now_ns, "armed without confirmation"
        if verdict.action is Action.TAKE_OFF:
            assert 0 <= now_ns - confirmed_ns <= (limits.arming_s + 1) * S, "taking off without confirmation"
        if command is Command.STOP:
            stopped_ns = now_ns if verdict.accepted is command else stopped_ns
            if before in FLYING | {Mode.FAILSAFE} and scene.craft not in (Craft.PILOTED, Craft.DOWN):
                assert (verdict.mode, verdict.action) == (Mode.HOLDING, Action.HOLD)
        if verdict.accepted not in (None, Command.STOP, Command.LAND):
            stopped_ns = -(10**12)
        if verdict.mode in (Mode.PILOT, Mode.FAILSAFE):
            assert verdict.action is Action.NONE and setpoint is None
        if setpoint is not None:
            assert verdict.mode in STEERED and scene.craft is Craft.AIRBORNE
            check(setpoint, scene, limits)
            if 0 <= now_ns - stopped_ns < 2 * S and verdict.mode is Mode.HOLDING:
                assert setpoint.velocity_m_s == (0.0, 0.0, 0.0), "moving after a stop"


def test_whatever_happens_gets_everywhere() -> None:
    modes, rows = set(), set()
    for seed in range(4):
        weather = Weather(seed)
        for _ in range(TURNS):
            weather.turn()
            modes.add(weather.scene.mode)
        rows |= set(weather.scene.rows)
    assert modes == set(Mode)
    assert len(rows) >= 0.75 * len(TABLE), {row.name for row in TABLE} - rows


def check(setpoint: Setpoint, scene: Scene, limits: SupervisorConfig) -> None:
    """Nothing leads beyond a limit."""
    forward, left, up = setpoint.velocity_m_s
    assert all(map(math.isfinite, (forward, left, up, setpoint.yaw_rate_rad_s)))
    assert math.hypot(forward, left) <= limits.max_speed_m_s + 1e-9
    assert abs(up) <= limits.max_climb_m_s + 1e-9
    assert abs(setpoint.yaw_rate_rad_s) <= limits.max_yaw_rate_rad_s
    known = scene.known
    told = (*known["position_m"], known["heading_rad"], known["bearing_rad"], known["distance_m"] or 0.0)
    if not all(map(math.isfinite, told)):
        assert (forward, left, up) == (0.0, 0.0, 0.0), "by what is no number nothing moves"
        return
    if known["distance_m"] is not None and setpoint.velocity_m_s != (0.0, 0.0, 0.0):
        ahead = forward * math.cos(known["bearing_rad"]) + left * math.sin(known["bearing_rad"])
        assert ahead <= max(0.8 * (known["distance_m"] - limits.min_distance_m), 0.0) + 1e-9
        assert -ahead <= max(0.8 * (limits.max_distance_m - known["distance_m"]), 0.0) + 1e-9
    east, north, height = known["position_m"]
    assert up >= -max(0.8 * (height - limits.floor_m), 0.0) - 1e-9
    assert up <= max(0.8 * (limits.ceiling_m - height), 0.0) + 1e-9
    turn = known["heading_rad"]
    x = forward * math.cos(turn) - left * math.sin(turn)
    y = forward * math.sin(turn) + left * math.cos(turn)
    for wall in limits.fence.walls(east, north):
        assert x * wall.east + y * wall.north <= max(0.8 * wall.distance_m, 0.0) + 0.02


FAULTS: dict[str, tuple[float, frozenset[Mode]]] = {
    "state_ns": (0.6, frozenset({Mode.HOLDING, Mode.EMERGENCY})),
    "link_ns": (1.1, frozenset({Mode.LOST_LINK, Mode.LANDING})),
    "pose_ns": (31.2, frozenset({Mode.HOLDING, Mode.LANDING})),
    "camera_ns": (11.2, frozenset({Mode.LANDING})),
    "deaf": (0.1, frozenset({Mode.HOLDING})),
    "swap": (0.1, frozenset({Mode.HOLDING})),
    "battery": (0.1, frozenset({Mode.LANDING})),
    "critical": (0.1, frozenset({Mode.EMERGENCY})),
    "health": (2.2, frozenset({Mode.LANDING})),
    "outside": (0.1, frozenset({Mode.EMERGENCY})),
    "jump": (0.1, frozenset({Mode.HOLDING})),
}
"""Each fault: within what time it ends in which modes. Out of touch, the vehicle was asked to hold."""


@pytest.mark.parametrize("fault", FAULTS)
@given(seed=seeds)
@settings(max_examples=5, deadline=None)
def test_every_fault_ends_in_its_time_and_the_flight_on_the_ground(fault: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    scene = flying(mode=[Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON][int(rng.integers(3))])
    scene.free("pose_ns")
    scene.turns(float(rng.uniform(0.0, 0.4)))
    within_s, ends = FAULTS[fault]
    passed_s = 1 / 30
    match fault:
        case "deaf":
            scene.ages["deaf_ns"] = 0.0
        case "swap":
            scene.known["person"] = 1
        case "battery" | "critical":
            scene.known["battery"] = 0.2 if fault == "battery" else 0.1
        case "health":
            scene.known["healthy"] = False
        case "outside":
            scene.known["position_m"] = (0.0, 33.0, 1.5)
        case "jump":
            passed_s = float(rng.choice([-60.0, -1.0, 1.0, 60.0]))
        case "camera_ns":
            scene.stick("camera_ns", "pose_ns")
        case _:
            scene.stick(fault)
    scene.turn(passed_s=passed_s)
    began_ns = scene.now_ns
    while scene.mode not in ends:
        scene.turn()
        assert scene.now_ns - began_ns <= within_s * S, f"{scene.mode} after {within_s} s"
    scene.turns(float(rng.uniform(1.0, 5.0)))
    scene.turn(Command.LAND)
    scene.turns(4.0)
    assert scene.mode in (Mode.DISARMED, Mode.HOLDING, Mode.EMERGENCY, Mode.LANDING)
    assert scene.craft is Craft.DOWN


AIRFRAMES = (ResponseConfig, px4_like, ardupilot_like)


@SETTINGS
@given(seed=seeds)
@example(seed=5)
def test_a_drone_is_never_brought_closer_than_the_minimum(seed: int) -> None:
    """Whatever is wished, flown by a vehicle that answers late. The person stands, or walks towards it."""
    rng = np.random.default_rng(seed)
    drone = Response(AIRFRAMES[seed % 3](position_m=(0.0, 0.0, 1.5)), seed)  # type: ignore[operator]
    scene = Scene(config=SupervisorConfig(fence=Cylinder(500.0)), mode=Mode.FOLLOWING)
    limits = scene.supervisor.config
    person, walking, near_s = np.array([4.0, 0.0]), np.zeros(2), 0.0
    wish = np.zeros(4)
    for _ in range(TURNS):
        state = drone.state
        seen = person - state.position_m[:2] + rng.normal(0.0, 0.02, 2)
        scene.known.update(
            position_m=tuple(map(float, state.position_m)), heading_rad=state.heading_rad,
            distance_m=float(np.hypot(*seen)), bearing_rad=math.atan2(seen[1], seen[0]) - state.heading_rad,
        )  # fmt: skip
        if rng.random() < 0.02:
            wish = rng.normal(0.0, [2.0, 2.0, 0.3, 1.0])
            towards = np.array([math.cos(scene.known["bearing_rad"]), math.sin(scene.known["bearing_rad"])])
            wish[:2] = wish[:2] if rng.random() < 0.5 else 1.5 * towards
        if rng.random() < 0.005:
            line = (state.position_m[:2] - person) / np.hypot(*(state.position_m[:2] - person))
            walking = line * rng.choice([0.0, 0.0, 0.5])
        scene.wish = Setpoint((float(wish[0]), float(wish[1]), float(wish[2])), float(wish[3]))
        scene.turn()
        drone.step(scene.sent[-1] or Setpoint(), 1 / 30)
        person = person + walking / 30
        away = person - drone.state.position_m[:2]
        distance = float(np.hypot(*away))
        own = float(drone.state.velocity_m_s[:2] @ away) / distance
        if distance < limits.min_distance_m - 0.12:
            near_s += 1 / 30
            assert walking.any() or near_s < 3.0, "closer than allowed, and nobody walked there"
            assert own < 0.05 or near_s < 0.8, "it goes on towards the person"
        else:
            near_s = 0.0
        if not walking.any() and near_s == 0.0:
            assert distance >= limits.min_distance_m - 0.12
    assert scene.mode in (Mode.FOLLOWING, Mode.LOST_PERSON)


@given(st.floats(0.1, 1.99), st.floats(-1, 1), st.floats(-5, 5), st.floats(-5, 5))
def test_too_close_always_retreats(distance: float, bearing: float, forward: float, left: float) -> None:
    scene = flying(config=SupervisorConfig(max_speed_m_s=20.0, fence=Cylinder(100.0)))
    scene.known.update(distance_m=distance, bearing_rad=bearing)
    scene.wish = Setpoint((forward, left, 0.0))
    scene.turn()
    assert (setpoint := scene.sent[-1]) is not None
    ahead = np.array([math.cos(bearing), math.sin(bearing)])
    assert np.array(setpoint.velocity_m_s[:2]) @ ahead <= -0.6 + 1e-9
