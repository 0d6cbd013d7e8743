#!/usr/bin/env python3
"""check_step.py FILE.step [MODEL.json]

What OpenCASCADE makes of a STEP file that `isophote convert` wrote: faces, whether BRepCheck_Analyzer calls the shape valid,
area, open edges; beside a model in the project's JSON, whether the control points, knots and weights of its surfaces are
those, bit for bit (not where a file is in another unit than mm). OpenCASCADE makes closed surfaces periodic: the others are compared
at 21 x 21 places of the same parameters, and the farthest is told, as a share of the surface's size. Exit status 1 where one is
farther than 1e-12, or has other degrees.
The figures of docs/export.md are its.
Needs cadquery-ocp==7.9.3.1.1.
"""
import collections, json, math, sys

import occ_common
from OCP.STEPControl import STEPControl_Reader
from OCP.IFSelect import IFSelect_RetDone
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRep import BRep_Tool
from OCP.GProp import GProp_GProps
from OCP.TopExp import TopExp_Explorer
from OCP.TopAbs import TopAbs_FACE, TopAbs_EDGE, TopAbs_SOLID
from OCP.TopoDS import TopoDS
from OCP.Geom import Geom_BSplineSurface, Geom_RectangularTrimmedSurface
from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape
from OCP.TopExp import TopExp
from OCP.Interface import Interface_Static
from OCP.gp import gp_Pnt

SIDE = 20
# farthest that counts as equal, as a share of the size
ENOUGH = 1e-12


def explore(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def numbers(surface):
    """Degrees, points, weights, knots of a B-spline surface, as a hashable tuple."""
    nu, nv = surface.NbUPoles(), surface.NbVPoles()
    points = tuple(c for i in range(1, nu + 1) for j in range(1, nv + 1)
                   for c in (lambda p: (p.X(), p.Y(), p.Z()))(surface.Pole(i, j)))
    rational = surface.IsURational() or surface.IsVRational()
    weights = tuple(surface.Weight(i, j) for i in range(1, nu + 1) for j in range(1, nv + 1)) if rational else None
    ku = tuple(surface.UKnot(k) for k in range(1, surface.NbUKnots() + 1) for _ in range(surface.UMultiplicity(k)))
    kv = tuple(surface.VKnot(k) for k in range(1, surface.NbVKnots() + 1) for _ in range(surface.VMultiplicity(k)))
    return (surface.UDegree(), surface.VDegree(), points, weights, ku, kv)


def expected(model):
    for face in model['faces']:
        s = model['surfaces'][face['surface']]
        weights = s['weights'] and tuple(s['weights'])
        if weights and len(set(weights)) == 1:
            weights = None
        points = tuple(float(c) for p in s['points'] for c in p)
        yield (*s['degree'], points, weights, tuple(map(float, s['knots_u'])), tuple(map(float, s['knots_v'])))


def apart(surface, ours):
    """How far a surface is from ours at the same parameters, as a share of its size; infinite for one of other degrees."""
    if surface is None or [surface.UDegree(), surface.VDegree()] != ours['degree']:
        return math.inf
    own = occ_common.to_occ_surface(ours)
    u0, u1, v0, v1 = own.Bounds()
    points = [gp_Pnt(*map(float, p)) for p in ours['points']]
    size = max(points[0].Distance(p) for p in points) or 1.0
    places = [(u0 + (u1 - u0) * i / SIDE, v0 + (v1 - v0) * j / SIDE) for i in range(SIDE + 1) for j in range(SIDE + 1)]
    return max(surface.Value(u, v).Distance(own.Value(u, v)) for u, v in places) / size


def main():
    Interface_Static.SetCVal_s('xstep.cascade.unit', 'MM')
    reader = STEPControl_Reader()
    assert reader.ReadFile(sys.argv[1]) == IFSelect_RetDone, 'not read'
    reader.TransferRoots()
    shape = reader.OneShape()
    faces = list(explore(shape, TopAbs_FACE))
    area, volume = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9)
    BRepGProp.VolumeProperties_s(shape, volume, 1e-9)
    uses = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, uses)
    shared = collections.Counter()
    for k in range(1, uses.Extent() + 1):
        if not BRep_Tool.Degenerated_s(TopoDS.Edge_s(uses.FindKey(k))):
            shared[uses.FindFromIndex(k).Extent()] += 1
    print(json.dumps({
        'faces': len(faces), 'solids': len(list(explore(shape, TopAbs_SOLID))), 'valid': BRepCheck_Analyzer(shape).IsValid(),
        'area': area.Mass(), 'volume': volume.Mass(), 'edges by faces': dict(sorted(shared.items())),
    }))
    if len(sys.argv) < 3:
        return
    model = json.load(open(sys.argv[2]))
    found, natives = [], []
    for face in faces:
        surface = BRep_Tool.Surface_s(TopoDS.Face_s(face))
        if isinstance(surface, Geom_RectangularTrimmedSurface):
            surface = surface.BasisSurface()
        is_spline = isinstance(surface, Geom_BSplineSurface)
        natives.append(surface if is_spline else None)
        found.append(numbers(surface) if is_spline else None)
    wanted = list(expected(model))
    same = [a == b for a, b in zip(found, wanted)]
    others = [k for k, is_same in enumerate(same) if not is_same]
    ours = [model['surfaces'][face['surface']] for face in model['faces']]
    off = [apart(natives[k], ours[k]) for k in others]
    periodic = sum(1 for k in others if natives[k] is not None and (natives[k].IsUPeriodic() or natives[k].IsVPeriodic()))
    print(json.dumps({'surfaces': len(wanted), 'bit for bit': sum(same), 'periodic': periodic, 'others': len(others) - periodic,
                      'farthest of those': max(off, default=0.0)}))
    sys.exit(len(found) != len(wanted) or max(off, default=0.0) > ENOUGH)


main()
