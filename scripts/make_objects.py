#!/usr/bin/env python3
"""Writes what is not written by hand in models/objects: the meshes (looks only) and ball, apple, egg and mug.

Usage: scripts/make_objects.py

Millimetres in here; models/objects/README.md gives origin and grade of every number.
"""

import math
import pathlib
import xml.etree.ElementTree as ET

from mjcf_tools import add, cross, normalized, remark, text, write

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "models" / "objects"
SLICES = 48
CONTACT = {"solref": (0.01, 1), "solimp": (0.95, 0.99, 0.001)}

# Profiles (r, z) from the bottom on the outside; a new list where the surface has an edge.
MUG_RADIUS, MUG_WALL, MUG_HALF_HEIGHT = 41, 4, 47.5
MUG_PROFILE = [
    [(0, -46.5), (31, -46.5)], [(31, -46.5), (32, -47.4), (34, -47.4), (35.5, -46.6), (39.5, -43.5), (41, -39)],
    [(41, -39), (41, 45)], [(41, 45), (40.6, 46.8), (39, 47.5), (37.4, 46.8), (37, 45)], [(37, 45), (37, -37)],
    [(37, -37), (35.5, -40), (32, -41.5)], [(32, -41.5), (0, -41.5)],
]
MUG_HANDLE = [(40, 27), (55, 29), (65.5, 18), (66, -6), (57, -21), (40, -26)]  # x, z of the rod's corners
MUG_HANDLE_RADIUS = 5
BOTTLE_PROFILE = [
    [(0, -101), (12, -102.5), (20, -104.9)], [(20, -104.9), (27, -104.9), (31, -103), (32.5, -99)],
    *([(32.5 - 0.8 * (i % 2), -99 + 5 * i), (31.7 + 0.8 * (i % 2), -94 + 5 * i)] for i in range(14)),
    [(32.5, -29), (32.5, 25)] + [(32.5 * math.sqrt(1 - (i / 11)**2), 25 + 60 * i / 11) for i in range(1, 11)]
    + [(13.5, 80)],
    [(13.5, 80), (13.5, 86)], [(13.5, 86), (16.5, 86), (16.5, 88), (13.5, 88)], [(13.5, 88), (13.5, 92), (0, 92)],
]
APPLE_PROFILE = [[(0, -26), (3, -26.5), (8, -30), (12, -33), (16, -34), (19.5, -33), (23.5, -29.8), (27.5, -25),
                  (31.2, -18), (35.2, -9), (37.6, -1), (38, 5), (37.3, 12), (35, 19.5), (31, 26), (26, 31),
                  (21, 33.6), (17, 34), (12, 32.4), (7, 27.5), (3, 22.5), (0, 21)]]
EGG_LENGTH, EGG_WIDTH, EGG_TAPER = 57.0, 43.5, 0.13


def egg_profile(count=24):
    """(r, z) from the blunt pole (below) to the pointed one."""
    points = []
    for i in range(count + 1):
        u = -math.cos(math.pi * i / count)
        points.append((math.sqrt(max(0.0, 1 - u * u)) * (1 - EGG_TAPER * u), EGG_LENGTH / 2 * u))
    widest = max(r for r, _ in points)
    return [(r / widest * EGG_WIDTH / 2, z) for r, z in points]


class Mesh:
    def __init__(self):
        self.vertices, self.faces = [], []

    def vertex(self, *p):
        self.vertices.append(p)
        return len(self.vertices)

    def quad(self, a, b, c, d):
        self.faces += [(a, b, c), (a, c, d)]

    def normals(self):
        """Of the vertices: the mean of their faces, by area."""
        sums = [[0.0] * 3 for _ in self.vertices]
        for face in self.faces:
            a, b, c = (self.vertices[i - 1] for i in face)
            n = cross([b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)])
            for i in face:
                sums[i - 1] = [s + x for s, x in zip(sums[i - 1], n)]
        return [normalized(s) if any(s) else (0, 0, 1) for s in sums]

    def write(self, name):
        lines = ["# Written by scripts/make_objects.py; metres."]
        lines += ["v " + text([0.001 * x for x in v], 6) for v in self.vertices]
        lines += ["vn " + text(n, 4) for n in self.normals()]
        lines += ["f " + " ".join(f"{i}//{i}" for i in f) for f in self.faces]
        (FOLDER / "meshes" / f"{name}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


def lathe(runs, wobble=lambda r, z, angle: 0.0):
    """Surface of revolution about z; `wobble` is added to the height of its points."""
    mesh = Mesh()
    for run in runs:
        rings = []
        for r, z in run:
            angles = [2 * math.pi * k / SLICES for k in range(SLICES if r > 0 else 1)]
            rings.append([mesh.vertex(r * math.cos(a), r * math.sin(a), z + wobble(r, z, a)) for a in angles])
        for low, high in zip(rings, rings[1:]):
            for k in range(SLICES):
                m = (k + 1) % SLICES
                if len(low) == 1:
                    mesh.faces.append((low[0], high[m], high[k]))
                elif len(high) == 1:
                    mesh.faces.append((low[k], low[m], high[0]))
                else:
                    mesh.quad(low[k], low[m], high[m], high[k])
    return mesh


def plate(outline, thickness, hole=None):
    """Flat convex plate about z = 0; the hole has as many points as the outline."""
    mesh = Mesh()
    loops = [outline] if hole is None else [outline, hole]
    flats, rims = [], []  # each with its own vertices, so that the edges stay sharp
    for z in (-thickness / 2, thickness / 2):
        flats.append([[mesh.vertex(x, y, z) for x, y in loop] for loop in loops])
        rims.append([[mesh.vertex(x, y, z) for x, y in loop] for loop in loops])
    for k in range(len(outline)):
        m = (k + 1) % len(outline)
        for up, flat in enumerate(flats):
            corners = [flat[0][k], flat[0][m]] + ([flat[0][0]] if hole is None else [flat[1][m], flat[1][k]])
            corners = corners if up else corners[::-1]
            mesh.faces.append(tuple(corners)) if hole is None else mesh.quad(*corners)
        for inside in range(len(loops)):
            low, high = rims[0][inside], rims[1][inside]
            corners = (low[k], low[m], high[m], high[k])
            mesh.quad(*(corners[::-1] if inside else corners))
    return mesh


def sleeve(radius, low, high):
    """Profile of a band around an upright cylinder; thick, since thin meshes shade themselves."""
    inner = radius - 3.6
    return [[(inner, low), (radius, low)], [(radius, low), (radius, high)], [(radius, high), (inner, high)],
            [(inner, high), (inner, low)]]


def rounded(corners, parts=5):
    """Points of the Catmull-Rom curve through the corners."""
    padded = [corners[0], *corners, corners[-1]]
    points = []
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        for k in range(parts):
            t = k / parts
            points.append(tuple(0.5 * (2 * b[i] + (c[i] - a[i]) * t + (2 * a[i] - 5 * b[i] + 4 * c[i] - d[i]) * t**2
                                       + (3 * b[i] - a[i] - 3 * c[i] + d[i]) * t**3) for i in range(2)))
    return [*points, corners[-1]]


def rounded_rectangle(x, y, radius):
    """Corners of radius `radius` on half sizes x, y, as many points as a lathe has slices."""
    points = []
    for k in range(SLICES):
        quarter = 4 * k // SLICES
        a = math.pi / 2 * (quarter + (k % (SLICES // 4)) / (SLICES // 4 - 1))
        sx, sy = ((1, 1), (-1, 1), (-1, -1), (1, -1))[quarter]
        points.append((sx * (x - radius) + radius * math.cos(a), sy * (y - radius) + radius * math.sin(a)))
    return points


def circle(x, radius):
    return [(x + radius * math.cos(2 * math.pi * k / SLICES), radius * math.sin(2 * math.pi * k / SLICES))
            for k in range(SLICES)]


def seam(radius, width, count=120, sides=8):
    """The tennis ball's curve as a thin rope on a sphere: (2 cos t + cos 3t, 2 sin t - sin 3t, 2^1.5 sin 2t) / 3."""
    mesh = Mesh()
    rings = []
    for i in range(count):
        t = 2 * math.pi * i / count
        n = [(2 * math.cos(t) + math.cos(3 * t)) / 3, (2 * math.sin(t) - math.sin(3 * t)) / 3,
             2**1.5 * math.sin(2 * t) / 3]
        d = [(-2 * math.sin(t) - 3 * math.sin(3 * t)), (2 * math.cos(t) - 3 * math.cos(3 * t)),
             2**2.5 * math.cos(2 * t)]
        length = math.sqrt(sum(x * x for x in d))
        d = [x / length for x in d]
        side = [d[1] * n[2] - d[2] * n[1], d[2] * n[0] - d[0] * n[2], d[0] * n[1] - d[1] * n[0]]
        ring = []
        for k in range(sides):
            a = 2 * math.pi * k / sides
            ring.append(mesh.vertex(*((radius + 0.35 * width * math.cos(a)) * n[j] + width * math.sin(a) * side[j]
                                      for j in range(3))))
        rings.append(ring)
    for i in range(count):
        low, high = rings[i], rings[(i + 1) % count]
        for k in range(sides):
            m = (k + 1) % sides
            mesh.quad(low[k], low[m], high[m], high[k])
    return mesh


def solid(profile, mass):
    """Centre height (m), moments about x and z at the centre (kg m2) and volume (cm3) of a homogeneous solid of
    revolution, from discs between the profile's points."""
    discs = []
    for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
        for k in range(50):
            r, z = r0 + (r1 - r0) * (k + 0.5) / 50, z0 + (z1 - z0) * (k + 0.5) / 50
            discs.append((math.pi * r * r * (z1 - z0) / 50, r, z))
    volume = sum(v for v, _, _ in discs)
    centre = sum(v * z for v, _, z in discs) / volume
    about_z = sum(v * r * r / 2 for v, r, _ in discs) / volume
    about_x = sum(v * (r * r / 4 + (z - centre)**2) for v, r, z in discs) / volume
    return centre / 1000, mass * about_x * 1e-6, mass * about_z * 1e-6, volume / 1000


def begin(name, friction, condim, words):
    """Root and body of a file, with the classes that the hand-written ones have too."""
    root = ET.Element("mujoco", model=name)
    remark(root, f"Written by scripts/make_objects.py. {words} Numbers: README.md.")
    add(root, "compiler", angle="radian", autolimits="true")
    add(add(root, "visual"), "headlight", ambient=(0.4, 0.4, 0.4), diffuse=(0.6, 0.6, 0.6))
    main = add(root, "default")
    add(add(main, "default", class_="visual"), "geom", group=2, contype=0, conaffinity=0, mass=0)
    add(add(main, "default", class_="collision"), "geom", group=3, condim=condim, friction=friction, **CONTACT,
        rgba=(0.8, 0.5, 0.3, 0.6))
    asset = add(root, "asset")
    body = add(add(root, "worldbody"), "body", name=name)
    add(body, "freejoint")
    return root, asset, body


def metres(*values):
    return [v / 1000 for v in values]


def write_mesh_asset(asset, mesh, name):
    mesh.write(name)
    add(asset, "mesh", name=name, file=f"meshes/{name}.obj")


def make_ball():
    mass, outer, inner = 0.058, 33.5, 27.0
    root, asset, body = begin("ball", (0.8, 0.005, 0.001), 6, "Tennis ball; origin: its centre.")
    write_mesh_asset(asset, seam(outer, 1.3), "ball_seam")
    add(asset, "material", name="felt", rgba=(0.80, 0.92, 0.18, 1), specular=0.02, shininess=0.05)
    add(asset, "material", name="seam", rgba=(0.96, 0.97, 0.94, 1), specular=0.05, shininess=0.1)
    moment = 0.4 * mass * (outer**5 - inner**5) / (outer**3 - inner**3) * 1e-6  # a hollow ball
    add(body, "inertial", pos=(0, 0, 0), mass=mass, diaginertia=text([moment] * 3, 11))
    add(body, "geom", class_="visual", type="sphere", size=outer / 1000, material="felt")
    add(body, "geom", class_="visual", type="mesh", mesh="ball_seam", material="seam")
    add(body, "geom", class_="collision", type="sphere", size=outer / 1000, mass=mass)
    write(root, FOLDER / "ball.xml")


def inertial(body, profile, mass):
    centre, about_x, about_z, volume = solid(profile, mass)
    add(body, "inertial", pos=(0, 0, centre), mass=mass, diaginertia=text((about_x, about_x, about_z), 11))
    return volume


def make_egg():
    mass = 0.059
    profile = egg_profile()
    root, asset, body = begin("egg", (0.5, 0.005, 0.0005), 6, "Hen's egg, its blunt end below; origin: mid-height.")
    write_mesh_asset(asset, lathe([[(r if 0 < i < len(profile) - 1 else 0, z) for i, (r, z) in enumerate(profile)]]),
                     "egg")
    add(asset, "material", name="shell", rgba=(0.87, 0.68, 0.52, 1), specular=0.15, shininess=0.3)
    volume = inertial(body, profile, mass)
    add(body, "geom", class_="visual", type="mesh", mesh="egg", material="shell")

    fine = egg_profile(2000)

    def inscribed(z):
        return min(math.hypot(r, h - z) for r, h in fine)

    # The end spheres touch the poles; between them the profile is the hull of seven spheres.
    ends = []
    for sign in (-1, 1):
        low, high = 1.0, EGG_WIDTH / 2
        for _ in range(40):
            mid = (low + high) / 2
            low, high = (mid, high) if inscribed(sign * (EGG_LENGTH / 2 - mid)) >= mid - 1e-6 else (low, mid)
        ends.append(sign * (EGG_LENGTH / 2 - low))
    count = 7
    for k in range(count):
        z = ends[0] + (ends[1] - ends[0]) * k / (count - 1)
        add(body, "geom", class_="collision", type="sphere", pos=metres(0, 0, z), size=text(inscribed(z) / 1000, 6),
            mass=mass / count)
    write(root, FOLDER / "egg.xml")
    print(f"egg: {volume:.1f} cm3, {1000 * mass / volume:.3f} g/cm3")


def make_apple():
    mass = 0.182
    root, asset, body = begin("apple", (0.6, 0.005, 0.0005), 6,
                              "Apple, standing on its five lobes; origin: mid-height of the flesh.")

    def lobes(r, z, angle):  # five feet: between them the skin is higher
        return 1.3 * (1 - math.cos(5 * angle)) * max(0.0, -z / 34) * min(1.0, r / 8)

    write_mesh_asset(asset, lathe(APPLE_PROFILE, lobes), "apple")
    add(asset, "material", name="skin", rgba=(0.78, 0.13, 0.10, 1), specular=0.35, shininess=0.5)
    add(asset, "material", name="blush", rgba=(0.80, 0.70, 0.22, 1), specular=0.3, shininess=0.5)
    add(asset, "material", name="stem", rgba=(0.33, 0.22, 0.10, 1), specular=0.05, shininess=0.1)
    add(asset, "material", name="leaf", rgba=(0.25, 0.50, 0.14, 1), specular=0.1, shininess=0.2)
    volume = inertial(body, APPLE_PROFILE[0], mass)
    add(body, "geom", class_="visual", type="mesh", mesh="apple", material="skin")
    add(body, "geom", class_="visual", type="ellipsoid", pos=metres(0, 0, 22.5), size=metres(9, 9, 3.5),
        material="blush")
    add(body, "geom", class_="visual", type="capsule", fromto=metres(0, 0, 21, 4, 1, 41), size=0.0014, material="stem")
    add(body, "geom", class_="visual", type="ellipsoid", pos=metres(12, 5, 38.5), size=metres(10, 5, 0.8),
        quat=(0.94, -0.05, -0.22, 0.2), material="leaf")
    parts = [("ellipsoid", (0, 0, 2), (38, 38, 32))]
    for k in range(5):
        a = 2 * math.pi * k / 5
        parts.append(("sphere", (16 * math.cos(a), 16 * math.sin(a), -22), (12,)))
    for k in range(6):
        a = 2 * math.pi * k / 6
        parts.append(("sphere", (17 * math.cos(a), 17 * math.sin(a), 19.5), (14.5,)))
    for kind, pos, size in parts:
        add(body, "geom", class_="collision", type=kind, pos=metres(*pos), size=metres(*size), mass=mass / len(parts))
    write(root, FOLDER / "apple.xml")
    print(f"apple: {volume:.1f} cm3, {1000 * mass / volume:.3f} g/cm3")


def make_mug():
    density = 2.4e-6  # kg/mm3
    inner, count = MUG_RADIUS - MUG_WALL, 20
    root, asset, body = begin("mug", (0.5, 0.005, 0.0001), 4,
                              "Mug, handle towards x; origin: on its axis at mid-height.")
    write_mesh_asset(asset, lathe(MUG_PROFILE), "mug")
    add(asset, "material", name="glaze", rgba=(0.13, 0.42, 0.52, 1), specular=0.6, shininess=0.7)
    add(asset, "material", name="band", rgba=(0.95, 0.93, 0.87, 1), specular=0.5, shininess=0.6)
    add(body, "geom", class_="visual", type="mesh", mesh="mug", material="glaze")
    write_mesh_asset(asset, lathe(sleeve(41.4, 24, 35)), "mug_band")
    add(body, "geom", class_="visual", type="mesh", mesh="mug_band", material="band")
    curve = rounded(MUG_HANDLE)
    for (x0, z0), (x1, z1) in zip(curve, curve[1:]):
        add(body, "geom", class_="visual", type="capsule", fromto=metres(x0, 0, z0, x1, 0, z1),
            size=MUG_HANDLE_RADIUS / 1000, material="glaze")
    rods = list(zip(MUG_HANDLE, MUG_HANDLE[1:]))
    low, high = -MUG_HALF_HEIGHT, -MUG_HALF_HEIGHT + 6
    remark(body, "The foot alone touches the table.")
    add(body, "geom", class_="collision", type="cylinder", pos=metres(0, 0, (low + high) / 2),
        size=metres(inner, (high - low) / 2), mass=density * math.pi * inner**2 * (high - low))
    wall_low = low + 2
    ring = density * math.pi * (MUG_RADIUS**2 - inner**2) * (MUG_HALF_HEIGHT - wall_low)
    for k in range(count):
        a = 2 * math.pi * k / count
        r = MUG_RADIUS - MUG_WALL / 2
        add(body, "geom", class_="collision", type="box", size=metres(MUG_WALL / 2, r * math.tan(math.pi / count),
                                                                      (MUG_HALF_HEIGHT - wall_low) / 2),
            pos=metres(r * math.cos(a), r * math.sin(a), (MUG_HALF_HEIGHT + wall_low) / 2),
            quat=(math.cos(a / 2), 0, 0, math.sin(a / 2)), mass=ring / count)
    for (x0, z0), (x1, z1) in rods:
        length = math.hypot(x1 - x0, z1 - z0)
        add(body, "geom", class_="collision", type="capsule", fromto=metres(x0, 0, z0, x1, 0, z1),
            size=MUG_HANDLE_RADIUS / 1000, mass=density * math.pi * MUG_HANDLE_RADIUS**2 * length)
    write(root, FOLDER / "mug.xml")


def main():
    lathe(BOTTLE_PROFILE).write("bottle")
    lathe(sleeve(33.0, -26, 22)).write("bottle_label")
    lathe(sleeve(33.4, -4, 8)).write("bottle_stripe")
    plate(rounded_rectangle(42.8, 26.99, 3.18), 0.76).write("card")
    plate(circle(-16, 12.5), 2.0, circle(-21.5, 3.8)).write("key_bow")
    make_ball()
    make_egg()
    make_apple()
    make_mug()


if __name__ == "__main__":
    main()
