/* The structs have the layout that binaries already compiled rely on, and the same size and last component in Fortran.
 * The numbers are the sums of the members by hand: they hold where int64_t, double and pointers have 8 bytes. */
#include "feti_contact.h"

#include <stddef.h>
#include <stdio.h>

#define SIZE(type, bytes) _Static_assert(sizeof(type) == (bytes), "size of " #type)
#define OFFSET(type, member, bytes) \
    _Static_assert(offsetof(type, member) == (bytes), "offset of " #type "." #member)

SIZE(feti_error_detail, 128);
OFFSET(feti_error_detail, struct_size, 0);
OFFSET(feti_error_detail, status, 8);
OFFSET(feti_error_detail, argument, 12);
OFFSET(feti_error_detail, body, 16);
OFFSET(feti_error_detail, entry, 48);
OFFSET(feti_error_detail, value, 56);
OFFSET(feti_error_detail, limit, 64);
OFFSET(feti_error_detail, function, 72);
OFFSET(feti_error_detail, element, 112);
OFFSET(feti_error_detail, node, 120);

SIZE(feti_option, 72);
OFFSET(feti_option, struct_size, 0);
OFFSET(feti_option, type, 8);
OFFSET(feti_option, minimum, 16);
OFFSET(feti_option, default_f64, 32);
OFFSET(feti_option, default_i64, 40);
OFFSET(feti_option, name, 48);
OFFSET(feti_option, doc, 56);
OFFSET(feti_option, default_str, 64);

SIZE(feti_info, 352);
OFFSET(feti_info, struct_size, 0);
OFFSET(feti_info, status, 8);
OFFSET(feti_info, bodies, 16);
OFFSET(feti_info, undetermined, 64);
OFFSET(feti_info, steps, 72);
OFFSET(feti_info, coarse_solves, 112);
OFFSET(feti_info, factorisations, 120);
OFFSET(feti_info, analyses, 128);
OFFSET(feti_info, worst, 136);
OFFSET(feti_info, equilibrium, 144);
OFFSET(feti_info, duality_gap, 192);
OFFSET(feti_info, energy, 200);
OFFSET(feti_info, seconds_setup, 208);
OFFSET(feti_info, seconds_solve, 216);
OFFSET(feti_info, direct_solves, 224);
OFFSET(feti_info, finished, 232);
OFFSET(feti_info, columns_computed, 240);
OFFSET(feti_info, columns_kept, 248);
OFFSET(feti_info, explicit_operators, 256);
OFFSET(feti_info, implicit_operators, 264);
OFFSET(feti_info, factor_bytes, 272);
OFFSET(feti_info, operator_bytes, 280);
OFFSET(feti_info, friction_cone, 288);
OFFSET(feti_info, friction_stick, 304);
OFFSET(feti_info, nodes, 312);
OFFSET(feti_info, friction_starts, 344);

SIZE(feti_phase, 32);
OFFSET(feti_phase, struct_size, 0);
OFFSET(feti_phase, bytes, 8);
OFFSET(feti_phase, seconds, 16);
OFFSET(feti_phase, name, 24);

SIZE(feti_certificate, 184);
OFFSET(feti_certificate, struct_size, 0);
OFFSET(feti_certificate, passed, 8);
OFFSET(feti_certificate, limit, 16);
OFFSET(feti_certificate, worst, 24);
OFFSET(feti_certificate, equilibrium, 32);
OFFSET(feti_certificate, duality_gap, 80);
OFFSET(feti_certificate, equilibrium_body, 88);
OFFSET(feti_certificate, complementarity_row, 128);
OFFSET(feti_certificate, friction_cone, 136);
OFFSET(feti_certificate, friction_cone_node, 160);
OFFSET(feti_certificate, friction_stick_node, 176);

SIZE(feti_progress, 88);
OFFSET(feti_progress, struct_size, 0);
OFFSET(feti_progress, phase, 8);
OFFSET(feti_progress, step, 12);
OFFSET(feti_progress, steps, 16);
OFFSET(feti_progress, products, 24);
OFFSET(feti_progress, active, 32);
OFFSET(feti_progress, residual, 40);
OFFSET(feti_progress, theta, 64);
OFFSET(feti_progress, seconds, 72);
OFFSET(feti_progress, fraction, 80);

SIZE(feti_findings, 192);
OFFSET(feti_findings, struct_size, 0);
OFFSET(feti_findings, status, 8);
OFFSET(feti_findings, kind, 12);
OFFSET(feti_findings, body, 16);
OFFSET(feti_findings, component, 24);
OFFSET(feti_findings, dof, 32);
OFFSET(feti_findings, row, 40);
OFFSET(feti_findings, rows_involved, 48);
OFFSET(feti_findings, undetermined, 56);
OFFSET(feti_findings, redundant_rows, 64);
OFFSET(feti_findings, untouched_bodies, 72);
OFFSET(feti_findings, untouched_body, 80);
OFFSET(feti_findings, margin, 88);
OFFSET(feti_findings, motion, 96);
OFFSET(feti_findings, unheld, 144);
OFFSET(feti_findings, doubtful_bodies, 152);
OFFSET(feti_findings, doubtful_body, 160);
OFFSET(feti_findings, soft_bodies, 168);
OFFSET(feti_findings, soft_body, 176);
OFFSET(feti_findings, capacity, 184);

SIZE(feti_body_facts, 160);
OFFSET(feti_body_facts, struct_size, 0);
OFFSET(feti_body_facts, unknowns, 8);
OFFSET(feti_body_facts, borrowed, 40);
OFFSET(feti_body_facts, null_space, 56);
OFFSET(feti_body_facts, shared_with, 80);
OFFSET(feti_body_facts, gap, 104);
OFFSET(feti_body_facts, force_error, 112);
OFFSET(feti_body_facts, soft_free, 120);
OFFSET(feti_body_facts, soft_held, 128);
OFFSET(feti_body_facts, softness, 136);
OFFSET(feti_body_facts, softness_of_rounding, 144);
OFFSET(feti_body_facts, pieces, 152);

struct layout {
    const char *type;
    size_t size, last; /* bytes; last: offset of the last member */
};

static const struct layout in_c[] = {
    {"feti_error_detail", sizeof(feti_error_detail), offsetof(feti_error_detail, node)},
    {"feti_option", sizeof(feti_option), offsetof(feti_option, default_str)},
    {"feti_info", sizeof(feti_info), offsetof(feti_info, friction_starts)},
    {"feti_certificate", sizeof(feti_certificate), offsetof(feti_certificate, friction_stick_node)},
    {"feti_progress", sizeof(feti_progress), offsetof(feti_progress, fraction)},
    {"feti_findings", sizeof(feti_findings), offsetof(feti_findings, capacity)},
    {"feti_phase", sizeof(feti_phase), offsetof(feti_phase, name)},
    {"feti_body_facts", sizeof(feti_body_facts), offsetof(feti_body_facts, pieces)},
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
