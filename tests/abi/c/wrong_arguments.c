/* An argument that cannot be right is refused with its own status, the text names the place, and what was
   handed over before still solves to the right answer. */
#include "small.h"

/* Refused with argument k; then everything is as before. */
#define REFUSED(problem, k, body_, dof_, row_, entry_, function_, says_, call)                       \
    do {                                                                                             \
        const expectation wanted = { FETI_ARGUMENT - (k), body_, dof_, row_, entry_, function_, says_ }; \
        EXPECT(FETI_ARGUMENT - (k), call);                                                           \
        check_last_error(problem, &wanted);                                                          \
        check_small_answer(problem, #call);                                                          \
    } while (0)

static int32_t stiffness(feti_problem *p, const int32_t *ptr, const int32_t *col, const double *val, int32_t base, int32_t storage)
{
    return feti_body_stiffness_i32(p, BLOCK, 2, ptr, col, val, base, storage, FETI_COPY);
}

static void sizes(feti_problem *p)
{
    static const char *const I32 = "feti_body_stiffness_i32";
    const double load[3] = { 0.0, -6.0, 0.0 };
    int64_t body;

    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_body_add", "", feti_body_add(p, -1, &body));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, I32, "", feti_body_stiffness_i32(p, 2, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, I32, "", feti_body_stiffness_i32(p, -1, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, I32, "2", feti_body_stiffness_i32(p, BLOCK, 1, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_body_load", "2", feti_body_load(p, BLOCK, 3, load));
    REFUSED(p, 4, ANY, ANY, ANY, ANY, "feti_body_null_space", "", feti_body_null_space(p, BLOCK, 1, 3, load, 3, FETI_EXACT));
    REFUSED(p, 6, ANY, ANY, ANY, ANY, "feti_body_null_space", "", feti_body_null_space(p, BLOCK, 1, 2, BLOCK_MODE, 1, FETI_EXACT));
    REFUSED(p, 5, ANY, ANY, ANY, ANY, "feti_body_stiffness_dense", "", feti_body_stiffness_dense(p, BLOCK, 2, BLOCK_VAL, 1, FETI_FULL, FETI_COPY));
}

static void flags_of_coordinates(feti_problem *p)
{
    static const char *const NAME = "feti_body_coordinates_flags";

    REFUSED(p, 2, ANY, ANY, ANY, ANY, NAME, "", feti_body_coordinates_flags(p, 2, FETI_SOFT));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, NAME, "", feti_body_coordinates_flags(p, -1, FETI_SOFT));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, NAME, "FETI_EXACT", feti_body_coordinates_flags(p, BLOCK, -1));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, NAME, "FETI_SOFT", feti_body_coordinates_flags(p, BLOCK, 3));
}

static void fixing(feti_problem *p)
{
    const int64_t far[1] = { 2 }, below[1] = { -1 };

    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_body_fixing_set", "", feti_body_fixing_set(p, 2, 1, far));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_body_fixing_set", "", feti_body_fixing_set(p, BLOCK, -1, far));
    REFUSED(p, 4, BLOCK, ANY, ANY, 0, "feti_body_fixing_set", "2", feti_body_fixing_set(p, BLOCK, 1, far));
    REFUSED(p, 4, BLOCK, ANY, ANY, 0, "feti_body_fixing_set", "below the first", feti_body_fixing_set(p, BLOCK, 1, below));
}

/* Either unknown of the block may be held in K+; the answer is the same. Too many are a null space of another size. */
static void fixing_dofs_are_taken(feti_problem *p)
{
    int64_t dof[2] = { 0, 1 }, held[1];

    for (int64_t k = 0; k < 2; k++) {
        OK(feti_body_fixing_set(p, BLOCK, 1, dof + k));
        OK(feti_body_fixing(p, BLOCK, 1, held));
        CHECK(held[0] == k, "unknown %lld is held", (long long)held[0]);
        check_small_answer(p, "feti_body_fixing_set");
    }
    OK(feti_body_fixing_set(p, BLOCK, 2, dof));
    EXPECT(FETI_NULL_SPACE, feti_setup(p));
    OK(feti_body_fixing_set(p, BLOCK, 0, NULL));
    check_small_answer(p, "feti_body_fixing_set");
}

static void flags(feti_problem *p)
{
    static const char *const I32 = "feti_body_stiffness_i32";
    REFUSED(p, 7, ANY, ANY, ANY, ANY, I32, "2", stiffness(p, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 2, FETI_LOWER));
    REFUSED(p, 8, ANY, ANY, ANY, ANY, I32, "7", stiffness(p, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, 7));
    REFUSED(p, 9, ANY, ANY, ANY, ANY, I32, "", feti_body_stiffness_i32(p, BLOCK, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, 8));
    REFUSED(p, 7, ANY, ANY, ANY, ANY, "feti_body_null_space", "", feti_body_null_space(p, BLOCK, 1, 2, BLOCK_MODE, 2, 9));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_rows_add_i32", "3", feti_rows_add_i32(p, 3, 1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_rows_clear", "", feti_rows_clear(p, 0));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_set_f64", "tolerence", feti_set_f64(p, "tolerence", 1e-9));
    REFUSED(p, 2, ANY, ANY, ANY, ANY, "feti_set_i64", "", feti_set_i64(p, "tolerance", 1));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_set_f64", "", feti_set_f64(p, "tolerance", -1.0));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_set_i64", "", feti_set_i64(p, "threads", -4));
}

static void patterns(feti_problem *p)
{
    static const char *const I32 = "feti_body_stiffness_i32";
    const int32_t descending[3] = { 0, 2, 1 }, late[3] = { 1, 2, 4 }, four[3] = { 0, 2, 4 }, three[3] = { 0, 1, 4 };
    const int32_t outside[3] = { 0, 2, 1 }, above[3] = { 1, 0, 1 }, negative[3] = { 0, -1, 1 };
    const int32_t twice[4] = { 0, 0, 0, 1 }, square[4] = { 0, 1, 0, 1 };
    const double four_values[4] = { 4.0, -4.0, -4.0, 4.0 }, crooked[4] = { 4.0, -4.0, -3.0, 4.0 };

    REFUSED(p, 4, ANY, ANY, ANY, ANY, I32, "", stiffness(p, descending, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER));
    REFUSED(p, 4, ANY, ANY, ANY, ANY, I32, "", stiffness(p, late, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER));
    REFUSED(p, 5, BLOCK, ANY, 1, 1, I32, "2", stiffness(p, BLOCK_PTR, outside, BLOCK_VAL, 0, FETI_LOWER));
    REFUSED(p, 5, BLOCK, ANY, 1, 1, I32, "", stiffness(p, BLOCK_PTR, negative, BLOCK_VAL, 0, FETI_LOWER));
    REFUSED(p, 5, BLOCK, 1, 0, ANY, I32, "lower", stiffness(p, BLOCK_PTR, above, BLOCK_VAL, 0, FETI_LOWER));
    REFUSED(p, 5, BLOCK, 0, 1, ANY, I32, "upper", stiffness(p, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_UPPER));
    REFUSED(p, 5, BLOCK, ANY, 1, ANY, I32, "", stiffness(p, three, twice, four_values, 0, FETI_LOWER));
    REFUSED(p, 6, BLOCK, 0, 1, ANY, I32, "symmetr", stiffness(p, four, square, crooked, 0, FETI_FULL));
    REFUSED(p, 4, BLOCK, ANY, ANY, ANY, "feti_body_stiffness_dense", "symmetr",
            feti_body_stiffness_dense(p, BLOCK, 2, crooked, 2, FETI_FULL, FETI_COPY));
}

static void rows(feti_problem *p)
{
    static const char *const ADD = "feti_rows_add_i32";
    const int32_t no_body[2] = { 0, 2 }, no_dof[2] = { 1, 0 }, far[2] = { 0, 3 }, backwards[2] = { 2, 0 };

    REFUSED(p, 4, ANY, ANY, ANY, ANY, ADD, "", feti_rows_add_i32(p, FETI_INEQUALITY, 1, backwards, ROW_BODY, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 5, ANY, ANY, 0, 1, ADD, "2", feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, no_body, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 6, ANY, ANY, 0, 0, ADD, "1", feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, no_dof, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 6, ANY, ANY, 0, 1, ADD, "3", feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, NULL, far, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, ADD, "", feti_rows_add_i32(p, FETI_INEQUALITY, -1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_rows_rhs", "", feti_rows_rhs(p, FETI_INEQUALITY, 1, 1, GAP));
}

static void compliances(feti_problem *p)
{
    static const char *const COMPLIANCE = "feti_rows_compliance";
    const double negative[1] = { -1e-300 }, not_one[2] = { 0.5, NAN }, infinite[1] = { INFINITY };

    REFUSED(p, 2, ANY, ANY, ANY, ANY, COMPLIANCE, "5", feti_rows_compliance(p, 5, 0, 1, GAP));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, COMPLIANCE, "1", feti_rows_compliance(p, FETI_INEQUALITY, 1, 1, GAP));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, COMPLIANCE, "", feti_rows_compliance(p, FETI_INEQUALITY, -1, 1, GAP));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, COMPLIANCE, "0", feti_rows_compliance(p, FETI_EQUALITY, 0, 1, GAP));
    REFUSED(p, 4, ANY, ANY, ANY, ANY, COMPLIANCE, "", feti_rows_compliance(p, FETI_INEQUALITY, 0, -1, GAP));
    REFUSED(p, 5, ANY, ANY, 0, 0, COMPLIANCE, ">= 0", feti_rows_compliance(p, FETI_INEQUALITY, 0, 1, negative));
    REFUSED(p, 5, ANY, ANY, 0, 0, COMPLIANCE, "finite", feti_rows_compliance(p, FETI_INEQUALITY, 0, 1, not_one + 1));
    REFUSED(p, 4, ANY, ANY, ANY, ANY, COMPLIANCE, "1", feti_rows_compliance(p, FETI_INEQUALITY, 0, 2, not_one));
    REFUSED(p, 5, ANY, ANY, 0, 0, COMPLIANCE, "finite", feti_rows_compliance(p, FETI_INEQUALITY, 0, 1, infinite));
}

static void not_numbers(feti_problem *p)
{
    const double val[3] = { 4.0, NAN, 4.0 }, pair[2] = { 1.0, INFINITY }, one[1] = { NAN };
    const int32_t node[2] = { 1, 2 }, dir[2] = { 1, 1 }, bad_dir[2] = { 1, 7 };
    const double place[2] = { 0.0, 1.0 };

    REFUSED(p, 6, BLOCK, ANY, ANY, 1, "feti_body_stiffness_i32", "", stiffness(p, BLOCK_PTR, BLOCK_COL, val, 0, FETI_LOWER));
    REFUSED(p, 5, BLOCK, ANY, ANY, ANY, "feti_body_null_space", "", feti_body_null_space(p, BLOCK, 1, 2, pair, 2, FETI_EXACT));
    REFUSED(p, 4, BLOCK, ANY, ANY, ANY, "feti_body_load", "", feti_body_load(p, BLOCK, 2, pair));
    REFUSED(p, 7, ANY, ANY, 0, 1, "feti_rows_add_i32", "", feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, pair, 0, GAP, NULL));
    REFUSED(p, 9, ANY, ANY, 0, ANY, "feti_rows_add_i32", "", feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, one, NULL));
    REFUSED(p, 5, ANY, ANY, ANY, ANY, "feti_rows_rhs", "", feti_rows_rhs(p, FETI_INEQUALITY, 0, 1, one));
    REFUSED(p, 7, BLOCK, ANY, ANY, ANY, "feti_body_coordinates", "", feti_body_coordinates(p, BLOCK, 1, 2, node, dir, pair, 1));
    REFUSED(p, 6, BLOCK, ANY, ANY, ANY, "feti_body_coordinates", "7", feti_body_coordinates(p, BLOCK, 1, 2, node, bad_dir, place, 1));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_body_coordinates", "", feti_body_coordinates(p, BLOCK, 4, 2, node, dir, place, 4));
    REFUSED(p, 3, ANY, ANY, ANY, ANY, "feti_set_f64", "", feti_set_f64(p, "gamma", NAN));
}

/* Texts count as the host does; the detail counts from 0. */
static void texts_count_from_the_base(feti_problem *p)
{
    const double val[3] = { 4.0, NAN, 4.0 };
    OK(feti_set_i64(p, "index_base", 1));
    REFUSED(p, 6, BLOCK, ANY, ANY, 1, "feti_body_stiffness_i32", "body 2", stiffness(p, BLOCK_PTR, BLOCK_COL, val, 0, FETI_LOWER));
    OK(feti_set_i64(p, "index_base", 0));
    REFUSED(p, 6, BLOCK, ANY, ANY, 1, "feti_body_stiffness_i32", "body 1", stiffness(p, BLOCK_PTR, BLOCK_COL, val, 0, FETI_LOWER));
}

/* The host asks for the length, then for the text; what does not fit is cut and ends with NUL. */
static void texts_are_cut_to_the_room(feti_problem *p)
{
    char room[8];
    memset(room, 'x', sizeof room);
    EXPECT(FETI_ARGUMENT - 3, feti_body_load(p, BLOCK, 3, BLOCK_LOAD));
    const int64_t full = feti_last_error(NULL, 0);
    CHECK(full > 8, "length %lld", (long long)full);
    CHECK(feti_last_error(room, 6) == full, "another length");
    CHECK(strlen(room) == 5 && room[6] == 'x', "text '%.7s'", room);
}

int main(void)
{
    feti_problem *problem = small_problem();
    check_small_answer(problem, "handing over");
    sizes(problem);
    flags_of_coordinates(problem);
    fixing(problem);
    fixing_dofs_are_taken(problem);
    flags(problem);
    patterns(problem);
    rows(problem);
    compliances(problem);
    not_numbers(problem);
    texts_count_from_the_base(problem);
    texts_are_cut_to_the_room(problem);
    OK(feti_problem_destroy(&problem));
    return check_result();
}
