"""MediaPipe Tasks as a pose engine: the same networks, found, followed and cropped by MediaPipe itself.

It looks for people in the full frame, not in crops, has no second look at what the detector takes for a
person, and does not tell how sure it is of one. It is here to be compared with, and for those who want it.
"""

from __future__ import annotations

import re
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from wigwag.errors import MissingExtraError, ModelError
from wigwag.extras import load, pip_install
from wigwag.pose.blazepose import check_picture
from wigwag.pose.body import Body, Picture
from wigwag.pose.bundle import task_file
from wigwag.pose.network import native_stderr_closed

_FAR_APART_MS = 10_000_000
"""Between two pictures, as MediaPipe is told. In a stream it smooths landmarks over time, which puts them
2 px behind a moving person; between pictures hours apart there is nothing to smooth. Tracking knows no time.
"""

_PACKAGES = {"libEGL.so.1": "libegl1", "libGLESv2.so.2": "libgles2", "libGL.so.1": "libgl1"}
"""System libraries that later releases of MediaPipe load, and the Debian and Ubuntu packages they are in."""


@dataclass(frozen=True, slots=True)
class MediaPipePoseConfig:
    """How bodies are looked for."""

    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    min_detection: float = 0.5
    """Detections below this score are not looked at."""
    min_presence: float = 0.5
    """A new body below this score is none."""
    min_tracking: float = 0.5
    """A body that is followed is let go below this score."""


class MediaPipePose:
    """Finds and follows one person in RGB pictures; a ``PoseEngine``.

    Its bodies have no ``score`` and no ``clarity``: MediaPipe keeps the one to itself and computes no other.

    Args:
        config: Options.

    Raises:
        MissingExtraError: If MediaPipe is not installed, or a system library that it loads is not.
        ModelError: If a network file is missing and cannot be fetched, or MediaPipe refuses it.
    """

    def __init__(self, config: MediaPipePoseConfig | None = None) -> None:
        self.config = config = config or MediaPipePoseConfig()
        self._mediapipe = _load("mediapipe")
        self._vision = _load("mediapipe.tasks.python.vision")
        self._bundle = task_file(config.model, config.models_dir)
        self._landmarkers: dict[str, Any] = {}
        weakref.finalize(self, _close, self._landmarkers)
        self._landmarker("VIDEO")
        self._count = 0
        self._followed: tuple[int, ...] | None = None
        """Shape of the last picture of the stream, if somebody was in it."""

    def detect(self, rgb: Picture) -> Body | None:
        """Return the body in one picture that stands for itself, or ``None``."""
        picture = self._picture(rgb)
        return _body(self._landmarker("IMAGE").detect(picture), rgb)

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next picture of a stream, or ``None`` while nobody is found."""
        picture = self._picture(rgb)
        self._count += 1
        stamp_ms = self._count * _FAR_APART_MS
        body = _body(self._landmarker("VIDEO").detect_for_video(picture, stamp_ms), rgb)
        self._followed = None if body is None else rgb.shape
        return body

    def reset(self) -> None:
        """Forget whom it follows."""
        if self._followed is not None:
            # It has no such call, and making it anew takes longer and leaves memory behind. Nobody is in a
            # black picture, and who is not there is followed no longer.
            self.track(np.zeros(self._followed, np.uint8))

    def close(self) -> None:
        """Let go of MediaPipe's threads and memory; looking again begins anew."""
        _close(self._landmarkers)
        self._count, self._followed = 0, None

    def _picture(self, rgb: Picture) -> Any:
        check_picture(rgb)
        kind = self._mediapipe.ImageFormat.SRGB
        return self._mediapipe.Image(image_format=kind, data=np.ascontiguousarray(rgb))

    def _landmarker(self, mode: Literal["IMAGE", "VIDEO"]) -> Any:
        """Return one of MediaPipe's two landmarkers, made when it is first asked for.

        Raises:
            MissingExtraError: If a system library is missing.
            ModelError: If it cannot be made of the bundle.
        """
        if mode in self._landmarkers:
            return self._landmarkers[mode]
        config, vision = self.config, self._vision
        options = vision.PoseLandmarkerOptions(
            base_options=self._mediapipe.tasks.BaseOptions(model_asset_path=str(self._bundle)),
            running_mode=vision.RunningMode[mode],
            min_pose_detection_confidence=config.min_detection,
            min_pose_presence_confidence=config.min_presence,
            min_tracking_confidence=config.min_tracking,
        )
        try:
            with native_stderr_closed():
                self._landmarkers[mode] = vision.PoseLandmarker.create_from_options(options)
        except OSError as error:
            raise _missing_library(error) from error
        except (RuntimeError, ValueError) as error:
            raise ModelError(f"{self._bundle}: MediaPipe cannot use this bundle ({error}).") from error
        return self._landmarkers[mode]


def _close(landmarkers: dict[str, Any]) -> None:
    while landmarkers:
        landmarker = landmarkers.popitem()[1]
        try:
            landmarker.close()
        except RuntimeError:  # the program ends, and the thread that MediaPipe closes in has ended before
            landmarker._handle = None  # or it tries once more, when it is collected, and complains


def _body(result: Any, rgb: Picture) -> Body | None:
    """Turn MediaPipe's answer into ours.

    MediaPipe measures from the picture's edges; the middle of a pixel is where our index is, half a pixel on.
    """
    if not result.pose_landmarks:
        return None
    landmarks, size = result.pose_landmarks[0], (rgb.shape[1], rgb.shape[0])
    return Body(
        points_px=np.array([(point.x, point.y) for point in landmarks]) * size - 0.5,
        visibility=np.array([point.visibility for point in landmarks], dtype=np.float64),
        world_m=_xyz(result.pose_world_landmarks[0]),
        score=None,
        clarity=None,
    )


def _xyz(landmarks: Any) -> Float[np.ndarray, "33 3"]:
    return np.array([(point.x, point.y, point.z) for point in landmarks], dtype=np.float64)


def _load(module: str) -> Any:
    """Import a part of MediaPipe.

    Raises:
        MissingExtraError: If it is not installed, or a system library that it loads is not.
    """
    try:
        with native_stderr_closed():
            return load(module, "mediapipe", "The pose engine 'mediapipe'")
    except MissingExtraError as error:
        if _library(error):
            raise _missing_library(error) from error
        raise
    except OSError as error:
        raise _missing_library(error) from error


def _library(error: Exception) -> str | None:
    """Return the name of the shared library that an error message complains of."""
    found = re.search(r"\blib[\w+-]+\.so[.\d]*", str(error))
    return found.group() if found else None


def _missing_library(error: Exception) -> MissingExtraError:
    name = _library(error)
    package = _PACKAGES.get(name or "")
    fix = f"apt-get install {package}" if package else f"install the system package with {name or 'it'}"
    return MissingExtraError(
        f"The pose engine 'mediapipe' needs a system library that cannot be loaded ({error}). On Debian and "
        f"Ubuntu: {fix}. Or install the release that needs none: {pip_install('wigwag[mediapipe]')}. "
        "The engine 'litert' needs no system library."
    )


__all__ = ["MediaPipePose", "MediaPipePoseConfig"]
