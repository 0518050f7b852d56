"""A clip becomes a gesture: wigwag's ``KernelRecognizer``, and the paper's two."""

from wigwag.recognise.encoded import EncodedRecognizer
from wigwag.recognise.heavy import HeavyRecognizer
from wigwag.recognise.kernel import KernelRecognizer

__all__ = ["EncodedRecognizer", "HeavyRecognizer", "KernelRecognizer"]
