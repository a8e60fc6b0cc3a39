/* test_tool_whole_file.c - files that appear whole or not at all. */
#include "cases.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "whole_file.h"

#define LARGE 300000u

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/pccd-whole-XXXXXX");
    return mkdtemp(folder) != NULL && chdir(folder) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return chdir("/") == 0 && rmdir(folder) == 0 ? 0 : -1;
}

static uint32_t count_files(void)
{
    uint32_t count = 0;
    DIR *here = opendir(".");
    assert_non_null(here);
    for (const struct dirent *entry; (entry = readdir(here)) != NULL;) {
        count += entry->d_name[0] != '.';
    }
    closedir(here);
    return count;
}

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void assert_holds(const char *path, const char *text)
{
    char got[64] = "";
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_int_equal(fread(got, 1, sizeof got - 1, file), strlen(text));
    assert_string_equal(got, text);
    fclose(file);
}

/* Write `bytes` bytes in a process that may write 64 KiB: the errno of finishing. */
static int write_limited(const char *path, size_t bytes)
{
    int status;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        const struct rlimit limit = {65536, 65536};
        struct whole_file file;
        if (setrlimit(RLIMIT_FSIZE, &limit) != 0 || whole_file_open(&file, path) != 0) {
            _exit(255);
        }
        for (size_t i = 0; i < bytes; i++) {
            putc('x', file.to);
        }
        _exit(whole_file_finish(&file));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* If it failed: half a picture would be taken for one, or a good file be lost to it. */
CASE(file__appears_whole_or_not_at_all)
{
    assert_int_equal(write_limited("new", LARGE), EFBIG);
    assert_int_equal(count_files(), 0);
    put("old", "good");
    assert_int_equal(write_limited("old", LARGE), EFBIG);
    assert_holds("old", "good");
    assert_int_equal(count_files(), 1);
    assert_int_equal(write_limited("old", 3), 0);
    assert_holds("old", "xxx");
    assert_int_equal(count_files(), 1);
    unlink("old");
}

/* If it failed: who looks while it is written would see a part of it. */
CASE(file__is_what_it_was_until_it_is_finished)
{
    struct whole_file file;
    put("old", "good");
    assert_int_equal(whole_file_open(&file, "old"), 0);
    fputs("better", file.to);
    fflush(file.to);
    assert_int_equal(file.bytes, 6);
    assert_holds("old", "good");
    whole_file_discard(&file);
    whole_file_discard(&file); /* it is not open any more */
    assert_holds("old", "good");
    assert_int_equal(count_files(), 1);
    unlink("old");
}

/* If it failed: a program that was killed would leave parts of files about. */
CASE(file__of_a_killed_program_is_gone)
{
    int status, nameless = open(".", O_TMPFILE | O_WRONLY, 0600);
    if (nameless < 0) {
        test_skip("this file system makes no file without a name");
    }
    close(nameless);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct whole_file file;
        if (whole_file_open(&file, "new") == 0 && fputs("half", file.to) >= 0 &&
            fflush(file.to) == 0) {
            kill(getpid(), SIGKILL);
        }
        _exit(1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    assert_int_equal(count_files(), 0);
}

/* If it failed: a link would be replaced by a file, or a file's rights be changed. */
CASE(file__keeps_links_and_rights)
{
    struct whole_file file;
    struct stat info;
    put("old", "good");
    assert_int_equal(chmod("old", 0640), 0);
    assert_int_equal(symlink("old", "link"), 0);
    assert_int_equal(whole_file_open(&file, "link"), 0);
    fputs("better", file.to);
    assert_int_equal(whole_file_finish(&file), 0);
    assert_int_equal(lstat("link", &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat("old", &info), 0);
    assert_int_equal(info.st_mode & 07777, 0640);
    assert_holds("old", "better");
    assert_int_equal(count_files(), 2);
    unlink("link");
    unlink("old");
}

/* If it failed: a pipe or a device could not be written to, or be replaced by a file. */
CASE(file__is_written_straight_where_it_is_none)
{
    struct whole_file file;
    struct stat info;
    assert_int_equal(whole_file_open(&file, "/dev/full"), 0);
    fputs("text", file.to);
    assert_int_equal(whole_file_finish(&file), ENOSPC);
    assert_int_equal(stat("/dev/full", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
    assert_int_equal(whole_file_open(&file, "/nowhere/at/all"), ENOENT);
    assert_null(file.to);
    assert_int_equal(whole_file_open(&file, "."), EISDIR);
}

CASES_WITH(make_folder, remove_folder);
