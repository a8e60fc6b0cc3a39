/* recorder.h - what a client asks and is answered, into a file.
 *
 * Room:     client/lib, private. May include: client.h, client/record/chunk.h.
 * Does:     append each event when it has happened: what was made or destroyed when its
 *           answer comes, a step when it has been sent, its answer when that comes. A
 *           step's positions are read out of its slot then, while the daemon computes.
 * Does not: let a call fail because a recording does: it ends, and says so when asked.
 * Threads:  [owner]. There is no other thread, and no buffer that a crash could lose:
 *           each event is one write.
 */
#ifndef CLI_RECORDER_H
#define CLI_RECORDER_H

#include "chunk.h"
#include "client.h"

struct cli_recorder {
    struct record_writer writer;
    char *path;
    uint64_t segment_bytes_max; /* 0: no bound */
    uint32_t segments_max;      /* 1: the file is ended when it is full */
    uint32_t segment;
    bool has_records;
    bool is_beginning;            /* what is kept is being written */
    bool has_ended;               /* nothing is written any more */
    struct pccd_record_info info; /* of earlier segments where the writer counts */
    uint64_t segment_frames;
    struct cli_journal *journals; /* of shared scenes (recorder_shared.h) */
    char text[CLI_TEXT_BYTES];    /* why it has ended */
};

/* Each does nothing without a recorder. The handle of a mesh that was made or
 * replaced, and is kept already: */
void cli_record_mesh(struct pccd_client *client, uint32_t mesh, uint32_t format,
                     uint32_t vertex_count, const void *x, uint32_t triangle_count,
                     const void *triangles);
/* A step has been sent; its slot is the daemon's. */
void cli_record_frame(struct pccd_client *client, const struct cli_call *call);
/* A request has been answered; cli_keep_answer has seen it. */
void cli_record_answer(struct pccd_client *client, const struct cli_call *call);
void cli_record_cancel(struct pccd_client *client, uint64_t step);

/* As $PCCD_RECORD and $PCCD_RECORD_OPTIONS say; 0 when they say nothing. */
int cli_record_environment(struct pccd_client *client);
/* End it, and free it. */
void cli_record_close(struct pccd_client *client);

/* recorder.c: begin a segment; whether this process is the one that records, still; end
 * the segment's file with END. */
int cli_record_open(struct pccd_client *client);
bool cli_record_is_on(const struct pccd_client *client);
/* Nothing is recorded any more, because of `status`, which it returns. */
int cli_record_stop_because(struct pccd_client *client, int status, const char *why);
void cli_record_end(struct pccd_client *client, enum record_reason reason);

/* recorder_snapshot.c: everything that is kept, into the segment that has just begun,
 * then LOG, then the steps without an answer. 0 or why it could not be written. */
int cli_record_snapshot(struct pccd_client *client);
/* Append; 0 or why not (the recording has ended then). In a ring of segments, a step and
 * its answers go to the segment at hand, be it full. */
int cli_record_add(struct pccd_client *client, enum record_kind kind,
                   const struct record_part *parts, size_t count);
/* The same for a change of what is kept, where it is already: in a ring of segments, what
 * does not fit is what another one begins with. */
int cli_record_change(struct pccd_client *client, enum record_kind kind,
                      const struct record_part *parts, size_t count);
int cli_record_step(struct pccd_client *client, const struct cli_call *call);

#endif
