/* registry_positions.c - where the objects of a registry are. */
#include "registry.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "rounding.h"

/* ---- arithmetic -------------------------------------------------------------------- */

/* `count` vertices as doubles; from float to double nothing changes. */
static void widen(double (*to)[3], const void *from, uint32_t format, size_t count)
{
    if (format == PCCD_FORMAT_F64) {
        memcpy(to, from, count * sizeof *to);
        return;
    }
    COMMON_ROUNDING_HERE;
    for (size_t i = 0; i < count; i++) {
        float x[3];

        memcpy(x, (const uint8_t *)from + i * sizeof x, sizeof x);
        for (size_t k = 0; k < 3; k++) {
            to[i][k] = (double)x[k];
        }
    }
}

void registry_registered(const struct registry_mesh *mesh, uint32_t v, double x[3])
{
    size_t each = common_vertex_bytes(mesh->format);

    assert(v < mesh->vertex_count);
    widen((double(*)[3])x, (const uint8_t *)mesh->x + v * each, mesh->format, 1);
}

/* Move registered positions to where a transform takes them. */
static void transform(const struct registry_mesh *mesh, const void *matrix,
                      uint32_t first, uint32_t count, double (*to)[3])
{
    double m[12];

    memcpy(m, matrix, sizeof m);
    COMMON_ROUNDING_HERE;
    for (uint32_t i = 0; i < count; i++) {
        double x[3];

        registry_registered(mesh, first + i, x);
        common_transform(m, x, to[i]);
    }
}

static bool is_whole(const struct registry_object *object,
                     const struct registry_motion *motion)
{
    return motion->first == 0 && motion->count == object->mesh->vertex_count;
}

static bool is_within(const struct registry_object *object,
                      const struct registry_motion *motion)
{
    return motion->first <= object->mesh->vertex_count &&
           motion->count <= object->mesh->vertex_count - motion->first &&
           motion->format < PCCD_FORMAT_COUNT;
}

/* ---- the end of the last step ------------------------------------------------------ */

/* Room for all vertices in a format; what was there is gone. */
static int allocate(struct registry_object *object, uint32_t format)
{
    void *x;

    if (object->x != NULL && object->format == format) {
        return 0;
    }
    x = malloc(object->mesh->vertex_count * common_vertex_bytes(format));
    if (x == NULL) {
        return PCCD_E_NOMEM;
    }
    free(object->x);
    object->x = x;
    object->format = format;
    return 0;
}

/* Floats that are there become doubles. */
static int widen_own(struct registry_object *object)
{
    float *narrow = object->x;
    int status;

    object->x = NULL;
    status = allocate(object, PCCD_FORMAT_F64);
    if (status != 0) {
        object->x = narrow;
        return status;
    }
    widen(object->x, narrow, PCCD_FORMAT_F32, object->mesh->vertex_count);
    free(narrow);
    return 0;
}

/* An array with the positions as they are, in `format` or a wider one. */
static int materialise(struct registry_object *object, uint32_t format)
{
    const struct registry_mesh *mesh = object->mesh;
    int status;

    static_assert(PCCD_FORMAT_F32 < PCCD_FORMAT_F64, "formats are compared below");
    if (object->placing == REGISTRY_FREELY) {
        return object->format < format ? widen_own(object) : 0;
    }
    if (object->placing == REGISTRY_RIGID) {
        status = allocate(object, PCCD_FORMAT_F64);
        if (status == 0) {
            transform(mesh, object->m, 0, mesh->vertex_count, object->x);
        }
    } else {
        status = allocate(object, mesh->format > format ? mesh->format : format);
        if (status == 0 && object->format == mesh->format) {
            memcpy(object->x, mesh->x,
                   mesh->vertex_count * common_vertex_bytes(mesh->format));
        } else if (status == 0) {
            widen(object->x, mesh->x, mesh->format, mesh->vertex_count);
        }
    }
    if (status == 0) {
        object->placing = REGISTRY_FREELY;
    }
    return status;
}

int registry_place(struct registry_object *object, const struct registry_motion *motion)
{
    uint32_t format = motion->is_rigid ? PCCD_FORMAT_F64 : motion->format;
    size_t each;
    int status;

    assert(object->x1 == NULL && is_within(object, motion));
    if (motion->is_rigid && is_whole(object, motion)) {
        memcpy(object->m, motion->end, sizeof object->m);
        object->placing = REGISTRY_RIGID;
        return 0;
    }
    if (is_whole(object, motion)) {
        status = allocate(object, format);
        object->placing = status == 0 ? REGISTRY_FREELY : object->placing;
    } else {
        status = materialise(object, format);
    }
    if (status != 0) {
        return status;
    }
    each = common_vertex_bytes(object->format);
    if (motion->is_rigid) {
        transform(object->mesh, motion->end, motion->first, motion->count,
                  (double(*)[3])object->x + motion->first);
    } else if (motion->format == object->format) {
        memcpy((uint8_t *)object->x + motion->first * each, motion->end,
               motion->count * each);
    } else {
        widen((double(*)[3])object->x + motion->first, motion->end, motion->format,
              motion->count);
    }
    return 0;
}

/* ---- both ends --------------------------------------------------------------------- */

int registry_follow(struct registry_object *object)
{
    const struct registry_mesh *mesh = object->mesh;
    size_t bytes = mesh->vertex_count * sizeof *object->x0;
    double(*x0)[3] = malloc(bytes);
    double(*x1)[3] = malloc(bytes);

    if (x0 == NULL || x1 == NULL) {
        free(x0);
        free(x1);
        return PCCD_E_NOMEM;
    }
    free(object->x0);
    free(object->x1);
    object->x0 = x0;
    object->x1 = x1;
    widen(x0, mesh->x, mesh->format, mesh->vertex_count);
    memcpy(x1, x0, bytes);
    return 0;
}

void registry_begin_step(struct registry_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        struct registry_object *object = &scene->objects[i];

        assert(object->x0 != NULL && object->x1 != NULL);
        memcpy(object->x0, object->x1, object->mesh->vertex_count * sizeof *object->x0);
        object->turned = false;
    }
}

static void move_end(struct registry_object *object, const struct registry_motion *motion,
                     const void *from, double (*to)[3])
{
    if (motion->is_rigid) {
        transform(object->mesh, from, motion->first, motion->count, to + motion->first);
    } else {
        widen(to + motion->first, from, motion->format, motion->count);
    }
}

void registry_move(struct registry_object *object, const struct registry_motion *motion)
{
    assert(object->x1 != NULL && is_within(object, motion));
    if (motion->start != NULL) {
        move_end(object, motion, motion->start, object->x0);
    }
    move_end(object, motion, motion->end, object->x1);
    object->placing = REGISTRY_FREELY;
}

/* Return the first stray of one end, counted from motion->first. */
static uint32_t stray_at(const struct registry_object *object,
                         const struct registry_motion *motion, const void *from)
{
    double m[12], x[3], to[3];

    if (from == NULL) {
        return motion->count;
    }
    if (!motion->is_rigid) {
        return (uint32_t)common_first_stray(from, motion->format, motion->count);
    }
    memcpy(m, from, sizeof m);
    for (uint32_t i = 0; i < motion->count; i++) {
        registry_registered(object->mesh, motion->first + i, x);
        common_transform(m, x, to);
        if (common_first_stray(to, PCCD_FORMAT_F64, 1) == 0) {
            return i;
        }
    }
    return motion->count;
}

uint32_t registry_first_stray(const struct registry_object *object,
                              const struct registry_motion *motion)
{
    uint32_t start, end;

    assert(is_within(object, motion));
    start = stray_at(object, motion, motion->start);
    end = stray_at(object, motion, motion->end);
    return motion->first + (start < end ? start : end);
}

/* ---- life -------------------------------------------------------------------------- */

int registry_reset(struct registry_object *object, uint64_t step)
{
    free(object->x);
    object->x = NULL;
    object->placing = REGISTRY_AS_REGISTERED;
    object->since = step;
    return object->x1 != NULL ? registry_follow(object) : 0;
}

void registry_free_positions(struct registry_object *object)
{
    free(object->x);
    free(object->x0);
    free(object->x1);
    object->x = NULL;
    object->x0 = object->x1 = NULL;
}
