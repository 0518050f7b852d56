"""The way from camera to pose, measured with stand-ins for the engine."""

from __future__ import annotations

import json

import numpy as np
import pytest

from wigwag.errors import WigwagError
from wigwag.evaluate import chain, memory
from wigwag.evaluate.chain import Measured, Slowed, besides, following, lateness, searching
from wigwag.evaluate.pictures import moving
from wigwag.pose.body import Body


@pytest.fixture(scope="module")
def frames():
    return list(moving(0.2, seed=3))


class Actor:
    """Finds somebody in the middle of the picture, but not in frames whose turn is on its list."""

    def __init__(self, *empty: int) -> None:
        self.empty, self.turn, self.resets = empty, -1, 0
        points = np.linspace([310.0, 180.0], [330.0, 320.0], 33)
        self.body = Body(points, np.ones(33), np.zeros((33, 3)), None, None)

    def detect(self, rgb: np.ndarray) -> Body | None:
        return self.track(rgb)

    def track(self, rgb: np.ndarray) -> Body | None:
        self.turn += 1
        return None if self.turn in self.empty else self.body

    def reset(self) -> None:
        self.resets += 1


class Ticking:
    """A clock that goes on by as much whenever it is read."""

    def __init__(self, step_s: float) -> None:
        self.now_s, self.step_s = 0.0, step_s

    def __call__(self) -> float:
        self.now_s += self.step_s
        return self.now_s


def test_following_counts_frames_between_two_with_somebody(frames) -> None:
    measured = following(Actor(2), frames, clock=Ticking(0.010))
    row = measured.row()
    assert len(frames) == 6
    assert row["frames"] == 3  # the second, and the last two
    assert row["ms_median"] == pytest.approx(10.0)
    assert row["frames_per_s"] == pytest.approx(100.0)


def test_searching_forgets_whom_it_finds(frames) -> None:
    engine = Actor(0, 1, 2, 4, 5)
    row = searching(engine, frames, "nobody", clock=Ticking(0.040)).row()
    assert (row["measure"], row["frames"], row["frames_per_s"]) == ("nobody", 6, 25.0)
    assert engine.resets == 2, "when it begins, and after the one frame with somebody"


def test_a_slowed_engine_takes_its_period_and_no_more_than_it_must() -> None:
    waited: list[float] = []
    slow = Slowed(Actor(), 0.5, clock=Ticking(0.1), wait=waited.append)
    assert slow.track(np.zeros((4, 4, 3), np.uint8)) is not None
    assert slow.detect(np.zeros((4, 4, 3), np.uint8)) is not None
    assert waited == pytest.approx([0.4, 0.4])
    slow.period_s = 0.05
    slow.track(np.zeros((4, 4, 3), np.uint8))
    assert waited[-1] == 0.0


def test_the_engines_own_work_is_not_what_comes_besides_it(frames) -> None:
    measured = besides(Actor(), frames[:3], clock=Ticking(0.01))
    assert measured.ms == pytest.approx([20.0] * 3), "two of three ticks: before and after the engine's own"


def test_lateness_is_measured_on_a_live_camera(frames) -> None:
    row = lateness(Actor(), frames, 200.0, 5).row()
    assert row["measure"] == "from stamp to pose, 200 Hz"
    assert row["frames"] == 5
    assert 0 < row["ms_median"] <= row["ms_p95"] <= row["ms_max"]
    assert row["frames_per_s"] is None, "the age of a frame is no processor time"
    assert row["skipped"] is not None


def test_memory_is_that_of_a_process_of_its_own(frames, monkeypatch) -> None:
    said = {"peak_mb": 200.0, "rounds_mb": [190.0, 199.5], "found": 3}
    commands = []

    def answer(command, **_):
        folder = command[3]
        assert json.loads(chain.Path(folder, "camera.json").read_text())["color"]["width"] == 640
        assert len(list(chain.Path(folder, "depth").iterdir())) == len(frames)
        commands.append(command)
        return chain.subprocess.CompletedProcess(command, 0, json.dumps(said), "")

    monkeypatch.setattr(chain.subprocess, "run", answer)
    row = chain.memory(frames).row()
    assert (row["rss_mb"], row["grown_mb"], row["frames"]) == (200.0, 9.5, 0)
    assert commands[0][1:3] == ["-m", "wigwag.evaluate.memory"]
    monkeypatch.setattr(
        chain.subprocess, "run", lambda c, **_: chain.subprocess.CompletedProcess(c, 1, "", "no network")
    )
    with pytest.raises(WigwagError, match="no network"):
        chain.memory(frames)


def test_the_process_sees_what_was_written_for_it(frames, tmp_path, monkeypatch) -> None:
    engine = Actor()
    monkeypatch.setattr("wigwag.pose.engine.open_engine", lambda *_: engine)
    chain._write_pairs(tmp_path, frames)
    account = memory.run(str(tmp_path), 2, "litert", "full")
    assert engine.turn + 1 == 2 * len(frames)
    assert account["peak_mb"] > 10
    assert len(account["rounds_mb"]) == 2


def test_a_measure_without_figures_has_none() -> None:
    row = Measured("nothing").row()
    assert {row[k] for k in ("frames_per_s", "ms_median", "ms_p95", "ms_max", "rss_mb")} == {None}
