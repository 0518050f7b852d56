"""The complete embedding of the paper's section 3: a clip of poses becomes a sequence of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Literal, Self

import numpy as np
from jaxtyping import Float
from numba import njit

from wigwag.errors import InputError
from wigwag.features.estimator import Transformer
from wigwag.skeleton import LANDMARKS, N_LANDMARKS, Clip

PAIRS: tuple[tuple[int, int], ...] = tuple(combinations(range(N_LANDMARKS), 2))
"""All 78 pairs of landmarks."""

_FIRSTS, _SECONDS = np.array(PAIRS).T

ALL_TRIPLES: tuple[tuple[int, int, int], ...] = tuple(combinations(range(N_LANDMARKS), 3))
"""All 286 triples of landmarks."""

ADJACENT_TRIPLES: tuple[tuple[int, int, int], ...] = (
    (0, 1, 3), (0, 2, 4),  # head and shoulders
    (1, 3, 5), (2, 4, 6),  # elbows
    (3, 1, 7), (4, 2, 8), (3, 1, 2), (4, 2, 1),  # armpits, and arms against the shoulder line
    (1, 7, 9), (2, 8, 10), (1, 7, 8), (2, 8, 7),  # hips, and the trunk's lean
    (7, 9, 11), (8, 10, 12),  # knees
    (9, 7, 8), (10, 8, 7),  # spread of the legs
)  # fmt: skip
"""16 triples of landmarks that are neighbours in the body, the same on both sides; the angle is at the
middle one."""

_SINGLE = (
    "position", "velocity", "acceleration", "angle", "angular_velocity", "angular_acceleration",
    "displacement",
)  # fmt: skip
_PAIR = ("difference", *_SINGLE[1:6])
_TRIPLE = ("theta", "angular_velocity", "angular_acceleration")


class Embedding(Transformer):
    """The paper's complete embedding: single joints, pairs of joints, triples of joints, frame by frame.

    It knows nothing of a training set; ``fit`` only settles which features there are. Differences over
    time use the clip's own stamps. Before the first frame the person is taken to have moved as between
    the first two. An angle of a vector without length is a right angle to every axis; three joints in
    one line span no plane, and their feature is 0.

    Args:
        triples: ``"adjacent"``, the 16 anatomically adjacent triples (1821 features in all), or
            ``"all"`` 286 (4251 features).
        displacement: A joint's change of position since the ``"previous"`` frame or the ``"first"``.
        dtype: Floating point type of the result, ``"float32"`` or ``"float64"``.

    Attributes:
        names_: A name for each feature, such as ``"left_wrist.velocity.x"``,
            ``"left_wrist-right_wrist.angle.y"`` or ``"left_shoulder>left_elbow>left_wrist.theta.z"``.
        n_features_: How many there are.

    Raises:
        InputError: From ``fit``, if a setting is not one of those named.

    Example:
        >>> import numpy as np
        >>> from wigwag.skeleton import Clip
        >>> clip = Clip.at_rate(np.random.default_rng(0).normal(size=(20, 13, 3)), rate_hz=30)
        >>> embedding = Embedding()
        >>> embedding.fit_transform([clip])[0].shape
        (20, 1821)
        >>> embedding.names_[:2]
        ('nose.position.x', 'nose.position.y')
    """

    names_: tuple[str, ...]
    n_features_: int

    def __init__(
        self,
        triples: Literal["adjacent", "all"] = "adjacent",
        displacement: Literal["previous", "first"] = "previous",
        dtype: Literal["float32", "float64"] = "float32",
    ) -> None:
        self.triples = triples
        self.displacement = displacement
        self.dtype = dtype

    def fit(self, clips: Sequence[Clip] | None = None, y: object = None) -> Self:
        """Check the settings and name the features; the clips are not looked at."""
        for field, known in (
            ("triples", ("adjacent", "all")),
            ("displacement", ("previous", "first")),
            ("dtype", ("float32", "float64")),
        ):
            if (value := getattr(self, field)) not in known:
                raise InputError(f"Embedding.{field} must be one of {known}, but got {value!r}.")
        self.names_ = _names(self._triples())
        self.n_features_ = len(self.names_)
        return self

    def transform(self, clips: Sequence[Clip]) -> list[Float[np.ndarray, "frames features"]]:
        """Embed each clip; clips should have been normalised before."""
        return [self.embed(clip) for clip in clips]

    def get_feature_names_out(self, input_features: object = None) -> np.ndarray:
        """Return ``names_`` the way scikit-learn asks for it."""
        return np.array(self.names_, dtype=object)

    def embed(self, clip: Clip) -> Float[np.ndarray, "frames features"]:
        """Embed one clip: one row a frame, one column a name of ``names_``."""
        joints = np.ascontiguousarray(clip.joints, dtype=np.float64)
        dt = np.diff(clip.stamps_ns) * 1e-9
        pairs = joints[:, _SECONDS] - joints[:, _FIRSTS]  # eq. difference vector
        out = np.empty((len(joints), self.n_features_), dtype=self.dtype)
        at = _write_vectors(joints, dt, out, 0)
        moved = out[:, at : at + joints[0].size]
        at += _write_displacement(joints, self.displacement, moved)
        at = _write_vectors(pairs, dt, out, at)
        _write_with_rates(_triple_angles(joints, self._triples()), dt, out, at)
        return out

    def _triples(self) -> tuple[tuple[int, int, int], ...]:
        return ALL_TRIPLES if self.triples == "all" else ADJACENT_TRIPLES


def _names(triples: Sequence[tuple[int, int, int]]) -> tuple[str, ...]:
    """Name each feature in the order in which ``Embedding.embed`` joins them."""
    pairs = [f"{LANDMARKS[a]}-{LANDMARKS[b]}" for a, b in PAIRS]
    threes = [">".join(LANDMARKS[j] for j in triple) for triple in triples]
    groups = ((LANDMARKS, _SINGLE), (pairs, _PAIR), (threes, _TRIPLE))
    return tuple(
        f"{who}.{what}.{axis}" for whose, kinds in groups for what in kinds for who in whose for axis in "xyz"
    )


def _write_vectors(
    vectors: Float[np.ndarray, "frames any 3"],
    dt: Float[np.ndarray, " steps"],
    out: Float[np.ndarray, "frames features"],
    at: int,
) -> int:
    """Write vectors, axis angles, and two rates of each from column ``at`` on; return where they end."""
    at = _write_with_rates(vectors, dt, out, at)
    return _write_with_rates(_axis_angles(vectors), dt, out, at)


def _write_with_rates(
    values: Float[np.ndarray, "frames any 3"],
    dt: Float[np.ndarray, " steps"],
    out: Float[np.ndarray, "frames features"],
    at: int,
) -> int:
    width = 3 * int(values.shape[1])
    _rates(values.reshape(len(values), width), dt, out[:, at : at + 3 * width])
    return at + 3 * width


@njit(cache=True)
def _rates(values, dt, out):  # type: ignore[no-untyped-def]  # compiled: numba infers the types
    """Write values, their rates and those' rates side by side, in one pass over the frames.

    A rate is the difference to the frame before over the time step; the first frame repeats the second's.
    """
    frames, width = values.shape
    velocity = np.empty(width)
    for i in range(width):
        velocity[i] = (values[1, i] - values[0, i]) / dt[0]
        out[0, i], out[0, width + i], out[0, 2 * width + i] = values[0, i], velocity[i], 0.0
    for t in range(1, frames):
        step = dt[t - 1]
        for i in range(width):
            now = (values[t, i] - values[t - 1, i]) / step  # eq. velocity: (p - p_prev) / dt
            out[t, i] = values[t, i]
            out[t, width + i] = now  # also eq. angular velocity, of angles
            out[t, 2 * width + i] = (now - velocity[i]) / step  # eq. acceleration: (v - v_prev) / dt
            velocity[i] = now


def _write_displacement(
    joints: Float[np.ndarray, "frames 13 3"], since: str, out: Float[np.ndarray, "frames 39"]
) -> int:
    """Write how far each joint has moved; return how many columns that took."""
    flat = joints.reshape(len(joints), -1)
    if since == "first":
        out[:] = flat - flat[0]  # eq. displacement
    else:
        np.subtract(flat[1:], flat[:-1], out=out[1:], casting="same_kind")  # eq. displacement
        out[0] = out[1]
    return flat.shape[1]


def _axis_angles(vectors: Float[np.ndarray, "frames any 3"]) -> Float[np.ndarray, "frames any 3"]:
    """Angles of each vector to the x, y and z axes, radians; a right angle for a vector without length."""
    length = np.sqrt(np.einsum("fnc,fnc->fn", vectors, vectors))
    length[length <= 1e-12] = np.inf
    cosine = vectors / length[:, :, None]
    np.clip(cosine, -1.0, 1.0, out=cosine)
    return np.asarray(np.arccos(cosine, out=cosine))  # eq. axis angle: arccos(v.a / |v||a|)


def _triple_angles(
    joints: Float[np.ndarray, "frames 13 3"], triples: Sequence[tuple[int, int, int]]
) -> Float[np.ndarray, "frames triples 3"]:
    """Compute Theta = N theta of each triple."""
    a, b, c = np.array(triples).T
    ab, bc = joints[:, b] - joints[:, a], joints[:, c] - joints[:, b]
    normal = np.stack(
        [
            ab[..., 1] * bc[..., 2] - ab[..., 2] * bc[..., 1],
            ab[..., 2] * bc[..., 0] - ab[..., 0] * bc[..., 2],
            ab[..., 0] * bc[..., 1] - ab[..., 1] * bc[..., 0],
        ],
        axis=-1,
    )
    length = np.sqrt(np.einsum("fnc,fnc->fn", normal, normal))
    # atan2 keeps its digits where arccos(AB.BC / |AB||BC|) loses them, near a stretched limb.
    theta = np.arctan2(length, np.einsum("fnc,fnc->fn", ab, bc))  # eq. tri-joint angle
    length[length <= 1e-12] = np.inf
    return np.asarray(normal * (theta / length)[:, :, None])  # eq. Theta = N theta
