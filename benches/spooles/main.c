/* What option dual_operator = automatic costs if K+ is SPOOLES, against the better of explicit and implicit.

   An elastic block of bricks lies on a slightly convex, rigid ground, floats (equality rows keep it from sliding) and is pressed
   down; its K+ is a factor of SPOOLES with six unknowns held. Every scene is solved with the three values of the option in turns;
   processor seconds of the calls of the library, with those of K+, medians of all rounds:

       spooles <scene> automatic/better <ratio> goal 1.2 ok|short

   Exit code 1 if a figure is short. Arguments: names of scenes, none for all. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "factor.h"
#include "feti_contact.h"

enum { HOLDS = 6, FORMS = 3, ROUNDS = 3, MOST_STEPS = 20 };
static const char *const FORM[FORMS] = { "explicit", "implicit", "automatic" };
static const double GOAL = 1.2, YOUNG = 2e5 /* N/mm^2 */, POISSON = 0.3;

/* A block of bricks of 1 mm; rows at the `patch` x `patch` nodes in the middle of its bottom. */
typedef struct {
    const char *name;
    int bricks[3], patch;
    /* Steps of load; `newton`: K is another one in every step. */
    int steps, newton;
} scene;

static const scene SCENES[] = {
    { "few-first", { 14, 14, 14 }, 5, 1, 0 },
    { "few-5-loads", { 14, 14, 14 }, 5, 5, 0 },
    { "few-20-loads", { 14, 14, 14 }, 5, 20, 0 },
    { "few-newton", { 14, 14, 14 }, 5, 6, 1 },
    { "face-first", { 14, 14, 14 }, 15, 1, 0 },
    { "face-5-loads", { 14, 14, 14 }, 15, 5, 0 },
    { "face-20-loads", { 14, 14, 14 }, 15, 20, 0 },
    { "face-newton", { 14, 14, 14 }, 15, 6, 1 },
    { "many-first", { 26, 26, 4 }, 27, 1, 0 },
    { "many-5-loads", { 26, 26, 4 }, 27, 5, 0 },
    { "many-20-loads", { 26, 26, 4 }, 27, 20, 0 },
    { "many-newton", { 26, 26, 4 }, 27, 6, 1 },
};

typedef struct {
    matrix k;
    factor *kplus;
    int64_t columns;
    double seconds;
} body;

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(int32_t status)
{
    char text[512];

    if (status >= 0) return;
    feti_last_error(text, sizeof text);
    fprintf(stderr, "%s: %s\n", feti_status_name(status), text);
    exit(1);
}

static void *room(size_t n, size_t bytes)
{
    void *p = calloc(n, bytes);

    if (!p) exit(1);
    return p;
}

static int nodes(const scene *s)
{
    return (s->bricks[0] + 1) * (s->bricks[1] + 1) * (s->bricks[2] + 1);
}

static int node(const scene *s, int i, int j, int k)
{
    return i + (s->bricks[0] + 1) * (j + (s->bricks[1] + 1) * k);
}

/* Integral of dN_a/dx_d dN_c/dx_e over a brick: products of integrals along the three axes. */
static double gradients(int a, int c, int d, int e)
{
    double product = 1.0;

    for (int axis = 0; axis < 3; axis++) {
        const int p = a >> axis & 1, q = c >> axis & 1;
        const double slope = p ? 1.0 : -1.0, other = q ? 1.0 : -1.0;
        if (axis == d && axis == e) product *= slope * other;
        else if (axis == d) product *= slope / 2.0;
        else if (axis == e) product *= other / 2.0;
        else product *= p == q ? 1.0 / 3.0 : 1.0 / 6.0;
    }
    return product;
}

/* lambda div v div u + 2 mu e(v):e(u), unknown d of corner a and e of corner c. */
static double brick(int a, int d, int c, int e)
{
    const double mu = YOUNG / (2.0 * (1.0 + POISSON)), lambda = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON);
    double value = lambda * gradients(a, c, d, e) + mu * gradients(a, c, e, d);

    for (int axis = 0; d == e && axis < 3; axis++) value += mu * gradients(a, c, axis, axis);
    return value;
}

/* Entry (row, col) of K, whose columns of a row are neighbours in the order of nodes. */
static double *entry(matrix *k, int row, int col)
{
    int at = k->ptr[row];

    while (at < k->ptr[row + 1] && k->col[at] != col) at++;
    return k->val + at;
}

/* K in step `step`: bricks of higher layers stiffen a little with every step. */
static matrix assembled(const scene *s, int step)
{
    const int n = 3 * nodes(s), *b = s->bricks;
    matrix k = { n, room((size_t)n + 1, sizeof(int)), room((size_t)n * 45, sizeof(int)), room((size_t)n * 45, sizeof(double)) };
    double own[24][24];
    int end = 0;

    for (int z = 0; z <= b[2]; z++)
        for (int y = 0; y <= b[1]; y++)
            for (int x = 0; x <= b[0]; x++)
                for (int d = 0; d < 3; d++) {
                    const int row = 3 * node(s, x, y, z) + d;
                    k.ptr[row] = end;
                    for (int near = 0; near < 27; near++) {
                        const int i = x + near % 3 - 1, j = y + near / 3 % 3 - 1, l = z + near / 9 - 1;
                        if (i < 0 || j < 0 || l < 0 || i > b[0] || j > b[1] || l > b[2]) continue;
                        for (int e = 0; e < 3; e++)
                            if (3 * node(s, i, j, l) + e >= row) k.col[end++] = 3 * node(s, i, j, l) + e;
                    }
                    k.ptr[row + 1] = end;
                }
    for (int r = 0; r < 24; r++)
        for (int c = 0; c < 24; c++) own[r][c] = brick(r / 3, r % 3, c / 3, c % 3);
    for (int z = 0; z < b[2]; z++)
        for (int y = 0; y < b[1]; y++)
            for (int x = 0; x < b[0]; x++)
                for (int r = 0; r < 24; r++)
                    for (int c = 0; c < 24; c++) {
                        const int p = r / 3, q = c / 3;
                        const int row = 3 * node(s, x + p % 2, y + p / 2 % 2, z + p / 4) + r % 3;
                        const int col = 3 * node(s, x + q % 2, y + q / 2 % 2, z + q / 4) + c % 3;
                        if (row <= col) *entry(&k, row, col) += own[r][c] * (1.0 + 0.05 * step * z / b[2]);
                    }
    return k;
}

static body made(const scene *s, int step)
{
    const int *b = s->bricks, far = node(s, b[0], 0, b[2]), deep = node(s, 0, b[1], b[2]), top = node(s, 0, 0, b[2]);
    const int held[HOLDS] = { 3 * top, 3 * top + 1, 3 * top + 2, 3 * far + 1, 3 * far + 2, 3 * deep + 2 };
    body own = { .k = assembled(s, step) };

    own.kplus = factor_new(&own.k, held, HOLDS);
    return own;
}

static int32_t by_kplus(void *user, int64_t number, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    body *own = user;
    const double begun = now();

    (void)number, (void)n;
    factor_solve(own->kplus, nrhs, x, ldx, y, ldy);
    own->columns += nrhs;
    own->seconds += now() - begun;
    return 0;
}

static int32_t by_k(void *user, int64_t number, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy)
{
    const matrix *k = &((const body *)user)->k;

    (void)number;
    for (int64_t c = 0; c < nrhs; c++, x += ldx, y += ldy)
        for (int64_t i = 0; i < n; i++)
            for (int at = k->ptr[i]; at < k->ptr[i + 1]; at++) {
                const int j = k->col[at];
                y[i] += k->val[at] * x[j];
                if (j != i) y[j] += k->val[at] * x[i];
            }
    return 0;
}

static void give(feti_problem *p, const scene *s, body *own)
{
    const int n = own->k.n;
    double *diag = room((size_t)n, sizeof *diag), *modes = room((size_t)n * 6, sizeof *modes);

    for (int i = 0; i < n; i++) diag[i] = own->k.val[own->k.ptr[i]];
    must(feti_body_operator(p, 0, n, diag, by_kplus, by_k, 0, own));
    for (int at = 0; at < n / 3; at++) {
        const int nx = s->bricks[0] + 1, ny = s->bricks[1] + 1;
        const double xyz[3] = { at % nx, at / nx % ny, at / nx / ny };
        for (int d = 0; d < 3; d++) {
            modes[3 * at + d + (int64_t)n * d] = 1.0;
            modes[3 * at + (d + 1) % 3 + (int64_t)n * (3 + d)] = -xyz[(d + 2) % 3];
            modes[3 * at + (d + 2) % 3 + (int64_t)n * (3 + d)] = xyz[(d + 1) % 3];
        }
    }
    must(feti_body_null_space(p, 0, 6, n, modes, n, FETI_EXACT));
    free(diag);
    free(modes);
}

/* -u_z <= gap at nodes of the bottom; three equalities against sliding and turning. */
static int give_rows(feti_problem *p, const scene *s)
{
    const int *b = s->bricks, most = (b[0] + 1) * (b[1] + 1);
    int32_t *ptr = room((size_t)most + 1, sizeof *ptr), *dof = room((size_t)most, sizeof *dof), count = 0;
    const int32_t three[4] = { 0, 1, 2, 3 };
    const int32_t held[3] = { 3 * node(s, 0, 0, 0), 3 * node(s, 0, 0, 0) + 1, 3 * node(s, b[0], 0, 0) + 1 };
    double *val = room((size_t)most, sizeof *val), *gap = room((size_t)most, sizeof *gap);
    const double ones[3] = { 1.0, 1.0, 1.0 };

    for (int j = 0; j <= b[1]; j++)
        for (int i = 0; i <= b[0]; i++) {
            const double x = i - 0.5 * b[0], y = j - 0.5 * b[1];
            if (2.0 * fmax(fabs(x), fabs(y)) > s->patch - 1) continue;
            dof[count] = 3 * node(s, i, j, 0) + 2, val[count] = -1.0;
            gap[count] = 1e-3 * (x * x + 0.5 * y * y) / (b[0] * b[0]);
            ptr[count + 1] = count + 1;
            count++;
        }
    must(feti_rows_add_i32(p, FETI_INEQUALITY, count, ptr, NULL, dof, val, 0, gap, NULL));
    must(feti_rows_add_i32(p, FETI_EQUALITY, 3, three, NULL, held, ones, 0, NULL, NULL));
    free(ptr), free(dof), free(val), free(gap);
    return count + 3;
}

/* Presses on the top, in step `step` more and farther to one side. */
static void give_load(feti_problem *p, const scene *s, int step)
{
    const int *b = s->bricks;
    const double total = 400.0 * (1.0 + 0.15 * step), lean = 0.02 * step;
    double *load = room((size_t)nodes(s) * 3, sizeof *load);

    for (int j = 0; j <= b[1]; j++)
        for (int i = 0; i <= b[0]; i++)
            load[3 * node(s, i, j, b[2]) + 2] = -total * (1.0 + lean * (2.0 * i / b[0] - 1.0)) / ((b[0] + 1) * (b[1] + 1));
    must(feti_body_load(p, 0, 3 * nodes(s), load));
    free(load);
}

typedef struct {
    double seconds, in_kplus;
    int64_t columns, products, active;
    int rows;
} cost;

/* All steps of a scene with one value of the option. */
static cost solved(const scene *s, body *bodies, const char *form)
{
    cost spent = { 0 };
    feti_problem *p = NULL;
    feti_info info = { .struct_size = sizeof info };
    int64_t number;

    must(feti_problem_create(&p));
    must(feti_set_str(p, "dual_operator", form));
    must(feti_set_i64(p, "threads", 1));
    must(feti_body_add(p, 3 * nodes(s), &number));
    give(p, s, bodies);
    spent.rows = give_rows(p, s);
    for (int step = 0; step < s->steps; step++) {
        body *own = bodies + (s->newton ? step : 0);
        const double begun = now();
        own->columns = 0, own->seconds = 0.0;
        if (s->newton && step) give(p, s, own);
        give_load(p, s, step);
        must(feti_solve(p, &info));
        spent.seconds += now() - begun;
        spent.in_kplus += own->seconds;
        spent.columns += own->columns;
        spent.products += info.dual_applications;
        spent.active = info.active;
        if (info.status != FETI_OK) exit(1);
    }
    must(feti_problem_destroy(&p));
    return spent;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* Seconds of a column of K+ alone, and in a call of 32 columns. */
static void price(const scene *s, body *own)
{
    enum { BLOCK = 32 };
    const int n = own->k.n;
    double *x = room((size_t)n * BLOCK, sizeof *x), *y = room((size_t)n * BLOCK, sizeof *y), times[2][ROUNDS];

    for (int i = 0; i < n * BLOCK; i++) x[i] = sin(i);
    for (int round = 0; round < ROUNDS; round++)
        for (int together = 0; together < 2; together++) {
            const double begun = now();
            for (int c = 0; c < BLOCK; c += together ? BLOCK : 1)
                factor_solve(own->kplus, together ? BLOCK : 1, x + (int64_t)n * c, n, y + (int64_t)n * c, n);
            times[together][round] = (now() - begun) / BLOCK;
        }
    for (int together = 0; together < 2; together++) qsort(times[together], ROUNDS, sizeof(double), ascending);
    printf("  %s: %d unknowns; K+ costs %.2f ms a column alone, %.2f in a block of %d\n", s->name, n, 1e3 * times[0][ROUNDS / 2],
           1e3 * times[1][ROUNDS / 2], BLOCK);
    free(x), free(y);
}

/* Prints the figure of a scene; whether it is within the goal. */
static int measured(const scene *s)
{
    body bodies[MOST_STEPS];
    const int count = s->newton ? s->steps : 1;
    double seconds[FORMS][ROUNDS], median[FORMS];
    cost last[FORMS];

    for (int at = 0; at < count; at++) bodies[at] = made(s, at);
    price(s, bodies);
    for (int round = 0; round < ROUNDS; round++)
        for (int form = 0; form < FORMS; form++) {
            last[form] = solved(s, bodies, FORM[form]);
            seconds[form][round] = last[form].seconds;
        }
    for (int form = 0; form < FORMS; form++) {
        qsort(seconds[form], ROUNDS, sizeof(double), ascending);
        median[form] = seconds[form][ROUNDS / 2];
        printf("  %-9s %8.1f ms, K+ in the last round %8.1f ms, %5lld columns, %4lld products, %d rows, %lld closed\n",
               FORM[form], 1e3 * median[form], 1e3 * last[form].in_kplus, (long long)last[form].columns,
               (long long)last[form].products, last[form].rows, (long long)last[form].active);
    }
    for (int at = 0; at < count; at++) {
        factor_free(bodies[at].kplus);
        free(bodies[at].k.ptr), free(bodies[at].k.col), free(bodies[at].k.val);
    }
    const double ratio = median[2] / fmin(median[0], median[1]);
    printf("spooles %s automatic/better %.2f goal %.1f %s\n", s->name, ratio, GOAL, ratio <= GOAL ? "ok" : "short");
    fflush(stdout);
    return ratio <= GOAL;
}

int main(int argc, char **argv)
{
    int is_short = 0;

    for (size_t at = 0; at < sizeof SCENES / sizeof *SCENES; at++) {
        int asked = argc < 2;
        for (int a = 1; a < argc; a++) asked = asked || strstr(SCENES[at].name, argv[a]);
        if (asked && !measured(&SCENES[at])) is_short = 1;
    }
    return is_short;
}
