/* folder.c - the folders in which what the library needs may lie. */
#include "folder.h"

#include <dlfcn.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

static void cut_name(char path[CLI_FOLDER_BYTES])
{
    char *slash = strrchr(path, '/');

    *(slash != NULL ? slash : path) = '\0';
}

void cli_folder_of_library(char folder[CLI_FOLDER_BYTES])
{
    Dl_info info;

    folder[0] = '\0';
    if (dladdr((const void *)(uintptr_t)&cli_folder_of_library, &info) != 0 &&
        info.dli_fname != NULL && strlen(info.dli_fname) < CLI_FOLDER_BYTES) {
        memcpy(folder, info.dli_fname, strlen(info.dli_fname) + 1);
    }
    cut_name(folder);
}

void cli_folder_of_program(char folder[CLI_FOLDER_BYTES])
{
    ssize_t bytes = readlink("/proc/self/exe", folder, CLI_FOLDER_BYTES - 1);

    folder[bytes > 0 ? bytes : 0] = '\0';
    cut_name(folder);
}
