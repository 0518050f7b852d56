"""The complete embedding, held against a frame-by-frame reading of the paper's equations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.features import Embedding
from wigwag.features.embedding import ADJACENT_TRIPLES, ALL_TRIPLES, PAIRS
from wigwag.skeleton import LANDMARKS, MIRROR, Clip, mirrored


def random_clip(seed: int, frames: int = 9) -> Clip:
    rng = np.random.default_rng(seed)
    stamps = np.cumsum(rng.integers(20_000_000, 60_000_000, frames))
    return Clip(rng.normal(size=(frames, 13, 3)), stamps)


def by_the_book(clip: Clip, triples) -> dict[str, np.ndarray]:
    """Section 3, one frame, one joint, one axis at a time."""
    p, t = clip.joints, clip.stamps_ns * 1e-9
    frames = len(clip)

    def rate(series):
        out = [None] + [(series[f] - series[f - 1]) / (t[f] - t[f - 1]) for f in range(1, frames)]
        out[0] = out[1]
        return out

    def angles(v):
        return np.array([math.acos(v[a] / math.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)) for a in range(3)])

    def theta(a, b, c):
        ab, bc = b - a, c - b
        normal = np.cross(ab, bc)
        cosine = np.dot(ab, bc) / (np.linalg.norm(ab) * np.linalg.norm(bc))
        return normal / np.linalg.norm(normal) * math.acos(cosine)

    out = {}

    def put(who, what, series):
        for axis in range(3):
            out[f"{who}.{what}.{'xyz'[axis]}"] = np.array([value[axis] for value in series])

    def motion(who, what, series):
        angle = [angles(v) for v in series]
        put(who, what, series)
        put(who, "velocity", rate(series))
        put(who, "acceleration", rate(rate(series)))
        put(who, "angle", angle)
        put(who, "angular_velocity", rate(angle))
        put(who, "angular_acceleration", rate(rate(angle)))

    for j, name in enumerate(LANDMARKS):
        motion(name, "position", [p[f, j] for f in range(frames)])
        moved = [p[f, j] - p[f - 1, j] for f in range(1, frames)]
        put(name, "displacement", [moved[0], *moved])
    for a in range(13):
        for b in range(a + 1, 13):
            motion(f"{LANDMARKS[a]}-{LANDMARKS[b]}", "difference", [p[f, b] - p[f, a] for f in range(frames)])
    for a, b, c in triples:
        series = [theta(p[f, a], p[f, b], p[f, c]) for f in range(frames)]
        who = f"{LANDMARKS[a]}>{LANDMARKS[b]}>{LANDMARKS[c]}"
        put(who, "theta", series)
        put(who, "angular_velocity", rate(series))
        put(who, "angular_acceleration", rate(rate(series)))
    return out


@pytest.mark.parametrize(("triples", "table"), [("adjacent", ADJACENT_TRIPLES), ("all", ALL_TRIPLES)])
def test_is_the_paper_equation_by_equation(triples, table):
    clip = random_clip(1)
    embedding = Embedding(triples, dtype="float64").fit()
    values = embedding.embed(clip)
    expected = by_the_book(clip, table)
    assert set(embedding.names_) == set(expected)
    for column, name in enumerate(embedding.names_):
        np.testing.assert_allclose(values[:, column], expected[name], rtol=1e-6, atol=1e-6, err_msg=name)


@pytest.mark.parametrize(("triples", "features"), [("adjacent", 1821), ("all", 4251)])
def test_states_its_dimension_and_names_each_feature_once(triples, features):
    embedding = Embedding(triples).fit()
    assert embedding.n_features_ == len(set(embedding.names_)) == features
    assert embedding.get_feature_names_out().tolist() == list(embedding.names_)
    assert sum("-" not in n and ">" not in n for n in embedding.names_) == 273
    assert sum("-" in n for n in embedding.names_) == 1404
    assert embedding.transform([random_clip(0)])[0].shape == (9, features)
    assert len(PAIRS) == 78


def test_adjacent_triples_are_the_same_on_both_sides():
    def unordered(triple):
        return frozenset([triple, triple[::-1]])

    here = {unordered(t) for t in ADJACENT_TRIPLES}
    assert {unordered(tuple(MIRROR[j] for j in t)) for t in ADJACENT_TRIPLES} == here
    assert len(here) == 16


def test_displacement_since_the_first_frame():
    clip = random_clip(2)
    embedding = Embedding(displacement="first", dtype="float64").fit()
    column = embedding.names_.index("left_wrist.displacement.y")
    np.testing.assert_allclose(
        embedding.embed(clip)[:, column], clip.joints[:, 5, 1] - clip.joints[0, 5, 1], atol=1e-12
    )


@given(seed=st.integers(0, 2**31), shift=st.lists(st.floats(-50, 50), min_size=3, max_size=3))
@settings(max_examples=15, deadline=None)
def test_pairs_and_triples_do_not_see_where_the_person_stands(seed, shift):
    clip = random_clip(seed, 5)
    moved = Clip(clip.joints + np.array(shift), clip.stamps_ns)
    embedding = Embedding(dtype="float64").fit()
    a, b = embedding.embed(clip), embedding.embed(moved)
    # Angles near 0 and 180 degrees lose half of the digits; rates divide by 20 ms twice.
    np.testing.assert_allclose(a[:, 273:], b[:, 273:], rtol=1e-5, atol=1e-3)


@given(seed=st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_mirroring_swaps_left_and_right(seed):
    clip = random_clip(seed, 5)
    embedding = Embedding(dtype="float64").fit()
    there, back = embedding.embed(mirrored(clip)), embedding.embed(clip)
    at = {name: column for column, name in enumerate(embedding.names_)}
    for joint, other in enumerate(MIRROR):
        for kind in ("position", "velocity", "acceleration", "displacement"):
            for axis, sign in zip("xyz", (-1, 1, 1), strict=True):
                a, b = (f"{LANDMARKS[j]}.{kind}.{axis}" for j in (joint, other))
                np.testing.assert_allclose(there[:, at[a]], sign * back[:, at[b]], atol=1e-9, err_msg=a)
    bend, other = (f"{s}_shoulder>{s}_elbow>{s}_wrist.theta" for s in ("left", "right"))
    for axis, sign in zip("xyz", (1, -1, -1), strict=True):  # a normal is no ordinary vector
        np.testing.assert_allclose(
            there[:, at[f"{bend}.{axis}"]], sign * back[:, at[f"{other}.{axis}"]], atol=1e-9
        )


@pytest.mark.parametrize("frames", [2, 3, 40])
def test_degenerate_bodies_give_numbers(frames):
    everything_in_one_point = np.zeros((frames, 13, 3))
    all_in_a_line = np.arange(13.0)[None, :, None] * np.ones((frames, 1, 3))
    for joints in (everything_in_one_point, all_in_a_line):
        values = Embedding("all").fit_transform([Clip.at_rate(joints, 30)])[0]
        assert values.shape == (frames, 4251)
        assert np.isfinite(values).all()
    names = Embedding().fit().names_
    values = Embedding().fit().embed(Clip.at_rate(everything_in_one_point, 30))
    assert values[0, names.index("nose.angle.x")] == pytest.approx(math.pi / 2)
    assert values[0, names.index("left_hip>left_knee>left_heel.theta.x")] == 0


@pytest.mark.parametrize("setting", [{"triples": "some"}, {"displacement": "last"}, {"dtype": "float16"}])
def test_names_a_setting_that_does_not_exist(setting):
    with pytest.raises(InputError, match=rf"Embedding\.{next(iter(setting))} must be one of"):
        Embedding(**setting).fit()
