"""Who is learned from and who is judged: the paper's random split, and two that keep people apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from wigwag.datasets.utd_mhad import ACTIONS
from wigwag.errors import InputError
from wigwag.skeleton import Clip

Protocol = Literal["random", "cross-subject", "loso"]
"""``"random"``: the paper's, one person's clips on both sides; ``"cross-subject"``: the data set's own;
``"loso"``: every person judged by what the others taught."""

PROTOCOLS: tuple[Protocol, ...] = ("random", "cross-subject", "loso")

CLASS_SETS: dict[str, tuple[str, ...]] = {
    "27": tuple(ACTIONS),
    "6": ("a1", "a6", "a7", "a9", "a24", "a27"),
    "7": ("a1", "a6", "a7", "a8", "a9", "a24", "a27"),
}
"""The paper's class sets of UTD-MHAD."""

TEST_SHARE = 0.2
"""Of the random split: 688 / 173 of UTD-MHAD's 861 clips."""

TRAIN_SUBJECTS: tuple[str, ...] = ("s1", "s3", "s5", "s7")
"""UTD-MHAD's own cross-subject protocol (Chen et al. 2015): learn from the odd, judge by the even."""


@dataclass(frozen=True, slots=True)
class Split:
    """One way to part a list of clips in two."""

    train: tuple[int, ...]
    """Indices of the clips to learn from."""
    test: tuple[int, ...]
    """Indices of the clips to judge by; none of them in ``train``."""
    name: str
    """Such as ``"seed 3"`` or ``"s5"``."""


def of_classes(clips: Sequence[Clip], classes: str) -> list[Clip]:
    """Keep the clips of one class set, ``"27"``, ``"6"`` or ``"7"``.

    Raises:
        InputError: If there is no such set or no such clip.
    """
    if classes not in CLASS_SETS:
        raise InputError(f"classes must be one of {', '.join(CLASS_SETS)}, but got {classes!r}.")
    kept = [clip for clip in clips if clip.label in CLASS_SETS[classes]]
    if not kept:
        raise InputError(f"No clip is labelled with one of {', '.join(CLASS_SETS[classes])}.")
    return kept


def random_split(clips: Sequence[Clip], seed: int) -> Split:
    """Part clips at random, each class in proportion, a fifth (rounded up) to judge by: the paper's split.

    The same people stand on both sides, so this says how well known people are recognised.

    Raises:
        InputError: If a class has fewer than two clips, or there are fewer test clips than classes.
    """
    from sklearn.model_selection import train_test_split

    _need_labels(clips)
    labels = [str(clip.label) for clip in clips]
    try:
        train, test = train_test_split(
            np.arange(len(clips)), test_size=TEST_SHARE, stratify=labels, random_state=seed
        )
    except ValueError as error:
        raise InputError(
            f"{len(clips)} clips of {len(set(labels))} classes cannot be split at random: {error} "
            "Give more clips a class."
        ) from error
    return Split(_indices(train), _indices(test), f"seed {seed}")


def cross_subject(clips: Sequence[Clip], train_subjects: Sequence[str] = TRAIN_SUBJECTS) -> Split:
    """Learn from some people and judge by all others.

    Raises:
        InputError: If a clip has no subject, or one side has no clips.
    """
    _need_subjects(clips)
    train = [i for i, clip in enumerate(clips) if clip.subject in train_subjects]
    test = [i for i, clip in enumerate(clips) if clip.subject not in train_subjects]
    if not train or not test:
        raise InputError(
            f"The cross-subject split needs clips of {', '.join(train_subjects)} and of others, "
            f"but got people {', '.join(_people(clips))}."
        )
    return Split(_indices(train), _indices(test), "others than " + ", ".join(train_subjects))


def leave_one_subject_out(clips: Sequence[Clip]) -> list[Split]:
    """Judge by each person in turn what all others taught.

    Raises:
        InputError: If a clip has no subject, or there are fewer than two people.
    """
    _need_subjects(clips)
    people = _people(clips)
    if len(people) < 2:
        raise InputError(f"Leaving one person out needs two people or more, but got {', '.join(people)}.")
    return [
        Split(
            _indices([i for i, clip in enumerate(clips) if clip.subject != person]),
            _indices([i for i, clip in enumerate(clips) if clip.subject == person]),
            person,
        )
        for person in people
    ]


def _people(clips: Sequence[Clip]) -> list[str]:
    return sorted({str(clip.subject) for clip in clips})


def _indices(values: Sequence[int] | np.ndarray) -> tuple[int, ...]:
    return tuple(int(i) for i in values)


def _need_labels(clips: Sequence[Clip]) -> None:
    for clip in clips:
        if clip.label is None:
            raise InputError(f"{clip.name}: a clip without a label cannot be judged. Set Clip.label.")


def _need_subjects(clips: Sequence[Clip]) -> None:
    _need_labels(clips)
    for clip in clips:
        if clip.subject is None:
            raise InputError(f"{clip.name}: keeping people apart needs to know who it is. Set Clip.subject.")


__all__ = [
    "CLASS_SETS", "PROTOCOLS", "TEST_SHARE", "TRAIN_SUBJECTS", "Protocol", "Split", "cross_subject",
    "leave_one_subject_out", "of_classes", "random_split",
]  # fmt: skip
