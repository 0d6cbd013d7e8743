#!/usr/bin/env python3
"""iges_solids.py OUTDIR [--seed 1] [--count 40]

The random solids of step_solids.py as IGES: as a solid (NAME_b.igs: 186, 514, 510, 508) and as trimmed surfaces (NAME_f.igs: 144),
their area and volume (OUTDIR/solids.json), and the faces of each file as OpenCASCADE reads them back (NAME_b.json, NAME_f.json,
the neutral format of occ_common.py). `formats` reads them: crates/formats/tests/iges/solids.rs.
Needs cadquery-ocp==7.9.3.1.1.
"""
import argparse, json, os, random
import occ_common
from step_solids import solids, count
from OCP.GProp import GProp_GProps
from OCP.BRepGProp import BRepGProp
from OCP.IGESControl import IGESControl_Writer, IGESControl_Controller
from OCP.Interface import Interface_Static


def main():
    ap = argparse.ArgumentParser(usage=__doc__); ap.add_argument('out'); ap.add_argument('--seed', type=int, default=1)
    ap.add_argument('--count', type=int, default=40); a = ap.parse_args()
    os.makedirs(a.out, exist_ok=True); rows = []
    IGESControl_Controller.Init_s()
    # Lengths of the file are read as they stand; a name of the author is no part of a test's data.
    for key in ('write.iges.header.author', 'write.iges.header.company'):
        Interface_Static.SetCVal_s(key, 'isophote')
    for shape, area, volume in solids(random.Random(a.seed)):
        if len(rows) == a.count:
            break
        name, sound = f'solid_{a.seed}_{len(rows)}', True
        for mode, suffix in ((1, 'b'), (0, 'f')):
            path = os.path.join(a.out, f'{name}_{suffix}')
            writer = IGESControl_Writer('MM', mode)
            writer.AddShape(shape); writer.ComputeModel(); writer.Write(path + '.igs')
            again, found = occ_common.load_shape(path + '.igs'), GProp_GProps()
            BRepGProp.SurfaceProperties_s(again, found, 1e-11)
            # Some files OpenCASCADE does not read back itself.
            sound = sound and count(again) == count(shape) and abs(found.Mass() / area - 1) < 1e-4
            occ_common.dump(occ_common.shape_to_neutral(again, name), path + '.json')
        if sound:
            rows.append(dict(name=name, faces=count(shape), area=area, volume=volume))
    json.dump(rows, open(os.path.join(a.out, 'solids.json'), 'w'), indent=1)


if __name__ == '__main__': main()
