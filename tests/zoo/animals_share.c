/* animals_share.c - hostile clients: scenes that are shared, and what is told of them. */
#include <stdio.h>
#include <string.h>

#include "animals.h"
#include "crossing.h"
#include "daemon.h"

#define SLOT_BYTES 65536u
#define ROUNDS     10
#define STEPS      400 /* more than a socket takes news of */
#define OBJECTS    32u /* in the short form; large ones: test_int_rivals */
#define IN_FLIGHT  24

static struct test_raw raw;
static struct test_raw other;

/* Take part in the scene of that name, which all animals of the kind share or which is
 * this one's. */
static int take_part(struct test_raw *peer, const char *name, enum pccd_share share,
                     uint32_t *scene)
{
    struct proto_SCENE_CREATE_request create = {.share = share};
    struct proto_SCENE_CREATE_result created = {.scene = 0};
    int status;

    (void)snprintf(create.name, sizeof create.name, "%s", name);
    do { /* busy: those that were left are being freed */
        status = test_raw_call(peer, PROTO_METHOD_SCENE_CREATE, &create, &created);
        test_sleep_ms(status == PCCD_E_BUSY);
    } while (status == PCCD_E_BUSY);
    *scene = created.scene;
    return status;
}

static int leave(struct test_raw *peer, uint32_t scene)
{
    return RAW_CALL(peer, SCENE_DESTROY, NULL, .scene = scene);
}

/* The triangle in the scene, with a mesh of its own. */
static bool add_triangle(struct zoo_cage *cage, struct test_raw *peer,
                         struct test_raw_crossing *scene)
{
    if (scene->mesh == 0) {
        EXPECT(cage, test_raw_mesh(peer, test_triangle_x, 3, test_triangle, 1,
                                   &scene->mesh) == 0);
    }
    EXPECT(cage, test_raw_add(peer, scene->scene, scene->mesh, &scene->object) == 0);
    return true;
}

static bool enter_both(struct zoo_cage *cage, const char *name,
                       struct test_raw_crossing *mine, struct test_raw_crossing *theirs)
{
    memset(mine, 0, sizeof *mine);
    memset(theirs, 0, sizeof *theirs);
    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, zoo_enter(cage, &other, SLOT_BYTES));
    EXPECT(cage, take_part(&raw, name, PCCD_SHARE_OPEN, &mine->scene) == 0);
    EXPECT(cage, take_part(&other, name, PCCD_SHARE_OPEN, &theirs->scene) == 0);
    return add_triangle(cage, &raw, mine) && add_triangle(cage, &other, theirs);
}

static int step_still(struct test_raw *peer, uint32_t scene)
{
    return RAW_CALL(peer, FRAME_SUBMIT, NULL, .scene = scene);
}

static int submit(const struct proto_FRAME_SUBMIT_request *request)
{
    return test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, request, NULL);
}

/* In a scene that all of the kind share: moves what is another's, holds what cannot be
 * held, and more than one frame; cancels and outwaits it; leaves while it holds, comes
 * back in the same breath and adds what cannot be added. It gets the error of each, and
 * the others step on. */
static bool misbehave(struct zoo_cage *cage, struct test_raw_crossing *mine,
                      const struct test_raw_crossing *theirs)
{
    struct proto_FRAME_SUBMIT_request step;
    struct test_raw_crossing stolen = *mine;
    uint32_t id;

    stolen.object = theirs->object;
    step = test_raw_turn(&raw, 0, &stolen, -1);
    EXPECT(cage, submit(&step) == PCCD_E_ACCESS);
    step.hold = true;
    step.seq = test_raw_publish(&raw, 0);
    EXPECT(cage, submit(&step) == PCCD_E_ACCESS);
    step = test_raw_turn(&raw, 0, mine, 1);
    step.hold = step.place = true;
    EXPECT(cage, submit(&step) == PCCD_E_INVAL);
    step.place = false;
    step.deadline_ns = 1; /* it is held, and answered at once or by another's step */
    EXPECT(cage, submit(&step) == 0);
    EXPECT(cage, step_still(&other, theirs->scene) == 0);
    step = test_raw_turn(&raw, 0, mine, 1);
    step.hold = true;
    id = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &step);
    EXPECT(cage, id != 0 && RAW_SEND(&raw, CANCEL, .id = id) != 0);
    EXPECT(cage, test_raw_answer(&raw, id, PROTO_METHOD_FRAME_SUBMIT, NULL) == 0);
    EXPECT(cage, step_still(&other, theirs->scene) == 0);
    return true;
}

bool zoo_fights_over_a_scene(struct zoo_cage *cage)
{
    struct proto_MESH_CREATE_result empty;
    struct test_raw_crossing mine;
    struct test_raw_crossing theirs;

    EXPECT(cage, enter_both(cage, "arena", &mine, &theirs));
    EXPECT(cage, RAW_CALL(&raw, MESH_CREATE, &empty, .vertex_count = 3,
                          .triangle_count = 1) == 0);
    for (int round = 0; round < ROUNDS; round++) {
        uint32_t next = ((mine.scene >> 20) + 1) << 20;
        struct proto_FRAME_SUBMIT_request step;
        uint32_t held;
        uint32_t added;

        EXPECT(cage, misbehave(cage, &mine, &theirs));
        step = test_raw_turn(&raw, 0, &mine, 1);
        step.hold = true;
        held = test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &step);
        EXPECT(cage, RAW_SEND(&raw, SCENE_DESTROY, .scene = mine.scene) != 0);
        EXPECT(cage, RAW_SEND(&raw, SCENE_CREATE, .share = PCCD_SHARE_OPEN,
                              .name = "arena", .want = next) != 0);
        added = RAW_SEND(&raw, SCENE_ADD, .scene = next, .mesh = empty.mesh);
        EXPECT(cage, held != 0 && added != 0);
        EXPECT(cage, test_raw_answer(&raw, added, PROTO_METHOD_SCENE_ADD, NULL) ==
                         PCCD_E_STATE);
        mine.scene = next;
        EXPECT(cage, add_triangle(cage, &raw, &mine));
        EXPECT(cage, step_still(&other, theirs.scene) == 0);
    }
    test_raw_close(&other);
    test_raw_close(&raw);
    return true;
}

/* A name of 1 to 255 bytes of what may be in one, and tells whose it is. */
static void make_name(const struct zoo_cage *cage, unsigned number, char *name)
{
    static const char *const odd[] = {"\n", "\x7f", "\xc3\xa9", "\xf0\x9f\x90\x98",
                                      "%s", "\"",   "/../",     "\x1b[2J"};
    size_t length =
        (size_t)snprintf(name, PROTO_STR_MAX + 1, "%u.%u", cage->number, number);
    const char *part = odd[number % (sizeof odd / sizeof odd[0])];

    while (number % 2 == 1 && length + strlen(part) <= PROTO_STR_MAX) {
        memcpy(name + length, part, strlen(part) + 1);
        length += strlen(part);
    }
}

/* A request of its own making, of which the name is these bytes. */
static int create_named(const void *name, uint8_t bytes)
{
    static const uint8_t head[] = "\x94\x00\x01\xacscene.create\x81\xa4name\xd9";
    uint8_t message[512];

    memcpy(message, head, sizeof head - 1);
    message[sizeof head - 1] = bytes;
    memcpy(message + sizeof head, name, bytes);
    if (!test_raw_send(&raw, message, sizeof head + bytes, 0) ||
        test_raw_receive(&raw) != 0) {
        return PCCD_E_DISCONNECTED;
    }
    return raw.envelope.failed ? raw.envelope.error.code : 0;
}

/* Names scenes as nobody would, as many as it may: 64 are its own, one more is E_LIMIT;
 * E_BUSY is a moment's; none of them is there when it has left. What is no name is
 * E_BADMSG, and what is no share or right E_INVAL. */
bool zoo_names_scenes(struct zoo_cage *cage)
{
    uint32_t scenes[PROTO_SHARED_PER_CLIENT + 1];
    char name[PROTO_STR_MAX + 1];

    EXPECT(cage, zoo_enter(cage, &raw, 0));
    EXPECT(cage, create_named("a\0b", 3) == PCCD_E_BADMSG);
    EXPECT(cage, create_named("\xff\xfe", 2) == PCCD_E_BADMSG);
    EXPECT(cage, create_named("\xc3", 1) == PCCD_E_BADMSG);
    EXPECT(cage, RAW_CALL(&raw, SCENE_CREATE, NULL, .share = PCCD_SHARE_COUNT,
                          .name = "x") == PCCD_E_INVAL);
    EXPECT(cage, RAW_CALL(&raw, SCENE_CREATE, NULL, .rights = 0777, .name = "x") ==
                     PCCD_E_INVAL);
    EXPECT(cage, RAW_CALL(&raw, SCENE_CREATE, NULL, .rights = 0777) == PCCD_E_INVAL);
    for (unsigned i = 0; i <= PROTO_SHARED_PER_CLIENT; i++) {
        make_name(cage, i, name);
        EXPECT(cage,
               take_part(&raw, name, PCCD_SHARE_ATTACH, &scenes[i]) == PCCD_E_AGAIN);
        EXPECT(cage, take_part(&raw, name, PCCD_SHARE_CREATE, &scenes[i]) ==
                         (i < PROTO_SHARED_PER_CLIENT ? 0 : PCCD_E_LIMIT));
    }
    make_name(cage, 7, name);
    EXPECT(cage, take_part(&raw, name, PCCD_SHARE_CREATE, &scenes[0]) == PCCD_E_STATE);
    EXPECT(cage, take_part(&raw, name, PCCD_SHARE_ATTACH, &scenes[0]) == PCCD_E_STATE);
    for (unsigned i = 1; i < PROTO_SHARED_PER_CLIENT; i += 2) {
        EXPECT(cage, leave(&raw, scenes[i]) == 0);
    }
    test_raw_close(&raw);
    return true;
}

/* Ask for many things, with as many as may be in flight. All must succeed. */
static bool ignore_all(struct zoo_cage *cage, uint32_t scene, const uint32_t *objects,
                       uint32_t count, uint32_t each)
{
    uint32_t sent = 0;
    uint32_t taken = 0;

    while (taken < count * each) {
        while (sent < count * each && sent - taken < IN_FLIGHT) {
            uint32_t b = objects[(sent / each + 1 + sent % each) % count];

            EXPECT(cage,
                   RAW_SEND(&raw, SCENE_IGNORE, .scene = scene, .a = objects[sent / each],
                            .b = b, .ignored = true) != 0);
            sent++;
        }
        EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
        taken++;
    }
    return true;
}

/* Fills a scene with objects that ignore each other, and leaves it to its other client:
 * objects and pairs go with it, while the others have their turns. */
bool zoo_ignores_every_pair(struct zoo_cage *cage)
{
    static uint32_t objects[2 * OBJECTS];
    uint32_t count = cage->patient ? 2 * OBJECTS : OBJECTS;
    struct test_raw_crossing mine = {0};
    uint32_t their_scene;
    char name[32];

    (void)snprintf(name, sizeof name, "pairs %u", cage->number);
    EXPECT(cage, zoo_enter(cage, &raw, SLOT_BYTES));
    EXPECT(cage, zoo_enter(cage, &other, SLOT_BYTES));
    EXPECT(cage, take_part(&raw, name, PCCD_SHARE_OPEN, &mine.scene) == 0);
    EXPECT(cage, take_part(&other, name, PCCD_SHARE_ATTACH, &their_scene) == 0);
    for (uint32_t i = 0; i < count; i++) {
        EXPECT(cage, add_triangle(cage, &raw, &mine));
        objects[i] = mine.object;
    }
    EXPECT(cage, ignore_all(cage, mine.scene, objects, count, count / 4));
    EXPECT(cage,
           RAW_CALL(&raw, OBJECT_SET, NULL, .scene = mine.scene, .object = mine.object,
                    .what = COMMON_OBJECT_KNOWN + 1) == PCCD_E_INVAL);
    EXPECT(cage,
           RAW_CALL(&other, OBJECT_SET, NULL, .scene = their_scene, .object = mine.object,
                    .what = PCCD_OBJECT_SELF) == PCCD_E_ACCESS);
    EXPECT(cage, leave(&raw, mine.scene) == 0);
    EXPECT(cage, step_still(&other, their_scene) == 0);
    test_raw_close(&raw);
    test_raw_close(&other);
    return true;
}

/* Takes part, watches, and reads nothing of what it is told, of more steps than its
 * socket takes: it is neither waited for nor dropped, and hears of the last one. */
bool zoo_reads_no_news(struct zoo_cage *cage)
{
    struct test_raw_crossing mine;
    struct test_raw_crossing theirs;
    uint32_t told = 0;
    char name[32];

    (void)snprintf(name, sizeof name, "news %u", cage->number);
    EXPECT(cage, enter_both(cage, name, &mine, &theirs));
    EXPECT(cage, RAW_CALL(&raw, WATCH_START, NULL, .session = 0) == 0);
    for (int i = 0; i < STEPS; i++) {
        EXPECT(cage, step_still(&other, theirs.scene) == 0);
    }
    EXPECT(cage, RAW_SEND(&raw, PING, .token = 1) != 0);
    do {
        EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
        told++;
    } while (raw.envelope.kind == PROTO_NOTIFICATION);
    EXPECT(cage, told > 1);
    test_raw_close(&other);
    test_raw_close(&raw);
    return true;
}

/* Asks for what there is, setting by setting and thing by thing, and beyond its end; sets
 * what is none: E_INVAL, E_HANDLE, and the settings are as they were. */
bool zoo_pries(struct zoo_cage *cage)
{
    struct proto_CONFIG_SET_request set = {.name = "threads", .value = "-1"};
    struct proto_CONFIG_GET_result got = {.count = 1};
    struct proto_LIST_SESSION_result session = {.session = 1};
    uint64_t before = 0;

    EXPECT(cage, zoo_enter(cage, &raw, 0));
    EXPECT(cage,
           test_raw_call(&raw, PROTO_METHOD_CONFIG_SET, &set, NULL) == PCCD_E_INVAL);
    memset(set.name, 'n', PROTO_STR_MAX);
    memset(set.value, '9', PROTO_STR_MAX);
    EXPECT(cage,
           test_raw_call(&raw, PROTO_METHOD_CONFIG_SET, &set, NULL) == PCCD_E_INVAL);
    EXPECT(cage, RAW_CALL(&raw, CONFIG_GET, NULL, .name = "nothing") == PCCD_E_INVAL);
    for (uint32_t i = 0; i < got.count; i++) {
        EXPECT(cage, RAW_CALL(&raw, CONFIG_GET, &got, .index = i) == 0);
        EXPECT(cage, !got.changed);
    }
    EXPECT(cage, RAW_CALL(&raw, CONFIG_GET, NULL, .index = got.count) == PCCD_E_INVAL);
    while (session.session != 0) {
        int status;

        EXPECT(cage, RAW_CALL(&raw, LIST_SESSION, &session, .before = before) == 0);
        before = session.session;
        status =
            RAW_CALL(&raw, LIST_SCENE, NULL, .session = before, .cursor = UINT32_MAX);
        EXPECT(cage, status == 0 || status == PCCD_E_HANDLE); /* it may have gone */
    }
    EXPECT(cage,
           RAW_CALL(&raw, STATS_HISTOGRAM, NULL, .kind = UINT32_MAX) == PCCD_E_INVAL);
    test_raw_close(&raw);
    return true;
}
