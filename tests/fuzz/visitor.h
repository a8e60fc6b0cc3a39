/* visitor.h - an honest client that must still be served among the inputs of a fuzzer. */
#ifndef FUZZ_VISITOR_H
#define FUZZ_VISITOR_H

void fuzz_visit(const char *socket_path);

#endif
