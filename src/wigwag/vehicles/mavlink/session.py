"""One flight of one autopilot: what it is told and when, as a machine of values and an injected clock."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from wigwag.errors import InputError
from wigwag.fly.values import HOVER, Setpoint, VehicleState
from wigwag.vehicles.mavlink import setup
from wigwag.vehicles.mavlink.autopilots import Doing
from wigwag.vehicles.mavlink.config import MavlinkConfig
from wigwag.vehicles.mavlink.control import Control, Decides
from wigwag.vehicles.mavlink.conversation import Conversation, Procedure
from wigwag.vehicles.mavlink.requests import Requests
from wigwag.vehicles.mavlink.signing import read_key
from wigwag.vehicles.protocol import AIRBORNE, Capabilities, FlightMode

_S = 1_000_000_000
_MUTE_S = 0.6
"""A link that gave no answer for so long may have swallowed set-points."""
_RETRY_S = 1.0
_LONG_AGO_NS = -1_000_000 * _S


class Session:
    """All that is decided about an autopilot. Bytes and time are handed in, bytes are handed out.

    Call ``receive`` with what comes, ``tick`` at ``due_ns`` or sooner, and send what ``tick`` returns.

    Args:
        config: How it is talked to.
        wall_clock_s: Seconds since 1970, for signatures only.
    """

    def __init__(self, config: MavlinkConfig | None = None, wall_clock_s: float = 0.0) -> None:
        self.config = c = config or MavlinkConfig()
        key = read_key(c.key) if c.key else None
        self.talk = Conversation(c.system, key, wall_clock_s, c.ack_s, c.tries)
        self.control = Control()
        self.ready = False
        """Whether messages flow and the settings were read."""
        self.warnings: tuple[str, ...] = ()
        self.denied = ""
        self.trouble = ""
        self.due_ns = 0
        """When ``tick`` wants to be called."""
        self._requests: Requests | None = None
        self._setting_up: Procedure | None = None
        self._asked: Procedure | None = None
        self._asked_for = ""
        self._then_height_m: float | None = None
        self._taking_off = False
        self._setpoint, self._stamp_ns = HOVER, _LONG_AGO_NS
        self._steered_ns = -1
        """When a set-point last left that counts; -1: it is not steered."""
        self._flow_ns: int | None = None
        """Since when set-points have been leaving without a gap."""
        self._beat_ns = self._heartbeat_ns = self._setup_ns = self._tried_ns = _LONG_AGO_NS
        self._count = self._restarts = 0
        self._as_gcs = c.heartbeat == "gcs"

    # What is known.

    @property
    def mode(self) -> FlightMode:
        """What the vehicle is doing."""
        t, autopilot = self.talk.telemetry, self.talk.autopilot
        if autopilot is None or not t.armed:
            return FlightMode.DISARMED
        if self.control.decides is Decides.PILOT:
            return FlightMode.MANUAL
        if self.control.decides is Decides.FAILSAFE:
            return FlightMode.FAILSAFE
        doing = autopilot.doing(t.custom_mode)
        if self._taking_off or doing is Doing.TAKE_OFF:
            return FlightMode.TAKING_OFF
        if doing is Doing.LAND:
            return FlightMode.LANDING
        if t.on_ground:
            return FlightMode.READY
        if doing is Doing.STEER:
            steered = self._steered_ns >= 0 or autopilot.stream_first_s > 0
            return FlightMode.STEERED if steered else FlightMode.HOLDING
        return FlightMode.HOLDING if doing is Doing.HOLD else FlightMode.MANUAL

    @property
    def capabilities(self) -> Capabilities:
        """What the vehicle can do."""
        autopilot, t = self.talk.autopilot, self.talk.telemetry
        name = f"{autopilot.name} {t.version}".strip() if autopilot else "not connected"
        own = self.talk.parameters.get("COM_OF_LOSS_T", self.talk.parameters.get("GUID_TIMEOUT"))
        return Capabilities(
            name, self.config.fresh_s, own, battery=t.battery is not None, health=True, pilot=True
        )

    def state(self, now_ns: int) -> VehicleState:
        """Return what the vehicle says of itself."""
        t = self.talk.telemetry
        trouble = self.trouble
        if self.talk.autopilot is not None and not t.position.stamp_ns:
            trouble = "; ".join(filter(None, (trouble, "it has no position yet")))
        return t.state(now_ns, self.denied, trouble)

    # What is asked.

    def beat(self, now_ns: int) -> None:
        """Say that the loop is alive."""
        self._beat_ns = max(self._beat_ns, now_ns)

    def arm(self, now_ns: int) -> bool:
        """Ask it to arm; armed and on the ground, it is done already."""
        if self.mode is FlightMode.READY:
            return True
        if self.mode is not FlightMode.DISARMED or self._requests is None or not self.ready:
            return False
        return self._ask("arm", self._requests.arm(), now_ns)

    def take_off(self, height_m: float, now_ns: int) -> bool:
        """Ask it to take off, at once or when it is armed.

        Raises:
            InputError: If the height is not positive.
        """
        if not height_m > 0 or not math.isfinite(height_m):
            raise InputError(f"take_off needs a height above 0 m, but got {height_m}.")
        if self._asked_for == "arm":
            self._then_height_m = height_m
            return True
        if self.mode is not FlightMode.READY or self._requests is None:
            return False
        self._taking_off = True
        return self._ask("take off", self._requests.take_off(height_m), now_ns)

    def land(self, now_ns: int) -> bool:
        """Ask it to land."""
        return self._leave("land", now_ns)

    def hold(self, now_ns: int) -> bool:
        """Ask it to hold."""
        return self._leave("hold", now_ns)

    def send(self, setpoint: Setpoint, stamp_ns: int, now_ns: int) -> bool:
        """Take a set-point; return whether it will be flown."""
        self.beat(now_ns)
        values = (*setpoint.velocity_m_s, setpoint.yaw_rate_rad_s)
        if self.mode not in AIRBORNE or self._asked_for in ("hold", "land") or not np.isfinite(values).all():
            return False
        if now_ns - stamp_ns > self.config.fresh_s * _S or stamp_ns < self._stamp_ns:
            return False
        self._setpoint, self._stamp_ns = setpoint, min(stamp_ns, now_ns)
        return True

    # What happens by itself.

    def receive(self, data: bytes, now_ns: int) -> None:
        """Take in bytes from the link."""
        if self.talk.receive(data, now_ns) and self.talk.autopilot is not None:
            self.control.seen(self.talk.telemetry, self.talk.autopilot, now_ns)
            if not self.talk.telemetry.armed:
                self._taking_off, self._steered_ns = False, -1
        self._advance()

    def tick(self, now_ns: int) -> list[bytes]:
        """Do what is due; return the packets to be sent, in order."""
        self.talk.now_ns = max(self.talk.now_ns, now_ns)
        self._advance()
        if now_ns >= self.due_ns:
            period_ns = round(_S / self.config.rate_hz)
            # The grid stays where it is, so that a late call does not shift those after it.
            late = (now_ns - self.due_ns) // period_ns
            self.due_ns = now_ns + period_ns if self.due_ns == 0 else self.due_ns + (late + 1) * period_ns
            self._periodic(now_ns)
        packets, self.talk.out = self.talk.out, []
        return packets

    def _periodic(self, now_ns: int) -> None:
        self._count += 1
        alive = now_ns - self._beat_ns <= self.config.beat_s * _S
        if alive and now_ns - self._heartbeat_ns >= 0.98 * _S:
            self._heartbeat_ns = now_ns
            self._post_heartbeat()
        if self.talk.autopilot is None:
            return
        if self._count % max(1, round(self.config.rate_hz / 10)) == 0:
            self.talk.echo()
        self._watch(now_ns)
        self._stream(now_ns)

    def _post_heartbeat(self) -> None:
        kind = 6 if self._as_gcs else 18  # MAV_TYPE_GCS, MAV_TYPE_ONBOARD_CONTROLLER
        self.talk.post(self.talk.encode.heartbeat_encode(kind, 8, 0, 0, 4))  # no autopilot; active

    def _watch(self, now_ns: int) -> None:
        """Set up, and again after a restart or when messages stop; note a mute link."""
        t = self.talk.telemetry
        if t.restarts != self._restarts:
            self._restarts = t.restarts
            self.trouble = "the autopilot was restarted"
            self.control.restart()
            self._asked, self._asked_for, self._taking_off, self._steered_ns = None, "", False, -1
            self._setup_ns, self._setting_up = _LONG_AGO_NS, None
        if self._requests is None:
            self._requests = Requests(self.talk, self.control)
        if t.echo_ns is not None and now_ns - t.link_ns() > _MUTE_S * _S:
            self.control.lapsed(now_ns)
        came_ns = min(t.position.arrived_ns, t.attitude.arrived_ns)
        silent = not self.ready or now_ns - came_ns > 2 * _S or t.landed is None
        heard = now_ns - t.heard_ns < _S
        if heard and silent and self._setting_up is None and now_ns - self._setup_ns > 3 * _S:
            self._setup_ns = now_ns
            self._setting_up = self._set_up()
        if self.control.timed_out and self._asked is None and now_ns - self._tried_ns > _RETRY_S * _S:
            self._tried_ns = now_ns
            self._ask("confirm", self._requests.confirm_hold(), now_ns, unasked=True)

    def _set_up(self) -> Procedure:
        """Agree with the autopilot on everything; the settings are read once."""
        if self.ready:
            yield from setup.streams(self.talk, self.config.stream_hz)
        else:
            yield from setup.set_up(self.talk, self.config.stream_hz)
            self.warnings = setup.settings_warnings(self.talk)
            needs = int(self.talk.parameters.get("NAV_DLL_ACT", 0)) > 0
            self._as_gcs |= self.config.heartbeat == "auto" and needs
            self.ready = True
        return (yield from setup.find_origin(self.talk, self.config.origin))

    def _advance(self) -> None:
        """Let what is under way go on."""
        if self._setting_up is not None:
            try:
                next(self._setting_up)
            except StopIteration:
                self._setting_up = None
        if self._asked is None:
            return
        try:
            next(self._asked)
        except StopIteration as end:
            asked_for, self._asked, self._asked_for = self._asked_for, None, ""
            self._ended(asked_for, end.value or "")

    def _ended(self, asked_for: str, reason: str) -> None:
        self.denied = reason
        self._taking_off = False
        height, self._then_height_m = self._then_height_m, None
        if asked_for == "arm" and height is not None and not reason:
            if not self.take_off(height, self.talk.now_ns):
                self.denied = "armed, but it does not stand on the ground"
        elif asked_for == "steer" and reason:
            self._flow_ns = None  # begins its second anew

    def _ask(self, what: str, procedure: Procedure, now_ns: int, *, unasked: bool = False) -> bool:
        """Begin something; what was under way is dropped.

        What nobody asked for (a dead man's switch asks for hold again and again) leaves a refusal said.
        """
        self.talk.now_ns = max(self.talk.now_ns, now_ns)
        self._asked, self._asked_for = procedure, what
        self._then_height_m = None
        self.denied = self.denied if unasked else ""
        self._advance()
        return True

    def _leave(self, what: Literal["hold", "land"], now_ns: int) -> bool:
        """Ask for one of the modes in which the autopilot flies by itself."""
        refused = (FlightMode.DISARMED, FlightMode.READY, FlightMode.MANUAL)
        autopilot = self.talk.autopilot
        if autopilot is None or self._requests is None or self.mode in refused:
            return False
        mode = autopilot.hold_mode if what == "hold" else autopilot.land_mode
        if self._asked_for == what or (self.talk.telemetry.custom_mode == mode and not self._asked_for):
            return True
        self._taking_off = False
        self._setpoint, self._stamp_ns, self._flow_ns = HOVER, _LONG_AGO_NS, None  # those before it are void
        return self._ask(what, self._requests.change(mode), now_ns)

    # Set-points, and what is sent when there are none.

    def _stream(self, now_ns: int) -> None:
        """Send the newest set-point while it is fresh; then stand still; then hold."""
        autopilot, requests = self.talk.autopilot, self._requests
        if autopilot is None or requests is None:
            return
        doing, mode = autopilot.doing(self.talk.telemetry.custom_mode), self.mode
        steering = doing is Doing.STEER
        if mode not in AIRBORNE or not steering:
            self._steered_ns = -1
        if mode not in AIRBORNE:
            self._flow_ns = None
            alive = now_ns - self._beat_ns <= self.config.beat_s * _S
            if mode is FlightMode.MANUAL and doing is Doing.HOLD and autopilot.stream_first_s and alive:
                # A pilot who lets PX4 hold can give it back by choosing Offboard, which wants a stream.
                self._post(HOVER, now_ns)
            return
        if self._asked_for in ("hold", "land"):
            if steering and self._steered_ns >= 0:
                self._post(HOVER, now_ns)
            return
        age_s = (now_ns - self._stamp_ns) * 1e-9
        if age_s <= self.config.fresh_s:
            self._flow_ns = self._flow_ns if self._flow_ns is not None else now_ns
            self._post(self._setpoint, now_ns)
            if steering:
                self._steered_ns = now_ns
            elif not self._asked_for and now_ns - self._flow_ns >= autopilot.stream_first_s * _S:
                self._ask("steer", requests.change(autopilot.steer_mode), now_ns, unasked=True)
            return
        self._flow_ns = None
        if not steering or self._steered_ns < 0:
            return
        self.control.lapsed(now_ns)
        self._post(HOVER, now_ns)
        if age_s > self.config.fresh_s + self.config.still_s and not self._asked_for:
            self._ask("hold", requests.change(autopilot.hold_mode), now_ns, unasked=True)

    def _post(self, setpoint: Setpoint, now_ns: int) -> None:
        t, autopilot = self.talk.telemetry, self.talk.autopilot
        assert autopilot is not None
        if (now_ns - t.attitude.stamp_ns) > 0.5 * _S:
            setpoint = HOVER  # nobody knows which way it looks
        self.talk.post(
            autopilot.setpoint(self.talk.encode, self.talk.target, setpoint, t.heading_rad(now_ns))
        )
