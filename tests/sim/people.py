"""A standing person for the tests of the renderer: arms as asked, sizes of a Kinect's skeleton."""

import numpy as np

from wigwag.skeleton import KINECT20

AT = {name: i for i, name in enumerate(KINECT20)}

DOWN = ((0.0, 0.15, -1.0), (0.1, 0.05, -1.0))
SIDE = ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
UP = ((0.0, 0.25, 1.0), (0.0, 0.0, 1.0))
AHEAD = ((1.0, 0.05, 0.0), (1.0, -0.05, 0.0))

ARMS = {
    "down": (DOWN, DOWN), "left side": (SIDE, DOWN), "right side": (DOWN, SIDE), "tee": (SIDE, SIDE),
    "up": (UP, UP), "left up": (UP, DOWN), "right up": (DOWN, UP),
    "vee": (((0, 1, 1), (0, 1, 1)),) * 2, "cactus": (((0, 1, 0), (0, 0, 1)),) * 2,
    "hanging forearms": (((0, 1, 0), (0, 0, -1)),) * 2, "ahead": (AHEAD, AHEAD),
    "left ahead": (AHEAD, DOWN), "right ahead": (DOWN, AHEAD),
    "palm ahead": (DOWN, ((0.6, 0.1, -0.3), (0.5, 0, 1))),
    "crossed": (((0.35, 0.1, -0.9), (0.55, -0.9, 0.3)),) * 2,
    "on the hips": (((-0.05, 0.55, -0.85), (0.6, -0.64, -0.3)),) * 2,
    "over the head": (((0.1, 0.35, 1), (0.1, -0.7, 0.8)),) * 2,
    "low vee": (((0, 0.8, -1), (0, 0.8, -1)),) * 2,
}  # fmt: skip
"""Directions of upper arm and forearm (forward, outward, up), left then right arm."""


def standing(arms="down", at=(4.0, 0.0), heading_rad=np.pi):
    """Joints (20, 3) of a person 1.75 m tall, metres, world ENU."""
    joints = np.zeros((20, 3))
    trunk = {"hip_center": 0.978, "spine": 1.058, "shoulder_center": 1.408, "head": 1.598}
    for name, height in trunk.items():
        joints[AT[name]] = (0.0, 0.0, height)
    for side, sign, directions in zip(("left", "right"), (1, -1), ARMS[arms], strict=True):
        out = np.array([1, sign, 1])
        upper, fore = (np.array(d, float) / np.linalg.norm(d) * out for d in directions)
        shoulder = joints[AT["shoulder_center"]] + (0, sign * 0.175, -0.096)
        elbow = shoulder + 0.284 * upper
        wrist = elbow + 0.249 * fore
        hip, ankle = np.array([0, sign * 0.077, 0.901]), np.array([-0.01, sign * 0.11, 0.079])
        for name, point in {
            "shoulder": shoulder, "elbow": elbow, "wrist": wrist, "hand": wrist + 0.079 * fore, "hip": hip,
            "knee": (hip + ankle) / 2 + np.array([0.02, 0, 0]), "ankle": ankle,
            "foot": ankle + np.array([0.12, sign * 0.03, -0.04]),
        }.items():  # fmt: skip
            joints[AT[f"{side}_{name}"]] = point
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    return joints @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (*at, 0.0)
