//! The fragments of a block: its pixels that show triangles, and the triangle of each.
//!
//! A block shows few triangles on many pixels. Each triangle gets a slot that holds its attributes
//! once; fragments gather them from there. A pixel mostly shows the same triangle as its left
//! neighbour. At the start of a run of pixels, the slot is looked up in a small hash table by the
//! low bits of the triangle's number. If another triangle has replaced it in the table, the
//! triangle gets a second slot, which only costs a little time.

use std::hint::select_unpredictable;

use crate::simd::dispatch;
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16, u32x16};

use super::runs::{MARGIN, Runs, Shown};
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Bits, UP_TO_SIXTEEN};

/// The pixels of one block that show triangles. See the [module](self).
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Fragments {
    /// The number of fragments.
    pub(crate) len: usize,
    /// The index of each fragment's pixel in the block, row by row.
    pub(crate) pixels: [u8; BATCH + AT_ONCE],
    /// The columns and rows in the picture.
    pub(crate) x: [i32; BATCH + AT_ONCE],
    pub(crate) y: [i32; BATCH + AT_ONCE],
    /// The slots of the fragments' triangles. Entries beyond the last fragment are valid slots,
    /// too.
    pub(crate) slots: [i32; BATCH + AT_ONCE],
    /// The slot of each pixel of the listed block, if it shows a triangle. The last row is room for
    /// a run that starts at the last pixel.
    own_slots: [i32; BLOCK_PIXELS + ROW],
    /// Whether the fragments belong to several blocks.
    several: bool,
    /// Whether fragments may share a pixel. If so, `shares` holds each fragment's number of samples
    /// of its pixel.
    pub(crate) shared: bool,
    pub(crate) shares: [i32; BATCH],
    /// The number of samples of every pixel, if fragments may share a pixel.
    pub(crate) samples: i32,
    /// The number of slots in use.
    pub(crate) count: usize,
    /// The triangles of the slots, by their numbers in the frame.
    pub(crate) numbers: [u32; SLOTS],
    /// A hash table indexed by the low bits of a triangle's number. An entry has, from the top, the
    /// number of the last triangle put there, the number of the list, and the slot in the lowest
    /// byte.
    table: [u64; TABLE],
    /// The number of the list, as stored in the table.
    list: u64,
    /// Whether the next list may continue with these slots.
    goes_on: bool,
    /// Whether triangles have no slots: `each` holds each fragment's triangle.
    tiny: bool,
    each: [u32; BATCH + AT_ONCE],
}

/// The number of entries in the table from triangles to slots. A later triangle replaces an earlier
/// one in the same entry.
const TABLE: usize = 128;

/// The bits of list numbers in the table, and the step from one list to the next.
const LISTS: u64 = 0xffff_ff00;
const NEXT_LIST: u64 = 0x100;

/// The number of fragments listed at once; there is room for this many after the last.
const AT_ONCE: usize = 16;

const ROW: usize = BLOCK as usize;

impl Default for Fragments {
    fn default() -> Self {
        Self {
            len: 0,
            pixels: [0; BATCH + AT_ONCE],
            x: [0; BATCH + AT_ONCE],
            y: [0; BATCH + AT_ONCE],
            slots: [0; BATCH + AT_ONCE],
            own_slots: [0; BLOCK_PIXELS + ROW],
            several: false,
            shared: false,
            shares: [0; BATCH],
            samples: 1,
            count: 0,
            numbers: [0; SLOTS],
            table: [0; TABLE],
            list: NEXT_LIST,
            goes_on: false,
            tiny: false,
            each: [0; BATCH + AT_ONCE],
        }
    }
}

impl Fragments {
    /// Lists the pixels of the block with the upper left pixel `corner` that show triangles. Keeps
    /// the slots of the last list's triangles if about `most` slots suffice.
    pub(crate) fn list(
        &mut self,
        level: Level,
        visibility: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        most: usize,
    ) -> Shown {
        dispatch!(level, simd => {
            let runs = Runs::find(simd, visibility);
            self.find(simd, &runs, corner, most)
        })
    }

    /// Lists the pixels of a block like [`Self::list`], from its runs.
    pub(crate) fn list_runs(
        &mut self,
        level: Level,
        runs: &Runs,
        corner: [i32; 2],
        most: usize,
    ) -> Shown {
        dispatch!(level, simd => self.find(simd, runs, corner, most))
    }

    /// Returns whether another block's pixels fit in the list: in a batch, and in about `most`
    /// slots.
    pub(crate) const fn have_room(&self, runs: &Runs, most: usize) -> bool {
        self.goes_on
            && self.len + runs.triangles.count_ones() as usize <= BATCH
            && self.slots_suffice(runs, most)
    }

    /// Adds the pixels of another block to the list. They must fit.
    pub(crate) fn list_more(&mut self, level: Level, runs: &Runs, corner: [i32; 2]) -> Shown {
        self.several = true;
        dispatch!(level, simd => self.put_runs(simd, runs, corner))
    }

    #[inline(always)]
    fn find<S: Simd>(&mut self, simd: S, runs: &Runs, corner: [i32; 2], most: usize) -> Shown {
        self.begin_block();
        // Every pixel shows the same triangle as the one before it.
        if runs.triangles == u64::MAX && runs.left | 1 == u64::MAX {
            self.list_full_block(runs.numbers[MARGIN], corner);
            return runs.shown();
        }
        // A block without triangles uses no slots, so the last list's slots stay.
        if runs.triangles != 0 && !(self.goes_on && self.slots_suffice(runs, most)) {
            self.begin_list();
        }
        self.put_runs(simd, runs, corner)
    }

    /// Returns whether about `most` slots also suffice for these runs.
    #[inline(always)]
    const fn slots_suffice(&self, runs: &Runs, most: usize) -> bool {
        // Triangles that replace each other in the table take a slot per run.
        let room = self.count + runs.starts().count_ones() as usize <= SLOTS;
        room && self.count + runs.new_starts().count_ones() as usize <= most
    }

    /// Adds the pixels of a block to the list.
    #[inline(always)]
    fn put_runs<S: Simd>(&mut self, simd: S, runs: &Runs, corner: [i32; 2]) -> Shown {
        if runs.triangles != 0 {
            self.share_out(&runs.numbers, runs.starts());
            if runs.triangles == u64::MAX {
                self.put_all(corner);
            } else {
                self.put_some(simd, corner, runs.triangles);
            }
        }
        runs.shown()
    }

    /// Empties the list, for fragments of one block.
    #[inline(always)]
    const fn begin_block(&mut self) {
        (self.len, self.several, self.shared, self.tiny) = (0, false, false, false);
    }

    /// Reverts [`Self::list_more`] to the `len` fragments and `count` slots before it.
    pub(crate) const fn take_back(&mut self, len: usize, count: usize) {
        // The table still has the dropped slots, so the next list must start afresh.
        (self.len, self.count, self.goes_on) = (len, count, false);
    }

    /// Begins a list without slots, for [tiny](super::tiny) triangles.
    pub(crate) const fn begin_tiny(&mut self) {
        self.begin_block();
        (self.count, self.goes_on, self.tiny) = (0, false, true);
    }

    /// Returns whether the list has no slots.
    pub(crate) const fn are_tiny(&self) -> bool {
        self.tiny
    }

    /// Returns whether another block's pixels fit in a list without slots.
    pub(crate) const fn have_room_for_tiny(&self, runs: &Runs) -> bool {
        self.tiny && self.len + runs.triangles.count_ones() as usize <= BATCH
    }

    /// Adds the pixels of a block to a list without slots. They must fit.
    pub(crate) fn list_tiny(&mut self, level: Level, runs: &Runs, corner: [i32; 2]) {
        self.several = true;
        dispatch!(level, simd => self.put_tiny(simd, runs, corner));
    }

    /// Returns the triangles of the fragments of a list without slots.
    pub(crate) fn each(&self) -> &[u32] {
        &self.each[..self.len]
    }

    /// Shortens a list without slots.
    pub(crate) const fn shorten(&mut self, len: usize) {
        self.len = len;
    }

    /// Lists some triangles, each with one fragment without a position.
    pub(crate) fn list_faces(&mut self, numbers: &[u32]) {
        self.begin_block();
        self.goes_on = false;
        (self.len, self.count) = (numbers.len(), numbers.len());
        self.numbers[..numbers.len()].copy_from_slice(numbers);
        for (slot, i) in self.slots.iter_mut().zip(0..) {
            *slot = i;
        }
    }

    /// Lists all pixels of a block that one triangle covers fully.
    pub(crate) fn list_full_block(&mut self, number: u32, corner: [i32; 2]) {
        self.begin_block();
        self.begin_list();
        let slot = self.slot_of(number);
        self.own_slots.fill(slot);
        self.put_all(corner);
    }

    /// Assigns slots to the runs of pixels that start at `starts`.
    #[inline(always)]
    fn share_out(&mut self, numbers: &[u32; MARGIN + BLOCK_PIXELS], starts: u64) {
        self.goes_on = true;
        for at in Bits(starts) {
            let at = at % BLOCK_PIXELS;
            // A run is at most a row long, so a whole row is filled; the next run overwrites the
            // rest.
            let slot = self.slot_of(numbers[MARGIN + at]);
            self.own_slots[at..][..ROW].fill(slot);
        }
    }

    /// Drops the slots of the last list.
    #[inline(always)]
    fn begin_list(&mut self) {
        (self.count, self.goes_on) = (0, false);
        // A new list number invalidates all entries of the table without clearing it.
        self.list = (self.list + NEXT_LIST) & LISTS;
        // After 2^24 lists numbers repeat, and old entries would match.
        if self.list == 0 {
            (self.table, self.list) = ([0; TABLE], NEXT_LIST);
        }
    }

    /// Returns the slot of a triangle, or a new one.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "there are 64 slots"
    )]
    fn slot_of(&mut self, number: u32) -> i32 {
        let entry = &mut self.table[number as usize % TABLE];
        let new = u64::from(number) << 32 | self.list;
        // If the entry belongs to this triangle in this list, only the slot remains after the XOR.
        let known = *entry ^ new;
        let is_known = known < SLOTS as u64;
        // Without a branch, because new triangles are unpredictable.
        let slot = select_unpredictable(is_known, known, self.count as u64) as usize % SLOTS;
        *entry = new | slot as u64;
        self.numbers[slot] = number;
        self.count += usize::from(!is_known);
        slot as i32
    }

    /// Adds all pixels of a block. They must fit.
    #[inline(always)]
    fn put_all(&mut self, [left, top]: [i32; 2]) {
        let from = self.len.min(BATCH - BLOCK_PIXELS);
        let to = from..from + BLOCK_PIXELS;
        self.len = to.end;
        self.pixels[to.clone()].copy_from_slice(&ALL_PIXELS);
        self.slots[to.clone()].copy_from_slice(&self.own_slots[..BLOCK_PIXELS]);
        let places = self.x[to.clone()].iter_mut().zip(&mut self.y[to]);
        for ((x, y), place) in places.zip(ALL_PIXELS) {
            *x = left + i32::from(place) % BLOCK;
            *y = top + i32::from(place) / BLOCK;
        }
    }

    /// Adds some pixels of a block.
    #[inline(always)]
    fn put_some<S: Simd>(&mut self, simd: S, corner: [i32; 2], pixels: u64) {
        for at in (0..BLOCK_PIXELS).step_by(16) {
            let (some, to) = self.put_places(simd, corner, (at, pixels >> at & 0xffff));
            let slots = i32x16::from_slice(simd, &self.own_slots[at..at + 16]).compress(some);
            slots.store_slice(&mut self.slots[to..to + 16]);
        }
    }

    /// Adds the pixels of a block that show triangles, with their triangles.
    #[inline(always)]
    fn put_tiny<S: Simd>(&mut self, simd: S, runs: &Runs, corner: [i32; 2]) {
        for at in (0..BLOCK_PIXELS).step_by(16) {
            let (some, to) = self.put_places(simd, corner, (at, runs.triangles >> at & 0xffff));
            let numbers = u32x16::from_slice(simd, &runs.numbers[MARGIN + at..][..16]);
            numbers.compress(some).store_slice(&mut self.each[to..to + 16]);
        }
    }

    /// Adds the places of some of a block's sixteen pixels, starting at `at`. Returns their mask,
    /// and their position in the list.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 64")]
    fn put_places<S: Simd>(
        &mut self,
        simd: S,
        [left, top]: [i32; 2],
        (at, some): (usize, u64),
    ) -> (mask32x16<S>, usize) {
        let mask = mask32x16::from_bitmask(simd, some);
        let first = i32x16::splat(simd, ALL_PIXELS[at].into());
        let places = (i32x16::from_slice(simd, &UP_TO_SIXTEEN) + first).compress(mask);
        let from = self.len;
        let to = from..from + 16;
        // All lanes are stored; later pixels overwrite the lanes beyond the selected ones.
        ((places & (BLOCK - 1)) + left).store_slice(&mut self.x[to.clone()]);
        ((places >> 3) + top).store_slice(&mut self.y[to.clone()]);
        for (pixel, place) in self.pixels[to].iter_mut().zip(<[i32; 16]>::from(places)) {
            *pixel = place as u8;
        }
        self.len += some.count_ones() as usize;
        (mask, from)
    }

    #[inline(always)]
    fn put(&mut self, [x, y]: [i32; 2], place: u8, slot: i32) -> usize {
        let i = self.len.min(BATCH - 1);
        self.pixels[i] = place;
        (self.x[i], self.y[i]) = (x, y);
        self.slots[i] = slot;
        self.len += 1;
        i
    }

    /// Sets each fragment's number of samples of its pixel, out of `samples`.
    pub(crate) fn share(&mut self, of_positions: &[i32; BLOCK_PIXELS], samples: i32) {
        (self.shared, self.samples) = (true, samples);
        for (share, place) in self.shares.iter_mut().zip(&self.pixels[..self.len]) {
            *share = of_positions[usize::from(*place) % BLOCK_PIXELS];
        }
    }

    /// Empties the list, for fragments that share pixels of this many samples. Triangles keep their
    /// slots if fewer than `most` are in use.
    pub(crate) fn begin_shared(&mut self, most: usize, samples: i32) {
        self.begin_block();
        (self.shared, self.samples) = (true, samples);
        if !(self.goes_on && self.count < most) {
            self.begin_list();
        }
    }

    /// Returns whether the list has `most` fragments, or no slot for another triangle.
    pub(crate) const fn is_full(&self, most: usize) -> bool {
        self.len == most || self.count == SLOTS
    }

    /// Adds a fragment with `share` samples of its pixel. The list must not be full, and its
    /// triangles must have slots.
    #[inline(always)]
    pub(crate) fn add(&mut self, number: u32, [left, top]: [i32; 2], place: usize, share: i32) {
        let slot = self.slot_of(number);
        let place = ALL_PIXELS[place % BLOCK_PIXELS];
        let [column, row] = [i32::from(place) % BLOCK, i32::from(place) / BLOCK];
        let i = self.put([left + column, top + row], place, slot);
        self.shares[i] = share;
    }

    /// Copies the fragments of another list that have slots marked in `keep`.
    pub(crate) fn take_from(&mut self, other: &Self, keep: &[bool; SLOTS]) {
        let mut new = [0; SLOTS];
        (self.count, self.goes_on) = (0, false);
        // Kept triangles move to the first slots.
        for slot in (0..other.count).filter(|slot| keep[*slot]) {
            self.numbers[self.count] = other.numbers[slot];
            new[slot] = i32::try_from(self.count).expect("there are 64 slots");
            self.count += 1;
        }
        self.begin_block();
        (self.shared, self.samples) = (other.shared, other.samples);
        for (from, place) in other.pixels[..other.len].iter().enumerate() {
            let slot = other.slots[from].cast_unsigned() as usize;
            if keep[slot] {
                let to = self.put([other.x[from], other.y[from]], *place, new[slot]);
                self.shares[to] = other.shares[from];
            }
        }
    }

    /// Returns whether the list is one whole block, pixel by pixel in order.
    pub(crate) const fn is_whole(&self) -> bool {
        self.len == BLOCK_PIXELS && !self.several
    }
}

/// The pixels of a block, in order.
const ALL_PIXELS: [u8; BLOCK_PIXELS] = {
    let mut pixels = [0; BLOCK_PIXELS];
    let mut place = 0;
    while place < 64 {
        pixels[place as usize] = place;
        place += 1;
    }
    pixels
};

#[cfg(test)]
mod tests;
