/* A contact problem known by hand, and what the drivers of the error paths share.

   spring (body 0): 1 unknown, stiffness 2, held;  block (body 1): 2 unknowns joined by 4, floating;
   row 0: u_spring - u_block[0] <= 1;  load -6 on block[1].
   lambda = 6, u_spring = -3, u_block = (-4, -5.5). */
#ifndef SMALL_H
#define SMALL_H

#include "check.h"

enum { SPRING = 0, BLOCK = 1 };

extern const int32_t SPRING_PTR[2], SPRING_COL[1], BLOCK_PTR[3], BLOCK_COL[3], ROW_PTR[2], ROW_BODY[2], ROW_DOF[2];
extern const double SPRING_VAL[1], BLOCK_VAL[3], BLOCK_MODE[2], BLOCK_LOAD[2], ROW_VAL[2], GAP[1];

/* Everything handed over, nothing solved. */
feti_problem *small_problem(void);

/* The calls of small_problem that correct one thing each; all return the status. */
int32_t give_block_stiffness(feti_problem *problem);
int32_t give_block_mode(feti_problem *problem);
int32_t give_block_load(feti_problem *problem);
int32_t give_row(feti_problem *problem);

/* Solves and compares with the answer by hand. */
void check_small_answer(feti_problem *problem, const char *after);

/* The call's status; where the call took its data, that of the solve that follows. */
int32_t or_solve(feti_problem *problem, int32_t status);

enum { ANY = -2 }; /* a place that may be named or not */

/* What the error detail of the last failure must say. Unset places (0) must be given as ANY or a number. */
typedef struct {
    int32_t status;
    int64_t body, dof, row, entry;
    const char *function;
    const char *says; /* part of the text */
} expectation;

/* The last error of this thread and of the problem name the same place. */
void check_last_error(feti_problem *problem, const expectation *wanted);

#endif
