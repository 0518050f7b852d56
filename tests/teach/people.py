"""Simulated people before a camera that stands still, as their poses: no pixels."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from wigwag.recognise import KernelRecognizer
from wigwag.sim.clips import SensorConfig, Session, cut, watch
from wigwag.sim.performing import PerformingConfig, plan_performances
from wigwag.sim.person import Person
from wigwag.skeleton import Clip, Pose
from wigwag.teach.teacher import Sight

TRIPOD = SensorConfig(distance_m=(4.5, 4.5), height_m=(1.2, 1.2), yaw_rad=0.0)
"""A camera that stands still."""

GESTURES = ("up", "left", "orbit", "land")


@cache
def performed(person: int, gestures: tuple[str, ...], times: int, pause_s: float = 5.0) -> Session:
    """Watch somebody show gestures in turn."""
    who = Person.random(person)
    script = plan_performances(who, gestures, person, PerformingConfig(times, pause_s))
    return watch(who, script, TRIPOD, np.random.default_rng([7, person]))


def clips_of(person: int, gestures: Sequence[str], times: int) -> list[Clip]:
    """Return their showings, cut out."""
    session = performed(person, tuple(gestures), times)
    return cut(session, (0.0, 0.15), name_others=True, pieces=0)


@cache
def model() -> KernelRecognizer:
    """Teach four commands, and two movements that are none, by three people."""
    clips = [c for person in (1, 2, 3) for c in clips_of(person, (*GESTURES, "wave", "bow"), 2)]
    return KernelRecognizer(origin="drift", preset="fast", copies=1).fit(clips)


def sights(session: Session) -> list[Sight]:
    """Return what a teacher is told of a session, frame by frame."""
    stream = session.stream
    return [
        Sight(int(stamp), Pose(joints, np.ones(13), int(stamp)))
        for joints, stamp in zip(stream.joints, stream.stamps_ns, strict=True)
    ]
