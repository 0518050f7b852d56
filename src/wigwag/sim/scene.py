"""Where the operator stands: ground, sky, far trees, and a few things that stand about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.fft
from jaxtyping import Float, Float32, Int64, UInt8, UInt32

from wigwag.sim.shapes import Shapes, Surface, linear_rgb

_SIDE = 1024
_TEXEL_M = 0.01


class Mipmap(NamedTuple):
    """A square texture and its halves, packed as 0x00BBGGRR, one after the other."""

    texels: UInt32[np.ndarray, " texels"]
    starts: Int64[np.ndarray, " levels"]
    texel_m: float


@dataclass(frozen=True, slots=True)
class SceneConfig:
    """What surrounds the operator."""

    ground: str = "meadow"
    """``"meadow"`` or ``"gravel"``."""
    clutter: int = 14
    """How many trees, poles and boxes stand 8 to 20 m around."""
    near: int = 0
    """How many boxes, posts and bushes stand within arm's reach and three metres of the operator, beside and
    behind them, off the ways 0.8 to 1.5 m before and behind on which people pass."""
    wall: str | None = None
    """Display colour of a wall behind the operator, ``"#rrggbb"``; no wall if ``None``."""
    wall_behind_m: float = 2.6
    """How far behind the operator the wall stands."""
    sun_elevation_deg: float = 42.0
    sun_azimuth_deg: float | None = None
    """Anticlockwise from east; drawn from the seed if ``None``."""


class Scene:
    """The surroundings, made once from a seed.

    Args:
        config: What to build.
        seed: The same seed gives the same scene.
        clear: Points on the ground (metres, world frame) that clutter keeps 7 m away from: where the operator
            stands, then where the drone does.
    """

    def __init__(
        self,
        config: SceneConfig | None = None,
        seed: int = 0,
        clear: Float[np.ndarray, "points 2"] | None = None,
    ) -> None:
        config = config or SceneConfig()
        rng = np.random.default_rng([seed, 0x5CE])
        self.ground = _ground(rng, config.ground)
        azimuth = config.sun_azimuth_deg
        azimuth = float(rng.uniform(0, 360)) if azimuth is None else azimuth
        e, a = np.radians(config.sun_elevation_deg), np.radians(azimuth)
        self.sun = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        """Unit vector to the sun, world frame."""
        self.strengths = (0.85, 0.42, 0.16)
        """Light from the sun, from the sky, and thrown back by the ground."""
        self.sky = _sky()
        self.clouds = _clouds(rng)
        self.skyline = _skyline(rng)
        near = np.zeros((1, 2)) if clear is None else np.asarray(clear, float)
        self.shapes = _clutter(rng, config.clutter, near)
        self.leaves = _leaves(rng)
        around = np.random.default_rng([seed, 0x5CF])  # what is added leaves the rest of the scene as it was
        added = [_beside(around, config.near, near), _wall(config, near)]
        self.shapes = Shapes.joined([self.shapes, *(s for s in added if len(s))])
        self.patches = np.asarray(1 + 0.09 * _noise(rng, 256, 1.3), dtype=np.float32).clip(0.7, 1.3)
        self.levels = _levels(k=_TEXEL_M)


def _levels(k: float) -> Float32[np.ndarray, "256 2"]:
    """Which texture to read and what haze leaves of it, by distance in half metres.

    A pixel's patch of ground is long and narrow: the level's texel, ``k`` metres doubled each time, lies
    between its length (t^2 / h f) and its width (t / f), for a camera 1.5 m up.
    """
    distance = np.arange(256) / 2 + 0.25
    patch = np.sqrt((distance**2 / (1.5 * 615)) * (distance / 615))
    level = np.clip(np.round(np.log2(patch / k)), 0, 9)
    return np.stack([level, np.exp(-distance / 70)], axis=1).astype(np.float32)


def _noise(rng: np.random.Generator, side: int, slope: float) -> Float32[np.ndarray, "side side"]:
    """Seamless noise with zero mean and unit deviation, whose spectrum falls as frequency ** -slope."""
    fy, fx = np.fft.fftfreq(side)[:, None] * side, np.fft.rfftfreq(side)[None, :] * side
    fall = (np.maximum(fy**2 + fx**2, 9.0) ** (-slope / 2)).astype(np.float32)
    fall[0, 0] = 0.0
    spectrum = scipy.fft.rfft2(rng.standard_normal((side, side), dtype=np.float32)) * fall
    field = scipy.fft.irfft2(spectrum, s=(side, side))
    return np.asarray(field / field.std(), dtype=np.float32)


def _ground(rng: np.random.Generator, kind: str) -> Mipmap:
    patches, grain = _noise(rng, _SIDE, 1.6), _noise(rng, _SIDE, 0.35)
    if kind == "gravel":
        base, wide, fine = (134, 128, 118), (9, 9, 9), (20, 19, 18)
    else:
        base, wide, fine = (104, 122, 68), (13, 8, 7), (15, 17, 11)
    sides = [_SIDE >> level for level in range(_SIDE.bit_length())]
    levels = [np.zeros((side, side), np.uint32) for side in sides]
    for channel in range(3):  # one at a time: together they would be the most memory of a whole flight
        image = np.clip(base[channel] + wide[channel] * patches + fine[channel] * grain, 0, 255)
        for level in levels:
            np.bitwise_or(level, np.round(image).astype(np.uint32) << (8 * channel), out=level)
            if len(image) > 1:
                image = (image[::2, ::2] + image[1::2, ::2] + image[::2, 1::2] + image[1::2, 1::2]) / 4
    # One more entry tells the kernel the size of the largest level.
    starts = np.cumsum([0, *(side * side for side in sides)])
    return Mipmap(np.concatenate([level.ravel() for level in levels]), starts, _TEXEL_M)


def _sky() -> Float32[np.ndarray, "64 3"]:
    """Display colours from the horizon up."""
    k = np.linspace(0, 1, 64)[:, None] ** 0.7
    horizon, zenith = np.array([206.0, 220, 230]), np.array([92.0, 145, 205])
    return np.asarray(horizon + k * (zenith - horizon), dtype=np.float32)


def _clouds(rng: np.random.Generator) -> UInt8[np.ndarray, "1024 1024"]:
    """How much of the sky a cloud covers, 255 for all of it."""
    return np.asarray(255 * np.clip(0.5 * _noise(rng, _SIDE, 1.7), 0, 0.85), dtype=np.uint8)


def _leaves(rng: np.random.Generator) -> Float32[np.ndarray, "256 256"]:
    """Light and dark of foliage, 0 to 1."""
    return np.asarray(np.clip(0.5 + 0.28 * _noise(rng, 256, 0.8), 0, 1), dtype=np.float32)


def _skyline(rng: np.random.Generator) -> Float[np.ndarray, " 720"]:
    """Slope of the far trees' tops, by azimuth."""
    f = np.fft.rfftfreq(720) * 720
    f[0] = np.inf
    rough = np.fft.irfft(np.fft.rfft(rng.standard_normal(720)) * np.maximum(f, 6) ** -0.8, n=720)
    return np.asarray(np.clip(0.035 + 0.012 * rough / rough.std(), 0.008, None))


def _clutter(rng: np.random.Generator, count: int, clear: Float[np.ndarray, "points 2"]) -> Shapes:
    groups: list[Shapes] = []
    placed: list[Float[np.ndarray, 2]] = []
    for k in range(count):
        for _ in range(50):
            r, a = rng.uniform(8, 20), rng.uniform(-np.pi, np.pi)
            spot = clear.mean(axis=0) + r * np.array([np.cos(a), np.sin(a)])
            apart = all(np.linalg.norm(spot - other) > 3.0 for other in placed)
            if apart and np.linalg.norm(clear - spot, axis=1).min() > 7.0:
                break
        else:
            continue
        placed.append(spot)
        groups.append((_tree, _crate, _tree, _pole)[k % 4](rng, spot))
    return Shapes.joined(groups) if groups else _nothing()


def _tree(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    height = rng.uniform(3.5, 6.0)
    foot, top = np.array([*spot, 0.1]), np.array([*(spot + rng.normal(0, 0.1, 2)), 0.65 * height])
    bark = np.array([linear_rgb("#5b4636")] * 2)
    trunk = Shapes.capsules(foot[None], top[None], np.array([[0.17, 0.1]]), bark[None])
    n = 4
    centres = top + rng.normal(0, [0.45, 0.45, 0.35], (n, 3)) * height / 5
    size = rng.uniform(0.5, 0.85, n) * height / 5
    dark, light = rng.choice(["#35502a", "#2d4a30", "#465a2c"]), rng.choice(["#6f8f3f", "#5f8a4a", "#8a9a48"])
    colours = np.broadcast_to(np.array([linear_rgb(dark), linear_rgb(light)]), (n, 2, 3))
    crown = Shapes.capsules(centres, centres, np.stack([size, size], axis=1), colours, Surface.LEAVES)
    return Shapes.joined([trunk, crown])


def _pole(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    height = rng.uniform(3.0, 5.0)
    foot, top = np.array([*spot, 0.0]), np.array([*spot, height])
    grey = np.array([linear_rgb("#8b8f92")] * 2)
    arm = top + np.array([*(0.9 * _direction(rng)), 0.1])
    return Shapes.capsules(
        np.stack([foot, top]), np.stack([top, arm]), np.array([[0.06, 0.045], [0.04, 0.03]]),
        np.stack([grey, grey]),
    )  # fmt: skip


def _crate(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    half = np.array([rng.uniform(0.5, 1.1), rng.uniform(0.4, 0.7), rng.uniform(0.35, 0.6)])
    wood = rng.choice(["#a98157", "#8f8a80", "#4c6a86"])
    colours = np.array([linear_rgb(wood), [0.5 * c for c in linear_rgb(wood)]])
    return Shapes.box(np.array([*spot, half[2]]), half, rng.uniform(0, np.pi), colours)


def _sight(clear: Float[np.ndarray, "points 2"]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where the operator stands, and unit vectors away from the drone and to the left of that."""
    away = clear[0] - (clear[1] if len(clear) > 1 else clear[0] - np.array([1.0, 0.0]))
    away = away / max(float(np.hypot(*away)), 1e-9)
    return clear[0], away, np.array([-away[1], away[0]])


def _beside(rng: np.random.Generator, count: int, clear: Float[np.ndarray, "points 2"]) -> Shapes:
    """Small things around the operator: beside them, or behind the ways on which people pass."""
    here, away, left = _sight(clear)
    groups: list[Shapes] = []
    placed: list[np.ndarray] = []
    for k in range(count):
        for _ in range(50):
            sign = rng.choice([-1.0, 1.0])
            if k % 2:
                off = rng.uniform(1.85, 2.25) * away + sign * rng.uniform(0.0, 2.4) * left
            else:
                off = rng.uniform(-0.3, 0.3) * away + sign * rng.uniform(0.85, 2.4) * left
            if all(np.linalg.norm(off - other) > 0.6 for other in placed):
                break
        else:
            continue
        placed.append(off)
        groups.append((_stool, _post, _bush)[k % 3](rng, here + off))
    return Shapes.joined(groups) if groups else _nothing()


def _stool(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    half = np.array([rng.uniform(0.16, 0.28), rng.uniform(0.16, 0.28), rng.uniform(0.22, 0.5)])
    paint = linear_rgb(str(rng.choice(["#a98157", "#8f8a80", "#4c6a86", "#7d2f2a", "#20242b"])))
    colours = np.array([paint, [0.5 * c for c in paint]])
    return Shapes.box(np.array([*spot, half[2]]), half, rng.uniform(0, np.pi), colours)


def _post(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    """A post with a sign: as tall and as slim as a person."""
    height = rng.uniform(1.5, 2.1)
    foot, top = np.array([*spot, 0.0]), np.array([*spot, height])
    grey = np.array([linear_rgb("#6f7478")] * 2)
    shaft = Shapes.capsules(foot[None], top[None], np.array([[0.05, 0.045]]), grey[None])
    sign = linear_rgb(str(rng.choice(["#b8322b", "#2b5fa8", "#d9d5cb", "#d3a92f"])))
    board = Shapes.box(
        np.array([*spot, height - 0.2]), np.array([0.04, 0.26, 0.2]), rng.uniform(-0.5, 0.5),
        np.array([sign, sign]), Surface.PLAIN,
    )  # fmt: skip
    return Shapes.joined([shaft, board])


def _bush(rng: np.random.Generator, spot: Float[np.ndarray, 2]) -> Shapes:
    n = 3
    size = rng.uniform(0.24, 0.36, n)
    centres = np.column_stack([spot + rng.normal(0, 0.12, (n, 2)), size * rng.uniform(0.6, 1.5, n)])
    colours = np.broadcast_to(np.array([linear_rgb("#2d4a30"), linear_rgb("#6f8f3f")]), (n, 2, 3))
    return Shapes.capsules(centres, centres, np.stack([size, size], axis=1), colours, Surface.LEAVES)


def _wall(config: SceneConfig, clear: Float[np.ndarray, "points 2"]) -> Shapes:
    if config.wall is None:
        return _nothing()
    here, away, _ = _sight(clear)
    spot = here + config.wall_behind_m * away
    colours = np.array([linear_rgb(config.wall)] * 2)
    half = np.array([0.1, 7.0, 1.7])
    heading = float(np.arctan2(away[1], away[0]))
    return Shapes.box(np.array([*spot, half[2]]), half, heading, colours, Surface.PLAIN)


def _nothing() -> Shapes:
    empty = np.zeros((0, 3))
    return Shapes.capsules(empty, empty, np.zeros((0, 2)), np.zeros((0, 2, 3)))


def _direction(rng: np.random.Generator) -> Float[np.ndarray, 2]:
    a = rng.uniform(-np.pi, np.pi)
    return np.array([np.cos(a), np.sin(a)])
