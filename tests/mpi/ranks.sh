# ranks.sh - starts the ranks of a program by the MPI of the build; sourced by bash scripts.
#
#   ranks N PROGRAM [ARGUMENT]...   with N ranks on this machine, more than it has processors
#                                   perhaps; ends after RANKS_SECONDS
#
# Nothing is started on other machines: Open MPI would look for ssh otherwise.

RANKS_SECONDS=${RANKS_SECONDS:-100}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

ranks() {
    local count=$1
    shift
    case $PCCD_MPI in
    openmpi)
        timeout -k 5 "$RANKS_SECONDS" "$MPIEXEC" --mca plm isolated --oversubscribe \
            --mca mpi_yield_when_idle 1 --mca btl self,vader -n "$count" "$@"
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
