/* file DATA FOLDER GOLDEN [CASE ...]: a problem goes through a file and solves to the same bits; what is no file, or a
   damaged one, is refused with path, operation and byte; so is a body that functions of the host stand for; options come
   as a text. */
#include "handover.h"
#include "small.h"

static char path[600];

static feti_problem *new_problem(void)
{
    feti_problem *problem = NULL;
    MUST(feti_problem_create(&problem));
    return problem;
}

static int same_bits(int64_t n, const double *a, const double *b)
{
    return memcmp(a, b, (size_t)n * sizeof *a) == 0;
}

static void comes_back(const char *folder, const char *name)
{
    const form how = { .storage = FETI_LOWER };
    case_data data;
    feti_problem *back = new_problem();
    char words[40];
    int64_t length, steps;

    read_or_stop(folder, name, &data);
    feti_problem *problem = handed_over(&data, &how);
    OK(feti_set_text(problem, "finish=direct max_steps=5000"));
    OK(feti_problem_write(problem, path));
    OK(feti_problem_read(back, path));
    OK(feti_get_str(back, "finish", words, sizeof words, &length));
    OK(feti_get_i64(back, "max_steps", &steps));
    CHECK(strcmp(words, "direct") == 0 && steps == 5000, "%s: options are %s, %lld", name, words, (long long)steps);
    answer old = solved(problem, &data), new = solved(back, &data);
    CHECK(same_bits(data.unknowns, old.u, new.u), "%s: other displacements", name);
    CHECK(same_bits(data.rows, old.lambda, new.lambda), "%s: other forces", name);
    CHECK(same_bits(data.equalities, old.mu, new.mu), "%s: other reactions", name);
    CHECK(old.info.steps == new.info.steps && old.info.dofs == new.info.dofs, "%s: other counts", name);
    EXPECT(FETI_STATE, feti_problem_read(back, path));
    answer_free(&old);
    answer_free(&new);
    case_free(&data);
    OK(feti_problem_destroy(&problem));
    OK(feti_problem_destroy(&back));
}

/* The status, parts of the text, and the byte (ANY: whatever it is). */
static void refused(feti_problem *p, int32_t status, int32_t expected, const char *says, int64_t byte)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    char text[900];

    feti_last_error(text, sizeof text);
    OK(feti_last_error_detail(&detail));
    CHECK(status == expected && strstr(text, says), "status %d, \"%s\", expected %d and \"%s\"", (int)status, text, (int)expected, says);
    CHECK(byte == ANY || detail.entry == byte, "byte %lld, expected %lld", (long long)detail.entry, (long long)byte);
    int64_t bodies = -1, dofs, rows, eqs;
    OK(feti_counts(p, &bodies, &dofs, &rows, &eqs));
    CHECK(bodies == 0 && rows == 0, "%lld bodies after a refused file", (long long)bodies);
}

static void put(const void *bytes, size_t length)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, length, file) != length || fclose(file) != 0) exit(1);
}

static size_t got(unsigned char *bytes, size_t cap)
{
    FILE *file = fopen(path, "rb");
    const size_t length = file ? fread(bytes, 1, cap, file) : 0;
    if (file) fclose(file);
    return length;
}

static void damaged_files_are_refused(const char *folder)
{
    feti_problem *p = new_problem(), *small = small_problem();
    unsigned char bytes[4096], changed[4096];
    char nowhere[700];

    OK(feti_problem_write(small, path));
    const size_t length = got(bytes, sizeof bytes);
    CHECK(length > 200 && length < sizeof bytes, "the file has %lld bytes", (long long)length);
    put("no problem", 10);
    refused(p, feti_problem_read(p, path), FETI_IO, "the file ends after 10 bytes", 10);
    refused(p, feti_problem_read(p, path), FETI_IO, path, 10);
    for (size_t cut = 0; cut < length; cut += 13) {
        put(bytes, cut);
        refused(p, feti_problem_read(p, path), FETI_IO, path, ANY);
    }
    for (size_t at = 0; at < length; at += 7) {
        memcpy(changed, bytes, length);
        changed[at] ^= 0x10;
        put(changed, length);
        const int32_t status = feti_problem_read(p, path);
        refused(p, status, status == FETI_UNSUPPORTED ? FETI_UNSUPPORTED : FETI_IO, path, ANY);
    }
    snprintf(nowhere, sizeof nowhere, "%s/nowhere/problem", folder);
    refused(p, feti_problem_read(p, nowhere), FETI_IO, "nowhere/problem: open: ", -1);
    EXPECT(FETI_IO, feti_problem_write(small, nowhere));
    EXPECT(FETI_IO, feti_problem_write(small, folder));
    put(bytes, length);
    OK(feti_problem_read(p, path));
    check_small_answer(p, "feti_problem_read");
    OK(feti_problem_destroy(&p));
    OK(feti_problem_destroy(&small));
}

static void wrong_arguments(void)
{
    feti_problem *p = small_problem();

    EXPECT(FETI_ARGUMENT - 2, feti_problem_write(p, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_problem_write(p, ""));
    EXPECT(FETI_ARGUMENT - 2, feti_problem_read(p, NULL));
    EXPECT(FETI_ARGUMENT - 2, feti_problem_read(p, ""));
    EXPECT(FETI_ARGUMENT - 2, feti_set_text(p, NULL));
    EXPECT(FETI_HANDLE, feti_problem_write(NULL, path));
    EXPECT(FETI_HANDLE, feti_problem_read(NULL, path));
    EXPECT(FETI_HANDLE, feti_set_text(NULL, "threads=1"));
    check_small_answer(p, "wrong arguments");
    OK(feti_problem_destroy(&p));
}

/* lambda = 6, u = -3, -4, -5.5 by hand; the host numbers the unknowns 4, 0, 2. New values of what was given dense come by
   the rows of the lower triangle: with a block twice as stiff u_block[1] = -4.75. */
static void numbers_and_patterns_come_back(void)
{
    static const int32_t spring[1] = { 4 }, block[2] = { 0, 2 };
    static const double dense[4] = { 4.0, -4.0, -4.0, 4.0 }, twice[3] = { 8.0, -8.0, 8.0 };
    feti_problem *p = small_problem(), *back = new_problem();
    double u[5] = { 0 };

    OK(feti_body_stiffness_i32(p, SPRING, 1, SPRING_PTR, SPRING_COL, SPRING_VAL, 0, FETI_LOWER, FETI_BORROW));
    OK(feti_body_stiffness_dense(p, BLOCK, 2, dense, 2, FETI_FULL, FETI_COPY));
    OK(feti_body_numbering_i32(p, SPRING, 1, spring, 0));
    OK(feti_body_numbering_i32(p, BLOCK, 2, block, 0));
    OK(feti_problem_write(p, path));
    OK(feti_problem_read(back, path));
    OK(feti_solve(back, NULL));
    OK(feti_displacement(back, FETI_ALL, 5, u));
    CHECK(fabs(u[4] + 3.0) + fabs(u[0] + 4.0) + fabs(u[2] + 5.5) <= 1e-9, "u = %g, %g, %g", u[4], u[0], u[2]);
    EXPECT(FETI_STATE, feti_body_values_dense(back, BLOCK, 2, dense, 2));
    OK(feti_body_values(back, BLOCK, 3, twice));
    OK(feti_solve(back, NULL));
    OK(feti_displacement(back, FETI_ALL, 5, u));
    CHECK(fabs(u[2] + 4.75) <= 1e-9, "u = %g with a block twice as stiff", u[2]);
    OK(feti_problem_destroy(&p));
    OK(feti_problem_destroy(&back));
}

static int32_t nothing(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    (void)user, (void)body, (void)n, (void)nrhs, (void)x, (void)ldx, (void)y, (void)ldy;
    return 1;
}

static void a_body_given_by_functions_is_not_written(void)
{
    const expectation wanted = { FETI_UNSUPPORTED, BLOCK, ANY, ANY, ANY, "feti_problem_write", "feti_body_operator" };
    const double diagonal[2] = { 4.0, 4.0 };
    feti_problem *p = small_problem();
    unsigned char bytes[8];

    put("old", 3);
    OK(feti_body_operator(p, BLOCK, 2, diagonal, nothing, nothing, 0, NULL));
    EXPECT(FETI_UNSUPPORTED, feti_problem_write(p, path));
    check_last_error(p, &wanted);
    CHECK(got(bytes, sizeof bytes) == 3 && memcmp(bytes, "old", 3) == 0, "the old file is gone");
    OK(give_block_stiffness(p));
    OK(feti_problem_write(p, path));
    OK(feti_problem_destroy(&p));
}

static void options_come_as_a_text(void)
{
    feti_problem *p = new_problem();
    double tolerance = 0.0;
    int64_t threads = -1;

    OK(feti_set_text(p, "tolerance = 1d-9, threads=3 # of four\n"));
    refused(p, feti_set_text(p, "threads=4 tolerence=1e-8"), FETI_ARGUMENT - 2, "tolerence", 10);
    refused(p, feti_set_text(p, "threads=4 tolerance=7"), FETI_ARGUMENT - 2, "tolerance", 20);
    refused(p, feti_set_text(p, "threads"), FETI_ARGUMENT - 2, "threads", 0);
    OK(feti_get_f64(p, "tolerance", &tolerance));
    OK(feti_get_i64(p, "threads", &threads));
    CHECK(tolerance == 1e-9 && threads == 3, "tolerance %g, threads %lld", tolerance, (long long)threads);
    OK(feti_problem_destroy(&p));
}

static void a_file_of_format_1_is_read(const char *golden)
{
    feti_problem *p = new_problem();
    feti_info info = { .struct_size = sizeof info };

    OK(feti_problem_read(p, golden));
    OK(feti_solve(p, &info));
    CHECK(info.bodies == 2 && info.rows == 1 && info.equalities == 1, "%lld bodies", (long long)info.bodies);
    OK(feti_problem_destroy(&p));
}

int main(int argc, char **argv)
{
    static const char *const ALL[] = { "p1_P1", "p1_P3", "p1_P3_galerkin", "p2_A", "p2_B1", "p2_B2", "p3_2block",
                                       "p3_3block", "hertz_cylinder", "three_bodies" };
    if (argc < 4) return 1;
    snprintf(path, sizeof path, "%s/problem.feti", argv[2]);
    for (int k = 4; k < argc; k++) comes_back(argv[1], argv[k]);
    for (size_t k = 0; argc == 4 && k < sizeof ALL / sizeof ALL[0]; k++) comes_back(argv[1], ALL[k]);
    damaged_files_are_refused(argv[2]);
    wrong_arguments();
    numbers_and_patterns_come_back();
    a_body_given_by_functions_is_not_written();
    options_come_as_a_text();
    a_file_of_format_1_is_read(argv[3]);
    remove(path);
    return check_result();
}
