"""What is agreed with an autopilot before it is flown: which messages it sends, and how it is set."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.vehicles.mavlink.autopilots import CommandRequest
from wigwag.vehicles.mavlink.conversation import Conversation, Procedure
from wigwag.vehicles.mavlink.parameters import ARDUPILOT_ADVICE, OPTIONAL, PX4_ADVICE, names, warnings

_S = 1_000_000_000
_HEARTBEAT, _SYS_STATUS, _GPS_RAW_INT, _ATTITUDE, _LOCAL_POSITION, _GLOBAL_POSITION = 0, 1, 24, 30, 32, 33
_VERSION, _FENCE_STATUS, _EXTENDED_SYS_STATE = 148, 162, 245
_REQUEST_MESSAGE, _RUN_PREARM_CHECKS = 512, 401
_ORIGIN_WAIT_S = 3.0
DEFAULT_ORIGIN = (0.001, 0.001, 0.0)
"""Degrees north, degrees east, metres above the sea: where a vehicle without GPS is said to be. What counts
is only that there is an origin; it lies in open sea, so that nobody takes it for a place."""
_NO_GPS, _FIX = 0, 2
"""GPS_FIX_TYPE: none connected; the least that is a position."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where the estimator's origin is put if the vehicle has none."""

    latitude_deg: float
    longitude_deg: float
    altitude_m: float


def streams(talk: Conversation, stream_hz: float) -> Procedure:
    """Ask for every message that is needed. ArduPilot sends hardly any by itself.

    Rates that are refused are left as they are: what does not come is missed where it is needed.
    """
    wanted = [
        (_LOCAL_POSITION, stream_hz), (_ATTITUDE, stream_hz), (_EXTENDED_SYS_STATE, 5.0),
        (_HEARTBEAT, 10.0),  # so that a pilot's change of mode is seen in a tenth of a second
        (_GLOBAL_POSITION, 5.0), (_SYS_STATUS, 2.0), (_GPS_RAW_INT, 1.0),
    ]  # fmt: skip
    if talk.autopilot is not None and talk.autopilot.name == "ArduPilot":
        wanted.append((_FENCE_STATUS, 5.0))  # PX4 calls a fence that was met critical; ArduPilot does not
    for message_id, rate_hz in wanted:
        yield from talk.set_interval(message_id, rate_hz)
    return ""


def read_settings(talk: Conversation) -> Procedure:
    """Read the autopilot's version and the parameters that matter."""
    params = (float(_VERSION), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    yield from talk.command(CommandRequest(_REQUEST_MESSAGE, "tell its version", params))
    px4 = talk.autopilot is not None and talk.autopilot.name == "PX4"
    for name in names(PX4_ADVICE) if px4 else names(ARDUPILOT_ADVICE, OPTIONAL):
        yield from talk.read_parameter(name, 1 if name in OPTIONAL else 4)
    return ""


def settings_warnings(talk: Conversation) -> tuple[str, ...]:
    """Return what is unwise in what was read."""
    px4 = talk.autopilot is not None and talk.autopilot.name == "PX4"
    return warnings(PX4_ADVICE if px4 else ARDUPILOT_ADVICE, talk.parameters)


def find_origin(talk: Conversation, origin: Origin | None) -> Procedure:
    """Give the estimator an origin if it has none and no GPS will bring one.

    Args:
        talk: With the autopilot.
        origin: The user's own; one that is given is set at once.
    """
    telemetry = talk.telemetry
    deadline = talk.now_ns + int(_ORIGIN_WAIT_S * _S)
    while not telemetry.origin and talk.now_ns < deadline:
        yield
    while not telemetry.origin:
        if telemetry.gps_fix < _FIX and (origin is not None or telemetry.gps_fix == _NO_GPS):
            place = origin or Origin(*DEFAULT_ORIGIN)
            talk.post(
                talk.encode.set_gps_global_origin_encode(
                    talk.target[0],
                    round(place.latitude_deg * 1e7),
                    round(place.longitude_deg * 1e7),
                    round(place.altitude_m * 1e3),
                )
            )
        again = talk.now_ns + _S
        while not telemetry.origin and talk.now_ns < again:
            yield
    return ""


def run_checks(talk: Conversation) -> Procedure:
    """Let it say what keeps it from arming."""
    params = (0.0,) * 7
    return (yield from talk.command(CommandRequest(_RUN_PREARM_CHECKS, "run its checks", params)))


def set_up(talk: Conversation, stream_hz: float) -> Procedure:
    """Everything that is agreed on before flying, the origin apart."""
    yield from streams(talk, stream_hz)
    yield from read_settings(talk)
    if not talk.telemetry.healthy:
        yield from run_checks(talk)
    return ""
