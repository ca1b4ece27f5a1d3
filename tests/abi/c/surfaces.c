/* Surfaces and pairs with results by hand. Two strips of three nodes at x = 0, 1, 2, each unknown on a spring of stiffness 4 to the
   ground: the lower one at y = 0 is the master, the upper one the slave, with areas .5, 1, .5. A node that is pushed down by F across a
   gap g carries (F - 4 g) / 2, and both springs yield. */
#include "check.h"

enum { NODES = 3, DOFS = 2 * NODES, LOWER = 0, UPPER = 1, NONE = -1 };

static const double LINE_X[DOFS] = { 0.0, 0.0, 1.0, 0.0, 2.0, 0.0 };
static const double SPRINGS[DOFS] = { 4.0, 4.0, 4.0, 4.0, 4.0, 4.0 }, AREAS[NODES] = { 0.5, 1.0, 0.5 };
static const int32_t PTR[DOFS + 1] = { 0, 1, 2, 3, 4, 5, 6 }, COL[DOFS] = { 0, 1, 2, 3, 4, 5 };
/* The body is on the left: above the slave's lines, below those of the master. */
static const int32_t SLAVE_LINES[4] = { 0, 1, 1, 2 };
static const int64_t MASTER_LINES_FROM_ONE[4] = { 2, 1, 3, 2 };

static feti_problem *two_bodies(void)
{
    feti_problem *p = NULL;
    int64_t body;

    MUST(feti_problem_create(&p));
    for (int k = 0; k < 2; k++) {
        MUST(feti_body_add(p, DOFS, &body));
        MUST(feti_body_stiffness_i32(p, body, DOFS, PTR, COL, SPRINGS, 0, FETI_LOWER, FETI_COPY));
    }
    return p;
}

static void lifted(double x[DOFS], double y)
{
    for (int k = 0; k < DOFS; k++) x[k] = k % 2 ? y : LINE_X[k];
}

/* The slave at height y, surface 0; its unknowns are those of body 1. */
static int64_t add_slave(feti_problem *p, double y)
{
    double x[DOFS];
    int64_t surface = NONE;

    lifted(x, y);
    OK(feti_surface_add_i32(p, UPPER, 2, NODES, x, 2, COL, 2, 0, &surface));
    OK(feti_surface_faces_i32(p, surface, FETI_LINE2, 2, SLAVE_LINES, 0));
    return surface;
}

/* The master by 64-bit numbers through all bodies, from 1, in columns of three with a number that is not read. */
static int64_t add_master(feti_problem *p)
{
    const double x[3 * NODES] = { 0.0, 0.0, NAN, 1.0, 0.0, NAN, 2.0, 0.0, NAN };
    const int64_t dof[3 * NODES] = { 1, 2, 99, 3, 4, 99, 5, 6, 99 };
    int64_t surface = NONE;

    OK(feti_surface_add_i64(p, FETI_ALL, 2, NODES, x, 3, dof, 3, 1, &surface));
    OK(feti_surface_faces_i64(p, surface, FETI_LINE2, 2, MASTER_LINES_FROM_ONE, 1));
    return surface;
}

static feti_problem *two_strips(double gap, int32_t method, int64_t *slave, int64_t *pair)
{
    feti_problem *p = two_bodies();
    int64_t first = NONE;

    *slave = add_slave(p, gap);
    MUST(feti_pair_add(p, *slave, add_master(p), method, 0.5, pair, &first));
    CHECK(*pair == 0 && first == 0, "pair %lld, first row %lld", (long long)*pair, (long long)first);
    return p;
}

static void load(feti_problem *p, const double f[DOFS])
{
    OK(feti_body_load(p, UPPER, DOFS, f));
}

static void expect_field(feti_problem *p, int64_t pair, int32_t field, int n, const double *wanted, const char *what)
{
    double found[DOFS];

    OK(feti_pair_field(p, pair, field, n, found));
    CHECK(check_distance(n, found, wanted) <= 1e-9, "%s: %g %g %g %g %g %g", what, found[0], found[1], found[2], n > 3 ? found[3] : 0.0,
          n > 3 ? found[4] : 0.0, n > 3 ? found[5] : 0.0);
}

static feti_pair_facts facts_of(feti_problem *p, int64_t pair)
{
    feti_pair_facts facts = { .struct_size = sizeof facts };

    OK(feti_pair_info(p, pair, &facts));
    return facts;
}

/* Loads F = 1 + 2 p A across a gap of .25 give the pressure p = 3. */
static void pressed(void)
{
    const double f[DOFS] = { 0.0, -4.0, 0.0, -7.0, 0.0, -4.0 }, u[DOFS] = { 0.0, -0.625, 0.0, -1.0, 0.0, -0.625 };
    int64_t slave, pair, rows, nodes, faces, data;
    int32_t dim;
    double found[DOFS], all[2 * DOFS], lambda[NODES];
    feti_certificate judged = { .struct_size = sizeof judged };
    feti_problem *p = two_strips(0.25, FETI_NODE_TO_FACE, &slave, &pair);

    OK(feti_surface_counts(p, slave, &dim, &nodes, &faces, &data));
    CHECK(dim == 2 && nodes == NODES && faces == 2 && data == 0, "%d, %lld, %lld", (int)dim, (long long)nodes, (long long)faces);
    EXPECT(FETI_STATE, feti_pair_field(p, pair, FETI_PRESSURE, NODES, found));
    load(p, f);
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    OK(feti_displacement(p, UPPER, DOFS, found));
    CHECK(check_distance(DOFS, found, u) <= 1e-9, "u of node 1 is %g", found[3]);
    OK(feti_counts(p, NULL, NULL, &rows, NULL));
    CHECK(rows == NODES, "%lld rows", (long long)rows);
    expect_field(p, pair, FETI_AREA, NODES, AREAS, "areas");
    expect_field(p, pair, FETI_PRESSURE, NODES, (double[3]){ 3.0, 3.0, 3.0 }, "pressures");
    expect_field(p, pair, FETI_FORCE, NODES, (double[3]){ 1.5, 3.0, 1.5 }, "forces");
    expect_field(p, pair, FETI_GAP, NODES, (double[3]){ 0.0, 0.0, 0.0 }, "gaps");
    expect_field(p, pair, FETI_CLOSED, NODES, (double[3]){ 1.0, 1.0, 1.0 }, "states");
    expect_field(p, pair, FETI_NORMAL, DOFS, (double[6]){ 0.0, -1.0, 0.0, -1.0, 0.0, -1.0 }, "normals");
    const feti_pair_facts facts = facts_of(p, pair);
    CHECK(facts.rows == 3 && facts.without == 0 && facts.closed == 3 && facts.sticking == 0 && facts.held == 0, "counts of the pair");
    CHECK(check_distance(3, facts.force, (double[3]){ 0.0, 6.0, 0.0 }) <= 1e-9, "force %g %g", facts.force[0], facts.force[1]);
    CHECK(check_distance(3, facts.moment, (double[3]){ 0.0, 0.0, 6.0 }) <= 1e-9, "moment %g", facts.moment[2]);
    CHECK(fabs(facts.closed_area - 2.0) <= 1e-12 && fabs(facts.pressure - 3.0) <= 1e-9 && facts.pressure_node >= 0, "pressure %g",
          facts.pressure);
    CHECK(facts.depth == 0.0 && facts.depth_node == NONE && facts.master_depth_node == NONE, "depth %g", facts.depth);
    /* node 2 pulls with 1, in equilibrium: its row is the worst, and is named by pair and node */
    OK(feti_multipliers(p, FETI_INEQUALITY, NODES, lambda));
    OK(feti_displacement(p, FETI_ALL, 2 * DOFS, all));
    lambda[2] = -1.0;
    all[5] = 0.25;
    all[DOFS + 5] = -1.25;
    OK(feti_check(p, 2 * DOFS, all, NODES, lambda, 0, NULL, &judged));
    CHECK(judged.passed == 0 && judged.force_row == 2, "row %lld", (long long)judged.force_row);
    CHECK(judged.pair == 0 && judged.pair_node == 2, "pair %lld, node %lld", (long long)judged.pair, (long long)judged.pair_node);
    OK(feti_problem_destroy(&p));
}

/* One of the nodes is lifted: it opens, by what the springs do not close. */
static void moved(void)
{
    const double f[DOFS] = { 0.0, -3.0, 0.0, -6.0, 0.0, -3.0 };
    int64_t slave, pair, state;
    double x[DOFS], before[DOFS], after[DOFS];
    feti_problem *p = two_strips(0.0, FETI_NODE_TO_FACE, &slave, &pair);

    load(p, f);
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    expect_field(p, pair, FETI_PRESSURE, NODES, (double[3]){ 3.0, 3.0, 3.0 }, "without a gap");
    OK(feti_pair_field(p, pair, FETI_FORCE, NODES, before));
    OK(feti_state_save(p, &state));
    lifted(x, 0.0);
    x[1] = -0.125; /* of node 0, which overlaps by that */
    x[5] = 3.0;    /* of node 2, beyond the distance */
    OK(feti_surface_move(p, slave, x, 2));
    expect_field(p, pair, FETI_PRESSURE, NODES, (double[3]){ 3.0, 3.0, 3.0 }, "before the next find");
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    feti_pair_facts facts = facts_of(p, pair);
    CHECK(facts.without == 1 && facts.closed == 2 && facts.depth_node == 0, "without %lld, closed %lld", (long long)facts.without,
          (long long)facts.closed);
    CHECK(fabs(facts.depth - 0.125) <= 1e-12, "depth %g", facts.depth);
    OK(feti_pair_field(p, pair, FETI_FORCE, NODES, after));
    CHECK(after[2] == 0.0 && after[0] > before[0], "forces %g %g", after[0], after[2]);
    OK(feti_state_restore(p, state));
    for (int again = 0; again <= 1; again++) {
        EXPECT(again ? FETI_OK : FETI_STATE, feti_pair_field(p, pair, FETI_FORCE, NODES, after));
        if (again) OK(feti_pairs_find(p));
        OK(feti_solve(p, NULL));
        OK(feti_pair_field(p, pair, FETI_FORCE, NODES, after));
        CHECK(memcmp(before, after, NODES * sizeof *before) == 0, "other forces after the state was restored");
    }
    OK(feti_problem_destroy(&p));
}

/* Coefficient .5: node 0 slips under .75, node 1 sticks under 1, node 2 has no shear. A cohesion of 1 per area then adds .5 at node 0. */
static void rubbed(void)
{
    const double f[DOFS] = { 4.0, -3.0, 2.0, -6.0, 0.0, -3.0 };
    double mu = 0.5, cohesion[NODES] = { 1.0, 0.0, 0.0 };
    int64_t slave, pair, nodes;
    int32_t dim;
    feti_problem *p = two_strips(0.0, FETI_NODE_TO_FACE, &slave, &pair);

    OK(feti_pair_set_f64(p, pair, "friction", 1, &mu));
    load(p, f);
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    OK(feti_friction_counts(p, &nodes, &dim));
    CHECK(nodes == NODES && dim == 1, "%lld nodes of %d rows", (long long)nodes, (int)dim);
    expect_field(p, pair, FETI_SHEAR, DOFS, (double[6]){ -1.5, 0.0, -1.0, 0.0, 0.0, 0.0 }, "shear");
    expect_field(p, pair, FETI_SLIP, DOFS, (double[6]){ 0.625, 0.0, 0.0, 0.0, 0.0, 0.0 }, "slip");
    expect_field(p, pair, FETI_CLOSED, NODES, (double[3]){ 3.0, 2.0, 2.0 }, "states");
    feti_pair_facts facts = facts_of(p, pair);
    CHECK(facts.sticking == 2 && facts.slipping == 1 && facts.closed == 3, "%lld stick", (long long)facts.sticking);
    CHECK(check_distance(3, facts.force, (double[3]){ -1.75, 6.0, 0.0 }) <= 1e-9, "force %g %g", facts.force[0], facts.force[1]);
    OK(feti_pairs_commit(p));
    OK(feti_pair_set_f64(p, pair, "cohesion", NODES, cohesion));
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    expect_field(p, pair, FETI_SHEAR, DOFS, (double[6]){ -2.5, 0.0, -1.0, 0.0, 0.0, 0.0 }, "shear with cohesion");
    OK(feti_problem_destroy(&p));
}

/* A tie carries tension, and half of the load goes to each spring. */
static void tied(void)
{
    const double f[DOFS] = { 2.0, 0.0, 0.0, 6.0, 0.0, 0.0 }, u[DOFS] = { 0.25, 0.0, 0.0, 0.75, 0.0, 0.0 };
    int64_t slave, pair, rows, eqs;
    double found[DOFS];
    feti_problem *p = two_strips(0.0, FETI_NODE_TO_FACE + FETI_TIED, &slave, &pair);

    load(p, f);
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    OK(feti_counts(p, NULL, NULL, &rows, &eqs));
    CHECK(rows == 0 && eqs == DOFS, "%lld and %lld rows", (long long)rows, (long long)eqs);
    for (int64_t body = LOWER; body <= UPPER; body++) {
        OK(feti_displacement(p, body, DOFS, found));
        CHECK(check_distance(DOFS, found, u) <= 1e-9, "body %lld: %g %g", (long long)body, found[0], found[3]);
    }
    expect_field(p, pair, FETI_FORCE, NODES, (double[3]){ 0.0, -3.0, 0.0 }, "tension");
    expect_field(p, pair, FETI_SHEAR, DOFS, (double[6]){ -2.0, 0.0, 0.0, 0.0, 0.0, 0.0 }, "shear of the tie");
    OK(feti_problem_destroy(&p));
}

/* A plane carries the whole load; it moves up by .5 under a shell of thickness .25, whose nodes are .125 above their surface. */
static void on_a_plane(void)
{
    const double f[DOFS] = { 0.0, -3.0, 0.0, -6.0, 0.0, -3.0 }, plane[4] = { 0.0, 0.0, 0.0, 2.0 }, up[4] = { 5.0, 0.5, 0.0, 1.0 };
    const double half = 0.125, off = 0.0;
    int64_t slave, master, pair, data;
    double u[DOFS];
    feti_problem *p = two_bodies();

    slave = add_slave(p, 0.0);
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, plane, &master));
    MUST(feti_pair_add(p, slave, master, FETI_NODE_TO_FACE, 1.0, &pair, NULL));
    OK(feti_surface_counts(p, master, NULL, NULL, NULL, &data));
    CHECK(data == 4, "a plane of %lld numbers", (long long)data);
    load(p, f);
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    expect_field(p, pair, FETI_PRESSURE, NODES, (double[3]){ 6.0, 6.0, 6.0 }, "on the plane");
    OK(feti_pair_set_f64(p, pair, "offset", 1, &half));
    OK(feti_surface_move(p, master, up, 0));
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    OK(feti_displacement(p, UPPER, DOFS, u));
    for (int k = 1; k < DOFS; k += 2) CHECK(fabs(u[k] - 0.625) <= 1e-9, "u = %g", u[k]);
    OK(feti_pair_set_f64(p, pair, "on", 1, &off));
    OK(feti_pairs_find(p));
    OK(feti_solve(p, NULL));
    expect_field(p, pair, FETI_FORCE, NODES, (double[3]){ 0.0, 0.0, 0.0 }, "switched off");
    OK(feti_problem_destroy(&p));
}

/* A node between two planes that leave it no room; a held node inside of a plane. */
static void contradictions(void)
{
    const double x[2] = { 1.0, 0.0 }, floor_[4] = { 0.0, 0.0, 0.0, 1.0 }, roof[4] = { 0.0, -0.1, 0.0, -1.0 }, inside[4] = { 0.0, 0.2, 0.0, 1.0 };
    const int32_t dof[2] = { 2, 3 }, held[2] = { -1, -1 };
    int64_t cloud, planes[2], pair;
    feti_findings found = { .struct_size = sizeof found };
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[512] = "";
    feti_problem *p = two_bodies();

    MUST(feti_surface_add_i32(p, UPPER, 2, 1, x, 2, dof, 2, 0, &cloud));
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, floor_, planes));
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, roof, planes + 1));
    for (int k = 0; k < 2; k++) MUST(feti_pair_add(p, cloud, planes[k], FETI_NODE_TO_FACE, 0.5, &pair, NULL));
    OK(feti_pairs_find(p));
    EXPECT(FETI_GAPS_CONTRADICT, feti_solve(p, NULL));
    feti_last_error(text, sizeof text);
    CHECK(strstr(text, "pair ") && strstr(text, "node 0"), "the text names neither pair nor node: %s", text);
    OK(feti_diagnosis(p, &found));
    CHECK(found.pair == found.row && found.pair_node == 0, "pair %lld, node %lld", (long long)found.pair, (long long)found.pair_node);
    OK(feti_problem_destroy(&p));

    p = two_bodies();
    MUST(feti_surface_add_i32(p, UPPER, 2, 1, x, 2, held, 2, 0, &cloud));
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, inside, planes));
    MUST(feti_pair_add(p, cloud, planes[0], FETI_NODE_TO_FACE, 0.5, &pair, NULL));
    EXPECT(FETI_GAPS_CONTRADICT, feti_pairs_find(p));
    OK(feti_last_error_detail(&detail));
    CHECK(detail.pair == 0 && detail.node == 0, "pair %lld, node %lld", (long long)detail.pair, (long long)detail.node);
    OK(feti_problem_destroy(&p));
}

/* The host has a table: unknowns 1 and 2 are those of a body, 0 is held at .25, 3 is constant + coefficient times unknown 1. The nodes have
   the heights 1 and 3, and a plane rises to .5. The rows of pairs follow a new table, also without a find. */
static void tabled(void)
{
    static const int32_t ptr[3] = { 0, 1, 2 }, number[4] = { -1, 1, 0, -1 }, term_ptr[5] = { 0, 0, 0, 0, 1 }, term[1] = { 1 }, dof[4] = { 2, 1, 0, 3 };
    static const double plane[4] = { 0.0, 0.5, 0.0, 1.0 };
    /* constant, coefficient, whether a find follows, height of node 0 and the forces */
    static const double tables[4][6] = { { 0.1, 2.0, 1, 0.5, 2.0, 0.0 }, { -1.0, 2.0, 0, 0.75, 0.0, 1.5 }, { -1.0, 2.0, 1, 0.75, 0.0, 1.5 },
                                         { -1.0, 1.0, 1, 1.5, 0.0, 6.0 } };
    int64_t body, cloud, master, pair = NONE;
    double u[4], force[2];
    feti_problem *p = NULL;

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, 2, &body));
    MUST(feti_body_stiffness_i32(p, body, 2, ptr, COL, SPRINGS, 0, FETI_LOWER, FETI_COPY));
    for (int k = 0; k < 4; k++) {
        const double constant[4] = { 0.25, 0.0, 0.0, tables[k][0] };
        OK(feti_dof_table_i32(p, 4, number, term_ptr, term, &tables[k][1], constant, 0));
        if (k == 0) {
            MUST(feti_surface_add_i32(p, FETI_ALL, 2, 2, LINE_X, 2, dof, 2, 0, &cloud));
            MUST(feti_surface_rigid(p, 2, FETI_PLANE, plane, &master));
            MUST(feti_pair_add(p, cloud, master, FETI_NODE_TO_FACE, 1.0, &pair, NULL));
        }
        if (tables[k][2] > 0.0) OK(feti_pairs_find(p));
        OK(feti_solve(p, NULL));
        OK(feti_displacement(p, FETI_ALL, 4, u));
        OK(feti_pair_field(p, pair, FETI_FORCE, 2, force));
        CHECK(fabs(u[1] - tables[k][3]) <= 1e-9 && check_distance(2, force, &tables[k][4]) <= 1e-9, "table %d: %g, forces %g %g", k, u[1],
              force[0], force[1]);
    }
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    pressed();
    moved();
    rubbed();
    tied();
    on_a_plane();
    tabled();
    contradictions();
    return check_result();
}
