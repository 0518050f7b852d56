"""Is a vocabulary of gestures a good one? Which are too alike, look like everyday life, come late."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from wigwag.datasets.recording import Recording
from wigwag.errors import InputError, ModelError
from wigwag.evaluate.cases import bare
from wigwag.evaluate.showings import between_rests, left_out
from wigwag.evaluate.stream.lessons import Lesson
from wigwag.evaluate.stream.metrics import match_by_decision
from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.evaluate.stream.systems import system_of
from wigwag.evaluate.stream.watch import Session, scene_at, watch, watched
from wigwag.gesture import Gesture
from wigwag.recognise import KernelRecognizer
from wigwag.recognise.alike import Separation, separation, separation_of
from wigwag.skeleton import Clip
from wigwag.stream.gesture_stream import StreamModel

Progress = Callable[[str, int, int], None]
"""Called with (what, done, total)."""


@dataclass(frozen=True, slots=True)
class Rules:
    """What is too much."""

    confused: float = 0.10
    """Two gestures are too alike if more of either's left-out showings than this are named the other."""
    nearer: float = 0.10
    """They are, too, if for more of both's examples than this share the nearest other example shows the other
    gesture, by dynamic time warping over all views."""
    close: float = 1.10
    """They are close if for a tenth of the examples the other gesture is less than so many times as far as
    their own."""
    everyday_per_hour: float = 1.0
    """A gesture looks like everyday movement if it is named more often an hour while nobody shows it."""
    found: float = 0.75
    """A gesture is often missed if less of its left-out showings are named right in a stream."""


@dataclass(frozen=True, slots=True)
class PairFinding:
    """How alike two gestures are."""

    first: str
    second: str
    confused: float | None
    """Share of left-out showings named as the other, of the gesture for which it is greater."""
    nearer: float | None
    """Share of both's examples whose nearest other example shows the other gesture."""
    ratio: float | None
    """How many times farther the other gesture is than their own, for the tenth that is closest."""
    verdict: str
    """``"too alike"``, ``"close"`` or ``"apart"``."""
    examples: tuple[str, str]
    """Names of the two clips that lie closest to each other."""


@dataclass(frozen=True, slots=True)
class GestureFinding:
    """What becomes of one gesture in a stream."""

    label: str
    examples: int
    people: int
    showings: int = 0
    """How many left-out showings were watched."""
    found: float | None = None
    """Share of them that were named right."""
    early: float | None = None
    """Share of those that were named before the movement ended."""
    seen: float | None = None
    """Share of the movement that had passed then, median."""
    everyday_per_hour: float = 0.0
    """How often an hour it is named while nobody shows it."""
    everyday_of: tuple[str, ...] = ()
    """On what, the most frequent first."""
    verdicts: tuple[str, ...] = ()
    """What is wrong with it; nothing: empty."""


@dataclass(frozen=True, slots=True)
class VocabularyReport:
    """What was found."""

    protocol: str
    """What was left out to judge by."""
    pairs: list[PairFinding]
    """The most alike first."""
    gestures: list[GestureFinding]
    everyday_hours: float
    lookalikes: dict[str, Clip] = field(default_factory=dict)
    """For a gesture that looks like everyday movement, a piece of that."""

    @property
    def too_alike(self) -> list[PairFinding]:
        """The pairs that no recogniser can be trusted to tell apart."""
        return [pair for pair in self.pairs if pair.verdict == "too alike"]


def check_vocabulary(
    clips: Sequence[Clip],
    everyday: Sequence[Recording] = (),
    rules: Rules | None = None,
    *,
    system: str = "stream",
    seed: int = 0,
    progress: Progress | None = None,
) -> VocabularyReport:
    """Examine a vocabulary by what its own examples say.

    Showings are left out and judged by the rest: whole people where two or more show every gesture, else
    every fourth example (every second of two); where there is one example alone, varied copies of it stand
    in, which flatters. Pairs are judged by those and by the distances between all examples; gestures by a
    stream into which the left-out showings are played between rests, and by an hour of simulated people's
    everyday movements.

    Args:
        clips: Labelled examples of two gestures or more.
        everyday: Recordings beside the simulated ones, in which no gesture is shown.
        rules: What is too much.
        system: What listens to the streams.
        seed: Of copies and simulated people.
        progress: Called before each step.

    Raises:
        InputError: If there are less than two gestures, or a clip has no label.
    """
    rules = rules or Rules()
    labels = _labels(clips)
    protocol, folds = left_out(clips, seed)
    background = [r.stream for r in simulated_everyday(4, "teach", seed)]
    teach = system_of(system)
    named: list[tuple[str, str]] = []
    sessions: list[Session] = []
    for number, (train, test) in enumerate(folds):
        if progress is not None:
            progress("left-out showings", number, len(folds) + 2)
        recogniser = KernelRecognizer(preset="fast", random_state=seed).fit(train)
        named += zip([str(c.label) for c in test], map(str, recogniser.predict(bare(test))), strict=True)
        listener = teach(Lesson(list(train), background=background, seed=seed))
        sessions += [watch(listener, between_rests(clip, [seed, i])) for i, clip in enumerate(test)]
    if progress is not None:
        progress("distances", len(folds), len(folds) + 2)
    apart = separation(*_fitted(clips, seed))
    if progress is not None:
        progress("everyday movements", len(folds) + 1, len(folds) + 2)
    listener = teach(Lesson(list(clips), background=background, seed=seed))
    lives = [*simulated_everyday(20, "test", seed), *everyday]
    idle = [watch(listener, recording) for recording in lives]
    pairs = _sorted([_pair(a, b, named, apart, rules) for a, b in combinations(labels, 2)])
    gestures = []
    for label in labels:
        examples = [clip for clip in clips if clip.label == label]
        people = len({clip.subject for clip in examples})
        gestures.append(_gesture(label, len(examples), people, sessions, idle, rules))
    hours = sum(s.duration_s for s in idle) / 3600
    return VocabularyReport(protocol, pairs, gestures, hours, _lookalikes(gestures, lives, idle))


def check_model(
    path: Path,
    everyday: Sequence[Recording] = (),
    rules: Rules | None = None,
    *,
    seed: int = 0,
    progress: Progress | None = None,
) -> VocabularyReport:
    """Examine the vocabulary of a saved model, as far as that goes without the clips that taught it.

    Pairs are judged by the distances between the model's examples, whoever shows them; how often a gesture
    is named while nobody shows it, by the model itself, where it is one that hears streams. Nothing can be
    left out, so that what is missed or comes late is not known, and there is nothing to draw.

    Args:
        path: What :meth:`StreamModel.save` or :meth:`KernelRecognizer.save` wrote.
        everyday: As for :func:`check_vocabulary`.
        rules: What is too much.
        seed: Of simulated people.
        progress: Called before each step.

    Raises:
        InputError: If there are less than two gestures.
        ModelError: If the file is neither.
    """
    rules = rules or Rules()
    idle: list[Session] = []
    try:
        model = StreamModel.load(path)
    except ModelError as error:
        try:
            recogniser = KernelRecognizer.load(path)
        except ModelError:
            raise error from None
        apart, protocol = separation(recogniser), "a saved recogniser of clips: its examples alone"
    else:
        known = model.prefixes
        apart = separation_of(known.similar, known.numbers, known.labels, known.names)
        protocol = "a saved stream model: its examples, and what it says of everyday movement"
        lives = [*simulated_everyday(20, "test", seed), *everyday]
        listener = model.stream()
        for number, recording in enumerate(lives):
            if progress is not None:
                progress("everyday movements", number, len(lives))
            idle.append(watch(listener, recording))
    labels = sorted(apart.classes)
    if len(labels) < 2:
        raise InputError(f"A vocabulary needs two gestures or more, but got {labels}.")
    pairs = _sorted([_pair(a, b, [], apart, rules) for a, b in combinations(labels, 2)])
    counts = Counter(apart.classes[int(n)] for n in apart.numbers)
    gestures = [_gesture(label, counts[label], 0, [], idle, rules) for label in labels]
    return VocabularyReport(protocol, pairs, gestures, sum(s.duration_s for s in idle) / 3600)


def _labels(clips: Sequence[Clip]) -> list[str]:
    for clip in clips:
        if clip.label is None:
            raise InputError(f"{clip.name}: has no label; a vocabulary is checked by labelled clips.")
    labels = list(dict.fromkeys(str(clip.label) for clip in clips))
    if len(labels) < 2:
        raise InputError(f"A vocabulary needs two gestures or more, but got {labels}.")
    return sorted(labels)


def _fitted(clips: Sequence[Clip], seed: int) -> tuple[KernelRecognizer, list[str | None] | None]:
    recogniser = KernelRecognizer(preset="fast", copies=1, random_state=seed).fit(list(clips))
    people = [clip.subject for clip in clips]
    several = all(len({c.subject for c in clips if c.label == label}) > 1 for label in recogniser.classes_)
    return recogniser, people if several and None not in people else None


def _sorted(pairs: list[PairFinding]) -> list[PairFinding]:
    return sorted(pairs, key=lambda p: (-(p.confused or 0) - (p.nearer or 0), p.ratio or np.inf))


def _pair(
    first: str, second: str, named: Sequence[tuple[str, str]], apart: Separation, rules: Rules
) -> PairFinding:
    shares = []
    for own, other in ((first, second), (second, first)):
        answers = [answer for truth, answer in named if truth == own]
        if answers:
            shares.append(sum(answer == other for answer in answers) / len(answers))
    confused = max(shares) if shares else None
    ratios = apart.ratios(first, second)
    nearer = float(np.mean(ratios < 1)) if len(ratios) else None
    ratio = float(np.quantile(ratios, 0.1)) if len(ratios) else None
    if (confused or 0.0) > rules.confused or (nearer or 0.0) > rules.nearer:
        verdict = "too alike"
    else:
        verdict = "close" if ratio is not None and ratio < rules.close else "apart"
    return PairFinding(first, second, confused, nearer, ratio, verdict, apart.closest(first, second))


def _gesture(  # noqa: PLR0917  # all that is known of it
    label: str,
    examples: int,
    people: int,
    sessions: Sequence[Session],
    idle: Sequence[Session],
    rules: Rules,
) -> GestureFinding:
    mine = [s for s in sessions if s.marks[0].label == label]
    answered = [pair for s in mine for pair in match_by_decision(watched(s)).found]
    before = [event.decided_ns < mark.end_ns for mark, event in answered]
    share = [
        (event.decided_ns - mark.onset_ns) / max(mark.end_ns - mark.onset_ns, 1) for mark, event in answered
    ]
    hours = sum(s.duration_s for s in idle) / 3600
    on = Counter(_scene(s, e) for s in idle for e in s.events if e.label == label)
    found = len(answered) / len(mine) if mine else None
    early = float(np.mean(before)) if before else None
    rate = on.total() / hours if hours else 0.0
    verdicts = []
    if rate > rules.everyday_per_hour:
        verdicts.append("looks like everyday movement")
    if found is not None and found < rules.found:
        verdicts.append("is often missed")
    if early == 0.0:
        verdicts.append("is never decided early")
    return GestureFinding(
        label,
        examples,
        people,
        len(mine),
        found,
        early,
        float(np.clip(np.median(share), 0, 1)) if share else None,
        rate,
        tuple(f"{name} ({count})" for name, count in on.most_common(3)),
        tuple(verdicts),
    )


def _scene(session: Session, event: Gesture) -> str:
    scene = scene_at(session, event)
    return scene.label.partition(":")[2] or scene.label if scene else "walking or standing"


def _lookalikes(
    gestures: Sequence[GestureFinding], lives: Sequence[Recording], idle: Sequence[Session]
) -> dict[str, Clip]:
    """Cut out what the first of its false commands fell on, for each gesture that has too many."""
    pieces = {}
    for gesture in gestures:
        if "looks like everyday movement" not in gesture.verdicts:
            continue
        for recording, session in zip(lives, idle, strict=True):
            event = next((e for e in session.events if e.label == gesture.label), None)
            if event is None:
                continue
            stream = recording.stream
            low, high = np.searchsorted(
                stream.stamps_ns, [event.onset_ns, max(event.decided_ns, event.end_ns)]
            )
            if high - low >= 4:
                pieces[gesture.label] = replace(
                    stream,
                    joints=stream.joints[low:high],
                    stamps_ns=stream.stamps_ns[low:high],
                    name=_scene(session, event),
                )
                break
    return pieces


__all__ = [
    "GestureFinding", "PairFinding", "Rules", "VocabularyReport", "check_model", "check_vocabulary",
]  # fmt: skip
