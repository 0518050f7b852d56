"""The real networks on real photos, on people far away, on nobody, and in a stream."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from wigwag.errors import InputError, ModelError
from wigwag.pose.blazepose import BlazePose, BlazePoseConfig, disagreement
from wigwag.pose.body import Body, Point
from wigwag.pose.landmarker import Sighting
from wigwag.pose.region import Region
from wigwag.pose.search import TILE_SHARES, search_tiles


def shrunk(photo: np.ndarray, share: float, u: int, v: int) -> np.ndarray:
    """The photo made small on grey, its upper left corner at (u, v): a person far away."""
    small = cv2.resize(photo, None, fx=share, fy=share, interpolation=cv2.INTER_AREA)
    picture = np.full_like(photo, 120)
    picture[v : v + len(small), u : u + small.shape[1]] = small
    return picture


def stands_upright(body: Body) -> bool:
    p = body.points_px
    rows = [p[[Point.NOSE], 1], p[[11, 12], 1], p[[23, 24], 1], p[[25, 26], 1], p[[27, 28], 1]]
    return bool(np.all(np.diff([row.mean() for row in rows]) > 0))


def torsos_apart(body: Body, points_px: np.ndarray) -> float:
    """Median distance of the landmarks from where they should be, in lengths of the torso."""
    hips, shoulders = points_px[[23, 24]].mean(axis=0), points_px[[11, 12]].mean(axis=0)
    away = np.linalg.norm(body.points_px - points_px, axis=1)
    return float(np.median(away) / np.linalg.norm(hips - shoulders))


def test_whole_bodies_in_real_photos(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    for name, photo in list(photos.items())[::2]:
        body = blazepose.detect(photo)
        assert body is not None, name
        assert stands_upright(body), name
        assert body.score > 0.9, name
        assert body.clarity > 0.7, name
        assert body.points_px.shape == (33, 2)
        assert ((body.visibility >= 0) & (body.visibility <= 1)).all()
        # The network's metres: a torso of an adult, the origin between the hips.
        np.testing.assert_allclose(body.world_m[[23, 24]].mean(axis=0), 0.0, atol=0.05)
        assert 0.35 < np.linalg.norm(body.world_m[[11, 12]].mean(axis=0)) < 0.65, name


def test_the_person_s_own_left_arm_points_left(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    """The operator faces the camera: their left is the picture's right."""
    for name, shoulder, wrist, sign in (("left", 11, 15, 1), ("right", 12, 16, -1)):
        body = blazepose.detect(photos[name])
        assert body is not None
        reach = body.points_px[wrist] - body.points_px[shoulder]
        assert sign * reach[0] > 0.6 * body.torso_px, name
        assert abs(reach[1]) < 0.6 * body.torso_px, name


def test_hands_up_at_take_off(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    body = blazepose.detect(photos["take_off"])
    assert body is not None
    assert (body.points_px[[15, 16], 1] < body.points_px[Point.NOSE, 1]).all()


def test_nobody_on_blank_and_noise(blazepose: BlazePose) -> None:
    rng = np.random.default_rng(0)
    noise = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    for picture in (np.zeros((480, 640, 3), np.uint8), noise, cv2.GaussianBlur(noise, (0, 0), 9)):
        assert blazepose.detect(picture) is None
        assert blazepose.track(picture) is None


def test_no_furniture_is_taken_for_a_person(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    """The detector and the network's own score see somebody in one empty room of three."""
    looked = 0
    for name, photo in list(photos.items())[::4]:
        body = blazepose.detect(photo)
        assert body is not None
        left, right = int(body.points_px[:, 0].min() - 25), int(body.points_px[:, 0].max() + 25)
        for part in (photo[:, : max(left, 0)], photo[:, right:]):
            if part.shape[1] >= 150:
                looked += 1
                assert blazepose.detect(np.ascontiguousarray(part)) is None, name
    assert looked >= 4


def test_far_people_are_found_by_the_crops(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    for name, share, u, v in (("land", 0.5, 300, 200), ("up", 0.45, 20, 30), ("left", 0.4, 200, 150)):
        near = blazepose.detect(photos[name])
        assert near is not None
        body = blazepose.detect(shrunk(photos[name], share, u, v))
        assert body is not None, name
        assert torsos_apart(body, near.points_px * share + (u, v)) < 0.08, name


def test_a_stream_finds_a_far_person_and_follows(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    """The crops take turns, so a far person takes some frames; from then on they are followed."""
    near = blazepose.detect(photos["land"])
    assert near is not None
    bodies = [blazepose.track(shrunk(photos["land"], 0.45, 100 + 2 * k, 150)) for k in range(40)]
    first = next(k for k, body in enumerate(bodies) if body is not None)
    assert first <= 25
    for k in range(first, 40):
        body = bodies[k]
        assert body is not None, f"lost in frame {k}"
        assert torsos_apart(body, near.points_px * 0.45 + (100 + 2 * k, 150)) < 0.1


def test_a_followed_person_costs_no_search_and_a_search_few_runs(
    blazepose: BlazePose, photos: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    runs: list[Region] = []
    detector = blazepose._detector

    def counted(rgb: np.ndarray, region: Region) -> object:
        runs.append(region)
        return detector(rgb, region)

    monkeypatch.setattr(blazepose, "_detector", counted)
    photo, blank = photos["land"], np.zeros((480, 640, 3), np.uint8)
    assert blazepose.track(photo) is not None
    runs.clear()
    assert blazepose.track(photo) is not None
    assert not runs
    places = set()
    for _ in range(130):
        runs.clear()
        assert blazepose.track(blank) is None
        assert len(runs) <= 2
        places.update(runs)
    tiles = {tile for share in TILE_SHARES for tile in search_tiles(640, 480, share)}
    assert tiles <= places, "every crop gets its turn"


def test_a_body_that_went_wrong_comes_right_again(
    blazepose: BlazePose, photos: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Left and right exchanged, and doubtful about it: what happened when a person half left the picture."""
    landmarker = blazepose._landmarker
    right = blazepose.track(photos["land"])
    assert right is not None
    doubtful = [True]

    def exchanged(rgb: np.ndarray, region: Region, *, mirrored: bool = False) -> Sighting:
        seen = landmarker(rgb, region, mirrored=mirrored)
        if not doubtful:
            return seen
        doubtful.clear()
        points = seen.body.points_px * (-1, 1) + (2 * region.u, 0)
        return Sighting(replace(seen.body, points_px=points, clarity=0.5), seen.region)

    monkeypatch.setattr(blazepose, "_landmarker", exchanged)
    body = blazepose.track(photos["land"])
    assert not doubtful
    assert body is not None
    assert body.clarity > 0.7
    assert torsos_apart(body, right.points_px) < 0.05


def test_lost_and_found_again(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    photo, blank = photos["video"], np.zeros((480, 640, 3), np.uint8)
    assert blazepose.track(photo) is not None
    for _ in range(3):
        assert blazepose.track(blank) is None, "a track ends when the person is gone"
    assert blazepose.track(photo) is not None


def test_reset_forgets(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    first = blazepose.track(photos["up"])
    blazepose.track(photos["up"])
    blazepose.reset()
    again = blazepose.track(photos["up"])
    assert first is not None
    assert again is not None
    np.testing.assert_array_equal(first.points_px, again.points_px)


def test_detect_leaves_the_track_alone(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    first = blazepose.track(photos["up"])
    blazepose.detect(photos["land"])
    body = blazepose.track(photos["up"])
    assert first is not None
    assert body is not None
    assert torsos_apart(body, first.points_px) < 0.05


def test_a_person_looks_the_same_in_the_mirror(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    """Left stays left, and what the network is sure of lies where it lay."""
    for name in ("left", "up", "land"):
        seen = blazepose.sight(photos[name])
        assert seen is not None
        mirrored = blazepose._landmarker(photos[name], seen.region, mirrored=True)
        assert disagreement(seen.body, mirrored.body) < 0.05, name
        apart_m = np.linalg.norm(mirrored.body.world_m[:, :2] - seen.body.world_m[:, :2], axis=1)
        assert np.median(apart_m) < 0.05, name
        assert mirrored.body.clarity > 0.7, name


def test_disagreement_is_in_torsos(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    body = blazepose.detect(photos["land"])
    assert body is not None
    aside = replace(body, points_px=body.points_px + np.array([0.3 * body.torso_px, 0.0]))
    assert disagreement(body, aside) == pytest.approx(0.3)
    assert disagreement(replace(body, points_px=np.zeros((33, 2))), body) == math.inf


def test_the_silhouette_is_the_person(blazepose: BlazePose, photos: dict[str, np.ndarray]) -> None:
    seen = blazepose.sight(photos["land"])
    assert seen is not None
    silhouette = blazepose.silhouette(photos["land"], seen.region)
    assert silhouette.shape == (480, 640)
    assert silhouette.min() >= 0
    assert silhouette.max() <= 1
    u, v = np.rint(seen.body.points_px[[11, 12, 13, 14, 23, 24]]).astype(int).T
    assert (silhouette[v, u] > 0.8).all()
    assert silhouette[:40].max() < 0.2
    assert 0.02 < silhouette.mean() < 0.2


def test_a_track_that_slid_to_furniture_ends(
    blazepose: BlazePose, photos: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Clear enough to be kept, never clear enough to be found again: what chairs do to the network."""
    landmarker = blazepose._landmarker
    assert blazepose.track(photos["land"]) is not None

    def doubtful(rgb: np.ndarray, region: Region, *, mirrored: bool = False) -> Sighting:
        seen = landmarker(rgb, region, mirrored=mirrored)
        return Sighting(replace(seen.body, clarity=0.5), seen.region)

    monkeypatch.setattr(blazepose, "_landmarker", doubtful)
    patience = blazepose.config.max_doubt_frames
    kept = [blazepose.track(photos["land"]) is not None for _ in range(patience + 20)]
    assert kept == [True] * patience + [False] * 20
    monkeypatch.setattr(blazepose, "_landmarker", landmarker)
    assert any(blazepose.track(photos["land"]) is not None for _ in range(3))


@pytest.mark.parametrize(
    "picture",
    [None, np.zeros((4, 4), np.uint8), np.zeros((4, 4, 4), np.uint8), np.zeros((4, 4, 3), np.float32)],
)
def test_what_is_no_picture_is_said(blazepose: BlazePose, picture: object) -> None:
    for look in (blazepose.track, blazepose.detect):
        with pytest.raises(InputError, match=r"uint8 with shape \(height, width, 3\)"):
            look(picture)


def test_tiny_pictures_hold_nobody(blazepose: BlazePose) -> None:
    for size in ((1, 1), (2, 300), (60, 30)):
        assert blazepose.detect(np.zeros((*size, 3), np.uint8)) is None


def test_a_missing_network_is_an_error_that_helps(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="To place it by hand"):
        BlazePose(BlazePoseConfig(models_dir=tmp_path))
