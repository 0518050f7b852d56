"""A gesture becomes a set-point: commands, the follow law, the supervisor."""

from wigwag.fly.values import HOVER, Command, Setpoint, VehicleState

__all__ = ["HOVER", "Command", "Setpoint", "VehicleState"]
