use super::*;
use crate::cells::Subdivision;
use crate::level::Level;
use crate::level::read::read;
use serde_json::Value;

/// Two rooms with a window high above the floor, and a closet that only the second one sees.
const ROOMS: &str = "[[room]]\nname = \"A & <B>\"\nrect = [0, 0, 4, 4]\n\
    [[room]]\nname = \"C\"\nrect = [4, 0, 8, 4]\n\
    [[room]]\nname = \"closet\"\nrect = [8, 0, 9, 1]\n\
    [[door]]\nbetween = [\"A & <B>\", \"C\"]\nwidth = 1\n\
    [[window]]\nbetween = [\"C\", \"closet\"]\nwidth = 0.3\nsill = 2\n\
    [[pillar]]\ncenter = [6, 2]\nradius = 0.5\nsides = 5\n";

/// A clock that goes a second further with every run, whatever that takes.
struct Desk {
    now: f64,
    /// What ran, and whether within a limit.
    runs: Vec<(String, bool)>,
    next: String,
    /// Runs that last longer than their limit.
    slow: &'static [&'static str],
}

impl Desk {
    fn new(slow: &'static [&'static str]) -> Self {
        Desk {
            now: 0.0,
            runs: Vec::new(),
            next: String::new(),
            slow,
        }
    }
}

impl Bench for Desk {
    fn next(&mut self, what: &str) {
        self.next = what.to_string();
    }

    fn now(&self) -> f64 {
        self.now
    }

    fn run(&mut self, limit: Option<f64>, work: &mut (dyn FnMut(&Progress) + Send)) -> Cost {
        let progress = Progress::default();
        let slow = limit.is_some() && self.slow.iter().any(|s| self.next.contains(s));
        if slow {
            progress.stop();
        }
        work(&progress);
        let seconds = if slow { limit.unwrap_or(1.0) } else { 1.0 };
        self.now += seconds;
        self.runs.push((self.next.clone(), limit.is_some()));
        Cost {
            seconds,
            bytes: None,
            stopped: slow,
        }
    }

    fn machine(&self) -> (String, usize) {
        ("a test".to_string(), 1)
    }
}

fn level(text: &str) -> Level {
    read(text.into(), "rooms.toml", None).unwrap()
}

fn studied(budget: f64, slow: &'static [&'static str]) -> (Level, Study, Desk) {
    let level = level(ROOMS);
    let options = StudyOptions {
        cells: Options::default(),
        seed: 1,
        budget,
    };
    let mut desk = Desk::new(slow);
    let study = study(&level, &options, &mut desk).unwrap();
    (level, study, desk)
}

fn of<'a>(study: &'a Study, label: &str) -> &'a Run {
    let mut runs = study.results.methods.iter();
    runs.find(|r| r.label == label)
        .unwrap_or_else(|| panic!("{label}"))
}

#[test]
fn everything_runs_where_there_is_time() {
    let (level, study, desk) = studied(1e6, &[]);
    let results = &study.results;
    assert_eq!(results.truth.agreed, Some(true));
    assert!(results.notes.is_empty(), "{:?}", results.notes);
    assert_eq!(results.subdivisions.len(), Subdivision::ALL.len());
    assert_eq!(results.heights.as_ref().unwrap().runs.len(), 6);
    for run in &results.methods {
        assert_eq!(run.state, State::Complete, "{}", run.label);
        let answer = run.answer.unwrap();
        let Accuracy {
            overestimate,
            underestimate,
            ..
        } = answer.accuracy;
        // What the classes promise.
        assert!(overestimate == 0.0 || !["exact", "aggressive"].contains(&run.class));
        assert!(underestimate == 0.0 || !["exact", "conservative"].contains(&run.class));
    }
    for label in ["sweep", "search", "lp", "flow", "flood", "sample, 100 rays"] {
        let runs = of(&study, label).seconds.unwrap().runs;
        assert!(runs >= 5, "{label} ran {runs} times");
    }
    assert!(of(&study, "sample, 100 rays").answer.unwrap().pairs >= study.graph.cells.len() as u64);
    // Only what nothing goes without has no limit, and what is known to end.
    let free = |(what, limited): &&(String, bool)| !limited && !what.starts_with("once more");
    assert_eq!(desk.runs.iter().filter(free).count(), 6);
    let page = page(&level, &study);
    assert!(page.contains("A &amp; &lt;B&gt;") && !page.contains("<B>"));
    assert!(!page.contains("NaN") && !page.contains("inf "));
}

#[test]
fn a_short_budget_leaves_out_and_says_so() {
    // Six seconds are spent on cutting and sweeping; two thirds of thirty on the rest.
    let (level, study, desk) = studied(30.0, &[]);
    assert!(desk.now <= 30.0, "{}", desk.now);
    let left_out = |r: &&Run| r.state == State::LeftOut;
    let n = study.results.methods.iter().filter(left_out).count();
    assert!(n > 0 && study.results.notes.len() >= n);
    assert!(
        study
            .results
            .notes
            .iter()
            .all(|note| note.contains("left out"))
    );
    for run in study.results.methods.iter().filter(left_out) {
        assert!(run.seconds.is_none() && run.answer.is_none());
    }
    assert!(page(&level, &study).contains("left out"));
}

#[test]
fn what_is_stopped_is_called_so() {
    let (level, study, _) = studied(1000.0, &["search", "lp"]);
    let search = of(&study, "search");
    assert_eq!((search.state, search.answer), (State::GaveUp, None));
    assert_eq!(study.results.truth.agreed, None);
    assert_eq!(of(&study, "lp").state, State::CutShort);
    // What is stopped does not run again.
    assert_eq!(of(&study, "lp").seconds.unwrap().runs, 1);
    let notes = study.results.notes.join("\n");
    assert!(notes.contains("search was stopped") && notes.contains("lp was stopped"));
    let page = page(&level, &study);
    assert!(page.contains("cut short") && page.contains("no answer"));
}

#[test]
fn nothing_but_times_differs_between_runs() {
    let json = || {
        let (_, study, _) = studied(1e6, &[]);
        serde_json::to_value(&study.results).unwrap()
    };
    let (first, second) = (json(), json());
    assert_eq!(first, second);
    let keys = |v: &Value| v.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    for key in [
        "format",
        "level",
        "setting",
        "truth",
        "methods",
        "differences",
        "notes",
    ] {
        assert!(keys(&first).iter().any(|k| k == key), "{key}");
    }
    assert_eq!(first["format"], "enfilade.study");
    assert_eq!(first["methods"][0]["method"], "sweep");
    assert_eq!(first["methods"][0]["answer"]["missed"], 0);
}

#[test]
fn a_level_without_inside_is_no_subject() {
    let level = level("[[wall]]\npoints = [[0, 0], [1, 0]]");
    let options = StudyOptions {
        cells: Options::default(),
        seed: 1,
        budget: 10.0,
    };
    assert!(study(&level, &options, &mut Desk::new(&[])).is_none());
}
