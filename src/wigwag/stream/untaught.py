"""Gestures that are no commands stand in, some at a time, for all the gestures that nobody teaches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from wigwag.stream.truth import Showing
from wigwag.stream.watcher import Hypothesis

TAUGHT = -1
"""Stands for 'never left out' where groups are numbers."""

GROUPS = 3
"""So many parts of the gestures that are no commands are left out in turn."""


class Untaught:
    """Parts the gestures that are no commands into groups.

    With every person left out in turn, a model knows every *movement* it is asked about: it learns how sure
    to be of strangers, but not of strange gestures, and takes what it never saw for the command that it is
    most like. So the gestures that are known by name and kept silent are left out too, some at a time; what
    the rest makes of them teaches doubt.

    Args:
        labels: All gestures.
        commands: Those that may be spoken; ``None``: all, so that none stands in for the untaught.
        rng: Parts them.
    """

    def __init__(
        self, labels: Sequence[str], commands: Sequence[str] | None, rng: np.random.Generator
    ) -> None:
        silent = [] if commands is None else [i for i, label in enumerate(labels) if label not in commands]
        self.of_label: Int[np.ndarray, " labels"] = np.full(len(labels), TAUGHT)
        """The group of each label; ``TAUGHT``: a command."""
        self.of_label[rng.permutation(silent).astype(np.int64)] = np.arange(len(silent)) % GROUPS
        self.count = min(len(silent), GROUPS)
        self._number = {label: i for i, label in enumerate(labels)}

    def of(self, hypothesis: Hypothesis, truth: Sequence[Showing]) -> int:
        """Return the group of the gesture that a stretch shares most time with."""
        group, most = TAUGHT, 0
        for showing in truth:
            shared = min(hypothesis.now_ns, showing.end_ns) - max(hypothesis.onset_ns, showing.onset_ns)
            if shared > most:
                group, most = int(self.of_label[self._number[showing.label]]), shared
        return group
