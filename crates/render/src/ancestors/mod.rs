//! The ancestors' fill algorithms that share no stage with the rest.

pub(crate) mod points;
