#!/usr/bin/env python3
"""freeze.py [OUTDIR] [--only eval|rays] [--models DIR] [--jobs 2] [--scenes NAME,...]

Writes the frozen answers that the Rust tests read (default OUTDIR: testdata/oracle
of this repository), so that the tests need no Python:

  OUTDIR/eval/<kind>.json   (large kinds: <kind>_0.json ..) points, derivatives, normals, curvatures by mpmath
  OUTDIR/rays/<scene>.json  nearest hits by OpenCASCADE, and rays/models/<name>.json

README.md beside this file documents both formats.  Everything is seeded: a second
run on the same library versions writes the same files.  The models of Newell
are read from --models (default testdata/models) as neutral JSON.
"""
import argparse, json, math, os, random, subprocess, sys, tempfile
HERE = os.path.dirname(os.path.abspath(__file__)); sys.path.insert(0, HERE)
import numpy as np
import make_cases as mc

ROOT = os.path.dirname(os.path.dirname(HERE))
SEED = 20240
DIGITS = 50
POINTS = 22          # points a surface in eval/
PART = 600_000       # bytes, about, of one file in eval/
PER_KIND = 12        # surfaces of each kind of make_cases.py in eval/
EVAL_KINDS = 'bezier fold huge knots mixed periodic pole quadric tiny unclamped weights'.split()


# ---------------------------------------------------------------- eval: surfaces

def degrees(R, n):
    """every degree 1..15 in u and in v; Bezier or few spans; half of them rational"""
    fixed = [(1, 4), (5, 2), (7, 7), (15, 15), (1, 15), (15, 1), (4, 1), (2, 5), (3, 3), (2, 2)]
    pairs = fixed + [(p, 16 - p) for p in range(1, 16)] + [(p, p) for p in range(1, 16)] + [(p, (7 * p) % 15 + 1) for p in range(1, 16)]
    p, q = pairs[n % len(pairs)]; k = n % 3
    return mc.mk(R, p, q, 1 if k == 0 else 2, 1 if k == 0 else 2 if p * q > 60 else 3, mu=1, mv=1, ratio=10, wr=None if n % 2 else 10.0)


def creases(R, n):
    """every interior knot of multiplicity p in u (C^0), of 1..q in v"""
    p, q = 1 + n % 7, R.randint(1, 5)

    def full(p, spans, least):
        k = [0.0] * (p + 1); x = 0.0
        for s in range(spans):
            x += R.uniform(.1, 1)
            k += [x] * (p + 1 if s == spans - 1 else R.randint(min(least, p), p))
        return k
    ku, kv = full(p, R.randint(2, 3), p), full(q, R.randint(2, 3), 1); nu, nv = len(ku) - p - 1, len(kv) - q - 1
    w = [math.exp(R.uniform(-1, 1)) for _ in range(nu * nv)] if n % 2 else None
    return mc.surf(p, q, ku, kv, nu, nv, mc.grid(R, nu, nv, rough=1.0), w)


def offset(R, n):
    """coordinates at 1e6 .. 1e9, size 1 or 1000"""
    d = 10.0 ** (6 + n % 4)
    return mc.mk(R, R.randint(1, 5), R.randint(1, 5), R.randint(1, 3), R.randint(1, 3), ratio=5, size=R.choice([1.0, 1e3]), off=[R.choice([-d, d]) * R.uniform(.5, 1) for _ in range(3)], wr=4.0 if n % 2 else None)


def shifted(R, n):
    """knots a + b k: domains far from zero, very long and very short"""
    s = mc.mk(R, R.randint(1, 5), R.randint(1, 5), R.randint(1, 4), R.randint(1, 4), ratio=10, wr=4.0 if n % 2 else None)
    for key in ('knots_u', 'knots_v'):
        a = R.choice([-1e6, -1e3, -5.5, 1e3, 1e6]); b = R.choice([1e-3, 1.0, 1e3])
        s[key] = [a + b * x for x in s[key]]
    return s


OWN = dict(degrees=(degrees, 55), creases=(creases, 21), offset=(offset, 20), shifted=(shifted, 20))


def eval_uv(R, s):
    """corners, sides, knots, a knot crossing, the double below a knot, then random interior points"""
    u0, u1, v0, v1 = mc.domain(s)
    inside = lambda k, lo, hi: sorted({x for x in k if lo < x < hi})
    ku, kv = inside(s['knots_u'], u0, u1), inside(s['knots_v'], v0, v1)
    ru, rv = lambda: R.uniform(u0, u1), lambda: R.uniform(v0, v1)
    uv = [[u0, v0], [u1, v0], [u0, v1], [u1, v1], [u0, rv()], [u1, rv()], [ru(), v0], [ru(), v1]]
    uv += [[x, rv()] for x in R.sample(ku, min(3, len(ku)))] + [[ru(), x] for x in R.sample(kv, min(3, len(kv)))]
    if ku: uv += [[math.nextafter(R.choice(ku), -math.inf), rv()], [R.choice(ku), v1]]
    if kv: uv += [[ru(), math.nextafter(R.choice(kv), -math.inf)]]
    if ku and kv: uv += [[R.choice(ku), R.choice(kv)]]
    while len(uv) < POINTS: uv.append([ru(), rv()])
    return uv


FIELD = '01-amp-deg2-0.2 01-min-span-1e-08 28-weight-one-1000 49-domain-1e+09-0.00100005 C4-span-triple-1e-3 C4-span-triple-1e-6 truth-tiny_1'.split()


def eval_surfaces(kind):
    if kind == 'field':                              # models of public bug reports, testdata/field
        for n, name in enumerate(FIELD):
            s = json.load(open(os.path.join(ROOT, 'testdata', 'field', name + '.json')))['surfaces'][0]
            yield name, s, random.Random('%d/%s/%d' % (SEED, kind, n))
        return
    for n in range(PER_KIND if kind in EVAL_KINDS else OWN[kind][1]):
        R = random.Random('%d/%s/%d' % (SEED, kind, n))
        yield '%s_%d' % (kind, n), (getattr(mc, 'g_' + kind) if kind in EVAL_KINDS else OWN[kind][0])(R, n), R


VECTORS = 'S Su Sv Suu Suv Svv normal'.split()
SCALARS = 'K H k1 k2'.split()


def floors(s):
    """unit of each quantity: the size of the net over the domain"""
    size = float(np.ptp(np.array(s['points']), axis=0).max()) or 1.0; u0, u1, v0, v1 = mc.domain(s); lu, lv = u1 - u0, v1 - v0
    return dict(S=size, Su=size / lu, Sv=size / lv, Suu=size / lu ** 2, Suv=size / lu / lv, Svv=size / lv ** 2, normal=1.0, K=size ** -2, H=1 / size, k1=1 / size, k2=1 / size)


def rounded(r, floor):
    """mpf -> nearest double; None stays; what is below 1e-35 of its unit is the rounding noise of an exact zero and becomes 0"""
    one = lambda x, k: 0.0 if abs(x) < 1e-35 * floor[k] else float(x)
    f = lambda k: None if r[k] is None else [one(c, k) for c in r[k]] if isinstance(r[k], list) else one(r[k], k)
    return {**{k: f(k) for k in VECTORS + SCALARS}, 'normal_kind': r['normal_kind']}


def same(a, b):
    """equal up to the last bit: an exact tie between two doubles may round either way"""
    if a['normal_kind'] != b['normal_kind']: return False
    flat = lambda x: [] if x is None else x if isinstance(x, list) else [x]
    return all(len(flat(a[k])) == len(flat(b[k])) and all(abs(x - y) <= math.ulp(x) for x, y in zip(flat(a[k]), flat(b[k]))) for k in VECTORS + SCALARS)


def difference(s, uv, a, b):
    """largest OpenCASCADE - mpmath of each quantity over the points, relative to its largest value, at least to its unit"""
    floor = floors(s); out = {}; u0, u1, v0, v1 = mc.domain(s)
    below = lambda x, k, length: any(0 < y - x <= 1e-9 * length + 4 * math.ulp(y) for y in k)      # there OpenCASCADE takes the span above
    ab = [(m, o) for (u, v), m, o in zip(uv, a, b) if not below(u, s['knots_u'], u1 - u0) and not below(v, s['knots_v'], v1 - v0)]
    for k in VECTORS + SCALARS:
        x = [(m[k], o[k]) for m, o in ab if m['normal_kind'] == 'regular' and o.get(k) is not None]
        if x:
            m, o = (np.array(y, float) for y in zip(*x))
            out[k] = float(np.abs(m - o).max() / max(floor[k], np.abs(m).max()))
    return out


def eval_kind(kind, folder):
    import mpmath as mp, oracle_eval as oe, occ_common as oc
    rows = []; worst = {}; kinds = {}; refused = 0
    for n, (name, s, R) in enumerate(eval_surfaces(kind)):
        mp.mp.dps = DIGITS
        uv = eval_uv(R, s); unit_of = floors(s); ans = [rounded(oe.eval_mp(s, u, v), unit_of) for u, v in uv]
        row = dict(name=name, kind=kind, surface=s, uv=uv)
        for k in VECTORS + ['normal_kind'] + SCALARS: row[k] = [a[k] for a in ans]
        rows.append(row)
        for k in row['normal_kind']: kinds[k] = kinds.get(k, 0) + 1
        mp.mp.dps = DIGITS + 30                      # the answers may not depend on the digits
        for i in range(0, len(uv), 7): assert same(rounded(oe.eval_mp(s, *uv[i]), unit_of), ans[i]), (name, uv[i])
        try: g = oc.to_occ_surface(s)
        except Exception: refused += 1; continue
        for k, e in difference(s, uv, ans, [oe.eval_occ(g, u, v) for u, v in uv]).items(): worst[k] = max(worst.get(k, (0.0, '')), (e, name))
    rows = [json.dumps(r, separators=(',', ':'), allow_nan=False) for r in rows]; parts = math.ceil(sum(map(len, rows)) / PART)
    for i in range(parts):
        name = os.path.join(folder, kind + ('_%d' % i if parts > 1 else '') + '.json')
        open(name, 'w').write('{"format":"isophote-oracle-eval","version":1,"digits":%d,"surfaces":[\n' % DIGITS + ',\n'.join(rows[i::parts]) + '\n]}\n')
    print('%-10s %3d surfaces %5d points %7d bytes %s' % (kind, len(rows), sum(kinds.values()), sum(map(len, rows)), kinds) + (' refused by OpenCASCADE: %d' % refused if refused else ''))
    print('           OpenCASCADE - mpmath: ' + ' '.join('%s %.1e (%s)' % (k, *worst[k]) for k in worst), flush=True)


# ---------------------------------------------------------------- rays: scenes

def basis(knots, p, n, x):
    """values of all n basis functions at the parameters x (last knot from below); an evaluator apart from oracle_eval.py and OpenCASCADE"""
    U = np.asarray(knots, float); x = np.clip(np.asarray(x, float), U[p], U[n])[:, None]
    last = max(i for i in range(n) if U[i] < U[i + 1])
    N = ((U[:-1] <= x) & (x < U[1:])).astype(float); N[(x[:, 0] >= U[n]), :] = 0; N[(x[:, 0] >= U[n]), last] = 1
    for q in range(1, p + 1):
        m = len(U) - q - 1; a = U[q:q + m] - U[:m]; b = U[q + 1:q + 1 + m] - U[1:1 + m]
        with np.errstate(divide='ignore', invalid='ignore'):
            N = np.where(a > 0, (x - U[:m]) / a, 0) * N[:, :m] + np.where(b > 0, (U[q + 1:q + 1 + m] - x) / b, 0) * N[:, 1:m + 1]
    return N


def points_at(s, u, v):
    A, B = basis(s['knots_u'], s['degree'][0], s['nu'], u), basis(s['knots_v'], s['degree'][1], s['nv'], v)
    w = np.ones(s['nu'] * s['nv']) if s.get('weights') is None else np.array(s['weights'], float)
    P = (np.array(s['points'], float) * w[:, None]).reshape(s['nu'], s['nv'], 3); W = w.reshape(s['nu'], s['nv'])
    return np.einsum('ki,kj,ijc->kc', A, B, P) / np.einsum('ki,kj,ij->k', A, B, W)[:, None]


def samples(surfaces, n=49):
    """n x n points and unit normals (by differences) of each surface, to place cameras with"""
    out = []
    for s in surfaces:
        u0, u1, v0, v1 = mc.domain(s); u, v = np.meshgrid(np.linspace(u0, u1, n), np.linspace(v0, v1, n), indexing='ij')
        X = points_at(s, u.ravel(), v.ravel()).reshape(n, n, 3); N = np.cross(np.gradient(X, axis=0), np.gradient(X, axis=1))
        with np.errstate(invalid='ignore', divide='ignore'): out.append((X, N / np.linalg.norm(N, axis=-1, keepdims=True)))
    return out


class Preview:
    """VTK ray cast of the sampled grids: how much of a view is grazing.  Chooses cameras, answers nothing."""

    def __init__(self, grids):
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        tri = []; b = 0
        for X, _ in grids:
            n = len(X); k = b + np.arange(n * n).reshape(n, n); b += n * n
            tri += [np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:]], -1).reshape(-1, 3), np.stack([k[:-1, :-1], k[1:, 1:], k[:-1, 1:]], -1).reshape(-1, 3)]
        self.points = np.concatenate([X.reshape(-1, 3) for X, _ in grids]); self.normals = np.nan_to_num(np.concatenate([N.reshape(-1, 3) for _, N in grids])); self.tri = np.concatenate(tri)
        lo, hi = self.points.min(0), self.points.max(0); self.mid = (lo + hi) / 2; self.size = float(np.linalg.norm(hi - lo))
        p = vtk.vtkPoints(); p.SetData(numpy_to_vtk((self.points - self.mid) / self.size, deep=True)); c = vtk.vtkCellArray()
        c.SetData(3, numpy_to_vtkIdTypeArray(self.tri.ravel().astype(np.int64), deep=True))
        self.data = vtk.vtkPolyData(); self.data.SetPoints(p); self.data.SetPolys(c); self.locator = vtk.vtkStaticCellLocator(); self.locator.SetDataSet(self.data); self.locator.BuildLocator()
        self.reference = vtk.reference

    def shares(self, cam, n=14):
        """(hit share, grazing share) of n x n rays"""
        from oracle_ray import camera
        o, d = (x.reshape(-1, 3) for x in camera(cam['eye'], cam['target'], cam['up'], n, n, cam.get('fov'), cam.get('ortho')))
        o = (o - self.mid) / self.size; t = self.reference(0.); i = self.reference(0); c = self.reference(0); x = [0, 0, 0]; w = [0, 0, 0]; hit = graze = 0
        for a, b in zip(o, d):
            if not self.locator.IntersectWithLine(a, a + b * (2 + 2 * np.linalg.norm(a)), 1e-12, t, x, w, i, c): continue
            hit += 1; m = np.array([1 - w[0] - w[1], w[0], w[1]]) @ self.normals[self.tri[int(c)]]; m /= np.linalg.norm(m) or 1.0
            graze += abs(m @ b) < GRAZING
        return hit / len(d), graze / len(d)


def unit(a): return a / np.linalg.norm(a)


def one_camera(R, view, grids, mid, size, axes, width, height):
    """one random camera of the view, or None; see camera_for"""
    name, _, lens = view.partition('/'); X = np.concatenate([x.reshape(-1, 3) for x, _ in grids])
    if name == 'low':
        a, e = R.uniform(0, 2 * math.pi), math.radians(R.uniform(1, 8)) * R.choice([-1, 1])
        back = math.cos(e) * (math.cos(a) * axes[0] + math.sin(a) * axes[1]) + math.sin(e) * axes[2]; up = axes[2]
    else:
        back = unit(np.array([R.gauss(0, 1) for _ in range(3)])); up = np.eye(3)[int(np.argmin(np.abs(back)))]
    up = np.round(up, 6); f = -back; r = unit(np.cross(f, up)); v = np.cross(r, f); fov = 30.0; k = math.tan(math.radians(fov) / 2); q = X - mid
    if name == 'skim':
        P, N = R.choice(grids); i = (R.randrange(len(P)), R.randrange(len(P))); n = N[i]; e = math.radians(R.uniform(2, 9)); dist = size * math.exp(R.uniform(math.log(.02), math.log(.4)))
        if not np.isfinite(n).all(): return None
        target = P[i]; back = math.cos(e) * unit(np.cross(n, back)) + math.sin(e) * n; eye = target + dist * back; up = np.round(n, 6); fov = R.uniform(6, 30); window = 2 * dist * math.tan(math.radians(fov) / 2)
    elif name == 'inside':
        eye = mid + .03 * size * back; target = eye + size * f; window = None; fov = 90.0
    else:
        dist = max(np.max(np.abs(q @ r) * height / width / k - q @ f), np.max(np.abs(q @ v) / k - q @ f)) * 1.03
        window = 2.06 * max(np.max(np.abs(q @ r)) * height / width, np.max(np.abs(q @ v))); eye, target = mid + dist * back, mid
        if name == 'rim':
            rim = []
            for P, N in grids:
                c = np.nan_to_num((N * (P - eye if lens != 'ortho' else f)).sum(-1))
                rim += list(P[:-1][c[:-1] * c[1:] < 0]) + list(P[:, :-1][c[:, :-1] * c[:, 1:] < 0])
            if not rim: return None
            target = rim[R.randrange(len(rim))]; window = size * math.exp(R.uniform(math.log(.01), math.log(.12)))
            if lens == 'ortho': eye = target + dist * back
            else: fov = math.degrees(2 * math.atan(window / 2 / np.linalg.norm(target - eye)))
    places = max(0, 6 - int(math.floor(math.log10(size)))); num = lambda a: [round(float(x), places) + 0.0 for x in a]
    cam = dict(eye=num(eye), target=num(target), up=[float(x) + 0.0 for x in up])
    if lens == 'ortho': cam['ortho'] = round(float(window), places)
    else: cam['fov'] = round(fov, 6)
    cam['size'] = [width, height]; return cam


def camera_for(R, view, surfaces, width, height):
    """view: look    the whole model from a random side
             low     the whole model from 1 to 8 degrees above its flattest plane
             rim     a window of 1 to 12 percent of the size on a silhouette point
             skim    close to a random surface point, along the surface at 2 to 9 degrees
             inside  from the middle of the model, wide angle
       then '/ortho' for an orthographic camera.  For low, rim and skim the one of many random cameras
       that Preview finds best: most grazing hits (more than 60 percent count no more), some misses.
       Numbers are rounded so that the scene's JSON is short.  Returns (camera, size) or None."""
    grids = samples(surfaces); see = Preview(grids); X = see.points; best = None
    axes = np.linalg.svd(X - X.mean(0), full_matrices=False)[2]          # rows: widest .. flattest direction
    for _ in range(dict(look=1, inside=1, low=12, rim=60, skim=60)[view.partition('/')[0]]):
        cam = one_camera(R, view, grids, see.mid, see.size, axes, width, height)
        if cam is None: continue
        hit, graze = see.shares(cam); score = min(graze, .6) + (.1 if .1 < hit < .95 else 0)
        if best is None or score > best[0]: best = score, cam
    return best and (best[1], see.size)


def plain(x):
    """a decimal without exponent that reads back as the same double"""
    return np.format_float_positional(x, trim='-')


NEWELL = ['teapot', 'teaspoon']
SIZE = (24, 24)
# model -> views.  <kind>_<n> is the case of that name that make_cases.py --seed 1 makes
SCENES = {
    'teapot': 'look look/ortho low low/ortho rim rim rim/ortho skim skim skim/ortho inside',
    'teaspoon': 'look low low/ortho rim rim/ortho skim skim/ortho',
    'fold_0': 'look rim skim', 'fold_1': 'low/ortho rim/ortho', 'fold_2': 'rim skim/ortho', 'fold_3': 'look/ortho low skim',
    'pole_0': 'low rim', 'pole_1': 'look skim/ortho', 'pole_2': 'low skim', 'pole_3': 'look/ortho rim/ortho',
    'quadric_0': 'look rim', 'quadric_1': 'look/ortho rim skim', 'quadric_2': 'look rim rim/ortho skim', 'quadric_3': 'look rim rim/ortho', 'quadric_4': 'look rim inside', 'quadric_5': 'low rim/ortho skim',
    'weights_0': 'low skim/ortho rim', 'weights_2': 'look skim', 'weights_3': 'low/ortho rim/ortho',
    'knots_0': 'look rim', 'knots_3': 'low/ortho rim skim', 'unclamped_0': 'look skim', 'unclamped_2': 'low/ortho rim',
    'periodic_0': 'look rim', 'periodic_1': 'look/ortho rim/ortho', 'periodic_2': 'look rim skim inside',
    'mixed_0': 'low skim', 'mixed_1': 'look/ortho rim', 'mixed_2': 'low/ortho skim/ortho',
    'huge_0': 'look skim', 'huge_1': 'look rim', 'huge_3': 'low skim/ortho', 'bezier_1': 'low rim', 'bezier_3': 'low/ortho rim skim',
}
BIG = 1e6            # size from which OpenCASCADE's intersector, whose tolerances are absolute, loses nearly all hits: asked about a smaller copy
TIMEOUT = 600        # seconds a scene
GRAZING = .2         # |n.d| below which a hit counts as grazing
MESH = 1e-4          # chord error of the comparison mesh over the model's size
MESH_OF = {**dict.fromkeys('teapot teaspoon fold_0 fold_1 quadric_2 quadric_3'.split(), 2e-5), 'quadric_4': 5e-4}     # what OpenCASCADE's mesher bears


def check_hits(surfaces, o, d, face, t, u, v):
    """largest |S(u,v) - (o + t d)| over the hits, by points_at: proves that `face` indexes `surfaces`"""
    e = 0.0
    for k in np.unique(face):
        m = face == k; e = max(e, float(np.linalg.norm(points_at(surfaces[k], u[m], v[m]) - o[m] - t[m, None] * d[m], axis=-1).max()))
    return e


def digits(x, n): return float('%.*g' % (n, x)) + 0.0


def ray_scene(name, reference, surfaces, cam, size, path, jobs, source, mesh):
    neutral = source or os.path.join(os.path.dirname(path), reference)
    unit = 2.0 ** round(math.log2(size)) if size > BIG else 1.0          # a power of two: the smaller model is the same to the last bit
    with tempfile.TemporaryDirectory() as tmp:
        if unit != 1.0:
            neutral = os.path.join(tmp, 'm.json'); json.dump(dict(surfaces=[{**s, 'points': [[c / unit for c in x] for x in s['points']]} for s in surfaces]), open(neutral, 'w'))
        npz = os.path.join(tmp, 'o.npz'); arg = [sys.executable, os.path.join(HERE, 'oracle_ray.py'), neutral, '-o', npz, '--jobs', str(jobs), '--mesh', plain(mesh * size / unit), '--size', *map(str, cam['size'])]
        for k in ('eye', 'target', 'up'): arg += ['--' + k, *(plain(x / (1.0 if k == 'up' else unit)) for x in cam[k])]
        arg += ['--ortho', plain(cam['ortho'] / unit)] if 'ortho' in cam else ['--fov', plain(cam['fov'])]
        try: run = subprocess.run(arg, capture_output=True, text=True, timeout=TIMEOUT)
        except subprocess.TimeoutExpired: print(name, 'FAILED: %d s' % TIMEOUT, flush=True); return None
        if run.returncode: print(name, 'FAILED', run.stderr[-300:], flush=True); return None
        z = np.load(npz); meta = json.loads(str(z['meta'])); z = {k: z[k] for k in z.files}
    hit = z['hit'].ravel() == 1; suspect = z['suspect'].ravel(); d = z['dirs'].reshape(-1, 3); o = np.broadcast_to(z['origins'], z['dirs'].shape).reshape(-1, 3)
    get = lambda k: z[k].reshape(len(hit), *z[k].shape[2:])[hit]
    o = o * unit; face, t, u, v, N = (get(k) for k in ('face', 't', 'u', 'v', 'normal')); t = t * unit; reach = max(np.abs(np.array(s['points'])).max() for s in surfaces) + np.abs(np.array(cam['eye'])).max()
    e = check_hits(surfaces, o[hit], d[hit], face, t, u, v) if hit.any() else 0.0
    assert e <= 1e-8 * size + 1e-14 * reach, (name, e, size)
    if len(u) > 1: assert check_hits(surfaces, o[hit], d[hit], face, t, u[::-1], v[::-1]) > 1e-6 * size       # the check can fail
    cos = np.abs((N * d[hit]).sum(-1)); graze = int((cos < GRAZING).sum())
    out = dict(format='isophote-oracle-rays', version=1, name=name, model=reference, camera=cam, rays=dict(
        hit=[int(x) for x in hit], suspect=[int(x) for x in suspect], face=[int(x) for x in face], t=[digits(x, 14) for x in t], u=[digits(x, 12) for x in u], v=[digits(x, 12) for x in v],
        normal=[[digits(c, 9) for c in n] if np.isfinite(n).all() else None for n in N]))
    text = json.dumps(out, separators=(',', ':'), allow_nan=False).replace(',"rays":{', ',\n"rays":{')
    for k in ('suspect', 'face', 't', 'u', 'v', 'normal'): text = text.replace(',"%s":[' % k, ',\n"%s":[' % k)
    open(path, 'w').write(text + '\n')
    at = suspect[hit] == 1
    r = dict(rays=len(hit), hits=int(hit.sum()), grazing=graze, suspect=int(suspect.sum()), suspect_grazing=int((at & (cos < GRAZING)).sum()), repaired=int(meta['repaired_miss'] + meta['repaired_far']),
             exact_only=meta['exact_only'], mesh_only=meta['mesh_only'], edge=edge_rays(z['hit'] == 1, z['t'] * unit, size))
    print('%-22s rays %5d hits %5d grazing %5d edge %4d suspect %4d (exact only %d, mesh only %d, t %d; grazing %d) repaired %d (missed %d) residual/size %.1e cast %.0f s %d bytes' % (
        name, r['rays'], r['hits'], graze, r['edge'], r['suspect'], meta['exact_only'], meta['mesh_only'], meta['t_far'], r['suspect_grazing'], r['repaired'], meta['repaired_miss'], e / size, meta['cast_s'], len(text)), flush=True)
    return r


def edge_rays(hit, t, size):
    """rays that a neighbour within 2 pixels contradicts: hit against miss, or t apart by more than 2 percent of the size"""
    H, W = hit.shape; e = np.zeros((H, W), bool); t = np.where(hit, t, 1e300)
    for dy in range(-2, 3):
        for dx in range(-2, 3):
            a = (slice(max(0, dy), H + min(0, dy)), slice(max(0, dx), W + min(0, dx))); b = (slice(max(0, -dy), H + min(0, -dy)), slice(max(0, -dx), W + min(0, -dx)))
            e[a] |= np.abs(t[a] - t[b]) > .02 * size
    return int(e.sum())


def rays(out, models, jobs, only):
    os.makedirs(os.path.join(out, 'models'), exist_ok=True); total = {}
    for model, views in ((m, v.split()) for m, v in SCENES.items()):
        if only and not any(x == model or x.startswith(model + '-') for x in only): continue
        if model in NEWELL:
            src = os.path.join(models, model + '.json'); surfaces = json.load(open(src))['surfaces']; reference = '../../models/%s.json' % model
        else:
            kind, n = model.split('_'); s = getattr(mc, 'g_' + kind)(random.Random('1/%s/%s' % (kind, n)), int(n)); surfaces = [s]; reference = 'models/%s.json' % model
            with open(os.path.join(out, reference), 'w') as f:
                json.dump(dict(format='nurbs-neutral', version=1, name=model, surfaces=surfaces, faces=[dict(surface=0, reversed=False, tolerance=0.0, loops=[])]), f, separators=(',', ':')); f.write('\n')
        for n, view in enumerate(views):
            name = '%s-%d' % (model, n)
            if only and name not in only and model not in only: continue
            made = camera_for(random.Random('%d/%s/%d' % (SEED, model, n)), view, surfaces, *SIZE)
            if made is None: print(name, view, 'has no silhouette', flush=True); continue
            r = ray_scene(name, reference, surfaces, *made, os.path.join(out, name + '.json'), jobs, src if model in NEWELL else None, MESH_OF.get(model, MESH))
            if r:
                for k, x in r.items(): total[k] = total.get(k, 0) + x
    print('TOTAL', json.dumps(total), 'grazing/rays %.3f grazing/hits %.3f' % (total['grazing'] / total['rays'], total['grazing'] / total['hits']))


def main():
    ap = argparse.ArgumentParser(usage=__doc__); ap.add_argument('out', nargs='?', default=os.path.join(ROOT, 'testdata', 'oracle')); ap.add_argument('--only', choices=['eval', 'rays']); ap.add_argument('--models', default=os.path.join(ROOT, 'testdata', 'models'))
    ap.add_argument('--jobs', type=int, default=2); ap.add_argument('--scenes'); ap.add_argument('--kinds'); a = ap.parse_args()
    if a.only != 'rays':
        os.makedirs(os.path.join(a.out, 'eval'), exist_ok=True)
        for kind in a.kinds.split(',') if a.kinds else EVAL_KINDS + list(OWN) + ['field']: eval_kind(kind, os.path.join(a.out, 'eval'))
    if a.only != 'eval': rays(os.path.join(a.out, 'rays'), a.models, a.jobs, a.scenes and a.scenes.split(','))


if __name__ == '__main__': main()
