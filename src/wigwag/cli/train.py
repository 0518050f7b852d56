"""``wigwag train``: a folder of clips becomes a model."""

from __future__ import annotations

import shlex
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class Train:
    """Teach a model from recorded clips.

    Clips without a label (folder "none") are movements that are no gesture; with some of them, a model says
    no more surely. How sure to be is learned by leaving people out: clips of several help.

    Exit code: 0 trained, 1 some clips could not be read and were left out, 2 wrong input.
    Example: wigwag train clips -o mine.wigwag
    """

    clips: tyro.conf.Positional[Path]
    """Folder of clips: <label>/<name>.json, as wigwag teach keeps them."""
    output: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """File of the model; an old one is replaced."""
    recognizer: Literal["kernel", "stream"] = "kernel"
    """Kind of model: names a movement once it is over, or while it goes on."""
    seed: int = 0
    """Of varied copies."""
    json: Path | None = None
    """File for the figures: one record."""

    def run(self) -> int:
        """Read, teach, save; return 0, or 1 if clips were left out."""
        from wigwag.cli.benchmark_text import read, wide_console
        from wigwag.cli.targets import check_file
        from wigwag.datasets.folder import load_folder
        from wigwag.evaluate.records import Records
        from wigwag.evaluate.taught import train

        command = ["wigwag", "train", str(self.clips), "-o", str(self.output)]
        command += ["--recognizer", self.recognizer, "--seed", str(self.seed)]
        records = Records(self.json, shlex.join(command), self.seed)
        check_file(self.output, "--output")
        console = wide_console()
        loaded = read(console, str(self.clips), lambda _: load_folder(self.clips))
        with console.status("teaching"):
            student = train(loaded.clips, self.recognizer, self.seed)
            student.save(self.output)
        counts = Counter(clip.label for clip in loaded.clips)
        for label in sorted(label for label in counts if label is not None):
            people = len({clip.subject for clip in loaded.clips if clip.label == label})
            console.print(
                f"  {label}: {counts[label]} clips of {people} people", highlight=False, soft_wrap=True
            )
        console.print(f"{self.output}: {len(student.known)} gestures.", highlight=False, soft_wrap=True)
        records.add(
            model=str(self.output),
            kind=type(student.model).__name__,
            gestures=list(student.known),
            clips=len(loaded.clips),
            without_label=counts[None],
            left_out=[list(item) for item in loaded.left_out],
        )
        return 1 if loaded.left_out else 0


__all__ = ["Train"]
