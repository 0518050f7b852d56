"""``wigwag benchmark stream``: commands in streams of poses, and above all those that nobody gave."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.table import Table


Data = Literal[
    "utd-mhad",
    "own",
    "own+others",
    "msrc12",
    "utkinect",
    "precog",
    "msrc12-negative",
    "simulated",
    "cost",
    "all",
]

Fault = Literal["missing", "jitter", "gap", "swapped", "stranger", "nan", "all"]


@dataclass(frozen=True)
class StreamBenchmark:
    """Let a taught system watch hours of poses: gestures of people it never met, everyday life between.

    Example: wigwag benchmark stream --data-dir DATA --json stream.json
    """

    data_dir: Path
    """Folder with utd_mhad, and utkinect, precog and msrc12 as far as you have them."""
    data: tuple[Data, ...] = ("all",)
    """utd-mhad: streams assembled of people never met. own: of people who enrolled one example of each
    gesture; own+others: beside what others taught. msrc12: its 12 gestures. utkinect, precog,
    msrc12-negative, simulated: only movements that are no command. cost: time and memory, an hour long."""
    vocabulary: tuple[Literal["6", "7", "27"], ...] = ("6",)
    """Which of UTD-MHAD's classes are commands."""
    system: tuple[str, ...] = ("stream", "spotter")
    """What is judged: stream, spotter; stream+deliberate, which is besides taught as no command what
    MSRC-12's people with an even number show."""
    inner: bool = False
    """Judge training people by each other instead: the figures by which settings may be chosen."""
    rounds: int = 8
    """How often every judged recording is shown, each time in another order and between other movements."""
    rate_hz: float = 30.0
    """Poses a second, 10 to 60."""
    corrupt: tuple[Fault, ...] = ()
    """Faults with which everything is shown once more."""
    seed: int = 0
    """Of orders and rests."""
    json: Path | None = None
    """File for the records; kept up to date row by row."""

    def run(self) -> int:
        """Run everything asked for; print the table, write the records."""
        from wigwag.cli.benchmark_text import bar_of_steps, wide_console
        from wigwag.evaluate.records import Records, command_line
        from wigwag.evaluate.stream.corrupt import CORRUPTIONS
        from wigwag.evaluate.stream.cost import run_cost
        from wigwag.evaluate.stream.material import read_material
        from wigwag.evaluate.stream.plan import SHOWS, StreamBenchmarkConfig
        from wigwag.evaluate.stream.run import run_system
        from wigwag.evaluate.stream.systems import system_of

        for system in self.system:
            system_of(system)
        console = wide_console()
        records = Records(self.json, command_line("wigwag benchmark stream", self), self.seed)
        with console.status("Reading"):
            material = read_material(self.data_dir)
        shows = [show for show in SHOWS if show in self.data or "all" in self.data]
        faults = tuple(kind for kind in CORRUPTIONS if kind in self.corrupt or "all" in self.corrupt)
        with bar_of_steps(console) as bar:
            for vocabulary in self.vocabulary if shows else ():
                config = StreamBenchmarkConfig(
                    vocabulary,
                    self.inner,
                    self.rounds,
                    rate_hz=self.rate_hz,
                    corrupt=faults,
                    seed=self.seed,
                )
                for system in self.system:
                    title = f"{system}, {vocabulary} classes"
                    for record in run_system(material, system, shows, config, progress=bar(title)):
                        row = records.add(**record)
                        console.print(_line(row), highlight=False)
            for system in self.system if {"cost", "all"} & set(self.data) else ():
                records.add(**run_cost(material, system, seed=self.seed, progress=bar("cost")))
        if shows:
            console.print(_table([row for row in records.rows if row["data"] != "cost"]))
        for row in records.rows:
            if row["data"] == "cost":
                console.print(_cost(row), highlight=False)
        if self.json is not None:
            console.print(f"Records: {self.json}")
        return 0


def _line(row: dict[str, Any]) -> str:
    """Say what is known as soon as it is."""
    from wigwag.evaluate.stream.tables import stream_of

    score = row["event_f1"] if row["action_point_f1"] is None else row["action_point_f1"]
    found = "" if score is None else f"F1 {score:.3f}, "
    return (
        f"{row['system']}, {stream_of(row)}: {found}{row['false_commands']} false in {row['hours']:.2f} h, "
        f"{row['ms_per_pose_mean']:.2f} ms a pose"
    )


def _table(rows: list[dict[str, Any]]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    from wigwag.evaluate.stream.tables import stream_of

    table = Table(
        title="Commands in streams",
        caption="false/h: commands that nobody gave, with the exact Poisson interval of one pass over "
        "the material. delay: from the gesture's true end to the decision. seen: share of it by then.",
        box=SIMPLE_HEAD,
    )
    for column in ("system", "data", "classes"):
        table.add_column(column, no_wrap=True)
    columns = (
        "hours",
        "events",
        "F1",
        "found %",
        "false/h (95 %)",
        "Jaccard",
        "delay s",
        "seen %",
        "ms a pose",
    )
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        low, high = row["false_commands_ci95"]
        table.add_row(
            row["system"],
            stream_of(row),
            row["vocabulary"],
            f"{row['hours']:.2f}",
            str(row["events"]),
            _number(row["event_f1"] if row["action_point_f1"] is None else row["action_point_f1"], 3),
            _number(row["detection_rate"], 1, 100),
            f"{row['false_commands_per_hour']:.1f} ({low:.1f}-{high:.1f})",
            _number(row["jaccard"], 3),
            _number(row["delay_from_end_s_median"], 2),
            _number(row["share_seen_median"], 0, 100),
            f"{row['ms_per_pose_mean']:.3f}",
        )
    return table


def _cost(row: dict[str, Any]) -> str:
    mean, median, most = (row[f"ms_per_pose_{name}"] for name in ("mean", "median", "p99"))
    return (
        f"{row['system']}, {row['gestures']} gestures, {row['hours']:.2f} h: {mean:.3f} ms a pose (median "
        f"{median:.3f}, 99 % below {most:.3f}, at most {row['ms_per_pose_max']:.1f}); last quarter to first "
        f"{row['last_to_first_quarter']:.2f}; memory {row['rss_mb']:.0f} MB, {row['rss_growth_mb']:+.1f} MB "
        "since the first minute."
    )


def _number(value: float | None, digits: int, times: float = 1.0) -> str:
    return "" if value is None else f"{value * times:.{digits}f}"


__all__ = ["StreamBenchmark"]
