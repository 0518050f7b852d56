"""wigwag's own recogniser: many views of a movement, compared by DTW, weighed by ridge regression."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Self

import numpy as np
from jaxtyping import Float, Int
from scipy.special import softmax

from wigwag.errors import InputError
from wigwag.features.canonical import CanonicalForm
from wigwag.gesture import Gesture
from wigwag.recognise.acceptance import BACKGROUND, nearest_of_each, signs_of
from wigwag.recognise.doubt import Doubt, targets_of
from wigwag.recognise.enrolment import Enrolling
from wigwag.recognise.examples import check_clips, labels_of, people_of
from wigwag.recognise.presets import ENOUGH_EXAMPLES, FEW, FEWEST_COPIES, MOST_COPIES, PRESETS
from wigwag.recognise.ridge import EmpiricalMapRidge
from wigwag.recognise.selection import RIDGES, WIDTHS, choose
from wigwag.recognise.similarity import Similarities
from wigwag.skeleton import Clip


class KernelRecognizer(Enrolling):
    """Ridge regression on DTW similarities to all training clips, in seven views of a movement.

    A clip is brought into its canonical form, seen in seven views (where the landmarks are, how limbs
    turn, how distances between landmarks change, the hands, the trunk's bounce, ...), and compared with
    every reference by banded DTW in each. One linear map, learned by ridge regression from these
    similarities (and from copies of the clips with other bodies and tempos), scores every gesture. Where a
    gesture has one example, a map is learned for each view by itself instead, and the mean decides.

    What is unlike anything taught is refused: see :meth:`accept_score`. Its threshold comes from training
    people, and gestures, that were left out in turn.

    Args:
        preset: ``"accurate"`` or ``"fast"``, which compares coarser sequences.
        origin: ``"start"``: walking stays visible; ``"drift"``: a camera that drifts does not disturb.
        ridge: Weight of the penalty, per example; ``None``: see ``width``.
        width: Width of the kernels, in median distances; ``None``, for both: the pair that forecasts
            training people best who are left out (:func:`~wigwag.recognise.selection.choose`).
        copies: Varied copies of each clip that are learned from too; ``None``: 2 to 8, more of few clips.
        false_reject: The threshold turns away this share of right decisions on training people.
        null_score: ``recognise`` gives no label below this log odds; ``None``: what ``false_reject`` says.
        random_state: Seed of the copies.

    Attributes:
        classes_: The gestures.
        accept_threshold_: The threshold in use.
        leeway_: How far below it each gesture may lie; 0 but for what was enrolled so.
        ridge_, width_, copies_: The penalty, the width and the number of copies in use.
        apart_: Whether each view decides by itself.

    Example:
        >>> import numpy as np
        >>> from wigwag.skeleton import Clip
        >>> rng, poses = np.random.default_rng(0), np.random.default_rng(1).normal(size=(2, 13, 3))
        >>> ramp = np.linspace(0, 1, 30)[:, None, None]
        >>> clips = [
        ...     Clip.at_rate(pose * (1 + ramp) + rng.normal(0, 0.01, (30, 13, 3)), 30, label, f"s{i}")
        ...     for i in range(3) for label, pose in zip(("wave", "stop"), poses)
        ... ]
        >>> recogniser = KernelRecognizer().fit(clips)
        >>> recogniser.predict(clips[:2]).tolist()
        ['wave', 'stop']
        >>> recogniser.enrol("again", [clips[0]]).classes_.tolist()
        ['stop', 'wave', 'again']
    """

    def __init__(
        self,
        *,
        preset: Literal["accurate", "fast"] = "accurate",
        origin: Literal["start", "drift"] = "start",
        ridge: float | None = 3e-4,
        width: float | None = 1.5,
        copies: int | None = None,
        false_reject: float = 0.05,
        null_score: float | None = None,
        random_state: int = 0,
    ) -> None:
        self.preset = preset
        self.origin = origin
        self.ridge = ridge
        self.width = width
        self.copies = copies
        self.false_reject = false_reject
        self.null_score = null_score
        self.random_state = random_state

    # -- fit ----------------------------------------------------------------------------------------------

    def fit(self, clips: Sequence[Clip], y: Sequence[str | None] | np.ndarray | None = None) -> Self:
        """Learn gestures from examples; clips labelled ``None`` are movements that are no gesture.

        Args:
            clips: Examples, with ``subject`` set where more than one person shows them: how sure to be is
                learned by leaving each person out.
            y: Labels; ``None``: the clips' own.

        Raises:
            InputError: If there are no clips, no labels, or not as many labels as clips, or a setting is
                out of range.
        """
        self._check_settings()
        labels, similar = labels_of(clips, y), self._similarities()
        self.classes_ = np.array(sorted({label for label in labels if label is not None}))
        number = {str(label): i for i, label in enumerate(self.classes_)}
        self.numbers_ = np.array([BACKGROUND if label is None else number[label] for label in labels])
        self.names_ = [clip.name for clip in clips]
        rng = np.random.default_rng(self.random_state)
        self._similar = similar
        wanted = min(max(ENOUGH_EXAMPLES // len(clips), FEWEST_COPIES), MOST_COPIES)
        self.copies_ = wanted if self.copies is None else self.copies
        sides = self._similar.fit(clips)
        self._similar.refer_to(sides)
        varied = [s for _ in range(self.copies_) for s in self._varied(clips, rng)]
        distances = np.stack([self._similar.distances(s) for s in sides + varied])
        self._similar.set_scales(distances[: len(clips)])
        self._rows, self._row_numbers = sides + varied, np.tile(self.numbers_, self.copies_ + 1)
        self._choose(distances, people_of(clips))
        features = self._similar.features(distances)
        self.apart_ = bool(np.median(np.bincount(self.numbers_[self.numbers_ >= 0])) < FEW)
        relative = self._similar.relative(distances[: len(clips)]).sum(axis=2)
        self.doubt_ = Doubt(self.false_reject).fit(
            features, relative, self.numbers_, people_of(clips), self.ridge_, apart=self.apart_
        )
        self.accept_threshold_ = (
            self.doubt_.acceptance.threshold_ if self.null_score is None else float(self.null_score)
        )
        self.leeway_ = np.zeros(len(self.classes_))
        self._ridge = EmpiricalMapRidge(self.ridge_, len(similar.kinds)).fit(
            features, targets_of(self._row_numbers, len(self.classes_))
        )
        self._penalised = self._ridge.penalised
        self._take_weights()
        self._examples = Similarities.comparing(self._similar, self._rows)
        return self

    def _check_settings(self) -> None:
        if self.preset not in PRESETS:
            raise InputError(
                f"KernelRecognizer.preset must be one of {', '.join(PRESETS)}, but got {self.preset!r}."
            )
        for name in ("ridge", "width"):
            if getattr(self, name) is not None and not getattr(self, name) > 0:
                raise InputError(f"KernelRecognizer.{name} must be positive, but got {getattr(self, name)}.")
        if self.copies is not None and self.copies < 0:
            raise InputError(f"KernelRecognizer.copies must be 0 or more, but got {self.copies}.")
        if not 0 <= self.false_reject < 1:
            raise InputError(
                f"KernelRecognizer.false_reject must be within 0 and 1, but got {self.false_reject}."
            )

    def _choose(self, distances: np.ndarray, people: Int[np.ndarray, " clips"]) -> None:
        """Settle width and ridge: as they are given, or by leaving people out."""

        def features_at(width: float) -> Float[np.ndarray, "examples features"]:
            self._similar.width = width
            return self._similar.features(distances)

        if self.width is not None and self.ridge is not None:
            self.width_, self.ridge_ = self.width, self.ridge
        else:
            widths = WIDTHS if self.width is None else (self.width,)
            ridges = RIDGES if self.ridge is None else (self.ridge,)
            self.width_, self.ridge_, _ = choose(features_at, self.numbers_, people, widths, ridges)
        self._similar.width = self.width_

    def _similarities(self) -> Similarities:
        preset = PRESETS[self.preset]
        form = CanonicalForm(frames=preset.frames, origin=self.origin)
        return Similarities(form, preset.kinds, preset.n_dims, preset.band, self.width or 1.0)

    # -- decide -------------------------------------------------------------------------------------------

    def predict(self, clips: Sequence[Clip]) -> np.ndarray:
        """Return the most likely gesture of each clip: always one, however unlikely.

        Raises:
            NotFittedError: Before ``fit``.
        """
        decided = self._scores(clips)[:, :-1].argmax(axis=1)
        return np.asarray(self.classes_[decided])

    def predict_proba(self, clips: Sequence[Clip]) -> Float[np.ndarray, "clips classes"]:
        """Return a probability for each gesture, given that it is one of them.

        Calibrated on training people who were left out.

        Raises:
            NotFittedError: Before ``fit``.
        """
        scores = self._scores(clips)[:, :-1]
        return np.asarray(softmax(self.doubt_.temperature * scores, axis=1))

    def accept_score(self, clips: Sequence[Clip]) -> Float[np.ndarray, " clips"]:
        """Return the log odds that a clip truly shows the gesture it is most like, leeway not counted."""
        self._check_fitted()
        check_clips(clips)
        if len(clips) == 0:
            return np.zeros(0)
        return np.concatenate([self._weigh(clip)[2] for clip in clips])

    def recognise(self, clip: Clip) -> Gesture:
        """Decide what one clip shows; ``label=None`` if it is no gesture, or if that is not sure enough.

        The confidence is the probability that to act on it is right, at equal odds of right and wrong, and
        with the gesture's leeway as odds that speak for it: at least ``accept_probability`` if it is
        accepted, less if it is refused as not sure enough, whether it was enrolled with leeway or not.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        check_clips([clip])
        scores, relative, log_odds = self._weigh(clip)
        first, last = int(clip.stamps_ns[0]), int(clip.stamps_ns[-1])
        decided = int(scores[0, :-1].argmax())
        same = np.flatnonzero(self.numbers_ == decided)
        nearest = same[relative[same].argmin()]
        times = relative[nearest] / self.doubt_.typical[decided]
        label = str(self.classes_[decided])
        account = f"nearest example {self.names_[nearest]} at {times:.2f} times the usual distance"
        odds = log_odds + self.leeway_[decided]  # one threshold for all, so that a confidence means the same
        sure = float(self.doubt_.acceptance.probability(odds)[0])
        if self.doubt_.background(scores)[0] > scores[0, decided]:
            return Gesture(None, sure, first, last, last, f"like a movement that is no gesture; {account}")
        if odds[0] < self.accept_threshold_:
            reason = f"not sure of {label}: {sure:.3f} < {self.accept_probability:.3f}; {account}"
            return Gesture(None, sure, first, last, last, reason)
        return Gesture(label, sure, first, last, last, account)

    @property
    def similarities(self) -> Similarities:
        """The comparison with its examples that it decides by.

        Raises:
            NotFittedError: Before ``fit``.
        """
        self._check_fitted()
        return self._similar

    @property
    def weights(self) -> Float[np.ndarray, "features classes+1"]:
        """What each similarity gives to each gesture's score, and to that of 'no gesture'."""
        self._check_fitted()
        return self._weights

    @property
    def accept_probability(self) -> float:
        """The confidence that ``recognise`` has to reach, the same for every gesture."""
        self._check_fitted()
        return float(self.doubt_.acceptance.probability(np.array([self.accept_threshold_]))[0])

    def _scores(self, clips: Sequence[Clip]) -> Float[np.ndarray, "clips classes+1"]:
        self._check_fitted()
        check_clips(clips)
        if len(clips) == 0:
            return np.zeros((0, len(self.classes_) + 1))
        return np.stack([self._similar.features(self._distances(clip)) @ self._weights for clip in clips])

    def _distances(self, clip: Clip) -> Float[np.ndarray, "references views"]:
        return self._similar.distances(self._similar.sides(clip))

    def _weigh(self, clip: Clip) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return scores, distances relative to the usual ones, and the log odds of acceptance."""
        distances = self._distances(clip)
        features = self._similar.features(distances)
        scores = (features @ self._weights)[None].astype(np.float64)
        relative = self._similar.relative(distances).sum(axis=1)
        near = nearest_of_each(relative[None], self.numbers_, len(self.classes_))
        alone = (features @ self._weights_apart)[None].astype(np.float64)
        background, typical = self.doubt_.background(scores), self.doubt_.typical
        _, signs = signs_of(scores[:, :-1], background, near, typical, alone[:, :-1])
        return scores, relative, self.doubt_.acceptance.score(signs)
