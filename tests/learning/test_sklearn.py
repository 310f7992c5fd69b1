"""The estimators are scikit-learn's own checks' idea of estimators."""

from __future__ import annotations

import pytest

pytest.importorskip("sklearn")

import numpy as np
from sklearn.datasets import load_iris
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from fuzzyarm.language import parse
from fuzzyarm.sklearn import FuzzyClassifier, FuzzyRegressor


@parametrize_with_checks(
    [FuzzyRegressor(), FuzzyRegressor(method="wang-mendel"), FuzzyClassifier()]
)
def test_scikit_learn_takes_it_for_an_estimator(estimator, check):
    check(estimator)
