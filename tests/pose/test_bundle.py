"""The bundle for MediaPipe, without MediaPipe."""

from __future__ import annotations

import io
import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from flatbuffers import encode, number_types, table

from tests.pose.test_tflite import answers
from wigwag.errors import ModelError
from wigwag.pose.bundle import assemble, task_file, with_normalisation
from wigwag.pose.models import DETECTOR, LANDMARKERS, locate
from wigwag.pose.tflite import BUFFERS, METADATA, Reader


def metadata(network: bytes) -> dict[str, bytes]:
    """What a network's table of contents names."""
    read = Reader(network)
    buffers = read.tables(read.root, BUFFERS)
    named: dict[str, bytes] = {}
    for entry in read.tables(read.root, METADATA):
        name = read.text(entry, 0)
        assert name not in named
        place = read.place(buffers[read.number(entry, 1)], 0)
        (length,) = struct.unpack_from("<I", network, place)
        named[name] = network[place + 4 : place + 4 + length]
    return named


def normalisation(said: bytes) -> tuple[int, float, float]:
    """Kind, mean and deviation of the first processing unit of the first input."""
    assert said[4:8] == b"M001"
    at = table.Table(said, encode.Get(number_types.UOffsetTFlags.packer_type, said, 0))

    def field(owner: table.Table, slot: int) -> int:
        return int(owner.Pos + owner.Offset(4 + 2 * slot))

    for slot in (3, 2, 4):  # subgraph_metadata, input_tensor_metadata, process_units: the first of each
        first = at.Vector(field(at, slot) - at.Pos)
        at = table.Table(said, at.Indirect(first))
    kind = said[field(at, 0)]
    options = table.Table(said, at.Indirect(field(at, 1)))
    mean, std = (
        struct.unpack_from("<f", said, options.Vector(field(options, slot) - options.Pos))[0]
        for slot in (0, 1)
    )
    return kind, mean, std


def test_a_network_says_how_it_wants_pixels_and_stays_the_same(landmark_network: bytes) -> None:
    said = with_normalisation(landmark_network, 10.0, 255.0)
    assert normalisation(metadata(said)["TFLITE_METADATA"]) == (1, 10.0, 255.0)
    assert set(metadata(said)) == {*metadata(landmark_network), "TFLITE_METADATA"}
    picture = np.random.default_rng(1).random((1, 256, 256, 3), dtype=np.float32)
    expected, got = answers(landmark_network, picture), answers(said, picture)
    assert set(got) == set(expected)
    for shape, values in expected.items():
        np.testing.assert_array_equal(got[shape], values)


def test_what_a_network_said_before_is_replaced(detection_network: bytes) -> None:
    """The published detector has metadata: a name that is not its own, and the right normalisation."""
    assert normalisation(metadata(detection_network)["TFLITE_METADATA"])[1:] == (127.5, 127.5)
    said = metadata(with_normalisation(detection_network, 1.0, 2.0))
    assert normalisation(said["TFLITE_METADATA"]) == (1, 1.0, 2.0)
    assert set(said) == set(metadata(detection_network))


def test_a_bundle_holds_both_networks_where_they_can_be_used_in_place(
    detection_network: bytes,
    landmark_network: bytes,
) -> None:
    data = assemble(detection_network, landmark_network)
    assert data == assemble(detection_network, landmark_network)
    with zipfile.ZipFile(io.BytesIO(data)) as bundle:
        assert bundle.testzip() is None
        assert bundle.namelist() == ["pose_detector.tflite", "pose_landmarks_detector.tflite"]
        for entry, expected in zip(bundle.infolist(), ((127.5, 127.5), (0.0, 255.0)), strict=True):
            assert entry.compress_type == zipfile.ZIP_STORED
            network = bundle.read(entry)
            assert data.index(network) % 64 == 0
            assert normalisation(metadata(network)["TFLITE_METADATA"])[1:] == expected


def test_no_network() -> None:
    with pytest.raises(ModelError, match="Expected a TensorFlow Lite network"):
        assemble(b"nothing", b"nothing")


@pytest.fixture
def environ(tmp_path: Path, landmark_network: bytes) -> dict[str, str]:
    """Networks in a folder of their own, and an empty cache."""
    networks = {file: locate(file) for file in (DETECTOR, LANDMARKERS["full"])}
    models = tmp_path / "models"
    models.mkdir()
    for file, path in networks.items():
        assert path is not None
        (models / file.name).symlink_to(path)
    return {"WIGWAG_MODELS": str(models), "XDG_CACHE_HOME": str(tmp_path / "cache")}


def test_a_bundle_is_made_once_and_anew_when_it_is_damaged(environ: dict[str, str]) -> None:
    path = task_file("full", environ=environ)
    assert path == Path(environ["XDG_CACHE_HOME"]) / "wigwag" / "models" / "pose_landmarker_full.task"
    whole = path.read_bytes()
    os.utime(path, ns=(1, 1))
    assert task_file("full", environ=environ) == path
    assert path.stat().st_mtime_ns == 1, "not written again"
    path.write_bytes(whole[:1000])
    assert task_file("full", environ=environ).read_bytes() == whole
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_a_cache_that_cannot_be_written(environ: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(ModelError, match=r"pose_landmarker_full\.task: .* XDG_CACHE_HOME"):
        task_file("full", environ=environ | {"XDG_CACHE_HOME": str(tmp_path / "file")})


def test_a_network_that_is_not_there(environ: dict[str, str]) -> None:
    with pytest.raises(ModelError, match=r"pose_landmark_heavy\.tflite"):
        task_file("heavy", environ=environ)
