"""Composites of small people, and what is measured on them: a few of each, with the real networks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from wigwag.errors import DataError, ModelError
from wigwag.evaluate import far
from wigwag.evaluate.composites import (
    CLUTTER,
    SIZE,
    STYLES,
    Photo,
    empty_parts,
    joined,
    load_photos,
    make_clutter,
    make_scene,
    painted_over,
)
from wigwag.evaluate.far import FarOptions, Trial, in_first_half, landmark_error, measure_far
from wigwag.evaluate.tables import far_table
from wigwag.evaluate.walls import look_at_walls
from wigwag.pose.blazepose import BlazePose

PHOTOS = Path(__file__).parents[2].parent / "shared" / "data" / "operator_photos"


@pytest.fixture(scope="module")
def pose() -> BlazePose:
    try:
        return BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A photo of each of five folders."""
    chosen = [
        sorted(PHOTOS.glob(f"{name}/*.jpg"))[:1] for name in ("down", "land", "left", "take_off", "video")
    ]
    if not all(chosen):
        pytest.skip(f"needs the operator photos in {PHOTOS}")
    root = tmp_path_factory.mktemp("photos")
    for (path,) in chosen:
        (root / path.parent.name).mkdir()
        (root / path.parent.name / path.name).symlink_to(path.resolve())
    return root


@pytest.fixture(scope="module")
def photos(folder: Path, pose: BlazePose) -> list[Photo]:
    found, empty = load_photos(folder, pose)
    assert not empty
    assert len(found) == 5
    return found


def test_people_are_as_tall_as_they_look(photos: list[Photo]) -> None:
    """The silhouette's rows agree with the height from eyes and toes, except where arms are raised."""
    for photo in photos:
        if photo.path.parent.name == "take_off":
            continue
        rows = np.flatnonzero((photo.silhouette > 0.5).any(axis=1))
        assert np.ptp(rows) == pytest.approx(photo.person_px, rel=0.05), photo.path


def test_what_is_beside_a_person_shows_nothing_of_them(photos: list[Photo]) -> None:
    for photo in photos:
        left, _, right, _ = photo.box(0.12)
        assert photo.silhouette[:, : int(left)].max(initial=0.0) < 0.3
        assert photo.silhouette[:, int(right) + 1 :].max(initial=0.0) < 0.3
        assert sum(part.shape[1] for part in empty_parts(photo, 1)) < photo.rgb.shape[1]
        assert joined(photo).shape[0] == photo.rgb.shape[0]


def test_painting_over_changes_the_person_and_nothing_else(photos: list[Photo]) -> None:
    painted = painted_over(photos[0])
    away = photos[0].silhouette == 0
    away[:] = False
    away[:, :100] = True
    np.testing.assert_array_equal(painted[away], photos[0].rgb[away])
    assert (painted != photos[0].rgb)[photos[0].silhouette > 0.9].mean() > 0.8


@pytest.mark.parametrize("style", STYLES)
def test_landmarks_go_where_their_pixels_go(photos: list[Photo], style: str) -> None:
    """Shrunk by two and set on clutter, the torso is the photo's torso."""
    photo = next(photo for photo in photos if photo.path.parent.name == "land")
    rng = np.random.default_rng(4)
    scene = make_scene(rng, photo, photos, photo.person_px / 2, style=style, kind="joined")
    scene = replace(scene, jpeg=None)
    rgb, points = scene.at(150, 60)
    torso = float(np.linalg.norm(points[[11, 12]].mean(axis=0) - points[[23, 24]].mean(axis=0)))
    assert torso == pytest.approx(photo.body.torso_px / 2, rel=0.02)
    for here, there in zip(points[[11, 12, 23, 24]], photo.body.points_px[[11, 12, 23, 24]], strict=True):
        small = rgb[int(here[1]) - 1 : int(here[1]) + 2, int(here[0]) - 1 : int(here[0]) + 2]
        large = photo.rgb[int(there[1]) - 2 : int(there[1]) + 3, int(there[0]) - 2 : int(there[0]) + 3]
        np.testing.assert_allclose(small.mean(axis=(0, 1)), large.mean(axis=(0, 1)), atol=25)


@pytest.mark.parametrize("kind", CLUTTER)
def test_clutter_and_scenes_follow_from_the_seed(photos: list[Photo], kind: str) -> None:
    first, second = (make_clutter(np.random.default_rng(5), photos, kind) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert first.shape == (SIZE[1], SIZE[0], 3)
    assert first.dtype == np.uint8
    scenes = [
        make_scene(np.random.default_rng(6), photos[0], photos, 100, style="window", kind=kind)
        for _ in range(2)
    ]
    np.testing.assert_array_equal(scenes[0].at(3, 4)[0], scenes[1].at(3, 4)[0])


def test_a_person_half_outside_of_the_picture_is_cut(photos: list[Photo]) -> None:
    scene = make_scene(np.random.default_rng(7), photos[0], photos, 120, style="photo", kind="part")
    for place in ((-40, -30), (SIZE[0] - 20, 5), (SIZE[0] + 9, 9999)):
        assert scene.at(*place)[0].shape == (SIZE[1], SIZE[0], 3)


def test_errors_count_in_torsos(photos: list[Photo]) -> None:
    body = photos[0].body
    assert landmark_error(body, body.points_px) == 0.0
    aside = body.points_px + np.array([0.2 * body.torso_px, 0.0])
    assert landmark_error(body, aside) == pytest.approx(0.2)
    assert landmark_error(None, aside) == float("inf")
    assert not Trial(photos[0].path, "photo", 0.2, 1.0).right


def test_halves_are_every_second_folder() -> None:
    assert [in_first_half(name, "dbca") for name in "abcd"] == [True, False, True, False]


def test_small_people_are_rightly_found_and_kept_and_walls_are_not(folder: Path, pose: BlazePose) -> None:
    """A glimpse of the benchmark: 102 px, in pictures and in streams."""
    rows = []
    measured = measure_far(folder, pose, FarOptions(sizes=(102,), walls=5), add=rows.append)
    assert rows == measured.rows
    by_mode = {row["mode"]: row for row in rows if row["data"] in ("all", "walls and furniture")}
    assert by_mode["full size"]["found_pct"] == 100
    picture, stream = by_mode["picture"], by_mode["stream"]
    for row in (picture, stream):
        assert row["n"] == 5
        assert row["found_pct"] == 100
        assert row["landmark_error_torso_median"] < 0.05
    assert picture["wrong_body"] == 0
    assert stream["acquired_pct"] == 100
    assert stream["frames_to_acquire_max"] <= 60
    assert stream["kept_pct"] == 100
    assert stream["false_frames"] == 0
    assert sum(row["false_found"] for row in rows if row["mode"] == "nobody") == 0
    halves = [row for row in rows if row["mode"] == "picture" and row["data"] != "all"]
    assert sum(row["n"] for row in halves) == 5
    table = far_table(rows)
    assert "| 102 (8.0) | 5 | 100.0" in table
    assert "somebody found in 0 of 5" in table


def test_walls_in_which_somebody_is_seen_are_counted_and_kept(photos: list[Photo]) -> None:
    class SeesPeopleEverywhere:
        def detect(self, rgb: np.ndarray) -> object:
            return photos[0].body

    rows, failures = look_at_walls(photos, SeesPeopleEverywhere(), 10, 0)  # type: ignore[arg-type]
    assert [(row["n"], row["false_found"]) for row in rows] == [(2, 2)] * 5
    assert len(failures) == 10


def test_a_folder_without_photos_is_said(tmp_path: Path, pose: BlazePose) -> None:
    with pytest.raises(DataError, match="expected photos of people"):
        measure_far(tmp_path, pose)
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "broken.jpg").write_bytes(b"no picture")
    with pytest.raises(DataError, match="cannot be read as a picture"):
        measure_far(tmp_path, pose)


def test_a_missed_person_is_a_failure_with_its_picture(
    folder: Path, pose: BlazePose, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(far, "RIGHT_WITHIN", 0.0)
    measured = measure_far(folder, pose, FarOptions(sizes=(200,), streams=False, walls=0))
    n = next(row["n"] for row in measured.rows if row["mode"] == "picture")
    assert len(measured.failures) == n
    assert all("off by" in what and rgb.shape == (480, 640, 3) for what, rgb in measured.failures)
