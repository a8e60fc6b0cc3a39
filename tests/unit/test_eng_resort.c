/* test_eng_resort.c - features that have left their neighbours are put in order again. */
#include "eng_kit.h"
#include "memory.h"
#include "step.h"
#include "wide_state.h"
#include "worker.h"
#include "world.h"

#define COUNT    6000u
#define VERTICES (3 * COUNT)

struct soup {
    struct eng_scene *scene;
    uint32_t idx;
    double rest[VERTICES][3];
    double (*x)[3];        /* [VERTICES] where it is to go */
    uint32_t place[COUNT]; /* triangle i goes to where triangle place[i] was */
};

static struct soup soup;

static void start(void)
{
    struct prng random = {91};
    struct eng_mesh *mesh = kit_soup(&random, COUNT);
    memcpy(soup.rest, mesh->x, sizeof soup.rest);
    assert_ok(eng_mesh_sort_features(mesh, 1));
    soup.scene = kit_scene();
    soup.idx = kit_add(soup.scene, mesh, 1);
    soup.x = test_copy(soup.rest, sizeof soup.rest);
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t other = prng_u32(&random, i + 1);
        soup.place[i] = soup.place[other];
        soup.place[other] = i;
    }
}

static void end(void)
{
    eng_scene_free(soup.scene);
    free(soup.x);
}

/* Every triangle goes to the place of another. */
static void shuffle(void)
{
    for (uint32_t i = 0; i < COUNT; i++) {
        memcpy(soup.x[3 * i], soup.rest[3 * soup.place[i]], sizeof soup.rest[0] * 3);
    }
}

static struct eng_step_result step(enum pccd_mode mode, uint32_t threads)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_WIDE);
    settings.threads = threads;
    settings.team_always = true;
    settings.tuning.still = ENG_STILL_ANEW; /* the shuffled soup then stands */
    eng_stage_begin(soup.scene);
    assert_ok(eng_stage_x0x1(soup.scene, soup.idx, PCCD_FORMAT_F64, 0, VERTICES, soup.x,
                             soup.x));
    struct eng_step_result result = kit_step(soup.scene, &settings);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    return result;
}

/* Steps until the features have a new order; what the step that takes it took, and how
 * many steps came before. */
static struct eng_step_result until_sorted(uint32_t threads, uint32_t *steps)
{
    for (*steps = 0; *steps < 10000; (*steps)++) {
        struct eng_step_result result = step(PCCD_MODE_PAIRS, threads);
        if (result.counters.swaps > 0) {
            assert_int_equal(result.counters.swaps, 1);
            assert_int_equal(result.counters.swapped_triangles, COUNT);
            return result;
        }
        assert_int_equal(result.counters.swapped_triangles, 0);
    }
    fail_msg("never sorted");
    return (struct eng_step_result){0};
}

/* A step in which the soup moves a little to and fro and all else stands. */
static struct eng_step_result step_to_and_fro(uint32_t number)
{
    struct eng_question settings = kit_contacts(PCCD_MODE_PAIRS, PCCD_METHOD_WIDE);
    for (uint32_t v = 0; v < VERTICES; v++) {
        soup.x[v][0] += number % 2 == 0 ? 0x1p-20 : -0x1p-20;
    }
    eng_stage_begin(soup.scene);
    assert_ok(eng_stage_x1(soup.scene, soup.idx, PCCD_FORMAT_F64, 0, VERTICES, soup.x));
    struct eng_step_result result = kit_step(soup.scene, &settings);
    return result;
}

/* If it failed: what moves would be slow for ever in a scene of which half stands, as its
 * steps never go through all of it. */
CASE(resort__sees_what_moves_beside_what_stands)
{
    struct prng random = {17};
    struct eng_mesh *scenery = kit_soup(&random, COUNT);
    start();
    kit_add(soup.scene, scenery, 2);
    for (uint32_t i = 0; i < 3; i++) {
        (void)step_to_and_fro(i);
    }
    shuffle();
    uint32_t steps = 3;
    struct eng_step_result result;
    do {
        result = step_to_and_fro(++steps);
        assert_true(result.counters.still_features > 0 || result.counters.swaps > 0);
    } while (result.counters.swaps == 0 && steps < 10000);
    assert_true(steps > 4 && steps < 10000);
    end();
}

/* If it failed: a mesh that comes apart would be as slow for ever as on the day that its
 * parts had mixed; or the answer would depend on the order. */
CASE(resort__makes_a_mixed_soup_as_good_as_new)
{
    for (uint32_t threads = 1; threads <= 2; threads++) {
        uint32_t steps;
        start();
        struct eng_step_result fresh = step(PCCD_MODE_PAIRS, threads);
        shuffle();
        struct eng_step_result mixed = step(PCCD_MODE_PAIRS, threads);
        assert_true(mixed.counters.box_tests > 2 * fresh.counters.box_tests);
        struct eng_step_result sorted = until_sorted(threads, &steps);
        assert_true(steps >= 1); /* a share in each, not all at once */
        assert_true(10 * sorted.counters.box_tests < 11 * fresh.counters.box_tests);
        assert_int_equal(sorted.hash[1], mixed.hash[1]);
        assert_int_equal(sorted.count, mixed.count);
        assert_ok(eng_wide_resort_bytes(&eng_wide_state_of(soup.scene)->resort));
        end();
    }
}

/* If it failed: a thousand scenes of one mesh would have its order a thousand times; or
 * what one scene moves would put the features of all others in disorder. */
CASE(order__is_the_meshs_until_an_object_needs_another)
{
    uint32_t idx, steps;
    start();
    struct eng_mesh *mesh = soup.scene->objects[soup.idx].mesh;
    assert_int_equal(eng_mesh_sort_features(mesh, 1), PCCD_E_STATE);
    struct eng_scene *other = kit_scene();
    uint64_t before = eng_alloc_bytes();
    assert_ok(eng_scene_add(other, mesh, 1, &idx));
    uint64_t positions = (uint64_t)VERTICES * 2 * sizeof *mesh->x;
    assert_true(eng_alloc_bytes() - before < positions + mesh->order_bytes);
    assert_ptr_equal(eng_wide_order_of(&other->objects[idx]), mesh->order);
    assert_ptr_equal(eng_wide_order_of(&soup.scene->objects[soup.idx]), mesh->order);
    size_t bytes = mesh->order->count[PCCD_TREE_FACES] * sizeof(uint32_t);
    uint32_t *faces = test_copy(mesh->order->feature[PCCD_TREE_FACES], bytes);
    step(PCCD_MODE_PAIRS, 1);
    shuffle();
    (void)until_sorted(1, &steps);
    const struct eng_wide_order *own = eng_wide_order_of(&soup.scene->objects[soup.idx]);
    assert_ptr_not_equal(own, mesh->order);
    assert_memory_not_equal(own->feature[PCCD_TREE_FACES], faces, bytes);
    assert_memory_equal(mesh->order->feature[PCCD_TREE_FACES], faces, bytes);
    assert_ptr_equal(eng_wide_order_of(&other->objects[idx]), mesh->order);
    free(faces);
    eng_scene_free(other);
    end();
}

/* If it failed: scenes whose order is good would pay for sorting it. */
CASE(resort__leaves_a_good_order_alone)
{
    start();
    for (uint32_t i = 0; i < 50; i++) {
        assert_int_equal(step(PCCD_MODE_PAIRS, 1).counters.swaps, 0);
        assert_int_equal(eng_wide_state_of(soup.scene)->resort.state, ENG_WIDE_IDLE);
    }
    end();
}

/* If it failed: an order of features that are gone would be taken. */
CASE(resort__forgets_what_it_began_when_objects_change)
{
    const enum eng_wide_resort_state states[] = {ENG_WIDE_WANTED, ENG_WIDE_SORTING,
                                                 ENG_WIDE_SORTED};
    for (int i = 0; i < 3; i++) {
        struct prng random = {3};
        start();
        step(PCCD_MODE_PAIRS, 1);
        shuffle();
        for (uint32_t steps = 0; eng_wide_state_of(soup.scene)->resort.state != states[i];
             steps++) {
            assert_true(steps < 10000);
            if (states[i] == ENG_WIDE_SORTING) {
                eng_wide_state_of(soup.scene)->resort.budget_ns =
                    0; /* a piece: not all in one step */
            }
            step(PCCD_MODE_PAIRS, 1);
        }
        kit_add(soup.scene, kit_soup(&random, 50), 2);
        assert_int_equal(step(PCCD_MODE_PAIRS, 1).counters.swaps, 0);
        assert_int_equal(eng_wide_state_of(soup.scene)->resort.state, ENG_WIDE_IDLE);
        end();
    }
}

/* Bring what is sorted into no order at all. */
static void spoil(struct eng_wide_resort *resort)
{
    const struct eng_object *object = &soup.scene->objects[soup.idx];
    struct prng random = {17};
    struct eng_split_item *part = resort->items;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t count = eng_wide_order_of(object)->count[kind];
        for (uint32_t i = 0; i < count; i++) {
            uint32_t other = prng_u32(&random, i + 1);
            struct eng_split_item item = part[i];
            part[i] = part[other];
            part[other] = item;
        }
        part += count;
    }
}

/* If it failed: what winds itself up would be twice as slow from the day on that a new
 * order was tried; or it would be tried again and again. */
CASE(resort__takes_back_an_order_that_is_worse)
{
    start();
    struct eng_wide_resort *resort = &eng_wide_state_of(soup.scene)->resort;
    step(PCCD_MODE_PAIRS, 1);
    struct eng_step_result good = step(PCCD_MODE_PAIRS, 1);
    resort->state = ENG_WIDE_WANTED;
    while (resort->state != ENG_WIDE_SORTED) {
        step(PCCD_MODE_PAIRS, 1);
    }
    spoil(resort);
    struct eng_step_result tried = step(PCCD_MODE_PAIRS, 1);
    assert_int_equal(tried.counters.swaps, 1);
    assert_true(tried.counters.box_tests > 2 * good.counters.box_tests);
    assert_int_equal(tried.hash[1], good.hash[1]);
    struct eng_step_result back = step(PCCD_MODE_PAIRS, 1);
    assert_int_equal(back.counters.swaps, 1);
    assert_int_equal(back.counters.box_tests, good.counters.box_tests);
    assert_int_equal(back.hash[1], good.hash[1]);
    assert_int_equal(resort->state, ENG_WIDE_IDLE);
    assert_int_equal(eng_wide_resort_bytes(resort), 0);
    /* As much as would ask for a sort, but for the one that was in vain. */
    resort->least_tests[PCCD_MODE_PAIRS] = good.counters.box_tests / 2;
    step(PCCD_MODE_PAIRS, 1);
    assert_int_equal(resort->state, ENG_WIDE_IDLE);
    resort->refused_tests[PCCD_MODE_PAIRS] = good.counters.box_tests / 2;
    step(PCCD_MODE_PAIRS, 1);
    assert_int_equal(resort->state, ENG_WIDE_WANTED);
    end();
}

/* If it failed: a step that is cancelled, or past its deadline, would sort on; or a share
 * would be as long as an object is large. */
CASE(resort__shares_are_short_and_end_with_the_step)
{
    const struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_stop stop;
    start();
    step(PCCD_MODE_PAIRS, 1);
    struct eng_wide_resort *resort = &eng_wide_state_of(soup.scene)->resort;
    resort->state = ENG_WIDE_WANTED;
    eng_wide_resort_prepare(resort, soup.scene);
    assert_int_equal(resort->state, ENG_WIDE_SORTING);
    resort->budget_ns = 0; /* one piece */
    eng_stop_init(&stop, &settings);
    atomic_store(&stop.stopped, true);
    eng_wide_resort_share(resort, soup.scene, &stop);
    assert_int_equal(resort->sources, 0);
    atomic_store(&stop.stopped, false);
    while (resort->kind != PCCD_TREE_EDGES || resort->sources == 0) {
        assert_int_equal(resort->state, ENG_WIDE_SORTING);
        eng_wide_resort_share(resort, soup.scene, &stop);
    }
    assert_int_equal(resort->sources, 16384); /* of 18000 edges */
    assert_int_equal(resort->sorted, 0);
    eng_wide_resort_share(resort, soup.scene, &stop);
    assert_int_equal(resort->sources, 3 * COUNT);
    assert_int_equal(resort->sorted, 0);
    eng_wide_resort_share(resort, soup.scene, &stop);
    assert_int_equal(resort->sorted, 1); /* they are not told apart: all are one */
    end();
}

/* ---- pieces ------------------------------------------------------------------------ */

#define PIECES  48u
#define SIDE    9u /* vertices */
#define SHEET   (SIDE * SIDE)
#define SQUARES ((SIDE - 1) * (SIDE - 1))

/* Sheets one upon the other, or each somewhere else. */
static void put_pieces(double (*x)[3], bool apart)
{
    for (uint32_t i = 0; i < PIECES * SHEET; i++) {
        uint32_t piece = i / SHEET, k = i % SHEET;
        uint32_t place = apart ? piece * 29 % PIECES : 0;
        x[i][0] = k % SIDE + 12.0 * (place % 7) + 0.01 * piece;
        x[i][1] = k / SIDE % SIDE + 12.0 * (place / 7);
        x[i][2] = 0.05 * piece;
    }
}

static uint32_t add_pieces(struct eng_scene *scene, const double (*x)[3])
{
    static uint32_t triangles[2 * PIECES * SQUARES][3];
    uint32_t count = 0, idx;
    for (uint32_t i = 0; i < PIECES * SQUARES; i++) {
        uint32_t square = i % SQUARES;
        uint32_t v =
            i / SQUARES * SHEET + square / (SIDE - 1) * SIDE + square % (SIDE - 1);
        const uint32_t two[2][3] = {{v, v + 1, v + SIDE},
                                    {v + 1, v + SIDE + 1, v + SIDE}};
        memcpy(triangles[count], two, sizeof two);
        count += 2;
    }
    struct eng_mesh *mesh = kit_mesh(x, PIECES * SHEET, triangles, count);
    idx = kit_add(scene, mesh, 1);
    return idx;
}

/* A step of pieces to x. */
static struct eng_step_result step_pieces(struct eng_scene *scene, uint32_t idx,
                                          const double (*x)[3])
{
    struct eng_question settings = kit_contacts(PCCD_MODE_PAIRS, PCCD_METHOD_WIDE);
    settings.tuning.still = ENG_STILL_ANEW;
    eng_stage_begin(scene);
    assert_ok(eng_stage_x0x1(scene, idx, PCCD_FORMAT_F64, 0, PIECES * SHEET, x, x));
    struct eng_step_result result = kit_step(scene, &settings);
    return result;
}

/* Check which piece the features of an order are of: each piece's follow each other. */
static void check_pieces(const struct eng_object *object)
{
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t changes = 0, last = PIECES;
        for (uint32_t i = 0; i < eng_wide_order_of(object)->count[kind]; i++) {
            uint32_t f = eng_wide_order_of(object)->feature[kind][i];
            if (f == ENG_WIDE_NO_FEATURE) {
                continue;
            }
            uint32_t vertex = kind == PCCD_TREE_VERTICES ? f
                              : kind == PCCD_TREE_EDGES  ? object->mesh->edges[f][0]
                                                         : object->mesh->leaves[f].v[0];
            changes += vertex / SHEET != last;
            last = vertex / SHEET;
        }
        assert_int_equal(changes, PIECES);
    }
}

/* If it failed: what breaks would be many times as slow from then on, until its features
 * had been sorted; or they would be sorted so that the next break is as bad. */
CASE(resort__pieces_may_fly_apart)
{
    static double x[PIECES * SHEET][3];
    struct eng_scene *scenes[2]; /* stacked first; apart from the beginning */
    uint32_t idx[2];
    for (int i = 0; i < 2; i++) {
        put_pieces(x, i == 1);
        scenes[i] = kit_scene();
        idx[i] = add_pieces(scenes[i], (const double(*)[3])x);
        check_pieces(&scenes[i]->objects[idx[i]]);
    }
    struct eng_step_result flown = step_pieces(scenes[0], idx[0], (const double(*)[3])x);
    struct eng_step_result fresh = step_pieces(scenes[1], idx[1], (const double(*)[3])x);
    assert_int_equal(flown.hash[1], fresh.hash[1]);
    assert_true(flown.counters.box_tests < 2 * fresh.counters.box_tests);

    eng_wide_state_of(scenes[0])->resort.state = ENG_WIDE_WANTED;
    struct eng_step_result sorted;
    do {
        sorted = step_pieces(scenes[0], idx[0], (const double(*)[3])x);
    } while (sorted.counters.swaps == 0);
    check_pieces(&scenes[0]->objects[idx[0]]);
    assert_int_equal(sorted.hash[1], fresh.hash[1]);
    assert_int_equal(sorted.counters.box_tests, fresh.counters.box_tests);
    eng_scene_free(scenes[0]);
    eng_scene_free(scenes[1]);
}
