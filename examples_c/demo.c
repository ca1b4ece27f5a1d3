#include "demo.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void demo_expect(int32_t status, const char *call)
{
    char text[512];
    if (status == FETI_OK) return;
    feti_last_error(text, sizeof text);
    fprintf(stderr, "%s\n  -> %s: %s\n", call, feti_status_name(status), text);
    exit(1);
}

void demo_stop(const char *text)
{
    fprintf(stderr, "%s\n", text);
    exit(1);
}

const char *demo_data_folder(int argc, char **argv)
{
    return argc > 1 ? argv[1] : "build/data";
}

const char *demo_picture_folder(int argc, char **argv)
{
    return argc > 2 ? argv[2] : "build/pictures";
}

void *demo_array(int64_t n, int64_t bytes_each)
{
    void *array = calloc((size_t)n + 1, (size_t)bytes_each);
    if (!array) demo_stop("out of memory");
    return array;
}

double demo_error(int64_t n, const double *x, const double *ref)
{
    double difference = 0.0, size = 0.0;
    for (int64_t i = 0; i < n; i++) {
        difference = fmax(difference, fabs(x[i] - ref[i]));
        size = fmax(size, fabs(ref[i]));
    }
    return size > 0.0 ? difference / size : difference;
}

void demo_value(const char *name, double value, const char *unit)
{
    printf("%-32s%16.6f %s\n", name, value, unit);
}

int demo_line(const char *example, const feti_info *info, double error, int ok)
{
    const double entry[] = { info->equilibrium, info->balance, info->penetration, info->equality,
                             info->negative_force, info->complementarity, info->duality_gap, info->friction_cone,
                             info->friction_work, info->friction_stick };
    double largest = 0.0;

    for (size_t k = 0; k < sizeof entry / sizeof entry[0]; k++) largest = fmax(largest, entry[k]);
    ok = ok && info->status == FETI_OK && info->worst <= 1.0 && error <= 1e-7;
    printf("demo %s c unknowns %lld rows %lld active %lld certificate %.1e error %.1e seconds %.3f %s\n",
           example, (long long)info->dofs, (long long)info->rows, (long long)info->active, largest, error,
           info->seconds_setup + info->seconds_solve, ok ? "ok" : "short");
    return ok ? 0 : 1;
}
