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

    Beside W there is the mean of what every kernel learns by itself, ``weights_apart``. A kernel alone has
    few features, so that it is the normal matrices F'F that are kept for it.

    Args:
        ridge: Weight of the penalty, per example that was fitted.
        kernels: How many there are; features stand kernel by kernel within each reference.
    """

    def __init__(self, ridge: float, kernels: int = 1) -> None:
        self.ridge = ridge
        self.kernels = kernels

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
        self._normals = normal_matrices(features, self.kernels)
        self.penalised = len(features) if penalised is None else penalised
        return self

    @property
    def weights(self) -> Float[np.ndarray, "features targets"]:
        """W, one row a feature."""
        coefficients = _penalised_solution(self._gram, self._targets, self.ridge * self.penalised)
        return _sums(self._features, coefficients)

    @property
    def weights_apart(self) -> Float[np.ndarray, "features targets"]:
        """The mean over kernels of what each learns by itself, in rows as ``weights``."""
        return solve_apart(self._features, self._targets, self._normals, self.ridge * self.penalised)

    def add_features(self, columns: Float[np.ndarray, "examples new"]) -> None:
        """Let every example have more features; W grows by as many rows, at its end."""
        self._gram += gram_matrix(columns)
        added = []
        for k, normal in enumerate(self._normals):
            new = columns[:, k :: self.kernels].astype(np.float64)
            across = _sums(self._features[:, k :: self.kernels], new)
            added.append(np.block([[normal, across], [across.T, new.T @ new]]))
        self._normals = added
        self._features = np.hstack([self._features, columns.astype(np.float32)])

    def add_examples(
        self, features: Float[np.ndarray, "new features"], targets: Float[np.ndarray, "new targets"]
    ) -> None:
        """Learn from more examples."""
        exact = np.asarray(features, dtype=np.float64)
        across = self._features @ exact.T
        self._gram = np.block([[self._gram, across], [across.T, exact @ exact.T]])
        more = normal_matrices(exact, self.kernels)
        self._normals = [normal + new for normal, new in zip(self._normals, more, strict=True)]
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


def normal_matrices(
    features: Float[np.ndarray, "examples features"], kernels: int
) -> list[Float[np.ndarray, "references references"]]:
    """Return F'F of each kernel in double precision."""
    each = (np.asarray(features[:, k::kernels], dtype=np.float64) for k in range(kernels))
    return [part.T @ part for part in each]


def solve_apart(
    features: Float[np.ndarray, "examples features"],
    targets: Float[np.ndarray, "examples targets"],
    normals: list[Float[np.ndarray, "references references"]],
    penalty: float,
) -> Float[np.ndarray, "features targets"]:
    """Return the mean over kernels of inv(F'F + penalty I) F'Y, a kernel's rows where its features are."""
    kernels = len(normals)
    weights = np.empty((features.shape[1], targets.shape[1]))
    products = _sums(features, targets)
    for k, normal in enumerate(normals):
        weights[k::kernels] = _penalised_solution(normal, products[k::kernels], penalty) / kernels
    return weights


def solve(
    gram: Float[np.ndarray, "examples examples"], targets: Float[np.ndarray, "examples targets"], ridge: float
) -> Float[np.ndarray, "examples targets"]:
    """Return inv(G) Y for one penalty, leaving ``gram`` as it is."""
    return _penalised_solution(gram, targets, ridge * len(gram))


def _penalised_solution(
    gram: Float[np.ndarray, "size size"], targets: Float[np.ndarray, "size targets"], penalty: float
) -> Float[np.ndarray, "size targets"]:
    penalised = gram.copy()
    penalised[np.diag_indices(len(gram))] += penalty
    return np.asarray(cho_solve(cho_factor(penalised, lower=True, overwrite_a=True), targets))


_ROWS_AT_ONCE = 128


def _sums(
    features: Float[np.ndarray, "examples features"], columns: Float[np.ndarray, "examples columns"]
) -> Float[np.ndarray, "features columns"]:
    """Return F' C in double precision, some rows at a time: a copy of all of F costs more."""
    result = np.zeros((columns.shape[1], features.shape[1]))
    for start in range(0, len(features), _ROWS_AT_ONCE):
        rows = slice(start, start + _ROWS_AT_ONCE)
        result += columns[rows].T @ features[rows].astype(np.float64)
    return np.ascontiguousarray(result.T)
