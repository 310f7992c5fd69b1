/* A plain C loop: CDID on the two-link arm, payload from the second segment on.
 *
 * Three segments of 5 s (there, back, hold), a set point every 3 ms, five control
 * iterations each: 25005 control steps, double precision. Prints the median time of a
 * run in seconds and the RMS errors in degrees, so that a caller can see that it has
 * measured the same thing.
 *
 * build: gcc -O2 closed_loop.c -lm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define DEGREES (180.0 / 3.14159265358979323846)

struct arm { double p[7], motor; };

static struct arm make(double m1, double m2, double x1, double x2, double i1, double i2,
                       double motor)
{
    const double l = 0.26, g = 9.8;
    struct arm a = {{i1 + i2 + m2 * (x2 * x2 + l * l) + m1 * x1 * x1, 2.0 * m2 * l * x2,
                     m2 * x2 * x2 + i2, 2.5, 2.5, g * (m1 * x1 + m2 * l), m2 * x2 * g}, motor};
    return a;
}

static void run(double rms[2])
{
    const double step = 0.0006, lambda = 100.0, kd = 50.0, segment = 5.0;
    const double goal[2] = {90.0 / DEGREES, -90.0 / DEGREES};
    const struct arm model = make(2, 2, 0.13, 0.14, 0.09, 0.09, 0.0);
    const struct arm light = make(2, 2, 0.13, 0.14, 0.09, 0.09, 0.1498);
    const struct arm heavy = make(3, 3, 0.15, 0.16, 1.5, 0.09, 0.1498);
    double q[2] = {0, 0}, v[2] = {0, 0}, sum[2] = {0, 0};
    int samples = 0;

    for (int part = 0; part < 3; part++) {
        const struct arm arm = part == 0 ? light : heavy;
        const double from = part == 1 ? 1.0 : 0.0, to = part == 0 ? 1.0 : 0.0;
        double t = 0.0;
        while (t <= segment) {
            double qd[2], vd[2], ad[2];
            for (int i = 0; i < 2; i++) {
                const double a0 = from * goal[i], way = (to - from) * goal[i];
                const double cubed = segment * segment * segment;
                const double a3 = 10.0 * way / cubed;
                const double a4 = -15.0 * way / (cubed * segment);
                const double a5 = 6.0 * way / (cubed * segment * segment);
                qd[i] = a0 + a3 * t * t * t + a4 * t * t * t * t + a5 * t * t * t * t * t;
                vd[i] = 3.0 * a3 * t * t + 4.0 * a4 * t * t * t + 5.0 * a5 * t * t * t * t;
                ad[i] = 6.0 * a3 * t + 12.0 * a4 * t * t + 20.0 * a5 * t * t * t;
            }
            t += 0.003;
            for (int k = 0; k < 5; k++) {
                const double s2 = sin(q[1]), c2 = cos(q[1]);
                const double c1 = cos(q[0]), c12 = cos(q[0] + q[1]);
                const double e[2] = {qd[0] - q[0], qd[1] - q[1]};
                const double vr[2] = {vd[0] + lambda * e[0], vd[1] + lambda * e[1]};
                const double ar[2] = {ad[0] + lambda * (vd[0] - v[0]),
                                      ad[1] + lambda * (vd[1] - v[1])};
                const double *m = model.p;
                const double torque1 =
                    (m[0] + m[1] * c2) * ar[0] + (m[2] + 0.5 * m[1] * c2) * ar[1]
                    + (m[3] - m[1] * s2 * v[1]) * vr[0] - 0.5 * m[1] * s2 * v[1] * vr[1]
                    + m[5] * c1 + m[6] * c12 + kd * (vr[0] - v[0]);
                const double torque2 =
                    (m[2] + 0.5 * m[1] * c2) * ar[0] + m[2] * ar[1]
                    + 0.5 * m[1] * s2 * v[0] * vr[0] + m[4] * vr[1] + m[6] * c12
                    + kd * (vr[1] - v[1]);
                const double *p = arm.p;
                const double f1 = torque1
                    - ((p[3] - p[1] * s2 * v[1]) * v[0] - 0.5 * p[1] * s2 * v[1] * v[1]
                       + p[5] * c1 + p[6] * c12);
                const double f2 = torque2
                    - (0.5 * p[1] * s2 * v[0] * v[0] + p[4] * v[1] + p[6] * c12);
                const double m11 = p[0] + p[1] * c2 + arm.motor;
                const double m12 = p[2] + 0.5 * p[1] * c2;
                const double m22 = p[2] + arm.motor;
                const double determinant = m11 * m22 - m12 * m12;
                const double a[2] = {(f1 * m22 - f2 * m12) / determinant,
                                     (f2 * m11 - f1 * m12) / determinant};
                if (k == 4) {
                    sum[0] += e[0] * e[0];
                    sum[1] += e[1] * e[1];
                    samples++;
                }
                for (int i = 0; i < 2; i++) {
                    v[i] += a[i] * step;
                    q[i] += v[i] * step + 0.5 * a[i] * step * step;
                }
            }
        }
    }
    rms[0] = sqrt(sum[0] / samples) * DEGREES;
    rms[1] = sqrt(sum[1] / samples) * DEGREES;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int count, char **words)
{
    const int rounds = count > 1 ? atoi(words[1]) : 50;
    double *seconds = malloc(sizeof(double) * (size_t)rounds), rms[2];
    if (!seconds || rounds < 1)
        return 1;
    for (int i = 0; i < rounds; i++) {
        struct timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        run(rms);
        clock_gettime(CLOCK_MONOTONIC, &b);
        seconds[i] = (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec);
    }
    qsort(seconds, (size_t)rounds, sizeof(double), ascending);
    printf("%.9f %.12g %.12g\n", seconds[rounds / 2], rms[0], rms[1]);
    free(seconds);
    return 0;
}
