/* Every argument of every function, made wrong in every way, is refused with its own number; nothing is written, and the
   problem solves to the same bits as before. With all arguments right every function succeeds. */
#include "calls.h"

static void wrong_one_by_one(const function *f)
{
    double before[ANSWER], after[ANSWER];
    feti_problem *p = problem_for(f);
    const int32_t status = answer(p, before);

    for (int k = 1; k <= f->fault_count; k++) {
        const char *what = f->faults[k - 1].what;
        expect(f, p, k, f->faults[k - 1].status, what);
        const int32_t again = answer(p, after);
        CHECK(again == status && memcmp(before, after, sizeof before) == 0, "%s with %s: another answer, status %d", f->name,
              what, (int)again);
    }
    OK(feti_problem_destroy(&p));
}

static void all_right(const function *f)
{
    feti_problem *p = problem_for(f);

    expect(f, p, 0, FETI_OK, "every argument right");
    EXPECT(strcmp(f->name, "feti_problem_destroy") == 0 ? FETI_HANDLE : FETI_OK, feti_problem_destroy(&p));
}

/* The problem by hand: u(0,0) - u(0,1) = 1/4, the first row closed with 6, 2 u(0,0) = -6. */
static void by_hand(void)
{
    const double expected[ANSWER] = { -3.0, -3.25, -4.25, -5.75, 6.0, 0.0, 5.0 };
    double found[ANSWER];
    feti_problem *p = problem_for(FUNCTIONS);

    OK(answer(p, found));
    for (int k = 0; k < ANSWER; k++) CHECK(fabs(found[k] - expected[k]) <= 1e-9, "entry %d is %g, expected %g", k, found[k], expected[k]);
    OK(feti_problem_destroy(&p));
}

int main(void)
{
    by_hand();
    for (const function *f = FUNCTIONS; f < FUNCTIONS + FUNCTION_COUNT; f++) {
        all_right(f);
        wrong_one_by_one(f);
    }
    return check_result();
}
