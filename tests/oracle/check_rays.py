#!/usr/bin/env python3
"""check_rays.py SCENE.json ... [--models DIR]

Second opinion on frozen ray answers, by a search that shares nothing with
OpenCASCADE's: complete, where the other can lose roots.  Every surface is cut
into rational Bezier patches (blossoms); for all rays at once the patches are
written as two plane functions and halved in u and v, what has its convex hull
off the ray being dropped; what is left after LEVELS halvings starts Newton.
The nearest root is compared with the file's hit and t.

Prints a line a scene and each differing ray (t of the file, t found here, |n.d|,
suspect); exit status 1 if a ray that is not suspect differs.  Before the first
scene it must notice a wrong answer: a t moved by 1e-5 of the size.
"""
import argparse, json, math, os, sys
import numpy as np
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

LEVELS = 11          # halvings in u and in v before Newton
BLOCK = 48           # rays worked on together
TOLERANCE = 1e-7     # of the size: larger differences in t are reported


def blossoms(knots, p, n):
    """for each nonempty span the (p+1) x n matrix from control points to the span's Bezier points"""
    out = []
    for k in range(p, n):
        a, b = knots[k], knots[k + 1]
        if a == b: continue
        M = np.zeros((p + 1, n))
        for j in range(p + 1):
            D = np.eye(p + 1)
            for r, x in enumerate([a] * (p - j) + [b] * j, 1):
                for m in range(p, r - 1, -1):
                    lo, hi = knots[k - p + m], knots[k + 1 + m - r]; D[m] = (hi - x) / (hi - lo) * D[m - 1] + (x - lo) / (hi - lo) * D[m]
            M[j, k - p:k + 1] = D[p]
        out.append(M)
    return out


def patches(s):
    """(p+1, q+1, 4) homogeneous Bezier points of every patch"""
    w = np.ones(s['nu'] * s['nv']) if s.get('weights') is None else np.array(s['weights'])
    H = np.concatenate([np.array(s['points']) * w[:, None], w[:, None]], 1).reshape(s['nu'], s['nv'], 4)
    V = blossoms(s['knots_v'], s['degree'][1], s['nv'])
    return [np.einsum('ai,bj,ijc->abc', A, B, H) for A in blossoms(s['knots_u'], s['degree'][0], s['nu']) for B in V]


def halves(p):
    L = np.array([[math.comb(i, j) / 2 ** i if j <= i else 0 for j in range(p + 1)] for i in range(p + 1)])
    return L, L[::-1, ::-1].copy()


def bernstein(p, u):
    """values and first derivatives"""
    def values(p):
        i = np.arange(p + 1); return np.array([math.comb(p, k) for k in i]) * u[:, None] ** i * (1 - u[:, None]) ** (p - i)
    z = np.zeros((len(u), 1)); b = values(p - 1)
    return values(p), p * (np.hstack([z, b]) - np.hstack([b, z]))


def on_line(F):
    """which sub-patches' hulls, seen along the ray, may hold the origin: eight directions, a margin for rounding"""
    G = F.reshape(len(F), F.shape[1] * F.shape[2], 2); x, y = G[..., 0], G[..., 1]; keep = np.ones(len(F), bool); margin = 1e-13 * (np.abs(G).max() if len(G) else 0)
    for z in (x, y, x + y, x - y, x + 2 * y, 2 * x - y, 2 * x + y, x - 2 * y): keep &= (z.min(1) <= margin) & (z.max(1) >= -margin)
    return keep


def cast(surfaces, o, d):
    """nearest t >= 0 of every ray, infinity for none; and the size"""
    C = np.array([c for s in surfaces for c in patches(s)]); p, q = C.shape[1] - 1, C.shape[2] - 1
    mid = C[..., :3].sum((0, 1, 2)) / C[..., 3].sum(); C[..., :3] -= C[..., 3:] * mid; o = o - mid; size = np.abs(C[..., :3] / C[..., 3:]).max()
    a = np.cross(d, np.where(np.abs(d[:, :1]) < .6, [[1., 0, 0]], [[0, 1., 0]])); a /= np.linalg.norm(a, axis=1)[:, None]; b = np.cross(d, a)
    half_u, half_v = halves(p), halves(q); best = np.full(len(o), np.inf)
    for at in range(0, len(o), BLOCK):
        O, A, B, D = (x[at:at + BLOCK] for x in (o, a, b, d))
        F = np.stack([np.einsum('pijc,rc->rpij', C[..., :3], N) - np.einsum('pij,r->rpij', C[..., 3], (N * O).sum(1)) for N in (A, B)], -1).reshape(-1, p + 1, q + 1, 2)
        ray, patch = (x.ravel() for x in np.meshgrid(np.arange(len(O)), np.arange(len(C)), indexing='ij')); u = np.zeros(len(ray)); v = np.zeros(len(ray))
        k = on_line(F); F, ray, patch, u, v = F[k], ray[k], patch[k], u[k], v[k]; first = F; cell = np.arange(len(F))
        for level in range(1, LEVELS + 1):
            h = .5 ** level
            F = np.concatenate([np.einsum('ab,nbqc->naqc', M, F) for M in half_u]); u = np.concatenate([u, u + h]); v = np.tile(v, 2); cell = np.tile(cell, 2); k = on_line(F); F, u, v, cell = F[k], u[k], v[k], cell[k]
            F = np.concatenate([np.einsum('ab,npbc->npac', M, F) for M in half_v]); v = np.concatenate([v, v + h]); u = np.tile(u, 2); cell = np.tile(cell, 2); k = on_line(F); F, u, v, cell = F[k], u[k], v[k], cell[k]
        if not len(cell): continue
        G = first[cell]; r = ray[cell]; u = u + h / 2; v = v + h / 2
        for _ in range(25):
            (bu, du), (bv, dv) = bernstein(p, u), bernstein(q, v); g, x, y = (np.einsum('ni,nj,nijc->nc', i, j, G) for i, j in ((bu, bv), (du, bv), (bu, dv)))
            det = x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]; det = np.where(det == 0, 1e-300, det)
            u = np.clip(u + np.clip((g[:, 1] * y[:, 0] - g[:, 0] * y[:, 1]) / det, -4 * h, 4 * h), 0, 1); v = np.clip(v + np.clip((g[:, 0] * x[:, 1] - g[:, 1] * x[:, 0]) / det, -4 * h, 4 * h), 0, 1)
        S = np.einsum('ni,nj,nijc->nc', bernstein(p, u)[0], bernstein(q, v)[0], C[patch[cell]]); E = S[:, :3] / S[:, 3:] - O[r]
        t = (E * D[r]).sum(1); off = np.hypot((E * A[r]).sum(1), (E * B[r]).sum(1)); ok = (off < 1e-10 * size + 1e-14 * np.abs(O[r]).max(1)) & (t >= 0)
        np.minimum.at(best, r[ok] + at, t[ok])
    return best, size


def differing(t, found, size):
    """rays whose hit or t differ"""
    both = np.isfinite(t) & np.isfinite(found); gap = np.zeros(len(t)); gap[both] = np.abs(t[both] - found[both])
    return (np.isfinite(t) != np.isfinite(found)) | (gap > TOLERANCE * size), gap


def main():
    from oracle_ray import camera
    ap = argparse.ArgumentParser(usage=__doc__); ap.add_argument('scenes', nargs='+'); ap.add_argument('--models'); a = ap.parse_args(); rays = wrong = doubted = 0; worst = 0.0; proved = False
    for path in a.scenes:
        j = json.load(open(path)); ref = j['model']; model = os.path.join(a.models, os.path.basename(ref)) if a.models and ref.startswith('..') else os.path.join(os.path.dirname(path), ref)
        c = j['camera']; o, d = (x.reshape(-1, 3).copy() for x in camera(c['eye'], c['target'], c['up'], *c['size'], c.get('fov'), c.get('ortho')))
        found, size = cast(json.load(open(model))['surfaces'], o, d); hit = np.array(j['rays']['hit']) == 1; suspect = np.array(j['rays']['suspect']) == 1; t = np.full(len(hit), np.inf); t[hit] = j['rays']['t']
        N = np.zeros((len(hit), 3)); N[hit] = [n or [0, 0, 0] for n in j['rays']['normal']]; cos = np.abs((N * d).sum(1)); bad, gap = differing(t, found, size)
        if not proved:
            spoilt = t.copy(); spoilt[np.argmax(hit)] += 1e-5 * size; assert differing(spoilt, found, size)[0].sum() == bad.sum() + 1; proved = True
        print('%-22s rays %d differ %d (suspect %d); suspect but equal %d; largest other gap / size %.1e' % (j['name'], len(t), bad.sum(), (bad & suspect).sum(), (suspect & ~bad).sum(), gap[~bad].max() / size), flush=True)
        for k in np.nonzero(bad)[0]: print('    ray %d: file %r, found %r, |n.d| %.2g, suspect %d' % (k, float(t[k]), float(found[k]), cos[k], suspect[k]))
        rays += len(t); wrong += int((bad & ~suspect).sum()); doubted += int((bad & suspect).sum()); worst = max(worst, gap[~bad].max() / size)
    print('TOTAL rays %d, differing %d, differing and suspect %d, largest other gap / size %.1e' % (rays, wrong, doubted, worst)); sys.exit(wrong > 0)


if __name__ == '__main__': main()
