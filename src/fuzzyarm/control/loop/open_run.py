"""A run in progress: advanced in parts, with loads and gains changed in between.

The whole state of a run is in the arrays of the loop, so a run in parts has the bits of a whole
one, and a change takes effect with the next part.
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
    """A controller of another structure, which cannot take over the state of the running one."""


class OpenRun:
    """A run in progress.

    Parameters
    ----------
    site : Site
        The ports and the layout of the board.
    program : LoopProgram
        The controller.
    course : Course
        The experiment.
    record : RunRecord
        Its arrays, for this program and course; its seed is that of the run.
    loaded : bool, optional
        Whether :meth:`push` is allowed, which needs an array of loads for all periods.

    Attributes
    ----------
    program : LoopProgram
        The controller now running.
    record : RunRecord
        The results so far.
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
        """Number of completed set points."""
        return self.record.next

    @property
    def over(self) -> bool:
        """Whether all set points are done, or the run has diverged."""
        return self.record.lost is not None or self.next >= self.count

    def advance(self, until: int | None = None) -> None:
        """Advance up to, not including, a set point; by default to the end."""
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
        """Add to drives after their limits from now on, on top of the loads of the options.

        Parameters
        ----------
        loads : mapping of (str, str) to float
            By axis and port of an input, in its unit; 0 for the others.
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
        """Replace the controller by one of the same structure, keeping its state.

        So gains, terms and tables can be changed during a run.
        """
        program = LoopProgram(controller_on(controller, self.site), self.program.arithmetic)
        if not program.compilable or program.structure() != self.program.structure():
            raise StructureError(f"{controller.name} has another structure")
        # State cells have other addresses if a rule base has another layout, but the same order.
        memory = program.memory.copy()
        memory[program.kept()] = np.asarray(self.record.memory)[self.program.kept()]
        self.record.memory = flat(memory, as_array=self.course.as_array)
        self._use(program)

    def _use(self, program: LoopProgram) -> None:
        self.program = program
        self._block = self.record.block(program, self._experiment)
        self._loop = loop_for(program, self.course, self.record)
