// The header compiles as C++11 without a warning, and its functions have C linkage: the library resolves them.
#include "feti_contact.h"

#include <cstdio>
#include <cstring>
#include <type_traits>

static_assert(std::is_standard_layout<feti_info>::value && std::is_trivial<feti_info>::value, "feti_info is plain data");
static_assert(std::is_same<decltype(&feti_body_add), int32_t (*)(feti_problem *, int64_t, int64_t *)>::value,
              "feti_body_add(problem, n, body)");

int main()
{
    int32_t (*const create)(feti_problem **) = feti_problem_create;
    int32_t (*const destroy)(feti_problem **) = feti_problem_destroy;
    feti_problem *problem = nullptr;

    if (create(&problem) != FETI_OK || problem == nullptr) {
        std::fprintf(stderr, "create failed\n");
        return 1;
    }
    if (destroy(&problem) != FETI_OK || problem != nullptr) {
        std::fprintf(stderr, "destroy failed\n");
        return 1;
    }
    return std::strcmp(feti_status_name(FETI_HANDLE), "FETI_HANDLE") == 0 ? 0 : 1;
}
