#!/usr/bin/env python3
"""An IGES file with names and colours, as OpenCASCADE writes it.

    V/bin/python tests/oracle/iges_looks.py testdata/iges

Writes looks.igs: a block of one colour with a face (x = 0) of another, and a yellow pin, each with a name.
"""
import sys
from pathlib import Path

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.IGESCAFControl import IGESCAFControl_Writer
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

doc = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
XCAFApp_Application.GetApplication_s().NewDocument(TCollection_ExtendedString("BinXCAF"), doc)
shapes, colours = XCAFDoc_DocumentTool.ShapeTool_s(doc.Main()), XCAFDoc_DocumentTool.ColorTool_s(doc.Main())


def add(shape, name, rgb):
    label = shapes.AddShape(shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))
    paint(label, rgb)
    return label


def paint(label, rgb):
    colours.SetColor(label, Quantity_Color(*(c / 255 for c in rgb), Quantity_TOC_sRGB), XCAFDoc_ColorSurf)


block = BRepPrimAPI_MakeBox(2.0, 3.0, 4.0).Shape()
label = add(block, "block", (90, 120, 200))
paint(shapes.AddSubShape(label, TopExp_Explorer(block, TopAbs_FACE).Current()), (200, 30, 60))
add(BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(9, 0, 0), gp_Dir(0, 0, 1)), 1.0, 5.0).Shape(), "pin", (255, 255, 0))
writer = IGESCAFControl_Writer()
Interface_Static.SetIVal_s("write.iges.brep.mode", 1)
writer.SetColorMode(True)
writer.SetNameMode(True)
writer.Transfer(doc)
writer.Write(str(Path(sys.argv[1]) / "looks.igs"))
