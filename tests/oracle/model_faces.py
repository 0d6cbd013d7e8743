#!/usr/bin/env python3
"""model_faces.py MODEL... [--isophote target/release/isophote] [--inches NAME,NAME]

Faces of whole model files (STEP, IGES), as this project reads them and as OpenCASCADE does, each by its own reader: degrees once all
is NURBS, rational or not, edges and holes; 20 x 20 places over the bounds of each of OpenCASCADE's faces, on its own surface, which
must lie on ours within the file's tolerance; and whether each is material, where it is farther from an edge than four tolerances.
OpenCASCADE answers by BRepTopAdaptor_FClass2d. Ours is the winding number of the loops that `convert` wrote (planar.py). Every file is read
in millimetres: those in inches are named by --inches. Exit status 1 if a place or a side differs. Counts that differ are printed:

    NIST_MBE_PMI_11.stp: 10 faces, 2 holes; places 3,920 (392 a face at least), farthest 0.004 tolerances; sides 3,911, 0 differ
"""
import argparse
import collections
import sys
from pathlib import Path

import numpy as np

import occ_common as oc
import planar
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.BRepTools import BRepTools
from OCP.BRepTopAdaptor import BRepTopAdaptor_FClass2d
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_IN, TopAbs_ON
from OCP.TopoDS import TopoDS
from OCP.gp import gp_Pnt, gp_Pnt2d

GRID = 20
# what files' digits leave, as a share of a face's size and of its distance from the origin
PRINTED = 1e-9, 1e-13


def counts(model, face):
    """what a face is, as both readers may count it: degrees, rational, edges, loops"""
    surface = model["surfaces"][face["surface"]]
    weights = surface["weights"]
    trims = [t for loop in face["loops"] for t in loop["trims"] if not t.get("degenerate")]
    holes = max(0, len(face["loops"]) - 1)
    return tuple(surface["degree"]), bool(weights) and len(set(weights)) > 1, len(trims), holes


class Face:
    """one face of ours: where a point in space lies on it, and whether that is material"""

    def __init__(self, model, face):
        surface = model["surfaces"][face["surface"]]
        self.geometry = oc.to_occ_surface(surface)
        self.analysis = ShapeAnalysis_Surface(self.geometry)
        ku, kv = surface["knots_u"], surface["knots_v"]
        (p, q), n, m = surface["degree"], surface["nu"], surface["nv"]
        self.box = [[ku[p], ku[n] - ku[p]], [kv[q], kv[m] - kv[q]]]
        self.loops = [loop for loop in face["loops"] if loop["trims"]]
        points = np.array(surface["points"])
        self.size = float(np.linalg.norm(points.max(0) - points.min(0)))
        self.far = float(np.abs(points).max())

    def nearest(self, point, enough):
        """parameters of the place of the whole surface nearest to a point, and how far it is"""
        uv = self.analysis.ValueOfUV(gp_Pnt(*point), enough)
        u, v = (min(max(x, a), a + s) for x, (a, s) in zip((uv.X(), uv.Y()), self.box))
        p = self.geometry.Value(u, v)
        return (u, v), float(np.linalg.norm(np.array([p.X(), p.Y(), p.Z()]) - point))

    def sides(self, uv):
        """whether places are material, and how far they are from an edge, in shares of the domain"""
        if not self.loops:
            return np.ones(len(uv), bool), np.full(len(uv), np.inf)
        segments, degree, _ = planar.segments(self.loops, self.box)
        share = (np.array(uv) - [a for a, _ in self.box]) / [s for _, s in self.box]
        winding, distance = planar.classify(segments, degree, np.ascontiguousarray(share))
        return winding != 0, distance


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("--isophote", default="target/release/isophote")
    parser.add_argument("--inches", default="")
    parser.add_argument("--moved", type=float, default=0.0, help="moves ours by so many tolerances: what must be seen to differ")
    asked = parser.parse_args()
    wrong = 0
    for path in asked.models:
        ours = oc.converted(path, asked.isophote)
        scale = 25.4 if path.name in asked.inches.split(",") else 1.0
        shape = oc.load_shape(str(path))
        theirs = oc.shape_to_neutral(shape)
        natives = oc.faces_of(shape)
        say = lambda *words: print(" ", path.name, *words, flush=True)
        if not len(ours["faces"]) == len(natives) == len(theirs["faces"]):
            say(f"{len(ours['faces'])} faces for {len(natives)}")
            wrong += 1
            continue
        places = sides = differ = 0
        least, farthest = GRID * GRID, 0.0
        unlike = collections.Counter()
        for k, native in enumerate(natives):
            a, b = counts(ours, ours["faces"][k]), counts(theirs, theirs["faces"][k])
            for what, x, y in zip(("degrees", "rational", "edges", "holes"), a, b):
                if x != y:
                    unlike[f"{what} {x} for {y}"] += 1
            face = Face(ours, ours["faces"][k])
            tolerance = max(ours["faces"][k]["tolerance"], PRINTED[0] * face.size, PRINTED[1] * face.far)
            forward = TopoDS.Face_s(native.Oriented(TopAbs_FORWARD))
            surface = BRep_Tool.Surface_s(forward)
            classifier = BRepTopAdaptor_FClass2d(forward, 1e-9)
            u0, u1, v0, v1 = BRepTools.UVBounds_s(forward)
            rows = []
            for i in range(GRID * GRID):
                u = u0 + (u1 - u0) * (i // GRID + 0.37) / GRID
                v = v0 + (v1 - v0) * (i % GRID + 0.41) / GRID
                p = surface.Value(u, v)
                point = np.array([p.X(), p.Y(), p.Z()]) / scale + asked.moved * tolerance
                state = classifier.Perform(gp_Pnt2d(u, v))
                if state != TopAbs_ON:
                    rows.append((point, state == TopAbs_IN))
            found = [face.nearest(point, 0.1 * tolerance) for point, _ in rows]
            material, distance = face.sides([uv for uv, _ in found])
            asked_here = 0
            for (point, inside), ((u, v), off), is_material, away in zip(rows, found, material, distance):
                is_ours = bool(is_material) and off <= 2 * tolerance
                if inside:
                    places += 1
                    if is_ours:
                        farthest = max(farthest, off / tolerance)
                # How far an edge is in space: at least the least speed of the surface there times the distance in the domain.
                d1u, d1v = (face.geometry.DN(u, v, *n) for n in ((1, 0), (0, 1)))
                speed = min(d1u.Magnitude() * face.box[0][1], d1v.Magnitude() * face.box[1][1])
                if off <= 2 * tolerance and away * speed <= 4 * tolerance:
                    continue
                sides += 1
                asked_here += 1
                if inside != is_ours:
                    differ += 1
                    if differ <= 8:
                        say(f"face {k}: inside {inside}, ours {is_ours} at {u:.6g}, {v:.6g}, {off:.1e} away, edge {away:.1e}")
            least = min(least, asked_here)
        for what, count in sorted(unlike.items()):
            say(f"{count} faces: {what}")
        holes = sum(max(0, len(face["loops"]) - 1) for face in ours["faces"])
        print(
            f"{path.name}: {len(natives)} faces, {holes} holes; places {places:,}, farthest {farthest:.2g} tolerances; "
            f"sides {sides:,} ({least} a face at least), {differ} differ",
            flush=True,
        )
        wrong += differ + (farthest > 1.0)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
