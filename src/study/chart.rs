//! Charts as SVG that follows the page's colours: error against time on logarithmic axes, and bars.
//!
//! In: points with a time and an error, in series. Out: markup for [`super::page`]. Nothing here is
//! drawn in a fixed colour: a series has a key, and the style sheet knows the colour of `k-KEY` on
//! light and on dark ground. An error of zero has no place on a logarithmic axis, so it gets a band
//! of its own below it.

use maud::{Markup, html};

use crate::level::wording::duration;

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 46.0;
/// Height of the band for zero, and its distance from the logarithmic part.
const BAND: f64 = 30.0;
const GAP: f64 = 8.0;
const TEXT: f64 = 12.5;
const DOT: f64 = 4.5;

/// Errors against times.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows, for those who cannot see it.
    pub about: String,
    /// What the errors are.
    pub y: &'static str,
    /// The points.
    pub series: Vec<Series>,
    /// Times to compare with: vertical lines.
    pub guides: Vec<Guide>,
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// Key of its colour.
    pub key: &'static str,
    /// Whether a line joins the points, in their order.
    pub joined: bool,
    /// Its points.
    pub points: Vec<Point>,
}

/// A point of a chart.
#[derive(Clone, Debug)]
pub struct Point {
    /// What is written beside it.
    pub label: String,
    /// What it is, in full.
    pub about: String,
    /// The time, in seconds.
    pub seconds: f64,
    /// The least and the greatest time.
    pub spread: [f64; 2],
    /// The error, as a share: 1 for as many as there are.
    pub error: f64,
}

/// A time to compare with.
#[derive(Clone, Debug)]
pub struct Guide {
    /// Key of its colour.
    pub key: &'static str,
    /// What is written beside it.
    pub label: String,
    /// The time, in seconds.
    pub seconds: f64,
}

/// A share in percent, with as many digits as say something: `0 %`, `0.0021 %`, `35 %`, `1,230 %`.
pub fn percent(share: f64) -> String {
    let value = share * 100.0;
    let text = match value {
        0.0 => "0".to_string(),
        v if v >= 999.5 => crate::level::wording::grouped(v.round() as u64),
        v if v >= 99.95 => format!("{v:.0}"),
        v if v >= 9.995 => format!("{v:.1}"),
        v if v >= 0.9995 => format!("{v:.2}"),
        // Two digits that count, however small.
        v => {
            let digits = (1.0 - v.log10().floor()).clamp(0.0, 9.0) as usize;
            format!("{v:.digits$}")
        }
    };
    format!("{text}\u{202f}%")
}

/// A logarithmic axis from one value to another, both positive, on a stretch of the page.
struct Log {
    from: f64,
    to: f64,
    start: f64,
    end: f64,
}

impl Log {
    fn at(&self, value: f64) -> f64 {
        let share = (value / self.from).ln() / (self.to / self.from).ln();
        self.start + share.clamp(0.0, 1.0) * (self.end - self.start)
    }

    /// Powers of ten on the axis, and between them, where there are fewer than `few`, twice and
    /// five times each.
    fn ticks(&self, few: usize) -> Vec<f64> {
        let powers = self.from.log10().floor() as i32..=self.to.log10().ceil() as i32;
        let within = |v: &f64| *v >= self.from * 0.999 && *v <= self.to * 1.001;
        let tens: Vec<f64> = powers
            .clone()
            .map(|k| 10f64.powi(k))
            .filter(within)
            .collect();
        if tens.len() >= few {
            // At most eight, or their texts run into each other.
            let step = tens.len().div_ceil(8);
            return tens.into_iter().step_by(step).collect();
        }
        let finer = |k| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(k));
        powers.flat_map(finer).filter(within).collect()
    }

    /// The ticks that have room for a text this wide, powers of ten before others.
    fn named(&self, ticks: &[f64], width: f64) -> Vec<f64> {
        let is_power = |t: f64| (t.log10() - t.log10().round()).abs() < 0.01;
        let (powers, others): (Vec<f64>, Vec<f64>) = ticks.iter().partition(|t| is_power(**t));
        let mut named: Vec<f64> = Vec::new();
        for tick in powers.into_iter().chain(others) {
            if named
                .iter()
                .all(|n| (self.at(*n) - self.at(tick)).abs() >= width)
            {
                named.push(tick);
            }
        }
        named
    }
}

/// Draws a chart; a sentence in its place if there are no points.
pub fn draw(chart: &Chart) -> Markup {
    let points = || chart.series.iter().flat_map(|s| &s.points);
    if points().next().is_none() {
        return html! { p.none { "Nothing was measured here." } };
    }
    let times = points()
        .flat_map(|p| [p.spread[0], p.spread[1], p.seconds])
        .chain(chart.guides.iter().map(|g| g.seconds));
    let (first, last) = extent(times).unwrap_or((1.0, 1.0));
    let x = Log {
        from: first / 2.2,
        to: last * 3.0,
        start: LEFT,
        end: WIDTH - RIGHT,
    };
    let floor = HEIGHT - BOTTOM - BAND;
    let (least, most) = extent(points().map(|p| p.error)).unwrap_or((2e-3, 0.5));
    let y = Log {
        from: 10f64.powf((least / 1.3).log10().floor()),
        to: 10f64.powf((most * 1.3).log10().ceil()),
        start: floor - GAP,
        end: TOP,
    };
    let zero = floor + BAND / 2.0;
    let place = |p: &Point| {
        let y = if p.error > 0.0 { y.at(p.error) } else { zero };
        (x.at(p.seconds), y)
    };
    let right = WIDTH - RIGHT;
    let bottom = HEIGHT - BOTTOM;
    let labels = Labels::around(chart, place, &x);
    let ticks = x.ticks(3);
    html! {
        svg.chart viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(chart.about) {
            rect.zero x=(LEFT) y=(floor) width=(right - LEFT) height=(BAND) {}
            @for tick in &ticks {
                line.grid x1=(short(x.at(*tick))) x2=(short(x.at(*tick))) y1=(TOP) y2=(bottom) {}
            }
            @for tick in x.named(&ticks, 54.0) {
                text x=(short(x.at(tick))) y=(bottom + 18.0) text-anchor="middle" { (round_duration(tick)) }
            }
            @for tick in y.ticks(2) {
                line.grid x1=(LEFT) x2=(right) y1=(short(y.at(tick))) y2=(short(y.at(tick))) {}
                text x=(LEFT - 8.0) y=(short(y.at(tick) + 4.5)) text-anchor="end" { (round_percent(tick)) }
            }
            text x=(LEFT - 8.0) y=(zero + 4.5) text-anchor="end" { "0" }
            text.axis x=(right) y=(HEIGHT - 6.0) text-anchor="end" { "time, longer →" }
            text.axis x=(LEFT) y=(HEIGHT - 6.0) { "↑ " (chart.y) }
            @for guide in &chart.guides {
                line class=(format!("guide k-{}", guide.key)) x1=(short(x.at(guide.seconds)))
                    x2=(short(x.at(guide.seconds))) y1=(TOP) y2=(bottom) {}
            }
            @for series in &chart.series {
                g class=(format!("k-{}", series.key)) {
                    @if series.joined {
                        polyline.joined points=(joined(series.points.iter().map(place))) {}
                    }
                    @for point in &series.points {
                        @let (px, py) = place(point);
                        g {
                            title { (point.about) }
                            line.spread x1=(short(x.at(point.spread[0]))) x2=(short(x.at(point.spread[1])))
                                y1=(short(py)) y2=(short(py)) {}
                            circle cx=(short(px)) cy=(short(py)) r=(DOT) {}
                        }
                    }
                }
            }
            @for label in labels.placed {
                text class=(format!("label k-{}", label.key)) x=(short(label.frame.0.0))
                    y=(short(label.frame.1.1 - 3.5)) { (label.text) }
            }
        }
    }
}

fn joined(places: impl Iterator<Item = (f64, f64)>) -> String {
    let pairs: Vec<String> = places
        .map(|(x, y)| format!("{},{}", short(x), short(y)))
        .collect();
    pairs.join(" ")
}

/// The least and the greatest of the positive ones.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|v| *v > 0.0).fold(None, |extent, v| {
        let (low, high) = extent.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    })
}

/// A coordinate on the page, to a tenth.
fn short(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}

/// A tick's time: one digit.
fn round_duration(seconds: f64) -> String {
    let text = duration(seconds);
    let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
    let number = match number.split_once('.') {
        Some((whole, part)) => {
            let part = part.trim_end_matches('0');
            if part.is_empty() {
                whole.to_string()
            } else {
                format!("{whole}.{part}")
            }
        }
        None => number.to_string(),
    };
    format!("{number} {unit}")
}

/// A tick's share: one digit.
fn round_percent(share: f64) -> String {
    let value = share * 100.0;
    if value >= 1000.0 {
        return percent(share);
    }
    let digits = (-(value * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$}\u{202f}%")
}

/// A rectangle: its upper left and its lower right corner.
type Frame = ((f64, f64), (f64, f64));

/// A text beside its point.
struct Label<'a> {
    key: &'static str,
    text: &'a str,
    frame: Frame,
}

/// Texts that cover neither points nor each other, as far as that can be had.
struct Labels<'a> {
    placed: Vec<Label<'a>>,
}

impl<'a> Labels<'a> {
    fn around(chart: &'a Chart, place: impl Fn(&Point) -> (f64, f64), x: &Log) -> Self {
        // A point with the line from its least time to its greatest.
        let mark = |p: &Point| -> Frame {
            let (at, y) = place(p);
            let [from, to] = p.spread.map(|s| x.at(s));
            ((from.min(at - DOT), y - DOT), (to.max(at + DOT), y + DOT))
        };
        let marks: Vec<Frame> = chart
            .series
            .iter()
            .flat_map(|s| &s.points)
            .map(mark)
            .collect();
        let mut labels = Labels { placed: Vec::new() };
        for guide in &chart.guides {
            let at = (x.at(guide.seconds), TOP + TEXT * 0.7);
            labels.put(guide.key, &guide.label, (at, at), &marks);
        }
        for series in &chart.series {
            for point in &series.points {
                labels.put(series.key, &point.label, mark(point), &marks);
            }
        }
        labels
    }

    /// Puts a text beside a mark, where it covers least; the sooner listed the better.
    fn put(&mut self, key: &'static str, text: &'a str, (from, to): Frame, marks: &[Frame]) {
        if text.is_empty() {
            return;
        }
        let (width, height) = (text.chars().count() as f64 * TEXT * 0.56, TEXT + 3.0);
        let ((left, right), (above, below)) = ((from.0 - 4.0, to.0 + 4.0), (from.1, to.1));
        let (x, y) = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
        let corners = [
            (right, y - height / 2.0),
            (left - width, y - height / 2.0),
            (x - width / 2.0, above - height),
            (x - width / 2.0, below),
            (x, above - height),
            (x, below),
            (x - width, above - height),
            (x - width, below),
            (x - width / 2.0, above - 2.1 * height),
            (x - width / 2.0, below + 1.1 * height),
            (x - width, above - 2.1 * height),
            (x - width, below + 1.1 * height),
        ];
        let frames = corners.map(|low| (low, (low.0 + width, low.1 + height)));
        let covered = |(low, high): &Frame| {
            let out = (LEFT + 2.0 - low.0).max(0.0)
                + (high.0 - WIDTH + 2.0).max(0.0)
                + (TOP - 8.0 - low.1).max(0.0)
                + (high.1 - (HEIGHT - BOTTOM)).max(0.0);
            let over = |(low2, high2): &Frame| {
                let w = high.0.min(high2.0) - low.0.max(low2.0);
                let h = high.1.min(high2.1) - low.1.max(low2.1);
                w.max(0.0) * h.max(0.0)
            };
            let texts = self.placed.iter().map(|l| over(&l.frame));
            out * 40.0 + marks.iter().map(over).sum::<f64>() * 3.0 + texts.sum::<f64>()
        };
        let best = frames
            .into_iter()
            .min_by(|a, b| covered(a).total_cmp(&covered(b)));
        if let Some(frame) = best {
            self.placed.push(Label { key, text, frame });
        }
    }
}

/// A bar with its figure.
#[derive(Clone, Debug)]
pub struct Bar {
    /// Key of its colour.
    pub key: &'static str,
    /// What it stands for.
    pub name: String,
    /// Its length.
    pub value: f64,
    /// Its length in words.
    pub text: String,
}

/// Bars from zero on, under a heading; the longest takes the whole width.
pub fn bars(heading: &str, bars: &[Bar]) -> Markup {
    let most = bars.iter().map(|b| b.value).fold(0.0, f64::max);
    html! {
        div.bars role="group" aria-label=(heading) {
            h4 { (heading) }
            @for bar in bars {
                @let share = if most > 0.0 { bar.value / most * 100.0 } else { 0.0 };
                div.bar {
                    span.name { (bar.name) }
                    span.track { span class=(format!("fill k-{}", bar.key)) style=(format!("width:{share:.1}%")) {} }
                    span.figure { (bar.text) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(label: &str, seconds: f64, error: f64) -> Point {
        Point {
            label: label.into(),
            about: label.into(),
            seconds,
            spread: [seconds * 0.9, seconds * 1.2],
            error,
        }
    }

    fn chart(points: Vec<Point>) -> Chart {
        Chart {
            about: "errors".into(),
            y: "error",
            series: vec![Series {
                key: "sweep",
                joined: false,
                points,
            }],
            guides: Vec::new(),
        }
    }

    #[test]
    fn shares_in_percent() {
        let text = |share| percent(share).replace('\u{202f}', "");
        assert_eq!(text(0.0), "0%");
        assert_eq!(text(0.000_021_4), "0.0021%");
        assert_eq!(text(0.0999), "9.99%");
        assert_eq!(text(0.352), "35.2%");
        assert_eq!(text(12.344), "1,234%");
        assert_eq!(round_percent(0.01).replace('\u{202f}', ""), "1%");
        assert_eq!(round_percent(1e-5).replace('\u{202f}', ""), "0.001%");
        assert_eq!(round_duration(0.05), "50 ms");
        assert_eq!(round_duration(1.0), "1 s");
    }

    #[test]
    fn zero_lies_below_all_that_is_more() {
        let chart = chart(vec![point("a", 0.001, 0.0), point("b", 1.0, 1e-6)]);
        let svg = draw(&chart).into_string();
        let heights: Vec<f64> = svg
            .split("cy=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
            .collect();
        assert_eq!(heights.len(), 2);
        assert!(
            heights[0] > heights[1] && heights[0] < HEIGHT - BOTTOM,
            "{heights:?}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn odd_data_gives_a_chart() {
        for points in [
            vec![],
            vec![point("alone", 0.5, 0.0)],
            vec![point("no time", 0.0, 0.5), point("much", 1e4, 80.0)],
            (0..30)
                .map(|i| point("same", 0.01, 0.1 * f64::from(i % 2)))
                .collect(),
        ] {
            let svg = draw(&chart(points)).into_string();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
