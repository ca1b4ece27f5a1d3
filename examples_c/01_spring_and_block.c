/* 01 Spring and block: the smallest contact problem, and the fifteen calls of a complete program.

       wall |--/\/\/\--o u1      gap c      u2 [ block ] u3  <--- F
              spring k                        stiffness s

   The wall holds the spring. The block floats: only the contact holds it. A force F pushes the block
   to the left, across the open gap, against the spring. By hand:

       contact force  lambda = F                the block is in balance
       spring end     u1 = -F/k
       block, front   u2 = u1 - c               the gap is closed
       block, rear    u3 = u2 - F/s             the block itself is compressed

   Units: N and mm. Everything counts from 0, as in C. */
#include <math.h>
#include <stdio.h>

#include "demo.h"

int main(void)
{
    const double k = 1000.0, s = 4000.0, c = 0.5, force = 100.0; /* N/mm, N/mm, mm, N */
    feti_problem *problem = NULL;
    int64_t spring, block;

    /* 1. A problem. The handle is opaque; every call takes it first and returns a status, 0 is FETI_OK.
          CALL ends this program with the library's text should a call fail. */
    CALL(feti_problem_create(&problem));

    /* 2. Settings have names. This one says how exactly the contact forces are computed. */
    CALL(feti_set_f64(problem, "tolerance", 1e-10));

    /* 3. Two bodies with 1 and 2 unknowns; the library numbers them. */
    CALL(feti_body_add(problem, 1, &spring));
    CALL(feti_body_add(problem, 2, &block));

    /* 4. Their stiffness matrices, by rows. Row i holds the entries row_ptr[i] to row_ptr[i+1]-1.
          Of a symmetric matrix the lower triangle is enough: FETI_LOWER.

              K_spring = [ k ]        K_block = [  s  .  ]
                                                [ -s  s  ]                                     */
    {
        const int32_t row_ptr[] = { 0, 1 }, col[] = { 0 };
        const double val[] = { k };
        CALL(feti_body_stiffness_i32(problem, spring, 1, row_ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    }
    {
        const int32_t row_ptr[] = { 0, 1, 3 }, col[] = { 0, 0, 1 };
        const double val[] = { s, -s, s };
        CALL(feti_body_stiffness_i32(problem, block, 2, row_ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    }

    /* 5. The motions that cost no energy: K R = 0. None for the spring, which the wall holds;
          the block moves as a whole, R = (1, 1)'. FETI_EXACT: this is the whole null space. */
    {
        const double shift[] = { 1.0, 1.0 };
        CALL(feti_body_no_null_space(problem, spring));
        CALL(feti_body_null_space(problem, block, 1, 2, shift, 2, FETI_EXACT));
    }

    /* 6. The load: F to the left on the rear of the block. A body without a call has no load. */
    {
        const double load[] = { 0.0, -force };
        CALL(feti_body_load(problem, block, 2, load));
    }

    /* 7. The contact row: the spring end must stay to the left of the block,

              u1 - u2 <= c

          Each entry names a body, an unknown of that body, and its coefficient. */
    {
        const int32_t row_ptr[] = { 0, 2 };
        const int32_t body[] = { (int32_t)spring, (int32_t)block }, dof[] = { 0, 0 };
        const double val[] = { 1.0, -1.0 }, gap[] = { c };
        CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, row_ptr, body, dof, val, 0, gap, NULL));
    }

    /* 8. Solve. info tells what was done and how well the answer satisfies the conditions of contact. */
    feti_info info = { .struct_size = sizeof info };
    CALL(feti_solve(problem, &info));

    /* 9. The answer: displacements per body, one contact force per row. */
    double u1, block_u[2], lambda;
    CALL(feti_displacement(problem, spring, 1, &u1));
    CALL(feti_displacement(problem, block, 2, block_u));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, 1, &lambda));

    /* 10. Give everything back. The handle is set to NULL. */
    CALL(feti_problem_destroy(&problem));

    demo_value("contact force", lambda, "N");
    demo_value("spring end u1", u1, "mm");
    demo_value("block front u2", block_u[0], "mm");
    demo_value("block rear u3", block_u[1], "mm");

    const double u[] = { u1, block_u[0], block_u[1] };
    const double by_hand[] = { -force / k, -force / k - c, -force / k - c - force / s };
    const double error = fmax(demo_error(1, &lambda, &force), demo_error(3, u, by_hand));
    return demo_line("01_spring_and_block", &info, error, 1);
}
