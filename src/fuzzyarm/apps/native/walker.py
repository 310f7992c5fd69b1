"""The interpreter of programs in C, with a case for each entry of the table of operations."""

from __future__ import annotations

from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.programs import HEAD, INSTRUCTION

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
