"""What of a bag is colour, what is depth, and how their cameras stand to each other."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from wigwag.camera.align import Extrinsic
from wigwag.camera.ros_images import extrinsic_of
from wigwag.errors import DataError

_IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
_INFO = "sensor_msgs/msg/CameraInfo"
_TRANSPORTS = ("/compressedDepth", "/compressed")


@dataclass(frozen=True, slots=True)
class Topics:
    """The topics that are read; empty where there is none."""

    color: str
    depth: str
    info: str
    depth_info: str
    infos: str
    """All ``CameraInfo`` topics there are, for messages."""


class Wanted(Protocol):
    """What the user said about topics; see ``BagConfig``."""

    @property
    def color(self) -> str: ...  # noqa: D102
    @property
    def depth(self) -> str: ...  # noqa: D102
    @property
    def info(self) -> str: ...  # noqa: D102
    @property
    def depth_info(self) -> str: ...  # noqa: D102


def choose(reader: Any, path: Path, wanted: Wanted) -> Topics:
    """Choose a bag's topics by what was asked for, and by types and names.

    Args:
        reader: An open ``rosbags`` reader.
        path: The bag, for messages.
        wanted: What was asked for.

    Raises:
        DataError: If a topic is not there or there is more than one choice; the message names all.
    """
    kinds = {c.topic: c.msgtype for c in reader.connections}
    images = sorted(t for t, kind in kinds.items() if kind in _IMAGES)
    infos = sorted(t for t, kind in kinds.items() if kind == _INFO)
    color = _one(wanted.color, [t for t in images if "depth" not in t.lower()], images, path, "color")
    if not color:
        raise DataError(
            f"{path}: has no topic of colour pictures. Name one: ?color=/topic. Pictures are in: "
            f"{', '.join(images) or 'none'}."
        )
    depth = _one(wanted.depth, [t for t in images if "depth" in t.lower()], images, path, "depth")
    return Topics(
        color,
        depth,
        _one(wanted.info, [t for t in infos if t == _beside(color)], infos, path, "info"),
        _one(wanted.depth_info, [t for t in infos if t == _beside(depth)], infos, path, "depth_info"),
        ", ".join(infos),
    )


def transform(messages: Iterable[Any], source: str, target: str) -> Extrinsic | None:
    """Return the way from one frame of reference to another through a tree of static transforms.

    Args:
        messages: ``tf2_msgs/TFMessage``.
        source: ``frame_id`` whose points are known.
        target: ``frame_id`` in which they are wanted.

    Returns:
        ``None`` if no way leads there.
    """
    ways: dict[str, list[tuple[str, Extrinsic]]] = {}
    for message in messages:
        for t in message.transforms:
            child, parent, up = _frame(t.child_frame_id), _frame(t.header.frame_id), extrinsic_of(t.transform)
            ways.setdefault(child, []).append((parent, up))
            ways.setdefault(parent, []).append((child, up.inverse()))
    source, target = _frame(source), _frame(target)
    reached = {source: Extrinsic.identity()}
    queue = deque([source])
    while queue and target not in reached:
        here = queue.popleft()
        for there, step in ways.get(here, ()):
            if there not in reached:
                reached[there] = reached[here].then(step)
                queue.append(there)
    return reached.get(target)


def _one(asked: str, found: list[str], there: list[str], path: Path, option: str) -> str:
    """Return the topic that was asked for, or the only one that fits."""
    if asked:
        if asked not in there:
            raise DataError(
                f"{path}: has no topic {asked} for ?{option}. Of its type there is: "
                f"{', '.join(there) or 'none'}."
            )
        return asked
    if len(found) > 1:
        raise DataError(f"{path}: which topic is {option}? Name it: ?{option}= one of {', '.join(found)}.")
    return found[0] if found else ""


def _beside(topic: str) -> str:
    """Return where the intrinsics of a picture topic are by ROS's convention."""
    for transport in _TRANSPORTS:
        topic = topic.removesuffix(transport)
    return topic.rpartition("/")[0] + "/camera_info"


def _frame(name: str) -> str:
    return name.lstrip("/")  # ROS 1 wrote it with and without
