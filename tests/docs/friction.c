/* The fragments about friction of docs/newton.md and docs/friction.md in the surroundings that the chapters take for granted: they
   compile. */
#include <stddef.h>

#include <feti_contact.h>

/* Rows of a kind, as for feti_rows_add_i32. */
typedef struct {
    const int32_t *ptr, *body, *dof;
    const double *val;
} rows_given;

int32_t turned(feti_problem *p, int32_t dim, int64_t rows, rows_given normal, rows_given tangential, const int32_t *normal_row,
               const double *gap, const double *coefficient, const double *s_begin, const double *s_k, double *s_old,
               const double *lambda, const double *lambda_t);
int32_t load_steps(feti_problem *p, int64_t body, int64_t n, const double *load, int steps, int32_t dim, int64_t nodes,
                   rows_given normal, rows_given tangential, int32_t *normal_row, double mu, double *coefficient,
                   const double *gap, double *lambda_t, double *slip);

int32_t turned(feti_problem *p, int32_t dim, int64_t rows, rows_given normal, rows_given tangential, const int32_t *normal_row,
               const double *gap, const double *coefficient, const double *s_begin, const double *s_k, double *s_old,
               const double *lambda, const double *lambda_t)
{
    const int32_t *row_ptr = normal.ptr, *body_of = normal.body, *dof = normal.dof;
    const int32_t *t_ptr = tangential.ptr, *t_body = tangential.body, *t_dof = tangential.dof;
    const double *val_of_rows = normal.val, *t_val = tangential.val;
    feti_info info = { .struct_size = sizeof info };
    int32_t status;
    int64_t k;

#include "fragment_6.inc"
    return status;
}

int32_t load_steps(feti_problem *p, int64_t body, int64_t n, const double *load, int steps, int32_t dim, int64_t nodes,
                   rows_given normal, rows_given tangential, int32_t *normal_row, double mu, double *coefficient,
                   const double *gap, double *lambda_t, double *slip)
{
    const int32_t *n_ptr = normal.ptr, *n_body = normal.body, *n_dof = normal.dof;
    const int32_t *t_ptr = tangential.ptr, *t_body = tangential.body, *t_dof = tangential.dof;
    const double *n_val = normal.val, *t_val = tangential.val;
    feti_info info = { .struct_size = sizeof info };
    int64_t k, first;
    int32_t status;
    int step;

#include "fragment_7.inc"
    return status;
}
