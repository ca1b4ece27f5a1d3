/* The host's own numbers of the unknowns: loads, rows, displacements and reactions of all bodies at once; connected parts
   of a body, and what the library knows about it.

   The problem of small.h: spring (one unknown), block (two); lambda = 6, u = -3, -4, -5.5. The host numbers them 4, 0, 2 of
   0 to 5. */
#include "small.h"

enum { WHOLE = 6 };
static const int32_t SPRING_NUMBER[1] = { 4 }, BLOCK_NUMBER[2] = { 0, 2 };
static const double BY_HAND[WHOLE] = { -4.0, 7.0, -5.5, 7.0, -3.0, 7.0 };
static const double FORCES[WHOLE] = { 6.0, 7.0, 0.0, 7.0, -6.0, 7.0 };

static void give_numbers(feti_problem *p)
{
    const int64_t from_one[1] = { 5 };

    MUST(feti_body_numbering_i64(p, SPRING, 1, from_one, 1));
    MUST(feti_body_numbering_i32(p, BLOCK, 2, BLOCK_NUMBER, 0));
}

static void check_whole(feti_problem *p, int64_t n, const double *u_by_hand, const double *r_by_hand, const char *what)
{
    double u[WHOLE], r[WHOLE];

    for (int i = 0; i < WHOLE; i++) u[i] = r[i] = 7.0;
    OK(feti_solve(p, NULL));
    OK(feti_displacement(p, FETI_ALL, n, u));
    OK(feti_reaction(p, 0, FETI_ALL, n, r));
    CHECK(check_distance(n, u, u_by_hand) <= 1e-9, "%s: u = %g %g %g %g %g %g", what, u[0], u[1], u[2], u[3], u[4], u[5]);
    CHECK(check_distance(n, r, r_by_hand) <= 1e-9, "%s: r = %g %g %g %g %g %g", what, r[0], r[1], r[2], r[3], r[4], r[5]);
}

static void numbered(void)
{
    const int32_t dof[2] = { 4, 0 }, dof_from_one[2] = { 5, 1 }, ptr_from_one[2] = { 1, 3 };
    const double f[WHOLE] = { 0.0, NAN, -6.0, NAN, 0.0, NAN }, none[2] = { 0.0, 0.0 };

    for (int base = 0; base <= 1; base++) {
        feti_problem *p = small_problem();

        give_numbers(p);
        OK(feti_rows_clear(p, FETI_INEQUALITY));
        if (base == 0) OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, NULL, dof, ROW_VAL, 0, GAP, NULL));
        else OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ptr_from_one, NULL, dof_from_one, ROW_VAL, 1, GAP, NULL));
        OK(feti_body_load(p, BLOCK, 2, none));
        OK(feti_body_load(p, FETI_ALL, WHOLE, f));
        check_whole(p, WHOLE, BY_HAND, FORCES, "numbered");
        check_whole(p, 5, BY_HAND, FORCES, "numbered, an array that ends with the largest number");
        check_small_answer(p, "numbers");
        OK(feti_problem_destroy(&p));
    }
}

/* The host has the spring, both unknowns of the block, a driven one at .25, and the sum of block[0] and that, on which the row acts. */
static void tabled(void)
{
    static const int32_t number[5] = { 4, 0, 2, -1, -1 }, ptr[6] = { 0, 0, 0, 0, 0, 2 }, term[2] = { 1, 3 }, dof[2] = { 0, 4 };
    static const int64_t number_from_one[5] = { 5, 1, 3, 0, 0 }, ptr_from_one[6] = { 1, 1, 1, 1, 1, 3 }, term_from_one[2] = { 2, 4 };
    static const int64_t circle[2] = { 2, 5 };
    const double ones[2] = { 1.0, 1.0 }, constant[5] = { 0.0, 0.0, 0.0, 0.25, 0.0 }, gap = 0.75, none[2] = { 0.0, 0.0 };
    const double f[5] = { 0.0, 2.0, -6.0, 9.0, -2.0 };
    const double u[5] = { -3.0, -4.0, -5.5, 0.25, -3.75 }, r[5] = { -6.0, 0.0, 0.0, 0.0, 6.0 };

    for (int base = 0; base <= 1; base++) {
        feti_problem *p = small_problem();

        give_numbers(p);
        OK(feti_rows_clear(p, FETI_INEQUALITY));
        if (base == 0) OK(feti_dof_table_i32(p, 5, number, ptr, term, ones, constant, 0));
        else OK(feti_dof_table_i64(p, 5, number_from_one, ptr_from_one, term_from_one, ones, constant, 1));
        OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, NULL, dof, ROW_VAL, 0, &gap, NULL));
        OK(feti_body_load(p, BLOCK, 2, none));
        OK(feti_body_load(p, FETI_ALL, 5, f));
        check_whole(p, 5, u, r, "by the table");
        EXPECT(FETI_ARGUMENT - 5, feti_dof_table_i64(p, 5, number_from_one, ptr_from_one, circle, ones, constant, 1));
        check_last_error(p, &(expectation){ FETI_ARGUMENT - 5, ANY, ANY, ANY, 4, "feti_dof_table_i64", "in a circle" });
        EXPECT(FETI_ARGUMENT - 4, feti_dof_table_i32(p, 5, number, term, term, ones, constant, 0));
        EXPECT(FETI_ARGUMENT - 3, feti_body_load(p, FETI_ALL, 4, f));
        check_whole(p, 5, u, r, "after tables that were refused");
        OK(feti_problem_destroy(&p));
    }
}

static void without_numbers(void)
{
    const double f[3] = { 0.0, 0.0, -6.0 }, u[3] = { -3.0, -4.0, -5.5 }, r[3] = { -6.0, 6.0, 0.0 };
    feti_problem *p = small_problem();

    OK(feti_body_load(p, FETI_ALL, 3, f));
    check_whole(p, 3, u, r, "one body after the other");
    EXPECT(FETI_ARGUMENT - 3, feti_displacement(p, FETI_ALL, 4, (double[4]){ 0 }));
    EXPECT(FETI_ARGUMENT - 3, feti_body_load(p, FETI_ALL, 2, f));
    OK(feti_problem_destroy(&p));
}

/* Block[0] has the number of the spring, 4, and no row joins them: u = -3 of both, -4.5 of block[1], which is pulled by -6. What the
   spring takes, r = K u - f = -6, the block gives. */
static void glued(void)
{
    static const int32_t block_number[2] = { 4, 2 };
    const double f[5] = { NAN, NAN, -6.0, NAN, 0.0 }, none[2] = { 0.0, 0.0 };
    const double u_by_hand[WHOLE] = { 7.0, 7.0, -4.5, 7.0, -3.0, 7.0 }, r_by_hand[WHOLE] = { 7.0, 7.0, 0.0, 7.0, 0.0, 7.0 };
    double r[2], u[3] = { -3.0, -3.0, -4.5 };
    int64_t rows = -1, equalities = -1;
    feti_certificate found = { .struct_size = sizeof found };
    feti_problem *p = small_problem();

    OK(feti_rows_clear(p, FETI_INEQUALITY));
    OK(feti_body_numbering_i32(p, SPRING, 1, SPRING_NUMBER, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, block_number, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, BLOCK, 0, ANY, 0, "feti_body_numbering_i32", "option glue = 1" });
    OK(feti_set_i64(p, "glue", 1));
    OK(feti_body_numbering_i32(p, BLOCK, 2, block_number, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_set_i64(p, "glue", 0));
    OK(feti_body_load(p, BLOCK, 2, none));
    OK(feti_body_load(p, FETI_ALL, 5, f));
    check_whole(p, WHOLE, u_by_hand, r_by_hand, "glued");
    OK(feti_reaction(p, 0, SPRING, 1, r));
    CHECK(fabs(r[0] + 6.0) <= 1e-9, "the glue pulls the spring with %g", r[0]);
    OK(feti_reaction(p, 0, BLOCK, 2, r));
    CHECK(fabs(r[0] - 6.0) <= 1e-9 && r[1] == 0.0, "the glue holds the block with %g %g", r[0], r[1]);
    OK(feti_reaction(p, FETI_EQUALITY, BLOCK, 2, r));
    CHECK(r[0] == 0.0 && r[1] == 0.0, "rows that are not there hold the block with %g %g", r[0], r[1]);
    OK(feti_counts(p, NULL, NULL, &rows, &equalities));
    CHECK(rows == 0 && equalities == 0, "%lld and %lld rows", (long long)rows, (long long)equalities);
    OK(feti_check(p, 3, u, 0, NULL, 0, NULL, &found));
    CHECK(found.passed == 1, "the answer by hand is refused: %g", found.worst);
    u[0] = -3.1;
    OK(feti_check(p, 3, u, 0, NULL, 0, NULL, &found));
    CHECK(found.passed == 0 && found.equality > found.limit && found.equality_row == -1, "copies apart: %g, row %lld",
          found.equality, (long long)found.equality_row);
    EXPECT(FETI_STATE, feti_dual_rhs(p, 0, r));
    check_last_error(p, &(expectation){ FETI_STATE, ANY, ANY, ANY, ANY, "feti_dual_rhs", "glued" });
    OK(feti_problem_destroy(&p));
}

/* Both copies held by rows of the host at different places: rows and number are named, as numbers of the host. */
static void held_against_the_glue(void)
{
    static const int32_t block_number[2] = { 4, 2 }, ptr[3] = { 0, 1, 2 }, body[2] = { SPRING, BLOCK }, dof[2] = { 0, 0 };
    const double ones[2] = { 1.0, 1.0 }, apart[2] = { -1.0, -2.0 };
    feti_error_detail detail = { .struct_size = sizeof detail };
    int64_t count = 0, row[4] = { -1, -1, -1, -1 };
    feti_problem *p = small_problem();

    OK(feti_set_i64(p, "glue", 1));
    OK(feti_body_numbering_i32(p, SPRING, 1, SPRING_NUMBER, 0));
    OK(feti_body_numbering_i32(p, BLOCK, 2, block_number, 0));
    OK(feti_rows_add_i32(p, FETI_EQUALITY, 2, ptr, body, dof, ones, 0, apart, NULL));
    EXPECT(FETI_GAPS_CONTRADICT, feti_solve(p, NULL));
    check_last_error(p, &(expectation){ FETI_GAPS_CONTRADICT, ANY, ANY, ANY, ANY, "feti_solve", "glue of the unknowns with number 4" });
    OK(feti_last_error_detail(&detail));
    CHECK(detail.value == 4.0 && detail.row >= 0 && detail.row < 2, "number %g, row %lld", detail.value, (long long)detail.row);
    OK(feti_diagnosis_rows(p, FETI_EQUALITY, 4, &count, row, NULL));
    CHECK(count == 2 && row[0] == 0 && row[1] == 1, "%lld rows, %lld and %lld", (long long)count, (long long)row[0], (long long)row[1]);
    OK(feti_problem_destroy(&p));
}

/* Refused numbers are named; those of before stay. */
static void wrong_numbers(void)
{
    const int32_t taken[2] = { 1, 4 }, twice[2] = { 3, 3 }, below[2] = { 0, -1 }, dof[2] = { 4, 1 };
    double x[WHOLE] = { 0.0 };
    int64_t body = -1;
    feti_problem *p = small_problem();

    OK(feti_body_numbering_i32(p, SPRING, 1, SPRING_NUMBER, 0));
    EXPECT(FETI_STATE, feti_body_load(p, FETI_ALL, WHOLE, x));
    check_last_error(p, &(expectation){ FETI_STATE, BLOCK, ANY, ANY, ANY, "feti_body_load", "feti_body_numbering" });
    EXPECT(FETI_STATE, feti_rows_add_i32(p, FETI_EQUALITY, 1, ROW_PTR, NULL, dof, ROW_VAL, 0, GAP, NULL));
    give_numbers(p);
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, taken, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, BLOCK, 1, ANY, 1, "feti_body_numbering_i32", "another body" });
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, twice, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, BLOCK, 1, ANY, 1, "feti_body_numbering_i32", "another unknown" });
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, below, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, BLOCK_NUMBER, 1));
    EXPECT(FETI_ARGUMENT - 4, feti_body_numbering_i32(p, BLOCK, 2, NULL, 0));
    EXPECT(FETI_ARGUMENT - 2, feti_body_numbering_i32(p, 2, 2, BLOCK_NUMBER, 0));
    EXPECT(FETI_ARGUMENT - 2, feti_body_numbering_i32(p, FETI_ALL, 2, BLOCK_NUMBER, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_body_numbering_i32(p, BLOCK, 1, BLOCK_NUMBER, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_numbering_i32(p, BLOCK, 2, BLOCK_NUMBER, 2));
    EXPECT(FETI_HANDLE, feti_body_numbering_i32(NULL, BLOCK, 2, BLOCK_NUMBER, 0));
    EXPECT(FETI_HANDLE, feti_body_numbering_i64(NULL, BLOCK, 0, NULL, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_body_load(p, FETI_ALL, 4, x));
    EXPECT(FETI_ARGUMENT - 3, feti_body_load(p, FETI_ALL, -1, x));
    EXPECT(FETI_ARGUMENT - 4, feti_body_load(p, FETI_ALL, WHOLE, NULL));
    x[2] = INFINITY;
    EXPECT(FETI_ARGUMENT - 4, feti_body_load(p, FETI_ALL, WHOLE, x));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, BLOCK, 1, ANY, 2, "feti_body_load", "finite" });
    EXPECT(FETI_ARGUMENT - 6, feti_rows_add_i32(p, FETI_EQUALITY, 1, ROW_PTR, NULL, dof, ROW_VAL, 0, GAP, NULL));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 6, ANY, ANY, 0, 1, "feti_rows_add_i32", "no unknown" });
    EXPECT(FETI_STATE, feti_displacement(p, FETI_ALL, WHOLE, x));
    check_whole(p, WHOLE, BY_HAND, FORCES, "after refused calls");
    EXPECT(FETI_ARGUMENT - 4, feti_displacement(p, FETI_ALL, WHOLE, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_reaction(p, 0, FETI_ALL, 4, x));
    EXPECT(FETI_ARGUMENT - 5, feti_reaction(p, 0, FETI_ALL, WHOLE, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_displacement(p, -2, WHOLE, x));
    OK(feti_body_add(p, 1, &body));
    EXPECT(FETI_STATE, feti_body_load(p, FETI_ALL, WHOLE, x));
    OK(feti_problem_destroy(&p));
}

/* Unknowns 0 and 2 joined, 1 on the ground, 3 with 4; the entry of 1 and 4 is 0 and joins nothing. */
static void parts_and_facts(void)
{
    const int32_t ptr[6] = { 0, 1, 2, 4, 5, 8 }, col[8] = { 0, 1, 0, 2, 3, 1, 3, 4 };
    const double val[8] = { 1.0, 2.0, -1.0, 1.0, 3.0, 0.0, -3.0, 3.0 };
    int64_t body = -1, part[5] = { 9, 9, 9, 9, 9 };
    const int64_t by_hand[5] = { 0, 1, 0, 2, 2 };
    feti_body_facts facts = { .struct_size = sizeof facts }, old = { .struct_size = 24, .entries = -7 };
    feti_problem *p = small_problem();

    OK(feti_body_add(p, 5, &body));
    EXPECT(FETI_STATE, feti_body_components(p, body, 5, part));
    OK(feti_body_info(p, body, &facts));
    CHECK(facts.unknowns == 5 && facts.entries == -1 && facts.components == -1 && facts.matrix_bytes == 0 &&
          facts.null_space == -1 && facts.factor_entries == -1 && facts.shared_with == -1 && facts.explicit_operator == -1 &&
          facts.gap != facts.gap, "a body without a matrix has facts");
    OK(feti_body_stiffness_i32(p, body, 5, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_components(p, body, 5, part));
    CHECK(memcmp(part, by_hand, sizeof part) == 0, "parts %d %d %d %d %d", (int)part[0], (int)part[1], (int)part[2],
          (int)part[3], (int)part[4]);
    EXPECT(FETI_ARGUMENT - 2, feti_body_components(p, 7, 5, part));
    EXPECT(FETI_ARGUMENT - 3, feti_body_components(p, body, 4, part));
    EXPECT(FETI_ARGUMENT - 4, feti_body_components(p, body, 5, NULL));
    EXPECT(FETI_HANDLE, feti_body_components(NULL, body, 5, part));

    OK(feti_setup(p));
    OK(feti_body_info(p, body, &facts));
    CHECK(facts.entries == 8 && facts.components == 3 && facts.borrowed == 0 && facts.matrix_bytes >= 8 * 12 &&
          facts.origin == FETI_ORIGIN_FOUND && facts.null_space == 2 && facts.gap >= 0.0 && facts.factor_entries > 0 &&
          facts.factor_bytes > 0 && facts.shared_with == -1, "facts of the new body: %lld modes", (long long)facts.null_space);
    OK(feti_body_info(p, BLOCK, &facts));
    CHECK(facts.origin == FETI_ORIGIN_EXACT && facts.null_space == 1 && facts.components == 1 &&
          facts.explicit_operator == 1 && facts.operator_bytes > 0 && facts.gap != facts.gap, "facts of the block");
    OK(feti_body_info(p, body, &old));
    CHECK(old.unknowns == 5 && old.entries == 8 && old.components == 0, "a shorter struct is not respected");
    EXPECT(FETI_ARGUMENT - 2, feti_body_info(p, 3, &facts));
    EXPECT(FETI_ARGUMENT - 3, feti_body_info(p, body, NULL));
    facts.struct_size = 8;
    EXPECT(FETI_ARGUMENT - 3, feti_body_info(p, body, &facts));
    EXPECT(FETI_HANDLE, feti_body_info(NULL, body, &facts));
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    numbered();
    tabled();
    without_numbers();
    glued();
    held_against_the_glue();
    wrong_numbers();
    parts_and_facts();
    return check_result();
}
