"""Draw the gallery's pictures anew: ``uv run python docs/draw_gallery.py`` (seeded).

With a film, ``uv run python docs/draw_gallery.py out/demo.mp4`` (of ``wigwag demo --seed 1``), the moving
picture of the first page alone is cut out of it.
"""

from __future__ import annotations

import sys
import tempfile
from fractions import Fraction
from itertools import islice
from pathlib import Path

import av
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


def looked_at(address: str, least: int, people: int, config: PoseConfig) -> tuple[Frame, PoseEstimator]:
    """Look through a camera until there is an operator and so many are seen; return the last frame too.

    Args:
        address: Of the camera.
        least: Frames to look at in any case.
        people: How many have to be seen at once.
        config: Who becomes the operator, and how.
    """
    estimator = PoseEstimator(config)
    with open_camera(address) as camera:
        for number, frame in enumerate(islice(camera, 240)):
            estimator(frame)
            operator = estimator.operator
            seen = sum(person.body is not None for person in estimator.people)
            if number >= least and operator is not None and operator.body is not None and seen >= people:
                break
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


def cut_film(film: Path, out: Path, begin_s: float = 7.5, end_s: float = 35.0, rate_hz: int = 8) -> None:
    """Write a part of a film as a moving picture, 640 pixels wide, that plays over and over."""
    with av.open(str(film)) as source, av.open(str(out), "w", options={"loop": "0"}) as target:
        stream = target.add_stream("libwebp_anim", rate=rate_hz, options={"quality": "45", "lossless": "0"})
        stream.width, stream.height, stream.pix_fmt = 640, 320, "yuv420p"
        stream.time_base, number = Fraction(1, rate_hz), 0
        for frame in source.decode(video=0):
            if frame.time is None or frame.time < begin_s + number / rate_hz:
                continue
            if frame.time > end_s:
                break
            small = frame.reformat(width=640, height=320, format="yuv420p", interpolation="AREA")
            small.pts, small.time_base = number, stream.time_base
            target.mux(stream.encode(small))
            number += 1
        target.mux(stream.encode())


def first(clips: list[Clip], label: str, subject: str) -> Clip:
    """Return somebody's first clip of a gesture."""
    return next(clip for clip in clips if clip.label == label and clip.subject == subject)


def main() -> None:
    """Draw all of them."""
    OUT.mkdir(exist_ok=True)
    frame, estimator = looked_at("sim:?seed=3&engage=0&distance_m=5", 55, 1, PoseConfig.alone())
    write("found", draw_people(frame, estimator))
    write("depth", draw_depth(frame))
    frame, estimator = looked_at("sim:?seed=4&passersby=2&near=2&distance_m=5", 60, 2, PoseConfig())
    write("passersby", draw_people(frame, estimator))
    frame, estimator = looked_at("sim:?seed=9&light=0.02&engage=0", 30, 1, PoseConfig.alone())
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
    if sys.argv[1:]:
        cut_film(Path(sys.argv[1]), OUT.parent / "demo.webp")
    else:
        main()
