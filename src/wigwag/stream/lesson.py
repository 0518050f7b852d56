"""What is learned from streams: what gestures look like while they are shown, and how sure to be of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from wigwag.errors import InputError
from wigwag.recognise.similarity import Sides
from wigwag.skeleton import Clip, Pose
from wigwag.stream.assemble import at_rate
from wigwag.stream.config import StreamConfig
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.glance import Glance
from wigwag.stream.prefix import NOTHING, Memory, PrefixModel, Shares
from wigwag.stream.rehearse import Rehearsal, choose, limits_of
from wigwag.stream.sureness import Sureness
from wigwag.stream.teach_glance import GlanceLesson
from wigwag.stream.ticks import RATE_HZ
from wigwag.stream.truth import LabelledStream, Meaning, Showing, meaning
from wigwag.stream.watcher import Hypothesis, WatchConfig, Watcher

Origin = Literal["start", "drift"]

_MOST_FOLDS = 4
_MOST_REFERENCES = 400
_MOST_GESTURES = 8000
_MOST_NOTHING = 10000
_MOST_LOOKS = 100_000
"""How many references there are, how many stretches are learned from, and how many are judged: what the
time of a decision, and of teaching, is bounded by."""

_THINNED = 0.2
"""Of streams that are not judged, this share of all stretches is kept."""


@dataclass(slots=True)
class Looked:
    """One hypothesis of a training stream."""

    hypothesis: Hypothesis
    meaning: Meaning
    sides: Sides


class Lesson:
    """Streams that are taught by.

    Args:
        streams: With their truth.
        origin: Of the canonical form.
        seed: Of what is drawn.

    Raises:
        InputError: If a showing is an action point, which has no beginning; or if fewer than two people show
            gestures.
    """

    def __init__(self, streams: Sequence[LabelledStream], origin: Origin = "start", seed: int = 0) -> None:
        self.streams = list(streams)
        self.rng = np.random.default_rng([0x1E55, seed])
        self.seed = seed
        self.model = PrefixModel(origin)
        self.truth = [one.showings for one in self.streams]
        if any(showing.is_point for truth in self.truth for showing in truth):
            raise InputError(
                "teach_stream needs to know where gestures begin and end, but a showing is an action point; "
                "teach those with teach_moments."
            )
        self.fold = self._folds()
        people = {str(s.stream.subject) for s, truth in zip(self.streams, self.truth, strict=True) if truth}
        if len(people) < 2:
            raise InputError(
                "teach_stream learns how sure to be from people who are left out in turn, but gestures are "
                f"shown in streams by {', '.join(sorted(people)) or 'nobody'} alone. Give another person's "
                "streams too, or clips, of which varied copies stand in for others."
            )

    def learn(self, config: StreamConfig) -> StreamModel:
        """Teach everything."""
        owners = self._refer()
        looked: list[list[Looked]] = [[] for _ in self.streams]
        judged: list[int] = []
        for number in self._order(config):
            whole = sum(len(looked[i]) for i in judged) < _MOST_LOOKS
            looked[number] = self._look(number, 1.0 if whole else _THINNED)
            judged += [number] if whole else []
        self._teach(looked, owners)
        self._glance()
        rehearsals = self._rehearse({number: looked[number] for number in judged}, owners)
        typical = self._typical(rehearsals)
        for one in rehearsals:
            one.signs[:, 4] += np.log(typical[one.decided])
        self.model.typical = typical
        sureness, probabilities = self._be_sure(rehearsals)
        thresholds = choose(rehearsals, probabilities, self.model.labels, config)
        self.model.lengths_s = self._lengths_s()
        self.model.limits = limits_of(rehearsals, len(self.model.labels))
        return StreamModel(self.model, sureness, thresholds, config, self.glance)

    def _folds(self) -> Int[np.ndarray, " streams"]:
        """Part streams by people into those that are left out together."""
        folds = np.zeros(len(self.streams), dtype=np.int64)
        for with_gestures in (True, False):
            mine = [i for i, truth in enumerate(self.truth) if bool(truth) == with_gestures]
            people = sorted({str(self.streams[i].stream.subject) for i in mine})
            for i in mine:
                folds[i] = people.index(str(self.streams[i].stream.subject)) % _MOST_FOLDS
        return folds

    def _refer(self) -> Int[np.ndarray, " references"]:
        """Choose references, evenly over gestures and people; return the fold that each belongs to."""
        found: dict[str, list[tuple[Clip, int]]] = {}
        for number in self.rng.permutation(len(self.streams)):
            stream, fold = self.streams[number].stream, int(self.fold[number])
            for showing in self.truth[number]:
                clip = _between(stream, showing)
                if clip is not None:
                    found.setdefault(showing.label, []).append((clip, fold))
        each = max(_MOST_REFERENCES // max(len(found), 1), 1)
        chosen: list[tuple[Clip, int]] = []
        for label in sorted(found):
            shuffled = [found[label][int(i)] for i in self.rng.permutation(len(found[label]))]
            chosen += _distinct(shuffled, each)
        self.model.refer_to([clip for clip, _ in chosen], [str(clip.label) for clip, _ in chosen])
        return np.array([fold for _, fold in chosen])

    def _look(self, number: int, share: float) -> list[Looked]:
        """Watch one stream and keep a share of what is looked at."""
        truth = self.truth[number]
        return [
            Looked(
                h,
                meaning(h, truth),
                [side.astype(np.float16) for side in self.model.sides(clip)],
            )
            for h, clip in watch(self.streams[number].stream)
            if share == 1.0 or self.rng.random() < share
        ]

    def _number(self, stream: int, one: Looked) -> int:
        if one.meaning.showing is None:
            return NOTHING
        return self.model.labels.index(self.truth[stream][one.meaning.showing].label)

    def _teach(self, looked: Sequence[list[Looked]], owners: Int[np.ndarray, " references"]) -> None:
        """Learn from some of all stretches: from all, and with each fold left out."""
        gestures: list[tuple[int, int]] = []
        nothing: list[tuple[int, int]] = []
        for stream, looks in enumerate(looked):
            for i, one in enumerate(looks):
                if not one.meaning.doubtful:
                    (nothing if one.meaning.showing is None else gestures).append((stream, i))
        some = [gestures[int(i)] for i in self.rng.permutation(len(gestures))[:_MOST_GESTURES]]
        some += [nothing[int(i)] for i in self.rng.permutation(len(nothing))[:_MOST_NOTHING]]
        numbers = np.array([self._number(s, looked[s][i]) for s, i in some])
        progress = np.array([looked[s][i].meaning.progress for s, i in some])
        folds = [int(self.fold[s]) for s, _ in some]
        views = len(self.model.similar.kinds)
        shares = Shares(len(self.model.numbers) * views, len(self.model.labels))
        for fold in sorted(set(folds)):
            rows = [r for r, mine in enumerate(folds) if mine == fold]
            features = self._features([looked[some[r][0]][some[r][1]] for r in rows])
            shares.add(fold, features, numbers[rows], progress[rows])
        self.model.weights = shares.solve()
        self.without: dict[int, np.ndarray] = {}
        for fold in range(_MOST_FOLDS):
            kept = owners != fold
            if kept.any():
                self.without[fold] = shares.solve(fold, np.repeat(kept, views))

    def _glance(self) -> None:
        """Teach the second view: from all, and with each fold left out; or none."""
        self.glance: Glance | None = None
        self.glances: dict[int, Glance] = {}
        # Varied copies of one person's examples say how they move, not how others do: a network that learns
        # from them alone is surer than it should be (own examples, inner folds: F1 0.968, without 0.977).
        shown = zip(self.streams, self.truth, strict=True)
        people = {str(one.stream.subject).partition(" again ")[0] for one, truth in shown if truth}
        # From a camera that flies more was missed with it (docs/stream-benchmark.md, "A second view").
        if len(people) < 2 or self.model.origin == "drift":
            return
        taught = GlanceLesson(self.streams, self.model.labels, self.fold, seed=self.seed)
        folds = {int(fold): taught.without(int(fold)) for fold in np.unique(self.fold)}
        shows = {fold: glance for fold, glance in folds.items() if glance is not None}
        if len(shows) == len(folds):
            self.glance, self.glances, self.glimpses = taught.without(None), shows, taught.glimpses

    def _features(self, looks: Sequence[Looked]) -> Float[np.ndarray, "rows features"]:
        similar = self.model.similar
        if not looks:
            return np.empty((0, len(self.model.numbers) * len(similar.kinds)), dtype=np.float32)
        distances = np.stack([similar.distances(_full(one.sides)) for one in looks])
        return similar.features(distances)

    def _rehearse(
        self, looked: dict[int, list[Looked]], owners: Int[np.ndarray, " references"]
    ) -> list[Rehearsal]:
        """Look at streams with what others have taught."""
        rehearsals = []
        for stream, looks in looked.items():
            fold = int(self.fold[stream])
            if not looks or fold not in self.without:
                continue
            memory, allowed = Memory.empty(), owners != fold
            glance, glimpses = self.glances.get(fold), None
            if glance is not None:
                stamps_ns = np.array([one.hypothesis.now_ns for one in looks])
                glimpses = self.glimpses(glance, stream, stamps_ns)
            decided, signs = np.empty(len(looks), dtype=np.int64), []
            for i, one in enumerate(looks):
                distances = self.model.similar.distances(_full(one.sides))
                scores = (self.model.similar.features(distances) @ self.without[fold]).astype(np.float64)
                glimpse = None if glimpses is None else glimpses[i]
                found = self.model.evidence(
                    one.hypothesis, distances, scores, memory, allowed=allowed, glimpse=glimpse
                )
                decided[i] = found[0]
                signs.append(found[1])
            right = np.array([self._number(stream, one) == d for one, d in zip(looks, decided, strict=True)])
            rehearsals.append(
                Rehearsal(
                    fold,
                    self.truth[stream],
                    self.streams[stream].stream.duration_s,
                    [one.hypothesis for one in looks],
                    np.stack(signs),
                    decided,
                    right,
                    np.array([one.meaning.doubtful for one in looks]),
                    self.streams[stream].deliberate,
                )
            )
        return rehearsals

    def _order(self, config: StreamConfig) -> list[int]:
        """Order streams: those with commands first, then those without gestures, then those with others."""

        def rank(stream: int) -> int:
            labels = {showing.label for showing in self.truth[stream]}
            spoken = labels if config.commands is None else labels & set(config.commands)
            return 0 if spoken else 1 if not labels else 2

        return sorted((int(i) for i in self.rng.permutation(len(self.streams))), key=rank)

    def _typical(self, rehearsals: Sequence[Rehearsal]) -> Float[np.ndarray, " labels"]:
        """Say how far the nearest example by another person usually is, a gesture."""
        near: list[list[float]] = [[] for _ in self.model.labels]
        for one in rehearsals:
            for i in np.flatnonzero(one.right):
                near[one.decided[i]].append(-float(one.signs[i, 4]))
        usual = [float(np.median(logs)) if len(logs) >= 5 else np.nan for logs in near]
        overall = float(np.nanmedian(usual)) if np.isfinite(usual).any() else 0.0
        return np.asarray(np.exp(np.where(np.isfinite(usual), usual, overall)))

    def _lengths_s(self) -> Float[np.ndarray, " labels"]:
        """Return how long each gesture takes, in the middle of all that are shown."""
        every = [showing for truth in self.truth for showing in truth]
        return np.array([
            np.median([(s.end_ns - s.onset_ns) * 1e-9 for s in every if s.label == label])
            for label in self.model.labels
        ])  # fmt: skip

    def _be_sure(self, rehearsals: Sequence[Rehearsal]) -> tuple[Sureness, list[np.ndarray]]:
        """Learn how sure to be; and for choosing thresholds, how sure people left out of that make it."""

        def fitted(kept: Sequence[Rehearsal]) -> Sureness:
            signs = np.concatenate([one.signs[~one.doubtful] for one in kept])
            right = np.concatenate([one.right[~one.doubtful] for one in kept])
            return Sureness().fit(signs, right, self.seed)

        folds = sorted({one.fold for one in rehearsals})
        probabilities: list[np.ndarray] = [np.empty(0)] * len(rehearsals)
        whole = fitted(rehearsals)
        for fold in folds:
            kept = [one for one in rehearsals if one.fold != fold]
            sure = fitted(kept) if kept else whole
            for i, one in enumerate(rehearsals):
                if one.fold == fold:
                    probabilities[i] = sure.probability(one.signs)
        return whole, probabilities


def watch(stream: Clip, config: WatchConfig | None = None) -> Iterator[tuple[Hypothesis, Clip]]:
    """Yield what is looked at in a stream, as it would be in flight."""
    watcher, visibility = Watcher(config), np.ones(13)
    for joints, stamp_ns in zip(stream.joints, stream.stamps_ns, strict=True):
        hypothesis = watcher.update(Pose(joints, visibility, int(stamp_ns)))
        if hypothesis is not None:
            yield hypothesis, watcher.clip(hypothesis)


def _full(sides: Sides) -> Sides:
    return [side.astype(np.float32) for side in sides]


def _between(stream: Clip, showing: Showing) -> Clip | None:
    """Cut a gesture out of its stream, with a tenth of a second before it."""
    low, high = np.searchsorted(stream.stamps_ns, [showing.onset_ns - 100_000_000, showing.end_ns + 1])
    if high - low < 4:
        return None
    piece = Clip(stream.joints[low:high], stream.stamps_ns[low:high], showing.label, stream.subject, "piece")
    at_s = showing.onset_ns * 1e-9
    return Clip.at_rate(
        at_rate(piece),
        RATE_HZ,
        showing.label,
        stream.subject,
        f"{showing.label} of {stream.subject} at {at_s:.1f} s",
    )


def _distinct(pieces: Sequence[tuple[Clip, int]], most: int) -> list[tuple[Clip, int]]:
    """Take one piece of each person in turn, up to ``most``."""
    queues: dict[str, list[tuple[Clip, int]]] = {}
    for piece in pieces:
        queues.setdefault(str(piece[0].subject), []).append(piece)
    taken: list[tuple[Clip, int]] = []
    while len(taken) < most and any(queues.values()):
        for queue in queues.values():
            if queue and len(taken) < most:
                taken.append(queue.pop())
    return taken
