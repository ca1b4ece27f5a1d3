#include "calls.h"

/* ---- memory that a call may write, or must leave */

enum { MOST = 8, PATTERN = 0xa5 };

static struct {
    const char *argument;
    const unsigned char *memory;
    unsigned char *before;
    size_t size;
    int written;
} watched[MOST];
static int watched_count;
static const function *current;
static const char *occasion = "";
static void *record;

void *patterned(void *memory, size_t size)
{
    return memset(memory, PATTERN, size);
}

void forget(void)
{
    for (int k = 0; k < watched_count; k++) free(watched[k].before);
    watched_count = 0;
}

void watch(const char *argument, const void *memory, size_t size, int written)
{
    unsigned char *before = check_array((int64_t)size, 1);
    memcpy(before, memory, size);
    watched[watched_count].argument = argument;
    watched[watched_count].memory = memory;
    watched[watched_count].before = before;
    watched[watched_count].size = size;
    watched[watched_count].written = written;
    watched_count++;
}

int32_t settled(int32_t status)
{
    for (int k = 0; k < watched_count && !(current->flags & WRITES_ANYWAY); k++) {
        const int same = memcmp(watched[k].before, watched[k].memory, watched[k].size) == 0;
        if (status < 0)
            CHECK(same, "%s, %s: status %d, but '%s' was written", current->name, occasion, (int)status, watched[k].argument);
        else if (watched[k].written)
            CHECK(!same, "%s, %s: '%s' was not written", current->name, occasion, watched[k].argument);
    }
    forget();
    return status;
}

int32_t created(int32_t status, feti_problem **p)
{
    if (status == FETI_OK) OK(feti_problem_destroy(p));
    return status;
}

void give_record(void *memory)
{
    record = memory;
}

void *given_record(int fault)
{
    return fault == GIVEN_RECORD ? record : NULL;
}

/* ---- calls */

static void check_named(const function *f, int32_t status, const char *when)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    OK(feti_last_error_detail(&detail));
    CHECK(strcmp(detail.function, f->name) == 0 && detail.status == status, "%s, %s: the last error is %d of %s", f->name, when,
          (int)detail.status, detail.function);
    CHECK(detail.argument == (status <= FETI_ARGUMENT ? FETI_ARGUMENT - status : 0), "%s, %s: argument %d", f->name, when,
          (int)detail.argument);
}

void expect(const function *f, feti_problem *p, int fault, int32_t status, const char *when)
{
    current = f;
    occasion = when;
    const int32_t found = f->call(p, fault);
    char text[512] = "";
    feti_last_error(text, sizeof text);
    CHECK(found == status, "%s, %s: status %d, expected %d (%s)", f->name, when, (int)found, (int)status, text);
    if (found < 0 && found == status && !(f->flags & KEEPS_ERROR)) check_named(f, status, when);
}

/* ---- the problem */

static void give_bodies(feti_problem *p)
{
    static const int32_t ptr[3] = { 0, 1, 3 }, col[3] = { 0, 0, 1 };
    static const double held[3] = { 6.0, -4.0, 4.0 }, floating[3] = { 4.0, -4.0, 4.0 }, mode[2] = { 1.0, 1.0 };
    static const double load[2] = { 0.0, -6.0 };
    int64_t body;

    MUST(feti_body_add(p, 2, &body));
    MUST(feti_body_add(p, 2, &body));
    MUST(feti_body_stiffness_i32(p, 0, 2, ptr, col, held, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_stiffness_i32(p, 1, 2, ptr, col, floating, 0, FETI_LOWER, FETI_COPY));
    MUST(feti_body_null_space(p, 0, 0, 2, NULL, 2, FETI_EXACT));
    MUST(feti_body_null_space(p, 1, 1, 2, mode, 2, FETI_EXACT));
    MUST(feti_body_load(p, 1, 2, load));
}

static void give_rows(feti_problem *p)
{
    static const int32_t ptr[3] = { 0, 2, 4 }, body[4] = { 0, 1, 0, 1 }, dof[4] = { 1, 0, 0, 0 };
    static const int32_t ties[2] = { 0, 2 }, tied_body[2] = { 0, 0 }, tied[2] = { 0, 1 };
    static const double val[4] = { 1.0, -1.0, 1.0, -1.0 }, gap[2] = { 1.0, 5.0 }, step[1] = { 0.25 };

    MUST(feti_rows_add_i32(p, FETI_INEQUALITY, 2, ptr, body, dof, val, 0, gap, NULL));
    MUST(feti_rows_add_i32(p, FETI_EQUALITY, 1, ties, tied_body, tied, val, 0, step, NULL));
}

/* A body of its own, held by nothing: motions that nothing determines. */
static void give_loose_body(feti_problem *p)
{
    static const double k[4] = { 4.0, -4.0, -4.0, 4.0 }, mode[2] = { 1.0, 1.0 };
    int64_t body;

    MUST(feti_body_add(p, 2, &body));
    MUST(feti_body_stiffness_dense(p, body, 2, k, 2, FETI_FULL, FETI_COPY));
    MUST(feti_body_null_space(p, body, 1, 2, mode, 2, FETI_EXACT));
}

/* Surface 0: both unknowns of body 1 as heights of two nodes; surface 1: a plane far below it; surface 2: the same nodes without a face.
   Pairs come before rows; the nodes have no partner. */
static void give_surfaces(feti_problem *p, int with_rows)
{
    static const double x[4] = { 0.0, 0.0, 1.0, 0.0 }, plane[4] = { 0.0, -9.0, 0.0, 1.0 };
    static const int32_t dof[4] = { -1, 0, -1, 1 }, line[2] = { 0, 1 };
    int64_t slave, master, cloud, pair;

    MUST(feti_rows_clear(p, FETI_INEQUALITY));
    MUST(feti_rows_clear(p, FETI_EQUALITY));
    MUST(feti_surface_add_i32(p, 1, 2, 2, x, 2, dof, 2, 0, &slave));
    MUST(feti_surface_faces_i32(p, slave, FETI_LINE2, 1, line, 0));
    MUST(feti_surface_rigid(p, 2, FETI_PLANE, plane, &master));
    MUST(feti_surface_add_i32(p, 1, 2, 2, x, 2, dof, 2, 0, &cloud));
    MUST(feti_pair_add(p, slave, master, FETI_NODE_TO_FACE, 1.0, &pair, NULL));
    if (with_rows) give_rows(p);
}

/* What the function wants besides bodies and rows. */
static void prepare(const char *name, feti_problem *p)
{
    static const double away[2] = { 0.0, 6.0 };
    static const double diagonal[2] = { 4.0, 4.0 }, beside[1] = { -4.0 }, dense[4] = { 4.0, -4.0, -4.0, 4.0 };
    static const int32_t row_ptr[3] = { 0, 0, 1 }, col[1] = { 0 };
    static const int32_t normal_row[1] = { 0 }, tangent_ptr[2] = { 0, 2 }, tangent_body[2] = { 0, 1 }, tangent_dof[2] = { 0, 1 };
    static const double tangent[2] = { 1.0, -1.0 };
    static const int32_t element_ptr[2] = { 0, 2 }, joined[2] = { 0, 1 };
    int64_t id;

    if (strncmp(name, "feti_body_element", 17) == 0 || strcmp(name, "feti_body_held_forces") == 0) {
        MUST(feti_body_mesh_i32(p, 1, 1, element_ptr, joined, 0));
        MUST(feti_body_element(p, 1, 0, 2, dense, 2));
    }
    if (strncmp(name, "feti_friction_", 14) == 0 || strcmp(name, "feti_check_friction") == 0)
        MUST(feti_friction_add_i32(p, 1, 1, normal_row, tangent_ptr, tangent_body, tangent_dof, tangent, 0, NULL, NULL, NULL));
    if (strncmp(name, "feti_surface_", 13) == 0 || strncmp(name, "feti_pair", 9) == 0)
        give_surfaces(p, strcmp(name, "feti_pair_add") != 0);
    if (strncmp(name, "feti_state_", 11) == 0) MUST(feti_state_save(p, &id));
    if (strncmp(name, "feti_diagnosis_undetermined", 27) == 0) give_loose_body(p);
    if (strcmp(name, "feti_diagnosis_motion") == 0) MUST(feti_body_load(p, 1, 2, away));
    if (strcmp(name, "feti_body_values_split") == 0)
        MUST(feti_body_stiffness_split_i32(p, 1, 2, diagonal, row_ptr, col, beside, 0, FETI_LOWER, FETI_COPY));
    if (strcmp(name, "feti_body_values_dense") == 0)
        MUST(feti_body_stiffness_dense(p, 1, 2, dense, 2, FETI_LOWER, FETI_COPY));
}

feti_problem *problem_for(const function *f)
{
    feti_problem *p = NULL;
    double values[ANSWER];

    MUST(feti_problem_create(&p));
    give_bodies(p);
    give_rows(p);
    prepare(f->name, p);
    answer(p, values);
    /* these want a problem without bodies */
    if (strcmp(f->name, "feti_problem_read") == 0 || strcmp(f->name, "feti_communicator_set") == 0) {
        MUST(feti_problem_write(p, FILE_OF_CALLS));
        MUST(feti_problem_destroy(&p));
        MUST(feti_problem_create(&p));
    }
    return p;
}

int32_t answer(feti_problem *p, double values[ANSWER])
{
    const int32_t status = feti_solve(p, NULL);
    double lambda[ROOM];
    int64_t rows;

    memset(values, 0, ANSWER * sizeof *values);
    if (status < 0) return status;
    OK(feti_counts(p, NULL, NULL, &rows, NULL));
    OK(feti_displacement(p, 0, 2, values));
    OK(feti_displacement(p, 1, 2, values + 2));
    OK(feti_multipliers(p, FETI_INEQUALITY, rows, lambda));
    memcpy(values + 4, lambda + rows - 2, 2 * sizeof *values); /* rows of pairs come first */
    OK(feti_multipliers(p, FETI_EQUALITY, 1, values + 6));
    return status;
}
