/* step.c - steps in flight and their answers.
 *
 * Room:     client/lib. May include: step.h, attach.h, page.h, recorder_shared.h,
 *           recover.h, rpc.h.
 * Does:     submit, poll, wait, fetch, cancel, release, and the calls that do it all in
 *           one. A step is a call of the table in client.h whose `step` is not 0; it
 *           stays there until its answer is taken.
 * Does not: interpret records: they lie in the daemon's memory, read-only.
 * Threads:  [owner].
 */
#include "step.h"

#include <string.h>

#include "attach.h"
#include "page.h"
#include "recorder.h"
#include "recorder_shared.h"
#include "recover.h"
#include "rpc.h"

#define ANSWER_TAG 0x7063636461677331ull /* marks an answer of this library */

int cli_step_check(struct pccd_client *client)
{
    uint32_t count = 0;
    int rc;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        const struct cli_call *call = &client->calls[i];

        count += call->step != 0 &&
                 (call->state == CLI_CALL_SENT || call->state == CLI_CALL_DONE);
    }
    if (count >= CLI_STEPS) {
        return cli_fail(client, PCCD_E_BUSY, "%u steps wait to be taken: poll or wait",
                        count);
    }
    rc = cli_page_check(client);
    return rc != 0 ? rc : cli_alive(client);
}

int cli_step_send(struct pccd_client *client, uint32_t scene, uint32_t slot, uint64_t seq,
                  uint32_t segment_count, const struct pccd_step_settings *settings,
                  uint64_t *step)
{
    struct proto_FRAME_SUBMIT_request request = {.scene = scene,
                                                 .slot = slot != CLI_SLOT_NONE ? slot : 0,
                                                 .seq = seq,
                                                 .segments = segment_count,
                                                 .step = client->next_step};
    struct cli_call *call = NULL;
    int rc = cli_step_check(client);

    if (settings != NULL) {
        request.mode = (uint32_t)settings->mode;
        request.method = (uint32_t)settings->method;
        request.threads = settings->threads;
        request.scheduler = (uint32_t)settings->scheduler;
        request.high_level = (uint32_t)settings->high_level;
        request.refit = (uint32_t)settings->refit;
        request.tolerance = settings->tolerance;
        request.deadline_ns = settings->deadline_ns;
        request.hold = settings->hold;
    }
    if (rc == 0) {
        rc = cli_call_send(client, PROTO_METHOD_FRAME_SUBMIT, &request, slot,
                           cli_deadline(client, -1), &call);
    }
    if (rc != 0) {
        if (slot != CLI_SLOT_NONE) {
            cli_slot_abort(client, slot);
        }
        return rc;
    }
    call->step = client->next_step;
    *step = client->next_step++;
    if (client->recorder != NULL) {
        cli_record_frame(client, call);
    }
    return 0;
}

int pccd_submit_still(struct pccd_client *client, uint32_t scene,
                      const struct pccd_step_settings *settings, uint64_t *step)
{
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (step == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "step is NULL");
    }
    rc = cli_alive(client);
    if (rc == 0 && client->ring.upload.base == NULL) {
        rc = cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, cli_deadline(client, -1));
    }
    if (rc != 0) {
        return rc;
    }
    return cli_step_send(client, scene, CLI_SLOT_NONE, 0, 0, settings, step);
}

/* ---- answers ----------------------------------------------------------------------- */

static uint64_t answer_tag(const struct pccd_client *client, uint64_t page)
{
    return (ANSWER_TAG ^ (uint64_t)(uintptr_t)client) + page;
}

static void fill_numbers(const struct proto_FRAME_SUBMIT_result *result,
                         struct pccd_answer *answer)
{
    answer->mode = (enum pccd_mode)result->mode;
    answer->method = (enum pccd_method)result->method;
    answer->incomplete = (enum pccd_incomplete)result->incomplete;
    answer->verdict = (enum pccd_verdict)result->verdict;
    answer->count = result->count;
    answer->first = result->first;
    answer->cursor = result->cursor;
    answer->total = result->total;
    answer->vf = result->vf;
    answer->ee = result->ee;
    answer->possible = result->possible;
    answer->initial = result->initial;
    answer->toi_first = result->toi_first;
    answer->hash[0] = result->hash_hi;
    answer->hash[1] = result->hash_lo;
    answer->number = result->number;
    answer->threads = result->threads;
    answer->scheduler = (enum pccd_scheduler)result->scheduler;
    answer->high_level = (enum pccd_high_level)result->high_level;
    answer->refit = (enum pccd_refit)result->refit;
    answer->times = (struct pccd_step_times){
        .queue = result->ns_queue,
        .ingest = result->ns_ingest,
        .refit = result->ns_refit,
        .traversal = result->ns_traversal,
        .tests = result->ns_tests,
        .merge = result->ns_merge,
        .step = result->ns_step,
        .low = result->ns_low,
        .high = result->ns_high,
        .rebuild = result->ns_rebuild,
    };
    answer->counters = (struct pccd_step_counters){
        .task_units = result->task_units,
        .box_tests = result->box_tests,
        .leaf_pairs = result->leaf_pairs,
        .candidates_vf = result->candidates_vf,
        .candidates_ee = result->candidates_ee,
        .survivors = result->survivors,
        .exact = result->exact,
        .builds = result->builds,
        .allocs = result->allocs,
        .rebuilds = result->rebuilds,
        .rebuilt_triangles = result->rebuilt_triangles,
        .swaps = result->swaps,
        .swapped_triangles = result->swapped_triangles,
    };
}

/* Hand a DONE call over to the user and free its entry. Returns the call's status. */
static int take_answer(struct pccd_client *client, struct cli_call *call,
                       struct pccd_answer *answer)
{
    const struct proto_FRAME_SUBMIT_result *result = &call->answer;

    memset(answer, 0, sizeof(*answer));
    answer->step = call->step;
    answer->status = call->status;
    if (call->status == 0) {
        const void *records =
            call->page != 0 ? cli_page_base(client, call->page) + result->offset : NULL;

        answer->step = result->step;
        fill_numbers(result, answer);
        if (result->mode == PCCD_MODE_PAIRS) {
            answer->pairs = records;
        } else {
            answer->contacts = records;
        }
        answer->reserved[0] = call->page;
        answer->reserved[1] = answer_tag(client, call->page);
    }
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

static struct cli_call *find_oldest_done(struct pccd_client *client)
{
    struct cli_call *oldest = NULL;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->step != 0 && call->state == CLI_CALL_DONE &&
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

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (answer == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "answer is NULL");
    }
    cli_step_drain(client);
    call = find_oldest_done(client);
    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_AGAIN, "no answer has arrived");
    }
    (void)take_answer(client, call, answer);
    return 0;
}

int pccd_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
              struct pccd_answer *answer)
{
    struct cli_call *call;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (answer == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "answer is NULL");
    }
    call = find_step(client, step);
    if (call == NULL) {
        return client->dead ? cli_alive(client)
                            : cli_fail(client, PCCD_E_INVAL, "step %llu is not pending",
                                       (unsigned long long)step);
    }
    if (timeout_ms == 0) {
        cli_step_drain(client);
        if (call->state == CLI_CALL_SENT) {
            return cli_fail(client, PCCD_E_AGAIN, "step %llu has not been answered",
                            (unsigned long long)step);
        }
    }
    cli_journal_pump(client);
    rc = cli_call_wait(client, call, cli_deadline(client, timeout_ms));
    return rc != 0 ? rc : take_answer(client, call, answer);
}

int cli_step_fetch(struct pccd_client *client,
                   const struct proto_FRAME_FETCH_request *request,
                   struct pccd_answer *answer)
{
    struct cli_call *call = NULL;
    uint64_t deadline_ns = cli_deadline(client, -1);
    int rc = cli_step_check(client);

    if (rc == 0) {
        rc = cli_call_send(client, PROTO_METHOD_FRAME_FETCH, request, CLI_SLOT_NONE,
                           deadline_ns, &call);
    }
    if (rc != 0) {
        return rc;
    }
    rc = cli_call_wait(client, call, deadline_ns);
    if (rc != 0) {
        cli_call_drop(client, call);
        return rc;
    }
    if (call->status != 0) { /* leaves the answer at hand as it is: it may hold a page */
        return cli_call_finish(client, call);
    }
    return take_answer(client, call, answer);
}

int pccd_fetch(struct pccd_client *client, uint32_t scene, uint64_t step, uint64_t cursor,
               struct pccd_answer *answer)
{
    struct proto_FRAME_FETCH_request request = {
        .scene = scene, .step = step, .cursor = cursor};

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (answer == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "answer is NULL");
    }
    return cli_step_fetch(client, &request, answer);
}

void pccd_answer_release(struct pccd_client *client, struct pccd_answer *answer)
{
    if (client == NULL || answer == NULL) {
        return;
    }
    if (answer->reserved[0] != 0 &&
        answer->reserved[1] == answer_tag(client, answer->reserved[0])) {
        cli_page_release(client, answer->reserved[0]);
    }
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->reserved[0] = answer->reserved[1] = 0;
}

int pccd_cancel(struct pccd_client *client, uint64_t step)
{
    struct proto_CANCEL_request request;
    struct proto_CANCEL_result result;
    struct cli_call *call;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
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

/* ---- begin, copy, commit and wait in one ------------------------------------------- */

/* Nobody will ever ask for this step again: stop it if that is still possible, and drop
 * whatever it brings. */
static void abandon(struct pccd_client *client, uint64_t step)
{
    struct cli_call *call = find_step(client, step);
    struct proto_CANCEL_request request;
    struct cli_call *cancel = NULL;

    if (call == NULL) {
        return;
    }
    request.id = call->id;
    cli_record_cancel(client, step);
    cli_call_drop(client, call);
    if (call->state == CLI_CALL_LOST &&
        cli_call_send(client, PROTO_METHOD_CANCEL, &request, CLI_SLOT_NONE, cli_now_ns(),
                      &cancel) == 0) {
        cli_call_drop(client, cancel);
    }
}

static int finish_step(struct pccd_client *client, uint64_t step,
                       struct pccd_answer *answer)
{
    char text[CLI_TEXT_BYTES];
    int rc = pccd_wait(client, step, -1, answer);

    if (rc != PCCD_E_TIMEOUT) {
        return rc;
    }
    memcpy(text, client->error, sizeof(text));
    abandon(client, step);
    return cli_fail(client, rc, "%s", text);
}

/* x0 NULL: the start is the last step's end. */
static int run_step(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const void *x0, const void *x1, enum pccd_format format,
                    uint32_t vertex_count, const struct pccd_step_settings *settings,
                    struct pccd_answer *answer)
{
    size_t bytes = (size_t)vertex_count *
                   (format == PCCD_FORMAT_F64 ? 3 * sizeof(double) : 3 * sizeof(float));
    struct pccd_frame frame = {.client = NULL};
    void *to0 = NULL;
    void *to1 = NULL;
    uint64_t step = 0;
    int rc = pccd_frame_begin(client, scene, 1, x0 != NULL ? 2 * bytes : bytes, &frame);

    if (rc != 0) {
        return rc;
    }
    rc = x0 != NULL ? pccd_frame_x0x1(&frame, object, format, 0, vertex_count, &to0, &to1)
                    : pccd_frame_x1(&frame, object, format, 0, vertex_count, &to1);
    if (rc != 0) {
        pccd_frame_abort(&frame);
        return rc;
    }
    if (x0 != NULL) {
        memcpy(to0, x0, bytes);
    }
    memcpy(to1, x1, bytes);
    rc = pccd_frame_commit(&frame, settings, &step);
    return rc != 0 ? rc : finish_step(client, step, answer);
}

int pccd_step_x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                 const void *x1, enum pccd_format format, uint32_t vertex_count,
                 const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (x1 == NULL || answer == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL", x1 == NULL ? "x1" : "answer");
    }
    return run_step(client, scene, object, NULL, x1, format, vertex_count, settings,
                    answer);
}

int pccd_step_x0x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                   const void *x0, const void *x1, enum pccd_format format,
                   uint32_t vertex_count, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer)
{
    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (x0 == NULL || x1 == NULL || answer == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL",
                        x0 == NULL   ? "x0"
                        : x1 == NULL ? "x1"
                                     : "answer");
    }
    return run_step(client, scene, object, x0, x1, format, vertex_count, settings,
                    answer);
}
