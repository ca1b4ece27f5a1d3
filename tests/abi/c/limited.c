#define _DEFAULT_SOURCE
#include "limited.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SECONDS = 60, STEPS = 40 };

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

void limited_now(int limited)
{
    limit_to(limited ? present_size() : RLIM_INFINITY);
}

/* Runs all calls under the limit; a refused one is repeated without the limit, the rest follow under it again. */
static outcome run_under(const limited_job *job, rlim_t room, int64_t threads)
{
    feti_problem *problem = NULL;
    outcome found = { 0 };

    for (int call = 0; call < job->calls; call++) {
        if (room != RLIM_INFINITY) limit_to(present_size() + room);
        const int32_t status = job->call(job->data, call, threads, &problem);
        limit_to(RLIM_INFINITY);
        CHECK(status == FETI_OK || status == FETI_MEMORY, "call %d returned %d", call, (int)status);
        if (status == FETI_OK) continue;
        if (job->refused) job->refused(job->data, call);
        found.refused++;
        EXPECT(FETI_OK, job->call(job->data, call, threads, &problem));
    }
    found.print = job->print(job->data, problem);
    OK(feti_problem_destroy(&problem));
    return found;
}

/* The same in a process of its own, which must end by itself. */
static outcome in_child(const limited_job *job, rlim_t room, int64_t threads)
{
    int ends[2], status = 0;
    outcome found = { 0 };
    if (pipe(ends) != 0) exit(1);
    const pid_t child = fork();

    if (child == 0) {
        alarm(SECONDS);
        check_failures = 0;
        found = run_under(job, room, threads);
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
static void ladder(const limited_job *job, int64_t threads, uint64_t print)
{
    int refused = 0, solved = 0;
    double megabytes = 0.1;

    for (int step = 0; step < STEPS; step++, megabytes = 1.12 * megabytes + 0.5) {
        const outcome found = in_child(job, (rlim_t)(megabytes * 1e6), threads);
        CHECK(found.print == print, "room for %.1f MB, %d threads: other bits", megabytes, (int)threads);
        refused += found.refused > 0;
        solved += found.refused == 0;
    }
    CHECK(refused > 0 && solved > 0, "%d threads: %d runs out of memory, %d not", (int)threads, refused, solved);
}

void limited_ladder(const limited_job *job)
{
    const uint64_t print = in_child(job, RLIM_INFINITY, 1).print;

    CHECK(in_child(job, RLIM_INFINITY, 2).print == print, "two threads: other bits");
    ladder(job, 1, print);
    ladder(job, 2, print);
}
