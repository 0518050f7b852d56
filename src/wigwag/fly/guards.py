"""What a set-point has to pass before it is sent: one small function a limit."""

from __future__ import annotations

import math
from collections.abc import Callable

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Memory, Situation
from wigwag.fly.values import HOVER, Setpoint

Guard = Callable[[Setpoint, Situation, Memory, SupervisorConfig], Setpoint]


def finite(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Stand still rather than fly what is no number."""
    return wish if all(map(math.isfinite, (*wish.velocity_m_s, wish.yaw_rate_rad_s))) else HOVER


def farthest(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Do not leave the operator behind."""
    if now.distance_m is None:
        return wish
    most = limits.braking_1_s * max(limits.max_distance_m - now.distance_m, 0.0)
    return _along(wish, now.bearing_rad + math.pi, most)


def nearest(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Brake before the minimum distance to the operator; nearer than that, retreat straight."""
    if now.distance_m is None:
        return wish
    left_m = now.distance_m - limits.min_distance_m
    if left_m >= 0:
        return _along(wish, now.bearing_rad, limits.braking_1_s * left_m)
    ahead, side = math.cos(now.bearing_rad), math.sin(now.bearing_rad)
    forward, left, up = wish.velocity_m_s
    approach = min(forward * ahead + left * side, -limits.retreat_m_s)
    return Setpoint((approach * ahead, approach * side, up), wish.yaw_rate_rad_s)


def speed(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Fly no faster than allowed."""
    forward, left, up = wish.velocity_m_s
    size = math.hypot(forward, left)
    if size <= limits.max_speed_m_s:
        return wish
    if not math.isfinite(size):  # each part is a number, but its speed is none
        return Setpoint((0.0, 0.0, up), wish.yaw_rate_rad_s)
    share = limits.max_speed_m_s / size
    return Setpoint((forward * share, left * share, up), wish.yaw_rate_rad_s)


def climb(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Climb and descend no faster than allowed."""
    forward, left, up = wish.velocity_m_s
    most = limits.max_climb_m_s
    return Setpoint((forward, left, min(max(up, -most), most)), wish.yaw_rate_rad_s)


def floor(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Do not descend below the floor."""
    forward, left, up = wish.velocity_m_s
    least = -limits.braking_1_s * max(now.position_m[2] - limits.floor_m, 0.0)
    return Setpoint((forward, left, max(up, least)), wish.yaw_rate_rad_s)


def ceiling(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Do not climb above the ceiling."""
    forward, left, up = wish.velocity_m_s
    most = limits.braking_1_s * max(limits.ceiling_m - now.position_m[2], 0.0)
    return Setpoint((forward, left, min(up, most)), wish.yaw_rate_rad_s)


def fence(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Do not leave the fence, not even to retreat."""
    east, north, _ = now.position_m
    for wall in limits.fence.walls(east, north):
        direction = math.atan2(wall.north, wall.east) - now.heading_rad
        wish = _along(wish, direction, limits.braking_1_s * max(wall.distance_m, 0.0))
    return wish


def cornered(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Stand still where what one limit leaves leads beyond another: between a wall and the operator."""
    east, north, _ = now.position_m
    allowed = [
        (math.atan2(wall.north, wall.east) - now.heading_rad, wall.distance_m)
        for wall in limits.fence.walls(east, north)
    ]
    if now.distance_m is not None:
        allowed.append((now.bearing_rad, now.distance_m - limits.min_distance_m))
        allowed.append((now.bearing_rad + math.pi, limits.max_distance_m - now.distance_m))
    forward, left, up = wish.velocity_m_s
    for direction, left_m in allowed:
        towards = forward * math.cos(direction) + left * math.sin(direction)
        if towards > limits.braking_1_s * max(left_m, 0.0) + _ROUNDING_M_S:
            return Setpoint((0.0, 0.0, up), wish.yaw_rate_rad_s)
    return wish


def yaw_rate(wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig) -> Setpoint:
    """Turn no faster than allowed."""
    most = limits.max_yaw_rate_rad_s
    return Setpoint(wish.velocity_m_s, min(max(wish.yaw_rate_rad_s, -most), most))


GUARDS: tuple[Guard, ...] = (
    finite,
    farthest,
    nearest,
    speed,
    climb,
    floor,
    ceiling,
    fence,
    cornered,
    yaw_rate,
)
"""Every guard, in the order in which a set-point passes them. What comes later wins: the fence over the
retreat."""
_ROUNDING_M_S = 1e-9


def guarded(
    guards: tuple[Guard, ...], wish: Setpoint, now: Situation, memory: Memory, limits: SupervisorConfig
) -> tuple[Setpoint, str]:
    """Pass a set-point through the guards; return what is left of it, and which of them changed it."""
    changed = []
    for guard in guards:
        after = guard(wish, now, memory, limits)
        if after != wish:
            changed.append(guard.__name__)
        wish = after
    return wish, ", ".join(changed)


def _along(wish: Setpoint, direction_rad: float, most_m_s: float) -> Setpoint:
    """Let no more than a speed remain of what leads in a direction (from the nose, positive to the left)."""
    ahead, side = math.cos(direction_rad), math.sin(direction_rad)
    forward, left, up = wish.velocity_m_s
    excess = forward * ahead + left * side - most_m_s
    if excess <= 0:
        return wish
    return Setpoint((forward - excess * ahead, left - excess * side, up), wish.yaw_rate_rad_s)
