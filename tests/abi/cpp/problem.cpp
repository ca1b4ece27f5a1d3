// problem.cpp CLAIM: the claims of tests/abi/cpp.cmake on feti_contact.hpp. The problem is the spring at a wall of README.md.
#include <feti_contact.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>

#include "check.h"

namespace {
const double k = 1000, s = 4000, c = 0.5, force = 100;
const double answer[] = {-force / k, -force / k - c, -force / k - c - force / s};

template <class I> feti::Problem spring_at_wall(double push = -force)
{
    const I ptr1[] = {0, 1};
    const std::vector<I> ptr2{0, 1, 3}, col2{0, 0, 1};
    const std::array<I, 2> row{0, 2};
    const feti::Array<const I> row_ptr{row.data(), row.size()};
    feti::Problem p;
    p.set("tolerance", 1e-10);
    const auto spring = p.body_add(1), block = p.body_add(2);
    p.body_stiffness(spring, ptr1, {0}, {&k, 1}, 0, FETI_LOWER);
    p.body_stiffness(block, ptr2, col2, {s, -s, s}, 0, FETI_LOWER);
    p.call(feti_body_no_null_space, spring);
    p.call(feti_body_null_space, block, 1, 2, std::vector<double>{1, 1}, 2, FETI_EXACT);
    p.body_load(block, {0, push});
    p.rows_add(FETI_INEQUALITY, row_ptr, {0, 1}, {0, 0}, {1, -1}, 0, {c});
    return p;
}

void right(const feti::Problem &p)
{
    const auto u = p.displacement(FETI_ALL), forces = p.multipliers(FETI_INEQUALITY);
    CHECK(u.size() == 3 && check_distance(3, u.data(), answer) < 1e-12, "u %g %g %g", u[0], u[1], u[2]);
    CHECK(forces.size() == 1 && std::fabs(forces[0] - force) < 1e-9, "force %g", forces[0]);
}

// The error that the action ends with.
feti::Error refused(const std::function<void()> &action, feti::Status status)
{
    try {
        action();
    } catch (const feti::Error &error) {
        CHECK(error.status() == status, "status %d (%s), expected %d", int(error.status()), error.what(), int(status));
        CHECK(error.detail.status == status, "status of the detail %d", int(error.detail.status));
        return error;
    }
    CHECK(false, "nothing was thrown, expected %d", int(status));
    return feti::Error("", FETI_OK);
}

template <class I> void numbers()
{
    feti::Problem p = spring_at_wall<I>();
    const auto info = p.solve();
    CHECK(info.status == FETI_OK && info.bodies == 2 && info.worst <= 1, "worst %g", info.worst);
    right(p);
    CHECK(p.active() == std::vector<feti::Status>{FETI_ROW_CLOSED}, "state of the row");
    CHECK(std::fabs(p.gaps().at(0)) < 1e-12, "gap");
    CHECK(std::fabs(p.reaction(0, 0).at(0) + force) < 1e-9, "reaction on the spring");
    CHECK(check_distance(2, p.displacement(1).data(), answer + 1) < 1e-12, "displacement of body 1");
    CHECK(p.multipliers(FETI_EQUALITY).empty(), "no equality rows");
    CHECK(p.facts<feti_body_facts>(feti_body_info, 1).null_space == 1, "null space");
    CHECK(p.read<double>(1, feti_amplitudes, 1).size() == 1, "amplitude");
}

void spring()
{
    numbers<std::int32_t>();
    numbers<std::int64_t>();
}

void errors()
{
    feti::Problem p;
    const auto body = p.body_add(2);
    const std::vector<int> ptr{0, 1, 3}, row_ptr{0, 2};
    const auto column = refused([&] { p.body_stiffness(body, ptr, {0, 0, 2}, {s, -s, s}, 0, FETI_LOWER); }, FETI_ARGUMENT - 5);
    CHECK(std::string(column.name()) == "FETI_ARGUMENT", "name %s", column.name());
    CHECK(column.detail.body == 0 && column.detail.row == 1 && column.detail.entry == 2 && column.detail.value == 2, "place");
    CHECK(std::string(column.what()) ==
          "feti_body_stiffness_i32: body 0, row 1, entry 2: column 2 is outside the 2 unknowns of the body", "text %s", column.what());

    // What the library cannot see: arrays that are shorter than row_ptr says.
    const auto few = refused([&] { p.body_stiffness(body, ptr, {0, 0}, {s, -s, s}, 0, FETI_LOWER); }, FETI_ARGUMENT - 5);
    CHECK(std::string(few.what()) == "feti_body_stiffness: argument 5 has 2 entries, not 3" && few.detail.argument == 5, "%s", few.what());
    CHECK(few.detail.body == -1 && few.detail.value == 2 && few.detail.limit == 3, "place, value and limit");
    refused([&] { p.body_stiffness(body, ptr, {0, 0, 1}, {}, 0, FETI_LOWER); }, FETI_ARGUMENT - 6);
    refused([&] { p.rows_add(FETI_INEQUALITY, row_ptr, {0}, {0, 1}, {1, -1}, 0); }, FETI_ARGUMENT - 5);
    refused([&] { p.rows_add(FETI_INEQUALITY, row_ptr, {0, 0}, {0, 1}, {1, -1}, 0, {c, c}); }, FETI_ARGUMENT - 9);
    refused([&] { p.body_stiffness(body, std::vector<int>{}, {}, {}, 0, FETI_LOWER); }, FETI_ARGUMENT - 3);
    refused([&] { p.set("no_such_option", 1); }, FETI_ARGUMENT - 2);
    refused([&] { feti::check(feti_solve(p.get(), nullptr)); }, FETI_STATE);

    auto pulled = spring_at_wall<int>(force);
    CHECK(refused([&] { pulled.solve(); }, FETI_LOAD_NOT_HELD).detail.body == 1, "the body that escapes");
    CHECK(pulled.facts<feti_findings>(feti_diagnosis).body == 1, "the body that the diagnosis names");
    pulled.body_load(1, {0, -force});
    pulled.solve();
    right(pulled);

    auto cancelled = spring_at_wall<int>();
    cancelled.on_progress([](const feti_progress *) { return 1; });
    CHECK(cancelled.solve().status == FETI_CANCELLED, "a status above 0 is returned");
    CHECK(feti::check(FETI_TIME) == FETI_TIME && feti::check(FETI_OK) == FETI_OK, "statuses from 0 on");
}

void lives()
{
    static_assert(!std::is_copy_constructible_v<feti::Problem> && !std::is_copy_assignable_v<feti::Problem>);
    static_assert(std::is_nothrow_move_constructible_v<feti::Problem> && std::is_nothrow_move_assignable_v<feti::Problem>);
    auto first = spring_at_wall<int>();
    int steps = 0;
    first.on_progress([&steps](const feti_progress *) { return steps++, 0; });
    feti_problem *const handle = first.get();
    feti::Problem second(std::move(first));
    CHECK(second.get() == handle && first.get() == nullptr, "the handle moves");
    second.solve(); // its functions have moved along
    CHECK(steps > 0, "the function of a moved problem is called");
    right(second);
    refused([&] { first.body_add(1); }, FETI_HANDLE);
    refused([&] { first.on_progress([](const feti_progress *) { return 0; }); }, FETI_HANDLE);
    first = spring_at_wall<int>();
    first.solve();
    right(first);

    feti_problem *const old = first.get();
    first = std::move(second);
    CHECK(first.get() == handle && feti_setup(old) == FETI_HANDLE, "assignment destroys what was there");
    auto &same = first;
    first = std::move(same);
    right(first);
    { const feti::Problem gone(std::move(first)); }
    CHECK(feti_setup(handle) == FETI_HANDLE, "the destructor destroys");
}

struct Thrown { int number; };

// The block by functions of the host: K+ has its second unknown held.
void block_by_functions(feti::Problem &p, feti::Status concurrent, const std::function<void()> &first)
{
    const auto kplus = [first](feti::Int, feti::Int, feti::Int columns, const double *x, feti::Int ldx, double *y, feti::Int ldy) {
        first();
        for (feti::Int j = 0; j < columns; j++) y[j * ldy] = x[j * ldx] / s;
        return 0;
    };
    const auto product = [](feti::Int, feti::Int, feti::Int columns, const double *x, feti::Int ldx, double *y, feti::Int ldy) {
        for (feti::Int j = 0; j < columns; j++) y[j * ldy] = s * (x[j * ldx] - x[j * ldx + 1]), y[j * ldy + 1] = -y[j * ldy];
        return 0;
    };
    p.body_operator(1, {s, s}, kplus, product, concurrent);
}

template <class Action> void throws(int number, Action action)
{
    try {
        action();
        CHECK(false, "nothing was thrown, expected %d", number);
    } catch (const Thrown &thrown) {
        CHECK(thrown.number == number, "%d arrived, expected %d", thrown.number, number);
    }
}

void callbacks()
{
    auto p = spring_at_wall<int>();
    p.on_progress([](const feti_progress *) -> feti::Status { throw Thrown{1}; });
    throws(1, [&] { p.solve(); });
    throws(1, [&] { p.call(feti_setup); });
    p.on_progress(nullptr);
    p.solve();
    right(p);

    std::string log;
    p.on_log([&log](feti::Status, const char *line) { return log += line, 0; }, FETI_LOG_PHASE);
    p.solve();
    CHECK(!log.empty(), "the log");
    p.on_log([](feti::Status, const char *) -> feti::Status { throw Thrown{2}; }, FETI_LOG_RESULT);
    throws(2, [&] { p.solve(); });
    p.on_log(nullptr, FETI_LOG_NONE);

    for (const feti::Status concurrent : {0, 1}) {
        block_by_functions(p, concurrent, [] { throw Thrown{3}; });
        throws(3, [&] { p.solve(); });
        block_by_functions(p, concurrent, [] {});
        p.solve();
        right(p);
    }

    // A function that returns a failure has thrown nothing, and what an earlier call has thrown is gone.
    p = spring_at_wall<int>();
    p.on_progress([](const feti_progress *) -> feti::Status { throw Thrown{4}; });
    CHECK(feti_solve(p.get(), nullptr) == FETI_CALLBACK, "a call without the class");
    p.on_progress([](const feti_progress *) { return -7; });
    CHECK(refused([&] { p.solve(); }, FETI_CALLBACK).detail.value == -7, "the number of the function");

    // Calls inside of a function are refused, and the function that runs is not replaced.
    feti::Status inside = FETI_OK;
    p.on_progress([&](const feti_progress *) {
        inside = refused([&] { p.on_progress(nullptr); }, FETI_BUSY).status();
        return 0;
    });
    p.solve();
    right(p);
    CHECK(inside == FETI_BUSY, "status inside %d", int(inside));
    p = spring_at_wall<int>();
    p.on_progress([&](const feti_progress *) { return p.body_add(1), 0; });
    refused([&] { p.solve(); }, FETI_BUSY);
}
} // namespace

int main(int count, char **arguments)
{
    const std::string claim = count > 1 ? arguments[1] : "";
    if (claim == "spring") spring();
    else if (claim == "errors") errors();
    else if (claim == "lives") lives();
    else if (claim == "callbacks") callbacks();
    else CHECK(false, "no claim %s", claim.c_str());
    return check_result();
}
