/* 05 Two cylinders (Problem 2 of the paper): dense bodies, as boundary elements give them.

   Two discs of radius 1 mm (E = 2.1e5 N/mm^2, nu = .3, plane stress, 1 mm thick) are stacked on
   rigid ground. Each disc has only its 72 boundary nodes and a dense symmetric matrix. The discs are held
   sideways; up and down both may move as a whole. A load presses on the top. Rows 0 to 6 join the
   discs, rows 7 to 13 the lower disc and the ground; the gaps are those of the circles.

   The problem is solved first by the method of the paper to four digits, then by the default. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "case_reader.h"
#include "demo.h"

enum { BETWEEN = 7 /* rows between the discs */ };

/* The full matrix of a body, n x n, as a boundary element code has it. */
static double *boundary_stiffness(const case_body *body)
{
    const case_matrix *k = &body->stiffness;
    const int64_t n = body->n;
    double *full = demo_array(n * n, sizeof *full);

    for (int64_t i = 0; i < n; i++)
        for (int32_t e = k->row_ptr[i]; e < k->row_ptr[i + 1]; e++)
            full[i + n * k->col[e]] = full[k->col[e] + n * i] = k->val[e];
    return full;
}

static void hand_over(feti_problem *problem, const case_data *data)
{
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        double *k = boundary_stiffness(body);
        int64_t number;

        CALL(feti_body_add(problem, body->n, &number));
        CALL(feti_body_stiffness_dense(problem, number, body->n, k, body->n, FETI_FULL, FETI_COPY));
        CALL(feti_body_null_space(problem, number, body->null_columns, body->n, body->null_space, body->n, FETI_EXACT));
        CALL(feti_body_load(problem, number, body->n, data->load + body->first));
        free(k);
    }
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, data->rows, data->contact.row_ptr, NULL, data->contact.col,
                           data->contact.val, 0, data->gap, NULL));
}

/* The method and how far it is to go. */
static void choose(feti_problem *problem, const char *method, double tolerance, double certificate_tolerance)
{
    CALL(feti_set_str(problem, "method", method));
    CALL(feti_set_f64(problem, "tolerance", tolerance));
    CALL(feti_set_f64(problem, "certificate_tolerance", certificate_tolerance));
}

/* Algorithm 3 with monotone proportioning. Its parameters are relative: no unit of the data matters. */
static void solve_as_in_the_paper(feti_problem *problem, int64_t rows, double *lambda)
{
    feti_info info = { .struct_size = sizeof info };

    choose(problem, "paper-monotone", 1e-6, 1e-4);
    CALL(feti_solve(problem, &info));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, rows, lambda));
    demo_value("paper: steps", (double)info.steps, "-");
    choose(problem, "proportioning", 1e-12, 1e-8);
}

/* The largest nodal force between the discs and that of Hertz: his peak pressure times the spacing, 5 degrees. */
static void print_forces(const double *lambda, const double *by_paper)
{
    const double pi = acos(-1.0), angle = pi / 36.0;
    double load = 0.0, largest = 0.0, paper = 0.0;

    for (int r = 0; r < BETWEEN; r++) {
        load += lambda[r] * cos((r - 3) * angle);
        largest = fmax(largest, lambda[r]);
        paper = fmax(paper, by_paper[r]);
    }
    const double half_width = sqrt(4.0 * load * 0.5 / (pi * 0.5 * 2.1e5));
    demo_value("force between the discs", load, "N");
    demo_value("largest nodal force", largest, "N");
    demo_value("nodal force after Hertz", angle * 2.0 * load / (pi * half_width), "N");
    demo_value("nodal force, paper's method", paper, "N");
}

int main(int argc, char **argv)
{
    char folder[512], text[640];
    case_data data;
    feti_problem *problem = NULL;

    snprintf(folder, sizeof folder, "%s/p2_B1", demo_data_folder(argc, argv));
    if (case_read(folder, &data, text, sizeof text) != 0) demo_stop(text);
    if (data.bodies != 2 || data.rows != 2 * BETWEEN || !data.lambda_ref || !data.u_ref) demo_stop("p2_B1 is not complete");

    CALL(feti_problem_create(&problem));
    hand_over(problem, &data);

    double *u = demo_array(data.unknowns, sizeof *u);
    double *lambda = demo_array(data.rows, sizeof *lambda), *by_paper = demo_array(data.rows, sizeof *by_paper);
    solve_as_in_the_paper(problem, data.rows, by_paper);

    feti_info info = { .struct_size = sizeof info };
    CALL(feti_solve(problem, &info));
    for (int64_t b = 0; b < data.bodies; b++)
        CALL(feti_displacement(problem, b, data.body[b].n, u + data.body[b].first));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, data.rows, lambda));
    CALL(feti_problem_destroy(&problem));

    print_forces(lambda, by_paper);
    const double error = fmax(demo_error(data.rows, lambda, data.lambda_ref), demo_error(data.unknowns, u, data.u_ref));
    const int agrees = demo_error(data.rows, by_paper, data.lambda_ref) < 1e-4;
    free(u);
    free(lambda);
    free(by_paper);
    case_free(&data);
    return demo_line("05_two_cylinders", &info, error, agrees);
}
