"""``wigwag fly``: what is looked at before, how it flies, how it ends."""

from __future__ import annotations

import io
import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from wigwag.camera.frame import Frame
from wigwag.cli.app import run
from wigwag.cli.fly import Fly
from wigwag.cli.flying import Flying
from wigwag.cli.preflight import Check, check_camera, check_model, check_vehicle
from wigwag.errors import CameraError, InputError
from wigwag.evaluate.prompted import Nobody, Prompter
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.pilot import Pilot
from wigwag.record.flight import Flight
from wigwag.record.recorder import Recorder
from wigwag.record.replay import Comparison, Replay
from wigwag.rig import Rig
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld
from wigwag.stream import models
from wigwag.vehicles import FlightMode
from wigwag.vehicles.dry import DryVehicle


class SketchCamera:
    """Lets a sketched world go on whenever it is looked at."""

    address = "sketch:"

    def __init__(self, world: SketchWorld) -> None:
        self.world, self.ended, self.fails_at_s = world, False, float("inf")
        self.at: dict[float, Any] = {}
        """What is done at a time, seconds."""

    @property
    def now_ns(self) -> int:
        return self.world.now_ns

    def latest(self, timeout_s: float = 1.0) -> Frame | None:
        frame = self.world.step()
        for when in [t for t in self.at if t <= self.now_ns * 1e-9]:
            self.at.pop(when)()
        if self.now_ns * 1e-9 > self.fails_at_s:
            raise CameraError("unplugged")
        return frame


class Bench:
    """A flight in a sketched world, by the loop of ``wigwag fly``."""

    def __init__(self, record: Path | None = None, dry: bool = False, **ends: Any) -> None:
        airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), 2)
        self.world = SketchWorld(airframe, lambda t: (4.5, 0.2), seed=2)
        self.camera = SketchCamera(self.world)
        vehicle = self.world.vehicle
        self.rig = Rig(self.camera, vehicle, lambda: self.world.now_ns, lambda: False, live=False)  # type: ignore[arg-type]
        self.dry = DryVehicle(vehicle) if dry else None
        pilot = Pilot(self.world, Nobody(), self.dry or vehicle, clock=lambda: 0.0, in_the_air=Mode.HOLDING)
        self.prompter = pilot.spotter = Prompter()  # type: ignore[assignment]
        self.console = Console(record=True, width=120, file=io.StringIO())
        book = None if record is None else Recorder(record, pilot, patient=True)
        self.flying = Flying(self.console, self.rig, pilot, book, **ends)

    def says(self, when_s: float, command: Command) -> None:
        self.camera.at[when_s] = lambda: setattr(self.prompter, "says", command)


def test_a_flight_to_its_end_is_written_down_and_ends_holding(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    bench = Bench(path, duration_s=9.0)
    bench.says(1.5, Command.TAKE_OFF)
    assert bench.flying.fly() == 0
    assert bench.world.vehicle.mode is FlightMode.HOLDING
    assert "it is up: following" in bench.console.export_text()
    compared, last = Comparison(), Mode.DISARMED
    for then, now in Replay(Flight.open(path)):
        compared.note(then, now)
        last = then.turn.verdict.mode
    assert compared.same and compared.turns > 270
    assert last is Mode.HOLDING


def test_it_lands_on_exit_if_asked() -> None:
    bench = Bench(duration_s=7.0, land_on_exit=True)
    bench.says(1.5, Command.TAKE_OFF)
    assert bench.flying.fly() == 0
    assert bench.world.vehicle.mode is FlightMode.DISARMED
    assert bench.world.now_ns < 16e9


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_holds_and_ends(number: int) -> None:
    bench = Bench()
    bench.says(1.5, Command.TAKE_OFF)
    bench.camera.at[7.0] = lambda: os.kill(os.getpid(), number)
    before = signal.getsignal(number)
    assert bench.flying.fly() == 0
    assert bench.world.vehicle.mode is FlightMode.HOLDING
    assert signal.getsignal(number) is before
    assert bench.world.now_ns < 9.5e9


def test_a_dry_run_passes_nothing_on() -> None:
    bench = Bench(dry=True, duration_s=4.0)
    bench.says(1.5, Command.TAKE_OFF)
    assert bench.flying.fly() == 0
    assert bench.world.vehicle.mode is FlightMode.DISARMED and not bench.world.airframe.state.armed
    assert bench.dry is not None and bench.dry.kept == ["arm"]
    assert "dry run: not passed on: arm" in bench.console.export_text()


def test_a_camera_that_fails_for_good_is_trouble() -> None:
    bench = Bench()
    bench.says(1.5, Command.TAKE_OFF)
    bench.camera.fails_at_s = 6.0
    assert bench.flying.fly() == 1
    assert "ended in trouble: unplugged" in bench.console.export_text()
    assert bench.world.vehicle.mode is FlightMode.HOLDING, "let go of, it holds by itself"


def test_a_live_camera_that_fails_for_good_lets_the_flight_go_on_to_the_ground() -> None:
    bench = Bench()
    bench.says(1.5, Command.TAKE_OFF)
    bench.camera.fails_at_s = 6.0
    world = bench.world

    def now_ns() -> int:  # time goes on whenever somebody looks at the clock
        if world.now_ns > 6e9:
            world.step()
        return world.now_ns

    bench.flying.rig = replace(bench.rig, live=True, now_ns=now_ns)
    assert bench.flying.fly() == 1
    assert world.vehicle.mode is FlightMode.DISARMED
    assert "blind for long: landing" in bench.console.export_text()


@pytest.fixture
def quiet(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Nothing is taught and no network is read for what fails before."""
    from wigwag.cli import fly

    monkeypatch.setattr(fly.Fly, "model_file", lambda self, stack: Path("none"))
    monkeypatch.setattr(models, "load_model", lambda path: (Nobody(), ("stop", "land")))
    monkeypatch.setattr(models, "warm_up", lambda model: None)
    monkeypatch.setattr(fly.Fly, "_pose", lambda self: lambda frame: None)
    yield


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--camera", "webcam:0"], "--model is missing"),
        (["--commands", "a6=dance"], "takes LABEL=COMMAND"),
        (["--fence", "1", "2", "3"], "--fence needs a radius, or pairs"),
        (["--altitude", "9"], "altitude_m is 9.0, but has to be"),
        (["--camera-pitch", "120"], "--camera-pitch must be -90 to 90 degrees, but got 120"),
        (["--camera", "nonsense"], "is no address of a camera"),
        (["--vehicle", "zeppelin:1"], "is no address of a vehicle"),
        (["--model", "nowhere.wigwag"], "there is no such model file"),
    ],
)
def test_wrong_input_says_what_is_wrong(
    options: list[str], says: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from wigwag.cli import fly

    monkeypatch.setattr(fly.Fly, "_pose", lambda self: lambda frame: None)
    if "--model" not in options:
        monkeypatch.setattr(fly.Fly, "model_file", lambda self, stack: Path("none"))
        monkeypatch.setattr(models, "load_model", lambda path: (Nobody(), ("stop", "land")))
        monkeypatch.setattr(models, "warm_up", lambda model: None)
    assert run(["fly", *options]) == 2
    assert says in " ".join(capsys.readouterr().err.split())


def test_out_of_order_nothing_flies(quiet: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["fly", "--commands", "clap=left"]) == 1
    out = capsys.readouterr().out
    assert "not in order" in out and "the model knows none" in out


def test_settings_become_limits() -> None:
    config = Fly(altitude=3.0, fence=(0.0, 0.0, 9.0, 0.0, 9.0, 9.0), ceiling=5.0).settings()
    assert (config.goal.altitude_m, config.movement.max_altitude_m, config.supervisor.ceiling_m) == (
        3.0,
        3.5,
        5.0,
    )
    assert len(config.supervisor.fence.walls(5.0, 2.0)) == 3
    assert Fly(camera_pitch=90.0).settings().mount.to_body(np.array([0.0, 0.0, 2.0])) == pytest.approx(
        [0.1, 0.0, -2.0]
    ), "straight down"
    with pytest.raises(InputError, match="radius_m must be above 0"):
        Fly(fence=(-1.0,)).settings()


def states(checks: Iterator[Check]) -> dict[str, str]:
    return {check.what: check.state for check in checks}


def test_the_checklist_finds_what_is_wrong() -> None:
    bench, limits = Bench(), SupervisorConfig()
    assert states(check_camera(bench.rig)) == {"camera": "ok", "depth": "ok"}
    healthy = states(check_vehicle(bench.rig, limits))
    assert set(healthy.values()) == {"ok", "warning"} and healthy["battery"] == "warning"
    bench.world.faults.frozen = True
    assert states(check_camera(bench.rig)) == {"camera": "fault"}
    assert states(check_model(("stop", "land", "take_off"), {c.value: c for c in Command}))["model"] == "ok"
    known = states(check_model(("stop", "left"), {c.value: c for c in Command}))
    assert known == {"gesture for land": "fault", "model": "warning"}

    class Ill:
        mode, warnings = FlightMode.MANUAL, ("COM_OBL_RC_ACT is 2",)
        capabilities = bench.world.vehicle.capabilities
        state = replace(
            bench.world.vehicle.state, stamp_ns=0, battery=0.1, healthy=False, trouble="no GPS",
            position_m=np.array([99.0, 0.0, 0.0]),
        )  # fmt: skip

    found = states(check_vehicle(replace(bench.rig, vehicle=Ill()), limits))  # type: ignore[arg-type]
    assert found == {
        "vehicle": "fault", "link": "fault", "position": "fault", "battery": "fault",
        "its own checks": "fault", "fence": "fault", "parameter": "warning",
    }  # fmt: skip
