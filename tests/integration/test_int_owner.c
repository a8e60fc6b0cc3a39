/* test_int_owner.c - whose a shared scene is. */
#include "cases.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixture.h"
#include "must.h"
#include "raw.h"

static const char *const options[] = {"--allow-uid", "65534", NULL};

static struct pccd_client *connect_as_other(void)
{
    assert_int_equal(seteuid(TEST_OTHER_USER), 0);
    struct pccd_client *client = test_connect(test_shared.url);
    assert_int_equal(seteuid(0), 0);
    return client;
}

static int setup(void **state)
{
    (void)state;
    if (geteuid() != 0) {
        return 0;
    }
    return test_shared_start_with(options) == 0 && chmod(test_shared.directory, 0755) == 0
               ? 0
               : -1;
}

static int teardown(void **state)
{
    return geteuid() != 0 ? 0 : test_shared_stop(state);
}

struct listing {
    uint32_t count;
    uint32_t uids[4];
};

static void note_scene(void *context, const struct pccd_scene_info *info)
{
    struct listing *listing = context;

    if (info->name[0] != '\0' && listing->count < 4) {
        listing->uids[listing->count++] = info->uid;
    }
}

static struct listing list(struct pccd_client *client)
{
    struct listing listing = {.count = 0};

    assert_ok(pccd_list_scenes(client, 0, note_scene, &listing));
    return listing;
}

/* If it failed, who makes a scene would find himself in another user's, with that one's
 * rights: so it was with root's 0600 and another's 0666. */
CASE(owner__names_belong_to_their_users)
{
    struct pccd_scene_settings other = {.name = "arena", .share = PCCD_SHARE_OTHER};
    struct pccd_client *theirs;
    struct listing listing;
    uint32_t first = 0;
    uint32_t second = 0;
    uint32_t scene = 0;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    struct pccd_client *mine = test_client_at(test_shared.url);
    theirs = connect_as_other();
    assert_non_null(theirs);
    assert_int_equal(test_take_part(theirs, "arena", PCCD_SHARE_OPEN, 0666, &first), 0);
    assert_int_equal(test_take_part(mine, "arena", PCCD_SHARE_ATTACH, 0, &scene),
                     PCCD_E_AGAIN);
    assert_non_null(strstr(pccd_error_text(mine), "user 65534 has one"));
    assert_int_equal(test_take_part(mine, "arena", PCCD_SHARE_CREATE, 0600, &second), 0);
    listing = list(mine);
    assert_int_equal(listing.count, 1);
    assert_int_equal(listing.uids[0], 0);
    /* Each is in the scene that was asked for; the other's is to be named. */
    assert_int_equal(pccd_scene_join(theirs, 0, "arena", &scene), PCCD_E_ACCESS);
    assert_ok(pccd_scene_join(mine, TEST_OTHER_USER, "arena", &scene));
    listing = list(mine);
    assert_int_equal(listing.count, 2);
    assert_true(listing.uids[0] == TEST_OTHER_USER || listing.uids[1] == TEST_OTHER_USER);
    assert_ok(pccd_scene_destroy(theirs, first));
    assert_int_equal(test_take_part(theirs, "arena", PCCD_SHARE_CREATE, 0, &first),
                     PCCD_E_STATE); /* it lives on with whom it is shared */
    assert_int_equal(pccd_scene_create(mine, &other, &scene), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(mine), "pccd_scene_join"));
    assert_int_equal(pccd_scene_join(mine, TEST_OTHER_USER, NULL, &scene), PCCD_E_INVAL);
    pccd_close(theirs);
    pccd_close(mine);
}

/* If it failed, who comes back after a crash of the daemon would be in a scene of his
 * own, not in the other user's that he was in. */
CASE(owner__a_killed_daemon_keeps_whose_scene_it_was)
{
    struct pccd_client *mine;
    struct pccd_client *theirs;
    struct listing listing;
    uint32_t first = 0;
    uint32_t joined = 0;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    mine = test_client_at(test_shared.url);
    theirs = connect_as_other();
    assert_non_null(theirs);
    assert_int_equal(test_take_part(mine, "again", PCCD_SHARE_CREATE, 0666, &first), 0);
    assert_ok(pccd_scene_join(theirs, 0, "again", &joined));
    assert_true(WIFSIGNALED(test_daemon_end(&test_shared, SIGKILL, 10000)));
    assert_true(test_daemon_restart(&test_shared, options));
    assert_ok(pccd_ping(mine, NULL));
    assert_int_equal(seteuid(TEST_OTHER_USER), 0); /* it connects anew */
    assert_ok(pccd_ping(theirs, NULL));
    assert_int_equal(seteuid(0), 0);
    listing = list(theirs);
    assert_int_equal(listing.count, 1);
    assert_int_equal(listing.uids[0], 0);
    pccd_close(theirs);
    pccd_close(mine);
}

/* If it failed, whoever speaks the protocol would not hear whose the scene is that was
 * given, or could make one in another user's name. */
CASE(owner__answer_says_whose_it_is)
{
    struct proto_SCENE_CREATE_request create = {.name = "raw", .share = PCCD_SHARE_OPEN};
    struct proto_SCENE_CREATE_result result;
    static struct test_raw raw;

    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    assert_int_equal(seteuid(TEST_OTHER_USER), 0);
    bool is_open = test_raw_open(&raw, test_shared.socket);
    assert_int_equal(seteuid(0), 0);
    assert_true(is_open);
    assert_ok(test_raw_hello(&raw));
    create.owner = 7;
    assert_int_equal(test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, NULL),
                     PCCD_E_INVAL);
    create.share = PCCD_SHARE_OTHER;
    assert_int_equal(test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, NULL),
                     PCCD_E_AGAIN);
    create = (struct proto_SCENE_CREATE_request){.name = "raw", .share = PCCD_SHARE_OPEN};
    assert_ok(test_raw_call(&raw, PROTO_METHOD_SCENE_CREATE, &create, &result));
    assert_false(result.existed);
    assert_int_equal(result.owner, TEST_OTHER_USER);
    test_raw_close(&raw);
}

CASES_WITH(setup, teardown);
