/* Bodies by their elements, whole and cut, against the same bodies by rows: forms of input, passes, held unknowns, and input
   that is refused with its element and loses nothing.

   POST (body 0): a chain of 8 springs on the ground, k_e = 100 + 10 e; unknown i is the upper end of spring i, the ground is
   the held unknown 0. Element 8 is a spring of 5 between unknown 3 and the ground, with one unknown.
   BAR (body 1): a chain of 6 such springs, floating, pushed by 10 at its far end.
   Row 0: u_post[7] - u_bar[0] <= 0.1, so that lambda = 10. */
#include "check.h"

enum { POST = 0, BAR = 1, POST_N = 8, BAR_N = 7, POST_E = 9, BAR_E = 6, ALL_N = POST_N + BAR_N, MOST = 9, PIECES = 3 };

/* How a chain is handed over. */
typedef enum { ONE_BY_ONE, FULL, LOWER, UPPER, FORMS } form;

typedef struct {
    double u[ALL_N], lambda, wall;
    int64_t pieces[2], analyses;
} answer;

static double stiffness(int e)
{
    return 100.0 + 10.0 * e;
}

/* Connectivity of a body, from `base`: 2 unknowns for every spring, 1 for the last element of the post. */
static int connectivity(int body, int base, int64_t ptr[MOST + 1], int64_t dof[2 * MOST])
{
    const int springs = body == POST ? POST_E - 1 : BAR_E, below = body == POST ? 1 : 0;

    for (int e = 0; e < springs; e++) {
        ptr[e] = 2 * e + base;
        dof[2 * e] = e - below + base;
        dof[2 * e + 1] = e - below + 1 + base;
    }
    ptr[springs] = 2 * springs + base;
    if (body == BAR) return springs;
    dof[2 * springs] = 3 + base;
    ptr[springs + 1] = 2 * springs + 1 + base;
    return springs + 1;
}

static int size_of(int body, int e)
{
    return body == POST && e == POST_E - 1 ? 1 : 2;
}

static double entry(int body, int e, int i, int j, double factor)
{
    if (size_of(body, e) == 1) return 5.0 * factor;
    return (i == j ? 1.0 : -1.0) * stiffness(e) * factor;
}

/* The matrices of elements `from` to `to` - 1 one after the other; how many numbers. */
static int64_t packed(int body, int from, int to, form how, double factor, double *ke)
{
    int64_t at = 0;

    for (int e = from; e < to; e++)
        for (int j = 0; j < size_of(body, e); j++)
            for (int i = 0; i < size_of(body, e); i++)
                if (how == FULL || (how == LOWER && i >= j) || (how == UPPER && i <= j)) ke[at++] = entry(body, e, i, j, factor);
    return at;
}

static int32_t give_one(feti_problem *p, int body, int e, double factor)
{
    double ke[2 * 3] = { NAN, NAN, NAN, NAN, NAN, NAN };
    const int n = size_of(body, e);

    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) ke[i + 3 * j] = entry(body, e, i, j, factor);
    return feti_body_element(p, body, e, n, ke, 3);
}

/* A pass over all elements; one by one from the last to the first, in blocks of four otherwise. */
static void give_elements(feti_problem *p, int body, int elements, form how, double factor)
{
    static const int32_t storage[FORMS] = { FETI_FULL, FETI_FULL, FETI_LOWER, FETI_UPPER };
    double ke[4 * MOST];

    if (how == ONE_BY_ONE)
        for (int e = elements - 1; e >= 0; e--) MUST(give_one(p, body, e, factor));
    else
        for (int from = 0; from < elements; from += 4) {
            const int to = from + 4 < elements ? from + 4 : elements;
            const int64_t numbers = packed(body, from, to, how, factor, ke);
            int64_t told = -1;
            MUST(feti_body_elements_size(p, body, from, to - from, storage[how], &told));
            CHECK(told == numbers, "elements %d to %d have %lld numbers, told %lld", from, to, (long long)numbers, (long long)told);
            MUST(feti_body_elements(p, body, from, to - from, ke, storage[how]));
        }
}

static void give_mesh(feti_problem *p, int body, int base, int wide)
{
    int64_t ptr[MOST + 1], dof[2 * MOST];
    int32_t short_ptr[MOST + 1], short_dof[2 * MOST];
    const int elements = connectivity(body, base, ptr, dof);

    for (int e = 0; e <= elements; e++) short_ptr[e] = (int32_t)ptr[e];
    for (int k = 0; k < ptr[elements] - base; k++) short_dof[k] = (int32_t)dof[k];
    if (wide) MUST(feti_body_mesh_i64(p, body, elements, ptr, dof, base));
    else MUST(feti_body_mesh_i32(p, body, elements, short_ptr, short_dof, base));
}

static void give_coordinates(feti_problem *p, int body, int n)
{
    int32_t node[MOST], dir[MOST];
    double x[MOST];

    for (int i = 0; i < n; i++) node[i] = i, dir[i] = 1, x[i] = body == POST ? i + 1.0 : i + 9.0;
    MUST(feti_body_coordinates(p, body, 1, n, node, dir, x, 1));
}

/* Bodies, load, row; no matrix yet. */
static feti_problem *begun(int64_t pieces, int coordinates)
{
    static const int32_t ptr[2] = { 0, 2 }, body[2] = { POST, BAR }, dof[2] = { POST_N - 1, 0 };
    static const double val[2] = { 1.0, -1.0 }, gap[1] = { 0.1 };
    double load[BAR_N] = { 0.0 };
    int64_t number;
    feti_problem *p = NULL;

    load[BAR_N - 1] = -10.0;
    MUST(feti_problem_create(&p));
    MUST(feti_set_i64(p, "pieces", pieces));
    MUST(feti_body_add(p, POST_N, &number));
    MUST(feti_body_add(p, BAR_N, &number));
    if (coordinates) {
        give_coordinates(p, POST, POST_N);
        give_coordinates(p, BAR, BAR_N);
    }
    MUST(feti_body_load(p, BAR, BAR_N, load));
    MUST(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ptr, body, dof, val, 0, gap, NULL));
    return p;
}

static feti_problem *by_elements(int64_t pieces, int coordinates, form how, int base, int wide)
{
    feti_problem *p = begun(pieces, coordinates);

    for (int body = POST; body <= BAR; body++) {
        give_mesh(p, body, base, wide);
        give_elements(p, body, body == POST ? POST_E : BAR_E, how, 1.0);
    }
    return p;
}

/* The same by rows of dense matrices. */
static feti_problem *by_matrix(void)
{
    feti_problem *p = begun(0, 1);

    for (int body = POST; body <= BAR; body++) {
        const int n = body == POST ? POST_N : BAR_N;
        double k[MOST * MOST] = { 0.0 };
        int64_t ptr[MOST + 1], dof[2 * MOST];
        const int elements = connectivity(body, 0, ptr, dof);
        for (int e = 0; e < elements; e++)
            for (int i = 0; i < size_of(body, e); i++)
                for (int j = 0; j < size_of(body, e); j++)
                    if (dof[ptr[e] + i] >= 0 && dof[ptr[e] + j] >= 0) k[dof[ptr[e] + i] + n * dof[ptr[e] + j]] += entry(body, e, i, j, 1.0);
        MUST(feti_body_stiffness_dense(p, body, n, k, n, FETI_FULL, FETI_COPY));
    }
    return p;
}

static answer solved(feti_problem *p, int meshed)
{
    feti_info info = { .struct_size = sizeof info };
    answer found = { .wall = NAN };

    OK(feti_solve(p, &info));
    OK(feti_displacement(p, POST, POST_N, found.u));
    OK(feti_displacement(p, BAR, BAR_N, found.u + POST_N));
    OK(feti_multipliers(p, FETI_INEQUALITY, 1, &found.lambda));
    for (int body = POST; body <= BAR; body++) {
        feti_body_facts facts = { .struct_size = sizeof facts };
        OK(feti_body_info(p, body, &facts));
        found.pieces[body] = facts.pieces;
    }
    found.analyses = info.analyses;
    if (meshed) OK(feti_body_held_forces(p, POST, 1, &found.wall));
    return found;
}

static void check_same(const answer *found, const answer *wanted, double factor, const char *what)
{
    double u[ALL_N];

    /* bodies `factor` times as stiff; the bar moves by the gap as before */
    for (int i = 0; i < ALL_N; i++) u[i] = i < POST_N ? wanted->u[i] / factor : (wanted->u[i] + 0.1) / factor - 0.1;
    CHECK(check_distance(ALL_N, found->u, u) <= 1e-9, "%s: u is off by %g", what, check_distance(ALL_N, found->u, u));
    CHECK(fabs(found->lambda - 10.0) <= 1e-8, "%s: lambda = %.12g", what, found->lambda);
    /* the ground holds the post by the force of its first spring */
    CHECK(fabs(found->wall + stiffness(0) * wanted->u[0]) <= 1e-8, "%s: held by %.12g", what, found->wall);
}

static void every_form(const answer *wanted)
{
    for (int64_t pieces = 1; pieces <= PIECES; pieces += PIECES - 1)
        for (int coordinates = 0; coordinates <= 1; coordinates++)
            for (int how = 0; how < FORMS; how++)
                for (int base = 0; base <= 1; base++) {
                    char what[64];
                    feti_problem *p = by_elements(pieces, coordinates, (form)how, base, base != how % 2);
                    const answer found = solved(p, 1);
                    snprintf(what, sizeof what, "pieces %d coordinates %d form %d base %d", (int)pieces, coordinates, how, base);
                    check_same(&found, wanted, 1.0, what);
                    CHECK(found.pieces[POST] == pieces && found.pieces[BAR] == pieces, "%s: %lld and %lld pieces", what,
                          (long long)found.pieces[POST], (long long)found.pieces[BAR]);
                    OK(feti_problem_destroy(&p));
                }
}

/* Springs in a line: the pieces of unknowns ascend, and each has some. */
static void pieces_of_unknowns(void)
{
    int64_t piece[POST_N], seen = 0;
    feti_problem *p = begun(PIECES, 1);

    EXPECT(FETI_STATE, feti_body_pieces(p, POST, POST_N, piece));
    OK(feti_problem_destroy(&p));
    p = by_elements(PIECES, 1, LOWER, 0, 0);
    OK(feti_body_pieces(p, POST, POST_N, piece));
    for (int i = 0; i < POST_N; i++) {
        CHECK(piece[i] >= 0 && piece[i] < PIECES, "unknown %d is in piece %lld", i, (long long)piece[i]);
        seen |= 1 << piece[i];
    }
    CHECK(seen == (1 << PIECES) - 1, "pieces without an unknown: %lld", (long long)seen);
    EXPECT(FETI_ARGUMENT - 2, feti_body_pieces(p, 2, POST_N, piece));
    EXPECT(FETI_ARGUMENT - 3, feti_body_pieces(p, POST, BAR_N, piece));
    EXPECT(FETI_ARGUMENT - 4, feti_body_pieces(p, POST, POST_N, NULL));
    OK(feti_problem_destroy(&p));
    p = by_matrix();
    OK(feti_body_pieces(p, POST, POST_N, piece));
    for (int i = 0; i < POST_N; i++) CHECK(piece[i] == 0, "unknown %d of a body by rows is in piece %lld", i, (long long)piece[i]);
    OK(feti_problem_destroy(&p));
}

/* New values on the old pattern and cut: without an analysis, begun by an element or by the same connectivity. */
static void passes(const answer *wanted)
{
    feti_problem *p = by_elements(PIECES, 1, FULL, 0, 0);
    answer found = solved(p, 1);
    const int64_t analyses = found.analyses;

    for (int body = POST; body <= BAR; body++) give_elements(p, body, body == POST ? POST_E : BAR_E, ONE_BY_ONE, 4.0);
    found = solved(p, 1);
    check_same(&found, wanted, 4.0, "a second pass");
    CHECK(found.analyses == analyses, "%lld analyses after %lld", (long long)found.analyses, (long long)analyses);
    for (int body = POST; body <= BAR; body++) {
        give_mesh(p, body, 0, 1);
        give_elements(p, body, body == POST ? POST_E : BAR_E, UPPER, 2.0);
    }
    found = solved(p, 1);
    check_same(&found, wanted, 2.0, "a third pass, begun by the same connectivity");
    CHECK(found.analyses == analyses, "%lld analyses after %lld", (long long)found.analyses, (long long)analyses);
    /* a pass that is given up */
    OK(give_one(p, BAR, 4, 7.0));
    EXPECT(FETI_STATE, feti_solve(p, NULL));
    give_mesh(p, BAR, 0, 0);
    give_elements(p, BAR, BAR_E, LOWER, 2.0);
    const answer again = solved(p, 1);
    CHECK(memcmp(again.u, found.u, sizeof found.u) == 0, "the same elements give other bits");
    OK(feti_problem_destroy(&p));
}

/* The last error names this element, or none (-1), and has the word. */
static void check_named(int64_t element, const char *word)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[512] = "";

    feti_last_error(text, sizeof text);
    OK(feti_last_error_detail(&detail));
    CHECK(detail.element == element, "element %lld named, expected %lld: %s", (long long)detail.element, (long long)element, text);
    CHECK(strstr(text, word) != NULL, "the text does not say '%s': %s", word, text);
}

/* What has no meaning for a body that is cut, and for one that was not given by its elements. */
static void not_of_a_cut_body(void)
{
    double x[ALL_N] = { 0.0 }, y[ALL_N];
    int64_t dof[1];
    feti_problem *p = by_elements(PIECES, 1, FULL, 0, 0);

    EXPECT(FETI_STATE, feti_body_kplus(p, BAR, BAR_N, 1, x, BAR_N, y, BAR_N));
    check_named(-1, "cut into pieces and has no K+ of its own: option pieces = 1, set before its elements, leaves it whole");
    EXPECT(FETI_STATE, feti_body_fixing(p, BAR, 1, dof));
    EXPECT(FETI_STATE, feti_dual_apply(p, 1, x, y));
    EXPECT(FETI_STATE, feti_dual_rhs(p, 1, y));
    EXPECT(FETI_STATE, feti_body_held_forces(p, POST, 1, y));
    (void)solved(p, 1);
    y[1] = 7.0;
    OK(feti_body_held_forces(p, POST, 1, y));
    CHECK(y[0] > 0.0 && y[1] == 7.0, "of one force %g %g were written", y[0], y[1]);
    OK(feti_body_held_forces(p, POST, 3, y));
    CHECK(y[0] > 0.0 && y[1] == 0.0 && y[2] == 0.0, "held forces %g %g %g", y[0], y[1], y[2]);
    OK(feti_body_held_forces(p, BAR, 0, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_body_held_forces(p, POST, -1, y));
    EXPECT(FETI_ARGUMENT - 4, feti_body_held_forces(p, POST, 1, NULL));
    y[POST_N] = 7.0;
    EXPECT(FETI_ARGUMENT - 3, feti_body_held_forces(p, POST, POST_N + 1, y));
    CHECK(y[POST_N] == 7.0, "a number beyond the array was written");
    OK(feti_problem_destroy(&p));
    p = by_matrix();
    (void)solved(p, 0);
    EXPECT(FETI_STATE, feti_body_held_forces(p, POST, 1, y));
    OK(feti_problem_destroy(&p));
}

static void refused_connectivity(feti_problem *p)
{
    static const int32_t ptr[3] = { 0, 2, 4 }, from_one[3] = { 1, 3, 5 }, back[3] = { 0, 2, 1 };
    static const int32_t dof[4] = { 0, 1, 1, 2 }, far[4] = { 0, 1, 1, POST_N };

    EXPECT(FETI_ARGUMENT - 5, feti_body_mesh_i32(p, POST, 2, ptr, far, 0));
    check_named(1, "outside the 8 unknowns");
    EXPECT(FETI_ARGUMENT - 4, feti_body_mesh_i32(p, POST, 2, from_one, dof, 0));
    check_named(0, "starts with 1");
    EXPECT(FETI_ARGUMENT - 4, feti_body_mesh_i32(p, POST, 2, ptr, dof, 1));
    EXPECT(FETI_ARGUMENT - 4, feti_body_mesh_i32(p, POST, 2, back, dof, 0));
    check_named(1, "goes from 2 to 1");
    EXPECT(FETI_ARGUMENT - 6, feti_body_mesh_i32(p, POST, 2, ptr, dof, 2));
    EXPECT(FETI_ARGUMENT - 3, feti_body_mesh_i32(p, POST, 0, ptr, dof, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_body_mesh_i32(p, POST, -1, ptr, dof, 0));
    EXPECT(FETI_ARGUMENT - 2, feti_body_mesh_i32(p, 2, 2, ptr, dof, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_mesh_i32(p, POST, 2, NULL, dof, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_mesh_i32(p, POST, 2, ptr, NULL, 0));
    EXPECT(FETI_HANDLE, feti_body_mesh_i64(NULL, POST, 0, NULL, NULL, 0));
}

/* Refused in the middle of a pass in which element 2 has come and element 1 has not. */
static void refused_elements(feti_problem *p)
{
    const double good[4] = { 110.0, -110.0, -110.0, 110.0 }, skew[4] = { 110.0, -110.0, -100.0, 110.0 };
    const double nan[4] = { 110.0, NAN, -110.0, 110.0 }, two[6] = { 110.0, -110.0, 110.0, 120.0, -120.0, 120.0 };
    int64_t numbers = -7;

    EXPECT(FETI_STATE, feti_body_element(p, POST, 2, 2, good, 2));
    check_named(2, "already");
    EXPECT(FETI_STATE, feti_body_elements(p, POST, 1, 2, two, FETI_LOWER));
    check_named(2, "already");
    EXPECT(FETI_ARGUMENT - 5, feti_body_element(p, POST, 1, 2, skew, 2));
    check_named(1, "not symmetric");
    EXPECT(FETI_ARGUMENT - 5, feti_body_element(p, POST, 1, 2, nan, 2));
    check_named(1, "finite");
    EXPECT(FETI_ARGUMENT - 4, feti_body_element(p, POST, 1, 1, good, 2));
    check_named(1, "is 1");
    EXPECT(FETI_ARGUMENT - 4, feti_body_element(p, POST, 1, INT64_MAX, good, 2));
    EXPECT(FETI_ARGUMENT - 6, feti_body_element(p, POST, 1, 2, good, 1));
    EXPECT(FETI_ARGUMENT - 3, feti_body_element(p, POST, POST_E, 2, good, 2));
    check_named(-1, "9 elements");
    EXPECT(FETI_ARGUMENT - 3, feti_body_element(p, POST, -1, 2, good, 2));
    EXPECT(FETI_ARGUMENT - 2, feti_body_element(p, 2, 1, 2, good, 2));
    EXPECT(FETI_ARGUMENT - 5, feti_body_element(p, POST, 1, 2, NULL, 2));
    EXPECT(FETI_ARGUMENT - 3, feti_body_elements(p, POST, POST_E, 1, good, FETI_FULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_elements(p, POST, 7, 3, good, FETI_FULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_elements(p, POST, 7, -1, good, FETI_FULL));
    EXPECT(FETI_ARGUMENT - 5, feti_body_elements(p, POST, 1, 1, NULL, FETI_FULL));
    EXPECT(FETI_ARGUMENT - 6, feti_body_elements(p, POST, 1, 1, good, 7));
    EXPECT(FETI_ARGUMENT - 5, feti_body_elements_size(p, POST, 1, 1, 7, &numbers));
    EXPECT(FETI_ARGUMENT - 6, feti_body_elements_size(p, POST, 1, 1, FETI_FULL, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_body_elements_size(p, POST, 1, POST_E, FETI_FULL, &numbers));
    CHECK(numbers == -7, "a refused call has written %lld", (long long)numbers);
    EXPECT(FETI_STATE, feti_setup(p));
    check_named(1, "has not been given");
    EXPECT(FETI_STATE, feti_solve(p, NULL));
    check_named(1, "has not been given");
    OK(feti_body_elements(p, POST, 4, 0, NULL, FETI_FULL));
}

static void refused_input_loses_nothing(void)
{
    const double good[4] = { 110.0, -110.0, -110.0, 110.0 };
    const double block[3][3] = { { 100.0, -100.0, 100.0 }, { 110.0, -110.0, 110.0 }, { 120.0, -120.0, INFINITY } };
    int64_t numbers = -7;
    feti_problem *p = by_elements(PIECES, 1, ONE_BY_ONE, 0, 0), *q = begun(PIECES, 1);
    const answer wanted = solved(p, 1);
    answer found;

    EXPECT(FETI_STATE, feti_body_element(q, POST, 1, 2, good, 2));
    check_named(-1, "feti_body_mesh");
    EXPECT(FETI_STATE, feti_body_elements(q, POST, 1, 1, good, FETI_FULL));
    EXPECT(FETI_STATE, feti_body_elements_size(q, POST, 1, 1, FETI_FULL, &numbers));
    EXPECT(FETI_STATE, feti_solve(q, NULL));
    refused_connectivity(q);
    give_mesh(q, POST, 0, 0);
    refused_connectivity(q);
    EXPECT(FETI_STATE, feti_setup(q));
    check_named(0, "has not been given");
    for (int e = POST_E - 1; e > 1; e--) OK(give_one(q, POST, e, 1.0));
    OK(give_one(q, POST, 0, 1.0));
    refused_connectivity(q);
    refused_elements(q);
    OK(give_one(q, POST, 1, 1.0));
    give_mesh(q, BAR, 0, 0);
    give_elements(q, BAR, BAR_E, ONE_BY_ONE, 1.0);
    found = solved(q, 1);
    CHECK(check_distance(ALL_N, found.u, wanted.u) <= 1e-12, "after refused input u is off by %g", check_distance(ALL_N, found.u, wanted.u));
    /* refused at the beginning of a pass, the matrix of the last one stays */
    EXPECT(FETI_ARGUMENT - 4, feti_body_element(q, POST, 1, 1, good, 2));
    EXPECT(FETI_ARGUMENT - 5, feti_body_elements(q, POST, 5, 3, block[0], FETI_UPPER));
    check_named(7, "finite");
    refused_connectivity(q);
    const answer again = solved(q, 1);
    CHECK(memcmp(again.u, found.u, sizeof found.u) == 0, "after refused input other bits");
    OK(feti_problem_destroy(&p));
    OK(feti_problem_destroy(&q));
}

/* A matrix in place of elements, and elements in place of a matrix. */
static void one_in_place_of_the_other(void)
{
    const double k[4] = { 4.0, -4.0, -4.0, 4.0 };
    static const int32_t ptr[2] = { 0, 2 }, dof[2] = { 0, 1 };
    feti_body_facts facts = { .struct_size = sizeof facts };
    int64_t body;
    feti_problem *p = NULL;

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, 2, &body));
    OK(feti_body_stiffness_dense(p, body, 2, k, 2, FETI_FULL, FETI_COPY));
    OK(feti_body_mesh_i32(p, body, 1, ptr, dof, 0));
    EXPECT(FETI_STATE, feti_body_values_dense(p, body, 2, k, 2));
    OK(feti_body_element(p, body, 0, 2, k, 2));
    OK(feti_body_info(p, body, &facts));
    CHECK(facts.entries == 4 && facts.components == 1 && facts.pieces == 1, "%lld entries of elements", (long long)facts.entries);
    OK(feti_body_stiffness_dense(p, body, 2, k, 2, FETI_FULL, FETI_COPY));
    EXPECT(FETI_STATE, feti_body_element(p, body, 0, 2, k, 2));
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    feti_problem *p = by_matrix();
    const answer wanted = solved(p, 0);

    OK(feti_problem_destroy(&p));
    every_form(&wanted);
    pieces_of_unknowns();
    passes(&wanted);
    not_of_a_cut_body();
    refused_input_loses_nothing();
    one_in_place_of_the_other();
    return check_result();
}
