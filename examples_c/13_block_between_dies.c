/* 13 A block between two dies: only contact holds the block, and it turns by 60 degrees.

   The block, 20 x 10 mm with a round groove along its top and its bottom, is pressed by two round dies that lie in the
   grooves and then turn together about its middle. It is a mesh of quadrilaterals of St. Venant and Kirchhoff's material
   (Green's strain); the dies are rigid. As in example 08, the host iterates and the library solves each linear problem:

       min 1/2 d'K d - f'd   with   -n_i'd <= g_i,   f = -internal forces(u),   then u := u + d

   The library makes the rows from top and bottom of the block and from the circles, as in example 18.

   K is the complete second derivative, so that the iteration converges quadratically: stiffness of the material, stress term
   (geometric stiffness), and curvature of the dies under the forces of the last iterate, -lambda (I - n n')/r. The block
   is compressed, so the last two terms are negative on its rigid motions and make K indefinite. The rigid motions of the
   position where K was assembled are therefore given as soft motions, FETI_SOFT: the library computes their stiffness from K
   itself, and returns FETI_INDEFINITE if the closed rows do not hold them.

   A load step that returns FETI_INDEFINITE or takes more than MOST iterations is rejected: displacement and forces are
   restored and the step is halved. The first step of each stage is the whole stage; for the rotation it is deliberately too
   large.

   Known by hand: without friction the force of a round die passes through its axis. The block is in balance, so both
   forces lie on the line of the axes, equal and opposite. Because the dies turn together, the block has the shape and
   the forces that it had before the rotation, rotated by the angle of the dies. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "demo.h"
#include "picture.h"

enum { NX = 24, NY = 8, LINE = NY + 1, NODES = (NX + 1) * LINE, N = 2 * NODES, SIDE = NX + 1, ROWS = 2 * SIDE, MOST = 6 };
static const double YOUNG = 1000.0, POISSON = 0.3;              /* MPa, -; plane strain, 1 mm thick */
static const double WIDTH = 20.0, HEIGHT = 10.0, GROOVE = 12.0; /* mm; HEIGHT in the middle, GROOVE: radius of curvature */
static const double RADIUS[2] = { 6.0, 8.0 };                   /* mm, of the dies above and below */
static const double DEPTH = 1.0, TURN = 60.0;                   /* mm, degrees: the dies come closer, then they turn */
static const double LEAST = 0.01;                               /* of a stage: no step is smaller */
static const double DEGREE = 3.14159265358979323846 / 180.0;    /* rad */

/* Lower triangle of K by rows: node (i, j) has entries with the nodes left of it and below it, and with itself. */
typedef struct {
    int32_t ptr[N + 1], col[10 * N];
    double val[10 * N];
} matrix;

/* Where the dies are: mm, degrees. */
typedef struct {
    double depth, angle;
} place;

static int node_at(int i, int j)
{
    return i >= 0 && i <= NX && j >= 0 && j <= NY ? i * LINE + j : -1;
}

/* Position of a node at rest (u = NULL) or displaced, the middle of the block being the origin. */
static void position(const double *u, int node, double x[2])
{
    x[0] = WIDTH * ((double)(node / LINE) / NX - 0.5);
    x[1] = (HEIGHT + x[0] * x[0] / GROOVE) * ((double)(node % LINE) / NY - 0.5);
    for (int c = 0; u && c < 2; c++) x[c] += u[2 * node + c];
}

static void make_pattern(matrix *k)
{
    int32_t end = 0;

    for (int i = 0; i <= NX; i++)
        for (int j = 0; j <= NY; j++) {
            const int near[5] = { node_at(i - 1, j - 1), node_at(i - 1, j), node_at(i - 1, j + 1), node_at(i, j - 1),
                                  node_at(i, j) };
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

/* Adds one point of integration (s, t) of a quadrilateral. With the gradients g_a of the shape functions at rest and
   F = sum x_a g_a': Green's strain E = (F'F - I)/2, stress S = lame tr(E) I + 2 shear E, weight w,

       f_a = w F S g_a,   K_ab = w (lame F g_a (F g_b)' + shear (F g_b (F g_a)' + g_a'g_b F F') + g_a'S g_b I) */
static void add_point(const double *u, matrix *k, double *internal, const int node[4], double s, double t)
{
    static const double corner[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    const double shear = YOUNG / (2.0 * (1.0 + POISSON)), lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
    double g[4][2], jacobian[2][2] = { { 0 } }, F[2][2] = { { 0 } }, S[2][2], FF[2][2], Fg[4][2], x[2], w, trace;

    for (int a = 0; a < 4; a++) {
        const double slope[2] = { corner[a][0] * (1.0 + corner[a][1] * t) / 4.0,
                                  corner[a][1] * (1.0 + corner[a][0] * s) / 4.0 };
        position(NULL, node[a], x);
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) jacobian[c][d] += slope[c] * x[d];
        memcpy(g[a], slope, sizeof slope);
    }
    w = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
    for (int a = 0; a < 4; a++) {
        const double slope[2] = { g[a][0], g[a][1] };
        g[a][0] = (jacobian[1][1] * slope[0] - jacobian[0][1] * slope[1]) / w;
        g[a][1] = (jacobian[0][0] * slope[1] - jacobian[1][0] * slope[0]) / w;
        position(u, node[a], x);
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) F[c][d] += x[c] * g[a][d];
    }
    trace = (F[0][0] * F[0][0] + F[0][1] * F[0][1] + F[1][0] * F[1][0] + F[1][1] * F[1][1] - 2.0) / 2.0;
    for (int c = 0; c < 2; c++)
        for (int d = 0; d < 2; d++) {
            FF[c][d] = F[c][0] * F[d][0] + F[c][1] * F[d][1];
            S[c][d] = shear * (F[0][c] * F[0][d] + F[1][c] * F[1][d] - (c == d)) + (c == d) * lame * trace;
        }
    for (int a = 0; a < 4; a++)
        for (int c = 0; c < 2; c++) Fg[a][c] = F[c][0] * g[a][0] + F[c][1] * g[a][1];
    for (int a = 0; a < 4; a++) {
        const double Sg[2] = { S[0][0] * g[a][0] + S[0][1] * g[a][1], S[1][0] * g[a][0] + S[1][1] * g[a][1] };
        for (int c = 0; c < 2; c++) internal[2 * node[a] + c] += w * (F[c][0] * Sg[0] + F[c][1] * Sg[1]);
        for (int b = 0; b < 4; b++) {
            const double gg = g[a][0] * g[b][0] + g[a][1] * g[b][1], stress = Sg[0] * g[b][0] + Sg[1] * g[b][1];
            for (int c = 0; c < 2; c++)
                for (int d = 0; d < 2; d++)
                    add(k, 2 * node[a] + c, 2 * node[b] + d, w * (lame * Fg[a][c] * Fg[b][d]
                        + shear * (Fg[b][c] * Fg[a][d] + gg * FF[c][d]) + (c == d) * stress));
        }
    }
}

/* K and internal forces of the block at u. */
static void assemble(const double *u, matrix *k, double *internal)
{
    const double gauss = sqrt(1.0 / 3.0);

    memset(k->val, 0, sizeof k->val);
    memset(internal, 0, N * sizeof *internal);
    for (int i = 0; i < NX; i++)
        for (int j = 0; j < NY; j++) {
            const int node[4] = { node_at(i, j), node_at(i + 1, j), node_at(i + 1, j + 1), node_at(i, j + 1) };
            for (int p = 0; p < 4; p++) add_point(u, k, internal, node, p % 2 ? gauss : -gauss, p / 2 ? gauss : -gauss);
        }
}

/* Row r is about a node of the top (r < SIDE) or of the bottom: its node. */
static int node_of(int r)
{
    return node_at(r % SIDE, r < SIDE ? NY : 0);
}

/* Axis of the die above (0) or below (1). */
static void axis_of(const place *at, int die, double c[2])
{
    const double y = (die == 0 ? 1.0 : -1.0) * (HEIGHT / 2.0 + RADIUS[die] - at->depth / 2.0);

    c[0] = -sin(at->angle * DEGREE) * y, c[1] = cos(at->angle * DEGREE) * y;
}

/* Distance of the node of row r from the axis of its die; its direction n away from it. */
static double from_axis(const double *u, const place *at, int r, double n[2])
{
    double c[2], distance;

    axis_of(at, r / SIDE, c);
    position(u, node_of(r), n);
    n[0] -= c[0], n[1] -= c[1];
    distance = hypot(n[0], n[1]);
    n[0] /= distance, n[1] /= distance;
    return distance;
}

/* The forces of the rows bend with the normals: -lambda (I - n n') / r. */
static void add_curvature(const double *u, const double *lambda, const place *at, matrix *k)
{
    for (int r = 0; r < ROWS; r++) {
        double n[2];
        const double bend = lambda[r] / from_axis(u, at, r, n);
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) add(k, 2 * node_of(r) + c, 2 * node_of(r) + d, -bend * ((c == d) - n[c] * n[d]));
    }
}

/* Top and bottom of the block as surfaces, nodes in ascending order; the dies as circles. */
typedef struct {
    int64_t side[2], die[2];
} surfaces;

static void data_of(const place *at, int die, double data[3])
{
    axis_of(at, die, data);
    data[2] = RADIUS[die];
}

static void positions(const double *u, double *x)
{
    for (int node = 0; node < NODES; node++) position(u, node, x + 2 * node);
}

/* A contact row per node of top and bottom, in the order of node_of. In the plane the body is on the left of its faces. */
static void add_surfaces(feti_problem *problem, int64_t body, const place *at, surfaces *s)
{
    double x[N], data[3];
    int32_t dof[N], face[2 * NX];

    positions(NULL, x);
    for (int i = 0; i < N; i++) dof[i] = i;
    for (int r = 0; r < 2; r++) {
        for (int i = 0; i < NX; i++) {
            face[2 * i] = r == 0 ? node_at(i + 1, NY) : node_at(i, 0);
            face[2 * i + 1] = r == 0 ? node_at(i, NY) : node_at(i + 1, 0);
        }
        data_of(at, r, data);
        CALL(feti_surface_add_i32(problem, body, 2, NODES, x, 2, dof, 2, 0, &s->side[r]));
        CALL(feti_surface_faces_i32(problem, s->side[r], FETI_LINE2, NX, face, 0));
        CALL(feti_surface_rigid(problem, 2, FETI_SPHERE, data, &s->die[r]));
    }
    for (int r = 0; r < 2; r++) {
        int64_t pair;
        CALL(feti_pair_add(problem, s->side[r], s->die[r], FETI_NODE_TO_FACE, WIDTH, &pair, NULL));
    }
}

/* Rows where block and dies are now: -n_i'd <= g_i. */
static void find_rows(feti_problem *problem, const surfaces *s, const double *u, const place *at)
{
    double x[N], data[3];

    positions(u, x);
    for (int r = 0; r < 2; r++) {
        data_of(at, r, data);
        CALL(feti_surface_move(problem, s->side[r], x, 2));
        CALL(feti_surface_move(problem, s->die[r], data, 2));
    }
    CALL(feti_pairs_find(problem));
}

/* The rigid motions of the block where it is: two translations, and the rotation about the origin, (-y, x). */
static void give_motions(feti_problem *problem, const double *u)
{
    double motion[3 * N] = { 0.0 }, x[2];

    for (int node = 0; node < NODES; node++) {
        position(u, node, x);
        motion[2 * node] = motion[N + 2 * node + 1] = 1.0;
        motion[2 * N + 2 * node] = -x[1], motion[2 * N + 2 * node + 1] = x[0];
    }
    CALL(feti_body_null_space(problem, 0, 3, N, motion, N, FETI_SOFT));
}

static double largest(const double *x)
{
    double size = 0.0;

    for (int i = 0; i < N; i++) size = fmax(size, fabs(x[i]));
    return size;
}

/* What block and dies leave unbalanced, against the largest internal force, and depth of penetration against the height of
   the block: both zero in the solution. `force`: what each die does to the block, in N. */
static double unbalanced(matrix *k, const double *u, const double *lambda, const place *at, double force[2][2])
{
    double internal[N], inside = 0.0, size;

    assemble(u, k, internal);
    size = largest(internal);
    memset(force, 0, 2 * sizeof force[0]);
    for (int r = 0; r < ROWS; r++) {
        double n[2];
        inside = fmax(inside, RADIUS[r / SIDE] - from_axis(u, at, r, n));
        for (int c = 0; c < 2; c++) internal[2 * node_of(r) + c] -= lambda[r] * n[c], force[r / SIDE][c] += lambda[r] * n[c];
    }
    return fmax(largest(internal) / size, inside / HEIGHT);
}

/* A step of the film: the block, and what the dies do to its top and its bottom. */
static void draw(const char *folder, int step, const double *u, const double *lambda, const place *at)
{
    const double shear = YOUNG / (2.0 * (1.0 + POISSON)), lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
    double x[N], force[N] = { 0.0 }, push[NODES] = { 0.0 }, gap[NODES], state[NODES], n[2];
    int32_t corner[4 * NX * NY], *next = corner;
    const picture_plane plane = { NODES, NX * NY, NX * NY, corner, x, u, force, push, gap, state, shear, lame };

    positions(NULL, x);
    for (int a = 0; a < NODES; a++) {
        gap[a] = NAN, state[a] = -1.0;
        if (a / LINE < NX && a % LINE < NY) *next++ = a, *next++ = a + LINE, *next++ = a + LINE + 1, *next++ = a + 1;
    }
    for (int r = 0; r < ROWS; r++) {
        const int a = node_of(r);
        gap[a] = from_axis(u, at, r, n) - RADIUS[r / SIDE], push[a] = lambda[r], state[a] = push[a] > 0.0;
        for (int d = 0; d < 2; d++) force[2 * a + d] = push[a] * n[d];
    }
    if (picture_step(folder, "block_between_dies", step, &plane) != 0) demo_stop("the picture cannot be written");
}

/* What load steps took. */
typedef struct {
    int steps, rejected, most, quadratic;
} tally;

/* Newton's method for a place of the dies; prints a line per iteration. Returns FETI_OK, or the status of the library for a step
   that is too large, or FETI_ITERATIONS. Cleared: `quadratic`, where a change is more than twice its predecessor squared (mm),
   once that is below 1 mm. Less than 1e-9 is printed as 1e-9. */
static int32_t newton(feti_problem *problem, matrix *k, const surfaces *sides, const place *at, double *u, double *lambda,
                      feti_info *info, int *iterations, int *quadratic)
{
    double change = HUGE_VAL;

    for (*iterations = 1; *iterations <= MOST; ++*iterations) {
        double f[N], d[N], force[2][2], error;
        const double last = change;
        int32_t status;
        assemble(u, k, f);
        for (int i = 0; i < N; i++) f[i] = -f[i];
        add_curvature(u, lambda, at, k);
        CALL(feti_body_values(problem, 0, k->ptr[N], k->val));
        give_motions(problem, u);
        CALL(feti_body_load(problem, 0, N, f));
        find_rows(problem, sides, u, at);
        CALL(feti_start_from(problem, FETI_INEQUALITY, ROWS, lambda)); /* the pairs are those of the last iterate */
        status = feti_solve(problem, info);
        if (status != FETI_OK) {
            printf("%5d %31s  %s\n", *iterations, "", feti_status_name(status));
            return status;
        }
        CALL(feti_displacement(problem, 0, N, d));
        CALL(feti_multipliers(problem, FETI_INEQUALITY, ROWS, lambda));
        for (int i = 0; i < N; i++) u[i] += d[i];
        change = largest(d);
        error = unbalanced(k, u, lambda, at, force);
        printf("%5d %12.1e %11.1e %6d  %s\n", *iterations, fmax(change, 1e-9), fmax(error, 1e-9), (int)info->active,
               feti_status_name(status));
        if (last < 1.0 && change > 2.0 * last * last + 1e-10) *quadratic = 0;
        if (change < 1e-6) return FETI_OK;
    }
    return FETI_ITERATIONS;
}

/* A stage: the dies go from a place to another by load steps, halved where one fails. Returns 1 when they are there. */
static int go(feti_problem *problem, matrix *k, const surfaces *sides, place from, place to, const char *folder, double *u,
              double *lambda, feti_info *info, tally *sum)
{
    double done = 0.0, step = 1.0, saved_u[N], saved_lambda[ROWS];

    while (done < 1.0 && step >= LEAST) {
        const double part = done + step;
        const place at = { from.depth + part * (to.depth - from.depth), from.angle + part * (to.angle - from.angle) };
        int iterations, quadratic = 1;
        memcpy(saved_u, u, sizeof saved_u);
        memcpy(saved_lambda, lambda, sizeof saved_lambda);
        printf("depth %.4f mm, angle %7.4f degrees\n", at.depth, at.angle);
        printf("           |d| / mm  unbalanced closed  status\n");
        if (newton(problem, k, sides, &at, u, lambda, info, &iterations, &quadratic) == FETI_OK) {
            draw(folder, sum->steps, u, lambda, &at);
            done += step, sum->steps++;
            sum->most = iterations > sum->most ? iterations : sum->most;
            sum->quadratic = sum->quadratic && quadratic;
        } else {
            printf("rejected, halved\n");
            memcpy(u, saved_u, sizeof saved_u);
            memcpy(lambda, saved_lambda, sizeof saved_lambda);
            step /= 2.0, sum->rejected++;
        }
    }
    return done >= 1.0;
}

/* How far the block is from having turned as one by the angle, against its width. */
static double not_turned(const double *u, const double *pressed, double angle)
{
    const double c = cos(angle * DEGREE), s = sin(angle * DEGREE);
    double worst = 0.0, x[2], y[2];

    for (int node = 0; node < NODES; node++) {
        position(u, node, x);
        position(pressed, node, y);
        worst = fmax(worst, hypot(x[0] - (c * y[0] - s * y[1]), x[1] - (s * y[0] + c * y[1])));
    }
    return worst / WIDTH;
}

int main(int argc, char **argv)
{
    const char *folder = demo_picture_folder(argc, argv);
    static matrix k;
    const place start = { 0.0, 0.0 }, closed = { DEPTH, 0.0 }, turned = { DEPTH, TURN };
    double u[N] = { 0.0 }, pressed[N], lambda[ROWS] = { 0.0 }, before[ROWS], force[2][2], error, size, axis[2], length;
    feti_problem *problem = NULL;
    feti_info info = { .struct_size = sizeof info };
    tally sum = { 0, 0, 0, 1 };
    surfaces sides;
    int64_t body;
    int right;

    make_pattern(&k);
    assemble(u, &k, pressed);
    CALL(feti_problem_create(&problem));
    CALL(feti_body_add(problem, N, &body));
    CALL(feti_body_stiffness_i32(problem, body, N, k.ptr, k.col, k.val, 0, FETI_LOWER, FETI_COPY));
    add_surfaces(problem, body, &start, &sides);
    right = go(problem, &k, &sides, start, closed, folder, u, lambda, &info, &sum);
    memcpy(pressed, u, sizeof u);
    memcpy(before, lambda, sizeof lambda);
    right = right && go(problem, &k, &sides, closed, turned, folder, u, lambda, &info, &sum);
    CALL(feti_problem_destroy(&problem));

    error = unbalanced(&k, u, lambda, &turned, force);
    size = hypot(force[0][0], force[0][1]);
    axis_of(&turned, 0, axis);
    error = fmax(error, hypot(force[0][0] + force[1][0], force[0][1] + force[1][1]) / size);
    length = hypot(axis[0], axis[1]);
    error = fmax(error, hypot(force[0][0] / size + axis[0] / length, force[0][1] / size + axis[1] / length));
    error = fmax(error, fmax(not_turned(u, pressed, TURN), demo_error(ROWS, lambda, before)));
    if (picture_pvd(folder, "block_between_dies", sum.steps) != 0) demo_stop("the film cannot be written");
    demo_value("load steps", sum.steps, "-");
    demo_value("rejected load steps", sum.rejected, "-");
    demo_value("most iterations of a load step", sum.most, "-");
    demo_value("force of either die", size, "N");
    demo_value("its angle against the first", atan2(force[0][0], -force[0][1]) / DEGREE, "degrees");
    return demo_line("13_block_between_dies", &info, error, right && sum.quadratic && sum.rejected > 0);
}
