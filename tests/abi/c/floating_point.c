/* A host that traps floating-point exceptions, flushes denormal numbers or rounds upwards: every call works, gives the
   bits of the default environment and leaves the environment of the host as it was. floating_point <data folder> */
#define _GNU_SOURCE
#include <fenv.h>
#include <float.h>
#include <xmmintrin.h>

#include "handover.h"
#include "small.h"

/* Flush to zero and denormals are zero, in MXCSR. */
enum { FLUSH = 0x8040 };

typedef struct {
    const char *name;
    int traps, rounding;
    unsigned flush;
} environment;

static const environment HOSTS[] = {
    { "traps", FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW, FE_TONEAREST, 0 },
    { "traps on inexact results", FE_ALL_EXCEPT, FE_TONEAREST, 0 },
    { "flush to zero", 0, FE_TONEAREST, FLUSH },
    { "rounding upwards", 0, FE_UPWARD, 0 },
    { "rounding to zero, traps and flush", FE_INVALID | FE_DIVBYZERO, FE_TOWARDZERO, FLUSH },
};
enum { HOST_COUNT = sizeof HOSTS / sizeof *HOSTS };

/* The environment the library is called in. */
static const environment *host;

static void enter(void)
{
    fesetround(host->rounding);
    _mm_setcsr(_mm_getcsr() | host->flush);
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(host->traps);
}

/* Back to the default, in which the driver compares. */
static void leave(void)
{
    fesetenv(FE_DFL_ENV);
}

/* The status of a call made in the host's environment, which must be the same afterwards, exception flags included. */
#define IN_HOST(expected, call)                                                                                \
    do {                                                                                                       \
        enter();                                                                                               \
        const unsigned before = _mm_getcsr();                                                                  \
        const int32_t found = (call);                                                                          \
        const unsigned after = _mm_getcsr();                                                                   \
        const int rounding = fegetround(), traps = fegetexcept();                                              \
        leave();                                                                                               \
        CHECK(found == (expected), "%s: %s returned %d", host->name, #call, (int)found);                       \
        CHECK(before == after, "%s: %s changed MXCSR from %x to %x", host->name, #call, before, after);        \
        CHECK(rounding == host->rounding && traps == host->traps, "%s: %s left rounding %x, traps %x",         \
              host->name, #call, (unsigned)rounding, (unsigned)traps);                                         \
    } while (0)

/* Hand-over, solve and results of a case. */
static answer solved_in_host(const case_data *data)
{
    answer result = { .info = { .struct_size = sizeof result.info } };
    feti_certificate verdict = { .struct_size = sizeof verdict };
    feti_problem *p = NULL;
    int64_t number;

    IN_HOST(FETI_OK, feti_problem_create(&p));
    IN_HOST(FETI_OK, feti_set_i64(p, "threads", 2));
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        const case_matrix *k = &body->stiffness;
        IN_HOST(FETI_OK, feti_body_add(p, body->n, &number));
        IN_HOST(FETI_OK, feti_body_stiffness_i32(p, b, body->n, k->row_ptr, k->col, k->val, 0, FETI_LOWER, FETI_COPY));
        IN_HOST(FETI_OK, feti_body_null_space(p, b, body->null_columns, body->n, body->null_space, body->n, FETI_EXACT));
        IN_HOST(FETI_OK, feti_body_load(p, b, body->n, data->load + body->first));
    }
    IN_HOST(FETI_OK, feti_rows_add_i32(p, FETI_INEQUALITY, data->rows, data->contact.row_ptr, NULL, data->contact.col,
                                       data->contact.val, 0, data->gap, NULL));
    if (data->equalities)
        IN_HOST(FETI_OK, feti_rows_add_i32(p, FETI_EQUALITY, data->equalities, data->equality.row_ptr, NULL,
                                           data->equality.col, data->equality.val, 0, data->prescribed, NULL));
    IN_HOST(FETI_OK, feti_setup(p));
    IN_HOST(FETI_OK, feti_solve(p, &result.info));
    result.u = check_array(data->unknowns, sizeof *result.u);
    result.lambda = check_array(data->rows, sizeof *result.lambda);
    result.mu = check_array(data->equalities, sizeof *result.mu);
    for (int64_t b = 0; b < data->bodies; b++)
        IN_HOST(FETI_OK, feti_displacement(p, b, data->body[b].n, result.u + data->body[b].first));
    IN_HOST(FETI_OK, feti_multipliers(p, FETI_INEQUALITY, data->rows, result.lambda));
    IN_HOST(FETI_OK, feti_multipliers(p, FETI_EQUALITY, data->equalities, result.mu));
    IN_HOST(FETI_OK, feti_check(p, data->unknowns, result.u, data->rows, result.lambda, data->equalities, result.mu, &verdict));
    IN_HOST(FETI_OK, feti_problem_destroy(&p));
    return result;
}

static void same_bits_in_every_environment(const case_data *data, const char *name)
{
    static const environment calm = { "default", 0, FE_TONEAREST, 0 };
    host = &calm;
    answer wanted = solved_in_host(data);
    check_forces(name, data, &wanted);
    for (int k = 0; k < HOST_COUNT; k++) {
        host = &HOSTS[k];
        answer found = solved_in_host(data);
        CHECK(memcmp(found.u, wanted.u, (size_t)data->unknowns * sizeof(double)) == 0, "%s, %s: other displacements", name, host->name);
        CHECK(memcmp(found.lambda, wanted.lambda, (size_t)data->rows * sizeof(double)) == 0, "%s, %s: other forces", name, host->name);
        answer_free(&found);
    }
    answer_free(&wanted);
}

/* Calls that fail, and numbers that trap as soon as they are computed with. */
static void refusals_do_not_trap(void)
{
    const double strange[3][2] = { { NAN, 1.0 }, { INFINITY, 1.0 }, { -1.0, HUGE_VAL } };
    const double tiny[2] = { DBL_MIN / 4.0, -6.0 };
    double number;
    char text[128];

    for (int k = 0; k < HOST_COUNT; k++) {
        feti_problem *p = small_problem();
        host = &HOSTS[k];
        for (int i = 0; i < 3; i++) IN_HOST(FETI_ARGUMENT - 4, feti_body_load(p, BLOCK, 2, strange[i]));
        IN_HOST(FETI_ARGUMENT - 3, feti_set_f64(p, "tolerance", strange[0][0]));
        IN_HOST(FETI_STATE, feti_displacement(p, BLOCK, 2, (double[2]){ 0.0, 0.0 }));
        IN_HOST(FETI_HANDLE, feti_setup(NULL));
        IN_HOST(FETI_OK, feti_get_f64(p, "time_limit", &number));
        IN_HOST(FETI_OK, feti_body_load(p, BLOCK, 2, tiny));
        IN_HOST(FETI_OK, feti_solve(p, NULL));
        IN_HOST(FETI_OK, feti_set_i64(p, "fault_injection", 1));
        IN_HOST(FETI_INTERNAL, feti_solve(p, NULL));
        IN_HOST(FETI_OK, feti_last_error(text, sizeof text) > 0 ? FETI_OK : FETI_INTERNAL);
        IN_HOST(FETI_OK, feti_problem_destroy(&p));
    }
}

int main(int argc, char **argv)
{
    const char *const names[2] = { "p2_A", "p3_2block" };
    case_data data;
    if (argc < 2) return 2;

    refusals_do_not_trap();
    for (int k = 0; k < 2; k++) {
        read_or_stop(argv[1], names[k], &data);
        same_bits_in_every_environment(&data, names[k]);
        case_free(&data);
    }
    return check_result();
}
