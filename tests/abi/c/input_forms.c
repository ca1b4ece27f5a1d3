/* Full, lower and upper storage, 32 and 64 bit indices, counting from 0 and from 1: the same bits come back.
   Dense matrices: the same answer.
   input_forms <data folder> */
#include "handover.h"

static int same_bits(int64_t n, const double *x, const double *y)
{
    return memcmp(x, y, (size_t)n * sizeof *x) == 0;
}

static void check_sparse_forms(const char *folder, const char *name)
{
    const form first_form = { .storage = FETI_LOWER };
    case_data data;
    read_or_stop(folder, name, &data);
    feti_problem *problem = handed_over(&data, &first_form);
    answer first = solved(problem, &data);
    OK(feti_problem_destroy(&problem));

    for (int32_t storage = FETI_FULL; storage <= FETI_UPPER; storage++)
        for (int32_t base = 0; base <= 1; base++)
            for (int wide = 0; wide <= 1; wide++) {
                const form how = { .storage = storage, .base = base, .wide = wide };
                problem = handed_over(&data, &how);
                answer other = solved(problem, &data);
                CHECK(same_bits(data.unknowns, first.u, other.u) && same_bits(data.rows, first.lambda, other.lambda) &&
                      same_bits(data.equalities, first.mu, other.mu),
                      "%s: storage %d, base %d, i%d: other bits", name, (int)storage, (int)base, wide ? 64 : 32);
                OK(feti_problem_destroy(&problem));
                answer_free(&other);
            }
    check_forces(name, &data, &first);
    answer_free(&first);
    case_free(&data);
}

static void check_dense_forms(const char *folder, const char *name, int unique)
{
    case_data data;
    read_or_stop(folder, name, &data);
    for (int32_t storage = FETI_FULL; storage <= FETI_UPPER; storage++) {
        const form how = { .storage = storage, .dense = 1 };
        feti_problem *problem = handed_over(&data, &how);
        answer result = solved(problem, &data);
        check_forces(name, &data, &result);
        if (unique) check_displacements(name, &data, &result);
        OK(feti_problem_destroy(&problem));
        answer_free(&result);
    }
    case_free(&data);
}

int main(int argc, char **argv)
{
    if (argc < 2) return 2;
    check_sparse_forms(argv[1], "p1_P3");
    check_sparse_forms(argv[1], "p2_A");
    check_dense_forms(argv[1], "p2_A", 1);
    check_dense_forms(argv[1], "p2_B1", 1);
    check_dense_forms(argv[1], "p2_B2", 0);
    return check_result();
}
