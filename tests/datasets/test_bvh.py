"""BVH: forward kinematics against SciPy, the names of several tools, units, and exact landmarks back."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from wigwag.datasets.bvh import Joint, Motion, format_motion, parse_motion, read_motion
from wigwag.datasets.bvh_clips import UNITS_M, bvh_text, read_bvh, read_bvhs
from wigwag.datasets.notes import Notes
from wigwag.errors import DataError
from wigwag.skeleton import LANDMARKS, Clip, Landmark

AXES = ("xrotation", "yrotation", "zrotation")


def clip(seed: int = 0, frames: int = 6, rate_hz: float = 30.0) -> Clip:
    """A person before the camera, metres, optical frame, jittered."""
    half = {"shoulder": (0.2, -0.45), "elbow": (0.25, -0.2), "wrist": (0.3, 0.05), "hip": (0.1, 0.0)}
    half |= {"knee": (0.11, 0.42), "heel": (0.12, 0.85)}
    pose = np.array(
        [
            (0, -0.7, 0) if name == "nose" else ((1 if name[0] == "l" else -1) * half[p][0], half[p][1], 0)
            for name in LANDMARKS
            for p in [name.partition("_")[2]]
        ]
    )
    rng = np.random.default_rng(seed)
    joints = pose + np.array([0, 0, 3]) + rng.normal(0, 0.02, (frames, 13, 3))
    return Clip.at_rate(joints, rate_hz, "land", "ann", f"take{seed}")


def written(path: Path, one: Clip) -> Path:
    path.write_text(bvh_text(one)[0])
    return path


@given(seed=st.integers(0, 10**6), frames=st.integers(2, 12), rate_hz=st.floats(5, 240))
def test_landmarks_come_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, seed: int, frames: int, rate_hz: float
) -> None:
    one = clip(seed, frames, rate_hz)
    back = read_bvh(written(tmp_path_factory.mktemp("b") / "take.bvh", one))
    np.testing.assert_allclose(back.joints, one.joints, rtol=0, atol=1e-9)
    assert np.abs(back.stamps_ns - one.stamps_ns).max() <= 1, "nanoseconds"


def test_axes_are_bvhs(tmp_path: Path) -> None:
    motion = read_motion(written(tmp_path / "a.bvh", clip()))
    place = dict(zip([joint.name for joint in motion.joints], motion.positions()[0], strict=True))
    assert place["Nose"][1] - place["LeftHeel"][1] > 140, "y up, centimetres"
    assert place["LeftShoulder"][0] > place["RightShoulder"][0], "faces +z: the left is at +x"
    assert place["Hips"][2] == pytest.approx(-300, abs=10), "the camera is where z is larger"
    assert motion.joints[0].channels[:3] == ("xposition", "yposition", "zposition")


def test_additive_readers_positions_are_understood(tmp_path: Path) -> None:
    """Files of programs that add positions to offsets give the same landmarks."""
    motion = read_motion(written(tmp_path / "a.bvh", clip()))
    values, column = motion.values.copy(), 0
    for joint in motion.joints:
        if joint.parent >= 0 and joint.channels:
            values[:, column : column + 3] -= joint.offset
        column += len(joint.channels)
    (tmp_path / "b.bvh").write_text(format_motion(Motion(motion.joints, values, motion.frame_time_s)))
    a, b = (read_bvh(tmp_path / f"{name}.bvh") for name in "ab")
    np.testing.assert_allclose(a.joints, b.joints, atol=1e-9)


@given(
    order=st.permutations(AXES),
    angles=st.lists(st.floats(-180, 180), min_size=6, max_size=6),
    first=st.booleans(),
)
def test_rotations_apply_in_the_order_of_channels(order: list[str], angles: list[float], first: bool) -> None:
    place = ("xposition", "yposition", "zposition")
    root = (*place, *order) if first else (*order, *place)
    joints = (
        Joint("Hips", -1, (0.0, 0.0, 0.0), root),
        Joint("Chest", 0, (1.0, 2.0, 3.0), tuple(order)),
        Joint("Chest_end", 1, (0.5, -1.0, 0.25), (), tip=True),
    )
    moved = [7.0, -8.0, 9.0]
    row = [*(moved + angles[:3] if first else angles[:3] + moved), *angles[3:]]
    motion = parse_motion(format_motion(Motion(joints, np.array([row, row]), 1 / 120)))
    intrinsic = "".join(channel[0].upper() for channel in order)
    a = Rotation.from_euler(intrinsic, np.round(angles[:3], 8), degrees=True)
    b = Rotation.from_euler(intrinsic, np.round(angles[3:], 8), degrees=True)
    chest = np.array(moved) + a.apply(joints[1].offset)
    end = chest + (a * b).apply(joints[2].offset)
    np.testing.assert_allclose(motion.positions()[0], [moved, chest, end], atol=1e-6)
    assert motion.frame_time_s == 1 / 120


# Of each tool: shoulder, elbow, wrist, hip, knee, ankle, collar bone.
SCHEMES: dict[str, tuple[str, ...]] = {
    "CMU": (
        "{Left}Arm", "{Left}ForeArm", "{Left}Hand", "{Left}UpLeg",
        "{Left}Leg", "{Left}Foot", "{Left}Shoulder",
    ),
    "Mixamo": (
        "mixamorig:{Left}Arm", "mixamorig:{Left}ForeArm", "mixamorig:{Left}Hand", "mixamorig:{Left}UpLeg",
        "mixamorig:{Left}Leg", "mixamorig:{Left}Foot", "mixamorig:{Left}Shoulder",
    ),
    "Rokoko": (
        "{Left}Arm", "{Left}ForeArm", "{Left}Hand", "{Left}Thigh",
        "{Left}Shin", "{Left}Foot", "{Left}Shoulder",
    ),
    "plain": (
        "{Left}Shoulder", "{Left}Elbow", "{Left}Wrist", "{Left}Hip",
        "{Left}Knee", "{Left}Ankle", "{Left}Collar",
    ),
    "Biovision": (
        "{Left}UpArm", "{Left}LowArm", "{Left}Hand", "{Left}UpLeg",
        "{Left}LowLeg", "{Left}Foot", "{Left}Collar",
    ),
    "3ds Max": (
        "Bip01 {L} UpperArm", "Bip01 {L} Forearm", "Bip01 {L} Hand", "Bip01 {L} Thigh",
        "Bip01 {L} Calf", "Bip01 {L} Foot", "Bip01 {L} Clavicle",
    ),
    "Unreal": (
        "upperarm_{l}", "lowerarm_{l}", "hand_{l}", "thigh_{l}",
        "calf_{l}", "foot_{l}", "clavicle_{l}",
    ),
    "Blender": (
        "upper_arm.{L}", "forearm.{L}", "hand.{L}", "thigh.{L}",
        "shin.{L}", "foot.{L}", "shoulder.{L}",
    ),
    "DAZ": (
        "{l}Shldr", "{l}ForeArm", "{l}Hand", "{l}Thigh",
        "{l}Shin", "{l}Foot", "{l}Collar",
    ),
    "ASF": (
        "{l}humerus", "{l}radius", "{l}wrist", "{l}femur",
        "{l}tibia", "{l}foot", "{l}clavicle",
    ),
}  # fmt: skip


def figure(scheme: str) -> tuple[str, dict[str, np.ndarray]]:
    """A person in a T pose with turned joints, centimetres; and where each landmark is (at rest)."""
    shoulder, elbow, wrist, hip, knee, ankle, collar = SCHEMES[scheme]
    head = "mixamorig:Head" if scheme == "Mixamo" else "Bip01 Head" if scheme == "3ds Max" else "Head"
    turned = "CHANNELS 3 Zrotation Xrotation Yrotation"
    lines = [
        "HIERARCHY",
        "ROOT Hips {",
        "OFFSET 0 0 0",
        f"CHANNELS 6 Xposition Yposition Zposition {turned[11:]}",
    ]
    places = {"nose": np.array([0.0, 170, 3])}
    lines += ["JOINT Spine {", "OFFSET 0 50 0", turned, f"JOINT {head}", "{", "OFFSET 0 10 2", turned]
    lines += ["End Site", "{", "OFFSET 0 20 2", "}", "}"]
    for side, sign in (("Left", 1), ("Right", -1)):
        name = {"Left": side, "L": side[0], "l": side[0].lower()}
        for part, x in ((collar, 5), (shoulder, 13), (elbow, 28), (wrist, 25)):
            lines += [f"JOINT {part.format(**name)}", "{", f"OFFSET {sign * x} 0 0", turned]
        lines += ["End Site", "{", f"OFFSET {sign * 9} 0 0", "}", "}", "}", "}", "}"]
        for landmark, x in (("shoulder", 18), ("elbow", 46), ("wrist", 71)):
            places[f"{side.lower()}_{landmark}"] = np.array([sign * x, 150.0, 0])
    lines += ["}"]
    for side, sign in (("Left", 1), ("Right", -1)):
        name = {"Left": side, "L": side[0], "l": side[0].lower()}
        lines += [f"JOINT {side[0]}HipJoint {{", "OFFSET 0 0 0", turned]
        for part, offset in ((hip, f"{sign * 10} 0 0"), (knee, "0 -45 0"), (ankle, "0 -42 0")):
            lines += [f"JOINT {part.format(**name)}", "{", f"OFFSET {offset}", turned]
        lines += ["End Site", "{", "OFFSET 0 -5 12", "}", "}", "}", "}", "}"]
        for landmark, y in (("hip", 100), ("knee", 55), ("heel", 13)):
            places[f"{side.lower()}_{landmark}"] = np.array([sign * 10.0, y, 0])
    lines += ["}", "MOTION", "Frames: 2", "Frame Time: 0.0083333"]
    channels = sum(int(line.split()[1]) for line in lines if line.startswith("CHANNELS"))
    rest = ["0 100 0", *["0"] * (channels - 3)]
    return "\n".join([*lines, *rest, " ".join(rest)]) + "\n", places


@pytest.mark.parametrize("scheme", SCHEMES)
def test_joints_are_found_by_the_names_of(scheme: str, tmp_path: Path) -> None:
    text, places = figure(scheme)
    (tmp_path / "a.bvh").write_text(text)
    back = read_bvh(tmp_path / "a.bvh")
    for i, landmark in enumerate(LANDMARKS):
        expected = places[landmark] * [0.01, -0.01, -0.01]
        np.testing.assert_allclose(back.joints[0, i], expected, atol=1e-9, err_msg=landmark)
    assert back.stamps_ns[1] == 8_333_300


@pytest.mark.parametrize(("unit", "scale"), UNITS_M.items())
@pytest.mark.parametrize("size", [0.65, 1.0, 1.15])
def test_units_are_told_by_the_legs(tmp_path: Path, unit: str, scale: float, size: float) -> None:
    motion = parse_motion(figure("plain")[0])
    per = 0.01 * size / scale
    joints = tuple(
        Joint(j.name, j.parent, tuple(v * per for v in j.offset), j.channels, j.tip) for j in motion.joints
    )
    (tmp_path / "a.bvh").write_text(format_motion(Motion(joints, motion.values * per, motion.frame_time_s)))
    leg = np.diff(read_bvh(tmp_path / "a.bvh").joints[0, [Landmark.LEFT_HIP, Landmark.LEFT_HEEL], 1])
    assert leg == pytest.approx(0.87 * size, rel=1e-5)
    given_m = read_bvh(tmp_path / "a.bvh", unit_m=scale / 2).joints[
        0, [Landmark.LEFT_HIP, Landmark.LEFT_HEEL], 1
    ]
    assert np.diff(given_m) == pytest.approx(0.87 * size / 2, rel=1e-5)


def test_uneven_stamps_become_steady_and_it_says_so(tmp_path: Path) -> None:
    one = clip(frames=4)
    uneven = Clip(one.joints, np.array([0, 30, 90, 120]) * 1_000_000, name="u")
    text, said = bvh_text(uneven)
    assert said == "uneven stamps: interpolated to a steady 25.00 frames a second"
    (tmp_path / "a.bvh").write_text(text)
    back = read_bvh(tmp_path / "a.bvh")
    np.testing.assert_allclose(back.joints[1], one.joints[1] * 5 / 6 + one.joints[2] / 6, atol=1e-9)
    jitter = Clip(one.joints, one.stamps_ns + np.array([0, 500_000, -500_000, 0]), name="j")
    assert bvh_text(jitter)[1] == ""


def test_the_first_of_several_figures(tmp_path: Path) -> None:
    head, motion = bvh_text(clip(1))[0].split("MOTION\n")
    second = head.removeprefix("HIERARCHY\n")
    lines = motion.splitlines()
    frames = [f"{line} {line}" for line in lines[2:]]
    (tmp_path / "a.bvh").write_text("\n".join([head + second + "MOTION", *lines[:2], *frames]))
    np.testing.assert_allclose(read_bvh(tmp_path / "a.bvh").joints, clip(1).joints, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("HIERARCHY", "HIER", "is no BVH"),
        ("MOTION", "MOVES", "is no BVH"),
        (
            "Frames: 6",
            "Frames: 7",
            "must hold 7 frames of 48 values, 336 in all, but holds 288. Was the file cut",
        ),
        ("Frames: 6", "Frames: many", "MOTION must begin with"),
        ("Frame Time: 0.0333", "Frame Time: -0.0333", "Frame Time must be seconds"),
        ("Frame Time: 0.0333", "Frame Time: nan0", "Frame Time must be a number"),
        ("CHANNELS 3", "CHANNELS 4", "CHANNELS of LeftHip must be a count"),
        ("Xposition Yposition Zposition\n", "Xposition Yposition Wposition\n", "CHANNELS of LeftHip"),
        ("OFFSET 0.0", "OFFSET x 0.0", "OFFSET of Hips must be 3 numbers"),
        ("JOINT LeftHip", "JOINT", "JOINT without a name"),
        ("JOINT LeftHip", "ROOT LeftHip", "where it cannot stand"),
        ("JOINT LeftHip", "BONE LeftHip", "which is no part of a BVH"),
        ("\t\t}\n", "", "HIERARCHY ends within a joint"),
        ("MOTION", "}\nMOTION", "closes more braces"),
        ("0.00000000 0.00000000 0.00000000 ", "0 0 nan ", "NaN or infinity, first in frame 0"),
        (
            "LeftHeel",
            "LeftFin",
            "no joint for left_heel: expected leftheel or leftankle or leftfoot, but has Hips",
        ),
        ("JOINT Nose", "JOINT Hat", "no joint for nose: expected nose or head"),
    ],
)
def test_damage_names_file_and_place(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = bvh_text(clip())[0]
    if "nan " in new:
        before, after = text.split("Frame Time")
        text = before + "Frame Time" + after.replace(old, new, 1)
    else:
        text = text.replace(old, new, 1)
    path = tmp_path / "a.bvh"
    path.write_text(text)
    with pytest.raises(DataError, match=said) as caught:
        read_bvh(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_no_unit_makes_it_a_person(tmp_path: Path) -> None:
    one = clip()
    path = written(tmp_path / "a.bvh", Clip(one.joints * 5.7, one.stamps_ns, name="giant"))
    with pytest.raises(DataError, match=r"a leg is 4\d\d.* Give the file's unit in metres \(--unit-m\)"):
        read_bvh(path)
    assert read_bvh(path, unit_m=0.01 / 5.7).joints[0] == pytest.approx(one.joints[0])
    with pytest.raises(DataError, match="unit_m must be metres, above 0"):
        read_bvh(path, unit_m=-1)


def test_a_folder_gives_labels_and_people_and_leaves_out_by_name(tmp_path: Path) -> None:
    for parts in (("land", "ann"), ("land",), ("none", "bo"), ()):
        folder = tmp_path.joinpath(*parts)
        folder.mkdir(parents=True, exist_ok=True)
        written(folder / f"take{len(parts)}.BVH", clip())
    (tmp_path / "land" / "bad.bvh").write_text("HIERARCHY")
    notes = Notes()
    found = {(c.label, c.subject, c.name) for c in read_bvhs(tmp_path, notes)}
    assert found == {
        ("land", "ann", "take2"),
        ("land", None, "take1"),
        (None, "bo", "take2"),
        (None, None, "take0"),
    }
    assert [name for name, _ in notes.left_out] == [str(Path("land", "bad.bvh"))]
    with pytest.raises(DataError, match="cannot be read"):
        read_motion(tmp_path / "nowhere.bvh")
