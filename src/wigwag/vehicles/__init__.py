"""The set-point leaves: the ``Vehicle`` protocol and its backends."""

from wigwag.vehicles.protocol import FlightMode, Vehicle
from wigwag.vehicles.simulated import AutopilotConfig, SimulatedVehicle

__all__ = ["AutopilotConfig", "FlightMode", "SimulatedVehicle", "Vehicle"]
