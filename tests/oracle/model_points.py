#!/usr/bin/env python3
"""model_points.py FILE... [--random N] [--isophote target/release/isophote]

Faces of .bpt, free-form .obj and .3dm files, as this project reads them (`convert` to JSON, evaluated by OpenCASCADE), against
those of a reader here that shares nothing with it: .bpt by Bernstein's polynomials and .obj by de Boor's recurrence, both in
rational numbers, of the numbers of the file; .3dm by rhino3dm's own evaluation. Compared are the faces' number, degrees, holes, and
20 x 20 places over each domain: at the same (u, v), or, where rhino3dm has other parameters than NURBS have, by the distance from
our surface. `--random N` adds N seeded surfaces of each format. Exit status 1 if something differs:

    teapot.bpt: 32 faces, 12,800 places, farthest 3.1e-16 of the size
"""
import argparse
import random
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import rhino3dm

import occ_common as oc
from OCP.gp import gp_Pnt
from OCP.ShapeAnalysis import ShapeAnalysis_Surface

SIDE = 20
# farthest that counts as equal, as a share of the face's size and distance from the origin
ENOUGH = 1e-12


def basis(knots, degree, t):
    """all basis functions of a knot vector at t, by their recurrence; the last knot of the domain belongs to the span before it"""
    n = len(knots) - degree - 1
    spans = [k for k in range(degree, n) if knots[k] <= t < knots[k + 1]] or [k for k in range(degree, n) if knots[k] < knots[k + 1]][-1:]
    row = [Fraction(int(k == spans[0])) for k in range(len(knots) - 1)]
    for p in range(1, degree + 1):
        part = lambda k, a, b, s: Fraction(0) if a == b else s / (b - a) * row[k]
        row = [part(k, knots[k], knots[k + p], t - knots[k]) + part(k + 1, knots[k + 1], knots[k + p + 1], knots[k + p + 1] - t)
               for k in range(len(row) - 1)]
    return row[:n]


class Patch:
    """a surface of numbers of a file: net[i][j] = (x, y, z, w), i along u"""

    def __init__(self, degree, knots, net, domain, holes=0):
        self.degree, self.knots, self.net, self.domain, self.holes = degree, knots, net, domain, holes
        flat = [c for row in net for p in row for c in p[:3]]
        self.size = float(max(flat) - min(flat)) + 1e-13 * float(max(map(abs, flat)))

    def points(self):
        shares = [[a + (b - a) * Fraction(k, SIDE - 1) for k in range(SIDE)] for a, b in self.domain]
        rows = [[basis(self.knots[d], self.degree[d], t) for t in shares[d]] for d in (0, 1)]
        for s, a in zip(shares[0], rows[0]):
            for t, b in zip(shares[1], rows[1]):
                total = [Fraction(0)] * 4
                for i, f in enumerate(a):
                    for j, g in enumerate(b):
                        if f and g:
                            x, y, z, w = self.net[i][j]
                            total = [c + f * g * w * d for c, d in zip(total, (x, y, z, 1))]
                yield (float(s), float(t)), [float(c / total[3]) for c in total[:3]]


def clamped(degree, breaks):
    return [breaks[0]] + [t for t in breaks for _ in range(degree)] + [breaks[-1]]


def bpt(path):
    """patches of Newell's format: lists of indices, or degrees and points"""
    lines = [line.replace(",", " ").split() for line in path.read_text().splitlines() if line.strip()]
    count = int(lines[0][0])
    number = lambda words: [Fraction(word) for word in words]
    if len(lines[1]) == 2:
        at, nets = 1, []
        for _ in range(count):
            p, q = map(int, lines[at])
            points = [number(line) for line in lines[at + 1:at + 1 + (p + 1) * (q + 1)]]
            nets.append([points[i * (q + 1):(i + 1) * (q + 1)] for i in range(p + 1)])
            at += 1 + (p + 1) * (q + 1)
    else:
        points = [number(line) for line in lines[count + 2:]]
        nets = [[[points[int(k) - 1] for k in line[4 * i:4 * i + 4]] for i in range(4)] for line in lines[1:count + 1]]
    for net in nets:
        degree = [len(net) - 1, len(net[0]) - 1]
        yield Patch(degree, [clamped(p, [Fraction(0), Fraction(1)]) for p in degree], [[p + [Fraction(1)] for p in row] for row in net], [[0, 1]] * 2)


def obj(path):
    """surfaces of cstype bezier and bspline; others are not looked at"""
    text = path.read_text().replace("\\\n", " ")
    vertices, element = [], None
    kind = is_rational = None
    degree = []
    for line in text.splitlines():
        key, *words = line.split("#")[0].split() or [""]
        if key == "v":
            numbers = [Fraction(w) for w in words]
            vertices.append(numbers[:3] + [numbers[3] if len(numbers) == 4 else Fraction(1)])
        elif key == "cstype":
            is_rational = words[0] == "rat"
            kind = words[-1]
        elif key == "deg":
            degree = [int(w) for w in words]
        elif key in ("surf", "curv2", "curv"):
            element = (key, words, {}, [])
        elif key == "parm":
            element[2][words[0]] = [Fraction(w) for w in words[1:]]
        elif key in ("trim", "hole"):
            element[3].append(key)
        elif key == "end":
            what, words, parm, loops = element
            if what != "surf" or kind not in ("bezier", "bspline"):
                continue
            knots = [parm[d] if kind == "bspline" else clamped(p, parm[d]) for d, p in zip("uv", degree)]
            nu, nv = (len(k) - p - 1 for k, p in zip(knots, degree))
            numbers = [int(w.split("/")[0]) for w in words[4:]]
            points = [vertices[n - 1 if n > 0 else len(vertices) + n] for n in numbers]
            points = [p if is_rational else p[:3] + [Fraction(1)] for p in points]
            domain = [[k[p], k[-p - 1]] for k, p in zip(knots, degree)]
            yield Patch(degree, knots, [[points[j * nu + i] for j in range(nv)] for i in range(nu)], domain, loops.count("hole"))


class Rhino:
    """a face by rhino3dm"""

    # rhino3dm does not tell a brep's loops
    holes = None

    def __init__(self, surface, model):
        # the model, whose memory the surface is in
        self.surface, self.model = surface, model
        nurbs = surface.ToNurbsSurface()
        self.degree = [nurbs.Degree(0), nurbs.Degree(1)]
        ends = lambda d: (d.T0, d.T1)
        self.domain = [ends(surface.Domain(0)), ends(surface.Domain(1))]
        found = [p for _, p in self.points()]
        self.size = float(np.ptp(found)) + 1e-13 * float(np.abs(found).max())

    def points(self):
        (a, b), (c, d) = self.domain
        for i in range(SIDE):
            for j in range(SIDE):
                # at the end of an unclamped domain rhino3dm answers the origin
                s, t = a + (b - a) * ((i + 0.37) / SIDE), c + (d - c) * ((j + 0.41) / SIDE)
                p = self.surface.PointAt(s, t)
                yield (s, t), [p.X, p.Y, p.Z]


def rhino(path):
    """breps and surfaces that are shown, in the file's order; extrusions and blocks are asked by make_3dm.py and its test"""
    model = rhino3dm.File3dm.Read(str(path))
    for item in model.Objects:
        shape = item.Geometry
        if item.Attributes.Mode != rhino3dm.ObjectMode.Normal:
            continue
        if isinstance(shape, rhino3dm.Brep):
            for k in range(len(shape.Faces)):
                yield Rhino(shape.Faces[k].UnderlyingSurface(), (model, shape))
        elif isinstance(shape, rhino3dm.Surface):
            yield Rhino(shape, (model, shape))


def compare(path, isophote, moved):
    ours = oc.converted(path, isophote)
    theirs = list({".bpt": bpt, ".obj": obj, ".3dm": rhino}[path.suffix](path))
    wrong = []
    if len(ours["faces"]) != len(theirs):
        wrong.append(f"{len(ours['faces'])} faces for {len(theirs)}")
    farthest = places = 0
    for k, (face, own) in enumerate(zip(ours["faces"], theirs)):
        surface = ours["surfaces"][face["surface"]]
        if surface["degree"] != list(own.degree):
            wrong.append(f"face {k}: degrees {surface['degree']} for {own.degree}")
        holes = sum(not loop["outer"] for loop in face["loops"])
        if own.holes is not None and holes != own.holes:
            wrong.append(f"face {k}: {holes} holes for {own.holes}")
        geometry = oc.to_occ_surface(surface)
        nearest = ShapeAnalysis_Surface(geometry)
        for (u, v), point in own.points():
            p = geometry.Value(u, v)
            point = [c + moved * own.size for c in point]
            off = float(np.linalg.norm(np.array([p.X(), p.Y(), p.Z()]) - point)) / own.size
            if off > ENOUGH and path.suffix == ".3dm":
                uv = nearest.ValueOfUV(gp_Pnt(*point), 1e-14 * own.size)
                off = geometry.Value(uv.X(), uv.Y()).Distance(gp_Pnt(*point)) / own.size
            places += 1
            farthest = max(farthest, off)
    if farthest > ENOUGH:
        wrong.append(f"farthest {farthest:.1e}")
    for text in wrong:
        print(" ", path.name, text)
    print(f"{path.name}: {len(theirs)} faces, {places:,} places, farthest {farthest:.1e} of the size", flush=True)
    return len(wrong)


def random_files(count, folder):
    """seeded surfaces: unclamped knots, multiple ones, weights of 1e-2 to 1e2, degrees 1 to 9"""
    dice = random.Random(12)
    knots = lambda p, n: sorted(dice.choice([dice.uniform(0, 9), float(dice.randrange(9))]) for _ in range(n + p + 1))
    surfaces = []
    while len(surfaces) < count:
        p, q = dice.randint(1, 9), dice.randint(1, 9)
        nu, nv = p + 1 + dice.randint(0, 4), q + 1 + dice.randint(0, 4)
        u, v = knots(p, nu), knots(q, nv)
        legal = lambda k, d, n: k[d] < k[n] and all(k[i] < k[i + d] for i in range(len(k) - d)) and min([b - a for a, b in zip(k, k[1:]) if a < b]) > 1e-3
        if legal(u, p, nu) and legal(v, q, nv):
            net = [[dice.uniform(-5, 5), dice.uniform(-5, 5), dice.uniform(-5, 5), 10 ** dice.uniform(-2, 2)] for _ in range(nu * nv)]
            surfaces.append((p, q, u, v, net))
    text, first = [], 1
    for p, q, u, v, net in surfaces:
        nu = len(u) - p - 1
        text += [f"v {x!r} {y!r} {z!r} {w!r}" for x, y, z, w in net] + ["cstype rat bspline", f"deg {p} {q}"]
        text += [f"surf {u[p]!r} {u[-p - 1]!r} {v[q]!r} {v[-q - 1]!r} " + " ".join(str(k - len(net)) for k in range(len(net)))]
        text += ["parm u " + " ".join(map(repr, u)), "parm v " + " ".join(map(repr, v)), "end"]
    (folder / "random.obj").write_text("\n".join(text) + "\n")
    text = [str(count)]
    for p, q, _, _, net in surfaces:
        text += [f"{p} {q}"] + [" ".join(map(repr, point[:3])) for point in net[:(p + 1) * (q + 1)]]
    (folder / "random.bpt").write_text("\n".join(text) + "\n")
    model = rhino3dm.File3dm()
    for p, q, u, v, net in surfaces:
        nu, nv = len(u) - p - 1, len(v) - q - 1
        surface = rhino3dm.NurbsSurface.Create(3, True, p + 1, q + 1, nu, nv)
        for i in range(nu):
            for j in range(nv):
                x, y, z, w = net[i * nv + j]
                surface.Points[i, j] = rhino3dm.Point4d(x * w, y * w, z * w, w)
        for k, t in enumerate(u[1:-1]):
            surface.KnotsU[k] = t
        for k, t in enumerate(v[1:-1]):
            surface.KnotsV[k] = t
        model.Objects.AddSurface(surface)
    for version in (4, 5, 7, 8):
        model.Write(str(folder / f"random-{version}.3dm"), version)
    return sorted(folder.iterdir())


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--random", type=int, default=0)
    parser.add_argument("--isophote", default="target/release/isophote")
    parser.add_argument("--moved", type=float, default=0.0, help="moves theirs by that share of the size: what must be seen to differ")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = asked.files + (random_files(asked.random, Path(folder)) if asked.random else [])
        sys.exit(sum(compare(path, asked.isophote, asked.moved) for path in files) > 0)


if __name__ == "__main__":
    main()
