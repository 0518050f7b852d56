"""``wigwag demo``: the whole chain on a simulated drone, from pixels to flight."""

from __future__ import annotations

import json
import multiprocessing
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from wigwag.cli.looking import Looking
from wigwag.errors import InputError
from wigwag.record.turns import Pictures

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from wigwag.evaluate.lessons import InStreams
    from wigwag.evaluate.session import Session
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.recognise.explain import Explanation
    from wigwag.record.recorder import Recorder
    from wigwag.sim.script import ScriptConfig
    from wigwag.view.onlookers import Onlookers
    from wigwag.view.report import Still


START_M = 5.6
"""How far off the operator stands when the drone is on the ground: from nearer, a level camera down there
does not see raised hands."""

HOVER_M = 4.0
"""How far off they stand when it hovers already."""


@dataclass(frozen=True)
class Demo:
    """Fly a simulated drone by the gestures of a simulated operator; every pose comes from rendered pixels.

    Writes summary.json, report.html and demo.mp4. Example: wigwag demo --seed 2 --out out

    With gestures of your own: wigwag demo --model mine.wigwag --gestures goalpost --commands goalpost=orbit
    """

    motion: Literal["gestures", "utd-mhad"] = "gestures"
    """What moves the operator: procedural marshalling signals, or the recordings of real people."""
    data: Path | None = None
    """Folder of UTD-MHAD (with Skeleton.zip or Skeleton/); needed for --motion utd-mhad."""
    seed: int = 1
    """Chooses the person, the order, and all noise."""
    out: Path = Path("out")
    """Folder for what is written."""
    recognizer: Literal["kernel", "stream", "heavy", "encoded"] = "kernel"
    """Which recogniser decides: wigwag's own once a movement is over, or while it goes on (stream), or one of
    the paper's two."""
    film: bool = True
    """Write demo.mp4."""
    idle: bool = False
    """The operator walks, turns and fidgets and commands nothing; the drone hovers from the beginning."""
    duration: float = 600.0
    """Seconds of that."""
    model: Path | None = None
    """Fly by what was taught (wigwag teach, wigwag train) rather than by the demo's own recogniser."""
    gestures: tuple[str, ...] = ()
    """What is shown between taking off and landing, of what MODEL knows; by default the ten commands, and all
    that --commands names."""
    commands: tuple[str, ...] = ()
    """Which label commands what beside the ten commands, such as goalpost=orbit crane=stop."""
    rounds: int = 2
    """How often everything is shown."""
    record: Path | None = None
    """Write the flight to this .mcap file too, for wigwag replay, Foxglove and Rerun; with --motion utd-mhad
    one file a person, NAME-SUBJECT.mcap. Needs wigwag[record]."""
    record_pictures: Pictures = "jpeg"
    """What is kept of the pictures: none, jpeg, or png, which loses nothing."""
    record_depth: bool = False
    """Keep the depth too."""
    looking: Looking = field(default_factory=Looking)

    def run(self) -> int:
        """Teach, fly, judge, report; return 0."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        if not self.duration > 0:
            raise InputError(f"--duration must be above 0 seconds, but got {self.duration:g}.")
        if not 0 <= self.seed < 1_000_000:
            raise InputError(
                f"--seed must be from 0 to 999999, but got {self.seed}; above are training people."
            )
        if self.idle and self.motion != "gestures":
            raise InputError("--idle is for --motion gestures: what recorded people show are gestures.")
        if self.model is None and (self.gestures or self.commands or self.rounds != 2):
            raise InputError("--gestures, --commands and --rounds are for --model FILE: teach one first.")
        if self.model is not None and (self.motion != "gestures" or self.idle):
            raise InputError("--model is for --motion gestures, and not for --idle.")
        if self.record is not None:
            from wigwag.record.container import check_target

            check_target(self.record)
        began = time.monotonic()
        try:
            self.out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"--out {self.out}: cannot be made a folder ({error}). Name another.") from error
        console = Console()
        # Small matrices: more threads only wait for each other.
        with threadpool_limits(1), self.looking.open(console) as onlookers:
            summary = self._fly(console, onlookers)
        summary["rss_mb"] = peak_mb()
        summary["wall_s"] = round(time.monotonic() - began, 1)
        (self.out / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
        account(console, summary, self.out, filmed=self.film)
        return 0

    def _fly(self, console: Console, onlookers: Onlookers) -> dict[str, Any]:
        if self.motion == "utd-mhad":
            from wigwag.cli.demo_recorded import fly_recorded

            return fly_recorded(self, console, onlookers)
        if self.model is None:
            return self._fly_procedural(console, onlookers)
        return self._fly_taught(self.model, console, onlookers)

    def _fly_taught(self, model: Path, console: Console, onlookers: Onlookers) -> dict[str, Any]:
        from wigwag.cli.demo_taught import mapping_of, session_of
        from wigwag.stream.models import load_model
        from wigwag.stream.overhear import Overhearing

        taught, known = load_model(model)
        commands = mapping_of(self.commands)
        config = session_of(self.gestures, commands, known, model, self.rounds)
        estimator = pose_estimator()
        session = self._procedural_session(estimator, config)
        session.pilot.commands, session.pilot.spotter = commands, Overhearing(taught)
        recorder = self.recorder(session, model.read_bytes())
        film = self.out / "demo.mp4" if self.film else None
        stills = fly(session, estimator, console, film, recorder=recorder, onlookers=onlookers)
        shown = {name: commands[name].value for name in config.commands}
        summary = account_of(
            session, self, {"model": str(model), "recognizer": type(taught).__name__, "commands": shown}
        )
        write(self, session, summary, stills)
        return summary

    def _fly_procedural(self, console: Console, onlookers: Onlookers) -> dict[str, Any]:
        from wigwag.evaluate.lessons import teach_procedural, warm_up
        from wigwag.stream.overhear import Overhearing

        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder) / "demo.wigwag"
            # Teaching and, on the first run, compiling take a process each: what they need of memory goes
            # with them.
            with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
                taught = pool.submit(teach_procedural, model, self.recognizer)
                warm = pool.submit(warm_up)
                with console.status("Teaching ten gestures by eight simulated training people ..."):
                    warm.result()
                    estimator = pose_estimator()
                    session = self._procedural_session(estimator)
                    clips = taught.result()
            recogniser = load_recogniser(self.recognizer, model)
            recorder = self.recorder(session, model.read_bytes())
        session.pilot.spotter = Overhearing(recogniser)
        film = self.out / "demo.mp4" if self.film else None
        stills = fly(session, estimator, console, film, recorder=recorder, onlookers=onlookers)
        summary = account_of(session, self, {"clips_taught": clips})
        write(self, session, summary, stills)
        return summary

    def recorder(self, session: Session, model: bytes, name: str = "") -> Recorder | None:
        """Return what writes a session down; ``None``: nothing does.

        Args:
            session: Before its first turn.
            model: What was taught, as its file's bytes.
            name: Goes into the file's name, where there are several sessions.
        """
        if self.record is None:
            return None
        from wigwag.record.recorder import Recorder

        path = self.record.with_stem(f"{self.record.stem}-{name}") if name else self.record
        facts = {"command": "wigwag demo", "motion": self.motion, "seed": str(self.seed)}
        return Recorder(
            path, session.pilot, pictures=self.record_pictures, depth=self.record_depth, model=model,
            facts=facts, patient=True,
        )  # fmt: skip

    def _procedural_session(self, estimator: PoseEstimator, shown: ScriptConfig | None = None) -> Session:
        from wigwag.evaluate.session import Session
        from wigwag.pilot import Pilot
        from wigwag.sim.idle import plan_idle
        from wigwag.sim.motion import Operator
        from wigwag.sim.paint import Look
        from wigwag.sim.person import Person
        from wigwag.sim.quadrotor import QuadrotorConfig
        from wigwag.sim.script import ScriptConfig, plan_session
        from wigwag.sim.world import World, WorldConfig

        person = Person.random(self.seed)
        if self.idle:
            script = plan_idle(person, self.seed, self.duration, ScriptConfig(radius_m=1.2, engage=True))
            operator = Operator(person, script, position_m=(HOVER_M, 0.0), seed=self.seed)
            config = WorldConfig()
        else:
            script = plan_session(person, self.seed, shown or ScriptConfig(engage=True))
            operator = Operator(person, script, position_m=(START_M, 0.0), seed=self.seed)
            config = WorldConfig(quadrotor=QuadrotorConfig(position_m=(0.0, 0.0, 0.0)))
        world = World(config, self.seed, operator, Look.from_seed(self.seed, person.height_m))
        pilot = Pilot(estimator, Untaught(), world.vehicle)
        return Session(world, pilot, script)


class Untaught:
    """Stands where the recogniser goes until it has been taught."""

    def recognise(self, clip: object) -> Any:
        """Refuse: nothing has been taught yet."""
        raise InputError("The recogniser has not been taught yet.")


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
