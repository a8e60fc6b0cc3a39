/* record_refit.c - what the refit costs, part by part. */
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
    double ns = (double)(common_now_ns() - begin_ns) - clock_ns;
    return ns > 0 ? ns : 0;
}

void model_refit_features(struct model_record *record)
{
    struct eng_scene *scene = record->scene;
    struct bench_samples vertices = {0};
    struct bench_samples edges = {0};
    for (uint32_t pass = 0; pass <= record->passes; pass++) {
        double vertex_ns = 0;
        double edge_ns = 0;
        for (uint32_t i = 0; i < scene->object_capacity; i++) {
            const struct eng_object *object = &scene->objects[i];
            if (!object->mesh) {
                continue;
            }
            uint64_t begin_ns = common_now_ns();
            eng_refit_vertices(scene, object->vertices);
            vertex_ns += since(begin_ns, record->clock_ns);
            begin_ns = common_now_ns();
            eng_refit_edges(scene, eng_planted_of(object)->edges);
            edge_ns += since(begin_ns, record->clock_ns);
        }
        if (pass > 0) {
            bench_add(&vertices, vertex_ns);
            bench_add(&edges, edge_ns);
        }
    }
    record->refit_scale = 1;
    record->vertices_ns = median(&vertices);
    record->edges_ns = median(&edges);
    bench_free(&vertices);
    bench_free(&edges);
}

static void refit_once(struct eng_scene *scene, const struct eng_refit_plan *plan,
                       double clock_ns, struct bench_samples *samples)
{
    for (uint32_t i = 0; i < plan->root_count; i++) {
        uint64_t begin_ns = common_now_ns();
        eng_refit_subtree(scene, plan->roots[i]);
        bench_add(&samples[i], since(begin_ns, clock_ns));
    }
    uint64_t begin_ns = common_now_ns();
    for (uint32_t i = plan->opened_count; i-- > 0;) {
        eng_refit_nodes(scene, (struct eng_range){plan->opened[i], 1});
    }
    bench_add(&samples[plan->root_count], since(begin_ns, clock_ns));
}

void model_refit_init(struct model_refit *refit, const struct model_record *record,
                      enum eng_refit_scheme scheme, uint32_t threads)
{
    struct eng_scene *scene = record->scene;
    memset(refit, 0, sizeof *refit);
    struct eng_refit_plan *plan = &refit->plan;
    model_must(eng_refit_plan_features(plan, scene) == PCCD_OK &&
                   eng_refit_plan_tree(plan, scene, scheme, threads) == PCCD_OK,
               "a plan of the refit");
    uint32_t count = plan->root_count + 1;
    struct bench_samples *samples = bench_alloc(count, sizeof *samples);
    memset(samples, 0, count * sizeof *samples);
    for (uint32_t pass = 0; pass < record->passes; pass++) {
        refit_once(scene, plan, record->clock_ns, samples);
    }
    refit->root_ns = bench_alloc(count, sizeof *refit->root_ns);
    for (uint32_t i = 0; i < count; i++) {
        refit->root_ns[i] = record->refit_scale * median(&samples[i]);
        bench_free(&samples[i]);
    }
    refit->node_ns = plan->opened_count > 0
                         ? refit->root_ns[plan->root_count] / plan->opened_count
                         : 0;
    free(samples);
}

void model_refit_calibrate(struct model_record *record, double refit_ns)
{
    struct model_refit alone;
    model_refit_init(&alone, record, ENG_REFIT_EVEN, 1);
    record->refit_scale = refit_ns / model_refit_ns(&alone, record);
    record->vertices_ns *= record->refit_scale;
    record->edges_ns *= record->refit_scale;
    model_refit_deinit(&alone);
}

double model_refit_ns(const struct model_refit *refit, const struct model_record *record)
{
    double ns = record->vertices_ns + record->edges_ns;
    for (uint32_t i = 0; i < refit->plan.root_count; i++) {
        ns += refit->root_ns[i];
    }
    return ns + refit->node_ns * refit->plan.opened_count;
}

void model_refit_deinit(struct model_refit *refit)
{
    free(refit->root_ns);
    eng_refit_plan_deinit(&refit->plan);
    memset(refit, 0, sizeof *refit);
}
