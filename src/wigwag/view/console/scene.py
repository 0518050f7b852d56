"""The page's 3-D scene: operator, drone, their paths, the fence. World frame ENU, metres."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.skeleton import BONES, LANDMARKS, Landmark
from wigwag.view.console.values import Figure, Flight, Snapshot
from wigwag.view.draw import bone_colors
from wigwag.view.places import circle, fence_lines, to_world

_OTHERS = (150, 158, 166)
_DRONE, _NOSE = (70, 140, 255), (255, 210, 60)
_FENCE, _NEAREST, _KEPT = (240, 90, 90), (240, 120, 80), (90, 200, 140)
_OPERATOR_PATH = (230, 150, 70)
_PATH_S, _PATH_STEP_M = 90.0, 0.12
_ARM_M = 0.28
STANDING = VehicleState(np.array([0.0, 0.0, 1.2]), np.zeros(3), 0.0, 0)
"""Where a camera is drawn that nothing is known of: level, at the height of a chest."""


class Scene:
    """Draws snapshots into a viser server's scene.

    Args:
        server: A ``viser.ViserServer``.
    """

    def __init__(self, server: Any) -> None:
        self._scene = scene = server.scene
        scene.set_up_direction("+z")
        scene.world_axes.visible = False
        scene.configure_environment_map(None)
        scene.add_light_ambient("/light", intensity=1.0)
        scene.add_grid(
            "/ground", 40.0, 40.0, cell_size=1.0, cell_color=(52, 58, 66), section_size=5.0,
            section_color=(86, 94, 104), shadow_opacity=0.0,
        )  # fmt: skip
        self._drone = scene.add_frame("/drone", show_axes=False)
        _add_drone(scene)
        self._camera: Any = None
        self._lines: dict[str, Any] = {}
        self._paths = {"drone": _Path(_DRONE), "operator": _Path(_OPERATOR_PATH)}
        self._limits: SupervisorConfig | None = None
        self._looked = False
        self._server = server

    def show(self, snapshot: Snapshot) -> None:
        """Draw a snapshot."""
        at = snapshot.seen_from or STANDING
        operator_m = None
        for number, figure in enumerate(snapshot.figures):
            world = None if figure.joints_m is None else to_world(figure.joints_m, at, snapshot.mount)
            self._figure(f"/people/{number}", figure, world)
            if figure.is_operator and world is not None:
                operator_m = world[[Landmark.LEFT_HIP, Landmark.RIGHT_HIP]].mean(axis=0)
        for name in [name for name in self._lines if name.startswith("/people/")]:
            if int(name.split("/")[2]) >= len(snapshot.figures):
                self._lines[name].visible = False
        self._eye(snapshot, at, operator_m)
        trodden = None if operator_m is None else operator_m * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.02]
        self._path("operator", trodden, snapshot.now_ns)
        flight = snapshot.flight
        if flight is None:
            self._drone.visible = False
            return
        self._fly(flight, operator_m)
        self._path("drone", np.asarray(flight.state.position_m, float), snapshot.now_ns)

    def _figure(self, name: str, figure: Figure, world: Float[np.ndarray, "13 3"] | None) -> None:
        if world is None:
            if name in self._lines:
                self._lines[name].visible = False
            return
        colors = bone_colors(BONES, LANDMARKS) if figure.is_operator else [_OTHERS] * len(BONES)
        self._segments(name, world[np.array(BONES)], _by_point(colors), 0.05)

    def _eye(self, snapshot: Snapshot, at: VehicleState, operator_m: Float[np.ndarray, " 3"] | None) -> None:
        """Draw the camera where it was, once its lens is known; let the first look be over its shoulder."""
        picture = snapshot.picture
        if self._camera is None:
            if picture is None:
                return
            aspect = picture.size_px[0] / picture.size_px[1]
            self._camera = self._scene.add_camera_frustum(
                "/camera", picture.fov_rad, aspect, scale=0.25, color=_NOSE, thickness=0.008,
                cast_shadow=False, receive_shadow=False,
            )  # fmt: skip
        body = rotation(at)
        self._camera.wxyz = quaternion(body @ _optical(snapshot.mount))
        self._camera.position = np.asarray(at.position_m) + body @ np.array(snapshot.mount.offset_m)
        if not self._looked and operator_m is not None:
            self._looked = True
            look_from_behind(self._server, np.asarray(at.position_m, float), operator_m)

    def _fly(self, flight: Flight, operator_m: Float[np.ndarray, " 3"] | None) -> None:
        state = flight.state
        position = np.asarray(state.position_m, float)
        self._drone.position, self._drone.wxyz = position, quaternion(rotation(state))
        foot = position * [1.0, 1.0, 0.0]
        self._segments("/height", np.array([[position, foot]]), np.array(_DRONE, np.uint8), 0.008)
        if operator_m is not None:
            for name, radius, color in (
                ("/nearest", flight.limits.min_distance_m, _NEAREST),
                ("/kept", flight.goal.distance_m, _KEPT),
            ):
                ring = circle((float(operator_m[0]), float(operator_m[1])), radius, 0.01)
                self._segments(name, ring, np.array(color, np.uint8), 0.02)
        if flight.limits != self._limits:
            self._limits = flight.limits
            walls = fence_lines(flight.limits.fence, flight.limits.ceiling_m)
            self._segments("/fence", walls, np.array(_FENCE, np.uint8), 0.03)

    def _path(self, name: str, at_m: Float[np.ndarray, " 3"] | None, now_ns: int) -> None:
        path = self._paths[name]
        if at_m is not None and path.add(at_m, now_ns):
            self._segments(f"/path/{name}", path.segments(), np.array(path.color, np.uint8), 0.015)

    def _segments(
        self, name: str, points: Float[np.ndarray, "lines 2 3"], colors: np.ndarray, thickness: float
    ) -> None:
        """Draw line segments under a name, in the place of those that were there."""
        handle = self._lines.get(name)
        points = points.astype(np.float32)
        if handle is None:
            self._lines[name] = self._scene.add_line_segments(name, points, colors, thickness=thickness)
            return
        if colors.ndim > 1 and not np.array_equal(handle.colors, colors):
            handle.colors = colors
        handle.points = points
        handle.visible = True


class _Path:
    """Where something has been: a point whenever it has moved by a little, forgotten after a while."""

    def __init__(self, color: tuple[int, int, int]) -> None:
        self.color = color
        self._points: deque[tuple[int, Float[np.ndarray, " 3"]]] = deque(maxlen=600)

    def add(self, at_m: Float[np.ndarray, " 3"], now_ns: int) -> bool:
        """Note a place; say whether there is something new to be drawn."""
        if self._points and float(np.linalg.norm(at_m - self._points[-1][1])) < _PATH_STEP_M:
            return False
        self._points.append((now_ns, at_m))
        while (now_ns - self._points[0][0]) * 1e-9 > _PATH_S:
            self._points.popleft()
        return len(self._points) > 1

    def segments(self) -> Float[np.ndarray, "lines 2 3"]:
        """Return the way as lines."""
        points = np.array([point for _, point in self._points])
        return np.stack([points[:-1], points[1:]], axis=1)


def quaternion(matrix: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, " 4"]:
    """Return a rotation as w, x, y, z.

    Example:
        >>> quaternion(np.eye(3)).tolist()
        [1.0, 0.0, 0.0, 0.0]
    """
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(matrix).as_quat()
    return np.array([w, x, y, z])


def look_from_behind(
    server: Any, drone_m: Float[np.ndarray, " 3"], operator_m: Float[np.ndarray, " 3"]
) -> None:
    """Let every browser that comes begin behind the drone and beside it, looking at the operator."""
    along = (operator_m - drone_m) * [1.0, 1.0, 0.0]
    along = along / max(float(np.linalg.norm(along)), 0.1)
    aside = np.array([-along[1], along[0], 0.0])
    middle = (drone_m + operator_m) / 2
    camera = server.initial_camera
    camera.look_at = middle * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.8]
    camera.position = middle * [1.0, 1.0, 0.0] - 5.5 * along + 4.0 * aside + [0.0, 0.0, 3.8]


def _optical(mount: Mount) -> Float[np.ndarray, "3 3"]:
    """Return the rotation that takes the camera's optical frame to the drone's body, FLU."""
    cos, sin = np.cos(mount.pitch_down_rad), np.sin(mount.pitch_down_rad)
    return np.array([[0.0, -sin, cos], [-1.0, 0.0, 0.0], [0.0, -cos, -sin]])


def _add_drone(scene: Any) -> None:
    """Four arms and four rotors in the body's frame; the front two in another colour."""
    arms, rotors, colors = [], [], []
    for ahead, left in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        tip = np.array([ahead, left, 0.0]) * _ARM_M / np.sqrt(2)
        color = _NOSE if ahead > 0 else _DRONE
        arms.append([np.zeros(3), tip])
        ring = circle((float(tip[0]), float(tip[1])), 0.13, 0.03)
        rotors.append(ring)
        colors += [color] * len(ring)
    scene.add_line_segments("/drone/arms", np.array(arms), np.array(_DRONE, np.uint8), thickness=0.04)
    scene.add_line_segments("/drone/rotors", np.concatenate(rotors), _by_point(colors), thickness=0.025)


def _by_point(colors: Sequence[tuple[int, int, int]]) -> UInt8[np.ndarray, "lines 2 3"]:
    """Return a colour a line as colours of its ends, which the page takes for amounts of light."""
    light = 255.0 * (np.array(colors, float) / 255.0) ** 2.2
    return np.repeat(light.astype(np.uint8)[:, None], 2, axis=1)


__all__ = ["STANDING", "Scene", "quaternion"]
