/* A host that runs out of address space: whatever the limit, every call returns FETI_OK or FETI_MEMORY, and with
   more memory the same problem is solved to the same bits. (Option memory_limit: wrong_problems.c.) */
#define _DEFAULT_SOURCE
#include <sys/wait.h>
#include <unistd.h>

#include "grid.h"
#include "limited.h"

enum { LENGTH = 72, SECONDS = 60 };

static int32_t call_of_grid(const void *bars, int call, int64_t threads, feti_problem **problem)
{
    if (call == GRID_CALLS) return feti_solve(*problem, NULL);
    const int32_t status = grid_call(bars, call, problem);
    return call == 0 && status == FETI_OK ? feti_set_i64(*problem, "threads", threads) : status;
}

static uint64_t print_of_grid(const void *bars, feti_problem *problem)
{
    return grid_fingerprint(bars, problem);
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
        limited_now(1);
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
        limited_now(0);
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
    limited_ladder(&(limited_job){ GRID_CALLS + 1, call_of_grid, NULL, print_of_grid, &bars });
    grid_free(&bars);
    return check_result();
}
