"""Figures of merit and how sure they are; confusion matrices as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import InputError

RESAMPLES = 10_000
"""Of the bootstrap over people."""

BINS = 15
"""Of the calibration error."""


def accuracy(truth: Sequence[str], predicted: Sequence[str]) -> float:
    """Share of cases that are right."""
    _same_length(truth, predicted)
    return float(np.mean(np.asarray(truth) == np.asarray(predicted)))


def confusion(
    truth: Sequence[str], predicted: Sequence[str], labels: Sequence[str]
) -> Int[np.ndarray, "classes classes"]:
    """Count cases: a row a true class, a column a predicted one.

    Raises:
        InputError: If the lengths differ or a label is not among ``labels``.
    """
    _same_length(truth, predicted)
    index = {label: i for i, label in enumerate(labels)}
    if unknown := sorted({*truth, *predicted} - set(index)):
        raise InputError(f"Labels {unknown} are not among the classes {list(labels)}.")
    counts = np.zeros((len(labels), len(labels)), dtype=np.int64)
    np.add.at(counts, ([index[label] for label in truth], [index[label] for label in predicted]), 1)
    return counts


def macro_f1(counts: Int[np.ndarray, "classes classes"]) -> float:
    """Mean over the classes of F1 = 2 TP / (2 TP + FP + FN).

    A class that is neither shown nor predicted does not count; one that is never right counts as 0.
    """
    right = np.diag(counts).astype(float)
    total = counts.sum(axis=0) + counts.sum(axis=1)
    present = total > 0
    if not present.any():
        raise InputError("F1 needs at least one case, but the confusion matrix is empty.")
    return float(np.mean(2 * right[present] / total[present]))


def t_interval(values: Sequence[float]) -> tuple[float, float]:
    """95 % confidence interval of the mean of a figure over random splits, by Student's t.

    Splits share clips, so they vary less than fresh data would: the interval says how much the figure
    depends on the split, not how it carries over to other people.

    Raises:
        InputError: With fewer than two values, which say nothing about their spread.
    """
    from scipy.stats import t

    if len(values) < 2:
        raise InputError(f"An interval over splits needs 2 or more, but got {len(values)}.")
    spread = float(np.std(values, ddof=1)) / np.sqrt(len(values))
    half = float(t.ppf(0.975, len(values) - 1)) * spread
    mean = float(np.mean(values))
    return max(mean - half, 0.0), min(mean + half, 1.0)


def wilson_interval(right: int, cases: int) -> tuple[float, float]:
    """95 % confidence interval of a share, by Wilson's score.

    Example:
        >>> [round(x, 3) for x in wilson_interval(9, 10)]
        [0.596, 0.982]

    Raises:
        InputError: If there are no cases or more right ones than cases.
    """
    if not 0 <= right <= cases or cases == 0:
        raise InputError(f"Expected 0 <= right <= cases and cases > 0, but got {right} of {cases}.")
    z = 1.959963984540054
    share, n = right / cases, float(cases)
    center = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * np.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    # At the ends the bound is the end itself; floating point would miss it by a hair.
    return (
        0.0 if right == 0 else float(center - half),
        1.0 if right == cases else float(center + half),
    )


def people_interval(
    right: Float[np.ndarray, " cases"], people: Sequence[str], seed: int
) -> tuple[float, float]:
    """95 % confidence interval of accuracy on new people: a bootstrap of whole people, then of their cases.

    One person's cases resemble each other, so cases are not drawn independently: people are drawn with
    replacement, and then, of each person drawn, cases with replacement. With four test people the interval
    is rough but not flattering.

    Args:
        right: 1 where a case is right, 0 where it is wrong; a mean over seeds may lie between.
        people: Whose case it is.
        seed: Of the resampling.

    Raises:
        InputError: If the lengths differ or there are no cases.
    """
    values = np.asarray(right, dtype=np.float64)
    _same_length(right, people)
    names = np.asarray(people)
    groups = [values[names == name] for name in np.unique(names)]
    rng = np.random.default_rng(seed)
    sums, counts = np.zeros(RESAMPLES), np.zeros(RESAMPLES)
    drawn = rng.integers(len(groups), size=(RESAMPLES, len(groups)))
    for number, group in enumerate(groups):
        times = (drawn == number).sum(axis=1)
        for repeat in range(1, int(times.max()) + 1):
            rows = np.flatnonzero(times >= repeat)
            sums[rows] += group[rng.integers(len(group), size=(len(rows), len(group)))].sum(axis=1)
            counts[rows] += len(group)
    low, high = np.quantile(sums / counts, [0.025, 0.975])
    return float(low), float(high)


def calibration_error(
    confidence: Sequence[float] | np.ndarray, right: Sequence[bool] | np.ndarray, adaptive: bool = False
) -> float:
    """Expected calibration error: how far confidences lie from the share that is right, on average.

    Cases are put into 15 bins by their confidence; the gaps between the share that is right and the mean
    confidence are averaged over the bins, each weighed by its cases (Guo et al., "On Calibration of Modern
    Neural Networks", ICML 2017).

    Args:
        confidence: Probability given to the decision, 0 to 1.
        right: Whether the decision is right.
        adaptive: Bins of equally many cases instead of equally wide ones. Where nearly all confidences lie
            close to 1, equally wide bins see little.

    Raises:
        InputError: If the lengths differ, there are no cases, or a confidence is not within 0 to 1.

    Example:
        >>> calibration_error([0.9] * 10, [True] * 8 + [False] * 2)
        0.1
    """
    _same_length(confidence, right)
    sure, hit = np.asarray(confidence, dtype=np.float64), np.asarray(right, dtype=np.float64)
    if not ((sure >= 0) & (sure <= 1)).all():
        raise InputError(f"Confidences must be within 0 to 1, but range from {sure.min()} to {sure.max()}.")
    if adaptive:
        order = np.argsort(sure, kind="stable")
        bins = [part for part in np.array_split(order, BINS) if len(part)]
    else:
        number = np.minimum((sure * BINS).astype(int), BINS - 1)
        bins = [np.flatnonzero(number == b) for b in np.unique(number)]
    gaps = [len(part) * abs(float(hit[part].mean() - sure[part].mean())) for part in bins]
    return round(float(np.sum(gaps)) / len(sure), 12)


def auroc(known: Sequence[float] | np.ndarray, unknown: Sequence[float] | np.ndarray) -> float:
    """Area under the receiver operating characteristic: how often a known case scores above an unknown one.

    Ties count half.

    Raises:
        InputError: If either side has no cases.

    Example:
        >>> auroc([2.0, 3.0], [1.0, 2.0])
        0.875
    """
    from scipy.stats import rankdata

    if len(known) == 0 or len(unknown) == 0:
        raise InputError(f"AUROC needs cases of both kinds, but got {len(known)} and {len(unknown)}.")
    ranks = rankdata(np.concatenate([known, unknown]))
    above = ranks[: len(known)].sum() - len(known) * (len(known) + 1) / 2
    return float(above / (len(known) * len(unknown)))


def false_accept_at(
    share: float, known: Sequence[float] | np.ndarray, unknown: Sequence[float] | np.ndarray
) -> float:
    """Share of unknown cases that pass the highest threshold which lets ``share`` of the known ones pass.

    The threshold is read off the cases that are judged, as is usual for this figure: it says what the score
    could do, not what a threshold chosen beforehand does.

    Args:
        share: Of the known cases, 0 to 1.
        known: Scores, higher for known.
        unknown: Scores.

    Raises:
        InputError: If either side has no cases or the share is not within 0 to 1.
    """
    if len(known) == 0 or len(unknown) == 0 or not 0 < share <= 1:
        raise InputError(
            f"Expected cases of both kinds and a share above 0 to 1, but got {len(known)}, {len(unknown)} "
            f"and {share}."
        )
    passing = int(np.ceil(share * len(known) - 1e-9))
    threshold = np.sort(np.asarray(known))[::-1][passing - 1]
    return float(np.mean(np.asarray(unknown) >= threshold))


def draw_confusion(
    counts: Int[np.ndarray, "classes classes"], names: Sequence[str], title: str, path: str | Path
) -> None:
    """Draw a confusion matrix: a row a true class, its cells in per cent, into a PNG file.

    Args:
        counts: A row a true class, a column a predicted one.
        names: What a person calls the classes.
        title: Above the picture.
        path: Where the picture goes; its folder is made if it is not there.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shares = 100.0 * counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    n = len(names)
    size = 3.2 + 0.42 * n
    figure = Figure(figsize=(size + 0.6, size), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    image = axes.imshow(shares, cmap="Blues", vmin=0, vmax=100)
    for row, column in np.argwhere(counts > 0):
        share = shares[row, column]
        axes.text(
            column, row, f"{share:.0f}", ha="center", va="center", fontsize=8,
            color="white" if share > 55 else "black",
        )  # fmt: skip
    axes.set_xticks(range(n), names, rotation=60, ha="right", rotation_mode="anchor", fontsize=8)
    axes.set_yticks(range(n), names, fontsize=8)
    axes.set_xlabel("recognised as")
    axes.set_ylabel("shown")
    axes.set_title(title, fontsize=10)
    axes.set_xticks(np.arange(n + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(n + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="0.9", linewidth=0.5)
    axes.tick_params(which="minor", length=0)
    figure.colorbar(image, ax=axes, shrink=0.6, label="% of the clips shown")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)


def _same_length(a: Sequence[object] | np.ndarray, b: Sequence[object] | np.ndarray) -> None:
    if len(a) != len(b) or len(a) == 0:
        raise InputError(
            f"Expected as many of one as of the other and at least 1, but got {len(a)}, {len(b)}."
        )


__all__ = [
    "accuracy", "auroc", "calibration_error", "confusion", "draw_confusion", "false_accept_at", "macro_f1",
    "people_interval", "t_interval", "wilson_interval",
]  # fmt: skip
