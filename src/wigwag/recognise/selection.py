"""Settings of a ridge recogniser, chosen by leaving out training people alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from jaxtyping import Float, Int
from scipy.special import logsumexp

from wigwag.recognise.acceptance import BACKGROUND
from wigwag.recognise.doubt import person_folds, targets_of
from wigwag.recognise.ridge import gram_matrix, solve

WIDTHS = (0.8, 1.5, 3.0)
RIDGES = (3e-5, 1e-4, 3e-4, 1e-3)
"""Candidates for :class:`~wigwag.recognise.kernel.KernelRecognizer`'s ``width`` and ``ridge``."""

_SHARPNESS = (2.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)


def choose(
    features_at: Callable[[float], Float[np.ndarray, "examples features"]],
    numbers: Int[np.ndarray, " clips"],
    people: Int[np.ndarray, " clips"],
    widths: tuple[float, ...] = WIDTHS,
    ridges: tuple[float, ...] = RIDGES,
) -> tuple[float, float, dict[tuple[float, float], float]]:
    """Choose width and ridge by how well people left out are forecast (mean log loss).

    Accuracy cannot tell the candidates apart: nearly all of them are right about nearly everybody.

    Args:
        features_at: Returns the similarities for a width; rows and columns as in
            :class:`~wigwag.recognise.doubt.Doubt`.
        numbers: Gestures of the clips.
        people: Whose they are.
        widths: Candidates.
        ridges: Candidates.

    Returns:
        Width, ridge, and the log loss of every pair. Where nobody can be left out whose gestures others
        show too, there is nothing to choose by: the middle candidates and an empty dictionary.
    """
    folds = person_folds(people)
    losses: dict[tuple[float, float], float] = {}
    for width in widths:
        scores: dict[float, list[np.ndarray]] = {ridge: [] for ridge in ridges}
        truth: list[np.ndarray] = []
        for shown, answers in _left_out(features_at(width), numbers, people, folds, ridges):
            truth.append(numbers[shown])
            for ridge in ridges:
                scores[ridge].append(answers[ridge])
        if not truth:
            return widths[len(widths) // 2], ridges[len(ridges) // 2], losses
        for ridge in ridges:
            losses[width, ridge] = _log_loss(np.concatenate(scores[ridge]), np.concatenate(truth))
    best = min(losses, key=lambda pair: losses[pair])
    return *best, losses


def _left_out(
    features: Float[np.ndarray, "examples features"],
    numbers: Int[np.ndarray, " clips"],
    people: Int[np.ndarray, " clips"],
    folds: list[Int[np.ndarray, " people"]],
    ridges: tuple[float, ...],
) -> Iterator[tuple[Int[np.ndarray, " shown"], dict[float, np.ndarray]]]:
    """For each fold of people, yield their gestures' clips and what is made of them at each ridge."""
    copies, views = len(features) // len(people), features.shape[1] // len(people)
    targets = targets_of(np.tile(numbers, copies), int(numbers.max()) + 1)
    whole = gram_matrix(features)
    for fold in folds:
        out = np.isin(people, fold)
        shown = np.flatnonzero(out & (numbers != BACKGROUND) & np.isin(numbers, numbers[~out]))
        if len(shown) == 0:
            continue
        rows = np.tile(~out, copies)
        # The references of people left out are a sum of their own: taken off, not computed anew.
        gram = whole - gram_matrix(features[:, np.repeat(out, views)])
        known = gram[np.ix_(rows, rows)]
        across = gram[np.ix_(shown, np.flatnonzero(rows))]
        yield shown, {ridge: (across @ solve(known, targets[rows], ridge))[:, :-1] for ridge in ridges}


def _log_loss(scores: Float[np.ndarray, "clips classes"], numbers: Int[np.ndarray, " clips"]) -> float:
    """Return the mean log loss at the sharpness that suits the scores best."""
    clips = np.arange(len(scores))
    return min(float(np.mean(logsumexp(s * scores, axis=1) - s * scores[clips, numbers])) for s in _SHARPNESS)
