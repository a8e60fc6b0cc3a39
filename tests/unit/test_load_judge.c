/* test_load_judge.c - whether the load harness would notice. */
#include "actor.h"
#include "cases.h"
#include "watch.h"

#define CLIENTS 5u
#define RECORDS 3u

struct fixture {
    struct load load;
    struct load_tally tally;
    struct load_actor actor;
    struct pccd_contact contacts[RECORDS];
    struct pccd_answer answer;
};

/* An answer to a step of client `number` from a position, as it was for that client
 * alone. */
static void make_answer(struct fixture *f, uint32_t number, uint32_t from)
{
    memset(f->contacts, 0, sizeof f->contacts);
    for (uint32_t i = 0; i < RECORDS; i++) {
        f->contacts[i].feature_a = number;
        f->contacts[i].feature_b = i;
        f->contacts[i].toi = 0.125 * from;
    }
    f->answer = (struct pccd_answer){.step = from + 1,
                                     .contacts = f->contacts,
                                     .count = RECORDS,
                                     .total = RECORDS,
                                     .hash = {number, from}};
}

/* The actor `number` waits for the answer to a step from that position. */
static void wait_for(struct fixture *f, uint32_t number, uint32_t from)
{
    f->actor = (struct load_actor){.load = &f->load,
                                   .tally = &f->tally,
                                   .number = number,
                                   .last_step = from + 1,
                                   .pending = {{.step = from + 1, .from = from}},
                                   .pending_count = 1};
}

static int set_up(void **state)
{
    struct fixture *f = test_room(sizeof *f);
    f->load.settings.clients = CLIENTS;
    f->load.shared =
        calloc(1, sizeof *f->load.shared + CLIENTS * LOAD_ORDERS * LOAD_FRAMES *
                                               sizeof f->load.shared->truth[0]);
    assert_non_null(f->load.shared);
    for (uint32_t i = 0; i < CLIENTS * LOAD_FRAMES; i++) {
        make_answer(f, i / LOAD_FRAMES, i % LOAD_FRAMES);
        wait_for(f, i / LOAD_FRAMES, i % LOAD_FRAMES);
        f->actor.is_alone = true;
        load_judge(&f->actor, &f->answer);
    }
    memset(&f->tally, 0, sizeof f->tally);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    free(f->load.shared);
    free(f);
    return 0;
}

/* If a right answer were called wrong, the harness would cry wolf. */
CASE_WITH(judge__takes_what_a_lone_client_got, set_up, tear_down)
{
    struct fixture *f = *state;
    wait_for(f, 3, 2);
    make_answer(f, 3, 2);
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.answered, 1);
    assert_int_equal(f->tally.records, RECORDS);
    assert_int_equal(f->tally.wrong + f->tally.crossed + f->tally.doubled, 0);
    assert_int_equal(f->actor.pending_count, 0);
}

/* If this failed, a spoilt record behind a right hash would go unnoticed. */
CASE_WITH(judge__finds_one_bit_that_is_wrong, set_up, tear_down)
{
    struct fixture *f = *state;
    wait_for(f, 3, 2);
    make_answer(f, 3, 2);
    f->contacts[RECORDS - 1].flags ^= 1;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.wrong, 1);
    wait_for(f, 3, 2);
    make_answer(f, 3, 2);
    f->answer.hash[1] ^= 1u << 31;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.wrong, 2);
}

/* If this failed, answers could go to others, or come again, and all would seem well. */
CASE_WITH(judge__finds_answers_of_others_and_second_ones, set_up, tear_down)
{
    struct fixture *f = *state;
    wait_for(f, 3, 2);
    make_answer(f, 4, 2); /* another client's */
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.crossed, 1);
    make_answer(f, 3, 2); /* once more */
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.doubled, 1);
    f->answer.step = 99; /* to nothing that was asked */
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.crossed, 2);
    assert_int_equal(f->tally.answered, 1);
}

/* If this failed, objects that were made anew would look like wrong answers: which has
 * the smaller number decides which of two edges comes first. */
CASE_WITH(judge__knows_both_orders_of_the_objects, set_up, tear_down)
{
    struct fixture *f = *state;
    make_answer(f, 3, 2);
    f->contacts[0].feature_a = 77; /* that differs */
    for (int alone = 1; alone >= 0; alone--) {
        wait_for(f, 3, 2);
        f->actor.floor = 2;
        f->actor.sheet = 1;
        f->actor.is_alone = alone;
        load_judge(&f->actor, &f->answer);
    }
    assert_int_equal(f->tally.wrong + f->tally.crossed, 0);
    wait_for(f, 3, 2); /* but not of the other order */
    f->actor.floor = 1;
    f->actor.sheet = 2;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.crossed, 1);
}

/* If this failed, a step that was refused or ended early without a reason would pass for
 * one that was meant to. */
CASE_WITH(judge__tells_errors_that_were_asked_for, set_up, tear_down)
{
    struct fixture *f = *state;
    wait_for(f, 3, 2);
    make_answer(f, 3, 2);
    f->answer.status = PCCD_E_NOTFINITE;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.failed, 1);
    wait_for(f, 3, 2);
    f->actor.pending[0].mischief = LOAD_NOT_FINITE;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.refused, 1);
    wait_for(f, 3, 2);
    make_answer(f, 3, 2);
    f->answer.incomplete = PCCD_INCOMPLETE_DEADLINE;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.failed, 2);
    wait_for(f, 3, 2);
    f->actor.pending[0].mischief = LOAD_DUE;
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.cancelled, 1);
}

/* If this failed, a client that is held up would ask less often, and the wait of what it
 * did not ask would be nobody's: coordinated omission. */
CASE_WITH(judge__counts_from_when_a_request_was_due, set_up, tear_down)
{
    struct fixture *f = *state;
    uint64_t now_ns = common_now_ns();
    f->load.settings.hz = 60;
    f->load.settings.deadline_ms = 20;
    wait_for(f, 3, 2);
    f->actor.pending[0].due_ns = now_ns - 50000000;
    f->actor.pending[0].sent_ns = now_ns - 1000000;
    make_answer(f, 3, 2);
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.measured, 1);
    assert_int_equal(f->tally.late, 1);
    assert_int_equal(f->tally.missed, 1);
    assert_true(f->tally.latency.longest_ns >= 50000000);
    f->load.settings.hz = 0; /* the closed loop: from when it was submitted */
    f->load.settings.deadline_ms = 0;
    wait_for(f, 3, 2);
    f->actor.pending[0].sent_ns = common_now_ns();
    make_answer(f, 3, 2);
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.measured, 2);
    assert_int_equal(f->tally.late, 1);
}

/* If this failed, what is slow at the beginning would be taken for what is slow. */
CASE_WITH(judge__leaves_the_warm_up_out, set_up, tear_down)
{
    struct fixture *f = *state;
    uint64_t now_ns = common_now_ns();
    f->load.settings.warm_up_s = 10;
    atomic_store(&f->load.shared->go_ns, now_ns - 5000000000ull);
    wait_for(f, 3, 2);
    f->actor.pending[0].sent_ns = now_ns;
    make_answer(f, 3, 2);
    load_judge(&f->actor, &f->answer);
    assert_int_equal(f->tally.answered, 1);
    assert_int_equal(f->tally.measured, 0);
    assert_int_equal(f->tally.latency.count, 0);
}

/* 300 samples of three workers: each begins elsewhere, and takes what it needs in its
 * first ten seconds. */
static void make_series(struct load_sample *samples, double per_s)
{
    for (uint32_t i = 0; i < 300; i++) {
        uint32_t age = i % 100;
        samples[i] = (struct load_sample){.at_s = i, .pid = 10 + (int)(i / 100)};
        samples[i].value[LOAD_MEMORY] = 5000 + 900 * (i / 100) + per_s * age +
                                        (age < 10 ? -40.0 * (10 - age) : 0) +
                                        (i % 7 == 3 ? 6 : 0);
    }
}

/* If this failed, a leak would look like noise, or every restart like a leak. */
CASE_WITH(watch__fits_a_slope_through_every_worker, set_up, tear_down)
{
    static struct load_sample samples[300];
    make_series(samples, 0);
    struct load_slope slope = load_slope_of(samples, 300, LOAD_MEMORY, 10);
    assert_int_equal(slope.count, 270);
    assert_true(slope.per_min < 3 * slope.error && slope.per_min > -3 * slope.error);
    make_series(samples, 0.5);
    slope = load_slope_of(samples, 300, LOAD_MEMORY, 10);
    assert_true(slope.per_min > 29 && slope.per_min < 31);
    assert_true(slope.error < 1);
}

/* Eight minutes of one worker, with a sawtooth of free pages that come and go, and near
 * the end a stall of which much is left for half a minute. */
static void make_saw(struct load_sample *samples, double per_s)
{
    for (uint32_t i = 0; i < 480; i++) {
        samples[i] = (struct load_sample){.at_s = i, .pid = 10};
        samples[i].value[LOAD_MEMORY] = 26000 + 40.0 * (i % 35) + 9.0 * (i % 4) +
                                        per_s * i + (i >= 420 && i < 450 ? 5000 : 0);
    }
}

/* If this failed, what comes and goes would look like a leak, or hide one. */
CASE_WITH(watch__floors_show_a_leak_and_nothing_else, set_up, tear_down)
{
    static struct load_sample samples[480];
    struct load_sample floors[480];
    make_saw(samples, 0);
    struct load_slope raw = load_slope_of(samples, 480, LOAD_MEMORY, 60);
    assert_true(raw.per_min > 4 * raw.error); /* as it was: a false alarm */
    size_t count = load_floors_of(samples, 480, 60, 60, floors);
    assert_int_equal(count, 6); /* the last minute is not over */
    struct load_slope slope = load_slope_of(floors, count, LOAD_MEMORY, 0);
    assert_true(slope.per_min < 4 * slope.error && slope.per_min < 20);
    make_saw(samples, 40.0 / 60);
    count = load_floors_of(samples, 480, 60, 60, floors);
    slope = load_slope_of(floors, count, LOAD_MEMORY, 0);
    assert_true(slope.per_min > 20 && slope.per_min < 60);
    assert_true(slope.per_min > 4 * slope.error);
}

/* If this failed, the floor of one worker would be taken for another's, or the first
 * seconds of a worker for its floor. */
CASE_WITH(watch__floors_are_of_one_worker_each, set_up, tear_down)
{
    static struct load_sample samples[300];
    struct load_sample floors[300];
    make_series(samples, 0);
    assert_int_equal(load_floors_of(samples, 300, 30, 10, floors), 6);
    for (uint32_t i = 0; i < 6; i++) {
        assert_int_equal(floors[i].pid, 10 + (int)(i / 2));
        assert_true(floors[i].value[LOAD_MEMORY] == 5000 + 900 * (i / 2));
    }
}
