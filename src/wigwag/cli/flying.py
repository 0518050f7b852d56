"""The loop of ``wigwag fly``: turn by turn to the end of a flight, and the end itself."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.live import Live
from rich.markup import escape

from wigwag.camera.fresh import Glimpse, fresh
from wigwag.camera.watchdog import Watchdog
from wigwag.errors import CameraError, DataError
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.pilot import Pilot, Step
from wigwag.record.recorder import Recorder
from wigwag.rig import Rig
from wigwag.vehicles.dry import DryVehicle
from wigwag.vehicles.protocol import FlightMode
from wigwag.view.onlookers import Onlookers

_BLIND_TURN_S = 0.03


class Flying:
    """One flight: turns of the loop until the end, and the end itself.

    Args:
        console: Where transitions and the state of the moment are shown.
        rig: Camera, vehicle and clock.
        pilot: What flies; its vehicle may be a dry one.
        recorder: Where everything is written down.
        land_on_exit: Land at the end, rather than hold.
        duration_s: End after so many seconds.
        onlookers: Whoever looks on; what is asked for on the console's page comes before what gestures ask.
    """

    def __init__(  # noqa: PLR0917  # one caller
        self, console: Console, rig: Rig, pilot: Pilot, recorder: Recorder | None = None,
        land_on_exit: bool = False, duration_s: float | None = None, onlookers: Onlookers | None = None,
    ) -> None:  # fmt: skip
        self.console, self.rig, self.pilot, self.vehicle = console, rig, pilot, pilot.vehicle
        self.recorder, self.land_on_exit, self.duration_s = recorder, land_on_exit, duration_s
        self.watchdog, self.stopped, self.trouble = Watchdog(), False, ""
        self.onlookers = onlookers or Onlookers()
        self.onlookers.begin(pilot, live=rig.live)

    def fly(self) -> int:
        """Fly to the end and return the exit code."""
        began_ns = self.rig.now_ns()
        try:
            with (
                self._interruptible(),
                Live(console=self.console, refresh_per_second=8, transient=True) as live,
            ):
                for glimpse in self._glimpses():
                    self._turn(glimpse, live)
                    spent_s = (glimpse.now_ns - began_ns) * 1e-9
                    limit_s = self.duration_s
                    if self.stopped or self.rig.over() or (limit_s is not None and spent_s >= limit_s):
                        break
                self._end(live)
        finally:
            self.rig.vehicle.close()
            if self.recorder is not None:
                self.recorder.close(ended=self.trouble or "as wished")
        return self._account()

    def _glimpses(self) -> Iterator[Glimpse]:
        """Look through the camera; should it fail for good, turns go on blindly until it has landed."""
        try:
            yield from fresh(self.rig.camera, self.watchdog, timeout_s=0.05)
        except (CameraError, DataError) as error:
            self.trouble = str(error)
        if not self.rig.live:
            return  # no time passes without frames
        never = threading.Event()
        while self.vehicle.mode is not FlightMode.DISARMED:
            now_ns = self.rig.now_ns()
            yield Glimpse(None, self.watchdog.check(now_ns), now_ns)
            never.wait(_BLIND_TURN_S)

    def _turn(self, glimpse: Glimpse, live: Live, asked: Command | None = None) -> None:
        step = self.pilot.step(glimpse.frame, glimpse.now_ns, self.onlookers.asked() or asked)
        if self.recorder is not None:
            self.recorder.turn(glimpse.frame, glimpse.now_ns, step)
        if step.verdict.row:
            why = f" ({step.verdict.reason})" if step.verdict.reason else ""
            text = f"{glimpse.now_ns * 1e-9:9.1f} s  {step.verdict.row}: {step.verdict.mode}{why}"
            self.console.print(text, highlight=False, markup=False)
        live.update(_line(step, glimpse.health.reason or self.pilot.trouble or self.onlookers.trouble))
        self.onlookers.turn(glimpse.frame, step, glimpse.health.reason)

    def _end(self, live: Live) -> None:
        """Hold, or land if that is wished; then let go."""
        ground = (FlightMode.DISARMED, FlightMode.READY)
        if self.vehicle.mode in (*ground, FlightMode.MANUAL) or isinstance(self.vehicle, DryVehicle):
            return
        self.stopped = False  # from here on Ctrl-C leaves
        ask: Command | None = Command.LAND if self.land_on_exit else Command.STOP
        began_ns, patience_s = self.rig.now_ns(), 90.0 if self.land_on_exit else 1.5
        for glimpse in self._glimpses():
            self._turn(glimpse, live, ask)
            ask = None
            landed = self.vehicle.mode in ground or self.pilot.supervisor.mode is Mode.PILOT
            if landed or self.stopped or (glimpse.now_ns - began_ns) * 1e-9 > patience_s:
                return

    @contextmanager
    def _interruptible(self) -> Iterator[None]:
        """Let Ctrl-C and a kind kill end the flight between two turns, never within one."""

        def stop(number: int, frame: object) -> None:
            self.stopped = True

        before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _account(self) -> int:
        vehicle = self.vehicle
        if isinstance(vehicle, DryVehicle):
            kept = ", ".join(vehicle.kept) or "no request"
            self.console.print(f"dry run: not passed on: {kept}; {vehicle.kept_setpoints} set-points.")
        if self.recorder is not None:
            self.trouble = self.trouble or self.recorder.failed
            left_out = self.recorder.left_out
            said = f"; {left_out} pictures left out: the disk did not keep up" if left_out else ""
            self.console.print(f"recorded: {self.recorder.path}{said}", highlight=False)
        if self.trouble:
            self.console.print(f"[bold red]ended in trouble:[/] {self.trouble}", highlight=False)
            return 1
        self.console.print(f"ended: the vehicle is {vehicle.mode}.", highlight=False)
        return 0


def _line(step: Step, trouble: str) -> str:
    """Return the state of the moment on one line."""
    now, state = step.situation, step.state
    distance = "-" if now.distance_m is None or step.pose is None else f"{now.distance_m:.1f} m"
    battery = "-" if state.battery is None else f"{100 * state.battery:.0f} %"
    said = step.verdict.reason or trouble
    return (
        f"[bold]{step.verdict.mode.replace('_', ' ')}[/]  vehicle {now.craft}  operator {distance}  "
        f"height {state.position_m[2]:.1f} m  battery {battery}  [yellow]{escape(said[:70])}[/]"
    )


__all__ = ["Flying"]
