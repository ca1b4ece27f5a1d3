/* 16 A body per rank: each rank has its own bodies, and no rank has the model.

   Four bars of 1 m stand on each other, the lowest on the ground, 1 mm below it; each weighs .5 MN. Rank r has bars r, r + size, ...: its
   matrix, its weight, and the contact row of its lower end, which names an unknown of the bar below by its number. All ranks make the
   calls; each gets the displacements of its bars and the forces of its rows:
     mpirun -n 4 16_body_per_rank */
#include <stddef.h>

#include "demo.h"
#include "feti_contact_mpi.h"

enum { BARS = 4, N = 1000 /* unknowns of a bar */ };

/* A chain of springs, held by nothing; unknown i of bar b has the number b N + i. */
static void add_bar(feti_problem *problem, int b)
{
    const double k = 1e4 * (N - 1);
    double val[2 * N - 1], load[N], one[N];
    int32_t ptr[N + 1], col[2 * N - 1];
    int64_t body, number[N];

    ptr[0] = 0;
    for (int i = 0; i < N; i++) {
        int32_t at = ptr[i];
        if (i > 0) col[at] = i - 1, val[at++] = -k;
        col[at] = i, val[at++] = i > 0 && i < N - 1 ? 2.0 * k : k;
        ptr[i + 1] = at;
        number[i] = (int64_t)b * N + i, load[i] = -0.5 / N, one[i] = 1.0;
    }
    CALL(feti_body_add(problem, N, &body));
    CALL(feti_body_stiffness_i32(problem, body, N, ptr, col, val, 0, FETI_LOWER, FETI_COPY));
    CALL(feti_body_null_space(problem, body, 1, N, one, N, FETI_EXACT));
    CALL(feti_body_load(problem, body, N, load));
    CALL(feti_body_numbering_i64(problem, body, N, number, 0));
}

/* The lower end of bar b stays above the upper end of the bar below it, or above the ground. */
static void add_row(feti_problem *problem, int b)
{
    const int64_t ptr[2] = { 0, b > 0 ? 2 : 1 }, number[2] = { (int64_t)b * N, (int64_t)b * N - 1 };
    const double val[2] = { -1.0, 1.0 }, gap = b > 0 ? 0.0 : 1e-3;

    CALL(feti_rows_add_i64(problem, FETI_INEQUALITY, 1, ptr, NULL, number, val, 0, &gap, NULL));
}

int main(int argc, char **argv)
{
    int level, rank, size, own = 0, bad = 0;
    double lambda[BARS], u[N], mine[2 * BARS] = { 0.0 }, all[2 * BARS], expected[BARS];
    feti_info info = { .struct_size = sizeof info };
    feti_problem *problem = NULL;

    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    CALL(feti_problem_create(&problem));
    CALL(feti_mpi(problem, MPI_COMM_WORLD));
    for (int b = rank; b < BARS; b += size, own++) add_bar(problem, b), add_row(problem, b);
    CALL(feti_solve(problem, &info));                         /* by all ranks */
    CALL(feti_multipliers(problem, FETI_INEQUALITY, own, lambda));
    for (int b = rank, k = 0; b < BARS; b += size, k++) {
        CALL(feti_displacement(problem, k, N, u));            /* of its bar k */
        mine[b] = lambda[k], mine[BARS + b] = u[N - 1];
    }
    CALL(feti_problem_destroy(&problem));

    MPI_Reduce(mine, all, 2 * BARS, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    for (int b = 0; b < BARS; b++) expected[b] = 0.5 * (BARS - b); /* each stands on what is below it */
    if (rank == 0) {
        demo_value("force on the ground", all[0], "MN");
        demo_value("force between the upper two", all[BARS - 1], "MN");
        demo_value("the top sinks by", -1e3 * all[2 * BARS - 1], "mm");
        bad = demo_line("16_body_per_rank", &info, demo_error(BARS, all, expected), 1);
    }
    MPI_Finalize();
    return bad;
}
