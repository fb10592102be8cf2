//! What the pages of the drawing studies have in common.

use maud::{Markup, html};

use super::difference::Screen;
use super::{About, RayCounts};
use crate::level::wording::{duration, grouped};
use crate::study::visibility::Spread;

/// A picture with what it shows.
pub fn picture(screen: &Screen, caption: &Markup, about: &str) -> Markup {
    html! {
        figure {
            img.drawn src=(screen.address()) alt=(about) loading="lazy";
            figcaption { (caption) }
        }
    }
}

/// A time with its spread.
pub fn time(spread: Option<&Spread>) -> Markup {
    html! {
        @match spread {
            None => { "–" }
            Some(s) => {
                (duration(s.median))
                small {
                    @if s.runs == 1 { "once" }
                    @else { (duration(s.min)) "–" (duration(s.max)) ", " (s.runs) "\u{202f}×" }
                }
            }
        }
    }
}

/// All rays, and by kind.
pub fn rays(rays: Option<&RayCounts>) -> Markup {
    let Some(rays) = rays else {
        return html! { "–" };
    };
    let kinds = [
        (rays.primary, "primary"),
        (rays.shadow, "shadow"),
        (rays.reflected, "reflected"),
        (rays.refracted, "passing"),
    ];
    let kinds = kinds.into_iter().filter(|(n, _)| *n > 0);
    let kinds: Vec<String> = kinds.map(|(n, k)| format!("{} {k}", grouped(n))).collect();
    html! {
        (grouped(rays.all()))
        small.kinds { (kinds.join(", ")) }
    }
}

/// A share of time: `−35 %`, `+4 %`.
pub fn change(share: f64) -> String {
    let percent = (share * 100.0).round();
    if percent == 0.0 {
        "±0\u{202f}%".to_string()
    } else {
        let sign = if percent < 0.0 { '−' } else { '+' };
        format!("{sign}{}\u{202f}%", percent.abs())
    }
}

/// How it was measured.
pub fn measured(about: &About, seconds: f64) -> Markup {
    let [width, height] = about.size;
    html! {
        footer {
            p {
                "Measured by enfilade " (about.enfilade) " on " (about.machine) " with "
                (about.threads) @if about.threads == 1 { " thread, " } @else { " threads, " }
                (about.view) ", " (width) " × " (height) " pixels, seed " (about.seed) ", in "
                (duration(seconds)) ". Times are medians; the machine may have had other things to do."
            }
        }
    }
}
