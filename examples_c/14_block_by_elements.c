/* 14 A block given by its elements, which the library cuts into pieces.

   A block of 1 m x 1 m x 1 m (E = 2.1e5 MN/m^2, nu = .3) is clamped on its face x = 0; 10 MN on its top press it onto a rigid,
   slightly curved obstacle below it. The host has an assembly loop and equation numbers, in which held unknowns are numbers
   below 0, but no sparse matrix: it passes one element after the other.

   The example solves the problem twice: cut into eight pieces (option pieces), and as a whole, with equal displacements. The
   forces of the clamp, which feti_body_held_forces returns, and the forces of the obstacle balance the load. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "demo.h"
#include "picture.h"

enum { N = 10 /* elements along 1 m */, L = N + 1, NODES = L * L * L, ELEMENTS = N * N * N, ALL = 3 * NODES, OWN = 24 };
static const double YOUNG = 2.1e5, POISSON = 0.3; /* MN/m^2, - */

/* Equation numbers of all unknowns: from 0, held ones -1, -2, ... */
typedef struct {
    int32_t equation[ALL];
    int32_t unknowns, held;
} numbers;

typedef struct {
    double *u, contact[L * L], gap[L * L], clamp[3 * L * L]; /* u by equations; force and gap of the row on each node of the bottom */
    int32_t state[L * L];
    int64_t *piece, pieces;
    feti_info info;
} answer;

static int node(int i, int j, int k)
{
    return i + L * (j + L * k);
}

static numbers *number_unknowns(void)
{
    numbers *all = demo_array(1, sizeof *all);

    for (int a = 0; a < NODES; a++)
        for (int d = 0; d < 3; d++) all->equation[3 * a + d] = a % L == 0 ? -1 - all->held++ : all->unknowns++;
    return all;
}

/* Stiffness of a cube of edge 1 / N, 24 x 24, 2 x 2 x 2 Gauss points. Corner c lies at bit 0, 1, 2 of c along x, y, z. */
static void element(double *ke)
{
    const double mu = YOUNG / (2.0 * (1.0 + POISSON)), la = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON);
    const double weight = 1.0 / (8.0 * N);

    memset(ke, 0, OWN * OWN * sizeof *ke);
    for (int point = 0; point < 8; point++) {
        double g[8][3];
        for (int c = 0; c < 8; c++)
            for (int a = 0; a < 3; a++) {
                g[c][a] = c >> a & 1 ? 1.0 : -1.0;
                for (int b = 0; b < 3; b++)
                    if (b != a) g[c][a] *= 0.5 * (1.0 + ((c >> b & 1) == (point >> b & 1) ? 1.0 : -1.0) / sqrt(3.0));
            }
        for (int p = 0; p < OWN; p++)
            for (int q = 0; q < OWN; q++) {
                const double *a = g[p / 3], *b = g[q / 3];
                double k = la * a[p % 3] * b[q % 3] + mu * a[q % 3] * b[p % 3];
                if (p % 3 == q % 3) k += mu * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
                ke[p + OWN * q] += weight * k;
            }
    }
}

/* Where every equation is: the cut and the rigid motions of the pieces follow from it. */
static void give_coordinates(feti_problem *problem, int64_t body, const numbers *all)
{
    int32_t *label = demo_array(all->unknowns, sizeof *label), *dir = demo_array(all->unknowns, sizeof *dir);
    double *xyz = demo_array(3 * all->unknowns, sizeof *xyz);

    for (int a = 0; a < NODES; a++)
        for (int d = 0; d < 3; d++) {
            const int32_t at = all->equation[3 * a + d];
            if (at < 0) continue;
            label[at] = a, dir[at] = d + 1;
            xyz[3 * at] = (double)(a % L) / N, xyz[3 * at + 1] = (double)(a / L % L) / N, xyz[3 * at + 2] = (double)(a / L / L) / N;
        }
    CALL(feti_body_coordinates(problem, body, 3, all->unknowns, label, dir, xyz, 3));
    free(label);
    free(dir);
    free(xyz);
}

/* Equations of the 24 unknowns of every element, then its matrix: the assembly loop of the host. */
static void give_elements(feti_problem *problem, int64_t body, const numbers *all)
{
    int32_t *ptr = demo_array(ELEMENTS + 1, sizeof *ptr), *dof = demo_array(OWN * ELEMENTS, sizeof *dof);
    double ke[OWN * OWN];

    for (int e = 0; e < ELEMENTS; e++) {
        ptr[e + 1] = OWN * (e + 1);
        for (int c = 0; c < 8; c++) {
            const int a = node(e % N + (c & 1), e / N % N + (c >> 1 & 1), e / N / N + (c >> 2));
            for (int d = 0; d < 3; d++) dof[OWN * e + 3 * c + d] = all->equation[3 * a + d];
        }
    }
    CALL(feti_body_mesh_i32(problem, body, ELEMENTS, ptr, dof, 0));
    for (int e = 0; e < ELEMENTS; e++) {
        element(ke);
        CALL(feti_body_element(problem, body, e, OWN, ke, OWN));
    }
    free(ptr);
    free(dof);
}

/* 10 MN down on the free nodes of the top, rows -u_z <= gap on the free nodes of the bottom; held nodes have no load and no row. */
static void give_load_and_obstacle(feti_problem *problem, int64_t body, const numbers *all)
{
    const int32_t ptr[2] = { 0, 1 }, whose[1] = { (int32_t)body };
    const double down[1] = { -1.0 };
    double *load = demo_array(all->unknowns, sizeof *load);

    for (int j = 0; j < L; j++)
        for (int i = 1; i < L; i++) {
            const double x = (double)i / N - 0.7, y = (double)j / N - 0.5, gap[1] = { 1e-5 + 1e-4 * (x * x + y * y) };
            load[all->equation[3 * node(i, j, N) + 2]] = -10.0 / (N * L);
            CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, 1, ptr, whose, &all->equation[3 * node(i, j, 0) + 2], down, 0, gap, NULL));
        }
    CALL(feti_body_load(problem, body, all->unknowns, load));
    free(load);
}

static void solve(const numbers *all, int64_t pieces, answer *found)
{
    feti_body_facts facts = { .struct_size = sizeof facts };
    feti_problem *problem = NULL;
    int64_t body;

    found->info.struct_size = sizeof found->info;
    CALL(feti_problem_create(&problem));
    CALL(feti_set_i64(problem, "pieces", pieces));
    CALL(feti_body_add(problem, all->unknowns, &body));
    give_coordinates(problem, body, all);
    give_elements(problem, body, all);
    give_load_and_obstacle(problem, body, all);
    CALL(feti_solve(problem, &found->info));
    CALL(feti_displacement(problem, body, all->unknowns, found->u));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, N * L, found->contact));
    CALL(feti_gaps(problem, N * L, found->gap));
    CALL(feti_active(problem, N * L, found->state));
    CALL(feti_body_held_forces(problem, body, all->held, found->clamp));
    CALL(feti_body_info(problem, body, &facts));
    CALL(feti_body_pieces(problem, body, all->unknowns, found->piece));
    found->pieces = facts.pieces;
    CALL(feti_problem_destroy(&problem));
}

/* Value of unknown d of node a, 0 where it is held. */
static double at(const numbers *all, const double *u, int a, int d)
{
    const int32_t equation = all->equation[3 * a + d];
    return equation < 0 ? 0.0 : u[equation];
}

/* The piece of an element: an unknown of several pieces has the first of them, an unknown inside a piece has its own. */
static double piece_of(const numbers *all, const answer *found, const int64_t *corner)
{
    int64_t piece = 0;
    for (int c = 0; c < 8; c++) {
        const int32_t equation = all->equation[3 * corner[c]];
        if (equation >= 0 && found->piece[equation] > piece) piece = found->piece[equation];
    }
    return (double)piece;
}

/* The elements with displacements, stresses and pieces, and what the contact does to them. */
static void draw(const char *folder, const numbers *all, const answer *found)
{
    static const int around[8] = { 0, 1, 3, 2, 4, 5, 7, 6 }; /* VTK goes around the bottom, then around the top */
    double *values = demo_array(12 * NODES + ELEMENTS, sizeof *values);
    double *xyz = values, *moved = values + 3 * NODES, *force = values + 6 * NODES, *push = values + 9 * NODES;
    double *gap = values + 10 * NODES, *state = values + 11 * NODES, *piece = values + 12 * NODES;
    int64_t *cells = demo_array(9 * ELEMENTS + 1, sizeof *cells), *offset = cells, *corner = cells + ELEMENTS + 1;
    int32_t *types = demo_array(2 * ELEMENTS, sizeof *types), *type = types, *body = types + ELEMENTS;
    const picture_grid grid = { NODES, ELEMENTS, xyz, offset, corner, type, body };
    const picture_answer answer = { moved, force, push, gap, state, piece, YOUNG / (2.0 * (1.0 + POISSON)), 0.0, 0 };

    for (int a = 0; a < NODES; a++) {
        const int place[3] = { a % L, a / L % L, a / L / L };
        for (int d = 0; d < 3; d++) xyz[3 * a + d] = (double)place[d] / N, moved[3 * a + d] = at(all, found->u, a, d);
        gap[a] = NAN, state[a] = -1.0;
        if (a >= L * L || a % L == 0) continue;
        const int row = a % L - 1 + N * (a / L); /* on the bottom */
        force[3 * a + 2] = push[a] = found->contact[row], gap[a] = found->gap[row], state[a] = found->state[row];
    }
    for (int e = 0; e < ELEMENTS; e++) {
        type[e] = PICTURE_HEXAHEDRON, body[e] = 1;
        offset[e + 1] = 8 * (e + 1);
        for (int c = 0; c < 8; c++)
            corner[8 * e + c] = node(e % N + (around[c] & 1), e / N % N + (around[c] >> 1 & 1), e / N / N + (around[c] >> 2));
        piece[e] = piece_of(all, found, corner + 8 * e);
    }
    if (picture_mesh(folder, "block_in_pieces.vtu", &grid, &answer) != 0) demo_stop("the picture cannot be written");
    free(values);
    free(cells);
    free(types);
}

int main(int argc, char **argv)
{
    numbers *all = number_unknowns();
    answer *cut = demo_array(1, sizeof *cut), *whole = demo_array(1, sizeof *whole);
    double contact = 0.0, clamp = 0.0, lowest = 0.0, error;
    int closed = 0, end;

    cut->u = demo_array(all->unknowns, sizeof *cut->u), cut->piece = demo_array(all->unknowns, sizeof *cut->piece);
    whole->u = demo_array(all->unknowns, sizeof *whole->u), whole->piece = demo_array(all->unknowns, sizeof *whole->piece);
    solve(all, 8, cut);
    solve(all, 1, whole);

    for (int r = 0; r < N * L; r++) contact += cut->contact[r], closed += cut->contact[r] > 1e-6;
    for (int k = 2; k < all->held; k += 3) clamp += cut->clamp[k]; /* the held unknowns of a node are x, y, z */
    for (int a = 0; a < NODES; a++) lowest = fmin(lowest, at(all, cut->u, a, 2));
    demo_value("elements", ELEMENTS, "-");
    demo_value("held unknowns", all->held, "-");
    demo_value("pieces", (double)cut->pieces, "-");
    demo_value("pieces of the whole block", (double)whole->pieces, "-");
    demo_value("load", -10.0, "MN");
    demo_value("force of the obstacle", contact, "MN");
    demo_value("force of the clamp", clamp, "MN");
    demo_value("nodes in contact", closed, "-");
    demo_value("largest settlement", -1e6 * lowest, "um");
    draw(demo_picture_folder(argc, argv), all, cut);
    error = demo_error(all->unknowns, cut->u, whole->u);
    end = demo_line("14_block_by_elements", &cut->info, error,
                    whole->info.status == FETI_OK && cut->pieces == 8 && whole->pieces == 1 && fabs(contact + clamp - 10.0) <= 1e-6);
    free(cut->u), free(cut->piece), free(cut), free(whole->u), free(whole->piece), free(whole), free(all);
    return end;
}
