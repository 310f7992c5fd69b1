"""Estimators of scikit-learn with a legible rule base as model.

``FuzzyRegressor().fit(X, y).rulebase_`` is the model, ``text_`` its file. They work in pipelines,
grid searches and cross-validations like every other estimator, and compute the same as ``fuzzyarm
fit``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import MissingExtraError

try:
    from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
    from sklearn.utils.multiclass import check_classification_targets
    from sklearn.utils.validation import check_is_fitted, validate_data
except ModuleNotFoundError as error:
    raise MissingExtraError("data", "fuzzyarm.apps.estimators") from error

from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.fit import Fit, fit, outputs_of
from fuzzyarm.learning.fit_options import Options

__all__ = ["FuzzyClassifier", "FuzzyRegressor"]

Array = NDArray[Any]


class _FuzzyModel(BaseEstimator):
    """Shared by both estimators: parameters, options, names of the inputs."""

    def __init__(
        self,
        *,
        start: str = "grid",
        rules: int = 16,
        terms: tuple[int, ...] | None = None,
        shrinkage: float | None = None,
        move: bool | None = None,
        series: bool = False,
        folds: int = 5,
        digits: int = 4,
        outside: str = "extend",
        random_state: int = 0,
    ) -> None:
        self.start = start
        self.rules = rules
        self.terms = terms
        self.shrinkage = shrinkage
        self.move = move
        self.series = series
        self.folds = folds
        self.digits = digits
        self.outside = outside
        self.random_state = random_state

    def _options(self) -> Options:
        return Options(
            start=self.start,
            rules=self.rules,
            terms=None if self.terms is None else tuple(self.terms),
            shrinkage=self.shrinkage,
            move=self.move,
            series=self.series,
            parts=self.folds,
            digits=self.digits,
            outside=self.outside,
            seed=0 if self.random_state is None else int(self.random_state),
            nested=False,  # scikit-learn judges by its own samples
        )

    def _learn(self, samples: Samples) -> Fit:
        result = fit(samples, self._options())
        if result.interrupted:  # a grid search would continue as if nothing had happened
            raise KeyboardInterrupt
        self.rulebase_ = result.rulebase
        self.text_ = result.text
        self.fit_ = result
        return result

    def _input_names(self, output_names: tuple[str, ...]) -> tuple[str, ...]:
        """Return names for the inputs; x0, x1 … for samples without names."""
        names_in = getattr(self, "feature_names_in_", None)
        names = (
            [f"x{k}" for k in range(self.n_features_in_)] if names_in is None else list(names_in)
        )
        return tuple(f"{name} (input)" if name in output_names else str(name) for name in names)

    def _outputs(self, X: Any, classes: tuple[str, ...]) -> Array:  # noqa: N803
        check_is_fitted(self)
        inputs = validate_data(self, X, reset=False, dtype=np.float64)
        names = tuple(variable.name for variable in self.rulebase_.inputs)
        unknown = np.zeros(len(inputs))
        target = self.rulebase_.outputs[0].name if not classes else "class"
        return outputs_of(self.rulebase_, Samples(names, inputs, target, unknown, classes))


class FuzzyRegressor(RegressorMixin, _FuzzyModel):
    """A Takagi–Sugeno or Wang–Mendel rule base for numbers.

    Parameters
    ----------
    method : str
        ``sugeno`` or ``wang-mendel``.
    words : int or (int, int)
        Of Wang and Mendel's rules; of a range cross-validation chooses.
    start, rules, terms, shrinkage, move, series, folds, digits, outside, random_state
        As in :class:`fuzzyarm.learning.fit.Options`.

    Attributes
    ----------
    rulebase_ : RuleBase
        The model.
    text_ : str
        Its file.
    fit_ : Fit
        Quality: errors, candidates, support of the rules.
    n_features_in_, feature_names_in_
        As everywhere in scikit-learn.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzyarm.apps.estimators import FuzzyRegressor
    >>> X = np.linspace(-1, 1, 50)[:, None]
    >>> model = FuzzyRegressor().fit(X, np.abs(X[:, 0]))
    >>> bool(model.score(X, np.abs(X[:, 0])) > 0.99)
    True
    """

    def __init__(
        self,
        *,
        method: str = "sugeno",
        words: int | tuple[int, int] = 7,
        start: str = "grid",
        rules: int = 16,
        terms: tuple[int, ...] | None = None,
        shrinkage: float | None = None,
        move: bool | None = None,
        series: bool = False,
        folds: int = 5,
        digits: int = 4,
        outside: str = "extend",
        random_state: int = 0,
    ) -> None:
        super().__init__(
            start=start,
            rules=rules,
            terms=terms,
            shrinkage=shrinkage,
            move=move,
            series=series,
            folds=folds,
            digits=digits,
            outside=outside,
            random_state=random_state,
        )
        self.method = method
        self.words = words

    def _options(self) -> Options:
        low, high = (self.words, self.words) if isinstance(self.words, int) else self.words
        return replace(super()._options(), method=self.method, words=(low, high))

    def fit(self, X: Any, y: Any) -> FuzzyRegressor:  # noqa: N803
        """Learn a rule base.

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            At most 32 inputs.
        y : array_like, shape (samples,)
            Numbers.

        Returns
        -------
        FuzzyRegressor
            Itself.
        """
        inputs, values = validate_data(
            self, X, y, dtype=np.float64, y_numeric=True, ensure_min_samples=2
        )
        names = self._input_names(("y",))
        self._learn(Samples(names, inputs, "y", values.astype(float)))
        return self

    def predict(self, X: Any) -> Array:  # noqa: N803
        """Return the output of the rule base, shape (samples,).

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            As for :meth:`fit`.
        """
        return self._outputs(X, ())[:, 0]


class FuzzyClassifier(ClassifierMixin, _FuzzyModel):
    """A Takagi–Sugeno rule base with an output for each class; the largest one is the answer.

    Parameters
    ----------
    start, rules, terms, shrinkage, move, series, folds, digits, outside, random_state
        As in :class:`fuzzyarm.learning.fit.Options`.

    Attributes
    ----------
    rulebase_ : RuleBase
        The model.
    text_ : str
        Its file.
    fit_ : Fit
        Quality: errors, candidates, support of the rules.
    classes_ : ndarray
        The classes.
    n_features_in_, feature_names_in_
        As everywhere in scikit-learn.
    """

    def fit(self, X: Any, y: Any) -> FuzzyClassifier:  # noqa: N803
        """Learn a rule base.

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            At most 32 inputs.
        y : array_like, shape (samples,)
            Classes, two or more.

        Returns
        -------
        FuzzyClassifier
            Itself.
        """
        inputs, labels = validate_data(self, X, y, dtype=np.float64, ensure_min_samples=2)
        check_classification_targets(labels)
        self.classes_, values = np.unique(labels, return_inverse=True)
        if len(self.classes_) < 2:
            raise ValueError("the samples have one class only, two are needed")
        names = self._input_names(self._class_names())
        samples = Samples(names, inputs, "class", values.astype(float), self._class_names())
        self._learn(samples)
        return self

    def _class_names(self) -> tuple[str, ...]:
        texts = tuple(str(label) for label in self.classes_.tolist())
        return texts if len(set(texts)) == len(texts) else tuple(map(repr, self.classes_.tolist()))

    def decision_function(self, X: Any) -> Array:  # noqa: N803
        """Return the outputs, shape (samples, classes); of two classes the second's lead.

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            As for :meth:`fit`.
        """
        check_is_fitted(self)
        outputs = self._outputs(X, self._class_names())
        return outputs[:, 1] - outputs[:, 0] if outputs.shape[1] == 2 else outputs

    def predict_proba(self, X: Any) -> Array:  # noqa: N803
        """Return shares that sum to 1, shape (samples, classes): the outputs that are above 0.

        They are estimates of least squares, see `fuzzyarm validate` for how far to trust them.

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            As for :meth:`fit`.
        """
        check_is_fitted(self)
        # An output above 1 is not cut: two of them would tie, and the first would be the answer.
        outputs = np.maximum(self._outputs(X, self._class_names()), 1e-9)
        shares: Array = outputs / outputs.sum(axis=1, keepdims=True)
        return shares

    def predict(self, X: Any) -> Array:  # noqa: N803
        """Return the class with the largest output, shape (samples,).

        Parameters
        ----------
        X : array_like, shape (samples, inputs)
            As for :meth:`fit`.
        """
        check_is_fitted(self)
        answers: Array = self.classes_[self.predict_proba(X).argmax(axis=1)]
        return answers
