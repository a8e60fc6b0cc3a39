/* answers.h - the answers in a recording, looked up by step. */
#ifndef CTL_ANSWERS_H
#define CTL_ANSWERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "pccd_types.h"
#include "reader.h"

/* A step or a question about what is near, in the order of the file. */
struct answers_asked {
    uint64_t step;
    uint64_t moves; /* a sum of which vertices of which objects; 0: nothing moves */
    bool is_near;
};

struct answers {
    struct record_begin begin;
    struct answers_asked *asked;
    size_t asked_count, asked_room;
    uint64_t *numbers; /* of these, sorted; NULL until they are wanted */
    uint64_t sum;      /* of all that was read: of two recordings it is not the same */
    struct record_answer *items; /* by step */
    size_t count, room;
    struct answers_page *pages; /* by step and first */
    size_t page_count, page_room;
    uint64_t frames;
    uint64_t questions; /* about what is near */
    uint64_t last_step; /* number of a frame or a question */
};

/* Read all that the reader gives, from the beginning; it is at its end then. Errors:
 * E_NOMEM, those of the reader; what stands before damage has been read. */
int answers_read(struct answers *answers, struct record_reader *reader,
                 struct ctl_error *error);
void answers_deinit(struct answers *answers);
/* Return the answer to a step, or to a question about what is near. NULL: it was not
 * answered. */
const struct record_answer *answers_find(const struct answers *answers, bool is_near,
                                         uint64_t step);
/* Records of the answer to a step or a question, from the first one on. */
struct answers_found {
    void *records; /* grown by realloc, of `room` bytes */
    size_t room;
    uint64_t count;
    uint64_t first_count; /* of the longest page that begins with the first */
    bool is_whole;        /* they are all that the answer had */
    bool is_torn;         /* pages that overlap were not the same */
};
int answers_records(const struct answers *answers, struct record_reader *reader,
                    uint64_t step, struct answers_found *found, struct ctl_error *error);
/* Return the least number above `after` of a step or question that has an answer, or a
 * page of records, and is not in the recording, or that has two answers. 0: there is
 * none, or no memory to look. */
uint64_t answers_stray(struct answers *answers, uint64_t after);

#endif
