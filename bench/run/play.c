/* play.c - the steps of a scene, pass after pass. */
#include "play.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "report.h"

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

double run_separation(const struct run_side *side, const struct bench_frames *frames)
{
    return side->separation > 0 ? side->separation * bench_frames_median_edge(frames) : 0;
}

/* ---- how far it is, for who looks -------------------------------------------------- */

static void draw(const struct run_play *play, uint32_t pass, uint32_t done)
{
    static uint64_t drawn_ns;
    uint64_t now_ns = common_now_ns();
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

/* One side while a pass lasts. */
struct player {
    const struct run_side *side;
    const struct run_way *way;
    struct bench_frames *frames; /* of the first side of the same scene */
    struct bench_frames own;     /* of that one */
    struct run_asked *asked;     /* NULL between the steps of a side that is fresh */
};

static void player_open(struct player *player, const struct run_side *side)
{
    player->side = side;
    player->way = side->via == RUN_VIA_ENGINE ? &run_way_engine : &run_way_client;
    player->asked = side->is_fresh ? NULL : player->way->open(side, player->frames);
}

static void player_close(struct player *player, struct run_sequence *sequence)
{
    if (player->asked) {
        sequence->method = player->way->method(player->asked);
        sequence->cpu = player->way->cpu(player->asked);
        player->way->close(player->asked);
        player->asked = NULL;
    }
}

static bool player_step(struct player *player, struct run_sequence *sequence,
                        struct run_frame *frame)
{
    const struct bench_frames *frames = player->frames;
    if (!player->side->is_fresh) {
        return player->way->step(player->asked, frames, frame);
    }
    uint64_t begin_ns = common_now_ns();
    player->asked = player->way->open(player->side, frames);
    bool good = player->way->step(player->asked, frames, frame);
    player_close(player, sequence);
    frame->ns[RUN_WALL] = common_now_ns() - begin_ns;
    return good;
}

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

/* Until the next step is due, so many times a second; 0: it is now. */
static void await_tick(uint32_t hz)
{
    static uint64_t due_ns;
    uint64_t now_ns = common_now_ns();
    if (hz == 0) {
        return;
    }
    due_ns += 1000000000u / hz;
    due_ns = due_ns < now_ns ? now_ns : due_ns;
    struct timespec due = {(time_t)(due_ns / 1000000000u), (long)(due_ns % 1000000000u)};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
}

static void seek(const struct run_play *play, struct player *players, uint32_t number)
{
    for (uint32_t i = 0; i < play->settings->side_count; i++) {
        bench_frames_seek(players[i].frames, number);
    }
}

/* The same step by all sides, beginning with another one each time. */
static bool take_turns(struct run_play *play, struct player *players, uint32_t turn,
                       struct run_frame *taken)
{
    uint32_t sides = play->settings->side_count;
    bool good = true;
    for (uint32_t i = 0; i < sides; i++) {
        uint32_t which = (i + turn) % sides;
        memset(&taken[which], 0, sizeof taken[which]);
        await_tick(play->settings->hz);
        good = player_step(&players[which], &play->sides[which], &taken[which]) && good;
    }
    return good;
}

/* The first side of the same scene as side i. */
static uint32_t first_of(const struct run_play *play, uint32_t i)
{
    uint32_t first = 0;
    while (play->sides[first].source != play->sides[i].source) {
        first++;
    }
    return first;
}

/* The first side that must have the same answers as side i. */
static uint32_t first_like(const struct run_play *play, uint32_t i)
{
    const struct run_side *sides = play->settings->sides;
    uint32_t first = 0;
    while (sides[first].step.mode != sides[i].step.mode ||
           sides[first].separation != sides[i].separation ||
           sides[first].step.approach != sides[i].step.approach ||
           play->sides[first].source != play->sides[i].source) {
        first++;
    }
    return first;
}

/* Keep what all sides took of a step. Return false if an answer is not that of the first
 * side like it, or of the first pass. */
static bool keep_turns(struct run_play *play, uint32_t step, uint32_t pass,
                       const struct run_frame *taken)
{
    const struct run_settings *settings = play->settings;
    bool good = true;
    for (uint32_t i = 0; i < settings->side_count; i++) {
        struct run_sequence *sequence = &play->sides[i];
        good = bench_check(keep(&sequence->frames[step], &taken[i], pass),
                           play->source->name, "another pass has another answer") &&
               bench_check(memcmp(taken[i].hash, taken[first_like(play, i)].hash,
                                  sizeof taken[i].hash) == 0,
                           settings->sides[i].label, "another side has another answer") &&
               good;
        for (enum run_time t = 0; i > 0 && t < RUN_TIMES; t++) {
            if (taken[i].ns[t] > 0 && taken[0].ns[t] > 0) {
                bench_add(&sequence->speed[t],
                          (double)taken[0].ns[t] / (double)taken[i].ns[t]);
            }
        }
    }
    return good;
}

/* The steps before the first one that counts. Where a scene has not so many, the first
 * one again and again, each time from its start. */
static bool warm_up(struct run_play *play, struct player *players)
{
    const struct run_settings *settings = play->settings;
    struct run_frame unused[RUN_SIDES_MAX];
    bool good = true;
    for (uint32_t left = settings->warm_up; left > 0 && good; left--) {
        seek(play, players,
             settings->first >= left ? settings->first - left : settings->first);
        good = take_turns(play, players, 0, unused);
    }
    return good;
}

/* The next step is of other triangles, or there is none. */
static bool is_last_of_its_scene(const struct run_play *play, uint32_t number)
{
    const struct bench_scene *source = play->sides[0].source;
    return number == play->settings->last ||
           (source->before && number + 1 == source->break_frame);
}

static bool play_steps(struct run_play *play, struct player *players, uint32_t pass,
                       XXH3_state_t *state)
{
    const struct bench_frames *frames = players[0].frames;
    const char *name = play->source->name;
    struct run_frame taken[RUN_SIDES_MAX];
    bool good = bench_check(warm_up(play, players), name, "incomplete while warming up");
    for (uint32_t i = 0; i < play->count && good; i++) {
        uint32_t number = play->settings->first + i;
        draw(play, pass, i);
        seek(play, players, number);
        digest_frame(state, frames, 0);
        good =
            bench_check(take_turns(play, players, pass + i, taken), name, "incomplete");
        for (uint32_t s = 0; s < play->settings->side_count; s++) {
            taken[s].number = number;
        }
        good = good && keep_turns(play, i, pass, taken);
        if (is_last_of_its_scene(play, number)) {
            digest_frame(state, frames, 1);
            digest_triangles(state, frames->scene);
        }
    }
    return good;
}

static bool play_pass(struct run_play *play, uint32_t pass, XXH3_state_t *state)
{
    const struct run_settings *settings = play->settings;
    uint32_t before =
        settings->first < settings->warm_up ? settings->first : settings->warm_up;
    struct player players[RUN_SIDES_MAX];
    char input[sizeof play->input];
    XXH3_128bits_reset(state);
    for (uint32_t i = 0; i < settings->side_count; i++) {
        players[i].frames = &players[first_of(play, i)].own;
        if (players[i].frames == &players[i].own) {
            bench_frames_init(&players[i].own, play->sides[i].source,
                              settings->first - before);
        }
        player_open(&players[i], &settings->sides[i]);
    }
    bool good = play_steps(play, players, pass, state);
    digest_text(state, pass == 0 ? play->input : input);
    good = good && bench_check(pass == 0 || strcmp(play->input, input) == 0,
                               play->source->name, "frames differ when made again");
    for (uint32_t i = 0; i < settings->side_count; i++) {
        player_close(&players[i], &play->sides[i]);
        if (players[i].frames == &players[i].own) {
            bench_frames_deinit(&players[i].own);
        }
    }
    return good;
}

/* The scene of a side: as it is told, or the part that moves. */
static void make_source(struct run_play *play, uint32_t i)
{
    const struct run_settings *settings = play->settings;
    struct bench_moving moving = settings->sides[i].moving;
    uint32_t first = 0;
    while (settings->sides[first].moving.what != moving.what ||
           settings->sides[first].moving.share != moving.share) {
        first++;
    }
    if (first < i) {
        play->sides[i].source = play->sides[first].source;
    } else if (moving.what == BENCH_MOVING_TOLD) {
        play->sides[i].source = play->source;
    } else {
        bench_make_partial(&play->sides[i].partial, play->source, settings->first,
                           moving);
        play->sides[i].source = &play->sides[i].partial;
    }
}

bool run_play(struct run_play *play, const struct run_settings *settings,
              const struct bench_scene *source)
{
    XXH3_state_t *state = XXH3_createState();
    bool good = state != NULL;
    *play = (struct run_play){.settings = settings,
                              .source = source,
                              .count = settings->last - settings->first + 1};
    for (uint32_t i = 0; i < settings->side_count; i++) {
        play->sides[i].frames = bench_alloc(play->count, sizeof *play->sides[i].frames);
        make_source(play, i);
    }
    for (uint32_t pass = 0; pass < settings->repeat && good; pass++) {
        good = play_pass(play, pass, state);
    }
    if (good) {
        run_frames_hash(play->sides[0].frames, play->count, play->hash);
    }
    XXH3_freeState(state);
    wipe();
    return good;
}

void run_play_deinit(struct run_play *play)
{
    for (uint32_t i = 0; i < play->settings->side_count; i++) {
        free(play->sides[i].frames);
        if (play->sides[i].source == &play->sides[i].partial) {
            bench_scene_free(&play->sides[i].partial);
        }
        for (enum run_time t = 0; t < RUN_TIMES; t++) {
            bench_free(&play->sides[i].speed[t]);
        }
    }
    *play = (struct run_play){.settings = NULL};
}
