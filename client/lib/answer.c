/* answer.c - the answers to what was asked of scenes.
 *
 * A step is a call of the table (client.h) whose `step` is not 0; it stays there until
 * its answer is taken.
 */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "connection.h"
#include "link.h"
#include "numbers.h"
#include "recorder.h"
#include "recorder_shared.h"
#include "replica.h"
#include "rpc.h"
#include "step.h"

#define ANSWER_TAG 0x7063636461677331ull /* marks an answer of this library */
#define TOI_NONE   2.0                   /* toi_first of no contacts */

/* ---- handing out ------------------------------------------------------------------- */

static uint64_t answer_tag(const struct pccd_client *client, uint64_t page)
{
    return (ANSWER_TAG ^ (uint64_t)(uintptr_t)client) + page;
}

/* Fill the answer to a step or about what is near, with the records of its page. */
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

static void take_one(const struct pccd_client *client, const struct cli_call *call,
                     struct pccd_answer *to)
{
    struct pccd_answer answer = {.step = call->step};
    bool is_near = call->method == PROTO_METHOD_SCENE_NEAR ||
                   call->method == PROTO_METHOD_NEAR_FETCH;
    const void *records =
        call->page != 0 ? cli_page_base(client, call->page) + call->answer.offset : NULL;

    if (call->status != 0) { /* `to` may still have the records of an answer before it */
        to->step = call->step;
        to->status = call->status;
        return;
    }
    fill_answer(&call->answer, is_near, records, &answer);
    answer.reserved[0] = call->page;
    answer.reserved[1] = answer_tag(client, call->page);
    cli_struct_fill(to, &answer, sizeof answer);
}

static bool is_batch_call(const struct cli_call *call)
{
    return call->method == PROTO_METHOD_BATCH_SUBMIT;
}

static void take_batch(const struct pccd_client *client, const struct cli_call *call,
                       struct pccd_batch_answer *to)
{
    const struct proto_BATCH_SUBMIT_result *result = &call->batch;

    if (call->status != 0) {
        to->step = call->step;
        to->status = call->status;
        return;
    }
    const struct pccd_batch_answer answer = {
        .step = call->step,
        .failed = result->failed,
        .incomplete = result->incomplete,
        .scenes = cli_batch_answers(client, call),
        .count = result->count,
        .total = result->total,
        .threads = result->threads,
        .queue_ns = result->ns_queue,
        .batch_ns = result->ns_batch,
        .steps_ns = result->ns_steps,
        .mode = (enum pccd_mode)call->params.BATCH_SUBMIT.mode,
        .offset = result->offset,
        .reserved = {call->page, answer_tag(client, call->page)}};
    cli_struct_fill(to, &answer, sizeof answer);
}

/* Hand a DONE call over to the user and free its entry. Returns the call's status. */
static int take(struct pccd_client *client, struct cli_call *call, void *to)
{
    assert(call->state == CLI_CALL_DONE && (call->page == 0 || call->status == 0));
    if (is_batch_call(call)) {
        take_batch(client, call, to);
    } else {
        take_one(client, call, to);
    }
    return cli_call_finish(client, call);
}

int cli_answer_check(struct pccd_client *client, const void *answer, bool is_batch)
{
    return answer == NULL ? cli_fail(client, PCCD_E_INVAL, "answer is NULL")
                          : cli_struct_check(client, "answer", answer,
                                             is_batch ? sizeof(struct pccd_batch_answer)
                                                      : sizeof(struct pccd_answer));
}

void cli_answer_release(struct pccd_client *client, uint64_t reserved[2])
{
    if (reserved[0] != 0 && reserved[1] == answer_tag(client, reserved[0])) {
        cli_page_release(client, reserved[0]);
    }
    reserved[0] = reserved[1] = 0;
}

/* ---- waiting ----------------------------------------------------------------------- */

struct cli_call *cli_step_find(struct pccd_client *client, uint64_t step)
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

/* Say why there is no such step. */
static int fail_not_pending(struct pccd_client *client, uint64_t step)
{
    return client->dead ? cli_alive(client)
                        : cli_fail(client, PCCD_E_INVAL, "step %llu is not pending",
                                   (unsigned long long)step);
}

static struct cli_call *find_oldest_done(struct pccd_client *client, bool is_batch)
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

/* More than the table's calls cannot matter. */
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

int cli_answer_poll(struct pccd_client *client, bool is_batch, void *answer)
{
    int status = cli_answer_check(client, answer, is_batch);
    struct cli_call *call;

    if (status != 0) {
        return status;
    }
    cli_step_drain(client);
    call = find_oldest_done(client, is_batch);
    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_AGAIN, "no answer has arrived");
    }
    (void)take(client, call, answer);
    return 0;
}

int cli_answer_wait(struct pccd_client *client, uint64_t step, bool is_batch,
                    int timeout_ms, void *answer)
{
    int status = cli_answer_check(client, answer, is_batch);
    struct cli_call *call = status == 0 ? cli_step_find(client, step) : NULL;

    if (call == NULL) {
        return status != 0 ? status : fail_not_pending(client, step);
    }
    if (is_batch_call(call) != is_batch) {
        return cli_fail(client, PCCD_E_INVAL, "%llu is the number of a %s",
                        (unsigned long long)step,
                        is_batch ? "step: pccd_wait" : "batch: pccd_batch_wait");
    }
    if (timeout_ms == 0) {
        cli_step_drain(client);
        if (call->state == CLI_CALL_SENT) {
            return cli_fail(client, PCCD_E_AGAIN, "step %llu has not been answered",
                            (unsigned long long)step);
        }
    }
    cli_journal_pump(client);
    status = cli_call_wait(client, call, cli_deadline(client, timeout_ms));
    return status != 0 ? status : take(client, call, answer);
}

int cli_answer_finish(struct pccd_client *client, uint64_t step, bool is_batch,
                      void *answer)
{
    char text[CLI_TEXT_BYTES];
    int status = cli_answer_wait(client, step, is_batch, -1, answer);

    if (status == PCCD_E_TIMEOUT) {
        memcpy(text, client->error, sizeof text);
        pccd_abandon(client, step);
        status = cli_fail(client, status, "%s", text);
    }
    return status;
}

int cli_answer_fetch(struct pccd_client *client, int method, const void *request,
                     struct pccd_answer *answer)
{
    struct cli_call *call = NULL;
    uint64_t deadline_ns = cli_deadline(client, -1);
    int status = cli_answer_check(client, answer, false);

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
    return take(client, call, answer);
}

/* ---- one scene --------------------------------------------------------------------- */

int pccd_poll(struct pccd_client *client, struct pccd_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return cli_answer_poll(client, false, answer);
}

int pccd_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
              struct pccd_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return cli_answer_wait(client, step, false, timeout_ms, answer);
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
               ? cli_answer_fetch(client, PROTO_METHOD_NEAR_FETCH, &near, answer)
               : cli_answer_fetch(client, PROTO_METHOD_FRAME_FETCH, &frame, answer);
}

void pccd_answer_release(struct pccd_client *client, struct pccd_answer *answer)
{
    CLI_TURN cli_turn = cli_enter_late(client);

    if (client == NULL || answer == NULL) {
        return;
    }
    cli_answer_release(client, answer->reserved);
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->near = NULL;
    answer->vertex_bounds = NULL;
    answer->count = 0;
}

int pccd_cancel(struct pccd_client *client, uint64_t step)
{
    struct proto_CANCEL_request request;
    struct proto_CANCEL_result result;
    struct cli_call *call;

    CLI_ENTER_OR_RETURN(client);
    call = cli_step_find(client, step);
    if (call == NULL) {
        return fail_not_pending(client, step);
    }
    if (call->state == CLI_CALL_DONE) {
        return 0;
    }
    request.id = call->id;
    return cli_call_sync(client, PROTO_METHOD_CANCEL, &request, &result,
                         cli_deadline(client, -1));
}

void pccd_abandon(struct pccd_client *client, uint64_t step)
{
    CLI_TURN cli_turn = cli_enter_late(client);
    struct cli_call *call = client != NULL ? cli_step_find(client, step) : NULL;
    struct proto_CANCEL_request request;
    struct cli_call *cancel = NULL;

    if (call == NULL) {
        return;
    }
    request.id = call->id;
    cli_call_drop(client, call);
    if (call->state == CLI_CALL_LOST &&
        cli_call_send(client, PROTO_METHOD_CANCEL, &request, CLI_SLOT_NONE,
                      common_now_ns(), &cancel) == 0) {
        cli_call_drop(client, cancel);
    }
}
