/* Plain C loops over a two-input table: bins, nearest and bilinear.
 *
 * Reads the table and the points from a file of doubles, repeats each loop and prints the
 * median nanoseconds per point and a sum of the results, so that a caller can see that it
 * has measured the same thing.
 *
 * build: gcc -O3 lookup.c -o lookup
 * file:  rows, columns, points; the row levels, the column levels, the row bins, the column
 *        bins; the table; the first and the second coordinate of every point
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct table {
    int rows, columns;
    const double *row_levels, *column_levels, *row_bins, *column_bins, *values;
};

/* Uneven thresholds: count those that are smaller. */
static int cell_of(const double *bins, int count, double x)
{
    int cell = 0;
    for (int k = 0; k < count; k++)
        cell += bins[k] < x;
    return cell;
}

static void by_bins(const struct table *t, const double *x, const double *y, double *out, int n)
{
    for (int k = 0; k < n; k++) {
        int i = cell_of(t->row_bins, t->rows - 1, x[k]);
        int j = cell_of(t->column_bins, t->columns - 1, y[k]);
        out[k] = t->values[i * t->columns + j];
    }
}

/* Even levels: the place is found by arithmetic. */
static int nearest(double low, double inverse, int count, double x)
{
    double place = (x - low) * inverse + 0.5;
    return (int)(place > 0 ? place < count - 1 ? place : count - 1 : 0);
}

static void by_nearest(const struct table *t, const double *x, const double *y, double *out, int n)
{
    const double a = (t->rows - 1) / (t->row_levels[t->rows - 1] - t->row_levels[0]);
    const double b = (t->columns - 1) / (t->column_levels[t->columns - 1] - t->column_levels[0]);
    for (int k = 0; k < n; k++) {
        int i = nearest(t->row_levels[0], a, t->rows, x[k]);
        int j = nearest(t->column_levels[0], b, t->columns, y[k]);
        out[k] = t->values[i * t->columns + j];
    }
}

static void bilinear(const struct table *t, const double *x, const double *y, double *out, int n)
{
    const double a = (t->rows - 1) / (t->row_levels[t->rows - 1] - t->row_levels[0]);
    const double b = (t->columns - 1) / (t->column_levels[t->columns - 1] - t->column_levels[0]);
    for (int k = 0; k < n; k++) {
        double u = (x[k] - t->row_levels[0]) * a, v = (y[k] - t->column_levels[0]) * b;
        u = u > 0 ? u < t->rows - 1 ? u : t->rows - 1 : 0;
        v = v > 0 ? v < t->columns - 1 ? v : t->columns - 1 : 0;
        int i = (int)u < t->rows - 2 ? (int)u : t->rows - 2;
        int j = (int)v < t->columns - 2 ? (int)v : t->columns - 2;
        u -= i;
        v -= j;
        const double *c = t->values + i * t->columns + j;
        double near = c[0] + v * (c[1] - c[0]);
        double far = c[t->columns] + v * (c[t->columns + 1] - c[t->columns]);
        out[k] = near + u * (far - near);
    }
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    static void (*const loops[3])(const struct table *, const double *, const double *, double *,
                                  int) = {by_bins, by_nearest, bilinear};
    const int repeats = argc > 2 ? atoi(argv[2]) : 9;
    FILE *file = argc > 1 ? fopen(argv[1], "rb") : NULL;
    double head[3], *data, *times = malloc(sizeof(double) * (size_t)repeats);
    if (!file || fread(head, sizeof head, 1, file) != 1)
        return 1;
    const int rows = (int)head[0], columns = (int)head[1], n = (int)head[2];
    const size_t size = (size_t)(2 * (rows + columns) - 2 + rows * columns) + 2 * (size_t)n;
    data = malloc(sizeof(double) * size);
    if (!data || !times || fread(data, sizeof(double), size, file) != size)
        return 1;
    struct table t = {rows, columns, data, NULL, NULL, NULL, NULL};
    t.column_levels = data + rows;
    t.row_bins = t.column_levels + columns;
    t.column_bins = t.row_bins + rows - 1;
    t.values = t.column_bins + columns - 1;
    const double *x = t.values + rows * columns, *y = x + n;
    double *out = malloc(sizeof(double) * (size_t)n);
    if (!out)
        return 1;
    memset(out, 0, sizeof(double) * (size_t)n);
    for (int loop = 0; loop < 3; loop++) {
        double sum = 0;
        for (int r = 0; r < repeats; r++) {
            const double begin = now();
            loops[loop](&t, x, y, out, n);
            times[r] = now() - begin;
        }
        for (int k = 0; k < n; k++)
            sum += out[k];
        qsort(times, (size_t)repeats, sizeof(double), compare);
        printf("%.6f %.17g\n", 1e9 * times[repeats / 2] / n, sum);
    }
    return 0;
}
