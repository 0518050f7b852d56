"""The MAVLink messages: pymavlink's generated code, loaded when a vehicle is."""

from __future__ import annotations

from typing import Any

from wigwag.extras import load

TAKES_VELOCITY = 0x1 | 0x2 | 0x4 | 0x40 | 0x80 | 0x100 | 0x400
"""``type_mask`` of SET_POSITION_TARGET_LOCAL_NED: position, acceleration and yaw are ignored; velocity and
yaw rate count."""


def dialect() -> Any:
    """Return pymavlink's module of the common messages, MAVLink 2.

    Raises:
        MissingExtraError: If pymavlink is not installed.
    """
    return load("pymavlink.dialects.v20.common", "mavlink", "A MAVLink vehicle")
