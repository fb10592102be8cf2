//! What each effect costs, and what is missing without it.

use maud::{Markup, html};
use serde::Serialize;

use super::difference::{Difference, Screen};
use super::{About, RayCounts, Shot, Take, draw_all, exposure_of, frame, with};
use crate::level::wording::duration;
use crate::study::page::page as document;
use crate::study::visibility::{Bench, Spread};
use crate::trace::effects::{Effect, Effects};

/// The figures of `enfilade study effects`.
#[derive(Clone, Debug, Serialize)]
pub struct EffectsStudy {
    /// `enfilade.study`
    pub format: &'static str,
    /// Of this layout.
    pub version: u32,
    /// `effects`
    pub kind: &'static str,
    /// What was studied.
    pub about: About,
    /// Seconds that it took.
    pub seconds: f64,
    /// The picture with all that it calls for.
    pub full: Drawn,
    /// With everything simulated, called for or not.
    pub all: Drawn,
    /// With nothing: surfaces lit as if nothing stood between them and the lights.
    pub none: Drawn,
    /// Each effect.
    pub effects: Vec<Row>,
    #[serde(skip)]
    pictures: Vec<(String, Screen)>,
}

/// A way to draw the picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawn {
    /// What was simulated.
    pub effects: String,
    /// How long it took; `None` if there was no time for it.
    pub seconds: Option<Spread>,
    /// Rays.
    pub rays: Option<RayCounts>,
    /// How far it is from the picture with all that is called for.
    pub difference: Option<Difference>,
}

/// An effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub effect: &'static str,
    /// Whether the picture calls for it.
    pub needed: bool,
    /// Why, or why not.
    pub reason: String,
    /// The picture without it, if it is called for.
    pub without: Option<Drawn>,
}

/// Draws the shot with all it calls for, with everything, with nothing, and without one after the
/// other.
pub fn study(shot: &Shot, bench: &mut dyn Bench) -> EffectsStudy {
    let needed = shot.survey.needed;
    let mut takes = vec![
        Take::new("all that is called for", with(shot, needed)),
        Take::new("everything", with(shot, Effects::ALL)),
        Take::new("nothing", with(shot, Effects::NONE)),
    ];
    for effect in needed.iter() {
        let label = format!("without {}", effect.as_str());
        takes.push(Take::new(label, with(shot, needed.without(effect))));
    }
    let order: Vec<usize> = (0..takes.len()).collect();
    draw_all(shot, &mut takes, &order, bench, 0.9);
    let exposure = takes[0].drawn.as_ref().map(exposure_of).unwrap_or_default();
    let screens: Vec<Option<Screen>> = (takes.iter())
        .map(|t| t.drawn.as_ref().map(|d| Screen::of(&d.picture, exposure)))
        .collect();
    let drawn = |i: usize| {
        let take: &Take = &takes[i];
        let pair = screens[0].as_ref().zip(screens[i].as_ref());
        Drawn {
            effects: take.options.effects.to_string(),
            seconds: take.spread(),
            rays: take.rays(),
            difference: pair.map(|(full, own)| own.difference(full)),
        }
    };
    let mut next = 3;
    let rows = shot.survey.verdicts.iter().map(|verdict| {
        let without = verdict.needed.then(|| {
            next += 1;
            drawn(next - 1)
        });
        Row {
            effect: verdict.effect.as_str(),
            needed: verdict.needed,
            reason: verdict.reason.clone(),
            without,
        }
    });
    EffectsStudy {
        format: "enfilade.study",
        version: 1,
        kind: "effects",
        about: shot.about.clone(),
        effects: rows.collect(),
        full: drawn(0),
        all: drawn(1),
        none: drawn(2),
        seconds: bench.now(),
        pictures: (takes.iter().zip(&screens))
            .filter_map(|(t, s)| Some((t.label.clone(), s.clone()?)))
            .collect(),
    }
}

impl EffectsStudy {
    /// How much longer the whole picture takes than one without the effect, as a share of the whole.
    fn cost(&self, row: &Row) -> Option<f64> {
        let full = self.full.seconds?.median;
        let without = row.without.as_ref()?.seconds?.median;
        Some((full - without) / full)
    }

    fn picture(&self, label: &str) -> Option<&Screen> {
        let found = self.pictures.iter().find(|(name, _)| name == label);
        found.map(|(_, screen)| screen)
    }

    /// What to leave out first, and what not: a sentence for each thing worth saying.
    pub fn advice(&self) -> Vec<String> {
        let mut list = Vec::new();
        let needed: Vec<&Row> = self.effects.iter().filter(|r| r.needed).collect();
        let idle: Vec<&str> = (self.effects.iter().filter(|r| !r.needed))
            .map(|r| r.effect)
            .collect();
        if let Some(full) = &self.full.seconds {
            list.push(format!(
                "The picture calls for {}: that takes {}.",
                if needed.is_empty() {
                    "no effect at all".to_string()
                } else {
                    self.full.effects.replace(',', ", ")
                },
                duration(full.median)
            ));
            if let (Some(all), false) = (&self.all.seconds, idle.is_empty()) {
                list.push(format!(
                    "Left out as nothing in sight calls for them: {}. Simulating them all the same gives {} and takes {} ({}).",
                    idle.join(", "),
                    match self.all.difference {
                        Some(d) if d.rmse == 0.0 => "the same picture, pixel for pixel,",
                        _ => "a different picture",
                    },
                    duration(all.median),
                    frame::change((all.median - full.median) / full.median),
                ));
            }
        }
        let dear = needed.iter().filter_map(|r| Some((self.cost(r)?, *r)));
        if let Some((cost, row)) = dear
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(c, _)| *c > 0.02)
        {
            let off = row.without.as_ref().and_then(|w| w.difference);
            list.push(format!(
                "The dearest is {}: {:.0}\u{202f}% of the time{}.",
                row.effect,
                cost * 100.0,
                off.map_or(String::new(), |d| format!(
                    "; without it the picture is {:.1}\u{202f}% alike",
                    d.likeness * 100.0
                ))
            ));
        }
        let cheap = needed.iter().filter_map(|r| {
            let alike = r.without.as_ref()?.difference?.likeness;
            Some((alike, self.cost(r)?, *r))
        });
        if let Some((alike, cost, row)) = cheap.min_by(|a, b| a.0.total_cmp(&b.0)) {
            list.push(format!(
                "What the picture can spare least is {}: without it, it is {:.1}\u{202f}% alike; it costs {:.0}\u{202f}% of the time.",
                row.effect,
                alike * 100.0,
                (cost * 100.0).max(0.0)
            ));
        }
        list
    }
}

/// The page.
pub fn page(study: &EffectsStudy) -> String {
    let about = &study.about;
    let body = html! {
        p.kicker { "enfilade · study of effects" }
        h1 { "What do the effects in " (about.level) " cost?" }
        p.lede {
            "A ray tracer can simulate shadows, mirrors, glass and more. Each takes rays of its own. \
            This page draws one picture (" (about.view) ") with all that the scene calls for, and \
            then without one effect after the other."
        }
        div.pick {
            p { b { "In short" } }
            ul { @for text in study.advice() { li { (text) } } }
        }
        @if let Some(full) = study.picture("all that is called for") {
            (frame::picture(full, &html! { "The picture with all that it calls for: " (study.full.effects) "." },
                "The whole picture"))
        }
        h2 { "Effect by effect" }
        (table(study))
        p.aside {
            "Time saved: by leaving the effect out of the whole picture. Error: the root of the mean \
            squared difference on the screen, 100\u{202f}% being white for black. Alike: structural \
            similarity, as an eye judges it."
        }
        @if study.effects.iter().any(|r| r.without.is_some()) {
            h2 { "The picture without it, and what that changes" }
            @for row in &study.effects {
                @if let Some(screen) = study.picture(&format!("without {}", row.effect)) {
                    h3 { "Without " (row.effect) }
                    div.pair {
                        (frame::picture(screen, &html! { "Without " (row.effect) "." }, &format!("Without {}", row.effect)))
                        @if let Some(full) = study.picture("all that is called for") {
                            (frame::picture(&screen.apart(full), &html! {
                                "The difference, four times as bright as it is. " (row.reason) "."
                            }, &format!("What {} changes", row.effect)))
                        }
                    }
                }
            }
        }
        @if let Some(none) = study.picture("nothing") {
            h2 { "With nothing" }
            (frame::picture(none, &html! { "No effects: light falls through everything, and nothing reflects." },
                "Without any effects"))
        }
        (frame::measured(about, study.seconds))
    };
    document(
        &format!("Effects in {}: what they cost", about.level),
        &body,
    )
}

fn table(study: &EffectsStudy) -> Markup {
    let number = |drawn: Option<&Drawn>, of: fn(&Difference) -> f64| {
        let difference = drawn.and_then(|d| d.difference);
        difference.map_or("–".to_string(), |d| {
            format!("{:.2}\u{202f}%", of(&d) * 100.0)
        })
    };
    let row = |name: &str, reason: &str, drawn: Option<&Drawn>, saved: Option<f64>| {
        html! {
            tr {
                th scope="row" { (name) }
                td.left.why { (reason) }
                td { (frame::time(drawn.and_then(|d| d.seconds.as_ref()))) }
                td { @if let Some(saved) = saved { (frame::change(-saved)) } @else { "–" } }
                td { (frame::rays(drawn.and_then(|d| d.rays.as_ref()))) }
                td { (number(drawn, |d| d.rmse)) }
                td { (number(drawn, |d| d.likeness)) }
            }
        }
    };
    let against_full = |drawn: &Drawn| {
        let [own, full] = [drawn, &study.full].map(|d| d.seconds.map(|s| s.median));
        own.zip(full).map(|(own, full)| (full - own) / full)
    };
    html! {
        div.scroll { table {
            thead { tr {
                th scope="col" { "Left out" }
                th.left scope="col" { "Why it is called for, or not" }
                th scope="col" { "Time without" }
                th scope="col" { "Time saved" }
                th scope="col" { "Rays" }
                th scope="col" { "Error" }
                th scope="col" { "Alike" }
            } }
            tbody {
                (row("nothing", "the picture with all that it calls for", Some(&study.full), None))
                @for r in &study.effects {
                    (row(r.effect, &r.reason, r.without.as_ref(), study.cost(r)))
                }
                (row("everything", "no effects at all", Some(&study.none), against_full(&study.none)))
                (row("nothing, and all added", "what is not called for is simulated as well", Some(&study.all), against_full(&study.all)))
            }
        } }
    }
}

/// The figures as a table for a terminal: header and rows.
pub fn rows(study: &EffectsStudy) -> Vec<[String; 5]> {
    let row = |name: &str, drawn: Option<&Drawn>| {
        let seconds = drawn.and_then(|d| d.seconds);
        let difference = drawn.and_then(|d| d.difference);
        [
            name.to_string(),
            seconds.map_or("-".to_string(), |s| duration(s.median)),
            drawn
                .and_then(|d| d.rays)
                .map_or("-".to_string(), |r| crate::level::wording::grouped(r.all())),
            difference.map_or("-".to_string(), |d| format!("{:.3} %", d.rmse * 100.0)),
            difference.map_or("-".to_string(), |d| format!("{:.2} %", d.likeness * 100.0)),
        ]
    };
    let mut list = vec![row("all that is called for", Some(&study.full))];
    for effect in Effect::ALL {
        let found = study.effects.iter().find(|r| r.effect == effect.as_str());
        if let Some(found) = found {
            let name = if found.needed {
                format!("without {}", found.effect)
            } else {
                format!("{} (not called for)", found.effect)
            };
            list.push(row(&name, found.without.as_ref()));
        }
    }
    list.push(row("nothing simulated", Some(&study.none)));
    list.push(row("everything simulated", Some(&study.all)));
    list
}
