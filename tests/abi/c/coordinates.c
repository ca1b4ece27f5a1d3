/* Coordinates instead of null spaces, and neither of them, give the same answer, with the supports as equality rows and with the
   supported unknowns struck out of K; only the rigid motions that the supports allow are in the null spaces.
   coordinates <data folder> */
#include "handover.h"

/* The dimension of every null space the library found. */
static void check_dimensions(const char *name, feti_problem *problem, const case_data *data, const int64_t *wanted)
{
    MUST(feti_setup(problem));
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        int64_t r = 0;
        OK(feti_body_null_space_get(problem, b, body->n, &r, NULL, body->n));
        CHECK(r == wanted[b], "%s: body %lld has a null space of dimension %lld, expected %lld", name, (long long)b,
              (long long)r, (long long)wanted[b]);
        if (r < 1) continue;
        double *modes = check_array(body->n * r, sizeof *modes), *force = check_array(body->n, sizeof *force);
        OK(feti_body_null_space_get(problem, b, body->n, &r, modes, body->n));
        const double stiff = check_max(body->stiffness.entries, body->stiffness.val) * check_max(body->n * r, modes);
        for (int64_t j = 0; j < r; j++) {
            multiply(&body->stiffness, modes + j * body->n, force);
            CHECK(check_max(body->n, force) <= 1e-9 * stiff, "%s: body %lld: |K R| = %g", name, (long long)b,
                  check_max(body->n, force));
        }
        free(modes);
        free(force);
    }
}

static void check_with(int null_space, const char *name, const case_data *data, const int64_t *dimensions)
{
    const form how = { .storage = FETI_LOWER, .null_space = null_space };
    feti_problem *problem = handed_over(data, &how);

    check_dimensions(name, problem, data, dimensions);
    answer result = solved(problem, data);
    CHECK(result.info.worst <= 1.0, "%s: certificate %g of its limit", name, result.info.worst);
    check_forces(name, data, &result);
    check_displacements(name, data, &result);
    OK(feti_problem_destroy(&problem));
    answer_free(&result);
}

static void check_both(const char *folder, const char *name, const int64_t *free_bodies, const int64_t *struck_out)
{
    case_data data, struck;
    int64_t *kept;

    read_or_stop(folder, name, &data);
    check_with(NULL_SPACE_COORDINATES, name, &data, free_bodies);
    check_with(NULL_SPACE_FOUND, name, &data, free_bodies);
    strike_supports(&data, &struck, &kept);
    check_with(NULL_SPACE_COORDINATES, name, &struck, struck_out);
    check_with(NULL_SPACE_FOUND, name, &struck, struck_out);
    free(kept);
    case_free(&struck);
    case_free(&data);
}

/* A spring 2 on the ground and, across a gap of 1, a block joined by 4, driven by .25 at its near end and pressed by 6:
   u = -25/7; -32/7, -85/14, lambda = 50/7, by hand. K of the block is indefinite, and the spring holds what it drives. */
static void a_driven_block_is_held_by_the_spring(void)
{
    const double spring[1] = { 2.0 }, block[4] = { 3.75, -4.0, -4.0, 4.0 }, load[2] = { 0.0, -6.0 }, gap[1] = { 1.0 };
    const double row[2] = { 1.0, -1.0 }, place[2] = { 5.0, 6.0 };
    const int32_t node[2] = { 1, 2 }, dir[2] = { 1, 1 }, ptr[2] = { 0, 2 }, of[2] = { 0, 1 }, dof[2] = { 0, 0 };
    feti_body_facts facts = { .struct_size = sizeof facts };
    feti_problem *p = NULL;
    int64_t body;
    double u[2], lambda[1];

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, 1, &body));
    MUST(feti_body_stiffness_dense(p, body, 1, spring, 1, FETI_FULL, FETI_COPY));
    MUST(feti_body_null_space(p, body, 0, 1, NULL, 1, FETI_EXACT));
    MUST(feti_body_add(p, 2, &body));
    MUST(feti_body_stiffness_dense(p, body, 2, block, 2, FETI_FULL, FETI_COPY));
    MUST(feti_body_load(p, body, 2, load));
    MUST(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ptr, of, dof, row, 0, gap, NULL));
    MUST(feti_body_coordinates_flags(p, body, FETI_SOFT)); /* before the coordinates: it waits for them */
    MUST(feti_body_coordinates(p, body, 1, 2, node, dir, place, 1));
    OK(feti_solve(p, NULL));
    OK(feti_displacement(p, body, 2, u));
    OK(feti_multipliers(p, FETI_INEQUALITY, 1, lambda));
    CHECK(fabs(u[0] + 32.0 / 7.0) <= 1e-12 && fabs(u[1] + 85.0 / 14.0) <= 1e-12, "u = %.15g %.15g", u[0], u[1]);
    CHECK(fabs(lambda[0] - 50.0 / 7.0) <= 1e-12, "lambda = %.15g", lambda[0]);
    OK(feti_body_info(p, body, &facts));
    CHECK(facts.origin == FETI_ORIGIN_COORDINATES && facts.null_space == 1, "origin %lld, dimension %lld",
          (long long)facts.origin, (long long)facts.null_space);
    OK(feti_body_coordinates_flags(p, body, FETI_CANDIDATES));
    EXPECT(FETI_INDEFINITE, feti_solve(p, NULL));
    OK(feti_body_coordinates_flags(p, body, FETI_EXACT)); /* the block does not float as a whole */
    EXPECT(FETI_NULL_SPACE, feti_solve(p, NULL));
    OK(feti_problem_destroy(&p));
}

int main(int argc, char **argv)
{
    static const int64_t plane_free[] = { 3, 3 }, plane_held[] = { 1, 0 };
    static const int64_t space_free[] = { 6, 6, 6 }, space_held[] = { 0, 3, 3 };

    if (argc < 2) return 2;
    check_both(argv[1], "hertz_cylinder", plane_free, plane_held);
    check_both(argv[1], "three_bodies", space_free, space_held);
    a_driven_block_is_held_by_the_spring();
    return check_result();
}
