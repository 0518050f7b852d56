"""What a command has to pass before it is obeyed: one small function a reason to refuse it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Memory, Situation, age_s
from wigwag.fly.values import Command
from wigwag.fly.watches import deaf, link_lost, person_far, person_lost, state_stale

Check = Callable[[Situation, Memory, SupervisorConfig], bool]


@dataclass(frozen=True, slots=True)
class Gate:
    """One reason to refuse."""

    name: str
    refuses: Check
    says: str
    """What the operator is told."""
    flying: bool = True
    """Whether movements have to pass it; a take-off has to pass all."""


URGENT = (Command.STOP, Command.LAND)
"""Commands that pass no gate: they win from everywhere."""


def too_soon(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Another command was heard just before."""
    return age_s(now.now_ns, memory.commanded_ns) < limits.command_period_s


def not_rested(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The body has not been at rest since the command before, as far as anybody can tell."""
    if now.rested_ns is None or memory.commanded_ns is None:
        return False
    return now.rested_ns < memory.commanded_ns


def not_engaged(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Nobody is the operator, or has been for long enough."""
    return now.engaged_ns is None or age_s(now.now_ns, now.engaged_ns) < limits.engaged_for_s


def too_near(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The operator stands too near to take off in front of."""
    return now.distance_m is not None and now.distance_m < limits.min_distance_m


def little_charge(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The battery is low already on the ground."""
    return now.battery is not None and now.battery < limits.battery_low


def not_healthy(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle's own checks complain."""
    return not now.healthy


def outside(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle stands outside the fence."""
    east, north, _ = now.position_m
    return min(wall.distance_m for wall in limits.fence.walls(east, north)) < 0


def withheld(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Somebody at the console keeps it where it is."""
    return now.withheld


GATES: tuple[Gate, ...] = (
    Gate("console", withheld, "held at the console, until somebody there presses engage"),
    Gate("rate", too_soon, "another command was given just before"),
    Gate("rest", not_rested, "lower your arms between two commands"),
    Gate("engaged", not_engaged, "nobody has been the operator for long enough"),
    Gate("in view", person_lost, "the operator is not seen"),
    Gate("in reach", person_far, "the operator is too far away"),
    Gate("state", state_stale, "the vehicle's state is old"),
    Gate("link", link_lost, "the vehicle is out of touch"),
    Gate("hearing", deaf, "the recogniser fails, so stop might not be heard", flying=False),
    Gate("clear", too_near, "the operator stands too near", flying=False),
    Gate("charge", little_charge, "the battery is low", flying=False),
    Gate("health", not_healthy, "the vehicle's own checks complain", flying=False),
    Gate("fence", outside, "the vehicle stands outside the fence", flying=False),
)
"""Every gate, in the order in which they are asked."""


def refused(gates: tuple[Gate, ...], now: Situation, memory: Memory, limits: SupervisorConfig) -> str:
    """Return why the command of the moment is refused; empty if it is not."""
    if now.command is None or now.command in URGENT:
        return ""
    for gate in gates:
        if (gate.flying or now.command is Command.TAKE_OFF) and gate.refuses(now, memory, limits):
            return gate.says
    return ""


def confirmed(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Say whether the command of the moment needs no confirmation, or has it.

    Taking off and landing were shown for long enough, or were shown a moment ago already.
    """
    held_s = {Command.TAKE_OFF: limits.take_off_held_s, Command.LAND: limits.land_held_s}
    if now.command not in held_s or now.held_s >= held_s[now.command]:
        return True
    return memory.pending is now.command and age_s(now.now_ns, memory.commanded_ns) <= limits.confirm_within_s
