/* Assertions of the C drivers. A driver prints nothing unless a check fails. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "feti_contact.h"

/* One number for all files of a driver. */
__attribute__((weak)) int check_failures;

/* CHECK(condition, format, ...): the text says what was expected, with the figures. */
#define CHECK(condition, ...)                                   \
    do {                                                        \
        if (!(condition)) {                                     \
            fprintf(stderr, "%s:%d: ", __FILE__, __LINE__);     \
            fprintf(stderr, __VA_ARGS__);                       \
            fprintf(stderr, "   [%s]\n", #condition);           \
            check_failures++;                                   \
        }                                                       \
    } while (0)

/* The call returns exactly this status. */
#define EXPECT(expected, call)                                                                          \
    do {                                                                                                \
        const int32_t check_status = (call);                                                            \
        if (check_status != (expected)) {                                                               \
            char check_text[512] = "";                                                                  \
            feti_last_error(check_text, sizeof check_text);                                             \
            fprintf(stderr, "%s:%d: %s returned %d (%s: %s), expected %d\n", __FILE__, __LINE__, #call, \
                    (int)check_status, feti_status_name(check_status), check_text, (int)(expected));    \
            check_failures++;                                                                           \
        }                                                                                               \
    } while (0)

#define OK(call) EXPECT(FETI_OK, call)

/* A call without which the rest makes no sense: ends the driver. */
#define MUST(call)                          \
    do {                                    \
        const int check_before = check_failures; \
        OK(call);                           \
        if (check_failures > check_before) exit(1); \
    } while (0)

/* n zeros of the given size, or the end of the driver. */
static inline void *check_array(int64_t n, size_t bytes_each)
{
    void *array = calloc((size_t)n + 1, bytes_each);
    if (!array) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return array;
}

static inline double check_max(int64_t n, const double *x)
{
    double size = 0.0;
    for (int64_t i = 0; i < n; i++) size = fmax(size, fabs(x[i]));
    return size;
}

/* max |x - y|; infinite when an entry is not a number. */
static inline double check_distance(int64_t n, const double *x, const double *y)
{
    double largest = 0.0;
    for (int64_t i = 0; i < n; i++) {
        const double d = fabs(x[i] - y[i]);
        if (!(d <= largest)) largest = d == d ? d : INFINITY;
    }
    return largest;
}

/* The exit code of the driver. */
static inline int check_result(void)
{
    return check_failures ? 1 : 0;
}

#endif
