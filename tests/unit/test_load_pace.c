/* test_load_pace.c - whether the load harness asks and counts as it says. */
#include "actor.h"
#include "cases.h"
#include "tally.h"

#define VALUES 20000u

static int compare(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Return a number of any octave from 1 ns to a minute. */
static uint64_t draw(uint64_t i)
{
    return (uint64_t)exp2(36 * load_unit(load_mix(7, i)));
}

/* If it failed, percentiles would be told that no request had. */
CASE(hist__has_the_quantiles_of_sorted_values_to_a_percent)
{
    static const double shares[] = {0.01, 0.5, 0.9, 0.99, 0.999, 0.9999, 1};
    static uint64_t values[VALUES];
    struct load_hist *hist = test_room(sizeof *hist);
    for (uint32_t i = 0; i < VALUES; i++) {
        values[i] = draw(i);
        load_hist_add(hist, values[i]);
    }
    qsort(values, VALUES, sizeof values[0], compare);
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        uint64_t exact = values[(size_t)ceil(shares[i] * VALUES) - 1];
        uint64_t told = load_hist_quantile(hist, shares[i]);
        assert_in_range(told, exact, exact + exact / 100 + 1);
    }
    assert_int_equal(load_hist_quantile(hist, 1), values[VALUES - 1]);
    assert_int_equal(hist->longest_ns, values[VALUES - 1]);
    memset(hist, 0, sizeof *hist);
    assert_int_equal(load_hist_quantile(hist, 0.5), 0);
    free(hist);
}

/* If it failed, a time beyond all bins would be written beside them. */
CASE(hist__takes_any_time)
{
    struct load_hist *hist = test_room(sizeof *hist);
    load_hist_add(hist, 0);
    load_hist_add(hist, UINT64_MAX);
    load_hist_add(hist, 1ull << 40);
    assert_int_equal(hist->count, 3);
    assert_int_equal(load_hist_quantile(hist, 0.1), 0);
    assert_int_equal(hist->longest_ns, UINT64_MAX);
    free(hist);
}

/* If it failed, processes would not add up, or seconds not be told apart. */
CASE(hist__parts_add_up_and_come_apart)
{
    struct load_hist *h = test_room(4 * sizeof *h);
    for (uint32_t i = 0; i < VALUES; i++) {
        load_hist_add(&h[i % 2], draw(i));
        load_hist_add(&h[2], draw(i));
    }
    load_hist_since(&h[2], &h[0], &h[3]); /* what is not in the one is in the other */
    assert_memory_equal(h[3].bins, h[1].bins, sizeof h[3].bins);
    assert_int_equal(h[3].count, VALUES / 2);
    uint64_t half = load_hist_quantile(&h[3], 0.5);
    assert_in_range(load_hist_above(&h[3], half), VALUES / 4 - 60, VALUES / 4);
    load_hist_merge(&h[0], &h[1]);
    assert_memory_equal(&h[0], &h[2], sizeof h[0]);
    free(h);
}

/* ---- plans ----------------------------------------------------------------------- */

static struct load make_load(double hz)
{
    static struct load_shared shared;
    atomic_store(&shared.go_ns, 1000000000u);
    return (struct load){.settings = {.seed = 1, .clients = 4, .hz = hz},
                         .shared = &shared};
}

/* If it failed, a slow daemon would be asked less often, or all clients at once. */
CASE(pace__open_loop_knows_nothing_of_answers)
{
    struct load load = make_load(50);
    for (uint32_t client = 0; client < 4; client++) {
        struct load_pace pace;
        load_pace_begin(&pace, &load, client);
        uint64_t first_ns = 1000000000u + client * 5000000u; /* spread over 20 ms */
        assert_int_equal(pace.due_ns, first_ns);
        for (uint64_t i = 1; i <= 1000; i++) {
            load_pace_next(&pace, &load,
                           first_ns + 77777777u * i); /* whenever that was */
            assert_int_equal(pace.due_ns, first_ns + i * 20000000u);
        }
    }
}

/* If it failed, random arrivals would have another rate than was asked, or be even. */
CASE(pace__random_arrivals_have_the_rate)
{
    struct load load = make_load(100);
    struct load_pace pace;
    double squares = 0;
    load.settings.poisson = true;
    load_pace_begin(&pace, &load, 2);
    uint64_t first_ns = pace.due_ns;
    for (uint32_t i = 0; i < 10000; i++) {
        uint64_t last_ns = pace.due_ns;
        load_pace_next(&pace, &load, 0);
        double ms = 1e-6 * (double)(pace.due_ns - last_ns);
        squares += ms * ms;
    }
    double mean_ms = 1e-10 * (double)(pace.due_ns - first_ns);
    assert_true(mean_ms > 9.6 && mean_ms < 10.4);
    assert_true(squares / 10000 > 180 &&
                squares / 10000 < 220); /* 2 x the mean's square */
}

/* If it failed, all clients would join at once, or latencies of joining would count. */
CASE(pace__clients_join_over_the_ramp)
{
    struct load load = make_load(0);
    struct load_pace pace;
    load.settings.ramp_s = 8;
    load.settings.warm_up_s = 2;
    load_pace_begin(&pace, &load, 0);
    assert_int_equal(pace.due_ns, 1000000000u);
    load_pace_begin(&pace, &load, 3);
    assert_int_equal(pace.due_ns, 7000000000u);
    assert_int_equal(load_measured_from_ns(&load), 11000000000u);
}

/* If it failed, a closed loop would not think, or think without being asked to. */
CASE(pace__closed_loop_thinks_from_the_last_request)
{
    struct load load = make_load(0);
    struct load_pace pace;
    load_pace_begin(&pace, &load, 1);
    load_pace_next(&pace, &load, 5000000000u);
    assert_int_equal(pace.due_ns, 1000000000u);
    load.settings.think_ms = 10;
    for (uint32_t i = 0; i < 100; i++) {
        load_pace_next(&pace, &load, 5000000000u);
        assert_in_range(pace.due_ns, 5005000000u, 5015000000u);
    }
}

/* If it failed, a planted stall would not be there, or be everywhere. */
CASE(pace__stalls_in_the_share_that_was_asked)
{
    struct load load = make_load(0);
    struct load_pace pace;
    uint32_t stalls = 0;
    load.settings.stall_share = 0.1;
    load.settings.stall_ms = 200;
    load_pace_begin(&pace, &load, 1);
    for (uint32_t i = 0; i < 10000; i++) {
        uint64_t stall_ns = load_pace_stall_ns(&pace, &load);
        assert_true(stall_ns == 0 || stall_ns == 200000000u);
        stalls += stall_ns > 0;
        load_pace_next(&pace, &load, 0);
    }
    assert_in_range(stalls, 850, 1150);
}

/* ---- scenes ---------------------------------------------------------------------- */

/* If it failed, another load would be made than was asked. */
CASE(size__reads_lists_with_weights_and_ranges)
{
    static const char *const wrong[] = {
        "",     "k",     "0",     "5..2",    "1k:",   "1k,",  ",1k",
        "1k:0", "1k:-1", "2000k", "1..2..3", "1k 2k", "1k:x", "..5"};
    struct load_sizes sizes = {0};
    assert_true(load_sizes_parse(&sizes, "200..5k:3,1.5k"));
    assert_int_equal(sizes.count, 2);
    assert_int_equal(sizes.parts[0].low, 200);
    assert_int_equal(sizes.parts[0].high, 5000);
    assert_true(sizes.parts[0].weight == 3 && sizes.parts[1].weight == 1);
    assert_int_equal(sizes.parts[1].low, 1500);
    assert_int_equal(load_sizes_largest(&sizes), 5000);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_false(load_sizes_parse(&sizes, wrong[i]));
    }
    assert_int_equal(sizes.count, 2); /* as it was */
}

/* If it failed, large scenes would be as many as small ones of a range are rare. */
CASE(size__draws_by_weight_and_by_octave)
{
    struct load_sizes sizes;
    uint32_t single = 0;
    uint32_t below = 0;
    assert_true(load_sizes_parse(&sizes, "100..10000:3,50:1"));
    for (uint32_t i = 0; i < 8000; i++) {
        uint32_t size = load_sizes_draw(&sizes, load_mix(3, i));
        assert_true(size == 50 || (size >= 100 && size <= 10000));
        single += size == 50;
        below += size >= 100 && size < 1000;
    }
    assert_in_range(single, 1850, 2150);
    assert_in_range(below, 2800, 3200); /* half of the three quarters */
}

/* If two clients sent the same, an answer that went to the wrong one would be right. */
CASE(shape__is_different_for_every_client_and_position)
{
    double x[2][25][3];
    struct load_shape shape = {.seed = 1, .client = 7, .side = 4};
    for (int scene = 0; scene < LOAD_SCENE_COUNT; scene++) {
        shape = (struct load_shape){
            .seed = 1, .client = 7, .side = 4, .scene = (enum load_scene)scene};
        assert_int_equal(load_sheet_vertices(&shape), 25);
        load_sheet_at(&shape, 0, PCCD_FORMAT_F64, x[0]);
        load_sheet_at(&shape, 0, PCCD_FORMAT_F64, x[1]);
        assert_memory_equal(x[0], x[1], sizeof x[0]);
        shape.client = 8;
        load_sheet_at(&shape, 0, PCCD_FORMAT_F64, x[1]);
        assert_memory_not_equal(x[0], x[1], sizeof x[0]);
        shape.client = 7;
        load_sheet_at(&shape, 1, PCCD_FORMAT_F64, x[1]);
        assert_memory_not_equal(x[0], x[1], sizeof x[0]);
        shape.seed = 2;
        load_sheet_at(&shape, 0, PCCD_FORMAT_F64, x[1]);
        assert_memory_not_equal(x[0], x[1], sizeof x[0]);
    }
}

/* If it failed, scenes would have another size than was asked. */
CASE(shape__has_about_the_triangles_that_were_asked)
{
    static const uint32_t asked[] = {40, 1000, 20000, 1000000};
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        struct load_shape shape = {.side = load_sheet_side(asked[i])};
        uint32_t made = load_sheet_triangle_count(&shape) + LOAD_FLOOR_TRIANGLES;
        assert_in_range(made, asked[i] - asked[i] / 20, asked[i] + asked[i] / 20);
        assert_true(shape.side <= LOAD_SIDE_MAX);
    }
    assert_int_equal(load_sheet_side(40), 4);
    assert_int_equal(load_sheet_side(1), 1);
}
