"""The paper's table: recognisers on UTD-MHAD, by protocol and class set, timed from raw clip to label."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from wigwag.evaluate.metrics import (
    accuracy,
    calibration_error,
    confusion,
    macro_f1,
    people_interval,
    t_interval,
    wilson_interval,
)
from wigwag.evaluate.protocols import (
    CLASS_SETS,
    Protocol,
    Split,
    cross_subject,
    leave_one_subject_out,
    of_classes,
    random_split,
)
from wigwag.evaluate.recognizers import BASELINES, RECOGNIZERS, SEEDLESS, Recognizer, chosen, maker_of
from wigwag.evaluate.threads import one_thread
from wigwag.skeleton import Clip

PAPER: dict[tuple[str, str], tuple[float, float]] = {
    ("heavy", "27"): (98.27, 2083.0),
    ("heavy", "6"): (98.72, 1513.0),
    ("heavy", "7"): (95.56, 1594.0),
    ("encoded", "27"): (83.24, 138.0),
    ("encoded", "6"): (97.44, 38.0),
    ("encoded", "7"): (86.67, 39.0),
}
"""Accuracy in per cent and milliseconds a case that the paper reports (random split, an Intel NUC)."""

Progress = Callable[[str, int, int], None]
"""Called with (which split, steps done, steps in all); a step is a fit or a case."""


@dataclass(slots=True)
class Run:
    """One split: what was shown, what was recognised, how long it took."""

    split: Split
    seed: int
    truth: list[str]
    predicted: list[str]
    people: list[str]
    names: list[str]
    fit_s: float
    case_s: list[float]
    confidence: list[float] = field(default_factory=list)
    """Probability of the most probable class, a case; empty if the recogniser gives none."""
    sure_of_right: list[bool] = field(default_factory=list)
    """Whether that class is the right one."""
    settings: str = ""
    """What the recogniser chose for itself."""


@dataclass(frozen=True, slots=True)
class Row:
    """One row of the table: a recogniser under a protocol on a class set."""

    recognizer: str
    """A name of ``RECOGNIZERS`` or ``BASELINES``."""
    protocol: Protocol
    """How clips are parted."""
    classes: str
    """``"27"``, ``"6"`` or ``"7"``."""
    nested: bool = False
    """Whether the recogniser chooses its settings inside its training people."""

    def __str__(self) -> str:
        return f"{self.recognizer}, {self.protocol}, {self.classes} classes"


@dataclass(slots=True)
class Result:
    """What came out of a row."""

    row: Row
    runs: list[Run] = field(default_factory=list)

    def confusion(self) -> Int[np.ndarray, "classes classes"]:
        """Count cases over all runs: a row a true class, a column a predicted one."""
        return np.asarray(sum(self._counts(run) for run in self.runs))

    def record(self, seed: int) -> dict[str, Any]:
        """Return the flat record of this row. Shares are 0 to 1; a split's figures are means over splits.

        ``accuracy_std`` and ``accuracy_ci95`` are over the splits for the random protocol (Student's t). For
        the other two, the deviation is that between test people and the interval a bootstrap of whole
        people. Where there is one random split alone, or no case at all is wrong, Wilson's score over the
        clips judged stands in: the other two would give an interval of no width. ``ece`` and ``ece_adaptive``
        are :func:`wigwag.evaluate.metrics.calibration_error` of ``predict_proba``, where there is one.
        """
        right, people = self._by_case()
        accuracies = [accuracy(run.truth, run.predicted) for run in self.runs]
        random = self.row.protocol == "random"
        mean = float(np.mean(accuracies) if random else right.mean())
        spread = accuracies if random else [right[people == person].mean() for person in np.unique(people)]
        if right.all() or (random and len(accuracies) == 1):
            method, interval = "Wilson", wilson_interval(round(right.sum()), len(right))
        elif random:
            method, interval = "t over splits", t_interval(accuracies)
        else:
            method, interval = "bootstrap of people", people_interval(right, list(people), seed)
        case_ms = 1e3 * np.concatenate([run.case_s for run in self.runs])
        return {
            "recognizer": self.row.recognizer,
            "protocol": self.row.protocol,
            "classes": int(self.row.classes),
            "n_train": round(np.mean([len(run.split.train) for run in self.runs])),
            "n_test": round(np.mean([len(run.split.test) for run in self.runs])),
            "accuracy_mean": mean,
            "accuracy_std": float(np.std(spread, ddof=1)) if len(spread) > 1 else 0.0,
            "accuracy_ci95": list(interval),
            "ci95_method": method,
            "macro_f1_mean": float(np.mean([macro_f1(counts) for counts in self._tables()])),
            "fit_s": float(np.mean([run.fit_s for run in self.runs])),
            "ms_per_case_median": float(np.median(case_ms)),
            "ms_per_case_p95": float(np.quantile(case_ms, 0.95)),
            "total_s": float(np.mean([sum(run.case_s) for run in self.runs])),
            "seeds": len({run.seed for run in self.runs}),
            "splits": len(self.runs),
            "cases": len(right),
            "ece": self._calibration_error(),
            "ece_adaptive": self._calibration_error(adaptive=True),
            "nested": self.row.nested,
            "settings": "; ".join(
                f"{n} x {what}" for what, n in Counter(r.settings for r in self.runs).items()
            ),
        }

    def _calibration_error(self, adaptive: bool = False) -> float | None:
        """Return the expected calibration error over the cases of all runs; None without probabilities."""
        if any(not run.confidence for run in self.runs):
            return None
        confidence = np.concatenate([run.confidence for run in self.runs])
        return calibration_error(
            confidence, np.concatenate([run.sure_of_right for run in self.runs]), adaptive
        )

    def _tables(self) -> list[Int[np.ndarray, "classes classes"]]:
        """Return the confusion of each run; of leave-one-subject-out, whose runs make one whole, the sum."""
        if self.row.protocol == "loso":
            return [self.confusion()]
        return [self._counts(run) for run in self.runs]

    def _counts(self, run: Run) -> Int[np.ndarray, "classes classes"]:
        return confusion(run.truth, run.predicted, CLASS_SETS[self.row.classes])

    def _by_case(self) -> tuple[Float[np.ndarray, " cases"], np.ndarray]:
        """Return for each clip judged the share of runs in which it is right, and whose it is."""
        right: dict[str, list[bool]] = {}
        people: dict[str, str] = {}
        for run in self.runs:
            for name, person, truth, predicted in zip(
                run.names, run.people, run.truth, run.predicted, strict=True
            ):
                right.setdefault(name, []).append(truth == predicted)
                people[name] = person
        return (
            np.array([np.mean(right[name]) for name in right]),
            np.array([people[name] for name in right]),
        )


def plan(clips: Sequence[Clip], row: Row, seeds: Sequence[int]) -> list[tuple[Split, int]]:
    """Return the splits to run, each with the recogniser's seed.

    Random splits: one a seed. Cross-subject: the one split, a run a seed (one if the recogniser does not
    depend on it). Leave one subject out: a split a person, with the first seed.
    """
    if row.protocol == "random":
        return [(random_split(clips, seed), seed) for seed in seeds]
    if row.protocol == "cross-subject":
        split = cross_subject(clips)
        return [(split, seed) for seed in (seeds[:1] if row.recognizer in SEEDLESS else seeds)]
    return [(split, seeds[0]) for split in leave_one_subject_out(clips)]


def run_row(
    clips: Sequence[Clip], row: Row, seeds: Sequence[int], progress: Progress | None = None
) -> Result:
    """Run one row of the table: fit and predict under every split of a protocol, in one thread.

    Args:
        clips: Of all classes; those of the class set are kept.
        row: Which recogniser, protocol and classes.
        seeds: Of splits and recogniser, one or more.
        progress: Called before each split and after each case.

    Raises:
        InputError: If there is no such recogniser, or the clips cannot be split that way.
    """
    maker_of(row.recognizer)  # found out before the work
    kept = of_classes(clips, row.classes)
    splits = plan(kept, row, seeds)
    result = Result(row)
    total, done = sum(1 + len(split.test) for split, _ in splits), 0
    with one_thread():
        for split, seed in splits:

            def step(steps: int, name: str = split.name, before: int = done) -> None:
                if progress is not None:
                    progress(name, before + steps, total)

            result.runs.append(run_split(kept, row.recognizer, split, seed, step, nested=row.nested))
            done += 1 + len(split.test)
    return result


def warm_up(clips: Sequence[Clip], recognizer: str) -> None:
    """Let a recogniser compile what it compiles on first use, so that no case is charged for it."""
    labels = sorted({str(clip.label) for clip in clips})[:3]
    some = {(clip.label, clip.subject): clip for clip in clips if clip.label in labels}
    few = list(some.values())[:12]
    with one_thread():
        estimator = maker_of(recognizer)(0)
        estimator.fit(few)
        estimator.predict(few[:2])


def run_split(
    clips: Sequence[Clip],
    recognizer: str,
    split: Split,
    seed: int,
    step: Callable[[int], object],
    *,
    nested: bool = False,
) -> Run:
    """Fit to a split's training clips and decide its test clips one by one, timed from raw clip to label.

    Args:
        clips: All of them.
        recognizer: A name of ``RECOGNIZERS`` or ``BASELINES``.
        split: Which clips are learned from, which are judged.
        seed: Of the recogniser.
        step: Called with the number of steps done; fitting is one, each case is one.
        nested: Let the recogniser choose its settings inside its training people.
    """
    estimator = maker_of(recognizer, nested)(seed)
    step(0)
    start = time.perf_counter()
    estimator.fit([clips[i] for i in split.train])
    fit_s = time.perf_counter() - start
    predicted: list[str] = []
    case_s: list[float] = []
    for done, i in enumerate(split.test, start=1):
        bare = Clip(clips[i].joints, clips[i].stamps_ns, name="case")  # no label, no person to peek at
        start = time.perf_counter()
        answer = list(estimator.predict([bare]))
        case_s.append(time.perf_counter() - start)
        predicted.append(str(answer[0]))
        step(done + 1)
    confidence, sure_of_right = _confidence(estimator, [clips[i] for i in split.test])
    return Run(
        split=split,
        seed=seed,
        truth=[str(clips[i].label) for i in split.test],
        predicted=predicted,
        people=[str(clips[i].subject) for i in split.test],
        names=[clips[i].name for i in split.test],
        fit_s=fit_s,
        case_s=case_s,
        confidence=confidence,
        sure_of_right=sure_of_right,
        settings=chosen(estimator),
    )


def _confidence(estimator: Recognizer, clips: Sequence[Clip]) -> tuple[list[float], list[bool]]:
    """Return how probable each case's most probable class is said to be, and whether it is right.

    No case is charged for it.
    """
    proba, classes = getattr(estimator, "predict_proba", None), getattr(estimator, "classes_", None)
    if proba is None or classes is None:
        return [], []
    given = np.asarray(proba([Clip(clip.joints, clip.stamps_ns, name="case") for clip in clips]))
    best = given.argmax(axis=1)
    right = [str(classes[b]) == clip.label for b, clip in zip(best, clips, strict=True)]
    return [float(p) for p in np.clip(given.max(axis=1), 0.0, 1.0)], right


__all__ = [
    "BASELINES", "PAPER", "RECOGNIZERS", "Recognizer", "Result", "Row", "Run", "one_thread", "plan",
    "run_row", "run_split", "warm_up",
]  # fmt: skip
