/* What the programs of the benchmark that call CHOLMOD share: clocks, memory, and the BLAS. */
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

/* CHOLMOD as both programs use it: METIS ordering, supernodal. */
static int begin(cholmod_common *common)
{
    if (!print_blas()) return !fail("the BLAS is not OpenBLAS: update-alternatives --config libblas.so.3-x86_64-linux-gnu");
    cholmod_start(common);
    common->supernodal = CHOLMOD_SUPERNODAL;
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_METIS;
    common->postorder = 1;
    return 1;
}
