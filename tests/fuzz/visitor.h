/* visitor.h - an honest client that must still be served among the inputs of a fuzzer.
 *
 * Room:     tests/fuzz. May include: the C library.
 * Threads:  one.
 * Does:     ask for everything once (tests/fault/life.h), and abort if something is
 *           refused.
 */
#ifndef FUZZ_VISITOR_H
#define FUZZ_VISITOR_H

void fuzz_visit(const char *socket_path);

#endif
