//! The floors of the program that read files, and no others: nothing that draws or knows of windows
//! has to be built for fuzzing, and none of its branches is counted.

#[path = "../../src/base/mod.rs"]
pub mod base;
#[path = "../../src/io/mod.rs"]
pub mod io;
#[path = "../../src/scene/mod.rs"]
pub mod scene;
