"""Vehicles that answer late, gusts, late frames: a person is followed, and commands end where they should."""

from __future__ import annotations

import pytest

from wigwag.evaluate.following import MOVES, VEHICLES, fly_command, follow
from wigwag.fly.values import Command

LATE = ("PX4-like", "ArduCopter-like")


@pytest.mark.parametrize("vehicle", LATE)
def test_a_person_on_an_arc_is_followed_for_a_minute(vehicle: str) -> None:
    followed = follow(vehicle, seed=7)
    assert followed.bearing_deg_mean < 2.0 / 3
    assert followed.distance_m_mean < 0.3 / 2
    assert followed.bearing_deg_max < 4.0


def test_so_does_a_rigid_body() -> None:
    followed = follow("RotorPy", seed=7, seconds=15.0)
    assert followed.bearing_deg_mean < 2.0 / 3
    assert followed.distance_m_mean < 0.3 / 2


@pytest.mark.parametrize("vehicle", LATE)
@pytest.mark.parametrize("command", MOVES)
def test_every_command_ends_near_its_end(vehicle: str, command: Command) -> None:
    missed = [fly_command(vehicle, command, seed) for seed in range(20, 22)]
    assert sum(missed) / len(missed) < 0.15, missed


def test_what_is_flown_follows_from_the_seed() -> None:
    assert follow("PX4-like", 1, 3.0) == follow("PX4-like", 1, 3.0) != follow("PX4-like", 2, 3.0)
    assert set(LATE) < set(VEHICLES)
