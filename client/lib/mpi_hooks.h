/* mpi_hooks.h - what libpccd-mpi asks of libpccd, and nobody else does.
 *
 * Tell the service in this process which features of a mesh are its own. All others are
 * foreign: pairs of which such a one is the first feature are left out of steps and of
 * what is near, because another process looks for them. Let that process end a step that
 * this one computes, have its share of the processors, write positions to where the
 * engine has them, and the records of an answer. All this needs the url direct:.
 */
#ifndef CLI_MPI_HOOKS_H
#define CLI_MPI_HOOKS_H

#include <stdbool.h>

#include "pccd.h"

/* Say which features of a mesh are this process's own, when pccd_mesh_put has just put
 * it, before its first step, once: a bit for each vertex, vertices[i / 64] >> i % 64 & 1,
 * and one for each edge (pccd_mesh_edges). Copied. A recording of the client ends here,
 * as nobody could repeat the answers. PCCD_E_STATE: also with another url; PCCD_E_HANDLE,
 * PCCD_E_NOMEM. */
__attribute__((visibility("default"))) int cli_mpi_own(struct pccd_client *client,
                                                       uint32_t mesh,
                                                       const uint64_t *vertices,
                                                       const uint64_t *edges);

/* Have is_stopped(asked) asked while the client's steps and questions are computed, by
 * the thread that called, every few microseconds as a rule, so it looks itself how long
 * ago it did more than that. True ends the step as pccd_cancel does:
 * PCCD_INCOMPLETE_CANCELLED. is_stopped must not call libpccd. NULL: nobody is asked any
 * more. PCCD_E_STATE: it is another url. */
__attribute__((visibility("default"))) int
cli_mpi_watch(struct pccd_client *client, bool (*is_stopped)(void *), void *asked);

/* Let nothing that the client asks for use more than so many threads, also not to take in
 * meshes and make scenes, where pccd.h knows no number; 0: as many as others.
 * PCCD_E_STATE: it is another url. */
__attribute__((visibility("default"))) int cli_mpi_threads(struct pccd_client *client,
                                                           uint32_t threads);

/* Expect the next step of the client's scene to find about so many contacts or pairs,
 * which would otherwise be taken to be as many as the last one found: what it finds has
 * memory first. Memory of pages that the client has released is given back. Neither
 * changes an answer. Does nothing with another url. */
__attribute__((visibility("default"))) void
cli_mpi_expect(struct pccd_client *client, uint32_t scene, uint64_t records);

/* Get where the positions of all vertices of an object of the client's scene, which it
 * does not share, can be written: those at the end of its next step and, unless x0 is
 * NULL, those at its start. Until cli_mpi_lent says how that ended, nothing else is asked
 * of the scene. PCCD_E_STATE: also with another url; PCCD_E_HANDLE, PCCD_E_NOMEM. */
__attribute__((visibility("default"))) int cli_mpi_lend(struct pccd_client *client,
                                                        uint32_t scene, uint32_t object,
                                                        double (**x0)[3],
                                                        double (**x1)[3]);

enum cli_mpi_lent { CLI_MPI_NONE, CLI_MPI_X1, CLI_MPI_X0X1 };
/* Say that those at the end are there, or both, for the scene's next step, whose frame
 * has no others of the object; or that none will be, and where the object's last step
 * began is not known any more. Errors: those of cli_mpi_lend. */
__attribute__((visibility("default"))) int cli_mpi_lent(struct pccd_client *client,
                                                        uint32_t scene, uint32_t object,
                                                        enum cli_mpi_lent which);

/* Have the contacts and pairs of the client's steps come to the page of an answer by
 * write(writer, to, from, count), which the thread that called calls. It is to make
 * `count` records of those that it reads, and may write there until pccd_answer_release.
 * The answer has no hash then. NULL: they are copied, as ever. PCCD_E_STATE: so they are,
 * as it is another url, or the client is recorded. */
__attribute__((visibility("default"))) int
cli_mpi_write(struct pccd_client *client,
              void (*write)(void *writer, void *to, const void *from, uint64_t count),
              void *writer);

/* Have the client's steps tell weigh(weigher, pairs, count) of the pairs that no box,
 * axis or plane rejects, from any thread of theirs, and make no records. NULL: they make
 * them. The url must be direct:. */
__attribute__((visibility("default"))) void
cli_mpi_weigh(struct pccd_client *client,
              void (*weigh)(void *weigher, const struct pccd_pair *pairs, uint32_t count),
              void *weigher);

#endif
