import numpy as np

from wigwag.evaluate.stream.simulated import simulated_everyday
from wigwag.sim.gestures import BACKGROUND, DISTRACTORS


def test_nobody_commands_and_everything_is_named() -> None:
    taught, judged = (simulated_everyday(1, purpose)[0] for purpose in ("teach", "test"))
    for recording, names in ((taught, BACKGROUND), (judged, (*BACKGROUND, *DISTRACTORS))):
        assert recording.marks == ()
        shown = [scene.label.removeprefix("simulated:") for scene in recording.scenes]
        assert sorted(shown) == sorted(2 * names)
        assert recording.stream.duration_s > 60
        assert (np.diff(recording.stream.joints, axis=0) != 0).any(axis=(1, 2)).all()


def test_people_who_teach_are_not_judged() -> None:
    people = [{str(r.stream.subject) for r in simulated_everyday(2, p)} for p in ("teach", "inner", "test")]
    assert len(set.union(*people)) == 6
    again = simulated_everyday(1, "test", 1)[0]
    assert again.stream.subject not in set.union(*people), "a seed brings others"
