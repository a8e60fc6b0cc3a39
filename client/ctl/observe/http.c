/* http.c - answers HTTP on a Unix socket, by libmicrohttpd.
 *
 * That library is loaded when it is needed: with it come nine others, which would make
 * each call of pccdctl take twice as long to begin. It has a thread for each connection,
 * so that one that waits for a daemon keeps no other waiting.
 */
#include "http.h"

#include "ctl.h"

#ifdef HAVE_MICROHTTPD

#include <dlfcn.h>
#include <errno.h>
#include <microhttpd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "terminal.h"

#define SLICE_S         0.2 /* between two looks for an interrupt */
#define CONNECTIONS_MAX 256u
#define IDLE_S          10u /* that a connection may be silent */

struct server {
    http_answer answer;
    void *context;
};

/* ---- the library ------------------------------------------------------------------- */

/* X(its function, without MHD_) */
#define FUNCTIONS(X)                                                                     \
    X(start_daemon)                                                                      \
    X(stop_daemon)                                                                       \
    X(create_response_from_buffer)                                                       \
    X(add_response_header)                                                               \
    X(queue_response)                                                                    \
    X(destroy_response)

static struct {
#define MEMBER(name) __typeof__(MHD_##name) *name;
    FUNCTIONS(MEMBER)
#undef MEMBER
} mhd;

/* Returns what is wrong, or NULL. */
static const char *load_library(void)
{
    void *library = dlopen("libmicrohttpd.so.12", RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        return dlerror();
    }
#define LOAD(name)                                                                       \
    *(void **)&mhd.name = dlsym(library, "MHD_" #name);                                  \
    if (mhd.name == NULL) {                                                              \
        return dlerror();                                                                \
    }
    FUNCTIONS(LOAD)
#undef LOAD
    return NULL;
}

/* ---- the socket -------------------------------------------------------------------- */

/* Return whether nobody listens there. A socket of another type, such as a daemon's, or
 * one that we may not connect to, fails otherwise. */
static bool is_refused(const struct sockaddr_un *address)
{
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    bool is = fd >= 0 &&
              connect(fd, (const struct sockaddr *)address, sizeof *address) != 0 &&
              errno == ECONNREFUSED;
    if (fd >= 0) {
        close(fd);
    }
    return is;
}

/* Remove a socket whose server is gone; anything else stays, and is in the way. */
static void remove_stale(const struct sockaddr_un *address)
{
    struct stat found;
    if (lstat(address->sun_path, &found) == 0 && S_ISSOCK(found.st_mode) &&
        is_refused(address)) {
        unlink(address->sun_path);
    }
}

/* Returns the listening socket, or -1 with errno. */
static int listen_at(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    strcpy(address.sun_path, path);
    remove_stale(&address);
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    mode_t before = umask(0117);
    bool is_bound =
        fd >= 0 && bind(fd, (const struct sockaddr *)&address, sizeof address) == 0;
    umask(before);
    if (is_bound && listen(fd, SOMAXCONN) == 0) {
        return fd;
    }
    int saved = errno;
    if (fd >= 0) {
        close(fd);
    }
    errno = saved;
    return -1;
}

/* ---- requests ---------------------------------------------------------------------- */

static enum MHD_Result reply(struct MHD_Connection *connection, unsigned status,
                             char *text, size_t bytes)
{
    struct MHD_Response *response =
        mhd.create_response_from_buffer(bytes, text, MHD_RESPMEM_MUST_FREE);
    if (response == NULL) {
        free(text);
        return MHD_NO;
    }
    (void)mhd.add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE,
                                  "text/plain; version=0.0.4; charset=utf-8");
    if (status == MHD_HTTP_METHOD_NOT_ALLOWED) {
        (void)mhd.add_response_header(response, MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
    }
    enum MHD_Result result = mhd.queue_response(connection, status, response);
    mhd.destroy_response(response);
    return result;
}

static enum MHD_Result on_request(void *context, struct MHD_Connection *connection,
                                  const char *url, const char *method,
                                  const char *version, const char *body,
                                  size_t *body_bytes, void **kept)
{
    const struct server *server = context;
    char *text = NULL;
    size_t bytes = 0;
    (void)version;
    (void)body;
    (void)kept;
    if (*body_bytes != 0) {
        *body_bytes = 0; /* nobody reads it */
        return MHD_YES;
    }
    FILE *to = open_memstream(&text, &bytes);
    if (to == NULL) {
        return MHD_NO;
    }
    bool is_read = strcmp(method, MHD_HTTP_METHOD_GET) == 0 ||
                   strcmp(method, MHD_HTTP_METHOD_HEAD) == 0;
    unsigned status = MHD_HTTP_METHOD_NOT_ALLOWED;
    if (is_read) {
        status = server->answer(server->context, url, to);
    } else {
        fputs("GET and HEAD are answered\n", to);
    }
    if (fclose(to) != 0) {
        free(text);
        return MHD_NO;
    }
    return reply(connection, status, text, bytes);
}

int http_serve(const char *path, http_answer answer, void *context)
{
    struct server server = {answer, context};
    const char *wrong = load_library();
    if (wrong != NULL) {
        return ctl_complain("cannot listen at %s: libmicrohttpd: %s", path, wrong);
    }
    int fd = listen_at(path);
    if (fd < 0) {
        return ctl_complain("cannot listen at %s: %s", path, strerror(errno));
    }
    terminal_catch_interrupts(); /* as its threads do, too */
    struct MHD_Daemon *daemon = mhd.start_daemon(
        MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD, 0, NULL, NULL,
        on_request, &server, MHD_OPTION_LISTEN_SOCKET, fd, MHD_OPTION_CONNECTION_LIMIT,
        CONNECTIONS_MAX, MHD_OPTION_CONNECTION_TIMEOUT, IDLE_S, MHD_OPTION_END);
    if (daemon == NULL) {
        close(fd);
        unlink(path);
        return ctl_complain("cannot serve HTTP at %s", path);
    }
    while (!terminal_was_interrupted()) {
        terminal_sleep(SLICE_S);
    }
    unlink(path);
    mhd.stop_daemon(daemon); /* closes the socket, when what waits has an answer */
    return CTL_DONE;
}

#else

int http_serve(const char *path, http_answer answer, void *context)
{
    (void)answer;
    (void)context;
    return ctl_complain("cannot listen at %s: pccdctl was built without libmicrohttpd",
                        path);
}

#endif
