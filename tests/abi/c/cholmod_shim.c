#include "cholmod_shim.h"

#include <stdlib.h>
#include <suitesparse/cholmod.h>

struct shim_factor {
    int64_t n, kept;
    int64_t *place; /* n: number among the kept unknowns, -1: held */
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *right; /* kept */
};

/* The rows of the lower triangle are the columns of the upper one: stype = 1. */
static cholmod_sparse *reduced(shim_factor *f, const int32_t *row_ptr, const int32_t *col, const double *val, int32_t base)
{
    cholmod_sparse *a = cholmod_allocate_sparse((size_t)f->kept, (size_t)f->kept, (size_t)(row_ptr[f->n] - base), 1, 1, 1,
                                                CHOLMOD_REAL, &f->common);
    int *ptr, *row, at = 0;

    if (!a) return NULL;
    ptr = a->p;
    row = a->i;
    for (int64_t i = 0; i < f->n; i++) {
        if (f->place[i] < 0) continue;
        ptr[f->place[i]] = at;
        for (int32_t e = row_ptr[i] - base; e < row_ptr[i + 1] - base; e++)
            if (f->place[col[e] - base] >= 0) {
                row[at] = (int)f->place[col[e] - base];
                ((double *)a->x)[at++] = val[e];
            }
    }
    ptr[f->kept] = at;
    return a;
}

static void number_the_kept(shim_factor *f, int64_t held, const int64_t *dof, int32_t base)
{
    for (int64_t k = 0; k < held; k++) f->place[dof[k] - base] = -1;
    for (int64_t i = 0; i < f->n; i++)
        if (f->place[i] == 0) f->place[i] = f->kept++;
}

shim_factor *shim_factorise(int64_t n, const int32_t *row_ptr, const int32_t *col, const double *val, int64_t held,
                            const int64_t *dof, int32_t base)
{
    shim_factor *f = calloc(1, sizeof *f);
    cholmod_sparse *a;

    if (!f) return NULL;
    cholmod_start(&f->common);
    f->common.print = 0;
    f->common.quick_return_if_not_posdef = 1;
    f->n = n;
    f->place = calloc((size_t)n + 1, sizeof *f->place);
    if (!f->place) {
        shim_release(f);
        return NULL;
    }
    number_the_kept(f, held, dof, base);
    a = reduced(f, row_ptr, col, val, base);
    f->factor = a ? cholmod_analyze(a, &f->common) : NULL;
    if (f->factor) cholmod_factorize(a, f->factor, &f->common);
    cholmod_free_sparse(&a, &f->common);
    f->right = cholmod_zeros((size_t)f->kept, 1, CHOLMOD_REAL, &f->common);
    if (!f->factor || !f->right || f->common.status != CHOLMOD_OK) {
        shim_release(f);
        return NULL;
    }
    return f;
}

int32_t shim_solve(shim_factor *f, const double *b, double *x)
{
    cholmod_dense *solution;

    for (int64_t i = 0; i < f->n; i++)
        if (f->place[i] >= 0) ((double *)f->right->x)[f->place[i]] = b[i];
    solution = cholmod_solve(CHOLMOD_A, f->factor, f->right, &f->common);
    if (!solution) return -1;
    for (int64_t i = 0; i < f->n; i++) x[i] = f->place[i] >= 0 ? ((double *)solution->x)[f->place[i]] : 0.0;
    cholmod_free_dense(&solution, &f->common);
    return 0;
}

void shim_release(shim_factor *f)
{
    if (!f) return;
    cholmod_free_factor(&f->factor, &f->common);
    cholmod_free_dense(&f->right, &f->common);
    cholmod_finish(&f->common);
    free(f->place);
    free(f);
}
