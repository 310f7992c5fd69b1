/* A plain C loop: a controller on the two-link arm, payload from the second segment on.
 *
 * CONTROL chooses it: PD, CT, FFID, CDID (by default), ACDID, MRAC, DAC, LUT, CDID_LUT,
 * SOC, DIRECT, STFC, CFAF, HFIE. Those with rules or tables include closed_loop_data.h, which
 * closed_loop.py writes from the same files that fuzzyarm reads.
 *
 * Three segments of 5 s (there, back, hold), a set point every 3 ms, five control
 * iterations each: 25005 control steps, double precision. Prints the least processor time of
 * a run in seconds and the RMS errors in degrees, so that a caller can see that it has
 * measured the same thing.
 *
 * build: gcc -O3 -DCONTROL=CDID closed_loop.c -lm
 * with -DEXACT for the exact centroid in place of that of 101 samples, and with -DASKING if
 * sets that did not fire are to be skipped
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define DEGREES (180.0 / PI)

struct arm { double p[7], motor; };

static struct arm make(double m1, double m2, double x1, double x2, double i1, double i2,
                       double motor)
{
    const double l = 0.26, g = 9.8;
    struct arm a = {{i1 + i2 + m2 * (x2 * x2 + l * l) + m1 * x1 * x1, 2.0 * m2 * l * x2,
                     m2 * x2 * x2 + i2, 2.5, 2.5, g * (m1 * x1 + m2 * l), m2 * x2 * g}, motor};
    return a;
}

enum { PD, CT, FFID, CDID, ACDID, MRAC, DAC, LUT, CDID_LUT, SOC, DIRECT, STFC, CFAF, HFIE };
#ifndef CONTROL
#define CONTROL CDID
#endif
#ifdef WITH_DATA
#include "closed_loop_data.h"
#endif

/* What a controller is told: set point, state, and the cosines that many laws share. */
struct now { double qd[2], vd[2], ad[2], q[2], v[2], c1, s2, c2, c12; int last; };

static const double step = 0.0006;

static void dynamics(const double *m, double motor, const struct now *x, const double vr[2],
                     const double ar[2], double torque[2])
{
    const double s2 = x->s2, c2 = x->c2;
    torque[0] = (m[0] + m[1] * c2 + motor) * ar[0] + (m[2] + 0.5 * m[1] * c2) * ar[1]
        + (m[3] - m[1] * s2 * x->v[1]) * vr[0] - 0.5 * m[1] * s2 * x->v[1] * vr[1]
        + m[5] * x->c1 + m[6] * x->c12;
    torque[1] = (m[2] + 0.5 * m[1] * c2) * ar[0] + (m[2] + motor) * ar[1]
        + 0.5 * m[1] * s2 * x->v[0] * vr[0] + m[4] * vr[1] + m[6] * x->c12;
}

static void pd(const struct now *x, double torque[2])
{
    for (int i = 0; i < 2; i++)
        torque[i] = 50.0 * (x->vd[i] - x->v[i]) + 100.0 * (x->qd[i] - x->q[i]);
}

static void ct(const struct now *x, const struct arm *model, double torque[2])
{
    double ar[2];
    for (int i = 0; i < 2; i++)
        ar[i] = x->ad[i] + 50.0 * (x->vd[i] - x->v[i]) + 100.0 * (x->qd[i] - x->q[i]);
    dynamics(model->p, 0.0, x, x->v, ar, torque);
}

static void ffid(const struct now *x, const struct arm *model, double torque[2])
{
    double feedback[2];
    dynamics(model->p, 0.0, x, x->vd, x->ad, torque);
    pd(x, feedback);
    torque[0] += feedback[0];
    torque[1] += feedback[1];
}

static void sliding(const struct now *x, double vr[2], double ar[2])
{
    for (int i = 0; i < 2; i++) {
        vr[i] = x->vd[i] + 100.0 * (x->qd[i] - x->q[i]);
        ar[i] = x->ad[i] + 100.0 * (x->vd[i] - x->v[i]);
    }
}

static void cdid(const struct now *x, const struct arm *model, double torque[2])
{
    double vr[2], ar[2];
    sliding(x, vr, ar);
    dynamics(model->p, 0.0, x, vr, ar, torque);
    torque[0] += 50.0 * (vr[0] - x->v[0]);
    torque[1] += 50.0 * (vr[1] - x->v[1]);
}

static void acdid(const struct now *x, double p[7], double torque[2])
{
    double vr[2], ar[2];
    sliding(x, vr, ar);
    dynamics(p, 0.1498, x, vr, ar, torque);
    const double e1 = x->v[0] - vr[0], e2 = x->v[1] - vr[1];
    torque[0] -= 50.0 * e1;
    torque[1] -= 50.0 * e2;
    const double rate = 100.0 * step;
    const double w12 = x->c2 * (ar[0] + 0.5 * ar[1])
        - 0.5 * x->s2 * x->v[1] * (vr[0] + vr[1]) - 0.5 * x->s2 * x->v[0] * vr[1];
    const double w22 = 0.5 * (x->c2 * vr[0] + x->s2 * x->v[0] * vr[0]);
    p[0] -= rate * (ar[0] * e1);
    p[1] -= rate * (w12 * e1 + w22 * e2);
    p[2] -= rate * (ar[1] * e1 + (ar[0] + ar[1]) * e2);
    p[3] -= rate * (vr[0] * e1);
    p[4] -= rate * (vr[1] * e2);
    p[5] -= rate * (x->c1 * e1);
    p[6] -= rate * (x->c12 * (e1 + e2));
}

static void mrac(const struct now *x, const struct arm *model, double gain[3][2][2],
                 double torque[2])
{
    const double k1 = 500.0, k2 = 100.0, p2 = 0.5 / k1, p3 = (1.0 + 2.0 * p2) / (2.0 * k2);
    double in[2], u[2], w[2], zero[2] = {0, 0}, gravity[2], rest[2];
    for (int i = 0; i < 2; i++) {
        in[i] = x->ad[i] + k2 * x->vd[i] + k1 * x->qd[i];
        w[i] = p2 * (x->qd[i] - x->q[i]) + p3 * (x->vd[i] - x->v[i]);
    }
    for (int i = 0; i < 2; i++) {
        u[i] = in[i] - k1 * x->q[i] - k2 * x->v[i];
        for (int j = 0; j < 2; j++)
            u[i] += gain[2][i][j] * in[j] - gain[0][i][j] * x->q[j] - gain[1][i][j] * x->v[j];
    }
    const double *m = model->p;
    const double coupling = m[2] + 0.5 * m[1] * x->c2;
    gravity[0] = m[5] * x->c1 + m[6] * x->c12;
    gravity[1] = m[6] * x->c12;
    rest[0] = (m[0] + m[1] * x->c2 + 0.1498) * x->ad[0] + coupling * x->ad[1];
    rest[1] = coupling * x->ad[0] + (m[2] + 0.1498) * x->ad[1];
    for (int i = 0; i < 2; i++) {
        torque[i] = u[i] + gravity[i] + m[3 + i] * x->vd[i] + rest[i] + zero[i];
        for (int j = 0; j < 2; j++) {
            gain[0][i][j] -= 100.0 * step * w[i] * x->q[j];
            gain[1][i][j] -= 100.0 * step * w[i] * x->v[j];
            gain[2][i][j] += 2.0 * step * w[i] * in[j];
        }
    }
}

static void dac(const struct now *x, double sum[2][4], double torque[2])
{
    const double c[2] = {1.1, 1.6};
    for (int i = 0; i < 2; i++) {
        const double e = x->qd[i] - x->q[i], d = x->vd[i] - x->v[i];
        const double r = 1650.0 * e + 50.0 * d, direct = fabs(r) * r;
        const double with[4] = {1.0, e, d, x->ad[i]};
        torque[i] = 0.0;
        for (int k = 0; k < 4; k++) {
            sum[i][k] += r * with[k] * step;
            torque[i] += (c[i] * sum[i][k] + direct * with[k]) * with[k];
        }
    }
}

static double motor(double control, double velocity, double ratio)
{
    return (20.0 * control / 6.0 - 0.066 * (velocity * ratio)) * 0.066 / 2.32 * ratio;
}

static const double ratios[2] = {80.0, 70.0};

#ifdef WITH_DATA
static int cell(double value)
{
    int k = 0;
    while (k < 12 && bins[k] < value)
        k++;
    return k;
}

static void scaled(const struct now *x, int i, double fine, double *e, double *ce)
{
    *e = (x->qd[i] - x->q[i]) * (fine / PI);
    *ce = (x->vd[i] - x->v[i]) * (10.8 / PI);
}

static void lut(const struct now *x, double torque[2])
{
    for (int i = 0; i < 2; i++) {
        double e, ce;
        scaled(x, i, 108.0, &e, &ce);
        torque[i] = motor(control_table[cell(e)][cell(ce)], x->v[i], ratios[i]);
    }
}

struct soc { double table[2][13][13]; long visits[2][13][13]; int row[2], column[2]; };

static void soc(const struct now *x, struct soc *s, double torque[2])
{
    for (int i = 0; i < 2; i++) {
        double e, ce;
        scaled(x, i, 1080.0, &e, &ce);
        const int row = cell(e), column = cell(ce);
        if (s->row[i] >= 0) {
            double *was = &s->table[i][s->row[i]][s->column[i]];
            *was = fmax(-6.0, fmin(6.0, *was + performance_table[row][column]));
        }
        s->row[i] = row;
        s->column[i] = column;
        s->visits[i][row][column]++;
        torque[i] = motor(s->table[i][row][column], x->v[i], ratios[i]);
    }
}

#ifndef EXACT
static double trapezoid(const double p[4], double x)
{
    if (x < p[0] || x > p[3])
        return 0.0;
    if (x < p[1])
        return (x - p[0]) / (p[1] - p[0]);
    return x <= p[2] ? 1.0 : (p[3] - x) / (p[3] - p[2]);
}
#endif

#ifdef EXACT
#ifdef ASKING
#define ASK(height) if ((height) <= 0.0) continue;
#else
#define ASK(height)
#endif

/* The two terms that hold at x, from `first` on, and their degrees along straight lines. */
static int held(const struct cell *cells, double x, double degree[2])
{
    const int at = (int)((x + 6.0) * (CELLS / 12.0)), k = at < CELLS ? at : CELLS - 1;
    for (int i = 0; i < 2; i++) {
        const double *line = cells[k].line[i];
        degree[i] = line[0] + (x - line[1]) * line[2];
    }
    return cells[k].first;
}

static void add(const double p[6], double height, double *area, double *moment)
{
    const double x = height < p[0] ? height : p[0];
    *area += x * (p[1] + p[2] * x);
    *moment += x * (p[3] + x * (p[4] + p[5] * x));
}

/* min, min, max, exact centroid: the four rules that fire, the sets that they cut, less the
   overlaps of neighbours; areas and moments are polynomials of the heights. */
static double infer(const struct rules *r, double e, double ce)
{
    double on_e[2], on_ce[2], strength[7] = {0}, moment = 0.0, area = 0.0;
    e = e < -6.0 ? -6.0 : e > 6.0 ? 6.0 : e;
    ce = ce < -6.0 ? -6.0 : ce > 6.0 ? 6.0 : ce;
    const int row = held(r->e, e, on_e), column = held(r->ce, ce, on_ce);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            const double both = on_e[i] < on_ce[j] ? on_e[i] : on_ce[j];
            const int then = r->then[row + i][column + j];
            if (both > strength[then])
                strength[then] = both;
        }
    for (int k = 0; k < 7; k++) {
        ASK(strength[k])
        add(r->set[k], strength[k], &area, &moment);
    }
    for (int k = 0; k < 6; k++) {
        const double both = strength[k] < strength[k + 1] ? strength[k] : strength[k + 1];
        ASK(both)
        add(r->overlap[k], both, &area, &moment);
    }
    return r->centre + moment / area;
}
#else
/* min, min, max, centroid over 101 samples; the samples of the sets are made once. */
static double infer(const struct rules *r, double e, double ce)
{
    double on_e[7], on_ce[7], strength[7] = {0}, moment = 0.0, area = 0.0, height[101] = {0};
    e = fmax(-6.0, fmin(6.0, e));
    ce = fmax(-6.0, fmin(6.0, ce));
    for (int i = 0; i < 7; i++) {
        on_e[i] = trapezoid(r->e[i], e);
        on_ce[i] = trapezoid(r->ce[i], ce);
    }
    for (int i = 0; i < 7; i++) {
        if (on_e[i] == 0.0)
            continue;
        for (int j = 0; j < 7; j++) {
            const double both = on_e[i] < on_ce[j] ? on_e[i] : on_ce[j];
            const int then = r->then[i][j];
            if (both > strength[then])
                strength[then] = both;
        }
    }
    for (int k = 0; k < 7; k++) {
        if (strength[k] == 0.0)
            continue;
        for (int i = r->first[k]; i < r->stop[k]; i++) {
            const double y = strength[k] < r->set[k][i] ? strength[k] : r->set[k][i];
            if (y > height[i])
                height[i] = y;
        }
    }
    for (int i = 0; i < 101; i++) {
        moment += r->at[i] * height[i];
        area += height[i];
    }
    return moment / area;
}
#endif

static void ruled(const struct now *x, double sum[2], double torque[2])
{
    for (int i = 0; i < 2; i++) {
        double e, ce, u = CONTROL == STFC || CONTROL == CFAF ? 3.0 : 1.0;
        scaled(x, i, 1080.0, &e, &ce);
        if (CONTROL == CFAF && fabs(e) <= 3.0 && fabs(ce) <= 3.0) {
            e *= 2.0;
            ce *= 2.0;
        }
        u *= infer(&control_rules, e, ce);
        if (CONTROL == STFC || CONTROL == CFAF)
            u *= infer(&alpha_rules, e, ce);
        torque[i] = motor(u, x->v[i], ratios[i]);
        if (CONTROL == HFIE) {
            sum[i] += x->qd[i] - x->q[i];
            torque[i] += 1500.0 * sum[i];
            if (x->last)
                sum[i] = 0.0;
        }
    }
}
#endif

struct memory {
    double p[7], gain[3][2][2], sum[2], dac[2][4];
#ifdef WITH_DATA
    struct soc soc;
#endif
};

static void control(const struct now *x, const struct arm *model, struct memory *own,
                    double torque[2])
{
#if defined WITH_DATA
    if (CONTROL == LUT)
        lut(x, torque);
    else if (CONTROL == SOC)
        soc(x, &own->soc, torque);
    else if (CONTROL == CDID_LUT) {
        double more[2];
        cdid(x, model, torque);
        lut(x, more);
        for (int i = 0; i < 2; i++) {
            own->sum[i] += x->qd[i] - x->q[i];
            torque[i] += more[i] + 50.0 * own->sum[i];
        }
    } else
        ruled(x, own->sum, torque);
#else
    if (CONTROL == PD)
        pd(x, torque);
    else if (CONTROL == CT)
        ct(x, model, torque);
    else if (CONTROL == FFID)
        ffid(x, model, torque);
    else if (CONTROL == ACDID)
        acdid(x, own->p, torque);
    else if (CONTROL == MRAC)
        mrac(x, model, own->gain, torque);
    else if (CONTROL == DAC)
        dac(x, own->dac, torque);
    else
        cdid(x, model, torque);
#endif
}

static void run(double rms[2])
{
    const double segment = 5.0;
    const double goal[2] = {90.0 / DEGREES, -90.0 / DEGREES};
    const struct arm exact = make(2, 2, 0.13, 0.14, 0.09, 0.09, 0.0);
    struct arm guess = make(1, 1, 0.11, 0.12, 0.05, 0.05, 0.0);
    const struct arm light = make(2, 2, 0.13, 0.14, 0.09, 0.09, 0.1498);
    const struct arm heavy = make(3, 3, 0.15, 0.16, 1.5, 0.09, 0.1498);
    struct memory own;
    struct now x;
    double sum[2] = {0, 0};
    int samples = 0;

    guess.p[3] = guess.p[4] = 2.0;
    const struct arm *model = CONTROL == MRAC ? &guess : &exact;
    memset(&x, 0, sizeof x);
    memset(&own, 0, sizeof own);
    memcpy(own.p, guess.p, sizeof own.p);
#ifdef WITH_DATA
    own.soc.row[0] = own.soc.row[1] = -1;
#endif
    for (int part = 0; part < 3; part++) {
        const struct arm arm = part == 0 ? light : heavy;
        const double from = part == 1 ? 1.0 : 0.0, to = part == 0 ? 1.0 : 0.0;
        double t = 0.0;
        while (t <= segment) {
            for (int i = 0; i < 2; i++) {
                const double a0 = from * goal[i], way = (to - from) * goal[i];
                const double cubed = segment * segment * segment;
                const double a3 = 10.0 * way / cubed;
                const double a4 = -15.0 * way / (cubed * segment);
                const double a5 = 6.0 * way / (cubed * segment * segment);
                x.qd[i] = a0 + a3 * t * t * t + a4 * t * t * t * t + a5 * t * t * t * t * t;
                x.vd[i] = 3.0 * a3 * t * t + 4.0 * a4 * t * t * t + 5.0 * a5 * t * t * t * t;
                x.ad[i] = 6.0 * a3 * t + 12.0 * a4 * t * t + 20.0 * a5 * t * t * t;
            }
            t += 0.003;
            for (int k = 0; k < 5; k++) {
                double torque[2];
                x.s2 = sin(x.q[1]);
                x.c2 = cos(x.q[1]);
                x.c1 = cos(x.q[0]);
                x.c12 = cos(x.q[0] + x.q[1]);
                x.last = k == 4;
                control(&x, model, &own, torque);
                const double *p = arm.p;
                const double f1 = torque[0]
                    - ((p[3] - p[1] * x.s2 * x.v[1]) * x.v[0] - 0.5 * p[1] * x.s2 * x.v[1] * x.v[1]
                       + p[5] * x.c1 + p[6] * x.c12);
                const double f2 = torque[1]
                    - (0.5 * p[1] * x.s2 * x.v[0] * x.v[0] + p[4] * x.v[1] + p[6] * x.c12);
                const double m11 = p[0] + p[1] * x.c2 + arm.motor;
                const double m12 = p[2] + 0.5 * p[1] * x.c2;
                const double m22 = p[2] + arm.motor;
                const double determinant = m11 * m22 - m12 * m12;
                const double a[2] = {(f1 * m22 - f2 * m12) / determinant,
                                     (f2 * m11 - f1 * m12) / determinant};
                if (k == 4) {
                    for (int i = 0; i < 2; i++)
                        sum[i] += (x.qd[i] - x.q[i]) * (x.qd[i] - x.q[i]);
                    samples++;
                }
                for (int i = 0; i < 2; i++) {
                    x.v[i] += a[i] * step;
                    x.q[i] += x.v[i] * step + 0.5 * a[i] * step * step;
                }
            }
        }
    }
    rms[0] = sqrt(sum[0] / samples) * DEGREES;
    rms[1] = sqrt(sum[1] / samples) * DEGREES;
}

int main(int count, char **words)
{
    const int rounds = count > 1 ? atoi(words[1]) : 50;
    double *seconds = malloc(sizeof(double) * (size_t)rounds), rms[2];
    if (!seconds || rounds < 1)
        return 1;
    for (int i = 0; i < rounds; i++) {
        struct timespec a, b;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &a);
        run(rms);
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &b);
        seconds[i] = (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec);
    }
    for (int i = 1; i < rounds; i++)
        seconds[0] = fmin(seconds[0], seconds[i]);
    printf("%.9f %.12g %.12g\n", seconds[0], rms[0], rms[1]);
    free(seconds);
    return 0;
}
