"""Schneider et al. 2019: key points, dynamic time warping coordinate by coordinate, one nearest neighbour.

Schneider, Memmesheimer, Kramer, Paulus, "Gesture Recognition in RGB Videos Using Human Body Keypoints and
Dynamic Time Warping", RoboCup 2019. Written anew from its description.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter1d, median_filter

from wigwag.recognise.baselines.nearest import NearestBaseline, by_shoulders
from wigwag.recognise.baselines.warp import dtw_each
from wigwag.skeleton import Clip


class SchneiderRecognizer(NearestBaseline):
    """Key points in the picture plane, smoothed; only the coordinates that move are compared.

    The neck becomes the origin and the width of the shoulders the unit. Coordinates across and along the
    picture (the method knows no depth) are median-filtered; those whose variance exceeds a threshold in
    either sequence are selected, smoothed by a Gaussian, freed of their mean and warped each by itself. The
    distance is the mean over the selected coordinates (over all, if none moves).

    Args:
        median_frames: Width of the median filter, frames.
        sigma_frames: Standard deviation of the Gaussian, frames.
        variance: Threshold of selection, squared shoulder widths.
    """

    def __init__(self, *, median_frames: int = 5, sigma_frames: float = 1.0, variance: float = 0.05) -> None:
        self.median_frames = median_frames
        self.sigma_frames = sigma_frames
        self.variance = variance

    def _tune(self) -> None:
        self._moving = [self._moves(sequence) for sequence in self.references_]
        self._freed = [self._free(sequence) for sequence in self.references_]

    def _sequence(self, clip: Clip) -> Float[np.ndarray, "frames 1 26"]:
        points = by_shoulders(clip)[:, :, :2].reshape(len(clip), 1, -1)
        smooth = median_filter(points, size=(self.median_frames, 1, 1), mode="nearest")
        return np.asarray(smooth, dtype=np.float32)

    def _moves(self, sequence: np.ndarray) -> Bool[np.ndarray, " coordinates"]:
        return np.asarray(sequence[:, 0].var(axis=0) > self.variance)

    def _distances(self, sequence: np.ndarray) -> Float[np.ndarray, " references"]:
        moving, query = self._moves(sequence), self._free(sequence)
        result = np.empty(len(self.references_))
        for i, (reference, moved) in enumerate(zip(self._freed, self._moving, strict=True)):
            selected = moving | moved
            each = dtw_each(query, reference)
            result[i] = each[selected].mean() if selected.any() else each.mean()
        return result

    def _free(self, sequence: np.ndarray) -> np.ndarray:
        smooth = gaussian_filter1d(sequence, self.sigma_frames, axis=0, mode="nearest")
        return np.asarray(smooth - smooth.mean(axis=0))


__all__ = ["SchneiderRecognizer"]
