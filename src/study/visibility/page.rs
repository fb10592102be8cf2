//! The page of a study, for people who never heard of visible sets.

use maud::{Markup, html};

use super::record::{Heights, Results};
use super::{Study, advice, figures, sketch, tables, wrong};
use crate::level::Level;
use crate::level::wording::{count, duration, grouped, in_sector};
use crate::study::page::page as frame;

/// The whole page: one HTML file that needs nothing else.
pub fn page(level: &Level, study: &Study) -> String {
    let results = &study.results;
    let title = format!("Visibility of {}: what accuracy costs", results.level.name);
    let body = html! {
        (head(results))
        (question(level, study))
        (methods(results))
        @if let Some(text) = advice::sampling(results) { (samples(results, &text)) }
        @if let Some(text) = advice::subdivisions(results) { (cells(results, &text)) }
        @if let Some(heights) = &results.heights { (floors(results, heights)) }
        (wrong::section(level, study))
        (measured(results))
    };
    frame(&title, &body)
}

/// A box with what to pick.
fn pick(text: &str) -> Markup {
    html! { div.pick { p { (text) } } }
}

fn head(results: &Results) -> Markup {
    let level = &results.level;
    html! {
        p.kicker { "enfilade · study of visibility" }
        h1 { "Who can see whom in " (level.name) ", and what does it cost to know?" }
        p.lede {
            (level.name) " (" code { (level.source) } ") has "
            (count(level.walls, "wall")) ". Cut into " (count(results.cells, "convex cell"))
            ", it has " (grouped(results.truth.pairs)) " pairs of cells that can see each other, "
            (format!("{:.1}", results.truth.density * 100.0)) "\u{202f}% of all. This page compares \
            ways to find them: how fast they are, and how wrong."
        }
        div.pick {
            p { b { "In short" } }
            p { (advice::exact(results)) }
            ul {
                @for text in advice::others(results) { li { (text) } }
                @if let Some(heights) = &results.heights { li { (advice::heights(heights)) } }
            }
        }
    }
}

fn question(level: &Level, study: &Study) -> Markup {
    let (graph, truth) = (&study.graph, &study.truth);
    html! {
        h2 { "What is asked" }
        p {
            "A program that shows a building from inside keeps asking: what can possibly be seen \
            from here? At any moment most of the building is hidden behind walls, and what is known \
            to be hidden need not be drawn, lit, loaded or sent over the network."
        }
        p {
            "So the plan is prepared once. It is cut into " b.key { "cells" } ": convex pieces of \
            floor without a wall inside. Where two cells touch without a wall between them, they \
            share a " b.key { "portal" } ". One cell sees another if some straight line leads from \
            inside the one to inside the other through nothing but portals. All cells that a cell \
            sees are its " b.key { "potentially visible set" } ", PVS for short: whoever stands \
            anywhere in the cell can see nothing that lies outside of its set."
        }
        @if let Some(source) = sketch::example(graph, truth) {
            @let n = truth.visible.count(source.0 as usize);
            @let place = in_sector(level, graph.cell(source).sector);
            @let about = format!(
                "Plan of {}: what cell {}{place} sees", level.name, source.0
            );
            figure.wide {
                (sketch::view(graph, truth, source, &about))
                figcaption {
                    "The plan of " (level.name) ". Cell " (source.0) (place) " "
                    span.swatch.source {} " sees " (grouped(n as u64)) " of "
                    (count(graph.cells.len(), "cell")) " " span.swatch.seen {}
                    ": from somewhere inside it, some part of them is in sight. The others "
                    span.swatch.floor {} " are hidden from every point of it. Thick lines are \
                    walls, thin ones portals."
                }
            }
        }
        p {
            "A method can go wrong in two ways. What it calls visible although it is hidden is its "
            b.key { "overestimate" } ": work done in vain. What it calls hidden although it can be \
            seen is its " b.key { "underestimate" } ": holes in the picture. Both are given in \
            percent of what can really be seen, as the average over all cells. By what they promise, \
            methods fall into four classes:"
        }
        dl.classes {
            dt { "exact" }        dd { "Neither ever happens." }
            dt { "conservative" } dd { "Nothing visible is ever missed; something hidden may be shown." }
            dt { "aggressive" }   dd { "Nothing hidden is ever shown; something visible may be missed." }
            dt { "approximate" }  dd { "Both may happen, and nothing tells where." }
        }
    }
}

fn methods(results: &Results) -> Markup {
    html! {
        h2 { "The methods" }
        ul {
            li { b.key.k-sweep { "sweep" } " turns a line of sight about every wall's end and notes \
                what it meets before and behind. In whole numbers, without rounding." }
            li { b.key.k-search { "search" } " goes from portal to portal, depth first, as long as \
                some line passes through all portals on the way; also without rounding. It shares \
                nothing with the sweep, so that each checks the other." }
            li { b.key.k-lp { "lp" } " is the same search, but asks a linear programme in \
                floating-point numbers whether a line passes: the method of the textbooks." }
            li { b.key.k-flow { "flow" } " narrows the view from portal to portal by separating \
                lines, as the tools for Quake do, in floating-point numbers with a tolerance." }
            li { b.key.k-flood { "flood" } " calls visible whatever can be reached through portals." }
            li { b.key.k-sample { "sample" } " shoots random sightlines and notes what they meet." }
        }
        (tables::of_methods(results))
        p.aside {
            "Time: the median of several runs, and the shortest and longest. Relative: in times of the fastest \
            exact method. Pairs are counted both ways (a sees b, b sees a, a sees itself); wrong \
            pairs are counted once. Memory: the most that was held beyond what was there before."
        }
        h3 { "Error against time" }
        p {
            "Further left is faster, further down is better. Both axes are logarithmic: each line of \
            the grid stands for ten times as much as the one before. What makes no error lies in the shaded band at the bottom."
        }
        (figures::of_methods(results))
        (pick(&advice::methods(results)))
    }
}

fn samples(results: &Results, text: &str) -> Markup {
    html! {
        h2 { "How many random sightlines are enough?" }
        p {
            "Random sightlines are easy to program, and what they find is certain. What they do not \
            find may be hidden, or only hard to hit: narrow views are missed longest."
        }
        (figures::of_samples(results))
        (pick(text))
    }
}

fn cells(results: &Results, text: &str) -> Markup {
    html! {
        h2 { "How should the plan be cut?" }
        p {
            b.key.k-bsp { "bsp" } " cuts along the lines of the walls, " b.key.k-kd { "kd" }
            " along vertical and horizontal lines through wall ends, " b.key.k-cdt { "cdt" }
            " into triangles. Small cells give tighter sets, for fewer places have to share one; \
            but there are more of them. The exact answer is exact for each."
        }
        (figures::of_subdivisions(results))
        (tables::of_subdivisions(results))
        (pick(text))
    }
}

fn floors(results: &Results, heights: &Heights) -> Markup {
    html! {
        h2 { "Floors and ceilings" }
        p {
            "So far only walls stopped sight. With heights a sightline must also pass above every \
            step and sill and below every lintel on its way. No simple exact method is known for that: \
            the answer is enclosed between what is proved visible and what is not proved \
            hidden. The lines through a chain of portals are split into ever smaller parts until all are decided, or \
            the given number of parts is reached; what is still open then is "
            b.key { "undecided" } ", and counts as visible."
        }
        (figures::of_heights(results, heights))
        (tables::of_heights(heights))
        (pick(&advice::heights(heights)))
    }
}

fn measured(results: &Results) -> Markup {
    let setting = &results.setting;
    html! {
        h2 { "How this was measured" }
        @if !results.notes.is_empty() {
            p { "Not everything fits into " (duration(setting.budget)) ":" }
            ul { @for note in &results.notes { li { (advice::capital(note)) } } }
        }
        p {
            "By " code { "enfilade study visibility" } ", version " (setting.enfilade) ", on "
            (setting.machine) ", with " (count(setting.threads, "thread")) ". Cells by "
            (setting.subdivision) " unless another subdivision is named; doors count as "
            (setting.doors) "; seed of random numbers: " (setting.seed) ". The study had "
            (duration(setting.budget)) " and took " (duration(results.seconds)) "."
        }
        p {
            "Every method ran once, then all of them again in turn as far as the time allowed; the \
            table tells how often. Times are those of the clock on the wall, so other work on the machine shows in the \
            longest ones. Everything but times and memory comes out the same whenever the study is \
            repeated, unless a method's time was over before its end."
        }
        footer { "Made by enfilade: exact cells-and-portals visibility." }
    }
}
