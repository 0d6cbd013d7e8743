#!/usr/bin/env python3
"""Layers in a STEP file that OpenCASCADE writes, and what its own reader then says of each face.

    V/bin/python tests/oracle/step_layers.py testdata/step

Writes layers.step and layers.json: for each face the centre of its area, and the layers of the face, else those of its part.
"""
import json
import sys
from pathlib import Path

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_Label, TDF_LabelSequence
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from step_attributes import centre, document, faces, text_of


def write(path):
    doc = document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(doc.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(doc.Main())

    def put(label, *names):
        for text in names:
            layers.SetLayer(label, layers.AddLayer(TCollection_ExtendedString(text, True)))

    def box(x, *names):
        body = BRepPrimAPI_MakeBox(gp_Pnt(x, 0, 0), 1, 2, 3).Shape()
        label = shapes.AddShape(body, False)
        put(label, *names)
        return body, label

    # A whole on a layer with a face on another one, a whole on two layers, and one on none.
    body, label = box(0, "Gehäuse außen")
    put(shapes.AddSubShape(label, next(faces(body))), "seals, tight")
    box(10, "Gehäuse außen", "42")
    box(20)
    writer = STEPCAFControl_Writer()
    writer.SetLayerMode(True)
    assert writer.Transfer(doc, STEPControl_AsIs)
    assert writer.Write(str(path)) == IFSelect_RetDone


def read(path):
    doc = document()
    reader = STEPCAFControl_Reader()
    reader.SetLayerMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    assert reader.Transfer(doc)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(doc.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(doc.Main())

    def of(label):
        found = TDF_LabelSequence()
        layers.GetLayers(label, found)
        return sorted(text_of(found.Value(i)) for i in range(1, found.Length() + 1))

    rows, roots = [], TDF_LabelSequence()
    shapes.GetFreeShapes(roots)
    for i in range(1, roots.Length() + 1):
        label = roots.Value(i)
        for face in faces(XCAFDoc_ShapeTool.GetShape_s(label)):
            own = TDF_Label()
            has_own = shapes.FindSubShape(label, face, own)
            rows.append({"centre": centre(face.Moved(TopLoc_Location())), "layers": (of(own) if has_own else []) or of(label)})
    return rows


folder = Path(sys.argv[1])
write(folder / "layers.step")
rows = read(folder / "layers.step")
(folder / "layers.json").write_text("[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n")
