"""Parts of wigwag that are installed when asked for."""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import os
import shlex
import shutil
import sys
from contextlib import suppress
from typing import Any

from wigwag.errors import MissingExtraError


def pip_install(*words: str) -> str:
    """Return the line that installs something into the environment that this runs in, not into another.

    Args:
        words: Requirements and options.

    Example:
        >>> pip_install("wigwag[view]").endswith("python -m pip install 'wigwag[view]'")
        True
    """
    said = f"-m pip install {shlex.join(words)}"
    if "UV" in os.environ:  # set by `uv run`; its environment is not the shell's
        return f"uv run python {said}"
    found = shutil.which("python")
    here = found is not None and os.path.abspath(found) == os.path.abspath(sys.executable)
    return f"{'python' if here else shlex.quote(sys.executable)} {said}"


def load(module: str, extra: str, what: str) -> Any:
    """Import a module that an extra brings.

    Args:
        module: Its import name.
        extra: Of wigwag.
        what: What needs it; begins the error message.

    Raises:
        MissingExtraError: If it is not installed or does not load.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"{what} needs the package {module.partition('.')[0]}, which cannot be imported ({error}). "
            f"Install it with: {pip_install(f'wigwag[{extra}]')}"
        ) from error


def require(module: str, extra: str, what: str) -> None:
    """Say early that a module is missing that another process is going to import.

    Args:
        module: Its import name.
        extra: Of wigwag.
        what: What needs it; begins the error message.

    Raises:
        MissingExtraError: If it is not installed.
    """
    if importlib.util.find_spec(module) is None:
        raise MissingExtraError(
            f"{what} needs the package {module}, which is not installed. "
            f"Install it with: {pip_install(f'wigwag[{extra}]')}"
        )


def load_realsense(what: str) -> Any:
    """Import ``pyrealsense2``, which needs libusb: the system's, or else the one that the extra brings.

    Args:
        what: What needs it; begins the error message.

    Raises:
        MissingExtraError: If it is not installed or does not load.
    """
    with suppress(MissingExtraError):
        return load("pyrealsense2", "realsense", what)
    with suppress(ImportError, OSError):
        library = importlib.import_module("libusb_package").get_library_path()
        # Once loaded, whoever asks for a library of its name gets this one.
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    return load("pyrealsense2", "realsense", what)
