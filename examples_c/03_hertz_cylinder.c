/* 03 A cylinder on a block: matrices of a finite element code, the answer compared with Hertz.

   A punch crowned like a cylinder of radius R = 10 mm is pressed on a block with P = 2265.6 N per mm of
   thickness, plane strain, E = 210000 MPa and nu = .3 for both. CalculiX wrote the stiffness matrices.
   The meshes do not match: a contact row joins one node of the punch with the two nodes of the block
   next to it,

       (weights . u_y of the block) - u_y of the punch <= gap      (mm)

   Both matrices come without supports, each body with its three rigid motions as null space. The
   supports (block: bottom; punch: sideways on its axis) are equality rows H u = 0.

   Hertz:  E* = E / (2 (1 - nu^2)),  half width b = sqrt(4 P R / (pi E*)),  peak p0 = 2 P / (pi b),
           p(x) = p0 sqrt(1 - x^2/b^2). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "case_reader.h"
#include "demo.h"
#include "picture.h"

static const double PI = 3.14159265358979323846;
static const double RADIUS = 10.0, YOUNG = 210000.0, POISSON = 0.3; /* mm, MPa, - */

/* The formulas of Hertz for the line load P (N/mm). */
typedef struct {
    double force, half_width, peak; /* N, mm, MPa */
} hertz;

static hertz hertz_of(double force)
{
    const double modulus = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    const double half_width = sqrt(4.0 * force * RADIUS / (PI * modulus));
    const hertz theory = { force, half_width, 2.0 * force / (PI * half_width) };
    return theory;
}

/* Passes the case to the library. Bodies are added in the order of the case, so they have its numbers. */
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
    /* B and H count the unknowns through all bodies: NULL for the bodies of the entries. */
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, data->rows, data->contact.row_ptr, NULL, data->contact.col,
                           data->contact.val, 0, data->gap, NULL));
    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, data->equalities, data->equality.row_ptr, NULL, data->equality.col,
                           data->equality.val, 0, data->prescribed, NULL));
}

/* x of the punch's node in each contact row; the rows run from left to right. (mm) */
static void contact_places(const case_data *data, double *x)
{
    for (int64_t r = 0; r < data->rows; r++)
        for (int32_t e = data->contact.row_ptr[r]; e < data->contact.row_ptr[r + 1]; e++)
            if (data->contact.col[e] < data->body[0].n) x[r] = data->xyz[3 * (int64_t)data->contact.col[e]];
}

/* The length of surface that belongs to node r: half way to each neighbour. (mm) */
static double tributary(int64_t rows, const double *x, int64_t r)
{
    const double from = x[r > 0 ? r - 1 : r], to = x[r + 1 < rows ? r + 1 : r];
    return (to - from) / 2.0;
}

/* Contact pressure of every node within 1.5 b against the ellipse of Hertz. */
static void draw_pressure(const char *folder, const hertz *theory, int64_t rows, const double *x, const double *pressure)
{
    enum { SAMPLES = 301 };
    double curve_x[SAMPLES], curve_y[SAMPLES];
    const double reach = 1.5 * theory->half_width;
    int64_t first = 0, last = rows;

    while (x[first] < -reach) first++;
    while (x[last - 1] > reach) last--;
    for (int i = 0; i < SAMPLES; i++) {
        const double s = curve_x[i] = reach * (2.0 * i / (SAMPLES - 1) - 1.0);
        curve_y[i] = theory->peak * sqrt(fmax(0.0, 1.0 - s * s / (theory->half_width * theory->half_width)));
    }
    const picture plot = { .title = "Contact pressure of the cylinder", .x_name = "x / mm",
                           .y_name = "pressure / MPa", .points_name = "computed", .curve_name = "Hertz",
                           .points = last - first, .x = x + first, .y = pressure + first,
                           .samples = SAMPLES, .curve_x = curve_x, .curve_y = curve_y };
    if (picture_svg(folder, "hertz_pressure.svg", &plot) != 0) demo_stop("hertz_pressure.svg cannot be written");
}

enum { STEPS = 1000 };

/* The steps of the solve, and the residual after each step relative to the limit that ends the solve. */
typedef struct {
    int64_t steps;
    double step[STEPS], residual[STEPS];
} steps_taken;

/* The library calls it at every step; 0: the solve continues. */
static int32_t note(void *user, const feti_progress *now)
{
    steps_taken *taken = user;
    if (now->phase != FETI_PHASE_SOLVE || taken->steps == STEPS) return 0;
    taken->residual[taken->steps++] = now->residual;
    return 0;
}

/* Logarithm of the residual of every step, relative to the limit that ends the solve. */
static void draw_convergence(const char *folder, steps_taken *taken)
{
    /* The line of the limit ends one step behind the last point, which thus lies inside the axes. */
    const double limit_x[2] = { 0.0, (double)(taken->steps + 1) }, limit_y[2] = { 0.0, 0.0 };

    for (int64_t i = 0; i < taken->steps; i++)
        taken->step[i] = (double)(i + 1), taken->residual[i] = log10(taken->residual[i]);
    const picture plot = { .title = "Convergence: the residual of every step", .x_name = "step",
                           .y_name = "log10(residual / limit)", .points_name = "computed", .curve_name = "limit",
                           .points = taken->steps, .x = taken->step, .y = taken->residual,
                           .samples = 2, .curve_x = limit_x, .curve_y = limit_y };
    if (picture_svg(folder, "hertz_convergence.svg", &plot) != 0) demo_stop("hertz_convergence.svg cannot be written");
}

/* The elements of both bodies with displacements, stresses, and what the contact does to them. */
static void draw_mesh(const char *folder, feti_problem *problem, const case_data *data, const double *u, const double *lambda,
                      const int32_t *state)
{
    double *force = demo_array(data->unknowns, sizeof *force), *slack = demo_array(data->rows, sizeof *slack);

    /* feti_reaction: force of the rows of one kind on a body, here -B'lambda. (N) */
    for (int64_t b = 0; b < 2; b++)
        CALL(feti_reaction(problem, FETI_INEQUALITY, b, data->body[b].n, force + data->body[b].first));
    CALL(feti_gaps(problem, data->rows, slack)); /* open gaps (mm) */
    if (picture_case(folder, "hertz_cylinder.vtu", data, YOUNG / (2.0 * (1.0 + POISSON)), u, force, lambda, slack, state) != 0)
        demo_stop("hertz_cylinder.vtu cannot be written");
    free(force);
    free(slack);
}

/* Prints the comparison with Hertz and draws it. Returns 1 when width and peak agree to 2 %, force to 1e-6. */
static int compare(const char *folder, const case_data *data, const double *lambda, const int32_t *state)
{
    double *x = demo_array(data->rows, sizeof *x), *pressure = demo_array(data->rows, sizeof *pressure);
    double half_width = 0.0, peak = 0.0, total = 0.0, applied = 0.0;

    contact_places(data, x);
    for (int64_t i = 0; i < data->unknowns; i++) applied -= data->load[i];
    for (int64_t r = 0; r < data->rows; r++) {
        const double length = tributary(data->rows, x, r);
        pressure[r] = lambda[r] / length; /* thickness 1 mm */
        peak = fmax(peak, pressure[r]);
        total += lambda[r];
        if (state[r] == FETI_ROW_CLOSED) half_width += length / 2.0;
    }
    const hertz theory = hertz_of(applied);
    demo_value("half width", half_width, "mm");
    demo_value("half width after Hertz", theory.half_width, "mm");
    demo_value("peak pressure", peak, "MPa");
    demo_value("peak pressure after Hertz", theory.peak, "MPa");
    demo_value("total contact force", total, "N");
    demo_value("applied force", applied, "N");
    draw_pressure(folder, &theory, data->rows, x, pressure);
    free(x);
    free(pressure);
    return fabs(half_width / theory.half_width - 1.0) < 0.02 && fabs(peak / theory.peak - 1.0) < 0.02 &&
           fabs(total / applied - 1.0) < 1e-6;
}

int main(int argc, char **argv)
{
    const char *pictures = demo_picture_folder(argc, argv);
    char folder[512], text[640];
    case_data data;
    feti_problem *problem = NULL;

    snprintf(folder, sizeof folder, "%s/hertz_cylinder", demo_data_folder(argc, argv));
    if (case_read(folder, &data, text, sizeof text) != 0) demo_stop(text);
    if (data.bodies != 2 || !data.xyz || !data.lambda_ref || !data.u_ref) demo_stop("hertz_cylinder is not complete");

    CALL(feti_problem_create(&problem));
    hand_over(problem, &data);

    /* The library calls note at every step. */
    feti_info info = { .struct_size = sizeof info };
    steps_taken *taken = demo_array(1, sizeof *taken);
    CALL(feti_on_progress(problem, note, taken));
    CALL(feti_solve(problem, &info));
    CALL(feti_on_progress(problem, NULL, NULL));
    draw_convergence(pictures, taken);
    free(taken);

    double *u = demo_array(data.unknowns, sizeof *u), *lambda = demo_array(data.rows, sizeof *lambda);
    int32_t *state = demo_array(data.rows, sizeof *state);
    for (int64_t b = 0; b < data.bodies; b++)
        CALL(feti_displacement(problem, b, data.body[b].n, u + data.body[b].first));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, data.rows, lambda));
    CALL(feti_active(problem, data.rows, state));

    const int agrees = compare(pictures, &data, lambda, state);
    draw_mesh(pictures, problem, &data, u, lambda, state);
    CALL(feti_problem_destroy(&problem));

    const double error = fmax(demo_error(data.rows, lambda, data.lambda_ref), demo_error(data.unknowns, u, data.u_ref));
    free(u);
    free(lambda);
    free(state);
    case_free(&data);
    return demo_line("03_hertz_cylinder", &info, error, agrees);
}
