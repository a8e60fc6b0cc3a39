/* pccd_daemon.h - what a daemon reports of itself and of its clients: lists, counters,
 * settings.
 *
 * Room:     common; installed. May include: the C library. Compiles as C++.
 * Does:     the structs of pccd_daemon, pccd_list_*, pccd_histogram, pccd_config_* and
 *           pccd_watch_*.
 * Does not: say who may ask what (pccd.h does).
 *
 * Those that the library hands to a callback may grow at their ends; the others stay as
 * they are. Times are in nanoseconds.
 */
#ifndef PCCD_DAEMON_H
#define PCCD_DAEMON_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct pccd_daemon_info {
    const char *name; /* "pccdd 0.1.0" */
    const char *cpu;  /* instruction set of its steps */
    uint32_t pid;
    uint32_t version;     /* of the protocol that both speak */
    uint32_t threads_max; /* of a step */
    uint64_t features;    /* bits, as in hello; 0 */
    uint64_t epoch;       /* another with each start of the daemon */
    uint64_t session;     /* number of this client's */
};

struct pccd_session_info {
    uint64_t session;   /* number, of this epoch */
    const char *client; /* name that it gave itself; gone when the callback returns */
    uint32_t uid, pid;  /* pid 0: not known */
    bool waiting;       /* its connection is lost */
    uint64_t ns_open;   /* since it said hello */
    uint32_t scenes, objects, meshes;
    uint32_t requests;  /* in flight */
    uint64_t triangles; /* of its objects */
    uint64_t shm_bytes; /* of its ring and result region */
    uint64_t errors;    /* error answers it got */
    uint64_t steps, steps_incomplete, contacts, upload_bytes, result_bytes;
    uint64_t ns_queue, ns_ingest, ns_refit, ns_traversal, ns_tests, ns_merge, ns_step;
    uint32_t batch, batch_done; /* scenes of the batch it has computed now, and done */
};

struct pccd_scene_info {
    uint32_t scene; /* handle in its session */
    uint32_t objects;
    uint64_t steps;
    uint64_t number;  /* of its last step in this epoch; 0: none yet */
    uint64_t total;   /* records of that one's answer */
    uint64_t hash[2]; /* of these: high, low */
    uint64_t ns_step; /* that it took */
    uint32_t ignored; /* pairs of its objects that ignore each other */
    const char *name; /* of one that is shared, gone when the callback returns; else "" */
    uint32_t uid;     /* user who made that */
    uint32_t rights;  /* who may take part: as a file's */
    uint32_t members; /* sessions that do */
    uint32_t held;    /* frames that wait for its next step */
    bool writable;    /* the session may add objects and step */
};

/* Ignoring each other: handles in their scene. */
struct pccd_ignored_pair {
    uint32_t object_a, object_b;
};

struct pccd_object_info {
    uint32_t object; /* handle in its scene */
    uint32_t mesh;   /* handle in its session; 0: destroyed since */
    uint64_t triangles;
    uint64_t owner;       /* number of the session that added it */
    uint64_t group, mask; /* what it may meet, as pccd_object_set says */
    bool self_collision;
    uint32_t rest_rings;
    double radius, rest_distance;
    uint64_t user_data;
    const char *name; /* pccd_object_name's, gone when the callback returns; "": none */
};

struct pccd_registered_mesh {
    uint32_t mesh; /* handle in its session */
    uint32_t vertex_count, triangle_count, generation;
    uint64_t objects;                 /* made of it */
    bool committed;                   /* it can be used */
    bool replacing;                   /* another shape of it is announced */
    uint32_t edge_count, point_count; /* that are named by themselves */
};

/* Bucket i counts what took less than 2^(10+i) ns and is in no bucket before; the last
 * one counts the rest. */
#define PCCD_HISTOGRAM_BUCKETS 27
enum pccd_histogram_kind {
    PCCD_HISTOGRAM_STEPS = 0,    /* steps, as computed */
    PCCD_HISTOGRAM_REQUESTS = 1, /* requests of every kind, from arrival to answer */
    PCCD_HISTOGRAM_COUNT = 2
};
struct pccd_histogram_info {
    uint64_t count;
    uint64_t ns_sum;
    uint64_t bucket[PCCD_HISTOGRAM_BUCKETS];
};

/* The strings are gone when the callback returns. */
struct pccd_setting {
    const char *name;  /* as pccdd's option, without the dashes */
    const char *value; /* that holds now */
    const char *text;  /* what it is, and which values it takes */
    bool changed;      /* since the daemon's start */
};

/* A step of anybody's, as one who watches is told of it. */
struct pccd_step_event {
    uint64_t number;  /* of the step in this epoch; 0: it failed */
    uint64_t session; /* whose */
    uint32_t scene;   /* handle there */
    int status;       /* 0, or why it failed */
    uint64_t step;    /* the client's number for it */
    uint32_t mode, incomplete, verdict, threads; /* as in struct pccd_answer */
    uint64_t total;                              /* records */
    uint64_t hash[2];                            /* high, low */
    uint64_t ns_queue, ns_step;
    uint64_t lost; /* steps before this one that were not told, for want of room */
};

#ifdef __cplusplus
}
#endif

#endif
