/* CHOLMOD behind three functions that Fortran can call too: the Cholesky factor of a symmetric matrix
   with some unknowns held at 0. */
#ifndef CHOLMOD_SHIM_H
#define CHOLMOD_SHIM_H

#include <stdint.h>

typedef struct shim_factor shim_factor;

/* Factorises K without the rows and columns dof[0..held). K is n x n, its lower triangle by rows, counted
   from base, and so is dof. NULL: CHOLMOD found K not positive definite on the rest, or no memory. */
shim_factor *shim_factorise(int64_t n, const int32_t *row_ptr, const int32_t *col, const double *val, int64_t held,
                            const int64_t *dof, int32_t base);

/* x = S (S' K S)^-1 S' b, S selects what is not held: x is 0 there. b and x may be the same. Returns 0. */
int32_t shim_solve(shim_factor *factor, const double *b, double *x);

void shim_release(shim_factor *factor);

#endif
