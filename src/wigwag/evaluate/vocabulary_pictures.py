"""Pictures for ``wigwag vocabulary check``: two movements, moment by moment beside each other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from wigwag.evaluate.confused import draw_figure
from wigwag.evaluate.vocabulary import PairFinding, VocabularyReport
from wigwag.features.canonical import CanonicalForm
from wigwag.skeleton import Clip

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOMENTS = 9
_FRAMES = 45
_APART = 2.2


def draw_pair(first: Clip, second: Clip, titles: tuple[str, str], heading: str, path: Path) -> None:
    """Draw two movements as rows of stick figures, each above the moment of the other that it corresponds to.

    Both are drawn as a recogniser sees them: cut to where the person moves, facing the camera, arms of one
    length. Moments correspond by dynamic time warping of the landmarks.

    Args:
        first: Nine moments of it, evenly in time.
        second: The moments that they correspond to.
        titles: What stands above each row.
        heading: What stands above the picture.
        path: The PNG file; its folder is made if it is not there.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    form = CanonicalForm(frames=_FRAMES)
    one, two = form.apply(first), form.apply(second)
    at = np.linspace(0, _FRAMES - 1, _MOMENTS).round().astype(int)
    beside = corresponding(one.joints, two.joints)[at]
    figure = Figure(figsize=(10.5, 5.4), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, movement, frames, title in zip(
        figure.subplots(2, 1), (one, two), (at, beside), titles, strict=True
    ):
        times = frames / (_FRAMES - 1) * movement.duration_s
        _row(axes, movement.joints[frames], times)
        axes.set_title(title, loc="left", fontsize=10)
    figure.suptitle(f"{heading}\nthe person's left in blue, right in orange", fontsize=11)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90)


def draw_report(report: VocabularyReport, clips: Sequence[Clip], out: Path, most: int = 12) -> list[Path]:
    """Draw every pair that is too alike or close, and every gesture beside what it was found in.

    Args:
        report: Of a check.
        clips: What was checked.
        out: Folder of the pictures.
        most: At most so many pairs.

    Returns:
        The files written.
    """
    by_name = {clip.name: clip for clip in clips}
    written = []
    for pair in [p for p in report.pairs if p.verdict != "apart"][:most]:
        one, two = (by_name[name] for name in pair.examples)
        path = out / f"{_safe(pair.verdict)}-{_safe(pair.first)}-{_safe(pair.second)}.png"
        titles = (f"{pair.first}: {one.name}", f"{pair.second}: {two.name}")
        draw_pair(one, two, titles, f"{pair.first} and {pair.second}: {say(pair)}", path)
        written.append(path)
    for label, piece in report.lookalikes.items():
        one = next(clip for clip in clips if clip.label == label)
        path = out / f"everyday-{_safe(label)}.png"
        titles = (f"{label}: {one.name}", f"taken for it: {piece.name}")
        draw_pair(one, piece, titles, f"{label} looks like everyday movement", path)
        written.append(path)
    return written


def say(pair: PairFinding) -> str:
    """Say in words how alike two gestures are."""
    parts = [pair.verdict]
    if pair.confused is not None:
        parts.append(f"{pair.confused:.0%} of left-out showings confused")
    if pair.nearer is not None:
        parts.append(f"{pair.nearer:.0%} of examples nearer to the other")
    return ", ".join(parts)


def corresponding(
    one: Float[np.ndarray, "frames 13 3"], two: Float[np.ndarray, "others 13 3"]
) -> Int[np.ndarray, " frames"]:
    """Return for each frame of one sequence the frame of another that it is warped to; ends go to ends."""
    away = np.linalg.norm(one[:, None] - two[None], axis=3).mean(axis=2)
    total = np.full((len(one) + 1, len(two) + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(len(one)):
        for j in range(len(two)):
            total[i + 1, j + 1] = away[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    i, j = len(one) - 1, len(two) - 1
    partners: list[list[int]] = [[] for _ in range(len(one))]
    while True:
        partners[i].append(j)
        if i == j == 0:
            break
        steps = [(total[i, j], i - 1, j - 1), (total[i, j + 1], i - 1, j), (total[i + 1, j], i, j - 1)]
        _, i, j = min(step for step in steps if step[1] >= 0 and step[2] >= 0)
    return np.array([round(float(np.mean(p))) for p in partners])


def _row(
    axes: Axes, joints: Float[np.ndarray, "moments 13 3"], times_s: Float[np.ndarray, " moments"]
) -> None:
    for moment, (figure, at) in enumerate(zip(joints, times_s, strict=True)):
        draw_figure(axes, figure, _APART * moment)
        axes.text(
            _APART * moment,
            -joints[..., 1].max() - 0.35,
            f"{at:.1f} s",
            ha="center",
            fontsize=8,
            color="0.35",
        )
    axes.set_aspect("equal")
    axes.axis("off")


def _safe(name: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in name)


__all__ = ["corresponding", "draw_pair", "draw_report", "say"]
