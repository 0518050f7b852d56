"""``wigwag demo``: the whole chain on a simulated drone, from pixels to flight."""

from __future__ import annotations

import json
import multiprocessing
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from wigwag.cli.demo_flight import account, account_of, fly, load_recogniser, peak_mb, pose_estimator, write
from wigwag.cli.looking import Looking
from wigwag.errors import InputError
from wigwag.record.turns import Pictures

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.evaluate.session import Session
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.record.recorder import Recorder
    from wigwag.sim.script import ScriptConfig
    from wigwag.view.onlookers import Onlookers


START_M = 5.6
"""How far off the operator stands when the drone is on the ground: from nearer, a level camera down there
does not see raised hands."""

HOVER_M = 4.0
"""How far off they stand when it hovers already."""


@dataclass(frozen=True)
class Demo:
    """Fly a simulated drone by the gestures of a simulated operator; every pose comes from rendered pixels.

    Writes summary.json, report.html and demo.mp4. Exit code 1: a command was false, or taken for another.
    Example: wigwag demo --seed 2 --out out

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
        """Teach, fly, judge, report; return 0, or 1 if anything was done that nobody had asked for."""
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
        return int(summary["gestures"]["wrong"] > 0 or summary["false_commands"] > 0)

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
                with console.status("Teaching ten gestures by simulated training people ..."):
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
