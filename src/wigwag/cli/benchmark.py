"""``wigwag benchmark``: remake every published figure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import tyro

from wigwag.cli.benchmark_camera import CameraBenchmark
from wigwag.cli.benchmark_console import ConsoleBenchmark
from wigwag.cli.benchmark_dtw import DtwBenchmark
from wigwag.cli.benchmark_far import FarBenchmark
from wigwag.cli.benchmark_faults import FaultsBenchmark
from wigwag.cli.benchmark_few_shot import FewShotBenchmark
from wigwag.cli.benchmark_follow import FollowBenchmark
from wigwag.cli.benchmark_gallery import GalleryBenchmark
from wigwag.cli.benchmark_lift import LiftBenchmark
from wigwag.cli.benchmark_link import LinkBenchmark
from wigwag.cli.benchmark_mission import MissionBenchmark
from wigwag.cli.benchmark_monocular import MonocularBenchmark
from wigwag.cli.benchmark_operator import OperatorBenchmark
from wigwag.cli.benchmark_pose import PoseBenchmark
from wigwag.cli.benchmark_record import RecordBenchmark
from wigwag.cli.benchmark_reject import RejectBenchmark
from wigwag.cli.benchmark_smooth import SmoothBenchmark
from wigwag.cli.benchmark_stream import StreamBenchmark
from wigwag.cli.benchmark_teach import TeachBenchmark
from wigwag.cli.benchmark_transfer import TransferBenchmark
from wigwag.cli.benchmark_utd_mhad import UtdMhadBenchmark


@dataclass(frozen=True)
class Benchmark:
    """Remake the published figures; each benchmark prints a table and writes JSON records.

    Example: wigwag benchmark faults --json faults.json
    """

    benchmark: tyro.conf.OmitArgPrefixes[
        tyro.conf.OmitSubcommandPrefixes[
            Annotated[UtdMhadBenchmark, tyro.conf.subcommand("utd-mhad")]
            | Annotated[LiftBenchmark, tyro.conf.subcommand("lift")]
            | Annotated[PoseBenchmark, tyro.conf.subcommand("pose")]
            | Annotated[CameraBenchmark, tyro.conf.subcommand("camera")]
            | Annotated[ConsoleBenchmark, tyro.conf.subcommand("console")]
            | Annotated[FarBenchmark, tyro.conf.subcommand("far")]
            | Annotated[MonocularBenchmark, tyro.conf.subcommand("monocular")]
            | Annotated[SmoothBenchmark, tyro.conf.subcommand("smooth")]
            | Annotated[DtwBenchmark, tyro.conf.subcommand("dtw")]
            | Annotated[GalleryBenchmark, tyro.conf.subcommand("gallery")]
            | Annotated[FewShotBenchmark, tyro.conf.subcommand("few-shot")]
            | Annotated[RejectBenchmark, tyro.conf.subcommand("reject")]
            | Annotated[FaultsBenchmark, tyro.conf.subcommand("faults")]
            | Annotated[FollowBenchmark, tyro.conf.subcommand("follow")]
            | Annotated[LinkBenchmark, tyro.conf.subcommand("link")]
            | Annotated[MissionBenchmark, tyro.conf.subcommand("mission")]
            | Annotated[OperatorBenchmark, tyro.conf.subcommand("operator")]
            | Annotated[TransferBenchmark, tyro.conf.subcommand("transfer")]
            | Annotated[RecordBenchmark, tyro.conf.subcommand("record")]
            | Annotated[StreamBenchmark, tyro.conf.subcommand("stream")]
            | Annotated[TeachBenchmark, tyro.conf.subcommand("teach")]
        ]
    ]

    def run(self) -> int:
        """Run the chosen benchmark and return its exit code."""
        return self.benchmark.run()


__all__ = ["Benchmark"]
