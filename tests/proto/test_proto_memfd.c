/* test_proto_memfd.c - shared memory keeps its size and its writer. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "memfd.h"
#include "pccd_types.h"
#include "shm.h"

#define BYTES     (16 * (size_t)PROTO_SHM_PAGE)
#define ALL_SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL)

static int count_open(void)
{
    int count = 0;
    for (int fd = 0; fd < 1024; fd++) {
        count += fcntl(fd, F_GETFD) != -1;
    }
    return count;
}

/* A memory of one's own making, for what a daemon would never send. */
static int make_memfd(off_t bytes, int seals)
{
    int fd = memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    assert_true(fd >= 0);
    assert_int_equal(ftruncate(fd, bytes), 0);
    if (seals != 0) {
        assert_int_equal(fcntl(fd, F_ADD_SEALS, seals), 0);
    }
    return fd;
}

/* If this failed, a client could shrink the memory and kill the daemon with SIGBUS. */
CASE(memory__cannot_change_its_size)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    for (int read_only = 0; read_only < 2; read_only++) {
        assert_ok(proto_memory_create(&memory, "test", BYTES, BYTES, read_only));
        char path[32];
        (void)snprintf(path, sizeof path, "/proc/self/fd/%d", memory.fd);
        assert_int_equal(chmod(path, S_IRUSR | S_IWUSR), 0); /* we own it */
        int writer = open(path, O_RDWR);
        assert_true(writer >= 0);
        assert_int_equal(ftruncate(writer, (off_t)BYTES - 1), -1);
        assert_int_equal(errno, EPERM);
        assert_int_equal(ftruncate(writer, (off_t)BYTES + 1), -1);
        assert_int_equal(errno, EPERM);
        assert_int_equal(close(writer), 0);
        assert_int_equal(ftruncate(memory.fd, (off_t)BYTES - 1), -1);
        assert_int_equal(errno, read_only ? EINVAL : EPERM);
        assert_int_equal(fcntl(memory.fd, F_ADD_SEALS, F_SEAL_WRITE), -1);
        assert_int_equal(errno, EPERM);
        assert_int_equal(fcntl(memory.fd, F_GETFD), FD_CLOEXEC);
        proto_memory_deinit(&memory);
    }
}

/* If this failed, the two sides would not see the same bytes. */
CASE(memory__is_shared)
{
    struct proto_memory ours = PROTO_MEMORY_NONE, theirs = PROTO_MEMORY_NONE;
    for (int read_only = 0; read_only < 2; read_only++) {
        assert_int_equal(proto_memory_create(&ours, "test", BYTES, BYTES, read_only), 0);
        assert_int_equal(proto_memory_map(&theirs, dup(ours.fd), BYTES, read_only), 0);
        for (size_t i = 0; i < BYTES; i += 4096) {
            assert_int_equal(((char *)ours.base)[i], 0);
        }
        memcpy((char *)ours.base + BYTES - 5, "there", 5);
        assert_memory_equal((char *)theirs.base + BYTES - 5, "there", 5);
        if (!read_only) {
            memcpy(theirs.base, "back", 4);
            assert_memory_equal(ours.base, "back", 4);
        }
        proto_memory_deinit(&theirs);
        proto_memory_deinit(&ours);
    }
}

/* 0: as ever; or the error of every fchmod, as where /proc is missing. */
static int fchmod_error;

int fchmod(int fd, mode_t mode)
{
    if (fchmod_error != 0) {
        errno = fchmod_error;
        return -1;
    }
    return (int)syscall(SYS_fchmod, fd, mode);
}

/* If this failed, one client could rewrite the results that it reads. */
CASE(result__cannot_be_made_writable)
{
    struct proto_memory ours = PROTO_MEMORY_NONE, theirs = PROTO_MEMORY_NONE;
    for (int is_sealed = 0; is_sealed < 2; is_sealed++) {
        fchmod_error = is_sealed ? EPERM : 0;
        assert_int_equal(proto_memory_create(&ours, "test", BYTES, BYTES, true), 0);
        fchmod_error = 0;
        assert_int_equal(proto_memory_map(&theirs, dup(ours.fd), BYTES, true), 0);
        assert_int_equal(mprotect(theirs.base, BYTES, PROT_READ | PROT_WRITE), -1);
        assert_int_equal(errno, EACCES);
        assert_ptr_equal(
            mmap(NULL, BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, theirs.fd, 0),
            MAP_FAILED);
        assert_int_equal(errno, is_sealed ? EPERM : EACCES);
        assert_int_equal(pwrite(theirs.fd, "x", 1, 0), -1);
        assert_int_equal(errno, is_sealed ? EPERM : EBADF);
        assert_int_equal(fallocate(theirs.fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                                   0, (off_t)BYTES),
                         -1);
        /* Our mapping still writes. */
        memcpy(ours.base, "ok", 2);
        assert_memory_equal(theirs.base, "ok", 2);
        proto_memory_deinit(&theirs);
        proto_memory_deinit(&ours);
    }
}

/* If this failed, another user who has the descriptor could open one that writes. */
CASE(result__is_not_opened_anew_by_others)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    struct stat info;
    assert_int_equal(proto_memory_create(&memory, "test", BYTES, BYTES, true), 0);
    assert_int_equal(fstat(memory.fd, &info), 0);
    assert_int_equal(info.st_mode & 07777, S_IRUSR);
    assert_int_equal(info.st_uid, geteuid());
    if (geteuid() == 0) {
        char path[32];
        int status = 0;
        (void)snprintf(path, sizeof path, "/proc/self/fd/%d", memory.fd);
        pid_t child = fork();
        if (child == 0) {
            bool is_other =
                setgroups(0, NULL) == 0 && setgid(65534) == 0 && setuid(65534) == 0;
            _exit(is_other && open(path, O_RDWR) < 0 && errno == EACCES ? 0 : 1);
        }
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_int_equal(status, 0);
    }
    proto_memory_deinit(&memory);
}

/* If this failed, memory that nobody uses would stay taken; or, where it cannot be given
 * back, it would be thought free. */
CASE(result__gives_memory_back)
{
    struct proto_memory ours = PROTO_MEMORY_NONE, theirs = PROTO_MEMORY_NONE;
    struct stat info;
    for (int is_sealed = 0; is_sealed < 2; is_sealed++) {
        fchmod_error = is_sealed ? EPERM : 0;
        assert_int_equal(proto_memory_create(&ours, "test", BYTES, BYTES, true), 0);
        fchmod_error = 0;
        assert_int_equal(proto_memory_map(&theirs, dup(ours.fd), BYTES, true), 0);
        memset(ours.base, 'x', BYTES);
        assert_int_equal(proto_memory_give_back(&ours, 4096, BYTES),
                         is_sealed ? PCCD_E_SYSTEM : 0);
        assert_int_equal(fstat(ours.fd, &info), 0);
        assert_int_equal(info.st_size, BYTES);
        assert_int_equal((size_t)info.st_blocks * 512, is_sealed ? BYTES : 4096);
        assert_memory_equal((char *)theirs.base + 4095, is_sealed ? "xx" : "x", 2);
        assert_int_equal(proto_memory_take(&ours, 4096, BYTES), 0);
        memcpy((char *)ours.base + BYTES - 5, "again", 5);
        assert_memory_equal((char *)theirs.base + BYTES - 5, "again", 5);
        proto_memory_deinit(&theirs);
        proto_memory_deinit(&ours);
    }
}

/* If this failed, a read beyond the end of a short memory would be a SIGBUS. */
CASE(map__refuses_another_size)
{
    struct proto_memory ours = PROTO_MEMORY_NONE, theirs = PROTO_MEMORY_NONE;
    static const size_t sizes[] = {0,         1,           BYTES - 1, BYTES - 4096,
                                   BYTES + 1, BYTES + 4096};
    assert_int_equal(proto_memory_create(&ours, "test", BYTES, BYTES, false), 0);
    int open_before = count_open();
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(proto_memory_map(&theirs, dup(ours.fd), sizes[i], false),
                         PCCD_E_BADMSG);
    }
    assert_int_equal(count_open(), open_before);
    assert_null(theirs.base);
    assert_int_equal(theirs.fd, -1);
    proto_memory_deinit(&ours);
}

/* If this failed, a memory whose size can still change would be trusted. */
CASE(map__refuses_missing_seals)
{
    struct proto_memory theirs = PROTO_MEMORY_NONE;
    static const int seals[] = {0, F_SEAL_SHRINK, F_SEAL_SHRINK | F_SEAL_GROW,
                                F_SEAL_GROW | F_SEAL_SEAL, F_SEAL_SHRINK | F_SEAL_SEAL};
    int open_before = count_open();
    for (size_t i = 0; i < sizeof seals / sizeof seals[0]; i++) {
        for (int read_only = 0; read_only < 2; read_only++) {
            assert_int_equal(proto_memory_map(&theirs, make_memfd((off_t)BYTES, seals[i]),
                                              BYTES, read_only),
                             PCCD_E_BADMSG);
        }
    }
    /* Right but for who may write. */
    assert_int_equal(
        proto_memory_map(&theirs, make_memfd((off_t)BYTES, ALL_SEALS), BYTES, true),
        PCCD_E_BADMSG);
    assert_int_equal(
        proto_memory_map(&theirs,
                         make_memfd((off_t)BYTES, ALL_SEALS | F_SEAL_FUTURE_WRITE), BYTES,
                         false),
        PCCD_E_BADMSG);
    assert_int_equal(count_open(), open_before);
    assert_ok(
        proto_memory_map(&theirs, make_memfd((off_t)BYTES, ALL_SEALS), BYTES, false));
    proto_memory_deinit(&theirs);
}

/* If this failed, a pipe or a file on disk could stand in for a memory. */
CASE(map__refuses_what_is_no_memfd)
{
    struct proto_memory theirs = PROTO_MEMORY_NONE;
    int pipe_fds[2];
    int open_before = count_open();
    assert_int_equal(pipe2(pipe_fds, O_CLOEXEC), 0);
    assert_int_equal(proto_memory_map(&theirs, pipe_fds[0], BYTES, false), PCCD_E_BADMSG);
    assert_int_equal(proto_memory_map(&theirs, pipe_fds[1], BYTES, true), PCCD_E_BADMSG);
    assert_int_equal(
        proto_memory_map(&theirs, open("/proc/self/exe", O_RDONLY), BYTES, true),
        PCCD_E_BADMSG);
    assert_int_equal(proto_memory_map(&theirs, -1, BYTES, true), PCCD_E_BADMSG);
    assert_int_equal(count_open(), open_before);
}

/* If this failed, the first step into each page would cost a fault, or die for lack of
 * memory that was promised. */
CASE(memory__is_there_from_the_start)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    struct stat info;
    unsigned char resident[BYTES / 4096];
    assert_int_equal(proto_memory_create(&memory, "test", BYTES, BYTES, false), 0);
    assert_int_equal(fstat(memory.fd, &info), 0);
    assert_true((size_t)info.st_blocks * 512 >= BYTES);
    assert_int_equal(mincore(memory.base, BYTES, resident), 0);
    for (size_t i = 0; i < sizeof resident; i++) {
        assert_int_equal(resident[i] & 1, 1);
    }
    proto_memory_deinit(&memory);
}

/* If this failed, a client would cost the whole of a memory of which it uses little, or
 * what is written would have no memory yet. */
CASE(memory__is_taken_in_steps)
{
    struct proto_memory ours = PROTO_MEMORY_NONE, theirs = PROTO_MEMORY_NONE;
    struct stat info;
    assert_int_equal(proto_memory_create(&ours, "test", BYTES, 4096, true), 0);
    assert_int_equal(proto_memory_map(&theirs, dup(ours.fd), BYTES, true), 0);
    assert_int_equal(fstat(ours.fd, &info), 0);
    assert_int_equal(info.st_size, BYTES);
    assert_int_equal(info.st_blocks * 512, 4096);
    assert_int_equal(proto_memory_take(&ours, 4096, 3 * 4096), 0);
    assert_int_equal(fstat(ours.fd, &info), 0);
    assert_int_equal(info.st_blocks * 512, 3 * 4096);
    memcpy((char *)ours.base + 2 * 4096, "there", 5);
    assert_memory_equal((char *)theirs.base + 2 * 4096, "there", 5);
    assert_int_equal(fstat(ours.fd, &info), 0);
    assert_int_equal(info.st_blocks * 512, 3 * 4096);
    proto_memory_deinit(&theirs);
    proto_memory_deinit(&ours);
}

/* Error of madvise with MADV_POPULATE_WRITE; 0: as ever. */
static int populate_error;

int madvise(void *at, size_t bytes, int advice)
{
    if (advice == 23 && populate_error != 0) {
        errno = populate_error;
        return -1;
    }
    return (int)syscall(SYS_madvise, at, bytes, advice);
}

/* If this failed, a daemon on Linux before 5.14 would die of SIGBUS where memory is
 * short, instead of saying so. */
CASE(results__are_there_from_the_start_on_an_old_kernel)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    struct stat info;
    populate_error = EINVAL;
    assert_ok(proto_memory_create(&memory, "test", BYTES, PROTO_SHM_PAGE, true));
    assert_int_equal(proto_memory_take(&memory, PROTO_SHM_PAGE, BYTES), 0);
    assert_int_equal(proto_memory_give_back(&memory, PROTO_SHM_PAGE, BYTES),
                     PCCD_E_SYSTEM); /* it could not be taken again */
    populate_error = 0;
    assert_int_equal(fstat(memory.fd, &info), 0);
    assert_int_equal((size_t)info.st_blocks * 512, BYTES);
    proto_memory_deinit(&memory);

    assert_ok(proto_memory_create(&memory, "test", BYTES, PROTO_SHM_PAGE, true));
    populate_error = EFAULT; /* no memory */
    assert_int_equal(proto_memory_take(&memory, PROTO_SHM_PAGE, BYTES), PCCD_E_NOMEM);
    populate_error = 0;
    proto_memory_deinit(&memory);
}

/* If this failed, running out of memory or descriptors would leave half a memory
 * behind. */
CASE(create__leaves_nothing_behind_on_failure)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    struct rlimit before, none;
    int open_before = count_open();

    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    none = before;
    none.rlim_cur = 4096; /* posix_fallocate fails: the file may not be that large */
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
    int status = proto_memory_create(&memory, "test", BYTES, BYTES, false);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_true(status == PCCD_E_SYSTEM || status == PCCD_E_NOMEM);

    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = before;
    none.rlim_cur = 0;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    status = proto_memory_create(&memory, "test", BYTES, BYTES, false);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(status, PCCD_E_SYSTEM);

    assert_int_equal(count_open(), open_before);
    assert_int_equal(memory.fd, -1);
    assert_null(memory.base);
}

/* If this failed, an error path that cleans up twice would close a stranger's
 * descriptor. */
CASE(deinit__may_be_called_twice)
{
    struct proto_memory memory = PROTO_MEMORY_NONE;
    proto_memory_deinit(&memory);
    assert_int_equal(proto_memory_create(&memory, "test", BYTES, BYTES, true), 0);
    proto_memory_deinit(&memory);
    assert_int_equal(memory.fd, -1);
    assert_null(memory.base);
    int open_before = count_open();
    proto_memory_deinit(&memory);
    assert_int_equal(count_open(), open_before);
}
