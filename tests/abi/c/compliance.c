/* Compliant rows by hand to 1e-10: one spring between bodies, a bed of springs under a rigid punch (a linear law of
   pressure and overclosure), an elastic support; rigid again they give the answer of rigid rows. */
#include "small.h"

static void check_number(double found, double wanted, const char *what)
{
    CHECK(fabs(found - wanted) <= 1e-10 * fmax(1.0, fabs(wanted)), "%s: %.15g, by hand %.15g", what, found, wanted);
}

/* lambda = 6 whatever the spring: the block sinks in by 6/k. */
static void a_spring_between_spring_and_block(void)
{
    static const double stiffness[3] = { 1e-3, 4.0, 1e9 };
    feti_problem *problem = small_problem();
    feti_info info = { .struct_size = sizeof info };
    int64_t state = -1, factorisations;
    double lambda, spring, block[2], gap, image, rigid = 0.0, force = 1.0;
    int32_t closed = -1;

    check_small_answer(problem, "rigid");
    OK(feti_state_save(problem, &state));
    OK(feti_dual_apply(problem, 1, &force, &rigid));
    for (int i = 0; i < 3; i++) {
        const double inv_k = 1.0 / stiffness[i];
        OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, &inv_k));
        EXPECT(FETI_STATE, feti_displacement(problem, SPRING, 1, &spring));
        OK(feti_solve(problem, &info));
        OK(feti_displacement(problem, SPRING, 1, &spring));
        OK(feti_displacement(problem, BLOCK, 2, block));
        OK(feti_multipliers(problem, FETI_INEQUALITY, 1, &lambda));
        OK(feti_gaps(problem, 1, &gap));
        OK(feti_active(problem, 1, &closed));
        check_number(spring, -3.0, "spring");
        check_number(block[0], -4.0 - 6.0 * inv_k, "near end of the block");
        check_number(block[1], -5.5 - 6.0 * inv_k, "far end of the block");
        check_number(lambda, 6.0, "lambda");
        check_number(1.0 + gap / (1.0 + 6.0 * inv_k), 1.0, "gap that is left");
        CHECK(closed == FETI_ROW_CLOSED, "state %d", (int)closed);
        CHECK(info.worst <= 1.0, "certificate %g of its limit", info.worst);
        /* u_spring^2 + 2 (u_0 - u_1)^2 + 6 u_1 + 36 inv_k / 2 */
        check_number(info.energy, 9.0 + 4.5 + 6.0 * (-5.5 - 6.0 * inv_k) + 18.0 * inv_k, "energy");
        OK(feti_dual_apply(problem, 1, &force, &image));
        check_number(image, rigid + inv_k, "F");
    }
    factorisations = info.factorisations;
    lambda = 0.0;
    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, &lambda));
    OK(feti_state_restore(problem, state)); /* the compliance belongs to the rows, not to the state */
    check_small_answer(problem, "rigid again");
    OK(feti_solve(problem, &info));
    CHECK(info.factorisations == factorisations, "a body was factorised anew");
    OK(feti_problem_destroy(&problem));
}

/* One rigid unknown over springs k_i that begin at c_i: lambda_i = k_i (u - c_i)_+. */
static void a_rigid_punch_on_a_bed_of_springs(void)
{
    static const double k[4] = { 2.0, 3.0, 10.0, 1.0 }, begin[4] = { 0.0, 0.5, 1.25, 4.0 };
    static const double depth[5] = { 0.1, 0.5, 0.75, 2.0, 7.0 }, ones[4] = { 1.0, 1.0, 1.0, 1.0 };
    static const int32_t ptr[5] = { 0, 1, 2, 3, 4 }, dof[4] = { 0, 0, 0, 0 };
    const double none = 0.0, mode = 1.0;
    double inv_k[4], pressure[4], u;
    feti_problem *problem = NULL;
    int64_t body = -1;

    for (int i = 0; i < 4; i++) inv_k[i] = 1.0 / k[i];
    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &body));
    MUST(feti_body_stiffness_dense(problem, 0, 1, &none, 1, FETI_FULL, FETI_COPY));
    MUST(feti_body_null_space(problem, 0, 1, 1, &mode, 1, FETI_EXACT));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 4, ptr, NULL, dof, ones, 0, begin, NULL));
    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 0, 1, inv_k));
    OK(feti_rows_compliance(problem, FETI_INEQUALITY, 1, 3, inv_k + 1));
    for (int step = 0; step < 5; step++) {
        double load = 0.0;
        for (int i = 0; i < 4; i++) load += k[i] * fmax(0.0, depth[step] - begin[i]);
        OK(feti_body_load(problem, 0, 1, &load));
        OK(feti_solve(problem, NULL));
        OK(feti_displacement(problem, 0, 1, &u));
        OK(feti_multipliers(problem, FETI_INEQUALITY, 4, pressure));
        check_number(u, depth[step], "depth");
        for (int i = 0; i < 4; i++) check_number(pressure[i], k[i] * fmax(0.0, depth[step] - begin[i]), "pressure");
    }
    OK(feti_problem_destroy(&problem));
}

/* Stiffness 2 under a load 3, the row 2 u - h = mu/4: mu = (3 - h) / 2.25, pulling and pushing. */
static void an_elastic_support(void)
{
    static const int32_t ptr[2] = { 0, 1 }, dof[1] = { 0 };
    const double stiffness = 2.0, load = 3.0, row = 2.0, inv_k = 0.25;
    feti_problem *problem = NULL;
    int64_t body = -1;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &body));
    MUST(feti_body_stiffness_dense(problem, 0, 1, &stiffness, 1, FETI_FULL, FETI_COPY));
    MUST(feti_body_null_space(problem, 0, 0, 1, NULL, 1, FETI_EXACT));
    MUST(feti_body_load(problem, 0, 1, &load));
    MUST(feti_rows_add_i32(problem, FETI_EQUALITY, 1, ptr, NULL, dof, &row, 0, NULL, NULL));
    OK(feti_rows_compliance(problem, FETI_EQUALITY, 0, 1, &inv_k));
    for (double h = -1.0; h < 6.0; h += 3.0) {
        const double wanted = (3.0 - h) / 2.25;
        double u, mu, certified[2];
        feti_certificate certificate = { .struct_size = sizeof certificate };
        OK(feti_rows_rhs(problem, FETI_EQUALITY, 0, 1, &h));
        OK(feti_solve(problem, NULL));
        OK(feti_displacement(problem, 0, 1, &u));
        OK(feti_multipliers(problem, FETI_EQUALITY, 1, &mu));
        check_number(u, (3.0 - 2.0 * wanted) / 2.0, "u");
        check_number(mu, wanted, "mu");
        OK(feti_check(problem, 1, &u, 0, NULL, 1, &mu, &certificate));
        CHECK(certificate.worst <= 1.0, "certificate %g of its limit", certificate.worst);
        certified[0] = h / 2.0; /* the answer of a rigid support is none */
        certified[1] = (3.0 - h) / 2.0;
        OK(feti_check(problem, 1, certified, 0, NULL, 1, certified + 1, &certificate));
        CHECK(certificate.equality > 0.01 && certificate.equilibrium < 1e-12, "equality %g", certificate.equality);
    }
    OK(feti_problem_destroy(&problem));
}

int main(void)
{
    a_spring_between_spring_and_block();
    a_rigid_punch_on_a_bed_of_springs();
    an_elastic_support();
    return check_result();
}
