import numpy as np
import pytest

from tests.evaluate.stream.people import RATE_HZ, swing
from wigwag.datasets.recording import Recording
from wigwag.errors import InputError
from wigwag.evaluate.stream.assembly import Body, Shown, assemble
from wigwag.evaluate.stream.corrupt import CORRUPTIONS, corrupted
from wigwag.skeleton import MIRROR

CLIPS = [swing(trial=t) for t in range(1, 7)]


@pytest.fixture(scope="module")
def recording() -> Recording:
    return assemble(Body.of(CLIPS, RATE_HZ), [[Shown(c, "utd:a1", "a1")] for c in CLIPS], [], seed=0)


@pytest.mark.parametrize("kind", CORRUPTIONS)
def test_every_pose_is_a_pose_and_a_seed_says_which(recording: Recording, kind: str) -> None:
    poses = corrupted(recording, kind, 5)  # type: ignore[arg-type]
    again = corrupted(recording, kind, 5)  # type: ignore[arg-type]
    assert [p.stamp_ns for p in poses] == [p.stamp_ns for p in again]
    assert all(np.isfinite(p.joints).all() for p in poses)
    np.testing.assert_array_equal(recording.stream.joints[0], np.asarray(recording.stream.joints)[0])


def test_how_many_are_missing(recording: Recording) -> None:
    count = len(recording.stream)
    assert len(corrupted(recording, "missing")) / count == pytest.approx(0.7, abs=0.04)
    assert len(corrupted(recording, "nan")) / count == pytest.approx(0.95, abs=0.02)


def test_time_may_run_back(recording: Recording) -> None:
    stamps = np.array([p.stamp_ns for p in corrupted(recording, "jitter")])
    away = stamps - recording.stream.stamps_ns
    assert 15e6 < np.abs(away).max() <= 20e6
    assert (np.diff(stamps) < 0).any()


def test_gaps_lie_in_the_middle_of_gestures(recording: Recording) -> None:
    stamps = np.array([p.stamp_ns for p in corrupted(recording, "gap")])
    holes = np.flatnonzero(np.diff(stamps) > 1e9)
    assert len(holes) == 2
    for hole in holes:
        middle = (stamps[hole] + stamps[hole + 1]) / 2
        assert stamps[hole + 1] - stamps[hole] == pytest.approx(2e9, abs=0.1e9)
        assert any(abs(middle - (m.onset_ns + m.end_ns) / 2) < 0.1e9 for m in recording.marks)


def test_sides_change_places_now_and_then(recording: Recording) -> None:
    clean = np.asarray(recording.stream.joints, dtype=float)
    poses = np.stack([p.joints for p in corrupted(recording, "swapped")])
    changed = (poses != clean).any(axis=(1, 2))
    assert 0.02 < changed.mean() < 0.3
    np.testing.assert_array_equal(poses[changed], clean[changed][:, list(MIRROR)])


def test_a_stranger_is_seen_for_ten_frames(recording: Recording) -> None:
    clean = np.asarray(recording.stream.joints, dtype=float)
    poses = np.stack([p.joints for p in corrupted(recording, "stranger", 1)])
    changed = (poses != clean).any(axis=(1, 2))
    edges = np.flatnonzero(np.diff(changed.astype(int)))
    assert changed.any()
    assert (edges[1::2] - edges[::2]).min() == 10
    away = np.abs(poses[changed].mean(axis=1) - clean[changed].mean(axis=1)).max(axis=1)
    assert away.min() > 0.5, "they stand elsewhere"


def test_an_unknown_fault() -> None:
    with pytest.raises(InputError, match=r"no corruption 'fog'. Available: missing, jitter, gap"):
        corrupted(None, "fog")  # type: ignore[arg-type]
