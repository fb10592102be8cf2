//! What somebody has chosen: how the window looks, what is drawn, how finely; and what of it is
//! remembered from one time to the next.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::cells::Doors;
use crate::preview::Culling;
use crate::trace::effects::Effects;

/// How many levels that were opened are remembered.
const RECENT: usize = 10;

/// A tab of the side panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tab {
    /// Cells, polygons, milliseconds.
    #[default]
    Statistics,
    /// What a picture calls for.
    Effects,
    /// Methods, samples, depth, and their cost.
    Accuracy,
    /// Why two cells see each other.
    Why,
    /// What `check` says.
    Findings,
}

/// What the view shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum View {
    /// The polygons, painted.
    #[default]
    Painted,
    /// The rays, traced.
    Traced,
    /// Both side by side.
    Both,
}

/// What is drawn, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Horizontal angle of view in degrees.
    pub fov: f64,
    /// Which cells are drawn.
    pub culling: Culling,
    /// With pictures.
    pub textured: bool,
    /// The plan beside the 3D view.
    pub plan: bool,
    /// The plan coloured by what cells see.
    pub heat: bool,
    /// A sightline to every cell that is seen.
    pub sightlines: bool,
    /// Borders of cells over the 3D view.
    pub outlines: bool,
    /// Doors that stand closed count as walls: since one was opened or closed by hand, and for that time only.
    #[serde(skip)]
    pub closed: bool,
    /// Heights count for "why".
    pub heights: bool,
    /// Times of the window's own thread.
    #[serde(skip)]
    pub debug: bool,
    /// The keys.
    #[serde(skip)]
    pub help: bool,
    /// What the view shows.
    pub view: View,
    /// Samples in each pixel of a traced picture, at the end.
    pub samples: u32,
    /// More samples where neighbouring pixels differ.
    pub adaptive: bool,
    /// Most reflections in a row.
    pub depth: u32,
    /// Smallest share of light that is followed.
    pub threshold: f64,
    /// Rays to each light with an extent, and into cones.
    pub rays: u32,
    /// How bright traced pictures are, in stops; `None`: as each asks for.
    pub stops: Option<f64>,
    /// Effects that are not traced although they matter.
    #[serde(skip)]
    pub without: Effects,
    /// The side panel's tab.
    pub tab: Tab,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            fov: 75.0,
            culling: Culling::Eye,
            textured: true,
            plan: true,
            heat: false,
            sightlines: false,
            outlines: false,
            closed: false,
            heights: false,
            debug: false,
            help: false,
            view: View::Painted,
            samples: 4,
            adaptive: false,
            depth: 5,
            threshold: 1.0 / 256.0,
            rays: 16,
            stops: None,
            without: Effects::NONE,
            tab: Tab::Statistics,
        }
    }
}

impl Settings {
    /// How doors count.
    pub fn doors(&self) -> Doors {
        if self.closed {
            Doors::Closed
        } else {
            Doors::Open
        }
    }
}

/// A level file that was opened, and which map of it.
pub type Opened = (PathBuf, Option<String>);

/// What is kept when the window is closed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Memory {
    /// What was chosen.
    pub settings: Settings,
    /// Levels that were opened, each with its map, the last one first.
    pub recent: Vec<Opened>,
}

/// A level was opened: it comes first, once.
pub fn put_first(recent: &mut Vec<Opened>, (path, map): Opened) {
    let level = (std::path::absolute(&path).unwrap_or(path), map);
    recent.retain(|old| *old != level);
    recent.insert(0, level);
    recent.truncate(RECENT);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_comes_back_and_the_rest_is_as_usual() {
        let mut memory = Memory::default();
        memory.settings.samples = 16;
        memory.settings.view = View::Both;
        memory.settings.culling = Culling::Pvs;
        memory.settings.help = true;
        memory.settings.closed = true;
        for name in ["a", "b", "a"] {
            put_first(
                &mut memory.recent,
                (format!("/levels/{name}.toml").into(), None),
            );
        }
        let text = serde_json::to_string(&memory).expect("it is plain data");
        let mut back: Memory = serde_json::from_str(&text).expect("it reads");
        assert!(!back.settings.help, "a window that was open");
        assert!(!back.settings.closed, "doors of another level");
        (back.settings.help, back.settings.closed) = (true, true);
        assert_eq!(back, memory);
        let names: Vec<_> = back.recent.iter().map(|(p, _)| p.clone()).collect();
        assert_eq!(
            names,
            ["/levels/a.toml", "/levels/b.toml"].map(PathBuf::from)
        );
        // What an older version has not written.
        let old: Memory = serde_json::from_str("{\"settings\":{\"samples\":9}}").expect("it reads");
        assert_eq!(
            old.settings,
            Settings {
                samples: 9,
                ..Settings::default()
            }
        );
    }

    #[test]
    fn so_many_levels_are_remembered() {
        let mut memory = Memory::default();
        for k in 0..30 {
            put_first(
                &mut memory.recent,
                ("/levels/all.wad".into(), Some(format!("MAP{k}"))),
            );
        }
        assert_eq!(memory.recent.len(), RECENT);
        assert_eq!(memory.recent[0].1.as_deref(), Some("MAP29"));
    }
}
