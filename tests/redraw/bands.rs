//! A picture drawn in bands of rows has the same bytes as one drawn as a whole.

use marraztu_core::accuracy::{ACCURACY_PRESETS, Resolution};
use marraztu_render::{Bands, without_ground};

use super::*;

/// Draws a picture in bands of at most these pixels. Returns their number, and all pixels.
fn in_bands(shot: &Shot, transparent: bool, pixels: usize) -> (usize, Vec<[u8; 4]>) {
    let mut bands = Bands::with_at_most(shot, transparent, pixels);
    assert_eq!(bands.size(), shot.size);
    assert_eq!(bands.stays(), shot.size.area() <= pixels);
    let (mut joined, mut count, mut reached) = (Vec::new(), 0, 0);
    let told = AtomicUsize::new(0);
    let tell = |done: usize, all: usize| {
        told.fetch_max(1000 * done / all, Ordering::Relaxed);
    };
    while let Some(band) = bands.draw_next(&|| true, &tell).unwrap() {
        assert_eq!(band.size().width, shot.size.width);
        joined.extend_from_slice(band.pixels());
        count += 1;
        let now = told.load(Ordering::Relaxed);
        assert!(now > reached, "the progress stays at {reached} of 1000");
        reached = now;
    }
    assert_eq!(reached, 1000);
    (count, joined)
}

#[test]
fn bands_of_random_scenes_are_the_rows_of_the_whole_picture() {
    let mut rng = Rng::new(71);
    for i in 0..24 {
        let mut desk = Desk::new();
        for _ in 0..8 {
            desk.change(&mut rng);
        }
        let Desk { scene, view, .. } = &desk;
        let samples = [Samples::One, Samples::Four, Samples::Sixteen][i % 3];
        let settings = Settings { samples, resolution: Resolution::Full, ..desk.settings };
        let size = Size::new(70 + 61 * (i % 4), 300 + i);
        let shot = Shot::new(scene, view, &settings, size);
        let mut whole = Renderer::default();
        let (count, bands) = in_bands(&shot, false, size.width * 100);
        assert_eq!(count, size.height.div_ceil(64), "one row of tiles in each band");
        assert!(bands == whole.render(&plan_frame(&shot)).pixels(), "{i}: {settings:?}");
        let (_, bands) = in_bands(&shot, true, size.width * 200);
        assert!(bands == without_ground(&mut whole, &shot).pixels(), "{i}: transparent");
    }
}

#[test]
fn every_choice_and_every_preset_is_drawn_in_bands() {
    let (scene, view) = marraztu_io::default_scene();
    let presets = ACCURACY_PRESETS.iter().map(|preset| preset.of(&Settings::default()));
    let choices = AXES.iter().flat_map(|axis| axis.choices);
    let choices = choices.map(|choice| choice.of(&Settings::default()));
    for settings in presets.chain(choices) {
        let is_ideal = settings.samples == Samples::TwoFiftySix;
        let size = if is_ideal { Size::new(70, 200) } else { Size::new(200, 330) };
        let shot = Shot::new(&scene, &view, &settings, size);
        let (count, bands) = in_bands(&shot, false, size.width * 130);
        // Pictures at half resolution are drawn and enlarged as a whole.
        assert_eq!(count > 1, settings.resolution == Resolution::Full, "{settings:?}");
        assert!(bands == Renderer::default().render(&plan_frame(&shot)).pixels(), "{settings:?}");
    }
}

#[test]
fn the_ideal_is_drawn_in_bands_of_an_odd_number_of_tile_rows() {
    let (scene, view) = marraztu_io::default_scene();
    let (samples, light) = (Samples::TwoFiftySix, LightAt::Sample);
    let settings = Settings { samples, light, ..Settings::default() };
    let shot = Shot::new(&scene, &view, &settings, Size::new(40, 250));
    let (count, bands) = in_bands(&shot, false, 40 * 64 * 3);
    assert_eq!(count, 2);
    assert!(bands == Renderer::default().render(&plan_frame(&shot)).pixels());
}

#[test]
fn a_picture_in_bands_is_cancelled_between_tiles() {
    let (scene, view) = marraztu_io::default_scene();
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(200, 330));
    let mut bands = Bands::with_at_most(&shot, false, 200 * 64);
    assert!(bands.draw_next(&|| true, &|_, _| {}).unwrap().is_some());
    assert_eq!(bands.draw_next(&|| false, &|_, _| {}), Err(Cancelled));
    // The same band can be drawn again.
    let mut last = None;
    while let Some(band) = bands.draw_next(&|| true, &|_, _| {}).unwrap() {
        last = Some(band);
    }
    let whole = Renderer::default().render(&plan_frame(&shot)).clone();
    let rows = last.unwrap();
    assert!(whole.pixels().ends_with(rows.pixels()) && rows.size().height == 330 % 64);
}
