/* contacts_csv.c - contacts as lines of text. */
#include "check_run.h"

#include <inttypes.h>
#include <string.h>

#include "kinds.h"
#include "output.h"

int contacts_csv_open(struct contacts_csv *csv, struct ctl_error *error)
{
    int status = output_open(&csv->whole, csv->path, true, error);
    if (status == PCCD_OK) {
        fprintf(csv->whole.to, "%skind,i0,i1,i2,i3,toi,toi_hi,proved%s\n",
                csv->has_step ? "step," : "",
                csv->objects != NULL ? ",object_a,object_b" : "");
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

/* The record up to its four vertices; those that a kind does not have are empty. */
static void print_features(const struct contacts_csv *csv, uint32_t step, uint32_t kind,
                           uint32_t a, uint32_t b)
{
    FILE *to = csv->whole.to;
    if (csv->has_step) {
        fprintf(to, "%" PRIu32 ",", step);
    }
    if (kind >= PCCD_KIND_COUNT) {
        fprintf(to, "%" PRIu32 ",,,,", kind); /* of a newer daemon */
        return;
    }
    const uint32_t *points = common_kinds[kind].points;
    fputs(common_kinds[kind].name, to);
    uint32_t printed = csv_vertices(to, points[0], a, csv->edges, csv->triangles);
    printed += csv_vertices(to, points[1], b, csv->edges, csv->triangles);
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

static void end_record(const struct contacts_csv *csv, uint32_t kind, uint32_t a,
                       uint32_t b)
{
    if (csv->objects != NULL && kind < PCCD_KIND_COUNT) {
        const struct ctl_mesh *mesh = csv->objects->mesh;
        const uint32_t *points = common_kinds[kind].points;
        print_name(csv->whole.to,
                   report_object(mesh, objects_of(csv->objects, points[0], a)));
        print_name(csv->whole.to,
                   report_object(mesh, objects_of(csv->objects, points[1], b)));
    } else if (csv->objects != NULL) {
        fputs(",,", csv->whole.to);
    }
    fputc('\n', csv->whole.to);
}

void contacts_csv_page(const struct contacts_csv *csv, uint32_t step,
                       const struct pccd_answer *page)
{
    for (uint64_t i = 0; i < page->count && page->contacts != NULL; i++) {
        const struct pccd_contact *contact = &page->contacts[i];
        print_features(csv, step, contact->kind, contact->feature_a, contact->feature_b);
        fprintf(csv->whole.to, ",%.17g,%.17g,%d", contact->toi, contact->toi_hi,
                (contact->flags & PCCD_PROVED) != 0);
        end_record(csv, contact->kind, contact->feature_a, contact->feature_b);
    }
    for (uint64_t i = 0; i < page->count && page->pairs != NULL; i++) {
        const struct pccd_pair *pair = &page->pairs[i];
        print_features(csv, step, pair->kind, pair->feature_a, pair->feature_b);
        fputs(",,,0", csv->whole.to);
        end_record(csv, pair->kind, pair->feature_a, pair->feature_b);
    }
}
