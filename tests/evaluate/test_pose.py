"""How engines are compared, with stand-ins whose times and places are known."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from wigwag.errors import DataError
from wigwag.evaluate.pictures import Endless, deserted, moving, read_photos, without_person
from wigwag.evaluate.pose import Shown, apart_px, compare, measure, rows
from wigwag.pose.body import Body

BLACK = np.zeros((48, 64, 3), np.uint8)


def body(u: float = 32.0, spread: float = 5.0) -> Body:
    points = np.linspace([u - spread, 4.0], [u + spread, 40.0], 33)
    return Body(points, np.ones(33), np.zeros((33, 3)), None, None)


@dataclass
class Clock:
    now_s: float = 0.0

    def __call__(self) -> float:
        return self.now_s


@dataclass
class Actor:
    """Takes its time, and finds a body at its own place in every picture that is not black."""

    clock: Clock
    takes_s: float
    place: Body | None
    calls: list[str] = field(default_factory=list)

    def detect(self, rgb: np.ndarray) -> Body | None:
        self.calls.append("detect")
        self.clock.now_s += self.takes_s
        return self.place if rgb.any() else None

    def track(self, rgb: np.ndarray) -> Body | None:
        found = self.detect(rgb)
        self.calls[-1] = "track"
        return found

    def reset(self) -> None:
        self.calls.append("reset")


def actors(away_px: float = 0.5) -> tuple[dict[str, Actor], Clock]:
    clock = Clock()
    other = Actor(clock, 0.020, body(32.0 + away_px))
    return {"litert": Actor(clock, 0.010, body(32.0)), "mediapipe": other}, clock


def stream(*bright: int) -> list[Shown]:
    return [Shown(np.full_like(BLACK, value), k == 0) for k, value in enumerate(bright)]


def test_a_record_an_engine_with_its_time_and_their_distance() -> None:
    engines, clock = actors()
    trials = compare(engines, "detect", stream(1, 1, 0, 1), clock)
    ours, theirs = rows(trials, "detect", "photos", "full")
    assert (ours["engine"], ours["ms_median"], ours["times_litert"]) == ("litert", 10.0, 1.0)
    assert (theirs["engine"], theirs["ms_median"], theirs["times_litert"]) == ("mediapipe", 20.0, 2.0)
    for row in (ours, theirs):
        assert (row["model"], row["mode"], row["data"]) == ("full", "detect", "photos")
        assert (row["frames"], row["found"], row["timed"]) == (4, 3, 4)
        assert row["agreement_px_median"] == pytest.approx(0.5)
    assert engines["litert"].calls == ["detect"] * 4


def test_who_goes_first_changes() -> None:
    engines, clock = actors()
    order: list[str] = []
    for name, engine in engines.items():
        engine.detect = lambda rgb, name=name: order.append(name)
    compare(engines, "detect", stream(1, 1, 1), clock)
    assert order == ["litert", "mediapipe", "mediapipe", "litert", "litert", "mediapipe"]


def test_following_is_timed_where_somebody_was_there_before() -> None:
    engines, clock = actors()
    trial = compare(engines, "track", stream(1, 1, 1, 0, 1, 1), clock)["litert"]
    assert len(trial.bodies) == 6
    assert len(trial.seconds) == 3  # neither found nor lost in the second, the third and the last
    assert engines["litert"].calls == ["reset", *["track"] * 6]


def test_searching_is_timed_where_nobody_is_found_and_whoever_is_found_is_forgotten() -> None:
    engines, clock = actors()
    trial = compare(engines, "search", stream(0, 0, 1, 0), clock)["mediapipe"]
    assert len(trial.seconds) == 3
    assert sum(found is not None for found in trial.bodies) == 1
    assert engines["mediapipe"].calls == ["reset", "track", "track", "track", "reset", "track"]


def test_pictures_that_do_not_count_leave_no_trace() -> None:
    engines, clock = actors()
    shown = [Shown(BLACK + 1, True, counted=False), Shown(BLACK + 1)]
    trials = compare(engines, "track", shown, clock)
    assert len(trials["litert"].bodies) == len(trials["litert"].seconds) == 1


def test_an_engine_alone_agrees_with_nobody() -> None:
    engines, clock = actors()
    del engines["mediapipe"]
    trials = compare(engines, "track", stream(1, 1), clock)
    (row,) = rows(trials, "track", "photos", "full")
    assert row["agreement_px_median"] is None
    assert not len(apart_px(list(trials.values())))


def test_nobody_found_has_no_time() -> None:
    engines, clock = actors()
    (row, _) = rows(compare(engines, "track", stream(0, 0), clock), "track", "photos", "full")
    assert row["ms_median"] is None
    assert row["times_litert"] is None
    assert row["found"] == 0


def test_every_mode_on_photos_and_on_rendered_motion() -> None:
    clock = Clock()
    wide = np.full((480, 640, 3), 7, np.uint8)
    said: list[str] = []
    records = list(
        measure(
            lambda: {"litert": Actor(clock, 0.01, body(300.0, 40.0))},
            "lite",
            [wide],
            seconds=0.2,
            seed=1,
            progress=lambda what, done, total: said.append(what),
        )
    )
    assert [(r["mode"], r["data"], r["frames"]) for r in records] == [
        ("detect", "photos", 1),
        ("track", "photos", 2),
        ("search", "photos, person cut away", 1),
        ("detect", "rendered motion", 2),
        ("track", "rendered motion", 4),
        ("search", "rendered, nobody there", 6),
    ]
    assert set(said) == {f"{r['mode']}, {r['data']}" for r in records}


def test_a_room_is_what_lies_beside_the_person() -> None:
    photo = np.zeros((48, 640, 3), np.uint8)
    photo[:, 300:] = 9
    photo[:, 100:200] = 200  # the person
    (room,) = without_person([photo], Actor(Clock(), 0.0, body(150.0, 50.0)))
    assert room.shape == photo.shape
    assert not (room == 200).any()
    assert without_person([photo], Actor(Clock(), 0.0, body(320.0, 200.0))) == [], "no rest is wide enough"
    assert without_person([photo * 0], Actor(Clock(), 0.0, body())) == [], "nobody is found"


def test_nobody_is_in_the_deserted_scene_and_somebody_in_the_other() -> None:
    empty, full = next(deserted(0.1, seed=3)), next(moving(0.1, seed=3))
    away = np.abs(empty.rgb.astype(int) - full.rgb.astype(int)).sum(axis=2) > 60
    assert empty.depth_mm is not None
    assert empty.rgb.shape == full.rgb.shape == (480, 640, 3)
    assert away[:, 240:400].mean() > 3 * away[:, :100].mean()
    assert len(list(deserted(0.2, seed=3))) == 6


def test_an_endless_source_goes_forth_and_back() -> None:
    source = Endless(list(moving(0.1, seed=1)), rate_hz=10.0)
    source.open()
    frames = [source.read() for _ in range(6)]
    assert [f.stamp_ns for f in frames] == [100_000_000 * k for k in range(1, 7)]
    assert [f.rgb is frames[k].rgb for k, f in zip((0, 1, 2, 1, 0, 1), frames, strict=True)] == [True] * 6
    source.close()


def test_no_photos(tmp_path) -> None:
    (tmp_path / "notes.txt").write_text("no picture")
    with pytest.raises(DataError, match="there is no picture in it"):
        read_photos(tmp_path)
