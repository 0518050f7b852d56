"""The autopilot's settings that decide what happens when wigwag, the radio or the link fails."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass

_INTEGERS = {1: "<B", 2: "<b", 3: "<H", 4: "<h", 5: "<I", 6: "<i"}
"""MAV_PARAM_TYPE."""

Values = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Advice:
    """What is said about a setting, given all that were read."""

    names: tuple[str, ...]
    """Which settings it looks at; the first that is there counts where one was renamed."""
    say: Callable[[Values], str]
    """Returns the warning, or nothing."""


def decode(value: float, kind: int, bytewise: bool) -> float:
    """Return a parameter's value.

    Args:
        value: ``param_value`` of PARAM_VALUE.
        kind: Its MAV_PARAM_TYPE.
        bytewise: Whether whole numbers are put into the float byte by byte (PX4) or converted (ArduPilot).

    Example:
        >>> decode(7.006492321624085e-45, 6, bytewise=True)
        5.0
    """
    form = _INTEGERS.get(kind)
    if not bytewise or form is None:
        return float(value)
    return float(struct.unpack(form, struct.pack("<f", value)[: struct.calcsize(form)])[0])


_LOSS = {
    0: "Position mode", 1: "Altitude mode", 2: "Manual mode", 3: "Return", 4: "Land", 5: "Hold",
    6: "Terminate", 7: "Disarm",
}  # fmt: skip


def _offboard_loss(v: Values) -> str:
    action = int(v["COM_OBL_RC_ACT"])
    if action == 5:
        return ""
    return (
        f"COM_OBL_RC_ACT is {action} ({_LOSS.get(action, 'unknown')}): when set-points stop, PX4 does that. "
        "Set it to 5 (Hold)."
    )


def _offboard_timeout(v: Values) -> str:
    seconds = v["COM_OF_LOSS_T"]
    if seconds <= 1.0:
        return ""
    return (
        f"COM_OF_LOSS_T is {seconds:g} s: so long PX4 flies on when set-points stop. Set it to 1 s or less."
    )


def _radio_exception(v: Values) -> str:
    if not int(v["COM_RCL_EXCEPT"]) & 4:
        return ""
    return (
        f"COM_RCL_EXCEPT is {int(v['COM_RCL_EXCEPT'])}: a lost radio is ignored in Offboard, and with it the "
        "pilot who should take over. Clear bit 2 if a pilot stands by with a radio."
    )


def _px4_return(v: Values) -> str:
    height = v["RTL_RETURN_ALT"]
    reasons = [name for name in ("NAV_DLL_ACT", "NAV_RCL_ACT") if int(v.get(name, 0)) == 2]
    if not reasons:
        return ""
    return (
        f"{' and '.join(reasons)} = 2 (Return): when the ground station or radio is lost, PX4 climbs to "
        f"{height:g} m and flies home over whoever stands below. Set 1 (Hold) or 3 (Land)."
    )


def _px4_fence(v: Values) -> str:
    if v["GF_MAX_HOR_DIST"] > 0 and v["GF_MAX_VER_DIST"] > 0 and int(v["GF_ACTION"]) > 1:
        return ""
    return (
        "PX4 has no geofence that stops it (GF_MAX_HOR_DIST, GF_MAX_VER_DIST, GF_ACTION): "
        "set a radius, a height and GF_ACTION 2 (Hold)."
    )


def _never_locks(v: Values) -> str:
    seconds = v["COM_DISARM_LAND"]
    if seconds > 0:
        return ""
    return (
        f"COM_DISARM_LAND is {seconds:g}: PX4 never locks its propellers after landing, and wigwag does not "
        "either. Set it to 2 s."
    )


def _guided_timeout(v: Values) -> str:
    seconds = v["GUID_TIMEOUT"]
    if seconds <= 1.0:
        return ""
    return f"GUID_TIMEOUT is {seconds:g} s: so long ArduPilot flies on when set-points stop. Set it to 1 s."


def _gcs_failsafe(v: Values) -> str:
    action = int(v["FS_GCS_ENABLE"])
    if action not in (1, 2, 3, 4, 6):
        return ""
    return (
        f"FS_GCS_ENABLE is {action}: when a ground station is lost, ArduPilot climbs to {_rtl_m(v)} and "
        "flies home over whoever stands below. Set 5 (Land) or 7 (Brake or Land)."
    )


def _ardupilot_fence(v: Values) -> str:
    if not int(v["FENCE_ENABLE"]):
        return (
            "FENCE_ENABLE is 0: ArduPilot has no geofence. Set it to 1, with FENCE_RADIUS and FENCE_ALT_MAX."
        )
    if not int(v["FENCE_ACTION"]):
        return "FENCE_ACTION is 0: ArduPilot only tells that it left its geofence. Set 4 (Brake or Land)."
    return ""


def _rtl_m(v: Values) -> str:
    if "RTL_ALT_M" in v:
        return f"{v['RTL_ALT_M']:g} m"
    return f"{v['RTL_ALT'] / 100:g} m" if "RTL_ALT" in v else "its RTL altitude"


PX4_ADVICE = (
    Advice(("COM_OBL_RC_ACT",), _offboard_loss),
    Advice(("COM_OF_LOSS_T",), _offboard_timeout),
    Advice(("COM_RCL_EXCEPT",), _radio_exception),
    Advice(("COM_DISARM_LAND",), _never_locks),
    Advice(("RTL_RETURN_ALT", "NAV_DLL_ACT", "NAV_RCL_ACT"), _px4_return),
    Advice(("GF_MAX_HOR_DIST", "GF_MAX_VER_DIST", "GF_ACTION"), _px4_fence),
)
ARDUPILOT_ADVICE = (
    Advice(("GUID_TIMEOUT",), _guided_timeout),
    Advice(("FS_GCS_ENABLE",), _gcs_failsafe),
    Advice(("FENCE_ENABLE", "FENCE_ACTION"), _ardupilot_fence),
)
OPTIONAL = ("RTL_ALT_M", "RTL_ALT")
"""Read for the text alone; which of the two there is depends on ArduPilot's version."""


def names(advice: tuple[Advice, ...], optional: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return which settings are to be read."""
    return (*dict.fromkeys(name for entry in advice for name in entry.names), *optional)


def warnings(advice: tuple[Advice, ...], values: Values) -> tuple[str, ...]:
    """Return what is unwise in the settings, and which could not be read.

    Args:
        advice: What to look at.
        values: Those that the vehicle told.

    Example:
        >>> warnings(ARDUPILOT_ADVICE[:1], {"GUID_TIMEOUT": 3.0})
        ('GUID_TIMEOUT is 3 s: so long ArduPilot flies on when set-points stop. Set it to 1 s.',)
    """
    said = []
    for entry in advice:
        missing = [name for name in entry.names if name not in values]
        said.append(f"{', '.join(missing)} could not be read." if missing else entry.say(values))
    return tuple(filter(None, said))
