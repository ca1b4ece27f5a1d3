/* A host that runs out of address space: whatever the limit, every call returns FETI_OK or FETI_MEMORY, and with
   more memory the same problem is solved to the same bits. (Option memory_limit: wrong_problems.c.) */
#define _DEFAULT_SOURCE
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "grid.h"

enum { LENGTH = 72, SECONDS = 60, SOLVE = GRID_CALLS, STEPS = 40 };

/* What a child found out before it ended. */
typedef struct {
    int64_t refused; /* calls that returned FETI_MEMORY */
    uint64_t print;
} outcome;

/* Bytes of address space in use. */
static rlim_t present_size(void)
{
    char text[64] = "";
    FILE *statm = fopen("/proc/self/statm", "r");
    if (!statm || !fgets(text, sizeof text, statm)) exit(1);
    fclose(statm);
    return (rlim_t)strtoull(text, NULL, 10) * (rlim_t)sysconf(_SC_PAGESIZE);
}

static void limit_to(rlim_t bytes)
{
    struct rlimit limit;
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = bytes;
    if (setrlimit(RLIMIT_AS, &limit) != 0) exit(1);
}

static int32_t made(const grid *bars, int call, int64_t threads, feti_problem **problem)
{
    if (call == SOLVE) return feti_solve(*problem, NULL);
    const int32_t status = grid_call(bars, call, problem);
    return call == 0 && status == FETI_OK ? feti_set_i64(*problem, "threads", threads) : status;
}

/* Runs all calls under the limit; a refused one is repeated without the limit, the rest follow under it again. */
static outcome run_under(const grid *bars, rlim_t room, int64_t threads)
{
    feti_problem *problem = NULL;
    outcome found = { 0 };

    for (int call = 0; call <= SOLVE; call++) {
        if (room != RLIM_INFINITY) limit_to(present_size() + room);
        const int32_t status = made(bars, call, threads, &problem);
        limit_to(RLIM_INFINITY);
        CHECK(status == FETI_OK || status == FETI_MEMORY, "call %d returned %d", call, (int)status);
        if (status == FETI_OK) continue;
        found.refused++;
        EXPECT(FETI_OK, made(bars, call, threads, &problem));
    }
    found.print = grid_fingerprint(bars, problem);
    OK(feti_problem_destroy(&problem));
    return found;
}

/* The same in a process of its own, which must end by itself. */
static outcome in_child(const grid *bars, rlim_t room, int64_t threads)
{
    int ends[2], status = 0;
    outcome found = { 0 };
    if (pipe(ends) != 0) exit(1);
    const pid_t child = fork();

    if (child == 0) {
        alarm(SECONDS);
        check_failures = 0;
        found = run_under(bars, room, threads);
        const ssize_t written = write(ends[1], &found, sizeof found);
        _exit(check_failures || written != (ssize_t)sizeof found);
    }
    close(ends[1]);
    const ssize_t got = read(ends[0], &found, sizeof found);
    close(ends[0]);
    CHECK(waitpid(child, &status, 0) == child, "no child");
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0 && got == (ssize_t)sizeof found,
          "room for %.1f MB, %d threads: ended by signal %d, code %d", (double)room / 1e6, (int)threads,
          WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0);
    return found;
}

/* From room for next to nothing to room for everything. */
static void ladder(const grid *bars, int64_t threads, uint64_t print)
{
    int refused = 0, solved = 0;
    double megabytes = 0.1;

    for (int step = 0; step < STEPS; step++, megabytes = 1.12 * megabytes + 0.5) {
        const outcome found = in_child(bars, (rlim_t)(megabytes * 1e6), threads);
        CHECK(found.print == print, "room for %.1f MB, %d threads: other bits", megabytes, (int)threads);
        refused += found.refused > 0;
        solved += found.refused == 0;
    }
    CHECK(refused > 0 && solved > 0, "%d threads: %d runs out of memory, %d not", (int)threads, refused, solved);
}

/* The first call of a process that has nothing left at all; once the host gives back what it holds, it works. */
static void first_call(void)
{
    int status = 0;
    const pid_t child = fork();

    if (child == 0) {
        void **held = NULL, **block;
        feti_problem *problem = NULL;
        alarm(SECONDS);
        check_failures = 0;
        limit_to(present_size());
        while ((block = malloc(sizeof(void *))) != NULL) {
            *block = held;
            held = block;
        }
        EXPECT(FETI_MEMORY, feti_problem_create(&problem));
        while (held) {
            block = *held;
            free(held);
            held = block;
        }
        limit_to(RLIM_INFINITY);
        OK(feti_problem_create(&problem));
        OK(feti_problem_destroy(&problem));
        _exit(check_failures);
    }
    CHECK(waitpid(child, &status, 0) == child, "no child");
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "the first call ended the process by signal %d, code %d",
          WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

int main(void)
{
    first_call();
    grid bars = grid_of(LENGTH);
    const uint64_t print = in_child(&bars, RLIM_INFINITY, 1).print;
    CHECK(in_child(&bars, RLIM_INFINITY, 2).print == print, "two threads: other bits");
    ladder(&bars, 1, print);
    ladder(&bars, 2, print);
    grid_free(&bars);
    return check_result();
}
