/* 17 One body in the host's subdomains: each rank has the matrix of its part of the mesh.

   A membrane of 40 x 80 square elements of 1 cm is held at its first line and pressed by 10 N/m^2 onto an obstacle 1 cm below it. The host
   has cut the mesh into strips, strip s on rank s mod size, and sums the matrix and the load of each strip from its own elements alone. Nodes
   on the line between two strips have one number on both: with option glue they move together. A rank gives the obstacle of the nodes that it
   owns, by numbers:
     mpirun -n 4 17_one_body_in_subdomains */
#include <stdlib.h>

#include "demo.h"
#include "feti_contact_mpi.h"

enum { STRIPS = 4, LENGTH = 20 /* elements of a strip */, WIDTH = 40, LINE = WIDTH + 1, N = LINE * (LENGTH + 1) };

/* Strip s of a membrane under a tension of 60 N/m. */
static void add_strip(feti_problem *problem, int s)
{
    static const double ke[4][4] = { { 40, -10, -10, -20 }, { -10, 40, -20, -10 }, { -10, -20, 40, -10 }, { -20, -10, -10, 40 } };
    double *k = demo_array(N * N, sizeof *k), load[N] = { 0.0 }, one[N];
    int64_t body, number[N];

    for (int e = 0; e < WIDTH * LENGTH; e++) {
        const int at = e / WIDTH * LINE + e % WIDTH, node[4] = { at, at + 1, at + LINE, at + LINE + 1 };
        for (int a = 0; a < 4; a++) {
            load[node[a]] -= 10.0 * 1e-4 / 4.0; /* what each rank adds to a node of two strips is added up */
            for (int b = 0; b < 4; b++) k[node[a] + N * node[b]] += ke[a][b];
        }
    }
    for (int i = 0; i < N; i++) number[i] = (int64_t)s * LENGTH * LINE + i, one[i] = 1.0;
    CALL(feti_body_add(problem, N, &body));
    CALL(feti_body_stiffness_dense(problem, body, N, k, N, FETI_LOWER, FETI_COPY));
    CALL(feti_body_null_space(problem, body, 1, N, one, N, FETI_EXACT));
    CALL(feti_body_load(problem, body, N, load));
    CALL(feti_body_numbering_i64(problem, body, N, number, 0));
    free(k);
}

/* Rows of one unknown each, for `lines` lines of nodes from the given one. */
static void add_lines(feti_problem *problem, int32_t kind, int first, int lines, double val, double rhs)
{
    const int rows = lines * LINE;
    int64_t *ptr = demo_array(rows + 1, sizeof *ptr), *number = demo_array(rows, sizeof *number);
    double *vals = demo_array(rows, sizeof *vals), *all = demo_array(rows, sizeof *all);

    for (int i = 0; i < rows; i++) ptr[i + 1] = i + 1, number[i] = (int64_t)first * LINE + i, vals[i] = val, all[i] = rhs;
    CALL(feti_rows_add_i64(problem, kind, rows, ptr, NULL, number, vals, 0, all, NULL));
    free(ptr), free(number), free(vals), free(all);
}

int main(int argc, char **argv)
{
    int level, rank, size, bad = 0;
    double u[N], reaction[N], mine[2] = { 0.0 }, all[2];
    feti_info info = { .struct_size = sizeof info };
    feti_problem *problem = NULL;

    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    CALL(feti_problem_create(&problem));
    CALL(feti_mpi(problem, MPI_COMM_WORLD));
    CALL(feti_set_i64(problem, "glue", 1));
    for (int s = rank; s < STRIPS; s += size) add_strip(problem, s);
    for (int s = rank; s < STRIPS; s += size) add_lines(problem, FETI_INEQUALITY, s * LENGTH + 1, LENGTH, -1.0, 1e-2);
    if (rank == 0) add_lines(problem, FETI_EQUALITY, 0, 1, 1.0, 0.0);
    CALL(feti_solve(problem, &info));                         /* by all ranks */
    for (int s = rank, k = 0; s < STRIPS; s += size, k++) {
        CALL(feti_displacement(problem, k, N, u));
        CALL(feti_reaction(problem, FETI_INEQUALITY, k, N, reaction));
        for (int i = 0; i < N; i++) mine[0] += reaction[i];
        if (s == STRIPS - 1) mine[1] = u[N - 1];
    }
    CALL(feti_problem_destroy(&problem));
    MPI_Reduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    if (rank == 0) {
        const double end = -1e-2;                             /* the far end lies on the obstacle */
        demo_value("nodes on the obstacle", (double)info.active, "-");
        demo_value("force of the obstacle", all[0], "N");
        demo_value("the far end is at", 1e3 * all[1], "mm");
        bad = demo_line("17_one_body_in_subdomains", &info, demo_error(1, &all[1], &end), 1);
    }
    MPI_Finalize();
    return bad;
}
