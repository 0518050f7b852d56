"""An MCAP file that is whole at every moment: a program that is killed leaves a file that opens."""

from __future__ import annotations

import fcntl
import os
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from wigwag.errors import InputError
from wigwag.extras import load
from wigwag.record.scribe import Scribe

MAGIC = b"\x89MCAP0\r\n"
_LEVEL = 1
"""Of zstandard: pictures are compressed already, and depth and numbers shrink nearly as much as at 3."""


@cache
def library() -> SimpleNamespace:
    """Return the parts of the packages ``mcap`` and ``zstandard`` that are used.

    Raises:
        MissingExtraError: If they are not installed.
    """
    what = "A flight's recording"
    return SimpleNamespace(
        records=load("mcap.records", "record", what),
        opcodes=load("mcap.opcode", "record", what).Opcode,
        streams=load("mcap.data_stream", "record", what),
        reading=load("mcap.stream_reader", "record", what),
        zstandard=load("zstandard", "record", what),
    )


def check_target(path: Path) -> None:
    """Make sure that a flight can be recorded to a file, before anything else is done for it.

    Raises:
        InputError: If the file exists.
        MissingExtraError: If the extra ``record`` is not installed.
    """
    library()
    load("foxglove_schemas_protobuf", "record", "A flight's recording")
    if path.exists():
        raise InputError(f"{path}: there is a file already. Name another, or move it away.")


def record(value: Any) -> bytes:
    """Return one of the library's records as bytes."""
    builder = library().streams.RecordBuilder()
    value.write(builder)
    return bytes(builder.end())


@dataclass
class Index:
    """What the end of a file says of the rest of it."""

    schemas: dict[int, Any] = field(default_factory=dict)
    channels: dict[int, Any] = field(default_factory=dict)
    chunks: list[Any] = field(default_factory=list)
    attachments: list[Any] = field(default_factory=list)
    metadata: list[Any] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    """Messages a channel."""
    _encoded: list[bytes] = field(default_factory=list)

    def summary(self, end: int) -> bytes:
        """Return the end of a file whose data end at ``end``. Chunks must not change once this was asked."""
        lib = library()
        self._encoded += [record(chunk) for chunk in self.chunks[len(self._encoded) :]]
        records, opcodes = lib.records, lib.opcodes
        data_end = record(records.DataEnd(0))
        start = end + len(data_end)
        groups = (
            (opcodes.SCHEMA, map(record, self.schemas.values())),
            (opcodes.CHANNEL, map(record, self.channels.values())),
            (opcodes.STATISTICS, [record(self._statistics())]),
            (opcodes.CHUNK_INDEX, self._encoded),
            (opcodes.ATTACHMENT_INDEX, map(record, self.attachments)),
            (opcodes.METADATA_INDEX, map(record, self.metadata)),
        )
        body, offsets = b"", b""
        for opcode, members in groups:
            part = b"".join(members)
            if part:
                offsets += record(records.SummaryOffset(opcode, start + len(body), len(part)))
            body += part
        offset_start = start + len(body)
        footer = record(records.Footer(start, offset_start, 0))
        crc = zlib.crc32(footer[:-4], zlib.crc32(body + offsets))
        return data_end + body + offsets + footer[:-4] + crc.to_bytes(4, "little") + MAGIC

    def _statistics(self) -> Any:
        starts = [chunk.message_start_time for chunk in self.chunks]
        ends = [chunk.message_end_time for chunk in self.chunks]
        return library().records.Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts=dict(self.counts),
            chunk_count=len(self.chunks),
            message_count=sum(self.counts.values()),
            message_end_time=max(ends, default=0),
            message_start_time=min(starts, default=0),
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )


class Container:
    """Writes an MCAP file in chunks. After each the file ends as a file should, indexes and all.

    A chunk and the file's new end are handed to a process of its own as one write over the old end
    (:mod:`~wigwag.record.scribe`): if this program is killed, what was handed over is still written whole.
    The file is locked for as long as it is written. Not thread-safe.

    Args:
        path: The file; it must not exist yet.

    Raises:
        InputError: If the file exists or cannot be written.
        MissingExtraError: If the extra ``record`` is not installed.
    """

    def __init__(self, path: Path) -> None:
        lib = library()
        self._records, self._builder = lib.records, lib.streams.RecordBuilder()
        self._zstd = lib.zstandard.ZstdCompressor(level=_LEVEL)
        self.path, self.index = path, Index()
        self._messages: dict[int, list[tuple[int, int]]] = {}
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
        except OSError as error:
            if path.exists():
                raise InputError(f"{path}: there is a file already. Name another, or move it away.") from None
            raise InputError(f"{path}: cannot be written ({error.strerror}).") from error
        fcntl.flock(file, fcntl.LOCK_EX)  # the scribe's too: it holds as long as the scribe lives
        self._scribe: Scribe | None = Scribe(file)
        os.close(file)
        self._end = 0
        self._append(MAGIC + record(self._records.Header("", "wigwag")))

    @property
    def pending(self) -> int:
        """Bytes that wait for ``flush``."""
        return int(self._builder.count)

    @property
    def size(self) -> int:
        """Bytes of the file, without its end."""
        return self._end

    def channel(self, topic: str, encoding: str, schema: tuple[str, str, bytes]) -> int:
        """Add a channel and return its number.

        Args:
            topic: Its name.
            encoding: Of its messages: ``"json"`` or ``"protobuf"``.
            schema: Name, encoding and text of their schema.
        """
        name, schema_encoding, data = schema
        numbers = [s.id for s in self.index.schemas.values() if s.name == name]
        added = b""
        if numbers:
            schema_id = numbers[0]
        else:
            schema_id = len(self.index.schemas) + 1
            self.index.schemas[schema_id] = self._records.Schema(schema_id, data, schema_encoding, name)
            added += record(self.index.schemas[schema_id])
        number = len(self.index.channels) + 1
        self.index.channels[number] = self._records.Channel(number, topic, encoding, {}, schema_id)
        self._append(added + record(self.index.channels[number]))
        return number

    def message(self, channel: int, log_ns: int, stamp_ns: int, sequence: int, data: bytes) -> None:
        """Add a message to the chunk that is being gathered."""
        self._messages.setdefault(channel, []).append((max(log_ns, 0), self._builder.count))
        self._records.Message(channel, max(log_ns, 0), data, max(stamp_ns, 0), sequence).write(self._builder)

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Add a file."""
        self.flush()
        whole = record(self._records.Attachment(0, 0, name, media_type, data))
        self.index.attachments.append(
            self._records.AttachmentIndex(self._end, len(whole), 0, 0, len(data), name, media_type)
        )
        self._append(whole)

    def metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Add a table of texts."""
        self.flush()
        whole = record(self._records.Metadata(name=name, metadata=dict(data)))
        self.index.metadata.append(self._records.MetadataIndex(self._end, len(whole), name))
        self._append(whole)

    def flush(self) -> None:
        """Hand the chunk that has been gathered to the operating system."""
        if not self._messages:
            return
        data = self._builder.end()
        stamps = [stamp for messages in self._messages.values() for stamp, _ in messages]
        chunk = self._records.Chunk(
            "zstd", self._zstd.compress(data), max(stamps), min(stamps), zlib.crc32(data), len(data)
        )
        added, index = chunked(chunk, self._messages, self._end)
        self.index.chunks.append(index)
        for channel, messages in self._messages.items():
            self.index.counts[channel] = self.index.counts.get(channel, 0) + len(messages)
        self._messages = {}
        self._append(added)

    def close(self) -> None:
        """Write what is pending, and close the file. Closing twice does nothing."""
        if self._scribe is None:
            return
        try:
            self.flush()
        finally:
            scribe, self._scribe = self._scribe, None
            scribe.close()

    def _append(self, data: bytes) -> None:
        """Write over the old end; the new one lies behind it."""
        if self._scribe is not None:
            self._scribe.write(self._end, data + self.index.summary(self._end + len(data)))
        self._end += len(data)


def chunked(chunk: Any, messages: Mapping[int, list[tuple[int, int]]], start: int) -> tuple[bytes, Any]:
    """Return a chunk with the indexes of its messages as bytes, and what the summary says of it.

    Args:
        chunk: The library's record.
        messages: Time and place in the uncompressed chunk of each message, by channel.
        start: Where the chunk begins in the file.
    """
    records = library().records
    data = record(chunk)
    length, offsets, added = len(data), {}, []
    at = start + length
    for channel, found in messages.items():
        part = record(records.MessageIndex(channel, found))
        offsets[channel] = at
        at += len(part)
        added.append(part)
    index = records.ChunkIndex(
        chunk_length=length,
        chunk_start_offset=start,
        compression=chunk.compression,
        compressed_size=len(chunk.data),
        message_end_time=chunk.message_end_time,
        message_index_length=at - start - length,
        message_index_offsets=offsets,
        message_start_time=chunk.message_start_time,
        uncompressed_size=chunk.uncompressed_size,
    )
    return data + b"".join(added), index


__all__ = ["MAGIC", "Container", "Index", "check_target", "chunked", "library", "record"]
