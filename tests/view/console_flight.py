"""A flight with a console in a process of its own: rendered pixels, the real networks, prompted commands.

``python -m tests.view.console_flight PORT SECONDS [TOKEN]`` flies one to look at.
"""

from __future__ import annotations

import io
import sys
import time
from contextlib import ExitStack
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from rich.console import Console as Terminal

from wigwag.camera.frame import Frame
from wigwag.cli.flying import Flying
from wigwag.evaluate.prompted import Nobody, Prompter
from wigwag.fly.situation import Mode
from wigwag.fly.values import Command
from wigwag.pilot import Pilot, Step
from wigwag.pose.estimator import PoseConfig, PoseEstimator
from wigwag.rig import open_rig
from wigwag.view.console.config import ConsoleConfig
from wigwag.view.console.console import Console
from wigwag.view.onlookers import Onlookers


class Teller:
    """Stands where the recorder goes, and tells of every turn: when it was, and what was decided."""

    failed = ""
    path = "nowhere"
    left_out = 0

    def __init__(self, link: Connection | None, prompter: Prompter, pilot: Pilot) -> None:
        self.pilot, self.link, self.prompter, self.orbiting = pilot, link, prompter, False

    def turn(self, frame: Frame | None, now_ns: int, step: Step) -> None:
        mode, now_s = step.verdict.mode, step.situation.now_ns * 1e-9
        if mode is Mode.DISARMED and 2.0 < now_s < 4.0:
            self.prompter.says = Command.TAKE_OFF
        elif mode is Mode.FOLLOWING and not step.situation.moving and not self.orbiting:
            self.prompter.says, self.orbiting = Command.ORBIT, True
        if self.link is not None:
            velocity = np.asarray(step.state.velocity_m_s, float)
            speed = float(np.hypot(velocity[0], velocity[1]))
            self.link.send(
                {
                    "wall_s": time.time(), "now_s": now_s, "mode": mode.value, "speed": speed,
                    "row": step.verdict.row, "withheld": step.situation.withheld,
                    "limit": self.pilot.supervisor.config.max_speed_m_s,
                    "position": step.state.position_m.tolist(), "sent": step.permit.setpoint,
                }
            )  # fmt: skip

    def close(self, **note: Any) -> None:
        pass


def fly(link: Connection | None, seconds: float, **where: Any) -> None:
    """Fly with a page at an address; tell by a link where it is, and of every turn."""
    with ExitStack() as stack:
        page = Console(ConsoleConfig(**where))
        stack.callback(page.close)
        print(page.url, flush=True)
        if link is not None:
            link.send({"url": page.url})
        rig = stack.enter_context(open_rig("sim:?seed=2", "sim:"))
        eyes = PoseEstimator(PoseConfig.alone())
        pilot = Pilot(eyes, Nobody(), rig.vehicle, in_the_air=Mode.HOLDING)
        prompter = pilot.spotter = Prompter()  # type: ignore[assignment]
        teller = Teller(link, prompter, pilot)
        terminal = Terminal(file=io.StringIO())
        Flying(terminal, rig, pilot, teller, False, seconds, Onlookers(None, page)).fly()  # type: ignore[arg-type]


if __name__ == "__main__":
    fly(None, float(sys.argv[2]), port=int(sys.argv[1]), token=(sys.argv[3:] or [None])[0])
