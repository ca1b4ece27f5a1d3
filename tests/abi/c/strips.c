#include "strips.h"

enum { LOWER, UPPER, CIRCLE };

void strips_make(strips *all)
{
    int32_t entries = 0;

    memset(all, 0, sizeof *all);
    for (int32_t k = 0; k < STRIP_DOFS; k++) {
        const int is_y = k % 2, node = k / 2;
        all->x[LOWER][k] = is_y ? 0.0 : 1.1 * node;
        all->x[UPPER][k] = is_y ? 0.01 + 1e-3 * (node % 7) : 1.05 * node;
        all->moved[k] = is_y ? 0.008 + 1e-3 * (node % 5) : 1.05 * node + 0.002;
        all->load[k] = is_y ? -0.3 - 0.01 * (node % 3) : 0.05 * (node % 4);
        all->dof[k] = k;
        if (k >= 2) {
            all->col[entries] = k - 2;
            all->val[entries++] = -1.0;
        }
        all->col[entries] = k;
        all->val[entries++] = 6.0;
        all->ptr[k + 1] = entries;
    }
    /* the body is on the left */
    for (int32_t k = 0; k < STRIP - 1; k++) {
        all->lines[LOWER][2 * k] = all->lines[UPPER][2 * k + 1] = k + 1;
        all->lines[LOWER][2 * k + 1] = all->lines[UPPER][2 * k] = k;
    }
}

static int32_t first_calls(strips *all, int call, feti_problem *p)
{
    static const double circle[3] = { 10.0, -7.0, 6.0 }, friction[1] = { 0.3 };
    int64_t number;

    switch (call) {
    case 1:
    case 2: return feti_body_add(p, STRIP_DOFS, &number);
    case 3:
    case 4: return feti_body_stiffness_i32(p, call - 3, STRIP_DOFS, all->ptr, all->col, all->val, 0, FETI_LOWER, FETI_COPY);
    case 5: return feti_body_load(p, UPPER, STRIP_DOFS, all->load);
    case 6:
    case 7: return feti_surface_add_i32(p, call - 6, 2, STRIP, all->x[call - 6], 2, all->dof, 2, 0, &number);
    case 8: return feti_surface_rigid(p, 2, FETI_SPHERE, circle, &number);
    case 9:
    case 10: return feti_surface_faces_i32(p, call - 9, FETI_LINE2, STRIP - 1, all->lines[call - 9], 0);
    case 11: return feti_pair_add(p, UPPER, LOWER, FETI_NODE_TO_FACE, 0.5, &number, NULL);
    case 12: return feti_pair_add(p, UPPER, CIRCLE, FETI_NODE_TO_FACE, 1.5, &number, NULL);
    default: return feti_pair_set_f64(p, 0, "friction", 1, friction);
    }
}

int32_t strips_call(strips *all, int call, feti_problem **problem)
{
    feti_problem *p = *problem;
    int64_t number;

    if (call == 0) return feti_problem_create(problem);
    if (call <= 13) return first_calls(all, call, p);
    switch (call) {
    case 14:
    case 18: return feti_pairs_find(p);
    case 15: return feti_state_save(p, &number);
    case 16: return feti_pairs_commit(p);
    case 17: return feti_surface_move(p, UPPER, all->moved, 2);
    case 19: return feti_solve(p, NULL);
    case 20: return feti_pair_field(p, 0, FETI_PRESSURE, STRIP, all->pressure);
    case 21:
        all->facts.struct_size = sizeof all->facts;
        return feti_pair_info(p, 0, &all->facts);
    default: return feti_state_drop(p, 0);
    }
}
