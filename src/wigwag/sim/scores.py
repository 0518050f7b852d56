"""The score of every gesture: its key poses, for an average person.

Ten commands after marshalling signals (ICAO Annex 2, NATOPS, UAV-GESTURE) and everyday movements that are
no command. The commands keep to the body's frontal plane, where a camera sees them best, and off the hips,
whose depth the drone follows; ``farther`` alone goes to the front. All use both arms, or the side that
names the command, and what goes to and fro is done twice. They last about two seconds, and begin and end
with hanging arms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from wigwag.fly.values import Command
from wigwag.sim.person import Side


@dataclass(frozen=True, slots=True)
class Key:
    """One key pose: which channels arrive where. A channel that is not named passes through."""

    after_s: float
    """Seconds since the key before, for a person of tempo 1."""
    to: dict[str, float]
    """Values in degrees (angles) or centimetres (pelvis and feet) by channel; empty: back to rest."""


Score = Callable[[Side], Sequence[Key]]
"""A gesture as key poses, given the hand it is shown with (commands are the same for either hand)."""


def _both(**values: float) -> dict[str, float]:
    """Set a channel of both arms or feet."""
    return {f"{side}_{name}": value for side in ("left", "right") for name, value in values.items()}


def _one(side: Side, **values: float) -> dict[str, float]:
    """Set channels of one arm or foot."""
    return {f"{side}_{name}": value for name, value in values.items()}


both_sides, one_side = _both, _one
"""The same for other files of scores."""


def other_side(side: Side) -> Side:
    """Return the other hand."""
    return "left" if side == "right" else "right"


REST: dict[str, float] = {}


def _take_off(_: Side) -> list[Key]:
    """Hands to the shoulders, then both are thrust overhead twice."""
    cocked = _both(**{"raise": 38, "forward": 5, "bend": 140, "roll": -62})
    thrust = _both(**{"raise": 166, "forward": 5, "bend": 12, "roll": -60})
    return [
        Key(0.42, cocked), Key(0.37, {**thrust, "pelvis_down": -1.0}), Key(0.35, cocked),
        Key(0.37, {**thrust, "pelvis_down": -1.0}), Key(0.30, cocked), Key(0.42, REST),
    ]  # fmt: skip


def _land(_: Side) -> list[Key]:
    """Arms level to the sides, then they sink while the knees bend, and the person rises again."""
    level = _both(**{"raise": 88, "forward": 5, "bend": 8, "roll": 0})
    sunk = _both(**{"raise": 42, "forward": 10, "bend": 12, "roll": 0})
    squat = {"pelvis_down": 24.0, "pelvis_forward": -9.0, "lean_forward": 20.0}
    return [Key(0.5, level), Key(0.6, {**sunk, **squat}), Key(0.62, REST)]


def _stop(_: Side) -> list[Key]:
    """Arms overhead, wrists crossed and opened twice (ICAO: stop)."""
    opened = _both(**{"raise": 134, "bend": 14, "roll": -88}) | {"left_forward": 0, "right_forward": 14}
    crossed = _both(**{"raise": 168, "bend": 74, "roll": -88}) | {"left_forward": -4, "right_forward": 16}
    return [
        Key(0.52, opened), Key(0.31, crossed), Key(0.30, opened), Key(0.31, crossed), Key(0.28, opened),
        Key(0.56, REST),
    ]  # fmt: skip


def _push(side: Side) -> list[Key]:
    """One hand pushes twice from the shoulder out to the side, the trunk leaning along."""
    sign = 1 if side == "left" else -1
    cocked = _one(side, **{"raise": 72, "forward": 12, "bend": 138, "roll": -58})
    pushed = _one(side, **{"raise": 90, "forward": 4, "bend": 6, "roll": -50})
    lean = {"lean_left": 9.0 * sign, "pelvis_left": 4.0 * sign}
    back = {"lean_left": 1.0 * sign, "pelvis_left": 1.0 * sign}
    return [
        Key(0.42, cocked), Key(0.37, {**pushed, **lean}), Key(0.35, {**cocked, **back}),
        Key(0.37, {**pushed, **lean}), Key(0.52, REST),
    ]  # fmt: skip


def _left(_: Side) -> list[Key]:
    """Push to the operator's left with the left hand."""
    return _push("left")


def _right(_: Side) -> list[Key]:
    """Push to the operator's right with the right hand."""
    return _push("right")


def _up(_: Side) -> list[Key]:
    """Straight arms beat twice from level to high (ICAO: move upwards)."""
    low = _both(**{"raise": 78, "forward": 4, "bend": 6, "roll": 0})
    high = _both(**{"raise": 142, "forward": 4, "bend": 6, "roll": 0})
    return [Key(0.45, low), Key(0.36, high), Key(0.35, low), Key(0.36, high), Key(0.62, REST)]


def _down(_: Side) -> list[Key]:
    """Straight arms beat twice from level down (ICAO: move downwards)."""
    high = _both(**{"raise": 100, "forward": 4, "bend": 6, "roll": 0})
    low = _both(**{"raise": 38, "forward": 4, "bend": 6, "roll": 0})
    return [Key(0.5, high), Key(0.34, low), Key(0.34, high), Key(0.34, low), Key(0.36, REST)]


def _closer(_: Side) -> list[Key]:
    """Level arms, forearms drawn up to the head twice, palms to oneself: come."""
    spread = _both(**{"raise": 86, "forward": 6, "bend": 10, "roll": -85})
    curled = _both(**{"raise": 92, "forward": 6, "bend": 128, "roll": -85})
    return [Key(0.46, spread), Key(0.37, curled), Key(0.36, spread), Key(0.37, curled), Key(0.55, REST)]


def _farther(_: Side) -> list[Key]:
    """Arms swept forward and up to the chest's height twice, palms ahead (ICAO: move back)."""
    swept = _both(**{"raise": 74, "forward": 66, "bend": 16, "roll": -20})
    drawn = _both(**{"raise": 22, "forward": 60, "bend": 30, "roll": -10})
    return [
        Key(0.46, {**swept, "lean_forward": 3.0}), Key(0.36, {**drawn, "lean_forward": 0.0}),
        Key(0.38, {**swept, "lean_forward": 3.0}), Key(0.5, REST),
    ]  # fmt: skip


def _orbit(_: Side) -> list[Key]:
    """Arms spread like wings, banked to one side and the other, and once more."""

    def bank(sign: int) -> dict[str, float]:
        return {
            "left_raise": 88 - 38 * sign, "right_raise": 88 + 38 * sign, "lean_left": 12.0 * sign,
            "pelvis_left": -3.0 * sign, **_both(forward=4, bend=6, roll=0),
        }  # fmt: skip

    return [Key(0.5, bank(1)), Key(0.48, bank(-1)), Key(0.48, bank(1)), Key(0.6, REST)]


COMMAND_SCORES: dict[str, Score] = {
    Command.TAKE_OFF.value: _take_off,
    Command.LAND.value: _land,
    Command.STOP.value: _stop,
    Command.LEFT.value: _left,
    Command.RIGHT.value: _right,
    Command.UP.value: _up,
    Command.DOWN.value: _down,
    Command.CLOSER.value: _closer,
    Command.FARTHER.value: _farther,
    Command.ORBIT.value: _orbit,
}
"""The ten commands by the value of ``Command``."""


def _wave(hand: Side) -> list[Key]:
    """Wave hello beside the head."""
    up = {"raise": 62, "forward": 25, "bend": 112}
    out, back = _one(hand, **up, roll=-95), _one(hand, **up, roll=-50)
    return [Key(0.5, out), Key(0.2, back), Key(0.2, out), Key(0.2, back), Key(0.2, out), Key(0.5, REST)]


def _scratch_head(hand: Side) -> list[Key]:
    """Scratch the top of the head."""
    near = _one(hand, **{"raise": 142, "forward": 9, "bend": 104, "roll": -62})
    far = _one(hand, **{"raise": 132, "forward": 12, "bend": 110, "roll": -64})
    tilt = {"tilt": 7.0 if hand == "left" else -7.0, "nod": 8.0}
    return [Key(0.65, near | tilt), Key(0.2, far), Key(0.2, near), Key(0.2, far), Key(0.2, near),
            Key(0.6, REST)]  # fmt: skip


def _hands_on_hips(_: Side) -> list[Key]:
    """Put the hands on the hips for a moment."""
    akimbo = _both(**{"raise": 66, "forward": -21, "bend": 122, "roll": 71, "shrug": 3})
    return [Key(0.6, akimbo), Key(0.35, {**akimbo, "lean_left": 3.0}), Key(0.6, REST)]


def _look_at_watch(hand: Side) -> list[Key]:
    """Raise the other hand's wrist before the chest and look at it."""
    wrist = _one(other_side(hand), **{"raise": 49, "forward": 63, "bend": 110, "roll": 48})
    return [Key(0.55, wrist | {"nod": 22.0}), Key(0.45, wrist | {"nod": 24.0}), Key(0.55, REST)]


def _bow(_: Side) -> list[Key]:
    """Bow."""
    down = {"lean_forward": 48.0, "pelvis_forward": -12.0, "nod": 6.0, **_both(swing=40.0)}
    return [Key(0.75, down), Key(0.15, down), Key(0.75, REST)]


def _kick(hand: Side) -> list[Key]:
    """Kick a ball that is not there."""
    back = _one(hand, foot_forward=-22, foot_up=14) | {"pelvis_left": 5.0 if hand == "right" else -5.0}
    kick = _one(hand, foot_forward=52, foot_up=34) | {"lean_forward": -8.0}
    arms = _one(other_side(hand), swing=35.0) | _one(hand, swing=-25.0)
    return [Key(0.4, back), Key(0.3, kick | arms | {"pelvis_left": back["pelvis_left"]}), Key(0.55, REST)]


def _shrug(_: Side) -> list[Key]:
    """Shrug: shoulders up, forearms out."""
    up = _both(**{"shrug": 16, "raise": 24, "forward": 10, "bend": 78, "roll": -50}) | {"tilt": 6.0}
    return [Key(0.45, up), Key(0.25, up), Key(0.5, REST)]


def _swing_arms(_: Side) -> list[Key]:
    """Swing both arms loosely to and fro."""
    ahead, behind = _both(swing=42.0, bend=25), _both(swing=-28.0, bend=8)
    return [Key(0.45, ahead), Key(0.45, behind), Key(0.45, ahead), Key(0.5, REST)]


def _point(hand: Side) -> list[Key]:
    """Point at something ahead and to the side, once."""
    arm = _one(hand, **{"raise": 80, "forward": 48, "bend": 10, "roll": 0})
    return [Key(0.5, arm | {"twist": 8.0 if hand == "left" else -8.0}), Key(0.3, arm), Key(0.55, REST)]


def _rub_neck(hand: Side) -> list[Key]:
    """Rub the neck."""
    near = _one(hand, **{"raise": 136, "forward": 30, "bend": 143, "roll": -44})
    far = _one(hand, **{"raise": 118, "forward": 38, "bend": 143, "roll": -33})
    return [Key(0.7, near | {"nod": 14.0}), Key(0.24, far), Key(0.24, near), Key(0.24, far),
            Key(0.6, REST)]  # fmt: skip


def _behind_head(_: Side) -> list[Key]:
    """Clasp the hands behind the head."""
    clasp = _both(**{"raise": 148, "forward": 21, "bend": 125, "roll": -66})
    return [Key(0.7, clasp), Key(0.3, clasp | {"lean_forward": -5.0}), Key(0.7, REST)]


def _rub_hands(_: Side) -> list[Key]:
    """Rub the hands before the belly."""
    one = {"raise": 33, "forward": 24, "bend": 107, "roll": 56}
    two = {"raise": 15, "forward": 54, "bend": 97, "roll": 39}
    here, there = _one("left", **one) | _one("right", **two), _one("left", **two) | _one("right", **one)
    return [Key(0.5, here), Key(0.2, there), Key(0.2, here), Key(0.2, there), Key(0.2, here), Key(0.5, REST)]


def _reach_up(_: Side) -> list[Key]:
    """Stretch upwards after long sitting: both arms up by the front, a lean to one side, down again."""
    up = _both(**{"raise": 164, "forward": 38, "bend": 28, "roll": -70, "shrug": 5})
    return [Key(0.75, up | {"lean_forward": -4.0}), Key(0.4, up | {"lean_left": 10.0}), Key(0.85, REST)]


def _drink(hand: Side) -> list[Key]:
    """Drink from a bottle."""
    mouth = _one(hand, **{"raise": 86, "forward": 72, "bend": 122, "roll": 30})
    return [Key(0.6, mouth), Key(0.4, mouth | {"nod": -18.0}), Key(0.6, REST)]


def _dust_off(_: Side) -> list[Key]:
    """Beat dust off the trousers with both hands."""
    off = {"raise": 36, "forward": 6, "bend": 40, "roll": 20}
    on = {"raise": 28, "forward": 4, "bend": 66, "roll": 66}
    lean = {"lean_forward": 14.0}
    return [Key(0.45, _both(**on) | lean), Key(0.2, _both(**off)), Key(0.2, _both(**on)),
            Key(0.2, _both(**off)), Key(0.2, _both(**on)), Key(0.5, REST)]  # fmt: skip


def _phone(hand: Side) -> list[Key]:
    """Take the phone to the ear."""
    ear = _one(hand, **{"raise": 102, "forward": 44, "bend": 131, "roll": -16})
    tilt = {"tilt": 8.0 if hand == "left" else -8.0}
    return [Key(0.6, ear | tilt), Key(0.5, ear | {"nod": 3.0}), Key(0.6, REST)]


def _adjust_hat(_: Side) -> list[Key]:
    """Set the hat right with both hands."""
    brim = _both(**{"raise": 130, "forward": 17, "bend": 109, "roll": -39})
    tug = _both(**{"raise": 125, "forward": 17, "bend": 116, "roll": -35})
    return [Key(0.6, brim | {"nod": 6.0}), Key(0.25, tug), Key(0.25, brim), Key(0.6, REST)]


def _clap(_: Side) -> list[Key]:
    """Clap three times in front of the chest."""
    apart = _both(**{"raise": 28, "forward": 55, "bend": 110, "roll": 0})
    clap = _both(**{"raise": 39, "forward": 73, "bend": 100, "roll": 31})
    return [Key(0.48, apart), Key(0.15, clap), Key(0.17, apart), Key(0.15, clap), Key(0.17, apart),
            Key(0.15, clap), Key(0.5, REST)]  # fmt: skip


def _arms_crossed(_: Side) -> list[Key]:
    """Fold the arms and let go again."""
    fold = _both(bend=92, roll=80) | {
        "left_raise": 47, "left_forward": 86, "right_raise": 42, "right_forward": 84,
    }  # fmt: skip
    return [Key(0.6, fold), Key(0.4, {**fold, "lean_forward": -2.0}), Key(0.6, REST)]


def _throw(hand: Side) -> list[Key]:
    """Throw a ball overarm, past the camera."""
    sign = 1.0 if hand == "right" else -1.0
    cocked = _one(hand, **{"raise": 96, "forward": -14, "bend": 92, "roll": -88}) | {"twist": -16.0 * sign}
    thrown = _one(hand, **{"raise": 78, "forward": 55, "bend": 20, "roll": -60}) | {"twist": 14.0 * sign}
    return [Key(0.58, cocked), Key(0.36, thrown | {"lean_forward": 10.0}), Key(0.65, REST)]


def _wipe_brow(hand: Side) -> list[Key]:
    """Wipe the forehead with the forearm."""
    start = _one(hand, **{"raise": 123, "forward": 72, "bend": 96, "roll": 40})
    end = _one(hand, **{"raise": 115, "forward": 25, "bend": 112, "roll": -29})
    return [Key(0.58, start | {"nod": 8.0}), Key(0.4, end), Key(0.6, REST)]


def _pick_up(_: Side) -> list[Key]:
    """Bend down to pick something up, knees bent."""
    down = {
        "pelvis_down": 26.0, "pelvis_forward": -16.0, "lean_forward": 58.0, "nod": -10.0,
        **_both(swing=52.0, bend=12),
    }  # fmt: skip
    return [Key(0.85, down), Key(0.12, down), Key(0.85, REST)]


def _stretch(_: Side) -> list[Key]:
    """Stretch: elbows drawn back at the shoulders' height, chest out, trunk turned to and fro."""
    wide = _both(**{"raise": 82, "forward": -12, "bend": 122, "roll": 10, "shrug": 4})
    return [Key(0.6, wide | {"lean_forward": -5.0}), Key(0.35, wide | {"twist": 20.0}),
            Key(0.5, wide | {"twist": -20.0}), Key(0.65, REST)]  # fmt: skip


BACKGROUND_SCORES: dict[str, Score] = {
    "wave": _wave, "scratch_head": _scratch_head, "hands_on_hips": _hands_on_hips,
    "look_at_watch": _look_at_watch, "bow": _bow, "kick": _kick, "shrug": _shrug,
    "swing_arms": _swing_arms, "point": _point, "rub_neck": _rub_neck, "behind_head": _behind_head,
    "rub_hands": _rub_hands, "reach_up": _reach_up, "drink": _drink, "dust_off": _dust_off,
}  # fmt: skip
"""Movements that are no command and that training may show as such."""

DISTRACTOR_SCORES: dict[str, Score] = {
    "phone": _phone, "adjust_hat": _adjust_hat, "clap": _clap, "arms_crossed": _arms_crossed,
    "throw": _throw, "wipe_brow": _wipe_brow, "pick_up": _pick_up, "stretch": _stretch,
}  # fmt: skip
"""Movements that are no command and that no training ever sees: what the demo distracts with."""


def _engage(hand: Side) -> list[Key]:
    """Raise one hand high above the head and hold it still; the other hangs."""
    up = _one(hand, **{"raise": 168, "forward": 6, "bend": 14, "roll": -60})
    return [Key(0.7, up), Key(1.9, up), Key(0.7, REST)]


def _disengage(_: Side) -> list[Key]:
    """Raise both hands high above the head and hold them still."""
    up = _both(**{"raise": 166, "forward": 6, "bend": 14, "roll": -60})
    return [Key(0.7, up), Key(2.6, up), Key(0.7, REST)]


ENGAGEMENT_SCORES: dict[str, Score] = {"engage": _engage, "disengage": _disengage}
"""How somebody becomes the operator and ceases to be: held still, which no command and no movement of
everyday life is (``wigwag.pose.engagement``)."""

SCORES: dict[str, Score] = {**COMMAND_SCORES, **BACKGROUND_SCORES, **DISTRACTOR_SCORES}
"""Every gesture by name, but for how one engages."""

COMMANDS = tuple(COMMAND_SCORES)
BACKGROUND = tuple(BACKGROUND_SCORES)
DISTRACTORS = tuple(DISTRACTOR_SCORES)
