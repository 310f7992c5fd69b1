/* A lag of first order, T x' = K u - x, y = x: the smallest unit that has everything a plant needs.
   In co-simulation it takes Euler steps of 1/8 of the communication step. */
#include <stdlib.h>

typedef struct { double time, u, x, gain, constant; } Unit;

static double slope(const Unit *unit) { return (unit->gain * unit->u - unit->x) / unit->constant; }

static double *cell(Unit *unit, unsigned reference)
{
    switch (reference) {
    case 1: return &unit->u;
    case 2: return &unit->x;
    case 3: return &unit->gain;
    default: return &unit->constant;
    }
}

static Unit *new_unit(void)
{
    Unit *unit = calloc(1, sizeof *unit);
    unit->gain = 2.0;
    unit->constant = 0.5;
    return unit;
}

static void advance(Unit *unit, double step)
{
    for (int i = 0; i < 8; i++)
        unit->x += slope(unit) * step / 8;
}

#if FMI == 2
#include "fmi2Functions.h"
#define OK return fmi2OK;
#define C fmi2Component c
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Component fmi2Instantiate(fmi2String n, fmi2Type t, fmi2String g, fmi2String r, const fmi2CallbackFunctions *f, fmi2Boolean v, fmi2Boolean l) { return new_unit(); }
void fmi2FreeInstance(C) { free(c); }
fmi2Status fmi2SetDebugLogging(C, fmi2Boolean l, size_t n, const fmi2String s[]) { OK }
fmi2Status fmi2SetupExperiment(C, fmi2Boolean d, fmi2Real e, fmi2Real s, fmi2Boolean k, fmi2Real p) { OK }
fmi2Status fmi2EnterInitializationMode(C) { OK }
fmi2Status fmi2ExitInitializationMode(C) { OK }
fmi2Status fmi2Terminate(C) { OK }
fmi2Status fmi2Reset(C) { OK }
fmi2Status fmi2GetReal(C, const fmi2ValueReference r[], size_t n, fmi2Real v[]) { for (size_t i = 0; i < n; i++) v[i] = *cell(c, r[i]); OK }
fmi2Status fmi2SetReal(C, const fmi2ValueReference r[], size_t n, const fmi2Real v[]) { for (size_t i = 0; i < n; i++) *cell(c, r[i]) = v[i]; OK }
#define NONE(name, type) \
    fmi2Status fmi2Get##name(C, const fmi2ValueReference r[], size_t n, type v[]) { return n ? fmi2Error : fmi2OK; } \
    fmi2Status fmi2Set##name(C, const fmi2ValueReference r[], size_t n, const type v[]) { return n ? fmi2Error : fmi2OK; }
NONE(Integer, fmi2Integer) NONE(Boolean, fmi2Boolean) NONE(String, fmi2String)
fmi2Status fmi2DoStep(C, fmi2Real t, fmi2Real h, fmi2Boolean k) { advance(c, h); OK }
fmi2Status fmi2SetTime(C, fmi2Real t) { ((Unit *)c)->time = t; OK }
fmi2Status fmi2EnterEventMode(C) { OK }
fmi2Status fmi2NewDiscreteStates(C, fmi2EventInfo *e) { e->newDiscreteStatesNeeded = fmi2False; e->terminateSimulation = fmi2False; e->nominalsOfContinuousStatesChanged = fmi2False; e->valuesOfContinuousStatesChanged = fmi2False; e->nextEventTimeDefined = fmi2False; OK }
fmi2Status fmi2EnterContinuousTimeMode(C) { OK }
fmi2Status fmi2CompletedIntegratorStep(C, fmi2Boolean k, fmi2Boolean *e, fmi2Boolean *t) { *e = *t = fmi2False; OK }
fmi2Status fmi2SetContinuousStates(C, const fmi2Real x[], size_t n) { ((Unit *)c)->x = x[0]; OK }
fmi2Status fmi2GetContinuousStates(C, fmi2Real x[], size_t n) { x[0] = ((Unit *)c)->x; OK }
fmi2Status fmi2GetNominalsOfContinuousStates(C, fmi2Real x[], size_t n) { x[0] = 1.0; OK }
fmi2Status fmi2GetDerivatives(C, fmi2Real d[], size_t n) { d[0] = slope(c); OK }
fmi2Status fmi2GetEventIndicators(C, fmi2Real e[], size_t n) { OK }
#else
#include "fmi3Functions.h"
#define OK return fmi3OK;
#define C fmi3Instance c
const char *fmi3GetVersion(void) { return fmi3Version; }
fmi3Instance fmi3InstantiateCoSimulation(fmi3String n, fmi3String k, fmi3String p, fmi3Boolean v, fmi3Boolean l, fmi3Boolean e, fmi3Boolean r, const fmi3ValueReference q[], size_t m, fmi3InstanceEnvironment i, fmi3LogMessageCallback g, fmi3IntermediateUpdateCallback u) { return new_unit(); }
fmi3Instance fmi3InstantiateModelExchange(fmi3String n, fmi3String k, fmi3String p, fmi3Boolean v, fmi3Boolean l, fmi3InstanceEnvironment i, fmi3LogMessageCallback g) { return new_unit(); }
void fmi3FreeInstance(C) { free(c); }
fmi3Status fmi3EnterInitializationMode(C, fmi3Boolean d, fmi3Float64 e, fmi3Float64 s, fmi3Boolean k, fmi3Float64 p) { OK }
fmi3Status fmi3ExitInitializationMode(C) { OK }
fmi3Status fmi3Terminate(C) { OK }
fmi3Status fmi3Reset(C) { OK }
fmi3Status fmi3GetFloat64(C, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m) { for (size_t i = 0; i < n; i++) v[i] = *cell(c, r[i]); OK }
fmi3Status fmi3SetFloat64(C, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m) { for (size_t i = 0; i < n; i++) *cell(c, r[i]) = v[i]; OK }
/* It says that it is over once its output has passed 1.9. */
fmi3Status fmi3DoStep(C, fmi3Float64 t, fmi3Float64 h, fmi3Boolean k, fmi3Boolean *e, fmi3Boolean *over, fmi3Boolean *r, fmi3Float64 *last) { advance(c, h); *e = *r = fmi3False; *over = ((Unit *)c)->x > 1.9; *last = t + h; OK }
fmi3Status fmi3SetTime(C, fmi3Float64 t) { ((Unit *)c)->time = t; OK }
fmi3Status fmi3UpdateDiscreteStates(C, fmi3Boolean *a, fmi3Boolean *b, fmi3Boolean *d, fmi3Boolean *e, fmi3Boolean *f, fmi3Float64 *g) { *a = *b = *d = *e = *f = fmi3False; OK }
fmi3Status fmi3EnterContinuousTimeMode(C) { OK }
fmi3Status fmi3SetContinuousStates(C, const fmi3Float64 x[], size_t n) { ((Unit *)c)->x = x[0]; OK }
fmi3Status fmi3GetContinuousStates(C, fmi3Float64 x[], size_t n) { x[0] = ((Unit *)c)->x; OK }
fmi3Status fmi3GetContinuousStateDerivatives(C, fmi3Float64 d[], size_t n) { d[0] = slope(c); OK }
#endif
