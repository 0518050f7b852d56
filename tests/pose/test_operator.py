"""Who is the operator, through crossings, absences and hand-overs; people on a stage, no networks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from wigwag.camera.frame import Frame
from wigwag.errors import InputError
from wigwag.pose.landmarker import Sighting
from wigwag.pose.operator import Claim, OperatorConfig, OperatorKeeper
from wigwag.pose.people import People, Seen
from wigwag.pose.region import Region
from wigwag.skeleton import Pose, from_blazepose33

from .staged import (
    BLUE,
    CAMERA,
    GREEN,
    RED,
    Player,
    Stage,
    body_of,
    engaging,
    handed,
    raised,
    region_of,
    standing,
    still,
    walks,
)


def operator_at(x_m: float, z_m: float, **changes: object) -> Player:
    return Player(still(x_m, z_m), **{"up": engaging(), **changes})


def test_nobody_is_the_operator_before_they_engage() -> None:
    stage = Stage([Player(still(0.0, 4.0))])
    assert not handed(stage.play(4.0))
    assert stage.estimate.operator is None
    assert stage.estimate.why == "nobody has engaged"
    assert [person.is_operator for person in stage.estimate.people] == [False]
    assert stage.estimate.body is not None, "though they are seen, and may be shown"


def test_who_engages_is_handed_on_from_then_on() -> None:
    stage = Stage([operator_at(0.3, 4.0)])
    seen = handed(stage.play(4.0))
    assert seen[0][0] == pytest.approx(1.55, abs=0.2)
    assert len(seen) == pytest.approx((4.0 - seen[0][0]) * 30, abs=1)
    assert {(round(x, 2), round(z, 2)) for _, x, z in seen} == {(0.3, 4.0)}
    operator = stage.estimate.operator
    assert operator is not None and operator.is_operator and stage.estimate.why == ""


def test_progress_can_be_shown() -> None:
    stage = Stage([operator_at(0.0, 4.0)])
    stage.play(1.1)
    assert 0.3 < stage.estimate.people[0].engaging < 0.8
    assert stage.estimate.people[0].disengaging == 0.0


def test_first_is_for_somebody_alone() -> None:
    stage = Stage([Player(still(0.0, 4.0))], engage="first")
    assert len(handed(stage.play(1.0))) == 30


def test_a_word_from_the_console_engages_whoever_is_alone() -> None:
    stage = Stage([Player(still(0.0, 4.0))])
    assert not handed(stage.play(1.0))
    stage.estimate.call_operator()
    assert len(handed(stage.play(2.0))) > 25
    assert stage.estimate.operator is not None


def test_a_word_from_the_console_engages_nobody_of_two_and_holds_for_a_second() -> None:
    gone = Player(lambda t: (1.2, 4.5) if t < 4.0 else None)
    stage = Stage([Player(still(-0.6, 4.0)), gone])
    stage.play(2.0)
    stage.estimate.call_operator()
    assert not handed(stage.play(8.0)), "nor whoever is alone long after"
    assert stage.estimate.operator is None


def test_a_word_from_the_console_takes_nobodys_place() -> None:
    stage = Stage([operator_at(0.3, 4.0)])
    stage.play(3.0)
    operator = stage.estimate.operator
    stage.players = [*stage.players, Player(still(-1.2, 3.5))]
    stage.estimate.call_operator()
    stage.play(2.0)
    assert operator is not None and stage.estimate.operator is not None
    assert stage.estimate.operator.number == operator.number


def test_of_several_people_the_one_who_engages() -> None:
    others = [Player(still(-1.2, 4.5)), Player(still(1.1, 3.5))]
    stage = Stage([others[0], operator_at(0.0, 4.0, up=engaging(1.5)), others[1]])
    seen = handed(stage.play(5.0))
    assert len(seen) > 60
    assert all(abs(x) < 0.05 and z == pytest.approx(4.0, abs=0.05) for _, x, z in seen)
    assert len(stage.estimate.people) == 3


@pytest.mark.parametrize("clothes", [BLUE, RED], ids=["other clothes", "same clothes"])
@pytest.mark.parametrize("before_m", [1.5, 0.8, -0.8, -1.5])
def test_a_passer_by_is_never_handed_on_and_the_operator_is_again(
    before_m: float, clothes: tuple[int, int, int]
) -> None:
    passer = Player(walks(4.0 - before_m, 3.0), shirt=clothes)
    stage = Stage([operator_at(0.0, 4.0), passer])
    stage.play(3.0)
    seen = handed(stage.play(7.0))
    assert all(abs(x) < 0.05 and z == pytest.approx(4.0, abs=0.1) for _, x, z in seen)
    clear_s = 3.0 + (2.2 + 0.6) / 1.3
    assert len([t for t, _, _ in seen if t > clear_s + 0.3]) == pytest.approx(
        (7.0 - clear_s - 0.3) * 30, abs=2
    )
    if before_m < 0:
        assert len(seen) == 120, "who passes behind hides nobody"
    else:
        hidden = 120 - len(seen)
        assert 5 < hidden < 45


@pytest.mark.parametrize(("clothes", "back"), [(BLUE, True), (RED, False)], ids=["other", "same"])
def test_whoever_mingles_with_somebody_in_the_same_clothes_has_to_engage_again(
    clothes: tuple[int, int, int], back: bool
) -> None:
    """Half an arm's length before the operator nothing but clothes tells them apart."""
    up = raised((0.5, 1.8), (9.0, 10.5))
    stage = Stage([operator_at(0.0, 4.0, up=up), Player(walks(3.55, 3.0), shirt=clothes)])
    stage.play(3.0)
    seen = handed(stage.play(8.5))
    assert all(abs(x) < 0.05 and z == pytest.approx(4.0, abs=0.1) for _, x, z in seen)
    assert bool([t for t, _, _ in seen if t > 6.0]) is back
    if not back:
        assert stage.estimate.why == "the operator was too close to somebody alike and has to engage again"
        assert handed(stage.play(11.0))[0][0] == pytest.approx(10.05, abs=0.3)


def looked_at(z_m: float, x_m: float = 0.0) -> Seen:
    points = standing(x_m, z_m)
    body = body_of(points)
    return Seen(body, region_of(body), Pose(from_blazepose33(points), np.ones(13), 0))


@pytest.mark.parametrize("covered", [True, False])
def test_a_mixture_with_whoever_begins_to_cover_the_operator_is_not_handed_on(covered: bool) -> None:
    """The hips of two bodies in one: a third of a metre nearer in one frame, where somebody comes before."""
    people = People()
    keeper = OperatorKeeper(OperatorConfig(), people)
    keeper.track = people.add(looked_at(4.0), 0)
    depth = np.full((480, 640), 3900, np.uint16)
    if covered:
        depth[:, : round(CAMERA.cx - 0.02 * CAMERA.fx)] = 3300
    now = 33_333_333
    keeper.begin(Frame(np.zeros((480, 640, 3), np.uint8), depth, CAMERA, now))
    assert (keeper.cover.nearer > 0.1) is covered and keeper.cover.nearer < keeper.config.hidden
    assert (keeper.claim(looked_at(3.67), now) is Claim.NO) is covered
    assert keeper.claim(looked_at(3.95), now) is Claim.YES, "as noisy as depth is"


@pytest.mark.parametrize("close", [True, False])
def test_a_mixture_with_whoever_comes_close_is_not_handed_on(close: bool) -> None:
    """The hips of two bodies in one, at the operator's distance: they jump aside as nobody runs."""
    people = People()
    keeper = OperatorKeeper(OperatorConfig(), people)
    keeper.track = operator = people.add(looked_at(8.0), 0)
    assert operator is not None
    if close:
        people.add(looked_at(6.8, x_m=-0.8), 0)
    now = 33_333_333
    people.begin(now, operator, (0.0, 0.0), CAMERA)
    keeper.begin(Frame(np.zeros((480, 640, 3), np.uint8), np.full((480, 640), 7900, np.uint16), CAMERA, now))
    assert (keeper.claim(looked_at(8.0, x_m=-0.25), now) is Claim.NO) is close
    if close:
        assert operator.position_m[0] == pytest.approx(0.0), "nor is the operator expected there from now on"
        assert keeper.claim(looked_at(8.1, x_m=-0.1), now) is Claim.YES, "as people run"


@pytest.mark.parametrize(
    ("before_m", "covered", "away"),
    [(None, False, True), (None, True, False), (6.8, False, False), (7.9, False, True)],
    ids=["nobody", "a fifth covered", "known before them", "known beside them"],
)
def test_who_may_be_hidden_is_not_taken_for_gone(before_m: float | None, covered: bool, away: bool) -> None:
    """Who stands before the operator hides them, though not where the operator is expected to be."""
    people = People()
    keeper = OperatorKeeper(OperatorConfig(), people)
    keeper.track = operator = people.add(looked_at(8.0), 0)
    other = None if before_m is None else people.add(looked_at(before_m, x_m=0.4), 0)
    depth = np.full((480, 640), 7900, np.uint16)
    if covered:
        depth[:, : round(CAMERA.cx - 0.01 * CAMERA.fx)] = 6700
    for k in range(1, 91):
        now = round(k * 1e9 / 30)
        people.begin(now, operator, (0.0, 0.0), CAMERA)
        if other is not None:
            people.update(other, looked_at(before_m, x_m=0.4), now)
        keeper.begin(Frame(np.zeros((480, 640, 3), np.uint8), depth, CAMERA, now))
    assert not covered or 0.1 < keeper.cover.nearer < 0.3
    assert keeper.away is away


def sitting(z_m: float, share: float = 0.6) -> Seen:
    """Somebody whose hips are seen so much nearer to their shoulders: behind their thighs."""
    points = standing(0.0, z_m)
    points[:11, 1] += (1 - share) * 0.5
    points[11:23, 1] += (1 - share) * float(points[[23, 24], 1].mean() - points[[11, 12], 1].mean())
    body = body_of(points)
    return Seen(body, region_of(body), Pose(from_blazepose33(points), np.ones(13), 0))


@pytest.mark.parametrize("close", [True, False])
def test_who_sits_down_is_still_the_operator_unless_it_may_be_a_mixture(close: bool) -> None:
    people = People()
    keeper = OperatorKeeper(OperatorConfig(), people)
    keeper.track = operator = people.add(looked_at(4.0), 0)
    assert operator is not None
    if close:
        people.add(looked_at(3.5, x_m=-0.6), 0)
    torso_m = operator.torso_m
    for k in range(1, 31):
        now = round(k * 1e9 / 30)
        people.begin(now, operator, (0.0, 0.0), CAMERA)
        keeper.begin(
            Frame(np.zeros((480, 640, 3), np.uint8), np.full((480, 640), 3900, np.uint16), CAMERA, now)
        )
        claim = keeper.claim(sitting(4.0), now)
        assert claim is (Claim.NO if close else Claim.YES)
    assert operator.torso_m == pytest.approx(torso_m), "nor do they shrink for good"


def bending(begin_s: float, end_s: float, depth_m: float = 0.3) -> Callable[[float], float]:
    return lambda t: depth_m * float(np.clip(min(t - begin_s, end_s - t) / 0.5, 0.0, 1.0))


def test_who_steps_before_a_bent_operator_hides_them_all_the_same() -> None:
    operator = operator_at(0.0, 4.0, lean=bending(3.0, 6.0))
    stage = Stage([operator, Player(walks(2.9, 3.0), shirt=RED)])
    stage.play(3.0)
    seen = handed(stage.play(7.0))
    assert all(abs(x) < 0.05 and z == pytest.approx(4.0, abs=0.1) for _, x, z in seen)
    assert 5 < 120 - len(seen) < 45


def test_while_hidden_nothing_is_handed_on_and_it_says_why() -> None:
    stage = Stage([operator_at(0.0, 4.0), Player(walks(3.0, 3.0), shirt=BLUE)])
    stage.play(3.0 + 2.2 / 1.3)
    assert stage.seen[-1][1] is None
    assert stage.estimate.why == "somebody or something stands before the operator"
    operator = stage.estimate.operator
    assert operator is not None and operator.position_m[2] == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("clothes", [BLUE, RED], ids=["other clothes", "same clothes"])
def test_who_stops_before_the_operator_is_not_taken_for_them(clothes: tuple[int, int, int]) -> None:
    def stops(t_s: float) -> tuple[float, float] | None:
        x = -2.2 + 1.3 * max(t_s - 3.0, 0.0)
        if t_s < 3.0:
            return None
        return (min(x, 0.0), 3.0) if t_s < 8.0 else (1.3 * (t_s - 8.0), 3.0)

    stage = Stage([operator_at(0.0, 4.0), Player(stops, shirt=clothes)])
    stage.play(3.0)
    seen = handed(stage.play(11.0))
    assert all(z == pytest.approx(4.0, abs=0.1) for _, _, z in seen)
    assert [t for t, _, _ in seen if t > 9.5], "and after they went on, the operator is believed again"
    assert not [t for t, _, _ in seen if 5.0 < t < 8.0]


def test_who_stops_beside_the_operator_and_shows_commands_is_not_heard() -> None:
    def stops(t_s: float) -> tuple[float, float] | None:
        return None if t_s < 3.0 else (max(2.2 - 1.3 * (t_s - 3.0), 0.7), 4.0)

    mimic = Player(stops, shirt=RED, up=raised((5.0, 7.0), (8.0, 11.0), both=False))
    stage = Stage([operator_at(0.0, 4.0), mimic])
    stage.play(3.0)
    seen = handed(stage.play(12.0))
    assert len(seen) == 270
    assert all(abs(x) < 0.05 for _, x, _ in seen)


def test_the_operator_may_walk_while_crossed() -> None:
    def strolls(t_s: float) -> tuple[float, float]:
        return 0.6 * max(0.0, min(t_s - 3.0, 3.0)) - 0.8, 4.0

    stage = Stage([Player(strolls, up=engaging()), Player(walks(3.0, 3.2), shirt=BLUE)])
    stage.play(3.0)
    seen = handed(stage.play(8.0))
    assert all(z == pytest.approx(4.0, abs=0.1) for _, _, z in seen)
    assert seen[-1][1] == pytest.approx(1.0, abs=0.05)
    assert len(seen) > 100


@pytest.mark.parametrize("step_m", [0.8, -0.2], ids=["back", "forward"])
def test_who_steps_back_while_hidden_is_known_again(step_m: float) -> None:
    """Farther from who hid them than they were, they can't be mistaken for that one."""

    def steps(t_s: float) -> tuple[float, float]:
        return 0.0, 4.0 + step_m * float(np.clip((t_s - 4.4) / 0.4, 0.0, 1.0))

    stage = Stage([Player(steps, up=engaging()), Player(walks(3.0, 3.0), shirt=RED)])
    stage.play(3.0)
    seen = handed(stage.play(8.0))
    assert all(abs(x) < 0.05 for _, x, _ in seen)
    assert len([t for t, _, _ in seen if t > 5.6]) == pytest.approx(72, abs=3)


def gone_from(t_s: float, back_s: float, x_m: float = 0.0):  # type: ignore[no-untyped-def]
    """Stand, walk out to the right at t_s, and be back at the place at back_s."""

    def at(t: float) -> tuple[float, float] | None:
        if t < t_s:
            return x_m, 4.0
        if t < back_s - 2.0:
            out = x_m + 1.5 * (t - t_s)
            return (out, 4.0) if out < 3.0 else None
        return (max(x_m, x_m + 1.5 * (back_s - t)), 4.0)

    return at


@pytest.mark.parametrize("clothes", [BLUE, RED], ids=["other clothes", "same clothes"])
def test_who_stands_where_the_operator_stood_is_not_the_operator(clothes: tuple[int, int, int]) -> None:
    def takes_the_place(t_s: float) -> tuple[float, float] | None:
        return None if t_s < 6.0 else (min(-2.2 + 1.3 * (t_s - 6.0), 0.0), 4.0)

    leaver = Player(gone_from(3.0, 100.0), up=engaging())
    stage = Stage([leaver, Player(takes_the_place, shirt=clothes, up=lambda t: (False, False))])
    stage.play(3.0)
    seen = handed(stage.play(20.0))
    assert all(x > -0.1 for _, x, _ in seen)
    assert not [t for t, _, _ in seen if t > 5.5]


@pytest.mark.parametrize("apart_m", [1.0, 1.7, 2.0])
def test_whoever_is_known_as_somebody_else_does_not_follow_an_operator_who_is_gone(apart_m: float) -> None:
    """In the same clothes, at the same distance, beside: only who they were tells them apart."""
    operator = Player(lambda t: (1.5, 4.0) if t < 3.0 else None, up=engaging())
    stage = Stage([operator, Player(still(1.5 - apart_m, 4.0), shirt=RED)])
    stage.play(3.0)
    assert not handed(stage.play(9.0))
    assert len(stage.estimate.people) == 2


def test_until_the_operator_is_released_nobody_who_looks_different_is_let_in() -> None:
    def takes_the_place(t_s: float) -> tuple[float, float] | None:
        return None if t_s < 5.0 else (0.0, 4.0)

    newcomer = Player(takes_the_place, shirt=BLUE, up=raised((7.0, 9.0), (16.0, 18.0)))
    stage = Stage([Player(gone_from(3.0, 100.0), up=engaging()), newcomer])
    stage.play(4.5)
    assert not handed(stage.play(15.5)), "ten seconds have not passed, and the operator has not let go"
    seen = handed(stage.play(19.0))
    assert seen and seen[0][0] == pytest.approx(17.05, abs=0.3)


def test_who_comes_back_late_has_to_engage_again_and_may() -> None:
    up = raised((0.5, 1.8), (10.5, 12.0))
    stage = Stage([Player(gone_from(3.0, 9.0), up=up)])
    stage.play(6.0)
    assert not handed(stage.play(10.5))
    assert stage.estimate.why == "the operator went away and has to engage again"
    assert handed(stage.play(12.5))[0][0] == pytest.approx(11.55, abs=0.3)


def test_a_moment_unseen_is_forgiven() -> None:
    stage = Stage([operator_at(0.0, 4.0)])
    stage.play(3.0)
    stage.blind = True
    assert not handed(stage.play(3.0 + 3 / 30))
    stage.blind = False
    assert len(handed(stage.play(4.0))) == 27, "three frames are the network's fault"
    stage.blind = True
    stage.play(4.8)
    stage.blind = False
    assert 15 < len(handed(stage.play(5.8))) < 29, "a longer gap takes a few frames to be sure"


class Crooked(Stage):
    """Eyes that see somebody off the middle of where they look too low and too large, as the network does."""

    def follow(self, rgb: np.ndarray, region: Region) -> Sighting | None:
        sighting = super().follow(rgb, region)
        if sighting is None:
            return None
        points = sighting.body.points_px
        if np.hypot(*(sighting.body.hip_center_px - (region.u, region.v))) < 0.1 * region.side:
            return sighting
        hips = points[[23, 24]].mean(axis=0)
        low = replace(sighting.body, points_px=hips + 1.25 * (points - hips) + (0.0, 60.0))
        return Sighting(low, region_of(low))


def test_after_a_second_without_pictures_the_same_person_is_the_same() -> None:
    """The drone moved on meanwhile, and the look at where they were shows a crooked body: nobody new."""
    stage = Crooked([Player(lambda t: (0.0, 4.0) if t < 2.5 else (0.4, 4.0))], engage="first")
    assert handed(stage.play(2.0))
    who = stage.estimate.operator
    stage.t_s = 3.2
    assert len(handed(stage.play(4.2))) > 25
    assert who is not None and stage.estimate.operator is not None
    assert stage.estimate.operator.number == who.number


def test_handing_over_needs_both() -> None:
    first = Player(still(-0.7, 4.0), up=lambda t: (0.5 <= t < 1.8 or 6 <= t < 8, 6 <= t < 8))
    second = Player(still(0.7, 4.0), shirt=BLUE, up=raised((3.0, 4.5), (7.0, 8.4), (10.0, 11.5)))
    stage = Stage([first, second])
    seen = handed(stage.play(6.5))
    assert seen and all(x == pytest.approx(-0.7, abs=0.05) for _, x, _ in seen), "one alone is not enough"
    stage.play(8.0)
    assert stage.estimate.operator is None, "the first has let go"
    assert not handed(stage.play(10.0)), "a hand held up before that has to come down first"
    seen = handed(stage.play(13.0))
    assert seen[0][0] == pytest.approx(11.1, abs=0.3)
    assert all(x == pytest.approx(0.7, abs=0.05) for _, x, _ in seen)


def test_two_who_engage_at_once_do_not_become_one() -> None:
    stage = Stage([operator_at(-0.8, 4.0), operator_at(0.8, 4.0, shirt=GREEN)])
    seen = handed(stage.play(5.0))
    assert seen
    assert len({round(x, 1) for _, x, _ in seen}) == 1


def test_somebody_of_another_size_in_the_same_clothes_is_not_the_operator() -> None:
    """A child steps in where the operator was for a moment unseen."""
    child = Player(lambda t: None if t < 3.5 else (0.0, 4.0), scale=0.6)
    adult = Player(lambda t: None if t >= 3.3 else (0.0, 4.0), up=engaging())
    stage = Stage([adult, child])
    stage.play(3.3)
    assert not handed(stage.play(5.0))


def test_reset_forgets_the_operator() -> None:
    stage = Stage([operator_at(0.0, 4.0)])
    stage.play(3.0)
    stage.estimate.reset()
    assert stage.estimate.operator is None and stage.estimate.people == ()
    assert not handed(stage.play(4.0))


def test_one_look_a_frame_while_somebody_is_the_operator() -> None:
    stage = Stage([operator_at(0.0, 4.0)])
    stage.play(2.5)
    looks, searches = stage.looks, stage.searches
    stage.play(5.5)
    assert stage.looks - looks == 90
    assert stage.searches - searches == pytest.approx(90 / 15, abs=1)


def test_others_cost_a_fraction_of_that() -> None:
    stage = Stage([operator_at(0.0, 4.0), Player(still(2.0, 5.5)), Player(still(-2.0, 5.5), shirt=BLUE)])
    stage.play(4.0)
    looks = stage.looks
    stage.play(7.0)
    assert 90 < stage.looks - looks < 90 * 1.25
    assert len(stage.estimate.people) == 3, "though they are kept in mind"


@pytest.mark.parametrize(
    "changes", [{"engage": "voice"}, {"lost_s": 0.0}, {"away_s": np.nan}, {"confirm": 0}, {"hidden": -1.0}]
)
def test_configuration_out_of_range_is_an_error(changes: dict[str, object]) -> None:
    with pytest.raises(InputError, match=f"OperatorConfig.{next(iter(changes))}"):
        OperatorConfig(**changes)  # type: ignore[arg-type]
