/* 09 Write a problem, read it back, check the answer: what a bug report needs.

   The problem of example 04 (three blocks, two of them floating) goes into one file and from there into a second
   problem, as for a colleague who receives the file. The second problem solves to the same bits. feti_check needs no solve of
   its own: it checks the answer of the first problem in the second problem, and refuses it if a contact force is one per
   cent too large, or if a node has moved by a micrometre. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_reader.h"
#include "demo.h"

typedef struct {
    double *u, *lambda, *mu; /* unknowns, rows, equalities */
} answer;

static feti_problem *hand_over(const case_data *data)
{
    feti_problem *problem = NULL;

    CALL(feti_problem_create(&problem));
    for (int64_t b = 0; b < data->bodies; b++) {
        const case_body *body = &data->body[b];
        const case_matrix *k = &body->stiffness;
        int64_t number;

        CALL(feti_body_add(problem, body->n, &number));
        CALL(feti_body_stiffness_i32(problem, number, body->n, k->row_ptr, k->col, k->val, 0, FETI_LOWER, FETI_COPY));
        CALL(feti_body_null_space(problem, number, body->null_columns, body->n, body->null_space, body->n, FETI_EXACT));
        CALL(feti_body_load(problem, number, body->n, data->load + body->first));
    }
    CALL(feti_rows_add_i32(problem, FETI_INEQUALITY, data->rows, data->contact.row_ptr, NULL, data->contact.col,
                           data->contact.val, 0, data->gap, NULL));
    CALL(feti_rows_add_i32(problem, FETI_EQUALITY, data->equalities, data->equality.row_ptr, NULL, data->equality.col,
                           data->equality.val, 0, data->prescribed, NULL));
    CALL(feti_set_text(problem, "tolerance=1e-12 finish=direct   # what the report is about"));
    return problem;
}

static answer solve(feti_problem *problem, const case_data *data, feti_info *info)
{
    answer x = { demo_array(data->unknowns, sizeof *x.u), demo_array(data->rows, sizeof *x.lambda),
                 demo_array(data->equalities, sizeof *x.mu) };

    CALL(feti_solve(problem, info));
    for (int64_t b = 0; b < data->bodies; b++)
        CALL(feti_displacement(problem, b, data->body[b].n, x.u + data->body[b].first));
    CALL(feti_multipliers(problem, FETI_INEQUALITY, data->rows, x.lambda));
    CALL(feti_multipliers(problem, FETI_EQUALITY, data->equalities, x.mu));
    return x;
}

static int same_bits(const answer *a, const answer *b, const case_data *data)
{
    return memcmp(a->u, b->u, (size_t)data->unknowns * sizeof *a->u) == 0 &&
           memcmp(a->lambda, b->lambda, (size_t)data->rows * sizeof *a->lambda) == 0 &&
           memcmp(a->mu, b->mu, (size_t)data->equalities * sizeof *a->mu) == 0;
}

static feti_certificate check(feti_problem *problem, const answer *x, const case_data *data)
{
    feti_certificate c = { .struct_size = sizeof c };
    CALL(feti_check(problem, data->unknowns, x->u, data->rows, x->lambda, data->equalities, x->mu, &c));
    return c;
}

static void print_row(const char *name, double solved, double pushed, double moved)
{
    printf("%-20s%12.1e%12.1e%12.1e\n", name, solved, pushed, moved);
}

/* One column for each answer; an entry passes when it is at most the limit. */
static void print_table(const feti_certificate *s, const feti_certificate *p, const feti_certificate *m)
{
    printf("%-20s%12s%12s%12s\n", "certificate", "as solved", "force +1 %", "moved 1 um");
    print_row("equilibrium", s->equilibrium, p->equilibrium, m->equilibrium);
    print_row("balance", s->balance, p->balance, m->balance);
    print_row("penetration", s->penetration, p->penetration, m->penetration);
    print_row("equality", s->equality, p->equality, m->equality);
    print_row("negative force", s->negative_force, p->negative_force, m->negative_force);
    print_row("complementarity", s->complementarity, p->complementarity, m->complementarity);
    print_row("limit", s->limit, p->limit, m->limit);
    printf("%-20s%12s%12s%12s\n", "verdict", s->passed ? "passes" : "refused", p->passed ? "passes" : "refused",
           m->passed ? "passes" : "refused");
}

static int64_t largest(int64_t n, const double *x)
{
    int64_t at = 0;
    for (int64_t i = 1; i < n; i++)
        if (x[i] > x[at]) at = i;
    return at;
}

int main(int argc, char **argv)
{
    char folder[512], file[512], text[640];
    case_data data;
    feti_problem *second = NULL;
    feti_info info = { .struct_size = sizeof info }, again = { .struct_size = sizeof again };

    snprintf(folder, sizeof folder, "%s/three_bodies", demo_data_folder(argc, argv));
    snprintf(file, sizeof file, "%s/three_bodies_c.feti", demo_picture_folder(argc, argv));
    if (case_read(folder, &data, text, sizeof text) != 0) demo_stop(text);
    if (!data.lambda_ref || !data.u_ref) demo_stop("three_bodies is not complete");

    feti_problem *first = hand_over(&data);
    CALL(feti_problem_write(first, file));
    CALL(feti_problem_create(&second));
    CALL(feti_problem_read(second, file));

    answer x = solve(first, &data, &info), y = solve(second, &data, &again);
    const int same = same_bits(&x, &y, &data);
    printf("%s\n", same ? "the problem that was read solves to the same bits" : "the problem that was read differs");
    const double error = fmax(demo_error(data.rows, x.lambda, data.lambda_ref), demo_error(data.unknowns, x.u, data.u_ref));

    const feti_certificate solved = check(second, &x, &data);
    const int64_t row = largest(data.rows, x.lambda);
    x.lambda[row] *= 1.01;
    const feti_certificate pushed = check(second, &x, &data);
    x.lambda[row] /= 1.01;
    x.u[data.unknowns - 1] += 1e-3; /* mm */
    const feti_certificate moved = check(second, &x, &data);
    print_table(&solved, &pushed, &moved);

    const int ok = same && solved.passed && !pushed.passed && !moved.passed;
    free(x.u), free(x.lambda), free(x.mu);
    free(y.u), free(y.lambda), free(y.mu);
    CALL(feti_problem_destroy(&first));
    CALL(feti_problem_destroy(&second));
    case_free(&data);
    return demo_line("09_write_read_check", &info, error, ok);
}
