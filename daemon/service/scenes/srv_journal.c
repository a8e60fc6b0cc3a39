/* srv_journal.c - what is done to a shared scene, written down for a session. */
#include "srv_journal.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "held.h"
#include "invariant.h"
#include "member.h"
#include "runners.h"
#include "service.h"
#include "session.h"
#include "staging.h"

struct srv_journal_entry {
    struct srv_journal_entry *next;
    uint64_t bytes;
    uint8_t data[];
};

/* ---- what is kept ------------------------------------------------------------------ */

static uint64_t kept_bytes(const struct srv_journal *journal)
{
    return journal->end - journal->begin;
}

/* A request of so many encoded bytes, and room for `bytes` of payload, zeros; NULL: it is
 * full. */
static uint8_t *add_entry(struct srv_journal *journal,
                          const struct proto_encoder *message, uint64_t bytes)
{
    const struct proto_journal_entry head = {
        .bytes = PROTO_JOURNAL_PAYLOAD(message->bytes) + (bytes + 7) / 8 * 8,
        .message_bytes = (uint32_t)message->bytes};
    if (head.bytes > journal->bytes_max - kept_bytes(journal)) {
        journal->status = PCCD_E_LIMIT;
        return NULL;
    }
    struct srv_journal_entry *entry = calloc(1, sizeof *entry + head.bytes);
    if (entry == NULL) {
        journal->status = PCCD_E_NOMEM;
        return NULL;
    }
    entry->bytes = head.bytes;
    memcpy(entry->data, &head, sizeof head);
    memcpy(entry->data + sizeof head, message->data, message->bytes);
    if (journal->last != NULL) {
        journal->last->next = entry;
    } else {
        journal->first = entry;
    }
    journal->last = entry;
    journal->end += head.bytes;
    return entry->data + PROTO_JOURNAL_PAYLOAD(message->bytes);
}

#define REQUESTS(X)                                                                      \
    X(SCENE_ADD)                                                                         \
    X(SCENE_REMOVE) X(OBJECT_SET) X(SCENE_IGNORE) X(FRAME_SUBMIT) X(SCENE_NEAR)
#define MEMBER(ID) struct proto_##ID##_request ID;
#define HAS_SCENE_FIRST(ID)                                                              \
    static_assert(offsetof(struct proto_##ID##_request, scene) == 0, #ID);
/* Each begins with the handle of its scene. */
union params {
    uint32_t scene;
    REQUESTS(MEMBER)
};
REQUESTS(HAS_SCENE_FIRST)

/* The same of a request that is to be encoded, with this session's handle. */
static uint8_t *add_request(struct srv_journal *journal, int method, const void *request,
                            uint64_t bytes)
{
    struct proto_encoder *encoder =
        srv_workspace_of_thread(journal->member->session->service->workspaces)->encoder;
    union params params;
    if (journal->status != 0) {
        return NULL;
    }
    memcpy(&params, request, proto_messages[method].request.struct_bytes);
    params.scene = journal->member->handle;
    int status = proto_encode_request(encoder, 0, method, &params);
    PCCD_ASSERT(status == 0); /* it has come as a message */
    return add_entry(journal, encoder, bytes);
}

/* A request with what its slot held. */
static void add_motion(struct srv_journal *journal, int method, const void *request,
                       const struct srv_sent *sent)
{
    journal->status = journal->status != 0 ? journal->status : sent->status;
    uint8_t *to = add_request(journal, method, request, sent->bytes);
    if (to != NULL && sent->bytes > 0) {
        memcpy(to, sent->slot, sent->bytes);
    }
}

void srv_journal_forget(struct srv_journal *journal, uint64_t position)
{
    srv_assert_compute();
    while (journal->first != NULL && journal->begin + journal->first->bytes <= position) {
        struct srv_journal_entry *entry = journal->first;
        journal->begin += entry->bytes;
        journal->first = entry->next;
        free(entry);
    }
    if (journal->first == NULL) {
        journal->last = NULL;
    }
}

void srv_journal_copy(const struct srv_journal *journal, uint64_t position,
                      uint64_t bytes, uint8_t *to)
{
    const struct srv_journal_entry *entry = journal->first;
    uint64_t at = journal->begin;
    PCCD_ASSERT(position >= journal->begin && position + bytes <= journal->end);
    while (bytes > 0) {
        uint64_t from = position - at;
        if (from < entry->bytes) {
            uint64_t part = entry->bytes - from < bytes ? entry->bytes - from : bytes;
            memcpy(to, entry->data + from, part);
            to += part;
            position += part;
            bytes -= part;
        }
        at += entry->bytes;
        entry = entry->next;
    }
}

void srv_journal_end(struct srv_scene *scene, struct srv_member *member)
{
    srv_assert_compute();
    struct srv_journal *journal = member->journal;
    struct srv_journal **at = &scene->journals;
    if (journal == NULL) {
        return;
    }
    while (*at != journal) {
        at = &(*at)->next;
    }
    *at = journal->next;
    member->journal = NULL;
    srv_journal_forget(journal, UINT64_MAX);
    free(journal);
    if (scene->journals == NULL) {
        srv_sent_end(&scene->sent);
    }
}

/* ---- objects ----------------------------------------------------------------------- */

/* `count` items of an array, which is NULL if there are none. Returns what is behind. */
static uint8_t *put(uint8_t *to, const void *items, uint64_t count, size_t item_bytes)
{
    if (count > 0) {
        memcpy(to, items, count * item_bytes);
    }
    return to + count * item_bytes;
}

static void note_object(struct srv_journal *journal, const struct srv_scene *scene,
                        const struct srv_placed *placed)
{
    const struct proto_SCENE_ADD_request add = {.want = placed->handle};
    const struct eng_mesh *mesh = eng_scene_mesh(scene->engine, placed->engine_idx);
    const double *radii = eng_mesh_radii(mesh);
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    const struct proto_journal_shape shape = {.vertex_count = info.vertex_count,
                                              .radius_count =
                                                  radii != NULL ? info.vertex_count : 0,
                                              .triangle_count = info.triangle_count,
                                              .edge_count = info.free_edge_count,
                                              .point_count = info.free_point_count};
    uint8_t *to = add_request(journal, PROTO_METHOD_SCENE_ADD, &add,
                              sizeof shape + shape.vertex_count * sizeof(double[3]) +
                                  shape.radius_count * sizeof(double) +
                                  shape.triangle_count * sizeof(uint32_t[3]) +
                                  shape.edge_count * sizeof(uint32_t[2]) +
                                  shape.point_count * sizeof(uint32_t));
    if (to == NULL) {
        return;
    }
    to = put(to, &shape, 1, sizeof shape);
    to = put(to, eng_mesh_vertices(mesh), shape.vertex_count, sizeof(double[3]));
    to = put(to, radii, shape.radius_count, sizeof(double));
    uint32_t(*triangles)[3] = (uint32_t(*)[3])(void *)to;
    uint32_t(*edges)[2] = (uint32_t(*)[2])(void *)(triangles + shape.triangle_count);
    eng_mesh_get_corners(mesh, triangles);
    if (shape.edge_count + shape.point_count > 0) {
        eng_mesh_get_free(mesh, edges, (uint32_t *)(void *)(edges + shape.edge_count));
    }
}

void srv_journal_add(struct srv_scene *scene, const struct srv_placed *placed)
{
    srv_assert_compute();
    for (struct srv_journal *journal = scene->journals; journal != NULL;
         journal = journal->next) {
        note_object(journal, scene, placed);
    }
}

void srv_journal_gone(struct srv_scene *scene, uint32_t object)
{
    const struct proto_SCENE_REMOVE_request gone = {.object = object};
    srv_journal_note(scene, PROTO_METHOD_SCENE_REMOVE, &gone);
}

void srv_journal_note(struct srv_scene *scene, int method, const void *request)
{
    srv_assert_compute();
    for (struct srv_journal *journal = scene->journals; journal != NULL;
         journal = journal->next) {
        (void)add_request(journal, method, request, 0);
    }
}

/* ---- steps ------------------------------------------------------------------------- */

void srv_journal_open(struct srv_scene *scene, uint32_t segments)
{
    srv_assert_compute();
    uint64_t segments_max = segments;
    uint64_t bytes_max = 0;
    for (const struct srv_held_frame *held = scene->held; held != NULL;
         held = held->next) {
        segments_max += held->submit.segments;
    }
    for (const struct srv_journal *journal = scene->journals; journal != NULL;
         journal = journal->next) {
        uint64_t left =
            journal->status == 0 ? journal->bytes_max - kept_bytes(journal) : 0;
        bytes_max = left > bytes_max ? left : bytes_max;
    }
    if (scene->journals != NULL) {
        srv_sent_begin(&scene->sent, segments_max, bytes_max);
    }
}

/* The number that the frame has to this session, which has held it; 0: it has none. */
static uint64_t number_of_held(const struct srv_held_frame *held,
                               const struct srv_member *member)
{
    while (held != NULL && held->member != member) {
        held = held->next;
    }
    return held != NULL && held->error.code == 0 ? held->submit.step : 0;
}

void srv_journal_step(struct srv_scene *scene,
                      const struct proto_FRAME_SUBMIT_request *submit,
                      const struct srv_member *member, const struct srv_held_frame *taken)
{
    srv_assert_compute();
    struct proto_FRAME_SUBMIT_request copy = *submit;
    copy.slot = 0; /* the payload has it all */
    copy.seq = 0;
    copy.segments = scene->sent.segments;
    for (struct srv_journal *journal = scene->journals; journal != NULL;
         journal = journal->next) {
        copy.step = submit->place               ? 0
                    : journal->member == member ? submit->step
                                                : number_of_held(taken, journal->member);
        add_motion(journal, PROTO_METHOD_FRAME_SUBMIT, &copy, &scene->sent);
    }
    srv_sent_end(&scene->sent);
}

void srv_journal_near(struct srv_scene *scene,
                      const struct proto_SCENE_NEAR_request *near,
                      const struct srv_member *member)
{
    srv_assert_compute();
    struct proto_SCENE_NEAR_request copy = *near;
    if (near->segments == 0) { /* no staging was opened */
        srv_sent_end(&scene->sent);
    }
    copy.slot = 0;
    copy.seq = 0;
    copy.segments = scene->sent.segments;
    const struct proto_FRAME_SUBMIT_request moved = {.segments = copy.segments};
    for (struct srv_journal *journal = scene->journals; journal != NULL;
         journal = journal->next) {
        if (journal->member == member) {
            add_motion(journal, PROTO_METHOD_SCENE_NEAR, &copy, &scene->sent);
        } else if (near->segments > 0) {
            add_motion(journal, PROTO_METHOD_FRAME_SUBMIT, &moved, &scene->sent);
        }
    }
    srv_sent_end(&scene->sent);
}

/* ---- the beginning ----------------------------------------------------------------- */

static void note_attributes(struct srv_journal *journal, const struct srv_placed *placed)
{
    const struct common_attributes *is = &placed->attributes;
    struct proto_OBJECT_SET_request set = {.object = placed->handle,
                                           .what = COMMON_OBJECT_KNOWN};
    if (!common_attributes_are_thick(is)) {
        set.what &= ~COMMON_OBJECT_THICK; /* a recording that needs no reader of these */
    }
    COMMON_ATTRIBUTES_COPY(&set, is);
    if (placed->name != NULL) {
        set.has_name = true;
        (void)snprintf(set.name, sizeof set.name, "%s", placed->name);
    }
    if (set.has_name || !common_attributes_are_at_first(is)) {
        (void)add_request(journal, PROTO_METHOD_OBJECT_SET, &set, 0);
    }
}

/* All pairs of which something is said: by index in the engine, to be named by handle. */
static void note_pairs(struct srv_journal *journal, const struct eng_scene *engine)
{
    uint32_t from = 0;
    uint32_t pair[2];
    bool ignored;
    double clearance;
    while (eng_scene_next_pair(engine, &from, pair, &ignored, &clearance)) {
        const struct proto_SCENE_IGNORE_request ignore = {
            .a = eng_scene_object_id(engine, pair[0]),
            .b = eng_scene_object_id(engine, pair[1]),
            .ignored = ignored,
            .has_clearance = !ignored,
            .clearance = ignored ? 0 : clearance};
        (void)add_request(journal, PROTO_METHOD_SCENE_IGNORE, &ignore, 0);
    }
}

/* Add where the scene's last step has moved the object, and from where, unless it stands
 * where its mesh was registered. */
static void add_place(struct srv_sent *sent, const struct srv_scene *scene,
                      const struct srv_placed *placed)
{
    const struct eng_scene *engine = scene->engine;
    uint32_t idx = placed->engine_idx;
    const void *registered = eng_mesh_vertices(eng_scene_mesh(engine, idx));
    const uint8_t *ends[2] = {(const uint8_t *)eng_scene_positions(engine, idx, 0),
                              (const uint8_t *)eng_scene_positions(engine, idx, 1)};
    uint64_t bytes = placed->vertex_count * sizeof(double[3]);
    const struct proto_segment segment = {.object = placed->handle,
                                          .kind = PROTO_SEGMENT_X0X1,
                                          .format = PCCD_FORMAT_F64,
                                          .count = placed->vertex_count};
    if (memcmp(ends[0], registered, bytes) != 0 ||
        memcmp(ends[1], registered, bytes) != 0) {
        srv_sent_add(sent, &segment, bytes, ends);
    }
}

static void note_scene(struct srv_journal *journal, const struct srv_scene *scene)
{
    struct proto_FRAME_SUBMIT_request placing = {.place = true};
    struct srv_sent places = {.slot = NULL};
    srv_sent_begin(&places, scene->placed_count, journal->bytes_max);
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        const struct srv_placed *placed = &scene->placed[i];
        if (placed->handle != 0) {
            note_object(journal, scene, placed);
            note_attributes(journal, placed);
            add_place(&places, scene, placed);
        }
    }
    if (scene->engine != NULL) {
        note_pairs(journal, scene->engine);
    }
    placing.segments = places.segments;
    if (places.segments > 0 || places.status != 0) {
        add_motion(journal, PROTO_METHOD_FRAME_SUBMIT, &placing, &places);
    }
    srv_sent_end(&places);
}

int srv_journal_begin(struct srv_scene *scene, struct srv_member *member,
                      uint64_t bytes_max)
{
    srv_assert_compute();
    if (member->journal != NULL) {
        return PCCD_E_STATE;
    }
    struct srv_journal *journal = calloc(1, sizeof *journal);
    if (journal == NULL) {
        return PCCD_E_NOMEM;
    }
    *journal = (struct srv_journal){
        .next = scene->journals, .member = member, .bytes_max = bytes_max};
    scene->journals = journal;
    member->journal = journal;
    note_scene(journal, scene);
    int status = journal->status;
    if (status != 0) {
        srv_journal_end(scene, member);
    }
    return status;
}
