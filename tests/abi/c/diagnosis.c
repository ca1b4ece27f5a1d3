/* Why there is no solution, and what an answer leaves open: bodies, motions, rows and weights known by hand. */
#include "small.h"

enum { MOST = 8 };

static feti_findings findings_of(feti_problem *problem, int32_t status)
{
    feti_findings found = { .struct_size = sizeof found };

    OK(feti_diagnosis(problem, &found));
    CHECK(found.status == status, "status %d, expected %d", (int)found.status, (int)status);
    return found;
}

/* Rows of a kind with their weights. */
static void check_rows(feti_problem *problem, int32_t kind, int64_t count, const int64_t *row, const double *weight)
{
    int64_t found = -1, rows[MOST] = { 0 };
    double weights[MOST] = { 0 };

    OK(feti_diagnosis_rows(problem, kind, 0, &found, NULL, NULL));
    CHECK(found == count, "%lld rows of kind %d, expected %lld", (long long)found, (int)kind, (long long)count);
    OK(feti_diagnosis_rows(problem, kind, MOST, &found, rows, weights));
    for (int64_t k = 0; k < count; k++)
        CHECK(rows[k] == row[k] && fabs(weights[k] - weight[k]) < 1e-9, "entry %lld: row %lld, weight %.17g",
              (long long)k, (long long)rows[k], weights[k]);
}

/* The load pulls the block away from the spring. */
static void the_body_that_escapes(void)
{
    feti_problem *problem = small_problem();
    const int32_t node[2] = { 1, 2 }, dir[2] = { 1, 1 };
    const double x[2] = { 5.0, 6.0 };
    double v[2] = { 0 };

    EXPECT(FETI_STATE, feti_diagnosis(problem, &(feti_findings){ .struct_size = sizeof(feti_findings) }));
    OK(feti_body_load(problem, BLOCK, 2, (double[2]){ 0.0, 6.0 }));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, NULL));
    feti_findings found = findings_of(problem, FETI_LOAD_NOT_HELD);
    CHECK(found.body == BLOCK && found.component == -1 && (found.dof == 0 || found.dof == 1), "body %lld, dof %lld",
          (long long)found.body, (long long)found.dof);
    CHECK(fabs(found.margin - 1.0) < 1e-12 && isnan(found.motion[0]), "margin %g", found.margin);
    CHECK(found.row == -1 && found.kind == 0 && found.rows_involved == 0, "rows where there are none");
    OK(feti_diagnosis_motion(problem, BLOCK, 2, v));
    CHECK(fabs(v[0] - 1.0) < 1e-12 && fabs(v[1] - 1.0) < 1e-12, "motion %g %g", v[0], v[1]);
    OK(feti_diagnosis_motion(problem, SPRING, 1, v));
    CHECK(v[0] == 0.0, "the spring moves");
    EXPECT(FETI_ARGUMENT - 3, feti_diagnosis_motion(problem, BLOCK, 1, v));

    OK(feti_body_coordinates(problem, BLOCK, 1, 2, node, dir, x, 1));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, NULL));
    found = findings_of(problem, FETI_LOAD_NOT_HELD);
    CHECK(fabs(found.motion[0] - 1.0) < 1e-9, "velocity %g", found.motion[0]);
    for (int k = 1; k < 6; k++) CHECK(fabs(found.motion[k]) < 1e-9, "motion %d is %g", k, found.motion[k]);

    OK(give_block_load(problem));
    check_small_answer(problem, "a load that is not held");
    found = findings_of(problem, FETI_OK);
    CHECK(found.body == -1 && isnan(found.margin) && isnan(found.motion[0]), "the old findings are still there");
    EXPECT(FETI_STATE, feti_diagnosis_motion(problem, BLOCK, 2, v));
    OK(feti_problem_destroy(&problem));
}

/* One body of two pairs of unknowns that nothing joins; a row holds the first pair against the load, none the second. */
static void the_part_that_escapes(void)
{
    const int32_t ptr[5] = { 0, 1, 3, 4, 6 }, col[6] = { 0, 0, 1, 2, 2, 3 };
    const double val[6] = { 1.0, -1.0, 1.0, 1.0, -1.0, 1.0 }, modes[8] = { 1, 1, 0, 0, 0, 0, 1, 1 };
    const int32_t row_ptr[2] = { 0, 1 }, row_dof[1] = { 0 };
    double v[4];
    feti_problem *problem = NULL;
    int64_t body;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 4, &body));
    MUST(feti_body_stiffness_i32(problem, body, 4, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, body, 2, 4, modes, 4, FETI_EXACT));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, row_ptr, NULL, row_dof, (double[1]){ 1.0 }, 0, (double[1]){ 0.5 }, NULL));
    OK(feti_body_load(problem, body, 4, (double[4]){ 0.0, 2.0, -1.0, 0.0 }));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(problem, NULL));
    feti_findings found = findings_of(problem, FETI_LOAD_NOT_HELD);
    CHECK(found.body == 0 && found.component == 1 && found.dof >= 2, "part %lld, dof %lld", (long long)found.component,
          (long long)found.dof);
    OK(feti_diagnosis_motion(problem, 0, 4, v));
    CHECK(check_distance(4, v, (double[4]){ 0.0, 0.0, -1.0, -1.0 }) < 1e-12, "motion %g %g %g %g", v[0], v[1], v[2], v[3]);
    OK(feti_problem_destroy(&problem));
}

/* A spring of one unknown at the wall with rows b u <= c and h u = g. */
static feti_problem *spring_with(int64_t rows, const double *b, const double *c, int64_t eqs, const double *h, const double *g)
{
    const int32_t ptr[MOST] = { 0, 1, 2, 3, 4, 5, 6, 7 }, zero[MOST] = { 0 };
    feti_problem *problem = NULL;
    int64_t body;

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 1, &body));
    MUST(feti_body_stiffness_i32(problem, body, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, body, 0, 1, NULL, 1, FETI_EXACT));
    MUST(feti_rows_add_i32(problem, FETI_INEQUALITY, rows, ptr, NULL, zero, b, 0, c, NULL));
    MUST(feti_rows_add_i32(problem, FETI_EQUALITY, eqs, ptr, NULL, zero, h, 0, g, NULL));
    return problem;
}

static void check_contradiction(feti_problem *problem, int32_t kind, int64_t row, int64_t involved, double margin)
{
    feti_info info = { .struct_size = sizeof info };

    EXPECT(FETI_GAPS_CONTRADICT, feti_solve(problem, &info));
    CHECK(info.dual_applications == 0, "%lld products", (long long)info.dual_applications);
    const feti_findings found = findings_of(problem, FETI_GAPS_CONTRADICT);
    CHECK(found.kind == kind && found.row == row, "row %lld of kind %d", (long long)found.row, (int)found.kind);
    CHECK(found.rows_involved == involved, "%lld rows", (long long)found.rows_involved);
    CHECK(fabs(found.margin - margin) < 1e-6, "margin %.9g, expected %g", found.margin, margin);
}

static void rows_that_contradict_each_other(void)
{
    const double none[1] = { 0.0 };

    /* u <= 5; 2 u <= -2 and -4 u <= -4: half the second and a quarter of the third are 0 <= -2. */
    feti_problem *problem = spring_with(3, (double[3]){ 1.0, 2.0, -4.0 }, (double[3]){ 5.0, -2.0, -4.0 }, 0, none, none);
    check_contradiction(problem, FETI_INEQUALITY, 1, 2, 1.0);
    check_rows(problem, FETI_INEQUALITY, 2, (int64_t[2]){ 1, 2 }, (double[2]){ 1.0, 0.5 });
    check_rows(problem, FETI_EQUALITY, 0, NULL, NULL);
    OK(feti_rows_rhs(problem, FETI_INEQUALITY, 1, 1, (double[1]){ 3.0 }));
    OK(feti_solve(problem, NULL));
    OK(feti_problem_destroy(&problem));

    /* u <= 1 and 2 u = 6: the first minus half the second is 0 <= -2. */
    problem = spring_with(1, (double[1]){ 1.0 }, (double[1]){ 1.0 }, 1, (double[1]){ 2.0 }, (double[1]){ 6.0 });
    check_contradiction(problem, FETI_INEQUALITY, 0, 2, 0.5);
    check_rows(problem, FETI_INEQUALITY, 1, (int64_t[1]){ 0 }, (double[1]){ 1.0 });
    check_rows(problem, FETI_EQUALITY, 1, (int64_t[1]){ 0 }, (double[1]){ -0.5 });
    OK(feti_problem_destroy(&problem));

    /* u = 1 and -u = 2: their sum is 0 = 3, with the sign that makes it negative. */
    problem = spring_with(0, none, none, 2, (double[2]){ 1.0, -1.0 }, (double[2]){ 1.0, 2.0 });
    check_contradiction(problem, FETI_EQUALITY, 1, 2, 1.0);
    check_rows(problem, FETI_EQUALITY, 2, (int64_t[2]){ 0, 1 }, (double[2]){ -1.0, -1.0 });
    OK(feti_problem_destroy(&problem));

    /* 0 u <= -3 */
    problem = spring_with(1, none, (double[1]){ -3.0 }, 0, none, none);
    check_contradiction(problem, FETI_INEQUALITY, 0, 1, 1.0);
    check_rows(problem, FETI_INEQUALITY, 1, (int64_t[1]){ 0 }, (double[1]){ 1.0 });
    OK(feti_problem_destroy(&problem));
}

/* A row that repeats another one, a body that no row touches, and its motion that nothing determines. */
static void what_an_answer_leaves_open(void)
{
    feti_problem *problem = small_problem();
    const int32_t ptr[2] = { 0, 2 }, body[2] = { SPRING, BLOCK }, dof[2] = { 0, 0 };
    const double val[2] = { 3.0, -3.0 };
    int64_t third;

    OK(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ptr, body, dof, val, 0, (double[1]){ 60.0 }, NULL));
    EXPECT(FETI_STATE, feti_diagnosis_rows(problem, FETI_INEQUALITY, 0, &third, NULL, NULL));
    OK(feti_body_add(problem, 2, &third));
    OK(feti_body_stiffness_i32(problem, third, 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_null_space(problem, third, 1, 2, BLOCK_MODE, 2, FETI_EXACT));
    OK(feti_solve(problem, NULL));
    const feti_findings found = findings_of(problem, FETI_OK);
    CHECK(found.redundant_rows == 1 && found.rows_involved == 0, "%lld redundant rows", (long long)found.redundant_rows);
    CHECK(found.untouched_bodies == 1 && found.untouched_body == third, "untouched body %lld", (long long)found.untouched_body);
    CHECK(found.undetermined == 1, "%lld motions undetermined", (long long)found.undetermined);
    check_rows(problem, FETI_INEQUALITY, 1, (int64_t[1]){ 1 }, (double[1]){ 3.0 });
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis_rows(problem, 0, 0, &third, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 3, feti_diagnosis_rows(problem, FETI_EQUALITY, -1, &third, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 4, feti_diagnosis_rows(problem, FETI_EQUALITY, 0, NULL, NULL, NULL));
    OK(feti_problem_destroy(&problem));
}

static void check_list(const char *what, int64_t count, const int64_t *found, int64_t expected, const int64_t *wanted)
{
    CHECK(count == expected, "%lld %s, expected %lld", (long long)count, what, (long long)expected);
    for (int64_t k = 0; k < expected && k < count; k++)
        CHECK(found[k] == wanted[k], "%s: %lld, expected %lld", what, (long long)found[k], (long long)wanted[k]);
}

/* Bars along x, y and z that no row touches, among others that rows hold: each slides along its axis. */
static void motions_that_nothing_determines(void)
{
    feti_problem *problem = small_problem();
    const int32_t node[2] = { 1, 2 };
    int64_t bar[3], body = -1, count = -1, list[MOST] = { 0 };
    double motion[6], v[2];

    EXPECT(FETI_STATE, feti_diagnosis_untouched(problem, 0, &count, NULL));
    EXPECT(FETI_STATE, feti_diagnosis_undetermined(problem, 0, &body, motion));
    for (int32_t axis = 0; axis < 3; axis++) {
        const int32_t dir[2] = { axis + 1, axis + 1 };
        double x[6] = { 0 };

        x[axis] = 2.0;
        x[3 + axis] = 3.0;
        OK(feti_body_add(problem, 2, &bar[axis]));
        OK(feti_body_stiffness_i32(problem, bar[axis], 2, BLOCK_PTR, BLOCK_COL, BLOCK_VAL, 0, FETI_LOWER, FETI_COPY));
        OK(feti_body_null_space(problem, bar[axis], 1, 2, BLOCK_MODE, 2, FETI_EXACT));
        if (axis > 0) OK(feti_body_coordinates(problem, bar[axis], 3, 2, node, dir, x, 3));
    }
    OK(feti_solve(problem, NULL));
    CHECK(findings_of(problem, FETI_OK).undetermined == 3, "other than three motions");
    OK(feti_diagnosis_untouched(problem, 0, &count, NULL));
    OK(feti_diagnosis_untouched(problem, MOST, &count, list));
    check_list("untouched bodies", count, list, 3, bar);
    for (int k = 0; k < 3; k++) {
        OK(feti_diagnosis_undetermined(problem, k, &body, motion));
        CHECK(body == bar[k], "motion %d is of body %lld", k, (long long)body);
        for (int axis = 0; axis < 6; axis++) {
            const int right = k == 0 ? isnan(motion[axis]) : fabs(motion[axis] - (axis == k)) < 1e-12;
            CHECK(right, "motion %d, entry %d: %g", k, axis, motion[axis]);
        }
        for (int other = 0; other < 3; other++) {
            OK(feti_diagnosis_undetermined_motion(problem, k, bar[other], 2, v));
            CHECK(fabs(v[0] - (other == k)) < 1e-12 && fabs(v[1] - (other == k)) < 1e-12, "motion %d of bar %d", k, other);
        }
    }
    OK(feti_diagnosis_undetermined(problem, 2, NULL, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis_undetermined(problem, 3, &body, motion));
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis_undetermined(problem, -1, &body, motion));
    EXPECT(FETI_ARGUMENT - 3, feti_diagnosis_undetermined_motion(problem, 0, 5, 2, v));
    EXPECT(FETI_ARGUMENT - 4, feti_diagnosis_undetermined_motion(problem, 0, BLOCK, 1, v));
    EXPECT(FETI_ARGUMENT - 5, feti_diagnosis_undetermined_motion(problem, 0, BLOCK, 2, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis_untouched(problem, -1, &count, list));
    EXPECT(FETI_ARGUMENT - 3, feti_diagnosis_untouched(problem, 0, NULL, list));
    OK(feti_problem_destroy(&problem));
}

/* u0 = u1, u1 = u2, u0 = u2 and twice the first: of the three differences one depends on the others. */
static void equality_rows_that_depend_on_each_other(void)
{
    const int32_t ptr[4] = { 0, 1, 2, 3 }, col[3] = { 0, 1, 2 };
    const int32_t row_ptr[5] = { 0, 2, 4, 6, 8 }, dof[8] = { 0, 1, 1, 2, 0, 2, 0, 1 };
    const double diagonal[3] = { 1.0, 2.0, 3.0 }, val[8] = { 1, -1, 1, -1, 1, -1, 2, -2 }, rhs[4] = { 0 };
    feti_problem *problem = NULL;
    int64_t body, count = -1, list[MOST] = { -1 };

    MUST(feti_problem_create(&problem));
    MUST(feti_body_add(problem, 3, &body));
    MUST(feti_body_stiffness_i32(problem, body, 3, ptr, col, diagonal, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(problem, body, 0, 3, NULL, 3, FETI_EXACT));
    MUST(feti_rows_add_i32(problem, FETI_EQUALITY, 4, row_ptr, NULL, dof, val, 0, rhs, NULL));
    OK(feti_body_load(problem, body, 3, (double[3]){ 6.0, 0.0, 0.0 }));
    EXPECT(FETI_STATE, feti_diagnosis_dependent(problem, 0, &count, NULL));
    OK(feti_solve(problem, NULL));
    OK(feti_diagnosis_dependent(problem, 0, &count, NULL));
    OK(feti_diagnosis_dependent(problem, MOST, &count, list));
    CHECK(count == 1 && list[0] >= 0 && list[0] < 3, "%lld rows, first %lld", (long long)count, (long long)list[0]);
    check_rows(problem, FETI_EQUALITY, 1, (int64_t[1]){ 3 }, (double[1]){ 2.0 });
    EXPECT(FETI_ARGUMENT - 2, feti_diagnosis_dependent(problem, -1, &count, list));
    EXPECT(FETI_ARGUMENT - 3, feti_diagnosis_dependent(problem, 0, NULL, list));
    OK(feti_problem_destroy(&problem));
}

/* A matrix with a negative direction: the body and the unknown. */
static void the_matrix_that_is_refused(void)
{
    feti_problem *problem = small_problem();

    OK(feti_body_stiffness_i32(problem, BLOCK, 2, BLOCK_PTR, BLOCK_COL, (double[3]){ 1.0, 2.0, 1.0 }, 0, FETI_LOWER, FETI_COPY));
    OK(feti_body_null_space(problem, BLOCK, 0, 2, NULL, 2, FETI_EXACT));
    EXPECT(FETI_INDEFINITE, feti_setup(problem));
    const feti_findings found = findings_of(problem, FETI_INDEFINITE);
    CHECK(found.body == BLOCK && found.dof >= 0 && isnan(found.margin), "body %lld, dof %lld", (long long)found.body,
          (long long)found.dof);
    OK(feti_problem_destroy(&problem));
}

static feti_body_facts facts_of(feti_problem *problem, int64_t body)
{
    feti_body_facts facts = { .struct_size = sizeof facts };

    OK(feti_body_info(problem, body, &facts));
    return facts;
}

enum { LINKS = 200 };

/* A chain of springs that nothing holds, its entries sums in the precision of float: row i has -k[i - 1], k[i - 1] + k[i]. */
static void give_chain(feti_problem *problem, int64_t body, int in_float)
{
    int32_t ptr[LINKS + 2] = { 0 }, col[2 * LINKS + 1];
    double val[2 * LINKS + 1], before = 0.0;

    for (int32_t i = 0, e = 0; i <= LINKS; i++) {
        const double k = i < LINKS ? 1e5 * (1.0 + 0.3 * sin(i + 1.0)) : 0.0, sum = before + k;

        if (i > 0) col[e] = i - 1, val[e++] = in_float ? (double)(float)-before : -before;
        col[e] = i, val[e++] = in_float ? (double)(float)sum : sum;
        ptr[i + 1] = e;
        before = k;
    }
    OK(feti_body_stiffness_i32(problem, body, LINKS + 1, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
}

/* Rounding of the entries holds a chain that nothing else does. */
static void a_stiffness_of_few_digits(void)
{
    feti_problem *problem = small_problem();
    int64_t chain;

    OK(feti_body_add(problem, LINKS + 1, &chain));
    give_chain(problem, chain, 1);
    CHECK(facts_of(problem, chain).soft_held == -1 && isnan(facts_of(problem, chain).softness), "soft motions before a setup");
    OK(feti_solve(problem, NULL));
    feti_findings found = findings_of(problem, FETI_OK);
    feti_body_facts facts = facts_of(problem, chain);
    CHECK(found.doubtful_bodies == 1 && found.doubtful_body == chain, "%lld doubtful bodies, the first %lld",
          (long long)found.doubtful_bodies, (long long)found.doubtful_body);
    CHECK(facts.soft_free + facts.soft_held == 1 && facts.softness > 0.0 && facts.softness_of_rounding < 1e-5,
          "%lld free, %lld held, %g, %g", (long long)facts.soft_free, (long long)facts.soft_held, facts.softness, facts.softness_of_rounding);

    give_chain(problem, chain, 0);
    OK(feti_solve(problem, NULL));
    found = findings_of(problem, FETI_OK);
    facts = facts_of(problem, chain);
    CHECK(found.doubtful_bodies == 0 && found.doubtful_body == -1, "%lld doubtful bodies", (long long)found.doubtful_bodies);
    CHECK(facts.soft_free == 0 && facts.soft_held == 0 && isnan(facts.softness) && isnan(facts.softness_of_rounding),
          "%lld free, %lld held, %g", (long long)facts.soft_free, (long long)facts.soft_held, facts.softness);
    OK(feti_problem_destroy(&problem));
}

int main(void)
{
    the_body_that_escapes();
    the_part_that_escapes();
    rows_that_contradict_each_other();
    what_an_answer_leaves_open();
    motions_that_nothing_determines();
    equality_rows_that_depend_on_each_other();
    the_matrix_that_is_refused();
    a_stiffness_of_few_digits();
    return check_result();
}
