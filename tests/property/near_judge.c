/* near_judge.c - the laws of an answer about what is near. */
#include "near_judge.h"

#include "names.h"
#include "oracle_near.h"

/* Truth about a question. */
struct truth {
    struct oracle_nears pairs;
    struct oracle_nears features;
    struct oracle_nears crossings;
    struct oracle_nears objects; /* by which two of them */
    uint64_t through;            /* edges that pass through faces of other objects */
};

bool near_may_meet(const void *context, uint32_t a, uint32_t b)
{
    const struct player *player = context;
    return filters_may_meet(&player->filters, a, b);
}

static int compare_objects(const void *a, const void *b)
{
    uint32_t left = ((const struct oracle_object *)a)->object_id;
    uint32_t right = ((const struct oracle_object *)b)->object_id;
    return left < right ? -1 : left > right;
}

void near_objects_list(const struct player *player, struct near_objects *objects)
{
    for (uint32_t i = 0; i < player->object_count; i++) {
        const struct player_object *object = &player->objects[i];
        objects->items[i] =
            (struct oracle_object){.object_id = object->id,
                                   .vertex_count = object->vertex_count,
                                   .triangle_count = object->triangle_count,
                                   .x0 = (const double(*)[3])object->x0,
                                   .x1 = (const double(*)[3])object->x1,
                                   .triangles = (const uint32_t(*)[3])object->triangles,
                                   .radii = object->radii,
                                   .registered = (const double(*)[3])object->registered,
                                   .rest_distance = object->thickness.rest_distance,
                                   .rest_rings = object->thickness.rest_rings};
    }
    if (player->object_count > 0) {
        qsort(objects->items, player->object_count, sizeof objects->items[0],
              compare_objects);
    }
}

/* Return whether crossings count, too: the question is about them, or says so. */
static bool has_crossings(const struct eng_question *settings)
{
    return settings->verb == PCCD_NEAR_CROSSINGS ||
           (common_near_has_all_pairs(settings->verb) && settings->tells_crossings);
}

/* false: it would take too long. */
static bool find_truth(const struct oracle_moment *moment,
                       const struct eng_question *settings, uint64_t queries_max,
                       struct truth *truth)
{
    bool crosses = settings->verb == PCCD_NEAR_CROSSINGS;
    memset(truth, 0, sizeof *truth);
    if (settings->verb == PCCD_NEAR_NEAREST) {
        return oracle_objects_nearest(moment, settings->objects, settings->distance,
                                      queries_max, &truth->objects);
    }
    if (settings->verb == PCCD_NEAR_DEPTH) {
        return oracle_objects_depth(moment, settings->objects, queries_max,
                                    &truth->objects, &truth->through);
    }
    if (has_crossings(settings) &&
        !oracle_near_crossings(moment, queries_max, &truth->crossings)) {
        return false;
    }
    if (!oracle_near_pairs(moment, crosses ? 0 : settings->distance, queries_max,
                           &truth->pairs)) {
        return false;
    }
    if (settings->verb == PCCD_NEAR_FEATURES) {
        oracle_near_features(moment, &truth->pairs, &truth->features);
    }
    return true;
}

static void truth_deinit(struct truth *truth)
{
    oracle_nears_deinit(&truth->pairs);
    oracle_nears_deinit(&truth->features);
    oracle_nears_deinit(&truth->crossings);
    oracle_nears_deinit(&truth->objects);
}

/* ---- records ----------------------------------------------------------------------- */

static bool are_same(const struct pccd_near *a, const struct pccd_near *b, bool counted)
{
    struct pccd_near left = *a;
    if (!counted) {
        left.count = b->count;
    }
    return memcmp(&left, b, sizeof left) == 0;
}

/* For whoever looks for what was wrong. */
static void tell(const char *whose, const struct pccd_near *near)
{
    print_message("# %s: kind %u, type %u, %u/%u %u/%u, d %a .. %a, param %a %a, "
                  "direction %a %a %a, count %u\n",
                  whose, near->kind, PCCD_NEAR_TYPE(near->flags), near->object_a,
                  near->feature_a, near->object_b, near->feature_b, near->d_lo,
                  near->d_hi, (double)near->param[0], (double)near->param[1],
                  (double)near->direction[0], (double)near->direction[1],
                  (double)near->direction[2], near->count);
}

/* The first records of the truth, as many as there are. */
static const char *check_first(const struct oracle_nears *nears,
                               const struct eng_step_result *result)
{
    const struct pccd_near *records = result->records;
    for (uint64_t i = 0; i < result->count; i++) {
        const struct pccd_near *want = &nears->items[i].record;
        if (i >= nears->count) {
            return "there are too many records";
        }
        if (!are_same(&records[i], want, true)) {
            tell("is", &records[i]);
            tell("must be", want);
            return are_same(&records[i], want, false) ? "what a record counts"
                                                      : "a record";
        }
    }
    return NULL;
}

/* Some of the truth, in order. */
static const char *check_part(const struct oracle_nears *nears,
                              const struct eng_step_result *result)
{
    const struct pccd_near *records = result->records;
    size_t at = 0;
    for (uint64_t i = 0; i < result->count; i++) {
        while (at < nears->count &&
               !are_same(&records[i], &nears->items[at].record, false)) {
            at++;
        }
        if (at == nears->count) {
            tell("is", &records[i]);
            return "a record of an answer that was cut is not true";
        }
        if (records[i].count == 0 || records[i].count > nears->items[at].record.count) {
            return "what a record of an answer that was cut counts";
        }
        at++;
    }
    return NULL;
}

/* Numbers about the records that are there. */
static const char *check_numbers(const struct eng_step_result *result)
{
    const struct pccd_near *records = result->records;
    uint64_t counts[PCCD_KINDS_MAX] = {0};
    uint64_t hash[2];
    double least = 2e18;
    double greatest = 0;
    for (uint64_t i = 0; i < result->count; i++) {
        counts[records[i].kind]++;
        least = fmin(least, records[i].d_lo);
        greatest = fmax(greatest, records[i].d_hi);
    }
    if (memcmp(counts, result->counts, sizeof counts) != 0) {
        return "the number of records by kind";
    }
    if (result->distance_min != least || result->distance_max != greatest) {
        return "the least or the greatest distance";
    }
    answer_hash(records, result->count, sizeof *records, hash);
    return memcmp(hash, result->hash, sizeof hash) != 0 ? "the hash" : NULL;
}

static const char *check_records(const struct oracle_nears *nears, bool is_limited,
                                 const struct eng_step_result *result)
{
    const char *wrong = NULL;
    if (result->record_bytes != sizeof(struct pccd_near)) {
        return "the size of a record";
    }
    switch (result->incomplete) {
    case PCCD_COMPLETE:
        wrong = check_first(nears, result);
        wrong = !wrong && result->count != nears->count ? "records are missing" : wrong;
        break;
    case PCCD_INCOMPLETE_CONTACT_LIMIT:
        wrong = check_first(nears, result);
        wrong = !wrong && !is_limited ? "it says that there are too many" : wrong;
        break;
    default:
        wrong = check_part(nears, result);
    }
    return wrong ? wrong : check_numbers(result);
}

/* ---- two objects ------------------------------------------------------------------- */

static bool are_same_two(const struct pccd_near *a, const struct pccd_near *b)
{
    return (a->object_a == b->object_a && a->object_b == b->object_b) ||
           (a->object_a == b->object_b && a->object_b == b->object_a);
}

/* Return how far the surfaces of two features are apart, nearly: their distance without
 * radii. */
static long double surfaces_of(const struct oracle_near *near, double distance)
{
    return (long double)distance - near->radius[0] - near->radius[1];
}

static const char *check_gap(const struct oracle_moment *moment,
                             const struct eng_question *settings,
                             const struct oracle_nears *nearest,
                             const struct pccd_near *is, struct near_sums *sums)
{
    struct oracle_near must_be;
    size_t at = 0;
    while (at < nearest->count && !are_same_two(is, &nearest->items[at].record)) {
        at++;
    }
    if (at == nearest->count) {
        return "two objects have a pair with a gap alone";
    }
    if (!oracle_objects_measure(moment, is, &must_be)) {
        return "no such pair";
    }
    must_be.record.flags |= (uint32_t)PCCD_NEAR_GAP;
    if (!are_same(is, &must_be.record, true)) {
        tell("is", is);
        tell("must be", &must_be.record);
        return "a number of a pair with a gap";
    }
    const struct oracle_near *best = &nearest->items[at];
    long double apart = surfaces_of(&must_be, is->d_lo);
    sums->gaps++;
    sums->others += is->d_lo != best->record.d_lo;
    return apart > surfaces_of(best, best->record.d_hi) + settings->gap ||
                   apart > settings->distance
               ? "a pair with a gap is too far away"
               : NULL;
}

static const char *check_gaps(const struct oracle_moment *moment,
                              const struct eng_question *settings,
                              const struct oracle_nears *nearest,
                              const struct eng_step_result *result,
                              struct near_sums *sums)
{
    const struct pccd_near *records = result->records;
    if (result->incomplete == PCCD_COMPLETE && result->count != nearest->count) {
        return "two objects have a pair without a gap alone, or twice";
    }
    for (uint64_t i = 0; i < result->count; i++) {
        for (uint64_t k = 0; k < i; k++) {
            if (are_same_two(&records[k], &records[i])) {
                return "two objects have two pairs with a gap";
            }
        }
        const char *wrong = check_gap(moment, settings, nearest, &records[i], sums);
        if (wrong) {
            return wrong;
        }
    }
    return NULL;
}

static const char *check_objects(const struct oracle_moment *moment,
                                 const struct truth *truth,
                                 const struct eng_question *settings,
                                 const struct eng_step_result *result,
                                 struct near_sums *sums)
{
    bool is_limited = truth->objects.count > settings->contact_max;
    bool is_depth = settings->verb == PCCD_NEAR_DEPTH;
    bool is_whole = result->incomplete == PCCD_COMPLETE;
    sums->nearest += is_depth ? 0 : truth->objects.count;
    sums->inside += is_depth ? truth->objects.count : 0;
    sums->through += truth->through;
    if (is_depth && is_whole && result->crossings != truth->through) {
        return "how many edges pass through";
    }
    return settings->gap > 0 ? check_gaps(moment, settings, &truth->objects, result, sums)
                             : check_records(&truth->objects, is_limited, result);
}

/* ---- bounds ------------------------------------------------------------------------ */

static const char *compare_bounds(const struct eng_vertex_bound *want, uint64_t count,
                                  const struct eng_step_result *result)
{
    const double *given = result->records;
    uint64_t hash[2];
    if (result->count != count || result->record_bytes != sizeof *given) {
        return "the number of bounds";
    }
    for (uint64_t i = 0; i < count; i++) {
        if (given[i] != want[i].bound) {
            return "a bound";
        }
    }
    answer_hash(want, count, sizeof *want, hash);
    return memcmp(hash, result->hash, sizeof hash) != 0 ? "the hash of the bounds" : NULL;
}

/* The least and the greatest that any vertex of the scene has of a pair. */
static const char *check_extremes(const struct oracle_moment *moment,
                                  const struct truth *truth,
                                  const struct eng_step_result *result)
{
    double least = 2e18;
    double greatest = 0;
    for (uint32_t i = 0; i < moment->object_count; i++) {
        uint32_t count = moment->objects[i].vertex_count;
        double *bounds = oracle_grow(NULL, (count + 1) * sizeof *bounds);
        oracle_near_bounds(moment, &truth->pairs, i, INFINITY, bounds);
        for (uint32_t v = 0; v < count; v++) {
            least = fmin(least, bounds[v]);
            greatest = bounds[v] < INFINITY ? fmax(greatest, bounds[v]) : greatest;
        }
        free(bounds);
    }
    return result->distance_min != least || result->distance_max != greatest
               ? "the least or the greatest bound"
               : NULL;
}

static const char *check_bounds(const struct oracle_moment *moment,
                                const struct truth *truth,
                                const struct eng_question *settings,
                                const struct eng_step_result *result,
                                struct near_sums *sums)
{
    struct eng_vertex_bound *want = NULL;
    uint64_t all = 0;
    for (uint32_t i = 0; i < moment->object_count; i++) {
        uint32_t id = moment->objects[i].object_id;
        uint32_t count = moment->objects[i].vertex_count;
        if (settings->objects[0] != 0 && settings->objects[0] != id) {
            continue;
        }
        double *bounds = oracle_grow(NULL, (count + 1) * sizeof *bounds);
        want = oracle_grow(want, (all + count + 1) * sizeof *want);
        oracle_near_bounds(moment, &truth->pairs, i, settings->distance, bounds);
        for (uint32_t v = 0; v < count; v++) {
            want[all++] = (struct eng_vertex_bound){id, v, bounds[v]};
            sums->bounds += bounds[v] < settings->distance;
        }
        free(bounds);
    }
    const char *wrong = compare_bounds(want, all, result);
    free(want);
    return wrong ? wrong : check_extremes(moment, truth, result);
}

/* ---- the whole --------------------------------------------------------------------- */

/* Nothing is said to be free of intersections, or not, that was not looked at. */
static const char *check_verdict(const struct truth *truth,
                                 const struct eng_question *settings,
                                 const struct eng_step_result *result)
{
    bool is_free = truth->crossings.count == 0 && truth->pairs.count == 0;
    if (common_near_has_all_pairs(result->what) && result->incomplete == PCCD_COMPLETE &&
        result->crossings != truth->crossings.count) {
        return "what crosses beside what was asked";
    }
    if (settings->verb != PCCD_NEAR_CROSSINGS) {
        return result->verdict != PCCD_VERDICT_NONE ? "a verdict of nothing" : NULL;
    }
    if (result->crossings != result->count) {
        return "the number of crossings";
    }
    if (result->incomplete != PCCD_COMPLETE) {
        return result->verdict != PCCD_VERDICT_NONE ? "a verdict before the end" : NULL;
    }
    return result->verdict != (is_free ? PCCD_VERDICT_NO : PCCD_VERDICT_YES)
               ? "the verdict"
               : NULL;
}

static void sum_up(const struct truth *truth, const struct eng_question *settings,
                   const struct eng_step_result *result, struct near_sums *sums)
{
    sums->judged++;
    sums->queries +=
        truth->pairs.queries + truth->crossings.queries + truth->objects.queries;
    sums->pairs += truth->pairs.count;
    sums->features += truth->features.count;
    for (size_t i = 0; i < truth->features.count; i++) {
        sums->merged += truth->features.items[i].record.count - 1;
    }
    sums->crossings += truth->crossings.count;
    sums->beside +=
        common_near_has_all_pairs(settings->verb) ? truth->crossings.count : 0;
    sums->parts += result->incomplete != PCCD_COMPLETE ? result->count : 0;
    sums->free += settings->verb == PCCD_NEAR_CROSSINGS && truth->crossings.count == 0 &&
                  truth->pairs.count == 0;
    sums->ties += truth->objects.ties;
    for (size_t i = 0; i < truth->objects.count; i++) {
        const struct pccd_near *record = &truth->objects.items[i].record;
        bool is_nearest = settings->verb == PCCD_NEAR_NEAREST;
        sums->touching_objects += record->d_hi == 0;
        sums->crossed += record->kind == PCCD_EF;
        sums->thick += is_nearest && record->d_lo > settings->distance;
    }
    for (size_t i = 0; i < truth->pairs.count; i++) {
        const struct pccd_near *record = &truth->pairs.items[i].record;
        sums->types[PCCD_NEAR_TYPE(record->flags)]++;
        sums->touching += record->d_hi == 0;
        sums->thick +=
            record->d_lo > settings->distance && settings->verb != PCCD_NEAR_CROSSINGS;
        sums->at_distance += record->d_hi > 0 && record->d_lo == record->d_hi &&
                             record->d_lo == settings->distance;
    }
}

/* Check what was counted on the way to a complete answer. Pairs that touch are not looked
 * for any more when it is known that features do, or cross. */
static const char *check_counters(const struct truth *truth,
                                  const struct eng_question *settings,
                                  const struct eng_step_result *result)
{
    const struct pccd_step_counters *counters = &result->counters;
    uint64_t counts[PCCD_KINDS_MAX] = {0};
    uint64_t all = 0;
    bool is_all = settings->verb != PCCD_NEAR_CROSSINGS;
    for (size_t i = 0; i < truth->pairs.count && is_all; i++) {
        counts[truth->pairs.items[i].record.kind]++;
    }
    counts[PCCD_EF] = truth->crossings.count;
    for (int kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        if (counters->candidates[kind] < counts[kind]) {
            return "there were more pairs than candidates";
        }
        all += counts[kind];
    }
    /* Of pairs that cannot lessen a bound none is asked what its distance is. */
    bool are_asked = settings->verb != PCCD_NEAR_VERTICES;
    return are_asked && counters->survivors < all ? "there were more pairs than survivors"
                                                  : NULL;
}

const char *near_judge(const struct oracle_moment *asked,
                       const struct eng_question *settings,
                       const struct eng_step_result *result, uint64_t queries_max,
                       struct near_sums *sums)
{
    struct oracle_moment moment = *asked;
    struct truth truth;
    const char *wrong = NULL;
    oracle_moment_thicken(&moment, settings->verb);
    if (!find_truth(&moment, settings, queries_max, &truth)) {
        truth_deinit(&truth);
        return NULL;
    }
    if (settings->verb == PCCD_NEAR_NEAREST || settings->verb == PCCD_NEAR_DEPTH) {
        wrong = check_objects(&moment, &truth, settings, result, sums);
        wrong = wrong ? wrong : check_verdict(&truth, settings, result);
        sum_up(&truth, settings, result, sums);
        truth_deinit(&truth);
        return wrong;
    }
    const struct oracle_nears *nears =
        settings->verb == PCCD_NEAR_FEATURES    ? &truth.features
        : settings->verb == PCCD_NEAR_CROSSINGS ? &truth.crossings
                                                : &truth.pairs;
    if (settings->verb != PCCD_NEAR_VERTICES) {
        uint64_t found = settings->verb == PCCD_NEAR_CROSSINGS ? truth.crossings.count
                                                               : truth.pairs.count;
        wrong = check_records(nears, found > settings->contact_max, result);
    } else if (result->incomplete == PCCD_COMPLETE) {
        wrong = check_bounds(&moment, &truth, settings, result, sums);
    } else if (result->count != 0) {
        wrong = "bounds before the end";
    }
    wrong = wrong ? wrong : check_verdict(&truth, settings, result);
    if (!wrong && result->incomplete == PCCD_COMPLETE && settings->objects[0] == 0) {
        wrong = check_counters(&truth, settings, result);
    }
    sum_up(&truth, settings, result, sums);
    truth_deinit(&truth);
    return wrong;
}

const char *near_judge_player(const struct player *player,
                              const struct eng_question *settings,
                              const struct eng_step_result *result, uint64_t queries_max,
                              struct near_sums *sums)
{
    struct near_objects objects;
    near_objects_list(player, &objects);
    for (uint32_t i = 0; i < player->object_count; i++) {
        struct oracle_object *object = &objects.items[i];
        object->x0 = object->x1 = settings->end == 0 ? object->x0 : object->x1;
    }
    const struct oracle_moment moment = {.objects = objects.items,
                                         .object_count = player->object_count,
                                         .may_meet = near_may_meet,
                                         .context = player};
    return near_judge(&moment, settings, result, queries_max, sums);
}

void near_sums_tell(const struct near_sums *sums)
{
    const struct {
        const char *name;
        uint64_t count;
    } all[] = {{"exact decisions", sums->queries},
               {"answers", sums->judged},
               {"pairs", sums->pairs},
               {"vf", sums->types[PCCD_VF]},
               {"ee", sums->types[PCCD_EE]},
               {"ve", sums->types[PCCD_VE]},
               {"vv", sums->types[PCCD_VV]},
               {"touching", sums->touching},
               {"exactly that far", sums->at_distance},
               {"by their radii", sums->thick},
               {"features", sums->features},
               {"merged", sums->merged},
               {"bounds", sums->bounds},
               {"crossings", sums->crossings},
               {"free", sums->free},
               {"of parts", sums->parts},
               {"nearest", sums->nearest},
               {"ties", sums->ties},
               {"touching objects", sums->touching_objects},
               {"crossed", sums->crossed},
               {"with a gap", sums->gaps},
               {"farther", sums->others},
               {"inside", sums->inside},
               {"through", sums->through}};
    print_message("# judged:");
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        print_message(" %llu %s%s", (unsigned long long)all[i].count, all[i].name,
                      i + 1 < sizeof all / sizeof all[0] ? "," : "\n");
    }
}
