"""``mavlink:...`` addresses."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from wigwag.camera.address import Address
from wigwag.errors import InputError
from wigwag.vehicles.mavlink.links import link_of
from wigwag.vehicles.mavlink.session import MavlinkConfig
from wigwag.vehicles.mavlink.setup import Origin
from wigwag.vehicles.mavlink.vehicle import MavlinkVehicle

OPTIONS = ("baud", "key", "system", "rate_hz", "stream_hz", "heartbeat", "origin")


def open_mavlink(address: Address) -> MavlinkVehicle:
    """Return the vehicle at an address, not yet connected.

    Args:
        address: Such as ``mavlink:serial:/dev/ttyACM0?baud=921600&key=FILE``, taken apart with ``OPTIONS``.

    Raises:
        InputError: If it names no link, or an option is wrong.
        MissingExtraError: If pymavlink is not installed.
    """
    default = MavlinkConfig()
    config = MavlinkConfig(
        system=address.whole("system", 0) or None,
        rate_hz=address.number("rate_hz", default.rate_hz),
        stream_hz=address.number("stream_hz", default.stream_hz),
        heartbeat=_heartbeat(address),
        origin=_origin(address),
        key=Path(address.text("key")).expanduser() if "key" in address.options else None,
    )
    return MavlinkVehicle(link_of(address.target, address.whole("baud", 57600)), config)


def _heartbeat(address: Address) -> Literal["auto", "onboard", "gcs"]:
    match address.text("heartbeat", "auto"):
        case "auto":
            return "auto"
        case "onboard":
            return "onboard"
        case "gcs":
            return "gcs"
        case other:
            raise InputError(f"mavlink: ?heartbeat= must be auto, onboard or gcs, but got {other!r}.")


def _origin(address: Address) -> Origin | None:
    text = address.text("origin")
    if not text:
        return None
    try:
        latitude, longitude, altitude = (float(part) for part in text.split(","))
    except ValueError:
        latitude = longitude = altitude = float("nan")
    if not (abs(latitude) <= 90 and abs(longitude) <= 180 and abs(altitude) < 10_000):
        raise InputError(
            "mavlink: ?origin= must be degrees north, degrees east and metres, such as 52.1,4.3,12, "
            f"but got {text!r}."
        )
    return Origin(latitude, longitude, altitude)
