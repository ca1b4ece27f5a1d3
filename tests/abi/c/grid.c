#include "grid.h"

/* Row i: springs along the three axes to the neighbours before; those to the ones behind count for the diagonal. */
static void springs_of(grid *bars, int32_t i, int32_t length)
{
    const int32_t stride[3] = { FACE, WIDE, 1 }, at[3] = { i / FACE, i / WIDE % WIDE, i % WIDE };
    const int32_t end[3] = { length, WIDE, WIDE };
    const int corner = at[0] == 0 && (at[1] == 0 || at[1] == WIDE - 1) && (at[2] == 0 || at[2] == WIDE - 1);
    double diagonal = corner ? 1.0 : 0.0;

    for (int axis = 0; axis < 3; axis++) {
        diagonal += (at[axis] > 0) + (at[axis] + 1 < end[axis]);
        if (at[axis] == 0) continue;
        bars->col[bars->entries] = i - stride[axis];
        bars->val[bars->entries++] = -1.0;
    }
    bars->col[bars->entries] = i;
    bars->val[bars->entries++] = diagonal;
    bars->ptr[i + 1] = bars->entries;
    bars->node[i] = i + 1;
    bars->dir[i] = 1;
    for (int axis = 0; axis < 3; axis++) bars->xyz[3 * i + axis] = at[axis];
}

/* Bar 0 is pushed towards bar 1, in the middle more than at the edges; the gaps grow from one corner. */
static void contact_of(grid *bars)
{
    for (int32_t i = 0; i < FACE; i++) {
        const double y = i / WIDE - 0.5 * (WIDE - 1), z = i % WIDE - 0.5 * (WIDE - 1);
        const int32_t node = bars->nodes - FACE + i;
        bars->load[node] = 2.0 - 0.06 * (y * y + z * z);
        bars->gap[i] = 0.01 * (i % WIDE) + 0.003 * (i / WIDE);
        bars->row_ptr[i + 1] = BARS * (i + 1);
        for (int32_t body = 0; body < BARS; body++) {
            bars->row_body[BARS * i + body] = body;
            bars->row_dof[BARS * i + body] = node;
            bars->row_val[BARS * i + body] = body == 0 ? 1.0 : -1.0;
        }
    }
}

grid grid_of(int32_t length)
{
    grid bars = { .nodes = FACE * length };
    bars.ptr = check_array(bars.nodes + 1, sizeof *bars.ptr);
    bars.col = check_array(4 * bars.nodes, sizeof *bars.col);
    bars.val = check_array(4 * bars.nodes, sizeof *bars.val);
    bars.node = check_array(bars.nodes, sizeof *bars.node);
    bars.dir = check_array(bars.nodes, sizeof *bars.dir);
    bars.load = check_array(bars.nodes, sizeof *bars.load);
    bars.xyz = check_array(3 * bars.nodes, sizeof *bars.xyz);
    for (int32_t i = 0; i < bars.nodes; i++) springs_of(&bars, i, length);
    contact_of(&bars);
    return bars;
}

void grid_free(grid *bars)
{
    free(bars->ptr);
    free(bars->col);
    free(bars->val);
    free(bars->node);
    free(bars->dir);
    free(bars->load);
    free(bars->xyz);
    memset(bars, 0, sizeof *bars);
}

int32_t grid_call(const grid *bars, int call, feti_problem **problem)
{
    const int32_t n = bars->nodes;
    int64_t number;

    switch (call) {
    case 0: return feti_problem_create(problem);
    case 1:
    case 2: return feti_body_add(*problem, n, &number);
    case 3:
    case 4: return feti_body_stiffness_i32(*problem, call - 3, n, bars->ptr, bars->col, bars->val, 0, FETI_LOWER, FETI_COPY);
    case 5: return feti_body_null_space(*problem, 0, 0, n, NULL, n, FETI_EXACT);
    case 6: return feti_body_coordinates(*problem, 1, 3, n, bars->node, bars->dir, bars->xyz, 3);
    case 7: return feti_body_load(*problem, 0, n, bars->load);
    default: return feti_rows_add_i32(*problem, FETI_INEQUALITY, FACE, bars->row_ptr, bars->row_body, bars->row_dof,
                                      bars->row_val, 0, bars->gap, NULL);
    }
}

uint64_t grid_folded(uint64_t print, int64_t n, const double *x)
{
    for (int64_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, &x[i], sizeof bits);
        print = (print ^ bits) * 0x100000001b3u;
    }
    return print;
}

uint64_t grid_fingerprint(const grid *bars, feti_problem *problem)
{
    double *u = check_array(bars->nodes, sizeof *u), lambda[FACE];
    uint64_t print = 0xcbf29ce484222325u;

    OK(feti_multipliers(problem, FETI_INEQUALITY, FACE, lambda));
    print = grid_folded(print, FACE, lambda);
    for (int body = 0; body < BARS; body++) {
        OK(feti_displacement(problem, body, bars->nodes, u));
        print = grid_folded(print, bars->nodes, u);
    }
    free(u);
    return print;
}
