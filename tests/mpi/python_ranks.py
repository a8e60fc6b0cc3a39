"""python_ranks.py - pccd.mpi over ranks, beside one process.

Room:     tests/mpi. Run by mpirun, with mpi4py; all ranks end with 1 if one is wrong.
Does:     a sheet falls on a pyramid, each rank has some rows of it: the hash, counts and
          gathered records of steps and questions are those of a client of direct:; a
          second thread cancels.
"""

import sys
import threading
import time

import numpy as np
from mpi4py import MPI

import pccd
import pccd.mpi

N = 12


def scene():
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, N)], indexing="ij")
    sheet = np.stack([u, v, 0.2 + 0 * u], -1).reshape(-1, 3)
    at = (np.arange(N - 1)[:, None] * N + np.arange(N - 1)).reshape(-1)
    triangles = np.concatenate([np.stack([at, at + 1, at + N], -1),
                                np.stack([at + 1, at + N + 1, at + N], -1)])
    cone = np.array([[-.5, -.5, 0], [.5, -.5, 0], [0, .5, 0], [0, 0, .15]])
    faces = len(sheet) + np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    return np.concatenate([sheet, cone]), np.concatenate([triangles, faces])


def refused(status, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except pccd.PccdError as problem:
        assert problem.status == status, problem
        return problem.text
    raise AssertionError("not refused")


def misuse(comm, world, x, faces, **totals):
    """Arrays of another length than they should have, on one rank; threads."""
    last = comm.rank == comm.size - 1
    invalid = pccd.Status.E_INVAL
    for name in "radii", "vertices", "triangle_numbers":
        count = len(faces) if name == "triangle_numbers" else len(x)
        text = refused(invalid, world.mesh_create, x, faces, **totals,
                       **{name: np.zeros(count - last, int) if last else None})
        assert (name if last else "NULL") in text, text
    refused(invalid, world.near, "closest")
    refused(invalid, world.near, "vertices")
    if last:
        got = []
        world._turn.acquire()
        thread = threading.Thread(target=lambda: got.append(
            refused(pccd.Status.E_BUSY, world.step)))
        thread.start()
        thread.join()
        world._turn.release()
        assert "another thread" in got[0]


def main():
    comm = MPI.COMM_WORLD
    x, triangles = scene()
    mine = np.array_split(np.arange(len(x)), comm.size)[comm.rank]
    faces = np.array_split(triangles, comm.size)[comm.rank]
    end = x - (np.arange(len(x)) < N * N)[:, None] * [0, 0, 0.3]
    with pccd.connect("direct:") as client, pccd.mpi.World(comm) as world:
        one = client.scene_create()
        body = client.scene_add(one, client.mesh_create(x, triangles))
        mesh = world.mesh_create(x[mine], faces, vertex_total=len(x),
                                 triangle_total=len(triangles))
        whole = world.add(mesh)
        for handle, set_it in ((body, lambda **a: client.object_set(one, body, **a)),
                               (whole, lambda **a: world.object_set(whole, **a))):
            set_it(radius=0.01, rest_rings=1)
        motions = pccd.Motions()
        x1 = np.ascontiguousarray(end[mine])
        motions.x1(whole, x1)
        alone, ours = client.step_x1(one, body, end), world.step(motions)
        assert ours.total == alone.total > 10, (ours.total, alone.total)
        misuse(comm, world, x[mine], faces, vertex_total=len(x),
               triangle_total=len(triangles))
        assert ours.hash == alone.hash and ours.toi_first == alone.toi_first
        assert comm.allreduce(ours.count) == ours.total
        assert all(len(world.feature(whole, 1, c["feature_a"])) == 1
                   for c in ours.contacts if c["kind"] == pccd.Kind.VF)
        contacts = ours.contacts.copy()
        records = world.gather(root=0)
        assert (records is None) == (comm.rank != 0)
        assert records is None or np.array_equal(
            records["feature_a"], alone.contacts["feature_a"])
        ask = (pccd.NearWhat.PAIRS, pccd.NearWhat.VERTICES, pccd.NearWhat.CROSSINGS)
        for what in ask:
            near = world.near(what, 0.05 if what != ask[2] else 0)
            with client.near(one, what, 0.05 if what != ask[2] else 0) as said:
                assert near.hash == said.hash and near.total == said.total, what
        # Records of an answer are there after other calls.
        assert np.array_equal(ours.contacts, contacts)
        assert world.share().own > 0
        # Before a call nothing is there to be cancelled; then a thread of the last rank
        # cancels while that waits for the first one.
        world.cancel()
        assert world.step(motions).incomplete == 0
        ended = threading.Event()

        def cancel():
            while not ended.wait(0.01):
                world.cancel()

        thread = threading.Thread(target=cancel)
        if comm.rank == comm.size - 1:
            thread.start()
        elif comm.rank == 0:
            time.sleep(0.2)
        why = world.step(motions).incomplete
        ended.set()
        if comm.rank == comm.size - 1:
            thread.join()
        assert comm.size == 1 or why == pccd.Incomplete.CANCELLED, why
        # A mistake of one rank is told to all of them.
        try:
            world.step(motions, pccd.StepSettings(separation=float(comm.rank)))
            assert comm.size == 1
        except pccd.PccdError as problem:
            assert comm.size > 1 and problem.status == pccd.Status.E_INVAL, problem
    for call in world.step, world.near, world.share, world.gather:
        refused(pccd.Status.E_STATE, call)
    world.close()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except AssertionError:
        import traceback
        traceback.print_exc()
        MPI.COMM_WORLD.Abort(1)
