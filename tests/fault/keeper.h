/* keeper.h - runs a daemon whose calls fail on order, and checks that it keeps
 * serving. */
#ifndef TEST_KEEPER_H
#define TEST_KEEPER_H

#include "fault.h"
#include "life.h"

/* Group set-up and tear-down: a daemon that no fault has met yet. */
int keeper_start(void **state);
int keeper_stop(void **state);

extern struct fault_page *keeper_page;

/* Make the page and let daemons that start from now on be the faulty one that has it. */
bool keeper_make_page(void);
void keeper_drop_page(void);

/* Every how-maniest fault is tried: $FAULT_EVERY, else `sample`. */
uint64_t keeper_stride(uint64_t sample);

/* Let `length` calls fail from the first-th on that a client's life takes, then look
 * whether all is well. Returns how many did. Fails the test, saying so, when the client
 * got no answer or a wrong one, or the daemon is not what it was. */
uint64_t keeper_try(enum fault_call call, uint64_t first, uint64_t length, int error);

/* Fail the test, naming `what`, unless an honest client is served at once and the daemon
 * holds what it held at the start. */
void keeper_expect_peace(const char *what);

/* From now on what the daemon holds is what it shall come back to. */
void keeper_settle(void);

/* A socket that is connected to the daemon, and says nothing. */
int keeper_connect(void);

/* The daemon's process. */
int keeper_pid(void);
const char *keeper_socket(void);

#endif
