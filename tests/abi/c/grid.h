/* Two bars of springs, one on top of the other: a contact problem of any size, built on the fly.

   Each bar is a grid of WIDE x WIDE x length nodes with one unknown each (the displacement along the bar), neighbours
   joined by springs of stiffness 1. Four nodes of each far end are held by springs to the ground, so both stiffness
   matrices are regular (r = 0): bar 0 says so, bar 1 gives coordinates. Every node of the near end of bar 0 faces one of bar 1: u_0 - u_1 <= gap. */
#ifndef GRID_H
#define GRID_H

#include "check.h"

enum { BARS = 2, WIDE = 12, FACE = WIDE * WIDE };

typedef struct {
    int32_t nodes, entries; /* of one bar; lower triangle by rows */
    int32_t *ptr, *col, *node, *dir;
    double *val, *load, *xyz;
    int32_t row_ptr[FACE + 1], row_body[BARS * FACE], row_dof[BARS * FACE];
    double row_val[BARS * FACE], gap[FACE];
} grid;

grid grid_of(int32_t length);
void grid_free(grid *bars);

/* The calls that hand the grid over and solve it, in order; each returns its status and can be repeated. */
enum { GRID_CALLS = 9 };
int32_t grid_call(const grid *bars, int call, feti_problem **problem);

/* Bits of n numbers, folded into `print`. */
uint64_t grid_folded(uint64_t print, int64_t n, const double *x);

/* Bits of displacements and forces, folded into one number. */
uint64_t grid_fingerprint(const grid *bars, feti_problem *problem);

#endif
