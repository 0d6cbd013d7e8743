"""Seeded random trimmed faces: make_face(n) is the n-th.  Loops are simple and disjoint by construction."""
import math, random
import numpy as np
import planar

SEED = 4711
ROOT_HALF = math.sqrt(.5)
KINDS = 'plane bicubic rational cylinder-split cylinder-window cylinder-patch sphere-cap sphere-patch'.split()
digits = lambda x: round(x, 5) + 0.0
point = lambda x, y: [digits(x), digits(y)]


# ---------------------------------------------------------------- curves

def trim(degree, knots, points, weights=None, reversed=False, seam=False, degenerate=False, edge=None):
    return dict(degree=degree, knots=[float(k) for k in knots], points=points, weights=weights, reversed=reversed, seam=seam, degenerate=degenerate, edge=edge)


def clamped(p, n):
    return [0.0] * (p + 1) + [float(i) for i in range(1, n - p)] + [float(n - p)] * (p + 1)


def line(a, b, **more): return trim(1, [0, 0, 1, 1], [a, b], **more)


def bezier(points, weights=None): return trim(len(points) - 1, clamped(len(points) - 1, len(points)), points, weights)


def polygon(P): return [line(a, b) for a, b in zip(P, P[1:] + P[:1])]


def backwards(trims):
    return [dict(t, reversed=not t['reversed']) for t in trims[::-1]]


def flipped(t):
    """the same path from a curve that runs the other way"""
    k = t['knots']; s = k[0] + k[-1]
    return dict(t, knots=[s - x for x in k[::-1]], points=t['points'][::-1], weights=t['weights'] and t['weights'][::-1], reversed=not t['reversed'])


def shape(R, c, r):
    """a counter-clockwise closed chain about c, star-shaped, within radii r; what it is and its trims.

    A control polygon that is star-shaped about c makes a star-shaped curve: no line meets a B-spline with positive
    weights more often than its control polygon, so that no line through c meets the curve more than twice.
    """
    kind = R.choice('spline spline spline rational ellipse polygon star pieces unclamped conics'.split()); n = R.randint(5, 11)
    turn = R.uniform(0, 2 * math.pi)
    at = lambda i, m, f: point(c[0] + r[0] * f * math.cos(turn + 2 * math.pi * i / m), c[1] + r[1] * f * math.sin(turn + 2 * math.pi * i / m))
    ring = lambda m, lo=.45: [at(i + R.uniform(-.3, .3), m, R.uniform(lo, 1)) for i in range(m)]
    if kind in ('spline', 'rational', 'pieces'):
        p = R.randint(1, 5) if kind != 'pieces' else R.randint(2, 3); P = ring(max(n, p + 2) if kind != 'pieces' else 6); P = P + P[:1]
        w = [round(math.exp(R.uniform(-1.2, 1.2)), 3) for _ in P[1:]] if kind == 'rational' else None
        trims = [trim(p, clamped(p, len(P)), P, w and w + w[:1])]
        if kind == 'pieces':
            B = [[point(x / z, y / z) for x, y, z in b] for b in planar.beziers(trims[0])]
            for a, b in zip(B, B[1:] + B[:1]): b[0] = a[-1]
            trims = [bezier(b) for b in B]
    elif kind == 'unclamped':
        p = R.randint(2, 5); P = ring(max(n, p + 3)); m = len(P)
        trims = [trim(p, range(m + 2 * p + 1), P + P[:p])]
    elif kind == 'ellipse':
        turn = R.choice([0.0, turn]); f = R.uniform(.5, 1)
        corner = lambda i: [c[0] + .7 * (r[0] * ((1, 1, 0, -1, -1, -1, 0, 1)[i % 8]) * f), c[1] + .7 * (r[1] * ((0, 1, 1, 1, 0, -1, -1, -1)[i % 8]))]
        q = [corner(i) for i in range(8)]; cs, sn = math.cos(turn) if r[0] == r[1] else 1.0, math.sin(turn) if r[0] == r[1] else 0.0
        q = [point(c[0] + cs * (x - c[0]) - sn * (y - c[1]), c[1] + sn * (x - c[0]) + cs * (y - c[1])) for x, y in q]
        trims = [trim(2, [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], q + q[:1], [1.0, ROOT_HALF] * 4 + [1.0])]
    elif kind in ('polygon', 'star'):
        P = ring(n) if kind == 'polygon' else [at(i, 2 * n, 1.0 if i % 2 else R.uniform(.35, .6)) for i in range(2 * n)]
        # one line a side, or all of it one curve of degree 1
        trims = polygon(P) if R.random() < .3 else [trim(1, clamped(1, len(P) + 1), P + P[:1])]
    else:
        P = ring(min(n, 6), .7); mid = [point((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in zip(P, P[1:] + P[:1])]
        trims = [bezier([a, q, b], [1.0, round(R.uniform(.4, 2.5), 3), 1.0]) for a, q, b in zip(mid[-1:] + mid[:-1], P, mid)]
    return kind, [flipped(t) if R.random() < .3 else t for t in trims]


# ---------------------------------------------------------------- surfaces

def circle(): return [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]], [1.0, ROOT_HALF] * 4 + [1.0]


def revolved(profile, box, knots_v, q):
    (u0, su), _ = box; C, W = circle(); points = []; weights = []
    for (x, y), w in zip(C, W):
        for rad, z, wp in profile: points.append([rad * x, rad * y, z]); weights.append(w * wp)
    ku = [u0 + su * k for k in (0, 0, 0, .25, .25, .5, .5, .75, .75, 1, 1, 1)]
    return dict(degree=[2, q], knots_u=ku, knots_v=knots_v, nu=9, nv=len(profile), points=points, weights=weights)


def surface(R, kind, box):
    (u0, su), (v0, sv) = box
    if kind.startswith('cylinder'): return revolved([[1.0, -1.0, 1.0], [1.0, 1.0, 1.0]], box, [v0, v0, v0 + sv, v0 + sv], 1)
    if kind.startswith('sphere'):
        return revolved([[0.0, -1.0, 1.0], [1.0, -1.0, ROOT_HALF], [1.0, 0.0, 1.0], [1.0, 1.0, ROOT_HALF], [0.0, 1.0, 1.0]], box, [v0 + sv * k for k in (0, 0, 0, .5, .5, 1, 1, 1)], 2)
    p, n = dict(plane=(1, 2), bicubic=(3, R.randint(4, 6)), rational=(2, R.randint(3, 5)))[kind]
    knots = lambda a, s: [a + s * k / (n - p) for k in clamped(p, n)]
    aspect = su / sv
    P = [[digits(2 * i / (n - 1) * aspect), digits(2 * j / (n - 1)), 0.0 if kind == 'plane' else digits(R.uniform(-.3, .3))] for i in range(n) for j in range(n)]
    return dict(degree=[p, p], knots_u=knots(u0, su), knots_v=knots(v0, sv), nu=n, nv=n, points=P, weights=[round(R.uniform(.5, 2), 3) for _ in P] if kind == 'rational' else None)


# ---------------------------------------------------------------- faces

def inner_loops(R, cells, size, nested):
    """a loop in most cells; where nested, some have an island, and some of those a hole again"""
    loops = []; names = []
    for c in cells:
        if R.random() < .45 and loops: continue
        r = [.5 * s * R.uniform(.55, .95) for s in size]; depth = 1
        for level in range(R.choice([1, 2, 3]) if nested else 1):
            kind, trims = shape(R, c, r); names.append(kind)
            loops.append(dict(outer=False, trims=backwards(trims) if level % 2 == 0 else trims))
            # the next level lies inside: within the circle that the curve leaves free
            b = np.vstack([sample(t) for t in trims]); free = np.min(np.hypot((b[:, 0] - c[0]) / r[0], (b[:, 1] - c[1]) / r[1]))
            if free < .2: break
            r = [x * free * .85 for x in r]
    return loops, names


def sample(t, n=24):
    return np.vstack([bernstein(np.array(b), np.linspace(0, 1, n)) for b in planar.beziers(t)])


def bernstein(b, x):
    p = len(b) - 1; B = np.array([math.comb(p, i) * x ** i * (1 - x) ** (p - i) for i in range(p + 1)]).T; h = B @ b
    return h[:, :2] / h[:, 2:]


def grid(box, g, shift=(0, 0)):
    (u0, su), (v0, sv) = box
    return [[u0 + su * ((i + .5) / g + shift[0]), v0 + sv * ((j + .5) / g + shift[1])] for i in range(g) for j in range(g)], [su / g, sv / g]


def natural(box):
    (u0, su), (v0, sv) = box; a, b, c, d = [u0, v0], [u0 + su, v0], [u0 + su, v0 + sv], [u0, v0 + sv]
    return a, b, c, d


def make_face(n):
    """(kind, box, surface, loops, period in u or 0, whether OpenCASCADE must be asked loop by loop, names of shapes)"""
    R = random.Random('%d/%d' % (SEED, n)); kind = KINDS[n % len(KINDS)]; nested = R.random() < .3
    box = R.choice([[0, 1], [0, 1], [-1, 2], [2.5, .5], [-64, 100]]), R.choice([[0, 1], [0, 1], [-3, 4], [10, 1], [0, .25]])
    box = [[float(x) for x in b] for b in box]; (u0, su), (v0, sv) = box
    S = surface(R, kind, box); a, b, c, d = natural(box); period = 0.0; single = nested; names = []
    seam = lambda p, q: line(p, q, seam=True, edge=1)
    if kind in ('plane', 'bicubic', 'rational'):
        if R.random() < .5:
            outer = polygon([a, b, c, d]); inside = box; g = R.randint(2, 3)
        else:
            name, outer = shape(R, [u0 + su / 2, v0 + sv / 2], [.48 * su, .48 * sv]); names.append('outer ' + name)
            q = np.vstack([sample(t) for t in outer]); free = .98 * np.min(np.hypot((q[:, 0] - u0) / su - .5, (q[:, 1] - v0) / sv - .5)) / math.sqrt(2)
            inside = [[u0 + su * (.5 - free), 2 * su * free], [v0 + sv * (.5 - free), 2 * sv * free]]; g = R.randint(1, 3)
        cells, size = grid(inside, g); loops, more = inner_loops(R, cells, size, nested)
    elif kind == 'cylinder-split':
        # a window across the seam, cut in two by it: the boundary goes round each half
        lo, hi, w, e = v0 + sv * R.uniform(.2, .4), v0 + sv * R.uniform(.6, .8), su * R.uniform(.05, .15), su * R.uniform(.05, .15)
        lo, hi = digits(lo), digits(hi); m = (hi - lo) / 3; u1 = u0 + su
        west = bezier([[u1, lo], point(u1 - w, lo), point(u1 - w, lo + 2 * m), [u1, hi]])
        east = bezier([[u0, hi], point(u0 + e, hi - m), point(u0 + e, lo), [u0, lo]], [1.0, 1.5, .7, 1.0])
        outer = [line(a, b), seam(b, [u1, lo]), west, seam([u1, hi], c), line(c, d), seam(d, [u0, hi]), east, seam([u0, lo], a)]
        cells, size = grid([[u0 + .2 * su, .6 * su], box[1]], R.randint(2, 3)); loops, more = inner_loops(R, cells, size, nested)
    elif kind == 'cylinder-window':
        # windows across the seam as single loops, whose parameters leave the domain on one side or the other
        period = su; single = True; outer = [line(a, b), seam(b, c), line(c, d), seam(d, a)]
        g = R.randint(2, 3); cells, size = grid(box, g, (.5 / g, 0)); cells = [[x - su if x > u0 + su - size[0] / 4 and R.random() < .5 else x, y] for x, y in cells]
        loops, more = inner_loops(R, cells, size, nested)
    elif kind in ('cylinder-patch', 'sphere-patch'):
        # a patch across the seam: its own outer loop leaves the domain
        period = su; side = R.choice([0.0, 1.0]); center = [u0 + su * (side + R.uniform(-.1, .1)), v0 + sv / 2]; r = [.4 * su, .45 * sv]
        name, outer = shape(R, center, r); names.append('outer ' + name)
        q = np.vstack([sample(t) for t in outer]); free = .98 * np.min(np.hypot((q[:, 0] - center[0]) / r[0], (q[:, 1] - center[1]) / r[1])) / math.sqrt(2)
        cells, size = grid([[center[0] - free * r[0], 2 * free * r[0]], [center[1] - free * r[1], 2 * free * r[1]]], R.randint(1, 2)); loops, more = inner_loops(R, cells, size, nested)
    else:
        # round the pole at the end of v: rim, seam, pole, seam
        n_rim = R.randint(6, 10); low = R.uniform(.15, .35)
        rim = [point(u0 + su * i / n_rim, v0 + sv * (low + R.uniform(-.1, .1))) for i in range(n_rim + 1)]; rim[-1] = [u0 + su, rim[0][1]]
        p = R.randint(1, 5)
        outer = [trim(p, clamped(p, len(rim)), rim), seam(rim[-1], c), line(c, d, degenerate=True, edge=2), seam(d, rim[0])]
        if R.random() < .5: # the other pole
            mirror = lambda q: [q[0], 2 * v0 + sv - q[1]]
            outer = backwards([dict(t, points=[mirror(q) for q in t['points']]) for t in outer]); inside = [v0, .5 * sv]
        else: inside = [v0 + .5 * sv, .5 * sv]
        cells, size = grid([box[0], inside], R.randint(2, 3)); loops, more = inner_loops(R, cells, size, nested)
    return kind, box, S, [dict(outer=True, trims=outer)] + loops, period, single, names + more
