"""How alike a movement is to each of many references, seen from several sides, under DTW."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from wigwag.distances import PackedSequences
from wigwag.features.canonical import CanonicalForm
from wigwag.features.views import View, views
from wigwag.skeleton import Clip

Sides = list[Float[np.ndarray, "frames dims"]]
"""One sequence a view, in the order of ``Similarities.kinds``."""

_NO_DISTANCE = 1e-6
"""Below this two float32 sequences are the same."""


class Similarities:
    """DTW distances between movements in several views, and the similarities that follow from them.

    Each view is projected on its principal directions, learned from the frames of the clips it is fitted
    on, and warped by itself. A distance d becomes the similarity exp(-d / (width * m)), with m the median
    distance between those clips in that view.

    Args:
        form: Canonical form of clips.
        kinds: Views in use.
        n_dims: Principal directions kept of each view.
        band: Sakoe-Chiba band, frames.
        width: Width of the kernels, in median distances.
    """

    def __init__(
        self, form: CanonicalForm, kinds: Sequence[View], n_dims: int, band: int, width: float
    ) -> None:
        self.form, self.kinds, self.n_dims = form, tuple(kinds), n_dims
        self.band, self.width = band, width
        self.references: list[Sides] = []
        self._packed: list[list[PackedSequences]] = []
        self._main = 0

    def __len__(self) -> int:
        return len(self.references)

    def fit(self, clips: Sequence[Clip]) -> list[Sides]:
        """Learn the projections from clips and return their sides; none becomes a reference by it."""
        raw = [views(self.form.apply(clip)) for clip in clips]
        self.means: list[np.ndarray] = []
        self.bases: list[np.ndarray] = []
        for kind in self.kinds:
            frames = np.concatenate([sides[kind] for sides in raw]).astype(np.float64)
            mean = frames.mean(axis=0)
            directions = min(self.n_dims, frames.shape[1])
            basis = np.eye(frames.shape[1])
            if directions < frames.shape[1]:
                frames -= mean
                _, vectors = np.linalg.eigh(frames.T @ frames)
                basis = vectors[:, ::-1][:, :directions]
            self.means.append(mean.astype(np.float32))
            self.bases.append(np.ascontiguousarray(basis, dtype=np.float32))
        return [self._project(sides) for sides in raw]

    def sides(self, clip: Clip) -> Sides:
        """Return the projected views of a clip."""
        return self._project(views(self.form.apply(clip)))

    def _project(self, raw: dict[View, Float[np.ndarray, "frames features"]]) -> Sides:
        return [
            (raw[kind] - mean) @ basis
            for kind, mean, basis in zip(self.kinds, self.means, self.bases, strict=True)
        ]

    def refer_to(self, references: Sequence[Sides]) -> None:
        """Compare with these from now on."""
        self.references = list(references)
        self._main = len(self.references)
        self._packed = [self._pack(self.references)]

    def add(self, references: Sequence[Sides]) -> None:
        """Compare with these too; they come after those there are."""
        self.references = [*self.references, *references]
        # What has been added since the last whole packing is packed apart: a few at a time, quickly.
        self._packed = [self._packed[0], self._pack(self.references[self._main :])]

    @classmethod
    def comparing(cls, other: Similarities, references: Sequence[Sides]) -> Similarities:
        """Return the same comparison with other references."""
        self = cls(other.form, other.kinds, other.n_dims, other.band, other.width)
        self.means, self.bases, self.scales = other.means, other.bases, other.scales
        self.refer_to(references)
        return self

    def _pack(self, references: Sequence[Sides]) -> list[PackedSequences]:
        return [PackedSequences([sides[v] for sides in references]) for v in range(len(self.kinds))]

    def distances(self, sides: Sides) -> Float[np.ndarray, "references views"]:
        """Return the DTW distance to each reference in each view."""
        result = np.empty((len(self.references), len(self.kinds)), dtype=np.float32)
        start = 0
        for packed in self._packed:
            stop = start + len(packed[0])
            for v, side in enumerate(sides):
                result[start:stop, v] = packed[v].distances(side, self.band)
            start = stop
        return result

    def set_scales(self, distances: Float[np.ndarray, "clips references views"]) -> None:
        """Take the median distance in each view for the unit of similarity.

        Where that is none, for there is one clip alone or all are alike, the unit is 1 a frame: an arm's
        length, or as far in another view.
        """
        medians = np.median(distances.reshape(-1, distances.shape[2]), axis=0)
        self.scales = np.where(medians > _NO_DISTANCE, medians, self.form.frames).astype(np.float32)

    def relative(self, distances: Float[np.ndarray, "*some views"]) -> Float[np.ndarray, "*some views"]:
        """Return distances in units of the usual one."""
        return np.asarray(distances / self.scales)

    def features(
        self, distances: Float[np.ndarray, "*some references views"]
    ) -> Float[np.ndarray, "*some features"]:
        """Return the similarities to all references, view by view within each reference."""
        similar = np.exp(distances * (-1.0 / (self.width * self.scales)))
        return np.asarray(similar.reshape(*distances.shape[:-2], -1))

    def arrays(self) -> dict[str, np.ndarray]:
        """Return what was learned, and the references, to be saved."""
        learned = {"scales": self.scales}
        for kind, mean, basis in zip(self.kinds, self.means, self.bases, strict=True):
            learned[f"mean_{kind}"], learned[f"basis_{kind}"] = mean, basis
        return learned | self.stacked("references", self.references)

    def restore(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Take back what ``arrays`` gave."""
        self.scales = arrays["scales"]
        self.means = [arrays[f"mean_{kind}"] for kind in self.kinds]
        self.bases = [arrays[f"basis_{kind}"] for kind in self.kinds]
        self.refer_to(self.unstacked("references", arrays))

    def stacked(self, name: str, movements: Sequence[Sides]) -> dict[str, np.ndarray]:
        """Return movements as one array a view."""
        return {
            f"{name}_{kind}": np.stack([sides[v] for sides in movements]) for v, kind in enumerate(self.kinds)
        }

    def unstacked(self, name: str, arrays: Mapping[str, np.ndarray]) -> list[Sides]:
        """Return the movements of ``stacked``."""
        return [list(sides) for sides in zip(*(arrays[f"{name}_{kind}"] for kind in self.kinds), strict=True)]
