"""A clip becomes numbers: preparation in time, normalisation in space, embedding, scaling."""

from wigwag.features.embedding import Embedding
from wigwag.features.normalise import Normalisation
from wigwag.features.prepare import Preparation
from wigwag.features.scale import FrameScaler

__all__ = ["Embedding", "FrameScaler", "Normalisation", "Preparation"]
