#include "small.h"

const int32_t SPRING_PTR[2] = { 0, 1 }, SPRING_COL[1] = { 0 };
const int32_t BLOCK_PTR[3] = { 0, 1, 3 }, BLOCK_COL[3] = { 0, 0, 1 };
const int32_t ROW_PTR[2] = { 0, 2 }, ROW_BODY[2] = { SPRING, BLOCK }, ROW_DOF[2] = { 0, 0 };
const double SPRING_VAL[1] = { 2.0 }, BLOCK_VAL[3] = { 4.0, -4.0, 4.0 };
const double BLOCK_MODE[2] = { 1.0, 1.0 }, BLOCK_LOAD[2] = { 0.0, -6.0 };
const double ROW_VAL[2] = { 1.0, -1.0 }, GAP[1] = { 1.0 };

int32_t give_block_stiffness(feti_problem *problem)
{
    return feti_body_stiffness_i32(problem, BLOCK, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY);
}

int32_t give_block_mode(feti_problem *problem)
{
    return feti_body_null_space(problem, BLOCK, 1, 2, BLOCK_MODE, 2, FETI_EXACT);
}

int32_t give_block_load(feti_problem *problem)
{
    return feti_body_load(problem, BLOCK, 2, BLOCK_LOAD);
}

int32_t give_row(feti_problem *problem)
{
    return feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ROW_PTR, ROW_BODY, ROW_DOF, ROW_VAL, 0, GAP, NULL);
}

feti_problem *small_problem(void)
{
    feti_problem *problem = NULL;
    int64_t body = -1;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &body));
    MUST(feti_body_add(problem, 2, &body));
    MUST(feti_body_stiffness_i32(problem, SPRING, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, SPRING, 0, 1, NULL, 1, FETI_EXACT));
    MUST(give_block_stiffness(problem));
    MUST(give_block_mode(problem));
    MUST(give_block_load(problem));
    MUST(give_row(problem));
    return problem;
}

void check_small_answer(feti_problem *problem, const char *after)
{
    const double by_hand[4] = { -3.0, -4.0, -5.5, 6.0 };
    double found[4] = { 0 };

    OK(feti_solve(problem, NULL));
    OK(feti_displacement(problem, SPRING, 1, found));
    OK(feti_displacement(problem, BLOCK, 2, found + 1));
    OK(feti_multipliers(problem, FETI_INEQUALITY, 1, found + 3));
    CHECK(check_distance(4, found, by_hand) <= 1e-7, "after %s: u = %g %g %g, lambda = %g", after, found[0], found[1],
          found[2], found[3]);
}

int32_t or_solve(feti_problem *problem, int32_t status)
{
    return status == FETI_OK ? feti_solve(problem, NULL) : status;
}

static void check_place(const char *what, int64_t found, int64_t wanted, const char *text)
{
    CHECK(wanted == ANY || found == wanted, "%s %lld named, expected %lld: %s", what, (long long)found,
          (long long)wanted, text);
}

void check_last_error(feti_problem *problem, const expectation *wanted)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[512] = "", same[512] = "";
    int64_t length = -1;
    const int64_t full = feti_last_error(text, sizeof text);

    CHECK(full == (int64_t)strlen(text) && full > 0, "text of %lld characters: %s", (long long)full, text);
    CHECK(strstr(text, wanted->says) != NULL, "the text does not say '%s': %s", wanted->says, text);
    OK(feti_problem_error(problem, same, sizeof same, &length));
    CHECK(strcmp(text, same) == 0 && length == full, "the problem says '%s', the thread '%s'", same, text);
    OK(feti_last_error_detail(&detail));
    CHECK(detail.status == wanted->status, "detail has status %d, expected %d", (int)detail.status, (int)wanted->status);
    CHECK(detail.argument == (wanted->status <= FETI_ARGUMENT ? FETI_ARGUMENT - wanted->status : 0),
          "detail has argument %d", (int)detail.argument);
    check_place("body", detail.body, wanted->body, text);
    check_place("dof", detail.dof, wanted->dof, text);
    check_place("row", detail.row, wanted->row, text);
    check_place("entry", detail.entry, wanted->entry, text);
    CHECK(strcmp(detail.function, wanted->function) == 0, "detail names %s, expected %s", detail.function, wanted->function);
}
