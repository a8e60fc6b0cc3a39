/* srv_journal.c - what is done to a shared scene, written down for a session. */
#include "srv_journal.h"

#include <stdlib.h>
#include <string.h>

#include "held.h"
#include "invariant.h"
#include "shm.h"

struct srv_journal_entry {
    struct srv_journal_entry *next;
    uint64_t bytes;
    uint8_t data[];
};

/* ---- what is kept ------------------------------------------------------------------ */

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

/* Room for an entry with `bytes` behind its head, zeros; NULL: it is full. */
static uint8_t *append(struct srv_journal *journal, enum proto_journal_kind kind,
                       uint32_t object, uint64_t bytes)
{
    const struct proto_journal_entry head = {
        .bytes = padded(sizeof head + bytes), .kind = (uint32_t)kind, .object = object};
    uint64_t kept = journal->end - journal->begin;
    if (journal->status != 0) {
        return NULL;
    }
    if (kept > journal->bytes_max || head.bytes > journal->bytes_max - kept) {
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
    if (journal->last != NULL) {
        journal->last->next = entry;
    } else {
        journal->first = entry;
    }
    journal->last = entry;
    journal->end += head.bytes;
    return entry->data + sizeof head;
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

struct srv_journal *srv_journal_find(const struct srv_scene *scene,
                                     const struct srv_member *member)
{
    srv_assert_compute();
    struct srv_journal *journal = scene->diaries;
    while (journal != NULL && journal->member != member) {
        journal = journal->next;
    }
    return journal;
}

void srv_journal_end(struct srv_scene *scene, const struct srv_member *member)
{
    srv_assert_compute();
    struct srv_journal **at = &scene->diaries;
    while (*at != NULL && (*at)->member != member) {
        at = &(*at)->next;
    }
    struct srv_journal *journal = *at;
    if (journal != NULL) {
        *at = journal->next;
        srv_journal_forget(journal, UINT64_MAX);
        free(journal);
    }
}

/* ---- objects ----------------------------------------------------------------------- */

static void note_radii(struct srv_journal *journal, const struct eng_mesh *mesh,
                       uint32_t vertex_count)
{
    const double *radii = eng_mesh_radii(mesh);
    const struct proto_journal_radii head = {.vertex_count = vertex_count};
    uint64_t bytes = vertex_count * sizeof *radii;
    uint8_t *to = radii != NULL
                      ? append(journal, PROTO_JOURNAL_RADII, 0, sizeof head + bytes)
                      : NULL;
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        memcpy(to + sizeof head, radii, bytes);
    }
}

static void note_free(struct srv_journal *journal, const struct eng_mesh *mesh,
                      const struct eng_mesh_info *info)
{
    const struct proto_journal_free head = {.vertex_count = info->vertex_count,
                                            .edge_count = info->free_edge_count,
                                            .point_count = info->free_point_count};
    uint64_t edge_bytes = head.edge_count * sizeof(uint32_t[2]);
    uint64_t point_bytes = head.point_count * sizeof(uint32_t);
    uint8_t *to = edge_bytes + point_bytes > 0
                      ? append(journal, PROTO_JOURNAL_FREE, 0,
                               sizeof head + edge_bytes + point_bytes)
                      : NULL;
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        to += sizeof head;
        eng_mesh_get_free(mesh, (uint32_t(*)[2])(void *)to,
                          (uint32_t *)(void *)(to + edge_bytes));
    }
}

static void note_object(struct srv_journal *journal, const struct srv_scene *scene,
                        const struct srv_placed *placed)
{
    const struct eng_mesh *mesh = eng_scene_mesh(scene->engine, placed->engine_idx);
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    const struct proto_journal_object head = {info.vertex_count, info.triangle_count};
    uint64_t x_bytes = info.vertex_count * sizeof(double[3]);
    note_radii(journal, mesh, info.vertex_count);
    note_free(journal, mesh, &info);
    uint8_t *to =
        append(journal, PROTO_JOURNAL_OBJECT, placed->handle,
               sizeof head + x_bytes + info.triangle_count * sizeof(uint32_t[3]));
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        memcpy(to + sizeof head, eng_mesh_vertices(mesh), x_bytes);
        eng_mesh_get_corners(mesh, (uint32_t(*)[3])(void *)(to + sizeof head + x_bytes));
    }
}

static void note_filter(struct srv_journal *journal, const struct srv_placed *placed)
{
    uint64_t words[COMMON_WORDS];
    common_attributes_pack(&placed->attributes, words);
    uint8_t *to = append(journal, PROTO_JOURNAL_FILTER, placed->handle, sizeof words);
    if (to != NULL) {
        memcpy(to, words, sizeof words);
    }
}

static void note_pairs(struct srv_journal *journal, const uint32_t (*pairs)[2],
                       uint32_t count, bool ignored)
{
    const struct proto_journal_pairs head = {count, ignored};
    uint8_t *to =
        append(journal, PROTO_JOURNAL_PAIRS, 0, sizeof head + count * sizeof *pairs);
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        memcpy(to + sizeof head, pairs, count * sizeof *pairs);
    }
}

void srv_journal_add(struct srv_scene *scene, const struct srv_placed *placed)
{
    srv_assert_compute();
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        note_object(journal, scene, placed);
    }
}

void srv_journal_gone(struct srv_scene *scene, uint32_t object)
{
    srv_assert_compute();
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        (void)append(journal, PROTO_JOURNAL_GONE, object, 0);
    }
}

void srv_journal_filter(struct srv_scene *scene, const struct srv_placed *placed)
{
    srv_assert_compute();
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        note_filter(journal, placed);
    }
}

void srv_journal_pair(struct srv_scene *scene, uint32_t a, uint32_t b, bool ignored)
{
    const uint32_t pair[1][2] = {{a, b}};
    srv_assert_compute();
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        note_pairs(journal, pair, 1, ignored);
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

/* How many objects are chosen, and the bytes of a segment table and positions of both
 * ends. */
static uint32_t measure(const struct srv_scene *scene, choose_fn is_chosen,
                        uint64_t *bytes)
{
    uint32_t count = 0;
    uint64_t x_bytes = 0;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        if (is_chosen(scene, &scene->placed[i])) {
            count++;
            x_bytes += scene->placed[i].vertex_count * sizeof(double[3]);
        }
    }
    *bytes = count * sizeof(struct proto_segment) + 2 * x_bytes;
    return count;
}

/* The `count` objects that are chosen, from where they were at the end `from` to where
 * they are, as they could have stood in a slot. */
static void write_motion(uint8_t *to, const struct srv_scene *scene, choose_fn is_chosen,
                         uint32_t count, unsigned from)
{
    uint64_t offset = count * sizeof(struct proto_segment);
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

/* What a step is asked for, but for its head. */
struct asked {
    struct proto_journal_separation separation;
    bool tells_start;
};

/* NULL: nobody was to meet anybody. */
static void note_asked(struct srv_journal *journal, const struct asked *asked)
{
    if (asked != NULL && asked->tells_start) {
        (void)append(journal, PROTO_JOURNAL_TELLS, 0, 0);
    }
    if (asked == NULL ||
        (asked->separation.separation == 0.0 && asked->separation.approach == 0.0)) {
        return;
    }
    uint8_t *to = append(journal, PROTO_JOURNAL_SEPARATION, 0, sizeof asked->separation);
    if (to != NULL) {
        memcpy(to, &asked->separation, sizeof asked->separation);
    }
}

/* A step of the objects that are chosen, which were at the end `from`. */
static void note_step(struct srv_journal *journal, const struct srv_scene *scene,
                      struct proto_journal_step head, const struct asked *asked,
                      choose_fn is_chosen, unsigned from)
{
    uint64_t bytes = 0;
    head.segments = measure(scene, is_chosen, &bytes);
    if (head.segments == 0 && head.step == 0) {
        return; /* nothing that a reader could not do without */
    }
    note_asked(journal, asked);
    uint8_t *to = append(journal, PROTO_JOURNAL_STEP, 0, sizeof head + bytes);
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        write_motion(to + sizeof head, scene, is_chosen, head.segments, from);
    }
}

/* The number that the frame has to this session, which has held it; 0: it has none. */
static uint64_t number_of_held(const struct srv_held *held,
                               const struct srv_member *member)
{
    while (held != NULL && held->member != member) {
        held = held->next;
    }
    return held != NULL && held->error.code == 0 ? held->submit.step : 0;
}

void srv_journal_step(struct srv_scene *scene,
                      const struct proto_FRAME_SUBMIT_request *submit,
                      const struct srv_member *member, const struct srv_held *taken)
{
    srv_assert_compute();
    struct proto_journal_step head = {.number = submit->place ? 0 : scene->number,
                                      .tolerance = submit->tolerance,
                                      .mode = submit->mode,
                                      .method = submit->method,
                                      .threads = submit->threads};
    const struct asked asked = {{submit->separation, submit->approach},
                                submit->tells_start};
    memcpy(head.tuning, submit->tuning, strnlen(submit->tuning, sizeof head.tuning));
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        head.step = submit->place               ? 0
                    : journal->member == member ? submit->step
                                                : number_of_held(taken, journal->member);
        note_step(journal, scene, head, &asked, was_moved, 0);
    }
}

static bool none(const struct srv_scene *scene, const struct srv_placed *placed)
{
    (void)scene;
    (void)placed;
    return false;
}

static void note_near(struct srv_journal *journal, const struct srv_scene *scene,
                      struct proto_journal_near head, choose_fn is_chosen)
{
    uint64_t bytes = 0;
    head.segments = measure(scene, is_chosen, &bytes);
    uint8_t *to = append(journal, PROTO_JOURNAL_NEAR, 0, sizeof head + bytes);
    if (to != NULL) {
        memcpy(to, &head, sizeof head);
        write_motion(to + sizeof head, scene, is_chosen, head.segments, 0);
    }
}

void srv_journal_near(struct srv_scene *scene,
                      const struct proto_SCENE_NEAR_request *near,
                      const struct srv_member *member)
{
    srv_assert_compute();
    bool moves = near->segments > 0;
    struct proto_journal_near head = {.step = near->step,
                                      .distance = near->distance,
                                      .gap = near->gap,
                                      .what = near->what,
                                      .end = near->end,
                                      .object_a = near->object_a,
                                      .object_b = near->object_b,
                                      .method = near->method,
                                      .threads = near->threads,
                                      .tells_crossings = near->tells_crossings};
    memcpy(head.tuning, near->tuning, strnlen(near->tuning, sizeof head.tuning));
    for (struct srv_journal *journal = scene->diaries; journal != NULL;
         journal = journal->next) {
        if (journal->member == member) {
            note_near(journal, scene, head, moves ? was_moved : none);
        } else if (moves) {
            const struct proto_journal_step moved = {.step = 0};
            note_step(journal, scene, moved, NULL, was_moved, 0);
        }
    }
}

/* ---- the beginning ----------------------------------------------------------------- */

/* All pairs that ignore each other: by index in the engine, to be named by handle. */
static void note_ignored(struct srv_journal *journal, const struct srv_scene *scene)
{
    uint32_t count = eng_scene_ignored_count(scene->engine);
    const struct proto_journal_pairs head = {count, true};
    uint32_t from = 0;
    uint32_t pair[2];
    if (count == 0) {
        return;
    }
    uint8_t *to =
        append(journal, PROTO_JOURNAL_PAIRS, 0, sizeof head + count * sizeof pair);
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

int srv_journal_begin(struct srv_scene *scene, const struct srv_member *member,
                      uint64_t bytes_max)
{
    srv_assert_compute();
    if (srv_journal_find(scene, member) != NULL) {
        return PCCD_E_STATE;
    }
    struct srv_journal *journal = calloc(1, sizeof *journal);
    if (journal == NULL) {
        return PCCD_E_NOMEM;
    }
    *journal = (struct srv_journal){
        .next = scene->diaries, .member = member, .bytes_max = bytes_max};
    scene->diaries = journal;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        if (scene->placed[i].handle != 0) {
            note_object(journal, scene, &scene->placed[i]);
            if (!common_attributes_are_at_first(&scene->placed[i].attributes)) {
                note_filter(journal, &scene->placed[i]);
            }
        }
    }
    if (scene->engine != NULL) {
        const struct proto_journal_step placing = {.step = 0};
        note_ignored(journal, scene);
        note_step(journal, scene, placing, NULL, is_elsewhere, 1);
    }
    int status = journal->status;
    if (status != 0) {
        srv_journal_end(scene, member);
    }
    return status;
}
