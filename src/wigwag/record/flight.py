"""A recorded flight, read back: whole, still being written, or cut short by a kill."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from wigwag.camera.frame import Frame
from wigwag.errors import DataError
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command, VehicleState
from wigwag.gesture import Gesture
from wigwag.pilot import PilotConfig
from wigwag.pose.estimator import PoseConfig
from wigwag.record import foxglove
from wigwag.record.codec import revived
from wigwag.record.container import library
from wigwag.record.repair import Found, members, scan, unpacked
from wigwag.record.turns import (
    DEPTH,
    GESTURE,
    IMAGE,
    MODEL,
    POSE,
    SETPOINT,
    STATE,
    TURN,
    VERSION,
    Recorded,
    Told,
    Turn,
)  # fmt: skip
from wigwag.skeleton import Pose

_Messages = dict[str, bytes]
"""What there is of one turn, by topic."""


@dataclass(frozen=True)
class Flight:
    """A recorded flight. Reading needs no index, so one that was cut short reads as far as it goes.

    Example: ``[turn.gesture for turn in Flight.open("flight.mcap").turns() if turn.gesture]``.
    """

    path: Path
    facts: Mapping[str, str]
    """All that was written at the beginning."""
    model: bytes | None
    """What was taught, as its file's bytes."""
    topics: Mapping[int, str]

    @classmethod
    def open(cls, path: str | Path) -> Flight:
        """Read a flight's beginning.

        Raises:
            DataError: If the file cannot be read, is no MCAP file, or no flight of wigwag's.
            MissingExtraError: If the extra ``record`` is not installed.
        """
        path, lib = Path(path), library()
        facts: dict[str, str] | None = None
        model, topics = None, {}
        for found in scan(path):
            if found.opcode == lib.opcodes.METADATA:
                table = found.read("Metadata")
                facts = table.metadata if table.name == "wigwag" else facts
            elif found.opcode == lib.opcodes.ATTACHMENT:
                attached = found.read("Attachment")
                model = attached.data if attached.name == MODEL else model
            elif found.opcode == lib.opcodes.CHANNEL:
                channel = found.read("Channel")
                topics[channel.id] = channel.topic
            elif found.opcode == lib.opcodes.CHUNK:
                break
        if facts is None or TURN not in topics.values():
            raise DataError(f"{path}: is no flight that wigwag recorded: it holds no {TURN}.")
        if not facts["version"].isdigit() or int(facts["version"]) > VERSION:
            raise DataError(
                f"{path}: was written in version {facts['version']}, but this wigwag reads up to {VERSION}. "
                "Install a newer wigwag."
            )
        return cls(path, facts, model, topics)

    @property
    def config(self) -> PilotConfig:
        """How it was flown."""
        return self._fact("config", PilotConfig)  # type: ignore[no-any-return]

    @property
    def commands(self) -> dict[str, Command]:
        """Which label commanded what."""
        return self._fact("commands", dict[str, Command])  # type: ignore[no-any-return]

    @property
    def mode(self) -> Mode:
        """The supervisor's mode in which it began."""
        return Mode(self.facts["mode"])

    @property
    def pose_config(self) -> PoseConfig | None:
        """How poses were found; ``None``: by something else than wigwag's estimator."""
        return self._fact("pose_config", PoseConfig | None)  # type: ignore[no-any-return]

    @property
    def tells_operator(self) -> bool:
        """Whether the pose source knew who commanded."""
        return bool(json.loads(self.facts["tells_operator"]))

    def _fact(self, name: str, kind: Any) -> Any:
        try:
            return revived(kind, json.loads(self.facts[name]))
        except (KeyError, ValueError) as error:
            raise DataError(f"{self.path}: what it says of its {name} is damaged ({error}).") from error

    def turns(self) -> Iterator[Recorded]:
        """Yield every turn that is there whole.

        Raises:
            DataError: If something within the file is damaged. A last chunk cut short is left out.
        """
        for number, messages in self._messages():
            yield self._recorded(number, messages)

    def frames(self) -> Iterator[tuple[Recorded, Frame | None]]:
        """Yield every turn with its frame; ``None``: there was none, or its picture was left out.

        Raises:
            DataError: As for :meth:`turns`.
        """
        for number, messages in self._messages():
            recorded = self._recorded(number, messages)
            yield recorded, _frame(recorded, messages)

    def _messages(self) -> Iterator[tuple[int, _Messages]]:
        """Yield the messages of each turn. All of one stand in one chunk, the turn itself last."""
        lib = library()
        gathered: _Messages = {}
        before: Found | None = None
        for found in scan(self.path):
            if found.opcode != lib.opcodes.CHUNK:
                continue
            if before is not None:
                yield from self._of(before, gathered)
            before = found
        if before is not None:
            try:
                last = list(self._of(before, gathered))
            except DataError:  # whole in length, but not in content: the machine itself went down
                return
            yield from last

    def _of(self, chunk: Found, gathered: _Messages) -> Iterator[tuple[int, _Messages]]:
        message = library().opcodes.MESSAGE
        gathered.clear()
        for opcode, _, content in members(unpacked(chunk)):
            if opcode != message:
                continue
            topic = self.topics.get(int.from_bytes(content[:2], "little"), "")
            gathered[topic] = content[22:]
            if topic == TURN:
                yield int.from_bytes(content[2:6], "little"), dict(gathered)
                gathered.clear()

    def _recorded(self, number: int, messages: _Messages) -> Recorded:
        def read(topic: str, kind: Any) -> Any:
            return revived(kind, json.loads(messages[topic])) if topic in messages else None

        try:
            return Recorded(
                number, read(TURN, Turn), read(POSE, Pose), read(STATE, VehicleState),
                read(SETPOINT, Told), read(GESTURE, Gesture),
            )  # fmt: skip
        except ValueError as error:
            raise DataError(f"{self.path}: turn {number} is damaged ({error}).") from error


def _frame(recorded: Recorded, messages: _Messages) -> Frame | None:
    look = recorded.turn.look
    if look is None or IMAGE not in messages:
        return None
    image = foxglove.message("CompressedImage").FromString(messages[IMAGE])
    bgr = cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR)
    if bgr is None:
        raise DataError(f"turn {recorded.number}: its picture is damaged.")
    depth = None
    if DEPTH in messages:
        raw = foxglove.message("RawImage").FromString(messages[DEPTH])
        depth = np.frombuffer(raw.data, "<u2").reshape(raw.height, raw.width).astype(np.uint16)
    return Frame(np.ascontiguousarray(bgr[:, :, ::-1]), depth, look.intrinsics, look.stamp_ns)


__all__ = ["Flight"]
