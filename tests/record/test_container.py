"""The file is whole at every moment, and what a kill in the wrong one leaves is mended."""

from __future__ import annotations

import fcntl
import io
import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from wigwag.errors import DataError, InputError
from wigwag.record.container import Container
from wigwag.record.repair import is_whole, repair, wait_until_written
from wigwag.record.scribe import serve

SCHEMA = ("wigwag.Test", "jsonschema", b"{}")


def write(path: Path, chunks: int = 4, each: int = 3) -> Container:
    file = Container(path)
    file.metadata("wigwag", {"what": "a test"})
    file.attach("model", "text/plain", b"taught")
    a, b = (file.channel(topic, "json", SCHEMA) for topic in ("/a", "/b"))
    for k in range(chunks):
        for i in range(each):
            number = k * each + i
            file.message(a, number * 10, number * 10 - 3, number, b'{"n":%d}' % number)
            if i == 0:
                file.message(b, number * 10, 0, number, b'{"k":%d}' % k)
        file.flush()
    return file


def numbers(data: bytes, topic: str = "/a") -> list[int]:
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    return [message.sequence for _, _, message in reader.iter_messages(topics=[topic])]


def test_it_is_whole_after_every_chunk_and_readers_seek_in_it(tmp_path: Path) -> None:
    path = tmp_path / "f.mcap"
    for chunks in range(4):
        path.unlink(missing_ok=True)
        file = write(path, chunks)
        file._scribe.close()  # type: ignore[union-attr]  # everything is handed over, nothing more is
        file._scribe = None
        data = path.read_bytes()
        assert is_whole(path)
        assert numbers(data) == list(range(3 * chunks))
        assert numbers(data, "/b") == [3 * k for k in range(chunks)]
        summary = make_reader(io.BytesIO(data)).get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 4 * chunks
        file.close()
    reader = make_reader(io.BytesIO(path.read_bytes()))
    assert [a.data for a in reader.iter_attachments()] == [b"taught"]
    assert [m.metadata for m in reader.iter_metadata()] == [{"what": "a test"}]
    some = [m.sequence for _, _, m in reader.iter_messages(topics=["/a"], starting_at=35, ending_before=75)]
    assert some == [4, 5, 6, 7]
    assert list(StreamReader(io.BytesIO(path.read_bytes()), validate_crcs=True).records)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_whatever_is_cut_off_is_mended(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    path = tmp_path_factory.mktemp("cut") / "f.mcap"
    write(path).close()
    whole = path.read_bytes()
    cut = data.draw(st.integers(8, len(whole) - 1))
    path.write_bytes(whole[:cut])
    done = repair(path)
    assert not done.complete and is_whole(path)
    mended = path.read_bytes()
    kept = numbers(mended)
    assert kept == list(range(len(kept))) and done.messages == len(kept) + len(kept) // 3
    assert numbers(mended, "/b") == list(range(0, len(kept), 3))
    assert list(StreamReader(io.BytesIO(mended), validate_crcs=True).records)
    assert repair(path).complete and path.read_bytes() == mended, "mending twice changes nothing"


def test_a_last_chunk_of_rubbish_is_taken_off(tmp_path: Path) -> None:
    """A kill within the writing of a chunk leaves its beginning before the rest of the old end."""
    path = tmp_path / "f.mcap"
    file = write(path, 2)
    end = file.size
    file.close()
    size = path.stat().st_size
    write(tmp_path / "g.mcap", 3).close()
    longer, whole = (tmp_path / "g.mcap").read_bytes(), path.read_bytes()
    for written in (1, 5, 9, 12, 60):
        torn = bytearray(whole)
        torn[end : end + written] = longer[end : end + written]
        path.write_bytes(torn)
        assert len(torn) == size
        repair(path)
        assert numbers(path.read_bytes()) == list(range(6)), written


def test_while_it_is_written_it_is_not_mended(tmp_path: Path) -> None:
    path = tmp_path / "f.mcap"
    write(path, 1).close()
    os.truncate(path, path.stat().st_size - 20)
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_SH)
        with pytest.raises(InputError, match="is being written; wait until the flight is over"):
            repair(path)
    other = Container(tmp_path / "g.mcap")
    with (tmp_path / "g.mcap").open("rb") as file, pytest.raises(BlockingIOError):
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    other.close()
    wait_until_written(tmp_path / "g.mcap")
    assert not repair(path).complete and numbers(path.read_bytes()) == [0, 1, 2]


def test_a_write_that_did_not_arrive_whole_is_dropped(tmp_path: Path) -> None:
    path = tmp_path / "f"
    with path.open("w+b") as file:
        head = (0).to_bytes(8, "little") + (4).to_bytes(8, "little")
        assert serve(io.BytesIO(head + b"abcd" + head + b"xy"), file.fileno()) == 0
        assert serve(io.BytesIO(head[:9]), file.fileno()) == 0
        assert path.read_bytes() == b"abcd"


def test_what_is_no_mcap_file_is_told_and_left(tmp_path: Path) -> None:
    path = tmp_path / "f.mcap"
    with pytest.raises(DataError, match="cannot be read"):
        repair(path)
    path.write_bytes(b"something else, and long enough to be one")
    with pytest.raises(DataError, match="is no MCAP file"):
        repair(path)
    assert path.read_bytes().startswith(b"something")


def test_no_file_is_written_over(tmp_path: Path) -> None:
    path = tmp_path / "f.mcap"
    write(path).close()
    with pytest.raises(InputError, match="there is a file already"):
        Container(path)
    with pytest.raises(InputError, match="cannot be written"):
        Container(path / "below.mcap")
