"""Clips to learn from: simulated training people as an RGB-D camera and its pose network deliver them.

Nobody who is shown later is among them: training people have their own range of seeds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from wigwag.errors import InputError
from wigwag.sim.gestures import BACKGROUND
from wigwag.sim.motion import Operator, play
from wigwag.sim.person import Person
from wigwag.sim.script import Script, ScriptConfig, Shown, plan_session
from wigwag.skeleton import KINECT20, Clip, from_kinect20

TRAINING_SEED = 1_000_000
"""Person seeds from here on are training people; the demo's operator has a seed below."""


LANDMARK_BIAS = 1e-3 * np.array([
    [0, 0, 20], [0, -22, 6], [0, -22, 6], [-3, -14, 2], [3, -14, 2], [3, -1, -7], [-3, -1, -7],
    [9, 15, 6], [-9, 15, 6], [-1, -10, 18], [1, -10, 18], [-11, 13, 1], [11, 13, 1],
])  # fmt: skip
"""Where the lifted BlazePose landmarks lie from the Kinect joints that stand in for them: right, down and
away (camera optical frame), as shares of the stature. Middle of the medians over six simulated training
people and over UTD-MHAD's subjects 1, 3, 5 and 7 in simulated bodies, left and right together; ears for
head and heel for ankle are in it. A Kinect's trunk is shorter than BlazePose's: by 28 thousandths of the
stature for the former people, by 45 for the latter."""

_GLITCHING = (3, 4, 5, 6)
"""Elbows and wrists: thin, quick, and passing before other things."""


@dataclass(frozen=True, slots=True)
class SensorConfig:
    """What the camera and the pose network add to the truth.

    The defaults were measured on rendered pictures of training people (see ``LANDMARK_BIAS``) at 3.2 to
    5.8 m, BlazePose 'full' and lifting against the joints that were rendered.
    """

    rate_hz: float = 30.0
    """Poses a second."""
    distance_m: tuple[float, float] = (3.0, 6.0)
    """Nearest and farthest that the camera hovers from the person."""
    height_m: tuple[float, float] = (1.2, 2.0)
    """Lowest and highest that the camera hovers."""
    yaw_rad: float = 0.436
    """How far the person may face past the camera, either way."""
    sideways_m: float = 0.009
    """Standard deviation of a landmark's error across the line of sight (the network's); it lasts."""
    correlation_s: float = 0.1
    """How long that error lasts: the width of the Gaussian that it is smoothed with."""
    depth_per_m: float = 0.00075
    """Standard deviation of the depth's error over the squared distance (the stereo camera's); it is new
    in every frame."""
    glitch_share: float = 0.005
    """Share of frames in which an elbow's or wrist's depth is that of something else."""
    glitch_m: float = 0.3
    """Standard deviation of the depth's error in such frames."""
    bias: bool = True
    """Whether landmarks lie where BlazePose puts them (``LANDMARK_BIAS``), not where the joints are."""
    session_bias_m: float = 0.007
    """Standard deviation of what a landmark is off by during all of a session beside that."""

    def __post_init__(self) -> None:
        """Check the rate."""
        if self.rate_hz <= 0:
            raise InputError(f"SensorConfig.rate_hz must be above 0, but got {self.rate_hz}.")


@dataclass(frozen=True, slots=True)
class Session:
    """One training person's session: what the camera delivers, without end, and what was truly shown."""

    stream: Clip
    """All poses of the session; no label."""
    shown: tuple[Shown, ...]
    """The truth; times are seconds since ``stream``'s stamp 0."""


def to_camera(
    joints: Float[np.ndarray, "frames 20 3"],
    camera_m: Float[np.ndarray, "frames 3"],
    camera_heading_rad: Float[np.ndarray, " frames"],
) -> Float[np.ndarray, "frames 20 3"]:
    """Turn joints from the world (ENU) into the optical frame of a level camera (x right, y down, z ahead).

    Args:
        joints: Metres, world ENU.
        camera_m: Where the camera is, metres, world ENU.
        camera_heading_rad: Where it looks, anticlockwise from east.
    """
    span = joints - camera_m[:, None]
    c, s = np.cos(camera_heading_rad)[:, None], np.sin(camera_heading_rad)[:, None]
    ahead = c * span[..., 0] + s * span[..., 1]
    right = s * span[..., 0] - c * span[..., 1]
    return np.stack([right, -span[..., 2], ahead], axis=-1)


def training_sessions(
    n_people: int = 12,
    repetitions: int = 4,
    seed: int = 0,
    config: ScriptConfig | None = None,
    sensor: SensorConfig | None = None,
) -> list[Session]:
    """Let training people show every command and every background movement, and watch them.

    Args:
        n_people: How many people.
        repetitions: How often each shows each gesture.
        seed: Chooses people, order, repetitions and noise.
        config: How a session is made up; names and counts are set here.
        sensor: The camera.
    """
    config = replace(
        config or ScriptConfig(),
        repetitions=repetitions,
        others=BACKGROUND,
        n_others=len(BACKGROUND) * repetitions,
        climb_s=1.5,
        descend_s=1.5,
    )
    sensor = sensor or SensorConfig()
    sessions = []
    for index in range(n_people):
        person = Person.random(TRAINING_SEED + 1000 * seed + index)
        rng = np.random.default_rng([0xC11B, seed, index])
        script = plan_session(person, 1000 * seed + index, config)
        sessions.append(watch(person, script, sensor, rng))
    return sessions


def watch(person: Person, script: Script, sensor: SensorConfig, rng: np.random.Generator) -> Session:
    """See a session through a camera that keeps its distance, as the drone does.

    Args:
        person: Who shows.
        script: What is shown: procedural gestures or recordings.
        sensor: The camera.
        rng: Chooses where the camera hovers, sway and noise.
    """
    operator = Operator(person, script, seed=int(rng.integers(1 << 31)))
    times, joints = play(operator, sensor.rate_hz, lambda _: np.array([-30.0, 0.0, 1.5]))
    # The person faces west, towards a far drone; the camera hovers at its own bearing and distance from
    # the person, following slowly.
    middle = gaussian_filter1d(joints[:, KINECT20.index("hip_center"), :2], 0.7 * sensor.rate_hz, axis=0)
    distance = _wander(rng, times, *sensor.distance_m)
    bearing = np.pi + _wander(rng, times, -sensor.yaw_rad, sensor.yaw_rad)
    height = _wander(rng, times, *sensor.height_m)
    camera = np.column_stack([
        middle[:, 0] + distance * np.cos(bearing), middle[:, 1] + distance * np.sin(bearing), height,
    ])  # fmt: skip
    seen = to_camera(joints, camera, bearing + np.pi)
    # Kinect axes and back: the one place that knows which joint stands in for which landmark.
    landmarks = from_kinect20(seen * np.array([-1.0, -1.0, 1.0]))
    noisy = landmarks + landmark_noise(rng, landmarks[..., 2], sensor)
    if sensor.bias:
        noisy += LANDMARK_BIAS * person.height_m
    stamps = np.round(times * 1e9).astype(np.int64)
    stream = Clip(noisy, stamps, None, f"person {person.seed}", f"session of person {person.seed}")
    return Session(stream, script.shown)


def _wander(rng: np.random.Generator, times: Float[np.ndarray, " n"], low: float, high: float) -> np.ndarray:
    """Wander slowly within bounds."""
    wave = sum(np.sin(2 * np.pi * rng.uniform(0.005, 0.04) * times + rng.uniform(0, 6.3)) for _ in range(2))
    return np.asarray((low + high) / 2 + (high - low) / 4 * wave)


def landmark_noise(
    rng: np.random.Generator, depth: Float[np.ndarray, "frames 13"], sensor: SensorConfig
) -> Float[np.ndarray, "frames 13 3"]:
    """Draw errors (camera optical frame, metres) for landmarks at a depth."""
    frames, landmarks = depth.shape
    width = max(sensor.correlation_s * sensor.rate_hz, 1e-3)
    lasting = gaussian_filter1d(rng.normal(size=(frames, landmarks, 3)), width, axis=0, mode="wrap")
    # Smoothing takes that much of the spread away.
    lasting *= np.sqrt(2 * np.sqrt(np.pi) * width) if width > 0.3 else 1.0
    error = lasting * sensor.sideways_m
    error[..., 2] += rng.normal(size=depth.shape) * sensor.depth_per_m * depth**2
    for landmark in _GLITCHING:
        for start in np.flatnonzero(rng.random(frames) < sensor.glitch_share / 2):  # each lasts 2 frames
            error[start : start + 2, landmark, 2] += rng.normal() * sensor.glitch_m
    return np.asarray(error + rng.normal(size=(landmarks, 3)) * sensor.session_bias_m)


def cut(
    session: Session,
    margin_s: tuple[float, float] = (-0.15, 0.3),
    seed: int = 0,
    pieces: int = 20,
    *,
    name_others: bool = False,
) -> list[Clip]:
    """Cut a session into clips as a segmenter by motion does: roughly.

    Args:
        session: One person's session.
        margin_s: Least and greatest time that is left on at either end; negative cuts into the movement.
        seed: Chooses the margins.
        pieces: How many pieces of what lies between the movements (standing, walking) to add.
        name_others: Label gestures that are no command too: a recogniser tells a gesture better from
            others that it knows by name than from one heap of everything else.

    Returns:
        A clip a movement, labelled if it is a command (see ``name_others``), and the pieces without label.
    """
    rng = np.random.default_rng([0xC07, seed, len(session.stream)])
    clips = []
    for shown in session.shown:
        before, after = rng.uniform(*margin_s, size=2)
        label = shown.label if shown.is_command or name_others else None
        clips.append(_piece(session, shown.start_s - before, shown.end_s + after, label, shown.label))
    gaps = [(a.end_s, b.start_s) for a, b in pairwise(session.shown) if b.start_s - a.end_s > 1.0]
    for index in rng.permutation(len(gaps))[:pieces]:
        start, end = gaps[int(index)]
        length = min(float(rng.uniform(0.8, 2.4)), end - start)
        begin = float(rng.uniform(start, end - length))
        clips.append(_piece(session, begin, begin + length, None, "between"))
    return clips


def _piece(session: Session, start_s: float, end_s: float, label: str | None, what: str) -> Clip:
    stream = session.stream
    low, high = np.searchsorted(stream.stamps_ns, [round(start_s * 1e9), round(end_s * 1e9)])
    low, high = max(int(low), 0), min(int(high), len(stream))
    return Clip(
        stream.joints[low:high],
        stream.stamps_ns[low:high],
        label,
        stream.subject,
        f"{what} of {stream.subject} at {start_s:.2f} s",
    )


def training_clips(
    n_people: int = 12,
    repetitions: int = 4,
    seed: int = 0,
    *,
    sensor: SensorConfig | None = None,
    margin_s: tuple[float, float] = (-0.15, 0.3),
    pieces: int = 20,
) -> list[Clip]:
    """Return clips of training people: commands labelled, all else with ``label=None``.

    Args:
        n_people: How many people.
        repetitions: How often each shows each gesture.
        seed: Chooses people, repetitions, noise and cuts.
        sensor: The camera.
        margin_s: Least and greatest time left on at the ends of a clip.
        pieces: How many pieces of standing and walking a person.

    Example:
        >>> clips = training_clips(n_people=1, repetitions=1, pieces=3)
        >>> sum(clip.label is not None for clip in clips)
        10
    """
    sessions = training_sessions(n_people, repetitions, seed, sensor=sensor)
    return [clip for session in sessions for clip in cut(session, margin_s, seed, pieces)]
