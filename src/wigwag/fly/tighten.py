"""Limits that are set anew during a flight: only ever tighter in the air, never looser than they began."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from wigwag.errors import InputError
from wigwag.fly.fence import Cylinder
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Situation

FENCE_RADIUS = "fence_radius_m"
"""The one dial that is no setting of its own: the radius of a fence that is a cylinder."""


@dataclass(frozen=True, slots=True)
class Dial:
    """A limit that can be set anew."""

    name: str
    """The setting of ``SupervisorConfig``, or ``FENCE_RADIUS``."""
    label: str
    """For people to read."""
    unit: str
    lowers: bool
    """Whether less is tighter."""
    tightest: float
    """The farthest that it goes: tighter, the drone could not do its work."""


DIALS: tuple[Dial, ...] = (
    Dial("max_speed_m_s", "Speed", "m/s", True, 0.2),
    Dial("max_climb_m_s", "Climb", "m/s", True, 0.1),
    Dial("max_yaw_rate_rad_s", "Turning", "rad/s", True, 0.3),
    Dial("min_distance_m", "Nearest", "m", False, 5.0),
    Dial("max_distance_m", "Farthest", "m", True, 3.0),
    Dial("ceiling_m", "Ceiling", "m", True, 1.0),
    Dial(FENCE_RADIUS, "Fence radius", "m", True, 3.0),
)
"""Every limit that can be set anew."""

_ROOM_M = 1.0
"""So much stays between the nearest and the farthest distance, for the drone to be at."""
_PLAY = 1e-9


def setting(limits: SupervisorConfig, name: str) -> float | None:
    """Return the value of a dial; ``None`` if there is no such dial, or the fence has no radius.

    Example:
        >>> setting(SupervisorConfig(), "fence_radius_m"), setting(SupervisorConfig(), "colour")
        (30.0, None)
    """
    if name == FENCE_RADIUS:
        return limits.fence.radius_m if isinstance(limits.fence, Cylinder) else None
    return float(getattr(limits, name)) if any(dial.name == name for dial in DIALS) else None


def with_settings(limits: SupervisorConfig, values: Mapping[str, float]) -> SupervisorConfig:
    """Return the limits with some dials set, however they stood before.

    Args:
        limits: As they are.
        values: By the dials' names.

    Raises:
        InputError: If there is no such dial here, or the limits would contradict each other.
    """
    for name in values:
        if setting(limits, name) is None:
            known = ", ".join(dial.name for dial in DIALS)
            raise InputError(f"{name!r} is no limit that can be set here. There are: {known}.")
    own = dict(values)
    fence, radius_m = limits.fence, own.pop(FENCE_RADIUS, None)
    if radius_m is not None and isinstance(fence, Cylinder):
        fence = replace(fence, radius_m=radius_m)
    return replace(limits, fence=fence, **own)


def changed(before: SupervisorConfig, after: SupervisorConfig) -> dict[str, float]:
    """Return the dials that differ, as they are afterwards.

    Example:
        >>> changed(SupervisorConfig(), SupervisorConfig(ceiling_m=3.0))
        {'ceiling_m': 3.0}
    """
    if before is after:
        return {}
    pairs = {dial.name: (setting(before, dial.name), setting(after, dial.name)) for dial in DIALS}
    return {name: now for name, (then, now) in pairs.items() if now is not None and now != then}


def tightened(
    limits: SupervisorConfig, start: SupervisorConfig, now: Situation, name: str, value: float
) -> tuple[SupervisorConfig, str]:
    """Set a limit anew if that is allowed: a function of its arguments and of nothing else.

    In flight a limit only gets tighter. On the ground, propellers locked, it may go back as far as where it
    was when the flight began. A limit of place is not drawn behind the drone: it would have to land for it.

    Args:
        limits: As they are.
        start: As they were when the flight began.
        now: What is known.
        name: The dial.
        value: In the dial's unit.

    Returns:
        The limits that hold from now on, and why they are the old ones; empty if they are not.

    Example:
        >>> limits, now = SupervisorConfig(), Situation(0, Craft.AIRBORNE, 0, 0)
        >>> slow, why = tightened(limits, limits, now, "max_speed_m_s", 0.5)
        >>> slow.max_speed_m_s, why
        (0.5, '')
        >>> tightened(slow, limits, now, "max_speed_m_s", 1.0)[1]
        'Speed: 1 m/s would be looser than 0.5 m/s; in flight a limit only gets tighter'
    """
    dial = next((dial for dial in DIALS if dial.name == name), None)
    was, first = setting(limits, name), setting(start, name)
    if dial is None or was is None or first is None or not math.isfinite(value):
        return limits, f"{name}: {value} cannot be set"
    why = _too_loose(dial, was, first, now.craft is Craft.DOWN, value) or _behind(dial, now, limits, value)
    if not why and not _looser(dial, dial.tightest, value):
        why = f"{dial.label}: {value:g} {dial.unit} is beyond {dial.tightest:g} {dial.unit}"
    if why:
        return limits, why
    try:
        tighter = with_settings(limits, {name: value})
    except InputError as error:
        return limits, f"{dial.label}: {error}"
    if tighter.max_distance_m - tighter.min_distance_m < _ROOM_M - _PLAY:
        return limits, f"{dial.label}: nearest and farthest have to be {_ROOM_M:g} m apart"
    return tighter, ""


def _looser(dial: Dial, than: float, value: float) -> bool:
    """Say whether a value is looser than another, or as loose."""
    return value >= than - _PLAY if dial.lowers else value <= than + _PLAY


def _too_loose(dial: Dial, was: float, first: float, grounded: bool, value: float) -> str:
    bound = first if grounded else was
    if _looser(dial, value, bound):
        return ""
    said = f"{dial.label}: {value:g} {dial.unit} would be looser than {bound:g} {dial.unit}"
    return f"{said}, where the flight began" if grounded else f"{said}; in flight a limit only gets tighter"


def _behind(dial: Dial, now: Situation, limits: SupervisorConfig, value: float) -> str:
    """Say why a limit of place cannot be set where the drone is beyond it already."""
    east, north, up = now.position_m
    if now.craft is Craft.DOWN:
        up = 0.0
    is_there: float | None = None
    if dial.name == "ceiling_m":
        is_there = up
    elif dial.name == "max_distance_m":
        is_there = now.distance_m
    elif dial.name == FENCE_RADIUS and isinstance(limits.fence, Cylinder):
        is_there = math.hypot(east - limits.fence.center_m[0], north - limits.fence.center_m[1])
    if is_there is None or is_there <= value:
        return ""
    return f"{dial.label}: the drone is at {is_there:.1f} {dial.unit}, beyond {value:g}; bring it back first"


__all__ = ["DIALS", "FENCE_RADIUS", "Dial", "changed", "setting", "tightened", "with_settings"]
