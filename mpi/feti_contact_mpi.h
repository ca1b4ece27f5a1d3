/* feti-contact for hosts with MPI: ranks that give bodies, and ranks that share the work of rank 0 (docs/machines.md). Compile feti_mpi.c with the host's own
   mpicc, and link it with the host; the library itself does not know MPI. */
#ifndef FETI_CONTACT_MPI_H
#define FETI_CONTACT_MPI_H

#include <mpi.h>

#include "feti_contact.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Makes the problem one of the ranks of comm: feti_communicator_set with the functions of MPI. Each rank that has a part of the problem
    calls it after feti_problem_create; those without serve. FETI_COMMUNICATION outside MPI_Init and MPI_Finalize, on a thread that may not call MPI, and if comm is not
    a communicator of one group. */
int32_t feti_mpi(feti_problem *p, MPI_Comm comm);

/** On ranks other than 0: answers rank 0, until rank 0 makes this call, too (feti_serve). Collective: every rank calls it once, with
    the communicator of feti_mpi. */
int32_t feti_mpi_serve(MPI_Comm comm);

/** The same with an integer communicator of Fortran. */
int32_t feti_mpi_f(feti_problem *p, int64_t comm);
int32_t feti_mpi_serve_f(int64_t comm);

#ifdef __cplusplus
}
#endif

#endif
