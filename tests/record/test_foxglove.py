"""Frames of reference in the file are those that are flown by; Rerun takes what is written."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from hypothesis import given
from hypothesis import strategies as st
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
