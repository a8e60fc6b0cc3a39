/* pccd.h - find every collision between moving triangle meshes: the whole library.
 *
 * You give the positions of all vertices at the beginning and at the end of a time step.
 * The answer says which vertices hit which faces and which edges hit which edges, when,
 * and where. A daemon, pccdd, computes it; with the url direct: this process does.
 *
 * Threads:  a client and everything made from it belong to one thread at a time. While
 *           one is in a call, another one's call is E_BUSY and does nothing; what returns
 *           nothing, such as pccd_answer_release, waits until the first is out. A program
 *           with several threads connects a client for each. The library has no threads
 *           of its own; the url direct: has those that compute a step. In a forked copy
 *           of the process every call with a client but pccd_close is E_DISCONNECTED.
 *
 * Every function that returns int returns 0 (PCCD_OK) or a negative status of
 * enum pccd_status, and leaves its outputs untouched on failure unless it says otherwise.
 * pccd_error_text() then says what was wrong, with names and numbers. Every call that
 * waits ends after the client's default timeout at the latest.
 *
 *     struct pccd_client *client;
 *     pccd_connect(NULL, &client);
 *     uint32_t scene, mesh, object;
 *     pccd_scene_create(client, NULL, &scene);
 *     pccd_mesh_create(client, x0, PCCD_FORMAT_F32, vertex_count, triangles,
 *                      triangle_count, &mesh, NULL);
 *     pccd_scene_add(client, scene, mesh, &object);
 *     for (each step) {
 *         struct pccd_answer answer = PCCD_ANSWER_INIT;
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

#include "pccd_batch.h"
#include "pccd_daemon.h"
#include "pccd_near.h"
#include "pccd_trace.h"
#include "pccd_points.h"
#include "pccd_rays.h"
#include "pccd_turning.h"
#include "pccd_types.h"
#include "pccd_weld.h"

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

/* Return a status as its name, "E_BADMSG", or as a text, "malformed message"; never NULL.
 * [any thread] */
const char *pccd_status_name(int status);
const char *pccd_status_text(int status);

/* Return why the most recent failed call on this client failed, as a sentence; "" when
 * none has. With a NULL client it is about the last call of this thread that has none:
 * pccd_connect, pccd_weld, all of pccd_points.h, pccd_joints_... of pccd_turning.h.
 * Handles stand in it as hexadecimal numbers. Valid until the next call. */
const char *pccd_error_text(const struct pccd_client *client);

/* Return the version of the library in use, as "0.1.0". [any thread] */
const char *pccd_version(void);

/* ---- connection -------------------------------------------------------------------- */

struct pccd_options {
    size_t struct_bytes;   /* sizeof(struct pccd_options); 0 reads as that */
    const char *url;       /* "unix:PATH", or "direct:" for no daemon at all (see below);
                              NULL: $PCCD_URL, else the user's own socket */
    const char *daemon;    /* program to start for the user; NULL: $PCCD_DAEMON, else
                              pccdd beside the running program or this library,
                              installed, or in $PATH */
    const char *name;      /* of this client, for the daemon's log; NULL: the program's */
    int timeout_ms;        /* of every call that waits, 1 .. 3600000; 0 = 30000 */
    bool no_autostart;     /* never start a daemon */
    bool private_daemon;   /* start a daemon for this client alone, which ends with it;
                              $PCCD_URL counts only if it is direct:, which is private */
    uint32_t slot_count;   /* of the upload ring, 1 .. 16; 0 = 4; from the third on they
                              get memory when they are first used */
    uint64_t slot_bytes;   /* payload of one slot; 0 = grown to what is needed */
    uint64_t result_bytes; /* of answers, at most; taken as needed; 0 = 64 MiB */
    uint32_t spin_us;      /* spin before blocking, 0 .. 1000, seldom while nothing comes
                              meanwhile; the default, when struct_bytes = 0 or options =
                              NULL: 200, or 0 with one CPU */
    int reconnect_ms;      /* how long to look for a daemon that was lost (see below);
                              0 = 10000; negative: not at all, its loss is an error */
    bool no_keep;          /* keep no copies for another daemon: saves their memory */
    bool observes;         /* it only lists (not pairs), watches, reads counters and sets
                              settings, all else is E_STATE: the first eight such clients
                              of a user take no place of its clients */
    int daemons_max;       /* a request fails after so many daemons have ended over it
                              (see below); 0 = 4; negative: it never does */
    /* For languages that hand out arrays in the library's memory and cannot take them
     * back: any function that has a client, pccd_close included, calls this instead of
     * munmap for the memory of frames and answers. It must call munmap(memory, bytes)
     * when no array lies there any more. NULL: the library calls munmap at once. */
    void (*unmap)(void *context, void *memory, size_t bytes);
    void *unmap_context;
};

/* Fill in every default. (Options have no ..._INIT: they are asked for once.) */
void pccd_options_init(struct pccd_options *options);

/* Connect; `options` NULL = all defaults. With the default URL and nobody listening,
 * starts a daemon for the user. Errors: E_NODAEMON, E_VERSION, E_INVAL, E_QUOTA,
 * E_TIMEOUT, E_NOMEM, E_SYSTEM. */
int pccd_connect(const struct pccd_options *options, struct pccd_client **client);

/* Close and free, here and in the daemon; NULL is allowed. Nothing that was made with the
 * client may be used afterwards, answers and frames included, but for its batches: a call
 * with one of these is E_DISCONNECTED. In a callback of the same client it does
 * nothing. */
void pccd_close(struct pccd_client *client);

/* Return the socket, for an event loop of your own. Call pccd_poll until it returns
 * E_AGAIN, then wait until the socket is readable; other calls may have received answers,
 * too. With direct: it is a descriptor that the first call makes, or -1 when there is
 * none. */
int pccd_fd(const struct pccd_client *client);

/* The url "direct:" computes in this process, without a daemon: the same calls, answers,
 * hashes and errors. It needs libpccd-direct.so.0 beside libpccd, or where the loader
 * finds it, or where $PCCD_DIRECT says (else pccd_connect: E_SYSTEM); other URLs do not
 * load it. These things differ from a daemon:
 * - A step is computed inside pccd_frame_commit (pccd_submit_still, pccd_step_x1), by the
 *   calling thread and its OpenMP team; its answer waits for pccd_poll or pccd_wait as
 *   ever. So deadline_ns begins with the commit, and pccd_cancel comes too late. No
 *   timeout ends a step, deadline_ns alone does: one in which a chain of joints turns
 *   near 2^20 turns may take minutes. A frame that is held can still be cancelled; when
 *   its deadline has come, pccd_fd of every client is readable, and pccd_poll of any of
 *   them answers it. To compute steps while your program draws, give the client to a
 *   thread of its own.
 * - The team is settings.threads - 1 further threads, of $OMP_NUM_THREADS or the
 *   processors at hand in all; with 1 there is none. They keep off the processor that
 *   the calling thread is on, which is left as it is. OpenMP's environment is the
 *   process's: GOMP_SPINCOUNT=2000 lets them sleep between steps, as in the daemon.
 * - It computes to nearest and with subnormal numbers, however the calling thread and the
 *   threads of its team compute (fesetround, -ffast-math, traps), and gives them back as
 *   they were.
 * - The calls of several clients of the process are served one after the other; each has
 *   a session of its own, and all of them are freed with the last one.
 * - A step like the one before it allocates nothing. The only quota is the machine's
 *   memory. There is nothing to reconnect to, so no copies are kept for that.
 * - A forked copy of the process cannot compute: E_DISCONNECTED, and E_STATE for another
 *   pccd_connect. */

/* When the connection is lost, the library makes another one, and every call just takes
 * longer. For example, the daemon crashes while pccd_wait waits: pccd_wait returns the
 * answer some milliseconds later. What happens meanwhile:
 * 1. The library connects again. If the same daemon still runs, the session goes on.
 * 2. Otherwise it tells the next daemon what this client had: meshes, scenes, objects
 *    under their old handles, what they may meet, and where they were. The next daemon is
 *    started by `pccdd --supervise`, by systemd, or by the library where it started the
 *    first.
 * 3. Steps without an answer are submitted again; each is answered once, with the same
 *    bytes. A step's deadline_ns begins again then.
 * What to know:
 * - After reconnect_ms without success every call fails with E_DISCONNECTED. A request
 *   also fails if daemons_max daemons have ended while it was the oldest one without
 *   an answer: it is probably what ends them. Other requests go on.
 * - Further pages of an answer that the lost daemon gave do not come back (pccd_fetch:
 *   E_STATE), nor does a trace of the daemon's threads.
 * - A call may take longer than its timeout while another daemon is told.
 * - Handles that are given later may differ from those of the lost daemon.
 * - The library keeps a copy of every mesh for this (12 or 24 bytes a vertex, 12 a
 *   triangle), and up to 24 bytes for each vertex of an object that has moved. With
 *   options.no_keep it keeps neither, and goes on only with a session that still exists.
 * - While the connection is lost, pccd_fd reads as ready; pccd_poll then tries, and does
 *   not wait. The number of the descriptor stays, but epoll must be told again when
 *   `reconnects` has changed. */
struct pccd_link_info {
    uint64_t reconnects; /* connections made after one was lost */
    uint64_t resumed;    /* of these, to the same session; others to a new daemon */
    uint64_t resent;     /* requests that were sent again */
    uint64_t gap_ns;     /* the last time: from the loss until all was as before */
    uint64_t restore_ns; /* of it: registering everything with a new daemon */
};
int pccd_link(const struct pccd_client *client, struct pccd_link_info *info);

/* Return the process id of the daemon; with direct: of this process. */
uint32_t pccd_daemon_pid(const struct pccd_client *client);

/* Return the instruction set that its steps use: scalar, sse2, sse4, avx2, avx512 or
 * neon; "" from a daemon that does not tell. Lives as long as the client. */
const char *pccd_daemon_cpu(const struct pccd_client *client);

/* Return "unix:PATH" of the daemon, or "direct:"; lives as long as the client. */
const char *pccd_url(const struct pccd_client *client);

/* Measure a round trip through the daemon's loop, in nanoseconds. */
int pccd_ping(struct pccd_client *client, uint64_t *round_trip_ns);

/* Call `each` for every counter of the daemon, in a fixed order. `text` is its
 * meaning; both strings are the library's and stay. */
typedef void (*pccd_stat_fn)(void *context, const char *name, uint64_t value,
                             const char *text);
int pccd_stats(struct pccd_client *client, pccd_stat_fn each, void *context);

/* Call `each` for every counter of one thread of this client's last step: what it did,
 * and what the step took. Ask for thread 0 first: the first counter, `threads`, says how
 * many there were; 0 if there was no step yet. `number` changes with every step; a batch
 * is one, and `batch` its scenes. `any`: the last step of the daemon instead, whoever
 * made it; for root and the daemon's own user (E_ACCESS). `tuning` gets how the threads
 * shared the work, as in struct pccd_answer, or is NULL. */
int pccd_stats_thread(struct pccd_client *client, bool any, uint32_t thread,
                      pccd_stat_fn each, void *context, char tuning[PCCD_TUNING_BYTES]);

/* ---- what a daemon tells about itself and its clients ------------------------------ */

/* Tell what was agreed on when connecting; the strings live as long as the client. */
int pccd_daemon(const struct pccd_client *client, struct pccd_daemon_info *info);

/* A list is no snapshot: it is read entry by entry, while other clients go on, and told
 * by `each` when all is read. If another daemon takes the place of the one that is asked,
 * the list is its own; E_HANDLE of a session that only the other one had. `each` may not
 * call the library with this client.
 *
 * List the sessions of this client's user, the newest first, or of everybody when that
 * user is root or the daemon's own. */
typedef void (*pccd_session_fn)(void *context, const struct pccd_session_info *info);
int pccd_list_sessions(struct pccd_client *client, pccd_session_fn each, void *context);
/* Walk through what a session has, in no particular order; `session` 0: this client's
 * own. E_HANDLE: there is no such session or scene, or it is another user's. */
typedef void (*pccd_scene_fn)(void *context, const struct pccd_scene_info *info);
int pccd_list_scenes(struct pccd_client *client, uint64_t session, pccd_scene_fn each,
                     void *context);
typedef void (*pccd_object_fn)(void *context, const struct pccd_object_info *info);
int pccd_list_objects(struct pccd_client *client, uint64_t session, uint32_t scene,
                      pccd_object_fn each, void *context);
/* List the pairs of a scene that ignore each other. E_NOMETHOD: the daemon is too old. */
typedef void (*pccd_pair_fn)(void *context, const struct pccd_ignored_pair *pair);
int pccd_list_pairs(struct pccd_client *client, uint64_t session, uint32_t scene,
                    pccd_pair_fn each, void *context);
typedef void (*pccd_mesh_fn)(void *context, const struct pccd_registered_mesh *info);
int pccd_list_meshes(struct pccd_client *client, uint64_t session, pccd_mesh_fn each,
                     void *context);

/* Read how long all steps, or all requests, took since the daemon's start. */
int pccd_histogram(struct pccd_client *client, enum pccd_histogram_kind kind,
                   struct pccd_histogram_info *info);

/* Tell the settings that may change while the daemon runs: the one of that name (E_INVAL:
 * there is none), or with NULL each of them. */
typedef void (*pccd_setting_fn)(void *context, const struct pccd_setting *setting);
int pccd_config_get(struct pccd_client *client, const char *name, pccd_setting_fn each,
                    void *context);
/* Give one another value until the daemon ends: for root and the daemon's own user
 * (E_ACCESS). E_INVAL: no such setting or value. */
int pccd_config_set(struct pccd_client *client, const char *name, const char *value);

/* Ask to be told of every step that is answered from now on. `session`: of this session
 * (E_HANDLE: there is none); 0: of all sessions, for root and the daemon's own user only
 * (E_ACCESS). `scene`: of this scene of the session; 0: of all. Nothing waits for a
 * client that does not take the events: steps that had no room are counted in `lost` of
 * the next event. Another call replaces the choice. When another daemon takes the place
 * of one that was lost, the library asks it, too; session numbers differ then. */
int pccd_watch_start(struct pccd_client *client, uint64_t session, uint32_t scene);
/* Get the next step, or wait for it; timeout_ms < 0: the client's default. E_TIMEOUT;
 * with 0: E_AGAIN. E_STATE: pccd_watch_start comes first. */
int pccd_watch_next(struct pccd_client *client, int timeout_ms,
                    struct pccd_step_event *event);
int pccd_watch_stop(struct pccd_client *client);

/* ---- meshes, scenes, objects ------------------------------------------------------- */

struct pccd_mesh_info {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t duplicate_count;  /* triangles with all corners of an earlier one */
    uint32_t degenerate_count; /* of zero area: tested as segments or points */
    uint32_t isolated_count;   /* vertices that nothing names; they are not tested */
    uint32_t generation;       /* 1, and one more with each pccd_mesh_replace */
    uint64_t build_ns;
    uint32_t free_edge_count;  /* edges that no triangle has */
    uint32_t free_point_count; /* named points that no triangle and no edge has */
};

/* Register a mesh: `x` float or double [vertex_count][3], |x| <= 1e18; `triangles`
 * [triangle_count][3]. The arrays are copied. `info` may be NULL.
 * Errors: E_NOTFINITE, E_INDEX, E_QUOTA, E_LIMIT, E_INVAL. */
int pccd_mesh_create(struct pccd_client *client, const void *x, enum pccd_format format,
                     uint32_t vertex_count, const uint32_t (*triangles)[3],
                     uint32_t triangle_count, uint32_t *mesh,
                     struct pccd_mesh_info *info);
/* Replace the vertices and triangles of a mesh, as when a body breaks. The handle stays.
 * Every object made of the mesh, in any scene of this client, gets the new shape at the
 * positions given here. Steps submitted before are computed with the old shape. Edges and
 * feature numbers of the old shape mean nothing later. When the call fails, the mesh and
 * its objects stay as they were. Errors: those of pccd_mesh_create, E_BUSY, E_QUOTA and
 * E_NOMEM (old and new are held at the same time). */
int pccd_mesh_replace(struct pccd_client *client, uint32_t mesh, const void *x,
                      enum pccd_format format, uint32_t vertex_count,
                      const uint32_t (*triangles)[3], uint32_t triangle_count,
                      struct pccd_mesh_info *info);
/* Everything that a mesh can have. */
struct pccd_mesh_data {
    size_t struct_bytes; /* sizeof(struct pccd_mesh_data); 0 reads as that */
    const void *x;       /* [vertex_count][3], of `format` */
    enum pccd_format format;
    uint32_t vertex_count, triangle_count;
    const uint32_t *triangles; /* [triangle_count][3], one behind the other */
    const double *radii; /* [vertex_count], 0 .. 1e18, for objects that have no radius of
                            their own (struct pccd_object_settings): a feature has the
                            largest of its vertices. NULL: none */
    /* Edges (rods) and points (clouds) that are named by themselves; there may be no
     * triangle then. One that a triangle has is that; an edge whose ends are the same
     * names a point; a point that a triangle or an edge has is a vertex of it. All others
     * are free: an edge of a rod meets edges, its ends and points meet faces, whatever
     * their distance; a point meets free edges and points (PCCD_VE, PCCD_VV) only where a
     * radius or a separation keeps them apart. */
    const uint32_t *edges;  /* [edge_count][2] */
    const uint32_t *points; /* [point_count] */
    uint32_t edge_count, point_count;
};
/* Create a mesh where *mesh is 0, as pccd_mesh_create; else replace *mesh, as
 * pccd_mesh_replace. The errors of both; also E_INVAL: a radius that is negative or not
 * finite, E_LIMIT: one above 1e18. */
int pccd_mesh_put(struct pccd_client *client, const struct pccd_mesh_data *data,
                  uint32_t *mesh, struct pccd_mesh_info *info);
/* Copy the unique edges, info.edge_count of them, in the order of the records' feature
 * numbers; edge_count says for how many there is room. E_INVAL: for fewer than there are;
 * E_BUSY: no room in the memory for answers; release answers first. */
int pccd_mesh_edges(struct pccd_client *client, uint32_t mesh, struct pccd_edge *edges,
                    uint32_t edge_count);
int pccd_mesh_destroy(struct pccd_client *client, uint32_t mesh);

/* Settings of a new scene: with whom it is shared. All zeros: with nobody. */
struct pccd_scene_settings {
    const char *name; /* of a shared scene (below), 1 .. 255 bytes; NULL: not shared */
    enum pccd_share share; /* with a name: make the scene, or take part in it */
    uint32_t rights;       /* of a scene that is made: like a file's, bits of 0666;
                             0 = 0600 */
};

/* Create an empty scene; `settings` NULL: the defaults. Errors: E_INVAL, E_LIMIT, E_BUSY;
 * of a named scene E_STATE (there is one), E_AGAIN (there is none yet, to take part in),
 * E_ACCESS. */
int pccd_scene_create(struct pccd_client *client,
                      const struct pccd_scene_settings *settings, uint32_t *scene);
int pccd_scene_destroy(struct pccd_client *client, uint32_t scene);
/* Take part in another user's scene of that name. Errors as above. */
int pccd_scene_join(struct pccd_client *client, uint32_t owner, const char *name,
                    uint32_t *scene);
/* Add an object, an instance of a mesh, at the mesh's registered positions. */
int pccd_scene_add(struct pccd_client *client, uint32_t scene, uint32_t mesh,
                   uint32_t *object);
int pccd_scene_remove(struct pccd_client *client, uint32_t scene, uint32_t object);

/* Copy the boxes of one level of a scene's hierarchies (the root is level 0), as the last
 * step left them that used the tree (answer.method says which one). Up to `room` boxes go
 * to `boxes`, which may be NULL with room 0. *count gets the number of boxes of the
 * level; 0: there is no such level, or no step has used the tree since objects came or
 * went. They hold
 * what is below them; those of the method wide are larger by up to 2^-12 of the longest
 * side of the scene. Errors:
 * E_HANDLE, E_INVAL, E_BUSY (release answers first), E_NOMETHOD (an older daemon). */
int pccd_scene_boxes(struct pccd_client *client, uint32_t scene, enum pccd_tree tree,
                     uint32_t level, struct pccd_box *boxes, uint32_t room,
                     uint32_t *count);

/* Scenes that clients share. For example, one process moves a cloth and another one the
 * body that wears it.
 * - A scene has a name. Names belong to their user: two users may each have an "arena".
 * - The client that makes a scene says who else may take part, by user and groups of
 *   their processes: to read, which is to know of its steps and fetch their answers; or
 *   also to write, which is to add objects and to step.
 * - Only the client that added an object moves and removes it; the object goes when that
 *   client goes. The scene goes with the last client.
 * - A step moves the objects of the client that submits it; all others stand still. To
 *   move objects of several clients over the same time, all but one submit frames with
 *   `hold` (struct pccd_step_settings). Such a frame waits for a step of the scene, goes
 *   along with it, and is answered with its numbers.
 * - After a crash of the daemon each client brings its own objects back. */
struct pccd_scene_news {
    uint64_t number; /* of the step among those of the scene, from 1 */
    enum pccd_mode mode;
    enum pccd_incomplete incomplete;
    uint64_t total;
    uint64_t hash[2]; /* as in struct pccd_answer */
};

/* Settings of an object: what it may meet, and how thick it is. Two objects of a scene
 * are tested against each other if a.group & b.mask and b.group & a.mask are not 0, and
 * the pair is not ignored; an object is tested against itself if its self_collision is
 * on. At first group is 1, mask all bits, self_collision on. An object keeps its settings
 * when its mesh is replaced.
 *
 * Thick features meet at a distance. For example, cloth of 2 mm has the radius 1e-3 (in
 * metres): it touches a body of radius 0 when their surfaces are 1 mm apart, and itself
 * when they are 2 mm apart. A pair meets when its Euclidean distance is at most r = the
 * radius of a + the radius of b + the step's separation, the exact sum of three doubles;
 * within one object its radius counts twice. Two objects may have a clearance in the
 * place of their radii (pccd_pair_clearance).
 *
 * Within one object what lies close together at rest would meet all the time. So pairs
 * lose their radii and the separation, and meet as features without thickness do, if
 * their distance in the registered positions is less than rest_distance, or if a vertex
 * of one and a vertex of the other are joined by rest_rings edges or fewer. */
struct pccd_object_settings {
    size_t struct_bytes;  /* sizeof(struct pccd_object_settings); 0 reads as that */
    uint32_t what;        /* which of these to set: bits of enum pccd_object_what */
    bool self_collision;  /* PCCD_OBJECT_SELF */
    uint64_t group;       /* PCCD_OBJECT_GROUP: the groups that it is in */
    uint64_t mask;        /* PCCD_OBJECT_MASK: the groups that it may meet */
    double radius;        /* PCCD_OBJECT_RADIUS: half its thickness, 0 .. 1e18, in the
                             unit of coordinates; at first 0: the radii of the mesh's
                             vertices, if it has any */
    double rest_distance; /* PCCD_OBJECT_REST_DISTANCE: 0 .. 1e18; at first 0 */
    uint32_t rest_rings;  /* PCCD_OBJECT_REST_RINGS: 0 .. 8; at first 0 */
    uint64_t user_data;   /* PCCD_OBJECT_USER_DATA: a number of the user's, such as an
                             entity's; at first 0 */
};

/* Set what settings->what names, for steps that are submitted from now on. Errors:
 * E_HANDLE; E_INVAL: a radius or distance that is negative or not finite; E_LIMIT: one
 * above 1e18, or too many rings. */
int pccd_object_set(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const struct pccd_object_settings *settings);
/* Get all of them; user_data, which the first release does not have, where struct_bytes
 * says that the struct has it. struct_bytes is not changed. */
int pccd_object_get(struct pccd_client *client, uint32_t scene, uint32_t object,
                    struct pccd_object_settings *settings);
/* Look up user_data[count] of objects[count], such as those of an answer's records. The
 * daemon is not asked: they are as this client has last set or got them, 0 for objects of
 * which it has done neither. E_INVAL: a pointer is NULL. */
int pccd_user_data(struct pccd_client *client, uint32_t scene, const uint32_t *objects,
                   uint64_t count, uint64_t *user_data);
/* Say what an object is called, such as "left sleeve", for the people who look at the
 * daemon (pccd_list_objects), or at recordings of this client and of others that share
 * the scene: they are told the name, and else a number. UTF-8, at most 255 bytes; NULL,
 * "": it has no name any more. Errors as of pccd_object_set, and E_INVAL: the name is
 * longer. */
int pccd_object_name(struct pccd_client *client, uint32_t scene, uint32_t object,
                     const char *name);
/* Make two objects ignore each other, or (ignored = false) meet again, by their radii.
 * Asking twice is the same as once; removing either object ends it. Errors as above, and
 * E_LIMIT: 262144 pairs of the scene ignore each other already, or have a clearance. In a
 * shared scene E_ACCESS: neither object is this client's (pccd_object_set: the object is
 * not). When another daemon takes the place of one that was lost, it is not told of pairs
 * with another client's object, because that comes back as a new object. */
int pccd_pair_ignore(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                     uint32_t object_b, bool ignored);
/* Have two objects meet in steps where their distance is at most r = clearance + the
 * step's separation: it takes the place of the radii of both, whatever these are. So a
 * pin may come near its hole, at 0, where only features meet that touch or cross, while a
 * handle may not come within 0.3 mm of anything. It ends as pccd_pair_ignore says; of the
 * two calls the last one counts. Questions about what is near go by the radii; a step
 * with tells_start and an approach is E_INVAL while two objects of its scene have a
 * clearance. clearance: 0 .. 1e18, in the unit of coordinates. Errors as of
 * pccd_pair_ignore, and E_INVAL, E_LIMIT: no such clearance. */
int pccd_pair_clearance(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                        uint32_t object_b, double clearance);

/* ---- steps ------------------------------------------------------------------------- */

/* How the threads of a step share its work is tuned by a text such as
 *
 *     scheduler=paper,high-level=disjoint,refit=paper
 *
 * in which any of these four may stand, once each; the first value is the default:
 *
 *     scheduler=steal|paper            threads steal work from each other, or the paper's
 *                                      dynamic assignment, then high-level nodes
 *     high-level=round-robin|disjoint  the paper's scheduler: pairs of such a node are
 *                                      dealt out, or only pairs without a common node are
 *                                      searched at a time
 *     refit=even|paper                 many small subtrees, taken on demand, or two a
 *                                      thread
 *     still=kept|anew                  boxes and records of what stands still come from
 *                                      the last step, or are made anew (to compare)
 *
 * All but `still` are choices of the method paper, and `still` one of wide: wide always
 * steals, and paper makes everything anew. None changes the answer. A text that is wrong
 * makes the step fail (E_INVAL), and pccd_error_text names what is wrong in it. */

/* Motion is linear, but of bodies that hang on joints (pccd_turning.h): in a step every
 * vertex goes straight from its start to its end with constant speed, also where
 * transforms are given. So a point that turns, at a distance
 * rho from the axis, by theta (radians) in k equal steps, is up to
 * rho (1 - cos(theta / (2k))) <= rho theta^2 / (8 k^2) off the true turn, and within
 * delta of it with k >= theta sqrt(rho / (8 delta)). An arm of 1 m that turns by 90
 * degrees in one step is up to 29 cm off, and passes what is there without a contact; 18
 * steps keep it within 1 mm. */
struct pccd_step_settings {
    size_t struct_bytes;     /* sizeof(struct pccd_step_settings). Members that a later
                                library has and this size does not cover are 0 to it;
                                0 stands for the size in 0.1 */
    enum pccd_mode mode;     /* 0 = all */
    enum pccd_method method; /* 0 = the daemon's default */
    uint32_t threads;        /* at most; 0 = the daemon decides. The answer never depends
                                on it */
    const char *tuning;      /* how the threads share the work (above); NULL or "": the
                                daemon decides */
    double tolerance;        /* bounds toi_hi - toi from above, 1e-12 .. 1; 0 = 1e-6 */
    uint64_t deadline_ns;    /* after it the answer is incomplete; 0 = none */
    bool hold;               /* in a shared scene: wait, and move with the next step of
                             another client. One frame of a client waits in a scene at a
                             time (E_BUSY). That step answers it, without records
                             (pccd_scene_read gives them). At its deadline, or when it
                             is cancelled, it is answered and still goes along */
    double separation;       /* added to the radii of every pair (struct
                                pccd_object_settings), 0 .. 1e18 */
    double approach;         /* of pairs that begin at their distance r or nearer. 0: they
                                meet at t = 0 (PCCD_INITIAL). Else above 0 and below 1:
                                they have the flag PCCD_INSIDE, and meet when they come to
                                `approach` times the distance that they begin with, also
                                if they leave r and come back; 0.1, say */
    bool tells_start;        /* say how the step begins, too: `crossings` and
                                `start_inside` of the answer. It costs about as much as
                                the question CROSSINGS of pccd_near.h; bodies that turn
                                begin at their places as these are rounded. Not of a
                                batch, nor with `hold` (E_INVAL) */
    /* What becomes of two features that touch at t = 0, or are too near then; not in mode
     * pairs. 0: they are a contact at t = 0. TOLD: that has one of three flags, too,
     * which say what happens just after t = 0, exactly. PCCD_ENTERS: it approaches, the
     * surfaces pass through each other there. PCCD_SLIDES: the features go on touching.
     * PCCD_LEAVES: they separate. LEFT_OUT: what slides or leaves is no contact at t = 0,
     * so that a box that leaves its floor has a safe_step; where it meets again within
     * the step, it is a contact then, and has its flag. Where nothing tells on which
     * side of each other the surfaces are, they enter: faces that lie in each other and
     * do not show each other their fronts, or part to the back; rods and points in the
     * plane of what they touch; faces and edges without extent. Features that do not
     * touch and begin within the distance at which they meet (radii, `separation`;
     * `approach` is 0) are told by that distance just after t = 0: it falls, and they
     * enter; it stays, or it rises. LEFT_OUT: what does not fall is a contact, with
     * PCCD_INSIDE, where it comes below 1 - 2^-20 of what it was. A pair is two features:
     * what slides along a surface comes nearer to edges ahead. Costs some 20 us of a
     * processor for a pair; nothing is kept from step to step. E_INVAL where bodies turn:
     * there `approach` takes what begins near */
    enum pccd_touching touching;
    /* Of bodies that turn (pccd_turning.h): a pair that is not proved is possible where
     * it comes within so much more than the distance at which it meets, in the unit of
     * coordinates. 0 .. 1e18; 0: 2^-20 of the size of the two bodies, the larger one's */
    double resolution;
    /* On which motions turn that are given with these settings (struct pccd_motion); of a
     * frame pccd_frame_joints has them, and a batch has none (E_INVAL). NULL: none */
    const struct pccd_joint *joints; /* [joint_count] */
    uint32_t joint_count;            /* 0 .. 65536 */
};

/* All defaults: struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT; */
#define PCCD_STEP_SETTINGS_INIT                                                          \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_step_settings)                                \
    }

/* The answer to one step, or a page of it. `contacts` (or `pairs`) lie in memory that the
 * daemon shares: read-only, valid until pccd_answer_release.
 *
 * For example, 2 500 000 contacts of 64 bytes do not fit the 64 MiB of this memory. Then
 * the first page has, say, first = 0, count = 1 000 000, cursor = 1 000 000,
 * total = 2 500 000 and incomplete = PCCD_INCOMPLETE_RESULT_FULL. Read it, release it,
 * and get the next page by pccd_fetch at `cursor`, until cursor = total. */
struct pccd_answer {
    size_t struct_bytes; /* sizeof(struct pccd_answer), set before a call, as
                            PCCD_ANSWER_INIT does; 0 reads as that */
    uint64_t step;       /* the client's number for it, as returned by pccd_submit */
    int status;          /* 0, or why the step failed: then nothing else is set, records
                            that it still has of an answer before can be released, and
                            positions are as before; pccd_error_text says more */
    enum pccd_mode mode;
    enum pccd_method method;
    enum pccd_incomplete incomplete;     /* 0: complete */
    enum pccd_verdict verdict;           /* mode any; in others PCCD_VERDICT_NONE */
    const struct pccd_contact *contacts; /* [count]; NULL in mode pairs or without any */
    const struct pccd_pair *pairs;       /* [count]; NULL in other modes or without any */
    uint64_t count;                      /* records of this page */
    uint64_t first;                      /* index of the page's first record */
    uint64_t cursor;                 /* the next page begins here; total: there is none */
    uint64_t total;                  /* records of the whole answer */
    uint64_t counts[PCCD_KINDS_MAX]; /* records by enum pccd_kind; in mode any 0 */
    uint64_t possible, initial;      /* possible: records that are not proved, of bodies
                                 * that turn */
    double toi_first; /* smallest toi; 2: no record, or mode any or pairs */
    uint64_t hash[2]; /* of all records, version PCCD_HASH_VERSION: high, low */
    uint64_t number;  /* of the step in its scene, from 1; 0: told before its turn */
    uint32_t threads;
    char tuning[PCCD_TUNING_BYTES]; /* what was used; "": one thread, nothing to share */
    struct pccd_step_times times;
    struct pccd_step_counters counters;
    bool is_near; /* true: the answer of pccd_submit_near (pccd_near.h). Then the members
                   * below are set; mode, contacts, pairs, possible, initial, toi_first
                   * and number are not */
    enum pccd_near_what what;
    const struct pccd_near *near; /* [count]; NULL for VERTICES or without any */
    const double *vertex_bounds;  /* [count], VERTICES; else NULL */
    double distance_min, distance_max;
    uint64_t crossings;   /* of a step with tells_start, too: edges that pass through
                             faces at t = 0 */
    uint64_t reserved[2]; /* the library's */
    /* From t = 0 to t = safe_step no pair meets: each is farther apart than the distance
     * at which it would. 0 .. 1; 1: none meets; 0 if toi_first is 0, if the step begins
     * with crossings that it tells, and where it is not known: of an incomplete answer,
     * and of mode any or pairs that is not empty. To go there, see pccd_step_safe. */
    double safe_step;
    uint64_t inside; /* records with PCCD_INSIDE, but for those with PCCD_INITIAL, too; in
                      * modes any and pairs 0 */
    bool crowded;    /* more than half of the records have PCCD_INITIAL or PCCD_INSIDE, of
                      * a thick object or by the separation: mostly a radius above the
                      * length of the edges, for which rest_rings and rest_distance are;
                      * or more than half are coincident */
    /* Of a step with tells_start and an approach: pairs within their distance at t = 0,
     * as PAIRS of pccd_near.h finds them; without an approach they are contacts, which
     * `initial` counts. If there are any, or crossings, mode any does not say NO: it says
     * YES. What is inside another, and passes through nothing, is not told: DEPTH of
     * pccd_near.h tells it. */
    uint64_t start_inside;
    /* Records with PCCD_INITIAL that touch in a vertex of both features. Many are a sign
     * of a surface that is split, at seams of its texture for example, and whose parts
     * touch for ever: pccd_weld of pccd_weld.h tells which vertices are one. 0 if
     * anything is thick, and in modes any and pairs. */
    uint64_t coincident;
    /* Of a step with `touching`: pairs that begin so and enter, slide or leave,
     * whether they are contacts or left out. 0 in modes any and pairs. */
    uint64_t entering, sliding, leaving;
};

/* An answer that is ready to be filled in: struct pccd_answer answer = PCCD_ANSWER_INIT;
 * in C++: pccd_answer answer{};
 * A library that is newer than the program fills in what the program knows of, and one
 * that is older leaves the rest 0. E_INVAL: no library has an answer of so many bytes. */
#define PCCD_ANSWER_INIT                                                                 \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_answer)                                       \
    }

/* Wait for news of a step that another client has made in a shared scene. Steps may be
 * left out, but never the last one. timeout_ms < 0: the client's default; 0: do not wait.
 * pccd_fd is readable when there may be news. Errors: E_AGAIN (timeout_ms = 0),
 * E_TIMEOUT. */
int pccd_scene_wait(struct pccd_client *client, uint32_t scene, int timeout_ms,
                    struct pccd_scene_news *news);
/* Get a page of the answer to step `number` of a shared scene, whoever made it, while it
 * is the last one (else E_STATE); to be released as any other. */
int pccd_scene_read(struct pccd_client *client, uint32_t scene, uint64_t number,
                    uint64_t cursor, struct pccd_answer *answer);

/* A step being written. It lies in a slot of the upload ring, the memory from which the
 * daemon reads, and consists of segments. A segment moves a run of vertices of one
 * object; two bodies that move are two segments. */
struct pccd_frame { /* the library's: only to be passed on */
    struct pccd_client *client;
    uint32_t scene;
    uint32_t slot;
    uint32_t segment_count;
    uint32_t segment_max;
    uint64_t used_bytes;
};

/* Return how many bytes of slot payload `segment_max` segments with `payload_bytes` of
 * data need. */
uint64_t pccd_frame_bytes(uint32_t segment_max, uint64_t payload_bytes);

/* Begin a frame: take a free slot for a step of up to segment_max segments and
 * payload_bytes of positions. Count 12 (F32) or 24 (F64) bytes a vertex, twice that for
 * both ends, and 192 for a rigid segment (pccd_turning.h: of a
 * turning one nothing, but of its joints); the library adds the rounding of each range
 * up to 8 bytes. If the slot is too small, the ring grows, when nothing is in flight.
 * If all slots are in flight, the call waits for one, up to the timeout. Errors: E_BUSY
 * (all slots are begun; 32 answers wait to be taken; the ring must grow while frames
 * are begun), E_LIMIT, E_QUOTA, E_TIMEOUT. */
int pccd_frame_begin(struct pccd_client *client, uint32_t scene, uint32_t segment_max,
                     uint64_t payload_bytes, struct pccd_frame *frame);
/* Add a segment and get the memory to write its positions to: packed [count][3] of
 * `format`. Write before commit; never read it. E_LIMIT: more than was announced. */
int pccd_frame_x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                  uint32_t first, uint32_t count, void **x1);
int pccd_frame_x0x1(struct pccd_frame *frame, uint32_t object, enum pccd_format format,
                    uint32_t first, uint32_t count, void **x0, void **x1);
/* Add a segment that moves by transforms for both ends, rows of [R | t], applied to
 * registered positions in double: ((r0 x + r1 y) + r2 z) + t, each operation rounded by
 * itself. Between the two ends each vertex moves on a straight line. `count` may be less
 * than the object has: other segments may move the rest. */
int pccd_frame_rigid(struct pccd_frame *frame, uint32_t object, uint32_t first,
                     uint32_t count, const double m0[12], const double m1[12]);
/* Publish and submit. `settings` may be NULL. The slot belongs to the daemon afterwards,
 * also on failure. *step numbers the step, from 1. */
int pccd_frame_commit(struct pccd_frame *frame, const struct pccd_step_settings *settings,
                      uint64_t *step);
/* Give the slot back unsent. */
void pccd_frame_abort(struct pccd_frame *frame);

/* A motion of a step: `count` vertices of an object, from `first`, in one of four ways:
 * to x1 from where the last step ended; from x0 to x1; by transforms m0 and m1 at both
 * ends, as pccd_frame_rigid says; or, where the settings of the step have joints, on one
 * of them: then `first` is the joint and `count` all vertices, as pccd_frame_turning
 * says. What a way does not need is NULL.
 *
 * The objects go there whatever they meet: after a step with contacts they stand at its
 * end, too. The next step with x0 and x1, or with m0 and m1, begins elsewhere, or
 * pccd_step_safe goes as far as nothing meets. */
struct pccd_motion {
    uint32_t object;
    uint32_t first, count;
    enum pccd_format format; /* of x0 and x1. 0 is PCCD_FORMAT_F32: doubles read as that
                                are other positions, which nobody notices */
    const void *x0, *x1;     /* [count][3] */
    const double *m0, *m1;   /* [12]: any affine transform, also one that scales or, with
                                zeros, collapses the body */
};

/* Begin a frame, copy these motions into it and commit it, in one call. The arrays may
 * change as soon as it returns. Errors: those of pccd_frame_begin, _x1 and _commit;
 * E_INVAL: a motion that says no way to move, or two. */
int pccd_submit(struct pccd_client *client, uint32_t scene,
                const struct pccd_motion *motions, uint32_t motion_count,
                const struct pccd_step_settings *settings, uint64_t *step);
/* Submit a step in which nothing moves. */
int pccd_submit_still(struct pccd_client *client, uint32_t scene,
                      const struct pccd_step_settings *settings, uint64_t *step);

/* Take one finished answer, oldest first, without waiting: E_AGAIN if there is none. A
 * step that failed is an answer too: then 0 is returned and answer->status says why. */
int pccd_poll(struct pccd_client *client, struct pccd_answer *answer);
/* Wait for the answer to `step`; timeout_ms < 0: the client's default, 0: like poll.
 * Returns the step's status: on failure of the step its code. */
int pccd_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
              struct pccd_answer *answer);
/* Wait until a frame that was committed with `hold` is ready: from then on the next
 * step of the scene takes it along. Returns 0 also when it has been answered already;
 * take the answer as usual. timeout_ms < 0: the client's default. Errors: E_AGAIN
 * (timeout_ms = 0), E_TIMEOUT; E_INVAL: no such step. */
int pccd_wait_held(struct pccd_client *client, uint64_t step, int timeout_ms);
/* Get a further page of the answer to `step`, from the record at `cursor` on. `step` is
 * the last step of `scene`, or its last question about what is near (pccd_near.h). If
 * the memory for answers is full, release the previous page before this call. E_STATE:
 * the answer is gone, because another step has run, or an object was removed or got
 * another shape since. */
int pccd_fetch(struct pccd_client *client, uint32_t scene, uint64_t step, uint64_t cursor,
               struct pccd_answer *answer);
/* Give the records back, and set `count` to 0. Pages may be released in any order, but
 * the memory of one comes back when all before it are released, too: one that is kept
 * holds back what came after it, and with 193 answers held so the next step is E_BUSY,
 * and pccd_error_text names the oldest. Safe on an answer without records and after a
 * failure. */
void pccd_answer_release(struct pccd_client *client, struct pccd_answer *answer);
/* Stop a submitted step. Unless it is done already, its answer has `incomplete` =
 * PCCD_INCOMPLETE_CANCELLED. */
int pccd_cancel(struct pccd_client *client, uint64_t step);
/* Give up the answer to `step`: the step is stopped if that is still possible, and its
 * answer is dropped. Does not wait; a step that is not pending is left alone. */
void pccd_abandon(struct pccd_client *client, uint64_t step);

/* Submit as pccd_submit does, and wait for the answer. On failure either answer->status
 * says so or the answer is untouched; a step that timed out is abandoned. */
int pccd_step(struct pccd_client *client, uint32_t scene,
              const struct pccd_motion *motions, uint32_t motion_count,
              const struct pccd_step_settings *settings, struct pccd_answer *answer);
/* Go as far as nothing meets. The step of the motions is answered as by pccd_step. Then,
 * if something meets, the objects go to x = x0 + part (x1 - x0) instead, rounded to the
 * motion's format: so far that the step from x0 to these x, which was tested too, has no
 * contact and no pair that comes nearer than its distance. For example:
 *
 *     void *x[1] = {next};
 *     double part;
 *     pccd_step_safe(client, scene, &motion, 1, &settings, x, &part, &answer);
 *
 * Each motion has x0 and x1, and x[i] is memory for as many vertices in the same format;
 * or m0 and m1, and x[i] is memory for 12 doubles: m0 + part (m1 - m0), number by number,
 * which brings each vertex to the place on its straight way. Where the two turn that is a
 * transform, but no rotation. Or it hangs on a joint: then the values of all joints go to
 * from + part (to - from), in doubles, and x[i] is memory for 12 doubles: the transform
 * that it has there. x[i] lies in neither end. *part is 0 .. 1, one for all
 * that moves: two bodies that meet hold up the others, too; 1: x is x1. 0: x is x0,
 * as what meets at t = 0 (PCCD_INITIAL) leaves no way to go, unless the settings have an
 * `approach`, or leave out what touches and does not enter (`touching`). The answer is
 * that of the whole step, in the mode that was asked for, and the caller's to release. If
 * it has several pages pccd_fetch has no others: E_STATE, as further steps have run. An
 * incomplete one, and mode any or pairs with a hit, are taken for a contact at t = 0.
 * Errors: those of pccd_step; E_INVAL: an end or x is missing, x lies in an end,
 * or settings with `hold`. */
int pccd_step_safe(struct pccd_client *client, uint32_t scene,
                   const struct pccd_motion *motions, uint32_t motion_count,
                   const struct pccd_step_settings *settings, void *const *x,
                   double *part, struct pccd_answer *answer);
/* Step the first vertex_count vertices of one object, as pccd_step does; all other
 * vertices stand still. It stands at x1 then, also if it met something. E_SEGMENT: the
 * object has fewer; E_QUOTA: so many take more memory than a slot may have. */
int pccd_step_x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                 const void *x1, enum pccd_format format, uint32_t vertex_count,
                 const struct pccd_step_settings *settings, struct pccd_answer *answer);
int pccd_step_x0x1(struct pccd_client *client, uint32_t scene, uint32_t object,
                   const void *x0, const void *x1, enum pccd_format format,
                   uint32_t vertex_count, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer);

/* ---- recording a session ----------------------------------------------------------- */

/* A recording is a file of everything that this client asks and is answered;
 * `pccdctl replay` runs it again. It begins with what is registered now; the log follows.
 * Each event is one write by the thread that calls, so a crash at any moment loses
 * nothing before it. Positions are read out of the slot when the step has been sent.
 *
 * No call is needed with $PCCD_RECORD=PATH in the environment: every client is recorded
 * from the beginning, to PATH, PATH-2, .. PATH-999, the first that there is not
 * (E_LIMIT: all exist); $PCCD_RECORD_OPTIONS holds settings, as
 * "max_bytes=N,segments=N,contacts=1,level=N,up=3".
 *
 * Shared scenes: the daemon keeps what anybody does to the scene (up to 128 MiB a scene,
 * charged as shared memory) until this client's next call fetches it. Such a recording
 * ends with E_LIMIT if that call comes too late, with E_DISCONNECTED when another daemon
 * takes the place of a lost one, and with E_STATE where the recording is in several
 * segments. */
struct pccd_record_settings {
    uint64_t max_bytes; /* of all files; 0: no bound */
    uint32_t segments;  /* 0, 1: one file, and recording ends when it is full. 2 .. 64: a
                           ring of so many files, each of which can be replayed alone.
                           PATH is being written, PATH.1, PATH.2, ... are older, and
                           the oldest is overwritten. Together they exceed max_bytes by
                           at most a step and the answers in flight */
    uint32_t contacts;  /* 1: record the contacts, too: the pages that were received */
    int32_t level;      /* of zstd, 1 .. 19; 0 = 1; negative: nothing is compressed */
    uint32_t up;        /* the axis that points up, for those who show the recording:
                           1 x, 2 y, 3 z; 0: nobody knows */
};
struct pccd_record_info {
    uint64_t bytes;     /* written, over all segments */
    uint64_t raw_bytes; /* the same before compression */
    uint64_t frames;    /* steps */
    uint64_t answers;
    uint64_t ns;       /* that the caller has spent on recording steps and answers */
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
/* Get the state of the recording; E_STATE: there is none. */
int pccd_record(const struct pccd_client *client, struct pccd_record_info *info);
/* End it, as pccd_close does. Returns info->status; `info` may be NULL. */
int pccd_record_stop(struct pccd_client *client, struct pccd_record_info *info);
/* Give the next scene, mesh or object that this client makes this handle; making it fails
 * with E_HANDLE if something has the handle. This is for repeating what a session did,
 * because records name handles. */
int pccd_request_handle(struct pccd_client *client, uint32_t handle);

/* ---- traces of the daemon's threads ------------------------------------------------ */

struct pccd_trace_info {
    uint32_t threads;    /* of the team, whose events are kept */
    uint32_t events_max; /* kept of each, and of the loop */
    uint64_t events;     /* after pccd_trace_stop: how many can be read */
    uint64_t lost;       /* how many were overwritten by newer ones */
};

/* Begin a trace: what the daemon's threads do, for all its clients, and when. (The
 * recording above is something else: the requests of one client.) Allowed to the daemon's
 * own user and root (E_ACCESS), one trace at a time (E_BUSY: another client's; E_STATE:
 * this one's). events: to keep of each thread, the newest; 0 = 65536, or what fits
 * (E_LIMIT). min_ns: tasks that took less are left out. `info` may be NULL. */
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
/* Return the method of a request in a trace, as "frame.submit"; NULL: not known to this
 * library. [any thread] */
const char *pccd_method_name(uint32_t number);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
