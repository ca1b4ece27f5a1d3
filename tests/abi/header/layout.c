/* The structs have the layout that binaries already compiled rely on, and the same size and last component in Fortran.
 * The numbers are the sums of the members by hand: they hold where int64_t, double and pointers have 8 bytes. */
#include "feti_contact.h"

#include <stddef.h>
#include <stdio.h>

/* For every TYPE: its bytes, and the offset of its members. */
#define SIZE(bytes) _Static_assert(sizeof(TYPE) == (bytes), "size of the struct");
#define AT(bytes, member) _Static_assert(offsetof(TYPE, member) == (bytes), "offset of " #member);

#define TYPE feti_error_detail
SIZE(152) AT(0, struct_size) AT(8, status) AT(12, argument) AT(16, body) AT(48, entry) AT(56, value) AT(64, limit)
AT(72, function) AT(112, element) AT(120, node) AT(128, rank) AT(136, pair) AT(144, face)
#undef TYPE

#define TYPE feti_option
SIZE(72) AT(0, struct_size) AT(8, type) AT(16, minimum) AT(32, default_f64) AT(40, default_i64) AT(48, name) AT(56, doc)
AT(64, default_str)
#undef TYPE

#define TYPE feti_info
SIZE(392) AT(0, struct_size) AT(8, status) AT(16, bodies) AT(64, undetermined) AT(72, steps) AT(112, coarse_solves)
AT(120, factorisations) AT(128, analyses) AT(136, worst) AT(144, equilibrium) AT(192, duality_gap) AT(200, energy)
AT(208, seconds_setup) AT(216, seconds_solve) AT(224, direct_solves) AT(232, finished) AT(240, columns_computed)
AT(248, columns_kept) AT(256, explicit_operators) AT(264, implicit_operators) AT(272, factor_bytes) AT(280, operator_bytes)
AT(288, friction_cone) AT(304, friction_stick) AT(312, nodes) AT(344, friction_starts)
AT(352, ranks) AT(360, messages) AT(376, seconds_waited) AT(384, seconds_leading)
#undef TYPE

#define TYPE feti_phase
SIZE(32) AT(0, struct_size) AT(8, bytes) AT(16, seconds) AT(24, name)
#undef TYPE

#define TYPE feti_certificate
SIZE(272) AT(0, struct_size) AT(8, passed) AT(16, limit) AT(24, worst) AT(32, equilibrium) AT(80, duality_gap)
AT(88, equilibrium_body) AT(128, complementarity_row) AT(136, friction_cone) AT(160, friction_cone_node)
AT(176, friction_stick_node) AT(184, equilibrium_rank) AT(248, friction_stick_rank) AT(256, pair) AT(264, pair_node)
#undef TYPE

#define TYPE feti_progress
SIZE(88) AT(0, struct_size) AT(8, phase) AT(12, step) AT(16, steps) AT(24, products) AT(32, active) AT(40, residual) AT(64, theta)
AT(72, seconds) AT(80, fraction)
#undef TYPE

#define TYPE feti_findings
SIZE(216) AT(0, struct_size) AT(8, status) AT(12, kind) AT(16, body) AT(24, component) AT(32, dof) AT(40, row)
AT(48, rows_involved) AT(56, undetermined) AT(64, redundant_rows) AT(72, untouched_bodies) AT(80, untouched_body) AT(88, margin)
AT(96, motion) AT(144, unheld) AT(152, doubtful_bodies) AT(160, doubtful_body) AT(168, soft_bodies) AT(176, soft_body)
AT(184, capacity) AT(192, rank) AT(200, pair) AT(208, pair_node)
#undef TYPE

#define TYPE feti_body_facts
SIZE(160) AT(0, struct_size) AT(8, unknowns) AT(40, borrowed) AT(56, null_space) AT(80, shared_with) AT(104, gap)
AT(112, force_error) AT(120, soft_free) AT(128, soft_held) AT(136, softness) AT(144, softness_of_rounding) AT(152, pieces)
#undef TYPE

#define TYPE feti_pair_facts
SIZE(200) AT(0, struct_size) AT(8, rows) AT(16, without) AT(24, closed) AT(32, sticking) AT(40, slipping) AT(48, force) AT(72, moment)
AT(96, closed_area) AT(104, pressure) AT(112, pressure_node) AT(120, angle) AT(128, angle_node) AT(136, depth) AT(144, depth_node)
AT(152, master_depth) AT(160, master_depth_node) AT(168, between_walls) AT(176, between_walls_node) AT(184, held) AT(192, held_overlap)
#undef TYPE

#define TYPE feti_communicator
SIZE(96) AT(0, struct_size) AT(8, rank) AT(12, size) AT(16, local_size) AT(20, reserved0) AT(24, user) AT(32, send) AT(40, flush)
AT(48, receive) AT(56, release) AT(64, reserved)
#undef TYPE

struct layout {
    const char *type;
    size_t size, last; /* bytes; last: offset of the last member */
};

static const struct layout in_c[] = {
    {"feti_error_detail", sizeof(feti_error_detail), offsetof(feti_error_detail, face)},
    {"feti_option", sizeof(feti_option), offsetof(feti_option, default_str)},
    {"feti_info", sizeof(feti_info), offsetof(feti_info, seconds_leading)},
    {"feti_certificate", sizeof(feti_certificate), offsetof(feti_certificate, pair_node)},
    {"feti_progress", sizeof(feti_progress), offsetof(feti_progress, fraction)},
    {"feti_findings", sizeof(feti_findings), offsetof(feti_findings, pair_node)},
    {"feti_phase", sizeof(feti_phase), offsetof(feti_phase, name)},
    {"feti_body_facts", sizeof(feti_body_facts), offsetof(feti_body_facts, pieces)},
    {"feti_pair_facts", sizeof(feti_pair_facts), offsetof(feti_pair_facts, held_overlap)},
    {"feti_communicator", sizeof(feti_communicator), offsetof(feti_communicator, reserved)},
};
enum { TYPES = sizeof in_c / sizeof in_c[0] };

/* layout.f90: the same figures, types in the order of in_c. */
void layout_in_fortran(int64_t size[TYPES], int64_t last[TYPES]);

int main(void)
{
    int64_t size[TYPES] = {0}, last[TYPES] = {0};
    int differences = 0;

    layout_in_fortran(size, last);
    for (size_t k = 0; k < TYPES; k++) {
        if (size[k] != (int64_t)in_c[k].size || last[k] != (int64_t)in_c[k].last) {
            fprintf(stderr, "%s: C size %zu, last member at %zu; Fortran %lld and %lld\n", in_c[k].type, in_c[k].size,
                    in_c[k].last, (long long)size[k], (long long)last[k]);
            differences++;
        }
    }
    return differences == 0 ? 0 : 1;
}
