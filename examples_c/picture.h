/* Pictures of the answer: an SVG plot of points against a curve, and a VTK XML file that ParaView opens. */
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
    const double *curve_x, *curve_y; /* samples; NaN: the next curve begins after it */
} picture;

/* Writes folder/name and prints "picture folder/name". Returns 0, or -1 when the file cannot be written. */
int picture_svg(const char *folder, const char *name, const picture *plot);

/* The cells of a body over its own nodes, counted from 0 within the body. */
typedef struct {
    int64_t cells, corners; /* nodes per cell: 1 point, 4 quadrilateral, 8 or 20 hexahedron */
    int64_t *corner;        /* corners x cells, column-major */
} picture_mesh;

/* Quadrilaterals of a body whose nodes run line after line, each line at one x from bottom to top. */
int picture_quads(const case_data *data, const case_body *body, int32_t dims, picture_mesh *mesh);

/* Hexahedra of a body whose nodes lie on a lattice of planes x = const, y = const, z = const, of which every
   `stride`-th carries corners (2 for elements with mid-side nodes). A body without such cells comes as points. */
int picture_hexahedra(const case_data *data, const case_body *body, int64_t stride, picture_mesh *mesh);

void picture_mesh_free(picture_mesh *mesh);

/* Contact results at the nodes: every row belongs to one node, that of the body which has only one node in it. */
typedef struct {
    double *pressure; /* force of the row over the area (in the plane: length) that belongs to the node; 0 without a row */
    double *gap;      /* open gap, length; NaN without a row */
    double *state;    /* FETI_ROW_OPEN, _CLOSED, _WEAK, _UNKNOWN; -1 without a row */
} picture_contact;

/* From the answer: lambda (force), slack (gap, length) and state of every contact row. Returns 0, or -1 on failure. */
int picture_contact_of(const case_data *data, int32_t dims, const double *lambda, const double *slack, const int32_t *state,
                       picture_contact *out);
void picture_contact_free(picture_contact *contact);

/* Numbers of every node. */
typedef struct {
    const char *name;
    int components, is_whole; /* 1 or 3; 1: whole numbers */
    const double *values;     /* components x nodes */
} picture_field;

/* An unstructured grid. Cell c has the nodes corner[offset[c]] to corner[offset[c + 1] - 1], counted from 0. */
typedef struct {
    int64_t nodes, cells;
    const double *xyz;              /* 3 x nodes, length, undeformed */
    const int64_t *offset, *corner; /* cells + 1, offset[cells] */
    const int64_t *body;            /* cells: number of the body, from 1 */
    int fields;
    const picture_field *field;
} picture_grid;

/* Writes folder/name as VTK XML (.vtu, ASCII), which ParaView opens ("Warp By Vector" deforms it), and prints
   "picture folder/name". Returns 0, or -1 on failure. */
int picture_vtu(const char *folder, const char *name, const picture_grid *grid);

/* Writes the bodies of a case as picture_vtu does: cells, displacement u and contact force on every node as vectors (dims unknowns
   per node, node by node), pressure, gap and contact state. */
int picture_case(const char *folder, const char *name, const case_data *data, int32_t dims, const picture_mesh *mesh,
                 const double *u, const double *force, const picture_contact *contact);

#endif
