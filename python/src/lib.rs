//! The kernel of the Python module `marraztu`.
//!
//! It passes plain values and arrays: the classes for users are written in Python, in
//! `python/marraztu`, and their hints for this kernel are in `_marraztu.pyi`. All work runs in
//! [`threads::work`], without Python's lock.

#![expect(clippy::needless_pass_by_value, reason = "PyO3 passes arguments by value")]

mod errors;
mod mesh;
mod pictures;
mod scene;
mod shot;
mod text;
mod threads;
mod values;

use pyo3::prelude::*;

#[pymodule]
mod _marraztu {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::errors::LoadError;
    #[pymodule_export]
    use super::mesh::Mesh;
    #[pymodule_export]
    use super::pictures::{amplified, flip, load_picture, png, save_picture};
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::shot::Shot;
    #[pymodule_export]
    use super::threads::{after_fork, cores};
    #[pymodule_export]
    use super::values::{axes, materials};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
