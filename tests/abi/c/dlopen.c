/* A host that loads the library at run time, unloads it while its threads are alive, and loads it again: the same bits,
   and the process ends in order. dlopen <library> */
#define _POSIX_C_SOURCE 200112L
#include <dlfcn.h>

#include "check.h"

/* The functions used, with their names. Bars i = 0, 1: N unknowns in a row joined by 1, held at one end by 1; the last
   unknown of bar 0 is pushed by 1 against that of bar 1 across the gap 0.5. */
enum { N = 40 };
#define FUNCTIONS(F)                                                                                                  \
    F(feti_problem_create) F(feti_problem_destroy) F(feti_set_i64) F(feti_body_add) F(feti_body_stiffness_i32)        \
    F(feti_body_null_space) F(feti_body_load) F(feti_rows_add_i32) F(feti_solve) F(feti_displacement) F(feti_multipliers)
#define MEMBER(name) __typeof__(&(name)) name;
#define LOAD(name) *(void **)&to.name = symbol(library, #name);

typedef struct {
    FUNCTIONS(MEMBER)
} functions;

static void *symbol(void *library, const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "%s\n", dlerror());
        exit(1);
    }
    return found;
}

static functions functions_of(void *library)
{
    functions to;
    FUNCTIONS(LOAD)
    return to;
}

#define CALL(call) CHECK((call) == FETI_OK, "failed")

/* Solves and writes u of both bars and lambda. */
static void solve(const functions *f, double answer[2 * N + 1])
{
    int32_t ptr[N + 1] = { 0 }, col[2 * N];
    double val[2 * N], load[N] = { 0 };
    const int32_t row_ptr[2] = { 0, 2 }, body[2] = { 0, 1 }, dof[2] = { N - 1, N - 1 };
    const double row[2] = { 1.0, -1.0 }, gap[1] = { 0.5 };
    feti_problem *p = NULL;
    int64_t number;

    for (int32_t i = 0; i < N; i++) {
        int32_t at = ptr[i];
        if (i > 0) col[at] = i - 1, val[at++] = -1.0;
        col[at] = i, val[at++] = i + 1 < N ? 2.0 : 1.0;
        ptr[i + 1] = at;
    }
    load[N - 1] = 1.0;
    CALL(f->feti_problem_create(&p));
    CALL(f->feti_set_i64(p, "threads", 2));
    for (int b = 0; b < 2; b++) {
        CALL(f->feti_body_add(p, N, &number));
        CALL(f->feti_body_stiffness_i32(p, b, N, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
        CALL(f->feti_body_null_space(p, b, 0, N, NULL, N, FETI_EXACT));
    }
    CALL(f->feti_body_load(p, 0, N, load));
    CALL(f->feti_rows_add_i32(p, FETI_INEQUALITY, 1, row_ptr, body, dof, row, 0, gap, NULL));
    CALL(f->feti_solve(p, NULL));
    for (int b = 0; b < 2; b++) CALL(f->feti_displacement(p, b, N, answer + b * N));
    CALL(f->feti_multipliers(p, FETI_INEQUALITY, 1, answer + 2 * N));
    CALL(f->feti_problem_destroy(&p));
}

/* By hand: u_0 - u_1 = N (1 - 2 lambda) = 1/2 at the ends. */
int main(int argc, char **argv)
{
    double first[2 * N + 1], again[2 * N + 1];
    const double lambda = 0.5 * (1.0 - 0.5 / N);
    if (argc < 2) return 2;

    for (int time = 0; time < 3; time++) {
        void *library = dlopen(argv[1], time == 1 ? RTLD_LAZY | RTLD_GLOBAL : RTLD_NOW | RTLD_LOCAL);
        if (!library) {
            fprintf(stderr, "%s\n", dlerror());
            return 1;
        }
        const functions loaded = functions_of(library);
        solve(&loaded, time == 0 ? first : again);
        CHECK(time == 0 || memcmp(first, again, sizeof first) == 0, "other bits after dlclose");
        CHECK(dlclose(library) == 0, "dlclose failed");
    }
    CHECK(fabs(first[2 * N] - lambda) <= 1e-9, "lambda = %.12g, by hand %.12g", first[2 * N], lambda);
    CHECK(fabs(first[N - 1] - first[2 * N - 1] - 0.5) <= 1e-9, "the gap is not closed");
    return check_result();
}
