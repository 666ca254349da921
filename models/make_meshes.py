#!/usr/bin/env python3
"""Writes the example meshes as ASCII PLY: triangles, millimetres, z up, front = -y, origin in the centre of the bounding box.

Each object is a set of closed parts whose faces turn outward. Plain Python, no packages; the same bytes on every run.
Usage: make_meshes.py [FOLDER]   (default: the folder of this script)
"""
import pathlib
import sys


class Mesh:
    """Closed parts in one list of vertices and outward triangles (counter-clockwise seen from outside)."""

    def __init__(self, name):
        self.name = name
        self.vertices = []
        self.triangles = []

    def add_vertices(self, points):
        first = len(self.vertices)
        self.vertices.extend(tuple(float(c) for c in p) for p in points)
        return list(range(first, len(self.vertices)))

    def add_polygon(self, indices):
        """A planar simple polygon, counter-clockwise seen from outside; may be concave (ear clipping)."""
        self.triangles.extend(triangulate([self.vertices[i] for i in indices], indices))

    def loft(self, *rings):
        """A closed part through rings of equally many points, from bottom to top, each counter-clockwise from above."""
        levels = [self.add_vertices(ring) for ring in rings]
        self.add_polygon(levels[0][::-1])
        for low, high in zip(levels, levels[1:]):
            n = len(low)
            for i in range(n):
                j = (i + 1) % n
                self.add_polygon([low[i], low[j], high[j], high[i]])
        self.add_polygon(levels[-1])

    def box(self, x, y, z):
        """An axis-aligned box from three (low, high) pairs."""
        self.loft(rectangle(x, y, z[0]), rectangle(x, y, z[1]))

    def extrude_x(self, profile_yz, x):
        """A prism along x over a simple polygon in the y-z plane, counter-clockwise seen from +x."""
        self.loft(*[[(level, y, z) for y, z in profile_yz] for level in x])

    def tray(self, x, y, z, rim, depth):
        """A box with a rectangular pit in its top."""
        outer_low = self.add_vertices(rectangle(x, y, z[0]))
        outer_high = self.add_vertices(rectangle(x, y, z[1]))
        inner_x, inner_y = (x[0] + rim, x[1] - rim), (y[0] + rim, y[1] - rim)
        inner_high = self.add_vertices(rectangle(inner_x, inner_y, z[1]))
        inner_low = self.add_vertices(rectangle(inner_x, inner_y, z[1] - depth))
        self.add_polygon(outer_low[::-1])
        for low, high in ((outer_low, outer_high), (outer_high, inner_high), (inner_high, inner_low)):
            for i in range(4):
                j = (i + 1) % 4
                self.add_polygon([low[i], low[j], high[j], high[i]])
        self.add_polygon(inner_low)

    def write(self, folder):
        path = folder / (self.name + ".ply")
        lines = ["ply", "format ascii 1.0", f"comment {self.name}, millimetres, z up, front -y",
                 "comment made by models/make_meshes.py",
                 f"element vertex {len(self.vertices)}", "property float x", "property float y", "property float z",
                 f"element face {len(self.triangles)}", "property list uchar int vertex_indices", "end_header"]
        lines += [" ".join(f"{c:g}" for c in v) for v in self.vertices]
        lines += ["3 " + " ".join(str(i) for i in t) for t in self.triangles]
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        print(f"{path}: {len(self.vertices)} vertices, {len(self.triangles)} triangles")


def rectangle(x, y, z):
    return [(x[0], y[0], z), (x[1], y[0], z), (x[1], y[1], z), (x[0], y[1], z)]


def octagon(x, y, z, chamfer):
    """A rectangle with its corners cut, counter-clockwise from above."""
    (x0, x1), (y0, y1), c = x, y, chamfer
    return [(x0 + c, y0, z), (x1 - c, y0, z), (x1, y0 + c, z), (x1, y1 - c, z),
            (x1 - c, y1, z), (x0 + c, y1, z), (x0, y1 - c, z), (x0, y0 + c, z)]


def subtract(a, b):
    return tuple(p - q for p, q in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def newell_normal(points):
    total = (0.0, 0.0, 0.0)
    for p, q in zip(points, points[1:] + points[:1]):
        total = tuple(t + c for t, c in zip(total, cross(p, q)))
    return total


def triangulate(points, indices):
    """Ear clipping; the triangles keep the polygon's sense of rotation."""
    normal = newell_normal(points)

    def area(i, j, k):
        return dot(normal, cross(subtract(points[j], points[i]), subtract(points[k], points[i])))

    def is_ear(remaining, position):
        i, j, k = remaining[position - 1], remaining[position], remaining[(position + 1) % len(remaining)]
        if area(i, j, k) <= 0:
            return False
        others = (p for p in remaining if p not in (i, j, k))
        return not any(area(i, j, p) >= 0 and area(j, k, p) >= 0 and area(k, i, p) >= 0 for p in others)

    remaining, triangles = list(range(len(points))), []
    while len(remaining) > 3:
        position = next(p for p in range(len(remaining)) if is_ear(remaining, p))
        triangles.append((remaining[position - 1], remaining[position], remaining[(position + 1) % len(remaining)]))
        del remaining[position]
    triangles.append(tuple(remaining))
    return [tuple(indices[i] for i in t) for t in triangles]


def cuboid(name, size_x, size_y, size_z):
    mesh = Mesh(name)
    mesh.box((-size_x / 2, size_x / 2), (-size_y / 2, size_y / 2), (-size_z / 2, size_z / 2))
    return mesh


def juice_dispenser():
    """220 x 320 x 482 mm. A base plate with cut corners, a drip tray, a column, a chamfered tank with lid, a tap block."""
    mesh = Mesh("juice_dispenser")
    base_x, base_y = (-110, 110), (-160, 160)
    mesh.loft(octagon(base_x, base_y, -241, 25), octagon(base_x, base_y, -213, 25))
    mesh.tray((-65, 65), (-145, -30), (-213, -199), rim=8, depth=8)
    mesh.box((-60, 60), (45, 140), (-213, -25))
    tank_x, tank_y = (-96, 96), (-85, 150)
    mesh.loft(octagon((-80, 80), (-69, 134), -25, 28), octagon(tank_x, tank_y, 2, 34),
              octagon(tank_x, tank_y, 185, 34), octagon((-84, 84), (-73, 138), 205, 30))
    mesh.loft(octagon((-90, 90), (-79, 144), 205, 32), octagon((-90, 90), (-79, 144), 226, 32))
    mesh.box((-28, 28), (14, 51), (226, 241))
    tap_profile = [(-85, 12), (-85, 62), (-112, 62), (-135, 42), (-135, -8), (-108, -8), (-108, 12)]
    mesh.extrude_x(tap_profile, (-20, 20))
    lever_y = (-128, -112)
    lever_foot = 62 - (lever_y[1] - lever_y[0]) * 20 / 23  # on the slope of the tap block
    mesh.extrude_x([(lever_y[0], lever_foot), (lever_y[1], 62), (lever_y[1], 96), (lever_y[0], 96)], (-7, 7))
    return mesh


def refrigerator():
    """600 x 650 x 1500 mm. A body with a plinth recess, a freezer door above a larger door, two bar handles."""
    mesh = Mesh("refrigerator")
    plinth_top, plinth_depth, body_front, back = -660, 55, -235, 325
    mesh.extrude_x([(body_front + plinth_depth, -750), (back, -750), (back, 750), (body_front, 750),
                    (body_front, plinth_top), (body_front + plinth_depth, plinth_top)], (-300, 300))
    door_y, gap = (-285, -241), 12
    split = 250
    doors = ((plinth_top, split - gap / 2), (split + gap / 2, 750))
    for low, high in doors:
        mesh.box((-286, 286), (-241, body_front), (low + 14, high - 14))  # gasket, set back behind the door
        mesh.box((-300, 300), door_y, (low, high))
    for low, high in ((-170, 190), (300, 560)):  # brackets that stand off the doors
        mesh.extrude_x([(-325, low), (-285, low), (-285, low + 22), (-307, low + 22),
                        (-307, high - 22), (-285, high - 22), (-285, high), (-325, high)], (232, 256))
    return mesh


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    folder.mkdir(parents=True, exist_ok=True)
    for mesh in (cuboid("parcel_box", 300, 200, 150), cuboid("book", 240, 165, 35), juice_dispenser(), refrigerator()):
        mesh.write(folder)


if __name__ == "__main__":
    main()
