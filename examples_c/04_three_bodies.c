/* 04 Three stacked blocks in space: meshes that do not match, two bodies that float.

   A base of 8-node bricks stands on the ground. On it lies a block of 10-node tetrahedra, and on that a block
   of 20-node bricks; 100 MPa press on the part x > .4 mm of the top. CalculiX wrote the matrices, without
   supports: each body comes with its six rigid motions. The supports are equality rows H u = 0 (the base is
   clamped at its bottom; of the other bodies only the three motions in the plane are held: only contact resists
   lift and tilt). Rows B u <= 0 join the nodes of one surface with the faces of the other; all gaps
   are 0. Half of the top would lift off: the example computes how much of each interface stays closed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "case_reader.h"
#include "demo.h"
#include "picture.h"

static const double YOUNG = 210000.0, POISSON = 0.3; /* MPa, -: of all bodies */

static void hand_over(feti_problem *problem, const case_data *data)
{
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        const case_matrix *k = &body->stiffness;
        int64_t number;

        CALL(feti_body_add(problem, body->n, &number));
        CALL(feti_body_stiffness_i32(problem, number, body->n, k->row_ptr, k->col, k->val, 0, FETI_LOWER, FETI_COPY));
        CALL(feti_body_null_space(problem, number, body->null_columns, body->n, body->null_space, body->n, FETI_EXACT));
        CALL(feti_body_load(problem, number, body->n, data->load + body->first));
    }
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, data->rows, data->contact.row_ptr, NULL, data->contact.col,
                           data->contact.val, 0, data->gap, NULL));
    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, data->equalities, data->equality.row_ptr, NULL, data->equality.col,
                           data->equality.val, 0, data->prescribed, NULL));
}

/* Does the row touch the base? Then it belongs to base and middle, otherwise to middle and top. */
static int touches_base(const case_data *data, int64_t row)
{
    for (int32_t e = data->contact.row_ptr[row]; e < data->contact.row_ptr[row + 1]; e++)
        if (data->contact.col[e] < data->body[1].first) return 1;
    return 0;
}

/* The rows point along z, so their forces add up to the load, on both interfaces. */
static void print_forces(const case_data *data, const double *lambda, const double *u)
{
    double base = 0.0, top = 0.0, largest = 0.0, lift = 0.0;

    for (int64_t r = 0; r < data->rows; r++) {
        if (touches_base(data, r)) base += lambda[r];
        else top += lambda[r];
        largest = fmax(largest, lambda[r]);
    }
    for (int64_t i = data->body[2].first; i < data->unknowns; i++)
        if (data->dir[i] == 3) lift = fmax(lift, u[i]);
    demo_value("force base on middle", base, "N");
    demo_value("force middle on top", top, "N");
    demo_value("largest nodal contact force", largest, "N");
    demo_value("lift of the top, largest", lift, "mm");
}

/* The elements of the bodies with displacements, stresses, and what the contact does to them. */
static void draw(const char *folder, feti_problem *problem, const case_data *data, const double *u, const double *lambda)
{
    double *force = demo_array(data->unknowns, sizeof *force), *slack = demo_array(data->rows, sizeof *slack);
    int32_t *state = demo_array(data->rows, sizeof *state);

    for (int64_t b = 0; b < 3; b++)
        CALL(feti_reaction(problem, FETI_INEQUALITY, b, data->body[b].n, force + data->body[b].first));
    CALL(feti_gaps(problem, data->rows, slack));
    CALL(feti_active(problem, data->rows, state));
    if (picture_case(folder, "three_bodies.vtu", data, YOUNG / (2.0 * (1.0 + POISSON)), u, force, lambda, slack, state) != 0)
        demo_stop("three_bodies.vtu cannot be written");
    free(force);
    free(slack);
    free(state);
}

int main(int argc, char **argv)
{
    const char *pictures = demo_picture_folder(argc, argv);
    char folder[512], text[640];
    case_data data;
    feti_problem *problem = NULL;

    snprintf(folder, sizeof folder, "%s/three_bodies", demo_data_folder(argc, argv));
    if (case_read(folder, &data, text, sizeof text) != 0) demo_stop(text);
    if (data.bodies != 3 || !data.xyz || !data.lambda_ref || !data.u_ref) demo_stop("three_bodies is not complete");

    CALL(feti_problem_create(&problem));
    hand_over(problem, &data);

    feti_info info = { .struct_size = sizeof info };
    CALL(feti_solve(problem, &info));

    double *u = demo_array(data.unknowns, sizeof *u), *lambda = demo_array(data.rows, sizeof *lambda);
    for (int64_t b = 0; b < data.bodies; b++)
        CALL(feti_displacement(problem, b, data.body[b].n, u + data.body[b].first));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, data.rows, lambda));

    print_forces(&data, lambda, u);
    draw(pictures, problem, &data, u, lambda);
    CALL(feti_problem_destroy(&problem));

    const double error = fmax(demo_error(data.rows, lambda, data.lambda_ref), demo_error(data.unknowns, u, data.u_ref));
    free(u);
    free(lambda);
    case_free(&data);
    return demo_line("04_three_bodies", &info, error, 1);
}
