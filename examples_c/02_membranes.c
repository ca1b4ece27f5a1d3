/* 02 Two membranes (Problem 1 of the paper): a scalar contact problem, matrices built here.

   Two square membranes hang side by side, Omega_1 = (0,1) x (0,1) and Omega_2 = (1,2) x (0,1). Omega_1
   is held at x = 0; only the contact holds Omega_2. Along x = 1 the left membrane must stay below the
   right membrane:

       u1(1,y) - u2(1,y) <= 0   on the 21 nodes with x = 1

   Grid of h = 1/20, five-point differences, so K is the Laplacian of the grid's graph: every grid line
   between two neighbours is an edge of weight 1. Load per node h^2 P: P = -3 on Omega_1 for y = .75
   to .95, P = -1 on Omega_2 for y = .05 to .20, inside the squares. No units. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "case_reader.h"
#include "demo.h"

enum { SIDE = 20, LINE = SIDE + 1 /* nodes on a line x = const */ };

/* Lower triangle, by rows, counted from 1 as a Fortran host would (base = 1 in the call). */
typedef struct {
    int32_t n, row_ptr[LINE * LINE + 1], col[3 * LINE * LINE];
    double val[3 * LINE * LINE];
} membrane;

/* The membrane of `columns` lines of nodes x = const; unknown i = LINE * ix + iy, iy upwards. With
   held_left there is one more line on the left whose displacement is 0: it was struck out, and of its
   edges only the diagonal entries remain. */
static void build(membrane *m, int columns, int held_left)
{
    int entries = 0;

    m->n = columns * LINE;
    for (int ix = 0; ix < columns; ix++)
        for (int iy = 0; iy < LINE; iy++) {
            const int i = LINE * ix + iy;
            const int left = ix > 0, right = ix + 1 < columns, below = iy > 0, above = iy + 1 < LINE;
            m->row_ptr[i] = entries + 1;
            if (left) m->col[entries] = i + 1 - LINE, m->val[entries++] = -1.0;
            if (below) m->col[entries] = i, m->val[entries++] = -1.0;
            m->col[entries] = i + 1;
            m->val[entries++] = left + right + below + above + (ix == 0 && held_left);
        }
    m->row_ptr[m->n] = entries + 1;
}

/* Adds the load h^2 P on the nodes with y from iy_low h to iy_high h, without first_out lines on the
   left and last_out on the right: those lie on the edge of the open square. */
static void pull(double *load, int columns, int first_out, int last_out, int iy_low, int iy_high, double p)
{
    for (int ix = first_out; ix < columns - last_out; ix++)
        for (int iy = iy_low; iy <= iy_high; iy++) load[LINE * ix + iy] += p / (SIDE * SIDE);
}

int main(int argc, char **argv)
{
    static membrane left, right;
    double load_left[SIDE * LINE] = { 0 }, load_right[LINE * LINE] = { 0 }, constant[LINE * LINE];
    feti_problem *problem = NULL;
    int64_t omega1, omega2;

    build(&left, SIDE, 1);
    build(&right, LINE, 0);
    pull(load_left, SIDE, 0, 1, 15, 19, -3.0);
    pull(load_right, LINE, 1, 1, 1, 4, -1.0);

    CALL(feti_problem_create(&problem));
    CALL(feti_set_f64(problem, "tolerance", 1e-10));

    /* The arrays count from 1 here, and the 1 before FETI_LOWER says so. Body numbers given one by
       one, as omega1, always count from 0 in C. */
    CALL(feti_body_add(problem, left.n, &omega1));
    CALL(feti_body_stiffness_i32(problem, omega1, left.n, left.row_ptr, left.col, left.val, 1, FETI_LOWER, FETI_COPY));
    CALL(feti_body_no_null_space(problem, omega1));
    CALL(feti_body_load(problem, omega1, left.n, load_left));

    /* A membrane that nothing holds may move as a whole: its null space is the constant. */
    for (int i = 0; i < right.n; i++) constant[i] = 1.0;
    CALL(feti_body_add(problem, right.n, &omega2));
    CALL(feti_body_stiffness_i32(problem, omega2, right.n, right.row_ptr, right.col, right.val, 1, FETI_LOWER, FETI_COPY));
    CALL(feti_body_null_space(problem, omega2, 1, right.n, constant, right.n, FETI_EXACT));
    CALL(feti_body_load(problem, omega2, right.n, load_right));

    /* One row per pair of nodes on x = 1. With NULL for the bodies the unknowns count through all
       bodies one after the other: right's first unknown is number left.n + 1. No right-hand sides
       either (NULL): the gaps are 0. */
    int32_t row_ptr[LINE + 1], dof[2 * LINE];
    double val[2 * LINE];
    for (int r = 0; r < LINE; r++) {
        row_ptr[r] = 2 * r + 1;
        dof[2 * r] = left.n - LINE + r + 1, val[2 * r] = 1.0;
        dof[2 * r + 1] = left.n + r + 1, val[2 * r + 1] = -1.0;
    }
    row_ptr[LINE] = 2 * LINE + 1;
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, LINE, row_ptr, NULL, dof, val, 1, NULL, NULL));

    feti_info info = { .struct_size = sizeof info };
    CALL(feti_solve(problem, &info));

    double u[(SIDE + LINE) * LINE], lambda[LINE], sum = 0.0, largest = 0.0;
    CALL(feti_displacement(problem, omega1, left.n, u));
    CALL(feti_displacement(problem, omega2, right.n, u + left.n));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, LINE, lambda));
    CALL(feti_problem_destroy(&problem));

    /* The contact carries the whole load of the floating membrane: the sum is .19. */
    for (int r = 0; r < LINE; r++) {
        sum += lambda[r];
        largest = fmax(largest, lambda[r]);
    }
    demo_value("sum of the multipliers", sum, "-");
    demo_value("largest multiplier", largest, "-");
    demo_value("energy", info.energy, "-");

    /* The reference solution of the same problem, known to 13 digits. */
    case_data reference;
    char folder[512], text[640];
    snprintf(folder, sizeof folder, "%s/p1_P3", demo_data_folder(argc, argv));
    if (case_read(folder, &reference, text, sizeof text) != 0) demo_stop(text);
    if (!reference.lambda_ref || !reference.u_ref || reference.rows != LINE || reference.unknowns != left.n + right.n)
        demo_stop("p1_P3 is not the problem of this example");
    const double error = fmax(demo_error(LINE, lambda, reference.lambda_ref),
                              demo_error(reference.unknowns, u, reference.u_ref));
    case_free(&reference);
    return demo_line("02_membranes", &info, error, fabs(sum - 0.19) < 1e-9);
}
