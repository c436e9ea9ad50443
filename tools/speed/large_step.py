#!/usr/bin/env python3
"""Writes a large STEP file of its own making, for measuring import.

    large_step.py plates OUT.step [--megabytes 60]
    large_step.py waves  OUT.step [--megabytes 60]

`plates`: an assembly of different plates with round corners and rows of holes; planes and
cylinders only. `waves`: blocks whose upper side is a bicubic B-spline surface. The
parts are placed on a grid by NEXT_ASSEMBLY_USAGE_OCCURRENCE, all in one context.
Needs nothing but Python, and writes the same bytes every time.
"""

import argparse
import math

HEADER = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('{name}','2024-01-01T00:00:00',(''),(''),'large_step.py','trimray','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
"""


class File:
    """Entities in the order in which they are made, numbered from 1."""

    def __init__(self, out):
        self.out, self.id, self.size = out, 0, 0

    def add(self, text: str) -> int:
        self.id += 1
        line = f"#{self.id}={text};\n"
        self.out.write(line)
        self.size += len(line)
        return self.id

    def point(self, p) -> int:
        return self.add("CARTESIAN_POINT('',(" + ",".join(number(x) for x in p) + "))")

    def direction(self, d) -> int:
        return self.add("DIRECTION('',(" + ",".join(number(x) for x in d) + "))")

    def placement(self, origin, z, x) -> int:
        origin, z, x = self.point(origin), self.direction(z), self.direction(x)
        return self.add(f"AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})")

    def vertex(self, p) -> tuple[int, tuple]:
        return self.add(f"VERTEX_POINT('',#{self.point(p)})"), p

    def edge(self, start, end, curve: int) -> int:
        return self.add(f"EDGE_CURVE('',#{start[0]},#{end[0]},#{curve},.T.)")

    def line(self, start, end) -> int:
        step = [b - a for a, b in zip(start[1], end[1])]
        length = math.hypot(*step)
        direction = self.direction([x / length for x in step])
        vector = self.add(f"VECTOR('',#{direction},{number(length)})")
        line = self.add(f"LINE('',#{self.point(start[1])},#{vector})")
        return self.edge(start, end, line)

    def arc(self, start, end, center, radius) -> int:
        """Counter-clockwise seen from above."""
        circle = self.add(f"CIRCLE('',#{self.placement(center, (0, 0, 1), (1, 0, 0))},{number(radius)})")
        return self.edge(start, end, circle)

    def bound(self, edges, outer: bool) -> int:
        """`edges`: pairs of an edge and whether it runs in its own direction."""
        uses = [self.add(f"ORIENTED_EDGE('',*,*,#{edge},{flag(same)})") for edge, same in edges]
        loop = self.add(f"EDGE_LOOP('',({references(uses)}))")
        return self.add(f"FACE_{'OUTER_' if outer else ''}BOUND('',#{loop},.T.)")

    def face(self, bounds, surface: int, same: bool = True) -> int:
        return self.add(f"ADVANCED_FACE('',({references(bounds)}),#{surface},{flag(same)})")

    def plane(self, origin, z, x) -> int:
        return self.add(f"PLANE('',#{self.placement(origin, z, x)})")

    def solid(self, faces) -> int:
        shell = self.add(f"CLOSED_SHELL('',({references(faces)}))")
        return self.add(f"MANIFOLD_SOLID_BREP('',#{shell})")


def number(x: float) -> str:
    text = repr(round(float(x), 9))
    return text[:-1] if text.endswith(".0") else text


def references(ids) -> str:
    return ",".join(f"#{i}" for i in ids)


def flag(value: bool) -> str:
    return ".T." if value else ".F."


def plate(file: File, index: int) -> int:
    """A plate with four round corners and n × n holes, all sizes depending on `index`."""
    n = 4 + index % 5
    pitch, height = 10 + 0.01 * (index % 97), 3 + 0.1 * (index % 13)
    size, corner, hole = n * pitch, 2 + 0.05 * (index % 11), 2 + 0.03 * (index % 17)
    bounds = {0.0: [], height: []}
    faces = []
    # Around: for each side the flat part, then the corner, anticlockwise from above.
    ways = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    corners = [(0, 0), (size, 0), (size, size), (0, size)]
    rings = {}
    for z in bounds:
        ring = []
        for (dx, dy), (x, y), (ex, ey) in zip(ways, corners, corners[1:] + corners[:1]):
            ring.append(file.vertex((x + dx * corner, y + dy * corner, z)))
            ring.append(file.vertex((ex - dx * corner, ey - dy * corner, z)))
        edges = []
        for i in range(8):
            start, end = ring[i], ring[(i + 1) % 8]
            if i % 2 == 0:
                edges.append(file.line(start, end))
            else:
                dx, dy = ways[i // 2]
                center = (start[1][0] - dy * corner, start[1][1] + dx * corner, z)
                edges.append(file.arc(start, end, center, corner))
        rings[z] = ring, edges
    (low, low_edges), (high, high_edges) = rings[0.0], rings[height]
    up = [file.line(a, b) for a, b in zip(low, high)]
    for i in range(8):
        j = (i + 1) % 8
        bound = file.bound([(low_edges[i], True), (up[j], True), (high_edges[i], False), (up[i], False)], True)
        dx, dy = ways[i // 2]
        if i % 2 == 0:
            surface = file.plane(low[i][1], (dy, -dx, 0), (dx, dy, 0))
        else:
            center = (low[i][1][0] - dy * corner, low[i][1][1] + dx * corner, 0)
            surface = file.add(
                f"CYLINDRICAL_SURFACE('',#{file.placement(center, (0, 0, 1), (1, 0, 0))},{number(corner)})"
            )
        faces.append(file.face([bound], surface))
    bounds[height].append(file.bound([(edge, True) for edge in high_edges], True))
    bounds[0.0].append(file.bound([(edge, False) for edge in reversed(low_edges)], True))
    for i in range(n * n):
        x, y = (i % n + 0.5) * pitch, (i // n + 0.5) * pitch
        ends = [file.vertex((x + hole, y, z)) for z in (0.0, height)]
        circles = [file.arc(v, v, (x, y, v[1][2]), hole) for v in ends]
        seam = file.line(*ends)
        bound = file.bound([(circles[0], True), (seam, True), (circles[1], False), (seam, False)], True)
        axis = file.placement((x, y, 0), (0, 0, 1), (1, 0, 0))
        surface = file.add(f"CYLINDRICAL_SURFACE('',#{axis},{number(hole)})")
        faces.append(file.face([bound], surface, same=False))
        bounds[height].append(file.bound([(circles[1], False)], False))
        bounds[0.0].append(file.bound([(circles[0], True)], False))
    faces.append(file.face(bounds[height], file.plane((0, 0, height), (0, 0, 1), (1, 0, 0))))
    faces.append(file.face(bounds[0.0], file.plane((0, 0, 0), (0, 0, -1), (1, 0, 0))))
    return file.solid(faces)


def wave(file: File, index: int) -> int:
    """A block whose upper side is a bicubic B-spline surface over n × n control points."""
    n, size = 16 + index % 9, 60.0
    step = size / (n - 1)

    def height(i, j):
        return 10 + 1.5 * math.sin(0.7 * i + 0.1 * index) * math.cos(0.5 * j + 0.03 * index)

    net = [[file.point((i * step, j * step, height(i, j))) for j in range(n)] for i in range(n)]
    inner = n - 4
    knots = ",".join(number(i / (inner + 1)) for i in range(inner + 2))
    counts = ",".join(["4"] + ["1"] * inner + ["4"])
    rows = ",".join(f"({references(row)})" for row in net)
    top = file.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({rows}),.UNSPECIFIED.,.F.,.F.,.F.,"
        f"({counts}),({counts}),({knots}),({knots}),.UNSPECIFIED.)"
    )
    sides = [[row[0] for row in net], net[-1], [row[-1] for row in net][::-1], net[0][::-1]]
    corners = [(0, 0), (size, 0), (size, size), (0, size)]
    places = [(0, 0), (n - 1, 0), (n - 1, n - 1), (0, n - 1)]
    low = [file.vertex((x, y, 0)) for x, y in corners]
    high = [file.vertex((x, y, height(i, j))) for (x, y), (i, j) in zip(corners, places)]
    up = [file.line(a, b) for a, b in zip(low, high)]
    faces, low_edges, high_edges = [], [], []
    for k, side in enumerate(sides):
        after = (k + 1) % 4
        low_edges.append(file.line(low[k], low[after]))
        curve = file.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',3,({references(side)}),.UNSPECIFIED.,.F.,.F.,"
            f"({counts}),({knots}),.UNSPECIFIED.)"
        )
        high_edges.append(file.edge(high[k], high[after], curve))
        bound = file.bound(
            [(low_edges[k], True), (up[after], True), (high_edges[k], False), (up[k], False)], True
        )
        dx, dy = [(1, 0), (0, 1), (-1, 0), (0, -1)][k]
        faces.append(file.face([bound], file.plane(low[k][1], (dy, -dx, 0), (dx, dy, 0))))
    faces.append(file.face([file.bound([(edge, True) for edge in high_edges], True)], top))
    bottom = file.bound([(edge, False) for edge in reversed(low_edges)], True)
    faces.append(file.face([bottom], file.plane((0, 0, 0), (0, 0, -1), (1, 0, 0))))
    return file.solid(faces)


def write(out, name: str, make, bytes_wanted: float) -> None:
    out.write(HEADER.format(name=name))
    file = File(out)
    length = file.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )")
    angle = file.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )")
    solid_angle = file.add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )")
    context = file.add(
        "( GEOMETRIC_REPRESENTATION_CONTEXT(3) "
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle})) REPRESENTATION_CONTEXT('','') )"
    )
    application = file.add("APPLICATION_CONTEXT('automotive design')")
    scope = file.add(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
    definition_scope = file.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')")

    def product(label, kind, items):
        made = file.add(f"PRODUCT('{label}','{label}','',(#{scope}))")
        formation = file.add(f"PRODUCT_DEFINITION_FORMATION('','',#{made})")
        definition = file.add(f"PRODUCT_DEFINITION('design','',#{formation},#{definition_scope})")
        shape = file.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        representation = file.add(f"{kind}('',({references(items)}),#{context})")
        file.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
        return definition, representation

    origin = file.placement((0, 0, 0), (0, 0, 1), (1, 0, 0))
    parts, places = [], []
    while file.size < bytes_wanted:
        index = len(parts)
        solid = make(file, index)
        parts.append(product(f"{name} {index}", "ADVANCED_BREP_SHAPE_REPRESENTATION", [solid, origin]))
        places.append(
            file.placement((120 * (index % 32), 120 * (index // 32), 0), (0, 0, 1), (1, 0, 0))
        )
    whole, frame = product(name, "SHAPE_REPRESENTATION", [origin, *places])
    for index, ((part, representation), place) in enumerate(zip(parts, places)):
        use = file.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{index}','','',#{whole},#{part},$)")
        shape = file.add(f"PRODUCT_DEFINITION_SHAPE('','',#{use})")
        move = file.add(f"ITEM_DEFINED_TRANSFORMATION('','',#{origin},#{place})")
        relation = file.add(
            f"( REPRESENTATION_RELATIONSHIP('','',#{representation},#{frame}) "
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{move}) SHAPE_REPRESENTATION_RELATIONSHIP() )"
        )
        file.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})")
    out.write("ENDSEC;\nEND-ISO-10303-21;\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["plates", "waves"])
    parser.add_argument("out")
    parser.add_argument("--megabytes", type=float, default=60)
    arguments = parser.parse_args()
    make = {"plates": plate, "waves": wave}[arguments.kind]
    with open(arguments.out, "w", encoding="ascii", newline="\n") as out:
        write(out, arguments.kind, make, arguments.megabytes * 1e6)


if __name__ == "__main__":
    main()
