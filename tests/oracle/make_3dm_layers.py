#!/usr/bin/env python3
"""make_3dm_layers.py OUTDIR: spheres on layers in layers, and the full path of each by rhino3dm.

Writes layers-5.3dm, -8.3dm and layers.json: for each face in order its object's name and its layer's path. Archives of versions 3 and 4
know no paths. Needs rhino3dm 8.35.
"""
import json
import sys
from pathlib import Path

import rhino3dm as r

model = r.File3dm()


def layer(name, parent=None):
    made = r.Layer()
    made.Name = name
    if parent is not None:
        made.ParentLayerId = model.Layers[parent].Id
    return model.Layers.Add(made)


body = layer("Karosserie")
panels = layer("Außenhaut", body)
door = layer("door, left", panels)
other = layer("Karosserie 2")


def sphere(x, name, layer):
    attributes = r.ObjectAttributes()
    attributes.Name, attributes.LayerIndex = name, layer
    return r.Sphere(r.Point3d(x, 0, 0), 1.0).ToBrep(), attributes


for k, (name, index) in enumerate([("shell", body), ("skin", panels), ("door", door), ("other", other)]):
    model.Objects.AddBrep(*sphere(10 * k, name, index))
own = sphere(0, "bolt", door)
model.InstanceDefinitions.Add("pair", "", "", "", r.Point3d(0, 0, 0), (own[0],), (own[1],))
attributes = r.ObjectAttributes()
attributes.Name, attributes.LayerIndex = "placed", other
definition = model.InstanceDefinitions[0]
model.Objects.Add(r.InstanceReference(definition.Id, r.Transform.Translation(0, 20, 0)), attributes)

folder = Path(sys.argv[1])
for version in (5, 8):
    assert model.Write(str(folder / f"layers-{version}.3dm"), version)
again = r.File3dm.Read(str(folder / "layers-8.3dm"))
path = {layer.Index: layer.FullPath for layer in again.Layers}
parts = [o.Attributes for o in again.Objects if not isinstance(o.Geometry, r.InstanceReference)]
rows = [{"name": part.Name, "layer": path[part.LayerIndex]} for part in parts]
rows.sort(key=lambda row: row["name"] == "bolt")
(folder / "layers.json").write_text("[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n")
