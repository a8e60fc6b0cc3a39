/* test_srv_handles.c - handles with generations. */
#include "cases.h"
#include "handles.h"
#include "pccd_types.h"

static char items[64];

/* With the slots that it needs. */
static int add(struct srv_handles *handles, void *item, uint32_t want, uint32_t *handle)
{
    uint32_t count = srv_handles_needs(handles, want);
    if (count > handles->capacity) {
        struct srv_handle_slot *slots = test_room(count * sizeof *slots);
        free(srv_handles_move(handles, slots, count));
    }
    return srv_handles_add(handles, item, want, handle);
}

/* A handle that leads elsewhere would let a client change another object than it
 * named. */
CASE(handles__get_returns_what_was_added)
{
    struct srv_handles handles;
    uint32_t handle[64];
    srv_handles_init(&handles, 64, 0);
    for (int i = 0; i < 64; i++) {
        assert_int_equal(add(&handles, &items[i], 0, &handle[i]), 0);
        assert_int_not_equal(handle[i], 0);
    }
    for (int i = 0; i < 64; i++) {
        assert_ptr_equal(srv_handles_get(&handles, handle[i]), &items[i]);
    }
    assert_int_equal(handles.count, 64);
    free(srv_handles_deinit(&handles));
}

/* Numbers from nowhere must not lead anywhere, 0 least of all. */
CASE(handles__unknown_handles_are_null)
{
    struct srv_handles handles;
    uint32_t handle = 0;
    srv_handles_init(&handles, 64, 0);
    assert_null(srv_handles_get(&handles, 0));
    assert_int_equal(add(&handles, items, 0, &handle), 0);
    assert_null(srv_handles_get(&handles, 0));
    assert_null(srv_handles_get(&handles, handle + 1));
    assert_null(srv_handles_get(&handles, handle + (1u << SRV_HANDLE_INDEX_BITS)));
    assert_null(srv_handles_get(&handles, UINT32_MAX));
    assert_null(srv_handles_remove(&handles, handle + 1));
    assert_int_equal(handles.count, 1);
    free(srv_handles_deinit(&handles));
}

/* A removed handle must stay dead when its index is used again, until 4095 reuses
 * later. */
CASE(handles__removed_handle_stays_stale_through_4094_reuses)
{
    struct srv_handles handles;
    uint32_t first = 0;
    srv_handles_init(&handles, 1, 7);
    assert_int_equal(add(&handles, items, 0, &first), 0);
    assert_ptr_equal(srv_handles_remove(&handles, first), items);
    assert_null(srv_handles_get(&handles, first));
    assert_null(srv_handles_remove(&handles, first));
    for (uint32_t reuse = 1; reuse < SRV_HANDLE_GENERATION_MAX; reuse++) {
        uint32_t handle = 0;
        assert_int_equal(add(&handles, items + 1, 0, &handle), 0);
        assert_int_not_equal(handle, first);
        assert_int_not_equal(handle >> SRV_HANDLE_INDEX_BITS, 0);
        assert_null(srv_handles_get(&handles, first));
        assert_ptr_equal(srv_handles_remove(&handles, handle), items + 1);
    }
    uint32_t wrapped = 0;
    assert_int_equal(add(&handles, items, 0, &wrapped), 0);
    assert_int_equal(wrapped, first);
    free(srv_handles_deinit(&handles));
}

/* Reusing the newest free index first would wear out its generations 1000 times as
 * fast. */
CASE(handles__free_indices_are_reused_in_turn)
{
    struct srv_handles handles;
    uint32_t handle[3];
    srv_handles_init(&handles, 64, 0);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(add(&handles, &items[i], 0, &handle[i]), 0);
    }
    static const int order[] = {1, 0, 2};
    for (int i = 0; i < 3; i++) {
        srv_handles_remove(&handles, handle[order[i]]);
    }
    for (int i = 0; i < 3; i++) {
        uint32_t again = 0;
        assert_int_equal(add(&handles, &items[i], 0, &again), 0);
        assert_int_equal(srv_handle_index(again), srv_handle_index(handle[order[i]]));
        assert_int_not_equal(again, handle[order[i]]);
    }
    free(srv_handles_deinit(&handles));
}

/* Without a bound a client could fill the memory; after removal there must be room
 * again. */
CASE(handles__exhaustion_is_a_limit_and_passes)
{
    struct srv_handles handles;
    uint32_t handle[20];
    uint32_t more = 77;
    srv_handles_init(&handles, 20, 0);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(add(&handles, &items[i], 0, &handle[i]), 0);
    }
    assert_int_equal(add(&handles, items, 0, &more), PCCD_E_LIMIT);
    assert_int_equal(more, 77);
    assert_ptr_equal(srv_handles_remove(&handles, handle[13]), &items[13]);
    assert_int_equal(add(&handles, items, 0, &more), 0);
    assert_int_equal(srv_handle_index(more), srv_handle_index(handle[13]));
    assert_int_equal(add(&handles, items, 0, &more), PCCD_E_LIMIT);
    free(srv_handles_deinit(&handles));
}

/* Two scenes of one session whose object handles are alike would hide a mix-up. */
CASE(handles__tables_with_other_salt_share_no_handles)
{
    struct srv_handles a;
    struct srv_handles b;
    uint32_t handle = 0;
    srv_handles_init(&a, 64, 4);
    srv_handles_init(&b, 64, 5);
    for (int i = 0; i < 10; i++) {
        uint32_t other = 0;
        assert_int_equal(add(&a, &items[i], 0, &handle), 0);
        assert_int_equal(add(&b, &items[i], 0, &other), 0);
        assert_null(srv_handles_get(&b, handle));
        assert_null(srv_handles_get(&a, other));
    }
    free(srv_handles_deinit(&a));
    free(srv_handles_deinit(&b));
}

/* A session that ends must find everything it has exactly once. */
CASE(handles__next_and_pop_yield_every_item_once)
{
    struct srv_handles handles;
    uint32_t handle[40];
    srv_handles_init(&handles, 64, 0);
    for (int i = 0; i < 40; i++) {
        assert_int_equal(add(&handles, &items[i], 0, &handle[i]), 0);
    }
    for (int i = 0; i < 40; i += 3) {
        srv_handles_remove(&handles, handle[i]);
    }
    uint32_t cursor = 0;
    int seen = 0;
    for (char *item; (item = srv_handles_next(&handles, &cursor)) != NULL; seen++) {
        assert_int_not_equal((item - items) % 3, 0);
    }
    assert_int_equal(seen, 26);
    assert_int_equal(handles.count, 26);
    cursor = 0;
    seen = 0;
    for (char *item; (item = srv_handles_pop(&handles, &cursor)) != NULL; seen++) {
        assert_int_not_equal((item - items) % 3, 0);
    }
    assert_int_equal(seen, 26);
    assert_int_equal(handles.count, 0);
    free(srv_handles_deinit(&handles));
}

/* If it failed, what a daemon that died had could not be made again under its handles. */
CASE(handles__wanted_ones_can_be_had)
{
    struct srv_handles handles;
    uint32_t handle = 0;
    const uint32_t fifth = 3u << SRV_HANDLE_INDEX_BITS | 5u;
    const uint32_t second = 7u << SRV_HANDLE_INDEX_BITS | 2u;
    srv_handles_init(&handles, 64, 0);
    assert_int_equal(add(&handles, items, 5u, &handle),
                     PCCD_E_HANDLE); /* no generation */
    assert_int_equal(add(&handles, items, fifth + 64, &handle),
                     PCCD_E_HANDLE); /* beyond the table */
    assert_int_equal(handles.count, 0);
    assert_int_equal(handles.capacity, 0);
    assert_int_equal(add(&handles, items, fifth, &handle), 0);
    assert_int_equal(handle, fifth);
    assert_ptr_equal(srv_handles_get(&handles, fifth), items);
    assert_int_equal(add(&handles, items, fifth, &handle), PCCD_E_HANDLE); /* taken */
    /* A place left empty, then the others in turn, then a new one. */
    assert_int_equal(add(&handles, items + 1, second, &handle), 0);
    assert_int_equal(handle, second);
    static const uint32_t order[] = {0, 1, 3, 4, 6};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(add(&handles, items, 0, &handle), 0);
        assert_int_equal(srv_handle_index(handle), order[i]);
    }
    assert_int_equal(handles.count, 7);
    free(srv_handles_deinit(&handles));
}
