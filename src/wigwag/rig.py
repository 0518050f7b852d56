"""A camera on a vehicle, and the one clock of both: what is flown, by its two addresses."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from wigwag.camera.live import LiveCamera
from wigwag.camera.playback import Playback
from wigwag.camera.protocol import Camera
from wigwag.cameras import open_camera, parse_camera, simulated
from wigwag.drones import open_vehicle
from wigwag.fly.operator import Mount
from wigwag.vehicles.protocol import Vehicle

PARKED_M = 5.6
"""How far off a simulated operator stands from a drone on the ground: from nearer, a level camera down there
does not see raised hands."""


@dataclass(frozen=True, slots=True)
class Rig:
    """What is flown."""

    camera: Camera
    vehicle: Vehicle
    """Connected."""
    now_ns: Callable[[], int]
    """The clock of all stamps, nanoseconds."""
    over: Callable[[], bool]
    """Whether there is nothing more to be flown for: a simulated operator has shown everything."""
    live: bool
    """Whether time passes by itself; if not, it passes with the camera's frames."""


@contextmanager
def open_rig(camera: str, vehicle: str, mount: Mount | None = None) -> Iterator[Rig]:
    """Open a camera and connect a vehicle; both are let go of at the end.

    Simulated both, they are one world, in which time passes with the frames. A simulated camera alone rides
    on whatever vehicle there is, such as an autopilot in its own simulator: the simulated operator stands
    before it.

    Args:
        camera: Its address; see docs/cameras.md.
        vehicle: Its address; see docs/vehicles.md.
        mount: How a simulated camera sits on the vehicle.

    Raises:
        InputError: If an address is of no known form, or an option is wrong.
        CameraError: If the camera is not there.
        VehicleError: If the vehicle cannot be reached.
        MissingExtraError: If one of them needs a package that is not installed.
    """
    mount = mount or Mount()
    simulated_camera = parse_camera(camera).kind == "sim"
    if simulated_camera and vehicle.partition(":")[0] == "sim":
        yield from _world(camera, vehicle, mount)
        return
    flown = open_vehicle(vehicle)
    flown.connect()
    try:
        opened = _mounted(camera, flown, mount) if simulated_camera else open_camera(camera)
        with opened:
            live = isinstance(opened, LiveCamera)
            now_ns = time.monotonic_ns if live else lambda: opened.now_ns
            yield Rig(opened, flown, now_ns, lambda: opened.ended, live)
    finally:
        flown.close()


def _world(camera: str, vehicle: str, mount: Mount) -> Iterator[Rig]:
    from wigwag.sim.camera import SimulatedSource
    from wigwag.sim.world import World

    open_vehicle(vehicle)  # its address is checked; the drone is the world's own
    address = parse_camera(camera)
    config = replace(simulated(address), parked=True, mount=mount)
    if "distance_m" not in address.options:
        config = replace(config, distance_m=PARKED_M)
    source = SimulatedSource(config, endless=True)

    class WorldCamera(Playback):
        """The camera of a world whose pictures come a frame late: the time is the world's."""

        @property
        def now_ns(self) -> int:
            return world.now_ns

    with WorldCamera(source) as opened:
        assert source.world is not None
        world: World = source.world
        yield Rig(opened, world.vehicle, lambda: world.now_ns, lambda: source.shown, live=False)


def _mounted(camera: str, vehicle: Vehicle, mount: Mount) -> Camera:
    from wigwag.sim.mounted import MountedSource

    address = parse_camera(camera)
    config = replace(simulated(address), mount=mount)
    if "distance_m" not in address.options:
        config = replace(config, distance_m=PARKED_M)
    return LiveCamera(MountedSource(config, lambda: vehicle.state))


__all__ = ["PARKED_M", "Rig", "open_rig"]
