"""A place for one value: what comes later replaces it, and whoever puts it there never waits."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Slot(Generic[Value]):
    """Holds the newest value until it is taken.

    Args:
        merge: What to hold of a value that nobody took and the one that comes after it; by default the later.

    Example:
        >>> slot = Slot()
        >>> slot.put(1); slot.put(2)
        >>> slot.take(), slot.replaced
        (2, 1)
    """

    def __init__(self, merge: Callable[[Value, Value], Value] | None = None) -> None:
        self._merge = merge
        self._there = threading.Condition()
        self._value: Value | None = None
        self.closed = False
        """Whether there is nothing more to wait for."""
        self.replaced = 0
        """How many values nobody took."""

    def put(self, value: Value) -> None:
        """Leave a value."""
        with self._there:
            if self._value is not None:
                self.replaced += 1
                value = value if self._merge is None else self._merge(self._value, value)
            self._value = value
            self._there.notify()

    def take(self, timeout_s: float | None = None) -> Value | None:
        """Wait for a value and take it; ``None`` if none came in time, or the slot is closed."""
        with self._there:
            self._there.wait_for(lambda: self.closed or self._value is not None, timeout_s)
            value, self._value = self._value, None
            return None if self.closed else value

    def close(self) -> None:
        """Let whoever waits go."""
        with self._there:
            self.closed = True
            self._there.notify_all()


__all__ = ["Slot"]
