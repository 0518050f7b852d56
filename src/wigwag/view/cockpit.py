"""One picture of the moment: what the camera sees, how deep it is, and where everybody is."""

from __future__ import annotations

from collections import deque

import cv2
import numpy as np
from jaxtyping import UInt8, UInt16

from wigwag.evaluate.session import Turn
from wigwag.pose.body import Body
from wigwag.view.draw import draw_banner, draw_body

Picture = UInt8[np.ndarray, "height width 3"]

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_PAPER, _INK, _GRID = (245, 248, 249), (34, 48, 58), (222, 230, 234)
_DRONE, _OPERATOR = (43, 108, 176), (217, 121, 43)
_GREEN, _GREY = (26, 158, 108), (143, 163, 173)


class Cockpit:
    """Composes pictures of 960x480: the camera's on the left; depth and map on the right.

    Args:
        span_m: Width of the map, metres.
        keep_s: How long a gesture stands in the banner.
    """

    def __init__(self, span_m: float = 11.0, keep_s: float = 2.0) -> None:
        self.span_m, self.keep_s = span_m, keep_s
        self._drone: deque[tuple[float, float]] = deque(maxlen=900)
        self._operator: deque[tuple[float, float]] = deque(maxlen=900)
        self._said: tuple[float, str, tuple[int, int, int]] = (-1e9, "", _GREY)

    def note(self, turn: Turn) -> None:
        """Take in a turn of the loop; call it for every one, drawn or not."""
        self._drone.append(turn.row.drone_m[:2])
        self._operator.append(turn.row.operator_m[:2])
        gesture = turn.step.gesture
        if gesture is None:
            return
        if gesture.label is None:
            self._said = (turn.row.time_s, "not a gesture I know", _GREY)
        else:
            name = gesture.label.replace("_", " ")
            self._said = (turn.row.time_s, f"{name}  {gesture.confidence:.0%}", _GREEN)

    def draw(self, turn: Turn, body: Body | None) -> Picture:
        """Draw the moment of ``turn``.

        Args:
            turn: Frame, decisions and state.
            body: What the pose network sees in the frame.
        """
        view = turn.frame.rgb.copy()
        if body is not None:
            draw_body(view, body)
        at_s, text, colour = self._said
        if turn.row.time_s - at_s > self.keep_s:
            text, colour = turn.row.mode.replace("_", " "), _GREY
        goal = turn.step.goal
        detail = f"{turn.row.time_s:5.1f} s   keeps {goal.distance_m:.1f} m, {goal.altitude_m:.1f} m high"
        draw_banner(view, text, detail, colour)
        height = view.shape[0]
        side = np.empty((height, height * 2 // 3, 3), np.uint8)
        half = height // 2
        if turn.frame.depth_mm is not None:
            side[:half] = cv2.resize(_false_colour(turn.frame.depth_mm), (side.shape[1], half))
        cv2.putText(side, "depth, 0.5 to 8 m", (8, 16), _FONT, 0.42, (255, 255, 255), 1, cv2.LINE_AA)
        self._map(side[half:], turn)
        return np.hstack([view, side])

    def _map(self, out: Picture, turn: Turn) -> None:
        height, width = out.shape[:2]
        middle = np.array(turn.row.operator_m[:2])
        scale = width / self.span_m

        def place(point: tuple[float, float]) -> tuple[int, int]:
            east, north = (np.asarray(point) - middle) * scale
            return round(width / 2 + float(east)), round(height / 2 - float(north))

        out[:] = _PAPER
        for metre in range(-40, 41):
            x, _ = place((float(round(middle[0])) + metre, 0.0))
            _, y = place((0.0, float(round(middle[1])) + metre))
            cv2.line(out, (x, 0), (x, height), _GRID, 1)
            cv2.line(out, (0, y), (width, y), _GRID, 1)
        for way, colour in ((self._drone, _DRONE), (self._operator, _OPERATOR)):
            points = np.array([place(p) for p in way], np.int32).reshape(-1, 1, 2)
            cv2.polylines(out, [points], False, colour, 1, cv2.LINE_AA)
        drone, operator = place(turn.row.drone_m[:2]), place(turn.row.operator_m[:2])
        cv2.circle(out, operator, round(turn.step.goal.distance_m * scale), _GRID, 1, cv2.LINE_AA)
        cv2.circle(out, operator, 5, _OPERATOR, -1, cv2.LINE_AA)
        heading = turn.step.state.heading_rad
        for side in (-0.48, 0.48):
            end = (drone[0] + 38 * np.cos(heading + side), drone[1] - 38 * np.sin(heading + side))
            cv2.line(out, drone, (round(float(end[0])), round(float(end[1]))), _DRONE, 1, cv2.LINE_AA)
        cv2.circle(out, drone, 5, _DRONE, -1, cv2.LINE_AA)
        cv2.putText(out, "from above, 1 m grid", (8, 16), _FONT, 0.42, _INK, 1, cv2.LINE_AA)


def _false_colour(depth_mm: UInt16[np.ndarray, "height width"]) -> Picture:
    small = depth_mm[::2, ::2]
    near = np.clip((8000.0 - small) / 7500.0 * 255.0, 0, 255).astype(np.uint8)
    colours = cv2.applyColorMap(near, cv2.COLORMAP_TURBO)[:, :, ::-1].copy()
    colours[small == 0] = 0
    return np.asarray(colours, np.uint8)
