#!/usr/bin/env python3
"""Writes the arm's and gripper's visual meshes: meshes/visual/*.obj.

Every shape is a loft: rings of points joined side by side and closed at both ends, so each is a
closed surface. Link lengths are those of the URDF; radii and curves are drawn by eye after pictures
of an LBR iiwa 14 and a Robotiq 2F-85. Python 3, standard library only. Run it in any folder.
"""

import math
import pathlib

SIDES = 24
FOLDER = pathlib.Path(__file__).resolve().parent / "meshes" / "visual"


def add(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def ring(centre, axis_a, axis_b, a, b=None, power=2.0, sides=SIDES):
    """A superellipse: power 2 is round, more is a box with rounded edges."""
    b = a if b is None else b
    points = []
    for i in range(sides):
        angle = 2 * math.pi * (i + 0.5) / sides
        c, s = math.cos(angle), math.sin(angle)
        x = math.copysign(abs(c) ** (2 / power), c) * a
        y = math.copysign(abs(s) ** (2 / power), s) * b
        points.append(add(add(centre, axis_a, x), axis_b, y))
    return points


def loft(rings):
    """Joins rings into a closed surface; each end is closed towards its middle."""
    sides = len(rings[0])
    vertices = [p for r in rings for p in r]
    triangles = []
    for k in range(len(rings) - 1):
        for i in range(sides):
            j = (i + 1) % sides
            a, b = k * sides + i, k * sides + j
            c, d = a + sides, b + sides
            triangles += [(a, b, d), (a, d, c)]
    for k, flip in ((0, True), (len(rings) - 1, False)):
        middle = len(vertices)
        vertices.append(tuple(sum(p[axis] for p in rings[k]) / sides for axis in range(3)))
        for i in range(sides):
            a, b = k * sides + i, k * sides + (i + 1) % sides
            triangles.append((b, a, middle) if flip else (a, b, middle))
    volume = sum(dot(vertices[a], cross(vertices[b], vertices[c])) for a, b, c in triangles)
    if volume < 0:  # the rings ran the other way round
        triangles = [(a, c, b) for a, b, c in triangles]
    return vertices, triangles


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def revolve(profile, axis=Z, origin=(0.0, 0.0, 0.0)):
    """profile: (radius, distance along the axis from origin)."""
    side = X if axis != X else Y
    other = cross(axis, side)
    return loft([ring(add(origin, axis, h), side, other, max(r, 1e-4)) for r, h in profile])


def round_off(r, h0, h1, edge, steps=5):
    """Profile of a drum from h0 to h1 whose end at h1 is rounded with the given edge radius."""
    sign = 1 if h1 > h0 else -1
    profile = [(r * 0.96, h0), (r, h0 + sign * 0.003)]
    for k in range(steps + 1):
        angle = math.pi / 2 * k / steps
        profile.append((r - edge + edge * math.cos(angle), h1 - sign * edge * (1 - math.sin(angle))))
    return profile


def cap(r, h, thickness, axis, origin):
    """A shallow dome at distance h along axis: the coloured cover of a joint."""
    sign = 1 if h > 0 else -1
    profile = [(r * 0.99, h - sign * 0.012), (r, h - sign * 0.002)]
    for k in range(1, 6):
        angle = math.pi / 2 * k / 5
        profile.append((r * math.cos(angle), h + sign * thickness * math.sin(angle)))
    return revolve(profile, axis, origin)


def smooth(t):
    t = min(max(t, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def tube(path, radii):
    """A tube along a path in the plane x = 0; radii: across (x) and within the plane."""
    rings = []
    for k, centre in enumerate(path):
        before, after = path[max(k - 1, 0)], path[min(k + 1, len(path) - 1)]
        along = unit(add(after, before, -1))
        rings.append(ring(centre, X, cross(along, X), *radii[k]))
    return loft(rings)


def bent_tube(start, end, stem, lean, r0, r_waist, r1, steps=10):
    """A tube from start towards end that leans over sideways; stem: unit direction of its straight
    part, lean: unit direction sideways. start, end: (along stem, along lean)."""
    path, radii = [], []
    for k in range(steps + 1):
        t = k / steps
        along = start[0] + (end[0] - start[0]) * t
        aside = start[1] + (end[1] - start[1]) * smooth((t - 0.15) / 0.75)
        path.append(add(add((0.0, 0.0, 0.0), stem, along), lean, aside))
        waist = math.sin(math.pi * t)
        r = (r0 + (r1 - r0) * t) * (1 - waist) + r_waist * waist
        if k in (0, steps):  # a chamfer shows where one link ends and the next begins
            r *= 0.94
        radii.append((r, r))
    # The chamfer is short.
    for k, toward in ((0, 1), (steps, steps - 1)):
        short = add(path[k], unit(add(path[toward], path[k], -1)), 0.005)
        path.insert(1 if k == 0 else len(path) - 1, short)
        radii.insert(1 if k == 0 else len(radii) - 1, (radii[k if k == 0 else -1][0] / 0.94,) * 2)
    return tube(path, radii)


def lower_link(length, side, r0, waist, drum):
    """Links 1, 3, 5: a tube along z whose head holds half of the next joint's housing, on the side
    `side` of y. Returns body and cover."""
    head = (0.0, 0.0, length)
    axis = (0.0, float(side), 0.0)
    body = [
        bent_tube((0.0, 0.0), (length, 0.040), Z, axis, r0, waist, drum * 0.86),
        revolve(round_off(drum, 0.001, 0.082, 0.034), axis, head),
    ]
    return body, [cap(drum * 0.62, 0.081, 0.007, axis, head)]


def upper_link(length, r1, waist, drum):
    """Links 2, 4: the other half of a joint's housing, on +z, and a tube along y to the next."""
    origin = (0.0, 0.0, 0.0)
    body = [
        revolve(round_off(drum, 0.001, 0.082, 0.034), Z, origin),
        bent_tube((0.0, 0.040), (length, 0.0), Y, Z, drum * 0.86, waist, r1),
    ]
    return body, [cap(drum * 0.80, 0.070, 0.022, Z, origin)]


def base():
    foot = [(0.100, 0.0), (0.105, 0.004), (0.105, 0.022), (0.099, 0.032), (0.086, 0.048)]
    neck = [(0.078, 0.075), (0.076, 0.110), (0.078, 0.140), (0.078, 0.152), (0.073, 0.1575)]
    plug = loft([ring((x, 0, 0.040), Y, Z, a, b, 5.0)
                 for x, a, b in ((-0.05, 0.05, 0.036), (-0.115, 0.05, 0.036), (-0.125, 0.044, 0.03))])
    return [revolve(foot + neck), plug]


def wrist():
    """Link 6: joint 6 along z, the flange along +y."""
    origin = (0.0, 0.0, 0.0)
    ball = [(0.066 * math.cos(a), 0.066 * math.sin(a))
            for a in (math.pi / 2 * (k / 7 * 2 - 1) for k in range(8))]
    flange = [(0.052, 0.0), (0.052, 0.045), (0.050, 0.072), (0.046, 0.078)]
    body = [revolve(ball, Z, origin), revolve(flange, Y, origin)]
    return body, [cap(0.058, 0.040, 0.034, Z, origin)]


def flange():
    return [revolve([(0.047, -0.002), (0.050, 0.003), (0.050, 0.020), (0.040, 0.022), (0.0315, 0.024),
                     (0.0315, 0.045)])]


def gripper_base():
    """Origin at the flange, z outward; the fingers open along x."""
    coupling = revolve([(0.037, 0.0), (0.0375, 0.003), (0.0375, 0.016), (0.034, 0.018)])
    body = loft([ring((0, 0, z), X, Y, a, b, p) for z, a, b, p in (
        (0.016, 0.036, 0.034, 3.0), (0.024, 0.039, 0.035, 3.5), (0.060, 0.040, 0.034, 4.0),
        (0.080, 0.043, 0.030, 4.0), (0.100, 0.046, 0.024, 4.0), (0.104, 0.044, 0.022, 4.0))])
    knuckles = [loft([ring((sign * x, 0, z), X, Y, a, 0.014, 5.0, 12) for x, z, a in (
        (0.036, 0.078, 0.013), (0.043, 0.092, 0.014), (0.044, 0.108, 0.012), (0.044, 0.110, 0.010))])
        for sign in (1, -1)]
    return [coupling, body] + knuckles


def finger():
    """Tip at z = 0, rising towards -z; the pad's face is x = 0 and faces -x."""
    return [loft([ring((x0 + a, 0, z), X, Y, a, b, 8.0, 12) for x0, a, b, z in (
        (0.0050, 0.0020, 0.0095, -0.0006), (0.0045, 0.0028, 0.0108, -0.004),
        (0.0045, 0.0037, 0.0110, -0.040), (0.0035, 0.0042, 0.0100, -0.052),
        (0.0030, 0.0045, 0.0085, -0.098), (0.0035, 0.0038, 0.0075, -0.100))])]


def finger_pad():
    """22 x 6.35 x 37.5 mm, with sharp edges: the outline of what grips."""
    return [loft([[(x, y, z) for x, y in ((0.0, -0.011), (0.00635, -0.011), (0.00635, 0.011),
                                          (0.0, 0.011))] for z in (0.0, -0.0375)])]


def write(name, surfaces):
    lines = ["# Written by make_meshes.py; metres."]
    first = 1
    for vertices, triangles in surfaces:
        lines += ["v %.5f %.5f %.5f" % v for v in vertices]
        lines += ["f %d %d %d" % tuple(first + i for i in t) for t in triangles]
        first += len(vertices)
    (FOLDER / (name + ".obj")).write_text("\n".join(lines) + "\n")
    return sum(len(triangles) for _, triangles in surfaces)


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    parts = {"link_0": base(), "link_5": None, "link_7": flange(), "gripper_base": gripper_base(),
             "finger": finger(), "finger_pad": finger_pad()}
    parts["link_1"], parts["link_1_cap"] = lower_link(0.2025, -1, 0.077, 0.068, 0.082)
    parts["link_2"], parts["link_2_cap"] = upper_link(0.2045, 0.074, 0.066, 0.082)
    parts["link_3"], parts["link_3_cap"] = lower_link(0.2155, 1, 0.074, 0.063, 0.076)
    parts["link_4"], parts["link_4_cap"] = upper_link(0.1845, 0.068, 0.060, 0.076)
    # Joint 6 sits in a fork beside the wrist's ball.
    parts["link_5"] = [
        bent_tube((0.0, 0.0), (0.2155, 0.058), Z, Y, 0.068, 0.058, 0.030),
        revolve(round_off(0.052, 0.040, 0.072, 0.016), Y, (0.0, 0.0, 0.2155)),
    ]
    parts["link_6"], parts["link_6_cap"] = wrist()
    total = sum(write(name, surfaces) for name, surfaces in sorted(parts.items()))
    print("%d triangles" % total)


if __name__ == "__main__":
    main()
