#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <FrontMtx.h>
#include <SymbFac.h>
#include <misc.h>

#include "factor.h"

/* Rows of a domain that is not dissected further, zeros accepted in a front, columns of a front: as its manual advises. */
enum { DOMAIN = 100, ZEROS = 256, COLUMNS = 48, SEED = 1 };

struct factor {
    int n, holds;
    int *held;
    ETree *tree;
    IVL *pattern;
    IV *to_new, *to_old;
    FrontMtx *front;
    SubMtxManager *room;
};

static char *marks(const factor *f)
{
    char *is_held = calloc((size_t)f->n, 1);

    for (int h = 0; h < f->holds; h++) is_held[f->held[h]] = 1;
    return is_held;
}

static InpMtx *entries(const factor *f, const matrix *k)
{
    InpMtx *a = InpMtx_new();
    char *is_held = marks(f);

    InpMtx_init(a, INPMTX_BY_ROWS, SPOOLES_REAL, k->ptr[k->n], 0);
    for (int i = 0; i < k->n; i++)
        for (int at = k->ptr[i]; at < k->ptr[i + 1]; at++) {
            const int j = k->col[at];
            if (!is_held[i] && !is_held[j]) InpMtx_inputRealEntry(a, i, j, k->val[at]);
            if (is_held[i] && i == j) InpMtx_inputRealEntry(a, i, i, 1.0);
        }
    InpMtx_changeStorageMode(a, INPMTX_BY_VECTORS);
    free(is_held);
    return a;
}

/* The order of elimination: the better of nested dissection and multisection. */
static ETree *ordered(InpMtx *a, int n)
{
    IVL *adjacent = InpMtx_fullAdjacency(a);
    Graph *graph = Graph_new();
    ETree *tree;

    Graph_init2(graph, 0, n, 0, IVL_tsize(adjacent), n, IVL_tsize(adjacent), adjacent, NULL, NULL);
    tree = orderViaBestOfNDandMS(graph, DOMAIN, ZEROS, COLUMNS, SEED, 0, NULL);
    Graph_free(graph);
    return tree;
}

factor *factor_new(const matrix *k, const int *held, int holds)
{
    factor *f = calloc(1, sizeof *f);
    InpMtx *a;
    ChvManager *chevrons = ChvManager_new();
    Chv *rest;
    double cpus[10] = { 0 };
    int stats[20] = { 0 }, failed = -1;

    f->n = k->n, f->holds = holds;
    f->held = malloc((size_t)(holds + 1) * sizeof *held);
    memcpy(f->held, held, (size_t)holds * sizeof *held);
    a = entries(f, k);
    f->tree = ordered(a, k->n);
    f->to_new = ETree_oldToNewVtxPerm(f->tree);
    f->to_old = ETree_newToOldVtxPerm(f->tree);
    ETree_permuteVertices(f->tree, f->to_new);
    InpMtx_permute(a, IV_entries(f->to_new), IV_entries(f->to_new));
    InpMtx_mapToUpperTriangle(a);
    InpMtx_changeCoordType(a, INPMTX_BY_CHEVRONS);
    InpMtx_changeStorageMode(a, INPMTX_BY_VECTORS);
    f->pattern = SymbFac_initFromInpMtx(f->tree, a);
    f->front = FrontMtx_new();
    f->room = SubMtxManager_new();
    SubMtxManager_init(f->room, NO_LOCK, 0);
    FrontMtx_init(f->front, f->tree, f->pattern, SPOOLES_REAL, SPOOLES_SYMMETRIC, FRONTMTX_DENSE_FRONTS,
                  SPOOLES_NO_PIVOTING, NO_LOCK, 0, NULL, f->room, 0, NULL);
    ChvManager_init(chevrons, NO_LOCK, 1);
    rest = FrontMtx_factorInpMtx(f->front, a, 0.0, 0.0, chevrons, &failed, cpus, stats, 0, NULL);
    ChvManager_free(chevrons);
    InpMtx_free(a);
    if (rest || failed >= 0) {
        fprintf(stderr, "SPOOLES cannot factorise K: front %d\n", failed);
        exit(1);
    }
    FrontMtx_postProcess(f->front, 0, NULL);
    return f;
}

void factor_solve(factor *f, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    DenseMtx *b = DenseMtx_new(), *u = DenseMtx_new();
    double cpus[10] = { 0 }, *entry;
    const size_t bytes = (size_t)f->n * sizeof *entry;

    DenseMtx_init(b, SPOOLES_REAL, 0, 0, f->n, (int)nrhs, 1, f->n);
    DenseMtx_init(u, SPOOLES_REAL, 0, 0, f->n, (int)nrhs, 1, f->n);
    entry = DenseMtx_entries(b);
    for (int64_t c = 0; c < nrhs; c++) {
        memcpy(entry + f->n * c, x + ldx * c, bytes);
        for (int h = 0; h < f->holds; h++) entry[f->held[h] + f->n * c] = 0.0;
    }
    DenseMtx_permuteRows(b, f->to_new);
    DenseMtx_zero(u);
    FrontMtx_solve(f->front, u, b, f->room, cpus, 0, NULL);
    DenseMtx_permuteRows(u, f->to_old);
    entry = DenseMtx_entries(u);
    for (int64_t c = 0; c < nrhs; c++) memcpy(y + ldy * c, entry + f->n * c, bytes);
    DenseMtx_free(b);
    DenseMtx_free(u);
}

void factor_free(factor *f)
{
    FrontMtx_free(f->front);
    ETree_free(f->tree);
    IVL_free(f->pattern);
    IV_free(f->to_new);
    IV_free(f->to_old);
    SubMtxManager_free(f->room);
    free(f->held);
    free(f);
}
