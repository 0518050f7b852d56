"""What others do: published recognisers and libraries behind our interface, for the benchmarks alone."""

from wigwag.recognise.baselines.celebi import CelebiRecognizer
from wigwag.recognise.baselines.classical import ClassicalRecognizer
from wigwag.recognise.baselines.peers import AeonDtwRecognizer, MultiRocketRecognizer
from wigwag.recognise.baselines.rwigema import RwigemaRecognizer
from wigwag.recognise.baselines.schneider import SchneiderRecognizer

__all__ = [
    "AeonDtwRecognizer",
    "CelebiRecognizer",
    "ClassicalRecognizer",
    "MultiRocketRecognizer",
    "RwigemaRecognizer",
    "SchneiderRecognizer",
]
