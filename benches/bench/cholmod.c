/* The unit of the benchmark: CHOLMOD analyses and factorises a positive definite matrix, once.
   cholmod <matrix> <bytes>   prints lines `name value`, after it has touched so much memory for each unknown, as backing.rs does
   for the other programs; the matrix is written by matrix.rs: int64 n, int64 entries, then the
   lower triangle by columns: int32 pointers (n + 1), int32 rows, double values. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    return 1;
}

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

/* Bytes that a line `key` of a file of the system gives in kB; 0 if it does not. */
static double bytes(const char *path, const char *key)
{
    char line[256];
    double kilobytes = 0.0;
    FILE *file = fopen(path, "r");

    while (file && fgets(line, sizeof line, file))
        if (!strncmp(line, key, strlen(key))) kilobytes = strtod(line + strlen(key), NULL);
    if (file) fclose(file);
    return 1024.0 * kilobytes;
}

/* Touches so much memory, at most half of what is available; a child does, so that it does not count in the peak. */
static void back_memory(size_t wanted)
{
    const size_t half = (size_t)bytes("/proc/meminfo", "MemAvailable:") / 2, size = wanted < half ? wanted : half;
    const pid_t child = fork();

    if (!child) {
        char *start = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (start == MAP_FAILED) _exit(1);
        madvise(start, size, MADV_HUGEPAGE);
        for (size_t at = 0; at < size; at += 4096) ((volatile char *)start)[at] = 1;
        _exit(0);
    }
    if (child > 0) waitpid(child, NULL, 0);
}

/* The file that a function of the BLAS or LAPACK comes from, links followed. */
static const char *origin(const char *function, char *path)
{
    Dl_info info;
    void *address = dlsym(RTLD_DEFAULT, function);

    return address && dladdr(address, &info) && realpath(info.dli_fname, path) ? path : "?";
}

/* The BLAS and LAPACK that CHOLMOD calls; 0 when the BLAS is not OpenBLAS. */
static int print_blas(void)
{
    char *(*config)(void) = NULL, blas[PATH_MAX], lapack[PATH_MAX];

    *(void **)&config = dlsym(RTLD_DEFAULT, "openblas_get_config");
    printf("blas %s (%s, LAPACK %s)\n", config ? config() : "?", origin("dgemm_", blas), origin("dpotrf_", lapack));
    return config && strstr(blas, "openblas");
}

int main(int arguments, char **argument)
{
    const clockid_t cpu = CLOCK_PROCESS_CPUTIME_ID, wall = CLOCK_MONOTONIC;
    double at[3], processor[3];
    cholmod_common common;
    cholmod_sparse *a;
    cholmod_factor *factor;

    if (!print_blas()) return fail("the BLAS is not OpenBLAS: update-alternatives --config libblas.so.3-x86_64-linux-gnu");
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
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
