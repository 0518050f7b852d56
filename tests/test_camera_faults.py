"""Real pixels through the real network: what a camera's faults do to a drone in flight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from wigwag.camera import Frame
from wigwag.camera.watchdog import Watchdog
from wigwag.errors import ModelError
from wigwag.evaluate.prompted import Nobody, Prompter
from wigwag.fly.situation import Mode
from wigwag.fly.values import HOVER
from wigwag.pilot import Pilot
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.sim.motion import Operator
from wigwag.sim.person import Person
from wigwag.sim.script import Script
from wigwag.sim.world import World, WorldConfig


class Chain:
    """A drone that hovers before a rendered person, and the chain that flies it."""

    def __init__(self) -> None:
        person = Person.random(4)
        operator = Operator(person, Script((), (), (), 60.0), position_m=(5.8, 0.3), seed=4)
        self.world = World(WorldConfig(), 4, operator)
        try:
            pose = PoseEstimator(PoseConfig.alone())
        except ModelError as error:
            pytest.skip(f"the pose networks are not here: {error}")
        self.pilot = Pilot(pose, Nobody(), self.world.vehicle)
        self.pilot.spotter = Prompter()  # type: ignore[assignment]
        self.watchdog = Watchdog()

    def turns(self, seconds: float, fault: Callable[[Frame], Frame | None]) -> list[Mode]:
        modes = []
        for _ in range(round(seconds * 30)):
            frame, now_ns = fault(self.world.step()), self.world.now_ns
            health = self.watchdog.check(now_ns) if frame is None else self.watchdog.see(frame, now_ns)
            self.step = self.pilot.step(frame if health.usable else None, now_ns)
            modes.append(self.step.verdict.mode)
        return modes


def lost(frame: Frame) -> Frame | None:
    return None


def black(frame: Frame) -> Frame | None:
    return replace(frame, rgb=np.zeros_like(frame.rgb))


def blind_depth(frame: Frame) -> Frame | None:
    assert frame.depth_mm is not None
    return replace(frame, depth_mm=np.zeros_like(frame.depth_mm))


class Frozen:
    """The same picture again and again, under new stamps."""

    def __init__(self) -> None:
        self.first: Frame | None = None

    def __call__(self, frame: Frame) -> Frame | None:
        self.first = self.first or frame
        return replace(self.first, stamp_ns=frame.stamp_ns)


@pytest.mark.parametrize(
    "fault", [lost, black, blind_depth, Frozen()], ids=["lost", "black", "no depth", "frozen"]
)
def test_without_pictures_of_now_it_stops_within_a_second_and_goes_on_with_them(
    fault: Callable[[Frame], Frame | None],
) -> None:
    chain = Chain()
    assert set(chain.turns(1.5, lambda frame: frame)[-20:]) == {Mode.FOLLOWING}
    assert chain.step.permit.setpoint is not None and chain.step.permit.setpoint.velocity_m_s[0] > 0.1
    modes = chain.turns(1.2, fault)
    stopped_s = modes.index(Mode.LOST_PERSON) / 30
    assert stopped_s < 0.7
    assert chain.step.permit.setpoint == HOVER
    speed = np.linalg.norm(chain.world.truth_now.drone.velocity_m_s)
    assert speed < 0.35
    assert chain.turns(1.5, lambda frame: frame)[-1] is Mode.FOLLOWING
