#!/usr/bin/env python3
"""step_solids.py OUTDIR [--seed 1] [--count 40]

Random solids by OpenCASCADE (boxes, cylinders, cones, spheres, tori, revolved splines; cut, fused, filleted, chamfered,
turned and moved), written as STEP with (u, v) curves (NAME_p.step) and without (NAME_n.step), and their area and volume
(OUTDIR/solids.json). `formats` reads them: crates/formats/tests/step/solids.rs.
Needs cadquery-ocp==7.9.3.1.1.
"""
import argparse, itertools, json, math, os, random
from OCP.gp import gp_Pnt, gp_Dir, gp_Ax1, gp_Ax2, gp_Trsf, gp_Vec
from OCP.BRepPrimAPI import (BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere,
                             BRepPrimAPI_MakeTorus, BRepPrimAPI_MakeRevol, BRepPrimAPI_MakePrism)
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse, BRepAlgoAPI_Common
from OCP.BRepBuilderAPI import (BRepBuilderAPI_Transform, BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire,
                                BRepBuilderAPI_MakeFace)
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet, BRepFilletAPI_MakeChamfer
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.TColgp import TColgp_HArray1OfPnt
from OCP.TopExp import TopExp_Explorer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopoDS import TopoDS
from OCP.GProp import GProp_GProps
from OCP.BRepGProp import BRepGProp
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.STEPControl import STEPControl_Writer, STEPControl_AsIs
from OCP.Interface import Interface_Static


def primitive(r):
    kind = r.choice(['box', 'cylinder', 'cone', 'sphere', 'torus', 'spline', 'part'])
    a, b, c = (r.uniform(1, 4) for _ in range(3))
    if kind == 'box':
        return BRepPrimAPI_MakeBox(gp_Pnt(-a / 2, -b / 2, -c / 2), a, b, c).Shape()
    if kind == 'cylinder':
        return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, -c / 2), gp_Dir(0, 0, 1)), a / 2, c).Shape()
    if kind == 'cone':
        return BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, -c / 2), gp_Dir(0, 0, 1)), a / 2, r.choice([0, b / 4]), c).Shape()
    if kind == 'sphere':
        return BRepPrimAPI_MakeSphere(a / 2).Shape()
    if kind == 'torus':
        return BRepPrimAPI_MakeTorus(a, a * r.uniform(.2, .7)).Shape()
    if kind == 'part':
        return BRepPrimAPI_MakeSphere(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), a / 2, -1.0, 1.2, r.uniform(1, 5)).Shape()
    points = TColgp_HArray1OfPnt(1, 5)
    for k in range(5):
        points.SetValue(k + 1, gp_Pnt(r.uniform(.6, 1.6), 0, (k - 2) * c / 4))
    curve = GeomAPI_Interpolate(points, False, 1e-9); curve.Perform()
    top, bottom = gp_Pnt(0, 0, c / 2), gp_Pnt(0, 0, -c / 2)
    edges = [BRepBuilderAPI_MakeEdge(curve.Curve()).Edge(), BRepBuilderAPI_MakeEdge(points.Value(5), top).Edge(),
             BRepBuilderAPI_MakeEdge(top, bottom).Edge(), BRepBuilderAPI_MakeEdge(bottom, points.Value(1)).Edge()]
    wire = BRepBuilderAPI_MakeWire(*edges).Wire()
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire).Face(), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()


def placed(shape, r, reach):
    move, turn = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(*[r.uniform(-1, 1) for _ in range(3)])), r.uniform(0, 2 * math.pi))
    move.SetTranslation(gp_Vec(*[r.uniform(-reach, reach) for _ in range(3)]))
    return BRepBuilderAPI_Transform(shape, move.Multiplied(turn), True).Shape()


def solid(r):
    shape = primitive(r)
    for _ in range(r.randrange(3)):
        tool = placed(primitive(r), r, 1.0)
        operation = r.choice([BRepAlgoAPI_Cut, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse, BRepAlgoAPI_Common])
        done = operation(shape, tool)
        if done.IsDone():
            shape = done.Shape()
    if r.random() < .5:
        edges = []
        e = TopExp_Explorer(shape, TopAbs_EDGE)
        while e.More():
            edges.append(TopoDS.Edge_s(e.Current())); e.Next()
        if edges:
            maker = r.choice([BRepFilletAPI_MakeFillet, BRepFilletAPI_MakeChamfer])(shape)
            maker.Add(r.uniform(.02, .1), r.choice(edges))
            try:
                maker.Build()
                if maker.IsDone():
                    shape = maker.Shape()
            except Exception:
                pass
    return placed(shape, r, 20.0)


def count(shape):
    n, e = 0, TopExp_Explorer(shape, TopAbs_FACE)
    while e.More():
        n += 1; e.Next()
    return n


def solids(r):
    """valid solids with area and volume, one after the other"""
    while True:
        try:
            shape = solid(r)
        except Exception:
            continue
        if not BRepCheck_Analyzer(shape).IsValid():
            continue
        area, volume = GProp_GProps(), GProp_GProps()
        BRepGProp.SurfaceProperties_s(shape, area, 1e-11); BRepGProp.VolumeProperties_s(shape, volume, 1e-11)
        if 1e-3 < volume.Mass():
            yield shape, area.Mass(), volume.Mass()


def main():
    ap = argparse.ArgumentParser(usage=__doc__); ap.add_argument('out'); ap.add_argument('--seed', type=int, default=1)
    ap.add_argument('--count', type=int, default=40); a = ap.parse_args()
    os.makedirs(a.out, exist_ok=True); rows = []
    for shape, area, volume in itertools.islice(solids(random.Random(a.seed)), a.count):
        name = f'solid_{a.seed}_{len(rows)}'
        for mode, suffix in ((1, 'p'), (0, 'n')):
            writer = STEPControl_Writer(); Interface_Static.SetIVal_s('write.surfacecurve.mode', mode)
            writer.Transfer(shape, STEPControl_AsIs); writer.Write(os.path.join(a.out, f'{name}_{suffix}.step'))
        rows.append(dict(name=name, faces=count(shape), area=area, volume=volume))
    json.dump(rows, open(os.path.join(a.out, 'solids.json'), 'w'), indent=1)


if __name__ == '__main__': main()
