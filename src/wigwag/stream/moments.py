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
from wigwag.stream.ticks import RATE_HZ, Ticks
from wigwag.stream.track import LAGS, Tail

BINS_S = (-1.2, -0.7, -0.4, -0.2, -0.067, 0.067, 0.2, 0.35, 0.7)
"""A row between the first and the last of these seconds after an action point (below 0: before it) is taught
as that gesture and as the stretch that it lies in; any other as no gesture."""

BINS = len(BINS_S) - 1


@dataclass(frozen=True, slots=True)
class MomentConfig:
    """When a gesture is spoken, and which of them have no side.

    Raises:
        InputError: If a setting is out of range.
    """

    commands: tuple[str, ...] | None = None
    """Labels that may be spoken; others are known by name and kept silent. ``None``: all may be spoken."""
    either_side: tuple[str, ...] = ()
    """Labels that mean the same shown in a mirror, with the other hand or foot: they are taught both ways."""
    threshold: float = 0.55
    """A decision must be right with this probability: the action point within ``within_s``, the name too."""
    within_s: float = 0.333
    """So far from its action point, before or after, a decision counts as right."""
    ahead_s: float = 0.1
    """Nothing is spoken as long as a decision so much later would sooner be right."""
    again_s: float = 0.4
    """After a gesture none is spoken for this long, and it itself not before it has seemed to be over."""

    def __post_init__(self) -> None:
        """Check the settings."""
        if not 0 < self.threshold <= 1:
            raise InputError(f"MomentConfig.threshold must be within 0 and 1, but got {self.threshold}.")
        if not 1 / RATE_HZ <= self.within_s <= BINS_S[-1]:
            raise InputError(
                f"MomentConfig.within_s must be within {1 / RATE_HZ:.3f} and {BINS_S[-1]}, "
                f"but got {self.within_s}."
            )
        if not 0 < self.ahead_s <= self.within_s or not self.again_s >= 0:
            raise InputError(
                f"MomentConfig.ahead_s must be above 0 and at most within_s, {self.within_s}, and again_s "
                f"0 or more, but got {self.ahead_s} and {self.again_s}."
            )


@dataclass(frozen=True, slots=True)
class MomentModel:
    """What :func:`~wigwag.stream.teach_moments.teach_moments` has learned."""

    labels: tuple[str, ...]
    networks: tuple[Network, ...]
    """Their classes are the stretches of ``BINS_S`` of the first label, of the next, and so on, then 'none';
    their probabilities are averaged."""
    config: MomentConfig

    def stream(self) -> MomentStream:
        """Begin a stream."""
        return MomentStream(self)

    def probabilities(
        self, numbers: Float[np.ndarray, "rows features"]
    ) -> Float[np.ndarray, "rows labels stretches"]:
        """Return how likely each row lies in each stretch of ``BINS_S`` about a point of each label."""
        every = [network.probabilities(numbers)[:, :-1] for network in self.networks]
        return np.asarray(np.mean(every, axis=0)).reshape(len(numbers), len(self.labels), BINS)

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to one file of arrays and JSON."""
        config = self.config
        facts: dict[str, Any] = {
            "labels": list(self.labels),
            "networks": len(self.networks),
            "commands": config.commands,
            "threshold": config.threshold,
            "either_side": config.either_side,
            "within_s": config.within_s,
            "ahead_s": config.ahead_s,
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
                tuple(facts["either_side"]),
                float(facts["threshold"]),
                float(facts["within_s"]),
                float(facts["ahead_s"]),
                float(facts["again_s"]),
            )
            networks = [Network.restored(arrays, f"network{i}") for i in range(int(facts["networks"]))]
            return cls(tuple(facts["labels"]), tuple(networks), config)


class MomentStream:
    """Says each gesture at its action point.

    Every row of the stream is asked how long ago which action point was, or how long it still takes. A
    decision is right if its action point lies within ``within_s``. The label of which that is likeliest is
    spoken once it is likely enough and waiting no longer makes it likelier: once the points that ``ahead_s``
    more would lose outweigh those that it would gain. So one rule serves gestures whose moment is sharp and
    those of which each person means another moment.

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
        self._ticks, self._tail = Ticks(), Tail()
        within, ahead = self.config.within_s, self.config.ahead_s
        spans = [(-within, within), (-within - ahead, -within), (within - ahead, within)]
        self._spans = np.array([shares(low, high) for low, high in spans], dtype=np.float32).T
        self._asked = np.zeros((len(model.labels), BINS))
        self._begin()

    def _begin(self) -> None:
        self._tail.reset()
        self._restarts = self._ticks.restarts
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
        self._tail.update(self._ticks.window(row, row)[0])
        self._asked = self.model.probabilities(self._tail.look())[0]
        right, gained, lost = (self._asked @ self._spans).T
        now_ns = self._ticks.stamp_ns(row)
        label = int(right.argmax())
        if self._spoken is not None and right[self._spoken] < self.config.threshold / 2:
            self._spoken = None
        if right[label] < self.config.threshold or lost[label] < gained[label] or now_ns < self._silent_ns:
            return None
        if label == self._spoken or not self._may[label]:
            return None
        self._spoken = label
        self._silent_ns = now_ns + round(self.config.again_s * 1e9)
        return Gesture(
            self.model.labels[label],
            min(float(right[label]), 1.0),
            max(now_ns - round(LAGS[-1] / RATE_HZ * 1e9), self._ticks.began_ns),
            now_ns,
            now_ns,
            f"its action point lies within {self.config.within_s:.2f} s with probability {right[label]:.2f}",
        )


def shares(low_s: float, high_s: float) -> Float[np.ndarray, " stretches"]:
    """Return which share of each stretch of ``BINS_S`` lies between two moments.

    Example:
        >>> shares(-0.4, 0.275).round(2).tolist()
        [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0]
    """
    first, last = np.array(BINS_S[:-1]), np.array(BINS_S[1:])
    inside = np.minimum(last, high_s) - np.maximum(first, low_s)
    return np.asarray(np.maximum(inside, 0.0) / (last - first))


__all__ = ["BINS", "BINS_S", "MomentConfig", "MomentModel", "MomentStream", "shares"]
