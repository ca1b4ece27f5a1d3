#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "picture.h"

/* VTK cell types by number of nodes: vertex, quadrilateral, hexahedron, quadratic hexahedron. */
static int cell_type(int64_t nodes)
{
    return nodes == 20 ? 25 : nodes == 8 ? 12 : nodes == 4 ? 9 : 1;
}

static void array_begin(FILE *file, const char *type, const char *name, int components)
{
    fprintf(file, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", type, name, components);
}

static void array_end(FILE *file)
{
    fprintf(file, "</DataArray>\n");
}

static void write_doubles(FILE *file, const char *name, int components, int64_t n, const double *values)
{
    array_begin(file, "Float64", name, components);
    for (int64_t i = 0; i < n; i++)
        for (int k = 0; k < components; k++) {
            const double x = values[components * i + k];
            const char *end = k + 1 < components ? " " : "\n";
            if (isnan(x)) fprintf(file, "nan%s", end);
            else fprintf(file, "%.9g%s", x, end);
        }
    array_end(file);
}

static void write_cells(FILE *file, const picture_grid *grid)
{
    fprintf(file, "<Cells>\n");
    array_begin(file, "Int64", "connectivity", 1);
    for (int64_t c = 0; c < grid->cells; c++)
        for (int64_t k = grid->offset[c]; k < grid->offset[c + 1]; k++)
            fprintf(file, "%lld%c", (long long)grid->corner[k], k + 1 < grid->offset[c + 1] ? ' ' : '\n');
    array_end(file);
    array_begin(file, "Int64", "offsets", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%lld\n", (long long)grid->offset[c + 1]);
    array_end(file);
    array_begin(file, "UInt8", "types", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%d\n", cell_type(grid->offset[c + 1] - grid->offset[c]));
    array_end(file);
    fprintf(file, "</Cells>\n");
}

int picture_vtu(const char *folder, const char *name, const picture_grid *grid)
{
    char path[1024];
    FILE *file;

    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "w");
    if (!file) return -1;
    fprintf(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n<Points>\n",
            (long long)grid->nodes, (long long)grid->cells);
    write_doubles(file, "Points", 3, grid->nodes, grid->xyz);
    fprintf(file, "</Points>\n");
    write_cells(file, grid);
    fprintf(file, "<PointData>\n");
    for (int f = 0; f < grid->fields; f++) {
        const picture_field *field = &grid->field[f];
        if (!field->is_whole) {
            write_doubles(file, field->name, field->components, grid->nodes, field->values);
            continue;
        }
        array_begin(file, "Int32", field->name, field->components);
        for (int64_t i = 0; i < field->components * grid->nodes; i++) fprintf(file, "%d\n", (int)field->values[i]);
        array_end(file);
    }
    fprintf(file, "</PointData>\n<CellData>\n");
    array_begin(file, "Int32", "body", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%d\n", (int)grid->body[c]);
    array_end(file);
    fprintf(file, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    if (fclose(file) != 0) return -1;
    printf("picture %s\n", path);
    return 0;
}

/* Three components per node, the third 0 in the plane. */
static void in_space(int64_t nodes, int32_t dims, const double *from, double *to)
{
    for (int64_t i = 0; i < nodes; i++)
        for (int k = 0; k < 3; k++) to[3 * i + k] = k < dims ? from[dims * i + k] : 0.0;
}

/* The cells of all bodies over the nodes of all bodies. */
static void join(const case_data *data, int32_t dims, const picture_mesh *mesh, int64_t *offset, int64_t *corner, int64_t *number)
{
    int64_t cell = 0;

    offset[0] = 0;
    for (int64_t b = 0; b < data->bodies; b++)
        for (int64_t c = 0; c < mesh[b].cells; c++, cell++) {
            for (int64_t k = 0; k < mesh[b].corners; k++)
                corner[offset[cell] + k] = data->body[b].first / dims + mesh[b].corner[mesh[b].corners * c + k];
            offset[cell + 1] = offset[cell] + mesh[b].corners;
            number[cell] = b + 1;
        }
}

int picture_case(const char *folder, const char *name, const case_data *data, int32_t dims, const picture_mesh *mesh,
                 const double *u, const double *force, const picture_contact *contact)
{
    const int64_t nodes = data->unknowns / dims;
    int64_t cells = 0, corners = 0;
    int status = -1;

    for (int64_t b = 0; b < data->bodies; b++) cells += mesh[b].cells, corners += mesh[b].cells * mesh[b].corners;
    double *vectors = malloc((size_t)(9 * nodes) * sizeof *vectors);
    int64_t *numbers = malloc((size_t)(2 * cells + 1 + corners) * sizeof *numbers);
    if (vectors && numbers) {
        double *xyz = vectors, *moved = vectors + 3 * nodes, *pushed = vectors + 6 * nodes;
        int64_t *offset = numbers, *number = numbers + cells + 1, *corner = numbers + 2 * cells + 1;
        const picture_field field[] = { { "displacement", 3, 0, moved }, { "contact_force", 3, 0, pushed },
                                        { "pressure", 1, 0, contact->pressure }, { "gap", 1, 0, contact->gap },
                                        { "contact", 1, 1, contact->state } };
        const picture_grid grid = { nodes, cells, xyz, offset, corner, number, 5, field };
        for (int64_t i = 0; i < nodes; i++)
            for (int k = 0; k < 3; k++) xyz[3 * i + k] = data->xyz[3 * dims * i + k];
        in_space(nodes, dims, u, moved);
        in_space(nodes, dims, force, pushed);
        join(data, dims, mesh, offset, corner, number);
        status = picture_vtu(folder, name, &grid);
    }
    free(vectors);
    free(numbers);
    return status;
}
