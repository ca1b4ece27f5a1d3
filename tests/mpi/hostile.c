/* hostile CASE: hosts with MPI that do unusual things; rank 0 prints `ok`, every failure is told on stderr. The source for MPI is
   included, so that its messages can be sent without the library, too. */
#include "feti_mpi.c"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int rank, size, failures;

#define CHECK(condition)                                                                                 \
    do {                                                                                                 \
        if (!(condition)) fprintf(stderr, "rank %d, line %d: %s\n", rank, __LINE__, #condition), failures++; \
    } while (0)
#define EXPECT(expected, call)                                                                                        \
    do {                                                                                                              \
        const int32_t status_ = (call);                                                                               \
        if (status_ != (expected))                                                                                    \
            fprintf(stderr, "rank %d, line %d: %s is %s\n", rank, __LINE__, #call, feti_status_name(status_)), failures++; \
    } while (0)

static feti_problem *created(void)
{
    feti_problem *p = NULL;
    EXPECT(FETI_OK, feti_problem_create(&p));
    return p;
}

/* A body of one spring, pulled by 3: u = 1.5. */
static void solves(feti_problem *p, int ranks)
{
    const double k = 2.0, f = 3.0;
    double u = 0.0;
    int64_t body;

    EXPECT(FETI_OK, feti_body_add(p, 1, &body));
    EXPECT(FETI_OK, feti_body_stiffness_dense(p, body, 1, &k, 1, FETI_FULL, FETI_COPY));
    EXPECT(FETI_OK, feti_body_load(p, body, 1, &f));
    feti_info info = { .struct_size = sizeof info };
    EXPECT(FETI_OK, feti_solve(p, &info));
    EXPECT(FETI_OK, feti_displacement(p, body, 1, &u));
    CHECK(fabs(u - 1.5) < 1e-12);
    CHECK(info.ranks == ranks);
}

/* Where MPI cannot be called: the status, and its text. */
static void refuses(MPI_Comm comm)
{
    feti_problem *p = created();
    char text[200] = "";

    EXPECT(FETI_COMMUNICATION, feti_mpi(p, comm));
    feti_last_error(text, sizeof text);
    CHECK(strncmp(text, "feti_serve: ", 12) == 0);
    EXPECT(FETI_COMMUNICATION, feti_mpi_serve(comm));
    solves(p, 1);
    EXPECT(FETI_OK, feti_problem_destroy(&p));
}

/* ---- cases, between MPI_Init and MPI_Finalize */

static void problems_alive_while_service_ends_and_begins_again(void)
{
    feti_problem *first = NULL, *second = NULL;

    for (int round = 0; round < 2; round++) {
        if (rank == 0) {
            feti_problem **const p = round == 0 ? &first : &second;
            *p = created();
            EXPECT(FETI_OK, feti_mpi(*p, MPI_COMM_WORLD));
            solves(*p, size);
        }
        EXPECT(FETI_OK, feti_mpi_serve(MPI_COMM_WORLD));
    }
    if (rank == 0) {
        EXPECT(FETI_OK, feti_problem_destroy(&second));
        EXPECT(FETI_OK, feti_problem_destroy(&first));
    }
}

static void a_second_table(void)
{
    feti_problem *p = created(), *other = created();

    if (rank == 0) {
        EXPECT(FETI_OK, feti_mpi(p, MPI_COMM_WORLD));
        EXPECT(FETI_STATE, feti_mpi(p, MPI_COMM_WORLD));
        EXPECT(FETI_OK, feti_mpi(other, MPI_COMM_WORLD));
        EXPECT(FETI_HANDLE, feti_mpi(NULL, MPI_COMM_WORLD));
        solves(p, size), solves(other, size);
    }
    EXPECT(FETI_OK, feti_mpi_serve(MPI_COMM_WORLD));
    EXPECT(FETI_OK, feti_problem_destroy(&p));
    EXPECT(FETI_OK, feti_problem_destroy(&other));
}

/* Every rank has a spring of stiffness 2, pulled by 3; its unknown has the number of the rank. */
static void gives(feti_problem *p)
{
    const double k = 2.0, f = 3.0;
    const int64_t number = rank;
    int64_t body;

    EXPECT(FETI_OK, feti_body_add(p, 1, &body));
    EXPECT(FETI_OK, feti_body_stiffness_dense(p, body, 1, &k, 1, FETI_FULL, FETI_COPY));
    EXPECT(FETI_OK, feti_body_load(p, body, 1, &f));
    EXPECT(FETI_OK, feti_body_numbering_i64(p, body, 1, &number, 0));
}

/* The unknown with this number stays below 1, or that of the rank itself is refused. */
static int32_t stop(feti_problem *p, int64_t number)
{
    const int64_t ptr[2] = { 0, 1 };
    const double one = 1.0;

    return feti_rows_add_i64(p, FETI_INEQUALITY, 1, ptr, NULL, &number, &one, 0, &one, NULL);
}

/* The status is that of an argument, which it counts. */
#define REFUSED(call) CHECK(strcmp(feti_status_name(call), "FETI_ARGUMENT") == 0)

/* An argument that one rank refuses: all ranks hear of it. */
static void refused_on_one(feti_problem *p, int wrong, int64_t id)
{
    const double u = 0.0, lambda = 0.0;
    feti_certificate certificate = { .struct_size = wrong ? 1 : (int64_t)sizeof certificate };
    feti_info info = { .struct_size = wrong ? 1 : (int64_t)sizeof info };
    int64_t none, count, bodies, dofs, rows, eqs;
    double v;

    EXPECT(FETI_OK, feti_counts(p, &bodies, &dofs, &rows, &eqs));
    REFUSED(feti_solve(p, &info));
    REFUSED(feti_check(p, 1, &u, rows, &lambda, 0, NULL, &certificate));
    REFUSED(feti_state_save(p, wrong ? NULL : &none));
    REFUSED(feti_state_restore(p, wrong ? -1 : id));
    REFUSED(feti_problem_write(p, wrong ? NULL : "nothing.feti"));
    REFUSED(feti_diagnosis_dependent(p, wrong ? -1 : 0, &count, NULL));
    REFUSED(feti_diagnosis_undetermined(p, wrong ? -1 : 0, NULL, NULL));
    REFUSED(feti_diagnosis_undetermined_motion(p, 0, wrong ? 7 : 0, 1, &v));
}

/* Parts that do not fit together: the same status on all ranks, and afterwards a problem that does. Alone, rank 0 has it all. */
static void parts_of_every_rank(void)
{
    const int last = size - 1;
    feti_error_detail detail = { .struct_size = sizeof detail };
    feti_problem *p = created(), *other = created();
    int64_t id = -1;
    double u = 0.0;

    EXPECT(FETI_OK, feti_mpi(p, MPI_COMM_WORLD));
    EXPECT(FETI_OK, feti_mpi(other, MPI_COMM_WORLD));
    gives(p), gives(other);
    if (size > 1) {
        if (rank == last) EXPECT(FETI_OK, stop(p, 1000)); /* nobody has it */
        EXPECT(FETI_ARGUMENT, feti_solve(p, NULL));
        EXPECT(FETI_OK, feti_last_error_detail(&detail));
        CHECK(detail.rank == last && detail.row == 0 && fabs(detail.value - 1000.0) < 1e-9);
        if (rank == last) EXPECT(FETI_OK, feti_rows_clear(p, FETI_INEQUALITY));
        EXPECT(FETI_STATE, rank == last ? feti_setup(p) : feti_solve(p, NULL));   /* different calls */
        EXPECT(FETI_OK, feti_solve(p, NULL));
        EXPECT(FETI_STATE, feti_solve(rank == last ? p : other, NULL));           /* different problems */
        EXPECT(FETI_UNSUPPORTED, feti_problem_read(p, "nothing.feti"));
    }
    if (rank == last) EXPECT(FETI_OK, stop(p, 0));
    EXPECT(FETI_OK, feti_solve(p, NULL));
    EXPECT(FETI_OK, feti_state_save(p, &id));
    EXPECT(FETI_OK, feti_displacement(p, 0, 1, &u));
    CHECK(fabs(u - (rank == 0 ? 1.0 : 1.5)) < 1e-12);
    EXPECT(FETI_OK, feti_state_restore(p, id));
    for (int by = 0; by < size; by++) refused_on_one(p, rank == by, id);
    EXPECT(FETI_OK, feti_problem_write(p, "written.feti"));
    EXPECT(FETI_IO, feti_problem_write(p, "no/such/folder.feti"));
    EXPECT(FETI_OK, feti_solve(other, NULL));
    EXPECT(FETI_OK, feti_problem_destroy(&p));
    EXPECT(FETI_OK, feti_problem_destroy(&other));
}

static void a_communicator_freed_before_its_problem(void)
{
    feti_problem *p = created();
    MPI_Comm own;

    MPI_Comm_dup(MPI_COMM_WORLD, &own);
    EXPECT(FETI_OK, feti_mpi(p, own));
    MPI_Comm_free(&own);
    EXPECT(FETI_COMMUNICATION, feti_mpi(p, own));
    EXPECT(FETI_OK, feti_problem_destroy(&p));
}

static void *on_another_thread(void *unused)
{
    refuses(MPI_COMM_WORLD);
    return unused;
}

static void another_thread(void)
{
    pthread_t thread;

    CHECK(pthread_create(&thread, NULL, on_another_thread, NULL) == 0);
    pthread_join(thread, NULL);
    EXPECT(FETI_OK, feti_mpi_serve(MPI_COMM_WORLD));
}

static void *solves_again_and_again(void *comm)
{
    feti_problem *p = created();

    EXPECT(FETI_OK, feti_mpi(p, *(MPI_Comm *)comm));
    gives(p);
    if (rank == 0) EXPECT(FETI_OK, stop(p, size - 1));
    for (int k = 0; k < 20; k++) EXPECT(FETI_OK, feti_solve(p, NULL));
    EXPECT(FETI_OK, feti_problem_destroy(&p));
    return NULL;
}

/* Parts of two problems, each with a communicator and a thread of its own. */
static void two_threads(void)
{
    MPI_Comm own[2];
    pthread_t threads[2];
    int level;

    MPI_Query_thread(&level);
    CHECK(level == MPI_THREAD_MULTIPLE);
    for (int k = 0; k < 2; k++) MPI_Comm_dup(MPI_COMM_WORLD, &own[k]);
    for (int k = 0; k < 2; k++) CHECK(pthread_create(&threads[k], NULL, solves_again_and_again, &own[k]) == 0);
    for (int k = 0; k < 2; k++) pthread_join(threads[k], NULL);
    for (int k = 0; k < 2; k++) MPI_Comm_free(&own[k]);
}

/* The last rank never makes the call: MPI_Abort ends the others, which wait for it. */
static void a_rank_that_leaves(void)
{
    feti_problem *p = created();

    EXPECT(FETI_OK, feti_mpi(p, MPI_COMM_WORLD));
    gives(p);
    if (rank == size - 1) MPI_Abort(MPI_COMM_WORLD, 3);
    feti_solve(p, NULL);
}

/* Long and short messages to the next rank and back, without the library. */
static void messages(void)
{
    enum { LONG = 300001 };
    static const int64_t bytes[] = { 1, 4095, 4096, 4097, LONG };
    static unsigned char given[LONG], taken[LONG];
    stream *const s = stream_of(MPI_COMM_WORLD);
    const feti_communicator by = table_of(s);

    CHECK(by.rank == rank && by.size == size && by.local_size == size);
    for (int r = 1; r < size; r++)
        for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
            const int64_t n = bytes[k];
            if (rank == 0) {
                for (int64_t i = 0; i < n; i++) given[i] = (unsigned char)(i * 31 + i / 256 * 7 + r);
                CHECK(by.send(by.user, r, n / 2 + 1, given) == 0 && (n < 2 || by.send(by.user, r, n - n / 2 - 1, given + n / 2 + 1) == 0));
                CHECK(by.flush(by.user) == 0 && by.receive(by.user, r, n, taken) == 0 && memcmp(given, taken, (size_t)n) == 0);
            } else if (rank == r) {
                CHECK(by.receive(by.user, 0, n / 2 + 1, taken) == 0 && (n < 2 || by.receive(by.user, 0, n - n / 2 - 1, taken + n / 2 + 1) == 0));
                CHECK(by.send(by.user, 0, n, taken) == 0 && by.flush(by.user) == 0);
            }
        }
    by.release(by.user);
}

static const struct {
    const char *name;
    void (*run)(void);
} CASES[] = {
    { "alive", problems_alive_while_service_ends_and_begins_again },
    { "single", problems_alive_while_service_ends_and_begins_again },
    { "twice", a_second_table },
    { "parts", parts_of_every_rank },
    { "freed", a_communicator_freed_before_its_problem },
    { "thread", another_thread },
    { "threads", two_threads },
    { "leaves", a_rank_that_leaves },
    { "messages", messages },
};

int main(int argc, char **argv)
{
    const char *const name = argc > 1 ? argv[1] : "";
    const int outside = strcmp(name, "outside") == 0;
    feti_problem *late = NULL;
    int level, known = outside;

    if (outside) refuses(MPI_COMM_WORLD);
    if (strcmp(name, "single") == 0) MPI_Init(&argc, &argv);
    else MPI_Init_thread(&argc, &argv, strcmp(name, "threads") == 0 ? MPI_THREAD_MULTIPLE : MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    for (size_t k = 0; k < sizeof CASES / sizeof CASES[0]; k++)
        if (strcmp(name, CASES[k].name) == 0) CASES[k].run(), known = 1;
    if (outside) {
        feti_problem *p = created();
        EXPECT(FETI_COMMUNICATION, feti_mpi(p, MPI_COMM_NULL));
        EXPECT(FETI_OK, feti_problem_destroy(&p));
        late = created();
        EXPECT(FETI_OK, feti_mpi(late, MPI_COMM_WORLD));
        EXPECT(FETI_OK, feti_mpi_serve(MPI_COMM_WORLD));
    }
    CHECK(known);
    MPI_Finalize();
    if (outside) {
        refuses(MPI_COMM_WORLD);
        EXPECT(FETI_OK, feti_problem_destroy(&late));
    }
    if (rank == 0 && failures == 0) puts("ok");
    return failures > 0;
}
