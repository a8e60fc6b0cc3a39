/* stepping.c - what steps and questions about what is near have in common. */
#include "stepping.h"

#include <math.h>
#include <stdlib.h>

#include "admission.h"
#include "invariant.h"
#include "member.h"
#include "service.h"
#include "session.h"
#include "srv_journal.h"

#define NS_PER_MS 1000000u

/* Copied on [loop] out of the slot of a step that is answered before its turn: some
 * 100 us. One that needs more is answered in its turn. */
#define EARLY_BYTES_MAX (1u << 20)

/* ---- what is asked ----------------------------------------------------------------- */

#define ASKED(request)                                                                   \
    {                                                                                    \
        {(request)->slot, (request)->segments, (request)->seq}, (request)->method,       \
            (request)->threads, (request)->deadline_ns, (request)->step,                 \
            (request)->tuning                                                            \
    }

struct srv_asked srv_asked_of(int method, const union srv_params *params)
{
    PCCD_ASSERT(srv_is_step(method));
    if (method == PROTO_METHOD_SCENE_NEAR) {
        return (struct srv_asked)ASKED(&params->SCENE_NEAR);
    }
    if (method == PROTO_METHOD_BATCH_SUBMIT) {
        return (struct srv_asked)ASKED(&params->BATCH_SUBMIT);
    }
    return (struct srv_asked)ASKED(&params->FRAME_SUBMIT);
}

static struct srv_asked asked_of(const struct srv_request *request)
{
    return srv_asked_of(request->method, &request->params);
}

int srv_stepping_choose(struct srv_call *call, const struct srv_choice *choices,
                        size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (choices[i].value >= choices[i].count) {
            return proto_error_set(&call->error, PCCD_E_INVAL, "unknown %s %u",
                                   choices[i].name, choices[i].value);
        }
    }
    return 0;
}

int srv_check_length(struct srv_call *call, const char *name, double length)
{
    if (!(length >= 0.0) || isinf(length)) { /* written so that NaN is refused */
        return proto_error_set(&call->error, PCCD_E_INVAL, "%s is %g, not 0 to %g", name,
                               length, PROTO_COORDINATE_MAX);
    }
    if (length > PROTO_COORDINATE_MAX) {
        return proto_error_set(&call->error, PCCD_E_LIMIT, "%s is %g, at most %g may be",
                               name, length, PROTO_COORDINATE_MAX);
    }
    return 0;
}

static int check_how(struct srv_call *call, const struct srv_asked *asked)
{
    const struct srv_choice method = {"method", asked->method, PCCD_METHOD_COUNT};
    struct eng_tuning tuning = {0};
    char why[ENG_TUNING_WHY_BYTES];
    int status = srv_stepping_choose(call, &method, 1);
    if (status == 0 && eng_tuning_read(asked->tuning, &tuning, why) != PCCD_OK) {
        status = proto_error_set(&call->error, PCCD_E_INVAL, "tuning: %s", why);
    }
    if (status == 0 && asked->cargo.segments > PROTO_SEGMENTS_MAX) {
        status = proto_error_set(&call->error, PCCD_E_LIMIT,
                                 "%u segments, a step has at most %u",
                                 asked->cargo.segments, PROTO_SEGMENTS_MAX);
    }
    return status;
}

int srv_stepping_check(struct srv_call *call, const struct srv_asked *asked,
                       struct srv_ring **ring)
{
    srv_assert_loop();
    const struct srv_session *session = call->session;
    int status = srv_admit_ring(call, ring);
    if (status == 0) {
        status = check_how(call, asked);
    }
    if (status == 0 && asked->cargo.segments > 0) {
        status = srv_admit_slot(call, *ring, asked->cargo.slot, asked->cargo.seq);
    }
    if (status == 0 && session->submit_count >= (*ring)->inflight_max) {
        status = proto_error_set(&call->error, PCCD_E_BUSY,
                                 "%u steps are in flight, no more than %u may be",
                                 session->submit_count, (*ring)->inflight_max);
    }
    return status;
}

/* ---- how it is computed ------------------------------------------------------------ */

uint64_t srv_stepping_deadline(uint64_t budget_ns, uint64_t arrival_ns)
{
    if (budget_ns == 0) {
        return 0;
    }
    return budget_ns > UINT64_MAX - arrival_ns ? UINT64_MAX : arrival_ns + budget_ns;
}

/* The sooner one of the client's deadline and what the daemon lets a step compute; 0:
 * none. */
static uint64_t end_of(const struct srv_request *request, uint64_t budget_ns)
{
    uint64_t own_ns = srv_stepping_deadline(budget_ns, request->arrival_ns);
    uint64_t max_ms = request->session->service->options->step_max_ms;
    bool has_begun = request->begin_ns != 0;
    uint64_t max_ns =
        max_ms == 0 || !has_begun ? 0 : request->begin_ns + max_ms * NS_PER_MS;
    return own_ns == 0 || (max_ns != 0 && max_ns < own_ns) ? max_ns : own_ns;
}

static struct srv_workspace *workspace_of(const struct srv_request *request)
{
    return srv_workspace_of_thread(request->session->service->workspaces);
}

struct eng_question srv_stepping_settings(struct srv_request *request)
{
    const struct srv_asked asked = asked_of(request);
    const struct srv_options *options = request->session->service->options;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    char why[ENG_TUNING_WHY_BYTES];
    int status = eng_tuning_read(asked.tuning, &settings.tuning, why);
    PCCD_ASSERT(status == PCCD_OK); /* it was checked */
    settings.method = (enum pccd_method)asked.method;
    uint32_t threads_max = eng_payer_threads(options->threads_max);
    settings.threads =
        asked.threads == 0 || asked.threads > threads_max ? threads_max : asked.threads;
    settings.deadline_ns = end_of(request, asked.deadline_ns);
    settings.cancel = &request->job.cancel;
    settings.is_stopped = request->session->service->is_stopped;
    settings.asked = request->session->service->asked;
    settings.contact_max = options->contacts_max;
    settings.brief = srv_request_state(request) == SRV_REQUEST_BRIEF;
    settings.affinity =
        request->session->service->is_pinned ? workspace_of(request)->affinity : NULL;
    return settings;
}

/* ---- its turn ---------------------------------------------------------------------- */

struct proto_error *srv_stepping_owed(const struct srv_request *request)
{
    return request->plan.member != NULL ? &request->plan.member->owed
                                        : &request->plan.scene->owed;
}

int srv_stepping_begin(struct srv_request *request)
{
    srv_assert_compute();
    struct proto_error *owed = srv_stepping_owed(request);
    int code = owed->code;
    if (code != 0) {
        request->error = *owed;
        owed->code = 0;
        return code;
    }
    struct srv_page page;
    void *data = NULL;
    return srv_ring_reserve(request->plan.ring, 1, 0, &page, &data, &request->error);
}

void srv_stepping_open(struct srv_request *request, struct eng_scene *engine)
{
    struct eng_question settings = srv_stepping_settings(request);
    srv_journal_open(request->plan.scene, asked_of(request).cargo.segments);
    eng_stage_begin(engine);
    if (!settings.brief) {
        eng_stage_share(engine, settings.threads, settings.affinity);
    }
}

int srv_stepping_stage(struct srv_request *request)
{
    const struct srv_asked asked = asked_of(request);
    const struct srv_plan *plan = &request->plan;
    struct proto_segment *table = workspace_of(request)->segments;
    int status = 0;
    if (asked.cargo.segments > 0) {
        status = srv_request_state(request) == SRV_REQUEST_EARLY
                     ? srv_stage_copy(request->copy, request->copy_bytes, &asked.cargo,
                                      plan->member, plan->scene, table,
                                      &request->upload_bytes, &request->error)
                     : srv_stage_slot(plan->ring, &asked.cargo, plan->member, plan->scene,
                                      table, &request->upload_bytes, &request->error);
    }
    srv_request_return_slot(request);
    return status;
}

/* ---- before its turn --------------------------------------------------------------- */

void srv_stepping_answer_early(struct srv_request *request, void *result,
                               uint64_t *release)
{
    srv_assert_loop();
    const struct srv_cargo cargo = asked_of(request).cargo;
    struct srv_quota_user *user = request->session->owner.user;
    struct srv_ring *ring = request->plan.ring;
    struct proto_error error = {0};
    uint64_t bytes = 0;
    uint64_t copy_bytes = 0;
    uint8_t *copy = NULL;
    if (cargo.segments > 0) {
        bytes = ring->slot_stride < EARLY_BYTES_MAX ? ring->slot_stride : EARLY_BYTES_MAX;
        if (srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, bytes, &error) != 0) {
            return;
        }
        /* If it cannot be: whoever stages it in its turn says why. */
        (void)srv_stage_keep(ring, &cargo, bytes, &copy, &copy_bytes, &error);
    }
    /* Storing it changes nothing. */
    *release =
        atomic_load_explicit(&ring->shared->result_head.value, memory_order_relaxed);
    bool can = copy != NULL || cargo.segments == 0;
    if (!(can && srv_request_answer_early(request, result, copy, bytes)) && bytes > 0) {
        free(copy);
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, bytes);
    }
}
