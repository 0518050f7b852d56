"""Which commands there are, and how their errors reach a person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Protocol

import tyro
from rich.console import Console
from rich.markup import escape

from wigwag.cli.benchmark import Benchmark
from wigwag.cli.clips import Clips
from wigwag.cli.console import ConsoleCommand
from wigwag.cli.demo import Demo
from wigwag.cli.doctor import Doctor
from wigwag.cli.evaluate import Evaluate
from wigwag.cli.explain import Explain
from wigwag.cli.flight import FlightCommand
from wigwag.cli.fly import Fly
from wigwag.cli.gestures import Gestures
from wigwag.cli.pose import PoseCommand
from wigwag.cli.replay import ReplayCommand
from wigwag.cli.teach import Teach
from wigwag.cli.train import Train
from wigwag.cli.vocabulary import Vocabulary
from wigwag.cli.watch import Watch
from wigwag.errors import WigwagError


class Runnable(Protocol):
    """A parsed command."""

    def run(self) -> int:
        """Do it and return the exit code."""
        ...


Commands = (
    Annotated[Demo, tyro.conf.subcommand("demo")]
    | Annotated[Fly, tyro.conf.subcommand("fly")]
    | Annotated[ConsoleCommand, tyro.conf.subcommand("console")]
    | Annotated[ReplayCommand, tyro.conf.subcommand("replay")]
    | Annotated[Explain, tyro.conf.subcommand("explain")]
    | Annotated[FlightCommand, tyro.conf.subcommand("flight")]
    | Annotated[Benchmark, tyro.conf.subcommand("benchmark")]
    | Annotated[PoseCommand, tyro.conf.subcommand("pose")]
    | Annotated[Teach, tyro.conf.subcommand("teach")]
    | Annotated[Gestures, tyro.conf.subcommand("gestures")]
    | Annotated[Train, tyro.conf.subcommand("train")]
    | Annotated[Evaluate, tyro.conf.subcommand("evaluate")]
    | Annotated[Vocabulary, tyro.conf.subcommand("vocabulary")]
    | Annotated[Watch, tyro.conf.subcommand("watch")]
    | Annotated[Clips, tyro.conf.subcommand("clips")]
    | Annotated[Doctor, tyro.conf.subcommand("doctor")]
)


def run(argv: Sequence[str] | None = None) -> int:
    """Parse the command line, run the command, return the exit code."""
    command: Runnable = tyro.cli(
        Commands,
        prog="wigwag",
        args=argv,
        description="Fly a drone with your body.",
        config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.OmitArgPrefixes),
    )
    try:
        return command.run()
    except WigwagError as error:
        Console(stderr=True).print(
            f"[bold red]error:[/] {escape(str(error))}", highlight=False, soft_wrap=True
        )
        return 2
    except OSError as error:
        if error.filename is None:  # no file or folder that somebody named: a fault of ours
            raise
        text = f"{error.filename}: {error.strerror}"
        Console(stderr=True).print(f"[bold red]error:[/] {escape(text)}", highlight=False, soft_wrap=True)
        return 2
    except KeyboardInterrupt:
        Console(stderr=True).print("stopped")
        return 130
