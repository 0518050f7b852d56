"""The ``.task`` bundle that MediaPipe Tasks takes, assembled from the two networks it is made of.

A bundle is a zip file of the detector and the landmark network, stored as they are. MediaPipe also wants
each network to say how pixels become its input, in metadata that the published landmark networks lack:
without them it answers that ``NormalizationOptions`` are missing. They are added here, and the network is
left as it is.
"""

from __future__ import annotations

import io
import os
import struct
import zipfile
from collections.abc import Mapping
from pathlib import Path

from wigwag.errors import ModelError
from wigwag.pose.models import DETECTOR, LANDMARKERS, cache_folder, find_model, write_whole
from wigwag.pose.tflite import ALIGNMENT, BUFFERS, METADATA, Rewriter, table, vector, whole_file

_HEADER = 30
"""Bytes of a zip entry before its name."""

_ENTRY = "TFLITE_METADATA"
"""Under this name a network's table of contents holds its metadata."""
_ENTRY_NAME, _ENTRY_BUFFER = range(2)

# Fields of TensorFlow Lite's metadata (metadata_schema.fbs).
_SUBGRAPHS, _INPUTS, _PROCESSING = 3, 2, 4
_OPTIONS_TYPE, _OPTIONS = range(2)
_NORMALISATION = 1
_MEAN, _STD = range(2)


def task_file(
    model: str = "full", models_dir: Path | None = None, environ: Mapping[str, str] = os.environ
) -> Path:
    """Return the bundle for a landmark network, in the user's cache; one that is there is checked.

    The same networks give the same bytes, so a bundle that differs in one of them is stale or damaged, and is
    written anew.

    Args:
        model: Landmark network: 'lite', 'full' or 'heavy'.
        models_dir: Folder with the network files; by default they are looked for and fetched once.
        environ: The environment, for ``WIGWAG_MODELS`` and the place of the cache.

    Raises:
        ModelError: If a network is not there and cannot be fetched, or the cache cannot be written.
    """
    networks = [find_model(file, models_dir, environ) for file in (DETECTOR, LANDMARKERS[model])]
    path = cache_folder(environ) / f"pose_landmarker_{model}.task"
    try:
        data = assemble(*(network.read_bytes() for network in networks))
        if not path.is_file() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, data)
    except OSError as error:
        raise ModelError(
            f"{path}: the bundle for MediaPipe cannot be written ({error.strerror}). Let XDG_CACHE_HOME name "
            "a folder that can be."
        ) from error
    return path


def assemble(detector: bytes, landmarker: bytes) -> bytes:
    """Return the bytes of a bundle.

    Args:
        detector: ``pose_detection.tflite``, which takes pixels from -1 to 1.
        landmarker: ``pose_landmark_lite.tflite`` or its larger sisters, which take pixels from 0 to 1.

    Raises:
        ModelError: If one of them is no TensorFlow Lite network.
    """
    files = {
        "pose_detector.tflite": with_normalisation(detector, mean=127.5, std=127.5),
        "pose_landmarks_detector.tflite": with_normalisation(landmarker, mean=0.0, std=255.0),
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as bundle:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            room = -(archive.tell() + _HEADER + len(name) + 4) % ALIGNMENT
            entry.extra = struct.pack("<HH", 0xD935, room) + bytes(room)  # as Android's zipalign does
            bundle.writestr(entry, data)
    return archive.getvalue()


def with_normalisation(network: bytes, mean: float, std: float) -> bytes:
    """Return a network that says how pixels become its input: ``(pixel - mean) / std``.

    What it said before is replaced.

    Args:
        network: A ``.tflite`` file.
        mean: Of the three channels, 0 to 255.
        std: Likewise.

    Raises:
        ModelError: If it is no TensorFlow Lite network.
    """
    new = Rewriter(network)
    read, builder = new.read, new.builder
    with whole_file():
        buffers = [new.old(buffer) for buffer in read.tables(read.root, BUFFERS)]
        others = [e for e in read.tables(read.root, METADATA) if read.text(e, _ENTRY_NAME) != _ENTRY]
    buffers.append(table(builder, {0: builder.CreateByteVector(_metadata(mean, std))}))
    name = builder.CreateString(_ENTRY)
    builder.StartObject(2)
    builder.PrependUOffsetTRelativeSlot(_ENTRY_NAME, name, 0)
    builder.PrependUint32Slot(_ENTRY_BUFFER, len(buffers) - 1, 0)
    entries = [*map(new.old, others), builder.EndObject()]
    return new.finish({BUFFERS: vector(builder, buffers), METADATA: vector(builder, entries)})


def _metadata(mean: float, std: float) -> bytes:
    """Return a ``ModelMetadata`` whose first input has one processing unit, ``NormalizationOptions``."""
    from flatbuffers import Builder

    builder = Builder(512)
    floats = {
        field: vector(builder, [value], builder.PrependFloat32)
        for field, value in ((_MEAN, mean), (_STD, std))
    }
    normalisation = table(builder, floats)
    builder.StartObject(2)
    builder.PrependUOffsetTRelativeSlot(_OPTIONS, normalisation, 0)
    builder.PrependUint8Slot(_OPTIONS_TYPE, _NORMALISATION, 0)
    unit = builder.EndObject()
    tensor = table(builder, {_PROCESSING: vector(builder, [unit])})
    subgraph = table(builder, {_INPUTS: vector(builder, [tensor])})
    builder.Finish(table(builder, {_SUBGRAPHS: vector(builder, [subgraph])}), file_identifier=b"M001")
    return bytes(builder.Output())


__all__ = ["assemble", "task_file", "with_normalisation"]
