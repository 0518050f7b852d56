"""What is noticed: one small function an event, over values alone."""

from __future__ import annotations

from collections.abc import Callable

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Craft, Memory, Mode, Situation, age_s
from wigwag.fly.transitions import Event

Watch = Callable[[Situation, Memory, SupervisorConfig], bool]


def pilot_flies(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """A pilot has the vehicle."""
    return now.craft is Craft.PILOTED


def stands(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle stands with propellers locked."""
    return now.craft is Craft.DOWN


def failsafe_flies(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The autopilot flies by itself, and not because a request of ours is still on its way."""
    return now.craft is Craft.OWN and age_s(now.now_ns, memory.asked_ns) > limits.ask_again_s


def link_gone(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle has not been heard of for long."""
    return _since_s(now, memory.link_ok_ns) > limits.land_without_link_s


def link_lost(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle has not been heard of."""
    return age_s(now.now_ns, now.link_ns) > limits.max_link_age_s


def clock_jumped(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Too much time, or less than none, has passed since the last turn."""
    if memory.now_ns is None:
        return False
    passed_s = (now.now_ns - memory.now_ns) * 1e-9
    return not 0 <= passed_s <= limits.max_turn_s


def state_gone(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle has said nothing of its place for long."""
    return _since_s(now, memory.state_ok_ns) > limits.land_without_state_s


def battery_critical(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The charge is nearly gone."""
    return now.battery is not None and now.battery < limits.battery_critical


def fence_broken(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle is well outside the fence or above the ceiling."""
    if state_stale(now, memory, limits):
        return False
    east, north, up = now.position_m
    walls = limits.fence.walls(east, north)
    inside = min(wall.distance_m for wall in walls)
    return inside < -limits.fence_margin_m or up > limits.ceiling_m + limits.fence_margin_m


def ill(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle's own checks have complained for a while."""
    return _since_s(now, memory.health_ok_ns) > limits.max_ill_s


def battery_low(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The charge is low."""
    return now.battery is not None and now.battery < limits.battery_low


def deaf_long(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The recogniser has failed for long."""
    return _since_s(now, memory.hearing_ok_ns) > limits.land_when_deaf_s


def blind_long(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The camera has shown nothing of now for long."""
    return _since_s(now, memory.camera_ok_ns) > limits.land_when_blind_s


def person_gone(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Nobody has been seen for long."""
    return _since_s(now, memory.person_ok_ns) > limits.land_when_lost_s


def state_stale(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle's state is old."""
    return age_s(now.now_ns, now.state_ns) > limits.max_state_age_s


def deaf(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The recogniser has failed and decided nothing since."""
    return now.deaf_ns is not None


def person_swapped(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """Whoever is tracked is not who was tracked before."""
    return now.person != memory.person


def person_lost(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The operator is not seen."""
    return now.distance_m is None or age_s(now.now_ns, now.pose_ns) > limits.max_pose_age_s


def person_far(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The operator is farther away than the drone may be; once lost so, they come somewhat nearer first."""
    back_m = 0.5 if memory.mode is Mode.LOST_PERSON else 0.0
    return now.distance_m is not None and now.distance_m > limits.max_distance_m - back_m


def timeout(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """A mode that has to end has lasted too long."""
    most = {
        Mode.ARMING: limits.arming_s,
        Mode.TAKING_OFF: limits.take_off_s,
        Mode.EXECUTING: limits.executing_s,
    }.get(memory.mode)
    return most is not None and _since_s(now, memory.since_ns) > most


def not_landing(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle was asked to land and still does something else that it can be called off from."""
    elsewhere = now.craft in (Craft.AIRBORNE, Craft.CLIMBING, Craft.ARMED)
    return elsewhere and age_s(now.now_ns, memory.asked_ns) > limits.ask_again_s


def armed(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle stands with propellers that may turn."""
    return now.craft is Craft.ARMED


def link_back(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle is heard of, and what it says is fresh."""
    return not link_lost(now, memory, limits) and not state_stale(now, memory, limits)


def airborne(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The vehicle flies and takes set-points."""
    return now.craft is Craft.AIRBORNE


def moved(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """No movement is under way any more."""
    return not now.moving


def person_seen(now: Situation, memory: Memory, limits: SupervisorConfig) -> bool:
    """The operator is in view and in reach, and the vehicle's place is known."""
    return not (
        person_lost(now, memory, limits)
        or person_far(now, memory, limits)
        or state_stale(now, memory, limits)
    )


def _since_s(now: Situation, moment_ns: int) -> float:
    return (now.now_ns - moment_ns) * 1e-9


WATCHES: dict[Event, Watch] = {
    Event.PILOT: pilot_flies,
    Event.DOWN: stands,
    Event.FAILSAFE: failsafe_flies,
    Event.LINK_GONE: link_gone,
    Event.LINK_LOST: link_lost,
    Event.CLOCK_JUMPED: clock_jumped,
    Event.STATE_GONE: state_gone,
    Event.BATTERY_CRITICAL: battery_critical,
    Event.FENCE_BROKEN: fence_broken,
    Event.ILL: ill,
    Event.BATTERY_LOW: battery_low,
    Event.DEAF_LONG: deaf_long,
    Event.BLIND_LONG: blind_long,
    Event.PERSON_GONE: person_gone,
    Event.STATE_STALE: state_stale,
    Event.DEAF: deaf,
    Event.PERSON_SWAPPED: person_swapped,
    Event.PERSON_LOST: person_lost,
    Event.PERSON_FAR: person_far,
    Event.TIMEOUT: timeout,
    Event.NOT_LANDING: not_landing,
    Event.ARMED: armed,
    Event.LINK_BACK: link_back,
    Event.AIRBORNE: airborne,
    Event.MOVED: moved,
    Event.PERSON_SEEN: person_seen,
}
"""How each event is noticed. The operator's commands (stop, land, take off, move) come by ``gates``."""
