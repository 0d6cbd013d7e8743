#!/usr/bin/env python3
"""Writes testdata/foreign/ from what docs/examples/foreign_renderer.py drew: the same pixels as NumPy may store them.

    isophote scene teapot --size 64x64 --out scene.json
    python3 docs/examples/foreign_renderer.py scene.json testdata/foreign/teapot.npz
    isophote scene teapot --size 24x24 --out small.json
    python3 docs/examples/foreign_renderer.py small.json small.npz
    python3 tests/oracle/make_foreign.py small.npz testdata/foreign
"""

import sys
from pathlib import Path

import numpy as np


def main(drawn, folder):
    folder = Path(folder)
    arrays = dict(np.load(drawn))
    # Uncompressed; single precision wherever the judge allows it, and a mask and faces of other types.
    plain = dict(arrays, hit=arrays["face"] >= 0, face=arrays["face"].astype(np.int16))
    plain["normal"] = plain["normal"].astype(np.float32)
    np.savez(folder / "plain.npz", **plain)
    fortran = dict(arrays, pos=np.asfortranarray(arrays["pos"]))
    np.savez_compressed(folder / "fortran.npz", **fortran)
    np.savez_compressed(folder / "big-endian.npz", **dict(arrays, u=arrays["u"].astype(">f8")))
    np.savez_compressed(folder / "half.npz", **dict(arrays, normal=arrays["normal"].astype(np.float16)))
    np.savez_compressed(folder / "misspelt.npz", **arrays, curvature=arrays["u"])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
