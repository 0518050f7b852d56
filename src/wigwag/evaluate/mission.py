"""A whole flight on any vehicle, judged: take off, follow a walking person, obey their gestures, land.

The person is simulated and seen without pixels (``wigwag.sim.stage``); everything from the poses on is what
``wigwag fly`` flies with. The vehicle may be any, such as an autopilot in its own simulator.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, field

import numpy as np

from wigwag.evaluate.following import Place, missed, place_around
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command, VehicleState
from wigwag.pilot import Pilot
from wigwag.sim.stage import Stage
from wigwag.vehicles.protocol import FlightMode

BEARING_DEG, DISTANCE_M, COMMAND_SHARE, HEIGHT_M = 2.0, 0.3, 0.15, 0.5
"""What a flight is held to: mean bearing and distance error, share of a command's way, height of take-off."""
_TAKES = 3
"""A gesture that is not understood is shown again, so often in all."""
_PATIENCE_S, _FLIGHT_PATIENCE_S, _SETTLE_S, _MEAN_S = 4.0, 60.0, 2.5, 1.0
_FLOWN = (Mode.FOLLOWING, Mode.EXECUTING)

Waiting = Generator[None, None, bool]
"""Part of the plan; goes on a picture at a time and says at its end whether it went well."""


@dataclass(frozen=True, slots=True)
class MissionConfig:
    """What is shown."""

    walk_s: float = 60.0
    speed_m_s: float = 0.75
    radius_m: float = 3.0
    """Of the circle that is walked."""
    commands: tuple[Command, ...] = (
        Command.LEFT, Command.UP, Command.CLOSER, Command.RIGHT, Command.DOWN, Command.FARTHER
    )  # fmt: skip
    """Shown one after the other, after the walk."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was asked of the flight."""

    what: str
    found: str
    asked: str
    good: bool
    value: float | None = None
    """The figure itself, in the unit of ``asked``; ``None``: it never came to that."""


@dataclass(slots=True)
class _Row:
    """One picture's moment."""

    time_s: float
    place: Place
    bearing_deg: float
    off_m: float
    """Distance less the one to be kept."""
    mode: Mode


@dataclass(slots=True)
class Mission:
    """Directs the person, and judges the vehicle.

    Args:
        stage: Where the person is.
        pilot: What flies.
        judged: Where the vehicle is: what it says of itself, or the truth where that is known.
        config: What is shown.
    """

    stage: Stage
    pilot: Pilot
    judged: Callable[[], VehicleState]
    config: MissionConfig = field(default_factory=MissionConfig)
    findings: list[Finding] = field(default_factory=list)
    over: bool = False
    """Whether everything was shown, and the vehicle stands again or never will."""
    _rows: list[_Row] = field(default_factory=list)
    _plan: Waiting | None = None
    _takes: int = 0

    @property
    def good(self) -> bool:
        """Whether everything was as asked."""
        return self.over and all(finding.good for finding in self.findings)

    def turn(self) -> None:
        """Look, and let the person go on; called once a picture."""
        if self.stage.time_s <= 0 or self.over:
            return
        self._plan = self._plan or self._fly()
        self._note()
        try:
            next(self._plan)
        except StopIteration:
            self.over = True

    # What is shown.

    def _fly(self) -> Waiting:
        """Show everything, in order."""
        yield from self._stand(SupervisorConfig().engaged_for_s + 1.0)
        up = yield from self._show(Command.TAKE_OFF, lambda: self._mode is not Mode.DISARMED)
        if up:
            up = yield from self._until(lambda: self._mode in _FLOWN and not self.pilot.helm.moving)
            yield from self._stand(_SETTLE_S)
        height = self._here()[2] if up else math.nan
        goal_m = self.pilot.config.goal.altitude_m
        self._find("take-off", height, "m", f"{goal_m:g} m +- {HEIGHT_M:g}", abs(height - goal_m) <= HEIGHT_M)
        if not up:
            return False
        yield from self._walk()
        for command in self.config.commands:
            yield from self._command(command)
        landed = yield from self._show(Command.LAND, lambda: self._mode is Mode.LANDING)
        landed &= yield from self._until(lambda: self.pilot.vehicle.mode is FlightMode.DISARMED)
        self.findings.append(Finding("land", str(self.pilot.vehicle.mode), "by gesture, disarmed", landed))
        return landed

    def _walk(self) -> Waiting:
        c, began = self.config, len(self._rows)
        self.stage.walk(c.speed_m_s, c.radius_m, c.walk_s)
        yield from self._stand(c.walk_s)
        rows = self._rows[began:]
        bearing = float(np.mean([abs(row.bearing_deg) for row in rows]))
        distance = float(np.mean([abs(row.off_m) for row in rows]))
        followed = float(np.mean([row.mode is Mode.FOLLOWING for row in rows]))
        what = f"{c.speed_m_s:g} m/s on an arc, {c.walk_s:g} s"
        good = bearing <= BEARING_DEG
        self._find(f"{what}: mean bearing", bearing, "degrees", f"{BEARING_DEG:g} degrees at most", good)
        good = distance <= DISTANCE_M
        self._find(f"{what}: mean distance error", distance, "m", f"{DISTANCE_M:g} m at most", good)
        self._find(f"{what}: followed", 100 * followed, "%", "100 %", followed == 1.0)
        yield from self._stand(_SETTLE_S)
        return True

    def _command(self, command: Command) -> Waiting:
        yield from self._stand(_SETTLE_S)
        before = self._here()
        heard = yield from self._show(command, lambda: self._mode is Mode.EXECUTING)
        if heard:
            right = self.pilot.helm.movement.command is command
            heard = yield from self._until(lambda: self._mode is not Mode.EXECUTING)
            heard &= right
            yield from self._stand(_SETTLE_S)
        share = missed(command, before, self._here(), self.pilot.config.movement) if heard else math.nan
        asked = f"{100 * COMMAND_SHARE:g} % at most"
        self._find(f"{command}: missed its end by", 100 * share, "%", asked, share <= COMMAND_SHARE)
        return heard

    def _show(self, command: Command, heard: Callable[[], bool]) -> Waiting:
        """Show a gesture until it is understood, and the arms are down again."""
        for _ in range(_TAKES):
            self._takes += 1
            until_s = self.stage.time_s + self.stage.show(command.value, self._takes)
            understood = yield from self._until(heard, until_s - self.stage.time_s + _PATIENCE_S)
            yield from self._stand(until_s - self.stage.time_s)
            if understood:
                return True
        return False

    def _stand(self, seconds: float) -> Waiting:
        return (yield from self._until(lambda: False, seconds))

    def _until(self, true: Callable[[], bool], seconds: float = _FLIGHT_PATIENCE_S) -> Waiting:
        """Wait for something; say whether it came in time."""
        until_s = self.stage.time_s + seconds
        while not true():
            if self.stage.time_s >= until_s:
                return False
            yield
        return True

    # What comes of it.

    @property
    def _mode(self) -> Mode:
        return self.pilot.supervisor.mode

    def _note(self) -> None:
        state, (x, y) = self.judged(), self.stage.place_m
        last = self._rows[-1].place[0] if self._rows else 0.0
        place = place_around(state.position_m, (float(x), float(y)), last)
        sight = math.atan2(y - state.position_m[1], x - state.position_m[0])
        bearing = (sight - state.heading_rad + math.pi) % (2 * math.pi) - math.pi
        off_m = place[1] - self.pilot.helm.movement.goal.distance_m
        self._rows.append(_Row(self.stage.time_s, place, math.degrees(bearing), off_m, self._mode))

    def _here(self) -> Place:
        """Return the place of the last second, on average."""
        rows = [row for row in self._rows if row.time_s > self.stage.time_s - _MEAN_S]
        angle, distance, height = np.mean([row.place for row in rows], axis=0)
        return float(angle), float(distance), float(height)

    def _find(self, what: str, value: float, unit: str, asked: str, good: bool) -> None:
        """Note what was found; a figure that never came to be is none."""
        if math.isnan(value):
            self.findings.append(Finding(what, "not flown", asked, False))
        else:
            self.findings.append(Finding(what, f"{value:.2f} {unit}", asked, good, value))


__all__ = ["Finding", "Mission", "MissionConfig"]
