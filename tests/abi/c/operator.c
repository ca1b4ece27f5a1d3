/* A host with a factorisation of its own: the answer is that of the matrices, its functions run on its thread alone or on
   any, in its floating-point environment; from inside it cancels and finds the problem busy; what fails is named.
   operator <data folder> [case ...] */
#define _POSIX_C_SOURCE 200112L
#include <fenv.h>
#include <pthread.h>
#include <xmmintrin.h>

#include "skyline.h"
#include "small.h"

static const form LOWER = { .storage = FETI_LOWER };

/* The host, and what its functions do at call number `when` (from 1). */
typedef struct {
    feti_problem *problem;
    const case_data *data;
    skyline factor[CASE_BODIES_MAX];
    pthread_t caller;
    pthread_mutex_t lock;
    unsigned rounding;
    int calls, elsewhere, columns_of_kplus;
    int when, reply, cancels, asks;
} own_host;

static void ask_inside(own_host *host)
{
    const double diag[1] = { 1.0 };
    feti_problem *copy = host->problem;
    int64_t bodies, length;

    EXPECT(FETI_BUSY, feti_counts(host->problem, &bodies, NULL, NULL, NULL));
    EXPECT(FETI_BUSY, feti_solve(host->problem, NULL));
    EXPECT(FETI_BUSY, feti_body_operator(host->problem, 0, 1, diag, NULL, NULL, 0, NULL));
    EXPECT(FETI_BUSY, feti_problem_destroy(&copy));
    OK(feti_problem_error(host->problem, NULL, 0, &length));
    feti_problem *other = small_problem();
    check_small_answer(other, "a function of another problem");
    OK(feti_problem_destroy(&other));
}

/* Counts a call; the reply. */
static int32_t enter(own_host *host, int64_t columns_of_kplus)
{
    pthread_mutex_lock(&host->lock);
    const int call = ++host->calls;
    host->elsewhere += !pthread_equal(host->caller, pthread_self());
    host->columns_of_kplus += (int)columns_of_kplus;
    pthread_mutex_unlock(&host->lock);
    CHECK(_MM_GET_ROUNDING_MODE() == host->rounding, "call %d in another environment", call);
    if (call != host->when) return 0;
    if (host->cancels) OK(feti_cancel(host->problem));
    if (host->asks) ask_inside(host);
    return host->reply;
}

static int32_t kplus(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    own_host *host = user;

    CHECK(n == host->data->body[body].n && nrhs >= 1 && nrhs <= 32 && ldx >= n && ldy >= n, "body %d, nrhs %d", (int)body, (int)nrhs);
    for (int64_t j = 0; j < nrhs; j++) {
        memcpy(y + j * ldy, x + j * ldx, (size_t)n * sizeof *y);
        skyline_solve(&host->factor[body], y + j * ldy);
    }
    return enter(host, nrhs);
}

static int32_t k(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    own_host *host = user;

    for (int64_t j = 0; j < nrhs; j++) {
        for (int64_t i = 0; i < n; i++) CHECK(y[i + j * ldy] == 0.0, "y is not zero");
        multiply(&host->data->body[body].stiffness, x + j * ldx, y + j * ldy);
    }
    return enter(host, 0);
}

static double *diagonal_of(const case_body *body)
{
    double *diag = check_array(body->n, sizeof *diag);
    const case_matrix *m = &body->stiffness;
    for (int64_t i = 0; i < body->n; i++)
        for (int32_t e = m->row_ptr[i]; e < m->row_ptr[i + 1]; e++)
            if (m->col[e] == i) diag[i] = m->val[e];
    return diag;
}

/* Body b by its functions. */
static void give(own_host *host, int64_t b, int32_t concurrent)
{
    double *diag = diagonal_of(&host->data->body[b]);
    OK(feti_body_operator(host->problem, b, host->data->body[b].n, diag, kplus, k, concurrent, host));
    free(diag); /* copied */
}

static own_host *host_of(const case_data *data)
{
    own_host *host = check_array(1, sizeof *host);

    *host = (own_host){ .problem = handed_over(data, &LOWER), .data = data, .caller = pthread_self() };
    pthread_mutex_init(&host->lock, NULL);
    for (int64_t b = 0; b < data->bodies; b++) host->factor[b] = skyline_of(&data->body[b]);
    return host;
}

static void host_free(own_host *host)
{
    OK(feti_problem_destroy(&host->problem));
    for (int64_t b = 0; b < host->data->bodies; b++) skyline_free(&host->factor[b]);
    pthread_mutex_destroy(&host->lock);
    free(host);
}

/* The known answer with all bodies, or all but the first, by functions; the same bits on any threads. */
static void the_answer_is_that_of_matrices(const char *name, const case_data *data)
{
    answer first = { 0 };

    for (int from = 1; from >= 0; from--)
        for (int32_t concurrent = 0; concurrent <= 1; concurrent++) {
            own_host *host = host_of(data); /* a second solve of one problem may use an F that the first has paid for: other bits */
            OK(feti_set_i64(host->problem, "threads", 4));
            for (int64_t b = from; b < data->bodies; b++) give(host, b, concurrent);
            host->calls = host->elsewhere = 0;
            answer result = solved(host->problem, data);
            check_forces(name, data, &result);
            if (result.info.undetermined == 0) check_displacements(name, data, &result);
            CHECK(host->calls > 0, "%s: no call", name);
            if (!concurrent) CHECK(host->elsewhere == 0, "%s: %d calls on another thread", name, host->elsewhere);
            if (concurrent && data->unknowns > 1000) CHECK(host->elsewhere > 0, "%s: all calls on one thread", name);
            host_free(host);
            if (!concurrent) {
                first = result;
                continue;
            }
            CHECK(memcmp(first.u, result.u, (size_t)data->unknowns * sizeof(double)) == 0, "%s: other bits", name);
            answer_free(&first);
            answer_free(&result);
        }
}

/* Rounding upwards on whatever thread; afterwards the host has its environment still. */
static void functions_see_the_environment_of_the_host(const char *name, const case_data *data)
{
    own_host *host = host_of(data);

    for (int64_t b = 0; b < data->bodies; b++) give(host, b, 1);
    host->rounding = _MM_ROUND_UP;
    fesetround(FE_UPWARD);
    answer result = solved(host->problem, data);
    const unsigned rounding = _MM_GET_ROUNDING_MODE();
    fesetround(FE_TONEAREST);
    CHECK(rounding == _MM_ROUND_UP, "the environment of the host is gone");
    check_forces(name, data, &result);
    answer_free(&result);
    host_free(host);
}

/* A second load step asks for K+ f, and once for u for every certificate. */
static void a_load_step_costs_few_products(const case_data *data)
{
    own_host *host = host_of(data);

    for (int64_t b = 0; b < data->bodies; b++) give(host, b, 0);
    answer result = solved(host->problem, data);
    CHECK(result.info.factorisations == 0 && result.info.analyses == 0, "a factorisation of the library");
    const int all = host->columns_of_kplus;
    answer_free(&result);
    for (int64_t b = 0; b < data->bodies; b++) OK(feti_body_load(host->problem, b, data->body[b].n, data->load + data->body[b].first));
    result = solved(host->problem, data);
    const int step = host->columns_of_kplus - all;
    CHECK(step >= 2 * data->bodies && step <= 4 * data->bodies, "%d columns for a load step, %d before", step, all);
    answer_free(&result);
    host_free(host);
}

static void inside_the_functions(const char *name, const case_data *data)
{
    own_host *host = host_of(data);
    feti_error_detail detail = { .struct_size = sizeof detail };

    for (int64_t b = 0; b < data->bodies; b++) give(host, b, 0);
    host->when = host->cancels = 1;
    EXPECT(FETI_CANCELLED, feti_solve(host->problem, NULL));
    host->cancels = host->calls = 0;
    for (host->when = 1; host->when <= 5; host->when++) {
        host->reply = host->when % 2 ? 7 : -7;
        host->calls = 0;
        EXPECT(FETI_CALLBACK, feti_solve(host->problem, NULL));
        OK(feti_last_error_detail(&detail));
        CHECK(detail.value == host->reply && detail.body >= 0 && detail.body < data->bodies, "value %g, body %d", detail.value, (int)detail.body);
        /* the functions of one problem are tried once more: nothing of the failed setup is kept that they must give */
        for (int64_t b = 0; b < data->bodies; b++) give(host, b, 0);
    }
    host->asks = 1;
    for (int32_t concurrent = 0; concurrent <= 1; concurrent++) {
        host->reply = host->calls = 0;
        host->when = 2;
        for (int64_t b = 0; b < data->bodies; b++) give(host, b, concurrent);
        answer result = solved(host->problem, data);
        check_forces(name, data, &result);
        CHECK(host->calls > 2, "nothing was asked");
        answer_free(&result);
    }
    host_free(host);
}

/* The spring of small.h, stiffness 2, by functions that are wrong by a factor. */
typedef struct {
    double k, kplus;
} one_spring;

static int32_t spring_kplus(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    for (int64_t j = 0; j < nrhs; j++) y[j * ldy] = ((one_spring *)user)->kplus * x[j * ldx];
    return n == 1 && body == SPRING ? 0 : 99;
}

static int32_t spring_k(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    for (int64_t j = 0; j < nrhs; j++) y[j * ldy] = ((one_spring *)user)->k * x[j * ldx];
    return n == 1 && body == SPRING ? 0 : 99;
}

#define GIVE(p, body, n, diag, kplus, k, concurrent) feti_body_operator(p, body, n, diag, kplus, k, concurrent, &spring)

static void wrong_arguments_and_functions(void)
{
    feti_problem *p = small_problem();
    one_spring spring = { 2.0, 0.5 };
    const double diag[1] = { 2.0 }, negative[1] = { -2.0 }, none[1] = { NAN };
    double x[1] = { 3.0 }, y[1] = { 0.0 };
    int64_t dof[1];

    EXPECT(FETI_HANDLE, GIVE(NULL, SPRING, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 2, GIVE(p, 2, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 2, GIVE(p, -1, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 3, GIVE(p, SPRING, 2, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 4, GIVE(p, SPRING, 1, NULL, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 4, GIVE(p, SPRING, 1, negative, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 4, GIVE(p, SPRING, 1, none, spring_kplus, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 5, GIVE(p, SPRING, 1, diag, NULL, spring_k, 0));
    EXPECT(FETI_ARGUMENT - 6, GIVE(p, SPRING, 1, diag, spring_kplus, NULL, 0));
    EXPECT(FETI_ARGUMENT - 7, GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 2));
    check_small_answer(p, "refused functions");

    OK(GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 0));
    check_small_answer(p, "functions");
    OK(feti_body_kplus(p, SPRING, 1, 1, x, 1, y, 1));
    CHECK(y[0] == 1.5, "K+ 3 = %g", y[0]);
    EXPECT(FETI_UNSUPPORTED, feti_body_fixing(p, SPRING, 0, dof));
    OK(feti_amplitudes(p, BLOCK, 1, y));

    spring.kplus = 0.25;
    OK(GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_CALLBACK, feti_solve(p, NULL));
    check_last_error(p, &(expectation){ FETI_CALLBACK, SPRING, 0, -1, -1, "feti_solve", "no inverse of its K" });
    spring = (one_spring){ 2.0, NAN };
    EXPECT(FETI_CALLBACK, feti_solve(p, NULL));
    check_last_error(p, &(expectation){ FETI_CALLBACK, SPRING, 0, -1, -1, "feti_solve", "not a finite number" });
    spring = (one_spring){ -2.0, -0.5 };
    EXPECT(FETI_INDEFINITE, feti_solve(p, NULL));
    spring = (one_spring){ 2.0, 0.5 };
    OK(feti_body_null_space(p, SPRING, 1, 1, diag, 1, FETI_EXACT));
    EXPECT(FETI_NULL_SPACE, feti_solve(p, NULL));
    OK(feti_body_null_space(p, SPRING, 0, 1, NULL, 1, FETI_EXACT));
    check_small_answer(p, "wrong functions");
    OK(feti_body_stiffness_i32(p, SPRING, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    spring.k = NAN;
    check_small_answer(p, "a matrix instead");
    OK(feti_problem_destroy(&p));
}

static void soft_motions_of_a_host_s_own_inverse_are_not_supported(void)
{
    feti_problem *p = small_problem();
    one_spring spring = { 2.0, 0.5 };
    const double diag[1] = { 2.0 };
    const int32_t one[1] = { 1 };

    OK(feti_body_coordinates_flags(p, SPRING, FETI_SOFT));
    OK(feti_body_coordinates(p, SPRING, 1, 1, one, one, diag, 1));
    OK(GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 0));
    check_small_answer(p, "soft coordinates behind a null space");
    OK(feti_problem_destroy(&p));
    OK(feti_problem_create(&p));
    int64_t body;
    OK(feti_body_add(p, 1, &body));
    OK(feti_body_coordinates(p, SPRING, 1, 1, one, one, diag, 1));
    OK(feti_body_coordinates_flags(p, SPRING, FETI_SOFT));
    OK(GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_UNSUPPORTED, feti_setup(p));
    OK(feti_problem_destroy(&p));
}

static void a_missing_null_space_is_named(void)
{
    feti_problem *p = NULL;
    one_spring spring = { 2.0, 0.5 };
    const double diag[1] = { 2.0 };
    int64_t body;

    OK(feti_problem_create(&p));
    OK(feti_body_add(p, 1, &body));
    OK(GIVE(p, SPRING, 1, diag, spring_kplus, spring_k, 0));
    EXPECT(FETI_STATE, feti_setup(p));
    check_last_error(p, &(expectation){ FETI_STATE, SPRING, -1, -1, -1, "feti_setup", "null space has not been given" });
    OK(feti_problem_destroy(&p));
}

int main(int argc, char **argv)
{
    if (argc < 2) return 2;
    wrong_arguments_and_functions();
    soft_motions_of_a_host_s_own_inverse_are_not_supported();
    a_missing_null_space_is_named();
    for (int c = 2; c < argc; c++) {
        case_data data;
        read_or_stop(argv[1], argv[c], &data);
        the_answer_is_that_of_matrices(argv[c], &data);
        functions_see_the_environment_of_the_host(argv[c], &data);
        a_load_step_costs_few_products(&data);
        inside_the_functions(argv[c], &data);
        case_free(&data);
    }
    return check_result();
}
