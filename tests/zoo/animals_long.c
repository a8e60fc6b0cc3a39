/* animals_long.c - hostile clients: what takes the daemon seconds. */
#include <math.h>

#include "animals.h"
#include "daemon.h"
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

/* Meshes of random triangles: the commit sorts their edges, and
 * puts their features in order. */
bool zoo_commits_heaps(struct zoo_cage *cage)
{
    return ask(cage, HOG_COMMIT, 1000000, 100000);
}

#define EVERYWHERE 1e18

/* Asks what is near, and means everything: each pair of features of a large scene is
 * within that distance. */
bool zoo_asks_for_everything(struct zoo_cage *cage)
{
    static const enum pccd_near_what whats[] = {PCCD_NEAR_VERTICES, PCCD_NEAR_PAIRS};
    struct proto_SCENE_NEAR_result answer;

    EXPECT(cage, test_hog_open(&hog, cage->socket, HOG_FAN, cage->patient ? 1000 : 300));
    for (size_t i = 0; i < sizeof whats / sizeof whats[0]; i++) {
        EXPECT(cage, RAW_CALL(&hog.raw, SCENE_NEAR, &answer, .scene = hog.scene,
                              .what = whats[i], .end = 1, .distance = EVERYWHERE) == 0);
        EXPECT(cage, answer.incomplete != PCCD_INCOMPLETE_DEADLINE &&
                         answer.incomplete != PCCD_INCOMPLETE_CANCELLED);
        EXPECT(cage, answer.total > 2 * (uint64_t)hog.triangles);
    }
    test_hog_close(&hog);
    return true;
}

/* Set a radius, and return what object.set says of it. */
static int set_radius(double radius)
{
    return RAW_CALL(&hog.raw, OBJECT_SET, NULL, .scene = hog.scene, .object = hog.object,
                    .what = PCCD_OBJECT_RADIUS, .radius = radius);
}

#define DEADLINE_MS 50u
#define SLACK_MS    2000u /* three animals and others share two processors */

/* An object all pairs of whose features meet at once, as soon as it stirs. What is no
 * radius is refused by name. */
static bool make_thick(struct zoo_cage *cage, uint32_t triangles)
{
    EXPECT(cage, test_hog_open(&hog, cage->socket, HOG_FAN, triangles));
    EXPECT(cage, set_radius(-1) == PCCD_E_INVAL);
    EXPECT(cage, set_radius(NAN) == PCCD_E_INVAL);
    EXPECT(cage, set_radius(INFINITY) == PCCD_E_INVAL);
    EXPECT(cage, set_radius(nextafter(EVERYWHERE, INFINITY)) == PCCD_E_LIMIT);
    EXPECT(cage, set_radius(EVERYWHERE) == 0);
    return true;
}

/* A step of it, with a deadline or without. */
static bool step_thick(struct zoo_cage *cage, uint64_t deadline_ms,
                       enum pccd_incomplete incomplete)
{
    struct proto_FRAME_SUBMIT_result answer = {.incomplete = PCCD_COMPLETE};
    uint64_t begin_ms;

    hog.deadline_ns = deadline_ms * 1000000;
    EXPECT(cage, test_hog_begin(&hog));
    begin_ms = test_now_ms();
    EXPECT(cage, test_hog_end(&hog, &answer) == 0);
    EXPECT(cage, deadline_ms == 0 || test_now_ms() - begin_ms <= deadline_ms + SLACK_MS);
    EXPECT(cage, answer.incomplete == incomplete);
    EXPECT(cage, answer.toi_first == (answer.total > 0 ? 0 : 2));
    EXPECT(cage, answer.safe_step == 0);
    test_raw_release(&hog.raw, answer.release);
    return true;
}

/* Steps objects whose radii are as large as they may be: of the large one, all pairs
 * would take days; of the small one they are more than are kept. */
bool zoo_thickens_everything(struct zoo_cage *cage)
{
    EXPECT(cage, make_thick(cage, cage->patient ? 1000000 : 20000));
    for (int i = 0; i < 3; i++) {
        EXPECT(cage, step_thick(cage, DEADLINE_MS, PCCD_INCOMPLETE_DEADLINE));
    }
    EXPECT(cage, RAW_CALL(&hog.raw, SCENE_NEAR, NULL, .scene = hog.scene,
                          .what = PCCD_NEAR_PAIRS, .end = 1) == PCCD_E_LIMIT);
    test_hog_close(&hog);
    EXPECT(cage, make_thick(cage, 500));
    EXPECT(cage, step_thick(cage, 0, PCCD_INCOMPLETE_CONTACT_LIMIT));
    test_hog_close(&hog);
    return true;
}
