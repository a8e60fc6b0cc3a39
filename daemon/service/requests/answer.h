/* answer.h - sends the answer of a request to its client. */
#ifndef SRV_ANSWER_H
#define SRV_ANSWER_H

#include <stdint.h>

#include "codec.h"

struct srv_session;

/* The request that is answered. */
struct srv_question {
    uint64_t arrival_ns;
    uint32_t id;
    int method; /* enum proto_method; -1: none that is known */
};

/* Send `result`, or `error` when that is not NULL. Takes over fds[fd_count]. A fatal
 * error is the last thing that the client hears. */
void srv_answer(struct srv_session *session, const struct srv_question *question,
                const void *result, const struct proto_error *error, const int *fds,
                int fd_count);

/* Keep it for a client that comes back, and send nothing. */
void srv_answer_keep(struct srv_session *session, const struct srv_question *question,
                     const void *result, const struct proto_error *error);

/* Send a fatal error that answers no message, and close. */
void srv_answer_refuse(struct srv_session *session, const struct proto_error *error);

/* Close the descriptors of an answer, which nobody gets. */
void srv_answer_close_fds(const int *fds, int fd_count);

#endif
