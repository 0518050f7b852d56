"""A simulated camera on somebody else's vehicle: the operator stands before it, wherever it flies."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from wigwag.camera.frame import Frame, Intrinsics
from wigwag.camera.live import Wait
from wigwag.camera.protocol import Source
from wigwag.errors import CameraError
from wigwag.fly.operator import Mount, rotation
from wigwag.fly.values import VehicleState
from wigwag.sim.camera import SimulatedCameraConfig
from wigwag.sim.motion import Operator
from wigwag.sim.noise import SensorNoise
from wigwag.sim.paint import Look
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig


class MountedSource(Source):
    """Frames of a simulated operator, seen from where a vehicle says that it is.

    So an autopilot in its own simulator, which has no camera, is flown by what a camera on it would see. The
    world begins where the vehicle stands when the first frame is read: the operator stands ahead of its nose.
    A frame is stamped as the state was that it is seen from.

    Args:
        config: Who is seen. Passers-by, light, walls and other things are left out.
        state: Asks the vehicle for its newest state.
        clock: Monotonic nanoseconds, the clock of the states' stamps.
        wait: How to wait for the time of the next frame.
    """

    def __init__(
        self,
        config: SimulatedCameraConfig,
        state: Callable[[], VehicleState],
        clock: Callable[[], int] = time.monotonic_ns,
        wait: Wait = threading.Event.wait,
    ) -> None:
        self.config, self.address = config, config.address
        self._state, self._clock, self._wait = state, clock, wait
        self._stop = threading.Event()

    def open(self) -> None:
        """Make operator and surroundings."""
        c = self.config
        person, self._script = c.operator, c.script()
        self._operator = Operator(person, self._script, (c.distance_m, 0.0), seed=c.seed)
        self._look = Look.from_seed(person.seed, person.height_m)
        clear = np.array([[0.0, 0.0], [c.distance_m, 0.0]])
        self._intrinsics, self._mount = Intrinsics(), Mount()
        self._renderer = Renderer(self._intrinsics, Scene(SceneConfig(near=c.near), c.seed, clear=clear))
        self._noise = SensorNoise(None, self._intrinsics, c.seed) if c.noise else None
        self._home: VehicleState | None = None
        self._began_ns = self._last_ns = self._due_ns = 0

    def read(self) -> Frame | None:
        """Return the next frame when its time has come; ``None`` when all is shown, or interrupted.

        Raises:
            CameraError: If the vehicle's state does not change for a second.
        """
        state = self._next_state()
        if state is None:
            return None
        if self._home is None:
            self._home, self._began_ns, self._last_ns = state, state.stamp_ns, state.stamp_ns - 33_000_000
        time_s = (state.stamp_ns - self._began_ns) * 1e-9
        most_s = self._script.duration_s if self.config.duration_s is None else self.config.duration_s
        if time_s > min(most_s, self._script.duration_s):
            return None
        seen_from = self._in_world(state)
        step_s = (state.stamp_ns - self._last_ns) * 1e-9
        self._last_ns = state.stamp_ns
        joints = self._operator.step(time_s + 1 / 30, step_s, seen_from.position_m)
        mount = self._mount
        pose = CameraPose.on_body(
            seen_from.position_m, rotation(seen_from), mount.offset_m, mount.pitch_down_rad
        )
        rgb, depth = self._renderer.render(pose, [(joints, self._look)])
        if self._noise is not None:
            rgb, depth = self._noise.apply(rgb, depth)
        return Frame(rgb, depth, self._intrinsics, state.stamp_ns)

    def close(self) -> None:
        """Nothing to let go of."""

    def interrupt(self) -> None:
        """Wait no longer."""
        self._stop.set()

    def _next_state(self) -> VehicleState | None:
        """Wait for the time of the next frame, and for a state that is newer than the last."""
        now_ns = self._clock()
        if self._due_ns > now_ns and self._wait(self._stop, (self._due_ns - now_ns) * 1e-9):
            return None
        self._due_ns = max(self._due_ns, now_ns) + round(1e9 / self.config.rate_hz)
        until_ns = self._clock() + 1_000_000_000
        while (state := self._state()).stamp_ns <= self._last_ns:
            if self._wait(self._stop, 0.002):
                return None
            if self._clock() > until_ns:
                raise CameraError(
                    f"{self.address}: the vehicle that carries the camera has said nothing new for a second."
                )
        return state

    def _in_world(self, state: VehicleState) -> VehicleState:
        """Turn and move a state into the world that begins where the vehicle stood, looking along +x."""
        assert self._home is not None
        angle = -self._home.heading_rad
        cos, sin = math.cos(angle), math.sin(angle)
        turn: Float[np.ndarray, "3 3"] = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        position = turn @ (state.position_m - self._home.position_m)
        return replace(
            state,
            position_m=np.maximum(position, [-np.inf, -np.inf, 0.0]),
            velocity_m_s=turn @ state.velocity_m_s,
            heading_rad=state.heading_rad + angle,
        )
