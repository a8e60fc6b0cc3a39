/* teardown.c - what a session that ends lets go of. */
#include "teardown.h"

#include "dispatch.h"
#include "linger.h"
#include "meshes.h"
#include "request.h"
#include "ringio.h"
#include "session.h"
#include "shared.h"
#include "srv_scene.h"
#include "tracing.h"
#include "watcher.h"

/* Drop the session's own references; what requests still use goes with the last of
 * them. */
static void drop_everything(struct srv_session *session)
{
    uint32_t cursor = 0;
    for (struct srv_scene *scene; (scene = srv_handles_pop(&session->scenes, &cursor));) {
        if (scene->shared != NULL) {
            srv_shared_leave(session, scene);
        } else {
            srv_resource_drop(&scene->resource);
        }
    }
    cursor = 0;
    for (struct srv_mesh *mesh; (mesh = srv_handles_pop(&session->meshes, &cursor));) {
        srv_mesh_free(mesh);
    }
    if (session->ring != NULL) {
        srv_resource_drop(&session->ring->resource);
        session->ring = NULL;
    }
    srv_tracing_drop(session);
    (void)srv_watcher_stop(session);
}

void srv_refuse(struct srv_session *session, const struct proto_error *error)
{
    if (session->conn != NULL) {
        srv_dispatch_violation(session, error->code, error->text);
    } else {
        srv_linger_end(session, error->text);
    }
}

void srv_let_go(struct srv_session *session)
{
    srv_request_abandon_all(session);
    drop_everything(session);
}
