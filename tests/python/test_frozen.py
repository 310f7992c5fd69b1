"""Data classes and named tuples of `fuzzyarm.frozen` beside the standard library's."""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import pickle
import typing
from typing import ClassVar

import pytest

from fuzzyarm import frozen

BODIES = '''
class Point(Base):
    """A point."""

    x: float
    y: float = 2.0
    where: str = field(default="here", compare=False, repr=False)
    known: dict = field(default_factory=dict, compare=False)
    unit: ClassVar[str] = "m"

    def __post_init__(self):
        if self.x < 0.0:
            raise ValueError("x")

    def twice(self):
        return 2.0 * self.x
'''

BELOW = '''
class Below(Point):
    """A point with a height."""

    z: float = 0.0
'''

TUPLE = '''
class Pair(NamedTuple):
    """A pair."""

    a: int
    b: str = "b"

    @property
    def both(self):
        return f"{self.a}{self.b}"
'''

OPTIONS = [
    {"slots": True},
    {"slots": False},
    {"slots": False, "eq": False},
    {"slots": True, "repr": False},
]


def classes(library, **options):
    """Return the data classes of BODIES and BELOW, made by one library."""
    space = {"Base": object, "field": library.field, "ClassVar": ClassVar, "__name__": __name__}
    for body, name in ((BODIES, "Point"), (BELOW, "Below")):
        exec(f"from __future__ import annotations\n{body}", space)
        space[name] = library.dataclass(frozen=True, **options)(space[name])
    return space["Point"], space["Below"]


def pair(library):
    space = {"NamedTuple": library.NamedTuple, "__name__": __name__}
    exec(f"from __future__ import annotations\n{TUPLE}", space)
    return space["Pair"]


def outcome(action):
    """Return what an action gives, or what it raises."""
    try:
        return action()
    except Exception as error:
        return type(error), str(error)


def answers_of_classes(point, below):
    """Return what data classes answer, whoever made them."""
    one, other = point(1.0), point(1.0, where="there")
    low = below(1.0, 2.0, "here", {}, 3.0)
    yield from (repr(one), repr(low), one == other, one == point(2.0), one == low, one == 1.0)
    yield from (one.twice(), one.unit, one.known is other.known, point.__match_args__)
    yield outcome(lambda: hash(one) == hash(other))
    yield hash(one) == hash((1.0, 2.0)), hash(low) == hash((1.0, 2.0, 3.0))
    for action in (
        lambda: setattr(one, "x", 3.0),
        lambda: delattr(low, "x"),
        lambda: point(-1.0),
        point,
        lambda: point(1.0, z=2.0),
    ):
        yield outcome(action)
    yield dataclasses.asdict(low)
    yield [(f.name, f.compare, f.repr, f.type) for f in dataclasses.fields(below)]
    yield dataclasses.replace(low, y=5.0), dataclasses.is_dataclass(point)
    yield copy.copy(low) == low, copy.deepcopy(low) == low
    yield hasattr(one, "__dict__"), inspect.signature(below).parameters.keys()


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_a_data_class_answers_as_the_standard_librarys(options):
    ours = map(str, answers_of_classes(*classes(frozen, **options)))
    theirs = map(str, answers_of_classes(*classes(dataclasses, **options)))
    without_addresses = [_without_address(answer) for answer in ours]
    assert without_addresses == [_without_address(answer) for answer in theirs]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_a_data_class_takes_no_new_attribute(options):
    point, _ = classes(frozen, **options)
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'new'"):
        point(1.0).new = 3.0


def _without_address(answer):
    return answer.split(" object at 0x")[0]


def test_a_named_tuple_answers_as_the_standard_librarys():
    def answers(kind):
        one = kind(1)
        yield from (one, repr(one), one.a, one.b, one.both, one == (1, "b"), hash(one))
        yield from (one._replace(b="c"), one._asdict(), kind._make([3, "d"]), kind._fields)
        yield from (kind._field_defaults, kind.__match_args__, hasattr(one, "__dict__"))
        yield from map(outcome, (kind, lambda: kind._make([1]), lambda: kind(1, "b", 2)))
        yield outcome(lambda: one._replace(c=1))
        yield copy.copy(one), copy.deepcopy(one), isinstance(one, tuple)

    assert [str(a) for a in answers(pair(frozen))] == [str(a) for a in answers(pair(typing))]


def test_replace_is_that_of_the_standard_library():
    point, _ = classes(frozen, slots=True)
    assert frozen.replace(point(1.0), y=5.0) == dataclasses.replace(point(1.0), y=5.0)
    with pytest.raises(TypeError, match="unexpected keyword argument 'height'"):
        frozen.replace(point(1.0), height=5.0)


def test_records_of_the_model_are_pickled():
    from fuzzyarm import load, shipped

    rulebase = load(shipped("pd7.frb"))
    assert pickle.loads(pickle.dumps(rulebase)) == rulebase


def test_methods_are_written_when_they_are_called():
    point, _ = classes(frozen, slots=True)
    assert type(vars(point)["__hash__"]).__name__ == "_Unwritten"
    hash(point(1.0))
    assert inspect.isfunction(vars(point)["__hash__"])


def test_what_is_inherited_from_is_made_here_too():
    @dataclasses.dataclass(frozen=True)
    class Base:
        x: int = 0

    with pytest.raises(AssertionError, match="made here, too"):
        frozen.dataclass(frozen=True)(type("Below", (Base,), {}))


@pytest.mark.parametrize("module", ["picture", "model.rulebase", "model.controller"])
def test_what_is_shared_by_many_cannot_be_changed(module):
    found = importlib.import_module(f"fuzzyarm.{module}")
    classes = [kind for kind in vars(found).values() if isinstance(kind, type)]
    kinds = [kind for kind in classes
             if kind.__module__ == found.__name__ and dataclasses.is_dataclass(kind)]  # fmt: skip
    assert kinds
    assert [kind.__name__ for kind in kinds if not kind.__dataclass_params__.frozen] == []
