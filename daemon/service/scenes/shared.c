/* shared.c - scenes that sessions share. */
#include "shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enginemem.h"
#include "held.h"
#include "host.h"
#include "invariant.h"
#include "log.h"
#include "meshes.h"
#include "now.h"
#include "service.h"
#include "session.h"
#include "srv_journal.h"

/* ---- who may ----------------------------------------------------------------------- */

#define MAY_READ  4u
#define MAY_WRITE 2u

/* Return which of MAY_READ and MAY_WRITE the session has, as with a file. */
static uint32_t rights_of(const struct srv_session *session,
                          const struct srv_shared *shared)
{
    uid_t uid = session->owner.user->uid;
    if (uid == 0) {
        return MAY_READ | MAY_WRITE;
    }
    uint32_t shift = uid == shared->uid                               ? 6
                     : srv_conn_has_group(session->conn, shared->gid) ? 3
                                                                      : 0;
    return shared->rights >> shift & (MAY_READ | MAY_WRITE);
}

static struct srv_member *member_of(const struct srv_shared *shared,
                                    const struct srv_session *session)
{
    struct srv_member *member = shared->members;
    while (member != NULL && member->session != session) {
        member = member->next;
    }
    return member;
}

struct srv_member *srv_shared_member(const struct srv_scene *scene,
                                     const struct srv_session *session)
{
    srv_assert_loop();
    return scene->shared != NULL ? member_of(scene->shared, session) : NULL;
}

void srv_shared_tell(const struct srv_scene *scene, const struct srv_session *session,
                     struct proto_LIST_SCENE_result *result)
{
    srv_assert_loop();
    const struct srv_shared *shared = scene->shared;
    if (shared == NULL) {
        return;
    }
    (void)snprintf(result->name, sizeof result->name, "%s", shared->name);
    result->uid = (uint32_t)shared->uid;
    result->rights = shared->rights;
    result->writable = member_of(shared, session)->is_writer;
    for (const struct srv_member *member = shared->members; member != NULL;
         member = member->next) {
        result->members++;
        result->held += member->holds;
    }
}

int srv_shared_refuse_reader(const struct srv_session *session,
                             const struct srv_scene *scene, struct proto_error *error)
{
    const struct srv_shared *shared = scene->shared;
    return shared == NULL || member_of(shared, session)->is_writer
               ? 0
               : proto_error_set(error, PCCD_E_ACCESS,
                                 "user %u may only read scene \"%s\" of user %u: its "
                                 "rights are 0%o",
                                 (unsigned)session->owner.user->uid, shared->name,
                                 (unsigned)shared->uid, shared->rights);
}

/* ---- journals ---------------------------------------------------------------------- */

void srv_shared_refund_journal(struct srv_member *member)
{
    struct srv_session *session = member->session;
    srv_quota_refund(session->owner.user, SRV_QUOTA_SHM_BYTES, member->journal_bytes);
    member->journal_bytes = 0;
}

int srv_shared_charge_journal(struct srv_member *member, uint64_t bytes,
                              struct proto_error *error)
{
    struct srv_session *session = member->session;
    if (member->journal_bytes != 0) {
        return proto_error_set(error, PCCD_E_STATE,
                               "this session keeps a journal of scene \"%s\" already",
                               member->shared->name);
    }
    int status = srv_quota_charge(session->owner.user, SRV_QUOTA_SHM_BYTES, bytes, error);
    member->journal_bytes = status == 0 ? bytes : 0;
    return status;
}

/* ---- the end ----------------------------------------------------------------------- */

/* The last one has left, and nothing of it is in the scene any more. */
static void end(struct srv_shared *shared)
{
    struct srv_session *keeper = shared->keeper;
    srv_resource_drop(&shared->scene->resource);
    free(shared);
    srv_session_detach(keeper);
}

static void unlist(struct srv_shared *shared)
{
    struct srv_shared **at = &shared->keeper->service->shared;
    while (*at != shared) {
        at = &(*at)->next;
    }
    *at = shared->next;
}

/* The time for taking objects out, before it is the turn of others. */
#define LEAVE_NS 500000u

/* From now on the session's objects meet nothing, whoever steps before all of them are
 * out. [compute] */
static void hide(const struct srv_member *member)
{
    const struct srv_scene *scene = member->shared->scene;
    bool is_any = false;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        const struct srv_placed *placed = &scene->placed[i];
        if (placed->handle != 0 && placed->member == member) {
            int status = eng_scene_exclude(scene->engine, placed->engine_idx);
            PCCD_ASSERT(status == PCCD_OK); /* it has every object that is placed */
            is_any = true;
        }
    }
    if (is_any) {
        eng_scene_purge_excluded(scene->engine);
    }
}

void srv_shared_hide(struct srv_scene *scene)
{
    srv_assert_compute();
    if (scene->shared == NULL) {
        return;
    }
    struct srv_member *member =
        atomic_exchange_explicit(&scene->shared->hiding, NULL, memory_order_acquire);
    for (; member != NULL; member = member->next_hiding) {
        hide(member);
    }
}

/* Hide the objects soon: what the session has in flight is still to be computed with
 * them. */
static void hide_soon(struct srv_member *member)
{
    struct srv_shared *shared = member->shared;
    if (member->session->request_count > 0) {
        return;
    }
    member->next_hiding = atomic_load_explicit(&shared->hiding, memory_order_relaxed);
    while (!atomic_compare_exchange_weak_explicit(&shared->hiding, &member->next_hiding,
                                                  member, memory_order_release,
                                                  memory_order_relaxed)) {
    }
}

/* Take what it held and the session's objects out of the engine's scene. [compute] */
static void run_leave(struct srv_job *job)
{
    struct srv_member *member = (struct srv_member *)job;
    struct srv_scene *scene = member->shared->scene;
    struct srv_session *keeper = member->shared->keeper;
    struct srv_enginemem memory;
    srv_enginemem_begin(&memory, keeper->owner.user);
    if (member->cursor == 0) { /* what it moves goes now */
        member->left = srv_held_frame_remove(scene, member);
        srv_journal_end(scene, member);
        srv_shared_hide(scene);
        hide(member);
    }
    uint64_t begin_ns = common_now_ns();
    bool has_time = true;
    while (has_time && member->cursor < scene->placed_count) {
        struct srv_placed *placed = &scene->placed[member->cursor++];
        if (placed->handle != 0 && placed->member == member) {
            srv_journal_gone(scene, placed->handle);
            srv_scene_displace(scene, placed);
            has_time = common_now_ns() - begin_ns < LEAVE_NS;
        }
    }
    job->goes_on = member->cursor < scene->placed_count;
    srv_enginemem_end(&memory);
}

static void done_leaving(struct srv_job *job)
{
    struct srv_member *member = (struct srv_member *)job;
    struct srv_shared *shared = member->shared;
    struct srv_session *session = member->session;
    srv_scene_forget_of(shared->scene, member);
    srv_held_frame_free(member->left);
    srv_shared_refund_journal(member);
    srv_resource_drop(&shared->scene->resource); /* the table's */
    free(member);
    session->scene_count--;
    if (--shared->member_count == 0) {
        end(shared);
    }
    srv_owner_release(&session->owner);
}

void srv_shared_leave(struct srv_session *session, struct srv_scene *scene)
{
    srv_assert_loop();
    struct srv_shared *shared = scene->shared;
    struct srv_member **at = &shared->members;
    while ((*at)->session != session) {
        at = &(*at)->next;
    }
    struct srv_member *member = *at;
    *at = member->next;
    session->shared_count--;
    if (shared->members == NULL) {
        unlist(shared); /* its name is free */
    }
    srv_scene_unlink_of(scene, member);
    hide_soon(member);
    srv_owner_keep(&session->owner);
    srv_job_init(&member->leave, run_leave, done_leaving);
    member->claim = &scene->claim;
    member->leave.claims = &member->claim;
    member->leave.claim_count = 1;
    srv_compute_push_reap(&session->service->compute, &session->owner.job_list,
                          &member->leave);
}

/* ---- coming back ------------------------------------------------------------------- */

/* Clients that come back to another daemon want the handles that their objects had, most
 * of them small. Who adds an object before all are back gets it a place behind these, and
 * by chance, as the same may happen again: half of the places are behind any that chance
 * begins with. Places that are left empty count as those that are wanted do: of many such
 * scenes of a session the later ones have none aside. */
#define ASIDE_PLACES 128u

static uint32_t first_aside(const struct srv_session *session)
{
    uint64_t luck = (session->service->epoch ^ session->id) * 0x9e3779b97f4a7c15u;
    return ASIDE_PLACES + (uint32_t)(luck >> 32) % (ASIDE_PLACES / 2);
}

uint32_t srv_shared_aside(struct srv_member *member)
{
    srv_assert_loop();
    if (member == NULL || !member->shared->is_restored ||
        member->aside >= 2 * ASIDE_PLACES) {
        return 0;
    }
    return member->shared->scene->objects.generation_first << SRV_HANDLE_INDEX_BITS |
           member->aside++;
}

/* ---- taking part ------------------------------------------------------------------- */

/* Each user has names of their own. */
static struct srv_shared *find(const struct srv_service *service, uid_t uid,
                               const char *name)
{
    struct srv_shared *shared = service->shared;
    while (shared != NULL && (shared->uid != uid || strcmp(shared->name, name) != 0)) {
        shared = shared->next;
    }
    return shared;
}

/* One of that name that another user lets the session take part in; NULL: there is
 * none. */
static const struct srv_shared *find_of_others(const struct srv_session *session,
                                               const char *name)
{
    const struct srv_shared *shared = session->service->shared;
    while (shared != NULL &&
           (shared->uid == session->owner.user->uid || strcmp(shared->name, name) != 0 ||
            (rights_of(session, shared) & MAY_READ) == 0)) {
        shared = shared->next;
    }
    return shared;
}

/* The most that leave, of a user; no quota counts them, and clients that connect, make
 * scenes and close may be faster than these are freed. */
#define KEEPERS_LEAVING_MAX 64u

/* scene.create with a name, and where its answer goes. */
struct asked {
    struct srv_session *session;
    const struct proto_SCENE_CREATE_request *request;
    const struct eng_scene_settings *settings;
    struct proto_SCENE_CREATE_result *result;
    struct proto_error *error;
};

/* A member, and the session's handle for the scene. */
static int take_member(const struct asked *asked, struct srv_shared *shared,
                       uint32_t rights)
{
    struct srv_session *session = asked->session;
    struct proto_SCENE_CREATE_result *result = asked->result;
    if (session->shared_count >= PROTO_SHARED_PER_CLIENT) {
        return proto_error_set(asked->error, PCCD_E_LIMIT,
                               "no room for another shared scene: there are %u",
                               session->shared_count);
    }
    struct srv_member *member = calloc(1, sizeof *member);
    if (member == NULL) {
        return proto_error_set(asked->error, PCCD_E_NOMEM, "no memory to take part");
    }
    member->handle = asked->request->want;
    int status = srv_session_handle(session, &session->scenes, "scene", shared->scene,
                                    &member->handle, asked->error);
    if (status != 0) {
        free(member);
        return status;
    }
    srv_resource_acquire(&shared->scene->resource);
    member->shared = shared;
    member->session = session;
    member->is_writer = (rights & MAY_WRITE) != 0;
    member->aside = first_aside(session);
    shared->is_restored = shared->is_restored || asked->request->want != 0;
    member->next = shared->members;
    shared->members = member;
    shared->member_count++;
    session->scene_count++;
    session->shared_count++;
    result->scene = member->handle;
    result->writable = member->is_writer;
    result->number = shared->last.number;
    result->owner = (uint32_t)shared->uid;
    return 0;
}

/* One that there was. */
static int attach(const struct asked *asked, struct srv_shared *shared)
{
    const char *name = asked->request->name;
    uint32_t rights = rights_of(asked->session, shared);
    if ((rights & MAY_READ) == 0) {
        return proto_error_set(asked->error, PCCD_E_ACCESS,
                               "scene \"%s\" is user %u's, and its rights are 0%o", name,
                               (unsigned)shared->uid, shared->rights);
    }
    if (member_of(shared, asked->session) != NULL) {
        return proto_error_set(asked->error, PCCD_E_STATE,
                               "this session takes part in scene \"%s\" already", name);
    }
    asked->result->existed = true;
    return take_member(asked, shared, rights);
}

static int make(const struct asked *asked)
{
    struct srv_session *session = asked->session;
    struct srv_service *service = session->service;
    const struct proto_SCENE_CREATE_request *request = asked->request;
    size_t bytes = strlen(request->name) + 1;
    if (session->owner.user->keepers_leaving >= KEEPERS_LEAVING_MAX) {
        return proto_error_set(
            asked->error, PCCD_E_BUSY, "%u shared scenes of user %u wait to be freed",
            session->owner.user->keepers_leaving, (unsigned)session->owner.user->uid);
    }
    struct srv_shared *shared = calloc(1, sizeof *shared + bytes);
    struct srv_session *keeper =
        shared == NULL ? NULL : srv_session_new_keeper(service, session->owner.user->uid);
    struct srv_scene *scene =
        keeper == NULL ? NULL : srv_scene_new(keeper, asked->settings, asked->error);
    if (scene == NULL) {
        if (keeper != NULL) {
            srv_session_detach(keeper);
        }
        free(shared);
        return keeper != NULL
                   ? asked->error->code
                   : proto_error_set(asked->error, PCCD_E_NOMEM, "no memory for a scene");
    }
    *shared = (struct srv_shared){.keeper = keeper,
                                  .scene = scene,
                                  .uid = session->owner.user->uid,
                                  .gid = srv_conn_group(session->conn),
                                  .rights = request->rights != 0 ? request->rights
                                                                 : SRV_RIGHTS_DEFAULT};
    memcpy(shared->name, request->name, bytes);
    scene->shared = shared;
    int status = take_member(asked, shared, MAY_READ | MAY_WRITE);
    if (status != 0) {
        end(shared);
        return status;
    }
    srv_scene_name(scene, asked->result->scene);
    shared->next = service->shared;
    service->shared = shared;
    srv_log(SRV_LOG_INFO, session->id, "shares scene \"%s\", rights 0%o", shared->name,
            shared->rights);
    return 0;
}

/* There is no scene to take part in. Whoever means another user's hears whose. */
static int refuse_absent(const struct asked *asked, uid_t uid)
{
    const char *name = asked->request->name;
    const struct srv_shared *other = find_of_others(asked->session, name);
    if (other != NULL && uid == asked->session->owner.user->uid) {
        return proto_error_set(
            asked->error, PCCD_E_AGAIN,
            "user %u has no scene \"%s\" yet; user %u has one (share = "
            "%d, owner = %u)",
            (unsigned)uid, name, (unsigned)other->uid, PCCD_SHARE_OTHER,
            (unsigned)other->uid);
    }
    return proto_error_set(asked->error, PCCD_E_AGAIN, "user %u has no scene \"%s\" yet",
                           (unsigned)uid, name);
}

int srv_shared_open(struct srv_session *session,
                    const struct proto_SCENE_CREATE_request *request,
                    const struct eng_scene_settings *settings,
                    struct proto_SCENE_CREATE_result *result, struct proto_error *error)
{
    srv_assert_loop();
    const struct asked asked = {session, request, settings, result, error};
    bool is_other = request->share == PCCD_SHARE_OTHER;
    uid_t uid = is_other ? request->owner : session->owner.user->uid;
    struct srv_shared *shared = find(session->service, uid, request->name);
    if (request->share >= PCCD_SHARE_COUNT) {
        return proto_error_set(error, PCCD_E_INVAL, "unknown share %u", request->share);
    }
    if ((request->rights & ~SRV_RIGHTS_ALL) != 0) {
        return proto_error_set(error, PCCD_E_INVAL,
                               "rights are 0%o; they are made of the bits of 0%o",
                               request->rights, SRV_RIGHTS_ALL);
    }
    if (!is_other && request->owner != 0) {
        return proto_error_set(error, PCCD_E_INVAL, "owner is of share %d, not %u",
                               PCCD_SHARE_OTHER, request->share);
    }
    if (shared != NULL && request->share == PCCD_SHARE_CREATE) {
        return proto_error_set(error, PCCD_E_STATE, "user %u has a scene \"%s\" already",
                               (unsigned)uid, request->name);
    }
    if (shared == NULL && (is_other || request->share == PCCD_SHARE_ATTACH)) {
        return refuse_absent(&asked, uid);
    }
    return shared != NULL ? attach(&asked, shared) : make(&asked);
}

/* ---- news -------------------------------------------------------------------------- */

/* Replies of its own come first: a client that does not read is not told more. */
static bool can_tell(struct srv_session *session)
{
    bool can = session->state == SRV_SESSION_OPEN && session->conn != NULL &&
               srv_conn_is_free(session->conn);
    session->is_behind = session->is_behind || !can;
    return can;
}

static void tell_held(struct srv_member *member)
{
    struct srv_service *service = member->session->service;
    const struct proto_SCENE_HELD_request note = {.scene = member->handle,
                                                  .step = member->held_step};
    member->owes_held = note.step != 0 && !can_tell(member->session);
    if (note.step == 0 || member->owes_held) {
        return; /* it has been answered, or is told later */
    }
    int status =
        proto_encode_notification(service->encoder, PROTO_NOTE_SCENE_HELD, &note);
    PCCD_ASSERT(status == 0);
    srv_conn_send(member->session->conn, service->encoder, NULL, 0);
}

void srv_shared_waits(struct srv_member *member, uint64_t step)
{
    srv_assert_loop();
    member->held_step = step;
    tell_held(member);
}

void srv_shared_resumed(struct srv_session *session)
{
    srv_assert_loop();
    uint32_t cursor = 0;
    for (struct srv_scene *scene;
         (scene = srv_handles_next(&session->scenes, &cursor)) != NULL;) {
        struct srv_member *member = srv_shared_member(scene, session);
        if (member != NULL && member->held_step != 0) {
            member->owes_held = session->is_behind = true;
        }
    }
}

static void tell(struct srv_member *member)
{
    struct srv_session *session = member->session;
    struct srv_service *service = session->service;
    member->is_behind = !can_tell(session);
    if (member->is_behind) {
        return;
    }
    struct proto_SCENE_STEP_request note = member->shared->last;
    note.scene = member->handle;
    int status =
        proto_encode_notification(service->encoder, PROTO_NOTE_SCENE_STEP, &note);
    PCCD_ASSERT(status == 0);
    srv_conn_send(session->conn, service->encoder, NULL, 0);
}

void srv_shared_stepped(struct srv_scene *scene, const struct srv_session *by,
                        const struct proto_answer *answer)
{
    srv_assert_loop();
    struct srv_shared *shared = scene->shared;
    shared->last = (struct proto_SCENE_STEP_request){.number = answer->number,
                                                     .mode = answer->mode,
                                                     .incomplete = answer->incomplete,
                                                     .total = answer->total,
                                                     .hash_hi = answer->hash_hi,
                                                     .hash_lo = answer->hash_lo};
    if (answer->incomplete == PCCD_INCOMPLETE_RESULT_FULL) { /* that one's page only */
        shared->last.incomplete = PCCD_COMPLETE;
    }
    for (struct srv_member *member = shared->members; member != NULL;
         member = member->next) {
        if (member->session != by) {
            tell(member);
        }
    }
}

void srv_shared_catch_up(struct srv_session *session)
{
    srv_assert_loop();
    if (!session->is_behind) {
        return;
    }
    session->is_behind = false;
    uint32_t cursor = 0;
    for (struct srv_scene *scene;
         (scene = srv_handles_next(&session->scenes, &cursor)) != NULL;) {
        struct srv_member *member = srv_shared_member(scene, session);
        if (member != NULL && member->owes_held) {
            tell_held(member);
        }
        if (member != NULL && member->is_behind) {
            tell(member);
        }
    }
}
