/* From the rows of a case to its nodes, for pictures. */
#include <math.h>
#include <stdlib.h>

#include "picture.h"

static int64_t body_of(const case_data *data, int64_t unknown)
{
    int64_t b = data->bodies - 1;
    while (data->body[b].first > unknown) b--;
    return b;
}

/* First and last body of a row. */
typedef struct {
    int64_t low, high;
} pair;

static pair pair_of(const case_data *data, int64_t row)
{
    pair bodies = { data->bodies, -1 };
    for (int32_t e = data->contact.row_ptr[row]; e < data->contact.row_ptr[row + 1]; e++) {
        const int64_t body = body_of(data, data->contact.col[e]);
        if (body < bodies.low) bodies.low = body;
        if (body > bodies.high) bodies.high = body;
    }
    return bodies;
}

/* The node of a body in a row, -1 if the row has several; the force on it over that of the row. */
static int64_t node_of(const case_data *data, int64_t dims, int64_t row, int64_t body, double *factor)
{
    double square = 0.0;
    int64_t node = -1;
    for (int32_t e = data->contact.row_ptr[row]; e < data->contact.row_ptr[row + 1]; e++) {
        const int64_t unknown = data->contact.col[e];
        if (body_of(data, unknown) != body) continue;
        if (node >= 0 && node != unknown / dims) return -1;
        node = unknown / dims, square += data->contact.val[e] * data->contact.val[e];
    }
    *factor = sqrt(square);
    return node;
}

/* Rows join a node of one body with a face of another: the body that has one node only in every row of the pair. */
static int64_t body_of_nodes(const case_data *data, int64_t dims, pair bodies)
{
    double factor;
    for (int64_t row = 0; row < data->rows; row++) {
        const pair other = pair_of(data, row);
        if (other.low == bodies.low && other.high == bodies.high && node_of(data, dims, row, bodies.low, &factor) < 0)
            return bodies.high;
    }
    return bodies.low;
}

/* The elements of the case, by the names that VTK has for them. */
static picture_grid elements_of(const case_data *data, int64_t dims, int32_t *numbers, const double *xyz)
{
    const case_elements *all = &data->elements;
    int32_t *type = numbers, *body = numbers + all->count;
    for (int64_t e = 0; e < all->count; e++) {
        const int64_t nodes = all->ptr[e + 1] - all->ptr[e];
        type[e] = nodes == 4 ? PICTURE_QUAD : nodes == 8 ? PICTURE_HEXAHEDRON
                : nodes == 10 ? PICTURE_TETRAHEDRON10 : PICTURE_HEXAHEDRON20;
        body[e] = all->body[e] + 1;
    }
    const picture_grid grid = { data->unknowns / dims, all->count, xyz, all->ptr, all->node, type, body };
    return grid;
}

int picture_case(const char *folder, const char *name, const case_data *data, double shear_modulus, const double *u,
                 const double *force, const double *lambda, const double *slack, const int32_t *state)
{
    const int64_t dims = data->unknowns > 2 && data->dir[2] == 3 ? 3 : 2, nodes = data->unknowns / dims;
    double *values = calloc((size_t)(12 * nodes), sizeof *values);
    int32_t *numbers = malloc((size_t)(2 * data->elements.count + 1) * sizeof *numbers);
    int status = -1;

    if (values && numbers) {
        double *xyz = values, *moved = values + 3 * nodes, *pushed = values + 6 * nodes;
        double *push = values + 9 * nodes, *gap = values + 10 * nodes, *of_row = values + 11 * nodes;
        const picture_answer answer = { moved, pushed, push, gap, of_row, NULL, shear_modulus, 0.0, 0 };
        const picture_grid grid = elements_of(data, dims, numbers, xyz);

        for (int64_t i = 0; i < nodes; i++) {
            gap[i] = NAN, of_row[i] = -1.0;
            for (int64_t k = 0; k < 3; k++) xyz[3 * i + k] = data->xyz[3 * dims * i + k];
            for (int64_t k = 0; k < dims; k++) moved[3 * i + k] = u[dims * i + k], pushed[3 * i + k] = force[dims * i + k];
        }
        for (int64_t r = 0; r < data->rows; r++) {
            double factor;
            const int64_t node = node_of(data, dims, r, body_of_nodes(data, dims, pair_of(data, r)), &factor);
            if (node >= 0) push[node] = lambda[r] * factor, gap[node] = slack[r], of_row[node] = state[r];
        }
        status = picture_mesh(folder, name, &grid, &answer);
    }
    free(values);
    free(numbers);
    return status;
}
