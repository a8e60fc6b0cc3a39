/* teardown.h - frees everything that a session had when it ends.
 *
 * Room:     service. May include: the C library.
 * Does:     stop its requests and drop its scenes, meshes and ring. sessions/session.c
 *           calls it through srv_service.let_go, because it knows neither requests nor
 *           scenes.
 * Threads:  [loop]
 */
#ifndef SRV_TEARDOWN_H
#define SRV_TEARDOWN_H

struct srv_session;

/* The session is CLOSED, and stays until the caller lets it go. */
void srv_let_go(struct srv_session *session);

#endif
