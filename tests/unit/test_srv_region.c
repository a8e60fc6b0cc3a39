/* test_srv_region.c - pages of the result region. */
#include "cases.h"
#include "pccd_types.h"
#include "ringio.h"

#define CAPACITY 4096u

static struct srv_page reserve(struct srv_region *region, uint64_t head,
                               uint32_t item_bytes, uint64_t wanted)
{
    struct srv_page page = {UINT64_MAX, UINT64_MAX, UINT64_MAX};
    assert_int_equal(srv_region_reserve(region, head, item_bytes, wanted, &page), 0);
    return page;
}

/* Pages that overlap would let one answer overwrite another before it is read. */
CASE(region__pages_follow_each_other)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    struct srv_page a = reserve(&region, 0, 20, 3);
    struct srv_page b = reserve(&region, 0, 64, 2);
    assert_int_equal(a.position, 0);
    assert_int_equal(a.count, 3);
    assert_int_equal(a.release, 64); /* 60 bytes, rounded to a cache line */
    assert_int_equal(b.position, 64);
    assert_int_equal(b.count, 2);
    assert_int_equal(b.release, 192);
}

/* A full region that did not say so would hand out memory the client still reads. */
CASE(region__full_region_gives_what_is_left_then_nothing)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    struct srv_page a = reserve(&region, 0, 64, 60);
    struct srv_page b = reserve(&region, 0, 64, 10);
    struct srv_page c = reserve(&region, 0, 64, 10);
    assert_int_equal(a.count, 60);
    assert_int_equal(b.count, 4);
    assert_int_equal(c.count, 0);
    assert_int_equal(c.release, b.release);
}

/* A page that wraps would make records straddle the end of the memory. */
CASE(region__page_moves_to_the_start_rather_than_wrap)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    struct srv_page a = reserve(&region, 0, 64, 60);
    /* 4 items fit at the end, 60 at the start. */
    struct srv_page b = reserve(&region, a.release, 64, 10);
    assert_int_equal(b.position, 0);
    assert_int_equal(b.count, 10);
    assert_int_equal(b.release, a.release + 640); /* an empty ring begins anywhere */
}

/* If only part fits in either stretch, the longer one saves round trips. */
CASE(region__longer_stretch_is_taken_when_neither_holds_all)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    struct srv_page a = reserve(&region, 0, 64, 10);
    reserve(&region, 0, 64, 20);                              /* up to item 30 */
    struct srv_page c = reserve(&region, a.release, 64, 100); /* 34 behind, 10 in front */
    assert_int_equal(c.position, 30 * 64);
    assert_int_equal(c.count, 34);
    struct srv_page d = reserve(&region, a.release, 64, 100);
    assert_int_equal(d.position, 0);
    assert_int_equal(d.count, 10);
    assert_int_equal(reserve(&region, a.release, 64, 1).count, 0);
}

/* An answer as large as the region could never be fetched if an empty region were cut in
 * two by where the last page ended. */
CASE(region__empty_region_holds_a_page_of_its_whole_size)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    uint64_t head = reserve(&region, 0, 64, 5).release;
    struct srv_page page = reserve(&region, head, 64, 64);
    assert_int_equal(page.position, 0);
    assert_int_equal(page.count, 64);
    assert_int_equal(reserve(&region, head, 64, 1).count, 0); /* nothing was released */
    page = reserve(&region, page.release, 64, 64);
    assert_int_equal(page.count, 64);
}

/* A head that is believed when it lies would free pages that were never handed out. */
CASE(region__impossible_heads_are_refused)
{
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    struct srv_page page;
    uint64_t first = reserve(&region, 0, 64, 5).release;
    uint64_t second = reserve(&region, first, 64, 5).release;
    assert_int_equal(srv_region_reserve(&region, 0, 64, 1, &page), PCCD_E_INVAL);
    assert_int_equal(srv_region_reserve(&region, second + 1, 64, 1, &page), PCCD_E_INVAL);
    assert_int_equal(srv_region_reserve(&region, UINT64_MAX, 64, 1, &page), PCCD_E_INVAL);
    assert_int_equal(reserve(&region, second, 64, 1).position, second); /* unharmed */
}

/* Over many turns no page may overlap one that has not been released, whatever the
 * sizes. */
CASE(region__random_pages_never_overlap_unreleased_ones)
{
    enum { LIVE_MAX = 8, ROUNDS = 20000 };
    static const uint32_t sizes[] = {8, 20, 64};
    struct {
        uint64_t begin, end, release;
    } live[LIVE_MAX];
    struct srv_region region;
    srv_region_init(&region, CAPACITY);
    uint64_t seed = 12345;
    uint64_t head = 0;
    uint64_t items = 0;
    int count = 0;
    for (int round = 0; round < ROUNDS; round++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        uint32_t bytes = sizes[(seed >> 33) % 3];
        struct srv_page page = reserve(&region, head, bytes, (seed >> 40) % 70);
        uint64_t end = page.position + page.count * bytes;
        assert_true(end <= CAPACITY);
        assert_int_equal(page.position % SRV_PAGE_ALIGN, 0);
        for (int i = 0; i < count && page.count > 0; i++) {
            assert_true(end <= live[i].begin || page.position >= live[i].end);
        }
        items += page.count;
        if (page.count > 0) {
            live[count].begin = page.position;
            live[count].end = end;
            live[count++].release = page.release;
        }
        int released =
            count == LIVE_MAX || page.count == 0 ? 1 + (int)(seed >> 60) % 4 : 0;
        for (; released > 0 && count > 0; released--) {
            head = live[0].release;
            for (int i = 1; i < count; i++) {
                live[i - 1] = live[i];
            }
            count--;
        }
    }
    assert_true(items > ROUNDS); /* the loop has not been refused all the time */
}

/* Answers that are taken one by one would walk through the whole ring, and take all of
 * its memory, however small they are. */
CASE(region__sparse_ring_stays_where_it_has_memory)
{
    struct srv_region region;
    struct srv_page page = {0};
    uint64_t head = 0;
    srv_region_init_sparse(&region, CAPACITY, 1024);
    for (int i = 0; i < 100; i++) { /* each is released before the next */
        assert_int_equal(srv_region_reserve(&region, head, 64, 10, &page), 0);
        assert_int_equal(page.count, 10);
        assert_true(page.position + 640 <= 1024);
        head = page.release;
    }
    srv_region_init_sparse(&region, 64 * CAPACITY, 5 * CAPACITY);
    uint64_t last = head = 0;
    for (int i = 0; i < 10000; i++) { /* each is released when the next is there */
        assert_int_equal(srv_region_reserve(&region, head, 64, 1, &page), 0);
        assert_int_equal(page.count, 1);
        assert_true(page.position + 64 <= 5 * CAPACITY);
        head = last;
        last = page.release;
    }
}

/* If it failed, answers that wait in a ring which has little memory yet would cut later
 * ones. */
CASE(region__sparse_ring_holds_as_much_as_another)
{
    struct srv_region region;
    srv_region_init_sparse(&region, CAPACITY, 1024);
    uint64_t head = reserve(&region, 0, 64, 10).release;
    assert_int_equal(reserve(&region, head, 64, 30).count, 30); /* at the start again */
    assert_int_equal(reserve(&region, head, 64, 34).count, 34);
    assert_int_equal(reserve(&region, head, 64, 1).count, 0);
}

/* A ring that is refused memory must go on with what it has, and lose nothing. */
CASE(region__limited_ring_uses_what_it_has)
{
    struct srv_region region;
    srv_region_init_sparse(&region, CAPACITY, 1024);
    struct srv_page page = reserve(&region, 0, 64, 40); /* may take more */
    assert_int_equal(page.count, 40);
    uint64_t head = page.release;
    region.limit = 1024;
    page = reserve(&region, head, 64, 40);
    assert_int_equal(page.position, 0);
    assert_int_equal(page.count, 16);
    assert_int_equal(reserve(&region, head, 64, 1).count, 0);
    assert_int_equal(reserve(&region, page.release, 64, 40).count, 16);
}

/* If it failed, what pages still stand in would be given back, or the rest would not. */
CASE(region__knows_how_far_it_is_used)
{
    struct srv_region region;
    srv_region_init_sparse(&region, CAPACITY, 1024);
    assert_int_equal(srv_region_used(&region, 0), 0);
    uint64_t first = reserve(&region, 0, 64, 10).release;
    uint64_t second = reserve(&region, 0, 64, 20).release;
    assert_int_equal(srv_region_used(&region, 0), 30 * 64);
    assert_int_equal(srv_region_used(&region, first), 30 * 64);
    assert_int_equal(srv_region_used(&region, second), 0);
    assert_int_equal(srv_region_used(&region, second + 1), CAPACITY); /* a lie */
    uint64_t rest = reserve(&region, first, 64, 34).release;
    assert_int_equal(srv_region_used(&region, first), CAPACITY); /* to the very end */
    uint64_t again = reserve(&region, second, 64, 5).release;
    assert_int_equal(srv_region_used(&region, second), CAPACITY); /* around it */
    assert_int_equal(srv_region_used(&region, rest), 5 * 64);
    assert_int_equal(srv_region_used(&region, again), 0);
    assert_int_equal(srv_region_used(&region, 0), CAPACITY); /* it went backwards */
}
