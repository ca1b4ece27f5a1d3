/* statuses: three ranks give bodies and rows, and one of them, each in turn, makes a mistake, before the first solve and after one. All
   ranks get the same status, the same text and the same place, in the numbers of the rank that has made it; when it has mended its part
   alone, all get the bits of a problem without the mistake. Then one rank, each in turn, spoils its part of the answer, and the certificate
   names it. Rank 0 prints every mistake with its statuses; failures are told on stderr. */
#define _POSIX_C_SOURCE 200809L
#include <stddef.h>

#include "statuses.h"

/* Where a mistake is: at the rank that errs, at the later of it and the next one, at some rank that all name alike, or nowhere; body and row
   in the numbers of that rank, from `by`, its last bar and row. */
enum { NOWHERE, AT_RANK, LATER, SOMEWHERE, NO = -100, LAST = 0, NEXT = 1, BEHIND = 2 };

/* A mistake: what spoils the part of a rank, and the call that tells it, feti_solve if there is none; the status if rank 0 errs, and if
   another does; its place. */
typedef struct {
    const char *name;
    void (*spoil)(feti_problem *p);
    int32_t (*call)(feti_problem *p, int wrong);
    int32_t status[2];
    int where, body, part, row;
} mistake;

static const mistake MISTAKES[] = {
#define EACH(status) { status, status }
#define LEADER(status) { status, FETI_OK }
    { "no matrix", no_matrix, NULL, EACH(FETI_STATE), AT_RANK, BEHIND, NO, NO },
    { "no numbers", no_numbers, NULL, EACH(FETI_STATE), AT_RANK, BEHIND, NO, NO },
    { "an element is missing", no_element, NULL, EACH(FETI_STATE), AT_RANK, NEXT, NO, NO },
    { "number of nobody", nobody, NULL, EACH(FETI_ARGUMENT), AT_RANK, NO, NO, NEXT },
    { "number of nobody at a node", nobody_at_node, NULL, EACH(FETI_ARGUMENT), AT_RANK, NO, NO, NEXT },
    { "number of another rank", anothers, NULL, EACH(FETI_ARGUMENT), LATER, NO, NO, NO },
    { "negative diagonal", negative_diagonal, NULL, EACH(FETI_INDEFINITE), AT_RANK, BEHIND, NO, NO },
    { "negative pivot", negative_pivot, NULL, EACH(FETI_INDEFINITE), AT_RANK, BEHIND, NO, NO },
    { "negative motion", negative_motion, NULL, EACH(FETI_INDEFINITE), AT_RANK, BEHIND, 0, NO },
    { "wrong motion", wrong_motion, NULL, EACH(FETI_NULL_SPACE), AT_RANK, LAST, NO, NO },
    { "no motion", no_motion, NULL, EACH(FETI_NULL_SPACE), AT_RANK, LAST, NO, NO },
    { "wrong fixing unknowns", wrong_fixing, NULL, EACH(FETI_NULL_SPACE), AT_RANK, LAST, NO, NO },
    { "load not held", loose, NULL, EACH(FETI_LOAD_NOT_HELD), AT_RANK, BEHIND, 1, NO },
    { "friction gives way", slips_away, NULL, EACH(FETI_LOAD_NOT_HELD), AT_RANK, BEHIND, 0, NO },
    { "slides", slides, NULL, EACH(FETI_SLIDES), AT_RANK, BEHIND, 0, NO },
    { "energy beyond numbers", beyond_numbers, NULL, EACH(FETI_INACCURATE), NOWHERE, NO, NO, NO },
    { "hardly held", hardly_held, NULL, EACH(FETI_MARGINAL), NOWHERE, NO, NO, NO },
    { "equality against equality", other_equality, NULL, EACH(FETI_GAPS_CONTRADICT), AT_RANK, NO, NO, NEXT },
    { "contact against equality", below_ground, NULL, EACH(FETI_GAPS_CONTRADICT), AT_RANK, NO, NO, LAST },
    { "contact row without entries", nothing_below, NULL, EACH(FETI_GAPS_CONTRADICT), AT_RANK, NO, NO, NEXT },
    { "equality row without entries", nothing_equal, NULL, EACH(FETI_GAPS_CONTRADICT), AT_RANK, NO, NO, NEXT },
    { "large row", large_row, NULL, EACH(FETI_OVERFLOW), AT_RANK, NO, NO, NEXT },
    { "small row", small_row, NULL, EACH(FETI_OVERFLOW), AT_RANK, NO, NO, NEXT },
    { "large tangential row", large_node, NULL, EACH(FETI_OVERFLOW), AT_RANK, NO, NO, NEXT },
    { "soft row", soft_row, NULL, EACH(FETI_OVERFLOW), AT_RANK, NO, NO, LAST },
    { "refused in local calls", refused, NULL, EACH(FETI_OK), NOWHERE, NO, NO, NO },
    { "functions of the host", functions, NULL, { FETI_CALLBACK, FETI_UNSUPPORTED }, AT_RANK, BEHIND, NO, NO },
    { "functions to a file", functions, writes_functions, EACH(FETI_UNSUPPORTED), AT_RANK, BEHIND, NO, NO },
    { "little memory", little_memory, NULL, LEADER(FETI_MEMORY), SOMEWHERE, NO, NO, NO },
    { "little time", little_time, NULL, LEADER(FETI_TIME), NOWHERE, NO, NO, NO },
    { "one step", one_step, NULL, LEADER(FETI_ITERATIONS), NOWHERE, NO, NO, NO },
    { "strict", strict, NULL, LEADER(FETI_STALLED), NOWHERE, NO, NO, NO },
    { "progress stops", stops, NULL, LEADER(FETI_CANCELLED), NOWHERE, NO, NO, NO },
    { "progress breaks", breaks, NULL, LEADER(FETI_CALLBACK), NOWHERE, NO, NO, NO },
    { "log breaks", breaks_log, NULL, LEADER(FETI_CALLBACK), NOWHERE, NO, NO, NO },
    { "another thread cancels", NULL, cancelled, EACH(FETI_CANCELLED), NOWHERE, NO, NO, NO },
    { "another call", NULL, other_call, EACH(FETI_STATE), NOWHERE, NO, NO, NO },
    { "slips of one rank", NULL, commits_alone, EACH(FETI_STATE), NOWHERE, NO, NO, NO },
    { "a file is read", NULL, reads, EACH(FETI_UNSUPPORTED), NOWHERE, NO, NO, NO },
    { "bad path", NULL, writes_nowhere, LEADER(FETI_IO), NOWHERE, NO, NO, NO },
    { "no path", NULL, writes_no_path, EACH(FETI_ARGUMENT - 2), AT_RANK, NO, NO, NO },
    { "short info", NULL, short_info, EACH(FETI_ARGUMENT - 2), AT_RANK, NO, NO, NO },
    { "state without number", NULL, saves_nowhere, EACH(FETI_ARGUMENT - 2), AT_RANK, NO, NO, NO },
    { "state that was dropped", NULL, restores_nothing, EACH(FETI_ARGUMENT - 2), AT_RANK, NO, NO, NO },
    { "short certificate", NULL, checks_nowhere, EACH(FETI_ARGUMENT - 11), AT_RANK, NO, NO, NO },
    { "check of more unknowns", NULL, checks_more, EACH(FETI_ARGUMENT - 2), AT_RANK, NO, NO, NO },
    { "check of what is no number", NULL, checks_nan, EACH(FETI_ARGUMENT - 3), AT_RANK, NO, NO, NO },
    { "check without forces", NULL, checks_null, EACH(FETI_ARGUMENT - 5), AT_RANK, NO, NO, NO },
    { "check of more nodes", NULL, checks_nodes, EACH(FETI_ARGUMENT - 8), AT_RANK, NO, NO, NO },
    { "closed", closes, NULL, EACH(FETI_INTERNAL), AT_RANK, NO, NO, NO },
};

/* What this rank has of an answer: displacements without those of the body of a mistake, forces of rows and nodes. */
typedef struct { double u[RANKS * N + SPARE], lambda[RANKS], mu[RANKS], tangential[RANKS]; } answer;

static answer good;

static feti_problem *created(void)
{
    feti_problem *p = NULL;

    SURE(feti_problem_create(&p));
    SURE(feti_mpi(p, MPI_COMM_WORLD));
    give(p);
    return p;
}

static answer solved(feti_problem *p)
{
    answer a = { .u = { 0.0 } };

    SURE(feti_solve(p, NULL));
    for (int k = 0; k <= rank + 1; k++) SURE(feti_displacement(p, k, k <= rank ? N : SPARE, a.u + k * N));
    SURE(feti_multipliers(p, FETI_INEQUALITY, rank + 1, a.lambda));
    SURE(feti_multipliers(p, FETI_EQUALITY, rank + 1, a.mu));
    SURE(feti_multipliers(p, FETI_TANGENTIAL, rank + 1, a.tangential));
    return a;
}

/* All ranks have the bytes of rank 0. */
static int same(const void *bytes, size_t count)
{
    char first[600];

    memcpy(first, bytes, count);
    MPI_Bcast(first, (int)count, MPI_CHAR, 0, MPI_COMM_WORLD);
    return memcmp(first, bytes, count) == 0;
}

static int64_t place(int from) { return from == NO ? -1 : by + from; }

/* What all ranks hear. */
static void told(feti_problem *p, const mistake *m, int32_t status)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    feti_findings found = { .struct_size = sizeof found };
    char text[600] = "", kept[600] = "";
    int64_t length;

    SURE(feti_last_error_detail(&detail));
    feti_last_error(text, sizeof text);
    SURE(feti_problem_error(p, kept, sizeof kept, &length));
    CHECK(detail.status == status && strcmp(text, kept) == 0);
    if (m->call != other_call) CHECK(same(&detail, sizeof detail) && same(text, sizeof text));
    if (m->where != SOMEWHERE) {
        const int next = (by + 1) % RANKS;
        CHECK(detail.rank == (m->where == NOWHERE ? -1 : m->where == LATER && next > by ? next : by));
        CHECK(detail.body == place(m->body) && detail.row == place(m->row) && detail.component == (m->part == NO ? -1 : m->part));
    }
    if (status == FETI_INTERNAL || feti_diagnosis(p, &found) != FETI_OK || found.status != status || status > 0) return;
    CHECK(found.rank == detail.rank && found.body == detail.body && found.component == detail.component && found.row == detail.row);
}

/* A mistake of rank `by`; in turn 1 after a good solve. */
static int32_t made(const mistake *m)
{
    feti_problem *p = created();
    const int wrong = rank == by;

    if (turn == 1) solved(p);
    if (wrong && m->spoil) m->spoil(p);
    const int32_t status = m->call ? m->call(p, wrong) : feti_solve(p, NULL);
    CHECK(same(&status, sizeof status));
    if (status != m->status[by > 0]) fail("the status", status);
    if (status != FETI_OK) told(p, m, status);
    if (status == FETI_INTERNAL) CHECK(feti_solve(p, NULL) == FETI_INTERNAL);
    else {
        if (wrong) give(p);
        const answer a = solved(p);
        CHECK(memcmp(&a, &good, sizeof a) == 0);
    }
    SURE(feti_problem_destroy(&p));
    return status;
}

/* ---- the worst place of a certificate */

typedef struct { const char *name; size_t entry, place, rank; int behind; } entry;

static const entry ENTRIES[] = {
#define AT(figure, place, of_rank, behind) \
    { #figure, offsetof(feti_certificate, figure), offsetof(feti_certificate, place), offsetof(feti_certificate, of_rank), behind }
    AT(equilibrium, equilibrium_body, equilibrium_rank, LAST),
    AT(balance, balance_body, balance_rank, NEXT),
    AT(penetration, penetration_row, penetration_rank, LAST),
    AT(equality, equality_row, equality_rank, LAST),
    AT(negative_force, force_row, force_rank, LAST),
    AT(complementarity, complementarity_row, complementarity_rank, LAST),
    AT(friction_cone, friction_cone_node, friction_cone_rank, LAST),
    AT(friction_work, friction_work_node, friction_work_rank, LAST),
    AT(friction_stick, friction_stick_node, friction_stick_rank, LAST),
};

/* Spoils the answer of this rank for an entry. */
static void spoil(answer *a, int k)
{
    double *const u = a->u + rank * N; /* of the last bar */

    switch (k) {
    case 0: u[2] += 10.0; break;
    case 1: a->mu[rank] += 10.0; break;
    case 2: u[0] -= 10.0; break;
    case 3: u[N + rank] += 10.0; break;
    case 4: a->lambda[rank] = -10.0; break;
    case 5: u[0] += 10.0; break;
    case 6: a->tangential[rank] = 10.0; break;
    case 7: u[1] = 10.0, a->tangential[rank] = -0.01 * (rank + 1); break;
    default: u[1] = 10.0, a->tangential[rank] = 0.0;
    }
}

static void certified(feti_problem *p, const entry *e)
{
    feti_certificate seen = { .struct_size = sizeof seen };
    const char *const from = (const char *)&seen;
    answer a = good;
    double figure;
    int64_t found[2];

    if (rank == by) spoil(&a, (int)(e - ENTRIES));
    SURE(feti_check_friction(p, (rank + 1) * N + SPARE, a.u, rank + 1, a.lambda, rank + 1, a.mu, rank + 1, 1, a.tangential, &seen));
    memcpy(&figure, from + e->entry, sizeof figure);
    memcpy(&found[0], from + e->place, sizeof found[0]), memcpy(&found[1], from + e->rank, sizeof found[1]);
    CHECK(same(&seen, sizeof seen) && !seen.passed && figure > seen.limit);
    if (found[0] != place(e->behind) || found[1] != by)
        fprintf(stderr, "rank %d: %s of rank %d: %g at %d of rank %d\n", rank, at, by, figure, (int)found[0], (int)found[1]), failures++;
}

int main(int argc, char **argv)
{
    int size, level, all;

    alarm(SECONDS); /* and again for each mistake: no rank waits longer for another, however slow the machine is */
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank), MPI_Comm_size(MPI_COMM_WORLD, &size);
    if (size != RANKS) return fprintf(stderr, "statuses takes %d ranks\n", RANKS), MPI_Abort(MPI_COMM_WORLD, 2);
    feti_problem *p = created();
    good = solved(p);
    for (size_t k = 0; k < sizeof MISTAKES / sizeof MISTAKES[0]; k++) {
        at = MISTAKES[k].name, alarm(SECONDS);
        if (argc > 1 && strcmp(argv[1], at)) continue;
        if (rank == 0) printf("%s:", at);
        for (by = 0; by < RANKS; by++)
            for (turn = 0; turn < 2; turn++) {
                const int32_t status = made(&MISTAKES[k]);
                if (rank == 0 && turn == 0) printf(" %s", feti_status_name(status));
            }
        if (rank == 0) puts(""), fflush(stdout);
    }
    for (size_t k = 0; k < sizeof ENTRIES / sizeof ENTRIES[0]; k++)
        for (at = ENTRIES[k].name, by = 0; by < RANKS; by++) certified(p, &ENTRIES[k]);
    SURE(feti_problem_destroy(&p));
    MPI_Allreduce(&failures, &all, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    MPI_Finalize();
    return all > 0;
}
