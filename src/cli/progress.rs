//! The progress bar: shown only on a terminal, and only for work of more than half a second.

use std::fmt;
use std::io::{self, IsTerminal};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use indicatif::{FormattedDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::pvs::Progress;

const PATIENCE: Duration = Duration::from_millis(500);
const PERIOD: Duration = Duration::from_millis(100);

/// Does the work, and meanwhile shows on standard error how far it has come. `progress` is what the
/// work counts in; where it never learns its total, only the time is shown.
pub fn show<T>(label: &str, quiet: bool, progress: &Progress, work: impl FnOnce() -> T) -> T {
    if quiet || !io::stderr().is_terminal() {
        return work();
    }
    thread::scope(|scope| {
        let (finished, wait) = mpsc::channel::<()>();
        scope.spawn(move || watch(label, progress, &wait));
        let result = work();
        drop(finished);
        result
    })
}

/// As [`show`], for work of several parts: `line` says at any time what is under way.
pub fn show_parts<T>(quiet: bool, line: impl Fn() -> String + Sync, work: impl FnOnce() -> T) -> T {
    if quiet || !io::stderr().is_terminal() {
        return work();
    }
    thread::scope(|scope| {
        let (finished, wait) = mpsc::channel::<()>();
        scope.spawn(|| {
            let wait = wait;
            let bar = ProgressBar::new_spinner();
            bar.set_style(style("{spinner} {msg}"));
            while wait.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                bar.set_message(line());
                bar.tick();
            }
            bar.finish_and_clear();
        });
        let result = work();
        drop(finished);
        result
    })
}

/// Draws the bar until the other end of `wait` is dropped.
fn watch(label: &str, progress: &Progress, wait: &mpsc::Receiver<()>) {
    let running = |time| wait.recv_timeout(time) == Err(RecvTimeoutError::Timeout);
    if !running(PATIENCE) {
        return;
    }
    let bar = ProgressBar::new_spinner()
        .with_message(label.to_string())
        .with_elapsed(PATIENCE);
    bar.set_style(style("{spinner} {msg} {elapsed}"));
    let mut known = false;
    loop {
        let total = progress.total.load(Relaxed);
        if total > 0 && !known {
            known = true;
            bar.set_length(total);
            bar.set_style(style(
                "{msg} [{bar:30}] {human_pos} of {human_len}, {rate}, {left} left",
            ));
        }
        bar.set_position(progress.done.load(Relaxed));
        bar.tick();
        if !running(PERIOD) {
            break;
        }
    }
    bar.finish_and_clear();
}

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).expect("the templates are constants");
    // Over all of the work: the first half second passed before the bar could see any of it.
    let per_second =
        |state: &ProgressState| state.pos() as f64 / state.elapsed().as_secs_f64().max(1e-3);
    let rate = move |state: &ProgressState, out: &mut dyn fmt::Write| {
        _ = write!(out, "{:.0}/s", per_second(state));
    };
    let left = move |state: &ProgressState, out: &mut dyn fmt::Write| {
        let rest = state.len().unwrap_or(0).saturating_sub(state.pos()) as f64;
        let seconds = (rest / per_second(state).max(1e-9)).min(1e9);
        _ = write!(
            out,
            "{}",
            FormattedDuration(Duration::from_secs_f64(seconds.ceil()))
        );
    };
    style
        .with_key("rate", rate)
        .with_key("left", left)
        .progress_chars("=> ")
}
