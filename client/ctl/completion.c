/* completion.c - commands and options as shells complete them. */
#include "dispatch.h"

#include <stdbool.h>
#include <string.h>

#include "ctl.h"

/* ---- the walk ---------------------------------------------------------------------- */

struct walk {
    FILE *to;
    const struct ctl_program *of;
    const struct ctl_command *command;
};

static void each_option(FILE *to, const struct ctl_program *of,
                        const struct ctl_command *command, option_visit print)
{
    struct walk walk = {to, of, command};
    option_each(command->table, print, &walk);
}

/* Return whether the help names the words that may stand there, "a|b|c", also in
 * brackets. */
static bool has_words(const char *argument)
{
    const char *words;
    return option_words(argument, &words) > 0;
}

static bool is_file(const char *argument)
{
    return argument != NULL && !has_words(argument) &&
           (strstr(argument, "FILE") != NULL || strstr(argument, "PATH") != NULL ||
            strstr(argument, "PROGRAM") != NULL || strstr(argument, "MESH") != NULL ||
            strstr(argument, "FRAME") != NULL || strstr(argument, "FOLDER") != NULL);
}

/* The words of "[a|b|c] [NAME]", with blanks between them. */
static void print_words(FILE *to, const char *argument)
{
    const char *words;
    for (size_t bytes = option_words(argument, &words); bytes > 0; bytes--, words++) {
        putc(*words == '|' ? ' ' : *words, to);
    }
}

/* Return how many characters of a help text are its first statement, without the
 * default. */
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

static void bash_name(void *context, const struct option_row *option)
{
    FILE *to = ((const struct walk *)context)->to;
    fprintf(to, " --%s", option->name);
    if (option->letter != 0) {
        fprintf(to, " -%c", option->letter);
    }
}

static void bash_value(void *context, const struct option_row *option)
{
    const struct walk *walk = context;
    FILE *to = walk->to;
    if (option->arg == NULL) {
        return;
    }
    fprintf(to, "    %s:--%s", walk->command->name, option->name);
    if (option->letter != 0) {
        fprintf(to, " | %s:-%c", walk->command->name, option->letter);
    }
    if (has_words(option->arg)) {
        fputs(") words='", to);
        print_words(to, option->arg);
        fputs("' ;;\n", to);
    } else {
        fputs(is_file(option->arg) ? ") files=1 ;;\n" : ") nothing=1 ;;\n", to);
    }
}

static void print_bash(FILE *to, const struct ctl_program *of)
{
    fprintf(to, "# %s: completion for bash, printed by %s completion bash.\n_%s()\n{\n",
            of->name, of->name, of->name);
    fputs("    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
          "    local command=${COMP_WORDS[1]} words= files= nothing=\n"
          "    COMPREPLY=()\n"
          "    if [ \"$cur\" = = ]; then\n        cur=\n"
          "    elif [ \"$prev\" = = ]; then\n"
          "        prev=${COMP_WORDS[COMP_CWORD-2]}\n    fi\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
          "        COMPREPLY=($(compgen -W 'help --help --version",
          to);
    for (size_t i = 0; i < of->command_count; i++) {
        fprintf(to, " %s", of->commands[i].name);
    }
    fputs("' -- \"$cur\"))\n        return\n    fi\n"
          "    case $command:$prev in\n",
          to);
    for (size_t i = 0; i < of->command_count; i++) {
        each_option(to, of, &of->commands[i], bash_value);
    }
    fputs("    esac\n    if [ -n \"$nothing\" ]; then\n        return\n    fi\n"
          "    if [ -z \"$words$files\" ]; then\n        case $command in\n"
          "        help) words='",
          to);
    for (size_t i = 0; i < of->command_count; i++) {
        fprintf(to, " %s", of->commands[i].name);
    }
    fputs("' ;;\n", to);
    for (size_t i = 0; i < of->command_count; i++) {
        fprintf(to, "        %s) words='", of->commands[i].name);
        if (has_words(of->commands[i].table->arguments)) {
            print_words(to, of->commands[i].table->arguments);
        }
        each_option(to, of, &of->commands[i], bash_name);
        fprintf(to, " --help'%s ;;\n",
                is_file(of->commands[i].table->arguments) ? " files=1" : "");
    }
    fputs("        esac\n    fi\n"
          "    case $cur in\n    -*) files= ;;\n"
          "    *) [ -z \"$files\" ] || { COMPREPLY=($(compgen -f -- \"$cur\")); return; "
          "} ;;\n"
          "    esac\n"
          "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}\n",
          to);
    fprintf(to, "complete -o filenames -F _%s %s\n", of->name, of->name);
}

/* ---- zsh --------------------------------------------------------------------------- */

static void zsh_option(void *context, const struct option_row *option)
{
    FILE *to = ((const struct walk *)context)->to;
    fprintf(to, "            '--%s%s[", option->name, option->arg != NULL ? "=" : "");
    print_text_zsh(to, option->help);
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

static void print_zsh(FILE *to, const struct ctl_program *of)
{
    fprintf(to,
            "#compdef %s\n# %s: completion for zsh, printed by %s completion zsh.\n"
            "_%s() {\n    local -a commands\n    commands=(\n",
            of->name, of->name, of->name, of->name);
    for (size_t i = 0; i < of->command_count; i++) {
        fprintf(to, "        '%s:", of->commands[i].name);
        print_text_zsh(to, of->commands[i].text);
        fputs("'\n", to);
    }
    fputs("        'help:explain a command'\n    )\n"
          "    if (( CURRENT == 2 )); then\n        _describe command commands\n"
          "        return\n    fi\n"
          "    local command=${words[2]}\n    shift words\n    (( CURRENT-- ))\n"
          "    case $command in\n    help) _describe command commands ;;\n",
          to);
    for (size_t i = 0; i < of->command_count; i++) {
        const char *arguments = of->commands[i].table->arguments;
        fprintf(to, "    %s)\n        _arguments \\\n", of->commands[i].name);
        each_option(to, of, &of->commands[i], zsh_option);
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
    fprintf(to, "    esac\n}\n_%s \"$@\"\n", of->name);
}

/* ---- fish -------------------------------------------------------------------------- */

static void fish_option(void *context, const struct option_row *option)
{
    const struct walk *walk = context;
    FILE *to = walk->to;
    fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from %s' -l %s",
            walk->of->name, walk->command->name, option->name);
    if (option->letter != 0) {
        fprintf(to, " -s %c", option->letter);
    }
    if (has_words(option->arg)) {
        fputs(" -x -a '", to);
        print_words(to, option->arg);
        putc('\'', to);
    } else if (option->arg != NULL) {
        fputs(is_file(option->arg) ? " -r -F" : " -x", to);
    }
    fputs(" -d '", to);
    print_text_fish(to, option->help);
    fputs("'\n", to);
}

static void print_fish(FILE *to, const struct ctl_program *of)
{
    const char *name = of->name;
    fprintf(to,
            "# %s: completion for fish, printed by %s completion fish.\n"
            "complete -c %s -f\n"
            "complete -c %s -n __fish_use_subcommand -a help -d 'explain a command'\n",
            name, name, name, name);
    fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from help' -a '", name);
    for (size_t i = 0; i < of->command_count; i++) {
        fprintf(to, "%s%s", i > 0 ? " " : "", of->commands[i].name);
    }
    fputs("'\n", to);
    for (size_t i = 0; i < of->command_count; i++) {
        const char *arguments = of->commands[i].table->arguments;
        fprintf(to, "complete -c %s -n __fish_use_subcommand -a %s -d '", name,
                of->commands[i].name);
        print_text_fish(to, of->commands[i].text);
        fputs("'\n", to);
        each_option(to, of, &of->commands[i], fish_option);
        if (has_words(arguments) || is_file(arguments)) {
            fprintf(to, "complete -c %s -n '__fish_seen_subcommand_from %s' ", name,
                    of->commands[i].name);
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

/* ---- the synopsis of a manual page ------------------------------------------------- */

static void print_synopsis(FILE *to, const struct ctl_program *of)
{
    for (size_t i = 0; i < of->command_count; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s %s", of->name, of->commands[i].name);
        option_synopsis(to, name, of->commands[i].table);
        fputs(i + 1 < of->command_count ? "++\n" : "\n", to);
    }
}

/* ---- the command ------------------------------------------------------------------- */

#define SHELLS "bash|zsh|fish"
/* Printers of completions, one for each shell, and of the synopsis, by a word that no
 * help names. */
static void (*const printers[])(FILE *to, const struct ctl_program *of) = {
    print_bash, print_zsh, print_fish, print_synopsis};

static void check(struct argp_state *state, void *to)
{
    const struct option_arguments *arguments = to;
    if (arguments->count > 1) {
        option_misused(state, "one shell at a time");
    }
    if (strcmp(arguments->list[0], "synopsis") != 0) {
        (void)option_word(state, NULL, arguments->list[0], strlen(arguments->list[0]),
                          SHELLS);
    }
}

const struct option_table completion_table = {
    .rows = (const struct option_row[]){{.type = OPTION_ARGUMENTS,
                                         .needed = "for which shell: bash, zsh or fish?"},
                                        {0}},
    .parts = (const struct option_part[]){{&ctl_common_table, 0}, {0}},
    .check = check};

int completion_command(const struct ctl_program *of, const struct option_table *table,
                       int argc, char **argv)
{
    static const char *const names[] = {"bash", "zsh", "fish", "synopsis"};
    struct option_arguments arguments = {.list = NULL};
    if (option_parse(table, argc, argv, &arguments) != 0) {
        return CTL_USAGE;
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(arguments.list[0], names[i]) == 0) {
            printers[i](stdout, of);
        }
    }
    return CTL_DONE;
}
