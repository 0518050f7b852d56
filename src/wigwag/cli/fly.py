"""``wigwag fly``: a drone follows the operator and does what their body says."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

from wigwag.errors import InputError
from wigwag.fly.values import Command

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.cli.preflight import Check
    from wigwag.pilot import PilotConfig, PoseSource
    from wigwag.rig import Rig
    from wigwag.stream.models import Taught


@dataclass(frozen=True)
class Fly:
    """Fly a drone by gestures, after a look at everything; it stops and lands as docs/safety.md says.

    Raise one hand above your head for a second to become the operator. Ctrl-C holds; a second one leaves.
    Exit code: 0 flown, 1 not in order or ended in trouble, 2 wrong input.
    Example: wigwag fly --camera sim: --vehicle sim:
    """

    camera: str = "sim:"
    """Address of the camera; see docs/cameras.md."""
    vehicle: str = "sim:"
    """Address of the vehicle, such as mavlink:udp:127.0.0.1:14550; see docs/vehicles.md."""
    model: Path | None = None
    """What was taught. Only a simulated operator can be flown for without: the demo's gestures are taught."""
    commands: tuple[str, ...] = ()
    """Which label commands what, such as a6=stop a24=up. By default labels are the commands' own names."""
    dry_run: bool = False
    """Everything but arming, requests and set-points."""
    distance: float = 4.5
    """Metres to the operator."""
    altitude: float = 1.2
    """Metres above the place of take-off."""
    fence: tuple[float, ...] = (30.0,)
    """Radius of the fence, or corners of a polygon: east north east north ...; metres from where it was
    switched on."""
    ceiling: float = 4.0
    """Metres above the place of take-off that it does not climb above."""
    engage: Literal["gesture", "first"] = "gesture"
    """Who becomes the operator: whoever raises a hand, or whoever is seen first."""
    land_on_exit: bool = False
    """Land on Ctrl-C and at the end, rather than hold."""
    duration_s: float | None = None
    """End after so many seconds."""
    log: Path | None = None
    """File for everything that is seen, decided and sent, a line of JSON a turn."""
    models_dir: tyro.conf.Suppress[Path | None] = None

    def run(self) -> int:
        """Look, fly, and end well; return the exit code."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.cameras import parse_camera
        from wigwag.cli.flying import Flying
        from wigwag.fly.situation import Mode
        from wigwag.journal import Journal
        from wigwag.pilot import Pilot
        from wigwag.rig import open_rig
        from wigwag.vehicles.dry import DryVehicle

        console = Console()
        config, commands = self.settings(), self.mapping()
        self._check_vehicle()
        if parse_camera(self.camera).kind != "sim" and self.model is None:
            raise InputError("--model is missing: a real operator's gestures have to be taught first.")
        with threadpool_limits(1), ExitStack() as stack:
            with console.status("reading what was taught"):
                model, labels = self._taught(stack)
            pose = self._pose()
            with console.status("opening camera and vehicle"):
                rig = stack.enter_context(open_rig(self.camera, self.vehicle))
            if not self._in_order(console, rig, config, labels, commands):
                return 1
            pilot = Pilot(
                pose, model, DryVehicle(rig.vehicle) if self.dry_run else rig.vehicle, commands=commands,
                config=config, in_the_air=Mode.HOLDING, time_ns=rig.now_ns if rig.live else None,
            )  # fmt: skip
            facts = {"camera": self.camera, "vehicle": self.vehicle, "dry_run": self.dry_run}
            journal = None if self.log is None else Journal(self.log, **facts)
            return Flying(console, rig, pilot, journal, self.land_on_exit, self.duration_s).fly()

    def settings(self) -> PilotConfig:
        """Return all settings of the flight.

        Raises:
            InputError: If they contradict each other.
        """
        from wigwag.fly.fence import Cylinder, Fence, Polygon
        from wigwag.fly.follow import Goal
        from wigwag.fly.limits import SupervisorConfig
        from wigwag.fly.movements import MovementConfig
        from wigwag.pilot import PilotConfig

        if len(self.fence) == 1:
            fence: Fence = Cylinder(self.fence[0])
        elif len(self.fence) % 2 == 0:
            fence = Polygon(tuple(zip(self.fence[::2], self.fence[1::2], strict=True)))
        else:
            raise InputError(f"--fence needs a radius, or pairs of east and north, but got {self.fence}.")
        bounds = MovementConfig()
        bounds = replace(
            bounds,
            max_altitude_m=min(max(bounds.max_altitude_m, self.altitude + 0.5), self.ceiling),
        )
        return PilotConfig(
            goal=Goal(distance_m=self.distance, altitude_m=self.altitude),
            movement=bounds,
            supervisor=SupervisorConfig(fence=fence, ceiling_m=self.ceiling),
        )

    def _check_vehicle(self) -> None:
        """Tell a wrong address before anything is taught or opened."""
        from wigwag.drones import parse_vehicle

        parse_vehicle(self.vehicle)

    def mapping(self) -> dict[str, Command]:
        """Return which label commands what.

        Raises:
            InputError: If a pair is none, or there is no such command.
        """
        if not self.commands:
            return {command.value: command for command in Command}
        found = {}
        for pair in self.commands:
            label, equals, name = pair.partition("=")
            if not (label and equals) or name not in set(Command):
                names = ", ".join(command.value for command in Command)
                raise InputError(f"--commands takes LABEL=COMMAND, but got {pair!r}. Commands: {names}.")
            found[label] = Command(name)
        return found

    def _taught(self, stack: ExitStack) -> tuple[Taught, tuple[str, ...]]:
        from wigwag.stream.models import load_model

        if self.model is not None:
            return load_model(self.model)
        from wigwag.evaluate.lessons import teach_procedural

        file = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "demo.wigwag"
        teach_procedural(file)
        return load_model(file)

    def _pose(self) -> PoseSource:
        from wigwag.pose.blazepose import BlazePoseConfig
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.pose.operator import OperatorConfig

        return PoseEstimator(
            PoseConfig(
                BlazePoseConfig(models_dir=self.models_dir), operator=OperatorConfig(engage=self.engage)
            )
        )

    def _in_order(
        self, console: Console, rig: Rig, config: PilotConfig, labels: tuple[str, ...],
        commands: dict[str, Command],
    ) -> bool:  # fmt: skip
        """Go through the checklist, print it, and say whether there is a flight."""
        from wigwag.cli.preflight import check_camera, check_model, check_vehicle

        checks = [
            *check_model(labels, commands), *check_camera(rig), *check_vehicle(rig, config.supervisor)
        ]  # fmt: skip
        _show(console, checks)
        faults = sum(check.state == "fault" for check in checks)
        if faults:
            console.print(f"[bold red]not in order:[/] {faults} of {len(checks)}; nothing flies.")
        return not faults


def _show(console: Console, checks: list[Check]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    colours = {"ok": "green", "warning": "yellow", "fault": "red"}
    table = Table(title="Before the flight", box=SIMPLE_HEAD)
    for column in ("", "", "found", "what to do"):
        table.add_column(column)
    for check in checks:
        state = f"[{colours[check.state]}]{check.state}[/]"
        table.add_row(check.what, state, escape(check.detail), escape(check.fix))
    console.print(table)


__all__ = ["Fly"]
