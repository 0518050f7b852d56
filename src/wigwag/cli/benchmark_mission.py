"""``wigwag benchmark mission``: a whole flight on your vehicle, such as an autopilot in its own simulator."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from wigwag.camera.playback import Playback
from wigwag.cli.fly import Fly

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.evaluate.mission import Mission, MissionConfig
    from wigwag.fly.values import VehicleState
    from wigwag.pilot import Pilot, PilotConfig
    from wigwag.record.recorder import Recorder
    from wigwag.sim.stage import Stage
    from wigwag.stream.models import Taught
    from wigwag.vehicles.protocol import Vehicle

_HEALTHY_S = 60.0


@dataclass(frozen=True)
class MissionBenchmark:
    """Take off, follow a person who walks an arc, obey six commands by gesture, land: all on your vehicle.

    The person is simulated and shows gestures with a whole body; they are seen as from a camera on the
    vehicle, wherever it says that it is. From the poses on everything is what wigwag fly flies with:
    recogniser, supervisor, follow law, vehicle. Exit code 1 if anything was not as asked.
    Needs some 12 m of free simulated air ahead of its nose and to its left. Example:
    wigwag benchmark mission --vehicle mavlink:udp:127.0.0.1:14540
    """

    vehicle: str = "sim:"
    """Address of the vehicle; see docs/vehicles.md."""
    model: Path | None = None
    """What was taught; without, the demo's gestures are taught first."""
    height: float = 3.0
    """Metres that it takes off to."""
    seconds: float = 60.0
    """Of walking."""
    seed: int = 1
    """Chooses the person and all noise."""
    json: Path | None = None
    """File for the records, one a finding."""
    record: Path | None = None
    """MCAP file for everything that is seen, decided and sent; see docs/flights.md. Needs wigwag[record]."""

    def run(self) -> int:
        """Fly, print what was found, write the records."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.drones import open_vehicle
        from wigwag.errors import InputError
        from wigwag.evaluate.mission import MissionConfig
        from wigwag.record.container import check_target
        from wigwag.stream.models import load_model, warm_up

        if not 3 <= self.seconds <= 3600:
            raise InputError(f"--seconds must be 3 to 3600, but got {self.seconds:g}.")
        fly, console = Fly(model=self.model, altitude=self.height), Console()
        settings = fly.settings()
        if self.record is not None:
            check_target(self.record)
        with threadpool_limits(1), ExitStack() as stack:
            vehicle = open_vehicle(self.vehicle)
            with console.status("reading what was taught"):
                file = fly.model_file(stack)
                taught = load_model(file)
                warm_up(taught[0])
            with console.status("connecting"):
                vehicle.connect()
                stack.enter_context(closing(vehicle))
                _await_health(vehicle)
            plan, pause = MissionConfig(walk_s=self.seconds), threading.Event()
            mission = fly_mission(
                console, vehicle, taught, settings, plan, seed=self.seed, wait=pause.wait,
                record=lambda pilot: self._recorder(pilot, file),
            )  # fmt: skip
        if not mission.findings:
            return 1
        self._tell(console, mission)
        return 0 if mission.good else 1

    def _recorder(self, pilot: Pilot, model: Path) -> Recorder | None:
        if self.record is None:
            return None
        from wigwag.record.recorder import Recorder

        return Recorder(
            self.record, pilot, pictures="none", model=model.read_bytes(), facts={"vehicle": self.vehicle}
        )

    def _tell(self, console: Console, mission: Mission) -> None:
        from rich.box import SIMPLE_HEAD
        from rich.table import Table

        from wigwag.evaluate.records import Records, command_line

        name = mission.pilot.vehicle.capabilities.name
        records = Records(self.json, command_line("wigwag benchmark mission", self), self.seed)
        table = Table(title=f"A whole flight: {name}", box=SIMPLE_HEAD)
        for column in ("", "flown", "asked", ""):
            table.add_column(column)
        for f in mission.findings:
            table.add_row(f.what, f.found, f.asked, "[green]ok[/]" if f.good else "[bold red]missed[/]")
            records.add(vehicle=name, what=f.what, value=f.value, asked=f.asked, good=f.good)
        console.print(table)
        if self.json is not None:
            console.print(f"Records: {self.json}")


def fly_mission(
    console: Console, vehicle: Vehicle, taught: tuple[Taught, tuple[str, ...]], settings: PilotConfig,
    plan: MissionConfig, *, seed: int = 1, wait: Callable[[float], object],
    now_ns: Callable[[], int] = time.monotonic_ns, truth: Callable[[], VehicleState] | None = None,
    record: Callable[[Pilot], Recorder | None] = lambda pilot: None,
) -> Mission:  # fmt: skip
    """Fly a mission by the loop of ``wigwag fly``, its checklist included.

    Args:
        console: Where everything is shown.
        vehicle: What is flown; connected.
        taught: A model and the labels that it speaks.
        settings: The pilot's; where the camera sits is the stage's.
        plan: What is shown.
        seed: Chooses the person and all noise.
        wait: Lets so many seconds pass.
        now_ns: Monotonic nanoseconds, the clock of all stamps.
        truth: Where the vehicle truly is, if it is known; by default what it says of itself.
        record: Makes what writes everything down, if anything does.

    Returns:
        The mission; without findings if the vehicle was not in order, and nothing flew.
    """
    from wigwag.cli.flying import Flying
    from wigwag.cli.preflight import in_order
    from wigwag.evaluate.mission import Mission
    from wigwag.fly.values import Command
    from wigwag.pilot import Pilot
    from wigwag.rig import Rig
    from wigwag.sim.stage import Stage, StageConfig

    eyes = truth or (lambda: vehicle.state)
    stage = Stage(eyes, wait, now_ns, StageConfig(seed=seed))
    model, labels = taught
    pilot = Pilot(stage, model, vehicle, config=replace(settings, mount=stage.config.mount))
    mission = Mission(stage, pilot, eyes, plan)
    with _StageCamera(stage) as camera:
        rig = Rig(camera, vehicle, now_ns, lambda: mission.over, live=False)
        if not in_order(console, rig, settings.supervisor, labels, {c.value: c for c in Command}):
            return mission
        stage.turn = mission.turn
        Flying(console, rig, pilot, record(pilot), land_on_exit=True).fly()
    return mission


class _StageCamera(Playback):
    """The camera of a stage, whose pictures come a little late: the time is the stage's."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._stage = stage

    @property
    def now_ns(self) -> int:
        """The time."""
        return self._stage.now_ns()


def _await_health(vehicle: Vehicle) -> None:
    """Give an autopilot that has just been started the time that its estimator needs."""
    pause, end_ns = threading.Event(), time.monotonic_ns() + round(_HEALTHY_S * 1e9)
    while not vehicle.state.healthy and time.monotonic_ns() < end_ns:
        vehicle.beat(time.monotonic_ns())
        pause.wait(0.1)


__all__ = ["MissionBenchmark", "fly_mission"]
