"""Writes dungeon.dd2vtt: a map as table-top programs write them, with closed and open portals, a portal
in a wall that runs on behind it, pillars as objects, a cave, and lights. One square is 5 feet."""

import json
import math
import sys


def line(*points):
    return [{"x": x, "y": y} for x, y in points]


def portal(a, b, closed):
    (ax, ay), (bx, by) = a, b
    return {
        "position": {"x": (ax + bx) / 2, "y": (ay + by) / 2},
        "bounds": line(a, b),
        "rotation": math.atan2(by - ay, bx - ax),
        "closed": closed,
        "freestanding": False,
    }


def pillar(x, y, r=0.5):
    ring = [(x + r, y), (x, y + r), (x - r, y), (x, y - r), (x + r, y)]
    return line(*ring)


def light(x, y, reach, color="ffeccd8b"):
    return {"position": {"x": x, "y": y}, "range": reach, "intensity": 1, "color": color, "shadows": True}


dungeon = {
    "format": 0.3,
    "resolution": {"map_origin": {"x": 0, "y": 0}, "map_size": {"x": 24, "y": 18}, "pixels_per_grid": 128},
    "line_of_sight": [
        line((10, 6), (10, 8), (7, 8)),
        line((5, 8), (2, 8), (2, 2), (10, 2), (10, 4)),
        line((10, 4), (16, 4)),
        line((10, 6), (16, 6)),
        line((16, 4), (17, 2.5), (19.5, 1.75), (22.25, 3), (23, 6.5), (21.5, 9.25), (18.5, 9.75), (16.75, 8), (16, 6)),
        line((5, 8), (5, 10), (4, 10), (4, 16), (8, 16), (8, 10), (7, 10), (7, 8)),
        line((8, 12), (12, 12), (12, 15), (8, 15)),
    ],
    "objects_line_of_sight": [pillar(4, 4), pillar(8, 4), pillar(4, 6), pillar(8, 6)],
    "portals": [
        portal((10, 4), (10, 6), True),
        portal((16, 4), (16, 6), False),
        portal((5, 8), (7, 8), True),
        portal((8, 13), (8, 14), True),
    ],
    "environment": {"baked_lighting": True, "ambient_light": "ff303040"},
    "lights": [light(6, 5, 8), light(19.5, 5.5, 6, "ff8bb4ec"), light(6, 13, 5)],
    "image": "",
}
with open(sys.argv[1] if len(sys.argv) > 1 else "dungeon.dd2vtt", "w") as out:
    json.dump(dungeon, out, indent=1)
    out.write("\n")
