/* New values on the pattern given last: in every storage, sorted or not, dense, at the price of one factorisation.

   A bar of three unknowns, springs a from the ground to the first, b and c between them, pulled by 1 at its end:
   u = 1/a, 1/a + 1/b, 1/a + 1/b + 1/c. */
#include "small.h"

enum { N = 3, MOST = 7 };

/* A way to give the bar: the rows of K = [a+b -b 0; -b b+c -c; 0 -c c], entries counted from 0. */
typedef struct {
    const char *name;
    int32_t storage, base, entries;
    int32_t ptr[N + 1], col[MOST], row[MOST];
} way;

static const way WAYS[] = {
    { "lower", FETI_LOWER, 0, 5, { 0, 1, 3, 5 }, { 0, 0, 1, 1, 2 }, { 0, 1, 1, 2, 2 } },
    { "lower, diagonal first", FETI_LOWER, 0, 5, { 0, 1, 3, 5 }, { 0, 1, 0, 2, 1 }, { 0, 1, 1, 2, 2 } },
    { "upper", FETI_UPPER, 1, 5, { 0, 2, 4, 5 }, { 0, 1, 1, 2, 2 }, { 0, 0, 1, 1, 2 } },
    { "upper, turned", FETI_UPPER, 1, 5, { 0, 2, 4, 5 }, { 1, 0, 2, 1, 2 }, { 0, 0, 1, 1, 2 } },
    { "full", FETI_FULL, 0, 7, { 0, 2, 5, 7 }, { 0, 1, 0, 1, 2, 1, 2 }, { 0, 0, 1, 1, 1, 2, 2 } },
    { "full, turned", FETI_FULL, 1, 7, { 0, 2, 5, 7 }, { 1, 0, 2, 0, 1, 2, 1 }, { 0, 0, 1, 1, 1, 2, 2 } },
};
enum { WAYS_COUNT = sizeof WAYS / sizeof WAYS[0] };

static void bar(const double s[N], double k[N * N])
{
    const double rows[N * N] = { s[0] + s[1], -s[1], 0.0, -s[1], s[1] + s[2], -s[2], 0.0, -s[2], s[2] };
    memcpy(k, rows, sizeof rows);
}

static void values_of(const way *how, const double s[N], double val[MOST])
{
    double k[N * N];

    bar(s, k);
    for (int32_t e = 0; e < how->entries; e++) val[e] = k[N * how->row[e] + how->col[e]];
}

static int32_t give(feti_problem *p, const way *how, const double s[N], int wide)
{
    int32_t ptr[N + 1], col[MOST];
    int64_t ptr64[N + 1], col64[MOST];
    double val[MOST];

    values_of(how, s, val);
    for (int i = 0; i <= N; i++) ptr64[i] = ptr[i] = how->ptr[i] + how->base;
    for (int32_t e = 0; e < how->entries; e++) col64[e] = col[e] = how->col[e] + how->base;
    if (wide) return feti_body_stiffness_i64(p, 0, N, ptr64, col64, val, how->base, how->storage, FETI_COPY);
    return feti_body_stiffness_i32(p, 0, N, ptr, col, val, how->base, how->storage, FETI_COPY);
}

static int32_t give_values(feti_problem *p, const way *how, const double s[N])
{
    double val[MOST];

    values_of(how, s, val);
    return feti_body_values(p, 0, how->entries, val);
}

static feti_problem *begin(void)
{
    const double load[N] = { 0.0, 0.0, 1.0 };
    feti_problem *p = NULL;
    int64_t body = -1;

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, N, &body));
    MUST(feti_body_null_space(p, 0, 0, N, NULL, N, FETI_EXACT));
    MUST(feti_body_load(p, 0, N, load));
    return p;
}

/* Solves; the price and the answer by hand. */
static void check_step(feti_problem *p, const double s[N], int64_t before[2], int64_t analyses, int64_t factorisations,
                       const char *what)
{
    const double by_hand[N] = { 1.0 / s[0], 1.0 / s[0] + 1.0 / s[1], 1.0 / s[0] + 1.0 / s[1] + 1.0 / s[2] };
    feti_info info = { .struct_size = sizeof info };
    double u[N] = { 0.0 };

    OK(feti_solve(p, &info));
    OK(feti_displacement(p, 0, N, u));
    CHECK(check_distance(N, u, by_hand) <= 1e-12, "%s: u = %g %g %g", what, u[0], u[1], u[2]);
    CHECK(info.analyses - before[0] == analyses && info.factorisations - before[1] == factorisations,
          "%s: %lld analyses, %lld factorisations", what, (long long)(info.analyses - before[0]),
          (long long)(info.factorisations - before[1]));
    before[0] = info.analyses;
    before[1] = info.factorisations;
}

/* Largest diagonal entries 6 and 4, between the same powers of two: the unit of the problem stays, and with it old factors. */
static const double FIRST[N] = { 1.0, 2.0, 4.0 }, SECOND[N] = { 3.0, 1.0, 2.0 };

static void every_storage(void)
{
    for (int k = 0; k < WAYS_COUNT; k++)
        for (int wide = 0; wide <= 1; wide++) {
            const way *how = &WAYS[k];
            int64_t before[2] = { 0, 0 };
            feti_problem *p = begin();

            MUST(give(p, how, FIRST, wide));
            check_step(p, FIRST, before, 1, 1, how->name);
            OK(give_values(p, how, SECOND));
            check_step(p, SECOND, before, 0, 1, how->name);
            OK(give_values(p, how, SECOND));
            check_step(p, SECOND, before, 0, 0, how->name);
            OK(feti_problem_destroy(&p));
        }
}

/* The diagonal in an array of its own, every storage, 32 and 64 bits, counted from 0 and 1. */
typedef struct {
    const char *name;
    int32_t storage, base, entries;
    int32_t ptr[N + 1], col[4], row[4];
} split_way;

static const split_way SPLITS[] = {
    { "split, lower", FETI_LOWER, 1, 2, { 0, 0, 1, 2 }, { 0, 1 }, { 1, 2 } },
    { "split, upper", FETI_UPPER, 0, 2, { 0, 1, 2, 2 }, { 1, 2 }, { 0, 1 } },
    { "split, full", FETI_FULL, 0, 4, { 0, 1, 3, 4 }, { 1, 0, 2, 1 }, { 0, 1, 1, 2 } },
    { "split, full, turned", FETI_FULL, 1, 4, { 0, 1, 3, 4 }, { 1, 2, 0, 1 }, { 0, 1, 1, 2 } },
};
enum { SPLITS_COUNT = sizeof SPLITS / sizeof SPLITS[0] };

static void split_values(const split_way *how, const double s[N], double diag[N], double val[4])
{
    double k[N * N];

    bar(s, k);
    for (int i = 0; i < N; i++) diag[i] = k[(N + 1) * i];
    for (int32_t e = 0; e < how->entries; e++) val[e] = k[N * how->row[e] + how->col[e]];
}

static int32_t give_split(feti_problem *p, const split_way *how, const double s[N], int wide)
{
    int32_t ptr[N + 1], col[4] = { 0 };
    int64_t ptr64[N + 1], col64[4] = { 0 };
    double diag[N], val[4];

    split_values(how, s, diag, val);
    for (int i = 0; i <= N; i++) ptr64[i] = ptr[i] = how->ptr[i] + how->base;
    for (int32_t e = 0; e < how->entries; e++) col64[e] = col[e] = how->col[e] + how->base;
    if (wide) return feti_body_stiffness_split_i64(p, 0, N, diag, ptr64, col64, val, how->base, how->storage, FETI_COPY);
    return feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, val, how->base, how->storage, FETI_COPY);
}

static void every_split(void)
{
    for (int k = 0; k < SPLITS_COUNT; k++)
        for (int wide = 0; wide <= 1; wide++) {
            const split_way *how = &SPLITS[k];
            int64_t before[2] = { 0, 0 };
            double diag[N], val[4];
            feti_problem *p = begin();

            MUST(give_split(p, how, FIRST, wide));
            check_step(p, FIRST, before, 1, 1, how->name);
            split_values(how, SECOND, diag, val);
            OK(feti_body_values_split(p, 0, N, diag, how->entries, val));
            check_step(p, SECOND, before, 0, 1, how->name);
            OK(feti_body_values_split(p, 0, N, diag, how->entries, val));
            check_step(p, SECOND, before, 0, 0, how->name);
            EXPECT(FETI_STATE, feti_body_values(p, 0, how->entries, val));
            check_last_error(p, &(expectation){ FETI_STATE, 0, ANY, ANY, ANY, "feti_body_values", "by feti_body_values_split" });
            OK(feti_problem_destroy(&p));
        }
}

/* Refused matrices and values with a diagonal of its own: the argument, the place, and nothing lost. */
static void wrong_split(void)
{
    const int32_t ptr[N + 1] = { 0, 0, 1, 2 }, col[2] = { 0, 1 }, on_diagonal[2] = { 0, 2 };
    const double diag[N] = { 3.0, 6.0, 4.0 }, val[2] = { -2.0, -4.0 }, bad[N] = { 3.0, INFINITY, 4.0 };
    int64_t before[2] = { 0, 0 };
    feti_problem *p = begin();

    EXPECT(FETI_STATE, feti_body_values_split(p, 0, N, diag, 2, val));
    MUST(give_split(p, &SPLITS[0], FIRST, 0));
    check_step(p, FIRST, before, 1, 1, "before");
    EXPECT(FETI_ARGUMENT - 2, feti_body_stiffness_split_i32(p, 1, N, diag, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 3, feti_body_stiffness_split_i32(p, 0, 2, diag, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_split_i32(p, 0, N, NULL, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_split_i32(p, 0, N, bad, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, 0, ANY, 1, 1, "feti_body_stiffness_split_i32", "finite" });
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_split_i32(p, 0, N, diag, NULL, col, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, NULL, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, on_diagonal, val, 0, FETI_LOWER, FETI_COPY));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 6, 0, 2, 2, 1, "feti_body_stiffness_split_i32", "diagonal" });
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, val, 0, FETI_UPPER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, NULL, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 8, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, val, 2, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 9, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, val, 0, 3, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 10, feti_body_stiffness_split_i32(p, 0, N, diag, ptr, col, val, 0, FETI_LOWER, 2));
    EXPECT(FETI_ARGUMENT - 2, feti_body_values_split(p, 1, N, diag, 2, val));
    EXPECT(FETI_ARGUMENT - 3, feti_body_values_split(p, 0, 2, diag, 2, val));
    EXPECT(FETI_ARGUMENT - 4, feti_body_values_split(p, 0, N, bad, 2, val));
    EXPECT(FETI_ARGUMENT - 5, feti_body_values_split(p, 0, N, diag, 3, val));
    EXPECT(FETI_ARGUMENT - 6, feti_body_values_split(p, 0, N, diag, 2, bad + 1));
    EXPECT(FETI_HANDLE, feti_body_values_split(NULL, 0, N, diag, 2, val));
    EXPECT(FETI_HANDLE, feti_body_stiffness_split_i32(NULL, 0, N, diag, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_HANDLE, feti_body_stiffness_split_i64(NULL, 0, N, diag, NULL, NULL, val, 0, FETI_LOWER, FETI_COPY));
    check_step(p, FIRST, before, 0, 0, "after refused matrices and values");
    OK(feti_problem_destroy(&p));
}

static void dense(void)
{
    int64_t before[2] = { 0, 0 };
    double k[N * N];
    feti_problem *p = begin();

    bar(FIRST, k);
    MUST(feti_body_stiffness_dense(p, 0, N, k, N, FETI_LOWER, FETI_COPY));
    check_step(p, FIRST, before, 1, 1, "dense");
    bar(SECOND, k);
    OK(feti_body_values_dense(p, 0, N, k, N));
    check_step(p, SECOND, before, 0, 1, "dense");
    OK(feti_body_values_dense(p, 0, N, k, N));
    check_step(p, SECOND, before, 0, 0, "dense");
    OK(feti_problem_destroy(&p));
}

static expectation no_matrix(const char *function)
{
    return (expectation){ FETI_STATE, 0, ANY, ANY, ANY, function, "feti_body_stiffness" };
}

static void wrong_form(void)
{
    double k[N * N];
    feti_problem *p = begin();

    bar(FIRST, k);
    EXPECT(FETI_STATE, feti_body_values(p, 0, 5, k));
    check_last_error(p, &(expectation[]){ no_matrix("feti_body_values") }[0]);
    EXPECT(FETI_STATE, feti_body_values_dense(p, 0, N, k, N));
    check_last_error(p, &(expectation[]){ no_matrix("feti_body_values_dense") }[0]);
    MUST(give(p, &WAYS[0], FIRST, 0));
    EXPECT(FETI_STATE, feti_body_values_dense(p, 0, N, k, N));
    check_last_error(p, &(expectation){ FETI_STATE, 0, ANY, ANY, ANY, "feti_body_values_dense", "by feti_body_values" });
    MUST(feti_body_stiffness_dense(p, 0, N, k, N, FETI_FULL, FETI_COPY));
    EXPECT(FETI_STATE, feti_body_values(p, 0, 5, k));
    check_last_error(p, &(expectation){ FETI_STATE, 0, ANY, ANY, ANY, "feti_body_values", "by feti_body_values_dense" });
    OK(feti_problem_destroy(&p));
}

/* Nothing that is refused changes a bit, or costs a factorisation. */
static void wrong_arguments(void)
{
    int64_t before[2] = { 0, 0 };
    double val[MOST], k[N * N];
    feti_problem *p = begin(), *dead;

    MUST(give(p, &WAYS[4], FIRST, 0));
    check_step(p, FIRST, before, 1, 1, "before");
    values_of(&WAYS[4], SECOND, val);
    EXPECT(FETI_ARGUMENT - 2, feti_body_values(p, 1, 7, val));
    EXPECT(FETI_ARGUMENT - 2, feti_body_values(p, -1, 7, val));
    EXPECT(FETI_ARGUMENT - 3, feti_body_values(p, 0, 6, val));
    EXPECT(FETI_ARGUMENT - 3, feti_body_values(p, 0, -7, val));
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, 7, NULL));
    val[3] = NAN;
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, 7, val));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, 0, ANY, 1, 3, "feti_body_values", "finite" });
    values_of(&WAYS[4], SECOND, val);
    val[1] = 0.25;
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, 7, val));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, 0, 0, 1, ANY, "feti_body_values", "not symmetric" });
    check_step(p, FIRST, before, 0, 0, "after refused values");
    values_of(&WAYS[4], SECOND, val);
    val[6] = -1.0;
    OK(feti_body_values(p, 0, 7, val));
    EXPECT(FETI_INDEFINITE, feti_solve(p, NULL));
    check_last_error(p, &(expectation){ FETI_INDEFINITE, 0, ANY, ANY, ANY, "feti_solve", "diagonal entry" });

    bar(SECOND, k);
    MUST(feti_body_stiffness_dense(p, 0, N, k, N, FETI_FULL, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 2, feti_body_values_dense(p, 1, N, k, N));
    EXPECT(FETI_ARGUMENT - 3, feti_body_values_dense(p, 0, N + 1, k, N + 1));
    EXPECT(FETI_ARGUMENT - 4, feti_body_values_dense(p, 0, N, NULL, N));
    EXPECT(FETI_ARGUMENT - 5, feti_body_values_dense(p, 0, N, k, N - 1));
    dead = p;
    OK(feti_problem_destroy(&p));
    EXPECT(FETI_HANDLE, feti_body_values(dead, 0, 7, val));
    EXPECT(FETI_HANDLE, feti_body_values_dense(NULL, 0, N, k, N));
}

int main(void)
{
    every_storage();
    every_split();
    wrong_split();
    dense();
    wrong_form();
    wrong_arguments();
    return check_result();
}
