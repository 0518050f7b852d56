"""``wigwag vocabulary check``: is it a good set of gestures, before anybody flies by it."""

from __future__ import annotations

import shlex
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import tyro

if TYPE_CHECKING:
    from rich.console import Console

    from wigwag.datasets.recording import Recording
    from wigwag.evaluate.vocabulary import VocabularyReport
    from wigwag.skeleton import Clip


@dataclass(frozen=True)
class Vocabulary:
    """Say which of your gestures are too alike, look like everyday movement, or are never decided early.

    Exit code 1: something is too alike.

    Example: wigwag vocabulary check clips --out pictures
    """

    action: tyro.conf.Positional[Literal["check"]] = "check"
    """What to do with the gestures."""
    clips: tyro.conf.Positional[Path | None] = None
    """Folder of your clips, <label>/<name>.json; or a saved model, of which less can be said. Or --data."""
    data: Path | None = None
    """UTD-MHAD's folder: check its classes instead."""
    labels: tuple[str, ...] = ()
    """Only these gestures, such as a1 a6 a7; none named: all."""
    people: tuple[str, ...] = ()
    """Only what these people show, such as s1 s3; none named: all."""
    everyday: Path | None = None
    """Folder with utkinect and precog: everyday movements beside the simulated ones."""
    out: Path | None = None
    """Folder for pictures of what is alike."""
    json: Path | None = None
    """File for the findings, one a pair and one a gesture."""
    seed: int = 0
    """Of simulated people and varied copies."""

    def run(self) -> int:
        """Check, print what was found, draw it; 1 if a pair is too alike."""
        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.cli.targets import make_folder
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.vocabulary import check_model, check_vocabulary
        from wigwag.evaluate.vocabulary_pictures import draw_report

        console = wide_console()
        name = "wigwag vocabulary check" + (f" {shlex.quote(str(self.clips))}" if self.clips else "")
        records = Records(self.json, command_line(name, replace(self, clips=None)), self.seed)
        everyday = self._everyday()
        clips: list[Clip] = []
        if self.clips is not None and self.clips.is_file():
            with bar_of_steps(console) as bar:
                report = check_model(self.clips, everyday, seed=self.seed, progress=bar("checking"))
        else:
            if self.out is not None:
                make_folder(self.out, "--out")
            clips = self._clips(console)
            with bar_of_steps(console) as bar:
                report = check_vocabulary(clips, everyday, seed=self.seed, progress=bar("checking"))
        for gesture in report.gestures:
            records.add(kind="gesture", protocol=report.protocol, **asdict(gesture))
        for pair in report.pairs:
            records.add(kind="pair", protocol=report.protocol, **asdict(pair))
        _say(console, report)
        if self.out is not None and clips:
            for path in draw_report(report, clips, self.out):
                console.print(f"Picture: {path}")
        return 1 if report.too_alike else 0

    def _clips(self, console: Console) -> list[Clip]:
        from wigwag.cli.benchmark_text import read
        from wigwag.datasets.folder import load_folder
        from wigwag.datasets.utd_mhad import load_skeletons
        from wigwag.errors import InputError

        if (self.clips is None) == (self.data is None):
            raise InputError("Give either a folder of clips or --data with UTD-MHAD's folder.")
        folder, data = self.clips, self.data
        loaded = (
            read(console, "UTD-MHAD", lambda bar: load_skeletons(data, progress=bar))
            if data is not None
            else read(console, "clips", lambda _: load_folder(folder or Path()))
        )
        chosen = [
            clip
            for clip in loaded.clips
            if clip.label is not None
            and (not self.labels or clip.label in self.labels)
            and (not self.people or clip.subject in self.people)
        ]
        if absent := sorted(set(self.labels) - {str(clip.label) for clip in chosen}):
            raise InputError(f"There is no clip of {', '.join(absent)}.")
        return chosen

    def _everyday(self) -> list[Recording]:
        from wigwag.evaluate.stream.material import read_everyday

        if self.everyday is None:
            return []
        streams = read_everyday(self.everyday)
        return [recording for name in ("utkinect", "precog") for recording in streams.get(name, [])]


def _say(console: Console, report: VocabularyReport) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from wigwag.evaluate.vocabulary_pictures import say

    table = Table(title=f"Gestures ({report.protocol})", box=SIMPLE_HEAD)
    table.add_column("gesture")
    for column in (
        "examples",
        "people",
        "found %",
        "before the end %",
        "seen by then %",
        "named an hour idle",
    ):
        table.add_column(column, justify="right")
    table.add_column("")
    for g in report.gestures:
        table.add_row(
            g.label,
            str(g.examples),
            str(g.people),
            _share(g.found),
            _share(g.early),
            _share(g.seen),
            f"{g.everyday_per_hour:.1f}",
            "; ".join([*g.verdicts, *(g.everyday_of if g.everyday_per_hour else ())]),
        )
    console.print(table)
    for pair in report.pairs:
        if pair.verdict != "apart":
            colour = "red" if pair.verdict == "too alike" else "yellow"
            console.print(f"[{colour}]{pair.first} and {pair.second}:[/] {say(pair)}", highlight=False)
    alike = len(report.too_alike)
    console.print(
        f"{alike} pair(s) too alike, of {len(report.pairs)}; idle: {report.everyday_hours:.2f} h of everyday "
        "movement.",
        highlight=False,
    )


def _share(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.0f}"


__all__ = ["Vocabulary"]
