# ranks.sh - starts the ranks of a program by the MPI of the build; sourced by bash scripts.
#
#   ranks N PROGRAM [ARGUMENT]...   with N ranks on this machine, more than it has processors
#                                   perhaps; ends after RANKS_SECONDS
#
# Nothing is started on other machines: Open MPI 4 would look for ssh otherwise. Settings go by the
# environment, where a release that lacks a component (5 has no plm "isolated") says nothing. Ranks
# of 5 sleep while they wait: eight that yield take three times as long on two busy processors. Those
# of 4 do where ranks_rest=yes preloads them with rest.c; no time is worth anything then.

RANKS_SECONDS=${RANKS_SECONDS:-300} # to 60 s have been seen beside other tests, 4 alone
ranks_rest=no
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_plm=isolated OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl=^tcp
export OMPI_MCA_threads_pthreads_yield_strategy=nanosleep

# What a rank says on its standard error goes past mpirun: that of Open MPI 5 may print a part of it
# on the standard output.
ranks() {
    local count=$1 status=0 said rest=
    shift
    # A sanitizer wants to come first.
    if [ $ranks_rest = yes ] && ! grep -q -- -DPCCD_SANITIZED "$top_builddir/Makefile"; then
        rest=$top_builddir/tests/mpi/.libs/rest.so
    fi
    case $PCCD_MPI in
    openmpi)
        said=$(mktemp "${TMPDIR:-/tmp}/pccd-ranks-XXXXXX") || return
        # shellcheck disable=SC2016 # of the inner shell
        timeout -k 5 "$RANKS_SECONDS" "$MPIEXEC" --oversubscribe -n "$count" \
            sh -c 'said=$1; export LD_PRELOAD="$2"; shift 2; exec "$@" 2>>"$said"' \
            rank "$said" "$rest" "$@" || status=$?
        cat "$said" >&2
        rm -f "$said"
        return $status
        ;;
    mpich)
        timeout -k 5 "$RANKS_SECONDS" "$MPIEXEC" -n "$count" "$@"
        ;;
    *)
        echo "ranks.sh: no MPI" >&2
        return 1
        ;;
    esac
}
