/* life.h - a client that uses every method once, from hello to bye. */
#ifndef TEST_LIFE_H
#define TEST_LIFE_H

#include "raw.h"

#define LIFE_STEPS 4u

enum life_kind {
    LIFE_ONCE,      /* what is refused twice is wrong */
    LIFE_RESUMABLE, /* besides, its session outlives its connection */
    LIFE_PATIENT    /* what is refused twice is no fault: refusals go on */
};

struct life {
    enum life_kind kind;
    const char *socket_path;
    struct proto_HELLO_result welcome;
    uint32_t resumptions; /* connections that were lost, and the session went on */
    bool is_lost;         /* the daemon closed the connection */
    uint32_t refusals;
    int refusal;      /* the last one's status */
    uint32_t answers; /* that were as wanted */
    char wrong[160];  /* "": nothing was */
    struct test_raw raw;
    struct test_raw guest; /* of its shared scene */
    struct proto_FRAME_SUBMIT_result steps[LIFE_STEPS];
    uint32_t step_count;
};

/* Live one at the daemon's socket. life->wrong says whether anything happened that must
 * not: no answer, a refusal of what cannot fail, a wrong contact. */
void life_run(struct life *life, const char *socket_path, enum life_kind kind);

#endif
