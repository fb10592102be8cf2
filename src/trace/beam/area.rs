//! Rectangles of pixels, and sets of pixels in small ones.

use glam::DVec2;

/// A rectangle of pixels: columns `x.0..x.1`, rows `y.0..y.1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// First column, and one past the last.
    pub x: (u32, u32),
    /// First row, and one past the last.
    pub y: (u32, u32),
}

/// The middle of a pixel.
#[inline]
pub fn middle(x: u32, y: u32) -> DVec2 {
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

impl Area {
    /// Number of pixels.
    #[inline]
    pub fn len(&self) -> usize {
        self.width() as usize * self.height() as usize
    }

    /// Whether it has none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of columns.
    #[inline]
    pub fn width(&self) -> u32 {
        self.x.1 - self.x.0
    }

    /// Number of rows.
    #[inline]
    pub fn height(&self) -> u32 {
        self.y.1 - self.y.0
    }

    /// The middles of the corner pixels.
    #[inline(always)]
    pub(crate) fn corners(&self) -> [DVec2; 4] {
        let (x, y) = ([self.x.0, self.x.1 - 1], [self.y.0, self.y.1 - 1]);
        [
            middle(x[0], y[0]),
            middle(x[1], y[0]),
            middle(x[0], y[1]),
            middle(x[1], y[1]),
        ]
    }

    /// Whether a [`Mask`] can tell its pixels apart.
    #[inline]
    pub(crate) fn is_window(&self) -> bool {
        self.width() <= 8 && self.height() <= 8
    }

    /// The two parts of a rectangle, across its longer side, the first a whole number of windows.
    #[inline]
    pub(crate) fn halves(&self) -> [Area; 2] {
        let Area { x, y } = *self;
        let cut = |(from, past): (u32, u32)| from + (past - from).div_ceil(16) * 8;
        if x.1 - x.0 >= y.1 - y.0 {
            let middle = cut(x);
            [(x.0, middle), (middle, x.1)].map(|x| Area { x, y })
        } else {
            let middle = cut(y);
            [(y.0, middle), (middle, y.1)].map(|y| Area { x, y })
        }
    }
}

/// Which pixels of an [`Area`]: all, or a set of those of at most 8 columns and 8 rows. Pixel (x, y)
/// of the area has bit 8·y + x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mask(pub u64);

impl Mask {
    /// Every pixel, however many there are.
    pub const ALL: Self = Self(u64::MAX);

    /// Whether it has every pixel.
    #[inline]
    pub fn is_all(self) -> bool {
        self == Self::ALL
    }

    /// Whether it has the pixel in this column and row of the area.
    #[inline]
    pub fn has(self, column: u32, row: u32) -> bool {
        self.is_all() || (self.0 >> (8 * row + column)) & 1 != 0
    }

    /// The bits of all pixels of a window.
    #[inline]
    pub(crate) fn whole(area: &Area) -> u64 {
        const COLUMNS: u64 = 0x0101_0101_0101_0101;
        let row = (1 << area.width()) - 1;
        (COLUMNS * row) & (u64::MAX >> (64 - 8 * area.height()))
    }

    /// The smallest area around these pixels of a window, and which of its pixels they are. There
    /// must be one.
    #[inline]
    pub(crate) fn trim(bits: u64, area: &Area) -> (Area, Self) {
        let (first, last) = (bits.trailing_zeros() / 8, bits.leading_zeros() / 8);
        let columns = (bits | (bits >> 32)) as u32;
        let columns = columns | (columns >> 16);
        let columns = (columns | (columns >> 8)) & 0xff;
        let left = columns.trailing_zeros();
        let (x, y) = (area.x.0 + left, area.y.0 + first);
        let trimmed = Area {
            x: (x, area.x.0 + 32 - columns.leading_zeros()),
            y: (y, area.y.0 + 8 - last),
        };
        let bits = bits >> (8 * first + left);
        let mask = if bits == Self::whole(&trimmed) {
            Self::ALL
        } else {
            Self(bits)
        };
        (trimmed, mask)
    }

    /// Its pixels as rectangles: the whole area, or runs in a row.
    pub fn rectangles(self, area: &Area, mut each: impl FnMut(Area)) {
        if self.is_all() {
            return each(*area);
        }
        for row in 0..area.height() {
            let mut bits = (self.0 >> (8 * row)) as u8;
            while bits != 0 {
                let from = bits.trailing_zeros();
                let past = from + (!(bits >> from)).trailing_zeros();
                let (x, y) = (area.x.0, area.y.0 + row);
                each(Area {
                    x: (x + from, x + past),
                    y: (y, y + 1),
                });
                bits &= (0xffu32 << past) as u8;
            }
        }
    }
}
