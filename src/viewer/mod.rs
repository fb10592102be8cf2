//! The interactive viewer: a window in which one walks through a level, and sees what is visible from
//! where, why, and what it costs.
//!
//! In: a level file and a way to read it ([`Services`]). Out: a window, until somebody closes it. Everything
//! that takes time happens beside the window's thread: reading and computing a level ([`app`]), what an
//! eye sees ([`engine`]).
//!
//! | file | what |
//! |---|---|
//! | [`document`] | a level with all that there is to show of it; never changed, only replaced |
//! | [`engine`] | a thread that answers what an eye sees, and why cells see each other |
//! | [`plan`] | the plan: to look at and to click on |
//! | [`overlay`] | lines over the view: borders of cells, sightlines, walks |
//! | [`sightlines`] | from one cell to all that it sees |
//! | [`methods`] | what other ways to a PVS cost here, and what they get wrong |
//! | [`costs`] | what traced pictures have cost, by what was asked of them |
//! | [`paths`] | walks: played, recorded, saved |
//! | [`settings`] | what is chosen, and what of it is remembered |
//! | [`app`] | the window: what is open, and what goes on |
//! | [`walker`] | movement: on the ground with its walls and steps, or flying |
//! | [`scene`] | the picture in space by the graphics card, in the order of the BSP |
//! | [`gpu`] | a device without a window, for pictures in files and for tests |
//! | [`tracing`] | the ray tracer beside the window's thread, coarse at once and finer as one waits |
//! | [`edit`] | changing the level on the plan, and saving it |
//! | `view`, `steer` | what view and plan show; keys and mouse |
//! | [`panels`], `accuracy`, `windows` | menus, statistics, effects, findings; what accuracy costs; keys, errors, files |

mod accuracy;
pub mod app;
pub mod costs;
pub mod document;
pub mod edit;
pub mod engine;
pub mod gpu;
pub mod methods;
pub mod overlay;
pub mod panels;
pub mod paths;
pub mod plan;
#[cfg(test)]
mod sample;
pub mod scene;
pub mod settings;
pub mod sightlines;
mod steer;
#[cfg(all(test, feature = "viewer-tests"))]
mod tests;
pub mod tracing;
mod view;
pub mod walker;
mod windows;

use std::path::PathBuf;

use eframe::egui;
use thiserror::Error;

pub use app::App;
pub use document::{Document, Loaded, Loader, Saver, Services, Voice};

/// Why there is no window.
#[derive(Debug, Error)]
pub enum ViewerError {
    /// Neither a screen nor a graphics adapter.
    #[error(
        "cannot open a window: that takes a screen (X11 or Wayland) and a Vulkan or OpenGL driver; without a \
         graphics card install Mesa's software driver (Debian, Ubuntu: `apt-get install \
         mesa-vulkan-drivers`). What the system says: {0}"
    )]
    Window(String),
}

/// Opens a window on a level, and returns when it is closed. `log` is told whenever the eye comes into
/// another cell: `eye X Y Z cell N pvs N`.
pub fn run(
    level: Option<(PathBuf, Option<String>)>,
    services: Services,
    log: Option<fn(&str)>,
) -> Result<(), ViewerError> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("enfilade")
            .with_inner_size([1440.0, 900.0])
            .with_drag_and_drop(true),
        ..eframe::NativeOptions::default()
    };
    let start = move |context: &eframe::CreationContext<'_>| -> Result<
        Box<dyn eframe::App>,
        Box<dyn std::error::Error + Send + Sync>,
    > {
        let mut app = App::new(&context.egui_ctx, context.wgpu_render_state.clone(), services);
        app.log = log;
        if let Some(memory) = context.storage.and_then(|s| eframe::get_value(s, eframe::APP_KEY)) {
            app.remember(memory);
        }
        if let Some((path, map)) = level {
            app.open(path, map);
        }
        Ok(Box::new(app))
    };
    eframe::run_native("enfilade", options, Box::new(start))
        .map_err(|e| ViewerError::Window(e.to_string()))
}
