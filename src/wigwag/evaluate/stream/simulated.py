"""Everyday movements of simulated people, seen through the simulated camera: as many hours as one likes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from wigwag.datasets.recording import Mark, Recording
from wigwag.sim.clips import TRAINING_SEED, SensorConfig, watch
from wigwag.sim.gestures import BACKGROUND, DISTRACTORS
from wigwag.sim.person import Person
from wigwag.sim.script import ScriptConfig, plan_session

_TAUGHT_SEED = TRAINING_SEED + 900_000
_INNER_SEED = 500_000


def simulated_everyday(people: int, purpose: str = "test", seed: int = 0) -> list[Recording]:
    """Let simulated people stand, walk, turn and move as people do who command nothing.

    Each shows every movement twice, in three minutes or so, half of the time walking between. What
    the camera adds is what the demo's does: noise that lasts, noise of depth, glitches, landmarks where
    BlazePose puts them.

    Args:
        people: How many people; each is one recording.
        purpose: ``"teach"``: movements that training may show, by people nobody is judged on;
            ``"inner"`` and ``"test"``: those and movements that no training shows, by others each.
        seed: Of people and order.

    Returns:
        Recordings without marks; scenes are named ``"simulated:scratch_head"`` and so on.
    """
    first = {"teach": _TAUGHT_SEED, "inner": _INNER_SEED, "test": 0}[purpose] + 1000 * seed
    return [_recording(number, purpose == "teach") for number in range(first, first + people)]


@lru_cache(maxsize=64)
def _recording(number: int, teach: bool) -> Recording:
    """Simulate one person; kept, since every teaching of a run sees the same ones."""
    names = BACKGROUND if teach else (*BACKGROUND, *DISTRACTORS)
    config = ScriptConfig(
        commands=(), repetitions=1, others=names, n_others=2 * len(names), gap_s=(0.6, 2.4), lead_in_s=3.0
    )
    person = Person.random(number)
    script = plan_session(person, number, config)
    session = watch(person, script, SensorConfig(), np.random.default_rng([0x51, number]))
    scenes = tuple(
        Mark(f"simulated:{s.label}", round(s.start_s * 1e9), round(s.end_s * 1e9)) for s in session.shown
    )
    return Recording(session.stream, (), scenes)


__all__ = ["simulated_everyday"]
