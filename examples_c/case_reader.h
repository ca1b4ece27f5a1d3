/* Reader for the case folders: the data a host code would have in its own arrays.

   A folder holds plain text (`make data` unpacks it):
     K1.mtx K2.mtx ...   stiffness of each body, MatrixMarket, symmetric: lower triangle, or general
     R1.mtx ...          null-space basis of that body, n x r; absent where K is not singular
     B.mtx c.txt         contact rows   B u <= c     (lengths)
     H.mtx h.txt         equality rows  H u  = h     (absent: none)
     f.txt               loads (forces), bodies one after the other
     u_ref.txt lambda_ref.txt mu_ref.txt             the solution, where known
     dofs.txt            node, direction, x, y, z of every unknown, where known
     elements.txt        body and nodes of every element, where known; pictures alone need them */
#ifndef CASE_READER_H
#define CASE_READER_H

#include <stdint.h>

enum { CASE_BODIES_MAX = 8 };

/* Sparse matrix by rows, everything counted from 0:
   row i holds the entries row_ptr[i] .. row_ptr[i+1]-1 of col and val. */
typedef struct {
    int64_t rows, cols, entries;
    int32_t *row_ptr; /* rows + 1 */
    int32_t *col;     /* entries  */
    double *val;      /* entries  */
    int symmetric;    /* 1: only the lower triangle is stored (FETI_LOWER) */
} case_matrix;

/* One body: n unknowns, unknown i of the body is unknown first + i of the whole. */
typedef struct {
    int64_t n, first;
    case_matrix stiffness; /* n x n */
    int64_t null_columns;  /* r: 0 where R is absent */
    double *null_space;    /* n x r, column-major, NULL where r = 0 */
} case_body;

/* The elements: number e, of body body[e] from 0, has the nodes node[ptr[e]] .. node[ptr[e+1]-1], counted from 0
   through all bodies in the order of VTK. */
typedef struct {
    int64_t count;
    int32_t *body;       /* count */
    int64_t *ptr, *node; /* count + 1, ptr[count] */
} case_elements;

/* A whole case. An absent file leaves NULL and a size of 0. */
typedef struct {
    int64_t bodies, unknowns, rows, equalities;
    case_body body[CASE_BODIES_MAX];
    case_matrix contact;    /* B, rows x unknowns */
    case_matrix equality;   /* H, equalities x unknowns */
    double *gap;            /* c, rows: length */
    double *prescribed;     /* h, equalities: length */
    double *load;           /* f, unknowns: force */
    double *u_ref;          /* unknowns: length */
    double *lambda_ref;     /* rows: force */
    double *mu_ref;         /* equalities: force */
    int32_t *node, *dir;    /* unknowns: node label, direction 1 to 3 */
    double *xyz;            /* 3 x unknowns, column-major: xyz[k + 3 i] */
    case_elements elements;
} case_data;

/* Reads the folder into *out. Returns 0; on failure a message in text[0..cap) and -1, and *out is empty. */
int case_read(const char *folder, case_data *out, char *text, int64_t cap);

/* Gives the memory back and empties *data. An empty case is left as it is. */
void case_free(case_data *data);

#endif
