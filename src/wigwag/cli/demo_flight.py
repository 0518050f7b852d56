"""What every demo does: fly a session to its end, account for it, write the report."""

from __future__ import annotations

import multiprocessing
import resource
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from wigwag.cli.demo import Demo
    from wigwag.evaluate.lessons import InStreams
    from wigwag.evaluate.session import Session
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.recognise.explain import Explanation
    from wigwag.record.recorder import Recorder
    from wigwag.view.onlookers import Onlookers
    from wigwag.view.report import Still


def pose_estimator() -> PoseEstimator:
    """Find or fetch the networks and make them ready."""
    from wigwag.pose.estimator import PoseEstimator

    return PoseEstimator()


def load_recogniser(name: str, model: Path) -> InStreams:
    """Read what was taught to hear a stream."""
    from wigwag.evaluate.lessons import IN_STREAMS

    return IN_STREAMS[name].load(model)


def fly(
    session: Session, estimator: PoseEstimator, console: Console, film: Path | None,
    *, recorder: Recorder | None = None, onlookers: Onlookers | None = None,
) -> list[Still]:  # fmt: skip
    """Fly a session to its end; show progress, film and record it, keep a still of each labelled gesture.

    Args:
        session: What is flown.
        estimator: Its eyes.
        console: Where progress is shown.
        film: File for the film; ``None``: none is made.
        recorder: Writes it down; ``None``: nothing does.
        onlookers: Whoever looks on, and may ask for something on the console's page.
    """
    from contextlib import nullcontext

    from wigwag.view.cockpit import Cockpit
    from wigwag.view.film import Film
    from wigwag.view.report import Still, jpeg

    stills: list[Still] = []
    cockpit = Cockpit()
    if onlookers is not None:
        onlookers.begin(session.pilot, estimator, live=False)
        session.asked = onlookers.asked
    frames = int(session.script.duration_s * session.world.config.rate_hz)
    with (
        _progress(console) as progress,
        nullcontext() if film is None else Film(film, rate_hz=10) as recording,
    ):
        task = progress.add_task("flying", total=frames, gestures=0)
        for count, turn in enumerate(session.fly()):
            cockpit.note(turn)
            if recorder is not None:
                recorder.turn(turn.frame, session.world.now_ns, turn.step)
            if onlookers is not None:
                onlookers.turn(turn.frame, turn.step)
            spoken = turn.step.gesture is not None and turn.step.gesture.label is not None
            if (recording is not None and count % 3 == 0) or spoken:
                picture = cockpit.draw(turn, estimator.body)
                if recording is not None and count % 3 == 0:
                    recording.add(picture)
                if spoken and turn.step.gesture is not None and len(stills) < 60:
                    caption = f"{turn.row.time_s:.1f} s: {str(turn.step.gesture.label).replace('_', ' ')}"
                    stills.append(Still(caption, jpeg(picture[:, :640]), _why(session)))
            if count % 15 == 0 or count == frames - 1:
                progress.update(task, completed=count + 1, gestures=len(session.log.events))
    if recorder is not None:
        recorder.close(ended="all shown")
        console.print(f"recorded: {recorder.path} {recorder.failed}", highlight=False)
    return stills


def _why(session: Session) -> Explanation | None:
    """Return what the last gesture came from, if its listener can tell."""
    from wigwag.stream.overhear import Overhearing

    listener = session.pilot.spotter
    return listener.explain() if isinstance(listener, Overhearing) else None


def _progress(console: Console) -> Progress:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("frames, {task.fields[gestures]} commands understood"),
        TimeRemainingColumn(),
        console=console,
    )


def peak_mb() -> int:
    """Return the most memory this process has held so far, MB."""
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def account_of(session: Session, demo: Demo, extra: dict[str, Any] | None = None) -> dict[str, Any]:
    """Return the figures of a session in the form of summary.json."""
    from wigwag import __version__
    from wigwag.evaluate.flight import summarise

    figures = summarise(session.log)
    return {
        "command": "demo",
        "version": __version__,
        "motion": demo.motion,
        "seed": demo.seed,
        "recognizer": demo.recognizer,
        "idle": demo.idle,
        **figures,
        "duration_s": round(session.script.duration_s, 1),
        "rss_mb": peak_mb(),
        **(extra or {}),
    }


def write(demo: Demo, session: Session, summary: dict[str, Any], stills: list[Still]) -> None:
    """Write the report."""
    from wigwag.view.report import write_report

    film = demo.out / "demo.mp4"
    shown = film if demo.film and film.stat().st_size < 24_000_000 else None
    # The plots' library stays out of the process that flies: it would add a twentieth to its memory.
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        pool.submit(write_report, demo.out / "report.html", summary, session.log, stills, shown).result()


def account(console: Console, summary: dict[str, Any], out: Path, *, filmed: bool = True) -> None:
    """Print the short account."""
    gestures, follow = summary["gestures"], summary["follow"]
    console.print(
        f"[bold]{gestures['recognised']} of {gestures['shown']} commands recognised[/], "
        f"{gestures['wrong']} wrong, {summary['false_commands']} false "
        f"({summary['others_shown']} other gestures shown)."
    )
    if "clips" in summary:
        clips = summary["clips"]
        console.print(
            f"One by one: {clips['right']} of {clips['shown']} recordings right, {clips['wrong']} wrong."
        )
    console.print(
        f"Operator found in {100 * summary['pose']['found']:.1f} % of the {summary['pose']['frames']} frames "
        "after engaging; "
        f"{summary['loop']['hz']:.0f} frames a second of one core, world included; {summary['rss_mb']} MB."
    )
    if follow:
        bearing, distance = follow["bearing_error_deg"], follow["distance_error_m"]
        console.print(
            f"Bearing error {bearing['mean']:.2f} degrees mean, {bearing['max']:.1f} at worst; "
            f"distance error {distance['mean']:.2f} m mean, {distance['max']:.2f} at worst."
        )
    film = f" and {out / 'demo.mp4'}" if filmed else ""
    console.print(f"Look at [bold]{out / 'report.html'}[/]{film}; figures: {out / 'summary.json'}")
