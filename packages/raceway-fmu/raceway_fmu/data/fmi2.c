/* FMI 2.0: co-simulation and model exchange.  The declarations are those of the standard (Modelica Association, FMI 2.0.4). */
#include "component.h"

typedef unsigned Reference;
typedef double Real;
typedef int Integer, Boolean, Status;
typedef const char *String;
typedef void (*Logger)(void *environment, String name, Status status, String category, String message, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;
typedef struct {
    Boolean needed, terminate, nominals, values, defined;
    Real next;
} EventInfo;

#if defined FMI2_FUNCTION_PREFIX /* for static linking: the model's identifier and _ */
#define NAME(name) JOIN_VALUES(FMI2_FUNCTION_PREFIX, fmi2##name)
#else
#define NAME(name) fmi2##name
#endif
#define FUNCTION(name) EXPORT Status NAME(name)

static void say(const Component *c, int status, const char *message)
{
    if (c->logger)
        ((Logger)c->logger)(c->environment, c->name, status, status == WARNING ? "logStatusWarning" : "logStatusError", message);
}

EXPORT String NAME(GetTypesPlatform)(void) { return "default"; }
EXPORT String NAME(GetVersion)(void) { return "2.0"; }
EXPORT void *NAME(Instantiate)(String name, int kind, String token, String resources, const Callbacks *callbacks, Boolean visible, Boolean logging)
{
    return create(name, token, (void (*)(void))callbacks->logger, callbacks->environment);
}
EXPORT void NAME(FreeInstance)(void *c) { destroy(c); }
FUNCTION(SetDebugLogging)(void *c, Boolean on, size_t count, const String categories[]) ANSWERS(OK)
FUNCTION(SetupExperiment)(void *c, Boolean known, Real tolerance, Real first, Boolean ends, Real last) ANSWERS(set_time(c, first))
FUNCTION(EnterInitializationMode)(void *c) ANSWERS(OK)
FUNCTION(ExitInitializationMode)(void *c) ANSWERS(OK)
FUNCTION(Terminate)(void *c) ANSWERS(OK)
FUNCTION(Reset)(void *c) ANSWERS(reset(c))
FUNCTION(GetReal)(void *c, const Reference r[], size_t n, Real v[]) ANSWERS(get_many(c, r, n, v))
FUNCTION(SetReal)(void *c, const Reference r[], size_t n, const Real v[]) ANSWERS(set_many(c, r, n, v))
FUNCTION(GetBoolean)(void *c, const Reference r[], size_t n, Boolean v[]) ANSWERS(n == 1 ? get_in_range(c, r[0], v) : ERROR)
FUNCTION(SetBoolean)(void *c, const Reference r[], size_t n, const Boolean v[]) HAS_NONE(n)
FUNCTION(GetInteger)(void *c, const Reference r[], size_t n, Integer v[]) HAS_NONE(n)
FUNCTION(SetInteger)(void *c, const Reference r[], size_t n, const Integer v[]) HAS_NONE(n)
FUNCTION(GetString)(void *c, const Reference r[], size_t n, String v[]) HAS_NONE(n)
FUNCTION(SetString)(void *c, const Reference r[], size_t n, const String v[]) HAS_NONE(n)
FUNCTION(GetFMUstate)(void *c, void **state) ANSWERS(save_state(c, state))
FUNCTION(SetFMUstate)(void *c, void *state) ANSWERS(restore_state(c, state))
FUNCTION(FreeFMUstate)(void *c, void **state) ANSWERS(release_state(state))
FUNCTION(SerializedFMUstateSize)(void *c, void *state, size_t *size) ANSWERS(ERROR)
FUNCTION(SerializeFMUstate)(void *c, void *state, char bytes[], size_t size) ANSWERS(ERROR)
FUNCTION(DeSerializeFMUstate)(void *c, const char bytes[], size_t size, void **state) ANSWERS(ERROR)
FUNCTION(GetDirectionalDerivative)(void *c, const Reference u[], size_t nu, const Reference k[], size_t nk, const Real seed[], Real change[])
    ANSWERS(differential(c, u, nu, k, nk, seed, change))

/* Model exchange: no states, no events. */
FUNCTION(EnterEventMode)(void *c) ANSWERS(OK)
FUNCTION(NewDiscreteStates)(void *c, EventInfo *info)
{
    memset(info, 0, sizeof *info);
    return OK;
}
FUNCTION(EnterContinuousTimeMode)(void *c) ANSWERS(OK)
FUNCTION(CompletedIntegratorStep)(void *c, Boolean keep, Boolean *enter, Boolean *terminate) ANSWERS(*enter = *terminate = 0)
FUNCTION(SetTime)(void *c, Real time) ANSWERS(set_time(c, time))
FUNCTION(SetContinuousStates)(void *c, const Real x[], size_t n) HAS_NONE(n)
FUNCTION(GetDerivatives)(void *c, Real x[], size_t n) HAS_NONE(n)
FUNCTION(GetEventIndicators)(void *c, Real x[], size_t n) HAS_NONE(n)
FUNCTION(GetContinuousStates)(void *c, Real x[], size_t n) HAS_NONE(n)
FUNCTION(GetNominalsOfContinuousStates)(void *c, Real x[], size_t n) HAS_NONE(n)

/* Co-simulation: outputs follow the inputs at once. */
FUNCTION(SetRealInputDerivatives)(void *c, const Reference r[], size_t n, const Integer order[], const Real v[]) HAS_NONE(n)
FUNCTION(GetRealOutputDerivatives)(void *c, const Reference r[], size_t n, const Integer order[], Real v[]) HAS_NONE(n)
FUNCTION(DoStep)(void *c, Real now, Real step, Boolean final) ANSWERS(set_time(c, now + step) | refresh(c))
FUNCTION(CancelStep)(void *c) ANSWERS(ERROR)
FUNCTION(GetStatus)(void *c, int kind, Status *v) ANSWERS(DISCARD)
FUNCTION(GetRealStatus)(void *c, int kind, Real *v) ANSWERS(DISCARD)
FUNCTION(GetIntegerStatus)(void *c, int kind, Integer *v) ANSWERS(DISCARD)
FUNCTION(GetBooleanStatus)(void *c, int kind, Boolean *v) ANSWERS(DISCARD)
FUNCTION(GetStringStatus)(void *c, int kind, String *v) ANSWERS(DISCARD)
