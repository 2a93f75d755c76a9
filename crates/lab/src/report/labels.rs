//! Places labels next to marks without overlaps.

/// A rectangle of text: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextBox {
    /// The left and the upper edge.
    pub min: [f32; 2],
    /// The right and the lower edge.
    pub max: [f32; 2],
}

impl TextBox {
    /// Makes a box from its corner and size.
    pub fn new([left, top]: [f32; 2], [width, height]: [f32; 2]) -> Self {
        Self { min: [left, top], max: [left + width, top + height] }
    }

    /// Returns whether two boxes share more than an edge.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|i| self.min[i] < other.max[i] && other.min[i] < self.max[i])
    }

    fn is_inside(&self, other: &Self) -> bool {
        (0..2).all(|i| other.min[i] <= self.min[i] && self.max[i] <= other.max[i])
    }
}

/// Places a label of each size near its mark, inside `frame`: next to the mark, or in the nearest
/// free place within `reach`. Labels never overlap each other, a mark, or the line that joins the
/// marks: one without room is left out. The label of the mark `first` is placed first, even over
/// the line if there is no other room.
pub fn place(
    marks: &[[f32; 2]],
    sizes: &[[f32; 2]],
    first: usize,
    frame: &TextBox,
    [radius, reach]: [f32; 2],
) -> Vec<Option<TextBox>> {
    let squares: Vec<TextBox> = marks
        .iter()
        .map(|[x, y]| TextBox::new([x - radius, y - radius], [2.0 * radius; 2]))
        .collect();
    let line: Vec<TextBox> = marks.windows(2).flat_map(|ends| along(ends[0], ends[1])).collect();
    let both = [squares.as_slice(), line.as_slice()].concat();
    let mut taken: Vec<TextBox> = Vec::new();
    let mut placed = vec![None; marks.len()];
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by_key(|i| *i != first);
    for i in order {
        let near = || around(marks[i], sizes[i], radius, reach);
        let free = |text: &TextBox, marks: &[TextBox]| {
            let clear = |others: &[TextBox]| others.iter().all(|other| !other.overlaps(text));
            text.is_inside(frame) && clear(&taken) && clear(marks)
        };
        let mut found = near().find(|text| free(text, &both));
        if i == first {
            found = found
                .or_else(|| near().find(|text| free(text, &squares)))
                .or_else(|| near().find(|text| free(text, &[])));
        }
        taken.extend(found);
        placed[i] = found;
    }
    placed
}

/// Returns small squares along the line between two marks.
fn along(from: [f32; 2], to: [f32; 2]) -> impl Iterator<Item = TextBox> {
    const PARTS: u16 = 64;
    (0..=PARTS).map(move |i| {
        let part = f32::from(i) / f32::from(PARTS);
        let [x, y] = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
        TextBox::new([x - 2.0, y - 2.0], [4.0; 2])
    })
}

/// Returns boxes around a mark, the nearest first.
fn around(
    [x, y]: [f32; 2],
    [w, h]: [f32; 2],
    radius: f32,
    reach: f32,
) -> impl Iterator<Item = TextBox> {
    let gaps = (0_u16..).map(move |step| radius + 2.0 + f32::from(step) * 4.0);
    gaps.take_while(move |gap| *gap <= radius + reach).flat_map(move |gap| {
        let near = gap - radius;
        [
            [x + gap, y - h / 2.0],
            [x - gap - w, y - h / 2.0],
            [x + near, y - gap - h],
            [x + near, y + gap],
            [x - near - w, y - gap - h],
            [x - near - w, y + gap],
            [x - w / 2.0, y - gap - h],
            [x - w / 2.0, y + gap],
        ]
        .map(|corner| TextBox::new(corner, [w, h]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_marks_at_one_place_do_not_overlap_and_stay_inside_and_near() {
        let frame = TextBox::new([0.0; 2], [600.0, 300.0]);
        let sizes: Vec<[f32; 2]> = (0..20u8).map(|i| [60.0 + 8.0 * f32::from(i), 16.0]).collect();
        for at in [[300.0, 150.0], [2.0, 2.0], [598.0, 298.0]] {
            let all = place(&[at; 20], &sizes, 19, &frame, [5.0, 22.0]);
            assert!(all[19].is_some(), "it is placed first");
            let placed: Vec<TextBox> = all.into_iter().flatten().collect();
            assert!((2..20).contains(&placed.len()), "{at:?}: {}", placed.len());
            let far = place(&[at; 20], &sizes, 19, &frame, [5.0, 600.0]);
            assert!(far.into_iter().flatten().count() > placed.len());
            // One more than the reach: a label at its end overlaps.
            let near = TextBox::new(at.map(|i| i - 28.0), [56.0; 2]);
            for (i, a) in placed.iter().enumerate() {
                assert!(a.is_inside(&frame) && a.overlaps(&near));
                assert!(placed[..i].iter().all(|b| !a.overlaps(b)), "{at:?} {i}");
            }
        }
    }

    #[test]
    fn a_label_is_next_to_its_mark_and_covers_neither_another_nor_the_line() {
        let frame = TextBox::new([0.0; 2], [200.0, 100.0]);
        let marks = [[50.0, 50.0], [70.0, 50.0]];
        let placed = place(&marks, &[[40.0, 12.0]; 2], 0, &frame, [4.0, 22.0]);
        let first = placed[0].unwrap();
        assert!(first.max[0] <= 46.0, "the right side is taken by the other mark: {first:?}");
        assert_eq!(placed[1].unwrap(), TextBox::new([76.0, 44.0], [40.0, 12.0]));
        assert_eq!(place(&marks[..1], &[[400.0, 12.0]], 0, &frame, [4.0, 22.0]), [None]);
    }
}
