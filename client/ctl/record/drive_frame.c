/* drive_frame.c - a frame of what a recorded step moves. */
#include "drive.h"

#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "coordinates.h"

/* Some vertices of an object that are told. */
struct drive_piece {
    struct record_segment segment;
    const double (*begin)[3]; /* [count] of the segment: where they begin; NULL: as the
                                 segment says */
    const double (*end)[3];   /* likewise, where they end */
};

static size_t range_bytes(const struct record_segment *segment)
{
    return segment->kind == RECORD_RIGID
               ? 12 * sizeof(double)
               : segment->count * common_vertex_bytes(segment->format);
}

/* Bytes of a piece in a frame. What begins where the world says has both ends in
 * doubles. */
static uint64_t piece_bytes(const struct drive_piece *piece)
{
    return piece->begin != NULL ? 2 * (uint64_t)piece->segment.count * sizeof(double[3])
           : piece->segment.kind == RECORD_X1 ? range_bytes(&piece->segment)
                                              : 2 * range_bytes(&piece->segment);
}

static int add_piece(struct drive_pieces *pieces, const struct drive_piece *piece,
                     struct ctl_error *error)
{
    if (!array_reserve((void **)&pieces->items, pieces->count, &pieces->room,
                       sizeof *pieces->items)) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what a step moves");
    }
    pieces->items[pieces->count++] = *piece;
    pieces->bytes += piece_bytes(piece);
    return PCCD_OK;
}

static int compare_pieces(const void *a, const void *b)
{
    const struct record_segment *x = &((const struct drive_piece *)a)->segment;
    const struct record_segment *y = &((const struct drive_piece *)b)->segment;
    return x->object != y->object ? (x->object > y->object) - (x->object < y->object)
                                  : (x->first > y->first) - (x->first < y->first);
}

/* Vertices of an object that no segment moves: they stand. */
static int add_standing(struct drive_pieces *pieces, const struct registry_object *object,
                        uint32_t first, uint32_t end, struct ctl_error *error)
{
    const struct drive_piece piece = {.segment = {.object = object->handle,
                                                  .kind = RECORD_X0X1,
                                                  .format = PCCD_FORMAT_F64,
                                                  .first = first,
                                                  .count = end - first},
                                      .begin = (const double(*)[3])object->x1 + first,
                                      .end = (const double(*)[3])object->x1 + first};
    return first < end ? add_piece(pieces, &piece, error) : PCCD_OK;
}

/* Whether the segments, in the order of compare_pieces, name objects and vertices that
 * there are, each once. A daemon refuses others, and is to be given them as they are. */
static bool is_sound(const struct drive_pieces *pieces,
                     const struct registry_scene *scene)
{
    for (uint32_t i = 0; i < pieces->count; i++) {
        const struct record_segment *segment = &pieces->items[i].segment;
        const struct record_segment *before =
            i > 0 ? &pieces->items[i - 1].segment : NULL;
        const struct registry_object *object = registry_object(scene, segment->object);
        if (object == NULL || segment->first > object->mesh->vertex_count ||
            segment->count > object->mesh->vertex_count - segment->first ||
            (before != NULL && before->object == segment->object &&
             segment->first - before->first < before->count)) {
            return false;
        }
    }
    return true;
}

/* Tell the beginning of what is told by its end alone, and of all objects that have ever
 * moved where they stand. */
static int add_begins(struct drive_pieces *pieces, const struct registry_scene *scene,
                      struct ctl_error *error)
{
    uint32_t told = pieces->count, next = 0;
    int status = PCCD_OK;
    if (told > 0) {
        qsort(pieces->items, told, sizeof *pieces->items, compare_pieces);
    }
    if (!is_sound(pieces, scene)) {
        return PCCD_OK;
    }
    for (uint32_t o = 0; o < scene->object_count && status == PCCD_OK; o++) {
        const struct registry_object *object = &scene->objects[o];
        bool has_moved = object->placing != REGISTRY_AS_REGISTERED;
        uint32_t from = 0;
        for (; next < told && pieces->items[next].segment.object == object->handle &&
               status == PCCD_OK;
             next++) {
            struct drive_piece *piece = &pieces->items[next];
            const uint32_t first = piece->segment.first, count = piece->segment.count;
            if (has_moved && piece->segment.kind == RECORD_X1) {
                pieces->bytes -= piece_bytes(piece);
                piece->begin = (const double(*)[3])object->x1 + first;
                pieces->bytes += piece_bytes(piece);
            }
            status = has_moved ? add_standing(pieces, object, from, first, error)
                               : PCCD_OK; /* may move pieces->items */
            from = first + count;
        }
        if (status == PCCD_OK && has_moved) {
            status =
                add_standing(pieces, object, from, object->mesh->vertex_count, error);
        }
    }
    return status;
}

int drive_pieces_make(struct drive_pieces *pieces, const struct registry *world,
                      uint32_t scene, uint32_t count, const uint8_t *slot,
                      struct ctl_error *error)
{
    const struct registry_scene *known =
        world != NULL ? registry_scene(world, scene) : NULL;
    int status = PCCD_OK;
    *pieces = (struct drive_pieces){.items = NULL};
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        struct drive_piece piece = {.begin = NULL};
        memcpy(&piece.segment, slot + i * sizeof piece.segment, sizeof piece.segment);
        status = add_piece(pieces, &piece, error);
    }
    if (status == PCCD_OK && known != NULL) {
        status = add_begins(pieces, known, error);
    }
    if (status != PCCD_OK) {
        drive_pieces_deinit(pieces);
    }
    return status;
}

int drive_pieces_repeat(struct drive_pieces *pieces, const struct registry *world,
                        uint32_t scene, struct ctl_error *error)
{
    const struct registry_scene *known = registry_scene(world, scene);
    int status = PCCD_OK;
    *pieces = (struct drive_pieces){.items = NULL};
    for (uint32_t o = 0; known != NULL && o < known->object_count && status == PCCD_OK;
         o++) {
        const struct registry_object *object = &known->objects[o];
        const struct drive_piece piece = {
            .segment = {.object = object->handle,
                        .kind = RECORD_X0X1,
                        .format = PCCD_FORMAT_F64,
                        .count = object->mesh->vertex_count},
            .begin = (const double(*)[3])object->x0,
            .end = (const double(*)[3])object->x1};
        if (object->placing != REGISTRY_AS_REGISTERED) {
            status = add_piece(pieces, &piece, error);
        }
    }
    if (status != PCCD_OK) {
        drive_pieces_deinit(pieces);
    }
    return status;
}

void drive_pieces_deinit(struct drive_pieces *pieces)
{
    free(pieces->items);
    *pieces = (struct drive_pieces){.items = NULL};
}

/* ---- the frame --------------------------------------------------------------------- */

/* The end of a segment, in doubles. `from` need not be aligned. */
static void copy_end(const struct record_segment *segment, const uint8_t *from,
                     double (*to)[3])
{
    if (segment->format == PCCD_FORMAT_F64) {
        memcpy(to, from, range_bytes(segment));
        return;
    }
    for (uint32_t i = 0; i < segment->count; i++) {
        float x[3];
        memcpy(x, from + i * sizeof x, sizeof x);
        for (uint32_t k = 0; k < 3; k++) {
            to[i][k] = (double)x[k];
        }
    }
}

static int frame_begun(struct pccd_frame *frame, const struct drive_piece *piece,
                       const uint8_t *slot)
{
    const struct record_segment *segment = &piece->segment;
    size_t bytes = segment->count * sizeof(double[3]);
    void *to0 = NULL, *to1 = NULL;
    int status = pccd_frame_x0x1(frame, segment->object, PCCD_FORMAT_F64, segment->first,
                                 segment->count, &to0, &to1);
    if (status != PCCD_OK) {
        return status;
    }
    memcpy(to0, piece->begin, bytes);
    if (piece->end != NULL) {
        memcpy(to1, piece->end, bytes);
    } else {
        copy_end(segment, slot + segment->offset1, to1);
    }
    return PCCD_OK;
}

static int frame_recorded(struct pccd_frame *frame, const struct record_segment *segment,
                          const uint8_t *slot)
{
    enum pccd_format format = (enum pccd_format)segment->format;
    void *to0 = NULL, *to1 = NULL;
    int status;
    if (segment->kind == RECORD_RIGID) {
        double m0[12], m1[12];
        memcpy(m0, slot + segment->offset0, sizeof m0);
        memcpy(m1, slot + segment->offset1, sizeof m1);
        return pccd_frame_rigid(frame, segment->object, segment->first, segment->count,
                                m0, m1);
    }
    status = segment->kind == RECORD_X1
                 ? pccd_frame_x1(frame, segment->object, format, segment->first,
                                 segment->count, &to1)
                 : pccd_frame_x0x1(frame, segment->object, format, segment->first,
                                   segment->count, &to0, &to1);
    if (status == PCCD_OK && segment->kind == RECORD_X0X1) {
        memcpy(to0, slot + segment->offset0, range_bytes(segment));
    }
    if (status == PCCD_OK) {
        memcpy(to1, slot + segment->offset1, range_bytes(segment));
    }
    return status;
}

int drive_pieces_frame(const struct drive_pieces *pieces, struct pccd_client *client,
                       uint32_t scene, const uint8_t *slot, struct pccd_frame *made)
{
    int status = pccd_frame_begin(client, scene, pieces->count, pieces->bytes, made);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < pieces->count && status == PCCD_OK; i++) {
        const struct drive_piece *piece = &pieces->items[i];
        status = piece->begin != NULL ? frame_begun(made, piece, slot)
                                      : frame_recorded(made, &piece->segment, slot);
    }
    if (status != PCCD_OK) {
        pccd_frame_abort(made);
    }
    return status;
}
