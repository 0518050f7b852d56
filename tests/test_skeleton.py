import numpy as np
import pytest

from wigwag.errors import InputError
from wigwag.skeleton import Clip, Pose

JOINTS, SEEN = np.zeros((13, 3)), np.ones(13)


def test_a_pose_without_a_word_on_it_is_exact_and_measured() -> None:
    pose = Pose(JOINTS, SEEN, 0)
    np.testing.assert_array_equal(pose.sigma_m, np.zeros(13))
    assert pose.distance_sigma_m == 0.0
    assert pose.monocular is False
    assert Pose(JOINTS, SEEN, 0).sigma_m is not pose.sigma_m, "one must not change another's"


def test_a_clip_is_made_of_poses_with_and_without_uncertainty() -> None:
    poses = [Pose(JOINTS, SEEN, 0), Pose(JOINTS, SEEN, 1, np.full(13, 0.3), 0.2, monocular=True)]
    assert len(Clip.from_poses(poses)) == 2


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"joints": np.zeros((12, 3))}, r"Pose.joints must have shape \(13, 3\), but got \(12, 3\)"),
        ({"joints": np.full((13, 3), np.inf)}, "Pose.joints holds NaN or infinity"),
        ({"visibility": np.ones(33)}, r"Pose.visibility must have shape \(13,\), but got \(33,\)"),
        ({"sigma_m": np.zeros(12)}, r"Pose.sigma_m must have shape \(13,\), but got \(12,\)"),
        ({"sigma_m": np.full(13, np.nan)}, "Pose.sigma_m must hold finite metres, 0 or more"),
        ({"sigma_m": np.full(13, -0.1)}, "Pose.sigma_m must hold finite metres, 0 or more"),
        ({"distance_sigma_m": np.nan}, "Pose.distance_sigma_m must be finite metres, 0 or more, but got nan"),
        ({"distance_sigma_m": -1.0}, "Pose.distance_sigma_m must be finite metres, 0 or more, but got -1.0"),
    ],
)
def test_faults(fields: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Pose(**({"joints": JOINTS, "visibility": SEEN, "stamp_ns": 0} | fields))
