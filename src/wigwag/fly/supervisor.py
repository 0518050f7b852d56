"""What stands between every wish and the propellers: a pure state machine over values and a clock.

The supervisor knows no recogniser, no camera and no vehicle. It is told what is known (``Situation``),
and answers what may be done (``Verdict``) and sent (``Permit``). It keeps no clock of its own. Its parts are
data: what is noticed (``watches``), what leads where (``transitions``), what commands pass (``gates``), what
set-points pass (``guards``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from wigwag.fly.gates import GATES, Gate, confirmed, refused
from wigwag.fly.guards import GUARDS, Guard, guarded
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Memory, Mode, Permit, Situation, Verdict, age_s, sound
from wigwag.fly.tighten import tightened
from wigwag.fly.transitions import MASKED_BY_STOP, TABLE, Event, Transition, arrange
from wigwag.fly.values import HOVER, Command, Setpoint
from wigwag.fly.watches import WATCHES, Watch, deaf, link_lost, person_lost, state_stale


@dataclass(frozen=True)
class Rules:
    """All that the supervisor goes by. Tests take single rules away and see that something breaks."""

    table: tuple[Transition, ...] = TABLE
    watches: Mapping[Event, Watch] = field(default_factory=lambda: WATCHES)
    gates: tuple[Gate, ...] = GATES
    guards: tuple[Guard, ...] = GUARDS

    @cached_property
    def rows(self) -> dict[Mode, tuple[Transition, ...]]:
        """The rows that lead away from each mode, the most urgent first."""
        return arrange(self.table)

    def without(self, name: str) -> Rules:
        """Return the same rules but for the row, event, gate or guard of this name."""
        return Rules(
            tuple(row for row in self.table if row.name != name),
            {event: watch for event, watch in self.watches.items() if watch.__name__ != name},
            tuple(gate for gate in self.gates if gate.name != name),
            tuple(guard for guard in self.guards if guard.__name__ != name),
        )


RULES = Rules()
"""The rules as they are flown."""

STEERED = frozenset({Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON})
"""Modes in which set-points are sent."""
FLYING = STEERED | {Mode.TAKING_OFF, Mode.LOST_LINK, Mode.LANDING, Mode.EMERGENCY}
"""Modes in which the drone is in the air and ours."""


class Supervisor:
    """Has the last word: limits, contingencies, confirmation; stop and land win from everywhere.

    Args:
        config: Limits.
        mode: Where it begins: on the ground, or taking over a vehicle that hovers already.
        rules: What it goes by.

    Example:
        >>> supervisor, s = Supervisor(), 10**9
        >>> seen = Situation(2 * s, Craft.DOWN, 2 * s, 2 * s, pose_ns=2 * s, distance_m=4.0, engaged_ns=0)
        >>> supervisor.step(replace(seen, command=Command.TAKE_OFF, held_s=0.5)).reason
        'take_off: show it again to confirm'
        >>> Supervisor().step(replace(seen, command=Command.TAKE_OFF, held_s=1.5)).action
        <Action.ARM: 'arm'>
    """

    def __init__(
        self,
        config: SupervisorConfig | None = None,
        mode: Mode = Mode.DISARMED,
        rules: Rules = RULES,
    ) -> None:
        self.config, self.rules = config or SupervisorConfig(), rules
        self.start = self.config
        """The limits that the flight began with; nothing loosens them beyond."""
        self.memory = Memory(mode)

    @property
    def mode(self) -> Mode:
        """What is being flown."""
        return self.memory.mode

    def step(self, situation: Situation) -> Verdict:
        """Decide once. Call it at the loop's rate, also when nothing was seen."""
        self.memory, verdict = decide(self.memory, situation, self.config, self.rules)
        return verdict

    def tighten(self, situation: Situation, name: str, value: float) -> str:
        """Set a limit anew if that is allowed (see ``wigwag.fly.tighten``); return why not, empty if it is.

        Args:
            situation: The newest.
            name: One of ``wigwag.fly.tighten.DIALS``.
            value: In the dial's unit.
        """
        self.config, why = tightened(self.config, self.start, situation, name, value)
        return why

    def permit(self, situation: Situation, wish: Setpoint) -> Permit:
        """Say what may be sent in the turn that has just been decided, if ``wish`` is what is wanted."""
        return permit(self.memory, situation, wish, self.config, self.rules)


def decide(
    memory: Memory, now: Situation, limits: SupervisorConfig, rules: Rules = RULES
) -> tuple[Memory, Verdict]:
    """Decide a turn: a function of its arguments and of nothing else.

    Args:
        memory: What the turn before left.
        now: What is known.
        limits: Limits.
        rules: What to go by.

    Returns:
        What to remember, and what is done.
    """
    now = sound(now)
    memory = _noticed(memory, now, limits)
    event, memory, reason = _heard(memory, now, limits, rules)
    row = _happened(memory, now, limits, rules, event)
    obeyed = row is not None and event is not None and row.event is event
    if event is not None and not obeyed and not reason:
        after = f"; {row.name}" if row is not None else ""
        reason = f"{now.command}: not while {memory.mode}{after}"
    mode = memory.mode if row is None else row.target
    verdict = Verdict(
        mode,
        Action.NONE if row is None else row.action,
        now.command if obeyed and event is not Event.LAND_ASKED else None,
        "" if row is None else row.name,
        reason,
    )
    return _remembered(memory, now, row, mode, obeyed), verdict


def permit(
    memory: Memory, now: Situation, wish: Setpoint, limits: SupervisorConfig, rules: Rules = RULES
) -> Permit:
    """Say what may be sent in the mode that was decided on: a function of its arguments and of nothing else.

    Args:
        memory: What ``decide`` returned for this turn.
        now: What is known.
        wish: What the follow law would like.
        limits: Limits.
        rules: What to go by.
    """
    mode, now = memory.mode, sound(now)
    if mode not in STEERED or now.craft is not Craft.AIRBORNE:
        return Permit(None)
    blind = person_lost(now, memory, limits) or state_stale(now, memory, limits)
    if mode is Mode.HOLDING and (blind or age_s(now.now_ns, memory.asked_ns) < limits.still_after_hold_s):
        # Once more to stand still, which is faster than a change of mode; then the vehicle holds by itself.
        return Permit(HOVER if memory.asked_ns == now.now_ns else None)
    if mode is Mode.LOST_PERSON or blind:
        wish = HOVER
    elif mode is Mode.HOLDING:
        wish = Setpoint((0.0, 0.0, 0.0), wish.yaw_rate_rad_s)
    return Permit(*guarded(rules.guards, wish, now, memory, limits))


def _noticed(memory: Memory, now: Situation, limits: SupervisorConfig) -> Memory:
    """Note what is all right at this moment, since the first turn at the earliest."""
    first = memory.now_ns is None
    if not first and memory.now_ns is not None and now.now_ns < memory.now_ns:
        memory = _moved_back(memory, memory.now_ns - now.now_ns)
    stamp = now.now_ns

    def kept(was_ns: int, fine: bool) -> int:
        return stamp if fine or first else was_ns

    return replace(
        memory,
        since_ns=stamp if first else memory.since_ns,
        person=now.person if first else memory.person,
        state_ok_ns=kept(memory.state_ok_ns, not state_stale(now, memory, limits)),
        link_ok_ns=kept(memory.link_ok_ns, not link_lost(now, memory, limits)),
        health_ok_ns=kept(memory.health_ok_ns, now.healthy),
        person_ok_ns=kept(memory.person_ok_ns, not person_lost(now, memory, limits)),
        camera_ok_ns=kept(memory.camera_ok_ns, age_s(stamp, now.camera_ns) <= limits.max_pose_age_s),
        hearing_ok_ns=kept(memory.hearing_ok_ns, not deaf(now, memory, limits)),
    )


def _moved_back(memory: Memory, by_ns: int) -> Memory:
    """Keep all ages as they were though the clock was set back."""

    def moved(stamp_ns: int | None) -> int | None:
        return None if stamp_ns is None else stamp_ns - by_ns

    return replace(
        memory,
        since_ns=memory.since_ns - by_ns,
        state_ok_ns=memory.state_ok_ns - by_ns,
        link_ok_ns=memory.link_ok_ns - by_ns,
        health_ok_ns=memory.health_ok_ns - by_ns,
        person_ok_ns=memory.person_ok_ns - by_ns,
        camera_ok_ns=memory.camera_ok_ns - by_ns,
        hearing_ok_ns=memory.hearing_ok_ns - by_ns,
        commanded_ns=moved(memory.commanded_ns),
        stopped_ns=moved(memory.stopped_ns),
        asked_ns=moved(memory.asked_ns),
    )


def _heard(
    memory: Memory, now: Situation, limits: SupervisorConfig, rules: Rules
) -> tuple[Event | None, Memory, str]:
    """Turn the command of the moment into an event, if it passes the gates and is confirmed."""
    command = now.command
    if command is None:
        return None, memory, ""
    if why := refused(rules.gates, now, memory, limits):
        return None, memory, f"{command}: {why}"
    if not confirmed(now, memory, limits):
        memory = replace(memory, pending=command, commanded_ns=now.now_ns)
        again = f"{command}: show it again to confirm"
        return (Event.LAND_ASKED if command is Command.LAND else None), memory, again
    event = {Command.STOP: Event.STOP, Command.LAND: Event.LAND, Command.TAKE_OFF: Event.TAKE_OFF}
    return event.get(command, Event.MOVE), memory, ""


def _happened(
    memory: Memory, now: Situation, limits: SupervisorConfig, rules: Rules, heard: Event | None
) -> Transition | None:
    """Return the first row whose event happens now."""
    relieved = age_s(now.now_ns, memory.stopped_ns) < limits.respite_s
    for row in rules.rows[memory.mode]:
        if row.event is heard:
            return row
        watch = rules.watches.get(row.event)
        if watch is None or (relieved and row.event in MASKED_BY_STOP):
            continue
        if watch(now, memory, limits):
            return row
    return None


def _remembered(memory: Memory, now: Situation, row: Transition | None, mode: Mode, obeyed: bool) -> Memory:
    """Write down what this turn changed."""
    stamp, before = now.now_ns, memory.mode
    changes: dict[str, Any] = {"now_ns": stamp, "mode": mode}
    if mode is not before:
        changes["since_ns"] = stamp
    if row is not None and row.action is not Action.NONE:
        changes["asked_ns"] = stamp
    if row is not None and row.event in (Event.STOP, Event.LAND_ASKED):
        changes["stopped_ns"] = stamp
    if row is not None and row.event is Event.MOVE:
        changes["since_ns"], changes["stopped_ns"] = stamp, None
    if obeyed and row is not None and row.event is not Event.LAND_ASKED:
        changes["commanded_ns"], changes["pending"] = stamp, None
    if mode not in (Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON):
        changes["person"] = now.person
    if before not in FLYING and mode in FLYING:
        for name in ("person_ok_ns", "camera_ok_ns", "hearing_ok_ns", "health_ok_ns"):
            changes[name] = stamp
    return replace(memory, **changes)
