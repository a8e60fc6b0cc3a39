/* test_eng_order.c - the order in which features are stored. */
#include "eng_kit.h"
#include "memory.h"
#include "topology.h"
#include "wide_order.h"

/* If a feature were missing from its order it would never be tested; if an aligned group
 * were spread over the object, its box would be useless. */
CASE(order__has_every_feature_once_in_tight_groups)
{
    enum { STRIP = 700 };
    static double x[STRIP + 3][3];
    static uint32_t triangles[STRIP][3];
    struct prng random = {5};
    for (uint32_t i = 0; i < STRIP + 3; i++) { /* the last one is in no triangle */
        x[i][0] = (double)(i * 577 % (STRIP + 3));
        x[i][1] = prng_between(&random, 0, 0.5);
    }
    for (uint32_t i = 0; i < STRIP; i++) {
        triangles[i][0] = i;
        triangles[i][1] = i + 1;
        triangles[i][2] = i; /* an edge and a face for each pair of neighbours */
    }
    struct eng_mesh *mesh = kit_mesh(x, STRIP + 3, triangles, STRIP);
    struct eng_wide_order *order;
    assert_ok(eng_wide_order_new(mesh, (const double(*)[3])mesh->x, 1, &order));
    assert_int_equal(order->count[PCCD_TREE_VERTICES], STRIP + 1);
    assert_int_equal(order->count[PCCD_TREE_EDGES], STRIP);
    assert_int_equal(order->count[PCCD_TREE_FACES], STRIP);
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        static bool seen[STRIP + 3];
        memset(seen, 0, sizeof seen);
        for (uint32_t i = 0; i < order->count[kind]; i++) {
            uint32_t feature = order->feature[kind][i];
            assert_true(feature <= STRIP && !seen[feature]);
            seen[feature] = true;
        }
    }
    const uint32_t *vertex = order->feature[PCCD_TREE_VERTICES];
    for (uint32_t group = 16; group <= 256; group *= 16) {
        for (uint32_t first = 0; first + group < STRIP + 1; first += group) {
            double last = 0; /* groups follow each other along the longest axis */
            for (uint32_t i = 0; i < group; i++) {
                last = x[vertex[first + i]][0] > last ? x[vertex[first + i]][0] : last;
            }
            for (uint32_t i = first + group; i < STRIP + 1; i++) {
                assert_true(x[vertex[i]][0] > last);
            }
        }
    }
    eng_free(order);
    eng_mesh_release(mesh);
}

static int compare_ids(const void *a, const void *b)
{
    const struct eng_split_item *x = a;
    const struct eng_split_item *y = b;
    return x->id < y->id ? -1 : x->id > y->id;
}

/* Without order within groups, which is none of the contract. */
static void sort_groups(struct eng_split_item *items, struct eng_wide_range range)
{
    for (uint32_t i = 0; i < range.count;) {
        uint32_t end = i + 16 - (range.slot + i) % 16;
        end = end < range.count ? end : range.count;
        qsort(items + range.first + i, end - i, sizeof *items, compare_ids);
        i = end;
    }
}

/* If it failed, features that are near each other would not be in one group: on a grid,
 * where most coordinates are equal, beside one that is far away, or in the least mesh. */
CASE(words__make_the_groups_that_medians_make)
{
    static uint64_t words[2 * ENG_WIDE_WORDS_MAX];
    static struct eng_split_item items[2][ENG_WIDE_WORDS_MAX + 300];
    static uint32_t ids[ENG_WIDE_WORDS_MAX + 300];
    const uint32_t counts[] = {1, 16, 17, 255, 256, 257, 1000, 2048, ENG_WIDE_WORDS_MAX};
    struct prng random = {11};
    for (uint32_t round = 0; round < 6 * sizeof counts / sizeof *counts; round++) {
        uint32_t count = counts[round / 6], kind = round % 6;
        struct eng_wide_range range = {0, 0, count + (kind == 2 ? 300 : 0)};
        for (uint32_t i = 0; i < range.count; i++) {
            struct eng_split_item *item = &items[0][i];
            item->id = kind == 1 ? i : (i * 7919u + 13u) % 104729u;
            for (int k = 0; k < 3; k++) {
                double x = prng_between(&random, -4, 4);
                item->centroid[k] = kind == 3 ? 1 : kind == 1 ? (float)(int)x : (float)x;
                item->centroid[k] *= k == 2 && i % 2 == 0 ? -0.0f : 1;
                item->centroid[k] *= kind == 4 && i == 0 ? 1e9f : kind == 5 ? 1e-36f : 1;
            }
        }
        if (kind == 2) { /* a part behind another, from a slot that is no multiple */
            range = (struct eng_wide_range){37, 256 * 3 + 5, count};
        }
        memcpy(items[1], items[0], sizeof items[0]);
        struct eng_wide_sorter sorter;
        eng_wide_sorter_begin(&sorter, range, 16);
        while (eng_wide_sorter_advance(&sorter, items[0], 64)) {
        }
        eng_wide_words_sort(words, items[1], range, ids);
        for (uint32_t i = 0; i < count; i++) {
            items[1][range.first + i].id = ids[range.first + i];
        }
        sort_groups(items[0], range);
        sort_groups(items[1], range);
        for (uint32_t i = 0; i < count; i++) {
            assert_int_equal(items[0][range.first + i].id, items[1][range.first + i].id);
        }
    }
}

/* `count` sheets of 8 x 8 squares in the same place, the first one of 8 x 8 x `times`. */
static struct eng_mesh *sheets(uint32_t count, uint32_t times)
{
    static double x[9 * 9 * 128][3];
    static uint32_t triangles[2 * 8 * 8 * 128][3];
    uint32_t vertices = 0, made = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t rows = i == 0 ? 8 * times : 8;
        for (uint32_t k = 0; k < rows * 8; k++) {
            uint32_t v = vertices + k / 8 * 9 + k % 8;
            const uint32_t two[2][3] = {{v, v + 1, v + 9}, {v + 1, v + 10, v + 9}};
            memcpy(triangles[made], two, sizeof two);
            made += 2;
        }
        for (uint32_t k = 0; k < (rows + 1) * 9; k++, vertices++) {
            x[vertices][0] = k % 9;
            x[vertices][1] = (double)(k / 9);
            x[vertices][2] = 0.01 * i;
        }
    }
    return kit_mesh(x, vertices, triangles, made);
}

/* If it failed: how fast a step is would depend on how many threads there were when its
 * mesh came. */
CASE(order__is_the_same_by_any_number_of_threads)
{
    /* More features than one thread takes, in one piece or in many. */
    struct eng_mesh *meshes[2] = {kit_sheet(100, 0.3), sheets(100, 2)};
    struct eng_wide_order *orders[2];
    const uint32_t threads[] = {2, 7, 16};
    for (int i = 0; i < 6; i++) {
        const struct eng_mesh *mesh = meshes[i / 3];
        const double(*x)[3] = (const double(*)[3])mesh->x;
        assert_ok(eng_wide_order_new(mesh, x, 0, &orders[0]));
        assert_ok(eng_wide_order_new(mesh, x, threads[i % 3], &orders[1]));
        for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
            assert_int_equal(orders[1]->count[kind], orders[0]->count[kind]);
            assert_memory_equal(orders[1]->feature[kind], orders[0]->feature[kind],
                                orders[0]->count[kind] * sizeof(uint32_t));
        }
        eng_free(orders[0]);
        eng_free(orders[1]);
    }
    eng_mesh_release(meshes[0]);
    eng_mesh_release(meshes[1]);
}

/* If it failed: a body and its splinters, or a pair, would lie where the splinters leave
 * room; or what breaks into many would mix them (test_eng_resort says at what price). */
CASE(order__pieces_are_told_apart_if_they_are_many)
{
    const struct {
        uint32_t sheets, times, pieces, threads;
    } cases[] = {{1, 1, 1, 1},   {15, 1, 1, 1},  {16, 1, 16, 1},  {40, 1, 40, 1},
                 {20, 24, 1, 1}, {20, 24, 1, 2}, {17, 16, 17, 1}, {40, 20, 40, 7}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct eng_mesh *mesh = sheets(cases[i].sheets, cases[i].times);
        struct eng_wide_order *order;
        assert_ok(eng_wide_order_new(mesh, (const double(*)[3])mesh->x, cases[i].threads,
                                     &order));
        assert_int_equal(order->piece_count, cases[i].pieces);
        for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
            uint32_t sum = 0;
            for (uint32_t k = 0; k < order->piece_count; k++) {
                sum += order->piece_size[kind][k];
            }
            for (uint32_t k = 0; k < order->count[kind]; k++) {
                sum -= order->feature[kind][k] != ENG_WIDE_NO_FEATURE;
            }
            assert_int_equal(sum, 0);
        }
        eng_free(order);
        eng_mesh_release(mesh);
    }
}
