"""Whoever looks on while the chain runs: Rerun, the console, both, or nobody. Two lines in every loop."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from wigwag.camera.frame import Frame
from wigwag.fly.values import Command
from wigwag.pilot import Pilot, Step
from wigwag.pose.estimator import PoseEstimator
from wigwag.skeleton import Pose
from wigwag.view.console.desk import Desk, Showing
from wigwag.view.console.values import Ask, Lesson

if TYPE_CHECKING:
    from wigwag.view.rerun import RerunView

_BEHIND_S = 0.25
"""A loop that is so far behind is not hurried on afterwards."""


class Pace:
    """Holds time that passes with the frames to the wall's clock.

    Args:
        clock_ns: The wall's.
        wait: How to wait.

    Example:
        >>> waited = []
        >>> pace = Pace(clock_ns=lambda: 0, wait=waited.append)
        >>> pace.wait(0); pace.wait(33_000_000)
        >>> waited
        [0.033]
    """

    def __init__(
        self,
        clock_ns: Callable[[], int] = time.monotonic_ns,
        wait: Callable[[float], object] | None = None,
    ) -> None:
        self._clock_ns, self._wait = clock_ns, wait or threading.Event().wait
        self._ahead_ns: int | None = None
        """The wall's clock, less the other one, when it was last in time."""

    def wait(self, now_ns: int) -> None:
        """Wait until it is so late on the wall, too."""
        wall_ns = self._clock_ns()
        if self._ahead_ns is None:
            self._ahead_ns = wall_ns - now_ns
        left_ns = now_ns + self._ahead_ns - wall_ns
        if left_ns > 0:
            self._wait(left_ns * 1e-9)
        elif left_ns < -_BEHIND_S * 1e9:
            self._ahead_ns = wall_ns - now_ns


class Onlookers:
    """Shows each turn of a loop to whoever looks on, and hears the console.

    A turn is: ``asked`` before it, ``turn`` (or ``watched``, where nothing flies) after it.

    Args:
        rerun: A view in Rerun.
        console: A page; while there is one, a simulated flight goes no faster than time does.
    """

    def __init__(self, rerun: RerunView | None = None, console: Showing | None = None) -> None:
        self.rerun, self.console = rerun, console
        self._desk: Desk | None = None
        self._pilot: Pilot | None = None
        self._eyes: PoseEstimator | None = None
        self._pace: Pace | None = None

    def begin(
        self,
        pilot: Pilot | None = None,
        eyes: PoseEstimator | None = None,
        *,
        live: bool = True,
    ) -> None:
        """Say what is looked on at; before the first turn.

        Args:
            pilot: What is flown; ``None``: nothing is.
            eyes: What finds people; by default the pilot's.
            live: Whether time passes by itself; if not, it passes with the frames.
        """
        self._pilot, self._eyes = pilot, eyes
        if eyes is None and pilot is not None and isinstance(pilot.pose, PoseEstimator):
            self._eyes = pilot.pose
        if self.console is not None:
            self._desk = Desk(self.console, pilot, self._eyes)
            self._pace = None if live else Pace()

    def asked(self) -> Command | None:
        """Return what the pilot is to be asked with the next turn."""
        return None if self._desk is None else self._desk.asked()

    def lessons(self) -> list[Ask]:
        """Return what was asked for of lessons, up to the last call of ``asked``."""
        if self._desk is None:
            return []
        asks = list(self._desk.lessons)
        self._desk.lessons.clear()
        return asks

    @property
    def trouble(self) -> str:
        """Why the page is gone; empty: it is there, or nobody asked for one."""
        return "" if self.console is None else self.console.trouble

    def turn(self, frame: Frame | None, step: Step, trouble: str = "") -> None:
        """Show a turn of a flight.

        Args:
            frame: What the camera gave.
            step: What the pilot made of it.
            trouble: What is wrong with the camera.
        """
        if self._desk is not None:
            self._desk.show(frame, step, trouble)
        if self.rerun is not None and self._pilot is not None:
            pilot, stamp_ns = self._pilot, step.situation.now_ns
            if frame is not None:
                stamp_ns = frame.stamp_ns
                self._picture(frame)
            seen_from = pilot.track.state_at(stamp_ns)
            self.rerun.flight(step, seen_from, pilot.config.mount, pilot.supervisor.config)
        if self._pace is not None:
            self._pace.wait(step.situation.now_ns)

    def watched(
        self,
        frame: Frame | None,
        pose: Pose | None,
        now_ns: int,
        pose_s: float,
        *,
        latency_s: float | None = None,
        trouble: str = "",
        lesson: Lesson | None = None,
    ) -> None:
        """Show a turn of a loop in which nothing flies.

        Args:
            frame: What the camera gave.
            pose: The operator's.
            now_ns: On the clock of the stamps.
            pose_s: Processor seconds for finding it.
            latency_s: From the frame's stamp to its pose; ``None``: time is not now.
            trouble: What is wrong with the camera.
            lesson: What is being taught.
        """
        if self._desk is not None:
            self._desk.show_watched(frame, pose, now_ns, pose_s, trouble, lesson=lesson)
        if self.rerun is not None and frame is not None:
            self._picture(frame)
            figures = {"pose_ms": 1e3 * pose_s}
            if latency_s is not None:
                figures["latency_ms"] = 1e3 * latency_s
            self.rerun.figures(figures)
        if self._pace is not None:
            self._pace.wait(now_ns)

    def _picture(self, frame: Frame) -> None:
        assert self.rerun is not None
        self.rerun.frame(frame)
        if self._eyes is not None:
            self.rerun.people(self._eyes.people)


__all__ = ["Onlookers", "Pace"]
