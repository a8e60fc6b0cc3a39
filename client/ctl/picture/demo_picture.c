/* demo_picture.c - the demo's last step as a picture. */
#include "cloth_scene.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "picture.h"
#include "printable.h"

static const float eye_direction[3] = {0.45f, 0.32f, 1.0f};

static const struct demo_object *find_object(const struct demo_object objects[2],
                                             uint32_t object)
{
    if (objects[0].object == object) {
        return &objects[0];
    }
    return objects[1].object == object ? &objects[1] : NULL;
}

/* Where the contact lies at the end of the step; false when the record names something
 * that is not in the scene. */
static bool locate(const struct demo_object objects[2],
                   const struct pccd_contact *contact, float at[3])
{
    const struct demo_object *a = find_object(objects, contact->object_a);
    const struct demo_object *b = find_object(objects, contact->object_b);
    if (a == NULL || b == NULL) {
        return false;
    }
    if (contact->kind == PCCD_VF) {
        if (contact->feature_b >= b->triangle_count) {
            return false;
        }
        const uint32_t *v = b->triangles[contact->feature_b];
        float second = contact->param[0], third = contact->param[1];
        for (uint32_t k = 0; k < 3; k++) {
            at[k] = (1.0f - second - third) * b->x[v[0]][k] + second * b->x[v[1]][k] +
                    third * b->x[v[2]][k];
        }
        return true;
    }
    if (contact->kind != PCCD_EE) {
        return false;
    }
    const struct pccd_edge *edge = &a->edges[contact->feature_a];
    for (uint32_t k = 0; k < 3; k++) {
        at[k] =
            a->x[edge->a][k] + contact->param[0] * (a->x[edge->b][k] - a->x[edge->a][k]);
    }
    return true;
}

int demo_picture_write(const struct demo_object objects[2], const struct demo_met *met,
                       FILE *file, const char *path, struct ctl_error *error)
{
    const struct picture_mesh meshes[2] = {{.x = objects[0].x,
                                            .triangles = objects[0].triangles,
                                            .vertex_count = objects[0].vertex_count,
                                            .triangle_count = objects[0].triangle_count,
                                            .front = {0.33f, 0.52f, 0.80f},
                                            .back = {0.55f, 0.63f, 0.75f}},
                                           {.x = objects[1].x,
                                            .triangles = objects[1].triangles,
                                            .vertex_count = objects[1].vertex_count,
                                            .triangle_count = objects[1].triangle_count,
                                            .front = {1.00f, 0.84f, 0.60f},
                                            .back = {0.60f, 0.45f, 0.30f}}};
    struct picture_group groups[2] = {{.colour = {0.90f, 0.22f, 0.10f}},
                                      {.colour = {0.98f, 0.84f, 0.10f}}};
    char title[96];
    struct picture_mark *marks = malloc(((size_t)met->count + 1) * sizeof *marks);
    uint32_t mark_count = 0;
    if (marks == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the picture", path);
    }
    for (uint64_t i = 0; i < met->count; i++) {
        const struct pccd_contact *contact = &met->contacts[i];
        struct picture_mark mark = {.group = contact->kind == PCCD_VF ? 0 : 1};
        if (locate(objects, contact, mark.at)) {
            marks[mark_count++] = mark;
        }
    }
    snprintf(title, sizeof title, "pccd demo, step %" PRIu64 ", %" PRIu32 " triangles",
             met->frame, objects[0].triangle_count + objects[1].triangle_count);
    snprintf(groups[0].label, sizeof groups[0].label, "%" PRIu64 " vertex-face %s",
             met->vf, proto_plural(met->vf, "contact", "contacts"));
    snprintf(groups[1].label, sizeof groups[1].label, "%" PRIu64 " edge-edge %s", met->ee,
             proto_plural(met->ee, "contact", "contacts"));
    struct picture picture = {.meshes = meshes,
                              .marks = marks,
                              .groups = groups,
                              .mesh_count = 2,
                              .mark_count = mark_count,
                              .group_count = 2,
                              .title = title};
    memcpy(picture.from, eye_direction, sizeof picture.from);
    int status = picture_write(&picture, file, path, error);
    free(marks);
    return status;
}
