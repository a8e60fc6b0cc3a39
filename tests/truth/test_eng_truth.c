/* test_eng_truth.c - the engine finds every contact of the published truth. */
#include "cases.h"
#include "eng_way.h"
#include "truth_engine.h"

/* One record of so many is timed by the oracle, which takes a tenth of a millisecond. */
#define TIMED_SHARE 8

/* The colliding pairs of both lists as records name them, sorted. Freed by the caller. */
static struct oracle_pair *read_truth(const struct data_scene *scene,
                                      uint32_t vertex_count, uint32_t edge_count,
                                      size_t *count)
{
    struct oracle_pair *truth = NULL;
    *count = 0;
    for (uint32_t kind = 0; kind < 2; kind++) {
        char ids[DATA_PATH_MAX];
        char flags[DATA_PATH_MAX];
        struct data_pairs pairs;
        truth_find(scene->ids[kind], ids);
        truth_find(scene->truth[kind], flags);
        assert_true(data_pairs_read(ids, flags, &pairs));
        truth = realloc(truth, (*count + pairs.count + 1) * sizeof *truth);
        assert_non_null(truth);
        for (size_t i = 0; i < pairs.count; i++) {
            uint32_t a = pairs.ids[i][0];
            uint32_t b = pairs.ids[i][1];
            if (!pairs.truth[i]) {
                continue;
            }
            if (kind == PCCD_VF) {
                b -= vertex_count + edge_count;
            } else {
                uint32_t low = a < b ? a : b;
                b = (a < b ? b : a) - vertex_count;
                a = low - vertex_count;
            }
            truth[(*count)++] = (struct oracle_pair){kind, 0, a, 0, b};
        }
        data_pairs_deinit(&pairs);
    }
    qsort(truth, *count, sizeof *truth, oracle_pair_compare);
    return truth;
}

/* Counts of the comparison of a scene. */
struct tally {
    size_t missing;
    size_t extra;    /* records beside the lists */
    size_t untrue;   /* of these, no contact by the definition */
    size_t possible; /* records that are not proved */
    size_t timed;
};

/* A record against exact arithmetic. */
static bool confirm(const struct oracle_object *object, const uint32_t (*edges)[2],
                    const struct pccd_contact *contact, struct tally *tally)
{
    double moving[8][3];
    if (contact->kind == PCCD_VF) {
        oracle_vf_points(object, contact->feature_a, object, contact->feature_b, moving);
    } else {
        oracle_ee_points(object, edges[contact->feature_a], object,
                         edges[contact->feature_b], moving);
    }
    enum oracle_kind kind = contact->kind == PCCD_VF ? ORACLE_VF : ORACLE_EE;
    bool is_proved = (contact->flags & PCCD_PROVED) != 0;
    struct oracle_first *first = oracle_first_new(kind, (truth_points)moving);
    if (first) {
        tally->timed++;
        assert_true(oracle_first_compare(first, contact->toi) >= 0);
        assert_true(!is_proved || oracle_first_compare(first, contact->toi_hi) <= 0);
        assert_int_equal(oracle_touching_at(kind, (truth_points)moving, 0),
                         (contact->flags & PCCD_INITIAL) != 0);
    }
    assert_true(first || !is_proved);
    oracle_first_free(first);
    return first != NULL;
}

/* Records and truth are sorted alike. */
static void compare(const struct oracle_object *object, const uint32_t (*edges)[2],
                    const struct eng_step_result *result, const struct oracle_pair *truth,
                    size_t truth_count, struct tally *tally)
{
    const struct pccd_contact *contacts = result->records;
    size_t at = 0;
    memset(tally, 0, sizeof *tally);
    tally->possible = result->possible;
    for (uint64_t i = 0; i < result->count; i++) {
        struct oracle_pair name = {contacts[i].kind, contacts[i].object_a,
                                   contacts[i].feature_a, contacts[i].object_b,
                                   contacts[i].feature_b};
        while (at < truth_count && oracle_pair_compare(&truth[at], &name) < 0) {
            tally->missing++;
            at++;
        }
        bool is_listed = at < truth_count && oracle_pair_compare(&truth[at], &name) == 0;
        at += is_listed;
        tally->extra += !is_listed;
        if (!is_listed || i % TIMED_SHARE == 0) {
            tally->untrue += !confirm(object, edges, &contacts[i], tally);
        }
    }
    tally->missing += truth_count - at;
}

/* If that failed, who computes would decide what is found. */
static void check_ways(struct eng_mesh *mesh, const struct oracle_object *object,
                       const uint64_t hash[2])
{
    for (uint32_t i = 1; i < truth_way_count(); i++) {
        struct eng_question settings = truth_way(i);
        struct eng_step_result result;
        eng_scene_free(truth_run(mesh, object, NULL, &settings, &result));
        if (result.hash[0] != hash[0] || result.hash[1] != hash[1]) {
            char text[WAY_TEXT_MAX];
            way_tell(&settings, text);
            fail_msg("%s: another answer", text);
        }
    }
}

/* `extra_max`: records beside the lists that are allowed, in thousandths of the truth. */
static void check_scene(enum data_scene_name name, size_t truth_expected,
                        size_t extra_max)
{
    const struct data_scene *scene = &data_scenes[name];
    struct ply frames[2];
    struct eng_step_result result;
    struct tally tally;
    uint32_t edge_count;
    size_t truth_count;
    truth_read_frames(scene, frames);
    struct oracle_object object = truth_object(frames);
    uint32_t(*edges)[2] = oracle_edges(&object, &edge_count);
    struct oracle_pair *truth =
        read_truth(scene, object.vertex_count, edge_count, &truth_count);
    struct eng_mesh *mesh = truth_mesh(&object);
    assert_memory_equal(eng_mesh_edges(mesh), edges, edge_count * sizeof *edges);
    struct eng_question alone = truth_way(0);
    struct eng_scene *engine = truth_run(mesh, &object, NULL, &alone, &result);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    compare(&object, (const uint32_t(*)[2])edges, &result, truth, truth_count, &tally);
    print_message("# %s: %zu true, %zu missing; %zu records, %zu beside the lists "
                  "(%zu of them no contact), %zu possible, %zu timed exactly\n",
                  scene->name, truth_count, tally.missing, (size_t)result.count,
                  tally.extra, tally.untrue, tally.possible, tally.timed);
    eng_scene_free(engine);
    uint64_t hash[2] = {result.hash[0], result.hash[1]};
    check_ways(mesh, &object, hash);
    eng_mesh_release(mesh);
    free(truth);
    free(edges);
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    assert_int_equal(truth_count, truth_expected);
    assert_int_equal(tally.missing, 0);
    assert_true(tally.extra * 1000 <= truth_count * extra_max);
}

/* If this failed, a real contact of cloth on a ball would be missed. */
CASE(engine__finds_every_contact_of_cloth_ball)
{
    check_scene(DATA_CLOTH_BALL, 113854, 1);
}

/* If this failed, a real contact of thousands of balls would be missed. */
CASE(engine__finds_every_contact_of_n_body)
{
    check_scene(DATA_N_BODY, 50490, 1);
}

/* If this failed, a real contact of nearly degenerate cloth would be missed. There are
 * only 134 of them, so that a single extra one is more than a thousandth. */
CASE(engine__finds_every_contact_of_cloth_funnel)
{
    check_scene(DATA_CLOTH_FUNNEL, 134, 50);
}

struct handmade {
    size_t queries;
    size_t truths;
    size_t missing;
    size_t proved_wrong;
    size_t possible; /* records of the query itself that are not proved */
    size_t untrue;   /* of these, no contact */
};

/* Each query in another way, and each way with half a thousand of them. */
static void run_handmade(void *context, bool is_vf, const char *path,
                         const struct data_queries *queries)
{
    struct handmade *tally = context;
    assert_true(queries->has_truth);
    for (size_t i = 0; i < queries->count; i++) {
        struct truth_two two;
        struct eng_step_result result;
        truth_two_init(&two, is_vf, (truth_points)queries->p[i]);
        struct eng_mesh *mesh = truth_mesh(&two.object);
        struct eng_question settings =
            truth_way((uint32_t)tally->queries % truth_way_count());
        struct eng_scene *scene = truth_run(mesh, &two.object, NULL, &settings, &result);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        const struct pccd_contact *contact = truth_two_find(is_vf, mesh, &result);
        bool is_proved = contact && contact->flags & PCCD_PROVED;
        tally->queries++;
        tally->truths += queries->truth[i];
        tally->possible += contact && !is_proved;
        tally->untrue += contact && !is_proved && !queries->truth[i];
        if ((!contact && queries->truth[i]) || (is_proved && !queries->truth[i])) {
            tally->missing += queries->truth[i];
            tally->proved_wrong += is_proved;
            print_message("# %s, query %zu: %s\n", path, i,
                          contact ? "invented" : "missed");
        }
        eng_scene_free(scene);
        eng_mesh_release(mesh);
    }
}

/* If this failed, a query made to be hard would be missed, or a contact proved that is
 * not there. */
CASE(engine__answers_every_handmade_query)
{
    struct handmade tally = {0};
    if (data_handmade(run_handmade, &tally) == 0) {
        test_skip("no hand-made queries in $PCCD_DATA");
    }
    print_message(
        "# %zu queries, %zu true, %zu missed, %zu invented; %zu possible, %zu of "
        "them no contact\n",
        tally.queries, tally.truths, tally.missing, tally.proved_wrong, tally.possible,
        tally.untrue);
    assert_int_equal(tally.queries, TRUTH_HANDMADE);
    assert_int_equal(tally.missing, 0);
    assert_int_equal(tally.proved_wrong, 0);
}
