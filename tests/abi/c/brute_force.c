#include "brute_force.h"

#include <math.h>
#include <string.h>

enum { ROWS_MAX = 14, MODES_MAX = 18, ORDER_MAX = ROWS_MAX + MODES_MAX };

/* A consistent, perhaps singular system of the given order, column-major with leading dimension ORDER_MAX. */
typedef struct {
    int64_t order;
    double a[ORDER_MAX * ORDER_MAX], b[ORDER_MAX], x[ORDER_MAX];
} linear_system;

static void swap(double *x, double *y)
{
    const double t = *x;
    *x = *y;
    *y = t;
}

/* Moves the largest entry of the rest to (k, k); at[j] is the unknown that stands in column j. */
static double pivot(linear_system *s, int64_t k, int64_t *at)
{
    int64_t row = k, col = k;
    for (int64_t j = k; j < s->order; j++)
        for (int64_t i = k; i < s->order; i++)
            if (fabs(s->a[i + ORDER_MAX * j]) > fabs(s->a[row + ORDER_MAX * col])) row = i, col = j;
    for (int64_t j = 0; j < s->order; j++) swap(&s->a[k + ORDER_MAX * j], &s->a[row + ORDER_MAX * j]);
    swap(&s->b[k], &s->b[row]);
    for (int64_t i = 0; i < s->order; i++) swap(&s->a[i + ORDER_MAX * k], &s->a[i + ORDER_MAX * col]);
    const int64_t unknown = at[k];
    at[k] = at[col];
    at[col] = unknown;
    return fabs(s->a[k + ORDER_MAX * k]);
}

/* Gaussian elimination with complete pivoting; what the system leaves free is set to 0. Returns 0 when it
   has no solution. */
static int eliminate(linear_system *s)
{
    int64_t at[ORDER_MAX], rank = 0;
    double first = 0.0, size = 0.0;

    for (int64_t i = 0; i < s->order; i++) at[i] = i, size = fmax(size, fabs(s->b[i]));
    for (; rank < s->order; rank++) {
        const double p = pivot(s, rank, at);
        if (rank == 0) first = p;
        if (p <= 1e-12 * first) break;
        for (int64_t i = rank + 1; i < s->order; i++) {
            const double factor = s->a[i + ORDER_MAX * rank] / s->a[rank + ORDER_MAX * rank];
            for (int64_t j = rank; j < s->order; j++) s->a[i + ORDER_MAX * j] -= factor * s->a[rank + ORDER_MAX * j];
            s->b[i] -= factor * s->b[rank];
        }
    }
    for (int64_t i = rank; i < s->order; i++)
        if (fabs(s->b[i]) > 1e-9 * size) return 0;
    memset(s->x, 0, sizeof s->x);
    for (int64_t i = rank - 1; i >= 0; i--) {
        double sum = s->b[i];
        for (int64_t j = i + 1; j < rank; j++) sum -= s->a[i + ORDER_MAX * j] * s->x[at[j]];
        s->x[at[i]] = sum / s->a[i + ORDER_MAX * i];
    }
    return 1;
}

/* Scaled to one size: F_SS / f, G / g, so that one pivot tolerance serves both blocks. */
typedef struct {
    int64_t m, r;
    const double *F, *d, *G, *e;
    double f, g; /* largest entries of F and G */
} dual;

/* [F_SS G_S'; G_S 0] [l_S; -a] = [d_S; e] for the rows of the set. */
static int solve_face(const dual *q, unsigned set, linear_system *s)
{
    int64_t row[ROWS_MAX], free_rows = 0;

    for (int64_t i = 0; i < q->m; i++)
        if (set >> i & 1u) row[free_rows++] = i;
    memset(s, 0, sizeof *s);
    s->order = free_rows + q->r;
    for (int64_t j = 0; j < free_rows; j++) {
        for (int64_t i = 0; i < free_rows; i++) s->a[i + ORDER_MAX * j] = q->F[row[i] + q->m * row[j]] / q->f;
        for (int64_t k = 0; k < q->r; k++) {
            const double g = q->G[k + q->r * row[j]] / q->g;
            s->a[free_rows + k + ORDER_MAX * j] = s->a[j + ORDER_MAX * (free_rows + k)] = g;
        }
        s->b[j] = q->d[row[j]] / q->f;
    }
    for (int64_t k = 0; k < q->r; k++) s->b[free_rows + k] = q->e[k] / q->g;
    return eliminate(s);
}

/* l >= 0 on the set, slack r = (F l - d) - G'a >= 0 on the other rows, both to 1e-9 of their size. */
static int is_optimal(const dual *q, unsigned set, const linear_system *s, double *l)
{
    int64_t k = 0;
    double force = 0.0, gap = 0.0;

    for (int64_t i = 0; i < q->m; i++) l[i] = set >> i & 1u ? s->x[k++] : 0.0;
    for (int64_t i = 0; i < q->m; i++) {
        force = fmax(force, fabs(l[i]));
        gap = fmax(gap, fabs(q->d[i]));
    }
    for (int64_t i = 0; i < q->m; i++) {
        double slack = -q->d[i];
        for (int64_t j = 0; j < q->m; j++) slack += q->F[i + q->m * j] * l[j];
        for (int64_t j = 0; j < q->r; j++) slack += q->G[j + q->r * i] * s->x[k + j] * q->f / q->g;
        if (l[i] < -1e-9 * force || (!(set >> i & 1u) && slack < -1e-9 * gap)) return 0;
    }
    return 1;
}

static double largest(int64_t n, const double *x)
{
    double size = 0.0;
    for (int64_t i = 0; i < n; i++) size = fmax(size, fabs(x[i]));
    return size > 0.0 ? size : 1.0;
}

int64_t brute_force(int64_t m, int64_t r, const double *F, const double *d, const double *G, const double *e,
                    double *l, double *spread)
{
    const dual q = { m, r, F, d, G, e, largest(m * m, F), largest(r * m, G) };
    static linear_system s;
    double trial[ROWS_MAX];
    int64_t found = 0;

    *spread = 0.0;
    if (m > ROWS_MAX || r > MODES_MAX) return -1;
    for (unsigned set = 0; set < 1u << m; set++) {
        if (!solve_face(&q, set, &s) || !is_optimal(&q, set, &s, trial)) continue;
        for (int64_t i = 0; found && i < m; i++) *spread = fmax(*spread, fabs(trial[i] - l[i]));
        memcpy(l, trial, (size_t)m * sizeof *l);
        found++;
    }
    return found;
}
