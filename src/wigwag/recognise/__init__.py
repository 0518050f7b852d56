"""A clip becomes a gesture: the Heavy and Encoded recognisers."""

from wigwag.recognise.encoded import EncodedRecognizer
from wigwag.recognise.heavy import HeavyRecognizer

__all__ = ["EncodedRecognizer", "HeavyRecognizer"]
