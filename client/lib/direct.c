/* direct.c - the service in this process.
 *
 * Find the library: as $PCCD_DIRECT says, else beside this one or the program, else where
 * it was installed or the loader finds it. It stays for as long as the process lives: the
 * threads of its OpenMP runtime do.
 */
#include <assert.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "connection.h"
#include "launch.h"
#include "mpi_hooks.h"
#include "proto_direct.h"
#include "recorder.h"

#define WHY_BYTES (CLI_TEXT_BYTES / 2)

static void *load(const char *path)
{
    return dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
}

/* The library in `folder``sub`, NULL where there is none that can be loaded; the first
 * reason goes to `why`. */
static void *load_in(const char *folder, const char *sub, char why[WHY_BYTES])
{
    char path[CLI_FOLDER_BYTES];
    void *library = NULL;
    int length =
        snprintf(path, sizeof path, "%s%s/%s", folder, sub, PROTO_DIRECT_LIBRARY);

    if (folder[0] != '\0' && (size_t)length < sizeof path && access(path, F_OK) == 0) {
        library = load(path);
        if (library == NULL && why[0] == '\0') {
            (void)snprintf(why, WHY_BYTES, "%s", dlerror());
        }
    }
    return library;
}

/* Wherever it may be, if nobody has said where. */
static void *search(char why[WHY_BYTES])
{
    char folder[CLI_FOLDER_BYTES];
    void *library;

    cli_folder_of_library(folder);
    library = load_in(folder, "", why);
    if (library == NULL) {
        cli_folder_of_program(folder);
        library = load_in(folder, "", why);
    }
    if (library == NULL) { /* where libtool has it, of a program in a build folder */
        library = load_in(folder, "/.libs", why);
    }
    if (library == NULL) {
        library = load_in(CLI_LIBRARY_FOLDER, "", why);
    }
    if (library == NULL) {
        library = load(PROTO_DIRECT_LIBRARY);
        if (library == NULL && why[0] == '\0') {
            (void)snprintf(why, WHY_BYTES, "%s", dlerror());
        }
    }
    return library;
}

static void *find_library(struct pccd_client *client)
{
    const char *chosen = getenv("PCCD_DIRECT");
    char why[WHY_BYTES] = "";
    void *library = NULL;

    if (chosen != NULL && chosen[0] != '\0') {
        library = load(chosen);
        if (library == NULL) {
            (void)cli_fail(client, PCCD_E_SYSTEM, "direct: PCCD_DIRECT=%.150s: %.250s",
                           chosen, dlerror());
        }
        return library;
    }
    library = search(why);
    if (library == NULL) {
        (void)cli_fail(client, PCCD_E_SYSTEM,
                       "direct: needs %s, which cannot be loaded: %.250s; install it "
                       "beside libpccd, name it in $PCCD_DIRECT, or use a daemon",
                       PROTO_DIRECT_LIBRARY, why);
    }
    return library;
}

int cli_direct_open(struct pccd_client *client)
{
    char text[PROTO_DIRECT_TEXT_BYTES] = "";
    struct cli_direct *direct = &client->direct;
    void *library = find_library(client);
    proto_direct_fn entrance = NULL;
    int status;

    if (library == NULL) {
        return PCCD_E_SYSTEM;
    }
    /* ISO C has no conversion from an object's address to a function's; POSIX has. */
    void *symbol = dlsym(library, PROTO_DIRECT_SYMBOL);

    memcpy(&entrance, &symbol, sizeof entrance);
    direct->host = entrance != NULL ? entrance(PROTO_DIRECT_VERSION) : NULL;
    if (direct->host == NULL) {
        return cli_fail(client, PCCD_E_VERSION,
                        "direct: the %s that was found is of another release than "
                        "libpccd %s",
                        PROTO_DIRECT_LIBRARY, pccd_version());
    }
    memcpy(client->url, CLI_DIRECT_URL, sizeof(CLI_DIRECT_URL));
    status = direct->host->open(&direct->line, text);
    return status == 0 ? 0 : cli_fail(client, status, "direct: %s", text);
}

void cli_direct_close(struct pccd_client *client)
{
    if (client->direct.line != NULL) {
        client->direct.host->close(client->direct.line);
    }
    client->direct.line = NULL;
}

int cli_direct_send(struct pccd_client *client, const void *message, size_t bytes)
{
    assert(client->direct.line != NULL);
    return client->direct.host->send(client->direct.line, message, bytes);
}

int cli_direct_receive(struct pccd_client *client, size_t *bytes, int *fd_count)
{
    return client->direct.host->receive(client->direct.line, client->message,
                                        sizeof client->message, bytes, client->fds,
                                        fd_count);
}

int cli_mpi_own(struct pccd_client *client, uint32_t mesh, const uint64_t *vertices,
                const uint64_t *edges)
{
    if (client->direct.line == NULL) {
        return cli_fail(client, PCCD_E_STATE, "only direct: knows foreign features");
    }
    int status = client->direct.host->own(client->direct.line, mesh, vertices, edges);
    if (status == 0 && client->recorder != NULL && !client->recorder->has_ended) {
        (void)cli_record_stop_because(client, PCCD_E_STATE,
                                      "it ends where a mesh became a part of another "
                                      "process's: its answers cannot be repeated alone");
    }
    return status == 0 ? 0
                       : cli_fail(client, status, "mesh 0x%x: its foreign features: %s",
                                  mesh, pccd_status_text(status));
}

int cli_mpi_watch(struct pccd_client *client, bool (*is_stopped)(void *), void *asked)
{
    if (client->direct.line == NULL) {
        return cli_fail(client, PCCD_E_STATE, "only direct: asks while it computes");
    }
    client->direct.host->watch(client->direct.line, is_stopped, asked);
    return 0;
}

int cli_mpi_threads(struct pccd_client *client, uint32_t threads)
{
    if (client->direct.line == NULL) {
        return cli_fail(client, PCCD_E_STATE, "only direct: has threads of a client");
    }
    client->direct.host->limit(client->direct.line, threads);
    return 0;
}

void cli_mpi_expect(struct pccd_client *client, uint32_t scene, uint64_t records)
{
    if (client->direct.line != NULL) {
        client->direct.host->expect(client->direct.line, scene, records);
    }
}

static int lend(struct pccd_client *client, uint32_t scene, uint32_t object,
                enum proto_direct_lend what, double (**x0)[3], double (**x1)[3])
{
    if (client->direct.line == NULL) {
        return cli_fail(client, PCCD_E_STATE, "only direct: has positions to write to");
    }
    int status =
        client->direct.host->lend(client->direct.line, scene, object, what, x0, x1);
    return status == 0 ? 0
                       : cli_fail(client, status, "object 0x%x: its positions: %s",
                                  object, pccd_status_text(status));
}

int cli_mpi_lend(struct pccd_client *client, uint32_t scene, uint32_t object,
                 double (**x0)[3], double (**x1)[3])
{
    return lend(client, scene, object, PROTO_DIRECT_LEND, x0, x1);
}

int cli_mpi_lent(struct pccd_client *client, uint32_t scene, uint32_t object,
                 enum cli_mpi_lent which)
{
    static const enum proto_direct_lend what[] = {[CLI_MPI_NONE] = PROTO_DIRECT_FORGET,
                                                  [CLI_MPI_X1] = PROTO_DIRECT_HAS_X1,
                                                  [CLI_MPI_X0X1] = PROTO_DIRECT_HAS_X0X1};
    return lend(client, scene, object, what[which], NULL, NULL);
}

int cli_mpi_write(struct pccd_client *client,
                  void (*write)(void *writer, void *to, const void *from, uint64_t count),
                  void *writer)
{
    if (client->direct.line == NULL || client->recorder != NULL) {
        return cli_fail(client, PCCD_E_STATE,
                        "only direct: lets a client write records, and no recorded one");
    }
    client->direct.host->write(client->direct.line, write, writer);
    return 0;
}

void cli_mpi_weigh(struct pccd_client *client,
                   void (*weigh)(void *weigher, const struct pccd_pair *pairs,
                                 uint32_t count),
                   void *weigher)
{
    client->direct.host->weigh(client->direct.line, weigh, weigher);
}

int cli_direct_descriptor(const struct pccd_client *client)
{
    return client->direct.host->descriptor(client->direct.line);
}
