/* 08 A Newton loop: a strip of bars is pressed down by a round die, with large displacements.

   The strip is a lattice of 24 x 4 cells of 1 mm with clamped ends. The bars have stiffness EA and Green strain, so
   that the tangent K(u) changes with the displacement. The die, a cylinder of radius 10 mm, comes from above: the
   normals of the contact rows also change with the displacement. The host iterates, and the library solves each linear
   problem with contact:

       min 1/2 d'K d - f'd   with   -n_i'd <= g_i,   f = -internal forces(u),   then u := u + d

   K includes the curvature of the die under the forces of the last iterate, -lambda (I - n n')/r; with this term the iteration
   converges quadratically.

   1. Small displacements: K is constant, only normals change. All iterations together need one factorisation.
   2. Large displacements: feti_body_values passes K on its old pattern. Each iteration needs one factorisation, no analysis.
   3. A load step that fails is rejected: feti_state_restore restores rows, gaps and forces, and the step is halved. A step
      smaller than LEAST ends the program: at a limit load no step is small enough.
   4. Large displacements with friction. The slip function of a node is s = RADIUS times its angle about the axis of the die;
      its tangential row is the gradient T = RADIUS/r t', t perpendicular to n. In every iteration the host passes s_begin -
      s(u), minus the slip since the load step began, to feti_friction_reference. K includes the rotation of the tangential
      forces, -lambda_t RADIUS/r^2 (n t' + t n'). This part ends at 6 mm: close to 8 mm bars that friction compresses buckle,
      and K is indefinite however small the step. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "demo.h"
#include "picture.h"

enum { NX = 24, NY = 4, LINE = NY + 1, NODES = (NX - 1) * LINE, N = 2 * NODES, ROWS = NX - 1, MOST = 8 };
static const double EA = 1000.0 /* N */, RADIUS = 10.0 /* mm */, DEPTH = 8.0 /* mm */, LEAST = 0.01 /* mm */;
static const double MU = 0.3 /* - */, LESS = 6.0 /* mm, the depth with friction */;

/* Lower triangle of K by rows: node (i, j) has entries with the nodes left of it and below it, and with itself. */
typedef struct {
    int32_t ptr[N + 1], col[10 * N];
    double val[10 * N];
} matrix;

/* Free node (i, j), 0 < i < NX, among all; its unknowns are 2 node and 2 node + 1. */
static int node_at(int i, int j)
{
    return i > 0 && i < NX && j >= 0 && j <= NY ? (i - 1) * LINE + j : -1;
}

static void make_pattern(matrix *k)
{
    int32_t end = 0;

    for (int i = 1; i < NX; i++)
        for (int j = 0; j <= NY; j++) {
            const int near[5] = { node_at(i - 1, j - 1), node_at(i - 1, j), node_at(i - 1, j + 1), node_at(i, j - 1), node_at(i, j) };
            for (int d = 0; d < 2; d++) {
                k->ptr[2 * near[4] + d] = end;
                for (int b = 0; b < 5; b++)
                    for (int e = 0; near[b] >= 0 && e < 2; e++)
                        if (b < 4 || e <= d) k->col[end++] = 2 * near[b] + e;
            }
        }
    k->ptr[N] = end;
}

static void add(matrix *k, int row, int col, double value)
{
    if (col > row) return;
    for (int32_t at = k->ptr[row]; at < k->ptr[row + 1]; at++)
        if (k->col[at] == col) k->val[at] += value;
}

/* Adds a bar: Green strain e = (l^2 - L^2) / (2 L^2), force density q = EA e / L; the internal forces are q x per end,
   the tangent EA/L^3 x x' + q I, x from end to end in the deformed strip. */
static void add_bar(const double *u, matrix *k, double *internal, int i, int j, int i2, int j2)
{
    const int a = node_at(i, j), b = node_at(i2, j2);
    const double X[2] = { i2 - i, j2 - j }, length = hypot(X[0], X[1]);
    double x[2], e, q;

    if (j2 < 0 || j2 > NY || (a < 0 && b < 0)) return;
    for (int d = 0; d < 2; d++) x[d] = X[d] + (b < 0 ? 0.0 : u[2 * b + d]) - (a < 0 ? 0.0 : u[2 * a + d]);
    e = (x[0] * x[0] + x[1] * x[1] - length * length) / (2.0 * length * length);
    q = EA * e / length;
    for (int c = 0; c < 2; c++) {
        if (a >= 0) internal[2 * a + c] -= q * x[c];
        if (b >= 0) internal[2 * b + c] += q * x[c];
        for (int d = 0; d < 2; d++) {
            const double value = EA / pow(length, 3) * x[c] * x[d] + (c == d ? q : 0.0);
            if (a >= 0) add(k, 2 * a + c, 2 * a + d, value);
            if (b >= 0) add(k, 2 * b + c, 2 * b + d, value);
            if (a >= 0 && b >= 0) {
                add(k, 2 * a + c, 2 * b + d, -value);
                add(k, 2 * b + c, 2 * a + d, -value);
            }
        }
    }
}

/* K and internal forces of the bars at u. */
static void assemble(const double *u, matrix *k, double *internal)
{
    memset(k->val, 0, sizeof k->val);
    memset(internal, 0, N * sizeof *internal);
    for (int i = 0; i < NX; i++)
        for (int j = 0; j <= NY; j++) {
            add_bar(u, k, internal, i, j, i + 1, j);
            add_bar(u, k, internal, i, j, i + 1, j + 1);
            add_bar(u, k, internal, i, j, i + 1, j - 1);
            if (i > 0) add_bar(u, k, internal, i, j, i, j + 1);
        }
}

/* Distance of top node i from the axis of the die; its direction n away from it. */
static double from_axis(const double *u, double depth, int i, double n[2])
{
    const double *v = u + 2 * node_at(i, NY);
    const double x = i + v[0] - NX / 2.0, y = v[1] - RADIUS + depth, r = hypot(x, y);

    n[0] = x / r, n[1] = y / r;
    return r;
}

/* Friction data of the loop: without friction mu and the forces are 0. Slips are RADIUS times an angle, mm. */
typedef struct {
    double mu, lambda_t[ROWS], s_begin[ROWS];
} friction;

/* Slip function of top node i; its direction t, and r. */
static double slip_function(const double *u, double depth, int i, double t[2], double *r)
{
    double n[2];

    *r = from_axis(u, depth, i, n);
    t[0] = -n[1], t[1] = n[0];
    return RADIUS * atan2(n[1], n[0]);
}

/* The forces of the rows turn with normals and tangents: -lambda/r t t' - lambda_t RADIUS/r^2 (n t' + t n'). */
static void add_curvature(const double *u, const double *lambda, const friction *rub, double depth, matrix *k)
{
    for (int i = 1; i < NX; i++) {
        const int dof = 2 * node_at(i, NY);
        double n[2];
        const double r = from_axis(u, depth, i, n), t[2] = { -n[1], n[0] };
        const double bend = lambda[i - 1] / r, turn = rub->lambda_t[i - 1] * RADIUS / (r * r);
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) add(k, dof + c, dof + d, -bend * t[c] * t[d] - turn * (n[c] * t[d] + t[c] * n[d]));
    }
}

/* A row per top node: it moves no further towards the axis than its distance allows. `from` is the displacement that the
   unknowns are counted from. */
static void give_rows(feti_problem *problem, const double *u, const double *from, double depth)
{
    int32_t ptr[ROWS + 1], dof[2 * ROWS];
    double val[2 * ROWS], gap[ROWS];

    for (int i = 1; i < NX; i++) {
        const int at = 2 * (i - 1), top = 2 * node_at(i, NY);
        double n[2];
        gap[i - 1] = from_axis(u, depth, i, n) - RADIUS;
        ptr[i - 1] = at;
        for (int d = 0; d < 2; d++) {
            dof[at + d] = top + d, val[at + d] = -n[d];
            gap[i - 1] += -n[d] * (u[top + d] - from[top + d]);
        }
    }
    ptr[ROWS] = 2 * ROWS;
    CALL(feti_rows_clear(problem, FETI_INEQUALITY));
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, ROWS, ptr, NULL, dof, val, 0, gap, NULL));
}

/* A tangential row beside each contact row, and what has slipped in this load step before u. */
static void give_friction(feti_problem *problem, const double *u, const friction *rub, double depth)
{
    int32_t row[ROWS], ptr[ROWS + 1], dof[2 * ROWS];
    double val[2 * ROWS], coefficient[ROWS], s_old[ROWS];

    for (int i = 1; i < NX; i++) {
        const int at = 2 * (i - 1);
        double t[2], r;
        s_old[i - 1] = rub->s_begin[i - 1] - slip_function(u, depth, i, t, &r);
        row[i - 1] = i - 1, ptr[i - 1] = at, coefficient[i - 1] = rub->mu;
        for (int d = 0; d < 2; d++) dof[at + d] = 2 * node_at(i, NY) + d, val[at + d] = RADIUS / r * t[d];
    }
    ptr[ROWS] = 2 * ROWS;
    CALL(feti_friction_add_i32(problem, ROWS, 1, row, ptr, NULL, dof, val, 0, coefficient, NULL, NULL));
    CALL(feti_friction_reference(problem, 0, ROWS, 1, s_old));
}

static double largest(const double *x)
{
    double size = 0.0;

    for (int i = 0; i < N; i++) size = fmax(size, fabs(x[i]));
    return size;
}

/* What a loop cost: feti_info counts what the problem has done in all. */
typedef struct {
    int iterations, factorisations, analyses;
} cost;

static void add_cost(cost *sum, const feti_info *info, const feti_info *before)
{
    sum->iterations++;
    sum->factorisations += (int)(info->factorisations - before->factorisations);
    sum->analyses += (int)(info->analyses - before->analyses);
}

/* Small displacements: K of the unloaded strip stays, the unknown is u itself. */
static cost with_fixed_tangent(feti_problem *problem, double depth, double *u, feti_info *info)
{
    const double zero[N] = { 0.0 };
    cost sum = { 0, 0, 0 };
    double change = 1.0;

    while (change > 1e-9 && sum.iterations < 30) {
        const feti_info before = *info;
        double next[N];
        give_rows(problem, u, zero, depth);
        CALL(feti_solve(problem, info));
        CALL(feti_displacement(problem, 0, N, next));
        for (int i = 0; i < N; i++) u[i] = next[i] - u[i];
        change = largest(u);
        memcpy(u, next, sizeof next);
        add_cost(&sum, info, &before);
    }
    return sum;
}

/* Newton's method at a depth of the die. Returns FETI_OK, the status of the library for a step that is too large, or
   FETI_ITERATIONS. `quadratic`: no change was more than its predecessor squared, once that was small. */
static int32_t newton(feti_problem *problem, matrix *k, double depth, double *u, double *lambda, friction *rub, cost *sum,
                      feti_info *info, int *quadratic)
{
    double change = 1.0;

    memset(sum, 0, sizeof *sum);
    *quadratic = 1;
    while (sum->iterations < MOST) {
        double f[N], d[N];
        const double last = change;
        const feti_info before = *info;
        assemble(u, k, f);
        for (int i = 0; i < N; i++) f[i] = -f[i];
        add_curvature(u, lambda, rub, depth, k);
        CALL(feti_body_values(problem, 0, k->ptr[N], k->val));
        CALL(feti_body_load(problem, 0, N, f));
        give_rows(problem, u, u, depth);
        if (rub->mu > 0.0) {
            give_friction(problem, u, rub, depth);
            CALL(feti_start_from(problem, FETI_TANGENTIAL, ROWS, rub->lambda_t));
        }
        CALL(feti_start_from(problem, FETI_INEQUALITY, ROWS, lambda)); /* the pairs are those of the last iterate */
        const int32_t status = feti_solve(problem, info); /* FETI_INDEFINITE: the step is too large */
        if (status < 0) *info = before; /* the counts of a call that failed are zero */
        add_cost(sum, info, &before);
        if (status != FETI_OK) return status;
        CALL(feti_displacement(problem, 0, N, d));
        CALL(feti_multipliers(problem, FETI_INEQUALITY, ROWS, lambda));
        if (rub->mu > 0.0) CALL(feti_multipliers(problem, FETI_TANGENTIAL, ROWS, rub->lambda_t));
        for (int i = 0; i < N; i++) u[i] += d[i];
        change = largest(d);
        if (rub->mu > 0.0)
            printf("%5d %12.1e %9d %9d\n", sum->iterations, fmax(change, 1e-9), (int)info->sticking, (int)info->slipping);
        if (last < 1e-2 && change > 10.0 * last * last + 1e-12) *quadratic = 0;
        if (change < 1e-6) return FETI_OK;
    }
    return FETI_ITERATIONS;
}

/* Largest force that the bars and the die leave unbalanced, and depth of penetration: both zero in the solution. */
static double unbalanced(matrix *k, const double *u, const double *lambda, const friction *rub, double depth, double *force)
{
    double internal[N], inside = 0.0, size;

    assemble(u, k, internal);
    size = largest(internal);
    *force = 0.0;
    for (int i = 1; i < NX; i++) {
        const int top = 2 * node_at(i, NY);
        double n[2];
        const double r = from_axis(u, depth, i, n), t[2] = { -n[1], n[0] };
        inside = fmax(inside, RADIUS - r);
        for (int d = 0; d < 2; d++) {
            const double on_node = lambda[i - 1] * n[d] - rub->lambda_t[i - 1] * RADIUS / r * t[d];
            internal[top + d] -= on_node;
            if (d == 1) *force -= on_node;
        }
    }
    return fmax(largest(internal) / size, inside / RADIUS);
}

/* A step of the film: the cells of the lattice with its clamped ends, and what the die does to the top. */
static void draw(const char *folder, int step, const double *u, const double *lambda, double depth)
{
    enum { ALL = (NX + 1) * LINE, CELLS = NX * NY };
    double x[2 * ALL], moved[2 * ALL] = { 0.0 }, force[2 * ALL] = { 0.0 }, push[ALL] = { 0.0 }, gap[ALL], state[ALL], n[2];
    int32_t corner[4 * CELLS], *next = corner;
    const picture_plane plane = { ALL, CELLS, CELLS, corner, x, moved, force, push, gap, state, 0.0, 0.0 };

    for (int a = 0; a < ALL; a++) {
        const int i = a / LINE, j = a % LINE, node = node_at(i, j);
        x[2 * a] = i, x[2 * a + 1] = j, gap[a] = NAN, state[a] = -1.0;
        if (i < NX && j < NY) *next++ = a, *next++ = a + LINE, *next++ = a + LINE + 1, *next++ = a + 1;
        if (node < 0) continue;
        for (int d = 0; d < 2; d++) moved[2 * a + d] = u[2 * node + d];
        if (j < NY) continue;
        gap[a] = from_axis(u, depth, i, n) - RADIUS, push[a] = lambda[i - 1], state[a] = push[a] > 0.0;
        for (int d = 0; d < 2; d++) force[2 * a + d] = push[a] * n[d];
    }
    if (picture_step(folder, "newton_loop", step, &plane) != 0) demo_stop("the picture cannot be written");
}

/* Presses the strip to a depth by load steps, halved where one fails; prints a line for each, and draws it where there is a folder. What is left unbalanced. */
static double press(feti_problem *problem, matrix *k, double to, friction *rub, const char *folder, feti_info *info, double *force,
                    int *right)
{
    double u[N] = { 0.0 }, lambda[ROWS] = { 0.0 }, saved_u[N], saved_lambda[ROWS], depth = 0.0, step = to;
    int steps = 0, rejected = 0, quadratic;
    friction saved_rub;
    int64_t state;
    cost sum;

    CALL(feti_body_load(problem, 0, N, u));
    give_rows(problem, u, u, 0.0);
    while (depth < to && step >= LEAST) {
        int32_t status;
        for (int i = 1; i < NX; i++) {
            double t[2], r;
            rub->s_begin[i - 1] = slip_function(u, depth, i, t, &r);
        }
        CALL(feti_state_save(problem, &state));
        memcpy(saved_u, u, sizeof u);
        memcpy(saved_lambda, lambda, sizeof lambda);
        saved_rub = *rub;
        status = newton(problem, k, depth + step, u, lambda, rub, &sum, info, &quadratic);
        if (status == FETI_OK) {
            depth += step;
            if (folder) draw(folder, steps, u, lambda, depth);
            steps++;
            *right = *right && quadratic && sum.factorisations == sum.iterations && sum.analyses == 0;
            unbalanced(k, u, lambda, rub, depth, force);
            printf("step to %.4f mm: %d iterations, %d factorisations, %d analyses, force %.4f N\n", depth, sum.iterations,
                   sum.factorisations, sum.analyses, *force);
        } else {
            printf("step to %.4f mm: %s after %d iterations, halved\n", depth + step, feti_status_name(status), sum.iterations);
            CALL(feti_state_restore(problem, state));
            memcpy(u, saved_u, sizeof u);
            memcpy(lambda, saved_lambda, sizeof lambda);
            *rub = saved_rub;
            step /= 2.0, rejected++;
        }
        CALL(feti_state_drop(problem, state));
    }
    if (folder && picture_pvd(folder, "newton_loop", steps) != 0) demo_stop("the film cannot be written");
    demo_value("load steps", steps, "-");
    demo_value("rejected load steps", rejected, "-");
    *right = *right && depth == to;
    return unbalanced(k, u, lambda, rub, depth, force);
}

int main(int argc, char **argv)
{
    static matrix k;
    double u[N] = { 0.0 }, f[N], force, error;
    friction none = { .mu = 0.0 }, rub = { .mu = MU };
    feti_problem *problem = NULL;
    feti_info info = { .struct_size = sizeof info };
    cost sum;
    int64_t body;
    int right = 1;

    make_pattern(&k);
    assemble(u, &k, f);
    CALL(feti_problem_create(&problem));
    CALL(feti_body_add(problem, N, &body));
    CALL(feti_body_stiffness_i32(problem, body, N, k.ptr, k.col, k.val, 0, FETI_LOWER, FETI_COPY));
    CALL(feti_body_no_null_space(problem, body)); /* the ends are clamped */

    sum = with_fixed_tangent(problem, 1.0, u, &info);
    demo_value("small displacements, iterations", sum.iterations, "-");
    demo_value("  factorisations", sum.factorisations, "-");
    demo_value("  analyses", sum.analyses, "-");
    right = right && sum.factorisations == 1 && sum.analyses == 1;

    error = press(problem, &k, DEPTH, &none, demo_picture_folder(argc, argv), &info, &force, &right);
    demo_value("force on the die", force, "N");
    printf("with friction: iteration, |d| / mm, nodes that stick, that slip\n");
    error = fmax(error, press(problem, &k, LESS, &rub, NULL, &info, &force, &right));
    demo_value("force on the die", force, "N");
    demo_value("nodes that stick", (double)info.sticking, "-");
    demo_value("nodes that slip", (double)info.slipping, "-");
    CALL(feti_problem_destroy(&problem));
    return demo_line("08_newton_loop", &info, error, right);
}
