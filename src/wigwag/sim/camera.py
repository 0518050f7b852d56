"""The camera of a simulated drone that hovers before a simulated operator."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from wigwag.camera.frame import Frame
from wigwag.camera.protocol import Source
from wigwag.errors import InputError
from wigwag.fly.operator import Mount
from wigwag.sim.exposure import ExposureConfig
from wigwag.sim.motion import Operator
from wigwag.sim.noise import SensorNoiseConfig
from wigwag.sim.paint import Look
from wigwag.sim.passerby import Passerby, crossings
from wigwag.sim.performing import PerformingConfig, plan_performances
from wigwag.sim.person import Person
from wigwag.sim.quadrotor import EstimateConfig, QuadrotorConfig
from wigwag.sim.scene import SceneConfig
from wigwag.sim.script import Script, ScriptConfig, plan_session
from wigwag.sim.wind import WindConfig
from wigwag.sim.world import World, WorldConfig

_OTHERS = 500_000
"""Passers-by are drawn from seeds from here on."""

TRIPOD_M = 1.2
"""How high a camera stands that nobody flies."""

PERFORMING_M = 4.5
"""How far off they stand who perform: from nearer, it does not see raised hands and feet at once."""


@dataclass(frozen=True, slots=True)
class SimulatedCameraConfig:
    """Who is seen, and how.

    Raises:
        InputError: If the distance, the duration or the light is not positive, or a number is negative.
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
    parked: bool = False
    """Whether the drone stands on the ground at first, for whoever flies it; by default it hovers."""
    engage: bool = True
    """Whether the operator first raises one hand, so that a chain that waits for it listens."""
    passersby: int = 0
    """How many people walk to and fro before and behind the operator."""
    light: float = 1.0
    """1 is daylight, 0.02 dusk, 0.005 the dark; see ``wigwag.sim.exposure``."""
    turned_deg: float = 0.0
    """How far past the drone the operator faces."""
    near: int = 0
    """How many things stand near the operator."""
    wall: bool = False
    """Whether a wall in the colour of the operator's shirt stands behind them."""
    mount: Mount = field(default_factory=Mount)
    """How it sits on the drone."""
    person: int | None = None
    """Who is seen: another number is somebody of other size, tempo and habits. ``None``: follows the seed."""
    perform: tuple[str, ...] = ()
    """What they show, again and again (:data:`~wigwag.sim.gestures.PERFORMABLE`); none named: a session of
    commands and other movements."""
    times: int = 10
    """How often, of ``perform``."""
    pause_s: float = 5.0
    """Rest after each showing of ``perform``."""
    tripod: bool = False
    """Whether the camera stands still, ``TRIPOD_M`` high, as a webcam does, rather than hovers in gusts."""

    def __post_init__(self) -> None:
        """Check what the world does not."""
        if not self.distance_m > 0 or (self.duration_s is not None and not self.duration_s > 0):
            raise InputError(
                "SimulatedCameraConfig needs distance_m and duration_s above 0, but got "
                f"{self.distance_m} and {self.duration_s}."
            )
        if not 0 < self.light <= 1 or self.passersby < 0 or self.near < 0:
            raise InputError(
                "SimulatedCameraConfig needs light above 0 and at most 1, passersby and near of 0 or more, "
                f"but got {self.light}, {self.passersby} and {self.near}."
            )

    @property
    def address(self) -> str:
        """What of it one would write as an address."""
        who = "" if self.person is None else f"&person={self.person}"
        what = f"&perform={','.join(self.perform)}" if self.perform else ""
        return f"sim:?seed={self.seed}{who}{what}"

    @property
    def operator(self) -> Person:
        """Who is seen."""
        return Person.random(self.seed if self.person is None else self.person)

    @property
    def carrier(self) -> QuadrotorConfig:
        """What carries the camera: a drone in gusts, one on the ground, or one that nothing ever moves."""
        if self.parked:
            return QuadrotorConfig(position_m=(0.0, 0.0, 0.0))
        if self.tripod:
            position_m, still = (0.0, 0.0, TRIPOD_M), WindConfig(gust_m_s=0.0)
            return QuadrotorConfig(position_m=position_m, wind=still, estimate=EstimateConfig.exact())
        return QuadrotorConfig()

    def script(self) -> Script:
        """Plan what they show.

        Raises:
            InputError: If there is no simulated gesture of a name in ``perform``, or a number is wrong.
        """
        if self.perform:
            config = PerformingConfig(self.times, self.pause_s, self.engage)
            return plan_performances(self.operator, self.perform, self.seed, config)
        return plan_session(self.operator, self.seed, ScriptConfig(engage=self.engage))


class SimulatedSource(Source):
    """Frames with depth of an operator who shows gestures; the same seed shows the same frames.

    Time passes in the world as frames are read, and stamps are the world's.

    Args:
        config: Who is seen, and how.
        endless: Go on when all is shown, with the operator standing there; see ``shown``.
    """

    def __init__(self, config: SimulatedCameraConfig | None = None, endless: bool = False) -> None:
        self.config, self._endless = config or SimulatedCameraConfig(), endless
        self.address = self.config.address
        self._left = 0
        self.world: World | None = None
        """Open, and what is true in it; for judging only."""

    def open(self) -> None:
        """Make the world."""
        c = self.config
        person, script = c.operator, c.script()
        turned_rad = float(np.radians(c.turned_deg))
        operator = Operator(person, script, (c.distance_m, 0.0), seed=c.seed, turned_rad=turned_rad)
        look = Look.from_seed(person.seed, person.height_m)
        config = WorldConfig(
            rate_hz=c.rate_hz,
            mount=c.mount,
            delay_frames=1 if c.parked else 0,
            quadrotor=c.carrier,
            noise=SensorNoiseConfig() if c.noise else None,
            scene=SceneConfig(near=c.near, wall=look.shirt if c.wall else None),
            exposure=ExposureConfig(light=c.light) if c.light < 1 else None,
        )
        others = [self._passerby(k, script.duration_s) for k in range(c.passersby)]
        self.world = World(config, c.seed, operator, look, others=others)
        duration_s = script.duration_s if c.duration_s is None else min(c.duration_s, script.duration_s)
        self._left = int(duration_s * c.rate_hz)

    def _passerby(self, number: int, duration_s: float) -> tuple[Passerby, Look]:
        """Let one more person walk to and fro, from their own side and in their own time."""
        c = self.config
        rng = np.random.default_rng([0xBA55, c.seed, number])
        start, ways = crossings(c.distance_m, int(duration_s / 4) + 1, rng)
        side = 1.0 if number % 2 else -1.0
        legs = [replace(leg, to_m=(leg.to_m[0], -side * leg.to_m[1])) for way in ways for leg in way]
        person = Person.random(_OTHERS + 100 * c.seed + number)
        begin_s = 2.0 + 1.7 * number
        walker = Passerby(person, (start[0], -side * start[1]), legs, begin_s, seed=number)
        return walker, Look.from_seed(person.seed, person.height_m)

    def read(self) -> Frame | None:
        """Let the world go on by a frame; ``None`` when all is shown."""
        if self.world is None or (self.shown and not self._endless):
            return None
        self._left -= 1
        return self.world.step()

    @property
    def shown(self) -> bool:
        """Whether the operator has shown everything, or the duration is over."""
        return self._left <= 0

    def close(self) -> None:
        """Forget the world."""
        self.world = None
