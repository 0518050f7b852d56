"""Similarities: DTW distances in several views, their units, and references that come and go."""

import numpy as np
import pytest

from tests.recognise.people import GESTURES, clip, clips
from wigwag.distances import dtw
from wigwag.features.canonical import CanonicalForm
from wigwag.features.views import views
from wigwag.recognise.similarity import Similarities
from wigwag.skeleton import Clip

KINDS = ("positions", "distances", "hands")
FORM = CanonicalForm(frames=16)
TRAIN = clips(GESTURES, range(3), takes=1)


def taught(n_dims: int = 12) -> tuple[Similarities, list]:
    similar = Similarities(FORM, KINDS, n_dims, 1, 1.5)
    sides = similar.fit(TRAIN)
    similar.refer_to(sides)
    similar.set_scales(np.stack([similar.distances(s) for s in sides]))
    return similar, sides


def test_distances_are_those_of_dtw_view_by_view():
    similar, sides = taught()
    found = similar.distances(sides[4])
    assert found.shape == (9, 3)
    for i in range(9):
        for v in range(3):
            assert found[i, v] == pytest.approx(dtw(sides[4][v], sides[i][v], band=1), rel=1e-4, abs=1e-4)


def test_the_band_bounds_the_warping():
    similar, sides = taught()
    late = [
        np.roll(side, 3, axis=0) for side in sides[4]
    ]  # three frames late, which one frame cannot make up
    found = similar.distances(late)[4]
    for v in range(3):
        one, wide = (dtw(late[v], sides[4][v], band=band) for band in (1, 6))
        assert found[v] == pytest.approx(one, rel=1e-4)
        assert wide < 0.9 * one


def test_distances_are_symmetric_and_nothing_from_oneself():
    similar, sides = taught()
    distances = np.stack([similar.distances(s) for s in sides])
    np.testing.assert_allclose(distances, distances.transpose(1, 0, 2), rtol=1e-5, atol=1e-4)
    np.testing.assert_allclose(distances[np.arange(9), np.arange(9)], 0, atol=1e-3)
    assert distances[0, 1:].min() > 0.1


def test_projections_are_on_the_principal_directions():
    _, sides = taught(n_dims=5)
    raw = np.concatenate([views(FORM.apply(c))["positions"] for c in TRAIN]).astype(np.float64)
    centred = raw - raw.mean(axis=0)
    spreads = np.linalg.svd(centred, compute_uv=False)
    projected = np.concatenate([s[0] for s in sides]).astype(np.float64)
    assert projected.shape == (9 * 16, 5)
    np.testing.assert_allclose(projected.mean(axis=0), 0, atol=1e-4)
    np.testing.assert_allclose(np.linalg.norm(projected, axis=0), spreads[:5], rtol=1e-4)
    # A view of no more numbers than directions asked for stays as it is, but for its middle.
    assert taught(n_dims=12)[1][0][2].shape == (16, 6)
    hands = views(FORM.apply(TRAIN[0]))["hands"]
    np.testing.assert_allclose(np.ptp(taught()[1][0][2], axis=0), np.ptp(hands, axis=0), rtol=1e-4)


def test_a_clip_seen_again_has_the_sides_it_was_taught_with():
    similar, sides = taught()
    for again, before in zip(similar.sides(TRAIN[5]), sides[5], strict=True):
        np.testing.assert_allclose(again, before, atol=1e-5)


def test_units_are_median_distances_and_similarities_follow():
    similar, sides = taught()
    distances = np.stack([similar.distances(s) for s in sides])
    np.testing.assert_allclose(np.median(similar.relative(distances), axis=(0, 1)), 1, rtol=1e-5)
    features = similar.features(distances)
    assert features.shape == (9, 27)
    # All views of the first reference come first: those of one reference stand side by side.
    expected = np.exp(-distances / (1.5 * np.median(distances, axis=(0, 1))))
    np.testing.assert_allclose(features[:, 3:6], expected[:, 1], rtol=1e-4)
    np.testing.assert_allclose(similar.features(distances[2]), features[2])
    assert ((features > 0) & (features <= 1)).all()


def test_what_is_added_in_steps_is_as_if_it_had_always_been_there():
    similar, sides = taught()
    query = similar.sides(clip("spread", 8, 0))
    whole = similar.distances(query)
    similar.refer_to(sides[:4])
    assert len(similar) == 4
    for stop in (5, 6, 9):
        similar.add(sides[len(similar) : stop])
        assert len(similar) == stop
        np.testing.assert_allclose(similar.distances(query), whole[:stop], rtol=1e-5)
    similar.refer_to(sides[2:3])
    np.testing.assert_allclose(similar.distances(query), whole[2:3], rtol=1e-5)


def test_comparing_with_others_changes_nothing_for_the_first():
    similar, sides = taught()
    other = Similarities.comparing(similar, sides[:2])
    other.add(sides[3:4])
    assert (len(similar), len(other)) == (9, 3)
    query = similar.sides(clip("bow", 8, 0))
    np.testing.assert_allclose(other.distances(query), similar.distances(query)[[0, 1, 3]], rtol=1e-5)
    np.testing.assert_allclose(
        other.features(other.distances(query)), similar.features(other.distances(query))
    )


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "clip",
    [TRAIN[0], Clip.at_rate(np.zeros((10, 13, 3)), 30), Clip.at_rate(TRAIN[0].joints[:2], 20)],
    ids=["one clip", "one point", "two frames"],
)
def test_units_where_nothing_differs_still_tell_near_from_far(clip):
    """Bug: they were 1e-9, so that all similarities were 0, and what was enrolled later unlike anything."""
    similar = Similarities(FORM, KINDS, 12, 4, 1.5)
    sides = similar.fit([clip])
    similar.refer_to(sides)
    similar.set_scales(np.stack([similar.distances(s) for s in sides]))
    same = similar.features(similar.distances(sides[0]))
    other = similar.features(similar.distances(similar.sides(TRAIN[-1])))
    np.testing.assert_allclose(same, 1, atol=1e-3)
    assert (other > 1e-6).all() and (other < 0.99).all()
