/* Implicit and explicit dual operators give the same forces; info tells how many there are and what they take, also to a
   host compiled with a shorter struct; every phase has its name, time and bytes. phases <data folder> */
#include <stddef.h>

#include "handover.h"
#include "small.h"

static const form LOWER = { .storage = FETI_LOWER };

/* Figures of feti_info end here in binaries of the first header. */
enum { SHORT = offsetof(feti_info, explicit_operators) };

static feti_phase phase_at(feti_problem *problem, int64_t k)
{
    feti_phase phase = { .struct_size = sizeof phase };

    OK(feti_phase_at(problem, k, &phase));
    return phase;
}

static double seconds_of_all(feti_problem *problem)
{
    int64_t count = 0;
    double sum = 0.0;

    OK(feti_phase_count(problem, &count));
    for (int64_t k = 0; k < count; k++) sum += phase_at(problem, k).seconds;
    return sum;
}

/* Names in their order; times sum up to the call's; a second solve makes nothing of the setup again. */
static void phases_are_told(const case_data *data)
{
    static const char *const names[] = { "rows", "null spaces", "analysis", "factorisation", "dual operators",
                                         "preconditioner", "dual solve", "recovery" };
    enum { PHASES = sizeof names / sizeof names[0], SETUP = 6 };
    feti_problem *problem = handed_over(data, &LOWER);
    feti_phase old = { .struct_size = 16 };
    int64_t count = 0;

    OK(feti_phase_count(problem, &count));
    CHECK(count == PHASES, "%lld phases", (long long)count);
    CHECK(seconds_of_all(problem) == 0.0, "time before the first call");
    answer result = solved(problem, data);
    const double sum = seconds_of_all(problem), call = result.info.seconds_setup + result.info.seconds_solve;
    CHECK(sum <= 1.001 * call && sum >= 0.5 * call, "phases take %g s of %g s", sum, call);
    for (int64_t k = 0; k < count; k++) {
        const feti_phase phase = phase_at(problem, k);
        CHECK(strcmp(phase.name, names[k]) == 0, "phase %lld is %s", (long long)k, phase.name);
        CHECK(phase.seconds > 0.0, "%s took no time", phase.name);
    }
    CHECK(phase_at(problem, 3).bytes == result.info.factor_bytes && result.info.factor_bytes > 0, "bytes of the factors");
    CHECK(phase_at(problem, 4).bytes == result.info.operator_bytes && result.info.operator_bytes > 0, "bytes of F");
    OK(feti_phase_at(problem, 4, &old));
    CHECK(old.struct_size == 16 && old.bytes == result.info.operator_bytes && old.name == NULL, "more than 16 bytes written");
    OK(feti_solve(problem, NULL));
    for (int64_t k = 0; k < SETUP; k++) CHECK(phase_at(problem, k).seconds == 0.0, "%s was done again", names[k]);
    EXPECT(FETI_ARGUMENT - 2, feti_phase_at(problem, PHASES, &old));
    EXPECT(FETI_ARGUMENT - 2, feti_phase_at(problem, -1, &old));
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
}

static void implicit_operators_give_the_same_forces(const case_data *data)
{
    feti_problem *problem = handed_over(data, &LOWER);
    double largest = 0.0;

    OK(feti_set_str(problem, "dual_operator", "explicit"));
    answer wanted = solved(problem, data);
    CHECK(wanted.info.explicit_operators == data->bodies && wanted.info.implicit_operators == 0, "explicit operators");
    EXPECT(FETI_ARGUMENT - 3, feti_set_str(problem, "dual_operator", "dense"));
    OK(feti_set_str(problem, "dual_operator", "implicit"));
    answer found = solved(problem, data);
    CHECK(found.info.explicit_operators == 0 && found.info.implicit_operators == data->bodies, "implicit operators");
    CHECK(found.info.operator_bytes == 0 && found.info.factorisations == data->bodies, "another factorisation");
    for (int64_t i = 0; i < data->rows; i++) largest = fmax(largest, fabs(wanted.lambda[i]));
    for (int64_t i = 0; i < data->rows; i++)
        CHECK(fabs(found.lambda[i] - wanted.lambda[i]) <= 1e-9 * largest, "force %lld is %g, not %g", (long long)i,
              found.lambda[i], wanted.lambda[i]);
    answer_free(&found);
    answer_free(&wanted);
    OK(feti_problem_destroy(&problem));
}

/* Nothing is written behind the struct of a host that knows fewer figures. */
static void a_shorter_info_is_respected(void)
{
    feti_problem *problem = small_problem();
    feti_info info;

    memset(&info, 0x5a, sizeof info);
    info.struct_size = SHORT;
    OK(feti_solve(problem, &info));
    CHECK(info.bodies == 2 && info.finished == 0, "the figures it knows are not written");
    CHECK(info.explicit_operators == 0x5a5a5a5a5a5a5a5a && info.operator_bytes == 0x5a5a5a5a5a5a5a5a, "written behind its end");
    OK(feti_problem_destroy(&problem));
}

int main(int argc, char **argv)
{
    case_data data;

    if (argc < 2) return 2;
    read_or_stop(argv[1], "three_bodies", &data);
    phases_are_told(&data);
    implicit_operators_give_the_same_forces(&data);
    a_shorter_info_is_respected();
    case_free(&data);
    return check_result();
}
