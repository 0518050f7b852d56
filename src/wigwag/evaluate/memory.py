"""How much memory the way from pictures to poses takes: run as a program, in a process of its own."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wigwag.pose.engine import EngineName, ModelName


def peak_mb() -> float:
    """Return the most memory this process has held so far, MB.

    ``getrusage`` would count what the process that started this one held.
    """
    status = Path("/proc/self/status")
    if status.exists():
        return _kilobytes(status.read_text(), "VmHWM") / 1024
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)


def _kilobytes(status: str, name: str) -> float:
    return float(next(line.split()[1] for line in status.splitlines() if line.startswith(f"{name}:")))


def run(
    folder: str, rounds: int, engine: EngineName, model: ModelName, models_dir: Path | None = None
) -> dict[str, object]:
    """Play a folder of colour and depth pictures so many times and find the operator in each."""
    from wigwag.cameras import open_camera
    from wigwag.pose.engine import open_engine
    from wigwag.pose.estimator import PoseConfig, PoseEstimator

    estimator = PoseEstimator(PoseConfig.alone(), tracker=open_engine(engine, model, models_dir))
    held, found = [], 0
    for _ in range(rounds):
        estimator.reset()
        with open_camera(f"pairs:{folder}") as camera:
            found += sum(estimator(frame) is not None for frame in camera)
        held.append(peak_mb())
    return {"peak_mb": round(peak_mb(), 1), "rounds_mb": held, "found": found}


if __name__ == "__main__":
    folder, rounds, engine, model, *models_dir = sys.argv[1:]
    account = run(folder, int(rounds), engine, model, *map(Path, models_dir))  # type: ignore[arg-type]  # as told
    print(json.dumps(account))
