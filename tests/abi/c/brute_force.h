/* The dual problem (12) by enumeration: every set of rows that may bear a force is tried. */
#ifndef BRUTE_FORCE_H
#define BRUTE_FORCE_H

#include <stdint.h>

/* min 1/2 l'Fl - l'd over l >= 0, G l = e; F is m x m, G is r x m, both column-major, m <= 14. Every
   l that satisfies the conditions of (12) is counted; the last of them is returned in l, and *spread is the largest
   difference between any two. */
int64_t brute_force(int64_t m, int64_t r, const double *F, const double *d, const double *G, const double *e,
                    double *l, double *spread);

#endif
