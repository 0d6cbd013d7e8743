#!/usr/bin/env python3
"""make_bicubic.py [OUTFILE]

Writes testdata/oracle/bicubic.json: five Bezier patches, the bicubic patch that stands for each, and the greatest
distance between both at equal parameters.  README.md beside this file documents the format.

All is derived anew from the definition: both factors of the tangents of a line by least squares over Gauss points in
40 digits (exact for these degrees), the distance on a grid of 513 x 513 in f64 by Bernstein polynomials, then uphill
from the best place in 40 digits.  Seeded: a second run writes the same file.
"""
import json, os, random, sys
import mpmath as mp
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
mp.mp.dps = 40
LEAST = mp.mpf(1) / 4        # of a factor
GRID = 512
PATCHES = [(4, 4, False), (5, 7, True), (9, 3, True), (2, 6, False), (8, 9, False)]


def bernstein(p, t):
    return [mp.binomial(p, i) * t ** i * (1 - t) ** (p - i) for i in range(p + 1)]


def curve(line, t):
    return sum((b * c for b, c in zip(bernstein(len(line) - 1, t), line)), mp.zeros(4, 1))


def nodes(count):
    """Gauss-Legendre over 0 to 1, exact to degree 2 count - 1."""
    x, w = np.polynomial.legendre.leggauss(count)
    out = []
    for guess in x:
        root = mp.findroot(lambda t: mp.legendre(count, t), mp.mpf(float(guess)))
        slope = count * (mp.legendre(count - 1, root) - root * mp.legendre(count, root)) / (1 - root ** 2)
        out.append(((1 + root) / 2, 1 / ((1 - root ** 2) * slope ** 2)))
    return out


NODES = nodes(14)


def cubic(line):
    """The cubic for a line of homogeneous points: least squares over the factors, or the same points raised."""
    p = len(line) - 1
    if p <= 3:
        # The cubic through the line at four parameters.
        ts = [mp.mpf(k) / 3 for k in range(4)]
        m = mp.matrix([bernstein(3, t) for t in ts])
        values = mp.matrix([[x for x in curve(line, t)] for t in ts])
        rows = mp.lu_solve(m, values[:, 0]), mp.lu_solve(m, values[:, 1]), mp.lu_solve(m, values[:, 2]), mp.lu_solve(m, values[:, 3])
        return [mp.matrix([rows[c][k] for c in range(4)]) for k in range(4)]
    points = [[c[k] / c[3] for k in range(3)] for c in line]
    low, high = ([f(x[k] for x in points) for k in range(3)] for f in (min, max))
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    reach = mp.sqrt(sum((b - a) ** 2 for a, b in zip(low, high))) / 2

    def about(c):
        return mp.matrix([c[k] - middle[k] * c[3] for k in range(3)] + [c[3] * reach])
    tangents = [(line[1] - line[0]) * p / 3, (line[-2] - line[-1]) * p / 3]

    def stand_in(factors):
        return [line[0], line[0] + tangents[0] * factors[0], line[-1] + tangents[1] * factors[1], line[-1]]

    def squares(factors):
        q = stand_in(factors)
        return sum(w * sum(x ** 2 for x in about(curve(line, t) - curve(q, t))) for t, w in NODES)

    # A quadratic in both factors: its six coefficients from six values, then its least value among those allowed.
    f = {k: squares(k) for k in [(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)]}
    a, b = ((f[k2] - 2 * f[k1] + f[0, 0]) / 2 for k1, k2 in [((1, 0), (2, 0)), ((0, 1), (0, 2))])
    d, e = f[1, 0] - f[0, 0] - a, f[0, 1] - f[0, 0] - b
    c = f[1, 1] - f[0, 0] - a - b - d - e
    free = mp.lu_solve(mp.matrix([[2 * a, c], [c, 2 * b]]), mp.matrix([-d, -e]))
    if min(free) >= LEAST:
        return stand_in(free)
    edges = [(LEAST, max(LEAST, -(e + c * LEAST) / (2 * b))), (max(LEAST, -(d + c * LEAST) / (2 * a)), LEAST)]
    return stand_in(min(edges, key=squares))


def bicubic(net):
    """Lines along u, then along v; net[i][j] is a column of four."""
    lines = [cubic([row[j] for row in net]) for j in range(len(net[0]))]
    return [cubic([line[i] for line in lines]) for i in range(4)]


def surface(net, u, v):
    x = curve([curve(row, v) for row in net], u)
    return [x[k] / x[3] for k in range(3)]


def farthest(net, other):
    def grid(net):
        c = np.array([[[float(x) for x in point] for point in row] for row in net])
        t = np.linspace(0, 1, GRID + 1)
        basis = [np.array([[float(mp.binomial(n - 1, i))] for i in range(n)]) * np.array([t ** i * (1 - t) ** (n - 1 - i) for i in range(n)]) for n in c.shape[:2]]
        x = np.einsum('ia,jb,ijk->abk', basis[0], basis[1], c)
        return x[..., :3] / x[..., 3:]
    d = np.linalg.norm(grid(net) - grid(other), axis=2)
    i, j = np.unravel_index(d.argmax(), d.shape)
    best = [mp.mpf(int(i)) / GRID, mp.mpf(int(j)) / GRID]

    def distance(place):
        a, b = surface(net, *place), surface(other, *place)
        return mp.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)))
    found, step = distance(best), mp.mpf(1) / GRID
    for _ in range(24):
        moves = [[best[0] + a * step, best[1] + b * step] for a, b in [(1, 0), (-1, 0), (0, 1), (0, -1)]]
        top = max((distance(m), m) for m in moves if all(0 <= x <= 1 for x in m))
        if top[0] > found:
            found, best = top
        else:
            step /= 2
    return found


def main(out):
    R = random.Random(20250)
    patches = []
    for p, q, rational in PATCHES:
        net = []
        for i in range(p + 1):
            row = []
            for j in range(q + 1):
                # Sums and products of these few bits are exact in f64: both read the same patch.
                x, y, z = (round(s * 1024) / 1024 for s in (i / p + R.uniform(-.1, .1), j / q + R.uniform(-.1, .1), R.uniform(-.25, .25)))
                w = round(R.uniform(.5, 2) * 64) / 64 if rational else 1.0
                row.append(mp.matrix([x * w, y * w, z * w, w]))
            net.append(row)
        stand_in = bicubic(net)
        if min(c[3] for row in stand_in for c in row) <= 0:
            raise SystemExit("a weight is not positive: choose another seed")

        def flat(net):
            return [[float(x) for x in c] for row in net for c in row]
        patches.append(dict(degree=[p, q], control=flat(net), bicubic=flat(stand_in), distance=float(farthest(net, stand_in))))
        print(p, q, patches[-1]["distance"])
    head = dict(format="isophote-oracle-bicubic", version=1, digits=mp.mp.dps)
    with open(out, "w") as f:
        f.write(json.dumps(head, separators=(",", ":"))[:-1] + ',"patches":[\n')
        f.write(",\n".join(json.dumps(patch, separators=(",", ":")) for patch in patches) + "\n]}\n")


if __name__ == "__main__":
    main(*(sys.argv[1:] or [os.path.join(ROOT, "testdata", "oracle", "bicubic.json")]))
