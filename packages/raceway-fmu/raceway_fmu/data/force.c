/* Forces of a bearing with rigid rings and balls on its shaft.  Every ball finds its place between the races: its contact forces, the
   centrifugal force and, where MOMENTS, its gyroscopic moment balance in its meridian plane (axial a, radial r). */
#include <math.h>

/* Columns of at_rest and by_square: raceway.core.ring.kernels.layout's of a ball, then those of all balls. */
enum { COSINE, SINE, CENTRIFUGAL, OUTER_SHARE, OUTER_FACTOR, SIDE, LEVER, SHIFT, OWN_REST_AXIAL, OWN_REST_RADIAL, OWN_OFFSET_INNER,
       OWN_OFFSET_OUTER, OWN_TILT_ARM, REST_AXIAL, REST_RADIAL, OFFSET_INNER, OFFSET_OUTER, TILT_ARM, DAMPING, CAGE, FRICTION, STICK,
       SHARE_INNER, SHARE_OUTER, BALL_OVER_PITCH, GYROSCOPIC, DIAMETER, TIME_CONSTANT, TRACTION };
enum { X, Y, Z, TILT_Y, TILT_Z, SPEED, CAGE_ANGLE };

typedef struct { double a, r; } Vector;
typedef struct { double aa, ar, ra, rr; } Matrix;
/* Direction n, distance of ball and groove centre, normal force and stiffness; tangential force h along t = (n.r, -n.a) with its
   derivatives by the contact's own distance and angle, by the other contact's angle, and by the inner distance (outer contact). */
typedef struct { Vector n; double length, force, stiffness, h, by_length, by_angle, by_other, by_inner; } Contact;

static double dot(Vector u, Vector v) { return u.a * v.a + u.r * v.r; }
static Vector across(Vector n) { return (Vector){n.r, -n.a}; }
static Vector times(Matrix m, Vector v) { return (Vector){m.aa * v.a + m.ar * v.r, m.ra * v.a + m.rr * v.r}; }
static Matrix sum(Matrix m, double f, Matrix k) { return (Matrix){m.aa + f * k.aa, m.ar + f * k.ar, m.ra + f * k.ra, m.rr + f * k.rr}; }
static Matrix outer(double f, Vector u, Vector v) { return (Matrix){f * u.a * v.a, f * u.a * v.r, f * u.r * v.a, f * u.r * v.r}; }
static Matrix product(Matrix m, Matrix k)
{
    return (Matrix){m.aa * k.aa + m.ar * k.ra, m.aa * k.ar + m.ar * k.rr, m.ra * k.aa + m.rr * k.ra, m.ra * k.ar + m.rr * k.rr};
}
static Matrix inverse(Matrix m)
{
    double det = m.aa * m.rr - m.ar * m.ra, trace = m.aa + m.rr;
    if (!(fabs(det) > 1e-14 * trace * trace)) { /* no step along a motion that nothing holds */
        double shift = -1e-7 * fabs(trace) - 1.0;
        m.aa += shift;
        m.rr += shift;
        det = m.aa * m.rr - m.ar * m.ra;
    }
    return (Matrix){m.rr / det, -m.ar / det, -m.ra / det, m.aa / det};
}

/* Normal force [N] of a contact at its approach [m], and its derivative. */
static double law(int contact, double approach, double *stiffness)
{
    *stiffness = 0.0;
    if (approach <= 0.0)
        return 0.0;
#if LAW == 3 /* (2 LAW) / 2 is the exponent: Hertz' 3/2, the square of a penalty */
    double slope = factors[contact] * sqrt(approach);
    *stiffness = 1.5 * slope;
    return slope * approach;
#elif LAW == 4
    *stiffness = 2.0 * factors[contact] * approach;
    return factors[contact] * approach * approach;
#else /* a table: Chebyshev series in the logarithm of the approach of force over approach^3/2 */
    double scale = 2.0 / log(TABLE_HIGH / TABLE_LOW), t = fmax(scale * log(approach / TABLE_LOW) - 1.0, -1.0), root = sqrt(approach);
    double before = 1.0, now = t, slope_before = 0.0, slope = 1.0;
    const double *c = tables[kinds[contact]];
    double value = c[0] + c[1] * t, by_t = c[1];
    for (int k = 2; k < TABLE_TERMS; k++) {
        double next = 2.0 * t * now - before, slope_next = 2.0 * now + 2.0 * t * slope - slope_before;
        value += c[k] * next;
        by_t += c[k] * slope_next;
        before = now;
        now = next;
        slope_before = slope;
        slope = slope_next;
    }
    *stiffness = root * (1.5 * value + (t > -1.0 ? scale * by_t : 0.0));
    return value * root * approach;
#endif
}

/* Gyroscopic moment [N m] of a ball that rolls without spin on the outer race, by the angles of both contacts. */
static double moment(Vector i, Vector o, double size, double *by_inner, double *by_outer)
{
    double q = at_rest[0][BALL_OVER_PITCH], d = o.r + q, t = o.a / d, t_o = (1.0 + q * o.r) / (d * d), e = 1.0 + q * o.r, c = 1.0 - q * i.r;
    double ro = (o.r + t * o.a) / e, ri = (i.r + t * i.a) / c, rolling = ro + ri, m = size * t / (q * rolling);
    double ro_o = (-o.a + t * o.r + t_o * o.a + ro * q * o.a) / e, ri_i = (-i.a + t * i.r - ri * q * i.a) / c, ri_o = t_o * i.a / c;
    *by_inner = -m * ri_i / rolling;
    *by_outer = size * t_o / (q * rolling) - m * (ro_o + ri_o) / rolling;
    return m;
}

/* What is carried of what is asked, of most at most: smoothly with TRACTION, else all of it; with its derivatives. */
static double carry(double asked, double most, double *by_asked, double *by_most)
{
    double limit = at_rest[0][TRACTION], size = limit > 0.0 ? hypot(asked, most) : fmax(fabs(asked), most), a = size > 0.0 ? asked / size : 0.0, m = size > 0.0 ? most / size : 0.0;
    *by_asked = limit > 0.0 ? m * m * m : m == 1.0;
    *by_most = limit > 0.0 ? a * a * a : m < 1.0 ? a : 0.0;
    return size * a * m;
}
static void add_moment(double size, Contact *inner, Contact *outer)
{
    double limit = at_rest[0][TRACTION], diameter = at_rest[0][DIAMETER], part = limit > 0.0 ? limit : 1.0; /* inside no more than the normal force */
    double by_i, by_o, m = moment(inner->n, outer->n, size, &by_i, &by_o), share = at_rest[0][SHARE_INNER] / diameter, rest = 2.0 / diameter, ai, fi, ao, fo;
    inner->h = -carry(share * m, part * inner->force, &ai, &fi);
    outer->h = -carry(rest * m + inner->h, limit > 0.0 ? limit * outer->force : 1e300, &ao, &fo);
    inner->by_length = -part * fi * inner->stiffness;
    outer->by_length = -part * fo * outer->stiffness;
    outer->by_inner = ao * part * fi * inner->stiffness;
    inner->by_angle = -share * ai * by_i, inner->by_other = -share * ai * by_o;
    outer->by_angle = -ao * (rest - share * ai) * by_o, outer->by_other = -ao * (rest - share * ai) * by_i;
}

static Contact contact(int number, Vector x, double offset, Vector otherwise)
{
    Contact c = {otherwise, sqrt(dot(x, x)), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    if (c.length > 0.0)
        c.n = (Vector){x.a / c.length, x.r / c.length};
    c.force = law(number, c.length - offset, &c.stiffness);
    return c;
}

/* Derivative of f n + h t by the vector from one centre to the other. */
static Matrix tangent(const Contact *c)
{
    Vector t = across(c->n);
    double w = c->length > 0.0 ? 1.0 / c->length : 0.0;
    Matrix m = sum(outer(c->stiffness, c->n, c->n), (c->force + c->by_angle) * w, outer(1.0, t, t));
    return MOMENTS ? sum(sum(m, -c->h * w, outer(1.0, c->n, t)), c->by_length, outer(1.0, t, c->n)) : m;
}

static Vector pull(const Contact *c) { return (Vector){c->force * c->n.a + c->h * c->n.r, c->force * c->n.r - c->h * c->n.a}; }

typedef struct { Vector force, couple_by_centre; Matrix by_centre; double couple, inner, outer; } Ball;

/* The last equilibrium of a ball, which the next one is predicted from: its place, the vector e there, how the place follows e, and how
   far e may have moved; 0 where there is none.  Results depend on it by rounding only. */
typedef struct { Vector place, centre; Matrix follow; double reach; } Last;
typedef Last Memory[BALLS];

/* A number of the grooves at a square of the speed: of all balls, and what ball k has beyond that. */
static double number(int k, int common, int own, double square)
{
    return at_rest[k][common] + at_rest[k][own] + square * (by_square[k][common] + by_square[k][own]);
}

/* Ball k with the vector e from the outer to the inner groove centre; 0 where it finds no place. */
static int place(int k, Vector e, double square, Memory memory, Ball *ball)
{
    double length = sqrt(dot(e, e)), li = number(k, OFFSET_INNER, OWN_OFFSET_INNER, square), slope = 0.0;
    double lo = number(k, OFFSET_OUTER, OWN_OFFSET_OUTER, square), push = square * by_square[k][CENTRIFUGAL], size = square * by_square[k][GYROSCOPIC];
    double seat = lo + (push > 0.0 ? pow(push / seats[k], SEAT_POWER) : 0.0);
    Vector p = {0.0, seat}, x = {e.a, e.r - seat}, step = {0.0, 0.0};
    memset(ball, 0, sizeof *ball);
    if (push <= 0.0 && length <= li + lo)
        return 1;
    if (length > li + lo && !(push > 0.0 && dot(x, x) <= li * li)) {
        double share = (lo + at_rest[k][OUTER_SHARE] * (length - li - lo)) / length;
        p = (Vector){share * e.a, share * e.r};
    }
    Vector moved = {e.a - memory[k].centre.a, e.r - memory[k].centre.r};
    if (dot(moved, moved) < memory[k].reach * memory[k].reach) {
        moved = times(memory[k].follow, moved);
        p = (Vector){memory[k].place.a + moved.a, memory[k].place.r + moved.r};
    }
    memory[k].reach = 0.0;
    for (int attempt = 0; attempt < 200; attempt++) {
        if (attempt == 60) { /* forces without a potential can lead in circles: once more from the seat */
            p = (Vector){0.0, seat};
            slope = 0.0;
        }
        x = (Vector){e.a - p.a, e.r - p.r};
        Contact o = contact(BALLS + k, p, lo, (Vector){0.0, 1.0}), i = contact(k, x, li, o.n);
        if (MOMENTS)
            add_moment(size, &i, &o);
        Vector inner = pull(&i), rest = pull(&o);
        rest = (Vector){inner.a - rest.a, inner.r - rest.r + push};
        if (slope > 0.0 && -dot(rest, step) > 0.9 * slope) { /* beyond the balance along the last step: half of it back */
            step = (Vector){0.5 * step.a, 0.5 * step.r};
            slope *= 0.5;
            p = (Vector){p.a - step.a, p.r - step.r};
            continue;
        }
        Vector ti = across(i.n), to = across(o.n);
        double wi = i.length > 0.0 ? 1.0 / i.length : 0.0, wo = 1.0 / o.length;
        Matrix stays = tangent(&i), by_place = sum((Matrix){0.0, 0.0, 0.0, 0.0}, -1.0, stays), by_centre = stays;
        if (MOMENTS) {
            by_place = sum(by_place, i.by_other * wo, outer(1.0, ti, to));
            by_centre = sum(sum(stays, -o.by_other * wi, outer(1.0, to, ti)), -o.by_inner, outer(1.0, to, i.n));
        }
        Matrix j = sum(sum(sum(by_place, -1.0, tangent(&o)), 1.0, stays), -1.0, by_centre), back = inverse(j);
        step = times(back, (Vector){-rest.a, -rest.r});
        double stride = sqrt(dot(step, step)), depth_i = i.length - li, depth_o = o.length - lo;
        if (stride > 0.2 * lo)
            step = (Vector){0.2 * lo / stride * step.a, 0.2 * lo / stride * step.r};
        p = (Vector){p.a + step.a, p.r + step.r};
        slope = dot(rest, step);
        double shallow = depth_o <= 0.0 || (depth_i > 0.0 && depth_i < depth_o) ? depth_i : depth_o;
        if (stride <= fmax(1e-7 * shallow, 1e-14 * lo)) {
            /* What this last step changes is added by the derivatives: what is left is of second order. */
            Vector change = times(by_place, step);
            double groove = li + 0.5 * at_rest[k][DIAMETER];
            Vector couple_by_e = {-groove * (i.by_length * i.n.a + i.by_angle * wi * ti.a), -groove * (i.by_length * i.n.r + i.by_angle * wi * ti.r)};
            Vector couple_by_p = {-couple_by_e.a - groove * i.by_other * wo * to.a, -couple_by_e.r - groove * i.by_other * wo * to.r};
            Matrix follow = product(back, by_centre);
            memory[k] = (Last){p, e, sum((Matrix){0.0, 0.0, 0.0, 0.0}, -1.0, follow), 0.1 * fabs(shallow)};
            ball->force = (Vector){inner.a + change.a, inner.r + change.r};
            ball->by_centre = sum(stays, -1.0, product(by_place, follow));
            ball->couple = -groove * i.h + dot(couple_by_p, step);
            ball->couple_by_centre = (Vector){couple_by_e.a - couple_by_p.a * follow.aa - couple_by_p.r * follow.ra,
                                              couple_by_e.r - couple_by_p.a * follow.ar - couple_by_p.r * follow.rr};
            ball->inner = fmax(i.force - i.stiffness * dot(i.n, step), 0.0);
            ball->outer = fmax(o.force + o.stiffness * dot(o.n, step), 0.0);
            if (ball->inner <= 0.0 && i.stiffness <= 0.0)
                memset(&ball->by_centre, 0, sizeof ball->by_centre);
            return 1;
        }
    }
    return 0;
}

/* Outputs: force and moments on the shaft (5), largest ball load, speed of the cage, loads of all balls inside and outside,
   stiffness (5 x 5).  1 in range, 0 beyond, -1 without equilibrium. */
static int compute(const double *in, double *out, Memory memory)
{
    double square = in[SPEED] * in[SPEED], turn_c = cos(in[CAGE_ANGLE]), turn_s = sin(in[CAGE_ANGLE]), *loads = out + 7, *stiffness = loads + 2 * BALLS;
    int in_range = in[SPEED] >= 0.0 && in[SPEED] <= HIGHEST_SPEED;
    memset(out, 0, OUTPUTS * sizeof *out);
    out[6] = CAGE_RATIO * in[SPEED];
    for (int k = 0; k < BALLS; k++) {
        const double *b = at_rest[k];
        double c = b[COSINE] * turn_c - b[SINE] * turn_s, s = b[SINE] * turn_c + b[COSINE] * turn_s, u = in[TILT_Y] * s - in[TILT_Z] * c;
        double side = b[SIDE], lever = b[LEVER], arm = number(k, TILT_ARM, OWN_TILT_ARM, square);
        double axial = number(k, REST_AXIAL, OWN_REST_AXIAL, square) + b[SHIFT] + square * by_square[k][SHIFT];
        double radial = number(k, REST_RADIAL, OWN_REST_RADIAL, square);
        Ball ball;
        Vector e = {axial + side * (in[X] + arm * u), radial + in[Y] * c + in[Z] * s - lever * u};
        if (!place(k, e, square, memory, &ball))
            return -1;
        Vector jacobian[5] = {{side, 0.0}, {0.0, c}, {0.0, s}, {side * arm * s, -lever * s}, {-side * arm * c, lever * c}};
        double turn[5] = {0.0, 0.0, 0.0, side * s, -side * c};
        for (int j = 0; j < 5; j++) {
            Vector force = times(ball.by_centre, jacobian[j]);
            for (int i = 0; i < 5; i++)
                stiffness[5 * i + j] += dot(jacobian[i], force);
            out[j] -= dot(jacobian[j], ball.force);
            if (MOMENTS) {
                double couple = dot(ball.couple_by_centre, jacobian[j]);
                for (int i = 3; i < 5; i++)
                    stiffness[5 * i + j] += turn[i] * couple;
                out[j] -= turn[j] * ball.couple;
            }
        }
        loads[k] = ball.inner;
        loads[BALLS + k] = ball.outer;
        out[5] = fmax(out[5], fmax(ball.inner, ball.outer));
        in_range &= ball.inner <= LIMIT_INNER && ball.outer <= LIMIT_OUTER;
    }
    return in_range;
}

static double derivative(const double *in, int output, int input)
{
    double before[OUTPUTS], after[OUTPUTS], moved[INPUTS], step = steps[input];
    Memory memory;
    memset(memory, 0, sizeof memory);
    if (output < 5 && input < 5)
        return compute(in, after, memory) < 0 ? 0.0 : -after[7 + 2 * BALLS + 5 * output + input];
    memcpy(moved, in, sizeof moved);
    moved[input] = in[input] + step;
    if (compute(moved, after, memory) < 0)
        return 0.0;
    moved[input] = in[input] - step;
    return compute(moved, before, memory) < 0 ? 0.0 : (after[output] - before[output]) / (2.0 * step);
}
