"""Through real sockets, in real time: two threads, another process that is killed, links that are lost."""

from __future__ import annotations

import gc
import os
import pty
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from wigwag.drones import open_vehicle
from wigwag.errors import InputError, VehicleError
from wigwag.fly.values import Setpoint
from wigwag.sim.autopilot_config import FakeConfig
from wigwag.sim.autopilot_server import AutopilotServer
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.pointmass import PointMass
from wigwag.vehicles import FlightMode
from wigwag.vehicles.mavlink import MavlinkVehicle
from wigwag.vehicles.mavlink.links import SerialLink, TcpLink, UdpLink, link_of

AHEAD = Setpoint((1.0, 0.0, 0.0))
FAST = FakeConfig(settle_s=0.1, climb_m_s=4.0)


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def until(
    true: Callable[[], bool], limit_s: float = 10.0, turn: Callable[[], object] = lambda: None
) -> float:
    """Wait for something that happens in real time; return how long it took."""
    began = time.monotonic()
    pause = threading.Event()
    while not true():
        turn()
        pause.wait(0.01)
        assert time.monotonic() - began < limit_s, "too late"
    return time.monotonic() - began


def airborne(make):
    """A fake that hovers already, in the mode that each holds in."""
    fake = make(FAST, PointMass(position_m=(0.0, 0.0, 3.0)))
    fake.armed, fake.origin = True, True
    fake.mode = FakePx4.HOLD if make is FakePx4 else FakeArduPilot.GUIDED
    return fake


@pytest.mark.parametrize("make", [FakePx4, FakeArduPilot])
def test_a_flight_through_real_sockets(make):
    port = free_port()
    with AutopilotServer(make(FAST), ("127.0.0.1", port)) as server:
        vehicle = open_vehicle(f"mavlink:udp:127.0.0.1:{port}")
        vehicle.connect()
        try:

            def turn(setpoint=None):
                now = time.monotonic_ns()
                vehicle.beat(now)
                if setpoint:
                    vehicle.send(setpoint, now)

            until(lambda: vehicle.state.healthy)
            assert vehicle.arm() and vehicle.take_off(1.5)
            until(lambda: vehicle.mode is FlightMode.HOLDING, turn=turn)
            assert server.autopilot.height_m == pytest.approx(1.5, abs=0.4)
            until(lambda: vehicle.mode is FlightMode.STEERED, turn=lambda: turn(AHEAD))
            until(lambda: server.autopilot.airframe.state.velocity_m_s[0] > 0.9, turn=lambda: turn(AHEAD))
            assert vehicle.state.position_age_s(time.monotonic_ns()) < 0.2
            assert vehicle.land()
            until(lambda: vehicle.mode is FlightMode.DISARMED, turn=turn)
        finally:
            vehicle.close()
            vehicle.close()
        assert threading.active_count() < 4


_SENDER = """
import sys, threading, time
from wigwag.drones import open_vehicle
from wigwag.fly.values import Setpoint
vehicle = open_vehicle(sys.argv[1])
vehicle.connect()
print("connected", flush=True)
pause = threading.Event()
while True:
    vehicle.send(Setpoint((1.0, 0.0, 0.0)), time.monotonic_ns())
    pause.wait(1 / 30)
"""


@pytest.mark.parametrize("make", [FakePx4, FakeArduPilot])
def test_killed_at_speed_nothing_more_leaves_and_the_vehicle_holds_by_itself(make):
    """kill -9 of the sending process at 1 m/s."""
    port = free_port()
    fake = airborne(make)
    with AutopilotServer(fake, ("127.0.0.1", port)) as server:
        address = f"mavlink:udp:127.0.0.1:{port}"
        process = subprocess.Popen([sys.executable, "-c", _SENDER, address], stdout=subprocess.PIPE)
        try:
            until(lambda: fake.airframe.state.velocity_m_s[0] > 0.95, 20.0)
            os.kill(process.pid, signal.SIGKILL)
            process.wait(5.0)
            died_s, at_m = server.now_s, float(fake.airframe.state.position_m[0])
            until(lambda: np.abs(fake.airframe.state.velocity_m_s).max() < 0.05)
            with server.lock:
                after = [at for at, _ in fake.received if at > died_s + 0.02]  # what lay in the socket
                flown = float(fake.airframe.state.position_m[0]) - at_m
        finally:
            process.kill()
            process.wait()
    assert not after
    assert flown < 2.2
    assert fake.mode == (FakePx4.HOLD if make is FakePx4 else FakeArduPilot.GUIDED)


@pytest.mark.parametrize("make", [FakePx4, FakeArduPilot])
def test_a_loop_that_hangs_while_its_threads_live(make):
    port = free_port()
    fake = airborne(make)
    with AutopilotServer(fake, ("127.0.0.1", port)) as server:
        vehicle = open_vehicle(f"mavlink:udp:127.0.0.1:{port}")
        vehicle.connect()
        try:
            until(
                lambda: fake.airframe.state.velocity_m_s[0] > 0.9,
                turn=lambda: vehicle.send(AHEAD, time.monotonic_ns()),
            )
            hung_s = server.now_s
            hold = FakePx4.HOLD if make is FakePx4 else FakeArduPilot.BRAKE
            held_s = until(lambda: fake.mode == hold)
            with server.lock:
                still = [at - hung_s for at, m in fake.received if at > hung_s and not m.vx and not m.vy]
        finally:
            vehicle.close()
    assert still[0] < 0.3
    assert held_s < 1.0


def test_what_was_loaded_is_left_out_of_garbage_collections():
    """A full collection keeps the interpreter, and with it the sender, for up to half a second."""
    gc.unfreeze()
    loaded = [[] for _ in range(50_000)]
    with AutopilotServer(FakePx4(FAST), ("127.0.0.1", port := free_port())):
        vehicle = open_vehicle(f"mavlink:udp:127.0.0.1:{port}")
        vehicle.connect()
        try:
            assert gc.get_freeze_count() > len(loaded)
            assert sys.getswitchinterval() <= 0.0005
            after = [[] for _ in range(10_000)]
            until(lambda: vehicle.state.healthy)
            vehicle.arm()
            assert gc.get_freeze_count() > len(loaded) + len(after), "and what was loaded since"
        finally:
            vehicle.close()


def test_nobody_there_says_what_to_look_at():
    vehicle = MavlinkVehicle(UdpLink("127.0.0.1", 0, listen=True), find_s=0.2)
    with pytest.raises(VehicleError, match=r"no autopilot answers.*switched on"):
        vehicle.connect()
    with pytest.raises(VehicleError, match="cannot be reached"):
        MavlinkVehicle(TcpLink("127.0.0.1", free_port())).connect()
    with pytest.raises(VehicleError, match="dialout"):
        MavlinkVehicle(SerialLink("/dev/no-such-device", 57600)).connect()


def test_an_autopilot_of_another_system_is_named():
    port = free_port()
    with AutopilotServer(FakePx4(FAST), ("127.0.0.1", port)):
        vehicle = open_vehicle(f"mavlink:udp:127.0.0.1:{port}?system=9")
        vehicle._find_s = 1.5
        with pytest.raises(VehicleError, match="system 1 is not the system 9 asked for"):
            vehicle.connect()


def test_a_port_that_is_taken_is_an_error():
    taken = UdpLink("127.0.0.1", 0, listen=True)
    taken.open()
    with pytest.raises(VehicleError, match="Is another program there"):
        UdpLink("127.0.0.1", taken.port, listen=True).open()
    taken.close()


def test_a_stranger_on_the_port_is_neither_heard_nor_answered():
    link = UdpLink("127.0.0.1", 0, listen=True, clock=lambda: clock[0])
    clock = [0]
    link.open()
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
    ):
        first.settimeout(1.0)
        other.settimeout(0.05)
        link.write(b"to nobody yet")
        first.sendto(b"first", ("127.0.0.1", link.port))
        assert link.read() == b"first"
        other.sendto(b"other", ("127.0.0.1", link.port))
        assert link.read() == b""
        link.write(b"answer")
        assert first.recv(100) == b"answer"
        with pytest.raises(TimeoutError):
            other.recv(100)
        clock[0] = 3_000_000_000  # the first fell silent: another may come
        other.sendto(b"other", ("127.0.0.1", link.port))
        assert link.read() == b"other"
    link.close()


def test_tcp_is_opened_again_when_it_was_lost():
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = TcpLink("127.0.0.1", server.getsockname()[1])
        link.open()
        peer, _ = server.accept()
        peer.sendall(b"hello")
        assert link.read() == b"hello"
        link.write(b"there")
        assert peer.recv(100) == b"there"
        peer.close()
        with pytest.raises(VehicleError, match="closed by the other side"):
            link.read()
        link.open()
        server.accept()[0].close()
        link.close()
    with pytest.raises(VehicleError, match="is closed"):
        link.read()


def test_a_serial_line_carries_bytes_both_ways():
    master, slave = pty.openpty()
    link = SerialLink(os.ttyname(slave), 115200)
    link.open()
    os.write(master, b"from the autopilot")
    came = b""
    while len(came) < 18:
        came += link.read()
    assert came == b"from the autopilot"
    link.write(b"to it")
    assert os.read(master, 100) == b"to it"
    assert link.read() == b""
    link.close()
    os.close(master)
    os.close(slave)


def test_a_sender_that_breaks_sends_nothing_more_and_says_so():
    vehicle = MavlinkVehicle(UdpLink("127.0.0.1", 0, listen=True), find_s=0.3)

    def broken(now_ns):
        raise RuntimeError("a bug")

    vehicle.session.tick = broken
    threading.excepthook, before = (lambda args: None), threading.excepthook
    try:
        with pytest.raises(VehicleError):
            vehicle.connect()
    finally:
        threading.excepthook = before
    assert "a bug" in vehicle.state.trouble
    assert not vehicle.send(AHEAD, time.monotonic_ns())
    assert not vehicle.arm()


@pytest.mark.parametrize(
    "text, what",
    [
        ("mavlink:", "is no link"),
        ("mavlink:udp:14550", "is no link"),
        ("mavlink:udp:host:port", "is no link"),
        ("mavlink:udp:host:99999", "is no link"),
        ("mavlink:serial:", "is no link"),
        ("mavlink:udp:h:1?rate_hz=500", "8 to 100"),
        ("mavlink:udp:h:1?heartbeat=loud", "auto, onboard or gcs"),
        ("mavlink:udp:h:1?origin=91,0,0", "degrees north"),
        ("mavlink:udp:h:1?origin=1,2", "degrees north"),
        ("mavlink:udp:h:1?colour=red", "has no option 'colour'"),
        ("mavlink:udp:h:1?key=/nowhere", "cannot be read"),
        ("boat:1", "is no address of a vehicle"),
        ("sim", "is no address"),
        ("sim:here", "takes options only"),
    ],
)
def test_addresses_that_are_wrong_say_how_they_should_be(text, what):
    with pytest.raises(InputError, match=what):
        open_vehicle(text)


def test_addresses_that_are_right():
    names = [
        link_of(text).name
        for text in ("udp:127.0.0.1:14550", "udpin::14550", "udpout:10.0.0.2:14540", "tcp:localhost:5760")
    ]
    assert names == [
        "UDP at 127.0.0.1:14550", "UDP at 0.0.0.0:14550", "UDP to 10.0.0.2:14540", "TCP to localhost:5760",
    ]  # fmt: skip
    assert link_of("serial:/dev/ttyACM0", 921600).name == "serial line /dev/ttyACM0 at 921600 baud"
    vehicle = open_vehicle(
        "mavlink:serial:/dev/ttyUSB0?baud=57600&system=3&rate_hz=20&stream_hz=10&origin=52.1,4.3,12"
    )
    assert vehicle.session.config.system == 3
    assert vehicle.session.config.origin.altitude_m == 12
