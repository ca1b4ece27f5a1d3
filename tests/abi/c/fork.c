/* A host that forks after the library has started its threads: parent and child go on, each with the problem that was
   there and with a new one, to the same bits. fork <data folder> */
#define _POSIX_C_SOURCE 200809L
#include <sys/wait.h>
#include <unistd.h>

#include "handover.h"

enum { SECONDS = 60, THREADS = 2 };

static const form LOWER = { .storage = FETI_LOWER };

static feti_problem *on_two_threads(const case_data *data)
{
    feti_problem *problem = handed_over(data, &LOWER);
    MUST(feti_set_i64(problem, "threads", THREADS));
    return problem;
}

/* Makes the factors again, in parallel, and solves. */
static void solve_again(feti_problem *problem, const case_data *data, const answer *wanted, const char *who)
{
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_matrix *k = &data->body[b].stiffness;
        OK(feti_body_stiffness_i32(problem, b, k->rows, k->row_ptr, k->col, k->val, 0, FETI_LOWER, FETI_COPY));
    }
    answer found = solved(problem, data);
    CHECK(memcmp(found.u, wanted->u, (size_t)data->unknowns * sizeof(double)) == 0, "%s: other displacements", who);
    CHECK(memcmp(found.lambda, wanted->lambda, (size_t)data->rows * sizeof(double)) == 0, "%s: other forces", who);
    answer_free(&found);
}

static void with_both(feti_problem *old, const case_data *data, const answer *wanted, const char *who)
{
    feti_problem *fresh = on_two_threads(data);
    solve_again(old, data, wanted, who);
    solve_again(fresh, data, wanted, who);
    OK(feti_problem_destroy(&fresh));
}

/* Forks `generations` times, each child from the one before; every child must end by itself without a fault. */
static void in_child(feti_problem *old, const case_data *data, const answer *wanted, int generations)
{
    int status = -1;
    const pid_t child = fork();

    if (child == 0) {
        alarm(SECONDS);
        with_both(old, data, wanted, "child");
        if (generations > 1) in_child(old, data, wanted, generations - 1);
        OK(feti_problem_destroy(&old));
        exit(check_result());
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child, "no child");
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "child ended by signal %d, code %d",
          WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

int main(int argc, char **argv)
{
    case_data data;
    if (argc < 2) return 2;
    alarm(4 * SECONDS);
    read_or_stop(argv[1], "p3_2block", &data);

    feti_problem *problem = on_two_threads(&data);
    answer wanted = solved(problem, &data);
    check_forces("p3_2block", &data, &wanted);
    in_child(problem, &data, &wanted, 2);
    with_both(problem, &data, &wanted, "parent");
    in_child(problem, &data, &wanted, 1);
    OK(feti_problem_destroy(&problem));
    answer_free(&wanted);
    case_free(&data);
    return check_result();
}
