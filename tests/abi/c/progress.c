/* A progress function hears of every body in every part of the setup and of every step, in the host's floating-point environment; it and
   feti_cancel from any thread end a call; what was cancelled can be solved again. progress <data folder> */
#define _POSIX_C_SOURCE 200112L
#include <fenv.h>
#include <pthread.h>
#include <xmmintrin.h>

#include "handover.h"
#include "small.h"

static const form LOWER = { .storage = FETI_LOWER };

enum { MOST = 2000 };

/* What the function hears, and what it does at call number `when` (from 0) or at step `step` of the solve. */
typedef struct {
    feti_problem *problem;
    int calls, when, step, reply, cancels;
    unsigned rounding; /* direction that the function must see in MXCSR, 0: not looked at */
    feti_progress heard[MOST];
} listener;

static int32_t hear(void *user, const feti_progress *now)
{
    listener *host = user;
    const int call = host->calls++;

    if (call < MOST) host->heard[call] = *now;
    if (host->rounding) CHECK(_MM_GET_ROUNDING_MODE() == host->rounding, "call %d in another environment", call);
    if (call != host->when && (now->phase != FETI_PHASE_SOLVE || now->steps != host->step)) return 0;
    if (host->cancels) OK(feti_cancel(host->problem));
    return host->reply;
}

static listener *listener_of(feti_problem *problem, int when, int reply)
{
    listener *host = check_array(1, sizeof *host);
    *host = (listener){ .problem = problem, .when = when, .reply = reply };
    OK(feti_on_progress(problem, hear, host));
    return host;
}

static void check_bits(const case_data *data, const answer *found, const answer *wanted, const char *after)
{
    CHECK(memcmp(found->u, wanted->u, (size_t)data->unknowns * sizeof(double)) == 0, "%s: other displacements", after);
    CHECK(memcmp(found->lambda, wanted->lambda, (size_t)data->rows * sizeof(double)) == 0, "%s: other forces", after);
}

/* Parts of the setup that are done body by body: null spaces, analysis, factors, dual operators. */
enum { PARTS = 4 };

/* Calls during the setup: every body in every part, and the preconditioner that the option `automatic` takes for this
   case; more where half a second passes between two. The fraction never falls and ends at 1. */
static int calls_of_setup(const listener *host, const case_data *data)
{
    int calls = 0, larger = 0;
    double before = 0.0;

    for (; calls < host->calls && calls < MOST && host->heard[calls].phase == FETI_PHASE_SETUP; calls++) {
        const feti_progress *now = &host->heard[calls];
        CHECK(now->step == 0 && now->steps == 0, "call %d: step %d", calls, (int)now->step);
        CHECK(isnan(now->residual) && isnan(now->theta), "figures in the setup");
        CHECK(now->fraction >= before && now->fraction <= 1.0, "fraction %g after %g", now->fraction, before);
        larger += now->fraction > before;
        before = now->fraction;
    }
    CHECK(larger == PARTS * data->bodies + 1, "%d advances of the setup", larger);
    CHECK(before == 1.0, "the setup ends at %g", before);
    return calls;
}

/* The parts of the setup, then one call a step; counts as in info; the dual functional falls. */
static void every_step_is_told(const case_data *data, const answer *wanted)
{
    feti_problem *problem = handed_over(data, &LOWER);
    listener *host = listener_of(problem, -1, 0);
    int64_t kinds[4] = { 0 };

    host->rounding = _MM_ROUND_UP;
    fesetround(FE_UPWARD);
    answer result = solved(problem, data);
    const unsigned rounding = _MM_GET_ROUNDING_MODE();
    fesetround(FE_TONEAREST);
    check_bits(data, &result, wanted, "watched");
    CHECK(rounding == _MM_ROUND_UP, "the environment of the host is gone");
    const int parts = calls_of_setup(host, data);
    CHECK(host->calls == parts + (int)result.info.steps, "%d calls for %lld steps", host->calls, (long long)result.info.steps);
    for (int k = 0; k < host->calls && k < MOST; k++) {
        const feti_progress *now = &host->heard[k], *before = &host->heard[k > 0 ? k - 1 : 0];
        CHECK(now->struct_size == (int64_t)sizeof *now, "struct_size is %lld", (long long)now->struct_size);
        CHECK(now->seconds >= before->seconds, "call %d: the clock ran back", k);
        if (k < parts) continue;
        CHECK(now->phase == FETI_PHASE_SOLVE && now->steps == k + 1 - parts, "call %d: step %lld", k, (long long)now->steps);
        CHECK(isnan(now->fraction), "a fraction in the solve");
        CHECK(now->step >= 1 && now->step <= 3, "a step of kind %d", (int)now->step);
        kinds[now->step >= 1 && now->step <= 3 ? now->step : 0]++;
        CHECK(now->products > before->products, "step %d without a product", k);
        CHECK(now->active >= 0 && now->active <= data->rows, "%lld rows with a force", (long long)now->active);
        CHECK(fabs(hypot(now->residual_free, now->residual_chopped) - now->residual) <= 1e-12 * now->residual,
              "parts of the residual");
        if (k > parts)
            CHECK(now->theta <= before->theta + 1e-12 * fabs(before->theta), "theta rose from %.17g to %.17g",
                  before->theta, now->theta);
    }
    CHECK(kinds[FETI_STEP_CONJUGATE_GRADIENT] == result.info.cg_steps, "%lld steps of conjugate gradients",
          (long long)kinds[FETI_STEP_CONJUGATE_GRADIENT]);
    CHECK(kinds[FETI_STEP_EXPANSION] == result.info.expansions && kinds[FETI_STEP_RELEASE] == result.info.releases,
          "kinds of steps differ from info");
    free(host);
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
}

/* A number > 0 at step k, or feti_cancel inside: no further product, results of that step; the next solve is as ever. */
static void the_function_cancels(const case_data *data, const answer *wanted, int cancels)
{
    feti_problem *problem = handed_over(data, &LOWER);
    listener *host = listener_of(problem, -1, cancels ? 0 : 17);
    feti_info info = { .struct_size = sizeof info };
    double *u = check_array(data->unknowns, sizeof(double));

    host->cancels = cancels;
    host->step = 3;
    EXPECT(FETI_CANCELLED, feti_solve(problem, &info));
    const feti_progress *last = &host->heard[host->calls - 1];
    CHECK(last->steps == 3 && info.steps == 3, "%lld steps, %lld told", (long long)info.steps, (long long)last->steps);
    CHECK(info.dual_applications == last->products, "%lld products, %lld when cancelled",
          (long long)info.dual_applications, (long long)last->products);
    CHECK(info.status == FETI_CANCELLED && info.worst > 0.0, "info is not written");
    OK(feti_displacement(problem, 0, data->body[0].n, u));

    OK(feti_on_progress(problem, NULL, NULL));
    answer result = solved(problem, data);
    check_bits(data, &result, wanted, "after a cancelled solve");
    free(u);
    free(host);
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
}

/* Cancelled in the setup there are no results; what was factorised is not factorised again. */
static void the_setup_is_cancelled(const case_data *data, const answer *wanted)
{
    feti_problem *problem = handed_over(data, &LOWER);
    listener *host = listener_of(problem, 0, 1);
    double *u = check_array(data->unknowns, sizeof(double));

    EXPECT(FETI_CANCELLED, feti_setup(problem));
    EXPECT(FETI_STATE, feti_displacement(problem, 0, data->body[0].n, u));
    for (int when = 1; when <= PARTS * (int)data->bodies; when++) {
        host->calls = 0;
        host->when = when;
        const int32_t status = feti_setup(problem);
        CHECK(status == (host->calls > when ? FETI_CANCELLED : FETI_OK), "status %d after %d calls", (int)status, host->calls);
    }
    host->when = -1;
    answer result = solved(problem, data);
    check_bits(data, &result, wanted, "after a cancelled setup");
    CHECK(result.info.factorisations == data->bodies, "%lld factorisations of %lld bodies",
          (long long)result.info.factorisations, (long long)data->bodies);
    free(u);
    free(host);
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
}

/* A number < 0 is the host's own failure: named, without results. */
static void the_function_fails(const case_data *data, const answer *wanted)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    double *u = check_array(data->unknowns, sizeof(double));

    for (int when = 0; when < 5; when += 2) {
        feti_problem *problem = handed_over(data, &LOWER);
        listener *host = listener_of(problem, when, -7);
        EXPECT(FETI_CALLBACK, feti_solve(problem, NULL));
        OK(feti_last_error_detail(&detail));
        CHECK(host->calls == when + 1, "%d calls", host->calls);
        CHECK(detail.status == FETI_CALLBACK && detail.value == -7.0, "status %d, value %g", (int)detail.status, detail.value);
        CHECK(strcmp(detail.function, "feti_solve") == 0, "%s failed", detail.function);
        EXPECT(FETI_STATE, feti_displacement(problem, 0, data->body[0].n, u));
        OK(feti_on_progress(problem, NULL, NULL));
        answer result = solved(problem, data);
        check_bits(data, &result, wanted, "after a failure of the host's function");
        answer_free(&result);
        free(host);
        OK(feti_problem_destroy(&problem));
    }
    free(u);
}

/* Inside the function the problem is busy, other problems are not. */
static int32_t use_problems(void *user, const feti_progress *now)
{
    feti_problem *problem = user, *copy = user, *other = small_problem();
    int64_t bodies, length;

    (void)now;
    EXPECT(FETI_BUSY, feti_solve(problem, NULL));
    EXPECT(FETI_BUSY, feti_counts(problem, &bodies, NULL, NULL, NULL));
    EXPECT(FETI_BUSY, feti_on_progress(problem, NULL, NULL));
    EXPECT(FETI_BUSY, feti_problem_destroy(&copy));
    OK(feti_problem_error(problem, NULL, 0, &length));
    check_small_answer(other, "a step of another problem");
    OK(feti_problem_destroy(&other));
    return 0;
}

static void calls_from_inside_are_refused(void)
{
    feti_problem *problem = small_problem();

    OK(feti_on_progress(problem, use_problems, problem));
    check_small_answer(problem, "calls from inside");
    OK(feti_problem_destroy(&problem));
}

/* A thread that cancels when it is told to, and the function that tells it and waits until it has. */
typedef struct {
    feti_problem *problem;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int wanted, done;
    int64_t products;
} remote;

static void *cancel_when_wanted(void *user)
{
    remote *other = user;

    pthread_mutex_lock(&other->lock);
    while (!other->wanted) pthread_cond_wait(&other->changed, &other->lock);
    OK(feti_cancel(other->problem));
    other->done = 1;
    pthread_cond_broadcast(&other->changed);
    pthread_mutex_unlock(&other->lock);
    return NULL;
}

static int32_t want_cancel(void *user, const feti_progress *now)
{
    remote *other = user;

    if (now->steps < 2) return 0;
    pthread_mutex_lock(&other->lock);
    other->wanted = 1;
    other->products = now->products;
    pthread_cond_broadcast(&other->changed);
    while (!other->done) pthread_cond_wait(&other->changed, &other->lock);
    pthread_mutex_unlock(&other->lock);
    return 0;
}

static void another_thread_cancels(const case_data *data, const answer *wanted)
{
    remote other = { .problem = handed_over(data, &LOWER), .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER };
    feti_info info = { .struct_size = sizeof info };
    pthread_t thread;

    OK(feti_on_progress(other.problem, want_cancel, &other));
    CHECK(pthread_create(&thread, NULL, cancel_when_wanted, &other) == 0, "no thread");
    EXPECT(FETI_CANCELLED, feti_solve(other.problem, &info));
    pthread_join(thread, NULL);
    CHECK(info.dual_applications == other.products, "%lld products after the cancel",
          (long long)(info.dual_applications - other.products));
    OK(feti_on_progress(other.problem, NULL, NULL));

    /* Without a running call it does nothing. */
    OK(feti_cancel(other.problem));
    answer result = solved(other.problem, data);
    check_bits(data, &result, wanted, "after a cancel between two calls");
    answer_free(&result);
    OK(feti_problem_destroy(&other.problem));
    EXPECT(FETI_HANDLE, feti_cancel(other.problem));
}

/* Without time nothing is begun, and there is no answer; with time again it is that of any other solve. */
static void no_time_is_no_answer(const case_data *data, const answer *wanted)
{
    feti_problem *problem = handed_over(data, &LOWER);
    feti_info info = { .struct_size = sizeof info };
    double *lambda = check_array(data->rows, sizeof(double));

    OK(feti_set_f64(problem, "time_limit", 0.0));
    EXPECT(FETI_TIME, feti_solve(problem, &info));
    EXPECT(FETI_STATE, feti_multipliers(problem, FETI_INEQUALITY, data->rows, lambda));
    free(lambda);
    OK(feti_set_f64(problem, "time_limit", 1e300));
    answer result = solved(problem, data);
    check_bits(data, &result, wanted, "after a solve without time");
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
}

int main(int argc, char **argv)
{
    case_data data;

    if (argc < 2) return 2;
    read_or_stop(argv[1], "three_bodies", &data);
    feti_problem *problem = handed_over(&data, &LOWER);
    answer wanted = solved(problem, &data);
    CHECK(wanted.info.steps > 4, "%lld steps are too few for this driver", (long long)wanted.info.steps);
    OK(feti_problem_destroy(&problem));

    every_step_is_told(&data, &wanted);
    the_function_cancels(&data, &wanted, 0);
    the_function_cancels(&data, &wanted, 1);
    the_setup_is_cancelled(&data, &wanted);
    the_function_fails(&data, &wanted);
    calls_from_inside_are_refused();
    another_thread_cancels(&data, &wanted);
    no_time_is_no_answer(&data, &wanted);
    answer_free(&wanted);
    case_free(&data);
    return check_result();
}
