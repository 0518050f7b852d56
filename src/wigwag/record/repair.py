"""Read an MCAP file as far as it goes, and give one that was cut short its end."""

from __future__ import annotations

import fcntl
import io
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wigwag.errors import DataError, InputError
from wigwag.record.container import MAGIC, Index, chunked, library

_HEAD = 9
"""Bytes before a record's content: what it is, and how long."""


@dataclass(frozen=True, slots=True)
class Found:
    """One whole record of a file."""

    opcode: int
    offset: int
    length: int
    """Bytes of it, head included."""
    content: bytes

    def read(self, kind: str) -> Any:
        """Return it as the library's record of this name.

        Raises:
            DataError: If it is none.
        """
        lib = library()
        stream = lib.streams.ReadDataStream(io.BytesIO(self.content))
        try:
            return getattr(lib.records, kind).read(stream)
        except Exception as error:  # whatever the library meets in bytes that are no such record
            raise DataError(f"the record at byte {self.offset} is no {kind} ({error}).") from error


def scan(path: Path) -> Iterator[Found]:
    """Yield the whole records of a file from its beginning, until its data end or are cut short.

    Raises:
        DataError: If the file cannot be read or is no MCAP file.
    """
    try:
        file = path.open("rb")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}).") from error
    with file:
        size = os.fstat(file.fileno()).st_size
        if file.read(len(MAGIC)) != MAGIC:
            raise DataError(f"{path}: is no MCAP file: it does not begin as one.")
        offset = len(MAGIC)
        while offset + _HEAD <= size:
            head = file.read(_HEAD)
            length = int.from_bytes(head[1:], "little")
            if head[0] == library().opcodes.DATA_END or offset + _HEAD + length > size:
                return
            yield Found(head[0], offset, _HEAD + length, file.read(length))
            offset += _HEAD + length


@dataclass(frozen=True, slots=True)
class Repaired:
    """What :func:`repair` found and did."""

    complete: bool
    """It was whole already, and was left as it is."""
    chunks: int
    messages: int
    dropped_bytes: int
    """Cut off its end: a last chunk that was not written to its end."""


def is_whole(path: Path) -> bool:
    """Say whether a file ends as it should, with a summary.

    Raises:
        DataError: If the file cannot be read or is no MCAP file.
    """
    next(scan(path), None)
    data_end, footer, opcodes = _HEAD + 4, _HEAD + 20, library().opcodes
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        if size < len(MAGIC) + data_end + footer + len(MAGIC):
            return False
        file.seek(-footer - len(MAGIC), os.SEEK_END)
        tail = file.read()
        start = int.from_bytes(tail[_HEAD : _HEAD + 8], "little")
        if tail[0] != opcodes.FOOTER or not tail.endswith(MAGIC) or not data_end < start < size:
            return False
        # A kill may leave the beginning of a new chunk before the rest of the old end.
        file.seek(start - data_end)
        end = file.read(size - start + data_end - len(MAGIC))
    crc = zlib.crc32(end[data_end:-4])
    return end[0] == opcodes.DATA_END and crc == int.from_bytes(end[-4:], "little")


def repair(path: Path) -> Repaired:
    """Give a file that was cut short its end, in place: what is not whole goes, indexes and summary come.

    Nothing that is whole is moved or copied, and a repair that is itself cut short can be begun again.

    Raises:
        DataError: If the file cannot be read or is no MCAP file.
        InputError: If it cannot be written, or still is being written.
    """
    index, end, last = _index(path)
    messages = sum(index.counts.values())
    if is_whole(path):
        return Repaired(True, len(index.chunks), messages, 0)
    size = path.stat().st_size
    added = b""
    if last is not None:
        # The indexes of the last chunk's messages may be missing, all or some: they are written anew.
        end, added = last
    try:
        with path.open("r+b") as file:
            _lock(file.fileno(), path)
            file.seek(end)
            file.write(added + index.summary(end + len(added)))
            file.truncate()
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}).") from error
    return Repaired(False, len(index.chunks), messages, max(size - end - len(added), 0))


def _lock(file: int, path: Path) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise InputError(f"{path}: is being written; wait until the flight is over.") from error


def wait_until_written(path: Path) -> None:
    """Wait until nobody writes to a file any more, such as the rest of a flight that was killed."""
    with path.open("rb") as file:
        fcntl.flock(file.fileno(), fcntl.LOCK_SH)


def _index(path: Path) -> tuple[Index, int, tuple[int, bytes] | None]:
    """Return the index of all that is whole, where it ends, and what has to follow the last chunk there."""
    lib = library()
    opcodes, records = lib.opcodes, lib.records
    index, end = Index(), len(MAGIC)
    newest: Found | None = None
    for found in scan(path):
        if found.opcode == opcodes.CHUNK:
            try:
                _note_chunk(index, found)
            except DataError:
                break
            newest = found
        elif found.opcode == opcodes.MESSAGE_INDEX and index.chunks:
            part, chunk = found.read("MessageIndex"), index.chunks[-1]
            chunk.message_index_offsets[part.channel_id] = found.offset
            chunk.message_index_length += found.length
        elif found.opcode == opcodes.SCHEMA:
            schema = found.read("Schema")
            index.schemas[schema.id] = schema
        elif found.opcode == opcodes.CHANNEL:
            channel = found.read("Channel")
            index.channels[channel.id] = channel
        elif found.opcode == opcodes.ATTACHMENT:
            a = found.read("Attachment")
            index.attachments.append(
                records.AttachmentIndex(
                    found.offset, found.length, a.log_time, a.create_time, len(a.data), a.name, a.media_type
                )
            )
        elif found.opcode == opcodes.METADATA:
            name = found.read("Metadata").name
            index.metadata.append(records.MetadataIndex(found.offset, found.length, name))
        end = found.offset + found.length
    if newest is None or end < newest.offset + newest.length:
        return index, end, None
    after = newest.offset + newest.length
    if end - after != index.chunks[-1].message_index_length:
        return index, end, None  # something whole came after it, so its indexes are whole
    data, index.chunks[-1] = chunked(newest.read("Chunk"), _messages(newest), newest.offset)
    return index, end, (after, data[newest.length :])


def _note_chunk(index: Index, found: Found) -> None:
    chunk, messages = found.read("Chunk"), _messages(found)
    index.chunks.append(
        library().records.ChunkIndex(
            chunk_length=found.length,
            chunk_start_offset=found.offset,
            compression=chunk.compression,
            compressed_size=len(chunk.data),
            message_end_time=chunk.message_end_time,
            message_index_length=0,
            message_index_offsets={},
            message_start_time=chunk.message_start_time,
            uncompressed_size=chunk.uncompressed_size,
        )
    )
    for channel, some in messages.items():
        index.counts[channel] = index.counts.get(channel, 0) + len(some)


def unpacked(found: Found) -> bytes:
    """Return what is in a chunk.

    Raises:
        DataError: If it is damaged.
    """
    chunk = found.read("Chunk")
    try:
        stream, length = library().reading.get_chunk_data_stream(chunk)
        data: bytes = stream.read(length)
    except Exception as error:  # each compression fails in its own way
        raise DataError(f"the chunk at byte {found.offset} is damaged ({error}).") from error
    if len(data) != chunk.uncompressed_size or (
        chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc
    ):
        raise DataError(f"the chunk at byte {found.offset} is damaged: its checksum is another one.")
    return data


def members(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yield the records in a chunk: what each is, where it begins, its content."""
    at = 0
    while at + _HEAD <= len(data):
        length = int.from_bytes(data[at + 1 : at + _HEAD], "little")
        yield data[at], at, data[at + _HEAD : at + _HEAD + length]
        at += _HEAD + length


def _messages(found: Found) -> dict[int, list[tuple[int, int]]]:
    """Return time and place of each message in a chunk, by channel."""
    message = library().opcodes.MESSAGE
    result: dict[int, list[tuple[int, int]]] = {}
    for opcode, at, content in members(unpacked(found)):
        if opcode == message:
            channel = int.from_bytes(content[:2], "little")
            result.setdefault(channel, []).append((int.from_bytes(content[6:14], "little"), at))
    return result


__all__ = ["Found", "Repaired", "is_whole", "members", "repair", "scan", "unpacked", "wait_until_written"]
