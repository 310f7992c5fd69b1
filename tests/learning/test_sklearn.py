"""The estimators are what scikit-learn's own checks take for estimators."""

from __future__ import annotations

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.inference import infer
from fuzzyarm.language import parse

QUICK = {"folds": 3, "rules": 2}


@pytest.fixture(autouse=True)
def sklearn():
    """scikit-learn takes seconds to import: not where tests are collected."""
    return pytest.importorskip("sklearn", reason="scikit-learn is not installed")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["FuzzyRegressor", "FuzzyClassifier"])
def test_scikit_learn_takes_it_for_an_estimator(name):
    from sklearn.utils.estimator_checks import check_estimator

    estimator = getattr(fuzzyarm.apps.estimators, name)(**QUICK, move=False)
    results = check_estimator(estimator, on_fail=None, on_skip=None)
    assert len(results) > 40
    failed = {each["check_name"]: each["exception"] for each in results
              if each["status"] not in ("passed", "skipped")}  # fmt: skip
    assert failed == {}


def test_the_model_is_a_rule_base_and_its_text():
    x = np.linspace(-1.0, 1.0, 60)[:, None]
    y = np.abs(x[:, 0])
    model = fuzzyarm.apps.estimators.FuzzyRegressor(**QUICK).fit(x, y)
    assert parse(model.text_).rulebase == model.rulebase_
    at = infer(model.rulebase_, x0=x[:, 0])["y"]
    assert np.allclose(model.predict(x), at, rtol=0.0, atol=1e-12)
    assert model.score(x, y) > 0.99


def test_wang_and_mendel_by_an_estimator():
    x = np.linspace(0.0, 1.0, 40)[:, None]
    model = fuzzyarm.apps.estimators.FuzzyRegressor(
        method="wang-mendel", words=(3, 5), folds=3
    ).fit(x, x[:, 0])
    assert "Wang and Mendel" in model.text_
    assert model.score(x, x[:, 0]) > 0.99


def test_names_of_a_frame_are_names_of_inputs():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"temperature": np.arange(30.0), "y": np.arange(30.0) % 7})
    model = fuzzyarm.apps.estimators.FuzzyRegressor(**QUICK).fit(frame, np.arange(30.0))
    assert [each.name for each in model.rulebase_.inputs] == ["temperature", "y (input)"]


@pytest.mark.slow
def test_pipeline_and_grid_search_and_classes():
    from sklearn.datasets import load_iris
    from sklearn.model_selection import GridSearchCV, cross_val_score
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    samples = load_iris()
    words = np.array(samples.target_names)[samples.target]
    search = GridSearchCV(
        make_pipeline(
            StandardScaler(), fuzzyarm.apps.estimators.FuzzyClassifier(folds=2, move=False)
        ),
        {"fuzzyclassifier__rules": [1, 3]},
        cv=2,
    ).fit(samples.data, words)
    assert search.best_params_ == {"fuzzyclassifier__rules": 3}
    model = fuzzyarm.apps.estimators.FuzzyClassifier(folds=2, rules=3, move=False)
    assert cross_val_score(model, samples.data, words, cv=3).mean() > 0.93
    model.fit(samples.data, words)
    assert [each.name for each in model.rulebase_.outputs] == list(model.classes_)
    shares = model.predict_proba(samples.data)
    assert np.allclose(shares.sum(axis=1), 1.0)
    assert (model.classes_[shares.argmax(axis=1)] == model.predict(samples.data)).all()


def test_the_largest_output_is_the_answer_beyond_1_too():
    """Outputs are straight lines: away from the samples several of three may exceed 1."""
    draw = np.random.default_rng(0)
    middles = np.array([[-0.5, 0.0], [0.5, 0.3], [0.1, -0.6]])
    x = draw.uniform(-1.0, 1.0, (60, 2))
    classes = ((x[:, None] - middles) ** 2).sum(axis=2).argmin(axis=1)
    model = fuzzyarm.apps.estimators.FuzzyClassifier(terms=(1, 1), shrinkage=0.0, move=False)
    model.fit(x, classes)
    far = draw.uniform(-4.0, 4.0, (200, 2))
    outputs = model.decision_function(far)
    assert ((outputs > 1.0).sum(axis=1) > 1).any()
    assert (model.predict(far) == outputs.argmax(axis=1)).all()
    assert (model.predict_proba(far).argmax(axis=1) == outputs.argmax(axis=1)).all()
