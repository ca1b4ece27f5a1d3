/* NULL, destroyed, foreign handles: every function returns FETI_HANDLE. NULL for an array: the number of the
   argument. NULL where the interface allows it: accepted. */
#include "small.h"

static int32_t multiply_spring(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    (void)user, (void)body, (void)n, (void)nrhs, (void)x, (void)ldx, (void)y, (void)ldy;
    return 1;
}

/* Every function with a handle and otherwise good arguments. */
static void every_function(int32_t expected, feti_problem *h)
{
    int32_t state[1];
    int64_t i = 1, dof[1];
    double x[8] = { 0 };
    feti_certificate certificate = { .struct_size = sizeof certificate };
    feti_findings findings = { .struct_size = sizeof findings };
    const int64_t ptr64[3] = { 0, 1, 3 }, col64[3] = { 0, 0, 1 };

    EXPECT(expected, feti_set_f64(h, "gamma", 1.0));
    EXPECT(expected, feti_set_i64(h, "threads", 1));
    EXPECT(expected, feti_set_str(h, "start", "cold"));
    EXPECT(expected, feti_get_f64(h, "gamma", x));
    EXPECT(expected, feti_get_i64(h, "threads", &i));
    EXPECT(expected, feti_get_str(h, "start", (char[8]){ 0 }, 8, &i));
    EXPECT(expected, feti_body_add(h, 1, &i));
    EXPECT(expected, give_block_stiffness(h));
    EXPECT(expected, feti_body_stiffness_i64(h, BLOCK, 2, ptr64, col64, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    EXPECT(expected, feti_body_stiffness_dense(h, SPRING, 1, SPRING_VAL, 1, FETI_FULL, FETI_COPY));
    EXPECT(expected, give_block_mode(h));
    EXPECT(expected, feti_body_no_null_space(h, SPRING));
    EXPECT(expected, feti_body_null_space_get(h, BLOCK, 2, &i, x, 2));
    EXPECT(expected, feti_body_coordinates(h, SPRING, 1, 1, (int32_t[1]){ 1 }, (int32_t[1]){ 1 }, x, 1));
    EXPECT(expected, feti_body_coordinates_flags(h, SPRING, FETI_SOFT));
    EXPECT(expected, give_block_load(h));
    EXPECT(expected, feti_body_operator(h, SPRING, 1, SPRING_VAL, multiply_spring, multiply_spring, 0, NULL));
    EXPECT(expected, give_row(h));
    EXPECT(expected, feti_rows_add_i64(h, FETI_EQUALITY, 0, ptr64, NULL, col64, x, 0, NULL, NULL));
    EXPECT(expected, feti_rows_rhs(h, FETI_INEQUALITY, 0, 1, GAP));
    EXPECT(expected, feti_rows_compliance(h, FETI_INEQUALITY, 0, 1, GAP));
    EXPECT(expected, feti_rows_clear(h, FETI_EQUALITY));
    EXPECT(expected, feti_setup(h));
    EXPECT(expected, feti_solve(h, NULL));
    EXPECT(expected, feti_check(h, 3, x, 1, x, 0, NULL, &certificate));
    EXPECT(expected, feti_displacement(h, BLOCK, 2, x));
    EXPECT(expected, feti_reaction(h, 0, BLOCK, 2, x));
    EXPECT(expected, feti_amplitudes(h, BLOCK, 1, x));
    EXPECT(expected, feti_multipliers(h, FETI_INEQUALITY, 1, x));
    EXPECT(expected, feti_gaps(h, 1, x));
    EXPECT(expected, feti_active(h, 1, state));
    EXPECT(expected, feti_counts(h, &i, NULL, NULL, NULL));
    EXPECT(expected, feti_friction_counts(h, &i, NULL));
    EXPECT(expected, feti_body_fixing(h, BLOCK, 1, dof));
    EXPECT(expected, feti_body_fixing_set(h, BLOCK, 0, dof));
    EXPECT(expected, feti_body_kplus(h, BLOCK, 2, 1, BLOCK_LOAD, 2, x, 2));
    EXPECT(expected, feti_dual_apply(h, 1, x, x + 1));
    EXPECT(expected, feti_dual_rhs(h, 1, x));
    EXPECT(expected, feti_problem_error(h, NULL, 0, &i));
    EXPECT(expected, feti_cancel(h));
    EXPECT(expected, feti_on_progress(h, NULL, NULL));
    EXPECT(expected, feti_start_from(h, FETI_INEQUALITY, 1, x));
    EXPECT(expected, feti_state_save(h, &i));
    EXPECT(expected, feti_state_restore(h, i));
    EXPECT(expected, feti_state_drop(h, i));
    EXPECT(expected, feti_diagnosis(h, &findings));
    EXPECT(expected, feti_diagnosis_rows(h, FETI_INEQUALITY, 0, &i, NULL, NULL));
    EXPECT(expected, feti_diagnosis_motion(h, BLOCK, 2, x));
    EXPECT(expected, feti_diagnosis_dependent(h, 0, &i, NULL));
    EXPECT(expected, feti_diagnosis_untouched(h, 0, &i, NULL));
    EXPECT(expected, feti_diagnosis_undetermined(h, 0, NULL, NULL));
    EXPECT(expected, feti_diagnosis_undetermined_motion(h, 0, BLOCK, 2, x));
}

static void bad_handles(void)
{
    int64_t local = 0;
    feti_problem *dead = small_problem(), *twice, *foreign = (feti_problem *)(void *)&local;

    twice = dead;
    OK(feti_problem_destroy(&dead));
    CHECK(dead == NULL, "the caller's handle is not zeroed");
    every_function(FETI_HANDLE, NULL);
    every_function(FETI_HANDLE, twice);
    every_function(FETI_HANDLE, foreign);
    EXPECT(FETI_HANDLE, feti_problem_destroy(&twice));
    EXPECT(FETI_HANDLE, feti_problem_destroy(&dead));
    EXPECT(FETI_HANDLE, feti_problem_destroy(NULL));
    EXPECT(FETI_HANDLE, feti_problem_destroy(&foreign));
    EXPECT(FETI_HANDLE, feti_problem_create(NULL));

    /* A handle is never used again. */
    feti_problem *fresh = small_problem();
    CHECK(fresh != twice, "a destroyed handle came back");
    OK(feti_problem_destroy(&fresh));
}

static void null_inputs(feti_problem *p)
{
    double x[2] = { 0 };
    int32_t one[2] = { 1, 1 };

    EXPECT(FETI_ARGUMENT - 2, feti_set_f64(p, NULL, 1.0));
    EXPECT(FETI_ARGUMENT - 3, feti_get_f64(p, "gamma", NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_body_add(p, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_i32(p, BLOCK, 2, NULL, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_i32(p, BLOCK, 2, BLOCK_PTR, NULL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_i32(p, BLOCK, 2, BLOCK_PTR, BLOCK_COL, NULL, 0, FETI_LOWER, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_dense(p, BLOCK, 2, NULL, 2, FETI_FULL, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 5, feti_body_null_space(p, BLOCK, 1, 2, NULL, 2, FETI_EXACT));
    EXPECT(FETI_ARGUMENT - 5, feti_body_coordinates(p, BLOCK, 1, 2, NULL, one, x, 1));
    EXPECT(FETI_ARGUMENT - 6, feti_body_coordinates(p, BLOCK, 1, 2, one, NULL, x, 1));
    EXPECT(FETI_ARGUMENT - 7, feti_body_coordinates(p, BLOCK, 1, 2, one, one, NULL, 1));
    EXPECT(FETI_ARGUMENT - 4, feti_body_load(p, BLOCK, 2, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_fixing_set(p, BLOCK, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_rows_add_i32(p, FETI_INEQUALITY, 1, NULL, ROW_BODY, ROW_DOF, ROW_VAL, 0, GAP, NULL));
    EXPECT(FETI_ARGUMENT - 6, feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, NULL, ROW_VAL, 0, GAP, NULL));
    EXPECT(FETI_ARGUMENT - 7, feti_rows_add_i32(p, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, NULL, 0, GAP, NULL));
    EXPECT(FETI_ARGUMENT - 5, feti_rows_rhs(p, FETI_INEQUALITY, 0, 1, NULL));
    EXPECT(FETI_ARGUMENT - 5, feti_rows_compliance(p, FETI_INEQUALITY, 0, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_start_from(p, FETI_INEQUALITY, 1, NULL));
}

static void null_outputs(feti_problem *p)
{
    double x[3] = { 0 };

    EXPECT(FETI_ARGUMENT - 3, feti_check(p, 3, NULL, 1, x, 0, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 8, feti_check(p, 3, x, 1, x, 0, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_null_space_get(p, BLOCK, 2, NULL, x, 2));
    EXPECT(FETI_ARGUMENT - 4, feti_displacement(p, BLOCK, 2, NULL));
    EXPECT(FETI_ARGUMENT - 5, feti_reaction(p, 0, BLOCK, 2, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_amplitudes(p, BLOCK, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_multipliers(p, FETI_INEQUALITY, 1, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_gaps(p, 1, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_active(p, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_fixing(p, BLOCK, 1, NULL));
    EXPECT(FETI_ARGUMENT - 5, feti_body_kplus(p, BLOCK, 2, 1, NULL, 2, x, 2));
    EXPECT(FETI_ARGUMENT - 7, feti_body_kplus(p, BLOCK, 2, 1, x, 2, NULL, 2));
    EXPECT(FETI_ARGUMENT - 3, feti_dual_apply(p, 1, NULL, x));
    EXPECT(FETI_ARGUMENT - 4, feti_dual_apply(p, 1, x, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_dual_rhs(p, 1, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_problem_error(p, NULL, 0, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_state_save(p, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_phase_count(p, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_phase_at(p, 0, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis(p, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_diagnosis_rows(p, FETI_INEQUALITY, 0, NULL, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_diagnosis_motion(p, BLOCK, 2, NULL));
    EXPECT(FETI_ARGUMENT - 1, feti_last_error_detail(NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_option_at(0, NULL));
}

static void null_that_is_allowed(feti_problem *p)
{
    int64_t r = 0;
    OK(feti_counts(p, NULL, NULL, NULL, NULL));
    OK(feti_body_null_space_get(p, BLOCK, 2, &r, NULL, 2));
    CHECK(r == 1, "null space of dimension %lld", (long long)r);
    CHECK(feti_last_error(NULL, 0) >= 0, "no length");
}

/* Every status has a name and a text; every option a name, a type and a default within its range. */
static void names_and_options(void)
{
    static const int32_t statuses[] = { 0, 1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6, -7, -8, -9, -10, -11, -12, -13, -104 };
    feti_option option = { .struct_size = sizeof option };

    for (size_t k = 0; k < sizeof statuses / sizeof statuses[0]; k++)
        CHECK(strncmp(feti_status_name(statuses[k]), "FETI_", 5) == 0 && strlen(feti_status_text(statuses[k])) > 3,
              "status %d", (int)statuses[k]);
    CHECK(strcmp(feti_status_name(77), "FETI_UNKNOWN") == 0, "77 is %s", feti_status_name(77));
    CHECK(feti_option_count() >= 10, "%lld options", (long long)feti_option_count());
    for (int64_t k = 0; k < feti_option_count(); k++) {
        OK(feti_option_at(k, &option));
        CHECK(option.name && option.doc && *option.name && *option.doc, "option %lld has no name or text", (long long)k);
        CHECK(option.type >= FETI_OPTION_F64 && option.type <= FETI_OPTION_STR, "%s has type %d", option.name, (int)option.type);
        if (option.type == FETI_OPTION_F64)
            CHECK(option.minimum <= option.default_f64 && option.default_f64 <= option.maximum, "%s", option.name);
    }
    EXPECT(FETI_ARGUMENT - 1, feti_option_at(feti_option_count(), &option));
    EXPECT(FETI_ARGUMENT - 1, feti_option_at(-1, &option));
}

int main(void)
{
    feti_problem *problem = small_problem();
    check_small_answer(problem, "handing over");
    bad_handles();
    null_inputs(problem);
    null_outputs(problem);
    null_that_is_allowed(problem);
    names_and_options();
    check_small_answer(problem, "all that");
    OK(feti_problem_destroy(&problem));
    return check_result();
}
