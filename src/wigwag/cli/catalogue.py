"""Which commands there are, as a list: for the documentation and for tests of the command line itself."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from typing import Annotated, Any, get_args, get_origin, get_type_hints


@dataclass(frozen=True, slots=True)
class Entry:
    """A command that can be run."""

    words: tuple[str, ...]
    """What is typed after ``wigwag``, such as ``("clips", "convert")``."""
    kind: type[Any]
    """The dataclass that its options come from."""

    @property
    def summary(self) -> str:
        """The first line of its help."""
        return inspect.getdoc(self.kind).partition("\n")[0] if self.kind.__doc__ else ""  # type: ignore[union-attr]

    @property
    def options(self) -> tuple[str, ...]:
        """Names of its options, as in Python."""
        return tuple(field.name for field in fields(self.kind))


def catalogue() -> Iterator[Entry]:
    """Yield every command that runs, in the order of ``wigwag --help``; groups are gone through.

    Example:
        >>> ("clips", "convert") in [entry.words for entry in catalogue()]
        True
    """
    from wigwag.cli.app import Commands

    yield from _under(Commands, ())


def _under(choice: object, words: tuple[str, ...]) -> Iterator[Entry]:
    for kind, name in _subcommands(choice):
        inner = [
            entry
            for hint in get_type_hints(kind, include_extras=True).values()
            for entry in _under(hint, (*words, name))
        ]
        if inner:
            yield from inner
        else:
            yield Entry((*words, name), kind)


def _subcommands(hint: object) -> Iterator[tuple[type[Any], str]]:
    """Yield the dataclasses of a union that are marked as subcommands, with their names."""
    if get_origin(hint) is Annotated:
        inner, *marks = get_args(hint)
        names = [mark.name for mark in marks if type(mark).__name__ == "_SubcommandConfig"]
        if names and is_dataclass(inner) and isinstance(inner, type):
            yield inner, str(names[0])
        else:
            yield from _subcommands(inner)
        return
    for part in get_args(hint):
        yield from _subcommands(part)


__all__ = ["Entry", "catalogue"]
