"""Flights in the sketched world, written down."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.evaluate.prompted import PromptedFlight
from wigwag.fly.values import Command
from wigwag.pilot import PilotConfig, Step
from wigwag.record.recorder import Recorder
from wigwag.sim.response import Response, ResponseConfig
from wigwag.sim.sketch import SketchWorld

SAID = {45: Command.TAKE_OFF, 240: Command.LEFT, 330: Command.STOP, 370: Command.LAND}
SMALL = Intrinsics(60.0, 60.0, 32.0, 24.0, 64, 48)


def flight(seed: int = 3, config: PilotConfig | None = None) -> PromptedFlight:
    airframe = Response(ResponseConfig(position_m=(0.0, 0.0, 0.0)), seed)
    return PromptedFlight(SketchWorld(airframe, lambda t: (4.5, 0.3), seed=seed), config)


def picture(turn: int, lens: Intrinsics = SMALL) -> Frame:
    """A frame with something in it that is another in every turn."""
    rng = np.random.default_rng(turn)
    rgb = np.zeros((lens.height, lens.width, 3), np.uint8)
    rgb[:, :, :] = rng.integers(0, 255, 3, dtype=np.uint8)
    rgb[: lens.height // 2] += rng.integers(0, 9, (lens.height // 2, lens.width, 3), dtype=np.uint8)
    depth = np.full((lens.height, lens.width), 4000 + turn, np.uint16)
    return Frame(rgb, depth, lens, round(turn * 1e9 / 30))


def record(path: Path, turns: int = 420, pictures: bool = False, **options: Any) -> list[Step]:
    """Fly for so many turns and write it down."""
    flown, steps = flight(), []
    options.setdefault("pictures", "jpeg" if pictures else "none")
    recorder = Recorder(path, flown.pilot, patient=True, **options)
    for turn in range(turns):
        step = flown.turn(SAID.get(turn))
        recorder.turn(picture(turn), flown.world.now_ns, step)
        steps.append(step)
    recorder.close(ended="all well")
    assert not recorder.failed
    return steps
