/* Groups of bodies that no row joins are problems of their own; a row with c = +infinity never closes and joins nothing. */
#include "small.h"

enum { SPRING_2 = 2, BLOCK_2 = 3, UNKNOWNS = 6 };

/* The small problem twice: bodies 2, 3 and row 1 as bodies 0, 1 and row 0. */
static feti_problem *two_groups(void)
{
    const int32_t body[2] = { SPRING_2, BLOCK_2 };
    feti_problem *problem = small_problem();
    int64_t number = -1;

    MUST(feti_body_add(problem, 1, &number));
    MUST(feti_body_add(problem, 2, &number));
    MUST(feti_body_stiffness_i32(problem, SPRING_2, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, SPRING_2, 0, 1, NULL, 1, FETI_EXACT));
    MUST(feti_body_stiffness_i32(problem, BLOCK_2, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, BLOCK_2, 1, 2, BLOCK_MODE, 2, FETI_EXACT));
    MUST(feti_body_load(problem, BLOCK_2, 2, BLOCK_LOAD));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ROW_PTR, body, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    return problem;
}

static double force_error_on(feti_problem *problem, int64_t body)
{
    feti_body_facts facts = { .struct_size = sizeof facts };

    OK(feti_body_info(problem, body, &facts));
    return facts.force_error;
}

/* Bodies 0 and 1, row 0 as by hand. */
static void check_first_group(feti_problem *problem)
{
    double u[3] = { 0 }, r[2] = { 0 }, alpha = NAN;

    OK(feti_displacement(problem, SPRING, 1, u));
    OK(feti_displacement(problem, BLOCK, 2, u + 1));
    CHECK(check_distance(3, u, (double[3]){ -3.0, -4.0, -5.5 }) <= 1e-9, "u = %g %g %g", u[0], u[1], u[2]);
    OK(feti_reaction(problem, 0, BLOCK, 2, r));
    CHECK(check_distance(2, r, (double[2]){ 6.0, 0.0 }) <= 1e-9, "r = %g %g", r[0], r[1]);
    OK(feti_amplitudes(problem, BLOCK, 1, &alpha));
    CHECK(isfinite(alpha), "amplitude %g", alpha);
    CHECK(force_error_on(problem, SPRING) <= 1e-9 && force_error_on(problem, BLOCK) <= 1e-9, "errors of forces %g %g",
          force_error_on(problem, SPRING), force_error_on(problem, BLOCK));
}

/* The load pulls the second block away from its spring. */
static void one_group_without_an_answer(void)
{
    feti_problem *problem = two_groups();
    feti_info info = { .struct_size = sizeof info };
    feti_findings found = { .struct_size = sizeof found };
    double u[UNKNOWNS] = { 0 }, lambda[2] = { 0 }, gap[2] = { 0 }, r[UNKNOWNS] = { 0 }, v[2] = { 0 };
    int32_t state[2] = { -1, -1 };
    char text[512] = "";

    CHECK(isnan(force_error_on(problem, SPRING)), "an error of forces before a solve");
    OK(feti_body_load(problem, BLOCK_2, 2, (double[2]){ 0.0, 6.0 }));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, &info));
    feti_last_error(text, sizeof text);
    CHECK(strstr(text, "body 3") != NULL, "the text names another body: %s", text);
    CHECK(info.status == FETI_LOAD_NOT_HELD && info.bodies == 4 && info.rows == 2 && info.floating_modes == 2,
          "status %d, %lld bodies, %lld rows, %lld modes", (int)info.status, (long long)info.bodies, (long long)info.rows,
          (long long)info.floating_modes);
    CHECK(info.worst <= 1.0 && info.active == 1, "worst %g, %lld closed rows of the other group", info.worst,
          (long long)info.active);
    /* 1/2 u'K u - f'u of the first group: 1/2 (2 9 + 4 2.25) - 33 */
    CHECK(fabs(info.energy + 19.5) <= 1e-9, "energy %g", info.energy);

    check_first_group(problem);
    EXPECT(FETI_STATE, feti_displacement(problem, SPRING_2, 1, v));
    EXPECT(FETI_STATE, feti_displacement(problem, BLOCK_2, 2, v));
    EXPECT(FETI_STATE, feti_reaction(problem, 0, BLOCK_2, 2, v));
    EXPECT(FETI_STATE, feti_amplitudes(problem, BLOCK_2, 1, v));
    CHECK(v[0] == 0.0 && v[1] == 0.0, "a refused call has written");
    CHECK(isnan(force_error_on(problem, SPRING_2)) && isnan(force_error_on(problem, BLOCK_2)), "an error of unknown forces");

    OK(feti_displacement(problem, FETI_ALL, UNKNOWNS, u));
    OK(feti_reaction(problem, 0, FETI_ALL, UNKNOWNS, r));
    for (int i = 0; i < UNKNOWNS; i++)
        CHECK(isnan(u[i]) == (i >= 3), "unknown %d of all: %g", i, u[i]);
    CHECK(r[0] == -r[1] && isnan(r[3]) && isnan(r[4]), "forces on all: %g %g %g %g", r[0], r[1], r[3], r[4]);
    OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
    OK(feti_gaps(problem, 2, gap));
    OK(feti_active(problem, 2, state));
    CHECK(fabs(lambda[0] - 6.0) <= 1e-9 && isnan(lambda[1]), "forces %g %g", lambda[0], lambda[1]);
    CHECK(fabs(gap[0]) <= 1e-9 && isnan(gap[1]), "gaps %g %g", gap[0], gap[1]);
    CHECK(state[0] == FETI_ROW_CLOSED && state[1] == FETI_ROW_UNKNOWN, "states %d %d", (int)state[0], (int)state[1]);

    OK(feti_diagnosis(problem, &found));
    CHECK(found.status == FETI_LOAD_NOT_HELD && found.body == BLOCK_2, "status %d, body %lld", (int)found.status,
          (long long)found.body);
    OK(feti_diagnosis_motion(problem, BLOCK_2, 2, v));
    CHECK(fabs(v[0] - 1.0) <= 1e-9 && fabs(v[1] - 1.0) <= 1e-9, "motion %g %g", v[0], v[1]);

    OK(feti_body_load(problem, BLOCK_2, 2, BLOCK_LOAD));
    OK(feti_solve(problem, &info));
    CHECK(info.active == 2 && fabs(info.energy + 39.0) <= 1e-9, "%lld closed rows, energy %g", (long long)info.active,
          info.energy);
    OK(feti_displacement(problem, BLOCK_2, 2, v));
    CHECK(check_distance(2, v, (double[2]){ -4.0, -5.5 }) <= 1e-9, "u = %g %g", v[0], v[1]);
    OK(feti_problem_destroy(&problem));
}

/* Neither group has an answer: the first is told of. */
static void no_group_with_an_answer(void)
{
    feti_problem *problem = two_groups();
    feti_findings found = { .struct_size = sizeof found };
    feti_info info = { .struct_size = sizeof info };
    double u = 7.0;

    OK(feti_body_load(problem, BLOCK, 2, (double[2]){ 0.0, 6.0 }));
    OK(feti_body_load(problem, BLOCK_2, 2, (double[2]){ 0.0, 6.0 }));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, &info));
    CHECK(isnan(info.worst) && isnan(info.energy), "figures of no answer: %g %g", info.worst, info.energy);
    OK(feti_diagnosis(problem, &found));
    CHECK(found.body == BLOCK, "body %lld", (long long)found.body);
    EXPECT(FETI_STATE, feti_displacement(problem, FETI_ALL, UNKNOWNS, &u));
    EXPECT(FETI_STATE, feti_displacement(problem, SPRING, 1, &u));
    CHECK(u == 7.0, "a refused call has written");
    OK(feti_problem_destroy(&problem));
}

/* A second row between the bodies of the small problem, far away, off, on, and off again. */
static void a_row_that_never_closes(void)
{
    const double never = INFINITY, near = -0.5, bad[2] = { NAN, -INFINITY };
    feti_problem *problem = small_problem();
    feti_info info = { .struct_size = sizeof info };
    double lambda[2] = { -1.0, -1.0 }, gap[2] = { 0 }, d[2] = { 0 };
    int32_t state[2] = { -1, -1 };
    int64_t first = -1;

    OK(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, &never, &first));
    CHECK(first == 1, "row %lld", (long long)first);
    OK(feti_solve(problem, &info));
    check_first_group(problem);
    OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
    OK(feti_gaps(problem, 2, gap));
    OK(feti_active(problem, 2, state));
    CHECK(fabs(lambda[0] - 6.0) <= 1e-9 && lambda[1] == 0.0 && gap[1] == INFINITY && state[1] == FETI_ROW_OPEN, "forces %g %g, gap %g, state %d", lambda[0],
          lambda[1], gap[1], (int)state[1]);
    CHECK(info.rows == 2 && info.active == 1 && info.worst <= 1.0 && isfinite(info.energy), "%lld rows, %lld closed, worst %g",
          (long long)info.rows, (long long)info.active, info.worst);
    OK(feti_dual_rhs(problem, 2, d));
    CHECK(isfinite(d[0]) && d[1] == -INFINITY, "d = %g %g", d[0], d[1]);

    /* u_spring - u_block[0] <= -0.5 now: u_block[0] = -2.5 */
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 1, 1, &near));
    EXPECT(FETI_STATE, feti_gaps(problem, 2, gap));
    OK(feti_solve(problem, &info));
    OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
    OK(feti_gaps(problem, 2, gap));
    CHECK(lambda[0] == 0.0 && fabs(lambda[1] - 6.0) <= 1e-9 && fabs(gap[0] - 1.5) <= 1e-9, "forces %g %g, gap %g", lambda[0],
          lambda[1], gap[0]);
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 1, 1, &never));
    OK(feti_solve(problem, &info));
    OK(feti_multipliers(problem, FETI_INEQUALITY, 2, lambda));
    CHECK(fabs(lambda[0] - 6.0) <= 1e-9 && lambda[1] == 0.0, "forces %g %g", lambda[0], lambda[1]);

    for (int k = 0; k < 2; k++) EXPECT(FETI_ARGUMENT - 5, feti_rows_rhs(problem, FETI_INEQUALITY, 1, 1, &bad[k]));
    EXPECT(FETI_ARGUMENT - 9, feti_rows_add_i32(problem, FETI_EQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, &never, NULL));
    /* both rows off: nothing holds the block, and no row joins the bodies */
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 0, 1, &never));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, NULL));
    OK(feti_displacement(problem, SPRING, 1, gap));
    CHECK(gap[0] == 0.0, "the spring moves by %g", gap[0]);
    OK(feti_problem_destroy(&problem));
}

int main(void)
{
    one_group_without_an_answer();
    no_group_with_an_answer();
    a_row_that_never_closes();
    return check_result();
}
