import hashlib

import pytest

from tests.vehicles.mavlink.flights import hovering
from wigwag.errors import InputError, VehicleError
from wigwag.sim.autopilot import FakeConfig
from wigwag.sim.autopilots import FakeArduPilot, FakePx4
from wigwag.sim.tethered import TetheredVehicle
from wigwag.vehicles.mavlink import MavlinkConfig
from wigwag.vehicles.mavlink.signing import read_key

KEY = bytes(range(32))


@pytest.fixture
def key_file(tmp_path):
    path = tmp_path / "key"
    path.write_bytes(KEY)
    return path


def test_three_forms_of_a_key(tmp_path, key_file):
    assert read_key(key_file) == KEY
    path = tmp_path / "hex"
    path.write_text(KEY.hex() + "\n")
    assert read_key(path) == KEY
    path.write_text("correct horse\n")
    assert read_key(path) == hashlib.sha256(b"correct horse").digest()


def test_no_key_is_an_error_that_does_not_tell_it(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_key(tmp_path / "none")
    (tmp_path / "empty").write_text("\n")
    with pytest.raises(InputError, match="holds no signing key"):
        read_key(tmp_path / "empty")


@pytest.mark.parametrize("make", [FakePx4, FakeArduPilot])
def test_a_signed_flight(make, key_file):
    fake = make(FakeConfig(key=KEY), wall_clock_s=0.0)
    flight = hovering(fake, config=MavlinkConfig(key=key_file))
    packet = flight.vehicle.sent[-1][1]
    assert packet[0] == 0xFD and packet[2] & 1  # MAVLink 2, signed
    assert len(packet) - packet[1] == 10 + 2 + 13


def test_another_key_is_not_heard(tmp_path):
    (tmp_path / "other").write_bytes(bytes(32))
    vehicle = TetheredVehicle(FakePx4(FakeConfig(key=KEY)), MavlinkConfig(key=tmp_path / "other"))
    with pytest.raises(VehicleError):
        vehicle.connect()
    assert vehicle.session.talk.broken > 10


def test_what_is_not_signed_is_not_heard(key_file):
    vehicle = TetheredVehicle(FakePx4(), MavlinkConfig(key=key_file))
    with pytest.raises(VehicleError):
        vehicle.connect()


def test_an_autopilot_with_a_key_does_not_hear_us_without():
    vehicle = TetheredVehicle(FakePx4(FakeConfig(key=KEY)))
    with pytest.raises(VehicleError):
        vehicle.connect()


def test_a_recorded_packet_is_worth_nothing_later(key_file):
    fake = FakePx4(FakeConfig(key=KEY))
    flight = hovering(fake, config=MavlinkConfig(key=key_file))
    land = [packet for _, packet in flight.vehicle.sent]
    heard = len(fake.received) + len(fake.heartbeats)
    for packet in land:
        fake.receive(packet)
    assert len(fake.received) + len(fake.heartbeats) == heard
