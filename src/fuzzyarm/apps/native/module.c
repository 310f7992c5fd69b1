/* The extension module fuzzyarm._kernels: what Python needs of the printed kernels.

   It has a table of entries for each level of the processor. An entry takes a pointer and a length
   for each array; its address is what kernels call each other by. Only the stable ABI of Python 3.11
   is used, so one build serves all later versions. */

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030b0000
#include <Python.h>
#include <stdint.h>
#include <string.h>

typedef void (*spread_entry)(void *const *at, const int64_t *lengths);

typedef struct {
  const char *key;
  void (*entry)(void);  /* as kernels call it: a pointer and a length for each array */
  spread_entry spread;  /* as Python does */
  unsigned filled;      /* a bit for each array that it writes into */
} table_row;

extern const table_row baseline_rows[], baseline_numbers[];
#ifdef FUZZYARM_V3
extern const table_row v3_rows[], v3_numbers[];
#endif
extern const char fuzzyarm_sources[];

typedef struct { double *at; int64_t length; } fuzzyarm_reals;
void baseline_rows_program(int64_t address, const fuzzyarm_reals *arrays, int count);

typedef struct {
  const char *level;
  const table_row *rows;
} table;

static const table tables[] = {
    {"baseline", baseline_rows},
    {"baseline", baseline_numbers},
#ifdef FUZZYARM_V3
    {"x86-64-v3", v3_rows},
    {"x86-64-v3", v3_numbers},
#endif
    {NULL, NULL}};

#ifdef FUZZYARM_V3
#include <cpuid.h>

/* Whether the processor has what x86-64-v3 names, and the system keeps its wide registers. */
static int has_v3(void) {
  unsigned a, b, c, d, low, high;
  const unsigned fma_movbe_xsave_avx_f16c = 1u << 12 | 1u << 22 | 1u << 27 | 1u << 28 | 1u << 29;
  const unsigned bmi1_avx2_bmi2 = 1u << 3 | 1u << 5 | 1u << 8;
  if (!__get_cpuid(1, &a, &b, &c, &d)) return 0;
  if ((c & fma_movbe_xsave_avx_f16c) != fma_movbe_xsave_avx_f16c) return 0;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return 0;
  if ((b & bmi1_avx2_bmi2) != bmi1_avx2_bmi2) return 0;
  if (!__get_cpuid(0x80000001, &a, &b, &c, &d) || !(c & 1u << 5)) return 0; /* lzcnt */
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low & 6) == 6;
}
#endif

/* The levels that this processor can run, the best one first. */
static PyObject *levels(PyObject *module, PyObject *unused) {
  (void)module;
  (void)unused;
#ifdef FUZZYARM_V3
  if (has_v3()) return Py_BuildValue("(ss)", "x86-64-v3", "baseline");
#endif
  return Py_BuildValue("(s)", "baseline");
}

/* The address of an entry, an even number. In WebAssembly code has a place in a table of functions,
   odd or even: code_at of fuzzyarm/symbolic/translation/targets.py reads this back. */
static unsigned long long address_of(const table_row *row) {
  const unsigned long long place = (uintptr_t)(void *)row->entry;
#ifdef __wasm__
  return 2 * place;
#else
  return place;
#endif
}

static PyObject *addresses(PyObject *module, PyObject *level) {
  (void)module;
  const char *name = PyUnicode_AsUTF8AndSize(level, NULL);
  PyObject *found = name == NULL ? NULL : PyDict_New();
  for (const table *part = tables; found != NULL && part->level != NULL; part++) {
    if (strcmp(part->level, name) != 0) continue;
    for (const table_row *row = part->rows; found != NULL && row->key != NULL; row++) {
      PyObject *address = PyLong_FromUnsignedLongLong(address_of(row));
      if (address == NULL || PyDict_SetItemString(found, row->key, address) < 0) Py_CLEAR(found);
      Py_XDECREF(address);
    }
  }
  if (found != NULL && PyDict_Size(found) == 0) {
    Py_CLEAR(found);
    PyErr_Format(PyExc_ValueError, "no machine code for '%s'", name);
  }
  return found;
}

/* --- Calls from Python --- */

enum { MOST_ARRAYS = 32 };

typedef struct {
  PyObject_HEAD
  const table_row *row;
  int count;                  /* of arrays */
  int held;                   /* buffers that are to be released */
  int brief;                  /* whether it keeps the lock of the interpreter */
  char letters[MOST_ARRAYS];  /* f: float64, i: int64, s: int32 */
  Py_buffer buffers[MOST_ARRAYS];
} Routine;

static PyTypeObject *routine_type;

static void release(Routine *self) {
  while (self->held > 0) PyBuffer_Release(&self->buffers[--self->held]);
}

static void routine_free(PyObject *object) {
  PyTypeObject *type = Py_TYPE(object);
  release((Routine *)object);
  PyObject_Free(object);
  Py_DECREF(type);
}

static PyType_Slot routine_slots[] = {{Py_tp_dealloc, routine_free}, {0, NULL}};
static PyType_Spec routine_spec = {
    "fuzzyarm._kernels.Routine", sizeof(Routine), 0, Py_TPFLAGS_DEFAULT, routine_slots};

static const char *kind_of(char letter) {
  return letter == 'f' ? "float64" : letter == 'i' ? "int64" : "int32";
}

/* Whether the elements are what the kernel reads; the format says so in one letter. */
static int fits(const Py_buffer *buffer, char letter) {
  const char *format = buffer->format;
  if (buffer->itemsize != (letter == 's' ? 4 : 8) || format == NULL) return 0;
  if (*format == '<' || *format == '@' || *format == '=') format++;
  if (letter == 'f') return *format == 'd';
  return *format == 'i' || *format == 'l' || *format == 'q';
}

/* Take hold of an array; of one that is written it is demanded that this is allowed. */
static int take(PyObject *array, char letter, int written, Py_buffer *buffer) {
  if (PyObject_GetBuffer(array, buffer, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) < 0) {
    PyErr_Clear();
    PyErr_Format(PyExc_TypeError, "a contiguous array of %s is needed", kind_of(letter));
    return -1;
  }
  if (written && buffer->readonly) {
    PyErr_Format(PyExc_ValueError, "an array that is filled in is read-only");
    PyBuffer_Release(buffer);
    return -1;
  }
  if (!fits(buffer, letter)) {
    PyErr_Format(PyExc_TypeError, "a contiguous array of %s is needed, not one of format '%s'",
                 kind_of(letter), buffer->format ? buffer->format : "B");
    PyBuffer_Release(buffer);
    return -1;
  }
  return 0;
}

/* The row of an entry; NULL for an address that is in no table. */
static const table_row *row_of(unsigned long long address) {
  for (const table *part = tables; part->level != NULL; part++)
    for (const table_row *row = part->rows; row->key != NULL; row++)
      if (address_of(row) == address) return row;
  return NULL;
}

static void run_entry(const Routine *self, const Py_buffer *buffers) {
  void *at[MOST_ARRAYS];
  int64_t lengths[MOST_ARRAYS];
  for (int k = 0; k < self->count; k++) {
    at[k] = buffers[k].buf;
    lengths[k] = buffers[k].len / buffers[k].itemsize;
  }
  self->row->spread(at, lengths);
}

static int take_one(const Routine *self, int k, PyObject *array, Py_buffer *buffer) {
  return take(array, self->letters[k], self->row->filled >> k & 1, buffer);
}

static PyObject *routine_call(PyObject *object, PyObject *const *arrays, Py_ssize_t count) {
  Routine *self = (Routine *)object;
  Py_buffer buffers[MOST_ARRAYS];
  if (count != self->count)
    return PyErr_Format(PyExc_TypeError, "%d arrays are needed, not %zd", self->count, count);
  int taken = 0;
  while (taken < count && take_one(self, taken, arrays[taken], &buffers[taken]) == 0) taken++;
  if (taken == count) {
    Py_BEGIN_ALLOW_THREADS
    run_entry(self, buffers);
    Py_END_ALLOW_THREADS
  }
  for (int k = 0; k < taken; k++) PyBuffer_Release(&buffers[k]);
  if (taken < count) return NULL;
  Py_RETURN_NONE;
}

static PyObject *routine_again(PyObject *object, PyObject *unused) {
  (void)unused;
  Routine *self = (Routine *)object;
  if (self->brief) { /* to give the lock away would cost as much as the work */
    run_entry(self, self->buffers);
  } else {
    Py_BEGIN_ALLOW_THREADS
    run_entry(self, self->buffers);
    Py_END_ALLOW_THREADS
  }
  Py_RETURN_NONE;
}

static PyMethodDef call_method = {
    "routine", (PyCFunction)(void (*)(void))routine_call, METH_FASTCALL, "Run a kernel."};
static PyMethodDef again_method = {
    "bound", routine_again, METH_NOARGS, "Run a kernel on the arrays that it was bound to."};

static Routine *new_routine(unsigned long long address, const char *letters) {
  const size_t count = strlen(letters);
  const table_row *row = row_of(address);
  if (row == NULL || count > MOST_ARRAYS) {
    PyErr_Format(PyExc_ValueError, "no kernel of %zu arrays stands at this address", count);
    return NULL;
  }
  Routine *self = PyObject_New(Routine, routine_type);
  if (self == NULL) return NULL;
  self->row = row;
  self->count = (int)count;
  self->held = self->brief = 0;
  memcpy(self->letters, letters, count);
  return self;
}

static PyObject *routine(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long address;
  const char *letters;
  if (!PyArg_ParseTuple(arguments, "Ks", &address, &letters)) return NULL;
  Routine *self = new_routine(address, letters);
  if (self == NULL) return NULL;
  PyObject *function = PyCFunction_NewEx(&call_method, (PyObject *)self, NULL);
  Py_DECREF(self);
  return function;
}

static PyObject *bind(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long address;
  const char *letters;
  PyObject *arrays;
  int brief;
  if (!PyArg_ParseTuple(arguments, "KsO!p", &address, &letters, &PyTuple_Type, &arrays, &brief))
    return NULL;
  Routine *self = new_routine(address, letters);
  if (self == NULL) return NULL;
  self->brief = brief;
  if (PyTuple_Size(arrays) != self->count) {
    Py_DECREF(self);
    return PyErr_Format(PyExc_TypeError, "%zu arrays are needed", strlen(letters));
  }
  while (self->held < self->count) {
    PyObject *array = PyTuple_GetItem(arrays, self->held);
    if (take_one(self, self->held, array, &self->buffers[self->held]) < 0) {
      Py_DECREF(self);
      return NULL;
    }
    self->held++;
  }
  PyObject *function = PyCFunction_NewEx(&again_method, (PyObject *)self, NULL);
  Py_DECREF(self);
  return function;
}

/* --- Many points of a rule base --- */

enum { MOST_INPUTS = 64 };

/* A kernel on a block with room for a chunk of points: it is run chunk by chunk over arrays. */
typedef struct {
  PyObject_HEAD
  spread_entry spread;
  Py_buffer block;
  int held;
  Py_ssize_t chunk, width;              /* points of a chunk, and from one row to the next */
  Py_ssize_t inputs, outputs;           /* how many there are */
  double *columns, *results;            /* their rows in the block */
  int64_t *points, *missing;            /* how many points there are; outputs without a value */
} Sweep;

static PyTypeObject *sweep_type;

static void sweep_free(PyObject *object) {
  Sweep *self = (Sweep *)object;
  PyTypeObject *type = Py_TYPE(object);
  if (self->held) PyBuffer_Release(&self->block);
  PyObject_Free(object);
  Py_DECREF(type);
}

static PyType_Slot sweep_slots[] = {{Py_tp_dealloc, sweep_free}, {0, NULL}};
static PyType_Spec sweep_spec = {
    "fuzzyarm._kernels.Sweep", sizeof(Sweep), 0, Py_TPFLAGS_DEFAULT, sweep_slots};

/* Evaluate elements of arrays from `begin` on; return how many outputs have no value. */
static long long sweep_over(Sweep *self, const Py_buffer *arrays, Py_ssize_t begin, Py_ssize_t end) {
  void *at[1] = {self->block.buf};
  const int64_t lengths[1] = {self->block.len / self->block.itemsize};
  long long missing = 0;
  for (; begin < end; begin += self->chunk) {
    const Py_ssize_t left = end - begin, count = left < self->chunk ? left : self->chunk;
    const size_t bytes = (size_t)count * sizeof(double);
    for (Py_ssize_t i = 0; i < self->inputs; i++)
      memcpy(self->columns + i * self->width, (double *)arrays[i].buf + begin, bytes);
    *self->points = count;
    self->spread(at, lengths);
    for (Py_ssize_t o = 0; o < self->outputs; o++)
      memcpy((double *)arrays[self->inputs + o].buf + begin, self->results + o * self->width, bytes);
    missing += *self->missing;
  }
  return missing;
}

/* From the arrays of the inputs and those of the outputs, and the first and the last element. */
static PyObject *sweep_arrays(PyObject *object, PyObject *arguments) {
  Sweep *self = (Sweep *)object;
  PyObject *arrays;
  Py_ssize_t begin, end;
  Py_buffer buffers[2 * MOST_INPUTS];
  if (!PyArg_ParseTuple(arguments, "O!nn", &PyTuple_Type, &arrays, &begin, &end)) return NULL;
  const Py_ssize_t count = self->inputs + self->outputs;
  if (PyTuple_Size(arrays) != count)
    return PyErr_Format(PyExc_TypeError, "%zd arrays are needed", count);
  Py_ssize_t taken = 0;
  int fit = 1;
  while (fit && taken < count) {
    const int written = taken >= self->inputs;
    if (take(PyTuple_GetItem(arrays, taken), 'f', written, &buffers[taken]) < 0) break;
    fit = begin >= 0 && end <= buffers[taken].len / buffers[taken].itemsize;
    taken++;
  }
  long long missing = 0;
  if (fit && taken == count) {
    Py_BEGIN_ALLOW_THREADS
    missing = sweep_over(self, buffers, begin, end);
    Py_END_ALLOW_THREADS
  }
  for (Py_ssize_t k = 0; k < taken; k++) PyBuffer_Release(&buffers[k]);
  if (!fit) return PyErr_Format(PyExc_ValueError, "an array ends before element %zd", end);
  return taken < count ? NULL : PyLong_FromLongLong(missing);
}

static PyMethodDef sweep_method = {
    "sweep", sweep_arrays, METH_VARARGS, "Evaluate elements of arrays, chunk by chunk."};

/* Return what runs a kernel over arrays: its block, and where in that the parts are. */
static PyObject *sweeper(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long address;
  PyObject *block;
  Py_ssize_t chunk, width, inputs, outputs, columns, results, points, missing;
  if (!PyArg_ParseTuple(arguments, "KO(nn)(nn)(nn)(nn)", &address, &block, &chunk, &width, &inputs,
                        &columns, &outputs, &results, &points, &missing))
    return NULL;
  const table_row *row = row_of(address);
  if (row == NULL || chunk < 1 || width < chunk || inputs < 0 || inputs > MOST_INPUTS ||
      outputs < 0 || outputs > MOST_INPUTS)
    return PyErr_Format(PyExc_ValueError, "no kernel for points of %zd inputs", inputs);
  Sweep *self = PyObject_New(Sweep, sweep_type);
  if (self == NULL) return NULL;
  self->spread = row->spread;
  self->held = 0;
  PyObject *function = NULL;
  if (take(block, 'f', 1, &self->block) == 0) {
    self->held = 1;
    const Py_ssize_t length = self->block.len / self->block.itemsize;
    double *numbers = self->block.buf;
    if (columns < 0 || results < 0 || columns + inputs * width > length ||
        results + outputs * width > length || points < 0 || points >= length || missing < 0 ||
        missing >= length) {
      PyErr_Format(PyExc_ValueError, "inputs or outputs lie outside the block");
    } else {
      self->chunk = chunk;
      self->width = width;
      self->inputs = inputs;
      self->outputs = outputs;
      self->columns = numbers + columns;
      self->results = numbers + results;
      self->points = (int64_t *)numbers + points;
      self->missing = (int64_t *)numbers + missing;
      function = PyCFunction_NewEx(&sweep_method, (PyObject *)self, NULL);
    }
  }
  Py_DECREF(self);
  return function;
}

/* --- One point of a rule base --- */

/* A kernel on a block with the numbers of a rule base. It keeps the lock of the interpreter, so that
   one block serves all threads: to give the lock away would cost as much as the work. */
typedef struct {
  PyObject_HEAD
  spread_entry spread;
  Py_buffer block;
  int held;
  double *x, *y;                /* where inputs and outputs stand in the block */
  Py_ssize_t inputs, outputs;   /* how many there are */
  PyObject *input_names, *output_names, *at_otherwise, *call_otherwise;
} Point;

static PyTypeObject *point_type;

static void point_free(PyObject *object) {
  Point *self = (Point *)object;
  PyTypeObject *type = Py_TYPE(object);
  if (self->held) PyBuffer_Release(&self->block);
  Py_XDECREF(self->input_names);
  Py_XDECREF(self->output_names);
  Py_XDECREF(self->at_otherwise);
  Py_XDECREF(self->call_otherwise);
  PyObject_Free(object);
  Py_DECREF(type);
}

static PyType_Slot point_slots[] = {{Py_tp_dealloc, point_free}, {0, NULL}};
static PyType_Spec point_spec = {
    "fuzzyarm._kernels.Point", sizeof(Point), 0, Py_TPFLAGS_DEFAULT, point_slots};

/* Evaluate; whether every output has a value. */
static int point_evaluate(Point *self, const double *given) {
  memcpy(self->x, given, (size_t)self->inputs * sizeof(double));
  void *at[1] = {self->block.buf};
  const int64_t lengths[1] = {self->block.len / self->block.itemsize};
  self->spread(at, lengths);
  for (Py_ssize_t k = 0; k < self->outputs; k++)
    if (self->y[k] != self->y[k]) return 0;
  return 1;
}

/* Read a number as a float; -1 for anything else. */
static int read_number(PyObject *value, double *number) {
  *number = PyFloat_AsDouble(value);
  if (*number == -1.0 && PyErr_Occurred()) {
    PyErr_Clear();
    return -1;
  }
  return 0;
}

/* From inputs in their order to a tuple; what is not ordinary goes elsewhere. */
static PyObject *point_at(PyObject *object, PyObject *const *values, Py_ssize_t count) {
  Point *self = (Point *)object;
  double given[MOST_INPUTS];
  Py_ssize_t read = 0;
  if (count == self->inputs)
    while (read < count && read_number(values[read], &given[read]) == 0) read++;
  PyObject *tuple;
  if (read < self->inputs || read != count || !point_evaluate(self, given)) {
    if ((tuple = PyTuple_New(count)) == NULL) return NULL;
    for (Py_ssize_t k = 0; k < count; k++) {
      Py_INCREF(values[k]);
      PyTuple_SetItem(tuple, k, values[k]);
    }
    PyObject *result = PyObject_CallObject(self->at_otherwise, tuple);
    Py_DECREF(tuple);
    return result;
  }
  if ((tuple = PyTuple_New(self->outputs)) == NULL) return NULL;
  for (Py_ssize_t k = 0; k < self->outputs; k++) {
    PyObject *value = PyFloat_FromDouble(self->y[k]);
    if (value == NULL) {
      Py_DECREF(tuple);
      return NULL;
    }
    PyTuple_SetItem(tuple, k, value);
  }
  return tuple;
}

/* From a dictionary, or a tuple in the order of the inputs, to a dictionary; None for what is not
   ordinary. */
static PyObject *point_named(PyObject *object, PyObject *values) {
  Point *self = (Point *)object;
  double given[MOST_INPUTS];
  const int by_name = PyDict_Check(values);
  if (!by_name && !PyTuple_Check(values)) Py_RETURN_NONE;
  if ((by_name ? PyDict_Size(values) : PyTuple_Size(values)) != self->inputs) Py_RETURN_NONE;
  for (Py_ssize_t k = 0; k < self->inputs; k++) {
    PyObject *value = by_name
        ? PyDict_GetItemWithError(values, PyTuple_GetItem(self->input_names, k))
        : PyTuple_GetItem(values, k);
    if (value == NULL && PyErr_Occurred()) return NULL;
    if (value == NULL || !(PyFloat_Check(value) || PyLong_Check(value))) Py_RETURN_NONE;
    if (read_number(value, &given[k]) < 0) Py_RETURN_NONE;
  }
  if (!point_evaluate(self, given)) Py_RETURN_NONE;
  PyObject *result = PyDict_New();
  for (Py_ssize_t k = 0; result != NULL && k < self->outputs; k++) {
    PyObject *value = PyFloat_FromDouble(self->y[k]);
    PyObject *name = PyTuple_GetItem(self->output_names, k);
    if (value == NULL || PyDict_SetItem(result, name, value) < 0) Py_CLEAR(result);
    Py_XDECREF(value);
  }
  return result;
}

/* From arguments, by name or in their order, to a dictionary; what is not ordinary goes elsewhere. */
static PyObject *point_call(PyObject *object, PyObject *values, PyObject *named) {
  const int by_name = named != NULL && PyDict_Size(named) > 0;
  if (!by_name || PyTuple_Size(values) == 0) {
    PyObject *found = point_named(object, by_name ? named : values);
    if (found != Py_None) return found;
    Py_DECREF(found);
  }
  return PyObject_Call(((Point *)object)->call_otherwise, values, named);
}

static PyMethodDef at_method = {
    "at", (PyCFunction)(void (*)(void))point_at, METH_FASTCALL, "Evaluate inputs in their order."};
static PyMethodDef named_method = {
    "named", point_named, METH_O, "Evaluate inputs by name; None for what is not ordinary."};
static PyMethodDef point_call_method = {
    "call", (PyCFunction)(void (*)(void))point_call, METH_VARARGS | METH_KEYWORDS,
    "Evaluate inputs by name or in their order."};

/* Return the three functions of a kernel on a block. */
static PyObject *point(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long address;
  PyObject *block, *input_names, *output_names, *at_otherwise, *call_otherwise;
  Py_ssize_t x, y;
  if (!PyArg_ParseTuple(arguments, "KOnO!nO!OO", &address, &block, &x, &PyTuple_Type, &input_names,
                        &y, &PyTuple_Type, &output_names, &at_otherwise, &call_otherwise))
    return NULL;
  const table_row *row = row_of(address);
  const Py_ssize_t inputs = PyTuple_Size(input_names), outputs = PyTuple_Size(output_names);
  if (row == NULL || inputs > MOST_INPUTS)
    return PyErr_Format(PyExc_ValueError, "no kernel for a point of %zd inputs", inputs);
  Point *self = PyObject_New(Point, point_type);
  if (self == NULL) return NULL;
  self->spread = row->spread;
  self->inputs = inputs;
  self->outputs = outputs;
  self->held = 0;
  Py_INCREF(self->input_names = input_names);
  Py_INCREF(self->output_names = output_names);
  Py_INCREF(self->at_otherwise = at_otherwise);
  Py_INCREF(self->call_otherwise = call_otherwise);
  PyObject *functions = NULL;
  if (take(block, 'f', 1, &self->block) == 0) {
    self->held = 1;
    const Py_ssize_t length = self->block.len / self->block.itemsize;
    if (x < 0 || y < 0 || x + inputs > length || y + outputs > length) {
      PyErr_Format(PyExc_ValueError, "inputs or outputs lie outside the block");
    } else {
      self->x = (double *)self->block.buf + x;
      self->y = (double *)self->block.buf + y;
      PyObject *at = PyCFunction_NewEx(&at_method, (PyObject *)self, NULL);
      PyObject *named = PyCFunction_NewEx(&named_method, (PyObject *)self, NULL);
      PyObject *call = PyCFunction_NewEx(&point_call_method, (PyObject *)self, NULL);
      if (at != NULL && named != NULL && call != NULL)
        functions = PyTuple_Pack(3, at, named, call);
      Py_XDECREF(at);
      Py_XDECREF(named);
      Py_XDECREF(call);
    }
  }
  Py_DECREF(self);
  return functions;
}

/* Whether arrays are as long as a program of operations reads and fills them, see
   fuzzyarm/symbolic/programs.py; with rows it has one array of numbers, without them any. */
static int are_long_enough(int64_t address, const fuzzyarm_reals *arrays, Py_ssize_t count) {
  const double *program = (const double *)(uintptr_t)(address - 1);
  const Py_ssize_t rows = (Py_ssize_t)program[0];
  const int64_t filled = arrays[count - 1].length;
  int64_t numbers = 0;
  if (rows > 0 && count != rows + 2) return 0;
  for (Py_ssize_t k = 0; k < rows; k++)
    if (arrays[k].length < filled) return 0;
  for (Py_ssize_t k = rows; k < count - 1; k++) numbers += arrays[k].length;
  return numbers == (int64_t)program[1] && (rows > 0 || filled >= (int64_t)program[4]);
}

/* Run a program of operations by itself, as kernels call it: rows, numbers, and what is filled. */
static PyObject *walk(PyObject *module, PyObject *arguments) {
  (void)module;
  unsigned long long address;
  PyObject *arrays;
  if (!PyArg_ParseTuple(arguments, "KO!", &address, &PyTuple_Type, &arrays)) return NULL;
  Py_buffer buffers[MOST_ARRAYS];
  fuzzyarm_reals given[MOST_ARRAYS];
  const Py_ssize_t count = PyTuple_Size(arrays);
  if (address % 2 == 0 || count < 2 || count > MOST_ARRAYS)
    return PyErr_Format(PyExc_ValueError, "not a program of operations");
  int taken = 0;
  while (taken < count &&
         take(PyTuple_GetItem(arrays, taken), 'f', taken == count - 1, &buffers[taken]) == 0) {
    given[taken].at = buffers[taken].buf;
    given[taken].length = buffers[taken].len / buffers[taken].itemsize;
    taken++;
  }
  const int fit = taken == count && are_long_enough((int64_t)address, given, count);
  if (fit) baseline_rows_program((int64_t)address, given, (int)count);
  for (int k = 0; k < taken; k++) PyBuffer_Release(&buffers[k]);
  if (fit) Py_RETURN_NONE;
  if (taken < count) return NULL;
  return PyErr_Format(PyExc_ValueError, "the arrays of a program of operations do not fit it");
}

static PyMethodDef methods[] = {
    {"levels", levels, METH_NOARGS, "Return the levels that this processor runs, the best first."},
    {"addresses", addresses, METH_O, "Return the address of each entry of a level, by its key."},
    {"routine", routine, METH_VARARGS, "Return a function of arrays that runs an entry."},
    {"bind", bind, METH_VARARGS, "Return a function that runs an entry on the same arrays."},
    {"point", point, METH_VARARGS, "Return what evaluates one point, by position and by name."},
    {"sweeper", sweeper, METH_VARARGS, "Return what evaluates arrays of points."},
    {"walk", walk, METH_VARARGS, "Run a program of operations on arrays."},
    {NULL, NULL, 0, NULL}};

static int execute(PyObject *module) {
  routine_type = (PyTypeObject *)PyType_FromSpec(&routine_spec);
  point_type = (PyTypeObject *)PyType_FromSpec(&point_spec);
  sweep_type = (PyTypeObject *)PyType_FromSpec(&sweep_spec);
  if (routine_type == NULL || point_type == NULL || sweep_type == NULL) return -1;
  return PyModule_AddStringConstant(module, "SOURCES", fuzzyarm_sources);
}

static PyModuleDef_Slot slots[] = {{Py_mod_exec, execute}, {0, NULL}};
static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "_kernels", "Kernels as machine code.", 0, methods, slots, NULL, NULL,
    NULL};

PyMODINIT_FUNC PyInit__kernels(void) { return PyModuleDef_Init(&definition); }
