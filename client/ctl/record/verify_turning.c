/* verify_turning.c - whether an answer is right about bodies that turn.
 *
 * They go along no line, so nothing here is exact: the oracle bounds where they are by
 * intervals, and says of a span of time that a pair is free in it, that it meets in it,
 * or that it cannot tell.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_distance.h"
#include "oracle_turning.h"
#include "verify.h"

#define TOLERANCE  1e-6
#define SPANS      20000u  /* of a pair, by doubles .. */
#define SPANS_FINE 500u    /* .. and by longer numbers: milliseconds */
#define RESOLUTION 0x1p-20 /* of the size of the larger body, unless a step says */
#define ROUNDING   0x1p-36 /* of coordinates, more than what that is raised to */

bool verify_turns(const struct play_step *step, const struct pccd_pair *pair)
{
    const struct registry_object *a = registry_object(step->scene, pair->object_a);
    const struct registry_object *b = registry_object(step->scene, pair->object_b);
    return a->turned || b->turned;
}

bool verify_has_turning(const struct play_step *step)
{
    bool has = false;
    for (uint32_t i = 0; i < step->scene->object_count; i++) {
        has = has || step->scene->objects[i].turned;
    }
    return has;
}

/* ---- what the oracle is asked ------------------------------------------------------ */

/* A pair as the oracle takes it, and the points of its features. */
struct question {
    struct oracle_turning pair;
    double x[2][2][3][3]; /* [side][end][point] */
};

static void take_side(const struct play_step *step, uint32_t handle, uint32_t feature,
                      uint32_t points, int side, struct question *question)
{
    const struct registry_object *object = registry_object(step->scene, handle);
    const uint32_t *v = recorded_feature(object->mesh, points, &feature);
    double(*x)[3][3] = question->x[side];
    for (uint32_t i = 0; i < points; i++) {
        if (object->turned) {
            registry_registered(object->mesh, v[i], x[0][i]);
            memcpy(x[1][i], x[0][i], sizeof x[0][i]);
        } else {
            memcpy(x[0][i], object->x0[v[i]], sizeof x[0][i]);
            memcpy(x[1][i], object->x1[v[i]], sizeof x[1][i]);
        }
    }
    question->pair.side[side] = (struct oracle_turning_side){
        .points = points,
        .joint = object->turned ? object->joint : PCCD_NO_JOINT,
        .x = {(const double(*)[3])x[0], (const double(*)[3])x[1]}};
}

static void take_pair(const struct play_step *step, const struct pccd_pair *pair,
                      struct question *question)
{
    const uint32_t *points = common_kinds[pair->kind].points;
    memset(question, 0, sizeof *question);
    question->pair.joints = step->joints.items;
    take_side(step, pair->object_a, pair->feature_a, points[0], 0, question);
    take_side(step, pair->object_b, pair->feature_b, points[1], 1, question);
    verify_radii(step, pair, question->pair.radius);
}

static double tolerance_of(const struct play_step *step)
{
    return step->frame->tolerance > 0 ? step->frame->tolerance : TOLERANCE;
}

static void ask(const struct play_step *step, struct question *question, double from,
                double to, struct oracle_turning_answer *answer)
{
    const struct oracle_turning_asked asked = {.from = from,
                                               .to = to,
                                               .width = tolerance_of(step) / 4,
                                               .spans = SPANS,
                                               .fine = SPANS_FINE};
    oracle_turning_find(&question->pair, &asked, answer);
}

/* ---- a record ---------------------------------------------------------------------- */

/* Enlarge the box by the points of an object: the registered ones of one that turns. */
static void measure(const struct registry_object *object, double *extent, double *size)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY};
    double hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t v = 0; v < object->mesh->vertex_count; v++) {
        double x[3][3];
        registry_registered(object->mesh, v, x[0]);
        memcpy(x[1], object->turned ? x[0] : object->x0[v], sizeof x[1]);
        memcpy(x[2], object->turned ? x[0] : object->x1[v], sizeof x[2]);
        for (int k = 3; k < 9; k++) {
            lo[k % 3] = fmin(lo[k % 3], x[k / 3][k % 3]);
            hi[k % 3] = fmax(hi[k % 3], x[k / 3][k % 3]);
        }
    }
    for (int k = 0; k < 3 && object->mesh->vertex_count > 0; k++) {
        *extent = fmax(*extent, hi[k] - lo[k]);
        *size = fmax(*size, fmax(fabs(lo[k]), fabs(hi[k])));
    }
}

/* Return how far from the origin all joints together take their frames, at most. */
static double length_of_joints(const struct play_step *step)
{
    double length = 0;
    for (uint32_t i = 0; i < step->joints.count; i++) {
        for (int k = 0; k < 3; k++) {
            const struct pccd_joint *joint = &step->joints.items[i];
            bool shifts = joint->kind == PCCD_JOINT_SHIFT ||
                          (joint->kind == PCCD_JOINT_SLIDE && k == 0);
            length += fabs(joint->position[k]);
            length += shifts ? fmax(fabs(joint->from[k]), fabs(joint->to[k])) : 0;
        }
    }
    return length;
}

/* Return how much more than its distance a pair that is possible may be apart. */
static double reach_of(const struct play_step *step, const struct pccd_pair *pair)
{
    double extent = 0, size = 0;
    measure(registry_object(step->scene, pair->object_a), &extent, &size);
    measure(registry_object(step->scene, pair->object_b), &extent, &size);
    size += length_of_joints(step);
    double resolution =
        step->frame->resolution > 0 ? step->frame->resolution : RESOLUTION * extent;
    return fmax(2 * resolution, ROUNDING * size);
}

/* Set where the points of a pair are at two times, as oracle.h orders them; a kind of
 * fewer repeats the last. False: too many joints. */
static bool place_pair(const struct question *question, const double t[2], double p[8][3])
{
    const struct oracle_turning_side *side = question->pair.side;
    bool fits = true;
    for (int i = 0; i < 4 && fits; i++) {
        double place[3][3];
        fits = oracle_turning_place(question->pair.joints, &side[i % 2], t[i / 2], place);
        double(*to)[3] = p + 4 * (i / 2) + (i % 2 == 1 ? side[0].points : 0);
        for (uint32_t n = 0; n < side[i % 2].points && fits; n++) {
            memcpy(to[n], place[n], sizeof place[n]);
        }
    }
    for (uint32_t i = side[0].points + side[1].points; i < 4 && fits; i++) {
        memcpy(p[i], p[i - 1], sizeof p[i]);
        memcpy(p[4 + i], p[3 + i], sizeof p[i]);
    }
    return fits;
}

/* Return what is wrong with where the record says that its features meet; NULL: nothing,
 * or it cannot be told. */
static const char *misplaced(const struct question *question,
                             const struct pccd_contact *contact)
{
    const double t[2] = {contact->toi, contact->toi_hi};
    struct pccd_contact alone = *contact;
    double p[8][3], way = 0, size = 0, r = 0;
    if (!place_pair(question, t, p)) {
        return NULL;
    }
    for (uint32_t i = 0; i < 12; i++) {
        way = fmax(way, fabs(p[4 + i / 3][i % 3] - p[i / 3][i % 3]));
        size = fmax(size, fabs(p[i / 3][i % 3] - p[0][i % 3]));
    }
    if (way > 1e-5 * size) {
        return NULL; /* too fast for that */
    }
    alone.toi = 0;
    alone.toi_hi = 1;
    for (int i = 0; i < 3; i++) {
        r += question->pair.radius[i];
    }
    return verify_place(&alone, (const double(*)[3])p, r);
}

/* Find the distance at which a pair meets, which with an approach is known by bounds:
 * ask which of its times are certain by `met`, the answer for the lower, and `is`, that
 * for the upper one, with which the question is left. Return whether the pair begins
 * inside: 1, it does; 0, it does not; -1, that is not known. */
static int ask_both(const struct play_step *step, const struct pccd_pair *pair,
                    struct question *question, struct oracle_turning_answer *is,
                    struct oracle_turning_answer *met)
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    const double s = step->frame->approach;
    double *radius = question->pair.radius;
    double r = radius[0] + radius[1] + radius[2], low = r, p[8][3], extent = 0, size = 0;
    struct oracle_distance first = {.lo = INFINITY};
    int inside = 0;
    if (s > 0 && r > 0 && place_pair(question, (const double[2]){0, 0}, p)) {
        oracle_distance_find(question->pair.side[0].points == 2 ? ORACLE_EE : ORACLE_VF,
                             (const double(*)[3])p, rank, &first);
        measure(registry_object(step->scene, pair->object_a), &extent, &size);
        measure(registry_object(step->scene, pair->object_b), &extent, &size);
        const double pad = ROUNDING * (size + length_of_joints(step));
        inside = first.hi + pad < r ? 1 : first.lo - pad > r ? 0 : -1;
        low = inside != 0 ? fmax(s * (first.lo - pad), 0) : r;
        r = inside == 1 ? s * (first.hi + pad) : r;
    }
    if (inside != 0) {
        memset(radius, 0, sizeof question->pair.radius);
        radius[0] = low;
        ask(step, question, 0, 1, met);
        radius[0] = r;
    }
    ask(step, question, 0, 1, is);
    *met = inside != 0 ? *met : *is;
    return inside;
}

/* Return what is wrong with a record's times and flags; NULL: nothing that is known. */
static const char *mistimed(const struct play_step *step, struct question *question,
                            const struct pccd_contact *contact,
                            const struct pccd_pair *pair,
                            const struct oracle_turning_answer *is,
                            const struct oracle_turning_answer *met)
{
    bool is_proved = (contact->flags & PCCD_PROVED) != 0;
    bool is_initial = (contact->flags & PCCD_INITIAL) != 0;
    struct oracle_turning_answer then;
    if (met->met_by < contact->toi) {
        return "the features meet before the record's time";
    }
    if (is_proved && (is->is_free || is->free_until > contact->toi_hi)) {
        return "a contact is claimed to be proved, and the features are apart until "
               "after its time";
    }
    if (is_initial && (!is_proved || contact->toi_hi > 0 || is->free_until > 0)) {
        return "the features are claimed to meet at t = 0, and are apart then";
    }
    if (is_proved) {
        return misplaced(question, contact);
    }
    question->pair.radius[3] = reach_of(step, pair);
    ask(step, question, contact->toi, contact->toi_hi, &then);
    return then.is_free ? "a possible contact is of features that are farther apart than "
                          "the resolution"
                        : NULL;
}

bool verify_turning(const struct play_step *step, const struct pccd_contact *contact,
                    const struct pccd_pair *pair, struct verify_result *result)
{
    const uint32_t known = PCCD_PROVED | PCCD_INITIAL | PCCD_INSIDE;
    bool is_proved = (contact->flags & PCCD_PROVED) != 0;
    struct question question;
    struct oracle_turning_answer is, met;
    if (pair->object_a == pair->object_b) {
        return verify_wrong(result, step, NULL, "a body that turns meets itself");
    }
    if ((contact->flags & ~known) != 0) {
        return verify_wrong(result, step, NULL,
                            "a record of a body that turns has flags that say nothing");
    }
    take_pair(step, pair, &question);
    int inside = ask_both(step, pair, &question, &is, &met);
    const char *what =
        inside >= 0 && inside != ((contact->flags & PCCD_INSIDE) != 0)
            ? "whether the features begin within their distance is told wrongly"
            : mistimed(step, &question, contact, pair, &is, &met);
    if (what != NULL) {
        return verify_wrong(result, step, pair, "%s", what);
    }
    bool is_told = met.met_by <= contact->toi_hi + tolerance_of(step) &&
                   is.free_until >= contact->toi - tolerance_of(step);
    result->counts.contacts += is_proved;
    result->counts.possible += !is_proved;
    result->counts.turning += is_proved && !is_told;
    return true;
}

void verify_turning_tell(const struct play_step *step, const struct pccd_pair *pair,
                         struct verify_witness *witness)
{
    struct question question;
    struct oracle_turning_answer is, met;
    take_pair(step, pair, &question);
    (void)ask_both(step, pair, &question, &is, &met);
    witness->has_pair = place_pair(&question, (const double[2]){0, 1}, witness->p);
    witness->has_contact = met.met_by <= 1;
    witness->lo = is.free_until;
    witness->hi = met.met_by;
}

/* ---- what is missing --------------------------------------------------------------- */

bool verify_turning_missing(const struct play_step *step, const struct pccd_pair *pair,
                            double from, struct verify_result *result)
{
    struct question question;
    struct oracle_turning_answer is, met;
    if (pair->object_a == pair->object_b) {
        return true; /* it does not meet itself */
    }
    take_pair(step, pair, &question);
    (void)ask_both(step, pair, &question, &is, &met);
    bool meets = met.met_by <= 1 && met.met_by < from;
    result->counts.non_contacts += !meets;
    result->counts.turning += !is.is_free && met.met_by > 1;
    return !meets ||
           verify_wrong(result, step, pair, "a contact is missing in the answer");
}

/* Set the transform of what hangs on a joint: where the origin goes, then the axes. */
static bool set_transform(const struct play_step *step, uint32_t joint, double t,
                          double m[12])
{
    static const double origin[1][3] = {{0}};
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct oracle_turning_side of[2] = {{1, joint, {origin, origin}},
                                              {3, joint, {axes, axes}}};
    double x[2][3][3];
    bool fits = oracle_turning_place(step->joints.items, &of[0], t, x[0]) &&
                oracle_turning_place(step->joints.items, &of[1], t, x[1]);
    for (int k = 0; k < 12 && fits; k++) {
        m[k] = k < 3 ? x[0][0][k] : x[1][k / 3 - 1][k % 3] - x[0][0][k % 3];
    }
    return fits;
}

bool verify_turning_places(const struct play_step *step, struct verify_result *result)
{
    const struct registry_scene *scene = step->scene;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];
        struct verify_path path;
        double extent = 0, size = 0;
        if (!object->turned || !set_transform(step, object->joint, 0, path.m[0])) {
            continue;
        }
        measure(object, &extent, &size);
        size += length_of_joints(step);
        for (uint32_t v = 0; v < object->mesh->vertex_count; v++) {
            double x[3], place[3];
            registry_registered(object->mesh, v, x);
            verify_path_place(&path, x, 0, place);
            for (int k = 0; k < 3; k++) {
                if (!(fabs(place[k] - object->x0[v][k]) <= ROUNDING * size)) {
                    return verify_wrong(result, step, NULL,
                                        "vertex %" PRIu32 " of 0x%" PRIx32
                                        " begins elsewhere than its joints say",
                                        v, object->handle);
                }
            }
        }
    }
    return true;
}

struct verify_path *verify_paths(const struct play_step *step)
{
    const struct registry_scene *scene = step->scene;
    struct verify_path *paths =
        verify_has_turning(step) ? calloc(scene->object_count, sizeof *paths) : NULL;
    for (uint32_t i = 0; i < scene->object_count && paths != NULL; i++) {
        for (uint32_t at = 0; at < VERIFY_TIMES && scene->objects[i].turned; at++) {
            double t = (double)at / (VERIFY_TIMES - 1);
            (void)set_transform(step, scene->objects[i].joint, t, paths[i].m[at]);
        }
    }
    return paths;
}

void verify_path_place(const struct verify_path *path, const double x[3], uint32_t at,
                       double place[3])
{
    const double *m = path->m[at];
    for (int k = 0; k < 3; k++) {
        place[k] = m[k] + x[0] * m[3 + k] + x[1] * m[6 + k] + x[2] * m[9 + k];
    }
}
