"""The plan of a session in which the operator commands nothing: they walk, turn about and fidget."""

from __future__ import annotations

import numpy as np

from wigwag.errors import InputError
from wigwag.sim.gestures import BACKGROUND, DISTRACTORS, perform
from wigwag.sim.person import Person
from wigwag.sim.script import Planner, Script, ScriptConfig

_STILL_S = (0.4, 4.0)
_WALK_S = (1.5, 4.0)
_TURNS = (0.0, 0.3, 0.6, 1.0)


def plan_idle(person: Person, seed: int, duration_s: float, config: ScriptConfig | None = None) -> Script:
    """Plan a session of everyday movements: those that training shows and those that it never does.

    Standing, walking (towards the drone, away, wholly or partly turned to where the way leads) and movements
    of the hands and the body follow one another at random.

    Args:
        person: Who.
        seed: Chooses everything.
        duration_s: At least so long; the last movement is finished.
        config: Walking and drifting; what it says about gestures is not used.

    Raises:
        InputError: If the duration is not positive.

    Example:
        >>> from wigwag.sim.person import Person
        >>> script = plan_idle(Person.random(7), seed=0, duration_s=60)
        >>> any(shown.is_command for shown in script.shown), script.duration_s >= 60
        (False, True)
    """
    if not duration_s > 0:
        raise InputError(f"plan_idle needs a duration above 0 seconds, but got {duration_s}.")
    config = config or ScriptConfig(radius_m=1.2)
    rng = np.random.default_rng([0x1D7E, seed])
    planner = Planner(config, rng)
    planner.begin(person, seed)
    names = (*BACKGROUND, *DISTRACTORS)
    while planner.now_s < duration_s:
        chance = float(rng.random())
        if chance < 0.35:
            planner.walk(float(rng.uniform(*_WALK_S)), turn=float(rng.choice(_TURNS)))
            planner.wait(config.pause_s)
        elif chance < 0.85:
            name = str(rng.choice(names))
            planner.act(
                perform(name, person, [seed, len(planner.acts)]), name, False, f"person {person.seed}"
            )
            planner.wait(float(rng.uniform(0.3, 1.0)))
        else:
            planner.wait(float(rng.uniform(*_STILL_S)))
    return planner.finish()


__all__ = ["plan_idle"]
