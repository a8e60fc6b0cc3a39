/* verify_options.c - what of a recording is checked. */
#include "verify.h"

#include "ctl.h"

#define SAMPLE_MAX 1000000000u

#define AT(member) offsetof(struct verify_options, member)
const struct option_table verify_table = {
    .rows = (const struct option_row[]){
        CTL_QUESTION,
        {"sample", 0, "N",
         "Check N pairs of each step that are near each other and not in the answer "
         "(default: 1000)",
         OPTION_U64, .at = AT(settings.sample), .max = SAMPLE_MAX},
        {"contacts", 0, "N", "Check about N contacts of each step (default: all)",
         OPTION_U64, .at = AT(settings.contacts_max), .min = 1, .max = SAMPLE_MAX},
        {"seed", 0, "N", "Seed of the random choice of pairs (default: 1)", OPTION_U64,
         .at = AT(settings.seed), .max = UINT64_MAX},
        {"repeat", 0, NULL,
         "Have a daemon repeat the steps even if the recording holds the contacts",
         OPTION_FLAG, .at = AT(repeats)},
        {0}}};
