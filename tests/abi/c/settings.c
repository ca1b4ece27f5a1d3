/* What is set is what is read, of every type, and a refused value changes nothing; the version that runs is the header's. */
#include "small.h"

static void numbers(feti_problem *p)
{
    double gamma = 0.0;
    int64_t threads = -1;

    OK(feti_get_f64(p, "gamma", &gamma));
    CHECK(gamma == 1.0, "gamma is %g by default", gamma);
    OK(feti_set_f64(p, "gamma", 2.5));
    EXPECT(FETI_ARGUMENT - 3, feti_set_f64(p, "gamma", -1.0));
    OK(feti_get_f64(p, "gamma", &gamma));
    CHECK(gamma == 2.5, "gamma is %g", gamma);
    OK(feti_set_i64(p, "steps", 2));
    EXPECT(FETI_ARGUMENT - 3, feti_set_i64(p, "steps", -1));
    OK(feti_set_i64(p, "threads", 3));
    EXPECT(FETI_ARGUMENT - 3, feti_set_i64(p, "threads", -1));
    OK(feti_get_i64(p, "threads", &threads));
    CHECK(threads == 3, "%lld threads", (long long)threads);
}

static void words(feti_problem *p)
{
    char room[16];
    int64_t length = 0;

    OK(feti_set_str(p, "start", "previous"));
    EXPECT(FETI_ARGUMENT - 3, feti_set_str(p, "start", "warm"));
    OK(feti_get_str(p, "start", NULL, 0, &length));
    CHECK(length == 8, "length %lld", (long long)length);
    OK(feti_get_str(p, "start", room, sizeof room, &length));
    CHECK(strcmp(room, "previous") == 0 && length == 8, "start is '%s'", room);
    OK(feti_get_str(p, "start", room, 5, &length));
    CHECK(strcmp(room, "prev") == 0 && length == 8, "cut to '%s'", room);
}

/* The log of a solve in a file; a path that cannot be opened is refused and changes nothing. */
static void log_file(feti_problem *p)
{
    const char *path = "settings log.txt";
    char line[256] = "", room[32];
    int64_t length = 0;
    FILE *file;

    remove(path);
    OK(feti_set_str(p, "log_file", path));
    OK(feti_set_text(p, "log_level=result"));
    EXPECT(FETI_ARGUMENT - 3, feti_set_str(p, "log_file", "/no such folder/log"));
    EXPECT(FETI_ARGUMENT - 2, feti_set_text(p, "log_level=step log_file=/no_such_folder/log"));
    OK(feti_get_str(p, "log_file", room, sizeof room, &length));
    CHECK(strcmp(room, path) == 0 && length == 16, "log_file is '%s'", room);
    OK(feti_solve(p, NULL));
    file = fopen(path, "r");
    CHECK(file && fgets(line, sizeof line, file) && strncmp(line, "solved: ", 8) == 0, "the first line is '%s'", line);
    if (file) fclose(file);
    OK(feti_set_str(p, "log_file", ""));
    remove(path);
}

static void version(void)
{
    char expected[32];
    const int32_t number = 10000 * FETI_CONTACT_VERSION_MAJOR + 100 * FETI_CONTACT_VERSION_MINOR + FETI_CONTACT_VERSION_PATCH;

    snprintf(expected, sizeof expected, "%d.%d.%d", FETI_CONTACT_VERSION_MAJOR, FETI_CONTACT_VERSION_MINOR,
             FETI_CONTACT_VERSION_PATCH);
    CHECK(strcmp(feti_version(), expected) == 0, "version %s, header %s", feti_version(), expected);
    CHECK(feti_version_number() == number, "version %d, header %d", (int)feti_version_number(), (int)number);
}

int main(void)
{
    feti_problem *p = small_problem();
    numbers(p);
    words(p);
    log_file(p);
    version();
    check_small_answer(p, "settings");
    OK(feti_problem_destroy(&p));
    return check_result();
}
