/* The fragments of docs/newton.md in the surroundings that the chapter takes for granted: they compile. */
#include <stddef.h>

#include <feti_contact.h>

int32_t iteration(feti_problem *p, int64_t body, int64_t nnz, const double *val, int64_t n, const double *f, int64_t rows,
                  const int32_t *row_ptr, const int32_t *body_of, const int32_t *dof, const double *val_of_rows,
                  const double *gap, double *lambda, double *d);
int32_t load_step(feti_problem *p, int32_t (*newton)(feti_problem *), double *size);
int32_t soft_motions(feti_problem *p, int64_t body, int64_t n, const double *x, const double *y, double *motion);
int32_t soft_coordinates(feti_problem *p, int64_t body, int32_t dim, int64_t n, const int32_t *node, const int32_t *dir,
                         const double *xyz, int64_t ld);

int32_t iteration(feti_problem *p, int64_t body, int64_t nnz, const double *val, int64_t n, const double *f, int64_t rows,
                  const int32_t *row_ptr, const int32_t *body_of, const int32_t *dof, const double *val_of_rows,
                  const double *gap, double *lambda, double *d)
{
    feti_info info = { .struct_size = sizeof info };
    int32_t status;

#include "fragment_1.inc"
    return status;
}

int32_t load_step(feti_problem *p, int32_t (*newton)(feti_problem *), double *size)
{
    double step = *size;
    int64_t state;
    int32_t status;

#include "fragment_2.inc"
    *size = step;
    return status;
}

int32_t soft_motions(feti_problem *p, int64_t body, int64_t n, const double *x, const double *y, double *motion)
{
    int32_t status;
    int64_t k;

#include "fragment_4.inc"
    return status;
}

int32_t soft_coordinates(feti_problem *p, int64_t body, int32_t dim, int64_t n, const int32_t *node, const int32_t *dir,
                         const double *xyz, int64_t ld)
{
    int32_t status;

#include "fragment_5.inc"
    return status;
}
