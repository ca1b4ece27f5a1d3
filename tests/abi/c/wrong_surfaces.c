/* Every mistake with surfaces and pairs has its status, names argument, pair, face and node, and changes nothing: afterwards the problem
   solves to the same bits. A body of two unknowns on springs is pressed by 1 and 2 on a plane at y = 0. */
#include "check.h"

enum { NODES = 2, DOFS = 4, ANY = -9, NONE = -1, PLANE = 0, SLAVE = 1, CUBE = 2, TOOL = 3, BALL = 4, EMPTY = 5, PAIR = 0 };

static const double STIFF[DOFS] = { 1.0, 1.0, 1.0, 1.0 }, LOAD[DOFS] = { 0.0, -1.0, 0.0, -2.0 };
static const double X[DOFS] = { 0.0, 0.0, 1.0, 0.0 }, GROUND[4] = { 0.0, 0.0, 0.0, 1.0 }, SPHERE[4] = { 0.0, 0.0, -5.0, 1.0 };
static const int32_t PTR[DOFS + 1] = { 0, 1, 2, 3, 4 }, COL[DOFS] = { 0, 1, 2, 3 }, LINE[NODES] = { 0, 1 };

/* The corners of a cube, and a node between 0 and 1. */
static const double CORNERS[27] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0.5, 0, 0 };

static feti_problem *pressed(void)
{
    feti_problem *p = NULL;
    int64_t body, number;

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, DOFS, &body));
    MUST(feti_body_stiffness_i32(p, body, DOFS, PTR, COL, STIFF, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_load(p, body, DOFS, LOAD));
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, GROUND, &number));
    MUST(feti_surface_add_i32(p, body, 2, NODES, X, 2, COL, 2, 0, &number));
    MUST(feti_surface_faces_i32(p, SLAVE, FETI_LINE2, 1, LINE, 0));
    MUST(feti_surface_add_i32(p, FETI_ALL, 3, 9, CORNERS, 3, NULL, 0, 0, &number));
    MUST(feti_surface_add_i32(p, FETI_ALL, 2, NODES, X, 2, NULL, 0, 0, &number));
    MUST(feti_surface_rigid(p, 3, FETI_SPHERE, SPHERE, &number));
    MUST(feti_surface_add_i32(p, body, 2, 0, NULL, 2, COL, 2, 0, &number));
    CHECK(number == EMPTY, "surface %lld", (long long)number);
    MUST(feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, 0.5, &number, NULL));
    MUST(feti_pairs_find(p));
    return p;
}

static void forces(feti_problem *p, double force[NODES])
{
    OK(feti_solve(p, NULL));
    OK(feti_pair_field(p, PAIR, FETI_FORCE, NODES, force));
}

static void refused(feti_problem *p, int32_t wanted, int32_t found, int64_t pair, int64_t face, int64_t node, const char *call)
{
    static const double by_hand[NODES] = { 1.0, 2.0 };
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[512] = "";
    double force[NODES];

    feti_last_error(text, sizeof text);
    CHECK(found == wanted, "%s: status %d, expected %d: %s", call, (int)found, (int)wanted, text);
    OK(feti_last_error_detail(&detail));
    CHECK(detail.status == wanted && detail.argument == (wanted <= FETI_ARGUMENT ? FETI_ARGUMENT - wanted : 0), "%s: argument %d", call,
          (int)detail.argument);
    CHECK(pair == ANY || detail.pair == pair, "%s: pair %lld: %s", call, (long long)detail.pair, text);
    CHECK(detail.face == face, "%s: face %lld: %s", call, (long long)detail.face, text);
    CHECK(node == ANY || detail.node == node, "%s: node %lld: %s", call, (long long)detail.node, text);
    forces(p, force);
    CHECK(check_distance(NODES, force, by_hand) <= 1e-12, "%s: forces %g %g afterwards", call, force[0], force[1]);
}

#define REFUSED_AT(k, face, node, call) refused(p, FETI_ARGUMENT - (k), call, ANY, face, node, #call)
#define REFUSED(k, call) REFUSED_AT(k, NONE, NONE, call)
#define FAILS(status, call) refused(p, status, call, ANY, NONE, NONE, #call)

static void surfaces(feti_problem *p)
{
    const double nan_x[DOFS] = { 0.0, 0.0, 1.0, NAN }, huge[DOFS] = { 0.0, 0.0, 1e200, 0.0 };
    const int32_t far[DOFS] = { 0, 1, 2, 4 };
    const int64_t one[DOFS] = { 1, 2, 3, 5 };
    int64_t s;

    REFUSED_AT(5, NONE, 1, feti_surface_add_i32(p, 0, 2, NODES, nan_x, 2, COL, 2, 0, &s));
    REFUSED_AT(5, NONE, 1, feti_surface_add_i32(p, 0, 2, NODES, huge, 2, COL, 2, 0, &s));
    REFUSED_AT(7, NONE, 1, feti_surface_add_i32(p, 0, 2, NODES, X, 2, far, 2, 0, &s));
    REFUSED_AT(7, NONE, 1, feti_surface_add_i64(p, FETI_ALL, 2, NODES, X, 2, one, 2, 1, &s));
    REFUSED(2, feti_surface_add_i32(p, 1, 2, NODES, X, 2, COL, 2, 0, &s));
    REFUSED(3, feti_surface_add_i32(p, 0, 1, NODES, X, 2, COL, 2, 0, &s));
    REFUSED(4, feti_surface_add_i32(p, 0, 2, -1, X, 2, COL, 2, 0, &s));
    REFUSED(5, feti_surface_add_i32(p, 0, 2, NODES, NULL, 2, COL, 2, 0, &s));
    REFUSED(6, feti_surface_add_i32(p, 0, 2, NODES, X, 1, COL, 2, 0, &s));
    REFUSED(8, feti_surface_add_i32(p, 0, 2, NODES, X, 2, COL, 1, 0, &s));
    REFUSED(9, feti_surface_add_i32(p, 0, 2, NODES, X, 2, COL, 2, 2, &s));
    REFUSED(10, feti_surface_add_i32(p, 0, 2, NODES, X, 2, COL, 2, 0, NULL));
    REFUSED_AT(3, NONE, 1, feti_surface_move(p, SLAVE, nan_x, 2));
    REFUSED(3, feti_surface_move(p, PLANE, nan_x, 2));
    REFUSED(3, feti_surface_move(p, PLANE, (double[4]){ 1.0, 2.0, 0.0, 0.0 }, 2));
    REFUSED(3, feti_surface_move(p, SLAVE, NULL, 2));
    REFUSED(4, feti_surface_move(p, SLAVE, X, 1));
    REFUSED(2, feti_surface_move(p, 99, X, 2));
    REFUSED(2, feti_surface_rigid(p, 2, FETI_CYLINDER, SPHERE, &s));
    REFUSED(3, feti_surface_rigid(p, 2, FETI_QUAD4, GROUND, &s));
    REFUSED(4, feti_surface_rigid(p, 2, FETI_PLANE, (double[4]){ 1.0, 2.0, 0.0, 0.0 }, &s));
    REFUSED(4, feti_surface_rigid(p, 3, FETI_SPHERE, (double[4]){ 1.0, 2.0, 3.0, 0.0 }, &s));
    REFUSED(2, feti_surface_counts(p, 99, NULL, NULL, NULL, NULL));
}

static void faces(feti_problem *p)
{
    static const int32_t bottom[4] = { 0, 3, 2, 1 }, twice[8] = { 4, 5, 6, 7, 0, 1, 1, 4 }, flat[3] = { 0, 8, 1 }, against[4] = { 1, 2, 6, 5 };
    static const int32_t wrong_way[4] = { 0, 4, 5, 1 }, third[3] = { 0, 1, 6 }, crossed[4] = { 0, 3, 1, 2 }, front[4] = { 0, 1, 5, 4 }, below[3] = { 0, -1, 1 };

    REFUSED_AT(5, 1, NONE, feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 2, twice, 0));
    REFUSED_AT(5, 0, NONE, feti_surface_faces_i32(p, CUBE, FETI_TRI3, 1, flat, 0));
    REFUSED_AT(5, 0, NONE, feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 1, crossed, 0));
    REFUSED_AT(5, 0, NONE, feti_surface_faces_i32(p, CUBE, FETI_TRI3, 1, below, 0));
    REFUSED_AT(5, 0, NONE, feti_surface_faces_i32(p, CUBE, FETI_TRI3, 1, third, 1));
    OK(feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 1, bottom, 0));
    REFUSED_AT(5, 1, NONE, feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 1, wrong_way, 0));
    OK(feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 1, front, 0));
    REFUSED_AT(5, 2, NONE, feti_surface_faces_i32(p, CUBE, FETI_TRI3, 1, third, 0));
    OK(feti_surface_faces_i32(p, CUBE, FETI_QUAD4, 1, against, 0));
    REFUSED(3, feti_surface_faces_i32(p, CUBE, FETI_POINT, 4, bottom, 0));
    REFUSED(5, feti_surface_faces_i32(p, TOOL, FETI_POINT, 2, below, 0));
    OK(feti_surface_faces_i32(p, TOOL, FETI_POINT, 2, LINE, 0));
    REFUSED(3, feti_surface_faces_i32(p, TOOL, FETI_LINE2, 1, LINE, 0));
    REFUSED(3, feti_surface_faces_i32(p, CUBE, 0, 1, bottom, 0));
    REFUSED(3, feti_surface_faces_i32(p, CUBE, FETI_PLANE, 1, bottom, 0));
    REFUSED(3, feti_surface_faces_i32(p, CUBE, FETI_LINE2, 1, bottom, 0));
    REFUSED(4, feti_surface_faces_i32(p, CUBE, FETI_QUAD4, INT64_MAX / 3, bottom, 0));
    REFUSED(2, feti_surface_faces_i32(p, BALL, FETI_QUAD4, 1, bottom, 0));
    FAILS(FETI_STATE, feti_surface_faces_i32(p, SLAVE, FETI_LINE2, 1, LINE, 0));
}

static void pairs(feti_problem *p)
{
    int64_t k;

    FAILS(FETI_UNSUPPORTED, feti_pair_add(p, SLAVE, SLAVE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    OK(feti_surface_add_i32(p, 0, 2, NODES, X, 2, COL, 2, 0, &k));
    FAILS(FETI_UNSUPPORTED, feti_pair_add(p, k, PLANE, FETI_MORTAR, 1.0, &k, NULL)); /* a cloud */
    REFUSED(2, feti_pair_add(p, TOOL, PLANE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    REFUSED(2, feti_pair_add(p, PLANE, SLAVE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    REFUSED(2, feti_pair_add(p, EMPTY, PLANE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    REFUSED(2, feti_pair_add(p, 99, PLANE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    REFUSED(3, feti_pair_add(p, SLAVE, TOOL, FETI_NODE_TO_FACE, 1.0, &k, NULL)); /* no faces */
    REFUSED(3, feti_pair_add(p, SLAVE, BALL, FETI_NODE_TO_FACE, 1.0, &k, NULL)); /* in space */
    REFUSED(3, feti_pair_add(p, SLAVE, -1, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    for (int32_t method = -1; method <= 9; method++)
        if ((method & ~FETI_TIED) != FETI_NODE_TO_FACE && (method & ~FETI_TIED) != FETI_MORTAR)
            REFUSED(4, feti_pair_add(p, SLAVE, PLANE, method, 1.0, &k, NULL));
    REFUSED(5, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, 0.0, &k, NULL));
    REFUSED(5, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, -1.0, &k, NULL));
    REFUSED(5, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, NAN, &k, NULL));
    REFUSED(5, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, INFINITY, &k, NULL));
    REFUSED(6, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, 1.0, NULL, NULL));
}

#define REFUSED_OF_PAIR(k, node, call) refused(p, FETI_ARGUMENT - (k), call, PAIR, NONE, node, #call)

static void numbers_of_pairs(feti_problem *p)
{
    static const struct {
        const char *name;
        double value;
    } wrong[] = { { "friction", -0.1 }, { "cohesion", -1.0 }, { "offset", NAN }, { "compliance", INFINITY }, { "adjust", -1.0 }, { "on", 0.5 },
                  { "angle", 181.0 }, { "depth", -1.0 }, { "thickness", 0.0 }, { "axisymmetric", 2.0 } };
    const double by_node[NODES] = { 0.1, NAN }, some[3] = { 0.0, 0.0, 0.0 };
    double values[DOFS] = { 0.0 };
    feti_pair_facts facts = { .struct_size = 15 };

    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        REFUSED_OF_PAIR(5, NONE, feti_pair_set_f64(p, PAIR, wrong[k].name, 1, &wrong[k].value));
    REFUSED_OF_PAIR(5, 1, feti_pair_set_f64(p, PAIR, "offset", NODES, by_node));
    REFUSED_OF_PAIR(4, NONE, feti_pair_set_f64(p, PAIR, "offset", 3, some));
    REFUSED_OF_PAIR(4, NONE, feti_pair_set_f64(p, PAIR, "offset", 0, some));
    REFUSED_OF_PAIR(4, NONE, feti_pair_set_f64(p, PAIR, "thickness", NODES, some));
    REFUSED_OF_PAIR(3, NONE, feti_pair_set_f64(p, PAIR, "stiffness", 1, some));
    REFUSED_OF_PAIR(3, NONE, feti_pair_set_f64(p, PAIR, "", 1, some));
    REFUSED(3, feti_pair_set_f64(p, PAIR, NULL, 1, some));
    REFUSED(5, feti_pair_set_f64(p, PAIR, "offset", 1, NULL));
    REFUSED(2, feti_pair_set_f64(p, 1, "offset", 1, some));
    REFUSED(2, feti_pair_field(p, 1, FETI_FORCE, NODES, values));
    REFUSED(3, feti_pair_field(p, PAIR, 0, NODES, values));
    REFUSED(3, feti_pair_field(p, PAIR, FETI_CLOSED + 1, NODES, values));
    REFUSED(4, feti_pair_field(p, PAIR, FETI_FORCE, DOFS, values));
    REFUSED(4, feti_pair_field(p, PAIR, FETI_SHEAR, NODES, values));
    REFUSED(4, feti_pair_field(p, PAIR, FETI_FORCE, -1, values));
    REFUSED(5, feti_pair_field(p, PAIR, FETI_FORCE, NODES, NULL));
    REFUSED(3, feti_pair_info(p, PAIR, &facts));
    REFUSED(2, feti_pair_info(p, -1, &facts));
    CHECK(check_max(DOFS, values) == 0.0, "a refused call has written");
}

/* Rows and nodes of the host come behind those of pairs. */
static void order_of_calls(feti_problem *p)
{
    static const int32_t row_ptr[2] = { 0, 1 }, dof[1] = { 1 }, tangent[1] = { 0 }, normal[1] = { NODES };
    const double one[1] = { 1.0 }, gap[1] = { 9.0 }, mu[1] = { 0.1 };
    feti_error_detail detail = { .struct_size = sizeof detail };
    int64_t k;

    OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, row_ptr, NULL, dof, one, 0, gap, &k));
    CHECK(k == NODES, "row %lld of the host", (long long)k);
    EXPECT(FETI_STATE, feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE, 1.0, &k, NULL));
    OK(feti_last_error_detail(&detail));
    CHECK(detail.row == NODES, "row %lld", (long long)detail.row);
    OK(feti_friction_add_i32(p, 1, 1, normal, row_ptr, NULL, tangent, one, 0, mu, NULL, NULL));
    refused(p, FETI_STATE, feti_pair_set_f64(p, PAIR, "friction", 1, mu), PAIR, NONE, NONE, "friction of a pair after that of the host");
    OK(feti_rows_clear(p, FETI_INEQUALITY));
    OK(feti_pair_add(p, SLAVE, PLANE, FETI_NODE_TO_FACE + FETI_TIED, 1.0, &k, NULL));
    refused(p, FETI_UNSUPPORTED, feti_pair_set_f64(p, k, "friction", 1, mu), k, NONE, NONE, "friction of a tie");
}

int main(void)
{
    feti_problem *p = pressed();
    double before[NODES], after[NODES];

    forces(p, before);
    surfaces(p);
    faces(p);
    pairs(p);
    numbers_of_pairs(p);
    forces(p, after);
    CHECK(memcmp(before, after, sizeof before) == 0, "other bits after calls that were refused");
    order_of_calls(p);
    OK(feti_problem_destroy(&p));
    return check_result();
}
