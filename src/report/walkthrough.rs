//! A walk as a page with charts, and as JSON: what culling saves along the way, and what frames cost.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::{Value, json};

use crate::walk::figures::{Frame, Spread, Summary};

/// A walk that was drawn.
pub struct Walk<'a> {
    /// Name of the level.
    pub level: &'a str,
    /// Its file.
    pub source: &'a str,
    /// What the walk is called.
    pub route: &'a str,
    /// How frames were drawn.
    pub renderer: &'static str,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Frames per second.
    pub fps: f64,
    /// How long it takes.
    pub seconds: f64,
    /// How long the way is, with its unit.
    pub length: &'a str,
    /// Each frame.
    pub frames: &'a [Frame],
    /// What they come to.
    pub summary: &'a Summary,
}

/// The figures for programs.
pub fn json(walk: &Walk) -> Value {
    json!({
        "format": "enfilade.walk",
        "version": 1,
        "level": {"name": walk.level, "source": walk.source},
        "walk": {
            "name": walk.route,
            "renderer": walk.renderer,
            "size": walk.size,
            "fps": walk.fps,
            "seconds": walk.seconds,
            "length": walk.length,
        },
        "summary": walk.summary,
        "frames": walk.frames,
    })
}

const STYLE: &str = include_str!("walkthrough.css");

/// A page that needs nothing else.
pub fn page(walk: &Walk) -> String {
    let summary = walk.summary;
    let factor = |k: usize| along(walk.frames, move |f| f.polygons.factors()[k]);
    let culling = Chart {
        about: "Culling factor along the walk: all polygons to those painted",
        logarithmic: true,
        lines: vec![
            ("facing", "backs alone", factor(0)),
            ("pvs", "with the PVS", factor(1)),
            ("eye", "with what the eye sees", factor(2)),
        ],
    };
    let cells = Chart {
        about: "Cells along the walk",
        logarithmic: true,
        lines: vec![
            (
                "pvs",
                "in the PVS of the eye's cell",
                along(walk.frames, |f| f.cells_pvs as f64),
            ),
            (
                "eye",
                "that the eye sees within the picture",
                along(walk.frames, |f| f.polygons.cells as f64),
            ),
        ],
    };
    let times = Chart {
        about: "Milliseconds to draw a frame",
        logarithmic: true,
        lines: vec![(
            "time",
            walk.renderer,
            along(walk.frames, |f| f.milliseconds_draw),
        )],
    };
    let counted = walk.frames.iter().any(|f| f.polygons.all > 0);
    let title = format!("{}: {}", walk.level, walk.route);
    let [width, height] = walk.size;
    let reuse = &summary.reuse;
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body { main {
                p.kicker { "enfilade walk · " (walk.source) }
                h1 { (title) }
                p.lede {
                    (format!("{} in {:.1} seconds, {} frames of {width} × {height}. ",
                        walk.length, walk.seconds, walk.frames.len()))
                    @if counted {
                        "In the median frame, one in " b { (short(summary.factor_eye.median)) }
                        " polygons of the level has to be painted."
                    }
                }
                @if counted {
                    h2 { "What culling saves" }
                    p { "All polygons of the level, divided by those that are painted. Without any culling \
                         but that of backs; with the cells of the PVS of the eye's cell only; with the cells \
                         that the eye sees within the angle of the picture." }
                    (draw(&culling, walk.seconds))
                    (table(&[
                        ("backs alone", summary.factor_facing),
                        ("with the PVS", summary.factor_pvs),
                        ("with what the eye sees", summary.factor_eye),
                    ]))
                    h2 { "Cells" }
                    (draw(&cells, walk.seconds))
                }
                h2 { "Time" }
                (draw(&times, walk.seconds))
                (table(&[("milliseconds a frame", summary.milliseconds_draw)]))
                h2 { "What neighbouring frames share" }
                p { (format!("{} of {} frames lie in the cell of the frame before, and take over its PVS and \
                     the effects that can matter there. To find these out took {} ms for the whole walk; {} ms \
                     if every frame had cost what those in a new cell did.",
                     reuse.frames, summary.frames, short(reuse.milliseconds), short(reuse.milliseconds_without))) }
            } }
        }
    }
    .into_string()
}

fn along(frames: &[Frame], value: impl Fn(&Frame) -> f64) -> Vec<[f64; 2]> {
    let start = frames.first().map_or(0.0, |f| f.seconds);
    frames
        .iter()
        .map(|f| [f.seconds - start, value(f)])
        .collect()
}

fn table(rows: &[(&str, Spread)]) -> Markup {
    html! {
        table {
            thead { tr { th {} th { "least" } th { "median" } th { "most" } } }
            tbody { @for (name, s) in rows {
                tr {
                    th scope="row" { (name) }
                    td { (short(s.least)) } td { (short(s.median)) } td { (short(s.most)) }
                }
            } }
        }
    }
}

/// With about three digits that count.
fn short(x: f64) -> String {
    match x.abs() {
        a if a >= 99.95 => format!("{x:.0}"),
        a if a >= 9.995 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    }
}

/// Numbers over time.
struct Chart {
    about: &'static str,
    logarithmic: bool,
    /// Key of the colour, name, and points: seconds and value.
    lines: Vec<(&'static str, &'static str, Vec<[f64; 2]>)>,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 40.0;
/// Points of a line: more cannot be seen.
const POINTS: usize = 900;

/// A figure with its legend.
fn draw(chart: &Chart, seconds: f64) -> Markup {
    let values = || chart.lines.iter().flat_map(|l| &l.2).map(|p| p[1]);
    let most = values().fold(1e-3, f64::max);
    let least = values().filter(|v| *v > 0.0).fold(most, f64::min);
    let (low, high) = if chart.logarithmic {
        (10f64.powf(least.log10().floor()), most * 1.15)
    } else {
        (0.0, most * 1.05)
    };
    let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    let y = |v: f64| {
        let share = if chart.logarithmic {
            (v.max(low) / low).ln() / (high / low).ln()
        } else {
            (v - low) / (high - low)
        };
        bottom - share * (bottom - TOP)
    };
    let x = |t: f64| LEFT + t / seconds.max(1e-9) * (right - LEFT);
    let step = nice(seconds / 8.0);
    let times = (0..).map(|k| f64::from(k) * step);
    let times: Vec<f64> = times.take_while(|t| *t <= seconds).collect();
    let marks = marks(low, high);
    html! {
        figure {
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(chart.about) {
                @for v in &marks {
                    line.grid x1=(LEFT) x2=(right) y1=(at(y(*v))) y2=(at(y(*v))) {}
                    text x=(LEFT - 8.0) y=(at(y(*v) + 4.5)) text-anchor="end" { (v) }
                }
                @for t in &times {
                    line.grid x1=(at(x(*t))) x2=(at(x(*t))) y1=(TOP) y2=(bottom) {}
                    text x=(at(x(*t))) y=(bottom + 18.0) text-anchor="middle" { (t) }
                }
                text.axis x=(right) y=(HEIGHT - 4.0) text-anchor="end" { "seconds of the walk" }
                @for (key, _, points) in &chart.lines {
                    polyline class=(format!("k-{key}")) points=(polyline(points, x, y)) {}
                }
            }
            figcaption {
                @for (key, name, _) in &chart.lines {
                    span { i class=(format!("k-{key}")) {} (name) }
                }
            }
        }
    }
}

/// 1, 2 or 5 times a power of ten, not below `x`.
fn nice(x: f64) -> f64 {
    let power = 10f64.powf(x.max(1e-6).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * power);
    steps.into_iter().find(|s| *s >= x).unwrap_or(10.0 * power)
}

/// Numbers for a logarithmic axis: powers of ten, twice and five times each.
fn marks(low: f64, high: f64) -> Vec<f64> {
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let all = powers.flat_map(|k| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(k)));
    // As decimal fractions, not as their products come out.
    let clean = all.map(|v| format!("{v:.6}").parse().unwrap_or(v));
    clean.filter(|v| *v >= low && *v <= high).collect()
}

fn at(x: f64) -> String {
    format!("{x:.1}")
}

fn polyline(points: &[[f64; 2]], x: impl Fn(f64) -> f64, y: impl Fn(f64) -> f64) -> String {
    let stride = points.len().div_ceil(POINTS).max(1);
    let shown = points.iter().step_by(stride);
    let texts: Vec<String> = shown
        .map(|p| format!("{:.1},{:.1}", x(p[0]), y(p[1])))
        .collect();
    texts.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_numbers() {
        assert_eq!(nice(0.9), 1.0);
        assert_eq!(nice(3.0), 5.0);
        assert_eq!(nice(60.0), 100.0);
        assert_eq!(marks(0.1, 3.0), [0.1, 0.2, 0.5, 1.0, 2.0]);
    }

    #[test]
    fn a_page_of_an_empty_walk_is_no_accident() {
        let summary = Summary::of(&[]);
        let walk = Walk {
            level: "L <1>",
            source: "l.toml",
            route: "tour",
            renderer: "preview",
            size: [4, 3],
            fps: 5.0,
            seconds: 0.0,
            length: "0 m",
            frames: &[],
            summary: &summary,
        };
        let page = page(&walk);
        assert!(page.contains("L &lt;1&gt;"));
        assert_eq!(json(&walk)["frames"], json!([]));
    }
}
