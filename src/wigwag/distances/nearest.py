"""Exact nearest neighbours under DTW in thousands of dimensions, at the cost of a few dozen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int

from wigwag.distances.dtw import dtw, dtw_by_product
from wigwag.distances.packed import Cost, PackedSequences, check_sequences
from wigwag.errors import InputError

_SLACK = 1e-3
"""Relative room for float32 rounding whenever a bound decides that a reference need not be looked at."""

_BASIS_FRAMES = 4000
"""Frames from which the projection is learned; more change the bound in the third digit."""


class NearestSequences:
    """Find the references nearest to a query under DTW, exactly.

    An orthonormal projection P never lengthens a vector, and what it leaves over, e = x - P'Px, obeys the
    triangle inequality, so that for any two frames

        |a - b|^2 >= |Pa - Pb|^2 + (|e_a| - |e_b|)^2.

    DTW over the right-hand side is DTW in ``n_projected + 1`` dimensions and never exceeds the true one,
    whichever path the true one takes. The search computes this bound for all references and the true
    distance only in the order of the bounds, until the next bound lies beyond the k-th best distance.
    With the principal directions of the references' frames as P the bound is so tight (about 97 % with 64
    directions of the paper's 1821 features) that a handful of true distances settle the answer.

    Only that handful is ever asked for in full. The references may therefore be any sequence of arrays,
    also one that computes an array when it is asked for it: fitting goes through it a few times, one array
    after the other, and what stays in memory are the projections.

    Args:
        n_projected: Directions kept. As many as there are features: the bound is the distance.
        random_state: Seed of the randomised decomposition that finds the directions. It changes how tight
            the bound is, never the answer.
        band: Sakoe-Chiba band, frames, as in :func:`wigwag.distances.dtw`; ``None``: no limit.
        cost: Distance between two frames, ``"euclidean"`` or its square, ``"squared"``.
    """

    def __init__(
        self, n_projected: int = 64, random_state: int = 0, band: int | None = None, cost: Cost = "euclidean"
    ) -> None:
        self.n_projected = n_projected
        self.random_state = random_state
        self.band = band
        self.cost = cost

    def fit(self, sequences: Sequence[Float[np.ndarray, "frames features"]]) -> Self:
        """Learn the projection from the references' frames, and project them.

        Raises:
            InputError: If there is no sequence, or the features differ.
        """
        frames = check_sequences(sequences)
        every = max(1, frames // _BASIS_FRAMES)
        some = np.concatenate([s[::every].copy() for s in sequences])
        self.mean_ = some.mean(axis=0, dtype=np.float64).astype(some.dtype)
        some -= self.mean_
        self.basis_ = self._learn(some)
        return self.restore(sequences, self.mean_, self.basis_, [self.project(s) for s in sequences])

    def restore(
        self,
        sequences: Sequence[Float[np.ndarray, "frames features"]],
        mean: Float[np.ndarray, " features"],
        basis: Float[np.ndarray, "features directions"],
        projected: Sequence[Float[np.ndarray, "frames directions+1"]],
    ) -> Self:
        """Take what ``fit`` learned from these references: ``mean_``, ``basis_`` and ``projected_``.

        Raises:
            InputError: If they do not belong together.
        """
        if len(projected) != len(sequences) or basis.shape[0] != len(mean):
            raise InputError(
                f"{len(projected)} projections from {basis.shape[0]} features do not belong to "
                f"{len(sequences)} sequences with a mean of {len(mean)} features."
            )
        self.sequences_, self.mean_, self.basis_ = sequences, mean, basis
        self.projected_ = list(projected)
        self.packed_ = PackedSequences(self.projected_)
        return self

    def _learn(self, centered: Float[np.ndarray, "frames features"]) -> np.ndarray:
        directions = min(self.n_projected, *centered.shape)
        if directions == centered.shape[1]:
            return np.eye(directions, dtype=centered.dtype)
        from sklearn.utils.extmath import randomized_svd  # with its 75 MB needed for learning alone

        _, _, rows = randomized_svd(centered, directions, n_iter=3, random_state=self.random_state)
        # Rounding leaves the rows a little off orthonormal; one more QR keeps the bound a bound.
        return np.asarray(np.linalg.qr(rows.T.astype(np.float64))[0], dtype=centered.dtype)

    def project(
        self, sequence: Float[np.ndarray, "frames features"]
    ) -> Float[np.ndarray, "frames directions+1"]:
        """Return the kept coordinates of each frame and, last, the length of what is left over."""
        centered = sequence - self.mean_
        kept = centered @ self.basis_
        whole = np.einsum("tf,tf->t", centered, centered)
        rest = np.sqrt(np.maximum(whole - np.einsum("tf,tf->t", kept, kept), 0))
        return np.column_stack([kept, rest])

    def bounds(self, query: Float[np.ndarray, "frames features"]) -> Float[np.ndarray, " references"]:
        """Return a lower bound of the DTW distance to each reference; exact up to float32 rounding."""
        return self.packed_.distances(self.project(query), self.band, self.cost)

    def nearest(
        self,
        query: Float[np.ndarray, "frames features"],
        k: int = 1,
        allowed: Bool[np.ndarray, " references"] | None = None,
        bounds: Float[np.ndarray, " references"] | None = None,
    ) -> tuple[Int[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """Return the k nearest references, nearest first, and their DTW distances.

        Args:
            query: One row a frame.
            k: How many; fewer come back if fewer are allowed.
            allowed: References that take part; ``None``: all.
            bounds: What :meth:`bounds` returned for this query, if it is at hand.
        """
        if bounds is None:
            bounds = self.bounds(query)
        order = np.argsort(bounds, kind="stable")
        if allowed is not None:
            order = order[allowed[order]]
        k = min(k, len(order))
        found: list[tuple[float, int]] = []
        for reference in order:
            if len(found) >= k and bounds[reference] * (1 - _SLACK) > found[k - 1][0]:
                break
            distance = self._distance(query, reference)
            found.append((distance, int(reference)))
            found.sort()
        # Those that rounding could have put in the wrong order are measured again without cancellation.
        close = [i for d, i in found if d <= found[k - 1][0] * (1 + _SLACK)]
        exact = sorted((dtw(query, self.sequences_[i], self.band, self.cost), i) for i in close)[:k]
        return np.array([i for _, i in exact]), np.array([d for d, _ in exact])

    def _distance(self, query: np.ndarray, reference: int) -> float:
        return float(
            dtw_by_product(query - self.mean_, self.sequences_[reference] - self.mean_, self.band, self.cost)
        )
