//! Divides the setup of a frame into pieces of work for threads.
//!
//! A piece is a range of vertices, triangles or edges of one draw. Its elements are neighbours, so
//! a piece has a home tile on the screen: the tile of its middle element. Pieces are distributed in
//! the order of their homes, and tiles in the same order, so each thread mostly draws triangles it
//! has set up.

use crate::accel::Accelerated as _;
use crate::accel::CLUSTER;
use crate::frame::FramePlan;
use crate::frame::draw::Draw;
use crate::screen::clip::Screen;
use crate::screen::tiles::{TILE, tiles_of};
use crate::work_stealing::WorkStealing;
use marraztu_core::base::image::Size;
use marraztu_core::scene::NONE;

/// The target number of pieces: smaller pieces are drawn closer to their homes.
const PIECES: usize = 256;

/// The smallest and largest size of a piece.
const LEAST: usize = 4 * CLUSTER;
const MOST: usize = 32 * CLUSTER;

/// Returns the size of a piece of `count` elements: a multiple of clusters.
pub(crate) fn piece_of(count: usize) -> usize {
    (count / PIECES).next_multiple_of(CLUSTER).clamp(LEAST, MOST)
}

/// The number of triangles, polygons or edges below which a single thread sets them up, because
/// waking the others takes longer.
pub(crate) const FEW: usize = 512;

/// The same limit for vertices, which take a few nanoseconds each.
pub(crate) const FEW_VERTICES: usize = 8192;

/// A piece of work.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Work<W> {
    pub(crate) draw: usize,
    pub(crate) what: W,
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// The index of the piece in the order of adding.
    pub(crate) place: usize,
    /// The tile that contains the middle element, or is nearest to it.
    home: usize,
}

/// The kind of a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) enum What {
    /// Setup of triangles.
    Triangles,
    /// Outlines of polygons that are single triangles, in draw order.
    Facing,
    /// Outlines of polygons.
    FacingOneByOne,
    /// Setup of edges.
    Edges,
    /// Setup of polygon normals.
    Normals,
    /// Setup of the lines and points of a mesh.
    Strokes,
}

/// Pieces of work on one picture, in the order of their homes.
#[derive(Debug)]
pub(crate) struct WorkList<W> {
    pieces: Vec<Work<W>>,
    /// The number of elements in all pieces.
    count: usize,
}

impl<W> Default for WorkList<W> {
    fn default() -> Self {
        Self { pieces: Vec::new(), count: 0 }
    }
}

impl<W: Copy> WorkList<W> {
    /// Removes all pieces.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
        self.count = 0;
    }

    /// Adds `count` elements of a draw. Their positions in object space determine their homes.
    pub(crate) fn add(
        &mut self,
        (i, draw): (usize, &Draw),
        (what, count): (W, usize),
        plan: &FramePlan,
        position: impl Fn(usize) -> [f64; 3],
    ) {
        let screen = Screen::new(draw.clip_from_object, plan.viewport).seen_from(plan.shift);
        self.count += count;
        let piece = piece_of(count);
        let places = self.pieces.len()..;
        self.pieces.extend(places.zip((0..count).step_by(piece)).map(|(place, from)| {
            let to = count.min(from + piece);
            // The home only decides which thread takes the piece, so one element is enough.
            let home = home(&screen, plan.size, position(from.midpoint(to)));
            Work { draw: i, what, from, to, place, home }
        }));
    }

    /// Returns all pieces, in the order of their homes.
    pub(crate) fn sorted(&mut self) -> &[Work<W>] {
        self.pieces.sort_unstable_by_key(|work| work.home);
        &self.pieces
    }

    /// Returns the number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Returns the number of threads worth waking: one for fewer than `few` elements.
    pub(crate) fn threads(&self, few: usize) -> usize {
        if self.count < few { 1 } else { rayon::current_num_threads() }
    }

    /// Distributes `tiles` tiles: each thread starts at the home of its pieces.
    pub(crate) fn shares_of_tiles(&self, tiles: usize) -> WorkStealing {
        let threads = rayon::current_num_threads();
        // Few pieces give no useful starts, so the tiles are divided evenly.
        if self.pieces.len() < 4 * threads {
            return WorkStealing::new(tiles, threads);
        }
        // The pieces were sorted by home during setup, so these starts ascend.
        WorkStealing::beginning_at(
            tiles,
            (0..threads).map(|i| self.pieces[i * self.pieces.len() / threads].home),
        )
    }
}

impl What {
    /// Returns the position of element `i` in object space; for normals, the position of polygon
    /// `i`.
    pub(crate) fn position(self, draw: &Draw, i: usize) -> [f64; 3] {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        match self {
            Self::Triangles | Self::Facing => order.position(order.triangles[i].vertices[0]),
            Self::FacingOneByOne | Self::Normals => {
                let polygon = u32::try_from(i).unwrap_or(0);
                let corner = mesh.corners()[mesh.corners_of(polygon).start];
                mesh.positions()[corner.position as usize].map(f64::from)
            }
            Self::Strokes => mesh.stroke_ends(&mesh.strokes()[i])[0].to_array(),
            Self::Edges => match mesh.edge_order().edges[i].vertices[0] {
                // An edge that no triangle uses has no vertex in draw order; any home will do.
                NONE => [0.0; 3],
                vertex => order.position(vertex),
            },
        }
    }
}

/// Returns the tile of the picture that contains a position, or is nearest to it.
#[expect(clippy::cast_possible_truncation, reason = "held to the picture")]
fn home(screen: &Screen, size: Size, place: [f64; 3]) -> usize {
    let (at, shift) = (screen.pixels(screen.clip(place)), screen.shift_in_pixels());
    let tiles = tiles_of(size);
    // The cast saturates and turns NaN into 0, so every position gets a tile.
    let [column, row] = [0, 1]
        .map(|axis| (((at[axis] - shift[axis]) as i32) / TILE).clamp(0, (tiles[axis] - 1).max(0)));
    usize::try_from(row * tiles[0] + column).expect("not negative")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_whole_clusters_of_bounded_size() {
        for count in [0, 1, 4096, 69_451, 1_000_000, 50_000_000] {
            let piece = piece_of(count);
            assert!(
                piece.is_multiple_of(CLUSTER) && (LEAST..=MOST).contains(&piece),
                "{count}: {piece}"
            );
        }
    }

    #[test]
    fn a_home_is_the_tile_of_a_place_or_the_nearest() {
        let size = Size { width: 200, height: 100 };
        let screen = Screen::new(glam::DMat4::IDENTITY, size);
        let homes = [
            ([-1.0, 1.0, 0.5], 0),
            ([0.99, 0.9, 0.5], 3),
            ([0.0, -0.9, 0.5], 5),
            ([-9.0, -9.0, 0.5], 4),
            ([1e300, 1e300, 0.5], 3),
            ([f64::NAN; 3], 0),
        ];
        for (place, tile) in homes {
            assert_eq!(home(&screen, size, place), tile, "{place:?}");
        }
    }
}
