/* 15 A serial code under mpirun: the other ranks share the work of rank 0.

   Eight blocks of 1 m x 1 m stand on each other (plane strain, nu = .25, 1 m thick), each softer than the one below, E = 1e4 to
   5.625e3 MN/m^2. The lowest is clamped to the ground, the others float, and each top is slightly hollow. A load of .5 MN presses on the left half of the highest block, so that
   contacts open on the right.

   The host is serial: one rank has the model and calls the library. The lines marked with MPI lend bodies to the other
   ranks. The forces are the same on any number of ranks:
     mpirun -n 4 15_serial_under_mpirun */
#include <math.h>
#include <stdlib.h>

#include "demo.h"
#include "feti_contact_mpi.h"

enum { BLOCKS = 8, N = 16 /* elements along 1 m */, LINE = N + 1, UNKNOWNS = 2 * LINE * LINE };

/* Unknown along x of node (i, j) of a block; the next is along y. */
static int32_t unknown(int i, int j)
{
    return 2 * (i * LINE + j);
}

/* Stiffness of a square element, plane strain, 2 x 2 Gauss points. Corners (0,0), (1,0), (0,1), (1,1). */
static void element(double k[8][8])
{
    const double young = 1e4, nu = 0.25, mu = young / (2.0 * (1.0 + nu)), la = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));

    for (int p = 0; p < 8; p++)
        for (int q = 0; q < 8; q++) k[p][q] = 0.0;
    for (int point = 0; point < 4; point++) {
        double g[4][2];
        for (int c = 0; c < 4; c++)
            for (int a = 0; a < 2; a++) {
                const int b = 1 - a;
                const double side = c >> a & 1 ? 1.0 : -1.0, other = (c >> b & 1 ? 1.0 : -1.0) * (point >> b & 1 ? 1.0 : -1.0);
                g[c][a] = side * 0.5 * (1.0 + other / sqrt(3.0));
            }
        for (int p = 0; p < 8; p++)
            for (int q = 0; q < 8; q++) {
                const double *a = g[p / 2], *b = g[q / 2];
                k[p][q] += 0.25 * (la * a[p % 2] * b[q % 2] + mu * a[q % 2] * b[p % 2]);
                if (p % 2 == q % 2) k[p][q] += 0.25 * mu * (a[0] * b[0] + a[1] * b[1]);
            }
    }
}

static void add_blocks(feti_problem *problem)
{
    double *k = demo_array(UNKNOWNS * UNKNOWNS, sizeof *k), *own = demo_array(UNKNOWNS * UNKNOWNS, sizeof *own);
    double *xyz = demo_array(2 * UNKNOWNS, sizeof *xyz), *load = demo_array(UNKNOWNS, sizeof *load), ke[8][8];
    int32_t *node = demo_array(UNKNOWNS, sizeof *node), *dir = demo_array(UNKNOWNS, sizeof *dir);

    element(ke);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            for (int p = 0; p < 8; p++)
                for (int q = 0; q < 8; q++) {
                    const int row = unknown(i + (p / 2) % 2, j + p / 4) + p % 2, col = unknown(i + (q / 2) % 2, j + q / 4) + q % 2;
                    k[row + UNKNOWNS * col] += ke[p][q];
                }
    for (int at = 0; at < UNKNOWNS; at++) {
        const int i = at / 2 / LINE, j = at / 2 % LINE;
        node[at] = at / 2 + 1, dir[at] = at % 2 + 1;
        xyz[2 * at] = (double)i / N, xyz[2 * at + 1] = (double)j / N;
        if (at % 2 == 1 && j == N && 2 * i < N) load[at] = -1.0 / N;
    }
    for (int b = 0; b < BLOCKS; b++) {
        int64_t body;
        for (int at = 0; at < UNKNOWNS * UNKNOWNS; at++) own[at] = (1.0 - b / 16.0) * k[at];
        CALL(feti_body_add(problem, UNKNOWNS, &body));
        CALL(feti_body_stiffness_dense(problem, body, UNKNOWNS, own, UNKNOWNS, FETI_LOWER, FETI_COPY));
        CALL(feti_body_coordinates(problem, body, 2, UNKNOWNS, node, dir, xyz, 2));
        if (b == BLOCKS - 1) CALL(feti_body_load(problem, body, UNKNOWNS, load));
    }
    free(k);
    free(own);
    free(xyz);
    free(load);
    free(node);
    free(dir);
}

/* One row: an unknown of a block, less one of another block if above >= 0. */
static void add_row(feti_problem *problem, int32_t kind, int below, int32_t dof, int above, int32_t other, double rhs)
{
    const int32_t ptr[2] = { 0, above < 0 ? 1 : 2 }, body[2] = { below, above }, dofs[2] = { dof, other };
    const double val[2] = { 1.0, -1.0 };

    CALL(feti_rows_add_i32(problem, kind, 1, ptr, body, dofs, val, 0, &rhs, NULL));
}

/* The clamp; a node of each other block that keeps it from sliding; a contact row along y for each node between two blocks. */
static void add_rows(feti_problem *problem)
{
    for (int i = 0; i < LINE; i++)
        for (int d = 0; d < 2; d++) add_row(problem, FETI_EQUALITY, 0, unknown(i, 0) + d, -1, 0, 0.0);
    for (int b = 1; b < BLOCKS; b++) {
        add_row(problem, FETI_EQUALITY, b, unknown(0, 0), -1, 0, 0.0);
        for (int i = 0; i < LINE; i++) {
            const double x = (double)i / N;
            add_row(problem, FETI_INEQUALITY, b - 1, unknown(i, N) + 1, b, unknown(i, 0) + 1, 2e-5 * x * (1.0 - x));
        }
    }
}

static int serial_host(void)
{
    feti_info info = { .struct_size = sizeof info };
    double lambda[(BLOCKS - 1) * LINE], force[BLOCKS - 1], expected[BLOCKS - 1], *u = demo_array(UNKNOWNS, sizeof *u);
    feti_problem *problem = NULL;
    int closed = 0;

    CALL(feti_problem_create(&problem));
    CALL(feti_mpi(problem, MPI_COMM_WORLD));                      /* MPI */
    add_blocks(problem);
    add_rows(problem);
    CALL(feti_solve(problem, &info));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, (BLOCKS - 1) * LINE, lambda));
    CALL(feti_displacement(problem, BLOCKS - 1, UNKNOWNS, u));
    CALL(feti_problem_destroy(&problem));

    for (int b = 0; b < BLOCKS - 1; b++) {
        force[b] = 0.0, expected[b] = (double)(N / 2) / N;        /* what stands above is pressed on by the load alone */
        for (int i = 0; i < LINE; i++) force[b] += lambda[b * LINE + i], closed += lambda[b * LINE + i] > 1e-6;
    }
    demo_value("nodes in contact", closed, "-");
    demo_value("contact force on the ground", force[0], "MN");
    demo_value("energy", 1e6 * info.energy, "J");
    demo_value("left upper corner sinks by", -1e3 * u[unknown(0, N) + 1], "mm");
    demo_value("right upper corner rises by", 1e3 * u[unknown(N, N) + 1], "mm");
    free(u);
    return demo_line("15_serial_under_mpirun", &info, demo_error(BLOCKS - 1, force, expected), 1);
}

int main(int argc, char **argv)
{
    int level, rank, bad = 0;

    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);   /* MPI */
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);                         /* MPI */
    if (rank == 0) bad = serial_host();
    CALL(feti_mpi_serve(MPI_COMM_WORLD));                         /* MPI: the other ranks work here until rank 0 comes, too */
    MPI_Finalize();                                               /* MPI */
    return bad;
}
