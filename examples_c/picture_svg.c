/* An SVG plot of points against curves. */
#include <math.h>
#include <stdio.h>

#include "picture.h"

enum { WIDTH = 720, HEIGHT = 480, LEFT = 80, RIGHT = 20, TOP = 64, BOTTOM = 64, TICKS = 6, COLOURS = 5 };
static const char *const COLOUR[COLOURS] = { "#1f5fa8", "#c03a1d", "#2a8a4a", "#8a4fb0", "#b8860b" };

/* The plotted range: x from low to high over the width, y from bottom <= 0 to top over the height. */
typedef struct {
    double low, high, bottom, top;
} frame;

static double place_x(const frame *range, double x)
{
    return LEFT + (x - range->low) / (range->high - range->low) * (WIDTH - LEFT - RIGHT);
}

static double place_y(const frame *range, double y)
{
    return HEIGHT - BOTTOM - (y - range->bottom) / (range->top - range->bottom) * (HEIGHT - TOP - BOTTOM);
}

/* A round step (1, 2 or 5 times a power of ten) that divides the length into at most TICKS parts. */
static double round_step(double length)
{
    const double step = pow(10.0, floor(log10(length / TICKS)));
    const double parts = length / (TICKS * step);
    return step * (parts <= 1.0 ? 1.0 : parts <= 2.0 ? 2.0 : parts <= 5.0 ? 5.0 : 10.0);
}

/* fmin and fmax leave out what is NaN. */
static void take(frame *range, double x, double y)
{
    range->low = fmin(range->low, x);
    range->high = fmax(range->high, x);
    range->bottom = fmin(range->bottom, y);
    range->top = fmax(range->top, y);
}

static frame range_of(const picture *plot)
{
    frame range = { plot->curve_x[0], plot->curve_x[0], 0.0, 0.0 };
    double step;

    for (int64_t i = 0; i < plot->samples; i++) take(&range, plot->curve_x[i], plot->curve_y[i]);
    for (int64_t i = 0; i < plot->points; i++) take(&range, plot->x[i], plot->y[i]);
    step = round_step(range.top - range.bottom);
    range.top = step * ceil(1.02 * range.top / step);
    range.bottom = step * floor(1.02 * range.bottom / step);
    return range;
}

static void draw_axes(FILE *file, const picture *plot, const frame *range)
{
    const double step_x = round_step(range->high - range->low), step_y = round_step(range->top - range->bottom);
    const double bottom = place_y(range, range->bottom);

    fprintf(file, "<g stroke=\"#ccc\" font-size=\"13\">\n");
    for (double x = step_x * ceil(range->low / step_x); x <= range->high + 1e-9 * step_x; x += step_x)
        fprintf(file, "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%.1f\"/><text x=\"%.1f\" y=\"%.1f\" "
                "text-anchor=\"middle\" stroke=\"none\">%g</text>\n", place_x(range, x), TOP, place_x(range, x), bottom,
                place_x(range, x), bottom + 18.0, fabs(x) < 1e-9 * step_x ? 0.0 : x);
    for (double y = step_y * ceil(range->bottom / step_y); y <= range->top + 1e-9 * step_y; y += step_y)
        fprintf(file, "<line x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/><text x=\"%d\" y=\"%.1f\" "
                "text-anchor=\"end\" stroke=\"none\">%g</text>\n", LEFT, place_y(range, y), WIDTH - RIGHT,
                place_y(range, y), LEFT - 6, place_y(range, y) + 4.0, fabs(y) < 1e-9 * step_y ? 0.0 : y);
    fprintf(file, "</g>\n<text x=\"%d\" y=\"28\" font-size=\"17\" text-anchor=\"middle\">%s</text>\n", WIDTH / 2,
            plot->title);
    fprintf(file, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", (LEFT + WIDTH - RIGHT) / 2,
            HEIGHT - 18, plot->x_name);
    fprintf(file, "<text transform=\"translate(20 %d) rotate(-90)\" text-anchor=\"middle\">%s</text>\n",
            (TOP + HEIGHT - BOTTOM) / 2, plot->y_name);
}

/* Curve and points of one colour each; if there is one curve alone, its points have another. */
static void draw_data(FILE *file, const picture *plot, const frame *range)
{
    const char *const line = "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"";
    int curve = 0, points = plot->names ? 0 : 1;

    fprintf(file, line, COLOUR[0]);
    for (int64_t i = 0; i < plot->samples; i++)
        if (isnan(plot->curve_x[i])) {
            curve++;
            if (i + 1 < plot->samples) fprintf(file, "\"/>\n"), fprintf(file, line, COLOUR[curve % COLOURS]);
        } else {
            fprintf(file, "%.2f,%.2f ", place_x(range, plot->curve_x[i]), place_y(range, plot->curve_y[i]));
        }
    fprintf(file, "\"/>\n");
    for (int64_t i = 0; i < plot->points; i++)
        if (isnan(plot->x[i])) points++;
        else fprintf(file, "<circle fill=\"%s\" cx=\"%.2f\" cy=\"%.2f\" r=\"3.2\"/>\n", COLOUR[points % COLOURS],
                     place_x(range, plot->x[i]), place_y(range, plot->y[i]));
}

/* Points and curve below the axis, beside its name, where no point lies; names of several curves above the axes. */
static void draw_legend(FILE *file, const picture *plot)
{
    const int y = HEIGHT - 18, line = WIDTH - RIGHT - 170;
    int curves = plot->names ? 1 : 0;

    fprintf(file, "<circle cx=\"%d\" cy=\"%d\" r=\"3.2\" fill=\"%s\"/><text x=\"%d\" y=\"%d\">%s</text>\n",
            LEFT + 4, y - 4, curves ? "#444" : COLOUR[1], LEFT + 14, y, plot->points_name);
    fprintf(file, "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"%s\" stroke-width=\"2\"/>"
            "<text x=\"%d\" y=\"%d\">%s</text>\n", line, y - 4, line + 24, y - 4, curves ? "#444" : COLOUR[0], line + 32, y,
            plot->curve_name);
    if (!curves) return;
    for (int64_t i = 0; i + 1 < plot->samples; i++) curves += isnan(plot->curve_x[i]) != 0;
    for (int k = 0; k < curves; k++) {
        const int x = LEFT + k * (WIDTH - LEFT - RIGHT) / curves;
        fprintf(file, "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"%s\" stroke-width=\"2\"/>"
                "<circle cx=\"%d\" cy=\"%d\" r=\"3.2\" fill=\"%s\"/><text x=\"%d\" y=\"%d\">%s</text>\n", x, TOP - 17, x + 24,
                TOP - 17, COLOUR[k % COLOURS], x + 12, TOP - 17, COLOUR[k % COLOURS], x + 32, TOP - 12, plot->names[k]);
    }
}

int picture_svg(const char *folder, const char *name, const picture *plot)
{
    char path[1024];
    FILE *file;
    frame range = range_of(plot);

    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "w");
    if (!file) return -1;
    fprintf(file, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"14\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    draw_axes(file, plot, &range);
    draw_data(file, plot, &range);
    draw_legend(file, plot);
    fprintf(file, "</svg>\n");
    if (fclose(file) != 0) return -1;
    printf("picture %s\n", path);
    return 0;
}
