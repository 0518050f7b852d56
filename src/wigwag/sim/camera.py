"""The camera of a simulated drone that hovers before a simulated operator."""

from __future__ import annotations

from dataclasses import dataclass

from wigwag.camera.frame import Frame
from wigwag.camera.protocol import Source
from wigwag.errors import InputError
from wigwag.sim.motion import Operator
from wigwag.sim.noise import SensorNoiseConfig
from wigwag.sim.paint import Look
from wigwag.sim.person import Person
from wigwag.sim.script import plan_session
from wigwag.sim.world import World, WorldConfig


@dataclass(frozen=True, slots=True)
class SimulatedCameraConfig:
    """Who is seen, and how.

    Raises:
        InputError: If the distance or the duration is not positive.
    """

    seed: int = 1
    """Chooses the person, what they show, the surroundings and all noise."""
    distance_m: float = 4.0
    """From the drone to the operator at first."""
    rate_hz: float = 30.0
    duration_s: float | None = None
    """``None``: until the operator has shown everything."""
    noise: bool = True
    """Whether the sensor is a real one."""

    def __post_init__(self) -> None:
        """Check what the world does not."""
        if not self.distance_m > 0 or (self.duration_s is not None and not self.duration_s > 0):
            raise InputError(
                "SimulatedCameraConfig needs distance_m and duration_s above 0, but got "
                f"{self.distance_m} and {self.duration_s}."
            )


class SimulatedSource(Source):
    """Frames with depth of an operator who shows gestures; the same seed shows the same frames.

    Time passes in the world as frames are read, and stamps are the world's.

    Args:
        config: Who is seen, and how.
    """

    def __init__(self, config: SimulatedCameraConfig | None = None) -> None:
        self.config = config or SimulatedCameraConfig()
        self.address = f"sim:?seed={self.config.seed}"
        self.world: World | None = None
        """Open, and what is true in it; for judging only."""

    def open(self) -> None:
        """Make the world."""
        c = self.config
        person = Person.random(c.seed)
        script = plan_session(person, c.seed)
        operator = Operator(person, script, position_m=(c.distance_m, 0.0), seed=c.seed)
        noise = SensorNoiseConfig() if c.noise else None
        config = WorldConfig(rate_hz=c.rate_hz, delay_frames=0, noise=noise)
        self.world = World(config, c.seed, operator, Look.from_seed(c.seed, person.height_m))
        duration_s = script.duration_s if c.duration_s is None else min(c.duration_s, script.duration_s)
        self._left = int(duration_s * c.rate_hz)

    def read(self) -> Frame | None:
        """Let the world go on by a frame; ``None`` when all is shown."""
        if self.world is None or self._left <= 0:
            return None
        self._left -= 1
        return self.world.step()

    def close(self) -> None:
        """Forget the world."""
        self.world = None
