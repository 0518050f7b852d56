"""PX4 and ArduPilot over MAVLink, as a companion computer talks to them. NED stays in here."""

from wigwag.vehicles.mavlink.session import MavlinkConfig, Session
from wigwag.vehicles.mavlink.vehicle import MavlinkVehicle

__all__ = ["MavlinkConfig", "MavlinkVehicle", "Session"]
