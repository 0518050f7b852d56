"""What was found in the picture becomes a pose in space: by depth, or, without any, by the body's size."""

from __future__ import annotations

from typing import Literal

from wigwag.camera.frame import Frame
from wigwag.pose.body import Body
from wigwag.pose.lift import LiftConfig, Lifter
from wigwag.pose.monocular import MonocularConfig, MonocularPlacer
from wigwag.skeleton import Pose, from_blazepose33


class InSpace:
    """Puts bodies of one camera into space. It remembers nothing: any number of people may share it.

    Args:
        lift: How landmarks get their depth.
        monocular: How they are placed without.
        head: What the first landmark is; see ``from_blazepose33``.
    """

    def __init__(
        self,
        lift: LiftConfig | None = None,
        monocular: MonocularConfig | None = None,
        head: Literal["ears", "nose"] = "ears",
    ) -> None:
        self._lifter = Lifter(lift or LiftConfig())
        self._placer = MonocularPlacer(monocular)
        self._head = head

    def __call__(self, body: Body, frame: Frame) -> Pose | None:
        """Return the body's pose, or ``None`` if it cannot be told where it stands.

        A frame whose ``depth_mm`` is ``None`` comes from a camera without depth and is placed by the body's
        size. A frame that has a depth picture without any depth at the body is a fault of a camera that has
        depth, and gives no pose, unless ``MonocularConfig.when_depth_fails`` says otherwise: whoever set up a
        depth camera counts on centimetres, and must not be handed decimetres without a word.

        Args:
            body: What the network says; its pixels must be finite.
            frame: The picture it was found in.
        """
        if frame.depth_mm is not None:
            points = from_blazepose33(body.points_px, self._head)
            visibility = from_blazepose33(body.visibility[:, None], self._head)[:, 0]
            lifted = self._lifter(points, visibility, frame.depth_mm, frame.intrinsics)
            if lifted is not None:
                return Pose(lifted.points_m, lifted.visibility, frame.stamp_ns, lifted.sigma_m)
            if not self._placer.config.when_depth_fails:
                return None
        placed = self._placer(body, frame.intrinsics, self._head)
        if placed is None:
            return None
        return Pose(
            placed.points_m,
            placed.visibility,
            frame.stamp_ns,
            placed.sigma_m,
            placed.distance_sigma_m,
            monocular=True,
        )


__all__ = ["InSpace"]
