#!/usr/bin/env python3
"""A renderer that is not Isophote's: draws a scene in NumPy and dumps the G-buffer that `compare` judges.

    isophote scene teapot --size 64x64 --out scene.json
    python3 docs/examples/foreign_renderer.py scene.json teapot.npz
    isophote compare teapot.npz

It reads nothing but scene.json (`docs/gbuffer.md` describes it, and the G-buffer) and needs nothing but NumPy. It works
as a GPU does, slowly: each face is cut into flat triangles, these are projected and tested against the pixels' centres,
(u, v) is interpolated in perspective, and the surface is evaluated there by de Boor's algorithm, in f64.
"""

import json
import sys

import numpy as np

# Flat triangles stay within this many pixels of the surface: what `compare --chord` assumes unless told otherwise.
CHORD_PX = 0.25


def de_boor(window, t, points):
    """Curves in homogeneous coordinates and their derivatives, one parameter a curve.

    window: (n, 2p), the knots t_{k-p+1} ... t_{k+p} around the span [t_k, t_{k+1}) of each parameter.
    points: (n, p + 1, 4), the control points that matter on that span.
    """
    p = points.shape[1] - 1
    d = [points[:, j] for j in range(p + 1)]
    for r in range(1, p + 1):
        if r == p:
            derivative = p * (d[p] - d[p - 1]) / (window[:, p] - window[:, p - 1])[:, None]
        for j in range(p, r - 1, -1):
            low, high = window[:, j - 1], window[:, j - r + p]
            a = ((t - low) / (high - low))[:, None]
            d[j] = (1 - a) * d[j - 1] + a * d[j]
    return d[p], derivative


class Face:
    """A face of scene.json."""

    def __init__(self, scene, number):
        face = scene["faces"][number]
        surface = scene["surfaces"][face["surface"]]
        self.reversed, self.pixel = face["reversed"], face["pixel"]
        self.degree = surface["degree"]
        self.knots = [np.array(surface["knots_u"]), np.array(surface["knots_v"])]
        counts = (surface["nu"], surface["nv"])
        points = np.array(surface["points"]).reshape(*counts, 3)
        weights = np.array(surface["weights"] or [1.0] * (counts[0] * counts[1])).reshape(*counts, 1)
        self.net = np.concatenate([points * weights, weights], axis=2)

    def breaks(self, direction):
        """The distinct knots of the domain."""
        knots, p = self.knots[direction], self.degree[direction]
        return np.unique(knots[p : len(knots) - p])

    def span(self, direction, t):
        """k with knots[k] <= t < knots[k + 1]; at the end of the domain, the last span that is not empty."""
        knots, p = self.knots[direction], self.degree[direction]
        last = np.searchsorted(knots, self.breaks(direction)[-1], side="left") - 1
        return np.clip(np.searchsorted(knots, t, side="right") - 1, p, last)

    def evaluate(self, u, v):
        """S, and the unit normal (NaN where S_u x S_v vanishes), at arrays of parameters."""
        p, q = self.degree
        i, j = self.span(0, u), self.span(1, v)
        window_u = self.knots[0][i[:, None] + np.arange(1 - p, p + 1)]
        window_v = self.knots[1][j[:, None] + np.arange(1 - q, q + 1)]
        rows = [self.net[(i - p + r)[:, None], j[:, None] + np.arange(-q, 1)] for r in range(p + 1)]
        along_v = [de_boor(window_v, v, row) for row in rows]
        a, a_u = de_boor(window_u, u, np.stack([point for point, _ in along_v], axis=1))
        a_v, _ = de_boor(window_u, u, np.stack([derivative for _, derivative in along_v], axis=1))
        w = a[:, 3:]
        s = a[:, :3] / w
        s_u, s_v = (a_u[:, :3] - a_u[:, 3:] * s) / w, (a_v[:, :3] - a_v[:, 3:] * s) / w
        normal = np.cross(s_v, s_u) if self.reversed else np.cross(s_u, s_v)
        length = np.linalg.norm(normal, axis=1)
        flat = length <= 1e-9 * np.linalg.norm(s_u, axis=1) * np.linalg.norm(s_v, axis=1)
        return s, np.where(flat, np.nan, normal.T / np.where(flat, 1, length)).T

    def triangles(self):
        """Parameters of the corners of flat triangles, (count, 3, 2), finer until they keep to the chord."""
        weights = np.array([[1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]], float)
        weights /= weights.sum(axis=1)[:, None]
        for cells in 2 ** np.arange(8):
            lines = [refined(self.breaks(direction), cells) for direction in (0, 1)]
            corner = np.stack(np.meshgrid(*lines, indexing="ij"), axis=2)
            a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
            uv = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 2)
            points = self.evaluate(*uv.reshape(-1, 2).T)[0].reshape(-1, 3, 3)
            inside = (weights @ uv).reshape(-1, 2)
            error = np.linalg.norm((weights @ points).reshape(-1, 3) - self.evaluate(*inside.T)[0], axis=1).max()
            # The places tried are few, so only half of what is allowed is used.
            if error <= 0.5 * CHORD_PX * self.pixel:
                return uv, points
        raise SystemExit(f"a face needs over {cells} x {cells} cells a span: the camera is too near to it")


def refined(breaks, cells):
    """Each interval between breaks, cut into equal cells."""
    parts = [np.linspace(a, b, cells, endpoint=False) for a, b in zip(breaks[:-1], breaks[1:])]
    return np.concatenate(parts + [breaks[-1:]])


class Camera:
    """The camera of scene.json; the directions are given, so that no convention need be guessed."""

    def __init__(self, scene):
        view = scene["view"]
        self.axes = np.array([view["right"], view["above"], view["forward"]])
        self.eye = np.array(scene["meta"]["camera"]["eye"])
        self.near = scene["meta"]["camera"]["near"]
        self.width, self.height = scene["meta"]["size"]
        self.half_height = view["half_height"]
        self.perspective = "perspective" in scene["meta"]["camera"]["projection"]

    def project(self, points):
        """Pixels from the top left corner, and w: the depth in perspective, else 1; and the depth."""
        x, y, depth = np.moveaxis((points - self.eye) @ self.axes.T, -1, 0)
        w = depth if self.perspective else np.ones_like(depth)
        scale = 0.5 * self.height / self.half_height / w
        return 0.5 * self.width + x * scale, 0.5 * self.height - y * scale, w, depth


def rasterize(camera, triangles):
    """The nearest triangle's face and interpolated (u, v) at each pixel's centre; face -1 where there is none."""
    shape = (camera.height, camera.width)
    face, uv, nearest = np.full(shape, -1, np.int32), np.full((*shape, 2), np.nan), np.full(shape, np.inf)
    for number, corner_uv, points in triangles:
        x, y, w, depth = camera.project(points)
        if depth.min() <= camera.near:
            raise SystemExit(f"a triangle of face {number} reaches the near plane: this example does not clip")
        # Rows and columns of pixels whose centres are inside the triangle's box.
        rows = np.arange(max(int(np.ceil(y.min() - 0.5)), 0), min(int(np.floor(y.max() - 0.5)) + 1, camera.height))
        columns = np.arange(max(int(np.ceil(x.min() - 0.5)), 0), min(int(np.floor(x.max() - 0.5)) + 1, camera.width))
        area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
        if len(rows) == 0 or len(columns) == 0 or area == 0:
            continue
        cx, cy = np.meshgrid(columns + 0.5, rows + 0.5)
        # Barycentric coordinates in the picture; in space they are these over w.
        b = [(x[k] - cx) * (y[m] - cy) - (x[m] - cx) * (y[k] - cy) for k, m in ((1, 2), (2, 0), (0, 1))]
        b = np.stack(b, axis=2) / area
        weight = b / w
        weight /= weight.sum(axis=2, keepdims=True)
        z = weight @ depth
        window = np.ix_(rows, columns)
        seen = (b >= 0).all(axis=2) & (z < nearest[window])
        face[window] = np.where(seen, number, face[window])
        nearest[window] = np.where(seen, z, nearest[window])
        uv[window] = np.where(seen[..., None], weight @ corner_uv, uv[window])
    return face, uv


def main(scene_path, out_path):
    with open(scene_path, encoding="utf-8") as file:
        scene = json.load(file)
    faces = [Face(scene, number) for number in range(len(scene["faces"]))]
    camera = Camera(scene)
    triangles = ((n, *pair) for n, face in enumerate(faces) for pair in zip(*face.triangles()))
    face, uv = rasterize(camera, triangles)
    position, normal = np.full((*face.shape, 3), np.nan), np.full((*face.shape, 3), np.nan)
    for number, one in enumerate(faces):
        mine = face == number
        if mine.any():
            # Interpolation may leave the domain by a rounding.
            for direction in (0, 1):
                breaks = one.breaks(direction)
                uv[mine, direction] = np.clip(uv[mine, direction], breaks[0], breaks[-1])
            position[mine], normal[mine] = one.evaluate(*uv[mine].T)
    meta = dict(scene["meta"], renderer="numpy-example", technique="fragment", version="1")
    np.savez_compressed(
        out_path, face=face, u=uv[..., 0], v=uv[..., 1], pos=position, normal=normal, meta=np.array(json.dumps(meta))
    )
    print(f"{out_path}: {(face >= 0).sum()} of {face.size} pixels covered")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
