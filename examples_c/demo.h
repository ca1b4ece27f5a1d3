/* What the examples share and a host would not need: stopping on a failed call, printing, the demo line. */
#ifndef DEMO_H
#define DEMO_H

#include <stdint.h>

#include "feti_contact.h"

/* Runs a library call and ends the program with the library's own words when it fails. A host would
   rather go on: after a refused call nothing is lost, the problem can be corrected and solved. */
#define CALL(call) demo_expect((call), #call)
void demo_expect(int32_t status, const char *call);

/* Ends the program with a text. */
void demo_stop(const char *text);

/* Every example takes two arguments: the folder of the data and the folder for pictures. */
const char *demo_data_folder(int argc, char **argv);    /* build/data */
const char *demo_picture_folder(int argc, char **argv); /* build/pictures */

/* n numbers set to zero, or the end of the program. */
void *demo_array(int64_t n, int64_t bytes_each);

/* max |x - ref| / max |ref|: relative error of x against the reference; 0 where there is nothing to compare. */
double demo_error(int64_t n, const double *x, const double *ref);

/* Prints one result: name, value, unit. The Fortran twin prints the same lines. */
void demo_value(const char *name, double value, const char *unit);

/* Prints the demo line and returns the exit code: 0 when the library reports FETI_OK, its certificate
   passes, error <= 1e-7 and the example's own checks hold (ok = 1). */
int demo_line(const char *example, const feti_info *info, double error, int ok);

#endif
