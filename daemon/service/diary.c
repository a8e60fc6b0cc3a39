/* diary.c - what is done to a shared scene, written down for a session.
 *
 * Room:     service. See diary.h.
 * Does:     positions are the engine's own, of both ends of the step: exact, whatever
 *           they came as.
 * Threads:  [compute].
 */
#include "diary.h"

#include <stdlib.h>
#include <string.h>

#include "held.h"
#include "invariant.h"
#include "request.h"
#include "shm.h"

struct srv_diary_entry {
    struct srv_diary_entry *next;
    uint64_t bytes;
    uint8_t data[];
};

/* ---- what is kept ------------------------------------------------------------------ */

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

/* Room for an entry with `bytes` behind its head, zeros; NULL: it is full. */
static uint8_t *append(struct srv_diary *diary, enum proto_journal_kind kind,
                       uint32_t object, uint64_t bytes)
{
    const struct proto_journal_entry head = {
        .bytes = padded(sizeof head + bytes), .kind = (uint32_t)kind, .object = object};
    uint64_t kept = diary->end - diary->begin;
    if (diary->status != 0) {
        return NULL;
    }
    if (kept > diary->bytes_max || head.bytes > diary->bytes_max - kept) {
        diary->status = PCCD_E_LIMIT;
        return NULL;
    }
    struct srv_diary_entry *entry = calloc(1, sizeof *entry + head.bytes);
    if (entry == NULL) {
        diary->status = PCCD_E_NOMEM;
        return NULL;
    }
    entry->bytes = head.bytes;
    memcpy(entry->data, &head, sizeof head);
    if (diary->last != NULL) {
        diary->last->next = entry;
    } else {
        diary->first = entry;
    }
    diary->last = entry;
    diary->end += head.bytes;
    return entry->data + sizeof head;
}

void srv_diary_forget(struct srv_diary *diary, uint64_t position)
{
    srv_assert_compute();
    while (diary->first != NULL && diary->begin + diary->first->bytes <= position) {
        struct srv_diary_entry *entry = diary->first;
        diary->begin += entry->bytes;
        diary->first = entry->next;
        free(entry);
    }
    if (diary->first == NULL) {
        diary->last = NULL;
    }
}

void srv_diary_copy(const struct srv_diary *diary, uint64_t position, uint64_t bytes,
                    uint8_t *to)
{
    const struct srv_diary_entry *entry = diary->first;
    uint64_t at = diary->begin;
    PCCD_ASSERT(position >= diary->begin && position + bytes <= diary->end);
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

struct srv_diary *srv_diary_find(const struct srv_scene *scene,
                                 const struct srv_seat *seat)
{
    srv_assert_compute();
    struct srv_diary *diary = scene->diaries;
    while (diary != NULL && diary->seat != seat) {
        diary = diary->next;
    }
    return diary;
}

void srv_diary_end(struct srv_scene *scene, const struct srv_seat *seat)
{
    srv_assert_compute();
    struct srv_diary **at = &scene->diaries;
    while (*at != NULL && (*at)->seat != seat) {
        at = &(*at)->next;
    }
    struct srv_diary *diary = *at;
    if (diary != NULL) {
        *at = diary->next;
        srv_diary_forget(diary, UINT64_MAX);
        free(diary);
    }
}

/* ---- objects ----------------------------------------------------------------------- */

static void note_object(struct srv_diary *diary, const struct srv_scene *scene,
                        const struct srv_placed *placed)
{
    const struct eng_mesh *mesh = eng_scene_mesh(scene->engine, placed->engine_idx);
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    const struct proto_journal_object head = {info.vertex_count, info.triangle_count};
    uint64_t x_bytes = info.vertex_count * sizeof(double[3]);
    uint8_t *to =
        append(diary, PROTO_JOURNAL_OBJECT, placed->handle,
               sizeof head + x_bytes + info.triangle_count * sizeof(uint32_t[3]));
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        memcpy(to + sizeof head, eng_mesh_vertices(mesh), x_bytes);
        eng_mesh_get_corners(mesh, (uint32_t(*)[3])(void *)(to + sizeof head + x_bytes));
    }
}

static void note_filter(struct srv_diary *diary, const struct srv_scene *scene,
                        const struct srv_placed *placed)
{
    struct eng_object_filter filter;
    int status = eng_scene_get_filter(scene->engine, placed->engine_idx, &filter);
    PCCD_ASSERT(status == ENG_OK); /* the engine has every object that is placed */
    const struct proto_journal_filter note = {
        .group = filter.group, .mask = filter.mask, .self = filter.self};
    uint8_t *to = append(diary, PROTO_JOURNAL_FILTER, placed->handle, sizeof note);
    if (to != NULL) {
        memcpy(to, &note, sizeof note);
    }
}

static void note_pairs(struct srv_diary *diary, const uint32_t (*pairs)[2],
                       uint32_t count, bool ignored)
{
    const struct proto_journal_pairs head = {count, ignored};
    uint8_t *to =
        append(diary, PROTO_JOURNAL_PAIRS, 0, sizeof head + count * sizeof *pairs);
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        memcpy(to + sizeof head, pairs, count * sizeof *pairs);
    }
}

void srv_diary_add(struct srv_scene *scene, const struct srv_placed *placed)
{
    srv_assert_compute();
    for (struct srv_diary *diary = scene->diaries; diary != NULL; diary = diary->next) {
        note_object(diary, scene, placed);
    }
}

void srv_diary_gone(struct srv_scene *scene, uint32_t object)
{
    srv_assert_compute();
    for (struct srv_diary *diary = scene->diaries; diary != NULL; diary = diary->next) {
        (void)append(diary, PROTO_JOURNAL_GONE, object, 0);
    }
}

void srv_diary_filter(struct srv_scene *scene, const struct srv_placed *placed)
{
    srv_assert_compute();
    for (struct srv_diary *diary = scene->diaries; diary != NULL; diary = diary->next) {
        note_filter(diary, scene, placed);
    }
}

void srv_diary_pair(struct srv_scene *scene, uint32_t a, uint32_t b, bool ignored)
{
    const uint32_t pair[1][2] = {{a, b}};
    srv_assert_compute();
    for (struct srv_diary *diary = scene->diaries; diary != NULL; diary = diary->next) {
        note_pairs(diary, pair, 1, ignored);
    }
}

/* ---- steps ------------------------------------------------------------------------- */

typedef bool (*choose_fn)(const struct srv_scene *scene, const struct srv_placed *placed);

static bool was_moved(const struct srv_scene *scene, const struct srv_placed *placed)
{
    return placed->handle != 0 && eng_scene_was_moved(scene->engine, placed->engine_idx);
}

/* Whether it is not where its mesh was registered. */
static bool is_elsewhere(const struct srv_scene *scene, const struct srv_placed *placed)
{
    return placed->handle != 0 &&
           memcmp(eng_scene_positions(scene->engine, placed->engine_idx, 1),
                  eng_mesh_vertices(eng_scene_mesh(scene->engine, placed->engine_idx)),
                  placed->vertex_count * sizeof(double[3])) != 0;
}

/* The objects that are chosen, from where they were at the end `from` to where they
 * are. */
static void note_step(struct srv_diary *diary, const struct srv_scene *scene,
                      struct proto_journal_step head, choose_fn is_chosen, unsigned from)
{
    uint64_t x_bytes = 0;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        if (is_chosen(scene, &scene->placed[i])) {
            head.segments++;
            x_bytes += scene->placed[i].vertex_count * sizeof(double[3]);
        }
    }
    if (head.segments == 0 && head.step == 0) {
        return; /* nothing that a reader could not do without */
    }
    uint64_t offset = head.segments * sizeof(struct proto_segment);
    uint8_t *to =
        append(diary, PROTO_JOURNAL_STEP, 0, sizeof head + offset + 2 * x_bytes);
    if (to == NULL) {
        return;
    }
    memcpy(to, &head, sizeof head);
    to += sizeof head;
    uint8_t *table = to;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        const struct srv_placed *placed = &scene->placed[i];
        if (!is_chosen(scene, placed)) {
            continue;
        }
        uint64_t bytes = placed->vertex_count * sizeof(double[3]);
        const struct proto_segment segment = {.object = placed->handle,
                                              .kind = PROTO_SEGMENT_X0X1,
                                              .format = PCCD_FORMAT_F64,
                                              .count = placed->vertex_count,
                                              .offset0 = offset,
                                              .offset1 = offset + bytes};
        memcpy(table, &segment, sizeof segment);
        memcpy(to + segment.offset0,
               eng_scene_positions(scene->engine, placed->engine_idx, from), bytes);
        memcpy(to + segment.offset1,
               eng_scene_positions(scene->engine, placed->engine_idx, 1), bytes);
        table += sizeof segment;
        offset += 2 * bytes;
    }
}

/* The step's number to this session: it has submitted it, or a frame that went along. */
static uint64_t number_to(const struct srv_request *request, const struct srv_seat *seat)
{
    if (request->plan.seat == seat) {
        return request->params.FRAME_SUBMIT.step;
    }
    const struct srv_held *held = request->taken;
    while (held != NULL && held->seat != seat) {
        held = held->next;
    }
    return held != NULL && held->error.code == 0 ? held->submit.step : 0;
}

void srv_diary_step(const struct srv_request *request)
{
    srv_assert_compute();
    const struct proto_FRAME_SUBMIT_request *submit = &request->params.FRAME_SUBMIT;
    const struct srv_scene *scene = request->plan.scene;
    struct proto_journal_step head = {.number = submit->place ? 0 : scene->number,
                                      .tolerance = submit->tolerance,
                                      .mode = submit->mode,
                                      .method = submit->method,
                                      .threads = submit->threads,
                                      .scheduler = submit->scheduler,
                                      .high_level = submit->high_level,
                                      .refit = submit->refit};
    for (struct srv_diary *diary = scene->diaries; diary != NULL; diary = diary->next) {
        head.step = submit->place ? 0 : number_to(request, diary->seat);
        note_step(diary, scene, head, was_moved, 0);
    }
}

/* ---- the beginning ----------------------------------------------------------------- */

static bool is_filtered(const struct srv_scene *scene, const struct srv_placed *placed)
{
    const struct eng_object_filter at_first = ENG_OBJECT_FILTER_DEFAULT;
    struct eng_object_filter filter;
    int status = eng_scene_get_filter(scene->engine, placed->engine_idx, &filter);
    PCCD_ASSERT(status == ENG_OK);
    return filter.group != at_first.group || filter.mask != at_first.mask ||
           filter.self != at_first.self;
}

/* All pairs that ignore each other: by index in the engine, to be named by handle. */
static void note_ignored(struct srv_diary *diary, const struct srv_scene *scene)
{
    uint32_t count = eng_scene_ignored_count(scene->engine);
    const struct proto_journal_pairs head = {count, true};
    uint32_t from = 0;
    uint32_t pair[2];
    if (count == 0) {
        return;
    }
    uint8_t *to =
        append(diary, PROTO_JOURNAL_PAIRS, 0, sizeof head + count * sizeof pair);
    if (to == NULL) {
        return;
    }
    memcpy(to, &head, sizeof head);
    to += sizeof head;
    while (eng_scene_next_ignored(scene->engine, &from, pair)) {
        for (int k = 0; k < 2; k++) {
            pair[k] = eng_scene_object_id(scene->engine, pair[k]);
        }
        memcpy(to, pair, sizeof pair);
        to += sizeof pair;
    }
}

int srv_diary_begin(struct srv_scene *scene, const struct srv_seat *seat,
                    uint64_t bytes_max)
{
    srv_assert_compute();
    if (srv_diary_find(scene, seat) != NULL) {
        return PCCD_E_STATE;
    }
    struct srv_diary *diary = calloc(1, sizeof *diary);
    if (diary == NULL) {
        return PCCD_E_NOMEM;
    }
    *diary =
        (struct srv_diary){.next = scene->diaries, .seat = seat, .bytes_max = bytes_max};
    scene->diaries = diary;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        if (scene->placed[i].handle != 0) {
            note_object(diary, scene, &scene->placed[i]);
            if (is_filtered(scene, &scene->placed[i])) {
                note_filter(diary, scene, &scene->placed[i]);
            }
        }
    }
    if (scene->engine != NULL) {
        const struct proto_journal_step placing = {.step = 0};
        note_ignored(diary, scene);
        note_step(diary, scene, placing, is_elsewhere, 1);
    }
    int status = diary->status;
    if (status != 0) {
        srv_diary_end(scene, seat);
    }
    return status;
}
