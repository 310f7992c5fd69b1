"""The C of a co-simulation unit: the functions of FMI 2.0 and FMI 3.0.

The common part of both versions is `_COMMON`; each adds its own names and arguments. A function
without use for a unit is a stub that returns an error for a call with arguments: hosts look every
name up when they load a unit.

References: Functional Mock-up Interface 2.0.4 (2022) and 3.0.1 (2023), modelica.org.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from fuzzyarm.exchange.export.document import Blocks, filled, filled_text

OK, ERROR = 0, 3
"""Of the status that every function returns."""

# The token is the GUID of FMI 2 and the instantiation token of FMI 3: a host that passes another
# one has read the description of another build, and gets no instance.
_COMMON = """
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct { /* an instance */
    <members>
    double start; /* of the simulation, s */
    unsigned long steps; /* that were made */
} unit;

static const char token[] = "<token>";

static void begin(unit *u)
{
    memset(u, 0, sizeof *u);
    <begin>
}

static unit *instantiate(const char *given)
{
    unit *u = NULL;
    if (given != NULL && strcmp(given, token) == 0) {
        u = malloc(sizeof *u);
    }
    if (u != NULL) {
        begin(u);
    }
    return u;
}

/* The number of a value reference; NULL where there is none. */
static double *number(unit *u, unsigned reference)
{
    switch (reference) {
    <cases>
    default: return NULL;
    }
}

/* What an instance shows, brought up to date before it is read. */
static void refresh(unit *u)
{
    <refresh>
}

static int get_numbers(unit *u, const unsigned *references, size_t count, double *values)
{
    size_t k;
    refresh(u);
    for (k = 0; k < count; k++) {
        const double *found = number(u, references[k]);
        if (found != NULL) {
            values[k] = *found;
        } else if (references[k] == <time>) {
            values[k] = <now>;
        } else {
            return 3;
        }
    }
    return 0;
}

static int set_numbers(unit *u, const unsigned *references, size_t count, const double *values)
{
    size_t k;
    for (k = 0; k < count; k++) {
        double *found = references[k] < <settable> ? number(u, references[k]) : NULL;
        if (found == NULL) {
            return 3;
        }
        *found = values[k];
    }
    return 0;
}

/* Go on to the end of a step of the host. */
static void advance(unit *u, double end)
{
    <advance>
}

static void *copied(const void *from)
{
    void *to = malloc(sizeof(unit));
    if (to != NULL) {
        memcpy(to, from, sizeof(unit));
    }
    return to;
}
"""

# Functions in short: a name, the parameters after the instance, the statements; see `_in_full`.
# A saved state is a copy of the bytes of an instance, which is sound because `unit` holds no
# pointers. A state that a host passes to Get…State was returned before, so it is freed first.
_STATES = """
GetFMU<State>(void **state)
    free(*state);
    *state = copied(instance);
    return *state != NULL ? 0 : 3;
SetFMU<State>(void *state)
    memcpy(instance, state, sizeof(unit));
    return 0;
FreeFMU<State>(void **state)
    free(*state);
    *state = NULL;
    return 0;
SerializedFMU<State>Size(void *state, size_t *size)
    *size = sizeof(unit);
    return 0;
SerializeFMU<State>(void *state, <byte> bytes[], size_t size)
    if (size < sizeof(unit)) {
        return 3;
    }
    memcpy(bytes, state, sizeof(unit));
    return 0;
<Read>FMU<State>(const <byte> bytes[], size_t size,<break>void **state)
    if (size != sizeof(unit)) {
        return 3;
    }
    *state = copied(bytes);
    return *state != NULL ? 0 : 3;
"""

_FMI2 = """
EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
    const void *callbacks, int visible, int logging)
{
    (void)name, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return type == 1 ? instantiate(guid) : NULL; /* co-simulation */
}

EXPORT void fmi2FreeInstance(void *instance)
{
    free(instance);
}
SetDebugLogging(int on, size_t n, const char *const categories[])
    return 0;
SetupExperiment(int has_tolerance, double tolerance, double start,
    int has_end, double end)
    ((unit *)instance)->start = start;
    return 0;
EnterInitializationMode()
    return 0;
ExitInitializationMode()
    return 0;
Terminate()
    return 0;
Reset()
    begin(instance);
    return 0;
GetReal(const unsigned vr[], size_t n, double values[])
    return get_numbers(instance, vr, n, values);
SetReal(const unsigned vr[], size_t n, const double values[])
    return set_numbers(instance, vr, n, values);
DoStep(double now, double size, int keeps_state)
    advance(instance, now + size);
    return 0;
<states>
"""

_FMI3 = """
EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}
SetDebugLogging(bool on, size_t n, const char *const categories[])
    return 0;

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *given,
    const char *resources, bool visible, bool logging, bool events, bool early,
    const unsigned required[], size_t n, void *environment, callback message, callback update)
{
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early;
    (void)required, (void)n, (void)environment, (void)message, (void)update;
    return instantiate(given);
}

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *given,
    const char *resources, bool visible, bool logging, void *environment, callback message)
{
    (void)name, (void)given, (void)resources, (void)visible, (void)logging;
    (void)environment, (void)message;
    return NULL;
}

EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *given,
    const char *resources, bool visible, bool logging, void *environment, callback message,
    callback update, callback lock, callback unlock)
{
    (void)name, (void)given, (void)resources, (void)visible, (void)logging;
    (void)environment, (void)message, (void)update, (void)lock, (void)unlock;
    return NULL;
}

EXPORT void fmi3FreeInstance(void *instance)
{
    free(instance);
}
EnterInitializationMode(bool has_tolerance, double tolerance,
    double start, bool has_end, double end)
    ((unit *)instance)->start = start;
    return 0;
ExitInitializationMode()
    return 0;
EnterStepMode()
    return 0;
Terminate()
    return 0;
Reset()
    begin(instance);
    return 0;
GetFloat64(const unsigned vr[], size_t n, double values[], size_t m)
    return n == m ? get_numbers(instance, vr, n, values) : 3;
SetFloat64(const unsigned vr[], size_t n, const double values[],
    size_t m)
    return n == m ? set_numbers(instance, vr, n, values) : 3;
DoStep(double now, double size, bool keeps_state,
    bool *event, bool *terminate, bool *early, double *last)
    advance(instance, now + size);
    *event = *terminate = *early = false;
    *last = now + size;
    return 0;
<states>
GetNumberOfEventIndicators(size_t *n)
    *n = 0;
    return 0;
GetNumberOfContinuousStates(size_t *n)
    *n = 0;
    return 0;
GetNumberOfVariableDependencies(unsigned vr, size_t *n)
    *n = 0;
    return 0;
"""

# Parameters that many stubs share. A stub reads none of its arguments but the count `n`.
_MANY = "const unsigned vr[], size_t n"
_SEED = "const unsigned unknown[], size_t n, const unsigned known[], size_t m, const double seed[]"

# A Boolean is an int in FMI 2 and C's bool in FMI 3.
_STUBS2: tuple[tuple[str, str], ...] = (
    *((f"Get{kind}", f"{_MANY}, {c} values[]") for kind, c in (
        ("Integer", "int"), ("Boolean", "int"), ("String", "const char *"))),
    *((f"Set{kind}", f"{_MANY}, const {c} values[]") for kind, c in (
        ("Integer", "int"), ("Boolean", "int"), ("String", "char *const"))),
    ("GetDirectionalDerivative", f"{_SEED}, double values[]"),
    ("SetRealInputDerivatives", f"{_MANY}, const int order[], const double values[]"),
    ("GetRealOutputDerivatives", f"{_MANY}, const int order[], double values[]"),
    ("CancelStep", ""),
    ("GetStatus", "int kind, int *value"),
    ("GetRealStatus", "int kind, double *value"),
    ("GetIntegerStatus", "int kind, int *value"),
    ("GetBooleanStatus", "int kind, int *value"),
    ("GetStringStatus", "int kind, const char **value"),
    ("EnterEventMode", ""),
    ("NewDiscreteStates", "void *info"),
    ("EnterContinuousTimeMode", ""),
    ("CompletedIntegratorStep", "int keeps_state, int *event, int *terminate"),
    ("SetTime", "double time"),
    ("SetContinuousStates", "const double x[], size_t n"),
    *((f"Get{name}", "double x[], size_t n") for name in (
        "Derivatives", "EventIndicators", "ContinuousStates", "NominalsOfContinuousStates")),
)  # fmt: skip

_NUMBERS3 = (
    ("Float32", "float"), ("Int8", "signed char"), ("UInt8", "unsigned char"),
    ("Int16", "int16_t"), ("UInt16", "uint16_t"), ("Int32", "int32_t"), ("UInt32", "uint32_t"),
    ("Int64", "int64_t"), ("UInt64", "uint64_t"), ("Boolean", "bool"),
)  # fmt: skip

_STUBS3: tuple[tuple[str, str], ...] = (
    *((f"Get{kind}", f"{_MANY}, {c} values[], size_t m") for kind, c in _NUMBERS3),
    *((f"Set{kind}", f"{_MANY}, const {c} values[], size_t m") for kind, c in _NUMBERS3),
    ("GetString", f"{_MANY}, const char *values[], size_t m"),
    ("SetString", f"{_MANY}, const char *const values[], size_t m"),
    ("GetBinary", f"{_MANY}, size_t sizes[], const unsigned char *values[], size_t m"),
    ("SetBinary", f"{_MANY}, const size_t sizes[], const unsigned char *const values[], size_t m"),
    ("GetClock", f"{_MANY}, bool values[]"),
    ("SetClock", f"{_MANY}, const bool values[]"),
    ("GetVariableDependencies", "unsigned dependent, size_t elements[], unsigned independents[],"
     " size_t others[], int kinds[], size_t n"),
    ("GetDirectionalDerivative", f"{_SEED}, size_t k, double values[], size_t j"),
    ("GetAdjointDerivative", f"{_SEED}, size_t k, double values[], size_t j"),
    ("EnterEventMode", ""),
    ("EnterConfigurationMode", ""),
    ("ExitConfigurationMode", ""),
    ("GetIntervalDecimal", f"{_MANY}, double intervals[], int qualifiers[]"),
    ("GetIntervalFraction", f"{_MANY}, uint64_t counters[], uint64_t resolutions[],"
     " int qualifiers[]"),
    ("GetShiftDecimal", f"{_MANY}, double shifts[]"),
    ("GetShiftFraction", f"{_MANY}, uint64_t counters[], uint64_t resolutions[]"),
    ("SetIntervalDecimal", f"{_MANY}, const double intervals[]"),
    ("SetIntervalFraction", f"{_MANY}, const uint64_t counters[], const uint64_t resolutions[]"),
    ("SetShiftDecimal", f"{_MANY}, const double shifts[]"),
    ("SetShiftFraction", f"{_MANY}, const uint64_t counters[], const uint64_t resolutions[]"),
    ("EvaluateDiscreteStates", ""),
    ("UpdateDiscreteStates", "bool *update, bool *terminate, bool *nominals, bool *values,"
     " bool *has_next, double *next"),
    ("EnterContinuousTimeMode", ""),
    ("CompletedIntegratorStep", "bool keeps_state, bool *event, bool *terminate"),
    ("SetTime", "double time"),
    ("SetContinuousStates", "const double x[], size_t n"),
    *((f"Get{name}", "double x[], size_t n") for name in (
        "ContinuousStateDerivatives", "EventIndicators", "ContinuousStates",
        "NominalsOfContinuousStates")),
    ("GetOutputDerivatives", f"{_MANY}, const int32_t orders[], double values[], size_t m"),
    ("ActivateModelPartition", "unsigned clock, double time"),
)  # fmt: skip


def _function(version: int, name: str, parameters: str, body: str, read: str) -> str:
    """Return a function of an instance; parameters that `read` lacks are unused."""
    listed = f"void *instance, {parameters}" if parameters else "void *instance"
    names = [part.replace("[]", "").replace("*", " ").split()[-1] for part in listed.split(",")]
    unused = [f"(void){each}" for each in names if not re.search(rf"\b{each}\b", read)]
    first = f"    {', '.join(unused)};\n" if unused else ""
    return f"EXPORT int fmi{version}{name}({listed})\n{{\n{first}{body}}}\n"


def _in_full(version: int, text: str) -> str:
    """Return a text of C with its functions in short written out."""
    words = {
        2: {"State": "state", "byte": "char", "Read": "DeSerialize", "break": " "},
        3: {"State": "State", "byte": "unsigned char", "Read": "Deserialize", "break": "\n    "},
    }
    states = list(filled(_STATES, words[version]))
    return "\n" + re.sub(
        r"^(\w+)\(([^)]*)\)\n((?: .*\n)+)",
        lambda short: "\n" + _function(version, short[1], short[2], short[3], read=short[3]),
        filled_text(text, {"states": states}),
        flags=re.MULTILINE,
    )


def _stub(version: int, name: str, parameters: str) -> str:
    # A call for no value is not a mistake.
    result = f"n == 0 ? {OK} : {ERROR}" if "size_t n" in parameters else str(ERROR)
    return _function(version, name, parameters, f"    return {result};\n", read="")


@dataclass(frozen=True, slots=True)
class UnitC:
    """The parts specific to a unit, as C about an instance ``u``."""

    members: tuple[str, ...]  # declarations of an instance, which is zeroed before it begins
    begin: tuple[str, ...]  # statements for a new instance
    refresh: tuple[str, ...]  # statements before numbers are read
    advance: tuple[str, ...]  # statements that advance to the time ``end``
    now: str  # the time, as an expression
    places: tuple[str, ...]  # members of the struct, by value reference
    settable: int  # so many of them, the first ones, may be set


def fmi_source(version: int, token: str, unit: UnitC) -> str:
    """Return the C of a unit, to follow the functions that it calls.

    `token` is its name in the description.
    """
    cases = [f"case {number}u: return &{place};" for number, place in enumerate(unit.places)]
    words: Blocks = {
        "members": unit.members,
        "token": token,
        "begin": unit.begin,
        "cases": cases,
        "refresh": unit.refresh or ("(void)u;",),
        # The time, the independent variable, has the last reference.
        "time": f"{len(unit.places)}u",
        "now": unit.now,
        "settable": f"{unit.settable}u",
        "advance": unit.advance,
    }
    text = filled_text(_COMMON, words)
    functions = _in_full(version, _FMI2 if version == 2 else _FMI3)
    return "\n".join([*_head(version), text + functions, *_stubs(version)])


def _head(version: int) -> Iterator[str]:
    if version == 3:
        yield "#include <stdbool.h>"
        yield "#include <stdint.h>\n"
        yield "typedef void (*callback)(void);\n"


def _stubs(version: int) -> Iterator[str]:
    for name, parameters in _STUBS2 if version == 2 else _STUBS3:
        yield _stub(version, name, parameters)
