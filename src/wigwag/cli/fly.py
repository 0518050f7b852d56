"""``wigwag fly``: a drone follows the operator and does what their body says."""

from __future__ import annotations

import math
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

from wigwag.cli.looking import Looking
from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.record.turns import Pictures

if TYPE_CHECKING:
    from wigwag.pilot import Pilot, PilotConfig, PoseSource
    from wigwag.record.recorder import Recorder


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
    camera_pitch: float = 0.0
    """Degrees that the camera looks down from straight ahead."""
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
    record: Path | None = None
    """MCAP file for everything that is seen, decided and sent; see docs/flights.md. Needs wigwag[record]."""
    record_pictures: Pictures = "jpeg"
    """What is kept of the colour pictures: none, jpeg (below 400 MB in ten minutes), or png, which loses
    nothing and is thirty times as large."""
    record_depth: bool = False
    """Keep the depth too, as it is."""
    looking: Looking = field(default_factory=Looking)
    models_dir: tyro.conf.Suppress[Path | None] = None

    def run(self) -> int:
        """Look, fly, and end well; return the exit code."""
        from rich.console import Console
        from threadpoolctl import threadpool_limits

        from wigwag.cameras import parse_camera
        from wigwag.cli.flying import Flying
        from wigwag.cli.preflight import in_order
        from wigwag.fly.situation import Mode
        from wigwag.pilot import Pilot
        from wigwag.record.container import check_target
        from wigwag.rig import open_rig
        from wigwag.stream.models import load_model, warm_up
        from wigwag.stream.overhear import Overhearing
        from wigwag.vehicles.dry import DryVehicle

        console = Console()
        config, commands = self.settings(), self.mapping()
        self._check_vehicle()
        if parse_camera(self.camera).kind != "sim" and self.model is None:
            raise InputError("--model is missing: a real operator's gestures have to be taught first.")
        if self.record is not None:
            check_target(self.record)
        with threadpool_limits(1), ExitStack() as stack:
            onlookers = stack.enter_context(self.looking.open(console))
            with console.status("reading what was taught"):
                file = self.model_file(stack)
                model, labels = load_model(file)
                warm_up(model)
            pose = self._pose()
            with console.status("opening camera and vehicle"):
                rig = stack.enter_context(open_rig(self.camera, self.vehicle, config.mount))
            if not in_order(console, rig, config.supervisor, labels, commands):
                return 1
            pilot = Pilot(
                pose, model, DryVehicle(rig.vehicle) if self.dry_run else rig.vehicle, commands=commands,
                config=config, in_the_air=Mode.HOLDING, time_ns=rig.now_ns if rig.live else None,
            )  # fmt: skip
            if onlookers.console is not None:  # whoever looks at the page wants to know why
                pilot.spotter = Overhearing(model, config.spot)
            recorder = self._recorder(pilot, file, patient=not rig.live)
            flying = Flying(console, rig, pilot, recorder, self.land_on_exit, self.duration_s, onlookers)
            return flying.fly()

    def settings(self) -> PilotConfig:
        """Return all settings of the flight.

        Raises:
            InputError: If they contradict each other.
        """
        from wigwag.fly.fence import Cylinder, Fence, Polygon
        from wigwag.fly.follow import Goal
        from wigwag.fly.limits import SupervisorConfig
        from wigwag.fly.movements import MovementConfig
        from wigwag.fly.operator import Mount
        from wigwag.pilot import PilotConfig

        if not -90 <= self.camera_pitch <= 90:
            raise InputError(f"--camera-pitch must be -90 to 90 degrees, but got {self.camera_pitch:g}.")
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
            mount=Mount(pitch_down_rad=math.radians(self.camera_pitch)),
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

    def model_file(self, stack: ExitStack) -> Path:
        """Return the file of what was taught; without one the demo's gestures are taught."""
        if self.model is not None:
            return self.model
        from wigwag.evaluate.lessons import teach_procedural

        file = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "demo.wigwag"
        teach_procedural(file)
        return file

    def _recorder(self, pilot: Pilot, model: Path, patient: bool) -> Recorder | None:
        if self.record is None:
            return None
        from wigwag.camera.address import hide_password
        from wigwag.record.recorder import Recorder

        facts = {
            "camera": hide_password(self.camera), "vehicle": self.vehicle, "dry_run": str(self.dry_run)
        }  # fmt: skip
        return Recorder(
            self.record, pilot, pictures=self.record_pictures, depth=self.record_depth,
            model=model.read_bytes(), facts=facts, patient=patient,
        )  # fmt: skip

    def _pose(self) -> PoseSource:
        from wigwag.pose.blazepose import BlazePoseConfig
        from wigwag.pose.estimator import PoseConfig, PoseEstimator
        from wigwag.pose.operator import OperatorConfig

        return PoseEstimator(
            PoseConfig(
                BlazePoseConfig(models_dir=self.models_dir), operator=OperatorConfig(engage=self.engage)
            )
        )


__all__ = ["Fly"]
