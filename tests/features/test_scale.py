"""Scaling learned from training frames."""

import numpy as np
import pytest

from wigwag.errors import InputError, NotFittedError
from wigwag.features import FrameScaler

RNG = np.random.default_rng(0)
SEQUENCES = [RNG.normal(size=(n, 4)) * [1, 10, 0.1, 0] + [0, 5, 0, 7] for n in (5, 50, 20)]


def test_minmax_spans_exactly_minus_one_to_one_over_all_training_frames():
    scaled = np.concatenate(FrameScaler().fit_transform(SEQUENCES))
    np.testing.assert_allclose(scaled[:, :3].min(axis=0), -1)
    np.testing.assert_allclose(scaled[:, :3].max(axis=0), 1)


def test_other_frames_may_lie_outside():
    scaler = FrameScaler().fit(SEQUENCES)
    assert scaler.scale(10 * SEQUENCES[0]).max() > 1


@pytest.mark.parametrize("method", ["minmax", "quantile", "std"])
def test_a_constant_feature_becomes_zero_and_harms_nothing(method):
    scaler = FrameScaler(method).fit(SEQUENCES)
    np.testing.assert_allclose(np.concatenate(scaler.transform(SEQUENCES))[:, 3], 0, atol=1e-12)
    assert np.isfinite(scaler.scale(SEQUENCES[0] + 1)).all()


def test_one_wild_frame_moves_the_quantiles_little():
    calm = RNG.normal(size=(2000, 1))
    wild = np.concatenate([calm, [[1000.0]]])
    ratio = {
        method: FrameScaler(method).fit([wild]).half_range_ / FrameScaler(method).fit([calm]).half_range_
        for method in ("minmax", "quantile")
    }
    assert ratio["quantile"] < 1.05
    assert ratio["minmax"] > 50


def test_weights_count_a_feature_more_often():
    weighted = FrameScaler(weights=np.array([3.0, 1, 1, 1])).fit_transform(SEQUENCES)[1]
    plain = FrameScaler().fit_transform(SEQUENCES)[1]
    np.testing.assert_allclose(weighted[:, 0], 3 * plain[:, 0])
    np.testing.assert_allclose(weighted[:, 1:], plain[:, 1:])


def test_float32_stays_float32():
    assert FrameScaler().fit(SEQUENCES).scale(SEQUENCES[0].astype(np.float32)).dtype == np.float32


def test_faults():
    with pytest.raises(NotFittedError, match="call fit"):
        FrameScaler().transform(SEQUENCES)
    with pytest.raises(InputError, match="at least one sequence"):
        FrameScaler().fit([])
    with pytest.raises(InputError, match="'minmax', 'quantile' or 'std'"):
        FrameScaler("max").fit(SEQUENCES)
