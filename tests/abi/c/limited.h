/* Jobs under a limit of address space: whatever the limit, every call returns FETI_OK or FETI_MEMORY, and with more memory the
   same problem is solved to the same bits. */
#ifndef LIMITED_H
#define LIMITED_H

#include "check.h"

/* Calls 0 to `calls` - 1 in their order, each of which may be repeated; `data` is handed on. */
typedef struct {
    int calls;
    int32_t (*call)(const void *data, int call, int64_t threads, feti_problem **problem);
    /* checks what a call says that returned FETI_MEMORY; may be NULL */
    void (*refused)(const void *data, int call);
    /* bits of the answer */
    uint64_t (*print)(const void *data, feti_problem *problem);
    const void *data;
} limited_job;

/* Sets the limit to what is in use now; false: takes it away. */
void limited_now(int limited);

/* Runs the job, without a limit and on a ladder of limits, each in a process of its own, with one thread and with two. */
void limited_ladder(const limited_job *job);

#endif
