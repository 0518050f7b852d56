"""Values as JSON and back again, to the last bit; and what JSON Schema says of their types."""

from __future__ import annotations

import json
import math
import re
import sys
import types
import typing
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Union

import numpy as np

from wigwag.errors import DataError
from wigwag.fly.fence import Cylinder, Fence, Polygon

_CHOICES: dict[Any, tuple[Any, ...]] = {Fence: (Cylinder, Polygon)}
"""Protocols that stand as types of fields, and the values that are written for them."""


def plain(value: Any) -> Any:
    """Turn a value into what JSON knows, losing nothing.

    Dataclasses become objects, enums their values. Numbers that are not finite become ``"inf"``, ``"-inf"``
    and ``"nan"``. Arrays become lists; those that are not float64 say what they are.

    Example:
        >>> plain((1.5, float("inf"), np.zeros(2, np.float32)))
        [1.5, 'inf', {'dtype': 'float32', 'values': [0.0, 0.0]}]
    """
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else repr(float(value))
    if isinstance(value, str | int):
        return value
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if _is_record(value):
        kind: Any = type(value)
        return {name: plain(getattr(value, name)) for name in _names(kind)}
    return str(value)


def text(value: Any) -> bytes:
    """Return a value as JSON text: equal for values that are equal to the last bit, and for those alone."""
    return json.dumps(plain(value), separators=(",", ":"), allow_nan=False).encode()


def _array(value: np.ndarray) -> Any:
    listed = value.tolist()
    if value.dtype != np.float64:
        return {"dtype": str(value.dtype), "values": listed}
    return listed if np.isfinite(value).all() else plain(listed)


def _is_record(kind: Any) -> bool:
    return is_dataclass(kind)


@cache
def _names(kind: Any) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


@cache
def _hints(kind: Any) -> dict[str, Any]:
    known = vars(sys.modules[kind.__module__])
    return {field.name: _hint(field.type, known) for field in fields(kind)}


def _hint(written: Any, known: dict[str, Any]) -> Any:
    """Return a field's type from what stands in the source; of arrays, only that and how deep they are."""
    if not isinstance(written, str):
        return written
    if array := re.fullmatch(r"\w+\[np\.ndarray, (.+)\](?P<maybe> \| None)?", written):
        depth = len(array[1].strip("\"' ").split())
        nested = typing.Annotated[np.ndarray, depth]
        return nested | None if array["maybe"] else nested
    return eval(written, known)  # our own source, as typing.get_type_hints does


def revived(kind: Any, value: Any) -> Any:
    """Take back what :func:`plain` gave.

    Args:
        kind: The type it was: a dataclass, an enum, a union, a tuple, a number, an array, ...
        value: As JSON has it.

    Raises:
        DataError: If the value cannot be one of this type.

    Example:
        >>> revived(tuple[float, ...], plain((1.5, float("-inf"))))
        (1.5, -inf)
    """
    try:
        return _revived(kind, value)
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, DataError):
            raise
        raise DataError(
            f"expected a {getattr(kind, '__name__', kind)}, but got {value!r} ({error})."
        ) from error


def _revived(kind: Any, value: Any) -> Any:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if kind in _CHOICES or origin in (Union, types.UnionType):
        return _one_of(_CHOICES.get(kind, parts), value)
    if kind is Any or origin is typing.Literal:
        return value
    if origin is tuple:
        kinds = [parts[0]] * len(value) if parts[1:] == (...,) else parts
        return tuple(_revived(k, v) for k, v in zip(kinds, value, strict=True))
    if origin is list:
        return [_revived(parts[0], v) for v in value]
    if origin is not None and issubclass(origin, Mapping):
        return {key: _revived(parts[1], v) for key, v in value.items()}
    if _is_record(kind):
        hints = _hints(kind)
        known = {name: _revived(hints[name], v) for name, v in value.items() if name in hints}
        return kind(**known)
    if origin is Annotated:
        if isinstance(value, dict):
            return np.array(value["values"], dtype=value["dtype"])
        return np.array(value, dtype=np.float64)
    if kind in (float, int, bool) and value is None:
        raise ValueError("it is missing")
    return kind(value)


def _one_of(kinds: tuple[Any, ...], value: Any) -> Any:
    """Return the value as the first type that fits it."""
    if value is None:
        if type(None) in kinds:
            return None
        raise ValueError("it is missing")
    for kind in kinds:
        if kind is type(None):
            continue
        if _is_record(kind) and not (isinstance(value, dict) and set(value) <= set(_names(kind))):
            continue
        return _revived(kind, value)
    raise ValueError(f"it is none of {kinds}")


def schema(kind: Any) -> dict[str, Any]:
    """Return what JSON Schema says of a type, so that viewers know what can be plotted.

    Fields that Foxglove's reader has no type for, arrays of arrays and mappings, are not described: it would
    refuse the whole channel. They stand in the messages all the same.

    Example:
        >>> schema(tuple[float, ...])
        {'type': 'array', 'items': {'type': 'number'}}
    """
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if kind in _CHOICES or origin in (Union, types.UnionType):
        some = [part for part in _CHOICES.get(kind, parts) if part is not type(None)]
        return schema(some[0])
    if origin in (tuple, list):
        return {"type": "array", "items": schema(parts[0])}
    if _is_record(kind):
        own = {name: schema(hint) for name, hint in _hints(kind).items()}
        shown = {name: said for name, said in own.items() if _has_a_type_in_foxglove(said)}
        return {"type": "object", "title": kind.__name__, "properties": shown}
    if origin is typing.Literal:
        return schema(type(parts[0]))
    if origin is Annotated:
        inner: dict[str, Any] = {"type": "number"}
        for _ in range(parts[1]):
            inner = {"type": "array", "items": inner}
        return inner
    names = {float: "number", int: "integer", bool: "boolean"}
    if kind in names:
        return {"type": names[kind]}
    return {"type": "string"} if kind in (str, Path) or isinstance(kind, type) else {}


def _has_a_type_in_foxglove(said: dict[str, Any]) -> bool:
    items = said.get("items", {"type": "none of an array"})
    return "type" in said and items.get("type", "array") != "array"


__all__ = ["plain", "revived", "schema", "text"]
