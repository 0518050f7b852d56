"""Joint angles become joint positions: the operator's channels and their forward kinematics.

A moment of the body is a row of ``CHANNELS``: how the pelvis, trunk and head deviate from standing, and
for each arm where it points. The legs follow by inverse kinematics from where the feet stand.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from jaxtyping import Float

from wigwag.sim.person import JOINT, TREE, Person

_TRUNK = (
    "pelvis_forward", "pelvis_left", "pelvis_down", "pelvis_yaw",
    "lean_forward", "lean_left", "twist", "nod", "tilt",
)  # fmt: skip
_LIMB = ("shrug", "raise", "forward", "bend", "roll", "swing", "foot_forward", "foot_out", "foot_up")

CHANNELS: tuple[str, ...] = (
    *_TRUNK,
    *(f"left_{name}" for name in _LIMB),
    *(f"right_{name}" for name in _LIMB),
)
"""Names of a moment's numbers. ``pelvis_forward|left|down`` and ``foot_*`` are metres, the rest radians.

``raise``: the upper arm's angle from hanging (0) over level (pi/2) to overhead (pi). ``forward``: the
direction in which it is raised, 0 sideways, pi/2 to the front. ``bend``: the elbow, 0 straight. ``roll``:
where the forearm bends to; 0 to the front, negative outward (upward when the arm is level), positive
inward. ``swing``: the whole arm forward about the shoulders' axis. ``twist`` turns the chest left.
"""

CHANNEL: dict[str, int] = {name: i for i, name in enumerate(CHANNELS)}
"""Index of each channel by name."""

METRES: Final = frozenset(
    name for name in CHANNELS if "foot_" in name or name in {"pelvis_forward", "pelvis_left", "pelvis_down"}
)
"""Channels in metres; the others are angles."""

_PELVIS_SHARE = 0.3
"""How much of a lean the pelvis takes; the lower spine takes 0.65 and the chest all."""


def rest(person: Person) -> Float[np.ndarray, " channels"]:
    """Return the channels of standing with the arms hanging."""
    row = np.zeros(len(CHANNELS))
    for side in ("left", "right"):
        row[CHANNEL[f"{side}_raise"]] = person.rest_raise_rad
        row[CHANNEL[f"{side}_forward"]] = 0.25
        row[CHANNEL[f"{side}_bend"]] = person.rest_bend_rad
        row[CHANNEL[f"{side}_roll"]] = 0.35
    return row


def _turn(axis: int, angle: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 3 3"]:
    """Rotation matrices about x (0), y (1) or z (2)."""
    c, s = np.cos(angle), np.sin(angle)
    out = np.zeros((len(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    out[:, axis, axis] = 1
    out[:, i, i] = out[:, j, j] = c
    out[:, i, j], out[:, j, i] = -s, s
    return out


def _apply(rotation: Float[np.ndarray, "n 3 3"], vector: Float[np.ndarray, "... 3"]) -> np.ndarray:
    """Rotate one vector, or one vector a row."""
    return np.asarray((rotation @ np.broadcast_to(vector, (len(rotation), 3))[..., None])[..., 0])


def _unit(vector: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    return np.asarray(vector / np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), 1e-9))


def _arm(
    row: Float[np.ndarray, "n channels"], side: str, sign: float
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Directions of upper arm and forearm in the chest's frame (x forward, y left, z up)."""
    lift, ahead, bend, roll, swing = (
        row[:, CHANNEL[f"{side}_{name}"]] for name in ("raise", "forward", "bend", "roll", "swing")
    )
    zero = np.zeros_like(lift)
    out = np.stack([np.sin(ahead), sign * np.cos(ahead), zero], axis=1)  # where the arm is raised to
    up = np.array([0.0, 0.0, 1.0])
    upper = np.sin(lift)[:, None] * out - np.cos(lift)[:, None] * up
    # The forearm's bending direction of a hanging arm, carried along by the smallest turn that takes
    # 'hanging' to 'raised'.
    hanging = np.stack([np.cos(roll), -sign * np.sin(roll), zero], axis=1)
    along = np.sum(hanging * out, axis=1, keepdims=True)
    bending = hanging + along * ((np.cos(lift)[:, None] - 1) * out + np.sin(lift)[:, None] * up)
    fore = np.cos(bend)[:, None] * upper + np.sin(bend)[:, None] * bending
    pitch = _turn(1, -swing)
    return _apply(pitch, upper), _apply(pitch, fore)


def _leg(
    hip: Float[np.ndarray, "n 3"],
    ankle: Float[np.ndarray, "n 3"],
    pole: Float[np.ndarray, "n 3"],
    person: Person,
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Knee and ankle of a two-bone leg; an ankle out of reach is pulled towards the hip (heel off)."""
    thigh, shin = person.thigh_m, person.shin_m
    span = ankle - hip
    distance = np.linalg.norm(span, axis=1)
    reach = np.clip(distance, abs(thigh - shin) + 1e-3, 0.9985 * (thigh + shin))
    direction = span / np.maximum(distance, 1e-9)[:, None]
    along = (thigh**2 - shin**2 + reach**2) / (2 * reach)
    aside = np.sqrt(np.maximum(thigh**2 - along**2, 0))
    pole = _unit(pole - np.sum(pole * direction, axis=1, keepdims=True) * direction)
    knee = hip + along[:, None] * direction + aside[:, None] * pole
    return knee, hip + reach[:, None] * direction


def pose_body(
    person: Person,
    channels: Float[np.ndarray, "n channels"],
    root_xy: Float[np.ndarray, "n 2"],
    heading_rad: Float[np.ndarray, " n"],
    feet: Float[np.ndarray, "n 2 4"],
) -> Float[np.ndarray, "n 20 3"]:
    """Pose the body: one row of output a row of channels.

    Args:
        person: Whose body.
        channels: One row a moment, as named by ``CHANNELS``.
        root_xy: Where the person stands, metres, world ENU.
        heading_rad: Where the person faces, anticlockwise from east.
        feet: For the left and right foot x, y and height above flat standing (metres, world ENU), and yaw.

    Returns:
        Kinect-20 joints, metres, world ENU, the ground at z = 0.
    """
    joints = np.zeros((len(channels), 20, 3))
    facing = _turn(2, heading_rad)
    pelvis, chest = _place_trunk(joints, channels, person, root_xy, heading_rad)
    for index, (side, sign) in enumerate((("left", 1.0), ("right", -1.0))):
        _place_arm(joints, channels, person, chest, side=side, sign=sign)
        frames = (pelvis, facing, heading_rad)
        _place_leg(joints, channels, person, frames, feet[:, index], side=side, sign=sign)
    return joints


def _place_trunk(
    joints: np.ndarray,
    channels: np.ndarray,
    person: Person,
    root_xy: Float[np.ndarray, "n 2"],
    heading: Float[np.ndarray, " n"],
) -> tuple[Float[np.ndarray, "n 3 3"], Float[np.ndarray, "n 3 3"]]:
    """Write hip centre, spine, shoulder centre and head; return the turns of pelvis and chest."""
    get = {name: channels[:, CHANNEL[name]] for name in _TRUNK}
    yaw, twist = _turn(2, heading + get["pelvis_yaw"]), _turn(2, get["twist"])

    def leaning(share: float, nod: float | np.ndarray = 0.0, tilt: float | np.ndarray = 0.0) -> np.ndarray:
        forward, left = share * get["lean_forward"] + nod, share * get["lean_left"] + tilt
        return np.asarray(_turn(1, forward) @ _turn(0, -left))

    pelvis = yaw @ leaning(_PELVIS_SHARE)
    chest = yaw @ twist @ leaning(1.0)
    shift = np.stack([get["pelvis_forward"], get["pelvis_left"], np.zeros(len(channels))], axis=1)
    root = np.column_stack([root_xy, person.hip_center_height_m - get["pelvis_down"]])
    root = root + _apply(_turn(2, heading), shift)
    spine = root + _apply(yaw @ leaning(0.65), np.array([0, 0, person.spine_m]))
    neck = spine + _apply(chest, np.array([0, 0, person.chest_m]))
    head = yaw @ twist @ leaning(0.7, get["nod"], get["tilt"])
    joints[:, JOINT["hip_center"]] = root
    joints[:, JOINT["spine"]] = spine
    joints[:, JOINT["shoulder_center"]] = neck
    # The middle of the head lies a little in front of the neck.
    joints[:, JOINT["head"]] = neck + person.neck_m * _apply(head, np.array([np.sin(0.1), 0, np.cos(0.1)]))
    return pelvis, chest


def _place_arm(
    joints: np.ndarray, channels: np.ndarray, person: Person, chest: np.ndarray, *, side: str, sign: float
) -> None:
    """Write one arm into ``joints``; the shoulder rises with an arm that is raised above level."""
    lift = channels[:, CHANNEL[f"{side}_raise"]]
    # Softplus: the collar bone begins to follow at about 70 degrees and takes a quarter of the rest.
    follow = 0.25 * 0.2 * np.log1p(np.exp((lift - 1.2) / 0.2))
    collar = _turn(0, sign * (channels[:, CHANNEL[f"{side}_shrug"]] + follow))
    base = np.array([0, sign * person.shoulder_half_m, -person.shoulder_drop_m])
    upper, fore = _arm(channels, side, sign)
    point = joints[:, JOINT["shoulder_center"]] + _apply(chest @ collar, base)
    joints[:, JOINT[f"{side}_shoulder"]] = point
    for name, length, direction in (
        ("elbow", person.upper_arm_m, upper),
        ("wrist", person.forearm_m, fore),
        ("hand", person.hand_m, fore),
    ):
        point = point + length * _apply(chest, direction)
        joints[:, JOINT[f"{side}_{name}"]] = point


def _place_leg(
    joints: np.ndarray,
    channels: np.ndarray,
    person: Person,
    frames: tuple[np.ndarray, np.ndarray, np.ndarray],
    foot: Float[np.ndarray, "n 4"],
    *,
    side: str,
    sign: float,
) -> None:
    """Write one leg into ``joints``; ``frames``: turns of pelvis and heading, and the heading (rad)."""
    pelvis, facing, heading = frames
    get = {name: channels[:, CHANNEL[f"{side}_foot_{name}"]] for name in ("forward", "out", "up")}
    hip = joints[:, JOINT["hip_center"]] + _apply(
        pelvis, np.array([0, sign * person.hip_half_m, -person.hip_drop_m])
    )
    offset = np.stack([get["forward"], sign * get["out"], get["up"]], axis=1)
    ankle = np.column_stack([foot[:, :2], person.ankle_height_m + foot[:, 2]]) + _apply(facing, offset)
    # Knees bend to where pelvis and foot look, and a little outward.
    yaw = heading + 0.5 * (foot[:, 3] - heading) + sign * 0.12
    pole = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=1)
    knee, ankle = _leg(hip, ankle, pole, person)
    joints[:, JOINT[f"{side}_hip"]] = hip
    joints[:, JOINT[f"{side}_knee"]] = knee
    joints[:, JOINT[f"{side}_ankle"]] = ankle
    # The toes stay on the ground while they reach it, then hang at up to 50 degrees.
    toe_drop = ankle[:, 2] - 0.35 * person.ankle_height_m
    sine = np.clip(toe_drop / person.foot_m, 0.0, 0.77)
    level = np.sqrt(1 - sine**2)
    toe = np.stack([np.cos(foot[:, 3]) * level, np.sin(foot[:, 3]) * level, -sine], axis=1)
    joints[:, JOINT[f"{side}_foot"]] = ankle + person.foot_m * toe


def blend(
    first: Float[np.ndarray, "20 3"], second: Float[np.ndarray, "20 3"], weight: float
) -> Float[np.ndarray, "20 3"]:
    """Go from one body to another on arcs: bones turn and their lengths change evenly.

    Args:
        first: Kinect-20 joints at weight 0, metres.
        second: Kinect-20 joints at weight 1, metres, same frame.
        weight: 0 to 1.
    """
    root = JOINT["hip_center"]
    out = np.empty_like(first)
    out[root] = (1 - weight) * first[root] + weight * second[root]
    for child, parent in TREE:
        a, b = first[child] - first[parent], second[child] - second[parent]
        la, lb = float(np.linalg.norm(a)), float(np.linalg.norm(b))
        u, v = a / max(la, 1e-9), b / max(lb, 1e-9)
        angle = float(np.arccos(np.clip(u @ v, -1, 1)))
        if angle < 1e-4 or angle > np.pi - 1e-4:  # parallel: no arc; opposite: none is better than another
            direction = (1 - weight) * u + weight * v
        else:
            direction = (np.sin((1 - weight) * angle) * u + np.sin(weight * angle) * v) / np.sin(angle)
        out[child] = out[parent] + ((1 - weight) * la + weight * lb) * direction
    return out
