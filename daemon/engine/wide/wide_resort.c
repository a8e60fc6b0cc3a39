/* daemon/engine/wide/wide_resort.c - features put in order again, aside.
 *
 * Room:     engine.
 * Does:     see wide_resort.h.
 * Threads:  wide_resort.h.
 */
#include "wide_resort.h"

#include <assert.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "topology.h"
#include "worker.h"
#include "world.h"

/* A sort is wanted when a step takes this much more than the cheapest one since the last
 * sort. What a sort costs in all, some 80 ns a feature, is what a step gains by a quarter
 * fewer tests in two or three. */
#define GROWTH_NUM 5u
#define GROWTH_DEN 4u

/* A new order that asks for this much more than the one before it, in the next step, is
 * taken back. */
#define WORSE_NUM 9u
#define WORSE_DEN 8u

/* Times as many box tests as with an order taken back to, before another sort. */
#define PATIENCE 2u

/* Box tests below which it is not worth while: 0.2 ms. */
#define TESTS_MIN 10000u

/* The share of a step that the sort may take, and the least that it takes. */
#define BUDGET_PART   32u
#define BUDGET_MIN_NS 20000u

/* Pieces of work between two looks at the clock, each a pass over at most this many
 * items or a pass over a larger part. */
#define PIECE_ITEMS 1024u

/* Edges or triangles that are listed between two looks: some 0.2 ms of gathers from
 * memory, a tenth of what a client that cancels may have to wait. */
#define PIECE_SOURCES 16384u

void eng_wide_resort_init(struct eng_wide_resort *resort)
{
    memset(resort, 0, sizeof *resort);
    resort->state = ENG_WIDE_IDLE;
}

void eng_wide_resort_deinit(struct eng_wide_resort *resort)
{
    eng_free(resort->items);
}

uint64_t eng_wide_resort_bytes(const struct eng_wide_resort *resort)
{
    return resort->item_count * sizeof *resort->items;
}

/* What the order at hand asks for is not known yet. */
static void begin_anew(struct eng_wide_resort *resort)
{
    memset(resort->least_tests, 0, sizeof resort->least_tests);
}

void eng_wide_resort_unlearn(struct eng_wide_resort *resort)
{
    begin_anew(resort);
    memset(resort->last_tests, 0, sizeof resort->last_tests);
    memset(resort->refused_tests, 0, sizeof resort->refused_tests);
}

static void end(struct eng_wide_resort *resort)
{
    eng_free(resort->items);
    resort->items = NULL;
    resort->item_count = 0;
    resort->state = ENG_WIDE_IDLE;
}

/* Idle, and nothing known of the order at hand. */
static void forget(struct eng_wide_resort *resort)
{
    end(resort);
    eng_wide_resort_unlearn(resort);
}

static size_t feature_count(const struct eng_scene *scene)
{
    size_t sum = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        for (int kind = 0; kind < ENG_WIDE_KINDS; kind++) {
            sum += object->mesh ? object->order->count[kind] : 0;
        }
    }
    return sum;
}

static void begin(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    size_t count = feature_count(scene);
    resort->items = count > 0 ? eng_alloc(count, sizeof *resort->items) : NULL;
    if (!resort->items) {
        forget(resort);
        return;
    }
    resort->item_count = count;
    resort->object = 0;
    resort->kind = ENG_WIDE_VERTICES;
    resort->first = 0;
    resort->sources = 0;
    resort->listed = 0;
    resort->is_begun = false;
    resort->state = ENG_WIDE_SORTING;
}

/* The orders of the scene against those of the items. */
static void exchange(struct eng_wide_resort *resort, struct eng_scene *scene)
{
    struct eng_split_item *item = resort->items;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        for (int kind = 0; object->mesh && kind < ENG_WIDE_KINDS; kind++) {
            for (uint32_t k = 0; k < object->order->count[kind]; k++) {
                uint32_t before = object->order->feature[kind][k];
                object->order->feature[kind][k] = item->id;
                (item++)->id = before;
            }
        }
        resort->sorted_triangles += object->mesh ? object->mesh->info.triangle_count : 0;
    }
    resort->sorts++;
    scene->wide.is_stale = true;
    begin_anew(resort);
}

void eng_wide_resort_prepare(struct eng_wide_resort *resort, struct eng_scene *scene)
{
    resort->sorts = 0;
    resort->sorted_triangles = 0;
    if (scene->wide.is_stale) {
        forget(resort);
    } else if (resort->state == ENG_WIDE_SORTED) {
        exchange(resort, scene);
        resort->state = ENG_WIDE_TRIED;
    } else if (resort->state == ENG_WIDE_REFUSED) {
        exchange(resort, scene);
        end(resort);
    } else if (resort->state == ENG_WIDE_WANTED) {
        begin(resort, scene);
    }
}

/* The next part: another tree of the object, or another object. */
static void go_on(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    const struct eng_object *object = &scene->objects[resort->object];
    resort->sources = 0;
    resort->listed = 0;
    resort->is_begun = false;
    resort->first += object->mesh ? object->order->count[resort->kind] : 0;
    if (object->mesh && resort->kind + 1 < ENG_WIDE_KINDS) {
        resort->kind++;
        return;
    }
    resort->kind = ENG_WIDE_VERTICES;
    if (++resort->object == scene->object_capacity) {
        resort->state = ENG_WIDE_SORTED;
    }
}

/* List some more features of the part at hand; its sort begins with the last of them. */
static void list_more(struct eng_wide_resort *resort, const struct eng_scene *scene,
                      const struct eng_object *object)
{
    const double(*x)[3] = (const double(*)[3])scene->x[scene->now];
    uint32_t left = eng_wide_order_sources(object->mesh, resort->kind) - resort->sources;
    uint32_t count = left < PIECE_SOURCES ? left : PIECE_SOURCES;
    resort->listed += eng_wide_order_list(object->mesh, x + object->vertices.first,
                                          resort->kind, resort->sources, count,
                                          resort->items + resort->first + resort->listed);
    resort->sources += count;
    if (count == left) {
        assert(resort->listed == object->order->count[resort->kind]);
        eng_wide_sorter_begin(&resort->sorter, resort->listed, ENG_WIDE);
        resort->is_begun = true;
    }
}

/* A piece of the part at hand. */
static void advance(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    const struct eng_object *object = &scene->objects[resort->object];
    if (!object->mesh) {
        go_on(resort, scene);
        return;
    }
    if (!resort->is_begun) {
        list_more(resort, scene, object);
    } else if (!eng_wide_sorter_advance(&resort->sorter, resort->items + resort->first,
                                        PIECE_ITEMS)) {
        go_on(resort, scene);
    }
}

void eng_wide_resort_share(struct eng_wide_resort *resort, const struct eng_scene *scene,
                           const struct eng_stop *stop)
{
    uint64_t end_ns = eng_now_ns() + resort->budget_ns;
    while (resort->state == ENG_WIDE_SORTING && !eng_stop_is_set(stop)) {
        advance(resort, scene);
        if (eng_now_ns() >= end_ns) {
            break;
        }
    }
}

void eng_wide_resort_learn(struct eng_wide_resort *resort, enum eng_mode mode,
                           uint64_t box_tests, uint64_t step_ns)
{
    uint64_t *least = &resort->least_tests[mode];
    uint64_t *last = &resort->last_tests[mode];
    uint64_t budget_ns = step_ns / BUDGET_PART;
    resort->budget_ns = budget_ns > BUDGET_MIN_NS ? budget_ns : BUDGET_MIN_NS;
    if (resort->state == ENG_WIDE_TRIED && *last > 0) {
        if (box_tests / WORSE_NUM > *last / WORSE_DEN) {
            resort->state = ENG_WIDE_REFUSED;
            resort->refused_tests[mode] = *last;
            return;
        }
        resort->refused_tests[mode] = 0;
        end(resort);
    }
    if (resort->state == ENG_WIDE_IDLE && *least > 0 && box_tests >= TESTS_MIN &&
        box_tests / GROWTH_NUM > *least / GROWTH_DEN &&
        box_tests / PATIENCE >= resort->refused_tests[mode]) {
        resort->state = ENG_WIDE_WANTED;
    }
    *least = *least == 0 || box_tests < *least ? box_tests : *least;
    *last = box_tests;
}
