#!/usr/bin/env python3
"""make_trims.py [OUTDIR] [--faces 304] [--models DIR] [--per-face 16]

Writes the frozen answers of point classification (default OUTDIR: testdata/trims of this repository):

  OUTDIR/random-<n>.json, .bin   seeded random trimmed faces, 1,000 points each
  OUTDIR/real-<model>.bin        with --models: points of the faces of DIR/<model>.json, which are not copied

README.md beside this file documents the formats and how the answers are checked.  A second run on the same library
versions writes the same files.
"""
import argparse, json, math, os, sys
HERE = os.path.dirname(os.path.abspath(__file__)); sys.path.insert(0, HERE)
import numpy as np
import occ_common as oc
import planar
from trim_faces import SEED, backwards, bernstein, bezier, make_face, sample
from OCP.BRep import BRep_Builder
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.BRepTopAdaptor import BRepTopAdaptor_FClass2d
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.TColgp import TColgp_Array1OfPnt2d
from OCP.TopAbs import TopAbs_IN, TopAbs_ON, TopAbs_REVERSED, TopAbs_FORWARD
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Vertex, TopoDS_Wire
from OCP.gp import gp_Pnt2d

ROOT = os.path.dirname(os.path.dirname(HERE))
POINTS = 1000
PART = 76            # faces of one file
BITS = 24            # of a coordinate near an edge, as a share of the face's box
COARSE = 12          # of a coordinate elsewhere, which lies in the middle of its cell
BAND = 1e-7          # distance to the nearest edge, in shares of the box, below which nobody is judged
TOLERANCE = 1e-12    # given to OpenCASCADE


# ---------------------------------------------------------------- OpenCASCADE

def curve2d(t):
    P = TColgp_Array1OfPnt2d(1, len(t['points']))
    for i, q in enumerate(t['points']): P.SetValue(i + 1, gp_Pnt2d(*map(float, q)))
    k, m = oc.knots_mults(t['knots'])
    return Geom2d_BSplineCurve(P, oc._r(t['weights']), oc._r(k), oc._i(m), t['degree'], False) if t['weights'] else Geom2d_BSplineCurve(P, oc._r(k), oc._i(m), t['degree'], False)


def occ_face(surf, loops, loc=TopLoc_Location()):
    """a face of OpenCASCADE with exactly these parameter curves; each junction is a vertex of its own"""
    B = BRep_Builder(); F = TopoDS_Face(); B.MakeFace(F, surf, 1e-7)
    for loop in loops:
        trims = loop['trims']; V = []
        for t in trims:
            v = TopoDS_Vertex(); x, y = planar.ends(t)[0]; B.MakeVertex(v, surf.Value(x, y), 1e-7); V.append(v)
        W = TopoDS_Wire(); B.MakeWire(W)
        for i, t in enumerate(trims):
            e = TopoDS_Edge(); c = curve2d(t); B.MakeEdge(e); B.UpdateEdge(e, c, F, 1e-7); B.Range(e, F, c.FirstParameter(), c.LastParameter())
            if t.get('degenerate'): B.Degenerated(e, True)
            a, z = V[i], V[(i + 1) % len(V)]
            if t['reversed']: a, z = z, a
            B.Add(e, a.Oriented(TopAbs_FORWARD)); B.Add(e, z.Oriented(TopAbs_REVERSED))
            B.Add(W, e.Oriented(TopAbs_REVERSED if t['reversed'] else TopAbs_FORWARD))
        B.Add(F, W)
    return F


def cut(loops):
    """the same loops with an edge for every Bezier segment: FClass2d samples an edge without regard to its knots"""
    one = lambda t: [t] if t.get('seam') or t.get('degenerate') else [bezier([[x / w, y / w] for x, y, w in b], [w for _, _, w in b]) for b in planar.beziers(t)]
    return [dict(l, trims=[q for t in l['trims'] for q in one(t)]) for l in loops]


def occ_ask(F, P, recadre):
    C = BRepTopAdaptor_FClass2d(F, TOLERANCE)
    out = [C.Perform(gp_Pnt2d(float(x), float(y)), recadre) for x, y in P]
    return np.array([1 if s == TopAbs_IN else 2 if s == TopAbs_ON else 0 for s in out], np.int8)


def occ_states(S, loops, P, period, single):
    """1 inside, 0 outside, 2 'on'"""
    surf = oc.to_occ_surface(S)
    if period: surf.SetUPeriodic()
    if not single: return occ_ask(occ_face(surf, loops), P, bool(period))
    # each loop as a face of its own, counter-clockwise; a point is inside where an odd number of them has it
    odd = np.zeros(len(P), np.int8); on = np.zeros(len(P), bool)
    for l in loops:
        q = np.vstack([sample(t, 8) for t in l['trims']]); area = np.sum(q[:, 0] * np.roll(q[:, 1], -1) - q[:, 1] * np.roll(q[:, 0], -1))
        s = occ_ask(occ_face(surf, [dict(trims=l['trims'] if area > 0 else backwards(l['trims']))]), P, bool(period) and not any(t['seam'] for t in l['trims']))
        odd ^= (s == 1).astype(np.int8); on |= s == 2
    return np.where(on, 2, odd)


def occ_intersections(S, loops, P, period):
    """the same by OpenCASCADE's classifier that intersects the curves with a line instead of sampling them"""
    surf = oc.to_occ_surface(S); odd = np.zeros(len(P), np.int8); on = np.zeros(len(P), bool)
    for l in loops:
        q = np.vstack([sample(t, 8) for t in l['trims']]); area = np.sum(q[:, 0] * np.roll(q[:, 1], -1) - q[:, 1] * np.roll(q[:, 0], -1))
        F = occ_face(surf, [dict(trims=l['trims'] if area > 0 else backwards(l['trims']))])
        for i, (x, y) in enumerate(P):
            for s in (-period, 0.0, period) if period else (0.0,):
                state = BRepClass_FaceClassifier(F, gp_Pnt2d(float(x + s), float(y)), TOLERANCE).State()
                odd[i] ^= state == TopAbs_IN; on[i] |= state == TopAbs_ON
    return np.where(on, 2, odd)


# ---------------------------------------------------------------- points and answers

def exact(K, box):
    """the f64 that a reader makes of the integers, in the same order of operations"""
    return np.column_stack([b[0] + b[1] * (K[:, i] / 2.0 ** BITS) for i, b in enumerate(box)])


def choose(rng, S, degree, gaps, n, shift):
    """half of the points uniform in the box, half near the edges at distances log-uniform in 1e-6 .. 1e-2"""
    top = 2 ** BITS; out = []; near = n // 2
    while len(out) < n:
        if len(out) < near:
            k = rng.integers(len(S)); b = S[k, :degree[k] + 1]; x = rng.random(); d = 10 ** rng.uniform(-6, -2) * rng.choice([-1, 1])
            q = bernstein(b, np.array([x, min(x + 1e-6, 1.0), max(x - 1e-6, 0.0)])); t = q[1] - q[2]; l = np.hypot(*t)
            if l == 0: continue
            p = q[0] + d * np.array([-t[1], t[0]]) / l
            if shift: p[0] -= math.floor(p[0])
            K = np.floor(p * top + .5)
        else: K = (rng.integers(2 ** COARSE, size=2) + .5) * 2.0 ** (BITS - COARSE)
        if (K < 0).any() or (K >= top).any(): continue
        if len(gaps) and (np.hypot(K[0] / top - gaps[:, 0], K[1] / top - gaps[:, 1]) < 4 * gaps[:, 2] + BAND).any(): continue
        out.append(K)
    return np.array(out, np.int64)


def answers(loops, box, K, period):
    """winding number over all shifts by the period, and distance, both in shares of the box"""
    S, degree, gaps = planar.segments(loops, box); Q = K / 2.0 ** BITS
    W = np.zeros(len(K), np.int64); D = np.full(len(K), np.inf)
    for s in (-1.0, 0.0, 1.0) if period else (0.0,):
        w, d = planar.classify(S, degree, Q + [s, 0.0]); W += w; D = np.minimum(D, d)
    return W, D


def pack(K, inside, wrong, D):
    near = len(K) // 2; three = lambda x: x.astype('<u4').reshape(-1, 1).view(np.uint8).reshape(-1, 4)[:, :3].tobytes()
    coarse = K[near:] >> (BITS - COARSE); b = three(K[:near]) + three(coarse[:, 0] | coarse[:, 1] << COARSE)
    bits = lambda x: np.packbits(x.astype(np.uint8), bitorder='little').tobytes()
    with np.errstate(divide='ignore'):
        # an eighth of a binary order a step, rounded so that the stored distance is never above the true one
        d = np.clip(np.ceil(-8 * np.log2(np.maximum(D * (1 - 2 * planar.SLACK), 1e-300))), 0, 255).astype(np.uint8)
    return b + bits(inside) + bits(wrong) + d.tobytes()


def check_angles(loops, P, W, D, wrong, period, count):
    """mpmath's sum of angles at the nearest points outside the band and at those where OpenCASCADE differs"""
    order = np.argsort(np.where(D > BAND, D, np.inf)); pick = list(order[:count]) + list(np.flatnonzero(wrong)); done = 0
    for i in dict.fromkeys(pick):
        if D[i] <= BAND: continue
        w = planar.winding_by_angles(loops, P[i], [(s * period, 0) for s in ((-1, 0, 1) if period else (0,))])
        if w is not None:
            if w != W[i]: raise SystemExit('crossings say %d, angles %d at %r' % (W[i], w, P[i]))
            done += 1
    return done


def write_bin(path, header, blobs):
    with open(path, 'wb') as f:
        H = dict(header, faces=[write_header_entry(e) for e in header['faces']])
        f.write(json.dumps(H, separators=(',', ':')).encode() + b'\n'); f.writelines(blobs)
    print(os.path.basename(path), os.path.getsize(path), 'bytes', flush=True)


def entry(face, kind, box, n, W, D, states, wrong, **more):
    far = D > BAND
    return dict(face=face, kind=kind, box=box, points=n, inside=int((W > 0).sum()), outside_band=int(far.sum()),
                occ_wrong=int(wrong.sum()), occ_on=int(((states == 2) & far).sum()), **more)


def write_header_entry(f):
    """counts that are nought and kinds that the file's name tells are left out"""
    return {k: v for k, v in f.items() if not (k in ('occ_wrong', 'occ_on', 'occ_uncut_wrong', 'occ_intersections_wrong', 'period', 'largest_gap') and v == 0 or v == 'real' or k == 'outside_band' and v == f['points'])}


def totals(faces):
    return {k: sum(f[k] for f in faces if k in f) for k in ('occ_wrong', 'occ_on', 'occ_uncut_wrong', 'occ_intersections_wrong')}


def header(model, faces, checked):
    return dict(format='isophote-trims', version=1, model=model, band=BAND, bits=BITS, checked_by_angles=checked, **totals(faces), faces=faces)


def random_part(out, part, numbers):
    model = dict(format='nurbs-neutral', version=1, name='random-%d' % part, surfaces=[], faces=[]); entries = []; blobs = []; checked = 0
    for n in numbers:
        kind, box, S, loops, period, single, names = make_face(n)
        rng = np.random.default_rng([SEED, n]); G = planar.segments(loops, box)
        K = choose(rng, *G, POINTS, bool(period)); W, D = answers(loops, box, K, period); P = exact(K, box)
        if not set(W[D > BAND]) <= {0, 1}: raise SystemExit('face %d: winding numbers %s: loops cross' % (n, set(W)))
        differs = lambda states: ((states == 1) != (W > 0)) & (states != 2) & (D > BAND)
        states = occ_states(S, cut(loops), P, period, single); uncut = differs(occ_states(S, loops, P, period, single)); wrong = differs(states); other = 0
        if (wrong | uncut).any():
            s = np.where(W > 0, 1, 0); s[wrong | uncut] = occ_intersections(S, loops, P[wrong | uncut], period); other = int(differs(s).sum())
        checked += check_angles(loops, P, W, D, wrong | uncut, period, 1)
        k = len(model['faces']); model['surfaces'].append(S); model['faces'].append(dict(surface=k, reversed=False, tolerance=0.0, loops=loops))
        entries.append(entry(k, kind, box, POINTS, W, D, states, wrong, period=period, occ='loops' if single else 'face', occ_uncut_wrong=int(uncut.sum()), occ_intersections_wrong=other, shapes=' '.join(names))); blobs.append(pack(K, W > 0, wrong, D))
    brief = lambda x: {k: brief(v) for k, v in x.items() if v is not None and v is not False or k == 'outer'} if isinstance(x, dict) else [brief(v) for v in x] if isinstance(x, list) else int(x) if isinstance(x, float) and x == int(x) else x
    text = lambda x: json.dumps(brief(x), separators=(',', ':'))
    with open(os.path.join(out, 'random-%d.json' % part), 'w') as f:
        f.write('{"format":"nurbs-neutral","version":1,"name":"%s","surfaces":[\n%s],\n"faces":[\n%s]}\n' % (model['name'], ',\n'.join(map(text, model['surfaces'])), ',\n'.join(map(text, model['faces']))))
    H = header('random-%d.json' % part, entries, checked); write_bin(os.path.join(out, 'random-%d.bin' % part), H, blobs)
    return H


def real_model(out, path, per_face):
    d = json.load(open(path)); name = os.path.basename(path); entries = []; blobs = []; checked = 0
    for k, f in enumerate(d['faces']):
        S = d['surfaces'][f['surface']]; loops = [l for l in f['loops'] if l['trims']]
        if not loops: continue
        rng = np.random.default_rng([SEED, k])
        q = np.vstack([sample(t, 8) for l in loops for t in l['trims']]); lo, hi = q.min(0), q.max(0); m = .05 * (hi - lo)
        if (hi <= lo).any(): continue
        short = lambda x: float('%.6g' % x); box = [[short(a - b), short(c - a + 2 * b)] for a, c, b in zip(lo, hi, m)]; G = planar.segments(loops, box)
        K = choose(rng, *G, per_face, False); W, D = answers(loops, box, K, 0.0); P = exact(K, box)
        states = occ_ask(occ_face(oc.to_occ_surface(S), cut(loops)), P, False); wrong = ((states == 1) != (W > 0)) & (states != 2) & (D > BAND)
        checked += check_angles(loops, P, W, D, wrong, 0.0, 1) if k % 8 == 0 or wrong.any() else 0
        bad = sorted(int(w) for w in set(W[D > BAND]) - {0, 1})
        entries.append(entry(k, 'real', box, per_face, W, D, states, wrong, largest_gap=float(G[2][:, 2].max()) if len(G[2]) else 0.0, **(dict(winding=bad) if bad else {})))
        blobs.append(pack(K, W > 0, wrong, D))
    H = header(name, entries, checked); write_bin(os.path.join(out, 'real-%s.bin' % os.path.splitext(name)[0]), H, blobs)
    return H


def main():
    ap = argparse.ArgumentParser(usage=__doc__); A = ap.add_argument
    A('out', nargs='?', default=os.path.join(ROOT, 'testdata/trims')); A('--faces', type=int, default=304); A('--models'); A('--per-face', type=int, default=16); a = ap.parse_args()
    oc.quiet(); os.makedirs(a.out, exist_ok=True); H = []
    if a.models:
        for f in sorted(os.listdir(a.models)):
            if f.endswith('.json'): H.append(real_model(a.out, os.path.join(a.models, f), a.per_face))
    else:
        for part, first in enumerate(range(0, a.faces, PART)): H.append(random_part(a.out, part, range(first, min(first + PART, a.faces))))
    F = [f for h in H for f in h['faces']]; n = sum(f['points'] for f in F)
    print(json.dumps(dict(faces=len(F), points=n, outside_band=sum(f['outside_band'] for f in F), inside_share=round(sum(f['inside'] for f in F) / n, 4),
                          **totals(F), checked_by_angles=sum(h['checked_by_angles'] for h in H))))


if __name__ == '__main__': main()
