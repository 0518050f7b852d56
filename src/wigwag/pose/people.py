"""Everybody in the picture: where each is, moves to, how large and of which clothes, and who was seen now."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Intrinsics
from wigwag.pose.appearance import Appearance
from wigwag.pose.body import Body
from wigwag.pose.engagement import Engagement, EngagementConfig
from wigwag.pose.region import Region
from wigwag.pose.sides import SideKeeper, SidesConfig
from wigwag.pose.turning import turned
from wigwag.skeleton import Landmark, Pose

_SHOULDERS = [Landmark.LEFT_SHOULDER, Landmark.RIGHT_SHOULDER]
_HIPS = [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]
_LEARN_VELOCITY_S = 0.5
"""Time constant with which a velocity follows what is measured: slow enough for the noise of depth at 8 m."""
_FASTEST_M_S = 2.5


@dataclass(frozen=True, slots=True)
class PeopleConfig:
    """Who can be whom from one look to the next. Positions are those of the middle of the hips."""

    most: int = 4
    """At most so many people are kept in mind."""
    range_slack_m: float = 0.3
    """How far somebody's distance from the camera may be off what is expected ..."""
    range_slack_share: float = 0.012
    """... plus this share of the distance: depth errs more from afar ..."""
    range_drift_m_s: float = 0.8
    """... plus this for every second without a look, up to ``most_drift_m``."""
    side_slack_m: float = 0.4
    """The same across the line of sight ..."""
    side_speed_m_s: float = 5.0
    """... for the first tenth of a second: people run, and what the camera's turning leaves ..."""
    side_drift_m_s: float = 1.2
    """... and from then on."""
    jump_m: float = 0.1
    """How far hips may seem to jump aside from frame to frame, besides what people run, while somebody else
    is close: more is a mixture of both bodies. Of people who stand or walk they do by 0.05 m at most."""
    most_drift_m: float = 1.2
    """What is expected is not doubted by more, however long it is ago."""
    size_slack: float = 0.35
    """A torso's length may be off its usual one by this (logarithm): more is another or a wrong body."""
    fold_slack: float = 0.75
    """But so much shorter may be seen of who is followed without a break, nobody else close: who sits down or
    bends has their hips behind their thighs. Nobody's torso grows."""
    unlike: float = 2.5
    """People whose ``Appearance.difference`` is greater are not the same one."""
    hips_apart_m: float = 0.45
    """Hips whose depths differ by more belong to two people, or to one and the wall."""
    mixed_m: float = 0.6
    """Nobody new is so close to where the operator should be: that is a mixture of two bodies."""
    torso_m: tuple[float, float] = (0.28, 0.85)
    """Shortest and longest torso of a person."""
    coast_s: float = 0.7
    """Time constant with which somebody unseen is expected to slow down."""
    forget_s: float = 2.0
    """Whoever was not seen for so long is forgotten (but for the operator)."""


@dataclass(frozen=True, slots=True)
class Seen:
    """One look at somebody: what the network said, and where that is in space."""

    body: Body
    region: Region
    pose: Pose
    """As lifted; sides as the network gave them."""
    appearance: Appearance | None = None

    @property
    def position_m(self) -> Float[np.ndarray, " 3"]:
        """Middle of the hips, camera optical frame."""
        return self.pose.hip_center

    @property
    def torso_m(self) -> float:
        """From the middle of the shoulders to the middle of the hips, metres."""
        joints = self.pose.joints
        return float(np.linalg.norm(joints[_SHOULDERS].mean(axis=0) - joints[_HIPS].mean(axis=0)))

    def coherent(self, config: PeopleConfig) -> bool:
        """Say whether this can be one person's trunk."""
        left, right = self.pose.joints[_HIPS]
        low, high = config.torso_m
        return abs(float(left[2] - right[2])) < config.hips_apart_m and low < self.torso_m < high


@dataclass(slots=True)
class Track:
    """One person who is kept in mind. ``People`` alone changes it."""

    number: int
    """Who, for as long as they are kept in mind; never given twice."""
    seen: Seen
    """The latest look that was theirs."""
    region: Region
    """Where in the picture that was, moved along as the camera has turned since."""
    seen_ns: int
    position_m: Float[np.ndarray, " 3"]
    """Middle of the hips when seen last, in the camera's optical frame as it is turned now."""
    torso_m: float
    sides: SideKeeper
    engagement: Engagement
    velocity_m_s: Float[np.ndarray, " 3"] = field(default_factory=lambda: np.zeros(3))
    appearance: Appearance | None = None
    looks: int = 1
    looked_ns: int = 0
    """When they were last looked for."""
    pose: Pose | None = None
    """Of the frame in hand, sides kept; ``None``: not seen in it."""
    body: Body | None = None
    """Of the frame in hand, sides kept."""

    def age_s(self, now_ns: int) -> float:
        """Seconds since they were seen."""
        return (now_ns - self.seen_ns) * 1e-9

    def expected_m(self, now_ns: int, coast_s: float) -> Float[np.ndarray, " 3"]:
        """Return where they should be now: they go on as they went, and ever slower."""
        going_s = coast_s * (1.0 - math.exp(-max(self.age_s(now_ns), 0.0) / coast_s))
        ahead = self.position_m + self.velocity_m_s * going_s
        ahead[2] = max(ahead[2], 0.3)
        return np.asarray(ahead)

    def expected_region(self, now_ns: int, coast_s: float, intrinsics: Intrinsics) -> Region:
        """Return where in the picture to look for them now."""
        ahead, last, region = self.expected_m(now_ns, coast_s), self.position_m, self.region
        if self.age_s(now_ns) < 0.1 or last[2] <= 0:
            return region
        shift = intrinsics.project(ahead) - intrinsics.project(last)
        nearer = float(last[2] / ahead[2])
        return Region(region.u + shift[0], region.v + shift[1], region.side * nearer, region.angle_rad)


class People:
    """Keeps people in mind and says who it is that was seen.

    A look belongs to whom it fits best in space, size and clothes; what fits nobody is somebody new.

    Args:
        config: Who can be whom.
        engagement: When a posture counts as held.
        sides: When a change of left and right is not believed.
    """

    def __init__(
        self,
        config: PeopleConfig | None = None,
        engagement: EngagementConfig | None = None,
        sides: SidesConfig | None = None,
    ) -> None:
        self.config = config or PeopleConfig()
        self._engagement, self._sides = engagement, sides
        self._next = 1
        self.tracks: list[Track] = []
        """Everybody kept in mind, the longest known first."""

    def reset(self) -> None:
        """Forget everybody; numbers go on."""
        self.tracks = []

    def begin(
        self, now_ns: int, keep: Track | None, shift_px: tuple[float, float], intrinsics: Intrinsics
    ) -> None:
        """Begin a frame: nobody is seen in it yet, and whoever was not seen for long is forgotten.

        Args:
            now_ns: The frame's stamp.
            keep: Is not forgotten (the operator).
            shift_px: How far the picture has moved to the right and down, because the camera turned.
            intrinsics: The camera's.
        """
        forget_s = self.config.forget_s
        self.tracks = [t for t in self.tracks if t is keep or t.age_s(now_ns) <= forget_s]
        for track in self.tracks:
            track.pose = track.body = None
            track.position_m = turned(track.position_m, shift_px, intrinsics)
            track.velocity_m_s = turned(track.velocity_m_s, shift_px, intrinsics)
            u, v = track.region.u + shift_px[0], track.region.v + shift_px[1]
            track.region = replace(track.region, u=u, v=v)

    def misfit(self, track: Track, seen: Seen, now_ns: int, nearer_slack_m: float = math.inf) -> float:
        """Return how badly a look fits somebody in space: 0 as expected, infinite if it cannot be them.

        Args:
            track: Who it may be.
            seen: The look.
            now_ns: Its stamp.
            nearer_slack_m: A tighter limit to how much nearer than expected they may be.
        """
        c = self.config
        expected, found = track.expected_m(now_ns, c.coast_s), seen.position_m
        age_s = track.age_s(now_ns)
        distance, measured = float(np.linalg.norm(expected)), float(np.linalg.norm(found))
        drift = min(c.range_drift_m_s * age_s, c.most_drift_m)
        deep = c.range_slack_m + c.range_slack_share * distance + drift
        if measured < distance:
            deep = min(deep, nearer_slack_m)
        wide = c.side_slack_m + c.side_speed_m_s * min(age_s, 0.1)
        wide += min(c.side_drift_m_s * max(age_s - 0.1, 0.0), c.most_drift_m)
        off_deep = abs(measured - distance)
        off_wide = float(np.linalg.norm(found * (distance / max(measured, 1e-6)) - expected))
        worst = max(off_deep / deep, off_wide / wide)
        return worst if worst < 1.0 else math.inf

    def jumps(self, track: Track, seen: Seen, now_ns: int) -> bool:
        """Say whether somebody who is followed would have jumped aside to be here, faster than people run."""
        expected, found = track.expected_m(now_ns, self.config.coast_s), seen.position_m
        at_their_distance = found * (
            float(np.linalg.norm(expected)) / max(float(np.linalg.norm(found)), 1e-6)
        )
        aside = float(np.linalg.norm(at_their_distance - expected))
        return aside > self.config.jump_m + _FASTEST_M_S * track.age_s(now_ns)

    def sized_like(self, track: Track, seen: Seen, *, folded: bool = False) -> bool:
        """Say whether a look can be of somebody's size, or of them ``folded``: sitting or bent."""
        longer = math.log(max(seen.torso_m, 1e-3) / track.torso_m)
        return (
            -(self.config.fold_slack if folded else self.config.size_slack) < longer < self.config.size_slack
        )

    def looks_like(self, track: Track, appearance: Appearance | None) -> bool:
        """Say whether somebody of this appearance can be who is kept in mind; what is not known may be."""
        if appearance is None or track.appearance is None:
            return True
        return track.appearance.difference(appearance) <= self.config.unlike

    def owner(self, seen: Seen, now_ns: int, candidates: Iterable[Track]) -> Track | None:
        """Return whom a look fits best, or ``None`` if it fits nobody.

        Who walks by is seen from the side, half hidden and cut off by the picture's edge: clothes are asked
        about only after a while without a look.
        """
        fits = [(self.misfit(track, seen, now_ns), track.number, track) for track in candidates]
        fits = [
            (worst, number, track)
            for worst, number, track in fits
            if worst < 1.0 and (track.age_s(now_ns) < 1.0 or self.looks_like(track, seen.appearance))
        ]
        return min(fits)[2] if fits else None

    def is_known(self, seen: Seen) -> bool:
        """Say whether this is somebody who was seen in this frame already."""
        return any(
            track.body is not None and _overlap(track.seen, seen, self.config) for track in self.tracks
        )

    def add(self, seen: Seen, now_ns: int) -> Track | None:
        """Keep somebody new in mind, unless there are too many already or they are known."""
        if len(self.tracks) >= self.config.most or self.is_known(seen):
            return None
        track = Track(
            self._next, seen, seen.region, now_ns, seen.position_m, seen.torso_m, SideKeeper(self._sides),
            Engagement(self._engagement), appearance=seen.appearance,
        )  # fmt: skip
        self._next += 1
        self.tracks.append(track)
        return track

    def update(
        self,
        track: Track,
        seen: Seen,
        now_ns: int,
        *,
        learn: bool = True,
        hidden: bool = False,
        touched: bool = False,
    ) -> None:
        """Take a look as somebody's.

        Args:
            track: Whose it is.
            seen: The look.
            now_ns: Its stamp.
            learn: Whether size and clothes are learned from it: not if somebody else is close.
            hidden: Whether a part of them is hidden. Whoever hides them lends their depth then: only the
                direction is taken over, not the distance, and nothing is learned about speed.
            touched: Whether somebody begins to hide them, or ceases to: the distance is taken over no faster
                than people run, and nothing is learned about speed.
        """
        age_s = track.age_s(now_ns)
        position = seen.position_m
        if hidden or touched:
            measured = max(float(np.linalg.norm(position)), 1e-6)
            distance = float(np.linalg.norm(track.expected_m(now_ns, self.config.coast_s)))
            most = 0.0 if hidden else _FASTEST_M_S * max(age_s, 0.0)
            position = position * (distance + min(max(measured - distance, -most), most)) / measured
        elif 0.0 < age_s < 1.0:
            expected = track.expected_m(now_ns, self.config.coast_s)
            share = 1.0 - math.exp(-age_s / _LEARN_VELOCITY_S)
            surprise = (seen.position_m - expected) / age_s
            track.velocity_m_s = track.velocity_m_s + share * surprise
            speed = float(np.linalg.norm(track.velocity_m_s))
            track.velocity_m_s *= min(1.0, _FASTEST_M_S / max(speed, 1e-6))
        if age_s >= 1.0:
            track.velocity_m_s = np.zeros(3)
        track.position_m, track.seen_ns = position, now_ns
        track.seen, track.region = seen, seen.region
        track.looks += 1
        if not learn:
            return
        # The first looks count alike; later ones change what is known slowly.
        share = max(1.0 / track.looks, 0.01)
        if self.sized_like(track, seen):
            track.torso_m *= math.exp(share * math.log(max(seen.torso_m, 1e-3) / track.torso_m))
        if seen.appearance is not None:
            known = track.appearance
            track.appearance = known.towards(seen.appearance, share) if known else seen.appearance

    def away_m(self, track: Track, seen: Seen, now_ns: int) -> float:
        """Return how far a look is from where somebody is expected, metres."""
        return float(np.linalg.norm(seen.position_m - track.expected_m(now_ns, self.config.coast_s)))

    def may_be_new(self, seen: Seen, now_ns: int, operator: Track | None) -> bool:
        """Say whether a look that fits nobody is somebody new, and not the operator seen badly.

        Where two people overlap in the picture, the network mixes them into one who stands between them.
        """
        return operator is None or self.away_m(operator, seen, now_ns) > self.config.mixed_m

    def close_to(self, track: Track, now_ns: int) -> list[Track]:
        """Return everybody else who is, or soon will be, before, behind or beside somebody in the picture."""
        coast_s = self.config.coast_s
        mine = track.expected_m(now_ns, coast_s)
        near = []
        for other in self.tracks:
            if other is track:
                continue
            theirs = other.expected_m(now_ns, coast_s) + 0.4 * other.velocity_m_s
            across = abs(theirs[0] / max(theirs[2], 0.3) - mine[0] / mine[2]) * mine[2]
            if across < 1.3:
                near.append(other)
        return near


def _overlap(one: Seen, other: Seen, config: PeopleConfig) -> bool:
    """Say whether two looks of one frame show the same person."""
    apart = float(np.linalg.norm(one.position_m - other.position_m))
    return apart < 0.35 or one.region.resembles(other.region)


__all__ = ["People", "PeopleConfig", "Seen", "Track"]
