/* near_best.c - the nearest pair so far. */
#include "near_best.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "kinds.h"
#include "thickness.h"

struct eng_near_pair eng_near_vf(const struct eng_scene *scene, uint32_t of_vertex,
                                 uint32_t v, uint32_t of_face, uint32_t f)
{
    const struct eng_object *face_object = &scene->objects[of_face];
    const uint32_t *corner = face_object->mesh->leaves[f].v;
    uint32_t first = face_object->vertices.first;
    return (struct eng_near_pair){.kind = PCCD_VF,
                                  .object = {of_vertex, of_face},
                                  .feature = {v, f},
                                  .point = {scene->objects[of_vertex].vertices.first + v,
                                            first + corner[0], first + corner[1],
                                            first + corner[2]}};
}

/* The name of an edge; its points go to `point`, the lower first. */
static uint64_t edge_of(const uint32_t edge[2], uint32_t first, uint32_t point[2])
{
    uint32_t low = edge[0] < edge[1] ? edge[0] : edge[1];
    uint32_t high = edge[0] < edge[1] ? edge[1] : edge[0];
    point[0] = first + low;
    point[1] = first + high;
    return (uint64_t)high << 32 | low;
}

struct eng_near_pair eng_near_ee(const struct eng_scene *scene, uint32_t a,
                                 const uint32_t edge_a[2], uint32_t b,
                                 const uint32_t edge_b[2])
{
    const struct eng_object *objects = scene->objects;
    bool in_order = objects[a].id < objects[b].id;
    uint32_t first = in_order ? a : b;
    uint32_t second = in_order ? b : a;
    struct eng_near_pair pair = {.kind = PCCD_EE, .object = {first, second}};
    pair.feature[0] =
        edge_of(in_order ? edge_a : edge_b, objects[first].vertices.first, pair.point);
    pair.feature[1] = edge_of(in_order ? edge_b : edge_a, objects[second].vertices.first,
                              pair.point + 2);
    return pair;
}

struct eng_near_pair eng_near_ef(const struct eng_scene *scene, uint32_t of_edge,
                                 const uint32_t edge[2], uint32_t of_face, uint32_t f)
{
    const struct eng_object *face_object = &scene->objects[of_face];
    struct eng_near_pair pair = {.kind = PCCD_EF, .object = {of_edge, of_face}};
    pair.feature[0] = edge_of(edge, scene->objects[of_edge].vertices.first, pair.point);
    pair.feature[1] = f;
    for (int i = 0; i < 3; i++) {
        pair.point[2 + i] =
            face_object->vertices.first + face_object->mesh->leaves[f].v[i];
    }
    return pair;
}

struct eng_near_pair eng_near_ve(const struct eng_scene *scene, uint32_t of_vertex,
                                 uint32_t v, uint32_t of_edge, const uint32_t edge[2])
{
    struct eng_near_pair pair = {.kind = PCCD_VE, .object = {of_vertex, of_edge}};
    pair.feature[0] = v;
    pair.feature[1] =
        edge_of(edge, scene->objects[of_edge].vertices.first, pair.point + 1);
    pair.point[0] = scene->objects[of_vertex].vertices.first + v;
    pair.point[3] = pair.point[2];
    return pair;
}

struct eng_near_pair eng_near_vv(const struct eng_scene *scene, uint32_t a, uint32_t v,
                                 uint32_t b, uint32_t w)
{
    const struct eng_object *objects = scene->objects;
    bool in_order = objects[a].id < objects[b].id;
    struct eng_near_pair pair = {.kind = PCCD_VV,
                                 .object = {in_order ? a : b, in_order ? b : a},
                                 .feature = {in_order ? v : w, in_order ? w : v}};
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t side = i == 0 ? 0 : 1;
        pair.point[i] =
            objects[pair.object[side]].vertices.first + (uint32_t)pair.feature[side];
    }
    return pair;
}

void eng_near_best_begin(struct eng_near_best *best, const struct eng_near_limits *limits)
{
    assert(limits->distance >= 0 && limits->gap >= 0);
    best->limits = *limits;
    best->radii = eng_sum_up(limits->most[0], limits->most[1]);
    best->is_made = false;
}

/* Surfaces that are farther apart need not be looked at. */
static double surfaces_reach(const struct eng_near_best *best)
{
    return best->is_made ? best->hi - best->limits.gap : best->limits.distance;
}

double eng_near_best_reach(const struct eng_near_best *best)
{
    return eng_sum_up(surfaces_reach(best), best->radii);
}

/* Return whether `a` is before `b` in canonical order. */
static bool is_before(const struct eng_scene *scene, const struct eng_near_pair *a,
                      const struct eng_near_pair *b)
{
    if (a->kind != b->kind) {
        return a->kind < b->kind;
    }
    for (int i = 0; i < 2; i++) {
        uint32_t object_a = scene->objects[a->object[i]].id;
        uint32_t object_b = scene->objects[b->object[i]].id;
        if (object_a != object_b) {
            return object_a < object_b;
        }
        if (a->feature[i] != b->feature[i]) {
            return a->feature[i] < b->feature[i];
        }
    }
    return false;
}

/* Load a pair. What passes through has a point in common: it is as far apart as a vertex
 * is from a face of that vertex alone. */
static void load(const struct eng_near_best *best, const struct eng_near_pair *pair,
                 struct eng_features *features)
{
    const uint32_t *sides = common_kinds[pair->kind].points;
    const uint32_t *point = pair->point;
    bool passes = pair->kind == PCCD_EF;
    features->kind = passes ? PCCD_VF : eng_distance_form((enum pccd_kind)pair->kind);
    for (int i = 0; i < 4; i++) {
        memcpy(features->x[i], best->x[point[passes ? 0 : i]], sizeof features->x[i]);
    }
    for (int side = 0; side < 2; point += sides[side++]) {
        const struct eng_object *object = &best->scene->objects[pair->object[side]];
        uint32_t v[3] = {0};
        for (uint32_t i = 0; i < sides[side]; i++) {
            v[i] = point[i] - object->vertices.first;
        }
        features->radius[side] =
            best->radii > 0 ? eng_thickness_radius(object, v, sides[side]) : 0;
    }
}

/* The order of the points by (object, vertex). */
static void rank_points(const struct eng_near_best *best,
                        const struct eng_near_pair *pair, uint8_t rank[4])
{
    uint32_t split = common_kinds[pair->kind].points[0];
    bool a_is_first = best->scene->objects[pair->object[0]].id <
                      best->scene->objects[pair->object[1]].id;
    for (uint32_t i = 0; i < 4; i++) {
        rank[i] = 0;
        for (uint32_t j = 0; j < 4; j++) {
            bool same_object = (i < split) == (j < split);
            bool is_less = same_object ? pair->point[j] < pair->point[i] ||
                                             (pair->point[j] == pair->point[i] && j < i)
                                       : (j < split) == a_is_first;
            rank[i] = (uint8_t)(rank[i] + is_less);
        }
    }
}

/* The knowledge of doubles about a pair. */
struct glance {
    double lo; /* its surfaces are apart by what is between these */
    double hi;
    bool touches; /* its distance is known to be 0 */
    bool has_parts;
    uint32_t part_count;
    uint32_t parts[4]; /* indices of positions, rising */
};

static void set_parts(const struct eng_near_pair *pair, uint32_t points,
                      struct glance *glance)
{
    glance->has_parts = true;
    glance->part_count = 0;
    for (int i = 0; i < 4; i++) {
        if ((points >> i & 1u) == 0) {
            continue;
        }
        uint32_t at = glance->part_count++;
        for (; at > 0 && glance->parts[at - 1] > pair->point[i]; at--) {
            glance->parts[at] = glance->parts[at - 1];
        }
        glance->parts[at] = pair->point[i];
    }
}

/* From how far apart features are to how far apart their surfaces are. */
static void set_range(struct glance *glance, double lo, double hi, const double radius[2])
{
    glance->touches = hi == 0;
    glance->lo = eng_difference_down(lo, eng_sum_up(radius[0], radius[1]));
    glance->hi = eng_sum_up(hi, -eng_difference_down(radius[0], -radius[1]));
}

static void look_quickly(const struct eng_near_pair *pair,
                         const struct eng_features *features, struct glance *glance)
{
    struct eng_distance_bounds bounds;
    *glance = (struct glance){.hi = INFINITY};
    if (pair->kind == PCCD_EF) {
        set_range(glance, 0, 0, features->radius);
    } else if (eng_distance_bound(features->kind, features->x, &bounds)) {
        set_range(glance, bounds.lo, bounds.hi, features->radius);
        set_parts(pair, bounds.points, glance);
    } else {
        set_range(glance, 0, INFINITY, features->radius);
    }
}

/* Return whether both distances are between the same points. Then they are equal. */
static bool has_same_parts(const struct eng_near_best *best, const struct glance *glance)
{
    return best->has_parts && glance->has_parts &&
           best->part_count == glance->part_count &&
           memcmp(best->parts, glance->parts,
                  glance->part_count * sizeof glance->parts[0]) == 0;
}

static void take(struct eng_near_best *best, const struct eng_near_pair *pair,
                 const struct eng_features *features, struct glance *glance)
{
    if (!isfinite(glance->hi)) {
        uint8_t rank[4];
        struct eng_distance distance;
        rank_points(best, pair, rank);
        eng_distance_find(best->distances, features->kind, features->x, rank, &distance);
        set_range(glance, distance.lo, distance.hi, features->radius);
    }
    best->is_made = true;
    best->pair = *pair;
    memcpy(best->radius, features->radius, sizeof best->radius);
    best->lo = glance->lo;
    best->hi = glance->hi;
    best->is_least =
        glance->touches && eng_radii_order(best->radius, best->limits.most) == ENG_ZERO;
    best->has_parts = glance->has_parts;
    best->part_count = glance->part_count;
    memcpy(best->parts, glance->parts, sizeof best->parts);
}

/* Compare how far apart the surfaces of a pair are with those of the best. */
static enum eng_sign order(const struct eng_near_best *best,
                           const struct eng_features *features,
                           const struct glance *glance)
{
    struct eng_features of_best;
    if (has_same_parts(best, glance)) {
        return eng_radii_order(best->radius, features->radius);
    }
    load(best, &best->pair, &of_best);
    return eng_distance_order(best->order, best->distances, features, &of_best);
}

static void load_five(const struct eng_near_best *best, const struct eng_near_pair *pair,
                      double x[5][3])
{
    for (int i = 0; i < 5; i++) {
        memcpy(x[i], best->x[pair->point[i]], sizeof x[i]);
    }
}

static bool passes_through(const struct eng_near_best *best,
                           const struct eng_near_pair *pair)
{
    double x[5][3];
    load_five(best, pair, x);
    return eng_distance_crosses(best->distances, (const double(*)[3])x);
}

void eng_near_best_look(struct eng_near_best *best, const struct eng_near_pair *pair)
{
    struct eng_features features;
    struct glance glance;
    best->looked++;
    load(best, pair, &features);
    look_quickly(pair, &features, &glance);
    if (glance.lo > surfaces_reach(best)) {
        return;
    }
    bool comes_first = !best->is_made || is_before(best->scene, pair, &best->pair);
    if ((!comes_first && best->is_least) ||
        (pair->kind == PCCD_EF && !passes_through(best, pair))) {
        return;
    }
    if (!best->is_made) {
        if (glance.hi <= best->limits.distance ||
            eng_distance_order_within(best->order, best->distances, &features,
                                      best->limits.distance)) {
            take(best, pair, &features, &glance);
        }
        return;
    }
    if (glance.hi < best->lo) {
        take(best, pair, &features, &glance);
        return;
    }
    enum eng_sign sign = order(best, &features, &glance);
    if (sign == ENG_MINUS || (sign == ENG_ZERO && comes_first)) {
        take(best, pair, &features, &glance);
    }
}

/* In a record's terms, of the points that the pair has. */
static struct eng_distance measure(const struct eng_near_best *best,
                                   const struct eng_near_pair *pair)
{
    struct eng_distance distance = {.type = ENG_NEAREST_VF};
    struct eng_features features;
    double x[5][3];
    uint8_t rank[4];
    if (pair->kind == PCCD_EF) {
        load_five(best, pair, x);
        distance.param[0] = eng_distance_crossing(best->distances, (const double(*)[3])x);
    } else {
        load(best, pair, &features);
        rank_points(best, pair, rank);
        eng_distance_find(best->distances, (enum pccd_kind)pair->kind, features.x, rank,
                          &distance);
    }
    return distance;
}

/* The number of a feature of `points` points. */
static uint32_t number_of(const struct eng_object *object, uint32_t points,
                          uint64_t feature)
{
    return points == 2
               ? eng_mesh_edge(object->mesh, (uint32_t)feature, (uint32_t)(feature >> 32))
               : (uint32_t)feature;
}

void eng_near_describe(const struct eng_near_best *best, const struct eng_near_pair *pair,
                       struct pccd_near *record)
{
    const struct eng_object *object_a = &best->scene->objects[pair->object[0]];
    const struct eng_object *object_b = &best->scene->objects[pair->object[1]];
    const uint32_t *sides = common_kinds[pair->kind].points;
    struct eng_distance distance = measure(best, pair);
    memset(record, 0, sizeof *record);
    record->kind = pair->kind;
    record->flags = (uint32_t)distance.type << 8 |
                    (best->limits.gap > 0 ? (uint32_t)PCCD_NEAR_GAP : 0);
    record->object_a = object_a->id;
    record->object_b = object_b->id;
    record->feature_a = number_of(object_a, sides[0], pair->feature[0]);
    record->feature_b = number_of(object_b, sides[1], pair->feature[1]);
    record->d_lo = distance.lo;
    record->d_hi = distance.hi;
    for (int i = 0; i < 2; i++) {
        record->param[i] = (float)distance.param[i];
    }
    for (int k = 0; k < 3; k++) {
        record->direction[k] = (float)distance.direction[k];
    }
    record->count = 1;
}
