"""Where the networks look in each frame: at the operator always, at others and for newcomers now and then."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import UInt8

from wigwag.camera.frame import Frame
from wigwag.pose.appearance import appearance_of
from wigwag.pose.body import Body
from wigwag.pose.landmarker import Sighting
from wigwag.pose.operator import Claim, OperatorKeeper
from wigwag.pose.people import People, Seen, Track
from wigwag.pose.region import Region
from wigwag.pose.search import AROUND, Search
from wigwag.skeleton import Pose

Picture = UInt8[np.ndarray, "height width 3"]
Lift = Callable[[Body, Frame], Pose | None]
"""Turns a body into a pose, or into ``None`` where its depth cannot be told."""


@runtime_checkable
class BodyTracker(Protocol):
    """Anything that finds one body in each picture of a stream."""

    def track(self, rgb: Picture) -> Body | None:
        """Return the body in the next picture, or ``None``."""
        ...

    def reset(self) -> None:
        """Forget whom it follows."""
        ...


@runtime_checkable
class PeopleFinder(Protocol):
    """Anything that finds several bodies and follows each, as ``wigwag.pose.blazepose.BlazePose`` does."""

    def find(
        self, rgb: Picture, regions: Sequence[Region], *, most: int = 1, known: Sequence[Region] = ()
    ) -> list[Sighting]:
        """Return people in some regions, surest first, but nobody of whom it is known where they are."""
        ...

    def follow(self, rgb: Picture, region: Region) -> Sighting | None:
        """Return the person in a region, or ``None``."""
        ...


@dataclass(frozen=True, slots=True)
class WatchConfig:
    """How much is looked at. Following one person takes one run of the landmark network a frame."""

    others_every: int = 6
    """While somebody is the operator, one of the others is looked at in every so many frames ..."""
    close_every: int = 2
    """... but in every so many, if one of them comes close to the operator."""
    newcomers_every: int = 15
    """While somebody is the operator, one region is searched for newcomers in every so many frames ..."""
    unengaged_every: int = 5
    """... and in every so many frames, while nobody is but somebody is there."""
    stale_s: float = 0.5
    """Whoever was not seen for so long is detected anew around where they should be: one run of the landmark
    network in a region of long ago shows a crooked body, which looks like somebody else."""
    doubtful: float = 0.6
    """An operator of a lower ``Body.clarity`` is detected anew in every third frame."""
    patience_frames: int = 2
    """A tracker of one body that shows somebody else for so many frames in a row is made to search anew."""


class Watcher:
    """Looks at each frame, and gives every look to whose it is.

    Args:
        eyes: What finds bodies: several (``PeopleFinder``) or one (``BodyTracker``).
        config: How much is looked at.
        lift: Turns a body into a pose.
        people: Everybody in the picture.
        keeper: Who the operator is.
    """

    def __init__(
        self,
        eyes: PeopleFinder | BodyTracker,
        config: WatchConfig,
        lift: Lift,
        people: People,
        keeper: OperatorKeeper,
    ) -> None:
        self.config = config
        self._eyes, self._lift, self._people, self._keeper = eyes, lift, people, keeper
        self._begin()

    def reset(self) -> None:
        """Begin another stream."""
        self._begin()
        if isinstance(self._eyes, BodyTracker):
            self._eyes.reset()

    def _begin(self) -> None:
        self._plan = Search(runs=1)
        self._frame_count = self._search_count = self._strangers = self._doubted = 0
        self.unplaced: Body | None = None
        """Seen in the frame in hand, but depth does not tell where they are."""

    def __call__(self, frame: Frame) -> None:
        """Look at the next frame."""
        self._frame_count += 1
        self.unplaced = None
        if not isinstance(self._eyes, PeopleFinder):
            self._watch_one(frame, self._eyes)
        elif self._keeper.track is not None:
            self._watch_operator(frame, self._eyes, self._keeper.track)
        else:
            self._watch_all(frame, self._eyes)

    def _watch_one(self, frame: Frame, eyes: BodyTracker) -> None:
        """Take what a tracker of one body gives."""
        body = eyes.track(frame.rgb)
        if body is None:
            return
        hips, above = body.hip_center_px, body.points_px[[11, 12]].mean(axis=0)
        region = Region.around(hips, hips + 1.9 * (above - hips))
        owner = self._take(Sighting(body, region), frame)
        if self._keeper.track is None or owner is self._keeper.track:
            self._strangers = 0
            return
        self._strangers += 1
        if self._strangers >= self.config.patience_frames:
            eyes.reset()
            self._strangers = 0

    def _watch_operator(self, frame: Frame, eyes: PeopleFinder, operator: Track) -> None:
        keeper, people, now = self._keeper, self._people, frame.stamp_ns
        owner = None
        if keeper.cover.nearer < keeper.config.gone and not keeper.cover.outside and not keeper.away:
            region = keeper.region(now, frame.intrinsics)
            sighting = eyes.follow(frame.rgb, region)
            if sighting is not None:
                sighting = self._second_look(frame, eyes, sighting)
                owner = self._take(sighting, frame)
        if owner is not operator:
            self._search(frame, eyes, operator)
        elif self._frame_count % self.config.newcomers_every == 0:
            self._search(frame, eyes, None)
        others = [track for track in people.tracks if track is not operator and track.body is None]
        close = bool(people.close_to(operator, now))
        every = self.config.close_every if close else self.config.others_every
        if others and self._frame_count % every == 0:
            self._look_at(min(others, key=lambda track: track.looked_ns), frame, eyes)

    def _watch_all(self, frame: Frame, eyes: PeopleFinder) -> None:
        tracks = self._people.tracks
        if tracks:
            self._look_at(min(tracks, key=lambda track: track.looked_ns), frame, eyes)
        if not tracks or self._frame_count % self.config.unengaged_every == 0:
            self._search(frame, eyes, None)

    def _look_at(self, track: Track, frame: Frame, eyes: PeopleFinder) -> None:
        track.looked_ns = frame.stamp_ns
        coast_s = self._people.config.coast_s
        region = track.expected_region(frame.stamp_ns, coast_s, frame.intrinsics)
        if track.age_s(frame.stamp_ns) > self.config.stale_s:
            found = eyes.find(frame.rgb, [region.wider(AROUND)])
            sighting = found[0] if found else None
        else:
            sighting = eyes.follow(frame.rgb, region)
        if sighting is not None:
            self._take(sighting, frame)

    def _second_look(self, frame: Frame, eyes: PeopleFinder, sighting: Sighting) -> Sighting:
        """Detect a doubtful body anew now and then, so that one that went wrong comes right again."""
        if sighting.clarity >= self.config.doubtful:
            self._doubted = 0
            return sighting
        self._doubted += 1
        if self._doubted % 3 != 1:
            return sighting
        found = eyes.find(frame.rgb, [sighting.region.wider(AROUND)])
        better = found and found[0].clarity > sighting.clarity
        return found[0] if better else sighting

    def _search(self, frame: Frame, eyes: PeopleFinder, missing: Track | None) -> None:
        """Search around a missing operator in every other frame, else the next of all crops."""
        now, people = frame.stamp_ns, self._people
        self._search_count += 1
        known = [track.seen.region for track in people.tracks if track.body is not None]
        if missing is not None and self._search_count % 2:
            where = [self._keeper.region(now, frame.intrinsics).wider(AROUND)]
        else:
            height, width = frame.rgb.shape[:2]
            where = self._plan.plan(width, height)
            if not people.tracks:  # nobody costs anything yet
                where += self._plan.plan(width, height)
        most = 2 if missing is not None else 1
        for sighting in eyes.find(frame.rgb, where, most=most, known=known):
            self._take(sighting, frame)

    def _take(self, sighting: Sighting, frame: Frame) -> Track | None:
        """Give a look to whose it is; return whose."""
        people, keeper, now = self._people, self._keeper, frame.stamp_ns
        seen = self._seen(sighting, frame)
        if seen is None:
            return None
        operator = keeper.track
        if operator is not None and operator.body is None:
            claim = keeper.claim(seen, now)
            if claim is not Claim.NO:
                self._show(operator, seen, frame)
                return operator
        if people.is_known(seen):
            return None
        others = [track for track in people.tracks if track is not operator and track.body is None]
        owner = people.owner(seen, now, others)
        if owner is not None:
            people.update(owner, seen, now)
        elif keeper.away or people.may_be_new(seen, now, operator):
            owner = people.add(seen, now)
        if owner is not None:
            owner.looked_ns = now
            self._show(owner, seen, frame)
        return owner

    def _seen(self, sighting: Sighting, frame: Frame) -> Seen | None:
        body = sighting.body
        if not np.isfinite(body.points_px).all():
            return None
        pose = self._lift(body, frame)
        if pose is None:
            self.unplaced = body
            return None
        distance_m = float(pose.hip_center[2])
        appearance = appearance_of(frame.rgb, frame.depth_mm, body, distance_m)
        seen = Seen(body, sighting.region, pose, appearance)
        return seen if seen.coherent(self._people.config) else None

    def _show(self, track: Track, seen: Seen, frame: Frame) -> None:
        """Put what is seen of somebody into the frame in hand, left and right as they were."""
        track.body = track.sides(seen.body, frame.stamp_ns)
        track.pose = seen.pose if track.body is seen.body else self._lift(track.body, frame)
        track.seen = replace(seen, body=track.body)


__all__ = ["BodyTracker", "Lift", "PeopleFinder", "WatchConfig", "Watcher"]
