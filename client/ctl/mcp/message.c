/* message.c - JSON-RPC by lines: what comes, and what is answered. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base64.h"
#include "ctl.h"
#include "mcp.h"
#include "output.h"
#include "pccd.h"
#include "pccd_types.h"
#include "shown.h"

#define WAITING_MAX 64u /* messages while a tool is at work; then nothing is read */
#define BATCH_MAX   64u

/* Error codes of JSON-RPC. */
enum {
    NOT_JSON = -32700,
    NO_REQUEST = -32600,
    NO_METHOD = -32601,
    WRONG_PARAMS = -32602
};

/* Newest first. */
static const char *const versions[] = {"2025-11-25", "2025-06-18", "2025-03-26",
                                       "2024-11-05"};

/* ---- out --------------------------------------------------------------------------- */

/* Write a message, which is taken, as a line. NULL: nothing is to be written. */
static void send_message(struct mcp *mcp, json_t *message)
{
    char *text = message != NULL ? mcp_dump(message) : NULL;
    size_t length = text != NULL ? strlen(text) : 0, done = 0;
    if (text != NULL) {
        text[length++] = '\n'; /* in the place of the NUL */
    }
    while (done < length && !mcp->is_gone) {
        ssize_t written = write(STDOUT_FILENO, text + done, length - done);
        if (written >= 0) {
            done += (size_t)written;
        } else if (errno == EAGAIN) {
            struct pollfd fd = {.fd = STDOUT_FILENO, .events = POLLOUT};
            (void)poll(&fd, 1, -1);
        } else if (errno != EINTR) {
            mcp->is_gone = true;
        }
    }
    free(text);
    json_decref(message);
}

/* Return whether a value names a request, or its progress. */
static bool is_id(const json_t *id)
{
    return json_is_number(id) ||
           (json_is_string(id) && json_string_length(id) <= MCP_ID_BYTES);
}

static json_t *error_of(const json_t *id, int code, const char *text)
{
    return json_pack("{s:s, s:O?, s:{s:i, s:o}}", "jsonrpc", "2.0", "id",
                     id != NULL ? (json_t *)id : json_null(), "error", "code", code,
                     "message", json_text(text));
}

static json_t *answer_of(const json_t *id, json_t *result)
{
    return result == NULL ? error_of(id, -32603, "there is no memory for the answer")
                          : json_pack("{s:s, s:O, s:o}", "jsonrpc", "2.0", "id",
                                      (json_t *)id, "result", result);
}

void mcp_tell_progress(struct mcp *mcp, uint32_t seconds)
{
    if (is_id(mcp->progress)) {
        send_message(mcp, json_pack("{s:s, s:s, s:{s:O, s:i, s:s}}", "jsonrpc", "2.0",
                                    "method", "notifications/progress", "params",
                                    "progressToken", (json_t *)mcp->progress, "progress",
                                    (int)seconds, "message", "seconds so far"));
    }
}

/* ---- methods ----------------------------------------------------------------------- */

static json_t *on_initialize(struct mcp *mcp, const json_t *params)
{
    const char *asked = json_string_value(json_object_get(params, "protocolVersion"));
    mcp->version = versions[0];
    for (size_t i = 0; asked != NULL && i < sizeof versions / sizeof versions[0]; i++) {
        if (strcmp(asked, versions[i]) == 0) {
            mcp->version = versions[i];
        }
    }
    return json_pack(
        "{s:s, s:{s:{}, s:{}}, s:{s:s, s:s, s:s}, s:s}", "protocolVersion", mcp->version,
        "capabilities", "tools", "resources", "serverInfo", "name", "pccdctl", "title",
        "pccd: exact continuous collision detection", "version", pccd_version(),
        "instructions",
        "Begin with scene, which lists the files of the folder, then check. Names of "
        "files "
        "count from that folder. Frames count from 0; step k moves from frame k - 1 to "
        "frame k on straight lines, with t from 0 to 1; lengths are in the files' unit. "
        "An answer has at most 2 KB: more {handle, offset} gives the rest, explain "
        "{handle, row} one record with a picture.");
}

static json_t *list_tools(const struct mcp *mcp)
{
    bool ok = true;
    json_t *list = json_array();
    for (const struct mcp_tool *tool = mcp_tools; tool->name != NULL; tool++) {
        json_append(list,
                    json_pack("{s:s, s:s, s:s, s:o, s:o, s:{s:b, s:b, s:b, s:b}}", "name",
                              tool->name, "title", tool->title, "description", tool->text,
                              "inputSchema", mcp_fields_schema(tool->takes, true),
                              "outputSchema", mcp_fields_schema(tool->tells, false),
                              "annotations", "readOnlyHint",
                              !(tool->writes && mcp->may_write), "destructiveHint", 0,
                              "idempotentHint", 1, "openWorldHint", 0),
                    &ok);
    }
    json_t *result = json_pack("{s:o}", "tools", list);
    if (!ok) {
        json_decref(result);
    }
    return ok ? result : NULL;
}

static json_t *list_pictures(const struct mcp *mcp)
{
    json_t *list = json_array();
    bool ok = true;
    for (size_t i = 0; i < MCP_PICTURES_MAX; i++) {
        const struct mcp_picture *picture = &mcp->pictures[i];
        if (picture->uri[0] != '\0') {
            json_append(list,
                        json_pack("{s:s, s:s, s:s}", "uri", picture->uri, "name",
                                  picture->uri + strlen("pccd://"), "mimeType",
                                  "image/png"),
                        &ok);
        }
    }
    return json_pack("{s:o}", "resources", list);
}

static json_t *read_picture(const struct mcp *mcp, const json_t *params,
                            struct ctl_error *error)
{
    const char *uri = json_string_value(json_object_get(params, "uri"));
    const struct mcp_picture *picture = mcp_find_picture(mcp, uri != NULL ? uri : "");
    if (picture == NULL) {
        (void)ctl_error_set(error, PCCD_E_INVAL,
                            "no picture \"%.100s\": the last %u of explain are kept",
                            uri != NULL ? tool_shown(uri) : "", MCP_PICTURES_MAX);
        return NULL;
    }
    char *text = NULL;
    size_t length = 0;
    FILE *to = open_memstream(&text, &length);
    bool ok = to != NULL && base64_write(picture->bytes, picture->count, to);
    ok = to != NULL && fclose(to) == 0 && ok;
    json_t *result =
        ok ? json_pack("{s:[{s:s, s:s, s:s%}]}", "contents", "uri", picture->uri,
                       "mimeType", "image/png", "blob", text, length)
           : NULL;
    free(text);
    return result;
}

/* A tool's result; NULL, with an error: there is no such tool, or no memory. */
static json_t *call(struct mcp *mcp, const json_t *id, const json_t *params,
                    struct ctl_error *error)
{
    const char *name = json_string_value(json_object_get(params, "name"));
    json_t *none = json_object();
    const json_t *asked = json_object_get(params, "arguments");
    const struct mcp_tool *tool = mcp_tools;
    json_t *result = NULL;
    mcp->is_cancelled = false;
    asked = asked == NULL || json_is_null(asked) ? none : asked;
    while (tool->name != NULL && (name == NULL || strcmp(tool->name, name) != 0)) {
        tool++;
    }
    if (tool->name == NULL) {
        (void)ctl_error_set(error, PCCD_E_INVAL,
                            "no tool \"%.100s\"; tools/list tells which there are",
                            name != NULL ? tool_shown(name) : "");
    } else if (!json_is_object(asked)) {
        (void)ctl_error_set(error, PCCD_E_INVAL, "\"arguments\" is no object");
    } else {
        struct ctl_error why = {.text = ""};
        mcp->current = id;
        mcp->progress =
            json_object_get(json_object_get(params, "_meta"), "progressToken");
        json_t *answer = mcp_fields_check(tool->takes, asked, &why) == PCCD_OK
                             ? tool->answer(mcp, tool, asked, &why)
                             : NULL;
        mcp->current = NULL;
        result = answer != NULL
                     ? mcp_result(answer)
                     : mcp_failure(why.text[0] != '\0' ? why.text : "there is no memory");
    }
    json_decref(none);
    return result;
}

static json_t *answer_request(struct mcp *mcp, const json_t *id, const char *method,
                              const json_t *params)
{
    struct ctl_error error = {.text = ""};
    json_t *result = NULL;
    if (strcmp(method, "initialize") == 0) {
        result = on_initialize(mcp, params);
    } else if (strcmp(method, "ping") == 0) {
        result = json_object();
    } else if (strcmp(method, "tools/list") == 0) {
        result = list_tools(mcp);
    } else if (strcmp(method, "tools/call") == 0) {
        result = call(mcp, id, params, &error);
        if (mcp->is_cancelled) {
            json_decref(result);
            return NULL; /* nobody waits for it */
        }
    } else if (strcmp(method, "resources/list") == 0) {
        result = list_pictures(mcp);
    } else if (strcmp(method, "resources/templates/list") == 0) {
        result = json_pack("{s:[]}", "resourceTemplates");
    } else if (strcmp(method, "resources/read") == 0) {
        result = read_picture(mcp, params, &error);
    } else {
        (void)ctl_error_set(&error, PCCD_E_INVAL, "no method \"%.100s\"",
                            tool_shown(method));
        return error_of(id, NO_METHOD, error.text);
    }
    return error.text[0] != '\0' ? error_of(id, WRONG_PARAMS, error.text)
                                 : answer_of(id, result);
}

/* ---- messages ---------------------------------------------------------------------- */

/* The answer to one message that is no array; NULL: it needs none. */
static json_t *answer_one(struct mcp *mcp, const json_t *message)
{
    const json_t *id = json_object_get(message, "id");
    const json_t *params = json_object_get(message, "params");
    const char *method = json_string_value(json_object_get(message, "method"));
    const char *version = json_string_value(json_object_get(message, "jsonrpc"));
    const json_t *named = is_id(id) ? id : NULL;
    if (!json_is_object(message) || version == NULL || strcmp(version, "2.0") != 0) {
        return error_of(named, NO_REQUEST, "no request: \"jsonrpc\" is not \"2.0\"");
    }
    if (method == NULL && (json_object_get(message, "result") != NULL ||
                           json_object_get(message, "error") != NULL)) {
        return NULL; /* an answer, though nothing was asked */
    }
    if (method == NULL) {
        return error_of(named, NO_REQUEST, "no request: \"method\" is no text");
    }
    if (id == NULL) {
        return NULL; /* a notification: those that matter come while a tool is at work */
    }
    if (named == NULL) {
        return error_of(NULL, NO_REQUEST,
                        "no request: \"id\" is neither number nor text of at most 256 "
                        "bytes");
    }
    if (params != NULL && !json_is_object(params)) {
        return error_of(id, WRONG_PARAMS, "\"params\" is no object");
    }
    return answer_request(mcp, id, method, params);
}

/* Answer a message, or all of an array. */
static void answer(struct mcp *mcp, const json_t *message)
{
    size_t count = json_array_size(message);
    if (!json_is_array(message) || count == 0 || count > BATCH_MAX) {
        send_message(mcp, json_is_array(message)
                              ? error_of(NULL, NO_REQUEST, "a batch has 1 to 64 messages")
                              : answer_one(mcp, message));
        return;
    }
    json_t *answers = json_array();
    bool ok = true;
    for (size_t i = 0; i < count && !mcp->is_gone; i++) {
        json_t *one = answer_one(mcp, json_array_get(message, i));
        if (one != NULL) {
            json_append(answers, one, &ok);
        }
    }
    if (json_array_size(answers) == 0) {
        json_decref(answers);
        answers = NULL;
    }
    send_message(mcp, ok ? answers : NULL);
}

/* ---- in ---------------------------------------------------------------------------- */

/* Read what is there, waiting for it. */
static void read_some(struct mcp *mcp)
{
    struct mcp_reader *reader = &mcp->reader;
    ssize_t got =
        read(STDIN_FILENO, reader->bytes + reader->count, MCP_LINE_BYTES - reader->count);
    if (got > 0) {
        reader->count += (size_t)got;
    } else if (got < 0 && errno == EAGAIN) {
        struct pollfd fd = {.fd = STDIN_FILENO, .events = POLLIN};
        (void)poll(&fd, 1, -1);
    } else if (got == 0 || errno != EINTR) {
        reader->is_at_end = true;
    }
}

/* Take the next message out of what was read. False: there is no whole line. `message`:
 * NULL where the line is empty, or was answered at once since it is no JSON. */
static bool take_message(struct mcp *mcp, json_t **message)
{
    struct mcp_reader *reader = &mcp->reader;
    const char *end = memchr(reader->bytes, '\n', reader->count);
    size_t length = end != NULL ? (size_t)(end - reader->bytes) : reader->count;
    bool is_full = end == NULL && reader->count == MCP_LINE_BYTES;
    bool is_last = end == NULL && reader->is_at_end && reader->count > 0;
    *message = NULL;
    if (end == NULL && !is_full && !is_last) {
        return false;
    }
    size_t blanks = 0;
    while (blanks < length && strchr(" \t\r", reader->bytes[blanks]) != NULL &&
           reader->bytes[blanks] != '\0') {
        blanks++;
    }
    if (is_full && !reader->is_skipping) {
        send_message(mcp,
                     error_of(NULL, NO_REQUEST, "a message has more than 1048576 bytes"));
    } else if (!is_full && !reader->is_skipping && blanks < length) {
        json_error_t why;
        *message = json_loadb(reader->bytes, length, JSON_DECODE_ANY, &why);
        if (*message == NULL) {
            char text[200];
            snprintf(text, sizeof text, "no JSON, at byte %d: %.100s", why.position,
                     tool_shown(why.text));
            send_message(mcp, error_of(NULL, NOT_JSON, text));
        }
    }
    reader->is_skipping = is_full;
    size_t used = length + (end != NULL);
    memmove(reader->bytes, reader->bytes + used, reader->count - used);
    reader->count -= used;
    return true;
}

static bool is_method(const json_t *message, const char *method)
{
    const char *named = json_string_value(json_object_get(message, "method"));
    return named != NULL && strcmp(named, method) == 0;
}

/* Forget the call that a client takes back, or end it. */
static void cancel(struct mcp *mcp, const json_t *id)
{
    if (mcp->current != NULL && json_equal(id, mcp->current)) {
        mcp->is_cancelled = true;
    }
    for (size_t i = 0; id != NULL && i < json_array_size(mcp->waiting); i++) {
        if (json_equal(json_object_get(json_array_get(mcp->waiting, i), "id"), id)) {
            (void)json_array_remove(mcp->waiting, i--);
        }
    }
}

void mcp_listen(struct mcp *mcp, bool has_more)
{
    json_t *message;
    if (json_array_size(mcp->waiting) >= WAITING_MAX) {
        struct timespec moment = {.tv_nsec = 10000000};
        (void)nanosleep(&moment, NULL); /* the rest stays in the pipe */
        return;
    }
    if (has_more) {
        read_some(mcp);
    }
    while (json_array_size(mcp->waiting) < WAITING_MAX && take_message(mcp, &message)) {
        if (is_method(message, "notifications/cancelled")) {
            cancel(mcp, json_object_get(json_object_get(message, "params"), "requestId"));
            json_decref(message);
        } else if (is_method(message, "ping")) {
            send_message(mcp, answer_one(mcp, message));
            json_decref(message);
        } else if (message != NULL) {
            (void)json_array_append_new(mcp->waiting, message);
        }
    }
}

int mcp_serve(struct mcp *mcp)
{
    mcp->reader.bytes = malloc(MCP_LINE_BYTES);
    mcp->waiting = json_array();
    signal(SIGPIPE, SIG_IGN);
    if (mcp->reader.bytes == NULL || mcp->waiting == NULL) {
        return ctl_complain("out of memory");
    }
    while (!mcp->is_gone) {
        json_t *message = NULL;
        if (json_array_size(mcp->waiting) > 0) {
            message = json_incref(json_array_get(mcp->waiting, 0));
            (void)json_array_remove(mcp->waiting, 0);
        } else if (!take_message(mcp, &message)) {
            if (mcp->reader.is_at_end) {
                break;
            }
            read_some(mcp);
        }
        if (message != NULL) {
            answer(mcp, message);
            json_decref(message);
        }
    }
    for (size_t i = 0; i < MCP_TABLES_MAX; i++) {
        mcp_forget(&mcp->tables[i]);
    }
    for (size_t i = 0; i < MCP_PICTURES_MAX; i++) {
        free(mcp->pictures[i].bytes);
    }
    json_decref(mcp->waiting);
    free(mcp->reader.bytes);
    return CTL_DONE;
}
