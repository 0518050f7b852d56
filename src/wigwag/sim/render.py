"""A picture with depth of people in the open, drawn on one core without OpenGL."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8, UInt16

from wigwag.camera.frame import Intrinsics
from wigwag.sim.backdrop import backdrop, shadows
from wigwag.sim.body import BodyPainter
from wigwag.sim.paint import Look
from wigwag.sim.raycast import COLUMNS, cast, place
from wigwag.sim.scene import Scene
from wigwag.sim.shade import resolve, tone_curve
from wigwag.sim.shapes import Shapes

_LENS = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
"""Body FLU directions into camera optical ones: right, down, forward."""


@dataclass(frozen=True, slots=True)
class CameraPose:
    """Where a camera is and how it is turned."""

    position_m: Float[np.ndarray, 3]
    """World frame ENU."""
    rotation: Float[np.ndarray, "3 3"]
    """World directions into the camera optical frame (x right, y down, z forward)."""

    @classmethod
    def on_body(
        cls,
        position_m: Float[np.ndarray, 3],
        rotation: Float[np.ndarray, "3 3"],
        offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
        tilt_down_rad: float = 0.0,
    ) -> CameraPose:
        """Mount a camera rigidly on a body.

        Args:
            position_m: The body's, world frame ENU.
            rotation: Body FLU directions into the world.
            offset_m: Where the lens sits, body FLU.
            tilt_down_rad: How far it looks below the body's forward axis.

        Example:
            >>> import numpy as np
            >>> pose = CameraPose.on_body(np.zeros(3), np.eye(3))
            >>> pose.to_camera(np.array([4.0, 1.0, 0.5])).tolist()  # ahead, to the left, above
            [-1.0, -0.5, 4.0]
        """
        c, s = np.cos(tilt_down_rad), np.sin(tilt_down_rad)
        tilt = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
        world_from_body = np.asarray(rotation, dtype=float)
        return cls(
            np.asarray(position_m, float) + world_from_body @ np.asarray(offset_m),
            _LENS @ tilt @ world_from_body.T,
        )

    @classmethod
    def looking(
        cls, position_m: Float[np.ndarray, 3], heading_rad: float, tilt_down_rad: float = 0.0
    ) -> CameraPose:
        """Build the pose of a level camera that looks along a heading (anticlockwise from east)."""
        c, s = np.cos(heading_rad), np.sin(heading_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return cls.on_body(position_m, turn, tilt_down_rad=tilt_down_rad)

    def to_camera(self, points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 3"]:
        """Bring world points into the camera optical frame, metres."""
        return np.asarray((np.asarray(points) - self.position_m) @ self.rotation.T)

    def to_world(self, points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 3"]:
        """Bring camera optical points into the world frame, metres."""
        return np.asarray(np.asarray(points) @ self.rotation + self.position_m)


class Renderer:
    """Draws a scene with people in it.

    One thread, no display, no OpenGL: every solid is met by rays inside its own box on the screen. The
    kernels compile at the first picture and are kept on disk.

    Args:
        intrinsics: Of the camera.
        scene: What stands around; a bare field if ``None``.
    """

    def __init__(self, intrinsics: Intrinsics | None = None, scene: Scene | None = None) -> None:
        self.intrinsics = k = intrinsics or Intrinsics()
        self.scene = scene or Scene()
        self._camera = np.array([k.fx, k.fy, k.cx, k.cy, k.width, k.height], dtype=np.float64)
        self._tones = tone_curve()
        self._nearest = np.empty((k.height, k.width), np.float32)
        self._seen = np.empty((k.height, k.width), np.int16)
        self._cover = np.empty((k.height, k.width), np.float32)
        self._painters: dict[Look, BodyPainter] = {}

    def render(
        self, camera: CameraPose, people: Sequence[tuple[Float[np.ndarray, "20 3"], Look]]
    ) -> tuple[UInt8[np.ndarray, "height width 3"], UInt16[np.ndarray, "height width"]]:
        """Draw one picture.

        Args:
            camera: Where it is taken from.
            people: For each, joints (metres, world frame ENU, the order of ``KINECT20``) and look.

        Returns:
            Colour, and depth along the optical axis in millimetres with 0 where there is none (sky and
            whatever is beyond 65 m). Both are new arrays.
        """
        return self.render_shapes(camera, [self._painter(look)(joints) for joints, look in people])

    def render_shapes(
        self, camera: CameraPose, solids: Sequence[Shapes]
    ) -> tuple[UInt8[np.ndarray, "height width 3"], UInt16[np.ndarray, "height width"]]:
        """Draw any solids, which throw shadows, in front of the scene; see ``render``."""
        k, scene = self.intrinsics, self.scene
        position = np.ascontiguousarray(camera.position_m, dtype=np.float64)
        rotation = np.ascontiguousarray(camera.rotation, dtype=np.float64)
        all_of = Shapes.joined([*solids, scene.shapes])
        placed = np.empty((len(all_of), COLUMNS))
        boxes = np.empty((len(all_of), 4), np.int64)
        rgb = np.empty((k.height, k.width, 3), np.uint8)
        depth = np.empty((k.height, k.width), np.uint16)
        place(
            all_of.a, all_of.b, all_of.radii, all_of.maps, all_of.paint, position, rotation,
            self._camera, placed, boxes,
        )  # fmt: skip
        cast(placed, boxes, self._camera, self._nearest, self._seen)
        backdrop(
            rgb, depth, self._camera, position, rotation, scene.ground.texels, scene.ground.starts,
            scene.ground.texel_m, scene.levels, scene.patches, scene.sky, scene.clouds, scene.skyline,
        )  # fmt: skip
        # A box throws the shadow of a ball that is somewhat smaller than the one around it.
        thick = all_of.radii * np.where(all_of.is_box, 0.62, 1.0)[:, None]
        shadows(
            rgb, depth, self._camera, position, rotation, all_of.a, all_of.b, thick, scene.sun, self._cover
        )
        light = np.concatenate([rotation @ scene.sun, rotation[:, 2], scene.strengths])
        resolve(
            rgb, depth, self._nearest, self._seen, boxes, self._camera, placed, rotation, position, light,
            scene.leaves, self._tones,
        )  # fmt: skip
        return rgb, depth

    def _painter(self, look: Look) -> BodyPainter:
        if look not in self._painters:
            self._painters[look] = BodyPainter(look)
        return self._painters[look]
