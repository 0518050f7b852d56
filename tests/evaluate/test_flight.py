"""Judging a flight: every event is accounted for exactly once."""

from wigwag.evaluate.flight import FlightLog, Outcome, Row, judge, summarise
from wigwag.gesture import Gesture
from wigwag.sim.script import Shown

SHOWN = [
    Shown("left", 10, 12, True),
    Shown("clap", 15, 16, False),
    Shown("up", 20, 22, True),
    Shown("down", 23, 25, True),
]


def event(label: str, decided_s: float, end_s: float | None = None) -> Gesture:
    end = decided_s - 0.3 if end_s is None else end_s
    return Gesture(label, 0.9, 0, int(end * 1e9), int(decided_s * 1e9))


def outcomes(*events: Gesture) -> list[Outcome]:
    return [outcome for _, outcome, _ in judge(SHOWN, events).showings]


def test_right_wrong_missed() -> None:
    assert outcomes(event("left", 12.4), event("down", 22.5)) == [
        Outcome.RECOGNISED, Outcome.LEFT_ALONE, Outcome.WRONG, Outcome.MISSED,
    ]  # fmt: skip


def test_an_event_that_comes_after_the_next_start_belongs_to_the_movement_it_saw() -> None:
    assert outcomes(event("up", 23.2, end_s=22.0), event("down", 25.3))[2:] == [
        Outcome.RECOGNISED, Outcome.RECOGNISED,
    ]  # fmt: skip


def test_false_commands_on_nothing_on_others_and_repeats() -> None:
    judged = judge(SHOWN, [event("up", 5), event("up", 16.2), event("left", 12.2), event("left", 12.9)])
    assert sorted(outcome.value for _, outcome in judged.false_events) == [
        "false on another gesture", "false on nothing", "false on nothing",
    ]  # fmt: skip


def test_summary_counts_and_ignores_errors_while_not_following() -> None:
    def row(time_s: float, flying: bool, bearing: float) -> Row:
        return Row(time_s, True, flying, bearing, 0.1, (0, 0, 1), (4, 0, 1), 10.0, 20.0, "following")

    log = FlightLog([row(0, False, 90.0), row(1, True, -2.0)], [event("left", 12.4)], list(SHOWN))
    summary = summarise(log)
    assert summary["gestures"]["shown"] == 3
    assert summary["gestures"]["recognised"] == 1
    assert summary["gestures"]["missed"] == 2
    assert summary["follow"]["bearing_error_deg"] == {"mean": 2.0, "max": 2.0}
    assert summary["loop"]["hz"] == 50.0


def test_a_flight_appended_comes_later_and_is_judged_as_it_was() -> None:
    def flight() -> FlightLog:
        row = Row(11.0, True, True, 3.0, 0.1, (0, 0, 1), (4, 0, 1), 10.0, 20.0, "following")
        return FlightLog([row], [event("left", 12.4), event("up", 5.0)], list(SHOWN))

    alone, both = summarise(flight()), flight()
    both.append(flight(), offset_s=30.0)
    summary = summarise(both)
    assert [row.time_s for row in both.rows] == [11.0, 41.0]
    assert [shown.start_s for shown in both.shown] == [10, 15, 20, 23, 40, 45, 50, 53]
    assert (both.events[2].onset_ns, both.events[2].decided_ns) == (30_000_000_000, 42_400_000_000)
    for key in ("shown", "recognised", "wrong", "missed"):
        assert summary["gestures"][key] == 2 * alone["gestures"][key]
    assert summary["false_commands"] == 2 * alone["false_commands"] == 2
    assert flight().rows[0].time_s == 11.0, "what is appended stays as it was"


def test_appending_to_nothing_is_a_copy() -> None:
    log, other = FlightLog(), FlightLog([], [event("left", 12.4)], list(SHOWN))
    log.append(other, 0.0)
    assert log == other
