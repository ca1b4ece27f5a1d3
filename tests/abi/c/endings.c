/* Ways in which a solve ends, rows that just touch or overflow, and sources of a null space, as the host sees them. An answer that is
   incomplete can be read; once the limit is lifted the answer has the bits of a problem that never met it. */
#include "grid.h"
#include "small.h"

static feti_problem *grid_problem(const grid *bars)
{
    feti_problem *problem = NULL;

    for (int call = 0; call < GRID_CALLS; call++) MUST(grid_call(bars, call, &problem));
    MUST(feti_set_i64(problem, "direct_limit", 0));
    return problem;
}

/* K u = f + r for the bars, whatever the forces are. */
static void check_balance(const grid *bars, feti_problem *problem, const char *after)
{
    const int32_t n = bars->nodes;
    double *u = check_array(n, sizeof *u), *rest = check_array(n, sizeof *rest), worst = 0.0;

    for (int body = 0; body < BARS; body++) {
        OK(feti_displacement(problem, body, n, u));
        OK(feti_reaction(problem, 0, body, n, rest));
        for (int32_t i = 0; i < n; i++) {
            if (body == 0) rest[i] += bars->load[i];
            for (int32_t k = bars->ptr[i]; k < bars->ptr[i + 1]; k++) {
                const int32_t j = bars->col[k];
                rest[i] -= bars->val[k] * u[j];
                if (j != i) rest[j] -= bars->val[k] * u[i];
            }
        }
        for (int32_t i = 0; i < n; i++) worst = fmax(worst, fabs(rest[i]));
    }
    CHECK(worst <= 1e-9, "%s: out of balance by %g", after, worst);
    free(u);
    free(rest);
}

static void a_limit_on_steps(void)
{
    grid bars = grid_of(6);
    feti_problem *problem = grid_problem(&bars);
    feti_info info = { .struct_size = sizeof info };
    uint64_t print;

    OK(feti_solve(problem, &info));
    CHECK(info.steps > 2, "solved in %lld steps: no limit can be met", (long long)info.steps);
    print = grid_fingerprint(&bars, problem);
    OK(feti_problem_destroy(&problem));

    problem = grid_problem(&bars);
    OK(feti_set_i64(problem, "max_steps", 1));
    EXPECT(FETI_ITERATIONS, feti_solve(problem, &info));
    CHECK(info.status == FETI_ITERATIONS && info.steps == 1, "status %d, %lld steps", (int)info.status,
          (long long)info.steps);
    CHECK(info.worst > 1.0, "stopped early, the certificate is %g of its limit", info.worst);
    check_balance(&bars, problem, "one step");
    OK(feti_set_i64(problem, "max_steps", 10000));
    OK(feti_solve(problem, &info));
    CHECK(grid_fingerprint(&bars, problem) == print, "other bits than without a limit");
    OK(feti_problem_destroy(&problem));
    grid_free(&bars);
}

/* A second block is stretched, and pulled away from its row by a force that nothing holds, a twelfth of it of the load; the
   first one does not feel it. The certificate is that of the whole load. */
static void a_small_part_of_the_load_is_not_held(double force, int32_t wanted)
{
    static const double away[1] = { -1.0 };
    static const int32_t ptr[2] = { 0, 1 }, body[1] = { 2 }, dof[1] = { 0 };
    const double pull[2] = { -6.0, 6.0 + force };
    feti_problem *problem = small_problem();
    feti_info info = { .struct_size = sizeof info };
    double lambda[2] = { 0 };
    int64_t number;

    MUST(feti_body_add(problem, 2, &number));
    MUST(feti_body_stiffness_i32(problem, 2, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, 2, 1, 2, BLOCK_MODE, 2, FETI_EXACT));
    MUST(feti_body_load(problem, 2, 2, pull));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ptr, body, dof, away, 0, GAP, NULL));
    EXPECT(wanted, feti_solve(problem, &info));
    if (wanted >= 0) {
        CHECK(info.status == wanted && (info.worst > 1.0) == (force > 1e-7),
              "status %d, the certificate is %g of its limit", (int)info.status, info.worst);
        OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
        CHECK(fabs(lambda[0] - 6.0) <= 1e-6 && fabs(lambda[1]) <= 1e-6, "forces %g %g", lambda[0], lambda[1]);
    } else {
        OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
        CHECK(fabs(lambda[0] - 6.0) <= 1e-6 && isnan(lambda[1]), "forces %g %g", lambda[0], lambda[1]);
    }
    OK(feti_problem_destroy(&problem));
}

/* Spring 2, load 2, u <= 1: it just touches, without force. */
static void a_row_that_touches_without_force_is_weak(void)
{
    static const int32_t body[1] = { 0 };
    static const double load[1] = { 2.0 }, one[1] = { 1.0 };
    feti_problem *problem = NULL;
    int64_t number;
    int32_t state = -1;
    double u = 0.0;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &number));
    MUST(feti_body_stiffness_i32(problem, 0, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_load(problem, 0, 1, load));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, SPRING_PTR, body, SPRING_COL, one, 0, GAP, NULL));
    OK(feti_solve(problem, NULL));
    OK(feti_active(problem, 1, &state));
    OK(feti_displacement(problem, 0, 1, &u));
    CHECK(state == FETI_ROW_WEAK && fabs(u - 1.0) <= 1e-12, "state %d, u = %.15g", (int)state, u);
    OK(feti_problem_destroy(&problem));
}

/* 1e308 times K_ii = 4 is no number: the row is named, and with a compliance that is one the problem is solved. */
static void a_compliance_that_overflows(void)
{
    static const double too_soft[1] = { 1e308 }, rigid[1] = { 0.0 };
    static const expectation wanted = { FETI_OVERFLOW, -1, -1, 0, ANY, "feti_solve", "overflows" };
    feti_problem *problem = small_problem();

    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, too_soft));
    EXPECT(FETI_OVERFLOW, feti_solve(problem, NULL));
    check_last_error(problem, &wanted);
    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, rigid));
    check_small_answer(problem, "a compliance that overflows");
    OK(feti_problem_destroy(&problem));
}

/* Where a null space comes from is told. */
static void check_origin(feti_problem *problem, int64_t body, int64_t origin, int64_t dimension)
{
    feti_body_facts facts = { .struct_size = sizeof facts };

    OK(feti_body_info(problem, body, &facts));
    CHECK(facts.origin == origin && facts.null_space == dimension, "origin %lld, dimension %lld, expected %lld, %lld",
          (long long)facts.origin, (long long)facts.null_space, (long long)origin, (long long)dimension);
}

static void a_null_space_from_every_source(void)
{
    static const double candidates[4] = { 1.0, 1.0, 1.0, -1.0 };
    grid bars = grid_of(2);
    feti_problem *problem = small_problem();

    check_small_answer(problem, "the mode");
    check_origin(problem, BLOCK, FETI_ORIGIN_EXACT, 1);
    OK(feti_body_null_space(problem, BLOCK, 2, 2, candidates, 2, FETI_CANDIDATES));
    check_small_answer(problem, "two candidates");
    check_origin(problem, BLOCK, FETI_ORIGIN_CANDIDATES, 1);
    OK(feti_problem_destroy(&problem));
    problem = grid_problem(&bars);
    OK(feti_setup(problem));
    check_origin(problem, 1, FETI_ORIGIN_COORDINATES, 0);
    OK(feti_problem_destroy(&problem));
    grid_free(&bars);
}

int main(void)
{
    a_limit_on_steps();
    a_small_part_of_the_load_is_not_held(6e-12, FETI_OK);
    a_small_part_of_the_load_is_not_held(6e-9, FETI_MARGINAL);
    a_small_part_of_the_load_is_not_held(3e-7, FETI_MARGINAL);
    a_small_part_of_the_load_is_not_held(6e-6, FETI_LOAD_NOT_HELD);
    a_row_that_touches_without_force_is_weak();
    a_compliance_that_overflows();
    a_null_space_from_every_source();
    return check_result();
}
