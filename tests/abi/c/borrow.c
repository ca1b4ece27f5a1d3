/* Matrices whose values stay with the host: no copy where the form allows it, rewritten in place, refused, replaced.

   A chain of N unknowns on springs s to the ground and 1 between neighbours, pulled by 1 at its end; a second body is its
   twin. Compared with the same chain copied. */
#include "small.h"

enum { N = 2000, ENTRIES = 2 * N - 1 };

static void fill(double *val, double s)
{
    int at = 0;

    for (int i = 0; i < N; i++) {
        if (i > 0) val[at++] = -1.0;
        val[at++] = s + (i > 0) + (i + 1 < N);
    }
}

static void pattern(int32_t *ptr, int32_t *col, int32_t base)
{
    int32_t at = 0;

    ptr[0] = base;
    for (int32_t i = 0; i < N; i++) {
        if (i > 0) col[at++] = i - 1 + base;
        col[at++] = i + base;
        ptr[i + 1] = at + base;
    }
}

static feti_problem *chains(void)
{
    double *f = check_array(N, sizeof *f);
    feti_problem *p = NULL;
    int64_t body = -1;

    f[N - 1] = 1.0;
    MUST(feti_problem_create(&p));
    for (int k = 0; k < 2; k++) {
        MUST(feti_body_add(p, N, &body));
        MUST(feti_body_null_space(p, body, 0, N, NULL, N, FETI_EXACT));
        MUST(feti_body_load(p, body, N, f));
    }
    free(f);
    return p;
}

static feti_body_facts facts_of(feti_problem *p, int64_t body)
{
    feti_body_facts facts = { .struct_size = sizeof facts };

    OK(feti_body_info(p, body, &facts));
    return facts;
}

/* u of both bodies, bit by bit that of a matrix that is copied. */
static void check_answer(feti_problem *p, double s, const char *what)
{
    int32_t *ptr = check_array(N + 1, sizeof *ptr), *col = check_array(ENTRIES, sizeof *col);
    double *val = check_array(ENTRIES, sizeof *val), *u = check_array(N, sizeof *u), *copied = check_array(N, sizeof *u);
    feti_problem *other = chains();

    pattern(ptr, col, 0);
    fill(val, s);
    for (int64_t body = 0; body < 2; body++)
        OK(feti_body_stiffness_i32(other, body, N, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    OK(feti_solve(other, NULL));
    OK(feti_displacement(other, 0, N, copied));
    OK(feti_solve(p, NULL));
    for (int64_t body = 0; body < 2; body++) {
        OK(feti_displacement(p, body, N, u));
        CHECK(memcmp(u, copied, N * sizeof *u) == 0, "%s: body %lld, other bits", what, (long long)body);
    }
    OK(feti_problem_destroy(&other));
    free(ptr);
    free(col);
    free(val);
    free(u);
    free(copied);
}

/* Arrays of exactly their size, freed right after the problem: valgrind sees whatever is read too early or too late. */
static void borrowed_rewritten_and_replaced(void)
{
    int32_t *ptr = check_array(N + 1, sizeof *ptr), *col = malloc(ENTRIES * sizeof *col);
    double *val = malloc(ENTRIES * sizeof *val), *other = malloc(ENTRIES * sizeof *other);
    feti_problem *p = chains();

    pattern(ptr, col, 0);
    fill(val, 0.5);
    OK(feti_body_stiffness_i32(p, 0, N, ptr, col, val, 0, FETI_LOWER, FETI_BORROW));
    OK(feti_body_stiffness_i32(p, 1, N, ptr, col, val, 0, FETI_LOWER, FETI_BORROW));
    free(ptr);
    CHECK(facts_of(p, 0).borrowed == 2, "borrowed is %lld", (long long)facts_of(p, 0).borrowed);
    CHECK(facts_of(p, 0).matrix_bytes == 8 * (N + 1), "%lld bytes are kept", (long long)facts_of(p, 0).matrix_bytes);
    check_answer(p, 0.5, "borrowed");
    CHECK(facts_of(p, 1).shared_with == 0 && facts_of(p, 0).shared_with == 1, "twins do not share");

    fill(val, 0.25);
    OK(feti_body_values(p, 0, ENTRIES, val));
    OK(feti_body_values(p, 1, ENTRIES, val));
    check_answer(p, 0.25, "rewritten in place");
    fill(val, 2.0);
    OK(feti_body_values(p, 1, ENTRIES, val));
    check_answer(p, 2.0, "rewritten for both bodies that borrow");

    fill(other, 1.0);
    OK(feti_body_values(p, 0, ENTRIES, other));
    OK(feti_body_values(p, 1, ENTRIES, other));
    free(val);
    check_answer(p, 1.0, "in another array");

    other[6] = NAN;
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, ENTRIES, other));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, 0, ANY, 3, 6, "feti_body_values", "finite" });
    EXPECT(FETI_STATE, feti_solve(p, NULL));
    check_last_error(p, &(expectation){ FETI_STATE, 0, ANY, ANY, ANY, "feti_solve", "rewritten in place" });
    fill(other, 3.0);
    OK(feti_body_values(p, 0, ENTRIES, other));
    check_answer(p, 3.0, "after refused values");
    EXPECT(FETI_ARGUMENT - 3, feti_body_values(p, 0, ENTRIES - 1, other));
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, ENTRIES, NULL));
    OK(feti_problem_destroy(&p));
    free(other);
    free(col);
}

/* A state holds no matrix: what was borrowed and replaced since is not read. */
static void states_and_copies(void)
{
    int32_t *ptr = check_array(N + 1, sizeof *ptr), *col = check_array(ENTRIES, sizeof *col);
    double *val = malloc(ENTRIES * sizeof *val), *copy = check_array(ENTRIES, sizeof *copy);
    int64_t state = -1;
    feti_problem *p = chains();

    pattern(ptr, col, 1);
    fill(val, 0.5);
    fill(copy, 0.5);
    for (int64_t body = 0; body < 2; body++)
        OK(feti_body_stiffness_i32(p, body, N, ptr, col, val, 1, FETI_LOWER, FETI_BORROW));
    CHECK(facts_of(p, 0).borrowed == 1, "columns from 1 are copied, values are not: %lld", (long long)facts_of(p, 0).borrowed);
    check_answer(p, 0.5, "counted from 1");
    OK(feti_state_save(p, &state));
    for (int64_t body = 0; body < 2; body++)
        OK(feti_body_stiffness_i32(p, body, N, ptr, col, copy, 1, FETI_LOWER, FETI_COPY));
    free(val);
    CHECK(facts_of(p, 0).borrowed == 0, "a copied matrix counts as borrowed");
    OK(feti_state_restore(p, state));
    check_answer(p, 0.5, "copied after a state");
    OK(feti_problem_destroy(&p));
    free(ptr);
    free(col);
    free(copy);
}

/* Every other form is copied: the host's arrays are free at once. */
static void other_forms_are_copied(void)
{
    const double load[2] = { 0.0, 1.0 }, by_hand[2] = { 1.0, 2.0 };
    const struct {
        int32_t storage, split, ptr[3], col[4];
        double diag[2], val[4];
    } forms[] = {
        { FETI_LOWER, 0, { 0, 1, 3 }, { 0, 1, 0 }, { 0 }, { 2, 1, -1 } },
        { FETI_UPPER, 0, { 0, 2, 3 }, { 0, 1, 1 }, { 0 }, { 2, -1, 1 } },
        { FETI_FULL, 0, { 0, 2, 4 }, { 0, 1, 0, 1 }, { 0 }, { 2, -1, -1, 1 } },
        { FETI_LOWER, 1, { 0, 0, 1 }, { 0 }, { 2, 1 }, { -1 } },
    };

    for (size_t k = 0; k < sizeof forms / sizeof forms[0]; k++) {
        int64_t body = -1;
        double u[2] = { 0 }, diag[2], val[4];
        feti_problem *p = NULL;

        memcpy(diag, forms[k].diag, sizeof diag);
        memcpy(val, forms[k].val, sizeof val);
        MUST(feti_problem_create(&p));
        MUST(feti_body_add(p, 2, &body));
        MUST(feti_body_load(p, body, 2, load));
        if (forms[k].split)
            OK(feti_body_stiffness_split_i32(p, 0, 2, diag, forms[k].ptr, forms[k].col, val, 0, forms[k].storage, FETI_BORROW));
        else
            OK(feti_body_stiffness_i32(p, 0, 2, forms[k].ptr, forms[k].col, val, 0, forms[k].storage, FETI_BORROW));
        memset(diag, -1, sizeof diag);
        memset(val, -1, sizeof val);
        CHECK(facts_of(p, 0).borrowed == 0, "form %d is borrowed", (int)k);
        OK(feti_solve(p, NULL));
        OK(feti_displacement(p, 0, 2, u));
        CHECK(check_distance(2, u, by_hand) <= 1e-14, "form %d: u = %g %g", (int)k, u[0], u[1]);
        OK(feti_problem_destroy(&p));
    }
}

static void wrong_arguments(void)
{
    const int32_t ptr[3] = { 0, 1, 3 }, col[3] = { 0, 0, 1 }, far[3] = { 0, -1, 1 };
    const double val[3] = { 2.0, -1.0, 1.0 }, bad[3] = { 2.0, -1.0, NAN };
    feti_problem *p = small_problem();

    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_i32(p, BLOCK, 2, ptr, NULL, val, 0, FETI_LOWER, FETI_BORROW));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_i32(p, BLOCK, 2, ptr, far, val, 0, FETI_LOWER, FETI_BORROW));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_i32(p, BLOCK, 2, ptr, col, NULL, 0, FETI_LOWER, FETI_BORROW));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_i32(p, BLOCK, 2, ptr, col, bad, 0, FETI_LOWER, FETI_BORROW));
    EXPECT(FETI_ARGUMENT - 9, feti_body_stiffness_i32(p, BLOCK, 2, ptr, col, val, 0, FETI_LOWER, 2));
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_dense(p, SPRING, 1, val, 1, FETI_FULL, FETI_BORROW));
    check_small_answer(p, "refused borrows");
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    borrowed_rewritten_and_replaced();
    states_and_copies();
    other_forms_are_copied();
    wrong_arguments();
    return check_result();
}
