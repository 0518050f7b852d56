from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.datasets.trees import UTD, needs_utd
from wigwag.datasets.utd_mhad import ACTIONS, KNOWN_MISSING, load_skeletons
from wigwag.errors import InputError
from wigwag.evaluate.protocols import (
    CLASS_SETS,
    TRAIN_SUBJECTS,
    Split,
    cross_subject,
    leave_one_subject_out,
    of_classes,
    random_split,
)
from wigwag.skeleton import Clip

JOINTS = np.zeros((2, 13, 3))


def clip(label: str | None, subject: str | None, trial: int = 1) -> Clip:
    return Clip.at_rate(JOINTS, 20, label, subject, f"{label}_{subject}_t{trial}")


def like_utd() -> list[Clip]:
    """As many clips, of the same classes and people, as the published set."""
    names = [(a, f"s{s}", t) for a in ACTIONS for s in range(1, 9) for t in range(1, 5)]
    return [clip(a, s, t) for a, s, t in names if f"{a}_{s}_t{t}" not in KNOWN_MISSING]


def is_partition(split: Split, clips: list[Clip]) -> bool:
    return sorted(split.train + split.test) == list(range(len(clips)))


@pytest.mark.parametrize(("classes", "train", "test"), [("27", 688, 173), ("6", 152, 39), ("7", 177, 45)])
def test_sizes_are_the_papers(classes: str, train: int, test: int) -> None:
    """The paper's 153 / 39 and 178 / 45 come out with a26, of which no recording is missing.

    Of a27 the published set lacks one, so its six classes have 191 clips and its seven 222.
    """
    kept = of_classes(like_utd(), classes)
    split = random_split(kept, seed=0)
    assert (len(split.train), len(split.test)) == (train, test)
    if classes != "27":
        lunge = [c for c in like_utd() if c.label in {*CLASS_SETS[classes], "a26"} - {"a27"}]
        split = random_split(lunge, seed=0)
        assert (len(split.train), len(split.test)) == (train + 1, test)


@pytest.mark.parametrize("classes", CLASS_SETS)
@pytest.mark.parametrize("seed", [0, 1, 9])
def test_random_split_is_stratified_and_reproducible(classes: str, seed: int) -> None:
    clips = of_classes(like_utd(), classes)
    split = random_split(clips, seed)
    assert is_partition(split, clips)
    assert split == random_split(clips, seed)
    assert split != random_split(clips, seed + 1)
    of_class = Counter(clips[i].label for i in split.test)
    assert set(of_class) == set(CLASS_SETS[classes])
    assert max(of_class.values()) - min(of_class.values()) <= 1


@settings(max_examples=40, deadline=None)
@given(
    who=st.lists(
        st.tuples(st.sampled_from("abc"), st.sampled_from([f"s{i}" for i in range(1, 9)])), max_size=60
    )
)
def test_no_person_stands_on_both_sides(who: list[tuple[str, str]]) -> None:
    clips = [clip(label, subject) for label, subject in who]
    people = {subject for _, subject in who}
    splits = []
    if people & set(TRAIN_SUBJECTS) and people - set(TRAIN_SUBJECTS):
        splits.append(cross_subject(clips))
    if len(people) > 1:
        folds = leave_one_subject_out(clips)
        assert sorted(i for fold in folds for i in fold.test) == list(range(len(clips))), "each judged once"
        splits += folds
    for split in splits:
        assert is_partition(split, clips)
        assert not {clips[i].subject for i in split.train} & {clips[i].subject for i in split.test}


def test_cross_subject_is_the_data_sets_own() -> None:
    clips = like_utd()
    split = cross_subject(clips)
    assert {clips[i].subject for i in split.train} == {"s1", "s3", "s5", "s7"}
    assert (len(split.train), len(split.test)) == (431, 430)


def test_loso_has_a_fold_a_person() -> None:
    assert [split.name for split in leave_one_subject_out(like_utd())] == [f"s{i}" for i in range(1, 9)]


def test_class_sets() -> None:
    assert len(CLASS_SETS["27"]) == 27
    assert set(CLASS_SETS["7"]) - set(CLASS_SETS["6"]) == {"a8"}
    assert {c.label for c in of_classes(like_utd(), "6")} == {"a1", "a6", "a7", "a9", "a24", "a27"}


def test_faults() -> None:
    with pytest.raises(InputError, match="classes must be one of 27, 6, 7, but got '5'"):
        of_classes(like_utd(), "5")
    with pytest.raises(InputError, match="No clip is labelled"):
        of_classes([clip("wave", "s1")], "6")
    with pytest.raises(InputError, match="cannot be split at random"):
        random_split([clip("a", "s1"), clip("b", "s1"), clip("b", "s1", 2)], 0)
    with pytest.raises(InputError, match=r"needs clips of s1, s3, s5, s7 and of others"):
        cross_subject([clip("a", "s1"), clip("a", "s3")])
    with pytest.raises(InputError, match="two people or more, but got s1"):
        leave_one_subject_out([clip("a", "s1")])
    with pytest.raises(InputError, match=r"Set Clip\.subject"):
        leave_one_subject_out([clip("a", "s1"), clip("a", None)])
    with pytest.raises(InputError, match=r"Set Clip\.label"):
        random_split([clip(None, "s1")], 0)


@needs_utd
def test_sizes_on_the_published_set() -> None:
    clips = load_skeletons(UTD).clips
    assert [(c.label, c.subject) for c in clips] == [(c.label, c.subject) for c in like_utd()]
