"""One lesson of ``wigwag teach``: repetitions are kept as they are taken, and learned in the end."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from wigwag.errors import InputError
from wigwag.view.console.values import Line

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.evaluate.taught import Estimate
    from wigwag.skeleton import Clip
    from wigwag.teach.student import Student
    from wigwag.teach.teacher import Coaching, LessonConfig, Sight

NAME_MOST = 40
"""Characters of a gesture's name, at most."""
_STYLES = {"alarm": "red", "refused": "yellow"}


def name_of(text: str) -> str:
    """Return a gesture's name as somebody gave it, on the command line or on the console's page.

    Raises:
        InputError: If it is empty, too long, not all of it can be printed, or it gives no file name.

    Example:
        >>> name_of(" my salute ")
        'my salute'
    """
    from wigwag.datasets.folder import safe_name

    name = text.strip()
    if not name:
        raise InputError("A gesture needs a name.")
    if len(name) > NAME_MOST or not name.isprintable():
        raise InputError(f"A gesture's name has 1 to {NAME_MOST} printable characters, but got {name!r}.")
    safe_name(name)
    return name


@dataclass(frozen=True, slots=True)
class Keeping:
    """How lessons go, and where what is shown goes."""

    subject: str
    clips: Path
    """Folder of the repetitions."""
    model: Path
    """File of the model."""
    learns: bool
    """Whether the model learns; if not, the clips are kept alone."""
    lesson: LessonConfig


class Voice:
    """Says things on the terminal, and keeps the last of them for the page.

    Args:
        console: The terminal.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self.now_ns = 0
        """On the clock of the stamps."""
        self.lines: deque[Line] = deque(maxlen=20)

    def say(self, text: str, kind: str = "") -> None:
        """Say it, as it is: a name may hold what a terminal would take for markup."""
        style = _STYLES.get(kind, "")
        self._console.print(text, style=style, highlight=False, markup=False, soft_wrap=True)
        self.lines.append(Line(self.now_ns * 1e-9, text, "console" if kind == "refused" else kind))


class Phase(StrEnum):
    """How far a lesson is."""

    SHOWING = "showing"
    LEARNING = "learning"
    OVER = "over"


class OneLesson:
    """One gesture: its repetitions are kept as they are taken, and learned in the end.

    Args:
        gesture: Its name.
        student: What learns it.
        keeping: How it goes.
        voice: Where it is said what was taken, refused and learned.
    """

    def __init__(self, gesture: str, student: Student, keeping: Keeping, voice: Voice) -> None:
        from wigwag.evaluate.taught import judge_of
        from wigwag.teach.teacher import Teacher

        self.gesture, self._student, self._keeping, self._voice = gesture, student, keeping, voice
        self._teacher = Teacher(gesture, keeping.subject, judge_of(student, gesture), keeping.lesson)
        self.coaching: Coaching | None = None
        """The newest; ``None``: nothing has been seen yet."""
        self.estimate: Estimate | None = None
        """How many of its own showings are recognised; ``None``: not asked, or it cannot be told."""
        self.phase = Phase.SHOWING
        self.outcome = ""
        """What has come of it, in a few words, once it is over."""
        self.cancelled = False

    @property
    def clips(self) -> list[Clip]:
        """The repetitions so far."""
        return self._teacher.clips

    @property
    def shown(self) -> bool:
        """Whether all repetitions are taken."""
        return len(self.clips) == self._keeping.lesson.repetitions

    @property
    def fine(self) -> bool:
        """Whether it came to its end, and what was shown is recognised; or somebody ended it on purpose."""
        recognised = self.estimate is None or self.estimate.right == self.estimate.shown
        return self.cancelled or (self.shown and recognised)

    def update(self, sight: Sight) -> Coaching:
        """Take in what is seen; keep a repetition that has just been taken, or say why it was not."""
        coaching = self.coaching = self._teacher.update(sight)
        if coaching.refused and coaching.advice is not None:
            self._voice.say(f"not taken: {coaching.advice.text}", "refused")
        if coaching.clip is not None:
            path = keep(coaching.clip, self._keeping.clips, self.gesture, self._keeping.subject)
            taken = f"{coaching.taken} of {self._keeping.lesson.repetitions}"
            self._voice.say(f"taken: {taken}, {coaching.clip.duration_s:.1f} s, {path}")
        return coaching

    def learn(self) -> None:
        """Let the model learn what was shown, save it at once, and say how well it would be recognised."""
        self.phase = Phase.OVER
        if not self._keeping.learns or not self.clips:
            self.outcome = f"kept {len(self.clips)}"
            return
        self._teach_model()
        self.outcome = "learned"
        if self.estimate is not None:
            self.outcome += f"; leave-one-out {self.estimate.right} of {self.estimate.shown}"

    def _teach_model(self) -> None:
        from wigwag.evaluate.taught import leave_one_out

        subject, model = self._keeping.subject, self._keeping.model
        named = [replace(clip, name=f"{self.gesture} of {subject}, {clip.name}") for clip in self.clips]
        estimate = self.estimate = leave_one_out(self._student, self.gesture, named)
        self._student.enrol(self.gesture, named)
        self._student.save(model)
        examples = self._student.counts()[self.gesture]
        self._voice.say(f"{model}: knows {self.gesture} now, by {examples} examples.", "gesture")
        if estimate is not None:
            low, high = estimate.interval
            self._voice.say(
                f"Leave-one-out ({estimate.protocol}): {estimate.right} of {estimate.shown} recognised; "
                f"of so few that means {100 * low:.0f} to {100 * high:.0f} % (95 % interval)."
            )

    def cancel(self) -> None:
        """End it early, because somebody wants to; what was taken is kept and not learned."""
        self.cancelled, self.phase, self.outcome = True, Phase.OVER, "cancelled"
        kept = f"; {len(self.clips)} repetitions stay in {self._keeping.clips}" if self.clips else ""
        self._voice.say(f"{self.gesture}: cancelled, nothing of it learned{kept}.", "refused")

    def figures(self) -> dict[str, object]:
        """Return what came of it, for a record."""
        estimate, student = self.estimate, self._student
        return {
            "gesture": self.gesture,
            "model": str(self._keeping.model),
            "kind": type(student.model).__name__,
            "taken": len(self.clips),
            "seconds": [round(clip.duration_s, 2) for clip in self.clips],
            "leave_one_out_right": None if estimate is None else estimate.right,
            "leave_one_out_shown": None if estimate is None else estimate.shown,
            "leave_one_out_answers": [] if estimate is None else list(estimate.answers),
            "gestures": list(student.known),
        }


def keep(clip: Clip, folder: Path, gesture: str, subject: str) -> Path:
    """Save a repetition under the first free number."""
    from wigwag.datasets.folder import clip_path, save_clip

    number = 1
    while (folder / clip_path(replace(clip, name=f"{gesture}-{subject}-{number}"), ".json")).exists():
        number += 1
    return save_clip(replace(clip, name=f"{gesture}-{subject}-{number}"), folder)


__all__ = ["NAME_MOST", "Keeping", "OneLesson", "Phase", "Voice", "keep", "name_of"]
