/* recorder_shared.c - shared scenes, in recordings. */
#include "recorder_shared.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "attach.h"
#include "journal.h"
#include "payload.h"
#include "rpc.h"

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

static int write_object(struct pccd_client *client, uint32_t scene,
                        const struct proto_journal_entry *entry, const uint8_t *at,
                        uint64_t bytes)
{
    struct proto_journal_object object;
    struct record_guest guest = {.scene = scene, .object = entry->object};
    struct record_part parts[2] = {{&guest, sizeof guest}};
    uint64_t need;

    if (bytes < sizeof object) {
        return PCCD_E_BADMSG;
    }
    memcpy(&object, at, sizeof object);
    need = object.vertex_count * sizeof(double[3]) +
           object.triangle_count * sizeof(uint32_t[3]);
    if (need > bytes - sizeof object || entry->object == 0) {
        return PCCD_E_BADMSG;
    }
    guest.vertex_count = object.vertex_count;
    guest.triangle_count = object.triangle_count;
    parts[1] = (struct record_part){at + sizeof object, need};
    return cli_record_add(client, RECORD_GUEST, parts, 2);
}

static int write_gone(struct pccd_client *client, uint32_t scene, uint32_t object)
{
    const struct record_gone gone = {.scene = scene, .object = object};

    return cli_record_add(client, RECORD_OBJECT_GONE,
                          &(struct record_part){&gone, sizeof gone}, 1);
}

static int write_filter(struct pccd_client *client, uint32_t scene, uint32_t object,
                        const uint8_t *at, uint64_t bytes)
{
    uint64_t words[COMMON_WORDS] = {0};
    struct common_attributes told = COMMON_ATTRIBUTES_AT_FIRST;
    struct record_filter filter;

    bytes = bytes < sizeof words ? bytes : sizeof words; /* a newer daemon tells more */
    memcpy(words, at, bytes);
    common_attributes_unpack(&told, words, bytes / sizeof words[0]);
    record_filter_make(&filter, scene, object, PCCD_OBJECT_ALL, &told);
    if (!common_attributes_are_thick(&told) &&
        (client->recorder->writer.features & RECORD_FEATURE_THICK) == 0) {
        filter.what &= ~COMMON_OBJECT_THICK; /* programs of before can read the file */
    }
    return cli_record_add(client, RECORD_FILTER,
                          &(struct record_part){&filter, sizeof filter}, 1);
}

static int write_pairs(struct pccd_client *client, uint32_t scene, const uint8_t *at,
                       uint64_t bytes)
{
    struct proto_journal_pairs from;
    struct record_pairs pairs = {.scene = scene};
    struct record_part parts[2] = {{&pairs, sizeof pairs}};

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    if ((bytes - sizeof from) / sizeof(uint32_t[2]) < from.count) {
        return PCCD_E_BADMSG;
    }
    pairs.ignored = from.ignored != 0;
    pairs.count = from.count;
    parts[1] = (struct record_part){at + sizeof from, from.count * sizeof(uint32_t[2])};
    return cli_record_add(client, RECORD_PAIRS, parts, 2);
}

static int write_step(struct pccd_client *client, uint32_t scene, const uint8_t *at,
                      uint64_t bytes)
{
    struct proto_journal_step from;
    struct record_frame frame = {.scene = scene};
    struct record_part parts[2] = {{&frame, sizeof frame}};
    int status;

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    frame.step = from.step;
    frame.segment_count = from.segments;
    frame.mode = from.mode;
    frame.method = from.method;
    frame.threads = from.threads;
    frame.tolerance = from.tolerance;
    parts[1] = (struct record_part){at + sizeof from, bytes - sizeof from};
    client->recorder->segment_frames += from.step != 0;
    from.tuning[sizeof from.tuning - 1] = '\0';
    status = cli_record_tuning(client, from.tuning);
    return status != 0
               ? status
               : cli_record_add(client, from.step != 0 ? RECORD_FRAME : RECORD_MOVE,
                                parts, parts[1].bytes > 0 ? 2 : 1);
}

/* Of the object behind them. */
static int write_radii(struct pccd_client *client, const uint8_t *at, uint64_t bytes)
{
    struct proto_journal_radii from;
    struct record_radii radii = {.vertex_count = 0};
    struct record_part parts[2] = {{&radii, sizeof radii}};

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    if ((bytes - sizeof from) / sizeof(double) < from.vertex_count) {
        return PCCD_E_BADMSG;
    }
    radii.vertex_count = from.vertex_count;
    parts[1] = (struct record_part){at + sizeof from, from.vertex_count * sizeof(double)};
    return cli_record_add(client, RECORD_RADII, parts, 2);
}

/* The same of its edges and points. */
static int write_free(struct pccd_client *client, const uint8_t *at, uint64_t bytes)
{
    struct proto_journal_free from;
    struct record_free free = {.vertex_count = 0};
    struct record_part parts[2] = {{&free, sizeof free}};
    uint64_t words;

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    words = 2 * (uint64_t)from.edge_count + from.point_count;
    if ((bytes - sizeof from) / sizeof(uint32_t) < words) {
        return PCCD_E_BADMSG;
    }
    free.vertex_count = from.vertex_count;
    free.edge_count = from.edge_count;
    free.point_count = from.point_count;
    parts[1] = (struct record_part){at + sizeof from, words * sizeof(uint32_t)};
    return cli_record_add(client, RECORD_FREE, parts, 2);
}

/* Of the step behind it. */
static int write_separation(struct pccd_client *client, const uint8_t *at, uint64_t bytes)
{
    struct proto_journal_separation from;

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    return cli_record_separation(client, from.separation, from.approach);
}

/* This client has asked what is near. */
static int write_near(struct pccd_client *client, uint32_t scene, const uint8_t *at,
                      uint64_t bytes)
{
    struct proto_journal_near from;
    struct record_near near = {.scene = scene};
    struct record_part parts[2] = {{&near, sizeof near}};
    int status;

    if (bytes < sizeof from) {
        return PCCD_E_BADMSG;
    }
    memcpy(&from, at, sizeof from);
    near.step = from.step;
    near.segment_count = from.segments;
    near.what = from.what;
    near.end = from.end;
    near.method = from.method;
    near.threads = from.threads;
    near.objects[0] = from.object_a;
    near.objects[1] = from.object_b;
    near.distance = from.distance;
    near.gap = from.gap;
    parts[1] = (struct record_part){at + sizeof from, bytes - sizeof from};
    from.tuning[sizeof from.tuning - 1] = '\0';
    status = cli_record_tuning(client, from.tuning);
    status = status != 0 ? status : cli_record_tells(client, from.tells_crossings != 0);
    return status != 0
               ? status
               : cli_record_add(client, RECORD_NEAR, parts, parts[1].bytes > 0 ? 2 : 1);
}

/* A whole entry of `bytes` bytes. */
static int write_entry(struct pccd_client *client, uint32_t scene, const uint8_t *at)
{
    struct proto_journal_entry entry;
    uint64_t bytes;

    memcpy(&entry, at, sizeof entry);
    at += sizeof entry;
    assert(entry.bytes >= sizeof entry); /* judged by write_entries */
    bytes = entry.bytes - sizeof entry;
    switch (entry.kind) {
    case PROTO_JOURNAL_OBJECT:
        return write_object(client, scene, &entry, at, bytes);
    case PROTO_JOURNAL_GONE:
        return write_gone(client, scene, entry.object);
    case PROTO_JOURNAL_FILTER:
        return write_filter(client, scene, entry.object, at, bytes);
    case PROTO_JOURNAL_PAIRS:
        return write_pairs(client, scene, at, bytes);
    case PROTO_JOURNAL_STEP:
        return write_step(client, scene, at, bytes);
    case PROTO_JOURNAL_NEAR:
        return write_near(client, scene, at, bytes);
    case PROTO_JOURNAL_RADII:
        return write_radii(client, at, bytes);
    case PROTO_JOURNAL_FREE:
        return write_free(client, at, bytes);
    case PROTO_JOURNAL_SEPARATION:
        return write_separation(client, at, bytes);
    case PROTO_JOURNAL_TELLS:
        return cli_record_tells(client, true);
    default:
        return 0; /* of a newer daemon, which says nothing that must be known */
    }
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
            status = write_entry(client, journal->scene, journal->entries + at);
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

static int ask(struct pccd_client *client, struct cli_journal *journal, uint64_t begin,
               bool stop, uint64_t deadline_ns, struct cli_call **call)
{
    const struct proto_SCENE_JOURNAL_request request = {
        .scene = journal->scene, .cursor = journal->cursor, .begin = begin, .stop = stop};
    int status = cli_call_send(client, PROTO_METHOD_SCENE_JOURNAL, &request,
                               CLI_SLOT_NONE, deadline_ns, call);

    journal->is_asked = status == 0;
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

        if (!journal->is_due || journal->is_asked || !cli_page_has_room(client) ||
            cli_call_inflight(client) >= PROTO_REPLIES_KEPT) {
            continue;
        }
        if (ask(client, journal, 0, false, common_now_ns(), &call) == 0) {
            journal->is_due = false;
            cli_call_drop(client, call); /* its page is written when it comes */
        }
    }
}

/* One page, or what `begin` and `stop` say; waits. */
static int ask_and_wait(struct pccd_client *client, struct cli_journal *journal,
                        uint64_t begin, bool stop, uint64_t deadline_ns)
{
    struct cli_call *call = NULL;
    int status = 0;

    while (status == 0 && journal->is_asked && !client->recorder->has_ended) {
        status = cli_progress(client, deadline_ns);
    }
    status = status != 0 ? status : ask(client, journal, begin, stop, deadline_ns, &call);
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

static int settle(struct pccd_client *client, struct cli_journal *journal,
                  uint64_t deadline_ns)
{
    int status = 0;

    do {
        status = ask_and_wait(client, journal, 0, false, deadline_ns);
    } while (status == 0 && journal->is_due && !client->recorder->has_ended);
    return status;
}

static bool can_ask(const struct pccd_client *client)
{
    return cli_record_is_on(client) && !client->dead;
}

void cli_journal_settle(struct pccd_client *client, uint32_t scene)
{
    uint64_t deadline_ns = cli_deadline(client, -1);

    for (struct cli_journal *journal =
             client->recorder != NULL ? client->recorder->journals : NULL;
         journal != NULL; journal = journal->next) {
        int status = (scene == 0 || journal->scene == scene) && can_ask(client)
                         ? settle(client, journal, deadline_ns)
                         : 0;

        if (status != 0) {
            stop_because(client, status, client->error);
        }
    }
}

/* ---- life -------------------------------------------------------------------------- */

static int check(struct pccd_client *client)
{
    if ((client->link.features & PROTO_FEATURE_JOURNAL) == 0) {
        stop_because(client, PCCD_E_VERSION,
                     "the daemon is too old to tell what others do to it");
        return PCCD_E_VERSION;
    }
    if (client->recorder->segments_max > 1) {
        stop_because(client, PCCD_E_STATE,
                     "it cannot be recorded in a ring of segments, only in one file");
        return PCCD_E_STATE;
    }
    return 0;
}

int cli_journal_begin(struct pccd_client *client, uint32_t scene)
{
    uint64_t deadline_ns = cli_deadline(client, -1);
    struct cli_journal *made;
    int status;

    if (!cli_record_is_on(client)) {
        return 0;
    }
    status = check(client);
    if (status != 0) {
        return status;
    }
    made = calloc(1, sizeof *made);
    if (made == NULL) {
        stop_because(client, PCCD_E_NOMEM, "no memory for its journal");
        return PCCD_E_NOMEM;
    }
    made->scene = scene;
    made->next = client->recorder->journals;
    client->recorder->journals = made;
    status = client->ring.upload.base != NULL
                 ? 0
                 : cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, deadline_ns);
    status = status != 0 ? status
                         : ask_and_wait(client, made, JOURNAL_BYTES, false, deadline_ns);
    status = status == 0 && made->is_due ? settle(client, made, deadline_ns) : status;
    if (status != 0) {
        stop_because(client, status, client->error);
    }
    return client->recorder->has_ended ? client->recorder->info.status : 0;
}

static void forget(struct cli_recorder *recorder, struct cli_journal *journal)
{
    struct cli_journal **at = &recorder->journals;

    while (*at != journal) {
        at = &(*at)->next;
    }
    *at = journal->next;
    free(journal->entries);
    free(journal);
}

void cli_journal_end(struct pccd_client *client, uint32_t scene)
{
    struct cli_journal *journal = find(client, scene);

    if (journal != NULL) {
        forget(client->recorder, journal);
    }
}

void cli_journal_stop(struct pccd_client *client)
{
    uint64_t deadline_ns = cli_deadline(client, -1);

    cli_journal_settle(client, 0);
    while (client->recorder->journals != NULL) {
        struct cli_journal *journal = client->recorder->journals;

        if (!client->dead && client->owner == getpid()) {
            (void)ask_and_wait(client, journal, 0, true, deadline_ns);
        }
        forget(client->recorder, journal);
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
