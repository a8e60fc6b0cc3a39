/* eng_blast.c - a sheet that flies to pieces, again and again. */
#include "eng_blast.h"

#include "trees.h"

/* Corners of the two triangles of a square. */
static const double corners[6][2] = {{0, 0}, {0.9, 0}, {0, 0.9},
                                     {1, 1}, {0.1, 1}, {1, 0.1}};

void blast_init(struct blast *blast, const struct eng_scene_settings *settings)
{
    static uint32_t triangles[BLAST_TRIANGLES][3];
    struct prng random = {61};
    for (uint32_t v = 0; v < BLAST_VERTICES; v++) {
        uint32_t square = v / 6;
        blast->rest[v][0] = (square % BLAST_SIDE + corners[v % 6][0]) / BLAST_SIDE;
        blast->rest[v][1] = (square / BLAST_SIDE + corners[v % 6][1]) / BLAST_SIDE;
        blast->rest[v][2] = 0.1 * blast->rest[v][0] + prng_between(&random, 0, 0.01);
        for (int k = 0; k < 3; k++) {
            blast->velocity[v][k] =
                v % 3 == 0 ? prng_between(&random, -1, 1) : blast->velocity[v - 1][k];
        }
        triangles[v / 3][v % 3] = v;
    }
    struct eng_mesh *mesh =
        kit_mesh(blast->rest, BLAST_VERTICES, triangles, BLAST_TRIANGLES);
    assert_ok(eng_scene_new(settings, &blast->scene));
    blast->idx = kit_add(blast->scene, mesh, 1);
}

void blast_deinit(struct blast *blast)
{
    eng_scene_free(blast->scene);
}

static void place(const struct blast *blast, double t, double (*x)[3])
{
    for (uint32_t v = 0; v < BLAST_VERTICES; v++) {
        for (int k = 0; k < 3; k++) {
            x[v][k] = blast->rest[v][k] + t * blast->velocity[v][k];
        }
    }
}

struct eng_step_result blast_run(struct blast *blast, double t0, double t1,
                                 struct eng_question settings)
{
    static double x0[BLAST_VERTICES][3];
    static double x1[BLAST_VERTICES][3];
    place(blast, t0, x0);
    place(blast, t1, x1);
    eng_stage_begin(blast->scene);
    assert_ok(eng_stage_x0x1(blast->scene, blast->idx, PCCD_FORMAT_F64, 0, BLAST_VERTICES,
                             x0, x1));
    struct eng_step_result result = kit_step(blast->scene, &settings);
    assert_true(eng_tree_validate(blast->scene));
    return result;
}

void blast_rebuild(struct blast *blast)
{
    assert_ok(eng_paper_add_objects(blast->scene));
    assert_ok(eng_build_object(blast->scene, blast->idx));
    eng_trees_of(blast->scene)->top_is_stale = true;
}
