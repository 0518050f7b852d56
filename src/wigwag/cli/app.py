"""Which commands there are, and how their errors reach a person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import tyro
from rich.console import Console

from wigwag.errors import WigwagError


def run(argv: Sequence[str] | None = None) -> int:
    """Parse the command line, run the command, return the exit code."""
    from wigwag.cli.doctor import Doctor

    commands = Annotated[Doctor, tyro.conf.subcommand("doctor")]
    command = tyro.cli(commands, prog="wigwag", args=argv, description=__doc__)
    try:
        return command.run()
    except WigwagError as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False)
        return 2
    except KeyboardInterrupt:
        return 130
