"""A gesture becomes a set-point: commands, the follow law, the supervisor."""

from wigwag.fly.values import Command, Setpoint, VehicleState

__all__ = ["Command", "Setpoint", "VehicleState"]
