"""How far apart gestures lie, by their own examples."""

import numpy as np
import pytest

from tests.evaluate.stream.people import swing
from wigwag.errors import InputError, NotFittedError
from wigwag.recognise import KernelRecognizer
from wigwag.recognise.alike import separation
from wigwag.skeleton import Clip

PEOPLE = ("s1", "s2", "s3")
CLIPS = [swing(p, label, trial=t) for label in ("a1", "a2", "a3") for p in PEOPLE for t in (1, 2)]


def twin(clip: Clip) -> Clip:
    """The same movement once more, by another name."""
    return swing(str(clip.subject), "a1", trial=int(clip.name[-1]) + 5)


@pytest.fixture(scope="module")
def clips() -> list[Clip]:
    renamed = [c for c in CLIPS if c.label != "a3"]
    for clip in (c for c in CLIPS if c.label == "a1"):
        same = twin(clip)
        renamed.append(Clip(same.joints, same.stamps_ns, "again", same.subject, f"again_{clip.name}"))
    return renamed


def fitted(clips: list[Clip]) -> KernelRecognizer:
    return KernelRecognizer(preset="fast", copies=0).fit(clips)


def test_the_same_movement_under_two_names_is_not_apart(clips: list[Clip]) -> None:
    found = separation(fitted(clips), [c.subject for c in clips])
    assert found.classes == ("a1", "a2", "again")
    same, other = found.ratios("a1", "again"), found.ratios("a1", "a2")
    assert len(same) == len(other) == 12
    assert np.median(same) == pytest.approx(1.0, abs=0.2)
    assert other.min() > 1.5
    np.testing.assert_allclose(np.sort(found.ratios("again", "a1")), np.sort(same))


def test_people_are_compared_with_others_alone(clips: list[Clip]) -> None:
    people = [c.subject for c in clips]
    alone, among = separation(fitted(clips)), separation(fitted(clips), people)
    assert (among.nearest >= alone.nearest - 1e-9).all()
    one = np.array([str(p) for p in people])
    assert all(one[among.neighbour[i, n]] != one[i] for i in range(len(one)) for n in range(3))
    first, second = among.closest("a1", "again")
    assert first.startswith("a1_") and second.startswith("again_")
    with pytest.raises(InputError, match="who shows each of 18 examples, but got 3 people"):
        separation(fitted(clips), PEOPLE)


def test_one_example_alone_has_nothing_to_compare_with() -> None:
    found = separation(fitted([swing("s1", "a1"), swing("s1", "a2")]))
    assert len(found.ratios("a1", "a2")) == 0
    assert found.closest("a1", "a2") == ("a1_s1_t1", "a2_s1_t1")
    with pytest.raises(NotFittedError):
        separation(KernelRecognizer())


def test_what_is_no_gesture_is_left_aside(clips: list[Clip]) -> None:
    nothing = [Clip(c.joints, c.stamps_ns, None, c.subject, c.name) for c in CLIPS if c.label == "a3"]
    people = [c.subject for c in (*clips, *nothing)]
    with_it = separation(fitted([*clips, *nothing]), people)
    assert with_it.nearest.shape == (18, 3)
