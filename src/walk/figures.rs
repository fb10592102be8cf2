//! What a walk cost: a row for each frame, and what they come to.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::frame::Counts;

/// A frame's figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Its number, from 0 on.
    pub frame: u32,
    /// When it is shown.
    pub seconds: f64,
    /// The eye.
    pub eye: [f64; 3],
    /// Where it looks; unit vector.
    pub direction: [f64; 3],
    /// The eye's cell.
    pub cell: u32,
    /// That cell's sector.
    pub sector: Option<u32>,
    /// Cells in its PVS.
    pub cells_pvs: u64,
    /// What there is to paint.
    pub polygons: Counts,
    /// Rays cast, of all kinds; none in a preview.
    pub rays: u64,
    /// Pixels painted, each as often as that was done; none in a traced frame.
    pub pixels: u64,
    /// The effects that were simulated.
    pub effects: String,
    /// Whether cell, PVS and effects were taken over from the frame before.
    pub same_cell: bool,
    /// Time to find out what there is to draw.
    pub milliseconds_visibility: f64,
    /// Time to draw it.
    pub milliseconds_draw: f64,
}

/// Rows with commas between their fields, under a heading.
pub fn csv(frames: &[Frame]) -> String {
    let mut text = String::from(
        "frame,seconds,x,y,z,cell,sector,cells_pvs,cells_eye,polygons,polygons_facing,polygons_pvs,\
         polygons_eye,rays,pixels,same_cell,ms_visibility,ms_draw\n",
    );
    for f in frames {
        let (p, [x, y, z]) = (&f.polygons, f.eye);
        let sector = f.sector.map(|s| s.to_string()).unwrap_or_default();
        _ = writeln!(
            text,
            "{},{},{x},{y},{z},{},{sector},{},{},{},{},{},{},{},{},{},{:.3},{:.3}",
            f.frame,
            f.seconds,
            f.cell,
            f.cells_pvs,
            p.cells,
            p.all,
            p.facing,
            p.pvs,
            p.eye,
            f.rays,
            f.pixels,
            u8::from(f.same_cell),
            f.milliseconds_visibility,
            f.milliseconds_draw,
        );
    }
    text
}

/// Least, median and most of a number over the frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Least.
    pub least: f64,
    /// Median.
    pub median: f64,
    /// Most.
    pub most: f64,
}

impl Spread {
    /// Of some numbers; zeros of none.
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        let mut list: Vec<f64> = numbers.into_iter().collect();
        list.sort_unstable_by(f64::total_cmp);
        let (Some(&least), Some(&most)) = (list.first(), list.last()) else {
            return Self::default();
        };
        Self {
            least,
            median: list[list.len() / 2],
            most,
        }
    }
}

/// What the frames come to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of frames.
    pub frames: usize,
    /// Culling factor by backs alone.
    pub factor_facing: Spread,
    /// With the PVS.
    pub factor_pvs: Spread,
    /// With what the eye sees.
    pub factor_eye: Spread,
    /// Milliseconds to draw a frame.
    pub milliseconds_draw: Spread,
    /// What neighbouring frames share.
    pub reuse: Reuse,
}

/// What was saved because neighbouring frames share their cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Reuse {
    /// Frames in the cell of the one before.
    pub frames: usize,
    /// Milliseconds to find out what there is to draw, all frames together.
    pub milliseconds: f64,
    /// The same, had each frame cost what those in a new cell did on average.
    pub milliseconds_without: f64,
}

impl Summary {
    /// Of all frames.
    pub fn of(frames: &[Frame]) -> Self {
        let factor = |k: usize| Spread::of(frames.iter().map(|f| f.polygons.factors()[k]));
        let visibility = |same: bool| {
            let own = frames.iter().filter(move |f| f.same_cell == same);
            own.map(|f| f.milliseconds_visibility)
        };
        let (anew, kept): (f64, f64) = (visibility(false).sum(), visibility(true).sum());
        let n_anew = visibility(false).count();
        Self {
            frames: frames.len(),
            factor_facing: factor(0),
            factor_pvs: factor(1),
            factor_eye: factor(2),
            milliseconds_draw: Spread::of(frames.iter().map(|f| f.milliseconds_draw)),
            reuse: Reuse {
                frames: frames.len() - n_anew,
                milliseconds: anew + kept,
                milliseconds_without: anew / n_anew.max(1) as f64 * frames.len() as f64,
            },
        }
    }
}

/// A line of so many signs as high as the numbers, on a logarithmic scale from 1 to `most`.
pub fn sparkline(numbers: &[f64], most: f64, width: usize) -> String {
    const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let n = numbers.len();
    let width = width.min(n);
    let sign = |i: usize| {
        let part = &numbers[i * n / width..(i + 1) * n / width];
        let mean = part.iter().map(|x| x.max(1.0).ln()).sum::<f64>() / part.len() as f64;
        let height = mean / most.max(std::f64::consts::E).ln() * BARS.len() as f64;
        BARS[(height as usize).min(BARS.len() - 1)]
    };
    (0..width).map(sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: u32, eye: u64, same_cell: bool, ms: f64) -> Frame {
        Frame {
            frame: number,
            seconds: f64::from(number) / 8.0,
            eye: [1.0, 2.5, 0.25],
            direction: [1.0, 0.0, 0.0],
            cell: 7,
            sector: (number > 0).then_some(3),
            cells_pvs: 12,
            polygons: Counts {
                all: 120,
                facing: 60,
                pvs: 30,
                eye,
                cells: 4,
            },
            rays: 9,
            pixels: 0,
            effects: "none".to_string(),
            same_cell,
            milliseconds_visibility: ms,
            milliseconds_draw: 2.0,
        }
    }

    #[test]
    fn a_row_for_each_frame() {
        let text = csv(&[frame(0, 10, false, 1.0), frame(1, 12, true, 0.5)]);
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), 3);
        assert_eq!(
            rows[2],
            "1,0.125,1,2.5,0.25,7,3,12,4,120,60,30,12,9,0,1,0.500,2.000"
        );
        let fields = |row: &str| row.split(',').count();
        assert!(rows.iter().all(|row| fields(row) == fields(rows[0])));
    }

    #[test]
    fn medians_and_what_was_saved() {
        let frames = [
            frame(0, 10, false, 4.0),
            frame(1, 12, true, 0.5),
            frame(2, 20, true, 0.5),
        ];
        let summary = Summary::of(&frames);
        assert_eq!(summary.factor_facing.median, 2.0);
        assert_eq!(summary.factor_pvs.median, 4.0);
        let eye = Spread {
            least: 6.0,
            median: 10.0,
            most: 12.0,
        };
        assert_eq!(summary.factor_eye, eye);
        assert_eq!(summary.reuse.frames, 2);
        assert_eq!(summary.reuse.milliseconds, 5.0);
        assert_eq!(summary.reuse.milliseconds_without, 12.0);
        assert_eq!(Summary::of(&[]).frames, 0);
    }

    #[test]
    fn a_line_is_as_high_as_its_numbers() {
        assert_eq!(sparkline(&[1.0, 100.0, 10.0], 100.0, 80), "▁█▅");
        assert_eq!(sparkline(&[1.0; 9], 50.0, 3), "▁▁▁");
        assert_eq!(sparkline(&[], 50.0, 3), "");
    }
}
