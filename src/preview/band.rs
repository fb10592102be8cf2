//! Rows of the picture, painted: all polygons and objects in order, from either end of the list.

use smallvec::{SmallVec, smallvec};

use super::border::Line;
use super::coat::Packed;
use super::draw::{Order, Painter};
use super::fill::{fill, solid};
use super::objects::{self, Spot, Standing, Window};
use super::view::{Shown, View};

/// What is painted in one go.
pub(super) enum Job<'a> {
    Polygon(Shown<'a>),
    Objects(Standing),
}

impl Job<'_> {
    fn rows(&self) -> (u32, u32) {
        match self {
            Self::Polygon(shown) => shown.rows,
            Self::Objects(standing) => standing.rows,
        }
    }
}

/// Everything that is painted.
pub(super) struct Scene<'s> {
    pub painter: &'s Painter<'s>,
    pub view: &'s View,
    pub lines: &'s [Line],
    pub windows: &'s [Window],
    /// The farthest first.
    pub jobs: &'s [Job<'s>],
}

/// Some rows of the picture.
pub(super) struct Band<'c> {
    pub top: u32,
    pub width: usize,
    pub pixels: &'c mut [Packed],
    /// Empty, or as many.
    pub surfaces: &'c mut [u32],
}

/// Pixels that are painted at the end, when what is behind them is.
enum Late {
    /// Of a job: a row's columns.
    Span(usize, u32, (u32, u32)),
    Spot(u32, u32, Spot),
}

impl Scene<'_> {
    /// Paints a band. Returns how many pixels were painted, and how many are covered.
    #[inline(always)]
    pub fn paint(&self, order: Order, band: &mut Band) -> [u64; 2] {
        let painted = match order {
            Order::BackToFront => self.back_to_front(band),
            Order::FrontToBack => self.front_to_back(band),
        };
        let covered = band.pixels.iter().filter(|p| **p >> 24 != 0).count();
        [painted, covered as u64]
    }

    #[inline(always)]
    fn back_to_front(&self, band: &mut Band) -> u64 {
        let mut painted = 0;
        for job in self.jobs {
            let (first, past) = band.rows(job);
            for y in first..past {
                match job {
                    Job::Polygon(shown) => {
                        let columns = shown.columns(self.lines, y);
                        painted += self.span(shown, y, columns, band);
                    }
                    Job::Objects(standing) => {
                        for x in standing.columns.0..standing.columns.1 {
                            if let Some(spot) = self.spot(standing, x, y) {
                                self.dab((x, y), &spot, band);
                            }
                        }
                    }
                }
            }
        }
        painted
    }

    #[inline(always)]
    fn front_to_back(&self, band: &mut Band) -> u64 {
        let mut painted = 0;
        let width = band.width as u32;
        let n_rows = band.pixels.len() / band.width;
        let mut free: Vec<SmallVec<[(u32, u32); 6]>> = vec![smallvec![(0, width)]; n_rows];
        let mut left = n_rows;
        let mut late = Vec::new();
        for (number, job) in self.jobs.iter().enumerate().rev() {
            let (first, past) = band.rows(job);
            for y in first..past {
                let free = &mut free[(y - band.top) as usize];
                if free.is_empty() {
                    continue;
                }
                match job {
                    Job::Polygon(shown) => {
                        let columns = shown.columns(self.lines, y);
                        if columns.0 >= columns.1 {
                            continue;
                        }
                        if shown.coat.is_clear() {
                            late.extend(parts(free, columns).map(|p| Late::Span(number, y, p)));
                            continue;
                        }
                        for part in parts(free, columns) {
                            painted += self.span(shown, y, part, band);
                        }
                        take(free, columns);
                    }
                    Job::Objects(standing) => {
                        let mut taken: SmallVec<[u32; 64]> = SmallVec::new();
                        for x in parts(free, standing.columns).flat_map(|(from, to)| from..to) {
                            match self.spot(standing, x, y) {
                                Some(spot) if spot.is_clear() => {
                                    late.push(Late::Spot(x, y, spot));
                                }
                                Some(spot) => {
                                    self.dab((x, y), &spot, band);
                                    taken.push(x);
                                }
                                None => {}
                            }
                        }
                        for run in taken.chunk_by(|a, b| a + 1 == *b) {
                            take(free, (run[0], run[run.len() - 1] + 1));
                        }
                    }
                }
                left -= usize::from(free.is_empty());
            }
            if left == 0 {
                break;
            }
        }
        for late in late.iter().rev() {
            match late {
                Late::Span(number, y, columns) => {
                    if let Job::Polygon(shown) = &self.jobs[*number] {
                        painted += self.span(shown, *y, *columns, band);
                    }
                }
                Late::Spot(x, y, spot) => self.dab((*x, *y), spot, band),
            }
        }
        painted
    }

    /// Paints columns of a row; how many.
    #[inline(always)]
    fn span(&self, shown: &Shown, y: u32, (from, to): (u32, u32), band: &mut Band) -> u64 {
        if from >= to {
            return 0;
        }
        let start = band.place(0, y);
        let range = start + from as usize..start + to as usize;
        let painter = self.painter;
        let scene = (painter.world(), painter.coats(), self.view);
        fill(scene, shown, (from, y), &mut band.pixels[range.clone()]);
        if !band.surfaces.is_empty() {
            for (x, surface) in (from..).zip(&mut band.surfaces[range]) {
                if solid(painter.coats(), shown, (x, y)) {
                    *surface = shown.polygon;
                }
            }
        }
        u64::from(to - from)
    }

    #[inline(never)]
    fn spot(&self, standing: &Standing, x: u32, y: u32) -> Option<Spot> {
        let painter = self.painter;
        let scene = (painter.world(), painter.coats(), self.view);
        objects::spot(
            scene,
            (standing, self.windows),
            (x, y),
            painter.brushes().finish,
        )
    }

    fn dab(&self, (x, y): (u32, u32), spot: &Spot, band: &mut Band) {
        let at = band.place(x, y);
        band.pixels[at] = spot.over(band.pixels[at]);
        if let Some(surface) = band.surfaces.get_mut(at) {
            *surface = self.painter.polygons().iter().len() as u32 + spot.object;
        }
    }
}

impl Band<'_> {
    /// The rows of a job in the band.
    fn rows(&self, job: &Job) -> (u32, u32) {
        let (first, past) = job.rows();
        let bottom = self.top + (self.pixels.len() / self.width) as u32;
        (first.max(self.top), past.min(bottom))
    }

    fn place(&self, x: u32, y: u32) -> usize {
        (y - self.top) as usize * self.width + x as usize
    }
}

/// The parts of columns that are free.
#[inline(always)]
fn parts(free: &[(u32, u32)], (from, to): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let cut = move |&(start, end): &(u32, u32)| (start.max(from), end.min(to));
    free.iter().map(cut).filter(|part| part.0 < part.1)
}

/// Takes columns out of those that are free.
#[inline(always)]
fn take(free: &mut SmallVec<[(u32, u32); 6]>, (from, to): (u32, u32)) {
    let mut i = 0;
    while i < free.len() {
        let (start, end) = free[i];
        if end <= from {
            i += 1;
        } else if to <= start {
            return;
        } else if start < from && to < end {
            free[i].1 = from;
            free.insert(i + 1, (to, end));
            return;
        } else if start < from {
            free[i].1 = from;
            i += 1;
        } else if to < end {
            free[i].0 = to;
            return;
        } else {
            free.remove(i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::sampling::Source;

    #[test]
    fn columns_are_taken_once() {
        let mut random = Source::new(2, 7, 1);
        for _ in 0..200 {
            let mut free: SmallVec<[(u32, u32); 6]> = smallvec![(0, 50)];
            let mut plain = [true; 50];
            for _ in 0..12 {
                let mut next = || (random.next() * 51.0) as u32;
                let (a, b) = (next(), next());
                let columns = (a.min(b), a.max(b));
                if columns.0 == columns.1 {
                    continue;
                }
                let met = parts(&free, columns).flat_map(|(from, to)| from..to);
                let expected = (columns.0..columns.1).filter(|&x| plain[x as usize]);
                assert!(met.eq(expected));
                take(&mut free, columns);
                plain[columns.0 as usize..columns.1 as usize].fill(false);
                assert!(free.iter().all(|(from, to)| from < to));
                let left: u32 = free.iter().map(|(from, to)| to - from).sum();
                assert_eq!(left as usize, plain.iter().filter(|p| **p).count());
            }
        }
    }
}
