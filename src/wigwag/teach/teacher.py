"""A lesson step by step: wait for somebody, count down, watch a repetition, judge it, ask for the next."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Pose
from wigwag.stream.segment import SegmentConfig, Segmenter, arms_down
from wigwag.teach.advice import (
    LONGEST_HOLE_S,
    MAX_S,
    Advice,
    Fault,
    advise_movement,
    advise_view,
)

_BEFORE_S = 0.22
"""A movement begins this long before it is noticed: the climb from rest and the filter's delay."""
_ARMS_UP_S = 1.0
_TWITCH_S = 0.7
"""What is over sooner is no attempt at a gesture, mostly a wrong depth, and is passed over in silence."""
_KEPT_S = MAX_S + 4.0

Judge = Callable[[Clip, Sequence[Clip]], Advice | None]
"""Says what is wrong with a repetition, given those that were taken before it."""


class Stage(StrEnum):
    """Where a lesson is."""

    LOOK = "look"
    """Nobody is seen whole yet."""
    STILL = "still"
    """Waiting for them to stand still, arms hanging."""
    COUNTDOWN = "countdown"
    SHOW = "show"
    """Waiting for the movement to begin."""
    MOVING = "moving"
    DONE = "done"
    """All repetitions are taken."""


@dataclass(frozen=True, slots=True)
class Sight:
    """One picture, as far as a lesson is concerned."""

    stamp_ns: int
    pose: Pose | None
    """Of whoever teaches; ``None``: not found."""
    out_of_view: tuple[str, ...] = ()
    """Parts of them that lie outside of the picture."""
    why: str = ""
    """Why there is no pose."""


@dataclass(frozen=True, slots=True)
class Coaching:
    """What to tell whoever teaches, just now."""

    stage: Stage
    taken: int
    """Repetitions taken so far."""
    count: int | None = None
    """Seconds left of the countdown."""
    advice: Advice | None = None
    """What is wrong, or was wrong with the last repetition."""
    clip: Clip | None = None
    """A repetition that has just been taken."""
    refused: bool = False
    """Whether a repetition has just been refused, for the reason in ``advice``."""


@dataclass(frozen=True, slots=True)
class LessonConfig:
    """How a lesson goes.

    Raises:
        InputError: If there is no repetition, or a time is negative.
    """

    repetitions: int = 3
    countdown_s: float = 3.0
    """Seconds of standing still before each repetition; 0 for recordings, whose people hear no countdown."""
    still_s: float = 0.3
    """How long somebody stands still before the countdown begins."""
    margin_s: float = 0.1
    """How much before and after a movement goes into its clip."""
    segment: SegmentConfig = field(default_factory=SegmentConfig)

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.repetitions < 1:
            raise InputError(f"A lesson needs 1 repetition or more, but got {self.repetitions}.")
        for name in ("countdown_s", "still_s", "margin_s"):
            if not 0 <= getattr(self, name) < 60:
                raise InputError(f"LessonConfig.{name} must be 0 to 60 s, but got {getattr(self, name)}.")


class Teacher:
    """Guides one person through the repetitions of one gesture; a state machine over sights, without a clock.

    Args:
        label: The gesture's name.
        subject: Who shows it.
        judge: Says what is wrong with a repetition that is whole; ``None``: nothing ever is.
        config: How the lesson goes.

    Example:
        ``teacher = Teacher("wave", "ann"); coaching = teacher.update(Sight(stamp_ns, pose))``
    """

    def __init__(
        self, label: str, subject: str, judge: Judge | None = None, config: LessonConfig | None = None
    ) -> None:
        if not label.strip():
            raise InputError("A gesture needs a name.")
        self.label, self.subject, self.judge = label, subject, judge
        self.config = config or LessonConfig()
        self.clips: list[Clip] = []
        """The repetitions taken."""
        self._segmenter = Segmenter(self.config.segment)
        self._sights: deque[Sight] = deque()
        self._stage = Stage.LOOK
        self._since_ns = 0
        self._advice: Advice | None = None
        self._begun_ns = 0
        self._stirs_ns: int | None = None

    def update(self, sight: Sight) -> Coaching:
        """Take in what is seen now; say what to tell.

        Sights that are not newer than the last are ignored.
        """
        if self._stage is Stage.DONE or (self._sights and sight.stamp_ns <= self._sights[-1].stamp_ns):
            return self._say()
        self._sights.append(sight)
        while (sight.stamp_ns - self._sights[0].stamp_ns) * 1e-9 > _KEPT_S:
            self._sights.popleft()
        if sight.pose is not None:
            self._segmenter.update(sight.pose)
        match self._stage:
            case Stage.MOVING:
                return self._moving(sight)
            case Stage.SHOW:
                return self._show(sight)
            case _:
                return self._prepare(sight)

    def _prepare(self, sight: Sight) -> Coaching:
        """Wait until somebody is seen whole and still, then count down."""
        trouble = advise_view(sight.pose is not None, sight.why, sight.out_of_view)
        if trouble is not None:
            self._enter(Stage.LOOK, sight)
            return self._say(trouble)
        if self._stage is Stage.LOOK:
            self._enter(Stage.STILL, sight)
        pose = sight.pose
        if not self._segmenter.resting or pose is None or not arms_down(pose):
            return self._stir(sight)
        self._stirs_ns = None
        if self._stage is Stage.STILL and self._passed_s(sight) >= self.config.still_s:
            self._enter(Stage.COUNTDOWN, sight)
        if self._stage is Stage.COUNTDOWN:
            left_s = self.config.countdown_s - self._passed_s(sight)
            if left_s > 1e-6:
                return self._say(count=math.ceil(left_s))
            self._enter(Stage.SHOW, sight)
        return self._say()

    def _stir(self, sight: Sight) -> Coaching:
        """Somebody moves before their time: wait on, and if it was no twitch, say so."""
        self._stirs_ns = sight.stamp_ns if self._stirs_ns is None else self._stirs_ns
        if self._stage is not Stage.COUNTDOWN:
            self._enter(Stage.STILL, sight)
            return self._say()
        if (sight.stamp_ns - self._stirs_ns) * 1e-9 < _TWITCH_S:
            return self._say(count=max(math.ceil(self.config.countdown_s - self._passed_s(sight)), 1))
        self._advice = Advice(Fault.EARLY, "too early: wait for the end of the countdown")
        self._enter(Stage.STILL, sight)
        return self._say()

    def _show(self, sight: Sight) -> Coaching:
        if sight.pose is None:
            trouble = advise_view(False, sight.why, ())
            if self._hole_s(sight.stamp_ns, self._since_ns) > LONGEST_HOLE_S:
                self._enter(Stage.LOOK, sight)
            return self._say(trouble)
        if not self._segmenter.resting:
            self._begun_ns = sight.stamp_ns - round(_BEFORE_S * 1e9)
            self._advice = None
            self._enter(Stage.MOVING, sight)
        return self._say()

    def _moving(self, sight: Sight) -> Coaching:
        """Wait for rest with hanging arms, the end of every movement."""
        pose, began_s = sight.pose, (sight.stamp_ns - self._begun_ns) * 1e-9
        hole_s = self._hole_s(sight.stamp_ns, self._begun_ns)
        if hole_s > self.config.segment.gap_s:
            return self._refuse(
                sight, Advice(Fault.LOST, f"lost you for {hole_s:.1f} s: stay in the picture")
            )
        if began_s > MAX_S + 1.0:
            return self._refuse(
                sight, Advice(Fault.TOO_LONG, f"too long: end with hanging arms within {MAX_S:.0f} s")
            )
        if pose is None or not self._segmenter.resting:
            return self._say()
        if not arms_down(pose):
            if self._segmenter.activity_m_s < self.config.segment.off_m_s and began_s > _ARMS_UP_S:
                return self._say(Advice(Fault.ARMS_UP, "let your arms hang to end the gesture"))
            return self._say()
        return self._finish(sight)

    def _finish(self, sight: Sight) -> Coaching:
        end_ns = sight.stamp_ns - round(self.config.segment.hang_s * 1e9)
        if (end_ns - self._begun_ns) * 1e-9 < _TWITCH_S:
            self._enter(Stage.SHOW, sight)
            return self._say()
        inside = [s for s in self._sights if self._begun_ns <= s.stamp_ns <= end_ns]
        clip = self._clip(self._begun_ns, end_ns)
        if clip is None:
            return self._refuse(sight, Advice(Fault.TOO_FAST, "too short to be a gesture"))
        whole = [s.pose is not None and not s.out_of_view for s in inside]
        lost = sorted({part for s in inside for part in s.out_of_view})
        hole_s = self._hole_s(end_ns, self._begun_ns)
        advice = advise_movement(clip, hole_s, sum(whole) / max(len(whole), 1), lost)
        margin_ns = round(self.config.margin_s * 1e9)
        roomy = self._clip(self._begun_ns - margin_ns, end_ns + margin_ns) or clip
        if advice is None and self.judge is not None:
            advice = self.judge(roomy, self.clips)
        if advice is not None:
            return self._refuse(sight, advice)
        self.clips.append(roomy)
        self._advice = None
        self._enter(Stage.DONE if len(self.clips) == self.config.repetitions else Stage.STILL, sight)
        return Coaching(self._stage, len(self.clips), clip=roomy)

    def _refuse(self, sight: Sight, advice: Advice) -> Coaching:
        self._advice = advice
        self._enter(Stage.STILL if sight.pose is not None else Stage.LOOK, sight)
        return Coaching(self._stage, len(self.clips), advice=advice, refused=True)

    def _clip(self, first_ns: int, last_ns: int) -> Clip | None:
        poses = [s.pose for s in self._sights if s.pose is not None and first_ns <= s.stamp_ns <= last_ns]
        name = f"{self.subject}-{first_ns // 1_000_000}"
        return Clip.from_poses(poses, self.label, self.subject, name) if len(poses) >= 4 else None

    def _hole_s(self, until_ns: int, since_ns: int) -> float:
        """Return the longest time without a pose in a stretch, seconds."""
        stamps = [
            s.stamp_ns for s in self._sights if s.pose is not None and since_ns <= s.stamp_ns <= until_ns
        ]
        edges = [since_ns, *stamps, until_ns]
        return max(b - a for a, b in pairwise(edges)) * 1e-9

    def _passed_s(self, sight: Sight) -> float:
        return (sight.stamp_ns - self._since_ns) * 1e-9

    def _enter(self, stage: Stage, sight: Sight) -> None:
        if stage is not self._stage or stage is Stage.STILL:
            self._since_ns = sight.stamp_ns
        self._stage = stage

    def _say(self, advice: Advice | None = None, count: int | None = None) -> Coaching:
        return Coaching(self._stage, len(self.clips), count, advice or self._advice)


__all__ = ["Coaching", "Judge", "LessonConfig", "Sight", "Stage", "Teacher"]
