/* A host that forks while another of its threads creates, solves and destroys problems and so makes pools of threads: every
   child solves a problem of its own, on pools of its own, to the same bits, and ends by itself. fork_threads <forks> */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "grid.h"

/* A child that solves ends in a fraction of a second. */
enum { LENGTH = 28, SECONDS = 20, MOST = 6 };

static volatile sig_atomic_t ended;

static uint64_t solved_on(const grid *bars, int64_t threads)
{
    feti_problem *problem = NULL;
    OK(grid_call(bars, 0, &problem));
    OK(feti_set_i64(problem, "threads", threads));
    for (int call = 1; call < GRID_CALLS; call++) OK(grid_call(bars, call, &problem));
    OK(feti_solve(problem, NULL));
    const uint64_t bits = grid_fingerprint(bars, problem);
    OK(feti_problem_destroy(&problem));
    return bits;
}

/* More sizes than pools are kept: they come and go. Failed calls keep their texts. */
static void *busy(void *argument)
{
    for (int64_t round = 0; !ended; round++) {
        feti_problem *problem = NULL;
        (void)solved_on(argument, 2 + round % MOST);
        for (int k = 0; k < 200; k++) {
            OK(feti_problem_create(&problem));
            (void)feti_set_f64(problem, "no such option", 1.0);
            OK(feti_problem_destroy(&problem));
        }
    }
    return NULL;
}

static void fork_once(const grid *bars, uint64_t wanted, int round)
{
    /* at any moment of what the other thread does */
    const struct timespec moment = { 0, (long)(round * 7919L % 31) * 100000L };
    int status = -1;
    nanosleep(&moment, NULL);
    const pid_t child = fork();
    if (child == 0) {
        alarm(SECONDS);
        CHECK(solved_on(bars, 1 + round % MOST) == wanted, "child %d: other bits", round);
        _exit(check_result());
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child, "no child %d", round);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "child %d ended by signal %d, code %d", round,
          WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

int main(int argc, char **argv)
{
    const int forks = argc > 1 ? atoi(argv[1]) : 100;
    grid bars = grid_of(LENGTH);
    pthread_t thread;
    const uint64_t wanted = solved_on(&bars, 1);

    CHECK(pthread_create(&thread, NULL, busy, &bars) == 0, "no thread");
    for (int round = 0; round < forks && check_result() == 0; round++) fork_once(&bars, wanted, round);
    ended = 1;
    CHECK(pthread_join(thread, NULL) == 0, "the thread is lost");
    CHECK(solved_on(&bars, 2) == wanted, "parent: other bits");
    grid_free(&bars);
    return check_result();
}
