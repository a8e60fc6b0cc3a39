/* sending.c - the positions of a step. */
#include "step.h"

#include <stdlib.h>

#include "mpi_hooks.h"
#include "parts.h"

/* Positions of steps go to where the engine has them; not those of questions. A world of
 * one rank may be recorded, and a recording has frames. */
static bool lends(const struct pccd_mpi *world, const struct ranks_sending *sending)
{
    return !sending->is_question && world->link.size > 1;
}

/* Return whether libpccd gets the start of the object, too. */
static bool has_start(const struct pccd_mpi *world, const struct ranks_sending *sending,
                      uint32_t o)
{
    return sending->starts[o] || world->objects[o]->is_elsewhere;
}

/* Tell libpccd that the positions it was lent are there, or will not be. */
static int end_lending(struct pccd_mpi *world, const struct ranks_sending *sending,
                       bool is_there)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && lends(world, sending); o++) {
        enum cli_mpi_lent which = !is_there                      ? CLI_MPI_NONE
                                  : has_start(world, sending, o) ? CLI_MPI_X0X1
                                                                 : CLI_MPI_X1;
        if (sending->local[o] != NULL && status == PCCD_OK) {
            status = cli_mpi_lent(world->client, world->scene, world->objects[o]->handle,
                                  which);
        }
    }
    return status;
}

static void drop_frame(struct pccd_mpi *world, const struct ranks_sending *sending,
                       struct pccd_frame *frame)
{
    pccd_frame_abort(frame);
    (void)end_lending(world, sending, false);
}

/* A frame with a segment for each object that is sent and has leaves here: the places for
 * its positions. Or without any, and these places are the engine's. */
static int begin_frame(struct pccd_mpi *world, const struct ranks_sending *sending,
                       struct pccd_frame *frame, double (**x0)[3], double (**x1)[3])
{
    uint64_t bytes = 0;
    uint32_t segments = 0;
    for (uint32_t o = 0; o < world->object_count && !lends(world, sending); o++) {
        const struct ranks_object *object = world->objects[o];
        if (sending->given[o] != NULL && object->local.vertex_count > 0) {
            segments++;
            bytes += 48 * (uint64_t)object->local.vertex_count;
        }
    }
    int status = pccd_frame_begin(world->client, world->scene, segments, bytes, frame);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        uint32_t count = object->local.vertex_count;
        bool has_x0 = has_start(world, sending, o);
        void *to[2] = {NULL, NULL};
        if (sending->given[o] == NULL || count == 0) {
            continue;
        }
        if (lends(world, sending)) {
            status = cli_mpi_lend(world->client, world->scene, object->handle,
                                  has_x0 ? &x0[o] : NULL, &x1[o]);
        } else {
            status = has_x0 ? pccd_frame_x0x1(frame, object->handle, PCCD_FORMAT_F64, 0,
                                              count, &to[0], &to[1])
                            : pccd_frame_x1(frame, object->handle, PCCD_FORMAT_F64, 0,
                                            count, &to[1]);
            x0[o] = to[0];
            x1[o] = to[1];
        }
        if (status != PCCD_OK) {
            drop_frame(world, sending, frame);
        }
    }
    return ranks_local_status(world, status, "no frame of libpccd");
}

int ranks_sending_make(struct pccd_mpi *world, const struct ranks_sending *sending,
                       struct pccd_frame *frame)
{
    uint32_t objects = world->object_count;
    double(**x0)[3] = calloc((size_t)objects + 1, sizeof *x0);
    int status = x0 == NULL ? ranks_no_memory(world) : PCCD_OK;
    bool has_frame = false;
    for (uint32_t o = 0; o < objects; o++) {
        const struct ranks_object *object = world->objects[o];
        bool is_sent = sending->moves[o] || has_start(world, sending, o);
        sending->given[o] = is_sent ? object->to : NULL;
    }
    if (status == PCCD_OK) {
        status = begin_frame(world, sending, frame, x0, sending->local);
        has_frame = status == PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, sending->given, sending->local);
    }
    for (uint32_t o = 0; o < objects; o++) {
        const struct ranks_object *object = world->objects[o];
        sending->given[o] = has_start(world, sending, o) ? object->from : NULL;
    }
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, sending->given, x0);
    }
    if (status != PCCD_OK && has_frame) {
        drop_frame(world, sending, frame);
    }
    free((void *)x0);
    return status;
}

int ranks_sending_commit(struct pccd_mpi *world, const struct ranks_sending *sending,
                         struct pccd_frame *frame,
                         const struct pccd_step_settings *settings,
                         struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = end_lending(world, sending, true);
    if (status != PCCD_OK) {
        drop_frame(world, sending, frame);
        return status;
    }
    status = pccd_frame_commit(frame, settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(world->client, step, -1, answer);
    }
    if (status != PCCD_OK) { /* one that was refused has not taken what was lent for it */
        (void)end_lending(world, sending, false);
    }
    return status;
}
