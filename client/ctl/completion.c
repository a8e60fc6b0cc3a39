/* completion.c - commands and options as shells complete them. */
#include "dispatch.h"

#include <stdbool.h>
#include <string.h>

#include "ctl.h"
#include "shown.h"

/* ---- the walk ---------------------------------------------------------------------- */

typedef void (*option_fn)(FILE *to, const struct completion *of,
                          const struct completion_row *row,
                          const struct argp_option *option);

/* Every option of a command, those of its children and of theirs. They nest as they are
 * written, a few deep. */
static void each_option(FILE *to, const struct completion *of,
                        const struct completion_row *row, const struct argp *argp,
                        option_fn print)
{
    for (const struct argp_option *option = argp->options;
         option != NULL &&
         (option->name != NULL || option->key != 0 || option->doc != NULL);
         option++) {
        if (option->name != NULL) {
            print(to, of, row, option);
        }
    }
    for (const struct argp_child *child = argp->children;
         child != NULL && child->argp != NULL; child++) {
        each_option(to, of, row, child->argp, print);
    }
}

static bool is_short(const struct argp_option *option)
{
    return option->key > ' ' && option->key < 127;
}

/* "a|b|c", also in brackets: the words that may stand there. */
static bool has_words(const char *argument)
{
    return argument != NULL && strchr(argument, '|') != NULL;
}

static bool is_file(const char *argument)
{
    return argument != NULL && !has_words(argument) &&
           (strstr(argument, "FILE") != NULL || strstr(argument, "PATH") != NULL ||
            strstr(argument, "PROGRAM") != NULL || strstr(argument, "MESH") != NULL ||
            strstr(argument, "FRAME") != NULL);
}

/* The words of "[a|b|c] [NAME]", with blanks between them. */
static void print_words(FILE *to, const char *argument)
{
    for (; *argument != '\0' && *argument != ' '; argument++) {
        if (*argument != '[' && *argument != ']') {
            putc(*argument == '|' ? ' ' : *argument, to);
        }
    }
}

/* How much of a help text is its first statement, without the default. */
static size_t statement_chars(const char *text)
{
    static const char *const ends[] = {";", ". ", " (default"};
    size_t chars = strlen(text);
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        const char *end = strstr(text, ends[i]);
        if (end != NULL && (size_t)(end - text) < chars) {
            chars = (size_t)(end - text);
        }
    }
    return chars;
}

/* That, within single quotes of fish, or of a specification of zsh. */
static void print_text_fish(FILE *to, const char *text)
{
    for (size_t i = 0, chars = statement_chars(text); i < chars; i++) {
        fprintf(to, text[i] == '\'' || text[i] == '\\' ? "\\%c" : "%c", text[i]);
    }
}

static void print_text_zsh(FILE *to, const char *text)
{
    for (size_t i = 0, chars = statement_chars(text); i < chars; i++) {
        const char *form = text[i] == '\''                    ? "'\\%c'"
                           : strchr("[]:\\", text[i]) != NULL ? "\\%c"
                                                              : "%c";
        fprintf(to, form, text[i]);
    }
}

/* ---- bash -------------------------------------------------------------------------- */

static void bash_name(FILE *to, const struct completion *of,
                      const struct completion_row *row, const struct argp_option *option)
{
    (void)of;

    (void)row;
    fprintf(to, " --%s", option->name);
    if (is_short(option)) {
        fprintf(to, " -%c", option->key);
    }
}

static void bash_value(FILE *to, const struct completion *of,
                       const struct completion_row *row, const struct argp_option *option)
{
    (void)of;

    if (option->arg == NULL) {
        return;
    }
    fprintf(to, "    %s:--%s", row->name, option->name);
    if (is_short(option)) {
        fprintf(to, " | %s:-%c", row->name, option->key);
    }
    if (has_words(option->arg)) {
        fputs(") words='", to);
        print_words(to, option->arg);
        fputs("' ;;\n", to);
    } else {
        fputs(is_file(option->arg) ? ") files=1 ;;\n" : ") nothing=1 ;;\n", to);
    }
}

static void print_bash(FILE *to, const struct completion *of)
{
    fprintf(to, "# %s: completion for bash, printed by %s completion bash.\n_%s()\n{\n",
            of->program, of->program, of->program);
    fputs("    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
          "    local command=${COMP_WORDS[1]} words= files= nothing=\n"
          "    COMPREPLY=()\n"
          "    if [ \"$cur\" = = ]; then\n        cur=\n"
          "    elif [ \"$prev\" = = ]; then\n"
          "        prev=${COMP_WORDS[COMP_CWORD-2]}\n    fi\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
          "        COMPREPLY=($(compgen -W 'help --help --version",
          to);
    for (size_t i = 0; i < of->row_count; i++) {
        fprintf(to, " %s", of->rows[i].name);
    }
    fputs("' -- \"$cur\"))\n        return\n    fi\n"
          "    case $command:$prev in\n",
          to);
    for (size_t i = 0; i < of->row_count; i++) {
        each_option(to, of, &of->rows[i], of->rows[i].argp, bash_value);
    }
    fputs("    esac\n    if [ -n \"$nothing\" ]; then\n        return\n    fi\n"
          "    if [ -z \"$words$files\" ]; then\n        case $command in\n"
          "        help) words='",
          to);
    for (size_t i = 0; i < of->row_count; i++) {
        fprintf(to, " %s", of->rows[i].name);
    }
    fputs("' ;;\n", to);
    for (size_t i = 0; i < of->row_count; i++) {
        fprintf(to, "        %s) words='", of->rows[i].name);
        if (has_words(of->rows[i].argp->args_doc)) {
            print_words(to, of->rows[i].argp->args_doc);
        }
        each_option(to, of, &of->rows[i], of->rows[i].argp, bash_name);
        fprintf(to, " --help'%s ;;\n",
                is_file(of->rows[i].argp->args_doc) ? " files=1" : "");
    }
    fputs("        esac\n    fi\n"
          "    case $cur in\n    -*) files= ;;\n"
          "    *) [ -z \"$files\" ] || { COMPREPLY=($(compgen -f -- \"$cur\")); return; "
          "} ;;\n"
          "    esac\n"
          "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}\n",
          to);
    fprintf(to, "complete -o filenames -F _%s %s\n", of->program, of->program);
}

/* ---- zsh --------------------------------------------------------------------------- */

static void zsh_option(FILE *to, const struct completion *of,
                       const struct completion_row *row, const struct argp_option *option)
{
    (void)of;

    (void)row;
    fprintf(to, "            '--%s%s[", option->name, option->arg != NULL ? "=" : "");
    print_text_zsh(to, option->doc);
    putc(']', to);
    if (has_words(option->arg)) {
        fprintf(to, ":%s:(", option->name);
        print_words(to, option->arg);
        putc(')', to);
    } else if (option->arg != NULL) {
        fprintf(to, ":%s:%s", option->name, is_file(option->arg) ? "_files" : " ");
    }
    fputs("' \\\n", to);
}

static void print_zsh(FILE *to, const struct completion *of)
{
    fprintf(to,
            "#compdef %s\n# %s: completion for zsh, printed by %s completion zsh.\n"
            "_%s() {\n    local -a commands\n    commands=(\n",
            of->program, of->program, of->program, of->program);
    for (size_t i = 0; i < of->row_count; i++) {
        fprintf(to, "        '%s:", of->rows[i].name);
        print_text_zsh(to, of->rows[i].text);
        fputs("'\n", to);
    }
    fputs("        'help:explain a command'\n    )\n"
          "    if (( CURRENT == 2 )); then\n        _describe command commands\n"
          "        return\n    fi\n"
          "    local command=${words[2]}\n    shift words\n    (( CURRENT-- ))\n"
          "    case $command in\n    help) _describe command commands ;;\n",
          to);
    for (size_t i = 0; i < of->row_count; i++) {
        const char *arguments = of->rows[i].argp->args_doc;
        fprintf(to, "    %s)\n        _arguments \\\n", of->rows[i].name);
        each_option(to, of, &of->rows[i], of->rows[i].argp, zsh_option);
        fputs("            '--help[tell how it is used]'", to);
        if (has_words(arguments)) {
            fputs(" \\\n            '1:what:(", to);
            print_words(to, arguments);
            fputs(")'", to);
        } else if (is_file(arguments)) {
            fputs(" \\\n            '*:file:_files'", to);
        }
        fputs("\n        ;;\n", to);
    }
    fprintf(to, "    esac\n}\n_%s \"$@\"\n", of->program);
}

/* ---- fish -------------------------------------------------------------------------- */

static void fish_option(FILE *to, const struct completion *of,
                        const struct completion_row *row,
                        const struct argp_option *option)
{

    fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from %s' -l %s", of->program,
            row->name, option->name);
    if (is_short(option)) {
        fprintf(to, " -s %c", option->key);
    }
    if (has_words(option->arg)) {
        fputs(" -x -a '", to);
        print_words(to, option->arg);
        putc('\'', to);
    } else if (option->arg != NULL) {
        fputs(is_file(option->arg) ? " -r -F" : " -x", to);
    }
    fputs(" -d '", to);
    print_text_fish(to, option->doc);
    fputs("'\n", to);
}

static void print_fish(FILE *to, const struct completion *of)
{
    const char *name = of->program;
    fprintf(to,
            "# %s: completion for fish, printed by %s completion fish.\n"
            "complete -c %s -f\n"
            "complete -c %s -n __fish_use_subcommand -a help -d 'explain a command'\n",
            name, name, name, name);
    fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from help' -a '", name);
    for (size_t i = 0; i < of->row_count; i++) {
        fprintf(to, "%s%s", i > 0 ? " " : "", of->rows[i].name);
    }
    fputs("'\n", to);
    for (size_t i = 0; i < of->row_count; i++) {
        const char *arguments = of->rows[i].argp->args_doc;
        fprintf(to, "complete -c %s -n __fish_use_subcommand -a %s -d '", name,
                of->rows[i].name);
        print_text_fish(to, of->rows[i].text);
        fputs("'\n", to);
        each_option(to, of, &of->rows[i], of->rows[i].argp, fish_option);
        if (has_words(arguments) || is_file(arguments)) {
            fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from %s' ", name,
                    of->rows[i].name);
        }
        if (has_words(arguments)) {
            fputs("-a '", to);
            print_words(to, arguments);
            fputs("'\n", to);
        } else if (is_file(arguments)) {
            fputs("-F\n", to);
        }
    }
}

/* ---- the command ------------------------------------------------------------------- */

static const char *const shell_names[] = {"bash", "zsh", "fish"};
static void (*const printers[])(FILE *to, const struct completion *of) = {
    print_bash, print_zsh, print_fish};

error_t completion_parse(int key, char *text, struct argp_state *state)
{
    int *shell = state->input;
    switch (key) {
    case ARGP_KEY_ARG:
        if (state->arg_num > 0) {
            tool_misused(state, "one shell at a time");
        }
        *shell = ctl_argument_name(state, text, shell_names, 3);
        return 0;
    case ARGP_KEY_NO_ARGS:
        tool_misused(state, "for which shell: bash, zsh or fish?");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int completion_command(const struct completion *of, const struct argp *argp, int argc,
                       char **argv)
{
    int shell = 0;
    if (argp_parse(argp, argc, argv, 0, NULL, &shell) != 0) {
        return CTL_USAGE;
    }
    printers[shell](stdout, of);
    return CTL_DONE;
}
