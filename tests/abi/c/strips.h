/* Two strips of nodes in the plane, each unknown on a spring to the ground and joined to that of the next node: the upper strip is the slave
   of the lower one, with friction, and of a rigid circle. For drivers that repeat each call of a load step until it succeeds. */
#ifndef STRIPS_H
#define STRIPS_H

#include "check.h"

enum { STRIP = 20, STRIP_DOFS = 2 * STRIP };

typedef struct {
    double x[2][STRIP_DOFS], moved[STRIP_DOFS], val[2 * STRIP_DOFS], load[STRIP_DOFS], pressure[STRIP];
    int32_t ptr[STRIP_DOFS + 1], col[2 * STRIP_DOFS], dof[STRIP_DOFS], lines[2][2 * (STRIP - 1)];
    feti_pair_facts facts;
} strips;

void strips_make(strips *all);

/* The calls of two load steps, in order; each returns its status and can be repeated. */
enum { STRIPS_CALLS = 23 };
int32_t strips_call(strips *all, int call, feti_problem **problem);

#endif
