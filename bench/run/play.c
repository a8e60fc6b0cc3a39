/* bench/run/play.c - the steps of a scene, pass after pass.
 *
 * Room:     bench/run.
 * Does:     see play.h.
 * Threads:  one.
 */
#include "play.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "report.h"
#include "way.h"

#define REDRAW_NS 50000000u

uint64_t run_resident_bytes(uint32_t pid)
{
    char path[64];
    uint64_t total;
    uint64_t resident;
    (void)snprintf(path, sizeof path, "/proc/%" PRIu32 "/statm", pid);
    FILE *file = fopen(path, "r");
    if (!file) {
        return RUN_UNKNOWN;
    }
    int read = fscanf(file, "%" SCNu64 " %" SCNu64, &total, &resident);
    fclose(file);
    return read == 2 ? resident * (uint64_t)sysconf(_SC_PAGESIZE) : RUN_UNKNOWN;
}

/* ---- how far it is, for who looks -------------------------------------------------- */

static void draw(const struct run_play *play, uint32_t pass, uint32_t done)
{
    static uint64_t drawn_ns;
    uint64_t now_ns = bench_now_ns();
    if (!isatty(STDERR_FILENO) || (drawn_ns > 0 && now_ns - drawn_ns < REDRAW_NS)) {
        return;
    }
    drawn_ns = now_ns;
    fprintf(stderr,
            "\r\033[K%s: pass %" PRIu32 " of %" PRIu32 ", step %" PRIu32 " of %" PRIu32,
            play->source->name, pass + 1, play->settings->repeat, done, play->count);
}

static void wipe(void)
{
    if (isatty(STDERR_FILENO)) {
        fputs("\r\033[K", stderr);
    }
}

/* ---- the positions ----------------------------------------------------------------- */

static void digest_text(XXH3_state_t *state, char text[33])
{
    XXH128_hash_t hash = XXH3_128bits_digest(state);
    (void)snprintf(text, 33, "%016" PRIx64 "%016" PRIx64, (uint64_t)hash.high64,
                   (uint64_t)hash.low64);
}

static void digest_frame(XXH3_state_t *state, const struct bench_frames *frames, int end)
{
    XXH3_128bits_update(state, frames->x[end],
                        frames->scene->vertex_count * sizeof *frames->x[end]);
}

static void digest_triangles(XXH3_state_t *state, const struct bench_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct bench_object *object = &scene->objects[i];
        XXH3_128bits_update(state, object->triangles,
                            object->triangle_count * sizeof *object->triangles);
    }
}

/* ---- playing ----------------------------------------------------------------------- */

/* One of a step's passes; the first sets it. False: the answers differ. */
static bool keep(struct run_frame *kept, const struct run_frame *frame, uint32_t pass)
{
    if (pass == 0) {
        *kept = *frame;
        return true;
    }
    if (frame->ns[RUN_STEP] < kept->ns[RUN_STEP]) {
        memcpy(kept->ns, frame->ns, sizeof kept->ns);
    }
    return memcmp(kept->hash, frame->hash, sizeof kept->hash) == 0;
}

/* The steps before the first one that counts. Where a scene has not so many, the first
 * one again and again, each time from its start. */
static bool warm_up(const struct run_way *way, struct run_asked *asked,
                    struct bench_frames *frames, const struct run_settings *settings)
{
    struct run_frame unused;
    bool good = true;
    for (uint32_t left = settings->warm_up; left > 0 && good; left--) {
        bench_frames_seek(frames, settings->first >= left ? settings->first - left
                                                          : settings->first);
        good = way->step(asked, frames, &unused);
    }
    return good;
}

/* The next step is of other triangles, or there is none. */
static bool is_last_of_its_scene(const struct run_play *play, uint32_t number)
{
    const struct bench_scene *source = play->source;
    return number == play->settings->last ||
           (source->before && number + 1 == source->break_frame);
}

static bool play_steps(struct run_play *play, const struct run_way *way,
                       struct run_asked *asked, struct bench_frames *frames,
                       uint32_t pass, XXH3_state_t *state)
{
    const char *name = play->source->name;
    bool good = bench_check(warm_up(way, asked, frames, play->settings), name,
                            "incomplete while warming up");
    for (uint32_t i = 0; i < play->count && good; i++) {
        struct run_frame frame = {.number = play->settings->first + i};
        draw(play, pass, i);
        bench_frames_seek(frames, frame.number);
        digest_frame(state, frames, 0);
        good = bench_check(way->step(asked, frames, &frame), name, "incomplete") &&
               bench_check(keep(&play->frames[i], &frame, pass), name,
                           "another pass has another answer");
        if (is_last_of_its_scene(play, frame.number)) {
            digest_frame(state, frames, 1);
            digest_triangles(state, frames->scene);
        }
    }
    return good;
}

static bool play_pass(struct run_play *play, const struct run_way *way, uint32_t pass,
                      XXH3_state_t *state)
{
    const struct run_settings *settings = play->settings;
    uint32_t before =
        settings->first < settings->warm_up ? settings->first : settings->warm_up;
    struct bench_frames frames;
    char input[sizeof play->input];
    XXH3_128bits_reset(state);
    bench_frames_init(&frames, play->source, settings->first - before);
    struct run_asked *asked = way->open(settings, &frames);
    bool good = play_steps(play, way, asked, &frames, pass, state);
    digest_text(state, pass == 0 ? play->input : input);
    good = good && bench_check(pass == 0 || strcmp(play->input, input) == 0,
                               play->source->name, "frames differ when made again");
    play->method = way->method(asked);
    play->cpu = way->cpu(asked);
    way->close(asked);
    bench_frames_deinit(&frames);
    return good;
}

bool run_play(struct run_play *play, const struct run_settings *settings,
              const struct bench_scene *source)
{
    const struct run_way *way =
        settings->via == RUN_VIA_ENGINE ? &run_way_engine : &run_way_client;
    XXH3_state_t *state = XXH3_createState();
    bool good = state != NULL;
    *play = (struct run_play){.settings = settings,
                              .source = source,
                              .count = settings->last - settings->first + 1};
    play->frames = bench_alloc(play->count, sizeof *play->frames);
    for (uint32_t pass = 0; pass < settings->repeat && good; pass++) {
        good = play_pass(play, way, pass, state);
    }
    if (good) {
        run_frames_hash(play->frames, play->count, play->hash);
    }
    XXH3_freeState(state);
    wipe();
    return good;
}

void run_play_deinit(struct run_play *play)
{
    free(play->frames);
    *play = (struct run_play){.frames = NULL};
}
