"""scikit-learn takes our estimators for its own, though they do not import it."""

import subprocess
import sys

import numpy as np
import pytest
from sklearn.base import clone, is_classifier
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import make_pipeline

from tests.recognise.people import GESTURES, clips
from wigwag.errors import InputError
from wigwag.features import Embedding, FrameScaler
from wigwag.recognise import HeavyRecognizer

CLIPS = clips(GESTURES, range(3))
LABELS = [clip.label for clip in CLIPS]


def test_parameters_go_round():
    scaler = FrameScaler("std", weights=np.ones(3))
    assert clone(scaler).get_params()["method"] == "std"
    assert scaler.set_params(method="minmax") is scaler
    assert scaler.method == "minmax"
    assert repr(Embedding(triples="all")) == "Embedding(triples='all')"
    with pytest.raises(InputError, match=r"Embedding has no parameter 'triple'.*triples, displacement"):
        Embedding().set_params(triple="all")


def test_transformers_stand_in_a_pipeline():
    pipeline = make_pipeline(Embedding(), FrameScaler())
    scaled = pipeline.fit_transform(CLIPS)
    np.testing.assert_array_equal(scaled[2], FrameScaler().fit_transform(Embedding().fit_transform(CLIPS))[2])


def test_recognisers_are_cross_validated_and_searched():
    recogniser = HeavyRecognizer(k=1)
    assert is_classifier(recogniser)
    clips_and_labels = np.array(CLIPS, dtype=object), np.array(LABELS)
    np.testing.assert_array_equal(cross_val_score(recogniser, *clips_and_labels, cv=2), 1.0)
    search = GridSearchCV(recogniser, {"k": [1, 3]}, cv=2).fit(*clips_and_labels)
    assert search.best_params_["k"] in (1, 3)
    assert search.predict(CLIPS[:3]).tolist() == LABELS[:3]


def test_deciding_does_not_import_what_teaching_needs():
    code = "import sys, wigwag.recognise, wigwag.distances; print('sklearn' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
