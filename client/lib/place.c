/* place.c - where the objects are that another daemon would have to be told of.
 *
 * Room:     client/lib. May include: place.h, attach.h, keep.h.
 * Does:     the segments of answered steps, in the order of the steps, into an array for
 *           each object; a transform of a whole object is kept as such.
 * Does not: read anything of a slot but ranges that were handed out: lengths come from
 *           the library's own copy of the segment table.
 * Threads:  [owner].
 */
#include "place.h"

#include <stdlib.h>
#include <string.h>

#include "attach.h"

static size_t vertex_bytes(uint32_t format)
{
    return format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]);
}

void cli_place_reset(struct cli_kept_object *object, uint64_t step)
{
    free(object->x);
    object->x = NULL;
    object->placing = CLI_PLACED_REGISTERED;
    object->since = step;
}

/* ---- arithmetic -------------------------------------------------------------------- */

/* `count` vertices in another format; from float to double nothing changes. */
static void widen(double *to, const float *from, size_t count)
{
    for (size_t i = 0; i < 3 * count; i++) {
        to[i] = (double)from[i];
    }
}

/* The protocol's transform of registered positions: each operation rounded once. */
static void transform(const struct cli_kept_mesh *mesh, const double m[12],
                      uint32_t first, uint32_t count, double (*to)[3])
{
    for (uint32_t i = 0; i < count; i++) {
        double x[3];

        if (mesh->format == PCCD_FORMAT_F64) {
            memcpy(x, (const double *)mesh->x + 3 * (size_t)(first + i), sizeof(x));
        } else {
            widen(x, (const float *)mesh->x + 3 * (size_t)(first + i), 1);
        }
        for (int row = 0; row < 3; row++) {
            const double *r = m + 4 * (size_t)row;

            to[i][row] = ((r[0] * x[0] + r[1] * x[1]) + r[2] * x[2]) + r[3];
        }
    }
}

/* ---- arrays ------------------------------------------------------------------------ */

/* Room for all vertices in a format; what was there is gone. */
static int allocate(struct cli_kept_object *object, uint32_t format)
{
    void *x;

    if (object->x != NULL && object->format == format) {
        return 0;
    }
    x = malloc(object->mesh->vertex_count * vertex_bytes(format));
    if (x == NULL) {
        return PCCD_E_NOMEM;
    }
    free(object->x);
    object->x = x;
    object->format = format;
    return 0;
}

/* An array with the positions as they are, in `format` or a wider one. */
static int materialise(struct cli_kept_object *object, uint32_t format)
{
    const struct cli_kept_mesh *mesh = object->mesh;
    int rc = 0;

    if (object->placing == CLI_PLACED_FREELY) {
        if (object->format < format) { /* float to double */
            float *narrow = object->x;

            object->x = NULL;
            rc = allocate(object, format);
            if (rc != 0) {
                object->x = narrow;
                return rc;
            }
            widen(object->x, narrow, mesh->vertex_count);
            free(narrow);
        }
        return 0;
    }
    if (object->placing == CLI_PLACED_RIGID) {
        rc = allocate(object, PCCD_FORMAT_F64);
        if (rc == 0) {
            transform(mesh, object->m, 0, mesh->vertex_count, object->x);
        }
    } else {
        rc = allocate(object, mesh->format > format ? mesh->format : format);
        if (rc == 0 && object->format == mesh->format) {
            memcpy(object->x, mesh->x, mesh->vertex_count * vertex_bytes(mesh->format));
        } else if (rc == 0) {
            widen(object->x, mesh->x, mesh->vertex_count);
        }
    }
    if (rc == 0) {
        object->placing = CLI_PLACED_FREELY;
    }
    return rc;
}

static bool is_whole(const struct cli_kept_object *object,
                     const struct proto_segment *segment)
{
    return segment->first == 0 && segment->count == object->mesh->vertex_count;
}

static int apply(struct cli_kept_object *object, const struct proto_segment *segment,
                 const uint8_t *payload)
{
    const uint8_t *end = payload + segment->offset1;
    size_t count = segment->count;
    int rc;

    if (segment->kind == PROTO_SEGMENT_RIGID && is_whole(object, segment)) {
        memcpy(object->m, end, sizeof(object->m));
        object->placing = CLI_PLACED_RIGID;
        return 0;
    }
    if (is_whole(object, segment)) {
        rc = allocate(object, segment->format);
        object->placing = rc == 0 ? CLI_PLACED_FREELY : object->placing;
    } else {
        rc = materialise(object, segment->format);
    }
    if (rc != 0) {
        return rc;
    }
    if (segment->kind == PROTO_SEGMENT_RIGID) {
        double m[12];

        memcpy(m, end, sizeof(m));
        transform(object->mesh, m, segment->first, segment->count,
                  (double(*)[3])object->x + segment->first);
    } else if (segment->format == object->format) {
        memcpy((uint8_t *)object->x + segment->first * vertex_bytes(object->format), end,
               count * vertex_bytes(object->format));
    } else {
        widen((double *)object->x + 3 * (size_t)segment->first,
              (const float *)(const void *)end, count);
    }
    return 0;
}

/* ---- slots ------------------------------------------------------------------------- */

/* The object of a segment of an answered step that no later step has overwritten. */
static struct cli_kept_object *find_current(struct cli_kept_scene *scene,
                                            const struct cli_slot *own, uint32_t at)
{
    const struct proto_segment *segment = &own->segments[at];
    struct cli_kept_object *object =
        scene != NULL ? cli_keep_object(scene, segment->object) : NULL;

    if (object == NULL || own->step < object->since ||
        segment->first + (uint64_t)segment->count > object->mesh->vertex_count) {
        return NULL;
    }
    return object;
}

static bool is_superseded(struct pccd_client *client, const struct cli_slot *own)
{
    struct cli_kept_scene *scene = cli_keep_scene(client, own->scene);

    for (uint32_t i = 0; i < own->segment_count; i++) {
        if (find_current(scene, own, i) != NULL) {
            return false;
        }
    }
    return true;
}

void cli_place_answered(struct pccd_client *client, uint32_t slot, uint64_t step)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct cli_kept_scene *scene = cli_keep_scene(client, own->scene);

    if (scene == NULL) {
        return;
    }
    own->step = step;
    own->state = CLI_SLOT_KEPT;
    for (uint32_t i = 0; i < own->segment_count; i++) {
        struct cli_kept_object *object = find_current(scene, own, i);

        if (object != NULL && is_whole(object, &own->segments[i])) {
            object->since = step;
        }
    }
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        struct cli_slot *other = &client->ring.slots[i];

        if (other->state == CLI_SLOT_KEPT && is_superseded(client, other)) {
            other->state = CLI_SLOT_FREE;
        }
    }
}

int cli_keep_fold(struct pccd_client *client, uint32_t slot)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct cli_kept_scene *scene = cli_keep_scene(client, own->scene);

    for (uint32_t i = 0; i < own->segment_count; i++) {
        struct cli_kept_object *object = find_current(scene, own, i);
        int rc = object == NULL
                     ? 0
                     : apply(object, &own->segments[i], cli_slot_payload(client, slot));

        if (rc != 0) {
            return cli_fail(client, rc, "no memory to keep the positions of object 0x%x",
                            own->segments[i].object);
        }
    }
    own->state = CLI_SLOT_FREE;
    return 0;
}

int cli_keep_fold_all(struct pccd_client *client)
{
    for (;;) {
        uint32_t oldest = CLI_SLOT_NONE;
        int rc;

        for (uint32_t i = 0; i < client->ring.slot_count; i++) {
            const struct cli_slot *own = &client->ring.slots[i];

            if (own->state == CLI_SLOT_KEPT &&
                (oldest == CLI_SLOT_NONE ||
                 own->step < client->ring.slots[oldest].step)) {
                oldest = i;
            }
        }
        if (oldest == CLI_SLOT_NONE) {
            return 0;
        }
        rc = cli_keep_fold(client, oldest);
        if (rc != 0) {
            return rc;
        }
    }
}
