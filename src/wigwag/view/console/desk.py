"""Where the loop and the console meet: a turn becomes a snapshot, and what is asked for reaches the pilot."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from statistics import median
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from wigwag.camera.frame import Frame
from wigwag.fly.operator import Mount
from wigwag.fly.situation import Situation
from wigwag.fly.values import Command, VehicleState
from wigwag.pilot import Pilot, Step
from wigwag.pose.estimator import Person, PoseEstimator
from wigwag.skeleton import Pose
from wigwag.view.console.values import (
    KEPT_WHYS,
    Ask,
    Button,
    Figure,
    Flight,
    Lesson,
    Line,
    Picture,
    Snapshot,
    Why,
)

if TYPE_CHECKING:
    from wigwag.recognise.explain import Explanation

SNAPSHOT_HZ = 12.0
"""How often a snapshot is made at most."""
PICTURE_EVERY = 2
"""Every so many of them carry a picture: it is by far the largest part."""
_KEPT_LINES = 40
_COMMANDS = {Button.STOP: Command.STOP, Button.HOLD: Command.STOP, Button.LAND: Command.LAND}


class Showing(Protocol):
    """What takes snapshots and gives back what is asked for: ``Console``, or a stand-in."""

    trouble: str

    def show(self, snapshot: Snapshot) -> None:
        """Take a snapshot without waiting."""
        ...

    def asks(self) -> list[Ask]:
        """Return what was asked for since the last call."""
        ...


@runtime_checkable
class Explaining(Protocol):
    """A listener that can say what its last word came from, such as ``Overhearing``."""

    def explain(self) -> Explanation | None:
        """Explain it; ``None``: that cannot be told."""
        ...


class Desk:
    """Sits between a loop and its console.

    A turn of the loop is: ``asked`` before it, ``show`` after it.

    Args:
        console: The page.
        pilot: What is flown; ``None``: nothing is.
        eyes: What finds people, if it tells of others than the operator.
        clock_ns: The wall's clock, for rates alone.
    """

    def __init__(
        self,
        console: Showing,
        pilot: Pilot | None = None,
        eyes: PoseEstimator | None = None,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self.console, self.pilot = console, pilot
        if eyes is None and pilot is not None and isinstance(pilot.pose, PoseEstimator):
            eyes = pilot.pose
        self.eyes, self._clock_ns = eyes, clock_ns
        self.lessons: deque[Ask] = deque(maxlen=8)
        """What was asked for of lessons, for whoever gives them to take."""
        self._lines: deque[Line] = deque(maxlen=_KEPT_LINES)
        self._whys: deque[Why] = deque(maxlen=KEPT_WHYS)
        """What was heard and not handed over yet."""
        self._turns: deque[int] = deque(maxlen=60)
        self._timings: deque[tuple[float, float]] = deque(maxlen=60)
        self._situation: Situation | None = None
        self._now_ns = 0
        self._shown_ns: int | None = None
        self._count = 0
        self._trouble = ""

    def asked(self) -> Command | None:
        """Do what was asked for on the page, and return what the pilot is to be asked with the next turn.

        Stop comes before land, whichever was pressed first.
        """
        asks = self.console.asks()
        if not asks:
            return None
        buttons = [ask.button for ask in asks if ask.button is not None]
        for ask in asks:
            if ask.teach is not None or ask.button is Button.CANCEL:
                self.lessons.append(ask)
            elif ask.button is None:
                self._tighten(ask)
        for button in buttons:
            self._press(button)
        commands = {_COMMANDS.get(button) for button in buttons} if self.pilot is not None else set()
        return next((command for command in (Command.STOP, Command.LAND) if command in commands), None)

    def _press(self, button: Button) -> None:
        self._say(f"{button} pressed on the page", "console")
        if self.pilot is not None and button in (Button.HOLD, Button.ENGAGE):
            self.pilot.withheld = button is Button.HOLD
            self.pilot.calls += button is Button.ENGAGE
        if button is Button.ENGAGE and self.eyes is not None:
            self.eyes.call_operator()

    def _tighten(self, ask: Ask) -> None:
        if self.pilot is None or self._situation is None:
            return
        why = self.pilot.tighten(self._situation, ask.limit, ask.value)
        self._say(f"refused: {why}" if why else f"{ask.limit} is {ask.value:g} from now on", "console")

    def show(self, frame: Frame | None, step: Step, trouble: str = "") -> None:
        """Tell the page of a turn of a flight.

        Args:
            frame: What the camera gave.
            step: What the pilot made of it.
            trouble: What is wrong with the camera.
        """
        now_ns = step.situation.now_ns
        self._situation, self._now_ns = step.situation, now_ns
        self._hear(step, now_ns)
        self._complain(trouble or ("" if self.pilot is None else self.pilot.trouble), now_ns)
        if not self._due(step.pose_s, step.rest_s) or self.pilot is None:
            return
        stamp_ns = now_ns if frame is None else frame.stamp_ns
        seen_from = self.pilot.track.state_at(stamp_ns)
        flight = _flight(step, self.pilot)
        self._leave(frame, step.pose, now_ns, flight, seen_from=seen_from, mount=self.pilot.config.mount)

    def show_watched(
        self,
        frame: Frame | None,
        pose: Pose | None,
        now_ns: int,
        pose_s: float,
        trouble: str,
        *,
        lesson: Lesson | None = None,
    ) -> None:
        """Tell the page of a turn of a loop that flies nothing.

        Args:
            frame: What the camera gave.
            pose: The operator's.
            now_ns: On the clock of the stamps.
            pose_s: Processor seconds for finding it.
            trouble: What is wrong with the camera.
            lesson: What is being taught. That it is being learned is shown at once: no other turn comes
                before that is over.
        """
        self._complain(trouble, now_ns)
        self._now_ns = now_ns
        due = self._due(pose_s, 0.0)
        if due or (lesson is not None and lesson.learning):
            self._leave(frame, pose, now_ns, None, lesson=lesson)

    def _hear(self, step: Step, now_ns: int) -> None:
        """Note what is worth a line in the list of events."""
        at_s, gesture, verdict = now_ns * 1e-9, step.gesture, step.verdict
        if gesture is not None:
            name = "not a gesture I know" if gesture.label is None else gesture.label.replace("_", " ")
            sure = f" {gesture.confidence:.0%}" if gesture.label is not None else f" ({gesture.reason})"
            self._lines.append(Line(at_s, name + sure, "gesture" if gesture.label is not None else ""))
            if gesture.label is not None:
                self._explain(at_s)
        if verdict.row:
            self._lines.append(Line(at_s, f"{verdict.row}: {verdict.mode.replace('_', ' ')}", "mode"))
        if verdict.reason:
            self._lines.append(Line(at_s, verdict.reason, "alarm"))

    def _explain(self, at_s: float) -> None:
        """Take down why it was heard, if the listener can tell; after the turn has sent what it asks for."""
        listener: object = None if self.pilot is None else self.pilot.spotter
        if not isinstance(listener, Explaining):
            return
        try:
            explained = listener.explain()
        except Exception as error:  # of whatever kind: nobody stops flying for want of an explanation
            self._lines.append(Line(at_s, f"cannot be explained: {error}", "alarm"))
            return
        if explained is not None:
            self._whys.append(Why.of(at_s, explained))

    def _complain(self, trouble: str, now_ns: int) -> None:
        if trouble != self._trouble and trouble:
            self._lines.append(Line(now_ns * 1e-9, trouble, "alarm"))
        self._trouble = trouble

    def _say(self, text: str, kind: str) -> None:
        self._lines.append(Line(self._now_ns * 1e-9, text, kind))

    def _due(self, pose_s: float, rest_s: float) -> bool:
        """Count a turn; say whether it is time for another snapshot."""
        now_ns = self._clock_ns()
        self._turns.append(now_ns)
        self._timings.append((1e3 * pose_s, 1e3 * rest_s))
        if self._shown_ns is not None and now_ns - self._shown_ns < 1e9 / SNAPSHOT_HZ:
            return False
        self._shown_ns = now_ns
        return True

    def _leave(
        self,
        frame: Frame | None,
        pose: Pose | None,
        now_ns: int,
        flight: Flight | None,
        *,
        seen_from: VehicleState | None = None,
        mount: Mount | None = None,
        lesson: Lesson | None = None,
    ) -> None:
        span_s = (self._turns[-1] - self._turns[0]) * 1e-9
        pose_ms, rest_ms = (median(part) for part in zip(*self._timings, strict=True))
        people = () if self.eyes is None else self.eyes.people
        snapshot = Snapshot(
            now_ns,
            None if frame is None or self._count % PICTURE_EVERY else _picture(frame),
            _figures(people, pose),
            seen_from,
            mount or Mount(),
            flight,
            self._who(pose),
            max((person.engaging for person in people if not person.is_operator), default=0.0),
            (len(self._turns) - 1) / span_s if span_s > 0 else 0.0,
            pose_ms,
            rest_ms,
            tuple(self._lines),
            lesson,
            tuple(self._whys),
        )
        self._whys.clear()
        self._count += 1
        self.console.show(snapshot)

    def _who(self, pose: Pose | None) -> str:
        if pose is not None:
            return "seen"
        return "not seen" if self.eyes is None or not self.eyes.why else self.eyes.why


def _figures(people: Sequence[Person], pose: Pose | None) -> tuple[Figure, ...]:
    """Return everybody; the operator as handed on, steadied, where they were."""
    if not people:
        return () if pose is None else (Figure(True, pose.joints, None, None),)
    figures = []
    for person in people:
        placed = pose if person.is_operator and pose is not None else person.pose
        body = person.body
        figures.append(
            Figure(
                person.is_operator,
                None if placed is None else placed.joints,
                None if body is None else body.points_px,
                None if body is None else body.visibility,
            )
        )
    return tuple(figures)


def _picture(frame: Frame) -> Picture:
    height, width = frame.rgb.shape[:2]
    return Picture(frame.rgb, (width, height), 2 * math.atan2(height / 2, frame.intrinsics.fy))


def _flight(step: Step, pilot: Pilot) -> Flight:
    sent, supervisor = step.permit.setpoint, pilot.supervisor
    speed_m_s = 0.0 if sent is None else math.hypot(*sent.velocity_m_s[:2])
    return Flight(
        step.verdict.mode, step.situation.craft, step.verdict.reason, step.permit.changed, speed_m_s,
        step.situation.distance_m, step.goal, step.state, supervisor.config, supervisor.start, pilot.withheld,
    )  # fmt: skip


__all__ = ["PICTURE_EVERY", "SNAPSHOT_HZ", "Desk", "Showing"]
