/* VTK XML files, as text. */
#include <math.h>
#include <stdio.h>

#include "picture.h"

static void array_begin(FILE *file, const char *type, const char *name, int components)
{
    fprintf(file, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", type, name, components);
}

static void write_numbers(FILE *file, const char *name, int components, int is_whole, int64_t n, const double *values)
{
    array_begin(file, is_whole ? "Int32" : "Float64", name, components);
    for (int64_t i = 0; i < components * n; i++) {
        const char end = (i + 1) % components ? ' ' : '\n';
        if (is_whole) fprintf(file, "%d%c", (int)values[i], end);
        else if (isnan(values[i])) fprintf(file, "nan%c", end);
        else fprintf(file, "%.9g%c", values[i], end);
    }
    fprintf(file, "</DataArray>\n");
}

static void write_cells(FILE *file, const picture_grid *grid)
{
    fprintf(file, "<Cells>\n");
    array_begin(file, "Int64", "connectivity", 1);
    for (int64_t c = 0; c < grid->cells; c++)
        for (int64_t k = grid->offset[c]; k < grid->offset[c + 1]; k++)
            fprintf(file, "%lld%c", (long long)grid->corner[k], k + 1 < grid->offset[c + 1] ? ' ' : '\n');
    fprintf(file, "</DataArray>\n");
    array_begin(file, "Int64", "offsets", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%lld\n", (long long)grid->offset[c + 1]);
    fprintf(file, "</DataArray>\n");
    array_begin(file, "UInt8", "types", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%d\n", (int)grid->type[c]);
    fprintf(file, "</DataArray>\n</Cells>\n");
}

static void write_fields(FILE *file, const picture_grid *grid, int of_cells, int fields, const picture_field *field)
{
    for (int f = 0; f < fields; f++)
        if (field[f].of_cells == of_cells)
            write_numbers(file, field[f].name, field[f].components, field[f].is_whole, of_cells ? grid->cells : grid->nodes,
                          field[f].values);
}

/* Opens folder/name.ending for writing and prints its name. */
static FILE *begin(const char *folder, const char *name, const char *ending)
{
    char path[1024];

    snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
    FILE *file = fopen(path, "w");
    if (file) printf("picture %s\n", path);
    return file;
}

int picture_vtu(const char *folder, const char *name, const picture_grid *grid, int fields, const picture_field *field)
{
    FILE *file = begin(folder, name, "");

    if (!file) return -1;
    fprintf(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n<Points>\n",
            (long long)grid->nodes, (long long)grid->cells);
    write_numbers(file, "Points", 3, 0, grid->nodes, grid->xyz);
    fprintf(file, "</Points>\n");
    write_cells(file, grid);
    fprintf(file, "<PointData>\n");
    write_fields(file, grid, 0, fields, field);
    fprintf(file, "</PointData>\n<CellData>\n");
    array_begin(file, "Int32", "body", 1);
    for (int64_t c = 0; c < grid->cells; c++) fprintf(file, "%d\n", (int)grid->body[c]);
    fprintf(file, "</DataArray>\n");
    write_fields(file, grid, 1, fields, field);
    fprintf(file, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    return fclose(file) == 0 ? 0 : -1;
}

int picture_pvd(const char *folder, const char *stem, int steps)
{
    FILE *file = begin(folder, stem, ".pvd");

    if (!file) return -1;
    fprintf(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
    for (int step = 0; step < steps; step++)
        fprintf(file, "<DataSet timestep=\"%d\" file=\"%s_%d.vtu\"/>\n", step, stem, step);
    fprintf(file, "</Collection>\n</VTKFile>\n");
    return fclose(file) == 0 ? 0 : -1;
}
