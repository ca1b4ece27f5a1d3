/* A rejected load step: loads, gaps, multipliers and the answer come back; a solve starts cold unless it is told where
   to start. state <data folder> */
#include "handover.h"
#include "small.h"

static const form LOWER = { .storage = FETI_LOWER };

/* A load step: loads times `load`, gaps plus `gap`. */
static void step(feti_problem *problem, const case_data *data, double load, double gap)
{
    double *f = check_array(data->unknowns, sizeof *f), *c = check_array(data->rows, sizeof *c);

    for (int64_t i = 0; i < data->unknowns; i++) f[i] = load * data->load[i];
    for (int64_t i = 0; i < data->rows; i++) c[i] = data->gap[i] + gap;
    for (int64_t b = 0; b < data->bodies; b++) OK(feti_body_load(problem, b, data->body[b].n, f + data->body[b].first));
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 0, data->rows, c));
    free(f);
    free(c);
}

static void check_bits(const case_data *data, const answer *found, const answer *wanted, const char *what)
{
    CHECK(memcmp(found->u, wanted->u, (size_t)data->unknowns * sizeof(double)) == 0, "%s: other displacements", what);
    CHECK(memcmp(found->lambda, wanted->lambda, (size_t)data->rows * sizeof(double)) == 0, "%s: other forces", what);
    CHECK(memcmp(found->mu, wanted->mu, (size_t)data->equalities * sizeof(double)) == 0, "%s: other support forces", what);
}

/* The answer that the problem has now, without a solve. */
static void check_answer_now(feti_problem *problem, const case_data *data, const answer *wanted, const char *what)
{
    answer now = { .u = check_array(data->unknowns, sizeof(double)),
                   .lambda = check_array(data->rows, sizeof(double)),
                   .mu = check_array(data->equalities, sizeof(double)) };

    for (int64_t b = 0; b < data->bodies; b++)
        OK(feti_displacement(problem, b, data->body[b].n, now.u + data->body[b].first));
    OK(feti_multipliers(problem, FETI_INEQUALITY, data->rows, now.lambda));
    OK(feti_multipliers(problem, FETI_EQUALITY, data->equalities, now.mu));
    check_bits(data, &now, wanted, what);
    answer_free(&now);
}

/* Solves from a warm start: the same forces to rounding, for few products. */
static void check_warm(feti_problem *problem, const case_data *data, const answer *cold, const char *what)
{
    answer warm = solved(problem, data);
    const double size = check_max(data->rows, cold->lambda);

    CHECK(check_distance(data->rows, warm.lambda, cold->lambda) <= 1e-7 * size, "%s: forces differ by %g of %g", what,
          check_distance(data->rows, warm.lambda, cold->lambda), size);
    CHECK(3 * warm.info.dual_applications <= cold->info.dual_applications, "%s: %lld products, %lld from nothing", what,
          (long long)warm.info.dual_applications, (long long)cold->info.dual_applications);
    answer_free(&warm);
}

static void a_rejected_step_comes_back(const case_data *data)
{
    feti_problem *problem = handed_over(data, &LOWER);
    int64_t first = -1, second = -1;

    answer before = solved(problem, data);
    OK(feti_state_save(problem, &first));
    step(problem, data, 1.5, 1e-3);
    answer rejected = solved(problem, data);
    OK(feti_state_save(problem, &second));
    CHECK(first == 0 && second == 1, "states %lld and %lld", (long long)first, (long long)second);

    OK(feti_state_restore(problem, first));
    check_answer_now(problem, data, &before, "restored");
    answer again = solved(problem, data);
    check_bits(data, &again, &before, "solved again");
    CHECK(again.info.factorisations == before.info.factorisations, "a matrix was factorised again");

    OK(feti_state_restore(problem, second));
    check_answer_now(problem, data, &rejected, "restored forwards");
    OK(feti_set_str(problem, "start", "previous"));
    check_warm(problem, data, &rejected, "start = previous");
    OK(feti_state_restore(problem, first));
    check_warm(problem, data, &before, "start = previous after a state came back");
    OK(feti_set_str(problem, "start", "cold"));
    answer cold = solved(problem, data);
    check_bits(data, &cold, &before, "cold again");

    answer_free(&cold);
    answer_free(&again);
    answer_free(&before);
    answer_free(&rejected);
    OK(feti_problem_destroy(&problem));
}

/* Given values start the next solve and no other one. */
static void start_values_are_used_once(const case_data *data)
{
    feti_problem *problem = handed_over(data, &LOWER);
    answer cold = solved(problem, data);
    double *wrong = check_array(data->rows, sizeof(double));

    OK(feti_start_from(problem, FETI_INEQUALITY, data->rows, cold.lambda));
    OK(feti_start_from(problem, FETI_EQUALITY, data->equalities, cold.mu));
    check_warm(problem, data, &cold, "start values");
    answer again = solved(problem, data);
    check_bits(data, &again, &cold, "the solve after start values");
    answer_free(&again);

    /* From anywhere to the same answer. */
    for (int64_t i = 0; i < data->rows; i++) wrong[i] = (i % 3) * 1e3 - 500.0;
    OK(feti_start_from(problem, FETI_INEQUALITY, data->rows, wrong));
    answer far = solved(problem, data);
    CHECK(check_distance(data->rows, far.lambda, cold.lambda) <= 1e-7 * check_max(data->rows, cold.lambda), "from a bad start");
    answer_free(&far);
    free(wrong);
    answer_free(&cold);
    OK(feti_problem_destroy(&problem));
}

/* Multipliers of parallel rows add up: the same row three times, the second one twice as long. */
static void parallel_rows_start_together(void)
{
    feti_problem *problem = small_problem();
    const int32_t ptr[3] = { 0, 2, 4 }, body[4] = { SPRING, BLOCK, SPRING, BLOCK }, dof[4] = { 0, 0, 0, 0 };
    const double val[4] = { 2.0, -2.0, 1.0, -1.0 }, gap[2] = { 2.0, 1.0 };
    const double shared[3] = { 3.0, 1.0, 1.0 }; /* 3 + 2 * 1 + 1 = 6 */
    feti_info info = { .struct_size = sizeof info };
    double lambda[3], u;

    OK(feti_rows_add_i32(problem, FETI_INEQUALITY, 2, ptr, body, dof, val, 0, gap, NULL));
    OK(feti_start_from(problem, FETI_INEQUALITY, 3, shared));
    OK(feti_solve(problem, &info));
    OK(feti_multipliers(problem, FETI_INEQUALITY, 3, lambda));
    OK(feti_displacement(problem, SPRING, 1, &u));
    CHECK(info.steps == 0 && info.dual_applications <= 2, "%lld steps", (long long)info.steps);
    CHECK(fabs(lambda[0] + 2.0 * lambda[1] + lambda[2] - 6.0) < 1e-9 && fabs(u + 3.0) < 1e-9, "u = %g", u);
    OK(feti_problem_destroy(&problem));
}

static void what_does_not_fit_is_refused(void)
{
    feti_problem *problem = small_problem();
    const double start[2] = { 6.0, 1.0 }, nan_start[1] = { NAN };
    int64_t state = -1, body, rows = 0;
    double u;
    char text[256];

    EXPECT(FETI_ARGUMENT - 2, feti_start_from(problem, 9, 1, start));
    EXPECT(FETI_ARGUMENT - 3, feti_start_from(problem, FETI_INEQUALITY, 2, start));
    EXPECT(FETI_ARGUMENT - 3, feti_start_from(problem, FETI_INEQUALITY, -1, start));
    EXPECT(FETI_ARGUMENT - 4, feti_start_from(problem, FETI_INEQUALITY, 1, nan_start));
    EXPECT(FETI_ARGUMENT - 4, feti_start_from(problem, FETI_INEQUALITY, 1, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_state_save(problem, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_state_restore(problem, 0));
    EXPECT(FETI_ARGUMENT - 2, feti_state_restore(problem, -1));
    EXPECT(FETI_ARGUMENT - 2, feti_state_drop(problem, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_set_str(problem, "start", "warm"));

    /* Saved before anything is solved: the loads and gaps come back, and no answer. */
    OK(feti_state_save(problem, &state));
    OK(feti_body_load(problem, BLOCK, 2, (double[2]){ 0.0, -60.0 }));
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 0, 1, (double[1]){ 7.0 }));
    OK(feti_solve(problem, NULL));
    OK(feti_state_restore(problem, state));
    EXPECT(FETI_STATE, feti_displacement(problem, SPRING, 1, &u));
    check_small_answer(problem, "a state without an answer");

    /* Another matrix: the state still fits, its answer does not. */
    OK(feti_state_save(problem, &state));
    OK(give_block_stiffness(problem));
    OK(feti_state_restore(problem, state));
    EXPECT(FETI_STATE, feti_displacement(problem, SPRING, 1, &u));
    OK(feti_set_str(problem, "start", "previous"));
    check_small_answer(problem, "a new matrix");

    /* Other rows: those of the state come back, with their gaps and compliances, and give its answer. */
    OK(feti_rows_clear(problem, FETI_INEQUALITY));
    OK(give_row(problem));
    OK(give_row(problem));
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 0, 2, (double[2]){ 7.0, 3.0 }));
    OK(feti_state_restore(problem, state));
    OK(feti_counts(problem, NULL, NULL, &rows, NULL));
    CHECK(rows == 1, "%lld rows came back", (long long)rows);
    EXPECT(FETI_STATE, feti_displacement(problem, SPRING, 1, &u));
    check_small_answer(problem, "rows of a state");
    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, (double[1]){ 0.5 }));
    OK(feti_state_restore(problem, state));
    check_small_answer(problem, "a rigid row of a state");

    /* Another body: nothing of it fits. */
    OK(feti_body_add(problem, 1, &body));
    EXPECT(FETI_STATE, feti_state_restore(problem, state));
    CHECK(feti_last_error(text, sizeof text) > 0 && strstr(text, "bodies were added"), "%s", text);
    OK(feti_state_drop(problem, state));
    EXPECT(FETI_ARGUMENT - 2, feti_state_restore(problem, state));
    OK(feti_problem_destroy(&problem));
}

int main(int argc, char **argv)
{
    case_data data;

    if (argc < 2) return 2;
    read_or_stop(argv[1], "three_bodies", &data);
    a_rejected_step_comes_back(&data);
    start_values_are_used_once(&data);
    case_free(&data);
    parallel_rows_start_together();
    what_does_not_fit_is_refused();
    return check_result();
}
