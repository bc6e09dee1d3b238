/* An instance of the bearing: inputs, outputs computed when they are asked for, and what both versions of FMI make of them.
   Value references: inputs, outputs, constants, then in_range and the time. */
#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the standard's functions have more arguments than a model without states needs */
#endif
#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT
#endif
#define JOIN(a, b) a##b
#define JOIN_VALUES(a, b) JOIN(a, b)
#define ANSWERS(status) { return status; }
#define HAS_NONE(count) { return (count) ? ERROR : OK; }
#include <stdlib.h>
#include <string.h>
#include "numbers.h"
#include MODEL_SOURCE

enum { FIRST_OUTPUT = INPUTS, FIRST_CONSTANT = INPUTS + OUTPUTS, IN_RANGE = FIRST_CONSTANT + CONSTANTS, TIME };
enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double in[INPUTS], out[OUTPUTS], time;
    int fresh, in_range;
    Memory memory;
    void (*logger)(void);
    void *environment;
    char *name;
} Component;

static void say(const Component *c, int status, const char *message);

static int reset(Component *c)
{
    memcpy(c->in, start, sizeof c->in);
    c->time = 0.0;
    c->fresh = 0;
    c->in_range = 1;
    memset(c->memory, 0, sizeof c->memory);
    return OK;
}

static int set_time(Component *c, double time)
{
    c->time = time;
    return OK;
}

static Component *create(const char *name, const char *token, void (*logger)(void), void *environment)
{
    Component *c = token && strcmp(token, TOKEN) == 0 ? calloc(1, sizeof *c) : NULL;
    if (!c || !(c->name = malloc(strlen(name) + 1))) {
        free(c);
        return NULL;
    }
    strcpy(c->name, name);
    c->logger = logger;
    c->environment = environment;
    reset(c);
    return c;
}

static void destroy(Component *c)
{
    if (c)
        free(c->name);
    free(c);
}

/* Outputs of the present inputs; those before stay where there are none. */
static int refresh(Component *c)
{
    if (!c->fresh) {
        double out[OUTPUTS];
        int in_range = compute(c->in, out, c->memory);
        if (in_range < 0) {
            say(c, DISCARD, "the balls find no equilibrium at these inputs: there are no outputs");
            return DISCARD;
        }
        if (c->in_range && !in_range)
            say(c, WARNING, BEYOND);
        memcpy(c->out, out, sizeof out);
        c->in_range = in_range;
        c->fresh = 1;
    }
    return OK;
}

static int get(Component *c, unsigned reference, double *value)
{
    int status = OK;
    if (reference < FIRST_OUTPUT)
        *value = c->in[reference];
    else if (reference < FIRST_CONSTANT) {
        status = refresh(c);
        *value = c->out[reference - FIRST_OUTPUT];
    } else if (reference < IN_RANGE)
        *value = constants[reference - FIRST_CONSTANT];
    else if (reference == TIME)
        *value = c->time;
    else {
        say(c, ERROR, "no real variable has this value reference");
        status = ERROR;
    }
    return status;
}

static int set(Component *c, unsigned reference, double value)
{
    if (reference >= FIRST_OUTPUT) {
        say(c, ERROR, "only inputs can be set");
        return ERROR;
    }
    if (!isfinite(value)) {
        say(c, DISCARD, "an input is not a finite number: it keeps its value");
        return DISCARD;
    }
    c->fresh = c->fresh && c->in[reference] == value;
    c->in[reference] = value;
    return OK;
}

static int get_many(Component *c, const unsigned *references, size_t count, double *values)
{
    int status, worst = OK;
    for (size_t k = 0; k < count; k++)
        worst = (status = get(c, references[k], values + k)) > worst ? status : worst;
    return worst;
}

static int set_many(Component *c, const unsigned *references, size_t count, const double *values)
{
    int status, worst = OK;
    for (size_t k = 0; k < count; k++)
        worst = (status = set(c, references[k], values[k])) > worst ? status : worst;
    return worst;
}

static int get_in_range(Component *c, unsigned reference, int *value)
{
    int status = reference == IN_RANGE ? refresh(c) : ERROR;
    if (status == ERROR)
        say(c, ERROR, "no Boolean variable has this value reference");
    *value = c->in_range;
    return status;
}

/* Changes of outputs with changes of inputs. */
static int differential(Component *c, const unsigned *unknown, size_t rows, const unsigned *known, size_t columns,
                        const double *seed, double *change)
{
    for (size_t i = 0; i < rows; i++) {
        change[i] = 0.0;
        for (size_t j = 0; j < columns; j++) {
            if (unknown[i] < FIRST_OUTPUT || unknown[i] >= FIRST_CONSTANT || known[j] >= FIRST_OUTPUT) {
                say(c, ERROR, "derivatives are of outputs by inputs");
                return ERROR;
            }
            change[i] += seed[j] * derivative(c->in, (int)unknown[i] - FIRST_OUTPUT, (int)known[j]);
        }
    }
    return OK;
}

/* Of the same instance, as the standard has it. */
static int save_state(const Component *c, void **state)
{
    if (!*state && !(*state = malloc(sizeof *c)))
        return ERROR;
    memcpy(*state, c, sizeof *c);
    return OK;
}

static int restore_state(Component *c, const void *state)
{
    memcpy(c, state, sizeof *c);
    return OK;
}

static int release_state(void **state)
{
    free(*state);
    *state = NULL;
    return OK;
}

/* MODEL_outputs, for S-functions, Modelica and others without FMI: 1 in range, 0 beyond, -1 without outputs. */
EXPORT int JOIN_VALUES(MODEL, _outputs)(const double *inputs, double *outputs)
{
    Memory memory;
    memset(memory, 0, sizeof memory);
    return compute(inputs, outputs, memory);
}
