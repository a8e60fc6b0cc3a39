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
    options->link.observes = options->what != PAIRS; /* these come by shared memory */
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

/* One list being made; session and scene say whose it is. */
struct printer {
    bool is_json;
    json_t *array;
    char *rows; /* ours: [count] of row_bytes each, for people */
    size_t row_bytes;
    uint32_t count, capacity;
    bool has_memory;
    uint64_t session;
    uint32_t scene;
};

/* Keep a row, which points at nothing that goes before the list is printed. */
static void keep_row(struct printer *printer, const struct column *columns,
                     const void *row, size_t bytes)
{
    if (printer->is_json) {
        json_array_append_new(printer->array, columns_json(columns, row));
        return;
    }
    if (printer->count == printer->capacity) {
        uint32_t capacity = 2 * printer->capacity + 16;
        char *more = realloc(printer->rows, capacity * bytes);
        if (more == NULL) {
            printer->has_memory = false;
            return;
        }
        printer->rows = more;
        printer->capacity = capacity;
    }
    memcpy(printer->rows + printer->count++ * bytes, row, bytes);
    printer->row_bytes = bytes;
}

#define OF(member) COLUMN_OF(struct session_row, member)
static const struct column session_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(info.session), .rank = 1},
    {"pid", "PID", COLUMN_NUMBER, OF(info.pid), .rank = 4},
    {"uid", "USER", COLUMN_USER, OF(info.uid), .is_left = true, .cut = 10, .rank = 7},
    {"client", "CLIENT", COLUMN_CHARS, OF(name), .is_left = true, .cut = 20, .rank = 2},
    {"scenes", "SCENES", COLUMN_NUMBER, OF(info.scenes), .rank = 8},
    {"objects", "OBJECTS", COLUMN_NUMBER, OF(info.objects), .rank = 9},
    {"meshes", "MESHES", COLUMN_NUMBER, OF(info.meshes), .rank = 12},
    {"triangles", "TRIANGLES", COLUMN_COUNT, OF(info.triangles), .rank = 5},
    {"shm_bytes", "SHARED", COLUMN_BYTES, OF(info.shm_bytes), .rank = 10},
    {"steps", "STEPS", COLUMN_NUMBER, OF(info.steps), .rank = 3},
    {"steps_incomplete", "INCOMPLETE", COLUMN_NUMBER, OF(info.steps_incomplete),
     .rank = 6},
    {"contacts", .type = COLUMN_NUMBER, OF(info.contacts)},
    {"errors", .type = COLUMN_NUMBER, OF(info.errors)},
    {"requests", .type = COLUMN_NUMBER, OF(info.requests)},
    {"ns_open", "OPEN FOR", COLUMN_SPAN, OF(info.ns_open), .rank = 11},
    {NULL, "", COLUMN_CHARS, OF(state), .rank = 13},
    {"waiting", .type = COLUMN_FLAG, OF(info.waiting)},
    {"batch", .type = COLUMN_NUMBER, OF(info.batch)},
    {"batch_done", .type = COLUMN_NUMBER, OF(info.batch_done)},
    {0}};
#undef OF

/* ---- scenes ------------------------------------------------------------------------ */

struct scene_line {
    uint64_t session;
    struct scene_row row;
    char hash[PROTO_HASH_BYTES];
    char last_hash[PROTO_HASH_BYTES]; /* "-": it has no step yet */
    char sharing[400];
};

#define OF(member) COLUMN_OF(struct scene_line, member)
static const struct column scene_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(session), .rank = 1},
    {"scene", "SCENE", COLUMN_HANDLE, OF(row.info.scene), .rank = 2},
    {"objects", "OBJECTS", COLUMN_NUMBER, OF(row.info.objects), .rank = 6},
    {"steps", "STEPS", COLUMN_NUMBER, OF(row.info.steps), .rank = 3},
    {"last_number", .type = COLUMN_NUMBER, OF(row.info.number)},
    {"last_total", "CONTACTS", COLUMN_NUMBER, OF(row.info.total), .rank = 4},
    {"last_hash", .type = COLUMN_CHARS, OF(hash)},
    {"last_ms", "LAST STEP", COLUMN_NS, OF(row.info.ns_step), .rank = 5},
    {"ignored_pairs", "IGNORED", COLUMN_NUMBER, OF(row.info.ignored), .rank = 9},
    {NULL, "HASH OF THE LAST ANSWER", COLUMN_CHARS, OF(last_hash), .is_left = true,
     .rank = 8},
    {"name", .type = COLUMN_CHARS, OF(row.name)},
    {NULL, "SHARED", COLUMN_CHARS, OF(sharing), .rank = 7},
    {"uid", .type = COLUMN_NUMBER, OF(row.info.uid)},
    {"rights", .type = COLUMN_NUMBER, OF(row.info.rights)},
    {"members", .type = COLUMN_NUMBER, OF(row.info.members)},
    {"held", .type = COLUMN_NUMBER, OF(row.info.held)},
    {"writable", .type = COLUMN_FLAG, OF(row.info.writable)},
    {0}};
#undef OF

/* "cloth" rw-r-----, 2 take part; "" for a scene that is not shared. */
static void describe_sharing(struct scene_line *line)
{
    const struct pccd_scene_info *info = &line->row.info;
    char rights[10] = "---------";
    for (uint32_t i = 0; i < 9; i++) {
        if ((info->rights >> (8 - i) & 1u) != 0) {
            rights[i] = "rwx"[i % 3];
        }
    }
    if (line->row.name[0] != '\0') {
        snprintf(line->sharing, sizeof line->sharing,
                 "\"%s\" of %s %s, %" PRIu32 " %s part, %" PRIu32 " held%s",
                 line->row.name, format_user(info->uid), rights, info->members,
                 proto_plural(info->members, "takes", "take"), info->held,
                 info->writable ? "" : ", reads");
    }
}

static void print_scene(struct printer *printer, const struct scene_row *row)
{
    struct scene_line line = {.session = printer->session, .row = *row};
    proto_hash_text(PCCD_HASH_VERSION, row->info.hash, line.hash);
    snprintf(line.last_hash, sizeof line.last_hash, "%s",
             row->info.steps > 0 ? line.hash : "-");
    describe_sharing(&line);
    keep_row(printer, scene_columns, &line, sizeof line);
}

/* ---- objects, pairs, meshes -------------------------------------------------------- */

struct object_line {
    uint64_t session;
    uint32_t scene;
    struct pccd_object_info info;
    char group[20], mask[20]; /* JSON has no numbers of 64 bits */
    const char *self;
    char name[256]; /* in the place of info.name */
};

#define OF(member) COLUMN_OF(struct object_line, member)
static const struct column object_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(session), .rank = 1},
    {"scene", "SCENE", COLUMN_HANDLE, OF(scene), .rank = 7},
    {"object", "OBJECT", COLUMN_HANDLE, OF(info.object), .rank = 2},
    {"name", "NAME", COLUMN_CHARS, OF(name), .is_left = true, .cut = 24, .rank = 3},
    {"mesh", "MESH", COLUMN_HANDLE, OF(info.mesh), .rank = 4},
    {"triangles", "TRIANGLES", COLUMN_NUMBER, OF(info.triangles), .rank = 5},
    {"owner", "OWNER", COLUMN_NUMBER, OF(info.owner), .rank = 10},
    {"group", .type = COLUMN_CHARS, OF(group)},
    {"mask", .type = COLUMN_CHARS, OF(mask)},
    {NULL, "GROUP", COLUMN_CHARS, OF(group[2]), .rank = 8}, /* without its 0x */
    {NULL, "MASK", COLUMN_CHARS, OF(mask[2]), .rank = 9},
    {NULL, "MEETS", COLUMN_TEXT, OF(self), .is_left = true, .rank = 6},
    {"self_collision", .type = COLUMN_FLAG, OF(info.self_collision)},
    {"radius", "RADIUS", COLUMN_REAL, OF(info.radius), .rank = 11},
    {"rest_distance", "REST", COLUMN_REAL, OF(info.rest_distance), .rank = 12},
    {"rest_rings", "RINGS", COLUMN_NUMBER, OF(info.rest_rings), .rank = 13},
    {"user_data", "USER", COLUMN_NUMBER, OF(info.user_data), .rank = 14},
    {0}};
#undef OF

static void print_object(void *context, const struct pccd_object_info *info)
{
    struct printer *printer = context;
    struct object_line line = {.session = printer->session,
                               .scene = printer->scene,
                               .info = *info,
                               .self = info->self_collision ? "self" : "-"};
    line.info.name = NULL; /* `name` is to be used */
    snprintf(line.name, sizeof line.name, "%s", info->name);
    snprintf(line.group, sizeof line.group, "0x%" PRIx64, info->group);
    snprintf(line.mask, sizeof line.mask, "0x%" PRIx64, info->mask);
    keep_row(printer, object_columns, &line, sizeof line);
}

struct pair_line {
    uint64_t session;
    uint32_t scene;
    struct pccd_ignored_pair pair;
};

#define OF(member) COLUMN_OF(struct pair_line, member)
static const struct column pair_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(session), .rank = 1},
    {"scene", "SCENE", COLUMN_HANDLE, OF(scene), .rank = 2},
    {"object_a", "OBJECT A", COLUMN_HANDLE, OF(pair.object_a), .rank = 3},
    {"object_b", "OBJECT B", COLUMN_HANDLE, OF(pair.object_b), .rank = 4},
    {0}};
#undef OF

static void print_pair(void *context, const struct pccd_ignored_pair *pair)
{
    struct printer *printer = context;
    const struct pair_line line = {printer->session, printer->scene, *pair};
    keep_row(printer, pair_columns, &line, sizeof line);
}

struct mesh_line {
    uint64_t session;
    struct pccd_registered_mesh info;
    const char *state;
};

#define OF(member) COLUMN_OF(struct mesh_line, member)
static const struct column mesh_columns[] = {
    {"session", "SESSION", COLUMN_NUMBER, OF(session), .rank = 1},
    {"mesh", "MESH", COLUMN_HANDLE, OF(info.mesh), .rank = 2},
    {"vertices", "VERTICES", COLUMN_NUMBER, OF(info.vertex_count), .rank = 3},
    {"triangles", "TRIANGLES", COLUMN_NUMBER, OF(info.triangle_count), .rank = 4},
    {"named_edges", .type = COLUMN_NUMBER, OF(info.edge_count)},
    {"named_points", .type = COLUMN_NUMBER, OF(info.point_count)},
    {"objects", "OBJECTS", COLUMN_NUMBER, OF(info.objects), .rank = 5},
    {"generation", "GENERATION", COLUMN_NUMBER, OF(info.generation), .rank = 7},
    {NULL, "STATE", COLUMN_TEXT, OF(state), .is_left = true, .rank = 6},
    {"committed", .type = COLUMN_FLAG, OF(info.committed)},
    {"replacing", .type = COLUMN_FLAG, OF(info.replacing)},
    {0}};
#undef OF

static void print_mesh(void *context, const struct pccd_registered_mesh *info)
{
    struct printer *printer = context;
    const struct mesh_line line = {printer->session, *info,
                                   !info->committed  ? "being filled"
                                   : info->replacing ? "being replaced"
                                                     : "committed"};
    keep_row(printer, mesh_columns, &line, sizeof line);
}

/* ---- the walk ---------------------------------------------------------------------- */

/* Print what one session has. What has gone since the list was read is not there. */
static int print_of(struct pccd_client *client, enum what what, struct printer *printer,
                    const struct session_row *row)
{
    struct scenes scenes = {.rows = NULL};
    int status = PCCD_OK;
    printer->session = row->info.session;
    if (what == SESSIONS) {
        keep_row(printer, session_columns, row, sizeof *row);
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

static const struct column *const columns_of[] = {[SESSIONS] = session_columns,
                                                  [SCENES] = scene_columns,
                                                  [OBJECTS] = object_columns,
                                                  [PAIRS] = pair_columns,
                                                  [MESHES] = mesh_columns};

static int list(struct pccd_client *client, void *to)
{
    const struct list_options *options = to;
    struct sessions sessions = {.rows = NULL};
    struct printer printer = {
        .is_json = options->is_json, .array = json_array(), .has_memory = true};
    int status = sessions_read(client, &sessions);
    if (status == PCCD_OK && options->session != 0 &&
        sessions_find(&sessions, options->session) == NULL) {
        sessions_deinit(&sessions);
        json_decref(printer.array);
        return ctl_complain("there is no session %" PRIu64
                            ", or it is another user's; pccdctl list shows them",
                            options->session);
    }
    for (uint32_t i = 0; i < sessions.count && status == PCCD_OK; i++) {
        const struct session_row *row = &sessions.rows[i];
        if (options->session == 0 || row->info.session == options->session) {
            status = print_of(client, options->what, &printer, row);
        }
    }
    if (status == PCCD_OK && !printer.has_memory) {
        status = PCCD_E_NOMEM;
    } else if (status == PCCD_OK && !options->is_json) {
        columns_table(columns_of[options->what], printer.rows, printer.row_bytes,
                      printer.count, false);
    }
    (void)output_json(printer.array, status == PCCD_OK && options->is_json, stdout);
    sessions_deinit(&sessions);
    free(printer.rows);
    if (status == PCCD_E_NOMEM) {
        return ctl_complain("list: out of memory");
    }
    return status == PCCD_OK ? CTL_DONE
                             : ctl_complain("list: %s", pccd_error_text(client));
}

int ctl_cmd_list(int argc, char **argv)
{
    struct list_options options = {.link = {.policy = CTL_LINK_EXISTING}};
    return ctl_link_command(&ctl_table_list, argc, argv, &options.link, list);
}
