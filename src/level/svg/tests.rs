use super::*;
use crate::level::snap::snap;
use crate::level::{Finding, Level, WallKind};

fn level_with(content: &str, root: &str, options: &DrawingOptions) -> Level {
    let text = svg(content, root);
    let draft = read(&text, "plan.svg", options).unwrap_or_else(|e| panic!("{e}\n{text}"));
    snap(draft).unwrap()
}

fn svg(content: &str, root: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" {root}>\n{content}\n</svg>"
    )
}

/// In metres, on a page of 20 by 10.
fn level(content: &str) -> Level {
    let options = DrawingOptions {
        unit: Some("m".parse().unwrap()),
        ..DrawingOptions::default()
    };
    level_with(content, "viewBox=\"0 0 20 10\"", &options)
}

fn message(content: &str) -> String {
    read(
        &svg(content, "viewBox=\"0 0 20 10\""),
        "plan.svg",
        &DrawingOptions::default(),
    )
    .unwrap_err()
    .to_string()
}

fn found<'a>(level: &'a Level, code: &str) -> &'a Finding {
    let found = level.findings.iter().find(|f| f.code == code);
    found.unwrap_or_else(|| panic!("no {code} in {:#?}", level.findings))
}

fn rooms(level: &Level) -> String {
    let message = &found(level, "room").message;
    message["Inside: ".len()..message.find(". Areas").unwrap()].to_string()
}

fn area(level: &Level) -> f64 {
    let message = &found(level, "room").message;
    let word = message.split("together ").nth(1).unwrap();
    word.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn shapes() {
    let pi = std::f64::consts::PI;
    for (shape, expected) in [
        ("<rect x='1' y='1' width='4' height='3'/>", 12.0),
        (
            "<rect x='1' y='1' width='4' height='3' rx='1'/>",
            12.0 - (4.0 - pi),
        ),
        ("<polygon points='1,1 5,1 5,4 1,4'/>", 12.0),
        ("<polyline points='1,1 5,1 5,4 1,4 1,1'/>", 12.0),
        ("<circle cx='5' cy='5' r='2'/>", 4.0 * pi),
        ("<ellipse cx='5' cy='5' rx='2' ry='1'/>", 2.0 * pi),
        ("<path d='M1 1H5V4H1z'/>", 12.0),
        ("<path d='m1,1 4,0 0,3 -4,0 z'/>", 12.0),
        ("<path d='M3 1a2 2 0 0 1 0 4a2 2 0 0 1 0 -4'/>", 4.0 * pi),
        ("<path d='M1 1C1 3 5 3 5 1z'/>", 4.8),
        ("<path d='M1 1Q3 4 5 1z'/>", 4.0),
        ("<path d='M1 1Q2 2 3 1T5 1V4H1z'/>", 12.0),
        ("<path d='M1 1C1 2 3 2 3 1S5 0 5 1V4H1z'/>", 12.0),
        (
            "<g transform='translate(2 3) scale(2)'><rect width='2' height='1'/></g>",
            8.0,
        ),
        (
            "<g transform='rotate(30)'><rect x='4' width='2' height='1' transform='skewX(20)'/></g>",
            2.0,
        ),
        (
            "<g transform='matrix(0 1 -1 0 8 0)'><rect x='1' width='2' height='3'/></g>",
            6.0,
        ),
    ] {
        let level = level(&format!("<g class='wall' fill='none'>{shape}</g>"));
        assert_eq!(level.sectors.len(), 1, "{shape}");
        assert!(
            (area(&level) - expected).abs() < 0.1,
            "{shape}: {} {expected}",
            area(&level)
        );
    }
}

#[test]
fn y_goes_up_and_units_are_those_of_the_page() {
    let wall = "<rect class='wall' fill='none' x='1' y='2' width='4' height='3'/>";
    let level = level(wall);
    let top = level.walls.iter().map(|w| level.grid.to_level(w.from).y);
    assert_eq!(top.fold(0.0, f64::max), 8.0);
    let plain = DrawingOptions::default();
    let page = "width='200mm' height='100mm' viewBox='0 0 20 10'";
    let paper = level_with(wall, page, &plain);
    assert_eq!(paper.unit, "mm");
    let right = paper.walls.iter().map(|w| paper.grid.to_level(w.from).x);
    assert!((right.fold(0.0, f64::max) - 50.0).abs() < 1e-6);
    assert_eq!(
        level_with(wall, "width='20' height='10'", &plain).unit,
        "px"
    );
}

#[test]
fn names_tell_what_is_drawn() {
    let plan = "<style>.hidden { display: none } .wall rect { fill: none }</style>
        <g inkscape:groupmode='layer' inkscape:label='Walls EG' fill='none'>
          <path d='M0 0H8V4H0z M4 0V1.5 M4 2.5V4'/>
          <g class='hidden'><path d='M2 0V4'/></g>
        </g>
        <g inkscape:groupmode='layer' inkscape:label='Doors'><line x1='4' y1='1.5' x2='4' y2='2.5'/></g>
        <rect class='window' x='1' y='-0.1' width='2' height='0.2'/>
        <g id='furniture'><circle cx='2' cy='2' r='0.5'/></g>
        <path id='north-arrow' d='M9 1V0'/>
        <text x='1' y='3' font-size='0.5'>Kitchen</text>
        <text x='5' y='3' font-size='0.5'><tspan>Hall</tspan><tspan dy='1'>16 m²</tspan></text>";
    let level = level(plan);
    assert_eq!(rooms(&level), "2 rooms of together 32 m²");
    let mut names: Vec<_> = level
        .sectors
        .iter()
        .map(|s| s.name.clone().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["Hall", "Kitchen"]);
    let openings = level
        .walls
        .iter()
        .filter(|w| matches!(w.kind, WallKind::Opening(_)));
    assert_eq!(openings.count(), 2);
    found(&level, "furniture");
    assert!(found(&level, "ignored").message.contains("hidden element"));
}

#[test]
fn filled_walls_are_solid() {
    let outline = "<rect class='wall' fill='none' x='1' y='1' width='8' height='8'/>";
    let block = "<path class='wall' d='M3 3H6V6H3z'/>";
    assert_eq!(
        rooms(&level(&format!("{outline}{block}"))),
        "1 room of together 55 m²"
    );
    let light = block.replace("d=", "style='fill:#eee' d=");
    assert_eq!(
        rooms(&level(&format!("{outline}{light}"))),
        "2 rooms of together 64 m²"
    );
    // A filled ring is solid between its two outlines only.
    let ring = "<path class='wall' fill-rule='evenodd' d='M3 3H7V7H3z M4 4H6V6H4z'/>";
    assert_eq!(
        rooms(&level(&format!("{outline}{ring}"))),
        "2 rooms of together 52 m²"
    );
    let column = "<circle id='column3' fill='none' cx='5' cy='5' r='1'/>";
    let level = level(&format!("{outline}{column}"));
    assert_eq!(level.sectors.len(), 1);
    found(&level, "solid");
}

#[test]
fn used_doors_swing() {
    let walls = "<path class='wall' fill='none' d='M0 0H8V4H0z M4 0V1 M4 1.9V4'/>";
    let symbol =
        "<defs><g id='d'><path d='M0 0V-0.9'/><path d='M0 -0.9A0.9 0.9 0 0 1 0.9 0'/></g></defs>";
    let curved = symbol.replace("A0.9 0.9 0 0 1 0.9 0", "C0.497 -0.9 0.9 -0.497 0.9 0");
    for symbol in [symbol, &curved] {
        let door = "<g id='doors'><use href='#d' transform='translate(4 1) rotate(90)'/></g>";
        let level = level(&format!("{symbol}{walls}{door}"));
        assert_eq!(rooms(&level), "2 rooms of together 32 m²", "{symbol}");
        let openings = level
            .walls
            .iter()
            .filter(|w| matches!(w.kind, WallKind::Opening(_)));
        assert_eq!(openings.count(), 1);
    }
}

#[test]
fn symbols_and_inner_pages_fit_their_boxes() {
    let symbol = "<symbol id='s' viewBox='0 0 10 10'><rect width='10' height='5'/></symbol>
        <use class='wall' fill='none' href='#s' x='1' y='1' width='4' height='4'/>";
    assert_eq!(rooms(&level(symbol)), "1 room of together 8 m²");
    let inner = "<svg x='2' y='2' width='8' height='4' viewBox='0 0 4 4' fill='none'>
        <rect class='wall' width='4' height='4'/></svg>";
    assert_eq!(rooms(&level(inner)), "1 room of together 16 m²");
    let stretched = inner.replace("viewBox", "preserveAspectRatio='none' viewBox");
    assert_eq!(rooms(&level(&stretched)), "1 room of together 32 m²");
}

#[test]
fn mistakes_have_a_place() {
    assert!(
        message("<path class='wall' d='M0 0 L1 oops'/>").starts_with("line 2, column "),
        "{}",
        message("<path class='wall' d='M0 0 L1 oops'/>")
    );
    assert!(message("<g><path d='M0 0'").starts_with("line "));
    assert!(message("<rect class='wall' width='wide'/>").contains("`width`"));
    assert!(message("<g transform='turn(3)'/>").contains("`transform`"));
    assert!(message("<g/>").contains("--layer wall=NAME"));
    let far = message("<path class='wall' d='M0 0 L1e300 0 L0 1e300z'/>");
    assert!(far.contains("too large"), "{far}");
    let html = read("<html/>", "plan.svg", &DrawingOptions::default()).unwrap_err();
    assert!(html.to_string().contains("<html>"));
    let circle = "<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>";
    assert!(
        message(circle).contains("without end: "),
        "{}",
        message(circle)
    );
}

#[test]
fn drawings_that_multiply_are_refused() {
    let mut laughs = String::from("<defs><g id='l0'><path class='wall' d='M0 0H1'/></g>");
    for i in 1..12 {
        let uses = format!("<use href='#l{}'/>", i - 1).repeat(10);
        laughs += &format!("<g id='l{i}'>{uses}</g>");
    }
    assert!(message(&format!("{laughs}</defs><use href='#l11'/>")).contains("1000000 elements"));
    let deep = format!("{}{}", "<g>".repeat(900), "</g>".repeat(900));
    assert!(
        message(&deep).contains("nested more than"),
        "{}",
        message(&deep)
    );
    let mut entities = String::from("<!DOCTYPE svg [<!ENTITY a0 'ha'>");
    for i in 1..12 {
        entities += &format!("<!ENTITY a{i} '{}'>", format!("&a{};", i - 1).repeat(10));
    }
    let text = format!("{entities}]><svg xmlns='http://www.w3.org/2000/svg'><g>&a11;</g></svg>");
    let error = read(&text, "plan.svg", &DrawingOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("line "), "{error}");
}

/// The same lines as usvg draws, which reads SVG by itself.
#[test]
fn usvg_draws_the_same() {
    use resvg::usvg;
    let house = include_str!("../../../levels/plans/house.svg");
    let own = drawing(house, "house.svg", &DrawingOptions::default()).unwrap();
    let tree = usvg::Tree::from_str(house, &usvg::Options::default()).unwrap();
    let mut theirs: Vec<DVec2> = Vec::new();
    let mut groups = vec![tree.root()];
    while let Some(group) = groups.pop() {
        for node in group.children() {
            match node {
                usvg::Node::Group(inner) => groups.push(inner),
                usvg::Node::Path(path) => {
                    let t = path.abs_transform();
                    theirs.extend(path.data().points().iter().map(|p| {
                        let (x, y) = (f64::from(p.x), f64::from(p.y));
                        DVec2::new(
                            f64::from(t.sx) * x + f64::from(t.kx) * y + f64::from(t.tx),
                            f64::from(t.ky) * x + f64::from(t.sy) * y + f64::from(t.ty),
                        )
                    }));
                }
                _ => {}
            }
        }
    }
    // usvg's page is in px and goes down: 12 m are 45354 px.
    let size = tree.size();
    let scale = 12_000.0 / f64::from(size.width());
    let theirs: Vec<DVec2> = (theirs.iter())
        .map(|p| DVec2::new(p.x, f64::from(size.height()) - p.y) * scale)
        .collect();
    let symbols = own.symbols.iter().flat_map(|s| s.lines.iter());
    let own: Vec<DVec2> = (own.strokes.iter().filter(|s| s.from.distance(s.to) > 600.0))
        .chain(symbols)
        .flat_map(|s| [s.from, s.to])
        .collect();
    assert!(own.len() > 40, "{}", own.len());
    for p in own {
        let nearest = theirs
            .iter()
            .map(|q| q.distance(p))
            .fold(f64::MAX, f64::min);
        assert!(nearest < 0.1, "{p} is {nearest} mm from the next of usvg's");
    }
}

#[test]
fn grounds_of_colour_are_no_walls() {
    let walls = "<rect x='4' y='2' width='6' height='5' fill='none' stroke='#000'/>";
    for ground in [
        "<rect width='20' height='10' fill='white'/>",
        "<g style='fill:#eee;stroke:none'><path d='M0,0H20V10H0Z'/></g>",
        "<style>.page{fill:rgb(250,250,240)}</style><rect class='page' width='20' height='10'/>",
    ] {
        let level = level(&format!("{ground}{walls}"));
        assert_eq!(rooms(&level), "1 room of together 30 m²", "{ground}");
        let ignored = &found(&level, "ignored").message;
        assert!(ignored.contains("nothing names"), "{ignored}");
    }
    // What a name tells is kept, whatever it looks like.
    let named = "<rect class='wall' x='1' y='1' width='4' height='3' fill='white'/>";
    assert_eq!(rooms(&level(named)), "1 room of together 12 m²");
}

#[test]
fn an_opening_that_reaches_into_a_filled_wall_makes_no_room_of_it() {
    // Two rooms of filled walls 0.2 thick; the opening between them was drawn too long, into the wall on
    // the left.
    let wall = |x: f64, y: f64, w: f64, h: f64| {
        format!("<rect class='wall' x='{x}' y='{y}' width='{w}' height='{h}' fill='#000'/>")
    };
    let walls = [
        wall(1.0, 1.0, 5.0, 0.2),
        wall(1.0, 8.8, 5.0, 0.2),
        wall(1.0, 1.2, 0.2, 7.6),
        wall(5.8, 1.2, 0.2, 7.6),
        wall(1.2, 4.9, 4.6, 0.2),
    ]
    .concat();
    let opening = "<rect class='opening' x='0.5' y='4.9' width='2.5' height='0.2' fill='#fff'/>";
    let level = level(&(walls + opening));
    assert_eq!(level.sectors.len(), 2, "{:?}", level.findings);
}

#[test]
fn one_path_of_too_many_pieces_is_refused_in_bounded_memory() {
    let arcs = "A1e9 1e9 0 1 1 5 5A1e9 1e9 0 1 1 0 0".repeat(5000);
    let curves = "C0 1e9 1e9 1e9 5 5C1e9 0 0 1e9 0 0".repeat(5000);
    for way in [arcs, curves] {
        let message = message(&format!("<path class='wall' d='M0 0{way}'/>"));
        assert!(
            message.contains("line 2, column 1") && message.contains("points"),
            "{message}"
        );
    }
}
