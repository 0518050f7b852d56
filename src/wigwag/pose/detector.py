"""BlazePose's detector: where in the picture somebody stands, and which way is up for them.

A single-shot detector over 2,254 anchors whose boxes hold the face and whose keypoints say where the
middle of the hips lies and how large and how tilted the whole body is (Bazarevsky et al., BlazePose,
2020; anchor layout and decoding after MediaPipe's published graph options).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.pose.network import PictureNetwork
from wigwag.pose.region import Region

_LAYERS = ((8, 2), (16, 2), (32, 6))
"""Stride in pixels, and anchors a cell, of each grid of the network."""


@dataclass(frozen=True, slots=True)
class Detection:
    """Somebody found by the detector."""

    score: float
    """0 to 1."""
    box_px: Float[np.ndarray, " 4"]
    """Left, top, right, bottom of the face, pixels of the picture."""
    region: Region
    """The turned square that holds the whole body."""


def anchors(pixels: int = 224) -> Float[np.ndarray, "2254 2"]:
    """Return the centres of the anchors, as shares of the input's side.

    Example:
        >>> anchors().shape
        (2254, 2)
    """
    grids = []
    for stride, repeat in _LAYERS:
        cells = pixels // stride
        axis = (np.arange(cells) + 0.5) / cells
        v, u = np.meshgrid(axis, axis, indexing="ij")
        grids.append(np.repeat(np.stack([u.ravel(), v.ravel()], axis=-1), repeat, axis=0))
    return np.concatenate(grids).astype(np.float32)


class Detector:
    """Finds people in a square region of the picture.

    Args:
        path: ``pose_detection.tflite``.
        threads: Threads of the interpreter.
        min_score: Detections below are dropped.
    """

    def __init__(self, path: Path, threads: int = 1, min_score: float = 0.5) -> None:
        self._network = PictureNetwork(path, threads, low=-1.0, high=1.0, border=cv2.BORDER_CONSTANT)
        self._anchors = anchors(self._network.pixels)
        # A score is the sigmoid of what the network gives; comparing before saves 2,254 exponentials.
        self._min_logit = float(np.log(min_score / (1.0 - min_score)))

    def __call__(self, rgb: UInt8[np.ndarray, "height width 3"], region: Region) -> list[Detection]:
        """Return who is found in ``region``, surest first."""
        self._network.run(rgb, region)
        n = len(self._anchors)
        logits = self._network.output(1, n, 1)[0, :, 0]
        keep = np.flatnonzero(logits >= self._min_logit)
        if not len(keep):
            return []
        raw = self._network.output(1, n, 12)[0, keep] / self._network.pixels
        scores = 1.0 / (1.0 + np.exp(-np.clip(logits[keep], -100.0, 100.0)))
        centers = raw[:, :2] + self._anchors[keep]
        boxes = np.concatenate([centers - raw[:, 2:4] / 2, centers + raw[:, 2:4] / 2], axis=1)
        keypoints = raw[:, 4:].reshape(-1, 4, 2) + self._anchors[keep, None]
        rows = np.concatenate([boxes.reshape(-1, 2, 2), keypoints], axis=1)
        return [self._place(score, points, region) for score, points in merge_overlapping(scores, rows)]

    @staticmethod
    def _place(score: float, points: Float[np.ndarray, "6 2"], region: Region) -> Detection:
        placed = region.to_picture(points)
        return Detection(score, placed[:2].ravel(), Region.around(placed[2], placed[3]))


def merge_overlapping(
    scores: Float[np.ndarray, " n"], rows: Float[np.ndarray, "n points 2"], min_overlap: float = 0.3
) -> list[tuple[float, Float[np.ndarray, "points 2"]]]:
    """Blend detections whose boxes overlap, weighted by score (MediaPipe's weighted suppression).

    Args:
        scores: Score of each detection.
        rows: Points of each detection; the first two are its box's upper left and lower right.
        min_overlap: Intersection over union from which on two boxes are the same person.

    Returns:
        Score and blended points of each person, surest first.
    """
    merged = []
    left = np.argsort(-scores, kind="stable")
    sizes = np.prod(np.clip(rows[:, 1] - rows[:, 0], 0.0, None), axis=-1)
    while len(left):
        best = left[0]
        low = np.maximum(rows[left, 0], rows[best, 0])
        high = np.minimum(rows[left, 1], rows[best, 1])
        shared = np.prod(np.clip(high - low, 0.0, None), axis=-1)
        overlap = shared / np.maximum(sizes[left] + sizes[best] - shared, 1e-12)
        same = overlap > min_overlap
        same[0] = True
        group = left[same]
        weights = scores[group] / scores[group].sum()
        merged.append((float(scores[best]), np.einsum("n,npd->pd", weights, rows[group])))
        left = left[~same]
    return merged
