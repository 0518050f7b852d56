"""The set-point leaves: the ``Vehicle`` protocol and its backends."""

from wigwag.vehicles.protocol import AIRBORNE, Capabilities, FlightMode, Vehicle
from wigwag.vehicles.simulated import AutopilotConfig, SimulatedVehicle

__all__ = ["AIRBORNE", "AutopilotConfig", "Capabilities", "FlightMode", "SimulatedVehicle", "Vehicle"]
