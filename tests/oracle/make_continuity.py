#!/usr/bin/env python3
"""Greatest gap, angle and difference of normal curvatures along seams of two surfaces; freezes testdata/oracle/continuity.json.

Usage: make_continuity.py [OUT.json] [--seed 1] [--count 24]. Needs mpmath.

Places are sought in doubles; what stands in the file is mpmath's, 30 digits, at the places found. Surfaces are Bezier patches, rational or not; the border is u = 1 of the first and
u = 0 of the second. For each place of either border the nearest of the other is found by Newton's method on (A - B) . B' = 0,
ended by the ends of the border; values there are compared at 161 places of each border, and the best three are refined by
golden section. The gap is the greatest distance to the nearest point, both ways; angle and difference likewise.
"""
import argparse
import json
import math
import random
from mpmath import asin, mp, mpf

mp.dps = 30
PLACES = 160


class Patch:
    def __init__(self, number, degree, points, weights):
        self.number, self.degree = number, degree
        p, q = degree
        self.h = [[[number(c) * number(weights[i * (q + 1) + j]) for c in points[i * (q + 1) + j]] + [number(weights[i * (q + 1) + j])]
                   for j in range(q + 1)] for i in range(p + 1)]

    @staticmethod
    def basis(n, t, order):
        """The derivative of that order of each Bernstein polynomial, by its definition."""
        def bernstein(n, i):
            return math.comb(n, i) * t**i * (1 - t)**(n - i) if 0 <= i <= n else 0 * t
        if order == 0:
            return [bernstein(n, i) for i in range(n + 1)]
        if order == 1:
            return [n * (bernstein(n - 1, i - 1) - bernstein(n - 1, i)) for i in range(n + 1)]
        if n < 2:
            return [0 * t] * (n + 1)
        return [n * (n - 1) * (bernstein(n - 2, i - 2) - 2 * bernstein(n - 2, i - 1) + bernstein(n - 2, i)) for i in range(n + 1)]

    def homogeneous(self, u, v, a, b):
        bu, bv = self.basis(self.degree[0], u, a), self.basis(self.degree[1], v, b)
        return [sum(bu[i] * sum(bv[j] * self.h[i][j][k] for j in range(len(bv))) for i in range(len(bu))) for k in range(4)]

    def jet(self, u, v, second=True):
        orders = [(0, 0), (1, 0), (0, 1)] + ([(2, 0), (1, 1), (0, 2)] if second else [])
        n = {o: self.homogeneous(u, v, *o) for o in orders}
        w = n[0, 0][3]
        s = [c / w for c in n[0, 0][:3]]
        su = [(n[1, 0][k] - n[1, 0][3] * s[k]) / w for k in range(3)]
        sv = [(n[0, 1][k] - n[0, 1][3] * s[k]) / w for k in range(3)]
        if not second:
            return s, su, sv
        suu = [(n[2, 0][k] - 2 * n[1, 0][3] * su[k] - n[2, 0][3] * s[k]) / w for k in range(3)]
        suv = [(n[1, 1][k] - n[1, 0][3] * sv[k] - n[0, 1][3] * su[k] - n[1, 1][3] * s[k]) / w for k in range(3)]
        svv = [(n[0, 2][k] - 2 * n[0, 1][3] * sv[k] - n[0, 2][3] * s[k]) / w for k in range(3)]
        return s, su, sv, suu, suv, svv


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def length(a):
    return dot(a, a)**0.5


def border(patch, side, t, second):
    return patch.jet(patch.number(1 - side), t, second)


def foot(patch, side, point, t):
    least = 1e-14 if patch.number is float else mpf(10)**-26
    for _ in range(60):
        s, _, sv, _, _, svv = border(patch, side, t, True)
        d = minus(point, s)
        slope = dot(sv, sv) - dot(d, svv)
        step = dot(d, sv) / (slope if slope > 0 else dot(sv, sv))
        new = min(patch.number(1), max(patch.number(0), t + step))
        if abs(new - t) < least:
            return new
        t = new
    return t


def across(jet):
    """The unit normal and the normal curvature at right angles to the border, by the shape operator's own definition."""
    _, su, sv, suu, suv, svv = jet
    n = cross(su, sv)
    n = [c / length(n) for c in n]
    tangent = [c / length(sv) for c in sv]
    d = cross(n, tangent)
    # d = a su + b sv, by Cramer's rule in the tangent plane.
    area = dot(cross(su, sv), n)
    a, b = dot(cross(d, sv), n) / area, dot(cross(su, d), n) / area
    return n, a * a * dot(suu, n) + 2 * a * b * dot(suv, n) + b * b * dot(svv, n)


def values(patches, side, t):
    """Gap, angle, difference of curvatures at t of border `side`; the other border has nearly the same parameter."""
    number = patches[0].number
    here = border(patches[side], side, t, True)
    guess = min([max(0, min(1, t + number(i) / 40)) for i in range(-4, 5)],
                key=lambda r: length(minus(border(patches[1 - side], 1 - side, r, False)[0], here[0])))
    there = border(patches[1 - side], 1 - side, foot(patches[1 - side], 1 - side, here[0], guess), True)
    (n, k), (m, l) = across(here), across(there)
    half = length(minus(n, m)) / 2
    return [length(minus(here[0], there[0])), 2 * (math.asin(half) if number is float else asin(half)), abs(k - l)]


def greatest(given):
    doubles, exact = [[Patch(number, *g) for g in given] for number in (float, mpf)]
    best = [mpf(0)] * 3
    for side in (0, 1):
        table = [values(doubles, side, i / PLACES) for i in range(PLACES + 1)]
        for which in range(3):
            order = sorted(range(PLACES + 1), key=lambda i: -table[i][which])[:3]
            places = [0.0, 1.0]
            for i in order:
                low, high = max(0, i - 1) / PLACES, min(PLACES, i + 1) / PLACES
                for _ in range(40):
                    third = (high - low) / 3
                    a, b = low + third, high - third
                    if values(doubles, side, a)[which] < values(doubles, side, b)[which]:
                        low = a
                    else:
                        high = b
                places += [(low + high) / 2]
            place = max(places, key=lambda t: values(doubles, side, t)[which])
            best[which] = max(best[which], values(exact, side, mpf(place))[which])
    return best


def seam(rng):
    p, q = rng.randint(1, 9), rng.randint(1, 9)
    rational = rng.random() < 0.5
    r = lambda size: rng.uniform(-size, size)
    net = [[[i / p - 1 + r(0.05), j / q + r(0.05), r(0.2)] for j in range(q + 1)] for i in range(p + 1)]
    weight = lambda: rng.uniform(0.7, 1.4) if rational else 1.0
    weights = [[weight() for _ in range(q + 1)] for _ in range(p + 1)]
    # The second patch begins with the first one's last row, moved a little, and goes on as that came in.
    n = rng.randint(1, 9)
    gap, angle = [10**rng.uniform(-6, -2) if rng.random() < 0.7 else 0.0 for _ in range(2)]
    other, other_weights = [], []
    for i in range(n + 1):
        row = []
        for j in range(q + 1):
            a, b = net[p][j], net[p - 1][j]
            step = i * p / n
            row.append([a[0] + step * (a[0] - b[0]), a[1] + step * (a[1] - b[1]),
                        a[2] + step * (a[2] - b[2]) + gap * ((j + 1) % 3) + (angle + r(0.1) * (i > 1)) * (i > 0)])
        other.append(row)
        other_weights.append(list(weights[p]))
    flat = lambda rows: [x for row in rows for x in row]
    return [([p, q], flat(net), flat(weights)), ([n, q], flat(other), flat(other_weights))]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", nargs="?", default="testdata/oracle/continuity.json")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=24)
    args = parser.parse_args()
    rng = random.Random(args.seed)
    seams = []
    for _ in range(args.count):
        given = seam(rng)
        found = greatest(given)
        print([mp.nstr(x, 6) for x in found], [g[0] for g in given], flush=True)
        seams.append({
            "patches": [{"degree": d, "points": p, "weights": w} for d, p, w in given],
            "gap": float(found[0]), "angle": float(found[1]), "difference": float(found[2]),
        })
    with open(args.out, "w") as out:
        out.write('{"format":"isophote-oracle-continuity","version":1,"digits":30,"seams":[\n')
        out.write(",\n".join(json.dumps(s, separators=(",", ":")) for s in seams))
        out.write("\n]}\n")


if __name__ == "__main__":
    main()
