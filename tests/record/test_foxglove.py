"""Frames of reference in the file are those that are flown by; Rerun takes what is written."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.record.flights import record
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.record import foxglove
from wigwag.record.turns import FOXGLOVE_CHANNELS

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
