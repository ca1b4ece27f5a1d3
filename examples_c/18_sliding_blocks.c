/* 18 Two blocks, large sliding with friction: contact by surfaces.

   A block with a crowned foot is pressed on another block and then pushed along it by 1.5 times its width, with friction. Meshes of quadrilaterals
   do not match; material of St. Venant and Kirchhoff (Green's strain), plane strain, 1 mm thick. The host iterates: in every iteration it
   assembles element matrices and internal forces at the present positions, and the library finds the partner of every node of the foot, makes the
   rows of contact and friction, and solves for the increment. Supports are in a table of unknowns; the top of the upper block is driven.

   Between the two marks below stands everything that contact adds to the host: from coordinates, faces, element matrices and supports to pressures
   and resultant.

   Known by hand: when the block slides, every node of its foot that touches has the shear mu x pressure, against the motion; and the
   resultant on the foot holds the forces at the top. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "demo.h"
#include "picture.h"

enum { BELOW_X = 40, BELOW_Y = 5, ABOVE_X = 16, ABOVE_Y = 8, BELOW = (BELOW_X + 1) * (BELOW_Y + 1), ABOVE = (ABOVE_X + 1) * (ABOVE_Y + 1),
       NODES = BELOW + ABOVE, N = 2 * NODES, ELEMENTS = BELOW_X * BELOW_Y + ABOVE_X * ABOVE_Y, FOOT = ABOVE_X + 1, STEPS = 7, MOST = 20 };
static const double YOUNG = 1000.0, POISSON = 0.3, MU = 0.3;                         /* MPa, -, - */
static const double LENGTH = 40.0, HEIGHT = 8.0, WIDTH = 10.0, TALL = 6.0, R = 60.0; /* mm; R: radius of the foot */
static const double LEFT = 6.0, DEPTH = 0.25, SLIDE = 15.0;                          /* mm: where the block stands, how far it goes */

/* The mesh of both blocks: positions at rest, unknown of K of each direction (-1: held), corners of elements, faces that may touch. */
typedef struct {
    double x[N];
    int32_t number[N], own[N], corner[4 * ELEMENTS], ptr[ELEMENTS + 1], dof[8 * ELEMENTS], below[2 * BELOW_X], foot[2 * ABOVE_X];
    int32_t unknowns;
} mesh;

/* Of contact, by node; `state`: 0 open, 2 sticks, 3 slips. */
typedef struct {
    double pressure[NODES], shear[N], force[NODES], gap[NODES], state[NODES]; /* MPa, N, mm */
    feti_pair_facts facts;
} results;

/* Nodes row by row from below; the first of them has number `first`. */
static int node_at(int first, int nx, int i, int j)
{
    return first + j * (nx + 1) + i;
}

static void add_block(mesh *m, int first, int element, int nx, int ny, int held_row)
{
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++) {
            const int node = node_at(first, nx, i, j);
            const double s = (double)i / nx, t = (double)j / ny, off = WIDTH * (s - 0.5);
            m->x[2 * node] = first ? LEFT + WIDTH * s : LENGTH * s;
            m->x[2 * node + 1] = first ? HEIGHT + t * TALL + (1.0 - t) * off * off / (2.0 * R) : HEIGHT * t;
            for (int d = 0; d < 2; d++) m->number[2 * node + d] = j == held_row ? -1 : m->unknowns++;
        }
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++, element++) {
            const int corner[4] = { node_at(first, nx, i, j), node_at(first, nx, i + 1, j), node_at(first, nx, i + 1, j + 1),
                                    node_at(first, nx, i, j + 1) };
            for (int a = 0; a < 4; a++) m->corner[4 * element + a] = corner[a];
        }
}

/* In the plane the body is on the left of its faces: the top of the lower block goes backwards, the foot of the upper one forwards. */
static void make_mesh(mesh *m)
{
    m->unknowns = 0;
    add_block(m, 0, 0, BELOW_X, BELOW_Y, 0);
    add_block(m, BELOW, BELOW_X * BELOW_Y, ABOVE_X, ABOVE_Y, ABOVE_Y);
    for (int i = 0; i < N; i++) m->own[i] = i;
    for (int e = 0; e < ELEMENTS; e++)
        for (int a = 0; a < 8; a++) m->ptr[e] = 8 * e, m->dof[8 * e + a] = m->number[2 * m->corner[4 * e + a / 2] + a % 2];
    m->ptr[ELEMENTS] = 8 * ELEMENTS;
    for (int i = 0; i < BELOW_X; i++)
        m->below[2 * i] = node_at(0, BELOW_X, i + 1, BELOW_Y), m->below[2 * i + 1] = node_at(0, BELOW_X, i, BELOW_Y);
    for (int i = 0; i < ABOVE_X; i++) m->foot[2 * i] = BELOW + i, m->foot[2 * i + 1] = BELOW + i + 1;
}

/* Adds one point of integration of an element: F = sum x_a g_a', Green's strain E = (F'F - I)/2, stress S = lame tr(E) I + 2 shear E,

       f_a = w F S g_a,   K_ab = w (lame F g_a (F g_b)' + shear (F g_b (F g_a)' + g_a'g_b F F') + g_a'S g_b I) */
static void add_point(const double *rest, const double *now, const int32_t *corner, double s, double t, double *ke, double *fe)
{
    static const double place[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    const double shear = YOUNG / (2.0 * (1.0 + POISSON)), lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
    double g[4][2], J[2][2] = { { 0 } }, F[2][2] = { { 0 } }, S[2][2], FF[2][2], Fg[4][2], w, trace;

    for (int a = 0; a < 4; a++) {
        g[a][0] = place[a][0] * (1.0 + place[a][1] * t) / 4.0, g[a][1] = place[a][1] * (1.0 + place[a][0] * s) / 4.0;
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) J[c][d] += g[a][c] * rest[2 * corner[a] + d];
    }
    w = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    for (int a = 0; a < 4; a++) {
        const double slope[2] = { g[a][0], g[a][1] };
        g[a][0] = (J[1][1] * slope[0] - J[0][1] * slope[1]) / w, g[a][1] = (J[0][0] * slope[1] - J[1][0] * slope[0]) / w;
        for (int c = 0; c < 2; c++)
            for (int d = 0; d < 2; d++) F[c][d] += now[2 * corner[a] + c] * g[a][d];
    }
    trace = (F[0][0] * F[0][0] + F[0][1] * F[0][1] + F[1][0] * F[1][0] + F[1][1] * F[1][1] - 2.0) / 2.0;
    for (int c = 0; c < 2; c++)
        for (int d = 0; d < 2; d++) {
            FF[c][d] = F[c][0] * F[d][0] + F[c][1] * F[d][1];
            S[c][d] = shear * (F[0][c] * F[0][d] + F[1][c] * F[1][d] - (c == d)) + (c == d) * lame * trace;
        }
    for (int a = 0; a < 4; a++)
        for (int c = 0; c < 2; c++) Fg[a][c] = F[c][0] * g[a][0] + F[c][1] * g[a][1];
    for (int a = 0; a < 4; a++) {
        const double Sg[2] = { S[0][0] * g[a][0] + S[0][1] * g[a][1], S[1][0] * g[a][0] + S[1][1] * g[a][1] };
        for (int c = 0; c < 2; c++) fe[2 * a + c] += w * (F[c][0] * Sg[0] + F[c][1] * Sg[1]);
        for (int b = 0; b < 4; b++) {
            const double gg = g[a][0] * g[b][0] + g[a][1] * g[b][1], stress = Sg[0] * g[b][0] + Sg[1] * g[b][1];
            for (int c = 0; c < 2; c++)
                for (int d = 0; d < 2; d++)
                    ke[2 * a + c + 8 * (2 * b + d)] += w * (lame * Fg[a][c] * Fg[b][d]
                        + shear * (Fg[b][c] * Fg[a][d] + gg * FF[c][d]) + (c == d) * stress);
        }
    }
}

/* Element matrices and internal forces at the positions `now`. The load of the increment: minus internal forces, and minus the part
   of K that acts on what held unknowns still have to go. */
static void assemble(const mesh *m, const double *now, const double *left, double *ke, double *internal, double *load)
{
    const double gauss = sqrt(1.0 / 3.0);

    memset(ke, 0, 64 * ELEMENTS * sizeof *ke);
    memset(internal, 0, N * sizeof *internal);
    memset(load, 0, N * sizeof *load);
    for (int e = 0; e < ELEMENTS; e++) {
        const int32_t *corner = m->corner + 4 * e;
        double fe[8] = { 0.0 }, *k = ke + 64 * e;
        for (int p = 0; p < 4; p++) add_point(m->x, now, corner, p % 2 ? gauss : -gauss, p / 2 ? gauss : -gauss, k, fe);
        for (int i = 0; i < 8; i++) {
            const int at = 2 * corner[i / 2] + i % 2;
            internal[at] += fe[i], load[at] -= fe[i];
            for (int j = 0; j < 8; j++) load[at] -= k[i + 8 * j] * left[2 * corner[j / 2] + j % 2];
        }
    }
}

/* ---- Contact: all that the host needs of the library. ---- */
typedef struct {
    feti_problem *problem;
    int64_t body, below, foot, pair;
} contact;

static void begin_contact(contact *c, const mesh *m)
{
    CALL(feti_problem_create(&c->problem));
    CALL(feti_body_add(c->problem, m->unknowns, &c->body));
    CALL(feti_body_mesh_i32(c->problem, c->body, ELEMENTS, m->ptr, m->dof, 0));
    CALL(feti_dof_table_i32(c->problem, N, m->number, NULL, NULL, NULL, NULL, 0));
    CALL(feti_surface_add_i32(c->problem, FETI_ALL, 2, NODES, m->x, 2, m->own, 2, 0, &c->below));
    CALL(feti_surface_faces_i32(c->problem, c->below, FETI_LINE2, BELOW_X, m->below, 0));
    CALL(feti_surface_add_i32(c->problem, FETI_ALL, 2, NODES, m->x, 2, m->own, 2, 0, &c->foot));
    CALL(feti_surface_faces_i32(c->problem, c->foot, FETI_LINE2, ABOVE_X, m->foot, 0));
    CALL(feti_pair_add(c->problem, c->foot, c->below, FETI_NODE_TO_FACE, 1.0, &c->pair, NULL));
    CALL(feti_pair_set_f64(c->problem, c->pair, "friction", 1, &MU));
}

static void begin_step(contact *c)
{
    CALL(feti_pairs_commit(c->problem)); /* slips count from here */
}

static void move_to(contact *c, const double *now)
{
    CALL(feti_surface_move(c->problem, c->below, now, 2));
    CALL(feti_surface_move(c->problem, c->foot, now, 2));
}

/* The increment d at the positions `now`; `left`: what held unknowns still have to go. */
static void find_increment(contact *c, const mesh *m, const double *now, const double *left,
                           const double *ke, const double *load, double *d, feti_info *info)
{
    move_to(c, now);
    CALL(feti_dof_table_i32(c->problem, N, m->number, NULL, NULL, NULL, left, 0));
    CALL(feti_pairs_find(c->problem));
    CALL(feti_body_elements(c->problem, c->body, 0, ELEMENTS, ke, FETI_FULL));
    CALL(feti_body_load(c->problem, FETI_ALL, N, load));
    CALL(feti_solve(c->problem, info));
    CALL(feti_displacement(c->problem, FETI_ALL, N, d));
}

static void get_results(contact *c, const double *now, results *r)
{
    move_to(c, now);
    CALL(feti_pair_field(c->problem, c->pair, FETI_PRESSURE, NODES, r->pressure));
    CALL(feti_pair_field(c->problem, c->pair, FETI_SHEAR, N, r->shear));
    CALL(feti_pair_field(c->problem, c->pair, FETI_FORCE, NODES, r->force));
    CALL(feti_pair_field(c->problem, c->pair, FETI_GAP, NODES, r->gap));
    CALL(feti_pair_field(c->problem, c->pair, FETI_CLOSED, NODES, r->state));
    CALL(feti_pair_info(c->problem, c->pair, &r->facts));
}

static void end_contact(contact *c)
{
    CALL(feti_problem_destroy(&c->problem));
}
/* ---- End of contact. ---- */

/* A step of the film. Where nothing is held, internal forces balance those of contact. */
static void draw(const char *folder, int step, const mesh *m, const double *now, const double *internal, results *r)
{
    const double shear = YOUNG / (2.0 * (1.0 + POISSON)), lame = 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON);
    double u[N], force[N];
    const picture_plane plane = { NODES, ELEMENTS, BELOW_X * BELOW_Y, m->corner, m->x, u, force, r->force, r->gap, r->state, shear, lame };

    for (int i = 0; i < N; i++) {
        u[i] = now[i] - m->x[i], force[i] = m->number[i] < 0 ? 0.0 : internal[i];
        if (i / 2 < BELOW || i / 2 >= BELOW + FOOT) r->gap[i / 2] = NAN, r->state[i / 2] = -1.0;
    }
    if (picture_step(folder, "sliding_blocks", step, &plane) != 0) demo_stop("the picture cannot be written");
}

/* Where the top of the upper block is to go in a step: down in the first, then along. */
static double goal_of(int step, int i)
{
    if (i < 2 * BELOW) return 0.0;
    return i % 2 ? -DEPTH : SLIDE * step / (STEPS - 1);
}

int main(int argc, char **argv)
{
    const char *folder = demo_picture_folder(argc, argv);
    static mesh m;
    static double ke[64 * ELEMENTS];
    static results r = { .facts.struct_size = sizeof r.facts };
    double now[N], left[N], d[N], internal[N], load[N], error, held[2] = { 0.0, 0.0 };
    feti_info info = { .struct_size = sizeof info };
    contact c;
    int longest = 0, sliding = 1;

    make_mesh(&m);
    memcpy(now, m.x, sizeof now);
    begin_contact(&c, &m);
    for (int step = 0; step < STEPS; step++) {
        double change = 1.0;
        int iterations = 0;
        begin_step(&c);
        while (change > 1e-10 * WIDTH && iterations++ < MOST) {
            for (int i = 0; i < N; i++) left[i] = m.number[i] < 0 ? m.x[i] + goal_of(step, i) - now[i] : 0.0;
            assemble(&m, now, left, ke, internal, load);
            find_increment(&c, &m, now, left, ke, load, d, &info);
            change = 0.0;
            for (int i = 0; i < N; i++) now[i] += d[i], change = fmax(change, fabs(d[i]));
        }
        longest = iterations > longest ? iterations : longest;
        get_results(&c, now, &r);
        assemble(&m, now, left, ke, internal, load);
        draw(folder, step, &m, now, internal, &r);
        printf("step %d: %2d iterations, %2d nodes touch, %2d slip, force on the foot %11.6f N up, %11.6f N along\n", step, iterations,
               (int)r.facts.closed, (int)r.facts.slipping, r.facts.force[1], r.facts.force[0]);
    }
    end_contact(&c);
    if (picture_pvd(folder, "sliding_blocks", STEPS) != 0) demo_stop("the film cannot be written");

    for (int i = 0; i <= ABOVE_X; i++)
        for (int dir = 0; dir < 2; dir++) held[dir] += internal[2 * node_at(BELOW, ABOVE_X, i, ABOVE_Y) + dir];
    error = hypot(held[0] + r.facts.force[0], held[1] + r.facts.force[1]) / hypot(held[0], held[1]);
    for (int node = BELOW; node <= BELOW + ABOVE_X; node++) {
        const double size = hypot(r.shear[2 * node], r.shear[2 * node + 1]);
        if (r.state[node] == 0.0) continue;
        sliding = sliding && r.state[node] == 3.0 && r.shear[2 * node] < 0.0;
        error = fmax(error, fabs(size - MU * r.pressure[node]) / (MU * r.facts.pressure));
    }
    demo_value("most iterations of a load step", longest, "-");
    demo_value("largest pressure", r.facts.pressure, "MPa");
    demo_value("force on the foot, up", r.facts.force[1], "N");
    demo_value("force on the foot, along", r.facts.force[0], "N");
    demo_value("area that touches", r.facts.closed_area, "mm2");
    return demo_line("18_sliding_blocks", &info, error, sliding && r.facts.closed > 3 && longest < MOST);
}
