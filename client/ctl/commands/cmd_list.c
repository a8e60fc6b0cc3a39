/* cmd_list.c - pccdctl list. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "sessions.h"
#include "shown.h"
#include "terminal.h"

enum what { SESSIONS, SCENES, OBJECTS, PAIRS, MESHES };

struct list_options {
    struct ctl_link link;
    struct option_arguments arguments;
    enum what what;
    uint64_t session; /* 0: all */
    bool is_json;
};

static void check(struct argp_state *state, void *to)
{
    struct list_options *options = to;
    const struct option_arguments *arguments = &options->arguments;
    if (arguments->count > 1) {
        option_misused(state, "one thing is listed at a time");
    }
    if (arguments->count > 0) {
        options->what = (enum what)option_word(state, NULL, arguments->list[0],
                                               strlen(arguments->list[0]),
                                               "sessions|scenes|objects|pairs|meshes");
    }
}

static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = offsetof(struct list_options, arguments)},
    CTL_QUESTION,
    {"session", 0, "N", "List only what belongs to session N", OPTION_U64,
     .at = offsetof(struct list_options, session), .min = 1, .max = INT64_MAX},
    CTL_OUTPUT,
    {"json", 0, NULL, "A JSON array", OPTION_FLAG,
     .at = offsetof(struct list_options, is_json)},
    {0}};

const struct option_table ctl_table_list = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct list_options, link)}, {0}},
    .check = check,
    .arguments = "[sessions|scenes|objects|pairs|meshes]",
    .text = "List what a daemon has: sessions (the default), scenes, objects, pairs "
            "of objects that ignore each other, or meshes, of this user, or of "
            "everybody for the daemon's own user and root.",
    .examples = "  pccdctl list\n"
                "  pccdctl list scenes --json\n",
};

/* One list being printed; session and scene say whose it is. */
struct printer {
    bool is_json;
    json_t *array;
    uint64_t session;
    uint32_t scene;
};

static void print_session(struct printer *printer, const struct session_row *row)
{
    const struct pccd_session_info *info = &row->info;
    const char *state = sessions_state(info);
    if (!printer->is_json) {
        printf("%7" PRIu64 " %7" PRIu32 " %s %s %6" PRIu32 " %7" PRIu32 " %6" PRIu32
               " %9s %9s %10" PRIu64 " %10s%s%s\n",
               info->session, info->pid, tool_shown_column(format_user(info->uid), 10),
               tool_shown_column(row->name, 20), info->scenes, info->objects,
               info->meshes, format_count((double)info->triangles),
               format_bytes((double)info->shm_bytes), info->steps,
               format_span(info->ns_open), state[0] != '\0' ? " " : "", state);
        return;
    }
    json_array_append_new(
        printer->array,
        json_pack(
            "{s:I, s:I, s:I, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, "
            "s:b, s:I, s:I}",
            "session", (json_int_t)info->session, "pid", (json_int_t)info->pid, "uid",
            (json_int_t)info->uid, "client", row->name, "scenes",
            (json_int_t)info->scenes, "objects", (json_int_t)info->objects, "meshes",
            (json_int_t)info->meshes, "triangles", (json_int_t)info->triangles,
            "shm_bytes", (json_int_t)info->shm_bytes, "steps", (json_int_t)info->steps,
            "contacts", (json_int_t)info->contacts, "errors", (json_int_t)info->errors,
            "requests", (json_int_t)info->requests, "ns_open", (json_int_t)info->ns_open,
            "waiting", info->waiting, "batch", (json_int_t)info->batch, "batch_done",
            (json_int_t)info->batch_done));
}

/* "cloth" rw-r-----, 2 take part; "" for a scene that is not shared. */
static const char *sharing(const struct scene_row *row)
{
    static char text[400];
    const struct pccd_scene_info *info = &row->info;
    char rights[10] = "---------";
    for (uint32_t i = 0; i < 9; i++) {
        if ((info->rights >> (8 - i) & 1u) != 0) {
            rights[i] = "rwx"[i % 3];
        }
    }
    if (row->name[0] == '\0') {
        return "";
    }
    snprintf(text, sizeof text,
             " \"%s\" of %s %s, %" PRIu32 " %s part, %" PRIu32 " held%s",
             tool_shown(row->name), tool_shown(format_user(info->uid)), rights,
             info->members, proto_plural(info->members, "takes", "take"), info->held,
             info->writable ? "" : ", reads");
    return text;
}

static void print_scene(struct printer *printer, const struct scene_row *row)
{
    const struct pccd_scene_info *info = &row->info;
    char hash[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, info->hash, hash);
    if (!printer->is_json) {
        printf("%7" PRIu64 " %#10" PRIx32 " %7" PRIu32 " %10" PRIu64 " %10" PRIu64
               " %10s %7" PRIu32 " %-34s%s\n",
               printer->session, info->scene, info->objects, info->steps, info->total,
               format_ms((double)info->ns_step / 1e6), info->ignored,
               info->steps > 0 ? hash : "-", sharing(row));
        return;
    }
    json_array_append_new(
        printer->array,
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:s, s:f, s:I, s:s, s:I, s:I, s:I, "
                  "s:I, s:b}",
                  "session", (json_int_t)printer->session, "scene",
                  (json_int_t)info->scene, "objects", (json_int_t)info->objects, "steps",
                  (json_int_t)info->steps, "last_number", (json_int_t)info->number,
                  "last_total", (json_int_t)info->total, "last_hash", hash, "last_ms",
                  (double)info->ns_step / 1e6, "ignored_pairs", (json_int_t)info->ignored,
                  "name", row->name, "uid", (json_int_t)info->uid, "rights",
                  (json_int_t)info->rights, "members", (json_int_t)info->members, "held",
                  (json_int_t)info->held, "writable", info->writable));
}

static void print_object(void *context, const struct pccd_object_info *info)
{
    struct printer *printer = context;
    char group[20], mask[20]; /* JSON has no numbers of 64 bits */
    snprintf(group, sizeof group, "0x%" PRIx64, info->group);
    snprintf(mask, sizeof mask, "0x%" PRIx64, info->mask);
    if (!printer->is_json) {
        printf("%7" PRIu64 " %#10" PRIx32 " %#10" PRIx32 " %#10" PRIx32 " %10" PRIu64
               " %7" PRIu64 " %18" PRIx64 " %18" PRIx64 " %s %10g %10g %5" PRIu32 "\n",
               printer->session, printer->scene, info->object, info->mesh,
               info->triangles, info->owner, info->group, info->mask,
               info->self_collision ? "self" : "-   ", info->radius, info->rest_distance,
               info->rest_rings);
        return;
    }
    json_array_append_new(
        printer->array,
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:s, s:s, s:b, s:f, s:f, s:I}",
                  "session", (json_int_t)printer->session, "scene",
                  (json_int_t)printer->scene, "object", (json_int_t)info->object, "mesh",
                  (json_int_t)info->mesh, "triangles", (json_int_t)info->triangles,
                  "owner", (json_int_t)info->owner, "group", group, "mask", mask,
                  "self_collision", info->self_collision, "radius", info->radius,
                  "rest_distance", info->rest_distance, "rest_rings",
                  (json_int_t)info->rest_rings));
}

static void print_pair(void *context, const struct pccd_ignored_pair *pair)
{
    struct printer *printer = context;
    if (!printer->is_json) {
        printf("%7" PRIu64 " %#10" PRIx32 " %#10" PRIx32 " %#10" PRIx32 "\n",
               printer->session, printer->scene, pair->object_a, pair->object_b);
        return;
    }
    json_array_append_new(
        printer->array,
        json_pack("{s:I, s:I, s:I, s:I}", "session", (json_int_t)printer->session,
                  "scene", (json_int_t)printer->scene, "object_a",
                  (json_int_t)pair->object_a, "object_b", (json_int_t)pair->object_b));
}

static void print_mesh(void *context, const struct pccd_registered_mesh *info)
{
    struct printer *printer = context;
    if (!printer->is_json) {
        printf("%7" PRIu64 " %#10" PRIx32 " %10" PRIu32 " %10" PRIu32 " %7" PRIu64
               " %10" PRIu32 " %s\n",
               printer->session, info->mesh, info->vertex_count, info->triangle_count,
               info->objects, info->generation,
               !info->committed  ? "being filled"
               : info->replacing ? "being replaced"
                                 : "committed");
        return;
    }
    json_array_append_new(
        printer->array,
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:b, s:b}", "session",
                  (json_int_t)printer->session, "mesh", (json_int_t)info->mesh,
                  "vertices", (json_int_t)info->vertex_count, "triangles",
                  (json_int_t)info->triangle_count, "named_edges",
                  (json_int_t)info->edge_count, "named_points",
                  (json_int_t)info->point_count, "objects", (json_int_t)info->objects,
                  "generation", (json_int_t)info->generation, "committed",
                  info->committed, "replacing", info->replacing));
}

/* Of one session. What has gone since the list was read is not there. */
static int print_of(struct pccd_client *client, enum what what, struct printer *printer,
                    const struct session_row *row)
{
    struct scenes scenes = {.rows = NULL};
    int status = PCCD_OK;
    printer->session = row->info.session;
    if (what == SESSIONS) {
        print_session(printer, row);
    } else if (what == MESHES) {
        status = pccd_list_meshes(client, printer->session, print_mesh, printer);
    } else {
        status = scenes_read(client, printer->session, &scenes);
        for (uint32_t i = 0; i < scenes.count && status == PCCD_OK; i++) {
            printer->scene = scenes.rows[i].info.scene;
            if (what == PAIRS) {
                status = pccd_list_pairs(client, printer->session, printer->scene,
                                         print_pair, printer);
            } else if (what == SCENES) {
                print_scene(printer, &scenes.rows[i]);
            } else {
                status = pccd_list_objects(client, printer->session, printer->scene,
                                           print_object, printer);
            }
        }
    }
    scenes_deinit(&scenes);
    return status == PCCD_E_HANDLE ? PCCD_OK : status;
}

static void print_head(enum what what)
{
    static const char *const heads[] = {
        [SESSIONS] =
            "SESSION     PID USER       CLIENT               SCENES OBJECTS MESHES "
            "TRIANGLES    SHARED      STEPS   OPEN FOR",
        [SCENES] =
            "SESSION      SCENE OBJECTS      STEPS   CONTACTS  LAST STEP IGNORED HASH OF "
            "THE LAST ANSWER            SHARED",
        [OBJECTS] = "SESSION      SCENE     OBJECT       MESH  TRIANGLES   OWNER     "
                    "         GROUP               MASK MEETS     RADIUS       REST RINGS",
        [PAIRS] = "SESSION      SCENE   OBJECT A   OBJECT B",
        [MESHES] = "SESSION       MESH   VERTICES  TRIANGLES OBJECTS GENERATION STATE"};
    printf("%s%s%s\n", terminal_begin(TERMINAL_BOLD), heads[what], terminal_end());
}

static int list(struct pccd_client *client, const struct list_options *options)
{
    struct sessions sessions = {.rows = NULL};
    struct printer printer = {.is_json = options->is_json, .array = json_array()};
    int status = sessions_read(client, &sessions);
    if (status == PCCD_OK && options->session != 0 &&
        sessions_find(&sessions, options->session) == NULL) {
        sessions_deinit(&sessions);
        json_decref(printer.array);
        return ctl_complain("there is no session %" PRIu64
                            ", or it is another user's; pccdctl list shows them",
                            options->session);
    }
    if (status == PCCD_OK && !options->is_json) {
        print_head(options->what);
    }
    for (uint32_t i = 0; i < sessions.count && status == PCCD_OK; i++) {
        const struct session_row *row = &sessions.rows[i];
        if (options->session == 0 || row->info.session == options->session) {
            status = print_of(client, options->what, &printer, row);
        }
    }
    if (status == PCCD_OK && options->is_json) {
        json_dumpf(printer.array, stdout, JSON_TEXT_FLAGS);
        putchar('\n');
    }
    sessions_deinit(&sessions);
    json_decref(printer.array);
    return status == PCCD_OK ? CTL_DONE
                             : ctl_complain("list: %s", pccd_error_text(client));
}

int ctl_cmd_list(int argc, char **argv)
{
    struct list_options options = {.link = {.policy = CTL_LINK_EXISTING}};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_list, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    options.link.observes = options.what != PAIRS; /* these come through shared memory */
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE) {
        status = list(client, &options);
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}
