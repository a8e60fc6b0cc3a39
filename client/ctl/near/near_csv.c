/* near_csv.c - what is near as lines of text. */
#include "near_run.h"

#include <inttypes.h>
#include <stdlib.h>

#include "kinds.h"
#include "output.h"

#define POINTS_MAX 5 /* of an edge and a face */

/* Bounds come by increasing handle. An insertion sort: files are few, and nearly so. */
static bool sort_objects(struct near_csv *csv)
{
    const struct near_run *near = csv->near;
    csv->order = malloc(near->scene.object_count * sizeof *csv->order);
    for (uint32_t i = 0; csv->order != NULL && i < near->scene.object_count; i++) {
        uint32_t at = i;
        while (at > 0 && near->scene.objects[csv->order[at - 1]].handle >
                             near->scene.objects[i].handle) {
            csv->order[at] = csv->order[at - 1];
            at--;
        }
        csv->order[at] = i;
    }
    return csv->order != NULL;
}

static bool has_place(const struct near_csv *csv)
{
    return csv->has_place && csv->near->settings.what != PCCD_NEAR_VERTICES;
}

int near_csv_open(struct near_csv *csv, struct ctl_error *error)
{
    if (csv->path == NULL) {
        return PCCD_OK;
    }
    if (!sort_objects(csv)) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the CSV");
    }
    int status = output_open(&csv->whole, csv->path, true, error);
    if (status == PCCD_OK) {
        fprintf(csv->whole.to, "%s%s\n",
                csv->near->settings.what == PCCD_NEAR_VERTICES
                    ? "object,vertex,bound"
                    : "kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz",
                has_place(csv) ? ",x,y,z" : "");
    }
    return status;
}

static uint32_t print_vertices(FILE *to, const struct scene_object *object,
                               uint32_t points, uint32_t feature)
{
    return csv_vertices(to, points, feature, object->edges,
                        (const uint32_t(*)[3])object->files.mesh.triangles.vertices);
}

/* The point of b; empty where there is none. */
static void print_place(const struct near_csv *csv, const struct pccd_near *record,
                        uint32_t a, uint32_t b)
{
    struct near_run *near = csv->near;
    struct scene_object *objects = near->scene.objects;
    const uint32_t *points = common_kinds[record->kind].points;
    struct place_feature ends[2];
    double at[2][3];
    if (!has_place(csv)) {
        return;
    }
    if (scene_feature(&objects[a], near->run.client, 0, points[0], record->feature_a,
                      &ends[0]) != PCCD_OK ||
        scene_feature(&objects[b], near->run.client, 0, points[1], record->feature_b,
                      &ends[1]) != PCCD_OK) {
        fputs(",,,", csv->whole.to);
        return;
    }
    place_find(record->kind, record->param, ends, 0, at);
    for (int k = 0; k < 3; k++) {
        csv_number(csv->whole.to, at[1][k]);
    }
}

static void print_record(const struct near_csv *csv, const struct pccd_near *record)
{
    const struct near_run *near = csv->near;
    FILE *to = csv->whole.to;
    uint32_t type = PCCD_NEAR_TYPE(record->flags), printed;
    uint32_t a = scene_place_of(&near->scene, record->object_a);
    uint32_t b = scene_place_of(&near->scene, record->object_b);
    if (record->kind >= COMMON_KIND_COUNT || a == near->scene.object_count ||
        b == near->scene.object_count) {
        /* Of a newer daemon. */
        fprintf(to, "%" PRIu32 ",,,,,,,,,,,,,,,,%s\n", record->kind,
                has_place(csv) ? ",,," : "");
        return;
    }
    const uint32_t *points = common_kinds[record->kind].points;
    fprintf(to, "%s,%s,%" PRIu32 ",%" PRIu32, common_kinds[record->kind].name,
            record->kind != PCCD_EF && type < PCCD_EF ? common_kinds[type].name : "",
            a + 1, b + 1);
    printed = print_vertices(to, &near->scene.objects[a], points[0], record->feature_a);
    printed += print_vertices(to, &near->scene.objects[b], points[1], record->feature_b);
    for (; printed < POINTS_MAX; printed++) {
        fputc(',', to);
    }
    fprintf(to, ",%.17g,%.17g,%" PRIu32, record->d_lo, record->d_hi, record->count);
    fprintf(to, ",%.9g,%.9g,%.9g,%.9g,%.9g", (double)record->param[0],
            (double)record->param[1], (double)record->direction[0],
            (double)record->direction[1], (double)record->direction[2]);
    print_place(csv, record, a, b);
    fputc('\n', to);
}

/* Bounds of a page, whose first is number page->first of all objects' vertices. */
static void print_bounds(const struct near_csv *csv, const struct pccd_answer *page)
{
    const struct near_run *near = csv->near;
    uint64_t vertex = page->first;
    uint32_t at = 0;
    for (uint64_t i = 0; i < page->count; i++, vertex++) {
        while (at < near->scene.object_count &&
               vertex >= near->scene.objects[csv->order[at]].info.vertex_count) {
            vertex -= near->scene.objects[csv->order[at++]].info.vertex_count;
        }
        if (at == near->scene.object_count) {
            return; /* more than there are vertices */
        }
        fprintf(csv->whole.to, "%" PRIu32 ",%" PRIu64 ",%.17g\n", csv->order[at] + 1,
                vertex, page->vertex_bounds[i]);
    }
}

void near_csv_page(void *context, const struct pccd_answer *page)
{
    const struct near_csv *csv = context;
    if (page->vertex_bounds != NULL) {
        print_bounds(csv, page);
    }
    for (uint64_t i = 0; page->near != NULL && i < page->count; i++) {
        print_record(csv, &page->near[i]);
    }
}

int near_csv_close(struct near_csv *csv, bool is_whole, struct ctl_error *error)
{
    free(csv->order);
    csv->order = NULL;
    return output_close(&csv->whole, csv->path, is_whole, error);
}
