/* landlock.c - keeps the daemon from changing and reading files (Landlock). */
#include "sandbox.h"

#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The same on every architecture. */
#define CALL_CREATE_RULESET 444
#define CALL_ADD_RULE       445
#define CALL_RESTRICT_SELF  446

#define CREATE_RULESET_VERSION 1u
#define RULE_PATH_BENEATH      1

/* Rights, by the version that brought them. */
#define EXECUTE     (1u << 0)
#define WRITE_FILE  (1u << 1)
#define READ_FILE   (1u << 2)
#define REMOVE_DIR  (1u << 4)
#define REMOVE_FILE (1u << 5)
#define MAKE_REG    (1u << 8)
#define MAKE_SOCK   (1u << 9)
#define MAKE_ANY    (0x7fu << 6) /* device files, folders, files, sockets, pipes, links */
#define REFER       (1u << 13)   /* version 2: rename or link into another folder */
#define TRUNCATE    (1u << 14)   /* version 3 */

struct ruleset_attr {
    uint64_t handled_access_fs;
};

struct path_beneath_attr {
    uint64_t allowed_access;
    int32_t parent_fd;
} __attribute__((packed));

/* Let `rights` go on beneath the folder that is the first `length` bytes of `path`. */
static bool allow(int ruleset, const char *path, size_t length, uint64_t rights)
{
    char folder[SRV_PATH_BYTES];
    snprintf(folder, sizeof folder, "%.*s", (int)length, path);
    const char *name = length == 0 ? (path[0] == '/' ? "/" : ".") : folder;
    struct path_beneath_attr rule = {.allowed_access = rights};
    rule.parent_fd = open(name, O_PATH | O_DIRECTORY | O_CLOEXEC);
    bool is_added = rule.parent_fd >= 0 &&
                    syscall(CALL_ADD_RULE, ruleset, RULE_PATH_BENEATH, &rule, 0) == 0;
    if (rule.parent_fd >= 0) {
        close(rule.parent_fd);
    }
    return is_added;
}

/* Return how much of a path is its folder's, without the slash behind it. */
static size_t folder_length(const char *path, size_t length)
{
    while (length > 0 && path[length - 1] != '/') {
        length--;
    }
    while (length > 0 && path[length - 1] == '/') {
        length--;
    }
    return length;
}

/* Allow what SIGHUP has opened again. */
static bool allow_again(int ruleset, const struct srv_options *options)
{
    const char *config = options->config_path, *log = options->log_path;
    return (config[0] == '\0' ||
            allow(ruleset, config, folder_length(config, strlen(config)), READ_FILE)) &&
           (log[0] == '\0' ||
            allow(ruleset, log, folder_length(log, strlen(log)), WRITE_FILE | MAKE_REG));
}

/* Allow the daemon its socket and lock; one that was given its socket has none. */
static bool allow_own(int ruleset, const struct srv_options *options)
{
    const char *path = options->socket_path;
    size_t folder = folder_length(path, strlen(path));
    if (options->listen_fd >= 0) {
        return true;
    }
    return allow(ruleset, path, folder, REMOVE_FILE | MAKE_SOCK) &&
           (!options->private_daemon || folder == 0 || /* the folder goes with it */
            allow(ruleset, path, folder_length(path, folder), REMOVE_DIR));
}

int srv_landlock_enter(const struct srv_options *options)
{
    long version = syscall(CALL_CREATE_RULESET, NULL, 0, CREATE_RULESET_VERSION);
    if (version < 1) {
        return 0;
    }
    const struct ruleset_attr attr = {
        .handled_access_fs = EXECUTE | WRITE_FILE | READ_FILE | REMOVE_DIR | REMOVE_FILE |
                             MAKE_ANY | (version >= 2 ? REFER : 0) |
                             (version >= 3 ? TRUNCATE : 0)};
    int ruleset = (int)syscall(CALL_CREATE_RULESET, &attr, sizeof attr, 0);
    if (ruleset < 0) {
        return 0;
    }
    bool is_in = allow_own(ruleset, options) && allow_again(ruleset, options) &&
                 prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                 syscall(CALL_RESTRICT_SELF, ruleset, 0) == 0;
    close(ruleset);
    return is_in ? (int)version : 0;
}
