/* actor.c - one client of a run. */
#include "actor.h"

#include <math.h>
#include <stdlib.h>

/* A slot takes both ends of the sheet in double; the region the answers to LOAD_DEPTH_MAX
 * steps of a small sheet, which has most records for its size. */
#define SLOT_BYTES          4096u
#define SLOT_VERTEX_BYTES   48u
#define RESULT_BYTES        (256u << 10)
#define RESULT_VERTEX_BYTES 1024u

/* A step without an answer for so long is lost. */
#define STALL_NS 120000000000ull

/* For a machine that is busy with other things, too. */
#define PATIENCE_MS 60000

/* The sheet is 1 wide. */
#define NEAR_DISTANCE 0.25

/* Requests between two changes of a client that churns. */
#define CHURN_EVERY 64u

_Static_assert(CHURN_EVERY % LOAD_FRAMES == 0, "a change begins a round");

static void complain(const struct load_actor *actor, const char *what)
{
    load_say("client %u: %s: %s%s%s", actor->number, what, pccd_error_text(actor->client),
             actor->second ? "; its second client: " : "",
             actor->second ? pccd_error_text(actor->second) : "");
}

/* ---- what it registers ------------------------------------------------------------- */

/* Return the format of positions that follow the registered ones, and of these: a sheet
 * that comes round is where it was. */
static enum pccd_format format_of(const struct load_actor *actor)
{
    return actor->kind == LOAD_PAIRS ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32;
}

static int create_sheet(struct load_actor *actor, bool replace, void *x,
                        uint32_t (*triangles)[3])
{
    uint32_t vertices = load_sheet_vertices(&actor->shape);
    uint32_t count = load_sheet_triangle_count(&actor->shape);
    const uint32_t(*constant)[3] = (const uint32_t(*)[3])(const void *)triangles;
    enum pccd_format format = format_of(actor);
    load_sheet_at(&actor->shape, 0, format, x);
    load_sheet(&actor->shape, triangles);
    return replace ? pccd_mesh_replace(actor->client, actor->sheet_mesh, x, format,
                                       vertices, constant, count, NULL)
                   : pccd_mesh_create(actor->client, x, format, vertices, constant, count,
                                      &actor->sheet_mesh, NULL);
}

static int add_sheet(struct load_actor *actor, bool replace)
{
    void *x = malloc(sizeof(double[3]) * load_sheet_vertices(&actor->shape));
    void *triangles =
        malloc(sizeof(uint32_t[3]) * load_sheet_triangle_count(&actor->shape));
    int status =
        x && triangles ? create_sheet(actor, replace, x, triangles) : PCCD_E_NOMEM;
    free(x);
    free(triangles);
    return status != 0 || replace ? status
                                  : pccd_scene_add(actor->client, actor->scene,
                                                   actor->sheet_mesh, &actor->sheet);
}

static int add_floor(struct load_actor *actor)
{
    float x[LOAD_FLOOR_VERTICES][3];
    uint32_t triangles[LOAD_FLOOR_TRIANGLES][3];
    load_floor(&actor->shape, x, triangles);
    struct pccd_client *client = actor->second ? actor->second : actor->client;
    uint32_t scene = actor->second ? actor->second_scene : actor->scene;
    int status = pccd_mesh_create(client, x, PCCD_FORMAT_F32, LOAD_FLOOR_VERTICES,
                                  (const uint32_t(*)[3])(const void *)triangles,
                                  LOAD_FLOOR_TRIANGLES, &actor->floor_mesh, NULL);
    return status != 0 ? status
                       : pccd_scene_add(client, scene, actor->floor_mesh, &actor->floor);
}

static bool shares(const struct load_actor *actor)
{
    return actor->kind == LOAD_SHARE && !actor->is_alone;
}

/* Whose requests are batches. */
static bool is_flock(const struct load_actor *actor)
{
    return actor->kind == LOAD_BATCH && !actor->is_alone;
}

/* Steps of a request. */
static uint32_t width_of(const struct load_actor *actor)
{
    return is_flock(actor) ? actor->load->settings.batch : 1;
}

static int add_all(struct load_actor *actor, const struct pccd_options *options)
{
    int status = shares(actor) ? load_couple_open(actor, options)
                               : pccd_scene_create(actor->client, NULL, &actor->scene);
    status = status == 0 && actor->sheet_first ? add_sheet(actor, false) : status;
    status = status == 0 ? add_floor(actor) : status;
    status = status == 0 && !actor->sheet_first ? add_sheet(actor, false) : status;
    status = status == 0 && is_flock(actor) ? load_flock_open(actor) : status;
    return status == 0 && actor->second ? load_couple_settle(actor) : status;
}

static int drop_all(struct load_actor *actor)
{
    int status = pccd_scene_destroy(actor->client, actor->scene);
    status = status == 0 ? pccd_mesh_destroy(actor->client, actor->floor_mesh) : status;
    return status == 0 ? pccd_mesh_destroy(actor->client, actor->sheet_mesh) : status;
}

/* ---- its connection ---------------------------------------------------------------- */

static int connect_and_add(struct load_actor *actor, bool loud)
{
    struct pccd_options options;
    pccd_options_init(&options);
    options.url = actor->load->url;
    options.name = "pccd-load";
    options.no_autostart = true;
    options.slot_count = actor->load->settings.depth;
    uint64_t vertices = load_sheet_vertices(&actor->shape);
    options.slot_bytes = (SLOT_BYTES + SLOT_VERTEX_BYTES * vertices) * width_of(actor);
    options.result_bytes =
        (RESULT_BYTES + RESULT_VERTEX_BYTES * vertices * options.slot_count) *
        width_of(actor);
    options.spin_us = 0; /* there are more clients than processors */
    options.reconnect_ms = PATIENCE_MS;
    options.daemons_max = -1; /* they are killed by chance, not by what is asked */
    options.timeout_ms = PATIENCE_MS;
    int status = pccd_connect(&options, &actor->client);
    if (status == 0) {
        actor->tally->opened++;
        status = add_all(actor, &options);
    }
    if (status != 0 && loud) {
        complain(actor, "cannot begin");
    }
    actor->moved_ns = common_now_ns();
    return status;
}

/* Clients take the kinds by turns. */
static enum load_kind kind_of(uint32_t kinds, uint32_t number)
{
    uint32_t rank = number % (uint32_t)__builtin_popcount(kinds);
    for (int kind = 0; kind < LOAD_KINDS; kind++) {
        if ((kinds >> kind & 1) != 0 && rank-- == 0) {
            return (enum load_kind)kind;
        }
    }
    return LOAD_FOLLOW;
}

int load_actor_open(struct load_actor *actor, bool loud)
{
    const struct load *load = actor->load;
    actor->shape = load_shape_of(load, actor->number);
    actor->kind = kind_of(load->settings.kinds, actor->number);
    actor->pace = (struct load_pace){.client = actor->number, .due_ns = common_now_ns()};
    return connect_and_add(actor, loud);
}

void load_actor_close(struct load_actor *actor)
{
    actor->tally->lost += (uint64_t)actor->pending_count * width_of(actor);
    actor->pending_count = 0;
    load_couple_close(actor);
    load_flock_close(actor);
    pccd_close(actor->client);
    actor->client = NULL;
}

/* Something failed that must not: say so, and begin anew. */
static void break_off(struct load_actor *actor, const char *what)
{
    complain(actor, what);
    actor->tally->broken++;
    load_actor_close(actor);
    actor->next = 0;
    actor->last_step = 0;
    if (connect_and_add(actor, true) != 0) {
        atomic_store(&actor->load->shared->failed, true);
    }
}

/* One of four changes; its shape stands at position 0 again. */
static int churn(struct load_actor *actor)
{
    int status = 0;
    actor->tally->remade++;
    switch (load_mix(actor->number, actor->next) % 4) {
    case 0:
        return add_sheet(actor, true);
    case 1:
        status = pccd_scene_remove(actor->client, actor->scene, actor->sheet);
        return status != 0 ? status
                           : pccd_scene_add(actor->client, actor->scene,
                                            actor->sheet_mesh, &actor->sheet);
    case 2:
        status = drop_all(actor);
        return status != 0 ? status : add_all(actor, NULL);
    default:
        load_actor_close(actor);
        actor->last_step = 0;
        return connect_and_add(actor, true);
    }
}

/* ---- steps ------------------------------------------------------------------------- */

static enum load_mischief mischief_of(const struct load_actor *actor)
{
    static const enum load_mischief some[] = {LOAD_CANCELLED, LOAD_CANCELLED, LOAD_DUE,
                                              LOAD_NOT_FINITE};
    uint64_t luck = load_mix(~actor->load->settings.seed,
                             (uint64_t)actor->number << 32 ^ actor->next);
    if (shares(actor)) { /* boxes of the floor's own features touch, masked or not */
        bool may_mask = actor->load->settings.mode != PCCD_MODE_PAIRS;
        return may_mask && luck % 8 == 0 ? LOAD_MASKED : LOAD_PLAIN;
    }
    bool may_err =
        (actor->kind == LOAD_JUMP || actor->kind == LOAD_BATCH) && !actor->is_alone;
    return may_err && luck % 64 < 4 ? some[luck % 64] : LOAD_PLAIN;
}

static int write_jump(const struct load_actor *actor, struct pccd_frame *frame,
                      const struct load_pending *pending)
{
    void *x0;
    void *x1;
    int status = pccd_frame_x0x1(frame, actor->sheet, PCCD_FORMAT_F64, 0,
                                 load_sheet_vertices(&actor->shape), &x0, &x1);
    if (status != 0) {
        return status;
    }
    load_sheet_at(&actor->shape, pending->from, PCCD_FORMAT_F64, x0);
    load_sheet_at(&actor->shape, (pending->from + 1) % LOAD_FRAMES, PCCD_FORMAT_F64, x1);
    if (pending->mischief == LOAD_NOT_FINITE) {
        ((double *)x1)[7] = NAN;
    }
    return 0;
}

static int write_step(const struct load_actor *actor, struct pccd_frame *frame,
                      const struct load_pending *pending)
{
    const struct load_shape *shape = &actor->shape;
    uint32_t vertices = load_sheet_vertices(shape);
    uint32_t to = (pending->from + 1) % LOAD_FRAMES;
    double m0[12];
    double m1[12];
    void *x1;
    if (actor->kind == LOAD_JUMP || actor->kind == LOAD_BATCH) {
        return write_jump(actor, frame, pending);
    }
    if (actor->kind == LOAD_RIGID) {
        load_sheet_pose(shape, pending->from, m0);
        load_sheet_pose(shape, to, m1);
        return pccd_frame_rigid(frame, actor->sheet, 0, vertices, m0, m1);
    }
    enum pccd_format format = format_of(actor);
    int status = pccd_frame_x1(frame, actor->sheet, format, 0, vertices, &x1);
    if (status == 0) {
        load_sheet_at(shape, to, format, x1);
    }
    return status;
}

static struct pccd_step_settings settings_of(const struct load_actor *actor,
                                             enum load_mischief mischief)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    settings.mode = actor->kind == LOAD_RIGID   ? PCCD_MODE_FIRST
                    : actor->kind == LOAD_PAIRS ? PCCD_MODE_PAIRS
                                                : PCCD_MODE_ALL;
    if (actor->load->settings.mode >= 0) {
        settings.mode = (enum pccd_mode)actor->load->settings.mode;
    }
    settings.deadline_ns = mischief == LOAD_DUE ? 1 : 0;
    settings.hold = shares(actor);
    return settings;
}

/* By position, so that what a lone client was answered there is the truth. */
static bool asks_near(const struct load_actor *actor, uint32_t from)
{
    return actor->load->settings.near && actor->kind != LOAD_SHARE &&
           actor->kind != LOAD_BATCH && from % 2 == 1;
}

/* A question has one answer at a position, too. */
static struct pccd_near_settings near_settings_of(const struct load_pending *pending)
{
    static const enum pccd_near_what whats[] = {PCCD_NEAR_VERTICES, PCCD_NEAR_NEAREST,
                                                PCCD_NEAR_CROSSINGS, PCCD_NEAR_VERTICES};
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = whats[pending->from / 2 % 4];
    settings.distance = NEAR_DISTANCE;
    settings.deadline_ns = pending->mischief == LOAD_DUE ? 1 : 0;
    return settings;
}

static int commit(const struct load_actor *actor, struct pccd_frame *frame,
                  struct load_pending *pending)
{
    if (pending->is_near) {
        const struct pccd_near_settings near = near_settings_of(pending);
        return pccd_frame_commit_near(frame, &near, &pending->step);
    }
    const struct pccd_step_settings settings = settings_of(actor, pending->mischief);
    return pccd_frame_commit(frame, &settings, &pending->step);
}

/* Write and commit it: a frame, or a batch. */
static int ask(struct load_actor *actor, struct load_pending *pending)
{
    struct pccd_frame frame;
    int status;
    if (is_flock(actor)) {
        const struct pccd_step_settings settings = settings_of(actor, pending->mischief);
        status = load_flock_write(actor, pending);
        return status != 0 ? status
                           : pccd_batch_commit(actor->batch, &settings, &pending->step);
    }
    status = pccd_frame_begin(
        actor->client, actor->scene, 1,
        (uint64_t)SLOT_VERTEX_BYTES * load_sheet_vertices(&actor->shape), &frame);
    if (status != 0) {
        return status;
    }
    status = write_step(actor, &frame, pending);
    if (status != 0) {
        pccd_frame_abort(&frame);
        return status;
    }
    return commit(actor, &frame, pending);
}

/* The next request. PCCD_E_BUSY: later. */
static int submit(struct load_actor *actor)
{
    struct load_pending *pending = &actor->pending[actor->pending_count];
    *pending = (struct load_pending){.from = (uint32_t)(actor->next % LOAD_FRAMES),
                                     .mischief = mischief_of(actor),
                                     .due_ns = actor->pace.due_ns,
                                     .sent_ns = common_now_ns()};
    pending->is_near = asks_near(actor, pending->from);
    int status =
        shares(actor) ? load_couple_set(actor, pending->mischief != LOAD_MASKED) : 0;
    if (status != 0) {
        return status;
    }
    status = ask(actor, pending);
    if (status != 0) {
        return status;
    }
    actor->pending_count++;
    actor->next++;
    actor->last_step = pending->step;
    actor->tally->submitted += width_of(actor);
    if (shares(actor)) {
        return load_couple_step(actor);
    }
    return pending->mischief == LOAD_CANCELLED ? pccd_cancel(actor->client, pending->step)
                                               : 0;
}

/* Everything that has arrived. */
static int take(struct load_actor *actor, bool *moved)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status;
    if (shares(actor)) {
        return load_couple_take(actor, moved);
    }
    if (is_flock(actor)) {
        return load_flock_take(actor, moved);
    }
    while ((status = pccd_poll(actor->client, &answer)) == 0) {
        load_judge(actor, &answer);
        pccd_answer_release(actor->client, &answer);
        actor->is_blocked = false;
        *moved = true;
    }
    return status == PCCD_E_AGAIN ? 0 : status;
}

static bool must_churn(const struct load_actor *actor)
{
    return actor->kind == LOAD_CHURN && !actor->is_alone && actor->next > 0 &&
           actor->next % CHURN_EVERY == 0 && actor->changed != actor->next;
}

/* Until the next one is due, or the client stops. */
static void go_on(struct load_actor *actor)
{
    if (actor->is_alone) {
        return;
    }
    uint64_t now_ns = common_now_ns();
    uint64_t stall_ns = load_pace_stall_ns(&actor->pace, actor->load);
    load_pace_next(&actor->pace, actor->load, now_ns);
    if (stall_ns > 0) {
        actor->stall_until_ns = now_ns + stall_ns;
        actor->tally->stalled++;
    }
}

/* One frame is held at a time. */
static uint32_t depth_of(const struct load_actor *actor)
{
    return shares(actor) ? 1 : actor->load->settings.depth;
}

static int send(struct load_actor *actor, bool *moved)
{
    actor->is_blocked = false;
    while (actor->pending_count < depth_of(actor)) {
        uint64_t now_ns = common_now_ns();
        if (must_churn(actor)) {
            actor->is_blocked = actor->pending_count > 0;
            if (actor->is_blocked) {
                return 0;
            }
            actor->changed = actor->next;
            int status = churn(actor);
            if (status != 0) {
                return status;
            }
        }
        if (now_ns < actor->stall_until_ns ||
            (!actor->is_alone && now_ns < actor->pace.due_ns)) {
            return 0;
        }
        int status = submit(actor);
        if (status != 0) {
            actor->is_blocked = status == PCCD_E_BUSY;
            return status == PCCD_E_BUSY ? 0 : status;
        }
        *moved = true;
        go_on(actor);
    }
    return 0;
}

bool load_actor_turn(struct load_actor *actor, bool more, bool readable)
{
    bool moved = false;
    if (common_now_ns() < actor->stall_until_ns) {
        return false;
    }
    int status = more ? send(actor, &moved) : 0;
    bool takes = (readable || moved) && common_now_ns() >= actor->stall_until_ns;
    status = status == 0 && takes ? take(actor, &moved) : status;
    if (status != 0) {
        break_off(actor, "a call failed");
        return true;
    }
    if (moved || actor->pending_count == 0) {
        actor->moved_ns = common_now_ns();
    }
    return moved;
}

uint64_t load_actor_wake_ns(const struct load_actor *actor, bool more)
{
    if (actor->stall_until_ns > common_now_ns()) {
        return actor->stall_until_ns;
    }
    bool can_submit =
        more && !actor->is_blocked && actor->pending_count < depth_of(actor);
    return can_submit ? actor->pace.due_ns : UINT64_MAX;
}

void load_actor_check(struct load_actor *actor, uint64_t now_ns)
{
    if (actor->pending_count > 0 && now_ns > actor->moved_ns &&
        now_ns - actor->moved_ns > STALL_NS) {
        break_off(actor, "no answer came");
    }
}

void load_actor_fds(const struct load_actor *actor, struct pollfd fds[2])
{
    fds[0] = (struct pollfd){.fd = pccd_fd(actor->client), .events = POLLIN};
    fds[1] = (struct pollfd){.fd = actor->second ? pccd_fd(actor->second) : -1,
                             .events = POLLIN};
}
