/* Contact of CalculiX 2.20 by feti-contact: called at the places of nonlingeo.c that insert.py knows.

   CalculiX keeps its mesh, loads, materials and its loop, and moves the nodes of ADJUST; it makes no contact elements. In every iteration K (ad, au) and the
   residual b come from CalculiX, rows and gaps from surfaces at co + vold, and the increments of the unknowns of K go back in b. Environment: CCX_CONTACT=feti switches this on;
   CCX_CONTACT=compliance also lets LINEAR surfaces yield by 1/slope, as those of CalculiX do.

   Arrays of CalculiX count from 1. An unknown of the mesh has the number mt (node - 1) + direction, as in nactdof. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "CalculiX.h"
#include "feti_contact.h"
#include "glue.h"

#define GROW(array, n) c.array = realloc(c.array, ((size_t)(n) + 1) * sizeof *c.array)
static struct {
    feti_problem *problem;
    int64_t body, pairs, surfaces;
    ITG nodes, mt, unknowns, status, without_stress, *dof, *node, *dir, *number, *ptr, *term;
    double *x, *xyz, *constant, *coefficient, *force;
    char text[1000];
} c;

/* Of CalculiX: shape of a face, numbers of its nodes in the element. */
void FORTRAN(faceinfo, (ITG *element, ITG *face, char *lakon, ITG *of_element, ITG *of_face, ITG *rule));
ITG FORTRAN(getnodel, (ITG *i, ITG *face, ITG *of_element));

char *feti_wish(void)
{
    return getenv("CCX_CONTACT");
}

static void call(int32_t status)
{
    if (status == FETI_OK) return;
    feti_last_error(c.text, sizeof c.text);
    printf(" *ERROR in contact by feti-contact: %s\n", c.text);
    exit(201);
}

static void move(double *co, double *vold)
{
    for (ITG i = 0; i < 3 * c.nodes; i++) c.x[i] = co[i] + vold[c.dof[i]];
    for (int64_t s = 0; s < c.surfaces; s++) call(feti_surface_move(c.problem, s, c.x, 3));
}

/* A surface over the nodes of the mesh: some points, or the faces code[0], code[stride], .. = 10 element + face, of which some may repeat the one before. */
static int64_t add_surface(ITG points, ITG *point, ITG *code, ITG stride, ITG count, ITG *ipkon, ITG *kon, char *lakon)
{
    static const int32_t shape[] = { FETI_TRI3, FETI_TRI6, FETI_QUAD4, FETI_QUAD8 }, size[] = { 3, 6, 4, 8 };
    ITG *node = malloc((8 * count + 1) * sizeof *node), n;
    call(feti_surface_add_i32(c.problem, FETI_ALL, 3, c.nodes, c.x, 3, c.dof, 3, 0, &c.surfaces));
    if (points) call(feti_surface_faces_i32(c.problem, c.surfaces, FETI_POINT, points, point, 1));
    for (int k = 0; k < 4 && !points; k++) {
        n = 0;
        for (ITG i = 0; i < count; i++) {
            ITG element = code[i * stride] / 10, face = code[i * stride] % 10, of_element, of_face, rule;
            FORTRAN(faceinfo, (&element, &face, lakon, &of_element, &of_face, &rule));
            if ((i && code[i * stride] == code[(i - 1) * stride]) || of_face != size[k]) continue;
            for (ITG a = 1; a <= of_face; a++) node[n++] = kon[ipkon[element - 1] + FORTRAN(getnodel, (&a, &face, &of_element)) - 1];
        }
        if (n) call(feti_surface_faces_i32(c.problem, c.surfaces, shape[k], n / size[k], node, 1));
    }
    free(node);
    return c.surfaces++;
}

/* Supports and equations, as what is left to go: an eliminated unknown is constant + sum coefficient x term. */
void feti_table(ITG *nactdof, double *xbounact, ITG *ipompc, ITG *nodempc, double *coefmpc, double *co, double *vold)
{
    ITG terms = 0;
    for (ITG i = 0; i < c.mt * c.nodes; c.ptr[++i] = terms) {
        const ITG kind = nactdof[i], own = kind - 1, node = i / c.mt, first = kind < 0 && kind % 2 ? ipompc[(-kind - 1) / 2] : 0;
        c.ptr[0] = 0, c.number[i] = kind > 0 ? own : -1;
        c.constant[i] = kind < 0 ? (first ? 0.0 : xbounact[-kind / 2 - 1]) - vold[i] : 0.0;
        for (ITG k = first ? nodempc[3 * first - 1] : 0; k; k = nodempc[3 * k - 1], terms++) {
            c.term[terms] = c.mt * (nodempc[3 * k - 3] - 1) + nodempc[3 * k - 2];
            c.coefficient[terms] = -coefmpc[k - 1] / coefmpc[first - 1];
            c.constant[i] += c.coefficient[terms] * vold[c.term[terms]];
        }
        for (int d = 0; d < 3 && kind > 0; d++) c.xyz[3 * own + d] = co[3 * node + d] + vold[c.mt * node + d + 1];
        if (kind > 0) c.node[own] = node, c.dir[own] = i % c.mt;
    }
    call(feti_dof_table_i32(c.problem, c.mt * c.nodes, c.number, c.ptr, c.term, c.coefficient, c.constant, 0));
    move(co, vold);
}

/* At the begin of a step: a pair for each *CONTACT PAIR, face to face by mortar. Its slave is a cloud of points if there is a set of nodes with its name.
   Material of a pair: law[2] slope, law[3] kind (2 LINEAR, 4 TIED), law[6] coefficient of friction. */
void feti_begin(ITG fits, ITG by_faces, ITG ntie, char *tieset, char *set, ITG nset, double *tietol, ITG *itietri, ITG *koncont, ITG *itiefac, ITG *islavsurf,
                ITG *nslavnode, ITG *islavnode, ITG *ipkon, ITG *kon, char *lakon, ITG nk, ITG mt, ITG neq, double *elcon, ITG values, ITG *nactdof, ITG terms,
                double *co, double *vold, double *xbounact, ITG *ipompc, ITG *nodempc, double *coefmpc)
{
    double size = 0.0;
    if (!fits) printf(" *ERROR in contact by feti-contact: the step has to be static and mechanical, with SOLVER=SPOOLES\n"), exit(201);
    c.nodes = nk, c.mt = mt, c.unknowns = neq, c.pairs = c.surfaces = 0;
    GROW(x, 3 * nk), GROW(dof, 3 * nk), GROW(xyz, 3 * neq), GROW(node, neq), GROW(dir, neq), GROW(force, neq), GROW(term, terms), GROW(coefficient, terms);
    GROW(number, mt * nk), GROW(constant, mt * nk), GROW(ptr, mt * nk);
    if (c.problem) call(feti_problem_destroy(&c.problem));
    call(feti_problem_create(&c.problem));
    call(feti_body_add(c.problem, neq, &c.body));
    for (ITG i = 0; i < 3 * nk; i++) c.dof[i] = mt * (i / 3) + i % 3 + 1;
    feti_table(nactdof, xbounact, ipompc, nodempc, coefmpc, co, vold);
    for (ITG i = 0; i < 3 * nk; i++) size = fmax(size, fabs(co[i] - co[i % 3]));
    for (ITG i = 0; i < ntie; i++) {
        char *tie = tieset + 243 * i; /* 81 characters for name and kind, then the sets of slave and master */
        const double *law = elcon + values * ((ITG)tietol[4 * i + 1] - 1), yield = 1.0 / law[2];
        const ITG kind = (ITG)law[3], points = nslavnode[i + 1] - nslavnode[i], method = by_faces ? FETI_MORTAR : FETI_NODE_TO_FACE;
        ITG faces = 1, *first = islavsurf + 2 * (itiefac[2 * i] - 1), *triangle = koncont + 4 * itietri[2 * i] - 1;
        if (tie[80] != 'C') continue;
        for (ITG k = 0; k < nset; k++) faces = faces && (strchr(tie + 81, ' ')[-1] == 'T' || memcmp(set + 81 * k, tie + 81, 81));
        const int64_t slave = add_surface(faces ? 0 : points, islavnode + nslavnode[i], first, 2, itiefac[2 * i + 1] - itiefac[2 * i] + 1, ipkon, kon, lakon);
        const int64_t master = add_surface(0, NULL, triangle, 4, itietri[2 * i + 1] - itietri[2 * i] + 1, ipkon, kon, lakon);
        call(feti_pair_add(c.problem, slave, master, method + (kind == 4 ? FETI_TIED : 0), 0.1 * size, &c.pairs, NULL));
        if (values > 7 && kind != 4) call(feti_pair_set_f64(c.problem, c.pairs, "friction", 1, law + 6));
        if (faces && kind == 2 && !strcmp(feti_wish(), "compliance")) call(feti_pair_set_f64(c.problem, c.pairs, "compliance", 1, &yield));
        c.pairs++;
    }
}

/* An increment begins: slips count from here. */
void feti_commit(double *co, double *vold)
{
    move(co, vold);
    call(feti_pairs_commit(c.problem));
}

/* b: the residual, then the increment. 1: K is indefinite, so this iteration is to be repeated without its stress term. */
ITG feti_again(double *ad, double *au, ITG *jq, ITG *irow, double *b, ITG finite)
{
    call(feti_body_stiffness_split_i32(c.problem, c.body, c.unknowns, ad, jq, irow, au, 1, FETI_UPPER, FETI_COPY));
    if (finite) call(feti_body_coordinates(c.problem, c.body, 3, c.unknowns, c.node, c.dir, c.xyz, 3));
    if (finite) call(feti_body_coordinates_flags(c.problem, c.body, FETI_SOFT));
    call(feti_body_load(c.problem, c.body, c.unknowns, b));
    c.status = feti_pairs_find(c.problem);
    if (c.status == FETI_OK) c.status = feti_solve(c.problem, NULL);
    feti_last_error(c.text, sizeof c.text);
    printf(" feti-contact: %s%s %s\n\n", feti_status_name(c.status), c.without_stress ? " without stress term" : "", c.status ? c.text : "");
    if (c.status == FETI_INDEFINITE && finite && !c.without_stress) return c.without_stress = 1;
    c.without_stress = 0;
    memset(b, 0, c.unknowns * sizeof *b), memset(c.force, 0, c.unknowns * sizeof *c.force);
    if (c.status != FETI_OK && c.status != FETI_MARGINAL) return 0;
    call(feti_displacement(c.problem, c.body, c.unknowns, b));
    call(feti_reaction(c.problem, 0, c.body, c.unknowns, c.force));
    return 0;
}

/* Forces of contact join the residual; without an answer CalculiX is to try a smaller increment. */
void feti_residual(double *b, double *qa, double *co, double *vold)
{
    feti_pair_facts facts = { .struct_size = sizeof facts };
    for (ITG i = 0; i < c.unknowns; i++) b[i] += c.force[i];
    if (c.status != FETI_OK && c.status != FETI_MARGINAL) qa[2] = 1.0;
    move(co, vold);
    for (int64_t i = 0; i < c.pairs; i++) {
        call(feti_pair_info(c.problem, i, &facts));
        printf(" feti-contact: pair %d: %d nodes closed, depth %e, of the master %e\n", (int)i + 1, (int)facts.closed, facts.depth, facts.master_depth);
    }
}
