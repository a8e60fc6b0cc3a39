/* life.c - everything a client may ask for, once, from hello to the end. */
#include "life.h"

#include <stdio.h>
#include <string.h>

#define SIDE       9u
#define VERTICES   (SIDE * SIDE)
#define TRIANGLES  (2u * (SIDE - 1) * (SIDE - 1))
#define SLOT_BYTES 65536u
#define HOLD_NS    2000000u

#define SHARED_NAME "life"

static const float floor_x[3][3] = {{-99, -99, 0}, {99, -99, 0}, {0, 99, 0}};
static const uint32_t floor_triangle[1][3] = {{0, 1, 2}};

static void blame(struct life *life, const char *what, int method, int status)
{
    if (life->wrong[0] == '\0') {
        (void)snprintf(life->wrong, sizeof life->wrong, "%s: %s (%s: %.60s)",
                       proto_messages[method].name, what, proto_status_name(status),
                       life->raw.error.text);
    }
}

/* Return whether a refusal by the world's fault is an answer to that. */
static bool may_refuse(int status)
{
    return status == PCCD_E_NOMEM || status == PCCD_E_SYSTEM || status == PCCD_E_LIMIT;
}

/* Connect again and go on with the session, if it can be. What was asked last has the
 * same number when it is asked again, so that it is done once. */
static bool resume(struct life *life)
{
    const struct proto_HELLO_request hello = {
        .version_min = PROTO_VERSION_MIN,
        .version_max = PROTO_VERSION_MAX,
        .client = "life",
        .resumable = true,
        .resume_epoch = life->welcome.epoch,
        .resume_session = life->welcome.session,
        .token_hi = life->welcome.token_hi,
        .token_lo = life->welcome.token_lo,
    };
    const struct proto_BYE_request bye = {0};
    struct proto_HELLO_result result;
    uint32_t last = life->raw.next_id - 1;
    if ((life->welcome.token_hi | life->welcome.token_lo) == 0 ||
        !test_raw_reopen(&life->raw, life->socket_path)) {
        return false;
    }
    life->raw.next_id = last + (1u << 20); /* of no request of this session */
    int status = test_raw_call(&life->raw, PROTO_METHOD_HELLO, &hello, &result);
    life->raw.next_id = last;
    life->resumptions++;
    if (status != 0 || !result.resumed) {
        /* A new session, which shall not wait for us when we go. */
        (void)test_raw_call(&life->raw, PROTO_METHOD_BYE, &bye, NULL);
        return false;
    }
    return true;
}

/* Note what was answered. True: as wanted. */
static bool note(struct life *life, int method, int status)
{
    if (status == 0) {
        life->answers++;
        return true;
    }
    if (status == PCCD_E_DISCONNECTED) {
        life->is_lost = !resume(life);
    } else if (may_refuse(status)) {
        life->refusals++;
        life->refusal = status;
    } else {
        blame(life, "must not fail so", method, status);
    }
    return false;
}

/* Return whether to go on after `tries` refusals; blame the second one. */
static bool again(struct life *life, int method, int tries)
{
    if (life->is_lost || life->wrong[0] != '\0') {
        return false;
    }
    if (tries == 2 && life->kind != LIFE_PATIENT && life->refusals > 1) {
        blame(life, "was refused again", method, life->refusal);
    }
    return tries < 3;
}

static bool ask(struct life *life, int method, const void *request, void *result)
{
    for (int tries = 0; again(life, method, tries); tries++) {
        if (note(life, method, test_raw_call(&life->raw, method, request, result))) {
            return true;
        }
    }
    return false;
}

static bool attach(struct life *life, uint32_t slots)
{
    for (int tries = 0; again(life, PROTO_METHOD_SHM_ATTACH, tries); tries++) {
        if (note(life, PROTO_METHOD_SHM_ATTACH,
                 test_raw_attach(&life->raw, slots, SLOT_BYTES))) {
            return true;
        }
    }
    return false;
}

/* One chunk, in slot 0: written once, since what was asked may be done late. */
static bool send_chunk(struct life *life, uint32_t mesh, uint32_t part, const void *items,
                       uint32_t count)
{
    struct proto_MESH_DATA_request data = {.mesh = mesh, .part = part, .count = count};
    memcpy(test_raw_payload(&life->raw, 0), items, count * sizeof(float[3]));
    data.seq = test_raw_publish(&life->raw, 0);
    return ask(life, PROTO_METHOD_MESH_DATA, &data, NULL);
}

static bool fill(struct life *life, uint32_t mesh, const float (*x)[3], uint32_t vertices,
                 const uint32_t (*triangles)[3], uint32_t count)
{
    const struct proto_MESH_COMMIT_request commit = {mesh};
    return send_chunk(life, mesh, 0, x, vertices) &&
           send_chunk(life, mesh, 1, triangles, count) &&
           ask(life, PROTO_METHOD_MESH_COMMIT, &commit, NULL);
}

static bool make_mesh(struct life *life, const float (*x)[3], uint32_t vertices,
                      const uint32_t (*triangles)[3], uint32_t count, uint32_t *mesh)
{
    const struct proto_MESH_CREATE_request create = {.vertex_count = vertices,
                                                     .triangle_count = count};
    struct proto_MESH_CREATE_result created;
    if (!ask(life, PROTO_METHOD_MESH_CREATE, &create, &created)) {
        return false;
    }
    *mesh = created.mesh;
    return fill(life, created.mesh, x, vertices, triangles, count);
}

static void sheet_positions(float x[VERTICES][3], float z)
{
    for (uint32_t i = 0; i < VERTICES; i++) {
        x[i][0] = (float)(i % SIDE) - 4;
        x[i][1] = (float)(i / SIDE) - 4;
        x[i][2] = z + 0.25f * (float)(i * 7 % 5);
    }
}

static void sheet_triangles(uint32_t triangles[TRIANGLES][3])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i + 1 < SIDE; i++) {
        for (uint32_t j = 0; j + 1 < SIDE; j++) {
            uint32_t a = i * SIDE + j;
            const uint32_t both[2][3] = {{a, a + 1, a + SIDE},
                                         {a + 1, a + SIDE + 1, a + SIDE}};
            memcpy(triangles[count], both, sizeof both);
            count += 2;
        }
    }
}

/* Handles of a client in the middle of its life. */
struct belongings {
    uint32_t scene;
    uint32_t floor_mesh;
    uint32_t sheet_mesh;
    uint32_t floor;
    uint32_t sheet;
};

/* Write the step from height z0 to z1 into slot 1: by its end alone the first time, since
 * there the sheet stands; by both ends when it may have moved already. */
static uint64_t write_step(struct life *life, const struct belongings *has,
                           const float z[2], bool is_repeated)
{
    const uint64_t bytes = sizeof(float[VERTICES][3]) + 4; /* a multiple of 8 */
    const struct proto_segment segment = {.object = has->sheet,
                                          .kind = is_repeated ? PROTO_SEGMENT_X0X1
                                                              : PROTO_SEGMENT_X1,
                                          .count = VERTICES,
                                          .offset0 = is_repeated ? sizeof segment : 0,
                                          .offset1 = sizeof segment + bytes};
    uint8_t *payload = test_raw_payload(&life->raw, 1);
    memcpy(payload, &segment, sizeof segment);
    for (size_t end = 0; end < 2; end++) {
        float x[VERTICES][3];
        sheet_positions(x, z[end]);
        memcpy(payload + sizeof segment + end * bytes, x, sizeof x);
    }
    return test_raw_publish(&life->raw, 1);
}

static int submit(struct life *life, const struct proto_FRAME_SUBMIT_request *request)
{
    struct proto_FRAME_SUBMIT_result *answer = &life->steps[life->step_count];
    int status = test_raw_call(&life->raw, PROTO_METHOD_FRAME_SUBMIT, request, answer);
    if (status != 0) {
        return status;
    }
    atomic_store(&test_raw_upload(&life->raw)->result_head.value, answer->release);
    /* What there is no memory for is left out, and the answer says so. */
    return answer->incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT ? PCCD_E_NOMEM : 0;
}

/* Move the sheet from height z0 to z1; every vertex meets the floor on the way. */
static bool step(struct life *life, const struct belongings *has, float z0, float z1,
                 enum pccd_method method)
{
    struct proto_FRAME_SUBMIT_request request = {.scene = has->scene,
                                                 .segments = 1,
                                                 .method = (uint32_t)method,
                                                 .step = life->step_count + 1,
                                                 .slot = 1};
    const float z[2] = {z0, z1};
    uint32_t refusals = life->refusals;
    request.seq = write_step(life, has, z, false);
    for (int tries = 0; again(life, PROTO_METHOD_FRAME_SUBMIT, tries); tries++) {
        if (life->refusals > refusals) {
            refusals = life->refusals;
            request.seq = write_step(life, has, z, true);
        }
        if (note(life, PROTO_METHOD_FRAME_SUBMIT, submit(life, &request))) {
            const struct proto_FRAME_SUBMIT_result *answer =
                &life->steps[life->step_count];
            if (answer->vf != VERTICES || answer->total != VERTICES) {
                blame(life, "has other contacts", PROTO_METHOD_FRAME_SUBMIT, 0);
            }
            life->step_count++;
            return true;
        }
    }
    return false;
}

static bool settle_in(struct life *life, struct belongings *has)
{
    const struct proto_HELLO_request hello = {.version_min = PROTO_VERSION_MIN,
                                              .version_max = PROTO_VERSION_MAX,
                                              .client = "life",
                                              .resumable = life->kind == LIFE_RESUMABLE};
    const struct proto_SCENE_CREATE_request create = {0};
    struct proto_SCENE_CREATE_result scene;
    struct proto_SCENE_ADD_result object;
    float x[VERTICES][3];
    uint32_t triangles[TRIANGLES][3];
    sheet_positions(x, 1);
    sheet_triangles(triangles);
    if (!ask(life, PROTO_METHOD_HELLO, &hello, &life->welcome) || !attach(life, 2) ||
        !ask(life, PROTO_METHOD_SCENE_CREATE, &create, &scene) ||
        !make_mesh(life, floor_x, 3, floor_triangle, 1, &has->floor_mesh) ||
        !make_mesh(life, (const float(*)[3])x, VERTICES, (const uint32_t(*)[3])triangles,
                   TRIANGLES, &has->sheet_mesh)) {
        return false;
    }
    has->scene = scene.scene;
    struct proto_SCENE_ADD_request add = {.scene = has->scene, .mesh = has->floor_mesh};
    if (!ask(life, PROTO_METHOD_SCENE_ADD, &add, &object)) {
        return false;
    }
    has->floor = object.object;
    add.mesh = has->sheet_mesh;
    if (!ask(life, PROTO_METHOD_SCENE_ADD, &add, &object)) {
        return false;
    }
    has->sheet = object.object;
    return true;
}

static bool look_back(struct life *life, const struct belongings *has)
{
    const struct proto_FRAME_FETCH_request fetch = {.scene = has->scene,
                                                    .step = life->step_count};
    const struct proto_MESH_EDGES_request edges = {.mesh = has->sheet_mesh, .count = 99};
    const struct proto_SCENE_BOXES_request boxes = {.scene = has->scene, .count = 99};
    const struct proto_PING_request ping = {.token = 7};
    const struct proto_STATS_request stats = {0};
    const struct proto_STATS_THREAD_request thread = {0};
    const struct proto_CANCEL_request cancel = {.id = 0};
    struct proto_FRAME_FETCH_result page;
    struct proto_STATS_result counters;
    bool all = ask(life, PROTO_METHOD_FRAME_FETCH, &fetch, &page) &&
               ask(life, PROTO_METHOD_MESH_EDGES, &edges, NULL) &&
               ask(life, PROTO_METHOD_SCENE_BOXES, &boxes, NULL) &&
               ask(life, PROTO_METHOD_PING, &ping, NULL) &&
               ask(life, PROTO_METHOD_STATS, &stats, &counters) &&
               ask(life, PROTO_METHOD_STATS_THREAD, &thread, NULL) &&
               ask(life, PROTO_METHOD_CANCEL, &cancel, NULL);
    if (all && page.hash_lo != life->steps[life->step_count - 1].hash_lo) {
        blame(life, "is another answer", PROTO_METHOD_FRAME_FETCH, 0);
    }
    return all;
}

/* The sheet's mesh again, under the same handle: it stands where it was registered. */
static bool replace(struct life *life, const struct belongings *has)
{
    const struct proto_MESH_REPLACE_request request = {
        .mesh = has->sheet_mesh, .vertex_count = VERTICES, .triangle_count = TRIANGLES};
    float x[VERTICES][3];
    uint32_t triangles[TRIANGLES][3];
    sheet_positions(x, 1);
    sheet_triangles(triangles);
    return ask(life, PROTO_METHOD_MESH_REPLACE, &request, NULL) &&
           fill(life, has->sheet_mesh, (const float(*)[3])x, VERTICES,
                (const uint32_t(*)[3])triangles, TRIANGLES);
}

/* The sheet may meet itself no more, and has a name: both, or where memory ran out
 * neither. */
static bool set_sheet(struct life *life, const struct belongings *has)
{
    const struct proto_OBJECT_SET_request set = {.scene = has->scene,
                                                 .object = has->sheet,
                                                 .what =
                                                     PCCD_OBJECT_GROUP | PCCD_OBJECT_SELF,
                                                 .group = 2,
                                                 .has_name = true,
                                                 .name = "sheet"};
    const struct proto_OBJECT_SET_request look = {.scene = has->scene,
                                                  .object = has->sheet};
    struct proto_OBJECT_SET_result now;
    for (int tries = 0; again(life, PROTO_METHOD_OBJECT_SET, tries); tries++) {
        int status = test_raw_call(&life->raw, PROTO_METHOD_OBJECT_SET, &set, &now);
        if (note(life, PROTO_METHOD_OBJECT_SET, status)) {
            if (now.group != 2 || now.mask != UINT64_MAX || now.self_collision) {
                blame(life, "has set something else", PROTO_METHOD_OBJECT_SET, 0);
            }
            return true;
        }
        if (status == PCCD_E_NOMEM &&
            test_raw_call(&life->raw, PROTO_METHOD_OBJECT_SET, &look, &now) == 0 &&
            now.group == 2) {
            blame(life, "has set a part", PROTO_METHOD_OBJECT_SET, status);
        }
    }
    return false;
}

/* The sheet may meet the floor as before. */
static bool set_filters(struct life *life, const struct belongings *has)
{
    const struct proto_SCENE_IGNORE_request ignore = {
        .scene = has->scene, .a = has->floor, .b = has->sheet, .ignored = true};
    const struct proto_SCENE_IGNORE_request heed = {
        .scene = has->scene, .a = has->floor, .b = has->sheet, .has_clearance = true};
    return set_sheet(life, has) &&
           ask(life, PROTO_METHOD_SCENE_IGNORE, &ignore, NULL) &&
           ask(life, PROTO_METHOD_SCENE_IGNORE, &heed, NULL);
}

static bool record(struct life *life, const struct belongings *has)
{
    const struct proto_TRACE_START_request start = {.events = 64};
    const struct proto_TRACE_STOP_request stop = {0};
    const struct proto_TRACE_DUMP_request dump = {.count = 64};
    return ask(life, PROTO_METHOD_TRACE_START, &start, NULL) &&
           step(life, has, -2, 1, PCCD_METHOD_DEFAULT) &&
           ask(life, PROTO_METHOD_TRACE_STOP, &stop, NULL) &&
           ask(life, PROTO_METHOD_TRACE_DUMP, &dump, NULL);
}

/* ---- among others ------------------------------------------------------------------ */

/* A second client, that only takes part. Its failure is no reason for another of the
 * life's; what it is told is wrong only if it is. */
static bool invite(struct life *life)
{
    struct proto_SCENE_CREATE_request create = {.share = PCCD_SHARE_ATTACH,
                                                .name = SHARED_NAME};
    int status = PCCD_E_DISCONNECTED;
    if (test_raw_open(&life->guest, life->socket_path)) {
        status = test_raw_hello(&life->guest);
        status = status != 0 ? status
                             : test_raw_call(&life->guest, PROTO_METHOD_SCENE_CREATE,
                                             &create, NULL);
        if (status == 0) {
            return true;
        }
        test_raw_close(&life->guest);
    }
    life->refusals++;
    if (status != PCCD_E_DISCONNECTED && !may_refuse(status)) {
        blame(life, "a guest must not fail so", PROTO_METHOD_SCENE_CREATE, status);
    }
    return false;
}

/* The guest has heard of a step of that number, unless it was lost on the way. */
static void part_with(struct life *life, uint64_t number)
{
    struct proto_SCENE_STEP_request news = {.number = 0};
    int status = test_raw_receive(&life->guest);
    if (status == 0) {
        status = proto_decode_body(&life->guest.envelope,
                                   &proto_messages[PROTO_NOTE_SCENE_STEP].request, &news,
                                   &life->guest.error);
    }
    if (status == PCCD_E_DISCONNECTED) {
        life->refusals++;
    } else if (status != 0 || news.number != number) {
        blame(life, "is told to a guest otherwise", PROTO_NOTE_SCENE_STEP, status);
    }
    test_raw_close(&life->guest);
}

/* Hold the sheet where it is, answered when its deadline comes. */
static bool hold(struct life *life, const struct belongings *has, uint64_t deadline_ns)
{
    const float z[2] = {1, 1};
    const struct proto_FRAME_SUBMIT_request request = {
        .scene = has->scene,
        .segments = 1,
        .slot = 1,
        .deadline_ns = deadline_ns,
        .hold = true,
        .seq = write_step(life, has, z, true)};
    struct proto_FRAME_SUBMIT_result answer;
    if (deadline_ns == 0) { /* answered when it leaves, or never */
        return test_raw_request(&life->raw, PROTO_METHOD_FRAME_SUBMIT, &request) != 0;
    }
    if (!ask(life, PROTO_METHOD_FRAME_SUBMIT, &request, &answer)) {
        return false;
    }
    if (answer.incomplete != PCCD_INCOMPLETE_DEADLINE) {
        blame(life, "has held otherwise", PROTO_METHOD_FRAME_SUBMIT, 0);
    }
    return true;
}

/* A scene with a name, a frame that another step takes along, a guest that hears of it,
 * and a frame that waits when all is over. */
static bool share(struct life *life, const struct belongings *home)
{
    const struct proto_SCENE_CREATE_request create = {.share = PCCD_SHARE_OPEN,
                                                      .name = SHARED_NAME};
    struct proto_SCENE_CREATE_result scene;
    struct proto_SCENE_ADD_result object;
    struct belongings has = *home;
    if (!ask(life, PROTO_METHOD_SCENE_CREATE, &create, &scene)) {
        return false;
    }
    has.scene = scene.scene;
    const struct proto_SCENE_ADD_request add = {.scene = has.scene,
                                                .mesh = has.sheet_mesh};
    const struct proto_FRAME_SUBMIT_request still = {.scene = has.scene};
    const struct proto_SCENE_DESTROY_request destroy = {has.scene};
    struct proto_FRAME_SUBMIT_result answer;
    if (!ask(life, PROTO_METHOD_SCENE_ADD, &add, &object)) {
        return false;
    }
    has.sheet = object.object;
    if (!hold(life, &has, HOLD_NS)) {
        return false;
    }
    bool is_accompanied = invite(life);
    bool all = ask(life, PROTO_METHOD_FRAME_SUBMIT, &still, &answer);
    if (is_accompanied && all) {
        part_with(life, answer.number);
    } else if (is_accompanied) {
        test_raw_close(&life->guest);
    }
    return all && hold(life, &has, 0) &&
           ask(life, PROTO_METHOD_SCENE_DESTROY, &destroy, NULL);
}

/* Ask what there is, and be told of steps. */
static bool watch(struct life *life, const struct belongings *has)
{
    const struct proto_WATCH_START_request start = {.session = life->welcome.session};
    const struct proto_WATCH_STOP_request stop = {0};
    const struct proto_FRAME_SUBMIT_request still = {.scene = has->scene};
    const struct proto_LIST_SESSION_request sessions = {0};
    const struct proto_LIST_SCENE_request scenes = {0};
    const struct proto_LIST_OBJECT_request objects = {.scene = has->scene};
    const struct proto_LIST_PAIR_request pairs = {.scene = has->scene};
    const struct proto_LIST_MESH_request meshes = {0};
    const struct proto_STATS_HISTOGRAM_request histogram = {0};
    const struct proto_CONFIG_SET_request set = {.name = "grace", .value = "10"};
    const struct proto_CONFIG_GET_request get = {.name = "grace"};
    return ask(life, PROTO_METHOD_WATCH_START, &start, NULL) &&
           ask(life, PROTO_METHOD_FRAME_SUBMIT, &still, NULL) &&
           ask(life, PROTO_METHOD_WATCH_STOP, &stop, NULL) &&
           ask(life, PROTO_METHOD_LIST_SESSION, &sessions, NULL) &&
           ask(life, PROTO_METHOD_LIST_SCENE, &scenes, NULL) &&
           ask(life, PROTO_METHOD_LIST_OBJECT, &objects, NULL) &&
           ask(life, PROTO_METHOD_LIST_PAIR, &pairs, NULL) &&
           ask(life, PROTO_METHOD_LIST_MESH, &meshes, NULL) &&
           ask(life, PROTO_METHOD_STATS_HISTOGRAM, &histogram, NULL) &&
           ask(life, PROTO_METHOD_CONFIG_SET, &set, NULL) &&
           ask(life, PROTO_METHOD_CONFIG_GET, &get, NULL);
}

/* A journal of a shared scene with the sheet in it, over a step. */
static bool keep_journal(struct life *life, const struct belongings *has)
{
    struct proto_SCENE_CREATE_request create = {.name = "life", .share = PCCD_SHARE_OPEN};
    struct proto_SCENE_CREATE_result made;
    struct proto_SCENE_ADD_result added;
    if (!ask(life, PROTO_METHOD_SCENE_CREATE, &create, &made)) {
        return false;
    }
    const struct proto_SCENE_ADD_request add = {.scene = made.scene,
                                                .mesh = has->sheet_mesh};
    const struct proto_SCENE_JOURNAL_request begin = {.scene = made.scene,
                                                      .begin = 1 << 16};
    const struct proto_SCENE_JOURNAL_request read = {.scene = made.scene};
    const struct proto_FRAME_SUBMIT_request still = {.scene = made.scene, .step = 99};
    const struct proto_SCENE_DESTROY_request destroy = {.scene = made.scene};
    return ask(life, PROTO_METHOD_SCENE_ADD, &add, &added) &&
           ask(life, PROTO_METHOD_SCENE_JOURNAL, &begin, NULL) &&
           ask(life, PROTO_METHOD_FRAME_SUBMIT, &still, NULL) &&
           ask(life, PROTO_METHOD_SCENE_JOURNAL, &read, NULL) &&
           ask(life, PROTO_METHOD_SCENE_DESTROY, &destroy, NULL);
}

static bool leave(struct life *life, const struct belongings *has)
{
    const struct proto_SCENE_REMOVE_request remove = {has->scene, has->floor};
    const struct proto_MESH_DESTROY_request mesh = {has->sheet_mesh};
    const struct proto_SCENE_DESTROY_request scene = {has->scene};
    const struct proto_BYE_request bye = {0};
    return ask(life, PROTO_METHOD_SCENE_REMOVE, &remove, NULL) &&
           ask(life, PROTO_METHOD_MESH_DESTROY, &mesh, NULL) &&
           ask(life, PROTO_METHOD_SCENE_DESTROY, &scene, NULL) && attach(life, 3) &&
           ask(life, PROTO_METHOD_BYE, &bye, NULL);
}

void life_run(struct life *life, const char *socket_path, enum life_kind kind)
{
    struct belongings has = {0};
    memset(life, 0, sizeof *life);
    life->kind = kind;
    life->socket_path = socket_path;
    if (!test_raw_open(&life->raw, socket_path)) {
        life->is_lost = true; /* the daemon does not listen: its keeper will notice */
        return;
    }
    bool all = settle_in(life, &has) && step(life, &has, 1, -2, PCCD_METHOD_DEFAULT) &&
               look_back(life, &has) && step(life, &has, -2, 1, PCCD_METHOD_PAPER) &&
               replace(life, &has) && set_filters(life, &has) &&
               step(life, &has, 1, -2, PCCD_METHOD_DEFAULT) && record(life, &has) &&
               watch(life, &has) && share(life, &has) && keep_journal(life, &has) &&
               leave(life, &has);
    if (!all && !life->is_lost && life->refusals == 0 && life->wrong[0] == '\0') {
        blame(life, "nothing explains this", PROTO_METHOD_PING, 0);
    }
    test_raw_close(&life->raw);
}
