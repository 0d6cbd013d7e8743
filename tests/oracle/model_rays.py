#!/usr/bin/env python3
"""model_rays.py MODEL... [--xtask target/release/xtask] [--size 64x48] [--inches NAME,NAME]

Ray pictures of whole model files (STEP, IGES), three views each, by this project's ray caster and by OpenCASCADE, each
with its own reader: how many pixels differ in the mask, in the face (number in the file's order), and in position by
more than 1e-9 of the size. OpenCASCADE's pictures are those of oracle_ray.py; pixels that it suspects are left out. It
reads every file in millimetres: files in inches are named by --inches, and their cameras scaled.
Exit status 1 if anything differs. A line a view:

    NIST_MBE_PMI_2.stp view 1: hits 2279, suspect 0, differ in mask 0, face 0, position 0; farthest 3.9e-15
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
VIEWS = [None, (-0.7, 0.5, 0.45), (0.2, 0.6, -0.75)]
NEAR = 1e-9


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr[-400:]}")


def differing(ours, theirs, scale, size):
    """pixels that differ in mask, face and position, and how far the farthest of the others is, in shares of the size"""
    certain = theirs["suspect"] != 1
    a, b = ours["hit"] == 1, theirs["hit"] == 1
    both = a & b & certain
    off = np.linalg.norm(ours["pos"] - theirs["pos"] / scale, axis=-1) / size
    counts = ((a != b) & certain).sum(), (both & (ours["face"] != theirs["face"])).sum(), (both & (off > NEAR)).sum()
    return [int(n) for n in counts], float(off[both].max()) if both.any() else 0.0


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("--xtask", default="target/release/xtask")
    parser.add_argument("--size", default="64x48")
    parser.add_argument("--inches", default="")
    asked = parser.parse_args()
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        scene, ours, theirs = (Path(folder) / name for name in ("scene.json", "ours.npz", "theirs.npz"))
        for model in asked.models:
            scale = 25.4 if model.name in asked.inches.split(",") else 1.0
            run([asked.xtask, "scene", model, "--size", asked.size, "--out", scene])
            camera = json.loads(scene.read_text())["meta"]["camera"]
            eye, target = np.array(camera["eye"]), np.array(camera["target"])
            distance = np.linalg.norm(eye - target)
            for number, way in enumerate(VIEWS):
                way = (eye - target) / distance if way is None else np.array(way) / np.linalg.norm(way)

                def view(factor):
                    places = [repr(float(x)) for x in np.concatenate([target + way * distance, target]) * factor]
                    return ["--eye", *places[:3], "--target", *places[3:], "--up", "0", "0", "1", "--fov", "40"]

                run([asked.xtask, "render", model, "--with", "raycast", "--gbuffer", ours, *view(1.0), "--size", asked.size])
                chord = repr(float(distance * scale * 1e-4))
                own = [sys.executable, HERE / "oracle_ray.py", model, "-o", theirs, *view(scale)]
                run([*own, "--size", *asked.size.split("x"), "--jobs", "1", "--mesh", chord])
                a, b = np.load(ours), np.load(theirs)
                (mask, face, place), farthest = differing(a, b, scale, distance / 2)
                moved = dict(a, pos=a["pos"] + 1e-8 * distance)
                assert differing(moved, b, scale, distance / 2)[0][2] > 0, "a moved picture is not noticed"
                print(
                    f"{model.name} view {number}: hits {int((a['hit'] == 1).sum())}, suspect {int((b['suspect'] == 1).sum())}, "
                    f"differ in mask {mask}, face {face}, position {place}; farthest {farthest:.1e}",
                    flush=True,
                )
                wrong += mask + face + place
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
