/* 11 A block on a slope: friction holds a body that nothing else holds, up to an angle that is known by hand.

      y |  +----------------+                contact row        -u_y <= 0     lambda_n: the slope presses
        |  |  2 m x 1 m     |   \            tangential row T   u_x           lambda_t > 0: the slope holds back
        |  |  W = 100 kN    |    \ weight, turned by the angle of the slope
        |  +----------------+     v          plane strain, 1 m thick
        +----------------------------- x, down the slope

   The block is elastic and floats: it has no support and no spring. The slope presses it with the sum of lambda_n = W
   cos(angle), friction holds it by the sum of lambda_t = W sin(angle). Since |lambda_t| <= mu lambda_n at every node, the
   block stays at rest if tan(angle) <= mu = 0.5, up to 26.565 degrees. Close to this angle some nodes slip a little, and the
   others stick.

   1. Smaller angles: the program prints both sums and the number of nodes that stick and slip.
   2. Larger angles: no contact force can balance the weight. feti_solve returns FETI_LOAD_NOT_HELD, and feti_diagnosis
      returns the body and a motion that the weight causes and no force of the slope resists: down, and away from the slope
      by mu. (With any slower lift friction could act.)
   3. Larger angles with a spring between the block and a rail above it. The spring could press the block onto the slope, and
      then friction would hold it: forces that balance the weight exist. But nothing tightens the spring, and the block still
      slides: FETI_SLIDES, with the part of the load that friction holds, mu / tan(angle).

   Units: kN and m. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "demo.h"

enum { NX = 8, NY = 4, SIDE = NX + 1, NODES = SIDE * (NY + 1), N = 2 * NODES };
static const double YOUNG = 3e7, POISSON = 0.2, WEIGHT = 100.0, MU = 0.5, EDGE = 0.25, SPRING = 10.0; /* kPa, -, kN, -, m, kN/m */
static const double DEGREE = 3.14159265358979323846 / 180.0;

/* Unknown along x of node (i, j), counted from below; that along y follows. */
static int unknown(int i, int j)
{
    return 2 * (i + SIDE * j);
}

/* Stiffness of a square element, plane strain, 2 x 2 Gauss points, independent of the edge length. Corners (0,0), (1,0),
   (0,1), (1,1). */
static void element(double k[8][8])
{
    const double mu = YOUNG / (2.0 * (1.0 + POISSON)), la = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON);

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

/* The block with its stiffness; coordinates in place of a null space. */
static void add_block(feti_problem *problem)
{
    static double k[N * N], xyz[2 * N], ke[8][8];
    int32_t node[N], dir[N];
    int64_t body;

    element(ke);
    for (int e = 0; e < NX * NY; e++)
        for (int p = 0; p < 8; p++)
            for (int q = 0; q < 8; q++) {
                const int row = unknown(e % NX + (p / 2) % 2, e / NX + p / 4) + p % 2;
                const int col = unknown(e % NX + (q / 2) % 2, e / NX + q / 4) + q % 2;
                k[row + N * col] += ke[p][q];
            }
    for (int at = 0; at < N; at++) {
        node[at] = at / 2 + 1, dir[at] = at % 2 + 1;
        xyz[2 * at] = EDGE * (at / 2 % SIDE), xyz[2 * at + 1] = EDGE * (at / 2 / SIDE);
    }
    CALL(feti_body_add(problem, N, &body));
    CALL(feti_body_stiffness_dense(problem, body, N, k, N, FETI_LOWER, FETI_COPY));
    CALL(feti_body_coordinates(problem, body, 2, N, node, dir, xyz, 2));
}

/* A contact row -u_y <= 0 and a tangential row u_x for every node of the bottom. */
static void add_slope(feti_problem *problem)
{
    int32_t ptr[SIDE + 1], normal_dof[SIDE], along_dof[SIDE], row[SIDE];
    double minus[SIDE], one[SIDE], coefficient[SIDE];

    for (int i = 0; i < SIDE; i++) {
        ptr[i] = i, row[i] = i;
        along_dof[i] = unknown(i, 0), normal_dof[i] = unknown(i, 0) + 1;
        minus[i] = -1.0, one[i] = 1.0, coefficient[i] = MU;
    }
    ptr[SIDE] = SIDE;
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, SIDE, ptr, NULL, normal_dof, minus, 0, NULL, NULL));
    CALL(feti_friction_add_i32(problem, SIDE, 1, row, ptr, NULL, along_dof, one, 0, coefficient, NULL, NULL));
}

/* A spring across the slope in the middle of the top: an equality row with a compliance, u_y = mu / k. */
static void add_spring(feti_problem *problem)
{
    const int32_t ptr[2] = { 0, 1 }, dof[1] = { unknown(NX / 2, NY) + 1 };
    const double one = 1.0, compliance = 1.0 / SPRING;

    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, 1, ptr, NULL, dof, &one, 0, NULL, NULL));
    CALL(feti_rows_compliance(problem, FETI_EQUALITY, 0, 1, &compliance));
}

/* The weight of each element goes to its corners. */
static void give_weight(feti_problem *problem, double angle)
{
    const double corner = WEIGHT / (4 * NX * NY);
    double load[N] = { 0.0 };

    for (int e = 0; e < NX * NY; e++)
        for (int c = 0; c < 4; c++) {
            const int at = unknown(e % NX + c % 2, e / NX + c / 2);
            load[at] += corner * sin(angle * DEGREE), load[at + 1] -= corner * cos(angle * DEGREE);
        }
    CALL(feti_body_load(problem, 0, N, load));
}

/* Solves and prints a line. The relative error of both sums; `info` is that of the last angle that has an answer. */
static double rest(feti_problem *problem, double angle, feti_info *info)
{
    const double across = WEIGHT * cos(angle * DEGREE), along = WEIGHT * sin(angle * DEGREE);
    double lambda_n[SIDE], lambda_t[SIDE], normal = 0.0, tangential = 0.0;

    give_weight(problem, angle);
    CALL(feti_solve(problem, info));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, SIDE, lambda_n));
    CALL(feti_multipliers(problem, FETI_TANGENTIAL, SIDE, lambda_t));
    for (int i = 0; i < SIDE; i++) normal += lambda_n[i], tangential += lambda_t[i];
    printf("%8.2f%14.6f%14.6f%14.6f%14.6f%6d%6d\n", angle, normal, across, tangential, along, (int)info->sticking,
           (int)info->slipping);
    return fmax(fabs(normal - across) / across, fabs(tangential - along) / along);
}

/* Solves what has no answer and prints a line: the status, how fast the block moves down the slope and away from it (the largest
   unknown of the motion is 1), and what is held. Returns whether the status is the one expected and the block moves down. */
static int escape(feti_problem *problem, double angle, int32_t expected, double *capacity)
{
    feti_findings found = { .struct_size = sizeof found };
    double v[N], down = 0.0, away = 0.0;
    int32_t status;

    give_weight(problem, angle);
    status = feti_solve(problem, NULL);
    if (status != expected) CALL(status);
    CALL(feti_diagnosis(problem, &found));
    CALL(feti_diagnosis_motion(problem, found.body, N, v));
    for (int i = 0; i < NODES; i++) down += v[2 * i] / NODES, away += v[2 * i + 1] / NODES;
    *capacity = found.capacity; /* NaN after FETI_LOAD_NOT_HELD */
    printf("%8.2f  %-18s  %12.6f%12.6f", angle, feti_status_name(status), down, away);
    if (status == FETI_SLIDES) printf("%14.6f%14.6f", found.capacity, MU / tan(angle * DEGREE));
    printf("\n");
    return found.body == 0 && down > 0.99 && fabs(away - (status == FETI_SLIDES ? 0.0 : MU)) < 1e-2;
}

int main(void)
{
    static const double below[] = { 5.0, 15.0, 25.0, 26.5 }, above[] = { 26.6, 30.0, 45.0 };
    feti_problem *problem = NULL;
    feti_info info = { .struct_size = sizeof info };
    double error = 0.0, capacity;
    int right = 1;

    CALL(feti_problem_create(&problem));
    add_block(problem);
    add_slope(problem);
    printf("   angle        normal         W cos    tangential         W sin stick  slip\n");
    for (int k = 0; k < 4; k++) error = fmax(error, rest(problem, below[k], &info));
    right = error <= 1e-10;
    printf("   angle  status                      down        away          held  mu/tan(angle)\n");
    for (int k = 0; k < 3; k++) right = escape(problem, above[k], FETI_LOAD_NOT_HELD, &capacity) && right;

    add_spring(problem);
    for (int k = 1; k < 3; k++) {
        right = escape(problem, above[k], FETI_SLIDES, &capacity) && right;
        right = right && fabs(capacity - MU / tan(above[k] * DEGREE)) <= 1e-5;
    }
    CALL(feti_problem_destroy(&problem));
    return demo_line("11_block_on_a_slope", &info, error, right);
}
