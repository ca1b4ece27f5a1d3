/* CHOLMOD as an independent oracle. With the unknowns held that the library holds, it factorises every body of the
   reference cases and gives K+ f, the dual operator F = B K+ B' and the right-hand side d = B K+ f - c
   (contact rows first, then equalities). Where m <= 14 the dual is solved by enumeration as well.
   cholmod_oracle <data folder> [case ...] */
#include "brute_force.h"
#include "cholmod_shim.h"
#include "handover.h"

static const char *const EVERY_CASE[] = { "p1_P1", "p1_P3", "p1_P3_galerkin", "p2_A", "p2_B1", "p2_B2", "p3_2block",
                                          "p3_3block", "hertz_cylinder", "three_bodies" };

/* One case, its rows [B; H] and CHOLMOD's factors. */
typedef struct {
    const char *name;
    const case_data *data;
    feti_problem *problem;
    int64_t m;
    shim_factor *factor[CASE_BODIES_MAX];
} oracle;

/* Row r of [B; H] added to x, s times. */
static void add_row(const oracle *o, int64_t r, double s, double *x)
{
    const case_matrix *a = r < o->data->rows ? &o->data->contact : &o->data->equality;
    const int64_t i = r < o->data->rows ? r : r - o->data->rows;
    for (int32_t e = a->row_ptr[i]; e < a->row_ptr[i + 1]; e++) x[a->col[e]] += s * a->val[e];
}

/* y = [B; H] x */
static void all_rows(const oracle *o, const double *x, double *y)
{
    multiply(&o->data->contact, x, y);
    if (o->data->equalities) multiply(&o->data->equality, x, y + o->data->rows);
}

/* x = K+ b, body by body, by CHOLMOD. */
static void kplus(const oracle *o, const double *b, double *x)
{
    for (int64_t p = 0; p < o->data->bodies; p++)
        CHECK(shim_solve(o->factor[p], b + o->data->body[p].first, x + o->data->body[p].first) == 0, "CHOLMOD fails");
}

/* Factorises every body with the library's fixing unknowns held. */
static int factorise(oracle *o)
{
    for (int64_t p = 0; p < o->data->bodies; p++) {
        const case_body *body = &o->data->body[p];
        const case_matrix *k = &body->stiffness;
        int64_t held[6] = { 0 };

        OK(feti_body_fixing(o->problem, p, body->null_columns, held));
        o->factor[p] = shim_factorise(body->n, k->row_ptr, k->col, k->val, body->null_columns, held, 0);
        CHECK(o->factor[p], "%s: CHOLMOD cannot factorise body %lld with the fixing unknowns held", o->name, (long long)p);
        if (!o->factor[p]) return 0;
    }
    return 1;
}

/* K+ f of the library and of CHOLMOD. */
static void check_kplus(const oracle *o)
{
    const int64_t n = o->data->unknowns;
    double *x = check_array(n, sizeof *x), *y = check_array(n, sizeof *y);

    kplus(o, o->data->load, x);
    for (int64_t p = 0; p < o->data->bodies; p++) {
        const case_body *body = &o->data->body[p];
        OK(feti_body_kplus(o->problem, p, body->n, 1, o->data->load + body->first, body->n, y + body->first, body->n));
        const double distance = check_distance(body->n, x + body->first, y + body->first);
        const double size = check_max(body->n, x + body->first);
        CHECK(distance <= 1e-10 * size, "%s: body %lld: K+ f differs by %.2e of %.2e", o->name, (long long)p, distance, size);
    }
    free(x);
    free(y);
}

/* F of CHOLMOD (m x m, column-major) and d, against the library's: |dF_ij| <= 1e-10 sqrt(F_ii F_jj). */
static void dual_by_cholmod(const oracle *o, double *F, double *d)
{
    const int64_t n = o->data->unknowns;
    double *b = check_array(n, sizeof *b), *x = check_array(n, sizeof *x);

    for (int64_t j = 0; j < o->m; j++) {
        memset(b, 0, (size_t)n * sizeof *b);
        add_row(o, j, 1.0, b);
        kplus(o, b, x);
        all_rows(o, x, F + o->m * j);
    }
    kplus(o, o->data->load, x);
    all_rows(o, x, d);
    for (int64_t r = 0; r < o->m; r++)
        d[r] -= r < o->data->rows ? o->data->gap[r] : o->data->prescribed[r - o->data->rows];
    free(b);
    free(x);
}

static void check_dual(const oracle *o, const double *F, const double *d)
{
    const int64_t m = o->m;
    double *unit = check_array(m, sizeof *unit), *column = check_array(m, sizeof *column), worst = 0.0;
    int64_t wrong = 0;

    for (int64_t j = 0; j < m; j++) {
        unit[j] = 1.0;
        OK(feti_dual_apply(o->problem, m, unit, column));
        unit[j] = 0.0;
        for (int64_t i = 0; i < m; i++) {
            const double allowed = 1e-10 * sqrt(F[i + m * i] * F[j + m * j]), found = fabs(column[i] - F[i + m * j]);
            wrong += !(found <= allowed);
            if (allowed > 0.0) worst = fmax(worst, found / allowed);
        }
    }
    CHECK(wrong == 0, "%s: %lld entries of F differ, the worst by %.2e of the limit", o->name, (long long)wrong, worst);
    OK(feti_dual_rhs(o->problem, m, column));
    CHECK(check_distance(m, column, d) <= 1e-10 * check_max(m, d), "%s: d differs by %.2e of %.2e", o->name,
          check_distance(m, column, d), check_max(m, d));
    free(unit);
    free(column);
}

/* G = R'B' (r x m) and e = R'f. */
static int64_t coarse(const oracle *o, double *G, double *e)
{
    int64_t r = 0, k = 0;
    double *row = check_array(o->data->unknowns, sizeof *row);

    for (int64_t p = 0; p < o->data->bodies; p++) r += o->data->body[p].null_columns;
    for (int64_t p = 0; p < o->data->bodies; p++) {
        const case_body *body = &o->data->body[p];
        for (int64_t j = 0; j < body->null_columns; j++, k++) {
            const double *mode = body->null_space + j * body->n;
            for (int64_t i = 0; i < body->n; i++) e[k] += mode[i] * o->data->load[body->first + i];
            for (int64_t c = 0; c < o->m; c++) {
                memset(row, 0, (size_t)o->data->unknowns * sizeof *row);
                add_row(o, c, 1.0, row);
                for (int64_t i = 0; i < body->n; i++) G[k + r * c] += mode[i] * row[body->first + i];
            }
        }
    }
    free(row);
    return r;
}

/* The library's contact forces and those of the enumeration over CHOLMOD's F. */
static void check_by_enumeration(const oracle *o, const double *F, const double *d)
{
    double G[6 * CASE_BODIES_MAX * 14] = { 0 }, e[6 * CASE_BODIES_MAX] = { 0 }, l[14], spread;
    answer result = solved(o->problem, o->data);
    const int64_t r = coarse(o, G, e), found = brute_force(o->m, r, F, d, G, e, l, &spread);
    const double size = check_max(o->m, result.lambda);

    CHECK(found >= 1, "%s: enumeration finds no solution", o->name);
    CHECK(found < 1 || spread <= 1e-7 * size, "%s: enumeration finds solutions %.2e apart", o->name, spread);
    CHECK(found < 1 || check_distance(o->m, l, result.lambda) <= 1e-7 * size, "%s: lambda differs from enumeration by %.2e of %.2e",
          o->name, check_distance(o->m, l, result.lambda), size);
    answer_free(&result);
}

static void check_case(const char *folder, const char *name)
{
    const form lower = { .storage = FETI_LOWER };
    case_data data;
    oracle o = { .name = name, .data = &data };

    read_or_stop(folder, name, &data);
    o.m = data.rows + data.equalities;
    o.problem = handed_over(&data, &lower);
    OK(feti_setup(o.problem));
    if (factorise(&o)) {
        double *F = check_array(o.m * o.m, sizeof *F), *d = check_array(o.m, sizeof *d);
        check_kplus(&o);
        dual_by_cholmod(&o, F, d);
        check_dual(&o, F, d);
        if (o.m <= 14) check_by_enumeration(&o, F, d);
        free(F);
        free(d);
    }
    for (int64_t p = 0; p < data.bodies; p++) shim_release(o.factor[p]);
    OK(feti_problem_destroy(&o.problem));
    case_free(&data);
}

int main(int argc, char **argv)
{
    if (argc < 2) return 2;
    for (size_t k = 0; argc == 2 && k < sizeof EVERY_CASE / sizeof EVERY_CASE[0]; k++) check_case(argv[1], EVERY_CASE[k]);
    for (int k = 2; k < argc; k++) check_case(argv[1], argv[k]);
    return check_result();
}
