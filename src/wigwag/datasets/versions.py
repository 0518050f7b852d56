"""The clip format's versions: what is current, and how what is older becomes current.

A change of the format adds one entry to :data:`MIGRATIONS` and one to :data:`VERSION`; reading and
``wigwag clips migrate`` go through both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from wigwag.errors import InputError

VERSION = 1
"""The version that is written."""

Step = Callable[[dict[str, Any]], dict[str, Any]]
"""Takes the content of a clip file of one version and returns that of the next."""

MIGRATIONS: Mapping[int, Step] = {}
"""By the version that a step starts from. Version 1 is the first: there is nothing to migrate from yet."""


def upgraded(
    content: dict[str, Any], steps: Mapping[int, Step] = MIGRATIONS, current: int = VERSION
) -> dict[str, Any]:
    """Bring the content of a clip file to the current version, one version at a time.

    Args:
        content: The parsed file; it is not changed.
        steps: By the version that each starts from.
        current: The version wanted.

    Raises:
        InputError: If the version is no whole number, newer than ``current``, or older than any known one.

    Example:
        >>> upgraded({"version": 1, "label": "land"})
        {'version': 1, 'label': 'land'}
        >>> upgraded({"version": 1, "who": "ann"}, {1: lambda old: {"subject": old["who"]}}, current=2)
        {'subject': 'ann', 'version': 2}
    """
    version = content.get("version")
    if isinstance(version, bool) or not isinstance(version, int):
        raise InputError(f"version must be a whole number, but got {version!r}.")
    if version > current:
        raise InputError(
            f"version is {version}, but this wigwag reads versions up to {current}. Update wigwag."
        )
    while version < current:
        if version not in steps:
            raise InputError(
                f"version is {version}, which no wigwag wrote; known ones end in {current} "
                f"and begin with {min(steps, default=current)}."
            )
        try:
            content = steps[version](content) | {"version": version + 1}
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"is no whole file of version {version} ({error!r}).") from error
        version += 1
    return content


__all__ = ["MIGRATIONS", "VERSION", "Step", "upgraded"]
