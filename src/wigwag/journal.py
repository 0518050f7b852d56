"""A flight written down as it happens: one line of JSON a turn, so that it can be flown again on paper."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from dataclasses import asdict, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from wigwag.errors import DataError, InputError
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Mode, Permit, Situation, Verdict
from wigwag.fly.supervisor import Supervisor
from wigwag.fly.tighten import with_setting
from wigwag.fly.values import Command, Setpoint
from wigwag.pilot import Step

VERSION = 1


class Journal:
    """Writes a flight, a line at a time.

    Each line goes to the operating system at once: a program that is killed leaves all turns it has flown.

    Args:
        path: The file; it must not exist yet.
        **facts: What the first line says besides the version: addresses, settings.

    Raises:
        InputError: If the file exists or cannot be written.
    """

    def __init__(self, path: Path, **facts: Any) -> None:
        self.path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
        except OSError as error:
            if path.exists():
                raise InputError(f"{path}: there is a file already. Name another, or move it away.") from None
            raise InputError(f"{path}: cannot be written ({error.strerror}).") from error
        self.failed = ""
        """Why nothing more is written, such as a full disk; empty: all is well."""
        self._write({"journal": VERSION, **facts})

    def turn(self, step: Step) -> None:
        """Write one turn of the loop. Never raises: a full disk must not end a flight (see ``failed``)."""
        pose = step.pose
        self._write(
            {
                "situation": step.situation, "verdict": step.verdict, "wish": step.wish,
                "permit": step.permit, "goal": step.goal, "state": step.state,
                "gesture": step.gesture, "command": step.command,
                "pose": None if pose is None else {
                    "stamp_ns": pose.stamp_ns, "joints": np.round(pose.joints, 4),
                    "visibility": np.round(pose.visibility, 3),
                },
            }
        )  # fmt: skip

    def note(self, **what: Any) -> None:
        """Write a line of its own, such as how the flight ended."""
        self._write({"note": what})

    def close(self) -> None:
        """Close the file. Closing twice does nothing."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _write(self, line: dict[str, Any]) -> None:
        if self.failed or self._file < 0:
            return
        try:
            text = json.dumps(_plain(line), separators=(",", ":"), allow_nan=False)
            os.write(self._file, text.encode() + b"\n")
        except OSError as error:
            self.failed = f"{self.path}: {error.strerror}"


def read_journal(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the lines of a journal. A last line that was cut short, as by a crash, is left out.

    Raises:
        DataError: If the file cannot be read, is no journal, or a line within it is damaged.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
    for number, line in enumerate(lines):
        if not line:
            continue
        try:
            read = json.loads(line)
        except ValueError as error:
            if number == len(lines) - 1:
                return
            raise DataError(f"{path}: line {number + 1} is damaged ({error}).") from error
        if number == 0 and (not isinstance(read, dict) or read.get("journal") != VERSION):
            raise DataError(f"{path}: expected a journal of version {VERSION}, but the first line is none.")
        yield read


def decide_again(
    path: Path, config: SupervisorConfig | None = None, mode: Mode = Mode.DISARMED
) -> Iterator[tuple[Verdict, Permit, Verdict, Permit]]:
    """Decide every turn of a journal anew.

    Args:
        path: The journal.
        config: Limits that the flight began with; other ones show what they would have changed. What was
            set anew in flight (a note of ``limit`` and ``value``) is set again.
        mode: The one in which the flight began.

    Yields:
        What was decided and sent then, and what is now.

    Raises:
        DataError: If the file is no whole journal.
    """
    supervisor = Supervisor(config, mode)
    for line in read_journal(path):
        try:
            if "limit" in line.get("note", ()):
                limit = line["note"]
                supervisor.config = with_setting(supervisor.config, limit["limit"], float(limit["value"]))
            if "situation" not in line:
                continue
            situation, wish = _situation(line["situation"]), _setpoint(line["wish"])
            then = _verdict(line["verdict"]), _permit(line["permit"])
        except (KeyError, TypeError, ValueError, InputError) as error:
            raise DataError(f"{path}: a turn does not hold what it should ({error}).") from error
        verdict = supervisor.step(situation)
        yield *then, verdict, supervisor.permit(situation, wish)


def _situation(read: dict[str, Any]) -> Situation:
    known = {field.name for field in fields(Situation)}
    values = {name: value for name, value in read.items() if name in known}
    values["craft"] = Craft(values["craft"])
    values["command"] = None if values["command"] is None else Command(values["command"])
    values["position_m"] = tuple(values["position_m"])
    values["held_s"] = math.inf if values["held_s"] is None else values["held_s"]
    return Situation(**values)


def _setpoint(read: dict[str, Any]) -> Setpoint:
    forward, left, up = (math.nan if v is None else v for v in read["velocity_m_s"])
    rate = read["yaw_rate_rad_s"]
    return Setpoint((forward, left, up), math.nan if rate is None else rate)


def _verdict(read: dict[str, Any]) -> Verdict:
    accepted = None if read["accepted"] is None else Command(read["accepted"])
    return Verdict(Mode(read["mode"]), Action(read["action"]), accepted, read["row"], read["reason"])


def _permit(read: dict[str, Any]) -> Permit:
    return Permit(None if read["setpoint"] is None else _setpoint(read["setpoint"]), read["changed"])


def _plain(value: Any) -> Any:
    """Turn values into what JSON knows; what is no finite number becomes null."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | int | bool):
        return value.value if isinstance(value, Enum) else value
    return str(value)


__all__ = ["Journal", "decide_again", "read_journal"]
