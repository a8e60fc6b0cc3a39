/* contacts_csv.c - contacts as lines of text. */
#include "check_run.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

int contacts_csv_open(struct contacts_csv *csv, struct ctl_error *error)
{
    int status = output_open(&csv->whole, csv->path, true, error);
    if (status == PCCD_OK) {
        fprintf(csv->whole.to, "%skind,i0,i1,i2,i3,toi,toi_hi,proved%s%s%s\n",
                csv->has_step ? "step," : "", csv->has_names ? ",object_a,object_b" : "",
                csv->scene == NULL  ? ""
                : csv->has_geometry ? ",ax,ay,az,bx,by,bz,nx,ny,nz"
                                    : ",x,y,z",
                csv->has_touching ? ",touching" : "");
    }
    return status;
}

uint32_t csv_vertices(FILE *to, uint32_t points, uint32_t feature,
                      const struct pccd_edge *edges, const uint32_t (*triangles)[3])
{
    if (points == 1) {
        fprintf(to, ",%" PRIu32, feature);
    } else if (points == 2) {
        fprintf(to, ",%" PRIu32 ",%" PRIu32, edges[feature].a, edges[feature].b);
    } else {
        const uint32_t *face = triangles[feature];
        fprintf(to, ",%" PRIu32 ",%" PRIu32 ",%" PRIu32, face[0], face[1], face[2]);
    }
    return points;
}

/* The vertices of a record's feature, by the file of its object. */
static uint32_t print_feature(const struct contacts_csv *csv, uint32_t handle,
                              uint32_t points, uint32_t feature)
{
    const struct objects_of *object = objects_find(csv->objects, handle);
    return csv_vertices(csv->whole.to, points, feature, object->edges,
                        (const uint32_t(*)[3])object->mesh->triangles.vertices);
}

/* The record up to its four vertices; those that a kind does not have are empty. */
static void print_features(const struct contacts_csv *csv, uint32_t step,
                           const struct pccd_pair *pair)
{
    FILE *to = csv->whole.to;
    if (csv->has_step) {
        fprintf(to, "%" PRIu32 ",", step);
    }
    if (pair->kind >= PCCD_KIND_COUNT) {
        fprintf(to, "%" PRIu32 ",,,,", pair->kind); /* of a newer daemon */
        return;
    }
    const uint32_t *points = common_kinds[pair->kind].points;
    fputs(common_kinds[pair->kind].name, to);
    uint32_t printed = print_feature(csv, pair->object_a, points[0], pair->feature_a);
    printed += print_feature(csv, pair->object_b, points[1], pair->feature_b);
    for (; printed < 4; printed++) {
        fputc(',', to);
    }
}

/* A comma and a name, in quotes if it has what would end it. */
static void print_name(FILE *file, const char *name)
{
    bool is_quoted = strpbrk(name, ",\"\r\n") != NULL;
    fputs(is_quoted ? ",\"" : ",", file);
    for (; *name != '\0'; name++) {
        fputs(*name == '"' ? "\"" : "", file);
        fputc(*name, file);
    }
    fputs(is_quoted ? "\"" : "", file);
}

void csv_number(FILE *to, double x)
{
    char text[32];
    int digits = 15;
    do {
        snprintf(text, sizeof text, "%.*g", digits, x);
    } while (digits++ < 17 && strtod(text, NULL) != x);
    fprintf(to, ",%s", text);
}

/* The point of the second feature when they meet, or that of both and the normal; empty
 * where there is no place. */
static void print_place(const struct contacts_csv *csv, uint32_t step,
                        const struct pccd_contact *contact)
{
    FILE *to = csv->whole.to;
    struct scene *scene = csv->scene;
    struct place_feature ends[2];
    double at[2][3];
    bool is_known = contact != NULL && contact->kind < PCCD_KIND_COUNT;
    for (uint32_t side = 0; side < 2 && is_known; side++) {
        uint32_t place =
            scene_place_of(scene, side == 0 ? contact->object_a : contact->object_b);
        is_known = place < scene->object_count &&
                   scene_feature(&scene->objects[place], NULL, step,
                                 common_kinds[contact->kind].points[side],
                                 side == 0 ? contact->feature_a : contact->feature_b,
                                 &ends[side]) == PCCD_OK;
    }
    if (!is_known) {
        fputs(csv->has_geometry ? ",,,,,,,,," : ",,,", to);
        return;
    }
    place_find(contact->kind, contact->param, ends, place_time(contact), at);
    for (uint32_t i = csv->has_geometry ? 0 : 3; i < 6; i++) {
        csv_number(to, at[i / 3][i % 3]);
    }
    for (uint32_t k = 0; csv->has_geometry && k < 3; k++) {
        csv_number(to, (double)contact->normal[k]);
    }
}

/* ",enters", and so on; a comma alone where it did not touch. */
static void print_touching(FILE *to, const struct pccd_contact *contact)
{
    uint32_t flags = contact != NULL ? contact->flags : 0;
    fputs((flags & PCCD_ENTERS) != 0   ? ",enters"
          : (flags & PCCD_SLIDES) != 0 ? ",slides"
          : (flags & PCCD_LEAVES) != 0 ? ",leaves"
                                       : ",",
          to);
}

static void end_record(const struct contacts_csv *csv, uint32_t step,
                       const struct pccd_pair *pair, const struct pccd_contact *contact)
{
    const struct objects *objects = csv->objects;
    if (csv->has_names && pair->kind < PCCD_KIND_COUNT) {
        const uint32_t *points = common_kinds[pair->kind].points;
        uint32_t a = objects_part(objects_find(objects, pair->object_a), points[0],
                                  pair->feature_a);
        uint32_t b = objects_part(objects_find(objects, pair->object_b), points[1],
                                  pair->feature_b);
        print_name(csv->whole.to, objects->names[a]);
        print_name(csv->whole.to, objects->names[b]);
    } else if (csv->has_names) {
        fputs(",,", csv->whole.to);
    }
    if (csv->scene != NULL) {
        print_place(csv, step, contact);
    }
    if (csv->has_touching) {
        print_touching(csv->whole.to, contact);
    }
    fputc('\n', csv->whole.to);
}

void contacts_csv_page(const struct contacts_csv *csv, uint32_t step,
                       const struct pccd_answer *page)
{
    for (uint64_t i = 0; i < page->count && page->contacts != NULL; i++) {
        const struct pccd_contact *contact = &page->contacts[i];
        const struct pccd_pair pair = {.kind = contact->kind,
                                       .object_a = contact->object_a,
                                       .object_b = contact->object_b,
                                       .feature_a = contact->feature_a,
                                       .feature_b = contact->feature_b};
        print_features(csv, step, &pair);
        fprintf(csv->whole.to, ",%.17g,%.17g,%d", contact->toi, contact->toi_hi,
                (contact->flags & PCCD_PROVED) != 0);
        end_record(csv, step, &pair, contact);
    }
    for (uint64_t i = 0; i < page->count && page->pairs != NULL; i++) {
        print_features(csv, step, &page->pairs[i]);
        fputs(",,,0", csv->whole.to);
        end_record(csv, step, &page->pairs[i], NULL);
    }
}
