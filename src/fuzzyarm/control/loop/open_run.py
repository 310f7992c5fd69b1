"""A run in progress: advanced in parts, with loads and gains changed on the way.

All that a run is stands in the arrays of the loop, so that a run in parts has the bits of a
whole one, and what is changed between two parts counts from there on.
"""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import Site, controller_on
from fuzzyarm.control.loop.course import Course, flat
from fuzzyarm.control.loop.loop import TICK
from fuzzyarm.control.loop.program import LoopProgram, RunRecord, loop_for
from fuzzyarm.plant.own import plain_errors
from fuzzyarm.plant.plant import Address


class StructureError(FuzzyarmError, ValueError):
    """A controller that cannot go on where another one is: they have different structures."""


class OpenRun:
    """A run, from its start on.

    Parameters
    ----------
    site : Site
        Where the controller runs.
    program : LoopProgram
        Of the controller.
    course : Course
        The experiment.
    record : RunRecord
        What it writes, of this program and course; its seed is that of the run.
    loaded : bool, optional
        Whether :meth:`push` is to be used, which needs a number for each drive and period.

    Attributes
    ----------
    program : LoopProgram
        That runs now.
    record : RunRecord
        What it has written so far.
    seconds : float
        Wall time of the loop.
    """

    def __init__(
        self,
        site: Site,
        program: LoopProgram,
        course: Course,
        record: RunRecord,
        *,
        loaded: bool = False,
    ) -> None:
        self.site, self.course, self.record = site, course, record
        self.seconds = 0.0
        self.count = len(course.motion.time)
        self._loads = course.loads() if loaded else None
        self._shares: dict[int, float] = {}
        if not course.as_array:
            program.controller.prepare(program.arithmetic)
        self._experiment = course.parts(record.seed, self._loads)
        self._use(program)

    @property
    def next(self) -> int:
        """Set points that are done."""
        return self.record.next

    @property
    def over(self) -> bool:
        """Whether all set points are done, or the run has been stopped before."""
        return self.record.lost is not None or self.next >= self.count

    def advance(self, until: int | None = None) -> None:
        """Go on before a set point; by default to the end."""
        if self.over:
            return
        end = self.count if until is None else min(until, self.count)
        self._write_loads(end)
        self.record.go_on(end)
        begin = time.perf_counter()
        with np.errstate(all="ignore"), plain_errors(self.course.plant):
            self._loop(self._block)
        self.seconds += time.perf_counter() - begin

    # --- Changes during a run ---

    def push(self, loads: Mapping[Address, float]) -> None:
        """Add to drives behind their limits, from now on; beside the loads of the options.

        Parameters
        ----------
        loads : mapping of (str, str) to float
            By axis and port of an input, in its unit; the others are let go.
        """
        if self._loads is None:
            raise ValueError("this run was not made to be pushed")
        inputs = list(self.course.site.interface.inputs)
        self._shares = {inputs.index(port): value for port, value in loads.items() if value}

    def _write_loads(self, end: int) -> None:
        if self._loads is None or not self._shares:
            return
        first = int(self.record.progress[TICK])
        last = first + int(self.course.motion.iterations[self.next : end].sum())
        rows = np.asarray(self._loads).reshape(self.course.steps, -1)
        for column, value in self._shares.items():
            rows[first:last, column] += value

    def take_over(self, controller: Controller) -> None:
        """Go on with another controller of the same structure; what is remembered stays.

        This changes gains, terms and tables during a run.
        """
        program = LoopProgram(controller_on(controller, self.site), self.program.arithmetic)
        if not program.compilable or program.structure() != self.program.structure():
            raise StructureError(f"{controller.name} has another structure")
        # Its cells lie elsewhere where a rule base has another layout; their order is the same.
        memory = program.memory.copy()
        memory[program.kept()] = np.asarray(self.record.memory)[self.program.kept()]
        self.record.memory = flat(memory, as_array=self.course.as_array)
        self._use(program)

    def _use(self, program: LoopProgram) -> None:
        self.program = program
        self._block = self.record.block(program, self._experiment)
        self._loop = loop_for(program, self.course, self.record)
