/* Friction by hand to 1e-9. A block of three unknowns on springs of stiffness 2 is pressed by 4 against a wall, row 0: lambda = 4,
   with a coefficient of 0.5 a bound of 2. Pushed by (0.6, 0.8) it sticks. Pushed by (3, 4) it slips: lambda_t = (1.2, 1.6),
   u = s = (0.9, 1.2). Let go it slips back: lambda_t = -(1.2, 1.6), u = (0.6, 0.8), s = (-0.3, -0.4).
   One of one unknown, pushed by 3, has no wall, and a bound of its own. */
#include <unistd.h>

#include "check.h"

enum { ALONG = 2 };

static void check_numbers(int n, const double *found, const double *wanted, const char *what)
{
    for (int i = 0; i < n; i++) CHECK(fabs(found[i] - wanted[i]) <= 1e-9, "%s %d: %.15g, by hand %.15g", what, i, found[i], wanted[i]);
}

static void push(feti_problem *problem, double x, double y)
{
    const double load[3] = { x, y, 4.0 };
    OK(feti_body_load(problem, 0, 3, load));
}

/* The block with its node. */
static feti_problem *block(void)
{
    static const int32_t ptr[4] = { 0, 1, 2, 3 }, col[3] = { 0, 1, 2 }, row_ptr[2] = { 0, 1 }, row_dof[1] = { 2 };
    static const int32_t normal[1] = { 0 }, t_ptr[3] = { 0, 1, 2 }, t_dof[2] = { 0, 1 };
    static const double k[3] = { 2.0, 2.0, 2.0 }, one[2] = { 1.0, 1.0 }, coefficient[1] = { 0.5 };
    feti_problem *problem = NULL;
    int64_t body, first = -1;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 3, &body));
    MUST(feti_body_stiffness_i32(problem, 0, 3, ptr, col, k, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, row_ptr, NULL, row_dof, one, 0, NULL, NULL));
    MUST(feti_friction_add_i32(problem, 1, ALONG, normal, t_ptr, NULL, t_dof, one, 0, coefficient, NULL, &first));
    CHECK(first == 0, "the first node has number %d", (int)first);
    return problem;
}

static void check_counts(feti_problem *problem, int64_t nodes, int32_t dim, const char *what)
{
    int64_t found = -1;
    int32_t rows = -1;
    OK(feti_friction_counts(problem, &found, &rows));
    CHECK(found == nodes && rows == dim, "%s: %d nodes of %d rows, expected %d of %d", what, (int)found, (int)rows, (int)nodes, (int)dim);
    OK(feti_friction_counts(problem, NULL, NULL));
}

static void check_answer(feti_problem *problem, const double force[2], const double slip[2], int32_t state, const char *what)
{
    double u[3], lambda[1], tangential[ALONG], slips[ALONG], reaction[3], all[3];
    int32_t found = -1;
    feti_certificate certificate = { .struct_size = sizeof certificate };

    OK(feti_multipliers(problem, FETI_TANGENTIAL, ALONG, tangential));
    OK(feti_multipliers(problem, FETI_INEQUALITY, 1, lambda));
    OK(feti_friction_slips(problem, 1, ALONG, slips));
    OK(feti_friction_states(problem, 1, &found));
    OK(feti_displacement(problem, 0, 3, u));
    check_numbers(ALONG, tangential, force, what);
    check_numbers(ALONG, slips, slip, what);
    CHECK(fabs(lambda[0] - 4.0) <= 1e-9, "%s: lambda %g", what, lambda[0]);
    CHECK(found == state, "%s: state %d, by hand %d", what, (int)found, (int)state);
    OK(feti_reaction(problem, FETI_TANGENTIAL, 0, 3, reaction));
    OK(feti_reaction(problem, 0, 0, 3, all));
    CHECK(reaction[0] == -tangential[0] && reaction[1] == -tangential[1] && reaction[2] == 0.0 && all[0] == reaction[0],
          "%s: the force on the block is not -T'lambda_t", what);
    OK(feti_check_friction(problem, 3, u, 1, lambda, 0, NULL, 1, ALONG, tangential, &certificate));
    CHECK(certificate.passed == 1, "%s: certificate %g", what, certificate.worst);
    tangential[0] += 0.1;
    OK(feti_check_friction(problem, 3, u, 1, lambda, 0, NULL, 1, ALONG, tangential, &certificate));
    CHECK(certificate.passed == 0, "%s: another force passes", what);
}

static void a_block_sticks_slips_and_slips_back(void)
{
    static const double stuck[2] = { 0.6, 0.8 }, none[2] = { 0.0, 0.0 }, bound[2] = { 1.2, 1.6 }, slid[2] = { 0.9, 1.2 };
    static const double back[2] = { -1.2, -1.6 }, returned[2] = { -0.3, -0.4 };
    feti_problem *problem = block();
    feti_info info = { .struct_size = sizeof info };
    int64_t state = -1;
    double slips[2];

    EXPECT(FETI_STATE, feti_friction_commit(problem));
    EXPECT(FETI_STATE, feti_friction_slips(problem, 1, ALONG, slips));
    push(problem, 0.6, 0.8);
    OK(feti_solve(problem, &info));
    CHECK(info.nodes == 1 && info.sticking == 1 && info.slipping == 0, "%d nodes, %d stick, %d slip", (int)info.nodes,
          (int)info.sticking, (int)info.slipping);
    check_answer(problem, stuck, none, FETI_FRICTION_STICK, "stick");
    OK(feti_friction_commit(problem));
    push(problem, 3.0, 4.0);
    OK(feti_solve(problem, &info));
    CHECK(info.sticking == 0 && info.slipping == 1, "%d stick, %d slip", (int)info.sticking, (int)info.slipping);
    check_answer(problem, bound, slid, FETI_FRICTION_SLIP, "slip");
    OK(feti_state_save(problem, &state));
    OK(feti_friction_commit(problem));
    OK(feti_friction_slips(problem, 1, ALONG, slips));
    check_numbers(ALONG, slips, slid, "slips after the commit");
    push(problem, 0.0, 0.0);
    OK(feti_solve(problem, &info));
    check_answer(problem, back, returned, FETI_FRICTION_SLIP, "let go");
    OK(feti_state_restore(problem, state)); /* with the s_old before the commit */
    check_answer(problem, bound, slid, FETI_FRICTION_SLIP, "restored");
    OK(feti_start_from(problem, FETI_TANGENTIAL, ALONG, bound));
    OK(feti_solve(problem, &info));
    check_answer(problem, bound, slid, FETI_FRICTION_SLIP, "from a start");
    OK(feti_problem_destroy(&problem));
}

/* A bound of 10 holds the push of 5; C_t = 1/2: u = C_t lambda_t and lambda_t = f - 2 u give u = f / 4, lambda_t = f / 2. s_old is where
   the block sticks. */
static void laws_compliances_and_references_change(void)
{
    static const double push_[2] = { 3.0, 4.0 }, none[2] = { 0.0, 0.0 }, half[2] = { 1.5, 2.0 }, s_old[2] = { 0.5, 1.0 }, moved[2] = { 2.0, 2.0 };
    const double large = 10.0, zero = 0.0, elastic = 0.5, wrong[2] = { -1.0, NAN };
    feti_problem *problem = block();
    feti_error_detail detail = { .struct_size = sizeof detail };

    push(problem, 3.0, 4.0);
    EXPECT(FETI_ARGUMENT - 5, feti_friction_law(problem, 0, 1, NULL, wrong));
    OK(feti_last_error_detail(&detail));
    CHECK(detail.node == 0 && detail.entry == 0 && detail.value == -1.0, "node %d, entry %d", (int)detail.node, (int)detail.entry);
    OK(feti_friction_law(problem, 0, 1, NULL, &large));
    OK(feti_solve(problem, NULL));
    check_answer(problem, push_, none, FETI_FRICTION_STICK, "bound");
    OK(feti_friction_compliance(problem, 0, 1, &elastic));
    EXPECT(FETI_STATE, feti_friction_commit(problem));
    OK(feti_solve(problem, NULL));
    check_answer(problem, half, none, FETI_FRICTION_STICK, "elastic stick");
    EXPECT(FETI_ARGUMENT - 4, feti_friction_compliance(problem, 0, 1, wrong));
    OK(feti_friction_compliance(problem, 0, 1, &zero));
    EXPECT(FETI_ARGUMENT - 4, feti_friction_reference(problem, 0, 1, 1, s_old));
    EXPECT(FETI_ARGUMENT - 5, feti_friction_reference(problem, 0, 1, ALONG, wrong));
    OK(feti_friction_reference(problem, 0, 1, ALONG, s_old));
    OK(feti_solve(problem, NULL));
    check_answer(problem, moved, none, FETI_FRICTION_STICK, "s_old");
    check_counts(problem, 1, ALONG, "a node in space");
    OK(feti_friction_clear(problem));
    check_counts(problem, 0, 0, "after feti_friction_clear");
    EXPECT(FETI_ARGUMENT - 2, feti_friction_law(problem, 0, 1, &large, NULL));
    OK(feti_solve(problem, NULL));
    OK(feti_problem_destroy(&problem));
}

/* Without a contact row, dim = 1, 64-bit indices that count from 1, bodies by number: pushed by 3 against a bound of 1. */
static void a_bound_acts_alone(void)
{
    static const int64_t normal[1] = { 0 }, ptr[2] = { 1, 2 }, body[1] = { 1 }, dof[1] = { 1 };
    const double one = 1.0, load = 3.0, k = 2.0;
    feti_problem *problem = NULL;
    int64_t number, first = -1;
    double force, slip, u;
    int32_t state;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &number));
    MUST(feti_body_stiffness_dense(problem, 0, 1, &k, 1, FETI_FULL, FETI_COPY));
    MUST(feti_body_load(problem, 0, 1, &load));
    EXPECT(FETI_ARGUMENT - 4, feti_friction_add_i64(problem, 1, 1, normal, ptr, body, dof, &one, 1, &one, &one, NULL));
    OK(feti_friction_add_i64(problem, 1, 1, normal, ptr, body, dof, &one, 1, NULL, &one, &first));
    check_counts(problem, 1, 1, "a node in the plane");
    CHECK(first == 0, "the first node has number %d", (int)first);
    OK(feti_solve(problem, NULL));
    OK(feti_multipliers(problem, FETI_TANGENTIAL, 1, &force));
    OK(feti_friction_slips(problem, 1, 1, &slip));
    OK(feti_friction_states(problem, 1, &state));
    OK(feti_displacement(problem, 0, 1, &u));
    CHECK(fabs(force - 1.0) <= 1e-9 && fabs(slip - 1.0) <= 1e-9 && fabs(u - 1.0) <= 1e-9, "force %g, slip %g, u %g", force, slip, u);
    CHECK(state == FETI_FRICTION_SLIP, "state %d", (int)state);
    OK(feti_friction_law(problem, 0, 1, NULL, &load));
    OK(feti_solve(problem, NULL));
    OK(feti_displacement(problem, 0, 1, &u));
    CHECK(fabs(u) <= 1e-9, "u %g", u);
    OK(feti_problem_destroy(&problem));
}

/* Read back a problem has its nodes, laws and s_old. */
static void a_problem_with_friction_is_written_and_read(void)
{
    char path[64];
    static const double s_old[2] = { 0.5, 1.0 }, held[2] = { 2.0, 2.0 }, none[2] = { 0.0, 0.0 };
    const double large = 10.0;
    feti_problem *problem = block(), *back = NULL;

    snprintf(path, sizeof path, "friction-%ld.feti", (long)getpid());
    push(problem, 3.0, 4.0);
    OK(feti_friction_law(problem, 0, 1, NULL, &large));
    OK(feti_friction_reference(problem, 0, 1, ALONG, s_old));
    OK(feti_problem_write(problem, path));
    MUST(feti_problem_create(&back));
    check_counts(back, 0, 0, "an empty problem");
    OK(feti_problem_read(back, path));
    remove(path);
    check_counts(back, 1, ALONG, "a problem that was read");
    OK(feti_solve(back, NULL));
    check_answer(back, held, none, FETI_FRICTION_STICK, "read");
    OK(feti_rows_clear(back, FETI_INEQUALITY));
    EXPECT(FETI_ARGUMENT - 2, feti_friction_law(back, 0, 1, NULL, &large));
    OK(feti_problem_destroy(&back));
    OK(feti_problem_destroy(&problem));
}

int main(void)
{
    a_block_sticks_slips_and_slips_back();
    laws_compliances_and_references_change();
    a_bound_acts_alone();
    a_problem_with_friction_is_written_and_read();
    return check_result();
}
