"""Trimmed NURBS surfaces, exact per pixel, as NumPy arrays.

    import isophote
    picture = isophote.open("part.step").render(isophote.Camera(view="iso"))
    picture.face, picture.u, picture.normal
"""

import io

import numpy

from ._isophote import (
    Camera,
    CameraError,
    EvalError,
    Face,
    GBuffer,
    GBufferError,
    IsophoteError,
    Model,
    ReadError,
    RenderError,
    Verdict,
    open,
)

__all__ = [
    "Camera",
    "CameraError",
    "EvalError",
    "Face",
    "GBuffer",
    "GBufferError",
    "IsophoteError",
    "Model",
    "ReadError",
    "RenderError",
    "Verdict",
    "gbuffer",
    "judge",
    "open",
]


def gbuffer(arrays):
    """Make a G-buffer of arrays by name and of `meta`, a JSON text, as docs/gbuffer.md tells; all are checked and copied."""
    file = io.BytesIO()
    numpy.savez(file, **arrays)
    return GBuffer.from_bytes(file.getvalue())


def judge(gbuffer, other=None, *, model=None, **options):
    """Judge one G-buffer, or two of one scene, as `isophote compare` does; `model` is the built-in one that they name, unless given."""
    model = open(gbuffer.meta["model"]) if model is None else model
    return model.judge(gbuffer, other, **options)
