"""Every camera by its address. All kinds are known here; each one's own file is loaded when it is used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wigwag.camera.address import Address, hide_password, parse
from wigwag.camera.live import LiveCamera
from wigwag.camera.paced import Paced
from wigwag.camera.playback import Playback
from wigwag.camera.protocol import Camera, Source
from wigwag.errors import InputError

if TYPE_CHECKING:
    from wigwag.camera.lens import LensConfig
    from wigwag.sim.camera import SimulatedCameraConfig


@dataclass(frozen=True, slots=True)
class Form:
    """One kind of camera."""

    address: str
    """What its address looks like."""
    what: str
    options: tuple[str, ...]
    source: Callable[[Address], Source]
    live: Callable[[Address], bool]
    """Whether it goes on by itself, so that frames are skipped rather than waited with."""


def parse_camera(address: str) -> Address:
    """Take a camera's address apart.

    Raises:
        InputError: If the address is of no known form, or an option is not known.
    """
    kind, colon, _ = address.partition(":")
    form = _FORMS.get(kind)
    if not colon or form is None:
        raise InputError(f"{hide_password(address)!r} is no address of a camera. There are:\n{forms()}")
    return parse(address, form.options)


def open_camera(address: str) -> Camera:
    """Open the camera at an address.

    Args:
        address: Such as ``webcam:0``, ``video:FILE`` or ``sim:``; see ``forms()`` and docs/cameras.md.

    Raises:
        InputError: If the address is of no known form, or an option is wrong.
        CameraError: If the camera is not there.
        DataError: If the recording is not there or damaged.
        MissingExtraError: If this kind of camera needs a package that is not installed.

    Example:
        >>> with open_camera("sim:?duration_s=0.1&noise=0") as camera:
        ...     [frame.rgb.shape for frame in camera]
        [(480, 640, 3), (480, 640, 3), (480, 640, 3)]
    """
    parsed = parse_camera(address)
    form = _FORMS[parsed.kind]
    source = form.source(parsed)
    if form.live(parsed):
        return LiveCamera(source)
    if parsed.flag("realtime"):
        return LiveCamera(Paced(source))
    return Playback(source)


def forms() -> str:
    """Return all forms of addresses, a line each."""
    return "\n".join(
        f"  {form.address:<34} {form.what}; options: {', '.join(form.options)}" for form in _FORMS.values()
    )


def addresses() -> tuple[str, ...]:
    """Return what each kind's address looks like."""
    return tuple(form.address for form in _FORMS.values())


def _path(address: Address) -> Path:
    if not address.target:
        raise InputError(f"{address.kind}: needs a path after the colon. There are:\n{forms()}")
    return Path(address.target).expanduser()


def _lens(address: Address) -> LensConfig:
    from wigwag.camera.lens import LensConfig

    file = address.text("intrinsics")
    default = LensConfig()
    return LensConfig(address.number("hfov_deg", default.hfov_deg), Path(file).expanduser() if file else None)


def _webcam(address: Address) -> Source:
    from wigwag.camera.webcam import WebcamConfig, WebcamSource

    config = WebcamConfig(
        width=address.whole("width", 0) if "width" in address.options else None,
        height=address.whole("height", 0) if "height" in address.options else None,
        rate_hz=address.number("rate_hz", 0.0) if "rate_hz" in address.options else None,
        lens=_lens(address),
        timeout_s=address.number("timeout_s", 5.0),
    )
    return WebcamSource(address.target, config)


def _video(address: Address) -> Source:
    from wigwag.camera.video import VideoSource

    return VideoSource(_path(address), _lens(address))


def _folder(address: Address) -> Source:
    from wigwag.camera.folder import FolderSource

    return FolderSource(_path(address), address.number("rate_hz", 30.0), _lens(address))


def _pairs(address: Address) -> Source:
    from wigwag.camera.pairs import PairsSource

    rate_hz = address.number("rate_hz", 0.0) if "rate_hz" in address.options else None
    return PairsSource(_path(address), rate_hz)


def _realsense(address: Address) -> Source:
    from wigwag.camera.realsense import RealSenseConfig, RealSenseSource

    if _is_recording(address):
        return RealSenseSource(path=_path(address))
    default = RealSenseConfig()
    config = RealSenseConfig(
        address.whole("width", default.width),
        address.whole("height", default.height),
        address.whole("rate_hz", default.rate_hz),
        address.number("timeout_s", default.timeout_s),
    )
    return RealSenseSource(serial=address.target, config=config)


def _bag(address: Address) -> Source:
    from wigwag.camera.bags import BagConfig, BagSource

    config = BagConfig(
        color=address.text("color"),
        depth=address.text("depth"),
        info=address.text("info"),
        depth_info=address.text("depth_info"),
        aligned=address.flag("aligned"),
        lens=_lens(address),
    )
    return BagSource(_path(address), config)


def _sim(address: Address) -> Source:
    from wigwag.sim.camera import SimulatedSource

    return SimulatedSource(simulated(address))


def simulated(address: Address) -> SimulatedCameraConfig:
    """Return what a simulated camera's address asks for.

    Raises:
        InputError: If the address has a target, or an option is wrong.
    """
    from wigwag.sim.camera import PERFORMING_M, SimulatedCameraConfig

    if address.target:
        raise InputError(f"sim: takes options only, such as sim:?seed=2, but got {address.target!r}.")
    default = SimulatedCameraConfig()
    perform = tuple(name for name in address.text("perform").split(",") if name)
    return SimulatedCameraConfig(
        seed=address.whole("seed", default.seed),
        distance_m=address.number("distance_m", PERFORMING_M if perform else default.distance_m),
        rate_hz=address.number("rate_hz", default.rate_hz),
        duration_s=address.number("duration_s", 0.0) if "duration_s" in address.options else None,
        noise=address.flag("noise", default.noise),
        engage=address.flag("engage", default.engage and not perform),
        passersby=address.whole("passersby", default.passersby),
        light=address.number("light", default.light),
        turned_deg=address.number("turned_deg", default.turned_deg),
        near=address.whole("near", default.near),
        wall=address.flag("wall", default.wall),
        person=address.whole("person", 0) if "person" in address.options else None,
        perform=perform,
        times=address.whole("times", default.times),
        pause_s=address.number("pause_s", default.pause_s),
        tripod=address.flag("tripod", bool(perform)),
    )


def _is_recording(address: Address) -> bool:
    return address.target.lower().endswith((".bag", ".db3"))


def _never(address: Address) -> bool:
    return False


_LENS = ("hfov_deg", "intrinsics")
_SIM = (
    "seed", "distance_m", "rate_hz", "duration_s", "noise", "engage", "passersby", "light", "turned_deg",
    "near", "wall", "person", "perform", "times", "pause_s", "tripod",
)  # fmt: skip
_FORMS: dict[str, Form] = {
    "webcam": Form(
        "webcam:0 | webcam:URL",
        "a device, or any OpenCV URL or GStreamer pipeline",
        ("width", "height", "rate_hz", "timeout_s", *_LENS),
        _webcam,
        lambda address: True,
    ),
    "video": Form("video:FILE", "a video file", ("realtime", *_LENS), _video, _never),
    "folder": Form("folder:DIR", "a folder of pictures", ("rate_hz", "realtime", *_LENS), _folder, _never),
    "pairs": Form(
        "pairs:DIR", "colour and 16-bit depth pictures in pairs", ("rate_hz", "realtime"), _pairs, _never
    ),
    "realsense": Form(
        "realsense: | realsense:SERIAL",
        "an Intel RealSense; realsense:FILE.bag plays a recording",
        ("width", "height", "rate_hz", "timeout_s", "realtime"),
        _realsense,
        lambda address: not _is_recording(address),
    ),
    "bag": Form(
        "bag:DIR?color=/topic&depth=/topic",
        "a ROS 1 or 2 bag, or MCAP",
        ("color", "depth", "info", "depth_info", "aligned", "realtime", *_LENS),
        _bag,
        _never,
    ),
    "sim": Form(
        "sim:",
        "a simulated operator",
        (*_SIM, "realtime"),
        _sim,
        _never,
    ),
}
