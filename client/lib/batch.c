/* batch.c - steps of many scenes by one request.
 *
 * Lay out the slot once: the table of scenes, the table of segments, the positions; each
 * step copies the tables there as they are.
 */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "step.h"

static_assert((int)PCCD_BATCH_X1 == PROTO_SEGMENT_X1 &&
                  (int)PCCD_BATCH_X0X1 == PROTO_SEGMENT_X0X1 &&
                  (int)PCCD_BATCH_RIGID == PROTO_SEGMENT_RIGID &&
                  (int)PCCD_BATCH_TURNING == PROTO_SEGMENT_TURNING,
              "a way is a kind of segment");

struct pccd_batch {
    struct pccd_client *client; /* NULL: it is closed */
    struct pccd_batch *next;    /* of the client's */
    uint32_t scene_count;
    uint32_t segment_count;
    uint32_t part_count;
    uint32_t slot;                    /* that is begun; CLI_SLOT_NONE: none */
    uint64_t slot_bytes;              /* tables and positions */
    struct proto_batch_scene *scenes; /* [scene_count] */
    uint32_t *joint_counts;           /* [scene_count]: of the table of each; 0: none */
    struct proto_segment *segments;   /* [segment_count] */
    uint32_t *segment_of;             /* [part_count]; NO_SEGMENT: nothing moves */
};

#define NO_SEGMENT UINT32_MAX

/* ---- what it is -------------------------------------------------------------------- */

static int check_part(struct pccd_client *client, const struct pccd_batch_part *parts,
                      uint32_t i)
{
    const struct pccd_batch_part *part = &parts[i];
    bool follows = i > 0 && parts[i - 1].scene == part->scene;

    if ((unsigned)part->way > PCCD_BATCH_TURNING ||
        (unsigned)part->format >= PCCD_FORMAT_COUNT) {
        return cli_fail(client, PCCD_E_INVAL, "part %u: unknown way %u or format %u", i,
                        (unsigned)part->way, (unsigned)part->format);
    }
    if (follows && (part->object == 0 || parts[i - 1].object == 0)) {
        return cli_fail(client, PCCD_E_INVAL,
                        "part %u: scene 0x%x stands still, and has another part", i,
                        part->scene);
    }
    if (part->object != 0 && part->count == 0) {
        return cli_fail(client, PCCD_E_INVAL, "part %u: no vertices", i);
    }
    return 0;
}

static int check_parts(struct pccd_client *client, const struct pccd_batch_part *parts,
                       uint32_t part_count, struct pccd_batch **batch)
{
    int status = 0;

    if (batch == NULL || parts == NULL || part_count == 0) {
        return cli_fail(client, PCCD_E_INVAL, "%s",
                        batch == NULL ? "batch is NULL" : "a batch of no parts");
    }
    if (part_count > PROTO_SEGMENTS_MAX) {
        return cli_fail(client, PCCD_E_LIMIT, "a batch has at most %u parts, not %u",
                        PROTO_SEGMENTS_MAX, part_count);
    }
    for (uint32_t i = 0; status == 0 && i < part_count; i++) {
        status = check_part(client, parts, i);
    }
    return status;
}

/* The entry of a part in both tables; where its positions are is not known yet. */
static void enter(struct pccd_batch *batch, const struct pccd_batch_part *parts,
                  uint32_t i)
{
    const struct pccd_batch_part *part = &parts[i];
    bool is_double = part->way >= PCCD_BATCH_RIGID;

    if (i == 0 || parts[i - 1].scene != part->scene) {
        batch->scenes[batch->scene_count++].scene = part->scene;
    }
    batch->segment_of[i] = NO_SEGMENT;
    if (part->object != 0) {
        batch->scenes[batch->scene_count - 1].segments++;
        batch->segment_of[i] = batch->segment_count;
        batch->segments[batch->segment_count++] = (struct proto_segment){
            .object = part->object,
            .kind = (uint16_t)part->way,
            .format = (uint16_t)(is_double ? PCCD_FORMAT_F64 : part->format),
            .first = part->first,
            .count = part->count};
    }
}

static uint64_t scenes_bytes(const struct pccd_batch *batch)
{
    return batch->scene_count * sizeof batch->scenes[0];
}

static uint64_t segments_bytes(const struct pccd_batch *batch)
{
    return batch->segment_count * sizeof batch->segments[0];
}

/* Positions behind the tables, in the order of the segments; the joints of a scene stand
 * where the first one that turns would have its positions. */
static void lay_out(struct pccd_batch *batch)
{
    uint64_t used =
        cli_round_up(scenes_bytes(batch) + segments_bytes(batch), CLI_PAYLOAD_ALIGN);
    struct proto_segment *segment = batch->segments;

    for (uint32_t i = 0; i < batch->scene_count; i++) {
        uint64_t joints_at = 0;

        for (uint32_t k = 0; k < batch->scenes[i].segments; k++, segment++) {
            if (segment->kind == PROTO_SEGMENT_TURNING && joints_at == 0) {
                joints_at = used;
                used += PROTO_JOINTS_BYTES(batch->joint_counts[i]);
            }
            segment->offset0 = joints_at;
            used = cli_segment_place(segment, used);
        }
    }
    batch->slot_bytes = used;
}

/* Take how many joints each scene has; parts turn on these alone. */
static int take_joints(struct pccd_batch *batch, const uint32_t *joint_counts,
                       uint32_t scene_count)
{
    const struct proto_segment *segment = batch->segments;

    if (joint_counts != NULL && scene_count != batch->scene_count) {
        return cli_fail(batch->client, PCCD_E_INVAL, "joints of %u scenes, there are %u",
                        scene_count, batch->scene_count);
    }
    for (uint32_t i = 0; i < batch->scene_count; i++) {
        uint32_t count = joint_counts != NULL ? joint_counts[i] : 0;

        batch->joint_counts[i] = count;
        for (uint32_t k = 0; k < batch->scenes[i].segments; k++, segment++) {
            if (segment->kind == PROTO_SEGMENT_TURNING &&
                (segment->first >= count || count > PROTO_JOINTS_MAX)) {
                return cli_fail(batch->client, PCCD_E_INVAL,
                                "object 0x%x of scene %u: joint %u of %u, from 0; %u at "
                                "most",
                                segment->object, i, segment->first, count,
                                PROTO_JOINTS_MAX);
            }
        }
    }
    return 0;
}

int pccd_batch_create(struct pccd_client *client, const struct pccd_batch_part *parts,
                      uint32_t part_count, struct pccd_batch **batch)
{
    return pccd_batch_create_turning(client, parts, part_count, NULL, 0, batch);
}

int pccd_batch_create_turning(struct pccd_client *client,
                              const struct pccd_batch_part *parts, uint32_t part_count,
                              const uint32_t *joint_counts, uint32_t scene_count,
                              struct pccd_batch **batch)
{
    struct pccd_batch *made;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = check_parts(client, parts, part_count, batch);
    if (status != 0) {
        return status;
    }
    made = calloc(1, sizeof *made);
    if (made != NULL) {
        made->scenes = calloc(part_count, sizeof *made->scenes);
        made->joint_counts = calloc(part_count, sizeof *made->joint_counts);
        made->segments = calloc(part_count, sizeof *made->segments);
        made->segment_of = calloc(part_count, sizeof *made->segment_of);
    }
    if (made == NULL || made->scenes == NULL || made->joint_counts == NULL ||
        made->segments == NULL || made->segment_of == NULL) {
        pccd_batch_destroy(made);
        return cli_fail(client, PCCD_E_NOMEM, "no memory for a batch of %u parts",
                        part_count);
    }
    made->client = client;
    made->next = client->batches;
    client->batches = made;
    made->part_count = part_count;
    made->slot = CLI_SLOT_NONE;
    for (uint32_t i = 0; i < part_count; i++) {
        enter(made, parts, i);
    }
    status = take_joints(made, joint_counts, scene_count);
    if (status != 0) {
        pccd_batch_destroy(made);
        return status;
    }
    lay_out(made);
    *batch = made;
    return 0;
}

void cli_batch_forget_all(struct pccd_client *client)
{
    for (; client->batches != NULL; client->batches = client->batches->next) {
        client->batches->client = NULL;
        client->batches->slot = CLI_SLOT_NONE; /* it goes with the ring */
    }
}

static struct pccd_client *client_of(const struct pccd_batch *batch)
{
    return batch != NULL ? batch->client : NULL;
}

/* As cli_enter, of a batch. */
static struct cli_turn enter_batch(const struct pccd_batch *batch)
{
    if (batch != NULL && batch->client == NULL) {
        return (struct cli_turn){.status = cli_fail(NULL, PCCD_E_DISCONNECTED,
                                                    "the batch's client is closed")};
    }
    return cli_enter(client_of(batch));
}
#define ENTER_BATCH_OR_RETURN(batch)                                                     \
    CLI_TURN cli_turn = enter_batch(batch);                                              \
    if (cli_turn.status != 0) {                                                          \
        return cli_turn.status;                                                          \
    }

void pccd_batch_destroy(struct pccd_batch *batch)
{
    CLI_TURN cli_turn = cli_enter_late(client_of(batch));
    struct pccd_batch **place;

    if (batch == NULL) {
        return;
    }
    if (batch->client != NULL) {
        pccd_batch_abort(batch);
        place = &batch->client->batches;
        while (*place != batch) {
            place = &(*place)->next;
        }
        *place = batch->next;
    }
    free(batch->scenes);
    free(batch->joint_counts);
    free(batch->segments);
    free(batch->segment_of);
    free(batch);
}

uint32_t pccd_batch_scenes(const struct pccd_batch *batch)
{
    return batch != NULL ? batch->scene_count : 0;
}

/* ---- submit ------------------------------------------------------------------------ */

/* Copies of the tables, if another daemon may have to be told what the slot moved. */
static int keep_tables(struct pccd_batch *batch, struct cli_slot *own)
{
    int status = cli_slot_room(own, batch->segment_count, batch->scene_count);

    if (status != 0) {
        return cli_fail(batch->client, status, "no memory for %u segments",
                        batch->segment_count);
    }
    memcpy(own->segments, batch->segments, segments_bytes(batch));
    memcpy(own->scenes, batch->scenes, scenes_bytes(batch));
    return 0;
}

/* Write the heads of the tables of joints. */
static void write_heads(const struct pccd_batch *batch, uint8_t *payload)
{
    const struct proto_segment *segment = batch->segments;

    for (uint32_t i = 0; i < batch->scene_count; i++) {
        const struct proto_joints head = {.count = batch->joint_counts[i]};

        for (uint32_t k = 0; k < batch->scenes[i].segments; k++, segment++) {
            if (segment->kind == PROTO_SEGMENT_TURNING) {
                memcpy(payload + segment->offset0, &head, sizeof head);
            }
        }
    }
}

/* A slot with the tables in it. */
static int begin(struct pccd_batch *batch)
{
    struct pccd_client *client = batch->client;
    struct cli_slot *own;
    uint32_t slot = CLI_SLOT_NONE;
    uint8_t *payload;
    int status;

    if (batch->slot != CLI_SLOT_NONE) {
        return cli_fail(client, PCCD_E_STATE, "the batch is begun: commit or abort it");
    }
    status = cli_step_slot(client, batch->slot_bytes, &slot);
    if (status != 0) {
        return status;
    }
    own = &client->ring.slots[slot];
    if (client->keeps) {
        status = keep_tables(batch, own);
    }
    if (status != 0) {
        cli_slot_abort(&client->ring, slot);
        return status;
    }
    payload = cli_slot_payload(&client->ring, slot);
    memcpy(payload, batch->scenes, scenes_bytes(batch));
    memcpy(payload + scenes_bytes(batch), batch->segments, segments_bytes(batch));
    write_heads(batch, payload);
    own->scene = 0;
    own->scene_count = batch->scene_count;
    own->segment_count = own->segment_max = batch->segment_count;
    own->used_bytes = own->limit_bytes = batch->slot_bytes;
    batch->slot = slot;
    return 0;
}

/* Return the segment that part i moves; NULL: nothing. */
static const struct proto_segment *segment_of(const struct pccd_batch *batch, uint32_t i)
{
    return batch->segment_of[i] != NO_SEGMENT ? &batch->segments[batch->segment_of[i]]
                                              : NULL;
}

/* Return whether a segment brings both ends. */
static bool has_both(const struct proto_segment *segment)
{
    return segment->kind == PROTO_SEGMENT_X0X1 || segment->kind == PROTO_SEGMENT_RIGID;
}

int pccd_batch_begin(struct pccd_batch *batch, void **x0, void **x1)
{
    uint8_t *payload;
    int status;

    ENTER_BATCH_OR_RETURN(batch);
    if (x1 == NULL) {
        return cli_fail(batch->client, PCCD_E_INVAL, "x1 is NULL");
    }
    for (uint32_t i = 0; x0 == NULL && i < batch->segment_count; i++) {
        if (has_both(&batch->segments[i])) {
            return cli_fail(batch->client, PCCD_E_INVAL,
                            "x0 is NULL, and a part has both ends");
        }
    }
    status = begin(batch);
    if (status != 0) {
        return status;
    }
    payload = cli_slot_payload(&batch->client->ring, batch->slot);
    for (uint32_t i = 0; i < batch->part_count; i++) {
        const struct proto_segment *segment = segment_of(batch, i);

        x1[i] = segment == NULL ? NULL
                : segment->kind == PROTO_SEGMENT_TURNING
                    ? payload + segment->offset0 + sizeof(struct proto_joints)
                    : payload + segment->offset1;
        if (x0 != NULL) {
            x0[i] =
                segment != NULL && has_both(segment) ? payload + segment->offset0 : NULL;
        }
    }
    return 0;
}

void pccd_batch_abort(struct pccd_batch *batch)
{
    CLI_TURN cli_turn = cli_enter_late(client_of(batch));

    if (batch == NULL || batch->slot == CLI_SLOT_NONE) {
        return;
    }
    if (!cli_is_copy(batch->client)) {
        cli_slot_abort(&batch->client->ring, batch->slot);
    }
    batch->slot = CLI_SLOT_NONE;
}

int pccd_batch_commit(struct pccd_batch *batch, const struct pccd_step_settings *settings,
                      uint64_t *step)
{
    union cli_params message;
    struct pccd_client *client;
    uint32_t slot;
    int status;

    ENTER_BATCH_OR_RETURN(batch);
    client = batch->client;
    if (batch->slot == CLI_SLOT_NONE) {
        return cli_fail(client, PCCD_E_STATE, "the batch is not begun");
    }
    status = step == NULL ? cli_fail(client, PCCD_E_INVAL, "step is NULL")
                          : cli_step_describe(client, PROTO_METHOD_BATCH_SUBMIT, settings,
                                              0, &message);
    status = status != 0 ? status : cli_step_check(client);
    if (status != 0) {
        pccd_batch_abort(batch);
        return status;
    }
    slot = batch->slot;
    batch->slot = CLI_SLOT_NONE;
    return cli_step_send(client, PROTO_METHOD_BATCH_SUBMIT, &message, slot, step);
}

/* Copy what every part moves. */
static int copy(struct pccd_batch *batch, const void *const *x0, const void *const *x1)
{
    uint8_t *payload = cli_slot_payload(&batch->client->ring, batch->slot);
    const void *table = NULL; /* of joints that was copied last, */
    uint64_t table_at = 0;    /* and where: one of each scene that has joints */

    for (uint32_t i = 0; i < batch->part_count; i++) {
        const struct proto_segment *segment = segment_of(batch, i);
        const void *start = x0 != NULL ? x0[i] : NULL;

        if (segment == NULL) {
            continue;
        }
        if (x1[i] == NULL || (has_both(segment) && start == NULL)) {
            return cli_fail(batch->client, PCCD_E_INVAL, "part %u: %s is NULL", i,
                            x1[i] == NULL ? "x1" : "x0");
        }
        if (segment->kind == PROTO_SEGMENT_TURNING) {
            struct proto_joints head;
            uint8_t *to = payload + segment->offset0;
            size_t bytes;

            memcpy(&head, to, sizeof head);
            bytes = head.count * sizeof(struct pccd_joint);
            if (segment->offset0 != table_at) {
                memcpy(to + sizeof head, x1[i], bytes);
                table = x1[i];
                table_at = segment->offset0;
            } else if (x1[i] != table && memcmp(x1[i], table, bytes) != 0) {
                return cli_fail(batch->client, PCCD_E_INVAL,
                                "part %u: its table of joints differs from one "
                                "before; a scene has one table",
                                i);
            }
        } else {
            cli_segment_write(payload, segment, start, x1[i]);
        }
    }
    return 0;
}

int pccd_batch_submit(struct pccd_batch *batch, const void *const *x0,
                      const void *const *x1, const struct pccd_step_settings *settings,
                      uint64_t *step)
{
    int status;

    ENTER_BATCH_OR_RETURN(batch);
    if (step == NULL || (x1 == NULL && batch->segment_count > 0)) {
        return cli_fail(batch->client, PCCD_E_INVAL, "%s is NULL",
                        step == NULL ? "step" : "x1");
    }
    status = begin(batch);
    if (status != 0) {
        return status;
    }
    status = copy(batch, x0, x1);
    if (status != 0) {
        pccd_batch_abort(batch);
        return status;
    }
    return pccd_batch_commit(batch, settings, step);
}

/* ---- answers ----------------------------------------------------------------------- */

int pccd_batch_poll(struct pccd_client *client, struct pccd_batch_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return cli_answer_poll(client, true, answer);
}

int pccd_batch_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
                    struct pccd_batch_answer *answer)
{
    CLI_ENTER_OR_RETURN(client);
    return cli_answer_wait(client, step, true, timeout_ms, answer);
}

int pccd_batch_step(struct pccd_batch *batch, const void *const *x0,
                    const void *const *x1, const struct pccd_step_settings *settings,
                    struct pccd_batch_answer *answer)
{
    uint64_t step = 0;
    int status;

    ENTER_BATCH_OR_RETURN(batch);
    status = cli_answer_check(batch->client, answer, true);
    if (status == 0) {
        status = pccd_batch_submit(batch, x0, x1, settings, &step);
    }
    return status != 0 ? status : cli_answer_finish(batch->client, step, true, answer);
}

/* The records of a scene, which lie as far from the answers as both are said to be. */
static const void *records_of(const struct pccd_batch_answer *answer, uint64_t i)
{
    const struct pccd_scene_answer *scene;

    if (answer == NULL || answer->scenes == NULL || i >= answer->count) {
        return NULL;
    }
    scene = &answer->scenes[i];
    return scene->count > 0
               ? (const uint8_t *)answer->scenes - answer->offset + scene->offset
               : NULL;
}

const struct pccd_contact *pccd_batch_contacts(const struct pccd_batch_answer *answer,
                                               uint64_t i)
{
    return answer != NULL && answer->mode != PCCD_MODE_PAIRS ? records_of(answer, i)
                                                             : NULL;
}

const struct pccd_pair *pccd_batch_pairs(const struct pccd_batch_answer *answer,
                                         uint64_t i)
{
    return answer != NULL && answer->mode == PCCD_MODE_PAIRS ? records_of(answer, i)
                                                             : NULL;
}

void pccd_batch_release(struct pccd_client *client, struct pccd_batch_answer *answer)
{
    CLI_TURN cli_turn = cli_enter_late(client);

    if (client == NULL || answer == NULL) {
        return;
    }
    cli_answer_release(client, answer->reserved);
    answer->scenes = NULL;
    answer->count = 0;
}
