"""A recorded flight is decided again alike; another model, or other limits, show what they would change."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.record.flights import SAID, flight, picture, record
from wigwag.camera.frame import Frame
from wigwag.errors import InputError
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot
from wigwag.record.codec import text
from wigwag.record.flight import Flight
from wigwag.record.recorder import Recorder
from wigwag.record.replay import Comparison, Replay
from wigwag.skeleton import Clip, Pose


def compare(replay: Replay) -> Comparison:
    compared = Comparison()
    for then, now in replay:
        compared.note(then, now)
    return compared


class Namer:
    """Calls every movement by one name."""

    def __init__(self, label: str) -> None:
        self.label = label

    def recognise(self, clip: Clip) -> Gesture:
        return Gesture(self.label, min(1.0, clip.duration_s / 9.0), reason=f"{clip.joints.sum()!r}")


def test_a_flight_is_decided_again_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    record(path, pictures=True)
    compared = compare(Replay(Flight.open(path)))
    assert compared.same and compared.turns == 420 and compared.poses == 0
    assert [label for _, label in compared.heard] == [c.value for c in SAID.values()] == [
        label for _, label in compared.heard_now
    ]  # fmt: skip
    assert compared.differences == [] and compared.duration_s == pytest.approx(419 / 30)


def test_other_limits_show_what_they_would_change(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    record(path)
    flown = Flight.open(path)
    slow = replace(flown.config, supervisor=SupervisorConfig(max_speed_m_s=0.05))
    compared = compare(Replay(flown, config=slow))
    assert not compared.same and compared.setpoints > 30 and compared.most_m_s > 0.1
    assert compared.gestures == 0 and compared.first_s is not None and compared.first_s > 3.7


@pytest.mark.parametrize("engaging", [False, True])
def test_what_hears_is_part_of_it_and_another_one_differs(tmp_path: Path, engaging: bool) -> None:
    """Real listening on poses that move, with late clocks, frames that fail, somebody at the console."""
    path, flown = tmp_path / "flight.mcap", flight()

    class Eyes:
        def __call__(self, frame: Frame) -> Pose | None:
            turn = round(frame.stamp_ns * 30e-9)
            if turn % 50 == 49:
                raise RuntimeError("a network that fails")
            pose = flown.world(frame)
            if pose is None or turn % 90 < 45:
                return pose
            joints = pose.joints.copy()
            joints[5:7, 1] -= 0.02 * min(turn % 90 - 45, 25)
            return replace(pose, joints=joints)

    class Engaged(Eyes):
        class operator:  # a value with a number
            number = 4

    late = [0]
    pilot = Pilot(
        Engaged() if engaging else Eyes(), Namer("up"), flown.world.vehicle, clock=lambda: 0.0,
        time_ns=lambda: flown.world.now_ns + late[0],
    )  # fmt: skip
    recorder = Recorder(path, pilot, patient=True)
    steps = []
    for turn in range(400):
        frame = flown.world.step()
        late[0] = 3_000_000 + 1000 * (turn % 7)
        asked = {60: Command.TAKE_OFF, 330: Command.LAND}.get(turn)
        steps.append(pilot.step(frame, flown.world.now_ns, asked))
        recorder.turn(frame, flown.world.now_ns, steps[-1])
    recorder.close()
    heard = [step.gesture for step in steps if step.gesture is not None]
    assert len(heard) > 3 and any(step.verdict.mode is Mode.EXECUTING for step in steps)
    recorded = Flight.open(path)
    assert recorded.tells_operator == engaging
    same = Replay(recorded)
    same.pilot.spotter = type(pilot.spotter)(Namer("up"))  # type: ignore[call-arg]
    compared = compare(same)
    assert compared.same and [label for _, label in compared.heard] == ["up"] * len(heard)
    again = [text(now.situation) for _, now in Replay(recorded)]
    assert again == [text(step.situation) for step in steps]
    other = Replay(recorded)
    other.pilot.spotter = type(pilot.spotter)(Namer("down"))  # type: ignore[call-arg]
    compared = compare(other)
    assert compared.gestures == len(heard) and compared.differences[0].what == "gesture"
    assert compared.differences[0].now.startswith("down") and not compared.same


def test_frames_that_are_not_there_are_asked_for_in_vain(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    record(path, 5)
    with pytest.raises(InputError, match="holds no pictures that wigwag found poses in"):
        Replay(Flight.open(path), material="frames")


def test_one_that_is_still_being_written_can_be_decided_again(tmp_path: Path) -> None:
    path, flown = tmp_path / "flight.mcap", flight()
    recorder = Recorder(path, flown.pilot, patient=True)
    for turn in range(200):
        step = flown.turn(SAID.get(turn))
        recorder.turn(picture(turn), flown.world.now_ns, step)
    compared = compare(Replay(Flight.open(path)))
    assert compared.same and compared.turns > 150
    recorder.close()
