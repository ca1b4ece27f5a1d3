/* Every reference case solves through the C interface to its known solution, and the certificate passes; with the null
   spaces given, and with nothing said about them.
   reference_cases <data folder> [case ...] */
#include "handover.h"

/* Neutral motions (rigid motions that no row sees) leave u without a unique answer. */
typedef struct {
    const char *name;
    int64_t undetermined;
} expected;

static const expected EVERY_CASE[] = {
    { "p1_P1", 0 }, { "p1_P3", 0 }, { "p1_P3_galerkin", 0 }, { "p2_A", 0 }, { "p2_B1", 0 },
    { "p2_B2", 2 }, { "p3_2block", 0 }, { "p3_3block", 0 }, { "hertz_cylinder", 0 }, { "three_bodies", 0 },
};
enum { CASES = sizeof EVERY_CASE / sizeof EVERY_CASE[0] };

static void check_counts(const char *name, feti_problem *problem, const case_data *data, const feti_info *info)
{
    int64_t bodies = -1, dofs = -1, rows = -1, equalities = -1, modes = 0;
    OK(feti_counts(problem, &bodies, &dofs, &rows, &equalities));
    CHECK(bodies == data->bodies && dofs == data->unknowns && rows == data->rows && equalities == data->equalities,
          "%s: the problem has %lld bodies, %lld unknowns, %lld and %lld rows", name, (long long)bodies,
          (long long)dofs, (long long)rows, (long long)equalities);
    for (int64_t b = 0; b < data->bodies; b++) modes += data->body[b].null_columns;
    CHECK(info->bodies == bodies && info->dofs == dofs && info->rows == rows && info->equalities == equalities &&
          info->floating_modes == modes, "%s: info tells other sizes", name);
}

/* The certificate of the answer, asked for again: every entry passes at 1e-8. */
static void check_certificate(const char *name, feti_problem *problem, const case_data *data, const answer *result)
{
    feti_certificate certificate = { .struct_size = sizeof certificate };
    OK(feti_check(problem, data->unknowns, result->u, data->rows, result->lambda, data->equalities, result->mu,
                  &certificate));
    CHECK(certificate.limit == 1e-8, "%s: limit %g", name, certificate.limit);
    CHECK(certificate.passed == 1 && certificate.worst <= 1.0, "%s: certificate %g of its limit", name, certificate.worst);
    CHECK(result->info.worst <= 1.0, "%s: info has certificate %g", name, result->info.worst);
}

/* A wrong answer must not pass: one displacement or one force moved by a thousandth of the largest. */
static void check_certificate_sees(const char *name, feti_problem *problem, const case_data *data, answer *result)
{
    feti_certificate certificate = { .struct_size = sizeof certificate };
    double *moved[2] = { result->u, result->lambda };
    const int64_t n[2] = { data->unknowns, data->rows };

    for (int k = 0; k < 2; k++) {
        const double kept = moved[k][n[k] / 2];
        moved[k][n[k] / 2] += 1e-3 * check_max(n[k], moved[k]);
        OK(feti_check(problem, data->unknowns, result->u, data->rows, result->lambda, data->equalities, result->mu,
                      &certificate));
        CHECK(certificate.passed == 0 && certificate.worst > 1.0, "%s: a wrong answer passes (%s moved)", name,
              k ? "force" : "displacement");
        moved[k][n[k] / 2] = kept;
    }
}

/* slack = c - B u; a row with a clear force is closed, a row with a clear gap is open. */
static void check_rows(const char *name, feti_problem *problem, const case_data *data, const answer *result)
{
    double *slack = check_array(data->rows, sizeof *slack), *bu = check_array(data->rows, sizeof *bu);
    int32_t *state = check_array(data->rows, sizeof *state);
    int64_t closed = 0;
    const double size = check_max(data->unknowns, result->u) + check_max(data->rows, data->gap);
    const double force = check_max(data->rows, data->lambda_ref);

    OK(feti_gaps(problem, data->rows, slack));
    OK(feti_active(problem, data->rows, state));
    multiply(&data->contact, result->u, bu);
    for (int64_t r = 0; r < data->rows; r++) {
        const double gap = data->gap[r] - bu[r];
        CHECK(fabs(slack[r] - gap) <= 1e-12 * size, "%s: row %lld has slack %g, c - B u is %g", name, (long long)r, slack[r], gap);
        if (data->lambda_ref[r] > 1e-6 * force)
            CHECK(state[r] == FETI_ROW_CLOSED, "%s: row %lld bears %g and has state %d", name, (long long)r, data->lambda_ref[r], state[r]);
        if (gap > 1e-6 * size)
            CHECK(state[r] == FETI_ROW_OPEN, "%s: row %lld is open by %g and has state %d", name, (long long)r, gap, state[r]);
        closed += state[r] == FETI_ROW_CLOSED;
    }
    CHECK(closed == result->info.active, "%s: %lld rows closed, info says %lld", name, (long long)closed, (long long)result->info.active);
    free(slack);
    free(bu);
    free(state);
}

/* K u = f + r with r = -B'lambda - H'mu, and the parts of both kinds add up. */
static void check_reactions(const char *name, feti_problem *problem, const case_data *data, const answer *result)
{
    double *all = check_array(data->unknowns, sizeof *all), *part = check_array(data->unknowns, sizeof *part);
    double *wanted = check_array(data->unknowns, sizeof *wanted), *ku = check_array(data->unknowns, sizeof *ku);

    add_transposed(&data->contact, -1.0, result->lambda, wanted);
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        OK(feti_reaction(problem, FETI_INEQUALITY, b, body->n, part + body->first));
        OK(feti_reaction(problem, 0, b, body->n, all + body->first));
        multiply(&body->stiffness, result->u + body->first, ku + body->first);
    }
    const double size = check_max(data->unknowns, ku) + check_max(data->unknowns, wanted);
    CHECK(check_distance(data->unknowns, part, wanted) <= 1e-12 * size, "%s: contact reactions are not -B'lambda", name);
    add_transposed(&data->equality, -1.0, result->mu, wanted);
    CHECK(check_distance(data->unknowns, all, wanted) <= 1e-12 * size, "%s: reactions are not -B'lambda - H'mu", name);
    for (int64_t i = 0; i < data->unknowns; i++) wanted[i] = data->load[i] + all[i];
    CHECK(check_distance(data->unknowns, ku, wanted) <= 1e-8 * size, "%s: K u differs from f + r by %g", name,
          check_distance(data->unknowns, ku, wanted));
    free(all);
    free(part);
    free(wanted);
    free(ku);
}

/* u = K+ (f + r) + R alpha, with the null space and the amplitudes the library tells. */
static void check_recovery(const char *name, feti_problem *problem, const case_data *data, const answer *result)
{
    for (int64_t b = 0; b < data->bodies; b++) {
        const int64_t n = data->body[b].n;
        const double *u = result->u + data->body[b].first;
        double modes[6], *basis = check_array(6 * n, sizeof *basis), *force = check_array(n, sizeof *force);
        double *sum = check_array(n, sizeof *sum);
        int64_t r = 6;

        OK(feti_body_null_space_get(problem, b, n, &r, basis, n));
        CHECK(r == data->body[b].null_columns, "%s: body %lld has %lld modes", name, (long long)b, (long long)r);
        OK(feti_amplitudes(problem, b, r, modes));
        OK(feti_reaction(problem, 0, b, n, force));
        for (int64_t i = 0; i < n; i++) force[i] += data->load[data->body[b].first + i];
        OK(feti_body_kplus(problem, b, n, 1, force, n, sum, n));
        for (int64_t j = 0; j < r; j++)
            for (int64_t i = 0; i < n; i++) sum[i] += modes[j] * basis[i + n * j];
        CHECK(check_distance(n, sum, u) <= 1e-8 * check_max(n, u), "%s: body %lld: u differs from K+ (f + r) + R alpha by %.2e",
              name, (long long)b, check_distance(n, sum, u));
        free(basis);
        free(force);
        free(sum);
    }
}

/* Takes out of du its part along the rigid motions of every body (Gram-Schmidt, twice). */
static void remove_rigid(const case_data *data, double *du)
{
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        double *q = check_array(body->n * body->null_columns, sizeof *q), *v = du + body->first;
        memcpy(q, body->null_space, (size_t)(body->n * body->null_columns) * sizeof *q);
        for (int64_t j = 0; j <= body->null_columns; j++) {
            double *x = j < body->null_columns ? q + j * body->n : v, norm = 0.0;
            for (int64_t k = 0; k < 2 * j; k++) {
                const double *y = q + k % j * body->n;
                double s = 0.0;
                for (int64_t i = 0; i < body->n; i++) s += x[i] * y[i];
                for (int64_t i = 0; i < body->n; i++) x[i] -= s * y[i];
            }
            if (x == v) break;
            for (int64_t i = 0; i < body->n; i++) norm += x[i] * x[i];
            for (int64_t i = 0; i < body->n; i++) x[i] /= sqrt(norm);
        }
        free(q);
    }
}

/* u - u_ref is a rigid motion of the bodies that no row sees. */
static void check_up_to_neutral(const char *name, const case_data *data, const answer *result)
{
    double *du = check_array(data->unknowns, sizeof *du), *seen = check_array(data->rows, sizeof *seen);
    const double size = check_max(data->unknowns, data->u_ref);

    for (int64_t i = 0; i < data->unknowns; i++) du[i] = result->u[i] - data->u_ref[i];
    multiply(&data->contact, du, seen);
    CHECK(check_max(data->rows, seen) <= 1e-8 * size, "%s: B u differs by %.2e", name, check_max(data->rows, seen));
    remove_rigid(data, du);
    CHECK(check_max(data->unknowns, du) <= 1e-8 * size, "%s: u differs by %.2e beside rigid motions", name,
          check_max(data->unknowns, du));
    free(du);
    free(seen);
}

static void check_case(const char *folder, const expected *wanted, int null_space)
{
    const form how = { .storage = FETI_LOWER, .null_space = null_space };
    case_data data;
    read_or_stop(folder, wanted->name, &data);
    feti_problem *problem = handed_over(&data, &how);
    answer result = solved(problem, &data);

    CHECK(result.info.undetermined == wanted->undetermined, "%s: %lld modes undetermined", wanted->name,
          (long long)result.info.undetermined);
    check_counts(wanted->name, problem, &data, &result.info);
    check_forces(wanted->name, &data, &result);
    if (wanted->undetermined) check_up_to_neutral(wanted->name, &data, &result);
    else check_displacements(wanted->name, &data, &result);
    check_certificate(wanted->name, problem, &data, &result);
    check_rows(wanted->name, problem, &data, &result);
    check_reactions(wanted->name, problem, &data, &result);
    check_recovery(wanted->name, problem, &data, &result);
    check_certificate_sees(wanted->name, problem, &data, &result);
    OK(feti_problem_destroy(&problem));
    answer_free(&result);
    case_free(&data);
}

int main(int argc, char **argv)
{
    int done = 0;
    for (int k = 0; k < CASES; k++) {
        int chosen = argc < 3;
        for (int i = 2; i < argc; i++) chosen = chosen || strcmp(argv[i], EVERY_CASE[k].name) == 0;
        if (chosen) check_case(argv[1], &EVERY_CASE[k], NULL_SPACE_EXACT);
        if (chosen) check_case(argv[1], &EVERY_CASE[k], NULL_SPACE_FOUND);
        done += chosen;
    }
    CHECK(done == (argc < 3 ? CASES : argc - 2), "%d cases done", done);
    return check_result();
}
