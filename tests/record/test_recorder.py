"""A flight written down is read back to the last bit, by us and by others, and survives kills."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader

from tests.record.flights import flight, picture, record
from wigwag.errors import DataError, InputError, MissingExtraError
from wigwag.fly.situation import Mode
from wigwag.record import container
from wigwag.record.codec import text
from wigwag.record.flight import Flight
from wigwag.record.recorder import Recorder
from wigwag.record.repair import is_whole, scan, wait_until_written
from wigwag.record.scribe import Scribe
from wigwag.record.turns import CLOUD, IMAGE, SKELETON


def test_every_turn_is_read_back_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    steps = record(path, model=b"what was taught", facts={"camera": "sketch:"})
    flown = Flight.open(path)
    turns = list(flown.turns())
    assert [turn.number for turn in turns] == list(range(420))
    for turn, step in zip(turns, steps, strict=True):
        assert turn.turn.situation == step.situation and turn.turn.verdict == step.verdict
        assert turn.told.wish == step.wish and turn.told.sent == step.permit.setpoint
        assert turn.turn.goal == step.goal and turn.gesture == step.gesture
        assert text(turn.state) == text(step.state) and text(turn.pose) == text(step.pose)
    assert flown.model == b"what was taught" and flown.facts["camera"] == "sketch:"
    assert flown.config == flight().pilot.config and flown.commands == flight().pilot.commands
    assert flown.mode is Mode.DISARMED and flown.pose_config is None and not flown.tells_operator


def test_frames_come_back_and_png_and_depth_lose_nothing(tmp_path: Path) -> None:
    path = tmp_path / "png.mcap"
    flown = flight()
    recorder = Recorder(path, flown.pilot, pictures="png", depth=True, patient=True)
    for turn in range(30):
        step = flown.turn()
        recorder.turn(picture(turn) if turn != 7 else None, flown.world.now_ns, step)
    recorder.close()
    for turn, (_, frame) in enumerate(Flight.open(path).frames()):
        if turn == 7:
            assert frame is None
            continue
        expected = picture(turn)
        assert frame is not None and frame.depth_mm is not None and expected.depth_mm is not None
        np.testing.assert_array_equal(frame.rgb, expected.rgb)
        np.testing.assert_array_equal(frame.depth_mm, expected.depth_mm)
        assert (frame.stamp_ns, frame.intrinsics) == (expected.stamp_ns, expected.intrinsics)


def test_the_size_of_pictures_is_kept_to_whatever_they_show(tmp_path: Path) -> None:
    """Noise is the worst that JPEG can meet: the quality goes down until the size fits, or is least."""
    flown, path = flight(), tmp_path / "noise.mcap"
    rng = np.random.default_rng(0)
    soft = [cv2.GaussianBlur(rng.integers(0, 255, (480, 640, 3), np.uint8), (0, 0), 2.0) for _ in range(4)]
    recorder = Recorder(path, flown.pilot, patient=True)
    for turn in range(60):
        step, frame = flown.turn(), picture(turn)
        recorder.turn(type(frame)(soft[turn % 4], None, frame.intrinsics, frame.stamp_ns), turn, step)
    recorder.close()
    with path.open("rb") as file:
        sizes = [len(m.data) for _, _, m in make_reader(file).iter_messages(topics=[IMAGE])]
    assert sizes[0] > 22_000, "it begins with more than it may"
    assert np.mean(sizes[30:]) < 640 * 480 * 0.5 / 8 * 1.1
    assert np.mean(sizes[30:]) > 640 * 480 * 0.5 / 8 * 0.7


def test_foxglove_reads_what_there_is_to_see(tmp_path: Path) -> None:
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
    from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    path = tmp_path / "flight.mcap"
    record(path, 90, pictures=True, depth=True)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        images = [m.data for _, _, m in reader.iter_messages(topics=[IMAGE])]
        scenes = [m.data for _, _, m in reader.iter_messages(topics=[SKELETON])]
        topics = {channel.topic for _, channel, _ in reader.iter_messages()}
    assert len(images) == 90
    image = CompressedImage.FromString(images[3])
    assert image.format == "jpeg" and image.timestamp.nanos == 100_000_000
    assert cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR).shape == (48, 64, 3)
    entity = SceneUpdate.FromString(scenes[-1]).entities[0]
    assert len(entity.lines[0].points) == 28 and entity.lines[0].points[0].z > 3
    with path.open("rb") as file:
        clouds = [m.data for _, _, m in make_reader(file).iter_messages(topics=[CLOUD])]
    cloud = PointCloud.FromString(clouds[-1])
    points = np.frombuffer(cloud.data, np.dtype([("at", "<f4", 3), ("rgba", "u1", 4)]))
    scene = np.array([[p.x, p.y, p.z] for p in entity.lines[0].points])
    assert cloud.point_stride == 16 and len(points) == 14 * 5
    np.testing.assert_allclose(points["at"].reshape(14, 5, 3)[:, [0, -1]].reshape(-1, 3), scene, atol=1e-6)
    assert topics >= {"/camera/depth", "/camera/calibration", "/tf", "/vehicle/state", "/setpoint"}


KILLED = """
    from pathlib import Path
    from tests.record.flights import SAID, flight, picture
    from wigwag.record.recorder import Recorder
    flown = flight()
    recorder = Recorder(Path({path!r}), flown.pilot, patient=True, model=b"taught")
    for turn in range(100_000):
        step = flown.turn(SAID.get(turn))
        recorder.turn(picture(turn), flown.world.now_ns, step)
        print(flown.world.now_ns, flush=True)
"""


@pytest.mark.parametrize("lines", [3, 40, 55, 151])
def test_a_kill_takes_at_most_a_second_away(tmp_path: Path, lines: int) -> None:
    path = tmp_path / "killed.mcap"
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(KILLED.format(path=str(path)))],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[2],
    ) as process:
        assert process.stdout is not None
        for _ in range(lines):
            process.stdout.readline()
        os.kill(process.pid, signal.SIGKILL)
        flown = [int(line) for line in process.stdout.read().split(b"\n") if line]
    wait_until_written(path)
    with path.open("rb") as file:
        stamps = [m.log_time for _, _, m in make_reader(file).iter_messages(topics=["/wigwag/turn"])]
    assert is_whole(path)
    turns = list(Flight.open(path).turns())
    assert [turn.turn.now_ns for turn in turns] == stamps
    last_ns = max(flown, default=0)
    assert last_ns - max(stamps, default=0) <= 1_000_000_000


def test_one_cut_short_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    record(path, 120)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 2 // 3])
    turns = list(Flight.open(path).turns())
    assert 30 < len(turns) < 110
    path.write_bytes(whole)
    chunks = [found for found in scan(path) if found.opcode == container.library().opcodes.CHUNK]
    damaged = bytearray(whole)
    damaged[chunks[2].offset + chunks[2].length // 2] ^= 0xFF
    path.write_bytes(damaged)
    with pytest.raises(DataError, match="is damaged"):
        list(Flight.open(path).turns())


def test_a_full_disk_ends_no_flight(tmp_path: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("there is no full disk here")
    flown = flight()
    recorder = Recorder(tmp_path / "f.mcap", flown.pilot, patient=True)
    full = os.open("/dev/full", os.O_WRONLY)
    recorder._file._scribe = Scribe(full)
    os.close(full)
    for turn in range(90):
        recorder.turn(picture(turn), flown.world.now_ns, flown.turn())
    recorder.close()
    assert "No space left" in recorder.failed
    assert not list(Flight.open(tmp_path / "f.mcap").turns())


def test_what_writes_may_die_too(tmp_path: Path) -> None:
    flown = flight()
    recorder = Recorder(tmp_path / "f.mcap", flown.pilot, patient=True)
    assert recorder._file._scribe is not None
    recorder._file._scribe._process.kill()
    for turn in range(90):
        recorder.turn(picture(turn), flown.world.now_ns, flown.turn())
    recorder.close()
    assert "what writes it was killed" in recorder.failed


def test_a_disk_that_does_not_keep_up_costs_pictures_and_no_turns(tmp_path: Path) -> None:
    import threading

    gate, path, flown = threading.Event(), tmp_path / "f.mcap", flight()
    recorder = Recorder(path, flown.pilot)
    write = recorder._write
    recorder._write = lambda *item: (gate.wait(), write(*item))  # type: ignore[method-assign]
    for turn in range(40):
        step = flown.turn()
        recorder.turn(picture(turn), flown.world.now_ns, step)
    gate.set()
    recorder.close()
    assert 28 <= recorder.left_out <= 31
    frames = [frame for _, frame in Flight.open(path).frames()]
    assert len(frames) == 40 and sum(frame is not None for frame in frames) == 40 - recorder.left_out


def test_what_is_no_flight_is_told(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    container.Container(path).close()
    with pytest.raises(DataError, match="is no flight that wigwag recorded"):
        Flight.open(path)
    record(tmp_path / "a.mcap", 3)
    with pytest.raises(InputError, match="there is a file already"):
        container.check_target(tmp_path / "a.mcap")
    newer = (
        (tmp_path / "a.mcap").read_bytes().replace(b"version\x01\x00\x00\x001", b"version\x01\x00\x00\x009")
    )
    path.write_bytes(newer)
    with pytest.raises(DataError, match="written in version 9, but this wigwag reads up to 1"):
        Flight.open(path)


def test_without_the_extra_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    container.library.cache_clear()
    monkeypatch.setitem(sys.modules, "mcap.records", None)
    with pytest.raises(MissingExtraError, match=r"wigwag\[record\]"):
        Recorder(tmp_path / "f.mcap", flight().pilot)
    container.library.cache_clear()
