"""The pose network must see the drawn operator as it sees people."""

import numpy as np
import pytest

from wigwag.pose.models import DETECTOR, LANDMARKERS, locate
from wigwag.sim.noise import SensorNoise
from wigwag.sim.paint import Look
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene
from wigwag.skeleton import KINECT20

from .people import ARMS, AT, standing

absent = [f.name for f in (DETECTOR, LANDMARKERS["full"]) if locate(f) is None]
pytestmark = pytest.mark.skipif(
    bool(absent),
    reason=f"pose networks {absent} are not on this machine; `wigwag doctor` says how to get them",
)

BLAZEPOSE = {"shoulder": (11, 12), "wrist": (15, 16), "hip": (23, 24)}


@pytest.fixture(scope="module")
def network():
    from wigwag.pose.blazepose import BlazePose

    return BlazePose()


@pytest.fixture(scope="module")
def seen(network):
    """For each arm pose at 3 to 6 m: true pixels of the joints, the body found, metres a pixel."""
    sightings = []
    noise = SensorNoise(seed=1)
    renderer = Renderer(scene=Scene(seed=2, clear=np.array([[0.0, 0.0], [4.0, 0.0]])))
    for k, arms in enumerate(ARMS):
        distance = 3.0 + k % 4
        joints = standing(arms, at=(distance, 0.2))
        camera = CameraPose.looking(np.array([0.0, 0.0, 1.5]), 0.0, 0.05)
        rgb, depth = renderer.render(camera, [(joints, Look.from_seed(k, 1.75))])
        rgb, _ = noise.apply(rgb, depth)
        network.reset()
        for _ in range(3):  # found, then followed
            body = network.track(rgb)
        pixels = renderer.intrinsics.project(camera.to_camera(joints))
        sightings.append((arms, pixels, body, distance / renderer.intrinsics.fx))
    return sightings


def test_the_operator_is_found_in_every_pose(seen):
    assert len(seen) == 18
    for arms, pixels, body, metres in seen:
        assert body is not None, arms
        hips = (pixels[AT["left_hip"]] + pixels[AT["right_hip"]]) / 2
        found = body.points_px[list(BLAZEPOSE["hip"])].mean(axis=0)
        assert np.linalg.norm(found - hips) * metres < 0.1, arms


def test_left_and_right_are_never_swapped(seen):
    for arms, _, body, _ in seen:
        left, right = body.points_px[list(BLAZEPOSE["shoulder"]), 0]
        assert left > right, arms


def test_wrists_lie_where_they_are(seen):
    errors = []
    for _, pixels, body, _ in seen:
        shoulders, hips = (
            pixels[[AT[f"left_{n}"], AT[f"right_{n}"]]].mean(axis=0) for n in ("shoulder", "hip")
        )
        for side, index in zip(("left", "right"), BLAZEPOSE["wrist"], strict=True):
            away = body.points_px[index] - pixels[KINECT20.index(f"{side}_wrist")]
            errors.append(np.linalg.norm(away) / np.linalg.norm(shoulders - hips))
    assert np.median(errors) < 0.06
    assert np.mean(np.array(errors) > 0.3) <= 0.06
