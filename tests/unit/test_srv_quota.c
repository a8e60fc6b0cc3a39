/* test_srv_quota.c - quotas of a user. */
#include "cases.h"
#include "quota.h"

static const uint64_t limits[SRV_QUOTA_COUNT] = {
    [SRV_QUOTA_CLIENTS] = 2,
    [SRV_QUOTA_SHM_BYTES] = 1000,
    [SRV_QUOTA_MESHES] = 3,
    [SRV_QUOTA_TRIANGLES] = UINT64_MAX,
};

/* A limit that is off by one, or that a huge amount can jump, is no limit. */
CASE(quota__charge_stops_exactly_at_the_limit)
{
    struct srv_quota quota;
    struct proto_error error = {0};
    srv_quota_init(&quota, limits);
    struct srv_quota_user *user = srv_quota_acquire(&quota, 1000);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, 999, &error), 0);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, 2, &error),
                     PCCD_E_QUOTA);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, UINT64_MAX, &error),
                     PCCD_E_QUOTA);
    assert_int_equal(user->used[SRV_QUOTA_SHM_BYTES], 999);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, 1, &error), 0);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, 1, &error),
                     PCCD_E_QUOTA);
    srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, 1000);
    srv_quota_release(&quota, user);
    srv_quota_deinit(&quota);
}

/* A refusal that does not name user, kind and limit leaves its reader guessing. */
CASE(quota__refusal_names_user_kind_and_limit)
{
    struct srv_quota quota;
    struct proto_error error = {0};
    srv_quota_init(&quota, limits);
    struct srv_quota_user *user = srv_quota_acquire(&quota, 1234);
    assert_int_equal(srv_quota_charge(user, SRV_QUOTA_MESHES, 4, &error), PCCD_E_QUOTA);
    assert_int_equal(error.code, PCCD_E_QUOTA);
    assert_non_null(strstr(error.text, "1234"));
    assert_non_null(strstr(error.text, "meshes"));
    assert_non_null(strstr(error.text, "quota of 3"));
    srv_quota_release(&quota, user);
    srv_quota_deinit(&quota);
}

/* If it failed, a user would be locked out after a day of normal use. */
CASE(quota__refund_makes_room_again)
{
    struct srv_quota quota;
    struct proto_error error = {0};
    srv_quota_init(&quota, limits);
    struct srv_quota_user *user = srv_quota_acquire(&quota, 1000);
    for (int round = 0; round < 100; round++) {
        assert_int_equal(srv_quota_charge(user, SRV_QUOTA_MESHES, 3, &error), 0);
        assert_int_equal(srv_quota_charge(user, SRV_QUOTA_MESHES, 1, &error),
                         PCCD_E_QUOTA);
        srv_quota_refund(user, SRV_QUOTA_MESHES, 3);
    }
    assert_int_equal(quota.total[SRV_QUOTA_MESHES], 0);
    srv_quota_release(&quota, user);
    srv_quota_deinit(&quota);
}

/* One user's use must not be another's refusal; the same user's connections share. */
CASE(quota__users_are_apart_and_connections_of_one_share)
{
    struct srv_quota quota;
    struct proto_error error = {0};
    srv_quota_init(&quota, limits);
    struct srv_quota_user *alice = srv_quota_acquire(&quota, 1000);
    struct srv_quota_user *bob = srv_quota_acquire(&quota, 1001);
    struct srv_quota_user *alice_too = srv_quota_acquire(&quota, 1000);
    assert_ptr_equal(alice, alice_too);
    assert_ptr_not_equal(alice, bob);
    assert_int_equal(srv_quota_charge(alice, SRV_QUOTA_CLIENTS, 2, &error), 0);
    assert_int_equal(srv_quota_charge(alice_too, SRV_QUOTA_CLIENTS, 1, &error),
                     PCCD_E_QUOTA);
    assert_int_equal(srv_quota_charge(bob, SRV_QUOTA_CLIENTS, 2, &error), 0);
    assert_int_equal(quota.total[SRV_QUOTA_CLIENTS], 4);
    srv_quota_refund(alice, SRV_QUOTA_CLIENTS, 2);
    srv_quota_release(&quota, alice);
    assert_int_equal(srv_quota_charge(alice_too, SRV_QUOTA_CLIENTS, 1, &error), 0);
    srv_quota_refund(alice_too, SRV_QUOTA_CLIENTS, 1);
    srv_quota_refund(bob, SRV_QUOTA_CLIENTS, 2);
    srv_quota_release(&quota, alice_too);
    srv_quota_release(&quota, bob);
    srv_quota_deinit(&quota);
}

/* Kinds that shared a counter would refuse a mesh because of memory. */
CASE(quota__kinds_are_apart)
{
    struct srv_quota quota;
    struct proto_error error = {0};
    srv_quota_init(&quota, limits);
    struct srv_quota_user *user = srv_quota_acquire(&quota, 1000);
    for (int kind = 0; kind < SRV_QUOTA_COUNT; kind++) {
        assert_ok(
            srv_quota_charge(user, (enum srv_quota_kind)kind, limits[kind], &error));
    }
    for (int kind = 0; kind < SRV_QUOTA_COUNT; kind++) {
        assert_int_equal(srv_quota_charge(user, (enum srv_quota_kind)kind, 1, &error),
                         PCCD_E_QUOTA);
        srv_quota_refund(user, (enum srv_quota_kind)kind, limits[kind]);
    }
    srv_quota_release(&quota, user);
    srv_quota_deinit(&quota);
}

/* A mesh of one triangle and two thousand million vertices must not be nearly free. */
CASE(quota__vertices_count_as_thirds_of_triangles)
{
    assert_int_equal(srv_triangle_charge(3, 1), 1);
    assert_int_equal(srv_triangle_charge(4, 1), 2);
    assert_int_equal(srv_triangle_charge(300, 100), 100);
    assert_int_equal(srv_triangle_charge(50, 100), 100);
    assert_int_equal(srv_triangle_charge(2147483647u, 1), 715827883u);
    assert_int_equal(srv_triangle_charge(UINT32_MAX, 1), 1431655765u);
}
