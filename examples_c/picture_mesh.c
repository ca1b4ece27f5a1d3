/* Elements with their stress, and faces in contact with their pressure, for pictures. */
#include <math.h>
#include <stdlib.h>

#include "picture.h"

enum { NODES_MAX = 20, FACES_MAX = 6, FACE_MAX = 8 };

/* An element: its faces, by the places of their nodes in it, corners first. */
typedef struct {
    int32_t type, faces, face_type, face_corners, face_nodes;
    int face[FACES_MAX][FACE_MAX];
} kind;

static const kind KINDS[] = {
    { PICTURE_QUAD, 4, PICTURE_LINE, 2, 2, { { 0, 1 }, { 1, 2 }, { 2, 3 }, { 3, 0 } } },
    { PICTURE_HEXAHEDRON, 6, PICTURE_QUAD, 4, 4,
      { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 }, { 1, 2, 6, 5 }, { 2, 3, 7, 6 }, { 3, 0, 4, 7 } } },
    { PICTURE_TETRAHEDRON10, 4, PICTURE_TRIANGLE6, 3, 6,
      { { 0, 2, 1, 6, 5, 4 }, { 0, 1, 3, 4, 8, 7 }, { 1, 2, 3, 5, 9, 8 }, { 2, 0, 3, 6, 7, 9 } } },
    { PICTURE_HEXAHEDRON20, 6, PICTURE_QUAD8, 4, 8,
      { { 0, 3, 2, 1, 11, 10, 9, 8 }, { 4, 5, 6, 7, 12, 13, 14, 15 }, { 0, 1, 5, 4, 8, 17, 12, 16 },
        { 1, 2, 6, 5, 9, 18, 13, 17 }, { 2, 3, 7, 6, 10, 19, 14, 18 }, { 3, 0, 4, 7, 11, 16, 15, 19 } } },
};

static const kind *kind_of(int32_t type)
{
    const kind *found = KINDS;
    while (found->type != type) found++;
    return found;
}

/* Gradient in the middle of an element of the shape function of its node i, in the element's own coordinates. */
static void gradient(int32_t type, int i, double g[3])
{
    /* Quadrilateral and hexahedra: the node's place in [-1, 1]^3; tetrahedron: the corners at the ends of a middle node's edge. */
    static const int place[NODES_MAX][3] = { { -1, -1, -1 }, { 1, -1, -1 }, { 1, 1, -1 }, { -1, 1, -1 }, { -1, -1, 1 },
                                             { 1, -1, 1 }, { 1, 1, 1 }, { -1, 1, 1 }, { 0, -1, -1 }, { 1, 0, -1 },
                                             { 0, 1, -1 }, { -1, 0, -1 }, { 0, -1, 1 }, { 1, 0, 1 }, { 0, 1, 1 },
                                             { -1, 0, 1 }, { -1, -1, 0 }, { 1, -1, 0 }, { 1, 1, 0 }, { -1, 1, 0 } };
    static const int ends[10][2] = { { 0, 0 }, { 0, 0 }, { 0, 0 }, { 0, 0 }, { 0, 1 }, { 1, 2 }, { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };

    for (int k = 0; k < 3; k++) {
        if (type == PICTURE_TETRAHEDRON10) /* N = L (2 L - 1), 4 L L', all L = 1/4: the corners have none */
            g[k] = i < 4 ? 0.0 : (ends[i][1] == k + 1) + (ends[i][0] == k + 1) - (ends[i][0] == 0);
        else if (type == PICTURE_QUAD)
            g[k] = k < 2 ? 0.25 * place[i][k] : 0.0;
        else if (type == PICTURE_HEXAHEDRON)
            g[k] = 0.125 * place[i][k];
        else
            g[k] = (i < 8 ? -0.125 : 0.25) * place[i][k];
    }
}

/* a = a b^-1 */
static void divide(double a[3][3], double b[3][3])
{
    double inverse[3][3], det = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int p = (j + 1) % 3, q = (j + 2) % 3, r = (i + 1) % 3, s = (i + 2) % 3;
            inverse[i][j] = b[p][r] * b[q][s] - b[p][s] * b[q][r];
        }
    for (int k = 0; k < 3; k++) det += b[0][k] * inverse[k][0];
    for (int i = 0; i < 3; i++) {
        const double row[3] = { a[i][0], a[i][1], a[i][2] };
        for (int j = 0; j < 3; j++)
            a[i][j] = (row[0] * inverse[0][j] + row[1] * inverse[1][j] + row[2] * inverse[2][j]) / det;
    }
}

/* Cauchy's stress F S F'/det F of St. Venant and Kirchhoff's material, from the gradient of u: F = I + grad u, Green's strain E = (F'F - I)/2,
   S = lame tr(E) I + 2 G E. */
static void cauchy(double grad[3][3], const picture_answer *answer, double stress[3][3])
{
    double F[3][3], S[3][3], trace = 0.0, det = 0.0;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) F[i][j] = (i == j) + grad[i][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            S[i][j] = answer->shear_modulus * (F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j] - (i == j));
            if (i == j) trace += S[i][j] / (2.0 * answer->shear_modulus);
        }
    for (int i = 0; i < 3; i++) {
        const int p = (i + 1) % 3, q = (i + 2) % 3;
        S[i][i] += answer->lame * trace, det += F[0][i] * (F[1][p] * F[2][q] - F[1][q] * F[2][p]);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            stress[i][j] = 0.0;
            for (int k = 0; k < 9; k++) stress[i][j] += F[i][k / 3] * S[k / 3][k % 3] * F[j][k % 3] / det;
        }
}

/* Von Mises stress in the middle of an element, sqrt(3/2 s : s), of the deviator s of the stress, 2 G strain where displacements are small;
   plane strain in the plane. */
static double von_mises(const picture_grid *grid, int64_t cell, const picture_answer *answer)
{
    double place[3][3] = { { 0.0 } }, moved[3][3] = { { 0.0 } }, stress[3][3], sum = 0.0;

    for (int64_t k = grid->offset[cell]; k < grid->offset[cell + 1]; k++) {
        const int64_t node = grid->corner[k];
        double g[3];
        gradient(grid->type[cell], (int)(k - grid->offset[cell]), g);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                place[i][j] += grid->xyz[3 * node + i] * g[j];
                moved[i][j] += answer->u[3 * node + i] * g[j];
            }
    }
    if (grid->type[cell] == PICTURE_QUAD) place[2][2] = 1.0;
    divide(moved, place); /* the gradient of u */
    if (answer->large) cauchy(moved, answer, stress);
    for (int k = 0; k < 9 && !answer->large; k++)
        stress[k / 3][k % 3] = answer->shear_modulus * (moved[k / 3][k % 3] + moved[k % 3][k / 3]);
    const double mean = (stress[0][0] + stress[1][1] + stress[2][2]) / 3.0;
    for (int k = 0; k < 9; k++) {
        const double s = stress[k / 3][k % 3] - (k / 3 == k % 3 ? mean : 0.0);
        sum += 1.5 * s * s;
    }
    return sqrt(sum);
}

/* Length (times thickness 1) or area of a face with plane corners; `u`: displaced, NULL: at rest. */
static double area_of(const picture_grid *grid, const double *u, int64_t face, int32_t corners)
{
    const int64_t *node = grid->corner + grid->offset[face];
    const int to[2] = { corners == 4 ? 2 : 1, corners - 1 }, from[2] = { 0, corners == 4 ? 1 : 0 }; /* the diagonals of a quadrilateral */
    double a[2][3], square = 0.0;

    for (int k = 0; k < 6; k++) {
        const int64_t end = 3 * node[to[k / 3]] + k % 3, begin = 3 * node[from[k / 3]] + k % 3;
        a[k / 3][k % 3] = grid->xyz[end] - grid->xyz[begin] + (u ? u[end] - u[begin] : 0.0);
    }
    for (int k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        const double part = corners == 2 ? a[0][k] : (a[0][p] * a[1][q] - a[0][q] * a[1][p]) / 2.0;
        square += part * part;
    }
    return sqrt(square);
}

/* The grid with faces behind the elements, in arrays of its own. */
typedef struct {
    picture_grid grid;
    int64_t *numbers;
    int32_t *types;
} with_faces;

static int add_faces(const picture_grid *elements, const double *state, with_faces *out)
{
    const int64_t most = elements->cells * (1 + FACES_MAX), nodes = elements->offset[elements->cells];
    int64_t cells = elements->cells;

    out->numbers = malloc((size_t)(most + 1 + nodes + elements->cells * FACES_MAX * FACE_MAX) * sizeof *out->numbers);
    out->types = malloc((size_t)(2 * most + 1) * sizeof *out->types);
    if (!out->numbers || !out->types) return -1;
    int64_t *offset = out->numbers, *corner = out->numbers + most + 1;
    int32_t *type = out->types, *body = out->types + most;
    for (int64_t c = 0; c < cells; c++) offset[c] = elements->offset[c], type[c] = elements->type[c], body[c] = elements->body[c];
    for (int64_t k = 0; k < nodes; k++) corner[k] = elements->corner[k];
    offset[cells] = nodes;
    for (int64_t c = 0; c < elements->cells; c++) {
        const kind *element = kind_of(elements->type[c]);
        for (int f = 0; f < element->faces; f++) {
            int touches = 1;
            for (int k = 0; k < element->face_nodes; k++) {
                const int64_t node = elements->corner[elements->offset[c] + element->face[f][k]];
                corner[offset[cells] + k] = node;
                touches = touches && state[node] >= 0.0;
            }
            if (!touches) continue;
            type[cells] = element->face_type, body[cells] = elements->body[c];
            offset[cells + 1] = offset[cells] + element->face_nodes, cells++;
        }
    }
    const picture_grid grid = { elements->nodes, cells, elements->xyz, offset, corner, type, body };
    out->grid = grid;
    return 0;
}

static int32_t face_corners(int32_t type)
{
    return type == PICTURE_LINE ? 2 : type == PICTURE_TRIANGLE6 ? 3 : 4;
}

/* Pressure of every face behind the elements: its nodes share their forces among their faces by the area of these. NaN elsewhere. */
static void pressures(const picture_grid *grid, int64_t elements, const picture_answer *answer, double *around, double *pressure)
{
    for (int64_t i = 0; i < grid->nodes; i++) around[i] = 0.0;
    for (int64_t c = 0; c < grid->cells; c++) {
        pressure[c] = NAN;
        for (int64_t k = grid->offset[c]; c >= elements && k < grid->offset[c + 1]; k++)
            around[grid->corner[k]] += area_of(grid, answer->large ? answer->u : NULL, c, face_corners(grid->type[c]));
    }
    for (int64_t c = elements; c < grid->cells; c++) {
        pressure[c] = 0.0;
        for (int64_t k = grid->offset[c]; k < grid->offset[c + 1]; k++)
            pressure[c] += answer->push[grid->corner[k]] / around[grid->corner[k]];
    }
}

int picture_mesh(const char *folder, const char *name, const picture_grid *elements, const picture_answer *answer)
{
    with_faces all = { { 0, 0, NULL, NULL, NULL, NULL, NULL }, NULL, NULL };
    int status = add_faces(elements, answer->state, &all);
    const int64_t cells = all.grid.cells;
    double *values = malloc((size_t)(3 * cells + elements->nodes + 1) * sizeof *values);

    if (status == 0 && values) {
        double *stress = values, *pressure = values + cells, *piece = values + 2 * cells, *around = values + 3 * cells;
        picture_field field[7] = { { "displacement", 0, 3, 0, answer->u }, { "contact_force", 0, 3, 0, answer->force },
                                   { "gap", 0, 1, 0, answer->gap }, { "contact", 0, 1, 1, answer->state },
                                   { "pressure", 1, 1, 0, pressure } };
        const picture_field of_stress = { "von_mises", 1, 1, 0, stress }, of_piece = { "piece", 1, 1, 1, piece };
        int fields = 5;
        if (answer->shear_modulus > 0.0) field[fields++] = of_stress;
        if (answer->piece) field[fields++] = of_piece;
        for (int64_t c = 0; c < cells; c++) {
            stress[c] = c < elements->cells && answer->shear_modulus > 0.0 ? von_mises(elements, c, answer) : NAN;
            piece[c] = answer->piece && c < elements->cells ? answer->piece[c] : -1.0;
        }
        pressures(&all.grid, elements->cells, answer, around, pressure);
        status = picture_vtu(folder, name, &all.grid, fields, field);
    } else {
        status = -1;
    }
    free(values);
    free(all.numbers);
    free(all.types);
    return status;
}

int picture_step(const char *folder, const char *stem, int step, const picture_plane *plane)
{
    const int64_t nodes = plane->nodes, cells = plane->cells;
    double *values = calloc((size_t)(9 * nodes), sizeof *values), *xyz = values, *u = values + 3 * nodes, *force = values + 6 * nodes;
    int64_t *numbers = malloc((size_t)(5 * cells + 1) * sizeof *numbers), *offset = numbers, *corner = numbers + cells + 1;
    int32_t *types = malloc((size_t)(2 * cells) * sizeof *types), *type = types, *body = types + cells;
    int status = -1;

    if (values && numbers && types) {
        const picture_grid grid = { nodes, cells, xyz, offset, corner, type, body };
        const picture_answer answer = { u, force, plane->push, plane->gap, plane->state, NULL, plane->shear_modulus, plane->lame, 1 };
        char name[64];
        for (int64_t i = 0; i < 2 * nodes; i++) {
            const int64_t at = i / 2 * 3 + i % 2;
            xyz[at] = plane->x[i], u[at] = plane->u[i], force[at] = plane->force[i];
        }
        for (int64_t c = 0; c <= cells; c++) offset[c] = 4 * c;
        for (int64_t c = 0; c < cells; c++) type[c] = PICTURE_QUAD, body[c] = c < plane->first ? 1 : 2;
        for (int64_t k = 0; k < 4 * cells; k++) corner[k] = plane->corner[k];
        snprintf(name, sizeof name, "%s_%d.vtu", stem, step);
        status = picture_mesh(folder, name, &grid, &answer);
    }
    free(values), free(numbers), free(types);
    return status;
}
