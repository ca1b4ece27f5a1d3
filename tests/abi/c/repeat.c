/* Problems that come and go leave nothing behind: neither in use nor resident. repeat <data folder> <times> */
#define _DEFAULT_SOURCE
#include <malloc.h>
#include <unistd.h>

#include "handover.h"
#include "small.h"

/* By how many bytes two equal moments may differ: the allocator's own lists of freed pieces fill up slowly. A leak of
   500 bytes in each of 200 problems is more. */
enum { IN_USE = 100000, RESIDENT = 1000000 };

static const form LOWER = { .storage = FETI_LOWER };

static int64_t resident_bytes(void)
{
    long long all, resident;
    FILE *statm = fopen("/proc/self/statm", "r");
    if (!statm || fscanf(statm, "%lld %lld", &all, &resident) != 2) exit(1);
    fclose(statm);
    return resident * sysconf(_SC_PAGESIZE);
}

static int64_t bytes_in_use(void)
{
    const struct mallinfo2 heap = mallinfo2();
    return (int64_t)(heap.uordblks + heap.hblkhd);
}

/* One problem that is solved, refused, changed and solved again. */
static void life_of_a_problem(const case_data *data, int threads)
{
    feti_problem *problem = handed_over(data, &LOWER), *other = small_problem();
    const double away[2] = { 0.0, 6.0 };

    OK(feti_set_i64(problem, "threads", threads));
    OK(feti_set_i64(other, "threads", threads));
    answer result = solved(problem, data);
    EXPECT(FETI_HANDLE, feti_setup(NULL));
    OK(feti_rows_clear(problem, FETI_INEQUALITY));
    OK(feti_body_load(other, BLOCK, 2, away));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(other, NULL));
    OK(give_block_load(other));
    check_small_answer(other, "a load that pulls away");
    answer_free(&result);
    OK(feti_problem_destroy(&problem));
    OK(feti_problem_destroy(&other));
}

/* After as many repetitions everything that is made once has been made, and the allocator's lists are full. */
static void nothing_grows(const case_data *data, int times, int threads)
{
    for (int k = 0; k < times; k++) life_of_a_problem(data, threads);
    const int64_t used = bytes_in_use(), resident = resident_bytes();
    for (int k = 0; k < times; k++) life_of_a_problem(data, threads);
    const int64_t more = bytes_in_use() - used, grown = resident_bytes() - resident;

    CHECK(more <= IN_USE, "%d threads: %lld bytes more in use after %d problems", threads, (long long)more, times);
    /* Memory checkers, with which the run is short, keep what is freed. */
    CHECK(grown <= RESIDENT || times < 100, "%d threads: %lld bytes more resident after %d problems", threads,
          (long long)grown, times);
}

int main(int argc, char **argv)
{
    case_data data;
    if (argc < 3) return 2;
    read_or_stop(argv[1], "p2_A", &data);
    nothing_grows(&data, atoi(argv[2]), 1);
    nothing_grows(&data, atoi(argv[2]), 2);
    case_free(&data);
    return check_result();
}
