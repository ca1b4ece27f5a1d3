/* What the C ABI costs on the smallest problem of contact: created, handed over, solved, read and destroyed again and
   again on one thread; the median of its process time. overhead [jobs]

   springs 2 (to the ground) and 4 in series, load 6 at the end, wall at distance 1:  u = (2/3, 1), lambda = 14/3. */
#define _POSIX_C_SOURCE 200112L
#include <math.h>
#include <time.h>

#include "check.h"

enum { WARM = 100, MOST = 20000 };

static const int32_t PTR[3] = { 0, 1, 3 }, COL[3] = { 0, 0, 1 }, ROW_PTR[2] = { 0, 1 }, ROW_BODY[1] = { 0 }, ROW_DOF[1] = { 1 };
static const double VAL[3] = { 6.0, -4.0, 4.0 }, LOAD[2] = { 0.0, 6.0 }, ONE[1] = { 1.0 };
static const double GOAL = 50.0; /* microseconds */

/* The whole job of a host; u and lambda are its answer. */
static void job(double u[2], double lambda[1])
{
    feti_problem *p = NULL;
    feti_info info = { .struct_size = sizeof info };
    int64_t body;

    OK(feti_problem_create(&p));
    OK(feti_body_add(p, 2, &body));
    OK(feti_body_stiffness_i32(p, body, 2, PTR, COL, VAL, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_null_space(p, body, 0, 2, NULL, 2, FETI_EXACT));
    OK(feti_body_load(p, body, 2, LOAD));
    OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, ONE, 0, ONE, NULL));
    OK(feti_set_i64(p, "threads", 1));
    OK(feti_solve(p, &info));
    OK(feti_displacement(p, body, 2, u));
    OK(feti_multipliers(p, FETI_INEQUALITY, 1, lambda));
    OK(feti_problem_destroy(&p));
}

static double microseconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e6 * (double)now.tv_sec + 1e-3 * (double)now.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    static double taken[MOST];
    const int asked = argc > 1 ? atoi(argv[1]) : 2000;
    const int jobs = asked < 1 ? 1 : asked > MOST ? MOST : asked;
    double u[2] = { 0 }, lambda[1] = { 0 };

    for (int k = -WARM; k < jobs; k++) {
        const double begun = microseconds();
        job(u, lambda);
        if (k >= 0) taken[k] = microseconds() - begun;
        CHECK(fabs(u[0] - 2.0 / 3.0) + fabs(u[1] - 1.0) + fabs(lambda[0] - 14.0 / 3.0) < 1e-9, "u = %g %g, lambda = %g", u[0],
              u[1], lambda[0]);
    }
    qsort(taken, (size_t)jobs, sizeof taken[0], ascending);
    printf("bench abi overhead_us %.1f goal %.0f %s\n", taken[jobs / 2], GOAL, taken[jobs / 2] <= GOAL ? "ok" : "short");
    return check_result();
}
