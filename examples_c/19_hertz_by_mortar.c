/* 19 A cylinder on a block, quadratic elements: pressures by mortar and by node-to-face, against Hertz.

   Two blocks of quadrilaterals with 8 nodes, plane strain, 1 mm thick; the foot of the upper one is round, and a load presses it on the lower one.
   Their meshes do not match. The blocks are 24 times as wide as the contact, so that Hertz' solution of two half planes holds:

       a^2 = 4 P R / (pi E'),   p(x) = 2 P / (pi a) sqrt(1 - (x/a)^2),   E' = E / (2 (1 - nu^2))

   On faces with mid nodes, nodal forces of node-to-face are no measure of pressure however fine the mesh: consistent forces of a constant pressure
   differ between corners and mid nodes by a factor that one row per node cannot follow. FETI_MORTAR weighs the gap over the faces.

   Known by hand: the resultant on the foot is the load, by either method. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "demo.h"
#include "picture.h"

enum { LINES = 64, AT_ALL = 20000, GAUSS = 3 };
static const double YOUNG = 1000.0, POISSON = 0.3, R = 100.0, A = 1.0; /* MPa, -, mm, mm: half width of the contact */
static const double HALF = 12.0, PI = 3.14159265358979323846;         /* mm: of both blocks */

/* Both blocks: positions, unknown of each direction (-1: held), nodes of elements, faces. */
typedef struct {
    int32_t nodes, unknowns, elements, faces[2];
    double *x;
    int32_t *number, *corner, *face[2];
} mesh;

/* Lines from 0 to HALF, `h` apart up to 1.5 a, then further and further; gives their number. */
static int graded(double h, double *line)
{
    int n = 0;
    double at = 0.0, step = h;

    line[0] = 0.0;
    while (at < HALF) {
        if (at > 1.5 * A) step *= 1.4;
        at += step;
        line[++n] = at;
    }
    for (int k = 0; k <= n; k++)
        if (line[k] > 1.5 * A) line[k] = 1.5 * A + (line[k] - 1.5 * A) * (HALF - 1.5 * A) / (at - 1.5 * A);
    return n;
}

/* A block of which `up` says whether it lies above y = 0; `h`: size of its elements at the contact. Elements have corners, then mid nodes. */
static void add_block(mesh *m, int up, double h)
{
    static const int around[8][2] = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 }, { 1, 0 }, { 2, 1 }, { 1, 2 }, { 0, 1 } };
    double line[LINES];
    const int n = graded(h, line), wide = 4 * n + 1, high = 2 * n + 1; /* places of nodes along x and y; none in the middle of elements */
    int32_t *at = demo_array((int64_t)wide * high, sizeof *at);

    for (int j = 0; j < high; j++)
        for (int i = 0; i < wide; i++) {
            const int k = abs(i - 2 * n);
            const double x = (i < 2 * n ? -0.5 : 0.5) * (line[k / 2] + line[(k + 1) / 2]), y = 0.5 * (line[j / 2] + line[(j + 1) / 2]);
            if (i % 2 && j % 2) continue;
            at[i + wide * j] = m->nodes;
            m->x[2 * m->nodes] = x;
            m->x[2 * m->nodes + 1] = up ? y + x * x / (2.0 * R) * (1.0 - y / HALF) : -y;
            m->number[2 * m->nodes] = k == 0 || (!up && j == high - 1) ? -1 : m->unknowns++; /* the middle stays in the middle */
            m->number[2 * m->nodes + 1] = !up && j == high - 1 ? -1 : m->unknowns++;
            m->nodes++;
        }
    for (int j = 0; j + 2 < high; j += 2)
        for (int i = 0; i + 2 < wide; i += 2, m->elements++)
            for (int a = 0; a < 8; a++) /* below, y goes down: turned over, to go around counterclockwise */
                m->corner[8 * m->elements + a] =
                    at[i + around[a][0] + wide * (j + (up ? around[a][1] : 2 - around[a][1]))];
    for (int i = 0; i + 2 < wide; i += 2) { /* the body is on the left */
        int32_t *face = m->face[up] + 3 * m->faces[up]++;
        face[0] = at[up ? i : i + 2], face[1] = at[up ? i + 2 : i], face[2] = at[i + 1];
    }
    free(at);
}

/* Shape functions of 8 nodes and their slopes at (s, t). */
static void shape(double s, double t, double n[8], double slope[8][2])
{
    static const double place[8][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 }, { 0, -1 }, { 1, 0 }, { 0, 1 }, { -1, 0 } };

    for (int a = 0; a < 8; a++) {
        const double p = place[a][0], q = place[a][1], u = 1.0 + p * s, v = 1.0 + q * t;
        if (a < 4) {
            n[a] = u * v * (p * s + q * t - 1.0) / 4.0;
            slope[a][0] = p * v * (2.0 * p * s + q * t) / 4.0, slope[a][1] = q * u * (2.0 * q * t + p * s) / 4.0;
        } else if (p == 0.0) {
            n[a] = (1.0 - s * s) * v / 2.0;
            slope[a][0] = -s * v, slope[a][1] = q * (1.0 - s * s) / 2.0;
        } else {
            n[a] = u * (1.0 - t * t) / 2.0;
            slope[a][0] = p * (1.0 - t * t) / 2.0, slope[a][1] = -t * u;
        }
    }
}

/* K of an element: int lame N_a,i N_b,j + shear (N_a,j N_b,i + delta_ij N_a,k N_b,k). */
static void element(const mesh *m, const int32_t *corner, double *ke)
{
    static const double place[GAUSS] = { -0.774596669241483377, 0.0, 0.774596669241483377 }, weight[GAUSS] = { 5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0 };
    const double shear = YOUNG / (2.0 * (1.0 + POISSON)), lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);

    memset(ke, 0, 256 * sizeof *ke);
    for (int p = 0; p < GAUSS * GAUSS; p++) {
        double n[8], g[8][2], J[2][2] = { { 0 } }, w;
        shape(place[p % GAUSS], place[p / GAUSS], n, g);
        for (int a = 0; a < 8; a++)
            for (int c = 0; c < 2; c++)
                for (int d = 0; d < 2; d++) J[c][d] += g[a][c] * m->x[2 * corner[a] + d];
        w = J[0][0] * J[1][1] - J[0][1] * J[1][0];
        for (int a = 0; a < 8; a++) {
            const double slope[2] = { g[a][0], g[a][1] };
            g[a][0] = (J[1][1] * slope[0] - J[0][1] * slope[1]) / w, g[a][1] = (J[0][0] * slope[1] - J[1][0] * slope[0]) / w;
        }
        w *= weight[p % GAUSS] * weight[p / GAUSS];
        for (int i = 0; i < 16; i++)
            for (int j = 0; j < 16; j++) {
                const double *a = g[i / 2], *b = g[j / 2];
                ke[i + 16 * j] += w * (lame * a[i % 2] * b[j % 2] + shear * a[j % 2] * b[i % 2]
                                       + (i % 2 == j % 2) * shear * (a[0] * b[0] + a[1] * b[1]));
            }
    }
}

/* The load P on the top of the upper block as a pressure, consistent: 1/6, 4/6, 1/6 of each edge. */
static void add_load(const mesh *m, double whole, double *load)
{
    for (int e = 0; e < m->elements; e++) {
        const int32_t *corner = m->corner + 8 * e;
        const double *right = m->x + 2 * corner[2], *left = m->x + 2 * corner[3];
        const double part = whole * (right[0] - left[0]) / (2.0 * HALF);
        if (right[1] < HALF - 1e-9 || left[1] < HALF - 1e-9) continue;
        load[2 * corner[2] + 1] -= part / 6.0, load[2 * corner[3] + 1] -= part / 6.0, load[2 * corner[6] + 1] -= 4.0 * part / 6.0;
    }
}

/* Pressures at the nodes of the foot by a method. */
static void solve(const mesh *m, int32_t method, double load, double *pressure, feti_pair_facts *facts, feti_info *info)
{
    int32_t *ptr = demo_array(m->elements + 1, sizeof *ptr), *dof = demo_array(16 * m->elements, sizeof *dof);
    double *f = demo_array(2 * m->nodes, sizeof *f), *own = demo_array(m->unknowns, sizeof *own), ke[256];
    feti_problem *problem = NULL;
    int64_t body, surface[2], pair;

    for (int e = 0; e < m->elements; e++)
        for (int i = 0; i < 16; i++) ptr[e + 1] = 16 * (e + 1), dof[16 * e + i] = m->number[2 * m->corner[8 * e + i / 2] + i % 2];
    add_load(m, load, f);
    for (int i = 0; i < 2 * m->nodes; i++)
        if (m->number[i] >= 0) own[m->number[i]] = f[i];
    CALL(feti_problem_create(&problem));
    CALL(feti_body_add(problem, m->unknowns, &body));
    CALL(feti_body_mesh_i32(problem, body, m->elements, ptr, dof, 0));
    for (int e = 0; e < m->elements; e++) {
        element(m, m->corner + 8 * e, ke);
        CALL(feti_body_element(problem, body, e, 16, ke, 16));
    }
    CALL(feti_body_load(problem, body, m->unknowns, own));
    for (int up = 0; up < 2; up++) {
        CALL(feti_surface_add_i32(problem, body, 2, m->nodes, m->x, 2, m->number, 2, 0, &surface[up]));
        CALL(feti_surface_faces_i32(problem, surface[up], FETI_LINE3, m->faces[up], m->face[up], 0));
    }
    CALL(feti_pair_add(problem, surface[1], surface[0], method, A, &pair, NULL));
    CALL(feti_pairs_find(problem));
    CALL(feti_solve(problem, info));
    CALL(feti_pair_field(problem, pair, FETI_PRESSURE, m->nodes, pressure));
    CALL(feti_pair_info(problem, pair, facts));
    CALL(feti_problem_destroy(&problem));
    free(ptr), free(dof), free(f), free(own);
}

/* Pressures along the foot within 1.5 a; the largest error within .9 a against the largest pressure p0. */
static double draw(const mesh *m, const double *pressure, double p0, const char *folder, const char *file, const char *title)
{
    enum { SAMPLES = 200 };
    double *x = demo_array(m->nodes, sizeof *x), *y = demo_array(m->nodes, sizeof *y), curve_x[SAMPLES + 1], curve_y[SAMPLES + 1], worst = 0.0;
    picture plot = { title, "x / mm", "pressure / MPa", "nodes of the foot", "Hertz", 0, SAMPLES + 1, x, y, curve_x, curve_y, NULL };

    for (int k = 0; k < 3 * m->faces[1]; k++) {
        const int32_t node = m->face[1][k];
        const double at = m->x[2 * node];
        if (k % 3 == 1 && k + 3 < 3 * m->faces[1]) continue; /* the first node of the next face */
        if (fabs(at) > 1.5 * A) continue;
        x[plot.points] = at, y[plot.points++] = pressure[node];
        if (fabs(at) < 0.9 * A) worst = fmax(worst, fabs(pressure[node] - p0 * sqrt(1.0 - at * at / (A * A))) / p0);
    }
    for (int k = 0; k <= SAMPLES; k++) {
        curve_x[k] = A * (2.0 * k / SAMPLES - 1.0);
        curve_y[k] = p0 * sqrt(fmax(0.0, 1.0 - curve_x[k] * curve_x[k] / (A * A)));
    }
    if (picture_svg(folder, file, &plot) != 0) demo_stop("the picture cannot be written");
    free(x), free(y);
    return worst;
}

int main(int argc, char **argv)
{
    const double stiff = YOUNG / (2.0 * (1.0 - POISSON * POISSON)), load = PI * A * A * stiff / (4.0 * R), p0 = 2.0 * load / (PI * A);
    const char *folder = demo_picture_folder(argc, argv);
    mesh m = { 0, 0, 0, { 0, 0 }, NULL, NULL, NULL, { NULL, NULL } };
    feti_info info[2] = { { .struct_size = sizeof info[0] }, { .struct_size = sizeof info[0] } };
    feti_pair_facts facts[2] = { { .struct_size = sizeof facts[0] }, { .struct_size = sizeof facts[0] } };
    double *pressure[2], mortar, nodes, error = 0.0;

    m.x = demo_array(2 * AT_ALL, sizeof *m.x), m.number = demo_array(2 * AT_ALL, sizeof *m.number);
    m.corner = demo_array(8 * AT_ALL, sizeof *m.corner);
    for (int up = 0; up < 2; up++) m.face[up] = demo_array(3 * 4 * LINES, sizeof *m.face[up]);
    add_block(&m, 0, 0.2 * A);
    add_block(&m, 1, 0.25 * A);
    for (int k = 0; k < 2; k++) {
        pressure[k] = demo_array(m.nodes, sizeof *pressure[k]);
        solve(&m, k == 0 ? FETI_MORTAR : FETI_NODE_TO_FACE, load, pressure[k], &facts[k], &info[k]);
        error = fmax(error, hypot(facts[k].force[0], facts[k].force[1] - load) / load);
    }
    mortar = draw(&m, pressure[0], p0, folder, "hertz_by_mortar.svg", "Pressure by mortar, faces with mid nodes");
    nodes = draw(&m, pressure[1], p0, folder, "hertz_by_nodes.svg", "Pressure by node-to-face, faces with mid nodes");
    demo_value("load", load, "N");
    demo_value("largest pressure, Hertz", p0, "MPa");
    demo_value("largest pressure, mortar", facts[0].pressure, "MPa");
    demo_value("largest pressure, node-to-face", facts[1].pressure, "MPa");
    demo_value("error of mortar inside .9 a", 100.0 * mortar, "%");
    demo_value("error of node-to-face", 100.0 * nodes, "%");
    free(m.x), free(m.number), free(m.corner), free(m.face[0]), free(m.face[1]), free(pressure[0]), free(pressure[1]);
    return demo_line("19_hertz_by_mortar", &info[0], error, mortar < 0.02 && nodes > 0.1 && info[1].status == FETI_OK);
}
