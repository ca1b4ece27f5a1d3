#include <feti_contact.h>
#include <stdio.h>

int main(void)
{
    const int32_t row_ptr[] = {0, 1, 3}, column[] = {0, 0, 1};
    const int32_t entries[] = {0, 1}, block[] = {0}, front[] = {1};
    const double k[] = {4000, -4000, 4000}, load[] = {100, 0}, one[] = {1}, gap[] = {0.5};
    double force = 0, u[2] = {0, 0};
    char text[400];
    int64_t body;
    feti_problem *p = NULL;
    if (feti_problem_create(&p) || feti_body_add(p, 2, &body) ||
        feti_body_stiffness_i32(p, body, 2, row_ptr, column, k, 0, FETI_LOWER, FETI_COPY) ||
        feti_body_load(p, body, 2, load) ||
        feti_rows_add_i32(p, FETI_INEQUALITY, 1, entries, block, front, one, 0, gap, NULL) ||
        feti_solve(p, NULL) || feti_displacement(p, body, 2, u) ||
        feti_multipliers(p, FETI_INEQUALITY, 1, &force)) {
        feti_last_error(text, sizeof text);
        fprintf(stderr, "%s\n", text);
    }
    printf("force %g N, rear %g mm, front %g mm\n", force, u[0], u[1]);
    return feti_problem_destroy(&p);
}
