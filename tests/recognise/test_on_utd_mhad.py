"""The recognisers on real recordings, people never seen: half of the set's people teach, half are judged."""

from pathlib import Path

import numpy as np
import pytest

from wigwag.datasets.utd_mhad import load_skeletons
from wigwag.distances import dtw
from wigwag.recognise import EncodedRecognizer, HeavyRecognizer
from wigwag.recognise.baselines import (
    CelebiRecognizer,
    ClassicalRecognizer,
    RwigemaRecognizer,
    SchneiderRecognizer,
)
from wigwag.skeleton import Clip

DATA = Path(__file__).parents[2].parent / "shared" / "data" / "utd_mhad"
SIX = ("a1", "a6", "a7", "a9", "a24", "a27")
TEACHERS = ("s1", "s3", "s5", "s7")

pytestmark = pytest.mark.skipif(
    not (DATA / "Skeleton.zip").exists(), reason="needs shared/data/utd_mhad/Skeleton.zip beside the checkout"
)


@pytest.fixture(scope="module")
def people():
    clips = load_skeletons(DATA, labels=SIX).clips
    teachers = [c for c in clips if c.subject in TEACHERS]
    return teachers, [c for c in clips if c.subject not in TEACHERS]


def shaken(clip: Clip, seed: int) -> Clip:
    """Show the recording as a drifting camera with noisy depth would: 30 Hz, with rest around it."""
    rng = np.random.default_rng(seed)
    times = np.arange(-0.3, clip.duration_s + 0.3, 1 / 30)
    flat = clip.joints.reshape(len(clip), -1)
    joints = np.stack([np.interp(times, clip.times_s, column) for column in flat.T], axis=1)
    joints = joints.reshape(-1, 13, 3) + (times - times[0])[:, None, None] * np.array([0.3, 0.0, 0.2])
    return Clip.at_rate(joints + rng.normal(0, [0.006, 0.006, 0.02], joints.shape), 30, clip.label)


@pytest.mark.parametrize("make", [HeavyRecognizer, EncodedRecognizer])
def test_six_gestures_of_four_new_people(make, people):
    teachers, others = people
    recogniser = make().fit(teachers)
    assert len(others) == 95
    assert recogniser.score(others, [c.label for c in others]) >= 0.97
    # Trimming by bare joint speed took drift and noise for movement.
    moved = [shaken(c, i) for i, c in enumerate(others)]
    assert recogniser.score(moved, [c.label for c in others]) >= 0.97


def test_the_papers_plain_form_and_its_exact_search(people):
    teachers, others = people
    recogniser = HeavyRecognizer.as_in_paper(k=1).fit(teachers)
    index = recogniser.index_
    assert index.sequences_[0].shape[1] == 1821
    for clip in others[::24]:
        query = recogniser._sequence(clip)
        brute = np.array([dtw(query, s) for s in index.sequences_])
        found, distances = index.nearest(query, 3)
        np.testing.assert_allclose(distances, np.sort(brute)[:3], rtol=1e-6)
        assert (index.bounds(query) <= brute * 1.0001).all()
        assert recogniser.predict([clip])[0] == teachers[int(brute.argmin())].label
        assert found[0] == brute.argmin()


@pytest.mark.parametrize(
    "make", [ClassicalRecognizer, SchneiderRecognizer, CelebiRecognizer, RwigemaRecognizer]
)
def test_baselines_are_no_straw_men(make, people):
    """Six gestures are easy even across people; on all 27 they fall behind."""
    teachers, others = people
    assert make().fit(teachers).score(others, [c.label for c in others]) >= 0.95
