/* truth_engine.c - steps of the engine on public scenes and queries. */
#include "truth_engine.h"

#include "eng_way.h"

uint32_t truth_way_count(void)
{
    return 1 + WAY_METHODS * way_kernels_count();
}

struct eng_question truth_way(uint32_t i)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.method = i == 0 ? PCCD_METHOD_PAPER : way_methods[(i - 1) % WAY_METHODS];
    settings.kernels = i == 0 ? NULL : way_kernels((i - 1) / WAY_METHODS);
    settings.threads = i == 0 ? 1 : 1 + i % 4;
    settings.team_always = true;
    return settings;
}

struct eng_mesh *truth_mesh(const struct oracle_object *object)
{
    return kit_mesh(object->x0, object->vertex_count, object->triangles,
                    object->triangle_count);
}

struct eng_scene *truth_run(struct eng_mesh *mesh, const struct oracle_object *object,
                            const struct eng_object_thickness *thickness,
                            const struct eng_question *settings,
                            struct eng_step_result *result)
{
    uint32_t object_idx;
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, mesh, 0, &object_idx));
    if (thickness) {
        assert_ok(eng_scene_set_thickness(scene, object_idx, thickness));
    }
    eng_stage_begin(scene);
    assert_ok(eng_stage_x1(scene, object_idx, PCCD_FORMAT_F64, 0, object->vertex_count,
                           object->x1));
    assert_ok(eng_step(scene, settings, result));
    return scene;
}

static const uint32_t vf_triangles[2][3] = {{1, 2, 3}, {0, 4, 5}};
static const int vf_points[6] = {0, 1, 2, 3, 0, 0};
static const uint32_t ee_triangles[2][3] = {{0, 1, 4}, {2, 3, 5}};
static const int ee_points[6] = {0, 1, 2, 3, 0, 2};

void truth_two_init(struct truth_two *two, bool is_vf, const double p[8][3])
{
    const int *points = is_vf ? vf_points : ee_points;
    for (int k = 0; k < 12; k++) {
        memcpy(two->x[k / 6][k % 6], p[4 * (k / 6) + points[k % 6]], sizeof two->x[0][0]);
    }
    two->object =
        (struct oracle_object){.vertex_count = 6,
                               .triangle_count = 2,
                               .x0 = (truth_points)two->x[0],
                               .x1 = (truth_points)two->x[1],
                               .triangles = is_vf ? vf_triangles : ee_triangles};
}

const struct pccd_contact *truth_two_find(bool is_vf, const struct eng_mesh *mesh,
                                          const struct eng_step_result *result)
{
    const struct pccd_contact *contacts = result->records;
    const uint32_t(*edges)[2] = eng_mesh_edges(mesh);
    for (uint64_t i = 0; i < result->count; i++) {
        uint32_t a = contacts[i].feature_a;
        uint32_t b = contacts[i].feature_b;
        if (contacts[i].kind == (is_vf ? PCCD_VF : PCCD_EE) &&
            (is_vf ? a == 0 && b == 0
                   : edges[a][0] == 0 && edges[a][1] == 1 && edges[b][0] == 2 &&
                         edges[b][1] == 3)) {
            return &contacts[i];
        }
    }
    return NULL;
}
