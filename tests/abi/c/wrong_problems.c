/* Data that only together cannot be right: setup or solve returns its own status and names the place; the
   problem can be corrected and solved afterwards. */
#include "small.h"

static void refused(feti_problem *p, int32_t status, int64_t body, int32_t found, const char *what)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[512] = "";

    feti_last_error(text, sizeof text);
    CHECK(found == status, "%s: status %d, expected %d: %s", what, (int)found, (int)status, text);
    OK(feti_last_error_detail(&detail));
    CHECK(detail.status == status, "%s: detail has status %d", what, (int)detail.status);
    CHECK(detail.body == body || body == ANY, "%s: body %lld named: %s", what, (long long)detail.body, text);
    if (body >= 0) {
        char name[32];
        snprintf(name, sizeof name, "body %d", (int)body);
        CHECK(strstr(text, name) != NULL, "%s: the text does not name %s: %s", what, name, text);
    }
    CHECK(p != NULL, "%s: no problem", what);
}

static int32_t block_stiffness(feti_problem *p, double first, double coupling, double second)
{
    const double val[3] = { first, coupling, second };
    return feti_body_stiffness_i32(p, BLOCK, 2, BLOCK_PTR, BLOCK_COL, val, 0, FETI_LOWER, FETI_COPY);
}

static void indefinite_stiffness(feti_problem *p)
{
    feti_error_detail detail = { .struct_size = sizeof detail };

    OK(feti_body_null_space(p, BLOCK, 0, 2, NULL, 2, FETI_EXACT));
    refused(p, FETI_INDEFINITE, BLOCK, or_solve(p, block_stiffness(p, 4.0, -8.0, 4.0)), "K = [4 -8; -8 4]");
    OK(feti_last_error_detail(&detail));
    CHECK(detail.dof == 0 || detail.dof == 1, "dof %lld named", (long long)detail.dof);
    OK(give_block_stiffness(p));
    OK(give_block_mode(p));
    check_small_answer(p, "an indefinite K");
}

static void singular_without_null_space(feti_problem *p)
{
    for (int short_form = 0; short_form <= 1; short_form++) {
        const int32_t given = short_form ? feti_body_no_null_space(p, BLOCK) : feti_body_null_space(p, BLOCK, 0, 2, NULL, 2, FETI_EXACT);
        const int32_t found = or_solve(p, given);
        CHECK(found == FETI_NULL_SPACE || found == FETI_INDEFINITE, "status %d for a singular K said to be regular", (int)found);
        refused(p, found, BLOCK, found, "a singular K said to be regular");
        OK(give_block_mode(p));
        check_small_answer(p, "a missing null space");
    }
    EXPECT(FETI_ARGUMENT - 2, feti_body_no_null_space(p, 7));
    OK(feti_body_no_null_space(p, SPRING));
    check_small_answer(p, "a spring said to be held");
}

static void null_space_that_is_none(feti_problem *p)
{
    const double crooked[2] = { 1.0, 1.001 }, twice[4] = { 1.0, 1.0, 2.0, 2.0 };
    refused(p, FETI_NULL_SPACE, BLOCK, or_solve(p, feti_body_null_space(p, BLOCK, 1, 2, crooked, 2, FETI_EXACT)), "K R /= 0");
    OK(give_block_mode(p));
    check_small_answer(p, "K R /= 0");
    refused(p, FETI_NULL_SPACE, BLOCK, or_solve(p, feti_body_null_space(p, BLOCK, 2, 2, twice, 2, FETI_EXACT)), "dependent columns");
    OK(give_block_mode(p));
    check_small_answer(p, "dependent columns");
}

/* Supports held by 1e30 on the diagonal: K is regular, but against its norm every R would look like a null space. */
static void supports_as_huge_diagonal(feti_problem *p)
{
    refused(p, FETI_NULL_SPACE, BLOCK, or_solve(p, block_stiffness(p, 1e30, -4.0, 4.0)), "1e30 on the diagonal");
    OK(give_block_stiffness(p));
    check_small_answer(p, "1e30 on the diagonal");
}

/* Finite entries of which products overflow; whoever looks for the null space meets them first. */
static void products_that_overflow(feti_problem *p)
{
    OK(feti_body_null_space(p, BLOCK, 1, 2, BLOCK_MODE, 2, FETI_CANDIDATES));
    refused(p, FETI_INDEFINITE, BLOCK, or_solve(p, block_stiffness(p, 1.0, 1e300, 1.0)), "1e300 among candidates");
    OK(give_block_stiffness(p));
    check_small_answer(p, "1e300 among candidates");
    OK(give_block_mode(p));
}

/* Two pairs that nothing joins have two motions; one of them alone passes K R = 0. One vector that moves both pairs gives both. */
static void missing_mode(void)
{
    const int32_t ptr[5] = { 0, 1, 3, 4, 6 }, col[6] = { 0, 0, 1, 2, 2, 3 };
    const double val[6] = { 4.0, -4.0, 4.0, 4.0, -4.0, 4.0 };
    const double one[4] = { 1.0, 1.0, 0.0, 0.0 }, both[8] = { 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0 };
    const double all[4] = { 1.0, 1.0, 1.0, 1.0 };
    const int32_t row_ptr[3] = { 0, 1, 2 }, dof[2] = { 0, 2 };
    const double down[2] = { -1.0, -1.0 }, load[4] = { 0.0, -1.0, 0.0, -3.0 };
    double lambda[2] = { 0 };
    feti_problem *p = NULL;
    int64_t body;

    MUST(feti_problem_create(&p));
    OK(feti_body_add(p, 4, &body));
    OK(feti_body_stiffness_i32(p, 0, 4, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_load(p, 0, 4, load));
    OK(feti_rows_add_i32(p, FETI_INEQUALITY, 2, row_ptr, NULL, dof, down, 0, NULL, NULL));
    refused(p, FETI_NULL_SPACE, 0, or_solve(p, feti_body_null_space(p, 0, 1, 4, one, 4, FETI_EXACT)), "a missing mode");
    OK(feti_body_null_space(p, 0, 1, 4, all, 4, FETI_EXACT));
    OK(feti_solve(p, NULL));
    OK(feti_body_null_space(p, 0, 2, 4, both, 4, FETI_EXACT));
    OK(feti_solve(p, NULL));
    OK(feti_multipliers(p, FETI_INEQUALITY, 2, lambda));
    CHECK(fabs(lambda[0] - 1.0) <= 1e-7 && fabs(lambda[1] - 3.0) <= 1e-7, "lambda = %g %g", lambda[0], lambda[1]);
    OK(feti_problem_destroy(&p));
}

static void load_that_pulls_away(feti_problem *p)
{
    const double away[2] = { 0.0, 6.0 };
    OK(feti_body_load(p, BLOCK, 2, away));
    refused(p, FETI_LOAD_NOT_HELD, BLOCK, feti_solve(p, NULL), "a load that pulls away");
    EXPECT(FETI_STATE, feti_displacement(p, BLOCK, 2, (double[2]){ 0.0, 0.0 }));
    OK(give_block_load(p));
    check_small_answer(p, "a load that pulls away");
}

/* u <= -1 and u >= 1 for the same spring. */
static void rows_that_contradict(feti_problem *p)
{
    const int32_t ptr[3] = { 0, 1, 2 }, body[2] = { SPRING, SPRING }, dof[2] = { 0, 0 };
    const double val[2] = { 1.0, -1.0 }, below[2] = { -1.0, -1.0 };

    OK(feti_rows_add_i32(p, FETI_INEQUALITY, 2, ptr, body, dof, val, 0, below, NULL));
    refused(p, FETI_GAPS_CONTRADICT, ANY, feti_solve(p, NULL), "u <= -1 and u >= 1");
    OK(feti_rows_clear(p, FETI_INEQUALITY));
    OK(give_row(p));
    check_small_answer(p, "contradictory rows");
}

/* Every step that is still missing is named, in any order of the calls. The null space of the block is never given. */
static void solve_before_the_data(void)
{
    feti_problem *p = NULL;
    double u[2];
    int64_t body;

    MUST(feti_problem_create(&p));
    EXPECT(FETI_STATE, feti_solve(p, NULL));
    EXPECT(FETI_STATE, feti_setup(p));
    OK(feti_body_add(p, 1, &body));
    OK(feti_body_add(p, 2, &body));
    OK(feti_body_stiffness_i32(p, SPRING, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_null_space(p, SPRING, 0, 1, NULL, 1, FETI_EXACT));
    refused(p, FETI_STATE, BLOCK, feti_solve(p, NULL), "no stiffness");
    OK(give_block_stiffness(p));
    OK(give_block_load(p));
    OK(give_row(p));
    EXPECT(FETI_STATE, feti_displacement(p, BLOCK, 2, u));
    EXPECT(FETI_STATE, feti_multipliers(p, FETI_INEQUALITY, 1, u));
    check_small_answer(p, "handing over late");
    refused(p, FETI_INDEFINITE, BLOCK, or_solve(p, block_stiffness(p, 1.0, 1e300, 1.0)), "1e300 without null space");
    OK(give_block_stiffness(p));
    check_small_answer(p, "1e300 without null space");
    OK(feti_problem_destroy(&p));
}

static void memory_limit_reached(feti_problem *p)
{
    OK(feti_set_i64(p, "memory_limit", 8));
    OK(give_block_stiffness(p));
    refused(p, FETI_MEMORY, ANY, feti_solve(p, NULL), "memory_limit 8");
    OK(feti_set_i64(p, "memory_limit", 0));
    check_small_answer(p, "the memory limit");
}

/* A fault of the library itself: this problem is lost, the next one is not. */
static void injected_fault(void)
{
    feti_problem *broken = small_problem(), *other = small_problem();
    char text[256] = "";
    int64_t length = 0, count = 0;

    OK(feti_set_i64(broken, "fault_injection", 1));
    EXPECT(FETI_INTERNAL, feti_solve(broken, NULL));
    OK(feti_problem_error(broken, text, sizeof text, &length));
    CHECK(length > 0, "no text for an internal error");
    EXPECT(FETI_INTERNAL, feti_solve(broken, NULL));
    EXPECT(FETI_INTERNAL, feti_counts(broken, &count, NULL, NULL, NULL));
    EXPECT(FETI_INTERNAL, feti_set_i64(broken, "fault_injection", 0));
    EXPECT(FETI_INTERNAL, feti_displacement(broken, SPRING, 1, (double[1]){ 0.0 }));
    check_small_answer(other, "a fault in another problem");
    OK(feti_problem_destroy(&broken));
    OK(feti_problem_destroy(&other));
    other = small_problem();
    check_small_answer(other, "a fault");
    OK(feti_problem_destroy(&other));
}

int main(void)
{
    feti_problem *problem = small_problem();
    indefinite_stiffness(problem);
    singular_without_null_space(problem);
    null_space_that_is_none(problem);
    supports_as_huge_diagonal(problem);
    products_that_overflow(problem);
    load_that_pulls_away(problem);
    rows_that_contradict(problem);
    memory_limit_reached(problem);
    OK(feti_problem_destroy(&problem));
    missing_mode();
    solve_before_the_data();
    injected_fault();
    return check_result();
}
