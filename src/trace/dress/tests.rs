//! Texels worked out by hand, in two rooms with a step and a lintel between them, and in Freedoom.

use super::*;
use crate::cells::{CellId, Doors, Locator, Options, Subdivision, subdivide};
use crate::level::doom::graphics;
use crate::level::dress::PictureName;
use crate::level::read::Source;
use crate::level::wad::tests::wad_bytes;
use crate::trace::cast::{Met, Place, walk};
use crate::trace::ray::Ray;

/// Two rooms of 64 by 64. West: floor 0, ceiling 125, light 160. East: floor 24, ceiling 96. The line
/// between them runs south, so that its front is to the west; further fields of it, its west side
/// and its sectors can be given.
fn rooms(line: &str, west_side: &str, west: &str, east: &str) -> String {
    let mut text = "namespace = \"ZDoom\";\n".to_string();
    for (x, y) in [(0, 0), (64, 0), (128, 0), (0, 64), (64, 64), (128, 64)] {
        text += &format!("vertex {{ x = {x}; y = {y}; }}\n");
    }
    // Clockwise: the front is inside. The south wall of the west room is the first.
    for (v1, v2, side) in [
        (1, 0, 0),
        (0, 3, 0),
        (3, 4, 0),
        (4, 5, 1),
        (5, 2, 1),
        (2, 1, 1),
    ] {
        text += &format!("linedef {{ v1 = {v1}; v2 = {v2}; sidefront = {side}; {line} }}\n");
    }
    text += &format!(
        "linedef {{ v1 = 4; v2 = 1; sidefront = 0; sideback = 1; twosided = true; {line} }}\n"
    );
    let hung = "texturetop = \"T\"; texturemiddle = \"T\"; texturebottom = \"T\";";
    text += &format!("sidedef {{ sector = 0; {hung} offsetx = 5; offsety = 2; {west_side} }}\n");
    text += &format!("sidedef {{ sector = 1; {hung} offsetx = 9; }}\n");
    text += &format!(
        "sector {{ heightfloor = 0; heightceiling = 125; lightlevel = 160;
        texturefloor = \"FLAT\"; textureceiling = \"FLAT\"; {west} }}\n"
    );
    text += &format!(
        "sector {{ heightfloor = 24; heightceiling = 96;
        texturefloor = \"FLAT\"; textureceiling = \"FLAT\"; {east} }}\n"
    );
    text
}

struct Dressed {
    graph: CellGraph,
    space: Space,
    wardrobe: Wardrobe,
}

/// A picture in which the texel in column c, row r is (c, r, blue).
fn chart(width: u32, height: u32, blue: u8) -> Picture {
    let texel = |i: u32| [(i % width) as u8, (i / width) as u8, blue, 255];
    Picture {
        width,
        height,
        pixels: (0..width * height).map(texel).collect(),
    }
}

/// Textures are charts of 32 by 16 (blue 1), with a hole in column 8, row 12; flats are charts of 64
/// by 64 (blue 2), skies of 256 by 128 (blue 3).
fn dressed(text: &str, doors: Doors) -> Dressed {
    let bytes = wad_bytes(&[
        ("MAP01", b"".as_slice()),
        ("TEXTMAP", text.as_bytes()),
        ("ENDMAP", b""),
    ]);
    let source = Source::parse(bytes, "test.wad").unwrap();
    let level = source.level(None).unwrap();
    let options = Options {
        doors,
        ..Options::default()
    };
    let graph = subdivide(&level, &options);
    let space = Space::with_gratings(&level, &graph);
    let picture = |name: &PictureName| match name {
        PictureName::Texture(name) if name == "SKY1" => Some(chart(256, 128, 3)),
        PictureName::Texture(name) if name == "T" => {
            let mut chart = chart(32, 16, 1);
            chart.pixels[12 * 32 + 8] = [0; 4];
            Some(chart)
        }
        PictureName::Flat(_) => Some(chart(64, 64, 2)),
        PictureName::Texture(_) => None,
    };
    let pictures = level.scene.dress.pictures.iter().map(picture).collect();
    let wardrobe = Wardrobe::new(&level, &graph, &space, pictures).unwrap();
    Dressed {
        graph,
        space,
        wardrobe,
    }
}

/// What a texel of a chart looks like.
fn texel(column: u8, row: u8, blue: u8) -> Look {
    Look::Texel(linear([column, row, blue]))
}

fn linear(rgb: [u8; 3]) -> DVec3 {
    DVec3::from(rgb.map(|c| decode(f64::from(c) / 255.0)))
}

impl Dressed {
    fn cell(&self, x: f64, y: f64) -> CellId {
        let at = self.graph.grid.nearest(DVec2::new(x, y)).unwrap();
        Locator::new(&self.graph).cell_at(&self.graph, at).unwrap()
    }

    /// From a point in a direction: what is met first.
    fn met(&self, from: [f64; 3], direction: [f64; 3]) -> (Met, DVec3) {
        let ray = Ray {
            origin: from.into(),
            direction: direction.into(),
        };
        let place = Place {
            cell: self.cell(from[0].floor(), from[1].floor()),
            on: None,
        };
        let met = walk(&self.space, &ray, place, f64::INFINITY, |_, _| {
            f64::INFINITY
        })
        .unwrap();
        (met, ray.at(met.t))
    }

    fn look(&self, from: [f64; 3], direction: [f64; 3]) -> Look {
        let (met, point) = self.met(from, direction);
        self.wardrobe.look(met.surface, point)
    }
}

fn look(line: &str, from: [f64; 3], direction: [f64; 3]) -> Look {
    dressed(&rooms(line, "", "", ""), Doors::Open).look(from, direction)
}

const EAST: [f64; 3] = [1.0, 0.0, 0.0];
const WEST: [f64; 3] = [-1.0, 0.0, 0.0];
const SOUTH: [f64; 3] = [0.0, -1.0, 0.0];

#[test]
fn a_wall_hangs_from_its_ceiling_or_stands_on_its_floor() {
    // The south wall, seen from the north: its left end is (64, 0). Column 64 - 20.5 + 5 = 48.5, that
    // is 16 of 32. Row 125 - 100.5 + 2 = 26.5, that is 10 of 16.
    assert_eq!(look("", [20.5, 30.0, 100.5], SOUTH), texel(16, 10, 1));
    // From the floor: the uppermost row begins at z = 16: 16 - 3.5 + 2 = 14.5.
    let pegged = "dontpegbottom = true;";
    assert_eq!(look(pegged, [20.5, 30.0, 3.5], SOUTH), texel(16, 14, 1));
    assert_eq!(look(pegged, [20.5, 30.0, 15.5], SOUTH), texel(16, 2, 1));
    // At z = 100.5: 16 - 100.5 + 2 = -82.5, that is 13.5 after six repetitions.
    assert_eq!(look(pegged, [20.5, 30.0, 100.5], SOUTH), texel(16, 13, 1));
}

#[test]
fn a_step_counts_from_its_edge_or_from_the_ceiling() {
    // The left end is (64, 64). Column 64 - 60.5 + 5 = 8.5; row 24 - 20.5 + 2 = 5.5.
    assert_eq!(look("", [30.0, 60.5, 20.5], EAST), texel(8, 5, 1));
    // Row 125 - 20.5 + 2 = 106.5, that is 10 of 16.
    let unpegged = "dontpegbottom = true;";
    assert_eq!(look(unpegged, [30.0, 60.5, 20.5], EAST), texel(8, 10, 1));
}

#[test]
fn a_lintel_stands_on_its_edge_or_hangs_from_the_ceiling() {
    // Its lowest row ends at z = 96, so the uppermost begins at 112: 112 - 100.5 + 2 = 13.5.
    assert_eq!(look("", [30.0, 60.5, 100.5], EAST), texel(8, 13, 1));
    // Row 125 - 100.5 + 2 = 26.5, that is 10 of 16.
    let unpegged = "dontpegtop = true;";
    assert_eq!(look(unpegged, [30.0, 60.5, 100.5], EAST), texel(8, 10, 1));
}

#[test]
fn a_grating_is_drawn_once_and_has_holes() {
    // Hung from z = 96: row 96 - 90.5 + 2 = 7.5; below row 15, that is below 82, nothing.
    assert_eq!(look("", [30.0, 60.5, 90.5], EAST), texel(8, 7, 1));
    assert_eq!(look("", [30.0, 60.5, 70.5], EAST), Look::Hole);
    // The offset moves it up, not around: row 0 begins at 98, which is hidden.
    assert_eq!(look("", [30.0, 60.5, 95.5], EAST), texel(8, 2, 1));
    // Row 12, column 8 is clear: 96 - 85.5 + 2 = 12.5. On a wall that is no hole.
    assert_eq!(look("", [30.0, 60.5, 85.5], EAST), Look::Hole);
    assert_eq!(
        look("", [60.5, 30.0, 114.5], SOUTH),
        Look::Texel(DVec3::ZERO)
    );
    // Standing on z = 24: it begins at 40: 40 - 30.5 + 2 = 11.5.
    let unpegged = "dontpegbottom = true;";
    assert_eq!(look(unpegged, [30.0, 60.5, 30.5], EAST), texel(8, 11, 1));
    assert_eq!(look(unpegged, [30.0, 60.5, 50.5], EAST), Look::Hole);
    // From behind the left end is (64, 0), the offsets are (9, 0): column 10.5 + 9, row 96 - 90.5.
    assert_eq!(look("", [100.0, 10.5, 90.5], WEST), texel(19, 5, 1));
    // Beyond the hole the ray goes on in the other room.
    let rooms = dressed(&rooms("", "", "", ""), Doors::Open);
    let (met, point) = rooms.met([30.0, 60.5, 70.5], EAST);
    let Surface::Pane(e) = met.surface else {
        panic!("{met:?}")
    };
    assert!(rooms.wardrobe.lets_pass(met.surface, point));
    let twin = rooms.graph.edge(e).twin().unwrap();
    let place = Place {
        cell: rooms.graph.edge(twin).cell,
        on: Some(met.surface),
    };
    let ray = Ray {
        origin: point,
        direction: DVec3::X,
    };
    let met = walk(&rooms.space, &ray, place, f64::INFINITY, |_, _| {
        f64::INFINITY
    })
    .unwrap();
    assert_eq!(ray.at(met.t).x, 128.0);
}

#[test]
fn parts_of_a_side_are_moved_and_scaled_by_themselves() {
    let side = "offsetx_top = 3; offsety_top = 1; scalex_top = 2; scaley_top = 0.5;
        offsety_bottom = 4;";
    let rooms = dressed(&rooms("", side, "", ""), Doors::Open);
    // Column 2 · (64 - 60.5) + 5 + 3 = 15. The picture is 32 units high, so it begins at 128: row
    // (128 - 100.5) / 2 + 2 + 1 = 16.75, that is 0.
    assert_eq!(rooms.look([30.0, 60.25, 100.5], EAST), texel(15, 0, 1));
    assert_eq!(rooms.look([30.0, 60.5, 20.5], EAST), texel(8, 9, 1));
}

#[test]
fn flats_lie_on_the_grid_of_the_map() {
    let rooms = dressed(&rooms("", "", "", ""), Doors::Open);
    // North is up: row 0 ends in the north at y = 64, so y = 10.5 is in row 53.
    for direction in [-1.0, 1.0] {
        let seen = rooms.look([70.5, 10.5, 60.0], [0.0, 0.0, direction]);
        assert_eq!(seen, texel(6, 53, 2));
    }
}

#[test]
fn flats_are_turned_moved_and_scaled() {
    let lies = "xpanningfloor = 16; ypanningfloor = 8; xscalefloor = 2; yscalefloor = 0.5;
        rotationfloor = 90; yscaleceiling = -1; xpanningceiling = 3; xscaleceiling = 0;";
    let rooms = dressed(&rooms("", "", lies, ""), Doors::Open);
    let seen = |z| rooms.look([10.25, 20.75, 60.0], [0.0, 0.0, z]);
    // Turned by 90° the point is in column -20.75, row -10.25; moved in column -4.75, row -2.25; scaled
    // in column -9.5, row -1.125. Of 64: 54 and 62.
    assert_eq!(seen(-1.0), texel(54, 62, 2));
    // Column 13.25; row -20.75 mirrored. A scale of 0 is none.
    assert_eq!(seen(1.0), texel(13, 20, 2));
}

#[test]
fn what_is_not_dressed_shows_what_lies_beyond() {
    let side = "texturetop = \"-\"; texturebottom = \"-\"; texturemiddle = \"NONE\";";
    let closed = dressed(&rooms("", side, "", ""), Doors::Open);
    // Column 64 - 60.5, row -20.5, that is 43 of 64.
    assert_eq!(closed.look([30.0, 60.5, 20.5], EAST), texel(3, 43, 2));
    assert_eq!(closed.look([30.0, 60.5, 100.5], EAST), texel(3, 27, 2));
    assert_eq!(closed.look([20.5, 30.0, 100.5], SOUTH), Look::Bare);
    let open = rooms("", side, "textureceiling = \"F_SKY1\";", "");
    assert_eq!(
        dressed(&open, Doors::Open).look([30.0, 60.5, 100.5], EAST),
        Look::Sky
    );
}

#[test]
fn between_two_skies_is_sky() {
    let sky = "textureceiling = \"F_SKY1\";";
    let unpegged = "dontpegbottom = true;";
    let rooms = dressed(&rooms(unpegged, "", sky, sky), Doors::Open);
    assert_eq!(rooms.look([30.0, 60.5, 100.5], EAST), Look::Sky);
    assert_eq!(rooms.look([30.0, 60.5, 60.5], [0.0, 0.0, 1.0]), Look::Sky);
    // And a step counts from the ceiling beyond: 96 - 20.5 + 2 = 77.5, that is 13.
    assert_eq!(rooms.look([30.0, 60.5, 20.5], EAST), texel(8, 13, 1));
}

#[test]
fn the_sky_turns_to_the_left() {
    let sky = "textureceiling = \"F_SKY1\";";
    let rooms = dressed(&rooms("", "", sky, sky), Doors::Open);
    let sky = |degrees: f64, slope: f64| {
        let flat = DVec2::from_angle(degrees.to_radians());
        rooms.wardrobe.sky(flat.extend(slope)).unwrap()
    };
    // 256 columns to a quarter: a degree is 2.84 columns.
    assert_eq!(sky(0.1, -0.001), linear([0, 100, 3]));
    assert_eq!(sky(45.1, -0.001), linear([128, 100, 3]));
    assert_eq!(sky(-0.1, -0.001), linear([255, 100, 3]));
    assert_eq!(sky(90.1, -0.001), linear([0, 100, 3]));
    // The cylinder's radius is 1024 / 2π = 163 columns: at a slope of a quarter, 40.7 rows up.
    assert_eq!(sky(0.1, 0.25), linear([0, 59, 3]));
    // Below its foot the last row goes on; above, there is one colour.
    assert_eq!(sky(0.1, -1.0), linear([0, 127, 3]));
    assert_eq!(sky(0.1, 2.0), sky(77.0, 3.0));
    assert_eq!(rooms.wardrobe.sky(DVec3::Z), Some(sky(0.1, 2.0)));
}

#[test]
fn light_is_that_of_the_sector_and_turns_with_the_walls() {
    let rooms = dressed(&rooms("", "", "", ""), Doors::Open);
    let light = |direction| {
        let (met, _) = rooms.met([30.0, 30.0, 10.0], direction);
        rooms.wardrobe.light(met.surface)
    };
    let level = |l: f64| decode(l / 255.0);
    assert_eq!(light([0.0, 0.0, -1.0]), level(160.0));
    assert!((light(SOUTH) - level(144.0)).abs() < 1e-12);
    assert!((light(EAST) - level(176.0)).abs() < 1e-12);
}

#[test]
fn a_door_that_counts_as_a_wall_wears_its_upper_texture() {
    // The east room is closed and opens by a line's special (ZDoom's Door_Raise, tag 7).
    let door = "heightceiling = 24; id = 7;";
    let text = rooms("special = 12; arg0 = 7;", "", "", door);
    for (doors, wall) in [(Doors::Open, false), (Doors::Closed, true)] {
        let rooms = dressed(&text, doors);
        let (met, point) = rooms.met([30.0, 60.5, 100.5], EAST);
        assert_eq!(matches!(met.surface, Surface::Wall(_)), wall);
        // It stands on z = 24 and begins at 40: 40 - 100.5 + 2 = -58.5, that is 5.5.
        assert_eq!(rooms.wardrobe.look(met.surface, point), texel(8, 5, 1));
    }
}

/// Textures and flats around the player's start in Freedoom's E1M1, looked up in the WAD by hand.
#[test]
fn around_the_start_of_e1m1() {
    let path = "/usr/share/games/doom/freedoom1.wad";
    let Ok(bytes) = std::fs::read(path) else {
        assert!(
            std::env::var("CI").is_err(),
            "{path} is not there; install Freedoom"
        );
        eprintln!("skipped: {path} is not there; install Freedoom");
        return;
    };
    let source = Source::parse(bytes, "freedoom1.wad").unwrap();
    let wad = source.wad().unwrap();
    let level = source.level(Some("E1M1")).unwrap();
    for subdivision in Subdivision::ALL {
        let graph = subdivide(
            &level,
            &Options {
                subdivision,
                ..Options::default()
            },
        );
        let space = Space::with_gratings(&level, &graph);
        let pictures = graphics::pictures(wad, &level.scene.dress);
        assert!(pictures.iter().all(Option::is_some));
        let wardrobe = Wardrobe::new(&level, &graph, &space, pictures).unwrap();
        let dressed = Dressed {
            graph,
            space,
            wardrobe,
        };
        let graphics = graphics::Graphics::new(wad).unwrap();
        // The start is (-160, 304), the floor at 0, the ceiling at 128.
        let camera = &level.scene.cameras[0];
        assert_eq!(camera.name, "player");
        assert_eq!(
            (camera.eye, camera.direction),
            (DVec3::new(-160.0, 304.0, 41.0), DVec3::X)
        );
        let check = |direction: [f64; 3], z: f64, picture: Picture, column: u32, row: u32| {
            let seen = dressed.look([-159.5, 304.5, z], direction);
            let at = row % picture.height * picture.width + column % picture.width;
            let [r, g, b, _] = picture.pixels[at as usize];
            assert_eq!(seen, Look::Texel(linear([r, g, b])));
        };
        let texture = |name| graphics.texture(name).unwrap();
        // Line 544, (-192, 512) to (16, 512), offset (64, 0): column 32.5 + 64.
        check([0.0, 1.0, 0.0], 40.5, texture("AQRUST08"), 96, 87);
        // Line 543, (-192, 64) to (-192, 512), no offset: column 240.5.
        check(WEST, 40.5, texture("AQRUST08"), 240, 87);
        // Line 580, (0, 448) to (0, 192), offset (-64, 0), from a room 136 high that lies beyond one of
        // 128; its upper texture is unpegged: column 143.5 - 64, row 136 - 132.5.
        let (met, _) = dressed.met([-20.0, 304.5, 132.5], EAST);
        let seen = dressed
            .wardrobe
            .look(met.surface, DVec3::new(0.0, 304.5, 132.5));
        assert!(matches!(met.surface, Surface::Lintel(_)));
        let trim = texture("AQTRIM05");
        let [r, g, b, _] = trim.pixels[(3 * trim.width + 79 % trim.width) as usize];
        assert_eq!(seen, Look::Texel(linear([r, g, b])));
        // Floor and ceiling: column 32.5 of 64, row -304.5, that is 15.
        check(
            [0.0, 0.0, -1.0],
            40.5,
            graphics.flat("AQF024").unwrap(),
            32,
            15,
        );
        check(
            [0.0, 0.0, 1.0],
            40.5,
            graphics.flat("SLIME14").unwrap(),
            32,
            15,
        );
    }
}
