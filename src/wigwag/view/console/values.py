"""What goes from the loop to the page, and what comes back: values, no handles."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, UInt8

from wigwag.errors import InputError
from wigwag.fly.follow import Goal
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.operator import Mount
from wigwag.fly.situation import Craft, Mode
from wigwag.fly.values import VehicleState

if TYPE_CHECKING:
    from wigwag.recognise.explain import Explanation

KEPT_WHYS = 5
"""How many of the last decisions can be looked into."""


@dataclass(frozen=True, slots=True)
class Line:
    """Something that was said or decided, for the list of events."""

    at_s: float
    """On the clock of the stamps."""
    text: str
    kind: str = ""
    """``"gesture"``, ``"mode"``, ``"console"``, ``"alarm"``, or nothing."""


@dataclass(frozen=True, slots=True)
class Figure:
    """Somebody, as far as they are drawn."""

    is_operator: bool
    joints_m: Float[np.ndarray, "13 3"] | None
    """Camera optical frame; ``None``: not placed in space."""
    points_px: Float[np.ndarray, "33 2"] | None
    """Landmarks in the picture as the camera gave it; ``None``: not seen in it."""
    visibility: Float[np.ndarray, " 33"] | None
    """Of those, 0 to 1."""


@dataclass(frozen=True, slots=True)
class Picture:
    """What the camera saw."""

    rgb: UInt8[np.ndarray, "height width 3"]
    """Perhaps smaller than the camera gave it."""
    size_px: tuple[int, int]
    """Width and height as the camera gave it: what ``Figure.points_px`` are counted in."""
    fov_rad: float
    """Vertical angle of view."""


@dataclass(frozen=True, slots=True)
class Flight:
    """Of the drone and the supervisor; absent where nothing flies."""

    mode: Mode
    craft: Craft
    reason: str
    """Why a command was not obeyed; empty most of the time."""
    changed: str
    """The guards that held the set-point back."""
    speed_m_s: float
    """Horizontal speed that was sent; 0 where nothing was."""
    distance_m: float | None
    """Horizontal distance to the operator."""
    goal: Goal
    state: VehicleState
    """The newest."""
    limits: SupervisorConfig
    start: SupervisorConfig
    """The limits that the flight began with."""
    withheld: bool
    """Whether the console holds the drone."""


@dataclass(frozen=True, slots=True)
class Lesson:
    """Of what is being taught; absent where nothing is."""

    gesture: str
    """Its name; empty: none has been named yet."""
    headline: str
    """The one thing to do now."""
    advice: str
    """What is wrong, or was wrong with the last repetition; empty: nothing."""
    taken: int
    """Repetitions so far."""
    wanted: int
    under_way: bool
    """Whether a gesture is being shown or learned: then no other one can be begun."""
    learning: bool
    """Whether the loop is about to learn and will not be heard of until it has."""
    said: tuple[Line, ...]
    """What was taken, refused and learned, the newest last."""
    known: tuple[str, ...]
    """The gestures that the model knows."""


@dataclass(frozen=True, slots=True)
class Why:
    """What a gesture that was heard came from."""

    at_s: float
    """On the clock of the stamps."""
    label: str
    packed: bytes
    """The explanation. Whoever unpacks it needs the recogniser's code, which takes a second to be imported:
    the page's process does so where it draws, and not where it reads."""

    @classmethod
    def of(cls, at_s: float, explained: Explanation) -> Why:
        """Pack an explanation."""
        return cls(at_s, explained.gesture.label or "no gesture", pickle.dumps(explained))

    @property
    def at(self) -> str:
        """When it was."""
        return f"{self.at_s:.1f} s"

    @property
    def title(self) -> str:
        """What it is called among others."""
        return f"{self.at}: {self.label.replace('_', ' ')}"

    @property
    def explained(self) -> Explanation:
        """The explanation; it comes from this program's own loop."""
        unpacked: Explanation = pickle.loads(self.packed)
        return unpacked


@dataclass(frozen=True, slots=True)
class Snapshot:
    """All that the page shows, at one moment: each one is complete, and any may be left out."""

    now_ns: int
    picture: Picture | None
    """``None``: none came, or it is not this one's turn to carry it."""
    figures: tuple[Figure, ...]
    seen_from: VehicleState | None
    """Where the drone was when the picture was taken; ``None``: the camera stands somewhere, level."""
    mount: Mount
    flight: Flight | None
    who: str
    """Who commands, or why nobody does."""
    engaging: float
    """How much of the time that engaging takes somebody has held a hand up, 0 to 1."""
    rate_hz: float
    """Turns of the loop a second, on the wall's clock."""
    pose_ms: float
    """Processor milliseconds of finding the pose, a median."""
    rest_ms: float
    """The same for everything after it."""
    lines: tuple[Line, ...]
    """The last events, the newest last; whoever missed a snapshot has missed none of them."""
    lesson: Lesson | None = None
    whys: tuple[Why, ...] = ()
    """What was heard since the last snapshot; the newest last."""


def newer(missed: Snapshot, snapshot: Snapshot) -> Snapshot:
    """Return the later of two snapshots, with what was only in the one that was missed.

    That is its picture, if the later one has none, and what was heard.
    """
    picture = missed.picture if snapshot.picture is None else snapshot.picture
    whys = (*missed.whys, *snapshot.whys)[-KEPT_WHYS:]
    if picture is snapshot.picture and whys == snapshot.whys:
        return snapshot
    return replace(snapshot, picture=picture, whys=whys)


class Button(StrEnum):
    """What can be pressed on the page. None of them arms or takes off."""

    STOP = "stop"
    """The operator's stop: it holds; the next gesture is obeyed."""
    HOLD = "hold"
    """Stop, and gestures but for stop and land are refused until somebody presses engage."""
    LAND = "land"
    ENGAGE = "engage"
    """Lets go of a hold; whoever is seen alone becomes the operator if nobody is."""
    CANCEL = "cancel"
    """Ends the lesson under way."""


NAME_MOST = 200
"""A gesture's name is cut off after so many characters where it enters, and refused where it is judged."""


@dataclass(frozen=True, slots=True)
class Ask:
    """What somebody asks for on the page: a button, a gesture to be taught, or a limit set anew."""

    button: Button | None = None
    limit: str = ""
    """The name of a dial (``wigwag.fly.tighten``)."""
    value: float = 0.0
    teach: str | None = None
    """The name of a gesture, as somebody typed it."""

    @property
    def about(self) -> tuple[str, str]:
        """What it is about: of two asks about the same, the later one counts."""
        if self.button is not None:
            return "button", self.button
        return ("teach", "") if self.teach is not None else ("limit", self.limit)

    def to_json(self) -> bytes:
        """Return it in the form in which it leaves the page's process."""
        read: dict[str, object] = {"limit": self.limit, "value": self.value}
        if self.button is not None:
            read = {"button": self.button}
        elif self.teach is not None:
            read = {"teach": self.teach[:NAME_MOST]}
        return json.dumps(read).encode()

    @classmethod
    def from_json(cls, data: bytes) -> Ask:
        """Read it. The loop unpickles nothing that comes from a process that listens to a network.

        Raises:
            InputError: If it is of no known form.

        Example:
            >>> Ask.from_json(Ask(Button.STOP).to_json())
            Ask(button=<Button.STOP: 'stop'>, limit='', value=0.0, teach=None)
        """
        try:
            read = json.loads(data)
            if set(read) == {"button"}:
                return cls(Button(read["button"]))
            if set(read) == {"limit", "value"} and math.isfinite(value := float(read["value"])):
                return cls(None, str(read["limit"])[:40], value)
            if set(read) == {"teach"} and isinstance(name := read["teach"], str):
                return cls(teach=name[:NAME_MOST])
        except (ValueError, TypeError, AttributeError) as error:
            raise InputError(f"{data[:80]!r} is nothing that the console's page can ask for.") from error
        raise InputError(f"{data[:80]!r} is nothing that the console's page can ask for.")


__all__ = [
    "KEPT_WHYS", "NAME_MOST", "Ask", "Button", "Figure", "Flight", "Lesson", "Line", "Picture", "Snapshot",
    "Why", "newer",
]  # fmt: skip
