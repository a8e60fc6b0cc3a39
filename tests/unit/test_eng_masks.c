/* test_eng_masks.c - objects that may not meet are left out, and only they. */
#include "eng_filters.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "memory.h"
#include "topology.h"

#define OBJECTS 40u
#define MODES   4

struct crowd {
    struct eng_scene *scene;
    uint32_t count;
    struct filters_place affinity[FILTERS_OBJECTS_MAX];
    double (*x0[FILTERS_OBJECTS_MAX])[3];
    double (*x1[FILTERS_OBJECTS_MAX])[3];
    uint32_t vertices[FILTERS_OBJECTS_MAX];
    struct filters filters;
};

static void add(struct crowd *crowd, struct eng_mesh *mesh, double reach,
                struct prng *random)
{
    uint32_t i = crowd->count++;
    assert_true(i < FILTERS_OBJECTS_MAX);
    crowd->affinity[i].id = (i * 37 + 5) % 1009; /* not in the order of the indices */
    assert_ok(eng_scene_add(crowd->scene, mesh, crowd->affinity[i].id,
                            &crowd->affinity[i].idx));
    crowd->vertices[i] = eng_scene_vertex_count(crowd->scene, crowd->affinity[i].idx);
    crowd->x0[i] = malloc(crowd->vertices[i] * sizeof *crowd->x0[i]);
    crowd->x1[i] = malloc(crowd->vertices[i] * sizeof *crowd->x1[i]);
    assert_true(crowd->x0[i] && crowd->x1[i]);
    for (uint32_t k = 0; k < 3 * crowd->vertices[i]; k++) {
        double x = mesh->x[k / 3][k % 3];
        crowd->x0[i][k / 3][k % 3] = x;
        crowd->x1[i][k / 3][k % 3] = x + prng_between(random, -reach, reach);
    }
    eng_mesh_release(mesh);
}

static void begin(struct crowd *crowd)
{
    memset(crowd, 0, sizeof *crowd);
    crowd->scene = kit_scene();
}

/* Soups of one triangle to some hundreds in the same cube: everything meets everything,
 * and nodes of the trees have features of one object, of a few, and of all. */
static void begin_soups(struct crowd *crowd)
{
    static const uint32_t sizes[] = {1, 300, 6, 40, 2};
    struct prng random = {77};
    begin(crowd);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        add(crowd, kit_soup(&random, sizes[i % 5]), 0.02, &random);
    }
}

static void end(struct crowd *crowd)
{
    for (uint32_t i = 0; i < crowd->count; i++) {
        free(crowd->x0[i]);
        free(crowd->x1[i]);
    }
    eng_scene_free(crowd->scene);
}

static struct eng_step_result step(struct crowd *crowd,
                                   const struct eng_question *settings)
{
    eng_stage_begin(crowd->scene);
    for (uint32_t i = 0; i < crowd->count; i++) {
        assert_ok(eng_stage_x0x1(crowd->scene, crowd->affinity[i].idx, PCCD_FORMAT_F64, 0,
                                 crowd->vertices[i], crowd->x0[i], crowd->x1[i]));
    }
    struct eng_step_result result = kit_step(crowd->scene, settings);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    return result;
}

static struct eng_step_result step_in(struct crowd *crowd, enum pccd_mode mode,
                                      enum pccd_method method)
{
    struct eng_question settings = kit_contacts(mode, method);
    return step(crowd, &settings);
}

/* ---- the rule ---------------------------------------------------------------------- */

/* Records as bytes. */
struct records {
    char *bytes;
    uint64_t count;
    uint32_t size;
};

static struct records copy_of(const struct eng_step_result *result)
{
    struct records records = {NULL, result->count, result->record_bytes};
    records.bytes = test_copy(result->records, records.count * records.size);
    return records;
}

/* The records of objects that may meet. Both kinds of record name the objects, but not
 * in the same words. */
static struct records allowed(const struct records *all, const struct filters *filters)
{
    struct records some = {malloc(all->count * all->size + 1), 0, all->size};
    assert_non_null(some.bytes);
    for (uint64_t i = 0; i < all->count; i++) {
        struct pccd_contact contact = {.kind = 0};
        const char *record = all->bytes + i * all->size;
        if (all->size == sizeof contact) {
            memcpy(&contact, record, sizeof contact);
        } else {
            struct pccd_pair pair;
            memcpy(&pair, record, sizeof pair);
            contact.object_a = pair.object_a;
            contact.object_b = pair.object_b;
        }
        if (filters_may_meet(filters, contact.object_a, contact.object_b)) {
            memcpy(some.bytes + some.count++ * some.size, record, some.size);
        }
    }
    return some;
}

/* Keep those contacts that may be the first. */
static void keep_first(struct records *records)
{
    struct pccd_contact contact;
    double bound = 1;
    uint64_t kept = 0;
    for (uint64_t i = 0; i < records->count; i++) {
        memcpy(&contact, records->bytes + i * sizeof contact, sizeof contact);
        if (contact.flags & PCCD_PROVED && contact.toi_hi < bound) {
            bound = contact.toi_hi;
        }
    }
    for (uint64_t i = 0; i < records->count; i++) {
        memcpy(&contact, records->bytes + i * sizeof contact, sizeof contact);
        if (contact.toi <= bound) {
            memcpy(records->bytes + kept++ * sizeof contact, &contact, sizeof contact);
        }
    }
    records->count = kept;
}

static void check_step(struct crowd *crowd, enum pccd_mode mode,
                       const struct records *all, const struct records *pairs,
                       struct prng *prng)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    char way[WAY_TEXT_MAX];
    settings.mode = mode;
    way_draw(prng, 4, &settings);
    way_tell(&settings, way);
    struct records want = allowed(mode == PCCD_MODE_PAIRS ? pairs : all, &crowd->filters);
    if (mode == PCCD_MODE_FIRST) {
        keep_first(&want);
    }
    struct eng_step_result result = step(crowd, &settings);
    if (mode == PCCD_MODE_ANY) {
        assert_int_equal(result.verdict,
                         want.count > 0 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO);
    } else if (result.count != want.count ||
               memcmp(result.records, want.bytes, want.count * want.size) != 0) {
        fail_msg("mode %d, %s: %llu records where %llu are wanted, or others", (int)mode,
                 way, (unsigned long long)result.count, (unsigned long long)want.count);
    }
    free(want.bytes);
}

/* If it failed: a contact would be missed because other objects may not meet, or objects
 * that may not would be answered; by some method, team or instruction set. */
CASE(masks__leave_out_what_may_not_meet)
{
    struct crowd crowd;
    struct prng prng = {prng_seed()};
    begin_soups(&crowd);
    struct eng_step_result result = step_in(&crowd, PCCD_MODE_ALL, PCCD_METHOD_WIDE);
    struct records all = copy_of(&result);
    result = step_in(&crowd, PCCD_MODE_PAIRS, PCCD_METHOD_WIDE);
    struct records pairs = copy_of(&result);
    assert_true(all.count > 2000 && pairs.count > all.count);
    for (uint32_t round = 0; round < 30; round++) {
        filters_draw(&crowd.filters, crowd.scene, crowd.affinity, crowd.count, &prng);
        check_step(&crowd, (enum pccd_mode)(round % MODES), &all, &pairs, &prng);
        check_step(&crowd, PCCD_MODE_ALL, &all, &pairs, &prng);
    }
    free(all.bytes);
    free(pairs.bytes);
    end(&crowd);
}

/* If it failed: what an object may meet would not go on with it, or be another's who
 * comes in its place. */
CASE(masks__stay_with_their_object)
{
    struct crowd crowd;
    struct prng random = {3};
    struct eng_object_filter bits = {6, 0x8000000000000001u, false};
    begin(&crowd);
    for (uint32_t i = 0; i < 3; i++) {
        add(&crowd, kit_soup(&random, 30), 0.1, &random);
    }
    const struct filters_place *at = crowd.affinity;
    filters_set(&crowd.filters, crowd.scene, at[1], bits);
    filters_ignore(&crowd.filters, crowd.scene, at[1], at[2], true);
    filters_ignore(&crowd.filters, crowd.scene, at[0], at[2], true);
    assert_int_equal(step_in(&crowd, PCCD_MODE_PAIRS, PCCD_METHOD_PAPER).count,
                     step_in(&crowd, PCCD_MODE_PAIRS, PCCD_METHOD_WIDE).count);
    struct eng_mesh *other = kit_soup(&random, 30);
    assert_ok(eng_scene_replace(crowd.scene, at[1].idx, other));
    struct eng_object_filter now;
    assert_ok(eng_scene_get_filter(crowd.scene, at[1].idx, &now));
    assert_true(now.group == 6 && now.mask == 0x8000000000000001u && !now.self);
    assert_int_equal(eng_scene_ignored_count(crowd.scene), 2);
    assert_ok(eng_scene_remove(crowd.scene, at[1].idx));
    assert_int_equal(eng_scene_ignored_count(crowd.scene), 1);
    assert_int_equal(eng_scene_get_filter(crowd.scene, at[1].idx, &now), PCCD_E_INVAL);
    uint32_t idx;
    assert_ok(eng_scene_add(crowd.scene, other, 4711, &idx));
    assert_int_equal(idx, at[1].idx);
    assert_ok(eng_scene_get_filter(crowd.scene, idx, &now));
    assert_true(now.group == 1 && now.mask == UINT64_MAX && now.self);
    eng_mesh_release(other);
    end(&crowd);
}

/* If it failed: a wrong index would be written to, or an object ignored itself. */
CASE(masks__refuse_what_is_not_there)
{
    struct crowd crowd;
    struct prng random = {3};
    struct eng_object_filter bits = ENG_OBJECT_FILTER_DEFAULT;
    begin(&crowd);
    add(&crowd, kit_soup(&random, 3), 0.1, &random);
    uint32_t idx = crowd.affinity[0].idx;
    assert_int_equal(eng_scene_set_filter(crowd.scene, idx + 1, &bits), PCCD_E_INVAL);
    assert_int_equal(eng_scene_set_filter(crowd.scene, UINT32_MAX, &bits), PCCD_E_INVAL);
    assert_int_equal(eng_scene_ignore(crowd.scene, idx, idx, true), PCCD_E_INVAL);
    assert_int_equal(eng_scene_ignore(crowd.scene, idx, idx + 1, true), PCCD_E_INVAL);
    assert_int_equal(eng_scene_ignore(crowd.scene, 9999, idx, false), PCCD_E_INVAL);
    assert_int_equal(eng_scene_ignored_count(crowd.scene), 0);
    end(&crowd);
}

/* ---- what is not paid for ---------------------------------------------------------- */

/* If it failed: an object whose self-collision is off, or two that ignore each other,
 * would cost as if they could meet. */
CASE(masks__cost_nothing_where_nothing_may_meet)
{
    struct crowd crowd;
    struct prng random = {8};
    struct eng_object_filter alone = {1, UINT64_MAX, false};
    begin(&crowd);
    for (uint32_t i = 0; i < 2; i++) {
        add(&crowd, kit_soup(&random, 3000), 0.01, &random);
    }
    for (enum pccd_method method = PCCD_METHOD_PAPER; method <= PCCD_METHOD_WIDE;
         method++) {
        struct eng_step_result open = step_in(&crowd, PCCD_MODE_ALL, method);
        filters_set(&crowd.filters, crowd.scene, crowd.affinity[0], alone);
        filters_set(&crowd.filters, crowd.scene, crowd.affinity[1], alone);
        struct eng_step_result mutual = step_in(&crowd, PCCD_MODE_ALL, method);
        uint64_t mutual_tests = mutual.counters.box_tests;
        filters_ignore(&crowd.filters, crowd.scene, crowd.affinity[0], crowd.affinity[1],
                       true);
        struct eng_step_result nothing = step_in(&crowd, PCCD_MODE_ALL, method);
        assert_int_equal(nothing.count, 0);
        assert_int_equal(nothing.counters.candidates[PCCD_VF] +
                             nothing.counters.candidates[PCCD_EE],
                         0);
        assert_true(nothing.counters.box_tests < open.counters.box_tests / 100);
        assert_true(mutual_tests < open.counters.box_tests * 3 / 4);
        filters_ignore(&crowd.filters, crowd.scene, crowd.affinity[0], crowd.affinity[1],
                       false);
        for (uint32_t i = 0; i < 2; i++) {
            struct eng_object_filter begins = ENG_OBJECT_FILTER_DEFAULT;
            filters_set(&crowd.filters, crowd.scene, crowd.affinity[i], begins);
        }
        struct eng_step_result again = step_in(&crowd, PCCD_MODE_ALL, method);
        assert_true(again.hash[0] == open.hash[0] && again.hash[1] == open.hash[1]);
    }
    end(&crowd);
}

/* If it failed: many things of one group that do not meet each other, as a level is made
 * of, would be compared pair by pair. */
CASE(masks__pass_over_groups_together)
{
    struct crowd crowd;
    struct prng random = {9};
    const struct eng_object_filter level = {2, 1, true};
    begin(&crowd);
    for (uint32_t i = 0; i < FILTERS_OBJECTS_MAX - 1; i++) {
        add(&crowd, kit_soup(&random, 8), 0.01, &random);
    }
    add(&crowd, kit_soup(&random, 30), 0.01, &random);
    struct eng_step_result open = step_in(&crowd, PCCD_MODE_ALL, PCCD_METHOD_WIDE);
    uint64_t open_tests = open.counters.box_tests;
    for (uint32_t i = 0; i + 1 < crowd.count; i++) {
        filters_set(&crowd.filters, crowd.scene, crowd.affinity[i], level);
    }
    struct eng_step_result some = step_in(&crowd, PCCD_MODE_ALL, PCCD_METHOD_WIDE);
    assert_true(some.count > 0);
    assert_true(some.counters.box_tests < open_tests / 5);
    end(&crowd);
}

/* If it failed: a step after a change would take memory, however often it changes. */
CASE(masks__change_without_memory)
{
    struct crowd crowd;
    struct prng prng = {11};
    begin_soups(&crowd);
    for (uint32_t i = 0; i < crowd.count; i++) { /* the most pairs that will be */
        for (uint32_t k = 0; k < i && i * k < FILTERS_IGNORED_MAX / 2; k++) {
            filters_ignore(&crowd.filters, crowd.scene, crowd.affinity[i],
                           crowd.affinity[k],
                           crowd.filters.ignored_count < FILTERS_IGNORED_MAX);
        }
    }
    step_in(&crowd, PCCD_MODE_ANY, PCCD_METHOD_WIDE);
    uint64_t before = eng_alloc_count();
    for (uint32_t round = 0; round < 20; round++) {
        for (uint32_t i = 0; i < crowd.count; i++) {
            struct eng_object_filter bits = {prng_next(&prng), prng_next(&prng),
                                             prng_below(&prng, 2) == 0};
            filters_set(&crowd.filters, crowd.scene, crowd.affinity[i], bits);
        }
        step_in(&crowd, PCCD_MODE_ANY, PCCD_METHOD_WIDE);
    }
    assert_int_equal(eng_alloc_count(), before);
    end(&crowd);
}
