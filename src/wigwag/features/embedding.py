"""The complete embedding of the paper's section 3: a clip of poses becomes a sequence of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Literal, Self

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.features.estimator import Transformer
from wigwag.skeleton import LANDMARKS, N_LANDMARKS, Clip

PAIRS: tuple[tuple[int, int], ...] = tuple(combinations(range(N_LANDMARKS), 2))
"""All 78 pairs of landmarks."""

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
        joints = np.asarray(clip.joints, dtype=np.float64)
        dt = np.diff(clip.stamps_ns)[:, None, None] * 1e-9
        parts = [*_single_joint(joints, dt, self.displacement), *_joint_pair(joints, dt)]
        parts += _three_joints(joints, dt, self._triples())
        flat = [part.reshape(len(joints), -1) for part in parts]
        return np.concatenate(flat, axis=1, dtype=np.dtype(self.dtype))

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


def _rate(
    values: Float[np.ndarray, "frames any 3"], dt: Float[np.ndarray, "steps 1 1"]
) -> Float[np.ndarray, "frames any 3"]:
    """Difference to the frame before over the time step; the first frame repeats the second's."""
    rate = np.empty_like(values)
    np.divide(np.diff(values, axis=0), dt, out=rate[1:])
    rate[0] = rate[1]
    return rate


def _axis_angles(vectors: Float[np.ndarray, "frames any 3"]) -> Float[np.ndarray, "frames any 3"]:
    """Angles of each vector to the x, y and z axes, radians."""
    length = np.sqrt(np.einsum("fnc,fnc->fn", vectors, vectors))[:, :, None]
    cosine = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-12)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))  # eq. axis angle: arccos(v.a / |v||a|)


def _motion(
    vectors: Float[np.ndarray, "frames any 3"], dt: Float[np.ndarray, "steps 1 1"]
) -> list[Float[np.ndarray, "frames any 3"]]:
    """Vectors, their velocity and acceleration, their axis angles, and those angles' two rates."""
    velocity = _rate(vectors, dt)  # eq. velocity: (p - p_prev) / dt
    acceleration = _rate(velocity, dt)  # eq. acceleration: (v - v_prev) / dt
    angles = _axis_angles(vectors)
    angular_velocity = _rate(angles, dt)  # eq. angular velocity
    angular_acceleration = _rate(angular_velocity, dt)  # eq. angular acceleration
    return [vectors, velocity, acceleration, angles, angular_velocity, angular_acceleration]


def _single_joint(
    joints: Float[np.ndarray, "frames 13 3"], dt: Float[np.ndarray, "steps 1 1"], displacement: str
) -> list[Float[np.ndarray, "frames 13 3"]]:
    """Compute the single-joint part: 7 kinds x 13 joints x 3."""
    moved = joints - joints[0]
    if displacement == "previous":
        moved[1:] = np.diff(joints, axis=0)
        moved[0] = moved[1]
    return [*_motion(joints, dt), moved]  # eq. displacement


def _joint_pair(
    joints: Float[np.ndarray, "frames 13 3"], dt: Float[np.ndarray, "steps 1 1"]
) -> list[Float[np.ndarray, "frames 78 3"]]:
    """Compute the joint-pair part: 6 kinds x 78 pairs x 3."""
    first, second = np.array(PAIRS).T
    return _motion(joints[:, second] - joints[:, first], dt)  # eq. difference vector


def _three_joints(
    joints: Float[np.ndarray, "frames 13 3"],
    dt: Float[np.ndarray, "steps 1 1"],
    triples: Sequence[tuple[int, int, int]],
) -> list[Float[np.ndarray, "frames triples 3"]]:
    """Compute the three-joint part: Theta = N theta and its two rates, each triples x 3."""
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
    scale = np.divide(theta, length, out=np.zeros_like(theta), where=length > 1e-12)
    feature = normal * scale[:, :, None]  # eq. Theta = N theta
    velocity = _rate(feature, dt)
    return [feature, velocity, _rate(velocity, dt)]
