"""A recorded flight is decided again, by the same chain, over its poses or its frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.fly.situation import Mode
from wigwag.fly.supervisor import Supervisor
from wigwag.fly.tighten import with_settings
from wigwag.fly.values import Setpoint, VehicleState
from wigwag.gesture import Gesture
from wigwag.pilot import CRAFT, Pilot, PilotConfig, PoseSource, Step
from wigwag.record.codec import text
from wigwag.record.flight import Flight
from wigwag.record.turns import Recorded, Turn
from wigwag.skeleton import Clip, Pose
from wigwag.stream.listener import Listener
from wigwag.vehicles.protocol import Capabilities, FlightMode

Material = Literal["poses", "frames"]
"""What is decided from: the poses as they were measured, or the pictures."""

_MODES = {craft: mode for mode, craft in reversed(CRAFT.items())}


@dataclass(frozen=True, slots=True)
class _Somebody:
    number: int


class _Reel:
    """The recorded turn whose turn it is, as everything that the pilot asks."""

    def __init__(self) -> None:
        self.now: Recorded | None = None

    @property
    def turn(self) -> Recorded:
        assert self.now is not None
        return self.now


class _Poses:
    """Finds in every frame what was found in it."""

    def __init__(self, reel: _Reel) -> None:
        self._reel = reel

    def __call__(self, frame: Frame) -> Pose | None:
        return self._reel.turn.pose


class _EngagedPoses(_Poses):
    """The same, and knows who commanded."""

    @property
    def operator(self) -> _Somebody | None:
        number = self._reel.turn.turn.operator
        return None if number is None else _Somebody(number)


class _Ear:
    """Hears what was heard."""

    def __init__(self, reel: _Reel) -> None:
        self._reel = reel

    def update(self, pose: Pose | None) -> Gesture | None:
        return self._reel.turn.gesture

    def reset(self) -> None:
        """There is nothing to forget."""


class _Deaf:
    """Stands where a model would."""

    def recognise(self, clip: Clip) -> Gesture:
        raise InputError("The flight was recorded without a model.")


class _Vehicle:
    """Is where the recorded one was, whatever it is told."""

    warnings: tuple[str, ...] = ()
    capabilities = Capabilities("a recorded flight", 0.5)

    def __init__(self, reel: _Reel) -> None:
        self._reel = reel

    @property
    def mode(self) -> FlightMode:
        now = self._reel.now
        return FlightMode.DISARMED if now is None else _MODES[now.turn.situation.craft]

    @property
    def state(self) -> VehicleState:
        return self._reel.turn.state

    def connect(self) -> None: ...
    def close(self) -> None: ...
    def beat(self, now_ns: int) -> None: ...

    def arm(self) -> bool:
        return True

    def take_off(self, height_m: float = 1.5) -> bool:
        return True

    def land(self) -> bool:
        return True

    def hold(self) -> bool:
        return True

    def send(self, setpoint: Setpoint, stamp_ns: int) -> bool:
        return True


class Replay:
    """Decides a flight again.

    The drone and the world do as they did: what would be decided otherwise changes nothing of what comes
    after it but the decisions.

    Args:
        flight: The recording.
        listener: What hears the stream; ``None``: says what was said, so that only what follows from gestures
            is decided again.
        material: What is decided from.
        config: Other settings; ``None``: the flight's own.
        models_dir: Where the pose networks are, for ``"frames"``.

    Raises:
        InputError: If frames are asked for that were not recorded.
        ModelError: If a pose network is missing.
    """

    def __init__(
        self,
        flight: Flight,
        listener: Listener | None = None,
        material: Material = "poses",
        config: PilotConfig | None = None,
        models_dir: Path | None = None,
    ) -> None:
        self.flight, self.material = flight, material
        self._reel = _Reel()
        config = config or flight.config
        pose = self._eyes(models_dir) if material == "frames" else self._poses()
        self.pilot = Pilot(
            pose, _Deaf(), _Vehicle(self._reel), commands=flight.commands, config=config,
            time_ns=lambda: self._reel.turn.turn.situation.now_ns,
        )  # fmt: skip
        self.pilot.supervisor = Supervisor(config.supervisor, Mode(flight.mode))
        self.pilot.spotter = listener or _Ear(self._reel)

    def _poses(self) -> PoseSource:
        return _EngagedPoses(self._reel) if self.flight.tells_operator else _Poses(self._reel)

    def _eyes(self, models_dir: Path | None) -> PoseSource:
        from wigwag.pose.estimator import PoseEstimator

        flight, config = self.flight, self.flight.pose_config
        if config is None or flight.facts["pictures"] == "none":
            raise InputError(
                f"{flight.path}: holds no pictures that wigwag found poses in. Decide from its poses instead."
            )
        if config.monocular is None and flight.facts["depth"] != "true":
            raise InputError(
                f"{flight.path}: holds pictures, but no depth, which its poses came from. Decide from its "
                "poses, or record with depth: --record-depth."
            )
        return PoseEstimator(replace(config, blazepose=replace(config.blazepose, models_dir=models_dir)))

    def __iter__(self) -> Iterator[tuple[Recorded, Step]]:
        """Yield each turn as it was, and as it is decided now.

        Raises:
            DataError: If the file is damaged.
        """
        for recorded, frame in self._turns():
            self._reel.now = recorded
            self._attend(recorded.turn)
            yield recorded, self.pilot.step(frame, recorded.turn.now_ns, recorded.turn.asked)

    def _attend(self, turn: Turn) -> None:
        """Do what somebody at the console did."""
        from wigwag.pose.estimator import PoseEstimator

        pilot = self.pilot
        pilot.withheld = turn.situation.withheld
        if turn.limits:
            pilot.supervisor.config = with_settings(pilot.supervisor.config, turn.limits)
            pilot.helm.keep_within(pilot.supervisor.config)
        if turn.called and isinstance(pilot.pose, PoseEstimator):
            pilot.pose.call_operator()

    def _turns(self) -> Iterator[tuple[Recorded, Frame | None]]:
        if self.material == "frames":
            yield from self.flight.frames()
            return
        for recorded in self.flight.turns():
            look = recorded.turn.look
            seen = look is not None and look.used
            yield recorded, replace(_BLANK, intrinsics=look.intrinsics) if seen and look else None


_BLANK = Frame(np.zeros((1, 1, 3), np.uint8), None, Intrinsics(), 0)
"""Stands for a frame that nobody looks at."""


@dataclass(frozen=True, slots=True)
class Difference:
    """Something that was decided otherwise."""

    time_s: float
    """On the flight's clock."""
    what: Literal["gesture", "transition"]
    then: str
    now: str


@dataclass(slots=True)
class Comparison:
    """What is the same and what is not, over a whole flight."""

    turns: int = 0
    poses: int = 0
    """Turns whose pose is another one."""
    gestures: int = 0
    """Turns whose gesture is another one, in whatever: label, times, confidence, reason."""
    verdicts: int = 0
    setpoints: int = 0
    """Turns in which something else would be wished for or sent."""
    heard: list[tuple[float, str | None]] = field(default_factory=list)
    """Every gesture as it was: seconds, and label."""
    heard_now: list[tuple[float, str | None]] = field(default_factory=list)
    most_m_s: float = 0.0
    """The greatest difference between velocities sent."""
    first_s: float | None = None
    """When the first decision differed."""
    differences: list[Difference] = field(default_factory=list)
    began_s: float | None = None
    ended_s: float = 0.0

    @property
    def same(self) -> bool:
        """Whether every decision is the same, to the last bit."""
        return self.gestures == self.verdicts == self.setpoints == 0

    @property
    def duration_s(self) -> float:
        """How long the flight was."""
        return 0.0 if self.began_s is None else self.ended_s - self.began_s

    def note(self, then: Recorded, now: Step) -> None:
        """Compare one turn."""
        at_s = then.turn.situation.now_ns * 1e-9
        self.began_s = at_s if self.began_s is None else self.began_s
        self.ended_s, self.turns = at_s, self.turns + 1
        if then.gesture is not None:
            self.heard.append((at_s, then.gesture.label))
        if now.gesture is not None:
            self.heard_now.append((at_s, now.gesture.label))
        self.poses += text(then.pose) != text(now.pose)
        gesture = text(then.gesture) != text(now.gesture)
        told = (then.told.wish, then.told.sent, then.told.changed)
        setpoint = text(told) != text((now.wish, now.permit.setpoint, now.permit.changed))
        verdict = text(then.turn.verdict) != text(now.verdict)
        self.gestures += gesture
        self.setpoints += setpoint
        self.verdicts += verdict
        if gesture:
            self.differences.append(Difference(at_s, "gesture", _said(then.gesture), _said(now.gesture)))
        rows = then.turn.verdict.row or then.turn.verdict.mode, now.verdict.row or now.verdict.mode
        if verdict and rows[0] != rows[1] and (then.turn.verdict.row or now.verdict.row):
            self.differences.append(Difference(at_s, "transition", *rows))
        if setpoint:
            self.most_m_s = max(self.most_m_s, _apart_m_s(then.told.sent, now.permit.setpoint))
        if self.first_s is None and (gesture or setpoint or verdict):
            self.first_s = at_s


def _said(gesture: Gesture | None) -> str:
    if gesture is None:
        return "nothing"
    return f"{gesture.label or 'none'} ({gesture.confidence:.3f})"


def _apart_m_s(a: Setpoint | None, b: Setpoint | None) -> float:
    zero = (0.0, 0.0, 0.0)
    first, second = (zero if s is None else s.velocity_m_s for s in (a, b))
    return float(np.linalg.norm(np.subtract(first, second)))


__all__ = ["Comparison", "Difference", "Material", "Replay"]
