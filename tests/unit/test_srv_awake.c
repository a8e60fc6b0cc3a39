/* test_srv_awake.c - a loop that stays awake while its client asks at once. */
#include "watch.h"

#include <string.h>

#include "cases.h"

struct fixture {
    uv_loop_t loop;
    struct srv_service service;
    struct srv_awake awake;
};

static int setup(void **state)
{
    static struct fixture fixture;
    memset(&fixture, 0, sizeof fixture);
    *state = &fixture;
    fixture.service.metrics.counters.processors = 2;
    assert_int_equal(uv_loop_init(&fixture.loop), 0);
    srv_awake_init(&fixture.awake, &fixture.loop, &fixture.service);
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    uv_close((uv_handle_t *)&f->awake.idle, NULL);
    (void)uv_run(&f->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&f->loop), 0);
    return 0;
}

/* Return whether it stays awake after a wait before which the loop has stepped. */
static bool stays(struct fixture *f)
{
    f->service.metrics.counters.steps_brief++;
    srv_awake_before_wait(&f->awake);
    return uv_is_active((uv_handle_t *)&f->awake.idle);
}

/* Look until it ends by itself. */
static void wait_in_vain(struct fixture *f)
{
    while (uv_is_active((uv_handle_t *)&f->awake.idle)) {
        (void)uv_run(&f->loop, UV_RUN_NOWAIT);
    }
}

/* If it failed: a client that asks at once would wait for a processor to wake. */
CASE_WITH(awake__goes_on_while_messages_come, setup, teardown)
{
    struct fixture *f = *state;
    for (int i = 0; i < 100; i++) {
        assert_true(stays(f));
        f->service.metrics.counters.messages++;
        (void)uv_run(&f->loop, UV_RUN_NOWAIT);
        assert_false(uv_is_active((uv_handle_t *)&f->awake.idle));
    }
}

/* If it failed: a client that asks now and then would have a processor for it. */
CASE_WITH(awake__is_seldom_where_nothing_comes, setup, teardown)
{
    struct fixture *f = *state;
    uint32_t between = 0;
    uint32_t asleep = 0;
    for (int i = 0; i < 12; i++) {
        for (asleep = 0; !stays(f); asleep++) {
            assert_true(asleep <= 256);
        }
        assert_true(asleep >= between);
        between = asleep;
        wait_in_vain(f);
    }
    assert_int_equal(between, 256);
    while (!stays(f)) {
        ;
    }
    f->service.metrics.counters.messages++;
    (void)uv_run(&f->loop, UV_RUN_NOWAIT);
    assert_true(stays(f)); /* it was not in vain */
    wait_in_vain(f);
}

/* If it failed: it would keep others from the only processor, or the daemon from its
 * end. */
CASE_WITH(awake__is_not_for_all, setup, teardown)
{
    struct fixture *f = *state;
    srv_awake_before_wait(&f->awake); /* nothing was stepped */
    assert_false(uv_is_active((uv_handle_t *)&f->awake.idle));
    f->service.phase = SRV_PHASE_DRAINING;
    assert_false(stays(f));
    f->service.phase = SRV_PHASE_RUNNING;
    f->service.metrics.counters.processors = 1;
    assert_false(stays(f));
}
