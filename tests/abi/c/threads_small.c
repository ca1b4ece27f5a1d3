/* Small problems on several threads, and one that threads share: for checkers of races, which are slow. */
#define _POSIX_C_SOURCE 200112L
#include <pthread.h>

#include "small.h"

enum { JOBS = 10, CALLS = 40 };

/* Problems of this thread's own come and go. */
static void *own_problems(void *unused)
{
    (void)unused;
    for (int k = 0; k < JOBS; k++) {
        feti_problem *problem = small_problem();
        OK(feti_set_i64(problem, "threads", 2));
        check_small_answer(problem, "other threads");
        OK(feti_problem_destroy(&problem));
    }
    return NULL;
}

/* Calls on a problem that another thread uses: done, or refused as busy; never anything else. */
static void *shared_problem(void *argument)
{
    feti_problem *problem = argument;
    double u[2];
    int64_t length;

    for (int k = 0; k < CALLS; k++) {
        const int32_t status = k % 2 ? feti_solve(problem, NULL) : give_block_load(problem);
        CHECK(status == FETI_OK || status == FETI_BUSY || status == FETI_CANCELLED, "status %d", (int)status);
        const int32_t read = feti_displacement(problem, BLOCK, 2, u);
        CHECK(read == FETI_OK || read == FETI_BUSY || read == FETI_STATE, "status %d", (int)read);
        OK(feti_problem_error(problem, NULL, 0, &length));
        if (k % 8 == 7) OK(feti_cancel(problem));
    }
    return NULL;
}

static void on_two_threads(void *(*work)(void *), void *argument)
{
    pthread_t thread[2];

    for (int k = 0; k < 2; k++) CHECK(pthread_create(&thread[k], NULL, work, argument) == 0, "no thread");
    for (int k = 0; k < 2; k++) pthread_join(thread[k], NULL);
}

int main(void)
{
    feti_problem *problem = small_problem();

    on_two_threads(own_problems, NULL);
    on_two_threads(shared_problem, problem);
    check_small_answer(problem, "shared use");
    OK(feti_problem_destroy(&problem));
    return check_result();
}
