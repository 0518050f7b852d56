"""Poses become steady without becoming late: a filter in space, landmark by landmark.

Swings and the person's own movement are filtered apart. What the limbs do, seen from the hips, goes through a
low-pass whose cutoff grows with speed (One-Euro; Casiez, Roussel, Vogel, CHI 2012): it has no momentum, so it
cannot overshoot, and it opens as soon as something moves. The hips go through a Kalman filter of constant
velocity: who walks is followed without lag. Both know how sure each landmark is along the line of sight,
where depth errs, and across it, where the picture is exact, and smooth each by its own measure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from wigwag.errors import InputError
from wigwag.skeleton import N_LANDMARKS, Landmark, Pose

_EXACT_M = 0.012
"""Across the line of sight at full visibility; nothing is taken as surer than this."""
_UNSEEN_M = 0.075
"""Across the line of sight at visibility 0; see ``wigwag.pose.uncertainty``."""
_AXIS = np.array([0.0, 0.0, 1.0])
_HIPS = [Landmark.LEFT_HIP, Landmark.RIGHT_HIP]
_NOISE = 5.0
"""What lies within so many standard deviations of the filtered place is noise, however fast it came."""
_WALKING_M_S = 1.0
"""How fast the hips may move when nothing is known yet: one standard deviation."""


@dataclass(frozen=True, slots=True)
class FilterConfig:
    """How poses are smoothed. Chosen on training people (see ``wigwag benchmark smooth``).

    Raises:
        InputError: If a value is out of range; the message names it.
    """

    rest_hz: float = 1.0
    """Cutoff for a landmark at rest that is as sure as can be; one that is n times less sure has an nth."""
    per_speed_hz: float = 12.0
    """By how much the cutoff grows with speed, hertz over metres a second."""
    speed_hz: float = 3.0
    """Cutoff of the speed that opens it."""
    hips_acceleration_m_s2: float = 8.0
    """How the hips may accelerate, seen from a camera that moves as well: one standard deviation."""
    distance_acceleration_m_s2: float = 2.0
    """The same along the line of sight without depth, where the distance jitters by a share of itself."""
    jump_m_s2: float = 300.0
    """A landmark that would have to accelerate more than this (throws of UTD-MHAD reach 100 to 200) ..."""
    jump_m: float = 0.15
    """... and stands farther than this from where it should be, has jumped: it is not believed at once."""
    insist_s: float = 0.04
    """A landmark that has not come back after this time is believed where it jumped to: it is more often the
    network that had lost an arm than the arm that is lost."""
    carry_s: float = 0.1
    """Time constant with which the speed of a landmark that is not measured dies away."""
    drift_m_s: float = 0.5
    """How fast the uncertainty of a landmark grows that is not measured."""
    most_sigma_m: float = 1.0
    """The uncertainty does not grow beyond this."""
    forget_s: float = 0.5
    """After a gap this long the filter begins anew."""

    def __post_init__(self) -> None:
        """Check ranges once, where the configuration enters."""
        for name in self.__slots__:
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"FilterConfig.{name} must be above 0, but got {getattr(self, name)}.")


class PoseFilter:
    """Smooths the poses of one person.

    Args:
        config: How much.

    Example:
        >>> import numpy as np
        >>> smooth = PoseFilter()
        >>> depth_m = 4.0 + np.random.default_rng(0).normal(0.0, 0.05, (60, 13))
        >>> poses = [
        ...     Pose(np.outer(z, [0, 0, 1]), np.ones(13), k * 33_333_333, np.full(13, 0.05))
        ...     for k, z in enumerate(depth_m)
        ... ]
        >>> steady = np.array([smooth(pose).joints[5, 2] for pose in poses])
        >>> bool(steady[30:].std() < 0.7 * 0.05)
        True
    """

    def __init__(self, config: FilterConfig | None = None) -> None:
        self.config = config or FilterConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the person, as when another one is followed."""
        self._stamp_ns: int | None = None
        self._hips = Walker(self.config)
        self._limbs = Limbs(self.config)

    def __call__(self, pose: Pose) -> Pose:
        """Return the pose smoothed, with the uncertainty that is left.

        The first pose, and one after a gap of ``forget_s``, comes back as it is. A pose that is not newer
        than the last one comes back as it is and changes nothing.

        Args:
            pose: As measured; ``sigma_m`` 0 counts as surely seen.
        """
        step_s = self.config.forget_s
        if self._stamp_ns is not None:
            step_s = (pose.stamp_ns - self._stamp_ns) * 1e-9
            if step_s <= 0.0:
                return pose
            if step_s > self.config.forget_s:
                self.reset()
        self._stamp_ns = pose.stamp_ns
        along, across = _own_sigmas(pose)
        hips = pose.hip_center
        distance = float(np.linalg.norm(hips))
        hips_sigma = np.array([across[_HIPS].mean(), np.hypot(along[_HIPS].mean(), pose.distance_sigma_m)])
        may = self.config.hips_acceleration_m_s2
        away = self.config.distance_acceleration_m_s2 if pose.monocular else may
        hips_m = self._hips.update(hips, _directions(hips), hips_sigma, np.array([may, away]), step_s)
        joints = pose.joints
        if pose.monocular and distance > 0.0:
            # Without depth the body's size jitters with its distance: it is put to the smoothed one.
            joints = joints * (np.linalg.norm(hips_m) / distance)
        sights = _directions(pose.joints)
        limbs_m = self._limbs.update(joints - hips_m, sights, np.stack([across, along]), step_s)
        sigma_m = np.hypot(self._limbs.sigma_m, pose.distance_sigma_m)
        return replace(pose, joints=hips_m + limbs_m, sigma_m=sigma_m)


class Jumps:
    """Tells points that jumped from points that move, by what acceleration it would take.

    Args:
        count: How many points.
        config: What a jump is.
    """

    def __init__(self, count: int, config: FilterConfig) -> None:
        self._config = config
        self._last = np.zeros((count, 3))
        self._velocity = np.zeros((count, 3))
        self._since_s = np.full(count, np.inf)

    def judge(
        self,
        points: Float[np.ndarray, "points 3"],
        doubtful: Bool[np.ndarray, " points"],
        step_s: float,
    ) -> tuple[Bool[np.ndarray, " points"], Bool[np.ndarray, " points"]]:
        """Say which points count, and which of them begin anew.

        Finite points count that did not jump, or stay where they jumped to. The latter, and those never seen
        before, begin anew: nothing is known of their speed.

        Args:
            points: As measured.
            doubtful: Which lie too far from the filtered ones to be noise; no other can have jumped.
            step_s: Seconds since the points before.
        """
        config = self._config
        there = np.isfinite(points).all(axis=1)
        points = np.where(there[:, None], points, self._last)
        self._since_s += step_s
        known = np.isfinite(self._since_s)
        since = np.where(known, self._since_s, 1.0)[:, None]
        off = np.linalg.norm(points - self._last - self._velocity * since, axis=1)
        limit = max(config.jump_m, config.jump_m_s2 * step_s**2)
        jumped = known & doubtful & (off > limit)
        counts = there & ~(jumped & (self._since_s <= config.insist_s))
        anew = counts & (jumped | ~known)
        moved = np.where(anew[:, None], 0.0, (points - self._last) / since)
        self._velocity = np.where(counts[:, None], moved, self._velocity)
        self._last = np.where(counts[:, None], points, self._last)
        self._since_s = np.where(counts, 0.0, self._since_s)
        return counts, anew


class Limbs:
    """The landmarks seen from the hips: a One-Euro filter in space, by its own measure along the sight.

    Args:
        config: How much is smoothed.
        count: How many landmarks.
    """

    def __init__(self, config: FilterConfig, count: int = N_LANDMARKS) -> None:
        self._config = config
        self._jumps = Jumps(count, config)
        self._place = np.zeros((count, 3))
        self._velocity = np.zeros((count, 3))
        self.sigma_m = np.full(count, config.most_sigma_m)
        """One standard deviation of what is returned. Averaging does not lower it, as what a pose network
        errs by lasts. It grows while a landmark is not measured."""

    def update(
        self,
        points: Float[np.ndarray, "count 3"],
        sights: Float[np.ndarray, "count 3"],
        sigma: Float[np.ndarray, "2 count"],
        step_s: float,
    ) -> Float[np.ndarray, "count 3"]:
        """Take in the landmarks and return them filtered.

        Args:
            points: Metres; a row that is not finite is a landmark that was not measured.
            sights: Unit vectors of the lines of sight.
            sigma: One standard deviation of each, metres, across the line of sight and along it.
            step_s: Seconds since the landmarks before.
        """
        config = self._config
        surprise = np.where(np.isfinite(points), points - self._place, 0.0)
        ahead = (surprise * sights).sum(axis=1)
        aside = (surprise**2).sum(axis=1) - ahead**2
        doubtful = aside / sigma[0] ** 2 + (ahead / sigma[1]) ** 2 > _NOISE**2
        counts, anew = self._jumps.judge(points, doubtful, step_s)

        sure = _EXACT_M / sigma
        share = _share(config.speed_hz * sure, step_s) * counts
        velocity = self._velocity + _scaled(surprise / step_s - self._velocity, sights, share)
        speed = np.linalg.norm(velocity, axis=1)
        share = _share((config.rest_hz + config.per_speed_hz * speed) * sure, step_s)
        # A place less than half as sure as the measurement, as after a hole, gives way to it at once.
        stale, fresh = self.sigma_m**2, 4.0 * sigma[1] ** 2
        share = np.where(anew, 1.0, np.maximum(share, (stale - fresh) / (stale + fresh))) * counts
        fades = np.exp(-step_s / config.carry_s)
        carried = config.carry_s * (1.0 - fades) * self._velocity
        self._place = self._place + np.where(counts[:, None], _scaled(surprise, sights, share), carried)
        self._velocity = np.where(counts[:, None], velocity, fades * self._velocity)
        self._velocity[anew] = 0.0
        grown = np.minimum(self.sigma_m + config.drift_m_s * step_s, config.most_sigma_m)
        mixed = np.sqrt((1.0 - share[1]) * stale + share[1] * sigma[1] ** 2)
        self.sigma_m = np.where(counts, mixed, grown)
        return self._place


class Walker:
    """The hips: a Kalman filter of constant velocity, along the line of sight and across it.

    Args:
        config: What a jump is.
    """

    def __init__(self, config: FilterConfig) -> None:
        self._jumps = Jumps(1, config)
        self._place = np.zeros(3)
        self._velocity = np.zeros(3)
        self._variance = np.zeros((3, 2))
        """Of place, of both, of velocity; across the sight and along it."""

    def update(
        self,
        point: Float[np.ndarray, " 3"],
        sight: Float[np.ndarray, " 3"],
        sigma: Float[np.ndarray, " 2"],
        acceleration: Float[np.ndarray, " 2"],
        step_s: float,
    ) -> Float[np.ndarray, " 3"]:
        """Take in the middle of the hips and return it filtered.

        Args:
            point: Metres.
            sight: Unit vector of the line of sight.
            sigma: One standard deviation, metres, across the line of sight and along it.
            acceleration: How the hips may accelerate, metres a second squared, likewise.
            step_s: Seconds since the one before.
        """
        place = self._place + step_s * self._velocity
        p, both, v = self._variance
        noise = acceleration**2
        p = p + 2.0 * step_s * both + step_s**2 * v + 0.25 * noise * step_s**4
        both = both + step_s * v + 0.5 * noise * step_s**3
        v = v + noise * step_s**2
        surprise = point - place
        expected = p + sigma**2
        ahead = surprise @ sight
        aside = float(surprise @ surprise - ahead**2)
        doubtful = aside / expected[0] + ahead**2 / expected[1] > _NOISE**2
        counts, anew = self._jumps.judge(point[None], np.array([doubtful]), step_s)
        if anew[0]:
            place, self._velocity = point, np.zeros(3)
            p, both, v = sigma**2, np.zeros(2), np.full(2, _WALKING_M_S**2)
        elif counts[0]:
            gain, pull = p / expected, both / expected
            place = place + _scaled(surprise, sight, gain)
            self._velocity = self._velocity + _scaled(surprise, sight, pull)
            p, both, v = (1.0 - gain) * p, (1.0 - gain) * both, v - pull * both
        self._place, self._variance = place, np.stack([p, both, v])
        return place


def _own_sigmas(pose: Pose) -> tuple[Float[np.ndarray, 13], Float[np.ndarray, 13]]:
    """Return each landmark's deviation from the body's place, along the sight and across it, metres."""
    along = np.sqrt(np.maximum(pose.sigma_m**2 - pose.distance_sigma_m**2, _EXACT_M**2))
    seen = np.clip(np.nan_to_num(pose.visibility), 0.0, 1.0)
    return along, np.minimum(along, np.hypot(_EXACT_M, _UNSEEN_M * (1.0 - seen)))


def _share(cutoff_hz: Float[np.ndarray, "*shape"], step_s: float) -> Float[np.ndarray, "*shape"]:
    """Return how much of a surprise a low-pass of this cutoff takes in after a step."""
    return np.asarray(1.0 - np.exp(-2.0 * np.pi * cutoff_hz * step_s))


def _directions(points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 3"]:
    """Return the lines of sight to points; ahead where there is no direction."""
    distance = np.linalg.norm(points, axis=-1, keepdims=True)
    return np.asarray(np.where(distance > 0.0, points, _AXIS) / np.where(distance > 0.0, distance, 1.0))


def _scaled(
    vectors: Float[np.ndarray, "*batch 3"],
    sights: Float[np.ndarray, "*batch 3"],
    factors: Float[np.ndarray, "2 ..."],
) -> Float[np.ndarray, "*batch 3"]:
    """Scale vectors by one factor across the line of sight and by another along it."""
    ahead = (vectors * sights).sum(axis=-1)
    along = (factors[1] - factors[0]) * ahead
    return np.asarray(factors[0][..., None] * vectors + along[..., None] * sights)


__all__ = ["FilterConfig", "Jumps", "Limbs", "PoseFilter", "Walker"]
