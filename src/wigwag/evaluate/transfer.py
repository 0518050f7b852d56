"""The same recognisers, settings untouched, on another data set: MSR-Action3D, leaving each person out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wigwag.evaluate.cases import Cases
from wigwag.evaluate.metrics import calibration_error, confusion, macro_f1
from wigwag.evaluate.protocols import leave_one_subject_out
from wigwag.evaluate.recognizers import SEEDLESS
from wigwag.evaluate.threads import one_thread
from wigwag.evaluate.utd_mhad import Run, run_split
from wigwag.skeleton import Clip

Progress = Callable[[str, int, int], None]
"""Called with (which person, steps done, steps in all); a step is a fit or a case."""


@dataclass(slots=True)
class Transfer:
    """What came out for one recogniser."""

    recognizer: str
    runs: list[Run] = field(default_factory=list)

    def record(self, seed: int) -> dict[str, Any]:
        """Return the flat record of this recogniser; shares are 0 to 1, times in seconds or ms as named."""
        cases = Cases()
        for run in self.runs:
            for name, person, truth, decided in zip(
                run.names, run.people, run.truth, run.predicted, strict=True
            ):
                cases.right.setdefault(name, []).append(truth == decided)
                cases.people[name] = person
        shown = [label for run in self.runs for label in run.truth]
        answered = [label for run in self.runs for label in run.predicted]
        case_ms = 1e3 * np.concatenate([run.case_s for run in self.runs])
        return {
            "recognizer": self.recognizer,
            "data": "MSR-Action3D",
            "protocol": "loso",
            "classes": len(set(shown)),
            "n_train": round(float(np.mean([len(run.split.train) for run in self.runs]))),
            **cases.figures(seed),
            "macro_f1_mean": macro_f1(confusion(shown, answered, sorted({*shown, *answered}))),
            "fit_s": float(np.mean([run.fit_s for run in self.runs])),
            "ms_per_case_median": float(np.median(case_ms)),
            "ms_per_case_p95": float(np.quantile(case_ms, 0.95)),
            "ece": self._calibration_error(),
            "seeds": len({run.seed for run in self.runs}),
        }

    def _calibration_error(self) -> float | None:
        if any(not run.confidence for run in self.runs):
            return None
        return calibration_error(
            np.concatenate([run.confidence for run in self.runs]),
            np.concatenate([run.sure_of_right for run in self.runs]),
        )


def run_transfer(
    clips: Sequence[Clip], recognizer: str, seeds: Sequence[int], progress: Progress | None = None
) -> Transfer:
    """Fit and test on these clips, leaving one person out at a time, in one thread.

    Args:
        clips: Labelled, with subjects and distinct names.
        recognizer: A name of ``RECOGNIZERS`` or ``BASELINES``.
        seeds: Of the recogniser; one that does not depend on it runs with the first alone.
        progress: Called before each person and after each case.

    Raises:
        InputError: If there is no such recogniser, or there are fewer than two people.
    """
    splits = leave_one_subject_out(clips)
    used = seeds[:1] if recognizer in SEEDLESS else seeds
    total = len(used) * (len(splits) + sum(len(split.test) for split in splits))
    result, done = Transfer(recognizer), 0
    with one_thread():
        for seed in used:
            for split in splits:

                def step(steps: int, name: str = split.name, before: int = done) -> None:
                    if progress is not None:
                        progress(name, before + steps, total)

                result.runs.append(run_split(clips, recognizer, split, seed, step))
                done += 1 + len(split.test)
    return result


__all__ = ["Transfer", "run_transfer"]
