"""The pose networks and real pictures, where there are any."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from wigwag.errors import ModelError
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.models import DETECTOR, LANDMARKERS, ModelFile, locate

PHOTOS = Path(__file__).parents[2].parent / "shared" / "data" / "operator_photos"


@pytest.fixture(scope="session")
def networks() -> BlazePose:
    """The real networks, fetched once if need be."""
    try:
        return BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


@pytest.fixture
def blazepose(networks: BlazePose) -> BlazePose:
    networks.reset()
    return networks


@pytest.fixture(scope="session")
def photos() -> dict[str, np.ndarray]:
    """One real photo of each folder, RGB 640x480."""
    paths = [sorted(folder.glob("*.jpg"))[0] for folder in sorted(PHOTOS.glob("*/"))]
    if not paths:
        pytest.skip(f"needs the operator photos in {PHOTOS}")
    return {path.parent.name: cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB) for path in paths}


def network_file(file: ModelFile) -> bytes:
    if (path := locate(file)) is None:
        pytest.skip("the pose networks are not here: wigwag doctor --fetch")
    return path.read_bytes()


@pytest.fixture(scope="session")
def landmark_network() -> bytes:
    """The published file."""
    return network_file(LANDMARKERS["full"])


@pytest.fixture(scope="session")
def detection_network() -> bytes:
    """The published file."""
    return network_file(DETECTOR)
