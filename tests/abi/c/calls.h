/* Every function of the header as a row of a table, with right arguments and with each of them wrong in every way.
   The table is generated from the sources of the header (tools/bindgen, --calls); what it stands on is in calls.c.

   body 0: u0, u1, stiffness (6 -4; -4 4), held;  body 1: u0, u1 joined by 4, floating, load -6 on u1
   inequality rows: u(0,1) - u(1,0) <= 1, u(0,0) - u(1,0) <= 5;  equality row: u(0,0) - u(0,1) = 0.25 */
#ifndef CALLS_H
#define CALLS_H

#include "check.h"

/* Numbers that every array of a call has room for. */
enum { ROOM = 16 };
/* As a fault: nothing is wrong, but the struct is that of give_record. */
enum { GIVEN_RECORD = -1 };

typedef struct {
    const char *what;
    int32_t status;
} fault;

typedef struct {
    const char *name;
    size_t offset, size;
} field;

enum { TAKES_HANDLE = 1, HAS_STATUS = 2, WRITES_ANYWAY = 4, NEVER_BUSY = 8, KEEPS_ERROR = 16 };

typedef struct {
    const char *name;
    int32_t (*call)(feti_problem *p, int fault); /* 0: every argument is right; k: faults[k - 1] */
    const fault *faults;
    int fault_count, flags;
    size_t record_size; /* 0, or size and fields of its struct with struct_size */
    const field *fields;
} function;

extern const function FUNCTIONS[];
extern const int FUNCTION_COUNT;
/* The functions with one of the flags. */
#define FOR_EACH(f, flag) \
    for (const function *f = FUNCTIONS; f < FUNCTIONS + FUNCTION_COUNT; f++) \
        if (f->flags & (flag))

/* A file that may be written, and that feti_problem_read finds a problem in. */
#define FILE_OF_CALLS "calls.feti"

/* ---- for the generated calls */

void *patterned(void *memory, size_t size);                                   /* filled with a pattern */
void forget(void);                                                            /* a new call begins */
void watch(const char *argument, const void *memory, size_t size, int written); /* written: when the call succeeds */
int32_t settled(int32_t status);              /* looks at the watched memory after the call */
int32_t created(int32_t status, feti_problem **p); /* the same, and destroys what the call has made */
void *given_record(int fault);

/* ---- for the drivers */

void give_record(void *record);

/* Calls f and checks status, that the thread's last error names it, and that nothing was written unless it succeeded. */
void expect(const function *f, feti_problem *p, int fault, int32_t status, const char *when);

/* The problem above, solved, and what else f wants to be there. */
feti_problem *problem_for(const function *f);

enum { ANSWER = 7 };
/* Solves; the status is returned, displacements and forces are written where there is an answer, else zeros. */
int32_t answer(feti_problem *p, double values[ANSWER]);

#endif
