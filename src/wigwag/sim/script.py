"""The plan of a session: what the operator shows when, and where they walk. Written before it is played.

The plan is open-loop: it never looks at what was recognised. Its intervals are the ground truth that a
recogniser's answers are held against.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.sim.gestures import BACKGROUND, COMMANDS, DISTRACTORS, FURTHER, Performance, perform
from wigwag.sim.person import Person
from wigwag.sim.recorded import Replay


@dataclass(frozen=True, slots=True)
class Shown:
    """The truth about one movement: what was shown from when to when."""

    label: str
    """The gesture's name; for commands the value of ``Command``."""
    start_s: float
    """Seconds since the session began: the first movement."""
    end_s: float
    """Seconds since the session began: the last movement."""
    is_command: bool
    """Whether the recogniser ought to answer with ``label``; if not, it ought to stay silent."""
    subject: str = ""
    """Who shows it."""


@dataclass(frozen=True, slots=True)
class Walk:
    """A stretch of walking: the speed swells and ebbs smoothly, the direction may bend."""

    start_s: float
    duration_s: float
    direction_rad: float
    """Where to, anticlockwise from east."""
    speed_m_s: float
    """The greatest speed."""
    bend_rad: float = 0.0
    """How far the direction turns from beginning to end."""
    turn: float = 0.0
    """How far the body turns from the drone into the direction of walking: 0 not at all, 1 wholly."""
    from_drone: bool = False
    """The direction counts from straight away from the drone, wherever that is by then, not from east."""

    def ramp_s(self) -> float:
        """Seconds of getting going, and of coming to a stand."""
        return min(0.5, self.duration_s / 2)

    def velocity(self, t_s: float) -> Float[np.ndarray, 2]:
        """Velocity at a time of the session, m/s, world ENU."""
        since = t_s - self.start_s
        if not 0 < since < self.duration_s:
            return np.zeros(2)
        edge = min(since, self.duration_s - since) / self.ramp_s()
        edge = min(edge, 1.0)
        speed = self.speed_m_s * edge * edge * (3 - 2 * edge)
        part = since / self.duration_s
        angle = self.direction_rad + self.bend_rad * part * part * (3 - 2 * part)
        return np.array([speed * np.cos(angle), speed * np.sin(angle)])


@dataclass(frozen=True, slots=True)
class Act:
    """One movement of the plan."""

    start_s: float
    motion: Performance | Replay
    """A procedural gesture or a recording."""

    @property
    def end_s(self) -> float:
        """Seconds since the session began."""
        return self.start_s + self.motion.duration_s


@dataclass(frozen=True, slots=True)
class Script:
    """A planned session of one operator."""

    acts: tuple[Act, ...]
    """What is shown, in order of time; engaging comes first and is not among ``shown``."""
    walks: tuple[Walk, ...]
    """Where the operator walks, in order of time."""
    shown: tuple[Shown, ...]
    """The truth, one entry an act that a recogniser is to judge."""
    duration_s: float
    """Length of the session."""
    engaged_s: float | None = None
    """When the raised hand with which the operator engages is down again; ``None``: nobody engages."""

    def __post_init__(self) -> None:
        """Check that nothing overlaps."""
        for before, after in pairwise(self.acts):
            if after.start_s < before.end_s:
                raise InputError(
                    f"Script.acts must not overlap, but one starts at {after.start_s:.2f} s while the one "
                    f"before ends at {before.end_s:.2f} s. Put them in order of time, with gaps."
                )


@dataclass(frozen=True, slots=True)
class ScriptConfig:
    """How a session is made up. The defaults are the demo's."""

    commands: tuple[str, ...] = COMMANDS
    """The commands shown."""
    repetitions: int = 2
    """How often each command is shown; as often does the drone take off and land."""
    others: tuple[str, ...] = DISTRACTORS
    """Movements that are no command."""
    n_others: int = 6
    """How many of them are shown."""
    engage: bool = False
    """Whether the operator engages before the first movement (``wigwag.pose.engagement``)."""
    lead_in_s: float = 1.2
    """Standing before the first movement."""
    tail_s: float = 1.8
    """Standing after the last."""
    gap_s: tuple[float, float] = (1.5, 1.9)
    """Shortest and longest standing between movements."""
    walk_gap_s: tuple[float, float] = (1.9, 2.8)
    """Shortest and longest gap with walking in it."""
    walk_share: float = 0.5
    """Share of the gaps with walking in them."""
    pause_s: float = 0.3
    """Standing between walking and a movement."""
    drift_share: float = 0.25
    """Share of movements during which the operator slowly drifts."""
    drift_speed_m_s: float = 0.15
    """Greatest speed of such a drift."""
    walk_speed_m_s: tuple[float, float] = (0.4, 0.75)
    """Slowest and fastest walking."""
    radius_m: float = 1.6
    """How far the operator strays from where they began."""
    climb_s: float = 2.5
    """Least gap after take-off and before landing may be answered: the drone needs time to climb."""
    descend_s: float = 4.0
    """Gap after landing: the drone needs time to come down; the operator waits."""
    step_back_m: float = 1.8
    """How far the operator then steps back from the landed drone: near the ground its camera sees all of
    a person, raised hands included, only from afar."""

    def __post_init__(self) -> None:
        """Check the names."""
        known = {*COMMANDS, *FURTHER, *DISTRACTORS}
        if unknown := set(self.commands) - known:
            raise InputError(
                f"ScriptConfig.commands holds {sorted(unknown)}, which are no commands; known "
                f"commands: {', '.join(sorted(known))}."
            )
        known = {*BACKGROUND, *DISTRACTORS, *FURTHER}
        if unknown := set(self.others) - known:
            raise InputError(
                f"ScriptConfig.others holds {sorted(unknown)}; known movements: {sorted(known)}."
            )
        if both := set(self.commands) & set(self.others):
            raise InputError(f"ScriptConfig holds {sorted(both)} as commands and as movements that are none.")


def shuffled_order(config: ScriptConfig, rng: np.random.Generator) -> list[tuple[str, bool]]:
    """Return names in the order of showing and whether each is a command.

    Each round begins with taking off and ends with landing (if those are among the commands); what lies
    between is shuffled, with the other movements strewn in. The same command is not shown twice running.
    """
    edges = (Command.TAKE_OFF.value, Command.LAND.value)
    middle = [name for name in config.commands if name not in edges]
    others: list[str] = []
    while len(others) < config.n_others and config.others:
        others += [str(name) for name in rng.permutation(config.others)]
    others = others[: config.n_others]
    order: list[tuple[str, bool]] = []
    for turn in range(config.repetitions):
        share = others[turn :: config.repetitions]
        names = [(str(name), True) for name in rng.permutation(middle)] if middle else []
        for name in share:
            names.insert(int(rng.integers(0, len(names) + 1)), (name, False))
        if edges[0] in config.commands:
            names.insert(0, (edges[0], True))
        if edges[1] in config.commands:
            names.append((edges[1], True))
        order += names
    return order


@dataclass(slots=True)
class Planner:
    """Writes a plan forward in time: acts, gaps, and walks that stay near the start."""

    config: ScriptConfig
    rng: np.random.Generator
    now_s: float = 0.0
    offset_m: Float[np.ndarray, 2] = field(default_factory=lambda: np.zeros(2))
    """Where the walks so far have led, relative to the start."""
    acts: list[Act] = field(default_factory=list)
    walks: list[Walk] = field(default_factory=list)
    shown: list[Shown] = field(default_factory=list)
    engaged_s: float | None = None

    def begin(self, person: Person, seed: int) -> None:
        """Stand before the first movement and, if so configured, engage."""
        self.wait(self.config.lead_in_s)
        if not self.config.engage:
            return
        self.acts.append(Act(self.now_s, perform("engage", person, seed)))
        self.engaged_s = self.now_s = self.acts[-1].end_s
        self.wait(self.config.gap_s[1])

    def wait(self, duration_s: float) -> None:
        """Stand."""
        self.now_s += duration_s

    def walk(self, duration_s: float, turn: float = 0.0, speed_m_s: float | None = None) -> None:
        """Walk somewhere within the radius."""
        low, high = self.config.walk_speed_m_s
        speed = float(self.rng.uniform(low, high)) if speed_m_s is None else speed_m_s
        aim = self.config.radius_m * np.sqrt(self.rng.random()) * _heading(self.rng.uniform(-np.pi, np.pi))
        path = aim - self.offset_m
        bend = float(self.rng.uniform(-0.7, 0.7))
        direction = float(np.arctan2(path[1], path[0])) - bend / 2
        walk = Walk(self.now_s, duration_s, direction, speed, bend, turn)
        # Never walk past the aim: a shorter way at a lower speed.
        ramp = walk.ramp_s()
        length = speed * (duration_s - ramp)
        if length > (reach := max(float(np.hypot(*path)), 0.25)):
            walk = Walk(self.now_s, duration_s, direction, speed * reach / length, bend, turn)
        clock = np.arange(0, duration_s, 0.01) + 0.005
        self.offset_m = self.offset_m + 0.01 * sum(walk.velocity(self.now_s + t) for t in clock)
        self.walks.append(walk)
        self.now_s += duration_s

    def step_back(self) -> None:
        """Walk backwards, away from the drone."""
        speed, distance = 0.7, self.config.step_back_m
        if distance <= 0:
            return
        walk = Walk(self.now_s, distance / speed + 0.5, 0.0, speed, from_drone=True)
        self.walks.append(walk)
        self.now_s += walk.duration_s + 0.8

    def act(self, motion: Performance | Replay, label: str, is_command: bool, subject: str = "") -> None:
        """Show a movement, maybe drifting."""
        start = self.now_s
        inner_start, inner_end = start, start + motion.duration_s
        if isinstance(motion, Replay):
            inner_start, inner_end = start + motion.lead_s, start + motion.lead_s + motion.recording_s
        elif self.rng.random() < self.config.drift_share:
            self.walk(motion.duration_s, speed_m_s=self.config.drift_speed_m_s)
        self.acts.append(Act(start, motion))
        self.shown.append(Shown(label, inner_start, inner_end, is_command, subject))
        self.now_s = start + motion.duration_s

    def gap(self) -> None:
        """Stand or walk between two movements."""
        config = self.config
        if self.rng.random() >= config.walk_share:
            self.wait(float(self.rng.uniform(*config.gap_s)))
            return
        length = float(self.rng.uniform(*config.walk_gap_s))
        self.wait(config.pause_s)
        self.walk(length - 2 * config.pause_s, turn=float(self.rng.choice([0.0, 0.0, 0.5])))
        self.wait(config.pause_s)

    def finish(self) -> Script:
        """Close the plan."""
        self.wait(self.config.tail_s)
        return Script(tuple(self.acts), tuple(self.walks), tuple(self.shown), self.now_s, self.engaged_s)


def plan_session(person: Person, seed: int, config: ScriptConfig | None = None) -> Script:
    """Plan a session of procedural gestures.

    While the drone stands on the ground it cannot follow: the operator only steps straight back from it.

    Args:
        person: Who shows; determines how long each gesture lasts.
        seed: Chooses order, gaps, walks and repetitions.
        config: What is shown.

    Example:
        >>> from wigwag.sim.person import Person
        >>> script = plan_session(Person.random(7), seed=0)
        >>> sum(shown.is_command for shown in script.shown), len(script.shown)
        (20, 26)
    """
    config = config or ScriptConfig()
    rng = np.random.default_rng([0x5C21, seed])
    planner = Planner(config, rng)
    planner.begin(person, seed)
    order = shuffled_order(config, rng)
    flying = Command.TAKE_OFF.value not in config.commands
    for index, (name, is_command) in enumerate(order):
        motion = perform(name, person, [seed, index])
        if name in (Command.TAKE_OFF.value, Command.LAND.value):
            planner.config = replace(config, drift_share=0.0)
        planner.act(motion, name, is_command, f"person {person.seed}")
        planner.config = config
        if index == len(order) - 1:
            break
        if name == Command.TAKE_OFF.value:
            flying = True
            planner.wait(config.climb_s)
        elif name == Command.LAND.value:
            flying = False
            planner.wait(config.descend_s)
            planner.step_back()
        elif flying:
            planner.gap()
        else:
            planner.wait(float(rng.uniform(*config.gap_s)))
    return planner.finish()


def plan_replays(
    replays: Sequence[tuple[Replay, str, bool, str]],
    seed: int,
    config: ScriptConfig | None = None,
    shuffle: bool = True,
    person: Person | None = None,
) -> Script:
    """Plan a stream of recordings with standing and walking between.

    Args:
        replays: What to show: the recording, its label, whether it is a command, and whose it is.
        seed: Chooses order, gaps and walks.
        config: Gaps and walks; what it says about gestures is not used.
        shuffle: Whether the recordings are shuffled; if not, they are shown in the order given.
        person: Whose habits engaging has, if the configuration asks for it.
    """
    config = config or ScriptConfig()
    rng = np.random.default_rng([0x5C22, seed])
    planner = Planner(config, rng)
    planner.begin(person or Person(), seed)
    order = rng.permutation(len(replays)) if shuffle else np.arange(len(replays))
    for place, index in enumerate(order):
        planner.act(*replays[int(index)])
        if place < len(order) - 1:
            planner.gap()
    return planner.finish()


def _heading(angle: float) -> Float[np.ndarray, 2]:
    return np.array([np.cos(angle), np.sin(angle)])
