//! How many samples, reflections and shadow rays are enough: error against time.
//!
//! Truth is a reference with many samples (1024 unless time runs short), the mean of pictures with
//! different seeds, none of which any of the compared pictures has.

use glam::DVec3;
use maud::{Markup, html};
use serde::Serialize;

use super::difference::{Difference, Screen};
use super::{About, RayCounts, Shot, Take, draw_all, frame};
use crate::level::wording::{duration, grouped};
use crate::pvs::Progress;
use crate::study::chart::{self, Chart, Point, Series, percent};
use crate::study::page::page as document;
use crate::study::visibility::{Bench, Spread};
use crate::trace::Tracer;
use crate::trace::effects::Effect;
use crate::trace::picture::{Exposure, Picture};
use crate::trace::render::{Adaptive, RenderOptions, render};
use crate::trace::shade::Limits;

/// Samples in one pass of the reference.
const PASS: u32 = 64;
/// Depth and threshold of the reference: what is beyond is darker than a screen can show.
const REFERENCE: (u32, f64) = (12, 1.0 / 65_536.0);
/// The part of the budget that is over when the reference is taken as it is, and when everything
/// has been drawn once.
const REFERRED: f64 = 0.4;
const ONCE: f64 = 0.85;

/// The figures of `enfilade study antialiasing`.
#[derive(Clone, Debug, Serialize)]
pub struct AntialiasingStudy {
    /// `enfilade.study`
    pub format: &'static str,
    /// Of this layout.
    pub version: u32,
    /// `antialiasing`
    pub kind: &'static str,
    /// What was studied.
    pub about: About,
    /// Seconds that it took.
    pub seconds: f64,
    /// What was simulated: all that the picture calls for.
    pub effects: String,
    /// The reference.
    pub reference: Reference,
    /// The pictures that were compared with it, series after series.
    pub series: Vec<Group>,
    #[serde(skip)]
    pictures: Vec<(String, Screen)>,
}

/// The picture that counts as true.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Samples in each pixel.
    pub samples: u32,
    /// As many as were asked for.
    pub wanted: u32,
    /// Most reflections and refractions in a row.
    pub depth: u32,
    /// Least share of a pixel for which a ray was cast.
    pub threshold: f64,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Pictures that differ in one setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The setting.
    pub setting: &'static str,
    /// What the others were.
    pub others: String,
    /// Why it is not here, if so.
    pub left_out: Option<String>,
    /// The pictures.
    pub runs: Vec<Run>,
}

/// A picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// The setting's value.
    pub value: f64,
    /// In words.
    pub label: String,
    /// How long it took; `None` if there was no time for it.
    pub seconds: Option<Spread>,
    /// Rays.
    pub rays: Option<RayCounts>,
    /// Pixels that got more samples.
    pub refined: u64,
    /// How far it is from the reference.
    pub difference: Option<Difference>,
}

/// What is to be drawn of one setting.
struct Plan {
    setting: &'static str,
    others: String,
    left_out: Option<String>,
    /// Value, words, options.
    takes: Vec<(f64, String, RenderOptions)>,
}

/// Draws the reference with `wanted` samples, and then everything else.
pub fn study(shot: &Shot, wanted: u32, bench: &mut dyn Bench) -> AntialiasingStudy {
    let (truth, reference) = refer(shot, wanted.max(1), bench);
    let exposure = Exposure::Stops(truth.factor(Exposure::Auto).log2());
    let plans = plans(shot, exposure);
    let mut takes: Vec<Take> = plans
        .iter()
        .flat_map(|p| &p.takes)
        .map(|(_, label, options)| Take::new(label.clone(), *options))
        .collect();
    // One of each setting in turn, so that time that runs short leaves something of each.
    let order = in_turn(plans.iter().map(|p| p.takes.len()));
    draw_all(shot, &mut takes, &order, bench, ONCE);
    let truth = Screen::of(&truth, exposure);
    let mut pictures = vec![("reference".to_string(), truth.clone())];
    let mut drawn = takes.iter();
    let groups = plans.into_iter().map(|plan| {
        let runs = plan.takes.into_iter().zip(&mut drawn);
        let runs = runs.map(|((value, label, _), take)| {
            let screen = take
                .drawn
                .as_ref()
                .map(|d| Screen::of(&d.picture, exposure));
            let difference = screen.as_ref().map(|s| s.difference(&truth));
            if let Some(screen) = screen.filter(|_| plan.setting == "samples") {
                pictures.push((label.clone(), screen));
            }
            Run {
                value,
                label,
                seconds: take.spread(),
                rays: take.rays(),
                refined: take.drawn.as_ref().map_or(0, |d| d.refined),
                difference,
            }
        });
        Group {
            setting: plan.setting,
            others: plan.others,
            left_out: plan.left_out,
            runs: runs.collect(),
        }
    });
    let series = groups.collect();
    AntialiasingStudy {
        format: "enfilade.study",
        version: 1,
        kind: "antialiasing",
        about: shot.about.clone(),
        effects: shot.options.effects.to_string(),
        reference,
        series,
        seconds: bench.now(),
        pictures,
    }
}

/// Numbers of things that lie in groups of these sizes, one after the other: the first of each
/// group, the second of each, and so on.
fn in_turn(sizes: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut places = Vec::new();
    let mut first = 0;
    for size in sizes {
        places.extend((0..size).map(|i| (i, first + i)));
        first += size;
    }
    places.sort_unstable();
    places.into_iter().map(|(_, place)| place).collect()
}

/// The reference: the mean of passes until there are enough samples, or no time is left for more.
fn refer(shot: &Shot, wanted: u32, bench: &mut dyn Bench) -> (Picture, Reference) {
    let tracer = Tracer::new(shot.world);
    let [width, height] = shot.camera.size;
    let mut sum = vec![DVec3::ZERO; width as usize * height as usize];
    let (mut samples, mut seconds, mut pass) = (0, 0.0, 0u64);
    let end = REFERRED * shot.about.budget;
    while samples < wanted && (samples == 0 || bench.now() < end) {
        let n = PASS.min(wanted - samples);
        bench.next(&format!(
            "the reference, sample {} of {wanted}",
            samples + 1
        ));
        let options = RenderOptions {
            samples: n,
            adaptive: None,
            limits: Limits {
                depth: REFERENCE.0,
                threshold: REFERENCE.1,
                ..shot.options.limits
            },
            // Apart from all seeds that people give.
            seed: shot.options.seed ^ (0x5eed_0000_0000_0000 + pass),
            ..shot.options
        };
        let cost = bench.run(None, &mut |progress: &Progress| {
            let drawn = render(&tracer, &shot.camera, shot.start, &options, progress);
            for (sum, colour) in sum.iter_mut().zip(&drawn.picture.pixels) {
                *sum += *colour * f64::from(n);
            }
        });
        (samples, seconds, pass) = (samples + n, seconds + cost.seconds, pass + 1);
    }
    let picture = Picture {
        size: shot.camera.size,
        pixels: sum.into_iter().map(|c| c / f64::from(samples)).collect(),
    };
    let reference = Reference {
        samples,
        wanted,
        depth: REFERENCE.0,
        threshold: REFERENCE.1,
        seconds,
    };
    (picture, reference)
}

fn plans(shot: &Shot, exposure: Exposure) -> Vec<Plan> {
    let usual = shot.options;
    let limits = usual.limits;
    let samples = |n| RenderOptions {
        samples: n,
        adaptive: None,
        ..usual
    };
    let within = |samples: u32, limits: Limits| RenderOptions {
        samples,
        adaptive: None,
        limits,
        ..usual
    };
    let has = |effects: &[Effect]| effects.iter().any(|&e| usual.effects.has(e));
    let secondary = has(&[
        Effect::Mirror,
        Effect::Glossy,
        Effect::Refraction,
        Effect::Translucency,
    ]);
    let no_rays = (!secondary).then(|| "nothing in sight reflects or lets light pass".to_string());
    let no_lamps = (!has(&[Effect::Soft])).then(|| "no light in sight has an extent".to_string());
    let each = |n: u32| {
        if n == 1 {
            "1 sample".to_string()
        } else {
            format!("{n} samples")
        }
    };
    let rest = |what: &str| {
        format!(
            "{what}, depth {}, threshold {:.4}",
            limits.depth, limits.threshold
        )
    };
    let fixed = [1, 4, 9, 16, 36, 64].map(|n| (f64::from(n), each(n), samples(n)));
    let adaptive = [(1, 16), (1, 64), (4, 16), (4, 64)].map(|(first, most)| {
        let options = RenderOptions {
            adaptive: Some(Adaptive {
                samples: most,
                contrast: 0.05,
                exposure,
            }),
            ..samples(first)
        };
        (f64::from(most), format!("{first} to {most}"), options)
    });
    let depth = [0, 1, 2, 3, 4, 5, 8].map(|depth| {
        let options = within(16, Limits { depth, ..limits });
        (f64::from(depth), format!("depth {depth}"), options)
    });
    let lights = [4, 16, 64, 256].map(|light_samples| {
        let options = within(
            4,
            Limits {
                light_samples,
                ..limits
            },
        );
        (
            f64::from(light_samples),
            format!("{light_samples} rays"),
            options,
        )
    });
    let threshold = [0.3, 0.1, 0.03, 0.01, 0.001].map(|threshold| {
        let options = within(
            16,
            Limits {
                threshold,
                ..limits
            },
        );
        (threshold, format!("threshold {threshold}"), options)
    });
    let plan = |setting, others, left_out: Option<String>, takes: Vec<_>| Plan {
        setting,
        others,
        takes: if left_out.is_some() {
            Vec::new()
        } else {
            takes
        },
        left_out,
    };
    vec![
        plan(
            "samples",
            rest("as many in every pixel"),
            None,
            fixed.into(),
        ),
        plan(
            "adaptive",
            rest("more where neighbours differ by 5 %"),
            None,
            adaptive.into(),
        ),
        plan(
            "depth",
            format!("16 samples, threshold {:.4}", limits.threshold),
            no_rays.clone(),
            depth.into(),
        ),
        plan("light samples", rest("4 samples"), no_lamps, lights.into()),
        plan(
            "threshold",
            format!("16 samples, depth {}", limits.depth),
            no_rays,
            threshold.into(),
        ),
    ]
}

impl AntialiasingStudy {
    fn group(&self, setting: &str) -> Option<&Group> {
        self.series
            .iter()
            .find(|g| g.setting == setting && !g.runs.is_empty())
    }

    /// Sentences about each setting: what to pick.
    pub fn advice(&self) -> Vec<(&'static str, String)> {
        let mut list = Vec::new();
        let measured = |group: &Group| -> Vec<(String, f64, f64)> {
            let runs = group.runs.iter();
            runs.filter_map(|r| Some((r.label.clone(), r.seconds?.median, r.difference?.rmse)))
                .collect()
        };
        if let Some(fixed) = self.group("samples").map(measured)
            && let (Some(first), Some(last)) = (fixed.first(), fixed.last())
        {
            list.push((
                "samples",
                format!(
                    "{} in each pixel leave an error of {} and take {}; {} leave {} and take {} ({:.1} times as long).",
                    first.0, percent(first.2), duration(first.1),
                    last.0, percent(last.2), duration(last.1), last.1 / first.1
                ),
            ));
            if let Some(adaptive) = self.group("adaptive").map(measured) {
                // The adaptive picture that beats a fixed one of at least its quality by most.
                let gains = adaptive.iter().filter_map(|a| {
                    let as_good = fixed.iter().filter(|f| f.2 <= a.2 * 1.02);
                    let fixed = as_good.min_by(|x, y| x.1.total_cmp(&y.1))?;
                    Some((fixed.1 / a.1, a, fixed))
                });
                let best = gains.max_by(|x, y| x.0.total_cmp(&y.0));
                list.push((
                    "adaptive",
                    match best {
                        Some((gain, a, fixed)) if gain > 1.05 => format!(
                            "Adaptive sampling ({}) comes as near in {} as {} everywhere in {}: {gain:.1} times as fast.",
                            a.0, duration(a.1), fixed.0, duration(fixed.1)
                        ),
                        _ => "Adaptive sampling gains nothing here: the error is not at the edges alone.".to_string(),
                    },
                ));
            }
        }
        let enough = |setting: &'static str, what: &str| -> Option<(&'static str, String)> {
            let runs = measured(self.group(setting)?);
            let best = runs.iter().map(|r| r.2).fold(f64::INFINITY, f64::min);
            // From where on more does not help by a twentieth.
            let found = runs.iter().find(|r| r.2 <= best * 1.05)?;
            let dearest = runs.iter().map(|r| r.1).fold(0.0, f64::max);
            Some((
                setting,
                format!(
                    "{what} {}: an error of {} in {}; the most that was tried takes {} and is no more than a twentieth better.",
                    found.0,
                    percent(found.2),
                    duration(found.1),
                    duration(dearest)
                ),
            ))
        };
        list.extend(enough("depth", "Reflections: pick"));
        list.extend(enough("light samples", "Penumbras: pick"));
        list.extend(enough("threshold", "Faint rays: pick"));
        list
    }
}

/// The page.
pub fn page(study: &AntialiasingStudy) -> String {
    let (about, reference) = (&study.about, &study.reference);
    let body = html! {
        p.kicker { "enfilade · study of sampling" }
        h1 { "How many rays are enough for " (about.level) "?" }
        p.lede {
            "A pixel shows a small square of the world, and a ray only a point of it. More rays come \
            nearer to the truth, and cost time. Here the truth is a picture with "
            (reference.samples) " rays in every pixel, which took " (duration(reference.seconds)) "."
            @if reference.samples < reference.wanted {
                " (There was no time for the " (reference.wanted) " that were asked for.)"
            }
        }
        div.pick {
            p { b { "In short" } }
            ul { @for (_, text) in study.advice() { li { (text) } } }
        }
        div.pair {
            @for (label, screen) in &study.pictures {
                @if label == "reference" {
                    (frame::picture(screen, &html! { "The reference: " (reference.samples) " samples." }, "The reference"))
                } @else if label == "1 sample" || label == "16 samples" {
                    (frame::picture(screen, &html! { (label) "." }, label))
                }
            }
        }
        @for group in &study.series { (section(study, group)) }
        (frame::measured(about, study.seconds))
    };
    document(
        &format!("Sampling {}: error against time", about.level),
        &body,
    )
}

fn section(study: &AntialiasingStudy, group: &Group) -> Markup {
    let (title, question) = match group.setting {
        "samples" => (
            "Samples in every pixel",
            "Error falls as one over the square root of the samples where chance reigns (soft shadows, gloss), faster at edges.",
        ),
        "adaptive" => (
            "Samples where they matter",
            "A few samples everywhere; more in pixels that differ from a neighbour.",
        ),
        "depth" => (
            "Depth of reflection",
            "How many mirrors or panes in a row a ray may follow.",
        ),
        "light samples" => (
            "Rays to lamps",
            "A lamp with an extent casts a penumbra; each ray asks whether one point of it is in sight.",
        ),
        _ => (
            "Faint rays",
            "A ray whose share of the pixel's colour is less than the threshold is not cast.",
        ),
    };
    let key = match group.setting {
        "samples" => "fixed",
        "adaptive" => "adaptive",
        "depth" => "depth",
        "light samples" => "lights",
        _ => "threshold",
    };
    let points = |group: &Group| -> Vec<Point> {
        let runs = group.runs.iter();
        runs.filter_map(|run| {
            let (seconds, difference) = (run.seconds?, run.difference?);
            Some(Point {
                label: run.label.clone(),
                about: format!(
                    "{}: {}, error {}",
                    run.label,
                    duration(seconds.median),
                    percent(difference.rmse)
                ),
                seconds: seconds.median,
                spread: [seconds.min, seconds.max],
                error: difference.rmse,
            })
        })
        .collect()
    };
    let mut series = vec![Series {
        key,
        joined: true,
        points: points(group),
    }];
    // To be compared with the same everywhere.
    if let (true, Some(fixed)) = (group.setting == "adaptive", study.group("samples")) {
        series.push(Series {
            key: "fixed",
            joined: true,
            points: points(fixed),
        });
    }
    let advice = study.advice();
    html! {
        h2 { (title) }
        p { (question) }
        @if let Some(reason) = &group.left_out {
            p.none { "Not studied: " (reason) "." }
        } @else {
            div.pair {
                figure {
                    h4 { "Error against time" }
                    (chart::draw(&Chart {
                        about: format!("{title}: error against time"),
                        y: "error",
                        series,
                        guides: Vec::new(),
                    }))
                }
                (table(group))
            }
            @if let Some((_, text)) = advice.iter().find(|(s, _)| *s == group.setting) {
                div.pick { p { (text) } }
            }
            p.aside { "The rest: " (group.others) "." }
        }
    }
}

fn table(group: &Group) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th scope="col" { (group.setting) }
                th scope="col" { "Time" }
                th scope="col" { "Rays" }
                th scope="col" { "Error" }
                th scope="col" { "Alike" }
            } }
            tbody {
                @for run in &group.runs {
                    tr {
                        th scope="row" {
                            (run.label)
                            @if run.refined > 0 { small { (grouped(run.refined)) " pixels refined" } }
                        }
                        td { (frame::time(run.seconds.as_ref())) }
                        td { (run.rays.map_or("–".to_string(), |r| grouped(r.all()))) }
                        td { (run.difference.map_or("–".to_string(), |d| percent(d.rmse))) }
                        td { (run.difference.map_or("–".to_string(), |d| format!("{:.2}\u{202f}%", d.likeness * 100.0))) }
                    }
                }
            }
        } }
    }
}

/// The figures as a table for a terminal.
pub fn rows(study: &AntialiasingStudy) -> Vec<[String; 5]> {
    let runs = study.series.iter().flat_map(|g| &g.runs);
    runs.map(|run| {
        [
            run.label.clone(),
            run.seconds.map_or("-".to_string(), |s| duration(s.median)),
            run.rays.map_or("-".to_string(), |r| grouped(r.all())),
            run.difference
                .map_or("-".to_string(), |d| format!("{:.3} %", d.rmse * 100.0)),
            run.difference
                .map_or("-".to_string(), |d| format!("{:.2} %", d.likeness * 100.0)),
        ]
    })
    .collect()
}
