"""Whole flights by the loop of ``wigwag fly``, over real MAVLink bytes in real UDP packets."""

from __future__ import annotations

import contextlib
import io
import json
import socket
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from wigwag.cli.app import run
from wigwag.cli.benchmark_mission import fly_mission
from wigwag.cli.fly import Fly
from wigwag.evaluate.lessons import LessonConfig, teach_procedural
from wigwag.evaluate.mission import Finding, Mission, MissionConfig
from wigwag.fly.values import Command, VehicleState
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot
from wigwag.record.flight import Flight
from wigwag.record.recorder import Recorder
from wigwag.record.replay import Comparison, Replay
from wigwag.sim.autopilot_config import FakeConfig
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.pointmass import PointMass
from wigwag.sim.tethered import TetheredVehicle
from wigwag.skeleton import Clip
from wigwag.stream.models import Taught, load_model, warm_up
from wigwag.vehicles import FlightMode

FAKES = (FakePx4, FakeArduPilot)


class UdpWire:
    """One way over the loopback: every packet goes through two sockets, and comes in the same turn."""

    def __init__(self) -> None:
        self.at, self.to = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self.at.bind(("127.0.0.1", 0))
        self.at.settimeout(5.0)
        self.on_the_way = 0
        self.packets = 0

    def send(self, packet: bytes, now_s: float) -> None:
        self.to.sendto(packet, self.at.getsockname())
        self.on_the_way += 1
        self.packets += 1

    def arrived(self, now_s: float) -> list[bytes]:
        count, self.on_the_way = self.on_the_way, 0
        return [self.at.recv(4096) for _ in range(count)]


@contextlib.contextmanager
def over_udp(fake) -> Iterator[TetheredVehicle]:
    """A real session and a fake autopilot, with sockets between, on a clock that is turned by hand."""
    vehicle = TetheredVehicle(fake)
    vehicle.up, vehicle.down = UdpWire(), UdpWire()  # type: ignore[assignment]
    vehicle.connect()
    try:
        yield vehicle
    finally:
        for wire in (vehicle.up, vehicle.down):
            wire.at.close()  # type: ignore[attr-defined]
            wire.to.close()  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> tuple[Taught, tuple[str, ...]]:
    """What three training people taught; whoever is flown for is none of them."""
    path = tmp_path_factory.mktemp("mission") / "model.wigwag"
    teach_procedural(path, config=LessonConfig(people=3))
    model, labels = load_model(path)
    warm_up(model)
    return model, labels


def report(mission: Mission, console: Console) -> str:
    lines = [f"{f.what}: {f.found} ({f.asked})" for f in mission.findings]
    return "\n".join([console.export_text(), *lines])


@pytest.mark.parametrize("make", FAKES, ids=lambda make: make.__name__)
def test_a_whole_mission_by_gestures(make, taught, tmp_path: Path) -> None:
    """Connect, arm, take off to 3 m, a minute of walking, six commands, land, disarmed."""
    console = Console(record=True, width=120, file=io.StringIO())
    with over_udp(make(airframe=PointMass(seed=5))) as vehicle:
        fake = vehicle.autopilot
        seen: list[FlightMode] = []
        armed: list[bool] = []

        def wait(seconds: float) -> None:
            vehicle.step(max(seconds, 0.001))
            if not seen or vehicle.mode is not seen[-1]:
                seen.append(vehicle.mode)
            if not armed or fake.armed != armed[-1]:
                armed.append(fake.armed)

        def truth() -> VehicleState:
            return replace(fake.airframe.state, stamp_ns=vehicle.now_ns)

        path = tmp_path / "flight.mcap"
        mission = fly_mission(
            console, vehicle, taught, Fly(altitude=3.0).settings(), MissionConfig(), seed=2, wait=wait,
            now_ns=lambda: vehicle.now_ns, truth=truth,
            record=lambda pilot: Recorder(path, pilot, pictures="none", patient=True),
        )  # fmt: skip
        told = report(mission, console)
        assert mission.good, told
        assert len(mission.findings) == 11, told
        assert armed == [False, True, False], "armed once, and disarmed at the end"
        assert fake.height_m == 0
        assert seen == [
            FlightMode.DISARMED, FlightMode.READY, FlightMode.TAKING_OFF, FlightMode.HOLDING,
            FlightMode.STEERED, FlightMode.LANDING, FlightMode.DISARMED,
        ], told  # fmt: skip
        assert vehicle.up.packets > 3000 and vehicle.down.packets > 10_000  # type: ignore[attr-defined]
        assert len(fake.received) > 2500, "set-points, thirty a second"
    compared = Comparison()
    for then, now in Replay(Flight.open(path)):
        compared.note(then, now)
    assert compared.same and compared.turns > 2500


class Deaf:
    """A recogniser that knows nothing."""

    def recognise(self, clip: Clip) -> Gesture:
        return Gesture(None)


def fly_deaf(fake, console: Console) -> Mission:
    labels = tuple(command.value for command in Command)
    with over_udp(fake) as vehicle:
        return fly_mission(
            console, vehicle, (Deaf(), labels), Fly(altitude=3.0).settings(), MissionConfig(),  # type: ignore[arg-type]
            wait=lambda seconds: vehicle.step(max(seconds, 0.001)), now_ns=lambda: vehicle.now_ns,
        )  # fmt: skip


def test_gestures_that_are_not_understood_are_a_mission_missed() -> None:
    fake, console = FakePx4(), Console(file=io.StringIO())
    mission = fly_deaf(fake, console)
    assert not mission.good and mission.over
    assert [(f.what, f.found) for f in mission.findings] == [("take-off", "not flown")]
    assert not fake.armed and not fake.received


def test_nothing_flies_that_is_not_in_order() -> None:
    console = Console(record=True, width=120, file=io.StringIO())
    mission = fly_deaf(FakeArduPilot(FakeConfig(battery=0.1)), console)
    assert not mission.findings and not mission.good
    assert "not in order" in console.export_text()


def test_the_command_tells_what_was_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake, at = FakePx4(), "wigwag.cli.benchmark_mission.fly_mission"
    monkeypatch.setattr("wigwag.cli.fly.Fly.model_file", lambda self, stack: Path("none"))
    monkeypatch.setattr("wigwag.stream.models.load_model", lambda path: (Deaf(), ()))
    monkeypatch.setattr("wigwag.stream.models.warm_up", lambda model: None)
    with over_udp(fake) as vehicle:
        monkeypatch.setattr("wigwag.drones.open_vehicle", lambda address: vehicle)

        def flown(console, vehicle, taught, settings, plan, *, seed, wait, record) -> Mission:
            assert (plan.walk_s, seed, settings.goal.altitude_m) == (5.0, 3, 2.5)
            pilot = Pilot(lambda frame: None, taught[0], vehicle)
            mission = Mission(None, pilot, lambda: vehicle.state, plan)  # type: ignore[arg-type]
            mission.over = True
            mission.findings = [Finding("up: missed its end by", "2.00 %", "15 % at most", good[0], 2.0)]
            return mission

        monkeypatch.setattr(at, flown)
        file = tmp_path / "mission.json"
        command = ["benchmark", "mission", "--height", "2.5", "--seconds", "5", "--seed", "3"]
        for good in ([True], [False]):
            assert run([*command, "--json", str(file)]) == (0 if good[0] else 1)
            (row,) = json.loads(file.read_text())
            assert (row["vehicle"], row["value"], row["good"]) == ("PX4 1.16.0", 2.0, good[0])
            assert ("missed" in capsys.readouterr().out.split("most")[-1]) is not good[0]
    assert run(["benchmark", "mission", "--seconds", "1"]) == 2
