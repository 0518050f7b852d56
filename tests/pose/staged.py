"""A stage for the estimator without networks: flat people in colour and depth, and eyes that see them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.pose.body import Body
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.pose.landmarker import Sighting
from wigwag.pose.lift import LiftConfig
from wigwag.pose.operator import OperatorConfig
from wigwag.pose.region import Region
from wigwag.skeleton import Pose

CAMERA = Intrinsics()
SURFACE = LiftConfig(surface_to_joint=False)
RATE_HZ = 30.0
RED, BLUE, GREEN, GREY = (190, 40, 40), (40, 60, 180), (40, 150, 60), (90, 90, 90)


def standing(x_m: float, z_m: float) -> np.ndarray:
    """33 landmarks of a flat person facing the camera, metres, camera frame."""
    points = np.zeros((33, 3))
    points[:11] = (0.0, -0.65, 0.0)
    points[[7, 8], 0] = (0.08, -0.08)
    points[[7, 8], 1] = -0.7
    for left, side, down in ((11, 0.2, -0.45), (13, 0.3, -0.2), (15, 0.35, 0.05), (17, 0.36, 0.1),
                             (19, 0.36, 0.12), (21, 0.34, 0.1), (23, 0.12, 0.0), (25, 0.13, 0.4),
                             (27, 0.13, 0.8), (29, 0.13, 0.85), (31, 0.16, 0.86)):  # fmt: skip
        points[left] = (side, down, 0.0)
        points[left + 1] = (-side, down, 0.0)
    return points + np.array([x_m, 0.1, z_m])


def raising(points: np.ndarray, left: bool = True, right: bool = False) -> np.ndarray:
    """The same person with one hand or both high above the head."""
    up = points.copy()
    for is_up, first in ((left, 0), (right, 1)):
        if is_up:
            up[13 + first, 1] -= 0.45
            up[[15 + first, 17 + first, 19 + first, 21 + first], 1] = points[0, 1] - 0.4
    return up


def body_of(points: np.ndarray, clarity: float = 0.9) -> Body:
    """What the network says of these 33 points."""
    around = points - points[[23, 24]].mean(axis=0)
    return Body(CAMERA.project(points), np.full(33, 0.9), around, 1.0, clarity)


def region_of(body: Body) -> Region:
    hips, shoulders = body.hip_center_px, body.points_px[[11, 12]].mean(axis=0)
    return Region.around(hips, hips + 1.9 * (shoulders - hips))


@dataclass
class Player:
    """Somebody on the stage."""

    at: Callable[[float], tuple[float, float] | None]
    """Where they stand at a time, x and z in metres; ``None``: not there."""
    shirt: tuple[int, int, int] = RED
    trousers: tuple[int, int, int] = GREY
    up: Callable[[float], tuple[bool, bool]] = lambda t: (False, False)
    """Whether the left and the right hand are raised at a time."""
    scale: float = 1.0
    """Of the body's lengths."""
    lean: Callable[[float], float] = lambda t: 0.0
    """How far the trunk is before the hips at a time, metres: bending towards the camera."""

    def points(self, t_s: float) -> np.ndarray | None:
        place = self.at(t_s)
        if place is None:
            return None
        x, z = place
        tall = raising(standing(0.0, 0.0) * self.scale, *self.up(t_s))
        trunk = float(tall[[23, 24], 1].mean() - tall[[11, 12], 1].mean())
        tall[:23, 1] += trunk - np.sqrt(trunk**2 - self.lean(t_s) ** 2)
        return tall + np.array([x, 0.0, z])


def raised(*spans: tuple[float, float], both: bool = False) -> Callable[[float], tuple[bool, bool]]:
    """Raise the left hand, or both, within these spans of time."""

    def up(t_s: float) -> tuple[bool, bool]:
        now = any(begin <= t_s < end for begin, end in spans)
        return now, now and both

    return up


def engaging(begin_s: float = 0.5) -> Callable[[float], tuple[bool, bool]]:
    return raised((begin_s, begin_s + 1.3))


@dataclass
class Stage:
    """Players before a wall 9 m away; the eyes see whoever is nearest where they look."""

    players: Sequence[Player]
    engage: str = "gesture"
    config: PoseConfig | None = None
    t_s: float = 0.0
    looks: int = 0
    searches: int = 0
    blind: bool = False
    """The eyes find nobody."""
    seen: list[tuple[float, Pose | None]] = field(default_factory=list)

    def __post_init__(self) -> None:
        operator = OperatorConfig(engage=self.engage)  # type: ignore[arg-type]
        self.estimate = PoseEstimator(self.config or PoseConfig(lift=SURFACE, operator=operator), self)

    def visible(self) -> list[tuple[float, np.ndarray]]:
        """Depth and points of whoever is there and not hidden behind somebody, nearest first."""
        there = [p for player in self.players if (p := player.points(self.t_s)) is not None]
        there.sort(key=lambda points: float(points[0, 2]))
        shown: list[tuple[float, np.ndarray]] = []
        for points in there:
            z = float(points[0, 2])
            u = CAMERA.project(points[23:25].mean(axis=0))[0]
            hidden = any(
                abs(CAMERA.project(other[23:25].mean(axis=0))[0] - u) < 0.3 * CAMERA.fx / near
                for near, other in shown
            )
            if not hidden and 0 <= u < 640:
                shown.append((z, points))
        return shown

    def follow(self, rgb: np.ndarray, region: Region) -> Sighting | None:
        """See the one nearest to the middle of the region, as the network does."""
        self.looks += 1
        seen = [] if self.blind else [body_of(points) for _, points in self.visible()]
        away = [float(np.hypot(*(b.hip_center_px - (region.u, region.v)))) / region.side for b in seen]
        if not away or min(away) > 0.4:
            return None
        body = seen[int(np.argmin(away))]
        return Sighting(body, region_of(body))

    def find(
        self, rgb: np.ndarray, regions: Sequence[Region], *, most: int = 1, known: Sequence[Region] = ()
    ) -> list[Sighting]:
        self.searches += 1
        found: list[Sighting] = []
        for region in regions:
            for _, points in [] if self.blind else self.visible():
                body = body_of(points)
                off = np.abs(body.hip_center_px - (region.u, region.v)).max()
                place = region_of(body)
                if off < region.side / 2 and not any(place.resembles(k) for k in known):
                    found.append(Sighting(body, place))
        return found[:most]

    def frame(self) -> Frame:
        """Paint everybody, the nearest last."""
        rgb = np.full((480, 640, 3), 120, np.uint8)
        depth = np.full((480, 640), 9000, np.uint16)
        there = [(p, player) for player in self.players if (p := player.points(self.t_s)) is not None]
        for points, player in sorted(there, key=lambda pair: -float(pair[0][0, 2])):
            z = float(points[0, 2])
            lean = player.lean(self.t_s)  # what is just above the hips stays where it is
            waist = np.array([0.0, 0.12 if lean else 0.0, 0.0])
            (chest, hips, feet) = (points[list(ends)].mean(axis=0) for ends in ((11, 12), (23, 24), (29, 30)))
            for top_m, bottom_m, half_m, colour, deep in (
                (chest, hips - waist, 0.22, player.shirt, z - lean),
                (hips - waist, hips, 0.22, player.shirt, z),
                (hips, feet, 0.2, player.trousers, z),
            ):
                (u, top), bottom = CAMERA.project(top_m), CAMERA.project(bottom_m)
                half = half_m * player.scale * CAMERA.fx / z
                box = np.round([u - half, u + half, top, bottom[1]]).astype(int)
                left, right, upper, lower = np.clip(box, 0, [640, 640, 480, 480])
                rgb[upper:lower, left:right], depth[upper:lower, left:right] = colour, round(1000 * deep)
            for first in (0, 1):
                hand = CAMERA.project(points[15 + first])
                u0, v0 = np.round(hand).astype(int)
                depth[max(v0 - 5, 0) : max(v0 + 5, 0), max(u0 - 5, 0) : max(u0 + 5, 0)] = round(1000 * z)
        return Frame(rgb, depth, CAMERA, round(self.t_s * 1e9))

    def play(self, until_s: float) -> list[tuple[float, Pose | None]]:
        """Go on to a time; return what was handed on meanwhile."""
        began = len(self.seen)
        while self.t_s < until_s - 1e-9:
            self.seen.append((self.t_s, self.estimate(self.frame())))
            self.t_s = (round(self.t_s * RATE_HZ) + 1) / RATE_HZ
        return self.seen[began:]


def handed(seen: Sequence[tuple[float, Pose | None]]) -> list[tuple[float, float, float]]:
    """Time, x and z of what was handed on."""
    return [(t, float(p.hip_center[0]), float(p.hip_center[2])) for t, p in seen if p is not None]


def still(x_m: float, z_m: float) -> Callable[[float], tuple[float, float]]:
    return lambda t: (x_m, z_m)


def walks(
    z_m: float, begin_s: float, speed_m_s: float = 1.3, from_m: float = -2.2
) -> Callable[[float], object]:
    """Walk across, away from ``from_m``; not there before and after."""

    def at(t_s: float) -> tuple[float, float] | None:
        gone = (t_s - begin_s) * speed_m_s
        if not 0 <= gone <= 2 * abs(from_m):
            return None
        return float(from_m - np.sign(from_m) * gone), z_m

    return at
