"""Whose body commands: one person, kept through crossings and short absences, and never mistaken."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Literal

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.errors import InputError
from wigwag.pose.cover import UPRIGHT_M, Cover, cover_at
from wigwag.pose.engagement import Signal
from wigwag.pose.people import People, Seen, Track
from wigwag.pose.region import Region


@dataclass(frozen=True, slots=True)
class OperatorConfig:
    """Who becomes the operator, and what it takes to stay it.

    Raises:
        InputError: If a value is out of range; the message names it.
    """

    engage: Literal["gesture", "first"] = "gesture"
    """``"gesture"``: whoever holds one hand above the head for a second (``wigwag.pose.engagement``); nobody
    before. ``"first"``: whoever is found first, for a person alone with a webcam; whoever is there once they
    are gone."""
    lost_s: float = 10.0
    """An operator not seen for so long is the operator no longer (``"gesture"``)."""
    first_lost_s: float = 1.0
    """The same (``"first"``)."""
    away_s: float = 2.0
    """An operator not seen for so long, though nobody hid any part of them, has to engage again, and only
    they can: until ``lost_s`` nobody who looks different is let in."""
    glitch_s: float = 0.15
    """A gap up to this long is the network's, and what fits after it is believed at once."""
    confirm: int = 3
    """After a longer gap, so many frames in a row must fit; twice as many if the place was seen empty."""
    hidden: float = 0.3
    """From this share of the trunk on that something nearer covers, nothing is handed on."""
    touched: float = 0.1
    """From this share on who covers it may lend the operator their depth, which is not believed at once."""
    gone: float = 0.8
    """From this share on the network is not even asked: it would see who stands before the operator."""
    wary_s: float = 2.0
    """For so long after somebody was before or beside the operator, clothes must fit as well."""

    def __post_init__(self) -> None:
        """Check ranges once, where the configuration enters."""
        if self.engage not in ("gesture", "first"):
            raise InputError(f"OperatorConfig.engage must be 'gesture' or 'first', but got {self.engage!r}.")
        for name in self.__slots__[1:]:
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"OperatorConfig.{name} must be above 0, but got {getattr(self, name)}.")


class Claim(Enum):
    """Whether a look is the operator's."""

    NO = 0
    """It is somebody else's, or nobody can tell."""
    MAYBE = 1
    """It fits; a few more frames have to."""
    YES = 2


class OperatorKeeper:
    """Knows who the operator is, and whether a look is theirs. When in doubt, it is not.

    A frame goes: ``begin``, a ``claim`` for every look that may be the operator's, ``decide``.

    Args:
        config: Who becomes and stays the operator.
        people: Everybody in the picture.
    """

    def __init__(self, config: OperatorConfig, people: People) -> None:
        self.config, self._people = config, people
        self.reset()

    def reset(self) -> None:
        """Nobody is the operator."""
        self.track: Track | None = None
        """The operator."""
        self.cover = Cover()
        """What stands at the operator's place in the frame in hand."""
        self.sure = False
        """Whether the operator was seen in the frame in hand, and is them beyond doubt."""
        self.why = "nobody has engaged"
        """Why nothing is handed on; empty if something is."""
        self._last_ns: int | None = None
        self._called_ns: int | None = None
        """Until when whoever is alone in the picture becomes the operator without a gesture."""
        self._forget_operator()

    def call(self) -> None:
        """Make whoever is seen alone within the next second the operator, without their raising a hand.

        Of several people nobody is; and somebody who is the operator stays it.
        """
        self._called_ns = (self._last_ns or 0) + _CALL_NS

    def _forget_operator(self) -> None:
        self.track, self.cover, self.sure = None, Cover(), False
        self._trial: list[Seen] = []
        self._trial_ns = 0
        self._absent_s = 0.0
        self._wary_ns: int | None = None
        self._before_m: tuple[float, int] | None = None
        self._in_doubt = self._mingled = False
        self._lean_m = UPRIGHT_M

    @property
    def away(self) -> bool:
        """Whether the operator has to engage again to be believed."""
        return self._mingled or self._absent_s > self.config.away_s

    def region(self, now_ns: int, intrinsics: Intrinsics) -> Region:
        """Return where in the picture to look for the operator now."""
        assert self.track is not None
        if self._trial and (now_ns - self._trial_ns) * 1e-9 <= self.config.glitch_s:
            return self._trial[-1].region
        return self.track.expected_region(now_ns, self._people.config.coast_s, intrinsics)

    def begin(self, frame: Frame) -> None:
        """Begin a frame: see by depth what stands at the operator's place; count how long they are gone."""
        now, config, track = frame.stamp_ns, self.config, self.track
        since_s = 0.0 if self._last_ns is None else (now - self._last_ns) * 1e-9
        self._last_ns, self.sure = now, False
        if track is None:
            return
        lost_s = config.lost_s if config.engage == "gesture" else config.first_lost_s
        if track.age_s(now) > lost_s:
            self._release()
            return
        expected_m = track.expected_m(now, self._people.config.coast_s)
        self.cover = cover = cover_at(frame, expected_m, self._lean_m)
        self._learn_lean(cover, since_s, seen=track.age_s(now) <= config.glitch_s)
        if cover.nearer >= config.touched and cover.range_m is not None:
            self._before_m = (cover.range_m, now)
        if cover.nearer >= config.hidden:
            self._in_doubt, self._wary_ns = True, now
        elif track.age_s(now) > 0.5 and not self._partly_hidden(track, now):
            self._absent_s += since_s
        if self._people.close_to(track, now):
            self._wary_ns = now
        if cover.nearer >= config.hidden or track.age_s(now) > config.glitch_s:
            self._mingled |= self._beside_a_double(track, now)

    def _partly_hidden(self, track: Track, now_ns: int) -> bool:
        """Say whether somebody may hide the operator, by depth or because they are known to be before them.

        Where exactly somebody unseen stands is not known: beside who is before them, they are still hidden.
        """
        if self.cover.nearer >= self.config.touched:
            return True
        mine = track.expected_m(now_ns, self._people.config.coast_s)
        return any(
            other.position_m[2] < mine[2] - _BEFORE_M
            and abs(other.position_m[0] / max(other.position_m[2], 0.3) * mine[2] - mine[0]) < _TOGETHER_M
            for other in self._people.tracks
            if other is not track and other.looks > 2 and other.age_s(now_ns) <= _LATELY_S
        )

    def _beside_a_double(self, track: Track, now_ns: int) -> bool:
        """Say whether somebody known, in the operator's clothes, is where the operator should be.

        If that is so while the operator is not seen, nobody can tell afterwards who is who.
        """
        coast_s = self._people.config.coast_s
        expected_m = track.expected_m(now_ns, coast_s)
        return any(
            np.linalg.norm(other.expected_m(now_ns, coast_s) - expected_m) < _TOGETHER_M
            and self._people.looks_like(track, other.appearance)
            for other in self._people.tracks
            if other is not track and other.looks > _KNOWN_LOOKS and other.age_s(now_ns) <= _LATELY_S
        )

    def _learn_lean(self, cover: Cover, since_s: float, *, seen: bool) -> None:
        """Follow how far the operator's trunk leans to the camera, no faster than a body does.

        Unseen, they are expected to straighten up.
        """
        if seen and cover.nearer < self.config.hidden and cover.lean_m is not None:
            most = _LEANS_M_S * since_s
            self._lean_m += min(max(cover.lean_m - self._lean_m, -most), most)
        elif not seen:
            self._lean_m += min(since_s, 1.0) * (UPRIGHT_M - self._lean_m)

    def _wary(self, now_ns: int) -> bool:
        return self._wary_ns is not None and (now_ns - self._wary_ns) * 1e-9 <= self.config.wary_s

    def claim(self, seen: Seen, now_ns: int) -> Claim:
        """Say whether a look is the operator's, and take it as theirs if it is."""
        track, people = self.track, self._people
        if track is None or self.away or not self._fits(track, seen, now_ns):
            return Claim.NO
        gap_s = track.age_s(now_ns)
        if gap_s > self.config.glitch_s:
            self._in_doubt = True
        if self._in_doubt:
            if not self._confirmed(seen, now_ns):
                if gap_s <= self.config.glitch_s:  # still followed, and half hidden
                    people.update(track, seen, now_ns, learn=False, hidden=True)
                return Claim.MAYBE
            self._in_doubt = False
        self._trial, self._absent_s, self.sure = [], 0.0, True
        touched = self.cover.nearer >= self.config.touched
        people.update(track, seen, now_ns, learn=not self._wary(now_ns), touched=touched)
        return Claim.YES

    def _fits(self, track: Track, seen: Seen, now_ns: int) -> bool:
        """Say whether a look can be the operator's in space, size, clothes, and against everybody else."""
        people = self._people
        slack = np.inf
        if self._before_m is not None and (now_ns - self._before_m[1]) * 1e-9 < self.config.wary_s:
            # Whoever stands before the operator is known by their distance: nearer to it than to the
            # operator's own is not the operator. Farther off than expected it is not they.
            expected = float(np.linalg.norm(track.expected_m(now_ns, people.config.coast_s)))
            slack = max(0.5 * (expected - self._before_m[0] - UPRIGHT_M), 0.2)
        followed = track.age_s(now_ns) <= self.config.glitch_s
        careful = self._wary(now_ns) or not followed
        if people.misfit(track, seen, now_ns, slack) >= 1.0:
            return False
        if not people.sized_like(track, seen, folded=not careful):
            return False
        mine = people.away_m(track, seen, now_ns)
        for other in people.tracks:
            age_s = other.age_s(now_ns)
            if other is track or other.looks <= 2 or age_s > (_LATELY_S if followed else _KNOWN_S):
                continue
            if people.away_m(other, seen, now_ns) < mine:
                return False
        if followed and careful and people.jumps(track, seen, now_ns):
            return False
        return not careful or people.looks_like(track, seen.appearance)

    def _confirmed(self, seen: Seen, now_ns: int) -> bool:
        """Count this look; say whether enough of them in a row agree."""
        if self._trial:
            last = self._trial[-1]
            late = (now_ns - self._trial_ns) * 1e-9 > self.config.glitch_s
            if late or np.linalg.norm(seen.position_m - last.position_m) > 0.45:
                self._trial = []
        if self.cover.nearer >= self.config.hidden:
            self._trial = []
            return False
        self._trial.append(seen)
        self._trial_ns = now_ns
        needed = self.config.confirm * (2 if self._absent_s > 0.0 else 1)
        return len(self._trial) >= needed

    def decide(self, now_ns: int) -> Track | None:
        """End a frame: hear who engages or disengages; return whose pose may be handed on."""
        heard = [
            (track, track.engagement.update(track.pose))
            for track in self._people.tracks
            if track.pose is not None and (track is not self.track or self.sure)
        ]
        for track, signal in heard:
            if track is self.track and signal is Signal.DISENGAGE and self.config.engage == "gesture":
                self._release()
                self.why = "the operator disengaged"
                return None
        if self.track is None:
            self._engage(heard)
        elif self.away:
            self._engage([h for h in heard if self._people.looks_like(self.track, h[0].appearance)])
        self.why = self._reason(now_ns)
        return self.track if self.sure and self.track is not None else None

    def _engage(self, heard: list[tuple[Track, Signal | None]]) -> None:
        if self.config.engage == "first" or self._alone(heard):
            chosen = [track for track, _ in heard]
        else:
            chosen = [track for track, signal in heard if signal is Signal.ENGAGE]
        if not chosen:
            return
        old, self._called_ns = self.track, None
        self._forget_operator()
        if old is not None and old is not chosen[0]:
            self._people.tracks.remove(old)
        self.track, self.sure = chosen[0], True

    def _alone(self, heard: list[tuple[Track, Signal | None]]) -> bool:
        """Say whether somebody was called for, and one person alone can be meant."""
        now = self._last_ns
        if self._called_ns is None or now is None or now > self._called_ns:
            return False
        return len(heard) == 1 and sum(t.age_s(now) * 1e9 < _CALL_NS for t in self._people.tracks) == 1

    def _release(self) -> None:
        """Nobody is the operator any more; whoever wants to be it has to begin now."""
        self._forget_operator()
        for track in self._people.tracks:
            track.engagement.reset()

    def _reason(self, now_ns: int) -> str:
        """Say why nothing is handed on, for people to read."""
        if self.sure:
            return ""
        if self.track is None:
            return "nobody has engaged" if self._people.tracks else "nobody is seen"
        if self.cover.nearer >= self.config.hidden:
            return "somebody or something stands before the operator"
        if self._mingled:
            return "the operator was too close to somebody alike and has to engage again"
        if self.away:
            return "the operator went away and has to engage again"
        if self._trial:
            return "in doubt whether this is the operator"
        if self.cover.outside:
            return "the operator is out of the picture"
        return "the operator is not seen"


_TOGETHER_M, _KNOWN_LOOKS = 0.5, 10
"""People nearer to each other, of whom one is not seen and the other was looked at more often, mingle."""
_BEFORE_M = 0.5
"""Who is nearer to the camera by more may hide somebody."""
_LATELY_S, _KNOWN_S = 0.5, 0.8
"""Who was seen as somebody else so lately is not the operator, who is followed or has to be found again: of
four people, each is looked at as often as the latter."""
_LEANS_M_S = 2.5
"""How fast a trunk bends at most, as the camera sees it."""
_CALL_NS = 1_000_000_000
"""How long a call for an operator holds, and how long somebody who was seen counts as being there."""

__all__ = ["Claim", "OperatorConfig", "OperatorKeeper"]
