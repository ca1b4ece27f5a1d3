/* Pictures of the answer: an SVG plot of points against a curve, and a VTK file that ParaView opens. */
#ifndef PICTURE_H
#define PICTURE_H

#include <stdint.h>
#include <stdio.h>

#include "case_reader.h"

/* One picture: points and a curve over the same x, title, legend, axis names with their units. */
typedef struct {
    const char *title, *x_name, *y_name, *points_name, *curve_name;
    int64_t points, samples;
    const double *x, *y;             /* points */
    const double *curve_x, *curve_y; /* samples; NaN: another curve begins behind it */
} picture;

/* Writes folder/name and prints "picture folder/name". Returns 0, or -1 when the file cannot be written. */
int picture_svg(const char *folder, const char *name, const picture *plot);

/* The cells of a body over its own nodes, counted from 0 within the body. */
typedef struct {
    int64_t cells, corners; /* corners per cell: 1 point, 4 quadrilateral, 8 hexahedron */
    int64_t *corner;        /* corners x cells, column-major */
} picture_mesh;

/* Quadrilaterals of a body whose nodes run line after line, each line at one x from bottom to top. */
int picture_quads(const case_data *data, const case_body *body, int32_t dims, picture_mesh *mesh);

/* Hexahedra of a body whose corner nodes lie on a lattice of planes x = const, y = const, z = const, of which
   every `stride`-th carries corners (2 for elements with mid-side nodes). A body without such cells comes
   as points. */
int picture_hexahedra(const case_data *data, const case_body *body, int64_t stride, picture_mesh *mesh);

void picture_mesh_free(picture_mesh *mesh);

/* Writes folder/name as legacy VTK (ASCII, unstructured grid) and prints "picture folder/name": points
   at xyz + u (dims unknowns per node, node by node), displacement u and force on the node as vectors
   (force = contact force), number of the body as a cell field. Returns 0, or -1 on failure. */
int picture_vtk(const char *folder, const char *name, const case_data *data, int32_t dims,
                const picture_mesh *mesh, const double *u, const double *force);

#endif
