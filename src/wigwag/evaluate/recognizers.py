"""Recognisers by name, as the benchmarks make them: wigwag's own, and what others published."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any
from typing import Protocol as TypingProtocol

from wigwag.errors import InputError
from wigwag.skeleton import Clip


class Recognizer(TypingProtocol):
    """What is benchmarked: a scikit-learn estimator over lists of clips."""

    def fit(self, clips: Sequence[Clip]) -> object:
        """Learn from labelled clips."""
        ...

    def predict(self, clips: Sequence[Clip]) -> Iterable[str]:
        """Return a label a clip."""
        ...


def _heavy(seed: int) -> Recognizer:
    from wigwag.recognise import HeavyRecognizer

    recognizer: Recognizer = HeavyRecognizer(random_state=seed)
    return recognizer


def _encoded(seed: int) -> Recognizer:
    from wigwag.recognise import EncodedRecognizer

    recognizer: Recognizer = EncodedRecognizer(random_state=seed)
    return recognizer


def _kernel(seed: int) -> Recognizer:
    from wigwag.recognise import KernelRecognizer

    recognizer: Recognizer = KernelRecognizer(random_state=seed)
    return recognizer


def _kernel_fast(seed: int) -> Recognizer:
    from wigwag.recognise import KernelRecognizer

    recognizer: Recognizer = KernelRecognizer(preset="fast", random_state=seed)
    return recognizer


def _classical(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import ClassicalRecognizer

    recognizer: Recognizer = ClassicalRecognizer()
    return recognizer


def _schneider(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import SchneiderRecognizer

    recognizer: Recognizer = SchneiderRecognizer()
    return recognizer


def _celebi(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import CelebiRecognizer

    recognizer: Recognizer = CelebiRecognizer(random_state=seed)
    return recognizer


def _rwigema(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import RwigemaRecognizer

    recognizer: Recognizer = RwigemaRecognizer(random_state=seed)
    return recognizer


def _aeon_dtw(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import AeonDtwRecognizer

    recognizer: Recognizer = AeonDtwRecognizer(random_state=seed)
    return recognizer


def _multirocket(seed: int) -> Recognizer:
    from wigwag.recognise.baselines import MultiRocketRecognizer

    recognizer: Recognizer = MultiRocketRecognizer(random_state=seed)
    return recognizer


RECOGNIZERS: dict[str, Callable[[int], Recognizer]] = {
    "kernel": _kernel,
    "kernel-fast": _kernel_fast,
    "heavy": _heavy,
    "encoded": _encoded,
}
"""Name to a maker that takes the seed. These are wigwag's own, and ``--recognizer all`` runs them."""

BASELINES: dict[str, Callable[[int], Recognizer]] = {
    "classical": _classical,
    "schneider": _schneider,
    "celebi": _celebi,
    "rwigema": _rwigema,
    "aeon-dtw": _aeon_dtw,
    "multirocket": _multirocket,
}
"""What others published, and libraries: see :mod:`wigwag.recognise.baselines`."""

SEEDLESS: frozenset[str] = frozenset({"heavy", "classical", "schneider", "aeon-dtw"})
"""Recognisers that decide the same whatever the seed: where the split is fixed, one run says all."""


NESTED: tuple[str, ...] = ("k", "width", "ridge")
"""Parameters that a recogniser chooses by leaving training people out if they are ``None``."""


def maker_of(recognizer: str, nested: bool = False) -> Callable[[int], Recognizer]:
    """Return what makes a recogniser from a seed.

    Args:
        recognizer: A name of ``RECOGNIZERS`` or ``BASELINES``.
        nested: Let it choose its settings inside its training people, where it can, instead of taking its
            defaults.

    Raises:
        InputError: If there is no such recogniser.
    """
    makers = RECOGNIZERS | BASELINES
    if recognizer not in makers:
        raise InputError(f"recognizer must be one of {', '.join(makers)}, but got {recognizer!r}.")
    make = makers[recognizer]
    return (lambda seed: _choosing(make(seed))) if nested else make


def _choosing(estimator: Any) -> Any:
    known = estimator.get_params()
    return estimator.set_params(**{name: None for name in NESTED if name in known})


def chosen(estimator: Any) -> str:
    """Say which settings a fitted recogniser has chosen for itself; empty if it has none to choose."""
    found = [(name, getattr(estimator, f"{name}_", None)) for name in NESTED]
    return ", ".join(f"{name} {value:g}" for name, value in found if value is not None)


__all__ = ["BASELINES", "NESTED", "RECOGNIZERS", "SEEDLESS", "Recognizer", "chosen", "maker_of"]
