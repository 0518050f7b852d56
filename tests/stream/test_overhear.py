"""Who listens in changes nothing, and what is explained is what was decided."""

from __future__ import annotations

import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.gesture import Gesture
from wigwag.recognise import HeavyRecognizer, KernelRecognizer
from wigwag.skeleton import Clip, Pose
from wigwag.stream.gesture_stream import StreamModel
from wigwag.stream.listener import Listener, listening
from wigwag.stream.overhear import Overhearing, parts_of
from wigwag.stream.teach import teach_stream

from .people import examples, session

ACTOR = 21


@pytest.fixture(scope="module")
def kernel() -> KernelRecognizer:
    clips = [clip for number in range(4) for clip in examples(number)]
    return KernelRecognizer(preset="fast").fit(clips)


@pytest.fixture(scope="module")
def stream_model() -> StreamModel:
    return teach_stream((), streams=[session(number).stream() for number in range(3)])


@pytest.fixture(params=["kernel", "stream"])
def taught(request: pytest.FixtureRequest) -> KernelRecognizer | StreamModel:
    name = "kernel" if request.param == "kernel" else "stream_model"
    return request.getfixturevalue(name)  # type: ignore[no-any-return]


def hear(listener: Listener, poses: list[Pose]) -> list[Gesture]:
    return [g for pose in poses if (g := listener.update(pose)) is not None]


def test_it_hears_what_is_heard_without_it(taught: KernelRecognizer | StreamModel) -> None:
    poses = session(ACTOR).poses()
    listener = Overhearing(taught)
    alone = hear(listening(taught), poses)
    assert hear(listener, poses) == alone and len(alone) > 4
    listener.reset()
    assert listener.heard is None and listener.explain() is None
    assert hear(listener, poses) == alone


def test_what_is_explained_is_what_was_decided(taught: KernelRecognizer | StreamModel) -> None:
    listener, explained = Overhearing(taught), []
    for pose in session(ACTOR).poses():
        gesture = listener.update(pose)
        if gesture is None:
            continue
        why = listener.explain()
        assert why is not None and why.gesture == gesture
        assert why.sure == gesture.confidence and 0 < why.least < 1
        assert why.pushes.sum() == pytest.approx(why.lead, abs=1e-3)
        assert why.lead >= 0 and why.runner_up not in (None, why.label)
        nearest, second, other = why.nearest
        assert (nearest.label, second.label, other.label) == (why.label, why.label, why.runner_up)
        assert nearest.by_view.sum() <= second.by_view.sum()
        assert f"{nearest.name} at {nearest.times:.2f} times the usual distance" in gesture.reason
        if gesture.label is not None:
            assert why.label == gesture.label and why.sure >= why.least
            assert nearest.path[-1].tolist() == [len(why.joints) - 1, len(nearest.joints) - 1]
            explained.append(why)
    assert {why.label for why in explained} == {"left", "right", "both"}
    for why in explained:
        # Seen as it was kept: the raised wrist is the one that the gesture is named after.
        highest = why.joints[..., 1].min(axis=0)
        raised = {"left": highest[5] < highest[6], "right": highest[6] < highest[5], "both": True}
        assert raised[why.label]
        assert why.answers[0].startswith("Refused, were more than")
        assert any(str(why.runner_up) in answer for answer in why.answers)


def test_without_the_most_telling_examples_the_runner_up_is_ahead(kernel: KernelRecognizer) -> None:
    """Counted anew, from the weights: one example fewer would not have sufficed."""
    clip = examples(9)[0]
    listener = Overhearing(kernel)
    listener.heard = None
    from wigwag.recognise.explain import explain

    why = explain(parts_of(kernel), clip, kernel.recognise(clip), kernel.accept_probability)
    similar = kernel.similarities
    features = similar.features(similar.distances(similar.sides(clip)))
    labels = kernel.classes_.tolist()
    first, second = labels.index(why.label), labels.index(why.runner_up)
    difference = kernel.weights[:, first] - kernel.weights[:, second]
    shares = (features * difference).reshape(len(similar), -1).sum(axis=1)
    order = np.argsort(-shares)
    assert why.telling is not None
    for left_out, ahead in ((why.telling - 1, True), (why.telling, False)):
        kept = np.delete(shares, order[:left_out])
        assert (kept.sum() >= 0) == ahead


def test_a_refusal_says_what_would_have_been_enough(kernel: KernelRecognizer) -> None:
    strict = KernelRecognizer(preset="fast", null_score=50.0).fit(
        [clip for number in range(2) for clip in examples(number)]
    )
    listener = Overhearing(strict)
    assert all(g.label is None for g in hear(listener, session(ACTOR).poses()))
    why = listener.explain()
    assert why is not None and why.gesture.label is None
    assert "sure enough" in why.answers[0] or "No gesture" not in why.answers[0]


def test_kinds_that_are_not_explained_are_told() -> None:
    heavy = HeavyRecognizer()
    with pytest.raises(InputError, match="Decisions of a HeavyRecognizer are not explained"):
        parts_of(heavy)

    class Namer:
        def recognise(self, clip: Clip) -> Gesture:
            return Gesture("up", 0.5)

    listener = Overhearing(Namer())
    assert hear(listener, session(ACTOR).poses()) and listener.heard is not None
    assert listener.explain() is None
