/* A host compiled against the header of the baseline (abi), run against the library of today: the forces are right, every result
   struct is filled as far as that header knows it, and no byte behind it is touched. */
#include <feti_contact.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures;

static void expect(int holds, const char *what)
{
    if (!holds) {
        printf("not so: %s\n", what);
        failures++;
    }
}

/* A struct of the old header, and what lies behind it in the memory of the host. */
#define GUARDED(type) struct { type it; unsigned char behind[256]; }
#define PREPARE(x) (memset(&(x), 0x5a, sizeof(x)), (x).it.struct_size = sizeof((x).it))

static int untouched(const unsigned char *behind)
{
    for (int i = 0; i < 256; i++) {
        if (behind[i] != 0x5a) {
            return 0;
        }
    }
    return 1;
}

/* The spring k at a wall, the gap c, the block s pushed by F of example 01. */
static feti_problem *spring_and_block(int64_t *spring, int64_t *block)
{
    const int32_t row_ptr[] = { 0, 1, 3 }, col[] = { 0, 0, 1 }, first[] = { 0, 2 }, dof[] = { 0, 0 };
    const double spring_k[] = { 1000.0 }, block_k[] = { 4000.0, -4000.0, 4000.0 }, load[] = { 0.0, -100.0 };
    const double row[] = { 1.0, -1.0 }, gap[] = { 0.5 };
    feti_problem *p = NULL;

    expect(feti_problem_create(&p) == FETI_OK, "a problem");
    expect(feti_body_add(p, 1, spring) == FETI_OK && feti_body_add(p, 2, block) == FETI_OK, "two bodies");
    expect(feti_body_stiffness_i32(p, *spring, 1, row_ptr, col, spring_k, 0, FETI_LOWER, FETI_COPY) == FETI_OK, "K of the spring");
    expect(feti_body_stiffness_i32(p, *block, 2, row_ptr, col, block_k, 0, FETI_LOWER, FETI_COPY) == FETI_OK, "K of the block");
    expect(feti_body_load(p, *block, 2, load) == FETI_OK, "the load");
    const int32_t body[] = { (int32_t)*spring, (int32_t)*block };
    expect(feti_rows_add_i32(p, FETI_INEQUALITY, 1, first, body, dof, row, 0, gap, NULL) == FETI_OK, "the row");
    return p;
}

/* What the library says of itself: options, and the error of a call that it refuses. */
static void texts(feti_problem *p)
{
    GUARDED(feti_option) option;
    PREPARE(option);
    expect(feti_option_at(0, &option.it) == FETI_OK && option.it.name[0] != '\0', "the first option has a name");
    expect(untouched(option.behind), "feti_option ends where the old one ends");

    GUARDED(feti_error_detail) detail;
    int64_t body;
    PREPARE(detail);
    expect(feti_body_add(p, -1, &body) == FETI_ARGUMENT - 2, "argument 2 is refused");
    expect(feti_last_error_detail(&detail.it) == FETI_OK && detail.it.argument == 2, "the detail names argument 2");
    expect(untouched(detail.behind), "feti_error_detail ends where the old one ends");
}

/* What is told about a solved problem. */
static void judged(feti_problem *p)
{
    const double u[] = { -0.1, -0.6, -0.625 }, lambda[] = { 100.0 };
    GUARDED(feti_certificate) certificate;
    PREPARE(certificate);
    expect(feti_check(p, 3, u, 1, lambda, 0, NULL, &certificate.it) == FETI_OK && certificate.it.passed == 1, "the answer by hand passes");
    expect(untouched(certificate.behind), "feti_certificate ends where the old one ends");

    GUARDED(feti_findings) findings;
    PREPARE(findings);
    expect(feti_diagnosis(p, &findings.it) == FETI_OK && findings.it.undetermined == 0, "nothing is undetermined");
    expect(untouched(findings.behind), "feti_findings ends where the old one ends");

    GUARDED(feti_phase) phase;
    PREPARE(phase);
    expect(feti_phase_at(p, 0, &phase.it) == FETI_OK && phase.it.name[0] != '\0', "the first phase has a name");
    expect(untouched(phase.behind), "feti_phase ends where the old one ends");
}

int main(void)
{
    int64_t spring, block;
    double force, u[2];
    feti_problem *p = spring_and_block(&spring, &block);
    GUARDED(feti_info) info;
    PREPARE(info);

    expect(feti_solve(p, &info.it) == FETI_OK && info.it.rows == 1 && info.it.dofs == 3, "solved, and info says what");
    expect(untouched(info.behind), "feti_info ends where the old one ends");
    expect(feti_multipliers(p, FETI_INEQUALITY, 1, &force) == FETI_OK && fabs(force - 100.0) < 1e-8, "the force is F");
    expect(feti_displacement(p, block, 2, u) == FETI_OK && fabs(u[1] + 0.625) < 1e-12, "the rear of the block by hand");
    texts(p);
    judged(p);
    expect(feti_problem_destroy(&p) == FETI_OK && p == NULL, "given back");
    return failures != 0;
}
