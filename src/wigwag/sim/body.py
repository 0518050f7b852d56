"""A person of tapered capsules, hung on the twenty joints of a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from jaxtyping import Float

from wigwag.sim.paint import Look
from wigwag.sim.shapes import Shapes, Surface, linear_rgb
from wigwag.skeleton import KINECT20

_AT = {name: i for i, name in enumerate(KINECT20)}


class _Frame(IntEnum):
    """Which part of the body a shape turns with."""

    WORLD = 0
    CHEST = 1
    PELVIS = 2
    HEAD = 3
    LEFT_HAND = 4
    RIGHT_HAND = 5
    LEFT_FOOT = 6
    RIGHT_FOOT = 7


Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class _Part:
    """One shape of the body: ends as weighted joints plus an offset in its frame (forward, left, up)."""

    a: dict[str, float]
    b: dict[str, float]
    radii: tuple[float, float]
    colours: tuple[Vector, Vector]
    frame: _Frame = _Frame.WORLD
    a_offset: Vector = (0.0, 0.0, 0.0)
    b_offset: Vector = (0.0, 0.0, 0.0)
    stretch: Vector = (1.0, 1.0, 1.0)
    """Thickness along forward, left, up as a share of the radius; at most 1."""
    surface: Surface = Surface.PLAIN
    cut: float = 1.0


class BodyPainter:
    """Turns joints into shapes, for one look.

    Example:
        >>> import numpy as np
        >>> painter = BodyPainter(Look())
        >>> joints = np.zeros((20, 3))
        >>> joints[:, 2] = np.linspace(1.7, 0.0, 20)
        >>> len(painter(joints)) > 30
        True
    """

    def __init__(self, look: Look) -> None:
        self.look = look
        parts = _parts(look)
        n = len(parts)
        self._ends = np.zeros((2 * n, len(KINECT20)))
        self._offsets = np.zeros((2 * n, 3))
        for k, part in enumerate(parts):
            for row, weights, offset in ((k, part.a, part.a_offset), (n + k, part.b, part.b_offset)):
                for joint, weight in weights.items():
                    self._ends[row, _AT[joint]] = weight
                self._offsets[row] = offset
        self._frame = np.array([int(p.frame) for p in parts])
        self._thin = 1.0 / np.array([p.stretch for p in parts])
        self._radii = np.array([p.radii for p in parts])
        self._colours = np.array([p.colours for p in parts])
        self._surface = np.array([int(p.surface) for p in parts])
        self._cut = np.array([p.cut for p in parts])
        self._is_box = np.zeros(n, dtype=bool)

    def __call__(self, joints: Float[np.ndarray, "20 3"]) -> Shapes:
        """Place the body.

        Args:
            joints: Metres, world frame ENU, in the order of ``wigwag.skeleton.KINECT20``.
        """
        frames = body_frames(joints)[self._frame]
        turned = np.einsum("kj,kji->ki", self._offsets, np.concatenate([frames, frames]))
        ends = self._ends @ joints + turned
        n = len(self._frame)
        return Shapes(
            ends[:n], ends[n:], self._radii, frames * self._thin[:, :, None], self._is_box,
            self._surface, self._colours, self._cut,
        )  # fmt: skip


def body_frames(joints: Float[np.ndarray, "20 3"]) -> Float[np.ndarray, "8 3 3"]:
    """Orientation of world, chest, pelvis, head, hands and feet; rows forward, left, up (unit)."""
    j = {name: joints[i] for name, i in _AT.items()}
    across = j["left_shoulder"] - j["right_shoulder"]
    hips = j["left_hip"] - j["right_hip"]
    chest = _frame_of(up=j["shoulder_center"] - j["spine"], left=across)
    pelvis = _frame_of(up=j["spine"] - j["hip_center"], left=hips)
    # A skeleton does not say where its head looks: between where the shoulders and the hips face.
    head = _frame_of(up=j["head"] - j["shoulder_center"], left=_unit(across) + _unit(hips))
    frames = [np.eye(3), chest, pelvis, head]
    for side in ("left", "right"):
        along = j[f"{side}_hand"] - j[f"{side}_wrist"]
        # The palm's normal follows the chest; the part of "up" keeps it defined for a forward arm.
        frames.append(_frame_along(along, normal=chest[0] + 0.35 * chest[2]))
    for side in ("left", "right"):
        sole = j[f"{side}_foot"] - j[f"{side}_ankle"]
        shin = j[f"{side}_knee"] - j[f"{side}_ankle"]
        ahead = sole - (sole @ _unit(shin)) * 0.8 * _unit(shin) + 0.02 * pelvis[0]
        left = np.cross(_unit(shin) + 0.01 * chest[0], ahead)
        frames.append(_frame_of(up=shin, left=left, keep="left"))
    return np.stack(frames)


def _unit(v: Float[np.ndarray, 3]) -> Float[np.ndarray, 3]:
    return np.asarray(v / (np.sqrt(v @ v) + 1e-12))


def _frame_of(
    up: Float[np.ndarray, 3], left: Float[np.ndarray, 3], keep: str = "up"
) -> Float[np.ndarray, "3 3"]:
    """Right-handed frame near two directions; ``keep`` says which of the two is met exactly."""
    z, y = _unit(up + np.array([0.0, 0.0, 1e-9])), _unit(left + np.array([0.0, 1e-9, 0.0]))
    if keep == "up":
        y = _unit(y - (y @ z) * z)
    else:
        z = _unit(z - (z @ y) * y)
    return np.stack([np.cross(y, z), y, z])


def _frame_along(along: Float[np.ndarray, 3], normal: Float[np.ndarray, 3]) -> Float[np.ndarray, "3 3"]:
    """Frame of a hand: up runs to the finger tips, forward is the palm's normal."""
    z = _unit(along + np.array([0.0, 0.0, -1e-9]))
    x = _unit(normal - (normal @ z) * z)
    return np.stack([x, np.cross(z, x), z])


def _parts(look: Look) -> list[_Part]:
    """Every shape of a body 1.75 m tall, scaled to the look's height and girth."""
    s = look.height_m / 1.75
    g = s * look.girth
    skin, hair, shirt = (linear_rgb(c) for c in (look.skin, look.hair, look.shirt))
    trousers = linear_rgb(look.trousers)
    return [
        *_trunk(g, skin, shirt, linear_rgb(look.shirt_below or look.shirt), trousers),
        *_head(s, skin, hair, look),
        *(part for side in ("left", "right") for part in _arm(side, look)),
        *(part for side in ("left", "right") for part in _leg(side, look)),
    ]


def _trunk(g: float, skin: Vector, shirt: Vector, below: Vector, trousers: Vector) -> list[_Part]:
    chest, pelvis = _Frame.CHEST, _Frame.PELVIS
    belt = linear_rgb("#241d19")
    return [
        _Part(  # ribs
            {"spine": 0.8, "shoulder_center": 0.2}, {"spine": 0.15, "shoulder_center": 0.85},
            (0.138 * g, 0.154 * g), (shirt, shirt), chest, (0.005, 0.0, -0.05), (0.006, 0.0, -0.1),
            (0.7, 1.0, 1.0),
        ),
        _Part(  # belly
            {"hip_center": 0.5, "spine": 0.5}, {"spine": 0.9, "shoulder_center": 0.1},
            (0.139 * g, 0.137 * g), (below, below), pelvis, (0.008, 0.0, 0.04), (0.005, 0.0, 0.0),
            (0.71, 1.0, 1.0),
        ),
        _Part(  # chest from armpit to armpit
            {"left_shoulder": 0.76, "right_shoulder": 0.24}, {"left_shoulder": 0.24, "right_shoulder": 0.76},
            (0.09 * g, 0.09 * g), (shirt, shirt), chest, (0.004, 0.0, -0.03), (0.004, 0.0, -0.03),
            (0.86, 1.0, 1.0),
        ),
        *(
            _Part(  # slope from neck to shoulder
                {"shoulder_center": 1.0}, {f"{side}_shoulder": 1.0}, (0.066 * g, 0.056 * g),
                (shirt, shirt), chest, (-0.008, 0.0, -0.022), (0.0, 0.0, 0.016),
            )
            for side in ("left", "right")
        ),
        _Part(  # pelvis
            {"hip_center": 1.0}, {"left_hip": 0.5, "right_hip": 0.5}, (0.142 * g, 0.132 * g),
            (trousers, trousers), pelvis, (0.003, 0.0, -0.045), (-0.005, 0.0, 0.02), (0.73, 1.0, 1.0),
        ),
        _Part(  # hips
            {"left_hip": 1.0}, {"right_hip": 1.0}, (0.1 * g, 0.1 * g), (trousers, trousers), pelvis,
            (-0.005, -0.012, -0.01), (-0.005, 0.012, -0.01), (0.98, 1.0, 1.0),
        ),
        _Part(  # belt
            {"hip_center": 1.0}, {"hip_center": 1.0}, (0.146 * g, 0.146 * g), (belt, belt), pelvis,
            (0.005, 0.0, 0.035), (0.005, 0.0, 0.035), (0.73, 1.0, 0.16),
        ),
        _Part(  # neck
            {"shoulder_center": 1.0}, {"head": 0.6, "shoulder_center": 0.4}, (0.064 * g, 0.051 * g),
            (shirt, skin), chest, (0.0, 0.0, -0.01), (-0.01, 0.0, 0.0), cut=0.15,
        ),
        _Part(  # neckline, lower in front than behind: tells the two apart from afar
            {"shoulder_center": 1.0}, {"shoulder_center": 1.0}, (0.055 * g, 0.022 * g), (skin, skin), chest,
            (0.034 * g, 0.0, 0.002), (0.088 * g, 0.0, -0.085 * g), (0.7, 1.0, 1.0),
        ),
    ]  # fmt: skip


def _head(s: float, skin: Vector, hair: Vector, look: Look) -> list[_Part]:
    frame, at = _Frame.HEAD, {"head": 1.0}
    dark = (0.85 * skin[0], 0.85 * skin[1], 0.85 * skin[2])
    parts = [
        _Part(  # skull and chin, with the face on it
            at, at, (0.094 * s, 0.056 * s), (skin, hair), frame, (0.0, 0.0, 0.03 * s),
            (0.034 * s, 0.0, -0.072 * s), (1.0, 0.82, 1.0), Surface.FACE, float(look.beard),
        ),
        _Part(  # hair
            at, at, (0.1 * s, 0.1 * s), (hair, hair), frame, (-0.018 * s, 0.0, 0.046 * s),
            (-0.018 * s, 0.0, 0.046 * s), (1.0, 0.86, 0.92),
        ),
        _Part(  # nose
            at, at, (0.008 * s, 0.015 * s), (skin, skin), frame, (0.094 * s, 0.0, 0.012 * s),
            (0.099 * s, 0.0, -0.028 * s), (1.0, 0.85, 1.0),
        ),
    ]  # fmt: skip
    for side in (1.0, -1.0):
        ear = (0.0, side * 0.074 * s, -0.004 * s)
        parts.append(_Part(at, at, (0.032 * s, 0.032 * s), (dark, dark), frame, ear, ear, (0.6, 0.35, 1.0)))
    if look.long_hair:
        parts.append(
            _Part(
                at, at, (0.092 * s, 0.075 * s), (hair, hair), frame, (-0.045 * s, 0.0, 0.02 * s),
                (-0.06 * s, 0.0, -0.15 * s), (0.75, 1.0, 1.0),
            )
        )  # fmt: skip
    return parts


def _arm(side: str, look: Look) -> list[_Part]:
    s = look.height_m / 1.75
    g = s * look.girth
    skin, shirt = linear_rgb(look.skin), linear_rgb(look.shirt)
    shoulder, elbow, wrist, hand = (f"{side}_{j}" for j in ("shoulder", "elbow", "wrist", "hand"))
    frame = _Frame.LEFT_HAND if side == "left" else _Frame.RIGHT_HAND
    thumb = -0.03 * s if side == "left" else 0.03 * s
    return [
        _Part({shoulder: 1.0}, {shoulder: 1 - look.sleeve, elbow: look.sleeve}, (0.058 * g, 0.051 * g),
              (shirt, shirt)),
        _Part({shoulder: 1.0}, {elbow: 1.0}, (0.046 * g, 0.038 * g), (skin, skin)),
        _Part({elbow: 1.0}, {elbow: 0.7, wrist: 0.3}, (0.038 * g, 0.039 * g), (skin, skin)),
        _Part({elbow: 0.7, wrist: 0.3}, {wrist: 1.0}, (0.039 * g, 0.026 * g), (skin, skin)),
        _Part({wrist: 1.0}, {hand: 1.0}, (0.032 * s, 0.042 * s), (skin, skin), frame,
              stretch=(0.6, 1.0, 1.0)),
        _Part({hand: 1.0}, {hand: 1.0}, (0.04 * s, 0.028 * s), (skin, skin), frame,
              b_offset=(0.0, 0.0, 0.075 * s), stretch=(0.45, 1.0, 1.0)),
        _Part({wrist: 0.4, hand: 0.6}, {hand: 1.0}, (0.014 * s, 0.011 * s), (skin, skin), frame,
              (0.0, thumb, 0.0), (0.0, 1.9 * thumb, 0.03 * s)),
    ]  # fmt: skip


def _leg(side: str, look: Look) -> list[_Part]:
    s = look.height_m / 1.75
    g = s * look.girth
    skin, trousers, shoes = (linear_rgb(c) for c in (look.skin, look.trousers, look.shoes))
    hip, knee, ankle, foot = (f"{side}_{j}" for j in ("hip", "knee", "ankle", "foot"))
    frame = _Frame.LEFT_FOOT if side == "left" else _Frame.RIGHT_FOOT
    sole = linear_rgb("#f2f0ea")
    lower = skin if look.shorts else trousers
    calf = 1.0 if look.shorts else 1.12
    parts = [
        _Part({hip: 1.0}, {knee: 1.0}, (0.092 * g, 0.06 * g), (trousers, lower), cut=0.82),
        _Part({knee: 1.0}, {knee: 0.7, ankle: 0.3}, (0.057 * g, 0.057 * g * calf), (lower, lower)),
        _Part({knee: 0.7, ankle: 0.3}, {knee: 0.06, ankle: 0.94}, (0.057 * g * calf, 0.042 * g * calf),
              (lower, lower)),
        _Part({ankle: 0.55, foot: 0.45}, {foot: 1.0}, (0.048 * s, 0.04 * s), (shoes, sole), frame,
              (0.0, 0.0, -0.01), (0.025 * s, 0.0, 0.0), (1.0, 1.0, 0.9), Surface.SHOE),
        _Part({ankle: 1.0}, {ankle: 0.55, foot: 0.45}, (0.047 * s, 0.046 * s), (shoes, sole), frame,
              (-0.035 * s, 0.0, -0.035 * s), (0.0, 0.0, -0.01), (1.0, 0.9, 1.0), Surface.SHOE),
    ]  # fmt: skip
    if look.shorts:
        parts.append(_Part({hip: 1.0}, {hip: 0.25, knee: 0.75}, (0.096 * g, 0.085 * g), (trousers, trousers)))
    return parts
