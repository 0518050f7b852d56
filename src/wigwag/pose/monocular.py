"""A pose in space without depth: the network's own metres, placed so that they meet the picture.

BlazePose guesses its landmarks in metres around the hips as well (``Body.world_m``), always for a body of
about the same stature. Where that body must stand, for its landmarks to be seen where they are, follows
from the camera's intrinsics; how far off the real person then is, from how tall they are compared with it.
Both are guesses, so all of this is marked (``Pose.monocular``) and states its uncertainty: some 8 % of the
distance for an adult of unknown stature, some 5 % for one whose stature is stated. An error of the focal
length goes into the distance in full, and is not in these figures: a webcam whose field of view is guessed
adds its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Intrinsics
from wigwag.errors import InputError
from wigwag.pose.body import Body, Point
from wigwag.skeleton import Landmark, from_blazepose33

# Measured in the simulator on training people and on UTD-MHAD's subjects 1, 3, 5 and 7 in simulated bodies,
# at 2 to 8 m (`wigwag benchmark monocular` shows others). In 140 photos of real operators the network leans
# as much.
NETWORK_STATURE_M = 1.62
"""The stature for which the network's metres are right."""
_LEAN = 0.20
"""The network sees the trunk lean towards the camera: head, arms and shoulders come by this share of the
trunk's length too near."""
_OWN_SIGMA_M = np.array([
    0.110, 0.085, 0.085, 0.075, 0.075, 0.095, 0.095, 0.030, 0.030, 0.140, 0.140, 0.110, 0.110,
])  # fmt: skip
"""One standard deviation of a landmark's depth from the hips', at full visibility."""
_UNSEEN_M = 0.075
"""Across the line of sight at visibility 0; see ``wigwag.pose.uncertainty``."""

_COUNTS = np.array([0.2] * 11 + [2.0] * 2 + [0.3] * 4 + [0.1] * 6 + [2.0] * 2 + [1.0] * 2 + [0.5] * 6)
"""What a landmark counts for: trunk and legs say how far a body is, arms swing, eleven make one face."""
_ABOVE_HIPS = slice(0, Point.LEFT_HIP)
_ROUNDS = 4
_PULL_M = 0.03
"""A landmark farther from where it should be pulls no harder than one at this distance."""
_OUTSIDE = 0.01
"""Weight of a landmark outside the picture: where it is there, the network guesses."""
_LEAST = 3.0
"""So much all weights together must be (a body seen in full: 18) to say where a person stands."""
_NEAREST_M, _FARTHEST_M = 0.3, 60.0


@dataclass(frozen=True, slots=True)
class MonocularConfig:
    """What is known of the person.

    Raises:
        InputError: If a value is out of range; the message names it.
    """

    stature_m: float | None = None
    """The operator's stature, ground to crown, metres; ``None``: an adult whom nobody measured."""
    average_m: float = 1.70
    """Stature that is then supposed, metres."""
    average_spread_m: float = 0.10
    """One standard deviation of adults around it, metres: 5.9 % of the distance."""
    placing_spread: float = 0.05
    """One standard deviation of what the network's body itself leaves open, as a share of the distance. In
    the simulator 3 to 4 % were measured; real pictures with a measured distance have not been tried."""
    when_depth_fails: bool = False
    """Whether a frame *with* a depth picture that shows nothing at the person is placed without it. Off: a
    depth camera that delivers holes is a fault, and a pose that silently becomes several times less sure
    must not steer a drone that was set up for a sure one."""

    def __post_init__(self) -> None:
        """Check ranges once, where the configuration enters."""
        for name in ("stature_m", "average_m"):
            value = getattr(self, name)
            if value is not None and not 0.5 <= value <= 2.5:
                raise InputError(f"MonocularConfig.{name} must lie within 0.5 and 2.5 m, but got {value}.")
        for name in ("average_spread_m", "placing_spread"):
            if not 0 <= getattr(self, name) < 1:
                raise InputError(
                    f"MonocularConfig.{name} must lie within 0 and 1, but got {getattr(self, name)}."
                )


@dataclass(frozen=True, slots=True)
class Placed:
    """Thirteen landmarks in space, placed without depth."""

    points_m: Float[np.ndarray, "13 3"]
    """Metres, camera optical frame; each on the ray of its pixel."""
    visibility: Float[np.ndarray, 13]
    """As it came in."""
    sigma_m: Float[np.ndarray, 13]
    """One standard deviation of the landmark's place along its worst axis, metres, everything included."""
    distance_sigma_m: float
    """The part of it that is the whole body's distance, metres."""
    distance_m: float
    """From the camera to the middle of the hips, along the optical axis."""


class MonocularPlacer:
    """Places a body by its supposed size.

    The translation is that of least squares between where the network's metres, moved by it, lie beside the
    rays of their pixels; landmarks weigh by the square of their visibility, those outside the picture hardly,
    those that disagree with the others no more than a bounded pull (Huber). The network sees a person as if
    the camera looked straight at them, so its metres are turned into the direction of the hips first. Each
    landmark then keeps its pixel and takes its depth from the placed body.

    Args:
        config: What is known of the person.
    """

    def __init__(self, config: MonocularConfig | None = None) -> None:
        self.config = config = config or MonocularConfig()
        stated = config.stature_m is not None
        stature = config.stature_m if config.stature_m is not None else config.average_m
        spread = 0.0 if stated else config.average_spread_m / stature
        self._scale = stature / NETWORK_STATURE_M
        self._distance_spread = float(np.hypot(spread, config.placing_spread))

    def __call__(self, body: Body, intrinsics: Intrinsics, head: str = "nose") -> Placed | None:
        """Place one person.

        Args:
            body: What the network says; pixels and metres.
            intrinsics: Of the picture.
            head: What the first landmark is, as in ``from_blazepose33``.

        Returns:
            The landmarks, or ``None`` if what is seen does not say where the person stands.
        """
        world = body.world_m
        if not (np.isfinite(world).all() and np.isfinite(body.points_px).all()):
            return None
        weights = _weights(body, intrinsics)
        if weights.sum() < _LEAST:
            return None
        hips_ray = intrinsics.deproject(body.hip_center_px, np.array(1.0))
        world = self._scale * _upright(world) @ towards(hips_ray).T
        rays = intrinsics.deproject(body.points_px, np.ones(len(world)))
        solved = _translation(world, rays, weights)
        if solved is None:
            return None
        z_m = from_blazepose33(world[:, 2:], head)[:, 0] + solved[2]
        hips_m = float(z_m[[Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean())
        if not (_NEAREST_M <= hips_m <= _FARTHEST_M and z_m.min() > 0.0):
            return None
        visibility = np.clip(np.nan_to_num(from_blazepose33(body.visibility[:, None], head)[:, 0]), 0.0, 1.0)
        points_m = intrinsics.deproject(from_blazepose33(body.points_px, head), z_m)
        distance_sigma = self._distance_spread * hips_m
        own = np.hypot(_OWN_SIGMA_M * self._scale, _UNSEEN_M * (1.0 - visibility))
        return Placed(points_m, visibility, np.hypot(own, distance_sigma), distance_sigma, hips_m)


def towards(ray: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
    """Return the shortest rotation that takes the optical axis into a ray's direction (z > 0).

    Example:
        >>> import numpy as np
        >>> (towards(np.array([1.0, 0.0, 1.0])) @ [0, 0, 1]).round(4).tolist()
        [0.7071, 0.0, 0.7071]
    """
    x, y, z = ray / np.linalg.norm(ray)
    turn = np.array([[0.0, 0.0, x], [0.0, 0.0, y], [-x, -y, 0.0]])
    return np.asarray(np.eye(3) + turn + turn @ turn / (1.0 + z))


def _upright(world: Float[np.ndarray, "33 3"]) -> Float[np.ndarray, "33 3"]:
    """Put the hips into the origin and take the network's lean out."""
    world = world - world[[Point.LEFT_HIP, Point.RIGHT_HIP]].mean(axis=0)
    trunk = world[[Point.LEFT_SHOULDER, Point.RIGHT_SHOULDER]].mean(axis=0)
    world[_ABOVE_HIPS, 2] += _LEAN * np.linalg.norm(trunk)
    return world


def _weights(body: Body, intrinsics: Intrinsics) -> Float[np.ndarray, " 33"]:
    """Weigh landmarks by how surely they are seen, and by whether the picture holds them at all."""
    u, v = body.points_px.T
    inside = (u >= 0) & (u < intrinsics.width) & (v >= 0) & (v < intrinsics.height)
    seen = np.clip(np.nan_to_num(body.visibility), 0.0, 1.0)
    return np.asarray(np.maximum(seen, 1e-3) ** 2 * np.where(inside, 1.0, _OUTSIDE) * _COUNTS)


def _translation(
    world: Float[np.ndarray, "33 3"], rays: Float[np.ndarray, "33 3"], weights: Float[np.ndarray, " 33"]
) -> Float[np.ndarray, " 3"] | None:
    """Return the translation after which each point lies on its ray, by reweighted least squares.

    A ray (a, b, 1) holds (x, y, z) if x - a z = 0 and y - b z = 0: linear in the translation, and the
    residuals are metres beside the ray.
    """
    slopes = rays[:, :2]
    target = slopes * world[:, 2:] - world[:, :2]
    pulls, moved = weights, None
    for _ in range(_ROUNDS):
        total, mean = pulls.sum(), pulls @ slopes
        normal = np.array([
            [total, 0.0, -mean[0]], [0.0, total, -mean[1]],
            [-mean[0], -mean[1], pulls @ (slopes**2).sum(axis=1)],
        ])  # fmt: skip
        against = pulls @ target
        right = np.array([against[0], against[1], -(pulls @ (slopes * target).sum(axis=1))])
        try:
            moved = np.linalg.solve(normal, right)
        except np.linalg.LinAlgError:
            return None
        beside = np.linalg.norm(moved[:2] - slopes * moved[2] - target, axis=1)
        pulls = weights * np.minimum(1.0, _PULL_M / np.maximum(beside, 1e-9))
    return moved if moved is not None and np.isfinite(moved).all() else None


__all__ = ["NETWORK_STATURE_M", "MonocularConfig", "MonocularPlacer", "Placed", "towards"]
