/* FMI 3.0: co-simulation and model exchange.  The declarations are those of the standard (Modelica Association, FMI 3.0.2). */
#include <stdbool.h>
#include <stdint.h>
#include "component.h"

typedef void *Instance;
typedef int Status;
typedef const char *String;
typedef uint32_t Reference;
typedef void (*Logger)(void *environment, Status status, String category, String message);

#if defined FMI3_FUNCTION_PREFIX /* for static linking: the model's identifier and _ */
#define NAME(name) JOIN_VALUES(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define NAME(name) fmi3##name
#endif
#define FUNCTION(name) EXPORT Status NAME(name)

static void say(const Component *c, int status, const char *message)
{
    if (c->logger)
        ((Logger)c->logger)(c->environment, status, status == WARNING ? "logStatusWarning" : "logStatusError", message);
}

EXPORT String NAME(GetVersion)(void) { return "3.0"; }
EXPORT Instance NAME(InstantiateModelExchange)(String name, String token, String resources, bool visible, bool logging, void *environment,
                                               Logger logger)
    ANSWERS(create(name, token, (void (*)(void))logger, environment))
EXPORT Instance NAME(InstantiateCoSimulation)(String name, String token, String resources, bool visible, bool logging, bool events, bool returns,
                                              const Reference needed[], size_t count, void *environment, Logger logger, void *update)
    ANSWERS(create(name, token, (void (*)(void))logger, environment))
EXPORT Instance NAME(InstantiateScheduledExecution)(String name, String token, String resources, bool visible, bool logging, void *environment,
                                                    Logger logger, void *update, void *lock, void *unlock)
    ANSWERS(NULL)
EXPORT void NAME(FreeInstance)(Instance c) { destroy(c); }
FUNCTION(SetDebugLogging)(Instance c, bool on, size_t count, const String categories[]) ANSWERS(OK)
FUNCTION(EnterInitializationMode)(Instance c, bool known, double tolerance, double first, bool ends, double last) ANSWERS(set_time(c, first))
FUNCTION(ExitInitializationMode)(Instance c) ANSWERS(OK)
FUNCTION(EnterEventMode)(Instance c) ANSWERS(OK)
FUNCTION(EnterConfigurationMode)(Instance c) ANSWERS(OK)
FUNCTION(ExitConfigurationMode)(Instance c) ANSWERS(OK)
FUNCTION(Terminate)(Instance c) ANSWERS(OK)
FUNCTION(Reset)(Instance c) ANSWERS(reset(c))

FUNCTION(GetFloat64)(Instance c, const Reference r[], size_t n, double v[], size_t count) ANSWERS(get_many(c, r, n, v))
FUNCTION(SetFloat64)(Instance c, const Reference r[], size_t n, const double v[], size_t count) ANSWERS(set_many(c, r, n, v))
FUNCTION(GetBoolean)(Instance c, const Reference r[], size_t n, bool v[], size_t count)
{
    int in_range = 0, status = n == 1 ? get_in_range(c, r[0], &in_range) : ERROR;
    if (status == OK)
        v[0] = in_range;
    return n ? status : OK;
}
FUNCTION(SetBoolean)(Instance c, const Reference r[], size_t n, const bool v[], size_t count) HAS_NONE(n)
#define NO_VARIABLES(type, name)                                                                                    \
    FUNCTION(Get##name)(Instance c, const Reference r[], size_t n, type v[], size_t count) HAS_NONE(n)              \
    FUNCTION(Set##name)(Instance c, const Reference r[], size_t n, const type v[], size_t count) HAS_NONE(n)
NO_VARIABLES(float, Float32)
NO_VARIABLES(int8_t, Int8)
NO_VARIABLES(uint8_t, UInt8)
NO_VARIABLES(int16_t, Int16)
NO_VARIABLES(uint16_t, UInt16)
NO_VARIABLES(int32_t, Int32)
NO_VARIABLES(uint32_t, UInt32)
NO_VARIABLES(int64_t, Int64)
NO_VARIABLES(uint64_t, UInt64)
NO_VARIABLES(String, String)
FUNCTION(GetBinary)(Instance c, const Reference r[], size_t n, size_t sizes[], const uint8_t *v[], size_t count) HAS_NONE(n)
FUNCTION(SetBinary)(Instance c, const Reference r[], size_t n, const size_t sizes[], const uint8_t *const v[], size_t count) HAS_NONE(n)
FUNCTION(GetClock)(Instance c, const Reference r[], size_t n, bool v[]) HAS_NONE(n)
FUNCTION(SetClock)(Instance c, const Reference r[], size_t n, const bool v[]) HAS_NONE(n)
FUNCTION(GetNumberOfVariableDependencies)(Instance c, Reference r, size_t *n) ANSWERS(ERROR)
FUNCTION(GetVariableDependencies)(Instance c, Reference r, size_t a[], Reference b[], size_t d[], int k[], size_t n) ANSWERS(ERROR)

FUNCTION(GetFMUState)(Instance c, void **state) ANSWERS(save_state(c, state))
FUNCTION(SetFMUState)(Instance c, void *state) ANSWERS(restore_state(c, state))
FUNCTION(FreeFMUState)(Instance c, void **state) ANSWERS(release_state(state))
FUNCTION(SerializedFMUStateSize)(Instance c, void *state, size_t *size) ANSWERS(ERROR)
FUNCTION(SerializeFMUState)(Instance c, void *state, uint8_t bytes[], size_t size) ANSWERS(ERROR)
FUNCTION(DeserializeFMUState)(Instance c, const uint8_t bytes[], size_t size, void **state) ANSWERS(ERROR)
FUNCTION(GetDirectionalDerivative)(Instance c, const Reference u[], size_t nu, const Reference k[], size_t nk, const double seed[], size_t seeds,
                                   double change[], size_t changes) ANSWERS(differential(c, u, nu, k, nk, seed, change))
FUNCTION(GetAdjointDerivative)(Instance c, const Reference u[], size_t nu, const Reference k[], size_t nk, const double seed[], size_t seeds,
                               double change[], size_t changes) ANSWERS(ERROR)

FUNCTION(GetIntervalDecimal)(Instance c, const Reference r[], size_t n, double v[], int q[]) HAS_NONE(n)
FUNCTION(GetIntervalFraction)(Instance c, const Reference r[], size_t n, uint64_t v[], uint64_t w[], int q[]) HAS_NONE(n)
FUNCTION(GetShiftDecimal)(Instance c, const Reference r[], size_t n, double v[]) HAS_NONE(n)
FUNCTION(GetShiftFraction)(Instance c, const Reference r[], size_t n, uint64_t v[], uint64_t w[]) HAS_NONE(n)
FUNCTION(SetIntervalDecimal)(Instance c, const Reference r[], size_t n, const double v[]) HAS_NONE(n)
FUNCTION(SetIntervalFraction)(Instance c, const Reference r[], size_t n, const uint64_t v[], const uint64_t w[]) HAS_NONE(n)
FUNCTION(SetShiftDecimal)(Instance c, const Reference r[], size_t n, const double v[]) HAS_NONE(n)
FUNCTION(SetShiftFraction)(Instance c, const Reference r[], size_t n, const uint64_t v[], const uint64_t w[]) HAS_NONE(n)
FUNCTION(EvaluateDiscreteStates)(Instance c) ANSWERS(OK)
FUNCTION(UpdateDiscreteStates)(Instance c, bool *needed, bool *terminate, bool *nominals, bool *values, bool *defined, double *next)
    ANSWERS(*needed = *terminate = *nominals = *values = *defined = false)

/* Model exchange: no states, no events. */
FUNCTION(EnterContinuousTimeMode)(Instance c) ANSWERS(OK)
FUNCTION(CompletedIntegratorStep)(Instance c, bool keep, bool *enter, bool *terminate) ANSWERS(*enter = *terminate = false)
FUNCTION(SetTime)(Instance c, double time) ANSWERS(set_time(c, time))
FUNCTION(SetContinuousStates)(Instance c, const double x[], size_t n) HAS_NONE(n)
FUNCTION(GetContinuousStateDerivatives)(Instance c, double x[], size_t n) HAS_NONE(n)
FUNCTION(GetEventIndicators)(Instance c, double x[], size_t n) HAS_NONE(n)
FUNCTION(GetContinuousStates)(Instance c, double x[], size_t n) HAS_NONE(n)
FUNCTION(GetNominalsOfContinuousStates)(Instance c, double x[], size_t n) HAS_NONE(n)
FUNCTION(GetNumberOfEventIndicators)(Instance c, size_t *n) ANSWERS(*n = 0)
FUNCTION(GetNumberOfContinuousStates)(Instance c, size_t *n) ANSWERS(*n = 0)

/* Co-simulation: outputs follow the inputs at once. */
FUNCTION(EnterStepMode)(Instance c) ANSWERS(OK)
FUNCTION(GetOutputDerivatives)(Instance c, const Reference r[], size_t n, const int32_t order[], double v[], size_t count) HAS_NONE(n)
FUNCTION(DoStep)(Instance c, double now, double step, bool final, bool *event, bool *terminate, bool *early, double *last)
{
    set_time(c, *last = now + step);
    *event = *terminate = *early = false;
    return refresh(c);
}
FUNCTION(ActivateModelPartition)(Instance c, Reference clock, double time) ANSWERS(ERROR)
