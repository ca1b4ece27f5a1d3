/* Breaks the contract: the load is one number shorter than the body. Under AddressSanitizer (make sanitize) this must be
   reported; it is no test by itself. */
#include "check.h"

int main(void)
{
    feti_problem *p = NULL;
    int64_t body;
    double *load = calloc(2, sizeof *load);

    MUST(feti_problem_create(&p));
    MUST(feti_body_add(p, 3, &body));
    feti_body_load(p, body, 3, load);
    free(load);
    return check_result();
}
