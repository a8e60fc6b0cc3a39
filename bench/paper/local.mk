# bench/paper/local.mk - the paper's evaluation, section 7.
#
# make bench                               all of it, some 25 minutes, into BENCH_INTO
# make bench BENCH_PARTS="peers figures"   parts of it (evaluate.sh has their names)
# make bench BENCH_MACHINE=desk            a name for this machine

test_scripts += bench/paper/smoke.sh

# The processor's name and how many there are, as a folder's name.
BENCH_MACHINE = $$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1 | \
    tr 'A-Z' 'a-z' | tr -cs 'a-z0-9\n' -)-$$(nproc)
BENCH_INTO = $(srcdir)/bench/results/$(BENCH_MACHINE)
BENCH_PARTS =

if HAVE_PEERS
bench_paper_peers = bench/peers/peers
endif

.PHONY: bench
bench: bench/pccd-bench bench/model/model bench/growth/growth pccdd pccd-load $(bench_paper_peers)
	@$(AM_TESTS_ENVIRONMENT) \
	$(srcdir)/bench/paper/evaluate.sh "$(BENCH_INTO)" $(BENCH_PARTS)
