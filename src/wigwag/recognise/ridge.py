"""Ridge regression on what many kernels say at once, grown and shrunk example by example."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float
from scipy.linalg import cho_factor, cho_solve


class EmpiricalMapRidge:
    """Least squares from similarities to targets: W minimises |F W - Y|^2 + ridge |W|^2.

    Row i of F holds the similarities of example i to every reference, one kernel after the other (the
    'empirical kernel map'; Schölkopf et al. 1999). Similarities from DTW are no positive semi-definite
    kernel, which this form does not ask for: G = F F' always is one, and W = F' inv(G + ridge I) Y.

    G is kept. One more example then costs a few products and one Cholesky factorisation, which is a third
    of a product of G with itself; the similarities, by far the dearest part, are never computed again.
    (Updating the inverse instead is cheaper still and wrong after three examples: G is nearly singular.)

    Args:
        ridge: Weight of the penalty, per example that was fitted.
    """

    def __init__(self, ridge: float) -> None:
        self.ridge = ridge

    def fit(
        self,
        features: Float[np.ndarray, "examples features"],
        targets: Float[np.ndarray, "examples targets"],
        penalised: int | None = None,
    ) -> EmpiricalMapRidge:
        """Learn from examples.

        Args:
            features: Their similarities to the references.
            targets: What they are.
            penalised: The penalty is as for this many examples; ``None``: as many as there are. Examples
                that come or go later do not change it, so that what was added can be taken away again.
        """
        self._features = np.asarray(features, dtype=np.float32)
        self._targets = np.asarray(targets, dtype=np.float64)
        self._gram = gram_matrix(features)
        self.penalised = len(features) if penalised is None else penalised
        return self

    @property
    def weights(self) -> Float[np.ndarray, "features targets"]:
        """W, one row a feature."""
        coefficients = _penalised_solution(self._gram, self._targets, self.ridge * self.penalised)
        return np.asarray(self._features.T @ coefficients)

    def add_features(self, columns: Float[np.ndarray, "examples new"]) -> None:
        """Let every example have more features; W grows by as many rows, at its end."""
        self._gram += gram_matrix(columns)
        self._features = np.hstack([self._features, columns.astype(np.float32)])

    def add_examples(
        self, features: Float[np.ndarray, "new features"], targets: Float[np.ndarray, "new targets"]
    ) -> None:
        """Learn from more examples."""
        exact = np.asarray(features, dtype=np.float64)
        across = self._features @ exact.T
        self._gram = np.block([[self._gram, across], [across.T, exact @ exact.T]])
        self._features = np.vstack([self._features, features.astype(np.float32)])
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
        """Forget all other examples and features, and one target."""
        targets = np.delete(self._targets[examples], gone, axis=1)
        self.fit(self._features[np.ix_(examples, features)], targets, self.penalised)


def gram_matrix(features: Float[np.ndarray, "examples features"]) -> Float[np.ndarray, "examples examples"]:
    """Return F F' in double precision: the penalty is a hundred-thousandth of its largest eigenvalue."""
    exact = np.asarray(features, dtype=np.float64)
    return np.asarray(exact @ exact.T)


def solve(
    gram: Float[np.ndarray, "examples examples"], targets: Float[np.ndarray, "examples targets"], ridge: float
) -> Float[np.ndarray, "examples targets"]:
    """Return inv(G) Y for one penalty, leaving ``gram`` as it is."""
    return _penalised_solution(gram, targets, ridge * len(gram))


def _penalised_solution(
    gram: Float[np.ndarray, "examples examples"],
    targets: Float[np.ndarray, "examples targets"],
    penalty: float,
) -> Float[np.ndarray, "examples targets"]:
    penalised = gram.copy()
    penalised[np.diag_indices(len(gram))] += penalty
    return np.asarray(cho_solve(cho_factor(penalised, lower=True, overwrite_a=True), targets))
