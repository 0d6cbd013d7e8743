"""Classification of points against closed loops of NURBS curves in the plane, by mathematics alone.

Two ways that share nothing but the definition of a B-spline: crossings of a ray with Bezier segments that are
subdivided until their hulls decide (f64, numba; also the distance), and the sum of angles along the curve itself
(mpmath).  Loops are lists of trims of the neutral JSON (occ_common.py).
"""
import numpy as np
import mpmath as mp
from numba import njit

MAX_DEGREE = 15
DEPTH = 60           # halvings: beyond f64's digits
SLACK = 1e-3         # distances are at most this share too large


def blossom(knots, points, span, args):
    """the polar form of the span's polynomial at args (as many as the degree), by de Boor's algorithm"""
    p = len(args)
    d = [list(points[j + span - p]) for j in range(p + 1)]
    for r in range(1, p + 1):
        x = args[r - 1]
        for j in range(p, r - 1, -1):
            a, b = knots[j + span - p], knots[j + 1 + span - r]
            f = (x - a) / (b - a)
            d[j] = [(1 - f) * s + f * t for s, t in zip(d[j - 1], d[j])]
    return d[p]


def homogeneous(trim, number=float):
    w = trim.get('weights') or [1.0] * len(trim['points'])
    return [[number(x) * number(c), number(y) * number(c), number(c)] for (x, y), c in zip(trim['points'], w)]


def spans(trim):
    k, p, n = trim['knots'], trim['degree'], len(trim['points'])
    return [i for i in range(p, n) if k[i] < k[i + 1]]


def beziers(trim):
    """homogeneous control points of the Bezier segments, in the order of the loop"""
    k, p, H = trim['knots'], trim['degree'], homogeneous(trim)
    out = [[blossom(k, H, s, [k[s]] * (p - i) + [k[s + 1]] * i) for i in range(p + 1)] for s in spans(trim)]
    return [b[::-1] for b in out[::-1]] if trim.get('reversed') else out


def ends(trim):
    b = beziers(trim); a, z = b[0][0], b[-1][-1]
    return [a[0] / a[2], a[1] / a[2]], [z[0] / z[2], z[1] / z[2]]


def segments(loops, box):
    """all segments of loops, in shares of the box [[u0, su], [v0, sv]], padded to one array; gaps become lines"""
    (u0, su), (v0, sv) = box; out = []; degree = []; gaps = []
    for loop in loops:
        trims = loop['trims']
        for i, t in enumerate(trims):
            for b in beziers(t):
                out.append(b); degree.append(t['degree'])
            a, z = ends(t)[1], ends(trims[(i + 1) % len(trims)])[0]
            if a != z:
                out.append([a + [1.0], z + [1.0]]); degree.append(1)
                gaps.append([(z[0] - u0) / su, (z[1] - v0) / sv, float(np.hypot((a[0] - z[0]) / su, (a[1] - z[1]) / sv))])
    S = np.zeros((len(out), MAX_DEGREE + 1, 3))
    for k, b in enumerate(out):
        h = np.array(b, float)
        S[k, :len(b), 0] = (h[:, 0] - u0 * h[:, 2]) / su; S[k, :len(b), 1] = (h[:, 1] - v0 * h[:, 2]) / sv; S[k, :len(b), 2] = h[:, 2]
    return S, np.array(degree, np.int64), np.array(gaps).reshape(-1, 3)


@njit
def _split(s, n, left, right):
    w = s.copy()
    for r in range(n + 1):
        for c in range(3):
            left[r, c] = w[0, c]; right[n - r, c] = w[n - r, c]
        for i in range(n - r):
            for c in range(3): w[i, c] = .5 * (w[i, c] + w[i + 1, c])


@njit
def _hull(s, n):
    x0 = x1 = s[0, 0] / s[0, 2]; y0 = y1 = s[0, 1] / s[0, 2]
    for i in range(1, n + 1):
        x = s[i, 0] / s[i, 2]; y = s[i, 1] / s[i, 2]
        x0 = min(x0, x); x1 = max(x1, x); y0 = min(y0, y); y1 = max(y1, y)
    return x0, x1, y0, y1


@njit
def classify(S, degree, P):
    """winding number and distance of every point of P (shares of the box)"""
    W = np.zeros(len(P), np.int64); D = np.empty(len(P))
    stack = np.empty((2 * DEPTH + 4, MAX_DEGREE + 1, 3)); depth = np.empty(2 * DEPTH + 4, np.int64)
    left = np.empty((MAX_DEGREE + 1, 3)); right = np.empty((MAX_DEGREE + 1, 3))
    H = np.empty((len(S), 4))
    for k in range(len(S)):
        H[k, 0], H[k, 1], H[k, 2], H[k, 3] = _hull(S[k], degree[k])
    for q in range(len(P)):
        px = P[q, 0]; py = P[q, 1]; w = 0; best = np.inf
        for k in range(len(S)):
            n = degree[k]
            # crossings of the ray to the right; "below" is y <= py
            if not (H[k, 3] <= py or H[k, 2] > py or H[k, 1] < px):
                top = 0; stack[0] = S[k]; depth[0] = 0
                while top >= 0:
                    s = stack[top].copy(); d = depth[top]; top -= 1
                    x0, x1, y0, y1 = _hull(s, n)
                    if y1 <= py or y0 > py or x1 < px: continue
                    if x0 > px or d >= DEPTH or n == 1 and d > 0 and x1 - x0 < 1e-300:
                        if x0 > px or .5 * (x0 + x1) > px:
                            w += int(s[n, 1] / s[n, 2] > py) - int(s[0, 1] / s[0, 2] > py)
                        continue
                    _split(s, n, left, right)
                    stack[top + 1] = right; stack[top + 2] = left; depth[top + 1] = depth[top + 2] = d + 1; top += 2
            # distance, branch and bound
            top = 0; stack[0] = S[k]; depth[0] = 0
            while top >= 0:
                s = stack[top].copy(); d = depth[top]; top -= 1
                x0, x1, y0, y1 = _hull(s, n)
                dx = max(max(x0 - px, px - x1), 0.0); dy = max(max(y0 - py, py - y1), 0.0)
                if dx * dx + dy * dy >= (1 - SLACK) * best * best: continue
                for e in (0, n):
                    ex = s[e, 0] / s[e, 2] - px; ey = s[e, 1] / s[e, 2] - py
                    best = min(best, np.sqrt(ex * ex + ey * ey))
                size = max(x1 - x0, y1 - y0)
                if d >= DEPTH or size <= 1e-15: continue
                _split(s, n, left, right)
                stack[top + 1] = right; stack[top + 2] = left; depth[top + 1] = depth[top + 2] = d + 1; top += 2
        W[q] = w; D[q] = best
    return W, D


def winding_by_angles(loops, q, shifts=((0, 0),), digits=40):
    """the winding number of the curves themselves about q, by adding angles in mpmath; gaps become lines"""
    with mp.workdps(digits):
        total = mp.mpf(0)
        for du, dv in shifts:
            x, y = mp.mpf(q[0]) + du, mp.mpf(q[1]) + dv
            for loop in loops:
                last = first = None
                for t in loop['trims']:
                    k = [mp.mpf(a) for a in t['knots']]; H = homogeneous(t, mp.mpf); p = t['degree']; pieces = spans(t)
                    rev = bool(t.get('reversed'))
                    for s in pieces[::-1] if rev else pieces:
                        at = lambda f: (lambda h: mp.mpc(h[0] / h[2] - x, h[1] / h[2] - y))(
                            blossom(k, H, s, [k[s] + ((1 - f) if rev else f) * (k[s + 1] - k[s])] * p))
                        f = mp.mpf(0); a = at(f); first = a if first is None else first
                        if last is not None and last != a: total += mp.arg(a / last)
                        step = mp.mpf(1) / 8
                        while f < 1:
                            step = min(step, 1 - f)
                            b = at(f + step); m = at(f + step / 2)
                            # small against the distance at both halves: the angle cannot have gone about
                            if abs(b - a) + abs(m - a) < .7 * min(abs(a), abs(b), abs(m)):
                                total += mp.arg(b / a); a = b; f += step; step *= 2
                            else: step /= 2
                            if step < mp.mpf(2) ** -80: return None
                        last = a
                if last != first: total += mp.arg(first / last)
        w = total / (2 * mp.pi)
        return int(mp.nint(w)) if abs(w - mp.nint(w)) < mp.mpf(10) ** -20 else None
