"""Which engines there are, and what is said where one is not."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from wigwag.camera import Frame, Intrinsics
from wigwag.errors import InputError, MissingExtraError
from wigwag.pose import mediapipe
from wigwag.pose.blazepose import BlazePose
from wigwag.pose.body import Body
from wigwag.pose.engine import ENGINES, PoseEngine, open_engine
from wigwag.pose.estimator import PoseConfig, PoseEstimator


def test_the_default_is_blazepose_on_litert(networks: BlazePose) -> None:
    engine: PoseEngine = open_engine()
    assert isinstance(engine, BlazePose)
    assert engine.config.model == "full"
    assert ENGINES[0] == "litert"


@pytest.mark.parametrize(
    ("name", "model", "message"),
    [
        ("openpose", "full", "There is no pose engine 'openpose'. Available: litert, mediapipe."),
        ("litert", "huge", "There is no network 'huge'. Available: lite, full, heavy."),
    ],
)
def test_no_such_engine(name: str, model: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        open_engine(name, model)  # type: ignore[arg-type]
    assert str(caught.value) == message


def test_mediapipe_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mediapipe", None)
    with pytest.raises(MissingExtraError, match=r"'mediapipe'.*python -m pip install 'wigwag\[mediapipe\]'"):
        open_engine("mediapipe")


@pytest.mark.parametrize(
    ("error", "fix"),
    [
        (OSError("libEGL.so.1: cannot open shared object file: No such file"), "apt-get install libegl1"),
        (OSError("libGLESv2.so.2: cannot open shared object file"), "apt-get install libgles2"),
        (MissingExtraError("... (libGL.so.1: cannot open shared object file)"), "apt-get install libgl1"),
        (OSError("libodd++.so.3: wrong ELF class"), "install the system package with libodd++.so.3"),
    ],
)
def test_a_system_library_is_missing(monkeypatch: pytest.MonkeyPatch, error: Exception, fix: str) -> None:
    def fail(*_: object) -> object:
        raise error

    monkeypatch.setattr(mediapipe, "load", fail)
    with pytest.raises(MissingExtraError) as caught:
        open_engine("mediapipe")
    assert fix in str(caught.value)
    assert "The engine 'litert' needs no system library." in str(caught.value)
    assert caught.value.__cause__ is error


def test_the_estimator_takes_any_engine() -> None:
    class Nobody:
        resets = 0

        def detect(self, rgb: np.ndarray) -> Body | None:
            return None

        def track(self, rgb: np.ndarray) -> Body | None:
            return None

        def reset(self) -> None:
            self.resets += 1

    engine = Nobody()
    estimator = PoseEstimator(PoseConfig.alone(), tracker=engine)
    before = engine.resets
    picture, depth = np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.uint16)
    assert estimator(Frame(picture, depth, Intrinsics(), 1)) is None
    estimator.reset()
    assert engine.resets == before + 1
