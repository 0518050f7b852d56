"""A movement seen from several sides: sequences of vectors that each bring out another of its traits."""

from __future__ import annotations

from itertools import combinations
from typing import Literal

import numpy as np
from jaxtyping import Float
from numba import njit

from wigwag.features.canonical import Canonical
from wigwag.skeleton import N_LANDMARKS

View = Literal[
    "positions", "velocities", "directions", "accelerations", "bones", "distances", "hands", "trunk"
]  # fmt: skip
"""Names of the views; see :func:`views`."""

VIEWS: tuple[View, ...] = (
    "positions", "velocities", "directions", "accelerations", "bones", "distances", "hands", "trunk",
)  # fmt: skip

_BONES = np.array(
    [(1, 3), (3, 5), (2, 4), (4, 6), (7, 9), (9, 11), (8, 10), (10, 12), (2, 1)], dtype=np.int64
)
_PAIRS = np.array(list(combinations(range(N_LANDMARKS), 2)), dtype=np.int64)
_USUAL_S = 2.5
"""Speeds in real time are per this many seconds, so that they are of the size of speeds per movement."""


def views(movement: Canonical) -> dict[View, Float[np.ndarray, "frames features"]]:
    """Return every view of a movement, float32.

    - ``positions`` (39): where the 13 landmarks are.
    - ``velocities`` (39): how they move in real time.
    - ``directions`` (39): where they move per share of the whole movement, compressed by the square root of
      their speed, so that a slow landmark counts beside a fast one.
    - ``accelerations`` (39): per share of the movement.
    - ``bones`` (30): how limbs and trunk turn in real time, whatever their lengths.
    - ``distances`` (78): how the landmarks' distances from each other change in real time, whichever way
      the person is turned.
    - ``hands`` (6): one hand from the other, and how that changes.
    - ``trunk`` (6): how hips and shoulders move in real time, smoothed less: the bounce of a run.
    """
    share = len(movement.joints) / 5.0  # a fifth of the movement is the unit of time, whatever the frames
    real = share * _USUAL_S / max(movement.duration_s, 0.1)
    arrays = _views(movement.joints, movement.trunk, np.float32(share), np.float32(real))
    return dict(zip(VIEWS, arrays, strict=True))


@njit(cache=True)
def _views(joints, trunk, share, real):  # type: ignore[no-untyped-def]  # compiled
    frames = len(joints)
    speed = _gradient(joints.reshape(frames, -1)) * share
    hands = np.empty((frames, 6), dtype=np.float32)
    for axis in range(3):
        hands[:, axis] = joints[:, 5, axis] - joints[:, 6, axis]
        hands[:, 3 + axis] = speed[:, 15 + axis] - speed[:, 18 + axis]
    return (
        joints.reshape(frames, -1).copy(),
        speed * (real / share),
        _directions(speed),
        _gradient(speed) * share,
        _gradient(_bones(joints)) * real,
        _gradient(_distances(joints)) * real,
        hands,
        _gradient(trunk.reshape(frames, -1)) * real,
    )


@njit(cache=True)
def _gradient(values):  # type: ignore[no-untyped-def]  # compiled
    """Central differences a frame, one-sided at the ends."""
    out = np.empty_like(values)
    out[0] = values[1] - values[0]
    out[-1] = values[-1] - values[-2]
    for i in range(1, len(values) - 1):
        for f in range(values.shape[1]):
            out[i, f] = (values[i + 1, f] - values[i - 1, f]) * np.float32(0.5)
    return out


@njit(cache=True)
def _directions(speed):  # type: ignore[no-untyped-def]  # compiled
    out = np.empty_like(speed)
    for i in range(len(speed)):
        for j in range(0, speed.shape[1], 3):
            length = np.sqrt(speed[i, j] ** 2 + speed[i, j + 1] ** 2 + speed[i, j + 2] ** 2)
            out[i, j : j + 3] = speed[i, j : j + 3] / np.sqrt(length + np.float32(1e-3))
    return out


@njit(cache=True)
def _bones(joints):  # type: ignore[no-untyped-def]  # compiled
    """Unit vectors along the limbs, across the shoulders, and up the trunk."""
    count = len(_BONES)
    out = np.empty((len(joints), 3 * (count + 1)), dtype=np.float32)
    vector = np.empty(3, dtype=np.float32)
    for i in range(len(joints)):
        for b in range(count + 1):
            for axis in range(3):
                if b < count:
                    vector[axis] = joints[i, _BONES[b, 1], axis] - joints[i, _BONES[b, 0], axis]
                else:
                    shoulders = joints[i, 1, axis] + joints[i, 2, axis]
                    vector[axis] = (shoulders - joints[i, 7, axis] - joints[i, 8, axis]) * np.float32(0.5)
            length = max(np.sqrt((vector**2).sum()), np.float32(1e-6))
            out[i, 3 * b : 3 * b + 3] = vector / length
    return out


@njit(cache=True)
def _distances(joints):  # type: ignore[no-untyped-def]  # compiled
    out = np.empty((len(joints), len(_PAIRS)), dtype=np.float32)
    for i in range(len(joints)):
        for p in range(len(_PAIRS)):
            square = np.float32(0)
            for axis in range(3):
                step = joints[i, _PAIRS[p, 0], axis] - joints[i, _PAIRS[p, 1], axis]
                square += step * step
            out[i, p] = np.sqrt(square)
    return out
