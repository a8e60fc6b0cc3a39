/* teardown.h - frees everything that a session had when it ends.
 *
 * Stop its requests and drop its scenes, meshes and ring; or have it end. What is below
 * calls it through srv_service.let_go and srv_service.refuse, because it knows neither
 * requests nor scenes.
 */
#ifndef SRV_TEARDOWN_H
#define SRV_TEARDOWN_H

struct proto_error;
struct srv_session;

/* The session is CLOSED, and stays until the caller lets it go. */
void srv_let_go(struct srv_session *session);

/* It may not go on: tell its client, if it has one, and end it. */
void srv_refuse(struct srv_session *session, const struct proto_error *error);

#endif
