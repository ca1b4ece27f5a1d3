/* One problem takes one call at a time, distinct problems run side by side, and the bits of the answer depend on
   neither. threads <data folder> */
#define _POSIX_C_SOURCE 200112L
#include <pthread.h>

#include "handover.h"

static const form LOWER = { .storage = FETI_LOWER };

/* One solve in a thread of its own. */
typedef struct {
    const case_data *data;
    feti_problem *problem;
    answer result;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int begun, let_go; /* 1: the solve runs; it may go on */
} job;

static void *solve_job(void *argument)
{
    job *work = argument;
    work->result.info.struct_size = sizeof work->result.info;
    work->result.info.status = feti_solve(work->problem, &work->result.info);
    return NULL;
}

/* Holds the solve at its first step until it is let go. */
static int32_t hold(void *user, const feti_progress *now)
{
    job *work = user;
    (void)now;
    pthread_mutex_lock(&work->lock);
    work->begun = 1;
    pthread_cond_broadcast(&work->changed);
    while (!work->let_go) pthread_cond_wait(&work->changed, &work->lock);
    pthread_mutex_unlock(&work->lock);
    return 0;
}

/* While a solve runs, other calls return FETI_BUSY; the error text can be read; the solve is not disturbed. */
static void second_thread_is_busy(const case_data *data, const answer *wanted)
{
    job work = { .data = data, .problem = handed_over(data, &LOWER), .lock = PTHREAD_MUTEX_INITIALIZER,
                 .changed = PTHREAD_COND_INITIALIZER };
    feti_problem *copy = work.problem;
    pthread_t thread;
    int32_t state[1];
    int64_t length;
    double number;

    OK(feti_on_progress(work.problem, hold, &work));
    CHECK(pthread_create(&thread, NULL, solve_job, &work) == 0, "no thread");
    pthread_mutex_lock(&work.lock);
    while (!work.begun) pthread_cond_wait(&work.changed, &work.lock);
    pthread_mutex_unlock(&work.lock);
    EXPECT(FETI_BUSY, feti_counts(work.problem, NULL, NULL, NULL, NULL));
    EXPECT(FETI_BUSY, feti_solve(work.problem, NULL));
    EXPECT(FETI_BUSY, feti_active(work.problem, 1, state));
    EXPECT(FETI_BUSY, feti_get_f64(work.problem, "tolerance", &number));
    EXPECT(FETI_BUSY, feti_set_i64(work.problem, "threads", 1));
    EXPECT(FETI_BUSY, feti_rows_clear(work.problem, FETI_INEQUALITY));
    EXPECT(FETI_BUSY, feti_problem_destroy(&copy));
    CHECK(copy == work.problem, "a refused destroy zeroed the handle");
    OK(feti_problem_error(work.problem, NULL, 0, &length));
    pthread_mutex_lock(&work.lock);
    work.let_go = 1;
    pthread_cond_broadcast(&work.changed);
    pthread_mutex_unlock(&work.lock);
    pthread_join(thread, NULL);
    CHECK(work.result.info.status == FETI_OK, "the disturbed solve returned %d", (int)work.result.info.status);

    work.result = solved(work.problem, data);
    CHECK(memcmp(work.result.lambda, wanted->lambda, (size_t)data->rows * sizeof(double)) == 0, "other bits after BUSY");
    answer_free(&work.result);
    OK(feti_problem_destroy(&work.problem));
}

/* The bits of an answer with the given number of threads. */
static answer answer_with(const case_data *data, int64_t threads)
{
    feti_problem *problem = handed_over(data, &LOWER);
    OK(feti_set_i64(problem, "threads", threads));
    answer result = solved(problem, data);
    OK(feti_problem_destroy(&problem));
    return result;
}

static void check_same_bits(const case_data *data, const answer *a, const answer *b, const char *what)
{
    CHECK(memcmp(a->u, b->u, (size_t)data->unknowns * sizeof(double)) == 0, "%s: other displacements", what);
    CHECK(memcmp(a->lambda, b->lambda, (size_t)data->rows * sizeof(double)) == 0, "%s: other contact forces", what);
    CHECK(memcmp(a->mu, b->mu, (size_t)data->equalities * sizeof(double)) == 0, "%s: other support forces", what);
}

static void *whole_job(void *argument)
{
    job *work = argument;
    work->result = answer_with(work->data, 2);
    return NULL;
}

static void problems_side_by_side(const case_data *data, const answer *wanted)
{
    job work[3];
    pthread_t thread[3];

    for (int k = 0; k < 3; k++) {
        work[k] = (job){ .data = data };
        CHECK(pthread_create(&thread[k], NULL, whole_job, &work[k]) == 0, "no thread");
    }
    for (int k = 0; k < 3; k++) {
        pthread_join(thread[k], NULL);
        check_same_bits(data, &work[k].result, wanted, "side by side");
        answer_free(&work[k].result);
    }
}

/* The last error belongs to the thread that made it. */
static void *no_error_here(void *argument)
{
    char text[64] = "x";
    (void)argument;
    CHECK(feti_last_error(text, sizeof text) == 0 && text[0] == '\0', "another thread's error: %s", text);
    return NULL;
}

static void errors_belong_to_their_thread(void)
{
    pthread_t thread;
    EXPECT(FETI_HANDLE, feti_setup(NULL));
    CHECK(pthread_create(&thread, NULL, no_error_here, NULL) == 0, "no thread");
    pthread_join(thread, NULL);
    CHECK(feti_last_error(NULL, 0) > 0, "the error is gone");
}

int main(int argc, char **argv)
{
    case_data blocks, stack;
    if (argc < 2) return 2;
    errors_belong_to_their_thread();

    read_or_stop(argv[1], "p3_2block", &blocks);
    answer one = answer_with(&blocks, 1), two = answer_with(&blocks, 2);
    check_forces("p3_2block", &blocks, &one);
    check_same_bits(&blocks, &one, &two, "one and two threads");
    problems_side_by_side(&blocks, &one);
    answer_free(&one);
    answer_free(&two);
    case_free(&blocks);

    read_or_stop(argv[1], "three_bodies", &stack);
    one = answer_with(&stack, 1);
    two = answer_with(&stack, 2);
    check_same_bits(&stack, &one, &two, "one and two threads");
    second_thread_is_busy(&stack, &one);
    answer_free(&one);
    answer_free(&two);
    case_free(&stack);
    return check_result();
}
