/* animals_long.c - hostile clients: what takes the daemon seconds.
 *
 * Room:     tests/zoo. May include: animals.h, hog.h.
 * Does:     see animals.h; each request gets its whole answer, however long that takes,
 *           and others get theirs meanwhile.
 * Threads:  one, of the animal's process.
 */
#include "animals.h"
#include "hog.h"

static struct hog hog;

/* One long request, of so many triangles; fewer where time is short. */
static bool ask(struct zoo_cage *cage, enum hog_kind kind, uint32_t patient,
                uint32_t hurried)
{
    struct proto_FRAME_SUBMIT_result answer = {.incomplete = PCCD_COMPLETE};

    EXPECT(cage,
           test_hog_open(&hog, cage->socket, kind, cage->patient ? patient : hurried));
    EXPECT(cage, test_hog_begin(&hog));
    EXPECT(cage, test_hog_end(&hog, &answer) == 0);
    /* More records than fit on a page, or than are kept, is all that may be missing. */
    EXPECT(cage, answer.incomplete != PCCD_INCOMPLETE_DEADLINE &&
                     answer.incomplete != PCCD_INCOMPLETE_CANCELLED);
    test_hog_close(&hog);
    return true;
}

/* Steps of triangles that are all in one place: each meets each. */
bool zoo_stacks_triangles(struct zoo_cage *cage)
{
    return ask(cage, HOG_COINCIDENT, 1000, 300);
}

/* Steps of triangles around one vertex. */
bool zoo_fans_triangles_out(struct zoo_cage *cage)
{
    return ask(cage, HOG_FAN, 50000, 10000);
}

/* Meshes of random triangles: the commit sorts their edges. */
bool zoo_commits_heaps(struct zoo_cage *cage)
{
    return ask(cage, HOG_COMMIT, 1000000, 100000);
}

/* Objects of these: the scene sorts their features. */
bool zoo_adds_heaps(struct zoo_cage *cage)
{
    return ask(cage, HOG_ADD, 1000000, 100000);
}

#define EVERYWHERE 1e18

/* Asks what is near, and means everything: each pair of features of a large scene is
 * within that distance. */
bool zoo_asks_for_everything(struct zoo_cage *cage)
{
    static const enum pccd_near_what whats[] = {PCCD_NEAR_VERTICES, PCCD_NEAR_PAIRS};
    struct proto_SCENE_NEAR_request near = {.end = 1, .distance = EVERYWHERE};
    struct proto_SCENE_NEAR_result answer;

    EXPECT(cage, test_hog_open(&hog, cage->socket, HOG_FAN, cage->patient ? 1000 : 300));
    near.scene = hog.scene;
    for (size_t i = 0; i < sizeof whats / sizeof whats[0]; i++) {
        near.what = whats[i];
        EXPECT(cage,
               test_raw_call(&hog.raw, PROTO_METHOD_SCENE_NEAR, &near, &answer) == 0);
        EXPECT(cage, answer.incomplete != PCCD_INCOMPLETE_DEADLINE &&
                         answer.incomplete != PCCD_INCOMPLETE_CANCELLED);
        EXPECT(cage, answer.total > 2 * (uint64_t)hog.triangles);
    }
    test_hog_close(&hog);
    return true;
}
