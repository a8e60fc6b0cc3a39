/* bench/model/record_refit.c - what the refit costs, part by part.
 *
 * Room:     bench/model.
 * Does:     time vertices, edges and every subtree of the engine's plan; medians.
 * Threads:  one.
 */
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "record.h"
#include "refit.h"
#include "report.h"

static double median(struct bench_samples *samples)
{
    double p50 = bench_summarise(samples).p50;
    bench_clear(samples);
    return p50;
}

static double since(uint64_t begin_ns, double clock_ns)
{
    double ns = (double)(eng_now_ns() - begin_ns) - clock_ns;
    return ns > 0 ? ns : 0;
}

/* The record describes a scene that others only read; the refit writes the boxes that are
 * there already. */
static struct eng_scene *writable(const struct model_record *record)
{
    return (struct eng_scene *)(uintptr_t)record->scene;
}

void model_refit_features(struct model_record *record)
{
    struct eng_scene *scene = writable(record);
    struct bench_samples vertices = {0};
    struct bench_samples edges = {0};
    uint32_t vertex_count = 0;
    uint32_t edge_count = 0;
    for (uint32_t pass = 0; pass <= record->passes; pass++) {
        double vertex_ns = 0;
        double edge_ns = 0;
        vertex_count = 0;
        edge_count = 0;
        for (uint32_t i = 0; i < scene->object_capacity; i++) {
            const struct eng_object *object = &scene->objects[i];
            if (!object->mesh) {
                continue;
            }
            uint64_t begin_ns = eng_now_ns();
            eng_refit_vertices(scene, object->vertices);
            vertex_ns += since(begin_ns, record->clock_ns);
            begin_ns = eng_now_ns();
            eng_refit_edges(scene, object->edges);
            edge_ns += since(begin_ns, record->clock_ns);
            vertex_count += object->vertices.count;
            edge_count += object->edges.count;
        }
        if (pass > 0) {
            bench_add(&vertices, vertex_ns);
            bench_add(&edges, edge_ns);
        }
    }
    record->vertex_count = vertex_count;
    record->edge_count = edge_count;
    record->vertices_ns = median(&vertices);
    record->edges_ns = median(&edges);
    bench_free(&vertices);
    bench_free(&edges);
}

void model_refit_init(struct model_refit *refit, const struct model_record *record,
                      uint32_t wanted)
{
    struct eng_scene *scene = writable(record);
    struct eng_refit_plan plan = {0};
    if (eng_refit_plan(&plan, scene, wanted) != ENG_OK) {
        exit(2);
    }
    refit->subtree_count = plan.count - plan.opened;
    refit->subtree_ns = bench_alloc(refit->subtree_count, sizeof *refit->subtree_ns);
    struct bench_samples *samples =
        bench_alloc(refit->subtree_count + 1, sizeof *samples);
    memset(samples, 0, (refit->subtree_count + 1) * sizeof *samples);
    for (uint32_t pass = 0; pass <= record->passes; pass++) {
        for (uint32_t i = 0; i < refit->subtree_count; i++) {
            uint32_t root = plan.nodes[plan.opened + i];
            uint64_t begin_ns = eng_now_ns();
            eng_refit_nodes(scene,
                            (struct eng_range){root, 2 * scene->nodes[root].count - 1});
            if (pass > 0) {
                bench_add(&samples[i], since(begin_ns, record->clock_ns));
            }
        }
        uint64_t begin_ns = eng_now_ns();
        for (uint32_t i = plan.opened; i-- > 0;) {
            eng_refit_nodes(scene, (struct eng_range){plan.nodes[i], 1});
        }
        eng_refit_nodes(scene, scene->top);
        if (pass > 0) {
            bench_add(&samples[refit->subtree_count], since(begin_ns, record->clock_ns));
        }
    }
    for (uint32_t i = 0; i < refit->subtree_count; i++) {
        refit->subtree_ns[i] = median(&samples[i]);
        bench_free(&samples[i]);
    }
    refit->top_ns = median(&samples[refit->subtree_count]);
    bench_free(&samples[refit->subtree_count]);
    free(samples);
    eng_refit_plan_deinit(&plan);
}

void model_refit_deinit(struct model_refit *refit)
{
    free(refit->subtree_ns);
    memset(refit, 0, sizeof *refit);
}
