#include "case_reader.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ELEMENT_NODES_MAX = 20 };

/* A text file in memory and the place where reading stands. */
typedef struct {
    char *text;
    char *at;
} reader;

/* Why the last file could not be read; NULL: it could. */
typedef const char *fault;

/* Opens folder/name. 1: read, 0: there is no such file, -1: it cannot be held in memory. */
static int reader_open(reader *file, const char *folder, const char *name)
{
    char path[1024];
    long size = 0;
    FILE *stream;

    file->text = file->at = NULL;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return -1;
    stream = fopen(path, "rb");
    if (!stream) return 0;
    if (fseek(stream, 0, SEEK_END) == 0 && (size = ftell(stream)) >= 0 && fseek(stream, 0, SEEK_SET) == 0)
        file->text = malloc((size_t)size + 1);
    if (file->text) {
        file->text[fread(file->text, 1, (size_t)size, stream)] = '\0';
        file->at = file->text;
    }
    fclose(stream);
    return file->text ? 1 : -1;
}

static void reader_close(reader *file)
{
    free(file->text);
    file->text = file->at = NULL;
}

static void skip_line(reader *file)
{
    while (*file->at && *file->at != '\n') file->at++;
    if (*file->at) file->at++;
}

/* Skips blank space and lines that begin with the comment mark. */
static void skip_comments(reader *file, char mark)
{
    for (;;) {
        while (isspace((unsigned char)*file->at)) file->at++;
        if (*file->at != mark) return;
        skip_line(file);
    }
}

static int next_number(reader *file, double *value)
{
    char *end;
    *value = strtod(file->at, &end);
    if (end == file->at) return 0;
    file->at = end;
    return 1;
}

static int next_integer(reader *file, int64_t *value)
{
    char *end;
    *value = strtoll(file->at, &end, 10);
    if (end == file->at) return 0;
    file->at = end;
    return 1;
}

/* The header "%%MatrixMarket matrix <format> real <symmetry>", written with one or two %. */
static fault read_header(reader *file, char format[16], char symmetry[16])
{
    const char *at = file->at;
    while (*at == '%') at++;
    if (at == file->at || sscanf(at, "MatrixMarket matrix %15s real %15s", format, symmetry) != 2)
        return "no MatrixMarket header";
    skip_comments(file, '%');
    return NULL;
}

static void matrix_free(case_matrix *matrix)
{
    free(matrix->row_ptr);
    free(matrix->col);
    free(matrix->val);
    memset(matrix, 0, sizeof *matrix);
}

/* Sorts the triplets (row, col, val) into rows, order within a row kept. */
static fault rows_from_triplets(case_matrix *out, const int32_t *row, const int32_t *col, const double *val)
{
    int64_t e, i;

    out->row_ptr = calloc((size_t)out->rows + 2, sizeof *out->row_ptr);
    out->col = malloc((size_t)(out->entries + 1) * sizeof *out->col);
    out->val = malloc((size_t)(out->entries + 1) * sizeof *out->val);
    if (!out->row_ptr || !out->col || !out->val) return "out of memory";
    /* counts one place ahead, so that row_ptr[i + 1] first serves as the place to fill of row i */
    for (e = 0; e < out->entries; e++) out->row_ptr[row[e] + 2]++;
    for (i = 0; i < out->rows; i++) out->row_ptr[i + 2] += out->row_ptr[i + 1];
    for (e = 0; e < out->entries; e++) {
        int32_t place = out->row_ptr[row[e] + 1]++;
        out->col[place] = col[e];
        out->val[place] = val[e];
    }
    return NULL;
}

static fault read_triplets(reader *file, case_matrix *out, int32_t *row, int32_t *col, double *val)
{
    int64_t e, i, j;
    for (e = 0; e < out->entries; e++) {
        if (!next_integer(file, &i) || !next_integer(file, &j) || !next_number(file, &val[e])) return "ends too early";
        if (i < 1 || i > out->rows || j < 1 || j > out->cols) return "index out of range";
        row[e] = (int32_t)(i - 1);
        col[e] = (int32_t)(j - 1);
    }
    return rows_from_triplets(out, row, col, val);
}

static fault read_coordinate(reader *file, case_matrix *out)
{
    int32_t *row, *col;
    double *val;
    fault why = "out of memory";

    if (!next_integer(file, &out->rows) || !next_integer(file, &out->cols) || !next_integer(file, &out->entries))
        return "no size line";
    row = malloc((size_t)(out->entries + 1) * sizeof *row);
    col = malloc((size_t)(out->entries + 1) * sizeof *col);
    val = malloc((size_t)(out->entries + 1) * sizeof *val);
    if (row && col && val) why = read_triplets(file, out, row, col, val);
    free(row);
    free(col);
    free(val);
    return why;
}

/* A sparse matrix; absent: left empty, *present = 0. */
static fault read_matrix(const char *folder, const char *name, case_matrix *out, int *present)
{
    reader file;
    char format[16], symmetry[16];
    fault why;

    *present = reader_open(&file, folder, name);
    if (*present < 0) return "cannot be read";
    if (!*present) return NULL;
    why = read_header(&file, format, symmetry);
    if (!why && strcmp(format, "coordinate") != 0) why = "is not in coordinate format";
    if (!why) why = read_coordinate(&file, out);
    out->symmetric = !why && strcmp(symmetry, "symmetric") == 0;
    reader_close(&file);
    return why;
}

/* A dense matrix, column-major; absent: left NULL. */
static fault read_dense(const char *folder, const char *name, int64_t rows, int64_t *cols, double **out)
{
    reader file;
    char format[16], symmetry[16];
    int64_t stored, k;
    fault why;
    int present = reader_open(&file, folder, name);

    *cols = 0;
    if (present <= 0) return present ? "cannot be read" : NULL;
    why = read_header(&file, format, symmetry);
    if (!why && strcmp(format, "array") != 0) why = "is not in array format";
    if (!why && (!next_integer(&file, &stored) || !next_integer(&file, cols))) why = "no size line";
    if (!why && (stored != rows || *cols < 0)) why = "has the wrong number of rows";
    if (!why && !(*out = malloc((size_t)(rows * *cols + 1) * sizeof **out))) why = "out of memory";
    for (k = 0; !why && k < rows * *cols; k++)
        if (!next_number(&file, *out + k)) why = "ends too early";
    reader_close(&file);
    return why;
}

/* A vector of n numbers; absent: left NULL. */
static fault read_vector(const char *folder, const char *name, int64_t n, double **out)
{
    reader file;
    int64_t k;
    fault why = NULL;
    int present = reader_open(&file, folder, name);

    if (present <= 0) return present ? "cannot be read" : NULL;
    *out = malloc((size_t)(n + 1) * sizeof **out);
    if (!*out) why = "out of memory";
    for (k = 0; !why && k < n; k++) {
        skip_comments(&file, '#');
        if (!next_number(&file, *out + k)) why = "ends too early";
    }
    reader_close(&file);
    return why;
}

/* dofs.txt: node, direction, x, y, z per unknown. */
static fault read_dofs(reader *file, case_data *out)
{
    int64_t i, node, dir;
    size_t n = (size_t)out->unknowns;

    out->node = malloc((n + 1) * sizeof *out->node);
    out->dir = malloc((n + 1) * sizeof *out->dir);
    out->xyz = malloc((3 * n + 1) * sizeof *out->xyz);
    if (!out->node || !out->dir || !out->xyz) return "out of memory";
    for (i = 0; i < out->unknowns; i++) {
        double *x = out->xyz + 3 * i;
        skip_comments(file, '#');
        if (!next_integer(file, &node) || !next_integer(file, &dir) || !next_number(file, x) ||
            !next_number(file, x + 1) || !next_number(file, x + 2))
            return "ends too early";
        out->node[i] = (int32_t)node;
        out->dir[i] = (int32_t)dir;
    }
    return NULL;
}

/* elements.txt: the number of elements, then body, number of nodes and nodes of each. */
static fault read_elements(reader *file, case_data *out)
{
    case_elements *all = &out->elements;
    int64_t count, body, nodes, node;

    skip_comments(file, '#');
    if (!next_integer(file, &count)) return "has no count";
    all->body = malloc((size_t)(count + 1) * sizeof *all->body);
    all->ptr = malloc((size_t)(count + 1) * sizeof *all->ptr);
    all->node = malloc((size_t)(ELEMENT_NODES_MAX * count + 1) * sizeof *all->node);
    if (!all->body || !all->ptr || !all->node) return "out of memory";
    all->ptr[0] = 0;
    for (; all->count < count; all->count++) {
        if (!next_integer(file, &body) || !next_integer(file, &nodes)) return "ends too early";
        if (nodes < 1 || nodes > ELEMENT_NODES_MAX || body < 1 || body > out->bodies) return "has an element that is none";
        all->body[all->count] = (int32_t)body - 1;
        all->ptr[all->count + 1] = all->ptr[all->count] + nodes;
        for (int64_t k = all->ptr[all->count]; k < all->ptr[all->count + 1]; k++) {
            if (!next_integer(file, &node)) return "ends too early";
            if (node < 1 || node > out->unknowns) return "has a node that is none";
            all->node[k] = node - 1;
        }
    }
    return NULL;
}

static fault read_present(const char *folder, const char *name, fault (*read)(reader *, case_data *), case_data *out)
{
    reader file;
    fault why = NULL;
    int present = reader_open(&file, folder, name);

    if (present < 0) return "cannot be read";
    if (present) why = read(&file, out);
    reader_close(&file);
    return why;
}

static fault read_bodies(const char *folder, case_data *out, char name[32])
{
    for (;;) {
        case_body *body = &out->body[out->bodies];
        fault why;
        int present = 0;

        if (out->bodies == CASE_BODIES_MAX) return NULL;
        snprintf(name, 32, "K%lld.mtx", (long long)out->bodies + 1);
        why = read_matrix(folder, name, &body->stiffness, &present);
        if (present) out->bodies++;
        if (why) return why;
        if (!present) return out->bodies ? NULL : "is missing";
        body->n = body->stiffness.rows;
        body->first = out->unknowns;
        out->unknowns += body->n;
        snprintf(name, 32, "R%lld.mtx", (long long)out->bodies);
        why = read_dense(folder, name, body->n, &body->null_columns, &body->null_space);
        if (why) return why;
    }
}

static fault read_all(const char *folder, case_data *out, char name[32])
{
    struct { const char *name; int64_t n; double **to; } vector[6];
    fault why = read_bodies(folder, out, name);
    int present, k;

    if (why) return why;
    strcpy(name, "B.mtx");
    if ((why = read_matrix(folder, name, &out->contact, &present))) return why;
    strcpy(name, "H.mtx");
    if ((why = read_matrix(folder, name, &out->equality, &present))) return why;
    out->rows = out->contact.rows;
    out->equalities = out->equality.rows;
    vector[0].name = "c.txt", vector[0].n = out->rows, vector[0].to = &out->gap;
    vector[1].name = "h.txt", vector[1].n = out->equalities, vector[1].to = &out->prescribed;
    vector[2].name = "f.txt", vector[2].n = out->unknowns, vector[2].to = &out->load;
    vector[3].name = "u_ref.txt", vector[3].n = out->unknowns, vector[3].to = &out->u_ref;
    vector[4].name = "lambda_ref.txt", vector[4].n = out->rows, vector[4].to = &out->lambda_ref;
    vector[5].name = "mu_ref.txt", vector[5].n = out->equalities, vector[5].to = &out->mu_ref;
    for (k = 0; k < 6; k++) {
        strcpy(name, vector[k].name);
        if ((why = read_vector(folder, name, vector[k].n, vector[k].to))) return why;
    }
    strcpy(name, "dofs.txt");
    if ((why = read_present(folder, name, read_dofs, out))) return why;
    strcpy(name, "elements.txt");
    return read_present(folder, name, read_elements, out);
}

int case_read(const char *folder, case_data *out, char *text, int64_t cap)
{
    char name[32] = "";
    fault why;

    memset(out, 0, sizeof *out);
    why = read_all(folder, out, name);
    if (!why) return 0;
    case_free(out);
    if (cap > 0) snprintf(text, (size_t)cap, "%s/%s %s", folder, name, why);
    return -1;
}

void case_free(case_data *data)
{
    int k;
    for (k = 0; k < CASE_BODIES_MAX; k++) {
        matrix_free(&data->body[k].stiffness);
        free(data->body[k].null_space);
    }
    matrix_free(&data->contact);
    matrix_free(&data->equality);
    free(data->gap);
    free(data->prescribed);
    free(data->load);
    free(data->u_ref);
    free(data->lambda_ref);
    free(data->mu_ref);
    free(data->node);
    free(data->dir);
    free(data->xyz);
    free(data->elements.body);
    free(data->elements.ptr);
    free(data->elements.node);
    memset(data, 0, sizeof *data);
}
