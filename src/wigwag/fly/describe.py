"""The supervisor's rules in words: the tables of docs/safety.md, generated from what is flown.

Run ``python -m wigwag.fly.describe docs/safety.md`` after changing a rule or a limit; a test sees it.
"""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Any

from wigwag.errors import InputError
from wigwag.fly.fence import Cylinder
from wigwag.fly.gates import GATES
from wigwag.fly.guards import GUARDS
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.movements import MovementConfig
from wigwag.fly.situation import Action, Mode
from wigwag.fly.supervisor import STEERED
from wigwag.fly.transitions import TABLE, Event
from wigwag.fly.watches import WATCHES

_COMMANDS = {
    Event.STOP: "The operator says stop.",
    Event.LAND: "The operator says land, and it is confirmed.",
    Event.LAND_ASKED: "The operator says land, not long enough.",
    Event.TAKE_OFF: "The operator says take off, confirmed, and no gate refuses it.",
    Event.MOVE: "The operator gives a command, and no gate refuses it.",
}
_UNITS = {
    "_m_s2": "m/s²", "_m_s3": "m/s³", "_rad_s": "rad/s", "_1_s": "1/s", "_m_s": "m/s", "_rad": "rad",
    "_m": "m", "_s": "s",
}  # fmt: skip


def attributes(kind: type[Any]) -> dict[str, str]:
    """Return the sentences that stand below the attributes of a class, each on one line."""
    tree = ast.parse(inspect.getsource(kind))
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    said: dict[str, str] = {}
    name = ""
    for node in body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            name = node.target.id
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and name:
            said[name] = " ".join(str(node.value.value).split())
            name = ""
        else:
            name = ""
    return said


def modes() -> str:
    """Return the table of modes."""
    said = attributes(Mode)
    sent = {
        Mode.HOLDING: "turning; a retreat; for 2 s after being asked to hold, nothing",
        Mode.LOST_PERSON: "standing still; a retreat",
    }
    lines = ["| mode | what it is | set-points |", "|---|---|---|"]
    for mode in Mode:
        what = sent.get(mode, "the follow law's, guarded") if mode in STEERED else "none"
        lines.append(f"| {_words(mode)} | {said.get(mode.name, '')} | {what} |")
    return "\n".join(lines)


def transitions() -> str:
    """Return the table of transitions."""
    lines = [
        "| transition | when | from | to | the vehicle is asked to | why |",
        "|---|---|---|---|---|---|",
    ]
    limits = SupervisorConfig()
    for row in TABLE:
        when = _COMMANDS.get(row.event) or (WATCHES[row.event].__doc__ or "").strip()
        if row.after:
            when += f" ({getattr(limits, row.after):g} s: `{row.after}`)"
        asked = "" if row.action is Action.NONE else _words(row.action)
        sources = ", ".join(_words(mode) for mode in row.sources)
        lines.append(f"| **{row.name}** | {when} | {sources} | {_words(row.target)} | {asked} | {row.why} |")
    return "\n".join(lines)


def limits() -> str:
    """Return the table of limits and their defaults."""
    return _settings(SupervisorConfig())


def movements() -> str:
    """Return the table of the commands' sizes."""
    return _settings(MovementConfig())


def gates() -> str:
    """Return the table of what commands have to pass."""
    lines = ["| gate | refuses when | the operator is told | asked for |", "|---|---|---|---|"]
    for gate in GATES:
        what = "take-off, movements" if gate.flying else "take-off"
        lines.append(f"| {gate.name} | {(gate.refuses.__doc__ or '').strip()} | {gate.says} | {what} |")
    return "\n".join(lines)


def guards() -> str:
    """Return the table of what set-points have to pass."""
    lines = ["| guard | what it does |", "|---|---|"]
    lines += [f"| {_words(guard.__name__)} | {(guard.__doc__ or '').strip()} |" for guard in GUARDS]
    return "\n".join(lines)


PARTS: dict[str, Callable[[], str]] = {
    "modes": modes, "transitions": transitions, "limits": limits, "movements": movements, "gates": gates,
    "guards": guards,
}  # fmt: skip
"""What can be written between the markers ``<!-- NAME: begin -->`` and ``<!-- NAME: end -->``."""


def filled(text: str) -> str:
    """Return a page with every table written anew.

    Raises:
        InputError: If the page has no place for one of them.
    """
    for name, part in PARTS.items():
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        if begin not in text or end not in text:
            raise InputError(f"Expected the markers {begin} and {end}, but they are not in the page.")
        before, after = text[: text.index(begin)], text[text.index(end) :]
        text = f"{before}{begin}\n{part()}\n{after}"
    return text


def _settings(config: Any) -> str:
    said = attributes(type(config))
    lines = ["| setting | default | what it is |", "|---|---|---|"]
    for name in config.__dataclass_fields__:
        value = getattr(config, name)
        shown = f"cylinder, radius {value.radius_m:g} m" if isinstance(value, Cylinder) else f"{value:.4g}"
        unit = next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), "")
        lines.append(f"| `{name}` | {f'{shown} {unit}'.strip()} | {said.get(name, '')} |")
    return "\n".join(lines)


def _words(value: StrEnum | str) -> str:
    return str(value).replace("_", " ")


if __name__ == "__main__":
    page = Path(sys.argv[1])
    page.write_text(filled(page.read_text("utf-8")), encoding="utf-8")
