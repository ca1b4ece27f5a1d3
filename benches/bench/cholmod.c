/* The unit of the benchmark: CHOLMOD analyses and factorises a positive definite matrix, once.
   cholmod <matrix> <bytes>   prints lines `name value`, after it has touched so much memory for each unknown, as backing.rs does
   for the other programs; the matrix is written by matrix.rs: int64 n, int64 entries, then the
   lower triangle by columns: int32 pointers (n + 1), int32 rows, double values. */
#include "cholmod_peer.h"

static cholmod_sparse *read_matrix(const char *path, cholmod_common *common)
{
    int64_t size[2];
    cholmod_sparse *a = NULL;
    FILE *file = fopen(path, "rb");

    if (file && fread(size, sizeof *size, 2, file) == 2) {
        const size_t n = (size_t)size[0], entries = (size_t)size[1];
        a = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, common);
        if (a && (fread(a->p, sizeof(int), n + 1, file) != n + 1 || fread(a->i, sizeof(int), entries, file) != entries ||
                  fread(a->x, sizeof(double), entries, file) != entries))
            cholmod_free_sparse(&a, common);
    }
    if (file) fclose(file);
    return a;
}

/* The largest residual of A x = A 1, relative to the largest entry of the right-hand side. */
static double residual(cholmod_sparse *a, cholmod_factor *factor, cholmod_common *common)
{
    double one[2] = { 1.0, 0.0 }, zero[2] = { 0.0, 0.0 }, minus[2] = { -1.0, 0.0 }, size, error;
    cholmod_dense *x = cholmod_ones(a->nrow, 1, CHOLMOD_REAL, common);
    cholmod_dense *b = cholmod_zeros(a->nrow, 1, CHOLMOD_REAL, common), *y;

    cholmod_sdmult(a, 0, one, zero, x, b, common);
    size = cholmod_norm_dense(b, 0, common);
    y = cholmod_solve(CHOLMOD_A, factor, b, common);
    if (!y) return HUGE_VAL;
    cholmod_sdmult(a, 0, minus, one, y, b, common);
    error = cholmod_norm_dense(b, 0, common);
    cholmod_free_dense(&x, common);
    cholmod_free_dense(&y, common);
    cholmod_free_dense(&b, common);
    return error / size;
}

int main(int arguments, char **argument)
{
    const clockid_t cpu = CLOCK_PROCESS_CPUTIME_ID, wall = CLOCK_MONOTONIC;
    double at[3], processor[3];
    cholmod_common common;
    cholmod_sparse *a;
    cholmod_factor *factor;

    if (!begin(&common)) return 1;
    a = arguments == 3 ? read_matrix(argument[1], &common) : NULL;
    if (!a) return fail("no matrix");
    back_memory(a->nrow * strtoull(argument[2], NULL, 10));
    at[0] = seconds(wall), processor[0] = seconds(cpu);
    factor = cholmod_analyze(a, &common);
    at[1] = seconds(wall), processor[1] = seconds(cpu);
    if (!factor || !cholmod_factorize(a, factor, &common) || common.status != CHOLMOD_OK) return fail("no factor");
    at[2] = seconds(wall), processor[2] = seconds(cpu);
    printf("peak %.0f\n", bytes("/proc/self/status", "VmHWM:"));
    if (factor->ordering != CHOLMOD_METIS || !factor->is_super) return fail("neither METIS nor supernodes");
    printf("wall %.6f\ncpu %.6f\n", at[2] - at[0], processor[2] - processor[0]);
    printf("analyse_wall %.6f\nanalyse_cpu %.6f\n", at[1] - at[0], processor[1] - processor[0]);
    printf("factorise_wall %.6f\nfactorise_cpu %.6f\n", at[2] - at[1], processor[2] - processor[1]);
    printf("flops %.6e\nentries %.6e\n", common.fl, common.lnz);
    printf("residual %.3e\n", residual(a, factor, &common));
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_finish(&common);
    return 0;
}
