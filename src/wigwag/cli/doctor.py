"""``wigwag doctor``: what works on this machine, what is missing, and how to get it."""

from __future__ import annotations

import importlib
import importlib.metadata
import os
import platform
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from wigwag.errors import InputError, ModelError
from wigwag.extras import pip_install

State = Literal["ok", "missing", "optional"]

_IMPORTS = {"opencv-python-headless": "cv2", "scikit-learn": "sklearn"}
"""Modules that are not named as their package is."""
_RUNS = 15
_LOADING_S = 120.0
_PYTHON = ".".join(map(str, sys.version_info[:2]))
_NO_MODULES = ("test", "tests", "docs", "examples")
"""What some packages install beside themselves."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What one check found."""

    check: str
    """What was looked at."""
    state: State
    """``"ok"``; ``"missing"``: wigwag needs it; ``"optional"``: it can do without."""
    detail: str
    """What is there."""
    fix: str = ""
    """What to do about it."""


@dataclass(frozen=True)
class Doctor:
    """Say what works here, what is missing, and how to get it. Exit code 1 if something needed is missing.

    Example: wigwag doctor --fetch
    """

    fetch: bool = False
    """Fetch the pose networks now if they are not on this machine yet."""
    picture: Path | None = None
    """Try the pose network on this picture; a blank one by default."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for."""
    json: Path | None = None
    """File for a list of records, one a check."""

    def run(self) -> int:
        """Check everything; return 0 if all that is needed works, else 1."""
        from rich.console import Console

        from wigwag.evaluate.records import Records

        console = Console(stderr=True)
        if self.picture is not None and not self.picture.exists():
            raise InputError(
                f"--picture {self.picture}: there is no such file. Name a picture, such as photo.jpg."
            )
        records = Records(self.json, "wigwag doctor", None)
        findings: list[Finding] = []
        with console.status("looking around"):
            findings += check_system()
            findings += check_packages()
            findings += check_extras()
        findings += self._check_models()
        with console.status("trying the pose network"):
            findings += self._check_pose()
        _show(findings)
        for finding in findings:
            records.add(**asdict(finding))
        return 1 if any(finding.state == "missing" for finding in findings) else 0

    def _check_models(self) -> Iterator[Finding]:
        from wigwag.pose.models import DETECTOR, LANDMARKERS, by_hand, find_model, locate

        for file in (DETECTOR, *LANDMARKERS.values()):
            needed: State = "missing" if file.member else "optional"
            try:
                fetch = self.fetch and file.member is not None
                path = find_model(file, self.models_dir) if fetch else locate(file, self.models_dir)
            except ModelError as error:
                yield Finding(file.name, needed, "not usable", str(error))
                continue
            if path:
                yield Finding(file.name, "ok", f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
            elif file.member:
                fix = "the first run that needs it fetches it; or now: wigwag doctor --fetch"
                yield Finding(file.name, needed, "not yet fetched", fix)
            else:
                yield Finding(file.name, needed, "not here", by_hand(file))

    def _check_pose(self) -> Iterator[Finding]:
        """Run both networks once they are here, and say how long a frame takes."""
        import numpy as np

        from wigwag.cli.pose import read_picture
        from wigwag.pose.blazepose import BlazePose, BlazePoseConfig
        from wigwag.pose.detector import Detector
        from wigwag.pose.landmarker import Landmarker
        from wigwag.pose.models import DETECTOR, LANDMARKERS, locate
        from wigwag.pose.region import Region

        try:
            detection, landmarks = (locate(f, self.models_dir) for f in (DETECTOR, LANDMARKERS["full"]))
            if detection is None or landmarks is None:
                return
            rgb = read_picture(self.picture) if self.picture else np.full((480, 640, 3), 127, np.uint8)
            whole = Region.whole(rgb.shape[1], rgb.shape[0])
            detector, landmarker = Detector(detection), Landmarker(landmarks)
            find_ms = _median_ms(lambda: detector(rgb, whole))
            follow_ms = _median_ms(lambda: landmarker(rgb, whole))
            detail = f"{follow_ms:.1f} ms a frame to follow, {find_ms:.1f} ms more to find (one thread)"
            yield Finding("pose network", "ok", detail)
            if self.picture:
                body = BlazePose(BlazePoseConfig(models_dir=self.models_dir)).detect(rgb)
                yield Finding(str(self.picture), "ok", "a body found" if body else "nobody found")
        except (ModelError, ImportError) as error:
            yield Finding("pose network", "missing", "does not run", str(error))


def check_system() -> Iterator[Finding]:
    """Say which Python, system and processor this is."""
    version = platform.python_version()
    fine = (3, 11) <= sys.version_info[:2] < (3, 14)
    fix = "" if fine else "wigwag needs Python 3.11 to 3.13"
    yield Finding("Python", "ok" if fine else "missing", f"{version} ({sys.executable})", fix)
    yield Finding("system", "ok", f"{platform.system()} {platform.release()}, {platform.machine()}")
    yield Finding("processor", "ok", f"{os.cpu_count()} cores")


def check_packages(requirements: list[str] | None = None) -> Iterator[Finding]:
    """Import every package of the base install.

    Args:
        requirements: Requirement lines; by default those that wigwag's own installation names.
    """
    if requirements is None:
        requirements = importlib.metadata.requires("wigwag") or []
    for line in requirements:
        if ";" in line and "extra" in line:
            continue
        name = re.split(r"[^A-Za-z0-9._-]", line, maxsplit=1)[0]
        fix = pip_install(line.partition(";")[0].strip())
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            yield Finding(name, "missing", "not installed", fix)
            continue
        try:
            importlib.import_module(_IMPORTS.get(name, name.replace("-", "_")))
        except Exception as error:  # a broken wheel may raise anything
            yield Finding(name, "missing", f"{version}, but it cannot be imported ({error})", fix)
            continue
        yield Finding(name, "ok", version)


def check_extras(requirements: list[str] | None = None) -> Iterator[Finding]:
    """Say which extras are installed and load; none is needed.

    Args:
        requirements: Requirement lines; by default those that wigwag's own installation names.
    """
    if requirements is None:
        requirements = importlib.metadata.requires("wigwag") or []
    extras: dict[str, list[str]] = {}
    for line in requirements:
        if extra := re.search(r"extra\s*==\s*['\"]([^'\"]+)['\"]", line):
            extras.setdefault(extra.group(1), []).append(line)
    for name, lines in extras.items():
        yield _extra(name, lines)


def _extra(name: str, lines: list[str]) -> Finding:
    check, there, missing, elsewhere = f"extra {name}", [], [], ""
    for line in lines:
        package = re.split(r"[^A-Za-z0-9._-]", line, maxsplit=1)[0]
        try:
            there.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            only = re.search(r"python_version\s*==\s*['\"]([^'\"]+)['\"]", line)
            if only and only[1] != _PYTHON:
                elsewhere = only[1]
            else:
                missing.append(package)
    if missing:
        fix = pip_install(f"wigwag[{name}]")
        return Finding(check, "optional", f"not installed: {', '.join(missing)}", fix)
    if elsewhere:
        return Finding(
            check, "optional", f"its packages exist for Python {elsewhere} alone; here is {_PYTHON}"
        )
    trouble = _trouble_loading(name, [entry.split()[0] for entry in there])
    if trouble:
        fix = pip_install("--force-reinstall", f"wigwag[{name}]")
        return Finding(check, "optional", f"{', '.join(there)}, but {trouble}", fix)
    return Finding(check, "ok", ", ".join(there))


def _trouble_loading(extra: str, packages: list[str]) -> str:
    """Import packages in a process of its own, whose memory and crashes go with it; say what went wrong."""
    modules = sorted(
        module
        for module, owners in importlib.metadata.packages_distributions().items()
        if module.isidentifier()
        and not module.startswith("_")
        and module not in _NO_MODULES
        and any(_same(owner, package) for owner in owners for package in packages)
    )
    code = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)"
    if extra == "realsense":  # it needs libusb loaded before it
        code, modules = "from wigwag.extras import load_realsense as load; load('doctor')", []
    try:
        done = subprocess.run(
            [sys.executable, "-c", code, *modules],
            capture_output=True,
            text=True,
            timeout=_LOADING_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"it cannot be imported ({error})"
    if done.returncode == 0:
        return ""
    said = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
    return f"it cannot be imported ({said[-1]})"


def _same(one: str, other: str) -> bool:
    """Say whether two names are one package's."""
    return re.sub(r"[-_.]+", "-", one).lower() == re.sub(r"[-_.]+", "-", other).lower()


def install_line(findings: list[Finding]) -> str:
    """Return the one line that installs all extras that are not here; empty if there is none.

    Example:
        >>> findings = [Finding("extra view", "optional", "", "..."), Finding("extra bags", "ok", "")]
        >>> install_line(findings).endswith("python -m pip install 'wigwag[view]'")
        True
    """
    names = [f.check.removeprefix("extra ") for f in findings if f.check.startswith("extra ") and f.fix]
    return pip_install(f"wigwag[{','.join(names)}]") if names else ""


def _median_ms(call: Callable[[], object]) -> float:
    times = []
    for _ in range(_RUNS):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return sorted(times)[_RUNS // 2] * 1e3


def _show(findings: list[Finding]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    styles = {"ok": "green", "missing": "bold red", "optional": "yellow"}
    table = Table(title="wigwag doctor")
    for column in ("check", "state", "what is there"):
        table.add_column(column, overflow="fold")
    for finding in findings:
        state = Text(finding.state, style=styles[finding.state])
        table.add_row(Text(finding.check), state, Text(finding.detail))
    console = Console()
    console.print(table)
    for finding in findings:
        if finding.fix:
            console.print(Text(f"{finding.check}: {finding.fix}"), soft_wrap=True)
    if line := install_line(findings):
        console.print(Text(f"All extras that are not here: {line}"), soft_wrap=True)
    missing = sum(finding.state == "missing" for finding in findings)
    console.print(Text("All that is needed works here." if not missing else f"{missing} needed: see above."))


__all__ = ["Doctor", "Finding", "check_extras", "check_packages", "check_system", "install_line"]
