/* The loop that hosts write themselves: penalty springs on the closed rows, weak springs on all unknowns, an active set, and CHOLMOD,
   whose analysis is made once for K and all rows.
   hostloop <problem> <accuracy> <bytes>   prints lines `name value`; the problem is written by matrix.rs. It ends once no row
   penetrates by more than the accuracy times the largest displacement, and K u + B'lambda - f is below it times the largest load.
   Until then forces on a set that stays are augmented: lambda and the forces of the weak springs go to the right-hand side. */
#include "cholmod_peer.h"

/* Penalty and weak springs against the diagonal of K. On the deck 40k_peers no other powers of ten are faster: 1e2 to 1e6 and 1e-10 to
   1e-7 take the same 6 factorisations, but from 1e5 on rounding leaves more than 1e-9 of the load. */
#define PENALTY 1e4
#define WEAK 1e-9
enum { ROUNDS = 100 };

/* Lower triangle of K by columns, and the rows: B u <= c. */
typedef struct {
    int64_t n, entries, rows, terms;
    int *ptr, *row, *row_ptr, *dof;
    double *value, *load, *term, *gap;
} Problem;

static void *take(FILE *file, int64_t count, size_t size)
{
    void *values = malloc((size_t)count * size + 1);

    return values && fread(values, size, (size_t)count, file) == (size_t)count ? values : NULL;
}

static int read_problem(const char *path, Problem *p)
{
    FILE *file = fopen(path, "rb");
    int64_t size[2];

    if (!file || fread(size, sizeof *size, 2, file) != 2) return 0;
    p->n = size[0], p->entries = size[1];
    p->ptr = take(file, p->n + 1, sizeof(int)), p->row = take(file, p->entries, sizeof(int));
    p->value = take(file, p->entries, sizeof(double)), p->load = take(file, p->n, sizeof(double));
    if (fread(size, sizeof *size, 2, file) != 2) return 0;
    p->rows = size[0], p->terms = size[1];
    p->row_ptr = take(file, p->rows + 1, sizeof(int)), p->dof = take(file, p->terms, sizeof(int));
    p->term = take(file, p->terms, sizeof(double)), p->gap = take(file, p->rows, sizeof(double));
    fclose(file);
    return p->ptr && p->row && p->value && p->load && p->row_ptr && p->dof && p->term && p->gap;
}

/* The pattern of K and of b b' of all rows, with the values of K. */
static cholmod_sparse *with_rows(const Problem *p, cholmod_common *common)
{
    int64_t most = p->entries;
    cholmod_triplet *all;
    cholmod_sparse *sum;

    for (int64_t i = 0; i < p->rows; i++) {
        const int64_t terms = p->row_ptr[i + 1] - p->row_ptr[i];
        most += terms * terms;
    }
    all = cholmod_allocate_triplet((size_t)p->n, (size_t)p->n, (size_t)most, -1, CHOLMOD_REAL, common);
    if (!all) return NULL;
    int *row = all->i, *column = all->j;
    double *value = all->x;
    for (int j = 0; j < p->n; j++)
        for (int k = p->ptr[j]; k < p->ptr[j + 1]; k++, all->nnz++)
            row[all->nnz] = p->row[k], column[all->nnz] = j, value[all->nnz] = p->value[k];
    for (int64_t i = 0; i < p->rows; i++)
        for (int k = p->row_ptr[i]; k < p->row_ptr[i + 1]; k++)
            for (int l = p->row_ptr[i]; l < p->row_ptr[i + 1]; l++)
                if (p->dof[k] >= p->dof[l])
                    row[all->nnz] = p->dof[k], column[all->nnz] = p->dof[l], value[all->nnz++] = 0.0;
    sum = cholmod_triplet_to_sparse(all, 0, common);
    cholmod_free_triplet(&all, common);
    return sum;
}

static double *entry(cholmod_sparse *a, int row, int column)
{
    const int *ptr = a->p, *index = a->i;
    int low = ptr[column], high = ptr[column + 1];

    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (index[middle] <= row) low = middle; else high = middle;
    }
    return (double *)a->x + low;
}

static double length(const Problem *p, int64_t i, const double *u)
{
    double sum = -p->gap[i];

    for (int k = p->row_ptr[i]; k < p->row_ptr[i + 1]; k++) sum += p->term[k] * u[p->dof[k]];
    return sum;
}

static double larger(double a, double b) { return a > b ? a : b; }

int main(int arguments, char **argument)
{
    const clockid_t cpu = CLOCK_PROCESS_CPUTIME_ID, wall = CLOCK_MONOTONIC;
    double one[2] = { 1.0, 0.0 }, minus[2] = { -1.0, 0.0 }, penetration = HUGE_VAL, equilibrium = HUGE_VAL;
    int factorisations = 0, solutions = 0, solved = 0, changes = 1;
    Problem p = { 0 };
    cholmod_common common;

    if (arguments != 4 || !read_problem(argument[1], &p)) return fail("no problem");
    if (!begin(&common)) return 1;
    back_memory((size_t)p.n * strtoull(argument[3], NULL, 10));
    const double accuracy = strtod(argument[2], NULL), at = seconds(wall), processor = seconds(cpu);
    cholmod_sparse *k = with_rows(&p, &common), *a = k ? cholmod_copy_sparse(k, &common) : NULL;
    cholmod_factor *factor = a ? cholmod_analyze(a, &common) : NULL;
    cholmod_dense *load = cholmod_zeros((size_t)p.n, 1, CHOLMOD_REAL, &common), *u = NULL;
    cholmod_dense *before = cholmod_zeros((size_t)p.n, 1, CHOLMOD_REAL, &common);
    cholmod_dense *rest = cholmod_zeros((size_t)p.n, 1, CHOLMOD_REAL, &common);
    double *penalty = calloc((size_t)p.rows, sizeof *penalty), *force = calloc((size_t)p.rows, sizeof *force);
    char *closed = malloc((size_t)p.rows);
    if (!factor || !load || !before || !rest || !penalty || !force || !closed) return fail("no memory");
    double *diagonal = malloc((size_t)p.n * sizeof *diagonal), loads = 0.0;
    for (int j = 0; j < p.n; j++) diagonal[j] = *entry(k, j, j), loads = larger(loads, fabs(p.load[j]));
    for (int64_t i = 0; i < p.rows; i++) {
        closed[i] = 1;
        for (int l = p.row_ptr[i]; l < p.row_ptr[i + 1]; l++) penalty[i] = larger(penalty[i], PENALTY * diagonal[p.dof[l]]);
    }
    for (int round = 0; round < ROUNDS && !solved; round++) {
        if (changes) {
            memcpy(a->x, k->x, k->nzmax * sizeof(double));
            for (int j = 0; j < p.n; j++) *entry(a, j, j) += WEAK * diagonal[j];
            for (int64_t i = 0; i < p.rows; i++)
                for (int m = p.row_ptr[i]; closed[i] && m < p.row_ptr[i + 1]; m++)
                    for (int l = p.row_ptr[i]; l < p.row_ptr[i + 1]; l++)
                        if (p.dof[m] >= p.dof[l]) *entry(a, p.dof[m], p.dof[l]) += penalty[i] * p.term[m] * p.term[l];
            if (!cholmod_factorize(a, factor, &common) || common.status != CHOLMOD_OK) return fail("no factor");
            factorisations++;
        }
        /* (K + W + sum penalty b b') u = f + W u_before + sum (penalty c - force) b, over the closed rows */
        double *f = load->x;
        for (int j = 0; j < p.n; j++) f[j] = p.load[j] + WEAK * diagonal[j] * ((double *)before->x)[j];
        for (int64_t i = 0; i < p.rows; i++)
            for (int m = p.row_ptr[i]; closed[i] && m < p.row_ptr[i + 1]; m++)
                f[p.dof[m]] += (penalty[i] * p.gap[i] - force[i]) * p.term[m];
        cholmod_free_dense(&u, &common);
        u = cholmod_solve(CHOLMOD_A, factor, load, &common), solutions++;
        if (!u) return fail("no solution");
        /* rows that pull open, rows that penetrate close; forces of an old set are no start for another */
        double size = 0.0, *r = rest->x;
        changes = 0;
        for (int64_t i = 0; i < p.rows; i++) {
            const double over = length(&p, i, u->x);
            const char is_closed = closed[i] ? force[i] + penalty[i] * over > 0.0 : over > 0.0;
            changes += is_closed != closed[i];
            closed[i] = is_closed;
        }
        penetration = 0.0;
        for (int j = 0; j < p.n; j++) size = larger(size, fabs(((double *)u->x)[j])), r[j] = p.load[j];
        for (int64_t i = 0; i < p.rows; i++) {
            const double over = length(&p, i, u->x);
            penetration = larger(penetration, over / size);
            force[i] = changes || !closed[i] ? 0.0 : force[i] + penalty[i] * over;
            for (int m = p.row_ptr[i]; m < p.row_ptr[i + 1]; m++) r[p.dof[m]] -= force[i] * p.term[m];
        }
        cholmod_sdmult(k, 0, minus, one, u, rest, &common);
        equilibrium = cholmod_norm_dense(rest, 0, &common) / loads;
        solved = !changes && penetration <= accuracy && equilibrium <= accuracy;
        memcpy(before->x, u->x, (size_t)p.n * sizeof(double));
    }
    printf("wall %.6f\ncpu %.6f\npeak %.0f\n", seconds(wall) - at, seconds(cpu) - processor, bytes("/proc/self/status", "VmHWM:"));
    printf("factorisations %d\nsolutions %d\nsolved %d\n", factorisations, solutions, solved);
    printf("penetration %.3e\nequilibrium %.3e\n", penetration, equilibrium);
    return 0;
}
