/* struct_size.h - lets a program and a library of different releases exchange structs
 * that have grown (struct_bytes).
 *
 * Read a struct that a program of another release filled in, and fill in one that it will
 * read. The program says in struct_bytes how much of the struct it knows; 0 stands for
 * what this library knows.
 */
#ifndef CLI_STRUCT_SIZE_H
#define CLI_STRUCT_SIZE_H

#include <stddef.h>

struct pccd_client;

/* Copy `asked` to `known`, which has known_bytes. Members that only a later release has
 * must be 0. E_INVAL with a text that begins with `name`. */
int cli_struct_read(struct pccd_client *client, const char *name, const void *asked,
                    void *known, size_t known_bytes);

/* May a struct that says to be of struct_bytes be filled in? E_INVAL likewise. */
int cli_struct_check(struct pccd_client *client, const char *name, size_t struct_bytes,
                     size_t known_bytes);

/* Copy `known` to `to`, whose struct_bytes was checked and stays; what it has beyond
 * known_bytes becomes 0. */
void cli_struct_fill(void *to, const void *known, size_t known_bytes);

#endif
