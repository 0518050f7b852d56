"""Draw the gallery's pictures anew: ``uv run python docs/draw_gallery.py`` (seeded)."""

from __future__ import annotations

import tempfile
from itertools import islice
from pathlib import Path

import cv2
import numpy as np

from wigwag.camera.frame import Frame
from wigwag.cameras import open_camera
from wigwag.evaluate.vocabulary_pictures import draw_pair
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.sim.clips import training_clips
from wigwag.skeleton import Clip
from wigwag.view.draw import MIDDLE, MISSING, draw_banner, draw_body

OUT = Path(__file__).parent / "gallery"


def write(name: str, rgb: np.ndarray) -> None:
    """Write a picture as WebP."""
    cv2.imwrite(str(OUT / f"{name}.webp"), rgb[:, :, ::-1], [cv2.IMWRITE_WEBP_QUALITY, 80])
    print(name)


def looked_at(address: str, frames: int, config: PoseConfig) -> tuple[Frame, PoseEstimator]:
    """Let an estimator look through a camera for some frames; return the last one, and what it knows."""
    estimator = PoseEstimator(config)
    with open_camera(address) as camera:
        for frame in islice(camera, frames):
            estimator(frame)
    return frame, estimator


def draw_people(frame: Frame, estimator: PoseEstimator) -> np.ndarray:
    """Draw everybody who is seen, and say who the operator is."""
    picture = frame.rgb.copy()
    for person in estimator.people:
        if person.body is not None:
            draw_body(picture, person.body)
    operator = estimator.operator
    text = "nobody commands" if operator is None else f"person {operator.number} commands"
    draw_banner(picture, text, f"{len(estimator.people)} in mind", MISSING if operator is None else MIDDLE)
    return picture


def draw_depth(frame: Frame) -> np.ndarray:
    """Return the depth picture in colours: near is red, far is blue, holes are black."""
    near = np.clip((8000.0 - frame.depth_mm) / 7500.0 * 255.0, 0, 255).astype(np.uint8)
    colours = cv2.applyColorMap(near, cv2.COLORMAP_TURBO)[:, :, ::-1].copy()
    colours[frame.depth_mm == 0] = 0
    return colours


def first(clips: list[Clip], label: str, subject: str) -> Clip:
    """Return somebody's first clip of a gesture."""
    return next(clip for clip in clips if clip.label == label and clip.subject == subject)


def main() -> None:
    """Draw all of them."""
    OUT.mkdir(exist_ok=True)
    frame, estimator = looked_at("sim:?seed=5&engage=0", 50, PoseConfig.alone())
    write("found", draw_people(frame, estimator))
    write("depth", draw_depth(frame))
    frame, estimator = looked_at("sim:?seed=8&passersby=2&near=3&distance_m=4.5", 85, PoseConfig())
    write("passersby", draw_people(frame, estimator))
    frame, estimator = looked_at("sim:?seed=9&light=0.02&engage=0", 30, PoseConfig.alone())
    write("dusk", draw_people(frame, estimator))

    clips = training_clips(n_people=2, repetitions=1, pieces=1)
    one, two = sorted({str(clip.subject) for clip in clips})
    for name, label in (("aligned_orbit", "orbit"), ("aligned_take_off", "take_off")):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "pair.png"
            draw_pair(
                first(clips, label, one), first(clips, label, two), (one, two),
                f"{label.replace('_', ' ')} by two people, aligned in time", path,
            )  # fmt: skip
            write(name, cv2.imread(str(path))[:, :, ::-1])


if __name__ == "__main__":
    main()
