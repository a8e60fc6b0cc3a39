/* shared.c - scenes that sessions share.
 *
 * Room:     service. See shared.h.
 * Does:     take a session in, let it leave, tell it of steps.
 * Does not: let more than the scenes of a session's table wait to be freed.
 * Threads:  [loop], but for run_leave.
 */
#include "shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "diary.h"
#include "enginemem.h"
#include "held.h"
#include "host.h"
#include "invariant.h"
#include "log.h"
#include "loop.h"
#include "meshes.h"
#include "now.h"
#include "session.h"

/* ---- who may ----------------------------------------------------------------------- */

#define MAY_READ  4u
#define MAY_WRITE 2u

/* Which of MAY_READ and MAY_WRITE the session has, as with a file. */
static uint32_t rights_of(const struct srv_session *session,
                          const struct srv_shared *shared)
{
    uid_t uid = session->user->uid;
    if (uid == 0) {
        return MAY_READ | MAY_WRITE;
    }
    uint32_t shift = uid == shared->uid                               ? 6
                     : srv_conn_has_group(session->conn, shared->gid) ? 3
                                                                      : 0;
    return shared->rights >> shift & (MAY_READ | MAY_WRITE);
}

static struct srv_seat *seat_of(const struct srv_shared *shared,
                                const struct srv_session *session)
{
    struct srv_seat *seat = shared->seats;
    while (seat != NULL && seat->session != session) {
        seat = seat->next;
    }
    return seat;
}

struct srv_seat *srv_shared_seat(const struct srv_scene *scene,
                                 const struct srv_session *session)
{
    srv_assert_loop();
    return scene->shared != NULL ? seat_of(scene->shared, session) : NULL;
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
    result->writable = seat_of(shared, session)->is_writer;
    for (const struct srv_seat *seat = shared->seats; seat != NULL; seat = seat->next) {
        result->seats++;
        result->held += seat->holds;
    }
}

int srv_shared_refuse_reader(const struct srv_session *session,
                             const struct srv_scene *scene, struct proto_error *error)
{
    const struct srv_shared *shared = scene->shared;
    return shared == NULL || seat_of(shared, session)->is_writer
               ? 0
               : proto_error_set(error, PCCD_E_ACCESS,
                                 "user %u may only read scene \"%s\" of user %u: its "
                                 "rights are 0%o",
                                 (unsigned)session->user->uid, shared->name,
                                 (unsigned)shared->uid, shared->rights);
}

/* ---- journals ---------------------------------------------------------------------- */

void srv_shared_refund_journal(struct srv_seat *seat)
{
    struct srv_session *session = seat->session;
    srv_quota_refund(&session->loop->quota, session->user, SRV_QUOTA_SHM_BYTES,
                     seat->journal_bytes);
    seat->journal_bytes = 0;
}

int srv_shared_charge_journal(struct srv_call *call, struct srv_seat *seat,
                              uint64_t bytes)
{
    struct srv_session *session = seat->session;
    if (seat->journal_bytes != 0) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "this session keeps a journal of scene \"%s\" already",
                               seat->shared->name);
    }
    int status = srv_quota_charge(&session->loop->quota, session->user,
                                  SRV_QUOTA_SHM_BYTES, bytes, &call->error);
    seat->journal_bytes = status == 0 ? bytes : 0;
    return status;
}

/* ---- the end ----------------------------------------------------------------------- */

/* The last one has left, and nothing of it is in the scene any more. */
static void end(struct srv_shared *shared)
{
    struct srv_session *host = shared->host;
    srv_resource_drop(&shared->scene->resource);
    free(shared);
    srv_session_detach(host);
}

static void unlist(struct srv_shared *shared)
{
    struct srv_shared **at = &shared->host->loop->shared;
    while (*at != shared) {
        at = &(*at)->next;
    }
    *at = shared->next;
}

/* Of taking objects out, before it is the turn of others. */
#define LEAVE_NS 500000u

/* From now on the session's objects meet nothing, whoever steps before all of them are
 * out. [compute] */
static void hide(const struct srv_seat *seat)
{
    const struct srv_scene *scene = seat->shared->scene;
    bool is_any = false;
    for (uint32_t i = 0; i < scene->placed_count; i++) {
        const struct srv_placed *placed = &scene->placed[i];
        if (placed->handle != 0 && placed->seat == seat) {
            int status = eng_scene_hide(scene->engine, placed->engine_idx);
            PCCD_ASSERT(status == ENG_OK); /* it has every object that is placed */
            is_any = true;
        }
    }
    if (is_any) {
        eng_scene_forget_hidden(scene->engine);
    }
}

void srv_shared_hide(struct srv_scene *scene)
{
    srv_assert_compute();
    if (scene->shared == NULL) {
        return;
    }
    struct srv_seat *seat =
        atomic_exchange_explicit(&scene->shared->hiding, NULL, memory_order_acquire);
    for (; seat != NULL; seat = seat->next_hiding) {
        hide(seat);
    }
}

/* What the session has in flight is still to be computed with its objects. */
static void hide_soon(struct srv_seat *seat)
{
    struct srv_shared *shared = seat->shared;
    if (seat->session->request_count > 0) {
        return;
    }
    seat->next_hiding = atomic_load_explicit(&shared->hiding, memory_order_relaxed);
    while (!atomic_compare_exchange_weak_explicit(&shared->hiding, &seat->next_hiding,
                                                  seat, memory_order_release,
                                                  memory_order_relaxed)) {
    }
}

/* Take what it held and the session's objects out of the engine's scene. [compute] */
static void run_leave(struct srv_job *job)
{
    struct srv_seat *seat = (struct srv_seat *)job;
    struct srv_scene *scene = seat->shared->scene;
    struct srv_session *host = seat->shared->host;
    struct srv_enginemem memory;
    srv_enginemem_begin(&memory, host->user, host->loop->options->engine_bytes_max);
    if (seat->cursor == 0) { /* what it moves goes now */
        seat->left = srv_held_remove(scene, seat);
        srv_diary_end(scene, seat);
        srv_shared_hide(scene);
        hide(seat);
    }
    uint64_t begin_ns = srv_now_ns();
    bool has_time = true;
    while (has_time && seat->cursor < scene->placed_count) {
        struct srv_placed *placed = &scene->placed[seat->cursor++];
        if (placed->handle != 0 && placed->seat == seat) {
            srv_scene_displace(scene, placed);
            has_time = srv_now_ns() - begin_ns < LEAVE_NS;
        }
    }
    job->goes_on = seat->cursor < scene->placed_count;
    srv_enginemem_end(&memory);
}

static void done_leaving(struct srv_job *job)
{
    struct srv_seat *seat = (struct srv_seat *)job;
    struct srv_shared *shared = seat->shared;
    struct srv_session *session = seat->session;
    srv_scene_forget_of(shared->scene, seat);
    srv_held_free(seat->left);
    srv_shared_refund_journal(seat);
    srv_resource_drop(&shared->scene->resource); /* the table's */
    free(seat);
    session->scene_count--;
    if (--shared->seat_count == 0) {
        end(shared);
    }
    srv_session_reaped(session);
}

void srv_shared_leave(struct srv_session *session, struct srv_scene *scene)
{
    srv_assert_loop();
    struct srv_shared *shared = scene->shared;
    struct srv_seat **at = &shared->seats;
    while ((*at)->session != session) {
        at = &(*at)->next;
    }
    struct srv_seat *seat = *at;
    *at = seat->next;
    if (shared->seats == NULL) {
        unlist(shared); /* its name is free */
    }
    srv_scene_unlink_of(scene, seat);
    hide_soon(seat);
    session->reap_count++;
    srv_job_init(&seat->leave, run_leave, done_leaving);
    seat->claim = &scene->claim;
    seat->leave.claims = &seat->claim;
    seat->leave.claim_count = 1;
    srv_compute_push_reap(&session->loop->compute, &session->lane, &seat->leave);
}

/* ---- coming back ------------------------------------------------------------------- */

/* Clients that come back to another daemon want the handles that their objects had, most
 * of them small. Who adds an object before all are back gets it a place behind these, and
 * by chance, as the same may happen again. Places that are left empty count as those that
 * are wanted do: of many such scenes of a session the later ones have none aside. */
#define ASIDE_PLACES 128u

static uint32_t first_aside(const struct srv_session *session)
{
    uint64_t luck = (session->loop->epoch ^ session->id) * 0x9e3779b97f4a7c15u;
    return ASIDE_PLACES + (uint32_t)(luck >> 32) % ASIDE_PLACES;
}

uint32_t srv_shared_aside(struct srv_seat *seat)
{
    srv_assert_loop();
    if (seat == NULL || !seat->shared->is_restored || seat->aside >= 2 * ASIDE_PLACES) {
        return 0;
    }
    return seat->shared->scene->objects.generation_first << SRV_HANDLE_INDEX_BITS |
           seat->aside++;
}

/* ---- taking part ------------------------------------------------------------------- */

/* Each user has names of their own. */
static struct srv_shared *find(const struct srv_loop *loop, uid_t uid, const char *name)
{
    struct srv_shared *shared = loop->shared;
    while (shared != NULL && (shared->uid != uid || strcmp(shared->name, name) != 0)) {
        shared = shared->next;
    }
    return shared;
}

/* One of that name that another user lets the session take part in; NULL: there is
 * none. */
static const struct srv_shared *find_foreign(const struct srv_session *session,
                                             const char *name)
{
    const struct srv_shared *shared = session->loop->shared;
    while (shared != NULL &&
           (shared->uid == session->user->uid || strcmp(shared->name, name) != 0 ||
            (rights_of(session, shared) & MAY_READ) == 0)) {
        shared = shared->next;
    }
    return shared;
}

/* Of a user; no quota counts them, and clients that connect, make scenes and close may be
 * faster than these are freed. */
#define HOSTS_LEAVING_MAX PROTO_SCENES_PER_CLIENT

/* A seat, and the session's handle for the scene. */
static int take_seat(struct srv_call *call, struct srv_shared *shared, uint32_t rights)
{
    struct srv_session *session = call->session;
    struct proto_SCENE_CREATE_result *result = &call->result.SCENE_CREATE;
    struct srv_seat *seat = calloc(1, sizeof *seat);
    if (seat == NULL) {
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory to take part");
    }
    uint32_t want = call->params.SCENE_CREATE.want;
    int status = srv_session_handle(session, &session->scenes, "scene", shared->scene,
                                    want, &seat->handle, &call->error);
    if (status != 0) {
        free(seat);
        return status;
    }
    srv_resource_acquire(&shared->scene->resource);
    seat->shared = shared;
    seat->session = session;
    seat->is_writer = (rights & MAY_WRITE) != 0;
    seat->aside = first_aside(session);
    shared->is_restored = shared->is_restored || want != 0;
    seat->next = shared->seats;
    shared->seats = seat;
    shared->seat_count++;
    session->scene_count++;
    result->scene = seat->handle;
    result->writable = seat->is_writer;
    result->number = shared->last.number;
    result->owner = (uint32_t)shared->uid;
    return 0;
}

/* One that there was. */
static int attach(struct srv_call *call, struct srv_shared *shared)
{
    const char *name = call->params.SCENE_CREATE.name;
    uint32_t rights = rights_of(call->session, shared);
    if ((rights & MAY_READ) == 0) {
        return proto_error_set(&call->error, PCCD_E_ACCESS,
                               "scene \"%s\" is user %u's, and its rights are 0%o", name,
                               (unsigned)shared->uid, shared->rights);
    }
    if (seat_of(shared, call->session) != NULL) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "this session takes part in scene \"%s\" already", name);
    }
    call->result.SCENE_CREATE.existed = true;
    return take_seat(call, shared, rights);
}

static int make(struct srv_call *call, const struct eng_scene_settings *settings)
{
    struct srv_session *session = call->session;
    struct srv_loop *loop = session->loop;
    const struct proto_SCENE_CREATE_request *request = &call->params.SCENE_CREATE;
    size_t bytes = strlen(request->name) + 1;
    if (session->user->hosts_leaving >= HOSTS_LEAVING_MAX) {
        return proto_error_set(
            &call->error, PCCD_E_BUSY, "%u shared scenes of user %u wait to be freed",
            session->user->hosts_leaving, (unsigned)session->user->uid);
    }
    struct srv_shared *shared = calloc(1, sizeof *shared + bytes);
    struct srv_session *host =
        shared == NULL ? NULL : srv_session_new_host(loop, session->user->uid);
    struct srv_scene *scene = host == NULL ? NULL : srv_scene_new(host, settings);
    if (scene == NULL) {
        if (host != NULL) {
            srv_session_detach(host);
        }
        free(shared);
        return proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a scene");
    }
    *shared = (struct srv_shared){.host = host,
                                  .scene = scene,
                                  .uid = session->user->uid,
                                  .gid = srv_conn_group(session->conn),
                                  .rights = request->rights != 0 ? request->rights
                                                                 : SRV_RIGHTS_DEFAULT};
    memcpy(shared->name, request->name, bytes);
    scene->shared = shared;
    int status = take_seat(call, shared, MAY_READ | MAY_WRITE);
    if (status != 0) {
        end(shared);
        return status;
    }
    srv_scene_name(scene, call->result.SCENE_CREATE.scene);
    shared->next = loop->shared;
    loop->shared = shared;
    srv_log(SRV_LOG_INFO, session->id, "shares scene \"%s\", rights 0%o", shared->name,
            shared->rights);
    return 0;
}

/* There is no scene to take part in. Whoever means another user's hears whose. */
static int refuse_absent(struct srv_call *call, uid_t uid)
{
    const char *name = call->params.SCENE_CREATE.name;
    const struct srv_shared *foreign = find_foreign(call->session, name);
    if (foreign != NULL && uid == call->session->user->uid) {
        return proto_error_set(
            &call->error, PCCD_E_AGAIN,
            "user %u has no scene \"%s\" yet; user %u has one (share = "
            "%d, owner = %u)",
            (unsigned)uid, name, (unsigned)foreign->uid, PCCD_SHARE_OTHER,
            (unsigned)foreign->uid);
    }
    return proto_error_set(&call->error, PCCD_E_AGAIN, "user %u has no scene \"%s\" yet",
                           (unsigned)uid, name);
}

int srv_shared_open(struct srv_call *call, const struct eng_scene_settings *settings)
{
    srv_assert_loop();
    const struct proto_SCENE_CREATE_request *request = &call->params.SCENE_CREATE;
    bool is_other = request->share == PCCD_SHARE_OTHER;
    uid_t uid = is_other ? request->owner : call->session->user->uid;
    struct srv_shared *shared = find(call->session->loop, uid, request->name);
    if (request->share >= PCCD_SHARE_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "unknown share %u",
                               request->share);
    }
    if ((request->rights & ~SRV_RIGHTS_ALL) != 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "rights are 0%o; they are made of the bits of 0%o",
                               request->rights, SRV_RIGHTS_ALL);
    }
    if (!is_other && request->owner != 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "owner is of share %d, not %u",
                               PCCD_SHARE_OTHER, request->share);
    }
    if (shared != NULL && request->share == PCCD_SHARE_CREATE) {
        return proto_error_set(&call->error, PCCD_E_STATE,
                               "user %u has a scene \"%s\" already", (unsigned)uid,
                               request->name);
    }
    if (shared == NULL && (is_other || request->share == PCCD_SHARE_ATTACH)) {
        return refuse_absent(call, uid);
    }
    return shared != NULL ? attach(call, shared) : make(call, settings);
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

static void tell_held(struct srv_seat *seat)
{
    struct srv_loop *loop = seat->session->loop;
    const struct proto_SCENE_HELD_request note = {.scene = seat->handle,
                                                  .step = seat->held_step};
    seat->owes_held = note.step != 0 && !can_tell(seat->session);
    if (note.step == 0 || seat->owes_held) {
        return; /* it has been answered, or is told later */
    }
    int status = proto_encode_notification(loop->encoder, PROTO_NOTE_SCENE_HELD, &note);
    PCCD_ASSERT(status == 0);
    srv_conn_send(seat->session->conn, loop->encoder, NULL, 0);
}

void srv_shared_waits(struct srv_seat *seat, uint64_t step)
{
    srv_assert_loop();
    seat->held_step = step;
    tell_held(seat);
}

void srv_shared_resumed(struct srv_session *session)
{
    srv_assert_loop();
    uint32_t cursor = 0;
    for (struct srv_scene *scene;
         (scene = srv_handles_next(&session->scenes, &cursor)) != NULL;) {
        struct srv_seat *seat = srv_shared_seat(scene, session);
        if (seat != NULL && seat->held_step != 0) {
            seat->owes_held = session->is_behind = true;
        }
    }
}

static void tell(struct srv_seat *seat)
{
    struct srv_session *session = seat->session;
    struct srv_loop *loop = session->loop;
    seat->is_behind = !can_tell(session);
    if (seat->is_behind) {
        return;
    }
    struct proto_SCENE_STEP_request note = seat->shared->last;
    note.scene = seat->handle;
    int status = proto_encode_notification(loop->encoder, PROTO_NOTE_SCENE_STEP, &note);
    PCCD_ASSERT(status == 0);
    srv_conn_send(session->conn, loop->encoder, NULL, 0);
}

void srv_shared_stepped(struct srv_scene *scene, const struct srv_session *by,
                        const struct proto_FRAME_SUBMIT_result *answer)
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
    for (struct srv_seat *seat = shared->seats; seat != NULL; seat = seat->next) {
        if (seat->session != by) {
            tell(seat);
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
        struct srv_seat *seat = srv_shared_seat(scene, session);
        if (seat != NULL && seat->owes_held) {
            tell_held(seat);
        }
        if (seat != NULL && seat->is_behind) {
            tell(seat);
        }
    }
}
