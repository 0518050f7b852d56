"""Sessions of recorded people: UTD-MHAD's movements in simulated bodies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wigwag.datasets.utd_mhad import RATE_HZ, load_raw20, load_skeletons
from wigwag.errors import DataError
from wigwag.evaluate.lessons import LessonConfig, closed_of, teach, teach_in_streams
from wigwag.fly.values import Command
from wigwag.sim.clips import SensorConfig, cut, watch
from wigwag.sim.person import Person
from wigwag.sim.recorded import Replay, replay
from wigwag.sim.script import ScriptConfig, plan_replays

COMMANDS: dict[str, Command] = {
    "a1": Command.LEFT, "a6": Command.STOP, "a7": Command.FARTHER, "a9": Command.ORBIT,
    "a24": Command.UP, "a27": Command.CLOSER,
}  # fmt: skip
"""What the paper's six classes ask of the drone in the demo."""

TRAINING = ("s1", "s3", "s5", "s7")
"""People whose skeletons are taught; the others are shown."""

SHOWN = ("s2", "s4", "s6", "s8")

Item = tuple[Replay, str, bool, str]


def load_person(data: Path, subject: str, labels: Sequence[str] | None = None) -> tuple[Person, list[Item]]:
    """Load one subject's recordings, ready to be shown, and a body with their limbs.

    Args:
        data: Folder of UTD-MHAD.
        subject: ``"s1"`` to ``"s8"``.
        labels: Which actions; ``None``: all 27.
    """
    loaded = load_skeletons(data, labels=labels, subjects=(subject,))
    items: list[Item] = []
    limbs = []
    for clip in loaded.clips:
        joints = load_raw20(data, clip.name)
        limbs.append(joints[:: max(len(joints) // 8, 1)])
        label = str(clip.label)
        items.append((replay(joints, RATE_HZ, clip.name), label, label in COMMANDS, subject))
    if not items:
        raise DataError(f"{data}: no usable recording of {subject}.")
    person = Person.like(np.concatenate(limbs), seed=int(subject[1:]))
    return person, items


def teach_recorded(
    data: Path,
    model: Path,
    six_classes: Path,
    recognizer: str = "kernel",
    config: LessonConfig | None = None,
) -> int:
    """Teach the six classes by the skeletons of subjects 1, 3, 5 and 7 and save two recognisers.

    No picture is rendered for it: a skeleton is moved to where the pose network would see it
    (``LANDMARK_BIAS``).

    Args:
        data: Folder of UTD-MHAD.
        model: For the stream: all 27 classes, of which six are commands; the standing and walking between,
            and halves of gestures, are background.
        six_classes: For recordings shown one by one: the six classes alone, as in the paper's table.
        recognizer: ``"kernel"``, ``"heavy"`` or ``"encoded"``.
        config: How much is taught.

    Returns:
        How many clips were taught for the stream.
    """
    config = config or LessonConfig(refused_per_person=150)
    sessions = []
    for subject in TRAINING:
        person, items = load_person(data, subject)
        script = plan_replays(items, config.seed, ScriptConfig(walk_share=0.3))
        rng = np.random.default_rng([0xACED, config.seed, int(subject[1:])])
        sessions.append(watch(person, script, SensorConfig(), rng))
    clips = [clip for session in sessions for clip in cut(session, seed=config.seed)]
    teach([clip for clip in clips if clip.label in COMMANDS], six_classes, closed_of(recognizer))
    return teach_in_streams(sessions, model, recognizer, config)
