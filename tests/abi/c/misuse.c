/* Every function with a handle that is none, and with one whose problem is busy: each with its exact status. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>

#include "calls.h"

static void with_every_function(feti_problem *p, int32_t status, const char *when)
{
    FOR_EACH(f, TAKES_HANDLE) expect(f, p, 0, status, when);
}

static void no_handles(void)
{
    int64_t local[8] = { 0 };
    feti_problem *dead = problem_for(FUNCTIONS), *copy = dead;

    OK(feti_problem_destroy(&dead));
    with_every_function(NULL, FETI_HANDLE, "NULL");
    with_every_function(copy, FETI_HANDLE, "destroyed");
    with_every_function((feti_problem *)(void *)local, FETI_HANDLE, "the address of a variable");
    with_every_function((feti_problem *)(uintptr_t)1000000007, FETI_HANDLE, "a number never given");
    with_every_function((feti_problem *)UINTPTR_MAX, FETI_HANDLE, "the largest number");
}

static void while_busy(feti_problem *p, const char *when)
{
    FOR_EACH(f, TAKES_HANDLE) expect(f, p, 0, f->flags & NEVER_BUSY ? FETI_OK : FETI_BUSY, when);
}

static void *second_thread(void *p)
{
    while_busy(p, "from a second thread");
    return NULL;
}

typedef struct {
    feti_problem *p;
    int phase, calls;
} visit;

/* Once in the given phase of a solve: from inside, then from another thread while the solve waits here. */
static int32_t visited(void *user, const feti_progress *now)
{
    visit *v = user;
    pthread_t thread;

    if (now->phase != v->phase || v->calls++ > 0) return 0;
    while_busy(v->p, "from a progress function");
    CHECK(pthread_create(&thread, NULL, second_thread, v->p) == 0, "no thread");
    CHECK(pthread_join(thread, NULL) == 0, "the thread did not end");
    return 0;
}

/* feti_cancel was among the calls: that solve is cancelled, the next one as ever. */
static void busy(int phase)
{
    double before[ANSWER], after[ANSWER];
    visit v = { problem_for(FUNCTIONS), phase, 0 };
    const double k[4] = { 6.0, -4.0, -4.0, 4.0 };

    OK(answer(v.p, before));
    OK(feti_body_stiffness_dense(v.p, 0, 2, k, 2, FETI_FULL, FETI_COPY));
    OK(feti_rows_rhs(v.p, FETI_INEQUALITY, 0, 1, (double[1]){ 2.0 }));
    OK(feti_on_progress(v.p, visited, &v));
    EXPECT(FETI_CANCELLED, feti_solve(v.p, NULL));
    CHECK(v.calls > 0, "phase %d was never told", phase);
    OK(feti_on_progress(v.p, NULL, NULL));
    OK(feti_rows_rhs(v.p, FETI_INEQUALITY, 0, 1, (double[1]){ 1.0 }));
    OK(answer(v.p, after));
    CHECK(memcmp(before, after, sizeof before) == 0, "another answer after the calls from inside");
    OK(feti_problem_destroy(&v.p));
}

int main(void)
{
    no_handles();
    busy(FETI_PHASE_SETUP);
    busy(FETI_PHASE_SOLVE);
    return check_result();
}
