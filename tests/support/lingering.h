/* lingering.h - a socket that blocks the thread that closes it. */
#ifndef TEST_LINGERING_H
#define TEST_LINGERING_H

/* A socket whose close(2) takes so many seconds: it has sent more than its peer, which
 * does not read, takes, and wants to see it off. Its peer goes to *peer; where that is
 * closed, who waits in close goes on. */
int test_lingering_new(int seconds, int *peer);

#endif
