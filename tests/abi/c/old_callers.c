/* Hosts compiled against an older or a newer header: a struct of every size from 16 bytes on is filled as far as it goes,
   with the same values, and the bytes behind it stay. */
#include "calls.h"

enum { BEYOND = 64, PATTERN = 0x3c };

/* Calls f with a struct of `size` bytes inside a larger one of `room` bytes, which begins with the pattern. */
static void called(const function *f, unsigned char *memory, size_t room, size_t size)
{
    const int64_t said = (int64_t)size;
    feti_problem *p = problem_for(f);

    memset(memory, PATTERN, room);
    memcpy(memory, &said, sizeof said);
    give_record(memory);
    expect(f, p, GIVEN_RECORD, FETI_OK, "a struct of another size");
    OK(feti_problem_destroy(&p));
}

static void check_fields(const function *f, const unsigned char *full, const unsigned char *found, size_t size)
{
    for (const field *x = f->fields + 1; x->name; x++)
        if (x->offset + x->size <= size && strncmp(x->name, "seconds", 7) != 0)
            CHECK(memcmp(full + x->offset, found + x->offset, x->size) == 0, "%s, %d bytes: field %s differs", f->name, (int)size,
                  x->name);
}

static void every_size(const function *f)
{
    const size_t room = f->record_size + BEYOND;
    unsigned char *full = check_array((int64_t)room, 1), *found = check_array((int64_t)room, 1);

    called(f, full, room, f->record_size);
    for (size_t size = 16; size <= room; size += 8) {
        const size_t end = size < f->record_size ? size : f->record_size;
        int64_t said;
        called(f, found, room, size);
        memcpy(&said, found, sizeof said);
        CHECK(said == (int64_t)size, "%s: struct_size became %lld", f->name, (long long)said);
        check_fields(f, full, found, end);
        for (size_t k = end; k < room; k++)
            CHECK(found[k] == PATTERN, "%s: byte %d written behind %d", f->name, (int)k, (int)end);
    }
    free(full);
    free(found);
}

int main(void)
{
    int structs = 0;
    for (const function *f = FUNCTIONS; f < FUNCTIONS + FUNCTION_COUNT; f++)
        if (f->record_size > 0) {
            every_size(f);
            structs++;
        }
    CHECK(structs >= 6, "%d functions with a struct", structs);
    return check_result();
}
