"""What is looked at before a flight: camera, model, vehicle. Nothing flies until all of it is in order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from wigwag.camera.fresh import Glimpse, fresh
from wigwag.fly.fence import Fence
from wigwag.fly.limits import SupervisorConfig
from wigwag.fly.values import Command, VehicleState
from wigwag.rig import Rig
from wigwag.vehicles.protocol import AIRBORNE, FlightMode

if TYPE_CHECKING:
    from rich.console import Console

State = Literal["ok", "warning", "fault"]
LOOK_S = 1.0
"""How long the camera is looked through."""
_PATIENCE_S = 5.0
_LEAST_HZ = 12.0


@dataclass(frozen=True, slots=True)
class Check:
    """What one look found."""

    what: str
    state: State
    """``"fault"``: there is no flight; ``"warning"``: there is, and somebody should know."""
    detail: str
    fix: str = ""
    """What to do about it."""


def check_camera(rig: Rig) -> Iterator[Check]:
    """Look through the camera for a second: are its pictures of now, often enough, and with depth?"""
    glimpses: list[Glimpse] = []
    began_ns = None
    for glimpse in fresh(rig.camera):
        began_ns = glimpse.now_ns if began_ns is None else began_ns
        glimpses.append(glimpse)
        seen = sum(g.frame is not None for g in glimpses)
        passed_s = (glimpse.now_ns - began_ns) * 1e-9
        if (seen >= 5 and passed_s >= LOOK_S) or passed_s > _PATIENCE_S:
            break
    good = [g for g in glimpses if g.frame is not None]
    if len(good) < 5:
        why = glimpses[-1].health.reason if glimpses else "no picture came"
        yield Check(
            "camera", "fault", why or "too few pictures", "check its cable, its lid, and who else uses it"
        )
        return
    spent_s = (good[-1].now_ns - good[0].now_ns) * 1e-9
    rate_hz = (len(good) - 1) / spent_s if spent_s > 0 else 0.0
    detail = f"{rate_hz:.0f} pictures a second, {1e3 * good[-1].health.age_s:.0f} ms old"
    slow = f"gestures are heard from {_LEAST_HZ:g} a second on" if rate_hz < _LEAST_HZ else ""
    yield Check("camera", "warning" if slow else "ok", detail, slow)
    if good[-1].health.depth:
        yield Check("depth", "ok", "measured")
    else:
        yield Check("depth", "fault", "none, or frozen", "use a camera with depth, aligned to colour")


def check_model(labels: tuple[str, ...], commands: Mapping[str, Command]) -> Iterator[Check]:
    """See whether the model knows what stops and lands a drone."""
    known = {commands[label] for label in labels if label in commands}
    for command in (Command.STOP, Command.LAND):
        if command not in known:
            yield Check(
                f"gesture for {command}", "fault", "the model knows none",
                f"teach one, or name it: --commands LABEL={command}",
            )  # fmt: skip
    missing = [command.value for command in Command if command not in known]
    detail = f"{len(known)} commands: {', '.join(sorted(command.value for command in known))}"
    if Command.TAKE_OFF not in known and known:
        yield Check(
            "model", "warning", detail, "it cannot take off by gesture: a pilot takes off, and hands over"
        )
    else:
        yield Check(
            "model", "ok" if known else "fault", detail if known else f"no command; missing: {missing}"
        )


def check_vehicle(rig: Rig, limits: SupervisorConfig) -> Iterator[Check]:
    """Ask the vehicle how it is."""
    vehicle, now_ns = rig.vehicle, rig.now_ns()
    state, can, mode = vehicle.state, vehicle.capabilities, vehicle.mode
    if mode is FlightMode.MANUAL:
        yield Check(
            "vehicle", "fault", f"{can.name}: a pilot has it", "let it stand disarmed, or hover on hold"
        )
    elif mode not in (FlightMode.DISARMED, FlightMode.READY, *AIRBORNE):
        yield Check("vehicle", "fault", f"{can.name}: {mode}", "wait until it stands, or hovers")
    else:
        yield Check("vehicle", "ok", f"{can.name}: {mode}")
    yield _check_age("link", state.link_age_s(now_ns), limits.max_link_age_s)
    yield _check_age(
        "position", max(state.position_age_s(now_ns), state.attitude_age_s(now_ns)), limits.max_state_age_s
    )
    yield _check_battery(state, limits)
    if not state.healthy:
        yield Check("its own checks", "fault", state.trouble or "it complains", "see its ground station")
    elif state.trouble:
        yield Check("its own checks", "warning", state.trouble)
    elif can.health:
        yield Check("its own checks", "ok", "content")
    yield _check_fence(state, limits.fence)
    for warning in vehicle.warnings:
        yield Check("parameter", "warning", warning)


def _check_age(what: str, age_s: float, most_s: float) -> Check:
    if age_s <= most_s:
        return Check(what, "ok", f"{1e3 * max(age_s, 0.0):.0f} ms old")
    detail = f"{age_s:.1f} s old" if age_s < 1e6 else "none yet"
    return Check(what, "fault", detail, "check radio, telemetry rates and the estimator (GPS or vision)")


def _check_battery(state: VehicleState, limits: SupervisorConfig) -> Check:
    if state.battery is None:
        return Check("battery", "warning", "not told", "watch it yourself: no low battery lands this drone")
    detail = f"{100 * state.battery:.0f} %"
    if state.battery < limits.battery_low:
        return Check("battery", "fault", detail, f"charge it above {100 * limits.battery_low:.0f} %")
    return Check("battery", "ok", detail)


def _check_fence(state: VehicleState, fence: Fence) -> Check:
    inside_m = min(w.distance_m for w in fence.walls(float(state.position_m[0]), float(state.position_m[1])))
    if inside_m < 0:
        return Check("fence", "fault", f"{-inside_m:.1f} m outside", "carry it inside, or set another fence")
    return Check("fence", "ok", f"{inside_m:.1f} m inside")


def in_order(
    console: Console, rig: Rig, limits: SupervisorConfig, labels: tuple[str, ...],
    commands: Mapping[str, Command],
) -> bool:  # fmt: skip
    """Go through the whole checklist, print it, and say whether there is a flight."""
    checks = [*check_model(labels, commands), *check_camera(rig), *check_vehicle(rig, limits)]
    _show(console, checks)
    faults = sum(check.state == "fault" for check in checks)
    if faults:
        console.print(f"[bold red]not in order:[/] {faults} of {len(checks)}; nothing flies.")
    return not faults


def _show(console: Console, checks: list[Check]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    colours = {"ok": "green", "warning": "yellow", "fault": "red"}
    table = Table(title="Before the flight", box=SIMPLE_HEAD)
    for column in ("", "", "found", "what to do"):
        table.add_column(column)
    for check in checks:
        state = f"[{colours[check.state]}]{check.state}[/]"
        table.add_row(check.what, state, escape(check.detail), escape(check.fix))
    console.print(table)


__all__ = ["Check", "check_camera", "check_model", "check_vehicle", "in_order"]
