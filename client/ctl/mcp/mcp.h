/* mcp.h - `pccdctl mcp`: commands as tools of the Model Context Protocol.
 *
 *   message.c   lines of JSON-RPC in and out; what is not a tool's
 *   tools.c     the tools: what each takes, does and tells
 *   fields.c    arguments and answers as tables: schemas, checks, command lines
 *   job.c       a command in a process of its own, which can be ended
 *   kept.c      what is kept of answers, and answers cut to size
 *   look.c      what no command tells: what files hold, where a contact is
 *
 * A tool runs a command of pccdctl in a child that is forked, not another program: it
 * has the command's code and options, reads within the folder alone (confined.h), and
 * whatever becomes of it, the server lives on.
 */
#ifndef CTL_MCP_H
#define CTL_MCP_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "error.h"

#define MCP_ANSWER_BYTES  2048u             /* of a tool's result, at most */
#define MCP_LINE_BYTES    ((size_t)1 << 20) /* of a message that is read */
#define MCP_TABLES_MAX    32u               /* that are kept */
#define MCP_ROWS_MAX      2000u             /* of each */
#define MCP_PICTURES_MAX  8u
#define MCP_PICTURE_BYTES ((size_t)4 << 20)
#define MCP_ID_BYTES      256u

/* ---- Arguments and answers as tables. */

enum mcp_form {
    MCP_TEXT,
    MCP_TEXTS, /* an array of texts, or one */
    MCP_FILE,  /* the name of a file within the folder */
    MCP_FILES, /* names or patterns, in an array, or one */
    MCP_WORD,  /* one of `words` */
    MCP_REAL,
    MCP_WHOLE,
    MCP_TRUTH,
    MCP_REALS,  /* of answers: an array of numbers */
    MCP_POINTS, /* of answers: an array of these */
    MCP_OBJECT, /* of answers: an object with the fields `of` */
    MCP_ROWS    /* of answers: an array of these */
};

struct mcp_field {
    const char *name;
    enum mcp_form form;
    const char *meaning;
    bool is_needed;    /* of an answer: it is always there */
    double min, max;   /* of numbers that are asked */
    const char *words; /* "a|b" */
    /* The option that a value becomes, "--rate"; of true and false "--self|--no-self",
     * either of which may be nothing. "": an argument; NULL: the tool does what it wants
     * with it. */
    const char *option;
    const struct mcp_field *of; /* up to one that is all zeros, as all tables */
};

/* Return a JSON Schema of type object for these fields. NULL: no memory. */
json_t *mcp_fields_schema(const struct mcp_field *fields, bool is_asked);
/* Compare what a client gives with what a tool takes: no other names, no other types, no
 * files outside of the folder. Errors: E_INVAL, whose text says what would be right. */
int mcp_fields_check(const struct mcp_field *fields, const json_t *asked,
                     struct ctl_error *error);

/* ---- A command in a process of its own. */

#define MCP_WORDS_MAX 1100u

/* Command to run, all of it ours. {0} at first. */
struct mcp_job {
    int (*run)(int argc, char **argv);
    char *words[MCP_WORDS_MAX + 1];
    int word_count;
    bool is_full;     /* a word had no room, or no memory */
    bool has_records; /* it writes CSV to descriptor MCP_RECORDS_FD */

    char *out, *err; /* what it has written to both; ended by a NUL */
    size_t out_bytes, err_bytes;
    json_t *rows; /* records as objects: the first ones of the CSV */
    uint64_t row_count;
    int status; /* exit status; 128 + N: ended by signal N */
};

#define MCP_RECORDS_FD   64 /* above those that there are */
#define MCP_RECORDS_PATH "/dev/fd/64"

struct mcp;

/* Add a word, "OPTION=VALUE" by a format. */
void mcp_job_add(struct mcp_job *job, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Add what the fields make of `asked`, options first, and "--" before arguments. */
void mcp_job_add_fields(struct mcp_job *job, const struct mcp_field *fields,
                        const json_t *asked);
/* Run it to its end. Errors: E_CANCELLED: the client takes its question back, or is gone;
 * E_TIMEOUT, E_NOMEM, E_SYSTEM. Otherwise it has ended by itself. */
int mcp_job_run(struct mcp_job *job, struct mcp *mcp, struct ctl_error *error);
/* Return the last line that the command has said on stderr, without its name before; or
 * NULL. It cuts that text to lines. */
const char *mcp_job_complaint(struct mcp_job *job);
void mcp_job_deinit(struct mcp_job *job);

/* ---- What is kept of answers. */

struct mcp_tool;

/* Turn a kept row into what is shown of it, which is the caller's. `names`: of the
 * objects, by their numbers from 1; or NULL. */
typedef json_t *(*mcp_show)(const json_t *row, const json_t *names);

/* Records of an answer, to be asked for by its handle. */
struct mcp_table {
    char handle[32]; /* "": there is none */
    const struct mcp_tool *tool;
    const json_t *asked; /* arguments of the call that found them */
    json_t *names;       /* of the objects; or NULL */
    json_t *rows;
    uint64_t count; /* of all that were found; rows may have less */
    mcp_show show;
};

struct mcp_picture {
    char uri[48]; /* "": there is none */
    char *bytes;
    size_t count;
};

struct mcp_reader {
    char *bytes; /* [MCP_LINE_BYTES] that were read and not yet used */
    size_t count;
    bool is_skipping; /* the rest of a line that is too long */
    bool is_at_end;
};

struct mcp {
    bool may_write;
    uint32_t seconds;    /* that a tool may take */
    int timeout_ms;      /* of commands that ask a daemon; 0: theirs */
    const char *version; /* of the protocol, once both have agreed */

    struct mcp_reader reader;
    json_t *waiting;        /* messages that came while a tool was at work */
    const json_t *current;  /* id of the call that is at work; NULL: none is */
    const json_t *progress; /* what its progress is told with; or NULL */
    bool is_cancelled;
    bool is_gone; /* nobody reads any more */

    struct mcp_table tables[MCP_TABLES_MAX];
    uint64_t table_count; /* that ever were */
    struct mcp_picture pictures[MCP_PICTURES_MAX];
    uint64_t picture_count;
};

/* Keep a table: its rows and names are taken, what was asked is not, and its handle is
 * made of `name`. Returns it. */
struct mcp_table *mcp_keep(struct mcp *mcp, const char *name, struct mcp_table table);
void mcp_forget(struct mcp_table *table);
/* Find a table by its handle. Errors: E_INVAL: there is no such handle, or it is gone. */
int mcp_find(struct mcp *mcp, const char *handle, struct mcp_table **table,
             struct ctl_error *error);
/* Set "rows" of an answer to those of the table from `offset` on, as many as might fit;
 * and "row_count", "handle", "offset". */
void mcp_show_rows(json_t *answer, const struct mcp_table *table, uint64_t offset,
                   bool *ok);
/* Return the result of a call: an answer, which is taken, as text and as it is, cut until
 * it has at most MCP_ANSWER_BYTES: rows first, then long texts. A picture is linked, too.
 * NULL: no memory. */
json_t *mcp_result(json_t *answer);
/* Return the result of a call that failed, cut to as many bytes. NULL: no memory. */
json_t *mcp_failure(const char *text);
/* Dump as all messages are; the caller's. */
char *mcp_dump(const json_t *value);

/* Keep a picture, which is taken, if it is one; returns its URI, or NULL. */
const char *mcp_keep_picture(struct mcp *mcp, char *bytes, size_t count);
const struct mcp_picture *mcp_find_picture(const struct mcp *mcp, const char *uri);

/* ---- The tools. */

struct mcp_tool {
    const char *name, *title, *text;
    const struct mcp_field *takes, *tells;
    bool writes;
    /* Do it; NULL: it failed, with an error. */
    json_t *(*answer)(struct mcp *mcp, const struct mcp_tool *tool, const json_t *asked,
                      struct ctl_error *error);
};

/* Up to one that is all zeros. */
extern const struct mcp_tool mcp_tools[];

/* Print JSON, in a child of a tool that is more than a command. argv[1]: the folder's
 * name. */
int mcp_look_folder(int argc, char **argv);
int mcp_look_scene(int argc, char **argv);
int mcp_look_record(int argc, char **argv);
int mcp_look_place(int argc, char **argv);

/* ---- Messages. */

/* Answer until the input ends. Returns an exit status. */
int mcp_serve(struct mcp *mcp);
/* Look at the input while a tool is at work, at what was read already and, if it
 * `has_more`, at that: nothing is answered but pings, and what cancels is noted. */
void mcp_listen(struct mcp *mcp, bool has_more);
/* Tell how long the call has taken, if its client wants to know. */
void mcp_tell_progress(struct mcp *mcp, uint32_t seconds);

#endif
