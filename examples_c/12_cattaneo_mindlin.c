/* 12 Cattaneo and Mindlin: two cylinders are pressed together and pushed back and forth; comparison with the closed forms.

       Q -->  ( upper cylinder )            pressure    p = p0 sqrt(1 - x^2/a^2),           P = pi/2 p0 a
               ------ 2a ------             push Q:     q = mu p(x) less mu p0 c/a sqrt(1 - x^2/c^2) where |x| < c,
              ( lower cylinder )  <-- Q                 c = a sqrt(1 - Q/(mu P)): it sticks within c, slips between c and a
                                            back to Q:  q = q(Q1) - 2 q((Q1 - Q)/2), Q1 being where the push has turned (Mindlin)

   Close to the contact both bodies are elastic half planes. The host has influence matrices, as from boundary elements: A f
   are the displacements of n = 400 cells over 3a by the forces f on them, in either direction, relative to a far point of the
   body, which also moves. In one direction the energy of a body is (u - w)'A^-1 (u - w) / 2, where w is the motion of the far
   point on every cell:

           [  A^-1       -A^-1 1 ]                  n cells and the far point; K 1 = 0:
       K = [                     ]                  the body floats
           [ -1'A^-1    1'A^-1 1 ]

   The loads P and Q act at the far point of the upper cylinder, which only contact and friction hold. Two equality rows hold
   the far point of the lower cylinder. The displacement that a force causes perpendicular to its direction is left out: it
   is equal on both surfaces, so it affects no row.

   Steps of the push, relative to mu P: 0 (pressed only), .3, .6, .9, back by steps of .45 to -.9, and to .9 again. After
   each step feti_friction_commit makes the current slips the reference of the next step.

   Units: N, mm, MPa; 1 mm thick. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "demo.h"
#include "picture.h"

enum { CELLS = 400, FAR = CELLS, ALONG = CELLS + 1, N = 2 * (CELLS + 1), STEPS = 12, SHOWN = 4, SAMPLES = 401 };
enum { TURN = 4, RETURN = 8 }; /* the first steps of the ways back and to again */
static const double PI = 3.14159265358979323846;
static const double YOUNG = 210000.0, POISSON = 0.3, RADIUS = 200.0, MU = 0.3; /* MPa, -, mm (of both cylinders), - */
static const double HALF = 1.0, REACH = 1000.0;                                /* mm: a; distance of the far point */
static const double PART[STEPS] = { 0.0, 0.3, 0.6, 0.9, 0.45, 0.0, -0.45, -0.9, -0.45, 0.0, 0.45, 0.9 };

/* What follows from these: modulus of a half plane E/(1 - nu^2), the largest pressure, load, and width of a cell. */
typedef struct {
    double modulus, p0, load, cell, x[CELLS];
} contact;

static contact of_hertz(void)
{
    contact c;

    c.modulus = YOUNG / (1.0 - POISSON * POISSON);
    c.p0 = c.modulus * HALF / (2.0 * RADIUS);
    c.load = 0.5 * PI * c.p0 * HALF;
    c.cell = 3.0 * HALF / CELLS;
    for (int i = 0; i < CELLS; i++) c.x[i] = -1.5 * HALF + (i + 0.5) * c.cell;
    return c;
}

/* Displacement at a distance from the middle of a cell by a unit force spread over it, -2/(pi E') times the mean of ln(|x|/REACH). */
static double influence(const contact *c, double distance)
{
    const double right = distance + 0.5 * c->cell, left = distance - 0.5 * c->cell;

    return -2.0 / (PI * c->modulus * c->cell) * (right * (log(fabs(right) / REACH) - 1.0) - left * (log(fabs(left) / REACH) - 1.0));
}

/* Inverse of A in place, by elimination without pivoting: A is symmetric and positive definite. */
static void invert(double *a)
{
    for (int k = 0; k < CELLS; k++) {
        const double pivot = 1.0 / a[k + CELLS * k];
        a[k + CELLS * k] = 1.0;
        for (int i = 0; i < CELLS; i++) a[i + CELLS * k] *= pivot; /* column k */
        for (int j = 0; j < CELLS; j++) {
            const double factor = a[k + CELLS * j];
            if (j == k) continue;
            a[k + CELLS * j] = 0.0;
            for (int i = 0; i < CELLS; i++) a[i + CELLS * j] -= factor * a[i + CELLS * k];
        }
    }
}

/* K of either cylinder: normal direction in unknowns 0 to FAR, along in ALONG to N - 1, the far point being the last of each. */
static double *stiffness(const contact *c)
{
    double *a = demo_array((int64_t)CELLS * CELLS, sizeof *a), *k = demo_array((int64_t)N * N, sizeof *k), all = 0.0;

    for (int i = 0; i < CELLS; i++)
        for (int j = 0; j < CELLS; j++) a[i + CELLS * j] = influence(c, c->x[i] - c->x[j]);
    invert(a);
    for (int i = 0; i < CELLS; i++) {
        double sum = 0.0;
        for (int j = 0; j < CELLS; j++) {
            const double value = 0.5 * (a[i + CELLS * j] + a[j + CELLS * i]);
            k[i + N * j] = k[ALONG + i + N * (ALONG + j)] = value;
            sum += value;
        }
        for (int from = 0; from < N; from += ALONG) k[from + i + N * (from + FAR)] = k[from + FAR + N * (from + i)] = -sum;
        all += sum;
    }
    for (int from = 0; from < N; from += ALONG) k[from + FAR + N * (from + FAR)] = all;
    free(a);
    return k;
}

/* Two equal bodies: upper 0, lower 1. The far point of the lower one is held. */
static void add_cylinders(feti_problem *problem, const contact *c)
{
    static const int32_t ptr[3] = { 0, 1, 2 }, body[2] = { 1, 1 }, dof[2] = { FAR, ALONG + FAR };
    static const double one[2] = { 1.0, 1.0 };
    double *k = stiffness(c), *shift = demo_array(2 * N, sizeof *shift);

    for (int i = 0; i <= FAR; i++) shift[i] = shift[N + ALONG + i] = 1.0;
    for (int b = 0; b < 2; b++) {
        int64_t number;
        CALL(feti_body_add(problem, N, &number));
        CALL(feti_body_stiffness_dense(problem, number, N, k, N, FETI_LOWER, FETI_COPY));
        CALL(feti_body_null_space(problem, number, 2, N, shift, N, FETI_EXACT));
    }
    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, 2, ptr, body, dof, one, 0, NULL, NULL));
    free(k);
    free(shift);
}

/* Cell by cell: the lower surface stays below the upper one, u_lower - u_upper <= x^2 / R, the gap of both together; and the slip
   of the upper surface on the lower one, u_upper - u_lower along x, with friction. */
static void add_pairs(feti_problem *problem, const contact *c)
{
    static int32_t ptr[CELLS + 1], row[CELLS], body[2 * CELLS], across[2 * CELLS], along[2 * CELLS];
    static double normal[2 * CELLS], tangential[2 * CELLS], gap[CELLS], coefficient[CELLS];

    for (int i = 0; i < CELLS; i++) {
        ptr[i] = 2 * i, row[i] = i, gap[i] = c->x[i] * c->x[i] / RADIUS, coefficient[i] = MU;
        for (int b = 0; b < 2; b++) {
            body[2 * i + b] = b, across[2 * i + b] = i, along[2 * i + b] = ALONG + i;
            normal[2 * i + b] = b == 0 ? -1.0 : 1.0, tangential[2 * i + b] = b == 0 ? 1.0 : -1.0;
        }
    }
    ptr[CELLS] = 2 * CELLS;
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, CELLS, ptr, body, across, normal, 0, gap, NULL));
    CALL(feti_friction_add_i32(problem, CELLS, 1, row, ptr, body, along, tangential, 0, coefficient, NULL, NULL));
}

static double half_width(double part)
{
    return HALF * sqrt(1.0 - part);
}

static double ellipse(double x, double half)
{
    return half > 0.0 ? sqrt(fmax(0.0, 1.0 - x * x / (half * half))) : 0.0;
}

/* Shear of Cattaneo and Mindlin over mu p0 for a push of so much of mu P >= 0; and of the path: to .9, back to -.9, to .9. */
static double cattaneo(double part, double x)
{
    return ellipse(x, HALF) - half_width(part) / HALF * ellipse(x, half_width(part));
}

static double mindlin(int step, double x)
{
    if (step < TURN) return cattaneo(PART[step], x);
    if (step < RETURN) return cattaneo(0.9, x) - 2.0 * cattaneo((0.9 - PART[step]) / 2.0, x);
    return -cattaneo(0.9, x) + 2.0 * cattaneo((0.9 + PART[step]) / 2.0, x);
}

/* How far the far points shift against each other, over mu p0 / E*: the displacement of the middle by an elliptic shear of
   half-width b is b (ln(2 REACH / b) + 1/2) times its largest value. */
static double shift_by(double part)
{
    const double c = half_width(part), of_slip = HALF * (log(2.0 * REACH / HALF) + 0.5);

    return c > 0.0 ? of_slip - c * c / HALF * (log(2.0 * REACH / c) + 0.5) : of_slip;
}

static double shift(int step)
{
    if (step < TURN) return shift_by(PART[step]);
    if (step < RETURN) return shift_by(0.9) - 2.0 * shift_by((0.9 - PART[step]) / 2.0);
    return -shift_by(0.9) + 2.0 * shift_by((0.9 + PART[step]) / 2.0);
}

/* What a step has come to. */
typedef struct {
    double shear[CELLS];                /* over mu p0 */
    double missed, size, worst;         /* root mean square over 2a of its error, and of the closed form; the largest error */
    double pressed, stuck, shift, sums; /* half-widths of contact and stick, mm; shift, mm; relative error of both sums */
    double pressure[CELLS], gap[CELLS], u[2 * N]; /* MPa, mm, mm: upper cylinder, lower one */
    int32_t state[CELLS];                         /* FETI_FRICTION_OPEN, _STICK, _SLIP, .. */
} step_result;

static void solve_step(feti_problem *problem, const contact *c, int step, step_result *out, feti_info *info)
{
    static double lambda_n[CELLS], lambda_t[CELLS], load[N];
    const double push = PART[step] * MU * c->load;
    double normal = 0.0, along = 0.0, missed = 0.0, size = 0.0;

    load[FAR] = -c->load, load[ALONG + FAR] = push;
    CALL(feti_body_load(problem, 0, N, load));
    CALL(feti_solve(problem, info));
    CALL(feti_friction_commit(problem)); /* the step is accepted: slips of the next one are counted from here */
    CALL(feti_multipliers(problem, FETI_INEQUALITY, CELLS, lambda_n));
    CALL(feti_multipliers(problem, FETI_TANGENTIAL, CELLS, lambda_t));
    CALL(feti_gaps(problem, CELLS, out->gap));
    CALL(feti_friction_states(problem, CELLS, out->state));
    for (int b = 0; b < 2; b++) CALL(feti_displacement(problem, b, N, out->u + b * N));
    for (int i = 0; i < CELLS; i++) {
        const double closed = mindlin(step, c->x[i]);
        double difference;
        out->pressure[i] = lambda_n[i] / c->cell;
        out->shear[i] = lambda_t[i] / c->cell / (MU * c->p0);
        difference = out->shear[i] - closed;
        missed += difference * difference, size += closed * closed;
        out->worst = fmax(out->worst, fabs(difference));
        normal += lambda_n[i], along += lambda_t[i];
    }
    out->missed = sqrt(missed * c->cell / (2.0 * HALF)), out->size = sqrt(size * c->cell / (2.0 * HALF));
    out->pressed = 0.5 * (double)info->active * c->cell, out->stuck = 0.5 * (double)info->sticking * c->cell;
    out->shift = out->u[ALONG + FAR]; /* the other far point is held */
    out->sums = fmax(fabs(normal - c->load), fabs(along - push)) / c->load;
}

/* Von Mises stress in the lower half plane, at depth below x: each cell acts as a force F of Flamant at its middle, whose stress at
   the distance d is -(2 / pi) (F.d) d d' / |d|^4; plane strain. (MPa) */
static double von_mises(const contact *c, const step_result *found, double x, double depth)
{
    double xx = 0.0, zz = 0.0, xz = 0.0;

    for (int i = 0; i < CELLS; i++) {
        const double d = x - c->x[i], square = d * d + depth * depth;
        const double along = found->shear[i] * MU * c->p0 * c->cell, down = found->pressure[i] * c->cell;
        const double factor = -2.0 / PI * (along * d + down * depth) / (square * square);
        xx += factor * d * d, zz += factor * depth * depth, xz += factor * d * depth;
    }
    const double yy = POISSON * (xx + zz);
    return sqrt(0.5 * ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) + 3.0 * xz * xz);
}

/* Cells of both surfaces with what the contact does to them, and squares of the lower half plane with their stress. */
static void draw_step(const char *folder, const contact *c, int step, const step_result *found)
{
    enum { ACROSS = 75, DOWN = 40, SQUARES = ACROSS * DOWN, ALL = 2 * CELLS + SQUARES,
           NODES = 2 * (CELLS + 1) + (ACROSS + 1) * (DOWN + 1) };
    static double xyz[3 * NODES], moved[3 * ALL], pressure[ALL], shear[ALL], gap[ALL], state[ALL], stress[ALL];
    static int64_t offset[ALL + 1], corner[4 * ALL];
    static int32_t type[ALL], body[ALL];
    const double side = 3.0 * HALF / ACROSS;
    const picture_grid grid = { NODES, ALL, xyz, offset, corner, type, body };
    const picture_field field[] = { { "displacement", 1, 3, 0, moved }, { "pressure", 1, 1, 0, pressure }, { "shear", 1, 1, 0, shear },
                                    { "gap", 1, 1, 0, gap }, { "friction", 1, 1, 1, state }, { "von_mises", 1, 1, 0, stress } };
    char name[64];

    for (int b = 0; b < 2; b++)
        for (int i = 0; i <= CELLS; i++) {
            const int cell = i + b * CELLS, first = i + b * (CELLS + 1);
            xyz[3 * first] = -1.5 * HALF + i * c->cell;
            if (i == CELLS) continue;
            type[cell] = PICTURE_LINE, body[cell] = b + 1;
            corner[2 * cell] = first, corner[2 * cell + 1] = first + 1, offset[cell + 1] = 2 * (cell + 1);
            moved[3 * cell] = found->u[b * N + ALONG + i], moved[3 * cell + 1] = found->u[b * N + i], moved[3 * cell + 2] = 0.0;
            pressure[cell] = found->pressure[i], shear[cell] = MU * c->p0 * found->shear[i], gap[cell] = found->gap[i];
            state[cell] = found->state[i], stress[cell] = NAN;
        }
    for (int j = 0; j <= DOWN; j++)
        for (int i = 0; i <= ACROSS; i++) {
            const int first = 2 * (CELLS + 1) + i + (ACROSS + 1) * j, cell = 2 * CELLS + i + ACROSS * j;
            xyz[3 * first] = -1.5 * HALF + i * side, xyz[3 * first + 1] = -j * side;
            if (i == ACROSS || j == DOWN) continue;
            type[cell] = PICTURE_QUAD, body[cell] = 2;
            const int64_t around[4] = { first, first + ACROSS + 1, first + ACROSS + 2, first + 1 };
            for (int k = 0; k < 4; k++) corner[offset[cell] + k] = around[k];
            offset[cell + 1] = offset[cell] + 4;
            for (int k = 0; k < 3; k++) moved[3 * cell + k] = NAN;
            pressure[cell] = shear[cell] = gap[cell] = NAN, state[cell] = -1.0;
            stress[cell] = von_mises(c, found, xyz[3 * first] + 0.5 * side, (j + 0.5) * side);
        }
    snprintf(name, sizeof name, "cattaneo_mindlin_%d.vtu", step);
    if (picture_vtu(folder, name, &grid, 6, field)) demo_stop("the picture cannot be written");
}

/* Every fifth cell of the three pushes and of the step back to no push, against the closed form. */
static void draw_shear(const char *folder, const contact *c, const step_result *found)
{
    static const int shown[SHOWN] = { 1, 2, 3, 5 };
    static const char *const name[SHOWN] = { "Q = .3 mu P", "Q = .6 mu P", "Q = .9 mu P", "back to Q = 0" };
    static double x[SHOWN * (CELLS + 1)], y[SHOWN * (CELLS + 1)], curve_x[SHOWN * SAMPLES], curve_y[SHOWN * SAMPLES];
    picture plot = { "Shear of two cylinders that are pushed along", "x / mm", "shear / (mu p0)", "computed",
                     "Cattaneo, Mindlin", 0, SHOWN * SAMPLES, x, y, curve_x, curve_y, name };

    for (int s = 0; s < SHOWN; s++) {
        for (int i = 2; i < CELLS; i += 5)
            if (fabs(c->x[i]) < 1.1 * HALF) x[plot.points] = c->x[i], y[plot.points++] = found[shown[s]].shear[i];
        x[plot.points] = y[plot.points] = NAN, plot.points++; /* the next points begin */
        for (int i = 0; i < SAMPLES; i++) {
            const double at = 1.1 * HALF * (2.0 * i / (SAMPLES - 2) - 1.0);
            curve_x[s * SAMPLES + i] = at, curve_y[s * SAMPLES + i] = mindlin(shown[s], at);
        }
        curve_x[s * SAMPLES + SAMPLES - 1] = curve_y[s * SAMPLES + SAMPLES - 1] = NAN; /* the next curve begins */
    }
    if (picture_svg(folder, "cattaneo_mindlin_shear.svg", &plot)) demo_stop("the picture cannot be written");
}

/* Push against shift: the steps, and the closed form from turn to turn. */
static void draw_loop(const char *folder, double unit, const step_result *found)
{
    static double x[STEPS], curve_x[3 * SAMPLES], curve_y[3 * SAMPLES];
    const picture plot = { "To and fro: the push against the shift of the cylinders", "shift / um", "push / (mu P)", "computed",
                           "Cattaneo, Mindlin", STEPS, 3 * SAMPLES, x, PART, curve_x, curve_y, NULL };

    for (int step = 0; step < STEPS; step++) x[step] = 1e3 * found[step].shift;
    for (int i = 0; i < SAMPLES; i++) {
        const double part = 0.9 * i / (SAMPLES - 1), turned = 0.9 * (1.0 - 2.0 * i / (SAMPLES - 1));
        const double back = shift_by(0.9) - 2.0 * shift_by((0.9 - turned) / 2.0);
        curve_x[i] = 1e3 * unit * shift_by(part), curve_y[i] = part;
        curve_x[SAMPLES + i] = 1e3 * unit * back, curve_y[SAMPLES + i] = turned;
        curve_x[2 * SAMPLES + i] = -1e3 * unit * back, curve_y[2 * SAMPLES + i] = -turned;
    }
    if (picture_svg(folder, "cattaneo_mindlin_loop.svg", &plot)) demo_stop("the picture cannot be written");
}

int main(int argc, char **argv)
{
    static step_result found[STEPS];
    const contact c = of_hertz();
    const double unit = MU * c.p0 / (0.5 * c.modulus); /* mm: mu p0 / E* */
    feti_problem *problem = NULL;
    feti_info info = { .struct_size = sizeof info };
    double sums = 0.0;
    int right = 1;

    CALL(feti_problem_create(&problem));
    CALL(feti_set_str(problem, "start", "previous")); /* each step begins from the forces of the last one */
    add_cylinders(problem, &c);
    add_pairs(problem, &c);
    for (int step = 0; step < STEPS; step++) {
        solve_step(problem, &c, step, &found[step], &info);
        right = right && info.status == FETI_OK && info.worst <= 1.0;
        sums = fmax(sums, found[step].sums);
    }
    CALL(feti_problem_destroy(&problem));

    demo_value("load P", c.load, "N/mm");
    demo_value("largest pressure p0", c.p0, "MPa");
    demo_value("half-width of contact, computed", found[0].pressed, "mm");
    for (int step = 1; step < TURN; step++) {
        const double relative = found[step].missed / found[step].size, width = half_width(PART[step]);
        printf("push %.1f mu P\n", PART[step]);
        demo_value("  error of the shear, rms", relative, "-");
        demo_value("  half-width that sticks", found[step].stuck, "mm");
        demo_value("  by hand", width, "mm");
        right = right && relative <= 2.5e-3 && fabs(found[step].stuck - width) <= c.cell;
    }
    printf("to and fro   error/(mu p0), rms    shift / um       by hand\n");
    for (int step = TURN; step < STEPS; step++) {
        printf("%10.2f%22.6f%14.6f%14.6f\n", PART[step], found[step].missed, 1e3 * found[step].shift, 1e3 * unit * shift(step));
        right = right && found[step].missed <= 5e-3 && fabs(found[step].shift - unit * shift(step)) <= 1e-4 * unit;
    }
    for (int step = 0; step < STEPS; step++) draw_step(demo_picture_folder(argc, argv), &c, step, &found[step]);
    if (picture_pvd(demo_picture_folder(argc, argv), "cattaneo_mindlin", STEPS)) demo_stop("the picture cannot be written");
    draw_shear(demo_picture_folder(argc, argv), &c, found);
    draw_loop(demo_picture_folder(argc, argv), unit, found);
    return demo_line("12_cattaneo_mindlin", &info, sums, right && fabs(found[0].pressed - HALF) <= c.cell);
}
