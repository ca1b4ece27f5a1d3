/* 06 Two blocks, cut into squares: the secondary decomposition (11) of the paper.

   A block of 2 m x 1 m is clamped to the ground, a block of 2 m x 2 m lies on it and floats (plane strain,
   E = 1e4 MN/m^2, nu = .25, 1 m thick); the top of the lower block is slightly hollow. 1 MN/m presses on the
   left part of the upper block, so that the contact opens on the right.

   The example solves the problem twice: as two bodies, and as six squares with equal matrices. Equality rows H u = 0 join the
   copies of a node; their multipliers may have any sign. At a node where four squares meet, all six pairs are joined, more
   than needed: redundant rows are allowed. Both solutions have equal contact forces.

   The clamp is also given by equality rows, and so is one node that keeps the upper block from sliding. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "demo.h"

enum { N = 6 /* elements along 1 m */, LINE = 2 * N + 1 /* nodes along 2 m */, SQUARES = 6, COPIES = 4 };

/* A rectangle of elements: its first node on the common grid, elements along x and y. Node (i, j) of it carries the
   unknowns 2 (i (ny + 1) + j) and the next. */
typedef struct {
    int i0, j0, nx, ny;
} rectangle;

static const rectangle WHOLE[2] = { { 0, 0, 2 * N, N }, { 0, N, 2 * N, 2 * N } };
static const rectangle CUT[SQUARES] = { { 0, 0, N, N }, { N, 0, N, N },
                                        { 0, N, N, N }, { N, N, N, N }, { 0, 2 * N, N, N }, { N, 2 * N, N, N } };

/* Unknown along x of node (i, j) of the grid in the rectangle, -1 where the node lies elsewhere. */
static int64_t unknown(const rectangle *r, int i, int j)
{
    const int k = i - r->i0, l = j - r->j0;
    return k < 0 || l < 0 || k > r->nx || l > r->ny ? -1 : 2 * (k * (r->ny + 1) + l);
}

/* Stiffness of a square element, plane strain, 8 x 8, 2 x 2 Gauss points, independent of the size. Corners (0,0),
   (1,0), (0,1), (1,1). */
static void element(double k[8][8])
{
    const double young = 1e4, nu = 0.25, mu = young / (2.0 * (1.0 + nu)), la = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));

    for (int p = 0; p < 8; p++)
        for (int q = 0; q < 8; q++) k[p][q] = 0.0;
    for (int point = 0; point < 4; point++) {
        double g[4][2];
        for (int c = 0; c < 4; c++)
            for (int a = 0; a < 2; a++) {
                const int b = 1 - a;
                const double side = c >> a & 1 ? 1.0 : -1.0, other = (c >> b & 1 ? 1.0 : -1.0) * (point >> b & 1 ? 1.0 : -1.0);
                g[c][a] = side * 0.5 * (1.0 + other / sqrt(3.0));
            }
        for (int p = 0; p < 8; p++)
            for (int q = 0; q < 8; q++) {
                const double *a = g[p / 2], *b = g[q / 2];
                k[p][q] += 0.25 * (la * a[p % 2] * b[q % 2] + mu * a[q % 2] * b[p % 2]);
                if (p % 2 == q % 2) k[p][q] += 0.25 * mu * (a[0] * b[0] + a[1] * b[1]);
            }
    }
}

/* Adds the rectangle as a body: dense matrix, coordinates in place of a null space, load on y = 3 m for x < .8 m. */
static void add_body(feti_problem *problem, const rectangle *r)
{
    const int64_t n = 2 * (r->nx + 1) * (r->ny + 1);
    double *k = demo_array(n * n, sizeof *k), *load = demo_array(n, sizeof *load), *xyz = demo_array(2 * n, sizeof *xyz);
    int32_t *node = demo_array(n, sizeof *node), *dir = demo_array(n, sizeof *dir);
    double ke[8][8];
    int64_t body;

    element(ke);
    for (int i = r->i0; i < r->i0 + r->nx; i++)
        for (int j = r->j0; j < r->j0 + r->ny; j++)
            for (int p = 0; p < 8; p++)
                for (int q = 0; q < 8; q++) {
                    const int64_t row = unknown(r, i + (p / 2) % 2, j + p / 4) + p % 2;
                    const int64_t col = unknown(r, i + (q / 2) % 2, j + q / 4) + q % 2;
                    k[row + n * col] += ke[p][q];
                }
    for (int i = r->i0; i <= r->i0 + r->nx; i++)
        for (int j = r->j0; j <= r->j0 + r->ny; j++)
            for (int d = 0; d < 2; d++) {
                const int64_t at = unknown(r, i, j) + d;
                node[at] = i * (3 * N + 1) + j + 1, dir[at] = d + 1;
                xyz[2 * at] = (double)i / N, xyz[2 * at + 1] = (double)j / N;
                /* a node on the cut x = 1 m is not loaded: it needs no decision whose the load is */
                if (d == 1 && j == 3 * N && 5 * i < 4 * N) load[at] = -1.0 / N;
            }
    CALL(feti_body_add(problem, n, &body));
    CALL(feti_body_stiffness_dense(problem, body, n, k, n, FETI_LOWER, FETI_COPY));
    CALL(feti_body_coordinates(problem, body, 2, n, node, dir, xyz, 2));
    CALL(feti_body_load(problem, body, n, load));
    free(k);
    free(load);
    free(xyz);
    free(node);
    free(dir);
}

/* Adds one row u_a - u_b (b = NULL: u_a alone) along direction d of node (i, j). */
static void add_row(feti_problem *problem, int32_t kind, const rectangle *parts, int a, int b, int i, int j, int d, double rhs)
{
    const int32_t end = b < 0 ? 1 : 2, ptr[2] = { 0, end }, body[2] = { a, b };
    const int32_t dof[2] = { (int32_t)unknown(&parts[a], i, j) + d, b < 0 ? 0 : (int32_t)unknown(&parts[b], i, j) + d };
    const double val[2] = { 1.0, -1.0 };

    CALL(feti_rows_add_i32(problem, kind, 1, ptr, body, dof, val, 0, &rhs, NULL));
}

/* The parts `from` to `to` - 1 that have node (i, j); how many. */
static int copies(const rectangle *parts, int from, int to, int i, int j, int found[COPIES])
{
    int count = 0;

    for (int p = from; p < to; p++)
        if (unknown(&parts[p], i, j) >= 0) found[count++] = p;
    return count;
}

/* H u = 0: all pairs of copies within a block; the clamp at y = 0; one node of the upper block along x. */
static void add_equalities(feti_problem *problem, const rectangle *parts, int lower, int all)
{
    int found[COPIES];

    for (int block = 0; block < 2; block++)
        for (int i = 0; i < LINE; i++)
            for (int j = 0; j <= 3 * N; j++) {
                const int count = copies(parts, block ? lower : 0, block ? all : lower, i, j, found);
                for (int a = 0; a < count; a++)
                    for (int b = a + 1; b < count; b++)
                        for (int d = 0; d < 2; d++)
                            add_row(problem, FETI_EQUALITY, parts, found[a], found[b], i, j, d, 0.0);
                for (int d = 0; d < 2; d++)
                    if (block == 0 && j == 0) add_row(problem, FETI_EQUALITY, parts, found[0], -1, i, j, d, 0.0);
            }
    copies(parts, lower, all, 0, N, found);
    add_row(problem, FETI_EQUALITY, parts, found[0], -1, 0, N, 0, 0.0);
}

/* Rows along y on y = 1 m: the lower block stays below the upper one; the gap grows towards the middle. */
static void add_contact(feti_problem *problem, const rectangle *parts, int lower, int all)
{
    int below[COPIES], above[COPIES];

    for (int i = 0; i < LINE; i++) {
        const double x = (double)i / N;
        copies(parts, 0, lower, i, N, below);
        copies(parts, lower, all, i, N, above);
        add_row(problem, FETI_INEQUALITY, parts, below[0], above[0], i, N, 1, 2e-5 * x * (2.0 - x));
    }
}

static void solve(const rectangle *parts, int lower, int all, feti_info *info, double *lambda)
{
    feti_problem *problem = NULL;

    CALL(feti_problem_create(&problem));
    for (int p = 0; p < all; p++) add_body(problem, &parts[p]);
    add_equalities(problem, parts, lower, all);
    add_contact(problem, parts, lower, all);
    CALL(feti_solve(problem, info));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, LINE, lambda));
    CALL(feti_problem_destroy(&problem));
}

int main(void)
{
    feti_info whole = { .struct_size = sizeof whole }, cut = { .struct_size = sizeof cut };
    double by_whole[LINE], by_cut[LINE], sum = 0.0;
    int closed = 0;

    solve(WHOLE, 1, 2, &whole, by_whole);
    solve(CUT, 2, SQUARES, &cut, by_cut);

    for (int r = 0; r < LINE; r++) {
        sum += by_cut[r];
        closed += by_cut[r] > 1e-6;
    }
    demo_value("equality rows of two blocks", (double)whole.equalities, "-");
    demo_value("equality rows of six squares", (double)cut.equalities, "-");
    demo_value("contact force", sum, "MN");
    demo_value("nodes in contact", closed, "-");
    demo_value("energy of two blocks", 1e6 * whole.energy, "J");
    demo_value("energy of six squares", 1e6 * cut.energy, "J");
    return demo_line("06_blocks_in_subdomains", &cut, demo_error(LINE, by_cut, by_whole), whole.status == FETI_OK);
}
