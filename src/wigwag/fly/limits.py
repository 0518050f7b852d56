"""The supervisor's limits: every number in one place, with a default that flies near people."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.errors import InputError
from wigwag.fly.fence import Cylinder, Fence


@dataclass(frozen=True, slots=True)
class SupervisorConfig:
    """Limits. They can be tightened; loosening them is at the user's own risk.

    Raises:
        InputError: If two limits contradict each other.
    """

    max_speed_m_s: float = 1.5
    """Horizontal speed that is asked for."""
    max_climb_m_s: float = 0.6
    """Speed up and down that is asked for."""
    max_yaw_rate_rad_s: float = 1.2
    """Rate of turning that is asked for."""
    min_distance_m: float = 2.0
    """Horizontal distance to the operator below which the drone only retreats."""
    max_distance_m: float = 8.0
    """An operator farther away than this is not followed, and what they show is not obeyed."""
    retreat_m_s: float = 0.6
    """Speed of the retreat from an operator who came closer than the minimum."""
    braking_1_s: float = 0.8
    """Speed towards a limit of place for each metre that is left to it. Slow enough that a vehicle that takes
    0.4 s to answer does not overshoot."""
    floor_m: float = 0.6
    """Height above the place of arming below which the drone does not descend, except to land."""
    ceiling_m: float = 4.0
    """Height above which it does not climb."""
    fence: Fence = Cylinder(30.0)  # noqa: RUF009  # frozen
    """Where it may be, seen from above."""
    fence_margin_m: float = 2.0
    """So far outside the fence, or above the ceiling, it lands where it is."""
    max_pose_age_s: float = 0.5
    """An operator not seen for this long is lost: the drone stops."""
    land_when_lost_s: float = 30.0
    """Nobody seen for this long: the drone lands."""
    land_when_blind_s: float = 10.0
    """No picture of now for this long: the drone lands."""
    land_when_deaf_s: float = 20.0
    """The recogniser failed and has decided nothing for this long: the drone lands."""
    max_state_age_s: float = 0.5
    """A vehicle state older than this is no state: the drone stops."""
    land_without_state_s: float = 5.0
    """No vehicle state for this long: the drone lands."""
    max_link_age_s: float = 1.0
    """A vehicle not heard of for this long is out of touch: it is asked to hold."""
    land_without_link_s: float = 10.0
    """A vehicle not heard of for this long is asked to land, in case it hears."""
    max_turn_s: float = 0.7
    """Two turns of the loop further apart than this, or in reverse order: the loop hung, or the clock was
    set. The drone stops."""
    battery_low: float = 0.25
    """With less charge there is no take-off, and the drone lands. Share of 1."""
    battery_critical: float = 0.12
    """With less charge the landing goes on by itself after a stop."""
    max_ill_s: float = 2.0
    """The vehicle's own checks complain for this long: the drone lands."""
    command_period_s: float = 1.0
    """Commands are taken at most this often, and the body rests in between; stop and land always."""
    engaged_for_s: float = 1.0
    """Somebody has to have been the operator for this long before a command is taken."""
    take_off_held_s: float = 1.2
    """A take-off that was shown for this long is confirmed; a shorter one has to be shown twice."""
    land_held_s: float = 0.8
    """A landing that was shown for this long is confirmed; a shorter one holds, and has to be shown twice."""
    confirm_within_s: float = 8.0
    """The second showing comes within this time after the first."""
    still_after_hold_s: float = 2.0
    """Asked to hold, the vehicle holds by itself: nothing at all is sent for this long."""
    respite_s: float = 5.0
    """A stop suspends a landing that nobody asked for, for this long."""
    arming_s: float = 5.0
    """A vehicle that is not armed within this time is not going to be."""
    take_off_s: float = 25.0
    """A take-off that takes longer than this is broken off: the drone lands."""
    executing_s: float = 90.0
    """A movement that takes longer than this is broken off: the drone holds."""
    ask_again_s: float = 1.0
    """A landing that the vehicle does not begin is asked for again this often."""

    def __post_init__(self) -> None:
        """Check what would make a guard useless."""
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if isinstance(value, float) and not value >= 0:
                raise InputError(f"SupervisorConfig.{name} must be 0 or more, but got {value}.")
        for low, high in (
            ("min_distance_m", "max_distance_m"),
            ("floor_m", "ceiling_m"),
            ("battery_critical", "battery_low"),
            ("max_pose_age_s", "land_when_lost_s"),
            ("max_state_age_s", "land_without_state_s"),
            ("max_link_age_s", "land_without_link_s"),
        ):
            if not getattr(self, low) < getattr(self, high):
                raise InputError(
                    f"SupervisorConfig.{low} must be below {high}, but got {getattr(self, low)} and "
                    f"{getattr(self, high)}."
                )
