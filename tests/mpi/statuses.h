/* The problem of statuses.c, what a rank may do wrong in its part of it, and calls in which it errs. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "feti_contact.h"
#include "feti_contact_mpi.h"

enum { RANKS = 3, N = 5, SPARE = 4, NEW = 4, SECONDS = 60 };

/* Bars that stand on each other, from bar 0 on the ground, by the ranks that have them: rank r has r + 1, so that numbers of one rank are
   those of no other. Its next body, the spare, floats but for its equality rows. */
static const int BAR[RANKS][RANKS] = { { 3 }, { 4, 1 }, { 5, 2, 0 } };

static int rank, failures, by /* the rank that errs */, turn;
static const char *at = ""; /* the mistake */

static void fail(const char *what, int32_t status)
{
    char text[400] = "";

    feti_last_error(text, sizeof text);
    fprintf(stderr, "rank %d: %s on rank %d, turn %d: %s: %s (%s)\n", rank, at, by, turn, what, feti_status_name(status), text);
    failures++;
}

#define SURE(call)                                    \
    do {                                              \
        const int32_t status_ = (call);               \
        if (status_) fail(#call, status_);            \
    } while (0)
#define CHECK(condition) ((condition) ? (void)0 : fail(#condition, 0))

/* ---- a good problem */

/* The lower triangle k of two unknowns, twice. */
static void matrix(feti_problem *p, int64_t body, const double k[3])
{
    const int32_t ptr[] = { 0, 1, 3, 4, 6 }, col[] = { 0, 0, 1, 2, 2, 3 };
    const double val[] = { k[0], k[1], k[2], k[0], k[1], k[2] };

    SURE(feti_body_stiffness_i32(p, body, NEW, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
}

/* A chain of n springs that floats. */
static void chain(feti_problem *p, int64_t body, int n, double k)
{
    double val[2 * N], one[N];
    int32_t ptr[N + 1] = { 0 }, col[2 * N];

    for (int i = 0, to = 0; i < n; i++) {
        if (i > 0) col[to] = i - 1, val[to++] = -k;
        col[to] = i, val[to++] = i > 0 && i < n - 1 ? 2.0 * k : k;
        ptr[i + 1] = to, one[i] = 1.0;
    }
    SURE(feti_body_stiffness_i32(p, body, n, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    SURE(feti_body_null_space(p, body, 1, n, one, n, FETI_EXACT));
    SURE(feti_body_fixing_set(p, body, 0, NULL));
}

static void number(feti_problem *p, int64_t body, int n, int64_t first)
{
    int64_t all[N];

    for (int i = 0; i < n; i++) all[i] = first + i;
    SURE(feti_body_numbering_i64(p, body, n, all, 0));
}

static void row(feti_problem *p, int kind, int entries, int64_t first, const double *val, double rhs)
{
    const int64_t ptr[] = { 0, entries }, dof[] = { first, first - 6 };

    SURE(feti_rows_add_i64(p, kind, 1, ptr, NULL, dof, val, 0, &rhs, NULL));
}

static void node(feti_problem *p, int64_t dof, int64_t normal, double val, double coefficient, double bound)
{
    const int64_t ptr[] = { 0, 1 };

    SURE(feti_friction_add_i64(p, 1, 1, &normal, ptr, NULL, &dof, &val, 0, &coefficient, &bound, NULL));
}

static int64_t spare(void) { return rank + 1; }
static int64_t spare_dof(int i) { return 1000 + 10 * rank + i; }
static int64_t bar_dof(int i) { return 10 * BAR[rank][rank] + i; } /* of the last bar */
static int64_t new_dof(int i) { return 2000 + 10 * rank + i; }

/* All that this rank gives, also where it was given before and spoilt. A body of mistakes ends as one that is held, without load. */
static void give(feti_problem *p)
{
    static const double hold[] = { 2.0, -1.0, 2.0 }, rest[N] = { 0.0 }, pair[] = { -1.0, 1.0 }, one = 1.0;
    const char *const options = "threads=1 tolerance=1e-12 certificate_tolerance=1e-8 max_steps=10000 memory_limit=0 direct_limit=1000 "
                                "index_base=0 finish=automatic glue=0 time_limit=1e9";
    int64_t bodies, body;

    SURE(feti_set_text(p, options));
    SURE(feti_on_progress(p, NULL, NULL));
    SURE(feti_on_log(p, NULL, FETI_LOG_NONE, NULL));
    SURE(feti_counts(p, &bodies, NULL, NULL, NULL));
    for (; bodies < rank + 2; bodies++) SURE(feti_body_add(p, bodies <= rank ? N : SPARE, &body));
    for (int k = 0; k <= rank; k++) {
        const int b = BAR[rank][k];
        const double load[N] = { 0.0, 0.25, 0.0, 0.0, -1.0 - b / 8.0 };
        chain(p, k, N, 2.0 + b % 3), number(p, k, N, 10 * b);
        SURE(feti_body_load(p, k, N, load));
    }
    chain(p, spare(), SPARE, 3.0), number(p, spare(), SPARE, spare_dof(0));
    SURE(feti_body_load(p, spare(), SPARE, rest));
    if (bodies > spare() + 1) {
        matrix(p, spare() + 1, hold), number(p, spare() + 1, NEW, new_dof(0));
        SURE(feti_body_no_null_space(p, spare() + 1));
        SURE(feti_body_load(p, spare() + 1, NEW, rest));
    }
    SURE(feti_rows_clear(p, FETI_INEQUALITY));
    SURE(feti_rows_clear(p, FETI_EQUALITY));
    for (int k = 0; k <= rank; k++) {
        row(p, FETI_INEQUALITY, BAR[rank][k] > 0 ? 2 : 1, 10 * BAR[rank][k], pair, 0.1);
        row(p, FETI_EQUALITY, 1, spare_dof(k), &one, 0.01 * (k + 1));
        node(p, 10 * BAR[rank][k] + 1, -1, 1.0, 0.0, 0.01 * (k + 1));
    }
}

/* ---- mistakes */

/* A body of two parts behind the spare, with this matrix and this load on the unknowns of the first. */
static void body(feti_problem *p, const double k[3], double first, double second)
{
    const double f[NEW] = { first, second };
    int64_t new;

    SURE(feti_body_add(p, NEW, &new));
    matrix(p, new, k), number(p, new, NEW, new_dof(0));
    SURE(feti_body_load(p, new, NEW, f));
}

static const double FREE[] = { 1.0, -1.0, 1.0 }, ONE = 1.0;
static const double MOTIONS[] = { 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0 };

static void no_matrix(feti_problem *p)
{
    int64_t new;

    SURE(feti_body_add(p, NEW, &new));
    number(p, new, NEW, new_dof(0));
}

static void no_numbers(feti_problem *p)
{
    int64_t new;

    SURE(feti_body_add(p, NEW, &new));
    matrix(p, new, FREE);
}

static void no_element(feti_problem *p)
{
    const int32_t ptr[] = { 0, 2, 4 }, dof[] = { 0, 1, 2, 3 };
    const double k[] = { 1.0, -1.0, -1.0, 1.0 };

    SURE(feti_body_mesh_i32(p, spare(), 2, ptr, dof, 0));
    SURE(feti_body_element(p, spare(), 0, 2, k, 2));
}

static void nobody(feti_problem *p) { row(p, FETI_INEQUALITY, 1, 999999, &ONE, 0.0); }
static void nobody_at_node(feti_problem *p) { node(p, 999999, -1, 1.0, 0.0, 1.0); }
static void anothers(feti_problem *p) { number(p, spare(), SPARE, 1000 + 10 * ((rank + 1) % RANKS)); }
static void negative_diagonal(feti_problem *p) { body(p, (const double[]){ 1.0, 0.0, -1.0 }, 0.0, 0.0); }
static void negative_pivot(feti_problem *p) { body(p, (const double[]){ 1.0, 2.0, 1.0 }, 0.0, 0.0); }
static void loose(feti_problem *p)
{
    const double load[NEW] = { 0.0, 0.0, 1.0, 0.0 };

    body(p, FREE, 0.0, 0.0);
    SURE(feti_body_load(p, spare() + 1, NEW, load));
}

static void hardly_held(feti_problem *p) { body(p, FREE, 1.0, -1.0 + 1e-9); }

static void beyond_numbers(feti_problem *p) { body(p, (const double[]){ 1e-300, 0.0, 1e300 }, 1.0, 1.0); }

static void negative_motion(feti_problem *p)
{
    body(p, (const double[]){ 1.0 - 1e-3, -1.0, 1.0 - 1e-3 }, 0.0, 0.0);
    SURE(feti_body_null_space(p, spare() + 1, 2, NEW, MOTIONS, NEW, FETI_SOFT));
}

static void wrong_motion(feti_problem *p)
{
    const double motion[] = { 1.0, 2.0, 0.0, 4.0, 1.0 };

    SURE(feti_body_null_space(p, rank, 1, N, motion, N, FETI_EXACT));
}

static void no_motion(feti_problem *p) { SURE(feti_body_no_null_space(p, rank)); }

static void wrong_fixing(feti_problem *p)
{
    const int64_t dof[] = { 0, 1 };

    SURE(feti_body_fixing_set(p, rank, 2, dof));
}

static void slips_away(feti_problem *p) { body(p, FREE, 1.0, 1.0), node(p, new_dof(0), -1, 1.0, 0.0, 0.1); }

/* Pressed against a wall by 1, with a spring across it, and pushed along it by .6, with a coefficient of friction of .5. */
static void slides(feti_problem *p)
{
    body(p, (const double[]){ 0.0, 0.0, 3.0 }, 0.6, 1.0);
    row(p, FETI_INEQUALITY, 1, new_dof(1), &ONE, 0.0), node(p, new_dof(0), rank + 1, 1.0, 0.5, 0.0);
}
static void other_equality(feti_problem *p) { row(p, FETI_EQUALITY, 1, spare_dof(rank), &ONE, 1.0); }
static void below_ground(feti_problem *p) { row(p, FETI_INEQUALITY, 1, spare_dof(rank), &ONE, -1.0); }
static void nothing_below(feti_problem *p) { row(p, FETI_INEQUALITY, 0, 0, &ONE, -1.0); }
static void nothing_equal(feti_problem *p) { row(p, FETI_EQUALITY, 0, 0, &ONE, 1.0); }
static void large_row(feti_problem *p) { row(p, FETI_EQUALITY, 1, bar_dof(2), (const double[]){ 1e200 }, 0.0); }
static void large_node(feti_problem *p) { node(p, bar_dof(2), -1, 1e200, 0.0, 1.0); }
static void small_row(feti_problem *p) { row(p, FETI_INEQUALITY, 1, bar_dof(2), (const double[]){ 1e-200 }, 1.0); }

/* What this rank alone hears of, without a change: options, a row, a gap, a load. */
static void refused(feti_problem *p)
{
    const int64_t ptr[] = { 0, 1 }, dof[] = { bar_dof(2) };
    const double nothing = NAN;

    CHECK(feti_set_f64(p, "tolerance", -1.0) == FETI_ARGUMENT - 3);
    CHECK(feti_set_i64(p, "no_option", 1) == FETI_ARGUMENT - 2);
    CHECK(feti_rows_add_i64(p, FETI_INEQUALITY, 1, ptr, NULL, dof, &nothing, 0, NULL, NULL) == FETI_ARGUMENT - 7);
    CHECK(feti_rows_rhs(p, FETI_INEQUALITY, rank, 1, &nothing) == FETI_ARGUMENT - 5);
    CHECK(feti_body_load(p, rank + 2, N, MOTIONS) == FETI_ARGUMENT - 2);
}

static void soft_row(feti_problem *p)
{
    const double inv_k = 1e308;

    SURE(feti_rows_compliance(p, FETI_INEQUALITY, rank, 1, &inv_k));
}

/* Options of rank 0 count alone. Memory is counted when a factor is made: of a new matrix. */
static void option(feti_problem *p, const char *text) { SURE(feti_set_text(p, text)); }
static void little_memory(feti_problem *p) { option(p, "memory_limit=200"), chain(p, 0, N, 9.0); }
static void little_time(feti_problem *p) { option(p, "time_limit=1e-9"); }
static void one_step(feti_problem *p) { option(p, "max_steps=1 direct_limit=0 finish=none"); }
static void strict(feti_problem *p) { option(p, "certificate_tolerance=1e-14 tolerance=1e-14 direct_limit=0 finish=none"); }
static void closes(feti_problem *p) { SURE(feti_set_i64(p, "fault_injection", 1)); }

/* Functions of the host, which rank 0 alone can have. */
static int32_t fails(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    (void)user, (void)body, (void)n, (void)nrhs, (void)x, (void)ldx, (void)y, (void)ldy;
    return 7;
}

static void functions(feti_problem *p)
{
    static const double diagonal[NEW] = { 1.0, 1.0, 1.0, 1.0 };

    body(p, FREE, 0.0, 0.0);
    SURE(feti_body_operator(p, spare() + 1, NEW, diagonal, fails, fails, 0, NULL));
    SURE(feti_body_null_space(p, spare() + 1, 2, NEW, MOTIONS, NEW, FETI_EXACT));
}

static int32_t answers(void *user, const feti_progress *now) { return (void)now, *(const int32_t *)user; }
static int32_t logs(void *user, int32_t level, const char *text) { return (void)user, (void)level, (void)text, 5; }

static void stops(feti_problem *p)
{
    static int32_t positive = 1;

    SURE(feti_on_progress(p, answers, &positive));
}

static void breaks(feti_problem *p)
{
    static int32_t negative = -4;

    SURE(feti_on_progress(p, answers, &negative));
}

static void breaks_log(feti_problem *p) { SURE(feti_on_log(p, logs, FETI_LOG_STEP, NULL)); }

/* ---- calls in which a rank errs */

static int32_t other_call(feti_problem *p, int wrong) { return wrong ? feti_setup(p) : feti_solve(p, NULL); }
static int32_t reads(feti_problem *p, int wrong) { return (void)wrong, feti_problem_read(p, "nothing.feti"); }
static int32_t writes_nowhere(feti_problem *p, int wrong) { return feti_problem_write(p, wrong ? "no/such/folder.feti" : "written.feti"); }
static int32_t writes_no_path(feti_problem *p, int wrong) { return feti_problem_write(p, wrong ? NULL : "written.feti"); }

static int32_t writes_functions(feti_problem *p, int wrong) { return (void)wrong, feti_problem_write(p, "written.feti"); }

static int32_t short_info(feti_problem *p, int wrong)
{
    feti_info info = { .struct_size = wrong ? 8 : (int64_t)sizeof info };

    return feti_solve(p, &info);
}

static int32_t saves_nowhere(feti_problem *p, int wrong)
{
    int64_t id;

    return feti_state_save(p, wrong ? NULL : &id);
}

static int32_t restores_nothing(feti_problem *p, int wrong)
{
    int64_t id = -1;

    SURE(feti_state_save(p, &id));
    if (wrong) SURE(feti_state_drop(p, id));
    return feti_state_restore(p, id);
}

/* A check of zeros: `what` says which argument is refused. */
static int32_t checks(feti_problem *p, int what)
{
    double zero[64] = { 0.0 };
    feti_certificate seen = { .struct_size = what == 1 ? 8 : (int64_t)sizeof seen };
    int64_t n, rows, eqs, nodes;

    SURE(feti_counts(p, NULL, &n, &rows, &eqs));
    SURE(feti_friction_counts(p, &nodes, NULL));
    if (what == 3) zero[n - 1] = NAN;
    return feti_check_friction(p, n + (what == 2), zero, rows, what == 4 ? NULL : zero + 40, eqs, zero + 40, nodes + (what == 5), 1,
                               zero + 40, &seen);
}

static int32_t checks_nowhere(feti_problem *p, int wrong) { return checks(p, wrong ? 1 : 0); }
static int32_t checks_more(feti_problem *p, int wrong) { return checks(p, wrong ? 2 : 0); }
static int32_t checks_nan(feti_problem *p, int wrong) { return checks(p, wrong ? 3 : 0); }
static int32_t checks_null(feti_problem *p, int wrong) { return checks(p, wrong ? 4 : 0); }
static int32_t checks_nodes(feti_problem *p, int wrong) { return checks(p, wrong ? 5 : 0); }

/* One rank commits its slips; the others follow when all have heard of it. */
static int32_t commits_alone(feti_problem *p, int wrong)
{
    SURE(feti_solve(p, NULL));
    if (wrong) SURE(feti_friction_commit(p));
    const int32_t status = feti_solve(p, NULL);
    if (!wrong) SURE(feti_friction_commit(p));
    if (!wrong) give(p);
    return status;
}

/* Another thread of one rank cancels; rank 0 is slow. */
static volatile int ended;

static void nap(int ms) { nanosleep(&(struct timespec){ .tv_nsec = ms * 1000000L }, NULL); }
static int32_t naps(void *user, const feti_progress *now) { return (void)user, (void)now, nap(50), 0; }

static void *cancels(void *p)
{
    while (!ended) feti_cancel(p), nap(1);
    return NULL;
}

static int32_t cancelled(feti_problem *p, int wrong)
{
    pthread_t thread;

    ended = 0;
    if (rank == 0) SURE(feti_on_progress(p, naps, NULL));
    if (wrong && pthread_create(&thread, NULL, cancels, p)) fail("pthread_create", 0);
    const int32_t status = feti_solve(p, NULL);
    ended = 1;
    if (wrong) pthread_join(thread, NULL);
    SURE(feti_on_progress(p, NULL, NULL));
    return status;
}
