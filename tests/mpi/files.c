/* files NAME...: rank 0 reads and solves each problem, and prints what came of it: the status, its text, and u and the forces bit by bit.
   The other ranks serve. */
#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "feti_contact.h"
#include "feti_contact_mpi.h"

/* FNV-1a over bytes. */
static uint64_t hashed(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *at = bytes;

    for (size_t k = 0; k < count; k++) hash = (hash ^ at[k]) * UINT64_C(0x100000001b3);
    return hash;
}

static double *room(int64_t count)
{
    double *all = calloc((size_t)count + 1, sizeof *all);

    if (!all) abort();
    return all;
}

/* Bits of u and of the forces. */
static uint64_t bits(feti_problem *p)
{
    int64_t bodies, dofs, rows, eqs;
    uint64_t hash = UINT64_C(0xcbf29ce484222325);

    if (feti_counts(p, &bodies, &dofs, &rows, &eqs)) abort();
    double *u = room(dofs), *lambda = room(rows), *mu = room(eqs);
    const int32_t got[] = { feti_displacement(p, FETI_ALL, dofs, u), feti_multipliers(p, FETI_INEQUALITY, rows, lambda),
                            feti_multipliers(p, FETI_EQUALITY, eqs, mu) };
    hash = hashed(hash, got, sizeof got);
    hash = hashed(hash, u, (size_t)dofs * sizeof *u);
    hash = hashed(hash, lambda, (size_t)rows * sizeof *lambda);
    hash = hashed(hash, mu, (size_t)eqs * sizeof *mu);
    free(u), free(lambda), free(mu);
    return hash;
}

int main(int argc, char **argv)
{
    int rank, bad = 0;
    int64_t ranks = 1, messages = 0;

    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    for (int k = 1; k < argc && rank == 0; k++) {
        const char *name = strrchr(argv[k], '/');
        feti_problem *p = NULL;
        char text[400] = "";

        if (feti_problem_create(&p) || feti_mpi(p, MPI_COMM_WORLD) || feti_problem_read(p, argv[k])) {
            feti_last_error(text, sizeof text);
            fprintf(stderr, "%s: %s\n", argv[k], text);
            bad = 1;
        } else {
            feti_info info = { .struct_size = sizeof info };
            const int32_t status = feti_solve(p, &info);
            if (status) feti_last_error(text, sizeof text);
            printf("%s %s %" PRId64 " %016" PRIx64 " %s\n", name ? name + 1 : argv[k], feti_status_name(status), info.steps, bits(p),
                   text);
            ranks = info.ranks, messages = info.messages;
        }
        feti_problem_destroy(&p);
    }
    if (rank == 0 && ranks > 1 && messages == 0) fprintf(stderr, "no body was lent\n"), bad = 1;
    if (feti_mpi_serve(MPI_COMM_WORLD)) bad = 1;
    MPI_Finalize();
    return bad;
}
