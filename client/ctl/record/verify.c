/* verify.c - whether the answer to a step is right.
 *
 * Source: proto/PROTOCOL.md, "Records".
 */
#include "verify.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "kinds.h"
#include "oracle.h"

#define TOLERANCE    1e-6
#define BRACKET_BITS 60u
#define SLACK        1e-5 /* of parameters and normals, which are floats */

/* ---- the step's numbers ------------------------------------------------------------ */

uint32_t verify_mode(const struct play_step *step)
{
    return step->answer != NULL ? (uint32_t)step->answer->mode : step->recorded->mode;
}

double verify_toi_first(const struct play_step *step)
{
    return step->answer != NULL ? step->answer->toi_first : step->recorded->toi_first;
}

uint32_t verify_verdict(const struct play_step *step)
{
    return step->answer != NULL ? (uint32_t)step->answer->verdict
                                : step->recorded->verdict;
}

uint32_t verify_incomplete(const struct play_step *step)
{
    return step->answer != NULL ? (uint32_t)step->answer->incomplete
                                : step->recorded->incomplete;
}

bool verify_is_complete(const struct play_step *step)
{
    return play_is_complete(verify_incomplete(step));
}

static struct pccd_pair pair_of(const struct play_step *step, uint64_t i)
{
    if (step->pairs != NULL) {
        return step->pairs[i];
    }
    const struct pccd_contact *c = &step->contacts[i];
    return (struct pccd_pair){c->kind, c->object_a, c->feature_a, c->object_b,
                              c->feature_b};
}

static int compare_pairs(const struct pccd_pair *a, const struct pccd_pair *b)
{
    const uint32_t x[5] = {a->kind, a->object_a, a->feature_a, a->object_b, a->feature_b};
    const uint32_t y[5] = {b->kind, b->object_a, b->feature_a, b->object_b, b->feature_b};
    for (int i = 0; i < 5; i++) {
        if (x[i] != y[i]) {
            return x[i] < y[i] ? -1 : 1;
        }
    }
    return 0;
}

bool verify_has(const struct play_step *step, const struct pccd_pair *pair)
{
    uint64_t low = 0, high = step->found.count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        struct pccd_pair at = pair_of(step, middle);
        int order = compare_pairs(&at, pair);
        if (order == 0) {
            return true;
        }
        if (order < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return false;
}

const struct pccd_contact *verify_of_objects(const struct play_step *step, uint32_t a,
                                             uint32_t b)
{
    for (uint64_t i = 0; i < step->found.count; i++) {
        const struct pccd_contact *is = &step->contacts[i];
        if ((is->object_a == a && is->object_b == b) ||
            (is->object_a == b && is->object_b == a)) {
            return is;
        }
    }
    return NULL;
}

/* ---- records ---------------------------------------------------------------------- */

/* Return NULL if a pair names two features that there are and that may touch; else why it
 * does not. */
static const char *misnamed(const struct registry_scene *scene,
                            const struct pccd_pair *pair)
{
    const struct registry_object *a = registry_object(scene, pair->object_a);
    const struct registry_object *b = registry_object(scene, pair->object_b);
    if (a == NULL || b == NULL) {
        return "the record names an object that is not in the scene";
    }
    if (!registry_may_meet(scene, a, b)) {
        return a == b ? "the record's object may not meet itself"
                      : "the record's objects may not meet each other";
    }
    if (pair->kind >= PCCD_KIND_COUNT) {
        return "the record has an unknown kind";
    }
    const uint32_t count_a = common_kinds[pair->kind].points[0];
    const uint32_t count_b = common_kinds[pair->kind].points[1];
    const uint32_t *va = recorded_feature(a->mesh, count_a, &pair->feature_a);
    const uint32_t *vb = recorded_feature(b->mesh, count_b, &pair->feature_b);
    if (va == NULL || vb == NULL) {
        return "the record names a feature that there is not";
    }
    if ((pair->kind == PCCD_VE || pair->kind == PCCD_VV) &&
        !(recorded_is_free(a->mesh, count_a, pair->feature_a) &&
          recorded_is_free(b->mesh, count_b, pair->feature_b))) {
        return "the record names a vertex or an edge that is not free";
    }
    if (count_a == count_b && (pair->object_a > pair->object_b ||
                               (a == b && pair->feature_a >= pair->feature_b))) {
        return "the record has its features in the wrong order";
    }
    return a == b && recorded_share_vertex(va, count_a, vb, count_b)
               ? "the record's features share a vertex"
               : NULL;
}

bool verify_leave(struct verify_result *result, const char *format, ...)
{
    va_list arguments;
    if (result->unchecked[0] == '\0') {
        va_start(arguments, format);
        (void)vsnprintf(result->unchecked, sizeof result->unchecked, format, arguments);
        va_end(arguments);
    }
    return true;
}

bool verify_wrong(struct verify_result *result, const struct play_step *step,
                  const struct pccd_pair *pair, const char *format, ...)
{
    struct verify_witness *witness = &result->witness;
    va_list arguments;
    result->is_wrong = true;
    memset(witness, 0, sizeof *witness);
    witness->step = step->number;
    va_start(arguments, format);
    (void)vsnprintf(witness->what, sizeof witness->what, format, arguments);
    va_end(arguments);
    if (pair == NULL) {
        return false;
    }
    witness->pair = *pair;
    if (misnamed(step->scene, pair) != NULL) {
        return false;
    }
    for (uint32_t side = 0; side < 2; side++) {
        const struct registry_object *object =
            registry_object(step->scene, side == 0 ? pair->object_a : pair->object_b);
        (void)snprintf(witness->names[side], sizeof witness->names[side], "%s",
                       object->name != NULL ? object->name : "");
    }
    if (verify_turns(step, pair)) {
        verify_turning_tell(step, pair, witness);
        return false;
    }
    struct verify_meeting meeting;
    verify_meet(step, pair, &meeting);
    struct oracle_first *first = meeting.first;
    witness->has_pair = true;
    memcpy(witness->p, meeting.p, sizeof witness->p);
    if (first != NULL) {
        mpq_t lo, hi;
        mpq_inits(lo, hi, NULL);
        oracle_first_bracket(first, BRACKET_BITS, lo, hi);
        witness->has_contact = true;
        witness->lo = mpq_get_d(lo);
        witness->hi = mpq_get_d(hi);
        mpq_clears(lo, hi, NULL);
        oracle_first_free(first);
    }
    return false;
}

/* ---- one contact ------------------------------------------------------------------- */

/* Return what is wrong with a contact, whatever its features, be they of bodies that turn
 * or not; NULL: nothing. */
static const char *malformed(const struct pccd_contact *contact, double tolerance)
{
    double w[2][3];
    bool are_inside = true;
    double length = 0;
    for (int k = 0; k < 3; k++) {
        length += (double)contact->normal[k] * (double)contact->normal[k];
    }
    if (!(contact->toi >= 0 && contact->toi <= contact->toi_hi && contact->toi_hi <= 1)) {
        return "the record's time is not within the step";
    }
    if ((contact->flags & PCCD_PROVED) != 0 &&
        contact->toi_hi - contact->toi > tolerance) {
        return "the record's time is wider than the tolerance";
    }
    common_contact_weights((enum pccd_kind)contact->kind, contact->param, w);
    for (int i = 0; i < 6; i++) {
        are_inside = are_inside && w[i / 3][i % 3] >= -SLACK;
    }
    if ((contact->flags & PCCD_PROVED) != 0 && !are_inside) {
        return "the record's parameters are outside of its features";
    }
    if (!(length == 0 || fabs(sqrt(length) - 1) <= SLACK)) {
        return "the record's normal is neither of unit length nor zero";
    }
    return contact->reserved != 0 ? "the record's last word is not 0" : NULL;
}

/* Return whether the record is of a pair that has parted, and meets again. */
static bool meets_again(const struct play_step *step, const struct pccd_contact *contact,
                        const struct verify_meeting *meeting)
{
    return step->frame->touching == PCCD_TOUCHING_LEFT_OUT && meeting->touches &&
           (contact->flags & PCCD_INITIAL) == 0;
}

static bool check_exactly(const struct play_step *step,
                          const struct pccd_contact *contact,
                          const struct pccd_pair *pair, struct verify_result *result)
{
    const uint32_t known = PCCD_PROVED | PCCD_INITIAL | PCCD_INSIDE | PCCD_ENTERS |
                           PCCD_SLIDES | PCCD_LEAVES;
    bool is_proved = (contact->flags & PCCD_PROVED) != 0;
    const char *what = NULL;
    struct verify_meeting meeting;
    if (verify_turns(step, pair)) {
        return verify_turning(step, contact, pair, result);
    }
    verify_meet(step, pair, &meeting);
    struct oracle_first *first = meeting.first;
    const char *untold = verify_touching(step, contact, pair, &meeting, result);
    if (first == NULL) {
        what = is_proved ? "a contact is claimed to be proved, and there is none" : NULL;
    } else if (is_proved && untold != NULL) {
        what = untold;
    } else if (meets_again(step, contact, &meeting)) {
        what = verify_place(contact, (const double(*)[3])meeting.p, 0);
    } else if (oracle_first_compare(first, contact->toi) < 0) {
        what = "the first contact is before the record's time";
    } else if (is_proved && oracle_first_compare(first, contact->toi_hi) > 0) {
        what = "the first contact is after the record's time";
    } else if (is_proved &&
               (contact->flags & (PCCD_INITIAL | PCCD_INSIDE)) != meeting.flags) {
        what = "whether the features meet at t = 0, or begin within their distance, is "
               "claimed wrongly";
    } else if (is_proved && (meeting.flags & PCCD_INITIAL) != 0 &&
               (contact->toi != 0 || contact->toi_hi != 0)) {
        what = "the features meet at t = 0, and the record's time is another";
    } else if (!is_proved && (meeting.r == 0 || (contact->flags & PCCD_INITIAL) != 0 ||
                              contact->flags != (meeting.flags & PCCD_INSIDE))) {
        what = "what could be proved of the record is not";
    } else if ((contact->flags & ~known) != 0) {
        what = "the record has flags that say nothing";
    } else if (is_proved) {
        what = verify_place(contact, (const double(*)[3])meeting.p, meeting.r);
    }
    oracle_first_free(first);
    if (what != NULL) {
        return verify_wrong(result, step, pair, "%s", what);
    }
    result->counts.contacts += is_proved;
    result->counts.possible += !is_proved;
    return is_proved ||
           verify_leave(result, "a record is possible: that it is not before its time is "
                                "checked, and no more");
}

uint64_t verify_mix(uint64_t x)
{
    x += VERIFY_MIX_STEP;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

/* Check that a pair of mode pairs is one that the mode asks for. */
static bool check_beside(const struct play_step *step, const struct pccd_pair *pair,
                         struct verify_result *result)
{
    return verify_turns(step, pair) || verify_is_beside(step, pair) ||
           verify_wrong(result, step, pair, "an axis separates a pair of the answer");
}

static bool check_records(const struct play_step *step,
                          const struct verify_settings *settings,
                          struct verify_result *result)
{
    double tolerance = step->frame->tolerance > 0 ? step->frame->tolerance : TOLERANCE;
    for (uint64_t i = 0; i < step->found.count; i++) {
        const struct pccd_pair pair = pair_of(step, i);
        const struct pccd_contact *contact =
            step->contacts != NULL ? &step->contacts[i] : NULL;
        const char *what = misnamed(step->scene, &pair);
        if (what == NULL && contact != NULL) {
            what = malformed(contact, verify_turns(step, &pair) ? 1 : tolerance);
        }
        if (what == NULL && i > 0) {
            const struct pccd_pair before = pair_of(step, i - 1);
            what = compare_pairs(&before, &pair) >= 0
                       ? "the record does not come after the one before"
                       : NULL;
        }
        if (what != NULL) {
            return verify_wrong(result, step, &pair, "record %" PRIu64 ": %s", i, what);
        }
        bool is_chosen = settings->contacts_max == 0 ||
                         verify_mix(settings->seed ^ verify_mix(step->number) ^ i) %
                                 step->found.count <
                             settings->contacts_max;
        if (!is_chosen) {
            continue;
        }
        if (contact == NULL && !check_beside(step, &pair, result)) {
            return false;
        }
        if (contact != NULL && !check_exactly(step, contact, &pair, result)) {
            result->witness.has_claim = true;
            result->witness.toi = contact->toi;
            result->witness.toi_hi = contact->toi_hi;
            return false;
        }
    }
    return true;
}

/* ---- the answer as a whole --------------------------------------------------------- */

void verify_skip(uint64_t step, bool is_near, struct verify_result *result)
{
    memset(result, 0, sizeof *result);
    result->step = step;
    result->is_near = is_near;
    verify_leave(result, "it had failed by chance, and is not repeated");
}

bool verify_is_bare(const struct record_answer *answer)
{
    const struct record_answer bare = {
        .step = answer->step, .status = answer->status, .is_near = answer->is_near};
    return memcmp(&bare, answer, sizeof bare) == 0;
}

/* Return whether the step has an answer to check; *is_right: what there is of one is
 * right. */
static bool can_check(const struct play_step *step, struct verify_result *result,
                      bool *is_right)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *now = step->answer;
    int answered = now != NULL ? now->status : then != NULL ? then->status : PCCD_OK;
    *is_right = true;
    if (now != NULL && then != NULL && now->status != then->status) {
        *is_right = verify_wrong(
            result, step, NULL, "the recorded status is %s, that of a daemon %s",
            pccd_status_name(then->status), pccd_status_name(now->status));
    } else if (then != NULL && then->status != PCCD_OK && !verify_is_bare(then)) {
        *is_right = verify_wrong(result, step, NULL,
                                 "the step failed, and its answer has numbers");
    } else if (now == NULL && then == NULL) {
        verify_leave(result, "it has no answer");
    } else if (answered != PCCD_OK) {
        verify_leave(result, "it failed: %s", pccd_status_text(answered));
    } else if (step->scene == NULL) {
        verify_leave(result, "its scene is gone");
    } else {
        return true;
    }
    return false;
}

/* Say what stays open of an answer that is not all there, or not all that there is. */
static void leave_open(const struct play_step *step, struct verify_result *result)
{
    static const char *const why[] = {
        [PCCD_INCOMPLETE_DEADLINE] = "its deadline passed",
        [PCCD_INCOMPLETE_CANCELLED] = "it was cancelled",
        [PCCD_INCOMPLETE_CONTACT_LIMIT] = "there was more than the daemon kept",
        [PCCD_INCOMPLETE_UNDECIDED] = "some pairs of what turns are not known"};
    uint32_t incomplete = verify_incomplete(step);
    if (!verify_is_complete(step)) {
        verify_leave(result, "%s: what is missing in its answer is not checked",
                     incomplete < sizeof why / sizeof why[0] ? why[incomplete] : "?");
    }
}

int verify_step(const struct play_step *step, const struct verify_settings *settings,
                struct verify_result *result, struct ctl_error *error)
{
    struct verify_start start = {.is_known = false};
    bool is_right = true;
    int status = PCCD_OK;
    if (step->asked != NULL) {
        return verify_distances(step, result, error);
    }
    memset(result, 0, sizeof *result);
    result->step = step->number;
    result->counts.steps = 1;
    if (!can_check(step, result, &is_right)) {
        result->counts.unchecked = is_right;
        return PCCD_OK;
    }
    for (uint32_t i = 0; i < step->scene->object_count && status == PCCD_OK; i++) {
        status = recorded_edges(step->scene->objects[i].mesh, error);
    }
    leave_open(step, result);
    is_right = status == PCCD_OK && check_records(step, settings, result) &&
               verify_numbers(step, result) &&
               verify_start(step, result, &start, error, &status);
    if (is_right && status == PCCD_OK && verify_mode(step) == PCCD_MODE_ANY) {
        is_right = verify_any(step, &start, result, error, &status);
    }
    if (is_right && status == PCCD_OK && step->found.is_whole &&
        verify_is_complete(step)) {
        (void)verify_near(step, settings, result);
    }
    if (result->counts.turning > 0) {
        verify_leave(result,
                     "bodies turn: of %" PRIu64 " of their pairs intervals do not "
                     "tell all",
                     result->counts.turning);
    }
    return status;
}

/* ---- options ----------------------------------------------------------------------- */

#define SAMPLE_MAX 1000000000u

#define AT(member) offsetof(struct verify_settings, member)
const struct option_table verify_table = {
    .rows = (const struct option_row[]){
        CTL_QUESTION,
        {"sample", 0, "N",
         "Check N pairs of each step that are near each other and not in the answer "
         "(default: 1000)",
         OPTION_U64, .at = AT(sample), .max = SAMPLE_MAX},
        {"contacts", 0, "N", "Check about N contacts of each step (default: all)",
         OPTION_U64, .at = AT(contacts_max), .min = 1, .max = SAMPLE_MAX},
        {"seed", 0, "N", "Seed of the random choice of pairs (default: 1)", OPTION_U64,
         .at = AT(seed), .max = UINT64_MAX},
        {"repeat", 0, NULL,
         "Have a daemon repeat the steps even if the recording holds the contacts",
         OPTION_FLAG, .at = AT(repeats)},
        {0}}};
