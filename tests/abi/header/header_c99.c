/* The header compiles as C99 without a warning, included twice, and its version is the library's. */
#include "feti_contact.h"
#include "feti_contact.h"

#include <stdio.h>

typedef void (*function)(void);

/* Assigned without a cast: a prototype other than these does not compile. */
static int32_t (*const create)(feti_problem **) = feti_problem_create;
static int32_t (*const load)(feti_problem *, int64_t, int64_t, const double *) = feti_body_load;
static int32_t (*const solve)(feti_problem *, feti_info *) = feti_solve;

int main(void)
{
    static const function table[] = {(function)create, (function)load, (function)solve,
                                     (function)feti_problem_destroy, (function)feti_rows_add_i32};
    const int32_t version = 10000 * FETI_CONTACT_VERSION_MAJOR + 100 * FETI_CONTACT_VERSION_MINOR
                            + FETI_CONTACT_VERSION_PATCH;
    const int32_t refused_second = FETI_ARGUMENT - 2;
    size_t k;

    for (k = 0; k < sizeof table / sizeof table[0]; k++) {
        if (table[k] == NULL) {
            fprintf(stderr, "function %d of the table has no address\n", (int)k);
            return 1;
        }
    }
    if (feti_version_number() != version) {
        fprintf(stderr, "header %d, library %d\n", (int)version, (int)feti_version_number());
        return 1;
    }
    return FETI_OK == 0 && refused_second == -102 ? 0 : 1;
}
