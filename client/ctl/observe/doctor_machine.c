/* doctor_machine.c - what is wrong with a machine for pccdd. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "doctor.h"

/* 1024 connections with three descriptors each. */
#define FILES_WANTED 3200u
#define SHM_WANTED   (64u << 20)

static void look_at_files(struct doctor *doctor)
{
    struct rlimit limit = {0, 0};
    getrlimit(RLIMIT_NOFILE, &limit);
    bool is_low = limit.rlim_cur < FILES_WANTED;
    doctor_find(doctor, is_low && limit.rlim_max < FILES_WANTED ? DOCTOR_WARN : DOCTOR_OK,
                "files",
                is_low && limit.rlim_max < FILES_WANTED
                    ? "a daemon started from here serves fewer clients: raise the hard "
                      "limit (LimitNOFILE= of systemd, or /etc/security/limits.conf)"
                    : "",
                "%llu descriptors at most, %llu after raising it",
                (unsigned long long)limit.rlim_cur, (unsigned long long)limit.rlim_max);
}

/* Try what a ring is made of: a memfd of that size, allocated and mapped. */
static void look_at_memory(struct doctor *doctor)
{
    int fd = memfd_create("pccdctl doctor", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    int failed = fd < 0 ? errno : posix_fallocate(fd, 0, SHM_WANTED);
    void *memory =
        failed != 0 ? MAP_FAILED : mmap(NULL, SHM_WANTED, PROT_READ, MAP_SHARED, fd, 0);
    if (failed == 0 && memory == MAP_FAILED) {
        failed = errno;
    }
    if (memory != MAP_FAILED) {
        munmap(memory, SHM_WANTED);
    }
    if (fd >= 0) {
        close(fd);
    }
    doctor_find(doctor, failed == 0 ? DOCTOR_OK : DOCTOR_FAIL, "memory",
                failed == 0 ? ""
                            : "clients share memory with the daemon: raise ulimit -v, or "
                              "the memory of this container",
                "%u MiB to share: %s", SHM_WANTED >> 20,
                failed == 0 ? "can be had" : strerror(failed));
}

static void look_at_openmp(struct doctor *doctor)
{
    static const char *const names[] = {"OMP_NUM_THREADS", "OMP_PROC_BIND", "OMP_PLACES",
                                        "GOMP_CPU_AFFINITY"};
    char found[DOCTOR_TEXT_BYTES] = "";
    size_t used = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *value = getenv(names[i]);
        if (value != NULL && used < sizeof found) {
            used += (size_t)snprintf(found + used, sizeof found - used, " %s=%.40s",
                                     names[i], value);
        }
    }
    doctor_find(
        doctor, found[0] == '\0' ? DOCTOR_OK : DOCTOR_WARN, "openmp",
        found[0] == '\0' ? ""
                         : "pccdd --threads and --pin say how many threads it has "
                           "and where; unset these where it is started",
        "%s%s", found[0] == '\0' ? "nothing is set that would disturb" : "set:", found);
}

void doctor_look_at_machine(struct doctor *doctor)
{
    look_at_files(doctor);
    look_at_memory(doctor);
    look_at_openmp(doctor);
}

/* ---- the socket -------------------------------------------------------------------- */

bool doctor_find_path(const struct pccd_options *options, char path[DOCTOR_PATH_BYTES])
{
    const char *url = options->url != NULL ? options->url : getenv("PCCD_URL");
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    if (url != NULL && url[0] != '\0') {
        snprintf(path, DOCTOR_PATH_BYTES, "%s",
                 strncmp(url, "unix:", 5) == 0 ? url + 5 : "");
    } else if (runtime != NULL && runtime[0] == '/') {
        snprintf(path, DOCTOR_PATH_BYTES, "%s/pccd/pccd.sock", runtime);
    } else {
        snprintf(path, DOCTOR_PATH_BYTES, "/tmp/pccd-%u/pccd.sock", (unsigned)geteuid());
    }
    return path[0] != '\0';
}

/* Return whether the daemon could make that folder: the one above it must be there. */
static bool can_make(const char *folder)
{
    char parent[DOCTOR_PATH_BYTES];
    snprintf(parent, sizeof parent, "%s", folder);
    char *slash = strrchr(parent, '/');
    if (slash == NULL) {
        return true; /* beside us */
    }
    slash[slash == parent ? 1 : 0] = '\0';
    return access(parent, W_OK | X_OK) == 0;
}

static void look_at_folder(struct doctor *doctor, const char *path)
{
    char folder[DOCTOR_PATH_BYTES];
    struct stat found;
    snprintf(folder, sizeof folder, "%s", path);
    char *slash = strrchr(folder, '/');
    if (slash == NULL || slash == folder) {
        return;
    }
    *slash = '\0';
    if (stat(folder, &found) != 0) {
        int why = errno;
        bool is_missing = why == ENOENT;
        bool can_be_made = is_missing && can_make(folder);
        if (can_be_made && doctor->is_unused) {
            return; /* the daemon makes it when it starts */
        }
        doctor_find(
            doctor, can_be_made || !is_missing ? DOCTOR_WARN : DOCTOR_FAIL, "folder",
            can_be_made  ? "the daemon makes it when it starts"
            : is_missing ? "the daemon makes only the last folder of the path, and "
                           "cannot: make it, or set XDG_RUNTIME_DIR or PCCD_URL"
                         : "let this user pass through it",
            "%s: %s", folder, strerror(why));
        return;
    }
    bool is_foreign = found.st_uid != 0 && found.st_uid != geteuid();
    bool is_open = (found.st_mode & 022) != 0 && (found.st_mode & S_ISVTX) == 0;
    doctor_find(doctor,
                is_open      ? DOCTOR_FAIL
                : is_foreign ? DOCTOR_WARN
                             : DOCTOR_OK,
                "folder",
                is_open ? "others could put a socket of theirs there: chmod go-w"
                : is_foreign
                    ? "another user's: is PCCD_URL or XDG_RUNTIME_DIR the right one?"
                    : "",
                "%s, mode %04o, user %u", folder, (unsigned)(found.st_mode & 07777),
                (unsigned)found.st_uid);
}

enum doctor_lock doctor_look_at_lock(const char *path, pid_t *holder)
{
    char text[32] = "";
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return DOCTOR_LOCK_NONE;
    }
    bool is_free = flock(fd, LOCK_SH | LOCK_NB) == 0;
    ssize_t bytes = pread(fd, text, sizeof text - 1, 0);
    close(fd);
    *holder = bytes > 0 ? (pid_t)strtol(text, NULL, 10) : 0;
    return is_free ? DOCTOR_LOCK_FREE : DOCTOR_LOCK_HELD;
}

/* Tell of the lock beside the socket. */
static void look_at_lock(struct doctor *doctor, const char *path, bool has_socket)
{
    char lock[DOCTOR_PATH_BYTES + 8];
    snprintf(lock, sizeof lock, "%s.lock", path);
    pid_t holder;
    enum doctor_lock state = doctor_look_at_lock(lock, &holder);
    bool is_free = state == DOCTOR_LOCK_FREE;
    if (state == DOCTOR_LOCK_NONE) {
        return;
    }
    if (is_free && has_socket) {
        doctor_find(doctor, DOCTOR_WARN, "lock",
                    "the next daemon that starts takes both over; nothing to do",
                    "%s is left from a daemon that has crashed", lock);
    } else {
        doctor_find(doctor, DOCTOR_OK, "lock", "", "%s is %s", lock,
                    is_free ? "free" : "held");
    }
}

/* A unit that is installed, and its socket. */
static void look_at_systemd(struct doctor *doctor)
{
    static const char *const places[] = {
        "/etc/systemd/system/pccdd.socket", "/usr/lib/systemd/system/pccdd.socket",
        "/lib/systemd/system/pccdd.socket", "/usr/local/lib/systemd/system/pccdd.socket"};
    struct stat found;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        if (stat(places[i], &found) != 0) {
            continue;
        }
        bool is_up = stat("/run/pccd/pccd.sock", &found) == 0;
        doctor_find(doctor, is_up ? DOCTOR_OK : DOCTOR_WARN, "systemd",
                    is_up ? "" : "systemctl enable --now pccdd.socket, if it is wanted",
                    "%s is installed, and %s", places[i],
                    is_up ? "listens at /run/pccd/pccd.sock" : "does not listen");
        return;
    }
    doctor_find(doctor, DOCTOR_OK, "systemd", "",
                "no unit is installed, and none needed");
}

/* Find the last words of a daemon there that has not ended as it should. It is no fault
 * where another one has come since. */
static void look_at_log(struct doctor *doctor, const char *path)
{
    char name[DOCTOR_PATH_BYTES + sizeof COMMON_OWN_LOG_ENDING];
    snprintf(name, sizeof name, "%s" COMMON_OWN_LOG_ENDING, path);
    common_last_words(name, doctor->last_words);
}

void doctor_look_at_socket(struct doctor *doctor, const struct pccd_options *options)
{
    char path[DOCTOR_PATH_BYTES];
    struct stat found;
    look_at_systemd(doctor);
    if (options->private_daemon || !doctor_find_path(options, path)) {
        return;
    }
    bool has_socket = stat(path, &found) == 0;
    const int why = errno;
    const char *told = getenv("PCCD_URL");
    doctor->is_unused = !has_socket && why == ENOENT && options->url == NULL &&
                        (told == NULL || told[0] == '\0');
    look_at_folder(doctor, path);
    if (doctor->is_unused) {
        doctor_find(doctor, DOCTOR_OK, "socket", "", "%s: nobody has needed it yet",
                    path);
    } else if (!has_socket) {
        doctor_find(doctor, DOCTOR_WARN, "socket",
                    why == ENOENT ? "no daemon has been started there yet"
                                  : "let this user pass through its folder",
                    "%s: %s", path, strerror(why));
    } else if (!S_ISSOCK(found.st_mode)) {
        doctor_find(doctor, DOCTOR_FAIL, "socket", "remove it, or choose another path",
                    "%s is no socket", path);
    } else if (access(path, W_OK) != 0) {
        doctor_find(doctor, DOCTOR_FAIL, "socket",
                    "join its group (systemd: pccd), or let the daemon allow this user",
                    "%s: this user may not connect (mode %04o, user %u, group %u)", path,
                    (unsigned)(found.st_mode & 07777), (unsigned)found.st_uid,
                    (unsigned)found.st_gid);
    } else {
        doctor_find(doctor, DOCTOR_OK, "socket", "", "%s, mode %04o, user %u", path,
                    (unsigned)(found.st_mode & 07777), (unsigned)found.st_uid);
    }
    look_at_lock(doctor, path, has_socket);
    look_at_log(doctor, path);
}
