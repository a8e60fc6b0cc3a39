/* question.c - the text by which a client tunes how threads share a step. */
#include "question.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#define VALUES_MAX  2
#define QUOTE_BYTES 32 /* of the client's text that an error says again */

enum { SCHEDULER, HIGH_LEVEL, REFIT, STILL, CHOICE_COUNT };

static const struct {
    const char *name;
    const char *values[VALUES_MAX]; /* by number of the enumerator */
} choices[CHOICE_COUNT] = {
    [SCHEDULER] = {"scheduler", {"steal", "paper"}},
    [HIGH_LEVEL] = {"high-level", {"round-robin", "disjoint"}},
    [REFIT] = {"refit", {"even", "paper"}},
    [STILL] = {"still", {"kept", "anew"}},
};
static_assert(ENG_SCHEDULER_COUNT == VALUES_MAX && ENG_HIGH_LEVEL_COUNT == VALUES_MAX &&
                  ENG_REFIT_COUNT == VALUES_MAX && ENG_STILL_COUNT == VALUES_MAX,
              "a word for each value");

/* A part of a text. */
struct word {
    const char *at;
    size_t bytes;
};

static bool is_word(struct word word, const char *text)
{
    return strlen(text) == word.bytes && memcmp(text, word.at, word.bytes) == 0;
}

/* The beginning of it, for a message: whatever is not printable ASCII as '?'. */
static const char *quoted(struct word word, char quote[QUOTE_BYTES + 1])
{
    size_t bytes = word.bytes < QUOTE_BYTES ? word.bytes : QUOTE_BYTES;
    for (size_t i = 0; i < bytes; i++) {
        quote[i] = word.at[i] >= ' ' && word.at[i] <= '~' ? word.at[i] : '?';
    }
    quote[bytes] = '\0';
    return quote;
}

/* One of "name=value". */
static int read_choice(struct word item, uint32_t values[CHOICE_COUNT],
                       bool is_named[CHOICE_COUNT], char why[ENG_TUNING_WHY_BYTES])
{
    char quote[QUOTE_BYTES + 1];
    const char *equals = memchr(item.at, '=', item.bytes);
    size_t name_bytes = equals == NULL ? item.bytes : (size_t)(equals - item.at);
    const struct word name = {item.at, name_bytes};
    uint32_t choice = 0, value = 0;
    while (choice < CHOICE_COUNT && !is_word(name, choices[choice].name)) {
        choice++;
    }
    if (choice == CHOICE_COUNT || equals == NULL) {
        (void)snprintf(why, ENG_TUNING_WHY_BYTES,
                       "\"%s\" is none of %s=, %s=, %s=, %s=", quoted(item, quote),
                       choices[SCHEDULER].name, choices[HIGH_LEVEL].name,
                       choices[REFIT].name, choices[STILL].name);
        return PCCD_E_INVAL;
    }
    const struct word text = {equals + 1, item.bytes - name_bytes - 1};
    while (value < VALUES_MAX && !is_word(text, choices[choice].values[value])) {
        value++;
    }
    if (value == VALUES_MAX || is_named[choice]) {
        (void)snprintf(why, ENG_TUNING_WHY_BYTES, "%s: \"%s\" is %s%s or %s",
                       choices[choice].name, quoted(text, quote),
                       value == VALUES_MAX ? "not " : "a second value, of ",
                       choices[choice].values[0], choices[choice].values[1]);
        return PCCD_E_INVAL;
    }
    is_named[choice] = true;
    values[choice] = value;
    return PCCD_OK;
}

int eng_tuning_read(const char *text, struct eng_tuning *tuning,
                    char why[ENG_TUNING_WHY_BYTES])
{
    uint32_t values[CHOICE_COUNT] = {tuning->scheduler, tuning->high_level, tuning->refit,
                                     tuning->still};
    bool is_named[CHOICE_COUNT] = {false};
    int status = PCCD_OK;
    while (status == PCCD_OK && *text != '\0') {
        const struct word item = {text, strcspn(text, ",")};
        status = read_choice(item, values, is_named, why);
        text += item.bytes;
        if (*text == ',' && *++text == '\0' && status == PCCD_OK) {
            (void)snprintf(why, ENG_TUNING_WHY_BYTES, "it ends with a comma");
            status = PCCD_E_INVAL;
        }
    }
    if (status == PCCD_OK) {
        *tuning = (struct eng_tuning){(enum eng_scheduler)values[SCHEDULER],
                                      (enum eng_high_level)values[HIGH_LEVEL],
                                      (enum eng_refit_scheme)values[REFIT],
                                      (enum eng_still)values[STILL]};
    }
    return status;
}

void eng_tuning_used(const struct eng_question *question,
                     const struct eng_step_result *result, char text[PCCD_TUNING_BYTES])
{
    const struct eng_tuning *tuning = &question->tuning;
    bool is_paper = result->method == PCCD_METHOD_PAPER;
    bool has_high = is_paper && tuning->scheduler == ENG_SCHEDULER_PAPER;
    text[0] = '\0';
    if (result->threads < 2) {
        return;
    }
    int bytes = snprintf(
        text, PCCD_TUNING_BYTES, "%s=%s%s%s%s%s,%s=%s", choices[SCHEDULER].name,
        choices[SCHEDULER].values[is_paper ? tuning->scheduler : ENG_SCHEDULER_STEAL],
        has_high ? "," : "", has_high ? choices[HIGH_LEVEL].name : "",
        has_high ? "=" : "",
        has_high ? choices[HIGH_LEVEL].values[tuning->high_level] : "",
        choices[REFIT].name,
        choices[REFIT].values[is_paper ? tuning->refit : ENG_REFIT_EVEN]);
    assert(bytes > 0 && bytes < PCCD_TUNING_BYTES);
    (void)bytes;
}
