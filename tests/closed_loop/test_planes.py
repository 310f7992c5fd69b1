"""Planes and bands of rule bases and tables hold what `infer` and `lookup` say, and are narrow."""

from dataclasses import replace

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.planes import RulePlanes, TablePlanes, Zonotope

BASES = {
    "pd7.frb": "u",  # minima, clipped sets
    "balance.frb": "push",  # products, singletons
    "roompi.frb": "du",
    "tipper.frb": "tip",
}


def asked(rulebase, output, points):
    evaluate = fuzzyarm.compiled(rulebase)
    column = [each.name for each in rulebase.outputs].index(output)
    return np.array([evaluate.at(*point)[column] for point in points])


def zonotope(generator, low, high, width):
    radius = 0.5 * width * (high - low)
    centre = generator.uniform(low + radius, high - radius)
    generators = generator.normal(size=(len(low), 3))
    generators *= (radius / np.abs(generators).sum(axis=1))[:, None]
    return Zonotope(centre, generators)


@pytest.mark.parametrize("name", BASES)
def test_a_band_holds_all_values_and_is_little_wider_than_they_are(name):
    rulebase = fuzzyarm.load(fuzzyarm.shipped(name))
    planes = RulePlanes(rulebase, BASES[name])
    low = np.array([each.low for each in rulebase.inputs])
    high = np.array([each.high for each in rulebase.inputs])
    generator = np.random.default_rng(11)
    for width in (1.0, 0.2, 0.02) * cases(2, 20):
        inputs = zonotope(generator, low, high, width)
        band = planes.band(inputs)
        shares = generator.uniform(-1, 1, (400, 3))
        shares[:100] = np.sign(shares[:100])
        points = inputs.centre + shares @ inputs.generators.T
        gaps = asked(rulebase, BASES[name], points) - points @ band.slopes
        slack = 1e-12 * (1 + np.abs(gaps).max())
        assert band.low - slack <= gaps.min()
        assert gaps.max() <= band.high + slack
        # Over the box around the set, whose corners count too.
        box = inputs.centre + generator.uniform(-1, 1, (2000, len(low))) * inputs.radius
        spread = np.ptp(asked(rulebase, BASES[name], box) - box @ band.slopes)
        assert band.high - band.low <= 2.0 * spread + 1e-6 * (1 + abs(band.high))


def test_the_whole_of_a_plane_is_a_plane():
    rulebase = fuzzyarm.load(fuzzyarm.shipped("balance.frb"))
    band = RulePlanes(rulebase, "push").band(Zonotope(np.zeros(2), np.diag([0.4, 0.4])))
    assert np.allclose(band.slopes, 2 / 3)
    assert band.high - band.low < 1e-9


def test_where_nothing_fires_nothing_is_said():
    rulebase = fuzzyarm.parse(
        "rulebase gap\ninput x 0 .. 2\noutput u 0 .. 1\nterm x a: triangle 0 0 0.5\n"
        "term u high: singleton 1\nrule if x is a then u is high\n"
    ).rulebase
    planes = RulePlanes(rulebase, "u")
    with pytest.raises(EnclosureError, match="no rule"):
        planes.band(Zonotope(np.array([0.6]), np.array([[0.2]])))
    assert planes.band(Zonotope(np.array([0.2]), np.array([[0.2]]))).low > 0.9


@pytest.mark.parametrize("mode", ["linear", "nearest"])
def test_the_band_of_a_table_holds_what_it_looks_up(mode):
    rulebase = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    table = replace(fuzzyarm.compile_table(rulebase, "u"), mode=mode)
    planes = TablePlanes(table)
    generator = np.random.default_rng(4)
    low = np.array([axis.levels[0] for axis in table.axes])
    high = np.array([axis.levels[-1] for axis in table.axes])
    for width in (1.2, 0.3, 0.05):
        radius = 0.5 * width * (high - low)
        inputs = Zonotope(generator.uniform(low, high) * 0.5, np.diag(radius))
        band = planes.band(inputs)
        points = inputs.centre + generator.uniform(-1, 1, (500, 2)) * radius
        values = np.array([table.lookup(*point) for point in points])
        gaps = values - points @ band.slopes
        assert band.low <= gaps.min()
        assert gaps.max() <= band.high
        if mode == "linear":
            assert band.high - band.low <= 1.6 * np.ptp(gaps) + 1e-9
