"""A flight is written down beside the loop that flies it."""

from __future__ import annotations

import json
import math
import queue
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from wigwag import __version__
from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.fly.tighten import changed
from wigwag.pilot import Engaging, Pilot, Step
from wigwag.record import foxglove
from wigwag.record.codec import plain, schema, text
from wigwag.record.container import Container
from wigwag.record.turns import (
    ANNOTATIONS,
    CALIBRATION,
    CLOUD,
    DEPTH,
    FOXGLOVE_CHANNELS,
    GESTURE,
    IMAGE,
    JSON_CHANNELS,
    LOG,
    MODEL,
    NOTE,
    POSE,
    SETPOINT,
    SKELETON,
    STATE,
    TRANSFORMS,
    TRANSITION,
    TURN,
    VERSION,
    Look,
    Pictures,
    Told,
    Turn,
)  # fmt: skip

_CHUNK_NS = 400_000_000
"""A chunk holds this much of a flight at most: what a kill takes away."""
_CHUNK_BYTES = 8_000_000
_WAITING = 9
"""Turns that may wait to be written, 0.3 s of them; then pictures are left out, or the loop waits."""
_BITS_A_PIXEL = 0.5
"""JPEG's size that the quality is kept to: 19 kB at 640x480, 346 MB in ten minutes at 30 Hz."""
_QUALITIES = (25, 85)

_Item = tuple[int, Frame | None, Turn, Step]


class Recorder:
    """Writes a flight to an MCAP file as it happens. The loop only hands over; a thread does the rest.

    The file is well-formed at every moment (:class:`~wigwag.record.container.Container`): a program that is
    killed leaves all but the last second at most.

    Args:
        path: The file; it must not exist yet.
        pilot: What flies. It must not have flown yet: its settings go into the file, to decide anew by.
        pictures: What is kept of the colour pictures.
        depth: Whether depth is kept.
        model: What was taught, as its file's bytes; goes along, so that the flight explains itself.
        facts: What else is known of the flight: addresses, seeds.
        patient: Let the loop wait for a slow disk, rather than leave pictures out. For worlds whose time
            waits too.

    Raises:
        InputError: If the file exists or cannot be written.
        MissingExtraError: If the extra ``record`` is not installed.
    """

    def __init__(
        self,
        path: Path,
        pilot: Pilot,
        *,
        pictures: Pictures = "jpeg",
        depth: bool = False,
        model: bytes | None = None,
        facts: Mapping[str, str] | None = None,
        patient: bool = False,
    ) -> None:
        self.path, self.pilot, self.pictures, self.depth = path, pilot, pictures, depth
        self.failed = ""
        """Why nothing more is written, such as a full disk; empty: all is well."""
        self.left_out = 0
        """Pictures that were left out because the disk, or the other core, did not keep up."""
        self._file = Container(path)
        self._begin(pilot, model, dict(facts or {}))
        self._limits, self._calls = pilot.supervisor.config, pilot.calls
        self._mount = pilot.config.mount
        self._waits: queue.Queue[_Item | None] = queue.Queue(_WAITING if patient else 0)
        self._patient = patient
        self._number, self._quality = 0, 50
        self._chunk_ns: int | None = None
        self._lens: Intrinsics | None = None
        self._shown = False
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    def turn(self, frame: Frame | None, now_ns: int, step: Step) -> None:
        """Hand over one turn of the loop. Never raises: what fails is told by ``failed``.

        Args:
            frame: What the pilot was given; kept until it is written, so its arrays must not change.
            now_ns: What the pilot was given.
            step: What it answered.
        """
        if self.failed or not self._thread.is_alive():
            return
        if not self._patient and self._waits.qsize() >= _WAITING and frame is not None:
            self.left_out += 1
            written = None
        else:
            written = frame
        look = None
        if frame is not None:
            look = Look(frame.stamp_ns, frame.intrinsics, step.situation.camera_ns == now_ns)
        operator = self.pilot.pose.operator if isinstance(self.pilot.pose, Engaging) else None
        asked = step.situation.command if math.isinf(step.situation.held_s) else None
        limits, calls = self.pilot.supervisor.config, self.pilot.calls
        turn = Turn(
            now_ns, look, None if operator is None else operator.number, asked, step.command, step.situation,
            step.verdict, step.goal, step.pose_s, step.rest_s, changed(self._limits, limits),
            calls != self._calls,
        )  # fmt: skip
        self._limits, self._calls = limits, calls
        self._waits.put((self._number, written, turn, step))
        self._number += 1

    def close(self, **note: Any) -> None:
        """Write what is pending, a note of how it ended if there is one, and finish the file."""
        if self._thread.is_alive():
            self._waits.put(None)
            self._thread.join()
        try:
            if note and not self.failed:
                at_ns = self._chunk_ns or 0
                self._file.message(self._channels[NOTE], at_ns, at_ns, self._number, text(note))
            self._file.close()
        except OSError as error:
            self.failed = self.failed or f"{self.path}: {error.strerror}"

    def _begin(self, pilot: Pilot, model: bytes | None, facts: dict[str, str]) -> None:
        from wigwag.pose.estimator import PoseEstimator

        pose = pilot.pose.config if isinstance(pilot.pose, PoseEstimator) else None
        own = {
            "version": str(VERSION),
            "wigwag": __version__,
            "mode": pilot.supervisor.mode.value,
            "tells_operator": json.dumps(isinstance(pilot.pose, Engaging)),
            "config": json.dumps(plain(pilot.config)),
            "commands": json.dumps(plain(dict(pilot.commands))),
            "pose_config": json.dumps(plain(pose)),
            "pictures": self.pictures,
            "depth": json.dumps(self.depth),
        }
        try:
            self._file.metadata("wigwag", facts | own)
            if model is not None:
                self._file.attach(MODEL, "application/octet-stream", model)
            self._channels = {
                topic: self._file.channel(topic, "protobuf", foxglove.protobuf_schema(name))
                for topic, name in FOXGLOVE_CHANNELS.items()
            }
            for topic, kind in JSON_CHANNELS.items():
                described = (f"wigwag.{kind.__name__}", "jsonschema", json.dumps(schema(kind)).encode())
                self._channels[topic] = self._file.channel(topic, "json", described)
            note = ("wigwag.Note", "jsonschema", b'{"type":"object","properties":{}}')
            self._channels[NOTE] = self._file.channel(NOTE, "json", note)
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written ({error.strerror}).") from error

    # -- on the thread ------------------------------------------------------------------------------------

    def _work(self) -> None:
        while (item := self._waits.get()) is not None:
            if self.failed:
                continue
            try:
                self._write(*item)
            except OSError as error:
                self.failed = f"{self.path}: {error.strerror}"
            except Exception as error:  # whatever it is, it must not end the flight
                self.failed = f"{self.path}: {error}"

    def _write(self, number: int, frame: Frame | None, turn: Turn, step: Step) -> None:
        now_ns = turn.situation.now_ns
        if self._chunk_ns is None or self._is_full(now_ns):
            self._file.flush()
            self._chunk_ns = now_ns

        def put(topic: str, data: bytes, stamp_ns: int = now_ns) -> None:
            self._file.message(self._channels[topic], now_ns, stamp_ns, number, data)

        if frame is not None:
            for topic, data in self._seen(frame):
                put(topic, data, frame.stamp_ns)
        for topic, data in self._told(step, now_ns):
            put(topic, data)
        if step.pose is not None:
            put(POSE, text(step.pose), step.pose.stamp_ns)
        if step.gesture is not None:
            put(GESTURE, text(step.gesture))
        put(STATE, text(step.state), step.state.stamp_ns)
        put(SETPOINT, text(Told(step.wish, step.permit.setpoint, step.permit.changed)))
        put(TURN, text(turn))

    def _is_full(self, now_ns: int) -> bool:
        assert self._chunk_ns is not None
        return abs(now_ns - self._chunk_ns) >= _CHUNK_NS or self._file.pending > _CHUNK_BYTES

    def _seen(self, frame: Frame) -> list[tuple[str, bytes]]:
        """Return what the camera saw, as messages."""
        made = []
        if frame.intrinsics != self._lens:
            self._lens = frame.intrinsics
            made.append((CALIBRATION, foxglove.calibration(frame.stamp_ns, frame.intrinsics)))
        if self.pictures != "none":
            data = self._png(frame) if self.pictures == "png" else self._jpeg(frame)
            made.append((IMAGE, foxglove.compressed_image(frame.stamp_ns, data, self.pictures)))
        if self.depth and frame.depth_mm is not None:
            made.append((DEPTH, foxglove.depth_image(frame)))
        return made

    def _told(self, step: Step, now_ns: int) -> list[tuple[str, bytes]]:
        """Return what else there is to look at, as messages."""
        made = [(TRANSFORMS, foxglove.transforms(step.state, self._mount, now_ns))]
        if step.pose is not None or self._shown:
            made.append((SKELETON, foxglove.skeleton(step.pose, now_ns)))
            made.append((CLOUD, foxglove.cloud(step.pose, now_ns)))
            if self._lens is not None:
                made.append((ANNOTATIONS, foxglove.overlay(step.pose, self._lens, now_ns)))
        self._shown = step.pose is not None
        gesture, verdict = step.gesture, step.verdict
        if gesture is not None:
            what = f"gesture {gesture.label or 'none'} ({gesture.confidence:.2f}): {gesture.reason}"
            made.append((LOG, foxglove.log(now_ns, what)))
        if verdict.row or verdict.reason:
            made.append((TRANSITION, text(verdict)))
            row = f"{verdict.row}: {verdict.mode}" if verdict.row else ""
            what = "; ".join(part for part in (row, verdict.reason) if part)
            made.append((LOG, foxglove.log(now_ns, what, alarming=bool(verdict.reason))))
        return made

    def _jpeg(self, frame: Frame) -> bytes:
        """Encode at the quality that keeps to the size: a noisy scene must not fill the disk."""
        _, data = cv2.imencode(".jpg", frame.rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, self._quality])
        share = 8 * data.size / (_BITS_A_PIXEL * frame.rgb.shape[0] * frame.rgb.shape[1])
        step = -6 if share > 1.3 else -1 if share > 1.0 else 1 if share < 0.9 else 0
        self._quality = int(np.clip(self._quality + step, *_QUALITIES))
        return bytes(data.tobytes())

    @staticmethod
    def _png(frame: Frame) -> bytes:
        _, data = cv2.imencode(".png", frame.rgb[:, :, ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 1])
        return bytes(data.tobytes())


__all__ = ["Recorder"]
