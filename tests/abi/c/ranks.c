/* Two ranks as threads of one process: messages run through pipes. A problem that lends is solved as ever, the other rank serves until
   rank 0 ends it, the functions run on the calling thread in the floating-point environment of the host. */
#include <fenv.h>
#include <pthread.h>
#include <unistd.h>

#include "check.h"

typedef struct {
    int from, to; /* ends of pipes */
    pthread_t thread;
    int sent, flushed, received, released;
    int fails; /* the next sending fails */
} end;

static void check_called(const end *e)
{
    CHECK(pthread_equal(e->thread, pthread_self()), "a function is called on another thread");
    CHECK(fegetround() == FE_UPWARD, "a function is called in another environment");
}

static int32_t send_bytes(void *user, int32_t rank, int64_t bytes, const void *data)
{
    end *e = user;

    check_called(e);
    CHECK(rank == 0 || rank == 1, "rank %d", (int)rank);
    e->sent++;
    return e->fails || write(e->to, data, (size_t)bytes) != bytes;
}

static int32_t flush(void *user)
{
    end *e = user;

    check_called(e);
    e->flushed++;
    return 0;
}

static int32_t receive_bytes(void *user, int32_t rank, int64_t bytes, void *data)
{
    end *e = user;

    check_called(e);
    CHECK(rank == 0 || rank == 1, "rank %d", (int)rank);
    for (int64_t have = 0; have < bytes;) {
        const ssize_t more = read(e->from, (char *)data + have, (size_t)(bytes - have));
        if (more <= 0) return 1;
        have += more;
    }
    e->received++;
    return 0;
}

static void release(void *user)
{
    end *e = user;

    check_called(e);
    e->released++;
}

static feti_communicator table(end *e, int32_t rank)
{
    feti_communicator by = { .struct_size = sizeof by, .rank = rank, .size = 2, .local_size = 2, .user = e, .send = send_bytes,
                             .flush = flush, .receive = receive_bytes, .release = release };
    return by;
}

static void *serves(void *user)
{
    end *e = user;
    const feti_communicator by = table(e, 1);

    e->thread = pthread_self();
    fesetround(FE_UPWARD);
    OK(feti_serve(&by));
    CHECK(fegetround() == FE_UPWARD, "feti_serve leaves another environment");
    return NULL;
}

/* A point on a spring of 2, pulled by 3, before a wall at 1. */
static void solve(feti_problem *p)
{
    static const int32_t ptr[2] = { 0, 1 }, body[1] = { 0 }, dof[1] = { 0 };
    static const double k[1] = { 2.0 }, f[1] = { 3.0 }, one[1] = { 1.0 }, gap[1] = { 1.0 };
    feti_info info = { .struct_size = sizeof info };
    double u = 0.0, lambda = 0.0;
    int64_t number;

    OK(feti_body_add(p, 1, &number));
    OK(feti_body_stiffness_dense(p, number, 1, k, 1, FETI_FULL, FETI_COPY));
    OK(feti_body_load(p, number, 1, f));
    OK(feti_rows_add_i32(p, FETI_INEQUALITY, 1, ptr, body, dof, one, 0, gap, NULL));
    OK(feti_solve(p, &info));
    OK(feti_displacement(p, number, 1, &u));
    OK(feti_multipliers(p, FETI_INEQUALITY, 1, &lambda));
    CHECK(fabs(u - 1.0) < 1e-9 && fabs(lambda - 1.0) < 1e-9, "u %g, force %g", u, lambda);
    CHECK(info.ranks == 2 && info.messages >= 0 && info.message_bytes >= 0 && info.seconds_waited >= 0.0 && info.seconds_leading > 0.0, "%d ranks, %d messages",
          (int)info.ranks, (int)info.messages);
}

int main(void)
{
    int down[2], up[2];
    pthread_t other;
    feti_problem *p = NULL, *late = NULL;

    if (pipe(down) != 0 || pipe(up) != 0) return 2;
    end here = { .from = up[0], .to = down[1], .thread = pthread_self() }, there = { .from = down[0], .to = up[1] };
    const feti_communicator by = table(&here, 0);
    feti_communicator wrong = table(&there, 1);

    fesetround(FE_UPWARD);
    if (pthread_create(&other, NULL, serves, &there) != 0) return 2;
    MUST(feti_problem_create(&p));
    OK(feti_communicator_set(p, &by));
    EXPECT(FETI_STATE, feti_communicator_set(p, &by));
    solve(p);
    OK(feti_serve(&by));
    pthread_join(other, NULL);
    CHECK(here.sent > 0 && here.flushed > 0 && here.received > 0 && there.sent > 0, "no message");
    CHECK(here.released == 0, "released before the problem is destroyed");
    OK(feti_problem_destroy(&p));
    CHECK(here.released == 1 && there.released == 0, "released %d times", here.released);

    OK(feti_problem_create(&late));
    wrong.size = 0;
    EXPECT(FETI_ARGUMENT - 2, feti_communicator_set(late, &wrong));
    here.fails = 1;
    EXPECT(FETI_COMMUNICATION, feti_serve(&by));
    OK(feti_problem_destroy(&late));
    CHECK(here.released == 1 && there.released == 0, "a table that was not taken is released");
    return check_result();
}
