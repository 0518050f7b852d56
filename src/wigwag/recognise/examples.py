"""What recognisers are taught with: clips, labels, and whose clips they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from wigwag.errors import InputError
from wigwag.skeleton import Clip


def check_clips(clips: Sequence[Clip]) -> None:
    """Refuse anything in a list that is no clip, and a clip that is not in a list.

    Raises:
        InputError: Naming the element.
    """
    if isinstance(clips, Clip):
        raise InputError(
            f"A recogniser takes a list of wigwag.skeleton.Clip, but got one clip, {clips.name!r}. "
            "Put it in a list, or hand it to recognise."
        )
    for i, clip in enumerate(clips):
        if not isinstance(clip, Clip):
            raise InputError(
                f"A recogniser takes a list of wigwag.skeleton.Clip, but element {i} is "
                f"{type(clip).__name__}. Build clips with Clip.at_rate or Clip.from_poses."
            )


def labels_of(clips: Sequence[Clip], y: Sequence[str | None] | np.ndarray | None) -> list[str | None]:
    """Return one label a clip: those of ``y``, or the clips' own.

    Raises:
        InputError: If there are no clips, not as many labels, or no label at all.
    """
    if len(clips) == 0:
        raise InputError("fit needs at least one labelled clip, but got an empty list.")
    check_clips(clips)
    labels = [clip.label for clip in clips] if y is None else [None if v is None else str(v) for v in y]
    if len(labels) != len(clips):
        raise InputError(f"fit needs one label a clip, but got {len(labels)} for {len(clips)} clips.")
    if all(label is None for label in labels):
        raise InputError(
            "fit needs clips of at least one gesture, but every label is None. Set Clip.label or give y."
        )
    return labels


def people_of(clips: Sequence[Clip]) -> Int[np.ndarray, " clips"]:
    """Number the people; where none or one alone is known, every clip counts as somebody else's."""
    subjects = [clip.subject for clip in clips]
    known = {subject for subject in subjects if subject is not None}
    if len(known) < 2:
        return np.arange(len(clips))
    names = [f"#{i}" if subject is None else subject for i, subject in enumerate(subjects)]
    return np.asarray(np.unique(names, return_inverse=True)[1])
