#include "handover.h"

void read_or_stop(const char *folder, const char *name, case_data *data)
{
    char path[512], text[640];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (case_read(path, data, text, sizeof text) != 0) {
        fprintf(stderr, "%s\n", text);
        exit(1);
    }
}

/* Index arrays moved to the given base, in 64 bits. */
static int64_t *widened(int64_t n, const int32_t *from, int32_t base)
{
    int64_t *out = check_array(n, sizeof *out);
    for (int64_t i = 0; i < n; i++) out[i] = (int64_t)from[i] + base;
    return out;
}

static int32_t *moved(int64_t n, const int32_t *from, int32_t base)
{
    int32_t *out = check_array(n, sizeof *out);
    for (int64_t i = 0; i < n; i++) out[i] = from[i] + base;
    return out;
}

static void hand_sparse(feti_problem *problem, int64_t body, const case_matrix *k, const form *how)
{
    if (how->wide) {
        int64_t *row_ptr = widened(k->rows + 1, k->row_ptr, how->base), *col = widened(k->entries, k->col, how->base);
        MUST(feti_body_stiffness_i64(problem, body, k->rows, row_ptr, col, k->val, how->base, how->storage, FETI_COPY));
        free(row_ptr);
        free(col);
    } else {
        int32_t *row_ptr = moved(k->rows + 1, k->row_ptr, how->base), *col = moved(k->entries, k->col, how->base);
        MUST(feti_body_stiffness_i32(problem, body, k->rows, row_ptr, col, k->val, how->base, how->storage, FETI_COPY));
        free(row_ptr);
        free(col);
    }
}

/* Column-major with a leading dimension larger than n; what must not be read is not a number. */
static void hand_dense(feti_problem *problem, int64_t body, const case_matrix *lower, int32_t storage)
{
    const int64_t n = lower->rows, ld = n + 3;
    double *k = check_array(ld * n, sizeof *k);

    for (int64_t i = 0; i < ld * n; i++) k[i] = NAN;
    for (int64_t j = 0; j < n; j++)
        for (int64_t i = 0; i < n; i++)
            if (storage == FETI_FULL || (storage == FETI_LOWER && i >= j) || (storage == FETI_UPPER && i <= j))
                k[i + ld * j] = 0.0;
    for (int64_t i = 0; i < n; i++)
        for (int32_t e = lower->row_ptr[i]; e < lower->row_ptr[i + 1]; e++) {
            const int64_t j = lower->col[e];
            if (storage != FETI_UPPER) k[i + ld * j] = lower->val[e];
            if (storage != FETI_LOWER) k[j + ld * i] = lower->val[e];
        }
    MUST(feti_body_stiffness_dense(problem, body, n, k, ld, storage, FETI_COPY));
    free(k);
}

static void hand_stiffness(feti_problem *problem, int64_t body, const case_matrix *lower, const form *how)
{
    if (how->dense) {
        hand_dense(problem, body, lower, how->storage);
    } else if (how->storage == FETI_LOWER) {
        hand_sparse(problem, body, lower, how);
    } else {
        case_matrix k = how->storage == FETI_UPPER ? upper_of(lower) : full_of(lower);
        hand_sparse(problem, body, &k, how);
        matrix_release(&k);
    }
}

static void hand_rows(feti_problem *problem, int32_t kind, const case_matrix *rows, const double *rhs, const form *how)
{
    int64_t first = -1;
    if (rows->rows == 0) return;
    if (how->wide) {
        int64_t *ptr = widened(rows->rows + 1, rows->row_ptr, how->base), *dof = widened(rows->entries, rows->col, how->base);
        MUST(feti_rows_add_i64(problem, kind, rows->rows, ptr, NULL, dof, rows->val, how->base, rhs, &first));
        free(ptr);
        free(dof);
    } else {
        int32_t *ptr = moved(rows->rows + 1, rows->row_ptr, how->base), *dof = moved(rows->entries, rows->col, how->base);
        MUST(feti_rows_add_i32(problem, kind, rows->rows, ptr, NULL, dof, rows->val, how->base, rhs, &first));
        free(ptr);
        free(dof);
    }
    CHECK(first == 0, "first row of its kind has number %lld", (long long)first);
}

feti_problem *handed_over(const case_data *data, const form *how)
{
    feti_problem *problem = NULL;
    int64_t number = -1;

    MUST(feti_problem_create(&problem));
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        MUST(feti_body_add(problem, body->n, &number));
        CHECK(number == b, "body %lld got number %lld", (long long)b, (long long)number);
        hand_stiffness(problem, number, &body->stiffness, how);
        if (how->null_space == NULL_SPACE_EXACT)
            MUST(feti_body_null_space(problem, number, body->null_columns, body->n, body->null_space, body->n, FETI_EXACT));
        else if (how->null_space == NULL_SPACE_COORDINATES)
            MUST(feti_body_coordinates(problem, number, 3, body->n, data->node + body->first, data->dir + body->first,
                                       data->xyz + 3 * body->first, 3));
        MUST(feti_body_load(problem, number, body->n, data->load + body->first));
    }
    hand_rows(problem, FETI_INEQUALITY, &data->contact, data->gap, how);
    hand_rows(problem, FETI_EQUALITY, &data->equality, data->prescribed, how);
    return problem;
}

answer solved(feti_problem *problem, const case_data *data)
{
    answer result = { .info = { .struct_size = sizeof result.info } };
    const int32_t status = feti_solve(problem, &result.info);

    EXPECT(FETI_OK, status);
    CHECK(result.info.status == status, "info has status %d, the call %d", (int)result.info.status, (int)status);
    result.u = check_array(data->unknowns, sizeof *result.u);
    result.lambda = check_array(data->rows, sizeof *result.lambda);
    result.mu = check_array(data->equalities, sizeof *result.mu);
    if (status < 0) return result;
    for (int64_t b = 0; b < data->bodies; b++)
        OK(feti_displacement(problem, b, data->body[b].n, result.u + data->body[b].first));
    OK(feti_multipliers(problem, FETI_INEQUALITY, data->rows, result.lambda));
    if (data->equalities) OK(feti_multipliers(problem, FETI_EQUALITY, data->equalities, result.mu));
    return result;
}

void answer_free(answer *result)
{
    free(result->u);
    free(result->lambda);
    free(result->mu);
    memset(result, 0, sizeof *result);
}

void check_forces(const char *name, const case_data *data, const answer *result)
{
    const double distance = check_distance(data->rows, result->lambda, data->lambda_ref);
    const double size = check_max(data->rows, data->lambda_ref);
    CHECK(distance <= 1e-7 * size, "%s: contact forces differ by %.2e, limit %.2e", name, distance, 1e-7 * size);
}

void check_displacements(const char *name, const case_data *data, const answer *result)
{
    const double distance = check_distance(data->unknowns, result->u, data->u_ref);
    const double size = check_max(data->unknowns, data->u_ref);
    CHECK(distance <= 1e-8 * size, "%s: displacements differ by %.2e, limit %.2e", name, distance, 1e-8 * size);
}
