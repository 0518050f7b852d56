"""What the terminal shows during a lesson."""

from __future__ import annotations

from rich.columns import Columns
from rich.console import Group
from rich.text import Text

from wigwag.skeleton import Pose
from wigwag.teach.teacher import Coaching, Stage
from wigwag.view.stick import stick_figure

_SAYS = {
    Stage.LOOK: "step into the picture, from head to feet",
    Stage.STILL: "stand still, arms hanging",
    Stage.SHOW: "now!",
    Stage.MOVING: "...",
    Stage.DONE: "done",
}


def headline(coaching: Coaching) -> str:
    """Return the one thing to do now.

    Example:
        >>> headline(Coaching(Stage.COUNTDOWN, 0, count=3))
        '3 ...'
    """
    return f"{coaching.count} ..." if coaching.stage is Stage.COUNTDOWN else _SAYS[coaching.stage]


def lesson_panel(label: str, coaching: Coaching, repetitions: int, pose: Pose | None) -> Columns:
    """Return what is shown of this moment: the figure, what to do, what was wrong.

    Args:
        label: The gesture.
        coaching: The newest.
        repetitions: How many are wanted.
        pose: What is seen.
    """
    lines = [
        Text(f"{label}: {coaching.taken} of {repetitions}", style="bold"),
        Text(""),
        Text(headline(coaching), style="bold green" if coaching.stage is Stage.SHOW else "bold"),
    ]
    if coaching.advice is not None:
        lines.append(Text(coaching.advice.text, style="yellow"))
    return Columns([Text(stick_figure(pose)), Group(*lines)], padding=(0, 3))


__all__ = ["headline", "lesson_panel"]
