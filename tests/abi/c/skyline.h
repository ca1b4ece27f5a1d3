/* A host's own factorisation: Cholesky of a symmetric matrix by rows, each from its first entry on, some unknowns held. */
#ifndef SKYLINE_H
#define SKYLINE_H

#include "handover.h"

typedef struct {
    int64_t n, *first, *begin; /* row i: columns first[i] .. i, at value[begin[i]] on */
    double *value;
    char *held;
} skyline;

/* Of a body of a case; as many unknowns are held as its null space has columns. */
skyline skyline_of(const case_body *body);

/* x <- K+ x: 0 for the unknowns held. */
void skyline_solve(const skyline *factor, double *x);
void skyline_free(skyline *factor);

#endif
