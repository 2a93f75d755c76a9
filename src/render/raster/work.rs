//! What threads do to bring a frame onto the screen, piece by piece.
//!
//! A piece is so many vertices, triangles or edges of one draw. They lie side by side, so a piece
//! has a home on the screen: the tile that its middle is in. Pieces are handed out in the order of
//! these homes, and tiles are in the same order, so that each thread draws mostly what it has set
//! up itself.

use crate::base::image::Size;
use crate::base::work_stealing::WorkStealing;
use crate::render::frame::draw::Draw;
use crate::render::screen::clip::Screen;
use crate::render::screen::tiles::{TILE, tiles_of};
use crate::scene::{CLUSTER, NONE};

/// How many pieces are made of many vertices, triangles, polygons or edges: the smaller they are,
/// the more of them are at home where they are drawn.
const PIECES: usize = 256;

/// The least and the most of a piece.
const LEAST: usize = 4 * CLUSTER;
const MOST: usize = 32 * CLUSTER;

/// How many of so many are a piece; whole clusters.
pub(crate) fn piece_of(count: usize) -> usize {
    (count / PIECES).next_multiple_of(CLUSTER).clamp(LEAST, MOST)
}

/// Fewer than this are set up by one thread: waking the others would take longer.
const FEW: usize = 4096;

/// What a thread takes at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Work<W> {
    pub(crate) draw: usize,
    pub(crate) what: W,
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// How many pieces were added before it.
    pub(crate) place: usize,
    /// The tile that its middle is in, or is nearest to.
    home: usize,
}

/// What is set up.
#[derive(Clone, Copy, Debug)]
pub(crate) enum What {
    /// Triangles into bins.
    Triangles,
    /// The outlines of polygons that are one triangle each, in the order of drawing.
    Facing,
    /// The outlines of polygons.
    FacingOneByOne,
    /// Edges into bins.
    Edges,
}

/// Pieces of work on one picture, in the order of their homes.
#[derive(Debug)]
pub(crate) struct WorkList<W> {
    pieces: Vec<Work<W>>,
    /// Vertices, triangles, polygons and edges of all.
    count: usize,
}

impl<W> Default for WorkList<W> {
    fn default() -> Self {
        Self { pieces: Vec::new(), count: 0 }
    }
}

impl<W: Copy> WorkList<W> {
    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
        self.count = 0;
    }

    /// Adds so many of a draw, each of which has a position in object space.
    pub(crate) fn add(
        &mut self,
        (i, draw): (usize, &Draw),
        (what, count): (W, usize),
        size: Size,
        position: impl Fn(usize) -> [f64; 3],
    ) {
        let screen = Screen::new(draw.clip_from_object, size);
        self.count += count;
        let piece = piece_of(count);
        let places = self.pieces.len()..;
        self.pieces.extend(places.zip((0..count).step_by(piece)).map(|(place, from)| {
            let to = count.min(from + piece);
            let home = home(&screen, size, position(from.midpoint(to)));
            Work { draw: i, what, from, to, place, home }
        }));
    }

    /// All pieces, in the order of their homes.
    pub(crate) fn sorted(&mut self) -> &[Work<W>] {
        self.pieces.sort_unstable_by_key(|work| work.home);
        &self.pieces
    }

    /// How many pieces there are.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// How many threads it is worth waking.
    pub(crate) fn threads(&self) -> usize {
        if self.count < FEW { 1 } else { rayon::current_num_threads() }
    }

    /// WorkStealing of `tiles` tiles that begin where those of the pieces do.
    pub(crate) fn shares_of_tiles(&self, tiles: usize) -> WorkStealing {
        let threads = rayon::current_num_threads();
        if self.pieces.len() < 4 * threads {
            return WorkStealing::new(tiles, threads);
        }
        WorkStealing::beginning_at(
            tiles,
            (0..threads).map(|i| self.pieces[i * self.pieces.len() / threads].home),
        )
    }
}

impl What {
    /// Where the `i`th is, in object space.
    pub(crate) fn position(self, draw: &Draw, i: usize) -> [f64; 3] {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        match self {
            Self::Triangles | Self::Facing => order.position(order.triangles[i].vertices[0]),
            Self::FacingOneByOne => {
                let polygon = u32::try_from(i).unwrap_or(0);
                let corner = mesh.corners()[mesh.corners_of(polygon).start];
                mesh.positions()[corner.position as usize].map(f64::from)
            }
            Self::Edges => match mesh.edge_order().edges[i].vertices[0] {
                NONE => [0.0; 3],
                vertex => order.position(vertex),
            },
        }
    }
}

/// The tile of the picture that a place is in, or is nearest to.
#[expect(clippy::cast_possible_truncation, reason = "held to the picture")]
fn home(screen: &Screen, size: Size, place: [f64; 3]) -> usize {
    let at = screen.pixels(screen.clip(place));
    let tiles = tiles_of(size);
    let [column, row] =
        [0, 1].map(|axis| ((at[axis] as i32) / TILE).clamp(0, (tiles[axis] - 1).max(0)));
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
