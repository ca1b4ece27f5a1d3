/* A host whose malloc fails, once at its n-th call or from there on: every call returns FETI_OK or FETI_MEMORY, nothing is
   printed, and once there is memory again the same problem is solved to the same bits. For every n until the last call. The problem has
   rows of the host, or surfaces. */
#define _GNU_SOURCE
#include <errno.h>
#include <sys/wait.h>
#include <unistd.h>

#include "grid.h"
#include "strips.h"

enum { LENGTH = 2, SECONDS = 60, ONCE = 0, ON = 1, KINDS = 2 };

void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t), *__libc_memalign(size_t, size_t);

/* Calls of malloc until the first that fails; none fails at 0. */
static long left, for_ever;

static int fails(void)
{
    const long before = __atomic_load_n(&left, __ATOMIC_RELAXED);
    if (before <= 0) return before < 0;
    if (__atomic_fetch_sub(&left, 1, __ATOMIC_RELAXED) != 1) return 0;
    if (for_ever) __atomic_store_n(&left, -1, __ATOMIC_RELAXED);
    return 1;
}

void *malloc(size_t size)
{
    return fails() ? (errno = ENOMEM, NULL) : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? (errno = ENOMEM, NULL) : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size)
{
    return fails() ? (errno = ENOMEM, NULL) : __libc_realloc(block, size);
}

int posix_memalign(void **block, size_t align, size_t size)
{
    if (fails()) return ENOMEM;
    *block = __libc_memalign(align, size);
    return *block ? 0 : ENOMEM;
}

/* Calls that end with a solve and what is read of it, and bits of the answer. */
typedef struct {
    const char *name;
    int calls;
    int32_t (*call)(int call, feti_problem **problem);
    uint64_t (*fingerprint)(feti_problem *problem);
} scenario;

static grid bars;
static strips surfaces;

static int32_t call_of_rows(int call, feti_problem **problem)
{
    return call == GRID_CALLS ? feti_solve(*problem, NULL) : grid_call(&bars, call, problem);
}

static uint64_t print_of_rows(feti_problem *problem)
{
    return grid_fingerprint(&bars, problem);
}

static int32_t call_of_surfaces(int call, feti_problem **problem)
{
    return strips_call(&surfaces, call, problem);
}

/* Forces now, and what was read in the last calls. */
static uint64_t print_of_surfaces(feti_problem *problem)
{
    double force[STRIP];
    uint64_t print = 0;

    OK(feti_pair_field(problem, 0, FETI_FORCE, STRIP, force));
    print = grid_folded(print, STRIP, force);
    print = grid_folded(print, STRIP, surfaces.pressure);
    return grid_folded(print, 3, surfaces.facts.force) + (uint64_t)surfaces.facts.slipping;
}

static const scenario SCENARIOS[] = { { "rows", GRID_CALLS + 1, call_of_rows, print_of_rows },
                                      { "surfaces", STRIPS_CALLS, call_of_surfaces, print_of_surfaces } };

/* All calls; the first status that is not FETI_OK. */
static int32_t live(const scenario *of, int64_t threads, int *call, feti_problem **problem)
{
    for (; *call < of->calls; ++*call) {
        const int32_t status = of->call(*call, problem);
        if (status != FETI_OK) return status;
        if (*call == 0) OK(feti_set_i64(*problem, "threads", threads));
    }
    return FETI_OK;
}

/* What a child ends with: the malloc failed and a call told so, it failed and all calls went on, or there was no such malloc. */
enum { TOLD = 10, WENT_ON = 11, NOT_REACHED = 12, AGAIN = 3 };

static int child(const scenario *of, long n, int kind, int64_t threads, uint64_t wanted)
{
    feti_problem *problem = NULL;
    int call = 0, told = 0;

    left = n;
    for_ever = kind == ON;
    int32_t status = live(of, threads, &call, &problem);
    const int reached = left <= 0;
    while (status == FETI_MEMORY) {
        if (kind == ON && told++ > AGAIN) left = 0;
        if (kind == ONCE) told++;
        status = live(of, threads, &call, &problem);
    }
    left = 0;
    if (status != FETI_OK) {
        char text[200];
        (void)feti_last_error(text, sizeof text);
        fprintf(stderr, "status %d in call %d: %s\n", status, call, text);
        return 1;
    }
    if (of->fingerprint(problem) != wanted) return 2;
    if (feti_solve(problem, NULL) != FETI_OK || of->fingerprint(problem) != wanted) return 3;
    return feti_problem_destroy(&problem) != FETI_OK ? 4 : !reached ? NOT_REACHED : told ? TOLD : WENT_ON;
}

/* Ends of a child whose malloc number n fails: none by a signal, none with output, each with the right answer after it. */
static int last_of(const scenario *of, long n, int kind, int64_t threads, uint64_t wanted)
{
    static const char *const kinds[KINDS] = { "once", "from then on" };
    int status = 0, pipes[2];
    char text[300] = "";

    if (pipe(pipes)) return 1;
    const pid_t id = fork();
    if (id == 0) {
        dup2(pipes[1], STDOUT_FILENO);
        dup2(pipes[1], STDERR_FILENO);
        alarm(SECONDS);
        _exit(child(of, n, kind, threads, wanted));
    }
    close(pipes[1]);
    const ssize_t bytes = read(pipes[0], text, sizeof text - 1);
    close(pipes[0]);
    CHECK(waitpid(id, &status, 0) == id, "no child");
    CHECK(bytes <= 0, "%s: %s from malloc %ld, %d threads: %s", of->name, kinds[kind], n, (int)threads, text);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) >= TOLD, "%s: %s from malloc %ld, %d threads: signal %d, code %d", of->name,
          kinds[kind], n, (int)threads, WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0);
    return !WIFEXITED(status) || WEXITSTATUS(status) == NOT_REACHED;
}

/* The argument: every how many mallocs one fails. */
int main(int argc, char **argv)
{
    const long step = argc > 1 ? atol(argv[1]) : 1;

    bars = grid_of(LENGTH);
    strips_make(&surfaces);
    for (int k = 0; k < 2; k++) {
        const scenario *of = SCENARIOS + k;
        feti_problem *problem = NULL;
        int call = 0;

        OK(live(of, 1, &call, &problem));
        const uint64_t wanted = of->fingerprint(problem);
        OK(feti_problem_destroy(&problem));
        for (int64_t threads = 1; threads <= 2; threads++)
            for (int kind = ONCE; kind < KINDS; kind++)
                for (long n = 1; !last_of(of, n, kind, threads, wanted); n += step) { }
    }
    grid_free(&bars);
    return check_result();
}
