"""Gestures said at their action points, by people who took no part in teaching."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wigwag.errors import InputError, ModelError
from wigwag.skeleton import MIRROR, Pose
from wigwag.stream import rows
from wigwag.stream import teach_moments as teaching
from wigwag.stream.listener import listening
from wigwag.stream.moments import BINS, MomentConfig, MomentModel, MomentStream
from wigwag.stream.network import Teacher
from wigwag.stream.teach import teach_stream
from wigwag.stream.teach_moments import teach_moments
from wigwag.stream.track import FEATURES, OTHER_SIDE, REACH, Change, Track
from wigwag.stream.truth import LabelledStream, Showing

from .people import GESTURES, Actor, session


def pointed(actor: Actor) -> LabelledStream:
    """Mark each gesture by its highest moment alone."""
    one = actor.stream()
    points = []
    for showing in one.showings:
        top = (showing.onset_ns + showing.end_ns) // 2
        points.append(Showing(showing.label, top, top))
    return replace(one, showings=tuple(points))


@pytest.fixture(scope="module")
def model() -> MomentModel:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(teaching, "_NETWORKS", 2)
        return teach_moments([pointed(session(number)) for number in range(8)])


def said(stream: MomentStream, poses: list[Pose]) -> list[tuple[str, int]]:
    stream.reset()
    heard = [stream.update(pose) for pose in poses]
    return [(str(gesture.label), gesture.decided_ns) for gesture in heard if gesture is not None]


def score(heard: list[tuple[str, int]], truth: LabelledStream) -> tuple[int, int]:
    """Return how many points were met within 0.4 s (the top of a swing is no sharp moment), and what else."""
    met = sum(
        any(label == p.label and abs(at - p.end_ns) <= 400_000_000 for label, at in heard)
        for p in truth.showings
    )
    return met, len(heard) - met


@pytest.mark.parametrize("rate_hz", [18.0, 30.0, 60.0])
def test_points_are_met_at_any_rate(model: MomentModel, rate_hz: float) -> None:
    actor = session(11, rate_hz, rounds=3)
    met, more = score(said(model.stream(), actor.poses()), pointed(actor))
    assert met >= 8 and more <= 1, f"{met} of 9, {more} more"


def test_missing_and_late_poses_are_borne(model: MomentModel) -> None:
    actor = session(12, rounds=3)
    rng = np.random.default_rng(0)
    poses = [pose for pose in actor.poses() if rng.random() > 0.3]
    for at in range(40, len(poses), 50):
        poses[at] = poses[at - 1]
    met, more = score(said(model.stream(), poses), pointed(actor))
    assert met >= 7 and more <= 1, f"{met} of 9, {more} more"
    assert model.stream().update(None) is None


def test_who_rests_says_nothing(model: MomentModel) -> None:
    actor = Actor(13)
    actor.rest(20.0)
    assert said(model.stream(), actor.poses()) == []


def test_what_is_heard_is_what_was_followed(model: MomentModel) -> None:
    actor = session(14, rounds=1)
    track = Track.of(actor.stream().stream)
    stream = model.stream()
    for pose in actor.poses():
        stream.update(pose)
    last = np.array([len(track.joints) - 1])
    np.testing.assert_allclose(stream._asked, model.probabilities(track.looks(last))[0], atol=1e-5)


def test_no_row_reaches_beyond_the_beginning_of_its_stream() -> None:
    one = Track.of(session(15, rounds=1).stream().stream)
    joined = Track.joined([one, one])
    rows = np.array([0, 5, REACH])
    np.testing.assert_array_equal(joined.looks(rows), joined.looks(rows + len(one.joints)))


def test_the_other_side_is_what_a_mirror_shows() -> None:
    one = Track.of(session(16, rounds=1).stream().stream)
    other = replace(one, joints=one.joints[:, list(MIRROR)] * OTHER_SIDE, hips=one.hips * OTHER_SIDE)
    rows = np.array([20, 60, 90])
    change = Change.random(3, np.random.default_rng(0), np.array([True, False, True]))
    seen, plain = one.looks(rows, change), replace(change, mirrored=None)
    np.testing.assert_allclose(seen[[0, 2]], other.looks(rows, plain)[[0, 2]], atol=1e-6)
    np.testing.assert_allclose(seen[1], one.looks(rows, plain)[1], atol=1e-6)


def test_only_what_has_no_side_is_taught_in_a_mirror(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[tuple[int, bool]] = set()
    mirrored: list[np.ndarray] = []

    class Kept(Teacher):
        def learn(self, numbers: np.ndarray, classes: np.ndarray, rate: float) -> None:
            seen.update(zip((classes // BINS).tolist(), mirrored[-1].tolist(), strict=True))

    def looks(track: Track, rows: np.ndarray, change: Change | None = None) -> np.ndarray:
        if change is not None and change.mirrored is not None:
            mirrored.append(change.mirrored)
        return np.zeros((len(rows), FEATURES), dtype=np.float32)

    monkeypatch.setattr(rows, "Teacher", Kept)
    monkeypatch.setattr(teaching, "_NETWORKS", 1)
    monkeypatch.setattr(Track, "looks", looks)
    teach_moments([pointed(session(0))], MomentConfig(either_side=("both",)))
    # 'both', 'left', 'right' and none
    assert seen == {(number, False) for number in range(4)} | {(0, True), (3, True)}


def test_what_is_no_command_is_not_said(model: MomentModel) -> None:
    actor = session(11, rounds=2)
    quiet = MomentStream(model, replace(model.config, commands=("left",)))
    assert {label for label, _ in said(quiet, actor.poses())} == {"left"}


def test_a_model_comes_back_as_it_was(model: MomentModel, tmp_path: Path) -> None:
    model.save(tmp_path / "moments.wigwag")
    again = MomentModel.load(tmp_path / "moments.wigwag")
    assert again.labels == tuple(sorted(GESTURES))
    poses = session(11, rounds=1).poses()
    heard = listening(again)
    assert isinstance(heard, MomentStream)
    assert said(heard, poses) == said(model.stream(), poses) != []
    with pytest.raises(ModelError, match="no such model file"):
        MomentModel.load(tmp_path / "nothing")


def test_teaching_needs_something_to_teach() -> None:
    one = pointed(session(0, rounds=1))
    with pytest.raises(InputError, match="at least one stream with a showing"):
        teach_moments([LabelledStream(one.stream)])
    with pytest.raises(InputError, match=r"holds \['wave'\], which nobody shows; shown are \['both', 'left'"):
        teach_moments([one], MomentConfig(commands=("wave",)))
    with pytest.raises(InputError, match=r"either_side holds \['wave'\], which nobody shows"):
        teach_moments([one], MomentConfig(either_side=("wave",)))
    with pytest.raises(InputError, match="teach those with teach_moments"):
        teach_stream((), (), [one])


@pytest.mark.parametrize(
    "settings",
    [{"threshold": 0.0}, {"within_s": 9.0}, {"ahead_s": 0.0}, {"ahead_s": 0.5}, {"again_s": -1.0}],
)
def test_settings_are_checked(settings: dict[str, float]) -> None:
    with pytest.raises(InputError, match="must be"):
        MomentConfig(**settings)
