/* deals NAME...: every rank reads each problem, which tests/dealt/files.rs has written; bodies, rows and nodes with friction are dealt out
   at random, three times, and each rank gives its own hand. Rank 0 prints the status, the steps and hashes of all bits that ranks have got,
   which must be the same for three deals. One rank first takes everything in the order of the file. */
#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "feti_contact.h"
#include "feti_contact_mpi.h"

/* What is dealt out: bodies, rows by their kinds, and nodes as the kind of tangential rows. */
enum { BODIES, KINDS = FETI_TANGENTIAL + 1, DEALS = 3 };

typedef struct {
    int64_t n, modes, flag, dimension;
    const int64_t *number, *ptr, *col;
    const double *val, *load, *basis, *xyz;
    const int32_t *node, *dir;
} body;

/* Rows that are given twice have one key: any of them may have the force. */
typedef struct {
    int64_t count;
    const int64_t *key, *ptr, *col;
    const double *val, *rhs, *inv_k;
} rows;

typedef struct {
    int64_t count[KINDS], dim, dofs;
    const char *options;
    body *bodies;
    rows rows[KINDS];
    const int64_t *normal;
    const double *coefficient, *bound;
} deck;

typedef struct { int64_t count, *item; } pile;

/* Hashes of what all ranks are told, and of bodies, rows and nodes. */
typedef struct {
    uint64_t told, of[KINDS];
    int64_t status, steps;
} answer;

static const uint64_t BASIS = UINT64_C(0xcbf29ce484222325);
static int rank, size, bad, bare;
static const char *file, *at, *end; /* what is left of its words */
static uint64_t state;              /* of the generator, equal on all ranks */

static void die(const char *what)
{
    char text[400] = "";

    feti_last_error(text, sizeof text);
    fprintf(stderr, "rank %d: %s: %s: %s\n", rank, file, what, text);
    MPI_Abort(MPI_COMM_WORLD, 1), abort();
}

/* A call that has to return 0. */
#define SURE(call) ((call) ? die(#call) : (void)0)

static void *room(int64_t count)
{
    void *all = calloc((size_t)count + 1, sizeof(double));

    if (!all) die("memory");
    return all;
}

/* FNV-1a over bytes. */
static uint64_t hashed(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;

    for (size_t k = 0; k < count; k++) hash = (hash ^ byte[k]) * UINT64_C(0x100000001b3);
    return hash;
}

/* The next words of the file, of 8 bytes. */
static const void *words(int64_t count)
{
    if (count < 0 || count > (end - at) / 8) die("the file is too short");
    return (at += count * 8) - count * 8;
}

static int64_t number(void) { return *(const int64_t *)words(1); }

static deck read_deck(void)
{
    deck d = { .dofs = 0 };

    d.count[BODIES] = number(), d.dim = number(), d.count[FETI_TANGENTIAL] = number(), d.options = words(4);
    d.bodies = room(d.count[BODIES] * (int64_t)sizeof *d.bodies / 8);
    for (body *b = d.bodies; b < d.bodies + d.count[BODIES]; d.dofs += b++->n) {
        b->n = number(), b->modes = number(), b->flag = number(), b->dimension = number(), b->number = words(b->n);
        b->ptr = words(b->n + 1), b->col = words(b->ptr[b->n]), b->val = words(b->ptr[b->n]), b->load = words(b->n);
        if (b->modes > 0) b->basis = words(b->modes * b->n);
        if (b->dimension > 0) b->node = words((b->n + 1) / 2), b->dir = words((b->n + 1) / 2), b->xyz = words(3 * b->n);
    }
    for (int kind = FETI_INEQUALITY; kind < KINDS; kind++) {
        rows *r = &d.rows[kind];
        r->count = number(), r->key = words(r->count), r->ptr = words(r->count + 1), r->col = words(r->ptr[r->count]);
        r->val = words(r->ptr[r->count]), r->rhs = words(r->count), r->inv_k = words(r->count);
        if (kind != FETI_TANGENTIAL) d.count[kind] = r->count;
    }
    d.normal = words(d.count[FETI_TANGENTIAL]);
    d.coefficient = words(d.count[FETI_TANGENTIAL]), d.bound = words(d.count[FETI_TANGENTIAL]);
    return d;
}

/* SplitMix64. */
static int64_t below(int64_t n)
{
    uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);

    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (int64_t)((z ^ (z >> 31)) % (uint64_t)n);
}

static int64_t place(const pile *own, int64_t item)
{
    int64_t k = own->count - 1;

    while (k >= 0 && own->item[k] != item) k--;
    return k;
}

/* The hand of this rank; whether it has nothing, and serves. If all others served, rank 0 would take rows in its own order. */
static int deal(const deck *d, int ordered, pile *own)
{
    const int64_t players = 1 + below(size), begin = below(size);
    int64_t all = 0;
    int serves = 0;

    for (int kind = 0; kind < KINDS; all += own[kind++].count) {
        int64_t *const item = own[kind].item;
        for (int64_t k = 0, by; k < d->count[kind]; k++) by = ordered ? k : below(k + 1), item[k] = item[by], item[by] = k;
        own[kind].count = 0;
        for (int64_t k = 0; k < d->count[kind]; k++) {
            const int64_t normal = kind == FETI_TANGENTIAL ? d->normal[item[k]] : -1;
            const int mine = (begin + below(players)) % size == rank;
            if (normal < 0 ? mine : place(&own[FETI_INEQUALITY], normal) >= 0) item[own[kind].count++] = item[k];
        }
    }
    for (int r = 2; r < size; r++) serves |= below(2) && r == rank;
    return serves && all == 0;
}

static void give(feti_problem *p, const deck *d, const pile *own)
{
    const int32_t dim = (int32_t)d->dim;
    int64_t k, first, ptr[3] = { 0 };

    SURE(feti_set_text(p, d->options));
    for (k = 0; k < own[BODIES].count; k++) {
        const body *b = &d->bodies[own[BODIES].item[k]];
        SURE(feti_body_add(p, b->n, &first));
        SURE(feti_body_stiffness_i64(p, k, b->n, b->ptr, b->col, b->val, 0, FETI_LOWER, FETI_COPY));
        SURE(feti_body_load(p, k, b->n, b->load));
        if (b->modes >= 0) SURE(feti_body_null_space(p, k, b->modes, b->n, b->basis, b->n, (int32_t)b->flag));
        if (b->dimension > 0) SURE(feti_body_coordinates(p, k, (int32_t)b->dimension, b->n, b->node, b->dir, b->xyz, 3));
        SURE(feti_body_numbering_i64(p, k, b->n, b->number, 0));
    }
    for (int kind = FETI_INEQUALITY; kind <= FETI_EQUALITY; kind++)
        for (k = 0; k < own[kind].count; k++) {
            const rows *r = &d->rows[kind];
            const int64_t row = own[kind].item[k], from = r->ptr[row];
            ptr[1] = r->ptr[row + 1] - from;
            SURE(feti_rows_add_i64(p, kind, 1, ptr, NULL, r->col + from, r->val + from, 0, r->rhs + row, &first));
            SURE(feti_rows_compliance(p, kind, first, 1, r->inv_k + row));
        }
    for (k = 0; k < own[FETI_TANGENTIAL].count; k++) {
        const rows *r = &d->rows[FETI_TANGENTIAL];
        const int64_t node = own[FETI_TANGENTIAL].item[k], row = node * d->dim, from = r->ptr[row];
        const int64_t normal = d->normal[node] < 0 ? -1 : place(&own[FETI_INEQUALITY], d->normal[node]);
        const double *const coefficient = d->coefficient + node, *const bound = d->bound + node;
        for (int i = 1; i <= dim; i++) ptr[i] = r->ptr[row + i] - from;
        SURE(feti_friction_add_i64(p, 1, dim, &normal, ptr, NULL, r->col + from, r->val + from, 0, coefficient, bound, &first));
        SURE(feti_friction_compliance(p, first, 1, r->inv_k + row));
        SURE(feti_friction_reference(p, first, 1, dim, r->rhs + row));
    }
}

/* Adds values of all bodies, rows or nodes of this rank to their hashes. */
static void add(uint64_t *word, int64_t count, const void *from, size_t bytes)
{
    for (int64_t k = 0; k < count; k++) word[k] = hashed(word[k], (const char *)from + (size_t)k * bytes, bytes);
}

#define TOLD(what) (a->told = hashed(a->told, &(what), sizeof(what)))
#define PART(from, to) (a->told = hashed(a->told, &(from), (size_t)((const char *)&(to) - (const char *)&(from))))
#define ADD(kind, call, from, bytes) (got = (call), TOLD(got), got ? (void)0 : add(word[kind], own[kind].count, from, bytes))

static void take(feti_problem *p, const deck *d, const pile *own, answer *a)
{
    const int64_t contacts = own[FETI_INEQUALITY].count, eqs = own[FETI_EQUALITY].count, nodes = own[FETI_TANGENTIAL].count;
    const int64_t most = d->dofs + contacts + eqs + d->rows[FETI_TANGENTIAL].count;
    const int32_t dim = (int32_t)d->dim;
    feti_info info = { .struct_size = sizeof info };
    feti_certificate seen = { .struct_size = sizeof seen };
    feti_error_detail detail = { .struct_size = sizeof detail, .body = -1 };
    double *const u = room(5 * most), *const x = u + most, *const f[] = { NULL, x + most, x + 2 * most, x + 3 * most };
    uint64_t *word[KINDS];
    int64_t *const found = room(most), n = 0, count;
    int32_t *const states = room(most), got;

    a->status = feti_solve(p, &info), a->steps = info.steps, a->told = BASIS, TOLD(a->status);
    PART(info.floating_modes, info.factorisations), PART(info.worst, info.seconds_setup), PART(info.direct_solves, info.columns_computed);
    PART(info.friction_cone, info.nodes), PART(info.sticking, info.ranks);
    PART(info.bodies, info.floating_modes), TOLD(info.nodes);
    if (a->status < 0) SURE(feti_last_error_detail(&detail)), TOLD(detail.value), TOLD(detail.limit);
    for (int kind = 0; kind < KINDS; kind++) {
        const int64_t width = kind == FETI_TANGENTIAL ? dim : 1, *const item = own[kind].item;
        const int is_row = kind == FETI_INEQUALITY || kind == FETI_EQUALITY;
        word[kind] = room(own[kind].count);
        for (int64_t k = 0; k < own[kind].count; k++)
            word[kind][k] = hashed(BASIS, is_row ? &d->rows[kind].key[item[k]] : &item[k], sizeof *item);
        if (kind != BODIES) ADD(kind, feti_multipliers(p, kind, own[kind].count * width, f[kind]), f[kind], (size_t)width * sizeof *u);
        if (is_row) SURE(feti_diagnosis_rows(p, kind, own[kind].count, &count, found, x));
        for (int64_t k = 0; is_row && k < count; k++) add(word[kind] + found[k], 1, x + k, sizeof *x);
    }
    for (int64_t k = 0, of; k < own[BODIES].count; k++, n += of) {
        of = d->bodies[own[BODIES].item[k]].n;
        const int is_named = detail.body == k && (detail.rank < 0 || detail.rank == rank);
        const int32_t got_both[] = { feti_displacement(p, k, of, u + n), feti_reaction(p, 0, k, of, x), is_named };
        add(word[BODIES] + k, 1, got_both, sizeof got_both);
        add(word[BODIES] + k, 1, u + n, got_both[0] ? 0 : (size_t)of * sizeof *u);
        add(word[BODIES] + k, 1, x, got_both[1] ? 0 : (size_t)of * sizeof *x);
    }
    ADD(FETI_INEQUALITY, feti_gaps(p, contacts, x), x, sizeof *x);
    ADD(FETI_INEQUALITY, feti_active(p, contacts, states), states, sizeof *states);
    ADD(FETI_TANGENTIAL, feti_friction_slips(p, nodes, dim, x), x, (size_t)dim * sizeof *x);
    ADD(FETI_TANGENTIAL, feti_friction_states(p, nodes, states), states, sizeof *states);
    if (a->status >= 0) {
        SURE(feti_check_friction(p, n, u, contacts, f[FETI_INEQUALITY], eqs, f[FETI_EQUALITY], nodes, dim, f[FETI_TANGENTIAL], &seen));
        PART(seen.passed, seen.equilibrium_body), PART(seen.friction_cone, seen.friction_cone_node);
    }
    for (int kind = 0; kind < KINDS; free(word[kind++]))
        for (int64_t k = 0; k < own[kind].count; k++) a->of[kind] += word[kind][k];
    free(u), free(found), free(states);
}

static void solve(const deck *d)
{
    pile own[KINDS];
    answer first = { .told = 0 };

    for (int kind = 0; kind < KINDS; kind++) own[kind].item = room(d->count[kind]);
    for (int k = 0; k < DEALS; k++) {
        const int serves = deal(d, size == 1 && k == 0, own);
        feti_problem *p = NULL;
        answer a = { .told = 0 };
        if (!serves) {
            SURE(feti_problem_create(&p));
            SURE(feti_mpi(p, MPI_COMM_WORLD));
            give(p, d, own);
            take(p, d, own, &a);
            SURE(feti_problem_destroy(&p));
        }
        SURE(feti_mpi_serve(MPI_COMM_WORLD));
        uint64_t told = a.told;
        MPI_Bcast(&told, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
        if (!serves && a.told != told) fprintf(stderr, "%s: rank %d is told something else than rank 0\n", file, rank), bad = 1;
        MPI_Reduce(rank ? a.of : MPI_IN_PLACE, a.of, KINDS, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
        bare |= own[BODIES].count == 0;
        if (rank > 0 || (k > 0 && a.told == first.told && memcmp(a.of, first.of, sizeof a.of) == 0)) continue;
        bad |= k > 0;
        printf("%s %s %" PRId64 " %016" PRIx64, file, feti_status_name((int32_t)a.status), a.steps, a.told);
        for (int kind = 0; kind < KINDS; kind++) printf(" %016" PRIx64 "%s", a.of[kind], kind == KINDS - 1 ? "\n" : "");
        if (k == 0) first = a;
    }
    for (int kind = 0; kind < KINDS; kind++) free(own[kind].item);
}

int main(int argc, char **argv)
{
    const size_t most = 1 << 24;

    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank), MPI_Comm_size(MPI_COMM_WORLD, &size);
    char *const all = room((int64_t)most / 8);
    for (int k = 1; k < argc; k++) {
        FILE *const from = fopen(argv[k], "rb");
        file = strrchr(argv[k], '/') ? strrchr(argv[k], '/') + 1 : argv[k];
        SURE(!from);
        at = all, end = all + fread(all, 1, most, from), state = hashed(BASIS, all, (size_t)(end - at));
        fclose(from);
        const deck d = read_deck();
        solve(&d);
        free(d.bodies);
    }
    free(all);
    if (rank == 0 && size > 1 && !bare) fprintf(stderr, "rank 0 always has bodies\n"), bad = 1;
    MPI_Finalize();
    return bad;
}
