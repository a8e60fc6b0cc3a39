/* test_int_standing.c - steps of which little moves, through everything that lies
 * between a client and the engine. */
#include "cases.h"

#include <signal.h>
#include <sys/socket.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"
#include "must.h"

#define SIDE   20u
#define COUNT  (SIDE * SIDE)
#define ROUNDS 48u

static const char *const supervised[] = {"--supervise",   "--threads", "1",
                                         "--crashes-max", "1000",      NULL};

struct world {
    struct test_daemon daemon;
    struct test_grid grid;
    struct pccd_client *client;
    struct pccd_client *other; /* of the same daemon: makes scenes for one step */
    float x0[COUNT][3];
    float x1[COUNT][3];
};

/* Ways to hand over the positions of a step. */
enum manner { PART, WHOLE, BOTH_ENDS, STILL, MANNERS };

/* Everything is where the last step ended; `count` vertices from `first` on go to
 * height z. */
static void move(struct world *world, uint32_t first, uint32_t count, float z)
{
    memcpy(world->x0, world->x1, sizeof world->x0);
    for (uint32_t i = first; i < first + count; i++) {
        world->x1[i][2] = z;
    }
}

/* Hand over what has moved, all of it vertices first .. first + count - 1. */
static uint64_t submit(struct world *world, enum manner manner, uint32_t first,
                       uint32_t count)
{
    struct pccd_frame frame;
    void *x0 = NULL;
    void *x1 = NULL;
    uint64_t step = 0;

    if (manner == STILL) {
        assert_ok(pccd_submit_still(world->client, world->grid.scene, NULL, &step));
        return step;
    }
    first = manner == WHOLE ? 0 : first;
    count = manner == WHOLE ? COUNT : count;
    assert_ok(pccd_frame_begin(world->client, world->grid.scene, 1, 2 * sizeof world->x1,
                               &frame));
    if (manner == BOTH_ENDS) {
        assert_ok(pccd_frame_x0x1(&frame, world->grid.object, PCCD_FORMAT_F32, first,
                                  count, &x0, &x1));
        memcpy(x0, world->x0[first], count * sizeof *world->x0);
    } else {
        assert_ok(pccd_frame_x1(&frame, world->grid.object, PCCD_FORMAT_F32, first, count,
                                &x1));
    }
    memcpy(x1, world->x1[first], count * sizeof *world->x1);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    return step;
}

/* The same step by a scene that is made for it. */
static void make_fresh(struct world *world, struct test_grid *fresh,
                       struct pccd_answer *answer)
{
    assert_ok(test_grid_make(world->other, SIDE, fresh));
    struct pccd_frame frame;
    void *x0 = NULL;
    void *x1 = NULL;
    uint64_t step = 0;

    assert_ok(
        pccd_frame_begin(world->other, fresh->scene, 1, 2 * sizeof world->x1, &frame));
    assert_ok(
        pccd_frame_x0x1(&frame, fresh->object, PCCD_FORMAT_F32, 0, COUNT, &x0, &x1));
    memcpy(x0, world->x0, sizeof world->x0);
    memcpy(x1, world->x1, sizeof world->x1);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(world->other, step, -1, answer));
}

/* Records but for the names of the objects, which come in the same order. */
static void check_same(const struct world *world, const struct pccd_answer *a,
                       const struct test_grid *fresh, const struct pccd_answer *b)
{
    assert_int_equal(a->incomplete, PCCD_COMPLETE);
    assert_int_equal(a->total, b->total);
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->initial, b->initial);
    assert_true(a->toi_first == b->toi_first);
    for (uint64_t i = 0; i < a->count; i++) {
        struct pccd_contact contact = b->contacts[i];
        uint32_t *names[2] = {&contact.object_a, &contact.object_b};

        for (int k = 0; k < 2; k++) {
            *names[k] =
                *names[k] == fresh->object ? world->grid.object : world->grid.floor;
        }
        assert_memory_equal(&a->contacts[i], &contact, sizeof contact);
    }
}

static void check_step(struct world *world, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer wanted = PCCD_ANSWER_INIT;
    struct test_grid fresh;

    assert_ok(pccd_wait(world->client, step, -1, &answer));
    make_fresh(world, &fresh, &wanted);
    check_same(world, &answer, &fresh, &wanted);
    pccd_answer_release(world->client, &answer);
    pccd_answer_release(world->other, &wanted);
    assert_ok(pccd_scene_destroy(world->other, fresh.scene));
    test_grid_free(&fresh);
}

static void begin(struct world *world)
{
    memset(world, 0, sizeof *world);
    assert_true(test_daemon_start(&world->daemon, supervised));
    world->client = test_client_at(world->daemon.url);
    world->other = test_client_at(world->daemon.url);
    assert_ok(test_grid_make(world->client, SIDE, &world->grid));
    memcpy(world->x1, world->grid.x, sizeof world->x1);
    move(world, 0, COUNT, 0); /* down to the floor, where it rests */
    check_step(world, submit(world, WHOLE, 0, COUNT));
    move(world, 0, 0, 0);
    check_step(world, submit(world, STILL, 0, 0));
}

static void end(struct world *world)
{
    test_grid_free(&world->grid);
    pccd_close(world->client);
    pccd_close(world->other);
    assert_true(test_daemon_finish(&world->daemon));
}

/* A round: a part, all of it or nothing moves, handed over in one of all manners. */
static uint64_t start_round(struct world *world, uint32_t round)
{
    enum manner manner = (enum manner)(round % MANNERS);
    bool stands = manner == STILL || round % 7 == 0;
    uint32_t first = round * 37 % (COUNT - 8);
    uint32_t count = 8;

    if (round % 11 == 10 && !stands) {
        first = 0;
        count = COUNT;
    }
    move(world, stands ? 0 : first, stands ? 0 : count, (float)(round % 3) * 0.5f - 0.5f);
    return submit(world, manner, first, count);
}

/* If it failed, a frame that hands over little, or what is there already, would be taken
 * for another motion. */
CASE(standing__is_the_same_by_every_kind_of_frame)
{
    static struct world world;

    begin(&world);
    for (uint32_t round = 0; round < ROUNDS; round++) {
        check_step(&world, start_round(&world, round));
    }
    end(&world);
}

/* If it failed, what a daemon kept of a scene would be asked of one that was started
 * since, and what stands would not be found. */
CASE(standing__is_found_by_the_next_daemon)
{
    static struct world world;

    begin(&world);
    for (uint32_t round = 0; round < ROUNDS / 2; round++) {
        pid_t worker = (pid_t)pccd_daemon_pid(world.client);
        if (round % 4 == 0) {
            assert_int_equal(kill(worker, SIGKILL), 0);
        }
        uint64_t step = start_round(&world, round);
        if (round % 4 == 2) {
            assert_int_equal(kill(worker, SIGKILL), 0);
        }
        check_step(&world, step);
    }
    end(&world);
}

/* If it failed, a session that goes on over another connection would have lost what it
 * was compared with, or a step of it. */
CASE(standing__goes_on_with_a_resumed_session)
{
    static struct world world;
    struct pccd_link_info info;

    begin(&world);
    for (uint32_t round = 0; round < ROUNDS / 2; round++) {
        if (round % 3 == 0) {
            assert_int_equal(shutdown(pccd_fd(world.client), SHUT_RDWR), 0);
        }
        uint64_t step = start_round(&world, round);
        if (round % 3 == 1) {
            assert_int_equal(shutdown(pccd_fd(world.client), SHUT_RDWR), 0);
        }
        check_step(&world, step);
    }
    assert_ok(pccd_link(world.client, &info));
    assert_true(info.resumed > 0);
    end(&world);
}

/* If it failed, nobody would see in an answer, or in what `pccdctl stats` prints, whether
 * what stands was left out. */
CASE(standing__is_counted_in_answers_and_totals)
{
    static const char *const names[] = {"still_features", "still_pairs", "kept_records"};
    static struct world world;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t before[3];

    begin(&world);
    for (uint32_t i = 0; i < 3; i++) {
        before[i] = test_stat(world.client, names[i]);
    }
    move(&world, COUNT / 2, 1, 0.25f);
    uint64_t step = submit(&world, PART, COUNT / 2, 1);
    assert_ok(pccd_wait(world.client, step, -1, &answer));
    assert_true(answer.counters.still_features > COUNT);
    assert_true(answer.counters.still_pairs > 0);
    assert_true(answer.counters.kept_records > 0);
    assert_true(answer.counters.kept_records < answer.total);
    const uint64_t counted[3] = {answer.counters.still_features,
                                 answer.counters.still_pairs,
                                 answer.counters.kept_records};
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(test_stat(world.client, names[i]), before[i] + counted[i]);
    }
    pccd_answer_release(world.client, &answer);
    end(&world);
}
