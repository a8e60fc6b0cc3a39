/* page_template.c - the page, without data. */
#include "inspect.h"

/* From the folder of the build, which is on the assembler's path. */
__asm__(".section .rodata\n"
        ".global ctl_page_begin\n"
        ".hidden ctl_page_begin\n"
        ".global ctl_page_end\n"
        ".hidden ctl_page_end\n"
        "ctl_page_begin:\n"
        ".incbin \"client/inspect/page.html\"\n"
        "ctl_page_end:\n"
        ".byte 0\n"
        ".previous\n");

extern const char ctl_page_begin[] __attribute__((visibility("hidden")));
extern const char ctl_page_end[] __attribute__((visibility("hidden")));

const char *page_template(size_t *bytes)
{
    *bytes = (size_t)(ctl_page_end - ctl_page_begin);
    return *bytes > 0 ? ctl_page_begin : NULL;
}
