/* folder.h - the folders in which what the library needs may lie.
 *
 * Tell the folder of the file that this library is, and of the running program. A product
 * may bring all of pccd in one folder of its own, as a Python wheel does.
 */
#ifndef CLI_FOLDER_H
#define CLI_FOLDER_H

#define CLI_FOLDER_BYTES 4096

/* Without a slash at the end; "": not known, or too long. */
void cli_folder_of_library(char folder[CLI_FOLDER_BYTES]);
void cli_folder_of_program(char folder[CLI_FOLDER_BYTES]);

#endif
