/* pccd.h - continuous collision detection of deforming triangle meshes, as a service.
 *
 * Room:     client/lib; installed. May include: pccd_*.h. Compiles as C++.
 * Does:     connect to pccdd (or start a private one), register meshes, place them in
 *           scenes, stream vertex positions through shared memory, and read the contacts
 *           of a step.
 * Threads:  a client and everything made from it belong to one thread at a time;
 *           different clients are independent. The library has no threads of its own; the
 *           url direct: has those that compute a step. In a forked copy of the process
 *           every call with a client but pccd_close is E_DISCONNECTED.
 *
 * Every function that returns int returns 0 (PCCD_OK) or a negative status of
 * enum pccd_status, and leaves its outputs untouched on failure unless it says otherwise.
 * pccd_error_text() then says what was wrong, with names and numbers. Nothing blocks for
 * ever: every call that waits keeps the client's default timeout.
 *
 *     struct pccd_client *client;
 *     pccd_connect(NULL, &client);
 *     uint32_t scene, mesh, object;
 *     pccd_scene_create(client, NULL, &scene);
 *     pccd_mesh_create(client, x0, PCCD_FORMAT_F32, vertex_count, triangles,
 *                      triangle_count, &mesh, NULL);
 *     pccd_scene_add(client, scene, mesh, &object);
 *     for (each step) {
 *         struct pccd_answer answer;
 *         pccd_step_x1(client, scene, object, x1, PCCD_FORMAT_F32, vertex_count, NULL,
 *                      &answer);
 *         use(answer.contacts, answer.count);
 *         pccd_answer_release(client, &answer);
 *     }
 *     pccd_close(client);
 */
#ifndef PCCD_H
#define PCCD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_daemon.h"
#include "pccd_trace.h"
#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the library is built with hidden visibility */
#endif

#define PCCD_VERSION_MAJOR 0
#define PCCD_VERSION_MINOR 1
#define PCCD_VERSION_PATCH 0

struct pccd_client;

/* ---- errors ------------------------------------------------------------------------ */

/* "E_BADMSG" and "malformed message"; never NULL. [any thread] */
const char *pccd_status_name(int status);
const char *pccd_status_text(int status);

/* What was wrong with the last call on this client that failed; "" when none did. With a
 * NULL client: of the last pccd_connect of this thread. Valid until the next call. */
const char *pccd_error_text(const struct pccd_client *client);

/* "0.1.0" of the library in use. [any thread] */
const char *pccd_version(void);

/* ---- connection -------------------------------------------------------------------- */

struct pccd_options {
    size_t struct_bytes;   /* sizeof(struct pccd_options); 0 reads as that */
    const char *url;       /* "unix:PATH", or "direct:" for no daemon at all (see below);
                              NULL: $PCCD_URL, else the user's own socket */
    const char *daemon;    /* program to start for the user; NULL: $PCCD_DAEMON, else
                              pccdd beside the running program, installed, or in $PATH */
    const char *name;      /* of this client, for the daemon's log; NULL: the program's */
    int timeout_ms;        /* of every call that waits, 1 .. 3600000; 0 = 30000 */
    bool no_autostart;     /* never start a daemon */
    bool private_daemon;   /* start one of our own on a socket of our own, gone with us;
                              $PCCD_URL counts only if it is direct:, which is private */
    uint32_t slot_count;   /* of the upload ring, 1 .. 16; 0 = 4 */
    uint64_t slot_bytes;   /* payload of one slot; 0 = grown to what is needed */
    uint64_t result_bytes; /* of answers, at most; taken as needed; 0 = 64 MiB */
    uint32_t spin_us;      /* spin before blocking, 0 .. 1000; the default, when
                              struct_bytes = 0 or options = NULL: 50, or 0 with one CPU */
    int reconnect_ms;      /* how long to look for a daemon that was lost (see below);
                              0 = 10000; negative: not at all, its loss is an error */
    bool no_keep;          /* keep no copies for another daemon: saves their memory */
    int daemons_max;       /* a request over which so many daemons have ended fails;
                              0 = 4; negative: the next one gets it, whatever it does */
};

/* Options with every default filled in. */
void pccd_options_init(struct pccd_options *options);

/* Connect; `options` NULL = all defaults. With the default URL and nobody listening,
 * starts a daemon for the user. Errors: E_NODAEMON, E_VERSION, E_INVAL, E_QUOTA,
 * E_TIMEOUT, E_NOMEM, E_SYSTEM. */
int pccd_connect(const struct pccd_options *options, struct pccd_client **client);

/* Close and free, here and in the daemon; NULL is allowed. */
void pccd_close(struct pccd_client *client);

/* The socket, to watch for readability in a loop of one's own while pccd_poll has
 * E_AGAIN (other calls take answers in, too). With direct: a descriptor made by the first
 * call, or -1 when there is none to be had. */
int pccd_fd(const struct pccd_client *client);

/* The url "direct:" computes in this process, without a daemon: the same calls, answers,
 * hashes and errors. It needs libpccd-direct.so.0 beside libpccd, or where the loader
 * finds it, or where $PCCD_DIRECT says (else pccd_connect: E_SYSTEM); others do not load
 * it. What is otherwise than with a daemon:
 * - A step is computed inside pccd_frame_commit (pccd_submit_still, pccd_step_x1), by the
 *   calling thread and its OpenMP team; its answer waits for pccd_poll or pccd_wait as
 *   ever. So deadline_ns begins with the commit, and pccd_cancel comes too late, but for
 *   a frame that is held: when its deadline has come, pccd_fd of every client is
 *   readable, and pccd_poll of any sees to it. Who wants steps beside the frame gives the
 *   client to a thread of its own.
 * - The team is settings.threads - 1 further threads, of $OMP_NUM_THREADS or the
 *   processors at hand in all; with 1 there is none. They keep off the processor that
 *   the calling thread is on, which is left as it is. OpenMP's environment is the
 *   process's: GOMP_SPINCOUNT=2000 lets them sleep between steps, as in the daemon.
 * - The calls of several clients of the process are served one after the other; each has
 *   a session of its own, and all of them are freed with the last one.
 * - A warm step allocates nothing. Quotas are the machine's memory. There is nothing to
 *   reconnect to, and nothing is kept for it.
 * - A forked copy of the process cannot compute: E_DISCONNECTED, and E_STATE for another
 *   pccd_connect. */

/* When the connection is lost the library makes another one, and every call just takes
 * longer: to the same daemon, where the session goes on, or to the next one (started by
 * `pccdd --supervise`, by systemd, or by the library where it started the first), which
 * is told again what this client had: meshes, scenes, objects under their old handles,
 * what they may meet, and where they were. Steps without an answer are submitted again;
 * each is answered once, with the same bytes. A step's deadline_ns begins anew then.
 * After reconnect_ms in vain, every call fails with E_DISCONNECTED; so does a single
 * request, and nothing else, over which daemons_max daemons have ended. What does not
 * come back: further pages of an answer that the lost daemon gave (pccd_fetch: E_STATE)
 * and recordings. A call may take longer than its timeout while another daemon is told.
 * Handles that are given afterwards may be others than the lost daemon would have given.
 *
 * For this the library keeps a copy of every mesh (12 or 24 bytes a vertex, 12 a
 * triangle) and up to 24 bytes for each vertex of an object that has moved; with
 * options.no_keep neither, and only a session that still exists goes on. While the
 * connection is lost pccd_fd reads as ready; pccd_poll then tries, and does not wait. The
 * number of the descriptor stays, but epoll must be told again, when `reconnects` has
 * changed. */
struct pccd_link_info {
    uint64_t reconnects; /* connections made after one was lost */
    uint64_t resumed;    /* of these, to the same session; the others were told anew */
    uint64_t resent;     /* requests that were sent again */
    uint64_t gap_ns;     /* the last time: from the loss to the end of all that */
    uint64_t restore_ns; /* of it, telling a new daemon anew */
};
int pccd_link(const struct pccd_client *client, struct pccd_link_info *info);

/* Process id of the daemon; with direct: of this process. */
uint32_t pccd_daemon_pid(const struct pccd_client *client);

/* The instruction set that its steps use: scalar, sse4, avx2, avx512 or neon; "" from a
 * daemon that does not tell. Lives as long as the client. */
const char *pccd_daemon_cpu(const struct pccd_client *client);

/* "unix:PATH" of the daemon, or "direct:"; lives as long as the client. */
const char *pccd_url(const struct pccd_client *client);

/* Round trip through the daemon's loop, nanoseconds. */
int pccd_ping(struct pccd_client *client, uint64_t *round_trip_ns);

/* Call `each` for every counter of the daemon, in a fixed order. `text` is its
 * meaning; both strings are the library's and stay. */
typedef void (*pccd_stat_fn)(void *context, const char *name, uint64_t value,
                             const char *text);
int pccd_stats(struct pccd_client *client, pccd_stat_fn each, void *context);

/* The same for one thread, 0 .. threads-1, of the last step: what it did, and what the
 * step took. The first counter is `threads`; 0: there was no step yet (thread must be 0
 * then). `number` changes with every step. `any`: of the daemon's last step, not of this
 * client's, for root and the daemon's own user (E_ACCESS). */
int pccd_stats_thread(struct pccd_client *client, bool any, uint32_t thread,
                      pccd_stat_fn each, void *context);

/* ---- what a daemon tells about itself and its clients ------------------------------ */

/* What was agreed on when connecting; the strings live as long as the client. */
int pccd_daemon(const struct pccd_client *client, struct pccd_daemon_info *info);

/* The lists, histograms, settings and steps below need a daemon that offers them
 * (E_VERSION otherwise). A list is read entry by entry while others work: it is no
 * snapshot. `each` may not call the library with this client.
 *
 * Sessions of this client's user, the newest first, or of everybody when that user is
 * root or the daemon's own. */
typedef void (*pccd_session_fn)(void *context, const struct pccd_session_info *info);
int pccd_list_sessions(struct pccd_client *client, pccd_session_fn each, void *context);
/* What a session has, in no particular order; `session` 0: this client's own. E_HANDLE:
 * there is no such session or scene, or it is another user's. */
typedef void (*pccd_scene_fn)(void *context, const struct pccd_scene_info *info);
int pccd_list_scenes(struct pccd_client *client, uint64_t session, pccd_scene_fn each,
                     void *context);
typedef void (*pccd_object_fn)(void *context, const struct pccd_object_info *info);
int pccd_list_objects(struct pccd_client *client, uint64_t session, uint32_t scene,
                      pccd_object_fn each, void *context);
/* Pairs of a scene that ignore each other. E_NOMETHOD: the daemon is too old. */
typedef void (*pccd_pair_fn)(void *context, const struct pccd_ignored_pair *pair);
int pccd_list_pairs(struct pccd_client *client, uint64_t session, uint32_t scene,
                    pccd_pair_fn each, void *context);
typedef void (*pccd_mesh_fn)(void *context, const struct pccd_registered_mesh *info);
int pccd_list_meshes(struct pccd_client *client, uint64_t session, pccd_mesh_fn each,
                     void *context);

/* How long all steps, or all requests, took since the daemon's start. */
int pccd_histogram(struct pccd_client *client, enum pccd_histogram_kind kind,
                   struct pccd_histogram_info *info);

/* Settings that may change while the daemon runs: the one of that name (E_INVAL: there is
 * none), or with NULL each of them. */
typedef void (*pccd_setting_fn)(void *context, const struct pccd_setting *setting);
int pccd_config_get(struct pccd_client *client, const char *name, pccd_setting_fn each,
                    void *context);
/* Give one another value until the daemon ends: for root and the daemon's own user
 * (E_ACCESS). E_INVAL: no such setting or value. */
int pccd_config_set(struct pccd_client *client, const char *name, const char *value);

/* Be told of every step that is answered from now on: of a session (E_HANDLE), its number
 * 0: of all, which is for root and the daemon's own user (E_ACCESS); of one scene of it,
 * 0: of all. Nothing waits for a client that does not take them: steps that had no room
 * are counted in the next event's `lost`. Another call replaces the choice. When another
 * daemon takes the place of one that was lost, it is asked again; session numbers are
 * others then. */
int pccd_watch_start(struct pccd_client *client, uint64_t session, uint32_t scene);
/* The next step; timeout_ms < 0: the client's default. E_TIMEOUT; with 0: E_AGAIN. */
int pccd_watch_next(struct pccd_client *client, int timeout_ms,
                    struct pccd_step_event *event);
int pccd_watch_stop(struct pccd_client *client);

/* ---- meshes, scenes, objects ------------------------------------------------------- */

struct pccd_mesh_info {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t duplicate_count;  /* triangles with all corners of an earlier one */
    uint32_t degenerate_count; /* of zero area: they are tested as segments, points */
    uint32_t isolated_count;   /* vertices in no triangle; they are not tested */
    uint32_t generation;       /* 1, and one more with each pccd_mesh_replace */
    uint64_t build_ns;
};

/* Register a mesh: `x` float or double [vertex_count][3], |x| <= 1e18; `triangles`
 * [triangle_count][3]. Copied; the arrays may go afterwards. `info` may be NULL.
 * Errors: E_NOTFINITE, E_INDEX, E_QUOTA, E_LIMIT, E_INVAL. */
int pccd_mesh_create(struct pccd_client *client, const void *x, enum pccd_format format,
                     uint32_t vertex_count, const uint32_t (*triangles)[3],
                     uint32_t triangle_count, uint32_t *mesh,
                     struct pccd_mesh_info *info);
/* Give a mesh other vertices and triangles, as when a body breaks: the handle stays, and
 * every object made of it, in any scene of this client, takes the new ones at the
 * positions given here. The mesh and its objects go on as they were until all has
 * arrived, and for good when this fails: E_QUOTA and E_NOMEM too (old and new are held at
 * once), E_BUSY, and the errors of pccd_mesh_create. Steps submitted before are computed
 * with the old vertices; edges and feature numbers of the old mesh mean nothing later. */
int pccd_mesh_replace(struct pccd_client *client, uint32_t mesh, const void *x,
                      enum pccd_format format, uint32_t vertex_count,
                      const uint32_t (*triangles)[3], uint32_t triangle_count,
                      struct pccd_mesh_info *info);
/* The unique edges in the order of the records' feature numbers, copied to
 * edges[info.edge_count]. */
int pccd_mesh_edges(struct pccd_client *client, uint32_t mesh, struct pccd_edge *edges,
                    uint32_t edge_count);
int pccd_mesh_destroy(struct pccd_client *client, uint32_t mesh);

/* How the trees that the method paper uses are built and kept. All zeros are the
 * defaults; the answers never depend on any of it. */
struct pccd_scene_settings {
    enum pccd_quality quality;      /* 0 = median */
    uint32_t rebuild_triangles_max; /* a subtree of up to so many is built anew at once;
                                       larger ones aside, a share a step; 0 = 1024 */
    double rebuild_ratio;  /* a subtree is built anew when the volume of its box is less
                             than so much of its two halves', which overlap then;
                             up to 1; 0 = 0.9; negative: never */
    const char *name;      /* of one to share (below), 1 .. 255 bytes; NULL: none */
    enum pccd_share share; /* of a named one: make it, or take part */
    uint32_t rights;       /* of one that is made: as a file's, of 0666; 0 = 0600 */
};

/* An empty scene; `settings` NULL: the defaults. Errors: E_INVAL, E_LIMIT, E_BUSY; of
 * a named scene E_STATE (there is one), E_AGAIN (there is none yet, to take part in),
 * E_ACCESS, E_VERSION (the daemon knows no such scenes). */
int pccd_scene_create(struct pccd_client *client,
                      const struct pccd_scene_settings *settings, uint32_t *scene);
int pccd_scene_destroy(struct pccd_client *client, uint32_t scene);
/* Take part in another user's scene of that name. Errors as above. */
int pccd_scene_join(struct pccd_client *client, uint32_t owner, const char *name,
                    uint32_t *scene);
/* An object is an instance of a mesh, placed at the mesh's registered positions. */
int pccd_scene_add(struct pccd_client *client, uint32_t scene, uint32_t mesh,
                   uint32_t *object);
int pccd_scene_remove(struct pccd_client *client, uint32_t scene, uint32_t object);

/* The boxes of a level of a scene's hierarchies, the root being level 0, as the last step
 * that used the tree left them (answer.method says which one did): up to `room` of them
 * to `boxes`, which may be NULL with room 0. *count: how many the level has; 0: there is
 * no such level, or no step has used the tree since objects came or went. Errors:
 * E_HANDLE, E_INVAL, E_BUSY (release answers first), E_NOMETHOD (an older daemon). */
int pccd_scene_boxes(struct pccd_client *client, uint32_t scene, enum pccd_tree tree,
                     uint32_t level, struct pccd_box *boxes, uint32_t room,
                     uint32_t *count);

/* Scenes that clients share; each user's have names of their own. Whoever makes one says
 * who else may take part, by user and groups of their processes: to read, which is to
 * know of its steps and fetch their answers, or also to write: add objects, step. An
 * object is moved and removed by the client that added it alone, and goes with it; the
 * scene goes with the last client. Steps of one client move its own objects, others
 * stand still: to move objects of several clients over the same time, all but one submit
 * frames with `hold` (struct pccd_step_settings), which wait for a step of the scene, go
 * along with it, and are answered with its numbers. After a crash of the daemon each
 * client brings its own objects back. */
struct pccd_scene_news {
    uint64_t number; /* of the step among those of the scene, from 1 */
    enum pccd_mode mode;
    enum pccd_incomplete incomplete;
    uint64_t total;
    uint64_t hash[2]; /* as in struct pccd_answer */
};

/* What an object may meet. Two objects of a scene are tested against each other if
 * a.group & b.mask and b.group & a.mask are not 0, and the pair is not ignored; an object
 * is tested against itself if its self_collision is on. At first group is 1, mask all
 * bits, self_collision on. It stays with the object when its mesh is replaced. */
struct pccd_object_settings {
    size_t struct_bytes;  /* sizeof(struct pccd_object_settings); 0 reads as that */
    uint32_t what;        /* which of these to set: bits of enum pccd_object_what */
    bool self_collision;  /* PCCD_OBJECT_SELF */
    uint64_t group;       /* PCCD_OBJECT_GROUP: the groups that it is in */
    uint64_t mask;        /* PCCD_OBJECT_MASK: the groups that it may meet */
};

/* Set what settings->what names, for steps that are submitted from now on. Errors:
 * E_HANDLE, E_INVAL; E_VERSION: a daemon that does not know of filters. */
int pccd_object_set(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const struct pccd_object_settings *settings);
/* All of them as they are; struct_bytes is not looked at, and stays. */
int pccd_object_get(struct pccd_client *client, uint32_t scene, uint32_t object,
                    struct pccd_object_settings *settings);
/* Have two objects ignore each other, or not any more; as often as you like. Removing
 * either ends it. Errors as above; E_LIMIT: 262144 pairs of a scene do already. In a
 * scene that is shared E_ACCESS: neither is this client's (above: it is not). Another
 * daemon is not told of pairs with another client's object, which comes back as a new
 * one. */
int pccd_pair_ignore(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                     uint32_t object_b, bool ignored);

/* ---- steps ------------------------------------------------------------------------- */

/* Motion is linear: in a step every vertex goes straight from its start to its end with
 * constant speed, also where transforms are given. So a point that turns, at a distance
 * rho from the axis, by theta (radians) in k equal steps, is up to
 * rho (1 - cos(theta / (2k))) <= rho theta^2 / (8 k^2) off the true turn, and within
 * delta of it with k >= theta sqrt(rho / (8 delta)). An arm of 1 m that turns by 90
 * degrees in one step is up to 29 cm off, and passes what is there without a contact; 18
 * steps keep it within 1 mm. */
struct pccd_step_settings {
    enum pccd_mode mode;     /* 0 = all */
    enum pccd_method method; /* 0 = the daemon's default */
    uint32_t threads;        /* at most; 0 = the daemon decides. The answer never depends
                                on it */
    enum pccd_scheduler scheduler;   /* how threads share the work; 0 = the daemon's */
    enum pccd_high_level high_level; /* default, as the next one */
    enum pccd_refit refit;
    double tolerance;     /* bounds toi_hi - toi from above, 1e-12 .. 1; 0 = 1e-6 */
    uint64_t deadline_ns; /* after it the answer is incomplete; 0 = none */
    bool hold;            /* in a shared scene: move with the next step of another
                             client. One frame of a client and scene waits at a time
                             (E_BUSY). Answered by that step, without records, which
                             pccd_scene_read has; or at its deadline, or cancelled: then
                             it goes along nevertheless */
};

/* Nanoseconds. `low` and `high` divide traversal + tests between low-level and high-level
 * nodes; `rebuild` is the reconstruction in it, the sum over all threads. */
struct pccd_step_times {
    uint64_t queue, ingest, refit, traversal, tests, merge, step, low, high, rebuild;
};

/* rebuilds: subtrees built anew during the traversal; swaps: large ones, built aside over
 * several steps, that were put in place; both with the triangles in them. candidates:
 * pairs whose feature boxes overlap; the method wide may leave out those that no time
 * brings together, except in mode pairs. */
struct pccd_step_counters {
    uint64_t task_units, box_tests, leaf_pairs, candidates_vf, candidates_ee, survivors,
        exact, builds, allocs, rebuilds, rebuilt_triangles, swaps, swapped_triangles;
};

/* The answer to one step. `contacts` (or `pairs`) lie in memory that the daemon shares:
 * read-only, valid until pccd_answer_release. */
struct pccd_answer {
    uint64_t step; /* as returned by pccd_submit */
    int status;    /* 0, or why the step failed: then nothing else is set
                                       and positions are as before; pccd_error_text says
                                       more */
    enum pccd_mode mode;
    enum pccd_method method;
    enum pccd_incomplete incomplete;     /* 0: complete */
    enum pccd_verdict verdict;           /* mode any; in others PCCD_VERDICT_NONE */
    const struct pccd_contact *contacts; /* [count]; NULL in mode pairs or without any */
    const struct pccd_pair *pairs;       /* [count]; NULL in other modes or without any */
    uint64_t count;                      /* records of this page */
    uint64_t first;                      /* index of the page's first record */
    uint64_t cursor; /* next page begins here; = total on the last page */
    uint64_t total;  /* records of the whole answer */
    uint64_t vf, ee, possible, initial;
    double toi_first; /* smallest toi; 2 without any record, in modes any and pairs */
    uint64_t hash[2]; /* XXH3-128 over all records: high, low */
    uint64_t number;  /* of the step among all of its scene, from 1 */
    uint32_t threads;
    enum pccd_scheduler scheduler;   /* what was used; 0: one thread had nothing to */
    enum pccd_high_level high_level; /* share, or there was no such phase */
    enum pccd_refit refit;
    struct pccd_step_times times;
    struct pccd_step_counters counters;
    uint64_t reserved[2]; /* the library's */
};

/* The last step that another client has made in a shared scene; steps may be left out,
 * the last never is. Waits for one that has not been told yet, up to timeout_ms; < 0: the
 * client's default; 0: does not wait. pccd_fd is readable when there may be one. Errors:
 * E_AGAIN (timeout_ms = 0), E_TIMEOUT. */
int pccd_scene_wait(struct pccd_client *client, uint32_t scene, int timeout_ms,
                    struct pccd_scene_news *news);
/* A page of the answer to step `number` of a shared scene, whoever made it, while it is
 * the last one (else E_STATE); to be released as any other. */
int pccd_scene_read(struct pccd_client *client, uint32_t scene, uint64_t number,
                    uint64_t cursor, struct pccd_answer *answer);

/* A step being written: a slot of the upload ring. */
struct pccd_frame {
    struct pccd_client *client;
    uint32_t scene;
    uint32_t slot;
    uint32_t segment_count;
    uint32_t segment_max;
    uint64_t used_bytes;
};

/* Bytes of slot payload that `segment_max` segments with `payload_bytes` of data need. */
uint64_t pccd_frame_bytes(uint32_t segment_max, uint64_t payload_bytes);

/* Take a free slot for a step of up to segment_max segments and payload_bytes of
 * positions: 12 (F32) or 24 (F64) bytes a vertex, twice that for both ends, 192 for a
 * rigid segment; the rounding of each range up to 8 bytes is the library's affair. Grows
 * the ring when nothing is in flight and the slot is too small. Waits for a slot to come
 * back when all are in flight, up to the timeout. Errors: E_BUSY (all slots are begun; 32
 * answers wait to be taken; the ring must grow while answers with records are held),
 * E_LIMIT, E_QUOTA, E_TIMEOUT. */
int pccd_frame_begin(struct pccd_client *client, uint32_t scene, uint32_t segment_max,
                     uint64_t payload_bytes, struct pccd_frame *frame);
/* Add a segment and get the memory to write its positions to: packed [count][3] of
 * `format`. Write before commit; never read it. E_LIMIT: more than was announced. */
int pccd_frame_x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                  uint32_t first, uint32_t count, void **x1);
int pccd_frame_x0x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                    uint32_t first, uint32_t count, void **x0, void **x1);
/* Transforms for both ends, rows of [R | t], applied to registered positions in double:
 * ((r0 x + r1 y) + r2 z) + t, each operation rounded by itself. In between vertices go
 * straight. `count` may be less than all: other segments may move the others. */
int pccd_frame_rigid(struct pccd_frame *frame, uint32_t object, uint32_t first,
                     uint32_t count, const double m0[12], const double m1[12]);
/* Publish and submit. `settings` may be NULL. The slot belongs to the daemon afterwards,
 * also on failure. *step numbers the step, from 1. */
int pccd_frame_commit(struct pccd_frame *frame, const struct pccd_step_settings *settings,
                      uint64_t *step);
/* Give the slot back unsent. */
void pccd_frame_abort(struct pccd_frame *frame);

/* A step in which nothing moves. */
int pccd_submit_still(struct pccd_client *client, uint32_t scene,
                      const struct pccd_step_settings *settings, uint64_t *step);

/* Take one finished answer, oldest first, without waiting: E_AGAIN if there is none. A
 * step that failed is an answer too: then 0 is returned and answer->status says why. */
int pccd_poll(struct pccd_client *client, struct pccd_answer *answer);
/* Wait for the answer to `step`; timeout_ms < 0: the client's default, 0: like poll.
 * Returns the step's status: on failure of the step its code. */
int pccd_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
              struct pccd_answer *answer);
/* Wait until a frame that was committed with `hold` waits for another client's step: the
 * next step of the scene takes it along. 0 as well when it has been answered; it is to be
 * taken as ever. timeout_ms < 0: the client's default. Errors: E_AGAIN (timeout_ms = 0),
 * E_TIMEOUT; E_INVAL: no such step; E_VERSION: the daemon is too old to tell. */
int pccd_wait_held(struct pccd_client *client, uint64_t step, int timeout_ms);
/* The page that begins at `cursor`, of the answer to `step`, the last of `scene`. Release
 * the page at hand first when the region is full. E_STATE: the answer is gone: another
 * step has run, or an object was removed or got another shape since. */
int pccd_fetch(struct pccd_client *client, uint32_t scene, uint64_t step, uint64_t cursor,
               struct pccd_answer *answer);
/* Give the records back. Pages may be released in any order. Safe on an answer without
 * records and after a failure. */
void pccd_answer_release(struct pccd_client *client, struct pccd_answer *answer);
/* Stop a submitted step: unless it is done, its answer is incomplete: CANCELLED. */
int pccd_cancel(struct pccd_client *client, uint64_t step);

/* Begin, copy, commit and wait in one: one object, its first vertex_count vertices (the
 * others stand still; E_SEGMENT: it has not so many). On failure either answer->status
 * says so or the answer is untouched; a step that timed out is cancelled. */
int pccd_step_x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                 const void *x1, enum pccd_format format, uint32_t vertex_count,
                 const struct pccd_step_settings *settings, struct pccd_answer *answer);
int pccd_step_x0x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                   const void *x0, const void *x1, enum pccd_format format,
                   uint32_t vertex_count, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer);

/* ---- recording a session ----------------------------------------------------------- */

/* Everything that this client asks and is answered, in a file that `pccdctl replay` runs
 * again: what is registered now first, then the log. Each event is one write by the
 * thread that calls, so that a crash at any moment loses nothing before it; positions are
 * read out of the slot when the step has been sent. With $PCCD_RECORD=PATH in the
 * environment every client is recorded from the beginning, to PATH, PATH-2, ...;
 * $PCCD_RECORD_OPTIONS holds settings, as "max_bytes=N,segments=N,contacts=1,level=N".
 * What is done to a shared scene, by whomever, the daemon keeps (up to 128 MiB a scene,
 * charged as shared memory) until this client's next call fetches it. Such a recording
 * ends with E_LIMIT if that is not soon enough, with E_DISCONNECTED when another daemon
 * takes the place of a lost one, with E_VERSION where the daemon keeps nothing, and with
 * E_STATE where it is in several segments. */
struct pccd_record_settings {
    uint64_t max_bytes; /* of all files; 0: no bound */
    uint32_t segments;  /* 0, 1: one file, which ends when it is full. 2 .. 64: so many,
                           each whole by itself, the oldest of which goes: PATH is being
                           written, PATH.1, PATH.2, ... are older (and overwritten). They
                           keep the bound but for a step and the answers in flight */
    uint32_t contacts;  /* 1: the records of answers, too: the pages that came */
    int32_t level;      /* of zstd, 1 .. 19; 0 = 1; negative: nothing is compressed */
    uint32_t reserved;  /* 0 */
};
struct pccd_record_info {
    uint64_t bytes;     /* written, over all segments */
    uint64_t raw_bytes; /* the same before compression */
    uint64_t frames;    /* steps */
    uint64_t answers;
    uint64_t ns;       /* that recording steps and answers has taken from the caller */
    uint32_t segments; /* begun */
    int32_t status;    /* 0, or why nothing is recorded any more: E_LIMIT (full),
                          E_SYSTEM, E_NOMEM, or as above for a shared scene. No
                          other call ever fails because of that */
};
/* Begin; `settings` NULL: the defaults. E_SYSTEM: the file cannot be made, or is there
 * already; E_STATE: a recording is under way, or something was registered that was not
 * kept (options.no_keep, direct:); E_LIMIT: a segment cannot hold twice what is
 * registered. */
int pccd_record_start(struct pccd_client *client, const char *path,
                      const struct pccd_record_settings *settings);
/* How it goes; E_STATE: there is none. */
int pccd_record(const struct pccd_client *client, struct pccd_record_info *info);
/* End it, as pccd_close does. Returns info->status; `info` may be NULL. */
int pccd_record_stop(struct pccd_client *client, struct pccd_record_info *info);
/* The next scene, mesh or object that is made gets this handle, if nothing has it; else
 * E_HANDLE. For who repeats what a session did: handles stand in the records. */
int pccd_want(struct pccd_client *client, uint32_t handle);

/* ---- recordings of the daemon's threads -------------------------------------------- */

struct pccd_trace_info {
    uint32_t threads;    /* of the team, whose events are kept */
    uint32_t events_max; /* kept of each, and of the loop */
    uint64_t events;     /* after the end: that can be read */
    uint64_t lost;       /* older ones that newer ones have taken the place of */
};

/* Record what the daemon does, for all its clients: allowed to its own user and root
 * (E_ACCESS), one recording at a time (E_BUSY: another client's; E_STATE: this one's).
 * events: to keep of each thread, the newest; 0 = 65536, or what fits (E_LIMIT). min_ns:
 * task units, subtrees and pairs that took less are left out. `info` may be NULL. */
int pccd_trace_start(struct pccd_client *client, uint32_t events, uint64_t min_ns,
                     struct pccd_trace_info *info);
/* End it: sets info->events and lost. It can be read until the next start or close. */
int pccd_trace_stop(struct pccd_client *client, struct pccd_trace_info *info);
/* Call `each` with the events, some thousands at a time: those of one thread after those
 * of the other, then the loop's and the clients', each in the order of their ends. They
 * lie in shared memory and are gone when `each` returns. */
typedef void (*pccd_trace_fn)(void *context, const struct pccd_trace_event *events,
                              uint32_t count);
int pccd_trace_dump(struct pccd_client *client, pccd_trace_fn each, void *context);
/* "frame.submit": the method of a request in a recording; NULL: not known to this
 * library. [any thread] */
const char *pccd_method_name(uint32_t number);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
