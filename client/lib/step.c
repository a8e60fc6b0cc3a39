/* step.c - steps in flight and their answers.
 *
 * Poll, wait, fetch, cancel, release, and the calls that submit and wait at once. A step
 * is a call of the table (call.h) whose `step` is not 0; it stays there until its answer
 * is taken.
 *
 * The way of a vertex from the caller's array to the daemon. It is copied once:
 *
 *     step.c       pccd_step_x1: submit, then wait
 *     frame.c      pccd_submit: the slot's table is written, the vertex copied behind it
 *     |  attach.c  finds a slot, or a larger ring
 *     submit.c     frame.submit, with the number of the step
 *     rpc.c        is encoded and sent; a call waits for the answer
 *
 * The answer comes by receive.c, connect.c tells the registry that the slot is done with,
 * and take_answer, below, hands it out.
 */
#include "step.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "client.h"
#include "connection.h"
#include "link.h"
#include "numbers.h"
#include "recorder.h"
#include "recorder_shared.h"
#include "replica.h"
#include "rpc.h"
#include "submit.h"

#define ANSWER_TAG 0x7063636461677331ull /* marks an answer of this library */
#define TOI_NONE   2.0                   /* toi_first of no contacts */

/* ---- answers ----------------------------------------------------------------------- */

static uint64_t answer_tag(const struct pccd_client *client, uint64_t page)
{
    return (ANSWER_TAG ^ (uint64_t)(uintptr_t)client) + page;
}

/* Of a step or about what is near, with the records of its page. */
static void fill_answer(const struct proto_answer *from, bool is_near,
                        const void *records, struct pccd_answer *answer)
{
#define GET(unused, type, name, of_step, of_near, member, meaning)                       \
    answer->member = from->name;
    COMMON_NUMBERS(GET, )
#undef GET
    answer->step = from->step;
    answer->count = from->count;
    answer->first = from->first;
    answer->cursor = from->cursor;
    answer->total = from->total;
    answer->number = from->number;
    (void)snprintf(answer->tuning, sizeof answer->tuning, "%.*s",
                   (int)sizeof answer->tuning - 1, from->tuning);
    answer->is_near = is_near;
    if (is_near) {
        answer->toi_first = TOI_NONE;
    }
    if (is_near && answer->what == PCCD_NEAR_VERTICES) {
        answer->vertex_bounds = records;
    } else if (is_near) {
        answer->near = records;
    } else if (answer->mode == PCCD_MODE_PAIRS) {
        answer->pairs = records;
    } else {
        answer->contacts = records;
    }
}

int cli_answer_check(struct pccd_client *client, const struct pccd_answer *answer)
{
    return answer == NULL
               ? cli_fail(client, PCCD_E_INVAL, "answer is NULL")
               : cli_struct_check(client, "answer", answer->struct_bytes, sizeof *answer);
}

/* Hand a DONE call over to the user and free its entry. Returns the call's status. */
static int take_answer(struct pccd_client *client, struct cli_call *call,
                       struct pccd_answer *to)
{
    struct pccd_answer answer = {.step = call->step, .status = call->status};

    assert(call->state == CLI_CALL_DONE && (call->page == 0 || call->status == 0));
    if (call->status == 0) {
        bool is_near = call->method == PROTO_METHOD_SCENE_NEAR ||
                       call->method == PROTO_METHOD_NEAR_FETCH;
        const void *records =
            call->page != 0 ? cli_page_base(client, call->page) + call->answer.offset
                            : NULL;

        fill_answer(&call->answer, is_near, records, &answer);
        answer.reserved[0] = call->page;
        answer.reserved[1] = answer_tag(client, call->page);
    }
    cli_struct_fill(to, &answer, sizeof answer);
    return cli_call_finish(client, call);
}

static struct cli_call *find_step(struct pccd_client *client, uint64_t step)
{
    for (uint32_t i = 0; step != 0 && i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->step == step &&
            (call->state == CLI_CALL_SENT || call->state == CLI_CALL_DONE)) {
            return call;
        }
    }
    return NULL;
}

static bool is_batch_call(const struct cli_call *call)
{
    return call->method == PROTO_METHOD_BATCH_SUBMIT;
}

struct cli_call *cli_step_oldest_done(struct pccd_client *client, bool is_batch)
{
    struct cli_call *oldest = NULL;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->step != 0 && call->state == CLI_CALL_DONE &&
            is_batch_call(call) == is_batch &&
            (oldest == NULL || call->step < oldest->step)) {
            oldest = call;
        }
    }
    return oldest;
}

/* Take in what has arrived, without waiting; more than the table's calls cannot
 * matter. */
void cli_step_drain(struct pccd_client *client)
{
    for (uint32_t i = 0; i < CLI_CALLS && !client->dead; i++) {
        if (cli_receive(client) != 0) {
            break;
        }
    }
    if (client->link.is_down) {
        cli_recover_poll(client);
    }
    cli_journal_pump(client);
}

int pccd_poll(struct pccd_client *client, struct pccd_answer *answer)
{
    struct cli_call *call;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_answer_check(client, answer);
    if (status != 0) {
        return status;
    }
    cli_step_drain(client);
    call = cli_step_oldest_done(client, false);
    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_AGAIN, "no answer has arrived");
    }
    (void)take_answer(client, call, answer);
    return 0;
}

int cli_step_await(struct pccd_client *client, uint64_t step, bool is_batch,
                   int timeout_ms, struct cli_call **found)
{
    struct cli_call *call = find_step(client, step);

    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_INVAL, "step %llu is not pending",
                                       (unsigned long long)step);
    }
    if (is_batch_call(call) != is_batch) {
        return cli_fail(client, PCCD_E_INVAL, "%llu is the number of a %s",
                        (unsigned long long)step,
                        is_batch ? "step: pccd_wait" : "batch: pccd_batch_wait");
    }
    *found = call;
    if (timeout_ms == 0) {
        cli_step_drain(client);
        if (call->state == CLI_CALL_SENT) {
            return cli_fail(client, PCCD_E_AGAIN, "step %llu has not been answered",
                            (unsigned long long)step);
        }
    }
    cli_journal_pump(client);
    return cli_call_wait(client, call, cli_deadline(client, timeout_ms));
}

int pccd_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
              struct pccd_answer *answer)
{
    struct cli_call *call = NULL;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_answer_check(client, answer);
    if (status == 0) {
        status = cli_step_await(client, step, false, timeout_ms, &call);
    }
    return status != 0 ? status : take_answer(client, call, answer);
}

int cli_step_fetch(struct pccd_client *client, int method, const void *request,
                   struct pccd_answer *answer)
{
    struct cli_call *call = NULL;
    uint64_t deadline_ns = cli_deadline(client, -1);
    int status = cli_answer_check(client, answer);

    status = status != 0 ? status : cli_step_check(client);
    if (status == 0) {
        status =
            cli_call_send(client, method, request, CLI_SLOT_NONE, deadline_ns, &call);
    }
    if (status != 0) {
        return status;
    }
    status = cli_call_wait(client, call, deadline_ns);
    if (status != 0) {
        cli_call_drop(client, call);
        return status;
    }
    if (call->status != 0) { /* leaves the answer at hand as it is: it may hold a page */
        return cli_call_finish(client, call);
    }
    return take_answer(client, call, answer);
}

int pccd_fetch(struct pccd_client *client, uint32_t scene, uint64_t step, uint64_t cursor,
               struct pccd_answer *answer)
{
    const struct proto_FRAME_FETCH_request frame = {
        .scene = scene, .step = step, .cursor = cursor};
    const struct proto_NEAR_FETCH_request near = {
        .scene = scene, .step = step, .cursor = cursor};

    CLI_ENTER_OR_RETURN(client);
    return cli_near_is(client, scene, step)
               ? cli_step_fetch(client, PROTO_METHOD_NEAR_FETCH, &near, answer)
               : cli_step_fetch(client, PROTO_METHOD_FRAME_FETCH, &frame, answer);
}

void pccd_answer_release(struct pccd_client *client, struct pccd_answer *answer)
{
    CLI_TURN cli_turn = cli_enter_late(client);

    if (client == NULL || answer == NULL) {
        return;
    }
    if (answer->reserved[0] != 0 &&
        answer->reserved[1] == answer_tag(client, answer->reserved[0])) {
        cli_page_release(client, answer->reserved[0]);
    }
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->near = NULL;
    answer->vertex_bounds = NULL;
    answer->reserved[0] = answer->reserved[1] = 0;
}

int pccd_cancel(struct pccd_client *client, uint64_t step)
{
    struct proto_CANCEL_request request;
    struct proto_CANCEL_result result;
    struct cli_call *call;

    CLI_ENTER_OR_RETURN(client);
    call = find_step(client, step);
    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_INVAL, "step %llu is not pending",
                                       (unsigned long long)step);
    }
    if (call->state == CLI_CALL_DONE) {
        return 0;
    }
    request.id = call->id;
    cli_record_cancel(client, step);
    return cli_call_sync(client, PROTO_METHOD_CANCEL, &request, &result,
                         cli_deadline(client, -1));
}

void pccd_abandon(struct pccd_client *client, uint64_t step)
{
    CLI_TURN cli_turn = cli_enter_late(client);
    struct cli_call *call = client != NULL ? find_step(client, step) : NULL;
    struct proto_CANCEL_request request;
    struct cli_call *cancel = NULL;

    if (call == NULL) {
        return;
    }
    request.id = call->id;
    cli_record_cancel(client, step);
    cli_call_drop(client, call);
    if (call->state == CLI_CALL_LOST &&
        cli_call_send(client, PROTO_METHOD_CANCEL, &request, CLI_SLOT_NONE,
                      common_now_ns(), &cancel) == 0) {
        cli_call_drop(client, cancel);
    }
}

/* ---- submit and wait in one -------------------------------------------------------- */

int cli_step_finish(struct pccd_client *client, uint64_t step, struct pccd_answer *answer)
{
    char text[CLI_TEXT_BYTES];
    int status = pccd_wait(client, step, -1, answer);

    if (status == PCCD_E_TIMEOUT) {
        memcpy(text, client->error, sizeof text);
        pccd_abandon(client, step);
        status = cli_fail(client, status, "%s", text);
    }
    return status;
}

int pccd_step(struct pccd_client *client, uint32_t scene,
              const struct pccd_motion *motions, uint32_t motion_count,
              const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_answer_check(client, answer);
    if (status == 0) {
        status = pccd_submit(client, scene, motions, motion_count, settings, &step);
    }
    return status != 0 ? status : cli_step_finish(client, step, answer);
}

int pccd_step_x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                 const void *x1, enum pccd_format format, uint32_t vertex_count,
                 const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    struct pccd_motion motion = {
        .object = object, .count = vertex_count, .format = format, .x1 = x1};

    CLI_ENTER_OR_RETURN(client);
    if (x1 == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "x1 is NULL");
    }
    return pccd_step(client, scene, &motion, 1, settings, answer);
}

int pccd_step_x0x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                   const void *x0, const void *x1, enum pccd_format format,
                   uint32_t vertex_count, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer)
{
    struct pccd_motion motion = {
        .object = object, .count = vertex_count, .format = format, .x0 = x0, .x1 = x1};

    CLI_ENTER_OR_RETURN(client);
    if (x0 == NULL || x1 == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL", x0 == NULL ? "x0" : "x1");
    }
    return pccd_step(client, scene, &motion, 1, settings, answer);
}
