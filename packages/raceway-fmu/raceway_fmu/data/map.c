/* Chebyshev series over the inputs: an output is the sum of c[i][j]... T_i(u) T_j(v) ..., u, v ... the inputs or their logarithms
   mapped to -1 ... 1. */
#include <math.h>

static void polynomials(int count, double t, double *value, double *slope)
{
    value[0] = 1.0;
    slope[0] = 0.0;
    if (count > 1) {
        value[1] = t;
        slope[1] = 1.0;
    }
    for (int k = 2; k < count; k++) {
        value[k] = 2.0 * t * value[k - 1] - value[k - 2];
        slope[k] = 2.0 * value[k - 1] + 2.0 * t * slope[k - 1] - slope[k - 2];
    }
}

static double series(const double *coefficients, double *const basis[INPUTS])
{
    double sum[TERMS];
    const double *from = coefficients;
    int size = TERMS;
    for (int axis = 0; axis < INPUTS; axis++) {
        size /= degrees[axis];
        for (int j = 0; j < size; j++)
            sum[j] = basis[axis][0] * from[j];
        for (int i = 1; i < degrees[axis]; i++)
            for (int j = 0; j < size; j++)
                sum[j] += basis[axis][i] * from[i * size + j];
        from = sum;
    }
    return sum[0];
}

/* Polynomials of all inputs and their slopes; 0 where an input is beyond its range, whose end then stands for it. */
static int place(const double *in, double value[INPUTS][MOST], double slope[INPUTS][MOST])
{
    int in_range = 1;
    for (int axis = 0; axis < INPUTS; axis++) {
        double x = fmin(fmax(in[axis], low[axis]), high[axis]), per_input = x == in[axis] ? 1.0 : 0.0;
        double first = low[axis], last = high[axis];
        in_range &= x == in[axis];
        if (logarithmic[axis]) {
            per_input /= x;
            x = log(x);
            first = log(first);
            last = log(last);
        }
        polynomials(degrees[axis], (2.0 * x - first - last) / (last - first), value[axis], slope[axis]);
        for (int k = 0; k < degrees[axis]; k++)
            slope[axis][k] *= per_input * 2.0 / (last - first);
    }
    return in_range;
}

typedef char Memory[1]; /* none */

static int compute(const double *in, double *out, Memory memory)
{
    (void)memory;
    double value[INPUTS][MOST], slope[INPUTS][MOST], *basis[INPUTS];
    int in_range = place(in, value, slope);
    for (int axis = 0; axis < INPUTS; axis++)
        basis[axis] = value[axis];
    for (int k = 0; k < OUTPUTS; k++)
        out[k] = series(terms[k], basis);
    return in_range;
}

static double derivative(const double *in, int output, int input)
{
    double value[INPUTS][MOST], slope[INPUTS][MOST], *basis[INPUTS];
    place(in, value, slope);
    for (int axis = 0; axis < INPUTS; axis++)
        basis[axis] = axis == input ? slope[axis] : value[axis];
    return series(terms[output], basis);
}
