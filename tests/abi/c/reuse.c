/* Nothing is computed twice: what a change of the problem costs, by the counters of feti_info.

   Eight bars of nine unknowns, springs of stiffness 1 from the ground to the first and from each to the next, pushed
   towards an obstacle at 1 in front of every unknown but the last. */
#include <stddef.h>

#include "check.h"

enum { BARS = 8, NODES = 9, FIRST_ROWS = NODES - 1 };

/* Analyses, factorisations, columns computed and kept. */
enum { COUNTERS = 4 };

static int32_t give_stiffness(feti_problem *problem, int64_t body, double stiffness)
{
    int32_t ptr[NODES + 1] = { 0 }, col[2 * NODES];
    double val[2 * NODES];
    int32_t at = 0;

    for (int32_t i = 0; i < NODES; i++) {
        if (i > 0) {
            col[at] = i - 1;
            val[at++] = -stiffness;
        }
        col[at] = i;
        val[at++] = (i + 1 < NODES ? 2.0 : 1.0) * stiffness;
        ptr[i + 1] = at;
    }
    return feti_body_stiffness_i32(problem, body, NODES, ptr, col, val, 0, FETI_LOWER, FETI_COPY);
}

static int32_t give_load(feti_problem *problem, int64_t body, double load)
{
    double f[NODES] = { 0.0 };

    f[NODES - 1] = load;
    return feti_body_load(problem, body, NODES, f);
}

/* u <= 1 for unknowns first to last of every bar. */
static int32_t give_rows(feti_problem *problem, int32_t first, int32_t last)
{
    int32_t ptr[BARS * NODES + 1] = { 0 }, body[BARS * NODES], dof[BARS * NODES], rows = 0;
    double val[BARS * NODES], gap[BARS * NODES];

    for (int32_t b = 0; b < BARS; b++) {
        for (int32_t i = first; i <= last; i++) {
            body[rows] = b;
            dof[rows] = i;
            val[rows] = 1.0;
            gap[rows] = 1.0;
            rows++;
            ptr[rows] = rows;
        }
    }
    return feti_rows_add_i32(problem, FETI_INEQUALITY, rows, ptr, body, dof, val, 0, gap, NULL);
}

/* Solves; what it cost is what was wanted, and the last row of every bar carries what its spring does not. */
static void check_step(feti_problem *problem, int64_t before[COUNTERS], const int64_t wanted[COUNTERS], const char *what)
{
    feti_info info = { .struct_size = sizeof info };
    int64_t all[COUNTERS];

    OK(feti_solve(problem, &info));
    all[0] = info.analyses;
    all[1] = info.factorisations;
    all[2] = info.columns_computed;
    all[3] = info.columns_kept;
    for (int k = 0; k < COUNTERS; k++) {
        CHECK(all[k] - before[k] == wanted[k], "%s: counter %d says %lld, expected %lld", what, k,
              (long long)(all[k] - before[k]), (long long)wanted[k]);
        before[k] = all[k];
    }
}

static void check_end(feti_problem *problem, double by_hand, const char *what)
{
    for (int64_t b = 0; b < BARS; b++) {
        double u[NODES] = { 0.0 };
        OK(feti_displacement(problem, b, NODES, u));
        CHECK(fabs(u[NODES - 1] - by_hand) <= 1e-7, "%s: bar %lld ends at %g, by hand %g", what, (long long)b,
              u[NODES - 1], by_hand);
    }
}

/* A caller whose struct ends before the counters of columns gets nothing beyond its end. */
static void an_older_caller(feti_problem *problem)
{
    feti_info info = { .struct_size = offsetof(feti_info, columns_computed), .columns_computed = -7, .columns_kept = -8 };

    OK(feti_solve(problem, &info));
    CHECK(info.factorisations > 0 && info.columns_computed == -7 && info.columns_kept == -8, "%lld %lld written",
          (long long)info.columns_computed, (long long)info.columns_kept);
}

int main(void)
{
    feti_problem *problem = NULL;
    int64_t before[COUNTERS] = { 0 }, body = -1;

    MUST(feti_problem_create(&problem));
    for (int64_t b = 0; b < BARS; b++) {
        MUST(feti_body_add(problem, NODES, &body));
        MUST(give_stiffness(problem, b, 1.0));
        MUST(give_load(problem, b, 0.5));
    }
    MUST(give_rows(problem, 0, FIRST_ROWS - 1));
    /* the last but one stands at the obstacle, the last goes on by 0.5 / 1 */
    check_step(problem, before, (int64_t[]){ 1, 1, BARS * FIRST_ROWS, 0 }, "eight equal bars");
    check_end(problem, 1.5, "eight equal bars");

    for (int64_t b = 0; b < BARS; b++)
        OK(give_load(problem, b, 0.75));
    check_step(problem, before, (int64_t[]){ 0, 0, 0, 0 }, "new loads");
    check_end(problem, 1.75, "new loads");

    for (int64_t b = 0; b < BARS; b++) {
        OK(give_stiffness(problem, b, 1.0 + (double)b / 16.0));
        OK(give_load(problem, b, 0.75 * (1.0 + (double)b / 16.0)));
    }
    check_step(problem, before, (int64_t[]){ 0, BARS - 1, BARS * FIRST_ROWS - FIRST_ROWS, FIRST_ROWS }, "new values");
    check_end(problem, 1.75, "new values");

    OK(give_rows(problem, NODES - 1, NODES - 1));
    check_step(problem, before, (int64_t[]){ 0, 0, BARS * NODES, 0 }, "new rows");
    check_end(problem, 1.0, "new rows");

    OK(feti_rows_clear(problem, FETI_INEQUALITY));
    OK(give_rows(problem, 0, NODES - 1));
    check_step(problem, before, (int64_t[]){ 0, 0, 0, BARS * NODES }, "the same rows again");
    an_older_caller(problem);
    OK(feti_problem_destroy(&problem));
    return check_result();
}
