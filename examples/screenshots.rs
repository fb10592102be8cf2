//! The viewer's pictures in the README: the real window, without a screen.
//!
//!     cargo run --release --features viewer-tests --example screenshots [FOLDER]
//!
//! Needs a Vulkan driver (Mesa's lavapipe will do) and, for the Doom map, Freedoom.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::{Key, vec2};
use egui_kittest::Harness;
use enfilade::cli::view::services;
use enfilade::viewer::App;
use enfilade::viewer::app::{Tab, View};
use enfilade::viewer::methods::Contender;
use enfilade::viewer::walker::Mode;
use glam::DVec3;
use image::DynamicImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};

/// Of each picture, in points; two of the points make no sharper text, but four times the bytes.
const SIZE: [f32; 2] = [1360.0, 800.0];

type Window = Harness<'static, App>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1);
    let folder = PathBuf::from(folder.as_deref().unwrap_or("levels/pictures"));
    std::fs::create_dir_all(&folder)?;
    let doom = Path::new("/usr/share/games/doom/freedoom1.wad");

    let mut window = open("levels/gallery.toml".into(), None)?;
    window.state_mut().settings.view = View::Both;
    window.state_mut().settings.stops = Some(0.7);
    window.state_mut().settings.tab = Tab::Effects;
    until(&mut window, "a traced picture", |app| {
        app.traced.as_ref().is_some_and(|(_, t)| t.done)
    })?;
    keep(&mut window, &folder, "viewer-gallery")?;

    let mut window = open("levels/museum.toml".into(), None)?;
    let app = window.state_mut();
    let own = app.subject().ok_or("the eye is outside")?;
    let document = app.document.clone().ok_or("no level")?;
    let (far, _) = document.farthest(own).ok_or("it sees nothing")?;
    app.ask_why_of(own, far);
    until(&mut window, "an explanation", |app| {
        app.explanation().is_some()
    })?;
    let line = window.state().explanation().and_then(|e| e.rise);
    window.state_mut().look_along(line.ok_or("no sightline")?);
    arrive(&mut window, "the view along it")?;
    keep(&mut window, &folder, "viewer-why")?;
    window.key_press(Key::Escape);
    let app = window.state_mut();
    app.settings.heat = true;
    app.settings.tab = Tab::Statistics;
    window.run_steps(4);
    keep(&mut window, &folder, "viewer-heat")?;

    if !doom.exists() {
        eprintln!(
            "left out: {} is not there (apt-get install freedoom)",
            doom.display()
        );
        return Ok(());
    }
    let mut window = open(doom.into(), Some("E1M1".into()))?;
    let app = window.state_mut();
    app.settings.tab = Tab::Accuracy;
    app.settings.sightlines = true;
    for contender in [
        Contender::ALL[0],
        Contender::ALL[2],
        Contender::ALL[5],
        Contender::ALL[6],
    ] {
        let app = window.state_mut();
        let document = app.document.clone().ok_or("no level")?;
        app.methods.measure(&document, contender, || {});
        until(&mut window, contender.name(), |app| {
            app.methods.of(contender).is_some()
        })?;
    }
    until(&mut window, "sightlines", |app| {
        app.sightlines.as_ref().is_some_and(|s| s.complete)
    })?;
    keep(&mut window, &folder, "viewer-e1m1")?;
    let app = window.state_mut();
    app.settings.sightlines = false;
    app.settings.tab = Tab::Effects;
    app.settings.view = View::Traced;
    until(&mut window, "a traced picture", |app| {
        app.traced.as_ref().is_some_and(|(_, t)| t.done)
    })?;
    keep(&mut window, &folder, "viewer-e1m1-traced")?;
    let app = window.state_mut();
    app.settings.view = View::Painted;
    app.settings.tab = Tab::Statistics;
    app.freeze();
    window.run_steps(4);
    let app = window.state_mut();
    app.eye.mode = Mode::Fly;
    let back = app.eye.direction() * 300.0;
    app.eye.eye += DVec3::Z * 420.0 - back;
    app.eye.pitch = -0.85;
    arrive(&mut window, "the frozen view")?;
    keep(&mut window, &folder, "viewer-frozen")?;
    Ok(())
}

/// A window with a level and a first picture.
fn open(path: PathBuf, map: Option<String>) -> Result<Window, String> {
    let mut window = Harness::builder()
        .with_size(vec2(SIZE[0], SIZE[1]))
        .wgpu()
        .build_eframe(move |context| {
            let card = context.wgpu_render_state.clone();
            let mut app = App::new(&context.egui_ctx, card, services());
            app.open(path, map);
            app
        });
    until(&mut window, "a level and a picture", |app| {
        app.seen.is_some()
    })?;
    window.run_steps(4);
    Ok(window)
}

/// Goes on until the view is that of the eye where it is now.
fn arrive(window: &mut Window, what: &str) -> Result<(), String> {
    window.run_steps(4);
    let camera = window.state().camera();
    until(window, what, |app| {
        app.seen.as_ref().is_some_and(|s| s.look.camera == camera)
    })
}

fn until(window: &mut Window, what: &str, done: impl Fn(&App) -> bool) -> Result<(), String> {
    let start = Instant::now();
    while !done(window.state()) {
        if let Some(error) = &window.state().error {
            return Err(error.clone());
        }
        if start.elapsed() > Duration::from_secs(300) {
            return Err(format!("no {what} within five minutes"));
        }
        window.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(3);
    Ok(())
}

fn keep(window: &mut Window, folder: &Path, name: &str) -> Result<(), Box<dyn std::error::Error>> {
    window.run_steps(2);
    let file = folder.join(format!("{name}.png"));
    let picture = DynamicImage::ImageRgba8(window.render()?).into_rgb8();
    let out = std::io::BufWriter::new(std::fs::File::create(&file)?);
    let encoder = PngEncoder::new_with_quality(out, CompressionType::Best, FilterType::Adaptive);
    picture.write_with_encoder(encoder)?;
    println!("{}", file.display());
    Ok(())
}
