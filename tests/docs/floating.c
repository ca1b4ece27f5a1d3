/* What docs/newton.md says about bodies that float: a lattice of bars with Green's strain stands on a flat floor, tilted at
   first, and is pressed down. With its rigid motions as soft ones, given or made of the
   current coordinates, the whole tangent converges in six iterations, quadratically; with coordinates as candidates, or nothing, it is refused as indefinite. Its material part alone converges with the current coordinates and without,
   the whole tangent with a multiple of the diagonal: in no case with a second analysis. The first coordinates serve as well, but
   once the body has turned its null space is sought in K, at the cost of analyses. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <feti_contact.h>

enum { NX = 6, NY = 4, LINE = NY + 1, NODES = (NX + 1) * LINE, N = 2 * NODES, MOST = 40 };
enum { NOTHING, CURRENT, FIRST, SOFT, PLACED }; /* coordinates that the library gets, or soft motions, or coordinates of such */
static const double EA = 1000.0 /* N */, FORCE = 2.0 /* N per node */, TILT = 0.3 /* rad */;

typedef struct {
    int stress, coordinates; /* the stress term is in K; which coordinates are given */
    double shift;            /* multiple of the diagonal added */
} way;

static double K[N][N], inside[N], u[N];
static int iterations;

static int near(int a, int b) { return abs(a / LINE - b / LINE) < 2 && abs(a % LINE - b % LINE) < 2; }

static void add_bar(int a, int b, int stress)
{
    const double X[2] = { b / LINE - a / LINE, b % LINE - a % LINE }, length = hypot(X[0], X[1]);
    double x[2], q;

    for (int d = 0; d < 2; d++) x[d] = X[d] + u[2 * b + d] - u[2 * a + d];
    q = EA * (x[0] * x[0] + x[1] * x[1] - length * length) / (2.0 * pow(length, 3));
    for (int c = 0; c < 2; c++) {
        inside[2 * a + c] -= q * x[c], inside[2 * b + c] += q * x[c];
        for (int d = 0; d < 2; d++) {
            const double value = EA / pow(length, 3) * x[c] * x[d] + (stress && c == d ? q : 0.0);
            K[2 * a + c][2 * a + d] += value, K[2 * b + c][2 * b + d] += value;
            K[2 * a + c][2 * b + d] -= value, K[2 * b + c][2 * a + d] -= value;
        }
    }
}

/* K in the lower triangle of couplings between neighbours; returns the entries. */
static int assemble(const way *w, int32_t *ptr, int32_t *col, double *val)
{
    int entries = 0;

    memset(K, 0, sizeof K), memset(inside, 0, sizeof inside);
    for (int a = 0; a < NODES; a++)
        for (int b = a + 1; b < NODES; b++)
            if (near(a, b)) add_bar(a, b, w->stress);
    for (int i = 0; i < N; i++) {
        ptr[i] = entries;
        for (int j = 0; j <= i; j++)
            if (near(i / 2, j / 2)) col[entries] = j, val[entries++] = K[i][j] * (i == j ? 1.0 + w->shift : 1.0);
    }
    ptr[N] = entries;
    return entries;
}

static int32_t give_motions(feti_problem *p)
{
    double motion[3 * N] = { 0.0 };

    for (int k = 0; k < NODES; k++) {
        motion[2 * k] = motion[N + 2 * k + 1] = 1.0;
        motion[2 * N + 2 * k] = -(k % LINE + u[2 * k + 1]);
        motion[2 * N + 2 * k + 1] = k / LINE + u[2 * k];
    }
    return feti_body_null_space(p, 0, 3, N, motion, N, FETI_SOFT);
}

static int32_t give_coordinates(feti_problem *p, const way *w)
{
    int32_t node[N], dir[N];
    double xyz[2 * N];

    for (int i = 0; i < N; i++) {
        const int k = i / 2;
        node[i] = k, dir[i] = 1 + i % 2;
        xyz[2 * i] = k / LINE + (w->coordinates != FIRST ? u[2 * k] : 0.0);
        xyz[2 * i + 1] = k % LINE + (w->coordinates != FIRST ? u[2 * k + 1] : 0.0);
    }
    return feti_body_coordinates(p, 0, 2, N, node, dir, xyz, 2);
}

static int32_t give_rows_and_load(feti_problem *p)
{
    int32_t ptr[NODES + 1], dof[NODES];
    double val[NODES], gap[NODES], f[N];

    for (int k = 0; k <= NODES; k++) ptr[k] = k;
    for (int k = 0; k < NODES; k++) dof[k] = 2 * k + 1, val[k] = -1.0, gap[k] = k % LINE + u[2 * k + 1];
    for (int i = 0; i < N; i++) f[i] = (i % 2 == 1 && i / 2 % LINE == NY ? -FORCE * (1.0 + 0.1 * (i / 2 / LINE)) : 0.0) - inside[i];
    if (feti_body_load(p, 0, N, f) != FETI_OK || feti_rows_clear(p, FETI_INEQUALITY) != FETI_OK) return FETI_STATE;
    return feti_rows_add_i32(p, FETI_INEQUALITY, NODES, ptr, NULL, dof, val, 0, gap, NULL);
}

/* The status that ends Newton's method, FETI_ITERATIONS without convergence. */
static int32_t newton(const way *w, feti_info *info)
{
    static int32_t ptr[N + 1], col[N * N];
    static double val[N * N];
    feti_problem *p = NULL;
    double d[N], change = 1.0;
    int32_t status;
    int64_t body;

    for (int k = 0; k < NODES; k++) {
        u[2 * k] = (cos(TILT) - 1.0) * (k / LINE) - sin(TILT) * (k % LINE);
        u[2 * k + 1] = sin(TILT) * (k / LINE) + (cos(TILT) - 1.0) * (k % LINE);
    }
    if (feti_problem_create(&p) != FETI_OK || feti_body_add(p, N, &body) != FETI_OK) return FETI_STATE;
    assemble(w, ptr, col, val);
    status = feti_body_stiffness_i32(p, 0, N, ptr, col, val, 0, FETI_LOWER, FETI_COPY);
    if (status == FETI_OK && w->coordinates == PLACED) status = feti_body_coordinates_flags(p, 0, FETI_SOFT);
    for (iterations = 0; iterations < MOST && status == FETI_OK && change > 1e-9; iterations++) {
        status = feti_body_values(p, 0, assemble(w, ptr, col, val), val);
        if (status == FETI_OK && w->coordinates == SOFT) status = give_motions(p);
        if (status == FETI_OK && w->coordinates != SOFT && w->coordinates != NOTHING) status = give_coordinates(p, w);
        if (status == FETI_OK) status = give_rows_and_load(p);
        if (status == FETI_OK) status = feti_solve(p, info);
        if (status == FETI_OK) status = feti_displacement(p, 0, N, d);
        change = 0.0;
        for (int i = 0; i < N && status == FETI_OK; i++) u[i] += d[i], change = fmax(change, fabs(d[i]));
    }
    feti_problem_destroy(&p);
    return status == FETI_OK && change > 1e-9 ? FETI_ITERATIONS : status;
}

int main(void)
{
    static const struct { way w; int32_t status; } cases[] = {
        { { 1, SOFT, 0.0 }, FETI_OK },            { { 1, PLACED, 0.0 }, FETI_OK },
        { { 1, CURRENT, 0.0 }, FETI_INDEFINITE }, { { 1, NOTHING, 0.0 }, FETI_INDEFINITE }, { { 0, CURRENT, 0.0 }, FETI_OK },
        { { 0, NOTHING, 0.0 }, FETI_OK },         { { 0, FIRST, 0.0 }, FETI_OK },            { { 1, NOTHING, 1e-3 }, FETI_OK },
    };
    int wrong = 0;

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        feti_info info = { .struct_size = sizeof info };
        const int32_t status = newton(&cases[k].w, &info);
        const int is_wrong = status != cases[k].status || ((cases[k].w.coordinates == SOFT || cases[k].w.coordinates == PLACED) && iterations > 6)
            || (status == FETI_OK && (info.analyses > 1) != (cases[k].w.coordinates == FIRST));
        printf("case %d: %s, %d iterations, %d analyses%s\n", (int)k, feti_status_name(status), iterations, (int)info.analyses,
               is_wrong ? ": wrong" : "");
        wrong = wrong || is_wrong;
    }
    return wrong;
}
