"""check_points.py - stencils, points and manifolds of records, from Python.

Room:     tests/python. Needs a daemon (support.py).
Does:     compare with what numpy makes of the same records.
"""

import unittest
from fractions import Fraction

import numpy as np

import pccd
from support import Supervised, cloth_triangles

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
SIDES = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
                  [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])
PLATE = np.array([[-4, -4, 0], [5, -4, 0], [5, 5, 0], [-4, 5, 0.0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
DOWN = np.array([0, 0, -2.0])


class Points(Supervised):
    """Two cubes that fall on a plate, one of them tilted; a rod and a cloud beside."""

    def setUp(self):
        self.client = client = self.connect()
        self.scene = client.scene_create()
        cube = client.mesh_create(CUBE, SIDES)
        plate = client.mesh_create(PLATE, HALVES)
        points = client.mesh_create(CUBE, points=np.arange(8))
        rods = client.mesh_create(CUBE, edges=[[0, 1], [6, 7]])
        self.plate = client.scene_add(self.scene, plate)
        self.cubes = [client.scene_add(self.scene, cube) for _ in range(2)]
        self.free = [client.scene_add(self.scene, mesh) for mesh in (points, rods)]
        self.x0 = {self.plate: PLATE, self.cubes[0]: CUBE + [0, 0, 1.5],
                   self.cubes[1]: CUBE @ [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]]
                   + [3, 0, 1.25], self.free[0]: CUBE + [0, 3, 0.25],
                   self.free[1]: CUBE + [0.25, 3, 0.5]}
        self.x1 = {handle: self.x0[handle] + DOWN for handle in self.cubes}
        moves = pccd.Motions()
        for handle in (*self.cubes, *self.free):
            moves.x0x1(handle, self.x0[handle], self.x1.get(handle, self.x0[handle]))
        self.moves = moves

    def all_of(self, x):
        return np.concatenate([x.get(handle, self.x0[handle])
                               for handle in sorted(self.x0)])

    # If this failed, a force would act on other vertices, or in another direction.
    def test_stencils__are_what_the_records_say(self):
        client, scene = self.client, self.scene
        x0, x1 = self.all_of(self.x0), self.all_of(self.x1)
        with client.step(scene, self.moves, pccd.StepSettings(separation=0.5)) as answer:
            for kind in (pccd.Kind.VF, pccd.Kind.EE, pccd.Kind.VE):
                self.assertGreater(answer.counts[kind], 0)
            stencils = answer.stencils(scene)
            points = client.bodies(scene).points(answer.records, self.x0, self.x1)
            x = x0 + stencils.at[:, None, None] * (x1 - x0)[None]
            x = np.take_along_axis(x, stencils.vertices[..., None].astype(np.int64), 1)
            between = (x * stencils.weights[..., None]).sum(1)
            np.testing.assert_allclose(between, points[:, 0] - points[:, 1], atol=1e-6)
            np.testing.assert_allclose(stencils.weights.sum(1), 0, atol=1e-6)
            np.testing.assert_array_equal(stencils.normal, answer.contacts["normal"])
            length = np.linalg.norm(between, axis=1)
            first = answer.contacts["flags"] & pccd.ContactFlag.INITIAL
            np.testing.assert_allclose(length[first == 0], 0.5, atol=1e-5)
        with client.near(scene, "pairs", 0.75, at_begin=True) as answer:
            stencils = answer.stencils(scene)
            self.assertGreater(len(stencils.at), 10)
            x = x0[stencils.vertices] * stencils.weights[..., None]
            np.testing.assert_allclose(np.linalg.norm(x.sum(1), axis=1), stencils.at,
                                       atol=1e-5)

    # If this failed, a cube would stand on one corner, or a game hear of a body twice.
    def test_manifolds__carry_what_falls(self):
        client, scene = self.client, self.scene
        with client.step(scene, self.moves) as answer:
            bodies = client.bodies(scene)
            contacts = answer.contacts.copy()
            made = bodies.manifolds(contacts, self.x0, self.x1)
            flat = np.concatenate(list(self.x0.values()))  # of which object is what?
            self.fails(pccd.Status.E_INVAL, bodies.points, contacts, flat)
        self.assertEqual(made["object_a"].tolist(), [self.plate, self.plate])
        self.assertEqual(made["object_b"].tolist(), self.cubes)
        flat, tilted = made
        self.assertEqual(flat["count"], 4)
        points = flat["points"]["point"]
        np.testing.assert_allclose(np.ptp(points, axis=0), [1, 1, 0], atol=1e-6)
        np.testing.assert_allclose(flat["points"]["normal"], [[0, 0, 1]] * 4)
        self.assertEqual(tilted["count"], 2)
        np.testing.assert_allclose(tilted["points"]["toi"][:2], 0.625, atol=1e-6)
        records = contacts[tilted["points"]["record"][:2]]
        self.assertTrue((records["object_a"] != self.cubes[0]).all())
        with client.step(scene, self.moves,
                         pccd.StepSettings(mode="first-per-pair")) as answer:
            self.assertEqual(answer.total, 2)
            for one in answer.contacts:
                pair = {one["object_a"], one["object_b"]}
                same = [all_ for all_ in contacts
                        if {all_["object_a"], all_["object_b"]} == pair]
                self.assertEqual(one, min(same, key=lambda each: each["toi"]))
        poses = {handle: (np.eye(3, 4), np.c_[np.eye(3), DOWN]) for handle in self.cubes}
        by_pose = bodies.manifolds(contacts, self.x0, poses=poses)
        self.assertEqual(by_pose.tobytes(), made.tobytes())

    # If this failed, a mistake would read memory that is nobody's.
    def test_bodies__refuse_what_they_do_not_know(self):
        client, scene = self.client, self.scene
        with client.step(scene, self.moves) as answer:
            contacts = answer.contacts.copy()
        bodies = client.bodies(scene)
        self.fails(pccd.Status.E_HANDLE, bodies.points, contacts, {self.plate: PLATE})
        self.fails(pccd.Status.E_INVAL, bodies.points, contacts,
                   {**self.x0, self.plate: PLATE[:3]})
        self.fails(pccd.Status.E_INVAL, bodies.stencils, np.zeros(3))
        self.fails(pccd.Status.E_INVAL, bodies.manifolds, contacts, self.x0, within=-1.0)
        client.scene_remove(scene, self.cubes[0])
        self.fails(pccd.Status.E_HANDLE, client.bodies(scene).stencils, contacts)
        with self.connect(keep=False) as other:
            made = other.scene_create()
            other.scene_add(made, other.mesh_create(CUBE, SIDES))
            self.fails(pccd.Status.E_STATE, other.bodies, made)


class Casts(Supervised):
    """Rays, spheres and capsules over hills."""

    def setUp(self):
        side = 16
        u, v = np.meshgrid(*2 * [np.arange(side, dtype=float)], indexing="ij")
        self.x = np.stack([u, v, np.sin(u) * np.cos(0.7 * v)], -1).reshape(-1, 3)
        self.triangles = cloth_triangles(side)
        self.client = self.connect()
        self.scene = self.client.scene_create()
        level = self.client.mesh_create(self.x, self.triangles)
        self.level = self.client.scene_add(self.scene, level)
        random = np.random.default_rng(5)
        self.begin = random.uniform([-1, -1, -2], [16, 16, 4], (300, 3))
        self.end = random.uniform([-1, -1, -2], [16, 16, 4], (300, 3))

    def first(self, begin, end):
        """Where a ray meets the hills, by numpy."""
        a, b, c = self.x[self.triangles].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((a - begin) * normal).sum(1) / ((end - begin) * normal).sum(1)
        p = begin + t[:, None] * (end - begin)
        inside = (t >= 0) & (t <= 1)
        for one, other in ((a, b), (b, c), (c, a)):
            inside &= (np.cross(other - one, p - one) * normal).sum(1) >= 0
        return t[inside].min(initial=np.inf), np.flatnonzero(inside)

    # If this failed, a shot would go through a hill, or hit the one behind.
    def test_cast__finds_the_first_thing_of_each_ray(self):
        truth = [self.first(*ray) for ray in zip(self.begin, self.end)]
        times = np.array([t for t, _ in truth])
        self.assertGreater(np.isfinite(times).sum(), 50)
        self.assertGreater(np.isinf(times).sum(), 50)
        for pieces in (1, 3, 8):
            rays = pccd.Rays(self.client, self.scene, 300, pieces=pieces)
            for _ in range(2):
                hits = rays.cast(self.begin, self.end)
                np.testing.assert_allclose(hits.t, times, atol=1e-6)
                for k in np.flatnonzero(np.isfinite(times)):
                    self.assertIn(hits.feature[k], truth[k][1])
                    self.assertEqual(hits.object[k], self.level)
                    corners = self.x[self.triangles[hits.feature[k]]]
                    np.testing.assert_allclose(hits.weights[k] @ corners, hits.point[k],
                                               atol=1e-5)
            rays.close()
        self.fails(pccd.Status.E_INVAL, rays.cast, self.begin[:3], self.end)
        for radii in ([1, 2], np.ones((300, 1)), "none", [[1], [1, 2]]):
            self.fails(pccd.Status.E_INVAL, pccd.Rays, self.client, self.scene, 300,
                       radii=radii)
        odd = np.array([[2 ** 53 + 1, 0, 0]] * 3)
        for x in (odd, odd.tolist(), odd.astype(object), odd.astype(np.longdouble),
                  odd.astype(object) * Fraction(1, 5)):  # no double is the first
            self.fails(pccd.Status.E_INVAL, self.client.mesh_create, x, [[0, 1, 2]])
        self.client.mesh_create(odd - 1, [[0, 1, 2]])
        far = np.array([[1e18, 0, 0], [np.nextafter(1e18, 2e18), 0, 0], [0, 1, 0]])
        with self.assertRaisesRegex(pccd.PccdError, r"is 1\.0000000000000001e\+18, not"):
            self.client.mesh_create(far, [[0, 1, 2]])

    # If this failed, a ball or a player would be let into the hill, or held off it.
    def test_cast__spheres_and_capsules_keep_their_radius(self):
        rods = np.arange(300).reshape(-1, 2)
        begin, end = self.begin.copy(), self.end.copy()
        begin[:, 2] += 6
        begin[1::2], end[1::2] = begin[::2] + [0, 0, 1], end[::2] + [0, 0, 1]
        for given, count in (({}, 300), ({"rods": rods}, 150)):
            told = []
            for pieces in (1, 8):
                rays = pccd.Rays(self.client, self.scene, 300, radii=0.25, pieces=pieces,
                                 **given)
                told.append(rays.cast(begin, end))
                rays.close()
            one, eight = told
            self.assertEqual(len(one.t), count)
            self.assertGreater(np.isfinite(one.t).sum(), 20)
            np.testing.assert_allclose(one.t, eight.t, atol=1e-5)
            met = np.isfinite(one.t)
            self.assertTrue((eight.object[met] == self.level).all())
            if not given:
                thin = np.array([self.first(*ray)[0] for ray in zip(begin, end)])
                self.assertTrue((one.t <= thin + 1e-6).all())
                self.assertGreater((one.t < thin - 1e-3).sum(), 20)
                at = (begin + one.t[:, None] * (end - begin))[met & (one.t > 0)]
                near = np.linalg.norm(at[:, None] - self.x[None], axis=2).min(1)
                self.assertTrue((near >= 0.25 - 1e-5).all())
                np.testing.assert_allclose(one.point[met & (one.t > 0)], at, atol=1e-12)


if __name__ == "__main__":
    unittest.main()
