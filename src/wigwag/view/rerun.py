"""What the chain sees, in Rerun: picture, depth, people in space, timings, and what is said about them."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError, ViewError
from wigwag.extras import load
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.pilot import Step
from wigwag.pose.body import BODY_BONES
from wigwag.pose.estimator import Person
from wigwag.skeleton import BONES, LANDMARKS, Pose
from wigwag.view.draw import BODY_NAMES, Color, bone_colors
from wigwag.view.places import fence_lines, to_world

_OTHERS: Color = (150, 158, 166)
"""RGB of whoever is not the operator."""
_DRONE: Color = (70, 140, 255)
_FENCE: Color = (240, 90, 90)
_WAY_M = 0.1
"""So far the drone flies before its way is drawn anew."""
_JPEG_QUALITY = 80
_BONE_M = 0.012
_JOINT_M = 0.022


class RerunView:
    """Logs to Rerun what there is to see, under one blueprint for every command.

    The root is the camera's optical frame (x right, y down, z forward, metres); a flight has a root of its
    own, the world's frame (ENU). Time is the frames' stamps, and the loop's for a flight.

    Args:
        save: Write a ``.rrd`` file; open it later with ``rerun FILE``.
        spawn: Open the viewer in a window of its own. Needs a display.

    Raises:
        MissingExtraError: If ``rerun-sdk`` is not installed.
        InputError: If neither file nor viewer is asked for, or the file cannot be written.
        ViewError: If the viewer cannot be opened.
    """

    def __init__(self, save: Path | None = None, spawn: bool = True) -> None:
        if save is None and not spawn:
            raise InputError("RerunView needs a file to save to or a viewer to open.")
        rr = self._rr = load("rerun", "view", "The view in Rerun")
        self._stream = rr.RecordingStream("wigwag")
        if save is not None:
            try:
                save.parent.mkdir(parents=True, exist_ok=True)
                save.touch()  # what cannot be written is said now
            except OSError as error:
                raise InputError(f"{save}: cannot be written ({error.strerror}).") from error
        try:
            sinks: list[Any] = []
            if save is not None:
                sinks.append(rr.FileSink(str(save)))
            if spawn:
                rr.spawn(connect=False, hide_welcome_screen=True)
                sinks.append(rr.GrpcSink())
            self._stream.set_sinks(*sinks, default_blueprint=_blueprint())
        except (RuntimeError, OSError, ValueError) as error:
            raise ViewError(
                f"Rerun's viewer does not open ({error}). Without a display, save a file instead and open it "
                "elsewhere with: rerun FILE"
            ) from error
        self._lens: Intrinsics | None = None
        self._shown: set[int] = set()
        self._way: deque[Float[np.ndarray, " 3"]] = deque(maxlen=600)
        self._limits: SupervisorConfig | None = None
        self._stream.log("world", rr.ViewCoordinates.RDF, static=True)
        self._stream.log("flight", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def frame(self, frame: Frame) -> None:
        """Show a picture and its depth; what follows belongs to its stamp."""
        rr, stream = self._rr, self._stream
        stream.set_time("stamp", duration=frame.stamp_ns * 1e-9)
        if frame.intrinsics != self._lens:
            self._lens = lens = frame.intrinsics
            matrix = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]])
            pinhole = rr.Pinhole(
                image_from_camera=matrix,
                resolution=[lens.width, lens.height],
                camera_xyz=rr.ViewCoordinates.RDF,
                image_plane_distance=0.6,
            )
            stream.log("world/camera", pinhole, static=True)
        fine, jpeg = cv2.imencode(".jpg", frame.rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
        if fine:
            image = rr.EncodedImage(contents=jpeg.tobytes(), media_type="image/jpeg")
            stream.log("world/camera/rgb", image)
        if frame.depth_mm is not None:
            depth = rr.DepthImage(frame.depth_mm, meter=1000.0, depth_range=[500.0, 8000.0])
            stream.log("world/camera/depth", depth)

    def people(self, people: Sequence[Person]) -> None:
        """Show everybody in the picture and in space; whoever was there before and is not, vanishes."""
        here = set()
        for person in people:
            here.add(person.number)
            self._person(person)
        for gone in self._shown - here:
            for path in (f"world/people/{gone}", f"world/camera/people/{gone}"):
                self._stream.log(path, self._rr.Clear(recursive=True))
        self._shown = here

    def figures(self, figures: Mapping[str, float]) -> None:
        """Plot numbers of the moment, such as milliseconds by part."""
        for name, value in figures.items():
            if np.isfinite(value):
                self._stream.log(f"figures/{name}", self._rr.Scalars([float(value)]))

    def flight(self, step: Step, seen_from: VehicleState, mount: Mount, limits: SupervisorConfig) -> None:
        """Show a turn of a flight: drone, operator, way and fence in the world's frame, figures, decisions.

        Args:
            step: What the pilot made of it.
            seen_from: Where the drone was when the picture was taken.
            mount: How the camera sits on it.
            limits: What holds now.
        """
        rr, stream, now = self._rr, self._stream, step.situation
        stream.set_time("stamp", duration=now.now_ns * 1e-9)
        at = np.asarray(step.state.position_m, float)
        nose = rotation(step.state) @ np.array([0.4, 0.0, 0.0])
        stream.log("flight/drone", rr.Arrows3D(origins=[at], vectors=[nose], colors=[_DRONE], radii=0.03))
        if step.pose is not None:
            world = to_world(step.pose.joints, seen_from, mount)
            bones = rr.LineStrips3D(
                world[np.array(BONES)], colors=bone_colors(BONES, LANDMARKS), radii=_BONE_M
            )
            stream.log("flight/operator", bones)
        if not self._way or np.linalg.norm(at - self._way[-1]) > _WAY_M:
            self._way.append(at)
            stream.log("flight/way", rr.LineStrips3D([list(self._way)], colors=[_DRONE], radii=0.01))
        if limits != self._limits:
            self._limits = limits
            walls = fence_lines(limits.fence, limits.ceiling_m)
            stream.log("flight/fence", rr.LineStrips3D(walls, colors=[_FENCE], radii=0.02))
        self.figures(_figures(step))
        self._decisions(step)

    def _decisions(self, step: Step) -> None:
        gesture, verdict = step.gesture, step.verdict
        if gesture is not None and gesture.label is not None:
            self.say(f"{gesture.label.replace('_', ' ')} {gesture.confidence:.0%}")
        if verdict.row:
            self.say(f"{verdict.row}: {verdict.mode.replace('_', ' ')}")
        if verdict.reason:
            self.say(verdict.reason, alarming=True)

    def say(self, text: str, alarming: bool = False) -> None:
        """Write a line into the log: a gesture, a change of the camera's health."""
        rr = self._rr
        level = rr.TextLogLevel.WARN if alarming else rr.TextLogLevel.INFO
        self._stream.log("log", rr.TextLog(text, level=level))

    def close(self) -> None:
        """Write out what is pending."""
        self._stream.flush()
        self._stream.disconnect()

    def _person(self, person: Person) -> None:
        rr, stream = self._rr, self._stream
        flat, spatial = f"world/camera/people/{person.number}", f"world/people/{person.number}"
        if person.body is not None:
            colors = _colors(BODY_BONES, BODY_NAMES, person.is_operator)
            lines = person.body.points_px[np.array(BODY_BONES)]
            stream.log(f"{flat}/bones", rr.LineStrips2D(lines, colors=colors, radii=1.4))
        else:
            stream.log(flat, rr.Clear(recursive=True))
        if person.pose is None:
            stream.log(spatial, rr.Clear(recursive=True))
            return
        pose = person.pose
        colors = _colors(BONES, LANDMARKS, person.is_operator)
        stream.log(
            f"{spatial}/bones", rr.LineStrips3D(pose.joints[np.array(BONES)], colors=colors, radii=_BONE_M)
        )
        stream.log(
            f"{spatial}/joints", rr.Points3D(pose.joints, radii=_joint_radii(pose), colors=_shades(pose))
        )


def _figures(step: Step) -> dict[str, float]:
    """Return what is plotted of a turn of a flight."""
    state, sent = step.state, step.permit.setpoint
    forward, left, up = (np.nan,) * 3 if sent is None else sent.velocity_m_s
    return {
        "pose_ms": 1e3 * step.pose_s,
        "rest_ms": 1e3 * step.rest_s,
        "distance_m": np.nan if step.situation.distance_m is None else step.situation.distance_m,
        "height_m": float(state.position_m[2]),
        "battery": np.nan if state.battery is None else state.battery,
        "sent_forward_m_s": forward,
        "sent_left_m_s": left,
        "sent_up_m_s": up,
    }


def _joint_radii(pose: Pose) -> Float[np.ndarray, 13]:
    """A landmark is as large as its uncertainty, within what can be looked at."""
    return np.asarray(np.clip(pose.sigma_m, _JOINT_M, 0.12))


def _shades(pose: Pose) -> Float[np.ndarray, "13 4"]:
    """Landmarks that are hardly seen are nearly transparent."""
    white = np.full((len(pose.joints), 4), 255, np.uint8)
    white[:, 3] = (60 + 195 * np.clip(pose.visibility, 0, 1)).astype(np.uint8)
    return white


def _colors(bones: Sequence[tuple[int, int]], names: Sequence[str], operator: bool) -> list[Color]:
    if not operator:
        return [_OTHERS] * len(bones)
    return bone_colors(bones, names)


def _blueprint() -> Any:
    """Lay out every command's view: space on the left; picture, depth and figures on the right."""
    rrb = load("rerun.blueprint", "view", "The view in Rerun")
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Tabs(
                rrb.Spatial3DView(
                    origin="world", name="space", contents=["$origin/**", "- $origin/camera/depth"]
                ),
                rrb.Spatial3DView(origin="flight", name="flight"),
            ),
            rrb.Vertical(
                rrb.Spatial2DView(
                    origin="world/camera", name="picture", contents=["$origin/rgb", "$origin/people/**"]
                ),
                rrb.Spatial2DView(origin="world/camera", name="depth", contents=["$origin/depth"]),
                rrb.Tabs(
                    rrb.TimeSeriesView(origin="figures", name="figures"),
                    rrb.TextLogView(origin="log", name="log"),
                ),
            ),
            column_shares=[3, 2],
        ),
        collapse_panels=True,
    )
