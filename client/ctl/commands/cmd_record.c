/* cmd_record.c - pccdctl record. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "answers.h"
#include "ctl.h"
#include "output.h"
#include "printable.h"
#include "reader.h"
#include "scene.h"

#define SEGMENTS_MAX  64u
#define LEVEL_MAX     19u
#define LEVEL_UNSET   UINT64_MAX
#define MAX_BYTES_MAX (1ull << 62)
#define FILES_MAX     999u /* that the library names: FILE, FILE-2, ... */

struct record_command {
    const char *path;
    uint64_t max_bytes, segments, level;
    bool has_contacts;
    uint32_t up; /* 1 x, 2 y, 3 z; 0: not given */
    struct option_arguments program;
};

static void check(struct argp_state *state, void *to)
{
    const struct record_command *command = to;
    if (command->segments > 0 && command->max_bytes == 0) {
        option_misused(state, "--segments wants --max-bytes");
    }
}

#define AT(member) offsetof(struct record_command, member)
static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Where the recording goes (default: the name of the program, with .rec); the second "
     "client of the program goes to FILE-2, and so on. Earlier recordings of these names "
     "are removed",
     OPTION_TEXT, .at = AT(path)},
    {"contacts", 0, NULL,
     "Record the contacts of the answers, too, so that they can be seen without a daemon",
     OPTION_FLAG, .at = AT(has_contacts)},
    {"max-bytes", 0, "N", "End the recording before it exceeds N bytes", OPTION_U64,
     .at = AT(max_bytes), .min = 4096, .max = MAX_BYTES_MAX},
    {"segments", 0, "N",
     "Keep the newest part instead, in N files (FILE, FILE.1, ...) of together "
     "--max-bytes; each can be read by itself",
     OPTION_U64, .at = AT(segments), .min = 2, .max = SEGMENTS_MAX},
    {"level", 0, "N", "Level of compression, 0 (none) to 19 (default: 1, the fastest)",
     OPTION_U64, .at = AT(level), .min = 0, .max = LEVEL_MAX},
    {"up", 0, "x|y|z", "Say which axis points up, for those who look at the recording",
     OPTION_WORD, .at = AT(up), .min = 1},
    {.type = OPTION_ARGUMENTS,
     .at = AT(program),
     .needed = "which program? pccdctl record [-o FILE] -- PROGRAM ..."},
    {0}};

const struct option_table ctl_table_record = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_common_table, 0}, {0}},
    .check = check,
    .arguments = "-- PROGRAM [ARGUMENT...]\nSCENE [SCENE OPTION...]",
    .ends_options = true,
    .text = "Run a program that uses libpccd, and record everything that it asks and "
            "is answered. A scene file is played by a daemon of its own, with the "
            "options of pccdctl load that are behind it.",
    .more = "The program needs no change: libpccd looks for $PCCD_RECORD. What is in "
            "the file survives the end of the program and of the daemon, however "
            "they end. Exit status: that of the program, 128 + N when signal N ended "
            "it; 4 when it ended with 0, and nothing was recorded or a file could "
            "not be written to its end.",
    .examples = "  pccdctl record -o run.rec -- ./simulator\n"
                "  pccdctl record --contacts -- ./simulator 100\n",
};

static int set_environment(const struct record_command *command)
{
    char text[160];
    int used = snprintf(text, sizeof text, "contacts=%d,up=%" PRIu32,
                        command->has_contacts, command->up);
    if (command->max_bytes > 0) {
        used += snprintf(text + used, sizeof text - (size_t)used, ",max_bytes=%" PRIu64,
                         command->max_bytes);
    }
    if (command->segments > 0) {
        used += snprintf(text + used, sizeof text - (size_t)used, ",segments=%" PRIu64,
                         command->segments);
    }
    if (command->level != LEVEL_UNSET) {
        snprintf(text + used, sizeof text - (size_t)used, ",level=%d",
                 command->level == 0 ? -1 : (int)command->level);
    }
    return setenv("PCCD_RECORD", command->path, 1) == 0 &&
                   setenv("PCCD_RECORD_OPTIONS", text, 1) == 0
               ? CTL_DONE
               : ctl_complain("out of memory");
}

/* Signals from the terminal reach the program too, which decides what they mean. */
static int run(char **command, bool *has_run)
{
    pid_t pid;
    int state = 0;
    int why;
    signal(SIGINT, SIG_IGN);
    signal(SIGQUIT, SIG_IGN);
    posix_spawnattr_t attributes;
    sigset_t defaults;
    posix_spawnattr_init(&attributes);
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGINT);
    sigaddset(&defaults, SIGQUIT);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    why = posix_spawnp(&pid, command[0], NULL, &attributes, command, environ);
    posix_spawnattr_destroy(&attributes);
    if (why != 0) {
        return ctl_complain("%s cannot be run: %s", command[0], strerror(why));
    }
    *has_run = true;
    while (waitpid(pid, &state, 0) < 0 && errno == EINTR) {
        ;
    }
    return WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
}

/* Run the program, or play a scene file, with the options that are behind it. */
static int run_asked(const struct record_command *command, bool *has_run)
{
    char own_program[] = "/proc/self/exe";
    const struct option_arguments *asked = &command->program;
    if (!scene_is_named(asked->list[0])) {
        return run(asked->list, has_run);
    }
    char **load = calloc(asked->count + 4u, sizeof *load);
    if (load == NULL) {
        return ctl_complain("out of memory");
    }
    load[0] = own_program;
    load[1] = "load";
    load[2] = "--private";
    memcpy(load + 3, asked->list, asked->count * sizeof *load);
    int status = run(load, has_run);
    free(load);
    return status;
}

/* ---- what is there already --------------------------------------------------------- */

/* "-2", ".1", "-2.1": what the library puts behind FILE. */
static bool is_ending(const char *text)
{
    const char *const marks = "-.";
    for (int i = 0; i < 2 && *text != '\0'; i++) {
        if (*text != marks[i]) {
            continue;
        }
        do {
            text++;
        } while (isdigit((unsigned char)*text));
        if (!isdigit((unsigned char)text[-1])) {
            return false;
        }
    }
    return *text == '\0';
}

static bool is_recording(int folder, const char *name)
{
    char magic[sizeof(RECORD_MAGIC)] = "";
    int fd = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    bool is_one = fd >= 0 && read(fd, magic, sizeof magic) == (ssize_t)sizeof magic &&
                  memcmp(magic, RECORD_MAGIC, sizeof magic) == 0;
    if (fd >= 0) {
        close(fd);
    }
    return is_one;
}

/* Files of an earlier recording beside FILE, which would pass for parts of this one. */
static int remove_others(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    size_t length = strlen(name);
    char *folder =
        slash != NULL ? strndup(path, (size_t)(slash + 1 - path)) : strdup(".");
    DIR *entries = folder != NULL ? opendir(folder) : NULL;
    int status = CTL_DONE;
    free(folder);
    for (struct dirent *entry; entries != NULL && (entry = readdir(entries)) != NULL;) {
        const char *end = entry->d_name + length;
        if (strncmp(entry->d_name, name, length) == 0 && *end != '\0' && is_ending(end) &&
            is_recording(dirfd(entries), entry->d_name) &&
            unlinkat(dirfd(entries), entry->d_name, 0) != 0) {
            status = ctl_complain("%s: %s", entry->d_name, strerror(errno));
        }
    }
    if (entries != NULL) {
        closedir(entries);
    }
    return status;
}

/* Make room for FILE, or say why there is none. What was there goes to *aside, ours to
 * free. */
static int clear(const struct record_command *command, char **aside)
{
    struct stat info;
    bool is_there = lstat(command->path, &info) == 0;
    if (is_there && !S_ISREG(info.st_mode) && !S_ISLNK(info.st_mode)) {
        return ctl_complain("%s is not a file", command->path); /* /dev/null */
    }
    if (is_there && asprintf(aside, "%s.before-%ld", command->path, (long)getpid()) < 0) {
        *aside = NULL;
        return ctl_complain("out of memory");
    }
    if (is_there && rename(command->path, *aside) != 0) {
        return ctl_complain("%s: %s", command->path, strerror(errno));
    }
    return remove_others(command->path);
}

/* Remove what was there, or put it back if nothing has come in its place. */
static void settle(const char *path, char *aside)
{
    if (aside != NULL && (access(path, F_OK) == 0 || rename(aside, path) != 0)) {
        (void)unlink(aside);
    }
    free(aside);
}

/* The file of a client of the program, from 1; NULL without memory. */
static char *name_of(const char *path, uint32_t client)
{
    size_t room = strlen(path) + 16;
    char *name = malloc(room);
    if (name != NULL) {
        snprintf(name, room, client == 1 ? "%s" : "%s-%" PRIu32, path, client);
    }
    return name;
}

static void note_files(const char *path, bool is_there[FILES_MAX + 1])
{
    for (uint32_t i = 1; i <= FILES_MAX; i++) {
        char *name = name_of(path, i);
        is_there[i] = name != NULL && access(name, F_OK) == 0;
        free(name);
    }
}

/* ---- telling ----------------------------------------------------------------------- */

static void tell_full(const char *path, const struct record_command *command)
{
    if (command->segments > 1) {
        ctl_complain("%s ends early: a segment (--max-bytes / --segments, %" PRIu64
                     " bytes) does not hold twice the meshes and positions that it "
                     "begins with",
                     path, command->max_bytes / command->segments);
    } else {
        ctl_complain("%s was full before the end: a larger --max-bytes keeps more, "
                     "--segments the newest part",
                     path);
    }
}

/* To stderr: the standard output is the program's. Whether all was written that was
 * asked for. */
static bool report(const char *path, const struct record_command *command)
{
    struct record_reader reader;
    struct answers answers = {.count = 0};
    struct ctl_error error = {.text = ""};
    int status = record_reader_open(&reader, path);
    if (status == PCCD_OK) {
        status = answers_read(&answers, &reader, &error);
    }
    size_t answered = answers.count;
    char questions[64] = "";
    if (answers.questions > 0) {
        (void)snprintf(questions, sizeof questions, "%" PRIu64 " %s about what is near, ",
                       answers.questions,
                       proto_plural(answers.questions, "question", "questions"));
    }
    ctl_complain("%s: %" PRIu64 " %s, %" PRIu64 " %s, %s%zu %s%s%s", path, reader.bytes,
                 proto_plural(reader.bytes, "byte", "bytes"), answers.frames,
                 proto_plural(answers.frames, "step", "steps"), questions, answered,
                 proto_plural(answered, "answer", "answers"),
                 status != PCCD_OK ? "; damaged " : "",
                 status != PCCD_OK ? reader.text : "");
    bool is_unwritten = reader.end_reason == RECORD_UNWRITTEN;
    if (is_unwritten) {
        ctl_complain("%s could not be written to its end: what came then is lost; is "
                     "there room on the disk?",
                     path);
    } else if (reader.end_reason == RECORD_FULL) {
        tell_full(path, command);
    } else if (reader.end_reason == RECORD_APART) {
        ctl_complain("%s ends before its program: what came next could not be repeated, "
                     "as a mesh became a part of one over ranks, or what others did was "
                     "not known",
                     path);
    }
    answers_deinit(&answers);
    record_reader_deinit(&reader);
    return status == PCCD_OK && !is_unwritten;
}

/* Returns an exit status: whether anything was recorded, and written. */
static int report_all(const struct record_command *command,
                      const bool was_there[FILES_MAX + 1])
{
    bool is_there[FILES_MAX + 1];
    uint32_t count = 0;
    bool is_written = true;
    note_files(command->path, is_there);
    for (uint32_t i = 1; i <= FILES_MAX; i++) {
        char *name = is_there[i] && !was_there[i] ? name_of(command->path, i) : NULL;
        if (name != NULL) {
            is_written = report(name, command) && is_written;
            count++;
        }
        free(name);
    }
    if (count == 0) {
        return ctl_complain("nothing was recorded: the program has not connected to a "
                            "daemon through libpccd");
    }
    return is_written ? CTL_DONE : CTL_FAILED;
}

int ctl_cmd_record(int argc, char **argv)
{
    struct record_command command = {.level = LEVEL_UNSET};
    char *name = NULL, *aside = NULL;
    if (option_parse(&ctl_table_record, argc, argv, &command) != 0) {
        return CTL_USAGE;
    }
    bool was_there[FILES_MAX + 1];
    bool has_run = false;
    if (command.path == NULL) {
        command.path = name = output_name(command.program.list[0], ".rec");
    }
    int status =
        command.path != NULL ? clear(&command, &aside) : ctl_complain("out of memory");
    if (status == CTL_DONE) {
        status = set_environment(&command);
    }
    if (status == CTL_DONE) {
        note_files(command.path, was_there);
        status = run_asked(&command, &has_run);
    }
    if (has_run) {
        int recorded = report_all(&command, was_there);
        status = status != 0 ? status : recorded; /* the program's error comes first */
    }
    settle(command.path, aside);
    free(name);
    return status;
}
