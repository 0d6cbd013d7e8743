#!/usr/bin/env python3
"""make_3dm.py: files of Rhino, written by rhino3dm in every version that we read, and what rhino3dm says of their faces.

    V/bin/pip install rhino3dm==8.17.0
    V/bin/python tests/oracle/make_3dm.py [FILE.3dm ...]

Without arguments it writes testdata/3dm/parts-N.3dm for archive versions 3 to 8, mitred.3dm and transposed.3dm, and for each
testdata/3dm/NAME.json with the answers.
With arguments it prints the answers for other files, by their names; those of ../shared/models/rhino/*.3dm are frozen as
testdata/3dm/samples.json. An answer is a list of faces in the order of the file:

    {"object": name, "reversed": bool, "domain": [u0, u1, v0, v1], "points": [x, y, z, ...], "inside": "1101..."}

Points are 20 x 20 at equal steps of the parameters of the rational form, u slowest: openNURBS's own evaluation of the surface as
it is in the file (circle, line, sum ...) at the parameters that its `GetSurfaceParameterFromNurbsFormParameter` gives. `inside` is
for 20 x 20 points at the middles of equal cells, decided in space from the shape that the object has by mathematics: 1, 0, or x
within 1e-3 of an edge. It is absent where the shape is not known here.
"""
import json, math, os, re, struct, sys, zlib
import rhino3dm as r

P, V = r.Point3d, r.Vector3d
N = 20


def attributes(name, layer, mode=None):
    a = r.ObjectAttributes()
    a.Name, a.LayerIndex = name, layer
    if mode is not None: a.Mode = mode
    return a


def wave():
    """Bicubic and rational, with a double knot, over [-1, 2] x [0, 5]."""
    s = r.NurbsSurface.Create(3, True, 4, 4, 6, 5)
    for i, k in enumerate([-1, -1, -1, 0.5, 0.5, 2, 2, 2]): s.KnotsU[i] = k
    for i, k in enumerate([0, 0, 0, 2, 5, 5, 5]): s.KnotsV[i] = k
    for i in range(6):
        for j in range(5):
            w = 1 + 0.5 * math.sin(3 * i + 5 * j)
            x, y, z = 2.0 * i, 1.5 * j, math.cos(i) * math.sin(j)
            s.Points[i, j] = r.Point4d(x * w, y * w, z * w, w)
    return s


def rounded(width, height, radius):
    """A rectangle about the origin with rounded corners: lines and arcs."""
    c = r.PolyCurve()
    w, h = width / 2, height / 2
    corners = [(w, -h), (w, h), (-w, h), (-w, -h)]
    for k, (x, y) in enumerate(corners):
        sx, sy = math.copysign(1, x), math.copysign(1, y)
        center = P(x - sx * radius, y - sy * radius, 0)
        start = k * math.pi / 2 - math.pi / 2
        at = lambda a: P(center.X + radius * math.cos(a), center.Y + radius * math.sin(a), 0)
        c.Append(r.Arc(at(start), at(start + math.pi / 4), at(start + math.pi / 2)))
        nx, ny = corners[(k + 1) % 4]
        tx, ty = math.copysign(1, nx), math.copysign(1, ny)
        a = start + math.pi / 2
        end = P(nx - tx * radius + radius * math.cos(a), ny - ty * radius + radius * math.sin(a), 0)
        c.Append(r.Line(at(a), end))
    return c


def in_rounded(width, height, radius):
    """Signed distance in the plane, below 0 inside."""
    def distance(x, y):
        qx, qy = abs(x) - (width / 2 - radius), abs(y) - (height / 2 - radius)
        return math.hypot(max(qx, 0), max(qy, 0)) + min(max(qx, qy), 0) - radius
    return distance


def disc(radius):
    return lambda x, y: math.hypot(x, y) - radius


def ring(outer, inner):
    return lambda x, y: max(disc(outer)(x, y), -disc(inner)(x, y))


def everywhere(x, y):
    return -1.0


def arc_curve(arc):
    """rhino3dm has no constructor for it, but takes arcs into polycurves."""
    c = r.PolyCurve()
    c.Append(arc)
    return c


def circle(radius, z=0.0):
    return r.Circle(P(0, 0, z), radius)


def build():
    """The file, and the shapes of its flat faces, which all lie in planes z = constant."""
    f = r.File3dm()
    f.Settings.ModelUnitSystem = r.UnitSystem.Inches
    f.Settings.ModelAbsoluteTolerance = 0.001
    for name, visible in (('Shown', True), ('Hidden', False)):
        layer = r.Layer()
        layer.Name, layer.Visible = name, visible
        f.Layers.Add(layer)
    shapes = {}
    o = f.Objects
    o.AddSurface(wave(), attributes('wave', 0))
    o.AddBrep(r.Brep.CreateFromSphere(r.Sphere(P(1, 2, 3), 1.5)), attributes('ball', 0))
    o.AddBrep(r.Brep.CreateFromCylinder(r.Cylinder(circle(1.0), 3.0), True, True), attributes('can', 0))
    shapes['can'] = disc(1.0)
    side = r.RevSurface.Create(r.LineCurve(P(1, 0, 0), P(0, 0, 2)), r.Line(P(0, 0, 0), P(0, 0, 1)), 0, 2 * math.pi)
    o.AddBrep(r.Brep.CreateFromRevSurface(side, True, False), attributes('cone', 0))
    shapes['cone'] = disc(1.0)
    o.AddExtrusion(r.Extrusion.CreatePipeExtrusion(r.Cylinder(circle(2.0), 3.0), 1.2, True, True), attributes('pipe', 0))
    shapes['pipe'] = ring(2.0, 1.2)
    o.AddExtrusion(r.Extrusion.Create(rounded(4, 3, 0.5), 2.0, True), attributes('rounded', 0))
    shapes['rounded'] = in_rounded(4, 3, 0.5)
    wavy = [P(math.cos(a) * (2 + (k % 2)), math.sin(a) * (2 + (k % 2)), 0) for k in range(8) for a in [k * math.pi / 4]]
    o.AddExtrusion(r.Extrusion.Create(r.NurbsCurve.Create(True, 3, wavy), 1.0, False), attributes('flutes', 0))
    profile = r.PolyCurve()
    profile.Append(r.Line(P(2, 0, 0), P(1, 0, 1)))
    profile.Append(r.Arc(P(1, 0, 1), P(1.5, 0, 1.6), P(1.2, 0, 2.5)))
    turned = r.RevSurface.Create(profile, r.Line(P(0, 0, 0), P(0, 0, 1)), 0.4, 4.4)
    o.AddBrep(r.Brep.CreateFromRevSurface(turned, False, False), attributes('vase', 0))
    plate = r.Brep.CreateTrimmedPlane(r.Plane.WorldXY(), rounded(4, 3, 0.5))
    o.AddBrep(plate, attributes('plate', 0))
    shapes['plate'] = in_rounded(4, 3, 0.5)
    swept = r.Brep.CreateTrimmedPlane(r.Plane.WorldXY(), r.NurbsCurve.CreateFromCircle(circle(0.4)))
    path = arc_curve(r.Arc(P(0, 0, 0), P(0.4, 0, 1.5), P(2, 0, 3)))
    o.AddBrep(swept.Faces[0].CreateExtrusion(path, True), attributes('sweep', 0))
    o.AddBrep(r.Brep.CreateFromSphere(r.Sphere(P(0, 0, 0), 1)), attributes('under a hidden layer', 1))
    o.AddBrep(r.Brep.CreateFromSphere(r.Sphere(P(0, 0, 0), 1)), attributes('hidden itself', 0, r.ObjectMode.Hidden))
    mesh = r.Mesh()
    for x, y in ((0, 0), (1, 0), (0, 1)): mesh.Vertices.Add(x, y, 0)
    mesh.Faces.AddFace(0, 1, 2)
    o.AddMesh(mesh, attributes('mesh', 0))
    o.AddPoint(P(1, 2, 3))
    o.AddCurve(arc_curve(r.Arc(P(0, 0, 0), P(1, 1, 0), P(2, 0, 0))), attributes('wire', 0))
    bolt = r.Brep.CreateFromCylinder(r.Cylinder(circle(0.25), 1.0), False, False)
    f.InstanceDefinitions.Add('bolt', '', '', '', P(0, 0, 0), (bolt,), (attributes('shank', 0),))
    bolt_id = f.InstanceDefinitions[0].Id
    moved = r.Transform.Translation(V(10, 0, 0))
    mirrored = r.Transform.Mirror(P(0, 5, 0), V(0, 1, 0))
    for name, x in (('bolt moved', moved), ('bolt mirrored', mirrored)):
        o.AddInstanceObject(r.InstanceReference(bolt_id, x), attributes(name, 0))
    pair = r.InstanceReference(bolt_id, r.Transform.Translation(V(0, 0, 2)))
    f.InstanceDefinitions.Add('nested', '', '', '', P(0, 0, 0), (pair,), (attributes('inner', 0),))
    o.AddInstanceObject(r.InstanceReference(f.InstanceDefinitions[1].Id, r.Transform.Scale(P(0, 0, 0), 3.0)), attributes('nested bolt', 0))
    return f, shapes


def unit(x, y, z):
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def mitred(is_transposed):
    """The bytes of a file with one extrusion whose ends are mitred; rhino3dm has no way to say so, but reads it."""
    f = r.File3dm()
    profile = r.PolyCurve()
    profile.Append(r.Line(P(-1, 2, 0), P(-1, -2, 0)))
    profile.Append(r.Arc(P(-1, -2, 0), P(1, 0, 0), P(-1, 2, 0)))
    f.Objects.AddExtrusion(r.Extrusion.Create(profile, 2.0, True), attributes('mitred', 0))
    f.Write('/tmp/mitred.3dm', 8)
    b = bytearray(open('/tmp/mitred.3dm', 'rb').read())
    # Range of the path, up vector, no normals, domain of the path; then whether it is transposed.
    known = re.escape(struct.pack('<2d', 0, 1)) + b'.{24}' + re.escape(bytes(2 + 48) + struct.pack('<2d', 0, 2))
    at = re.search(known, b, re.DOTALL).start() + 40
    b[at:at + 2] = b'\1\1'
    struct.pack_into('<6d', b, at + 2, *unit(0.3, -0.2, 0.8), *unit(-0.1, 0.4, 0.7))
    b[at + 66] = is_transposed
    # The checksum is of the chunk's own bytes, without the chunks in it: the version, and from behind the profile to the caches.
    start = at
    while start == at or start + 12 + struct.unpack_from('<q', b, start + 4)[0] < at:
        start = b.rindex(struct.pack('<I', 0x40008000), 0, start)
    end = start + 12 + struct.unpack_from('<q', b, start + 4)[0] - 4
    behind = start + 20 + 12 + struct.unpack_from('<q', b, start + 24)[0]
    caches = b.index(struct.pack('<I', 0x40008000), behind)
    struct.pack_into('<I', b, end, zlib.crc32(b[start + 12:start + 20] + b[behind:caches]))
    return bytes(b)


def places(domain, shift):
    (a, b) = domain
    last = N - 1 if shift == 0 else N
    return [a + (b - a) * (k + shift) / last for k in range(N)]


def answer(name, surface, reverse, shape=None, place=lambda p: p):
    du, dv = ((d.T0, d.T1) for d in (surface.Domain(0), surface.Domain(1)))
    points = []
    for s in places(du, 0):
        for t in places(dv, 0):
            got = surface.GetSurfaceParameterFromNurbsFormParameter(s, t)
            p = place(surface.PointAt(got[-2], got[-1]))
            points += [float('%.11g' % x) for x in (p.X, p.Y, p.Z)]
    face = {'object': name, 'reversed': reverse, 'domain': [*du, *dv], 'points': points}
    if shape is not None:
        inside = ''
        for s in places(du, 0.5):
            for t in places(dv, 0.5):
                got = surface.GetSurfaceParameterFromNurbsFormParameter(s, t)
                p = surface.PointAt(got[-2], got[-1])
                d = shape(p.X, p.Y)
                inside += 'x' if abs(d) < 1e-3 else '1' if d < 0 else '0'
        face['inside'] = inside
    return face


def is_level(surface):
    u, v = surface.Domain(0), surface.Domain(1)
    return surface.IsPlanar(1e-9) and abs(surface.NormalAt(u.T0, v.T0).Z) > 0.999


def faces(f, shapes):
    found = []
    blocks = {d.Id: d for d in f.InstanceDefinitions}
    geometry = {o.Attributes.Id: o for o in f.Objects}

    def draw(o, name, place, mirrored):
        g = o.Geometry
        if isinstance(g, r.InstanceReference):
            x = g.Xform
            def further(p, x=x): q = r.Point3d(p.X, p.Y, p.Z); return place(q.Transform(x))
            m = [[getattr(x, f'M{i}{j}') for j in range(3)] for i in range(3)]
            det = sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))
            for i in blocks[g.ParentIdefId].GetObjectIds(): draw(geometry[i], name, further, mirrored ^ (det < 0))
            return
        if isinstance(g, r.Extrusion): g = g.ToBrep(False)
        if isinstance(g, r.Brep):
            for k in range(len(g.Faces)):
                face = g.Faces[k]
                under = face.UnderlyingSurface()
                is_known = name in shapes or not under.IsPlanar(1e-9)
                shape = (shapes.get(name) if is_level(under) else everywhere) if is_known else None
                found.append(answer(name, under, face.OrientationIsReversed ^ mirrored, shape, place))
        elif isinstance(g, r.Surface):
            found.append(answer(name, g, mirrored, everywhere, place))

    for o in f.Objects:
        a = o.Attributes
        layer = f.Layers.FindIndex(a.LayerIndex)
        shown = a.Mode != r.ObjectMode.Hidden and a.Visible and (layer is None or layer.Visible)
        if not a.IsInstanceDefinitionObject and shown: draw(o, a.Name, lambda p: p, False)
    return found


def main():
    if len(sys.argv) > 1:
        print(json.dumps({os.path.basename(path): faces(r.File3dm.Read(path), {}) for path in sys.argv[1:]}))
        return
    folder = os.path.join(os.path.dirname(__file__), '../../testdata/3dm')
    f, shapes = build()
    for version in range(3, 9):
        f.Write(os.path.join(folder, f'parts-{version}.3dm'), version)
    for name, is_transposed in (('mitred', False), ('transposed', True)):
        with open(os.path.join(folder, name + '.3dm'), 'wb') as out: out.write(mitred(is_transposed))
    # What is asked is the file that was written, not what was meant.
    for name, model in (('parts', 'parts-8'), ('mitred', 'mitred'), ('transposed', 'transposed')):
        found = faces(r.File3dm.Read(os.path.join(folder, model + '.3dm')), shapes if name == 'parts' else {})
        with open(os.path.join(folder, name + '.json'), 'w') as out:
            out.write('[\n' + ',\n'.join(json.dumps(face, separators=(',', ':')) for face in found) + '\n]\n')
        for face in found: print(name, face['object'], face['reversed'], face['domain'], face.get('inside', '').count('1'))


main()
