/* 07 A host with its own factorisation: banded Cholesky, as in a code of the 1970s.

   A block of 12 mm x 4 mm is clamped to the ground, another one lies on it and floats (plane strain, E = 1e4 N/mm^2,
   nu = .3, 1 mm thick, squares of 1 mm). The bottom of the upper block is slightly convex; 10 N press on each of the
   five nodes at the left of its top, so that the contact opens on the right.

   The host numbers the unknowns column by column and stores each K as a band in LAPACK's format. Instead of a
   matrix it passes the diagonal and two functions:

       Y = K X        the product with the band
       Y = K+ X       solve with the banded factor

   The clamped block has K+ = K^-1. K of the floating block is singular: three of its unknowns are held, by rows and columns
   of the identity in the factor and zeros in X and Y; they are the lower corners, far apart.

   The example solves the problem twice: with these functions, and with the matrices themselves. The answers are equal, and
   with the functions the library factorises nothing. Units: N and mm. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "demo.h"

enum { NX = 12, NY = 4, MOST = 2 * (NX + 1) * (NY + 1), KD = 2 * (NY + 2) + 1, LD = KD + 1, BODIES = 2, ROWS = NX + 1 };
static const double E = 1e4 /* N/mm^2 */, NU = 0.3, FORCE = 10.0 /* N */, CROWN = 1e-3 /* mm */;

/* Entry (i, j), j <= i <= j + KD, of K is k[i - j + LD j], of the Cholesky factor l[i - j + LD j]. Nodes on the line
   j = 0 of the clamped block carry no unknowns: first = 1. */
typedef struct {
    int first, n;
    double k[LD * MOST], l[LD * MOST];
    int held[3], holds;
} block;

/* First unknown of node (i, j), -1 where it is clamped. */
static int unknown(const block *b, int i, int j)
{
    return j < b->first ? -1 : 2 * (i * (NY + 1 - b->first) + j - b->first);
}

/* Integral of dN_a/dx_d dN_c/dx_e over a square, N_a the bilinear function of corner a. */
static double gradients(int a, int c, int d, int e)
{
    static const double CORNER[4][2] = { { -1, -1 }, { 1, -1 }, { -1, 1 }, { 1, 1 } };
    const double both = CORNER[a][d] * CORNER[c][e] / 4.0;
    return d == e ? both * (1.0 + CORNER[a][1 - d] * CORNER[c][1 - d] / 3.0) : both;
}

/* Entry of an element: lambda div v div u + 2 mu e(v):e(u). */
static double element(int a, int d, int c, int e)
{
    const double mu = E / (2.0 * (1.0 + NU)), lambda = 2.0 * mu * NU / (1.0 - 2.0 * NU);
    double value = lambda * gradients(a, c, d, e) + mu * gradients(a, c, e, d);
    if (d == e) value += mu * (gradients(a, c, 0, 0) + gradients(a, c, 1, 1));
    return value;
}

static void assemble(block *b, int first)
{
    memset(b, 0, sizeof *b);
    b->first = first;
    b->n = 2 * (NX + 1) * (NY + 1 - first);
    for (int i = 0; i < NX; i++)
        for (int j = 0; j < NY; j++)
            for (int p = 0; p < 8; p++)
                for (int q = 0; q < 8; q++) {
                    const int row = unknown(b, i + p / 2 % 2, j + p / 4), col = unknown(b, i + q / 2 % 2, j + q / 4);
                    if (row < 0 || col < 0 || row + p % 2 < col + q % 2) continue;
                    b->k[row + p % 2 - (col + q % 2) + LD * (col + q % 2)] += element(p / 2, p % 2, q / 2, q % 2);
                }
}

/* A = L L' in the band, A positive definite. */
static void band_factor(int n, double *a)
{
    for (int j = 0; j < n; j++) {
        const int below = n - 1 - j < KD ? n - 1 - j : KD;
        double *column = a + LD * j;
        column[0] = sqrt(column[0]);
        for (int i = 1; i <= below; i++) column[i] /= column[0];
        for (int c = 1; c <= below; c++)
            for (int i = c; i <= below; i++) a[i - c + LD * (j + c)] -= column[i] * column[c];
    }
}

/* x := (L L')^-1 x */
static void band_solve(int n, const double *l, double *x)
{
    for (int j = 0; j < n; j++) {
        x[j] /= l[LD * j];
        for (int i = 1; i <= KD && j + i < n; i++) x[j + i] -= l[i + LD * j] * x[j];
    }
    for (int j = n - 1; j >= 0; j--) {
        for (int i = 1; i <= KD && j + i < n; i++) x[j] -= l[i + LD * j] * x[j + i];
        x[j] /= l[LD * j];
    }
}

/* y := y + K x */
static void band_multiply(int n, const double *k, const double *x, double *y)
{
    for (int j = 0; j < n; j++) {
        y[j] += k[LD * j] * x[j];
        for (int i = 1; i <= KD && j + i < n; i++) {
            y[j + i] += k[i + LD * j] * x[j];
            y[j] += k[i + LD * j] * x[j + i];
        }
    }
}

/* The factor of K with the held unknowns struck out. */
static void factorise(block *b)
{
    memcpy(b->l, b->k, sizeof b->l);
    for (int h = 0; h < b->holds; h++) {
        const int at = b->held[h];
        for (int i = 1; i <= KD; i++) {
            b->l[i + LD * at] = 0.0;
            if (at - i >= 0) b->l[i + LD * (at - i)] = 0.0;
        }
        b->l[LD * at] = 1.0;
    }
    band_factor(b->n, b->l);
}

/* Y = K+ X and Y = K X: called by the library with 1 to 32 columns, Y full of zeros. 0: done. */
static int32_t kplus(void *user, int64_t body, int64_t n, int64_t nrhs,
                     const double *x, int64_t ldx, double *y, int64_t ldy)
{
    const block *b = (const block *)user + body;

    for (int64_t c = 0; c < nrhs; c++) {
        memcpy(y + ldy * c, x + ldx * c, (size_t)n * sizeof *y);
        for (int h = 0; h < b->holds; h++) y[b->held[h] + ldy * c] = 0.0;
        band_solve((int)n, b->l, y + ldy * c);
    }
    return 0;
}

static int32_t k(void *user, int64_t body, int64_t n, int64_t nrhs,
                 const double *x, int64_t ldx, double *y, int64_t ldy)
{
    const block *b = (const block *)user + body;

    for (int64_t c = 0; c < nrhs; c++) band_multiply((int)n, b->k, x + ldx * c, y + ldy * c);
    return 0;
}

static void give_functions(feti_problem *problem, int64_t body, block *blocks)
{
    const block *b = blocks + body;
    double diag[MOST];

    for (int i = 0; i < b->n; i++) diag[i] = b->k[LD * i];
    CALL(feti_body_operator(problem, body, b->n, diag, kplus, k, 0, blocks));
}

/* The lower triangle by columns is the upper triangle by rows. */
static void give_matrix(feti_problem *problem, int64_t body, const block *b)
{
    int32_t ptr[MOST + 1], col[LD * MOST], end = 0;
    double val[LD * MOST];

    for (int j = 0; j < b->n; j++) {
        ptr[j] = end;
        for (int i = j; i < b->n && i <= j + KD; i++) {
            col[end] = i;
            val[end++] = b->k[i - j + LD * j];
        }
    }
    ptr[b->n] = end;
    CALL(feti_body_stiffness_i32(problem, body, b->n, ptr, col, val, 0, FETI_UPPER, FETI_COPY));
}

/* Two translations and a rotation about the lower left corner; the clamped block has none. */
static void give_null_space(feti_problem *problem, int64_t body, const block *b)
{
    double r[3 * MOST];

    memset(r, 0, sizeof r);
    for (int i = 0; i <= NX; i++)
        for (int j = b->first; j <= NY; j++) {
            const int x = unknown(b, i, j), y = x + 1;
            r[x] = 1.0;
            r[y + b->n] = 1.0;
            r[x + 2 * b->n] = -j, r[y + 2 * b->n] = i;
        }
    CALL(feti_body_null_space(problem, body, b->holds, b->n, b->holds ? r : NULL, b->n, FETI_EXACT));
}

/* u_y of the lower block - u_y of the upper one <= gap along the line of contact; the middle of the upper block keeps its
   place along x: nothing else keeps it from sliding. */
static void give_rows(feti_problem *problem, const block *blocks)
{
    int32_t ptr[ROWS + 1], body[2 * ROWS], dof[2 * ROWS];
    double val[2 * ROWS], gap[ROWS];

    for (int i = 0; i < ROWS; i++) {
        const double x = (i - NX / 2) / (NX / 2.0);
        ptr[i] = 2 * i;
        body[2 * i] = 0, dof[2 * i] = unknown(&blocks[0], i, NY) + 1, val[2 * i] = 1.0;
        body[2 * i + 1] = 1, dof[2 * i + 1] = unknown(&blocks[1], i, 0) + 1, val[2 * i + 1] = -1.0;
        gap[i] = CROWN * x * x;
    }
    ptr[ROWS] = 2 * ROWS;
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, ROWS, ptr, body, dof, val, 0, gap, NULL));
    body[0] = 1, dof[0] = unknown(&blocks[1], NX / 2, 0), ptr[1] = 1;
    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, 1, ptr, body, dof, val, 0, NULL, NULL));
}

/* Solves with the functions of the host, or with its matrices: forces of the rows, displacements of the upper block. */
static void contact(block *blocks, int own, feti_info *info, double *lambda, double *u)
{
    feti_problem *problem = NULL;
    double load[MOST] = { 0 };

    CALL(feti_problem_create(&problem));
    CALL(feti_set_f64(problem, "tolerance", 1e-10));
    for (int b = 0; b < BODIES; b++) {
        int64_t body;
        CALL(feti_body_add(problem, blocks[b].n, &body));
        if (own)
            give_functions(problem, body, blocks);
        else
            give_matrix(problem, body, &blocks[b]);
        give_null_space(problem, body, &blocks[b]);
    }
    for (int i = 0; i < 5; i++) load[unknown(&blocks[1], i, NY) + 1] = -FORCE;
    CALL(feti_body_load(problem, 1, blocks[1].n, load));
    give_rows(problem, blocks);
    CALL(feti_solve(problem, info));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, ROWS, lambda));
    CALL(feti_displacement(problem, 1, blocks[1].n, u));
    CALL(feti_problem_destroy(&problem));
}

int main(void)
{
    block *blocks = demo_array(BODIES, sizeof *blocks);
    feti_info own = { .struct_size = sizeof own }, reference = { .struct_size = sizeof reference };
    double lambda[ROWS], by_matrix[ROWS], u[MOST], u_by_matrix[MOST], sum = 0.0, closed = 0.0;

    assemble(&blocks[0], 1);
    assemble(&blocks[1], 0);
    blocks[1].holds = 3;
    blocks[1].held[0] = unknown(&blocks[1], 0, 0);
    blocks[1].held[1] = unknown(&blocks[1], 0, 0) + 1;
    blocks[1].held[2] = unknown(&blocks[1], NX, 0) + 1;
    for (int b = 0; b < BODIES; b++) factorise(&blocks[b]);
    contact(blocks, 1, &own, lambda, u);
    contact(blocks, 0, &reference, by_matrix, u_by_matrix);

    for (int i = 0; i < ROWS; i++) {
        sum += lambda[i];
        if (lambda[i] > 1e-6) closed += 1.0;
    }
    demo_value("contact force", sum, "N");
    demo_value("nodes in contact", closed, "-");
    demo_value("top, left corner", 1e3 * u[unknown(&blocks[1], 0, NY) + 1], "um");
    demo_value("top, right corner", 1e3 * u[unknown(&blocks[1], NX, NY) + 1], "um");
    demo_value("factorisations by the library", (double)own.factorisations, "-");
    demo_value("factorisations with matrices", (double)reference.factorisations, "-");

    const double error = fmax(demo_error(ROWS, lambda, by_matrix), demo_error(blocks[1].n, u, u_by_matrix));
    const int ok = own.factorisations == 0 && reference.status == FETI_OK && fabs(sum - 5.0 * FORCE) < 1e-6;
    free(blocks);
    return demo_line("07_own_factorisation", &own, error, ok);
}
