#include "handover.h"

void multiply(const case_matrix *a, const double *x, double *y)
{
    for (int64_t i = 0; i < a->rows; i++) y[i] = 0.0;
    for (int64_t i = 0; i < a->rows; i++)
        for (int32_t e = a->row_ptr[i]; e < a->row_ptr[i + 1]; e++) {
            const int64_t j = a->col[e];
            y[i] += a->val[e] * x[j];
            if (a->symmetric && i != j) y[j] += a->val[e] * x[i];
        }
}

void add_transposed(const case_matrix *a, double s, const double *x, double *y)
{
    for (int64_t i = 0; i < a->rows; i++)
        for (int32_t e = a->row_ptr[i]; e < a->row_ptr[i + 1]; e++) y[a->col[e]] += s * a->val[e] * x[i];
}

static case_matrix matrix_of(int64_t rows, int64_t cols, int64_t entries)
{
    case_matrix out = { .rows = rows, .cols = cols, .entries = entries };
    out.row_ptr = check_array(rows + 1, sizeof *out.row_ptr);
    out.col = check_array(entries, sizeof *out.col);
    out.val = check_array(entries, sizeof *out.val);
    return out;
}

void matrix_release(case_matrix *matrix)
{
    free(matrix->row_ptr);
    free(matrix->col);
    free(matrix->val);
    memset(matrix, 0, sizeof *matrix);
}

/* Rows of the transpose; columns within a row ascend. */
case_matrix upper_of(const case_matrix *lower)
{
    case_matrix out = matrix_of(lower->cols, lower->rows, lower->entries);
    int32_t *next = check_array(out.rows + 1, sizeof *next);

    for (int64_t e = 0; e < lower->entries; e++) out.row_ptr[lower->col[e] + 1]++;
    for (int64_t i = 0; i < out.rows; i++) out.row_ptr[i + 1] += out.row_ptr[i];
    memcpy(next, out.row_ptr, (size_t)out.rows * sizeof *next);
    for (int64_t i = 0; i < lower->rows; i++)
        for (int32_t e = lower->row_ptr[i]; e < lower->row_ptr[i + 1]; e++) {
            const int32_t place = next[lower->col[e]]++;
            out.col[place] = (int32_t)i;
            out.val[place] = lower->val[e];
        }
    free(next);
    return out;
}

/* Row i: the lower row (with the diagonal), then what the transpose has to the right of the diagonal. */
case_matrix full_of(const case_matrix *lower)
{
    case_matrix upper = upper_of(lower), out = matrix_of(lower->rows, lower->cols, 2 * lower->entries);
    int32_t place = 0;

    for (int64_t i = 0; i < lower->rows; i++) {
        const case_matrix *part[2] = { lower, &upper };
        for (int k = 0; k < 2; k++)
            for (int32_t e = part[k]->row_ptr[i]; e < part[k]->row_ptr[i + 1]; e++)
                if (k == 0 || part[k]->col[e] != i) {
                    out.col[place] = part[k]->col[e];
                    out.val[place++] = part[k]->val[e];
                }
        out.row_ptr[i + 1] = place;
    }
    out.entries = place;
    matrix_release(&upper);
    return out;
}

/* The rows row_kept[0..rows) of a (NULL: the first ones), only the columns with number[col] >= 0, renumbered so. */
static case_matrix columns_kept(const case_matrix *a, const int64_t *row_kept, int64_t rows, const int64_t *number)
{
    case_matrix out = matrix_of(rows, a->cols, a->entries);
    int32_t place = 0;

    for (int64_t i = 0; i < rows; i++) {
        const int64_t row = row_kept ? row_kept[i] : i;
        for (int32_t e = a->row_ptr[row]; e < a->row_ptr[row + 1]; e++)
            if (number[a->col[e]] >= 0) {
                out.col[place] = (int32_t)number[a->col[e]];
                out.val[place++] = a->val[e];
            }
        out.row_ptr[i + 1] = place;
    }
    out.entries = place;
    out.symmetric = a->symmetric;
    return out;
}

static double *copy_kept(const double *from, int64_t n, const int64_t *kept)
{
    double *out = check_array(n, sizeof *out);
    for (int64_t i = 0; i < n; i++) out[i] = from[kept ? kept[i] : i];
    return out;
}

/* New numbers within the whole; -1 where a row of H holds the unknown. */
static int64_t *numbers_without_supports(const case_data *data, int64_t **kept, int64_t *count)
{
    int64_t *number = check_array(data->unknowns, sizeof *number);

    *kept = check_array(data->unknowns, sizeof **kept);
    *count = 0;
    for (int64_t r = 0; r < data->equalities; r++) {
        const int32_t e = data->equality.row_ptr[r];
        CHECK(data->equality.row_ptr[r + 1] == e + 1 && data->prescribed[r] == 0.0, "row %lld of H is no support", (long long)r);
        number[data->equality.col[e]] = -1;
    }
    for (int64_t i = 0; i < data->unknowns; i++)
        if (number[i] == 0) {
            (*kept)[*count] = i;
            number[i] = (*count)++;
        }
    return number;
}

static void strike_body(const case_body *from, case_body *to, int64_t first, const int64_t *number)
{
    int64_t *local = check_array(from->n, sizeof *local), *rows = check_array(from->n, sizeof *rows);
    memset(to, 0, sizeof *to);
    to->first = first;
    for (int64_t i = 0; i < from->n; i++) {
        local[i] = number[from->first + i] < 0 ? -1 : to->n;
        if (local[i] >= 0) rows[to->n++] = i;
    }
    to->stiffness = columns_kept(&from->stiffness, rows, to->n, local);
    to->stiffness.cols = to->n;
    free(local);
    free(rows);
}

void strike_supports(const case_data *data, case_data *out, int64_t **kept)
{
    int64_t *number, first = 0;

    memset(out, 0, sizeof *out);
    number = numbers_without_supports(data, kept, &out->unknowns);
    out->bodies = data->bodies;
    for (int64_t b = 0; b < data->bodies; b++) {
        strike_body(&data->body[b], &out->body[b], first, number);
        first += out->body[b].n;
    }
    out->rows = data->rows;
    out->contact = columns_kept(&data->contact, NULL, data->rows, number);
    out->contact.cols = out->unknowns;
    out->gap = copy_kept(data->gap, data->rows, NULL);
    out->lambda_ref = copy_kept(data->lambda_ref, data->rows, NULL);
    out->load = copy_kept(data->load, out->unknowns, *kept);
    out->u_ref = copy_kept(data->u_ref, out->unknowns, *kept);
    out->node = check_array(out->unknowns, sizeof *out->node);
    out->dir = check_array(out->unknowns, sizeof *out->dir);
    out->xyz = check_array(3 * out->unknowns, sizeof *out->xyz);
    for (int64_t i = 0; i < out->unknowns; i++) {
        out->node[i] = data->node[(*kept)[i]];
        out->dir[i] = data->dir[(*kept)[i]];
        memcpy(out->xyz + 3 * i, data->xyz + 3 * (*kept)[i], 3 * sizeof *out->xyz);
    }
    free(number);
}
