"""What ``KernelRecognizer`` is set to, and what was measured to set it so."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.features.views import View


@dataclass(frozen=True, slots=True)
class KernelPreset:
    """What a preset stands for; see :class:`KernelRecognizer`."""

    frames: int
    band: int
    n_dims: int
    kinds: tuple[View, ...]


_KINDS: tuple[View, ...] = (
    "positions", "bones", "directions", "distances", "accelerations", "hands", "trunk",
)  # fmt: skip

PRESETS: dict[str, KernelPreset] = {
    "fast": KernelPreset(frames=20, band=5, n_dims=12, kinds=_KINDS),
    "accurate": KernelPreset(frames=40, band=10, n_dims=12, kinds=_KINDS),
}
"""Chosen by teaching two of UTD-MHAD's training subjects 1, 3, 5, 7 and testing the other two: log loss
0.090, 0.069 and 0.051 at 16, 20 and 40 frames (two copies a clip). 64 frames, wider bands and both origins at
once add little."""

FEW = 2
"""With fewer examples of a gesture, each view learns by itself: one of another person is recognised at 90.2
instead of 87.8 % and one's own alone at 99.7 instead of 99.4 % (four copies a clip, training people).
With two or more, all views at once are right more often."""

ENOUGH_EXAMPLES = 1000
FEWEST_COPIES, MOST_COPIES = 2, 8
"""Copies matter most where there is little to learn from: one example a class of other people is recognised
at 85.5, 87.5, 87.8 and 87.9 % with 1, 2, 4 and 8 copies, two people at log loss 0.054, 0.051 and 0.048 with
1, 2 and 4. Learning from more than so many in all takes longer than it is worth."""
