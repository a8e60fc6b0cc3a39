/* error.c - one error text, filled where the fault is found. */
#include "error.h"

#include <stdarg.h>
#include <stdio.h>

int ctl_error_set(struct ctl_error *error, int status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return status;
}
