/* recorder_shared.c - shared scenes, in recordings. */
#include "recorder_shared.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "attach.h"
#include "rpc.h"

/* A scene's journal. */
struct cli_journal {
    struct cli_journal *next;
    uint32_t scene;
    bool has_begun;   /* at the daemon */
    bool is_due;      /* there is more, or there may be */
    bool is_asked;    /* a page is on its way */
    uint64_t cursor;  /* of what has come */
    uint8_t *entries; /* that have come and are not whole yet */
    size_t bytes;
    size_t room;
    uint64_t number; /* of the client's last step in the scene, to the scene and */
    uint64_t step;   /* to the client */
};

/* Kept by the daemon until it is fetched, which each answered step is cause for. */
#define JOURNAL_BYTES (128ull << 20)

static struct cli_journal *find(const struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *journal =
        client->recorder != NULL ? client->recorder->journals : NULL;

    while (journal != NULL && journal->scene != scene) {
        journal = journal->next;
    }
    return journal;
}

bool cli_journal_has(const struct pccd_client *client, uint32_t scene)
{
    return find(client, scene) != NULL;
}

void cli_journal_note(struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *journal = find(client, scene);

    if (journal != NULL) {
        journal->is_due = true;
    }
}

void cli_journal_answered(struct pccd_client *client, uint32_t scene, uint64_t step,
                          uint64_t number)
{
    struct cli_journal *journal = find(client, scene);

    if (journal != NULL && number != 0) {
        journal->number = number;
        journal->step = step;
    }
    cli_journal_note(client, scene);
}

uint64_t cli_journal_step(const struct pccd_client *client, uint32_t scene,
                          uint64_t number)
{
    const struct cli_journal *journal = find(client, scene);

    return journal != NULL && journal->number == number ? journal->step : 0;
}

/* ---- entries ----------------------------------------------------------------------- */

/* An object's shape, in the payload of an entry. */
static int write_guest(struct pccd_client *client,
                       const struct proto_SCENE_ADD_request *add, struct record_part in)
{
    struct proto_journal_shape head;
    struct registry_shape shape;
    const uint8_t *at = in.at;
    uint64_t x_bytes, radii_bytes, triangle_bytes, edge_bytes;

    if (in.bytes < sizeof head) {
        return PCCD_E_BADMSG;
    }
    memcpy(&head, at, sizeof head);
    x_bytes = head.vertex_count * sizeof(double[3]);
    radii_bytes = head.radius_count * sizeof(double);
    triangle_bytes = head.triangle_count * sizeof(uint32_t[3]);
    edge_bytes = head.edge_count * sizeof(uint32_t[2]);
    if (add->want == 0 || (radii_bytes != 0 && head.radius_count != head.vertex_count) ||
        in.bytes - sizeof head < x_bytes + radii_bytes + triangle_bytes + edge_bytes +
                                     head.point_count * sizeof(uint32_t)) {
        return PCCD_E_BADMSG;
    }
    at += sizeof head;
    shape = (struct registry_shape){.format = PCCD_FORMAT_F64,
                                    .vertex_count = head.vertex_count,
                                    .triangle_count = head.triangle_count,
                                    .edge_count = head.edge_count,
                                    .point_count = head.point_count,
                                    .x = at,
                                    .radii = radii_bytes != 0 ? at + x_bytes : NULL};
    shape.triangles = at + x_bytes + radii_bytes;
    shape.edges = (const uint8_t *)shape.triangles + triangle_bytes;
    shape.points = (const uint8_t *)shape.edges + edge_bytes;
    return cli_record_put_shape(
        client, &(struct record_mesh){.scene = add->scene, .object = add->want}, &shape,
        cli_record_add);
}

/* A whole entry: a request, written as if it were this client's own. The decoder is free:
 * the answer that has brought the entry has been decoded. */
static int write_entry(struct pccd_client *client, const uint8_t *at)
{
    struct proto_journal_entry entry;
    struct proto_envelope envelope;
    struct proto_error error;
    union cli_params params;
    struct record_part payload[2] = {{NULL, 0}, {NULL, 0}};
    int status;

    memcpy(&entry, at, sizeof entry);
    if (PROTO_JOURNAL_PAYLOAD(entry.message_bytes) > entry.bytes) {
        return PCCD_E_BADMSG;
    }
    payload[0].at = at + PROTO_JOURNAL_PAYLOAD(entry.message_bytes);
    payload[0].bytes = entry.bytes - PROTO_JOURNAL_PAYLOAD(entry.message_bytes);
    status = proto_decode(client->decoder, at + sizeof entry, entry.message_bytes,
                          &envelope, &error);
    if (status != 0 || envelope.kind != PROTO_REQUEST) {
        return status != 0 ? status : PCCD_E_BADMSG;
    }
    if (envelope.method < 0) {
        return 0; /* of a newer daemon, which says nothing that must be known */
    }
    status = proto_decode_body(&envelope, &proto_messages[envelope.method].request,
                               &params, &error);
    if (status != 0) {
        return status;
    }
    if (envelope.method == PROTO_METHOD_SCENE_ADD) {
        return write_guest(client, &params.SCENE_ADD, payload[0]);
    }
    return envelope.method == PROTO_METHOD_FRAME_SUBMIT ||
                   envelope.method == PROTO_METHOD_SCENE_NEAR
               ? cli_record_motion(client, envelope.method, &params, payload)
               : cli_record_change(client, envelope.method, &params, NULL,
                                   cli_record_add);
}

/* Write the entries that are whole; the rest waits for the next page. */
static int write_entries(struct pccd_client *client, struct cli_journal *journal)
{
    size_t at = 0;
    int status = 0;

    assert(journal->bytes <= journal->room);
    while (status == 0 && journal->bytes - at >= sizeof(struct proto_journal_entry)) {
        struct proto_journal_entry entry;

        memcpy(&entry, journal->entries + at, sizeof entry);
        if (entry.bytes < sizeof entry || entry.bytes % 8 != 0 ||
            entry.bytes > JOURNAL_BYTES) {
            status = PCCD_E_BADMSG;
        } else if (entry.bytes > journal->bytes - at) {
            break;
        } else {
            status = write_entry(client, journal->entries + at);
            at += entry.bytes;
        }
    }
    if (at > 0) { /* before the first entry there is no room for any */
        memmove(journal->entries, journal->entries + at, journal->bytes - at);
        journal->bytes -= at;
    }
    return status;
}

/* ---- pages ------------------------------------------------------------------------- */

static int append(struct cli_journal *journal, const uint8_t *from, uint64_t count)
{
    if (count > journal->room - journal->bytes) {
        size_t room = journal->bytes + count + count / 2;
        uint8_t *entries = realloc(journal->entries, room);

        if (entries == NULL) {
            return PCCD_E_NOMEM;
        }
        journal->entries = entries;
        journal->room = room;
    }
    memcpy(journal->entries + journal->bytes, from, count);
    journal->bytes += count;
    return 0;
}

static void stop_because(struct pccd_client *client, int status, const char *text)
{
    if (!client->recorder->has_ended) {
        char why[CLI_TEXT_BYTES];

        (void)snprintf(why, sizeof why, "a shared scene: %.400s", text);
        (void)cli_record_stop_because(client, status, why);
    }
}

void cli_journal_take(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_SCENE_JOURNAL_request *request = &call->params.SCENE_JOURNAL;
    const struct proto_SCENE_JOURNAL_result *result = &call->journal;
    struct cli_journal *journal = find(client, request->scene);
    int status = 0;

    if (journal == NULL || !cli_record_is_on(client)) {
        return;
    }
    journal->is_asked = false;
    if (call->status != 0) {
        stop_because(client, call->status, "the daemon has kept no journal of it");
        return;
    }
    if (request->stop || result->cursor != journal->cursor) {
        return; /* said once more, over another connection */
    }
    if (result->count > 0) {
        status = append(journal, cli_page_base(client, call->page) + result->offset,
                        result->count);
        journal->cursor += result->count;
    }
    status = status != 0 ? status : write_entries(client, journal);
    journal->is_due = journal->cursor < result->end;
    if (status != 0) {
        stop_because(client, status, proto_status_text(status));
    } else if (result->full && !journal->is_due) {
        stop_because(client, PCCD_E_LIMIT,
                     "more was done to it than its journal could hold until it was "
                     "fetched");
    }
}

static int ask(struct pccd_client *client, struct cli_journal *journal, bool stop,
               uint64_t deadline_ns, struct cli_call **call)
{
    const struct proto_SCENE_JOURNAL_request request = {
        .scene = journal->scene,
        .cursor = journal->cursor,
        .begin = journal->has_begun ? 0 : JOURNAL_BYTES,
        .stop = stop};
    int status = cli_call_send(client, PROTO_METHOD_SCENE_JOURNAL, &request,
                               CLI_SLOT_NONE, deadline_ns, call);

    journal->is_asked = status == 0;
    journal->has_begun = journal->has_begun || status == 0;
    return status;
}

void cli_journal_pump(struct pccd_client *client)
{
    struct cli_journal *journal =
        client->recorder != NULL ? client->recorder->journals : NULL;

    if (journal == NULL || !cli_record_is_on(client) || client->link.is_down ||
        client->link.is_recovering || client->ring.upload.base == NULL) {
        return;
    }
    for (; journal != NULL; journal = journal->next) {
        struct cli_call *call = NULL;

        if (!journal->is_due || journal->is_asked || !cli_pages_have_room(client) ||
            cli_call_inflight(client) >= PROTO_REPLIES_KEPT) {
            continue;
        }
        if (ask(client, journal, false, common_now_ns(), &call) == 0) {
            journal->is_due = false;
            cli_call_drop(client, call); /* its page is written when it comes */
        }
    }
}

/* A page, or the end of the journal; waits. */
static int ask_and_wait(struct pccd_client *client, struct cli_journal *journal,
                        bool stop, uint64_t deadline_ns)
{
    struct cli_call *call = NULL;
    int status = 0;

    while (status == 0 && journal->is_asked && !client->recorder->has_ended) {
        status = cli_progress(client, deadline_ns);
    }
    status = status != 0 ? status : ask(client, journal, stop, deadline_ns, &call);
    if (status != 0) {
        return status;
    }
    status = cli_call_wait(client, call, deadline_ns);
    if (status != 0) {
        cli_call_drop(client, call);
        return status;
    }
    cli_page_release(client, call->page);
    return cli_call_finish(client, call);
}

/* Write all that there is. */
static void settle(struct pccd_client *client, struct cli_journal *journal)
{
    uint64_t deadline_ns = cli_deadline(client, -1);
    int status = 0;

    do {
        if (client->dead || !cli_record_is_on(client)) {
            return;
        }
        status = ask_and_wait(client, journal, false, deadline_ns);
    } while (status == 0 && journal->is_due);
    if (status != 0) {
        stop_because(client, status, client->error);
    }
}

void cli_journal_settle(struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *journal = find(client, scene);

    if (journal != NULL) {
        settle(client, journal);
    }
}

/* ---- life -------------------------------------------------------------------------- */

static int refuse(struct pccd_client *client, int status, const char *text)
{
    stop_because(client, status, text);
    return status;
}

int cli_journal_begin(struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *made;
    int status = 0;

    if (!cli_record_is_on(client)) {
        return 0;
    }
    if (client->recorder->segments_max > 1) {
        return refuse(client, PCCD_E_STATE,
                      "it cannot be recorded in a ring of segments, only in one file");
    }
    made = calloc(1, sizeof *made);
    if (made == NULL) {
        return refuse(client, PCCD_E_NOMEM, "no memory for its journal");
    }
    made->scene = scene;
    made->next = client->recorder->journals;
    client->recorder->journals = made;
    if (client->ring.upload.base == NULL) {
        status = cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, cli_deadline(client, -1));
    }
    if (status != 0) {
        return refuse(client, status, client->error);
    }
    settle(client, made);
    return client->recorder->has_ended ? client->recorder->info.status : 0;
}

void cli_journal_end(struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *journal = find(client, scene);

    if (journal != NULL) {
        struct cli_journal **at = &client->recorder->journals;

        while (*at != journal) {
            at = &(*at)->next;
        }
        *at = journal->next;
        free(journal->entries);
        free(journal);
    }
}

void cli_journal_stop(struct pccd_client *client)
{
    struct cli_journal *journal;

    while ((journal = client->recorder->journals) != NULL) {
        settle(client, journal);
        if (!client->dead && client->owner == getpid()) {
            (void)ask_and_wait(client, journal, true, cli_deadline(client, -1));
        }
        cli_journal_end(client, journal->scene);
    }
}

void cli_journal_lost(struct pccd_client *client)
{
    if (client->recorder != NULL && client->recorder->journals != NULL &&
        cli_record_is_on(client)) {
        stop_because(client, PCCD_E_DISCONNECTED,
                     "its daemon was lost, and with it what others have done to it");
    }
}
