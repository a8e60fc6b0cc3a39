/* answers.c - what was answered, by step. */
#include "answers.h"

#include <assert.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"

struct answers_page {
    uint64_t step, first, count;
    uint64_t offset; /* of the chunk */
};

#define SUM_FACTOR 0x9e3779b97f4a7c15u /* odd, so that the order counts */

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what was answered");
}

static int compare_answers(const void *a, const void *b)
{
    const struct record_answer *x = a, *y = b;
    return (x->step > y->step) - (x->step < y->step);
}

static int compare_nears(const void *a, const void *b)
{
    const struct record_near_answer *x = a, *y = b;
    return (x->step > y->step) - (x->step < y->step);
}

static int compare_pages(const void *a, const void *b)
{
    const struct answers_page *x = a, *y = b;
    return x->step != y->step ? (x->step > y->step) - (x->step < y->step)
                              : (x->first > y->first) - (x->first < y->first);
}

static bool take_page(struct answers *answers, const struct record_view *view)
{
    struct record_records head;
    if (!array_reserve((void **)&answers->pages, answers->page_count, &answers->page_room,
                       sizeof *answers->pages)) {
        return false;
    }
    memcpy(&head, view->payload, sizeof head);
    answers->pages[answers->page_count++] =
        (struct answers_page){head.step, head.first, head.count, view->offset};
    return true;
}

/* One that moves nothing has 0; two that move the same vertices have the same. */
static uint64_t sum_moves(uint32_t scene, uint32_t count, const uint8_t *slot)
{
    uint64_t sum = scene;
    for (uint32_t i = 0; i < count; i++) {
        struct record_segment segment;
        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        sum = (sum ^ segment.object) * SUM_FACTOR;
        sum = (sum ^ ((uint64_t)segment.first << 32 | segment.count)) * SUM_FACTOR;
        sum ^= sum >> 32;
    }
    return count > 0 ? sum | 1 : 0;
}

static bool take_asked(struct answers *answers, const struct answers_asked *asked)
{
    if (!array_reserve((void **)&answers->asked, answers->asked_count,
                       &answers->asked_room, sizeof *answers->asked)) {
        return false;
    }
    answers->asked[answers->asked_count++] = *asked;
    answers->last_step = asked->step;
    return true;
}

static bool take_frame(struct answers *answers, const struct record_view *view)
{
    struct record_frame frame;
    memcpy(&frame, view->payload, sizeof frame);
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof frame;
    const struct answers_asked asked = {
        .step = frame.step, .moves = sum_moves(frame.scene, frame.segment_count, slot)};
    answers->frames++;
    return take_asked(answers, &asked);
}

static bool take_near(struct answers *answers, const struct record_view *view)
{
    struct record_near near;
    memcpy(&near, view->payload, sizeof near);
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof near;
    const struct answers_asked asked = {
        .step = near.step,
        .moves = sum_moves(near.scene, near.segment_count, slot),
        .is_near = true};
    answers->questions++;
    return take_asked(answers, &asked);
}

static bool take(struct answers *answers, const struct record_view *view)
{
    switch (view->kind) {
    case RECORD_BEGIN:
        memcpy(&answers->begin, view->payload, sizeof answers->begin);
        return true;
    case RECORD_FRAME:
        return take_frame(answers, view);
    case RECORD_NEAR:
        return take_near(answers, view);
    case RECORD_ANSWER:
        if (!array_reserve((void **)&answers->items, answers->count, &answers->room,
                           sizeof *answers->items)) {
            return false;
        }
        memcpy(&answers->items[answers->count++], view->payload, sizeof *answers->items);
        return true;
    case RECORD_NEAR_ANSWER:
        if (!array_reserve((void **)&answers->nears, answers->near_count,
                           &answers->near_room, sizeof *answers->nears)) {
            return false;
        }
        memcpy(&answers->nears[answers->near_count++], view->payload,
               sizeof *answers->nears);
        return true;
    case RECORD_RECORDS:
    case RECORD_NEAR_RECORDS:
        return take_page(answers, view);
    default:
        return true;
    }
}

int answers_read(struct answers *answers, struct record_reader *reader,
                 struct ctl_error *error)
{
    const uint32_t kinds = 1u << RECORD_BEGIN | 1u << RECORD_FRAME | 1u << RECORD_ANSWER |
                           1u << RECORD_RECORDS | 1u << RECORD_NEAR |
                           1u << RECORD_NEAR_ANSWER | 1u << RECORD_NEAR_RECORDS |
                           1u << RECORD_END;
    struct record_view view;
    int got;
    while ((got = record_reader_skim(reader, kinds, &view)) == 1) {
        answers->sum = (answers->sum ^ view.sum) * SUM_FACTOR;
        if (!take(answers, &view)) {
            return no_memory(error);
        }
    }
    if (answers->count > 0) {
        qsort(answers->items, answers->count, sizeof *answers->items, compare_answers);
    }
    if (answers->near_count > 0) {
        qsort(answers->nears, answers->near_count, sizeof *answers->nears, compare_nears);
    }
    if (answers->page_count > 0) {
        qsort(answers->pages, answers->page_count, sizeof *answers->pages, compare_pages);
    }
    return got == 0 ? PCCD_OK : ctl_error_set(error, got, "%s", reader->text);
}

void answers_deinit(struct answers *answers)
{
    free(answers->asked);
    free(answers->items);
    free(answers->nears);
    free(answers->pages);
    free(answers->numbers);
    memset(answers, 0, sizeof *answers);
}

const struct record_answer *answers_find(const struct answers *answers, uint64_t step)
{
    const struct record_answer key = {.step = step};
    return answers->count == 0 ? NULL
                               : bsearch(&key, answers->items, answers->count,
                                         sizeof *answers->items, compare_answers);
}

const struct record_near_answer *answers_find_near(const struct answers *answers,
                                                   uint64_t step)
{
    const struct record_near_answer key = {.step = step};
    return answers->near_count == 0 ? NULL
                                    : bsearch(&key, answers->nears, answers->near_count,
                                              sizeof *answers->nears, compare_nears);
}

/* The first page of a step, or where it would be. */
static size_t first_page(const struct answers *answers, uint64_t step)
{
    size_t low = 0, high = answers->page_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (answers->pages[middle].step < step) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* A page's records: what is there already is to be the same, the rest is appended. */
static int append(struct record_reader *reader, const struct answers_page *page,
                  size_t record_bytes, struct answers_found *found,
                  struct ctl_error *error)
{
    struct record_view view;
    struct record_records head;
    record_reader_seek(reader, page->offset);
    int got = record_reader_next(reader, &view);
    if (got != 1 || (view.kind != RECORD_RECORDS && view.kind != RECORD_NEAR_RECORDS)) {
        return ctl_error_set(error, PCCD_E_FORMAT, "at byte %" PRIu64 ": %s",
                             page->offset, got < 0 ? reader->text : "no records");
    }
    memcpy(&head, view.payload, sizeof head);
    if (head.record_bytes != record_bytes) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "at byte %" PRIu64 ": records of another mode",
                             page->offset);
    }
    const uint8_t *from = (const uint8_t *)view.payload + sizeof head;
    uint64_t end = head.first + head.count, known = found->count - head.first;
    size_t bytes = (size_t)(end > found->count ? end : found->count) * record_bytes;
    if (bytes > found->room) {
        void *grown = realloc(found->records, bytes + bytes / 2);
        if (grown == NULL) {
            return no_memory(error);
        }
        found->records = grown;
        found->room = bytes + bytes / 2;
    }
    known = known < head.count ? known : head.count;
    uint8_t *to = (uint8_t *)found->records + head.first * record_bytes;
    found->is_torn = found->is_torn ||
                     (known > 0 && memcmp(to, from, (size_t)known * record_bytes) != 0);
    if (end > found->count) {
        memcpy(to + known * record_bytes, from + known * record_bytes,
               (size_t)(head.count - known) * record_bytes);
        found->count = end;
    }
    return PCCD_OK;
}

int answers_records(const struct answers *answers, struct record_reader *reader,
                    uint64_t step, struct answers_found *found, struct ctl_error *error)
{
    const struct record_answer *answer = answers_find(answers, step);
    const struct record_near_answer *near = answers_find_near(answers, step);
    uint64_t total = answer != NULL ? answer->total : near != NULL ? near->total : 0;
    size_t each = sizeof(struct pccd_contact);
    if (answer != NULL && answer->mode == PCCD_MODE_PAIRS) {
        each = sizeof(struct pccd_pair);
    } else if (near != NULL) {
        each =
            near->what == PCCD_NEAR_VERTICES ? sizeof(double) : sizeof(struct pccd_near);
    }
    int status = PCCD_OK;
    found->count = found->first_count = 0;
    found->is_torn = false;
    for (size_t i = first_page(answers, step);
         i < answers->page_count && answers->pages[i].step == step && status == PCCD_OK;
         i++) {
        const struct answers_page *page = &answers->pages[i];
        if (page->first == 0 && page->count > found->first_count) {
            found->first_count = page->count;
        }
        /* Pages may have been fetched again, or from anywhere on. */
        if (page->first <= found->count && page->count > 0) {
            status = append(reader, page, each, found, error);
        }
    }
    found->is_whole = (answer != NULL || near != NULL) && found->count == total;
    return status;
}

/* ---- what belongs to nothing ------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* Whether a step or question of that number was asked. */
static bool was_asked(const struct answers *answers, uint64_t number)
{
    return answers->asked_count > 0 &&
           bsearch(&number, answers->numbers, answers->asked_count,
                   sizeof *answers->numbers, compare_numbers) != NULL;
}

uint64_t answers_stray(struct answers *answers, uint64_t after)
{
    uint64_t least = UINT64_MAX;
    if (answers->numbers == NULL) {
        answers->numbers = malloc((answers->asked_count + 1) * sizeof *answers->numbers);
        for (size_t i = 0; answers->numbers != NULL && i < answers->asked_count; i++) {
            answers->numbers[i] = answers->asked[i].step;
        }
        if (answers->numbers == NULL) {
            return 0; /* nothing is said of them then */
        }
        qsort(answers->numbers, answers->asked_count, sizeof *answers->numbers,
              compare_numbers);
    }
#define LOOK(items, item_count)                                                          \
    for (size_t i = 0; i < (item_count); i++) {                                          \
        uint64_t step = (items)[i].step;                                                 \
        bool is_twice = i > 0 && (items)[i - 1].step == step;                            \
        if (step > after && step < least && (is_twice || !was_asked(answers, step))) {   \
            least = step;                                                                \
        }                                                                                \
    }
    LOOK(answers->items, answers->count)
    LOOK(answers->nears, answers->near_count)
#undef LOOK
    for (size_t i = 0; i < answers->page_count; i++) {
        uint64_t step = answers->pages[i].step;
        if (step > after && step < least && !was_asked(answers, step)) {
            least = step;
        }
    }
    return least == UINT64_MAX ? 0 : least;
}
