/* answers.c - what was answered, by step. */
#include "answers.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "recorded_state.h"

struct answers_page {
    uint64_t step, first, count;
    uint64_t offset; /* of the chunk */
};

#define SUM_FACTOR 0x9e3779b97f4a7c15u /* odd, so that the order counts */

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what was answered");
}

/* Compare answers, or numbers: they begin with the number of their step. */
static int compare_steps(const void *a, const void *b)
{
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static int compare_pages(const void *a, const void *b)
{
    const struct answers_page *x = a, *y = b;
    return x->step != y->step ? (x->step > y->step) - (x->step < y->step)
                              : (x->first > y->first) - (x->first < y->first);
}

/* One more at the end of *items. False: no memory. */
static bool append(void **items, size_t *count, size_t *room, const void *item,
                   size_t bytes)
{
    if (!array_reserve(items, *count, room, bytes)) {
        return false;
    }
    memcpy((uint8_t *)*items + (*count)++ * bytes, item, bytes);
    return true;
}

static bool take_page(struct answers *answers, const struct record_view *view)
{
    struct record_records head;
    memcpy(&head, view->payload, sizeof head);
    const struct answers_page page = {head.step, head.first, head.count, view->offset};
    return append((void **)&answers->pages, &answers->page_count, &answers->page_room,
                  &page, sizeof page);
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

static bool take_asked(struct answers *answers, const struct record_view *view)
{
    struct recorded_item item;
    (void)recorded_item_take(&item, view);
    const struct answers_asked asked = {
        .step = item.frame.step,
        .moves = sum_moves(item.frame.scene, item.frame.segment_count, item.slot),
        .is_near = item.is_near};
    answers->frames += !item.is_near;
    answers->questions += item.is_near;
    answers->last_step = item.frame.step;
    return append((void **)&answers->asked, &answers->asked_count, &answers->asked_room,
                  &asked, sizeof asked);
}

static bool take(struct answers *answers, const struct record_view *view)
{
    switch (view->kind) {
    case RECORD_BEGIN:
        memcpy(&answers->begin, view->payload, sizeof answers->begin);
        return true;
    case RECORD_FRAME:
    case RECORD_NEAR:
        return take_asked(answers, view);
    case RECORD_ANSWER:
        return append((void **)&answers->items, &answers->count, &answers->room,
                      view->payload, sizeof *answers->items);
    case RECORD_RECORDS:
        return take_page(answers, view);
    default:
        return true;
    }
}

static void sort(void *items, size_t count, size_t bytes,
                 int (*compare)(const void *a, const void *b))
{
    if (count > 0) {
        qsort(items, count, bytes, compare);
    }
}

int answers_read(struct answers *answers, struct record_reader *reader,
                 struct ctl_error *error)
{
    const uint32_t kinds = 1u << RECORD_BEGIN | 1u << RECORD_FRAME | 1u << RECORD_ANSWER |
                           1u << RECORD_RECORDS | 1u << RECORD_NEAR | 1u << RECORD_END;
    struct record_view view;
    int got;
    while ((got = record_reader_skim(reader, kinds, &view)) == 1) {
        answers->sum = (answers->sum ^ view.sum) * SUM_FACTOR;
        if (!take(answers, &view)) {
            return no_memory(error);
        }
    }
    sort(answers->items, answers->count, sizeof *answers->items, compare_steps);
    sort(answers->pages, answers->page_count, sizeof *answers->pages, compare_pages);
    return got == 0 ? PCCD_OK : ctl_error_set(error, got, "%s", reader->text);
}

void answers_deinit(struct answers *answers)
{
    free(answers->asked);
    free(answers->items);
    free(answers->pages);
    free(answers->numbers);
    memset(answers, 0, sizeof *answers);
}

/* The item of a number among items that are sorted by it; NULL: there is none. */
static const void *find(const void *items, size_t count, size_t bytes, uint64_t number)
{
    return count == 0 ? NULL : bsearch(&number, items, count, bytes, compare_steps);
}

const struct record_answer *answers_find(const struct answers *answers, bool is_near,
                                         uint64_t step)
{
    const struct record_answer *answer =
        find(answers->items, answers->count, sizeof *answers->items, step);
    return answer != NULL && (answer->is_near != 0) == is_near ? answer : NULL;
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
static int take_records(struct record_reader *reader, const struct answers_page *page,
                        size_t record_bytes, struct answers_found *found,
                        struct ctl_error *error)
{
    struct record_view view;
    struct record_records head;
    record_reader_seek(reader, page->offset);
    int got = record_reader_next(reader, &view);
    if (got != 1 || view.kind != RECORD_RECORDS) {
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
    const struct record_answer *answer =
        find(answers->items, answers->count, sizeof *answers->items, step);
    size_t each = answer == NULL                       ? sizeof(struct pccd_contact)
                  : answer->is_near == 0               ? answer->mode == PCCD_MODE_PAIRS
                                                             ? sizeof(struct pccd_pair)
                                                             : sizeof(struct pccd_contact)
                                : answer->what == PCCD_NEAR_VERTICES ? sizeof(double)
                                                       : sizeof(struct pccd_near);
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
            status = take_records(reader, page, each, found, error);
        }
    }
    found->is_whole = answer != NULL && found->count == answer->total;
    return status;
}

/* ---- what belongs to nothing ------------------------------------------------------- */

/* Return whether a step or question of that number was asked. */
static bool was_asked(const struct answers *answers, uint64_t number)
{
    return find(answers->numbers, answers->asked_count, sizeof *answers->numbers,
                number) != NULL;
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
        sort(answers->numbers, answers->asked_count, sizeof *answers->numbers,
             compare_steps);
    }
    for (size_t i = 0; i < answers->count; i++) {
        uint64_t step = answers->items[i].step;
        bool is_twice = i > 0 && answers->items[i - 1].step == step;
        if (step > after && step < least && (is_twice || !was_asked(answers, step))) {
            least = step;
        }
    }
    for (size_t i = 0; i < answers->page_count; i++) {
        uint64_t step = answers->pages[i].step;
        if (step > after && step < least && !was_asked(answers, step)) {
            least = step;
        }
    }
    return least == UINT64_MAX ? 0 : least;
}
