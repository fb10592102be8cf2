//! The progress bar: shown only on a terminal, and only for work of more than half a second.

use std::fmt;
use std::io::{self, IsTerminal};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

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

/// Draws the bar until the other end of `wait` is dropped.
fn watch(label: &str, progress: &Progress, wait: &mpsc::Receiver<()>) {
    let running = |time| wait.recv_timeout(time) == Err(RecvTimeoutError::Timeout);
    if !running(PATIENCE) {
        return;
    }
    let bar = ProgressBar::new_spinner().with_message(label.to_string());
    bar.set_style(style("{spinner} {msg} {elapsed}"));
    let mut known = false;
    loop {
        let total = progress.total.load(Relaxed);
        if total > 0 && !known {
            known = true;
            bar.set_length(total);
            bar.set_style(style(
                "{msg} [{bar:30}] {human_pos} of {human_len}, {rate}, {eta} left",
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
    let rate = |state: &ProgressState, out: &mut dyn fmt::Write| {
        _ = write!(out, "{:.0}/s", state.per_sec());
    };
    style.with_key("rate", rate).progress_chars("=> ")
}
