"""What was recorded: gestures, and everyday life to stand between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from wigwag.datasets import msrc12, precog, utd_mhad, utkinect
from wigwag.datasets.recording import Mark, Recording
from wigwag.evaluate.stream.assembly import Shown
from wigwag.skeleton import Clip

TWINS: dict[str, str] = {
    "utkinect:walk": "a23", "utkinect:sitDown": "a25", "utkinect:standUp": "a24", "utkinect:throw": "a5",
    "utkinect:push": "a18", "utkinect:waveHands": "a3", "utkinect:clapHands": "a4", "precog": "a13",
    "msrc12:g2": "a27", "msrc12:g8": "a5", "simulated:wave": "a3", "simulated:clap": "a4",
    "simulated:throw": "a5", "simulated:arms_crossed": "a6",
}  # fmt: skip
"""Everyday movements that are the same movement as one of UTD-MHAD's gestures. A command of that name is
neither right nor false while they are shown; it is counted apart. PRECOG punches as a13 does; g2 ducks as
a27 squats."""

SEATED = ("utkinect:sitDown", "utkinect:standUp")
"""Whoever sits down gets up again: not shown between gestures where getting up is one."""

PIECE_S = (2.5, 5.0)
"""Shortest and longest piece of a recording without marked actions that is shown at once."""

LONGEST_HOLE_S = 0.5
"""A recorded action with a longer hole is not shown between gestures."""


@dataclass(frozen=True, slots=True)
class Material:
    """Everything that was read."""

    utd: list[Clip] = field(default_factory=list)
    """UTD-MHAD's recordings."""
    everyday: list[Shown] = field(default_factory=list)
    """Everyday movements of other sets' people, without a label."""
    streams: dict[str, list[Recording]] = field(default_factory=dict)
    """Whole recordings of other sets by its name; everything in them is a scene, nothing a mark."""
    msrc12: list[Recording] = field(default_factory=list)
    """MSRC-12 with its action points as marks."""


def read_material(data: Path) -> Material:
    """Read UTD-MHAD, and UTKinect, PRECOG and MSRC-12 as far as they are there.

    Args:
        data: Folder with ``utd_mhad``, ``utkinect``, ``precog`` and ``msrc12``.

    Raises:
        DataError: If UTD-MHAD is not there.
    """
    material = Material(utd=utd_mhad.load_skeletons(data / "utd_mhad").clips, streams=read_everyday(data))
    material.everyday.extend(_actions(material.streams.get("utkinect", [])))
    for recording in material.streams.get("precog", []):
        material.everyday.extend(_pieces(recording.stream, "precog"))
    if (data / "msrc12").exists():
        material.msrc12.extend(msrc12.load_recordings(data / "msrc12").recordings)
        # Nothing in it is a command of another vocabulary: all of a recording shows its one gesture.
        material.streams["msrc12"] = [
            Recording(r.stream, (), (_whole(r.stream, f"msrc12:{r.marks[0].label}"),))
            for r in material.msrc12
            if r.marks
        ]
    return material


def read_everyday(data: Path) -> dict[str, list[Recording]]:
    """Read whole recordings of everyday movement, their actions as scenes: UTKinect, PRECOG.

    Args:
        data: Folder with ``utkinect`` and ``precog``, or one of them, or none.
    """
    streams: dict[str, list[Recording]] = {}
    if (data / "utkinect").exists():
        streams["utkinect"] = [
            replace(r, scenes=tuple(replace(s, label=f"utkinect:{s.label}") for s in r.scenes))
            for r in utkinect.load_recordings(data / "utkinect").recordings
        ]
    if (data / "precog").exists():
        clips = precog.load_recordings(data / "precog").clips
        streams["precog"] = [Recording(clip, (), (_whole(clip, "precog"),)) for clip in clips]
    return streams


def taught(person: str) -> bool:
    """Say whether a person of the everyday sets is among those whose movements may be taught.

    Those with an odd number in UTKinect and PRECOG, and an even one in MSRC-12 (whose numbers here are
    multiples of three); the others are only judged.
    """
    number = int(person[-2:])
    return (number % 2 == 0) == person.startswith("msrc12")


def shown_between(material: Material, classes: Sequence[str]) -> list[Shown]:
    """Return everyday movements that may be shown between gestures of a vocabulary."""
    seat = {"a24", "a25"} & set(classes)
    kept = []
    for shown in material.everyday:
        twin = TWINS.get(shown.source) in classes and shown.source.startswith("utkinect")
        if not twin and not (seat and shown.source in SEATED):
            kept.append(shown)
    return kept


def _actions(recordings: Sequence[Recording]) -> list[Shown]:
    """Cut the actions out of recorded streams."""
    cut = []
    for recording in recordings:
        stream = recording.stream
        for number, scene in enumerate(recording.scenes):
            low, high = np.searchsorted(stream.stamps_ns, [scene.onset_ns, scene.end_ns + 1])
            stamps = stream.stamps_ns[low:high]
            if high - low < 4 or float(np.diff(stamps).max()) * 1e-9 > LONGEST_HOLE_S:
                continue
            name = f"{stream.name}_{number}_{scene.label.partition(':')[2]}"
            clip = Clip(stream.joints[low:high], stamps - stamps[0], None, stream.subject, name)
            cut.append(Shown(clip, scene.label))
    return cut


def _pieces(clip: Clip, source: str) -> list[Shown]:
    """Cut a recording into equal pieces of a length that is shown at once."""
    count = max(round(clip.duration_s / (sum(PIECE_S) / 2)), 1)
    edges = np.linspace(0, len(clip), count + 1).astype(int)
    return [
        Shown(replace(_part(clip, low, high), name=f"{clip.name}_{number}"), source)
        for number, (low, high) in enumerate(pairwise(edges))
    ]


def _part(clip: Clip, low: int, high: int) -> Clip:
    stamps = clip.stamps_ns[low:high]
    return replace(clip, joints=clip.joints[low:high], stamps_ns=stamps - stamps[0])


def _whole(clip: Clip, source: str) -> Mark:
    return Mark(source, int(clip.stamps_ns[0]), int(clip.stamps_ns[-1]))


__all__ = [
    "LONGEST_HOLE_S",
    "PIECE_S",
    "SEATED",
    "TWINS",
    "Material",
    "read_material",
    "shown_between",
    "taught",
]
