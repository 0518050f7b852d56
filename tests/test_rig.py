"""A camera on a vehicle: one world if both are simulated; else a simulated camera rides on the vehicle."""

from __future__ import annotations

import math
import threading
from dataclasses import replace

import numpy as np
import pytest

from wigwag.camera.fresh import fresh
from wigwag.errors import CameraError, InputError
from wigwag.fly.operator import Mount
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.rig import open_rig
from wigwag.sim.autopilot_server import AutopilotServer
from wigwag.sim.autopilots import FakePx4
from wigwag.sim.camera import SimulatedCameraConfig
from wigwag.sim.mounted import MountedSource
from wigwag.vehicles import FlightMode
from wigwag.vehicles.dry import DryVehicle

S = 10**9


def test_both_simulated_are_one_world() -> None:
    with open_rig("sim:?seed=2&duration_s=0.4&noise=0", "sim:") as rig:
        assert not rig.live and rig.vehicle.mode is FlightMode.DISARMED
        assert rig.vehicle.arm() and rig.vehicle.take_off(1.0)
        heights = []
        for glimpse in fresh(rig.camera):
            assert glimpse.now_ns == rig.now_ns()
            heights.append(float(rig.vehicle.state.position_m[2]))
            if len(heights) == 90:
                break
        assert heights[-1] > 0.5, "the drone flies on as frames are read"
        assert rig.over(), "all was shown, and the world goes on"
        assert rig.now_ns() == pytest.approx(3.0 * S, rel=0.02)


@pytest.mark.parametrize(
    ("camera", "vehicle"), [("sim:", "sim:?speed=3"), ("sim:?colour=red", "sim:"), ("x:", "sim:")]
)
def test_addresses_are_checked(camera: str, vehicle: str) -> None:
    with pytest.raises(InputError), open_rig(camera, vehicle):
        pass


class Carrier:
    """A vehicle somewhere, whose clock and place are set by hand."""

    def __init__(self) -> None:
        self.state = VehicleState(np.array([7.0, -3.0, 0.2]), np.zeros(3), math.radians(100), 50 * S)

    def source(self, **changes: object) -> MountedSource:
        config = replace(SimulatedCameraConfig(seed=1, distance_m=5.0, noise=False), **changes)  # type: ignore[arg-type]
        return MountedSource(config, lambda: self.state, lambda: self.state.stamp_ns, self.wait)

    def wait(self, event: threading.Event, seconds: float) -> bool:
        self.state = replace(self.state, stamp_ns=self.state.stamp_ns + max(round(seconds * 1e9), 1_000_000))
        return event.is_set()

    def move(self, **changes: object) -> None:
        self.state = replace(self.state, **changes)  # type: ignore[arg-type]


def middle_of(frame: object) -> tuple[float, float]:
    """Column and depth of what stands out from the background: the operator."""
    depth = frame.depth_mm.astype(float)  # type: ignore[attr-defined]
    near = (depth > 1000) & (depth < 5600)
    near[300:] = False  # the ground
    return float(np.nonzero(near)[1].mean()), float(np.median(depth[near])) / 1000


def test_a_mounted_camera_sees_the_operator_ahead_of_wherever_the_vehicle_stands() -> None:
    carrier = Carrier()
    source = carrier.source()
    source.open()
    first = source.read()
    assert first is not None and first.stamp_ns == carrier.state.stamp_ns
    carrier.move(position_m=np.array([7.0, -3.0, 1.4]))
    column, depth = middle_of(source.read())
    assert column == pytest.approx(320, abs=40) and depth == pytest.approx(4.8, abs=0.3)
    ahead = np.array([math.cos(math.radians(100)), math.sin(math.radians(100)), 0.0])
    carrier.move(position_m=np.array([7.0, -3.0, 1.4]) + ahead)
    assert middle_of(source.read())[1] == pytest.approx(3.8, abs=0.3), "one metre nearer"
    carrier.move(heading_rad=math.radians(110))
    assert middle_of(source.read())[0] > 380, "turned to the left, the operator is to the right"
    tilted = Carrier()
    low = tilted.source(mount=Mount(pitch_down_rad=math.radians(20)))
    low.open()
    low.read()
    tilted.move(position_m=np.array([7.0, -3.0, 3.0]))
    assert middle_of(low.read())[1] == pytest.approx(4.8, abs=0.4), "looking down, it sees them from 3 m"


def test_a_mounted_camera_ends_with_the_duration_and_tells_of_a_silent_vehicle() -> None:
    carrier = Carrier()
    source = carrier.source(duration_s=0.1)
    source.open()
    frames = 0
    while source.read() is not None:
        frames += 1
    assert 2 <= frames <= 5
    silent = Carrier()
    stuck = MountedSource(SimulatedCameraConfig(noise=False), lambda: silent.state, clock=iter(range(0, 99 * S, S // 9)).__next__, wait=lambda e, s: False)  # fmt: skip  # noqa: E501
    stuck.open()
    assert stuck.read() is not None
    with pytest.raises(CameraError, match="nothing new for a second"):
        stuck.read()
    stuck.interrupt()
    stuck.close()


def read_until(source: MountedSource, carrier: Carrier, seconds: float) -> None:
    end_ns = carrier.state.stamp_ns + round(seconds * S)
    while carrier.state.stamp_ns < end_ns and source.read() is not None:
        pass


def test_the_operator_asks_again_until_the_vehicle_is_up_and_then_goes_on() -> None:
    """A hand that was raised while the checklist was gone through used to be the only one."""
    carrier = Carrier()
    carrier.move(armed=False)
    source = carrier.source(rate_hz=3.0)
    source.open()
    read_until(source, carrier, 40.0)
    asked = len(source.shown)
    assert asked >= 6 and source.shown[:4] == ("engage", "take_off", "engage", "take_off")
    carrier.move(armed=True, velocity_m_s=np.array([0.0, 0.0, 0.8]), position_m=np.array([7.0, -3.0, 1.4]))
    read_until(source, carrier, 14.0)
    assert len(source.shown) > asked, "it climbs still"
    asked = len(source.shown)
    carrier.move(velocity_m_s=np.zeros(3))
    read_until(source, carrier, 14.0)
    assert len(source.shown) > asked + 20, "all the rest"
    assert "land" in source.shown


def test_an_operator_whom_nothing_obeys_gives_up() -> None:
    carrier = Carrier()
    carrier.move(armed=False)
    source = carrier.source(rate_hz=1.0, engage=False)
    source.open()
    read_until(source, carrier, 600.0)
    assert source.read() is None
    assert set(source.shown) == {"take_off"}


def test_a_simulated_camera_rides_on_an_autopilot_over_udp() -> None:
    port = 14_731
    with (
        AutopilotServer(FakePx4(), ("127.0.0.1", port)),
        open_rig("sim:?noise=0", f"mavlink:udp:127.0.0.1:{port}") as rig,
    ):
        assert rig.live and "PX4" in rig.vehicle.capabilities.name
        frames = []
        for glimpse in fresh(rig.camera):
            rig.vehicle.beat(glimpse.now_ns)
            if glimpse.frame is not None:
                frames.append(glimpse)
            if len(frames) == 5:
                break
        assert all(abs(g.now_ns - g.frame.stamp_ns) < 0.5 * S for g in frames if g.frame is not None)


def test_a_dry_vehicle_passes_nothing_on() -> None:
    with open_rig("sim:?duration_s=0.1&noise=0", "sim:") as rig:
        dry = DryVehicle(rig.vehicle)
        dry.connect()
        dry.beat(0)
        assert not (dry.arm() or dry.take_off(2.0) or dry.hold() or dry.land() or dry.send(Setpoint(), 0))
        assert dry.kept == ["arm", "take off to 2 m", "hold", "land"] and dry.kept_setpoints == 1
        assert (dry.mode, dry.warnings) == (FlightMode.DISARMED, ())
        assert dry.capabilities == rig.vehicle.capabilities
        assert dry.state.stamp_ns == rig.vehicle.state.stamp_ns
        dry.close()
