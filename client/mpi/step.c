/* step.c - a step of the whole scene.
 *
 * Let all ranks know what moves; choose ghosts where those at hand may not do; send
 * positions; let libpccd compute; put the answer together; look whether that is to end
 * early.
 */
#include "step.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "clock.h"
#include "cut.h"
#include "ghosts.h"
#include "mpi_hooks.h"
#include "names.h"
#include "near_objects.h"
#include "parts.h"
#include "rounding.h"

/* What all ranks know of an object's motion. */
enum {
    MOVES = 0,  /* rows of struct moment.bytes */
    STARTS = 1, /* some vertex begins elsewhere than it ended */
    MISSES = 2, /* some vertex is outside of the box that ghosts were chosen for */
    /* The same if the step for which ghosts are right once is made backwards; and both if
     * nothing moves in any rank, in a question of what is near. */
    BACK_MISSES = 3,
    STILL_MISSES = 4,
    STILL_BACK_MISSES = 5,
    ROWS = 6
};

static uint8_t *row(const struct pccd_mpi *world, const struct ranks_moment *moment,
                    int which)
{
    return moment->bytes + (size_t)which * world->object_count;
}

/* ---- settings --------------------------------------------------------------------- */

static int read_settings(struct pccd_mpi *world, const struct pccd_step_settings *asked,
                         struct pccd_step_settings *settings, uint64_t *hash)
{
    *settings = (struct pccd_step_settings)PCCD_STEP_SETTINGS_INIT;
    if (asked != NULL) {
        size_t bytes = asked->struct_bytes;
        bytes = bytes == 0 ? offsetof(struct pccd_step_settings, separation) : bytes;
        memcpy(settings, asked, bytes > sizeof *settings ? sizeof *settings : bytes);
    }
    settings->struct_bytes = sizeof *settings;
    *hash = ranks_hash(1, &settings->mode, sizeof settings->mode);
    *hash = ranks_hash(*hash, &settings->method, sizeof settings->method);
    *hash = ranks_hash(*hash, &settings->threads, sizeof settings->threads);
    *hash = ranks_hash(*hash, &settings->tolerance, sizeof settings->tolerance);
    *hash = ranks_hash(*hash, &settings->separation, sizeof settings->separation);
    *hash = ranks_hash(*hash, &settings->approach, sizeof settings->approach);
    *hash = ranks_hash(*hash, &settings->tells_start, sizeof settings->tells_start);
    *hash = ranks_hash(*hash, &settings->deadline_ns, sizeof settings->deadline_ns);
    if (settings->tuning != NULL) {
        *hash = ranks_hash(*hash, settings->tuning, strlen(settings->tuning));
    }
    if (settings->threads == 0) {
        settings->threads = world->threads;
    }
    if (settings->touching != PCCD_TOUCHING_KEPT) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "touching: a rank does not know all that is around a vertex");
    }
    if (settings->joint_count > 0 || settings->resolution != 0) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "joints, resolution: ranks share what goes straight alone");
    }
    if (settings->mode == PCCD_MODE_FIRST_PER_PAIR) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "mode first-per-pair: a rank does not know what the others "
                          "find of its objects; ask for mode all");
    }
    if (settings->hold || (unsigned)settings->mode >= PCCD_MODE_COUNT ||
        !(settings->separation >= 0)) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "a step with hold, an unknown mode or a negative separation");
    }
    return PCCD_OK;
}

/* ---- ghosts ----------------------------------------------------------------------- */

/* Look whether vertices leave their boxes between two ends, steps from where the scene
 * is. */
static void look_at_boxes(const struct pccd_mpi *world, struct ranks_moment *moment,
                          int which, double from, double to)
{
    if (world->link.size == 1 || !world->is_covered) {
        return;
    }
    if (world->is_once) { /* the scene is at an end of that step */
        double begin = from == to ? 1 : 0;
        ranks_ghosts_look(world, begin, 1, row(world, moment, which));
        ranks_ghosts_look(world, 1 - begin, 0, row(world, moment, which + 1));
    } else {
        ranks_ghosts_look(world, world->gone + from, world->gone + to,
                          row(world, moment, which));
    }
}

/* Note what this rank knows of each object. */
static void look(struct pccd_mpi *world, struct ranks_moment *moment)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        bool moves = object->to != (const double(*)[3])object->x;
        bool starts = object->from != (const double(*)[3])object->x;
        row(world, moment, MOVES)[o] = moves;
        row(world, moment, STARTS)[o] = starts;
    }
    look_at_boxes(world, moment, MISSES, 0, 1);
    uint8_t *of_all = moment->bytes + (size_t)ROWS * world->object_count;
    of_all[0] = moment->motion_count > 0;
    of_all[1] = (uint8_t)ranks_stop_reason(&world->stop);
}

/* At rest a step began where the last one did; else what no motion has stands still. */
static void begin_at(struct pccd_mpi *world, bool at_rest)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        if (at_rest) {
            object->from = object->begun;
        } else if (object->to == (const double(*)[3])object->x) {
            object->from = object->to;
        }
    }
}

static void forget_begins(struct pccd_mpi *world, const struct ranks_moment *moment)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        if (row(world, moment, MOVES)[o]) {
            world->objects[o]->begun = (const double(*)[3])world->objects[o]->x;
        }
    }
}

/* Nothing moves here: all stands where the last step ended, or began. */
static void look_still(struct pccd_mpi *world, struct ranks_moment *moment,
                       bool is_at_begin)
{
    if (is_at_begin) {
        begin_at(world, true);
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        row(world, moment, STARTS)[o] = object->from != (const double(*)[3])object->x;
    }
    look_at_boxes(world, moment, STILL_MISSES, is_at_begin ? -1 : 0, 0);
}

/* Each rank takes its motions, says of each object what it knows, and hears of all. */
static int take_motions(struct pccd_mpi *world, struct ranks_moment *moment)
{
    struct ranks_link *link = &world->link;
    size_t bytes = (size_t)ROWS * world->object_count;
    bool is_at_begin =
        moment->near != NULL &&
        common_near_reads_begin(moment->near->what, moment->near->at_begin ? 0 : 1);
    int status = ranks_motions_take(world, moment->motions, moment->motion_count);
    look(world, moment);
    if (moment->near != NULL && moment->motion_count == 0) {
        look_still(world, moment, is_at_begin);
    }
    status = ranks_agree_on(link, status);
    if (link->broken == PCCD_OK) {
        int heard = ranks_max_bytes(link, moment->bytes, (int)bytes + 2);
        status = status == PCCD_OK ? heard : status;
    }
    moment->is_still = moment->near != NULL && moment->bytes[bytes] == 0;
    moment->stopped = (enum pccd_incomplete)moment->bytes[bytes + 1];
    world->stop.is_set |= moment->stopped == PCCD_INCOMPLETE_CANCELLED;
    if (is_at_begin && !moment->is_still) {
        begin_at(world, false);
    }
    return status;
}

static bool has_misses(const struct pccd_mpi *world, const struct ranks_moment *moment)
{
    const int which = moment->is_still ? STILL_MISSES : MISSES;
    bool back_misses = !world->is_once;
    bool misses =
        world->link.size > 1 && !moment->is_still && world->gone >= world->lasts;
    for (uint32_t o = 0; o < world->object_count; o++) {
        misses = misses || row(world, moment, which)[o];
        back_misses = back_misses || row(world, moment, which + 1)[o];
    }
    return misses && back_misses;
}

static int choose_ghosts(struct pccd_mpi *world, struct ranks_moment *moment)
{
    bool is_of_pairs = moment->near == NULL && moment->settings.mode == PCCD_MODE_PAIRS;
    bool is_far = world->reach < moment->settings.separation ||
                  (is_of_pairs && !world->is_for_pairs);
    bool has_missed = world->is_covered && has_misses(world, moment);
    if (world->is_covered && !is_far && !has_missed) {
        return PCCD_OK;
    }
    world->is_for_pairs |= is_of_pairs; /* and later, as they will be asked for again */
    int status = ranks_ghosts_choose(world, moment->settings.separation, moment->is_still,
                                     has_missed);
    return status == PCCD_OK ? ranks_stop_agree(&world->stop, &moment->stopped) : status;
}

/* Give memory of a cut back: it is much, and would stay with the process. */
static void give_back(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

/* ---- computing -------------------------------------------------------------------- */

static struct ranks_sending sending_of(const struct pccd_mpi *world,
                                       const struct ranks_moment *moment)
{
    return (struct ranks_sending){.moves = row(world, moment, MOVES),
                                  .starts = row(world, moment, STARTS),
                                  .given = moment->given,
                                  .local = moment->local,
                                  .is_question = moment->near != NULL};
}

/* All pages of libpccd's answer. */
static int take_pages(struct pccd_mpi *world, struct pccd_answer *answer)
{
    struct pccd_answer page = *answer;
    if (ranks_records_hold(world, &page)) {
        return PCCD_OK;
    }
    for (;;) {
        uint64_t cursor = page.cursor;
        bool is_last =
            page.incomplete == PCCD_INCOMPLETE_CANCELLED || cursor >= answer->total;
        int status = ranks_records_take(world, &page);
        pccd_answer_release(world->client, &page);
        if (status != PCCD_OK || is_last) {
            answer->incomplete = page.incomplete == PCCD_INCOMPLETE_RESULT_FULL
                                     ? PCCD_COMPLETE
                                     : page.incomplete;
            return status;
        }
        status = pccd_fetch(world->client, world->scene, answer->step, cursor, &page);
        if (status != PCCD_OK) {
            return ranks_local_status(world, status, "a page of records did not come");
        }
    }
}

static int commit(struct pccd_mpi *world, const struct ranks_moment *moment,
                  struct pccd_frame *frame, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = PCCD_OK;
    if (moment->near != NULL) {
        struct pccd_near_settings all = *moment->near;
        all.object_a = all.object_b = 0; /* bounds are of all that is near */
        all.deadline_ns = ranks_stop_rest(&world->stop);
        if (frame->segment_count == 0) {
            all.at_begin = false; /* here both are where it stands; libpccd thinks of
                                     its last step */
        }
        status = pccd_frame_commit_near(frame, &all, &step);
        if (status == PCCD_OK) {
            status = pccd_wait(world->client, step, -1, answer);
        }
    } else {
        struct pccd_step_settings settings = moment->settings;
        settings.deadline_ns = ranks_stop_rest(&world->stop);
        const struct ranks_sending sending = sending_of(world, moment);
        status = ranks_sending_commit(world, &sending, frame, &settings, answer);
    }
    answer->number -= world->weighings;
    return ranks_local_status(world, status, "the step failed");
}

static int compute(struct pccd_mpi *world, const struct ranks_moment *moment,
                   struct pccd_frame *frame, struct pccd_answer *answer)
{
    int status = commit(world, moment, frame, answer);
    if (status != PCCD_OK) {
        return status;
    }
    /* Others go on where how the step begins is told of all of them. */
    if (answer->verdict == PCCD_VERDICT_YES && moment->near == NULL &&
        !moment->settings.tells_start) {
        ranks_stop_say(&world->stop);
    }
    return take_pages(world, answer);
}

/* The step was made: what moved is there now. is_known: libpccd has it there, too. */
static void move_on(struct pccd_mpi *world, const struct ranks_moment *moment,
                    bool is_known)
{
    if (!moment->is_still || world->gone == 0) { /* boxes were made for its end */
        world->gone++;
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        bool starts = object->from != (const double(*)[3])object->x;
        if (object->to == (const double(*)[3])object->next) {
            double(*before)[3] = object->x;
            object->x = object->next;
            object->next = before;
            object->begun = (const double(*)[3])(starts ? object->start : before);
        } else if (!moment->is_still) {
            object->begun = (const double(*)[3])object->x;
        }
        object->is_elsewhere = !is_known && (object->is_elsewhere || !moment->is_still);
    }
}

/* libpccd's meshes would only lie there while the leaves travel: ghosts are chosen anew
 * then, and it gets others. */
static int cut_leaves(struct pccd_mpi *world, struct ranks_moment *moment)
{
    int status = PCCD_OK;
    cli_mpi_expect(world->client, world->scene,
                   world->found / (uint64_t)world->link.size);
    world->is_covered = false;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        if (object->is_built) {
            object->is_built = false;
            status = ranks_local_put_nothing(world, &object->local_mesh);
        }
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_cut(world);
    }
    return status == PCCD_OK ? ranks_stop_agree(&world->stop, &moment->stopped) : status;
}

/* libpccd makes the step of what was sent, and counts the pairs of each leaf. */
static int count_pairs(struct pccd_mpi *world, const struct ranks_moment *moment,
                       const struct ranks_sending *sending, struct pccd_frame *frame,
                       struct pccd_answer *answer)
{
    struct pccd_step_settings settings = moment->settings;
    settings.mode = PCCD_MODE_ALL;
    settings.deadline_ns = ranks_stop_rest(&world->stop);
    world->weighings++;
    int status = ranks_sending_commit(world, sending, frame, &settings, answer);
    ranks_pairs_count_end(world);
    if (status != PCCD_OK) {
        return ranks_local_status(world, status, "the leaves were not weighed");
    }
    pccd_answer_release(world->client, answer);
    return PCCD_OK;
}

/* Collective: what own leaves weigh in this step. Ghosts for it are there. */
static int weigh(struct pccd_mpi *world, struct ranks_moment *moment, bool *is_uneven)
{
    struct ranks_sending sending = sending_of(world, moment);
    struct pccd_frame frame;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    sending.is_question = false;
    int status = ranks_ghosts_build(world);
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, ranks_pairs_count_begin(world));
    }
    if (status == PCCD_OK) {
        status = ranks_sending_make(world, &sending, &frame);
    }
    if (status != PCCD_OK) {
        ranks_pairs_count_end(world);
        return status;
    }
    ranks_stop_open(&world->stop);
    status = ranks_agree_on(&world->link,
                            count_pairs(world, moment, &sending, &frame, &answer));
    ranks_stop_close(&world->stop);
    for (uint32_t o = 0; o < world->object_count; o++) {
        world->objects[o]->is_elsewhere = true;
        moment->local[o] = NULL;
    }
    if (status == PCCD_OK) {
        status = ranks_leaves_weigh(world, &answer.counters, is_uneven);
    }
    return status == PCCD_OK ? ranks_stop_agree(&world->stop, &moment->stopped) : status;
}

/* Cut by the work of each leaf in this step, if that is uneven, or always; *is_cut: it
 * was. */
static int cut_by_work(struct pccd_mpi *world, struct ranks_moment *moment, bool always,
                       bool *is_cut)
{
    bool is_uneven = false;
    int status = choose_ghosts(world, moment);
    if (status == PCCD_OK && moment->stopped == PCCD_COMPLETE) {
        status = weigh(world, moment, &is_uneven);
    }
    *is_cut =
        status == PCCD_OK && moment->stopped == PCCD_COMPLETE && (always || is_uneven);
    if (*is_cut) {
        status = cut_leaves(world, moment);
    }
    ranks_weights_forget(world);
    return status;
}

/* The scene is cut, as that is due or it never was. By work, so that ranks have about as
 * many records, too; first by leaves, if it never was. A step of mode any mostly ends
 * long before all leaves are weighed. */
static int cut(struct pccd_mpi *world, struct ranks_moment *moment, bool is_of_leaves)
{
    const bool was_cut = world->is_cut;
    int status = was_cut ? PCCD_OK : cut_leaves(world, moment);
    bool goes_on = world->link.size > 1 && is_of_leaves &&
                   (was_cut || moment->settings.mode != PCCD_MODE_ANY);
    for (uint32_t cuts = was_cut ? 1 : RANKS_CUTS_BY_WORK; cuts > 0 && goes_on; cuts--) {
        if (status != PCCD_OK || moment->stopped != PCCD_COMPLETE) {
            break;
        }
        status = cut_by_work(world, moment, was_cut, &goes_on);
    }
    return status;
}

static int make_answer(struct pccd_mpi *world, const struct ranks_moment *moment,
                       uint64_t cut_ns, struct pccd_answer *answer)
{
    return moment->near != NULL
               ? ranks_answer_make_near(world, moment->near, answer)
               : ranks_answer_make(world, &moment->settings, cut_ns, answer);
}

/* All ranks know that the call ends: libpccd counts the step, and is not told what moves.
 * Whatever it still says, of what stood in its last step, is no answer. */
static int answer_nothing(struct pccd_mpi *world, const struct ranks_moment *moment,
                          uint64_t begin_ns, uint64_t cut_ns, struct pccd_answer *answer)
{
    struct pccd_frame frame;
    struct pccd_answer said = PCCD_ANSWER_INIT;
    world->stop.is_set = true;
    /* It may have a mesh of before a cut: no record gets numbers of what is there now. */
    (void)cli_mpi_write(world->client, NULL, NULL);
    int status = pccd_frame_begin(world->client, world->scene, 0, 0, &frame);
    status = status == PCCD_OK ? commit(world, moment, &frame, &said)
                               : ranks_local_status(world, status, "no frame of libpccd");
    status = ranks_agree_on(&world->link, status);
    *answer = (struct pccd_answer){.mode = moment->settings.mode,
                                   .method = said.method,
                                   .incomplete = moment->stopped,
                                   .verdict = PCCD_VERDICT_NONE,
                                   .toi_first = 2,
                                   .number = said.number,
                                   .threads = said.threads,
                                   .times.step = common_now_ns() - begin_ns,
                                   .is_near = said.is_near,
                                   .what = said.what,
                                   .distance_min = 2e18};
    if (status == PCCD_OK) {
        pccd_answer_release(world->client, &said);
        ranks_records_begin(world);
        status = make_answer(world, moment, cut_ns, answer);
    }
    return status;
}

/* libpccd computes, in each rank for what is there. */
static int ask_libpccd(struct pccd_mpi *world, struct ranks_moment *moment,
                       uint64_t begin_ns, bool is_cut, struct pccd_answer *answer)
{
    const struct ranks_sending sending = sending_of(world, moment);
    struct pccd_frame frame;
    int status = choose_ghosts(world, moment);
    if (status == PCCD_OK) {
        status = ranks_ghosts_build(world);
    }
    if (is_cut) {
        give_back();
    }
    uint64_t cut_ns = is_cut ? common_now_ns() - begin_ns : 0;
    if (status == PCCD_OK && moment->stopped != PCCD_COMPLETE) {
        return answer_nothing(world, moment, begin_ns, cut_ns, answer);
    }
    if (status == PCCD_OK) {
        status = ranks_sending_make(world, &sending, &frame);
    }
    if (status != PCCD_OK) {
        return status;
    }
    ranks_stop_open(&world->stop);
    status = ranks_agree_on(&world->link, compute(world, moment, &frame, answer));
    ranks_stop_close(&world->stop);
    if (status == PCCD_OK && world->is_merged) {
        status = ranks_merge(world);
    }
    if (status == PCCD_OK) {
        status = make_answer(world, moment, cut_ns, answer);
    }
    if (status != PCCD_OK) { /* some ranks may have moved on */
        for (uint32_t o = 0; o < world->object_count; o++) {
            world->objects[o]->is_elsewhere = true;
        }
    }
    return status;
}

/* Questions about two objects find out whether they are allowed, whenever they end. */
static int answer_by(struct pccd_mpi *world, struct ranks_moment *moment,
                     uint64_t begin_ns, struct pccd_answer *answer)
{
    bool is_of_leaves =
        moment->near == NULL || !common_near_is_of_objects(moment->near->what);
    bool is_stopped = is_of_leaves && moment->stopped != PCCD_COMPLETE;
    bool is_cut =
        !is_stopped && (!world->is_cut || (is_of_leaves && ranks_cut_is_due(world)));
    int status = is_cut ? cut(world, moment, is_of_leaves) : PCCD_OK;
    if (status != PCCD_OK) {
        return status;
    }
    uint64_t cut_ns = is_cut ? common_now_ns() - begin_ns : 0;
    is_stopped = is_of_leaves && moment->stopped != PCCD_COMPLETE;
    if (is_of_leaves && !is_stopped) {
        return ask_libpccd(world, moment, begin_ns, is_cut, answer);
    }
    status = is_stopped ? answer_nothing(world, moment, begin_ns, cut_ns, answer)
                        : ranks_near_of_objects(world, moment->near, answer);
    if (status == PCCD_OK && !moment->is_still && has_misses(world, moment)) {
        world->is_covered = false; /* they were not needed; whoever needs them looks */
    }
    return status;
}

static int make(struct pccd_mpi *world, struct ranks_moment *moment,
                struct pccd_answer *answer)
{
    bool is_of_leaves =
        moment->near == NULL || !common_near_is_of_objects(moment->near->what);
    uint64_t begin_ns = common_now_ns();
    world->link.sent_bytes = 0;
    ranks_records_begin(world);
    world->bound_count = world->stray_count = 0;
    world->is_merged = moment->near != NULL && moment->near->what == PCCD_NEAR_FEATURES;
    world->mode = moment->near != NULL ? PCCD_MODE_ALL : moment->settings.mode;
    world->has_bounds = moment->near != NULL && moment->near->what == PCCD_NEAR_VERTICES;
    int status = take_motions(world, moment);
    if (status == PCCD_OK) {
        status = answer_by(world, moment, begin_ns, answer);
    }
    if (status == PCCD_OK) {
        move_on(world, moment, is_of_leaves && moment->stopped == PCCD_COMPLETE);
        return PCCD_OK;
    }
    world->record_count = world->bound_count = 0;
    world->is_covered = false; /* ghosts may be those of the step that was not made */
    forget_begins(world, moment);
    if (world->link.broken == PCCD_OK) {
        int settled = ranks_stop_settle_alone(&world->stop);
        status = settled == PCCD_OK ? status : settled;
    }
    return status;
}

static void moment_deinit(struct ranks_moment *moment)
{
    free(moment->bytes);
    free((void *)moment->given);
    free((void *)moment->local);
}

static int moment_init(struct pccd_mpi *world, struct ranks_moment *moment)
{
    size_t objects = world->object_count;
    moment->bytes = calloc(objects * ROWS + 2, 1);
    moment->given = calloc(objects + 1, sizeof *moment->given);
    moment->local = calloc(objects + 1, sizeof *moment->local);
    return moment->bytes == NULL || moment->given == NULL || moment->local == NULL
               ? ranks_no_memory(world)
               : ranks_motions_check(world, moment->motions, moment->motion_count);
}

int ranks_moment_make(struct pccd_mpi *world, enum ranks_call call, uint64_t hash,
                      int status, struct ranks_moment *moment, struct pccd_answer *answer)
{
    struct pccd_answer made = PCCD_ANSWER_INIT;
    uint32_t threads =
        moment->near != NULL ? moment->near->threads : moment->settings.threads;
    world->team = threads < world->threads ? threads : world->threads;
    ranks_stop_begin(&world->stop);
    if (answer == NULL || (moment->motions == NULL && moment->motion_count > 0)) {
        status = ranks_missing(&world->link, answer == NULL ? "answer" : "motions");
    }
    if (status == PCCD_OK) {
        status = moment_init(world, moment);
    }
    status = ranks_agree(&world->link, call, hash, status);
    if (status == PCCD_OK) {
        ranks_stop_limit(&world->stop, moment->near != NULL
                                           ? moment->near->deadline_ns
                                           : moment->settings.deadline_ns);
        status = make(world, moment, &made);
    }
    moment_deinit(moment);
    if (status == PCCD_OK) {
        size_t bytes = answer->struct_bytes;
        memcpy(answer, &made, bytes == 0 || bytes > sizeof made ? sizeof made : bytes);
        answer->struct_bytes = bytes;
    }
    return status;
}

int pccd_mpi_step(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_step_settings *settings,
                  struct pccd_answer *answer)
{
    COMMON_ROUNDING_HERE;
    struct ranks_moment moment = {.motions = motions, .motion_count = motion_count};
    uint64_t hash = 0;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    int status = read_settings(world, settings, &moment.settings, &hash);
    return ranks_moment_make(world, RANKS_STEP, hash, status, &moment, answer);
}
