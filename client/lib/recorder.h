/* recorder.h - what a client asks and is answered, in a file.
 *
 * Append an event when it has happened: what was made or destroyed when its answer comes;
 * a step when it has been sent; its answer when that comes. The positions of a step are
 * read from its slot then, while the daemon computes.
 *
 * Threads: [owner]. There is no other thread, and no buffer that a crash could lose: each
 * event is one write.
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
    uint32_t up;                  /* of pccd_record_settings */
    bool is_beginning;            /* what is kept is being written */
    bool has_ended;               /* nothing is written any more */
    struct pccd_record_info info; /* of earlier segments where the writer counts */
    struct cli_journal *journals; /* of shared scenes (recorder_shared.h) */
    char text[CLI_TEXT_BYTES];    /* why it has ended */
};

/* Return whether this process is the one that records, still. */
bool cli_record_is_on(const struct pccd_client *client);

/* Append a chunk; 0 or why not (the recording has ended then). In a ring of segments, a
 * step and its answers go to the segment at hand, be it full. */
int cli_record_add(struct pccd_client *client, enum record_kind kind,
                   const struct record_part *parts, size_t count);

/* End the recording because of `status`, which it returns, with a text that says
 * `why`. */
int cli_record_stop_because(struct pccd_client *client, int status, const char *why);
/* End it because an append has failed with `status`, which it returns. */
int cli_record_stop_failed(struct pccd_client *client, int status);
/* End the segment's file with END. */
void cli_record_end(struct pccd_client *client, enum record_reason reason);
/* Close it, and add its bytes to those of the earlier segments. */
void cli_record_close_file(struct cli_recorder *recorder);

/* Return how many bytes of the file, but for END, an event must not go beyond; 0: no
 * bound. is_change: of what is registered, which another segment can begin with. */
uint64_t cli_record_bound(const struct cli_recorder *recorder, bool is_change);
/* Append within that bound: 0, PCCD_E_LIMIT, or another failure. */
int cli_record_append(struct cli_recorder *recorder, uint64_t bytes_max,
                      enum record_kind kind, const struct record_part *parts,
                      size_t count);

/* ---- requests: recorder_requests.c ------------------------------------------------- */

typedef int (*cli_record_fn)(struct pccd_client *client, enum record_kind kind,
                             const struct record_part *parts, size_t count);
/* Write a shape by `add`: a MESH, or a GUEST, whose handle or handles `of` has. */
int cli_record_put_shape(struct pccd_client *client, const struct record_mesh *of,
                         const struct registry_shape *shape, cli_record_fn add);
/* Write by `add` what an object is called; "": nothing any more. */
int cli_record_put_name(struct pccd_client *client, uint32_t scene, uint32_t object,
                        const char *name, cli_record_fn add);
/* Append a frame.submit or scene.near, with what it moves, in two parts, of which each
 * may be empty. A step without a number is another client's. */
int cli_record_motion(struct pccd_client *client, int method,
                      const union cli_params *params, const struct record_part moved[2]);
/* Write by `add` what a method has made, set or destroyed; nothing of other methods.
 * `answer`: what tells a new handle, NULL: nobody knows it. */
int cli_record_change(struct pccd_client *client, int method,
                      const union cli_params *params, const void *answer,
                      cli_record_fn add);

/* ---- what is kept: recorder_snapshot.c --------------------------------------------- */

/* Write everything that is kept into the segment that has just begun, then the steps
 * without an answer. 0 or why it could not be written. */
int cli_record_snapshot(struct pccd_client *client);
/* Append a step that has been sent, with the payload of its slot; nothing where a journal
 * says it. */
int cli_record_step(struct pccd_client *client, const struct cli_call *call);

/* ---- events ------------------------------------------------------------------------ */

/* Begin a segment. 0 or why not: the recording has ended then. */
int cli_record_open(struct pccd_client *client);

/* Append the mesh of a handle, which was made or replaced, and is kept already. This and
 * the next two do nothing without a recorder. */
void cli_record_mesh(struct pccd_client *client, uint32_t mesh,
                     const struct registry_shape *shape);
/* Append a step that has been sent; its slot is the daemon's. */
void cli_record_frame(struct pccd_client *client, const struct cli_call *call);
/* Append what the answer to a request tells; cli_replica_answer has seen it. */
void cli_record_answer(struct pccd_client *client, const struct cli_call *call);

/* ---- begin and end ----------------------------------------------------------------- */

/* Begin to record as $PCCD_RECORD and $PCCD_RECORD_OPTIONS say; 0 when they say
 * nothing. */
int cli_record_environment(struct pccd_client *client);
/* End it, and free it. */
void cli_record_close(struct pccd_client *client);

#endif
