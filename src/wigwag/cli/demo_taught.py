"""``wigwag demo --model``: the demo's world, flown by what somebody has taught."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.sim.script import ScriptConfig

EDGES = (Command.TAKE_OFF.value, Command.LAND.value)
"""What every session begins and ends with."""


def mapping_of(pairs: Sequence[str]) -> dict[str, Command]:
    """Return which label commands what: the commands' own names, and what is asked for beside.

    Args:
        pairs: Such as ``"goalpost=orbit"``.

    Raises:
        InputError: If a pair is none, or there is no such command.

    Example:
        >>> mapping_of(["goalpost=orbit"])["goalpost"].value
        'orbit'
    """
    from wigwag.cli.fly import Fly

    own = {command.value: command for command in Command}
    return own | (Fly(commands=tuple(pairs)).mapping() if pairs else {})


def session_of(
    gestures: Sequence[str], commands: dict[str, Command], known: Sequence[str], model: Path, rounds: int
) -> ScriptConfig:
    """Return what the simulated operator shows: taking off, these gestures, others that are none, landing.

    Args:
        gestures: What is shown; none named: the demo's ten commands and all that ``commands`` adds.
        commands: Which label commands what.
        known: What the model may answer with.
        model: Its file, for messages.
        rounds: How often everything is shown.

    Raises:
        InputError: If a gesture is not known to the model, commands nothing, or cannot be shown.
    """
    if rounds < 1:
        raise InputError(f"--rounds must be 1 or more, but got {rounds}.")
    named = list(dict.fromkeys(gestures or commands))
    shown = tuple(dict.fromkeys([EDGES[0], *(g for g in named if g not in EDGES), EDGES[1]]))
    if unknown := [name for name in shown if name not in known]:
        raise InputError(
            f"{model}: does not know {', '.join(unknown)}. It knows: {', '.join(sorted(known))}. Teach it: "
            f"wigwag teach --gesture {unknown[0]} --model {model}"
        )
    if silent := [name for name in shown if name not in commands]:
        raise InputError(f"{silent[0]} commands nothing. Say what it commands: --commands {silent[0]}=orbit")
    default = ScriptConfig()
    others = tuple(name for name in default.others if name not in commands)
    config = ScriptConfig(commands=shown, others=others, n_others=3 * rounds, repetitions=rounds)
    return replace(config, engage=True)


__all__ = ["mapping_of", "session_of"]
