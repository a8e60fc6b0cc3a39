/* commandline.c - what the command line decides. */
#include "commandline.h"

#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "allow.h"
#include "option_table.h"
#include "proto_limits.h"
#include "seqpacket.h"
#include "settings.h"
#include "supervise.h"

const char *argp_program_version = "pccdd " PACKAGE_VERSION;

/* Its row says where it goes, and `max` how many bytes there are. */
static void take_path(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    size_t bytes = strlen(text);
    if (bytes == 0 || bytes >= (size_t)row->max) {
        option_misused(state, "--%s: a path has 1 to %zu bytes, this one %zu", row->name,
                       (size_t)row->max - 1, bytes);
    }
    strcpy((char *)to + row->at, text);
}

static void take_user(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct srv_options *options = to;
    (void)row;
    if (!srv_allow_user(&options->allow, text)) {
        option_misused(state, "--allow-uid: no user \"%s\", or more than %u", text,
                       SRV_ALLOW_MAX);
    }
}

static void take_group(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct srv_options *options = to;
    (void)row;
    if (!srv_allow_group(&options->allow, text)) {
        option_misused(state, "--allow-gid: no group \"%s\", or more than %u", text,
                       SRV_ALLOW_MAX);
    }
}

static_assert(SRV_PIN_AUTO == 0 && SRV_PIN_ON == 1 && SRV_PIN_OFF == 2 &&
                  SRV_SANDBOX_AUTO == 0 && SRV_SANDBOX_ON == 1 && SRV_SANDBOX_OFF == 2,
              "by place in auto|on|off");
static_assert(SRV_LOG_ERROR == 0 && SRV_LOG_DEBUG == 3, "by place in error|..|debug");
static_assert(SRV_LOG_TEXT == 0 && SRV_LOG_JSON == 1, "by place in text|json");

#define AT(member) offsetof(struct srv_options, member)

/* Make a setting an option. */
#define FORM_u32    OPTION_U32
#define FORM_u64    OPTION_U64
#define FORM_level  OPTION_WORD
#define START(most) most
#define ROW(ID, name, letter, argument, form, member, least, most, units, text, later,   \
            first)                                                                       \
    {name,         letter,           argument,     text " (default: " first ")",         \
     FORM_##form,  .at = AT(member), .min = least, .max = most,                          \
     .unit = units},
static const struct option_row rows[] = {
    {.help = "Where and how long:", .at = 1},
    {"socket", 's', "PATH",
     "listen there (default: $XDG_RUNTIME_DIR/pccd/pccd.sock, or "
     "/tmp/pccd-UID/pccd.sock)",
     OPTION_OWN, .at = AT(socket_path), .max = SRV_SOCKET_PATH_BYTES, .take = take_path},
    {"private", 0, NULL, "exit with the last client, or after 10 s if none comes",
     OPTION_FLAG, .at = AT(private_daemon)},
    SRV_SETTINGS_OF_LIFE(ROW)
    {"supervise", 0, NULL,
     "stay as a small parent that starts the daemon again when it crashes", OPTION_FLAG,
     .at = AT(supervise)},
    {"crashes-max", 0, "N",
     "supervise: give up after that many crashes within 10 s (default 5)", OPTION_U32,
     .at = AT(crashes_max), .min = 1, .max = SRV_CRASHES_LIMIT},
    {"sandbox", 0, "auto|on|off",
     "allow only the system calls that serving needs: on, off, or auto (default: on "
     "where the system can do it)",
     OPTION_WORD, .at = AT(sandbox)},
    {"ready-fd", 0, "N",
     "write the byte 1 to this descriptor and close it when listening", OPTION_U32,
     .at = AT(ready_fd), .max = 1u << 20},
    {"log-format", 0, "text|json",
     "text (default), or json: one object a line, for programs that collect logs",
     OPTION_WORD, .at = AT(log_format)},
    {"log-file", 0, "FILE",
     "append messages to FILE, and open it anew on SIGHUP (default: standard error)",
     OPTION_OWN, .at = AT(log_path), .max = SRV_PATH_BYTES, .take = take_path},
    {"config", 0, "FILE",
     "read options from lines NAME = VALUE of FILE, and on SIGHUP again; those of the "
     "command line come after them",
     OPTION_OWN, .at = AT(config_path), .max = SRV_PATH_BYTES, .take = take_path},
    {"allow-uid", 0, "USER",
     "let this user be a client, besides root and the daemon's own; may be repeated "
     "(default: whoever can reach the socket)",
     OPTION_OWN, .take = take_user},
    {"allow-gid", 0, "GROUP",
     "let the members of this group be clients, too; may be repeated", OPTION_OWN,
     .take = take_group},

    {.help = "Computing:", .at = 2},
    SRV_SETTINGS_OF_COMPUTING(ROW)
    {"pin", 0, "auto|on|off",
     "bind each thread of a step to a processor of its own: on, off, or auto (default: "
     "when --threads is the number of processors that may be used)",
     OPTION_WORD, .at = AT(pin)},

    {.help = "Quotas of one user:", .at = 3},
    SRV_SETTINGS_OF_USER(ROW)

    {.help = "Bounds of all users together:", .at = 4},
    SRV_SETTINGS_OF_ALL(ROW)
    {0}};

static uint32_t cpu_count(void)
{
    cpu_set_t cpus;
    if (sched_getaffinity(0, sizeof cpus, &cpus) != 0) {
        return 1; /* more CPUs than cpu_set_t holds: --threads says how many to use */
    }
    return (uint32_t)CPU_COUNT(&cpus);
}

/* Half of what the machine has; 1 GiB where it does not say. */
static uint64_t half_of_memory(void)
{
    long pages = sysconf(_SC_PHYS_PAGES);
    long page_bytes = sysconf(_SC_PAGESIZE);
    return pages > 0 && page_bytes > 0 ? (uint64_t)pages * (uint64_t)page_bytes / 2
                                       : 1ull << 30;
}

static uint64_t shared_memory(void)
{
    uint64_t eighth = half_of_memory() / 4 >> 20 << 20;
    return eighth > PROTO_SHM_BYTES_PER_UID ? eighth : PROTO_SHM_BYTES_PER_UID;
}

static const struct option_table table = {
    .rows = rows,
    .text = "Continuous collision detection of deforming triangle meshes, as a service "
            "for the processes of this machine.",
    .examples = "  pccdd --supervise\n"
                "  pccdd --socket /tmp/pccd.sock --threads 4 --log-level warn\n"};

static void set_defaults(struct srv_options *options)
{
    *options = (struct srv_options){
        .threads_max = cpu_count(),
        .connections_max = 1024,
        .scenes_max = PROTO_SCENES_PER_CLIENT,
        .inflight_max = PROTO_INFLIGHT_MAX,
        .queue_max = 32768,
        .contacts_max = PROTO_CONTACTS_PER_STEP,
        .quota = {[SRV_QUOTA_CLIENTS] = PROTO_CLIENTS_PER_UID,
                  [SRV_QUOTA_SHM_BYTES] = shared_memory(),
                  [SRV_QUOTA_MESHES] = PROTO_MESHES_PER_UID,
                  [SRV_QUOTA_TRIANGLES] = PROTO_TRIANGLES_PER_UID},
        .engine_bytes_max = half_of_memory(),
        .memory_total_max = half_of_memory() / 2 * 3,
        .grace_s = 10,
        .crashes_max = SRV_CRASHES_MAX,
        .linger_s = PROTO_LINGER_S,
        .ready_fd = -1,
        .listen_fd = -1,
        .log_level = SRV_LOG_INFO,
    };
}

static void parse(struct srv_options *options, int argc, char **argv)
{
    if (option_parse(&table, argc, argv, options) != 0) {
        fputs("pccdd: out of memory\n", stderr);
        exit(1);
    }
}

/* ---- the configuration file -------------------------------------------------------- */

struct search {
    const char *name;
    const struct option_row *row; /* NULL: there is none of that name */
};

static void look_at_row(void *context, const struct option_row *row)
{
    struct search *search = context;
    search->row = strcmp(row->name, search->name) == 0 ? row : search->row;
}

static const struct option_row *find_row(const char *name)
{
    struct search search = {.name = name};
    option_each(&table, look_at_row, &search);
    return search.row;
}

/* Return what is wrong with a line, but for the value; NULL: nothing. */
static const char *look_at_line(const struct option_row *row, const char *value)
{
    return row == NULL ? "there is no such setting"
           : row->at == AT(ready_fd) || row->at == AT(config_path)
               ? "this is for the command line"
           : row->type == OPTION_FLAG && strcmp(value, "yes") != 0 &&
                   strcmp(value, "no") != 0
               ? "yes or no is wanted"
               : NULL;
}

const char *srv_option_wrong(const struct srv_settings_line *line)
{
    const struct option_row *row = find_row(line->name);
    const char *wrong = look_at_line(row, line->value);
    char words[64], word[sizeof line->value + 2], *end;
    bool is_value = true;
    if (wrong == NULL && row->type == OPTION_WORD) {
        snprintf(words, sizeof words, "|%s|", row->arg);
        snprintf(word, sizeof word, "|%s|", line->value);
        is_value = strstr(words, word) != NULL && strchr(line->value, '|') == NULL;
    } else if (wrong == NULL && row->type == OPTION_U32) {
        unsigned long number = strtoul(line->value, &end, 10);
        is_value = *end == '\0' && number >= row->min && number <= row->max;
    }
    return is_value ? wrong : "there is no such value";
}

/* Take one line as the option that it names. What is wrong ends the program. */
static void take_line(struct srv_options *options, const char *path,
                      const struct srv_settings_line *line)
{
    char place[SRV_PATH_BYTES + 32], word[sizeof line->name + sizeof line->value + 4];
    char *argv[] = {program_invocation_name, word, NULL};
    const struct option_row *row = find_row(line->name);
    const char *wrong = look_at_line(row, line->value);
    snprintf(place, sizeof place, "%s:%u", path, line->number);
    if (wrong != NULL) {
        fprintf(stderr, "pccdd: %s: %s: %s\n", place, line->name, wrong);
        exit(argp_err_exit_status);
    }
    if (row->type != OPTION_FLAG) {
        snprintf(word, sizeof word, "--%s=%s", line->name, line->value);
    } else if (strcmp(line->value, "yes") == 0) {
        snprintf(word, sizeof word, "--%s", line->name);
    } else {
        return;
    }
    option_set_place(place);
    parse(options, 2, argv);
    option_set_place(NULL);
}

/* Take the file over the defaults, and the command line over the file. */
static void parse_file(struct srv_options *options, int argc, char **argv)
{
    static struct srv_settings_file file;
    char error[SRV_SETTINGS_ERROR_BYTES];
    char path[SRV_PATH_BYTES];
    strcpy(path, options->config_path);
    if (!srv_kept_file(&file) && !srv_settings_file_read(&file, path, error)) {
        fprintf(stderr, "pccdd: %s\n", error);
        exit(argp_err_exit_status);
    }
    set_defaults(options);
    for (uint32_t i = 0; i < file.count; i++) {
        take_line(options, path, &file.lines[i]);
    }
    parse(options, argc, argv);
    options->config = &file;
}

void srv_options_parse(struct srv_options *options, int argc, char **argv)
{
    set_defaults(options);
    parse(options, argc, argv);
    if (options->config_path[0] != '\0') {
        parse_file(options, argc, argv);
    }
    if (options->socket_path[0] == '\0' &&
        proto_default_socket_path(options->socket_path, sizeof options->socket_path) !=
            0) {
        fprintf(stderr, "pccdd: the default socket path is too long; use --socket\n");
        exit(1);
    }
}
