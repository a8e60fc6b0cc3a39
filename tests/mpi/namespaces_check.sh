#!/bin/bash
# namespaces_check.sh - each rank in a network of its own: the same bytes, over TCP.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

name=mpi__ranks_in_networks_of_their_own_answer_as_one_process
work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-mpi-XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
log=$work/log
plays=4
export RANKS_SECONDS=100
if [ "${PCCD_MPI_ALL:-0}" != 0 ]; then
    plays=60
    RANKS_SECONDS=300
fi

# What runs inside: it makes the networks, then starts a rank in each. Exit status 77: it may
# not.
cat >"$work/inside.sh" <<'END'
mount -t tmpfs none /run && mkdir /run/netns && ip link set lo up &&
    ip link add bridge type bridge && ip address add 10.77.0.100/24 dev bridge &&
    ip link set bridge up || exit 77
for i in 1 2 3; do
    ip netns add "rank$i" && ip link add "at$i" type veth peer name wire netns "rank$i" &&
        ip link set "at$i" master bridge up &&
        ip -n "rank$i" address add "10.77.0.$i/24" dev wire &&
        ip -n "rank$i" link set wire up && ip -n "rank$i" link set lo up || exit 77
done
# MPI calls it in the place of ssh: AGENT [OPTION]... HOST COMMAND...
cat >/run/agent <<'AGENT'
#!/bin/bash
while [ "${1#-}" != "$1" ]; do shift; done
name=rank${1##*[.k]} # rank2 and 10.77.0.2 are the same
shift
exec ip netns exec "$name" unshare -u bash -c "hostname $name; $*"
AGENT
chmod +x /run/agent
if [ "$PCCD_MPI" = openmpi ]; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    set -- --mca plm_rsh_agent /run/agent --mca btl tcp,self \
        --mca btl_tcp_if_include 10.77.0.0/24 --mca oob_tcp_if_include 10.77.0.0/24 \
        --mca mpi_yield_when_idle 1 -H rank1,rank2,rank3 -n 3 "$@"
else
    export UCX_TLS=tcp,self UCX_NET_DEVICES=wire
    set -- -launcher ssh -launcher-exec /run/agent -localhost 10.77.0.100 \
        -hosts 10.77.0.1,10.77.0.2,10.77.0.3 -n 3 "$@"
fi
unshare -u bash -c 'hostname starter && exec timeout -k 5 "$@"' sh \
    "$RANKS_SECONDS" "$MPIEXEC" "$@" || status=$?
# MPICH 4.0 over UCX 1.13, as Debian 12 has them, may wait for ever in MPI_Finalize, also in a
# program that only adds up numbers. All answers have been compared then.
[ "${status:-0}" -eq 0 ] || { [ "$PCCD_MPI" = mpich ] && [ "$status" -eq 124 ]; } || exit 1
# All of it went over the bridge: more than starting the ranks takes.
bytes=$(cat /sys/class/net/at2/statistics/rx_bytes 2>/dev/null ||
    ip -s link show at2 | awk '/RX:/ { getline; print $1 }')
echo "rank 2 has sent $bytes bytes"
[ "$bytes" -gt 100000 ]
END

if [ "${PCCD_MPI:-no}" = no ]; then
    tap_skip "$name" "no --with-mpi"
elif ! command -v ip >/dev/null; then
    tap_skip "$name" "no ip (iproute2)"
else
    unshare --net --mount --propagation private bash "$work/inside.sh" \
        "$top_builddir/tests/mpi/same_as_one" $plays 60 31 >"$log" 2>&1
    status=$?
    if [ $status -eq 77 ] || grep -q 'unshare failed' "$log"; then
        tap_skip "$name" "this user may not make networks"
    else
        # If it failed, ranks on several machines could answer otherwise than on one.
        [ $status -eq 0 ] && grep -q '^# 3 ranks: ' "$log"
        tap_result $? "$name" "$log"
    fi
fi
tap_end
