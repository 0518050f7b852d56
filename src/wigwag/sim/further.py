"""Scores of gestures that nobody is taught beforehand: what a simulated operator shows to teach.

They keep to the rules of the commands (``wigwag.sim.scores``): both arms, off the hips, about two seconds,
from hanging arms to hanging arms.
"""

from __future__ import annotations

from wigwag.sim.person import Side
from wigwag.sim.scores import REST, Key, Score
from wigwag.sim.scores import both_sides as both
from wigwag.sim.scores import one_side as one


def _goalpost(_: Side) -> list[Key]:
    """Upper arms level, forearms up like goalposts; they fall and rise again, twice."""
    up = both(**{"raise": 86, "forward": 8, "bend": 88, "roll": -84})
    fallen = both(**{"raise": 80, "forward": 8, "bend": 86, "roll": 78})
    return [
        Key(0.48, up), Key(0.42, fallen), Key(0.40, up), Key(0.42, fallen), Key(0.50, REST),
    ]  # fmt: skip


def _semaphore(_: Side) -> list[Key]:
    """One arm straight up, the other level: an L, then the L of the other side, and once more."""

    def letter(high: Side, level: Side) -> dict[str, float]:
        return one(high, **{"raise": 166, "forward": 4, "bend": 8, "roll": -40}) | one(
            level, **{"raise": 88, "forward": 4, "bend": 8, "roll": 0}
        )

    return [
        Key(0.52, letter("left", "right")), Key(0.50, letter("right", "left")),
        Key(0.50, letter("left", "right")), Key(0.60, REST),
    ]  # fmt: skip


def _crane(_: Side) -> list[Key]:
    """Stand on the left leg, the right knee raised, arms spread low; down, and once more."""
    low = both(**{"raise": 62, "forward": 8, "bend": 14, "roll": 0})
    up = one("right", foot_forward=24, foot_up=42) | low | {"pelvis_left": 5.0}
    hanging = both(**{"raise": 30, "forward": 8, "bend": 20, "roll": 0})
    down = one("right", foot_forward=0, foot_up=0) | hanging | {"pelvis_left": 0.0}
    return [Key(0.55, up), Key(0.50, down), Key(0.50, up), Key(0.55, REST)]


def _hug(_: Side) -> list[Key]:
    """Arms wide, then folded around oneself, twice."""
    wide = both(**{"raise": 84, "forward": 6, "bend": 12, "roll": 0})
    folded = both(**{"raise": 60, "forward": 62, "bend": 112, "roll": 38})
    return [Key(0.48, wide), Key(0.45, folded), Key(0.45, wide), Key(0.45, folded), Key(0.6, REST)]


FURTHER_SCORES: dict[str, Score] = {
    "goalpost": _goalpost, "semaphore": _semaphore, "crane": _crane, "hug": _hug,
}  # fmt: skip
"""Gestures that are in no vocabulary until somebody teaches them."""

FURTHER = tuple(FURTHER_SCORES)

__all__ = ["FURTHER", "FURTHER_SCORES"]
