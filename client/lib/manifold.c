/* manifold.c - of the points of two bodies the four that span the largest area. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client.h"
#include "kinds.h"
#include "points.h"

/* A record and whose it is, the lower object first. */
struct entry {
    uint32_t object[2];
    uint64_t record;
};

/* A point as it is seen along the normal. */
struct seen {
    double at[2];
    uint32_t number; /* of the candidate */
};

static int compare_entries(const void *a, const void *b)
{
    const struct entry *one = a, *other = b;
    for (int i = 0; i < 2; i++) {
        if (one->object[i] != other->object[i]) {
            return one->object[i] < other->object[i] ? -1 : 1;
        }
    }
    return (one->record > other->record) - (one->record < other->record);
}

static int compare_seen(const void *a, const void *b)
{
    const struct seen *one = a, *other = b;
    for (int i = 0; i < 2; i++) {
        if (one->at[i] != other->at[i]) {
            return one->at[i] < other->at[i] ? -1 : 1;
        }
    }
    return (one->number > other->number) - (one->number < other->number);
}

static int compare_numbers(const void *a, const void *b)
{
    uint32_t one = *(const uint32_t *)a, other = *(const uint32_t *)b;
    return (one > other) - (one < other);
}

/* Twice the area of a triangle, above 0 if it turns left. */
static double area(const struct seen *a, const struct seen *b, const struct seen *c)
{
    return (b->at[0] - a->at[0]) * (c->at[1] - a->at[1]) -
           (b->at[1] - a->at[1]) * (c->at[0] - a->at[0]);
}

/* Leave of sorted points, no two at one place, the corners of their hull in its order, in
 * hull[2 * count]; returns how many. */
static uint32_t find_hull(const struct seen *points, uint32_t count, struct seen *hull)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        while (n >= 2 && area(&hull[n - 2], &hull[n - 1], &points[i]) <= 0) {
            n--;
        }
        hull[n++] = points[i];
    }
    for (uint32_t i = count - 1, lower = n + 1; i-- > 0;) {
        while (n >= lower && area(&hull[n - 2], &hull[n - 1], &points[i]) <= 0) {
            n--;
        }
        hull[n++] = points[i];
    }
    return count > 1 ? n - 1 : n;
}

/* Choose of five corners or more those of the largest quadrilateral: for each diagonal
 * the farthest on either side, which goes around with it. */
static void choose_four(const struct seen *hull, uint32_t n, uint32_t chosen[4])
{
    double largest = -1;
    for (uint32_t i = 0; i + 2 < n; i++) {
        uint32_t right = i + 1, left = i + 3;
        for (uint32_t k = i + 2; k < n && k + 1 < n + i; k++) {
#define CORNER(number) (&hull[(number) % n])
            while (right + 1 < k && area(CORNER(i), CORNER(right + 1), CORNER(k)) >=
                                        area(CORNER(i), CORNER(right), CORNER(k))) {
                right++;
            }
            left = left > k ? left : k + 1;
            while (left + 1 < n + i && area(CORNER(i), CORNER(k), CORNER(left + 1)) >=
                                           area(CORNER(i), CORNER(k), CORNER(left))) {
                left++;
            }
            double size = area(CORNER(i), CORNER(right), CORNER(k)) +
                          area(CORNER(i), CORNER(k), CORNER(left));
            if (size > largest) {
                largest = size;
                chosen[0] = i;
                chosen[1] = right;
                chosen[2] = k;
                chosen[3] = left % n;
            }
#undef CORNER
        }
    }
}

/* The coordinate that counts least seen along a normal; without one, that of the least
 * extent. */
static int dropped_axis(const struct pccd_manifold_point *candidates, uint32_t count)
{
    double size[3];
    double extent[3];
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY, sum = 0;
        for (uint32_t i = 0; i < count; i++) {
            low = fmin(low, candidates[i].point[k]);
            high = fmax(high, candidates[i].point[k]);
            sum += candidates[i].normal[k];
        }
        size[k] = fabs(sum);
        extent[k] = high - low;
    }
    bool has_normal = size[0] > 0 || size[1] > 0 || size[2] > 0;
    for (int k = 1; k < 3; k++) {
        bool is_better = has_normal ? size[k] > size[axis] : extent[k] < extent[axis];
        axis = is_better ? k : axis;
    }
    return axis;
}

/* Choose at most four of [count] candidates; seen[3 * count] is scratch. */
static uint32_t choose(const struct pccd_manifold_point *candidates, uint32_t count,
                       struct seen *seen, uint32_t chosen[4])
{
    int axis = dropped_axis(candidates, count);
    uint32_t distinct = 0;
    struct seen *hull = seen + count;
    for (uint32_t i = 0; i < count; i++) {
        const double *point = candidates[i].point;
        seen[i] = (struct seen){{point[(axis + 1) % 3], point[(axis + 2) % 3]}, i};
    }
    qsort(seen, count, sizeof *seen, compare_seen);
    for (uint32_t i = 0; i < count; i++) {
        if (i == 0 || seen[i].at[0] != seen[distinct - 1].at[0] ||
            seen[i].at[1] != seen[distinct - 1].at[1]) {
            seen[distinct++] = seen[i];
        }
    }
    uint32_t n = find_hull(seen, distinct, hull);
    uint32_t corners[4] = {0, 1, 2, 3};
    if (n > 4) {
        choose_four(hull, n, corners);
        n = 4;
    }
    for (uint32_t i = 0; i < n; i++) {
        chosen[i] = hull[corners[i]].number;
    }
    qsort(chosen, n, sizeof *chosen, compare_numbers);
    return n;
}

/* The point of a record, as its manifold has it. */
static void describe(const struct cli_records *records, uint64_t record,
                     const struct cli_feature_pair *pair, struct pccd_manifold_point *to)
{
    double points[2][3];
    double squares = 0;
    bool is_swapped = pair->object[0] > pair->object[1];
    cli_feature_pair_points(pair, points);
    *to = (struct pccd_manifold_point){.record = record};
    for (int k = 0; k < 3; k++) {
        double normal = (double)pair->normal[k];
        double between = points[0][k] - points[1][k];
        to->point[k] = 0.5 * points[0][k] + 0.5 * points[1][k];
        to->normal[k] = is_swapped || normal == 0 ? normal : -normal;
        squares += between * between;
    }
    to->toi = records->near != NULL ? 0 : pair->t;
    to->distance = records->near != NULL ? pair->distance : sqrt(squares);
}

/* Everything that a call needs. */
struct work {
    const struct cli_records *records;
    double within;
    struct entry *entries;        /* [count] */
    struct pccd_manifold_point *candidates; /* [count] */
    struct seen *seen;            /* [3 * count] */
};

/* Write the manifold of entries [count], which are of the same two objects; *written: 0
 * or 1. */
static int write_manifold(const struct work *work, const struct entry *entries,
                          uint64_t count, struct pccd_manifold *manifold,
                          uint32_t *written)
{
    const struct cli_records *records = work->records;
    const double within = work->within;
    struct cli_feature_pair pair;
    uint32_t chosen[4];
    uint32_t kept = 0;
    double most = within;
    *written = 0;
    for (uint64_t i = 0; i < count && records->near == NULL; i++) {
        double toi = records->contacts[entries[i].record].toi;
        most = i == 0 ? toi + within : fmin(most, toi + within);
    }
    for (uint64_t i = 0; i < count; i++) {
        uint64_t record = entries[i].record;
        int status = cli_feature_pair_find(records, record, &pair);
        if (status != PCCD_OK) {
            return status;
        }
        double is = records->near != NULL ? pair.distance : pair.t;
        if (pair.kind != PCCD_EF && is <= most) {
            describe(records, record, &pair, &work->candidates[kept++]);
        }
    }
    if (kept == 0) {
        return PCCD_OK;
    }
    uint32_t n = choose(work->candidates, kept, work->seen, chosen);
    *written = 1;
    if (manifold == NULL) {
        return PCCD_OK;
    }
    *manifold = (struct pccd_manifold){.object_a = entries[0].object[0],
                                       .object_b = entries[0].object[1],
                                       .count = n};
    for (uint32_t i = 0; i < n; i++) {
        manifold->points[i] = work->candidates[chosen[i]];
    }
    return PCCD_OK;
}

static int write_all(const struct work *work, struct pccd_manifold *manifolds,
                     uint64_t room, uint64_t *total)
{
    const struct cli_records *records = work->records;
    for (uint64_t i = 0; i < records->count; i++) {
        const void *record = records->near != NULL ? (const void *)&records->near[i]
                                                   : (const void *)&records->contacts[i];
        struct pccd_contact is; /* near has its objects there, too (points.c) */
        memcpy(&is, record, sizeof is);
        bool is_swapped = is.object_a > is.object_b;
        work->entries[i] = (struct entry){{is_swapped ? is.object_b : is.object_a,
                                           is_swapped ? is.object_a : is.object_b},
                                          i};
    }
    qsort(work->entries, records->count, sizeof *work->entries, compare_entries);
    *total = 0;
    for (uint64_t i = 0, end = 0; i < records->count; i = end) {
        const struct entry *first = &work->entries[i];
        uint32_t written = 0;
        while (end < records->count &&
               memcmp(work->entries[end].object, first->object, sizeof first->object) ==
                   0) {
            end++;
        }
        int status = write_manifold(work, first, end - i,
                                    *total < room ? &manifolds[*total] : NULL, &written);
        if (status != PCCD_OK) {
            return status;
        }
        *total += written;
    }
    return PCCD_OK;
}

static int make(const struct cli_records *records, const char *what, double within,
                struct pccd_manifold *manifolds, uint64_t room, uint64_t *total)
{
    int status = cli_records_check_positions(records, what);
    if (status == PCCD_OK && (total == NULL || (manifolds == NULL && room > 0))) {
        status = cli_fail(NULL, PCCD_E_INVAL, "%s: %s is NULL", what,
                          total == NULL ? "total" : "manifolds");
    }
    if (status == PCCD_OK && !(within >= 0)) {
        status = cli_fail(NULL, PCCD_E_INVAL, "%s: %s is %g, below 0", what,
                          records->near != NULL ? "distance" : "time", within);
    }
    if (status != PCCD_OK) {
        return status;
    }
    uint64_t count = records->count + 1;
    struct work work = {.records = records,
                        .within = within,
                        .entries = calloc(count, sizeof *work.entries),
                        .candidates = calloc(count, sizeof *work.candidates),
                        .seen = calloc(3 * count, sizeof *work.seen)};
    status = work.entries == NULL || work.candidates == NULL || work.seen == NULL ||
                     count > UINT32_MAX
                 ? cli_fail(NULL, PCCD_E_NOMEM, "%s: no memory", what)
                 : write_all(&work, manifolds, room, total);
    free(work.entries);
    free(work.candidates);
    free(work.seen);
    return status;
}

int pccd_manifolds(const struct pccd_body *bodies, uint32_t body_count,
                   const struct pccd_contact *contacts, uint64_t count, double time,
                   struct pccd_manifold *manifolds, uint64_t room, uint64_t *total)
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .contacts = contacts, .count = count};
    return make(&records, "manifolds", time, manifolds, room, total);
}

int pccd_near_manifolds(const struct pccd_body *bodies, uint32_t body_count,
                        const struct pccd_near *near, uint64_t count, double distance,
                        double t, struct pccd_manifold *manifolds, uint64_t room,
                        uint64_t *total)
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .near = near, .count = count, .t = t};
    return make(&records, "near_manifolds", distance, manifolds, room, total);
}
