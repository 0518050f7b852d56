"""People kept in mind: prediction, who a look belongs to, newcomers, forgetting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wigwag.pose.appearance import Appearance
from wigwag.pose.people import People, PeopleConfig, Seen, Track
from wigwag.skeleton import Pose, from_blazepose33

from .staged import CAMERA, Player, Stage, body_of, engaging, region_of, standing, still, walks

SECOND = 10**9
STILL = (0.0, 0.0)
RED = Appearance.of(np.array([[0.5, 0.05, 0.05]] * 2 + [[0.1, 0.1, 0.1]]))
BLUE = Appearance.of(np.array([[0.05, 0.05, 0.5]] * 2 + [[0.1, 0.1, 0.1]]))


def look(x_m: float, z_m: float, scale: float = 1.0, appearance: Appearance | None = RED) -> Seen:
    points = standing(0.0, 0.0) * scale + np.array([x_m, 0.0, z_m])
    body = body_of(points)
    return Seen(body, region_of(body), Pose(from_blazepose33(points), np.ones(13), 0), appearance)


def somebody(people: People, x_m: float, z_m: float, now_ns: int = 0) -> Track:
    track = people.add(look(x_m, z_m), now_ns)
    assert track is not None
    return track


def walked(speed_m_s: float = 1.2, seconds: float = 1.0) -> tuple[People, Track]:
    """Somebody who has walked to the right, 4 m away, and is at x = 0 now, at ``seconds``."""
    people = People()
    frames = round(30 * seconds)
    track = somebody(people, -speed_m_s * seconds, 4.0)
    for k in range(1, frames + 1):
        people.begin(k * SECOND // 30, None, STILL, CAMERA)
        people.update(track, look(speed_m_s * (k - frames) / 30, 4.0), k * SECOND // 30)
    return people, track


def test_who_walks_is_expected_to_go_on_and_to_slow_down() -> None:
    _, track = walked()
    assert track.velocity_m_s == pytest.approx([1.2, 0.0, 0.0], abs=0.25)
    coast_s = PeopleConfig().coast_s
    ahead = [track.expected_m(round((1 + s) * SECOND), coast_s)[0] for s in (0.0, 0.3, 1.0, 10.0)]
    assert ahead[0] == pytest.approx(0.0, abs=0.01)
    assert 0.2 < ahead[1] < 0.36
    assert ahead[1] < ahead[2] < ahead[3] < 1.2 * coast_s * 1.3


def test_the_region_goes_along_and_grows_with_nearness() -> None:
    _, track = walked()
    region = track.expected_region(round(1.4 * SECOND), 0.7, CAMERA)
    assert region.u - track.seen.region.u == pytest.approx(0.37 * CAMERA.fx / 4.0, rel=0.3)
    track.velocity_m_s = np.array([0.0, 0.0, -1.0])
    assert track.expected_region(round(1.5 * SECOND), 0.7, CAMERA).side > 1.05 * track.seen.region.side


def test_a_camera_that_turns_takes_people_along() -> None:
    people = People()
    track = somebody(people, 0.5, 4.0)
    before, region = CAMERA.project(track.position_m), track.region
    people.begin(SECOND // 30, None, (20.0, -35.0), CAMERA)
    assert CAMERA.project(track.position_m) - before == pytest.approx([20.0, -35.0], abs=1.5)
    assert np.linalg.norm(track.position_m) == pytest.approx(np.linalg.norm([0.5, 0.1, 4.0]))
    assert (track.region.u - region.u, track.region.v - region.v) == (20.0, -35.0)


def test_a_look_belongs_to_whom_it_fits_best() -> None:
    people = People()
    left, right = somebody(people, -0.5, 4.0), somebody(people, 0.5, 4.2)
    now = SECOND // 30
    people.begin(now, None, STILL, CAMERA)
    for x_m, whose in ((-0.45, left), (-0.2, left), (0.2, right), (0.55, right)):
        assert people.owner(look(x_m, 4.1), now, people.tracks) is whose
    assert people.owner(look(0.5, 3.2), now, people.tracks) is None, "a metre nearer is somebody else"
    assert people.owner(look(2.0, 4.0), now, people.tracks) is None


def test_distance_is_trusted_more_than_the_place_across() -> None:
    """A camera turns and the picture moves; nobody comes nearer by it."""
    people = People()
    track = somebody(people, 0.0, 4.0)
    now = SECOND // 30
    assert people.misfit(track, look(0.45, 4.0), now) < 1.0
    assert people.misfit(track, look(0.0, 3.55), now) == np.inf
    assert people.misfit(track, look(0.0, 3.75), now) < 1.0
    assert people.misfit(track, look(0.0, 3.75), now, nearer_slack_m=0.2) == np.inf
    assert people.misfit(track, look(0.0, 4.25), now, nearer_slack_m=0.2) < 1.0


def test_the_longer_unseen_the_less_is_certain_but_not_without_end() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    fits = [people.misfit(track, look(0.0, 4.9), round(s * SECOND)) < 1 for s in (0.1, 0.9, 5.0)]
    assert fits == [False, True, True]
    assert people.misfit(track, look(0.0, 6.0), 60 * SECOND) == np.inf


def test_clothes_decide_after_a_while_without_a_look() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    stranger = look(0.1, 4.0, appearance=BLUE)
    assert people.owner(stranger, round(0.5 * SECOND), [track]) is track, "from the side clothes deceive"
    assert people.owner(stranger, round(1.5 * SECOND), [track]) is None
    assert people.owner(look(0.1, 4.0), round(1.5 * SECOND), [track]) is track
    assert people.looks_like(track, None) and not people.looks_like(track, BLUE)


def test_size_tells_a_child_from_an_adult() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    assert people.sized_like(track, look(0.0, 4.0, scale=1.15))
    assert not people.sized_like(track, look(0.0, 4.0, scale=0.6))
    assert people.sized_like(track, look(0.0, 4.0, scale=0.6), folded=True), "who sits looks shorter"
    assert not people.sized_like(track, look(0.0, 4.0, scale=1.5), folded=True), "nobody looks longer"


def test_trunks_that_cannot_be_are_not_coherent() -> None:
    c = PeopleConfig()
    assert look(0.0, 4.0).coherent(c)
    assert not look(0.0, 4.0, scale=0.4).coherent(c)
    torn = look(0.0, 4.0)
    joints = torn.pose.joints.copy()
    joints[7, 2] += 0.8  # one hip on the wall behind
    assert not replace(torn, pose=Pose(joints, np.ones(13), 0)).coherent(c)


def test_what_is_learned_while_nobody_is_close_stays_while_somebody_is() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    known = track.torso_m
    for k in range(1, 31):
        seen = look(0.0, 4.0, scale=1.1, appearance=BLUE)
        people.update(track, seen, k * SECOND // 30, learn=False)
    assert track.torso_m == known
    assert track.appearance is not None and track.appearance.difference(RED) == 0.0
    for k in range(31, 61):
        people.update(track, look(0.0, 4.0, scale=1.1), k * SECOND // 30)
    assert known < track.torso_m < 1.1 * known


def test_half_hidden_people_teach_no_speed() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    for k in range(1, 10):
        people.update(track, look(0.05 * k, 4.0), k * SECOND // 30, hidden=True)
    assert track.velocity_m_s.tolist() == [0.0, 0.0, 0.0]
    assert track.position_m[0] == pytest.approx(0.45, abs=0.01)


def test_whoever_hides_somebody_does_not_draw_them_nearer() -> None:
    people = People()
    track = somebody(people, 0.0, 4.0)
    for k in range(1, 10):
        people.update(track, look(0.02 * k, 4.0 - 0.05 * k), k * SECOND // 30, hidden=True)
    assert np.linalg.norm(track.position_m) == pytest.approx(np.hypot(4.0, 0.1), abs=0.01)
    assert track.position_m[0] == pytest.approx(0.2, abs=0.03)


def test_whoever_begins_to_hide_somebody_lends_them_no_speed() -> None:
    """A single look 0.3 m too near, as an arm before the hips gives, must not send them on their way."""
    people = People()
    near, plain = somebody(people, 0.0, 4.0), somebody(people, 1.5, 4.0)
    people.update(near, look(0.0, 3.7), SECOND // 30, touched=True)
    people.update(plain, look(1.5, 3.7), SECOND // 30)
    assert near.velocity_m_s.tolist() == [0.0, 0.0, 0.0] and plain.velocity_m_s[2] < -0.3
    assert 3.9 < near.position_m[2] < 3.95, "no faster than people run"
    for k in range(2, 10):
        people.update(near, look(0.0, 3.7), k * SECOND // 30, touched=True)
    assert near.position_m[2] == pytest.approx(3.7, abs=0.01), "and not for ever"


def test_a_mixture_of_two_bodies_is_nobody_new() -> None:
    people = People()
    operator = somebody(people, 0.0, 4.0)
    now = SECOND // 30
    assert not people.may_be_new(look(0.1, 3.5), now, operator)
    assert people.may_be_new(look(0.1, 3.1), now, operator), "a passer-by"
    assert people.may_be_new(look(0.1, 3.5), now, None)


def test_newcomers_are_taken_up_once_and_not_beyond_the_most() -> None:
    people = People(PeopleConfig(most=2))
    first = somebody(people, 0.0, 4.0)
    first.body = first.seen.body
    assert people.add(look(0.1, 4.0), 0) is None, "the same person twice in one frame"
    second = people.add(look(1.5, 4.0), 0)
    assert second is not None and second.number == first.number + 1
    assert people.add(look(-1.5, 4.0), 0) is None


def test_whoever_is_not_seen_is_forgotten_but_for_the_operator() -> None:
    people = People()
    one, other = somebody(people, 0.0, 4.0), somebody(people, 1.5, 4.0)
    people.begin(round(1.9 * SECOND), other, STILL, CAMERA)
    assert people.tracks == [one, other]
    people.begin(round(2.1 * SECOND), other, STILL, CAMERA)
    assert people.tracks == [other]
    number = somebody(people, -1.0, 4.0).number
    assert number > other.number, "numbers are never given twice"


def test_who_is_close_in_the_picture_though_metres_before() -> None:
    people = People()
    track, before, aside = somebody(people, 0.4, 4.0), somebody(people, 0.2, 2.0), somebody(people, -1.8, 4.0)
    assert people.close_to(track, SECOND // 30) == [before]
    aside.velocity_m_s = np.array([2.4, 0.0, 0.0])
    assert people.close_to(track, SECOND // 30) == [before, aside], "and who soon will be"


def test_people_are_found_followed_and_told_apart_on_the_stage() -> None:
    stage = Stage([
        Player(still(-1.0, 4.0), up=engaging()),
        Player(still(1.0, 3.0)),
        Player(walks(2.2, 1.0, 0.8, from_m=-1.1)),
    ])  # fmt: skip
    numbers = set()
    for tenth in range(5, 35):
        stage.play(tenth / 10)
        numbers |= {person.number for person in stage.estimate.people}
    assert numbers == {1, 2, 3}, "nobody is taken for somebody new"
    assert {round(float(p.position_m[2])) for p in stage.estimate.people} == {2, 3, 4}
