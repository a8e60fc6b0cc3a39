/* test_srv_sandbox.c - the calls of the sandbox on other processors. */
#include "cases.h"
#include "sandbox_calls.h"

#ifdef HAVE_SECCOMP
#include <seccomp.h>

static const char *const calls[] = {
#define CALL(name) #name,
    SRV_SANDBOX_CALLS(CALL)
#undef CALL
};

#define CALL_COUNT (sizeof calls / sizeof calls[0])

/* Return what glibc calls where there is no such call. */
static const char *in_place_of(const char *call)
{
    static const char *const pairs[][2] = {{"epoll_wait", "epoll_pwait"},
                                           {"poll", "ppoll"},
                                           {"rmdir", "unlinkat"},
                                           {"unlink", "unlinkat"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        if (strcmp(call, pairs[i][0]) == 0) {
            return pairs[i][1];
        }
    }
    return call;
}

static bool has(uint32_t processor, const char *call)
{
    return seccomp_syscall_resolve_name_arch(processor, call) >= 0;
}

static bool is_allowed(const char *call)
{
    size_t i = 0;
    while (i < CALL_COUNT && strcmp(calls[i], call) != 0) {
        i++;
    }
    return i < CALL_COUNT;
}

static const uint32_t processors[] = {SCMP_ARCH_X86_64, SCMP_ARCH_AARCH64,
                                      SCMP_ARCH_RISCV64};
#endif

/* If one were missing, a daemon there would leave its socket behind, or not serve. */
CASE(sandbox__allows_what_each_processor_calls)
{
#ifdef HAVE_SECCOMP
    for (size_t n = 0; n < sizeof processors / sizeof processors[0]; n++) {
        for (size_t i = 0; i < CALL_COUNT; i++) {
            const char *call = calls[i];
            call = has(processors[n], call) ? call : in_place_of(call);
            if (!has(processors[n], call) || !is_allowed(call)) {
                fail_msg("%s is not allowed, for processor %#x", call,
                         (unsigned)processors[n]);
            }
        }
    }
#else
    test_skip("built without libseccomp");
#endif
}
