"""``wigwag demo --motion utd-mhad``: real people's recorded movements drive the rendered operator."""

from __future__ import annotations

import multiprocessing
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wigwag.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.cli.demo import Demo
    from wigwag.evaluate.recorded import Item
    from wigwag.evaluate.session import Session
    from wigwag.pose.estimator import PoseEstimator
    from wigwag.sim.person import Person
    from wigwag.view.onlookers import Onlookers
    from wigwag.view.report import Still

COMMANDS_EACH, OTHERS_EACH = 10, 5
"""Commands and other recordings that each of the four people shows in the stream."""


def fly_recorded(demo: Demo, console: Console, onlookers: Onlookers) -> dict[str, Any]:
    """Show each of four people's recordings of the six classes one by one, then fly a stream of theirs."""
    from wigwag.cli.demo_flight import account_of, fly, write
    from wigwag.evaluate.flight import FlightLog, summarise
    from wigwag.evaluate.recorded import SHOWN
    from wigwag.sim.script import ScriptConfig, plan_replays

    if demo.data is not None and not demo.data.exists():  # before processes are started that find it out
        raise InputError(
            f"--data {demo.data}: no such file or folder. Expected UTD-MHAD's Skeleton.zip or Skeleton/."
        )
    if demo.data is None:
        raise InputError("--motion utd-mhad needs --data: UTD-MHAD's folder (Skeleton.zip or Skeleton/).")
    recogniser, six_classes, estimator, clips, model = _taught(demo.data, demo.recognizer, console)
    answers: list[dict[str, Any]] = []
    stream = FlightLog()
    stills: list[Still] = []
    standing = ScriptConfig(walk_share=0.0, drift_share=0.0, engage=True)
    walking = ScriptConfig(engage=True)
    session: Session | None = None
    # One person's recordings and one world at a time: all of them together would take 150 MB more.
    for number, subject in enumerate(SHOWN):
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            person, chosen, mixed = pool.submit(shown_by, demo.data, subject, [demo.seed, number]).result()
        console.print(f"{subject}: {len(chosen)} recordings one by one")
        session, script = None, plan_replays(chosen, demo.seed, standing, shuffle=False, person=person)
        session = make_session(person, script, estimator, recogniser, demo.seed + number)
        fly(session, estimator, console, None)
        answers += one_by_one(session, six_classes)
        console.print(f"{subject}: a stream of {len(mixed)} recordings, walking between")
        session, script = (
            None,
            plan_replays(mixed, demo.seed + number, walking, person=person),
        )
        session = make_session(person, script, estimator, recogniser, 100 + demo.seed + number)
        film = demo.out / "demo.mp4" if demo.film and number == 0 else None
        recorder = demo.recorder(session, model, subject)
        # The stamps of each subject begin anew: the first one is looked on at, as it is filmed.
        looking = onlookers if number == 0 else None
        stills += fly(session, estimator, console, film, recorder=recorder, onlookers=looking)[:12]
        stream.append(session.log, stream.rows[-1].time_s + 1.0 if stream.rows else 0.0)
    assert session is not None
    summary = account_of(session, demo, {"clips_taught": clips})
    summary |= summarise(stream)
    summary["duration_s"] = round(stream.rows[-1].time_s, 1)
    right, wrong = (sum(a["outcome"] == o for a in answers) for o in ("right", "wrong"))
    summary["clips"] = {
        "shown": len(answers),
        "right": right,
        "wrong": wrong,
        "null": len(answers) - right - wrong,
        "not_right": [a for a in answers if a["outcome"] != "right"],
    }
    session.log = stream
    write(demo, session, summary, stills)
    return summary


def _taught(data: Path, recognizer: str, console: Console) -> tuple[Any, Any, PoseEstimator, int, bytes]:
    """Return recognisers for the stream and of the six classes alone, pose chain, clips, the first's file."""
    from wigwag.cli.demo_flight import load_recogniser, pose_estimator
    from wigwag.datasets.utd_mhad import load_skeletons
    from wigwag.evaluate.lessons import RECOGNISERS, closed_of, warm_up
    from wigwag.evaluate.recorded import teach_recorded

    with tempfile.TemporaryDirectory() as folder:
        model, six = Path(folder) / "stream.wigwag", Path(folder) / "six.wigwag"
        with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
            # A wrong folder shows before anything is fetched or taught.
            pool.submit(load_skeletons, data, labels=("a1",)).result()
            taught = pool.submit(teach_recorded, data, model, six, recognizer)
            warm = pool.submit(warm_up)
            with console.status("Teaching six classes by the skeletons of subjects 1, 3, 5 and 7 ..."):
                warm.result()
                estimator = pose_estimator()
                clips = taught.result()
        stream, closed = load_recogniser(recognizer, model), RECOGNISERS[closed_of(recognizer)].load(six)
        file = model.read_bytes()
    return stream, closed, estimator, clips, file


def shown_by(data: Path, subject: str, seed: list[int]) -> tuple[Person, list[Item], list[Item]]:
    """Return one subject's body, their recordings of the six classes, and those of their stream.

    Runs in a process of its own, which takes what reading a hundred recordings needs of memory with it.
    """
    from wigwag.evaluate.recorded import load_person

    person, items = load_person(data, subject)
    mixed = choose(items, np.random.default_rng([0x3141, *seed]))
    return person, [item for item in items if item[2]], mixed


def make_session(
    person: Person, script: Any, estimator: PoseEstimator, recogniser: Any, seed: int
) -> Session:
    """Put a person and a hovering drone into a new world."""
    from wigwag.evaluate.recorded import COMMANDS
    from wigwag.evaluate.session import Session
    from wigwag.pilot import Pilot
    from wigwag.sim.motion import Operator
    from wigwag.sim.paint import Look
    from wigwag.sim.world import World, WorldConfig
    from wigwag.stream.overhear import Overhearing

    operator = Operator(person, script, position_m=(4.0, 0.0), seed=seed)
    look = Look.from_seed(seed, person.height_m)
    world = World(WorldConfig(), seed, operator, look)
    estimator.reset()
    pilot = Pilot(estimator, recogniser, world.vehicle, commands=COMMANDS)
    pilot.spotter = Overhearing(recogniser)
    return Session(world, pilot, script)


def choose(items: list[Item], rng: np.random.Generator) -> list[Item]:
    """Draw commands, evenly over the classes, and other recordings."""
    commands = [item for item in items if item[2]]
    others = [item for item in items if not item[2]]
    by_class: dict[str, list[Item]] = {}
    for index in rng.permutation(len(commands)):
        by_class.setdefault(commands[int(index)][1], []).append(commands[int(index)])
    names = sorted(by_class)
    drawn = [by_class[names[i % len(names)]][i // len(names)] for i in range(COMMANDS_EACH)]
    return drawn + [others[int(i)] for i in rng.permutation(len(others))[:OTHERS_EACH]]


def one_by_one(session: Session, six_classes: Any) -> list[dict[str, Any]]:
    """Say which of the six classes each recording is, by the poses that the chain measured meanwhile.

    As in the paper's table the answer is one of the six; nothing is refused but an operator not seen.
    """
    from wigwag.skeleton import Clip

    stamps = np.array([pose.stamp_ns for pose in session.movements]) * 1e-9
    answers = []
    for shown in session.script.shown:
        inside = np.flatnonzero((stamps >= shown.start_s - 0.1) & (stamps <= shown.end_s + 0.1))
        label = None
        if len(inside) >= 4:
            clip = Clip.from_poses([session.movements[int(i)] for i in inside], name=shown.label)
            label = str(six_classes.predict([clip])[0])
        outcome = "right" if label == shown.label else "null" if label is None else "wrong"
        answers.append({"shown": shown.label, "subject": shown.subject, "got": label, "outcome": outcome})
    return answers
