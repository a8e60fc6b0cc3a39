/* two_processes.c - one scene, two processes: one moves the cloth, the other obstacles.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     the parent shares a scene of its private daemon with its child, whose floor
 *           rises through the parent's triangle. Each frame of the child is held until
 *           the parent steps, when a byte in a pipe says that one waits.
 * Threads:  one in each process.
 */
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pccd.h"

enum { FRAMES = 40 };

static const uint32_t triangle[1][3] = {{0, 1, 2}};

/* Take part in the scene with one triangle of this process. */
static int take_part(const struct pccd_options *options, const float x[3][3],
                     struct pccd_client **client, uint32_t *scene, uint32_t *object)
{
    const struct pccd_scene_settings shared = {.name = "stage", .share = PCCD_SHARE_OPEN};
    uint32_t mesh = 0;
    int status = pccd_connect(options, client);

    status = status ? status : pccd_scene_create(*client, &shared, scene);
    status = status ? status
                    : pccd_mesh_create(*client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh,
                                       NULL);
    return status ? status : pccd_scene_add(*client, *scene, mesh, object);
}

/* The floor at height z goes with the step of another; wait until the daemon has it. */
static int hold(struct pccd_client *client, uint32_t scene, uint32_t floor, float z,
                uint64_t *step)
{
    const float x1[3][3] = {{-9, -9, z}, {9, -9, z}, {0, 9, z}};
    const struct pccd_step_settings held = {.struct_bytes = sizeof held, .hold = true};
    struct pccd_frame frame;
    void *slot = NULL;
    int status = pccd_frame_begin(client, scene, 1, sizeof x1, &frame);
    status = status ? status : pccd_frame_x1(&frame, floor, PCCD_FORMAT_F32, 0, 3, &slot);
    if (status == 0) {
        memcpy(slot, x1, sizeof x1);
        status = pccd_frame_commit(&frame, &held, step);
    }
    return status ? status : pccd_wait_held(client, *step, -1);
}

/* The floor from height -1 to 1; a byte to `held` for each frame that waits. */
static int run_obstacles(const char *url, int held)
{
    const float x0[3][3] = {{-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
    struct pccd_client *client = NULL;
    struct pccd_options options;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    unsigned long long met = 0;
    uint32_t scene = 0, floor = 0;
    uint64_t step = 0;
    int status;

    pccd_options_init(&options);
    options.url = url;
    status = take_part(&options, x0, &client, &scene, &floor);
    for (int i = 1; status == 0 && i <= FRAMES; i++) {
        status = hold(client, scene, floor, -1 + 2 * (float)i / (float)FRAMES, &step);
        status = status == 0 && write(held, "h", 1) != 1 ? PCCD_E_SYSTEM : status;
        status = status ? status : pccd_wait(client, step, -1, &answer);
        met += status == 0 ? answer.counts[PCCD_VF] : 0;
    }
    printf("obstacles: %d frames, %llu vertices met %s\n", FRAMES, met,
           pccd_error_text(client));
    pccd_close(client);
    fflush(stdout);
    return status != 0 || met != 3;
}

int main(void)
{
    const float x[3][3] = {{0, 0, 0.01f}, {1, 0, 0.02f}, {0, 1, 0.04f}};
    struct pccd_client *client = NULL;
    struct pccd_options options;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    unsigned long long met = 0, steps = 0;
    uint32_t scene = 0, cloth = 0;
    int ended = 0, held[2] = {-1, -1}, status;
    pid_t child;
    char byte;

    pccd_options_init(&options);
    options.private_daemon = true;
    status = take_part(&options, x, &client, &scene, &cloth);
    if (status == 0 && strcmp(pccd_url(client), "direct:") == 0) {
        fprintf(stderr, "PCCD_URL=direct: has no daemon that two processes share\n");
        return 1;
    }
    child = status == 0 && pipe(held) == 0 ? fork() : -1;
    if (child == 0) { /* the parent's client is the parent's: the child makes its own */
        close(held[0]);
        _exit(run_obstacles(pccd_url(client), held[1]));
    }
    close(held[1]);
    while (status == 0 && read(held[0], &byte, 1) == 1) { /* until the child has gone */
        status = pccd_step_x1(client, scene, cloth, x, PCCD_FORMAT_F32, 3, NULL, &answer);
        if (status == 0) {
            met += answer.counts[PCCD_VF];
            steps++;
            pccd_answer_release(client, &answer);
        }
    }
    waitpid(child, &ended, 0);
    printf("cloth: %llu steps, %llu vertices met: %s %s\n", steps, met,
           status == 0 && met == 3 && ended == 0 ? "right" : "wrong",
           pccd_error_text(client));
    pccd_close(client);
    return status != 0 || met != 3 || steps != FRAMES || ended != 0;
}
