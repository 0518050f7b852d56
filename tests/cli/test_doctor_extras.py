"""``wigwag doctor`` on extras: all of them, what is missing or broken, and the line that installs it."""

import sys
import tomllib
from pathlib import Path

import pytest

from wigwag.cli import doctor
from wigwag.cli.doctor import Finding, check_extras, install_line
from wigwag.extras import pip_install

HERE = ".".join(map(str, sys.version_info[:2]))


def test_extras_are_grouped_and_none_is_needed():
    lines = [
        "numpy>=1.26",
        "pytest>=1; extra == 'tests'",
        'hypothesis; extra == "tests"',
        f"no-such-package-here>=2; python_version == '{HERE}' and extra == 'boats'",
    ]
    tests, boats = check_extras(lines)
    assert (tests.check, tests.state, tests.fix) == ("extra tests", "ok", "")
    assert "pytest" in tests.detail and "hypothesis" in tests.detail
    assert boats.state == "optional"
    assert boats.detail == "not installed: no-such-package-here"
    assert boats.fix.endswith("python -m pip install 'wigwag[boats]'")


def test_every_extra_of_the_project_is_checked():
    project = tomllib.loads(Path("pyproject.toml").read_text("utf-8"))["project"]
    assert {f.check for f in check_extras()} == {f"extra {name}" for name in project["optional-dependencies"]}


def test_an_extra_for_another_python_is_not_offered_here():
    (boats,) = check_extras(["no-such-package-here; python_version == '2.7' and extra == 'boats'"])
    assert (boats.state, boats.fix) == ("optional", "")
    assert boats.detail == f"its packages exist for Python 2.7 alone; here is {HERE}"


def test_an_extra_that_does_not_load_says_why(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "hypothesis").mkdir()
    (tmp_path / "hypothesis" / "__init__.py").write_text("raise ImportError('libGL.so.1 is not there')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    (tests,) = check_extras(["hypothesis; extra == 'tests'"])
    assert tests.state == "optional"
    assert "cannot be imported (ImportError: libGL.so.1 is not there)" in tests.detail
    assert tests.fix.endswith("python -m pip install --force-reinstall 'wigwag[tests]'")


def test_one_line_installs_all_that_is_not_here():
    findings = [
        Finding("numpy", "missing", "", "python -m pip install numpy"),
        Finding("extra view", "optional", "", "python -m pip install 'wigwag[view]'"),
        Finding("extra bags", "ok", "rosbags 1"),
        Finding("extra ros2", "optional", "its packages exist for Python 3.11 alone"),
        Finding("extra mavlink", "optional", "", "python -m pip install 'wigwag[mavlink]'"),
    ]
    assert install_line(findings).endswith("python -m pip install 'wigwag[view,mavlink]'")
    assert install_line(findings[:1]) == ""


def test_the_line_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    doctor._show([Finding("extra boats", "optional", "", "python -m pip install 'wigwag[boats]'")])
    assert capsys.readouterr().out.splitlines()[-2].endswith("python -m pip install 'wigwag[boats]'")


def test_the_line_installs_into_this_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("UV", "/usr/bin/uv")  # as `uv run` sets it: the shell's own python is another
    assert pip_install("wigwag[view]") == "uv run python -m pip install 'wigwag[view]'"
    monkeypatch.delenv("UV")
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent))
    assert pip_install("numpy") == "python -m pip install numpy"
    monkeypatch.setenv("PATH", str(tmp_path))
    assert pip_install("numpy>=2") == f"{sys.executable} -m pip install 'numpy>=2'"
