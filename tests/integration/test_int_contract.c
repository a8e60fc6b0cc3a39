/* test_int_contract.c - sentences of pccd.h and pccd(7), held against a real daemon. */
#include "cases.h"

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"
#include "prng.h"

#define PI 3.14159265358979323846

static struct pccd_client *client;

static int open_client(void **state)
{
    struct pccd_options options;
    (void)state;
    pccd_options_init(&options);
    options.url = test_shared.url;
    return pccd_connect(&options, &client);
}

static int close_client(void **state)
{
    (void)state;
    pccd_close(client);
    return 0;
}

static uint32_t add(uint32_t scene, const float (*x)[3], uint32_t vertex_count,
                    const uint32_t (*triangles)[3], uint32_t triangle_count,
                    struct pccd_mesh_info *info)
{
    uint32_t mesh = 0;
    assert_ok(pccd_mesh_create(client, x, PCCD_FORMAT_F32, vertex_count, triangles,
                               triangle_count, &mesh, info));
    uint32_t object = test_object(client, scene, mesh);
    return object;
}

/* ---- motion is straight ------------------------------------------------------------ */

/* The example of README.md and pccd(7): an arm of 1 m turns by 90 degrees, and its tip is
 * to stay within 1 mm of its arc. */
#define ARM_LENGTH   1.0
#define ARM_ANGLE    (PI / 2)
#define ARM_DISTANCE 0.001
#define ARM_STEPS    18u

static const float arm_x[4][3] = {
    {0, -.02f, -.02f}, {0, .02f, -.02f}, {0, 0, .02f}, {(float)ARM_LENGTH, 0, 0}};
static const uint32_t arm_triangles[4][3] = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
static const uint32_t box_triangles[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                              {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                              {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

/* Turn by an angle about the z axis, as the rows of [R | t]. */
static void rotation(double angle, double m[12])
{
    const double rows[12] = {cos(angle), -sin(angle), 0, 0, sin(angle), cos(angle),
                             0,          0,           0, 0, 1,          0};
    memcpy(m, rows, sizeof rows);
}

/* Contacts of the arm, over so many steps, with a box whose inner face is so far from the
 * axis, in the direction of `angle`. */
static uint64_t turn_arm(uint32_t steps, double inner, double angle)
{
    uint64_t contacts = 0;
    float x[8][3];
    for (uint32_t i = 0; i < 8; i++) {
        double out = i & 1 ? inner + .2 : inner;
        double along = i & 2 ? .01 : -.01;
        x[i][0] = (float)(out * cos(angle) - along * sin(angle));
        x[i][1] = (float)(out * sin(angle) + along * cos(angle));
        x[i][2] = i & 4 ? .1f : -.1f;
    }
    uint32_t scene = test_scene(client);
    (void)add(scene, (const float(*)[3])x, 8, box_triangles, 12, NULL);
    uint32_t arm = add(scene, arm_x, 4, arm_triangles, 4, NULL);
    for (uint32_t i = 0; i < steps; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        struct pccd_frame frame;
        uint64_t step = 0;
        double m0[12];
        double m1[12];
        rotation(ARM_ANGLE * i / steps, m0);
        rotation(ARM_ANGLE * (i + 1) / steps, m1);
        assert_ok(pccd_frame_begin(client, scene, 1, 192, &frame));
        assert_ok(pccd_frame_rigid(&frame, arm, 0, 4, m0, m1));
        assert_ok(pccd_frame_commit(&frame, NULL, &step));
        assert_ok(pccd_wait(client, step, -1, &answer));
        contacts += answer.total;
        pccd_answer_release(client, &answer);
    }
    assert_ok(pccd_scene_destroy(client, scene));
    return contacts;
}

/* Between two steps a point is nearest to the axis halfway: there the chord is off. */
static double middle_of_a_chord(uint32_t steps)
{
    return ARM_ANGLE * (steps / 2 + .5) / steps;
}

/* If it failed, the documents would promise a distance from the arc that a planner cannot
 * rely on, or hide that one step of a large turn passes what is on its way. */
CASE_WITH(motion__is_straight_and_an_arc_needs_the_steps_that_are_said, open_client,
          close_client)
{
    double fewest = ARM_ANGLE * sqrt(ARM_LENGTH / (8 * ARM_DISTANCE));
    assert_int_equal((uint32_t)ceil(fewest), ARM_STEPS);
    /* A box well within the arc, 10 cm: one step passes it by. */
    assert_int_equal(turn_arm(1, .9, PI / 4), 0);
    assert_true(turn_arm(2, .9, PI / 4) > 0);
    assert_true(turn_arm(ARM_STEPS, .9, PI / 4) > 0);
    /* One that reaches 1 mm into the arc, where a chord is farthest from it. */
    double inner = ARM_LENGTH - ARM_DISTANCE;
    assert_true(turn_arm(ARM_STEPS, inner, middle_of_a_chord(ARM_STEPS)) > 0);
    assert_int_equal(turn_arm(ARM_STEPS - 1, inner, middle_of_a_chord(ARM_STEPS - 1)), 0);
}

/* ---- random scenes on a coarse grid ------------------------------------------------ */

enum { VERTICES = 36, TRIANGLES = 24 };

/* One object that goes from x0 to x1, both on a grid of few places: a lot is coplanar,
 * parallel, touches at the start, at the end, or for the whole time. */
struct soup {
    float x0[VERTICES][3];
    float x1[VERTICES][3];
    uint32_t triangles[TRIANGLES][3];
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
};

static void soup_fill(struct soup *soup, struct prng *prng, uint32_t places)
{
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        soup->x0[i / 3][i % 3] = (float)prng_below(prng, places);
        soup->x1[i / 3][i % 3] = (float)prng_below(prng, places);
    }
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++) {
        soup->triangles[i / 3][i % 3] = (uint32_t)prng_below(prng, VERTICES);
    }
}

/* `handle`: of the object, which stands in the records; 0: any. */
static void soup_register(struct soup *soup, uint32_t handle)
{
    soup->scene = test_scene(client);
    soup->mesh = test_mesh(client, soup->x0, PCCD_FORMAT_F32, VERTICES, soup->triangles,
                           TRIANGLES);
    if (handle != 0) {
        assert_ok(pccd_request_handle(client, handle));
    }
    soup->object = test_object(client, soup->scene, soup->mesh);
}

static void soup_step(const struct soup *soup, const struct pccd_step_settings *settings,
                      struct pccd_answer *answer)
{
    assert_ok(pccd_step_x0x1(client, soup->scene, soup->object, soup->x0, soup->x1,
                             PCCD_FORMAT_F32, VERTICES, settings, answer));
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
}

static void soup_drop(const struct soup *soup)
{
    assert_ok(pccd_scene_destroy(client, soup->scene));
    assert_ok(pccd_mesh_destroy(client, soup->mesh));
}

/* If it failed, a record would have come that is not proved, which this release says it
 * does not give, or a verdict that says neither yes nor no. */
CASE_WITH(records__are_all_proved, open_client, close_client)
{
    struct prng prng = {prng_seed()};
    uint64_t records = 0;
    uint64_t initial = 0;
    for (uint32_t round = 0; round < 60; round++) {
        struct pccd_step_settings settings = {
            .struct_bytes = sizeof(struct pccd_step_settings), .method = 1 + round % 2};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        struct soup soup;
        soup_fill(&soup, &prng, 3 + round % 5);
        soup_register(&soup, 0);
        soup_step(&soup, &settings, &answer);
        assert_int_equal(answer.possible, 0);
        for (uint64_t i = 0; i < answer.count; i++) {
            assert_true(answer.contacts[i].flags & PCCD_PROVED);
        }
        records += answer.count;
        initial += answer.initial;
        uint64_t count = answer.count;
        pccd_answer_release(client, &answer);
        settings.mode = PCCD_MODE_ANY;
        soup_step(&soup, &settings, &answer);
        assert_int_equal(answer.verdict, count > 0 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO);
        pccd_answer_release(client, &answer);
        soup_drop(&soup);
    }
    assert_true(initial > 1000 && records > 2 * initial);
}

/* If it failed, mode first would leave out a contact that may be the earliest, or give
 * one that cannot. */
CASE_WITH(first__has_the_contacts_that_begin_before_any_must_have, open_client,
          close_client)
{
    struct prng prng = {prng_seed()};
    uint64_t ties = 0;
    for (uint32_t round = 0; round < 40; round++) {
        struct pccd_step_settings settings = {
            .struct_bytes = sizeof(struct pccd_step_settings), .mode = PCCD_MODE_FIRST};
        struct pccd_answer all = PCCD_ANSWER_INIT;
        struct pccd_answer first = PCCD_ANSWER_INIT;
        struct soup soup;
        double bound = 2;
        uint64_t found = 0;
        soup_fill(&soup, &prng, round % 2 ? 1000 : 3);
        soup_register(&soup, 0);
        soup_step(&soup, NULL, &all);
        soup_step(&soup, &settings, &first);
        for (uint64_t i = 0; i < all.count; i++) {
            bound = fmin(bound, all.contacts[i].toi_hi);
        }
        for (uint64_t i = 0; i < all.count; i++) {
            if (all.contacts[i].toi <= bound) {
                assert_true(found < first.count);
                assert_memory_equal(&first.contacts[found++], &all.contacts[i],
                                    sizeof all.contacts[i]);
            }
        }
        assert_int_equal(first.count, found);
        assert_true(first.toi_first == all.toi_first);
        ties += found > 1;
        pccd_answer_release(client, &first);
        pccd_answer_release(client, &all);
        soup_drop(&soup);
    }
    assert_in_range(ties, 1, 39);
}

/* ---- tolerance --------------------------------------------------------------------- */

/* If it failed, a bracket would be wider than asked for, or which contacts there are
 * would depend on the tolerance; nor is a bracket to be taken for as wide as that. */
CASE_WITH(tolerance__bounds_brackets_from_above_and_changes_no_contact, open_client,
          close_client)
{
    static const double tolerances[] = {1e-6, 1, 1e-3, 1e-9, 1e-12};
    struct prng prng = {prng_seed()};
    struct pccd_contact *first = NULL;
    uint64_t count = 0;
    struct soup soup;
    soup_fill(&soup, &prng, 1000);
    soup_register(&soup, 0);
    for (size_t i = 0; i < sizeof tolerances / sizeof tolerances[0]; i++) {
        struct pccd_step_settings settings = {.struct_bytes =
                                                  sizeof(struct pccd_step_settings),
                                              .tolerance = tolerances[i]};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        soup_step(&soup, &settings, &answer);
        assert_true(answer.count > 50);
        if (first == NULL) {
            count = answer.count;
            first = test_copy(answer.contacts, count * sizeof *first);
        }
        assert_int_equal(answer.count, count);
        for (uint64_t k = 0; k < count; k++) {
            const struct pccd_contact *contact = &answer.contacts[k];
            double width = contact->toi_hi - contact->toi;
            assert_memory_equal(contact, &first[k], offsetof(struct pccd_contact, toi));
            assert_true(width >= 0 && width <= tolerances[i]);
            assert_true(width < 1e-6); /* with a tolerance of 1, too */
            assert_true(contact->toi <= first[k].toi_hi);
            assert_true(contact->toi_hi >= first[k].toi);
        }
        pccd_answer_release(client, &answer);
    }
    free(first);
    soup_drop(&soup);
}

/* ---- numbering --------------------------------------------------------------------- */

/* A contact by the vertices of its features, in an order of their own. */
struct named {
    uint32_t kind;
    uint32_t v[5]; /* vertex, corners of the face; or the ends of both edges */
};

static int compare_numbers(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a;
    uint32_t y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static int compare_named(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct named));
}

/* The answer's contacts, sorted; vertex i was vertex old[i] before it was renumbered. */
static void name_all(const struct soup *soup, const struct pccd_answer *answer,
                     const uint32_t *old, struct named *named)
{
    struct pccd_edge edges[3 * TRIANGLES];
    struct pccd_mesh_info info;
    assert_ok(pccd_mesh_replace(client, soup->mesh, soup->x0, PCCD_FORMAT_F32, VERTICES,
                                soup->triangles, TRIANGLES, &info));
    assert_ok(pccd_mesh_edges(client, soup->mesh, edges, info.edge_count));
    memset(named, 0, answer->count * sizeof *named);
    for (uint64_t i = 0; i < answer->count; i++) {
        const struct pccd_contact *contact = &answer->contacts[i];
        uint32_t *v = named[i].v;
        named[i].kind = contact->kind;
        if (contact->kind == PCCD_VF) {
            v[0] = old[contact->feature_a];
            for (int k = 0; k < 3; k++) {
                v[1 + k] = old[soup->triangles[contact->feature_b][k]];
            }
            qsort(v + 1, 3, sizeof *v, compare_numbers);
            continue;
        }
        v[0] = old[edges[contact->feature_a].a];
        v[1] = old[edges[contact->feature_a].b];
        v[2] = old[edges[contact->feature_b].a];
        v[3] = old[edges[contact->feature_b].b];
        qsort(v, 2, sizeof *v, compare_numbers);
        qsort(v + 2, 2, sizeof *v, compare_numbers);
        if (memcmp(v, v + 2, 2 * sizeof *v) > 0) {
            uint32_t swapped[4] = {v[2], v[3], v[0], v[1]};
            memcpy(v, swapped, sizeof swapped);
        }
    }
    qsort(named, answer->count, sizeof *named, compare_named);
}

/* The same surface with its vertices and triangles in the reverse order, and each
 * triangle from another corner. */
static void soup_renumber(const struct soup *from, struct soup *to)
{
    for (uint32_t v = 0; v < VERTICES; v++) {
        memcpy(to->x0[v], from->x0[VERTICES - 1 - v], sizeof to->x0[v]);
        memcpy(to->x1[v], from->x1[VERTICES - 1 - v], sizeof to->x1[v]);
    }
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++) {
        to->triangles[i / 3][i % 3] =
            VERTICES - 1 - from->triangles[TRIANGLES - 1 - i / 3][(i + 1) % 3];
    }
}

/* If it failed, somebody who numbers a mesh as another does would get other bytes, or
 * somebody who numbers it otherwise other contacts. */
CASE_WITH(numbering__decides_the_bytes_and_not_the_contacts, open_client, close_client)
{
    struct prng prng = {prng_seed()};
    struct soup soups[3];
    struct pccd_answer answers[3] = {PCCD_ANSWER_INIT, PCCD_ANSWER_INIT,
                                     PCCD_ANSWER_INIT};
    struct named *named[3];
    uint32_t same[VERTICES];
    uint32_t reversed[VERTICES];
    for (uint32_t v = 0; v < VERTICES; v++) {
        same[v] = v;
        reversed[v] = VERTICES - 1 - v;
    }
    soup_fill(&soups[0], &prng, 6);
    soups[1] = soups[0];
    soup_renumber(&soups[0], &soups[2]);
    for (int i = 0; i < 3; i++) {
        soup_register(&soups[i], i == 0 ? 0 : soups[0].object);
        soup_step(&soups[i], NULL, &answers[i]);
        named[i] = calloc(answers[i].count + 1, sizeof *named[i]);
        assert_non_null(named[i]);
        name_all(&soups[i], &answers[i], i == 2 ? reversed : same, named[i]);
    }
    assert_true(answers[0].count > 50);
    assert_int_equal(answers[1].count, answers[0].count);
    assert_memory_equal(answers[1].contacts, answers[0].contacts,
                        answers[0].count * sizeof(struct pccd_contact));
    assert_memory_equal(answers[1].hash, answers[0].hash, sizeof answers[0].hash);
    assert_int_equal(answers[2].count, answers[0].count);
    assert_memory_equal(named[2], named[0], answers[0].count * sizeof *named[0]);
    assert_memory_not_equal(answers[2].hash, answers[0].hash, sizeof answers[0].hash);
    for (int i = 0; i < 3; i++) {
        free(named[i]);
        pccd_answer_release(client, &answers[i]);
        soup_drop(&soups[i]);
    }
}

/* ---- triangles that name a vertex twice -------------------------------------------- */

/* If it failed, a mesh with such triangles, as an exporter writes them, would be counted
 * or answered otherwise than is said: as the segment, or the point, that they are. */
CASE_WITH(triangles__that_name_a_vertex_twice_are_segments_and_points, open_client,
          close_client)
{
    static const float x0[4][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {3, 3, 3}};
    /* A segment; the same once more; not the same; a point. */
    static const uint32_t odd[4][3] = {{0, 1, 1}, {1, 0, 1}, {0, 0, 1}, {2, 2, 2}};
    /* Straight up, its first vertex through the segment, its second through the point. */
    static const float below[3][3] = {{.5f, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
    static const float above[3][3] = {{.5f, 0, 2}, {0, 1, 2}, {-1, -1, 2}};
    struct pccd_mesh_info info;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t faces_hit[2] = {0, 0}; /* bits: by each vertex */
    uint32_t scene = 0;
    scene = test_scene(client);
    uint32_t still = add(scene, x0, 4, odd, 4, &info);
    assert_int_equal(info.degenerate_count, 4);
    assert_int_equal(info.duplicate_count, 1);
    assert_int_equal(info.edge_count, 1);
    assert_int_equal(info.isolated_count, 1);
    uint32_t moving = add(scene, below, 3, test_triangle, 1, NULL);
    assert_ok(
        pccd_step_x1(client, scene, moving, above, PCCD_FORMAT_F32, 3, NULL, &answer));
    for (uint64_t i = 0; i < answer.count; i++) {
        const struct pccd_contact *contact = &answer.contacts[i];
        assert_true(contact->flags & PCCD_PROVED);
        assert_true(contact->toi <= .5 && contact->toi_hi >= .5);
        assert_int_not_equal(contact->object_a, contact->object_b);
        if (contact->kind == PCCD_VF && contact->object_b == still) {
            assert_in_range(contact->feature_a, 0, 1);
            faces_hit[contact->feature_a] |= 1u << contact->feature_b;
        }
    }
    assert_int_equal(faces_hit[0], 1 + 2 + 4);
    assert_int_equal(faces_hit[1], 8);
    pccd_answer_release(client, &answer);
}

/* ---- answers that are cut, and how long they are kept ------------------------------ */

#define SIDE  60u
#define LIMIT 2000u

/* All pages of the answer, in `records`. Returns how many of them. */
static uint64_t read_all(const struct test_grid *grid, struct pccd_answer *answer,
                         struct pccd_contact *records)
{
    enum pccd_incomplete incomplete = answer->incomplete;
    uint64_t got = 0;
    for (;;) {
        memcpy(records + got, answer->contacts, answer->count * sizeof *records);
        got += answer->count;
        uint64_t step = answer->step;
        uint64_t cursor = answer->cursor;
        assert_int_equal(cursor, got);
        pccd_answer_release(grid->client, answer);
        if (cursor == answer->total) {
            return got;
        }
        assert_ok(pccd_fetch(grid->client, grid->scene, step, cursor, answer));
        /* Full pages end, what was cut stays so. */
        assert_int_equal(answer->incomplete,
                         answer->cursor == answer->total &&
                                 incomplete == PCCD_INCOMPLETE_RESULT_FULL
                             ? PCCD_COMPLETE
                             : incomplete);
    }
}

static void fall(struct test_grid *grid, enum pccd_method method,
                 struct pccd_answer *answer)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .method = method};
    uint64_t step = 0;
    assert_ok(test_grid_submit(grid, &settings, &step));
    assert_ok(pccd_wait(grid->client, step, -1, answer));
}

/* If it failed, what an answer with too many records keeps would be left to chance, or
 * could not be read to its end, or the scene would not have moved on. */
CASE_WITH(incomplete__at_the_limit_keeps_the_first_records_in_order, open_client,
          close_client)
{
    struct pccd_contact *whole = malloc(SIDE * SIDE * sizeof *whole);
    struct pccd_contact *kept = malloc(LIMIT * sizeof *kept);
    struct pccd_client *usual = client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    assert_true(whole != NULL && kept != NULL);
    client = test_client(&(struct pccd_options){
        .url = test_shared.url, .result_bytes = 65536}); /* 1024 records */
    assert_ok(test_grid_make(client, SIDE, &grid));
    for (enum pccd_method method = PCCD_METHOD_PAPER; method < PCCD_METHOD_COUNT;
         method++) {
        fall(&grid, method, &answer);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_RESULT_FULL);
        assert_int_equal(read_all(&grid, &answer, whole), SIDE * SIDE);
        fall(&grid, method, &answer); /* back */
        pccd_answer_release(client, &answer);
        assert_ok(pccd_config_set(client, "contacts-max", "2000"));
        fall(&grid, method, &answer); /* the first way once more */
        assert_ok(pccd_config_set(client, "contacts-max", "16777216"));
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(answer.total, LIMIT);
        assert_int_equal(answer.counts[PCCD_VF] + answer.counts[PCCD_EE], LIMIT);
        assert_int_equal(read_all(&grid, &answer, kept), LIMIT);
        assert_memory_equal(kept, whole, LIMIT * sizeof *kept);
        fall(&grid, method, &answer); /* it had moved on: this is the way back */
        assert_int_equal(read_all(&grid, &answer, whole), SIDE * SIDE);
    }
    test_grid_close(&grid);
    client = usual;
    free(whole);
    free(kept);
}

/* If it failed, mode first at the limit would keep what is not among the earliest, or
 * take itself for whole. */
CASE_WITH(incomplete__at_the_limit_keeps_some_of_the_first, open_client, close_client)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .mode = PCCD_MODE_FIRST};
    struct test_crossing crossing; /* its three contacts begin at the same time */
    struct pccd_contact whole[3];
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x[3][3];
    assert_ok(test_crossing_make(client, &crossing));
    for (int turn = 0; turn < 3; turn++) {
        crossing.z = -crossing.z;
        test_crossing_positions(x, crossing.z);
        assert_ok(pccd_config_set(client, "contacts-max", turn < 2 ? "16777216" : "2"));
        assert_ok(test_crossing_step(&crossing, x, &settings, &answer));
        if (turn == 0) {
            assert_int_equal(answer.incomplete, PCCD_COMPLETE);
            assert_int_equal(answer.count, 3);
            memcpy(whole, answer.contacts, sizeof whole);
        }
        if (turn < 2) {
            pccd_answer_release(client, &answer);
        }
    }
    assert_ok(pccd_config_set(client, "contacts-max", "16777216"));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
    assert_int_equal(answer.total, 2);
    for (uint64_t i = 0; i < answer.count; i++) {
        uint32_t vertex = answer.contacts[i].feature_a;
        assert_in_range(vertex, 0, 2);
        assert_memory_equal(&answer.contacts[i], &whole[vertex], sizeof whole[0]);
    }
    pccd_answer_release(client, &answer);
}

/* If it failed, an answer could be read for longer than is said, or not as long. */
CASE_WITH(answer__is_kept_until_a_step_or_until_its_objects_change, open_client,
          close_client)
{
    struct test_crossing crossing;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer page = PCCD_ANSWER_INIT;
    uint64_t still = 0;
    uint32_t more = 0;
    float x[3][3];
    assert_ok(test_crossing_make(client, &crossing));
    for (int change = 0; change < 4; change++) {
        crossing.z = -crossing.z;
        test_crossing_positions(x, crossing.z);
        assert_ok(test_crossing_step(&crossing, x, NULL, &answer));
        uint64_t step = answer.step;
        pccd_answer_release(client, &answer);
        if (change == 0) { /* an object that comes takes nothing away */
            more = test_object(client, crossing.scene, crossing.mesh);
        } else if (change == 1) {
            assert_ok(pccd_scene_remove(client, crossing.scene, more));
        } else if (change == 2) {
            assert_ok(pccd_mesh_replace(client, crossing.floor_mesh, test_floor_x,
                                        PCCD_FORMAT_F32, 3, test_triangle, 1, NULL));
        } else {
            assert_ok(pccd_submit_still(client, crossing.scene, NULL, &still));
            assert_ok(pccd_wait(client, still, -1, &answer));
            pccd_answer_release(client, &answer);
        }
        int expected = change == 0 ? PCCD_OK : PCCD_E_STATE;
        assert_int_equal(pccd_fetch(client, crossing.scene, step, 0, &page), expected);
        if (expected == PCCD_OK) {
            assert_int_equal(page.count, 3);
            pccd_answer_release(client, &page);
        }
    }
}

CASES_WITH(test_shared_start, test_shared_stop);
