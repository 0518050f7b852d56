"""What must come out, told as short flights. Each takes the rules, so that any one can be taken away."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from tests.fly.scene import WISH, Scene, flying
from wigwag.fly.fence import Cylinder, Polygon
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Mode
from wigwag.fly.supervisor import Rules
from wigwag.fly.values import HOVER, Command, Setpoint

Scenario = Callable[[Rules], None]
SCENARIOS: list[Scenario] = []
LIMITS = SupervisorConfig()


def scenario(play: Scenario) -> Scenario:
    SCENARIOS.append(play)
    return play


def grounded(rules: Rules, config: SupervisorConfig | None = None) -> Scene:
    scene = Scene(rules, config)
    scene.turns(2.0)
    assert scene.mode is Mode.DISARMED and scene.sent == [None] * 60
    return scene


# --- taking off and landing -----------------------------------------------------------------------------


@scenario
def a_whole_flight(rules: Rules) -> None:
    scene = grounded(rules)
    assert scene.turn(Command.TAKE_OFF).action is Action.ARM
    scene.until(Mode.TAKING_OFF, 1.0)
    assert scene.verdict.action is Action.TAKE_OFF
    scene.until(Mode.FOLLOWING, 4.0)
    assert scene.turn().row == "" and scene.sent[-1] == WISH
    scene.turns(1.0)
    assert scene.turn(Command.UP).accepted is Command.UP
    assert scene.mode is Mode.EXECUTING and scene.sent[-1] == WISH
    scene.known["moving"] = False
    scene.turn()
    assert scene.mode is Mode.FOLLOWING
    assert scene.turn(Command.LAND).action is Action.LAND
    scene.until(Mode.DISARMED, 4.0)
    assert scene.asked == [Action.ARM, Action.TAKE_OFF, Action.LAND]
    assert scene.sent[-1] is None


@scenario
def taking_off_is_shown_long_or_twice(rules: Rules) -> None:
    scene = grounded(rules)
    assert scene.turn(Command.TAKE_OFF, held_s=1.0).reason == "take_off: show it again to confirm"
    assert scene.mode is Mode.DISARMED
    scene.turns(LIMITS.confirm_within_s + 0.5)
    assert scene.turn(Command.TAKE_OFF, held_s=1.0).mode is Mode.DISARMED, "too late to confirm"
    scene.turns(2.0)
    assert scene.turn(Command.TAKE_OFF, held_s=1.0).mode is Mode.ARMING
    assert scene.asked == [Action.ARM]


@scenario
def a_landing_shown_briefly_holds_and_shown_twice_lands(rules: Rules) -> None:
    scene = flying(rules)
    verdict = scene.turn(Command.LAND, held_s=0.4)
    assert (verdict.mode, verdict.action, verdict.accepted) == (Mode.HOLDING, Action.HOLD, None)
    assert scene.sent[-1] == HOVER
    scene.turns(2.0)
    assert scene.turn(Command.LAND, held_s=0.4).mode is Mode.LANDING


@scenario
def a_vehicle_that_does_not_arm_is_let_be(rules: Rules) -> None:
    scene = grounded(rules)
    scene.obeys = False
    scene.turn(Command.TAKE_OFF)
    passed_s = scene.until(Mode.DISARMED, LIMITS.arming_s + 0.1)
    assert passed_s > LIMITS.arming_s - 0.1
    assert scene.asked == [Action.ARM]


@scenario
def a_take_off_that_gets_nowhere_is_broken_off(rules: Rules) -> None:
    scene = grounded(rules)
    scene.turn(Command.TAKE_OFF)
    scene.until(Mode.TAKING_OFF, 1.0)
    scene.obeys = False
    scene._due = None
    scene.until(Mode.LANDING, LIMITS.take_off_s + 0.1)
    assert scene.asked[-1] is Action.LAND


@scenario
def stop_and_land_before_the_take_off_call_it_off(rules: Rules) -> None:
    for command in (Command.STOP, Command.LAND):
        scene = grounded(rules)
        scene.turn(Command.TAKE_OFF)
        assert scene.turn(command).mode is Mode.READY
        scene.turns(3.0)
        assert scene.mode is Mode.DISARMED
        assert Action.TAKE_OFF not in scene.asked


@scenario
def armed_by_somebody_else_it_waits_for_a_confirmed_take_off(rules: Rules) -> None:
    scene = grounded(rules)
    scene.craft = Craft.ARMED
    scene.turns(3.0)
    assert scene.mode is Mode.READY and scene.asked == []
    assert scene.turn(Command.TAKE_OFF, held_s=0.5).mode is Mode.READY
    assert scene.turn(Command.STOP).action is Action.LAND
    scene.turns(2.0)
    scene.craft, scene._due = Craft.ARMED, None
    scene.turns(1.0)
    assert scene.turn(Command.TAKE_OFF).action is Action.TAKE_OFF
    assert scene.mode is Mode.TAKING_OFF
    assert Action.ARM not in scene.asked


@scenario
def landed_by_itself_it_is_on_the_ground(rules: Rules) -> None:
    for craft, mode in ((Craft.DOWN, Mode.DISARMED), (Craft.ARMED, Mode.READY)):
        scene = flying(rules)
        scene.craft = craft
        assert scene.turn().mode is mode
        assert scene.sent[-1] is None


@scenario
def found_in_the_air_it_holds_and_waits_for_a_command(rules: Rules) -> None:
    scene = grounded(rules)
    scene.craft = Craft.AIRBORNE
    assert scene.turn().mode is Mode.HOLDING
    scene.turns(2.0)
    assert scene.sent[-1] == Setpoint((0.0, 0.0, 0.0), WISH.yaw_rate_rad_s)
    assert scene.asked == []


@scenario
def found_in_the_air_with_nobody_in_view_it_has_its_time(rules: Rules) -> None:
    scene = grounded(rules)
    scene.stick("pose_ns")
    scene.turns(60.0)
    scene.craft = Craft.AIRBORNE
    scene.turns(LIMITS.land_when_lost_s - 1.0)
    assert scene.mode is Mode.HOLDING
    scene.until(Mode.LANDING, 1.5)


@scenario
def refused_to_land_it_is_asked_again(rules: Rules) -> None:
    for mode in (Mode.LANDING, Mode.EMERGENCY):
        scene = flying(rules)
        scene.obeys = False
        scene.known["battery"] = 0.05 if mode is Mode.EMERGENCY else 0.2
        scene.turns(5.0)
        assert scene.mode is mode
        assert 4 <= scene.asked.count(Action.LAND) <= 6


# --- commands -------------------------------------------------------------------------------------------


@scenario
def commands_come_once_a_second_and_after_rest(rules: Rules) -> None:
    scene = flying(rules)
    assert scene.turn(Command.LEFT).accepted is Command.LEFT
    assert scene.turn(Command.RIGHT).accepted is None
    scene.turns(0.8)
    assert "just before" in scene.turn(Command.RIGHT).reason
    scene.turns(0.3)
    assert scene.turn(Command.RIGHT).accepted is Command.RIGHT
    scene.stick("rested_ns")
    scene.turns(5.0)
    scene.ages["rested_ns"] = 6.0
    assert "lower your arms" in scene.turn(Command.LEFT).reason
    assert scene.turn(Command.STOP).accepted is Command.STOP, "stop needs no rest"


@scenario
def whoever_has_just_become_the_operator_commands_nothing_yet(rules: Rules) -> None:
    for age in (None, 0.5):
        scene = flying(rules)
        scene.ages["engaged_ns"] = age
        assert "nobody has been the operator" in scene.turn(Command.LEFT).reason
        assert scene.turn(Command.STOP).mode is Mode.HOLDING, "stop is anybody's"


@scenario
def unseen_or_far_away_nobody_moves_it(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.HOLDING)
    scene.stick("pose_ns")
    scene.turns(1.0)
    assert "not seen" in scene.turn(Command.LEFT).reason
    scene.free("pose_ns")
    scene.known["distance_m"] = 8.2
    scene.turn()
    assert "too far" in scene.turn(Command.LEFT).reason
    scene.known["distance_m"] = 4.0
    assert scene.turn(Command.LEFT).mode is Mode.EXECUTING


@scenario
def without_a_fresh_state_or_link_nobody_moves_it(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.HOLDING)
    assert scene.sent[-1] == Setpoint((0.0, 0.0, 0.0), WISH.yaw_rate_rad_s), "it turns to the operator"
    scene.stick("state_ns")
    scene.turns(1.0)
    assert scene.sent[-1] is None, "by an old heading it does not even turn"
    assert "state is old" in scene.turn(Command.LEFT).reason
    assert scene.mode is Mode.HOLDING
    scene.free("state_ns")
    scene.turn()
    assert scene.turn(Command.LEFT).mode is Mode.EXECUTING
    ground = grounded(rules)
    ground.stick("link_ns")
    ground.turns(2.0)
    assert "out of touch" in ground.turn(Command.TAKE_OFF).reason


@scenario
def no_take_off_but_in_order(rules: Rules) -> None:
    for name, value, says in (
        ("battery", 0.2, "battery"), ("healthy", False, "checks"), ("distance_m", 1.5, "too near"),
        ("position_m", (31.0, 0.0, 0.0), "outside the fence"), ("distance_m", None, "not seen"),
        ("distance_m", 9.0, "too far"),
    ):  # fmt: skip
        scene = grounded(rules)
        scene.known[name] = value
        scene.turns(0.5)
        assert says in scene.turn(Command.TAKE_OFF).reason
        assert scene.asked == []
    for name, says in (("state_ns", "state is old"), ("link_ns", "out of touch"), ("pose_ns", "not seen")):
        scene = grounded(rules)
        scene.stick(name)
        scene.turns(2.0)
        assert says in scene.turn(Command.TAKE_OFF).reason
        assert scene.asked == []
    scene = grounded(rules)
    scene.ages["deaf_ns"] = 1.0
    scene.turn()
    assert "recogniser" in scene.turn(Command.TAKE_OFF).reason
    assert scene.asked == []


# --- stop -----------------------------------------------------------------------------------------------


@scenario
def stop_holds_from_every_mode_in_the_air(rules: Rules) -> None:
    for mode in (
        Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON, Mode.LOST_LINK, Mode.LANDING,
        Mode.EMERGENCY, Mode.FAILSAFE,
    ):  # fmt: skip
        scene = flying(rules, mode=mode)
        airborne = scene.craft is Craft.AIRBORNE
        verdict = scene.turn(Command.STOP)
        assert (verdict.mode, verdict.action) == (Mode.HOLDING, Action.HOLD)
        assert scene.sent[-1] == (HOVER if airborne else None)
        assert scene.turn().mode in (Mode.HOLDING, Mode.LOST_LINK)
        assert scene.sent[-1] is None


@scenario
def land_lands_from_every_mode_in_the_air(rules: Rules) -> None:
    for mode in (
        Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON, Mode.LOST_LINK, Mode.FAILSAFE
    ):  # fmt: skip
        scene = flying(rules, mode=mode)
        verdict = scene.turn(Command.LAND)
        assert (verdict.mode, verdict.action) == (Mode.LANDING, Action.LAND)
        assert scene.sent[-1] is None


@scenario
def after_a_stop_nothing_moves_until_a_command(rules: Rules) -> None:
    scene = flying(rules)
    scene.turn(Command.STOP)
    scene.turns(1.9)
    assert scene.sent[-50:] == [None] * 50
    scene.turns(5.0)
    assert set(scene.sent[-100:]) == {Setpoint((0.0, 0.0, 0.0), WISH.yaw_rate_rad_s)}
    assert scene.turn(Command.CLOSER).mode is Mode.EXECUTING
    assert scene.sent[-1] == WISH


@scenario
def stop_during_the_take_off_holds(rules: Rules) -> None:
    scene = grounded(rules)
    scene.turn(Command.TAKE_OFF)
    scene.until(Mode.TAKING_OFF, 1.0)
    scene.turns(1.0)
    assert scene.craft is Craft.CLIMBING
    assert scene.turn(Command.STOP).mode is Mode.HOLDING
    assert scene.asked[-1] is Action.HOLD


@scenario
def a_landing_nobody_asked_for_goes_on_after_a_stop(rules: Rules) -> None:
    for battery, mode in ((0.2, Mode.LANDING), (0.05, Mode.EMERGENCY)):
        scene = flying(rules)
        scene.known["battery"] = battery
        assert scene.turn().mode is mode
        scene.turns(0.5)
        assert scene.turn(Command.STOP).mode is Mode.HOLDING
        scene.turns(LIMITS.respite_s - 0.3)
        assert scene.mode is Mode.HOLDING
        scene.until(mode, 0.5)
    scene = flying(rules, mode=Mode.LANDING)
    scene.turn(Command.STOP)
    scene.turns(20.0)
    assert scene.mode is Mode.HOLDING, "one that the operator asked for does not"


# --- the person -----------------------------------------------------------------------------------------


@scenario
def a_lost_person_stops_it_then_it_goes_on_or_lands(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING):
        scene = flying(rules, mode=mode)
        scene.stick("pose_ns")
        passed_s = scene.until(Mode.LOST_PERSON, LIMITS.max_pose_age_s + 0.1)
        assert passed_s > LIMITS.max_pose_age_s - 0.1
        assert scene.sent[-1] == HOVER and scene.asked in ([], [Action.HOLD])
        scene.turns(2.0)
        assert scene.sent[-1] == HOVER
        scene.free("pose_ns")
        assert scene.turn().mode is Mode.FOLLOWING
    scene.known["moving"] = False
    scene.stick("pose_ns")
    scene.until(Mode.LOST_PERSON, 1.0)
    scene.turns(LIMITS.land_when_lost_s - 1.0)
    assert scene.mode is Mode.LOST_PERSON
    scene.until(Mode.LANDING, 1.5)
    assert scene.asked[-1] is Action.LAND


@scenario
def nobody_in_view_of_a_holding_drone_for_long_lands_it(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.HOLDING)
    scene.stick("pose_ns")
    scene.turns(LIMITS.land_when_lost_s - 1.0)
    assert scene.mode is Mode.HOLDING
    assert scene.sent[-1] is None
    scene.until(Mode.LANDING, 2.0)


@scenario
def a_camera_without_news_lands_it_sooner(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.HOLDING):
        scene = flying(rules, mode=mode)
        scene.stick("pose_ns", "camera_ns")
        scene.turns(LIMITS.land_when_blind_s - 1.0)
        assert scene.mode in (Mode.LOST_PERSON, Mode.HOLDING)
        scene.until(Mode.LANDING, 2.0)


@scenario
def somebody_else_is_not_followed(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON):
        scene = flying(rules, mode=mode)
        scene.free("pose_ns")
        scene.known["person"] = 1
        assert scene.turn().mode is Mode.HOLDING
        assert scene.asked[-1] is Action.HOLD
        scene.turns(2.0)
        assert scene.mode is Mode.HOLDING
        assert scene.turn(Command.LEFT).mode is Mode.EXECUTING
        assert scene.turn().mode is Mode.EXECUTING, "the new operator it is"


@scenario
def too_far_away_is_lost_and_back_is_well_back(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING):
        scene = flying(rules, mode=mode)
        scene.known["distance_m"] = 8.1
        assert scene.turn().mode is Mode.LOST_PERSON
        assert scene.sent[-1] == HOVER
        scene.known["distance_m"] = 7.8
        assert scene.turn().mode is Mode.LOST_PERSON
        scene.known["distance_m"] = 7.4
        assert scene.turn().mode is Mode.FOLLOWING


@scenario
def too_close_it_retreats_straight(rules: Rules) -> None:
    scene = flying(rules)
    for bearing in (-0.4, 0.0, 0.3):
        scene.known.update(distance_m=1.7, bearing_rad=bearing)
        scene.wish = Setpoint((1.0, 0.6, 0.1), 0.2)
        scene.turn()
        forward, left, up = sent(scene).velocity_m_s
        assert math.isclose(forward * math.cos(bearing) + left * math.sin(bearing), -LIMITS.retreat_m_s)
        assert math.isclose(-forward * math.sin(bearing) + left * math.cos(bearing), 0.0, abs_tol=1e-9)
        assert up == 0.1
        scene.wish = Setpoint((-1.2, 0.0, 0.0))
        scene.known["bearing_rad"] = 0.0
        scene.turn()
        assert sent(scene).velocity_m_s[0] == -1.2, "faster away is fine"
    holding = flying(rules, mode=Mode.HOLDING)
    holding.known["distance_m"] = 1.7
    holding.turn()
    assert sent(holding).velocity_m_s[0] == -LIMITS.retreat_m_s


@scenario
def it_brakes_before_the_nearest_and_the_farthest(rules: Rules) -> None:
    scene = flying(rules)
    scene.wish = Setpoint((1.4, 0.0, 0.0))
    for distance, most in ((2.0, 0.0), (2.5, 0.4), (3.0, 0.8), (4.0, 1.4)):
        scene.known["distance_m"] = distance
        scene.turn()
        assert math.isclose(sent(scene).velocity_m_s[0], most, abs_tol=1e-9)
    scene.wish = Setpoint((-1.4, 0.0, 0.0))
    for distance, most in ((7.9, 0.08), (7.0, 0.8), (5.0, 1.4)):
        scene.known["distance_m"] = distance
        scene.turn()
        assert math.isclose(sent(scene).velocity_m_s[0], -most, abs_tol=1e-9)


# --- limits of place and motion ---------------------------------------------------------------------------


@scenario
def no_setpoint_is_faster_than_allowed(rules: Rules) -> None:
    scene = flying(rules)
    scene.known["bearing_rad"] = math.pi
    scene.wish = Setpoint((3.0, 4.0, 0.0), 0.0)
    scene.turn()
    assert math.isclose(math.hypot(*sent(scene).velocity_m_s[:2]), LIMITS.max_speed_m_s)
    assert math.isclose(sent(scene).velocity_m_s[0], 0.6 * LIMITS.max_speed_m_s)
    scene.wish = Setpoint((1.3e308, 1.3e308, 0.0), 0.0)
    scene.turn()
    assert math.hypot(*sent(scene).velocity_m_s[:2]) <= LIMITS.max_speed_m_s
    for up in (-5.0, 5.0):
        scene.wish = Setpoint((0.0, 0.0, up), 0.0)
        scene.turn()
        assert abs(sent(scene).velocity_m_s[2]) <= LIMITS.max_climb_m_s
    for rate in (-9.0, 9.0):
        scene.wish = Setpoint((0.0, 0.0, 0.0), rate)
        scene.turn()
        assert sent(scene).yaw_rate_rad_s == math.copysign(LIMITS.max_yaw_rate_rad_s, rate)


@scenario
def what_is_no_number_is_standing_still(rules: Rules) -> None:
    scene = flying(rules)
    for wish in (
        Setpoint((math.nan, 0.0, 0.0)), Setpoint((0.0, -math.inf, 0.0)), Setpoint((0.0, 0.0, math.nan)),
        Setpoint((0.5, 0.0, 0.0), math.nan),
    ):  # fmt: skip
        scene.wish = wish
        scene.turn()
        assert scene.sent[-1] == HOVER


@scenario
def floor_and_ceiling_are_not_passed(rules: Rules) -> None:
    scene = flying(rules)
    scene.wish = Setpoint((0.0, 0.0, -0.6))
    for height, most in ((0.4, 0.0), (0.6, 0.0), (0.85, 0.2), (2.0, 0.6)):
        scene.known["position_m"] = (0.0, 0.0, height)
        scene.turn()
        assert math.isclose(sent(scene).velocity_m_s[2], -most, abs_tol=1e-9)
    scene.wish = Setpoint((0.0, 0.0, 0.6))
    for height, most in ((4.2, 0.0), (4.0, 0.0), (3.75, 0.2), (2.0, 0.6)):
        scene.known["position_m"] = (0.0, 0.0, height)
        scene.turn()
        assert math.isclose(sent(scene).velocity_m_s[2], most, abs_tol=1e-9)


@scenario
def the_fence_is_not_passed_not_even_to_retreat(rules: Rules) -> None:
    square = Polygon(((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)))
    for fence, east in ((Cylinder(5.0), 4.75), (square, 4.75)):
        scene = flying(rules, SupervisorConfig(fence=fence))
        scene.known.update(position_m=(east, 0.0, 1.5), heading_rad=math.pi / 2)
        scene.wish = Setpoint((0.3, -1.0, 0.0))  # north, and east to the wall
        scene.turn()
        forward, left, _ = sent(scene).velocity_m_s
        assert math.isclose(left, -0.2, abs_tol=1e-9) and math.isclose(forward, 0.3, abs_tol=1e-9)
        scene.known.update(position_m=(5.5, 0.0, 1.5), distance_m=1.0, bearing_rad=math.pi / 2)
        scene.turn()
        assert abs(sent(scene).velocity_m_s[1]) < 1e-9, "a retreat would lead out"
        scene.known.update(distance_m=4.0)
        scene.wish = Setpoint((0.0, 1.0, 0.0))
        scene.turn()
        assert sent(scene).velocity_m_s[1] == 1.0, "inwards it may"


@scenario
def between_the_fence_and_the_operator_it_stands_still(rules: Rules) -> None:
    for out_rad in (1.9, -1.9):
        # The drone is at the edge; along it, it would slide past the operator, and nearer than it may.
        edge = Cylinder(5.0, (-5.0 * math.cos(out_rad), -5.0 * math.sin(out_rad)))
        scene = flying(rules, SupervisorConfig(fence=edge))
        scene.known.update(distance_m=2.1)
        scene.wish = Setpoint((0.0, math.copysign(1.0, out_rad), 0.2), 0.1)
        scene.turn()
        assert sent(scene) == Setpoint((0.0, 0.0, 0.2), 0.1)


@scenario
def far_outside_or_above_it_lands(rules: Rules) -> None:
    for place in ((33.0, 0.0, 1.5), (0.0, 0.0, 6.5)):
        for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON):
            scene = flying(rules, mode=mode)
            scene.known["position_m"] = place
            assert scene.turn().mode is Mode.EMERGENCY
            assert scene.asked[-1] is Action.LAND


# --- the vehicle ------------------------------------------------------------------------------------------


@scenario
def a_stale_state_holds_then_lands(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON):
        scene = flying(rules, mode=mode)
        scene.stick("state_ns")
        passed_s = scene.until(Mode.HOLDING, LIMITS.max_state_age_s + 0.1)
        assert passed_s > LIMITS.max_state_age_s - 0.1
        assert scene.asked[-1] is Action.HOLD and scene.sent[-1] == HOVER
        scene.turns(1.0)
        assert scene.sent[-1] is None, "the vehicle holds by itself"
        scene.until(Mode.EMERGENCY, LIMITS.land_without_state_s)
        assert scene.asked[-1] is Action.LAND


@scenario
def out_of_touch_it_is_asked_to_hold_and_left_alone(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON):
        scene = flying(rules, mode=mode)
        scene.stick("link_ns")
        scene.until(Mode.LOST_LINK, LIMITS.max_link_age_s + 0.1)
        assert scene.asked[-1] is Action.HOLD
        scene.turns(1.0)
        assert scene.sent[-20:] == [None] * 20
        scene.free("link_ns")
        scene.free("pose_ns")
        assert scene.turn().mode is Mode.HOLDING
        assert scene.turn(Command.LEFT).mode is Mode.EXECUTING
    scene.stick("link_ns")
    scene.until(Mode.LANDING, LIMITS.land_without_link_s + LIMITS.max_link_age_s + 0.2)


@scenario
def a_link_without_a_fresh_state_is_not_in_touch(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.LOST_LINK)
    scene.free("link_ns")
    scene.turns(0.5)
    assert scene.mode is Mode.LOST_LINK
    scene.free("state_ns")
    assert scene.turn().mode is Mode.HOLDING


@scenario
def a_low_battery_lands_and_a_critical_one_for_good(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON):
        scene = flying(rules, mode=mode)
        scene.known["battery"] = 0.24
        scene.turns(4.0)
        assert Mode.LANDING is scene.mode or scene.mode is Mode.DISARMED
        assert scene.asked[-1] is Action.LAND
    scene = flying(rules, mode=Mode.LANDING)
    scene.known["battery"] = 0.1
    assert scene.turn().mode is Mode.EMERGENCY
    scene = flying(rules, mode=Mode.LOST_LINK)
    scene.known["battery"] = 0.1
    assert scene.turn().mode is Mode.EMERGENCY


@scenario
def a_vehicle_that_complains_is_landed_but_not_for_a_moment(rules: Rules) -> None:
    scene = flying(rules)
    scene.known["healthy"] = False
    scene.turns(LIMITS.max_ill_s - 0.2)
    assert scene.mode is Mode.FOLLOWING
    scene.known["healthy"] = True
    scene.turns(0.5)
    scene.known["healthy"] = False
    scene.until(Mode.LANDING, LIMITS.max_ill_s + 0.2)
    assert scene.asked[-1] is Action.LAND


@scenario
def a_pilot_is_never_fought(rules: Rules) -> None:
    for mode in (
        Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON, Mode.LOST_LINK, Mode.LANDING,
        Mode.EMERGENCY, Mode.FAILSAFE,
    ):  # fmt: skip
        scene = flying(rules, mode=mode)
        scene.craft, scene._due, asked = Craft.PILOTED, None, list(scene.asked)
        scene.known["battery"] = 0.05
        for command in (None, Command.STOP, Command.LAND, Command.LEFT, Command.TAKE_OFF):
            assert scene.turn(command).mode is Mode.PILOT
            scene.turns(2.0)
        assert scene.asked == asked and scene.sent[-1] is None
    scene.known["battery"] = 0.8
    scene.free("state_ns", "link_ns")
    scene.craft = Craft.AIRBORNE
    assert scene.turn().mode is Mode.HOLDING, "given back, it waits for a command"
    scene.craft = Craft.PILOTED
    scene.turn()
    scene.craft = Craft.ARMED
    assert scene.turn().mode is Mode.READY
    scene.craft = Craft.PILOTED
    scene.turn()
    scene.craft = Craft.DOWN
    assert scene.turn().mode is Mode.DISARMED


@scenario
def a_failsafe_of_the_autopilot_is_not_fought(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.HOLDING, Mode.LOST_PERSON, Mode.LOST_LINK):
        scene = flying(rules, mode=mode)
        scene.craft = Craft.OWN
        scene.turns(1.2)
        assert scene.mode is Mode.FAILSAFE
        asked = list(scene.asked)
        scene.turns(10.0)
        assert scene.asked == asked and scene.sent[-1] is None
        scene.free("state_ns", "link_ns", "pose_ns")
        scene.craft = Craft.AIRBORNE
        assert scene.turn().mode is Mode.HOLDING
    scene = flying(rules, mode=Mode.FAILSAFE)
    scene.obeys = False
    assert scene.turn(Command.LAND).mode is Mode.LANDING
    scene.turns(0.5)
    assert scene.mode is Mode.LANDING, "the request gets a moment"
    scene.until(Mode.FAILSAFE, 1.0)
    scene.turns(1.2)
    scene.craft = Craft.ARMED
    assert scene.turn().mode is Mode.READY


# --- the program itself -----------------------------------------------------------------------------------


@scenario
def a_loop_that_hung_holds(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON):
        for passed_s in (2.0, -3.0):
            scene = flying(rules, mode=mode)
            assert scene.turn(passed_s=passed_s).mode is Mode.HOLDING
            assert scene.asked[-1] is Action.HOLD and scene.sent[-1] == HOVER
            scene.turns(3.0)
            assert scene.mode is Mode.HOLDING
    scene = grounded(rules)
    scene.turn(Command.TAKE_OFF)
    assert scene.turn(passed_s=2.0).mode is Mode.READY
    assert Action.TAKE_OFF not in scene.asked


@scenario
def a_clock_set_back_makes_no_state_older_than_it_is(rules: Rules) -> None:
    scene = flying(rules)
    scene.turn(passed_s=-50.0)
    scene.turns(3.0)
    assert scene.mode is Mode.HOLDING, "not landing: everything is fresh"
    scene.ages["state_ns"] = -20.0  # a vehicle whose stamps are still those of before
    scene.turns(1.0)
    assert scene.turn(Command.LEFT).accepted is None
    scene.until(Mode.EMERGENCY, LIMITS.land_without_state_s + 0.2)


@scenario
def a_recogniser_that_fails_holds_then_lands(rules: Rules) -> None:
    for mode in (Mode.FOLLOWING, Mode.EXECUTING, Mode.LOST_PERSON):
        scene = flying(rules, mode=mode)
        scene.ages["deaf_ns"] = 0.0
        scene.stick("deaf_ns")
        assert scene.turn().mode is Mode.HOLDING
        assert scene.asked[-1] is Action.HOLD
        if mode is not Mode.LOST_PERSON:
            scene.turns(LIMITS.land_when_deaf_s - 1.0)
            assert scene.mode is Mode.HOLDING
            scene.until(Mode.LANDING, 1.5)
    scene = flying(rules)
    scene.ages["deaf_ns"] = 0.0
    scene.turn()
    scene.ages["deaf_ns"] = None
    scene.turns(LIMITS.land_when_deaf_s + 1.0)
    assert scene.mode is Mode.HOLDING, "it works again: a command goes on"


@scenario
def a_movement_that_never_ends_is_broken_off(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.EXECUTING)
    scene.turns(LIMITS.executing_s - 2.0)
    assert scene.mode is Mode.EXECUTING
    scene.until(Mode.HOLDING, 3.0)


@scenario
def another_command_replaces_the_one_under_way_and_its_time(rules: Rules) -> None:
    scene = flying(rules, mode=Mode.EXECUTING)
    scene.turns(LIMITS.executing_s - 5.0)
    assert scene.turn(Command.ORBIT).accepted is Command.ORBIT
    scene.turns(10.0)
    assert scene.mode is Mode.EXECUTING


@scenario
def trouble_during_the_take_off(rules: Rules) -> None:
    for name, value, mode in (
        ("battery", 0.2, Mode.LANDING), ("battery", 0.05, Mode.EMERGENCY), ("healthy", False, Mode.LANDING),
        ("position_m", (40.0, 0.0, 1.0), Mode.EMERGENCY),
    ):  # fmt: skip
        scene = climbing(rules)
        scene.known[name] = value
        scene.until(mode, LIMITS.max_ill_s + 0.2)
    for stamp, mode in (("state_ns", Mode.HOLDING), ("link_ns", Mode.LOST_LINK)):
        scene = climbing(rules)
        scene.stick(stamp)
        scene.until(mode, 1.2)
    scene = climbing(rules)
    scene.ages["deaf_ns"] = 0.0
    assert scene.turn().mode is Mode.HOLDING
    assert climbing(rules).turn(passed_s=3.0).mode is Mode.HOLDING
    scene = climbing(rules)
    scene.craft = Craft.OWN
    scene.until(Mode.FAILSAFE, 1.5)
    scene = climbing(rules)
    scene.craft = Craft.PILOTED
    assert scene.turn().mode is Mode.PILOT


@scenario
def what_the_console_holds_no_gesture_moves(rules: Rules) -> None:
    scene = grounded(rules)
    scene.known["withheld"] = True
    assert "held at the console" in scene.turn(Command.TAKE_OFF).reason and scene.mode is Mode.DISARMED
    scene = flying(rules, mode=Mode.HOLDING)
    scene.known["withheld"] = True
    assert "held at the console" in scene.turn(Command.CLOSER).reason and scene.mode is Mode.HOLDING
    scene.known["withheld"] = False
    assert scene.turn(Command.CLOSER).accepted is Command.CLOSER
    scene.known["withheld"] = True
    assert scene.turn(Command.LAND).action is Action.LAND, "land and stop pass whoever holds it"


def climbing(rules: Rules) -> Scene:
    scene = grounded(rules)
    scene.turn(Command.TAKE_OFF)
    scene.until(Mode.TAKING_OFF, 1.0)
    scene.turns(0.5)
    assert scene.craft is Craft.CLIMBING
    scene._due = None
    return scene


def sent(scene: Scene) -> Setpoint:
    setpoint = scene.sent[-1]
    assert setpoint is not None
    return setpoint


__all__ = ["SCENARIOS", "replace"]
