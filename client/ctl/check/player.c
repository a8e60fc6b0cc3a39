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

/* Read the frames of one object. */
static int read_frames(struct player *player, struct scene *files, uint32_t object,
                       struct progress *progress, struct ctl_error *error)
{
    struct ctl_mesh *frames = &player->frames[(size_t)object * files->count];
    bool is_double = false;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < files->count && status == PCCD_OK; i++) {
        status = scene_read_object(files, &files->objects[object], i, &frames[i], error);
        is_double = is_double || frames[i].format == PCCD_FORMAT_F64;
        progress_update(progress, (uint64_t)object * files->count + i + 1);
    }
    for (uint32_t i = 0; is_double && i < files->count && status == PCCD_OK; i++) {
        status = ctl_mesh_promote(&frames[i], error);
    }
    return status;
}

int player_read(struct player *player, struct scene *files,
                const struct player_settings *settings, struct ctl_error *error)
{
    struct progress progress;
    player->settings = settings;
    player->files = files;
    player->frames =
        calloc((size_t)files->object_count * files->count, sizeof *player->frames);
    player->motions = calloc(files->object_count, sizeof *player->motions);
    player->times_ms = malloc(PLAYER_TIMES_MAX * sizeof *player->times_ms);
    if (player->frames == NULL || player->motions == NULL || player->times_ms == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    int status = scene_read(files, 0, error);
    progress_begin(&progress, "frames", (uint64_t)files->object_count * files->count);
    for (uint32_t i = 0; i < files->object_count && status == PCCD_OK; i++) {
        /* Where nothing moves, all do, to where they are. */
        if (files->objects[i].files.count > 1 || files->count == 1) {
            status = read_frames(player, files, i, &progress, error);
        }
    }
    progress_clear(&progress);
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

static int place_all(struct player *player, struct scene *files, struct ctl_error *error)
{
    const struct pccd_scene_settings shared = {.name = player->settings->scene,
                                               .share = PCCD_SHARE_OPEN};
    int status = pccd_scene_create(
        player->client, player->settings->scene != NULL ? &shared : NULL, &player->scene);
    if (status != PCCD_OK) {
        return fail(player, status, "no scene", error);
    }
    for (uint32_t i = 0; i < files->object_count; i++) {
        player->triangles += files->objects[i].files.mesh.triangles.count;
    }
    return scene_place(files, player->client, player->scene, false, error);
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

/* Move all to a frame, from where they are. */
static int submit(struct player *player, uint32_t frame, uint64_t *step)
{
    const struct player_settings *settings = player->settings;
    const struct scene *files = player->files;
    const struct pccd_step_settings asked = {.struct_bytes =
                                                 sizeof(struct pccd_step_settings),
                                             .threads = settings->threads,
                                             .hold = settings->holds,
                                             .tells_start = settings->tells_start};
    uint32_t count = 0;
    for (uint32_t i = 0; i < files->object_count; i++) {
        const struct ctl_mesh *mesh = &player->frames[(size_t)i * files->count + frame];
        if (mesh->x != NULL) {
            player->motions[count++] =
                (struct pccd_motion){.object = files->objects[i].handle,
                                     .count = mesh->vertex_count,
                                     .format = mesh->format,
                                     .x1 = mesh->x};
        }
    }
    return count == 0 ? pccd_submit_still(player->client, player->scene, &asked, step)
                      : pccd_submit(player->client, player->scene, player->motions, count,
                                    &asked, step);
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
    uint32_t frame = frame_after(player->steps, player->files->count);
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
    uint64_t turn = player->files->count > 1 ? player->files->count - 1 : 1;
    uint64_t wanted = settings->seconds > 0 ? 0 : turn * settings->times;
    struct progress progress;
    int status = place_all(player, player->files, error);
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
    size_t count = player->frames == NULL
                       ? 0
                       : (size_t)player->files->object_count * player->files->count;
    for (size_t i = 0; i < count; i++) {
        ctl_mesh_deinit(&player->frames[i]);
    }
    free(player->frames);
    free(player->motions);
    free(player->times_ms);
}
