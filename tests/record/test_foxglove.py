"""Frames of reference in the file are those that are flown by; Foxglove and Rerun take what is written."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.unknown_fields import UnknownFieldSet
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from scipy.spatial.transform import Rotation

from tests.record.flights import record
from wigwag.camera.frame import Intrinsics
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.record import foxglove
from wigwag.record.turns import FOXGLOVE_CHANNELS
from wigwag.skeleton import BONES, Pose

ANGLES = st.floats(-1.2, 1.2)


@given(st.floats(-3.1, 3.1), ANGLES, ANGLES, ANGLES)
def test_transforms_are_those_that_the_pilot_flies_by(
    yaw: float, pitch: float, roll: float, down: float
) -> None:
    state = VehicleState(np.array([1.0, 2.0, 3.0]), np.zeros(3), yaw, 5, roll, pitch)
    mount = Mount(down, (0.1, 0.02, -0.03))
    made = FrameTransforms.FromString(foxglove.transforms(state, mount, 5))
    body, camera = made.transforms

    def placed(one: object, point: np.ndarray) -> np.ndarray:
        t, r = one.translation, one.rotation  # type: ignore[attr-defined]
        turned = Rotation.from_quat([r.x, r.y, r.z, r.w]).apply(point)
        return np.array([t.x, t.y, t.z]) + turned

    point = np.array([0.3, -0.4, 4.0])
    np.testing.assert_allclose(placed(camera, point), mount.to_body(point), atol=1e-9)
    expected = state.position_m + rotation(state) @ mount.to_body(point)
    np.testing.assert_allclose(placed(body, placed(camera, point)), expected, atol=1e-9)
    assert (body.parent_frame_id, camera.parent_frame_id) == ("world", body.child_frame_id)


def test_bones_lie_over_the_picture_where_the_lens_sees_them() -> None:
    joints = np.random.default_rng(0).uniform(-1, 1, (13, 3)) + np.array([0, 0, 4.0])
    pose, lens = Pose(joints, np.ones(13), 1_500_000_000), Intrinsics()
    made = ImageAnnotations.FromString(foxglove.overlay(pose, lens, 7))
    points = np.array([[p.x, p.y] for p in made.points[0].points])
    np.testing.assert_allclose(points, lens.project(joints)[np.array(BONES).ravel()])
    assert len(made.points[0].outline_colors) == 14 and made.timestamp.nanos == 500_000_000
    behind = Pose(joints - np.array([0, 0, 9.0]), np.ones(13), 5)
    for nobody in (None, behind):
        assert not ImageAnnotations.FromString(foxglove.overlay(nobody, lens, 7)).points


@pytest.mark.parametrize("name", sorted(FOXGLOVE_CHANNELS.values()))
def test_schemas_stand_by_themselves(name: str) -> None:
    title, encoding, data = foxglove.protobuf_schema(name)
    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(data).file:
        pool.Add(file)
    assert encoding == "protobuf"
    assert pool.FindMessageTypeByName(title).full_name == f"foxglove.{name}"


def refused(described: dict[str, Any], path: str = "") -> list[str]:
    """Return what Foxglove's reader of JSON Schema has no type for; it then refuses the whole channel.

    By the rules of ``parseJsonSchema`` in the last open release of its viewer: an object at the root;
    booleans, strings, numbers, objects, and arrays of these; no arrays of arrays, nothing without a type.
    """
    if described.get("type") != "object":
        return [f"{path or 'the root'} is no object"]
    found = []
    for name, field in described["properties"].items():
        inner = field.get("items", {}) if field.get("type") == "array" else field
        if inner.get("type") == "object":
            found += refused(inner, f"{path}.{name}")
        elif inner.get("type") not in ("boolean", "string", "number", "integer"):
            found.append(f"{path}.{name}: {inner.get('type')}")
    return found


def test_foxgloves_reader_has_a_type_for_all_that_is_described(tmp_path: Path) -> None:
    """Poses used to be described as arrays of arrays, for which it refuses a channel."""
    path = tmp_path / "flight.mcap"
    record(path, 90)
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    described = {s.name: json.loads(s.data) for s in summary.schemas.values() if s.encoding == "jsonschema"}
    assert {"wigwag.Pose", "wigwag.Turn", "wigwag.Told", "wigwag.Gesture"} <= set(described)
    assert [hole for one in described.values() for hole in refused(one)] == []
    assert "visibility" in described["wigwag.Pose"]["properties"], "what it has a type for can be plotted"


def test_frames_hang_together_and_stamps_are_the_messages_own(tmp_path: Path) -> None:
    """Foxglove draws nothing in a frame that no transform leads to."""
    path = tmp_path / "flight.mcap"
    frames: set[str] = set()
    stamps: dict[str, list[int]] = {}
    record(path, 90, pictures=True, depth=True)
    with path.open("rb") as file:
        for described, channel, one in make_reader(file).iter_messages():
            if described is None or described.encoding != "protobuf":
                continue
            pool = DescriptorPool()
            for part in FileDescriptorSet.FromString(described.data).file:
                pool.Add(part)
            read = GetMessageClass(pool.FindMessageTypeByName(described.name)).FromString(one.data)
            assert not list(UnknownFieldSet(read)), "the schema in the file tells of everything"
            framed = [read, *getattr(read, "entities", ()), *getattr(read, "transforms", ())]
            frames |= {part.frame_id for part in framed if getattr(part, "frame_id", "")}
            frames |= {part.child_frame_id for part in framed if hasattr(part, "child_frame_id")}
            frames |= {part.parent_frame_id for part in framed if hasattr(part, "parent_frame_id")}
            stamps.setdefault(channel.topic, []).append(one.log_time)
    assert frames == {foxglove.WORLD, foxglove.BODY, foxglove.CAMERA}
    assert all(times == sorted(times) for times in stamps.values())
    assert {"/camera/image", "/camera/depth", "/tf", "/operator/skeleton"} <= set(stamps)


def test_rerun_imports_a_flight(tmp_path: Path) -> None:
    rerun = shutil.which("rerun")
    if rerun is None:
        pytest.skip("rerun is not installed")
    path = tmp_path / "flight.mcap"
    record(path, 90, pictures=True, depth=True)
    for words in (["check", str(path)], ["convert", str(path), "-o", str(tmp_path / "flight.rrd")]):
        done = subprocess.run([rerun, "mcap", *words], capture_output=True, text=True, check=False)
        said = [line for line in (done.stdout + done.stderr).splitlines() if "app_id" not in line]
        assert done.returncode == 0, said  # app_id: Rerun makes a name of the path
        assert not any(word in line.upper() for line in said for word in ("ERROR", "WARN")), said
    assert (tmp_path / "flight.rrd").stat().st_size > 10_000
