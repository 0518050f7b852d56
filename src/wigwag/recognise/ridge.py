"""Ridge regression on what many kernels say at once, grown and shrunk example by example."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float
from scipy.linalg import cho_factor, cho_solve


class EmpiricalMapRidge:
    """Least squares from similarities to targets: W minimises |F W - Y|^2 + ridge |W|^2.

    Row i of F holds the similarities of example i to every reference, one kernel after the other (the
    'empirical kernel map'; Schölkopf et al. 1999). Similarities from DTW are no positive semi-definite
    kernel, which this form does not ask for: F F' always is one. With G = F F' + ridge I, W = F' inv(G) Y.
    inv(G) is kept while examples are added, so that one more costs a few products and no new solution:
    references add columns to F (Woodbury), examples add rows (block inverse).

    Args:
        ridge: Weight of the penalty, per example.
    """

    def __init__(self, ridge: float) -> None:
        self.ridge = ridge

    def fit(
        self, features: Float[np.ndarray, "examples features"], targets: Float[np.ndarray, "examples targets"]
    ) -> EmpiricalMapRidge:
        """Solve from scratch."""
        gram = gram_matrix(features)
        self._penalty = self.ridge * len(gram)
        gram[np.diag_indices(len(gram))] += self._penalty
        self._inverse = cho_solve(cho_factor(gram, overwrite_a=True), np.eye(len(gram)), overwrite_b=True)
        self._features = np.asarray(features, dtype=np.float64)
        self._targets = np.asarray(targets, dtype=np.float64)
        return self

    @property
    def weights(self) -> Float[np.ndarray, "features targets"]:
        """W, one row a feature."""
        return np.asarray(self._features.T @ (self._inverse @ self._targets))

    def add_features(self, columns: Float[np.ndarray, "examples new"]) -> None:
        """Let every example have more features; W grows by as many rows, at its end."""
        columns = np.asarray(columns, dtype=np.float64)
        reached = self._inverse @ columns
        inner = np.eye(columns.shape[1]) + columns.T @ reached
        self._inverse -= reached @ np.linalg.solve(inner, reached.T)
        self._features = np.hstack([self._features, columns])

    def add_examples(
        self, features: Float[np.ndarray, "new features"], targets: Float[np.ndarray, "new targets"]
    ) -> None:
        """Learn from more examples."""
        features = np.asarray(features, dtype=np.float64)
        across = self._features @ features.T
        corner = features @ features.T
        corner[np.diag_indices(len(corner))] += self._penalty
        reached = self._inverse @ across
        inner = np.linalg.inv(corner - across.T @ reached)
        moved = reached @ inner
        self._inverse = np.block([[self._inverse + moved @ reached.T, -moved], [-moved.T, inner]])
        self._features = np.vstack([self._features, features])
        self._targets = np.vstack([self._targets, targets])

    def add_target(self, at: int) -> None:
        """Make room for one more target, which no example so far has."""
        self._targets = np.insert(self._targets, at, -1.0, axis=1)

    def keep(
        self,
        examples: Bool[np.ndarray, " examples"],
        features: Bool[np.ndarray, " features"],
        gone: int,
    ) -> None:
        """Forget all other examples and features, and one target, by solving again without them."""
        targets = np.delete(self._targets[examples], gone, axis=1)
        self.fit(self._features[np.ix_(examples, features)], targets)


def gram_matrix(features: Float[np.ndarray, "examples features"]) -> Float[np.ndarray, "examples examples"]:
    """Return F F' in double precision: the penalty is a hundred-thousandth of its largest eigenvalue."""
    exact = np.asarray(features, dtype=np.float64)
    return np.asarray(exact @ exact.T)


def solve(
    gram: Float[np.ndarray, "examples examples"], targets: Float[np.ndarray, "examples targets"], ridge: float
) -> Float[np.ndarray, "examples targets"]:
    """Return inv(G) Y for one penalty, leaving ``gram`` as it is."""
    penalised = gram.copy()
    penalised[np.diag_indices(len(gram))] += ridge * len(gram)
    return np.asarray(cho_solve(cho_factor(penalised, overwrite_a=True), targets))
