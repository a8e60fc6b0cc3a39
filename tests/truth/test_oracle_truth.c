/* test_oracle_truth.c - the exact oracle agrees with the published truth. */
#include "cases.h"
#include "truth_kit.h"

struct tally {
    size_t queries;
    size_t wrong;
    int exponent; /* coordinates are scaled by 2^exponent */
    bool is_reversed;
    unsigned role; /* which exchange of roles */
};

/* Exchanges that leave the truth as it is: corners of the face, ends and order of
 * edges. */
static void exchange(bool is_vf, unsigned role, double (*p)[3])
{
    static const int vf[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 2, 1}, {0, 1, 3, 2}};
    static const int ee[4][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    const int *order = is_vf ? vf[role] : ee[role];
    double from[8][3];
    memcpy(from, p, sizeof from);
    for (int i = 0; i < 8; i++) {
        memcpy(p[i], from[(i & 4) + order[i & 3]], sizeof from[0]);
    }
}

static void compare_file(void *context, bool is_vf, const char *path,
                         const struct data_queries *queries)
{
    struct tally *tally = context;
    if (!queries->has_truth) {
        fail_msg("%s has no truth column", path);
    }
    for (size_t i = 0; i < queries->count; i++) {
        double p[8][3];
        for (int k = 0; k < 24; k++) {
            int row = k / 3;
            row = tally->is_reversed ? row ^ 4 : row;
            p[k / 3][k % 3] = ldexp(queries->p[i][row][k % 3], tally->exponent);
        }
        exchange(is_vf, tally->role, p);
        bool hits = oracle_hits(is_vf ? ORACLE_VF : ORACLE_EE, (truth_points)p);
        tally->queries++;
        if (hits != queries->truth[i]) {
            tally->wrong++;
            print_message("# %s, query %zu: %d, should be %d\n", path, i, hits,
                          queries->truth[i]);
        }
    }
}

static void compare_handmade(struct tally tally)
{
    if (data_handmade(compare_file, &tally) == 0) {
        test_skip("no hand-made queries in $PCCD_DATA");
    }
    print_message("# %zu queries, %zu wrong\n", tally.queries, tally.wrong);
    assert_int_equal(tally.queries, TRUTH_HANDMADE);
    assert_int_equal(tally.wrong, 0);
}

/* If this failed, the oracle would be wrong about touching, sliding or coplanar
 * motion. */
CASE(oracle__agrees_with_every_handmade_query)
{
    compare_handmade((struct tally){0});
}

/* If this failed, the answer would depend on the direction of time. */
CASE(oracle__agrees_when_time_runs_backwards)
{
    compare_handmade((struct tally){.is_reversed = true});
}

/* If this failed, the answer would depend on which corner or edge is named first. */
CASE(oracle__agrees_when_roles_are_exchanged)
{
    for (unsigned role = 1; role < 4; role++) {
        compare_handmade((struct tally){.role = role});
    }
}

/* If this failed, the answer would depend on the unit of length, though scaling by a
 * power of two loses no bit of these coordinates. */
CASE(oracle__agrees_at_every_scale)
{
    compare_handmade((struct tally){.exponent = 40});
    compare_handmade((struct tally){.exponent = -100, .is_reversed = true});
}

static void read_pairs(const struct data_scene *scene, int kind, struct data_pairs *pairs)
{
    char ids[DATA_PATH_MAX];
    char truth[DATA_PATH_MAX];
    truth_find(scene->ids[kind], ids);
    truth_find(scene->truth[kind], truth);
    assert_true(data_pairs_read(ids, truth, pairs));
}

/* Every pair of the lists, with its points from the frames. */
static void compare_scene(const struct data_scene *scene)
{
    struct ply frames[2];
    uint32_t edge_count;
    size_t wrong = 0;
    truth_read_frames(scene, frames);
    uint32_t v = frames[0].vertex_count;
    struct oracle_object object = truth_object(frames);
    uint32_t(*edges)[2] = oracle_edges(&object, &edge_count);
    for (int kind = 0; kind < 2; kind++) {
        struct data_pairs pairs;
        size_t hit_count = 0;
        read_pairs(scene, kind, &pairs);
        for (size_t i = 0; i < pairs.count; i++) {
            uint32_t a = pairs.ids[i][0];
            uint32_t b = pairs.ids[i][1];
            double p[8][3];
            if (kind == ORACLE_VF) {
                assert_true(a < v && b >= v + edge_count &&
                            b < v + edge_count + object.triangle_count);
                oracle_vf_points(&object, a, &object, b - v - edge_count, p);
            } else {
                assert_true(a >= v && a < v + edge_count && b >= v && b < v + edge_count);
                oracle_ee_points(&object, edges[a - v], &object, edges[b - v], p);
            }
            bool hits = oracle_hits(kind ? ORACLE_EE : ORACLE_VF, (truth_points)p);
            hit_count += hits;
            if (hits != pairs.truth[i]) {
                wrong++;
                print_message("# %s %s %u %u: %d, should be %d\n", scene->name,
                              kind ? "ee" : "vf", a, b, hits, pairs.truth[i]);
            }
        }
        print_message("# %s %s: %zu pairs, %zu true\n", scene->name, kind ? "ee" : "vf",
                      pairs.count, hit_count);
        data_pairs_deinit(&pairs);
    }
    free(edges);
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    assert_int_equal(wrong, 0);
}

/* If this failed, real cloth at rest on a ball would be judged wrongly. */
CASE(oracle__agrees_with_the_pairs_of_cloth_ball)
{
    compare_scene(&data_scenes[DATA_CLOTH_BALL]);
}

/* If this failed, thousands of pairs that stay coplanar would be judged wrongly. */
CASE(oracle__agrees_with_the_pairs_of_n_body)
{
    compare_scene(&data_scenes[DATA_N_BODY]);
}

/* If this failed, nearly degenerate pairs in double precision would be judged wrongly. */
CASE(oracle__agrees_with_the_pairs_of_cloth_funnel)
{
    compare_scene(&data_scenes[DATA_CLOTH_FUNNEL]);
}

/* If this failed, frames and lists would be read in another way than they were written:
 * the published rationals are an independent copy of the same numbers. */
CASE(oracle__agrees_with_published_rationals)
{
    size_t wrong = 0;
    size_t total = 0;
    for (int i = 0; i < 2 * DATA_SCENES; i++) {
        const struct data_scene *scene = &data_scenes[i / 2];
        int kind = i % 2;
        char path[DATA_PATH_MAX];
        struct data_pairs pairs;
        struct data_queries queries;
        if (!scene->queries[kind]) {
            continue;
        }
        truth_find(scene->queries[kind], path);
        read_pairs(scene, kind, &pairs);
        assert_true(data_queries_read(path, &queries));
        assert_int_equal(queries.count, pairs.count);
        for (size_t k = 0; k < pairs.count; k++) {
            wrong += oracle_hits(kind ? ORACLE_EE : ORACLE_VF,
                                 (truth_points)queries.p[k]) != pairs.truth[k];
        }
        total += pairs.count;
        data_pairs_deinit(&pairs);
        data_queries_deinit(&queries);
    }
    print_message("# %zu queries, %zu wrong\n", total, wrong);
    assert_int_equal(wrong, 0);
}
