"""A supervisor, a clock, and a craft that does what it is asked: what scenarios are played with."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.situation import Action, Craft, Mode, Permit, Situation, Verdict
from wigwag.fly.supervisor import RULES, Rules, Supervisor
from wigwag.fly.values import Command, Setpoint

S = 10**9
TURN_NS = S // 30
WISH = Setpoint((0.5, 0.2, 0.1), 0.3)


class Scene:
    """Everything is all right, unless a scenario says otherwise.

    ``known`` is what the supervisor is told in every turn; stamps in it are ages in seconds.
    """

    def __init__(
        self, rules: Rules = RULES, config: SupervisorConfig | None = None, mode: Mode = Mode.DISARMED
    ) -> None:
        self.supervisor = Supervisor(config, mode, rules)
        self.now_ns = 100 * S
        self.craft = Craft.DOWN if mode is Mode.DISARMED else Craft.AIRBORNE
        self.obeys = True
        self.wish = WISH
        self.ages: dict[str, float | None] = {
            "state_ns": 0.0, "link_ns": 0.0, "camera_ns": 0.0, "pose_ns": 0.0, "rested_ns": 0.0,
            "engaged_ns": 60.0, "deaf_ns": None,
        }  # fmt: skip
        self.known: dict[str, Any] = {
            "position_m": (0.0, 0.0, 1.5), "distance_m": 4.0, "battery": 0.8, "moving": False,
        }  # fmt: skip
        self.asked: list[Action] = []
        self.rows: list[str] = []
        self.sent: list[Setpoint | None] = []
        self.verdict = Verdict(mode)
        self._due: tuple[int, Craft] | None = None

    @property
    def mode(self) -> Mode:
        return self.supervisor.mode

    def situation(self, **changes: Any) -> Situation:
        stamps = {
            name: None if age is None else self.now_ns - int(age * S) for name, age in self.ages.items()
        }
        return replace(Situation(self.now_ns, self.craft, 0, 0), **{**stamps, **self.known, **changes})

    def turn(self, command: Command | None = None, held_s: float = 2.0, passed_s: float = 1 / 30) -> Verdict:
        """Let time pass, decide once, and let the craft do as it is asked."""
        for name in ("state_ns", "link_ns", "camera_ns", "pose_ns", "rested_ns", "engaged_ns", "deaf_ns"):
            age = self.ages[name]
            if name in self.stuck and age is not None:
                self.ages[name] = age + passed_s
        self.now_ns += int(passed_s * S)
        if self._due is not None and self.now_ns >= self._due[0]:
            self.craft, self._due = self._due[1], None
            if self.craft is Craft.CLIMBING:
                self._due = (self.now_ns + 2 * S, Craft.AIRBORNE)
        situation = self.situation(command=command, held_s=held_s)
        self.verdict = verdict = self.supervisor.step(situation)
        permit: Permit = self.supervisor.permit(situation, self.wish)
        self.sent.append(permit.setpoint)
        if verdict.row:
            self.rows.append(verdict.row)
        if verdict.mode is Mode.EXECUTING and verdict.accepted is not None:
            self.known["moving"] = True
        if verdict.action is not Action.NONE:
            self.asked.append(verdict.action)
            if self.obeys:
                self._obey(verdict.action)
        return verdict

    stuck: frozenset[str] = frozenset()
    """Stamps that do not move: what they stand for grows old."""

    def stick(self, *names: str) -> None:
        self.stuck = self.stuck | set(names)

    def free(self, *names: str) -> None:
        self.stuck = self.stuck - set(names)
        for name in names:
            self.ages[name] = 0.0

    def turns(self, seconds: float) -> Verdict:
        for _ in range(max(1, round(seconds * 30))):
            self.turn()
        return self.verdict

    def until(self, mode: Mode, within_s: float) -> float:
        """Turn until a mode is reached; return after how many seconds."""
        began = self.now_ns
        while self.mode is not mode:
            self.turn()
            passed = (self.now_ns - began) / S
            assert passed <= within_s, f"still {self.mode} after {within_s} s, not {mode}"
        return (self.now_ns - began) / S

    def _obey(self, action: Action) -> None:
        ground = self.craft in (Craft.DOWN, Craft.ARMED)
        match action:
            case Action.ARM:
                self._due = (self.now_ns + S // 5, Craft.ARMED)
            case Action.TAKE_OFF:
                self._due = (self.now_ns + S // 10, Craft.CLIMBING)
            case Action.LAND:
                self.craft = Craft.ARMED if ground else Craft.SINKING
                self._due = (self.now_ns + (S if ground else 3 * S), Craft.DOWN)
            case Action.HOLD if not ground:
                self.craft, self._due = Craft.AIRBORNE, None
            case _:
                pass


def flying(
    rules: Rules = RULES, config: SupervisorConfig | None = None, mode: Mode = Mode.FOLLOWING
) -> Scene:
    """A scene in the air, following for two seconds already (or however ``mode`` is reached)."""
    scene = Scene(rules, config, Mode.FOLLOWING)
    scene.turns(2.0)
    if mode is Mode.HOLDING:
        scene.turn(Command.STOP)
        scene.turns(6.0)
    elif mode is Mode.EXECUTING:
        scene.turn(Command.UP)
        scene.turns(0.5)
    elif mode is Mode.LOST_PERSON:
        scene.stick("pose_ns")
        scene.turns(1.0)
    elif mode is Mode.LOST_LINK:
        scene.stick("link_ns", "state_ns")
        scene.turns(2.0)
    elif mode is Mode.LANDING:
        scene.turn(Command.LAND)
        scene.turns(0.5)
    elif mode is Mode.EMERGENCY:
        scene.known["battery"] = 0.05
        scene.turns(0.5)
    elif mode is Mode.PILOT:
        scene.craft = Craft.PILOTED
        scene.turns(0.5)
    elif mode is Mode.FAILSAFE:
        scene.craft = Craft.OWN
        scene.turns(1.5)
    assert scene.mode is mode, f"{scene.mode} is not {mode}"
    return scene
