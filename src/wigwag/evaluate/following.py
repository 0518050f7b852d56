"""How well a person is followed and commands are flown, by vehicles that answer as real ones do."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.movements import MovementConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.sim.quadrotor import Quadrotor, QuadrotorConfig
from wigwag.sim.response import Response, ardupilot_like, px4_like
from wigwag.sim.sketch import Flown, SketchConfig, SketchWorld, Walk
from wigwag.sim.wind import WindConfig

START_M = (0.0, 0.0, 1.2)
SENSOR = SketchConfig(delay_s=0.05, jitter_s=0.05, lost=0.02)
"""Frames that come 50 to 100 ms late, and one in fifty without a pose."""
WIND = WindConfig(gust_m_s=2.0)
MOVES = (
    Command.LEFT, Command.RIGHT, Command.UP, Command.DOWN, Command.CLOSER, Command.FARTHER, Command.ORBIT
)  # fmt: skip
_SETTLE_S = 2.0
_STAND_S, _MEAN_S = 6.0, 2.0
"""Before a command, so long it stands: put into the wind at rest, a quadrotor takes seconds to lean against
it. Where it is, before and after, is the mean of so long: gusts shake it by half a decimetre in a second."""

Place = tuple[float, float, float]
"""Where a drone is, seen from the person: angle around them, radians; distance; height, metres."""


def _rotorpy(seed: int) -> Flown:
    return Quadrotor(QuadrotorConfig(position_m=START_M, wind=WIND), seed)


VEHICLES: dict[str, Callable[[int], Flown]] = {
    "PX4-like": lambda seed: Response(px4_like(position_m=START_M, wind=WIND), seed),
    "ArduCopter-like": lambda seed: Response(ardupilot_like(position_m=START_M, wind=WIND), seed),
    "RotorPy": _rotorpy,
}
"""Vehicles by name, each with its wind."""


@dataclass(frozen=True, slots=True)
class Followed:
    """How one walk was followed. Errors are true ones; the first two seconds are left out."""

    bearing_deg_mean: float
    bearing_deg_max: float
    distance_m_mean: float
    distance_m_max: float


def arc(speed_m_s: float = 0.75, radius_m: float = 3.0) -> Walk:
    """Return a walk along a circle that begins 4.5 m ahead of the drone, after two seconds of standing."""

    def walk(time_s: float) -> tuple[float, float]:
        angle = max(time_s - 2.0, 0.0) * speed_m_s / radius_m
        return 4.5 + radius_m * math.sin(angle), radius_m * (1.0 - math.cos(angle))

    return walk


def follow(vehicle: str, seed: int, seconds: float = 60.0, walk: Walk | None = None) -> Followed:
    """Follow a person who walks along an arc at 0.75 m/s.

    Args:
        vehicle: One of ``VEHICLES``.
        seed: Draws noise, lateness and wind.
        seconds: Of walking.
        walk: Another walk.
    """
    flight = PromptedFlight(SketchWorld(VEHICLES[vehicle](seed), walk or arc(), SENSOR, seed))
    flight.turns(_SETTLE_S)
    bearing, distance = [], []
    for _ in range(round(seconds * 30)):
        step = flight.turn()
        bearing.append(abs(math.degrees(flight.world.bearing_rad)))
        distance.append(abs(flight.world.distance_m - step.goal.distance_m))
    return Followed(float(np.mean(bearing)), max(bearing), float(np.mean(distance)), max(distance))


def fly_command(vehicle: str, command: Command, seed: int) -> float:
    """Fly one command around a standing person; return by which share of its way it missed its end.

    Args:
        vehicle: One of ``VEHICLES``.
        command: One of ``MOVES``.
        seed: Draws noise, lateness and wind.
    """
    world = SketchWorld(VEHICLES[vehicle](seed), lambda time_s: (4.5, 0.0), SENSOR, seed)
    flight, sizes = PromptedFlight(world), MovementConfig()
    places: list[Place] = []

    def turn(command: Command | None = None) -> None:
        flight.turn(command)
        at_m = world.airframe.state.position_m
        places.append(place_around(at_m, world.person_m, places[-1][0] if places else 0.0))

    def where() -> Place:
        """Return the place of the last seconds, on average."""
        angle, distance, height = np.mean(places[-round(30 * _MEAN_S) :], axis=0)
        return float(angle), float(distance), float(height)

    for _ in range(round(_STAND_S * 30)):
        turn()
    before = where()
    turn(command)
    heard_by_s = flight.now_s + 0.5  # a turn whose frame is late hears the command with the next one
    while flight.pilot.supervisor.mode is not Mode.EXECUTING and flight.now_s < heard_by_s:
        turn()
    until_s = flight.now_s + 90.0
    while flight.pilot.supervisor.mode is Mode.EXECUTING and flight.now_s < until_s:
        turn()
    for _ in range(round((_SETTLE_S + _MEAN_S) * 30)):
        turn()
    return missed(command, before, where(), sizes)


def missed(command: Command, before: Place, after: Place, sizes: MovementConfig) -> float:
    """Return by which share of its way a command missed its end.

    Args:
        command: One of ``MOVES``.
        before: Where the drone was.
        after: Where it came to.
        sizes: How far each command goes.
    """
    turned, farther, higher = (a - b for a, b in zip(after, before, strict=True))
    done, wanted = {
        Command.LEFT: (turned * before[1], sizes.sideways_m),
        Command.RIGHT: (-turned * before[1], sizes.sideways_m),
        Command.ORBIT: (-turned, sizes.orbit_rad),
        Command.UP: (higher, sizes.altitude_step_m),
        Command.DOWN: (-higher, sizes.altitude_step_m),
        Command.CLOSER: (-farther, sizes.distance_step_m),
        Command.FARTHER: (farther, sizes.distance_step_m),
    }[command]
    return abs(done - wanted) / wanted


def place_around(drone_m: Float[np.ndarray, " 3"], person_m: tuple[float, float], last_rad: float) -> Place:
    """Return where a drone is, seen from a person; the angle is the one nearest to the last one.

    The angle grows anticlockwise, which is to the operator's own left.
    """
    x, y = float(drone_m[0]) - person_m[0], float(drone_m[1]) - person_m[1]
    turned = (math.atan2(y, x) - last_rad + math.pi) % (2 * math.pi) - math.pi
    return last_rad + turned, math.hypot(x, y), float(drone_m[2])


def summary(vehicle: str, runs: int, seconds: float, seed: int) -> dict[str, Any]:
    """Follow and fly every command with each of several seeds; return the record of one vehicle."""
    seeds = range(seed, seed + runs)
    walks = [follow(vehicle, s, seconds) for s in seeds]
    missed = {move: [fly_command(vehicle, move, s) for s in seeds] for move in MOVES}
    every = [miss for misses in missed.values() for miss in misses]
    return {
        "vehicle": vehicle,
        "runs": runs,
        "seconds": seconds,
        "bearing_deg_mean": float(np.mean([w.bearing_deg_mean for w in walks])),
        "bearing_deg_worst_run": max(w.bearing_deg_mean for w in walks),
        "bearing_deg_max": max(w.bearing_deg_max for w in walks),
        "distance_m_mean": float(np.mean([w.distance_m_mean for w in walks])),
        "distance_m_worst_run": max(w.distance_m_mean for w in walks),
        "distance_m_max": max(w.distance_m_max for w in walks),
        "command_error_mean": float(np.mean(every)),
        "command_error_max": max(every),
        "commands_within_15": float(np.mean(np.array(every) <= 0.15)),
        **{f"{move}_error_mean": float(np.mean(misses)) for move, misses in missed.items()},
    }


__all__ = [
    "MOVES", "VEHICLES", "Followed", "Place", "arc", "fly_command", "follow", "missed", "place_around",
    "summary",
]  # fmt: skip
