/* near_kit.c - asks in every way that must not matter. */
#include "near_kit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eng_way.h"

void near_kit_begin(struct near_kit *kit)
{
    memset(kit, 0, sizeof *kit);
    assert_int_equal(eng_scene_new(NULL, &kit->scene), PCCD_OK);
}

void near_kit_end(struct near_kit *kit)
{
    eng_scene_free(kit->scene);
}

void near_kit_add(struct near_kit *kit, struct eng_mesh *mesh)
{
    uint32_t i = kit->count++;
    assert_true(i < sizeof kit->idx / sizeof kit->idx[0]);
    assert_int_equal(eng_scene_add(kit->scene, mesh, i + 1, &kit->idx[i]), PCCD_OK);
    eng_mesh_release(mesh);
}

struct eng_mesh *near_kit_box(const double low[3], const double high[3], bool inward)
{
    static const uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    double x[8][3];
    uint32_t triangles[12][3];
    for (uint32_t i = 0; i < 8; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            x[i][k] = (i >> k & 1u) != 0 ? high[k] : low[k];
        }
    }
    for (uint32_t i = 0; i < 12; i++) {
        const uint32_t *side = sides[i / 2];
        triangles[i][0] = side[0];
        triangles[i][1] = inward ? side[2 + i % 2] : side[1 + i % 2];
        triangles[i][2] = inward ? side[1 + i % 2] : side[2 + i % 2];
    }
    return kit_mesh((const double(*)[3])x, 8, (const uint32_t(*)[3])triangles, 12);
}

struct eng_question near_kit_settings(enum pccd_near_what what)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.verb = what;
    settings.end = 1;
    settings.distance = what == PCCD_NEAR_NEAREST ? INFINITY : 0;
    return settings;
}

struct eng_step_result near_kit_ask(struct near_kit *kit,
                                    const struct eng_question *settings)
{
    struct eng_question way = *settings;
    struct eng_step_result result = {0};
    void *kept = NULL;
    uint64_t count = 0;
    for (uint32_t i = 0; i < WAY_METHODS * way_kernels_count() * 3; i++) {
        way.method = way_methods[i % WAY_METHODS];
        way.threads = 1 + i / WAY_METHODS % 3;
        way.kernels = way_kernels(i / WAY_METHODS / 3);
        way.team_always = true;
        assert_int_equal(eng_near(kit->scene, &way, &result), PCCD_OK);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        if (i == 0) {
            count = result.count;
            kept = malloc((size_t)count * result.record_bytes + 1);
            assert_non_null(kept);
            if (count > 0) { /* else there may be no records to point to */
                memcpy(kept, result.records, (size_t)count * result.record_bytes);
            }
        }
        assert_int_equal(result.count, count);
        if (settings->gap == 0 && count > 0) {
            assert_memory_equal(result.records, kept,
                                (size_t)count * result.record_bytes);
        }
    }
    free(kept);
    return result;
}
