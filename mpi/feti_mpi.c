/* The functions of feti_communicator by MPI. The messages of a communicator run on a duplicate, which is an attribute of it and freed
   with it: freeing is collective, so it must not happen when a problem is destroyed. */
#define _POSIX_C_SOURCE 200809L
#include "feti_contact_mpi.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <time.h>

/* Largest message in bytes: MPI counts in int. */
#ifndef FETI_MPI_CHUNK
#define FETI_MPI_CHUNK (1 << 30)
#endif

enum { TAG = 0, SPINS = 2000, SHORTEST = 20000, LONGEST = 100000 /* nanoseconds */ };

/* A duplicate with the messages on their way. */
typedef struct {
    MPI_Comm comm;
    int rank, size, local_size;
    int closed;  /* the host has freed its communicator */
    int holders; /* the attribute, and the tables that the library has; under `lock` */
    int sent, room;
    MPI_Request *sends;
} stream;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int key = MPI_KEYVAL_INVALID; /* under `lock` */

/* MPI is not there, or this thread may not call it. */
static int barred(void)
{
    int begun = 0, over = 0, level = MPI_THREAD_SINGLE, is_main = 1;

    MPI_Initialized(&begun);
    MPI_Finalized(&over);
    if (!begun || over) return 1;
    MPI_Query_thread(&level);
    if (level < MPI_THREAD_SERIALIZED) MPI_Is_thread_main(&is_main);
    return !is_main;
}

/* A moment for others, the longer the more often it has been tried. Rank 0 only yields: the others wait for it. */
static void rest(const stream *s, long tries)
{
    struct timespec pause = { 0, SHORTEST };

    if (tries < SPINS) return;
    if (s->rank == 0) {
        sched_yield();
        return;
    }
    pause.tv_nsec += (tries - SPINS) * 1000;
    if (pause.tv_nsec > LONGEST) pause.tv_nsec = LONGEST;
    nanosleep(&pause, NULL);
}

/* Waits for a message; whether it is complete. */
static int completed(const stream *s, MPI_Request *request)
{
    int done = 0;

    for (long tries = 0; !done; tries++) {
        if (MPI_Test(request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) return 0;
        if (!done) rest(s, tries);
    }
    return 1;
}

static int32_t flush_messages(void *user)
{
    stream *s = user;
    int failed = 0;

    if (s->sent > 0 && (s->closed || barred())) return 1;
    /* after a failure of one message the others are waited for, too: their data are freed */
    for (int i = 0; i < s->sent; i++) failed |= !completed(s, &s->sends[i]);
    s->sent = 0;
    return failed;
}

/* Bytes of the next message. */
static int portion(int64_t left)
{
    return (int)(left < FETI_MPI_CHUNK ? left : FETI_MPI_CHUNK);
}

static int32_t send_message(void *user, int32_t rank, int64_t bytes, const void *data)
{
    stream *s = user;

    if (s->closed || barred()) return 1;
    for (int64_t at = 0; at < bytes; at += FETI_MPI_CHUNK) {
        const int count = portion(bytes - at);
        int failed = 0;

        if (s->sent == s->room) {
            MPI_Request *more = realloc(s->sends, (size_t)(2 * s->room + 64) * sizeof *more);
            failed = !more;
            if (more) s->sends = more, s->room = 2 * s->room + 64;
        }
        /* MPI before version 3 takes data to send as not constant */
        failed = failed || MPI_Isend((char *)(size_t)data + at, count, MPI_BYTE, rank, TAG, s->comm, &s->sends[s->sent]) != MPI_SUCCESS;
        if (failed) {
            /* after a failure the library frees what is on its way */
            flush_messages(s);
            return 1;
        }
        s->sent++;
    }
    return 0;
}

static int32_t receive_message(void *user, int32_t rank, int64_t bytes, void *data)
{
    stream *s = user;

    if (s->closed || barred()) return 1;
    for (int64_t at = 0; at < bytes; at += FETI_MPI_CHUNK) {
        const int count = portion(bytes - at);
        MPI_Request request;

        if (MPI_Irecv((char *)data + at, count, MPI_BYTE, rank, TAG, s->comm, &request) != MPI_SUCCESS) return 1;
        if (!completed(s, &request)) return 1;
    }
    return 0;
}

static void drop(stream *s)
{
    pthread_mutex_lock(&lock);
    const int left = --s->holders;
    pthread_mutex_unlock(&lock);
    if (left > 0) return;
    free(s->sends);
    free(s);
}

static void release_table(void *user)
{
    drop(user);
}

/* The host frees its communicator, or MPI ends. */
static int forget(MPI_Comm comm, int keyval, void *value, void *extra)
{
    stream *s = value;
    int over = 0;

    (void)comm, (void)keyval, (void)extra;
    s->closed = 1;
    MPI_Finalized(&over);
    if (!over) MPI_Comm_free(&s->comm);
    drop(s);
    return MPI_SUCCESS;
}

/* The key of the attribute, or MPI_KEYVAL_INVALID. */
static int key_of_streams(void)
{
    pthread_mutex_lock(&lock);
    if (key == MPI_KEYVAL_INVALID && MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, forget, &key, NULL) != MPI_SUCCESS)
        key = MPI_KEYVAL_INVALID;
    const int found = key;
    pthread_mutex_unlock(&lock);
    return found;
}

/* What the duplicate is; 0 if MPI refuses something. */
static int describe(stream *s)
{
    MPI_Comm machine;

    MPI_Comm_set_errhandler(s->comm, MPI_ERRORS_RETURN);
    if (MPI_Comm_rank(s->comm, &s->rank) != MPI_SUCCESS || MPI_Comm_size(s->comm, &s->size) != MPI_SUCCESS
        || MPI_Comm_split_type(s->comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine) != MPI_SUCCESS)
        return 0;
    MPI_Comm_size(machine, &s->local_size);
    MPI_Comm_free(&machine);
    return 1;
}

/* The stream of a communicator: its attribute, made by the first call, which is collective. NULL: not possible. */
static stream *stream_of(MPI_Comm comm)
{
    stream *s = NULL;
    int found = 0, has_two_groups = 0;

    if (barred() || comm == MPI_COMM_NULL) return NULL;
    if (MPI_Comm_test_inter(comm, &has_two_groups) != MPI_SUCCESS || has_two_groups) return NULL;
    const int attribute = key_of_streams();
    if (attribute == MPI_KEYVAL_INVALID || MPI_Comm_get_attr(comm, attribute, &s, &found) != MPI_SUCCESS) return NULL;
    if (found) return s;
    s = calloc(1, sizeof *s);
    if (!s || MPI_Comm_dup(comm, &s->comm) != MPI_SUCCESS) {
        free(s);
        return NULL;
    }
    s->holders = 1;
    if (!describe(s) || MPI_Comm_set_attr(comm, attribute, s) != MPI_SUCCESS) {
        MPI_Comm_free(&s->comm);
        free(s);
        return NULL;
    }
    return s;
}

static feti_communicator table_of(stream *s)
{
    const feti_communicator by = { .struct_size = sizeof by, .rank = s->rank, .size = s->size, .local_size = s->local_size,
                                   .user = s, .send = send_message, .flush = flush_messages, .receive = receive_message,
                                   .release = release_table };

    pthread_mutex_lock(&lock);
    s->holders++; /* until the library calls release, or has not taken the table */
    pthread_mutex_unlock(&lock);
    return by;
}

static int32_t send_nothing(void *user, int32_t rank, int64_t bytes, const void *data)
{
    (void)user, (void)rank, (void)bytes, (void)data;
    return 1;
}

static int32_t receive_nothing(void *user, int32_t rank, int64_t bytes, void *data)
{
    (void)user, (void)rank, (void)bytes, (void)data;
    return 1;
}

static int32_t flush_nothing(void *user)
{
    (void)user;
    return 1;
}

/* Where MPI cannot be called, the library gives the status and its text: it fails to send. */
static int32_t refused(void)
{
    static int nobody;
    const feti_communicator none = { .struct_size = sizeof none, .size = 2, .local_size = 1, .user = &nobody,
                                     .send = send_nothing, .flush = flush_nothing, .receive = receive_nothing };

    return feti_serve(&none);
}

int32_t feti_mpi(feti_problem *p, MPI_Comm comm)
{
    stream *const s = stream_of(comm);

    if (!s) return refused();
    const feti_communicator by = table_of(s);
    const int32_t status = feti_communicator_set(p, &by);
    if (status != FETI_OK) drop(s);
    return status;
}

int32_t feti_mpi_serve(MPI_Comm comm)
{
    stream *const s = stream_of(comm);

    if (!s) return refused();
    const feti_communicator by = table_of(s);
    const int32_t status = feti_serve(&by);
    drop(s);
    return status;
}

int32_t feti_mpi_f(feti_problem *p, int64_t comm)
{
    return barred() ? refused() : feti_mpi(p, MPI_Comm_f2c((MPI_Fint)comm));
}

int32_t feti_mpi_serve_f(int64_t comm)
{
    return barred() ? refused() : feti_mpi_serve(MPI_Comm_f2c((MPI_Fint)comm));
}
