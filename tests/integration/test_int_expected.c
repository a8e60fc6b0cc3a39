/* test_int_expected.c - how many records libpccd-mpi says that a step will find. */
#include "cases.h"

#include <unistd.h>

#include "grid.h"
#include "mpi_hooks.h"
#include "must.h"
#include "pccd.h"
#include "process_status.h"

static uint64_t shared_mb(void)
{
    return common_process_status((long)getpid(), "RssShmem:") >> 10;
}

/* If it failed, a process of libpccd-mpi would keep the memory of records that went to
 * others, or miss some. */
CASE(expected__memory_follows_records)
{
    enum { WIDTH = 512, CONTACTS = WIDTH * WIDTH, MB = CONTACTS >> 14 };
    static const uint64_t expected[] = {CONTACTS, 0, 4 * CONTACTS, 0};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t answered = 0, rest = 0;

    struct pccd_client *client = test_client(&(struct pccd_options){.url = "direct:"});
    assert_ok(test_grid_make(client, WIDTH, &grid));
    for (int i = 0; i < 4; i++) {
        assert_ok(test_grid_turn(&grid, NULL, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        answered = shared_mb();
        if (answered == 0) {
            test_skip("this system does not tell how much memory is shared");
        }
        pccd_answer_release(client, &answer);
        cli_mpi_expect(client, grid.scene, expected[i]);
        rest = i == 0 ? shared_mb() : rest; /* slots for positions */
        assert_in_range(shared_mb(), rest, rest + 1);
        /* What the client has read was mapped twice. */
        assert_in_range(answered - rest - (i == 3 ? 5u : 2u) * MB, 0, 8);
    }
    test_grid_close(&grid);
}
