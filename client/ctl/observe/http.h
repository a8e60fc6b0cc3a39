/* http.h - answers HTTP on a Unix socket.
 *
 * Threads: http_serve has one for each connection, which calls http_answer.
 */
#ifndef CTL_HTTP_H
#define CTL_HTTP_H

#include <stdio.h>

#define HTTP_OK          200u
#define HTTP_NOT_FOUND   404u
#define HTTP_UNAVAILABLE 503u

/* Write the body of the answer, plain text, to `to`; [any]. Returns the status of
 * HTTP. */
typedef unsigned (*http_answer)(void *context, const char *url, FILE *to);

/* Listen at `path`, for this user and group, and have each GET and HEAD answered, until
 * an interrupt or SIGTERM. A socket that nobody listens at is replaced. Returns an exit
 * status; what was wrong is said. */
int http_serve(const char *path, http_answer answer, void *context);

#endif
