//! Which structure finds what a ray meets fastest: the portal walk, all structures of the lecture, and
//! testing everything, on the same rays.
//!
//! Three kinds of rays: primary ones of a picture, shadow rays from what those meet to the lights
//! there (four at most), and one diffusely reflected ray from each hit, in any direction. All are
//! cast one by one, on one thread. Every answer is compared with the portal walk's, bit by bit.

use glam::{DVec2, DVec3};
use maud::{Markup, html};
use serde::Serialize;

use super::{About, Shot, frame};
use crate::level::wording::{duration, grouped};
use crate::pvs::Progress;
use crate::study::chart::{Bar, bars};
use crate::study::page::page as document;
use crate::study::visibility::{Bench, Spread};
use crate::trace::accel::{Counters, Kind};
use crate::trace::beam::middle;
use crate::trace::light::arrival;
use crate::trace::sampling::Source;
use crate::trace::world::meet::{Departure, Meeting};
use crate::trace::{Ray, Tracer};

/// Shadow rays from one hit.
const LIGHTS: usize = 4;
/// The part of the budget that all casting may take.
const CASTING: f64 = 0.85;
/// Runs of each.
const RUNS: usize = 5;
/// Rays whose steps are counted, evenly chosen.
const COUNTED: usize = 4000;
/// Rays between two looks at the clock.
const CHUNK: usize = 64;

/// The figures of `enfilade study structures`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructuresStudy {
    /// `enfilade.study`
    pub format: &'static str,
    /// Of this layout.
    pub version: u32,
    /// `structures`
    pub kind: &'static str,
    /// What was studied.
    pub about: About,
    /// Seconds that it took.
    pub seconds: f64,
    /// Surfaces and objects.
    pub primitives: usize,
    /// Cells of the level.
    pub cells: usize,
    /// Rays of each kind.
    pub rays: Vec<Bundle>,
    /// The ways to find what they meet.
    pub rows: Vec<Row>,
}

/// Rays of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bundle {
    /// `primary`, `shadow`, `incoherent`
    pub kind: &'static str,
    /// How many.
    pub rays: usize,
}

/// A way to find what rays meet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Seconds to build it, cells and portals not counted.
    pub build: Option<Spread>,
    /// Memory beyond the primitives, in bytes.
    pub bytes: usize,
    /// What each kind of rays cost.
    pub casts: Vec<Cost>,
}

/// What rays of one kind cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Rays that there was time for.
    pub rays: usize,
    /// Seconds for those.
    pub seconds: Option<Spread>,
    /// Millions of rays in a second, by the median.
    pub mrays: Option<f64>,
    /// Nodes of trees looked at, for a ray.
    pub nodes: f64,
    /// Cells entered, for a ray.
    pub cells: f64,
    /// Primitives tested, for a ray.
    pub tests: f64,
    /// Answers other than the portal walk's.
    pub wrong: u64,
}

/// A ray with where it starts and ends.
type Thrown = (Ray, Departure, f64);

/// The rays of all three kinds.
fn rays(shot: &Shot) -> [Vec<Thrown>; 3] {
    let tracer = Tracer::new(shot.world);
    let [width, height] = shot.camera.size;
    let from = Departure::within(shot.start);
    let mut random = Source::new(shot.about.seed, 0x57a7, 0);
    let (mut primary, mut shadow, mut incoherent) = (Vec::new(), Vec::new(), Vec::new());
    for (x, y) in (0..width * height).map(|i| (i % width, i / width)) {
        let ray = shot.camera.ray(middle(x, y));
        primary.push((ray, from, f64::INFINITY));
        let Some(meeting) = tracer.nearest(&ray, &from, f64::INFINITY) else {
            continue;
        };
        let hit = tracer.hit(&ray, &meeting);
        // The side from which it is seen.
        let normal = if hit.normal.dot(ray.direction) > 0.0 {
            -hit.normal
        } else {
            hit.normal
        };
        let lights = shot.world.lights_of(hit.cell).iter().take(LIGHTS);
        for &light in lights {
            let light = &shot.world.lights[light as usize];
            let coming = arrival(light, hit.point, DVec2::splat(0.5));
            if let Some(coming) = coming.filter(|a| a.direction.dot(normal) > 0.0) {
                let ray = Ray {
                    origin: hit.point,
                    direction: coming.direction,
                };
                shadow.push((ray, tracer.depart(&hit, ray.direction), coming.distance));
            }
        }
        let ray = Ray {
            origin: hit.point,
            direction: diffuse(normal, &mut random),
        };
        incoherent.push((ray, tracer.depart(&hit, ray.direction), f64::INFINITY));
    }
    // Evenly, so that those for which a slow structure has time are a fair choice; and in runs, so
    // that neighbours stay together as they do in a renderer's tiles.
    [primary, shadow, incoherent].map(|set| spread_out(&set))
}

/// Runs of rays in an order in which any first part is spread over the whole.
fn spread_out(set: &[Thrown]) -> Vec<Thrown> {
    let runs: Vec<&[Thrown]> = set.chunks(CHUNK).collect();
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by_key(|i| (*i as u32).reverse_bits().wrapping_mul(0x9e37_79b1));
    order
        .into_iter()
        .flat_map(|i| runs[i].iter().copied())
        .collect()
}

/// A direction away from a surface, steep ones likelier (by the cosine), as matt surfaces reflect.
fn diffuse(normal: DVec3, random: &mut Source) -> DVec3 {
    let up = random.next();
    let flat = (1.0 - up).sqrt() * DVec2::from_angle(std::f64::consts::TAU * random.next());
    let (u, v) = normal.any_orthonormal_pair();
    u * flat.x + v * flat.y + normal * up.max(f64::MIN_POSITIVE).sqrt()
}

/// What a ray met, to the last bit.
fn answer(meeting: Option<&Meeting>) -> (u64, u64) {
    match meeting {
        None => (0, u64::MAX),
        Some(Meeting::Surface(met)) => (1, met.t.to_bits()),
        Some(Meeting::Object(found, _)) => {
            (2 + u64::from(found.primitive), found.contact.t.to_bits())
        }
    }
}

/// Casts all rays with every structure.
pub fn study(shot: &Shot, bench: &mut dyn Bench) -> StructuresStudy {
    let sets = rays(shot);
    let truth: Vec<Vec<(u64, u64)>> = {
        let tracer = Tracer::new(shot.world);
        let of = |(ray, from, limit): &Thrown| answer(tracer.nearest(ray, from, *limit).as_ref());
        sets.iter()
            .map(|set| set.iter().map(of).collect())
            .collect()
    };
    let kinds: Vec<Option<Kind>> = std::iter::once(None).chain(Kind::ALL.map(Some)).collect();
    let slots = (kinds.len() * sets.len()) as f64;
    let mut rows = Vec::new();
    for (i, kind) in kinds.iter().enumerate() {
        let name = kind.map_or("portal walk".to_string(), |k| k.to_string());
        let mut times = Vec::new();
        let mut tracer = Tracer::new(shot.world);
        if let Some(kind) = *kind {
            bench.next(&format!("building {name}"));
            for _ in 0..RUNS {
                let cost = bench.run(None, &mut |_: &Progress| {
                    tracer = match kind {
                        Kind::Brute => Tracer::brute(shot.world),
                        kind => Tracer::with_structure(shot.world, kind),
                    };
                });
                times.push(cost.seconds);
                if times.iter().sum::<f64>() > 0.01 * shot.about.budget {
                    break;
                }
            }
        }
        let casts = sets
            .iter()
            .zip(&truth)
            .enumerate()
            .map(|(j, (set, truth))| {
                bench.next(&format!("casting rays: {name}"));
                // What is left, shared among those that come.
                let open = slots - (i * sets.len() + j) as f64;
                let left = CASTING * shot.about.budget - bench.now();
                cast(&tracer, set, truth, (left / open).max(0.02), bench)
            });
        let casts = casts.collect();
        rows.push(Row {
            name,
            build: Spread::of(&times),
            bytes: tracer.bytes(),
            casts,
        });
    }
    let names = ["primary", "shadow", "incoherent"];
    let bundles = names.into_iter().zip(&sets).map(|(kind, set)| Bundle {
        kind,
        rays: set.len(),
    });
    StructuresStudy {
        format: "enfilade.study",
        version: 1,
        kind: "structures",
        about: shot.about.clone(),
        primitives: shot.world.surfaces().len() + shot.world.standing.len(),
        cells: shot.world.space.cells.len(),
        rays: bundles.collect(),
        rows,
        seconds: bench.now(),
    }
}

/// Casts rays for so many seconds, at least some of them.
fn cast(
    tracer: &Tracer,
    set: &[Thrown],
    truth: &[(u64, u64)],
    seconds: f64,
    bench: &mut dyn Bench,
) -> Cost {
    let (mut times, mut n, mut wrong) = (Vec::new(), set.len(), 0);
    let mut spent = 0.0;
    for run in 0..RUNS {
        let mut done = 0;
        let cost = bench.run((run == 0).then_some(seconds), &mut |progress: &Progress| {
            (done, wrong) = (0, 0);
            for (rays, truth) in set[..n].chunks(CHUNK).zip(truth[..n].chunks(CHUNK)) {
                for ((ray, from, limit), truth) in rays.iter().zip(truth) {
                    let met = tracer.nearest(ray, from, *limit);
                    wrong += u64::from(answer(met.as_ref()) != *truth);
                }
                done += rays.len();
                if run == 0 && progress.stopped() {
                    break;
                }
            }
        });
        n = done;
        times.push(cost.seconds);
        spent += cost.seconds;
        if spent + cost.seconds > seconds {
            break;
        }
    }
    let mut steps = Counters::default();
    let every = (n / COUNTED).max(1);
    let counted = set[..n].iter().step_by(every);
    let mut count = 0.0;
    for (ray, from, limit) in counted {
        tracer.nearest_counting(ray, from, *limit, &mut steps);
        count += 1.0;
    }
    let spread = Spread::of(&times).filter(|_| n > 0);
    let each = |total: u64| {
        if count > 0.0 {
            total as f64 / count
        } else {
            0.0
        }
    };
    Cost {
        rays: n,
        seconds: spread,
        mrays: spread.map(|s| n as f64 / s.median / 1e6),
        nodes: each(steps.nodes),
        cells: each(steps.cells),
        tests: each(steps.tests),
        wrong,
    }
}

impl StructuresStudy {
    /// Sentences about what to pick.
    pub fn advice(&self) -> Vec<String> {
        let mut list = Vec::new();
        for (j, bundle) in self.rays.iter().enumerate() {
            let rated = self
                .rows
                .iter()
                .filter_map(|r| Some((r.casts[j].mrays?, &r.name)));
            let mut rated: Vec<(f64, &String)> = rated.collect();
            rated.sort_by(|a, b| b.0.total_cmp(&a.0));
            let walk = rated.iter().find(|r| r.1 == "portal walk");
            let other = rated.iter().find(|r| r.1 != "portal walk");
            if let (Some(walk), Some(other)) = (walk, other) {
                list.push(format!(
                    "{} rays: the portal walk casts {:.1} million a second, {:.1} times as many as the best structure ({}, {:.1}).",
                    capital(bundle.kind), walk.0, walk.0 / other.0, other.1, other.0
                ));
            }
        }
        let wrong: u64 = self
            .rows
            .iter()
            .flat_map(|r| &r.casts)
            .map(|c| c.wrong)
            .sum();
        let all: usize = self
            .rows
            .iter()
            .flat_map(|r| &r.casts)
            .map(|c| c.rays)
            .sum();
        list.push(if wrong == 0 {
            format!(
                "All give the same answer, bit by bit, to each of {} questions.",
                grouped(all as u64)
            )
        } else {
            format!(
                "{} of {} answers differ from the portal walk's.",
                grouped(wrong),
                grouped(all as u64)
            )
        });
        list
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    let first = chars.next().into_iter().flat_map(char::to_uppercase);
    first.chain(chars).collect()
}

/// The page.
pub fn page(study: &StructuresStudy) -> String {
    let about = &study.about;
    let bar = |j: usize, row: &Row| -> Option<Bar> {
        let mrays = row.casts[j].mrays?;
        Some(Bar {
            key: if row.name == "portal walk" {
                "fixed"
            } else {
                "other"
            },
            name: row.name.clone(),
            value: mrays,
            text: format!("{mrays:.2} M/s"),
        })
    };
    let body = html! {
        p.kicker { "enfilade · study of structures" }
        h1 { "What is the quickest way to what a ray meets in " (about.level) "?" }
        p.lede {
            "The level has " (grouped(study.primitives as u64)) " surfaces and objects. Testing each of them for \
            every ray is slow. Structures sort them by place; the portal walk needs none, for it \
            goes through the " (grouped(study.cells as u64)) " cells that the visible sets are made of."
        }
        div.pick {
            p { b { "In short" } }
            ul { @for text in study.advice() { li { (text) } } }
        }
        h2 { "Millions of rays in a second" }
        p { "One thread, one ray after the other." }
        div.rates {
            @for (j, bundle) in study.rays.iter().enumerate() {
                figure {
                    @let list: Vec<Bar> = study.rows.iter().filter_map(|r| bar(j, r)).collect();
                    (bars(&format!("{} rays", capital(bundle.kind)), &list))
                    figcaption { (grouped(bundle.rays as u64)) " rays: " (match bundle.kind {
                        "primary" => "from the eye through the pixels, neighbours nearly alike",
                        "shadow" => "from what those meet to the lights there",
                        _ => "reflected from there in any direction",
                    }) "." }
                }
            }
        }
        h2 { "Steps" }
        p {
            "Steps for a ray do not depend on the machine: nodes of trees looked at, cells entered, \
            surfaces and objects tested."
        }
        (table(study))
        (frame::measured(about, study.seconds))
    };
    document(&format!("Structures for {}", about.level), &body)
}

fn table(study: &StructuresStudy) -> Markup {
    html! {
        div.scroll { table {
            thead {
                tr {
                    th scope="col" rowspan="2" { "Structure" }
                    th scope="col" rowspan="2" { "Build" }
                    th scope="col" rowspan="2" { "Memory" }
                    @for bundle in &study.rays { th scope="col" colspan="4" { (capital(bundle.kind)) } }
                }
                tr {
                    @for _ in &study.rays {
                        th scope="col" { "M/s" } th scope="col" { "nodes" }
                        th scope="col" { "cells" } th scope="col" { "tests" }
                    }
                }
            }
            tbody {
                @for row in &study.rows {
                    tr {
                        th scope="row" { (row.name) }
                        td { @if row.build.is_some() { (row.build.map_or(String::new(), |s| duration(s.median))) } @else { "–" } }
                        td { (memory(row.bytes)) }
                        @for cost in &row.casts {
                            td { (cost.mrays.map_or("–".to_string(), |m| format!("{m:.2}"))) }
                            td { (steps(cost.nodes)) } td { (steps(cost.cells)) } td { (steps(cost.tests)) }
                        }
                    }
                }
            }
        } }
    }
}

fn steps(n: f64) -> String {
    match n {
        0.0 => "–".to_string(),
        n if n < 100.0 => format!("{n:.1}"),
        n => grouped(n.round() as u64),
    }
}

fn memory(bytes: usize) -> String {
    match bytes {
        0 => "–".to_string(),
        n if n < 1_000_000 => format!("{:.0} kB", n as f64 / 1e3),
        n => format!("{:.1} MB", n as f64 / 1e6),
    }
}

/// The figures as a table for a terminal.
pub fn rows(study: &StructuresStudy) -> Vec<[String; 6]> {
    let rate = |c: &Cost| c.mrays.map_or("-".to_string(), |m| format!("{m:.2}"));
    let rows = study.rows.iter();
    rows.map(|row| {
        let [a, b, c] = [0, 1, 2].map(|j| rate(&row.casts[j]));
        let build = row.build.map_or("-".to_string(), |s| duration(s.median));
        [
            row.name.clone(),
            build,
            memory(row.bytes).replace('–', "-"),
            a,
            b,
            c,
        ]
    })
    .collect()
}
