/* test_cli_weld.c - vertices at one place. */
#include "cases.h"

#include <fenv.h>
#include <time.h>

#include "pccd.h"
#include "prng.h"

static struct pccd_weld *begin(uint32_t vertex_count, double distance, bool tells_more)
{
    const struct pccd_mesh_data mesh = {.vertex_count = vertex_count};
    struct pccd_weld *weld = NULL;
    assert_ok(pccd_weld_begin(&mesh, distance, tells_more, &weld));
    return weld;
}

static struct pccd_weld_counts go_on(struct pccd_weld *weld, const void *x)
{
    struct pccd_weld_counts counts;
    assert_ok(pccd_weld_frame(weld, x, PCCD_FORMAT_F64));
    assert_non_null(pccd_weld_read(weld, &counts));
    return counts;
}

/* If it failed: two vertices that stay together would be parted because a third one that
 * was there, too, has gone; or many at one place would take for ever. */
CASE(weld__keeps_together_what_stays_together)
{
    enum { COUNT = 200000 };
    double(*x)[3] = test_room(COUNT * sizeof *x);
    struct pccd_weld *weld = begin(COUNT, 0, false);
    const uint32_t *to = pccd_weld_read(weld, NULL);
    assert_null(to);
    assert_int_equal(go_on(weld, x).joined, COUNT - 1);
    to = pccd_weld_read(weld, NULL);
    for (uint32_t i = 0; i < COUNT; i++) {
        x[i][1] = i % 1000;
    }
    assert_int_equal(go_on(weld, x).joined, COUNT - 1000);
    assert_int_equal(to[123456], 456);
    memset(x, 0, COUNT * sizeof *x);
    assert_int_equal(go_on(weld, x).apart, 999); /* what was apart stays so */
    x[456][0] = 1;
    assert_int_equal(go_on(weld, x).joined, COUNT - 1001);
    assert_int_equal(to[123456], 1456);
    assert_int_equal(to[456], 456);
    pccd_weld_end(weld);
    free(x);
}

/* If it failed: two vertices that were too far apart would be one after both lay beside a
 * third one, which has gone; or two that never were would be parted with it. */
CASE(weld__joins_none_that_were_too_far_apart)
{
    for (int is_near = 0; is_near < 2; is_near++) {
        const double way = is_near ? .25 : .75;
        const double first[3][3] = {{0, 0, 0}, {way, 0, 0}, {-way, 0, 0}};
        const double then[3][3] = {{5, 0, 0}, {way, 0, 0}, {way, 0, 0}};
        struct pccd_weld *weld = begin(3, 1, false);
        assert_int_equal(go_on(weld, first).joined, 2);
        assert_int_equal(go_on(weld, then).joined, is_near);
        assert_int_equal(go_on(weld, then).joined, is_near);
        assert_int_equal(go_on(weld, first).joined, is_near);
        assert_int_equal(pccd_weld_read(weld, NULL)[2], is_near ? 1 : 2);
        pccd_weld_end(weld);
    }
}

/* If it failed: the search in cells would miss pairs across their borders, or join what
 * is farther apart. */
CASE(weld__finds_what_comparing_all_finds)
{
    enum { COUNT = 600 };
    static double x[COUNT][3];
    static float narrow[COUNT][3];
    struct prng random = {prng_seed()};
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)random.state);
    for (int round = 0; round < 40; round++) {
        const double distances[4] = {0, 1, .25, 7};
        double distance = distances[round % 4];
        uint32_t joined = 0, expected[COUNT];
        struct pccd_weld_counts counts;
        for (int i = 0; i < COUNT * 3; i++) {
            double value = (double)prng_below(&random, 16) - 7;
            x[i / 3][i % 3] =
                round < 20 ? value : value + (double)prng_below(&random, 16) / 16;
            narrow[i / 3][i % 3] = (float)x[i / 3][i % 3];
        }
        for (uint32_t i = 0; i < COUNT; i++) {
            expected[i] = i;
            for (uint32_t j = 0; j < i && expected[i] == i; j++) {
                double sum = 0;
                for (int k = 0; k < 3; k++) {
                    sum += (x[i][k] - x[j][k]) * (x[i][k] - x[j][k]);
                }
                if (expected[j] == j && sum <= distance * distance) {
                    expected[i] = j;
                    joined++;
                }
            }
        }
        for (int is_double = 0; is_double < 2; is_double++) {
            struct pccd_weld *weld = begin(COUNT, distance, round % 3 == 0);
            const void *at = is_double ? (void *)x : (void *)narrow;
            enum pccd_format format = is_double ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32;
            assert_ok(pccd_weld_frame(weld, at, format));
            assert_memory_equal(pccd_weld_read(weld, &counts), expected, sizeof expected);
            assert_int_equal(counts.joined, joined);
            pccd_weld_end(weld);
        }
    }
}

/* If it failed: what is off by a rounding would be joined unasked, or nobody be told; or
 * vertices that nothing names count. */
CASE(weld__tells_what_is_nearly_at_one_place)
{
    double x[7][3] = {{0}, {1}, {1}, {1, 0x1p-50}, {-0.0, 0, -0.0}, {0}, {0, 1}};
    const uint32_t triangles[2][3] = {{0, 2, 6}, {4, 3, 5}}, edges[1][2] = {{5, 6}};
    const struct pccd_mesh_data mesh = {.vertex_count = 7,
                                        .triangles = triangles[0],
                                        .triangle_count = 2,
                                        .edges = edges[0],
                                        .edge_count = 1};
    struct pccd_weld *weld;
    struct pccd_weld_counts counts;
    assert_ok(pccd_weld_begin(&mesh, 0, true, &weld));
    counts = go_on(weld, x);
    assert_int_equal(counts.joined, 2); /* 4 and 5 to 0; 1 is not named */
    assert_int_equal(counts.more, 1);
    assert_true(counts.more_distance == 0x1p-40);
    assert_memory_equal(pccd_weld_read(weld, NULL), ((uint32_t[7]){0, 1, 2, 3, 0, 0, 6}),
                        28);
    x[5][0] = 0x1p-50;
    x[3][1] = 2;
    counts = go_on(weld, x);
    assert_int_equal(counts.joined, 1);
    assert_int_equal(counts.apart, 1);
    assert_int_equal(counts.more, 1);
    assert_int_equal(pccd_weld_read(weld, NULL)[5], 5);
    pccd_weld_end(weld);
    assert_ok(pccd_weld_begin(&mesh, 0x1p-40, true, &weld));
    counts = go_on(weld, x);
    assert_int_equal(counts.joined, 2);
    assert_int_equal(counts.more, 0);
    pccd_weld_end(weld);
}

/* If it failed: a program that computes otherwise (fesetround) would have other vertices
 * joined. */
CASE(weld__rounds_as_ever)
{
    const double x[2][3] = {{0}, {0x1.0000000000001p-1, 0, 0x1p-30}};
    for (int way = 0; way < 2; way++) {
        struct pccd_weld *weld = begin(2, 0.5000000000000001, false);
        assert_int_equal(fesetround(way == 0 ? FE_UPWARD : FE_TONEAREST), 0);
        uint32_t joined = go_on(weld, x).joined;
        assert_int_equal(fesetround(FE_TONEAREST), 0);
        assert_int_equal(joined, 1);
        pccd_weld_end(weld);
    }
}

/* If it failed: a wrong call would read what is not there, or somebody look for the
 * reason elsewhere. */
CASE(weld__says_what_is_wrong)
{
    static const double x[3][3] = {{0}, {1}, {2, NAN}};
    const uint32_t triangle[3] = {0, 1, 3};
    struct pccd_mesh_data mesh = {.vertex_count = 3};
    struct pccd_weld *weld = NULL;
    const double distances[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pccd_weld_begin(&mesh, distances[i], false, &weld),
                         PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(NULL), "distance"));
    }
    assert_int_equal(pccd_weld_begin(NULL, 0, false, &weld), PCCD_E_INVAL);
    assert_int_equal(pccd_weld_begin(&mesh, 0, false, NULL), PCCD_E_INVAL);
    mesh.triangle_count = 1;
    assert_int_equal(pccd_weld_begin(&mesh, 0, false, &weld), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(NULL), "triangles"));
    mesh.triangles = triangle;
    assert_int_equal(pccd_weld_begin(&mesh, 0, false, &weld), PCCD_E_INDEX);
    assert_string_equal(pccd_error_text(NULL), "the triangles name vertex 3 of 3");
    mesh.vertex_count = 0;
    assert_int_equal(pccd_weld_begin(&mesh, 0, false, &weld), PCCD_E_INVAL);
    assert_null(weld);
    weld = begin(3, 0, true);
    assert_int_equal(pccd_weld_frame(NULL, x, PCCD_FORMAT_F64), PCCD_E_INVAL);
    assert_int_equal(pccd_weld_frame(weld, NULL, PCCD_FORMAT_F64), PCCD_E_INVAL);
    assert_int_equal(pccd_weld_frame(weld, x, (enum pccd_format)7), PCCD_E_INVAL);
    assert_int_equal(pccd_weld_frame(weld, x, PCCD_FORMAT_F64), PCCD_E_NOTFINITE);
    assert_non_null(strstr(pccd_error_text(NULL), "vertex 2: "));
    assert_null(pccd_weld_read(weld, NULL));
    assert_null(pccd_weld_read(NULL, NULL));
    pccd_weld_end(weld);
    pccd_weld_end(NULL);
}

/* If it failed: a large mesh would take minutes. Ten million vertices take seconds, so
 * that a tenth of them has a hundred times as long as it needs. */
CASE(weld__takes_seconds_for_millions)
{
    enum { COUNT = 1000000 };
    float(*x)[3] = test_room(COUNT * sizeof *x);
    struct prng random = {prng_seed()};
    for (uint32_t i = 0; i < COUNT; i++) { /* each place twice, two for others nearby */
        for (int k = 0; k < 3; k++) {
            x[i][k] = i % 2 == 0 ? (float)prng_below(&random, 1u << 20) : x[i - 1][k];
        }
    }
    for (int way = 0; way < 3; way++) {
        struct pccd_weld *weld = begin(COUNT, way == 2 ? 3e4 : 0, way == 1);
        struct pccd_weld_counts counts;
        clock_t start = clock();
        assert_ok(pccd_weld_frame(weld, x, PCCD_FORMAT_F32));
        double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        (void)pccd_weld_read(weld, &counts);
        print_message("%d vertices, %u joined: %.2f s\n", COUNT, counts.joined, seconds);
        assert_true(counts.joined >= COUNT / 2 && seconds < 60);
        pccd_weld_end(weld);
    }
    free(x);
}
