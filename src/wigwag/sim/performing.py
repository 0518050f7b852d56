"""The plan of somebody who shows one gesture again and again, with rests between: to teach it by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wigwag.errors import InputError
from wigwag.sim.gestures import PERFORMABLE, perform
from wigwag.sim.person import Person
from wigwag.sim.script import Planner, Script, ScriptConfig

LEAD_IN_S = 5.0
"""Standing before the first showing: whoever teaches counts down from three first."""


@dataclass(frozen=True, slots=True)
class PerformingConfig:
    """How showings follow each other.

    Raises:
        InputError: If there is no showing, or no time between two.
    """

    times: int = 10
    """How often each gesture is shown."""
    pause_s: float = 5.0
    """Rest after each showing; long enough for a countdown from three."""
    engage: bool = False
    """Whether one hand is raised first, to engage."""

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.times < 1 or not self.pause_s >= 1:
            raise InputError(
                "PerformingConfig needs times of 1 or more and pause_s of 1 or more, but got "
                f"{self.times} and {self.pause_s}."
            )


def plan_performances(
    person: Person,
    gestures: Sequence[str],
    seed: int = 0,
    config: PerformingConfig | None = None,
    *,
    commands: Sequence[str] | None = None,
) -> Script:
    """Plan showings of one gesture, or of several in turn.

    Args:
        person: Who shows them: their sizes, tempo and habits.
        gestures: Any of :data:`~wigwag.sim.gestures.PERFORMABLE`.
        seed: Chooses the repetitions.
        config: How often, and how far apart.
        commands: Which of them ought to be answered; by default all.

    Raises:
        InputError: If there is no simulated gesture of a name, or none is named.

    Example:
        >>> script = plan_performances(Person.random(2), ["goalpost"], config=PerformingConfig(times=3))
        >>> [shown.label for shown in script.shown]
        ['goalpost', 'goalpost', 'goalpost']
    """
    if not gestures or (unknown := set(gestures) - set(PERFORMABLE)):
        what = f"no {', '.join(sorted(unknown))}" if gestures else "no gesture named"
        raise InputError(f"There is {what} to show. A simulated operator shows: {', '.join(PERFORMABLE)}.")
    config = config or PerformingConfig()
    lead_in_s = 1.2 if config.engage else LEAD_IN_S
    standing = ScriptConfig(engage=config.engage, lead_in_s=lead_in_s, drift_share=0.0)
    planner = Planner(standing, np.random.default_rng([0x9E2F, seed]))
    planner.begin(person, seed)
    if config.engage:
        planner.wait(LEAD_IN_S - 1.2)
    for turn in range(config.times):
        for place, name in enumerate(gestures):
            spoken = commands is None or name in commands
            motion = perform(name, person, [0x9E2F, seed, turn * len(gestures) + place])
            planner.act(motion, name, spoken, f"person {person.seed}")
            planner.wait(config.pause_s)
    return planner.finish()


__all__ = ["LEAD_IN_S", "PerformingConfig", "plan_performances"]
