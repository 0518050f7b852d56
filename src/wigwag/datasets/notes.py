"""What a reader that yields clip after clip has to say beside them."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Notes:
    """Filled while clips are read, as in :class:`wigwag.datasets.loaded.Loaded`."""

    left_out: list[tuple[str, str]] = field(default_factory=list)
    """``(file, reason)`` of each recording that could not be read."""
    repaired: list[tuple[str, str]] = field(default_factory=list)
    """``(file, what was done)`` of each that is not as it was recorded."""


__all__ = ["Notes"]
