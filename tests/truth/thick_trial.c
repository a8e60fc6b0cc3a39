/* thick_trial.c - judges an answer about a public scene with a thickness. */
#include "thick_trial.h"

#include "cases.h"
#include "truth_kit.h"

#define STRIPS 64

void trial_radius(struct trial *trial, double r)
{
    trial->radius[0] = trial->radius[1] = r / 4;
    trial->radius[2] = r / 2;
}

/* ---- one pair ---------------------------------------------------------------------- */

static int compare_name(const void *key, const void *item)
{
    const struct pccd_contact *contact = item;
    const struct oracle_pair name = {contact->kind, contact->object_a, contact->feature_a,
                                     contact->object_b, contact->feature_b};
    return oracle_pair_compare(key, &name);
}

struct fuzz_thick_case trial_case(const struct trial *trial,
                                  const struct oracle_feature *a,
                                  const struct oracle_feature *b)
{
    struct fuzz_thick_case made = {.tolerance = TRIAL_TOLERANCE};
    made.query.query.kind = a->points == 1 ? PCCD_VF : PCCD_EE;
    made.query.approach = trial->approach;
    memcpy(made.query.radius, trial->radius, sizeof made.query.radius);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t v = i < a->points ? a->v[i] : b->v[i - a->points];
        memcpy(made.query.query.x[0][i], trial->object->x0[v], sizeof(double[3]));
        memcpy(made.query.query.x[1][i], trial->object->x1[v], sizeof(double[3]));
    }
    return made;
}

static void judge(struct trial *trial, const struct oracle_feature *a,
                  const struct oracle_feature *b, const struct pccd_contact *contact)
{
    struct fuzz_thick_case made = trial_case(trial, a, b);
    struct fuzz_thick_truth truth = fuzz_thick_truth_of(&made);
    struct eng_hit hit = {0};
    if (contact) {
        hit.flags = contact->flags;
        hit.toi = contact->toi;
        hit.toi_hi = contact->toi_hi;
        memcpy(hit.param, contact->param, sizeof hit.param);
        memcpy(hit.normal, contact->normal, sizeof hit.normal);
    }
    const char *what = fuzz_thick_judge_hit(&made, &truth, contact ? &hit : NULL);
    oracle_first_free(truth.first);
    trial->judged_found += contact != NULL;
    trial->judged_absent += contact == NULL;
    if (what && trial->wrong++ < 10) {
        print_message("# %s: feature %u, feature %u\n", trial->name, a->index, b->index);
        fuzz_thick_print(stdout, &made, &hit, what);
    }
}

static const struct pccd_contact *find_contact(const struct trial *trial,
                                               const struct oracle_feature *a,
                                               const struct oracle_feature *b)
{
    const struct oracle_pair name = {a->points == 1 ? PCCD_VF : PCCD_EE, 0, a->index, 0,
                                     b->index};
    return trial->count == 0 ? NULL
                             : bsearch(&name, trial->contacts, trial->count,
                                       sizeof *trial->contacts, compare_name);
}

/* A pair that no axis keeps apart. */
static void visit(struct trial *trial, const struct oracle_feature *a,
                  const struct oracle_feature *b)
{
    if (oracle_features_share_vertex(a, b)) {
        return;
    }
    if (a->points == 2 && a->index > b->index) {
        const struct oracle_feature *first = b;
        b = a;
        a = first;
    }
    const struct pccd_contact *contact = find_contact(trial, a, b);
    trial->walked++;
    trial->met += contact != NULL;
    if (prng_below(&trial->prng, contact ? trial->each_found : trial->each_absent) == 0) {
        judge(trial, a, b, contact);
    }
}

/* ---- all pairs --------------------------------------------------------------------- */

/* A feature, and its boxes at both ends of the step. */
struct span {
    struct oracle_feature feature;
    double lo[2][3];
    double hi[2][3];
    int strips[2]; /* the first and the last that it reaches into */
};

struct spans {
    struct span *items;
    size_t count;
};

static int compare_low(const void *a, const void *b)
{
    double left = ((const struct span *)a)->feature.lo[0];
    double right = ((const struct span *)b)->feature.lo[0];
    return left < right ? -1 : left > right;
}

static struct span span_of(const struct oracle_object *object,
                           const struct oracle_feature *feature)
{
    struct span span = {.feature = *feature};
    for (int k = 0; k < 6; k++) {
        truth_points x = k < 3 ? object->x0 : object->x1;
        double *lo = &span.lo[k / 3][k % 3];
        double *hi = &span.hi[k / 3][k % 3];
        *lo = *hi = x[feature->v[0]][k % 3];
        for (uint32_t i = 1; i < feature->points; i++) {
            *lo = fmin(*lo, x[feature->v[i]][k % 3]);
            *hi = fmax(*hi, x[feature->v[i]][k % 3]);
        }
    }
    return span;
}

/* Features of that many points, by where their motion begins along x. */
static void spans_init(const struct oracle_object *object, uint32_t points,
                       struct spans *spans)
{
    struct oracle_features features = {0};
    oracle_features_list(object, 1, points, &features);
    spans->count = features.count;
    spans->items = test_room((features.count + 1) * sizeof *spans->items);
    for (size_t i = 0; i < features.count; i++) {
        spans->items[i] = span_of(object, &features.items[i]);
    }
    qsort(spans->items, spans->count, sizeof *spans->items, compare_low);
    oracle_features_deinit(&features);
}

/* Return whether one is beyond the other along an axis by more than `reach` at both ends,
 * and so all the time. */
static bool are_apart(const struct span *a, const struct span *b, double reach)
{
    for (int k = 0; k < 3; k++) {
        if ((a->lo[0][k] > b->hi[0][k] + reach && a->lo[1][k] > b->hi[1][k] + reach) ||
            (b->lo[0][k] > a->hi[0][k] + reach && b->lo[1][k] > a->hi[1][k] + reach)) {
            return true;
        }
    }
    return false;
}

/* Space is cut into strips along y, from `low` on. A pair is looked at in the strip in
 * which the later one of the two begins: so it is looked at once. */
static void cut(const struct spans *spans, double low, double width, double reach)
{
    for (size_t i = 0; i < spans->count; i++) {
        struct span *span = &spans->items[i];
        double ends[2] = {span->feature.lo[1], span->feature.hi[1] + reach};
        for (int k = 0; k < 2; k++) {
            span->strips[k] = (int)fmin(fmax((ends[k] - low) / width, 0), STRIPS - 1);
        }
    }
}

/* Those that reach into a strip, in order, to some[]. */
static size_t gather(const struct spans *spans, int strip, const struct span **some)
{
    size_t count = 0;
    for (size_t i = 0; i < spans->count; i++) {
        const int *strips = spans->items[i].strips;
        if (strips[0] <= strip && strips[1] >= strip) {
            some[count++] = &spans->items[i];
        }
    }
    return count;
}

/* One of `left`, and one of `right` that begins behind it along x; if they begin
 * together, they are not `turned`: then `right` has the features a. */
static void walk_behind(struct trial *trial, int strip, const struct spans *left,
                        const struct spans *right, bool turned)
{
    const struct span **a = malloc((left->count + 1) * sizeof *a);
    const struct span **b = malloc((right->count + 1) * sizeof *b);
    assert_true(a && b);
    size_t count_a = gather(left, strip, a);
    size_t count_b = gather(right, strip, b);
    size_t begin = 0;
    for (size_t i = 0; i < count_a; i++) {
        double low = a[i]->feature.lo[0];
        double high = a[i]->feature.hi[0] + trial->reach;
        while (begin < count_b && (left == right ? begin <= i
                                   : turned      ? b[begin]->feature.lo[0] <= low
                                                 : b[begin]->feature.lo[0] < low)) {
            begin++;
        }
        for (size_t j = begin; j < count_b && b[j]->feature.lo[0] <= high; j++) {
            bool is_here = a[i]->strips[0] == strip || b[j]->strips[0] == strip;
            if (is_here && !are_apart(a[i], b[j], trial->reach)) {
                visit(trial, turned ? &b[j]->feature : &a[i]->feature,
                      turned ? &a[i]->feature : &b[j]->feature);
            }
        }
    }
    free(a);
    free(b);
}

/* All pairs of one of `left` and one of `right` that no axis keeps apart. */
static void walk(struct trial *trial, const struct spans *left, const struct spans *right)
{
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < left->count; i++) {
        low = fmin(low, left->items[i].feature.lo[1]);
        high = fmax(high, left->items[i].feature.hi[1]);
    }
    double width = fmax((high - low) / STRIPS, 1e-300);
    cut(left, low, width, trial->reach);
    cut(right, low, width, trial->reach);
    for (int strip = 0; strip < STRIPS; strip++) {
        walk_behind(trial, strip, left, right, false);
        if (left != right) {
            walk_behind(trial, strip, right, left, true);
        }
    }
}

static void judge_anywhere(struct trial *trial, const struct spans of[4])
{
    for (uint32_t i = 0; i < trial->anywhere; i++) {
        const struct spans *left = &of[i % 2 ? 1 : 2];
        const struct spans *right = &of[i % 2 ? 3 : 2];
        const struct oracle_feature *a =
            &left->items[prng_below(&trial->prng, left->count)].feature;
        const struct oracle_feature *b =
            &right->items[prng_below(&trial->prng, right->count)].feature;
        bool is_turned = left == right && a->index > b->index;
        if (!oracle_features_share_vertex(a, b)) {
            judge(trial, is_turned ? b : a, is_turned ? a : b,
                  find_contact(trial, is_turned ? b : a, is_turned ? a : b));
        }
    }
}

/* Return how far a coordinate is from 0, at most; what rounding loses is a part of it. */
static double largest(const struct oracle_object *object)
{
    double most = 0;
    for (uint32_t i = 0; i < 3 * object->vertex_count; i++) {
        most = fmax(most,
                    fmax(fabs(object->x0[i / 3][i % 3]), fabs(object->x1[i / 3][i % 3])));
    }
    return most;
}

void trial_judge(struct trial *trial)
{
    double r = trial->radius[0] + trial->radius[1] + trial->radius[2];
    trial->reach = (r + largest(trial->object)) * 0x1p-40 + r;
    struct spans of[4]; /* by number of points */
    for (uint32_t points = 1; points <= 3; points++) {
        spans_init(trial->object, points, &of[points]);
    }
    for (uint64_t i = 1; i < trial->count; i++) { /* what bsearch relies on */
        const struct pccd_contact *contact = &trial->contacts[i - 1];
        const struct oracle_pair name = {contact->kind, 0, contact->feature_a, 0,
                                         contact->feature_b};
        assert_true(compare_name(&name, &trial->contacts[i]) < 0);
    }
    walk(trial, &of[1], &of[3]);
    walk(trial, &of[2], &of[2]);
    judge_anywhere(trial, of);
    for (uint32_t points = 1; points <= 3; points++) {
        free(of[points].items);
    }
    if (trial->met != trial->count) {
        print_message("# %s: of %llu records %llu are of features that are near\n",
                      trial->name, (unsigned long long)trial->count,
                      (unsigned long long)trial->met);
    }
    assert_int_equal(trial->met, trial->count);
    assert_int_equal(trial->wrong, 0);
}
