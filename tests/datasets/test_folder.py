import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wigwag.datasets.folder import load_clip, load_folder, save_clip
from wigwag.errors import DataError, InputError
from wigwag.skeleton import LANDMARKS, Clip


def clip(seed: int = 0, frames: int = 5, **fields: Any) -> Clip:
    rng = np.random.default_rng(seed)
    stamps = np.cumsum(rng.integers(1, 10**9, size=frames)) + 10**18
    fields = {"label": "land", "subject": "ann", "name": f"take{seed}"} | fields
    return Clip(rng.normal(0, 2, (frames, 13, 3)), stamps, **fields)


def edited(path: Path, **changes: Any) -> Path:
    content = json.loads(path.read_text()) | changes
    path.write_text(json.dumps({k: v for k, v in content.items() if v is not ...}))
    return path


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), frames=st.integers(2, 20), label=st.none() | st.text("ab c/ö", min_size=1))
def test_what_is_saved_is_what_is_loaded(
    tmp_path_factory: pytest.TempPathFactory, seed: int, frames: int, label: str | None
) -> None:
    if label is not None and not label.strip(" /"):
        return  # such a label gives no folder name of its own
    root = tmp_path_factory.mktemp("clips")
    saved = clip(seed, frames, label=label)
    back = load_clip(save_clip(saved, root))
    assert (back.label, back.subject, back.name) == (label, "ann", saved.name)
    np.testing.assert_array_equal(back.stamps_ns, saved.stamps_ns)
    assert np.abs(back.joints - saved.joints).max() <= 0.5001e-4, "rounded to 0.1 mm"


def test_layout_is_label_then_name(tmp_path: Path) -> None:
    assert save_clip(clip(), tmp_path) == tmp_path / "land" / "take0.json"
    assert save_clip(clip(label=None), tmp_path) == tmp_path / "none" / "take0.json"


def test_a_person_can_read_it(tmp_path: Path) -> None:
    lines = save_clip(clip(frames=3), tmp_path).read_text().splitlines()
    assert sum(line.startswith("    [[") for line in lines) == 3, "one line a frame"
    assert '  "label": "land",' in lines


def test_names_cannot_leave_the_folder(tmp_path: Path) -> None:
    path = save_clip(clip(name="../../etc/x", label="../up"), tmp_path)
    assert path.resolve().is_relative_to(tmp_path.resolve())
    with pytest.raises(InputError, match="gives no file name"):
        save_clip(clip(name=".."), tmp_path)


def test_does_not_overwrite_unasked(tmp_path: Path) -> None:
    save_clip(clip(), tmp_path)
    with pytest.raises(InputError, match=r"take0\.json: is there already"):
        save_clip(clip(), tmp_path)
    save_clip(clip(), tmp_path, overwrite=True)
    assert not list(tmp_path.rglob("*.part"))


def test_folder_is_sorted_and_leaves_out_by_name(tmp_path: Path) -> None:
    for seed in (2, 1):
        save_clip(clip(seed), tmp_path)
    (tmp_path / "land" / "bad.json").write_text("{")
    loaded = load_folder(tmp_path)
    assert [c.name for c in loaded.clips] == ["take1", "take2"]
    assert [name for name, _ in loaded.left_out] == [str(Path("land", "bad.json"))]


def test_landmarks_may_come_in_any_order(tmp_path: Path) -> None:
    saved = clip()
    path = save_clip(saved, tmp_path)
    order = np.random.default_rng(0).permutation(13)
    edited(
        path,
        landmarks=[LANDMARKS[i] for i in order],
        joints=np.round(saved.joints[:, order], 4).tolist(),
    )
    np.testing.assert_allclose(load_clip(path).joints, saved.joints, atol=1e-4)


def test_a_steady_rate_may_stand_for_stamps(tmp_path: Path) -> None:
    path = edited(save_clip(clip(), tmp_path), stamps_ns=..., rate_hz=20)
    assert load_clip(path).duration_s == pytest.approx(4 / 20)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": "other"}, "is no clip file"),
        ({"version": 2}, "version is 2"),
        ({"units": "mm"}, "units must be 'metre'"),
        ({"frame": ...}, "frame must be"),
        ({"label": 3}, "label must be text or null"),
        ({"landmarks": ["nose"]}, "landmarks must be"),
        ({"joints": ...}, "has no joints"),
        ({"joints": [[1, 2], [3]]}, "joints must be a regular list"),
        ({"joints": "abc"}, "joints must be a regular list"),
        ({"joints": [[[0.0] * 3] * 12] * 5}, r"must have shape \(frames, 13, 3\)"),
        ({"joints": []}, "must have shape"),
        ({"joints": [[[0.0] * 3] * 13], "stamps_ns": [0]}, "at least 2 frames"),
        ({"joints": [[[float("nan")] * 3] * 13] * 5}, "NaN or infinity, first in frame 0"),
        ({"stamps_ns": [0, 1, 2, 2, 3]}, "time must run forward, but frame 3"),
        ({"stamps_ns": [0, 1]}, "stamps_ns must have shape"),
        ({"stamps_ns": ...}, "needs stamps_ns, or rate_hz"),
        ({"stamps_ns": ..., "rate_hz": 0}, "rate_hz above 0"),
    ],
)
def test_faults_name_file_and_field(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    path = edited(save_clip(clip(), tmp_path), **changes)
    with pytest.raises(DataError, match=message) as caught:
        load_clip(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_nothing_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"no such folder.*<label>/<name>\.json"):
        load_folder(tmp_path / "nowhere")
    with pytest.raises(DataError, match="no usable clip"):
        load_folder(tmp_path)
    with pytest.raises(DataError, match="cannot be read"):
        load_clip(tmp_path / "nowhere.json")
    (tmp_path / "x.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DataError, match=r"no usable clip; first of 1 left out: x\.json: is no JSON"):
        load_folder(tmp_path)
