#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "picture.h"

static const double *node_xyz(const case_data *data, const case_body *body, int32_t dims, int64_t node)
{
    return data->xyz + 3 * (body->first + dims * node);
}

static int mesh_begin(picture_mesh *mesh, int64_t corners, int64_t cells_at_most)
{
    mesh->cells = 0;
    mesh->corners = corners;
    mesh->corner = malloc((size_t)(corners * cells_at_most + 1) * sizeof *mesh->corner);
    return mesh->corner ? 0 : -1;
}

void picture_mesh_free(picture_mesh *mesh)
{
    free(mesh->corner);
    mesh->corner = NULL;
    mesh->cells = 0;
}

/* Every node a cell of its own. */
static int points(const case_body *body, int32_t dims, picture_mesh *mesh)
{
    if (mesh_begin(mesh, 1, body->n / dims) != 0) return -1;
    for (; mesh->cells < body->n / dims; mesh->cells++) mesh->corner[mesh->cells] = mesh->cells;
    return 0;
}

int picture_quads(const case_data *data, const case_body *body, int32_t dims, picture_mesh *mesh)
{
    const int64_t nodes = body->n / dims;
    int64_t line = 1, i, j;

    while (line < nodes && node_xyz(data, body, dims, line)[0] == node_xyz(data, body, dims, 0)[0]) line++;
    if (line < 2 || nodes % line != 0) return points(body, dims, mesh);
    if (mesh_begin(mesh, 4, nodes) != 0) return -1;
    for (i = 0; i + 1 < nodes / line; i++)
        for (j = 0; j + 1 < line; j++) {
            int64_t *q = mesh->corner + 4 * mesh->cells++;
            q[0] = i * line + j;
            q[1] = q[0] + line;
            q[2] = q[1] + 1;
            q[3] = q[0] + 1;
        }
    return 0;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The lattice planes of one direction: sorted coordinates without repetition. Coordinates of one plane differ by at most
   `tolerance`, 1e-6 of the body's length along the axis. */
typedef struct {
    int64_t planes;
    double *at, tolerance;
} axis;

static int axis_planes(const case_data *data, const case_body *body, int k, axis *out)
{
    const int64_t nodes = body->n / 3;
    out->planes = 0;
    out->at = malloc((size_t)nodes * sizeof *out->at);
    if (!out->at) return -1;
    for (int64_t i = 0; i < nodes; i++) out->at[i] = node_xyz(data, body, 3, i)[k];
    qsort(out->at, (size_t)nodes, sizeof *out->at, ascending);
    out->tolerance = 1e-6 * (out->at[nodes - 1] - out->at[0]);
    for (int64_t i = 0; i < nodes; i++)
        if (out->planes == 0 || out->at[i] > out->at[out->planes - 1] + out->tolerance) out->at[out->planes++] = out->at[i];
    return 0;
}

static int64_t plane_of(const axis *direction, double x)
{
    int64_t low = 0, high = direction->planes - 1;
    while (low < high) {
        const int64_t middle = (low + high) / 2;
        if (x > direction->at[middle] + direction->tolerance) low = middle + 1;
        else high = middle;
    }
    return low;
}

/* Takes every cell of the lattice whose nodes are all there; node[] holds -1 where there is none. The order is that of VTK: corners
   around the bottom and the top; then, where every other plane has mid-side nodes alone, the edges around both and those between. */
static void lattice_cells(const axis way[3], const int64_t *node, int64_t stride, picture_mesh *mesh)
{
    static const int half[20][3] = { { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 }, { 0, 0, 2 }, { 2, 0, 2 }, { 2, 2, 2 },
                                     { 0, 2, 2 }, { 1, 0, 0 }, { 2, 1, 0 }, { 1, 2, 0 }, { 0, 1, 0 }, { 1, 0, 2 }, { 2, 1, 2 },
                                     { 1, 2, 2 }, { 0, 1, 2 }, { 0, 0, 1 }, { 2, 0, 1 }, { 2, 2, 1 }, { 0, 2, 1 } };
    for (int64_t i = 0; i + stride < way[0].planes; i += stride)
        for (int64_t j = 0; j + stride < way[1].planes; j += stride)
            for (int64_t k = 0; k + stride < way[2].planes; k += stride) {
                int64_t *cell = mesh->corner + mesh->corners * mesh->cells;
                int complete = 1;
                for (int c = 0; c < mesh->corners; c++) {
                    const int64_t x = i + stride * half[c][0] / 2, y = j + stride * half[c][1] / 2;
                    cell[c] = node[(x * way[1].planes + y) * way[2].planes + k + stride * half[c][2] / 2];
                    complete = complete && cell[c] >= 0;
                }
                mesh->cells += complete;
            }
}

/* The hexahedra of a body on a known lattice; a lattice far larger than the body is none. */
static int lattice_mesh(const case_data *data, const case_body *body, const axis way[3], int64_t stride,
                        picture_mesh *mesh)
{
    const int64_t nodes = body->n / 3, places = way[0].planes * way[1].planes * way[2].planes;
    int64_t *node;

    if (places > 8 * nodes) return points(body, 3, mesh);
    node = malloc((size_t)places * sizeof *node);
    if (!node || mesh_begin(mesh, stride == 2 ? 20 : 8, places) != 0) {
        free(node);
        return -1;
    }
    for (int64_t i = 0; i < places; i++) node[i] = -1;
    for (int64_t i = 0; i < nodes; i++) {
        const double *x = node_xyz(data, body, 3, i);
        node[(plane_of(&way[0], x[0]) * way[1].planes + plane_of(&way[1], x[1])) * way[2].planes +
             plane_of(&way[2], x[2])] = i;
    }
    lattice_cells(way, node, stride, mesh);
    free(node);
    return 0;
}

int picture_hexahedra(const case_data *data, const case_body *body, int64_t stride, picture_mesh *mesh)
{
    axis way[3] = { { 0, NULL, 0.0 }, { 0, NULL, 0.0 }, { 0, NULL, 0.0 } };
    int status = 0;

    for (int k = 0; k < 3 && status == 0; k++) status = axis_planes(data, body, k, &way[k]);
    if (status == 0) status = lattice_mesh(data, body, way, stride, mesh);
    for (int k = 0; k < 3; k++) free(way[k].at);
    return status;
}
