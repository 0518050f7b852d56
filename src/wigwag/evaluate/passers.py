"""Sessions in which people cross, stop beside and before, and replace a rendered operator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wigwag.sim.exposure import ExposureConfig
from wigwag.sim.gestures import COMMANDS, perform
from wigwag.sim.motion import Operator
from wigwag.sim.paint import Look
from wigwag.sim.passerby import Leg, Passerby, beside, crossings
from wigwag.sim.person import Person
from wigwag.sim.quadrotor import QuadrotorConfig
from wigwag.sim.scene import SceneConfig
from wigwag.sim.script import Act, Script, Walk
from wigwag.sim.world import World, WorldConfig

DISTANCES_M = (3.0, 4.0, 6.0, 8.0)
PATIENCE_S = 1.5
"""So soon after the passer-by is clear the operator must be handed on again."""
PASSERBY_SEED = 50_000
_ROOM_M = 4.0
"""Nearer than this, gusts tilt a raised hand out of the picture: the operator raises it three times."""

_Cast = tuple["Condition", int, np.random.Generator]
"""What chooses a passer-by: the condition, the seed, and chance."""

Event = Literal["crosses", "stops beside", "stops before", "takes the place"]


@dataclass(frozen=True, slots=True)
class Condition:
    """What makes it hard."""

    name: str
    light: float = 1.0
    """See ``wigwag.sim.exposure``."""
    wall: bool = False
    """A wall in the shirt's colour behind the operator."""
    turned_deg: float = 0.0
    """How far past the drone the operator faces, once engaged."""
    same_clothes: bool = False
    """Passers-by dress as the operator does."""
    event: Event = "crosses"
    passers: int = 1
    """How many people cross at the same time, from either side."""
    walks: bool = False
    """The operator walks to and fro instead of standing."""
    follows: bool = False
    """The drone flies and follows; otherwise it hovers, in the same gusts."""

    @property
    def patience_s(self) -> float:
        """How soon after an event the operator must be handed on: who left has to come back and engage."""
        return 11.0 if self.event == "takes the place" else PATIENCE_S


CONDITIONS: tuple[Condition, ...] = (
    Condition("clutter"),
    Condition("dusk", light=0.02),
    Condition("dark", light=0.005),
    Condition("shirt-coloured wall", wall=True),
    Condition("turned -60", turned_deg=-60.0),
    Condition("turned -30", turned_deg=-30.0),
    Condition("turned 30", turned_deg=30.0),
    Condition("turned 60", turned_deg=60.0),
    Condition("same clothes", same_clothes=True),
    Condition("same clothes, dark", same_clothes=True, light=0.005),
    Condition("two at once", passers=2),
    Condition("operator walks", walks=True),
    Condition("drone follows", walks=True, follows=True),
    Condition("stops beside, shows commands", event="stops beside"),
    Condition("stops beside, same clothes", event="stops beside", same_clothes=True),
    Condition("stops before", event="stops before"),
    Condition("takes the place", event="takes the place"),
    Condition("takes the place, same clothes", event="takes the place", same_clothes=True),
)
"""Everything that is measured. There is clutter near the operator in all of them."""


@dataclass(frozen=True, slots=True)
class Staged:
    """A session ready to be played."""

    world: World
    condition: Condition
    distance_m: float
    engaged_s: float
    """When the operator's raised hand is down again."""
    windows: tuple[tuple[float, float], ...]
    """When each crossing (or other event) begins and ends, seconds."""
    duration_s: float


def stage(condition: Condition, distance_m: float, events: int, seed: int) -> Staged:
    """Build a session: an operator who engages and then shows commands, and people who cross.

    Args:
        condition: What makes it hard.
        distance_m: From the drone to the operator.
        events: How many crossings, or other events of the condition's kind.
        seed: Chooses people, clothes, surroundings, ways, gusts and noise.
    """
    rng = np.random.default_rng([0x0B5E, seed, round(10 * distance_m), _code(condition.name)])
    person = Person.random(seed)
    look = Look.from_seed(seed, person.height_m)
    engage = perform("engage", person, seed)
    raises = 1 if distance_m >= _ROOM_M else 3
    acts = [Act(1.0 + k * (engage.duration_s + 0.3), engage) for k in range(raises)]
    engaged_s = acts[-1].end_s
    begin_s = engaged_s + 1.0
    passers, windows = _passers(condition, distance_m, events, begin_s=begin_s, seed=seed, rng=rng)
    duration_s = max(end for _, end in windows) + condition.patience_s + 0.2
    walks: tuple[Walk, ...] = ()
    if condition.event == "takes the place":
        walks, again = _leave_and_return(windows, person, seed)
        acts += again
    else:
        acts += _commands(person, begin_s, duration_s, seed, rng)
        walks = _to_and_fro(begin_s, duration_s) if condition.walks else ()
    script = Script(tuple(acts), walks, (), duration_s, engaged_s)
    operator = Operator(
        person, script, (distance_m, 0.0), seed=seed,
        turned_rad=float(np.radians(condition.turned_deg)), turns_s=engaged_s,
    )  # fmt: skip
    others = []
    for k, passer in enumerate(passers):
        theirs = Look.from_seed(PASSERBY_SEED + 10 * seed + k, passer.person.height_m)
        if condition.same_clothes:
            theirs = replace(
                theirs, shirt=look.shirt, shirt_below=look.shirt_below, trousers=look.trousers,
                shorts=look.shorts, sleeve=look.sleeve, shoes=look.shoes,
            )  # fmt: skip
        others.append((passer, theirs))
    config = WorldConfig(
        scene=SceneConfig(near=7, wall=look.shirt if condition.wall else None),
        exposure=ExposureConfig(light=condition.light) if condition.light < 1 else None,
        quadrotor=QuadrotorConfig(position_m=(0.0, 0.0, 1.3)),
    )
    world = World(config, seed, operator, look, others=others)
    return Staged(world, condition, distance_m, engaged_s, windows, duration_s)


def _code(name: str) -> int:
    """Turn a name into a number, the same on every machine."""
    return sum((k + 1) * ord(letter) for k, letter in enumerate(name))


def _passers(
    condition: Condition,
    distance_m: float,
    events: int,
    *,
    begin_s: float,
    seed: int,
    rng: np.random.Generator,
) -> tuple[list[Passerby], tuple[tuple[float, float], ...]]:
    """Plan the ways of those who pass, and when each event begins and ends."""
    start, ways = crossings(distance_m, events, rng)
    if condition.event != "crosses":
        ways = [_stops(condition.event, distance_m, way) for way in ways]
    legs = [leg for way in ways for leg in way]
    marks = [int(mark) - 1 for mark in np.cumsum([len(way) for way in ways])]
    cast = (condition, seed, rng)
    first = _passer(0, start, legs, begin_s, cast)
    ends = first.ends_s
    starts = [begin_s, *(ends[mark] + legs[mark].pause_s for mark in marks[:-1])]
    windows = tuple((a, ends[mark]) for a, mark in zip(starts, marks, strict=True))
    passers = [first]
    for n in range(1, condition.passers):
        # The others walk the same ways from the other side, a little later.
        mirrored = [Leg((leg.to_m[0], -leg.to_m[1]), leg.speed_m_s, leg.pause_s) for leg in legs]
        late = begin_s + 0.4 * n
        passers.append(_passer(n, (start[0], -start[1]), mirrored, late, cast))
    return passers, windows


def _stops(event: Event, distance_m: float, way: Sequence[Leg]) -> list[Leg]:
    """Let somebody who would cross stop on the way, and change sides clear of the operator.

    Each way begins on the side on which the last one ended: nobody walks through anybody.
    """
    to, speed, across = way[0].to_m, way[0].speed_m_s, way[1].to_m
    side, offset = float(np.sign(to[1])), abs(to[0] - distance_m)
    if event == "stops beside":  # 0.64 to 1.2 m from the operator
        place = (distance_m, 0.8 * side * offset)
        return [way[0], Leg(place, speed, 5.0), Leg(to, speed, 1.0), Leg(across, speed, 1.0)]
    if event == "stops before":
        near = beside(distance_m - offset, side)
        here = (near[0], 0.0)
        return [Leg(near, speed, 0.9), Leg(here, speed, 3.0), Leg((near[0], -near[1]), speed, 0.4)]
    # The operator is away, beyond where this ends, until then.
    return [Leg(to, speed, 4.5), Leg((distance_m, 0.0), speed, 4.5), Leg(across, speed, 5.5)]


def _passer(
    number: int, start: tuple[float, float], legs: Sequence[Leg], begin_s: float, cast: _Cast
) -> Passerby:
    condition, seed, rng = cast
    person = Person.random(PASSERBY_SEED + 10 * seed + number)
    plain = Passerby(person, start, legs, begin_s)
    stops = condition.event in ("stops beside", "takes the place")
    acts = []
    for leg, end_s in zip(legs, plain.ends_s, strict=True):
        if stops and abs(leg.to_m[1]) < 1.5 and leg.pause_s > 4:
            motion = perform(str(rng.choice(COMMANDS)), person, int(rng.integers(1 << 30)))
            acts.append(Act(end_s + 1.0, motion))
    return Passerby(person, start, legs, begin_s, acts=acts, looks_at_drone=stops, seed=seed)


def _commands(person: Person, begin_s: float, end_s: float, seed: int, rng: np.random.Generator) -> list[Act]:
    """Let the operator show commands all the time."""
    acts: list[Act] = []
    now_s = begin_s
    while now_s < end_s:
        motion = perform(str(rng.choice(COMMANDS)), person, [seed, len(acts)])
        acts.append(Act(now_s, motion))
        now_s = acts[-1].end_s + float(rng.uniform(1.0, 2.0))
    return acts


def _to_and_fro(begin_s: float, end_s: float) -> tuple[Walk, ...]:
    """Let the operator walk 0.9 m to either side."""
    walks: list[Walk] = []
    now_s, direction, length = begin_s, np.pi / 2, 0.9
    while now_s < end_s:
        speed = 0.6
        walks.append(Walk(now_s, length / speed + 0.5, direction, speed))
        now_s += walks[-1].duration_s + 0.8
        direction, length = -direction, 1.8
    return tuple(walks)


def _leave_and_return(
    windows: Sequence[tuple[float, float]], person: Person, seed: int
) -> tuple[tuple[Walk, ...], list[Act]]:
    """Let the operator walk out of the picture as each event begins, and back and engage as it ends."""
    walks: list[Walk] = []
    acts: list[Act] = []
    for k, (begin, end) in enumerate(windows):
        side = np.pi / 2 if k % 2 == 0 else -np.pi / 2  # away from where the other comes from
        length, speed = 5.2, 1.4
        lasts = length / speed + 0.5
        walks.append(Walk(begin, lasts, side, speed))
        walks.append(Walk(end - 0.5, lasts, -side, speed))
        acts.append(Act(end + lasts, perform("engage", person, [seed, k])))
    return tuple(walks), acts


__all__ = ["CONDITIONS", "DISTANCES_M", "Condition", "Staged", "stage"]
