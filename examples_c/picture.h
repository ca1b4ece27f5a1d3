/* Pictures of the answer: an SVG plot of points against curves, and VTK XML files that ParaView opens. */
#ifndef PICTURE_H
#define PICTURE_H

#include <stdint.h>
#include <stdio.h>

#include "case_reader.h"

/* One plot: points and curves over the same x, title, axis names with their units. Behind a NaN the next curve begins, and the
   next points; each curve and its points have a colour of their own. */
typedef struct {
    const char *title, *x_name, *y_name, *points_name, *curve_name;
    int64_t points, samples;
    const double *x, *y;             /* points */
    const double *curve_x, *curve_y; /* samples */
    const char *const *names;        /* of the curves, for the legend, one for each; NULL where there is one curve */
} picture;

/* Writes folder/name and prints "picture folder/name". Returns 0, or -1 when the file cannot be written. */
int picture_svg(const char *folder, const char *name, const picture *plot);

enum { PICTURE_LINE = 3, PICTURE_QUAD = 9, PICTURE_HEXAHEDRON = 12, PICTURE_TRIANGLE6 = 22, PICTURE_QUAD8 = 23,
       PICTURE_TETRAHEDRON10 = 24, PICTURE_HEXAHEDRON20 = 25 }; /* the numbers that VTK has for them */

/* The cells of all bodies. Cell c has the nodes corner[offset[c]] to corner[offset[c + 1] - 1], counted from 0. */
typedef struct {
    int64_t nodes, cells;
    const double *xyz;              /* 3 x nodes, length, undeformed */
    const int64_t *offset, *corner; /* cells + 1, offset[cells]: in the order of VTK */
    const int32_t *type, *body;     /* cells: PICTURE_QUAD .., number of the body from 1 */
} picture_grid;

/* Numbers of every node or of every cell. */
typedef struct {
    const char *name;
    int of_cells, components, is_whole; /* 1: of cells, otherwise of nodes; 1 or 3; 1: whole numbers */
    const double *values;               /* components x nodes or cells */
} picture_field;

/* Writes folder/name as VTK XML (.vtu, ASCII), which ParaView opens ("Warp By Vector" deforms it), and prints
   "picture folder/name". Returns 0, or -1 on failure. */
int picture_vtu(const char *folder, const char *name, const picture_grid *grid, int fields, const picture_field *field);

/* Writes folder/stem.pvd, which ParaView opens as a film of stem_0.vtu, stem_1.vtu, .. at the times 0, 1, .. */
int picture_pvd(const char *folder, const char *stem, int steps);

/* What a solve has come to, for all bodies. */
typedef struct {
    const double *u, *force;          /* 3 x nodes: displacement, length; contact force */
    const double *push, *gap, *state; /* nodes: force and gap of the row at the node, FETI_ROW_OPEN, ..; -1, NaN without a row */
    const double *piece;              /* cells: the piece of a body that is cut; NULL: no body is */
    double shear_modulus, lame;       /* shear_modulus 0: no stress is written */
    int large;                        /* 1: large displacements of St. Venant and Kirchhoff's material; areas are those of displaced faces */
} picture_answer;

/* Writes elements and, as cells of their own, those of their faces that may touch, all of whose nodes have a row. Numbers of
   cells: body, piece, von Mises stress of elements, contact pressure of faces; of nodes: displacement, contact_force, gap, contact
   (the state of the row). */
int picture_mesh(const char *folder, const char *name, const picture_grid *elements, const picture_answer *answer);

/* Quadrilaterals in the plane with large displacements. */
typedef struct {
    int64_t nodes, cells, first;      /* the first cells are body 1, the others body 2 */
    const int32_t *corner;            /* 4 x cells, nodes from 0 */
    const double *x, *u, *force;      /* 2 x nodes: at rest, displacement, length; contact force */
    const double *push, *gap, *state; /* nodes */
    double shear_modulus, lame;
} picture_plane;

/* The same for a step of a film: folder/stem_step.vtu. */
int picture_step(const char *folder, const char *stem, int step, const picture_plane *plane);

/* The same from a case with its rows: u and contact force by unknowns; lambda (force), slack (gap, length) and state of every row. */
int picture_case(const char *folder, const char *name, const case_data *data, double shear_modulus, const double *u,
                 const double *force, const double *lambda, const double *slack, const int32_t *state);

#endif
