/* recorder.c - the file that a client is recorded into. */
#include "recorder.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- the end of a file, and of a recording ----------------------------------------- */

void cli_record_end(struct pccd_client *client, enum record_reason reason)
{
    struct cli_recorder *recorder = client->recorder;
    struct record_end end = {.reason = reason};
    const struct record_part part = {&end, sizeof end};
    int status;

    assert(recorder->writer.fd >= 0 && !recorder->has_ended);
    recorder->writer.bytes_max = 0; /* for END there is room always */
    status = record_writer_add(&recorder->writer, RECORD_END, common_now_ns(), &part, 1);
    /* A full disk may have no room even for that; who reads the file is to know. */
    if (status == PCCD_E_SYSTEM && record_writer_take_back(&recorder->writer) == 0) {
        (void)record_writer_add(&recorder->writer, RECORD_END, common_now_ns(), &part, 1);
    }
}

void cli_record_close_file(struct cli_recorder *recorder)
{
    recorder->info.bytes += recorder->writer.bytes;
    recorder->info.raw_bytes += recorder->writer.raw_bytes;
    recorder->writer.bytes = recorder->writer.raw_bytes = 0;
    (void)record_writer_close(&recorder->writer);
}

/* Return whether it was for want of room; or else what happened was not to be recorded.
 */
static enum record_reason reason_of(int status)
{
    bool is_unwritten =
        status == PCCD_E_NOMEM || status == PCCD_E_QUOTA || status == PCCD_E_SYSTEM;

    return status == PCCD_E_LIMIT ? RECORD_FULL
           : is_unwritten         ? RECORD_UNWRITTEN
                                  : RECORD_APART;
}

int cli_record_stop_because(struct pccd_client *client, int status, const char *why)
{
    struct cli_recorder *recorder = client->recorder;

    (void)snprintf(recorder->text, sizeof recorder->text, "recording %s: %s",
                   recorder->path, why);
    if (recorder->writer.fd >= 0 && !recorder->has_ended) {
        cli_record_end(client, reason_of(status));
    }
    assert(status != 0);
    recorder->info.status = status;
    recorder->has_ended = true;
    cli_record_close_file(recorder);
    return status;
}

/* ---- what is appended -------------------------------------------------------------- */

/* Return the bound of a segment of a ring: what it begins with leaves room for what
 * happens then. */
uint64_t cli_record_bound(const struct cli_recorder *recorder, bool is_change)
{
    bool is_ring = recorder->segments_max > 1;

    if (recorder->segment_bytes_max == 0 ||
        (is_ring && !is_change && !recorder->is_beginning)) {
        return 0;
    }
    return is_ring && recorder->is_beginning
               ? recorder->segment_bytes_max / 2
               : recorder->segment_bytes_max -
                     record_chunk_bytes_max(sizeof(struct record_end));
}

int cli_record_append(struct cli_recorder *recorder, uint64_t bytes_max,
                      enum record_kind kind, const struct record_part *parts,
                      size_t count)
{
    recorder->writer.bytes_max = bytes_max;
    return record_writer_add(&recorder->writer, kind, common_now_ns(), parts, count);
}

int cli_record_stop_failed(struct pccd_client *client, int status)
{
    const struct cli_recorder *recorder = client->recorder;
    const char *why = proto_status_text(status);

    if (status == PCCD_E_SYSTEM) {
        why = strerror(errno);
    } else if (status == PCCD_E_LIMIT && recorder->writer.bytes_max != 0) {
        why = recorder->segments_max > 1
                  ? "a segment, max_bytes / segments, does not hold twice what it begins "
                    "with"
                  : "max_bytes is reached";
    }
    return cli_record_stop_because(client, status, why);
}

int cli_record_add(struct pccd_client *client, enum record_kind kind,
                   const struct record_part *parts, size_t count)
{
    struct cli_recorder *recorder = client->recorder;
    int status;

    if (recorder->has_ended) {
        return recorder->info.status;
    }
    status = cli_record_append(recorder, cli_record_bound(recorder, false), kind, parts,
                               count);
    return status == 0 ? 0 : cli_record_stop_failed(client, status);
}

bool cli_record_is_on(const struct pccd_client *client)
{
    return client->recorder != NULL && !client->recorder->has_ended &&
           client->owner == getpid();
}
