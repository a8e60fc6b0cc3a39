/* wide_resort.c - features put in order again, aside. */
#include "wide_resort.h"

#include <assert.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "topology.h"
#include "wide.h"
#include "worker.h"

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
    eng_free(resort->pieces);
    eng_free(resort->next);
}

uint64_t eng_wide_resort_bytes(const struct eng_wide_resort *resort)
{
    return resort->item_count * sizeof *resort->items +
           resort->piece_capacity * (sizeof *resort->pieces + sizeof *resort->next);
}

/* Begin anew: what the order at hand asks for is not known yet. */
static void begin_anew(struct eng_wide_resort *resort)
{
    memset(resort->least_tests, 0, sizeof resort->least_tests);
}

void eng_wide_resort_unlearn(struct eng_wide_resort *resort)
{
    begin_anew(resort);
    memset(resort->last_tests, 0, sizeof resort->last_tests);
    memset(resort->refused_tests, 0, sizeof resort->refused_tests);
    memset(resort->whole_tests, 0, sizeof resort->whole_tests);
    memset(resort->tests_each, 0, sizeof resort->tests_each);
}

/* Free what only the sort itself takes. */
static void end_sorting(struct eng_wide_resort *resort)
{
    eng_free(resort->pieces);
    eng_free(resort->next);
    resort->pieces = NULL;
    resort->next = NULL;
    resort->piece_capacity = 0;
}

static void end(struct eng_wide_resort *resort)
{
    end_sorting(resort);
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

/* Room for the features of all objects, and for the pieces of any of them. */
static bool make_room(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    size_t count = 0;
    uint32_t pieces = 1;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        for (int kind = 0; object->mesh && kind < ENG_WIDE_TREES; kind++) {
            count += eng_wide_order_of(object)->count[kind];
        }
        if (object->mesh && eng_wide_order_of(object)->piece_count > pieces) {
            pieces = eng_wide_order_of(object)->piece_count;
        }
    }
    if (count == 0) {
        return false;
    }
    resort->items = eng_alloc(count, sizeof *resort->items);
    resort->item_count = resort->items ? count : 0;
    resort->pieces = !resort->items ? NULL : eng_alloc(pieces, sizeof *resort->pieces);
    resort->next = !resort->pieces ? NULL : eng_alloc(pieces, sizeof *resort->next);
    resort->piece_capacity = pieces;
    return resort->next != NULL;
}

/* The first part of an object. */
static void begin_object(struct eng_wide_resort *resort, const struct eng_scene *scene,
                         uint32_t object)
{
    memset(resort->pieces, 0, resort->piece_capacity * sizeof *resort->pieces);
    resort->object = object;
    resort->frame = scene->objects[object].frame;
    resort->kind = PCCD_TREE_VERTICES;
    resort->summed = 0;
    resort->is_sequenced = false;
}

static void begin_part(struct eng_wide_resort *resort)
{
    resort->sources = 0;
    resort->sorted = 0;
    resort->slot = 0;
    resort->sorter.waiting = 0;
    resort->sorter.is_splitting = false;
}

static void begin(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    if (!make_room(resort, scene)) {
        forget(resort);
        return;
    }
    resort->first = 0;
    begin_object(resort, scene, 0);
    begin_part(resort);
    resort->state = ENG_WIDE_SORTING;
}

/* From now on each object has an order of its own, that can be changed. False: no
 * memory. */
static bool own_orders(struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_wide_object *kept = eng_wide_object_of(&scene->objects[i]);
        if (!scene->objects[i].mesh || kept->own) {
            continue;
        }
        kept->own = eng_wide_order_copy(kept->order);
        if (!kept->own) {
            return false;
        }
        kept->order = kept->own;
    }
    return true;
}

/* The orders of the scene against those of the items. */
static void exchange(struct eng_wide_resort *resort, struct eng_scene *scene)
{
    assert(resort->items);
    struct eng_split_item *item = resort->items;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        for (int kind = 0; object->mesh && kind < ENG_WIDE_TREES; kind++) {
            struct eng_wide_order *order = eng_wide_object_of(object)->own;
            for (uint32_t k = 0; k < order->count[kind]; k++) {
                uint32_t before = order->feature[kind][k];
                order->feature[kind][k] = item->id;
                (item++)->id = before;
            }
        }
        resort->sorted_triangles += object->mesh ? object->mesh->leaf_count : 0;
    }
    resort->sorts++;
    eng_wide_of(scene)->is_stale = true;
    begin_anew(resort);
}

void eng_wide_resort_prepare(struct eng_wide_resort *resort, struct eng_scene *scene)
{
    resort->sorts = 0;
    resort->sorted_triangles = 0;
    bool is_lost = resort->state == ENG_WIDE_SORTED && !own_orders(scene);
    if (eng_wide_of(scene)->is_stale || is_lost) {
        forget(resort);
    } else if (resort->state == ENG_WIDE_SORTED) {
        end_sorting(resort);
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
    begin_part(resort);
    resort->first += object->mesh ? eng_wide_order_of(object)->count[resort->kind] : 0;
    if (object->mesh && resort->kind + 1 < ENG_WIDE_TREES) {
        resort->kind++;
    } else if (resort->object + 1 < scene->object_capacity) {
        begin_object(resort, scene, resort->object + 1);
    } else {
        resort->state = ENG_WIDE_SORTED;
    }
}

/* See where some more vertices are; the pieces are in order with the last of them. */
static void sum_more(struct eng_wide_resort *resort, const struct eng_object *object,
                     struct eng_wide_positions positions)
{
    uint32_t left = object->mesh->info.vertex_count - resort->summed;
    uint32_t count = left < PIECE_SOURCES ? left : PIECE_SOURCES;
    eng_wide_order_sum(eng_wide_order_of(object), positions, resort->summed, count,
                       resort->pieces);
    resort->summed += count;
    if (count == left) {
        eng_wide_order_sequence(eng_wide_order_of(object), resort->pieces);
        resort->is_sequenced = true;
    }
}

/* List some more features of the part at hand. */
static void list_more(struct eng_wide_resort *resort, const struct eng_object *object,
                      struct eng_wide_positions positions, uint32_t left)
{
    struct eng_split_item *items = resort->items + resort->first;
    uint32_t count = left < PIECE_SOURCES ? left : PIECE_SOURCES;
    if (resort->sources == 0) {
        eng_wide_order_assign_slots(eng_wide_order_of(object), resort->kind,
                                    resort->pieces, items, resort->next);
    }
    struct eng_wide_sources sources = {resort->kind, resort->sources, count};
    eng_wide_order_list(eng_wide_order_of(object), object->mesh, positions, sources,
                        items, resort->next);
    resort->sources += count;
}

/* Have the sorter take the next piece, in the sequence in which they lie. */
static void sort_next(struct eng_wide_resort *resort, const struct eng_wide_order *order)
{
    uint32_t piece = resort->pieces[resort->sorted++].id;
    struct eng_wide_range range = {resort->slot, resort->slot,
                                   order->piece_size[resort->kind][piece]};
    eng_wide_sorter_begin(&resort->sorter, range, ENG_WIDE);
    resort->slot += eng_wide_order_slots(order, resort->kind, piece);
}

/* A piece of the part at hand. */
static void advance(struct eng_wide_resort *resort, const struct eng_scene *scene)
{
    const struct eng_object *object = &scene->objects[resort->object];
    if (!object->mesh) {
        go_on(resort, scene);
        return;
    }
    struct eng_wide_positions positions = {(const double(*)[3])scene->x[scene->now] +
                                               object->vertices.first,
                                           &resort->frame};
    uint32_t left = eng_wide_order_sources(object->mesh, resort->kind) - resort->sources;
    if (!resort->is_sequenced) {
        sum_more(resort, object, positions);
    } else if (left > 0) {
        list_more(resort, object, positions, left);
    } else if (!eng_wide_sorter_advance(&resort->sorter, resort->items + resort->first,
                                        PIECE_ITEMS)) {
        if (resort->sorted < eng_wide_order_of(object)->piece_count) {
            sort_next(resort, eng_wide_order_of(object));
        } else {
            go_on(resort, scene);
        }
    }
}

void eng_wide_resort_share(struct eng_wide_resort *resort, const struct eng_scene *scene,
                           const struct eng_stop *stop)
{
    assert(resort->state == ENG_WIDE_SORTING);
    uint64_t end_ns = common_now_ns() + resort->budget_ns;
    while (resort->state == ENG_WIDE_SORTING && !eng_stop_is_set(stop)) {
        advance(resort, scene);
        if (common_now_ns() >= end_ns) {
            break;
        }
    }
}

uint64_t eng_wide_resort_whole(struct eng_wide_resort *resort, enum pccd_mode mode,
                               uint64_t box_tests, uint64_t moving, uint64_t all)
{
    assert(moving >= 1 && moving <= all);
    double whole = (double)resort->whole_tests[mode];
    double each = (double)box_tests / (double)moving;
    double *first = &resort->tests_each[mode];
    if (*first <= 0) {
        *first = each;
    }
    double part = (double)moving / (double)all;
    double growth = each > *first ? each / *first - 1 : 0;
    return (uint64_t)(whole * (1 + part * growth));
}

void eng_wide_resort_learn(struct eng_wide_resort *resort, enum pccd_mode mode,
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
