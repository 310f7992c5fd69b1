"""The kernels to build: all with an address in use.

Controllers, plants and rule bases of a user are not among them; they are data to these kernels,
or programs of operations.

A kernel is plain Python over scalars and arrays. :mod:`fuzzyarm.symbolic.translation` infers the
type of every name and prints C or JavaScript; ``build.py`` compiles it with ``module.c`` into
``fuzzyarm/_kernels``, at two levels for x86-64, both with the bits of the interpreted kernel. A
feature of Python that is not translated is refused by name: add it to the translation, or to
``functions`` of both targets. Slices are pointers and a length, without reference counts; these and
calls by address are the reasons for printed C instead of Cython (in pairs: 50 ns beside 61 for a
point of ``pd7.frb``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import product
from typing import Any, NamedTuple

from fuzzyarm.control.controllers import kernel as controller_kernel
from fuzzyarm.control.controllers.adaptive import (
    ADAPTIVE_CRITICALLY_DAMPED_LAW,
    DECENTRALISED_LAW,
    MODEL_REFERENCE_LAW,
)
from fuzzyarm.control.controllers.conventional import (
    COMPUTED_TORQUE_LAW,
    CRITICALLY_DAMPED_LAW,
    FEED_FORWARD_INVERSE_LAW,
    INTEGRAL_LAW,
    PD_LAW,
    PURE_FEED_FORWARD_LAW,
)
from fuzzyarm.control.controllers.law import LAW_ARRAYS, drives_of_laws, law_at_address, law_kernel
from fuzzyarm.control.controllers.on_plant import text_law
from fuzzyarm.control.controllers.updates import UPDATE_ARRAYS, update_function
from fuzzyarm.control.loop.loop import LOOP_ARRAYS, LoopBlock, loop_bindings, run_loop
from fuzzyarm.inference.kernel import GRID, evaluate
from fuzzyarm.inference.programs import EVALUATORS, IN_ROWS, PROGRAMS
from fuzzyarm.inference.row_functions import (
    built_in_curve,
    corners_row,
    hedged_corners_row,
    hedges_on_row,
    norm_row,
)
from fuzzyarm.language.model.rulebase import Hedge
from fuzzyarm.plant.own import PLANTS
from fuzzyarm.plant.plant import ARRAYS as PLANT_ARRAYS
from fuzzyarm.plant.plant import BY_PROGRAM, dynamics_of, run_plant
from fuzzyarm.plant.setting import RunArithmetic, stored_double, stored_single
from fuzzyarm.symbolic.kernels import key_of, letters_of
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.sources import SOURCES
from fuzzyarm.table import lookup


class Root(NamedTuple):
    """A kernel to build.

    Attributes
    ----------
    function : callable
        The kernel.
    types : str
        A letter for each array.
    bindings : mapping of str to callable
        See :func:`fuzzyarm.symbolic.kernels.address_of`.
    over_rows : bool
        Whether it runs over rows of many numbers; otherwise over a few, just written, where a
        vector load would wait for the stores.
    in_one : bool
        Whether all functions called by name are compiled into it, with arrays that do not overlap.
    block : type, optional
        Named tuple of its arrays; without one they are separate parameters.
    """

    function: Callable[..., Any]
    types: str
    bindings: Mapping[str, Callable[..., Any]] = {}
    over_rows: bool = False
    in_one: bool = False
    block: type[tuple[Any, ...]] | None = None

    @property
    def key(self) -> str:
        """Its key in the machine code."""
        return key_of(self.function, self.types, self.bindings)


PRECISIONS = tuple({"stored": stored} for stored in (stored_double, stored_single))

LAWS = (
    PD_LAW,
    INTEGRAL_LAW,
    COMPUTED_TORQUE_LAW,
    CRITICALLY_DAMPED_LAW,
    FEED_FORWARD_INVERSE_LAW,
    PURE_FEED_FORWARD_LAW,
    ADAPTIVE_CRITICALLY_DAMPED_LAW,
    DECENTRALISED_LAW,
    MODEL_REFERENCE_LAW,
)


def roots() -> Iterator[Root]:
    """Iterate over all kernels to build, each once."""
    once = {root.key: root for root in _roots()}
    yield from once.values()


def _roots() -> Iterator[Root]:
    yield from (
        Root(evaluator, "f", over_rows=evaluator is not evaluate) for evaluator in EVALUATORS
    )
    yield Root(evaluate, "f", GRID)
    blocks = (*PROGRAMS, *IN_ROWS)
    yield from (Root(block.block, "f", block.bindings, over_rows=True) for block in blocks)
    yield from _rows()
    yield from _plants()
    yield from (Root(*table, over_rows=True) for table in lookup.ROOTS)
    for source in SOURCES.values():
        if source.function is not None:
            yield Root(update_function(source), UPDATE_ARRAYS)
    yield from _loops()
    for stored in PRECISIONS:
        yield Root(drives_of_laws, "fifff", stored)
        yield Root(controller_kernel.step, "if", stored)
        yield Root(controller_kernel.step_guarded, "if", stored)
        yield Root(controller_kernel.settle, "if", stored)
        yield Root(text_law, LAW_ARRAYS, stored)
        for kernel in (law_kernel, *(law.kernel for law in LAWS)):
            yield Root(law_at_address, LAW_ARRAYS, {**stored, "law_kernel": kernel})


def _rows() -> Iterator[Root]:
    """Iterate over norms, curved terms and hedges over rows of numbers."""
    yield Root(corners_row, "fff", over_rows=True)
    yield Root(hedged_corners_row, "fff", over_rows=True)
    for norm in (*TNORMS.values(), *SNORMS.values()):
        yield Root(norm_row(norm), "ffff", over_rows=True)
    for name in SHAPES:
        if SHAPES[name].fuzzy and not SHAPES[name].straight and name != "formula":
            yield Root(built_in_curve(name), "fff", over_rows=True)
    for name, hedge in HEDGES.items():
        if len(hedge.symbols) == 1:  # the others have an exponent, constant over the row
            yield Root(hedges_on_row((Hedge(name, None),)), "fff", over_rows=True)


def _loops() -> Iterator[Root]:
    """Iterate over the loops: a general one, and those with law and plant compiled in."""
    plants = (kind.variants()[0] for kind in PLANTS.values())
    every = [dynamics_of(plant, RunArithmetic(), address=lambda *_, **__: 0) for plant in plants]
    for dynamics, of_text in product((None, *(d for d in every if d.actuates)), (False, True)):
        bindings = loop_bindings(dynamics, single=False, of_text=of_text)
        in_one = dynamics is not None
        yield Root(run_loop, LOOP_ARRAYS, bindings, in_one=in_one, block=LoopBlock)
    bindings = loop_bindings(None, single=True, of_text=False)
    yield Root(run_loop, LOOP_ARRAYS, bindings, block=LoopBlock)


def _plants() -> Iterator[Root]:
    roots: list[Root] = []

    def recorded(function: Callable[..., None], **bindings: Callable[..., Any]) -> int:
        roots.append(Root(function, letters_of(PLANT_ARRAYS), bindings))
        return 0

    plants = [plant for kind in PLANTS.values() for plant in kind.variants()]
    for single in (False, True):
        arithmetic = RunArithmetic(single)
        for plant in plants:
            for finely in (False, True):
                dynamics_of(plant, arithmetic, finely=finely, address=recorded)
    yield from roots
    yield from (Root(run_plant, PLANT_ARRAYS, bindings) for bindings in BY_PROGRAM)
