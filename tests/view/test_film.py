from pathlib import Path

import av
import numpy as np

from wigwag.view.film import Film


def test_film_can_be_played_back(tmp_path: Path) -> None:
    path = tmp_path / "flight.mp4"
    with Film(path, rate_hz=10) as film:
        for brightness in range(0, 250, 10):
            film.add(np.full((48, 64, 3), brightness, np.uint8))
    with av.open(str(path)) as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert len(pictures) == 25
    assert pictures[0].shape == (48, 64, 3)
    assert abs(int(pictures[20].mean()) - 200) < 8
