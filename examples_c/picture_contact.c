#include <math.h>
#include <stdlib.h>

#include "picture.h"

enum { SAMPLES = 200 }; /* along each side of a contact surface in space */

/* A row as its node sees it. */
typedef struct {
    int64_t node, own, other; /* node of all bodies; the two bodies */
    double factor;            /* force on the node over that of the row */
} place;

static int64_t body_of(const case_data *data, int64_t unknown)
{
    int64_t b = data->bodies - 1;
    while (data->body[b].first > unknown) b--;
    return b;
}

/* Has the row entries on one node only of this body? */
static int has_one_node(const case_data *data, int32_t dims, int64_t row, int64_t body)
{
    int64_t node = -1;
    for (int32_t e = data->contact.row_ptr[row]; e < data->contact.row_ptr[row + 1]; e++) {
        const int64_t unknown = data->contact.col[e];
        if (body_of(data, unknown) != body) continue;
        if (node >= 0 && node != unknown / dims) return 0;
        node = unknown / dims;
    }
    return node >= 0;
}

static place place_of(const case_data *data, int32_t dims, int64_t row)
{
    const int32_t from = data->contact.row_ptr[row], to = data->contact.row_ptr[row + 1];
    place at = { -1, -1, -1, 0.0 };
    double square = 0.0;

    for (int32_t e = from; e < to && at.own < 0; e++)
        if (has_one_node(data, dims, row, body_of(data, data->contact.col[e]))) at.own = body_of(data, data->contact.col[e]);
    for (int32_t e = from; e < to; e++) {
        const int64_t unknown = data->contact.col[e], body = body_of(data, unknown);
        if (body != at.own) at.other = body;
        else at.node = unknown / dims, square += data->contact.val[e] * data->contact.val[e];
    }
    at.factor = sqrt(square);
    return at;
}

/* In the plane: half way to the neighbours of the same pair of bodies along x. */
static void lengths(const case_data *data, int64_t rows, const place *at, double *area)
{
    for (int64_t r = 0; r < rows; r++) {
        const double x = data->xyz[3 * 2 * at[r].node];
        double left = x, right = x;
        for (int64_t s = 0; s < rows; s++) {
            const double y = data->xyz[3 * 2 * at[s].node];
            if (at[s].own != at[r].own || at[s].other != at[r].other) continue;
            if (y < x && (left == x || y > left)) left = y;
            if (y > x && (right == x || y < right)) right = y;
        }
        area[r] = (right - left) / 2.0;
    }
}

/* In space, on a surface z = const: samples of the rectangle around the nodes of a pair of bodies go to the nearest of them. */
static void areas(const case_data *data, int64_t rows, const place *at, double *area)
{
    for (int64_t r = 0; r < rows; r++) area[r] = 0.0;
    for (int64_t first = 0; first < rows; first++) {
        double low[2] = { HUGE_VAL, HUGE_VAL }, high[2] = { -HUGE_VAL, -HUGE_VAL };
        int seen = 0;
        for (int64_t r = 0; r < rows; r++) {
            if (at[r].own != at[first].own || at[r].other != at[first].other) continue;
            seen = seen || r < first;
            for (int k = 0; k < 2; k++) {
                const double x = data->xyz[3 * 3 * at[r].node + k];
                low[k] = fmin(low[k], x), high[k] = fmax(high[k], x);
            }
        }
        if (seen) continue;
        const double sample = (high[0] - low[0]) * (high[1] - low[1]) / ((double)SAMPLES * SAMPLES);
        for (int i = 0; i < SAMPLES * SAMPLES; i++) {
            const double x = low[0] + (high[0] - low[0]) * (i % SAMPLES + 0.5) / SAMPLES;
            const double y = low[1] + (high[1] - low[1]) * (i / SAMPLES + 0.5) / SAMPLES;
            double least = HUGE_VAL;
            int64_t nearest = first;
            for (int64_t r = first; r < rows; r++) {
                const double *p = data->xyz + 3 * 3 * at[r].node;
                const double square = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
                if (at[r].own == at[first].own && at[r].other == at[first].other && square < least) least = square, nearest = r;
            }
            area[nearest] += sample;
        }
    }
}

int picture_contact_of(const case_data *data, int32_t dims, const double *lambda, const double *slack, const int32_t *state,
                       picture_contact *out)
{
    const int64_t nodes = data->unknowns / dims, rows = data->rows;
    place *at = malloc((size_t)(rows + 1) * sizeof *at);
    double *area = malloc((size_t)(rows + 1) * sizeof *area);

    out->pressure = malloc((size_t)(3 * nodes) * sizeof *out->pressure);
    if (out->pressure && at && area) {
        out->gap = out->pressure + nodes, out->state = out->pressure + 2 * nodes;
        for (int64_t i = 0; i < nodes; i++) out->pressure[i] = 0.0, out->gap[i] = NAN, out->state[i] = -1.0;
        for (int64_t r = 0; r < rows; r++) at[r] = place_of(data, dims, r);
        if (dims == 2) lengths(data, rows, at, area);
        else areas(data, rows, at, area);
        for (int64_t r = 0; r < rows; r++) {
            if (at[r].node < 0) continue;
            out->pressure[at[r].node] = area[r] > 0.0 ? lambda[r] * at[r].factor / area[r] : 0.0;
            out->gap[at[r].node] = slack[r], out->state[at[r].node] = state[r];
        }
    }
    const int failed = !out->pressure || !at || !area;
    free(at);
    free(area);
    if (failed) picture_contact_free(out);
    return failed ? -1 : 0;
}

void picture_contact_free(picture_contact *contact)
{
    free(contact->pressure);
    contact->pressure = contact->gap = contact->state = NULL;
}
