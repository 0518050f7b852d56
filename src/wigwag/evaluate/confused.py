"""What is taken for what, as pictures: a movement beside what it is and what it was taken for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from wigwag.evaluate.utd_mhad import Result
from wigwag.features.canonical import CanonicalForm
from wigwag.skeleton import BONES, Clip, Landmark

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOMENTS = 9
_LEFT: set[int] = {Landmark.LEFT_ELBOW, Landmark.LEFT_WRIST, Landmark.LEFT_KNEE, Landmark.LEFT_HEEL}
_RIGHT: set[int] = {Landmark.RIGHT_ELBOW, Landmark.RIGHT_WRIST, Landmark.RIGHT_KNEE, Landmark.RIGHT_HEEL}


def confused_pairs(result: Result, most: int = 4) -> list[tuple[str, str, str, float]]:
    """Return the pairs most often confused: truth, answer, a clip of that kind, and its share of all errors.

    The clip is the one most often wrong that way; runs count alike.
    """
    errors = Counter[tuple[str, str]]()
    clips: dict[tuple[str, str], Counter[str]] = {}
    for run in result.runs:
        for name, truth, answer in zip(run.names, run.truth, run.predicted, strict=True):
            if truth != answer:
                errors[truth, answer] += 1
                clips.setdefault((truth, answer), Counter())[name] += 1
    total = sum(errors.values())
    return [
        (*pair, clips[pair].most_common(1)[0][0], count / total) for pair, count in errors.most_common(most)
    ]


def draw_confused(
    result: Result, clips: Sequence[Clip], names: Mapping[str, str], path: Path, most: int = 4
) -> bool:
    """Draw confused movements: each above an example of what it is and one of what it was taken for.

    Every movement is drawn as the recogniser sees it: cut to where the person moves, facing the camera.
    Examples are those of training people that are nearest to it frame by frame.

    Args:
        result: Of a benchmark row.
        clips: All clips of the data set.
        names: What labels mean.
        path: Picture to write.
        most: At most so many pairs.

    Returns:
        Whether there was anything to draw.
    """
    pairs = confused_pairs(result, most)
    if not pairs:
        return False
    from matplotlib.figure import Figure

    form = CanonicalForm(frames=_MOMENTS)
    by_name = {clip.name: clip for clip in clips}
    figure = Figure(figsize=(8.5, 4.6 * len(pairs)), layout="constrained")
    rows = figure.subplots(3 * len(pairs), 1, squeeze=False)[:, 0]
    for number, (truth, answer, name, share) in enumerate(pairs):
        shown = by_name[name]
        others = [clip for clip in clips if clip.subject != shown.subject]
        title = f"{name}: {names[truth]}, taken for {names[answer]} ({share:.0%} of errors)"
        for axes, what, clip in (
            (rows[3 * number], title, shown),
            (rows[3 * number + 1], f"{names[truth]} by somebody else", _nearest(shown, others, truth, form)),
            (
                rows[3 * number + 2],
                f"{names[answer]} by somebody else",
                _nearest(shown, others, answer, form),
            ),
        ):
            _strip(axes, clip, form)
            axes.set_title(what, fontsize=10, loc="left", weight="bold" if clip is shown else "normal")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=70)
    return True


def _nearest(shown: Clip, others: Sequence[Clip], label: str, form: CanonicalForm) -> Clip:
    joints = form.apply(shown).joints
    alike = [clip for clip in others if clip.label == label]
    far = [float(np.linalg.norm(form.apply(clip).joints - joints, axis=2).mean()) for clip in alike]
    return alike[int(np.argmin(far))]


def _strip(axes: Axes, clip: Clip, form: CanonicalForm) -> None:
    """Draw a movement's moments side by side."""
    for moment, joints in enumerate(form.apply(clip).joints):
        draw_figure(axes, joints, 2.2 * moment)
    axes.set_aspect("equal")
    axes.axis("off")


def draw_figure(axes: Axes, joints: Float[np.ndarray, "13 3"], right: float) -> None:
    """Draw one moment as a stick figure; the person's left is blue, their right orange.

    Args:
        axes: Where.
        joints: Any unit, y down, facing the camera.
        right: How far to the right of the axes' origin the person stands, in the same unit.
    """
    for start, stop in BONES:
        ends = {start, stop}
        color = "tab:blue" if ends & _LEFT else "tab:orange" if ends & _RIGHT else "0.4"
        x, y = joints[[start, stop], 0] + right, -joints[[start, stop], 1]
        axes.plot(x, y, color=color, linewidth=2, solid_capstyle="round")
    head = joints[Landmark.NOSE]
    axes.plot(head[0] + right, -head[1], "o", color="0.4", markersize=7)


__all__ = ["confused_pairs", "draw_confused", "draw_figure"]
