"""Published networks, rewritten where that serves: what nobody reads is not computed.

A ``.tflite`` file is a flatbuffer: tables that name others by their distance, which always lie further on. So
a network is changed by a new root in front of its bytes, which stay as they are: the new tables name some of
the old ones, and new ones of their own. Numbers of fields are those of TensorFlow Lite's schema (schema.fbs).
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from wigwag.errors import ModelError

ALIGNMENT = 64
"""Bytes. Weights are used where they lie in the file, so its parts keep to multiples of this."""

_VERSION, _CODES, _SUBGRAPHS, _DESCRIPTION, BUFFERS, _OLD_METADATA, METADATA, _SIGNATURES = range(8)
"""Fields of a network's root."""
_TENSORS, _INPUTS, _OUTPUTS, _OPERATORS, _NAME = range(5)
"""Fields of its graph."""
_OPERATOR_INPUTS, _OPERATOR_OUTPUTS = 1, 2
_TENSOR_SHAPE = 0


class Reader:
    """A network's tables, read as far as they are asked for.

    Args:
        data: A ``.tflite`` file.

    Raises:
        ModelError: If it is none.
    """

    def __init__(self, data: bytes) -> None:
        from flatbuffers import encode, number_types, table

        if data[4:8] != b"TFL3":
            raise ModelError(f"Expected a TensorFlow Lite network, but its bytes begin with {data[:8]!r}.")
        self._data, self._flags, self._table = data, number_types, table.Table
        with whole_file():
            self.root = int(encode.Get(number_types.UOffsetTFlags.packer_type, data, 0))

    def place(self, owner: int, field: int) -> int:
        """Return the position of what a table's field names, 0 if it names nothing."""
        table = self._table(self._data, owner)
        offset = table.Offset(4 + 2 * field)
        place = int(table.Indirect(owner + offset)) if offset else 0
        if place >= len(self._data):
            raise IndexError(f"byte {place} is named, but there are {len(self._data)}")
        return place

    def number(self, owner: int, field: int) -> int:
        """Return the unsigned number in a table's field."""
        table = self._table(self._data, owner)
        offset = table.Offset(4 + 2 * field)
        return int(table.Get(self._flags.Uint32Flags, owner + offset)) if offset else 0

    def numbers(self, owner: int, field: int) -> list[int]:
        """Return the numbers in a table's vector."""
        if not (place := self.place(owner, field)):
            return []
        (count,) = struct.unpack_from("<I", self._data, place)
        return list(struct.unpack_from(f"<{count}i", self._data, place + 4))

    def tables(self, owner: int, field: int) -> list[int]:
        """Return the positions of the tables in a table's vector."""
        begins = self.place(owner, field) + 4
        return [begins + 4 * i + step for i, step in enumerate(self.numbers(owner, field))]

    def text(self, owner: int, field: int) -> str:
        """Return the text that a table's field names."""
        if not (place := self.place(owner, field)):
            return ""
        (length,) = struct.unpack_from("<I", self._data, place)
        return self._data[place + 4 : place + 4 + length].decode()


@contextmanager
def whole_file() -> Iterator[None]:
    """Turn what goes wrong while a damaged network is read into ``ModelError``."""
    try:
        yield
    except (struct.error, IndexError, OverflowError, UnicodeDecodeError, TypeError) as error:
        # TypeError is what flatbuffers makes of a position before the file.
        raise ModelError(f"The network is no whole TensorFlow Lite file ({error}).") from error


class Rewriter:
    """A network that gets a new root.

    Args:
        data: A ``.tflite`` file.

    Raises:
        ModelError: If it is none.
    """

    def __init__(self, data: bytes) -> None:
        from flatbuffers import Builder

        self.read = Reader(data)
        self.builder: Any = Builder(len(data) + 65536)
        self.builder.Prep(ALIGNMENT, 0)
        self._end = self.builder.CreateByteVector(data + bytes(-len(data) % ALIGNMENT)) - 4

    def old(self, position: int) -> int:
        """Return where the builder finds what stood at a position of the old file: it counts from the end."""
        return int(self._end - position)

    def finish(self, new: Mapping[int, int]) -> bytes:
        """Return the network with a new root, in which these fields name something else than before."""
        read, root = self.read, self.read.root
        names = (_CODES, _SUBGRAPHS, _DESCRIPTION, BUFFERS, _OLD_METADATA, METADATA, _SIGNATURES)
        kept = {field: self.old(place) for field in names if (place := read.place(root, field))}
        self.builder.StartObject(8)
        self.builder.PrependUint32Slot(_VERSION, read.number(root, _VERSION), 0)
        for field, offset in {**kept, **new}.items():
            self.builder.PrependUOffsetTRelativeSlot(field, offset, 0)
        self.builder.Finish(self.builder.EndObject(), file_identifier=b"TFL3")
        return bytes(self.builder.Output())


def only_outputs(data: bytes, shapes: Sequence[tuple[int, ...]]) -> bytes:
    """Return a network that computes some of its outputs, and nothing that leads to the others alone.

    BlazePose's landmark networks also draw a mask of the person, at full size: a tenth of the arithmetic of
    'full', but two fifths of its time. What is kept is computed as before, bit for bit.

    Args:
        data: A ``.tflite`` file with one graph.
        shapes: Of the outputs to keep; others are dropped.

    Raises:
        ModelError: If it is no such file, or no output has one of these shapes.
    """
    new = Rewriter(data)
    read, builder = new.read, new.builder
    with whole_file():
        graphs = read.tables(read.root, _SUBGRAPHS)
        if len(graphs) != 1:
            raise ModelError(f"Expected a network with one graph, but it has {len(graphs)}.")
        graph = graphs[0]
        tensors = read.tables(graph, _TENSORS)
        there = {i: tuple(read.numbers(tensors[i], _TENSOR_SHAPE)) for i in read.numbers(graph, _OUTPUTS)}
        for shape in shapes:
            if shape not in there.values():
                raise ModelError(
                    f"No output has shape {shape}; there are {sorted(there.values())}. "
                    "Is it another network or version?"
                )
        outputs = [i for i, shape in there.items() if shape in shapes]
        operators = _leading_to(outputs, read.tables(graph, _OPERATORS), read)
        kept = {f: new.old(place) for f in (_TENSORS, _INPUTS, _NAME) if (place := read.place(graph, f))}
    kept[_OUTPUTS] = vector(builder, outputs, builder.PrependInt32)
    kept[_OPERATORS] = vector(builder, [new.old(position) for position in operators])
    return new.finish({_SUBGRAPHS: vector(builder, [table(builder, kept)])})


def _leading_to(outputs: Sequence[int], operators: Sequence[int], read: Reader) -> list[int]:
    """Return the operators whose results are asked for, or asked for by those."""
    wanted, kept = set(outputs), []
    for operator in reversed(operators):  # a network's operators stand in the order in which they run
        if wanted.intersection(read.numbers(operator, _OPERATOR_OUTPUTS)):
            wanted.update(read.numbers(operator, _OPERATOR_INPUTS))
            kept.append(operator)
    return kept[::-1]


def table(builder: Any, fields: Mapping[int, int]) -> int:
    """Write a table of offsets and return where it is."""
    builder.StartObject(max(fields) + 1)
    for field, offset in fields.items():
        builder.PrependUOffsetTRelativeSlot(field, offset, 0)
    return int(builder.EndObject())


def vector(builder: Any, values: Sequence[float], prepend: Callable[[Any], None] | None = None) -> int:
    """Write a vector of four-byte values, offsets by default, and return where it is."""
    builder.StartVector(4, len(values), 4)
    for value in reversed(values):
        (prepend or builder.PrependUOffsetTRelative)(value)
    return int(builder.EndVector())


__all__ = [
    "ALIGNMENT",
    "BUFFERS",
    "METADATA",
    "Reader",
    "Rewriter",
    "only_outputs",
    "table",
    "vector",
    "whole_file",
]
