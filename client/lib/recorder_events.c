/* recorder_events.c - what a client asks and is answered, as chunks of its recording. */

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "numbers.h"
#include "payload.h"
#include "recorder.h"
#include "recorder_shared.h"
#include "rpc.h"

/* ---- segments ---------------------------------------------------------------------- */

int cli_record_open(struct pccd_client *client)
{
    struct cli_recorder *recorder = client->recorder;
    int status = client->keeps ? record_writer_open(&recorder->writer, recorder->path)
                               : PCCD_E_NOMEM;

    if (status != 0) {
        return cli_record_stop_because(
            client, status,
            status == PCCD_E_NOMEM ? "no memory to keep what there is" : strerror(errno));
    }
    recorder->info.segments++;
    return cli_record_snapshot(client);
}

static void name_of(const struct cli_recorder *recorder, uint32_t age, char *name,
                    size_t room)
{
    (void)snprintf(name, room, age == 0 ? "%s" : "%s.%u", recorder->path, age);
}

/* The oldest file goes, the others become older, and a new one begins. */
static void turn(struct pccd_client *client)
{
    struct cli_recorder *recorder = client->recorder;
    size_t room = strlen(recorder->path) + 16;
    char *from = malloc(2 * room);

    if (from == NULL) {
        (void)cli_record_stop_because(client, PCCD_E_NOMEM, "no memory for a name");
        return;
    }
    assert(recorder->segments_max > 1 && !recorder->is_beginning);
    cli_record_end(client, RECORD_TURNED);
    cli_record_close_file(recorder);
    for (uint32_t age = recorder->segments_max - 1; age > 0; age--) {
        name_of(recorder, age - 1, from, room);
        name_of(recorder, age, from + room, room);
        (void)rename(from, from + room); /* there may be none of that age yet */
    }
    free(from);
    recorder->segment++;
    (void)cli_record_open(client);
}

/* Append a change of what is registered, where it is already: in a ring of segments, what
 * does not fit is what another one begins with. */
static int add_or_turn(struct pccd_client *client, enum record_kind kind,
                       const struct record_part *parts, size_t count)
{
    struct cli_recorder *recorder = client->recorder;
    int status;

    if (recorder->segments_max == 1 || recorder->is_beginning || recorder->has_ended) {
        return cli_record_add(client, kind, parts, count);
    }
    status =
        cli_record_append(recorder, cli_record_bound(recorder, true), kind, parts, count);
    if (status == PCCD_E_LIMIT) {
        turn(client);
        return recorder->info.status;
    }
    return status == 0 ? 0 : cli_record_stop_failed(client, status);
}

/* ---- events ------------------------------------------------------------------------ */

/* Time that recording takes is told: it is the caller's. */
static void count_time(struct pccd_client *client, uint64_t begin_ns)
{
    client->recorder->info.ns += common_now_ns() - begin_ns;
}

void cli_record_mesh(struct pccd_client *client, uint32_t mesh,
                     const struct registry_shape *shape)
{
    if (cli_record_is_on(client)) {
        (void)cli_record_put_shape(client, &(struct record_mesh){.mesh = mesh}, shape,
                                   add_or_turn);
    }
}

void cli_record_frame(struct pccd_client *client, const struct cli_call *call)
{
    struct cli_recorder *recorder = client->recorder;
    uint64_t begin_ns;

    if (!cli_record_is_on(client)) {
        return;
    }
    begin_ns = common_now_ns();
    recorder->info.frames += call->method == PROTO_METHOD_BATCH_SUBMIT
                                 ? call->params.BATCH_SUBMIT.scenes
                                 : call->method == PROTO_METHOD_FRAME_SUBMIT;
    if (recorder->segments_max > 1 &&
        recorder->writer.bytes >= recorder->segment_bytes_max) {
        turn(client); /* the new segment begins with every step without an answer */
    } else {
        (void)cli_record_step(client, call);
    }
    count_time(client, begin_ns);
}

/* The page of an answer. */
static void add_records(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_answer *answer = &call->answer;
    struct record_records head = {.step = answer->step,
                                  .first = answer->first,
                                  .count = answer->count,
                                  .record_bytes = answer->record_bytes};
    struct record_part parts[2] = {{&head, sizeof head}};

    if (!client->recorder->has_records || call->status != 0 || call->page == 0) {
        return;
    }
    if (call->method == PROTO_METHOD_FRAME_FETCH &&
        call->params.FRAME_FETCH.number != 0) {
        head.step = cli_journal_step(client, call->params.FRAME_FETCH.scene,
                                     call->params.FRAME_FETCH.number);
        if (head.step == 0) {
            return; /* of another client's step */
        }
    }
    parts[1] = (struct record_part){cli_page_base(client, call->page) + answer->offset,
                                    answer->count * answer->record_bytes};
    (void)cli_record_add(client, RECORD_RECORDS, parts, 2);
}

static void add_answer(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_answer *r = &call->answer;
    bool is_near = call->method == PROTO_METHOD_SCENE_NEAR;
    struct record_answer answer = {.step = is_near ? call->params.SCENE_NEAR.step
                                                   : call->params.FRAME_SUBMIT.step,
                                   .is_near = is_near,
                                   .status = call->status};

    if (call->status == 0) {
        answer = (struct record_answer){.step = r->step,
                                        .is_near = is_near,
                                        .mode = is_near ? 0 : r->mode,
                                        .what = is_near ? r->what : 0,
                                        .incomplete = r->incomplete,
                                        .verdict = r->verdict,
                                        .total = r->total,
                                        .possible = is_near ? 0 : r->possible,
                                        .initial = is_near ? 0 : r->initial,
                                        .toi_first = is_near ? 0 : r->toi_first,
                                        .distance_min = is_near ? r->distance_min : 0,
                                        .distance_max = is_near ? r->distance_max : 0,
                                        .crossings = is_near ? r->crossings : 0,
                                        .hash = {r->hash_hi, r->hash_lo}};
#define PUT(unused, type, name, of_step, of_near, member, meaning)                       \
    answer.member = r->name;
        COMMON_KINDS(PUT, )
#undef PUT
    }
    if (is_near) {
        cli_journal_note(client, call->params.SCENE_NEAR.scene);
    } else {
        cli_journal_answered(client, call->params.FRAME_SUBMIT.scene,
                             call->params.FRAME_SUBMIT.step, r->number);
        client->recorder->info.answers++;
    }
    if (cli_record_add(client, RECORD_ANSWER,
                       &(struct record_part){&answer, sizeof answer}, 1) == 0) {
        add_records(client, call);
    }
}

/* The answer to one scene of a batch, as to a step of it. */
static int add_scene_answer(struct pccd_client *client, const struct cli_call *call,
                            const struct pccd_scene_answer *scene, uint64_t step)
{
    const struct proto_BATCH_SUBMIT_request *asked = &call->params.BATCH_SUBMIT;
    struct record_answer answer = {.step = step, .status = scene->status};
    bool is_pairs = asked->mode == PCCD_MODE_PAIRS;
    struct record_records head = {.step = step,
                                  .count = scene->count,
                                  .record_bytes = is_pairs ? sizeof(struct pccd_pair)
                                                           : sizeof(struct pccd_contact)};
    struct record_part parts[2] = {{&head, sizeof head}};
    int status;

    if (scene->status == 0) {
        answer.mode = asked->mode;
        answer.incomplete = scene->incomplete;
        answer.verdict = scene->verdict;
        answer.total = scene->total;
        memcpy(answer.counts, scene->counts, sizeof answer.counts);
        answer.possible = scene->possible;
        answer.initial = scene->initial;
        answer.toi_first = scene->toi_first;
        memcpy(answer.hash, scene->hash, sizeof answer.hash);
    }
    cli_journal_answered(client, scene->scene, step, scene->number);
    client->recorder->info.answers++;
    status = cli_record_add(client, RECORD_ANSWER,
                            &(struct record_part){&answer, sizeof answer}, 1);
    if (status == 0 && client->recorder->has_records && scene->count > 0) {
        parts[1] = (struct record_part){cli_page_base(client, call->page) + scene->offset,
                                        scene->count * head.record_bytes};
        status = cli_record_add(client, RECORD_RECORDS, parts, 2);
    }
    return status;
}

static void add_batch_answer(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_BATCH_SUBMIT_request *asked = &call->params.BATCH_SUBMIT;
    const struct pccd_scene_answer refused = {.status = call->status};
    const struct pccd_scene_answer *scenes =
        call->status == 0 ? cli_batch_answers(client, call) : NULL;
    int status = 0;

    for (uint32_t i = 0; status == 0 && i < asked->scenes; i++) {
        status = add_scene_answer(client, call, scenes != NULL ? &scenes[i] : &refused,
                                  asked->step + i);
    }
}

/* A change of a scene whose journal says so. */
static bool is_in_journal(const struct pccd_client *client, const struct cli_call *call)
{
    switch (call->method) {
    case PROTO_METHOD_SCENE_ADD:
        return cli_journal_has(client, call->params.SCENE_ADD.scene);
    case PROTO_METHOD_SCENE_REMOVE:
        return cli_journal_has(client, call->params.SCENE_REMOVE.scene);
    case PROTO_METHOD_OBJECT_SET:
        return cli_journal_has(client, call->params.OBJECT_SET.scene);
    case PROTO_METHOD_SCENE_IGNORE:
        return cli_journal_has(client, call->params.SCENE_IGNORE.scene);
    default:
        return false;
    }
}

void cli_record_answer(struct pccd_client *client, const struct cli_call *call)
{
    uint64_t begin_ns;

    if (!cli_record_is_on(client) || call->recovery) {
        return;
    }
    begin_ns = common_now_ns();
    if (call->method == PROTO_METHOD_SCENE_DESTROY && call->status == 0) {
        cli_journal_end(client, call->params.SCENE_DESTROY.scene);
    }
    switch (call->method) {
    case PROTO_METHOD_FRAME_SUBMIT:
    case PROTO_METHOD_SCENE_NEAR:
        add_answer(client, call);
        break;
    case PROTO_METHOD_FRAME_FETCH:
    case PROTO_METHOD_NEAR_FETCH:
        add_records(client, call);
        break;
    case PROTO_METHOD_BATCH_SUBMIT:
        add_batch_answer(client, call);
        break;
    case PROTO_METHOD_SCENE_JOURNAL:
        cli_journal_take(client, call);
        break;
    default:
        if (call->status == 0 && !is_in_journal(client, call)) {
            (void)cli_record_change(client, call->method, &call->params, call->result,
                                    add_or_turn);
        }
        break;
    }
    count_time(client, begin_ns);
}
