/* reader.h - reads the chunks of a recording, one after the other.
 *
 * Threads: one thread per reader.
 */
#ifndef RECORD_READER_H
#define RECORD_READER_H

#include "chunk.h"

/* The ways in which a file ends. */
enum record_ending {
    RECORD_ENDING_UNKNOWN = 0, /* not read to the end yet */
    RECORD_ENDING_WHOLE,       /* with END */
    RECORD_ENDING_OPEN,        /* without: still being written, or the writer was ended */
    RECORD_ENDING_CUT          /* in the middle of a chunk, which is lost */
};

struct record_reader {
    int fd;             /* -1: `memory` */
    const void *memory; /* the caller's */
    uint64_t bytes;     /* of file or memory, when it was opened */
    uint64_t offset;    /* of the next chunk */
    enum record_ending ending;
    uint32_t vertex_count_max; /* of any mesh that was read */
    bool has_end;              /* the last chunk was END */
    uint32_t end_reason;       /* enum record_reason, if its payload was read */
    uint8_t *stored;
    uint8_t *payload;
    size_t stored_room, payload_room;
    char text[RECORD_TEXT_BYTES + 64]; /* of the last failure, with its place */
};

/* A chunk; `payload` lives until the next call. */
struct record_view {
    uint64_t offset; /* in the file */
    uint16_t kind;
    uint64_t time_ns;
    uint64_t sum; /* of its header, and so of all that it holds */
    uint64_t bytes;
    const void *payload; /* NULL after record_reader_skim */
};

/* Open, and judge the head. PCCD_E_SYSTEM, PCCD_E_FORMAT; reader->text says more, and
 * deinit is to be called all the same. */
int record_reader_open(struct record_reader *reader, const char *path);
int record_reader_open_memory(struct record_reader *reader, const void *memory,
                              uint64_t bytes);
void record_reader_deinit(struct record_reader *reader);

/* Read the next chunk of a known kind: 1, or 0 at the end (reader->ending says which),
 * or PCCD_E_FORMAT (damaged: nothing after it can be trusted), PCCD_E_SYSTEM,
 * PCCD_E_NOMEM. */
int record_reader_next(struct record_reader *reader, struct record_view *view);
/* Read the next chunk, but neither read nor judge the payloads of kinds whose bit
 * (1 << kind) is not in `kinds`. */
int record_reader_skim(struct record_reader *reader, uint32_t kinds,
                       struct record_view *view);
/* Go on with the chunk at `offset`, which a view has named. */
void record_reader_seek(struct record_reader *reader, uint64_t offset);

#endif
