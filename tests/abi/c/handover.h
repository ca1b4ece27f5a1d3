/* Hands a case folder to the library in every form the interface accepts. */
#ifndef HANDOVER_H
#define HANDOVER_H

#include "case_reader.h"
#include "check.h"

enum { NULL_SPACE_EXACT, NULL_SPACE_COORDINATES, NULL_SPACE_FOUND };

/* The form of the hand-over; all zero: full matrix, i32, from 0, exact null spaces. */
typedef struct {
    int32_t storage; /* FETI_FULL, FETI_LOWER, FETI_UPPER */
    int32_t base;    /* 0, 1 */
    int wide;        /* 1: the _i64 functions */
    int dense;       /* 1: feti_body_stiffness_dense */
    int null_space;  /* NULL_SPACE_EXACT, NULL_SPACE_COORDINATES, NULL_SPACE_FOUND: nothing is given */
} form;

/* What the library answers. */
typedef struct {
    feti_info info;
    double *u, *lambda, *mu; /* unknowns, rows, equalities */
} answer;

/* Reads folder/name or ends the driver. */
void read_or_stop(const char *folder, const char *name, case_data *data);

/* A new problem with all bodies, loads and rows of the case. */
feti_problem *handed_over(const case_data *data, const form *how);

/* Solves and fetches; the status is in info.status. Displacements and forces only when it is >= 0. */
answer solved(feti_problem *problem, const case_data *data);
void answer_free(answer *result);

/* Compares with the solution of the case: max|dlambda| <= 1e-7 max|lambda_ref| and, where u is unique,
   max|du| <= 1e-8 max|u_ref|. */
void check_forces(const char *name, const case_data *data, const answer *result);
void check_displacements(const char *name, const case_data *data, const answer *result);

/* y = A x, and y = y + s A'x, for a matrix of the case (a symmetric one is expanded). */
void multiply(const case_matrix *a, const double *x, double *y);
void add_transposed(const case_matrix *a, double s, const double *x, double *y);

/* The symmetric matrix stored as its upper triangle, or in full, from its lower triangle. */
case_matrix upper_of(const case_matrix *lower);
case_matrix full_of(const case_matrix *lower);
void matrix_release(case_matrix *matrix);

/* The same case with the supported unknowns (one entry per row of H, h = 0) struck out of K, B, f, u_ref
   and dofs; no equality rows and no null spaces remain. kept[i] is the old number of the new unknown i. */
void strike_supports(const case_data *data, case_data *out, int64_t **kept);

#endif
