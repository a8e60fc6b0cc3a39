/* gendoc.c - the tables of PROTOCOL.md, from the manifest.
 *
 * Copies standard input to standard output and writes anew what stands between "<!--
 * begin: NAME -->" and "<!-- end: NAME -->"; with the argument `manual` the same for the
 * manual page, between "; begin: NAME" and "; end: NAME"; with the argument `manifest`
 * prints one line a field, which tests/abi compares with what was frozen.
 */
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "pccd_daemon.h"
#include "pccd_trace.h"

#define LINE_BYTES 4096

static const char *type_name(enum proto_type type)
{
    static const char *const names[] = {"u32", "u64", "f64", "bool", "str"};
    return names[type];
}

/* ---- prose ------------------------------------------------------------------------ */

static struct {
    FILE *to; /* open_memstream */
    char *text;
    size_t bytes;
} prose;

/* Begin a paragraph: what is printed to prose.to from here on. */
static void begin_prose(void)
{
    prose.to = open_memstream(&prose.text, &prose.bytes);
    if (prose.to == NULL) {
        abort();
    }
}

/* Print the paragraph in lines of at most 100 columns that begin with `indent`. */
static void end_prose(const char *indent)
{
    const size_t room = 100 - (indent[0] == '\t' ? 8 : 0);
    (void)fclose(prose.to);
    const char *text = prose.text;
    while (strlen(text) > room) {
        size_t end = room;
        while (text[end] != ' ') {
            end--;
        }
        printf("%s%.*s\n", indent, (int)end, text);
        text += end + 1;
    }
    printf("%s%s\n", indent, text);
    free(prose.text);
}

/* ---- tables ----------------------------------------------------------------------- */

static void print_methods(void)
{
    puts("| Method | Since | Before hello | Computed | Repeatable | Page | Does |\n"
         "|---|---|---|---|---|---|---|");
    for (int i = 0; i < PROTO_METHOD_COUNT; i++) {
        const struct proto_message_info *message = &proto_messages[i];
        printf("| `%s` | %u | %s | %s | %s | %s | %s |\n", message->name, message->since,
               message->flags & PROTO_F_BEFORE_HELLO ? "yes" : "",
               message->flags & PROTO_F_COMPUTE ? "yes" : "",
               message->flags & PROTO_F_REPEAT ? "yes" : "",
               message->flags & PROTO_F_HAS_PAGE ? "yes" : "", message->text);
    }
}

static void print_notifications(void)
{
    puts("| Notification | Since | Says |\n|---|---|---|");
    for (int i = PROTO_METHOD_COUNT; i < PROTO_MESSAGE_COUNT; i++) {
        const struct proto_message_info *message = &proto_messages[i];
        printf("| `%s` | %u | %s |\n", message->name, message->since, message->text);
    }
}

static void print_fields(const char *title, const struct proto_fields *fields)
{
    printf("| %s | Type | Needed | Meaning |\n|---|---|---|---|\n", title);
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        printf("| `%s` | %s | %s | %s |\n", field->name, type_name(field->type),
               field->need == PROTO_NEED_REQ ? "yes" : "", field->text);
    }
}

static bool is_same(const struct proto_fields *a, const struct proto_fields *b,
                    bool compares_needs)
{
    uint32_t same = 0;
    while (same < a->count && a->count == b->count && a->count > 1 &&
           strcmp(a->items[same].name, b->items[same].name) == 0 &&
           (!compares_needs || a->items[same].need == b->items[same].need)) {
        same++;
    }
    return same == a->count;
}

/* The first message before `method` with the same result, else with one that differs in
 * what is needed, else `method`. */
static int same_result(int method)
{
    const struct proto_fields *own = &proto_messages[method].result;
    for (int loose = 0; loose < 2; loose++) {
        for (int other = 0; other < method; other++) {
            if (is_same(own, &proto_messages[other].result, loose == 0)) {
                return other;
            }
        }
    }
    return method;
}

static void print_needs(const struct proto_fields *own, const struct proto_fields *other,
                        enum proto_need need, const char *title)
{
    const char *before = title;
    for (uint32_t i = 0; i < own->count; i++) {
        if (own->items[i].need == need && other->items[i].need != need) {
            fprintf(prose.to, "%s`%s`", before, own->items[i].name);
            before = ", ";
        }
    }
}

static void print_same_result(int method)
{
    const struct proto_message_info *other = &proto_messages[same_result(method)];
    const struct proto_fields *own = &proto_messages[method].result;
    puts("");
    begin_prose();
    fprintf(prose.to, "The result has the fields of `%s`", other->name);
    print_needs(own, &other->result, PROTO_NEED_REQ, "; needed are also ");
    print_needs(own, &other->result, PROTO_NEED_OPT, "; not needed are ");
    fputc('.', prose.to);
    end_prose("");
}

static void print_messages(void)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        const struct proto_message_info *message = &proto_messages[i];
        printf("%s### `%s`\n\n", i > 0 ? "\n" : "", message->name);
        begin_prose();
        fprintf(prose.to, "%c%s.", toupper((unsigned char)message->text[0]),
                message->text + 1);
        end_prose("");
        puts("");
        print_fields(i < PROTO_METHOD_COUNT ? "Param" : "Field", &message->request);
        if (i == PROTO_METHOD_STATS) {
            puts("\nThe result is the table of [counters](#counters).");
        } else if (i < PROTO_METHOD_COUNT && same_result(i) != i) {
            print_same_result(i);
        } else if (i < PROTO_METHOD_COUNT) {
            puts("");
            print_fields("Result", &message->result);
        }
    }
}

static void print_stats(void)
{
    const struct proto_fields *fields = &proto_messages[PROTO_METHOD_STATS].result;
    print_fields("Counter", fields);
}

static void print_statuses(void)
{
    puts("| Code | Name | Text |\n|---|---|---|");
#define ROW(name, value, text) printf("| %d | `%s` | %s |\n", value, #name, text);
    PCCD_STATUS_LIST(ROW)
#undef ROW
}

static void print_limit(const char *name, double value, const char *text)
{
    printf("| `%s` | %.17g | %s |\n", name, value, text);
}

static void print_limits(void)
{
    puts("| Limit | Value | Of |\n|---|---|---|");
#define LIMIT(name, text) print_limit(#name, (double)(name), text)
    LIMIT(PROTO_VERSION_MIN, "oldest protocol version");
    LIMIT(PROTO_VERSION_MAX, "newest protocol version");
    LIMIT(PROTO_MESSAGE_BYTES_MAX, "bytes of a message; it has at least 1");
    LIMIT(PROTO_DEPTH_MAX, "containers inside one another; an empty one does not count");
    LIMIT(PROTO_ELEMENTS_MAX, "MessagePack objects of a message, containers included");
    LIMIT(PROTO_STR_MAX, "bytes of a string");
    LIMIT(PROTO_MESSAGES_PER_TURN, "messages read from a client before the others' turn");
    LIMIT(PROTO_REPLIES_QUEUED_MAX,
          "replies that wait for a client; then it is not read");
    LIMIT(PROTO_REPLIES_KEPT,
          "requests without an answer of a resumable client; answers kept for it");
    LIMIT(PROTO_LINGER_S, "seconds that a session waits for its client (default)");
    LIMIT(PROTO_SLOTS_MAX, "slots of an upload ring");
    LIMIT(PROTO_INFLIGHT_MAX, "steps in flight of a client; `shm.attach` may say less");
    LIMIT(PROTO_SEGMENTS_MAX, "segments of a step, or of a batch");
    LIMIT(PROTO_BATCH_MAX, "scenes of a batch");
    LIMIT(PROTO_JOINTS_MAX, "joints of a table");
    LIMIT(PROTO_SLOT_BYTES_MIN, "bytes of a slot, at least");
    LIMIT(PROTO_RESULT_BYTES_MIN, "bytes of a result region, at least");
    LIMIT(PROTO_COUNT_MAX, "vertices, triangles or edges of a scene");
    LIMIT(PROTO_COORDINATE_MAX, "absolute value of a coordinate");
    LIMIT(PROTO_TRACE_EVENTS, "events kept of each thread in a trace (default)");
    LIMIT(PROTO_TRACE_EVENTS_MAX, "events kept of each thread in a trace");
    LIMIT(PROTO_TRACE_BYTES_MAX, "bytes of a trace");
    LIMIT(PROTO_SCENES_PER_CLIENT, "scenes of a client (default)");
    LIMIT(PROTO_SHARED_PER_CLIENT, "scenes that a client shares with others");
    LIMIT(PROTO_OBJECTS_PER_SCENE, "objects of a scene");
    LIMIT(PROTO_IGNORED_PER_SCENE,
          "pairs of objects of a scene that ignore each other, or have a clearance");
    LIMIT(PROTO_CLIENTS_PER_UID, "clients of a user (default)");
    LIMIT(PROTO_SHM_BYTES_PER_UID,
          "bytes of shared memory of a user; an eighth of the machine's if that is more "
          "(default)");
    LIMIT(PROTO_MESHES_PER_UID, "meshes of a user (default)");
    LIMIT(PROTO_TRIANGLES_PER_UID, "triangles of the meshes of a user (default)");
    LIMIT(PROTO_CONTACTS_PER_STEP, "records that are kept of a step (default)");
#undef LIMIT
}

static void print_enum(const char *name)
{
    printf("\n`enum %s`\n\n| Value | Name | Meaning |\n|---|---|---|\n", name);
}

static void print_value(const char *name, unsigned value, const char *text)
{
    printf("| %u | `%s` | %s |\n", value, name, text);
}

#define VALUE(name, text) print_value(#name, (unsigned)(name), text)

/* Print the enums of the parameters of a step. */
static void print_step_enums(void)
{
    print_enum("pccd_mode");
    VALUE(PCCD_MODE_ALL, "every contact");
    VALUE(PCCD_MODE_FIRST, "the contacts that may attain the scene's earliest time");
    VALUE(PCCD_MODE_ANY, "whether there is a contact; no records");
    VALUE(PCCD_MODE_PAIRS, "the pairs that neither x, y nor z separates");
    VALUE(PCCD_MODE_FIRST_PER_PAIR,
          "for each two objects that meet, and each that meets itself, the contact of "
          "the least toi; of several the first in canonical order");
    print_enum("pccd_method");
    VALUE(PCCD_METHOD_DEFAULT, "wide; paper where its scheduler is asked for");
    VALUE(PCCD_METHOD_PAPER, "binary tree of boxes over triangles");
    VALUE(PCCD_METHOD_WIDE, "trees of 16 children over vertices, edges and faces");
    print_enum("pccd_near_what");
    VALUE(PCCD_NEAR_PAIRS, "each VF and EE pair within the distance");
    VALUE(PCCD_NEAR_FEATURES, "the closest features of these pairs, each once");
    VALUE(PCCD_NEAR_VERTICES, "for each vertex its bound: least distance of its pairs");
    VALUE(PCCD_NEAR_NEAREST, "for each two objects the nearest pair, of any kind");
    VALUE(PCCD_NEAR_CROSSINGS, "each edge that passes through a face");
    VALUE(PCCD_NEAR_DEPTH, "how deep vertices are in closed meshes of others");
}

/* Print the enums of the answer to a step, and of its records. */
static void print_answer_enums(void)
{
    print_enum("pccd_incomplete");
    VALUE(PCCD_COMPLETE, "the answer is whole");
    VALUE(PCCD_INCOMPLETE_RESULT_FULL, "the page ended: go on with `frame.fetch`");
    VALUE(PCCD_INCOMPLETE_DEADLINE, "the deadline passed");
    VALUE(PCCD_INCOMPLETE_CANCELLED, "cancelled");
    VALUE(PCCD_INCOMPLETE_CONTACT_LIMIT, "more records than the daemon keeps of a step");
    VALUE(PCCD_INCOMPLETE_UNDECIDED, "pairs of what turns took too much work or memory");
    print_enum("pccd_verdict");
    VALUE(PCCD_VERDICT_NO, "there is no contact");
    VALUE(PCCD_VERDICT_POSSIBLE, "nothing is proved, but something is undecided");
    VALUE(PCCD_VERDICT_YES, "there is a contact");
    VALUE(PCCD_VERDICT_NONE, "not asked (another mode), or ended before it was known");
    print_enum("pccd_kind");
#define KIND(NAME, value, name, points_a, points_b, text) VALUE(PCCD_##NAME, text);
    PCCD_KIND_LIST(KIND)
    print_enum("pccd_near_kind");
    PCCD_NEAR_KIND_LIST(KIND)
#undef KIND
    print_enum("pccd_contact_flag");
    VALUE(PCCD_PROVED, "the contact exists, and begins in [toi, toi_hi]");
    VALUE(PCCD_INITIAL, "the features touch, or are within the distance at which they "
                        "meet, at t = 0; then toi = toi_hi = 0");
    VALUE(PCCD_INSIDE, "they begin within that distance, and come nearer than the part "
                       "of their first distance that approach allows");
    VALUE(PCCD_ENTERS, "with touching: just after t = 0 the surfaces pass through each "
                       "other there, or nothing tells their sides apart");
    VALUE(PCCD_SLIDES, "with touching: they go on touching");
    VALUE(PCCD_LEAVES, "with touching: they separate");
    print_enum("pccd_touching");
    VALUE(PCCD_TOUCHING_KEPT, "thin features that touch at t = 0 are a contact then");
    VALUE(PCCD_TOUCHING_TOLD, "the same, with one of the flags 8, 16 and 32");
    VALUE(PCCD_TOUCHING_LEFT_OUT, "those that slide or leave are a contact when they "
                                  "meet next");
    print_enum("pccd_near_flag");
    VALUE(PCCD_NEAR_GAP, "another pair may be nearer, by the gap that was asked for");
    print_enum("pccd_format");
    VALUE(PCCD_FORMAT_F32, "float[3], 12 bytes a vertex");
    VALUE(PCCD_FORMAT_F64, "double[3], 24 bytes a vertex");
    print_enum("pccd_joint_kind");
    VALUE(PCCD_JOINT_FIXED, "x' = x");
    VALUE(PCCD_JOINT_TURN, "x' = x, turned about `axis` by the value, in radians");
    VALUE(PCCD_JOINT_SLIDE, "x' = x, moved along `axis` by the value");
    VALUE(PCCD_JOINT_SHIFT, "x' = x, moved by the vector of values");
    VALUE(PCCD_JOINT_VECTOR, "x' = x, turned about the vector of values by its length");
}

/* Print the enums of scenes and objects, and of what shows what a daemon does. */
static void print_other_enums(void)
{
    print_enum("pccd_share");
    VALUE(PCCD_SHARE_CREATE, "make the scene; there must be none of that name");
    VALUE(PCCD_SHARE_OPEN, "make it unless there is one");
    VALUE(PCCD_SHARE_ATTACH, "take part; there must be one");
    VALUE(PCCD_SHARE_OTHER, "take part in one of the user `owner`; there must be one");
    print_enum("pccd_object_what");
#define ATTRIBUTE(F, type, member, name, at_first, meaning)                              \
    VALUE(PCCD_OBJECT_##name, "`" #member "` is set");
    COMMON_OBJECT_ATTRIBUTES(ATTRIBUTE, )
#undef ATTRIBUTE
    VALUE(PCCD_OBJECT_ALL, "whatever the daemon knows");
    print_enum("pccd_tree");
    VALUE(PCCD_TREE_VERTICES, "of the method wide, over vertices: up to 16 children");
    VALUE(PCCD_TREE_EDGES, "of the method wide, over edges: up to 16 children");
    VALUE(PCCD_TREE_FACES, "of the method wide, over faces: up to 16 children");
    VALUE(PCCD_TREE_TRIANGLES, "of the method paper: binary");
    print_enum("pccd_histogram_kind");
    VALUE(PCCD_HISTOGRAM_STEPS, "steps, as computed");
    VALUE(PCCD_HISTOGRAM_REQUESTS, "requests, from arrival to answer");
    print_enum("pccd_trace_kind");
    VALUE(PCCD_TRACE_STEP, "a whole step; a: triangles, b: threads");
    VALUE(PCCD_TRACE_REFIT, "a thread's part of the refit");
    VALUE(PCCD_TRACE_UNIT, "self-CD task unit; a: node, b: triangles below it");
    VALUE(PCCD_TRACE_SUBTREE, "all units below a node; a: node, b: triangles");
    VALUE(PCCD_TRACE_PAIRS, "what a pair of nodes leads to; a, b: nodes");
    VALUE(PCCD_TRACE_HIGH, "a thread's part of a high-level node; a: node, b: pairs");
    VALUE(PCCD_TRACE_TESTS, "elementary tests; a: enum pccd_kind, b: candidates");
    VALUE(PCCD_TRACE_REBUILD, "reconstruction; a: node, b: triangles");
    VALUE(PCCD_TRACE_BACKGROUND,
          "a share of a subtree built in the background; a: node, b: triangles");
    VALUE(PCCD_TRACE_WAIT, "without work");
    VALUE(PCCD_TRACE_MERGE, "sort, gather, hash");
    VALUE(PCCD_TRACE_REQUEST, "a client's request, from its arrival to its answer");
    VALUE(PCCD_TRACE_RECEIVE, "the loop reads a request");
    VALUE(PCCD_TRACE_ANSWER, "the loop sends an answer");
}

#undef VALUE

static void print_enums(void)
{
    puts("Values of the parameters and fields that name an enum.");
    print_step_enums();
    print_answer_enums();
    print_other_enums();
}

/* ---- the document ----------------------------------------------------------------- */

struct region {
    const char *name;
    void (*print)(void);
};

static const struct region regions[] = {
    {"methods", print_methods},   {"notifications", print_notifications},
    {"messages", print_messages}, {"counters", print_stats},
    {"statuses", print_statuses}, {"limits", print_limits},
    {"enums", print_enums},
};

/* ---- the manual page --------------------------------------------------------------- */

/* A sentence for scdoc, which gives underscores and stars a meaning. */
static void print_manual_text(const char *text)
{
    fputc(toupper((unsigned char)text[0]), prose.to);
    for (text++; *text != '\0'; text++) {
        if (*text == '_' || *text == '*' || *text == '`') {
            fputc('\\', prose.to);
        }
        fputc(*text, prose.to);
    }
}

static void print_manual_methods(void)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        printf("%s*%s*\n", i > 0 ? "\n" : "", proto_messages[i].name);
        begin_prose();
        print_manual_text(proto_messages[i].text);
        fputs(i < PROTO_METHOD_COUNT ? "." : " (a notification).", prose.to);
        end_prose("\t");
    }
}

static void print_manual_statuses(void)
{
    int first = 1;
#define ROW(name, value, text)                                                           \
    printf("%s*%s*, %d\n", first ? "" : "\n", #name, value);                             \
    begin_prose();                                                                       \
    print_manual_text(text);                                                             \
    fputc('.', prose.to);                                                                \
    end_prose("\t");                                                                     \
    first = 0;
    PCCD_STATUS_LIST(ROW)
#undef ROW
}

static const struct region manual_regions[] = {
    {"methods", print_manual_methods},
    {"statuses", print_manual_statuses},
};

/* ---- rewriting --------------------------------------------------------------------- */

/* A kind of document: its regions, and how their edges are marked. */
struct document {
    const struct region *regions;
    size_t region_count;
    const char *marker; /* of edge and name */
};

static const struct document protocol = {regions, sizeof regions / sizeof regions[0],
                                         "<!-- %s: %s -->\n"};
static const struct document manual = {
    manual_regions, sizeof manual_regions / sizeof manual_regions[0], "; %s: %s\n"};

/* Number of the region whose marker `line` is ("begin" or "end"), or -1. */
static int find_region(const struct document *document, const char *line,
                       const char *edge)
{
    char marker[64];
    for (size_t i = 0; i < document->region_count; i++) {
        snprintf(marker, sizeof marker, document->marker, edge,
                 document->regions[i].name);
        if (strcmp(line, marker) == 0) {
            return (int)i;
        }
    }
    return -1;
}

/* Returns 0, or 1 when a region is missing, open at the end or closed by another's
 * end. */
static int rewrite(const struct document *document)
{
    static char line[LINE_BYTES];
    size_t found = 0;
    int open = -1;
    while (fgets(line, sizeof line, stdin) != NULL) {
        if (open < 0) {
            fputs(line, stdout);
            open = find_region(document, line, "begin");
            if (open >= 0) {
                puts("");
                document->regions[open].print();
                puts("");
                found++;
            }
        } else if (find_region(document, line, "end") == open) {
            fputs(line, stdout);
            open = -1;
        }
    }
    if (open >= 0 || found != document->region_count) {
        fprintf(stderr, "gendoc: %zu of %zu regions, %s open at the end\n", found,
                document->region_count,
                open >= 0 ? document->regions[open].name : "none");
        return 1;
    }
    return 0;
}

/* ---- the frozen manifest ---------------------------------------------------------- */

static void print_frozen(const char *message, const char *part,
                         const struct proto_fields *fields)
{
    for (uint32_t i = 0; i < fields->count; i++) {
        printf("%s %s %s %s %s\n", message, part, fields->items[i].name,
               type_name(fields->items[i].type),
               fields->items[i].need == PROTO_NEED_REQ ? "REQ" : "OPT");
    }
}

static void print_manifest(void)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        const struct proto_message_info *message = &proto_messages[i];
        printf("%s since %u\n", message->name, message->since);
        print_frozen(message->name, "request", &message->request);
        print_frozen(message->name, "result", &message->result);
    }
}

int main(int argc, char **argv)
{
    int status = 0;
    if (argc == 2 && strcmp(argv[1], "manifest") == 0) {
        print_manifest();
    } else if (argc == 2 && strcmp(argv[1], "manual") == 0) {
        status = rewrite(&manual);
    } else if (argc == 1) {
        status = rewrite(&protocol);
    } else {
        status = 2;
    }
    if (status == 2) {
        fputs("usage: gendoc <PROTOCOL.md >NEW, gendoc manual <PAGE >NEW, or gendoc "
              "manifest\n",
              stderr);
    }
    return fflush(stdout) == 0 ? status : 1;
}
