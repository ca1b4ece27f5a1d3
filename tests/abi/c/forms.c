/* K by its profile and by triplets: the bits of K by rows, in answers and after new values; what is refused.

   A random K of N unknowns, positive definite and connected, with a profile of different heights that has zeros, meets a spring. */
#include "small.h"

enum { N = 60, MOST = N * N };

/* The lower triangle, row by row; 0 outside and inside of the profile. */
typedef struct {
    double k[N][N];
    int first[N];
} matrix;

static uint64_t state;

static double draw(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) / 9007199254740992.0;
}

/* Every fourth entry of a profile is 0. */
static matrix random_matrix(void)
{
    matrix m = { 0 };

    state = 7;
    for (int i = 0; i < N; i++) {
        m.first[i] = i == 0 ? 0 : i - 1 - (int)(draw() * (i < 12 ? i : 12));
        for (int j = m.first[i]; j < i; j++) m.k[i][j] = j > m.first[i] && draw() < 0.25 ? 0.0 : draw() - 0.5;
        m.k[i][i] = 20.0 + draw();
    }
    return m;
}

static matrix other_values(const matrix *of)
{
    matrix m = *of;

    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++) m.k[i][j] *= 1.0 + 0.25 * draw();
    return m;
}

enum { ROWS, DOWN, DOWN_APART, UP, UP_APART, FEAP, LOWER, UPPER, FULL, WAYS };
static const char *const NAMES[WAYS] = { "rows", "down", "down, diagonal apart", "COLSOL", "up, diagonal apart", "FEAP",
                                         "triplets, lower", "triplets, upper", "triplets, full" };

/* What a host passes, counted from `base`. */
typedef struct {
    int32_t base, entries, ptr[N + 1], row[4 * MOST], col[4 * MOST];
    double diag[N], val[4 * MOST];
} arrays;

static void add(arrays *a, int i, int j, double v)
{
    a->row[a->entries] = i + a->base, a->col[a->entries] = j + a->base, a->val[a->entries++] = v;
}

/* Two parts of every value, 2 v and -v, whose sum is exact, in any order. */
static void triplets_of(const matrix *m, int way, arrays *a)
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++) {
            if (m->k[i][j] == 0.0) continue;
            for (int part = 0; part < 2; part++) {
                const double v = part ? -m->k[i][j] : 2.0 * m->k[i][j];
                if (way != UPPER) add(a, i, j, v);
                if (way == UPPER || (way == FULL && i != j)) add(a, j, i, v);
            }
        }
    state = 11;
    for (int e = a->entries - 1; e > 0; e--) {
        const int other = (int)(draw() * (e + 1)), row = a->row[e], col = a->col[e];
        const double val = a->val[e];
        a->row[e] = a->row[other], a->col[e] = a->col[other], a->val[e] = a->val[other];
        a->row[other] = row, a->col[other] = col, a->val[other] = val;
    }
}

static void arrays_of(const matrix *m, int way, arrays *a)
{
    const int apart = way == DOWN_APART || way == UP_APART || way == FEAP, up = way == UP || way == UP_APART;

    a->base = way == UP || way == UPPER;
    a->entries = 0;
    if (way >= LOWER) {
        triplets_of(m, way, a);
        return;
    }
    a->ptr[0] = a->base;
    for (int i = 0; i < N; i++) {
        const int last = apart ? i - 1 : i;
        for (int at = m->first[i]; at <= last; at++) {
            const int j = up ? last + m->first[i] - at : at;
            if (way != ROWS || m->k[i][j] != 0.0) add(a, i, j, m->k[i][j]);
        }
        a->diag[i] = m->k[i][i];
        a->ptr[i + 1] = a->entries + a->base;
    }
}

static int32_t give(feti_problem *p, const matrix *m, int way, int wide)
{
    static arrays a;
    static int64_t ptr[N + 1], row[4 * MOST], col[4 * MOST];
    const int32_t direction = way == UP || way == UP_APART ? FETI_SKYLINE_UP : FETI_SKYLINE_DOWN;
    const int32_t storage = way == FULL ? FETI_FULL : way == UPPER ? FETI_UPPER : FETI_LOWER, flags = wide ? FETI_COPY : FETI_BORROW;
    const double *diag = way == DOWN_APART || way == UP_APART || way == FEAP ? a.diag : NULL;

    arrays_of(m, way, &a);
    for (int i = 0; i <= N; i++) ptr[i] = a.ptr[i];
    for (int32_t e = 0; e < a.entries; e++) row[e] = a.row[e], col[e] = a.col[e];
    if (way == ROWS) return feti_body_stiffness_i32(p, 0, N, a.ptr, a.col, a.val, a.base, FETI_LOWER, FETI_COPY);
    if (way < LOWER && wide) return feti_body_stiffness_skyline_i64(p, 0, N, diag, ptr, a.val, a.base, direction, flags);
    if (way < LOWER) return feti_body_stiffness_skyline_i32(p, 0, N, diag, a.ptr, a.val, a.base, direction, flags);
    if (wide) return feti_body_stiffness_triplets_i64(p, 0, N, a.entries, row, col, a.val, a.base, storage, flags);
    return feti_body_stiffness_triplets_i32(p, 0, N, a.entries, a.row, a.col, a.val, a.base, storage, flags);
}

static int32_t give_values(feti_problem *p, const matrix *m, int way)
{
    static arrays a;

    arrays_of(m, way, &a);
    if (way == DOWN_APART || way == UP_APART || way == FEAP) return feti_body_values_split(p, 0, N, a.diag, a.entries, a.val);
    return feti_body_values(p, 0, a.entries, a.val);
}

/* Unknown 7 is pushed against a spring, across a gap. */
static feti_problem *begin(void)
{
    const int32_t ptr[2] = { 0, 2 }, one[2] = { 0, 1 }, body[2] = { 0, 1 }, dof[2] = { 7, 0 };
    const double spring[1] = { 3.0 }, row[2] = { 1.0, -1.0 }, gap[1] = { 1e-3 };
    double f[N];
    feti_problem *p = NULL;
    int64_t number = -1;

    for (int i = 0; i < N; i++) f[i] = i == 7 ? 5.0 : 0.125;
    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, N, &number));
    MUST(feti_body_add(p, 1, &number));
    MUST(feti_body_stiffness_i32(p, 1, 1, one, one, spring, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_load(p, 0, N, f));
    MUST(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ptr, body, dof, row, 0, gap, NULL));
    return p;
}

typedef struct {
    double u[N + 1], force, certificate[8];
    int64_t analyses, factorisations;
} result;

static result solve(feti_problem *p)
{
    feti_info info = { .struct_size = sizeof info };
    result r;

    memset(&r, 0, sizeof r);
    OK(feti_solve(p, &info));
    OK(feti_displacement(p, FETI_ALL, N + 1, r.u));
    OK(feti_multipliers(p, FETI_INEQUALITY, 1, &r.force));
    memcpy(r.certificate, (double[]){ info.worst, info.equilibrium, info.balance, info.penetration, info.negative_force,
                                      info.complementarity, info.duality_gap, info.energy }, sizeof r.certificate);
    r.analyses = info.analyses;
    r.factorisations = info.factorisations;
    return r;
}

static void same_bits_and_new_values(void)
{
    const matrix first = random_matrix(), second = other_values(&first);
    result by_rows[2];

    for (int way = 0; way < WAYS; way++)
        for (int wide = 0; wide < 2; wide++) {
            feti_problem *p = begin();
            result r[2];

            MUST(give(p, &first, way, wide));
            r[0] = solve(p);
            OK(give_values(p, &second, way));
            r[1] = solve(p);
            CHECK(r[0].force > 0.5 && r[1].force > 0.5, "the spring is not touched");
            if (way == ROWS) memcpy(by_rows, r, sizeof r);
            for (int step = 0; step < 2; step++)
                CHECK(memcmp(&r[step], &by_rows[step], sizeof r[step]) == 0, "%s, step %d: other bits or counts than by rows", NAMES[way], step);
            CHECK(r[1].analyses == r[0].analyses, "%s: new values are analysed", NAMES[way]);
            OK(give_values(p, &second, way));
            CHECK(solve(p).factorisations == r[1].factorisations, "%s: equal values are factorised", NAMES[way]);
            OK(feti_problem_destroy(&p));
        }
}

static int lines;

static int32_t hear(void *user, int32_t level, const char *line)
{
    (void)user, (void)level;
    lines += strstr(line, "profile of K was 0") != NULL;
    return 0;
}

static void a_zero_that_becomes_an_entry(void)
{
    matrix first = random_matrix(), second = first;
    feti_problem *p = begin(), *anew = begin();
    result before, after, by_rows;
    int i = N - 1;

    while (first.first[i] > i - 3) i--;
    first.k[i][i - 1] = 0.0;
    second.k[i][i - 1] = 0.75;
    OK(feti_on_log(p, hear, FETI_LOG_PHASE, NULL));
    OK(give(p, &first, UP, 0));
    before = solve(p);
    OK(give_values(p, &second, UP));
    after = solve(p);
    CHECK(after.analyses == before.analyses + 1 && lines == 1, "%lld analyses, %d lines", (long long)after.analyses, lines);
    OK(give_values(p, &first, UP));
    after = solve(p);
    CHECK(after.analyses == before.analyses + 1 && lines == 1, "a value that becomes 0 costs an analysis");
    OK(give_values(p, &second, UP));
    after = solve(p);
    OK(give(anew, &second, ROWS, 0));
    by_rows = solve(anew);
    CHECK(memcmp(after.u, by_rows.u, sizeof after.u) == 0, "other bits than by rows");
    OK(feti_problem_destroy(&anew));
    OK(feti_problem_destroy(&p));
}

/* Refused profiles and triplets: the argument, the place, and nothing lost. */
static void wrong_arguments(void)
{
    const int32_t ptr[4] = { 1, 2, 4, 5 }, late[4] = { 0, 1, 3, 4 }, back[4] = { 1, 3, 2, 5 }, high[4] = { 1, 3, 4, 5 },
                  flat[4] = { 1, 2, 2, 3 };
    const int64_t huge[4] = { 1, 2, INT64_MAX, INT64_MAX };
    const int32_t row[3] = { 1, 2, 3 }, col[3] = { 1, 2, 4 }, below[3] = { 1, 0, 3 };
    const double val[4] = { 2.0, 2.0, -1.0, 2.0 }, diag[3] = { 2.0, 2.0, NAN }, bad[4] = { 2.0, 2.0, INFINITY, 2.0 };
    const double load[3] = { 2.0, 1.0, 2.0 }, by_hand[3] = { 5.0 / 3.0, 4.0 / 3.0, 1.0 };
    feti_problem *p = NULL;
    int64_t body = -1;
    double u[3];

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, 3, &body));
    MUST(feti_body_load(p, 0, 3, load));
    EXPECT(FETI_STATE, feti_body_values(p, 0, 4, val));
    MUST(feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, val, 1, FETI_SKYLINE_UP, FETI_COPY));
    EXPECT(FETI_ARGUMENT - 2, feti_body_stiffness_skyline_i32(p, 1, 3, NULL, ptr, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_body_stiffness_skyline_i32(p, 0, 3000000000, NULL, ptr, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_skyline_i32(p, 0, 3, diag, (int32_t[]){ 0, 0, 0, 0 }, val, 0, 1, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 4, 0, 2, ANY, 2, "feti_body_stiffness_skyline_i32", "finite" });
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, NULL, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, late, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, back, val, 1, 1, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 5, ANY, 1, ANY, ANY, "feti_body_stiffness_skyline_i32", "goes from 3 to 2" });
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, high, val, 1, 1, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 5, 0, 0, ANY, ANY, "feti_body_stiffness_skyline_i32", "of which only 1" });
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, flat, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_skyline_i64(p, 0, 3, NULL, huge, val, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, NULL, 1, 1, 0));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, bad, 1, 1, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 6, 0, 1, ANY, 2, "feti_body_stiffness_skyline_i32", "finite" });
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, val, 2, 1, 0));
    EXPECT(FETI_ARGUMENT - 8, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, val, 1, 2, 0));
    EXPECT(FETI_ARGUMENT - 9, feti_body_stiffness_skyline_i32(p, 0, 3, NULL, ptr, val, 1, 1, 2));
    EXPECT(FETI_ARGUMENT - 2, feti_body_stiffness_triplets_i32(p, 1, 3, 3, row, row, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 3, feti_body_stiffness_triplets_i32(p, 0, 2, 3, row, row, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_triplets_i32(p, 0, 3, -1, row, row, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 4, feti_body_stiffness_triplets_i32(p, 0, 3, INT64_MAX, row, row, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_triplets_i32(p, 0, 3, 3, NULL, row, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 5, feti_body_stiffness_triplets_i32(p, 0, 3, 3, below, row, val, 1, 0, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 5, 0, ANY, ANY, 1, "feti_body_stiffness_triplets_i32", "row 0 is outside" });
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, NULL, val, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, col, val, 1, 0, 0));
    check_last_error(p, &(expectation){ FETI_ARGUMENT - 6, 0, ANY, ANY, 2, "feti_body_stiffness_triplets_i32", "column 4 is outside" });
    EXPECT(FETI_ARGUMENT - 6, feti_body_stiffness_triplets_i32(p, 0, 3, 2, row, row + 1, val, 1, FETI_LOWER, 0));
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, row, NULL, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, row, bad, 1, 0, 0));
    EXPECT(FETI_ARGUMENT - 7, feti_body_stiffness_triplets_i32(p, 0, 3, 2, row, row + 1, val, 1, FETI_FULL, 0));
    EXPECT(FETI_ARGUMENT - 8, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, row, val, 2, 0, 0));
    EXPECT(FETI_ARGUMENT - 9, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, row, val, 1, 3, 0));
    EXPECT(FETI_ARGUMENT - 10, feti_body_stiffness_triplets_i32(p, 0, 3, 3, row, row, val, 1, 0, 2));
    EXPECT(FETI_ARGUMENT - 3, feti_body_values(p, 0, 3, val));
    EXPECT(FETI_ARGUMENT - 4, feti_body_values(p, 0, 4, bad));
    EXPECT(FETI_STATE, feti_body_values_split(p, 0, 3, val, 1, val));
    check_last_error(p, &(expectation){ FETI_STATE, 0, ANY, ANY, ANY, "feti_body_values_split", "by its profile: give new values by feti_body_values" });
    OK(feti_solve(p, NULL));
    OK(feti_displacement(p, 0, 3, u));
    CHECK(check_distance(3, u, by_hand) <= 1e-14, "u = %g %g %g", u[0], u[1], u[2]);
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    same_bits_and_new_values();
    a_zero_that_becomes_an_entry();
    wrong_arguments();
    return check_result();
}
