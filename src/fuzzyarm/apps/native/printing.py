"""The kernels in C: a file with the functions and a table of entries for each unit.

An entry takes a pointer and a length for each array; kernels call each other by its address. The
table also has its name, its wrapper for Python, and the set of arrays that it writes: this follows
from the kernel's own source, and for calls by address from all possible targets. One entry is the
interpreter of programs, with a case for each operation of the table.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from fuzzyarm.apps.native.roots import Root
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.programs import HEAD, INSTRUCTION
from fuzzyarm.symbolic.translation.functions import Translation, part_name
from fuzzyarm.symbolic.translation.targets import C99, HEAD_OF_C, POINTERS
from fuzzyarm.symbolic.translation.types import ARRAYS, Array, TupleType

_FRAME = """\
/* --- Programs of operations, see fuzzyarm/symbolic/programs.py --- */


#define minimum(a, b) real_min(a, b)
#define maximum(a, b) real_max(a, b)

enum {{ LANES = 32, ROOM = 4096 }};

/* One operation on all lanes: the choice is outside the loops, for the vectoriser. */
static void operate(int64_t code, const double *a, const double *b, const double *c, double *result,
                    int64_t lanes) {{
  switch (code) {{
{cases}
  }}
}}

/* Elements from `start` on, as many as there are lanes. Numbers come from arrays, one behind the
   other. */
static void walk(const double *program, const reals *rows, const reals *numbers, int number_arrays,
                 double *values, int64_t lanes, int64_t start) {{
  const int64_t row_count = (int64_t)program[0];
  const int64_t constant_count = (int64_t)program[2], steps = (int64_t)program[3];
  const double *constants = program + {head};
  const double *step = constants + constant_count;
  double *next = values;
  for (int64_t row = 0; row < row_count; row++, next += lanes)
    for (int64_t lane = 0; lane < lanes; lane++) next[lane] = rows[row].at[start + lane];
  for (const reals *part = numbers; part < numbers + number_arrays; part++)
    for (int64_t k = 0; k < part->length; k++, next += lanes)
      for (int64_t lane = 0; lane < lanes; lane++) next[lane] = part->at[k];
  for (int64_t k = 0; k < constant_count; k++, next += lanes)
    for (int64_t lane = 0; lane < lanes; lane++) next[lane] = constants[k];
  for (int64_t k = 0; k < steps; k++, next += lanes, step += {instruction})
    operate((int64_t)step[0], values + (int64_t)step[1] * lanes, values + (int64_t)step[2] * lanes,
            values + (int64_t)step[3] * lanes, next, lanes);
}}

/* Rows, numbers, and what is filled: an element of it for each element of the rows. A program
   without rows takes its numbers from all arrays in front, and fills in its results. */
static NEVER_INLINE void run_program(int64_t address, const reals *arrays, int count) {{
  const double *program = (const double *)(address - 1);
  const int64_t values = (int64_t)(program[0] + program[1] + program[2] + program[3]);
  const double *results =
      program + {head} + (int64_t)program[2] + {instruction} * (int64_t)program[3];
  const reals into = arrays[count - 1];
  double room[ROOM];
  double *work = values <= ROOM ? room : malloc((size_t)values * sizeof(double));
  if (work == NULL) {{
    for (int64_t k = 0; k < into.length; k++) into.at[k] = NAN;
    return;
  }}
  const int64_t most = values * LANES <= ROOM ? LANES : 1;
  if (program[0] == 0.0) {{
    walk(program, arrays, arrays, count - 1, work, 1, 0);
    for (int64_t k = 0; k < (int64_t)program[4]; k++) into.at[k] = work[(int64_t)results[k]];
  }} else {{
    for (int64_t start = 0; start < into.length; start += most) {{
      const int64_t left = into.length - start, lanes = left < most ? left : most;
      walk(program, arrays, arrays + count - 2, 1, work, lanes, start);
      const double *result = work + (int64_t)results[0] * lanes;
      for (int64_t lane = 0; lane < lanes; lane++) into.at[start + lane] = result[lane];
    }}
  }}
  if (work != room) free(work);
}}
"""

_CASE = """\
    case {code}: /* {name} */
      for (int64_t k = 0; k < lanes; k++) result[k] = {value};
      break;"""


def _cases() -> str:
    parts = ("a[k]", "b[k]", "c[k]")
    return "\n".join(
        _CASE.format(code=code, name=name, value=operation.c.lstrip("@").format(*parts))
        for code, (name, operation) in enumerate(OPERATIONS.items())
    )


WALKER = _FRAME.format(cases=_cases(), head=HEAD, instruction=INSTRUCTION)
"""Definitions in C, after those of :class:`fuzzyarm.symbolic.translation.targets.C99`."""


UNITS: dict[str, tuple[str, ...]] = {
    "rows": (),
    # Loops over a few numbers just written one by one: a vector load would wait for the stores, and
    # a
    # call of memset for four numbers costs more than the stores. Loops over the ports of a plant
    # compiled into its loop are unrolled.
    "numbers": (
        "-fno-tree-vectorize",
        "-fno-tree-loop-distribute-patterns",
        "--param=max-completely-peel-times=32",
    ),
}
"""Units with separate flags; see :attr:`Root.over_rows`."""


def kernels_in_c(kernels: Iterable[Root]) -> dict[str, str]:
    """Return the C of kernels by unit.

    The macros ``TABLE`` and ``RUN_PROGRAM`` are the external names of a file: it is compiled once
    for each level of the processor.
    """
    units = {unit: _Unit() for unit in UNITS}
    for root in kernels:
        units["rows" if root.over_rows else "numbers"].add(root)
    filled = dict(filled_arrays([entry for unit in units.values() for entry in unit.entries]))
    return {name: unit.text(filled) for name, unit in units.items()}


class TranslatedKernel(NamedTuple):
    """A translated kernel: its key and the types of its arrays."""

    key: str
    types: tuple[Array, ...]
    function: Any
    in_one: bool
    block: TupleType | None = None

    @property
    def arguments(self) -> list[str]:
        """Names of its arrays: of parameters, or of the parts of its block."""
        parameters: list[str] = self.function.parameters
        if self.block is None:
            return parameters
        return [part_name(parameters[0], part) for part in self.block.names]


class _Unit:
    """Kernels of one file."""

    def __init__(self) -> None:
        self.translation = Translation(C99)
        self.entries: list[TranslatedKernel] = []

    def add(self, root: Root) -> None:
        """Translate a kernel."""
        types = tuple(ARRAYS[letter] for letter in root.types)
        fields = getattr(root.block, "_fields", ())
        block = TupleType(types, fields) if fields else None
        taken = types if block is None else (block,)
        function = self.translation.function(root.function, taken, root.bindings)
        self.entries.append(TranslatedKernel(root.key, types, function, root.in_one, block))

    def text(self, filled: dict[str, set[int]]) -> str:
        """Return the file."""
        entries, rows = [], []
        for index, entry in enumerate(self.entries):
            key, block = entry.key, entry.block
            record = "" if block is None else self.translation.type_name(block)
            entries.append(_entries(index, entry, record))
            bits = sum(1 << position for position in filled[key])
            both = f"(void (*)(void))entry_{index}, spread_{index}"
            rows.append(f"  {{{json.dumps(key)}, {both}, {bits}u}},")
        table = ["const table_row TABLE[] = {", *rows, "  {0, 0, 0, 0},", "};", ""]
        body = self.translation.text()  # names the structures
        head = [HEAD_OF_C, WALKER, *self.translation.structures]
        return "\n".join([*head, body, *entries, _ROW, *table, _WALK])


def filled_arrays(entries: Sequence[TranslatedKernel]) -> Iterator[tuple[str, set[int]]]:
    """Iterate over kernels by key, with the arrays that each writes."""
    # A call by address may reach any kernel with such arrays, or a program of operations, which
    # writes its last one. Their sets may grow in a later pass: iterate to a fixed point.
    by_types: dict[tuple[Array, ...], set[int]] = defaultdict(set)
    for entry in entries:
        by_types[entry.types].add(len(entry.types) - 1)
    before = -1
    while before != (before := sum(map(len, by_types.values()))):
        for entry in entries:
            by_types[entry.types] |= set(_filled_by(entry, by_types))
    for entry in entries:
        yield entry.key, set(_filled_by(entry, by_types))


def _filled_by(
    entry: TranslatedKernel, by_types: dict[tuple[Array, ...], set[int]]
) -> Iterator[int]:
    """Iterate over the arrays written by a kernel, directly or in calls by address."""
    arguments = entry.arguments
    yield from map(arguments.index, entry.function.writes)
    for request in entry.function.address_calls:
        for position in by_types[tuple(type_ for type_, _ in request)]:
            yield from map(arguments.index, request[position][1])


_WALK = """\
void RUN_PROGRAM(int64_t address, const reals *arrays, int count) {
  run_program(address, arrays, count);
}
"""


_ROW = """\
typedef struct {
  const char *key;
  void (*entry)(void);
  void (*spread)(void *const *, const int64_t *);
  unsigned filled;
} table_row;
"""


def _entries(index: int, entry: TranslatedKernel, record: str) -> str:
    """Return the entry for kernels, arrays (in a `record`) as arguments, and that for Python."""
    types, in_one = entry.types, entry.in_one
    # The arrays of a loop do not overlap. With `restrict` the compiler keeps in registers the
    # numbers that a control period writes and reads again, in spite of stores to other arrays
    # between.
    apart = "restrict " if in_one else ""
    listed = ", ".join(
        f"{POINTERS[type_]} *{apart}at_{k}, int64_t length_{k}" for k, type_ in enumerate(types)
    )
    names = [C99.types[type_] for type_ in types]
    passed = ", ".join(f"({name}){{at_{k}, length_{k}}}" for k, name in enumerate(names))
    if record:
        passed = f"({record}){{{passed}}}"
    spread = ", ".join(f"at[{k}], lengths[{k}]" for k in range(len(types)))
    name, flatten = entry.function.name, "FLATTEN " * in_one
    return (
        f"{flatten}static void entry_{index}({listed}) {{ {name}({passed}); }}\n"
        f"static void spread_{index}(void *const *at, const int64_t *lengths) "
        f"{{ entry_{index}({spread}); }}\n"
    )
