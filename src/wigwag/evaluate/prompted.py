"""A pilot in a world without pixels, who is told what the recogniser would have said."""

from __future__ import annotations

from wigwag.camera.watchdog import Watchdog
from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.gesture import Gesture
from wigwag.pilot import Pilot, PilotConfig, Step
from wigwag.sim.sketch import SketchWorld
from wigwag.skeleton import Clip, Pose

HELD_S = 2.0
"""How long a prompted gesture is said to have been shown."""


class Prompter:
    """Stands where gestures are spotted and says what it is told, whatever it sees."""

    def __init__(self) -> None:
        self.says: Command | None = None
        """What is said next, once."""
        self.held_s = HELD_S
        self.broken = False
        """Whether it raises instead."""

    def update(self, pose: Pose | None) -> Gesture | None:
        """Say it, if a pose is there to say it of.

        Raises:
            RuntimeError: While ``broken``.
        """
        if self.broken:
            raise RuntimeError("the recogniser is broken")
        if pose is None or self.says is None:
            return None
        label, self.says = self.says.value, None
        onset_ns = pose.stamp_ns - round(self.held_s * 1e9)
        return Gesture(label, 1.0, onset_ns, pose.stamp_ns, pose.stamp_ns)


class Nobody:
    """A recogniser that is never asked."""

    def recognise(self, clip: Clip) -> Gesture:
        """Refuse.

        Raises:
            InputError: Always.
        """
        raise InputError("A prompted pilot has nothing recognised.")


class PromptedFlight:
    """One flight in a sketched world, a turn of the loop at a time.

    Args:
        world: Where it flies.
        config: The pilot's.
    """

    def __init__(self, world: SketchWorld, config: PilotConfig | None = None) -> None:
        self.world, self.prompter = world, Prompter()
        self.pilot = Pilot(world, Nobody(), world.vehicle, config=config, clock=lambda: 0.0)
        self.pilot.spotter = self.prompter  # type: ignore[assignment]  # says, and never spots
        self.watchdog = Watchdog()
        self.step: Step | None = None
        self.clock_off_ns = 0
        """How far the loop's clock is set off; stamps are not."""

    @property
    def now_s(self) -> float:
        """The time, seconds since the world began."""
        return self.world.now_ns * 1e-9

    def turn(self, command: Command | None = None) -> Step:
        """Let the world go on by a frame, and the pilot by a turn."""
        if command is not None:
            self.prompter.says = command
        frame = self.world.step()
        now_ns = self.world.now_ns + self.clock_off_ns
        health = self.watchdog.check(now_ns) if frame is None else self.watchdog.see(frame, now_ns)
        self.step = self.pilot.step(frame if health.usable else None, now_ns)
        return self.step

    def turns(self, seconds: float) -> None:
        """Go on for a while."""
        for _ in range(round(seconds * self.world.config.rate_hz)):
            self.turn()
