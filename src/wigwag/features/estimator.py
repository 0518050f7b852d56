"""scikit-learn's contract for estimators, without its import: 75 MB of which flying needs nothing."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from wigwag.errors import InputError

if TYPE_CHECKING:
    from sklearn.utils import Tags


class Estimator:
    """Parameters are what the constructor takes, kept under their own names.

    That is all that ``sklearn.base.clone``, pipelines and searches over parameters ask for. See
    https://scikit-learn.org/stable/developers/develop.html.
    """

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Return the constructor's parameters; none of ours holds another estimator, so ``deep`` is moot."""
        return {name: getattr(self, name) for name in self._parameters()}

    def set_params(self, **params: Any) -> Self:
        """Set some of the constructor's parameters.

        Raises:
            InputError: If there is no such parameter.
        """
        known = self._parameters()
        for name, value in params.items():
            if name not in known:
                raise InputError(
                    f"{type(self).__name__} has no parameter {name!r}. "
                    f"Available parameters: {', '.join(known)}."
                )
            setattr(self, name, value)
        return self

    @classmethod
    def _parameters(cls) -> list[str]:
        return list(inspect.signature(cls).parameters)

    def __repr__(self) -> str:
        """Name the parameters that are not the default ones."""
        defaults = {name: p.default for name, p in inspect.signature(type(self)).parameters.items()}
        changed = [f"{k}={v!r}" for k, v in self.get_params().items() if v is not defaults[k]]
        return f"{type(self).__name__}({', '.join(changed)})"

    def __sklearn_tags__(self) -> Tags:
        """Say what kind of estimator this is; scikit-learn alone asks, so it is imported already."""
        from sklearn.utils import Tags, TargetTags

        return Tags(estimator_type=None, target_tags=TargetTags(required=False))


class Transformer(Estimator):
    """An estimator that transforms."""

    def fit_transform(self, clips: Sequence[Any], y: object = None) -> Any:
        """Fit, then transform what was fitted on."""
        return self.fit(clips, y).transform(clips)  # type: ignore[attr-defined]  # a subclass brings both

    def __sklearn_tags__(self) -> Tags:
        """Say that this is a transformer."""
        from sklearn.utils import TransformerTags

        tags = super().__sklearn_tags__()
        tags.estimator_type, tags.transformer_tags = "transformer", TransformerTags()
        return tags


class Classifier(Estimator):
    """An estimator that classifies."""

    _estimator_type = "classifier"  # how scikit-learn before 1.6 asked

    def score(self, clips: Sequence[Any], y: Sequence[str] | np.ndarray) -> float:
        """Return the share of clips that ``predict`` gives the label in ``y``."""
        predicted = self.predict(clips)  # type: ignore[attr-defined]  # a subclass brings it
        return float(np.mean(np.asarray(predicted) == np.asarray(y)))

    def __sklearn_tags__(self) -> Tags:
        """Say that this is a classifier."""
        from sklearn.utils import ClassifierTags

        tags = super().__sklearn_tags__()
        tags.estimator_type, tags.classifier_tags = "classifier", ClassifierTags()
        tags.target_tags.required = True
        return tags
