/* log DATA: what solves tell in words makes a bug report; a function that fails ends the call, and nothing else. */
#include "handover.h"
#include "small.h"

typedef struct {
    feti_problem *problem;
    int lines, level[500], busy;
    int fail_at; /* this line, from 1; 0: none */
    char text[500][400];
} diary;

static int32_t note(void *user, int32_t level, const char *text)
{
    diary *book = user;

    CHECK(!strpbrk(text, "\n\r\033"), "a line with an end or a colour: %s", text);
    CHECK(strlen(text) > 5, "a line without words: \"%s\"", text);
    if (book->lines < 500) {
        book->level[book->lines] = level;
        snprintf(book->text[book->lines], sizeof book->text[0], "%s", text);
    }
    book->lines++;
    if (book->problem && feti_solve(book->problem, NULL) == FETI_BUSY) book->busy++;
    return book->lines == book->fail_at ? 7 : 0;
}

/* The first line that begins so, or the number of lines. */
static int line_with(const diary *book, const char *begin)
{
    for (int k = 0; k < book->lines; k++)
        if (strncmp(book->text[k], begin, strlen(begin)) == 0) return k;
    return book->lines;
}

static void levels(const case_data *data, diary *book)
{
    const form how = { .storage = FETI_LOWER };
    feti_problem *p = handed_over(data, &how);

    memset(book, 0, sizeof *book);
    OK(feti_on_log(p, note, FETI_LOG_RESULT, book));
    answer result = solved(p, data);
    CHECK(book->lines == 1 && book->level[0] == FETI_LOG_RESULT, "%d lines of results", book->lines);
    CHECK(line_with(book, "solved: ") == 0 && strstr(book->text[0], "contact rows closed; certificate equilibrium"),
          "the result is \"%s\"", book->text[0]);
    answer_free(&result);

    memset(book, 0, sizeof *book);
    OK(feti_set_text(p, "preconditioner=none"));
    OK(feti_on_log(p, note, FETI_LOG_STEP, book));
    result = solved(p, data);
    int steps = 0;
    for (int k = 0; k < book->lines; k++) steps += book->level[k] == FETI_LOG_STEP;
    CHECK(steps == result.info.steps && book->lines > steps + 4, "%d steps in %d lines", steps, book->lines);
    CHECK(line_with(book, "feti-contact 0.") == 0, "the first line is \"%s\"", book->text[0]);
    CHECK(line_with(book, "options: preconditioner=none") == 1, "the second line is \"%s\"", book->text[1]);
    CHECK(line_with(book, "method: proportioning") < line_with(book, "step 1: "), "the method is not told first");
    CHECK(line_with(book, "dual solve: ") < line_with(book, "solved: "), "the phases are not told");
    CHECK(line_with(book, "solved: ") == book->lines - 1, "the last line is \"%s\"", book->text[book->lines - 1]);
    answer_free(&result);

    OK(feti_on_log(p, NULL, FETI_LOG_STEP, NULL));
    book->lines = 0;
    result = solved(p, data);
    OK(feti_on_log(p, note, FETI_LOG_NONE, book));
    answer_free(&result);
    result = solved(p, data);
    CHECK(book->lines == 0, "%d lines after the function was taken away", book->lines);
    answer_free(&result);
    OK(feti_problem_destroy(&p));
}

static void failures(diary *book)
{
    feti_error_detail detail = { .struct_size = sizeof detail };
    feti_problem *p = small_problem();
    const double away[2] = { 0.0, 6.0 };

    memset(book, 0, sizeof *book);
    book->fail_at = 3;
    OK(feti_on_log(p, note, FETI_LOG_STEP, book));
    EXPECT(FETI_CALLBACK, feti_solve(p, NULL));
    OK(feti_last_error_detail(&detail));
    CHECK(detail.value == 7.0 && book->lines == 3, "value %g after %d lines", detail.value, book->lines);
    book->fail_at = 0;
    book->problem = p;
    check_small_answer(p, "a log function that failed");
    CHECK(book->busy > 3, "%d calls from inside were refused", book->busy);

    memset(book, 0, sizeof *book);
    OK(feti_on_log(p, note, FETI_LOG_RESULT, book));
    OK(feti_body_load(p, BLOCK, 2, away));
    EXPECT(FETI_LOAD_NOT_HELD, feti_solve(p, NULL));
    CHECK(book->lines == 1 && strncmp(book->text[0], "solve failed: body 1", 20) == 0, "told: \"%s\"", book->text[0]);
    OK(give_block_load(p));

    EXPECT(FETI_ARGUMENT - 3, feti_on_log(p, note, -1, book));
    EXPECT(FETI_ARGUMENT - 3, feti_on_log(p, note, 4, book));
    EXPECT(FETI_HANDLE, feti_on_log(NULL, note, FETI_LOG_STEP, book));
    OK(feti_setup(p));
    OK(feti_problem_destroy(&p));
}

int main(int argc, char **argv)
{
    static diary book;
    case_data data;

    if (argc < 2) return 1;
    read_or_stop(argv[1], "p1_P3", &data);
    levels(&data, &book);
    failures(&book);
    case_free(&data);
    return check_result();
}
