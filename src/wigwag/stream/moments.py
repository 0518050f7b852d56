"""Gestures that are to be recognised at one moment, their action point: ``MomentStream``."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.gesture import Gesture
from wigwag.recognise import store
from wigwag.skeleton import Pose
from wigwag.stream.network import Network
from wigwag.stream.posture import Postures
from wigwag.stream.ticks import RATE_HZ, Ticks
from wigwag.stream.track import LAGS, REACH, Track

NEAR_S = (-0.10, 0.30)
"""A row is taught as a gesture from so long before its action point until so long after it."""


@dataclass(frozen=True, slots=True)
class MomentConfig:
    """When a gesture is spoken.

    Raises:
        InputError: If a setting is out of range.
    """

    commands: tuple[str, ...] | None = None
    """Labels that may be spoken; others are known by name and kept silent. ``None``: all may be spoken."""
    threshold: float = 0.55
    """Of an action point, so much must be expected to lie in the last ``window_s``: that is the sum of the
    probabilities of its rows, over how many rows each action point was taught by."""
    window_s: float = 0.57
    again_s: float = 0.9
    """After a gesture none is spoken for this long, and it itself not before less than half of what it was
    spoken for is expected."""

    def __post_init__(self) -> None:
        """Check the settings."""
        if not 0 < self.threshold <= 1:
            raise InputError(f"MomentConfig.threshold must be within 0 and 1, but got {self.threshold}.")
        if not 1 / RATE_HZ <= self.window_s <= REACH / RATE_HZ or not self.again_s >= 0:
            raise InputError(
                f"MomentConfig.window_s must be within {1 / RATE_HZ:.3f} and {REACH / RATE_HZ:.2f} and "
                f"again_s 0 or more, but got {self.window_s} and {self.again_s}."
            )


@dataclass(frozen=True, slots=True)
class MomentModel:
    """What :func:`~wigwag.stream.teach_moments.teach_moments` has learned."""

    labels: tuple[str, ...]
    networks: tuple[Network, ...]
    """Their classes are the labels, then 'none'; their probabilities are averaged."""
    config: MomentConfig

    def stream(self) -> MomentStream:
        """Begin a stream."""
        return MomentStream(self)

    def probabilities(self, numbers: Float[np.ndarray, "rows features"]) -> Float[np.ndarray, "rows labels"]:
        """Return how likely each row lies at an action point of each label."""
        every = [network.probabilities(numbers)[:, :-1] for network in self.networks]
        return np.asarray(np.mean(every, axis=0))

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to one file of arrays and JSON."""
        config = self.config
        facts: dict[str, Any] = {
            "labels": list(self.labels),
            "networks": len(self.networks),
            "commands": config.commands,
            "threshold": config.threshold,
            "window_s": config.window_s,
            "again_s": config.again_s,
        }
        arrays: dict[str, np.ndarray] = {}
        for number, network in enumerate(self.networks):
            arrays |= network.arrays(f"network{number}")
        store.write(path, "MomentModel", facts, arrays)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> MomentModel:
        """Read a model that ``save`` wrote.

        Raises:
            ModelError: If the file is missing, damaged, of another version, or holds something else.
        """
        facts, arrays = store.read(path, cls.__name__)
        with store.explained(path):
            commands = facts["commands"]
            config = MomentConfig(
                None if commands is None else tuple(commands),
                float(facts["threshold"]),
                float(facts["window_s"]),
                float(facts["again_s"]),
            )
            networks = [Network.restored(arrays, f"network{i}") for i in range(int(facts["networks"]))]
            return cls(tuple(facts["labels"]), tuple(networks), config)


class MomentStream:
    """Says each gesture at its action point.

    Every row of the stream is asked how likely it lies at an action point. What is spoken is the label of
    which at least half a one is expected in the last half second: where the moment is unsure, that is its
    median.

    Args:
        model: What was taught.
        config: When to speak; ``None``: as it was taught.

    Example: see :func:`~wigwag.stream.teach_moments.teach_moments`.
    """

    def __init__(self, model: MomentModel, config: MomentConfig | None = None) -> None:
        self.model = model
        self.config = config or model.config
        may = [self.config.commands is None or label in self.config.commands for label in model.labels]
        self._may = np.array(may)
        self._ticks, self._postures = Ticks(), Postures()
        self._last = np.zeros((round(self.config.window_s * RATE_HZ), len(model.labels)))
        self._joints = np.zeros((REACH, 13, 3), dtype=np.float32)
        self._begin()

    def _begin(self) -> None:
        self._postures.reset()
        self._restarts = self._ticks.restarts
        self._rows = 0
        self._last[:] = 0
        self._silent_ns = -(1 << 62)
        self._spoken: int | None = None

    def reset(self) -> None:
        """Forget the stream, as when another person takes over."""
        self._ticks.reset()
        self._begin()

    def update(self, pose: Pose | None) -> Gesture | None:
        """Take in the newest pose and return a gesture when one has been decided."""
        if pose is None:
            return None
        new = self._ticks.update(pose)
        if self._ticks.restarts != self._restarts:
            self._begin()
        said = None
        for row in range(self._ticks.count - new, self._ticks.count):
            said = self._hear(row) or said
        return said

    def _hear(self, row: int) -> Gesture | None:
        placed, hips = self._postures.update(self._ticks.window(row, row)[0])
        self._joints[:-1] = self._joints[1:]
        self._joints[-1] = placed
        self._rows = min(self._rows + 1, REACH)
        first = np.full(REACH, REACH - self._rows)
        track = Track(self._joints, np.broadcast_to(hips.astype(np.float32), (REACH, 3)), first, first)
        self._last[:-1] = self._last[1:]
        self._last[-1] = self.model.probabilities(track.looks(np.array([REACH - 1])))[0]
        now_ns = self._ticks.stamp_ns(row)
        expected = self._last.sum(axis=0) / rows_near()
        label = int(expected.argmax())
        if self._spoken is not None and expected[self._spoken] < self.config.threshold / 2:
            self._spoken = None
        if expected[label] < self.config.threshold or now_ns < self._silent_ns:
            return None
        if label == self._spoken or not self._may[label]:
            return None
        self._spoken = label
        self._silent_ns = now_ns + round(self.config.again_s * 1e9)
        return Gesture(
            self.model.labels[label],
            min(float(expected[label]), 1.0),
            max(now_ns - round(LAGS[-1] / RATE_HZ * 1e9), self._ticks.began_ns),
            now_ns,
            now_ns,
            f"{expected[label]:.2f} of an action point expected in the last {self.config.window_s:.2f} s",
        )


def rows_near() -> int:
    """Return how many rows each action point is taught by."""
    return round((NEAR_S[1] - NEAR_S[0]) * RATE_HZ)


__all__ = ["NEAR_S", "MomentConfig", "MomentModel", "MomentStream", "rows_near"]
