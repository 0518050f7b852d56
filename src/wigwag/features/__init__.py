"""A clip becomes numbers: preparation in time, normalisation in space, embedding, scaling."""

from wigwag.features.embedding import Embedding
from wigwag.features.estimator import Classifier, Estimator, Transformer
from wigwag.features.normalise import Normalisation
from wigwag.features.prepare import Preparation
from wigwag.features.scale import FrameScaler

__all__ = [
    "Classifier",
    "Embedding",
    "Estimator",
    "FrameScaler",
    "Normalisation",
    "Preparation",
    "Transformer",
]
