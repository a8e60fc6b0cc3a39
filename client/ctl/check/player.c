/* player.c - frames of a mesh, played in a daemon. */
#include "player.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "check_run.h"
#include "coordinates.h"
#include "terminal.h"

#define LOOK_MS 100 /* between looks at the clock and for an interrupt */

/* ---- reading ----------------------------------------------------------------------- */

static int read_frames(struct player *player, struct ctl_error *error)
{
    uint32_t count = player->files.count;
    bool is_double = false;
    struct progress progress;
    progress_begin(&progress, "frames", count);
    for (uint32_t i = 0; i < count; i++) {
        struct ctl_mesh *frame = &player->frames[i];
        int status = ctl_frames_read(&player->files, i, frame, error);
        if (status != PCCD_OK) {
            progress_clear(&progress);
            return status;
        }
        is_double = is_double || frame->format == PCCD_FORMAT_F64;
        progress_update(&progress, i + 1);
    }
    progress_clear(&progress);
    for (uint32_t i = 0; is_double && i < count; i++) {
        int status = ctl_mesh_promote(&player->frames[i], error);
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

int player_read(struct player *player, const struct player_settings *settings,
                struct ctl_error *error)
{
    player->settings = settings;
    int status = ctl_frames_open(&player->files, settings->files, settings->file_count,
                                 &settings->frames, error);
    ctl_sequence_warn(&player->files.sequence);
    if (status != PCCD_OK) {
        return status;
    }
    player->frames = calloc(player->files.count, sizeof *player->frames);
    player->still = calloc(settings->still_count + 1u, sizeof *player->still);
    player->times_ms = malloc(PLAYER_TIMES_MAX * sizeof *player->times_ms);
    if (player->frames == NULL || player->still == NULL || player->times_ms == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    status = read_frames(player, error);
    for (uint32_t i = 0; status == PCCD_OK && i < settings->still_count; i++) {
        struct ctl_welded welded;
        uint32_t frame_count;
        status = ctl_frames_read_one(settings->still[i], &settings->frames,
                                     &player->still[i], &welded, &frame_count, error);
        if (status == PCCD_OK && frame_count > 1) {
            status = ctl_error_set(error, PCCD_E_INVAL,
                                   "%s has %" PRIu32 " frames: what stands has one",
                                   settings->still[i], frame_count);
        }
    }
    return status;
}

/* ---- playing ----------------------------------------------------------------------- */

static int fail(const struct player *player, int status, const char *what,
                struct ctl_error *error)
{
    const char *text = pccd_error_text(player->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

static int place(struct player *player, const struct ctl_mesh *mesh, uint32_t *object,
                 struct ctl_error *error)
{
    uint32_t handle = 0;
    int status = check_run_put_mesh(player->client, mesh, &handle, NULL);
    if (status == PCCD_OK) {
        status = pccd_scene_add(player->client, player->scene, handle, object);
    }
    player->triangles += mesh->triangles.count;
    return status == PCCD_OK ? PCCD_OK
                             : fail(player, status, "a mesh was not accepted", error);
}

static int place_all(struct player *player, struct ctl_error *error)
{
    uint32_t ignored = 0;
    const struct pccd_scene_settings shared = {.name = player->settings->scene,
                                               .share = PCCD_SHARE_OPEN};
    int status = pccd_scene_create(
        player->client, player->settings->scene != NULL ? &shared : NULL, &player->scene);
    if (status != PCCD_OK) {
        return fail(player, status, "no scene", error);
    }
    struct ctl_mesh first = player->files.mesh;
    first.x = player->frames[0].x;
    first.format = player->frames[0].format;
    status = place(player, &first, &player->object, error);
    for (uint32_t i = 0; status == PCCD_OK && i < player->settings->still_count; i++) {
        status = place(player, &player->still[i], &ignored, error);
    }
    return status;
}

/* The frame at the end of step `step`, from 0: forwards, backwards, forwards ... */
static uint32_t frame_after(uint64_t step, uint32_t frame_count)
{
    if (frame_count < 2) {
        return 0;
    }
    uint64_t turn = step / (frame_count - 1), at = step % (frame_count - 1) + 1;
    return (uint32_t)(turn % 2 == 0 ? at : frame_count - 1 - at);
}

static int submit(struct player *player, const struct ctl_mesh *frame, uint64_t *step)
{
    const struct player_settings *settings = player->settings;
    const struct pccd_step_settings asked = {.struct_bytes =
                                                 sizeof(struct pccd_step_settings),
                                             .threads = settings->threads,
                                             .hold = settings->holds};
    size_t bytes = (size_t)frame->vertex_count * common_vertex_bytes(frame->format);
    struct pccd_frame out;
    void *x1 = NULL;
    int status = pccd_frame_begin(player->client, player->scene, 1, bytes, &out);
    if (status != PCCD_OK) {
        return status;
    }
    status =
        pccd_frame_x1(&out, player->object, frame->format, 0, frame->vertex_count, &x1);
    if (status != PCCD_OK) {
        pccd_frame_abort(&out);
        return status;
    }
    memcpy(x1, frame->x, bytes);
    return pccd_frame_commit(&out, &asked, step);
}

static bool is_over(const struct player *player)
{
    const struct player_settings *settings = player->settings;
    return terminal_was_interrupted() ||
           (settings->seconds > 0 &&
            terminal_now_s() - player->begin_s >= settings->seconds);
}

/* A frame that is held is answered when somebody else steps, which may be never. Returns
 * PCCD_E_TIMEOUT when it is over before that. */
static int await(struct player *player, uint64_t step, struct pccd_answer *answer)
{
    if (!player->settings->holds) {
        return pccd_wait(player->client, step, -1, answer);
    }
    int status = PCCD_E_TIMEOUT;
    while (status == PCCD_E_TIMEOUT && !is_over(player)) {
        status = pccd_wait(player->client, step, LOOK_MS, answer);
    }
    return status;
}

static int play_step(struct player *player, struct ctl_error *error)
{
    const struct player_settings *settings = player->settings;
    const struct ctl_mesh *frame =
        &player->frames[frame_after(player->steps, player->files.count)];
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    double begin_s = terminal_now_s();
    int status = submit(player, frame, &step);
    status = status == PCCD_OK ? await(player, step, &answer) : status;
    if (status == PCCD_E_TIMEOUT && settings->holds) {
        return PCCD_OK;
    }
    if (status != PCCD_OK) {
        return fail(player, status, "a step failed", error);
    }
    if (player->kept < PLAYER_TIMES_MAX) {
        player->times_ms[player->kept++] = (terminal_now_s() - begin_s) * 1e3;
    }
    player->steps++;
    player->contacts += answer.total;
    player->incomplete += answer.incomplete != PCCD_COMPLETE;
    pccd_answer_release(player->client, &answer);
    return PCCD_OK;
}

int player_play(struct player *player, struct ctl_error *error)
{
    const struct player_settings *settings = player->settings;
    uint64_t turn = player->files.count > 1 ? player->files.count - 1 : 1;
    uint64_t wanted = settings->seconds > 0 ? 0 : turn * settings->times;
    struct progress progress;
    int status = place_all(player, error);
    player->begin_s = terminal_now_s();
    progress_begin(&progress, wanted > 0 ? "steps" : "playing (ms)",
                   wanted > 0 ? wanted : (uint64_t)(settings->seconds * 1e3));
    while (status == PCCD_OK && !is_over(player) &&
           (wanted == 0 || player->steps < wanted)) {
        if (settings->hz > 0) {
            double due_s = player->begin_s + (double)player->steps / settings->hz;
            double left_s = due_s - terminal_now_s();
            if (left_s > 0) {
                terminal_sleep(left_s);
            }
            /* Late is who begins when the next one should. */
            player->late += left_s < -1.0 / settings->hz;
        }
        status = play_step(player, error);
        progress_update(&progress,
                        wanted > 0
                            ? player->steps
                            : (uint64_t)((terminal_now_s() - player->begin_s) * 1e3));
    }
    progress_clear(&progress);
    player->seconds = terminal_now_s() - player->begin_s;
    return status;
}

void player_deinit(struct player *player)
{
    const struct player_settings *settings = player->settings;
    for (uint32_t i = 0; player->frames != NULL && i < player->files.count; i++) {
        ctl_mesh_deinit(&player->frames[i]);
    }
    for (uint32_t i = 0; player->still != NULL && i < settings->still_count; i++) {
        ctl_mesh_deinit(&player->still[i]);
    }
    free(player->frames);
    free(player->still);
    free(player->times_ms);
    ctl_frames_close(&player->files);
}
