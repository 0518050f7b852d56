"""Every vehicle by its address. All kinds are known here; each one's own file is loaded when it is used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wigwag.camera.address import Address, parse
from wigwag.errors import InputError
from wigwag.vehicles.protocol import Vehicle


@dataclass(frozen=True, slots=True)
class VehicleForm:
    """One kind of vehicle."""

    address: str
    """What its address looks like."""
    what: str
    options: tuple[str, ...]
    make: Callable[[Address], Vehicle]


def open_vehicle(address: str) -> Vehicle:
    """Return the vehicle at an address, not yet connected.

    Args:
        address: Such as ``mavlink:udp:127.0.0.1:14550`` or ``sim:``; see ``vehicle_forms()`` and
            docs/vehicles.md.

    Raises:
        InputError: If the address is of no known form, or an option is wrong.
        MissingExtraError: If this kind of vehicle needs a package that is not installed.

    Example:
        >>> open_vehicle("sim:?seed=2").capabilities.name
        'simulated quadrotor'
    """
    parsed = parse_vehicle(address)
    return _FORMS[parsed.kind].make(parsed)


def parse_vehicle(address: str) -> Address:
    """Take a vehicle's address apart; nothing is opened.

    Raises:
        InputError: If it is of no known form, or has an option that its kind does not take.
    """
    kind, colon, _ = address.partition(":")
    form = _FORMS.get(kind)
    if not colon or form is None:
        raise InputError(f"{address!r} is no address of a vehicle. There are:\n{vehicle_forms()}")
    return parse(address, form.options)


def vehicle_forms() -> str:
    """Return all forms of addresses, a line each."""
    return "\n".join(
        f"  {form.address:<38} {form.what}; options: {', '.join(form.options)}" for form in _FORMS.values()
    )


def _sim(address: Address) -> Vehicle:
    from wigwag.sim.clocked import ClockedVehicle

    if address.target:
        raise InputError(f"sim: takes options only, such as sim:?seed=2, but got {address.target!r}.")
    return ClockedVehicle(address.whole("seed", 0))


def _mavlink(address: Address) -> Vehicle:
    from wigwag.vehicles.mavlink.address import open_mavlink

    return open_mavlink(address)


def _ros2(address: Address) -> Vehicle:
    from wigwag.vehicles.ros2 import open_ros2

    return open_ros2(address)


def _mrs(address: Address) -> Vehicle:
    from wigwag.vehicles.mrs import open_mrs

    return open_mrs(address)


_FORMS: dict[str, VehicleForm] = {
    "sim": VehicleForm("sim:", "a simulated quadrotor, on the clock", ("seed",), _sim),
    "mavlink": VehicleForm(
        "mavlink:udp:HOST:PORT | mavlink:serial:DEVICE",
        "PX4 or ArduPilot; also udpin:, udpout:, tcp:",
        ("baud", "key", "system", "rate_hz", "stream_hz", "heartbeat", "origin"),
        _mavlink,
    ),
    "ros2": VehicleForm(
        "ros2:/NAMESPACE",
        "any ROS 2 drone that takes TwistStamped",
        ("cmd", "odom", "frame", "take_off", "land", "hold", "arm"),
        _ros2,
    ),
    "mrs": VehicleForm("mrs:/uav1", "the MRS UAV system", ("ros",), _mrs),
}
