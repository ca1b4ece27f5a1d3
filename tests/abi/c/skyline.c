#include "skyline.h"

/* Holds the unknowns whose rows of R are most independent, by Gram-Schmidt. */
static void hold(const case_body *body, char *held)
{
    const int64_t n = body->n, r = body->null_columns;
    double *rows = check_array(n * r, sizeof *rows), pivot[16];

    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j < r; j++) rows[i * r + j] = body->null_space[i + n * j];
    for (int64_t k = 0; k < r; k++) {
        int64_t best = 0;
        double most = -1.0;
        for (int64_t i = 0; i < n; i++) {
            double size = 0.0;
            for (int64_t j = 0; j < r; j++) size += rows[i * r + j] * rows[i * r + j];
            if (size > most) {
                most = size;
                best = i;
            }
        }
        held[best] = 1;
        memcpy(pivot, rows + best * r, (size_t)r * sizeof *pivot);
        for (int64_t i = 0; i < n; i++) {
            double part = 0.0;
            for (int64_t j = 0; j < r; j++) part += rows[i * r + j] * pivot[j] / most;
            for (int64_t j = 0; j < r; j++) rows[i * r + j] -= part * pivot[j];
        }
    }
    free(rows);
}

static void gather(const case_matrix *k, skyline *factor)
{
    for (int64_t i = 0; i < factor->n; i++) {
        factor->first[i] = i;
        for (int32_t e = k->row_ptr[i]; e < k->row_ptr[i + 1]; e++)
            if (k->col[e] < factor->first[i]) factor->first[i] = k->col[e];
        factor->begin[i + 1] = factor->begin[i] + i - factor->first[i] + 1;
    }
    factor->value = check_array(factor->begin[factor->n], sizeof *factor->value);
    for (int64_t i = 0; i < factor->n; i++) {
        double *row = factor->value + factor->begin[i] - factor->first[i];
        for (int32_t e = k->row_ptr[i]; e < k->row_ptr[i + 1]; e++) {
            const int64_t j = k->col[e];
            if (j <= i && !factor->held[i] && !factor->held[j]) row[j] = k->val[e];
        }
        if (factor->held[i]) row[i] = 1.0;
    }
}

static void factorise(skyline *factor)
{
    for (int64_t i = 0; i < factor->n; i++) {
        double *row = factor->value + factor->begin[i] - factor->first[i];
        for (int64_t j = factor->first[i]; j <= i; j++) {
            const double *other = factor->value + factor->begin[j] - factor->first[j];
            const int64_t from = factor->first[j] > factor->first[i] ? factor->first[j] : factor->first[i];
            double sum = row[j];
            for (int64_t k = from; k < j; k++) sum -= row[k] * other[k];
            row[j] = j < i ? sum / other[j] : sqrt(sum);
        }
    }
}

skyline skyline_of(const case_body *body)
{
    skyline factor = { .n = body->n };

    factor.first = check_array(body->n, sizeof *factor.first);
    factor.begin = check_array(body->n + 1, sizeof *factor.begin);
    factor.held = check_array(body->n, 1);
    hold(body, factor.held);
    gather(&body->stiffness, &factor);
    factorise(&factor);
    return factor;
}

void skyline_solve(const skyline *factor, double *x)
{
    for (int64_t i = 0; i < factor->n; i++) {
        const double *row = factor->value + factor->begin[i] - factor->first[i];
        double sum = factor->held[i] ? 0.0 : x[i];
        for (int64_t k = factor->first[i]; k < i; k++) sum -= row[k] * x[k];
        x[i] = sum / row[i];
    }
    for (int64_t i = factor->n - 1; i >= 0; i--) {
        const double *row = factor->value + factor->begin[i] - factor->first[i];
        x[i] /= row[i];
        for (int64_t k = factor->first[i]; k < i; k++) x[k] -= row[k] * x[i];
    }
}

void skyline_free(skyline *factor)
{
    free(factor->first);
    free(factor->begin);
    free(factor->value);
    free(factor->held);
}
