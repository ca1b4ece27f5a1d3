/* K+ of a symmetric matrix by SPOOLES, for functions of the host. */
#ifndef FACTOR_H
#define FACTOR_H

#include <stdint.h>

/* The upper triangle of K by rows: entries val, force per length, at columns col, ascending. */
typedef struct {
    int n;
    int *ptr, *col;
    double *val;
} matrix;

typedef struct factor factor;

/* L D L' of K with these unknowns held: their rows and columns are those of the identity. Ends the program if SPOOLES fails. */
factor *factor_new(const matrix *k, const int *held, int holds);

/* Y = K+ X, n x nrhs, columns ldx and ldy apart: 0 where unknowns are held. */
void factor_solve(factor *f, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy);

void factor_free(factor *f);

#endif
