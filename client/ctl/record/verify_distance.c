/* verify_distance.c - whether an answer about what is near is right. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "names.h"
#include "oracle_near.h"
#include "payload.h"
#include "registry.h"
#include "verify.h"

#define DECISIONS_MAX 4000000u /* exact ones for one answer: a minute */

struct judge {
    const struct play_step *near;
    struct verify_result *result;
    /* What the answer must say beside its records. */
    uint32_t verdict;
    uint64_t crossings;
    struct oracle_object *objects;
    struct oracle_moment moment;
};

static bool wrong(struct judge *judge, const char *what, uint64_t at)
{
    struct verify_witness *witness = &judge->result->witness;
    judge->result->is_wrong = true;
    memset(witness, 0, sizeof *witness);
    witness->step = judge->near->number;
    (void)snprintf(witness->what, sizeof witness->what,
                   "what is near: record %" PRIu64 ": %.140s", at, what);
    return false;
}

static bool may_meet(const void *context, uint32_t a, uint32_t b)
{
    const struct registry_scene *scene = context;
    return registry_may_meet(scene, registry_object(scene, a), registry_object(scene, b));
}

/* Radii of vertices, and where they were registered. false: no memory. */
static bool add_thickness(const struct registry_object *object, struct oracle_object *to)
{
    uint32_t count = object->mesh->vertex_count;
    double *radii = malloc(((size_t)count + 1) * sizeof *radii);
    double(*registered)[3] = malloc(((size_t)count + 1) * sizeof *registered);
    to->radii = radii;
    to->registered = (const double(*)[3])registered;
    to->rest_distance = object->attributes.rest_distance;
    to->rest_rings = object->attributes.rest_rings;
    for (uint32_t v = 0; radii != NULL && registered != NULL && v < count; v++) {
        radii[v] = recorded_radius(object, &v, 1);
        registry_registered(object->mesh, v, registered[v]);
    }
    return radii != NULL && registered != NULL;
}

static void free_moment(struct judge *judge)
{
    for (uint32_t i = 0; judge->objects != NULL && i < judge->moment.object_count; i++) {
        free((void *)judge->objects[i].radii);
        free((void *)judge->objects[i].registered);
    }
    free(judge->objects);
}

/* Free it in any case. false: no memory. */
static bool make_moment(struct judge *judge)
{
    const struct registry_scene *scene = judge->near->scene;
    uint32_t what = judge->near->asked->what;
    bool has_memory = true;
    judge->objects = calloc((size_t)scene->object_count + 1, sizeof *judge->objects);
    for (uint32_t i = 0; judge->objects != NULL && i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];
        const double(*x)[3] =
            (const double(*)[3])(judge->near->asked->end == 0 ? object->x0 : object->x1);
        judge->objects[i] = (struct oracle_object){
            .object_id = object->handle,
            .vertex_count = object->mesh->vertex_count,
            .triangle_count = object->mesh->triangle_count,
            .x0 = x,
            .x1 = x,
            .triangles = (const uint32_t(*)[3])object->mesh->triangles,
            .edge_count = object->mesh->named_edge_count,
            .point_count = object->mesh->named_point_count,
            .edges = (const uint32_t(*)[2])object->mesh->named_edges,
            .points = object->mesh->named_points};
        has_memory = add_thickness(object, &judge->objects[i]) && has_memory;
    }
    judge->moment = (struct oracle_moment){.objects = judge->objects,
                                           .object_count = scene->object_count,
                                           .may_meet = may_meet,
                                           .context = scene};
    oracle_moment_thicken(&judge->moment, what);
    return judge->objects != NULL && has_memory;
}

/* ---- numbers ----------------------------------------------------------------------- */

/* Numbers of an answer that follow from its records. */
struct numbers {
    uint64_t total, counts[PCCD_KINDS_MAX];
    double distance_min, distance_max;
    uint64_t hash[2];
};

static const char *check_recorded(const struct judge *judge, const struct numbers *is)
{
    struct record_answer must = {.step = judge->near->number,
                                 .is_near = 1,
                                 .what = judge->near->asked->what,
                                 .verdict = judge->verdict,
                                 .total = is->total,
                                 .distance_min = is->distance_min,
                                 .distance_max = is->distance_max,
                                 .crossings = judge->crossings};
    memcpy(must.counts, is->counts, sizeof must.counts);
    memcpy(must.hash, is->hash, sizeof must.hash);
    return verify_recorded(judge->near->recorded, must);
}

static const char *check_daemon(const struct judge *judge, const struct numbers *is)
{
    const struct pccd_answer *now = judge->near->answer;
#define SAME(member)                                                                     \
    if (memcmp(&now->member, &is->member, sizeof is->member) != 0) {                     \
        return #member;                                                                  \
    }
    SAME(total)
    SAME(counts)
    SAME(distance_min)
    SAME(distance_max)
    SAME(hash)
#undef SAME
    return (uint32_t)now->what != judge->near->asked->what ? "what"
           : (uint32_t)now->verdict != judge->verdict      ? "verdict"
           : now->crossings != judge->crossings            ? "crossings"
                                                           : NULL;
}

/* Both answers, where they have all records: these are right. With a gap the records, and
 * so the numbers, of two right answers may differ. */
static bool check_numbers(struct judge *judge, const struct numbers *is)
{
    const struct play_step *near = judge->near;
    const struct record_answer *then = near->recorded;
    const char *name = near->answer != NULL ? check_daemon(judge, is) : NULL;
    bool is_other = near->answer != NULL && play_has_gap(near->asked);
    if (name == NULL && then != NULL) {
        if (!play_is_complete(then->incomplete) || is_other) {
            verify_leave(judge->result, "%s: only a daemon's answer was checked",
                         is_other ? "it has a gap, with which answers may differ"
                                  : "it ended before it was done");
        } else {
            name = check_recorded(judge, is);
        }
    }
    if (name != NULL) {
        char what[120];
        (void)snprintf(what, sizeof what, "%s: it is not that of the records", name);
        return wrong(judge, what, near->found.count);
    }
    judge->result->counts.near_records += near->found.count;
    return true;
}

/* By records. */
static bool check_sums(struct judge *judge)
{
    const struct play_step *near = judge->near;
    struct numbers is = {.total = near->found.count, .distance_min = 2e18};
    record_answer_hash(near->nears, near->found.count, sizeof *near->nears, is.hash);
    if (play_has_gap(near->asked)) {
        memset(is.hash, 0, sizeof is.hash);
    }
    for (uint64_t i = 0; i < near->found.count; i++) {
        is.counts[near->nears[i].kind]++; /* it was found right */
        is.distance_min = fmin(is.distance_min, near->nears[i].d_lo);
        is.distance_max = fmax(is.distance_max, near->nears[i].d_hi);
    }
    return check_numbers(judge, &is);
}

/* Every record and nothing else. */
static bool check_records(struct judge *judge, const struct oracle_nears *truth)
{
    const struct play_step *near = judge->near;
    for (uint64_t i = 0; i < near->found.count && i < truth->count; i++) {
        const struct pccd_near *is = &near->nears[i], *must = &truth->items[i].record;
        if (memcmp(is, must, sizeof *is) != 0) {
            char what[160];
            (void)snprintf(what, sizeof what,
                           "%s %" PRIu32 " of 0x%" PRIx32 " and %" PRIu32 " of 0x%" PRIx32
                           " at %.17g, exact: %s %" PRIu32 " of 0x%" PRIx32
                           " and %" PRIu32 " of 0x%" PRIx32 " at %.17g",
                           is->kind < COMMON_KIND_COUNT ? common_kinds[is->kind].name
                                                        : "unknown",
                           is->feature_a, is->object_a, is->feature_b, is->object_b,
                           is->d_lo, common_kinds[must->kind].name, must->feature_a,
                           must->object_a, must->feature_b, must->object_b, must->d_lo);
            return wrong(judge, what, i);
        }
    }
    if (near->found.count != truth->count) {
        return wrong(judge,
                     near->found.count < truth->count
                         ? "it is missing, as are those behind it"
                         : "there is nothing more that is near",
                     near->found.count < truth->count ? near->found.count : truth->count);
    }
    return check_sums(judge);
}

/* Check the bounds of one object, which are those of the answer from `at` on if it was
 * asked about; and find the least and greatest of them that a pair makes. */
static bool check_object(struct judge *judge, const struct oracle_nears *pairs,
                         uint32_t object, struct record_bound *records, uint64_t *at,
                         struct numbers *is)
{
    const struct play_step *near = judge->near;
    const struct oracle_object *of = &judge->objects[object];
    uint32_t only = near->asked->objects[0];
    bool is_asked = only == 0 || only == of->object_id;
    double *bounds = malloc(((size_t)of->vertex_count + 1) * sizeof *bounds);
    bool is_right = bounds != NULL || wrong(judge, "no memory", near->found.count);
    if (is_right && is_asked && of->vertex_count > near->found.count - *at) {
        is_right = wrong(judge, "a vertex has no bound", near->found.count);
    }
    if (is_right) {
        oracle_near_bounds(&judge->moment, pairs, object, INFINITY, bounds);
    }
    for (uint32_t v = 0; v < of->vertex_count && is_right; v++) {
        if (bounds[v] < INFINITY) {
            is->distance_min = fmin(is->distance_min, bounds[v]);
            is->distance_max = fmax(is->distance_max, bounds[v]);
        }
        double bound = fmin(bounds[v], near->asked->distance);
        if (is_asked && memcmp(&bound, &near->bounds[*at], sizeof bound) != 0) {
            char what[120];
            (void)snprintf(what, sizeof what, "bound %.17g, exact: %.17g",
                           near->bounds[*at], bound);
            is_right = wrong(judge, what, *at);
        } else if (is_asked) {
            records[(*at)++] = (struct record_bound){of->object_id, v, bound};
        }
    }
    free(bounds);
    return is_right;
}

/* One after the other, of all objects or of the one that was asked for. */
static bool check_bounds(struct judge *judge, const struct oracle_nears *pairs)
{
    const struct play_step *near = judge->near;
    struct numbers is = {.total = near->found.count, .distance_min = 2e18};
    struct record_bound *records = malloc((near->found.count + 1) * sizeof *records);
    uint64_t at = 0;
    bool is_right = records != NULL || wrong(judge, "no memory", near->found.count);
    for (uint32_t i = 0; i < judge->moment.object_count && is_right; i++) {
        is_right = check_object(judge, pairs, i, records, &at, &is);
    }
    if (is_right && at != near->found.count) {
        is_right = wrong(judge, "there is no such vertex", at);
    }
    if (is_right) {
        record_answer_hash(records, at, sizeof *records, is.hash);
        is_right = check_numbers(judge, &is);
    }
    free(records);
    return is_right;
}

/* Check how many edges pass through faces. */
static bool check_count(struct judge *judge, uint64_t crossings)
{
    const struct play_step *near = judge->near;
    char what[120];
    uint64_t said =
        near->answer != NULL ? near->answer->crossings : near->recorded->crossings;
    judge->crossings = crossings;
    (void)snprintf(what, sizeof what,
                   "%" PRIu64 " edges pass through faces, exact: %" PRIu64, said,
                   crossings);
    return said == crossings || wrong(judge, what, near->found.count);
}

/* NO only where nothing crosses and nothing touches. */
static bool check_crossings(struct judge *judge, const struct oracle_nears *crossings,
                            const struct oracle_nears *touching)
{
    const struct play_step *near = judge->near;
    bool intersects = crossings->count + touching->count > 0;
    judge->verdict = intersects ? PCCD_VERDICT_YES : PCCD_VERDICT_NO;
    uint32_t verdict =
        near->answer != NULL ? (uint32_t)near->answer->verdict : near->recorded->verdict;
    if (verdict != judge->verdict) {
        return wrong(judge,
                     intersects ? "something intersects or touches, and it says no"
                                : "nothing intersects or touches, and it says yes",
                     near->found.count);
    }
    return check_count(judge, crossings->count) && check_records(judge, crossings);
}

/* ---- objects two by two ------------------------------------------------------------ */

static bool are_of_one_pair(const struct pccd_near *a, const struct pccd_near *b)
{
    return (a->object_a == b->object_a && a->object_b == b->object_b) ||
           (a->object_a == b->object_b && a->object_b == b->object_a);
}

/* Return whether the surfaces of a pair are at most the distance apart, and no farther
 * than those of the nearest by more than the gap; but for what rounding takes or adds. */
static bool is_within_gap(const struct oracle_near *is, const struct oracle_near *nearest,
                          const struct record_frame *asked)
{
    double radii = is->radius[0] + is->radius[1];
    double of_nearest = nearest->radius[0] + nearest->radius[1];
    double slack = 0x1p-50 * (radii + of_nearest);
    double apart = is->record.d_lo - radii - slack;
    return apart <= nearest->record.d_hi - of_nearest + asked->gap &&
           apart <= asked->distance;
}

/* With a gap: of each two objects that have a nearest pair some pair, which is its own
 * numbers long, and no farther than the nearest by more than the gap. */
static bool check_with_gap(struct judge *judge, const struct oracle_nears *truth)
{
    const struct play_step *near = judge->near;
    for (uint64_t i = 0; i < near->found.count; i++) {
        const struct pccd_near *is = &near->nears[i];
        struct oracle_near must, before;
        size_t at = 0;
        while (at < truth->count && !are_of_one_pair(is, &truth->items[at].record)) {
            at++;
        }
        if (at == truth->count || !oracle_objects_measure(&judge->moment, is, &must)) {
            return wrong(judge, "it names no pair of two objects that are near", i);
        }
        must.record.flags |= (uint32_t)PCCD_NEAR_GAP;
        if (memcmp(is, &must.record, sizeof *is) != 0) {
            return wrong(judge, "its numbers are not those of its pair", i);
        }
        if (!is_within_gap(&must, &truth->items[at], near->asked)) {
            return wrong(judge, "another pair is nearer by more than the gap", i);
        }
        before.record = near->nears[i > 0 ? i - 1 : 0];
        if (i > 0 && oracle_near_compare(&before, &must) >= 0) {
            return wrong(judge, "it does not come after the one before", i);
        }
    }
    return near->found.count == truth->count
               ? check_sums(judge)
               : wrong(judge, "two objects have no pair, or more than one",
                       near->found.count);
}

/* As check. */
static int check_objects(struct judge *judge)
{
    const struct record_frame *asked = judge->near->asked;
    struct oracle_nears truth = {.count = 0};
    uint64_t crossings = 0;
    int is_right = -1;
    if (asked->what == PCCD_NEAR_DEPTH) {
        if (oracle_objects_depth(&judge->moment, asked->objects, DECISIONS_MAX, &truth,
                                 &crossings)) {
            is_right = check_count(judge, crossings) && check_records(judge, &truth);
        }
    } else if (oracle_objects_nearest(&judge->moment, asked->objects, asked->distance,
                                      DECISIONS_MAX, &truth)) {
        is_right = play_has_gap(asked) ? check_with_gap(judge, &truth)
                                       : check_records(judge, &truth);
    }
    oracle_nears_deinit(&truth);
    return is_right;
}

/* ---- the question ------------------------------------------------------------------ */

/* 1: right, 0: wrong, -1: too much to decide. */
static int check(struct judge *judge)
{
    const struct record_frame *asked = judge->near->asked;
    bool crosses = asked->what == PCCD_NEAR_CROSSINGS;
    struct oracle_nears pairs = {.count = 0}, more = {.count = 0};
    int is_right = -1;
    if (judge->near->asked->tells && common_near_has_all_pairs(asked->what)) {
        if (!oracle_near_crossings(&judge->moment, DECISIONS_MAX, &more)) {
            return -1;
        }
        judge->crossings = more.count; /* which the answer's numbers are compared with */
        oracle_nears_deinit(&more);
    }
    if (common_near_is_of_objects(asked->what)) {
        return check_objects(judge);
    }
    if (!oracle_near_pairs(&judge->moment, crosses ? 0 : asked->distance, DECISIONS_MAX,
                           &pairs)) {
        return -1;
    }
    if (crosses && oracle_near_crossings(&judge->moment, DECISIONS_MAX, &more)) {
        is_right = check_crossings(judge, &more, &pairs);
    } else if (asked->what == PCCD_NEAR_PAIRS) {
        is_right = check_records(judge, &pairs);
    } else if (asked->what == PCCD_NEAR_FEATURES) {
        oracle_near_features(&judge->moment, &pairs, &more);
        is_right = check_records(judge, &more);
    } else if (asked->what == PCCD_NEAR_VERTICES) {
        is_right = check_bounds(judge, &pairs);
    }
    oracle_nears_deinit(&pairs);
    oracle_nears_deinit(&more);
    return is_right;
}

/* ---- how a step begins ------------------------------------------------------------- */

/* True: it is known, and was not too much to decide. */
static bool find_start(struct judge *judge, const struct record_frame *frame,
                       struct verify_start *start)
{
    struct oracle_nears crossings = {.count = 0}, pairs = {.count = 0};
    start->is_known =
        oracle_near_crossings(&judge->moment, DECISIONS_MAX, &crossings) &&
        (frame->approach == 0 ||
         oracle_near_pairs(&judge->moment, frame->separation, DECISIONS_MAX, &pairs));
    start->crossings = crossings.count;
    start->inside = pairs.count;
    oracle_nears_deinit(&crossings);
    oracle_nears_deinit(&pairs);
    return start->is_known;
}

/* The count of an answer of mode any is what was found before something decided it. */
static bool is_count(const struct play_step *step, uint64_t said, uint64_t is)
{
    return verify_mode(step) == PCCD_MODE_ANY ? said <= is : said == is;
}

bool verify_start(const struct play_step *step, struct verify_result *result,
                  struct verify_start *start, struct ctl_error *error, int *status)
{
    const struct pccd_answer *now = step->answer;
    const struct record_frame asked = {.what = PCCD_NEAR_PAIRS, .end = 0};
    const struct play_step near = {
        .frame = &asked, .asked = &asked, .scene = step->scene};
    struct judge judge = {.near = &near, .result = result};
    *start = (struct verify_start){.is_known = false};
    if (!step->frame->tells) {
        return now == NULL || now->crossings + now->start_inside == 0 ||
               verify_wrong(result, step, NULL, "it tells how it begins, unasked");
    }
    if (!verify_is_complete(step)) {
        return true;
    }
    if (!verify_turning_places(step, result)) {
        return false;
    }
    const struct registry_pairs *pairs = &step->scene->pairs;
    for (uint32_t i = 0; i < pairs->count && step->frame->approach > 0; i++) {
        if (pairs->said[i].has_clearance) { /* such a step is refused */
            return verify_wrong(result, step, NULL,
                                "it says how it begins, but objects have a clearance");
        }
    }
    bool has_memory = make_moment(&judge);
    bool is_known = has_memory && find_start(&judge, step->frame, start);
    free_moment(&judge);
    if (!has_memory) {
        *status = ctl_error_set(error, PCCD_E_NOMEM, "no memory for how a step begins");
        return true;
    }
    if (!is_known) {
        return verify_leave(result, "how it begins is more than can be decided");
    }
    return now == NULL ||
           (is_count(step, now->crossings, start->crossings) &&
            is_count(step, now->start_inside, start->inside)) ||
           verify_wrong(result, step, NULL,
                        "it begins with %" PRIu64 " crossings, and %" PRIu64
                        " pairs inside, exact: %" PRIu64 " and %" PRIu64,
                        now->crossings, now->start_inside, start->crossings,
                        start->inside);
}

/* Return why the answers to a question cannot be; NULL: they can. */
static const char *misfit(const struct play_step *near)
{
    const struct record_answer *then = near->recorded;
    const struct pccd_answer *now = near->answer;
    if (now != NULL && then != NULL && now->status != then->status) {
        return "the recorded status is not that of a daemon";
    }
    if (then != NULL && then->status != PCCD_OK) {
        return verify_is_bare(then) ? NULL
                                    : "the question failed, and its answer has numbers";
    }
    if (near->found.is_torn) {
        return "a page of records that was fetched twice was not the same";
    }
    if (now != NULL || then == NULL) {
        return NULL;
    }
    if (then->incomplete > PCCD_INCOMPLETE_CONTACT_LIMIT) {
        return "the answer ended for no reason that there is";
    }
    if (near->found.count > then->total ||
        (near->found.count > 0 && near->found.count < then->total &&
         then->incomplete == PCCD_COMPLETE)) {
        return "its total is not that of the records";
    }
    if (near->found.is_whole && play_is_complete(then->incomplete) &&
        (then->incomplete == PCCD_COMPLETE) !=
            (near->found.first_count == near->found.count)) {
        return "whether its first page has all of it is claimed wrongly";
    }
    return NULL;
}

static bool can_check(const struct play_step *near, struct verify_result *result)
{
    const struct record_answer *then = near->recorded;
    const struct pccd_answer *now = near->answer;
    if (now == NULL && then == NULL) {
        verify_leave(result, "it has no answer");
        return false;
    }
    int status = now != NULL ? now->status : then->status;
    uint32_t incomplete = now != NULL ? (uint32_t)now->incomplete : then->incomplete;
    if (status != PCCD_OK) {
        verify_leave(result, "it failed: %s", pccd_status_text(status));
    } else if (near->scene == NULL) {
        verify_leave(result, "its scene is gone");
    } else if (!play_is_complete(incomplete)) {
        verify_leave(result, "it ended before it was done");
    } else if (!near->found.is_whole) {
        verify_leave(result, "%" PRIu64 " of its %" PRIu64 " records are known",
                     near->found.count, now != NULL ? now->total : then->total);
    }
    return result->unchecked[0] == '\0';
}

int verify_distances(const struct play_step *near, struct verify_result *result,
                     struct ctl_error *error)
{
    struct judge judge = {.near = near, .result = result, .verdict = PCCD_VERDICT_NONE};
    const char *what = misfit(near);
    memset(result, 0, sizeof *result);
    result->step = near->number;
    result->is_near = true;
    result->counts.nears = 1;
    if (what != NULL) {
        wrong(&judge, what, near->found.count);
        return PCCD_OK;
    }
    if (!can_check(near, result)) {
        result->counts.nears_unchecked = 1;
        return PCCD_OK;
    }
    if (!make_moment(&judge)) {
        free_moment(&judge);
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what is near");
    }
    if (check(&judge) < 0) {
        result->counts.nears_unchecked = 1;
        verify_leave(result, "more pairs are near than can be decided");
    }
    free_moment(&judge);
    return PCCD_OK;
}
