/* client/ctl/commands/cmd_verify.c - pccdctl verify.
 *
 * Room:     client/ctl.
 * Does:     checks the answers of a recording by exact arithmetic, and says PASS, or
 *           shows what is wrong with all that is needed to repeat it.
 * Does not: compute contacts.
 * Threads:  one.
 * Source:   verify.h.
 */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "ctl.h"
#include "json_text.h"
#include "kinds.h"
#include "play_options.h"
#include "plural.h"
#include "verify.h"

#define SAMPLE     1000u
#define SAMPLE_MAX 1000000000u

enum { OPTION_SAMPLE = 256 + 64, OPTION_CONTACTS, OPTION_SEED, OPTION_REPEAT };

struct verification {
    struct play_options options;
    struct verify_settings settings;
    struct verify_counts counts;
    struct verify_witness witness;
    bool has_failed;
};

static const struct argp_option option_list[] = {
    {"sample", OPTION_SAMPLE, "N", 0,
     "Check N pairs of each step that are near each other and not in the answer "
     "(default: 1000)",
     0},
    {"contacts", OPTION_CONTACTS, "N", 0,
     "Check about N contacts of each step (default: all)", 0},
    {"seed", OPTION_SEED, "N", 0, "Seed of the random choice of pairs (default: 1)", 0},
    {"repeat", OPTION_REPEAT, NULL, 0,
     "Have a daemon repeat the steps even if the recording holds the contacts", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct verification *verification = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &verification->options;
        return 0;
    case OPTION_SAMPLE:
        verification->settings.sample =
            ctl_option_count(state, "sample", text, 0, SAMPLE_MAX);
        return 0;
    case OPTION_CONTACTS:
        verification->settings.contacts_max =
            ctl_option_count(state, "contacts", text, 1, SAMPLE_MAX);
        return 0;
    case OPTION_SEED:
        verification->settings.seed =
            ctl_option_count(state, "seed", text, 0, UINT64_MAX);
        return 0;
    case OPTION_REPEAT:
        verification->options.play.source = PLAY_DAEMON;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&play_options_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_verify = {
    .options = option_list,
    .parser = parse,
    .args_doc = "FILE",
    .doc = "Check the answers of a recording by exact rational arithmetic, which shares "
           "nothing with the engine: every contact, and a sample of pairs that are not "
           "among them.\vThe contacts are those of the recording, or a daemon's that "
           "repeats it (a private one, unless another is named). Exit status: 0 after "
           "PASS, 1 after FAIL.",
    .children = children};

static int check(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct verification *verification = context;
    bool is_right = true;
    int status = verify_step(step, &verification->settings, &verification->counts,
                             &verification->witness, &is_right, error);
    if (status != PCCD_OK || is_right) {
        return status;
    }
    verification->has_failed = true;
    return PCCD_E_CANCELLED;
}

static int check_near(void *context, const struct play_near *near,
                      struct ctl_error *error)
{
    struct verification *verification = context;
    bool is_right = true;
    int status = verify_distances(near, &verification->counts, &verification->witness,
                                  &is_right, error);
    if (status != PCCD_OK || is_right) {
        return status;
    }
    verification->has_failed = true;
    return PCCD_E_CANCELLED;
}

/* ---- telling ----------------------------------------------------------------------- */

/* Of a pair with those points a side: "vertex", "face 2", or "edge a 0" where both are of
 * one sort. */
static const char *point_name(const uint32_t points[2], uint32_t point, char text[16])
{
    uint32_t side = point < points[0] ? 0 : 1;
    const char *feature = common_feature_names[points[side]];
    const char *of = points[0] != points[1] ? "" : side == 0 ? " a" : " b";
    if (points[side] == 1) {
        snprintf(text, 16, "%s%s", feature, of);
    } else {
        snprintf(text, 16, "%s%s %" PRIu32, feature, of, point - side * points[0]);
    }
    return text;
}

static void print_witness(const struct verify_witness *witness)
{
    const struct pccd_pair *pair = &witness->pair;
    printf("FAIL: step %" PRIu64 ": %s\n", witness->step, witness->what);
    if (!witness->has_pair) {
        return;
    }
    const uint32_t *points = common_kinds[pair->kind].points;
    printf("  %s %" PRIu32 " of object 0x%" PRIx32 ", %s %" PRIu32 " of object 0x%" PRIx32
           "\n",
           common_feature_names[points[0]], pair->feature_a, pair->object_a,
           common_feature_names[points[1]], pair->feature_b, pair->object_b);
    if (witness->has_claim) {
        printf("  claimed: first contact in [%a, %a]\n", witness->toi, witness->toi_hi);
    }
    if (witness->has_contact) {
        printf("  exact:   first contact in [%a, %a], t = %.9g\n", witness->lo,
               witness->hi, witness->lo);
    } else {
        printf("  exact:   no contact\n");
    }
    for (uint32_t i = 0; i < 8; i++) {
        char name[16];
        if (i % 4 < points[0] + points[1]) {
            printf("  %-8s at t = %" PRIu32 ": %a %a %a\n",
                   point_name(points, i % 4, name), i / 4, witness->p[i][0],
                   witness->p[i][1], witness->p[i][2]);
        }
    }
}

static void print_text(const struct verification *verification)
{
    const struct verify_counts *counts = &verification->counts;
    if (verification->has_failed) {
        print_witness(&verification->witness);
        return;
    }
    printf(
        "PASS: %" PRIu64 " %s, %" PRIu64 " %s and %" PRIu64 " %s by exact arithmetic",
        counts->steps, proto_plural(counts->steps, "step", "steps"), counts->contacts,
        proto_plural(counts->contacts, "contact", "contacts"), counts->non_contacts,
        proto_plural(counts->non_contacts, "pair that is none", "pairs that are none"));
    if (counts->possible > 0) {
        printf(", %" PRIu64 " possible %s not contradicted", counts->possible,
               proto_plural(counts->possible, "one", "ones"));
    }
    if (counts->unchecked > 0) {
        printf(", %" PRIu64 " %s without an answer to check", counts->unchecked,
               proto_plural(counts->unchecked, "step", "steps"));
    }
    if (counts->nears > 0) {
        printf("; %" PRIu64 " %s about what is near with %" PRIu64 " %s", counts->nears,
               proto_plural(counts->nears, "question", "questions"), counts->near_records,
               proto_plural(counts->near_records, "record", "records"));
    }
    if (counts->nears_unchecked > 0) {
        printf(", %" PRIu64 " of them not checked", counts->nears_unchecked);
    }
    putchar('\n');
}

static json_t *witness_json(const struct verify_witness *witness)
{
    json_t *points = json_array();
    char text[64];
    for (int i = 0; i < 24; i++) {
        snprintf(text, sizeof text, "%a", witness->p[i / 3][i % 3]);
        json_array_append_new(points, json_string(text));
    }
    return json_pack("{s:I, s:s, s:b, s:I, s:I, s:I, s:I, s:I, s:b, s:f, s:f, s:o}",
                     "step", (json_int_t)witness->step, "what", witness->what, "has_pair",
                     witness->has_pair, "kind", (json_int_t)witness->pair.kind,
                     "object_a", (json_int_t)witness->pair.object_a, "feature_a",
                     (json_int_t)witness->pair.feature_a, "object_b",
                     (json_int_t)witness->pair.object_b, "feature_b",
                     (json_int_t)witness->pair.feature_b, "has_contact",
                     witness->has_contact, "contact_lo", witness->lo, "contact_hi",
                     witness->hi, "points", points);
}

static bool print_json(const struct verification *verification)
{
    const struct verify_counts *counts = &verification->counts;
    json_t *all = json_pack(
        "{s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "pass",
        !verification->has_failed, "steps", (json_int_t)counts->steps, "contacts",
        (json_int_t)counts->contacts, "possible", (json_int_t)counts->possible,
        "non_contacts", (json_int_t)counts->non_contacts, "unchecked",
        (json_int_t)counts->unchecked, "nears", (json_int_t)counts->nears, "near_records",
        (json_int_t)counts->near_records, "nears_unchecked",
        (json_int_t)counts->nears_unchecked);
    bool ok = all != NULL;
    if (ok && verification->has_failed) {
        ok = json_object_set_new(all, "witness", witness_json(&verification->witness)) ==
             0;
    }
    ok = ok && json_dumpf(all, stdout, JSON_TEXT_FLAGS) == 0 && putchar('\n') == '\n';
    json_decref(all);
    return ok;
}

int ctl_cmd_verify(int argc, char **argv)
{
    struct verification verification = {.settings = {.seed = 1, .sample = SAMPLE}};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&verification.options, "steps");
    verification.options.play.source = PLAY_RECORDS;
    verification.options.play.needs_records = true;
    verification.options.play.show_near = check_near;
    if (argp_parse(&ctl_argp_verify, argc, argv, 0, NULL, &verification) != 0) {
        return CTL_USAGE;
    }
    int status = play_options_open(&verification.options, &error);
    if (status == PCCD_OK) {
        status = play(&verification.options.play, check, &verification, &summary, &error);
    }
    if (status == PCCD_OK && !verification.has_failed &&
        verification.counts.steps == verification.counts.unchecked &&
        verification.counts.nears == verification.counts.nears_unchecked) {
        status = ctl_error_set(&error, PCCD_E_STATE,
                               "%s: none of %" PRIu64 " steps has an answer to check",
                               verification.options.play.path, verification.counts.steps);
    }
    if (status == PCCD_OK) {
        play_options_warn(&verification.options.play, &summary);
        if (verification.options.is_json && !print_json(&verification)) {
            status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report cannot be written");
        } else if (!verification.options.is_json) {
            print_text(&verification);
        }
    }
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&verification.options);
    return (int)ctl_exit_of(status, !verification.has_failed);
}
