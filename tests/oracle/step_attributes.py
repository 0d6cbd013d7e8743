#!/usr/bin/env python3
"""Names, colours and visibility in a STEP file that OpenCASCADE writes, and what its own reader then says of each face.

    python3 -m venv V && V/bin/pip install cadquery==2.8.0 cadquery-ocp==7.9.3.1.1
    V/bin/python tests/oracle/step_attributes.py testdata/step

Writes attributes.step and attributes.json: for each visible face the centre of its area, its colour in sRGB and its name.
"""
import json
import sys
from pathlib import Path

from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.GProp import GProp_GProps
from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.IFSelect import IFSelect_RetDone
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_ColorTool, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool


def document():
    doc = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    XCAFApp_Application.GetApplication_s().NewDocument(TCollection_ExtendedString("BinXCAF"), doc)
    return doc


def colour(r, g, b):
    return Quantity_Color(r / 255, g / 255, b / 255, Quantity_TOC_sRGB)


def name(label, text):
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(text, True))


def faces(shape):
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face_s(explorer.Current())
        explorer.Next()


def centre(face):
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties)
    point = properties.CentreOfMass()
    return [round(x, 9) + 0.0 for x in (point.X(), point.Y(), point.Z())]


def write(path):
    doc = document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(doc.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(doc.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(doc.Main())

    # A whole: coloured, with a face of another colour and a name of its own, and another face in a named colour.
    body = BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 1, 2, 3).Shape()
    part = shapes.AddShape(body, False)
    name(part, "Träger")
    colours.SetColor(part, colour(200, 100, 50), XCAFDoc_ColorSurf)
    own = list(faces(body))
    for face, (text, rgb) in zip(own, [("Auflage 面", (10, 20, 30)), ("", (255, 0, 0))]):
        label = shapes.AddSubShape(part, face)
        if text:
            name(label, text)
        colours.SetColor(label, colour(*rgb), XCAFDoc_ColorSurf)

    # One without a colour.
    plain = shapes.AddShape(BRepPrimAPI_MakeBox(gp_Pnt(10, 0, 0), 1, 1, 1).Shape(), False)
    name(plain, "plain")

    # An assembly of one part, twice.
    brick = shapes.AddShape(BRepPrimAPI_MakeBox(gp_Pnt(0, 0, 0), 1, 1, 1).Shape(), False)
    name(brick, "brick")
    colours.SetColor(brick, colour(0, 128, 255), XCAFDoc_ColorSurf)
    wall = shapes.NewShape()
    name(wall, "wall")
    for x in (20, 30):
        move = gp_Trsf()
        move.SetTranslation(gp_Vec(x, 0, 0))
        shapes.AddComponent(wall, brick, TopLoc_Location(move))

    # Two that are not shown: one by itself, one by its layer.
    ghost = shapes.AddShape(BRepPrimAPI_MakeBox(gp_Pnt(40, 0, 0), 1, 1, 1).Shape(), False)
    name(ghost, "ghost")
    colours.SetVisibility(ghost, False)
    aside = shapes.AddShape(BRepPrimAPI_MakeBox(gp_Pnt(50, 0, 0), 1, 1, 1).Shape(), False)
    name(aside, "aside")
    layer = layers.AddLayer(TCollection_ExtendedString("construction"))
    layers.SetLayer(aside, layer)
    layers.SetVisibility(layer, False)
    shapes.UpdateAssemblies()

    writer = STEPCAFControl_Writer()
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    writer.SetLayerMode(True)
    assert writer.Transfer(doc, STEPControl_AsIs)
    assert writer.Write(str(path)) == IFSelect_RetDone


def text_of(label):
    attribute = TDataStd_Name()
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return ""
    label.FindAttribute(TDataStd_Name.GetID_s(), attribute)
    return attribute.Get().ToExtString()


def read(path):
    """Every face that is visible to OpenCASCADE's own reader: a face's colour and name, else those of its part."""
    doc = document()
    reader = STEPCAFControl_Reader()
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    reader.SetLayerMode(True)
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    assert reader.Transfer(doc)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(doc.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(doc.Main())
    layers = XCAFDoc_DocumentTool.LayerTool_s(doc.Main())

    def is_visible(label):
        of = TDF_LabelSequence()
        layers.GetLayers(label, of)
        return XCAFDoc_ColorTool.IsVisible_s(label) and all(layers.IsVisible(of.Value(i)) for i in range(1, of.Length() + 1))

    def colour_of(label):
        found = Quantity_Color()
        if not XCAFDoc_ColorTool.GetColor_s(label, XCAFDoc_ColorSurf, found):
            return None
        parts = found.Values(Quantity_TOC_sRGB)
        return [round(255 * part) for part in parts]

    rows = []

    def part(label, location):
        if not is_visible(label):
            return
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            components = TDF_LabelSequence()
            XCAFDoc_ShapeTool.GetComponents_s(label, components)
            for i in range(1, components.Length() + 1):
                component, referred = components.Value(i), TDF_Label()
                XCAFDoc_ShapeTool.GetReferredShape_s(component, referred)
                part(referred, location.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(component)))
            return
        for face in faces(XCAFDoc_ShapeTool.GetShape_s(label)):
            own = TDF_Label()
            has_own = shapes.FindSubShape(label, face, own)
            rows.append({
                "centre": centre(face.Moved(location)),
                "colour": (colour_of(own) if has_own else None) or colour_of(label),
                "name": (text_of(own) if has_own else "") or text_of(label),
            })

    roots = TDF_LabelSequence()
    shapes.GetFreeShapes(roots)
    for i in range(1, roots.Length() + 1):
        part(roots.Value(i), TopLoc_Location())
    return rows


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write(folder / "attributes.step")
    rows = read(folder / "attributes.step")
    (folder / "attributes.json").write_text("[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n")
