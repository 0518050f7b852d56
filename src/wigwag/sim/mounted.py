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
from wigwag.fly.operator import rotation
from wigwag.fly.values import VehicleState
from wigwag.sim.camera import SimulatedCameraConfig
from wigwag.sim.gestures import perform
from wigwag.sim.motion import Operator
from wigwag.sim.noise import SensorNoise
from wigwag.sim.paint import Look
from wigwag.sim.render import CameraPose, Renderer
from wigwag.sim.scene import Scene, SceneConfig
from wigwag.sim.script import Act, Script, plan_session

_FOREVER_S = 1e6
_UP_M, _CALM_M_S = 0.5, 0.2
_FIRST_S, _BETWEEN_S, _AGAIN_S, _LATER_S = 2.0, 2.0, 6.0, 3.0
"""Standing before the hand is raised, before taking off is shown, before both are shown again, and before all
else once the vehicle is up, seconds."""
_TRIES = 12
"""So often is a vehicle asked to take off that does not."""


class MountedSource(Source):
    """Frames of a simulated operator, seen from where a vehicle says that it is.

    So an autopilot in its own simulator, which has no camera, is flown by what a camera on it would see. The
    world begins where the vehicle stands when the first frame is read: the operator stands ahead of its nose.
    A frame is stamped as the state was that it is seen from.

    As people do, the operator waits for the vehicle: they raise a hand and show taking off, again and again,
    until it is up; then they show everything else.

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

    @property
    def shown(self) -> tuple[str, ...]:
        """What the operator shows, in order; it grows while they wait for the vehicle."""
        return tuple(act.motion.name for act in self._operator.script.acts)

    def open(self) -> None:
        """Make operator and surroundings."""
        c = self.config
        person = c.operator
        told = bool(c.perform)  # then they show that, whatever the vehicle does
        self._later: Script | None = None if told else plan_session(person, c.seed)
        self._next_s, self._tries = _FIRST_S, 0
        script = c.script() if told else Script((), (), (), _FOREVER_S)
        self._operator = Operator(person, script, (c.distance_m, 0.0), seed=c.seed)
        self._look = Look.from_seed(person.seed, person.height_m)
        clear = np.array([[0.0, 0.0], [c.distance_m, 0.0]])
        self._intrinsics, self._mount = Intrinsics(), c.mount
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
            # In the air, its height is counted from where it was armed.
            self._ground_m = 0.0 if state.armed else float(state.position_m[2])
        time_s = (state.stamp_ns - self._began_ns) * 1e-9
        most_s = _FOREVER_S if self.config.duration_s is None else self.config.duration_s
        self._direct(time_s, state)
        if time_s > min(most_s, self._operator.script.duration_s):
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

    def _direct(self, time_s: float, state: VehicleState) -> None:
        """Add to what is shown, when its time has come."""
        if self._later is None or time_s < self._next_s:
            return
        script = self._operator.script
        high = float(state.position_m[2]) - self._ground_m > _UP_M
        up = state.armed and high and abs(float(state.velocity_m_s[2])) < _CALM_M_S
        if up and (self._tries or not self.config.engage):
            self._operator.script = _joined(script, self._later, time_s + _LATER_S)
            self._later = None
        elif self._tries == _TRIES:
            self._operator.script = replace(script, duration_s=time_s)
            self._later = None
        else:
            self._ask(script, time_s)

    def _ask(self, script: Script, time_s: float) -> None:
        """Let the operator raise a hand, if they have to, and show taking off."""
        acts, person = list(script.acts), self._operator.person
        self._tries += 1
        if self.config.engage:
            acts.append(Act(time_s, perform("engage", person, [self.config.seed, self._tries])))
            time_s = acts[-1].end_s + _BETWEEN_S
        acts.append(Act(time_s, perform("take_off", person, [self.config.seed, self._tries])))
        self._operator.script = replace(script, acts=tuple(acts))
        self._next_s = acts[-1].end_s + _AGAIN_S

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
        east, north, _ = self._home.position_m
        position = turn @ (state.position_m - [east, north, self._ground_m])
        return replace(
            state,
            position_m=np.maximum(position, [-np.inf, -np.inf, 0.0]),
            velocity_m_s=turn @ state.velocity_m_s,
            heading_rad=state.heading_rad + angle,
        )


def _joined(script: Script, later: Script, from_s: float) -> Script:
    """Let what was planned follow on what was shown; its own taking off is over."""
    first = later.acts[0]
    off_s = from_s - first.end_s
    acts = [replace(act, start_s=act.start_s + off_s) for act in later.acts[1:]]
    walks = [replace(w, start_s=w.start_s + off_s) for w in later.walks if w.start_s >= first.end_s]
    return Script((*script.acts, *acts), tuple(walks), (), later.duration_s + off_s)
