// feti_contact.h for C++17: a problem that destroys itself, failures as exceptions, arrays that have their sizes. A method has the
// name of its C function without `feti_`, and its arguments without the handle, without sizes that arrays have, and without results,
// which it returns. Problem::call makes all other calls. A status below 0 is thrown, any other returned.
#ifndef FETI_CONTACT_HPP
#define FETI_CONTACT_HPP
#include <feti_contact.h>
#include <cmath>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace feti {
using Status = std::int32_t;
using Int = std::int64_t;
/// A struct of the header with its size, ready for the library.
template <class S> S sized() { S s{}; s.struct_size = sizeof s; return s; }
/// A failed call: what() is the library's text, `detail` has status, argument, place, value and limit.
struct Error : std::runtime_error {
    Error(const std::string &text, const feti_error_detail &place) : std::runtime_error(text), detail(place) {}
    Error(const std::string &text, Status status, Status k = 0, double value = NAN, double limit = NAN) : Error(text, sized<feti_error_detail>()) {
        auto &d = detail;
        d.status = status, d.argument = k, d.value = value, d.limit = limit;
        d.body = d.component = d.dof = d.row = d.entry = d.element = d.node = d.rank = d.pair = d.face = -1;
    }
    Status status() const noexcept { return detail.status; }
    const char *name() const noexcept { return feti_status_name(detail.status); }
    feti_error_detail detail;
};
/// The status of a call if it is not below 0; otherwise throws the last error of this thread.
inline Status check(Status status) {
    if (status >= 0) return status;
    auto detail = sized<feti_error_detail>();
    if (feti_last_error_detail(&detail) != FETI_OK || detail.status != status) throw Error(feti_status_text(status), status);
    std::string text(std::size_t(feti_last_error(nullptr, 0)), ' ');
    feti_last_error(text.data(), Int(text.size()) + 1); // a string has room for the NUL
    throw Error(text, detail);
}
/// A view of a container, a C array, {1, 2} or {pointer, size}; an empty one is NULL.
template <class T> struct Array {
    T *data_ = nullptr;
    Int size_ = 0;
    Array() = default;
    template <class N, class = std::enable_if_t<std::is_integral_v<N>>> Array(T *data, N n) : data_(n ? data : nullptr), size_(Int(n)) {}
    Array(std::initializer_list<std::remove_const_t<T>> list) : Array(std::data(list), list.size()) {}
    template <class C, class = std::enable_if_t<std::is_convertible_v<decltype(std::data(std::declval<C &>())), T *>>>
    Array(C &&container) : Array(std::data(container), std::size(container)) {}
    T *data() const { return data_; }
    Int size() const { return size_; }
    /// Of row_ptr: how many entries the arrays have that it leads to.
    Int entries(Int base) const { return size_ ? Int(data_[size_ - 1]) - base : 0; }
    /// The pointer, if argument k of the function has n entries, or, where it is optional, none.
    T *of(Int n, Status k, const std::string &function, bool optional = false) const {
        if (size_ == n || (optional && !size_)) return data_;
        const auto text = ": argument " + std::to_string(k) + " has " + std::to_string(size_) + " entries, not " + std::to_string(n);
        throw Error("feti_" + function + text, FETI_ARGUMENT - k, k, double(size_), double(n));
    }
};
using Doubles = Array<const double>;
template <class A> using Like = Array<const std::remove_pointer_t<decltype(std::data(std::declval<A &>()))>>; // indices of one type

/// Owns a problem, may be moved. What a function of the host throws arrives in the caller of the library.
class Problem {
public:
    using Progress = std::function<Status(const feti_progress *)>; // as in C, without `user`
    using Log = std::function<Status(Status, const char *)>;
    using Operator = std::function<Status(Int, Int, Int, const double *, Int, double *, Int)>;
    Problem() : host_(new Host) { check(feti_problem_create(&p_)); }
    Problem(Problem &&other) noexcept : host_(std::move(other.host_)), p_(std::exchange(other.p_, nullptr)) {}
    Problem &operator=(Problem other) noexcept { host_.swap(other.host_); std::swap(p_, other.p_); return *this; }
    ~Problem() { if (p_ && feti_problem_destroy(&p_) != FETI_OK) host_.release(); } // a call still runs, which uses them
    feti_problem *get() const noexcept { return p_; }
    /// Any function whose first argument is the handle; a container stands for its pointer.
    template <class F, class... A> Status call(F function, A &&...a) const {
        const Status status = function(p_, raw(a, 0)...);
        const auto thrown = host_ && status != FETI_BUSY ? host_->put(nullptr) : nullptr;
        if (thrown && status == FETI_CALLBACK) std::rethrow_exception(thrown);
        return feti::check(status);
    }
    /// One whose last argument is a struct, or n and an array: what it gives.
    template <class S, class F, class... A> S facts(F f, A &&...a) const { auto s = sized<S>(); return call(f, a..., &s), s; }
    template <class T, class F, class... A> std::vector<T> read(Int n, F f, A &&...a) const {
        auto values = std::vector<T>(std::size_t(n));
        return call(f, a..., n, values), values;
    }
    Int body_add(Int n) { Int body = 0; return call(feti_body_add, n, &body), body; }
    template <class A> void body_stiffness(Int body, const A &row_ptr, Like<A> col, Doubles val, Status base, Status storage, Status flags = 0) {
        const Like<A> ptr(row_ptr);
        call(twin<A>(feti_body_stiffness_i32, feti_body_stiffness_i64), body, ptr.size() - 1, ptr, col.of(ptr.entries(base), 5, __func__),
             val.of(ptr.entries(base), 6, __func__), base, storage, flags);
    }
    void body_operator(Int body, Doubles diag, Operator kplus, Operator k, Status concurrent = 0) {
        hook(body, kplus, k, [&](auto f, auto g, void *user) { call(feti_body_operator, body, diag.size(), diag, f, g, concurrent, user); });
    }
    void body_load(Int body, Doubles f) { call(feti_body_load, body, f.size(), f); }
    template <class A> Int rows_add(Status kind, const A &row_ptr, Like<A> body, Like<A> dof, Doubles val, Status base, Doubles rhs = {}) {
        const Like<A> ptr(row_ptr);
        Int n = ptr.entries(base), rows = ptr.size() - 1, first = 0;
        return call(twin<A>(feti_rows_add_i32, feti_rows_add_i64), kind, rows, ptr, body.of(n, 5, __func__, true), dof.of(n, 6, __func__),
             val.of(n, 7, __func__), base, rhs.of(rows, 9, __func__, true), &first), first;
    }
    void set(const std::string &option, double value) { call(feti_set_f64, option, value); }
    template <class N> std::enable_if_t<std::is_integral_v<N>> set(const std::string &option, N value) { call(feti_set_i64, option, Int(value)); }
    void set(const std::string &option, const std::string &value) { call(feti_set_str, option, value); }
    void on_progress(Progress f) { hook(-1, f, {}, [&](auto run, auto, void *user) { call(feti_on_progress, run, user); }); }
    void on_log(Log f, Status level) { hook(-2, f, {}, [&](auto run, auto, void *user) { call(feti_on_log, run, level, user); }); }
    feti_info solve() { return facts<feti_info>(feti_solve); }
    std::vector<double> displacement(Int body) const { return read<double>(unknowns(body), feti_displacement, body); }
    std::vector<double> reaction(Status kind, Int body) const { return read<double>(unknowns(body), feti_reaction, kind, body); }
    std::vector<double> multipliers(Status kind) const { return read<double>(count(kind == FETI_EQUALITY ? 3 : 2), feti_multipliers, kind); }
    std::vector<double> gaps() const { return read<double>(count(2), feti_gaps); }
    std::vector<Status> active() const { return read<Status>(count(2), feti_active); }
private:
    struct Host { // what the library calls, and what it threw
        std::map<Int, std::shared_ptr<void>> functions;
        std::mutex lock; // of `thrown`: with concurrent = 1 several functions run at once
        std::exception_ptr thrown;
        std::exception_ptr put(std::exception_ptr e) { const std::lock_guard<std::mutex> guard(lock); return std::exchange(thrown, e); }
    };
    template <class... A> struct Hook {
        Host *host;
        std::function<Status(A...)> f[2];
        template <int k> static Status run(void *user, A... a) noexcept {
            const auto hook = static_cast<Hook *>(user);
            try { return hook->f[k](a...); } catch (...) { return hook->host->put(std::current_exception()), -1; }
        }
    };
    // Gives the library one or two functions, and keeps them once it has taken them.
    template <class... A, class G> void hook(Int key, std::function<Status(A...)> f, std::function<Status(A...)> g, G give) {
        if (!host_) throw Error(feti_status_text(FETI_HANDLE), FETI_HANDLE);
        auto &place = host_->functions[key];
        auto made = std::make_shared<Hook<A...>>(Hook<A...>{host_.get(), {f, g}});
        give(f ? Hook<A...>::template run<0> : nullptr, g ? Hook<A...>::template run<1> : nullptr, made.get());
        place = std::move(made);
    }
    template <class A, class F, class G> static auto twin(F f, G g) { if constexpr (sizeof *Like<A>().data() == 4) return f; else return g; }
    template <class A> static auto raw(A &a, int) -> decltype(std::data(a)) { return std::data(a); }
    template <class A> static A &raw(A &a, long) { return a; }
    Int count(int of) const { Int n[4] = {}; return call(feti_counts, n, n + 1, n + 2, n + 3), n[of]; }
    Int unknowns(Int body) const { return body == FETI_ALL ? count(1) : facts<feti_body_facts>(feti_body_info, body).unknowns; }
    std::unique_ptr<Host> host_;
    feti_problem *p_ = nullptr;
};
} // namespace feti
#endif
