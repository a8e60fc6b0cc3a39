/* actor.c - one client of a run.
 *
 * Room:     client/load.
 * Does:     the life of a connection, and turns. See actor.h.
 * Does not: judge answers (judge.c).
 * Threads:  actor.h.
 */
#include "actor.h"

#include <math.h>
#include <string.h>

#include "judge.h"

#define SLOT_BYTES   8192u        /* the largest step takes some 1300 */
#define RESULT_BYTES (256u << 10) /* the answers to LOAD_DEPTH_MAX steps take less */

/* A step without an answer for so long is lost. */
#define STALL_NS 120000000000ull

/* For a machine that is busy with other things, too. */
#define PATIENCE_MS 60000

/* Requests between two changes of a client that churns. */
#define CHURN_EVERY 64u

_Static_assert(CHURN_EVERY % LOAD_FRAMES == 0, "a change begins a round");

static void complain(const struct load_actor *actor, const char *what)
{
    load_say("client %u: %s: %s", actor->number, what, pccd_error_text(actor->client));
}

/* ---- what it registers ------------------------------------------------------------- */

static int add_sheet(struct load_actor *actor, bool replace)
{
    float x[LOAD_SHEET_VERTICES][3];
    uint32_t triangles[LOAD_SHEET_TRIANGLES][3];
    load_sheet_f32(actor->load->settings.seed, actor->number, 0, x);
    load_sheet(triangles);
    if (replace) {
        return pccd_mesh_replace(
            actor->client, actor->sheet_mesh, x, PCCD_FORMAT_F32, LOAD_SHEET_VERTICES,
            (const uint32_t(*)[3])(const void *)triangles, LOAD_SHEET_TRIANGLES, NULL);
    }
    int rc = pccd_mesh_create(actor->client, x, PCCD_FORMAT_F32, LOAD_SHEET_VERTICES,
                              (const uint32_t(*)[3])(const void *)triangles,
                              LOAD_SHEET_TRIANGLES, &actor->sheet_mesh, NULL);
    return rc != 0 ? rc
                   : pccd_scene_add(actor->client, actor->scene, actor->sheet_mesh,
                                    &actor->sheet);
}

static int add_floor(struct load_actor *actor)
{
    float x[LOAD_FLOOR_VERTICES][3];
    uint32_t triangles[LOAD_FLOOR_TRIANGLES][3];
    load_floor(x, triangles);
    int rc = pccd_mesh_create(actor->client, x, PCCD_FORMAT_F32, LOAD_FLOOR_VERTICES,
                              (const uint32_t(*)[3])(const void *)triangles,
                              LOAD_FLOOR_TRIANGLES, &actor->floor_mesh, NULL);
    return rc != 0 ? rc
                   : pccd_scene_add(actor->client, actor->scene, actor->floor_mesh,
                                    &actor->floor);
}

static int add_all(struct load_actor *actor)
{
    int rc = pccd_scene_create(actor->client, NULL, &actor->scene);
    rc = rc == 0 && actor->sheet_first ? add_sheet(actor, false) : rc;
    rc = rc == 0 ? add_floor(actor) : rc;
    return rc == 0 && !actor->sheet_first ? add_sheet(actor, false) : rc;
}

static int drop_all(struct load_actor *actor)
{
    int rc = pccd_scene_destroy(actor->client, actor->scene);
    rc = rc == 0 ? pccd_mesh_destroy(actor->client, actor->floor_mesh) : rc;
    return rc == 0 ? pccd_mesh_destroy(actor->client, actor->sheet_mesh) : rc;
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
    options.slot_bytes = SLOT_BYTES;
    options.result_bytes = RESULT_BYTES;
    options.spin_us = 0; /* there are more clients than processors */
    options.reconnect_ms = PATIENCE_MS;
    options.daemons_max = -1; /* they are killed by chance, not by what is asked */
    options.timeout_ms = PATIENCE_MS;
    int rc = pccd_connect(&options, &actor->client);
    if (rc == 0) {
        actor->tally->opened++;
        rc = add_all(actor);
    }
    if (rc != 0 && loud) {
        complain(actor, "cannot begin");
    }
    actor->moved_ns = load_now_ns();
    return rc;
}

int load_actor_open(struct load_actor *actor, const struct load *load, uint32_t number,
                    struct load_tally *tally, bool sheet_first, bool loud)
{
    memset(actor, 0, sizeof *actor);
    actor->load = load;
    actor->tally = tally;
    actor->number = number;
    actor->sheet_first = sheet_first;
    actor->kind = (enum load_kind)(number % LOAD_KINDS);
    return connect_and_add(actor, loud);
}

void load_actor_close(struct load_actor *actor)
{
    actor->tally->lost += actor->pending_count;
    actor->pending_count = 0;
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
    int rc = 0;
    actor->tally->remade++;
    switch (load_mix(actor->number, actor->next) % 4) {
    case 0:
        return add_sheet(actor, true);
    case 1:
        rc = pccd_scene_remove(actor->client, actor->scene, actor->sheet);
        return rc != 0 ? rc
                       : pccd_scene_add(actor->client, actor->scene, actor->sheet_mesh,
                                        &actor->sheet);
    case 2:
        rc = drop_all(actor);
        return rc != 0 ? rc : add_all(actor);
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
    return actor->kind == LOAD_JUMP && !actor->is_alone && luck % 64 < 4 ? some[luck % 64]
                                                                         : LOAD_PLAIN;
}

static int write_jump(const struct load_actor *actor, struct pccd_frame *frame,
                      const struct load_pending *pending)
{
    uint64_t seed = actor->load->settings.seed;
    void *x0;
    void *x1;
    int rc = pccd_frame_x0x1(frame, actor->sheet, PCCD_FORMAT_F64, 0, LOAD_SHEET_VERTICES,
                             &x0, &x1);
    if (rc != 0) {
        return rc;
    }
    load_sheet_f64(seed, actor->number, pending->from, x0);
    load_sheet_f64(seed, actor->number, (pending->from + 1) % LOAD_FRAMES, x1);
    if (pending->mischief == LOAD_NOT_FINITE) {
        ((double *)x1)[7] = NAN;
    }
    return 0;
}

static int write_step(const struct load_actor *actor, struct pccd_frame *frame,
                      const struct load_pending *pending)
{
    uint64_t seed = actor->load->settings.seed;
    uint32_t to = (pending->from + 1) % LOAD_FRAMES;
    double m0[12];
    double m1[12];
    void *x1;
    if (actor->kind == LOAD_JUMP) {
        return write_jump(actor, frame, pending);
    }
    if (actor->kind == LOAD_RIGID) {
        load_sheet_pose(seed, actor->number, pending->from, m0);
        load_sheet_pose(seed, actor->number, to, m1);
        return pccd_frame_rigid(frame, actor->sheet, 0, LOAD_SHEET_VERTICES, m0, m1);
    }
    enum pccd_format format =
        actor->kind == LOAD_PAIRS ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32;
    int rc = pccd_frame_x1(frame, actor->sheet, format, 0, LOAD_SHEET_VERTICES, &x1);
    if (rc == 0 && format == PCCD_FORMAT_F64) {
        load_sheet_f64(seed, actor->number, to, x1);
    } else if (rc == 0) {
        load_sheet_f32(seed, actor->number, to, x1);
    }
    return rc;
}

static struct pccd_step_settings settings_of(const struct load_actor *actor,
                                             enum load_mischief mischief)
{
    struct pccd_step_settings settings = {0};
    settings.mode = actor->kind == LOAD_RIGID   ? PCCD_MODE_FIRST
                    : actor->kind == LOAD_PAIRS ? PCCD_MODE_PAIRS
                                                : PCCD_MODE_ALL;
    settings.deadline_ns = mischief == LOAD_DUE ? 1 : 0;
    return settings;
}

/* The next request. PCCD_E_BUSY: later. */
static int submit(struct load_actor *actor)
{
    struct load_pending *pending = &actor->pending[actor->pending_count];
    struct pccd_frame frame;
    *pending = (struct load_pending){.from = (uint32_t)(actor->next % LOAD_FRAMES),
                                     .mischief = mischief_of(actor),
                                     .sent_ns = load_now_ns()};
    struct pccd_step_settings settings = settings_of(actor, pending->mischief);
    int rc = pccd_frame_begin(actor->client, actor->scene, 1,
                              sizeof(double[2 * LOAD_SHEET_VERTICES][3]), &frame);
    if (rc != 0) {
        return rc;
    }
    rc = write_step(actor, &frame, pending);
    if (rc != 0) {
        pccd_frame_abort(&frame);
        return rc;
    }
    rc = pccd_frame_commit(&frame, &settings, &pending->step);
    if (rc != 0) {
        return rc;
    }
    actor->pending_count++;
    actor->next++;
    actor->last_step = pending->step;
    actor->tally->submitted++;
    return pending->mischief == LOAD_CANCELLED ? pccd_cancel(actor->client, pending->step)
                                               : 0;
}

/* Everything that has arrived. */
static int take(struct load_actor *actor, bool *moved)
{
    struct pccd_answer answer;
    int rc;
    while ((rc = pccd_poll(actor->client, &answer)) == 0) {
        load_judge(actor, &answer);
        pccd_answer_release(actor->client, &answer);
        *moved = true;
    }
    return rc == PCCD_E_AGAIN ? 0 : rc;
}

static bool must_churn(const struct load_actor *actor)
{
    return actor->kind == LOAD_CHURN && !actor->is_alone && actor->next > 0 &&
           actor->next % CHURN_EVERY == 0 && actor->changed != actor->next;
}

/* As an application does between its frames. */
static void think(struct load_actor *actor)
{
    uint64_t think_ns = (uint64_t)actor->load->settings.think_ms * 1000000u;
    if (think_ns > 0) {
        uint64_t luck = load_mix(actor->number, actor->next ^ actor->last_step << 32);
        actor->due_ns = load_now_ns() + think_ns / 2 + luck % think_ns;
    }
}

static int send(struct load_actor *actor, bool *moved)
{
    while (actor->pending_count < actor->load->settings.depth) {
        if (must_churn(actor)) {
            if (actor->pending_count > 0) {
                return 0;
            }
            actor->changed = actor->next;
            int rc = churn(actor);
            if (rc != 0) {
                return rc;
            }
        }
        if (load_now_ns() < actor->due_ns) {
            return 0;
        }
        int rc = submit(actor);
        if (rc != 0) {
            return rc == PCCD_E_BUSY ? 0 : rc;
        }
        *moved = true;
        think(actor);
    }
    return 0;
}

bool load_actor_turn(struct load_actor *actor, bool more)
{
    bool moved = false;
    int rc = more ? send(actor, &moved) : 0;
    rc = rc == 0 ? take(actor, &moved) : rc;
    uint64_t now_ns = load_now_ns();
    if (rc != 0) {
        break_off(actor, "a call failed");
        return true;
    }
    if (moved || actor->pending_count == 0) {
        actor->moved_ns = now_ns;
    } else if (now_ns - actor->moved_ns > STALL_NS) {
        break_off(actor, "no answer came");
        return true;
    }
    return moved;
}
