"""What finds a body in a picture, behind one protocol, and which such engines there are."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, Protocol, get_args

from wigwag.errors import InputError
from wigwag.pose.body import Body, Picture

EngineName = Literal["litert", "mediapipe"]
ModelName = Literal["lite", "full", "heavy"]

ENGINES: tuple[EngineName, ...] = get_args(EngineName)
"""'litert' is the default and needs nothing more; 'mediapipe' needs the extra of that name."""


class PoseEngine(Protocol):
    """Finds one person in pictures, RGB, 8 bit; gives their landmarks as they are seen, without smoothing."""

    def detect(self, rgb: Picture) -> Body | None:
        """Return the body in a picture that stands for itself, or ``None``; the stream is not touched.

        Raises:
            InputError: If it is no such picture.
        """
        ...

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next picture of a stream, or ``None`` while nobody is found.

        Raises:
            InputError: If it is no such picture.
        """
        ...

    def reset(self) -> None:
        """Forget the stream and whom it follows."""
        ...


def open_engine(
    name: EngineName = "litert",
    model: ModelName = "full",
    models_dir: Path | None = None,
) -> PoseEngine:
    """Make an engine with its defaults; its own class takes more options.

    Args:
        name: One of ``ENGINES``.
        model: Landmark network. 'lite' gets crossed and forward-pointing arms wrong, 'heavy' takes three to
            four times as long.
        models_dir: Folder with the network files; by default they are looked for and fetched once.

    Raises:
        InputError: If there is no such engine or network.
        ModelError: If a network file is missing and cannot be fetched, or is damaged.
        MissingExtraError: If the engine needs an extra, or a system library, that is not installed.

    Example:
        ``engine = open_engine("mediapipe"); body = engine.track(frame.rgb)``
    """
    if model not in get_args(ModelName):
        raise InputError(f"There is no network {model!r}. Available: {', '.join(get_args(ModelName))}.")
    if name == "litert":
        from wigwag.pose.blazepose import BlazePose, BlazePoseConfig

        return BlazePose(BlazePoseConfig(model=model, models_dir=models_dir))
    if name == "mediapipe":
        from wigwag.pose.mediapipe import MediaPipePose, MediaPipePoseConfig

        return MediaPipePose(MediaPipePoseConfig(model=model, models_dir=models_dir))
    raise InputError(f"There is no pose engine {name!r}. Available: {', '.join(ENGINES)}.")


__all__ = ["ENGINES", "EngineName", "ModelName", "Picture", "PoseEngine", "open_engine"]
