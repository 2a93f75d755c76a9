//! The floors of the program that read files, without those that draw or have windows: these need
//! not be built for fuzzing, and their branches are not counted.

#[path = "../../src/base/mod.rs"]
pub mod base;
#[path = "../../src/io/mod.rs"]
pub mod io;
#[path = "../../src/scene/mod.rs"]
pub mod scene;
