//! A BVH of a mesh's triangles for ray-triangle intersection.
//!
//! `obvhs` builds the tree from boxes scaled to the unit cube, so it never meets infinities. It
//! takes quadratic time for boxes that coincide, so equal boxes are merged into one leaf first. The
//! boxes of the finished tree exactly bound the unscaled triangles, or parts of long ones. A leaf
//! stores its triangles in blocks of eight, coordinate by coordinate, so SIMD code prepares eight
//! at once.
//!
//! Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
//! Construction", 2018.

use std::ops::Range;

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, u32x8};
use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use marraztu_core::base::math::each;
use marraztu_core::scene::{Accelerator, AcceleratorPlace, Mesh};

use super::draw_order::index;
use super::eight_boxes::{Box3, EMPTY, EightBoxes, union};
use super::slivers::{have_empty_boxes, split};

/// A BVH of a mesh's triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    /// The root. If no triangle of the mesh has an area, the tree has neither nodes nor triangles.
    pub root: BvhChild,
    /// The inner nodes.
    pub nodes: Vec<BvhNode>,
    /// The triangles, leaf by leaf, eight at a time.
    pub blocks: Vec<BvhBlock>,
}

/// The number of triangles in a block.
pub const BVH_BLOCK: usize = 8;

/// Up to eight triangles of a leaf. The last triangle fills the rest of the block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct BvhBlock {
    /// The coordinates in object space, for each corner and axis.
    pub corners: [[[f32; BVH_BLOCK]; 3]; 3],
    /// The triangles' indices in [`Mesh::triangles`].
    pub numbers: [u32; BVH_BLOCK],
}

impl BvhBlock {
    /// Builds a block of one to eight triangles.
    fn of(triangles: &[BvhTriangle]) -> Self {
        let mut block = Self::default();
        for i in 0..BVH_BLOCK {
            let triangle = &triangles[i.min(triangles.len() - 1)];
            block.numbers[i] = triangle.number;
            for (rows, corner) in block.corners.iter_mut().zip(triangle.corners) {
                rows.iter_mut().zip(corner).for_each(|(row, x)| row[i] = x);
            }
        }
        block
    }

    /// Returns the mask of triangles with numbers in a range: from the first bound to below the
    /// second.
    #[inline(always)]
    pub fn among<S: Simd>(&self, simd: S, [first, end]: [u32; 2]) -> u64 {
        let numbers = u32x8::from_slice(simd, &self.numbers);
        (numbers.simd_ge(first) & numbers.simd_lt(end)).to_bitmask()
    }

    /// Returns one triangle of the block.
    #[must_use]
    pub fn triangle(&self, i: usize) -> BvhTriangle {
        BvhTriangle {
            corners: self.corners.map(|rows| rows.map(|row| row[i])),
            number: self.numbers[i],
        }
    }
}

/// The largest number of children of a node.
const WIDTH: usize = EightBoxes::COUNT;

/// An inner node: the boxes of up to eight children, in four cache lines. Memory latency bounds the
/// traversal of large trees, so wide nodes keep the number of levels low.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct BvhNode {
    pub(crate) boxes: EightBoxes,
    pub(crate) children: [BvhChild; WIDTH],
}

impl Default for BvhNode {
    fn default() -> Self {
        Self { boxes: EightBoxes::default(), children: [BvhChild::NONE; WIDTH] }
    }
}

impl BvhNode {
    /// Returns the children, each with the smallest and the largest coordinates of its box.
    #[inline(always)]
    pub fn children(&self) -> impl Iterator<Item = (BvhChild, [[f32; 3]; 2])> {
        let children = self.children.iter().take_while(|child| **child != BvhChild::NONE);
        children.enumerate().map(|(i, child)| (*child, self.boxes.get(i)))
    }
}

/// A child of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BvhChild {
    /// The index of the node in [`Bvh::nodes`], or of the leaf's first block in
    /// [`Bvh::blocks`].
    pub first: u32,
    /// The number of triangles of a leaf; 0 for an inner node.
    pub count: u32,
}

impl BvhChild {
    /// Marks an unused child.
    const NONE: Self = Self { first: u32::MAX, count: 0 };

    /// Returns the blocks of a leaf.
    #[must_use]
    pub const fn blocks(self) -> Range<usize> {
        let first = self.first as usize;
        first..first + (self.count as usize).div_ceil(BVH_BLOCK)
    }
}

/// A triangle of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhTriangle {
    /// The corners in object space.
    pub corners: [[f32; 3]; 3],
    /// The triangle's index in [`Mesh::triangles`].
    pub number: u32,
}

/// The largest number of boxes in a leaf, and the cost of a node relative to a box in a leaf.
const LEAF: u32 = 8;
const NODE_COST: f32 = 4.0;

/// A mesh with at most this number of boxes is a single leaf.
const FEW: usize = 2;

impl Accelerator for Bvh {
    const PLACE: AcceleratorPlace = AcceleratorPlace::Bvh;

    /// Builds the tree of a mesh. This takes a second for a million triangles, so drawing
    /// threads do it.
    ///
    /// # Panics
    /// In builds with debug assertions, on a thread that does not draw, such as the window's.
    fn build(mesh: &Mesh) -> Self {
        debug_assert!(
            rayon::current_thread_index().is_some(),
            "a tree of boxes is built on a thread that does not draw: prepare it before"
        );
        let groups = Groups::of(mesh);
        if groups.boxes.is_empty() {
            return Self::default();
        }
        if groups.boxes.len() <= FEW {
            let mut flat = Self::default();
            flat.root = flat.add_leaf(&groups.triangles);
            return flat;
        }
        // Build a binary tree, improve it by reinsertion, and merge small subtrees into leaves.
        let unit = in_unit_cube(&groups.boxes);
        let numbers = (0..index(unit.len())).collect();
        let distance = PlocSearchDistance::Medium;
        let mut tree = PlocBuilder::with_capacity(unit.len()).build(
            distance,
            &unit,
            numbers,
            SortPrecision::U64,
            3,
        );
        ReinsertionOptimizer::default().run(&mut tree, 0.05, None);
        collapse(&mut tree, LEAF, NODE_COST);
        Self::flattened(&tree, &groups)
    }
}

impl Bvh {
    /// Adds the triangles of a leaf.
    fn add_leaf(&mut self, triangles: &[BvhTriangle]) -> BvhChild {
        let child = BvhChild { first: index(self.blocks.len()), count: index(triangles.len()) };
        self.blocks.extend(triangles.chunks(BVH_BLOCK).map(BvhBlock::of));
        child
    }

    /// Returns the triangles of a leaf.
    pub fn leaf(&self, child: BvhChild) -> impl Iterator<Item = BvhTriangle> + '_ {
        let place = move |i: usize| (child.first as usize + i / BVH_BLOCK, i % BVH_BLOCK);
        (0..child.count as usize).map(place).map(|(block, i)| self.blocks[block].triangle(i))
    }

    /// Copies the nodes of a binary tree into wide nodes, parents before children, and computes the
    /// boxes.
    fn flattened(tree: &Bvh2, groups: &Groups) -> Self {
        let mut flat = Self::default();
        // Nodes to be copied, each with the node and child slot that refers to it.
        let mut open = vec![(0, None::<(usize, usize)>)];
        let (mut triangles, mut around) = (Vec::new(), EMPTY);
        // Depth first and the first child next, so subtrees are neighbours in memory.
        while let Some((place, parent)) = open.pop() {
            let node = &tree.nodes[place];
            let own = if node.prim_count == 0 {
                let at = flat.nodes.len();
                flat.nodes.push(BvhNode::default());
                let children = children_of(tree, place).into_iter().enumerate();
                open.extend(children.map(|(i, child)| (child, Some((at, i)))).rev());
                BvhChild { first: index(at), count: 0 }
            } else {
                // A leaf of the binary tree refers to groups; it gets the triangles of all of them.
                let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                triangles.clear();
                around = EMPTY;
                for group in &tree.primitive_indices[leaf] {
                    around = union(around, groups.boxes[*group as usize]);
                    let own = groups.starts[*group as usize]..groups.starts[*group as usize + 1];
                    triangles.extend_from_slice(&groups.triangles[own]);
                }
                flat.add_leaf(&triangles)
            };
            match parent {
                None => flat.root = own,
                Some((at, child)) => {
                    flat.nodes[at].children[child] = own;
                    // Boxes of inner nodes wait for their children: see below.
                    if own.count > 0 {
                        flat.nodes[at].boxes.set(child, around);
                    }
                }
            }
        }
        // Children have larger numbers than their parents, so one backward pass computes all boxes.
        for at in (0..flat.nodes.len()).rev() {
            for child in 0..WIDTH {
                let BvhChild { first, count } = flat.nodes[at].children[child];
                if count == 0 && first != BvhChild::NONE.first {
                    let around = flat.nodes[first as usize].boxes.around();
                    flat.nodes[at].boxes.set(child, around);
                }
            }
        }
        flat
    }
}

/// Collects up to eight descendants of a node as its children. The inner node with the largest area
/// is replaced by its two children while there is room.
fn children_of(tree: &Bvh2, node: usize) -> Vec<usize> {
    let pair = |node: usize| {
        let first = tree.nodes[node].first_index as usize;
        [first, first + 1]
    };
    let mut children = Vec::from(pair(node));
    // More rays meet large boxes, so opening the largest one first spares most steps.
    while children.len() < WIDTH {
        let inner =
            children.iter().enumerate().filter(|(_, child)| tree.nodes[**child].prim_count == 0);
        let area = |node: usize| tree.nodes[node].aabb.half_area();
        let largest = inner.max_by(|(_, a), (_, b)| area(**a).total_cmp(&area(**b)));
        let Some((i, child)) = largest.map(|(i, child)| (i, *child)) else { break };
        let [first, second] = pair(child);
        children[i] = first;
        children.insert(i + 1, second);
    }
    children
}

/// Triangles, grouped by equal boxes.
#[derive(Debug, Default)]
struct Groups {
    boxes: Vec<Box3>,
    triangles: Vec<BvhTriangle>,
    /// The first triangle of each group, and the end of the last group.
    starts: Vec<usize>,
}

impl Groups {
    /// Groups the triangles of a mesh; triangles with an edge of length 0 are left out. If
    /// triangles of one part coincide, only the first is kept: they block the same rays.
    fn of(mesh: &Mesh) -> Self {
        let positions = mesh.positions();
        let corners = |number: u32| {
            // Adding 0 turns -0 into 0, so both have the same bits.
            let place =
                |corner: usize| each(positions[mesh.vertex_of(corner) as usize], |x| x + 0.0);
            each(mesh.triangle(number as usize), place)
        };
        let mut all: Vec<BvhTriangle> = (0..index(mesh.triangle_count()))
            .into_par_iter()
            .map(|number| BvhTriangle { corners: corners(number), number })
            // With two equal corners, a triangle is a line and blocks no ray.
            .filter(|it| {
                let [a, b, c] = it.corners;
                a != b && b != c && c != a
            })
            .collect();
        let part = |it: &BvhTriangle| mesh.polygon_parts()[mesh.polygon_of(it.number) as usize];
        let key = |it: &BvhTriangle| (bits(&box_of(&it.corners)), part(it), sorted(&it.corners));
        // Sorting by box brings the triangles of a group together.
        all.par_sort_unstable_by_key(|it| (bits(&box_of(&it.corners)), it.number));
        let mut groups = Self::default();
        for own in all.chunk_by_mut(|a, b| box_of(&a.corners) == box_of(&b.corners)) {
            // Two triangles are neighbours in any order, so only larger groups need the sort.
            if own.len() > 2 {
                own.sort_by_key(|it| (key(it), it.number));
            }
            groups.boxes.push(box_of(&own[0].corners));
            groups.starts.push(groups.triangles.len());
            // After sorting by key, triangles that coincide in one part follow each other.
            let mut last = None;
            for it in &*own {
                let this = Some(key(it));
                if this != last {
                    groups.triangles.push(*it);
                    last = this;
                }
            }
        }
        groups.starts.push(groups.triangles.len());
        if have_empty_boxes(&groups.triangles) { groups.split() } else { groups }
    }

    /// Splits the boxes of single triangles.
    fn split(self) -> Self {
        let (mut singles, mut groups) = (Vec::new(), Self::default());
        for (around, ends) in self.boxes.iter().zip(self.starts.windows(2)) {
            match &self.triangles[ends[0]..ends[1]] {
                [one] => singles.push((*around, *one)),
                several => groups.add(*around, several),
            }
        }
        split(&mut singles);
        singles.iter().for_each(|(around, one)| groups.add(*around, &[*one]));
        groups.starts.push(groups.triangles.len());
        groups
    }

    fn add(&mut self, around: Box3, triangles: &[BvhTriangle]) {
        self.boxes.push(around);
        self.starts.push(self.triangles.len());
        self.triangles.extend_from_slice(triangles);
    }
}

/// Returns the bits of a box.
fn bits(of: &Box3) -> [[u32; 3]; 2] {
    of.map(|corner| corner.map(f32::to_bits))
}

/// Returns the bits of three corners, in an order that does not depend on the triangle's first
/// corner.
fn sorted(corners: &[[f32; 3]; 3]) -> [[u32; 3]; 3] {
    let mut all = corners.map(|corner| corner.map(f32::to_bits));
    all.sort_unstable();
    all
}

fn box_of(corners: &[[f32; 3]; 3]) -> Box3 {
    corners.iter().fold(EMPTY, |around, corner| union(around, [*corner; 2]))
}

/// Moves and scales boxes into the unit cube. Their order along each axis is kept.
#[expect(clippy::cast_possible_truncation, reason = "the tree may be built from rounded boxes")]
fn in_unit_cube(boxes: &[Box3]) -> Vec<Aabb> {
    let [low, high] = boxes.iter().fold(EMPTY, |around, own| union(around, *own));
    // In f64, because the difference of two f32 may overflow.
    let extent = (0..3).map(|axis| f64::from(high[axis]) - f64::from(low[axis]));
    let extent = extent.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    // One scale for all axes keeps the ratios of areas, which the builder compares.
    let place = |corner: [f32; 3]| {
        let axis = |i: usize| ((f64::from(corner[i]) - f64::from(low[i])) / extent) as f32;
        Vec3A::new(axis(0), axis(1), axis(2))
    };
    boxes.par_iter().map(|[low, high]| Aabb::new(place(*low), place(*high))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::scene::MeshSource;

    #[test]
    #[should_panic(expected = "built on a thread that does not draw")]
    fn only_drawing_threads_build_a_tree() {
        let mesh = Mesh::new(MeshSource::default()).expect("an empty mesh");
        Bvh::build(&mesh);
    }
}
