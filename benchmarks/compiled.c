/* Fuzzy inference by hand, with the exact centroid: what compiled rule bases are held against.
 *
 * Two controllers of two inputs and 49 rules (min, max, centroid):
 *   even()      seven evenly spaced triangles for every variable, each foot under the
 *               neighbour's peak: two terms hold at a place, so four rules fire;
 *   straight()  any piecewise-linear terms: breakpoints of the clipped sets, sorted.
 * Built as a shared library with -O3, once more with -DASKING; compiled.py hands both the same points as fuzzyarm.
 */
enum { TERMS = 7, CORNERS = 8, MOST = 256 };

static double least(double a, double b) { return a < b ? a : b; }
static double greatest(double a, double b) { return a > b ? a : b; }

#ifdef ASKING
#define ASK(height) if ((height) <= 0.0) continue;
#else
#define ASK(height)
#endif

/* ---- strong partitions of equal triangles ------------------------------------------- */

/* The left of the two terms that hold at x, and the degree of the right one. */
static int cell(double x, double low, double spacing, double *share)
{
    double at = (x - low) / spacing;
    int left;

    at = least(greatest(at, 0.0), TERMS - 1.0);
    left = (int)least(at, TERMS - 2.0);
    *share = at - left;
    return left;
}

void even(const double *e, const double *ce, double *u, long points, const int *rules,
          double low, double high)
{
    const double spacing = (high - low) / (TERMS - 1);

    for (long p = 0; p < points; p++) {
        double height[TERMS] = {0.0}, area = 0.0, moment = 0.0, right, below;
        const int row = cell(e[p], low, spacing, &right);
        const int column = cell(ce[p], low, spacing, &below);
        const double row_degree[2] = {1.0 - right, right};
        const double column_degree[2] = {1.0 - below, below};

        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) {
                const int then = rules[TERMS * (row + i) + column + j];
                height[then] = greatest(height[then], least(row_degree[i], column_degree[j]));
            }
        /* Clipped triangles in units of the spacing, less the overlaps of neighbours. To ask
         * whether a term fired pays where points that are neighbours follow each other; the
         * processor guesses wrong where they are random. */
        for (int k = 1; k < TERMS - 1; k++) {
            ASK(height[k])
            const double a = height[k] * (2.0 - height[k]);
            area += a;
            moment += a * k;
        }
        for (int k = 0; k < TERMS - 1; k++) {
            ASK(height[k])
            ASK(height[k + 1])
            const double m = least(least(height[k], height[k + 1]), 0.5);
            const double a = m * (1.0 - m);
            area -= a;
            moment -= a * (k + 0.5);
        }
        /* Half a triangle at either end: a rectangle, then a triangle as wide as high. */
        for (int end = 0; end < 2; end++) {
            ASK(height[end * (TERMS - 1)])
            const double h = height[end * (TERMS - 1)], top = 1.0 - h;
            const double a = h - 0.5 * h * h;
            const double inward = 0.5 * top * top * h + 0.5 * h * h * (top + h / 3.0);
            area += a;
            moment += end ? (TERMS - 1) * a - inward : inward;
        }
        u[p] = low + spacing * moment / area;
    }
}

/* ---- any piecewise-linear terms ------------------------------------------------------ */

typedef struct {
    int corners;
    double x[CORNERS], y[CORNERS];
} Term;

static double membership(const Term *term, double x)
{
    int i;

    if (x <= term->x[0])
        return term->y[0];
    for (i = 1; i < term->corners; i++)
        if (x < term->x[i])
            return term->y[i - 1] + (term->y[i] - term->y[i - 1])
                * (x - term->x[i - 1]) / (term->x[i] - term->x[i - 1]);
    return term->y[term->corners - 1];
}

static int insert(double *sorted, int count, double x)
{
    int i = count;

    while (i > 0 && sorted[i - 1] > x) {
        sorted[i] = sorted[i - 1];
        i--;
    }
    sorted[i] = x;
    return count + 1;
}

static double centroid(const Term *terms, const double *height, double low, double high)
{
    double place[MOST], area = 0.0, moment = 0.0;
    int fired[TERMS], piece[TERMS] = {0}, count = 0, places = 0;

    for (int k = 0; k < TERMS; k++)
        if (height[k] > 0.0)
            fired[count++] = k;
    /* Corners, and where a set passes its height. */
    places = insert(place, places, low);
    places = insert(place, places, high);
    for (int n = 0; n < count; n++) {
        const Term *term = &terms[fired[n]];
        const double h = height[fired[n]];

        for (int i = 0; i < term->corners; i++) {
            if (term->x[i] > low && term->x[i] < high)
                places = insert(place, places, term->x[i]);
            if (i > 0 && (term->y[i - 1] - h) * (term->y[i] - h) < 0.0) {
                const double x = term->x[i - 1] + (term->x[i] - term->x[i - 1])
                    * (h - term->y[i - 1]) / (term->y[i] - term->y[i - 1]);
                if (x > low && x < high)
                    places = insert(place, places, x);
            }
        }
    }
    for (int s = 0; s + 1 < places; s++) {
        const double a = place[s], b = place[s + 1];
        double ya[TERMS], yb[TERMS], from = a, at, cut[TERMS * TERMS];
        int cuts = 0;

        if (!(b > a))
            continue;
        for (int n = 0; n < count; n++) {
            const Term *term = &terms[fired[n]];
            int i = piece[n];

            while (i < term->corners && term->x[i] <= a)
                i++;
            piece[n] = i;
            if (i == 0 || i == term->corners) {
                ya[n] = yb[n] = least(height[fired[n]], term->y[i == 0 ? 0 : i - 1]);
            } else {
                const double slope
                    = (term->y[i] - term->y[i - 1]) / (term->x[i] - term->x[i - 1]);
                ya[n] = least(height[fired[n]], term->y[i - 1] + slope * (a - term->x[i - 1]));
                yb[n] = least(height[fired[n]], term->y[i - 1] + slope * (b - term->x[i - 1]));
            }
        }
        for (int n = 0; n < count; n++)
            for (int m = n + 1; m < count; m++) {
                const double left = ya[n] - ya[m], right = yb[n] - yb[m];
                if (left * right < 0.0)
                    cuts = insert(cut, cuts, a + (b - a) * left / (left - right));
            }
        cuts = insert(cut, cuts, b);
        at = 0.0;
        for (int n = 0; n < count; n++)
            at = greatest(at, ya[n]);
        for (int c = 0; c < cuts; c++) {
            const double width = cut[c] - from, share = (cut[c] - a) / (b - a);
            double next = 0.0, part;

            for (int n = 0; n < count; n++)
                next = greatest(next, ya[n] + (yb[n] - ya[n]) * share);
            part = 0.5 * width * (at + next);
            area += part;
            moment += from * part + width * width * (at + 2.0 * next) / 6.0;
            from = cut[c];
            at = next;
        }
    }
    return moment / area;
}

void straight(const double *e, const double *ce, double *u, long points, const int *rules,
              const Term *e_terms, const Term *ce_terms, const Term *u_terms, double low,
              double high)
{
    for (long p = 0; p < points; p++) {
        double row[TERMS], column[TERMS], height[TERMS] = {0.0};

        for (int i = 0; i < TERMS; i++) {
            row[i] = membership(&e_terms[i], e[p]);
            column[i] = membership(&ce_terms[i], ce[p]);
        }
        for (int i = 0; i < TERMS; i++) {
            if (row[i] <= 0.0)
                continue;
            for (int j = 0; j < TERMS; j++) {
                const int then = rules[TERMS * i + j];
                height[then] = greatest(height[then], least(row[i], column[j]));
            }
        }
        u[p] = centroid(u_terms, height, low, high);
    }
}
