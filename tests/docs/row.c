/* What README.md leaves out around its row of a node and a face. */
#include <stdint.h>
#include <stdio.h>

int main(void);
int main(void)
{
    /* node 1 of body 0 at (.5, .5, 1.25) over a square of body 1 in the plane z = 1 */
    enum { upper = 0, lower = 1, s = 1, nodes = 4, row = 0 };
    const double x[] = { 0, 0, 0, 0.5, 0.5, 1.25 }, x_foot[] = { 0.5, 0.5, 1 }, n[] = { 0, 0, -1 }, w[] = { 0.25, 0.25, 0.25, 0.25 };
    const int32_t face[] = { 4, 5, 7, 6 };
    int32_t row_ptr[2] = { 0, 0 }, body[15], dof[15];
    double coefficient[15], gap[1], sum = 0, most = 0;

#include "fragment_8.inc"

    /* a common motion does not change the gap: the entries sum to 0; a motion of the node by the gap along n closes it */
    for (int32_t at = 0; at < row_ptr[1]; at++) {
        sum += coefficient[at];
        if (body[at] == upper && dof[at] == 5) most = coefficient[at];
    }
    if (row_ptr[1] != 15 || sum != 0 || most != -1 || gap[0] != 0.25) return puts("the row of README.md is wrong"), 1;
    return 0;
}
