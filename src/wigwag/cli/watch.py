"""``wigwag watch``: see what the camera sees, who is the operator, and what is measured, live."""

from __future__ import annotations

import shlex
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from wigwag.cli.looking import Looking
from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.camera.protocol import Camera
    from wigwag.evaluate.records import Records
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.view.onlookers import Onlookers
    from wigwag.view.watching import Meter


@dataclass(frozen=True)
class Watch:
    """See what the camera sees: rate, who is the operator, what is measured. Nothing flies.

    Raise one hand above your head for a second to become the operator; both hands let go again.
    Example: wigwag watch --camera webcam:0 --view
    """

    camera: str = "webcam:0"
    """Address of the camera; see docs/cameras.md. sim: needs no hardware."""
    duration_s: float | None = None
    """Stop after so many seconds of the stream; by default at its end, or on Ctrl-C."""
    engage: Literal["gesture", "first"] = "gesture"
    """Who becomes the operator: whoever raises a hand, or whoever is seen first."""
    json: Path | None = None
    """File for the figures: one record."""
    looking: Looking = field(default_factory=Looking)

    def run(self) -> int:
        """Watch to the end of the stream; return 0."""
        from rich.console import Console

        from wigwag.camera.address import hide_password
        from wigwag.cameras import open_camera
        from wigwag.evaluate.records import Records
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.pose.operator import OperatorConfig
        from wigwag.view.watching import Meter

        if self.duration_s is not None and not self.duration_s > 0:
            raise InputError(f"--duration-s must be above 0, but got {self.duration_s}.")
        records = Records(
            self.json, shlex.join(["wigwag", "watch", "--camera", hide_password(self.camera)]), None
        )
        console, meter = Console(), Meter()
        with ExitStack() as stack:
            onlookers = stack.enter_context(self.looking.open(console, flies=False))
            estimator = PoseEstimator(PoseConfig(operator=OperatorConfig(engage=self.engage)))
            camera = stack.enter_context(open_camera(self.camera))
            try:
                self._watch(console, camera, estimator, onlookers, meter)
            except KeyboardInterrupt:
                console.print("stopped")
            finally:
                self._account(console, meter, records)
        return 0

    def _watch(
        self,
        console: Console,
        camera: Camera,
        estimator: PoseEstimator,
        onlookers: Onlookers,
        meter: Meter,
    ) -> None:
        from rich.live import Live

        from wigwag.camera.fresh import fresh
        from wigwag.view.watching import Watched, panel

        live_clock = _is_live(camera)
        onlookers.begin(eyes=estimator, live=live_clock)
        began_ns: int | None = None
        said_ns, sight = 0, None
        with Live(console=console, refresh_per_second=8, transient=True) as live:
            for glimpse in fresh(camera):
                began_ns = glimpse.now_ns if began_ns is None else began_ns
                pose, began = None, time.thread_time()
                if glimpse.frame is not None:
                    pose = estimator(glimpse.frame)
                spent_s = time.thread_time() - began
                latency_s = None
                if live_clock and glimpse.frame is not None:
                    latency_s = (camera.now_ns - glimpse.frame.stamp_ns) * 1e-9
                watched = Watched(glimpse, pose, spent_s, latency_s)
                meter.note(watched)
                onlookers.asked()
                onlookers.watched(
                    glimpse.frame,
                    pose,
                    glimpse.now_ns,
                    spent_s,
                    latency_s=latency_s,
                    trouble=glimpse.health.reason,
                )
                if onlookers.rerun is not None and glimpse.health.sight is not sight:
                    sight = glimpse.health.sight
                    said = f"picture {sight.value} {glimpse.health.reason}"
                    onlookers.rerun.say(said, not glimpse.health.usable)
                if glimpse.now_ns - said_ns > 120_000_000:
                    said_ns = glimpse.now_ns
                    live.update(panel(camera, watched, meter, estimator.people, estimator.why))
                if self.duration_s is not None and (glimpse.now_ns - began_ns) * 1e-9 >= self.duration_s:
                    return

    def _account(self, console: Console, meter: Meter, records: Records) -> None:
        figures = meter.account()
        found, rate = figures["operator_found"], figures["rate_hz"]
        if found is None:
            console.print("No usable picture came.")
        else:
            text = f"{figures['frames_fresh']} pictures"
            text += f" at {rate:.1f} a second" if rate else ""
            text += f"; the operator's pose in {found:.0%} of them, {figures['pose_ms_median']:.1f} ms each"
            if figures["latency_ms_median"] is not None:
                text += f", {figures['latency_ms_median']:.0f} ms after the picture (median)"
            console.print(text + ".")
        sights = {f"sight_{name}": turns for name, turns in figures.pop("sights").items()}
        records.add(**figures, **sights)


def _is_live(camera: Camera) -> bool:
    from wigwag.camera.live import LiveCamera

    return isinstance(camera, LiveCamera)
