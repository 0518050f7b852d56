"""How many examples does it take? From other people, from oneself, and from oneself beside the others."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from wigwag.errors import InputError
from wigwag.evaluate.cases import Cases, bare
from wigwag.evaluate.protocols import Split, cross_subject, leave_one_subject_out
from wigwag.evaluate.recognizers import Recognizer, maker_of
from wigwag.evaluate.threads import one_thread
from wigwag.skeleton import Clip

Who = Literal["others", "own+others", "own"]
"""Whose examples are taught. ``"others"``: so many a class from training people, nothing of the test person;
``"own+others"``: everything from training people, and so many a class from the test person, enrolled;
``"own"``: so many a class from the test person, nothing else."""

SETTINGS: tuple[tuple[Who, int], ...] = (
    ("others", 1), ("others", 2), ("others", 4), ("others", 8),
    ("own+others", 1), ("own+others", 2),
    ("own", 1), ("own", 2),
)  # fmt: skip
"""What the benchmark runs: whose examples, and how many a class."""

Progress = Callable[[str, int, int], None]
"""Called with (which person, people tested, people to test in all, over all draws)."""


@dataclass(slots=True)
class FewShot:
    """What came out of one setting."""

    recognizer: str
    setting: Who
    examples: int
    draws: int
    cases: Cases = field(default_factory=Cases)
    n_taught: list[int] = field(default_factory=list)
    """Clips taught, a test person and draw."""
    enrol_s: list[float] = field(default_factory=list)
    """Seconds of each ``enrol``; empty if the recogniser has none and was fitted anew."""

    def record(self, seed: int) -> dict[str, Any]:
        """Return the flat record of this setting; shares are 0 to 1."""
        figures = self.cases.figures(seed)
        return {
            "recognizer": self.recognizer,
            "setting": self.setting,
            "examples": self.examples,
            "draws": self.draws,
            "n_train": round(float(np.mean(self.n_taught))),
            "enrol_ms_median": 1e3 * float(np.median(self.enrol_s)) if self.enrol_s else None,
        } | figures


def folds(clips: Sequence[Clip], protocol: Literal["cross-subject", "loso"]) -> list[Split]:
    """Return who is taught from and who is tested.

    ``"cross-subject"``: people 1, 3, 5, 7 are the others, each of the rest is a test person; ``"loso"``:
    everybody is a test person once, and all the rest are the others.
    """
    return [cross_subject(clips)] if protocol == "cross-subject" else leave_one_subject_out(clips)


def draw(clips: Sequence[Clip], examples: int, seed: int) -> list[int]:
    """Choose so many examples of each class at random, from as many people as possible.

    People are put in a random order for each class and asked for one clip after the other in turn, as one
    would collect examples. A class that has fewer gives what it has.

    Args:
        clips: Labelled, with subjects.
        examples: How many a class.
        seed: Of the choice.

    Returns:
        Indices into ``clips``, sorted.
    """
    rng = np.random.default_rng([0xF5, seed])
    chosen: list[int] = []
    for label in sorted({str(clip.label) for clip in clips}):
        of_class = [int(i) for i in rng.permutation(len(clips)) if clips[i].label == label]
        turns: dict[str | None, int] = {}
        round_of = []
        for i in of_class:
            round_of.append(turns.get(clips[i].subject, 0))
            turns[clips[i].subject] = round_of[-1] + 1
        order = np.argsort(round_of, kind="stable")
        chosen += [of_class[int(j)] for j in order[:examples]]
    return sorted(chosen)


def run_setting(
    clips: Sequence[Clip],
    recognizer: str,
    setting: tuple[Who, int],
    draws: Sequence[int],
    splits: Sequence[Split],
    *,
    progress: Progress | None = None,
) -> FewShot:
    """Teach so many examples and test, over several draws of which.

    Test clips are always of the test person and never among those taught; those of one draw may be taught
    in another. Everything runs in one thread.

    Args:
        clips: Labelled, with subjects and distinct names.
        recognizer: A name of ``RECOGNIZERS`` or ``BASELINES``.
        setting: Whose examples, and how many a class.
        draws: Seeds of the draws, one or more, and of the recognisers fitted for them.
        splits: Who is taught from and who is tested.
        progress: Called before each test person, and at the end.

    Raises:
        InputError: If there is no such recogniser, or nothing is left to test.
    """
    who, examples = setting
    result = FewShot(recognizer, who, examples, len(draws))
    total = len(draws) * sum(len(_people(clips, split)) for split in splits)
    done = 0
    with one_thread():
        for split in splits:
            teacher = _Teacher(result, [clips[i] for i in split.train])
            for seed in draws:
                for person in _people(clips, split):
                    if progress is not None:
                        progress(person, done, total)
                    done += 1
                    mine = [clips[i] for i in split.test if clips[i].subject == person]
                    taught = set() if who == "others" else set(draw(mine, examples, seed))
                    rest = [clip for i, clip in enumerate(mine) if i not in taught]
                    if rest:
                        fitted = teacher.teach(seed, [mine[i] for i in sorted(taught)])
                        result.cases.add(rest, fitted.predict(bare(rest)))
    if progress is not None:
        progress("", total, total)
    return result


def _people(clips: Sequence[Clip], split: Split) -> list[str]:
    return sorted({str(clips[i].subject) for i in split.test})


class _Teacher:
    """Fits recognisers for one group of other people; one that several test persons share is fitted once."""

    def __init__(self, result: FewShot, others: list[Clip]) -> None:
        self._result, self._others = result, others
        self._shared: tuple[int, Recognizer] | None = None

    def teach(self, seed: int, own: list[Clip]) -> Recognizer:
        """Return a recogniser taught as the setting says, with the test person's own examples."""
        result = self._result
        if result.setting == "others":
            chosen = draw(self._others, result.examples, seed)
            result.n_taught.append(len(chosen))
            return self._once(seed, [self._others[i] for i in chosen])
        result.n_taught.append(len(own) + (0 if result.setting == "own" else len(self._others)))
        if result.setting == "own":
            return self._fit(seed, own)
        if not hasattr(maker_of(result.recognizer)(seed), "enrol"):
            return self._fit(seed, self._others + own)
        return self._beside(self._once(0, self._others), own)

    def _once(self, key: int, clips: list[Clip]) -> Recognizer:
        if self._shared is None or self._shared[0] != key:
            self._shared = key, self._fit(key, clips)
        return self._shared[1]

    def _fit(self, seed: int, clips: list[Clip]) -> Recognizer:
        if not clips:
            raise InputError("There is no example to teach: no clip of the people to learn from.")
        recognizer = maker_of(self._result.recognizer)(seed)
        recognizer.fit(clips)
        return recognizer

    def _beside(self, fitted: Recognizer, own: list[Clip]) -> Recognizer:
        """Enrol a person's own examples; the fitted recogniser itself stays as it is."""
        enrolled: Any = copy.deepcopy(fitted)
        for label in sorted({str(clip.label) for clip in own}):
            of_label = [clip for clip in own if clip.label == label]
            start = time.perf_counter()
            enrolled.enrol(label, of_label)
            self._result.enrol_s.append(time.perf_counter() - start)
        taught: Recognizer = enrolled
        return taught


__all__ = ["SETTINGS", "FewShot", "Who", "draw", "folds", "run_setting"]
