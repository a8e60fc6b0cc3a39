/* recorder_snapshot.c - how a segment of a recording begins.
 *
 * Room:     client/lib. May include: recorder.h, recorder_shared.h, attach.h,
 *           keep.h.
 * Does:     write what another daemon would have to be told, from what is kept for that.
 * Does not: follow events (recorder.c).
 * Threads:  [owner].
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "attach.h"
#include "keep.h"
#include "recorder.h"
#include "recorder_shared.h"

static int write_begin(struct pccd_client *client)
{
    const struct cli_recorder *recorder = client->recorder;
    struct record_begin begin = {
        .pid = (uint32_t)client->owner,
        .daemon_pid = client->pid,
        .segment = recorder->segment,
        .flags = RECORD_EXACT_PAIRS | (recorder->has_records ? RECORD_HAS_RECORDS : 0u)};
    struct timespec now;

    (void)clock_gettime(CLOCK_REALTIME, &now);
    begin.unix_ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
    (void)snprintf(begin.library, sizeof(begin.library), "%.15s", pccd_version());
    (void)snprintf(begin.cpu, sizeof(begin.cpu), "%.15s", client->cpu);
    return cli_record_add(client, RECORD_BEGIN,
                          &(struct record_part){&begin, sizeof(begin)}, 1);
}

static int write_scene(struct pccd_client *client, const struct cli_kept_scene *kept)
{
    struct record_scene scene = {.scene = kept->handle,
                                 .quality = kept->settings.quality,
                                 .rebuild_triangles_max =
                                     kept->settings.rebuild_triangles_max,
                                 .rebuild_ratio = kept->settings.rebuild_ratio};

    return cli_record_add(client, RECORD_SCENE,
                          &(struct record_part){&scene, sizeof(scene)}, 1);
}

static int write_meshes(struct pccd_client *client)
{
    for (const struct cli_kept_mesh *mesh = client->kept_meshes;
         mesh != NULL && !client->recorder->has_ended; mesh = mesh->next) {
        cli_record_mesh(client, mesh->handle, mesh->format, mesh->vertex_count, mesh->x,
                        mesh->triangle_count, mesh->triangles);
    }
    return client->recorder->info.status;
}

/* Meshes that are gone, but for the objects made of them. */
static int write_gone(struct pccd_client *client)
{
    int rc = 0;

    for (const struct cli_kept_mesh *mesh = client->kept_meshes; rc == 0 && mesh != NULL;
         mesh = mesh->next) {
        struct record_gone gone = {.mesh = mesh->handle};

        rc = mesh->is_destroyed
                 ? cli_record_add(client, RECORD_MESH_GONE,
                                  &(struct record_part){&gone, sizeof(gone)}, 1)
                 : 0;
    }
    return rc;
}

static int write_place(struct pccd_client *client, const struct cli_kept_scene *scene,
                       const struct cli_kept_object *kept)
{
    struct record_place place = {.scene = scene->handle, .object = kept->handle};
    struct record_part parts[2] = {{&place, sizeof(place)}};

    if (kept->placing == CLI_PLACED_REGISTERED) {
        return 0;
    }
    if (kept->placing == CLI_PLACED_RIGID) {
        place.placing = RECORD_PLACED_RIGID;
        place.format = PCCD_FORMAT_F64;
        parts[1] = (struct record_part){kept->m, sizeof(kept->m)};
    } else {
        place.placing = RECORD_PLACED_FREELY;
        place.format = kept->format;
        parts[1] = (struct record_part){
            kept->x,
            kept->mesh->vertex_count *
                (kept->format == PCCD_FORMAT_F64 ? sizeof(double[3]) : sizeof(float[3]))};
    }
    return cli_record_add(client, RECORD_PLACE, parts, 2);
}

static int write_filter(struct pccd_client *client, const struct cli_kept_scene *scene,
                        const struct cli_kept_object *kept)
{
    const struct record_filter filter = {.scene = scene->handle,
                                         .object = kept->handle,
                                         .what = kept->what,
                                         .self = kept->self,
                                         .group = kept->group,
                                         .mask = kept->mask};

    return kept->what == 0
               ? 0
               : cli_record_add(client, RECORD_FILTER,
                                &(struct record_part){&filter, sizeof(filter)}, 1);
}

static int write_object(struct pccd_client *client, const struct cli_kept_scene *scene,
                        const struct cli_kept_object *kept)
{
    const struct record_object object = {
        .scene = scene->handle, .mesh = kept->mesh->handle, .object = kept->handle};
    int rc = cli_record_add(client, RECORD_OBJECT,
                            &(struct record_part){&object, sizeof(object)}, 1);

    rc = rc != 0 ? rc : write_place(client, scene, kept);
    return rc != 0 ? rc : write_filter(client, scene, kept);
}

/* Those of its objects that ignore each other. */
static int write_pairs(struct pccd_client *client, struct cli_kept_scene *scene)
{
    struct record_pairs head = {.scene = scene->handle, .ignored = 1};
    struct record_part parts[2] = {{&head, sizeof(head)}};
    uint32_t(*pairs)[2];
    int rc;

    cli_kept_pairs_settle(&scene->ignored);
    if (scene->ignored.count == 0) {
        return 0;
    }
    head.count = scene->ignored.count;
    pairs = malloc(head.count * sizeof(*pairs));
    if (pairs == NULL) {
        return cli_record_stop_because(client, PCCD_E_NOMEM, "no memory for pairs");
    }
    for (uint32_t i = 0; i < head.count; i++) {
        pairs[i][0] = scene->ignored.said[i].a;
        pairs[i][1] = scene->ignored.said[i].b;
    }
    parts[1] = (struct record_part){pairs, head.count * sizeof(*pairs)};
    rc = cli_record_add(client, RECORD_PAIRS, parts, 2);
    free(pairs);
    return rc;
}

/* Its journal says what is in it. */
static bool is_shared(const struct cli_kept_scene *scene)
{
    return scene->settings.name[0] != '\0';
}

static int begin_journals(struct pccd_client *client)
{
    int rc = 0;

    for (const struct cli_kept_scene *scene = client->kept_scenes;
         rc == 0 && scene != NULL; scene = scene->next) {
        rc = is_shared(scene) ? cli_journal_begin(client, scene->handle) : 0;
    }
    return rc;
}

static int write_scenes(struct pccd_client *client)
{
    int rc = 0;

    for (struct cli_kept_scene *scene = client->kept_scenes; rc == 0 && scene != NULL;
         scene = scene->next) {
        rc = write_scene(client, scene);
        for (uint32_t i = 0; rc == 0 && !is_shared(scene) && i < scene->object_count;
             i++) {
            rc = write_object(client, scene, &scene->objects[i]);
        }
        rc = rc != 0 || is_shared(scene) ? rc : write_pairs(client, scene);
    }
    return rc;
}

/* Steps that are not in what is kept yet, in the order of their sending. */
static int write_unanswered(struct pccd_client *client)
{
    uint64_t after = 0;
    int rc = 0;

    for (;;) {
        const struct cli_call *next = NULL;

        for (uint32_t i = 0; i < client->calls_end; i++) {
            const struct cli_call *call = &client->calls[i];

            if ((call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST) &&
                call->method == PROTO_METHOD_FRAME_SUBMIT && !call->recovery &&
                call->serial > after && (next == NULL || call->serial < next->serial)) {
                next = call;
            }
        }
        if (next == NULL || rc != 0) {
            return rc;
        }
        after = next->serial;
        rc = cli_journal_has(client, next->params.FRAME_SUBMIT.scene)
                 ? 0
                 : cli_record_step(client, next);
    }
}

int cli_record_snapshot(struct pccd_client *client)
{
    struct record_log log = {.next_step = client->next_step};
    int rc = cli_keep_fold_all(client);

    client->recorder->is_beginning = true;
    rc = rc != 0 ? rc : write_begin(client);
    rc = rc != 0 ? rc : write_meshes(client);
    rc = rc != 0 ? rc : write_scenes(client);
    rc = rc != 0 ? rc : write_gone(client);
    rc = rc != 0 ? rc
                 : cli_record_add(client, RECORD_LOG,
                                  &(struct record_part){&log, sizeof(log)}, 1);
    client->recorder->is_beginning = false;
    rc = rc != 0 ? rc : begin_journals(client);
    return rc != 0 ? rc : write_unanswered(client);
}
