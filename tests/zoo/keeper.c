/* keeper.c - an honest client that is measured, and the daemon it looks after. */
#include "keeper.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crossing.h"

#define SIDE      40u /* 3042 triangles: a step takes a millisecond or less */
#define WARM_UP   20u
#define AWAIT_MS  10000
#define FDS_MAX   100000
#define ANSWER_MS 60000

/* One step. Returns its time, 0 when the answer is not right; `keep` NULL: compare. */
static uint64_t step(struct zoo_keeper *keeper, struct pccd_contact **keep)
{
    struct test_grid *grid = &keeper->grid;
    uint64_t begin_us = test_now_us();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t number = 0;
    uint64_t end_us;
    int way = grid->z > 0 ? 0 : 1;
    bool right;

    if (test_grid_submit(grid, NULL, &number) != 0 ||
        pccd_wait(grid->client, number, ANSWER_MS, &answer) != 0) {
        fprintf(stderr, "# keeper: %s\n", pccd_error_text(grid->client));
        return 0;
    }
    end_us = test_now_us();
    right = test_grid_is_right(grid, &answer);
    if (right && keep != NULL) {
        keeper->count = answer.count;
        keep[way] = realloc(keep[way], answer.count * sizeof(**keep));
        memcpy(keep[way], answer.contacts, answer.count * sizeof(**keep));
    } else if (right) {
        right = answer.count == keeper->count &&
                memcmp(answer.contacts, keeper->alone[way],
                       answer.count * sizeof *keeper->alone[way]) == 0;
    }
    pccd_answer_release(grid->client, &answer);
    if (!right) {
        fprintf(stderr, "# keeper: an answer is not what it was alone\n");
    }
    return !right ? 0 : end_us > begin_us ? end_us - begin_us : 1;
}

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;

    return (x > y) - (x < y);
}

bool zoo_keeper_work(struct zoo_keeper *keeper, uint32_t requests,
                     struct zoo_times *times)
{
    for (uint32_t i = 0; i < requests; i++) {
        keeper->taken_us[i] = step(keeper, NULL);
        if (keeper->taken_us[i] == 0) {
            return false;
        }
    }
    qsort(keeper->taken_us, requests, sizeof *keeper->taken_us, by_value);
    *times = (struct zoo_times){
        .p50_ms = (double)keeper->taken_us[requests / 2] / 1000,
        .p99_ms = (double)keeper->taken_us[requests - 1 - requests / 100] / 1000,
        .most_ms = (double)keeper->taken_us[requests - 1] / 1000};
    return true;
}

bool zoo_keeper_start(struct zoo_keeper *keeper, uint32_t requests_max)
{
    /* What the answers of a stack of triangles take is not the point. */
    static const char *const options[] = {"--contacts-max", "1000000", "--scenes-max",
                                          "64", NULL};

    memset(keeper, 0, sizeof *keeper);
    keeper->taken_us = calloc(requests_max, sizeof *keeper->taken_us);
    if (keeper->taken_us == NULL || !test_daemon_start(&keeper->daemon, options)) {
        return false;
    }
    struct pccd_client *client = test_connect(keeper->daemon.url);
    if (client == NULL || test_grid_make(client, SIDE, &keeper->grid) != 0) {
        return false;
    }
    for (uint32_t i = 0; i < WARM_UP; i++) {
        if (step(keeper, keeper->alone) == 0) {
            return false;
        }
    }
    return true;
}

bool zoo_keeper_stop(struct zoo_keeper *keeper)
{
    pccd_close(keeper->grid.client);
    test_grid_free(&keeper->grid);
    free(keeper->alone[0]);
    free(keeper->alone[1]);
    free(keeper->taken_us);
    return test_daemon_finish(&keeper->daemon);
}

/* ---- what the daemon holds --------------------------------------------------------- */

static uint64_t anonymous_bytes(const struct zoo_keeper *keeper)
{
    char path[64];
    char line[256];
    unsigned long long kib = 0;
    FILE *file;

    (void)snprintf(path, sizeof path, "/proc/%ld/smaps_rollup", (long)keeper->daemon.pid);
    file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (sscanf(line, "Anonymous: %llu kB", &kib) == 1) {
            break;
        }
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return (uint64_t)kib << 10;
}

static int count_fds(const struct zoo_keeper *keeper)
{
    char path[64];
    DIR *entries;
    int count = 0;

    (void)snprintf(path, sizeof path, "/proc/%ld/fd", (long)keeper->daemon.pid);
    entries = opendir(path);
    while (entries != NULL && count < FDS_MAX && readdir(entries) != NULL) {
        count++;
    }
    if (entries != NULL) {
        (void)closedir(entries);
    }
    return count;
}

void zoo_keeper_look(struct zoo_keeper *keeper, struct zoo_held *held)
{
    struct pccd_client *client = keeper->grid.client;

    *held = (struct zoo_held){.sessions = test_stat(client, "sessions_now"),
                              .meshes = test_stat(client, "meshes_now"),
                              .scenes = test_stat(client, "scenes_now"),
                              .objects = test_stat(client, "objects_now"),
                              .shm_bytes = test_stat(client, "shm_bytes_now"),
                              .jobs = test_stat(client, "jobs_queued_now"),
                              .engine_bytes = test_stat(client, "engine_bytes_now"),
                              .heap_bytes = anonymous_bytes(keeper),
                              .fds = count_fds(keeper)};
}

bool zoo_keeper_await(struct zoo_keeper *keeper, const struct zoo_held *before)
{
    uint64_t until_ms = test_now_ms() + AWAIT_MS;
    struct zoo_held now;

    do {
        zoo_keeper_look(keeper, &now);
        if (now.sessions == before->sessions && now.meshes == before->meshes &&
            now.scenes == before->scenes && now.objects == before->objects &&
            now.shm_bytes <= before->shm_bytes && /* less: what was idle was given back */
            now.jobs == before->jobs && now.engine_bytes == before->engine_bytes &&
            now.fds <= before->fds) {
            return true;
        }
        test_sleep_ms(5);
    } while (test_now_ms() < until_ms);
    fprintf(stderr,
            "# left: %lld sessions, %lld meshes, %lld scenes, %lld objects, %lld bytes "
            "shared, %lld jobs, %lld bytes of the engine, %d descriptors\n",
            (long long)(now.sessions - before->sessions),
            (long long)(now.meshes - before->meshes),
            (long long)(now.scenes - before->scenes),
            (long long)(now.objects - before->objects),
            (long long)(now.shm_bytes - before->shm_bytes),
            (long long)(now.jobs - before->jobs),
            (long long)(now.engine_bytes - before->engine_bytes), now.fds - before->fds);
    return false;
}
