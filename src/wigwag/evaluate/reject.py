"""Saying no to a clip: gestures that are known, and movements of other people that are none of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from wigwag.datasets.utd_mhad import ACTIONS
from wigwag.errors import InputError
from wigwag.evaluate.cases import bare
from wigwag.evaluate.metrics import auroc, false_accept_at
from wigwag.evaluate.protocols import CLASS_SETS, cross_subject
from wigwag.evaluate.recognizers import maker_of
from wigwag.evaluate.threads import one_thread
from wigwag.skeleton import Clip

Background = Literal["other classes", "other classes, none of those judged", "no other classes"]
"""What training people teach as no gesture. ``"other classes"``: their clips of all classes that are not
known, so that the classes judged are seen, if shown by other people. ``"other classes, none of those
judged"``: two thirds of them, while the last third is judged, in three turns. ``"no other classes"``:
nothing; the unknown classes appear nowhere in training. Recordings of another set can be added to each."""

SETTINGS: tuple[tuple[int, Background], ...] = (
    (6, "other classes"),
    (6, "other classes, none of those judged"),
    (21, "no other classes"),
)
"""How many of the 27 classes are known, and what is taught beside them."""

TURNS = 3
"""Into how many parts unknown classes fall where none that is judged may be taught."""

Progress = Callable[[str, int, int], None]
"""Called with (which draw, fits done, fits in all)."""


@dataclass(slots=True)
class Turn:
    """One fitted recogniser: its scores on test people's clips, and its threshold."""

    known: Float[np.ndarray, " known"]
    """Scores of clips of known classes."""
    unknown: Float[np.ndarray, " unknown"]
    """Scores of clips of unknown classes."""
    threshold: float
    """Chosen by the recogniser on its training people."""
    right: Float[np.ndarray, " known"]
    """1 where the known clip's gesture is recognised rightly, whatever its score."""


@dataclass(slots=True)
class Rejection:
    """What came out of one draw of known classes."""

    recognizer: str
    known: tuple[str, ...]
    unknown: tuple[str, ...]
    background: str
    draw: int
    turns: list[Turn] = field(default_factory=list)

    def record(self) -> dict[str, Any]:
        """Return the flat record of this draw; shares are 0 to 1, means over turns.

        ``false_accept_at_95``: unknown clips that pass the threshold at which 95 % of the known test clips
        do, as the curve's usual figure; the ``..._at_threshold`` figures are those of the threshold that the
        recogniser chose on training people. ``right_at_threshold``: known clips that are accepted and
        recognised rightly.
        """

        def mean(figure: Callable[[Turn], Any]) -> float:
            return float(np.mean([figure(turn) for turn in self.turns]))

        return {
            "recognizer": self.recognizer,
            "known": len(self.known),
            "unknown": len(self.unknown),
            "draw": self.draw,
            "background": self.background,
            "auroc": mean(lambda t: auroc(t.known, t.unknown)),
            "false_accept_at_95": mean(lambda t: false_accept_at(0.95, t.known, t.unknown)),
            "true_accept_at_threshold": mean(lambda t: np.mean(t.known >= t.threshold)),
            "false_accept_at_threshold": mean(lambda t: np.mean(t.unknown >= t.threshold)),
            "right_at_threshold": mean(lambda t: np.mean(t.right * (t.known >= t.threshold))),
            "n_known": len(self.turns[0].known),
            "n_unknown": sum(len(turn.unknown) for turn in self.turns),
            "known_classes": list(self.known),
        }


def known_classes(count: int, draw: int, seed: int = 0) -> tuple[str, ...]:
    """Return which of UTD-MHAD's 27 classes are known.

    Draw 0 is made of the paper's six: they are the known ones of 6, and the unknown ones of 21. Other draws
    are random.

    Raises:
        InputError: If ``count`` is neither 6 nor 21.
    """
    if count not in (6, 21):
        raise InputError(f"6 or 21 of the 27 classes are known, but got {count}.")
    if draw == 0:
        six = set(CLASS_SETS["6"])
    else:
        rng = np.random.default_rng([0x2E, seed, draw])
        six = {str(label) for label in rng.choice(list(ACTIONS), 6, replace=False)}
    return tuple(label for label in ACTIONS if (label in six) == (count == 6))


def run_draw(
    clips: Sequence[Clip],
    recognizer: str,
    setting: tuple[int, Background],
    draw: int,
    more: Sequence[Clip] = (),
    *,
    seed: int = 0,
    progress: Progress | None = None,
) -> Rejection:
    """Fit on training people's known classes and a background; score test people's known and unknown ones.

    People are kept apart as in the cross-subject protocol. Everything runs in one thread.

    Args:
        clips: Of UTD-MHAD, all classes.
        recognizer: A name of ``RECOGNIZERS`` or ``BASELINES``.
        setting: How many classes are known, and what training people teach beside them.
        draw: Which classes are known; also the recogniser's seed.
        more: Other movements that are no gesture, for the background: recordings of another set.
        seed: Of the draws.
        progress: Called before each fit and at the end.

    Raises:
        InputError: If there is no such recogniser, or one side of the split lacks clips.
    """
    count, background = setting
    known = known_classes(count, draw, seed)
    unknown = tuple(label for label in ACTIONS if label not in known)
    split = cross_subject(clips)
    train, test = ([clips[i] for i in side] for side in (split.train, split.test))
    said = " + ".join([background, "another set"] if more else [background])
    result = Rejection(recognizer, known, unknown, said, draw)
    parts = _turns(unknown, background, [draw, seed])
    with one_thread():
        for done, (taught, judged) in enumerate(parts):
            if progress is not None:
                progress(f"draw {draw}", done, len(parts))
            lesson = [clip for clip in train if clip.label in known]
            lesson += [replace(clip, label=None) for clip in train if clip.label in taught]
            lesson += [replace(clip, label=None) for clip in more]
            result.turns.append(_turn(maker_of(recognizer)(draw), lesson, test, known, judged))
    if progress is not None:
        progress(f"draw {draw}", len(parts), len(parts))
    return result


def _turns(
    unknown: tuple[str, ...], background: Background, seed: Sequence[int]
) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return for each fit the classes taught as no gesture and those judged."""
    if background == "other classes":
        return [(unknown, unknown)]
    if background == "no other classes":
        return [((), unknown)]
    order = np.random.default_rng([0x3D, *seed]).permutation(len(unknown))
    parts = [{unknown[int(i)] for i in part} for part in np.array_split(order, TURNS)]
    return [
        (tuple(c for c in unknown if c not in part), tuple(c for c in unknown if c in part)) for part in parts
    ]


def _turn(
    estimator: Any, lesson: list[Clip], test: list[Clip], known: tuple[str, ...], judged: tuple[str, ...]
) -> Turn:
    mine = [clip for clip in test if clip.label in known]
    other = [clip for clip in test if clip.label in judged]
    if not mine or not other:
        raise InputError(
            f"Test people show {len(mine)} clips of known and {len(other)} of unknown classes; "
            "both are needed."
        )
    estimator.fit(lesson)
    decided = [str(label) for label in estimator.predict(bare(mine))]
    right = np.array([label == clip.label for label, clip in zip(decided, mine, strict=True)], dtype=float)
    if hasattr(estimator, "accept_score"):
        scores = [np.asarray(estimator.accept_score(bare(side)), dtype=float) for side in (mine, other)]
        return Turn(scores[0], scores[1], float(estimator.accept_threshold_), right)
    scores = [_by_decision(estimator, bare(side)) for side in (mine, other)]
    return Turn(scores[0], scores[1], 0.0, right)


def _by_decision(estimator: Any, clips: list[Clip]) -> Float[np.ndarray, " clips"]:
    """Score clips by ``recognise`` alone: its confidence, less 1 where it gives no label.

    At the threshold 0 that is what the recogniser itself decides.
    """
    gestures = [estimator.recognise(clip) for clip in clips]
    return np.array([g.confidence - (g.label is None) for g in gestures])


__all__ = ["SETTINGS", "Background", "Rejection", "Turn", "known_classes", "run_draw"]
