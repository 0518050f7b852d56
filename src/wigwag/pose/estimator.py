"""A frame becomes the operator's 3-D pose: bodies in the colour, depth under them, one who commands."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame
from wigwag.errors import InputError
from wigwag.pose.blazepose import BlazePose, BlazePoseConfig
from wigwag.pose.body import Body
from wigwag.pose.engagement import EngagementConfig
from wigwag.pose.lift import LiftConfig
from wigwag.pose.monocular import MonocularConfig
from wigwag.pose.operator import OperatorConfig, OperatorKeeper
from wigwag.pose.people import People, PeopleConfig, Track
from wigwag.pose.sides import SidesConfig
from wigwag.pose.space import InSpace
from wigwag.pose.steady import Steadier, SteadyConfig
from wigwag.pose.turning import PictureShift
from wigwag.pose.watching import BodyTracker, PeopleFinder, WatchConfig, Watcher
from wigwag.skeleton import Pose


@dataclass(frozen=True, slots=True)
class PoseConfig:
    """How a frame becomes a pose."""

    blazepose: BlazePoseConfig = field(default_factory=BlazePoseConfig)
    """How bodies are found in the colour picture."""
    lift: LiftConfig = field(default_factory=LiftConfig)
    """How landmarks get their depth."""
    monocular: MonocularConfig | None = None
    """How people are placed by their size in frames without depth. ``None``: such frames are an error, so
    that nobody flies on decimetres without having asked for it."""
    sides: SidesConfig = field(default_factory=SidesConfig)
    """When a change of left and right is not believed."""
    operator: OperatorConfig = field(default_factory=OperatorConfig)
    """Whose pose is handed on: by default nobody's before they have engaged."""
    engagement: EngagementConfig = field(default_factory=EngagementConfig)
    """How somebody engages and disengages."""
    people: PeopleConfig = field(default_factory=PeopleConfig)
    """Who can be whom from one look to the next."""
    watch: WatchConfig = field(default_factory=WatchConfig)
    """How much of each frame the networks look at."""
    head: Literal["ears", "nose"] = "ears"
    """What the first landmark is: the middle of the ears, where a Kinect puts its head joint, so that
    people recorded with a Kinect and people seen by a camera agree; or the nose, as in the paper."""
    steady: SteadyConfig = field(default_factory=SteadyConfig)
    """How what is handed on is made steady."""

    @classmethod
    def alone(cls) -> PoseConfig:
        """Return options for one person alone before the camera: whoever is found first is the operator."""
        return cls(operator=OperatorConfig(engage="first"))


@dataclass(frozen=True, slots=True)
class Person:
    """Somebody in the picture, as the estimator sees them; for display and for judging."""

    number: int
    """Who, for as long as they are kept in mind; never given twice."""
    is_operator: bool
    body: Body | None
    """In the latest frame's colour picture; ``None``: not looked at or not seen in it."""
    pose: Pose | None
    """The same in space, not smoothed."""
    position_m: Float[np.ndarray, " 3"]
    """Middle of the hips when seen last, metres, camera optical frame."""
    seen_ns: int
    """Stamp of the frame in which they were seen last."""
    engaging: float
    """How much of the time that engaging takes one hand has been held up, 0 to 1."""
    disengaging: float
    """How much of the time that disengaging takes both hands have been held up, 0 to 1."""


class PoseEstimator:
    """Turns each frame of a stream into the pose of the operator: of them alone, and only when that is sure.

    Several people are followed; one becomes the operator by engaging (``PoseConfig.operator``), and stays it
    through crossings and short absences. What the estimator sees besides is there to be shown: ``people``,
    ``operator``, and in ``why`` the reason for a frame without a pose.

    Args:
        config: Options; the defaults suit an RGB-D camera on a drone, 2 to 8 m from the person.
        tracker: What finds bodies; BlazePose by default. One that finds several people (``PeopleFinder``) is
            asked for them; one that only follows a single body (any ``wigwag.pose.engine.PoseEngine``) is
            taken by its word, and made to search anew when that body is not the operator's.

    Raises:
        ModelError: If a network file is missing and cannot be fetched, or is damaged.
    """

    def __init__(
        self, config: PoseConfig | None = None, tracker: PeopleFinder | BodyTracker | None = None
    ) -> None:
        self.config = config = config or PoseConfig()
        self._in_space = InSpace(config.lift, config.monocular, config.head)
        self._people = People(config.people, config.engagement, config.sides)
        self._keeper = OperatorKeeper(config.operator, self._people)
        self._shift = PictureShift()
        self._steady = Steadier(config.steady)
        eyes = tracker or BlazePose(config.blazepose)
        self._watcher = Watcher(eyes, config.watch, self.lift, self._people, self._keeper)
        self.body: Body | None = None
        """The operator in the latest frame's colour picture, or while there is none, whoever is known longest
        (for drawing); ``None``: not seen."""
        self.reset()

    def reset(self) -> None:
        """Forget everybody and when the last frame was."""
        self._watcher.reset()
        self._people.reset()
        self._keeper.reset()
        self._shift.reset()
        self.body = None
        self._steady.reset()
        self._stamp_ns: int | None = None

    @property
    def people(self) -> tuple[Person, ...]:
        """Everybody who is kept in mind, the longest known first."""
        return tuple(self._person(track) for track in self._people.tracks)

    @property
    def operator(self) -> Person | None:
        """Who commands, also while not seen; ``None``: nobody."""
        track = self._keeper.track
        return None if track is None else self._person(track)

    @property
    def why(self) -> str:
        """Why the latest frame gave no pose, for people to read; empty if it gave one."""
        if self._keeper.why and self._watcher.unplaced is not None:
            return "the depth of who is there cannot be told"
        return self._keeper.why

    def call_operator(self) -> None:
        """Make whoever is seen alone within the next second the operator, without their raising a hand.

        For a word from the console. Of several people nobody becomes it, and who is the operator stays it.
        """
        self._keeper.call()

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the operator's pose, or ``None``: see ``why``.

        Raises:
            InputError: If the frame has no depth, or is not later than the one before.
        """
        self._check(frame)
        shift_px = self._shift(frame.rgb)
        self._people.begin(frame.stamp_ns, self._keeper.track, shift_px, frame.intrinsics)
        self._keeper.begin(frame)
        self._watcher(frame)
        track = self._keeper.decide(frame.stamp_ns)
        shown = self._keeper.track or next(iter(self._people.tracks), None)
        self.body = self._watcher.unplaced if shown is None or shown.body is None else shown.body
        if track is None or track.pose is None:
            return None
        return self._steady(track.pose, track.number)

    def _check(self, frame: Frame) -> None:
        if frame.depth_mm is None and self.config.monocular is None:
            raise InputError(
                "Frame.depth_mm is None, but a 3-D pose needs depth in millimetres aligned to the colour "
                "picture. Use a camera with depth and align it to colour, or allow poses without it by "
                "PoseConfig.monocular."
            )
        if self._stamp_ns is not None and frame.stamp_ns <= self._stamp_ns:
            raise InputError(
                f"Frame.stamp_ns must grow from frame to frame, but {frame.stamp_ns} follows "
                f"{self._stamp_ns}. Call reset() before another stream."
            )
        self._stamp_ns = frame.stamp_ns

    def lift(self, body: Body, frame: Frame) -> Pose | None:
        """Place a body in space by the frame's depth; ``None`` if there is no depth where the person is."""
        return self._in_space(body, frame)

    def _person(self, track: Track) -> Person:
        return Person(
            track.number, track is self._keeper.track, track.body, track.pose, track.position_m,
            track.seen_ns, track.engagement.progress, track.engagement.release_progress,
        )  # fmt: skip


__all__ = ["BodyTracker", "PeopleFinder", "Person", "PoseConfig", "PoseEstimator"]
