/* answer.c - an answer on its way to a client. */
#include "answer.h"

#include <unistd.h>

#include "host.h"
#include "invariant.h"
#include "log.h"
#include "now.h"
#include "replies.h"
#include "service.h"
#include "session.h"
#include "tracing.h"

void srv_answer_close_fds(const int *fds, int fd_count)
{
    for (int i = 0; i < fd_count; i++) {
        close(fds[i]);
    }
}

/* One answer into service->encoder; kept, too, where it may have to be sent again. */
static void encode(struct srv_session *session, const struct srv_question *question,
                   const void *result, const struct proto_error *error)
{
    struct proto_encoder *encoder = session->service->encoder;
    int status = error != NULL ? proto_encode_error(encoder, question->id, error)
                               : proto_encode_result(encoder, question->id,
                                                     question->method, result);
    PCCD_ASSERT(status == 0); /* no answer of ours comes near the limit */
    if (session->replies != NULL && srv_replies_must_keep(question->method) &&
        !(error != NULL && error->fatal)) {
        srv_replies_keep(session->replies, srv_reply_copy(question->id, encoder));
    }
}

/* Send one answer. Takes fds over. A fatal error is the last thing the client hears. */
static void send_answer(struct srv_session *session, const struct srv_question *question,
                        const void *result, const struct proto_error *error,
                        const int *fds, int fd_count)
{
    struct srv_service *service = session->service;
    int method = question->method;
    encode(session, question, result, error);
    srv_conn_send(session->conn, service->encoder, fds, fd_count);
    if (error == NULL) {
        return;
    }
    srv_metrics_add_error(&service->metrics, error->code);
    session->stats.errors++;
    srv_log(SRV_LOG_DEBUG, session->id, "%s: %s: %s",
            method >= 0 && method < PROTO_MESSAGE_COUNT ? proto_messages[method].name
                                                        : "?",
            proto_status_name(error->code), error->text);
    if (error->fatal) {
        session->is_ending = true;
        srv_conn_finish(session->conn);
    }
}

void srv_answer(struct srv_session *session, const struct srv_question *question,
                const void *result, const struct proto_error *error, const int *fds,
                int fd_count)
{
    struct srv_service *service = session->service;
    uint64_t begin_ns = service->tracing != NULL ? common_now_ns() : 0;
    send_answer(session, question, result, error, fds, fd_count);
    srv_metrics_add_duration(&service->metrics, PCCD_HISTOGRAM_REQUESTS,
                             common_now_ns() - question->arrival_ns);
    srv_tracing_add(service, PCCD_TRACE_ANSWER, session, begin_ns, question->method,
                    question->id);
    srv_tracing_add(service, PCCD_TRACE_REQUEST, session, question->arrival_ns,
                    question->method, question->id);
}

void srv_answer_keep(struct srv_session *session, const struct srv_question *question,
                     const void *result, const struct proto_error *error)
{
    PCCD_ASSERT(session->replies != NULL);
    encode(session, question, result, error);
}

void srv_answer_refuse(struct srv_session *session, const struct proto_error *error)
{
    PCCD_ASSERT(error->fatal);
    const struct srv_question none = {.method = -1};
    send_answer(session, &none, NULL, error, NULL, 0);
}
