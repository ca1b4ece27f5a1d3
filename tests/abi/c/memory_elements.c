/* Bodies by their elements, cut into pieces, by a host that runs out of address space: an element that is refused is named, may come
   again, and belongs to the same pass as before. Two passes over two bars of springs (grid.h). */
#include "grid.h"
#include "limited.h"

enum { LENGTH = 24, PIECES = 6, BLOCKS = 4, SETUP = 9, ADDED = BARS * (BLOCKS + 1), CALLS = SETUP + 2 * (ADDED + 1) };

/* A bar by springs: of one unknown to the ground, of two between neighbours. */
typedef struct {
    const grid *bars;
    int32_t elements, *ptr, *dof;
    double *ke; /* the lower triangles one after the other */
    int32_t *at;
} springs;

static springs springs_of(const grid *bars)
{
    springs all = { .bars = bars };
    const int32_t most = 4 * bars->nodes;
    double *left = check_array(bars->nodes, sizeof *left);

    all.ptr = check_array(most + 1, sizeof *all.ptr);
    all.dof = check_array(2 * most, sizeof *all.dof);
    all.ke = check_array(3 * most, sizeof *all.ke);
    all.at = check_array(most + 1, sizeof *all.at);
    for (int32_t i = 0; i < bars->nodes; i++) {
        for (int32_t k = bars->ptr[i]; k < bars->ptr[i + 1]; k++) {
            const int32_t j = bars->col[k], e = all.elements;
            left[i] += bars->val[k];
            if (j == i) continue;
            left[j] += bars->val[k];
            all.dof[all.ptr[e]] = j;
            all.dof[all.ptr[e] + 1] = i;
            memcpy(all.ke + all.at[e], (double[3]){ 1.0, -1.0, 1.0 }, 3 * sizeof(double));
            all.ptr[e + 1] = all.ptr[e] + 2;
            all.at[e + 1] = all.at[e] + 3;
            all.elements++;
        }
    }
    for (int32_t i = 0; i < bars->nodes; i++) {
        const int32_t e = all.elements;
        if (left[i] <= 0.5) continue;
        all.dof[all.ptr[e]] = i;
        all.ke[all.at[e]] = left[i];
        all.ptr[e + 1] = all.ptr[e] + 1;
        all.at[e + 1] = all.at[e] + 1;
        all.elements++;
    }
    free(left);
    return all;
}

/* Body and first element of a block, and where it ends; the last one of a body is a single element. */
static void block_of(const springs *all, int call, int *body, int32_t *first, int32_t *end)
{
    const int k = call % (ADDED / BARS);

    *body = call / (ADDED / BARS);
    *first = k == BLOCKS ? all->elements - 1 : k * ((all->elements - 1) / BLOCKS);
    *end = k == BLOCKS ? all->elements : k == BLOCKS - 1 ? all->elements - 1 : (k + 1) * ((all->elements - 1) / BLOCKS);
}

static int32_t prepared(const springs *all, int call, int64_t threads, feti_problem **problem)
{
    const grid *bars = all->bars;
    const int32_t n = bars->nodes;
    int64_t number;
    int32_t status;

    switch (call) {
    case 0:
        status = feti_problem_create(problem);
        if (status == FETI_OK) status = feti_set_i64(*problem, "threads", threads);
        return status == FETI_OK ? feti_set_i64(*problem, "pieces", PIECES) : status;
    case 1:
    case 2: return feti_body_add(*problem, n, &number);
    case 3:
    case 4: return feti_body_mesh_i32(*problem, call - 3, all->elements, all->ptr, all->dof, 0);
    case 5:
    case 6: return feti_body_coordinates(*problem, call - 5, 3, n, bars->node, bars->dir, bars->xyz, 3);
    case 7: return feti_body_load(*problem, 0, n, bars->load);
    default: return feti_rows_add_i32(*problem, FETI_INEQUALITY, FACE, bars->row_ptr, bars->row_body, bars->row_dof,
                                      bars->row_val, 0, bars->gap, NULL);
    }
}

static int32_t call_of_springs(const void *data, int call, int64_t threads, feti_problem **problem)
{
    const springs *all = data;
    const int pass = (call - SETUP) % (ADDED + 1);
    int body;
    int32_t first, end;

    if (call < SETUP) return prepared(all, call, threads, problem);
    if (pass == ADDED) return feti_solve(*problem, NULL);
    block_of(all, pass, &body, &first, &end);
    return feti_body_elements(*problem, body, first, end - first, all->ke + all->at[first], FETI_LOWER);
}

/* A refused block is named by its first element. */
static void refused_springs(const void *data, int call)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[256] = "";
    const int pass = (call - SETUP) % (ADDED + 1);
    int body;
    int32_t first, end;

    if (call < SETUP || pass == ADDED) return;
    block_of(data, pass, &body, &first, &end);
    feti_last_error(text, sizeof text);
    OK(feti_last_error_detail(&detail));
    CHECK(detail.status == FETI_MEMORY && detail.body == body && detail.element == first,
          "call %d, body %d, element %d: named body %lld, element %lld: %s", call, body, (int)first, (long long)detail.body,
          (long long)detail.element, text);
}

static uint64_t print_of_springs(const void *data, feti_problem *problem)
{
    feti_body_facts facts = { .struct_size = sizeof facts };

    OK(feti_body_info(problem, 0, &facts));
    CHECK(facts.pieces == PIECES, "%lld pieces", (long long)facts.pieces);
    return grid_fingerprint(((const springs *)data)->bars, problem);
}

/* Option memory_limit: the piece that takes most is named by its body and its first element, and nothing is lost. */
static void limit_of_the_option(const springs *all)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    feti_problem *problem = NULL;
    char text[256] = "";

    for (int call = 0; call < SETUP + ADDED; call++) EXPECT(FETI_OK, call_of_springs(all, call, 1, &problem));
    OK(feti_set_i64(problem, "memory_limit", 1000));
    for (int setup = 0; setup < 2; setup++) {
        EXPECT(FETI_MEMORY, setup ? feti_setup(problem) : feti_solve(problem, NULL));
        feti_last_error(text, sizeof text);
        OK(feti_last_error_detail(&detail));
        CHECK(detail.body >= 0 && detail.body < BARS && detail.element >= 0 && detail.element < all->elements &&
              detail.limit == 1000.0, "body %lld, element %lld: %s", (long long)detail.body, (long long)detail.element, text);
        CHECK(strstr(text, "those of this body take most") != NULL, "%s", text);
    }
    OK(feti_set_i64(problem, "memory_limit", 0));
    OK(feti_solve(problem, NULL));
    const uint64_t print = print_of_springs(all, problem);
    OK(feti_problem_destroy(&problem));
    for (int call = 0; call <= SETUP + ADDED; call++) EXPECT(FETI_OK, call_of_springs(all, call, 1, &problem));
    CHECK(print_of_springs(all, problem) == print, "after a limit that was too low: other bits");
    OK(feti_problem_destroy(&problem));
}

int main(void)
{
    grid bars = grid_of(LENGTH);
    springs all = springs_of(&bars);

    limit_of_the_option(&all);
    limited_ladder(&(limited_job){ CALLS, call_of_springs, refused_springs, print_of_springs, &all });
    free(all.ptr);
    free(all.dof);
    free(all.ke);
    free(all.at);
    grid_free(&bars);
    return check_result();
}
