#!/usr/bin/env python3
"""make_3dm_colours.py OUTDIR: spheres in colours of their own, of their layer, of a reference's; and what each is to be.

Writes colours-3.3dm, -4, -5, -8 and colours.json: for each face in order its object's name and its colour in sRGB, which
is None where no material says it. Needs rhino3dm 8.35.
"""
import json
import sys
from pathlib import Path

import rhino3dm as r

LAYER, OWN, MATERIAL, PARENT = (
    r.ObjectColorSource.ColorFromLayer,
    r.ObjectColorSource.ColorFromObject,
    r.ObjectColorSource.ColorFromMaterial,
    r.ObjectColorSource.ColorFromParent,
)

model = r.File3dm()
for name, colour in [("steel", (171, 205, 239)), ("brass", (18, 52, 86)), ("glass", (90, 80, 70))]:
    material = r.Material()
    material.Name, material.DiffuseColor = name, (*colour, 255)
    model.Materials.Add(material)
BY_LAYER, BY_OBJECT, BY_PARENT = (
    r.ObjectMaterialSource.MaterialFromLayer,
    r.ObjectMaterialSource.MaterialFromObject,
    r.ObjectMaterialSource.MaterialFromParent,
)
layer = r.Layer()
layer.Name = "walls"
layer.Color = (200, 100, 50, 255)
layer.RenderMaterialIndex = 1
layer_index = model.Layers.Add(layer)
rows = []


def attributes(name, source, colour=(1, 2, 3), material=(BY_LAYER, -1)):
    made = r.ObjectAttributes()
    made.MaterialSource, made.MaterialIndex = material
    made.Name, made.LayerIndex, made.ColorSource, made.ObjectColor = name, layer_index, source, (*colour, 255)
    return made


def sphere(x):
    return r.Sphere(r.Point3d(x, 0, 0), 1.0).ToBrep()


for x, (name, source, material, expected) in enumerate([
    ("by layer", LAYER, (BY_OBJECT, 0), [200, 100, 50]),
    ("by itself", OWN, (BY_OBJECT, 0), [10, 20, 30]),
    ("by material", MATERIAL, (BY_OBJECT, 2), [90, 80, 70]),
    ("by its layer's material", MATERIAL, (BY_LAYER, 0), [18, 52, 86]),
    ("by no material", MATERIAL, (BY_OBJECT, -1), None),
    ("by parent, without one", PARENT, (BY_LAYER, -1), [200, 100, 50]),
]):
    model.Objects.AddBrep(sphere(10 * x), attributes(name, source, (10, 20, 30), material))
    rows.append({"name": name, "colour": expected})

parts = [sphere(0), sphere(5), sphere(-5)]
own = [
    attributes("inner by parent", PARENT),
    attributes("inner by layer", LAYER),
    attributes("inner by the parent's material", MATERIAL, material=(BY_PARENT, -1)),
]
model.InstanceDefinitions.Add("pair", "", "", "", r.Point3d(0, 0, 0), tuple(parts), tuple(own))
definition = model.InstanceDefinitions[0]
reference = r.InstanceReference(definition.Id, r.Transform.Translation(0, 20, 0))
model.Objects.Add(reference, attributes("placed", OWN, (0, 128, 255), (BY_OBJECT, 0)))
rows.append({"name": "inner by parent", "colour": [0, 128, 255]})
rows.append({"name": "inner by layer", "colour": [200, 100, 50]})
rows.append({"name": "inner by the parent's material", "colour": [171, 205, 239]})

folder = Path(sys.argv[1])
for version in (3, 4, 5, 8):
    assert model.Write(str(folder / f"colours-{version}.3dm"), version)
(folder / "colours.json").write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
