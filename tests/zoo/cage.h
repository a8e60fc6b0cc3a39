/* cage.h - runs one hostile client in a process of its own. */
#ifndef ZOO_CAGE_H
#define ZOO_CAGE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "raw.h"

#define ZOO_EACH_MAX 32

/* Shared by keeper and animal. */
struct zoo_cage {
    const char *socket;
    unsigned number;   /* among its like */
    unsigned pause_ms; /* that an animal which stops itself is stopped for */
    unsigned burst_us; /* as the animal's */
    unsigned rest_us;
    bool patient;     /* there is time for what takes ten seconds */
    atomic_bool stop; /* set by the keeper */
    atomic_uint acts; /* done, as they must be */
    atomic_int line;  /* where something else happened; 0: nowhere */
    char what[160];   /* then: what was expected */
};

struct zoo_animal {
    const char *name;
    /* One act in the animal's process. False: zoo_fail has been called. */
    bool (*act)(struct zoo_cage *cage);
    bool sleeps;       /* it does nothing that another could notice: one act is enough */
    unsigned burst_us; /* of one that burns: what it works, */
    unsigned rest_us;  /* and what it sleeps then */
    bool takes_long;   /* the daemon computes for seconds for it */
};

/* A daemon's socket and `each` animals in front of it. */
struct zoo_den {
    struct zoo_cage *cages; /* [each], shared memory */
    pid_t pids[ZOO_EACH_MAX];
    unsigned each;
    uint64_t begin_us;
    uint64_t work_us; /* once closed: processor time of all and of their children, */
    uint64_t wall_us; /* in so much time */
};

/* Let them in, and wait until each has done an act, 20 s at most. False: one has not, or
 * has been answered wrongly. */
bool zoo_open(struct zoo_den *den, const struct zoo_animal *animal, const char *socket,
              unsigned each, bool patient, unsigned pause_ms);
/* Tell them to end, and wait for it; one that does not is killed. Returns the acts that
 * they did; 0: one of them was answered wrongly, and zoo_say says what. */
unsigned zoo_close(struct zoo_den *den);
/* One that needs a processor as those of a closed den did, in as many pieces of a
 * millisecond at most, and never talks to the daemon. */
struct zoo_animal zoo_burner(const struct zoo_den *den, unsigned acts);

/* Print what went wrong, on stderr. */
void zoo_say(const struct zoo_den *den, const struct zoo_animal *animal);

/* Record what was expected; false. */
bool zoo_fail(struct zoo_cage *cage, int line, const char *what);

#define EXPECT(cage, condition)                                                          \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            return zoo_fail(cage, __LINE__, #condition);                                 \
        }                                                                                \
    } while (0)

/* The animal's own session: connected, with hello, and with slots of that size unless it
 * is 0. */
bool zoo_enter(struct zoo_cage *cage, struct test_raw *raw, uint64_t slot_bytes);

#endif
