/* A host in C: a block, held by nothing, is pushed against a spring by F = 100 N across a gap of 0.5 mm. By hand: force F,
   u1 = -F/k, u2 = u1 - c, u3 = u2 - F/s with k = 1000 N/mm, s = 4000 N/mm. Prints them; exit code 1 on any status but 0. */
#include <feti_contact.h>
#include <stdio.h>

static int refused(int32_t status)
{
    if (status != FETI_OK) {
        fprintf(stderr, "%s\n", feti_status_text(status));
    }
    return status != FETI_OK;
}

int main(void)
{
    const int32_t row_ptr[] = { 0, 1, 3 }, col[] = { 0, 0, 1 }, first[] = { 0, 2 }, dof[] = { 0, 0 };
    const double spring_k[] = { 1000.0 }, block_k[] = { 4000.0, -4000.0, 4000.0 }, load[] = { 0.0, -100.0 };
    const double row[] = { 1.0, -1.0 }, gap[] = { 0.5 };
    feti_problem *p = NULL;
    int64_t spring, block;
    double u1, u[2], force;

    if (refused(feti_problem_create(&p)) || refused(feti_body_add(p, 1, &spring)) || refused(feti_body_add(p, 2, &block))
        || refused(feti_body_stiffness_i32(p, spring, 1, row_ptr, col, spring_k, 0, FETI_LOWER, FETI_COPY))
        || refused(feti_body_stiffness_i32(p, block, 2, row_ptr, col, block_k, 0, FETI_LOWER, FETI_COPY))
        || refused(feti_body_load(p, block, 2, load))) {
        return 1;
    }
    const int32_t body[] = { (int32_t)spring, (int32_t)block };
    if (refused(feti_rows_add_i32(p, FETI_INEQUALITY, 1, first, body, dof, row, 0, gap, NULL)) || refused(feti_solve(p, NULL))
        || refused(feti_displacement(p, spring, 1, &u1)) || refused(feti_displacement(p, block, 2, u))
        || refused(feti_multipliers(p, FETI_INEQUALITY, 1, &force)) || refused(feti_problem_destroy(&p))) {
        return 1;
    }
    printf("force%12.6f\nu%12.6f%12.6f%12.6f\n", force, u1, u[0], u[1]);
    return 0;
}
