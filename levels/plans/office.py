"""Writes office.dxf with ezdxf (pip install ezdxf): an office with walls of two lines.

Layers as architects name them: A-WALL, A-COLS, A-DOOR, A-GLAZ, I-FURN, A-ANNO-DIMS, A-AREA-IDEN,
A-WALL-PATT. Doors are one block, mirrored, turned and scaled; the double door and the round bay are
drawn with arcs and bulges; millimetres ($INSUNITS 4).
"""

import sys

import ezdxf

doc = ezdxf.new("R2010", setup=True)
doc.units = ezdxf.units.MM
msp = doc.modelspace()
for name, color in [
    ("A-WALL", 7), ("A-COLS", 8), ("A-DOOR", 3), ("A-GLAZ", 4), ("I-FURN", 6),
    ("A-ANNO-DIMS", 2), ("A-AREA-IDEN", 5), ("A-WALL-PATT", 9),
]:
    doc.layers.add(name, color=color)


def wall(points, closed=False):
    msp.add_lwpolyline(points, close=closed, dxfattribs={"layer": "A-WALL"})


# The block of a door of 900 mm: hinge at (0, 0), leaf open upwards, arc to the strike at (900, 0).
door = doc.blocks.new("DOOR-900")
door.add_lwpolyline([(0, 0), (40, 0), (40, 900), (0, 900)], close=True)
door.add_arc((0, 0), 900, 0, 90)


def place_door(at, rotation=0, xscale=1, yscale=1):
    msp.add_blockref("DOOR-900", at, dxfattribs={
        "layer": "A-DOOR", "rotation": rotation, "xscale": xscale, "yscale": yscale})


# The block of a window of 1 m: two panes of glass and the sill, in a wall of 300 mm.
window = doc.blocks.new("WINDOW-1000")
for y in (0, 130, 170, 300):
    window.add_line((0, y), (1000, y), dxfattribs={"layer": "A-GLAZ"})


def place_window(at, width, rotation=0):
    msp.add_blockref("WINDOW-1000", at, dxfattribs={
        "layer": "A-GLAZ", "rotation": rotation, "xscale": width / 1000})


# Outside 12.6 m by 8.6 m, walls of 300 mm: one closed polyline, with gaps for the entrance (1.8 m) and
# a window, and a round bay at the end of the corridor (bulges of half circles); and the pier between.
outer = [(0, 0, 0), (5400, 0, 0), (5400, 300, 0), (300, 300, 0), (300, 8300, 0), (12300, 8300, 0),
         (12300, 4900, -1), (12300, 3520, 0), (12300, 300, 0), (10200, 300, 0), (10200, 0, 0),
         (12600, 0, 0), (12600, 3220, 1), (12600, 5200, 0), (12600, 8600, 0), (0, 8600, 0)]
msp.add_lwpolyline(outer, format="xyb", close=True, dxfattribs={"layer": "A-WALL"})
wall([(7200, 0), (8200, 0), (8200, 300), (7200, 300)], closed=True)
# Inner walls of 120 mm: a corridor from west to east, three offices north of it, two rooms south.
NORTH, SOUTH, I = 4900, 3400, 120


def along_x(y, x0, x1):
    """A piece of wall as single lines, capped where a door begins."""
    lines = [((x0, y), (x1, y)), ((x0, y + I), (x1, y + I))]
    lines += [((x, y), (x, y + I)) for x in (x0, x1) if x not in (300, 12300)]
    for a, b in lines:
        msp.add_line(a, b, dxfattribs={"layer": "A-WALL"})


for x0, x1 in [(300, 2900), (3800, 4400), (5300, 9000), (9900, 12300)]:
    along_x(NORTH, x0, x1)
for x0, x1 in [(300, 3100), (4000, 7700), (8600, 12300)]:
    along_x(SOUTH, x0, x1)
# Cross walls: between the offices, and between the rooms in the south, with a door in it.
for x in (4040, 8040):
    for side in (x, x + I):
        msp.add_line((side, 5020), (side, 8300), dxfattribs={"layer": "A-WALL"})
wall([(4700, 3400), (4700, 2000), (4820, 2000), (4820, 3400)])
wall([(4700, 300), (4700, 1100), (4820, 1100), (4820, 300)])
# Doors: one mirrored in x, one in y, one turned about.
place_door((2900, NORTH))
place_door((5300, NORTH), xscale=-1)
place_door((9000, NORTH + I), yscale=-1)
place_door((4000, SOUTH + I), rotation=180)
place_door((7700, SOUTH))
place_door((4820, 1100), rotation=90)
# The entrance: two leaves with arcs, drawn as they are.
for hinge, way in [(5400, 1), (7200, -1)]:
    msp.add_line((hinge, 150), (hinge, 150 + 900), dxfattribs={"layer": "A-DOOR"})
    msp.add_arc((hinge, 150), 900, 0 if way > 0 else 90, 90 if way > 0 else 180,
                dxfattribs={"layer": "A-DOOR"})
# Windows: one in a gap of the south wall, three over the north wall, which runs on behind them.
place_window((8200, 0), 2000)
place_window((1200, 8300), 1800)
place_window((5200, 8300), 1800)
place_window((9400, 8300), 1800)
# Columns: a circle, an ellipse, and a filled square.
msp.add_circle((8600, 2000), 200, dxfattribs={"layer": "A-COLS"})
msp.add_ellipse((11000, 4300), (250, 0), 0.6, dxfattribs={"layer": "A-COLS"})
msp.add_solid([(10500, 1500), (10800, 1500), (10500, 1800), (10800, 1800)], dxfattribs={"layer": "A-COLS"})
# Furniture, dimensions, hatching, texts: what does not matter for sight.
desk = doc.blocks.new("DESK")
desk.add_lwpolyline([(0, 0), (1600, 0), (1600, 800), (0, 800)], close=True)
chair = doc.blocks.new("CHAIR")
chair.add_circle((0, 0), 250)
desk.add_blockref("CHAIR", (800, -300))
for x, y in [(600, 6800), (4600, 6800), (8600, 6800), (1000, 1200)]:
    msp.add_blockref("DESK", (x, y), dxfattribs={"layer": "I-FURN"})
dim = msp.add_linear_dim(base=(0, -800), p1=(0, 0), p2=(12600, 0), dxfattribs={"layer": "A-ANNO-DIMS"})
dim.render()
hatch = msp.add_hatch(color=9, dxfattribs={"layer": "A-WALL-PATT"})
hatch.paths.add_polyline_path([(7200, 0), (8200, 0), (8200, 300), (7200, 300)], is_closed=True)
for text, at in [("Anna", (1500, 7800)), ("Boris", (5500, 7800)), ("Meeting", (9500, 7800)),
                 ("Corridor", (1500, 4100)), ("Archive", (1500, 2500)), ("Lobby", (9000, 2600))]:
    msp.add_text(text, height=250, dxfattribs={"layer": "A-AREA-IDEN"}).set_placement(at)
msp.add_mtext("{\\fArial|b0;Archive}\\P13.9 m²", dxfattribs={"layer": "A-AREA-IDEN", "char_height": 150,
              "insert": (1000, 900)})
doc.saveas(sys.argv[1] if len(sys.argv) > 1 else "office.dxf")
if len(sys.argv) > 2:
    doc.saveas(sys.argv[2], fmt="bin")
